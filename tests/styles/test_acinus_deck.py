"""The deck examples/acinus, shortened to its first two cells: they hold a closed lumen."""
from pathlib import Path

import numpy as np
import pytest

import lammps_dcm
from lammps_dcm.mesh import Mesh

ROOT = Path(__file__).resolve().parents[2]
# names of the analysis -> elements of compute dcm/lumen
ELEMENTS = {"number": 1, "volume": 2, "wall": 3, "closure": 5, "cells": 6, "covered": 8}
P, SHARE = 0.3, 15.0


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    from support.runner import Runner

    deck = (ROOT / "examples/acinus/in.acinus").read_text()
    columns = "c_lumen[1] c_lumen[2] c_lumen[3] c_lumen[5] c_lumen[6] &\n                c_lumen[8]"
    assert columns in deck
    deck = deck.replace(columns, "c_lumen[*]").replace("%.10g", "%.16g").replace(
        "run             $(round(v_hours", "thermo_modify format float %.15g\nrun $(round(v_hours")
    deck = deck.replace("thermo          50", "thermo 1")    # dumps come by time
    folder = tmp_path_factory.mktemp("acinus")
    files = {"cells.txt": ROOT / "examples/acinus/cells.txt",
             "acinus.dcm": ROOT / "potentials/acinus.dcm"}
    return Runner(folder)(deck, files=files, vars={"hours": 0.3, "P": P, "share": SHARE})


def rows(run):
    return {int(row["Step"]): row for row in run.thermo if "c_lumen[1]" in row}


def hits(center, corners, directions):
    """Which rays from a point meet any of the triangles (m, 3, 3)."""
    a, u, v = corners[:, 0] - center, corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    found = np.zeros(len(directions), dtype=bool)
    for k, d in enumerate(directions):
        p = np.cross(d, v)
        det = (u * p).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            s = -(a * p).sum(axis=1) / det
            q = np.cross(-a, u)
            t, far = q @ d / det, (v * q).sum(axis=1) / det
        found[k] = ((s >= 0) & (t >= 0) & (s + t <= 1) & (far > 0)).any()
    return found


def test_two_cells_around_a_closed_lumen(run):
    last = list(rows(run).values())[-1]
    assert (last["f_growth"], last["c_lumen[1]"], last["c_lumen[6]"]) == (2, 1, 2)
    volume = last["c_lumen[2]"]
    assert 10.0 < volume < 2 * 446.0 / 4
    # of the states of balance in which a division may end some leave 0.94, others 0.97
    assert last["c_lumen[8]"] > 0.9 and last["c_lumen[5]"] < 0.05
    # a fixed amount of solute. The volume in a wall that does not close depends on the point that
    # it is seen from, by a third of closure times area for each um; the two styles look at a point
    # that moves in a step, by less than 0.01 um
    seen = last["c_lumen[5]"] * last["c_lumen[3]"] / 3 * 0.01
    wanted = P * min(1.0, 2 * SHARE / volume)
    assert last["f_osmosis[5]"] == pytest.approx(wanted, rel=1e-6 + seen / volume)
    assert seen / volume < 1e-4


def test_no_way_out(run):
    """Rays from the middle of the lumen meet a cell. Facets touch within the range of adhesion, so
    that a few find a slit: one of width h0 = 0.35 um all around a lumen of radius 2.4 um would let
    through h0 / 2 r = 7 %."""
    u = lammps_dcm.load(dump=run.path / "lumen.dump")
    lumen = lammps_dcm.Lumens(u).run().results.lumens[-1][0]
    u.trajectory[-1]
    mesh = Mesh(lammps_dcm.frame_atoms.AtomBook(u).frame())
    corners = mesh.corners + mesh.origin[mesh.cell][:, None, :]
    z = np.linspace(-1, 1, 4002)[1:-1]
    angle = np.pi * (3 - np.sqrt(5)) * np.arange(len(z))
    r = np.sqrt(1 - z**2)
    directions = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)
    center = np.array([lumen["x"], lumen["y"], lumen["z"]])
    assert hits(center, corners, directions).mean() > 0.99
    half = directions[:, 2] > 0    # the test of the test: without the faces above they do not
    below = corners[corners[:, :, 2].max(axis=1) < center[2]]
    assert not hits(center, below, directions[half]).any()


def test_analysis_agrees_with_the_compute(run):
    u = lammps_dcm.load(dump=run.path / "lumen.dump")
    results = lammps_dcm.Lumens(u).run().results
    thermo = rows(run)
    compared = 0
    for k, step in enumerate(results.steps):
        row = thermo.get(int(step))
        # a gap that begins to open counts as linked by an open line of sight in one, by a short
        # distance in the other
        if row is None or row["c_lumen[1]"] != 1 or results.number[k] != 1:
            continue
        compared += 1
        for name, n in ELEMENTS.items():
            assert results[name][k] == pytest.approx(row[f"c_lumen[{n}]"], rel=1e-6, abs=1e-6)
    assert compared >= 2
