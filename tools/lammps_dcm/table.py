"""`cells`: table of volume, area and pressure of every cell and frame, as CSV."""
import sys

import numpy as np

from .inputs import add_input, bulk_modulus_of, load_run
from .text import write_text


def write_columns(path, columns):
    """Write a dict of equally long columns as CSV; path None: to the screen."""
    names = list(columns)
    rows = zip(*columns.values())
    text = "\n".join([",".join(names)] + [",".join(f"{v:.10g}" for v in row) for row in rows])
    if path is None:
        print(text)
        return
    write_text(path, text + "\n")


def cell_columns(results, names):
    """Columns for write_columns: step, cell and those of `names` that an analysis has, with a row
    for every cell in every frame that has it."""
    frame, cell = np.nonzero(results.present)
    columns = {"step": results.steps[frame], "cell": results.cells[cell]}
    return columns | {name: results[name][frame, cell] for name in names if name in results}


def add_arguments(parser):
    """Options of `cells`."""
    parser.epilog = ("A row per deformable cell of a frame. Cells are told apart by the column mol "
                     "of the dump, since division gives atom IDs to other cells.")
    add_input(parser)
    parser.add_argument("-o", "--output", help="CSV file; by default the screen")


def run(args, words):
    """Write the table the command line asks for."""
    from . import CellPressure, CellVolume

    universe = load_run(args, "all")
    modulus = bulk_modulus_of(args.bulk_modulus)
    analysis = CellVolume(universe) if modulus is None else CellPressure(universe, modulus)
    results = analysis.run(verbose=sys.stderr.isatty()).results
    write_columns(args.output, cell_columns(results, ("volume", "area", "pressure")))
    if args.output:
        frames, cells = results.present.shape
        print(f"wrote {args.output}: {results.present.sum()} rows, {cells} cells in {frames} "
              "frames")
