#!/usr/bin/env python3
"""The runs and the figures of the manual page doc/experiments.rst.

    tools/python examples/experiments/study.py
                                all runs (10 minutes), a table of what they print, experiments.png,
                                experiments_cells.png
    ... --report                only table and figures, from the logs and pictures there are

Further studies of decks have scripts of their own: calibrate.py fits what in.calibrate measures,
tissue.py --study compares what in.import makes with the tissue.

It can be stopped at any time and called again: runs whose log is complete are not repeated.
tools/python examples/experiments/study.py needs nothing else. Else LAMMPS is `--lmp`, else the
environment variable DCM_LMP, else `lmp`; it needs LAMMPS_PLUGIN_PATH and LAMMPS_POTENTIALS, as for
any deck, and the folder tools in PYTHONPATH.
"""

import argparse
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from lammps_dcm.log import read_log

HERE = Path(__file__).resolve().parent
INDENTS = [
    {"rest": r, "level": n, "by": 0.02, "steps": 3} for r in (1.0, 0.95) for n in (2, 3, 4, 5)
]
RUNS = [
    ("shock", {}),
    ("shock", {"shock": 0.8}),
    ("indent", {}),
    *[("indent", options) for options in INDENTS],
    *[("stretch", options) for options in ({}, {"level": 2}, {"level": 4})],
    *[("contract", options) for options in ({}, {"level": 2}, {"level": 4})],
    *[("aspirate", options) for options in ({}, {"level": 2}, {"level": 4})],
    *[("sorting", options) for options in ({}, {"seed": 2}, {"seed": 3})],
    *[("sorting", {"W": 0.05, "seed": seed}) for seed in (1, 2, 3)],
    ("compress", {}),
    ("compress", {"level": 3}),
    *[("spread", {"W": W}) for W in (0.02, 0.04, 0.08)],
    *[("spread", {"W": W, "level": 2}) for W in (0.02, 0.04, 0.08, 0.12)],
    *[("spread", {"friction": friction}) for friction in (0.5, 50)],
    *[("chemotaxis", options) for options in ({}, {"profile": "exponential"})],
    ("chemotaxis", {"kind": "dcm", "n": 16, "hours": 4}),
    *[("calibrate", {"kind": kind}) for kind in ("dcm", "cbm")],
    *[("rheometer", {"rate": rate}) for rate in (1e-4, 1e-3, 1e-2)],
    ("import", {}),
]
SAYS = (
    "depth", "strain", "recoil", "suction", "at 1.2", "contracted", "let go", "shocked", "the other",
    "demixing", "spread", "theory", "crawled", "distance", "after",
)  # fmt: skip


def log_of(out, deck, options):
    return out / ("log." + "_".join([deck, *(f"{k}{v}" for k, v in options.items())]))


def run(lmp, out, deck, options):
    """One deck, in the folder `out`; pictures are those of decks without options."""
    words = [lmp, "-in", f"in.{deck}", "-nocite", "-log", "log.part"]
    for name, value in ({"image": "no", **options} if options else {}).items():
        words += ["-var", name, str(value)]
    done = subprocess.run(words, cwd=out, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit("\n".join([" ".join(words), *done.stdout.splitlines()[-5:]]))
    (out / "log.part").rename(log_of(out, deck, options))


def swelling(shock, t, R=6.0, rest=0.95, ks=2.887, gamma=4.0, ecm=1.0, KV=2.5):
    """Volume of an evenly swelling cell over that before the shock; see doc/experiments.rst."""

    def rate(_, s):
        root = 2 * math.sqrt(3)  # sum of the squared edges over the area
        pull = -KV * np.log(s**3 / shock) * s**2 * R - root * ks * (s - rest)
        return pull / (root * gamma + ecm * s**2 * R**2)

    return solve_ivp(rate, (0, t[-1]), [1.0], t_eval=t, rtol=1e-8).y[0] ** 3


def draw(out, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(2, 4, figsize=(17, 7.5), constrained_layout=True)
    ((press, relax, indent, aspirate), (shock, stretch, contract, sorting)) = axes
    for options, style in (({}, "o:"), ({"level": 3}, "s-")):
        log = read_log(log_of(out, "compress", options))
        label = "642 nodes a cell" if options else "162 nodes a cell"
        ends = np.flatnonzero(np.append(np.diff(log["strain"]) > 0, True))
        press.plot(log["strain"][ends], log["force"][ends], style, color="tab:blue", label=label)
        press.plot(log["strain"][ends], log["elastic"][ends], style, color="tab:orange", ms=3)
        since = log["Time"] - log["Time"][0]
        relax.semilogy(since[since > 0], log["force"][since > 0], style[1:], color="tab:blue")
    press.set(title="compress", xlabel="strain", ylabel="force, its elastic part (nN)")
    relax.set(title="compress", xlabel="time (s)", ylabel="force (nN)", ylim=(0.2, 50))
    for rest, color, label in ((1.0, "tab:green", "slack"), (0.95, "tab:red", "under tension")):
        points = []
        for options in INDENTS:
            if options["rest"] == rest:
                text = log_of(out, "indent", options).read_text()
                found = re.search(r"^depth.* stiffness ([\d.]+).* has ([\d.]+)", text, re.M)
                stiffness, theory = found.groups()
                points.append(
                    (1.82 * 2.0 ** (2 - options["level"]), float(stiffness) / float(theory))
                )
        indent.plot(*zip(*points, strict=True), "o-", color=color, label=label)
    indent.set(
        title="indent", xlabel="edge (um)", ylabel="stiffness / that of a shell", xlim=(0, 2)
    )
    indent.axhline(1.0, color="k", lw=0.8)
    for level, style in ((2, "v:"), (3, "o-"), (4, "s-")):
        text = log_of(out, "aspirate", {"level": level} if level != 3 else {}).read_text()
        found = re.findall(r"^suction ([\d.]+).* length ([\d.]+).* has ([\d.]+)", text, re.M)
        pull, length, theory = np.array(found, dtype=float).T
        aspirate.plot(pull, length, style, ms=4, label=f"{10 * 4**level + 2} nodes")
    aspirate.plot(pull, theory, "k-", lw=0.8)
    aspirate.set(title="aspirate", xlabel="suction (kPa)", ylabel="length in the pipette (um)")
    for s, color in ((0.8, "tab:purple"), (1.3, "tab:brown")):
        log = read_log(log_of(out, "shock", {"shock": s} if s < 1 else {}))
        t = log["Time"]
        shock.plot(t, log["volume"], "o", ms=3, color=color, label=f"V0 times {s}")
        shock.plot(t, log["volume"][0] * swelling(s, t), "k-", lw=0.8)
    shock.set(title="shock", xlabel="time (s)", ylabel="volume (um^3)", xlim=(0, 12))
    log = read_log(log_of(out, "stretch", {}))
    R, T, sigma = log["radius"][-1], 0.2, 0.01
    t = log["Time"] - 20
    final, tau = sigma * R / (6 * T), R**2 / (4 * T)
    e = final * np.where(
        t < 200, 1 - np.exp(-t / tau), (1 - np.exp(-200 / tau)) * np.exp((200 - t) / tau)
    )
    stretch.plot(t, (log["ratio"] - 1) / (1 + log["ratio"] / 2), "o", ms=3, label="642 nodes")
    stretch.plot(t[t > 0], e[t > 0], "k-", lw=0.8)
    stretch.set(title="stretch", xlabel="time (s)", ylabel="strain", xlim=(0, 360))
    log = read_log(log_of(out, "contract", {}))
    before = np.flatnonzero(log["Time"] >= 100)[0]
    for name, label in (
        ("apical", "apical area"), ("height", "height"), ("factor", "factor on rest lengths")
    ):  # fmt: skip
        contract.plot(log["Time"], log[name] / log[name][before], lw=1.2, label=label)
    contract.set(title="contract", xlabel="time (s)", ylabel="over that before", xlim=(60, 420))
    for deck, options in RUNS:
        if deck == "sorting":
            log = read_log(log_of(out, deck, options))
            seed = options.get("seed", 1)
            color, label = ("gray", "one W") if "W" in options else (f"C{seed}", f"seed {seed}")
            sorting.plot(log["hour"], log["index"], color=color, lw=1, label=label)
    sorting.set(title="sorting", xlabel="time (h)", ylabel="demixing index", ylim=(-0.3, 1))
    for ax in axes.flat:
        ax.grid(alpha=0.3)
        if ax.get_legend_handles_labels()[0]:
            ax.legend(fontsize=7)
    fig.savefig(path, dpi=80)


PICTURES = (
    "compress", "indent", "stretch", "aspirate", "contract", "sorting.start", "sorting.end"
)  # fmt: skip


def draw_cells(out, path):
    """What the decks without options have drawn, side by side, without the empty margin."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(1, len(PICTURES), figsize=(2.1 * len(PICTURES), 2.1))
    for ax, name in zip(axes, PICTURES, strict=True):
        image = plt.imread(out / f"{name}.png")
        m = image.shape[0] // 8
        ax.imshow(image[m:-m, m:-m])
        ax.axis("off")
    fig.tight_layout(pad=0.2)
    fig.savefig(path, dpi=100)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lmp", default=os.environ.get("DCM_LMP", "lmp"))
    parser.add_argument("--report", action="store_true", help="no runs")
    parser.add_argument(
        "--out", type=Path, default=Path("experiments_study"), help="folder of the runs"
    )
    args = parser.parse_args()

    logs = [log_of(args.out, deck, options) for deck, options in RUNS]
    missing = [log for log in logs if not log.exists()]
    if args.report and missing:
        sys.exit(f"{args.out}: {len(missing)} of {len(RUNS)} runs are missing, such as "
                 f"{missing[0].name}: call this without --report first")
    args.out.mkdir(parents=True, exist_ok=True)
    for path in HERE.iterdir():
        if path.is_file() and path.suffix != ".py":
            shutil.copy(path, args.out)
    shutil.copytree(HERE / "tissue", args.out / "tissue", dirs_exist_ok=True)
    for n, (deck, options) in enumerate(RUNS, 1):
        text = " ".join(f"{k} {v}" for k, v in options.items())
        if not args.report and not log_of(args.out, deck, options).exists():
            print(f"run {n} of {len(RUNS)}: {deck} {text}", flush=True)
            run(args.lmp, args.out, deck, options)
    for deck, options in RUNS:
        log = log_of(args.out, deck, options)
        print(f"\n{log.name}")
        print(*[line for line in log.read_text().splitlines() if line.startswith(SAYS)], sep="\n")
    draw(args.out, args.out / "experiments.png")
    draw_cells(args.out, args.out / "experiments_cells.png")


if __name__ == "__main__":
    main()
