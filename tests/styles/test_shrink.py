"""fix dcm/motion maxmove X shrink: a step in which a node would move too far becomes shorter."""

import re

import numpy as np
import pytest

from support.bad_decks import fails
from support.cycle_decks import same

COLUMNS = "id mol type xu yu zu vx vy vz fx fy fz"
PULL = "group tip id 10\nfix tip tip addforce 0 0 {force}\n"


def pulled(scenes, options, dt, run, *, force=8.0, every=10, head=None, more="", boundary="f f f"):
    """A node of a cell drawn out at once: it moves fast at first."""
    count = ["n=f_motion[11]"] if "shrink" in options else []
    scene = scenes.single_cell(level=1, box=40.0, boundary=boundary)
    return (
        (head or scene.head())
        + scene.forces()
        + PULL.format(force=force)
        + scene.motion(options=f"tolerance 1e-12 {options}")
        + more
        + scenes.dump(COLUMNS, every)
        + scenes.thermo(["time", "dt"] + count, 1)
        + (f"timestep {dt!r}\n" if dt else "")
        + run
    )


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_goes_on_where_a_step_is_too_long(lmp, scenes, scheme):
    """By default an error that names the remedy; with shrink the way of steps a tenth as long."""
    options = f"scheme {scheme} maxmove 0.02"
    stopped = lmp.run(pulled(scenes, options, 1.0, "run 100\n"))
    assert re.search(
        r"would move by .*or let such steps become shorter, maxmove X shrink", stopped.error
    )
    result = lmp(pulled(scenes, options + " shrink", 1.0, "run 100\n"))
    steps = [row["Dt"] for row in result.thermo]
    assert min(steps) < 0.5 and steps[-1] == 1.0
    short = sum(dt < 1.0 for dt in steps[:-1])  # that of the last line is the step after the run
    assert re.search(
        rf"dcm/motion: {short} of 100 steps of this run were shorter than the "
        rf"timestep 1, the shortest {min(steps):.4g}",
        result.log,
    )
    assert result.log.count("steps are shorter than the timestep") == 1
    for row, dt, after in zip(result.thermo, steps, result.thermo[1:]):
        assert after["Time"] - row["Time"] == pytest.approx(dt, rel=1e-9)
    # at the same time the same place, to the first order in steps of 1 s
    end = result.thermo[-1]["Time"]
    fine = lmp(
        pulled(
            scenes,
            f"scheme {scheme} maxmove 1 stop {end}",
            0.02,
            "run 1000000\n",
            every=round(end / 0.02),
        )
    )
    a, b = result.dump()[-1], fine.dump()[-1]
    way = np.linalg.norm(b.x - fine.dump()[0].x, axis=1)
    assert np.linalg.norm(a.x - b.x, axis=1).max() < 0.02 * way.max()


def test_nothing_happens_where_steps_are_short(lmp, scenes):
    """Bit for bit the run without the option, and no word of it."""
    plain = lmp(pulled(scenes, "", 0.05, "run 20\n", force=1.0))
    with_it = lmp(pulled(scenes, "maxmove 0.25 shrink", 0.05, "run 20\n", force=1.0))
    assert np.array_equal(plain.dump()[-1].x, with_it.dump()[-1].x)
    assert "shorter" not in with_it.log and with_it.thermo[-1]["v_n"] == 0


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_1_2_3_and_4_ranks_take_the_same_steps(lmp, scenes, scheme):
    deck = pulled(scenes, f"scheme {scheme} maxmove 0.02 shrink", 1.0, "run 60\n")
    one = lmp(deck)
    for n in (2, 3, 4):
        other = lmp(deck, np=n)
        assert [row["Dt"] for row in other.thermo] == [row["Dt"] for row in one.thermo]
        assert np.abs(other.dump()[-1].x - one.dump()[-1].x).max() < 1e-8


@pytest.mark.parametrize("at", [3, 40])  # among short steps, and after them
def test_restart_is_exact(lmp, scenes, at):
    """Bit for bit, and a run in two parts is one but for the order of sums; the short step at which
    the file is written is not the timestep to come back to."""
    options, rest = "maxmove 0.02 shrink", 60 - at
    run = f"run {at}\nwrite_restart a.restart\nrun {rest}\n"
    parts = lmp(pulled(scenes, options, 1.0, run, every=60))
    again = lmp(
        pulled(scenes, options, None, f"run {rest}\n", every=60, head="read_restart a.restart\n"),
        files={"a.restart": parts.path / "a.restart"},
    )
    same(again.dump()[-1], parts.dump()[-1], COLUMNS)
    for name in ("Time", "Dt"):
        assert [r[name] for r in again.thermo] == [r[name] for r in parts.runs[1]]
    whole = lmp(pulled(scenes, options, 1.0, "run 60\n", every=60))
    assert [r["Dt"] for r in whole.thermo] == [r["Dt"] for r in parts.runs[0] + parts.runs[1][1:]]
    assert whole.thermo[3]["Dt"] < 0.5 < whole.thermo[-1]["Dt"]
    assert np.abs(whole.dump()[-1].x - parts.dump()[-1].x).max() < 1e-10


def test_timestep_of_the_deck_counts(lmp, scenes):
    """A timestep given between runs, or after a restart, is the one that steps come back to."""
    result = lmp(pulled(scenes, "maxmove 0.02 shrink", 1.0, "run 3\ntimestep 0.7\nrun 60\n"))
    assert result.runs[0][-1]["Dt"] < 1.0
    assert result.runs[1][-1]["Dt"] == 0.7 and max(r["Dt"] for r in result.runs[1]) == 0.7
    assert "shorter than the timestep 0.7" in result.log


def test_a_step_that_cannot_be_short_enough(lmp, scenes):
    """Not even in a thousandth of the step: the error, with the timestep and what was tried."""
    result = lmp.run(pulled(scenes, "maxmove 0.02 shrink", 1.0, "run 10\n", force=3e5))
    assert re.search(
        r"would move by .* at step \d+.*maxmove 0.02; use a smaller timestep than 1 "
        r"\(it was tried down to 0.001\)",
        result.error,
    )


def test_who_does_not_go_with_it(lmp, scenes):
    scene = scenes.doublet()
    start = scene.head() + scene.forces()
    auto = scene.motion(options="scheme implicit dt auto tol 0.1 maxmove 0.2 shrink")
    fails(lmp, start + auto, "dt auto shortens steps by itself; leave out shrink")
    motion = scene.motion(options="maxmove 0.2 shrink")
    fails(lmp, start + scene.motility() + motion, "maxmove shrink.*dcm/motility.*leave shrink out")
    fails(lmp, start + motion + "fix r all dt/reset 1 0.1 1 0.1\n", "maxmove shrink; unfix one")
