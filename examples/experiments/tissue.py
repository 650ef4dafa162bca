#!/usr/bin/env python3
"""A tissue as a microscope and a segmentation give it, its cells as meshes, and how near the cells
of a run are to the image.

    ./tissue.py                          the folder tissue, of which in.import makes cells
    ./tissue.py --voxel 0.25 -o fine     the same tissue, seen more finely
    ./tissue.py --report FOLDER          what a run of in.import in FOLDER says against the tissue
    ./tissue.py --study FOLDER           in.import with other voxels and meshes, and all reports

The tissue is known exactly: the cells of Voronoi of some seeds, cut off by a ball. It needs the
folder tools in PYTHONPATH; --study runs LAMMPS, which is `--lmp`, else DCM_LMP, else `lmp`.
"""

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from lammps_dcm.labels import cells_of_image
from lammps_dcm.text import write_text

BALL, APART = 13.5, 6.5  # um: radius of the tissue, least distance of two seeds
LEAST = 1.0  # um^2: who shares less is no neighbor
FINE = 0.125  # um: voxels of the image with which the tissue itself is measured
HERE = Path(__file__).resolve().parent
STUDY = [(1.0, 162), (0.5, 162), (0.25, 162), (0.5, 642), (0.25, 642)]  # voxel (um), nodes a cell


def seeds():
    """Middles of the cells, um, around the origin."""
    drawn = np.random.default_rng(2).uniform(-10.0, 10.0, (400, 3))
    chosen = []
    for seed in drawn[np.linalg.norm(drawn, axis=1) < 10.0]:
        if not chosen or cKDTree(chosen).query(seed)[0] > APART:
            chosen.append(seed)
    return np.array(chosen)


def image(voxel):
    """Labels (z, y, x) from 1, 0 outside, and the place of the corner of the first voxel, um."""
    n = int(np.ceil(BALL / voxel)) + 2
    at = (np.arange(2 * n) - n + 0.5) * voxel
    z, y, x = np.meshgrid(at, at, at, indexing="ij")
    place = np.stack([x, y, z], axis=-1)
    labels = cKDTree(seeds()).query(place)[1] + 1
    labels[np.linalg.norm(place, axis=-1) > BALL] = 0
    return labels, -n * voxel


def volumes(labels, voxel):
    return np.bincount(labels.ravel())[1:] * voxel**3


def neighbors(labels, voxel):
    """{(label, label): area, um^2} of the cells that share one. Sides of voxels between two labels
    make steps, whose area is |nx| + |ny| + |nz| times that of the border: their sums along the three
    axes are the components of its normal."""
    sums = {}
    for axis in range(3):
        a = np.moveaxis(labels, axis, 0)
        low, high = a[:-1].ravel(), a[1:].ravel()
        border = (low != high) & (low > 0) & (high > 0)
        pairs = np.sort(np.stack([low[border], high[border]], axis=1), axis=1)
        for pair, count in zip(*np.unique(pairs, axis=0, return_counts=True), strict=True):
            sums.setdefault(tuple(int(p) for p in pair), np.zeros(3))[axis] = count * voxel**2
    return {pair: float(np.linalg.norm(s)) for pair, s in sums.items()}


def write_meshes(folder, voxel, nodes):
    """A mesh of each label, at its own place, coordinates to 0.1 nm."""
    labels, corner = image(voxel)
    cells = cells_of_image(labels, np.full(3, voxel), nodes)
    folder.mkdir(parents=True, exist_ok=True)
    for cell in cells:
        rows = ["OFF", f"{len(cell.nodes)} {len(cell.faces)} 0"]
        rows += ["{:.4f} {:.4f} {:.4f}".format(*x) for x in cell.nodes + corner]
        rows += ["3 {} {} {}".format(*face) for face in cell.faces]
        write_text(folder / f"cell_{cell.label:02d}.off", "\n".join(rows) + "\n")
    return cells


def contacts(path):
    """{(cell, cell): area, um^2} of a file of in.import."""
    rows = [line.split() for line in path.read_text().splitlines()[9:]]
    return {tuple(sorted((int(a), int(b)))): float(area) for _, a, b, area in rows}


def agreement(found, expected):
    """Pairs that are right, missing and too many, and the F-score: 1 if none is wrong."""
    right = len(found & expected)
    missing, extra = len(expected) - right, len(found) - right
    return right, missing, extra, 2 * right / max(1, len(found) + len(expected))


def report(folder):
    """Lines that compare a run with the tissue itself."""
    labels, _ = image(FINE)
    exact, areas = volumes(labels, FINE), neighbors(labels, FINE)
    expected = {pair for pair, area in areas.items() if area > LEAST}
    lines = [f"tissue: {len(exact)} cells, {len(expected)} pairs that share over {LEAST:g} um^2"]
    for name in ("start", "end"):
        found = contacts(folder / f"import.{name}.contacts")
        some = {pair for pair, area in found.items() if area > LEAST}
        right, missing, extra, score = agreement(some, expected)
        share = sum(found.values()) / sum(areas.values())
        lines.append(
            f"{name}: {right} pairs right, {missing} missing, {extra} too many, F-score "
            f"{score:.3f}; contact area {share:.3f} of that of the tissue"
        )
        rows = (folder / f"import.{name}.cells").read_text().splitlines()[9:]
        volume = np.array([float(line.split()[1]) for line in rows])
        lines.append(
            f"{name}: volumes off by {100 * np.sqrt(np.mean((volume / exact - 1) ** 2)):.2f} % rms"
        )
    return lines


def study(folder, lmp):
    """Each run in a folder of its own; one that has ended is not repeated."""
    for voxel, nodes in STUDY:
        here = folder / f"voxel{voxel:g}_nodes{nodes}"
        if not (here / "import.end.cells").exists():
            write_meshes(here / "tissue", voxel, nodes)
            for name in ("in.import", "start.lmp", "cell.lmp", "experiments.dcm"):
                shutil.copy(HERE / name, here)
            words = [lmp, "-in", "in.import", "-nocite", "-log", "log.import"]
            words += ["-var", "image", "no", "-var", "overlap", "1"]
            done = subprocess.run(words, cwd=here, capture_output=True, text=True, check=False)
            if done.returncode:
                sys.exit("\n".join([" ".join(words), *done.stdout.splitlines()[-5:]]))
        log = (here / "log.import").read_text().splitlines()
        print(f"\nvoxels of {voxel:g} um, {nodes} nodes a cell")
        print(*[line for line in log if line.startswith(("after", "Total wall"))], sep="\n")
        print(*report(here), sep="\n", flush=True)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--voxel", type=float, default=0.5, help="um (default: %(default)g)")
    parser.add_argument("--nodes", type=int, default=162, help="of a cell, about")
    parser.add_argument("-o", "--output", type=Path, default=Path("tissue"), metavar="FOLDER")
    parser.add_argument("--report", type=Path, metavar="FOLDER")
    parser.add_argument("--study", type=Path, metavar="FOLDER")
    parser.add_argument("--lmp", default=os.environ.get("DCM_LMP", "lmp"))
    args = parser.parse_args()
    if args.report:
        print(*report(args.report), sep="\n")
        return
    if args.study:
        study(args.study, args.lmp)
        return
    cells = write_meshes(args.output, args.voxel, args.nodes)
    print(f"{len(cells)} cells in {args.output}")


if __name__ == "__main__":
    main()
