"""tools/bench division: what a division costs, alone and in a growing spheroid.

Standard library only; expects the environment that tools/bench sets (DCM_LMP, LAMMPS_PLUGIN_PATH).
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from bench_mechanics import ROOT, parse

NODES = {1: 42, 2: 162, 3: 642, 4: 2562}
SECONDS, ITERATIONS, DIVISIONS = "f_division[4]", "f_division[3]", "f_division[1]"


def run_deck(name, ranks, variables, folder):
    """Run examples/NAME/in.NAME in `folder`; returns the text of its log."""
    shutil.copytree(ROOT / "examples" / name, folder, dirs_exist_ok=True)
    command = ["mpirun", "-np", str(ranks), os.environ["DCM_LMP"], "-in", f"in.{name}"]
    command += ["-log", "log.bench", "-screen", "none"]
    for key, value in variables.items():
        command += ["-var", key, str(value)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"in.{name} failed:\n{done.stdout}{done.stderr}")
    return (folder / "log.bench").read_text()


def one_division(level, folder):
    """Print what one division at an icosphere level costs on one rank."""
    step = 1.0 if level < 4 else 0.5
    log = run_deck("division", 1, {"level": level, "image": "no", "dt": step,
                                   "steps": round(300 / step)}, folder / f"division{level}")
    row = parse(log)[3]
    names = re.search(r"^ +Step .*", log, re.M).group().split()
    rows = [dict(zip(names, map(float, line.split())))
            for line in re.findall(r"^ +\d+ +[12] .*", log, re.M)]
    two = [line for line in rows if line["f_growth"] == 2]
    per_step = (two[-1]["CPU"] - two[0]["CPU"]) / (two[-1]["Step"] - two[0]["Step"])
    print(f"{NODES[level]:6d} {int(row[ITERATIONS]):11d} {row[SECONDS]:9.3f} s "
          f"{1e3 * per_step:9.2f} ms {row[SECONDS] / per_step:9.0f}", flush=True)


def spheroid(options, folder):
    """Print the spheroid's figures on 2 ranks; returns the share of the run spent dividing."""
    log = run_deck("spheroid", 2, {"level": options.level, "hours": options.hours, "movie": "no"},
                   folder / "spheroid")
    seconds, steps, parts, row = parse(log)
    share = row[SECONDS] / seconds
    print(f"\nspheroid, {NODES[options.level]} nodes per cell, 2 ranks: {steps} steps, "
          f"{int(row['f_growth'])} cells at the end,\n{int(row[DIVISIONS])} divisions in "
          f"{row[SECONDS]:.2f} s of {seconds:.1f} s")
    return share


def main():
    parser = argparse.ArgumentParser(prog="tools/bench division", description=__doc__)
    parser.add_argument("--levels", default="1,2,3,4",
                        help="icosphere levels to divide (%(default)s)")
    parser.add_argument("--hours", type=float, default=5.0, help="of the spheroid (%(default)s)")
    parser.add_argument("--level", type=int, default=2, choices=(1, 2, 3),
                        help="of its meshes (%(default)s)")
    options = parser.parse_args()
    levels = [int(text) for text in options.levels.split(",")]
    if not set(levels) <= set(NODES):
        parser.error(f"--levels {options.levels}: expected levels of 1 to 4")

    with tempfile.TemporaryDirectory(prefix="bench_division.") as name:
        folder = Path(name)
        print("one division of a round cell into two, 1 rank; a step: of the two cells\n"
              " nodes  iterations      division      a step  in steps", flush=True)
        for level in levels:
            one_division(level, folder)
        share = spheroid(options, folder)
    print(f"division_share: {share:.4f}")


if __name__ == "__main__":
    main()
