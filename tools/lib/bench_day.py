"""A day of the full bile duct: 31 deformable cells of 642 nodes and 486 spheres come to rest, grow
and divide (examples/bile_duct_day, size full, without lumen), with steps chosen by their error."""
import argparse
import os
import re
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OFF = [w for name in ("osmosis", "differentiation", "constriction") for w in ("-var", name, "no")]


def run(folder, lmp, options):
    """Output and seconds of a run of the deck; one that fails ends the benchmark."""
    begin = time.perf_counter()
    words = [*lmp, "-in", str(folder / "in.bile_duct_day"), "-nocite", "-var", "size", "full", *OFF,
             *options]
    done = subprocess.run(words, cwd=folder, text=True, capture_output=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(words)}\n{done.stdout[-3000:]}{done.stderr[-1000:]}")
    return done.stdout, time.perf_counter() - begin


def table(out):
    """Thermo lines of the day: list of dicts."""
    rows, names = [], None
    for line in out.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            names = words
        elif names and len(words) == len(names):
            try:
                rows.append(dict(zip(names, map(float, words))))
            except ValueError:
                names = None
    return rows


def main():
    parser = argparse.ArgumentParser(prog="tools/bench day", description=__doc__)
    parser.add_argument("-np", type=int, default=2, help="MPI ranks (default: 2)")
    parser.add_argument("--hours", type=float, default=24.0, help="of the day (default: 24)")
    parser.add_argument("--explicit", type=int, default=100, help="steps of the explicit scheme "
                        "that are timed at the start, for the ratio (default: 100; 0: none)")
    args = parser.parse_args()
    lmp = [os.environ["DCM_LMP"]]
    if args.np > 1:
        lmp = [os.environ.get("DCM_MPIEXEC", "mpirun"), "-np", str(args.np), *lmp]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for file in (ROOT / "examples/bile_duct_day").iterdir():
            (folder / file.name).write_bytes(file.read_bytes())
        print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores, {args.np} rank(s)")
        each = None
        if args.explicit:
            hours = args.explicit / 3600.0
            out, _ = run(folder, lmp, ["-var", "motion", "scheme explicit",
                                       "-var", "rest", f"{hours}", "-var", "hours", "0.0003"])
            loops = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps", out)
            each = float(loops[0][0]) / int(loops[0][1])
            print(f"explicit: {1000 * each:.1f} ms a step of 1 s, "
                  f"{each * 3600 * 27 / 60:.0f} min for 27 h (rest and day)")
        out, seconds = run(folder, lmp, ["-var", "hours", f"{args.hours:g}"])
        loops = [(float(a), int(b)) for a, b in
                 re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps", out)]
        rows = [row for row in table(out) if "v_ncells" in row]
        print(f"steps: {sum(n for _, n in loops)} ({loops[0][1]} of them to rest in 3 h), "
              f"{seconds:.0f} s, {rows[-1]['v_ncells']:.0f} deformable cells at the end")
        if each:
            print(f"ratio to the explicit scheme: {each * 3600 * (3 + args.hours) / seconds:.1f}")
        print(f"day_minutes: {sum(t for t, _ in loops) / 60:.1f}")


if __name__ == "__main__":
    main()
