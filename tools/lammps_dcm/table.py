"""`cells`: table of volume, area and pressure of every cell and frame, as CSV."""
import sys

import numpy as np


def write_columns(path, columns):
    """Write a dict of equally long columns as CSV; path None: to the screen."""
    names = list(columns)
    rows = zip(*columns.values())
    text = "\n".join([",".join(names)] + [",".join(f"{v:.10g}" for v in row) for row in rows])
    if path is None:
        print(text)
        return
    with open(path, "w", encoding="ascii") as handle:
        handle.write(text + "\n")


def add_arguments(parser):
    """Options of `cells`."""
    from .render import add_input

    add_input(parser)
    parser.add_argument("-o", "--output", help="CSV file; by default the screen")


def run(args, words):
    """Write the table the command line asks for."""
    from . import CellPressure, CellVolume, load
    from .render import bulk_modulus_of, pairs

    universe = load(args.data, args.dump, rename=pairs(args.rename, "--rename"))
    modulus = bulk_modulus_of(args.bulk_modulus)
    analysis = CellVolume(universe) if modulus is None else CellPressure(universe, modulus)
    results = analysis.run(verbose=sys.stderr.isatty()).results
    shape = results.volume.shape
    columns = {"step": np.repeat(results.steps, shape[1]),
               "cell": np.tile(results.cells, shape[0])}
    for name in ("volume", "area", "pressure"):
        if name in results:
            columns[name] = results[name].ravel()
    write_columns(args.output, columns)
    if args.output:
        print(f"wrote {args.output}: {shape[0]} frames of {shape[1]} cells")
