"""Hard cases of time: steps too long, very many steps."""

import numpy as np

from hard.mixed import push
from hard.scenes_contact import apart
from hard.suite import NAMED, hard


def doublet(case, time, dt, motion="", **more):
    scene = case.scenes.doublet(level=2, gap=-0.3, box=25.0)
    deck = case.deck(scene, time, dt, motion=case.motion(scene, motion) if motion else None, **more)
    return case.run(deck, fails=True, show=True)


def reference(case, time):
    scene = case.scenes.doublet(level=2, gap=-0.3, box=25.0)
    return case.run(case.deck(scene, time, 1.0, motion=scene.motion(options="scheme explicit")))


@hard("Time")
def steps_ten_times_as_long(case):
    """Two sticking cells in steps of 20 s, ten times what the explicit scheme stands.

    Implicit: as far apart after 600 s as with explicit steps of 1 s, to 0.03 R. Explicit: one error
    that names the node and says that the step is too long."""
    run = doublet(case, 600.0, 20.0, "maxmove 1")
    if case.implicit:
        case.check("return code", run.returncode, most=0)
        case.close("distance, of steps of 1 s", apart(run.last), apart(reference(case, 600.0).last),
                   tol=0.2, unit="um")  # fmt: skip
        case.sound(run, volume=(0.9, 1.0))
    else:
        case.stopped(run, *NAMED, "timestep")


@hard("Time")
def steps_a_hundred_times_as_long(case):
    """Two sticking cells in steps of 200 s, a hundred times what the explicit scheme stands.

    Implicit: at rest after 4000 s as far apart as with error control, to 0.03 R. Explicit: one error
    that names the node and says that the step is too long."""
    run = doublet(case, 4000.0, 200.0, "maxmove 2")
    if case.implicit:
        auto = doublet(case, 1e9, 1.0, "dt auto tol 0.01 max 60 stop 4000")
        case.picture = run.path / "dump.txt"
        case.check("return code", run.returncode, most=0)
        case.close("distance, of dt auto", apart(run.last), apart(auto.last), tol=0.2, unit="um")
        case.sound(run, volume=(0.9, 1.0))
    else:
        case.stopped(run, *NAMED, "timestep")


@hard("Time")
def a_hundred_thousand_steps_at_rest(case):
    """Two cells at rest, for 100,000 steps in the long version, 2,000 in the quick one.

    Once at rest nothing changes any more: volume and energy by less than 1e-6 of themselves, the
    place of the doublet by less than 1e-4 um, and the energy does not grow."""
    steps = 100000 if case.full else 2000
    level = 1
    scene = case.scenes.doublet(level=level, gap=-0.3, box=25.0)
    dt = case.pick(0.5, 4.0)
    deck = case.deck(scene, steps * dt, dt, frames=20, settle=(case.pick(1500.0, 6000.0), dt))
    run = case.run(deck, show=True)
    rows = run.thermo
    energy = np.array([r["E_bond"] + r["E_dihed"] + r["f_volume"] for r in rows])
    volume = np.array([sum(c.volume for c in f.cells.values()) for f in run.frames])
    place = np.array([np.mean([c.centroid for c in f.cells.values()], axis=0) for f in run.frames])
    case.check("change of volume", np.ptp(volume) / volume[0], most=1e-5, spread=1.0)
    case.check("change of energy", np.ptp(energy) / energy[0], most=1e-4, spread=1.0)
    case.check("growth of energy", (energy[-1] - energy[0]) / energy[0], most=1e-6, spread=1.0)
    case.check("way of the doublet", np.linalg.norm(place - place[0], axis=1).max(), most=1e-3,
               unit="um", spread=1.0)  # fmt: skip
    case.sound(run, volume=(0.8, 1.0))


@hard("Time", schemes=("implicit",))
def chosen_steps_under_a_jolt(case):
    """Steps chosen by their error, and a force of 3 nN that comes at once after a long rest.

    The steps become shorter by themselves; the cells then move apart or in as with steps of 1 s, to
    0.05 R."""
    time = 400.0
    jolt = push(1, 3.0, 162) + push(2, -3.0, 162)
    found = []
    for auto in (True, False):
        scene = case.scenes.doublet(level=2, gap=-0.3, box=25.0)
        motion = (case.motion(scene, "dt auto tol 0.02 max 60 stop 1000") if auto else
                  scene.motion(options="scheme explicit"))  # fmt: skip
        deck = case.deck(scene, 1000.0, 1.0, motion=motion, frames=1)
        if auto:
            deck = deck.replace("run 1000", "run 1000000")
            deck += f"fix_modify motion stop {1000.0 + time}\n" + jolt + "run 1000000\n"
        else:
            deck += jolt + f"run {round(time)}\n"
        deck += "write_dump all custom end.txt id xu yu zu\n"
        found.append((case.run(deck, show=auto), deck))
    # frames are by step; the last one of each run is at its end
    ends = [run.frames[-1] for run, _ in found]
    case.close("distance, of steps of 1 s", apart(ends[0]), apart(ends[1]), tol=0.3, unit="um")
    case.sound(found[0][0], volume=(0.7, 1.0), balanced=False)
