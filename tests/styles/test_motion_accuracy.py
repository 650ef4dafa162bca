"""fix dcm/motion accuracy: steps chosen so that a run keeps a relative accuracy."""

import numpy as np
import pytest

from support.bad_decks import fails

G_ECM = 1.0    # of support/parameters.py
RATE = 0.01    # 1/s


def relaxing(lmp, scenes, accuracy, more=""):
    """A sphere on a spring without anything else: z falls as exp(-RATE t). No style asks for
    spheres in the table of cells. Returns times and z/z0."""
    radius, z0 = 5.0, 4.0
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(0.0, 0.0, z0, radius)
    K = RATE * G_ECM * 4.0 * np.pi * radius**2
    result = lmp(
        scene.head() + "fix cell all dcm/cell\n" + f"fix plane all dcm/confine plane z {K!r}\n"
        + scene.motion(options=f"scheme implicit accuracy {accuracy} dt auto max 1000 "
                       f"stop 400 maxmove 1 {more}")
        + scenes.dump("id type z", 1) + scenes.thermo(["s=time", "h=dt"], 1)
        + "timestep 0.01\nrun 1000000\n")  # fmt: skip
    times = np.array([row["v_s"] for row in result.thermo])
    z = np.array([frame["z"][0] for frame in result.dump()])
    return times, z / z0


@pytest.mark.parametrize("accuracy", [0.1, 0.02, 0.005])
def test_keeps_what_it_promises_of_a_relaxation(lmp, scenes, accuracy):
    """Backward Euler in closed form: the motion of a mode is off by h rate/2, which is A, of what
    there was to move at most."""
    times, z = relaxing(lmp, scenes, accuracy)
    assert times[-1] == pytest.approx(400.0)
    off = np.abs(z - np.exp(-RATE * times)).max()
    assert off < accuracy
    assert off > 0.02 * accuracy    # nor is it far more exact than asked, which would cost time


def test_more_accurate_takes_more_steps(lmp, scenes):
    """Steps are as long as 2 A / rate where the relaxation bounds them: of half the accuracy, twice
    as many."""
    number = [len(relaxing(lmp, scenes, accuracy)[0]) for accuracy in (0.02, 0.01, 0.005)]
    for coarse, fine in zip(number, number[1:]):
        assert 1.4 < fine / coarse < 2.4, number


def deck(scenes, options, level=1, contact=""):
    scene = scenes.doublet(level=level)
    return scene.head() + scene.forces(contact) + scene.motion(options=options) + "run 0\n"


def test_says_what_it_chose(lmp, scenes):
    log = lmp(deck(scenes, "scheme implicit accuracy 0.04")).log
    assert "accuracy 0.04, for cells of radius" in log and "solver tolerance 0.002" in log
    log = lmp(deck(scenes, "scheme implicit accuracy 0.04 tolerance 1e-6")).log
    assert "solver tolerance 1e-06" in log


@pytest.mark.parametrize("options", ["accuracy 0.04", "dt auto tol 0.02"])
def test_timestep_may_come_after_the_fix(lmp, scenes, options):
    """Without max the longest step is sixty times the deck's timestep, wherever that stands."""
    scene = scenes.doublet()
    end = lmp(scene.head() + scene.forces() + scene.motion(options=f"scheme implicit {options}")
              + scenes.thermo(["h=dt"], 1) + "timestep 2.0\nrun 1\n")
    assert end.thermo[0]["v_h"] >= 2.0
    if "accuracy" in options:
        assert "steps of 2 to 120" in end.log


def test_warns_of_a_mesh_that_does_not_hold_it(lmp, scenes):
    """Errors of a mesh are inverse to its nodes: 42 leave four times what 162 do."""
    coarse, fine = (lmp(deck(scenes, "scheme implicit accuracy 0.05", level)).log
                    for level in (1, 2))
    assert "the mesh does not hold accuracy 0.05: cells of 42 nodes" in coarse
    assert "130 nodes would do" in coarse
    assert "does not hold" not in fine


def test_warns_of_a_range_that_does_not_hold_it(lmp, scenes):
    text = "the range of adhesion h0 0.05 does not hold accuracy 0.05"
    assert text in lmp(deck(scenes, "scheme implicit accuracy 0.05", 2, "h0 0.05")).log
    assert text not in lmp(deck(scenes, "scheme implicit accuracy 0.05", 2, "h0 0.4")).log


BAD = {
    "explicit": ("accuracy 0.02 scheme explicit", "does not go with scheme explicit"),
    "tol as well": ("scheme implicit accuracy 0.02 dt auto tol 0.1", "chooses tol of dt auto"),
    "zero": ("accuracy 0", "accuracy"),
    "large": ("accuracy 0.5", "at most 0.2"),
    "word": ("accuracy much", "accuracy"),
    "shrink": ("scheme implicit accuracy 0.02 maxmove 0.2 shrink", "shortens steps by itself"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_arguments(lmp, scenes, name):
    options, text = BAD[name]
    fails(lmp, deck(scenes, options), text)
