"""Rules of fix dcm/convert that follow a lumen, pressures and strains, and the time they hold."""

import numpy as np
import pytest

from support.conversions import cells, cells_dump, convert, deformable, row_of_spheres, still
from support.cycle_decks import growth, same
from support.parameters import FILES, PLAIN

COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"
R = 5.0
V = 4.0 / 3.0 * np.pi * R**3


def seen_dump(scenes, column, every=10):
    """What a rule has seen at its last look; after cells_dump()."""
    return f"compute {column} all dcm/cell {column}\n" + scenes.dump(
        f"id mol type c_{column}", every, "seen.txt", "cells"
    )


def seen(result, column):
    """step -> molecule -> value."""
    return {
        frame.step: {
            int(m): value
            for m, t, value in zip(frame["mol"], frame["type"], frame[f"c_{column}"], strict=True)
            if t in (1, 4)
        }
        for frame in result.dump("seen.txt")
    }


def forms(result):
    """step -> molecules of deformable cells."""
    return {frame.step: deformable(frame) for frame in result.dump("cells.txt")}


def pressed(scene, rule, options="every 10 mesh icosphere 1"):
    """Cells in contact that do not move."""
    return (
        scene.head()
        + scene.forces("growth 1.3")
        + growth(scene, "")
        + convert(rule, options)
        + "timestep 1.0\n"
    )


# --- strain ---------------------------------------------------------------------------------------


def test_strain_of_spheres(lmp, scenes):
    """Half the overlap over the radius: 0.06 and 0.1 in two pairs, of which one is over 0.08."""
    scene = scenes.Scene((40.0, 12.0, 12.0), "f f f")
    for x in (-20.0, -20.0 + 2 * R * 0.94, 10.0, 10.0 + 2 * R * 0.90):
        scene.cbm(x, 0.3, -0.2, R)
    deck = still(scene, "strain 0.08 0.02") + cells_dump(scenes, 10)
    result = lmp(deck + seen_dump(scenes, "flattening") + "run 30\n")
    values = seen(result, "flattening")
    assert values[10] == pytest.approx({1: 0.06, 2: 0.06, 3: 0.1, 4: 0.1}, abs=1e-12)
    assert forms(result)[10] == forms(result)[30] == {3, 4}
    # the cell it becomes has its plane there: a node of it is less than half an edge off the axis
    edge = 1.107 / 2
    for m in (3, 4):
        assert values[20][m] == pytest.approx(0.1, abs=0.5 * (0.6 * edge) ** 2)


def test_strain_across_a_periodic_border(lmp, scenes):
    scene = scenes.Scene((14.6, 12.0, 12.0), "p p p")  # 1 and 3 are 9.2 apart
    for x in (-10.0, 0.0, 10.0):
        scene.cbm(x, 0.3, -0.2, R)
    deck = still(scene, "strain 0.07 0.0") + cells_dump(scenes, 10)
    assert forms(lmp(deck + "run 10\n"))[10] == {1, 3}


def test_strain_of_deformable_cells(lmp, scenes):
    """An ellipsoid keeps its form, a round cell becomes a sphere; values from the meshes."""
    nodes, faces = scenes.icosphere(2)
    nodes = nodes * [6.0, 5.0, 4.0]
    scene = scenes.Scene((40.0, 14.0, 14.0), "f f f")
    scene.dcm(-15.0, 0.0, 0.0, R, mesh=("ellipsoid.off", len(nodes), len(faces)))
    scene.dcm(15.0, 0.0, 0.0, R)
    deck = still(scene, "strain 0.25 0.05") + cells_dump(scenes, 10)
    deck += seen_dump(scenes, "flattening") + "run 20\n"
    result = lmp(deck, files={"ellipsoid.off": scenes.off(nodes, faces)})
    a, b, c = (nodes[faces[:, k]] for k in range(3))
    radius = np.cbrt(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 / (4 / 3 * np.pi))
    expected = 1 - np.linalg.norm(nodes, axis=1).min() / radius
    assert expected == pytest.approx(1 - 4 / np.cbrt(120), abs=0.02)
    assert seen(result, "flattening")[10] == pytest.approx({1: expected, 2: 0.0}, abs=1e-9)
    assert forms(result)[10] == forms(result)[20] == {1}


# --- pressure -------------------------------------------------------------------------------------


@pytest.mark.parametrize("part, changed", [(0.49, {1, 2, 3}), (0.98, {2}), (1.02, set())])
def test_pressure_of_spheres(lmp, scenes, part, changed):
    """Three in a row, Hertz: p = F d / (3 V) in the middle, half of it at the ends."""
    scene = scenes.Scene((20.0, 12.0, 12.0), "f f f", parameters=PLAIN)
    d = 9.2
    for x in (-d, 0.0, d):
        scene.cbm(x, 0.0, 0.0, R)
    E = 0.45 / (1 - 0.4**2) / 2
    p = 4 / 3 * E * np.sqrt(R / 2) * (2 * R - d) ** 1.5 * d / (3 * V)
    deck = pressed(scene, f"pressure {part * p:.12g} {0.1 * p:.12g}") + cells_dump(scenes, 10)
    result = lmp(deck + seen_dump(scenes, "outer_pressure") + "run 10\n", files=FILES)
    values = seen(result, "outer_pressure")[10]
    assert values == pytest.approx({1: p / 2, 2: p, 3: p / 2}, rel=1e-9)
    assert forms(result)[10] == changed


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("tension", ["", "tension 0.2"])
def test_pressure_of_a_deformable_cell(lmp, scenes, tension, np_):
    """What its own forces hold: sum F.(x - center) / (3 V) over its nodes, with the forces it has
    without contacts; across a periodic border."""
    scene = scenes.Scene((15.0, 12.0, 12.0), "p p p", parameters=PLAIN, level=2)
    for x in (0.0, 9.6, -9.6):
        scene.dcm(x, 0.0, 0.0, R)
    fix = f"fix tension all dcm/tension {scene.map} {tension}\n" if tension else ""
    dump = scenes.dump("id mol type xu yu zu fx fy fz", 10)
    deck = pressed(scene, "pressure 1e3 -1e3") + fix + cells_dump(scenes, 10)
    deck += seen_dump(scenes, "outer_pressure") + dump
    deck += "displace_atoms all move 14.5 0 0 units box\nrun 10\n"
    result = lmp(deck, files=FILES, np=np_)
    alone = scene.head() + scene.cortex() + "comm_modify cutoff 14\nfix cell all dcm/cell\n"
    free = lmp(alone + scene.volume() + fix + dump + "run 0\n", files=FILES).dump()[0]
    nodes = (free["mol"] == 1) & (free["type"] == 2)
    x = free.x[nodes]
    virial = np.einsum("ij,ij->", free.f[nodes], x - x.mean(axis=0))
    volume = cells(result.dump("cells.txt")[0])[1][2]
    assert seen(result, "outer_pressure")[10][1] == pytest.approx(virial / (3 * volume), rel=1e-9)


@pytest.mark.parametrize("P", [0.0, 0.3])
def test_pressure_from_all_sides(lmp, scenes, P):
    """At rest the pressure outside, whatever the tension of the cortex: zero for a free cell."""
    scene = scenes.Scene(15.0, "s s s", level=2, parameters=PLAIN)
    scene.dcm(0.0, 0.0, 0.0, R)
    deck = scene.head() + scene.forces() + growth(scene, "") + convert("pressure 1e3 -1e3")
    deck += f"fix osm all dcm/osmosis pressure {P} marks flood starter 0 0 0 100 1e9\n"
    deck += scene.motion() + cells_dump(scenes, 600) + seen_dump(scenes, "outer_pressure", 600)
    result = lmp(deck + "timestep 1.0\nrun 600\n", files=FILES)
    assert cells(result.dump("cells.txt")[-1])[1][3] > P + 0.01  # with the tension of the cortex
    assert seen(result, "outer_pressure")[600][1] == pytest.approx(P, abs=1e-6)


def chain(scenes, rule, options="every 10 mesh icosphere 1 rest 0.95", release=True):
    """A force presses three spheres together, and lets go."""
    scene = scenes.Scene((24.0, 14.0, 14.0), "f f f", parameters=PLAIN)
    for x in (-9.9, 0.0, 9.9):
        scene.cbm(x, 0.0, 0.1, R)
    deck = (
        scene.head() + scene.forces("growth 1.3") + growth(scene, "")
        + "group left molecule 1\ngroup right molecule 3\ngroup middle molecule 2\n"
        + convert(rule, options).replace("convert all", "convert middle")
        + "fix pull left addforce 2.0 0 0\nfix push right addforce -2.0 0 0\n"
        + scene.motion() + cells_dump(scenes, 10) + scenes.dump(COLUMNS, 1) + "timestep 1.0\n"
    )  # fmt: skip
    if release:
        deck += "run 100\nunfix pull\nunfix push\nrun 400\n"
    return deck


@pytest.mark.parametrize("rule", ["pressure 0.005 0.001", "strain 0.1 0.02"])
def test_there_and_back(lmp, scenes, rule):
    """Pressed, the middle sphere becomes deformable, since 2 F R / (3 V) is 0.0127; released it has
    no force left and becomes round again: it goes back to a sphere.  As such it shows more strain
    than before, since 42 nodes do not tell less than 0.05: the first number is higher."""
    result = lmp(chain(scenes, rule) + scenes.thermo(["to=f_convert[1]", "back=f_convert[2]"], 100)
                 .replace("thermo 100", "run 0"), files=FILES)  # fmt: skip
    form = forms(result)
    steps = [step for step, molecules in form.items() if molecules == {2}]
    assert steps and 100 in steps and not form[500]
    assert steps == list(range(steps[0], steps[-1] + 1, 10))  # once there, once back
    row = result.thermo[-1]
    assert (row["v_to"], row["v_back"]) == (1, 1)


# --- lumen ----------------------------------------------------------------------------------------


def beside_a_lumen(scenes, rule, seconds=1e9):
    """All faces of cell 1 bound a lumen; spheres in a row beside it, 14, 25 and 40 um away."""
    scene = scenes.Scene((50.0, 14.0, 14.0), "f f f", level=2)
    scene.dcm(0.0, 0.0, 0.0, R)
    for x in (14.0, 25.0, 40.0):
        scene.cbm(x, 0.0, 0.0, R)
    return (
        scene.head() + scene.forces("growth 1.3") + growth(scene, "")
        + convert(rule, "every 10 mesh icosphere 2")
        + f"fix osm all dcm/osmosis pressure 0 marks flood starter 0 0 0 7 {seconds}\n"
        + scene.motion() + cells_dump(scenes, 10)
        + scenes.dump(COLUMNS, 1) + "timestep 1.0\n"
    )  # fmt: skip


def test_lumen(lmp, scenes):
    """The nearest face is 9 um from the first sphere, 20 from the second."""
    assert forms(lmp(beside_a_lumen(scenes, "lumen osm 8.8 12") + "run 10\n"))[10] == {1}
    assert forms(lmp(beside_a_lumen(scenes, "lumen osm 9.3 12") + "run 10\n"))[10] == {1, 2}
    assert forms(lmp(beside_a_lumen(scenes, "lumen osm 20.3 22") + "run 10\n"))[10] == {1, 2, 3}


def test_the_wall_of_a_lumen_stays(lmp, scenes):
    """Its own faces are 5 um from the center of cell 1, farther than the second distance; when they
    bound a lumen no longer it becomes a sphere like the others."""
    form = forms(lmp(beside_a_lumen(scenes, "lumen osm 2 3", 25) + "run 50\n"))
    assert form[10] == form[20] == {1}
    assert form[50] == set()


# --- hold -----------------------------------------------------------------------------------------

# deformable at looks 10, 30, 50 ..., sphere at 20, 40, 60 ...
TO_AND_FRO = "variable want atom 1-2*((step%20)<5)\n"


def changes_of(lmp, scenes, options):
    """Steps in which the cell changes its form."""
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, R)
    deck = TO_AND_FRO + still(scene, "variable v_want", f"every 10 mesh icosphere 1 {options}")
    form = forms(lmp(deck + cells_dump(scenes, 10) + "run 200\n"))
    return [s for s in range(10, 201, 10) if form[s] != form[s - 10]]


def test_hold(lmp, scenes):
    """Held for 35 s from step 10: at 50 and later it may be changed, at 60 the rule wants that."""
    assert changes_of(lmp, scenes, "") == list(range(10, 201, 10))
    assert changes_of(lmp, scenes, "hold 0") == list(range(10, 201, 10))
    assert changes_of(lmp, scenes, "hold 35") == [10, 60, 110, 160]
    assert changes_of(lmp, scenes, "hold 50") == [10, 60, 110, 160]  # to the second
    assert changes_of(lmp, scenes, "hold 50.1") == [10, 80, 150]
    assert changes_of(lmp, scenes, "hold 1000") == [10]


def test_newborn_are_not_held(lmp, scenes):
    """Their mother was converted 20 s before she divided; it is the cell that is held."""
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, R)
    deck = "variable want atom (mol==1)-(mol>1)\n"
    deck += still(scene, "variable v_want", "every 30 mesh icosphere 1 hold 500", "cycle_time 50")
    deck += "fix division all dcm/division seed 4\n" + cells_dump(scenes, 10) + "run 70\n"
    form = forms(lmp(deck))
    assert form[40] == {1} and form[50] == {2, 3} and form[60] == set()


# --- several fixes, groups that follow ------------------------------------------------------------


def test_two_fixes(lmp, scenes):
    """In one deck, with one table of cells; each has a rule that says nothing on cells of the
    other, since the second deformable cell joins the groups of the first."""
    scene = row_of_spheres(scenes)
    deck = "variable first atom (mol==1)-(mol==2)\nvariable second atom (mol==3)*(1-2*(step>25))\n"
    deck += still(scene, "variable v_first", "every 10 mesh icosphere 1 hold 15")
    again = convert("variable v_second").replace("fix convert", "fix again")
    deck = deck.replace("timestep", again + "timestep") + cells_dump(scenes, 10)
    form = forms(lmp(deck + "run 30\n"))
    assert form[10] == form[20] == {1, 3} and form[30] == {1}


def test_near_a_group_that_follows(lmp, scenes):
    """Near the free end of a row: cells with contact on one side only are the group."""
    scene = scenes.Scene((50.0, 12.0, 12.0), "f f f")
    for k in range(7):
        scene.cbm(9.6 * (k - 3), 0.0, 0.0, R)
    deck = pressed(scene, "near surface 10 12")
    deck = deck.replace("fix convert", "compute many all dcm/cell neighbors\n"
                        "variable one atom c_many==1\n"
                        "group surface dynamic all var one every 5\nfix convert")
    form = forms(lmp(deck + cells_dump(scenes, 10) + "run 10\n"))
    assert form[10] == {1, 2, 6, 7}


# --- ranks, restarts ------------------------------------------------------------------------------


RULES = {
    "pressure": lambda scenes: chain(scenes, "pressure 0.005 0.001"),
    "strain": lambda scenes: chain(scenes, "strain 0.1 0.02"),
    "lumen": lambda scenes: beside_a_lumen(scenes, "lumen osm 9.3 12", 25) + "run 60\n",
}


@pytest.mark.parametrize("rule", RULES)
def test_ranks_agree(lmp, scenes, rule):
    one = lmp(RULES[rule](scenes), files=FILES).dump()
    for np_ in (2, 3, 4):
        other = lmp(RULES[rule](scenes), files=FILES, np=np_).dump()
        for a, b in zip(one, other, strict=True):
            assert np.array_equal(a["mol"], b["mol"]) and np.array_equal(a["type"], b["type"])
            assert np.abs(a.x - b.x).max() < 1e-9


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize(
    "rule", ["pressure 0.005 0.001", "strain 0.1 0.02", "lumen osm 9.3 12", "variable v_want"]
)
def test_restart_while_a_cell_is_held(lmp, scenes, rule, np_):
    """Held for 60 s, so that one of three restart files comes within that time, whenever it is."""
    head = f"processors * 1 1\n{TO_AND_FRO}"
    deck = chain(scenes, rule, "every 10 mesh icosphere 1 rest 0.95 hold 60", release=False)
    if "lumen" in rule:
        deck = beside_a_lumen(scenes, rule, 25).replace("icosphere 2\n", "icosphere 2 hold 60\n")
    run = "restart 25 r.*\nrun {}\n"
    whole = lmp(head + deck + run.format(150), np=np_, files=FILES)
    assert len(set(map(frozenset, forms(whole).values()))) > 1  # somebody is converted
    start = deck.index("pair_coeff")  # what a restart file does not hold
    rest = "\n".join(line for line in deck[start:].splitlines() if not line.startswith("group"))
    for at in (25, 75, 125):
        again = lmp(
            f"processors * 1 1\nread_restart r.{at}\n{TO_AND_FRO}{rest}\n" + run.format(150 - at),
            np=np_,
            files=FILES | {f"r.{at}": whole.path / f"r.{at}"},
        )
        for a, b in zip(whole.dump()[at:], again.dump(), strict=True):
            same(a, b, COLUMNS)
