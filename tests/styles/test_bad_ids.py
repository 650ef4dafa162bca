"""Atom IDs, molecule IDs and per-atom values that LAMMPS or the deck edits, reuses or exhausts."""

import os
import re

import numpy as np
import pytest

from support.bad_decks import fails, lines_of_error, whole

# --- reset_atoms id -------------------------------------------------------------------------------


@pytest.mark.parametrize("np", [1, 3])
@pytest.mark.parametrize("options", ["", "sort yes"])
def test_reset_atoms(lmp, scenes, options, np):
    """Vertices of faces do not follow: the command is refused where it stands."""
    deck = whole(scenes.doublet()) + "timestep 0.5\nrun 2\n"
    result = lmp.run(deck + f"reset_atoms id {options}\nrun 2\n", np=np)
    assert result.returncode != 0
    assert re.search("reset_atoms id.*fix dcm/cell", result.error), result.tail()


@pytest.mark.parametrize("np", [1, 3])
def test_reset_atoms_after_deletion(lmp, scenes, np):
    deck = whole(scenes.doublet()) + "timestep 0.5\nrun 2\ngroup g molecule 1\n"
    deck += "delete_atoms group g bond yes compress no\nreset_atoms id\nrun 2\n"
    result = lmp.run(deck, np=np)
    assert re.search("reset_atoms id.*fix dcm/cell", result.error), result.tail()


@pytest.mark.parametrize("np", [1, 3])
@pytest.mark.parametrize("options", ["", "sort yes"])
def test_reset_atoms_before_fix_cell(lmp, scenes, options, np):
    """Nobody can refuse it there: faces whose vertices are gone are an error that names it. On one
    rank IDs of new cells stay as they are unless they are sorted."""
    scene = scenes.doublet()
    deck = whole(scene, head=scene.head() + f"reset_atoms id {options}\n")
    if options or np > 1:
        fails(lmp, deck, "reset_atoms id", np=np)
    else:
        lmp(deck + "run 1\n")


@pytest.mark.parametrize("np", [1, 3])
@pytest.mark.parametrize(
    "options, pattern",
    [
        ("all", "cell 0 has two center atoms.*reset_atoms mol"),
        ("all single yes", "has vertex|no center atom"),
    ],
)
def test_reset_molecules(lmp, scenes, options, pattern, np):
    """It goes by bonds, which centers and faces do not have."""
    deck = whole(scenes.doublet()) + f"timestep 0.5\nrun 2\nreset_atoms mol {options}\nrun 2\n"
    result = lmp.run(deck, np=np)
    assert len(lines_of_error(result)) == 1, result.tail()
    assert re.search(pattern, result.error.replace("\n", " ")), result.tail()
    assert "reset_atoms" in result.error


# --- molecule and atom IDs ------------------------------------------------------------------------

LAST = 2**31 - 1
four_byte_ids = pytest.mark.skipif(
    os.environ.get("LAMMPS_SIZES") == "BIGBIG", reason="8-byte IDs do not run out"
)
ONE = """one atom

1 atoms
4 atom types
1 bond types
1 dihedral types
-20 20 xlo xhi
-20 20 ylo yhi
-20 20 zlo zhi

Masses

1 1
2 1
3 1
4 1

Atoms # dcm

{tag} {mol} 4 1 4 0 14 0 0 0 0 0 0
"""
CELL = "create_cells single c dcm 0 -4 0 6 dcm c 1 2 3 1 1 mesh icosphere 1 rest 0.95\n"


def after_one(scene, extra="", cells=CELL):
    head = (
        "units lj\natom_style dcm\nnewton on\nboundary p p p\n"
        "read_data one.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n" + cells
    )
    return whole(scene, head=head, extra=extra)


@four_byte_ids
def test_no_molecule_left(lmp, scenes):
    scene = scenes.Scene()
    files = {"one.data": ONE.format(tag=7, mol=LAST)}
    fails(
        lmp,
        after_one(scene),
        "Create_cells: no molecule IDs are left for 1 new",
        str(LAST),
        files=files,
    )
    files = {"one.data": ONE.format(tag=LAST - 5, mol=7)}
    fails(lmp, after_one(scene), "Create_cells: no atom IDs are left for 123 new", files=files)


def test_last_molecules(lmp, scenes):
    """The last IDs are given, and no more."""
    files = {"one.data": ONE.format(tag=7, mol=LAST - 1)}
    deck = after_one(scenes.Scene()) + "dump d all custom 1 mol.txt id mol\nrun 0\n"
    frame = lmp(deck, files=files).dump("mol.txt")[-1]
    assert set(frame["mol"]) == {LAST - 1, LAST}


@four_byte_ids
@pytest.mark.parametrize("np", [1, 3])
def test_no_molecule_left_for_daughters(lmp, scenes, np):
    """Four IDs are left: two divisions at the same time, and then none."""
    scene = scenes.Scene()
    extra = (
        f"fix grow all dcm/growth {scene.map} seed 1 cycle_time 4 rounding 0 1\n"
        "fix divide all dcm/division seed 3\n"
    )
    files = {"one.data": ONE.format(tag=7, mol=LAST - 5)}
    deck = after_one(scene, extra) + "timestep 0.5\nrun 60\n"
    result = lmp.run(deck, files=files, np=np)
    assert result.returncode != 0
    assert re.search("no molecule IDs are left for new cells at step [0-9]+", result.error)


# --- values of fix property/atom ------------------------------------------------------------------


@pytest.mark.parametrize("np", [1, 3])
def test_property_atom_of_daughters(lmp, scenes, np):
    """Atoms that are made in a run begin with 0, whatever stood at their place in memory."""
    scene = scenes.doublet(boundary="p p p", gap=1.0, box=30.0)
    contact = scene.contact().replace("neighbor 0.6", "neighbor 1.0")
    extra = (
        f"fix grow all dcm/growth {scene.map} seed 5 cycle_time 40\n"
        "fix divide all dcm/division seed 7\n"
        "fix mark all property/atom d_mark i_count d2_pair 2\n"
    )
    deck = whole(scene, extra=extra, contact=contact) + "timestep 1.0\n"
    deck += "set group all d_mark 7.5 i_count 3 d2_pair[1] 1.5 d2_pair[2] 2.5\nrun 60\n"
    deck += "write_dump all custom mark.txt id mol d_mark i_count d2_pair[1] d2_pair[2]\n"
    frame = lmp(deck, np=np).dump("mark.txt")[-1]
    assert set(frame["mol"]) == {3, 4, 5, 6}
    for name in ("d_mark", "i_count", "d2_pair[1]", "d2_pair[2]"):
        assert np_all_zero(frame[name]), name


def np_all_zero(values):
    return not np.any(values)


def test_property_atom_of_created_cells(lmp, scenes):
    scene = scenes.doublet(box=40.0, boundary="p p p")
    deck = whole(scene) + "fix mark all property/atom d_mark\nset group all d_mark 7.5\n"
    deck += "run 0\ngroup g molecule 2\ndelete_atoms group g bond yes compress no\n"
    deck += "create_cells single hep dcm 20 20 0 6 dcm hep 1 2 3 1 1 mesh icosphere 1\n"
    deck += "run 0\nwrite_dump all custom mark.txt id mol d_mark\n"
    frame = lmp(deck).dump("mark.txt")[-1]
    assert set(frame["d_mark"][frame["mol"] == 1]) == {7.5}
    assert set(frame["d_mark"][frame["mol"] != 1]) == {0.0}
