"""Cells that are near each other, found by bins: against a look at every pair."""

import re

import numpy as np
import pytest

BOX = np.array([40.0, 27.0, 33.0])  # half lengths
RADIUS = 2.0


def place_cells(n, boundary, seed=11, apart=4.5):
    """n random places, none closer than `apart`; some at periodic borders and corners."""
    random = np.random.default_rng(seed)
    room = np.where([b == "p" for b in boundary.split()], BOX, BOX - 4.0)
    places = [room * 0.999, room * [-0.999, 0.999, 0.0], room * [0.3, -0.999, 0.999]]
    while len(places) < n:
        x = random.uniform(-1, 1, 3) * room
        if distances(np.array([*places, x]), boundary)[-1, :-1].min() > apart:
            places.append(x)
    return np.array(places)


def distances(x, boundary):
    d = x[:, None] - x[None]
    for k, b in enumerate(boundary.split()):
        if b == "p":
            d[:, :, k] -= 2 * BOX[k] * np.round(d[:, :, k] / (2 * BOX[k]))
    return np.linalg.norm(d, axis=2)


@pytest.mark.parametrize("np_", [1, 4])
@pytest.mark.parametrize("boundary", ["p p p", "f p f"])
@pytest.mark.parametrize("reach", [(6.0, 9.0), (12.0, 16.0), (24.0, 26.9)])
def test_convert_near(lmp, scenes, reach, boundary, np_):
    """60 spheres; near 5 of them they become deformable, near others stay so or go back."""
    n, (d1, d2) = 60, reach
    x = place_cells(n, boundary)
    d = distances(x, boundary)
    assert np.abs(d - d1).min() > 1e-6 and np.abs(d - d2).min() > 1e-6
    scene = scenes.Scene(BOX, boundary)
    for place in x:
        scene.cbm(*place, RADIUS)
    seeds = ([1, 2, 3, 20, 40], [2, 50])
    deck = (
        scene.head()
        + scene.cortex()
        + "comm_modify cutoff 8\nfix cell all dcm/cell\n"
        + scene.volume()
        + f"group seed molecule {' '.join(map(str, seeds[0]))}\n"
        + f"fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 near seed {d1} {d2} every 2 "
        + "mesh icosphere 1\ntimestep 1.0\ngroup cells type 1 4\n"
        + scenes.dump("id mol type x y z", 2, "cells.txt")
        + "run 2\ngroup seed clear\n"
        + f"group seed molecule {' '.join(map(str, seeds[1]))}\nrun 2\n"
    )
    frames = lmp(deck, np=np_).dump("cells.txt")
    deformable = np.zeros(n, dtype=bool)
    changes = 0
    for frame, group in zip(frames[1:], seeds, strict=True):
        nearest = d[:, np.array(group) - 1].min(axis=1)
        before = deformable
        deformable = np.where(nearest < d1, True, np.where(nearest > d2, False, deformable))
        changes += (before & ~deformable).sum()
        assert set(frame["mol"][frame["type"] == 1]) == set(np.flatnonzero(deformable) + 1)
        assert set(frame["mol"][frame["type"] == 4]) == set(np.flatnonzero(~deformable) + 1)
    assert deformable.any() and changes > 0  # both ways


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("boundary", ["p p p", "f f p", "f f f"])
def test_overlaps_at_the_start(lmp, scenes, boundary, np_):
    """Pairs of spheres closer than the sum of radii less half the smaller one are counted."""
    n = 80
    x = place_cells(n, boundary, seed=3, apart=1.0)
    radius = np.random.default_rng(4).uniform(3.0, 8.0, n)
    limit = radius[:, None] + radius[None] - 0.5 * np.minimum(radius[:, None], radius[None])
    d = distances(x, boundary)
    pairs = np.triu(d < limit, 1)
    assert np.abs(d - limit)[np.triu_indices(n, 1)].min() > 1e-9
    across = pairs & ~(distances(x, "f f f") < limit)
    assert (across.sum() > 0) == ("p" in boundary) and pairs.sum() > 30
    scene = scenes.Scene(BOX, boundary)
    for place, R in zip(x, radius, strict=True):
        scene.cbm(*place, R)
    deck = scene.head() + scene.contact().replace("neighbor 0.6", "neighbor 1.0") + "run 0\n"
    result = lmp(deck, np=np_)
    counted = re.search(r"dcm/contact: (\d+) pairs of center-based cells start with", result.log)
    assert int(counted.group(1)) == pairs.sum()


@pytest.mark.parametrize("border", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (1, 0, 1)])
def test_deformable_cells_inside_each_other_across_a_border(lmp, scenes, border):
    """Refused at the start; half a radius farther apart they may run."""
    u = np.array(border) / np.linalg.norm(border)
    for apart, fine in ((6.0, False), (11.5, True)):
        scene = scenes.Scene(BOX, "p p p")
        corner = BOX * border
        scene.dcm(*(corner - (apart - 0.5) * u), 6.0)
        wrapped = corner + 0.5 * u
        scene.dcm(*(wrapped - 2 * BOX * border), 6.0)
        scene.cbm(0.0, 0.0, 0.0, 6.0)
        deck = scene.head() + scene.cortex() + scene.contact() + "fix cell all dcm/cell\n"
        result = lmp.run(deck + scene.volume() + "run 0\n")
        assert (result.returncode == 0) == fine, result.tail()
        if not fine:
            assert re.search("Pair style dcm/contact: cells 1 and 2", result.error), result.error
