"""Hard cases of time: steps too long, very many steps."""

import numpy as np

from hard.mixed import one_type, push
from hard.scenes_contact import FAST, apart
from hard.suite import NAMED, hard
from support.parameters import PARAMETERS


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
        case.close(
            "distance, of steps of 1 s",
            apart(run.last),
            apart(reference(case, 600.0).last),
            tol=0.2,
            unit="um",
        )
        case.sound(run, volume=(0.9, 1.0))
    else:
        case.stopped(run, *NAMED, "timestep")


@hard("Time")
def steps_a_hundred_times_as_long(case):
    """Two sticking cells in steps of 200 s, a hundred times what the explicit scheme stands.

    Implicit: at rest after 4000 s as far apart as with error control, to 0.03 R. Explicit: one
    error that names the node and says that the step is too long."""
    run = doublet(case, 4000.0, 200.0, "maxmove 2")
    if case.implicit:
        auto = doublet(case, 4000.0, 1.0, auto="tol 0.01 max 60")
        case.picture = run.path / "dump.txt"
        case.check("return code", run.returncode, most=0)
        case.close("distance, of dt auto", apart(run.last), apart(auto.last), tol=0.2, unit="um")
        case.sound(run, volume=(0.9, 1.0))
    else:
        case.stopped(run, *NAMED, "timestep")


@hard("Time")
def a_hundred_thousand_steps_at_rest(case):
    """Two sticking cells at rest and a free one, for 100,000 steps in the long version, 2,000
    in the quick one.

    Of the free cell, volume and place do not change by 1e-9 of themselves. The two creep on
    each other as slowly as contact friction makes them: less in the second half than in the
    first, volume by less than 1e-4, and the pair stays where it is to 0.01 um."""
    steps = 100000 if case.full else 2000
    scene = case.scenes.doublet(level=1, gap=-0.3, box=25.0)
    scene.dcm(0.0, 17.0, 0.0, 6.0)
    dt = case.pick(0.5, 4.0)
    deck = case.deck(scene, steps * dt, dt, frames=20, settle=(case.pick(1000.0, 8000.0), dt))
    run = case.run(deck, files={PARAMETERS: one_type(**FAST)}, show=True)
    volume = np.array([[c.volume for c in f.cells.values()] for f in run.frames])
    place = np.array([[c.centroid for c in f.cells.values()] for f in run.frames])
    pair = place[:, :2].mean(axis=1)
    shift = np.linalg.norm(np.diff(place[:, 1] - place[:, 0], axis=0), axis=1)
    first, second = shift[: len(shift) // 2].sum(), shift[len(shift) // 2 :].sum()
    # coordinates of 10 um in double precision, and the solver's tolerance
    case.check(
        "free cell: change of volume", np.ptp(volume[:, 2]) / volume[0, 2], most=1e-9, spread=1.0
    )
    case.check(
        "free cell: way",
        np.linalg.norm(place[:, 2] - place[0, 2], axis=1).max(),
        most=1e-8,
        unit="um",
        spread=1.0,
    )
    case.check(
        "pair: change of volume",
        (np.ptp(volume[:, :2], axis=0) / volume[0, :2]).max(),
        most=1e-4,
        spread=1.0,
    )
    case.check(
        "pair: way", np.linalg.norm(pair - pair[0], axis=1).max(), most=0.06, unit="um", spread=1.0
    )
    case.check(
        "pair: creep of second over first half", second / max(first, 1e-9), most=1.0, spread=1.0
    )
    case.sound(run, volume=(0.8, 1.0))


@hard("Time", schemes=("implicit",))
def chosen_steps_under_a_jolt(case):
    """Steps chosen by their error, and a force of 3 nN that comes at once after a long rest.

    The steps become shorter by themselves; the cells then move apart or in as with steps of 1 s, to
    0.05 R."""
    jolt = push(1, 3.0, 162) + push(2, -3.0, 162)
    found = []
    for auto in ("tol 0.02 max 60", ""):
        scene = case.scenes.doublet(level=2, gap=-0.3, box=25.0)
        motion = None if auto else scene.motion(options="scheme explicit")
        deck = case.deck(scene, 1000.0, 1.0, motion=motion, frames=1, auto=auto)
        more = "fix_modify motion stop 1400\nrun 100000000\n" if auto else "run 400\n"
        deck += jolt + more
        if auto:
            deck = deck.replace("every/time 1000.0", "every/time 200")
        found.append(case.run(deck.replace("all custom 1000 ", "all custom 200 ")))
    case.picture = found[0].path / "dump.txt"
    case.close(
        "distance, of steps of 1 s", apart(found[0].last), apart(found[1].last), tol=0.3, unit="um"
    )
    case.check(
        "shortest step over the longest before the jolt",
        0.0
        if not found[0].runs
        else min(row["f_motion[9]"] for row in found[0].runs[-1])
        / max(row["f_motion[9]"] for row in found[0].runs[0]),
        most=0.7,
        spread=1.0,
    )
    case.sound(found[0], volume=(0.7, 1.0))
