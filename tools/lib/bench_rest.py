"""What a tissue at rest costs, and how much of a tissue rests: the quick bile duct at rest for 3 h
with longer and longer steps, against explicit steps of 1 s; and the share of cells none of whose
nodes moves by more than a hundredth of h0 in a step, there and where cells grow (examples/crowd,
half an hour)."""
import argparse
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
HOURS = 3.0
SHARE = 0.01     # of the range of adhesion h0
MOTION = ("scheme explicit", "dt auto tol 0.02 max 20", "dt auto tol 0.02 max 60",
          "dt auto tol 0.02 max 600", "dt auto tol 0.02 max 3600", "accuracy 0.02 dt auto max 3600")
WAY = """
variable        way atom dt*sqrt(vx*vx+vy*vy+vz*vz)
compute         cells dcm chunk/atom molecule nchunk every compress yes
group           nodes type 2
compute         most nodes reduce/chunk cells max v_way
fix             ways all ave/time {every} 1 {every} c_most mode vector file ways.txt
"""


def run(folder, lmp, deck, words=()):
    """Output of a run; one that fails ends the benchmark."""
    done = subprocess.run([*lmp, "-in", deck, "-nocite", *words], cwd=folder, text=True,
                          capture_output=True, check=False)
    if done.returncode:
        raise SystemExit(f"{deck} {' '.join(words)}\n{done.stdout[-3000:]}{done.stderr[-1000:]}")
    return done.stdout


def resting(folder, out):
    """Percent of cells that rest in a step, a mean over the looks of fix ave/time."""
    h0 = float(re.search(r"h0 (\S+), range", out).group(1))
    looks = []
    for line in (folder / "ways.txt").read_text().splitlines():
        words = line.split()
        if line.startswith("#"):
            continue
        if words[1].isdigit():    # step and number of cells
            looks.append([])
        else:
            looks[-1].append(float(words[1]))
    return 100.0 * np.mean([np.mean(np.array(look) < SHARE * h0) for look in looks])


def steps_of(out):
    """Seconds and steps of the last run."""
    loops = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps", out)
    return float(loops[-1][0]), int(loops[-1][1])


def duct():
    """The example until it rests, and from there."""
    text = (ROOT / "examples/bile_duct/in.bile_duct").read_text()
    text = text[:text.index("dump            image")]
    return text + (
        f"thermo_modify norm no\nrun 1000000000\nfix_modify confine hold yes\n"
        f"fix_modify move stop $(time+{3600 * HOURS})\n" + WAY.format(every=10)
        + 'run 1000000000\nprint "at rest $(f_volume[1]:%.10g) $(ebond+edihed:%.10g)"\n')


def crowd():
    """The example with the ways of its nodes."""
    text = (ROOT / "examples/crowd/in.crowd").read_text()
    return (text[:text.index("thermo_style")] + "group dcm type 1 2 3\n" + WAY.format(every=5)
            + "run 1000000000\n")


def main():
    parser = argparse.ArgumentParser(prog="tools/bench rest", description=__doc__)
    parser.add_argument("-np", type=int, default=1, help="MPI ranks (default: 1)")
    ranks = parser.parse_args().np
    lmp = [os.environ["DCM_LMP"]]
    if ranks > 1:
        lmp = [os.environ.get("DCM_MPIEXEC", "mpirun"), "-np", str(ranks), *lmp]
    print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores, {ranks} rank(s)")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name in ("bile_duct", "crowd"):
            for file in (ROOT / "examples" / name).iterdir():
                shutil.copy(file, folder)
        (folder / "in.rest").write_text(duct())
        (folder / "in.grow").write_text(crowd())
        exact = None
        for motion in MOTION:
            out = run(folder, lmp, "in.rest", ["-var", "motion", motion])
            seconds, steps = steps_of(out)
            found = np.array(re.search(r"^at rest (\S+) (\S+)$", out, re.M).groups(), float)
            exact = found if exact is None else exact
            off = 100.0 * np.abs(found / exact - 1.0)
            print(f"{motion:34s} {steps:6d} steps {seconds:7.2f} s; off by {off[0]:.3f} % of "
                  f"the pressure, {off[1]:.3f} % of the elastic energy; "
                  f"{resting(folder, out):.0f} % of the cells rest in a step", flush=True)
        out = run(folder, lmp, "in.grow", ["-var", "hours", "0.5", "-var", "image", "no"])
        print(f"crowd that grows: {steps_of(out)[1]} steps; {resting(folder, out):.0f} % of the "
              "cells rest in a step")


if __name__ == "__main__":
    main()
