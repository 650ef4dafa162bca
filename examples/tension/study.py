#!/usr/bin/env python3
"""Contact angle of two cells of constant surface tension over work of adhesion and mesh.

Runs in.tension for every combination, prints a line for each and writes tension_study.csv.
tools/python examples/tension/study.py needs nothing else. Else LAMMPS is `--lmp`, else the
environment variable DCM_LMP, else `lmp`; it needs LAMMPS_PLUGIN_PATH, as for any deck of the
package.

    ./study.py                                         162 and 642 nodes, law dmt
    ./study.py --law maugis --levels 2 --set h0=0.2    any variable of the deck
"""

import argparse
import csv
import itertools
import os
import re
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
NUMBER = r"(-?[\d.]+(?:e[-+]?\d+)?)"
PRINTED = {
    "pressure": f"pressure {NUMBER} kPa",
    "radius": f"contact radius {NUMBER} um",
    "expected": f"Young and Dupre: +{NUMBER}",
    "by_shape": f"length and volume: +{NUMBER}",
    "by_area": f"area in contact: +{NUMBER}",
}
COLUMNS = ["law", "nodes", "w", "seed", "settings", *PRINTED, "note"]


def run(args, level, w, seed):
    settings = dict(law=args.law, level=level, w=w, seed=seed)
    settings.update(one.split("=", 1) for one in args.set)
    command = [args.lmp, "-in", str(HERE / "in.tension"), "-log", "none",
               "-var", "image", "no"]
    for name, value in settings.items():
        command += ["-var", name, str(value)]
    with tempfile.TemporaryDirectory() as folder:
        text = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    row = dict(law=args.law, nodes=10 * 4**level + 2, w=w, seed=seed, settings=" ".join(args.set))
    for name, pattern in PRINTED.items():
        found = re.findall(pattern, text.stdout)
        row[name] = found[-1] if found else ""
    error = re.search(r"ERROR.*?: (.*)", text.stdout)
    row["note"] = error.group(1)[:80] if error else ""
    return row


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lmp", default=os.environ.get("DCM_LMP", "lmp"))
    parser.add_argument("--law", default="dmt")
    parser.add_argument("--levels", type=int, nargs="+", default=[2, 3])
    parser.add_argument("--w", type=float, nargs="+", default=[0.2, 0.4, 0.6, 0.8, 1.0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[3])
    parser.add_argument("--set", nargs="*", default=[], metavar="VARIABLE=VALUE")
    parser.add_argument("--out", type=Path, default=HERE / "tension_study.csv")
    args = parser.parse_args()
    with args.out.open("w", newline="") as out:
        writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for level, w, seed in itertools.product(args.levels, args.w, args.seeds):
            row = run(args, level, w, seed)
            print({k: v for k, v in row.items() if v}, flush=True)
            writer.writerow(row)
            out.flush()


if __name__ == "__main__":
    main()
