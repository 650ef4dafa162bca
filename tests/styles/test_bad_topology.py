"""Bonds and dihedrals that do not fit the faces of a cell: one error with cell, edge and remedy."""

import re

import pytest

from support.bad_decks import fails, whole

NEDGES = 120  # of a mesh of 42 nodes: 3 n - 6


@pytest.fixture(scope="module")
def text(lmp_module, scenes):
    """Data file of a doublet: center 1, nodes 2 to 43, faces 44 to 123, and the second cell."""
    done = lmp_module(whole(scenes.doublet()) + "write_data cells.data nocoeff\n")
    return (done.path / "cells.data").read_text()


def reading(scene, **parts):
    head = (
        "units lj\natom_style dcm\nnewton on\nboundary s s s\n"
        "read_data cells.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
    )
    return whole(scene, head=head, **parts)


def rows(text, section):
    body = re.search(rf"\n{section}[^\n]*\n\n(.*?)(\n\n|\Z)", text, re.S).group(1)
    return [[int(w) for w in line.split()] for line in body.splitlines()]


def with_rows(text, section, new):
    """The data file with other rows of a section, and their number in the header."""
    body = "\n".join(f"{n} " + " ".join(map(str, row[1:])) for n, row in enumerate(new, 1))
    text = re.sub(rf"(\n{section}[^\n]*\n\n).*?(\n\n|\Z)", rf"\g<1>{body}\g<2>", text, flags=re.S)
    return re.sub(rf"\d+ {section.lower()}", f"{len(new)} {section.lower()}", text, count=1)


def in_cell_2(row):
    return min(row[2:]) > 123


def cases():
    def no_bonds(bonds, _):
        return [b for b in bonds if not in_cell_2(b)], None

    def twice(bonds, _):
        return bonds + bonds, None

    def one_missing(bonds, _):
        return bonds[1:], None

    def between(bonds, _):
        return bonds + [[0, 1, 5, 130]], None

    def across(bonds, _):
        edges = {frozenset(b[2:]) for b in bonds}
        far = next(n for n in range(3, 44) if frozenset((2, n)) not in edges)
        return bonds + [[0, 1, 2, far]], None

    def to_center(bonds, _):
        return bonds + [[0, 1, 1, 2]], None

    def moved(bonds, _):
        # as many bonds as before, one of them between other nodes
        edges = {frozenset(b[2:]) for b in bonds}
        far = next(
            n
            for n in range(3, 44)
            if frozenset((bonds[0][2], n)) not in edges | {frozenset((n,))} and n != bonds[0][2]
        )
        return [[1, 1, bonds[0][2], far], *bonds[1:]], None

    def no_hinges(_, hinges):
        return None, hinges[5:]

    def hinges_twice(_, hinges):
        return None, hinges + hinges[:1]

    def hinge_wrong(_, hinges):
        # of the far nodes of the first hinge, one is replaced by one that is no neighbor
        first = hinges[0]
        cell = range(2, 44) if first[2] < 124 else range(125, 167)
        return None, [[*first[:5], next(n for n in cell if n not in first[2:])], *hinges[1:]]

    edge = r"edge \d+-\d+"
    return {
        "no bonds": (
            no_bonds,
            "bonds of cell 2",
            f"{edge} has no bond",
            f"{NEDGES} edges, 0 bonds",
        ),
        "twice": (twice, "bonds of cell 1", f"{edge} has more than one bond", "240 bonds"),
        "one missing": (one_missing, f"{edge} has no bond", "119 bonds"),
        "between cells": (between, "bonds of cell", "atom (5|130), which is no node of this cell"),
        "across": (across, "bonds of cell 1", "a bond joins nodes 2 and .* no edge"),
        "to the center": (to_center, "atom 1 has a bond|atom 1, which is no node"),
        "moved": (moved, "bonds of cell", "joins nodes .* no edge", "120 bonds"),
        "no hinges": (no_hinges, "dihedrals of cell", f"{edge} has no dihedral", "115 dihedrals"),
        "hinge twice": (hinges_twice, f"{edge} has more than one dihedral", "121 dihedrals"),
        "hinge wrong": (hinge_wrong, f"dihedral at {edge} reaches to node"),
    }


def changed(text, case):
    make, *patterns = cases()[case]
    bonds, hinges = make(rows(text, "Bonds"), rows(text, "Dihedrals"))
    if bonds is not None:
        text = with_rows(text, "Bonds", bonds)
    if hinges is not None:
        text = with_rows(text, "Dihedrals", hinges)
    return text, patterns


@pytest.mark.parametrize("case", cases())
def test_topology(lmp, scenes, text, case):
    data, patterns = changed(text, case)
    fails(lmp, reading(scenes.doublet()), "Fix dcm/cell", *patterns, files={"cells.data": data})


@pytest.mark.parametrize("case", ["no bonds", "between cells", "hinge wrong"])
def test_topology_on_three_ranks(lmp, scenes, text, case):
    data, patterns = changed(text, case)
    fails(lmp, reading(scenes.doublet()), *patterns, files={"cells.data": data}, np=3)


def test_as_given(lmp, scenes, text):
    """Any order and direction of bonds and dihedrals is right, and so is the energy."""
    bonds, hinges = rows(text, "Bonds"), rows(text, "Dihedrals")
    other = with_rows(text, "Bonds", [[*b[:2], b[3], b[2]] for b in reversed(bonds)])
    other = with_rows(other, "Dihedrals", [[*h[:2], *reversed(h[2:])] for h in reversed(hinges)])
    deck = reading(scenes.doublet()) + scenes.thermo(["ebond", "edihed"]) + "run 5\n"
    one = lmp(deck, files={"cells.data": text}).thermo[-1]
    two = lmp(deck, files={"cells.data": other}).thermo[-1]
    assert one["E_bond"] > 0
    for name in ("E_bond", "E_dihed"):
        assert two[name] == pytest.approx(one[name], rel=1e-9)


# --- faces and their cells ------------------------------------------------------------------------


def atoms(text, change):
    """The data file with changed words of its atoms."""
    head, body, tail = re.fullmatch(r"(.*\nAtoms[^\n]*\n\n)(.*?)(\n\n.*)", text, re.S).groups()
    return head + "\n".join(" ".join(change(line.split())) for line in body.splitlines()) + tail


@pytest.mark.parametrize("np", [1, 3])
def test_faces_of_another_cell(lmp, scenes, text, np):
    """Both surfaces stay closed if two cells trade all their faces."""

    def change(words):
        if words[3] == "4":
            words[1] = {"1": "2", "2": "1"}[words[1]]
        return words

    fails(
        lmp,
        reading(scenes.doublet()),
        "face .* of cell [12] has vertex .* a node of cell [12]",
        "three nodes of its own cell",
        files={"cells.data": atoms(text, change)},
        np=np,
    )


def test_vertex_that_is_no_node(lmp, scenes, text):
    def change(words):
        if words[0] == "50":
            words[8] = "1"
        return words

    fails(
        lmp,
        reading(scenes.doublet()),
        "face 50 of cell 1 has vertex 1, which is a center",
        files={"cells.data": atoms(text, change)},
    )


# --- bonds edited by LAMMPS -----------------------------------------------------------------------

EDITORS = {
    # what is done between two runs, patterns
    "delete": ("group sub id 2:20\ndelete_bonds sub bond 1 remove special\n", "were edited"),
    "off": ("group sub id 2:20\ndelete_bonds sub bond 1\n", "were edited"),
    "delete dihedrals": ("group sub id 2:20\ndelete_bonds sub dihedral 1 remove\n", "were edited"),
    "delete a node": (
        "group sub id 5\ndelete_atoms group sub bond yes\n", "delete_atoms of some nodes"),
    "create": ("create_bonds single/bond 1 5 140 special no\n", "were edited"),
    "delete and create": (
        "group sub id 2:43\ndelete_bonds sub bond 1 remove special\n{again}",
        "were edited",
    ),
}


@pytest.mark.parametrize("case", EDITORS)
@pytest.mark.parametrize("np", [1, 3])
def test_edited_bonds(lmp, scenes, text, case, np):
    """Rest lengths and angles stand in slots of the lists: no run goes on with mixed up ones."""
    edit, *patterns = EDITORS[case]
    again = "".join(
        f"create_bonds single/bond 1 {a} {b} special no\n"
        for _, _, a, b in rows(text, "Bonds")[::-1]
        if max(a, b) < 44
    )
    deck = reading(scenes.doublet()) + "timestep 0.5\nrun 3\nprint begin\n"
    deck += edit.format(again=again) + "run 1\n"
    result = lmp.run(deck, files={"cells.data": text}, np=np, timeout=60)
    assert result.returncode != 0, result.tail()
    for pattern in ("node .* .cell 1.", "delete_bonds", *patterns):
        assert re.search(pattern, result.error.replace("\n", " ")), result.error
    assert result.thermo[-1]["Step"] == 3


def test_edited_before_the_rest_file(lmp, scenes):
    deck = whole(scenes.doublet()) + "run 1\nfix_modify cell rest/write a.rest\n"
    deck += "group sub id 2:20\ndelete_bonds sub bond 1 remove special\n"
    result = lmp.run(deck + "fix_modify cell rest/write b.rest\n")
    assert "rest-state file b.rest is not written: the bonds" in result.error
    assert (result.path / "a.rest").exists() and not (result.path / "b.rest").exists()


def test_edited_before_the_first_run(lmp, scenes):
    """create_cells and restart files have rest lengths before any run."""
    scene = scenes.doublet()
    edit = "group sub id 2:20\ndelete_bonds sub bond 1 remove special\n"
    fails(lmp, whole(scene, extra=edit), "were edited")
    done = lmp(whole(scene) + "run 1\nwrite_restart a.restart\n")
    deck = whole(scene, head="read_restart a.restart\n", extra=edit)
    fails(lmp, deck, "were edited", files={"a.restart": done.path / "a.restart"})


@pytest.mark.parametrize("np", [1, 3])
def test_tethers_of_a_hybrid_style(lmp, scenes, np):
    """Bonds of another style may be added; the cortex keeps its rest lengths, bit for bit."""
    scene = scenes.doublet()
    cortex = scene.cortex().replace(
        "bond_style dcm/cortex", "bond_style hybrid dcm/cortex harmonic"
    )
    cortex = cortex.replace("bond_coeff 1 ", "bond_coeff 1 dcm/cortex ")
    cortex += "bond_coeff 2 harmonic 0.0 5.0\n"
    head = scene.head().replace("bond/types 1", "bond/types 2")
    deck = whole(scene, head=head, cortex=cortex) + "run 5\nfix_modify cell rest/write a.rest\n"
    deck += "create_bonds single/bond 2 43 130 special no\nrun 0\n"
    path = lmp(deck + "fix_modify cell rest/write b.rest\n", np=np).path

    def edges(name):
        return {line for line in (path / name).read_text().splitlines() if len(line.split()) == 3}

    assert len(edges("a.rest")) == 2 * NEDGES
    assert edges("a.rest") == edges("b.rest")
