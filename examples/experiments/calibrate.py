#!/usr/bin/env python3
"""Apparent modulus of center-based cells that are pressed as deformable ones are.

    ./calibrate.py [--level 3] [--E 1] [--out FOLDER] [-var steps 8 ...]

Runs in.calibrate with deformable cells and fits a1 to a4 to the pressure over the distance of the
cells by least squares; E_contact is that of type `red` or what --E says. Writes them to
FOLDER/calibrated.dcm, runs in.calibrate again with center-based cells of that file, and says how
far they are from the deformable ones, and those without a1 to a4. The run with deformable cells is
not repeated if its log is there: other -var need another folder.
LAMMPS is `--lmp`, else the environment variable DCM_LMP, else `lmp`; it needs LAMMPS_PLUGIN_PATH
and LAMMPS_POTENTIALS, as for any deck.
"""

import argparse
import math
import os
import re
import shutil
import subprocess
import sys
from datetime import date
from pathlib import Path

import numpy as np
from scipy.optimize import brentq, least_squares

HERE = Path(__file__).resolve().parent
INPUTS = ("in.calibrate", "start.lmp", "experiments.dcm")


def run(lmp, out, name, options):
    """Distances (um) and pressures (kPa) of a run of in.calibrate in the folder `out`."""
    log = out / f"log.{name}"
    if not log.exists():
        words = [lmp, "-in", "in.calibrate", "-nocite", "-log", "log.part", "-var", "image", "no"]
        for key, value in options.items():
            words += ["-var", key, str(value)]
        done = subprocess.run(words, cwd=out, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit("\n".join([" ".join(words), *done.stdout.splitlines()[-5:]]))
        (out / "log.part").rename(log)
    found = re.findall(r"^distance ([\d.]+) um: pressure (\S+) kPa", log.read_text(), re.MULTILINE)
    return np.array(found, dtype=float).T


def sphere_pressure(d, R, nu, W, E, a=()):
    """Pressure of spheres in the closest packing: JKR, with the apparent modulus E + sum a_k s^k.

    The radius c of the contact is the larger root of delta = c^2/R' - sqrt(2 pi W c/E'), R' = R/2.
    """
    s = max(0.0, 1 - d / (2 * R))
    modulus = (E + sum(a_k * s ** (k + 1) for k, a_k in enumerate(a))) / (2 * (1 - nu**2))
    half = R / 2
    lowest = (half / 4 * math.sqrt(2 * math.pi * W / modulus)) ** (2 / 3)

    def delta(c):
        return c**2 / half - math.sqrt(2 * math.pi * W * c / modulus)

    if 2 * R - d <= delta(lowest):
        return 0.0  # has come apart
    c = brentq(lambda c: delta(c) - (2 * R - d), lowest, 2 * R)
    force = 4 * modulus * c**3 / (3 * half) - math.sqrt(8 * math.pi * W * modulus * c**3)
    return 2 * math.sqrt(2) * force / d**2


def fit(d, pressure, R, nu, W, E):
    """a1 to a4, none below zero, so that the modulus grows with the compression; the misfit.

    Unknowns are scaled to the modulus that each one adds at the smallest distance.
    """
    powers = (1 - d.min() / (2 * R)) ** np.arange(1, 5)

    def misfit(x):
        return [sphere_pressure(one, R, nu, W, E, x / powers) for one in d] - pressure

    found = least_squares(misfit, np.ones(4), bounds=(0, np.inf))
    return found.x / powers, np.sqrt(np.mean(found.fun**2))


def value(text, celltype, keyword):
    """A value of a cell type in the text of a parameter file."""
    block = re.search(rf"^celltype {celltype}\b(.*?)(?=^\S|\Z)", text, re.MULTILINE | re.DOTALL)
    return float(re.search(rf"^\s+{keyword}\s+(\S+)", block[1], re.MULTILINE)[1])


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lmp", default=os.environ.get("DCM_LMP", "lmp"))
    parser.add_argument("--level", type=int, default=2, help="icosphere of the deformable cells")
    parser.add_argument("--E", type=float, help="E_contact of the center-based cells, kPa")
    parser.add_argument("--out", type=Path, default=Path("calibrate"), help="folder of the runs")
    parser.add_argument("-var", nargs=2, action="append", default=[], metavar=("NAME", "VALUE"))
    args = parser.parse_args()

    args.out.mkdir(parents=True, exist_ok=True)
    for name in INPUTS:
        shutil.copy(HERE / name, args.out)
    options = dict(args.var)
    R = float(options.get("R", 6.0))
    text = (args.out / "experiments.dcm").read_text()
    nu = value(text, "red", "nu_contact")
    W = float(re.search(r"^adhesion red\s+red\s+(\S+)", text, re.MULTILINE)[1])

    d, pressure = run(args.lmp, args.out, f"dcm{args.level}", {**options, "level": args.level})
    E = args.E or value(text, "red", "E_contact")
    a, rms = fit(d, pressure, R, nu, W, E)
    lines = [
        f"# DATE: {date.today()} UNITS: um nN s CONTRIBUTOR: LAMMPS-DCM",
        "#",
        "# Written by examples/experiments/calibrate.py: center-based cells that are pressed as the",
        f"# deformable type `cell` of experiments.dcm, icosphere {args.level}, of radius {R} um,",
        f"# distances from {d.max()} to {d.min()} um; root mean square of the misfit {rms:.2e} kPa.",
        "",
        "celltype fitted",
        f"  E_contact             {E:.6g}",
        *(f"  a{k}                    {a_k:.6g}" for k, a_k in enumerate(a, 1)),
        *(
            f"  {key:<21} {value(text, 'red', key):g}"
            for key in ("nu_contact", "friction_normal", "friction_tangential", "friction_ecm", "D")
        ),
        "",
        f"adhesion fitted fitted {W:g}",
    ]
    (args.out / "calibrated.dcm").write_text("\n".join(lines) + "\n")

    for name in ("cbm", "fitted"):
        (args.out / f"log.{name}").unlink(missing_ok=True)
    _, before = run(args.lmp, args.out, "cbm", {**options, "kind": "cbm"})
    new = {"kind": "cbm", "parameters": "calibrated.dcm", "sphere": "fitted"}
    _, after = run(args.lmp, args.out, "fitted", {**options, **new})
    print("distance  deformable  spheres before  fitted spheres  (um, kPa)")
    for row in zip(d, pressure, before, after, strict=True):
        print("{:8.4f}  {:10.5f}  {:14.5f}  {:14.5f}".format(*row))
    print(f"E_contact {E:.4g} kPa, a1 to a4", *(f"{a_k:.4g}" for a_k in a))
    scale = np.ptp(pressure)
    for name, curve in (("before", before), ("fitted", after)):
        off = np.sqrt(np.mean((curve - pressure) ** 2))
        print(f"{name}: root mean square {off:.5f} kPa, {100 * off / scale:.2f} % of the range")
    print(f"written: {args.out / 'calibrated.dcm'}")


if __name__ == "__main__":
    main()
