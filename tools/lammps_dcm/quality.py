"""`quality`: how good the triangles of every cell are, as CSV."""
import sys

import numpy as np

from .inputs import add_input, chosen_frames, load_run
from .table import cell_columns, write_columns


def add_arguments(parser):
    """Options of `quality`."""
    parser.epilog = ("Quality of a triangle: 4 sqrt(3) area / (sum of squared edges), 1 for an "
                     "equilateral one, 0 for one without area. Columns: step, cell, worst and "
                     "median quality, atom ID of the worst face.")
    add_input(parser, pressures=False)
    parser.add_argument("--frame", default="-1", help="number from 0, from the end if negative, "
                        "or all (default: %(default)s)")
    parser.add_argument("-o", "--output", help="CSV file; by default the screen")


def run(args, words):
    """Write the table the command line asks for."""
    from . import CellQuality

    universe = load_run(args, args.frame)
    frames = list(chosen_frames(args.frame, len(universe.trajectory)))
    results = CellQuality(universe).run(frames=frames, verbose=sys.stderr.isatty()).results
    write_columns(args.output, cell_columns(results, ("worst", "median", "worst_face")))
    if args.output:
        known = np.where(np.isnan(results.worst), np.inf, results.worst)
        print(f"wrote {args.output}: {results.present.sum()} rows, {known.shape[1]} cells in "
              f"{len(frames)} frames, the worst {known.min(initial=np.inf):.3g}")
