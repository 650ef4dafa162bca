"""`quality`: how good the triangles of every cell are, as CSV."""
import sys

import numpy as np

from .table import write_columns


def add_arguments(parser):
    """Options of `quality`."""
    from .render import add_input

    parser.epilog = ("Quality of a triangle: 4 sqrt(3) area / (sum of squared edges), 1 for an "
                     "equilateral one, 0 for one without area. Columns: step, cell, worst and "
                     "median quality, atom ID of the worst face.")
    add_input(parser, pressures=False)
    parser.add_argument("--frame", default="-1", help="number from 0, from the end if negative, "
                        "or all (default: %(default)s)")
    parser.add_argument("-o", "--output", help="CSV file; by default the screen")


def run(args, words):
    """Write the table the command line asks for."""
    from . import CellQuality, load
    from .render import chosen_frames, pairs

    universe = load(args.data, args.dump, rename=pairs(args.rename, "--rename"))
    frames = list(chosen_frames(args.frame, len(universe.trajectory)))
    results = CellQuality(universe).run(frames=frames, verbose=sys.stderr.isatty()).results
    shape = results.worst.shape
    columns = {"step": np.repeat(results.steps, shape[1]), "cell": np.tile(results.cells, shape[0])}
    columns |= {name: results[name].ravel() for name in ("worst", "median", "worst_face")}
    write_columns(args.output, columns)
    if args.output:
        known = np.where(np.isnan(results.worst), np.inf, results.worst)
        print(f"wrote {args.output}: {shape[0]} frames of {shape[1]} cells, the worst "
              f"{known.min():.3g}")
