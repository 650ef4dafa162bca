"""Deaths: who dies, shrinking, counts, tags and memory over many births and deaths."""

import os
import re

import numpy as np
import pytest

from lammps_dcm import read_deaths
from support.cycle_decks import counting, growth, same, sphere, topology_counts
from support.parameters import FILES, PLAIN

COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"
ATOMS, EDGES = 1 + 42 + 80, 120  # of a deformable cell of an icosphere of level 1
COUNTS = ["atoms", "bonds", "dihedrals", "n=f_growth"]


def death(options):
    return f"fix death all dcm/death {options} log death.log\n"


def counts(result):
    """Atoms, bonds, dihedrals and cells of every thermo line."""
    return [(r["Atoms"], r["Bonds"], r["Diheds"], r["v_n"]) for r in result.thermo]


# --- who dies -------------------------------------------------------------------------------------


def left(lmp, scenes, options, cells=27, steps=60, before=""):
    """Cells that are left of 27 in a cube, its corner at (-24, -24, -24), and the death log."""
    deck = counting(cells, "cycle_time 1e9") + before + death(options)
    result = lmp(deck + scenes.dump("id mol x y z", 10) + f"run {steps}\n")
    return result.dump(), read_deaths(result.path / "death.log")


def test_all_of_a_group(lmp, scenes):
    deck = counting(27, "cycle_time 1e9") + "group doomed molecule 3 5 20:23\n"
    deck += "fix death doomed dcm/death all every 10 log death.log\n"
    result = lmp(deck + scenes.dump("id mol", 5) + "run 25\n")
    for frame in result.dump():
        gone = set() if frame.step < 10 and frame.step else {3, 5, 20, 21, 22, 23}
        if frame.step:
            assert set(frame["mol"]) == set(range(1, 28)) - gone
    log = read_deaths(result.path / "death.log")
    assert list(log.cell) == [3, 5, 20, 21, 22, 23]
    assert set(log.step) == {10} and set(log.time) == {10.0}
    assert set(log.reason) == {"all"} and set(log.kind) == {"cbm"}
    assert log.volume == pytest.approx(sphere(5.0), rel=1e-6)


def test_everybody(lmp, scenes):
    frames, log = left(lmp, scenes, "all every 20", steps=40)
    assert len(log) == 27 and not len(frames[-1]["id"])


@pytest.mark.parametrize("scheme", ["explicit", "implicit", "implicit dt auto tol 0.02 max 10"])
@pytest.mark.parametrize("np_", [1, 3])
def test_when_all_are_dead(lmp, scenes, np_, scheme):
    """An empty box goes on, its files are written, and it takes cells again."""
    scene = scenes.doublet(boundary="p p p")
    scene.cbm(0.0, 11.0, 0.0, 5.0)
    deck = scene.head() + scene.forces() + death("all")
    deck += scene.motion(options=f"scheme {scheme}") + "timestep 0.5\n"
    deck += scenes.thermo(["atoms"]) + "run 3\nrun 3\n"
    deck += "write_restart last.restart\nwrite_data last.data\nunfix death\nrun 2\n"
    deck += "\n".join(scene.cells) + "\nrun 3\n"
    result = lmp(deck, np=np_)
    assert [run[-1]["Atoms"] for run in result.runs] == [0, 0, 0, 2 * ATOMS + 1]
    assert (result.path / "last.restart").exists() and (result.path / "last.data").exists()


def test_region(lmp, scenes):
    frames, log = left(lmp, scenes, "region r", before="region r sphere 16 16 16 17\n")
    # the corner (16, 16, 16) and its three neighbors at 16
    assert len(log) == 4 and set(log.reason) == {"region"}
    assert len(frames[-1]["id"]) == 23
    assert (np.linalg.norm(frames[-1].vectors("x", "y", "z") - 16, axis=1) > 17).all()


def test_age(lmp, scenes):
    frames, log = left(lmp, scenes, "age 35 every 10")
    assert set(log.step) == {40} and len(log) == 27 and set(log.reason) == {"age"}


def test_criteria_must_all_be_met(lmp, scenes):
    before = "region r block 0 EDGE EDGE EDGE EDGE EDGE\nvariable v atom mol<=15\n"
    frames, log = left(lmp, scenes, "region r variable v_v age 30", before=before)
    # x = -16, 0, 16 for molecules 1, 2, 3 and so on
    assert sorted(log.cell) == [m for m in range(1, 16) if m % 3 != 1]
    assert set(log.step) == {30}


def test_variable_of_deformable_cells(lmp, scenes):
    """Evaluated at the center; here by what the cell is made of."""
    scene = scenes.single_cell(box=25.0, boundary="f f f")
    scene.dcm(14.0, 0.0, 0.0, 5.0)
    deck = scene.head() + scene.cortex() + "fix cell all dcm/cell\ncomm_modify cutoff 12\n"
    deck += growth(scene, "") + scene.volume() + "compute of all dcm/cell volume x\n"
    deck += "variable small atom c_of[1]>0&&c_of[1]<700\n" + death("variable v_small")
    result = lmp(deck + scenes.thermo(COUNTS) + "timestep 1.0\nrun 2\n")
    assert counts(result)[-1] == (ATOMS, EDGES, EDGES, 1)
    log = read_deaths(result.path / "death.log")
    assert list(log.cell) == [2] and list(log.kind) == ["dcm"]


def test_rate_is_exponential_decay(lmp, scenes):
    """N = N0 exp(-r t), binomial error; looking every 5 steps gives the same."""
    N0, r = 400, 1e-3
    deck = counting(N0, "cycle_time 1e9") + death("rate 1e-3 seed 6 every 5")
    result = lmp(deck + scenes.thermo(["n=f_growth", "gone=f_death"], 250) + "run 1500\n")
    for row in result.thermo:
        p = np.exp(-r * row["Step"])
        assert row["v_n"] == pytest.approx(N0 * p, abs=3 * (N0 * p * (1 - p)) ** 0.5 + 1)
        assert row["v_n"] + row["v_gone"] == N0
    times = read_deaths(result.path / "death.log").time
    assert len(set(times)) > 100
    # mean age at death of those that died before t: 1/r - t/(exp(r t) - 1)
    expected = 1 / r - 1500 / (np.exp(1.5) - 1)
    assert times.mean() == pytest.approx(expected, abs=3 * times.std() / len(times) ** 0.5)


# --- shrinking ------------------------------------------------------------------------------------


def shrinking(scenes, options="variable v_pick shrink 100"):
    """Cells in contact of which one deformable and one sphere die from step 20 on."""
    scene = scenes.Scene((27.0, 27.0, 18.0), "f f f", parameters=PLAIN)
    for x, y in ((0.0, 6.8), (-5.9, -3.4), (5.9, -3.4)):
        scene.dcm(x, y, 0.0, 6.0)
    for x, y in ((-11.0, 7.0), (11.0, 7.0), (0.0, -13.0), (-16.0, -1.5)):
        scene.cbm(x, y, 0.2, 5.0)
    rest = "fix cell all dcm/cell\n" + scene.volume() + growth(scene, "")
    rest += "variable pick atom step>=20&&(mol==2||mol==5)\n" + death(options)
    rest += scene.motion() + "timestep 1.0\ngroup cells type 1 4\n"
    rest += "compute of cells dcm/cell volume0 volume\n"
    rest += scenes.dump("id mol c_of[1] c_of[2]", 1, "cells.txt", "cells")
    coeff = f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
    return scene.head() + scene.cortex() + "pair_style dcm/contact\n", coeff, rest


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_shrinking(lmp, scenes, np_):
    """V0 goes linearly to zero; the cell goes when one part in twenty is left."""
    head, coeff, rest = shrinking(scenes)
    rest += scenes.thermo(COUNTS) + "run 140\n"
    result = lmp(head + coeff + rest, np=np_, files=FILES)
    first = None
    for frame in result.dump("cells.txt"):
        first = frame if first is None else first
        part = dict.fromkeys(range(1, 8), 1.0)
        part[2] = part[5] = min(1.0, 1 - (frame.step - 20) / 100)
        if frame.step >= 115:
            assert list(frame["mol"]) == [1, 3, 4, 6, 7]
            continue
        assert sorted(frame["mol"]) == list(range(1, 8))
        for k, molecule in enumerate(frame["mol"]):
            start = first["c_of[1]"][list(first["mol"]).index(molecule)]
            assert frame["c_of[1]"][k] == pytest.approx(part[molecule] * start, rel=1e-10)
            if part[molecule] > 0.3:  # the shape follows
                assert frame["c_of[2]"][k] == pytest.approx(part[molecule] * start, rel=0.1)
    assert counts(result)[0] == (3 * ATOMS + 4, 3 * EDGES, 3 * EDGES, 7)
    assert counts(result)[-1] == (2 * ATOMS + 3, 2 * EDGES, 2 * EDGES, 5)
    log = read_deaths(result.path / "death.log")
    assert list(log.cell) == [2, 5] and list(log.kind) == ["dcm", "cbm"]
    assert set(log.step) == {115}


def test_rest_lengths_shrink_along(lmp, scenes):
    head, coeff, rest = shrinking(scenes)
    read = "run {0} upto\nfix_modify cell rest/write rest.{0}\n"
    deck = head + coeff + rest + "".join(read.format(k) for k in (0, 20, 70))
    path = lmp(deck, files=FILES).path
    table = {}
    for k in (0, 20, 70):
        rows = [line.split() for line in (path / f"rest.{k}").read_text().splitlines()]
        table[k] = np.array([[float(x) for x in row] for row in rows if len(row) == 3])
    assert np.array_equal(table[0], table[20])
    second = (table[0][:, 0] > ATOMS) & (table[0][:, 0] <= 2 * ATOMS)  # tags of cell 2
    factor = table[70][:, 2] / table[0][:, 2]
    assert factor[second] == pytest.approx(0.5 ** (1 / 3), rel=1e-10)
    assert (factor[~second] == 1).all()


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_while_shrinking(lmp, scenes, np_):
    head, coeff, rest = shrinking(scenes)
    rest += scenes.dump(COLUMNS, 10) + "restart 60 r.*\n"
    processors = "processors * 1 1\n"
    whole = lmp(processors + head + coeff + rest + "run 130\n", np=np_, files=FILES)
    again = lmp(
        processors + "read_restart r.60\n" + coeff + rest + "run 70\n",
        np=np_,
        files={**FILES, "r.60": whole.path / "r.60"},
    )
    for a, b in zip(whole.dump()[6:], again.dump(), strict=True):
        same(a, b, COLUMNS)
    assert len(again.dump()[-1]["id"]) == 2 * ATOMS + 3


# --- counts, tags, memory -------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_counts_at_once(lmp, scenes, np_):
    head, coeff, rest = shrinking(scenes, "variable v_pick")
    result = lmp(head + coeff + rest + scenes.thermo(COUNTS) + "run 40\n", np=np_, files=FILES)
    whole = (3 * ATOMS + 4, 3 * EDGES, 3 * EDGES, 7)
    some = (2 * ATOMS + 3, 2 * EDGES, 2 * EDGES, 5)
    assert counts(result) == [whole] * 20 + [some] * 21


@pytest.mark.skipif(os.environ.get("DCM_PRESET") == "asan", reason="it keeps memory that is free")
def test_tags_and_memory_stay_bounded(lmp, scenes):
    """Ten spheres, in each of 1000 cycles each divides and one of the daughters dies."""
    deck = counting(20, "cycle_time 10").replace("boundary f f f", "boundary p p p")
    deck += "variable even atom mol%2==0\n"
    deck += "fix division all dcm/division seed 4\n" + death("variable v_even")
    deck += "variable tag atom id\ncompute last all reduce max v_tag\n"
    deck += scenes.thermo(["atoms", "n=f_growth", "b=f_growth[6]", "last=c_last"], 10)
    result = lmp(deck + 'run 10000 every 1000 "info memory"\n')
    last = result.thermo[-1]
    assert last["v_b"] >= 19000 and last["Atoms"] == 20
    assert max(row["v_last"] for row in result.thermo) <= 20
    peaks = [float(x) for x in re.findall(r"Maximum resident set size: ([\d.]+)", result.out)]
    assert len(peaks) == 10 and peaks[-1] < 1.05 * peaks[0]


@pytest.mark.parametrize("np_", [1, 2])
def test_sorted_dump_of_other_tags(lmp, scenes, np_):
    """As many atoms as at the start, but others: LAMMPS takes the order of the IDs for granted."""
    deck = counting(27, "cycle_time 10") + "variable odd atom mol%2\n"
    deck += "fix division all dcm/division seed 4\n" + death("variable v_odd every 15")
    result = lmp(deck + scenes.dump("id mol", 16) + "run 16\n", np=np_)
    lines = (result.path / "dump.txt").read_text().splitlines()[-27:]
    rows = [[int(word) for word in line.split()] for line in lines]
    tags = [tag for tag, _ in rows]
    assert tags == sorted(set(tags)) and tags[-1] > 27
    assert sorted(m for _, m in rows) == list(range(28, 82, 2))


def test_tags_of_deformable_cells_stay_bounded(lmp, scenes):
    """Four deformable cells that divide, one daughter each dies; counts exact at every step."""
    scene = scenes.Scene(40.0, "f f f")
    for x, y in ((-16, -16), (16, -16), (-16, 16), (16, 16)):
        scene.dcm(x, y, 0.0, 5.0, options="rotate 3 rest 1")
    deck = scene.head() + scene.forces() + growth(scene, "cycle_time 150")
    deck += "fix division all dcm/division seed 4\nvariable odd atom mol>4&&mol%2==1\n"
    deck += death("variable v_odd") + scene.motion(options="")
    deck += "variable tag atom id\ncompute last all reduce max v_tag\n"
    deck += scenes.thermo([*COUNTS, "b=f_growth[6]", "last=c_last"]) + "timestep 1.0\nrun 760\n"
    result = lmp(deck, np=2)
    for row in result.thermo:
        n = row["v_n"]
        assert n == (8 if row["Step"] and row["Step"] % 150 == 0 else 4)
        assert (row["Atoms"], row["Bonds"], row["Diheds"]) == (n * ATOMS, n * EDGES, n * EDGES)
        assert row["v_last"] <= 8 * ATOMS
    assert result.thermo[-1]["v_b"] == 40
    assert topology_counts(result) == (4 * ATOMS, 4 * EDGES, 4 * EDGES)
