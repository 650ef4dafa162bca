"""Divisions every N steps; atom IDs of new cells, also from a data file with IDs in disorder."""

import re

import numpy as np
import pytest

from lammps_dcm import read_deaths, read_divisions
from support.cycle_decks import counting, growth, same
from support.data_files import section

SIZE = 1 + 42 + 80  # atoms of a deformable cell of an icosphere of level 1
CENTER, NODE, FACE = 2, 3, 4


# --- every ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("every", [1, 15, 40])
def test_spheres_divide_every(lmp, scenes, every):
    """Ready after 40 steps, they divide at the next multiple and begin anew there."""
    deck = counting(3, "cycle_time 40") + f"fix division all dcm/division seed 4 every {every} "
    deck += "log division.log\n" + scenes.thermo(["n=f_growth", "ready=f_growth[3]"])
    result = lmp(deck + "run 130\n")
    period = -(-40 // every) * every  # 40, 45 or 40
    for row in result.thermo:
        step = int(row["Step"])
        assert row["v_n"] == 3 * 2 ** (step // period)
        assert row["v_ready"] == (row["v_n"] if step and step % period >= 40 else 0)
    log = read_divisions(result.path / "division.log")
    assert sorted(set(log.step)) == [period * k for k in range(1, 130 // period + 1)]
    assert set(np.asarray(log.step) % every) == {0}
    assert list(log.mother) == list(range(1, len(log) + 1))


def test_deformable_cells_divide_every(lmp, scenes):
    """Two that are ready at steps 30 and 40 both divide at 50, as they do one by one otherwise."""
    rows = {}
    for every in (1, 25):
        scene = scenes.Scene(25.0, "f f f")
        scene.dcm(-8.0, 0.0, 0.0, 6.0)
        scene.dcm(8.0, 0.0, 0.0, 6.0)
        deck = scene.head() + scene.cortex() + scene.contact().replace("0.6", "0.8")
        deck += "fix cell all dcm/cell\n" + scene.volume()
        deck += growth(scene, "cycle_time 40 newborn 700")
        # V0 = 4 pi/3 6^3 = 905: at s = 0.29 of growth, full-grown after 0.71 of 0.95 of 40 steps
        deck += f"fix division all dcm/division seed 4 every {every} log division.log\n"
        deck += scene.motion(options="") + "timestep 1.0\ngroup centers type 1\n"
        deck += "compute of centers dcm/cell volume0 rounding_factor phase\n"
        deck += scenes.dump("id mol c_of[1] c_of[2] c_of[3]", 1, "cells.txt", "centers")
        result = lmp(deck + "run 50\n")
        rows[every] = read_divisions(result.path / "division.log"), result.dump("cells.txt")
    grown = (4 / 3 * np.pi * 6.0**3 - 700) / 700
    ready = int(np.ceil(40 - 0.95 * 40 * grown - 1e-9))
    assert ready < 49
    log, frames = rows[1]
    assert list(log.step) == [ready] * 2
    log, frames = rows[25]
    assert list(log.step) == [25 * -(-ready // 25)] * 2 == [50, 50]
    assert list(log.mother) == [1, 2] and list(log.generation) == [1, 1]
    for frame in frames:
        if ready <= frame.step < 50:  # round, full-grown and ready all the time
            assert list(frame["c_of[3]"]) == [2, 2]
            assert frame["c_of[2]"] == pytest.approx([0.95, 0.95], rel=1e-12)
            assert frame["c_of[1]"] == pytest.approx([1400.0] * 2, rel=1e-9)
    assert list(frames[-1]["mol"]) == [3, 4, 5, 6]
    assert frames[-1]["c_of[1]"] == pytest.approx([700.0] * 4, rel=1e-9)


# --- atom IDs -------------------------------------------------------------------------------------


def lowest(used, n):
    """First of n free IDs in a row."""
    first = 1
    while any(first + k in used for k in range(n)):
        first += 1
    return first


def disordered(lmp, scenes, order):
    """Data file of three deformable cells and five spheres; `order` gives their atom IDs."""
    scene = scenes.Scene((30.0, 15.0, 15.0), "f f f")
    for x in (-18.0, 0.0, 18.0):
        scene.dcm(x, 0.0, 0.0, 6.0)
        scene.cbm(x, 0.0, 11.5, 3.0)
    scene.cbm(9.0, 10.0, 0.0, 3.0)
    scene.cbm(-9.0, 10.0, 0.0, 3.0)
    text = (lmp(scene.head() + "write_data x.data nofix nocoeff\n").path / "x.data").read_text()
    number = int(re.search(r"(\d+) atoms", text).group(1))
    assert number == 3 * SIZE + 5
    new = dict(zip(range(1, number + 1), order(number), strict=True))
    assert len(set(new.values())) == number

    def rewrite(title, change):
        nonlocal text
        lines = section(text.replace(f"{title}\n", title.split()[0] + "\n"), title.split()[0])
        rows = "\n".join(" ".join(map(str, change(line.split()))) for line in lines)
        start, _, rest = text.partition(f"{title}\n\n")
        text = f"{start}{title}\n\n{rows}\n\n" + rest.partition("\n\n")[2]

    def atom(w):
        if int(w[3]) == FACE:
            w[8:11] = [new[int(v)] for v in w[8:11]]
        return [new[int(w[0])], *w[1:]]

    rewrite("Atoms # dcm", atom)
    if "Velocities" in text:
        rewrite("Velocities", lambda w: [new[int(w[0])], *w[1:]])
    rewrite("Bonds", lambda w: [*w[:2], *(new[int(v)] for v in w[2:])])
    rewrite("Dihedrals", lambda w: [*w[:2], *(new[int(v)] for v in w[2:])])
    return scene, text, new


def shuffled(n):
    """In disorder, with gaps and one free row of 130 from 41 on."""
    pool = [k for k in range(5, 1000) if not 41 <= k < 171]
    return np.random.default_rng(5).permutation(pool)[:n].tolist()


def with_gaps(n):
    """Each cell in a row, but with room between them: the center's ID is the lowest."""
    ids, at = [], 1
    for k in range(n):
        if k in (SIZE + 1, 2 * SIZE + 2):
            at += 300 if k == SIZE + 1 else 40
        ids.append(at)
        at += 1
    return ids


def backward(n):
    """Each cell in a row, its center last."""
    return list(range(n + 7, 7, -1))


@pytest.mark.parametrize("order", [shuffled, with_gaps, backward])
@pytest.mark.parametrize("np_", [1, 2, 4])
def test_lowest_free_ids(lmp, scenes, order, np_):
    """Step 10: cell 3 and its sphere die. Step 30: cell 1 divides. The lowest rows are taken."""
    scene, data, new = disordered(lmp, scenes, order)
    deck = (
        "units lj\natom_style dcm\nnewton on\nboundary f f f\n"
        "read_data x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
        + scene.cortex()
        + "comm_modify cutoff 14\nfix cell all dcm/cell\n"
        + scene.volume()
        + "group one molecule 1\n"
        + growth(scene, "cycle_time 30", "one")
        + "fix division all dcm/division seed 4 log division.log\n"
        + "group two molecule 3 4\nfix death two dcm/death all every 10\n"
        + scene.motion(options="")
        + "timestep 1.0\ncompute p all property/atom kind vertex1 vertex2 vertex3\n"
        + scenes.dump("id mol type x y z c_p[1] c_p[2] c_p[3] c_p[4]", 10)
        + "run 40\nwrite_data out.data nofix nocoeff\n"
    )
    result = lmp(deck, np=np_, files={"x.data": data})
    frames = {frame.step: frame for frame in result.dump()}
    assert set(frames[0]["id"].astype(int)) == set(new.values())
    assert set(frames[10]["mol"]) == {1, 2, 5, 6, 7, 8}
    used = set(frames[20]["id"][frames[20]["mol"] != 1].astype(int))
    assert used == {int(t) for t, m in zip(frames[0]["id"], frames[0]["mol"]) if m not in (1, 3, 4)}
    after = frames[30]
    tags = after["id"].astype(int)
    assert len(set(tags)) == len(tags) == 2 * SIZE + SIZE + 4
    for molecule in (9, 10):
        first = lowest(used, SIZE)
        row = set(range(first, first + SIZE))
        mine = after["mol"] == molecule
        assert set(tags[mine]) == row
        assert tags[mine & (after["c_p[1]"] == CENTER)] == [first]
        nodes = set(tags[mine & (after["c_p[1]"] == NODE)])
        faces = mine & (after["c_p[1]"] == FACE)
        corners = after.vectors("c_p[2]", "c_p[3]", "c_p[4]")[faces].astype(int)
        assert set(corners.ravel()) == nodes and len(nodes) == 42
        used |= row
    # who took no part keeps its IDs
    old, now = ({int(m): set() for m in after["mol"]} for _ in range(2))
    for frame, sets in ((frames[0], old), (frames[40], now)):
        for t, m in zip(frame["id"].astype(int), frame["mol"].astype(int), strict=True):
            sets.setdefault(m, set()).add(t)
    for molecule in (2, 5, 6, 7, 8):
        assert now[molecule] == old[molecule]
    head = (result.path / "out.data").read_text().partition("Atoms")[0]
    count = {w[1]: int(w[0]) for w in map(str.split, head.splitlines()) if len(w) == 2}
    assert (count["atoms"], count["bonds"], count["dihedrals"]) == (3 * SIZE + 4, 360, 360)


def test_ids_of_many_deaths_and_divisions_on_ranks(lmp, scenes):
    """The same IDs on any number of ranks, from a data file in disorder."""
    scene, data, _ = disordered(lmp, scenes, shuffled)
    deck = (
        "units lj\natom_style dcm\nnewton on\nboundary f f f\n"
        "read_data x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
        + scene.cortex()
        + "comm_modify cutoff 14\nfix cell all dcm/cell\n"
        + scene.volume()
        + growth(scene, "cycle_time 20 cycle_sd 4")
        + "fix division all dcm/division seed 4\n"
        + "variable odd atom mol>8&&mol%3==0\n"
        + "fix death all dcm/death variable v_odd log death.log\n"
        + scene.motion(options="tolerance 1e-12")
        + "timestep 1.0\n"
        + scenes.dump("id mol type", 5)
        + "run 45\n"
    )
    one = lmp(deck, files={"x.data": data})
    assert len(read_deaths(one.path / "death.log")) > 4
    for np_ in (2, 4):
        other = lmp(deck, np=np_, files={"x.data": data})
        for a, b in zip(one.dump(), other.dump(), strict=True):
            same(a, b, "id mol type")
            assert len(set(a["id"])) == len(a["id"])


@pytest.mark.parametrize("np_", [1, 3])
def test_data_file_without_image_flags(lmp, scenes, np_):
    """They are optional: a cell across a periodic corner divides as it does with them."""
    scene = scenes.Scene(15.0, "p p p")
    scene.dcm(14.0, -14.5, 14.2, 6.0)
    data = (lmp(scene.head() + "write_data x.data nofix nocoeff\n").path / "x.data").read_text()
    start, _, rest = data.partition("Atoms # dcm\n\n")
    atoms, _, rest = rest.partition("\n\n")
    flags = {tuple(line.split()[-3:]) for line in atoms.splitlines()}
    assert len(flags) == 8  # it lies in all eight corners of the box
    bare = "\n".join(" ".join(line.split()[:-3]) for line in atoms.splitlines())
    deck = (
        "units lj\natom_style dcm\nnewton on\nboundary p p p\n"
        "read_data x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
        + scene.cortex()
        + "comm_modify cutoff 14\nfix cell all dcm/cell\n"
        + scene.volume()
        + growth(scene, "cycle_time 20")
        + "fix division all dcm/division seed 4 plane given 1 0 0 log division.log\n"
        + scene.motion(options="tolerance 1e-10")
        + "timestep 1.0\n"
        + scenes.dump("id mol type x y z", 21)
        + "run 21\n"
    )
    with_flags = lmp(deck, np=np_, files={"x.data": data})
    without = lmp(deck, np=np_, files={"x.data": f"{start}Atoms # dcm\n\n{bare}\n\n{rest}"})
    a, b = (read_divisions(r.path / "division.log") for r in (with_flags, without))
    assert len(a) == len(b) == 1
    assert b.volume == pytest.approx(a.volume, rel=1e-9)
    first, second = (r.dump()[-1] for r in (with_flags, without))
    assert len(first["id"]) == len(second["id"]) == 2 * SIZE
    apart = first.vectors("x", "y", "z") - second.vectors("x", "y", "z")
    assert np.abs(apart - 30.0 * np.round(apart / 30.0)).max() < 1e-6
