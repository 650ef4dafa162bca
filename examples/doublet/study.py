#!/usr/bin/env python3
"""Doublet over contact law, mesh, range of adhesion h0 and orientation of the meshes.

The rest is approached from first touch and from a contact that was pressed: the two radii differ
where the mesh pins the contact line.

Runs in.doublet for every combination and writes doublet_study.csv (one line per run) and
doublet_study.png.  Units: um, nN, s.

Runs that the csv already holds are not repeated, so that several calls add up to one csv; the one
beside this file was merged from several calls and does not hold every combination.  A run is known
by law, nodes, h0, press and seed alone: use another --out for other values of the rest, or after
the default of h0 has changed.

    ./study.py                        162 and 642 nodes, both laws
    ./study.py --levels 2 3 4         2562 nodes as well: minutes a run, more if h0 is not resolved
    ./study.py --rest-only            without the pull

tools/python examples/doublet/study.py needs nothing else. Else LAMMPS is `--lmp`, else the
environment variable DCM_LMP, else `lmp`; it needs LAMMPS_PLUGIN_PATH and LAMMPS_POTENTIALS, as for
any deck of the package.
"""

import argparse
import csv
import itertools
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
KEYS = ["law", "nodes", "h0", "press", "seed"]
VALUES = ["h0_used", "edge", "area", "radius", "distance", "drift", "pull_off", "load", "work",
          "lost", "stored", "adhesion", "note"]
NUMBER = r"(-?[\d.]+(?:e[-+]?\d+)?)"


def read_log(text, end, settle, h0, pulled):
    """Results of one run from its log; what it does not contain stays empty."""
    found = {}

    def pick(pattern, *names):
        match = re.search(pattern, text)
        if match:
            found.update(zip(names, match.groups()))

    pick(rf"mean edge {NUMBER}", "edge")
    pick(rf"h0 {NUMBER}, range", "h0_used")
    if h0 != "default" and "auto" not in h0:
        found["h0_used"] = h0
    pick(rf"pull-off force, load at separation: {NUMBER} nN, {NUMBER}", "pull_off", "load")
    pick(rf"work of the pull: +{NUMBER}", "work")
    pick(rf"lost in friction, stored: +{NUMBER}, {NUMBER}", "lost", "stored")
    pick(rf"work of adhesion per area at rest: +{NUMBER}", "adhesion")
    rows = [line.split() for line in text.splitlines() if re.match(r"\s+\d+\s+\d", line)]
    rest = [row for row in rows if float(row[1]) <= end]
    if rest and float(rest[-1][1]) >= end:
        last = rest[-1]
        quarter = [row for row in rest if float(row[1]) <= end - 0.25 * settle][-1]
        found.update(distance=last[3], area=last[4], radius=last[5])
        # change of the radius over the last quarter of the time to come to rest
        found["drift"] = f"{float(last[5]) / float(quarter[5]) - 1.0:.4f}"
    error = re.search(r"ERROR: (.*)", text)
    if error:
        found["note"] = error.group(1)[:100]
    elif pulled and re.search(r"^The cells still stick", text, re.M):
        found["note"] = "not separated"
    return found


def run(args, law, level, h0, press, seed):
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        command = [args.lmp, "-in", str(HERE / "in.doublet"), "-screen", "none", "-log", str(log)]
        settings = dict(law=law, level=level, h0=h0, press=press, seed=seed, settle=args.settle,
                        rate=args.rate, dt=args.dt, friction=args.friction, image="no")
        if args.rest_only or press > 0.0:
            settings["longest"] = 0
        if h0 == "default":
            del settings["h0"]
        for name, value in settings.items():
            command += ["-var", name, str(value)]
        subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                       check=False)
        text = log.read_text() if log.exists() else ""
    row = dict(law=law, nodes=10 * 4**level + 2, h0=h0, press=press, seed=seed)
    end = args.settle * (2.5 if press > 0.0 else 1.0)
    row.update(read_log(text, end, args.settle, h0,
                        not args.rest_only and press == 0.0))
    return row


def draw(rows, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    from matplotlib.ticker import FixedLocator

    panels = [("radius", "contact radius at rest (um)"), ("load", "load at separation (nN)"),
              ("adhesion", "work of adhesion / area at rest (nN/um)")]
    fig, axes = plt.subplots(1, 3, figsize=(12, 4.6), constrained_layout=True)
    color = {"dmt": "tab:blue", "maugis": "tab:red"}
    marker = {"162": "o", "642": "s", "2562": "^"}
    for ax, (name, label) in zip(axes, panels):
        for law, nodes in sorted({(r["law"], str(r["nodes"])) for r in rows}):
            mine = [r for r in rows if (r["law"], str(r["nodes"])) == (law, nodes) and r.get(name)]
            up = sorted((float(r["h0_used"]), float(r[name])) for r in mine
                        if float(r["press"]) == 0.0)
            down = [(float(r["h0_used"]), float(r[name])) for r in mine if float(r["press"]) > 0.0]
            if up:
                x, y = np.array(up).T
                grid = np.unique(x)
                ax.plot(grid, [y[x == g].mean() for g in grid], color=color[law], lw=1,
                        ls={"162": "--", "642": "-"}.get(nodes, ":"))
                ax.plot(x, y, marker[nodes], color=color[law], ms=5,
                        mfc="none" if nodes == "162" else None, label=f"{law}, {nodes} nodes")
            if down and name == "radius":
                ax.plot(*np.array(down).T, "x" if nodes == "162" else "+", color=color[law],
                        ms=6, label=f"{law}, {nodes}, pressed before")
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(FixedLocator([0.02, 0.05, 0.1, 0.2, 0.4]))
        ax.xaxis.set_major_formatter("{x:g}")
        ax.xaxis.set_minor_locator(FixedLocator([]))
        ax.set_xlabel("range of adhesion h0 (um)")
        ax.set_ylabel(label)
        ax.grid(alpha=0.3)
    axes[2].axhline(0.1, color="k", lw=0.8)
    axes[2].set_ylim(0.05, 0.12)    # outside: the time step does not resolve the force
    fig.legend(*axes[0].get_legend_handles_labels(), fontsize=8, ncols=5,
               loc="outside lower center")
    fig.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lmp", default=os.environ.get("DCM_LMP", "lmp"))
    parser.add_argument("--laws", nargs="+", default=["dmt", "maugis"])
    parser.add_argument("--levels", nargs="+", type=int, default=[2, 3],
                        help="icosphere levels: 2, 3, 4 are 162, 642, 2562 nodes")
    parser.add_argument("--h0", nargs="+", default=["default", "0.02", "0.1", "0.2", "0.4"])
    parser.add_argument("--press", nargs="+", type=float, default=[0.0, 1.0],
                        help="0: rest from first touch; > 0: from a contact pressed with this "
                             "force (nN), not pulled")
    parser.add_argument("--seeds", nargs="+", type=int, default=[3, 11])
    parser.add_argument("--settle", type=float, default=2000.0, help="time to come to rest, s")
    parser.add_argument("--rate", type=float, default=1e-3, help="of the pulling force, nN/s")
    parser.add_argument("--friction", type=float, default=5.0, help="contact friction, nN s/um^3")
    parser.add_argument("--dt", type=float, default=1.0, help="time step, s")
    parser.add_argument("--jobs", type=int, default=1, help="runs at the same time")
    parser.add_argument("--rest-only", action="store_true", help="do not pull")
    parser.add_argument("--out", type=Path, default=Path("doublet_study"), help="csv and png")
    args = parser.parse_args()

    table = args.out.with_suffix(".csv")
    rows = list(csv.DictReader(table.open())) if table.exists() else []
    done = {tuple(r[k] for k in KEYS) for r in rows}
    todo = [c for c in itertools.product(args.laws, args.levels, args.h0, args.press,
                                            args.seeds)
            if (c[0], str(10 * 4 ** c[1] + 2), *map(str, c[2:])) not in done]
    with ThreadPoolExecutor(args.jobs) as pool:
        for row in pool.map(lambda c: run(args, *c), sorted(todo, key=lambda c: c[1])):
            rows.append(row)
            print({k: v for k, v in row.items() if v}, flush=True)
            with table.open("w", newline="") as out:
                writer = csv.DictWriter(out, KEYS + VALUES, restval="", lineterminator="\n")
                writer.writeheader()
                writer.writerows(rows)
    draw(rows, args.out.with_suffix(".png"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
