"""Hard cases of boxes and long ways: periodic corners, open borders, far from the origin."""

import numpy as np

from hard.mixed import push
from hard.suite import hard
from support.parameters import FRICTION

ECM = FRICTION["friction_ecm"]


def cells_mean(frame):
    return np.array([c.x.mean(axis=0) for c in frame.cells.values()])


@hard("Boxes")
def periodic_corner_at_speed(case):
    """Two sticking cells pulled along the diagonal of a small periodic box, through its corners.

    They move as in a box that is ten times as wide and never crossed, to 1e-6 um: a border is
    nowhere. Their speed is force over friction of the free surface, to 1 %."""
    force, time, dt = 300.0, 60.0, case.pick(0.5, 1.0)
    found = []
    for box in (16.0, 160.0):
        scene = case.scenes.Scene(box, "p p p", level=1)
        for sign in (-1.0, 1.0):
            d = sign * 5.95 / np.sqrt(2.0)
            scene.dcm(d, -d, 0.0, 6.0)
        extra = "".join(push(m, force / np.sqrt(3.0), 42, axis=k) for m in (1, 2) for k in range(3))
        extra += "compute free all dcm/cell free_area\ncompute area all reduce sum c_free\n"
        deck = case.deck(
            scene, time, dt, extra=extra, thermo=["area=c_area"], maxmove="2", frames=10
        )
        found.append(case.run(deck))
    small, wide = found
    case.picture = small.path / "dump.txt"
    way = cells_mean(small.last) - cells_mean(small.first)
    case.check("way", np.linalg.norm(way, axis=1).min(), least=28.0, unit="um")
    off = max(
        np.abs(a.x[a.moving] - b.x[b.moving]).max() for a, b in zip(small.frames, wide.frames)
    )
    case.check("off the run in a wide box", off, most=1e-6, unit="um", spread=1.0)
    v = small.last.v[small.last.moving].mean(axis=0)
    case.close(
        "speed over force by friction",
        np.linalg.norm(v) * ECM * small.thermo[-1]["v_area"] / (2.0 * force),
        1.0,
        rel=0.01,
    )
    case.sound(small, periodic=True, force=3 * [2.0 * force / np.sqrt(3.0)], volume=(0.8, 1.02))


@hard("Boxes")
def long_crawl(case):
    """A cell that crosses periodic borders again and again, 20 box lengths in the long version.

    Speed and volume at the end are those of the beginning, to 1e-6: nothing adds up."""
    lengths = 20.0 if case.full else 2.0
    scene = case.scenes.Scene(13.0, "p p p", level=1)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    force = np.array([60.0, 20.0, -10.0])
    extra = "".join(push(1, f, 42, axis=k) for k, f in enumerate(force))
    dt = case.pick(0.5, 1.0)
    speed = np.linalg.norm(force) / (ECM * 420.0)
    deck = case.deck(scene, 200.0 + lengths * 26.0 / speed, dt, extra=extra, frames=20)
    run = case.run(deck, show=True)
    frames = run.frames[len(run.frames) // 2 :]
    v = np.array([f.v[f.moving].mean(axis=0) for f in frames])
    volume = np.array([f.cells[1].volume for f in frames])
    way = frames[-1].x[frames[-1].moving].mean(axis=0) - run.first.x[run.first.moving].mean(axis=0)
    case.check("way over box", np.linalg.norm(way) / 26.0, least=0.8 * lengths)
    case.check(
        "change of speed", np.ptp(v, axis=0).max() / np.linalg.norm(v[0]), most=1e-6, spread=1.0
    )
    case.check("change of volume", np.ptp(volume) / volume[0], most=1e-6, spread=1.0)
    case.check(
        "off the force",
        np.abs(v[-1] / force * np.linalg.norm(force) / np.linalg.norm(v[-1]) - 1.0).max(),
        most=1e-3,
        spread=1.0,
    )
    case.sound(run, force=force, volume=(0.9, 1.0))


@hard("Boxes")
def drifting_out_of_an_open_box(case):
    """A cell pushed out of the box.

    A shrink-wrapped box follows it: it moves by force over friction, to 1 %. In a fixed one the run
    stops with one error that says which cell is lost, where and when."""
    force, dt = 40.0, case.pick(0.5, 1.0)
    for boundary in ("s s s", "f f f"):
        scene = case.scenes.Scene(14.0, boundary, level=2)
        scene.dcm(4.0, 0.0, 0.0, 6.0)
        extra = push(1, force, 162)
        deck = case.deck(scene, 200.0, dt, extra=extra, frames=8)
        run = case.run(deck, fails=boundary == "f f f", show=boundary == "s s s")
        if boundary == "s s s":
            area = np.mean([c.areas.sum() for c in (f.cells[1] for f in run.frames[1:])])
            way = cells_mean(run.last)[0] - cells_mean(run.first)[0]
            case.close(
                "way over force by friction", way[0] * ECM * area / (force * 200.0), 1.0, rel=0.01
            )
            case.sound(run, force=(force, 0.0, 0.0), volume=(0.9, 1.0))
        else:
            case.stopped(run, r"[Ll]ost atoms|cell \d.* at step \d+.*lost through a fixed boundary")


@hard("Boxes")
def far_from_the_origin(case):
    """A doublet at 100,000 um from the origin, where a coordinate has lost 5 of its 16 digits.

    It moves as one at the origin, to 1e-6 um."""
    runs = []
    for at in (0.0, 1e5):
        scene = case.scenes.Scene(20.0, "p p p", level=2)
        for x in (-5.95, 5.95):
            scene.dcm(x + at, at, -at, 6.0)
        deck = case.deck(scene, case.pick(100.0, 300.0), case.pick(0.5, 4.0))
        a = f"{at - 20.0!r} {at + 20.0!r}"
        deck = deck.replace(
            f"region box block {' '.join(3 * ['-20.0 20.0'])}",
            f"region box block {a} {a} {-at - 20.0!r} {-at + 20.0!r}",
        )
        runs.append(case.run(deck))
    near, far = runs
    case.picture = near.path / "dump.txt"
    shift = np.array([1e5, 1e5, -1e5])
    off = np.abs(far.last.x - shift - near.last.x)[near.last.moving].max()
    case.check("off the run at the origin", off, most=1e-6, unit="um", spread=1.0)
    case.sound(far, periodic=True, volume=(0.9, 1.0))


@hard("Boxes")
def fixed_neighbor(case):
    """A cell that sticks to one outside the group that moves.

    The fixed cell stays to the last bit, and the other one comes to rest against it."""
    scene = case.scenes.doublet(level=2, gap=-0.3, box=25.0)
    deck = case.deck(
        scene,
        case.pick(200.0, 400.0),
        case.pick(0.5, 4.0),
        before="group mobile molecule 2\n",
        group="mobile",
    )
    run = case.run(deck, show=True)
    still = run.first["mol"] == 1
    node = run.first["kind"] == 3
    moved = np.abs(run.last.x - run.first.x).max(axis=1)
    case.check("way of the fixed cell", moved[still & node].max(), most=0.0, spread=1.0)
    case.check("way of the other", moved[~still & node].max(), least=1e-3, unit="um")
    speed = np.abs(run.last.v[node & ~still]).max()
    case.check("fastest node at last", speed, most=0.02, unit="um/s", spread=1.0)
    case.sound(run, volume=(0.8, 1.001))
