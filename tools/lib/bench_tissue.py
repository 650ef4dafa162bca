"""tools/bench tissue: tracers in a tissue that grows, moves and divides; leaks, and what they cost.

Leaks are judged by the solid angle of whole cells, which fix dcm/tracer does not use. Expects the
environment that tools/bench sets (DCM_LMP, LAMMPS_PLUGIN_PATH, LAMMPS_POTENTIALS).
"""

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from bench_mechanics import ROOT, parse

sys.path.insert(0, str(ROOT / "tests"))
from support.runner import read_dump
from support.tracers import surfaces, tracers, winding

DECK = Path(__file__).with_name("in.bench_tissue")
COUNTS = ["inside", "outside", "exits", "swept", "caught", "rejected", "capped", "deleted",
          "blocked"]


def run(folder, ranks, **variables):
    """Run the deck; returns its loop time, last thermo row, and CPU seconds of all ranks."""
    folder.mkdir()
    shutil.copy(DECK, folder)
    command = ["mpirun", "-np", str(ranks), os.environ["DCM_LMP"], "-in", DECK.name]
    command += ["-log", "log.bench", "-screen", "none"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    start = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{DECK.name} failed:\n{done.stdout}{done.stderr}")
    seconds, _, _, row = parse((folder / "log.bench").read_text())
    return seconds, row, end.ru_utime - start.ru_utime


def check(folder):
    """Tracers on the wrong side, asked, largest number of cells. A tracer of the second frame of
    each look is among the surfaces of the first, against which it was moved."""
    frames = {frame.step: frame for frame in read_dump(folder / "look.dump")}
    wrong = asked = most = 0
    for step, frame in frames.items():
        if step - 1 not in frames:
            continue
        cells = {**surfaces(frame), **surfaces(frames[step - 1])}
        _, x, home, host = tracers(frame)
        asked += np.count_nonzero(host == 0)
        now = surfaces(frame)
        most = max(most, len(now))
        wrong += np.count_nonzero(~np.isin(home, [0, *now]))
        for mol in now:
            inside = winding(x, cells[mol]) > 0.5
            wrong += np.count_nonzero((host == 0) & (home == mol) & ~inside)
            wrong += np.count_nonzero((host == 0) & (home == 0) & inside)
    return wrong, asked, most


def leaks(options, folder):
    total = 0
    for ranks in (1, 4):
        where = folder / f"leaks{ranks}"
        seconds, row, _ = run(where, ranks, number=options.number, D=options.D, steps=options.steps)
        wrong, asked, cells = check(where)
        count = {name: round(row[f"f_tracer[{k}]"]) for k, name in enumerate(COUNTS, 1)}
        there = count["inside"] + count["outside"]
        print(f"{ranks} ranks: {there * options.steps:.2g} steps of {there} tracers, 8 to {cells} "
              f"cells, {seconds:.0f} s; {wrong} of {asked}\n  on the wrong side; "
              + ", ".join(f"{value} {name}" for name, value in count.items()), flush=True)
        total += wrong
    return total


def cost(options, folder):
    """CPU time with and without tracers, the least of three runs each, in which nothing divides."""
    n = 8 * options.number
    print(f"\n{'nodes':>6} {'tracers':>8} {'ms a step without':>18} {'with':>8} {'share':>7} "
          f"{'ns a tracer and step':>21}")
    for level, nodes in ((1, 42), (2, 162), (3, 642)):
        least = {}
        for number in (0, options.number) * 3:
            short, long = (
                run(folder / f"cost{level}_{number}_{steps}_{len(os.listdir(folder))}", 1,
                    number=number, D=options.D, level=level, steps=steps, look=0, cycle=1e6)[2]
                for steps in (20, 20 + options.timed)
            )
            least[number] = min(least.get(number, np.inf), (long - short) / options.timed)
        without, all_ = least[0], least[options.number]
        print(f"{nodes:6d} {n:8d} {1e3 * without:18.2f} {1e3 * all_:8.2f} "
              f"{(all_ - without) / all_:7.1%} {1e9 * (all_ - without) / n:21.0f}", flush=True)


def main():
    parser = argparse.ArgumentParser(prog="tools/bench tissue", description=__doc__)
    parser.add_argument("--number", type=int, default=500, help="tracers per cell")
    parser.add_argument("--D", type=float, default=0.04, help="um^2/s")
    parser.add_argument("--steps", type=int, default=2500, help="of the look for leaks; 0: none")
    parser.add_argument("--timed", type=int, default=100, help="steps that are timed; 0: none")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        wrong = leaks(options, Path(name)) if options.steps else 0
        if options.timed:
            cost(options, Path(name))
    sys.exit(1 if wrong else 0)


main()
