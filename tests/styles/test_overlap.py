"""Cells of different size that run into each other, or are given so: never without a word; how much
space cells share is output and warned about."""

import re

import numpy as np
import pytest

from support.bad_decks import fails, whole
from support.meshes import cube

RUN_INTO = "Pair style dcm/contact: cells 1 and 2 run into each other"


def pushed(scenes, big, small, force, box=(40.0, 20.0, 20.0), boundary="f f f", style="", run=200):
    """Deck: cell 1 at rest, cell 2 of another size driven along +x by a total force.

    big, small: (kind, place, radius, level).
    """
    scene = scenes.Scene(box, boundary)
    for kind, place, radius, level in (big, small):
        if kind == "dcm":
            scene.dcm(*place, radius, level=level)
        else:
            scene.cbm(*place, radius)
    kind, _, _, level = small
    n = 10 * 4**level + 2 if kind == "dcm" else 1
    return (
        whole(scene, contact=scene.contact(style), motion=scene.motion(options="maxmove 3"))
        + f"group small molecule 2\ngroup movers type {2 if kind == 'dcm' else 4}\n"
        + "group pushed intersect small movers\n"
        + f"fix push pushed addforce {force / n!r} 0 0\n"
        + f"thermo 20\ntimestep 1.0\nrun {run}\n"
    )


BIG = ("dcm", (0.0, 0.0, 0.0), 6.0, 1)
BALL = ("cbm", (0.0, 0.0, 0.0), 6.0, 0)
# name: the two cells, force, style of the pair
THROUGH = {
    "small": (BIG, ("dcm", (-7.5, 0.2, 0.3), 0.5, 1), 1.2566, ""),
    "fine small": (BIG, ("dcm", (-8.5, -0.9, 0.4), 1.5, 2), 8.0, ""),
    "maugis history": (BIG, ("dcm", (-7.5, 0.2, 0.3), 0.5, 1), 1.2566, "law maugis branch history"),
    "range given": (BIG, ("dcm", (-7.5, 0.2, 0.3), 0.5, 1), 1.2566, "range 3"),
    "fine big": (("dcm", (0.0, 0.0, 0.0), 6.0, 3), ("dcm", (-7.5, 0.2, 0.3), 0.5, 1), 1.2566, ""),
    "sphere": (BIG, ("cbm", (-7.5, 0.2, 0.3), 0.5, 0), 1.2, ""),
    "into a sphere": (BALL, ("dcm", (-7.5, 3.2, 0.3), 0.5, 1), 1.2566, ""),
    "sphere into sphere": (BALL, ("cbm", (-7.5, 0.2, 0.3), 0.5, 0), 4.0, ""),
}  # fmt: skip


@pytest.mark.parametrize("name", THROUGH)
def test_no_cell_passes_into_another_unseen(lmp, scenes, name):
    big, small, force, style = THROUGH[name]
    result = lmp.run(pushed(scenes, big, small, force, style=style))
    assert result.returncode != 0, result.tail()
    assert re.search(RUN_INTO, result.error), result.error
    assert "maxmove" in result.error and "at step" in result.error
    # before it has gone farther in than its own size: depth and limit are in the message
    depth, limit = map(
        float, re.search(r"overlap by (\S+) at step.*more than ([\d.]+)", result.error).groups()
    )
    assert limit < depth < 2.2 * small[2]
    if small[0] == "dcm" and big[0] == "dcm":
        assert limit <= 0.5 * small[2] * 1.001


@pytest.mark.parametrize(
    "law, force", [("dmt", 2.5), ("dmt", 5.0), ("foundation", 10.0)]
)  # 2.7, 5.4 and 10.8 of its edges in a step; with less, law foundation only dents the large cell
@pytest.mark.parametrize("start", [-7.5, -7.2, -6.9])
def test_even_where_it_is_inside_after_one_step(lmp, scenes, start, law, force):
    small = ("dcm", (start, 0.2, 0.3), 0.5, 1)
    deck = pushed(scenes, BIG, small, force, style=f"law {law}", run=30)
    result = lmp.run(deck.replace("maxmove 3", "maxmove 20"))
    assert re.search(RUN_INTO, result.error), result.error + result.tail()


@pytest.mark.parametrize("np_", [2, 3, 4])
@pytest.mark.parametrize("name", ["small", "sphere", "into a sphere"])
def test_on_all_ranks(lmp, scenes, name, np_):
    """The same pair, step and depth as on one rank."""
    big, small, force, style = THROUGH[name]
    deck = pushed(scenes, big, small, force, style=style)
    first, second = lmp.run(deck), lmp.run(deck, np=np_)
    pattern = r"overlap by (\S+) at step (\d+)"
    assert re.search(RUN_INTO, second.error), second.error
    one, more = (re.search(pattern, r.error).groups() for r in (first, second))
    assert one == more


@pytest.mark.parametrize("shift", [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)])
def test_across_a_periodic_border(lmp, scenes, shift):
    """The wall of the large cell lies at a periodic border, or in an edge of the box."""
    x, y = shift
    big = ("dcm", (x + 6.0 - 40.0 * (x > 0), y - 40.0 * (y > 0), 0.0), 6.0, 1)
    small = ("dcm", (x - 1.5, 0.2 + y - 40.0 * (y > 0), 0.3), 0.5, 1)
    deck = pushed(scenes, big, small, 1.2566, box=20.0, boundary="p p p")
    assert re.search(RUN_INTO, lmp.run(deck, np=2).error)


def test_between_rebuilds(lmp, scenes):
    """A skin so thick that the list is never made anew."""
    big, small, force, style = THROUGH["small"]
    deck = pushed(scenes, big, small, force, style=style)
    deck = deck.replace("neighbor 0.6 multi", "neighbor 8.0 multi")
    assert re.search(RUN_INTO, lmp.run(deck).error)


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (3.5, 0.0, 0.0), (0.0, -2.0, 4.0)])
@pytest.mark.parametrize("inner", ["dcm", "cbm"])
def test_wholly_inside_at_the_start(lmp, scenes, place, inner, np_):
    scene = scenes.Scene(25.0)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    getattr(scene, inner)(*place, 0.5)
    scene.cbm(15.0, 0.0, 0.0, 6.0)
    fails(lmp, whole(scene), "Pair style dcm/contact: cells 1 and 2 overlap.*move them apart",
          np=np_)  # fmt: skip


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("between", [
    "displace_atoms small move -9.0 0.3 0.2 units box",
    "set type 4 diameter 13.2",
])  # fmt: skip
def test_moved_into_each_other_between_runs(lmp, scenes, between, np_):
    """At the step at which the run before has ended, with the same atoms."""
    scene = scenes.Scene(25.0)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(9.3, 0.0, 0.0, 3.0)
    deck = whole(scene) + f"group small molecule 2\nrun 0\nrun 0\n{between}\n"
    error = lmp.run(deck + "run 5\n", np=np_).error
    assert re.search("cells 1 and 2 overlap.*move them apart", error)


def test_inside_the_end_of_a_long_cell_at_the_start(lmp, scenes):
    """Beyond the ball of the long cell's volume."""
    nodes, faces = scenes.icosphere(2)
    nodes = nodes * [4.0, 1.0, 1.0]
    scene = scenes.Scene(40.0)
    mesh = ("long.off", len(nodes), len(faces))
    scene.dcm(0.0, 0.0, 0.0, 12.0, mesh=mesh, options="scale nodes")
    scene.dcm(9.0, 0.0, 0.0, 0.6)
    fails(lmp, whole(scene), "dcm/contact: the center of cell 2 lies inside cell 1",
          files={"long.off": scenes.off(nodes, faces)})  # fmt: skip
    scene = scenes.Scene(40.0)
    scene.dcm(0.0, 0.0, 0.0, 12.0, mesh=mesh, options="scale nodes")
    scene.dcm(9.0, 4.0, 0.0, 0.6)
    lmp(whole(scene) + "run 0\n", files={"long.off": scenes.off(nodes, faces)})


def test_small_beside_large_may_touch(lmp, scenes):
    """Cells of very different size at rest beside each other are no error."""
    scene = scenes.Scene(25.0)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.dcm(-7.05, 0.2, 0.3, 1.0)
    scene.cbm(7.1, 0.2, 0.3, 1.0)
    deck = whole(scene, contact=scene.contact("law foundation h0 0.05"), motion=scene.motion())
    result = lmp(deck + "compute p all pair dcm/contact\n" + scenes.thermo(["c_p[3]"], 50)
                 + "timestep 0.2\nrun 200\n")  # fmt: skip
    assert result.thermo[-1]["c_p[3]"] > 0.01


def test_moves_are_measured_in_own_edges(lmp, scenes):
    """maxmove: a small cell's node in its own mean edge, whatever else there is."""
    for radius, others in ((6.0, ()), (0.6, ()), (0.6, (6.0, 6.0))):
        scene = scenes.Scene(40.0)
        scene.dcm(0.0, 0.0, 0.0, radius)
        for k, other in enumerate(others):
            scene.dcm(20.0, 15.0 * k, 0.0, other)
        speed = 0.2 * radius * 0.4
        area = 4 * np.pi * radius**2
        deck = (
            whole(scene, motion=scene.motion(options="tolerance 1e-10"))
            + "group one molecule 1\ngroup nodes type 2\ngroup pushed intersect one nodes\n"
            + f"fix push pushed addforce {speed * area / 42!r} 0 0\n"
            + scenes.thermo(["f_motion[4]"], 1)
            + "timestep 1.0\nrun 1\n"
        )
        move = lmp(deck).thermo[-1]["f_motion[4]"]
        edge = 0.589 * radius  # of the icosphere of 42 nodes, mean of 0.5465 and 0.6180
        assert move == pytest.approx(speed / edge, rel=0.15)


# ---- output and warnings


def box_of_cells(scenes, law, half, level=1):
    """Eight cells of radius 6 on a lattice in a periodic cube of half side `half`."""
    scene = scenes.Scene(half, "p p p", level)
    for x in (-half / 2, half / 2):
        for y in (-half / 2, half / 2):
            for z in (-half / 2, half / 2):
                scene.dcm(x, y, z, 6.0)
    return whole(scene, contact=scene.contact(law), motion=scene.motion(options=""))


OUTPUT = (
    "compute p all pair dcm/contact\ncompute v all dcm/cell volume\n"
    "compute all all reduce sum c_v\n"
)


@pytest.mark.parametrize("np_", [1, 4])
def test_filled_and_overlap_are_output(lmp, scenes, np_):
    """The sum of the cells' volumes over that of the box; the overlap of flats, known."""
    deck = (
        box_of_cells(scenes, "law foundation", 12.9)
        + OUTPUT
        + scenes.thermo(["c_p[5]", "c_p[6]", "sum=c_all/vol"], 1)
        + "timestep 1.0\nrun 2\n"
    )
    for row in lmp(deck, np=np_).thermo:
        assert row["c_p[6]"] == pytest.approx(row["v_sum"], rel=1e-12)
        assert row["c_p[5]"] == 0.0

    nodes, faces = cube(6)
    mesh = ("cube.off", len(nodes), len(faces))
    scene = scenes.Scene(25.0)
    for sign in (-1, 1):
        scene.dcm(sign * 5.9, 0, 0, 6 * np.sqrt(3), mesh=mesh, options="scale nodes")
    deck = whole(scene) + OUTPUT + scenes.thermo(["c_p[5]", "c_p[6]"]) + "run 0\n"
    row = lmp(deck, np=np_, files={"cube.off": scenes.off(nodes, faces)}).thermo[0]
    assert row["c_p[5]"] == pytest.approx(0.2, abs=1e-9)


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("overlap", [0.1, 0.4])
def test_overlap_between_the_middles_of_coarse_faces(lmp, scenes, overlap, np_):
    """Two balls of 42 nodes, node against node: the tips overlap although the surfaces are a gap
    apart in front of the middles of all faces."""
    nodes, faces = scenes.icosphere(1)
    top = nodes[0]
    side = np.cross(top, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    turned = 6.0 * nodes @ np.array([top, side, np.cross(top, side)]).T  # nodes at +x and at -x
    lower = turned[faces[np.any(faces == 0, axis=1)]].mean(axis=1)[:, 0].max()
    assert 2 * (6.0 - lower) > 0.4  # middles of the faces around a tip
    mesh = ("ball.off", len(nodes), len(faces))
    scene = scenes.Scene(25.0)
    for x in (-1, 1):
        scene.dcm(x * (6.0 - overlap / 2), 0, 0, 6.0, mesh=mesh, options="scale nodes")
    deck = whole(scene) + OUTPUT + scenes.thermo(["c_p[5]"]) + "run 0\n"
    row = lmp(deck, np=np_, files={"ball.off": scenes.off(turned, faces)}).thermo[0]
    assert row["c_p[5]"] == pytest.approx(overlap, abs=1e-9)


def test_spheres_count_in_periodic_boxes(lmp, scenes):
    for boundary, counted in (("p p p", True), ("f p p", False)):
        scene = scenes.Scene(20.0, boundary)
        scene.dcm(0.0, 0.0, 0.0, 6.0)
        scene.cbm(12.5, 0.0, 0.0, 6.0)
        deck = whole(scene) + OUTPUT + scenes.thermo(["c_p[6]", "v=c_all"]) + "run 0\n"
        row = lmp(deck).thermo[0]
        ball = 4 / 3 * np.pi * 6.0**3
        expected = row["v_v"] - ball * (not counted)
        assert row["c_p[6]"] * 40.0**3 == pytest.approx(expected, rel=1e-9)


def test_squeezed_tissue_is_warned_about(lmp, scenes):
    """Once per run, on any output interval, with the remedy; not with law foundation."""
    squeeze = "fix squeeze all deform 1 x scale 0.64 y scale 0.64 z scale 0.64 remap x\n"
    for law, warned in (("law dmt", True), ("law foundation", False)):
        deck = box_of_cells(scenes, law, 12.9) + squeeze + "thermo 50\ntimestep 1.0\nrun 600\n"
        log = lmp.run(deck, np=2).log
        filled = re.findall(r"the volumes of the cells add up to ([\d.]+) of the box", log)
        deep = re.findall(r"cells \d+ and \d+ overlap by ([\d.]+) at step", log)
        assert len(filled) == len(deep) == warned, log[-3000:]
        if warned:
            assert 1.01 < float(filled[0]) < 1.05
            assert 0.6 < float(deep[0]) < 1.2
            assert "'pair_style dcm/contact law foundation' keeps them apart" in log
