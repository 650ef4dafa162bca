"""Logic of tools/accuracy on made-up data: errors, orders, front, resuming, changed examples."""
import json
import math
import sys

import numpy as np
import pytest

from accuracy import decks, errors, scenes, tables
from accuracy.errors import Row
from accuracy.knobs import Knob, Value, knobs_of
from accuracy.points import Point, Result, Runner, digest
from accuracy.scenes import Quantity, Scene


class Made(Scene):
    """A scene whose result is a polynomial in dt."""

    name, about, hours = "made", "made up", 2.0
    defaults = dict(step="implicit 4")
    quantities = (Quantity("height", "height", "um"), Quantity("place", "place", "um", "size"))

    def write(self, folder, settings):
        (folder / "in.run").write_text(f"# step {settings['step']} {settings['tolerance']}\n")
        return ["-var", "step", settings["step"]]

    def read(self, folder):
        return json.loads((folder / "answer").read_text())


FAKE = """import json, sys, pathlib
kind, dt = sys.argv[sys.argv.index("-var") + 2].split()
here = pathlib.Path(".")
(here / "calls").open("a").write("once\\n")
if float(dt) > 30:
    (here / "log.lammps").write_text("print 'ERROR: no'\\nERROR: Fix x: too long (a.cpp:3)\\n")
    sys.exit(1)
(here / "log.lammps").write_text("Loop time of 1.5 on 1 procs for 25 steps with 3 atoms\\n" * 2)
(here / "answer").write_text(json.dumps(dict(
    height={"1": [10 + 0.1 * float(dt)], "2": [20.0]}, size={"": [12.0]},
    place={"1": [0, 0.03 * float(dt), 0.04 * float(dt)]})))
"""


@pytest.fixture
def runner(tmp_path, monkeypatch):
    """Runner of the made-up scene with a program of a few lines."""
    monkeypatch.setitem(scenes.SCENES, "made", Made())
    path = tmp_path / "fake.py"
    path.write_text(FAKE)
    digest.cache_clear()
    return Runner(tmp_path / "runs", [sys.executable, str(path)], say=lambda text: None)


def calls(runner, point):
    return len((runner.place(point) / "calls").read_text().splitlines())


def test_a_finished_run_is_not_repeated_and_a_changed_deck_is(runner, monkeypatch):
    point = Point.of("made", step="implicit 8")
    runner.run_all([point, point])
    assert calls(runner, point) == 1
    found = runner.result(point)
    assert found.steps == 50 and found.seconds > 0.0 and not found.note
    runner.run_all([point])
    assert calls(runner, point) == 1
    monkeypatch.setattr(Made, "write", lambda self, folder, settings:
                        (folder / "in.run").write_text("# other\n") and ["-var", "step",
                                                                         settings["step"]])
    digest.cache_clear()
    assert runner.result(point) is None
    runner.run_all([point])
    assert calls(runner, point) == 2


def test_a_run_that_fails_keeps_its_message_and_is_no_result_to_compare(runner):
    point = Point.of("made", step="implicit 40")
    runner.run_all([point])
    assert runner.result(point).note == "Fix x: too long (a.cpp:3)"
    assert errors.good([runner.result(point)]) is None


def test_the_default_is_one_point_however_it_is_written(runner):
    assert Point.of("made") == Point.of("made", step="implicit 4", seed=1)
    with pytest.raises(ValueError, match="no setting stepp; it has .* step "):
        Point.of("made", stepp="implicit 4")


def knob():
    return Knob("dt", "made", "time", tuple(
        Value(f"{dt} s", float(dt), dict(step=f"implicit {dt}")) for dt in (40, 16, 8, 4)),
        dict(step="implicit 1"), dict(step="implicit 2"), 2.0, 1.0)


def test_errors_and_orders_of_a_knob(runner):
    runner.run_all(knob().points())
    rows = errors.measure(knob(), runner.result)
    height = {r.label: r for r in rows if r.quantity == "height"}
    # of two cells one is off by 0.1 (dt - 1): root mean square over both
    right = math.sqrt((10.1**2 + 20.0**2) / 2)
    assert height["8 s"].own == pytest.approx(0.7 / math.sqrt(2))
    assert height["8 s"].relative == pytest.approx(0.7 / math.sqrt(2) / right)
    assert height["8 s"].uncertain == pytest.approx(0.1 / math.sqrt(2) / right)
    assert height["8 s"].cost == pytest.approx(height["8 s"].seconds / 2.0)
    assert height["4 s"].default and not height["8 s"].default
    assert height["40 s"].note and math.isnan(height["40 s"].relative)
    place = {r.label: r for r in rows if r.quantity == "place"}
    assert place["16 s"].own == pytest.approx(0.05 * 15)
    assert place["16 s"].relative == pytest.approx(0.05 * 15 / 12.0)
    # the error C (dt - 1) looks steeper than first order unless the reference is thought of
    with_reference = errors.orders(list(height.values()), finest=1.0)
    assert [p for _, _, p in with_reference] == pytest.approx([1.0, 1.0], abs=1e-6)
    assert all(p > 1.05 for _, _, p in errors.orders(list(height.values())))


@pytest.mark.parametrize("p", [0.5, 2.0 / 3.0, 1.0, 2.0, 3.0, -0.5])
def test_order_of_made_up_errors(p):
    e = [abs(x**p - 0.125**p) for x in (0.5, 0.25)]
    assert errors.order_of(0.5, e[0], 0.25, e[1], 0.125) == pytest.approx(p, abs=1e-6)
    assert errors.order_of(0.5, 0.5**p, 0.25, 0.25**p) == pytest.approx(p, abs=1e-6)


def test_order_where_there_is_none():
    assert math.isnan(errors.order_of(2.0, 0.0, 1.0, 0.1))
    assert math.isnan(errors.order_of(2.0, 1e9, 1.0, 1e-9))


def test_errors_below_the_uncertainty_of_the_reference_have_no_order():
    rows = [Row("s", "k", "time", f"{x}", x, "q", "um", True, relative=0.01 * x, uncertain=0.01)
            for x in (16.0, 8.0, 4.0, 2.0, 1.0)]
    assert [(a, b) for a, b, _ in errors.orders(rows)] == [("16.0", "8.0"), ("8.0", "4.0")]


def test_the_front_and_who_is_beaten():
    points = [(1.0, 1.0), (0.5, 2.0), (0.6, 3.0), (0.1, 9.0), (0.5, 2.5), (0.095, 9.5)]
    assert errors.front(points) == [0, 1, 3, 5]
    # 2.5 s are not clearly less than 3 s: times scatter by a quarter
    assert errors.beaten(points[2], points) == [1]
    assert errors.beaten(points[1], points) == []
    # nor is 0.5 clearly less than 0.52
    assert errors.beaten((0.52, 9.9), points) == []
    assert errors.front([]) == []


def test_the_cheapest_that_is_exact_enough_counts_the_reference():
    def row(e, cost, uncertain=0.0):
        return Row("s", "k", "time", "x", 1.0, "q", "um", True, relative=e, cost=cost,
                   uncertain=uncertain)
    rows = [row(0.2, 1.0), row(0.04, 5.0), row(0.03, 4.0, 0.2), row(0.01, 20.0, math.nan)]
    assert errors.cheapest(rows, 0.05).cost == 5.0
    assert errors.cheapest(rows, 0.01).cost == 20.0
    assert errors.cheapest(rows, 0.001) is None


def test_means_over_orientations_and_their_band():
    def result(*heights):
        return Result(values=dict(height={str(k): [h] for k, h in enumerate(heights)}))
    mean = errors.mean_of([result(1.0, 2.0), result(3.0, 2.0)])
    assert np.allclose([mean["height"]["0"], mean["height"]["1"]], 2.0)
    # one of them lost a cell: nothing to compare
    assert errors.mean_of([result(1.0, 2.0), result(3.0)]) == {}
    q = Quantity("height", "height", "um")
    assert all(map(math.isnan, errors.error(q, {}, mean)))


def test_pairs_of_one_orientation_leave_the_scatter_of_orientations_out():
    def result(height):
        return Result(values=dict(height={"": [height]}))
    found = [result(11.0), result(20.0), result(33.0)]
    reference = [result(10.0), result(20.0), result(30.0)]
    q = Quantity("height", "height", "um")
    own, relative = errors.root_mean_square(errors.pairs(q, found, reference))
    assert own == pytest.approx(math.sqrt((1.0 + 0.0 + 9.0) / 3))
    assert relative == pytest.approx(math.sqrt((0.01 + 0.0 + 0.01) / 3))


def test_every_setting_of_every_scene_is_known_and_writes_a_deck(tmp_path):
    for scene in (s for s in scenes.SCENES if s != "made"):
        for full in (False, True):
            for one in knobs_of(scene, full):
                points = one.points()
                assert points and all(p.scene == scene for p in points)
                # nothing is its own reference
                if one.kind not in ("model", "cost") and one.reference is not None:
                    same = {p for v in one.values for p in one.runs(v.changes)}
                    assert same.isdisjoint(one.runs(one.reference)), (scene, one.name)
                if one.kind in ("solver", "division") or one.name == "mesh":
                    assert any(map(one.is_default, one.values)), (scene, one.name)
        assert len(digest(Point.of(scene))) == 16


def test_an_example_that_has_changed_is_an_error():
    text = "pair_style  dcm/contact law dmt\nrun 10\n"
    assert decks.swap(text, "pair_style dcm/contact", "x") == "x\nrun 10\n"
    with pytest.raises(decks.DeckChanged, match="0 lines instead of 1 begin with 'fix move'"):
        decks.swap(text, "fix move", "x")
    with pytest.raises(decks.DeckChanged, match="'law maugis' is not there"):
        decks.put(text, "law maugis", "x")
    with pytest.raises(decks.DeckChanged, match="no line begins with 'dump'"):
        decks.until(text, "dump")


def test_summary_of_a_scene(runner, monkeypatch):
    monkeypatch.setattr(tables, "knobs_of", lambda scene, full: [knob()])
    runner.run_all(knob().points())
    made = tables.Map("made", runner.result)
    # place: 0.05 * 3 of 12 um; height: 0.1 * 3 um of one of two cells, which is more
    height = 0.3 / math.sqrt(2) / math.sqrt((10.1**2 + 20.0**2) / 2)
    assert made.summary()["steps"] == f"{tables.percent(height)} (height)"
    assert made.costs()["5 %, steps"].endswith(" s")
    assert made.costs()["1 %, steps"].startswith("not reached; 1.3 %")
    table = made.table()
    assert [row[:3] for row in table[:2]] == [
        ["dt", "40 s", "failed"], ["dt", "16 s", tables.percent(5 * height)]]
    assert "default" in table[-1][-1]


def test_a_run_that_measures_less_is_not_on_the_front(runner, monkeypatch):
    """It may be cheaper, and its largest error smaller, for what it leaves out."""
    monkeypatch.setattr(tables, "knobs_of", lambda scene, full: [knob()])
    runner.run_all(knob().points())
    path = runner.place(Point.of("made", step="implicit 8")) / "result.json"
    result = json.loads(path.read_text())
    del result["values"]["height"]
    path.write_text(json.dumps(result | dict(seconds=1e-9)))
    made = tables.Map("made", runner.result)
    assert {h.row.label for h in made.motion} == {"16 s", "4 s"}
    assert made.better_than_default() == []


def test_tables_can_be_read_again(runner, monkeypatch, tmp_path):
    monkeypatch.setattr(tables, "knobs_of", lambda scene, full: [knob()])
    runner.run_all(knob().points())
    made = tables.Map("made", runner.result)
    tables.write_all([made], tmp_path / "tables")
    lines = (tmp_path / "tables/points.csv").read_text().splitlines()
    assert len(lines) == 1 + 4 * 2
    assert "too long" in (tmp_path / "tables/failed.csv").read_text()
    assert "dt" in tables.text(made)
