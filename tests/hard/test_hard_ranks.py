"""Boxes that follow the cells and begin far too large: the same run on any number of ranks. The
first shrink moves sub-domains by more than one, and LAMMPS hands atoms to the next rank only."""

import numpy as np
import pytest


def deck(scene, scenes, more="run 2\n", **parts):
    spheres_only = not any(" dcm " in cell.split("dcm hep")[0] for cell in scene.cells)
    forces = scene.contact() + "fix cell all dcm/cell\n" if spheres_only else scene.forces()
    return (
        scene.head() + parts.get("extra", "") + forces + scene.motion() + "timestep 0.5\n"
        + scenes.thermo(["atoms", "pe", "lx"]) + more
    )  # fmt: skip


def doublet_at(scenes, x, box):
    scene = scenes.Scene(box, "s s s")
    scene.dcm(x - 5.95, 0.0, 0.0, 6.0)
    scene.dcm(x + 5.95, 0.0, 0.0, 6.0)
    return scene


def aside(scenes):
    return doublet_at(scenes, -40.0, (60.0, 20.0, 20.0))


def middle(scenes):
    return doublet_at(scenes, 0.0, 20.0)


def far_in_a_huge_box(scenes):
    return doublet_at(scenes, 150.0, 200.0)


def minimum_boundary(scenes):
    scene = aside(scenes)
    scene.boundary = "m s s"
    return scene


def spheres(scenes):
    scene = scenes.Scene((60.0, 20.0, 20.0), "s s s")
    for x in np.arange(-55.0, -20.0, 7.9):
        for y in (0.0, 7.9):
            for z in (0.0, 7.9):
                scene.cbm(x, y, z, 4.0)
    return scene


@pytest.fixture(scope="module")
def alone(lmp_module, scenes):
    """Thermo of each scene on one rank."""
    kept = {}

    def run(make):
        if make not in kept:
            kept[make] = lmp_module(deck(make(scenes), scenes)).thermo
        return kept[make]

    return run


@pytest.mark.parametrize("np_", [3, 4, 5])
@pytest.mark.parametrize("make", [aside, middle, far_in_a_huge_box, minimum_boundary, spheres])
def test_box_shrinks_far(lmp, scenes, alone, make, np_):
    one, many = alone(make), lmp(deck(make(scenes), scenes), np=np_).thermo
    for a, b in zip(one, many, strict=True):
        assert b["Atoms"] == a["Atoms"]
        assert b["PotEng"] == pytest.approx(a["PotEng"], rel=1e-8)
        assert b["Lx"] == pytest.approx(a["Lx"], rel=1e-10)


@pytest.mark.parametrize("np_", [4, 5])
def test_box_shrinks_between_runs(lmp, scenes, np_):
    """The far cells are deleted, and the box follows the others."""
    scene = scenes.Scene((60.0, 20.0, 20.0), "s s s")
    for x in (-45.95, -34.05, 50.0):
        scene.dcm(x, 0.0, 0.0, 6.0)
    more = (
        "run 2\ngroup g molecule 3\ndelete_atoms group g bond yes compress no\nrun 2\n"
        "write_restart end.restart\nwrite_data end.data\n"
    )
    one, many = (lmp(deck(scene, scenes, more), np=np_or_1).thermo for np_or_1 in (1, np_))
    assert one[-1]["Lx"] < 0.3 * one[0]["Lx"]
    for a, b in zip(one, many, strict=True):
        assert b["Atoms"] == a["Atoms"]
        assert b["PotEng"] == pytest.approx(a["PotEng"], rel=1e-8)


def test_restart_in_a_shrunk_box(lmp, scenes):
    """Bit for bit on the same ranks, memory of contacts of spheres included."""
    scene = spheres(scenes)
    tail = scenes.dump(every=10) + "run 10\n"
    whole = lmp(deck(scene, scenes, "run 10\nwrite_restart a.restart\n" + tail), np=4)
    rest = (
        "read_restart a.restart\n" + scene.contact() + "fix cell all dcm/cell\n" + scene.motion()
        + "timestep 0.5\n" + scenes.thermo(["atoms", "pe", "lx"]) + tail
    )  # fmt: skip
    again = lmp(rest, np=4, files={"a.restart": whole.path / "a.restart"})
    assert np.array_equal(whole.dump()[-1].x, again.dump()[-1].x)
    # not the box, which follows the atoms when lists are built
    for name in ("Atoms", "PotEng"):
        assert whole.thermo[-1][name] == again.thermo[-1][name]
