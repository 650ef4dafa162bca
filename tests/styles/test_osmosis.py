"""fix dcm/osmosis: marks, pressure, work; closed forms, ranks, restart."""

import math

import numpy as np
import pytest

from support.bad_decks import fails, whole
from support.data_files import section
from support.divisions import Cell, frame_at, molecules, read_log, scene_of

FOREVER = 1e9
VECTOR = ("area", "faces", "cells", "volume", "pressure", "force", "closure", "lost", "solute")
KV, SURFACE = 2.5, 4.0  # of support/parameters.py


def osmosis(options, group="all", id="osm"):
    return f"fix {id} {group} dcm/osmosis {options}\n"


def everywhere(r=100.0):
    """All faces within r of the origin are sources, in contact or not."""
    return f"marks flood starter 0 0 0 {r} {FOREVER}"


def values(scenes, every=1, extra=(), id="osm"):
    names = [f"{name}=f_{id}[{n}]" for n, name in enumerate(VECTOR, 1)] + [f"work=f_{id}"]
    return scenes.thermo([*names, *extra], every)


def get(row, name):
    return row["v_" + name]


def with_regions(lmp, scene, pick, setup=""):
    """Data file of the scene in which faces are apical if pick(molecule, centroid)."""
    data = lmp(scene.head() + setup + "write_data x.data nofix nocoeff\n").path / "x.data"
    text = data.read_text()
    atoms = [line.split() for line in section(text.replace("Atoms # dcm", "Atoms"), "Atoms")]
    # id mol type kind radius x y z v1 v2 v3 region volume0 ix iy iz
    for row in atoms:
        if int(row[3]) == 4:
            row[11] = "2" if pick(int(row[1]), np.array(row[5:8], dtype=float)) else "0"
    start, _, rest = text.partition("Atoms # dcm\n\n")
    end = rest.partition("\n\n")[2]
    lines = "\n".join(" ".join(row) for row in atoms)
    return f"{start}Atoms # dcm\n\n{lines}\n\n{end}"


def read(boundary="s s s"):
    return (
        f"units lj\natom_style dcm\nnewton on\nboundary {boundary}\n"
        "read_data x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
    )


# --- pressure -------------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("P", [0.0, 0.3])
def test_pressure_all_around_one_cell(lmp, scenes, P, np_):
    """Like an outer pressure: p = P + 2T/R at rest, and V = V0 exp(-p/K_V); nothing moves on.

    On a mesh 2T/R is exactly -W/(3V), W being the virial of its edges: hinges have none.
    """
    scene = scenes.single_cell(level=2)
    result = lmp(
        scene.head() + scene.forces() + osmosis(f"pressure {P} {everywhere()}")
        + scene.motion(options="tolerance 1e-12")
        + "compute c all dcm/cell volume volume0 pressure area\n"
        + "compute v all reduce sum c_c[*]\n"
        + "compute edges all pressure NULL bond\n"
        + scenes.dump("id mol type xu yu zu vx vy vz fx fy fz", 600)
        + values(scenes, 600, [*(f"c{k}=c_v[{k}]" for k in (1, 2, 3, 4)), "W=3*c_edges*vol"])
        + "timestep 1.0\nrun 600\n",
        np=np_,
    )  # fmt: skip
    last, frame = result.thermo[-1], result.dump()[-1]
    V, V0, p, S = (get(last, f"c{k}") for k in (1, 2, 3, 4))
    assert V == pytest.approx(V0 * math.exp(-p / KV), rel=1e-12)
    assert p == pytest.approx(P - get(last, "W") / (3 * V), rel=1e-6)
    R, scale = math.cbrt(0.75 * V / math.pi), p * S
    assert np.abs(frame.f.sum(axis=0)).max() < 1e-13 * scale
    assert np.abs(np.cross(frame.x, frame.f).sum(axis=0)).max() < 1e-13 * R * scale
    assert get(last, "pressure") == P
    # the marked faces look out of the cell: what they enclose counts against the lumen
    assert get(last, "volume") == pytest.approx(-V, rel=1e-12)
    assert get(last, "area") == pytest.approx(S, rel=1e-12)
    assert (get(last, "faces"), get(last, "cells")) == (320, 1)
    assert get(last, "closure") < 1e-13 and get(last, "force") <= 1e-12 * P * S
    assert "the lumen is open" in result.out


def test_work_is_the_integral_of_P_dV(lmp, scenes):
    """Over a run in which the pressure begins at once; and again with a pressure that changes."""
    scene = scenes.single_cell(level=1)
    for P, tolerance in (("0.3", 1e-3), ("v_P", 1e-3)):
        result = lmp(
            scene.head() + scene.forces() + "variable P equal 0.2+0.002*step\n"
            + osmosis(f"pressure {P} {everywhere()}")
            + scene.motion() + values(scenes, 1) + "timestep 1.0\nrun 60\n"
        )  # fmt: skip
        V = np.array([get(row, "volume") for row in result.thermo])
        p = np.array([get(row, "pressure") for row in result.thermo])
        work = (0.5 * (p[1:] + p[:-1]) * np.diff(V)).sum()
        assert V[-1] - V[0] > 5.0  # the cell shrinks, the space around it grows
        assert get(result.thermo[0], "work") == 0.0
        assert get(result.thermo[-1], "work") == pytest.approx(work, rel=tolerance)


def test_virial_is_that_of_a_pressure(lmp, scenes):
    """Forces -P A n/3 on all faces of a closed cell: r.F sums to -3 P V."""
    scene = scenes.single_cell(level=1)
    result = lmp(
        scene.head() + scene.forces() + osmosis(f"pressure 0.3 {everywhere()}")
        + "compute p all pressure NULL fix\nfix_modify volume virial no\n"
        + values(scenes, 1, ["W=3*c_p*vol"]) + "run 0\n"
    )  # fmt: skip
    row = result.thermo[0]
    assert get(row, "W") == pytest.approx(3 * 0.3 * get(row, "volume"), rel=1e-12)


def test_dilution_and_ramp(lmp, scenes):
    """P0 min(1, V*/V) and a line in time; with solute nkT/V besides."""
    scene, files = ring_data(lmp, scenes)
    result = lmp(
        ring_deck(scene, "pressure 0.2 dilute 5 ramp 10 marks flood slab z -3 3 every 1")
        + scene.motion() + values(scenes) + "timestep 1.0\nrun 15\n",
        files=files,
    )  # fmt: skip
    for row in result.thermo:
        full = 0.2 * min(1.0, row["Step"] / 10)
        V = get(row, "volume")
        assert V > 5.0
        assert get(row, "pressure") == pytest.approx(full * 5 / V, rel=1e-9)


def test_solute_stops_a_lumen(lmp, scenes):
    """n grows by R per secreting area and time, P = n kT/V; with a loss it becomes steady."""
    scene, files = ring_data(lmp, scenes)
    result = lmp(
        ring_deck(scene, "solute rate 2e-3 kT 2.577 marks flood slab z -3 3 every 1")
        + scene.motion() + values(scenes) + "timestep 1.0\nrun 20\n",
        files=files,
    )  # fmt: skip
    rows = result.thermo
    assert get(rows[0], "solute") == 0.0
    for row in rows:
        expected = get(row, "solute") * 2.577 / max(1.0, get(row, "volume"))
        assert get(row, "pressure") == pytest.approx(expected, rel=1e-12)
    grown = np.diff([get(row, "solute") for row in rows])[1:]
    assert (grown > 0.0).all()
    # all of the wall that is apical secretes; here less than all of it is
    assert (grown <= 2e-3 * max(get(row, "area") for row in rows)).all()


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("weight", ["free", "full"])
def test_implicit_step_knows_that_the_pressure_falls(lmp, scenes, weight, np_):
    """(A + dt c g g^T) v = F with c = P/V and the force g of a unit of pressure, against the
    Sherman-Morrison formula; A and g from the steps with two constant pressures."""
    scene, files = ring_data(lmp, scenes)
    dt = 20.0

    def step(pressure):
        result = lmp(
            ring_deck(scene, f"{pressure} marks flood slab z -3 3 every 1 weight {weight}")
            + scene.motion(options="tolerance 1e-13 scheme implicit maxmove 10") + values(scenes)
            + scenes.dump("id type vx vy vz fx fy fz", 1) + f"timestep {dt}\nrun 0\n",
            files=files, np=np_,
        )  # fmt: skip
        frame = result.dump()[0]
        nodes = frame["type"] == 2
        return frame.v[nodes].ravel(), frame.f[nodes].ravel(), result.thermo[0]

    v, f, row = step("pressure 1.0 dilute 5.0")
    P, V = get(row, "pressure"), get(row, "volume")
    assert P == pytest.approx(5.0 / V, rel=1e-12) and V > 10.0
    v0, f0, _ = step(f"pressure {P!r}")
    v1, f1, _ = step(f"pressure {P + 0.5!r}")
    assert np.abs(f - f0).max() < 1e-12 * np.abs(f).max()
    g, moved = (f1 - f0) / 0.5, (v1 - v0) / 0.5    # moved: A^-1 g
    c = dt * P / V
    expected = v0 - c * moved * (g @ v0) / (1.0 + c * (g @ moved))
    assert np.abs(expected - v0).max() > 0.05 * np.abs(v0).max()
    assert np.abs(v - expected).max() < 1e-8 * np.abs(v0).max()


# --- marks ----------------------------------------------------------------------------------------


def ring(scenes, level=1, boundary="s s s", gap=-0.6):
    """Four cells around a hole at the origin."""
    scene = scenes.Scene((28.0, 28.0, 16.0), boundary, level)
    d = (6.0 + gap / 2) * math.sqrt(2)
    for k in range(4):
        phi = 0.1 + k * math.pi / 2
        scene.dcm(
            d * math.cos(phi), d * math.sin(phi), 0.0, 6.0, options=f"rotate {k + 1} rest 0.95"
        )
    return scene


def ring_data(lmp, scenes, **options):
    """The ring and its data file, apical around the hole."""
    scene = ring(scenes, **options)
    return scene, {"x.data": with_regions(lmp, scene, lambda mol, x: math.hypot(x[0], x[1]) < 5.5)}


def ring_deck(scene, options):
    return (
        read(scene.boundary) + scene.cortex() + scene.contact() + "fix cell all dcm/cell\n"
        + scene.volume() + osmosis(options)
    )  # fmt: skip


@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_1_2_3_and_4_ranks_agree(lmp, scenes, boundary):
    scene, files = ring_data(lmp, scenes, boundary=boundary)
    # in the periodic box the lumen lies on a corner of it
    shift = "displace_atoms all move 28 28 16\n" if boundary == "p p p" else ""
    deck = (
        ring_deck(scene, "pressure 0.3 ramp 20 marks flood" + (" slab z -4 4" if not shift else ""))
        + shift
        + "compute lumen all dcm/lumen"
        + (" plane z 0 slab -3 3\n" if not shift else "\n")
        + "compute mark all dcm/face mark\n"
        + scene.motion()
        + scenes.dump("id mol type c_mark c_lumen xu yu zu", 20)
        + values(scenes, 20, [f"l{k}=c_lumen[{k}]" for k in range(1, 9)])
        + "timestep 1.0\nrun 100\n"
    )
    one = lmp(deck, files=files)
    frames = one.dump()
    assert get(one.thermo[-1], "faces") > 10 and get(one.thermo[-1], "cells") == 4
    assert frames[-1]["c_mark"].sum() == get(one.thermo[-1], "faces")
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_, files=files)
        for a, b in zip(frames, other.dump(), strict=True):
            assert (a["id"] == b["id"]).all()
            assert (a["c_mark"] == b["c_mark"]).all() and (a["c_lumen"] == b["c_lumen"]).all()
            assert np.abs(a.x - b.x).max() < 1e-9  # um
        for a, b in zip(one.thermo, other.thermo, strict=True):
            for key in a:
                assert b[key] == pytest.approx(a[key], rel=1e-8, abs=1e-12), (np_, key)


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize(
    "options",
    [
        "pressure 0.3 marks flood slab z -4 4 ramp 100 dilute 30 memory yes starter apical 70",
        "solute rate 1e-3 kT 2.577 loss 200 marks flood slab z -4 4",
    ],
)
def test_restart_is_bit_for_bit(lmp, scenes, options, np_):
    columns = "id mol type xu yu zu vx vy vz fx fy fz c_mark c_lumen"
    scene, files = ring_data(lmp, scenes)
    fixes = (
        "fix cell all dcm/cell\n" + scene.volume() + osmosis(options) + scene.motion()
        + "compute lumen all dcm/lumen\ncompute mark all dcm/face mark\n"
        + "timestep 1.0\n" + scenes.dump(columns, 5) + values(scenes, 5)
    )  # fmt: skip
    # between two looks
    whole = lmp(
        "processors * 1 1\n" + read() + scene.cortex() + scene.contact() + fixes
        + "restart 45 r.*\nrun 90\n",
        np=np_,
        files=files,
    )  # fmt: skip
    rest = lmp(
        "processors * 1 1\nread_restart r.45\n" + f"pair_coeff * * {scene.map}\n"
        + "neighbor 0.6 multi\n" + fixes + "restart 45 r.*\nrun 45\n",
        np=np_,
        files={"r.45": whole.path / "r.45"},
    )  # fmt: skip
    assert get(whole.thermo[-1], "faces") > 10
    for a, b in zip(whole.dump()[9:], rest.dump(), strict=True):
        assert a.step == b.step
        for name in columns.split():
            assert (a[name] == b[name]).all(), (a.step, name)
    assert whole.thermo[9:] == rest.thermo


@pytest.mark.parametrize("np_", [1, 2])
def test_writing_restart_files_changes_nothing(lmp, scenes, np_):
    """Work is summed up as without them, to the last bit; a run that continues has the same."""
    scene, files = ring_data(lmp, scenes)
    fixes = (
        "fix cell all dcm/cell\n" + scene.volume()
        + osmosis("pressure 0.3 marks flood slab z -4 4 ramp 10") + scene.motion()
        + "timestep 1.0\n" + scenes.thermo(["work=f_osm"], 1)
    )  # fmt: skip
    head = "processors * 1 1\n"
    start = head + read() + scene.cortex() + scene.contact() + fixes
    # not `restart N`, which has LAMMPS rebuild the neighbor lists in these steps
    plain = lmp(start + "run 21\nrun 19\n", np=np_, files=files).thermo
    written = lmp(start + "run 21\nwrite_restart r.21\nrun 19\n", np=np_, files=files)
    assert [row["v_work"] for row in written.thermo] == [row["v_work"] for row in plain]
    assert plain[-1]["v_work"] > 0.0
    again = head + f"read_restart r.21\npair_coeff * * {scene.map}\nneighbor 0.6 multi\n" + fixes
    rest = lmp(again + "run 19\n", np=np_, files={"r.21": written.path / "r.21"})
    assert [row["v_work"] for row in rest.thermo] == [row["v_work"] for row in plain[-20:]]
    if np_ == 1:  # on another number of processes: as a sum
        two = lmp(again + "run 0\n", np=2, files={"r.21": written.path / "r.21"})
        assert two.thermo[0]["v_work"] == pytest.approx(plain[-20]["v_work"], rel=1e-12)


def test_marks_in_a_slab(lmp, scenes):
    """Faces with their centroid in it; forces across its axis need not vanish, along it they do."""
    scene = scenes.single_cell(level=2)
    result = lmp(
        scene.head() + scene.forces()
        + osmosis(f"pressure 1 {everywhere()} slab z -2 2 weight full")
        + "compute mark all dcm/face mark\n" + scenes.dump("id type c_mark xu yu zu", 1)
        + values(scenes) + "run 0\n"
    )  # fmt: skip
    frame = result.dump()[0]
    face = frame["type"] == 3
    inside = np.abs(frame["zu"][face]) < 2.0
    assert 60 < inside.sum() < 160
    assert (frame["c_mark"][face] == inside).all()
    assert get(result.thermo[0], "faces") == inside.sum()
    # a ring of the cell of its own height 4, seen from outside: -pi R^2 4 less what is curved
    assert -math.pi * 36 * 4 < get(result.thermo[0], "volume") < -math.pi * 32 * 3


def test_memory_keeps_marks_without_a_source(lmp, scenes):
    scene = scenes.single_cell(level=1)
    for memory, faces in (("yes", 80), ("no", 0)):
        result = lmp(
            scene.head() + scene.forces()
            + osmosis(f"pressure 0.1 marks flood starter 0 0 0 100 20 memory {memory} every 5")
            + scene.motion() + values(scenes) + "timestep 1.0\nrun 40\n"
        )  # fmt: skip
        for row in result.thermo:
            assert get(row, "faces") == (80 if row["Step"] < 20 else faces), row["Step"]
            lost = row["Step"] in range(20, 25) and memory == "no"
            assert (get(row, "lost") > 0.0) == lost


@pytest.mark.parametrize("np_", [1, 2])
def test_starter_between_apical_faces(lmp, scenes, np_):
    """Two cells in contact with apical faces there: marked, in full, as long as it lasts."""
    scene = scenes.doublet(level=2, gap=-0.6)
    data = with_regions(lmp, scene, lambda mol, x: abs(x[0]) < 0.9)
    deck = (
        read() + scene.cortex() + scene.contact() + "fix cell all dcm/cell\n" + scene.volume()
        + osmosis("pressure 0.05 marks flood {} every 1")
        + "compute f all dcm/face mark contact_area area region\n" + scene.motion()
        + scenes.dump("id mol type c_f[1] c_f[2] c_f[3] c_f[4] xu yu zu", 1)
        + values(scenes) + "timestep 1.0\nrun 40\n"
    )  # fmt: skip
    result = lmp(deck.format("starter apical 20"), files={"x.data": data}, np=np_)
    without = lmp(deck.format(""), files={"x.data": data}, np=np_)
    for frame in without.dump():
        closed = (frame["c_f[4]"] == 2) & (frame["c_f[2]"] > 0.6 * frame["c_f[3]"])
        assert not (frame["c_f[1]"] == 1)[closed].any()
    for frame in result.dump():
        touching = (frame["c_f[4]"] == 2) & (frame["c_f[2]"] > 0.6 * frame["c_f[3]"])
        assert touching.sum() >= 6, frame.step
        marked = frame["c_f[1]"] == 1
        if frame.step < 20:
            assert marked[touching].all()
        else:
            assert not marked[touching].any()
    assert get(result.thermo[0], "cells") == 2


def test_daughters_take_the_marks_of_the_surface_they_are_made_of(lmp, scenes):
    """In the step of the division as regions do; the next step decides anew."""
    scene = scene_of(scenes, 15.0, "f f f")
    scene.dcm(0.0, 0.0, 0.0, 6.0, options="rotate 3 rest 1")
    data = with_regions(lmp, scene, lambda mol, x: x[2] > 0.0)
    for np_ in (1, 2):
        result = lmp(
            read("f f f") + scene.cortex() + scene.contact() + "fix cell all dcm/cell\n"
            + scene.volume()
            + f"fix grow all dcm/growth {scene.map} seed 5 cycle_time 40\n"
            + "fix divide all dcm/division seed 7 log div.log plane given 1 0 0\n"
            # marks reach all of the cell's surface
            + osmosis("pressure 0.01 marks flood every 1000") + scene.motion(options="")
            + "timestep 1.0\ncompute p all property/atom kind vertex1 vertex2 vertex3 region\n"
            + "compute c all dcm/cell volume volume0 contact_area marked_area\n"
            + "compute m all dcm/face mark nx contact_area area\n"
            + scenes.dump(
                "id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_c[1] c_c[2] c_c[3] c_c[4] "
                "c_m[1] c_m[2] c_m[3] c_m[4] xu yu zu vx vy vz fx fy fz", 1)
            + "run 45\n",
            files={"x.data": data}, np=np_,
        )  # fmt: skip
        (row,) = read_log(result.path)
        step = row["step"]
        before, frame, after = (frame_at(result, step + k) for k in (-1, 0, 1))
        assert molecules(frame) == [2, 3]
        face = frame["c_p[1]"] == 4
        mother = before["c_p[1]"] == 4
        assert before["c_m[1]"][mother].all()
        for molecule, side in ((2, -1.0), (3, 1.0)):
            mine = face & (frame["mol"] == molecule)
            marked, nx = frame["c_m[1]"][mine] == 1, side * frame["c_m[2]"][mine]
            x = frame["xu"][mine]
            # the plane faces across: no mark; the outer surface: marked
            plane = (nx > 0.95) & (np.abs(x) < 0.3)
            assert plane.sum() > 5 and not marked[plane].any()
            outer = np.abs(x) > 3.0
            assert outer.sum() > 10 and marked[outer].all()
            assert Cell(frame, molecule).volume > 0.0
        # and by contact afterwards
        face = after["c_p[1]"] == 4
        part = after["c_m[3]"][face] / after["c_m[4]"][face]
        assert not (after["c_m[1]"][face] == 1)[part > 0.6].any()
        assert (after["c_m[1]"][face] == 1)[part < 0.01].all()
        # the look was before atoms moved
        assert (after["id"] == frame["id"]).all()
        total = (after["c_m[1]"] * frame["c_m[4]"])[face].sum()
        assert after["c_c[4]"].sum() == pytest.approx(total, rel=1e-12)


# --- cells that come and go -----------------------------------------------------------------------


def test_the_last_secreting_cell_dies(lmp, scenes):
    """The others keep what is free around the hole with memory, and lose it without."""
    scene, files = ring_data(lmp, scenes)
    for memory in ("yes", "no"):
        result = lmp(
            read() + scene.cortex() + scene.contact() + "fix cell all dcm/cell\n"
            + scene.volume() + "group source molecule 1\n"
            + f"fix growth all dcm/growth {scene.map} seed 3 cycle_time 1e9\n"
            + "fix dying source dcm/death all every 10\n"
            + osmosis(
                "pressure 0.1 marks flood slab z -4 4 secrete source every 5 memory " + memory
            )
            + scene.motion() + values(scenes, 1) + "timestep 1.0\nrun 30\n",
            files=files,
        )  # fmt: skip
        assert get(result.thermo[5], "cells") == 4
        last = result.thermo[-1]
        assert (get(last, "cells"), get(last, "faces") > 5) == (
            (3, True) if memory == "yes" else (0, False)
        )
        assert get(last, "force") >= 0.0


@pytest.mark.parametrize("np_", [1, 2])
def test_all_cells_of_a_lumen_divide_in_one_step(lmp, scenes, np_):
    scene, files = ring_data(lmp, scenes, boundary="f f f")
    scene.NAMES = "hepatoblast hepatoblast hepatoblast NULL"
    result = lmp(
        read("f f f") + scene.cortex() + scene.contact()
        + "fix cell all dcm/cell\n" + scene.volume()
        + f"fix grow all dcm/growth {scene.map} seed 5 cycle_time 20\n"
        + "fix divide all dcm/division seed 7 log div.log plane given 0 0 1\n"
        + osmosis("pressure 0.1 marks flood slab z -4 4") + scene.motion(options="")
        + values(scenes, 1) + "timestep 1.0\nrun 25\n",
        files=files, np=np_,
    )  # fmt: skip
    log = read_log(result.path)
    assert len(log) == 4 and len({row["step"] for row in log}) == 1
    step = log[0]["step"]
    area = {row["Step"]: get(row, "area") for row in result.thermo}
    assert area[step - 1] > 30.0
    # in the step itself, and when the next look has decided
    assert area[step] > 0.4 * area[step - 1]
    assert area[step + 1] > 0.3 * area[step - 1]


def test_a_cell_at_the_lumen_becomes_a_sphere(lmp, scenes):
    scene, files = ring_data(lmp, scenes)
    result = lmp(
        read() + scene.cortex() + scene.contact() + "neighbor 0.8 multi\n"
        + "fix cell all dcm/cell\n" + scene.volume()
        + "group one molecule 1\n"
        + "variable out atom -step/10+0.45\n"
        + "fix change one dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_out every 5\n"
        + osmosis("pressure 0.1 marks flood slab z -4 4")
        + scene.motion() + values(scenes, 1) + "timestep 1.0\nrun 15\n",
        files=files,
    )  # fmt: skip
    cells = [get(row, "cells") for row in result.thermo]
    assert cells[0] == 4 and cells[-1] == 3
    assert all(math.isfinite(get(row, "volume")) for row in result.thermo)


def test_pressure_far_above_rupture(lmp, scenes):
    """The run goes on, or ends with one error that names style, cell or node, step and remedy."""
    scene, files = ring_data(lmp, scenes)
    for P in (5.0, 500.0):
        result = lmp.run(
            ring_deck(scene, f"pressure {P} marks flood slab z -4 4") + scene.motion()
            + values(scenes, 5) + "timestep 1.0\nrun 40\n",
            files=files,
        )  # fmt: skip
        errors = [line for line in result.out.splitlines() if "ERROR" in line]
        if result.returncode == 0:
            assert not errors and math.isfinite(get(result.thermo[-1], "volume"))
        else:
            assert len(errors) == 1 and "Segmentation" not in result.err
            assert "step" in errors[0] and "cell" in errors[0]


# --- bad input ------------------------------------------------------------------------------------

FLOOD = "pressure 0.1 marks flood "
BAD = {
    "nothing": ("marks flood", "give 'pressure P', 'solute"),
    "no marks": ("pressure 1", "add 'marks flood' or 'marks tracer'"),
    "pressure text": ("pressure x marks flood", "pressure is 'x'"),
    "pressure nan": ("pressure nan marks flood", "pressure is 'nan'"),
    "variable": ("pressure v_none marks flood", "no equal-style variable none"),
    "marks": ("pressure 1 marks x", "marks must be flood or tracer"),
    "keyword": (FLOOD + "x 1", "unknown keyword x; known"),
    "dilute": ("dilute 3 marks flood solute rate 1 kT 1", "keyword dilute needs keyword pressure"),
    "dilute 0": (FLOOD + "dilute 0", "dilute is 0.*positive"),
    "solute": ("solute rate 1 marks flood", "solute"),
    "solute word": ("solute x 1 kT 1 marks flood", "solute needs 'rate R kT E'"),
    "solute kT": ("solute rate 1 kT 0 marks flood", "solute kT is 0.*positive"),
    "solute rate": ("solute rate -1 kT 1 marks flood", "solute rate is -1"),
    "secrete": (FLOOD + "secrete none", "secrete: there is no group none"),
    "free": (FLOOD + "free 0.6", "free is 0.6.*0.5"),
    "free 0": (FLOOD + "free 0", "free is 0.*positive"),
    "range": (FLOOD + "range -1", "range is -1.*positive"),
    "weight": (FLOOD + "weight x", "weight must be free or full"),
    "memory": (FLOOD + "memory x", "memory must be no or yes"),
    "slab": (FLOOD + "slab z 3 -3", "slab from 3 to -3 is empty"),
    "slab axis": (FLOOD + "slab w 3 4", "slab must be x, y or z"),
    "starter": (FLOOD + "starter 0 0 0 1", "starter"),
    "starter radius": (FLOOD + "starter 0 0 0 0 5", "starter radius is 0.*positive"),
    "starter time": (FLOOD + "starter apical 0", "starter time is 0.*positive"),
    "ramp": (FLOOD + "ramp -1", "ramp is -1"),
    "every": (FLOOD + "every 0", "every is 0"),
    "tracers": ("pressure 0.1 marks tracer", "marks tracer needs tracers; add a fix dcm/tracer"),
    "not apical": (FLOOD, "no face is apical; add a fix dcm/polarity"),
    "nobody": (FLOOD + "secrete empty", "no deformable cell secretes.*group empty"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_input(lmp, scenes, name):
    options, pattern = BAD[name]
    scene = scenes.single_cell()
    extra = "group empty molecule 99\n" + osmosis(options)
    fails(lmp, whole(scene, extra=extra), "Fix dcm/osmosis: .*" + pattern)


def test_bad_decks(lmp, scenes):
    scene = scenes.single_cell()
    fix = osmosis(FLOOD + "starter 0 0 0 100 10")
    empty = "group empty molecule 99\n" + fix.replace("all", "empty")
    fails(lmp, whole(scene, extra=empty), "Fix dcm/osmosis: no deformable cell.*group empty")
    late = whole(scene) + fix
    fails(lmp, late, "Fix dcm/osmosis: fix osm stands after fix motion")
    twice = fix + fix.replace("fix osm", "fix again")
    fails(lmp, whole(scene, extra=twice), "marked_area already, of another style")
    none = whole(scene, extra=fix, contact="neighbor 0.6 multi\ncomm_modify cutoff 8\n")
    fails(lmp, none, "Fix dcm/osmosis: there is no pair_style dcm/contact")
    far = whole(scene, extra=osmosis(FLOOD + "starter 0 0 0 100 10 range 20"))
    fails(lmp, far, "Fix dcm/osmosis: the ghost cutoff .* is too small for range 20", np=2)
    scene = scenes.single_cell()
    result = lmp(
        whole(scene, extra=osmosis("pressure -0.1 marks flood starter 0 0 0 100 10"))
        + "timestep 1.0\nrun 2\n"
    )
    assert "pressure is -0.1, which sucks lumens shut" in result.out


def test_a_variable_that_is_no_number(lmp, scenes):
    scene = scenes.single_cell()
    result = lmp.run(
        whole(scene, extra="variable P equal 1.0/(3-step)\n"
              + osmosis("pressure v_P marks flood starter 0 0 0 100 1e9"))
        + "timestep 1.0\nthermo 1\nrun 5\n"
    )  # fmt: skip
    assert result.returncode != 0
    assert "Divide by 0" in result.error or "variable P gives the pressure" in result.error
