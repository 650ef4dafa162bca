"""Scenes, tables and pictures of deformable cells in LAMMPS. Lengths in um, pressures in kPa."""
import argparse
import importlib
import sys

from . import __version__

# command -> module that has add_arguments(parser) and run(args, words), help
COMMANDS = {
    "scene": ("scene", "write a cells table for `create_cells table FILE`"),
    "render": ("render", "draw a frame of a dump or a data file into a PNG"),
    "export": ("export", "cells as VTK files for ParaView and OVITO, or as an HTML page"),
    "mesh": ("mesh_convert", "convert meshes for `create_cells ... mesh file`, or check them"),
    "cells": ("table", "volume, area and pressure of every cell and frame as CSV"),
    "quality": ("quality", "quality of the triangles of every cell as CSV"),
    "lumen": ("lumen", "volume, section and closure of lumens over time as CSV, and a plot"),
    "polarity": ("polarity", "apical and polar vectors of cells, their angles and order, as CSV"),
    "log": ("log", "plot the thermo columns of a LAMMPS log"),
    "lineage": ("lineage", "family trees and cycle times from the logs of divisions and deaths"),
    "movie": ("movie", "assemble pictures into an animated GIF or an .mp4"),
}


def make_parser(words):
    """Parser of all commands; only the module of the command in `words` is imported, since
    MDAnalysis and VTK take seconds to load."""
    parser = argparse.ArgumentParser(prog="python -m lammps_dcm", description=__doc__)
    parser.add_argument("--version", action="version", version=f"lammps_dcm {__version__}")
    sub = parser.add_subparsers(dest="command", required=True)
    asked = next((w for w in words if w in COMMANDS), None)
    for name, (module, text) in COMMANDS.items():
        p = sub.add_parser(name, help=text, description=text)
        if name == asked:
            module = importlib.import_module("." + module, __package__)
            module.add_arguments(p)
            p.set_defaults(run=module.run)
    return parser


def main(words=None):
    """Run the command line `words`; returns the exit status."""
    words = sys.argv[1:] if words is None else list(words)
    try:
        args = make_parser(words).parse_args(words)
        args.run(args, words)
    except ModuleNotFoundError as err:
        print(f"lammps_dcm: {err}; install the requirements: pip install -r "
              "tools/requirements.txt", file=sys.stderr)
        return 1
    except (ValueError, OSError) as err:
        print(f"lammps_dcm {args.command}: {err}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
