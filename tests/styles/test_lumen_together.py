"""All styles of the lumen in one deck: polarity, constriction, tracers, osmosis, signaling, with
division.

A ring of four cells around a hole along z. Cells 1 to 3 are cholangiocytes, cell 4 a hepatoblast
that the others signal to; it divides, and its daughters are cholangiocytes."""

import math

import numpy as np
import pytest

from support.cycle_decks import same
from support.divisions import Cell, frame_at, read_log
from support.parameters import CONTACT, CORTEX, FRICTION, cell_type

HEPATOBLAST, TRACER_TYPE, CHOLANGIOCYTE = (1, 2, 3), 5, (6, 7, 8)
CENTER, NODE, FACE, TRACER = 2, 3, 4, 5  # kinds
LATERAL, POLAR, APICAL, JUNCTION, BASAL = range(5)
CYCLE = 58  # s, of the hepatoblast, which divides then; at no look of polarity and osmosis
SLAB = 1.6

FILE = "together.dcm"
NAMES = "hepatoblast hepatoblast hepatoblast NULL NULL" + " cholangiocyte" * 3


def parameters(cycle=CYCLE, later=1e9):
    text = (
        cell_type("hepatoblast", **CORTEX, **CONTACT, **FRICTION, D=1e-4, cycle_time=cycle)
        + cell_type("cholangiocyte", **CORTEX, **CONTACT, **FRICTION, D=1e-4, cycle_time=later)
    )
    for a, b in (("hepatoblast",) * 2, ("cholangiocyte", "hepatoblast"), ("cholangiocyte",) * 2):
        text += f"adhesion {a} {b} 0.1\n"
        text += f"adhesion {a}:apical {b} 0.02\n"
        text += f"adhesion {a}:junction {b}:junction 0.3\n"
    return text


COLUMNS = (
    "id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6] c_p[7] c_c[1] c_c[2] c_c[3] c_c[4] "
    "c_c[5] c_c[6] c_c[7] c_c[8] c_c[9] c_c[10] c_c[11] c_c[12] c_c[13] "
    "c_f[1] c_f[2] c_f[3] c_f[4] c_f[5] c_lumen xu yu zu vx vy vz fx fy fz"
)
VALUES = (
    [f"osm{k}=f_osm[{k}]" for k in range(1, 10)]
    + ["work=f_osm"]
    + [f"lumen{k}=c_lumen[{k}]" for k in range(1, 9)]
    + [f"tight{k}=f_tight[{k}]" for k in range(1, 5)]
    + [f"tracer{k}=f_tracer[{k}]" for k in range(1, 10)]
    + [f"signal{k}=f_signal[{k}]" for k in range(1, 5)]
    + [f"pol{k}=f_pol[{k}]" for k in range(1, 6)]
)


class Together:
    """Parts of the deck, in their order."""

    def __init__(self, scenes, level=2, cells=4, gap=-1.3, boundary="f f f", box=(24, 24, 12)):
        self.scenes, self.boundary = scenes, boundary
        self.scene = scenes.Scene(box, boundary, level, parameters=FILE)
        self.scene.NAMES = NAMES
        self.d = (6.0 + gap / 2) / math.sin(math.pi / cells)
        for k in range(cells):
            phi = 0.1 + 2 * math.pi * k / cells
            self.scene.dcm(self.d * math.cos(phi), self.d * math.sin(phi), 0.0, 6.0,
                           options=f"rotate {k + 1} rest 0.95")

    def head(self, types=(6, 6, 6, 1)):
        scene = self.scene
        made, scene.cells = scene.cells, [
            line.replace("1 2 3 1 1", f"{a} {a + 1} {a + 2} 1 1")
            for line, a in zip(scene.cells, types, strict=True)
        ]
        text = scene.head().replace("create_box 4", "create_box 8")
        scene.cells = made
        return text

    def again(self, read):
        return f"units lj\natom_style dcm\nnewton on\nboundary {self.boundary}\n{read}"

    def laws(self):
        return self.scene.cortex() + self.scene.contact() + "fix cell all dcm/cell\n"

    def cells(self, *, pressure="pressure 0.2 ramp 20", marks="flood", growth=True, dying="",
              change="", polarity="", constriction="ramp 20", tracer="", secrete="all",
              signal="area 0.01 time 20", osmosis="", motion="tolerance 1e-12", number=30,
              D=0.02, every=5, groups=True):
        scene = self.scene
        return (
            ("group cholangio type 6 7 8\ngroup cells type 1 2 3 6 7 8\n" if groups else "")
            + scene.volume()
            + (f"fix grow all dcm/growth {scene.map} seed 3\n"
               "fix divide all dcm/division seed 7 log div.log plane polarity\n" if growth else "")
            + dying + change
            + "fix pol cells dcm/polarity seed 11 apical 0.7 junction auto plane z "
            + f"init toward 0 0 0 sees lumen freeze 30 every {every} {polarity}\n"
            + f"fix tight cells dcm/constriction cap 0.8 ribbon 0.7 {constriction}\n"
            + f"fix tracer {secrete} dcm/tracer type {TRACER_TYPE} number {number} D {D} seed 5 "
            + f"slab z {-SLAB} {SLAB} {tracer}\n"
            + f"fix osm cells dcm/osmosis {pressure} marks {marks} slab z {-SLAB} {SLAB} "
            + f"secrete {secrete} every {every} {osmosis}\n"
            + f"fix signal cells dcm/signal from cholangio to 6 7 8 {signal}\n"
            + scene.motion(options=motion)
            + "timestep 1.0\n"
        )

    def output(self, every=1, columns=COLUMNS, dump=True):
        return (
            "compute p all property/atom kind vertex1 vertex2 vertex3 home host region\n"
            "compute c all dcm/cell volume volume0 contact_area ax ay az px py pz constricted "
            "constriction fate marked_area\n"
            "compute f all dcm/face mark area contact_area nx ny\n"
            f"compute lumen all dcm/lumen plane z 0 slab {-SLAB} {SLAB}\n"
            + (self.scenes.dump(columns, every) if dump else "")
            + self.scenes.thermo(["atoms", *VALUES], every)
        )  # fmt: skip

    def deck(self, steps, *, head=None, every=1, after="", dump=True, **options):
        return (
            (self.head() if head is None else head) + self.laws() + self.cells(**options)
            + self.output(every, dump=dump) + after + (f"run {steps}\n" if steps else "")
        )  # fmt: skip


FILES = {FILE: parameters()}


def get(row, name):
    return row["v_" + name]


def winding(x, corners):
    """Solid angle of a closed surface seen from points x, over 4 pi."""
    a, b, c = (corners[None, :, k] - x[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    triple = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    below = (la * lb * lc + np.einsum("ijk,ijk->ij", a, b) * lc
             + np.einsum("ijk,ijk->ij", b, c) * la + np.einsum("ijk,ijk->ij", c, a) * lb)
    return np.arctan2(triple, below).sum(axis=1) / (2 * np.pi)


def inside(x, cell):
    return winding(x, np.stack(cell.corners, axis=1)) > 0.5


def tracers(frame):
    """Their rows in the frame: x, home, host."""
    rows = frame["c_p[1]"] == TRACER
    return frame["id"][rows], frame.x[rows], frame["c_p[5]"][rows], frame["c_p[6]"][rows]


def cells_of(frame):
    mine = frame["c_p[1]"] == CENTER
    return sorted(frame["mol"][mine].astype(int))


def value(frame, molecule, column):
    return frame[column][(frame["c_p[1]"] == CENTER) & (frame["mol"] == molecule)][0]


def axes(frame, molecule):
    return [value(frame, molecule, f"c_c[{k}]") for k in range(4, 10)]


CONSTRICTED, CONSTRICTION, FATE, MARKED_AREA = (f"c_c[{k}]" for k in range(10, 14))
MARK, AREA, COVERED, REGION = "c_f[1]", "c_f[2]", "c_f[3]", "c_p[7]"


def sound(frames):
    """Tracers lie where their home says: with regard to the surfaces of the frame before, against
    which they were moved, or, of new cells, to their own. Those that a dying cell sets free are put
    out of cells that it overlapped at the beginning of the next step."""
    for before, frame in zip(frames[:-1], frames[1:], strict=True):
        tags, x, home, host = tracers(frame)
        now, then = cells_of(frame), cells_of(before)
        was = dict(zip(*(tracers(before)[k] for k in (0, 2)), strict=True))
        freed = np.array([was[tag] not in {0, *now} for tag in tags], dtype=bool)
        assert set(home) <= {0, *now}
        for molecule in now:
            within = inside(x, Cell(before if molecule in then else frame, molecule))
            assert within[home == molecule].all(), (frame.step, molecule)
            assert not within[(home == 0) & (host == 0) & ~freed].any(), (frame.step, molecule)


# --- a cell at the lumen divides ------------------------------------------------------------------


def distances(points, corners):
    """Distances (points, triangles), of points to triangles as sampled."""
    a, b, c = (corners[:, k] for k in range(3))
    n = 8
    u, v = (w.ravel() for w in np.meshgrid(*[np.arange(n + 1) / n] * 2))
    u, v = u[u + v <= 1 + 1e-9], v[u + v <= 1 + 1e-9]
    cloud = a[:, None] + u[:, None] * (b - a)[:, None] + v[:, None] * (c - a)[:, None]
    return np.linalg.norm(points[:, None, None] - cloud[None], axis=3).min(axis=2)


def faces_of(frame, molecule):
    """Rows of its faces, in the order of Cell.faces."""
    return np.flatnonzero((frame["c_p[1]"] == FACE) & (frame["mol"] == molecule))


@pytest.mark.parametrize("np_", [1, 2])
def test_a_cell_at_the_lumen_divides(lmp, scenes, np_):
    """What is told on the pages about tracers, marks, regions, vectors, constriction, fate, volume.

    The cell begins to round up in the middle of its ramp, at a look of none of the styles."""
    together = Together(scenes)
    deck = (
        together.deck(50, number=100, dump=False, every=1)
        + scenes.dump(COLUMNS, 1) + "run 16\n"
    )  # fmt: skip
    result = lmp(deck, np=np_, files=FILES)
    (row,) = read_log(result.path)
    step, mother, daughters = row["step"], row["mother"], row["daughters"]
    thermo = {int(r["Step"]): r for r in result.thermo}
    frames = [frame_at(result, k) for k in range(50, 67)]
    before, frame = (frame_at(result, step + k) for k in (-1, 0))
    assert mother == 4 and cells_of(frame) == [1, 2, 3, *daughters]

    # the fate is decided, the daughters are cholangiocytes
    assert value(before, mother, FATE) == 1 and get(thermo[step], "signal3") == 1
    for daughter in daughters:
        assert set(frame["type"][frame["mol"] == daughter]) == {*CHOLANGIOCYTE}
        assert value(frame, daughter, FATE) == 0

    # vectors, and the plane
    assert np.abs(row["axis"] - axes(before, mother)[3:]).max() < 1e-6
    for later in range(step, step + 6):
        for daughter in daughters:
            assert axes(frame_at(result, later), daughter) == axes(before, mother)

    # the constriction: let go in the mother, begun anew in the daughters
    assert value(before, mother, CONSTRICTED) >= 0.0
    share = [value(frame_at(result, k), mother, CONSTRICTION) for k in range(50, step)]
    assert share[0] == 1.0 and share[-1] < 1.0  # it rounds up faster than the ramp runs back
    assert all(value(frame, daughter, CONSTRICTED) < 0.0 for daughter in daughters)
    born = {d: value(frames[-1], d, CONSTRICTED) for d in daughters}
    assert all(step < born[d] <= step + 5 for d in daughters), born

    # tracers
    sound([f for f in frames if -2 <= f.step - step <= 4])
    tags, _, home, _ = tracers(before)
    assert (home == mother).sum() > 80
    _, x, now, _ = tracers(frame)
    of_mother = now[home == mother]
    left = of_mother == 0
    assert set(of_mother) <= {0, *daughters}
    exits = get(thermo[step], "tracer3") - get(thermo[step - 1], "tracer3")
    assert left.sum() <= exits <= 3
    for daughter in daughters:
        assert (of_mother == daughter).sum() > 20
    assert (tracers(frame)[0] == tags).all()

    # marks and regions are those of the mother's surface there
    old = Cell(before, mother)
    corners = np.stack(old.corners, axis=1)
    rows = faces_of(before, mother)
    edge = np.mean([np.linalg.norm(corners[:, k] - corners[:, k - 1], axis=1) for k in range(3)])
    marked = 0
    for daughter in daughters:
        mine = faces_of(frame, daughter)
        y = frame.x[mine]
        every = distances(y, corners)
        distance = every.min(axis=1)
        across = np.abs((y - old.centroid) @ row["axis"]) < 0.1 * edge
        outer = distance < 0.12 * edge
        assert across.sum() > 10 and outer.sum() > 40
        plane = across & (distance > edge)
        assert plane.sum() > 10
        assert not frame[MARK][mine[plane]].any()
        assert (frame[REGION][mine[plane]] == LATERAL).all()
        for f in np.flatnonzero(outer & ~across):
            near = rows[every[f] < distance[f] + 0.3 * edge]
            assert frame[REGION][mine[f]] in before[REGION][near], (daughter, y[f])
        to_marks = every[:, before[MARK][rows] == 1].min(axis=1)
        # within 0.3 mean edges, of all cells, at the start of the step: all edges are longer then
        assert (to_marks[frame[MARK][mine] == 1] < 0.45 * edge).all()
        marked += frame[AREA][mine][frame[MARK][mine] == 1].sum()
    kept = before[AREA][rows][before[MARK][rows] == 1].sum()
    assert 0.6 * kept < marked < 2.0 * kept

    # the lumen's volume: what the daughters leave free or take of the space in the slab, and the
    # change of a step
    rng = np.random.default_rng(1)
    lo, hi = old.x.min(axis=0) - 0.5, old.x.max(axis=0) + 0.5
    lo[2], hi[2] = -SLAB, SLAB
    points = lo + (hi - lo) * rng.random((3000, 3))
    ring = np.linalg.norm(points[:, :2], axis=1) < np.linalg.norm(old.centroid[:2])
    points = points[ring]
    was = inside(points, old)
    new = np.any([inside(points, Cell(frame, d)) for d in daughters], axis=0)
    part = np.prod(hi - lo) / 3000.0
    gain, loss = (was & ~new).sum() * part, (new & ~was).sum() * part
    volume = {k: get(thermo[k], "lumen2") for k in range(step - 6, step + 6)}
    jump = volume[step] - volume[step - 1]
    usual = max(abs(volume[k] - volume[k - 1]) for k in range(step - 5, step))
    assert -loss - usual < jump < gain + usual
    assert get(thermo[step + 1], "lumen1") >= 1 and get(thermo[step + 1], "osm3") == 5


# --- restart --------------------------------------------------------------------------------------

RESTARTS = (17, 63)


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_is_bit_for_bit(lmp, scenes, np_):
    """In the ramps of pressure and constriction, with time of contact counted; and after the
    division, while the daughters' vectors stay. Between two looks."""
    together = Together(scenes)
    first, second = RESTARTS
    deck = together.deck(first, every=1, dump=False, head="processors * 1 1\n" + together.head())
    deck += f"write_restart r.{first}\nrun {second - first}\nwrite_restart r.{second}\n"
    deck += scenes.dump(COLUMNS, 6) + f"run {75 - second}\n"
    whole = lmp(deck, np=np_, files=FILES)
    thermo = {int(row["Step"]): row for row in whole.thermo}
    assert 0.0 < get(thermo[first], "tight4") < 1.0 and get(thermo[first], "signal1") == 1
    assert get(thermo[second], "signal3") == 1 and get(thermo[second], "tracer2") > 3
    (row,) = read_log(whole.path)
    assert first < row["step"] < second
    for step in RESTARTS:
        head = f"processors * 1 1\nread_restart r.{step}\n"
        stops = [second, 75] if step == first else [75]
        deck = head + f"pair_coeff * * {together.scene.map}\nneighbor 0.6 multi\n"
        deck += "fix cell all dcm/cell\n" + together.cells(groups=False)
        deck += together.output(dump=False)
        for stop in stops:
            if stop == 75:
                deck += scenes.dump(COLUMNS, 6)
            deck += f"run {stop} upto\n"
            if stop == second:  # sums of this process go into the record: as the whole run does
                deck += "write_restart again\n"
        rest = lmp(deck, np=np_, files={**FILES, f"r.{step}": whole.path / f"r.{step}"})
        for a in rest.thermo:
            b = thermo[int(a["Step"])]
            assert a == b, [(k, a[k], b[k]) for k in a if a[k] != b[k]]
        for a, b in zip(whole.dump(), rest.dump(), strict=True):
            same(a, b, COLUMNS)


# --- ranks ----------------------------------------------------------------------------------------

WHOLE = "id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6] c_p[7] c_f[1] c_lumen"


def compare(one, other, np_):
    for a, b in zip(one.dump(), other.dump(), strict=True):
        same(a, b, WHOLE)
        assert np.abs(a.x - b.x).max() < 1e-9, a.step  # um
        for column in (CONSTRICTED, CONSTRICTION, FATE):
            assert np.array_equal(a[column], b[column]), (a.step, column)
    for a, b in zip(one.thermo, other.thermo, strict=True):
        for key in a:
            # work and force of marks that do not close: differences of larger numbers
            assert b[key] == pytest.approx(a[key], rel=1e-7, abs=1e-8), (np_, a["Step"], key)


def test_1_2_3_and_4_ranks_agree(lmp, scenes):
    """Cells, homes of tracers, marks, lumens, fates are the same; positions to round-off."""
    deck = Together(scenes).deck(80, every=10)
    one = lmp(deck, files=FILES)
    (row,) = read_log(one.path)
    last = one.thermo[-1]
    assert get(last, "signal3") == 1 and get(last, "tracer2") > 3 and get(last, "tight1") == 5
    for np_ in (2, 3, 4):
        compare(one, lmp(deck, np=np_, files=FILES), np_)


# --- marks and pressure ---------------------------------------------------------------------------


def apical_data(lmp, scene, pick):
    """Data file of the scene in which faces are apical if pick(centroid)."""
    made = lmp(scene.head().replace("create_box 4", "create_box 8")
               + "write_data x.data nofix nocoeff\n", files=FILES)
    start, _, rest = (made.path / "x.data").read_text().partition("Atoms # dcm\n\n")
    atoms, end = rest.split("\n\n", 1)
    atoms = [line.split() for line in atoms.splitlines()]
    # id mol type kind radius x y z v1 v2 v3 region volume0 ix iy iz
    for row in atoms:
        if int(row[3]) == FACE and pick(np.array(row[5:8], float)):
            row[11] = str(APICAL)
    return start + "Atoms # dcm\n\n" + "\n".join(map(" ".join, atoms)) + "\n\n" + end


READ = "read_data x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"


def around_origin(x):
    return math.hypot(x[0], x[1]) < 5.5


@pytest.mark.parametrize("np_", [1, 2])
def test_tracers_mark_what_the_flood_does(lmp, scenes, np_):
    """Surfaces at rest; after the tracers have had the time to spread."""
    together = Together(scenes, gap=-0.3)
    data = apical_data(lmp, together.scene, around_origin)
    area = {}
    for marks, steps in (("flood", 2), ("tracer", 250)):
        deck = (
            together.again(READ) + together.laws() + "comm_modify cutoff 8.5\n"
            + together.scene.volume() + f"fix tracer all dcm/tracer type {TRACER_TYPE} number 60 "
            + f"D 0.14 seed 5 slab z {-SLAB} {SLAB}\n"
            + f"fix osm all dcm/osmosis pressure 0 marks {marks} slab z {-SLAB} {SLAB} every 1\n"
            + "compute f all dcm/face mark area contact_area\n"
            + "timestep 1.0\n" + scenes.dump("id type c_f[1] c_f[2] c_f[3]", 1000)
            + scenes.thermo(["out=f_tracer[2]"], 50)
            + f"run {steps}\nwrite_dump all custom last.txt id type c_f[1] c_f[2] c_f[3] "
            + "modify sort id format float %.17g\n"
        )  # fmt: skip
        result = lmp(deck, np=np_, files={**FILES, "x.data": data})
        frame = result.dump("last.txt")[0]
        area[marks] = np.where(frame["c_f[1]"] == 1, frame["c_f[2]"], 0.0)
        if marks == "tracer":
            assert result.thermo[-1]["v_out"] > 20
    both = np.minimum(area["flood"], area["tracer"]).sum()
    either = np.maximum(area["flood"], area["tracer"]).sum()
    assert area["flood"].sum() > 20.0
    assert both == pytest.approx(either, rel=1e-12)


@pytest.mark.parametrize("weight", ["full", "free"])
def test_net_force_and_torque_of_several_cells(lmp, scenes, weight):
    """All of the surface of four touching cells is marked and closes: with weight full force and
    torque are round-off. With weight free, what is in contact is not pushed on, and of a lumen
    between the cells the marks do not close: the net force is P times the missing area vector."""
    together = Together(scenes)
    data = apical_data(lmp, together.scene, around_origin)
    for marks in ("starter 0 0 0 100 1e9", f"slab z {-SLAB} {SLAB}"):
        frames = []
        for P in (0.0, 1.0):
            deck = (
                together.again(READ) + together.laws() + together.scene.volume()
                + f"fix osm all dcm/osmosis pressure {P} marks flood {marks} weight {weight}\n"
                + "compute f all dcm/face mark area contact_area nx ny nz\n"
                + scenes.dump("id type c_f[1] c_f[2] c_f[3] c_f[4] c_f[5] c_f[6] xu yu zu "
                              "fx fy fz", 1)
                + scenes.thermo(["force=f_osm[6]", "closure=f_osm[7]", "area=f_osm[1]"])
                + "run 0\n"
            )  # fmt: skip
            result = lmp(deck, files={**FILES, "x.data": data})
            frames.append(result.dump()[0])
        force = frames[1].f - frames[0].f
        total, torque = force.sum(axis=0), np.cross(frames[0].x, force).sum(axis=0)
        frame, row = frames[1], result.thermo[-1]
        scale, arm = get(row, "area"), np.abs(frame.x).max()
        marked = frame["c_f[1]"] == 1
        # starters are pushed on in full, whatever the weight
        full = weight == "full" or "starter" in marks
        w = frame["c_f[2]"] - (0.0 if full else frame["c_f[3]"])
        normals = frame.vectors("c_f[4]", "c_f[5]", "c_f[6]")
        missing = (w[:, None] * normals)[marked].sum(axis=0)
        # the forces of the cells, which are subtracted, are no larger
        assert np.abs(total + missing).max() < 1e-12 * scale
        assert get(row, "force") == pytest.approx(np.linalg.norm(missing), abs=1e-12 * scale)
        if "starter" in marks:
            assert marked.sum() == 4 * 320
            assert np.abs(total).max() < 1e-12 * scale
            assert np.abs(torque).max() < 1e-12 * scale * arm


def test_hysteresis_of_marks(lmp, scenes):
    """Two cells approach and part again: a mark falls when more than half of its face is in
    contact, and comes back when less than theta is."""
    scene = scenes.doublet(level=2, gap=0.6)
    scene.parameters, scene.NAMES = FILE, NAMES
    data = apical_data(lmp, scene, lambda x: True)
    deck = (
        f"units lj\natom_style dcm\nnewton on\nboundary {scene.boundary}\n" + READ
        + scene.forces() + "group left molecule 1\ngroup right molecule 2\n"
        + "fix osm all dcm/osmosis pressure 0 marks flood every 1 free 0.05\n"
        + "fix one left move wiggle 0.6 0.0 0.0 60.0\nfix two right move wiggle -0.6 0.0 0.0 60.0\n"
        + "compute f all dcm/face mark area contact_area\ntimestep 1.0\n"
        + scenes.dump("id type c_f[1] c_f[2] c_f[3]", 1) + "run 30\n"
    )  # fmt: skip
    frames = lmp(deck, files={**FILES, "x.data": data}).dump()
    seen = np.zeros(3, dtype=int)
    for before, frame in zip(frames[1:-1], frames[2:], strict=True):
        face = before["type"] == 3
        # a mark of a step is of the contacts at the end of the step before
        part = before["c_f[3]"][face] / before["c_f[2]"][face]
        was, now = before["c_f[1]"][face] == 1, frame["c_f[1]"][face] == 1
        assert now[part < 0.05].all() and not now[part > 0.5].any(), frame.step
        between = (part > 0.05) & (part < 0.5)
        assert (now == was)[between].all(), frame.step
        seen += [(between & was).sum(), (between & ~was).sum(), (part > 0.5).sum()]
    assert (seen > 10).all(), seen


# --- cells that come, go and change ---------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
def test_all_cells_of_a_lumen_divide_in_one_step(lmp, scenes, np_):
    together = Together(scenes)
    result = lmp(
        together.deck(48, head=together.head((1, 1, 1, 1)), dump=False, signal="area 0.01 time inf")
        + scenes.dump(COLUMNS, 1) + "run 20\n",
        np=np_, files={FILE: parameters(cycle=50)},
    )  # fmt: skip
    log = read_log(result.path)
    assert len(log) == 4 and len({row["step"] for row in log}) == 1
    step = log[0]["step"]
    thermo = {int(row["Step"]): row for row in result.thermo}
    for k in range(step, step + 18):
        row = thermo[k]
        assert get(row, "tracer1") + get(row, "tracer2") + get(row, "tracer5") == 120
    assert get(thermo[step - 1], "tight1") == 4 and get(thermo[step], "tight1") == 0
    assert get(thermo[step], "osm1") > 0.5 * get(thermo[step - 1], "osm1")
    assert get(thermo[step + 1], "osm1") > 0.5 * get(thermo[step - 1], "osm1")
    last = result.thermo[-1]
    assert get(last, "osm3") == 8 and get(last, "tight1") == 8 and get(last, "lumen1") >= 1
    frames = [frame_at(result, k) for k in range(step - 1, step + 3)]
    sound(frames)


@pytest.mark.parametrize(("np_", "death"), [(1, "delete"), (2, "release")])
def test_the_last_secreting_cell_dies(lmp, scenes, np_, death):
    """Its tracers go or are set free; nobody secretes any longer, so that all marks fall; the cells
    left stay constricted and keep their vectors."""
    together = Together(scenes)
    result = lmp(
        together.head() + "group one molecule 2\n" + together.laws()
        + together.cells(
            secrete="one", tracer=f"death {death}",
            dying="variable dies atom step>=25\nfix death one dcm/death variable v_dies\n",
        )
        + together.output(1) + "run 35\n",
        np=np_, files=FILES,
    )  # fmt: skip
    thermo = {int(row["Step"]): row for row in result.thermo}
    frames = result.dump()
    gone = next(frame.step for frame in frames if 2 not in cells_of(frame))
    assert 25 <= gone <= 27
    assert get(thermo[gone - 1], "osm3") == 4
    held = get(thermo[gone - 1], "tracer1")
    last = result.thermo[-1]
    assert get(last, "tracer1") == 0
    assert get(last, "tracer8") == (held if death == "delete" else 0)
    assert get(last, "tracer2") + get(last, "tracer5") == 30 - get(last, "tracer8")
    assert get(last, "osm2") == 0 and get(last, "lumen1") == 0
    assert get(last, "tight1") == 3 and get(last, "pol1") == 3
    sound(frames[20:])


@pytest.mark.parametrize(("np_", "death"), [(1, "delete"), (2, "release")])
def test_a_secreting_cell_becomes_a_sphere(lmp, scenes, np_, death):
    together = Together(scenes)
    together.scene.NAMES = NAMES.replace("NULL", "hepatoblast_cbm", 1)
    text = parameters() + cell_type("hepatoblast_cbm", K_V=2.5, **CONTACT, **FRICTION, D=1e-4)
    for other in ("hepatoblast", "cholangiocyte", "hepatoblast_cbm"):
        text += f"adhesion hepatoblast_cbm {other} 0.1\n"
    result = lmp(
        together.head() + "group one molecule 2\n" + together.laws() + "neighbor 0.8 multi\n"
        + together.cells(
            tracer=f"death {death}", growth=False,
            change="variable out atom 24.5-step\n"
            "fix change one dcm/convert dcm 6 7 8 1 1 cbm 4 variable v_out every 1\n",
        )
        + together.output(1) + "run 35\n",
        np=np_, files={FILE: text},
    )  # fmt: skip
    thermo = {int(row["Step"]): row for row in result.thermo}
    frames = result.dump()
    change = next(frame.step for frame in frames if 2 not in cells_of(frame))
    held = (tracers(frame_at(result, change - 1))[2] == 2).sum()
    assert held > 20 and get(thermo[change - 1], "osm3") == 4
    last = result.thermo[-1]
    assert get(last, "tracer8") == (held if death == "delete" else 0)
    total = sum(get(last, f"tracer{k}") for k in (1, 2, 5, 8))
    assert total == 120
    assert get(last, "tight1") == 3 and get(last, "pol1") == 3
    assert set(frames[-1]["type"][frames[-1]["mol"] == 2]) == {4}
    sound(frames[20:])
