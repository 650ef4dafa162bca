"""Death, conversion and division in decks without fix dcm/growth; the fix dcm/cell they make."""

import numpy as np
import pytest

from lammps_dcm import read_deaths
from support.bad_decks import fails, whole
from support.cycle_decks import counting, growth, same
from support.parameters import FILES, PLAIN

COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"
ATOMS, EDGES = 1 + 42 + 80, 120  # of a deformable cell of an icosphere of level 1
LIVES = "mother generation birth phase"
VALUES = " ".join(f"c_of[{k}]" for k in range(1, 7))


def tissue(scenes):
    """Three deformable and six center-based cells; head, what restart files lack, and the rest.

    Shrinking from step 10 on: cells 2 (deformable) and 5; at once: 6 by region at step 10, 8 by
    age at step 30. At step 20 cell 4 becomes deformable and cell 3 a sphere.
    """
    scene = scenes.hybrid(level=1, boundary="p p p", box=(27.0, 27.0, 18.0), shift=(3.0, 2.0, 0.5))
    scene.cbm(20.0, 20.0, -8.0, 4.0)
    scene.cbm(-20.0, 20.0, -8.0, 4.0)
    head = scene.head() + scene.cortex() + "pair_style dcm/contact law dmt\n"
    coeff = f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
    rest = (
        "fix cell all dcm/cell\n"
        + scene.volume()
        + "variable pick atom step>=10&&(mol==2||mol==5)\n"
        + "fix shrink all dcm/death variable v_pick shrink 60 log shrink.log\n"
        + "region corner block -2 8 -15 -8 EDGE EDGE\n"
        + "fix away all dcm/death region corner every 10 log region.log\n"
        + "group old molecule 8\nfix old old dcm/death age 30 log age.log\n"
        + "fix chance all dcm/death rate 4e-3 seed 12 every 5 log rate.log\n"
        + "variable want atom (mol==4)-(mol==3)\n"
        + "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_want every 20 "
        + "mesh icosphere 1\n"
        + scene.motion()
        + "timestep 1.0\ngroup cells type 1 4\n"
        + f"compute of cells dcm/cell volume0 volume {LIVES}\n"
        + scenes.dump("id mol type " + VALUES, 5, "cells.txt", "cells")
        + scenes.dump(COLUMNS, 5)
        + scenes.thermo(["atoms", "bonds", "dihedrals", "a=f_shrink", "b=f_away", "c=f_old",
                         "d=f_chance", "to=f_convert[1]", "back=f_convert[2]"], 5)
    )  # fmt: skip
    return head, coeff, rest


@pytest.fixture(scope="module")
def one_rank(lmp_module, scenes):
    return lmp_module("".join(tissue(scenes)) + "run 80\n")


def test_who_dies_and_who_changes(one_rank):
    log = {
        name: read_deaths(one_rank.path / f"{name}.log")
        for name in ("shrink", "region", "age", "rate")
    }
    # 5 % are left after 57 of 60 s, unless chance was faster
    assert set(log["shrink"].cell) <= {2, 5} and len(log["shrink"].cell) > 0
    assert set(log["shrink"].step) == {10 + 57}
    assert list(log["region"].cell) == [6] and list(log["region"].step) == [10]
    assert list(log["age"].cell) == [8] and list(log["age"].step) == [30]
    assert set(np.asarray(log["rate"].step) % 5) <= {0}
    row = one_rank.thermo[-1]
    gone = [c for name in log for c in log[name].cell]
    assert len(gone) == len(set(gone))
    assert [row[f"v_{k}"] for k in "abcd"] == [len(log[k].cell) for k in log]
    assert (row["v_to"], row["v_back"]) == (1, 1)
    frame = one_rank.dump("cells.txt")[-1]
    left = set(range(1, 10)) - set(gone)
    assert set(frame["mol"]) == left
    deformable = left & {1, 2, 4}
    assert set(frame["mol"][frame["type"] == 1]) == deformable
    counts = (row["Atoms"], row["Bonds"], row["Diheds"])
    n, m = len(deformable), len(left)
    assert counts == (n * ATOMS + m - n, n * EDGES, n * EDGES)


def test_lives(one_rank):
    """Without growth a cell is quiescent until it shrinks, whatever form it has."""
    for frame in one_rank.dump("cells.txt"):
        for k, m in enumerate(frame["mol"]):
            mother, generation, birth, phase = (frame[f"c_of[{c}]"][k] for c in (3, 4, 5, 6))
            assert (mother, generation, birth) == (0, 0, 0)
            assert phase == (4 if m in (2, 5) and frame.step >= 10 else 3)
            if m in (2, 5) and frame.step >= 10:
                first = one_rank.dump("cells.txt")[0]
                start = first["c_of[1]"][list(first["mol"]).index(m)]
                left = 1 - (frame.step - 10) / 60
                assert frame["c_of[1]"][k] == pytest.approx(left * start, rel=1e-9)


@pytest.mark.parametrize("np_", [2, 3, 4])
def test_same_on_ranks(lmp, scenes, one_rank, np_):
    other = lmp("".join(tissue(scenes)) + "run 80\n", np=np_)
    for name in ("shrink", "region", "age", "rate"):
        a, b = (read_deaths(r.path / f"{name}.log") for r in (one_rank, other))
        assert list(a.step) == list(b.step) and list(a.cell) == list(b.cell)
    for a, b in zip(one_rank.dump(), other.dump(), strict=True):
        same(a, b, "id mol type")
        assert np.abs(a.x - b.x).max() < 1e-9
    for a, b in zip(one_rank.dump("cells.txt"), other.dump("cells.txt"), strict=True):
        same(a, b, "id mol c_of[3] c_of[4] c_of[5] c_of[6]")
        for k in (1, 2):
            assert b[f"c_of[{k}]"] == pytest.approx(a[f"c_of[{k}]"], rel=1e-9)


@pytest.mark.parametrize("np_", [1, 2])
def test_restart(lmp, scenes, np_):
    """At step 40: two cells are shrinking, one has died of age, two have changed their form."""
    head, coeff, rest = tissue(scenes)
    rest += "restart 40 r.*\n"
    processors = "processors * 1 1\n"
    whole_run = lmp(processors + head + coeff + rest + "run 80\n", np=np_)
    again = lmp(
        processors + "read_restart r.40\n" + coeff + rest + "run 40\n",
        np=np_,
        files={"r.40": whole_run.path / "r.40"},
    )
    assert (whole_run.thermo[8]["v_to"], whole_run.thermo[8]["v_c"]) == (1, 1)
    for name, columns in (
        ("dump.txt", COLUMNS),
        ("cells.txt", "id mol type " + VALUES),
    ):
        for a, b in zip(whole_run.dump(name)[8:], again.dump(name), strict=True):
            same(a, b, columns)
    assert whole_run.thermo[-1] == again.thermo[-1]
    first, second = ((r.path / "shrink.log").read_text() for r in (whole_run, again))
    rows = [line for line in first.splitlines() if line[0] != "#"]
    assert rows and [line for line in second.splitlines() if line[0] != "#"] == rows


def test_conversion_alone(lmp, scenes):
    """There and back, with neither growth nor death, and with motion and contact."""
    scene = scenes.Scene((24.0, 16.0, 16.0), "f f f")
    for x in (-9.6, 0.0, 9.6):
        scene.cbm(x, 0.1, 0.2, 5.0)
    deck = "variable want atom (step<40)*(mol==2)-(step>=40)\n" + scene.head() + scene.forces()
    deck += "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_want every 10 "
    deck += "mesh icosphere 1\n" + scene.motion() + "timestep 1.0\n"
    deck += scenes.thermo(["atoms", "bonds"], 10) + "run 60\n"
    atoms = {int(row["Step"]): (row["Atoms"], row["Bonds"]) for row in lmp(deck).thermo}
    assert atoms == {0: (3, 0), **dict.fromkeys((10, 20, 30), (2 + ATOMS, EDGES)),
                     **dict.fromkeys((40, 50, 60), (3, 0))}  # fmt: skip


# --- a dying cell and fix dcm/growth --------------------------------------------------------------


def dying(scenes, death, rest):
    deck = counting(8, "cycle_time 1e9").replace("fix growth", "#fix growth")
    deck += "variable pick atom mol<=2\n" + death + "compute of all dcm/cell phase volume0\n"
    return deck + scenes.dump("id mol c_of[1] c_of[2]", 10) + "run 20\n" + rest


GROW = "fix growth {} dcm/growth NULL d d d c seed 3 cycle_time 1000\n"
SHRINK = "fix death all dcm/death variable v_pick shrink 100\n"


def test_growth_does_not_wake_the_dying(lmp, scenes):
    """Cells that shrink when fix dcm/growth comes go on shrinking, and die in time."""
    frames = lmp(dying(scenes, SHRINK, GROW.format("all") + "run 80\n")).dump()
    start = frames[0]["c_of[2]"][0]
    for frame in frames:
        for m, phase, volume0 in zip(frame["mol"], frame["c_of[1]"], frame["c_of[2]"]):
            if m <= 2 and frame.step:  # chosen at step 1
                assert phase == 4, (frame.step, m)
                assert volume0 == pytest.approx(start * (1 - (frame.step - 1) / 100), rel=1e-9)
    assert [len(f["mol"]) for f in frames] == [8] * (len(frames) - 1) + [6]


def test_leaving_the_group_of_growth_does_not_wake_the_dying(lmp, scenes):
    before = "group some molecule 1 3 4\n" + GROW.format("some")
    rest = "group some clear\ngroup some molecule 4\nrun 80\n"
    frames = lmp(dying(scenes, before + SHRINK, rest)).dump()
    whole_cell = frames[1]["c_of[2]"] / (1 - 9 / 100)  # when it was chosen, at step 1
    for frame in frames[1:-1]:
        for m, phase, volume0 in zip(frame["mol"], frame["c_of[1]"], frame["c_of[2]"]):
            if m <= 2:
                left = whole_cell[list(frames[1]["mol"]).index(m)] * (1 - (frame.step - 1) / 100)
                assert phase == 4, (frame.step, m)
                assert volume0 == pytest.approx(left, rel=1e-9)
    assert len(frames[-1]["mol"]) == 6


# --- errors, and the fix dcm/cell that is made ----------------------------------------------------


def test_division_alone(lmp, scenes):
    deck = whole(scenes.doublet(), extra="fix division all dcm/division seed 1\n")
    fails(lmp, deck, "Fix dcm/division: nothing in the deck makes cells ready to divide",
          "needs a fix dcm/growth")  # fmt: skip


def spheres(scene, fix):
    return (
        scene.head()
        + f"pair_style dcm/contact growth 1.35\npair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
        + fix.format(growth(scene, "cycle_time 40"))
        + "fix division all dcm/division seed 4 cbm soften 20 log division.log\n"
        + scene.motion()
        + "timestep 1.0\n"
    )


CELL = "fix cell all dcm/cell\n"


@pytest.mark.parametrize("np_", [1, 2])
def test_spheres_without_fix_cell(lmp, scenes, np_):
    """Growth makes one; a deck that has its own, before or after growth, runs the same, but for the
    order of sums: that of the atoms after a division follows that of the fixes."""
    scene = scenes.Scene(30.0, "f f f", parameters=PLAIN)
    for x in (-7.0, 7.0):
        scene.cbm(x, 0.0, 0.0, 5.0)
    frames = []
    for fix in ("{}", CELL + "{}", "{}" + CELL):
        deck = spheres(scene, fix) + scenes.dump(COLUMNS, 10) + "run 60\n"
        result = lmp(deck, np=np_, files=FILES)
        assert ("added 'fix cell all dcm/cell'" in result.log) == (fix != CELL + "{}")
        frames.append(result.dump())
    assert len(frames[0][-1]["id"]) == 4
    for other in frames[1:]:
        for a, b in zip(frames[0], other, strict=True):
            assert a.step == b.step
            for name in COLUMNS.split():
                assert np.abs(a[name] - b[name]).max() < 1e-12, (a.step, name)


@pytest.mark.parametrize("written", ["{}", "{}" + CELL])
@pytest.mark.parametrize("read", ["{}", CELL + "{}", "{}" + CELL])
def test_restart_with_a_fix_cell_that_was_made(lmp, scenes, written, read):
    """The table of cells comes back whichever deck wrote it, and whichever reads it."""
    scene = scenes.Scene(30.0, "f f f", parameters=PLAIN)
    for x in (-7.0, 7.0):
        scene.cbm(x, 0.0, 0.0, 5.0)
    tail = scenes.dump(COLUMNS, 10) + "compute of all dcm/cell mother generation progress\n"
    tail += scenes.dump("id c_of[1] c_of[2] c_of[3]", 10, "cells.txt") + "restart 50 r.*\n"
    whole_run = lmp(spheres(scene, written) + tail + "run 90\n", files=FILES)
    fixes = spheres(scene, read).split("neighbor 0.6 multi\n")[1]
    again = lmp(
        f"read_restart r.50\npair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
        + fixes + tail + "run 40\n",
        files={**FILES, "r.50": whole_run.path / "r.50"},
    )  # fmt: skip
    for name, columns in (("dump.txt", COLUMNS), ("cells.txt", "id c_of[1] c_of[2] c_of[3]")):
        for a, b in zip(whole_run.dump(name)[5:], again.dump(name), strict=True):
            same(a, b, columns)
    assert len(again.dump()[-1]["id"]) == 8


def test_another_fix_cell_of_another_name(lmp, scenes):
    """One that was made stands in the way of one with another ID: the error says what to do."""
    scene = scenes.doublet()
    extra = f"fix growth all dcm/growth {scene.map} seed 1 cycle_time 1000\n"
    deck = whole(scene, cell=extra + "fix mine all dcm/cell\n")
    fails(lmp, deck, "fix dcm/cell already .ID cell, added for a style above; define yours before")


@pytest.mark.parametrize("np_", [1, 2])
def test_the_last_deformable_cell_dies(lmp, scenes, np_):
    """Its types are empty then; exclusions of the pair style's own do not end the next run."""
    scene = scenes.doublet(boundary="f f f")
    scene.cbm(0.0, 12.0, 0.0, 4.0)
    deck = whole(
        scene,
        contact=scene.contact().replace("neighbor 0.6", "neighbor 0.8"),
        extra="group doomed molecule 1 2\nfix death doomed dcm/death all every 3\n",
        motion=scene.motion(),
    )
    deck += "thermo_style custom step atoms\nthermo 1\ntimestep 1.0\nrun 5\n"
    result = lmp(deck + "write_restart r.5\nwrite_data r.data nofix nocoeff\nrun 5\n", np=np_)
    assert [row["Atoms"] for row in result.thermo][-1] == 1
    assert (result.path / "r.5").stat().st_size > 0
