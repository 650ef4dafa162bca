"""Boxes and spheres so large that neighbor bins as small as the faces would fill the memory.

LAMMPS lays bins through the box and all room for ghosts: 600 um to each side of a sphere of radius
300 um, with bins of 1.5 um. Pairs are what counts; the slow list without bins is the reference.
"""

import numpy as np
import pytest

from support.scenes import Scene

RADIUS = 300.0  # um


def large_and_small(boundary="p p p", box=400.0, neighbor="multi"):
    """A sphere, a finely meshed cell and a small sphere that touch, on a diagonal."""
    scene = Scene(box, boundary)
    along = np.array([0.6, -0.48, 0.64])
    scene.cbm(0.0, 0.0, 0.0, RADIUS)
    scene.dcm(*((RADIUS + 5.9) * along), 6.0, level=2)
    scene.cbm(*((RADIUS + 16.8) * along), 5.0)
    return (
        scene.head()
        + scene.forces().replace("neighbor 0.6 multi", f"neighbor 3.0 {neighbor}")
        + scene.motion()
        + "timestep 0.1\n"
    )


def last(scenes, steps=4):
    return scenes.dump(every=steps) + "thermo 1\n" + f"run {steps}\n"


@pytest.mark.parametrize("boundary", ["p p p", "f f f"])
@pytest.mark.parametrize("np_", [1, 2, 4])
def test_bins_fit_into_the_memory(lmp, scenes, boundary, np_):
    """The same forces and positions as without bins."""
    slow = lmp(large_and_small(boundary, neighbor="nsq") + last(scenes)).dump()[-1]
    result = lmp(large_and_small(boundary) + last(scenes), np=np_)
    fast = result.dump()[-1]
    assert "Pair style dcm/contact: neighbor bins of at least" in result.log
    touched = np.abs(slow.f).max(axis=1) > 1e-6
    assert touched[0] and touched[-1]  # both spheres
    assert np.abs(fast.x - slow.x).max() < 1e-9
    assert np.abs(fast.f - slow.f).max() < 1e-9 * np.abs(slow.f).max()


def test_bins_of_one_size(lmp, scenes):
    """Cells far apart in a box of 20 mm, neighbor style bin."""

    def pair(box, at=0.0):
        scene = Scene(box, "p p p")
        scene.dcm(at - 5.95, at, at, 6.0)
        scene.dcm(at + 5.95, at, at, 6.0)
        text = scene.forces().replace("0.6 multi", "0.6 bin")
        return scene.head() + text + scene.motion() + "timestep 0.1\n" + last(scenes)

    wide, usual = lmp(pair(10000.0, 9000.0)), lmp(pair(20.0))
    assert "neighbor bins of at least" in wide.log
    assert "neighbor bins of at least" not in usual.log
    a, b = wide.dump()[-1], usual.dump()[-1]
    assert np.abs(b.f).max() > 0.01
    assert np.abs(a.f - b.f).max() < 1e-9
    assert np.abs(a.x - 9000.0 - b.x).max() < 1e-9


def test_a_box_that_will_shrink_counts_as_it_will_be(lmp, scenes):
    """Wide as the deck gives it, but LAMMPS wraps it around the cells before it lays bins."""
    scene = Scene(10000.0, "s s s")
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    result = lmp(scene.head() + scene.forces() + scene.motion() + "timestep 0.1\nrun 2\n")
    assert "neighbor bins of at least" not in result.log


def test_restart_keeps_the_size(lmp, scenes):
    """Bit for bit, though the list depends on the bins."""
    deck = large_and_small()
    whole = lmp(deck + "restart 5 half.*.restart\n" + last(scenes, 10))
    fixes = deck[deck.index("fix cell") :]
    again = (
        "read_restart half.5.restart\nneighbor 3.0 multi\n"
        f"pair_coeff * * {Scene().map}\n{fixes}{scenes.dump(every=10)}"
        "restart 5 half.*.restart\nrun 5\n"  # lists are rebuilt where a restart is written
    )
    half = whole.path / "half.5.restart"
    one, two = (r.dump()[-1] for r in (whole, lmp(again, files={"half.5.restart": half})))
    assert one.step == two.step == 10
    assert (one.x == two.x).all() and (one.f == two.f).all()
