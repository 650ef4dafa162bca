#!/usr/bin/env python3
"""What a border of deformable cells changes and costs: a table of errors and seconds, a picture.

    ./study.py                           all borders of in.resolution, some minutes
    ./study.py --borders 0 1 all         some of them
    ./study.py --report                  table and picture of the runs there are

Errors are those of the seven cells of interest, the growing one and its neighbors, against border
all with the same meshes.  The line "all, seed 2" has other orientations of all meshes: what lies
below it is no finer than the meshes themselves.  Spheres have the pressure of their contacts alone,
without the tension of a cortex.

Each run has a folder of its own in --out; a finished one is not repeated, so that the study can be
stopped at any time and called again. Seconds are CPU time of all ranks. tools/python
examples/resolution/study.py needs nothing else. Else LAMMPS is `--lmp`, else the environment
variable DCM_LMP, else `lmp`; it needs LAMMPS_PLUGIN_PATH and LAMMPS_POTENTIALS, as for any deck of
the package. Units: um, nN, s, kPa.
"""

import argparse
import os
import re
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
BORDERS = ["none", "0", "1", "2", "3", "all"]
COLUMNS = ["border", "deformable", "steps", "CPU s", "p middle", "p around", "error p",
           "area", "error area", "distance", "error x"]  # fmt: skip
LIMITS = (0.10, 0.20)  # of the picture, kPa


def name_of(border, seed):
    return border if seed == 1 else f"{border}, seed {seed}"


def folder_of(args, border, seed):
    return args.out / name_of(border, seed).replace(", ", "-").replace(" ", "")


def run(args, border, seed):
    """Run the deck in its folder; the file `seconds` tells that it is finished."""
    folder = folder_of(args, border, seed)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    shutil.copy(HERE / "cells.txt", folder)
    command = ["mpirun", "-np", str(args.np)] if args.np > 1 else []
    command += [args.lmp, "-in", str(HERE / "in.resolution"), "-log", "log", "-nocite",
                "-var", "image", "no"]
    for name, value in {"border": border, "seed": seed, **dict(args.set)}.items():
        command += ["-var", name, str(value)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if result.returncode:
        error = re.search(r"ERROR.*", result.stdout + result.stderr)
        sys.exit(f"border {name_of(border, seed)} failed: {error[0] if error else result.stderr}")
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    (folder / "seconds").write_text(f"{seconds:.1f}\n")


def read(args, border, seed):
    """Name -> (7,) values of the cells of interest, deformable cells, steps, seconds; or None."""
    folder = folder_of(args, border, seed)
    if not (folder / "seconds").exists():
        return None
    lines = (folder / "resolution.table").read_text().splitlines()
    start = max(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    table = np.array([line.split() for line in lines[start + 1:]], dtype=float)  # fmt: skip
    names = lines[start].split()[2:]
    table = table[np.argsort(table[:, names.index("cell")])]
    cells = {name: table[:7, k] for k, name in enumerate(names)}
    step = int(lines[lines.index("ITEM: TIMESTEP") + 1])
    deformable = int((table[:, names.index("kind")] == 2).sum())
    return cells, deformable, step, float((folder / "seconds").read_text())


def rms(values):
    return float(np.sqrt(np.mean(np.sum(np.atleast_2d(values) ** 2, axis=0))))


def row(border, seed, run, reference):
    cells, deformable, steps, seconds = run
    where = np.array([cells[axis] for axis in "xyz"])
    distance = np.linalg.norm(where[:, 1:] - where[:, :1], axis=0).mean()
    p, area = cells["pressure"], cells["contact_area"]
    values = [f"{p[0]:.4f}", f"{p[1:].mean():.4f}", "-", f"{area.mean():.1f}", "-",
              f"{distance:.3f}", "-"]  # fmt: skip
    if reference and reference is not run:
        of = reference[0]
        values[2] = f"{rms(p - of['pressure']):.4f}"
        values[4] = f"{rms(area - of['contact_area']):.1f}"
        values[6] = f"{rms(where - np.array([of[axis] for axis in 'xyz'])):.3f}"
    return [name_of(border, seed), str(deformable), str(steps), f"{seconds:.1f}", *values]


def report(runs):
    """The table: pressures and their root mean square error (kPa), contact areas (um^2), mean
    distance of the neighbors from the middle and error of the centers (um)."""
    reference = runs.get(("all", 1))
    rows = [COLUMNS] + [row(*key, one, reference) for key, one in runs.items()]
    width = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(word.rjust(w) for word, w in zip(words, width, strict=True)) for words in rows
    )


def draw(args, keys):
    """Side by side, from above: deformable cells in the color of their pressure, spheres gray."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    sys.path.insert(0, str(HERE.parents[1] / "tools"))
    from lammps_dcm import load
    from lammps_dcm.render import GREY, make_picture
    from lammps_dcm.render import draw as render

    rows = -(-len(keys) // 3)
    fig, axes = plt.subplots(rows, min(3, len(keys)), figsize=(9.0, 3.0 * rows), squeeze=False,
                             constrained_layout=True)  # fmt: skip
    for ax in axes.flat:
        ax.set_axis_off()
    for ax, (border, seed) in zip(axes.flat, keys):
        folder = folder_of(args, border, seed)
        universe = load(str(folder / "resolution.data"), None)
        if border == "none":
            picture = make_picture(universe)
            picture.sphere_rgb[:] = GREY
        else:
            picture = make_picture(universe, "pressure", LIMITS, bulk_modulus=2.5)
        picture.bar, picture.legend, picture.title = None, {}, ""
        render(picture, folder / "picture.png", size=600)
        ax.imshow(plt.imread(folder / "picture.png"))
        ax.set_title(f"border {name_of(border, seed)}", fontsize=9)
    colors = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(*LIMITS), "viridis")
    fig.colorbar(colors, ax=axes, label="pressure, kPa", shrink=0.7)
    path = args.out / "resolution.png"
    fig.savefig(path, dpi=110)
    return path


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lmp", default=os.environ.get("DCM_LMP", "lmp"))
    parser.add_argument("--np", type=int, default=1, help="MPI ranks")
    parser.add_argument("--borders", nargs="+", default=BORDERS, choices=BORDERS)
    parser.add_argument("--set", nargs=2, action="append", default=[], metavar=("NAME", "VALUE"),
                        help="another variable of the deck, such as level 3; use another --out")
    parser.add_argument("--report", action="store_true", help="no runs")
    parser.add_argument("--out", type=Path, default=Path("resolution_study"), help="a folder")
    args = parser.parse_args()

    keys = [(border, 1) for border in args.borders]
    if "all" in args.borders:
        keys.append(("all", 2))
    todo = [key for key in keys if not args.report and read(args, *key) is None]
    for n, key in enumerate(todo):
        print(f"border {name_of(*key)}: run {n + 1} of {len(todo)}", flush=True)
        start = time.monotonic()
        run(args, *key)
        print(f"  took {time.monotonic() - start:.0f} s", flush=True)
    runs = {key: one for key in keys if (one := read(args, *key))}
    if not runs:
        sys.exit(f"no finished run in {args.out}")
    print(report(runs))
    print("wrote", draw(args, [key for key in runs if key[1] == 1]))


if __name__ == "__main__":
    main()
