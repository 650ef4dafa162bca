"""Data files without image flags, or with wrong ones: cells across a periodic border."""

import re

import numpy as np
import pytest

PLACE = np.array([19.5, -19.0, 19.9])  # a cell of radius 6 in a box of +-20: across three borders


def without_flags(text, change):
    """The rows of the section Atoms with other image flags, or none."""
    head, body, tail = re.fullmatch(r"(.*\nAtoms[^\n]*\n\n)(.*?)(\n\n.*)", text, re.S).groups()
    rows = [change(line.split()) for line in body.splitlines()]
    return head + "\n".join(" ".join(row) for row in rows) + tail


FLAGS = {
    "none": lambda words: words[:13],
    "zero": lambda words: [*words[:13], "0", "0", "0"],
    "of each atom its own": lambda words: [*words[:13], str(int(words[0]) % 3 - 1), "1", "-2"],
}


@pytest.fixture(scope="module")
def data(lmp_module, scenes):
    scene = scenes.Scene(20.0, "p p p")
    scene.dcm(*PLACE, 6.0)
    deck = scene.head() + scene.forces() + scene.motion() + "run 0\nwrite_data w.data nocoeff\n"
    return (lmp_module(deck).path / "w.data").read_text()


def reading(scenes, extra, run):
    scene = scenes.Scene()
    forces = scene.forces().replace("neighbor 0.6", "neighbor 1.0")  # necks of spheres that come
    extras = "extra/bond/per/atom 8 extra/dihedral/per/atom 8"
    head = f"units lj\natom_style dcm\nnewton on\nboundary p p p\nread_data w.data {extras}\n"
    return head + forces + extra.format(map=scene.map) + scene.motion() + run


CONVERT = (
    "variable s atom -1\n"
    "fix conv all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_s mesh icosphere 1 every 1\n"
)


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("flags", FLAGS)
def test_conversion(lmp, scenes, data, flags, np_):
    """The sphere has the cell's place and its rest volume."""
    run = "timestep 0.01\nrun 1\nwrite_dump all custom d.txt id type x y z radius\n"
    deck = reading(scenes, CONVERT, run)
    files = {"w.data": without_flags(data, FLAGS[flags])}
    frame = lmp(deck, files=files, np=np_).dump("d.txt")[0]
    assert list(frame["type"]) == [4]
    far = frame.vectors("x", "y", "z")[0] - PLACE
    far -= 40.0 * np.round(far / 40.0)
    # rest volume: that of the ball of radius 6, whose volume the mesh has; place: the mean node
    # moves by the rounding of the data file and one short step only
    assert np.linalg.norm(far) < 1e-3
    assert frame["radius"][0] == pytest.approx(6.0, rel=1e-6)


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("flags", FLAGS)
def test_division(lmp, scenes, data, flags, np_):
    """Daughters lie at their mother's place, as with the right flags."""
    extra = (
        "fix grow all dcm/growth {map} seed 3 cycle_time 10 rounding 0 1\n"
        "fix divide all dcm/division seed 5\n"
    )
    run = "timestep 0.5\nrun 30\nwrite_dump all custom d.txt id mol type x y z\n"
    deck = reading(scenes, extra, run)
    files = {"w.data": without_flags(data, FLAGS[flags])}
    frame = lmp(deck, files=files, np=np_).dump("d.txt")[0]
    flagged = lmp(deck, files={"w.data": data}).dump("d.txt")[0]
    cells = set(frame["mol"])
    assert len(cells) >= 2 and 1 not in cells
    # all atoms of all daughters are within a mother's diameter of her place
    far = frame.vectors("x", "y", "z") - PLACE
    far -= 40.0 * np.round(far / 40.0)
    assert np.linalg.norm(far, axis=1).max() < 2 * 6.0 * 2 ** (1 / 3)
    # and where they are with the right flags, but for the tolerances of solver and division
    assert list(frame["mol"]) == list(flagged["mol"])
    off = frame.vectors("x", "y", "z") - flagged.vectors("x", "y", "z")
    off -= 40.0 * np.round(off / 40.0)
    assert np.abs(off).max() < 0.01
