"""Random numbers belong to cells, events and times: neither the length of steps nor their number
changes what they decide."""

import numpy as np
import pytest

from lammps_dcm import read_deaths
from support.bad_decks import fails
from support.cycle_decks import counting, same

COLUMNS = "id mol type xu yu zu vx vy vz fx fy fz"


# --- motility -------------------------------------------------------------------------------------


def wanderers(scenes, options, motion="", cells=8):
    """Free spheres on a grid, wandering with D = 0.1."""
    scene = scenes.Scene(16.0, "f f f")
    for k in range(cells):
        scene.cbm(*(8.0 * np.array([k % 2 - 0.5, k // 2 % 2 - 0.5, k // 4 - 0.5])), 2.0)
    return (
        scene.head() + "fix cell all dcm/cell\n"
        + scene.motility(seed=5, options=f"D 0.1 {options}")
        + scene.motion(options=f"tolerance 1e-13 maxmove 10 {motion}")
        + "comm_modify cutoff 8\n"
    )  # fmt: skip


@pytest.mark.parametrize("more", ["", "persistence 20"])
def test_steps_of_any_length_end_at_the_same_place(lmp, scenes, more):
    """A free cell has a constant velocity for each interval: steps are exact, chosen ones as well,
    which end with the intervals."""
    def place(motion, dt, run):
        deck = wanderers(scenes, f"interval 12 {more}", motion)
        result = lmp(deck + scenes.dump(COLUMNS, 1) + scenes.thermo(["time"])
                     + f"timestep {dt}\n{run}\n")
        assert result.thermo[-1]["Time"] == pytest.approx(72.0, abs=1e-9)
        return result.dump()[-1].x, len(result.thermo) - 1

    reference, _ = place("", 1.0, "run 72")
    start = lmp(wanderers(scenes, "interval 12") + scenes.dump(COLUMNS, 1) + "run 0\n").dump()[0].x
    assert 1.0 < np.sqrt(np.mean((reference - start) ** 2)) < 10.0
    for dt in (2.0, 6.0, 12.0):
        assert np.abs(place("", dt, f"run {round(72 / dt)}")[0] - reference).max() < 1e-10
    for longest, least in ((5.0, 18), (100.0, 6)):
        x, steps = place(f"scheme implicit dt auto tol 100 min 1 max {longest} stop 72", 1.0,
                         "run 1000")
        assert np.abs(x - reference).max() < 1e-10
        assert least <= steps <= least + 12


@pytest.mark.parametrize("motion", ["", "scheme implicit dt auto tol 100 min 1 max 5"])
def test_restart_within_an_interval(lmp, scenes, motion):
    """Bit for bit, with the force that is held."""
    start = wanderers(scenes, "interval 12 persistence 20", motion)
    fixes = start[start.index("fix cell"):]
    end = scenes.dump(COLUMNS, 5) + "timestep 1.0\n"
    whole = lmp(start + end + "run 15\nwrite_restart x.restart\nrun 20\n")
    again = lmp(f"read_restart {whole.path / 'x.restart'}\n" + fixes + end + "run 20\n")
    frames = {frame.step: frame for frame in whole.dump()}
    assert len(again.dump()) == 5
    for frame in again.dump():
        same(frame, frames[frame.step], COLUMNS)


def test_a_run_goes_on_after_a_step_that_was_shortened(lmp, scenes):
    """The timestep that a run begins with is then no part of the interval, and no error."""
    deck = wanderers(scenes, "interval 12").replace("maxmove 10", "maxmove 0.05 shrink")
    result = lmp(deck + scenes.thermo(["dt", "time"]) + "timestep 4.0\nrun 3\nrun 3\n")
    assert result.runs[1][0]["Dt"] < 3.9


def test_intervals_hold_whole_steps(lmp, scenes):
    fails(lmp, wanderers(scenes, "interval 2.5") + "timestep 1.0\n",
          "interval 2.5 is no multiple of the timestep 1")
    fails(lmp, wanderers(scenes, "interval 0") + "timestep 1.0\n", "interval is 0.*positive")


# --- fates ----------------------------------------------------------------------------------------


def shifted(deck, steps):
    """The deck with other numbers of steps at the same times."""
    return deck.replace("timestep 1.0\n", f"timestep 1.0\nreset_timestep {steps}\n", 1)


def dead(lmp, options, dt=1.0, shift=0):
    """cell -> time of its death, of 60 cells in 1200 s."""
    deck = counting(60, "cycle_time 1e9") + f"fix death all dcm/death {options} log death.log\n"
    deck = shifted(deck, shift).replace("timestep 1.0", f"timestep {dt}")
    log = read_deaths(lmp(deck + f"run {round(1200 / dt)}\n").path / "death.log")
    return dict(zip(log.cell, log.time - shift * dt, strict=True))


def test_a_cell_has_its_time_to_die(lmp):
    """Of an exponential distribution, whatever the steps; a death is late by less than a look."""
    reference = dead(lmp, "rate 1e-3 seed 6")
    assert 25 < len(reference) < 55    # 42 +- 3 x 3.6
    assert dead(lmp, "rate 1e-3 seed 6", shift=7000) == reference
    assert dead(lmp, "rate 1e-3 seed 7") != reference
    for options, dt in (("rate 1e-3 seed 6", 4.0), ("rate 1e-3 seed 6 every 20", 1.0)):
        late = dead(lmp, options, dt)
        latest = 20.0 if "every" in options else dt
        assert set(late) <= set(reference)
        assert all(t > 1200 - latest for cell, t in reference.items() if cell not in late)
        for cell, time in late.items():
            assert 0.0 <= time - reference[cell] < latest + 1e-6, (cell, time, reference[cell])


def test_the_time_to_die_goes_on_after_a_restart(lmp):
    start = counting(60, "cycle_time 1e9")
    death = "fix death all dcm/death rate 1e-3 seed 6 every 3 log death.log\n"
    whole = lmp(start + death + "run 500\nwrite_restart x.restart\nrun 500\n").path
    fixes = start[start.index("comm_modify"):] + death
    again = lmp(f"read_restart {whole / 'x.restart'}\n" + fixes + "run 500\n").path
    log, late = read_deaths(whole / "death.log"), read_deaths(again / "death.log")
    after = log.time > 500.0
    assert len(late) > 10
    assert list(late.cell) == list(log.cell[after]) and list(late.time) == list(log.time[after])


def test_who_rests_does_not_depend_on_the_number_of_the_step(lmp, scenes):
    """Half of the cells are sent to quiescence; the choice depends on the seed."""
    def resting(shift, seed=3):
        deck = counting(40, "cycle_time 1e5 proliferating c 0.5").replace("seed 3", f"seed {seed}")
        deck += "compute of all dcm/cell phase volume\n" + scenes.dump("id c_of[1]", 1)
        phase = lmp(shifted(deck, shift) + "run 3\n").dump()[-1]["c_of[1]"]
        assert sorted(np.unique(phase, return_counts=True)[1]) == [20, 20]
        return list(phase)

    assert resting(0) == resting(4000)
    assert resting(0) != resting(0, seed=4)


def test_orientation_of_a_new_mesh_does_not_depend_on_the_number_of_the_step(lmp, scenes):
    def nodes(shift):
        scene = scenes.Scene(20.0, "f f f")
        scene.cbm(0.0, 0.0, 0.0, 5.0)
        deck = (
            scene.head() + scene.cortex() + "comm_modify cutoff 14\nfix cell all dcm/cell\n"
            + scene.volume() + "variable want atom 1\nfix convert all dcm/convert dcm 1 2 3 1 1 "
            "cbm 4 variable v_want every 1 mesh icosphere 1\ntimestep 1.0\n"
            + scenes.dump(COLUMNS, 1)
        )  # fmt: skip
        frame = lmp(shifted(deck, shift) + "run 2\n").dump()[-1]
        assert len(frame.x) == 123
        return frame.x

    assert (nodes(0) == nodes(300)).all()
