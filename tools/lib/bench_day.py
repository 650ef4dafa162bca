"""A day of the full bile duct: 31 deformable cells of 642 nodes and 486 spheres come to rest, grow
and divide (examples/bile_duct_day, size full, without lumen), with steps chosen by their error."""
import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

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


def loops(out):
    """Seconds and steps of the runs of a deck."""
    found = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps", out)
    return [(float(seconds), int(steps)) for seconds, steps in found]


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


def cells(folder):
    """The deck's table of cells at its end, by molecule ID: dict of dicts."""
    lines = (folder / "cells.dump").read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    rows = [dict(zip(lines[at].split()[2:], map(float, line.split()))) for line in lines[at + 1:]]
    return {int(row["mol"]): row for row in rows}


def errors(found, exact):
    """What of chosen steps differs from explicit ones: cells with the same ID, no daughters of a
    division that came before another. Root mean square and largest, in percent: pressures and
    contact areas of their mean, centers of the mean diameter."""
    ids = [
        i
        for i in exact
        if i in found and abs(found[i]["volume"] / exact[i]["volume"] - 1) < 0.1
    ]

    def column(table, name):
        return np.array([table[i][name] for i in ids])

    result = {}
    for name in ("pressure", "contact_area"):
        right = column(exact, name)
        off = np.abs(column(found, name) - right) / np.mean(right)
        result[name.replace("_", " ")] = off
    move = np.sqrt(sum((column(found, k) - column(exact, k)) ** 2 for k in "xyz"))
    result["center"] = move / np.mean(np.cbrt(6 * column(exact, "volume") / np.pi))
    return len(ids), {k: (100 * np.sqrt(np.mean(v**2)), 100 * v.max()) for k, v in result.items()}


def compare(folder, lmp, hours):
    """Both schemes from the same state of rest: seconds of an explicit step of 1 s."""
    run(folder, lmp, ["-var", "hours", "0.0003"])
    (folder / "bile_duct_day.restart").rename(folder / "rest.restart")
    found, each = {}, 0.0
    for motion in ("scheme explicit", None):
        words = ["-var", "from", "rest.restart", "-var", "hours", f"{hours:g}"]
        out, seconds = run(folder, lmp, words + (["-var", "motion", motion] if motion else []))
        steps = sum(n for _, n in loops(out))
        print(
            f"first {hours:g} h of the day, {motion or 'chosen steps'}: {steps} steps, "
            f"{seconds:.0f} s"
        )
        found[motion] = cells(folder)
        each = seconds / steps if motion else each
    number, off = errors(found[None], found["scheme explicit"])
    for name, (rms, most) in off.items():
        print(f"error of {number} of {len(found['scheme explicit'])} deformable cells, {name}: "
              f"{rms:.2f} % (rms), {most:.2f} % (largest)")
    return each


def main():
    parser = argparse.ArgumentParser(prog="tools/bench day", description=__doc__)
    parser.add_argument("-np", type=int, default=2, help="MPI ranks (default: 2)")
    parser.add_argument("--hours", type=float, default=24.0, help="of the day (default: 24)")
    parser.add_argument("--explicit", type=int, default=100, help="steps of the explicit scheme "
                        "that are timed at the start, for the ratio (default: 100; 0: none)")
    parser.add_argument("--error", type=float, default=2.0, metavar="HOURS", help="of the day that "
                        "are also run in explicit steps of 1 s, to compare (default: 2; 0: none)")
    args = parser.parse_args()
    lmp = [os.environ["DCM_LMP"]]
    if args.np > 1:
        lmp = [os.environ.get("DCM_MPIEXEC", "mpirun"), "-np", str(args.np), *lmp]
    sys.stdout.reconfigure(line_buffering=True)
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
            took, steps = loops(out)[0]
            each = took / steps
            print(f"explicit: {1000 * each:.1f} ms a step of 1 s, "
                  f"{each * 3600 * 27 / 60:.0f} min for 27 h (rest and day)")
        if args.error:
            each = compare(folder, lmp, args.error)
        out, seconds = run(folder, lmp, ["-var", "hours", f"{args.hours:g}"])
        runs = loops(out)
        rows = [row for row in table(out) if "v_ncells" in row]
        print(f"steps: {sum(n for _, n in runs)} ({runs[0][1]} of them to rest in 3 h), "
              f"{seconds:.0f} s, {rows[-1]['v_ncells']:.0f} deformable cells at the end; mean of "
              f"{np.mean([row['f_move[2]'] for row in rows if row['f_move[2]']]):.0f} iterations "
              f"at the steps of the thermo output")
        if each:
            print(f"ratio to explicit steps of {1000 * each:.1f} ms, were no cell born: "
                  f"{each * 3600 * (3 + args.hours) / seconds:.1f}")
        print(f"day_minutes: {sum(t for t, _ in runs) / 60:.1f}")


if __name__ == "__main__":
    main()
