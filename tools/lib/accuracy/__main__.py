"""The command tools/accuracy."""
import argparse
import os
import platform
import sys
import time
from pathlib import Path

from .decks import ROOT
from .draw import draw
from .knobs import knobs_of
from .points import Runner
from .scenes import SCENES
from .tables import Map, sections, text, write_all

PAGE = ROOT / "doc" / "accuracy"
PICTURES = ROOT / "doc" / "img"


def processor():
    """Name of the processor, as Linux tells it."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.machine()


def parse(words):
    parser = argparse.ArgumentParser(prog="tools/accuracy", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=[])
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--quick", action="store_true")
    size.add_argument("--full", action="store_true")
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--page", action="store_true")
    parser.add_argument("--verify", action="store_true")
    args = parser.parse_args(words)
    unknown = [s for s in args.scenes if s not in SCENES]
    if unknown:
        raise ValueError(f"no scene {unknown[0]}; there are {' '.join(SCENES)}")
    if args.jobs < 1:
        raise ValueError(f"--jobs {args.jobs}: at least 1")
    args.scenes = args.scenes or list(SCENES)
    return args


def report(maps, folder, pictures, note=None):
    """CSV files and pictures; `note`: text of machine and date, for the page."""
    pictures.mkdir(parents=True, exist_ok=True)
    maps = [m for m in maps if draw(m, pictures / f"accuracy_{m.scene}.png")]
    if not maps:
        raise ValueError("nothing has been run yet")
    write_all(maps, folder)
    if note:
        (folder / "machine.txt").write_text(note, encoding="ascii")
        (folder / "scenes.txt").write_text(sections(maps))


def machine(full):
    """Line about when, where and how, for the page."""
    size = "full" if full else "quick"
    return (f"{time.strftime('%d %B %Y')}, {os.cpu_count()} cores of {processor()}, load "
            f"{os.getloadavg()[0]:.1f}, size *{size}*\n")


def verify(runner, args, folder):
    """Keyword accuracy on scenes that it was not made with."""
    from . import verify as unseen  # its scenes are known from here on

    if not args.report:
        runner.run_all(unseen.points())
    rows = unseen.judge(runner.result)
    for place in [folder, *([PAGE] if args.page else [])]:
        unseen.write(rows, place / "verify.csv")
        (place / "verify.txt").write_text("\n\n".join(unseen.verdict(rows)) + "\n")
    print(unseen.table(rows))
    print("\n".join(unseen.verdict(rows)))


def main(words=None, lmp=None):
    """Run what is missing and report; returns the exit status."""
    try:
        args = parse(sys.argv[1:] if words is None else words)
        folder = (args.folder or ROOT / "runs" / "accuracy").resolve()
        if args.page and not args.verify and set(args.scenes) != set(SCENES):
            raise ValueError("--page is made of all scenes: name none")
        lmp = lmp or os.environ.get("DCM_LMP", "lmp").split()
        runner = Runner(folder, lmp, args.jobs)
        if args.verify:
            verify(runner, args, folder)
            return 0
        if not args.report:
            made = runner.run_all([p for s in args.scenes for k in knobs_of(s, args.full)
                                   for p in k.points()])
            if made:
                (folder / "machine.txt").write_text(machine(args.full))
        maps = [Map(s, runner.result, args.full) for s in args.scenes]
        report(maps, folder, folder)
        whole = "\n".join(text(m) for m in maps)
        (folder / "accuracy.txt").write_text(whole)
        print(whole)
        print(f"in {folder}: accuracy.txt, points.csv, summary.csv, orders.csv, off_front.csv, "
              "failed.csv, accuracy_SCENE.png")
        if args.page:
            note = folder / "machine.txt"
            report(maps, PAGE, PICTURES, note.read_text() if note.exists() else machine(args.full))
            print(f"tables in {PAGE}, pictures in {PICTURES}")
    except KeyboardInterrupt:
        print("[accuracy] stopped; the same command goes on from here")
        return 130
    except (ValueError, OSError) as err:
        print(f"tools/accuracy: {err}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
