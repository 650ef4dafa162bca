"""compute dcm/contact/local through the real lmp: the pairs of cells in contact."""

import math
import re
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import brentq

from support.bad_decks import fails
from support.scenes import Scene, dump, hybrid, thermo

VALUES = "molecule1 molecule2 area force fx fy fz normal"
SPHERES = "E_contact 5 nu_contact 0.5 W 0.1"
RANKS = [1, 2, 3, 4]


def local(values=VALUES, group="all", every=1, file="pairs", compute="pairs"):
    """The compute and its dump, every number exact."""
    columns = f"c_{compute}[*]" if " " in values else f"c_{compute}"
    return (
        f"compute {compute} {group} dcm/contact/local {values}\n"
        f"dump {file} all local {every} {file} {columns}\n"
        f"dump_modify {file} format float %.17g\n"
    )


def read_pairs(result, file="pairs", values=VALUES):
    """Per frame: step -> dict of (first, second) -> dict of values; each pair may be there once."""
    text = (result.path / file).read_text()
    frames = {}
    for block in text.split("ITEM: TIMESTEP\n")[1:]:
        lines = block.splitlines()
        head = next(k for k, line in enumerate(lines) if line.startswith("ITEM: ENTRIES"))
        rows = [dict(zip(values.split(), map(float, line.split()))) for line in lines[head + 1 :]]
        assert len(rows) == int(lines[2])
        keys = [(int(row["molecule1"]), int(row["molecule2"])) for row in rows]
        assert len(set(keys)) == len(keys), "a pair is listed twice"
        assert all(a < b for a, b in keys)
        frames[int(lines[0])] = dict(zip(keys, rows))
    return frames


def force(row):
    return np.array([row["fx"], row["fy"], row["fz"]])


def jkr(E, R, W, delta):
    """Contact radius and force of Johnson, Kendall and Roberts, by bisection of their equations."""

    def overlap(a):
        return a * a / R - math.sqrt(2 * math.pi * W * a / E)

    fold = (math.pi * W * R * R / (8 * E)) ** (1 / 3)  # least overlap
    a = brentq(lambda a: overlap(a) - delta, fold, 10 * R, xtol=1e-15, rtol=1e-14)
    return a, 4 * E * a**3 / (3 * R) - math.sqrt(8 * math.pi * W * E * a**3)


# --- closed form, periodic images -----------------------------------------------------------------


@pytest.mark.parametrize("np_", RANKS)
@pytest.mark.parametrize("delta", [0.5, 0.01])  # they push; they pull
def test_two_spheres_across_the_border(lmp, np_, delta):
    # the first is at the upper end of the box, so the second pushes it back, along -x and -y
    R1, R2, W = 3.0, 2.0, 0.1
    scene = Scene(box=12.0, boundary="p p p")
    u = np.array([0.8, 0.6, 0.0])
    a, b = np.array([11.5, 10.0, 1.0]), np.array([11.5, 10.0, 1.0]) + (R1 + R2 - delta) * u
    scene.cbm(*a, R1)
    scene.cbm(*(b - [24, 0, 0] - [0, 24 * (b[1] > 12), 0]), R2)
    scene.cbm(0, 0, -9, 2.0)
    deck = scene.head() + scene.contact(coeff=SPHERES) + local() + "run 0\n"
    pairs = read_pairs(lmp(deck, np=np_))[0]
    assert list(pairs) == [(1, 2)]
    radius, F = jkr(5 / 1.5, R1 * R2 / (R1 + R2), W, delta)
    assert (F > 0.1) == (delta > 0.1) and abs(F) > 0.1
    row = pairs[1, 2]
    assert row["area"] == pytest.approx(math.pi * radius**2, rel=1e-10)
    assert row["normal"] == pytest.approx(F, rel=1e-10)
    assert row["force"] == pytest.approx(abs(F), rel=1e-10)
    assert force(row) == pytest.approx(-F * u, rel=1e-10, abs=1e-12)


# --- all sorts of pairs, against what others say --------------------------------------------------


@pytest.mark.parametrize("np_", RANKS)
@pytest.mark.parametrize("law", ["dmt", "maugis", "foundation"])
def test_areas_and_forces_add_up(lmp, np_, law):
    """Those of each cell: areas to that of compute dcm/cell, forces to the one on its atoms."""
    scene = hybrid(boundary="p p p", shift=(18.0, 20.0, 12.0))  # across three borders
    deck = (
        scene.head()
        + scene.contact(f"law {law}")
        + "fix cell all dcm/cell\ncompute c all dcm/cell molecule contact_area neighbors\n"
        + local()
        + dump("id mol fx fy fz c_c[1] c_c[2] c_c[3]")
        + "run 0\n"
    )
    result = lmp(deck, np=np_)
    pairs, atoms = read_pairs(result)[0], result.dump()[-1]
    kinds = {(a <= 3) + (b <= 3) for a, b in pairs}
    assert kinds == {0, 1, 2}  # deformable cells in the pair
    largest = 0.0
    for cell in range(1, 8):
        own = [(row, 1 if cell == a else -1) for (a, b), row in pairs.items() if cell in (a, b)]
        on_atoms = atoms.f[atoms["mol"] == cell].sum(axis=0)
        total = sum((sign * force(row) for row, sign in own), np.zeros(3))
        here = atoms["c_c[1]"] == cell
        area, neighbors = (atoms[f"c_c[{k}]"][here].item() for k in (2, 3))
        assert sum(row["area"] for row, _ in own) == pytest.approx(area, rel=1e-12)
        assert sum(row["area"] > 0 for row, _ in own) == neighbors
        largest = max([largest, *(row["force"] for row, _ in own)])
        assert total == pytest.approx(on_atoms, abs=1e-11 * largest)
    assert largest > 0.1
    for row in pairs.values():
        assert row["force"] == pytest.approx(np.linalg.norm(force(row)), rel=1e-14)


def test_ranks_agree_and_so_do_steps_that_are_read(lmp):
    """In a run: on 1 to 4 ranks; read in each step, in each fifth, and by compute reduce."""
    scene = hybrid(boundary="p p p", shift=(18.0, 20.0, 12.0))
    deck = (
        scene.head()
        + scene.forces()
        + scene.motion()
        + "timestep 0.5\n"
        + local()
        + "compute sum all reduce sum c_pairs[3] c_pairs[5] inputs local\n"
        + "fix ave all ave/time 5 1 5 c_sum[*] file sums format ' %.17g'\n"
        + "run 12\n"
    )
    first = read_pairs(lmp(deck))
    assert sorted(first) == list(range(13))
    areas = [sum(row["area"] for row in pairs.values()) for pairs in first.values()]
    assert len(set(areas)) == 13 and min(areas) > 1.0
    for np_ in (2, 3, 4):
        result = lmp(deck.replace("local 1 pairs", "local 5 pairs"), np=np_)
        other = read_pairs(result)
        assert sorted(other) == [0, 5, 10]
        for step, pairs in other.items():
            assert set(pairs) == set(first[step])
            for key, row in pairs.items():
                assert row == pytest.approx(first[step][key], rel=1e-6, abs=1e-8), (np_, step, key)
        sums = np.loadtxt(result.path / "sums", ndmin=2)
        assert sums[:, 0].tolist() == [0, 5, 10]
        for step, area, fx in sums:
            rows = list(other[int(step)].values())
            assert area == pytest.approx(sum(row["area"] for row in rows), rel=1e-12)
            assert fx == pytest.approx(sum(row["fx"] for row in rows), rel=1e-9, abs=1e-12)


# --- contacts that come and go --------------------------------------------------------------------


def test_the_last_step_of_a_run_can_be_read(lmp):
    """By a variable between two runs, though nothing announced it; a contact that has ended."""
    scene = Scene(box=15.0, boundary="f f f")
    scene.cbm(-2.9, 0, 0, 3.0)
    scene.cbm(2.9, 0, 0, 3.0)
    deck = (
        scene.head()
        + scene.contact(coeff=SPHERES)
        + "fix cell all dcm/cell\n"
        + scene.motion()
        + "compute area all dcm/contact/local area\n"
        + "compute sum all reduce sum c_area inputs local\n"
        + "group one molecule 1\nthermo_style custom step\ntimestep 1.0\nthermo 100\n"
        + "run 7\nprint \"at $(step) $(c_sum:%.17g)\"\n"
        + "displace_atoms one move -3 0 0\nrun 0\nprint \"at $(step) $(c_sum:%.17g)\"\n"
    )
    rows = [line.split() for line in lmp(deck).out.splitlines() if line.startswith("at ")]
    assert [row[1] for row in rows] == ["7", "7"]
    assert float(rows[0][2]) > 0.1 and float(rows[1][2]) == 0.0
    # the area is that of the place: a run of no steps from there says the same
    same = deck[: deck.index("displace")] + 'run 0\nprint "at $(step) $(c_sum:%.17g)"\n'
    again = [line.split()[2] for line in lmp(same).out.splitlines() if line.startswith("at ")]
    assert float(again[1]) == pytest.approx(float(again[0]), rel=1e-9)
    assert again[0] == rows[0][2]


@pytest.mark.parametrize("np_", [1, 3])
def test_a_pushed_pair_balances(lmp, np_):
    """Two spheres pressed together by a force: at rest their contact bears it."""
    F, R = 1.2, 3.0
    scene = Scene(box=15.0, boundary="f f f")
    scene.cbm(-2.95, 0.5, 0, R)
    scene.cbm(2.95, 0.5, 0, R)
    deck = (
        scene.head()
        + scene.contact(coeff=SPHERES + " friction_normal 1 friction_tangential 1")
        + "fix cell all dcm/cell\ngroup left molecule 1\ngroup right molecule 2\n"
        + f"fix l left addforce {F} 0 0\nfix r right addforce -{F} 0 0\n"
        + scene.motion()
        + local(every=250)
        + "timestep 1.0\nthermo 250\nrun 250\n"
    )
    frames = read_pairs(lmp(deck, np=np_))
    assert abs(frames[0][1, 2]["normal"] - F) > 0.1
    row = frames[250][1, 2]
    assert force(row) == pytest.approx([-F, 0, 0], rel=1e-6, abs=1e-9)
    delta = brentq(lambda d: jkr(5 / 1.5, R / 2, 0.1, d)[1] - F, 0.0, 2.0)
    assert row["area"] == pytest.approx(math.pi * jkr(5 / 1.5, R / 2, 0.1, delta)[0] ** 2, rel=1e-6)


# --- group, columns -------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", RANKS)
def test_pairs_with_a_cell_of_the_group(lmp, np_):
    """Of a row of five cells, and a vector if there is one value."""
    scene = Scene(box=26.0, boundary="f f f")
    for n in range(5):
        scene.cbm(-20 + 9.9 * n, 0, 0, 5.0)
    deck = (
        scene.head()
        + scene.contact(coeff=SPHERES)
        + "group some molecule 2 5\ngroup none empty\n"
        + local()
        + local("molecule1 molecule2", "some", file="some", compute="some")
        + local("molecule1 molecule2", "none", file="none", compute="none")
        + local("molecule2", "some", file="vector", compute="vector")
        + "run 0\n"
    )
    result = lmp(deck, np=np_)
    everyone = read_pairs(result)[0]
    assert sorted(everyone) == [(1, 2), (2, 3), (3, 4), (4, 5)]
    assert sorted(read_pairs(result, "some")[0]) == [(1, 2), (2, 3), (4, 5)]
    assert read_pairs(result, "none")[0] == {}
    lines = (result.path / "vector").read_text().splitlines()
    assert sorted(float(line) for line in lines[9:]) == [2, 3, 5]
    # all contacts are alike
    for one, other in combinations(everyone.values(), 2):
        assert one["area"] == pytest.approx(other["area"], rel=1e-9)


def test_a_run_without_readers_is_the_same(lmp):
    """Recording changes no force, to the last bit."""
    scene = hybrid()
    columns = ["fmax", "pe", "press"]
    deck = scene.head() + scene.forces() + scene.motion() + "timestep 0.5\n"
    end = thermo(columns) + "run 5\n"
    plain, read = lmp(deck + end), lmp(deck + local() + end)
    assert plain.thermo == read.thermo and plain.thermo[0]["Fmax"] > 0


# --- bad input ------------------------------------------------------------------------------------


def two():
    scene = Scene()
    scene.cbm(-2.9, 0, 0, 3.0)
    scene.cbm(2.9, 0, 0, 3.0)
    return scene


@pytest.mark.parametrize(
    "lines, patterns",
    [
        ("compute c all dcm/contact/local", ["dcm/contact/local: no values", "known: molecule1"]),
        ("compute c all dcm/contact/local area aera", ["unknown value aera", "known: molecule1"]),
        (
            "compute c nodes dcm/contact/local area",
            ["dcm/contact/local", "nodes"],
        ),
    ],
)
def test_errors(lmp, lines, patterns):
    scene = hybrid()
    deck = (
        scene.head()
        + "group nodes type 2\n"
        + scene.contact()
        + "fix cell all dcm/cell\n"
        + scene.motion()
    )
    fails(lmp, deck + lines + "\n", *patterns)


def test_needs_the_pair_style(lmp):
    deck = two().head() + "pair_style none\ncomm_modify cutoff 8\n"
    fails(lmp, deck + "compute c all dcm/contact/local area\n", "needs pair_style dcm/contact")


def test_read_in_a_step_that_was_not_recorded(lmp):
    """Fix halt ends a run before its last step: nothing had announced to read this one."""
    scene = hybrid()
    deck = (
        scene.head()
        + scene.forces()
        + "compute area all dcm/contact/local area\n"
        + "compute sum all reduce sum c_area inputs local\n"
        + scene.motion()
        + "variable n equal step\nfix stop all halt 1 v_n >= 3 error continue message no\n"
        + "run 9\n"
    )
    read = 'print "at $(step) $(c_sum)"\n'
    result = lmp.run(deck + read)
    assert result.returncode != 0
    text = result.error.replace("\n", " ")
    assert re.search(r"dcm/contact/local: contacts of step 3 were not recorded.*'run 0'", text)
    after = [line.split() for line in lmp(deck + "unfix stop\nrun 0\n" + read).out.splitlines()]
    found = [row for row in after if row[:1] == ["at"]]
    assert len(found) == 1 and found[0][1] == "3" and float(found[0][2]) > 1.0


def test_needs_the_atom_style(lmp):
    deck = "region b block 0 1 0 1 0 1\ncreate_box 1 b\nmass 1 1.0\n"
    result = lmp.run(deck + "compute c all dcm/contact/local area\nrun 0\n")
    assert result.returncode != 0 and "atom_style dcm" in result.out
