"""Conversion between center-based and deformable cells: rules, volume, center, cycle, ranks."""

import numpy as np
import pytest

from lammps_dcm import read_divisions
from support.conversions import cells, cells_dump, convert, deformable, row_of_spheres, still
from support.cycle_decks import growth, same, sphere
from support.parameters import FILES, PLAIN

COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"
ATOMS, EDGES = 1 + 42 + 80, 120  # of a deformable cell of an icosphere of level 1
K_V = 2.5
COUNTS = ["atoms", "bonds", "dihedrals", "n=f_growth", "to=f_convert[1]", "back=f_convert[2]"]


# --- rules ----------------------------------------------------------------------------------------


def test_region(lmp, scenes):
    """Inside IN: deformable; outside OUT: back; between the two a cell stays what it is."""
    scene = row_of_spheres(scenes)  # x = -28, -14, 0, 14, 28
    deck = "region in block -20 5 EDGE EDGE EDGE EDGE\n"
    deck += "region out block -30 20 EDGE EDGE EDGE EDGE\n"
    deck = still(scene, "region in out").replace("fix convert", deck + "fix convert")
    deck += cells_dump(scenes, 5) + scenes.thermo(COUNTS) + "run 10\n"
    deck += "displace_atoms all move 10 0 0 units box\nrun 10\n"  # x = -4 and 10: both stay
    deck += "displace_atoms all move 11 0 0 units box\nrun 10\n"  # 7 stays, 21 goes back
    result = lmp(deck.replace("block -37.0 37.0", "block -37.0 70.0"))
    frames = {frame.step: deformable(frame) for frame in result.dump("cells.txt")}
    assert frames[0] == frames[5] == set()
    assert frames[10] == frames[15] == {2, 3}
    assert frames[20] == {1, 2, 3}
    # x = -7, 7, 21, 35, 49
    assert frames[30] == {1, 2}
    row = result.thermo[-1]
    assert (row["v_to"], row["v_back"], row["v_n"]) == (3, 1, 5)
    assert (row["Atoms"], row["Bonds"], row["Diheds"]) == (2 * ATOMS + 3, 2 * EDGES, 2 * EDGES)


def test_near(lmp, scenes):
    """Closer than d1 to a cell of the group: deformable; farther than d2 from all: back."""
    scene = row_of_spheres(scenes)
    deck = still(scene, "near seed 16 22")
    deck = deck.replace("fix growth", "group seed molecule 3\nfix growth")
    deck += "group other molecule 2\n" + cells_dump(scenes, 10) + "run 10\n"
    for move in (-6, -4):  # molecule 2 at 20, then 24 from 3, and past 1
        deck += f"displace_atoms other move {move} 0 0 units box\nrun 10\n"
    frames = {f.step: deformable(f) for f in lmp(deck).dump("cells.txt")}
    assert frames[10] == {2, 3, 4}  # the cell itself is at distance 0
    assert frames[20] == {2, 3, 4}
    assert frames[30] == {3, 4}


def test_near_across_a_periodic_border(lmp, scenes):
    scene = row_of_spheres(scenes, boundary="p p p")  # length 74: 1 and 5 are 18 apart
    deck = still(scene, "near seed 18.5 30").replace("12.0", "14.0")
    deck = deck.replace("fix growth", "group seed molecule 5\nfix growth")
    frames = lmp(deck + cells_dump(scenes, 10) + "run 10\n").dump("cells.txt")
    assert deformable(frames[-1]) == {1, 4, 5}


def test_variable(lmp, scenes):
    """Positive: deformable; negative: back; zero: stays."""
    scene = row_of_spheres(scenes)
    want = "variable want atom (mol<=3)*(step<25)-(mol>1)*(step>=35)\n"
    deck = want + still(scene, "variable v_want") + cells_dump(scenes, 10) + "run 50\n"
    frames = {f.step: deformable(f) for f in lmp(deck).dump("cells.txt")}
    assert frames[20] == frames[30] == {1, 2, 3}
    assert frames[40] == frames[50] == {1}


@pytest.mark.parametrize("start", ["spheres", "deformable"])
def test_other_form_from_nothing(lmp, scenes, start):
    """Decks that begin with one form only, with contact and motion."""
    scene = scenes.Scene((24.0, 16.0, 16.0), "f f f")
    for x in (-9.6, 0.0, 9.6):
        (scene.cbm if start == "spheres" else scene.dcm)(x, 0.1, 0.2, 5.0)
    sign = 1 if start == "spheres" else -1
    deck = f"variable want atom {sign}*(mol==2)\n" + scene.head() + scene.forces("growth 1.3")
    deck += growth(scene, "") + convert("variable v_want") + scene.motion()
    deck += cells_dump(scenes) + "timestep 1.0\nrun 60\n"
    frames = lmp(deck).dump("cells.txt")
    assert deformable(frames[-1]) == ({2} if start == "spheres" else {1, 3})
    for it in cells(frames[-1]).values():
        assert np.isfinite(it[4]).all()
        assert it[2] == pytest.approx(sphere(5.0), rel=0.1)


# --- what stays -----------------------------------------------------------------------------------


def test_volume_and_center(lmp, scenes):
    """Of a lone cell, at any place and size; neighbors at a distance that do not touch."""
    scene = scenes.Scene((30.0, 12.0, 12.0), "f f f")
    for x, radius in ((-20.0, 4.0), (-5.0, 5.5), (15.0, 7.0)):
        scene.cbm(x, 0.7, -1.3, radius)
    deck = "variable want atom 1-2*(step>=20)\n" + still(scene, "variable v_want")
    frames = [cells(f) for f in lmp(deck + cells_dump(scenes, 10) + "run 20\n").dump("cells.txt")]
    for m in (1, 2, 3):
        assert [frame[m][0] for frame in frames] == [False, True, False]
        for frame in frames[1:]:
            for k in (1, 2):
                assert frame[m][k] == pytest.approx(frames[0][m][2], rel=1e-10)
            assert frame[m][4] == pytest.approx(frames[0][m][4], abs=1e-10)


def test_volume_in_contact(lmp, scenes):
    """Flattened by three neighbors: the volume is the sphere's, the mean node near its place."""
    scene = scenes.Scene(20.0, "f f f")
    for x, y in ((0.0, 0.0), (9.5, 0.0), (-4.7, 8.0), (-4.7, -8.0)):
        scene.cbm(x, y, 0.0, 5.0)
    deck = "variable want atom mol==1\n" + still(scene, "variable v_want", "every 10")
    frames = [cells(f) for f in lmp(deck + cells_dump(scenes, 10) + "run 10\n").dump("cells.txt")]
    assert frames[1][1][0]
    assert frames[1][1][2] == pytest.approx(frames[0][1][2], rel=1e-10)
    assert np.linalg.norm(frames[1][1][4] - frames[0][1][4]) < 0.02 * 5.0


def test_there_and_back_keeps_the_pressure(lmp, scenes):
    """V0 = V exp(p/K_V) comes back with the pressure; the sphere has the volume V in between."""
    scene = scenes.single_cell(boundary="f f f", options="rotate 3 rest 0.95")
    deck = "variable want atom (step>=200)-2*(step>=100&&step<200)\n"
    deck += still(scene, "variable v_want", "every 100 mesh icosphere 1")
    deck = deck.replace("timestep", scene.motion() + "timestep") + cells_dump(scenes) + "run 99\n"
    frames = lmp(deck + "unfix motion\nrun 102\n").dump("cells.txt")
    at = {frame.step: cells(frame)[1] for frame in frames}
    before, as_sphere, after = at[99], at[100], at[201]
    assert before[0] and not as_sphere[0] and not at[199][0] and after[0]
    assert before[3] > 0.05
    assert as_sphere[2] == pytest.approx(before[2], rel=1e-10)
    assert after[1] == pytest.approx(before[1], rel=1e-10)
    assert after[2] == pytest.approx(before[2], rel=1e-10)
    assert after[3] == pytest.approx(before[3], rel=1e-8)
    assert after[4] == pytest.approx(before[4], abs=1e-10)


def test_cycle_and_lineage_go_on(lmp, scenes):
    """Converted twice in its cycle, a cell grows by the law and divides in time."""
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 5.0)
    scene.cbm(13.0, 13.0, 13.0, 5.0)
    deck = "variable want atom (mol==1)*(step<60)-(mol==1)*(step>=60)\n"
    deck += still(scene, "variable v_want", "every 30 mesh icosphere 1", "cycle_time 100")
    deck += "fix division all dcm/division seed 4 log division.log\n" + cells_dump(scenes)
    result = lmp(deck + scenes.thermo(COUNTS) + "run 205\n")
    for frame in result.dump("cells.txt")[:100]:
        for m, it in cells(frame).items():
            assert it[0] == (m == 1 and 30 <= frame.step < 60) or frame.step == 0
            factor = 1 + min(frame.step / 95, 1)
            # a sphere takes the volume that the still nodes of the deformable cell have kept
            kept = (1 + 30 / 95) / (1 + 60 / 95) if m == 1 and frame.step >= 60 else 1
            assert it[1] == pytest.approx(factor * kept * sphere(5.0), rel=1e-9)
    log = read_divisions(result.path / "division.log")
    assert list(log.step) == [100] * 2 + [200] * 4
    assert list(log.mother) == [1, 2, 3, 4, 5, 6]
    assert list(log.generation) == [1, 1, 2, 2, 2, 2]


def test_compression_slows_who_became_a_sphere(lmp, scenes):
    """In a deck that began with deformable cells only; Hertz' force as in test_growth.py."""
    scene = scenes.Scene(20.0, "f f f", parameters=PLAIN)
    for x in (-4.75, 4.75):
        scene.dcm(x, 0.0, 0.0, 5.0)
    grown = []
    for compression in ("", "compression 0.002 2"):
        deck = "variable want atom -1\n" + scene.head() + scene.forces("growth 1.4")
        deck += growth(scene, f"cycle_time 2000 {compression}") + convert("variable v_want")
        deck += cells_dump(scenes, 10) + "timestep 1.0\nrun 1000\n"
        frames = lmp(deck, files=FILES).dump("cells.txt")
        assert deformable(frames[0]) == {1, 2} and deformable(frames[1]) == set()
        grown.append(cells(frames[-1])[1][1] / cells(frames[1])[1][1])
    assert grown[0] == pytest.approx((1 + 1000 / 1900) / (1 + 10 / 1900), rel=1e-9)
    assert grown[1] < 0.97 * grown[0]


# --- in a tissue: neighbors, ranks, restarts ------------------------------------------------------


def tissue(scenes):
    """Three deformable and four center-based cells in contact; at step 40 two of them change."""
    scene = scenes.hybrid(level=1, boundary="p p p", box=(27.0, 27.0, 18.0), shift=(3.0, 2.0, 0.5))
    rest = "fix cell all dcm/cell\n" + scene.volume() + growth(scene, "cycle_time 2000")
    rest += "variable want atom (mol==4)-(mol==2)\n"
    rest += convert("variable v_want", "every 40 mesh icosphere 1") + scene.motion()
    rest += cells_dump(scenes, 10) + scenes.dump(COLUMNS, 1) + "timestep 1.0\n"
    coeff = f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
    return scene.head() + scene.cortex() + "pair_style dcm/contact\n", coeff, rest


def test_neighbors_stay_where_they_are(lmp, scenes):
    """Less than a tenth of a radius in the step after, for each node and sphere."""
    head, coeff, rest = tissue(scenes)
    frames = {f.step: f for f in lmp(head + coeff + rest + "run 60\n").dump()}
    for step in (40, 41, 42, 50):
        a, b = frames[step - 1], frames[step]
        if step == 40:
            assert set(a["type"][a["mol"] == 4]) == {4} and set(b["type"][b["mol"] == 2]) == {4}
        for m in (1, 3, 5, 6, 7):
            moved = b.x[b["mol"] == m] - a.x[a["mol"] == m]
            assert np.linalg.norm(moved, axis=1).max() < 0.1 * 5.0


def test_1_2_and_4_ranks_agree(lmp, scenes):
    head, coeff, rest = tissue(scenes)
    one = lmp(head + coeff + rest + "run 60\n").dump()
    for np_ in (2, 4):
        other = lmp(head + coeff + rest + "run 60\n", np=np_).dump()
        for a, b in zip(one, other, strict=True):
            assert np.array_equal(a["mol"], b["mol"]) and np.array_equal(a["type"], b["type"])
            assert np.abs(a.x - b.x).max() < 1e-9


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("at", [20, 50])
def test_restart(lmp, scenes, np_, at):
    """Before and after the conversion."""
    head, coeff, rest = tissue(scenes)
    rest += f"restart {at} r.*\n"
    processors = "processors * 1 1\n"
    whole = lmp(processors + head + coeff + rest + "run 60\n", np=np_)
    again = lmp(
        processors + f"read_restart r.{at}\n" + coeff + rest + f"run {60 - at}\n",
        np=np_,
        files={f"r.{at}": whole.path / f"r.{at}"},
    )
    for a, b in zip(whole.dump()[at:], again.dump(), strict=True):
        same(a, b, COLUMNS)
