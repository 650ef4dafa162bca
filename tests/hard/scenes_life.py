"""Hard cases of life: cells that divide, die and change their form in bad conditions."""

import numpy as np

from hard.mixed import one_type
from hard.suite import NAMED, hard
from support.meshes import icosphere, off
from support.parameters import PARAMETERS

SPHERE_VOLUME = 4.0 / 3.0 * np.pi


def life(scene, cycle, *, group="all", growth="", plane=""):
    return (
        f"fix grow {group} dcm/growth {scene.map} seed 5 cycle_time {cycle} {growth}\n"
        f"fix divide all dcm/division seed 7 log div.log {plane}\n"
    )


def scene_of(case, *args, **options):
    """A scene without a type for center-based cells, for which pair_style would make room."""
    scene = case.scenes.Scene(*args, **options)
    scene.NAMES = "hepatoblast hepatoblast hepatoblast NULL"
    return scene


def divisions(run):
    """Rows of the log: volumes of mother and daughters."""
    rows = []
    for line in (run.path / "div.log").read_text().splitlines():
        if not line.startswith("#"):
            w = line.split()
            rows.append(
                dict(
                    step=int(w[0]),
                    mother=int(w[2]),
                    generation=int(w[5]),
                    volume=float(w[10]),
                    daughters=(float(w[11]), float(w[12])),
                    pressure=float(w[14]),
                )
            )
    return rows


def judge(case, run, count, volume=(0.6, 1.3), quality=0.1, **options):
    """As many divisions as there should be, whose daughters share the mother's volume."""
    rows = divisions(run)
    case.check("divisions", len(rows), least=count, most=count)
    # the log has seven digits
    off = max(
        (abs(2.0 * v / row["volume"] - 1.0) for row in rows for v in row["daughters"]), default=0.0
    )
    case.check("daughters off half the mother's volume", off, most=2e-6, spread=1.0)
    case.sound(run, volume=volume, quality=quality, **options)


def cage(case, scene, distance):
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    for k in range(3):
        for sign in (-1.0, 1.0):
            at = [0.0, 0.0, 0.0]
            at[k] = sign * distance
            scene.dcm(*at, 6.0)
    return "group mother molecule 1\ngroup cage molecule 2:7\ngroup inner subtract all cage\n"


@hard("Life", section="z=0")
def division_in_a_cage(case):
    """A cell that grows and divides between six cells that do not move.

    It divides under more than twice the pressure of a free cell into halves, and they stay in the
    cage."""
    cycle, dt = 300.0, case.pick(1.0, 2.0)
    free = scene_of(case, 20.0, level=2)
    free.dcm(0.0, 0.0, 0.0, 6.0)
    alone = case.run(case.deck(free, cycle + 10.0, dt, extra=life(free, cycle)))
    scene = scene_of(case, 25.0, level=2)
    before = cage(case, scene, 11.5)
    deck = case.deck(
        scene,
        cycle + 30.0,
        dt,
        before=before,
        extra=life(scene, cycle, group="mother"),
        group="inner",
        frames=11,
    )
    run = case.run(deck, show=True)
    case.check(
        "pressure over that of a free cell",
        divisions(run)[0]["pressure"] / divisions(alone)[0]["pressure"],
        least=2.0,
    )
    far = max(np.linalg.norm(c.centroid) for m, c in run.last.cells.items() if m not in range(2, 8))
    case.check("daughters from the middle", far, most=6.0, unit="um")
    judge(case, run, 1, volume=(0.4, 1.1), balanced=False, depth=0.5)


@hard("Life")
def all_at_once(case):
    """Eight touching cells that divide in the same step.

    Sixteen sound daughters, that share their mothers' volumes."""
    scene = scene_of(case, 40.0, level=2 if case.full else 1)
    for i in range(8):
        scene.dcm(*(6.2 * (2 * np.array([i % 2, i // 2 % 2, i // 4]) - 1)), 6.0)
    dt = case.pick(1.0, 2.0)
    run = case.run(case.deck(scene, 220.0, dt, extra=life(scene, 200)), show=True)
    case.check("steps with a division", len({row["step"] for row in divisions(run)}), most=1)
    judge(case, run, 8, depth=0.5)


def fast_cycle(case, cycle, generations):
    scene = scene_of(case, 40.0, level=1)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    deck = case.deck(
        scene,
        generations * cycle + 4.0,
        case.pick(1.0, 2.0),
        contact=case.contact(scene, "growth 2"),  # the mother's own and her stretch at the end
        extra=life(scene, cycle),
        frames=generations,
    )
    run = case.run(deck, fails=True, show=True)
    if run.returncode:
        case.stopped(run, *NAMED)
    else:
        judge(case, run, 2**generations - 1, depth=None)


@hard("Life")
def cycle_of_20_s(case):
    """Cells of 42 nodes that divide every 20 s, before they are round, four times.

    Fifteen divisions into halves, or one error that names style, cell, step and remedy."""
    fast_cycle(case, 20.0, 4)


@hard("Life")
def cycle_of_60_s(case):
    """Cells of 42 nodes that divide every 60 s, four times.

    Fifteen divisions into halves, or one error that names style, cell, step and remedy."""
    fast_cycle(case, 60.0, 4)


@hard("Life")
def cycle_of_a_few_relaxation_times(case):
    """Cells that divide every 200 s, a few of their relaxation times, three times.

    Seven divisions into halves; all cells are sound."""
    scene = scene_of(case, 40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    deck = case.deck(scene, 606.0, case.pick(1.0, 2.0), extra=life(scene, 200), frames=3)
    judge(case, case.run(deck, show=True), 7, depth=0.5)


def ellipsoid(level, *axes):
    x, faces = icosphere(level)
    return off(x * np.array(axes), faces), ("body.off", len(x), len(faces))


@hard("Life")
def flat_and_long_mothers(case):
    """Mothers of the shapes 3:3:1 and 3:1:1, grown up at the start, that divide at once along and
    across, in the long version also askew and along their longest axis.

    Halves of the volume, no face of the newborn below quality 0.15."""
    more = ["given 1 0 1", "long"] if case.full else []
    for axes in ((1.0, 1.0, 1.0 / 3.0), (3.0, 1.0, 1.0)):
        for plane in ("given 1 0 0", "given 0 0 1", *more):
            text, mesh = ellipsoid(2, *axes)
            scene = scene_of(case, 30.0, level=2)
            scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=mesh, options="rest 0.95")
            extra = life(
                scene, 4, plane=f"plane {plane}", growth=f"newborn {0.5 * SPHERE_VOLUME * 216.0!r}"
            )
            deck = case.deck(scene, 0.8, 0.05, extra=extra, thermo=["worst=f_divide[6]"])
            run = case.run(deck, files={"body.off": text}, show=True)
            case.check("worst face of a newborn", run.thermo[-1]["v_worst"], least=0.15, spread=0.1)
            judge(case, run, 1, depth=None)


@hard("Life")
def death_of_all_but_one(case):
    """Eight cells of which seven die in one step, and the last one lives on.

    One cell is left, as round and large as one that was alone all the time, to 1e-3."""
    scene = scene_of(case, 40.0, level=1)
    for i in range(8):
        scene.dcm(*(5.9 * (2 * np.array([i % 2, i // 2 % 2, i // 4]) - 1)), 6.0)
    die = "variable doomed atom (mol!=5)*(step>40)\n"
    die += "fix die all dcm/death variable v_doomed every 10\n"
    dt = case.pick(1.0, 4.0)
    run = case.run(case.deck(scene, 400.0, dt, extra=die, frames=40), show=True)
    alone = scene_of(case, 40.0, level=1)
    alone.dcm(0.0, 0.0, 0.0, 6.0)
    single = case.run(case.deck(alone, 400.0, dt))
    case.check("cells", len(run.last.cells), least=1, most=1)
    case.close(
        "volume, of a single cell", run.last.cells[5].volume, single.last.cells[1].volume, rel=1e-3
    )
    case.close(
        "area, of a single cell",
        run.last.cells[5].areas.sum(),
        single.last.cells[1].areas.sum(),
        rel=1e-3,
    )
    case.sound(run, volume=(0.9, 1.0))
    case.picture = run.path / "dump.txt"


@hard("Life")
def conversion_at_a_moving_border(case):
    """A row of cells that become deformable and spheres again as a border runs to and fro over
    them.

    No cell is lost or doubled, rest volumes are kept to 1e-6 over all conversions, and all
    cells are sound."""
    scene = case.scenes.Scene((40.0, 12.0, 12.0), "p p p", level=1)
    for x in (-30.0, -18.0, -6.0, 6.0, 18.0, 30.0):
        scene.cbm(x, 0.0, 0.0, 5.9)
    dt = case.pick(1.0, 2.0)
    extra = (
        "variable at equal 25*sin(0.04*step*dt)\n"
        "variable form atom (x<v_at)-(x>v_at+2)\n"
        "fix conv all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_form mesh icosphere 1 rest 0.95"
        " every 1\n"
    )
    deck = case.deck(
        scene,
        320.0,
        dt,
        extra=extra,
        frames=16,
        thermo=["n=f_conv[1]+f_conv[2]"],
        cortex=scene.cortex(),
        volume=scene.volume(),
    )
    run = case.run(deck.replace("neighbor 0.6", "neighbor 1.0"), show=True)  # necks of spheres
    count = [len(f.cells) + len(f.spheres) for f in run.frames]
    case.check("conversions", run.thermo[-1]["v_n"], least=12, spread=1.0)
    case.check("cells, least", min(count), least=6, most=6)
    case.check("cells, most", max(count), least=6, most=6)
    rest = {int(m): v for m, v in zip(run.last["mol"], run.last["volume0"]) if v > 0.0}
    sizes = [rest.get(m, 0.0) for m in run.last.cells]
    sizes += [SPHERE_VOLUME * r**3 for _, r in run.last.spheres.values()]
    case.close("mean rest volume", np.mean(sizes) / (SPHERE_VOLUME * 5.9**3), 1.0, tol=0.02)
    case.sound(run, volume=(0.7, 1.1), periodic=True)


@hard("Life")
def shrinking_between_neighbors(case):
    """A cell that dies by shrinking to nothing between two that stick to it.

    It goes when a twentieth of its volume is left; the others end whole, and nobody in another."""
    scene = scene_of(case, 30.0, level=2)
    for x in (-11.9, 0.0, 11.9):
        scene.dcm(x, 0.0, 0.0, 6.0)
    die = "group middle molecule 2\nfix die middle dcm/death all shrink 200 log death.log\n"
    run = case.run(case.deck(scene, 240.0, case.pick(0.5, 2.0), extra=die, frames=6), show=True)
    case.check("cells at last", len(run.last.cells), least=2, most=2)
    case.sound(run, volume=(0.9, 1.02))


@hard("Life")
def large_mesh_divides(case):
    """A cell of 2,562 nodes (642 in the quick version) that divides, in steps of 1 s.

    Two sound daughters with half the volume each."""
    scene = scene_of(case, 20.0, level=4 if case.full else 3)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    growth = f"rounding 0.05 0.95 newborn {0.505 * SPHERE_VOLUME * 216.0!r}"
    deck = case.deck(scene, 24.0, 1.0, extra=life(scene, 200, growth=growth), maxmove="1")
    judge(case, case.run(deck, show=True), 1, depth=0.5)
    case.check(
        "nodes of a daughter",
        len(next(iter(case_cells(case))).x),
        least=642 if not case.full else 2562,
    )


def case_cells(case):
    from hard.surfaces import read_snapshots

    return read_snapshots(case.picture)[-1].cells.values()


@hard("Life")
def ten_generations(case):
    """Ten generations of which one daughter each dies.

    Meshes do not decay: volumes at division differ by less than 1 % from the fourth on, and no
    newborn has a face below quality 0.5."""
    cycle = 200.0
    scene = scene_of(case, 30.0, level=1)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    dt = case.pick(1.0, 4.0)
    every = round(60.0 / dt)
    die = f"variable odd atom (mol>1)*(mol%2)\nfix die all dcm/death variable v_odd every {every}\n"
    deck = case.deck(scene, 10 * cycle, dt, extra=life(scene, cycle) + die, frames=100)
    run = case.run(deck, show=True)
    rows = divisions(run)
    volumes = np.array([row["volume"] for row in rows])
    case.check("generations", max(row["generation"] for row in rows), least=10, most=10)
    case.check(
        "volume at division off the mean",
        np.abs(volumes[3:] / volumes[3:].mean() - 1.0).max(),
        most=0.01,
    )
    quality = [min(c.quality for c in f.cells.values()) for f in run.frames[20:]]
    case.check("worst face of all frames", min(quality), least=0.5, spread=0.05)
    judge(case, run, 10)


@hard("Life")
def stiff_cell_divides(case):
    """A mother ten times as stiff as usual, in cortex and volume, that divides.

    Halves of the volume, sound daughters; the step is that of the stiff cell."""
    scene = scene_of(case, 20.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    files = {PARAMETERS: one_type(E_cor=50.0, K_V=25.0)}
    growth = f"newborn {0.55 * SPHERE_VOLUME * 216.0!r}"
    deck = case.deck(scene, 60.0, case.pick(0.05, 0.5), extra=life(scene, 200, growth=growth))
    judge(case, case.run(deck, files=files, show=True), 1)


@hard("Life")
def division_at_a_periodic_corner(case):
    """A mother around the corner of a periodic box, for two generations.

    Three divisions into halves, in the same steps and at the same places as in the middle of the
    box, within a tenth of a daughter's radius: there are many states of balance close together."""
    ends = []
    for at in ((0.0, 0.0, 0.0), (19.5, -19.0, 19.875)):
        scene = scene_of(case, 20.0, "p p p", level=1)
        scene.dcm(*at, 6.0)
        deck = case.deck(scene, 410.0, case.pick(1.0, 2.0), extra=life(scene, 200), frames=10)
        run = case.run(deck)
        ends.append((run, at))
    middle, corner = (run for run, _ in ends)
    steps = [[row["step"] for row in divisions(run)] for run in (middle, corner)]
    case.check("divisions in other steps", sum(a != b for a, b in zip(*steps)), most=0)
    shift = np.array(ends[1][1])
    off = 0.0
    for m, cell in corner.last.cells.items():
        d = cell.centroid - shift - middle.last.cells[m].centroid
        off = max(off, np.abs(d - 40.0 * np.round(d / 40.0)).max())
    case.picture = corner.path / "dump.txt"
    case.check("off the run in the middle", off, most=0.4, unit="um", spread=1.0)
    judge(case, corner, 3, periodic=True, depth=0.5)


@hard("Life")
def division_at_the_border(case):
    """A cell that grows and divides 0.6 um from the border of the box.

    A shrink-wrapped box follows; from a fixed one nodes are lost, and one error says so."""
    for boundary in ("s s s", "f f f"):
        scene = scene_of(case, 15.0, boundary, level=1)
        scene.dcm(-8.4, 0.0, 0.0, 6.0)
        deck = case.deck(scene, 220.0, case.pick(1.0, 2.0), extra=life(scene, 200))
        run = case.run(deck, fails=boundary == "f f f", show=boundary == "s s s")
        if boundary == "s s s":
            judge(case, run, 1, depth=0.5)
        else:
            case.stopped(run, r"[Ll]ost atoms|cell \d.* at step \d+.*lost through a fixed boundary")


@hard("Life")
def sisters_without_and_with_strong_adhesion(case):
    """Sisters that do not stick, and that stick ten times as much as usual.

    Halves of the volume, sound; those that stick share more surface."""
    area = []
    for W in (0.0, 1.0):
        scene = scene_of(case, 20.0, level=2)
        scene.dcm(0.0, 0.0, 0.0, 6.0)
        contact = case.contact(scene, "", f"W {W}")
        extra = life(scene, 200) + "compute contact all pair dcm/contact\n"
        deck = case.deck(
            scene,
            300.0,
            case.pick(1.0, 2.0),
            extra=extra,
            contact=contact,
            thermo=["area=c_contact[3]"],
        )
        run = case.run(deck, show=True)
        judge(case, run, 1, depth=0.5)
        area.append(run.thermo[-1]["v_area"])
    case.check("contact, strong over none", area[1] / area[0], least=1.5, spread=0.2)


@hard("Life", quick="implicit", section="z=0")
def tissue_that_fills_its_box(case):
    """Eight cells that grow and divide in a periodic box until there is no room.

    They fill the box but for the sagitta of their coarse faces, stay whole, and their pressure
    rises to more than 0.5 kPa; or one error that names cells, step and remedy."""
    side = 12.5
    scene = scene_of(case, side, "p p p", level=1)
    for i in range(8):
        scene.dcm(*(0.5 * side * (2 * np.array([i % 2, i // 2 % 2, i // 4]) - 1)), 5.0)
    extra = life(scene, 280, growth="cycle_sd 40 age random")
    extra += "compute p all dcm/cell pressure\n".replace("compute p ", "compute press ")
    deck = case.deck(
        scene, 560.0, case.pick(1.0, 4.0), extra=extra, thermo=["p=c_press[2]"], frames=7
    )
    run = case.run(deck, fails=True, show=True)
    if run.returncode:
        case.stopped(run, *NAMED)
        return
    cells = run.last.cells.values()
    filled = sum(c.volume for c in cells) / (2.0 * side) ** 3
    # contact is that of the spheres through the faces, which lie e^2/6R over their middles
    gap = sum(c.areas.sum() * c.mean_edge**2 / (6.0 * c.radius) for c in cells) / (2.0 * side) ** 3
    case.check("cells over box", filled, least=0.95 - gap, most=1.05, spread=0.1)
    case.check("mean pressure", run.thermo[-1]["v_p"], least=0.5, unit="kPa", spread=0.05)
    case.sound(run, volume=(0.3, 1.02), periodic=True, depth=0.5)
