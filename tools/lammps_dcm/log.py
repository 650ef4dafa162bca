"""Curves of the thermo columns in a LAMMPS log file."""
from pathlib import Path

import numpy as np

from .table import write_columns


def read_log(path):
    """All thermo output of a log: dict of column -> array (rows,). Runs that print other columns
    than the last run are left out."""
    if not Path(path).exists():
        raise FileNotFoundError(f"no file {path}: LAMMPS writes log.lammps, or what -log names")
    runs, rows = [], None
    for line in Path(path).read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            rows = []
            runs.append((tuple(words), rows))
        elif line.startswith("Loop time"):
            rows = None
        elif rows is not None and len(words) == len(runs[-1][0]):
            try:
                rows.append([float(w) for w in words])
            except ValueError:
                continue    # a warning in between
    runs = [r for r in runs if r[1]]
    if not runs:
        raise ValueError(f"{path}: no thermo output whose first column is Step: is it a log file, "
                         "and does thermo_style begin with step?")
    names = runs[-1][0]
    return dict(zip(names, np.array([row for head, rows in runs if head == names
                                     for row in rows]).T))


def add_arguments(parser):
    """Options of `log`."""
    parser.add_argument("log", help="LAMMPS log file")
    parser.add_argument("--columns", nargs="+", help="columns to plot; by default all")
    parser.add_argument("--csv", help="write the columns to this file, too")
    parser.add_argument("-o", "--output", default="log.png", help="default: %(default)s")


def run(args, words):
    """Plot what the command line asks for, one panel a column."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    table = read_log(args.log)
    columns = args.columns or [c for c in table if c != "Step"]
    unknown = [c for c in columns if c not in table]
    if unknown:
        raise ValueError(f"no column {unknown[0]} in {args.log}; there are {' '.join(table)}")
    figure, panels = pyplot.subplots(len(columns), 1, sharex=True, squeeze=False,
                                     figsize=(7, 1 + 1.6 * len(columns)), layout="constrained")
    for panel, name in zip(panels[:, 0], columns):
        panel.plot(table["Step"], table[name], lw=1)
        panel.set_ylabel(name)
    panels[-1, 0].set_xlabel("step")
    figure.savefig(args.output, dpi=120)
    if args.csv:
        write_columns(args.csv, {"Step": table["Step"], **{c: table[c] for c in columns}})
    print(f"wrote {args.output}: {len(table['Step'])} rows of {' '.join(columns)}")
