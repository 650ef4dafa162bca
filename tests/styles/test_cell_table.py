"""The table of cells: requests that go with their asker, columns by name, pressure as a sum."""

import re

import numpy as np
import pytest

from support.bad_decks import fails, whole
from support.cycle_decks import counting, growth, same, sphere

K_V = 2.5  # of hepatoblast in both parameter files of the tests
KIND = "compute p all property/atom kind vertex1 vertex2 vertex3\n"
FACE = 4  # c_p[1]


# --- requests -------------------------------------------------------------------------------------


def reach(frame):
    """Distance of the farthest vertex from the centroid, of every face, by atom IDs."""
    x = dict(zip(frame["id"].astype(int), frame.x, strict=True))
    faces = np.flatnonzero(frame["c_p[1]"] == FACE)
    vertices = frame.vectors("c_p[2]", "c_p[3]", "c_p[4]")[faces].astype(int)
    corners = np.array([[x[v] for v in row] for row in vertices])
    centroid = corners.mean(axis=1)
    return frame["radius"][faces], np.linalg.norm(corners - centroid[:, None], axis=2).max(axis=1)


@pytest.mark.parametrize("np_", [1, 2])
def test_contact_range_goes_with_the_pair_style(lmp, scenes, np_):
    """With contacts faces reach half the range farther than their vertices, without them not."""
    scene = scenes.doublet(boundary="f f f")
    deck = scene.head() + scene.cortex() + scene.contact("h0 0.25 range 2.0")
    deck += "fix cell all dcm/cell\n" + scene.volume() + KIND
    deck += scenes.dump("id mol type radius xu yu zu c_p[1] c_p[2] c_p[3] c_p[4]")
    deck += "run 1\npair_style none\ncomm_modify cutoff 15\nrun 1\n"
    before, _, after = lmp(deck, np=np_).dump()
    radius, farthest = reach(before)
    assert len(radius) == 160
    assert radius == pytest.approx(farthest + 1.0, rel=1e-12)
    radius, farthest = reach(after)
    assert radius == pytest.approx(farthest, rel=1e-12)


def test_largest_of_several_contact_ranges(lmp, scenes):
    """Another range in the second run replaces that of the first, also a smaller one."""
    scene = scenes.doublet(boundary="f f f")
    deck = scene.head() + scene.cortex() + "fix cell all dcm/cell\n" + scene.volume() + KIND
    deck += scenes.dump("id mol type radius xu yu zu c_p[1] c_p[2] c_p[3] c_p[4]")
    for range_ in (2.0, 1.5):
        deck += scene.contact(f"h0 0.25 range {range_}") + "run 1\n"
    for frame, range_ in zip(lmp(deck).dump()[1:], (2.0, 1.5), strict=True):
        radius, farthest = reach(frame)
        assert radius == pytest.approx(farthest + 0.5 * range_, rel=1e-12)


def test_curvature_goes_and_comes_with_its_compute(lmp, scenes):
    """Nobody asks in the second run; in the third it is there again, the same."""
    scene = scenes.single_cell(boundary="f f f")
    ask = "compute k all dcm/face curvature\n"
    show = scenes.dump("id c_k", 1, "{}", "all")
    deck = scene.head() + scene.cortex() + "comm_modify cutoff 12\nfix cell all dcm/cell\n"
    deck += scene.volume() + ask + show.format(*["one"] * show.count("{}")) + "run 0\nundump one\n"
    deck += "uncompute k\nrun 0\n" + ask + show.format(*["two"] * show.count("{}")) + "run 0\n"
    result = lmp(deck)
    same(result.dump("one")[0], result.dump("two")[0], "c_k")
    faces = result.dump("one")[0]["c_k"]
    assert np.count_nonzero(faces) == 80
    assert faces[faces != 0] == pytest.approx(2 / 6.0, rel=0.1)  # of a sphere: 2/R


# --- columns by name ------------------------------------------------------------------------------


def columns(scenes, names, every=1, file="cells.txt"):
    """One line per cell and step with any values of compute dcm/cell."""
    names = names.split()
    fields = [f"c_of[{k}]" for k in range(1, len(names) + 1)] if len(names) > 1 else ["c_of"]
    return (
        "group cells type 1 4\n"
        f"compute of cells dcm/cell {' '.join(names)}\n"
        + scenes.dump("id mol type " + " ".join(fields), every, file, "cells")
    )


def table(result, names, file="cells.txt"):
    """step -> molecule -> name -> value."""
    names = names.split()
    fields = [f"c_of[{k}]" for k in range(1, len(names) + 1)] if len(names) > 1 else ["c_of"]
    return {
        frame.step: {
            int(m): {name: frame[field][k] for name, field in zip(names, fields, strict=True)}
            for k, m in enumerate(frame["mol"])
            if frame["type"][k] in (1, 4)
        }
        for frame in result.dump(file)
    }


CYCLE = "in_cycle cycle_time volume_born volume_newborn progress rounding_factor"


@pytest.mark.parametrize("np_", [1, 2])
def test_columns_of_growth(lmp, scenes, np_):
    """cycle_time 100, linear, rounding 0.2 0.9: grown at 80, then rest lengths to 0.9 at 100.

    Of a deformable cell that cannot move and a sphere, both outside of any contact.
    """
    scene = scenes.single_cell(boundary="f f f", options="rotate 3 rest 1")
    scene.cbm(11.0, 11.0, 11.0, 3.0)
    names = CYCLE + " volume0 phase"
    deck = scene.head() + scene.cortex() + "fix cell all dcm/cell\ncomm_modify cutoff 12\n"
    deck += growth(scene, "cycle_time 100 rounding 0.2 0.9")
    deck += columns(scenes, names) + "timestep 1.0\nrun 105\n"
    rows = table(lmp(deck, np=np_), names)
    for step, cells in rows.items():
        for m in (1, 2):
            it, born = cells[m], rows[0][m]["volume0"]
            assert it["in_cycle"] == 1.0 and it["cycle_time"] == 100.0
            assert it["volume_born"] == pytest.approx(born, rel=1e-14)
            assert it["volume_newborn"] == 0.0  # measured with `until volume`, or at a division
            # it waits for a division that does not come
            assert it["progress"] == pytest.approx(min(step, 100) / 100, abs=1e-9)
            part = min(max(step - 80, 0) / 20, 1)
            assert it["rounding_factor"] == pytest.approx(1 - 0.1 * part, abs=1e-9)
            assert it["volume0"] == pytest.approx(born * (1 + min(step / 80, 1)), rel=1e-9)
            assert it["phase"] == (0 if step < 80 else 1 if step < 100 else 2)


def test_pressure_columns_of_growth(lmp, scenes):
    """When it rounds up: the pressure at that moment, and the largest since."""
    scene = scenes.single_cell(boundary="f f f")
    names = "pressure_before pressure_rounding pressure phase"
    deck = scene.head() + scene.cortex() + "fix cell all dcm/cell\ncomm_modify cutoff 12\n"
    deck += scene.volume() + growth(scene, "cycle_time 100 rounding 0.2 0.9") + scene.motion()
    deck += columns(scenes, names) + "timestep 1.0\nrun 110\n"
    rows = {step: cells[1] for step, cells in table(lmp(deck), names).items()}
    begin = min(step for step, it in rows.items() if it["phase"] == 1)
    assert begin == 80
    largest = 0.0
    for step, it in rows.items():
        if step < begin:
            assert it["pressure_before"] == it["pressure_rounding"] == 0.0
            continue
        # it looks at the start of a step, at what the step before has left
        largest = max(largest, rows[step - 1]["pressure"])
        assert it["pressure_before"] == rows[begin - 1]["pressure"]
        assert it["pressure_rounding"] == largest
    assert largest > rows[begin - 1]["pressure"] > 0.0


def test_born_and_newborn_of_daughters(lmp, scenes):
    """Rest volume: half the mother's. Volume at birth: half of what the mother had."""
    scene = scenes.Scene(20.0, "f f f")
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    names = "volume_born volume_newborn progress rounding_factor volume0 generation mother birth"
    deck = scene.head() + scene.forces() + growth(scene, "cycle_time 60")
    deck = deck.replace("neighbor 0.6", "neighbor 0.8")  # for necks between spheres to come
    deck += "fix division all dcm/division seed 7 log division.log\n" + scene.motion(options="")
    deck += columns(scenes, names) + "timestep 1.0\nrun 70\n"
    result = lmp(deck)
    rows = table(result, names)
    line = [r.split() for r in (result.path / "division.log").read_text().splitlines()][-1]
    assert line[0] == "60"
    mother = rows[59][1]
    assert set(rows[60]) == {2, 3}
    for m in (2, 3):
        it = rows[60][m]
        assert it["volume_born"] == it["volume0"] == 0.5 * mother["volume0"]
        assert it["volume_newborn"] == pytest.approx(0.5 * float(line[10]), rel=1e-7)
        assert it["progress"] == 0.0 and it["rounding_factor"] == 1.0
        assert (it["generation"], it["mother"], it["birth"]) == (1.0, 1.0, 60.0)
        assert rows[70][m]["progress"] == pytest.approx(10 / 60, rel=1e-12)


def test_cells_outside_of_growth(lmp, scenes):
    """Types without cycle time rest in the cycle; cells out of the group are not in it at all."""
    scene = scenes.Scene(20.0, "f f f")
    for x in (-14.0, 0.0, 14.0):
        scene.cbm(x, 0.0, 0.0, 5.0)
    names = "in_cycle progress cycle_time phase generation mother birth"
    deck = scene.head() + "comm_modify cutoff 12\ngroup some molecule 1 2\n"
    deck += growth(scene, "cycle_time 10", "some") + columns(scenes, names)
    rows = table(lmp(deck + "timestep 1.0\nrun 4\n"), names)
    assert [rows[4][m]["in_cycle"] for m in (1, 2, 3)] == [1, 1, 0]
    assert [rows[4][m]["progress"] for m in (1, 2, 3)] == pytest.approx([0.4, 0.4, 0], abs=1e-12)
    assert [rows[4][m]["phase"] for m in (1, 2, 3)] == [0, 0, 3]


@pytest.mark.parametrize("np_", [1, 2])
def test_lives_without_growth(lmp, scenes, np_):
    """Nobody makes cells grow: first generation, no mother, born when first seen, quiescent."""
    scene = scenes.hybrid(boundary="f f f")
    names = "mother generation birth phase"
    deck = scene.head() + "timestep 0.5\nreset_timestep 8\n" + scene.forces()
    deck += columns(scenes, names) + "run 2\n"
    rows = table(lmp(deck, np=np_), names)
    assert sorted(rows[10]) == [1, 2, 3, 4, 5, 6, 7]
    for cells in rows.values():
        for it in cells.values():
            assert (it["mother"], it["generation"], it["phase"]) == (0, 0, 3)
            assert it["birth"] == rows[8][1]["birth"]


@pytest.mark.parametrize("np_", [1, 2])
def test_rest_ratio(lmp, scenes, np_):
    """V0/V of a deformable cell, exp(p/K_V), is remembered by the sphere it becomes, then 1."""
    scene = scenes.single_cell(boundary="f f f", options="rotate 3 rest 0.95")
    names = "rest_ratio volume volume0 pressure kind"
    deck = "variable want atom (step>=60)-2*(step>=30&&step<60)\n" + scene.head() + scene.cortex()
    deck += "comm_modify cutoff 14\nfix cell all dcm/cell\n" + scene.volume()
    deck += "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_want every 10 "
    deck += "mesh icosphere 1\n" + scene.motion() + columns(scenes, names) + "timestep 1.0\n"
    rows = table(lmp(deck + "run 60\n", np=np_), names)
    assert rows[29][1]["rest_ratio"] == 1.0  # never converted
    assert [rows[k][1]["kind"] for k in (29, 30, 59, 60)] == [2, 1, 1, 2]
    moved = rows[30][1]["volume"]  # the mesh moved once more before it was converted
    ratio = rows[29][1]["volume0"] / moved
    assert ratio > 1.001
    assert rows[30][1]["rest_ratio"] == rows[59][1]["rest_ratio"] == pytest.approx(ratio, rel=1e-12)
    assert rows[60][1]["rest_ratio"] == 1.0
    assert rows[60][1]["volume0"] == pytest.approx(ratio * rows[60][1]["volume"], rel=1e-9)


def test_unknown_value(lmp, scenes):
    """Before the first step, with all that would be known: its own and those of the styles."""
    scene = scenes.doublet()
    extra = f"fix growth all dcm/growth {scene.map} seed 1 cycle_time 1000\n"
    extra += "compute of all dcm/cell volume polarity\n"
    deck = whole(scene, extra=extra)
    fails(lmp, deck, "Compute dcm/cell: unknown value polarity; known: volume volume0 area",
          "progress", "cycle_time", "rounding_factor", "volume_born",
          "pressure_before")  # fmt: skip
    deck = deck.replace("polarity", "rest_ratio")
    fails(lmp, deck, "unknown value rest_ratio; known:.*progress")


def test_values_of_growth_without_growth(lmp, scenes):
    deck = whole(scenes.doublet(), extra="compute of all dcm/cell progress\n")
    result = fails(lmp, deck, "Compute dcm/cell: unknown value progress; known: volume")
    assert "progress" not in result.error.split("known:")[1]


def test_value_before_its_column_exists(lmp, scenes):
    """A dump between the definition of the compute and the next run: an error, no crash."""
    deck = counting(8, "cycle_time 100") + "run 1\ncompute of all dcm/cell progress\n"
    deck += "write_data x.data nofix nocoeff\nwrite_dump all custom x.txt id c_of\n"
    result = lmp.run(deck)
    assert result.returncode == 1, result.tail()
    assert re.search("Compute dcm/cell.*run 0", result.error), result.tail()


def test_columns_go_with_their_owner(lmp, scenes):
    """Without fix dcm/growth its values are unknown again, and another one may bring them anew."""
    deck = counting(8, "cycle_time 100") + columns(scenes, "progress") + "run 10\n"
    again = "fix growth all dcm/growth NULL d d d c seed 3 cycle_time 50\n"
    rows = table(lmp(deck + "unfix growth\n" + again + "run 10\n"), "progress")
    assert rows[10][1]["progress"] == pytest.approx(0.1, rel=1e-12)
    assert rows[20][1]["progress"] == pytest.approx(0.2, rel=1e-12)  # from the start, 10 of 50

    result = lmp.run(deck + "unfix growth\nrun 10\n")
    assert result.returncode == 1, result.tail()
    assert "unknown value progress; known: volume" in result.error


# --- pressure -------------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
def test_pressure_is_that_of_the_fixes_there_are(lmp, scenes, np_):
    """Two fixes for one cell each; without one of them its cell has none, and then the other."""
    scene = scenes.Scene(25.0, "f f f")
    scene.dcm(-8.0, 0.0, 0.0, 6.0)
    scene.dcm(8.0, 0.0, 0.0, 5.0)
    deck = scene.head() + scene.cortex() + "comm_modify cutoff 12\nfix cell all dcm/cell\n"
    for name in ("one", "two"):
        deck += f"group {name} molecule {1 if name == 'one' else 2}\n"
        deck += scene.volume().replace("fix volume all", f"fix {name} {name}")
    names = "pressure volume volume0"
    deck += scene.motion() + columns(scenes, names, 20) + "timestep 1.0\nrun 20\n"
    deck += "unfix two\nrun 20\nunfix one\nrun 20\n"
    frames = lmp(deck, np=np_).dump("cells.txt")
    on = [(1, 1), (1, 1), (1, 0), (0, 0)]
    for frame, acting in zip(frames, np.array(on), strict=True):
        cells = frame["type"] == 1
        p, V, V0 = (frame[f"c_of[{k}]"][cells] for k in (1, 2, 3))
        expected = -K_V * np.log(V / V0) * acting
        assert p == pytest.approx(expected, rel=1e-9, abs=1e-14)
    assert abs(frames[1]["c_of[1]"][0]) > 0.01  # there was something to forget


def test_rest_volume_of_spheres(lmp, scenes):
    """The table has the volume of spheres, also of those that grow."""
    deck = counting(8, "cycle_time 100 rounding 0 1") + columns(scenes, "volume0 volume")
    rows = table(lmp(deck + "run 30\n"), "volume0 volume")
    for step, cells in rows.items():
        for it in cells.values():
            assert it["volume0"] == pytest.approx(sphere(5.0) * (1 + step / 100), rel=1e-12)
            assert it["volume"] == pytest.approx(it["volume0"], rel=1e-12)


def test_cells_that_nothing_grows_any_more_are_quiescent(lmp):
    """Growing (0) with fix dcm/growth, at rest (3) once it is gone: no cell stays on its way."""
    deck = counting(4, "cycle_time 100") + "compute of all dcm/cell phase\n"
    deck += "dump d all custom 1 phase.txt id c_of\ndump_modify d sort id\n"
    result = lmp(deck + "run 2\nunfix growth\nrun 2\n")
    phases = {frame.step: list(frame["c_of"]) for frame in result.dump("phase.txt")}
    assert phases[1] == phases[2] == [0.0] * 4
    assert phases[3] == phases[4] == [3.0] * 4
