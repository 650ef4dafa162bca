"""What fix dcm/cell and the pair style offer to styles to come: adjacency, regions of ghost faces,
contact areas per pair of cells; asked for by fix dcm/probe, in tests/probe."""

import os
from pathlib import Path

import pytest

from support.bad_decks import whole

NAMES = ["nodes", "around", "fewest", "edges", "both", "ghosts", "stale", "pairs", "pair_area"]


@pytest.fixture
def lmp(lmp):
    """Runner with the plugin that has fix dcm/probe."""
    folder = Path(os.environ["DCM_BUILD"]) / "extend"
    assert (folder / "dcmplugin.so").exists(), f"no dcmplugin.so in {folder}; use tools/test"
    lmp.env["LAMMPS_PLUGIN_PATH"] = str(folder)
    return lmp


def probe(lmp, scenes, scene, np_, options="", steps=6):
    deck = whole(scene, extra=f"fix probe all dcm/probe {options}\n")
    deck += "compute of all dcm/cell contact_area\ncompute sum all reduce sum c_of\n"
    columns = [f"{name}=f_probe[{k}]" for k, name in enumerate(NAMES, 1)]
    deck += scenes.thermo([*columns, "covered=c_sum"]) + f"timestep 1.0\nrun {steps}\n"
    rows = lmp(deck, np=np_).thermo
    assert len(rows) == steps + 1
    return [{name: row[f"v_{name}"] for name in [*NAMES, "covered"]} for row in rows]


@pytest.mark.parametrize("np_", [1, 2, 3, 4])
@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_adjacency(lmp, scenes, np_, boundary):
    """Euler: V nodes have E = 3 V - 6 edges and F = 2 V - 4 faces, two at each edge. In a small
    periodic box a process knows several images of a node and of a face."""
    scene = scenes.doublet(boundary=boundary, box=15.0 if boundary == "p p p" else 20.0)
    for row in probe(lmp, scenes, scene, np_):
        assert row["nodes"] == 2 * 42
        assert row["edges"] == row["both"] == 2 * (3 * 42 - 6)
        assert row["around"] == 2 * 3 * (2 * 42 - 4)
        assert row["fewest"] == 0


@pytest.mark.parametrize("np_", [2, 3, 4])
def test_regions_of_ghost_faces(lmp, scenes, np_):
    """Every face changes its region in every step. Ghosts that are told have it; those that are not
    keep what they began with, 0, which is right for one in five."""
    told = probe(lmp, scenes, scenes.doublet(), np_)
    assert all(row["ghosts"] > 0 and row["stale"] == 0 for row in told)
    silent = probe(lmp, scenes, scenes.doublet(), np_, "send no", steps=1)
    assert silent[1]["stale"] / silent[1]["ghosts"] == pytest.approx(0.8, abs=0.05)


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_contact_areas_of_pairs_every_third_step(lmp, scenes, np_):
    """Recorded in multiples of 3 and kept between; a contact covers as much of either cell."""
    rows = probe(lmp, scenes, scenes.doublet(), np_, "every 3", steps=8)
    for step, row in enumerate(rows):
        assert row["pairs"] == 1
        assert row["pair_area"] == rows[step - step % 3]["pair_area"]
        if step % 3 == 0:
            assert 2 * row["pair_area"] == pytest.approx(row["covered"], rel=1e-12)
        else:
            assert 2 * row["pair_area"] != pytest.approx(row["covered"], rel=1e-6)
