"""The worked fix of examples/extend, in a plugin of its own: examples/extend/fix_dcm_anchor.cpp."""

import math
import os
import re
from pathlib import Path

import numpy as np
import pytest

from support.bad_decks import fails, whole
from support.cycle_decks import same

G_ECM = 1.0  # test.dcm of conftest.py
NUMBER, FRICTION = 40.0, 2.5
ANCHOR = f"number {NUMBER} friction {FRICTION}"
DRAG = NUMBER * FRICTION
U = np.array([0.02, -0.03, 0.01])
COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz c_cells[1]"


@pytest.fixture
def lmp(lmp):
    """Runner with the plugin that has the styles of examples/extend."""
    folder = Path(os.environ["DCM_BUILD"]) / "extend"
    assert (folder / "dcmplugin.so").exists(), f"no dcmplugin.so in {folder}; use tools/test"
    lmp.env["LAMMPS_PLUGIN_PATH"] = str(folder)
    return lmp


def anchor(scenes, options="", group="all", velocity=U):
    moving = f"velocity {scenes.words(*velocity)}" if velocity is not None else ""
    return f"fix anchor {group} dcm/anchor {ANCHOR} {moving} {options}\n"


# --- friction and force ---------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
def test_a_sphere_is_slowed_down(lmp, scenes, np_):
    """v = (F + n Z u)/(g 4 pi R^2 + n Z)."""
    R, F = 4.0, np.array([3.0, -2.0, 1.0])
    scene = scenes.Scene(20.0, "p p p")
    scene.cbm(-1.0, 2.0, 3.0, R)
    scene.cbm(9.0, 2.0, 3.0, R)  # not in the group
    result = lmp(
        scene.head()
        + scene.contact()
        + "group held molecule 1\n"
        + f"fix push all addforce {scenes.words(*F)}\n"
        + anchor(scenes, group="held")
        + scene.motion()
        + scenes.dump(every=10)
        + "timestep 0.5\nrun 10\n",
        np=np_,
    )
    free = G_ECM * 4 * math.pi * R**2
    for frame in result.dump():
        assert frame.v[0] == pytest.approx((F + DRAG * U) / (free + DRAG), rel=1e-12)
        assert frame.v[1] == pytest.approx(F / free, rel=1e-12)
    assert "Fix dcm/anchor: added 'fix cell all dcm/cell'" in result.log
    # timed as the styles of the package are
    assert re.search(r"^  fix anchor dcm/anchor +[\d.e-]+ ", result.log, re.M)


@pytest.mark.parametrize("np_", [1, 2])
def test_a_deformable_cell_is_slowed_down(lmp, scenes, np_):
    """Without any other friction the mean node moves with u + F/(n Z), however the cell deforms."""
    scene = scenes.single_cell(level=1, boundary="p p p")
    result = lmp(
        scene.head()
        + scene.cortex()
        + "comm_modify cutoff 8\nfix cell all dcm/cell\n"
        + scene.volume()
        + "group nodes type 2\nfix push nodes addforce 0.05 0.0 0.0\n"
        + anchor(scenes)
        + scene.motion(options="tolerance 1e-12 friction_ecm 0")
        + scenes.dump("id type vx vy vz", 5)
        + "timestep 0.1\nrun 5\n",
        np=np_,
    )
    expected = U + np.array([42 * 0.05 / DRAG, 0.0, 0.0])
    for frame in result.dump():
        nodes = frame.v[frame["type"] == 2]
        assert nodes.std(axis=0).max() > 1e-3  # it does deform
        assert nodes.mean(axis=0) == pytest.approx(expected, rel=1e-8)


# --- the column, divisions and deaths -------------------------------------------------------------


def tissue(scenes, steps, *, anchors, extra=""):
    """A deformable cell and a sphere, apart from each other; each divides at step 100."""
    scene = scenes.Scene((32.0, 16.0, 16.0), "f f f")
    scene.dcm(-15.0, 0.0, 0.0, 6.0)
    scene.cbm(15.0, 0.0, 0.0, 5.0)
    return (
        "processors * 1 1\n" + scene.head() + scene.cortex() + "pair_style dcm/contact\n",
        f"pair_coeff * * {scene.map}\nneighbor 1.5 multi\n"
        "fix cell all dcm/cell\n"
        + scene.volume("K_V 2.5")
        + f"fix grow all dcm/growth {scene.map} seed 5 cycle_time 100 K_V 2.5\n"
        + "fix divide all dcm/division seed 7 cbm soften 50\n"
        + anchors
        + extra
        + scene.motion()
        + "compute cells all dcm/cell anchors molecule mother\n"
        + scenes.dump(COLUMNS + " c_cells[2] c_cells[3]", 10)
        + scenes.thermo(
            ["anchors=f_anchor", "divisions=f_anchor[1]", "deaths=f_anchor[2]", "lost=f_anchor[3]"],
            10,
        )
        + f"timestep 1.0\nrun {steps}\n",
    )


def values(frame):
    """Molecule -> (anchors, mother) of every cell."""
    cell = frame["c_cells[2]"] > 0
    rows = frame.vectors("c_cells[2]", "c_cells[1]", "c_cells[3]")[cell]
    return {int(molecule): (number, int(mother)) for molecule, number, mother in rows}


def test_daughters_share_their_mothers_anchors(lmp, scenes):
    """Half each unless told otherwise, for both kinds of cells; the sum is kept to the last bit."""
    for options, shares in (("", (0.5, 0.5)), ("share 0.25", (0.25, 0.75))):
        result = lmp("".join(tissue(scenes, 120, anchors=anchor(scenes, options, velocity=None))))
        frames = result.dump()
        assert values(frames[9]) == {1: (NUMBER, 0), 2: (NUMBER, 0)}
        found = values(frames[-1])
        assert sorted(mother for _, mother in found.values()) == [1, 1, 2, 2]
        for mother in (1, 2):
            daughters = sorted(m for m in found if found[m][1] == mother)
            assert [found[m][0] for m in daughters] == [share * NUMBER for share in shares]
        assert [row["v_divisions"] for row in result.thermo][-3:] == [2.0, 2.0, 2.0]
        assert all(row["v_anchors"] == 2 * NUMBER for row in result.thermo)
        assert result.thermo[0]["v_divisions"] == 0.0


def test_anchors_of_the_dead_are_lost(lmp, scenes):
    death = "fix death all dcm/death age 15 every 20\n"
    result = lmp(
        "".join(tissue(scenes, 120, anchors=anchor(scenes, velocity=None), extra=death)),
    )
    assert result.thermo[-1]["v_deaths"] == 2.0
    assert not values(result.dump()[-1])
    for row in result.thermo:
        assert row["v_anchors"] == (2 - row["v_deaths"]) * NUMBER
        assert row["v_anchors"] + row["v_lost"] == 2 * NUMBER


def test_anchors_recover(lmp, scenes):
    """n(t) = N - N/2 exp(-t/T) after the division at step 100, to rounding at each step."""
    deck = "".join(tissue(scenes, 150, anchors=anchor(scenes, "recovery 30.0")))
    for frame in lmp(deck).dump():
        # the division takes place after the step's initial_integrate
        missing = NUMBER / 2 * math.exp(-(frame.step - 100) / 30.0) if frame.step >= 100 else 0.0
        for number, _ in values(frame).values():
            assert number == pytest.approx(NUMBER - missing, rel=1e-12)


# --- ranks and restart ----------------------------------------------------------------------------


def test_1_2_and_4_ranks_agree(lmp, scenes):
    deck = "".join(tissue(scenes, 130, anchors=anchor(scenes, "recovery 30.0 share 0.25")))
    one = lmp(deck)
    for np_ in (2, 4):
        other = lmp(deck, np=np_)
        assert other.thermo == one.thermo
        for a, b in zip(one.dump(), other.dump(), strict=True):
            assert values(a) == values(b)
            assert np.abs(a.x - b.x).max() < 1e-8, a.step


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_is_bit_for_bit(lmp, scenes, np_):
    """A run that goes on from step 120, after divisions, while anchors recover."""
    start, rest = tissue(scenes, 160, anchors=anchor(scenes, "recovery 30.0 share 0.25"))
    rest = rest.replace("timestep", "restart 120 r.*\ntimestep")
    first = lmp(start + rest, np=np_)
    again = lmp(
        "processors * 1 1\nread_restart r.120\n" + rest.replace("run 160", "run 40"),
        np=np_,
        files={"r.120": first.path / "r.120"},
    )
    expected, found = first.dump()[12:], again.dump()
    assert [frame.step for frame in found] == [120, 130, 140, 150, 160]
    for a, b in zip(expected, found, strict=True):
        same(a, b, COLUMNS + " c_cells[2] c_cells[3]")
    assert again.thermo == first.thermo[12:]


# --- bad input ------------------------------------------------------------------------------------

CASES = {
    "no number": ("friction 1", "Fix dcm/anchor: keyword number is missing; give a positive"),
    "no friction": ("number 1", "Fix dcm/anchor: keyword friction is missing; give a positive"),
    "number 0": ("number 0 friction 1", "Fix dcm/anchor: number is 0.*positive"),
    "number text": ("number x friction 1", "Fix dcm/anchor: number is 'x'.*number"),
    "friction -1": ("number 1 friction -1", "Fix dcm/anchor: friction is -1.*positive"),
    "velocity short": (f"{ANCHOR} velocity 1 2", "Fix dcm/anchor: keyword velocity needs 3"),
    "velocity nan": (f"{ANCHOR} velocity 1 2 nan", "Fix dcm/anchor: velocity is 'nan'"),
    "recovery 0": (f"{ANCHOR} recovery 0", "Fix dcm/anchor: recovery is 0.*positive"),
    "share 2": (f"{ANCHOR} share 2", "Fix dcm/anchor: share is 2, must be 0 to 1"),
    "share -1": (f"{ANCHOR} share -1", "Fix dcm/anchor: share is -1"),
    "keyword": (f"{ANCHOR} x 1", "Fix dcm/anchor: unknown keyword x; known: number friction"),
    "twice": (f"{ANCHOR}\nfix b all dcm/anchor {ANCHOR}",
              "Fix dcm/anchor: cells have a value anchors already, of another style"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_bad(lmp, scenes, case):
    text, pattern = CASES[case]
    fails(lmp, whole(scenes.doublet(), extra=f"fix a all dcm/anchor {text}\n"), pattern)


def test_nothing_moves(lmp, scenes):
    deck = whole(scenes.doublet(), extra=anchor(scenes), motion="")
    fails(lmp, deck, "Fix dcm/anchor: nothing solves for velocities.*add a fix dcm/motion")
