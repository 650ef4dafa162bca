"""Hard cases of force: far more than cells can bear, in steps short and long."""

import numpy as np

from hard.mixed import one_type, push
from hard.scenes_contact import apart
from hard.suite import NAMED, hard
from support.parameters import PARAMETERS

# of scheme implicit: ten and a hundred times what the explicit scheme stands, and chosen by error
LARGE = {"10x": 20.0, "100x": 200.0, "auto": None}


def sound_or_stops(case, run, where="", **limits):
    """Either; an error names style, cell, step and remedy. Returns True if sound."""
    if run.returncode:
        case.stopped(run, *NAMED)
        return False
    case.sound(run, **limits)
    return True


def between_spheres(case, force):
    scene = case.scenes.Scene(40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(-11.0, 0.0, 0.0, 5.0)
    scene.cbm(11.0, 0.0, 0.0, 5.0)
    return scene, (
        "group left molecule 2\ngroup right molecule 3\n"
        f"fix l left addforce {force} 0 0\nfix r right addforce {-force} 0 0\n"
    )


def sphere_pressed(case, force):
    scene = case.scenes.Scene(40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(8.9, 0.0, 0.0, 3.0)
    return scene, f"group ball molecule 2\nfix push ball addforce {-force} 0 0\n" + push(
        1, force, 162
    )


def node_pulled(case, force):
    scene = case.scenes.single_cell(level=2, box=60.0)
    return scene, (
        f"group tip id 10\nfix tip tip addforce 0 0 {force}\n" + push(1, -force, 162, axis=2)
    )


def torn(case, force):
    scene = case.scenes.doublet(level=2, gap=-0.3, box=40.0)
    return scene, push(1, -force, 162) + push(2, force, 162)


def rising(case, make, forces, time, least_sound, **limits):
    """Runs with growing force; up to least_sound (nN) they must be sound."""
    for force in forces:
        scene, extra = make(case, force)
        run = case.run(
            case.deck(scene, time, case.pick(0.5, 2.0), extra=extra),
            fails=True,
            show=force == forces[0],
        )
        whole = sound_or_stops(case, run, **limits)
        if force <= least_sound:
            case.check(f"{force:g} nN: sound", whole, least=1)


@hard("Force")
def crushed_between_spheres(case):
    """A cell between two center-based cells that are pressed together by 5, 500 and 5000 nN; it
    bears some 5.

    Sound with 5 nN; else sound, or one error that names style, cell, step and remedy."""
    rising(case, between_spheres, (5.0, 500.0, 5000.0), 300.0, 5.0, volume=(0.2, 1.05))


@hard("Force")
def crushed_between_cells(case):
    """A cell between two others that are pressed together by 5, 50 and 500 nN.

    Sound with 5 nN; else sound, or one error that names style, cell, step and remedy."""

    def make(case, force):
        scene = case.scenes.Scene(40.0, level=2)
        for x in (-11.9, 0.0, 11.9):
            scene.dcm(x, 0.0, 0.0, 6.0)
        return scene, push(1, force, 162) + push(3, -force, 162)

    rising(case, make, (5.0, 50.0, 500.0), 200.0, 5.0, volume=(0.2, 1.05), depth=0.75)


@hard("Force")
def sphere_pressed_into_a_cell(case):
    """A center-based cell pressed into a deformable one with 1, 20 and 400 nN.

    Sound with 1 nN; else sound, with the sphere's center outside, or one error that names style,
    cell, step and remedy."""
    rising(case, sphere_pressed, (1.0, 20.0, 400.0), 200.0, 1.0, volume=(0.2, 1.05))


@hard("Force")
def node_torn_out(case):
    """One node drawn out of a cell by 1, 30 and 1000 nN, which all others hold against.

    Sound with 1 nN; else sound, or one error that names style, cell, step and remedy."""
    rising(case, node_pulled, (1.0, 30.0, 1000.0), 100.0, 1.0, volume=(0.2, 1.2), quality=0.001)


@hard("Force")
def torn_apart(case):
    """Two sticking cells pulled apart by 5, 50 and 500 nN.

    They come apart and each is whole; or one error that names style, cell, step and remedy."""
    rising(case, torn, (5.0, 50.0, 500.0), 100.0, 5.0)


@hard("Force", schemes=("implicit",))
def crushed_in_large_steps(case):
    """The cell between spheres, pressed by 5 and 5000 nN in steps of 20 s, 200 s, and chosen ones.

    No step is too long for 5 nN, which a cell bears; with 5000 nN sound, or one error that names
    style, cell, step and remedy."""
    large_steps(case, between_spheres, (5.0, 5000.0), volume=(0.2, 1.05))


@hard("Force", schemes=("implicit",))
def pressed_in_large_steps(case):
    """A sphere pressed into a cell by 1 and 400 nN in steps of 20 s, 200 s, and chosen ones.

    No step is too long for 1 nN; with 400 nN sound, or one error that names style, cell, step and
    remedy."""
    large_steps(case, sphere_pressed, (1.0, 400.0), volume=(0.2, 1.05))


@hard("Force", schemes=("implicit",))
def node_pulled_in_large_steps(case):
    """One node pulled by 1 and 1000 nN in steps of 20 s, 200 s, and chosen ones.

    No step is too long for 1 nN; with 1000 nN sound, or one error that names style, cell, step and
    remedy."""
    large_steps(case, node_pulled, (1.0, 1000.0), volume=(0.2, 1.2), quality=0.001)


@hard("Force", schemes=("implicit",))
def torn_apart_in_large_steps(case):
    """Two sticking cells pulled apart by 5 and 500 nN in steps of 20 s, 200 s, and chosen ones.

    Sound and apart, or one error that names style, cell, step and remedy."""
    large_steps(case, torn, (5.0, 500.0), bears=False)


def large_steps(case, make, forces, bears=True, **limits):
    for name, dt in LARGE.items():
        for k, force in enumerate(forces):
            scene, extra = make(case, force)
            deck = case.deck(
                scene,
                600.0,
                dt or 1.0,
                extra=extra,
                maxmove="" if dt is None else "1",
                auto="tol 0.02 max 60" if dt is None else "",
            )
            run = case.run(deck, fails=True, show=dt is None and k == 0)
            whole = sound_or_stops(case, run, **limits)
            if bears and k == 0:
                case.check(f"{name}, {force:g} nN: sound", whole, least=1)


@hard("Force")
def every_law_and_adhesion(case):
    """Two cells, laws foundation, dmt and maugis, with adhesion from none to 10 nN/um, a hundred
    times the usual one.

    Without adhesion they stay apart, with more they come closer; from ten times the usual one on,
    sound or one error with the remedy. Law maugis refuses what it would turn into repulsion."""
    for law in ("foundation", "dmt", "maugis"):
        for W in (0.0, 0.1, 1.0, 10.0):
            scene = case.scenes.doublet(level=1, gap=-0.1, box=25.0)
            contact = case.contact(scene, f"law {law}", f"W {W}")
            deck = case.deck(scene, 200.0, case.pick(0.5, 2.0), contact=contact)
            run = case.run(deck, fails=True)
            if run.returncode and law == "maugis" and W == 10.0:
                case.stopped(run, "too strong for law maugis", "E_contact")
                continue
            if run.returncode == 0:
                case.sound(run, volume=(0.5, 1.05), depth=0.75)
                far = run.first.cells[1]  # a coarse mesh reaches beyond the sphere of its volume
                free = 2.0 * np.linalg.norm(far.x - far.centroid, axis=1).max() + 0.05
                case.check(
                    f"{law}, W {W}: distance",
                    apart(run.last),
                    unit="um",
                    **(dict(most=11.9) if W else dict(least=11.85, most=free)),
                )
            else:
                case.stopped(run, *NAMED)
                case.check(f"{law}, W {W}: may stop", W > 0.1, least=1)
            case.picture = run.path / "dump.txt" if run.returncode == 0 else case.picture


@hard("Force")
def limp_cortex(case):
    """Two sticking cells without tension and with a cortex a ninth as stiff, that wrinkles.

    Sound, or one error that names style, cell, step and remedy."""
    scene = case.scenes.Scene(25.0, level=2)
    for x in (-5.95, 5.95):
        scene.dcm(x, 0.0, 0.0, 6.0, options="rotate 3 rest 1.0")
    files = {PARAMETERS: one_type(E_cor=2.0, h_cor=0.3)}
    run = case.run(case.deck(scene, 800.0, case.pick(0.5, 4.0)), files=files, fails=True, show=True)
    sound_or_stops(case, run, volume=(0.5, 1.05), quality=0.005, depth=0.75)


@hard("Force")
def small_cell_pressed_into_a_large_one(case):
    """A cell of radius 2 pressed with 2 and 20 nN into one of radius 12.

    The small one does not pass in: sound, or one error that names style, cell, step and remedy."""

    def make(case, force):
        scene = case.scenes.Scene(40.0, level=2)
        scene.dcm(0.0, 0.0, 0.0, 12.0)
        scene.dcm(13.9, 0.0, 0.0, 2.0)
        return scene, push(2, -force, 162) + push(1, force, 162)

    # limit of the pair: 0.75 of the mean edge of the small cell
    rising(case, make, (2.0, 20.0), 100.0, 0.0, volume=(0.2, 1.05), depth=0.75)


@hard("Force")
def step_that_inverts(case):
    """Steps of 300 s with the limit on displacements lifted: cells turn inside out.

    The run stops with one error that names the cell, before a number is none; implicit steps may
    also go on, with cells that are whole."""
    scene = case.scenes.doublet(level=2, gap=-0.3, box=60.0)
    deck = case.deck(scene, 30000.0, 300.0, maxmove="1e9", frames=100)
    run = case.run(deck, fails=True, show=True)
    if run.returncode or not case.implicit:
        case.stopped(run, r"dcm/", r"cells? \d+")
    else:
        case.sound(run, volume=(0.5, 1.2))
        case.check("distance", apart(run.last), least=9.0, most=12.0, unit="um", spread=1.0)
    finite = all(np.isfinite(f.x).all() for f in run.frames)
    case.check("frames with no number", 0 if finite else 1, most=0)
