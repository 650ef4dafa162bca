"""compute dcm/lumen, value mark of compute dcm/face, fix dcm/confine hold."""

import math

import numpy as np
import pytest

from support.bad_decks import fails, whole
from support.cycle_decks import same
from support.divisions import Cell

EVERYWHERE = "fix osm all dcm/osmosis pressure 0 marks flood starter 0 0 0 100 1e9\n"


def lumen(options=""):
    return f"compute lumen all dcm/lumen {options}\n"


def row_of(scenes, extra=()):
    return scenes.thermo([*(f"l{k}=c_lumen[{k}]" for k in range(1, 9)), *extra], 1)


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_the_space_around_a_cell(lmp, scenes, np_):
    """The marked faces of one cell: its surface seen from outside, volume and section negative."""
    scene = scenes.single_cell(level=2)
    result = lmp(
        scene.head() + scene.forces() + EVERYWHERE + lumen("plane x 0.7")
        + "compute p all property/atom kind vertex1 vertex2 vertex3\n"
        + "compute c all dcm/cell volume volume0 contact_area\n"
        + scenes.dump("id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_c[1] c_c[2] c_c[3] c_lumen "
                      "xu yu zu vx vy vz fx fy fz", 1)
        + row_of(scenes, ["x=c_lumen[1][7]", "v=c_lumen[1][1]", "s=c_lumen[1][10]"]) + "run 0\n",
        np=np_,
    )  # fmt: skip
    row, frame = result.thermo[0], result.dump()[0]
    cell = Cell(frame, 1)
    a, b, c = cell.corners
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    # outline: edges that go through x = 0.7
    points = []
    for f in cell.faces:
        for u, v in zip(f, np.roll(f, -1), strict=True):
            p, q = cell.x[u], cell.x[v]
            if u < v and (p[0] - 0.7) * (q[0] - 0.7) < 0:
                points.append(p + (0.7 - p[0]) / (q[0] - p[0]) * (q - p))
    points = np.array(points)
    points = points[np.argsort(np.arctan2(points[:, 2], points[:, 1]))]
    after = np.roll(points, -1, axis=0)
    section = 0.5 * (points[:, 1] * after[:, 2] - points[:, 2] * after[:, 1]).sum()
    length = np.linalg.norm(after - points, axis=1).sum()
    expected = [1, -cell.volume, area, -section, 0, 1, -4 * math.pi * section / length**2]
    expected.append(-1)  # the whole solid angle, seen from behind
    for k, value in enumerate(expected, 1):
        assert row[f"v_l{k}"] == pytest.approx(value, rel=1e-12, abs=1e-12), k
    assert row["v_v"] == row["v_l2"] and row["v_s"] == row["v_l8"]
    assert row["v_x"] == pytest.approx(0.0, abs=0.05)
    face = frame["c_p[1]"] == 4
    assert (frame["c_lumen"] == face).all()


def test_two_cells_apart_are_two(lmp, scenes):
    """The larger first; with min only that one; in a group of no cells: zeros."""
    scene = scenes.Scene(20.0)
    scene.dcm(-8.0, 0.0, 0.0, 4.0)
    scene.dcm(8.0, 0.0, 0.0, 5.0)
    for group, options, number in (("all", "", 2), ("all", "min 250", 1), ("none", "", 0)):
        result = lmp(
            scene.head() + scene.forces() + EVERYWHERE + "group none molecule 99\n"
            + lumen(options).replace("all", group)
            + scenes.dump("id mol type c_lumen", 1)
            + row_of(scenes, ["x=c_lumen[1][7]"] if number else []) + "run 0\n"
        )  # fmt: skip
        row, frame = result.thermo[0], result.dump()[0]
        assert row["v_l1"] == number
        assert not number or row["v_x"] == pytest.approx(8.0, abs=0.1)
        for molecule, value in ((2, 1), (1, 2)):
            mine = (frame["mol"] == molecule) & (frame["type"] == 3)
            assert (frame["c_lumen"][mine] == (value if value <= number else 0)).all()
        if number == 0:
            assert all(row[f"v_l{k}"] == 0 for k in range(1, 9))
        else:
            assert row["v_l6"] == 1 and row["v_l2"] < -400


BAD = {
    "no marks": ("", "", "nothing marks the faces at a lumen; add a fix dcm/osmosis"),
    "plane": (EVERYWHERE, "plane w 0", "plane must be x, y or z"),
    "plane at": (EVERYWHERE, "plane z x", "plane position is 'x'"),
    "slab": (EVERYWHERE, "plane z 0 slab 1 -1", "slab from 1 to -1 is empty"),
    "slab alone": (EVERYWHERE, "slab -1 1", "slab needs 'plane x|y|z at'"),
    "min": (EVERYWHERE, "min -1", "min is -1"),
    "range": (EVERYWHERE, "range 0", "range is 0.*positive"),
    "keyword": (EVERYWHERE, "x", "unknown keyword x"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(lmp, scenes, name):
    fix, options, pattern = BAD[name]
    pattern = pattern.replace("x|y|z", "x.y.z")
    extra = fix + lumen(options) + "thermo_style custom step c_lumen[1]\n"
    fails(lmp, whole(scenes.single_cell(), extra=extra), "Compute dcm/lumen: .*" + pattern)


def test_mark_needs_marks(lmp, scenes):
    extra = "compute m all dcm/face mark\nfix a all ave/atom 1 1 1 c_m\n"
    fails(lmp, whole(scenes.single_cell(), extra=extra), "Compute dcm/face: value mark needs")


# --- fix dcm/confine hold -------------------------------------------------------------------------


def confined(scenes):
    scene = scenes.hybrid(level=1)
    fix = "fix press all dcm/confine pressure 0.2 over all tau 20 {}\n"
    return scene, fix


def test_confine_holds_its_force(lmp, scenes):
    scene, fix = confined(scenes)
    columns = "id mol type xu yu zu vx vy vz fx fy fz"
    parts = (
        "fix cell all dcm/cell\n" + scene.volume() + fix + scene.motion() + "timestep 1.0\n"
        + scenes.dump(columns, 5) + scenes.thermo(["force=f_press[1]"], 5)
    )  # fmt: skip
    held = lmp(
        scene.head() + scene.cortex() + scene.contact() + parts.format("")
        + "run 20\nfix_modify press hold yes\nrestart 10 r.*\nrun 20\n"
        + "fix_modify press hold no\nrun 10\n"
    )  # fmt: skip
    force = [[row["v_force"] for row in run] for run in held.runs]
    assert len(set(force[0])) > 3 and force[0][-1] > 0.0
    assert set(force[1]) == {force[0][-1]}
    assert len(set(force[2])) > 2
    # restart files know of it
    rest = lmp(
        "read_restart r.30\n" + f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
        + parts.format("") + "restart 10 r.*\nrun 10\n",
        files={"r.30": held.path / "r.30"},
    )  # fmt: skip
    assert {row["v_force"] for row in rest.thermo} == {force[0][-1]}
    same(held.dump()[8], rest.dump()[-1], columns)
    # from the beginning: no force at all
    never = lmp(
        scene.head() + scene.cortex() + scene.contact() + parts.format("hold yes") + "run 10\n"
    )
    assert {row["v_force"] for row in never.thermo} == {0.0}


def test_confine_hold_is_checked(lmp, scenes):
    scene, fix = confined(scenes)
    fails(lmp, whole(scene, extra=fix.format("hold x")), "Fix dcm/confine: hold must be no or yes")
    plane = "fix press all dcm/confine plane z 10 {}\n"
    fails(lmp, whole(scene, extra=plane.format("hold yes")), "keyword hold needs keyword pressure")
    modify = "fix_modify press hold "
    fails(lmp, whole(scene, extra=fix.format("") + modify + "x\n"), "hold must be yes or no, not x")
    fails(
        lmp, whole(scene, extra=plane.format("") + modify + "yes\n"), "hold needs keyword pressure"
    )
