#!/usr/bin/env python3
"""Contact laws against what they should do: a table, a plot, and the same runs again on request.

    ./study.py                       all parts, both laws, 162 and 642 nodes
    ./study.py --parts angle fill    some of them
    ./study.py --quick               162 nodes only, one orientation
    ./study.py --report              only the table and plot of what there is

Parts, each a deck run with `scheme implicit`:

    doublet   contact radius at rest of two cells over orientations of their meshes
    angle     contact angle of two cells of constant surface tension against Young and Dupre
    fill      volumes of the cells in a shrinking periodic cube, in units of the cube, over pressure
    pull      pull-off force and work of adhesion
    border    a deformable cell between two center-based ones: force on its faces, areas
    plates    one cell between plates: force over height, on meshes of three sizes

It can be stopped at any time and called again: what contact_study.csv holds is not repeated.
tools/python examples/contact/study.py needs nothing else. Else LAMMPS is `--lmp`, else the
environment variable DCM_LMP, else `lmp`; it needs LAMMPS_PLUGIN_PATH and LAMMPS_POTENTIALS, as for
any deck of the package. Units: um, nN, s, kPa.
"""

import argparse
import csv
import math
import os
import re
import statistics
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
NUMBER = r"(-?[\d.]+(?:e[-+]?\d+)?)"
FIELDS = ["part", "law", "layer", "nodes", "settings", "name", "value"]
LAWS = ["dmt", "foundation"]
AUTO = "implicit tolerance 1e-3 dt auto tol {tol} max 20 stop {stop}"
PRESSURES = [0.3, 0.6, 1.0, 2.0, 5.0]  # at which `fill` is read, kPa


def plan(args):
    """(part, law, layer, level, settings of the deck) of every run."""
    fine = [2] if args.quick else [2, 3]
    for law in args.laws:
        for level in fine:
            turned = [(3, 11)] if args.quick else [(3, 11), (5, 7), (13, 17), (23, 29)]
            for seed, other in turned[: 2 if level == 3 else None]:
                yield "doublet", law, "", level, dict(seed=seed, other=other)
            for w in (0.2, 0.4, 0.6, 0.8, 1.0) if level == 2 else (0.2, 0.6, 1.0):
                yield "angle", law, "", level, dict(w=w, seed=3)
            for seed in [] if args.quick else [5] if level == 3 else [5, 7, 11, 13]:
                yield "angle", law, "", level, dict(w=0.6, seed=seed)
        layers = [""] if law != "foundation" else ["0.25", "0.1", "0.025"]
        for layer in layers:
            yield "fill", law, layer, 2, dict(n=2, KV=25)
            if not args.quick:
                yield "fill", law, layer, 1, dict(n=3, KV=25)
        for seed in (3, 11):
            yield "pull", law, "", 2, dict(seed=seed)
        for force in (1.0, 5.0):
            yield "border", law, "", 2, dict(force=force)
        for level in [2, 3] if args.quick else [2, 3, 4]:
            yield "plates", law, "", level, {}


DECKS = {
    "doublet": "../doublet/in.doublet",
    "pull": "../doublet/in.doublet",
    "angle": "../tension/in.tension",
    "fill": "in.fill",
    "border": "in.border",
    "plates": "in.plates",
}


def command(args, part, law, layer, level, settings):
    values = dict(law=law, level=level, **settings)
    if layer:
        values["layer"] = layer
    if part == "doublet":
        values.update(image="no", longest=0, settle=4000, dt=0.5,
                      scheme=AUTO.format(tol=0.1, stop=2000))  # fmt: skip
    elif part == "pull":
        values.update(image="no", scheme="implicit")
    elif part == "angle":
        values.update(scheme=AUTO.format(tol=0.02, stop=2500), settle=5000)
    words = [args.lmp, "-in", str(HERE / DECKS[part]), "-log", "log", "-nocite",
             "-var", "image", "no"]
    for name, value in values.items():
        words += ["-var", name, str(value)]
    return words


def thermo(text):
    """Rows of numbers of the thermo output, all runs one after the other."""
    rows = []
    for line in text.splitlines():
        words = line.split()
        if len(words) > 3 and re.fullmatch(r"\d+", words[0]):
            try:
                rows.append([float(word) for word in words])
            except ValueError:
                continue
    return rows


def at(rows, pressure):
    """filled where the pressure is first reached, between two rows (step time filled p overlap)."""
    for a, b in zip(rows, rows[1:], strict=False):
        if a[3] < pressure <= b[3]:
            return a[2] + (b[2] - a[2]) * (pressure - a[3]) / (b[3] - a[3])
    return None


def read(part, text):
    """name -> value of a finished run; note: how it ended if not as it should."""
    found = {}

    def pick(pattern, *names):
        match = re.search(pattern, text)
        if match:
            found.update(zip(names, map(float, match.groups()), strict=True))

    rows = thermo(text)
    if part == "doublet" and rows:
        found.update(distance=rows[-1][3], area=rows[-1][4], radius=rows[-1][5], time=rows[-1][1])
    elif part == "pull":
        pick(rf"load at separation: {NUMBER} nN, {NUMBER}", "pull_off", "load")
        pick(rf"area at rest: +{NUMBER}", "adhesion")
    elif part == "angle":
        pick(rf"Young and Dupre: +{NUMBER}", "expected")
        pick(rf"length and volume: +{NUMBER}", "by_shape")
        pick(rf"area in contact: +{NUMBER}", "by_area")
    elif part == "fill":
        rows = [row for row in rows if len(row) == 5]
        for pressure in PRESSURES:
            value = at(rows, pressure)
            if value is not None:
                found[f"at {pressure:g}"] = value
        if rows:
            found.update(most=max(row[2] for row in rows), pressure=max(row[3] for row in rows))
    elif part == "border":
        pick(rf"force {NUMBER} nN: on the faces {NUMBER}", "force", "on_faces")
        pick(rf"area in contact: cell {NUMBER}, sphere {NUMBER}", "area_cell", "area_sphere")
        pick(rf"centers {NUMBER}", "distance")
    elif part == "plates":
        for height, force in re.findall(rf"height {NUMBER} um: force {NUMBER} nN", text):
            found[f"at {float(height):g}"] = float(force)
    error = re.search(r"ERROR.*?: (.*)", text)
    if error and "still stick" not in text:
        found["note"] = error.group(1)[:90]
    return found


def run(args, part, law, layer, level, settings):
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        result = subprocess.run(command(args, part, law, layer, level, settings), cwd=folder,
                                capture_output=True, text=True, check=False)  # fmt: skip
        text = log.read_text() if log.exists() else result.stdout
    found = read(part, text)
    print(part, law, layer, 10 * 4**level + 2, settings,
          {k: round(v, 5) if isinstance(v, float) else v for k, v in found.items()}, flush=True)
    key = dict(part=part, law=law, layer=layer, nodes=10 * 4**level + 2,
               settings=" ".join(f"{k}={v}" for k, v in settings.items()))  # fmt: skip
    return [dict(key, name=name, value=value) for name, value in (found or {"note": "-"}).items()]


# ---- report


def runs_of(rows, part):
    """(law, layer, nodes) -> list of (settings, name -> value)."""
    found = {}
    for row in rows:
        if row["part"] != part:
            continue
        key = (row["law"], row["layer"], int(row["nodes"]))
        value = row["value"] if row["name"] == "note" else float(row["value"])
        found.setdefault(key, {}).setdefault(row["settings"], {})[row["name"]] = value
    return found


def spread(values):
    mean = statistics.fmean(values)
    return mean, (max(values) - min(values)) / mean if len(values) > 1 else 0.0


def report(rows):
    lines = []
    for key, runs in sorted(runs_of(rows, "doublet").items()):
        radius = [r["radius"] for r in runs.values() if "radius" in r]
        if radius:
            mean, scatter = spread(radius)
            lines.append(f"doublet {key[0]:10s} {key[2]:4d} nodes: radius {mean:.3f} um, largest less "
                         f"smallest {100 * scatter:.1f} % of {len(radius)} orientations")  # fmt: skip
    for key, runs in sorted(runs_of(rows, "angle").items()):
        at06 = []
        for settings, r in sorted(runs.items()):
            if "expected" not in r:
                lines.append(f"angle   {key[0]:10s} {key[2]:4d} nodes {settings}: {r.get('note')}")
                continue
            if "w=0.6" in settings:
                at06.append(r["by_shape"])
            if "seed=3" in settings:
                off = [100 * (r[n] / r["expected"] - 1) for n in ("by_shape", "by_area")]
                lines.append(f"angle   {key[0]:10s} {key[2]:4d} nodes {settings:13s}: expected "
                             f"{r['expected']:.1f}, shape {r['by_shape']:.1f} ({off[0]:+.0f} %), area "
                             f"{r['by_area']:.1f} ({off[1]:+.0f} %)")  # fmt: skip
        if len(at06) > 1:
            mean, scatter = spread(at06)
            lines.append(f"angle   {key[0]:10s} {key[2]:4d} nodes w=0.6: {mean:.2f} degrees, largest "
                         f"less smallest {100 * scatter:.1f} % of {len(at06)}")  # fmt: skip
    for key, runs in sorted(runs_of(rows, "fill").items()):
        for settings, r in runs.items():
            text = ", ".join(f"{v:.3f} {k} kPa" for k, v in r.items() if k.startswith("at"))
            note = f"; ended: {r['note']}" if "note" in r else ""
            lines.append(f"fill    {key[0]:10s} layer {key[1] or '-':5s} {key[2]:4d} nodes {settings}: "
                         f"{text}; most {r['most']:.3f}, up to {r['pressure']:.2f} kPa{note}")  # fmt: skip
    for part in ("pull", "border", "plates"):
        for key, runs in sorted(runs_of(rows, part).items()):
            for settings, r in runs.items():
                values = ", ".join(f"{k} {v:.4f}" if k != "note" else v for k, v in r.items())
                lines.append(f"{part:7s} {key[0]:10s} {key[2]:4d} nodes {settings}: {values}")
    return "\n".join(lines)


def draw(rows, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(1, 3, figsize=(13, 4.2), constrained_layout=True)
    color = {"dmt": "tab:blue", "foundation": "tab:red"}
    for key, runs in sorted(runs_of(rows, "angle").items()):
        points = sorted((float(re.search(r"w=([\d.]+)", s).group(1)), r["by_shape"])
                        for s, r in runs.items() if "by_shape" in r)  # fmt: skip
        axes[0].plot(*zip(*points, strict=True), "o" if key[2] == 162 else "s", color=color[key[0]],
                     mfc="none" if key[2] == 162 else None, label=f"{key[0]}, {key[2]} nodes")
    w = [0.01 * k for k in range(1, 111)]
    axes[0].plot(w, [math.degrees(math.acos(1 - 0.5 * v)) for v in w], "k-", lw=0.8)
    axes[0].set(xlabel="W/T", ylabel="contact angle (degrees)")
    dash = {"": "-", "0.25": "-", "0.1": "--", "0.025": ":"}
    for key, runs in sorted(runs_of(rows, "fill").items()):
        for settings, r in runs.items():
            points = sorted((float(k[3:]), v) for k, v in r.items() if k.startswith("at "))
            if points and "n=2" in settings:
                axes[1].plot(*zip(*points, strict=True), "o" + dash[key[1]], color=color[key[0]],
                             label=f"{key[0]} {key[1]}")  # fmt: skip
    axes[1].axhline(1.0, color="k", lw=0.8)
    axes[1].set(xlabel="pressure (kPa)", ylabel="volumes of the cells / cube", xscale="log")
    axes[1].set_xticks(PRESSURES, [f"{p:g}" for p in PRESSURES])
    axes[1].minorticks_off()
    for key, runs in sorted(runs_of(rows, "plates").items()):
        for r in runs.values():
            points = sorted((float(k[3:]), v) for k, v in r.items() if k.startswith("at "))
            if points:
                axes[2].plot(*zip(*points, strict=True), {162: ":", 642: "--"}.get(key[2], "-"),
                             color=color[key[0]], label=f"{key[0]}, {key[2]} nodes")  # fmt: skip
    axes[2].set(xlabel="height (um)", ylabel="force of the plates (nN)")
    for ax in axes:
        ax.legend(fontsize=7)
        ax.grid(alpha=0.3)
    fig.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lmp", default=os.environ.get("DCM_LMP", "lmp"))
    parser.add_argument("--parts", nargs="+", default=list(DECKS), choices=list(DECKS))
    parser.add_argument("--laws", nargs="+", default=LAWS)
    parser.add_argument("--quick", action="store_true", help="162 nodes, one orientation")
    parser.add_argument("--report", action="store_true", help="no runs")
    parser.add_argument("--out", type=Path, default=Path("contact_study"), help="csv and png")
    args = parser.parse_args()

    table = args.out.with_suffix(".csv")
    rows = list(csv.DictReader(table.open())) if table.exists() else []
    done = {tuple(str(row[k]) for k in FIELDS[:5]) for row in rows}
    todo = [] if args.report else [p for p in plan(args) if p[0] in args.parts]
    order = list(DECKS)
    for one in sorted(todo, key=lambda p: (p[3], order.index(p[0]))):
        part, law, layer, level, settings = one
        text = " ".join(f"{k}={v}" for k, v in settings.items())
        if (part, law, layer, str(10 * 4**level + 2), text) in done:
            continue
        rows += run(args, *one)
        with table.open("w", newline="") as out:
            writer = csv.DictWriter(out, FIELDS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    rows = list(csv.DictReader(table.open()))
    print(report(rows))
    draw(rows, args.out.with_suffix(".png"))


if __name__ == "__main__":
    main()
