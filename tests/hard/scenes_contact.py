"""Hard cases of contact: strong adhesion, soft against stiff, unequal sizes, pressure, overlaps."""

import re

import numpy as np

from hard.mixed import TwoTypes, one_type, push
from hard.suite import STIFFNESS, hard
from support.meshes import icosphere, off
from support.parameters import CORTEX, FRICTION, PARAMETERS

GAMMA, ECM, K_V = CORTEX["gamma"], FRICTION["friction_ecm"], CORTEX["K_V"]


# contacts that come to rest ten times as fast; an explicit step of 0.5 s is below 2 g/k
FAST = dict(friction_normal=5.0, friction_tangential=5.0)


def apart(frame, a=1, b=2):
    return np.linalg.norm(frame.cells[b].centroid - frame.cells[a].centroid)


AREA = ["area=c_contact[3]", "overlap=c_contact[5]"]
CONTACT = "compute contact all pair dcm/contact\n"


def pair(
    case, time, dt, *, W=0.1, style="", level=2, show=False, gap=-0.1, box=25.0, extra="", **more
):
    scene = case.scenes.doublet(level=level, gap=gap, box=box)
    contact = case.contact(scene, style, f"W {W}")
    deck = case.deck(scene, time, dt, contact=contact, extra=CONTACT + extra, thermo=AREA, **more)
    return case.run(deck, show=show)


@hard("Contact")
def adhesion_times_20(case):
    """Two cells that stick with twenty times the usual adhesion, 2 nN/um.

    They spread on each other: more contact than with the usual adhesion, but not through each
    other; half the step changes their distance by less than 1 % of R."""
    time, dt = case.pick(300.0, 600.0), case.pick(0.5, 5.0)
    strong = pair(case, time, dt, W=2.0, show=True)
    half = pair(case, time, 0.5 * dt, W=2.0)
    usual = pair(case, time, dt)
    case.check(
        "contact over that of W = 0.1",
        strong.thermo[-1]["v_area"] / usual.thermo[-1]["v_area"],
        least=1.2,
    )
    case.close(
        "distance, of half the step", apart(strong.last), apart(half.last), tol=0.06, unit="um"
    )
    case.sound(strong, volume=(0.7, 1.05))


@hard("Contact")
def range_of_adhesion_tenth(case):
    """Adhesion that reaches a tenth as far, 0.035 um, which the mesh cannot resolve.

    The cells come to rest all the same, with a distance within 5 % of R of that with the range by
    default on the next finer mesh: the contact line is pinned, forces are not wrong."""
    time, dt = case.pick(300.0, 600.0), case.pick(0.5, 5.0)
    narrow = pair(case, time, dt, style="h0 0.035", show=True)
    usual = pair(case, time, dt, level=3 if case.full else 2)
    case.close(
        "distance, of the usual range", apart(narrow.last), apart(usual.last), tol=0.6, unit="um"
    )
    speed = np.abs(narrow.last.v[narrow.last.moving]).max()
    case.check("fastest node at last", speed, most=0.02, unit="um/s", spread=1.0)
    case.sound(narrow, volume=(0.8, 1.05))


@hard("Contact")
def soft_against_stiff(case):
    """A cell pressed with 1 nN on one whose cortex and surface are a hundred times as stiff.

    The stiff cell keeps its shape to 1 %, the soft one gives way; both carry the same force."""
    stiff = dict(E_cor=500.0, E_contact=500.0)
    scene = TwoTypes(25.0, level=2, b=stiff)
    scene.cell("a", -5.95, 0.0, 0.0, 6.0)
    scene.cell("b", 5.95, 0.0, 0.0, 6.0, options="rotate 3 rest 1.0")
    # the stiff cell does not move: what it carries is the force of the contact
    extra = push(1, 1.0, 162) + "group soft molecule 1\ngroup stiff molecule 2\n"
    # rate of an edge 72 /s: 0.02 is stable
    time, dt = case.pick(10.0, 300.0), case.pick(0.02, 5.0)
    extra += push(2, -1.0, 162, node_type=5)
    deck = case.deck(scene, time, dt, extra=extra)
    run = case.run(deck, files=scene.files(), show=True)
    change = [
        run.last.cells[m].extent.min() / run.first.cells[m].extent.min() - 1.0 for m in (1, 2)
    ]
    case.check("change of the stiff cell", abs(change[1]), most=0.01)
    case.check("change of the soft one over it", abs(change[0] / change[1]), least=3.0, spread=1.0)
    case.sound(run, volume=(0.7, 1.05))


@hard("Contact")
def radii_1_to_8(case):
    """A cell of radius 1.5 on one of radius 12, with edges eight times as long.

    The small cell neither sinks in nor is torn: overlap within a quarter of its own edges, volume
    within what its tension allows; they stay in touch."""
    scene = case.scenes.Scene(30.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 12.0)
    scene.dcm(13.45, 0.0, 0.0, 1.5)
    run = case.run(case.deck(scene, case.pick(100.0, 400.0), case.pick(0.5, 4.0)), show=True)
    case.close("distance", apart(run.last), 13.5, tol=0.75, unit="um")
    case.sound(run, volume=(0.6, 1.02), depth=0.3)


def dented(level, angle):
    """An icosphere whose cap around +x is mirrored inwards."""
    x, faces = icosphere(level)
    at = np.cos(angle)
    cap = x[:, 0] > at
    x[cap, 0] = 2.0 * at - x[cap, 0]
    return off(x, faces), len(x), len(faces)


@hard("Contact", section="z=0")
def sphere_in_a_dent(case):
    """A center-based cell pressed with 0.5 nN into the concave dent of a deformable one.

    It comes to rest in the dent, carried by the concave faces: what they push back with is the
    force it is pressed with, to 2 %, and it is in them by no more than 0.3 of its radius."""
    text, nodes, faces = dented(3, np.radians(42.0))
    scene = case.scenes.Scene(30.0, level=3)
    scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=("dent.off", nodes, faces), options="scale nodes rest 1.0")
    scene.cbm(5.2, 0.0, 0.0, 2.0)
    extra = "group ball molecule 2\nfix press ball addforce -0.5 0 0\n" + push(1, 0.5, nodes)
    deck = case.deck(scene, case.pick(150.0, 600.0), case.pick(0.5, 4.0), extra=extra, frames=8)
    files = {"dent.off": text, PARAMETERS: one_type(**FAST)}
    run = case.run(deck, files=files, show=True)
    last = run.last
    ball = last["kind"] == 1
    # the sphere's force is that of the contact and 0.5 from outside; at rest it is its friction
    case.close(
        "force of the contact on the sphere", last.f[ball][0, 0] + 0.5, 0.5, tol=0.05, unit="nN"
    )
    case.sound(run, quality=0.02)


@hard("Contact")
def engulfment(case):
    """A large cell, ten times as soft as usual, sticks to a small one with five times the usual
    adhesion and wraps it.

    The contact grows to more than a third of the small cell's surface, and neither is inside the
    other."""
    soft = dict(E_cor=0.5, K_V=0.5)
    scene = TwoTypes(25.0, level=2, W=0.5, a=FAST | soft, b=FAST)
    scene.cell("a", 0.0, 0.0, 0.0, 6.0, level=3)
    scene.cell("b", 8.0, 0.0, 0.0, 2.1)
    deck = case.deck(
        scene,
        case.pick(150.0, 300.0),
        case.pick(0.25, 2.0),
        extra=CONTACT,
        thermo=AREA,
        maxmove="0.5",
    )
    run = case.run(deck, files=scene.files(), show=True)
    small = run.last.cells[2]
    case.check(
        "contact over surface of the small cell",
        run.thermo[-1]["v_area"] / small.areas.sum(),
        least=0.3,
        most=1.0,
    )
    case.sound(run, volume=(0.5, 1.05), depth=0.5)


def overlapping(case, share, level, time):
    """A doublet that begins with surfaces overlapping by `share` of the radius."""
    scene = case.scenes.doublet(level=level, gap=-6.0 * share, box=25.0)
    deck = case.deck(scene, time, case.pick(0.5, 4.0), maxmove="1")
    return case.run(deck, files={PARAMETERS: one_type(**FAST)}, fails=True)


@hard("Contact")
def start_overlap_small(case):
    """Two cells that begin inside each other by 0.1 and 0.2 of their radius.

    They come to rest as far apart as two that began touching, to 2 % of R."""
    touching = overlapping(case, 0.01, 1, 2000.0)
    case.picture = touching.path / "dump.txt"
    for share in (0.1, 0.2):
        run = overlapping(case, share, 1, 2000.0)
        case.check(f"{share} R: return code", run.returncode, most=0)
        if run.returncode == 0:
            case.close(
                f"{share} R: distance", apart(run.last), apart(touching.last), tol=0.12, unit="um"
            )
            case.sound(run, volume=(0.9, 1.0))


@hard("Contact")
def start_overlap_large(case):
    """Two cells that begin inside each other by 0.3 to 1.2 of their radius.

    Each is a sound run, or one error that says which cells begin inside each
    other, and how deep."""
    for share in (0.3, 0.4, 0.5, 0.6, 1.2):
        run = overlapping(case, share, 2, 50.0)
        if run.returncode == 0:
            case.sound(run, volume=(0.9, 1.0))
            continue
        case.stopped(run, r"dcm/contact", r"cells 1 and 2", "overlap", "start|given|data file")
        depth = re.search(r"by ([-\d.]+) at step \d+, more than ([\d.]+)", run.out)
        if depth:  # of the middles of two faces, which lie a little below the sphere
            case.check(
                "depth it tells, over its limit", float(depth[1]) / float(depth[2]), least=1.0
            )
            case.check(
                "depth it tells, over that of the spheres",
                float(depth[1]) / (6.0 * share),
                least=0.5,
                most=1.0,
            )


@hard("Contact")
def friction_ratio_1e6(case):
    """Contacts with a million times more friction in one direction than in the other, sheared.

    Slippery cells slide past each other as two free ones: their speed is the force over the
    friction of their free surface, to 5 %; sticky ones move less. The solver arrives in both."""
    speeds = {}
    for name, normal, tangential in (("slippery", 50.0, 5e-5), ("sticky", 5e-5, 50.0)):
        scene = case.scenes.doublet(level=2, gap=-0.1, box=30.0)
        files = {PARAMETERS: one_type(friction_normal=normal, friction_tangential=tangential)}
        extra = push(1, 2.0, 162, axis=1) + push(2, -2.0, 162, axis=1)
        extra += "compute free all dcm/cell free_area\ncompute area all reduce sum c_free\n"
        dt = case.pick(0.1, 0.5)
        deck = case.deck(scene, 5.0, dt, thermo=["area=c_area"], settle=(100.0, dt), then=extra)
        run = case.run(deck, files=files, show=True)
        last = run.last
        v = [last.v[c.rows].mean(axis=0)[1] for c in last.cells.values()]
        speeds[name] = 0.5 * (v[0] - v[1])
        case.check(
            f"{name}: iterations",
            max(row["f_motion[2]"] for row in run.thermo),
            most=400,
            spread=1.0,
        )
        if name == "slippery":
            case.close(
                "speed over that of free cells",
                speeds[name] * ECM * run.thermo[-1]["v_area"] / 4.0,
                1.0,
                rel=0.05,
            )
        case.sound(run, volume=(0.9, 1.02))
    case.check("speed of sticky over slippery", speeds["sticky"] / speeds["slippery"], most=0.8)


@hard("Contact")
def no_friction_with_surroundings(case):
    """Two sticky cells with no friction but that of cortex and contact: where they are is not
    determined, how they move is.

    The doublet as a whole stays, within a thousandth of the speed of its nodes, and comes together
    as one with little friction does, to 1 % of R."""
    runs = []
    for friction in (0.0, 1e-3):
        scene = case.scenes.doublet(level=2, gap=-0.1, box=25.0)
        files = {PARAMETERS: one_type(friction_ecm=friction)}
        deck = case.deck(scene, case.pick(150.0, 300.0), case.pick(0.5, 4.0))
        runs.append(case.run(deck, files=files, show=True))
    run = runs[0]
    mean = max(np.abs(f.v[f.moving].mean(axis=0)).max() for f in run.frames)
    case.check("mean velocity", mean, most=1e-3, unit="um/s", spread=1.0)
    case.close(
        "distance, of little friction", apart(run.last), apart(runs[1].last), tol=0.06, unit="um"
    )
    case.sound(run, volume=(0.9, 1.02))


@hard("Contact")
def fine_beside_coarse(case):
    """A cell of 42 nodes beside one of 10,242 (2,562 in the quick version), of the same size.

    They stick and come to rest as far apart as two of 642 nodes do, to 5 % of R."""
    fine = 5 if case.full else 4
    time, dt = case.pick(40.0, 120.0), case.pick(0.5, 4.0)
    found = []
    for levels in ((1, fine), (3, 3)):
        scene = case.scenes.Scene(25.0)
        for x, level in zip((-5.95, 5.95), levels):
            scene.dcm(x, 0.0, 0.0, 6.0, level=level)
        deck = case.deck(scene, time, dt, maxmove="5", frames=2)
        found.append(case.run(deck))
    case.picture = found[0].path / "dump.txt"
    case.close(
        "distance, of equal meshes", apart(found[0].last), apart(found[1].last), tol=0.3, unit="um"
    )
    case.sound(found[0], volume=(0.9, 1.02), depth=2.0)


@hard("Contact", view="xy")
def face_on_three_cells(case):
    """A coarse cell whose one face lies on three small cells at once, pressed with 0.6 nN.

    Each of the three, which are held, carries a third to 10 %; the large cell stays outside."""
    nodes, faces = icosphere(1)
    n = nodes[faces].mean(axis=1)
    k = int(np.argmax(n[:, 2]))
    normal = n[k] / np.linalg.norm(n[k])
    corners = nodes[faces[k]]
    R, r = 8.0, 1.6
    height = R * np.linalg.norm(n[k])
    scene = case.scenes.Scene(30.0)
    scene.dcm(0.0, 0.0, 0.0, R, level=1, options="scale nodes rest 0.95")
    for corner in corners:
        side = corner - (corner @ normal) * normal
        place = normal * (height + r + 0.05) + 1.9 * side / np.linalg.norm(side)
        scene.dcm(*place, r, level=2)
    group = "group large molecule 1\n"
    force = 0.6 * normal
    extra = "".join(push(1, f, 42, axis=a) for a, f in enumerate(force))
    deck = case.deck(
        scene,
        case.pick(400.0, 600.0),
        case.pick(0.5, 4.0),
        before=group,
        extra=extra,
        group="large",
        contact=case.contact(scene, "", "W 0"),
    )
    run = case.run(deck, files={PARAMETERS: one_type(**FAST)}, show=True)
    carried = [run.last.f[run.last.cells[m].rows].sum(axis=0) @ normal for m in (2, 3, 4)]
    case.close("carried by all three", sum(carried), 0.6, tol=0.06, unit="nN")
    for m, c in zip((2, 3, 4), carried):
        case.close(f"share of cell {m}", c / sum(carried), 1.0 / 3.0, rel=0.1)
    case.sound(run, balanced=False, depth=0.5)


@hard("Contact", section="z=0", quick="implicit")
def thirty_cells_at_5_kPa(case):
    """Thirty-six cells in a periodic box that grow until they fill it, at 5 kPa (bulk modulus 30).

    Volumes sum up to the box, to what the layers give way; the mean pressure is that of the law for
    the volume of the box, to 15 %; nobody is deeper in a neighbor than 5 kPa make it, and the
    sagitta of a coarse face."""
    R, K_V, P = 4.0, 30.0, 5.0
    d = 2.0 * R * 1.005
    count = (3, 4, 3)  # hexagonal layers, one straight on the other
    lengths = np.array([3.0, 4.0 * np.sqrt(0.75), 3.0]) * d
    scene = case.scenes.Scene(0.5 * lengths, "p p p", level=1)
    for i, j, k in np.ndindex(*count):
        at = np.array([i + 0.5 * (j % 2) + 0.25, (j + 0.5) * np.sqrt(0.75), k + 0.5]) * d
        scene.dcm(*(at - 0.5 * lengths), R)
    files = {PARAMETERS: one_type(K_V=K_V, **FAST)}
    rest = np.exp(P / K_V) * np.prod(lengths) / (np.prod(count) * 4.0 / 3.0 * np.pi * R**3)
    cycle = case.pick(100.0, 400.0)
    grow = f"fix grow all dcm/growth {scene.map} seed 3 cycle_time {cycle} rounding 0 1\n"
    dt = case.pick(0.1, 1.0 if case.full else 4.0)
    deck = case.deck(
        scene,
        cycle * (rest - 1.0),
        dt,
        extra=grow,
        frames=1,
        maxmove="1",
        contact=case.contact(scene, "growth 3"),
    )
    deck += f"unfix grow\nrun {round(case.pick(25.0, 100.0) / dt)}\n"
    run = case.run(deck, files=files, show=True)
    last = run.last
    total = sum(c.volume for c in last.cells.values())
    edge = np.mean([c.mean_edge for c in last.cells.values()])
    area = sum(c.areas.sum() for c in last.cells.values())
    overlap = P / STIFFNESS
    case.close(
        "cells over box",
        total / np.prod(last.lengths),
        1.0,
        tol=0.5 * area * overlap / np.prod(last.lengths),
    )
    pressures = [
        -K_V * np.log(c.volume / v)
        for c, v in zip(last.cells.values(), last["volume0"][last["volume0"] > 0.0])
    ]
    case.close("mean pressure", np.mean(pressures), P, rel=0.15, unit="kPa")
    bound = (1.5 * overlap + edge**2 / (8.0 * R)) / edge
    case.sound(run, volume=(0.8, 1.0), depth=bound, periodic=True)
