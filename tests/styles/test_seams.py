"""What fix dcm/cell and the pair style offer to styles to come: adjacency, regions of ghost faces,
contact areas per pair of cells, stiffness of contacts; asked by fix dcm/probe in tests/probe."""

import os
from pathlib import Path

import pytest

from support.bad_decks import whole

NAMES = ["nodes", "around", "fewest", "edges", "both", "ghosts", "stale", "pairs", "pair_area",
         "stiffness"]


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


def push(lmp, scenes, scene, np_, shifts, options="stiffness yes"):
    """Force along x on the cell of molecule 1, shifted along x, and its stiffness by the probe."""
    deck = whole(scene, contact=scene.contact(coeff="W 0"), motion="", extra=f"""
fix probe all dcm/probe {options}
group one molecule 1
compute push one reduce sum fx
""")  # fmt: skip
    deck += scenes.thermo(["push=c_push", f"stiffness=f_probe[{len(NAMES)}]"])
    for shift in shifts:
        deck += f"displace_atoms one move {shift!r} 0 0 units box\nrun 0\n"
    result = lmp(deck, np=np_)
    return [(run[0]["v_push"], run[0]["v_stiffness"]) for run in result.runs]


def spheres_on_a_line(scenes):
    scene = scenes.Scene(20.0, boundary="f f f")
    scene.cbm(-5.0, 0.0, 0.0, 6.0)
    scene.cbm(5.4, 0.0, 0.0, 6.0)
    return scene


def cell_and_sphere(scenes):
    scene = scenes.Scene(20.0, level=2)
    scene.dcm(-5.7, 0.0, 0.0, 6.0)
    scene.cbm(5.9, 0.0, 0.0, 6.0)
    return scene


SCENES = {
    "faces": (lambda scenes: scenes.doublet(level=2, gap=-0.6), 0.03),
    "mixed": (cell_and_sphere, 0.03),
    "spheres": (spheres_on_a_line, 1e-6),
}


@pytest.mark.parametrize("name", SCENES)
def test_stiffness_is_the_derivative_of_the_force(lmp, scenes, name):
    """One cell shifted against the other, without adhesion, so that nothing is left out as
    negative. What the blocks do not have: axes of faces that turn, a few percent."""
    build, tolerance = SCENES[name]
    e = 1e-4
    left, right, middle = push(lmp, scenes, build(scenes), 1, [-e, 2 * e, -e])
    assert middle[1] == pytest.approx((left[0] - right[0]) / (2 * e), rel=tolerance)
    assert middle[1] > 1.0
    assert push(lmp, scenes, build(scenes), 1, [0.0], "")[0][1] == 0.0  # nobody asks


@pytest.mark.parametrize("name", SCENES)
def test_stiffness_on_more_ranks(lmp, scenes, name):
    build = SCENES[name][0]
    alone = push(lmp, scenes, build(scenes), 1, [0.0])[0]
    for np_ in (2, 3, 4):
        shared = push(lmp, scenes, build(scenes), np_, [0.0])[0]
        assert shared[1] == pytest.approx(alone[1], rel=1e-12)
