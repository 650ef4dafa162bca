"""tools/bench mechanics: time the bile-duct scene on 1 and 2 ranks and say where the time goes.

Standard library only; expects the environment that tools/bench sets (DCM_LMP, LAMMPS_PLUGIN_PATH).
"""

import argparse
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DECK = ROOT / "examples" / "bile_duct"

# columns of in.bench's thermo output that are read below
ITERATIONS, ASSEMBLY, SOLVE, MESSAGES = "f_move[3]", "f_move[5]", "f_move[6]", "f_move[7]"
UNKNOWNS, CONTACTS, PRESSURE = "f_move[8]", "c_contact[2]", "f_confine[2]"


def run_lammps(ranks, options, folder):
    """Run in.bench on `ranks` ranks; returns the text of its log and the peak memory in bytes."""
    command = ["mpirun", "-np", str(ranks), os.environ["DCM_LMP"], "-in", "in.bench"]
    command += ["-log", f"log.{ranks}", "-screen", "none"]
    for name, value in (("size", options.size), ("warm", options.warm), ("timed", options.steps)):
        command += ["-var", name, str(value)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    log = folder / f"log.{ranks}"
    if done.returncode != 0:
        sys.exit(f"in.bench failed on {ranks} ranks:\n{done.stdout}{done.stderr}")
    return log.read_text(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024


def parse(log):
    """Loop time (s), steps, breakdown {section: s} and last thermo row {column: value} of a log."""
    timed = log[log.rindex("Per MPI rank memory allocation"):]
    seconds, steps = re.search(r"Loop time of (\S+) on \d+ procs for (\d+) steps", timed).groups()
    table = re.findall(r"^(\w+) +\| +\S+ +\| +(\S+) +\|", timed, re.M)
    parts = {name: float(average) for name, average in table}
    lines = timed.splitlines()
    head = next(i for i, line in enumerate(lines) if line.split()[:1] == ["Step"])
    last = next(i for i, line in enumerate(lines) if line.startswith("Loop time")) - 1
    row = dict(zip(lines[head].split(), map(float, lines[last].split())))
    return float(seconds), int(steps), parts, row


def report(ranks, log, memory):
    """Print one run's figures; returns node-steps per second."""
    seconds, steps, parts, row = parse(log)
    spheres = int(re.findall(r"and (\d+) center-based cells", log)[0])
    nodes = int(row[UNKNOWNS])
    speed = nodes * steps / seconds
    friction = {"friction matrix": row[ASSEMBLY], "solve: arithmetic": row[SOLVE],
                "solve: messages": row[MESSAGES]}
    sums = parts.get("Modify", 0.0) - sum(friction.values())
    shares = {"contact": parts.get("Pair", 0.0), "cortex and bending": parts.get("Bond", 0.0),
              **friction, "cell sums, faces, other fixes": sums,
              "neighbor lists": parts.get("Neigh", 0.0),
              "messages of LAMMPS": parts.get("Comm", 0.0)}
    print(f"\n{ranks} rank{'s' if ranks > 1 else ''}: {steps} steps in {seconds:.2f} s, "
          f"{1e3 * seconds / steps:.1f} ms a step, {speed:.3g} node-steps/s")
    print(f"  {nodes} moving nodes and spheres, {spheres} spheres in all, "
          f"{row[CONTACTS]:.0f} contacts, mean DCM pressure {row[PRESSURE]:.3f}")
    print(f"  CG iterations a step: {row[ITERATIONS]:.1f}; "
          f"memory: {memory / nodes / 1024:.1f} KiB per node on the largest rank")
    for name, value in shares.items():
        print(f"  {name:30s} {100 * value / seconds:5.1f} %")
    return speed


def main():
    parser = argparse.ArgumentParser(prog="tools/bench mechanics")
    parser.add_argument("--size", choices=["quick", "full"], default="full")
    parser.add_argument("--steps", type=int, default=100, help="timed steps (default 100)")
    parser.add_argument("--warm", type=int, default=200, help="steps before, to make contact")
    options = parser.parse_args()
    speeds = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for item in DECK.glob("*"):
            if item.is_file():
                shutil.copy(item, folder)
        for ranks in (1, 2):
            print(f"running {options.warm} + {options.steps} steps on {ranks} rank(s) ...",
                  flush=True)
            speeds.append(report(ranks, *run_lammps(ranks, options, folder)))
    print(f"\n2 ranks over 1: {speeds[1] / speeds[0]:.2f}")
    print(f"node_steps_per_second: {speeds[1]:.4g}")


if __name__ == "__main__":
    main()
