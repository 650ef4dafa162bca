"""Decks that cannot run: settings, foreign atom style, scenes, a plugin of another LAMMPS."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from support.bad_decks import RUN, fails, whole

ROOT = Path(__file__).resolve().parents[2]


def test_timestep(lmp, scenes):
    for dt in ("0.0", "-1.0"):
        run = f"timestep {dt}\nthermo 1\nrun 2\n"
        fails(lmp, whole(scenes.single_cell()), "timestep", dt.rstrip("0").rstrip("."), run=run)


def test_newton_off(lmp, scenes):
    for newton in ("off", "on off", "off on"):
        deck = whole(scenes.doublet()).replace("newton on", f"newton {newton}")
        fails(lmp, deck, "needs newton on")


# --- styles without atom_style dcm ----------------------------------------------------------------

FOREIGN = {
    "bond": "bond_style dcm/cortex\nbond_coeff 1 bile_duct.dcm hepatoblast",
    "dihedral": "dihedral_style dcm/bend\ndihedral_coeff 1 bile_duct.dcm hepatoblast",
    "pair": "pair_style dcm/contact\npair_coeff * * bile_duct.dcm hepatoblast",
    "cell": "fix f all dcm/cell",
    "volume": "fix f all dcm/volume bile_duct.dcm hepatoblast",
    "motion": "fix f all dcm/motion bile_duct.dcm hepatoblast",
    "motility": "fix f all dcm/motility bile_duct.dcm hepatoblast seed 1",
    "confine": "fix f all dcm/confine plane z 1",
    "compute cell": "compute c all dcm/cell volume",
    "compute face": "compute c all dcm/face area",
    "create_cells": "create_cells single a dcm 0 0 0 1 dcm a 1 2 3 1 1 mesh icosphere 1",
}


@pytest.mark.parametrize("style", FOREIGN)
def test_no_atom_style(lmp, scenes, style):
    head = (
        "units lj\natom_style full\nregion b block -5 5 -5 5 -5 5\n"
        "create_box 1 b bond/types 1 dihedral/types 1\nmass 1 1\ncreate_atoms 1 single 0 0 0\n"
    )
    fails(lmp, head + FOREIGN[style] + "\n", "dcm", "needs atom_style dcm", "full")


def test_contact_history_needs_brick(lmp, scenes):
    """LAMMPS' contact history cannot communicate in tiled style, on any number of ranks."""
    deck = whole(scenes.hybrid(level=1), extra="comm_style tiled\n")
    fails(lmp, deck, "Pair style dcm/contact.*spheres.*comm_style brick")


# --- scenes that cannot be ------------------------------------------------------------------------


def test_ghost_cutoff(lmp, scenes):
    scene = scenes.doublet()
    result = fails(
        lmp,
        whole(scene, contact="comm_modify cutoff 0.5\n" + scene.contact()),
        "ghost cutoff 0.5 is too small",
        "set 'comm_modify cutoff [0-9.]+'",
    )
    needed = re.search(r"set 'comm_modify cutoff ([0-9.]+)'", result.error).group(1)
    lmp(whole(scene, contact=f"comm_modify cutoff {needed}\n" + scene.contact()) + RUN)


def test_box_too_small(lmp, scenes):
    scene = scenes.single_cell(box=10.0, boundary="p p p")
    fails(lmp, whole(scene), "cell 1 spans 0.[56].* of a periodic box", "at least two cells wide")


OVERLAP = {
    "dcm dcm": (("dcm", 0.0, 6.0), ("dcm", 6.0, 6.0), "cells 1 and 2 overlap by about 1"),
    "same place": (("dcm", 0.0, 6.0), ("dcm", 0.0, 6.0), "cells 1 and 2 overlap"),
    "inside": (("dcm", 0.0, 9.0), ("dcm", 0.0, 3.0), "cells 1 and 2 overlap"),
    "dcm cbm": (("dcm", 0.0, 6.0), ("cbm", 6.0, 6.0), "cells 1 and 2 overlap by about 1"),
    "cbm inside": (("dcm", 0.0, 9.0), ("cbm", 1.0, 3.0), "cells 1 and 2 overlap"),
}


@pytest.mark.parametrize("case", OVERLAP)
def test_start_overlap(lmp, scenes, case):
    *cells, pattern = OVERLAP[case]
    scene = scenes.Scene(30.0, level=2)
    for kind, x, radius in cells:
        getattr(scene, kind)(x, 0.0, 0.0, radius)
    fails(lmp, whole(scene), "Pair style dcm/contact", pattern, "move them apart")


def test_start_overlap_spheres(lmp, scenes):
    """Spheres may overlap far, as after a division: a warning; but not be in the same place."""
    scene = scenes.Scene(30.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(6.0, 0.0, 0.0, 6.0)
    parts = {"cortex": "", "volume": "", "cell": "fix cell all dcm/cell\n"}
    result = lmp(whole(scene, **parts) + "timestep 0.01\n" + "run 0\n")
    assert "1 pairs of center-based cells start with an overlap of more than half" in result.log

    scene = scenes.Scene(30.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    fails(lmp, whole(scene, **parts), "Pair style dcm/contact", "cells 1 and 2")


def test_start_overlap_two_ranks(lmp, scenes):
    scene = scenes.Scene(30.0, level=2)
    scene.dcm(-3.0, 0.0, 0.0, 6.0)
    scene.dcm(3.0, 0.0, 0.0, 6.0)
    fails(lmp, whole(scene), "cells 1 and 2 overlap", "move them apart", np=2)


# --- plugin of another LAMMPS ---------------------------------------------------------------------


def test_other_version(lmp, tmp_path):
    """A plugin for another LAMMPS says so instead of crashing; here only its entry point."""
    cache = Path(lmp.env["LAMMPS_PLUGIN_PATH"].split(":")[0]) / "CMakeCache.txt"
    compiler = shutil.which("mpicxx")
    found = re.search(r"LAMMPS_SOURCE_DIR:PATH=(.*)", cache.read_text() if cache.exists() else "")
    if not found or not compiler:
        pytest.skip("no build folder with a LAMMPS source next to the plugin, or no mpicxx")
    other = tmp_path / "other"
    other.mkdir()
    (other / "dcm_style_headers.h").write_text("")
    command = [compiler, "-std=c++17", "-shared", "-fPIC", "-DLAMMPS_SMALLBIG", "-DLMP_PLUGIN",
               "-DOMPI_SKIP_MPICXX=1", "-DDCM_LAMMPS_VERSION=20200101", f"-I{other}",
               f"-I{found.group(1)}", f"-I{ROOT / 'src/DCM'}",
               str(ROOT / "src/plugin/dcmplugin.cpp"),
               "-o", str(other / "dcmplugin.so")]  # fmt: skip
    subprocess.run(command, check=True, timeout=300)
    lmp.env = {**lmp.env, "LAMMPS_PLUGIN_PATH": ""}
    result = lmp.run(f"plugin load {other}/dcmplugin.so\natom_style dcm\n")
    text = result.out + result.err
    assert "compiled for LAMMPS version 20200101, this LAMMPS is version" in text
    assert "Rebuild the plugin with cmake -D LAMMPS_SOURCE_DIR" in text
    assert result.returncode == 1, result.tail()
    assert re.search("dcm", result.error), result.tail()
