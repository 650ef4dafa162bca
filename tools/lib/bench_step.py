"""Error against time of the schemes of fix dcm/motion, on the bile-duct scene as it comes to rest
(examples/bile_duct, quick size): centers of cells and pressures against a fine explicit run."""
import argparse
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SECONDS, EVERY = 1500, 300
REFERENCE = ("explicit 0.25", 0.25, "scheme explicit tolerance 1e-6")
RUNS = [
    ("explicit 1", 1.0, "scheme explicit tolerance 1e-6"),
    ("explicit 1, tolerance 1e-3", 1.0, "scheme explicit tolerance 1e-3"),
    ("implicit 5", 5.0, "scheme implicit tolerance 1e-3 maxmove 1"),
    ("implicit 10", 10.0, "scheme implicit tolerance 1e-3 maxmove 1"),
    ("implicit 20", 20.0, "scheme implicit tolerance 1e-3 maxmove 1"),
    ("auto tol 0.005", 1.0, "scheme implicit tolerance 1e-3 dt auto tol 0.005 max 60"),
    ("auto tol 0.02", 1.0, "scheme implicit tolerance 1e-3 dt auto tol 0.02 max 60"),
]


def deck():
    """The example, with a dump of the deformable cells every 300 s instead of pictures."""
    text = (ROOT / "examples/bile_duct/in.bile_duct").read_text()
    begin, end = text.index("dump            image"), text.index("# f_confine: inward")
    text = text[:begin] + (
        f"dump c dcm custom 1000000 cells.dump id x y z c_cell[4]\n"
        f"dump_modify c every/time {EVERY} sort id format float %.12g\n") + text[end:]
    text = text.replace("stop $(3600*v_hours)", f"stop {SECONDS}")
    return text[:text.index("run       ")] + "run 1000000000\n"


def run(folder, lmp, dt, motion):
    """Seconds it takes, steps, and per frame of the dump an array (cells, x y z pressure)."""
    scene = (ROOT / "examples/bile_duct/scene.bile_duct").read_text()
    scene = scene.replace("dcm/motion ${motion}\n", f"dcm/motion {motion}\n")
    scene = scene.replace("timestep        1.0", f"timestep {dt}")
    (folder / "scene.bile_duct").write_text(scene)
    (folder / "in.step").write_text(deck())
    shutil.copy(ROOT / "examples/bile_duct/cells.quick.txt", folder)
    begin = time.perf_counter()
    out = subprocess.run([*lmp, "-in", "in.step", "-nocite"], cwd=folder, text=True,
                         capture_output=True, check=False)
    seconds = time.perf_counter() - begin
    if out.returncode:
        raise SystemExit(out.stdout[-2000:])
    lines, frames = (folder / "cells.dump").read_text().splitlines(), []
    for k, line in enumerate(lines):
        if line.startswith("ITEM: ATOMS"):
            n = int(lines[k - 5])
            rows = np.array([r.split() for r in lines[k + 1:k + 1 + n]], float)
            frames.append(rows[rows[:, 4] != 0.0][:, 1:])
    steps = int([w for w in out.stdout.splitlines() if w.startswith("Loop time")][-1].split()[8])
    return seconds, steps, frames


def main():
    parser = argparse.ArgumentParser(prog="tools/bench step", description=__doc__)
    parser.add_argument("-np", type=int, default=1, help="MPI ranks (default: 1)")
    ranks = parser.parse_args().np
    lmp = [os.environ["DCM_LMP"]]
    if ranks > 1:
        lmp = [os.environ.get("DCM_MPIEXEC", "mpirun"), "-np", str(ranks), *lmp]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        seconds, steps, exact = run(folder, lmp, *REFERENCE[1:])
        times = [EVERY * k for k in range(1, len(exact))]
        print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores, {ranks} rank(s)")
        print("rms and largest error of the centers (um), mean error of the pressures (%), at "
              + ", ".join(f"{t} s" for t in times))
        print(f"{REFERENCE[0]:28s} {steps:6d} steps {seconds:7.1f} s   (reference)")
        for name, dt, motion in RUNS:
            seconds, steps, frames = run(folder, lmp, dt, motion)
            text = f"{name:28s} {steps:6d} steps {seconds:7.1f} s "
            for a, b in zip(frames[1:], exact[1:], strict=True):
                d = np.linalg.norm(a[:, :3] - b[:, :3], axis=1)
                p = np.abs(a[:, 3] - b[:, 3]).mean() / np.abs(b[:, 3]).mean()
                text += f"  {np.sqrt(np.mean(d**2)):.4f} {d.max():.4f} {100 * p:.2f}"
            print(text, flush=True)


if __name__ == "__main__":
    main()
