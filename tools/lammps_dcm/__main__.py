"""Command line: `python -m lammps_dcm scene ...`; --help lists the rest."""
import argparse
import sys

from . import scene


def make_parser():
    """The parser of all sub-commands."""
    parser = argparse.ArgumentParser(prog="python -m lammps_dcm", description=__doc__)
    sub = parser.add_subparsers(dest="command", required=True)
    p = sub.add_parser("scene", help="write a cells table for `create_cells table FILE`")
    scene.add_arguments(p)
    p.set_defaults(run=scene.run)
    return parser


def main(words=None):
    """Run the command line `words`; returns the exit status."""
    words = sys.argv[1:] if words is None else words
    args = make_parser().parse_args(words)
    try:
        args.run(args, words)
    except (ValueError, OSError) as err:
        print(f"lammps_dcm {args.command}: {err}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
