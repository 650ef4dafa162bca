"""Styles that are named and have nothing to do change nothing, and wake up when there is something.

The decks are those of tools/bench effects, which counts what they cost.
"""

import numpy as np
import pytest
from effects_decks import EFFECTS, NO_POLARITY, OSMOSIS, POLARITY, SCENES, TRACER, deck, fixes
from effects_jobs import jobs_of

from support.runner import ROOT

IDLE = [effect for effect in EFFECTS if effect.idle is not None]
JOIN = "group none union none dcm\n"  # cells join the group that was empty


@pytest.fixture
def run(lmp):
    """run(deck, np): with the files that decks of the scene `pair` read."""

    def run_deck(text, np=1):
        files = {
            "cells.txt": SCENES["pair"].cells,
            "bile_duct.dcm": ROOT / "potentials/bile_duct.dcm",
        }
        return lmp(text, np=np, files=files)

    return run_deck


def places(result):
    frame = result.dump("end.dump")[-1]
    return frame.x, frame.v


def ending(text):
    return text + "write_dump dcm custom end.dump id xu yu zu vx vy vz modify format float %.17g\n"


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("effect", IDLE, ids=lambda effect: effect.name)
def test_nothing_to_do_changes_nothing(run, effect, np_):
    """To round-off: a list that is laid out for cells that may come adds in another order."""
    jobs = jobs_of(effect, "pair", "instructions")
    without, idle = (
        places(run(ending(jobs[name].deck()), np=np_)) for name in ("idle_base", "idle")
    )
    np.testing.assert_allclose(idle[0], without[0], rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(idle[1], without[1], rtol=0.0, atol=1e-9)
    assert np.abs(without[1]).max() > 1e-4  # the cells do move


def asleep_then_awake(run, fields, waking, output, np_):
    """The value of `output` at the end of a run, and after a second one begun with `waking`."""
    text = deck(SCENES["pair"], fields, 10, output)
    result = run(text + waking + "run 10\n", np=np_)
    return [rows[-1][output] for rows in result.runs]


@pytest.mark.parametrize("np_", [1, 2])
def test_a_lumen_is_found_when_cells_become_polar(run, np_):
    fields = fixes(NO_POLARITY, OSMOSIS)
    waking = "unfix polarity\nunfix osmosis\nunfix move\n" + "\n".join(
        [POLARITY, OSMOSIS, "fix move mobile dcm/motion scheme explicit\n"]
    )
    before, after = asleep_then_awake(run, fields, waking, "f_osmosis[1]", np_)
    assert before == 0.0 and after > 1.0


@pytest.mark.parametrize("np_", [1, 2])
def test_cells_that_join_get_tracers(run, np_):
    fields = fixes(POLARITY, TRACER.replace(" dcm dcm/", " none dcm/"))
    before, after = asleep_then_awake(run, fields, JOIN, "f_tracer[1]", np_)
    assert before == 0.0 and after > 190.0


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize(
    "line, output",
    [
        ("fix x none dcm/confine plane z 10.0", "f_x[3]"),
        ("fix x none dcm/volume", "f_x[1]"),
        ("fix x none dcm/traction vector 0 0 0.1", "f_x[4]"),
        ("fix x none dcm/adapt rest 0.9 faces lateral every 1", "f_x[3]"),
    ],
)
def test_cells_that_join_are_acted_on(run, line, output, np_):
    before, after = asleep_then_awake(run, fixes(line) | {"volume": ""}, JOIN, output, np_)
    assert before == 0.0 and after != 0.0


@pytest.mark.parametrize("np_", [1, 2])
def test_a_tension_that_begins_at_zero(run, np_):
    fields = fixes("variable T equal 0.1*(step>5)", "fix x dcm dcm/tension tension v_T")
    text = deck(SCENES["pair"], fields | {"thermo": "5"}, 10, "f_x")
    energies = [row["f_x"] for row in run(text, np=np_).thermo]
    assert energies[:2] == [0.0, 0.0] and energies[2] > 10.0


@pytest.mark.parametrize("np_", [1, 2])
def test_cells_that_join_move_at_random(run, np_):
    crawl = "fix x none dcm/motility seed 1 D 1e-2"
    still, moved = (
        places(run(ending(deck(SCENES["pair"], fixes(crawl), 10) + waking + "run 10\n"), np=np_))
        for waking in ("", JOIN)
    )
    assert np.abs(moved[0] - still[0]).max() > 1e-4
