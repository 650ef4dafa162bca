"""fix dcm/traction: forces, closed forms, which faces, variables, virial, ranks, restart."""

import math

import numpy as np
import pytest

from support.bad_decks import fails, lines_of_error, whole

BARE = "bond_style zero nocoeff\nbond_coeff *\ndihedral_style zero nocoeff\ndihedral_coeff *\n"
LIST = "comm_modify cutoff 12\n"
CELL = "fix cell all dcm/cell\n"
POLARITY = "fix pol all dcm/polarity seed 3 init toward 3 30 8 junction 0.2 0.7 basal 0.6\n"
GROUPS = "group nodes type 2\ngroup faces type 3\n"
SUMS = [f"f{k}=f_load[{k}]" for k in range(1, 5)]
K_V = 2.5


def load(options, group="all", id="load"):
    return f"fix {id} {group} dcm/traction {options}\n"


def get(row, name):
    return row["v_" + name]


@pytest.fixture(scope="module")
def mesh(scenes):
    nodes, faces = scenes.icosphere(1)
    return faces, {"cell.off": scenes.off(nodes, faces)}


def perturbed(scenes, contact=False):
    """A cell across a periodic border, with nothing that acts on it."""
    scene = scenes.Scene(20.0, "p p p")
    scene.dcm(19.0, 2.0, 3.0, 6.0, mesh=("cell.off", 42, 80), options="scale nodes rest 0.95")
    contact = scene.contact() if contact else LIST
    return scene.head() + BARE + GROUPS + (
        "displace_atoms nodes random 0.4 0.4 0.4 4711 units box\n" + contact + CELL
    )


def in_box(frame):
    """A face may be a little beyond the border until the next rebuild."""
    return (frame.vectors("x", "y", "z") + 20.0) % 40.0 - 20.0


def corners(x, faces):
    return (x[faces[:, k]] for k in range(3))


def area_vectors(x, faces):
    a, b, c = corners(x, faces)
    return 0.5 * np.cross(b - a, c - a)


def forces(x, faces, P=0.0, t=(0.0, 0.0, 0.0)):
    """On the nodes; P a number or one a face, t a vector or one a face."""
    S = area_vectors(x, faces)
    A = np.linalg.norm(S, axis=1)[:, None]
    F = A * np.broadcast_to(t, S.shape) - np.broadcast_to(P, len(S))[:, None] * S
    f = np.zeros_like(x)
    for k in range(3):
        np.add.at(f, faces[:, k], F / 3.0)
    return f


# --- forces ---------------------------------------------------------------------------------------

VARIABLES = """variable P equal 0.3+0.1*step
variable tx atom 0.1+0.02*y
variable Pyz atom 0.1*y*z
region ball sphere 19 5 5 5 units box
region side block -18 INF INF INF INF INF units box
"""
CASES = {
    # options, P and t of a face: of step, centroid in the box, number of its surface region
    "pressure": ("pressure 0.3", lambda s, x, r: (0.3, (0, 0, 0))),
    "suction": ("pressure -0.3", lambda s, x, r: (-0.3, (0, 0, 0))),
    "vector": ("vector 0.1 -0.2 0.3", lambda s, x, r: (0.0, (0.1, -0.2, 0.3))),
    "both": ("vector 0.1 0 0 pressure 0.2", lambda s, x, r: (0.2, (0.1, 0, 0))),
    "in time": ("pressure v_P", lambda s, x, r: (0.3 + 0.1 * s, (0, 0, 0))),
    "in space": ("pressure v_Pyz", lambda s, x, r: (0.1 * x[1] * x[2], (0, 0, 0))),
    "mixed": (
        "vector v_tx 0.5 v_P",
        lambda s, x, r: (0.0, (0.1 + 0.02 * x[1], 0.5, 0.3 + 0.1 * s)),
    ),
    "a region": ("pressure 0.3 region side", lambda s, x, r: (0.3 * (x[0] >= -18), (0, 0, 0))),
    "apical": ("pressure 0.3 faces apical", lambda s, x, r: (0.3 * (r == 2), (0, 0, 0))),
    "three": (
        "faces junction basal polar pressure 0.3 region side",
        lambda s, x, r: (0.3 * (r in (1, 3, 4)) * (x[0] >= -18), (0, 0, 0)),
    ),
}


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("name", CASES)
def test_forces(lmp, scenes, mesh, name, np_):
    """Against the formula face by face, on a cell across a periodic border; their sum; the area."""
    options, law = CASES[name]
    faces, files = mesh
    result = lmp(
        perturbed(scenes, contact=True) + "reset_timestep 4\n" + POLARITY + VARIABLES
        + load(options, "faces")
        + "compute r all dcm/face region\n"
        + scenes.dump("id type x y z xu yu zu fx fy fz c_r") + scenes.thermo(SUMS)
        + "run 0\n",
        files=files, np=np_,
    )  # fmt: skip
    frame, row = result.dump()[-1], result.thermo[-1]
    nodes, face = frame["type"] == 2, frame["type"] == 3
    assert set(frame["c_r"][face]) == {0, 1, 2, 3, 4}
    x = frame.x[nodes]
    inside = in_box(frame)[face]
    assert inside[:, 0].min() < -18 and inside[:, 0].max() > 18  # on both sides of the border
    loads = [law(4, *at) for at in zip(inside, frame["c_r"][face], strict=True)]
    P, t = (np.array([one[k] for one in loads], dtype=float) for k in (0, 1))
    expected = forces(x, faces, P, t)
    scale = np.abs(expected).max()
    assert scale > 0.1
    assert np.abs(frame.f[nodes] - expected).max() < 1e-13 * scale
    assert (frame.f[~nodes] == 0.0).all()
    area = np.linalg.norm(area_vectors(x, faces), axis=1)
    loaded = (P != 0.0) | (t != 0.0).any(axis=1)
    assert get(row, "f4") == pytest.approx(area[loaded].sum(), rel=1e-13)
    total = [get(row, f"f{k}") for k in (1, 2, 3)]
    np.testing.assert_allclose(total, expected.sum(axis=0), rtol=0.0, atol=1e-12 * scale)
    if name in ("pressure", "suction", "in time"):
        assert np.abs(total).max() < 1e-12 * scale
        assert np.abs(np.cross(x, expected).sum(axis=0)).max() < 1e-11 * scale


def test_a_region_that_moves_and_a_group_that_does_not(lmp, scenes):
    """Faces come into a moving region; a group chosen once stays with its faces."""
    scene = scenes.single_cell(boundary="f f f", options="rotate 3 rest 1")
    result = lmp(
        scene.head() + BARE + GROUPS + LIST + CELL + scene.volume()
        + "variable down equal -0.1*time\n"
        + "region lid block INF INF INF INF 5 INF move NULL NULL v_down\n"
        + "region top block INF INF INF INF 4 INF\n"
        + "group top region top\ngroup patch intersect faces top\n"
        + load("vector 0 0 -0.01 region lid")
        + load("vector 0 0 -0.01", "patch", "fixed") + scene.motion()
        + "compute f all dcm/face area\ncompute z all property/atom zu\n"
        + scenes.dump("id type xu yu zu c_f", every=10)
        + scenes.thermo([*SUMS, "fixed=f_fixed[4]"], 10) + "timestep 1.0\nrun 30\n"
    )  # fmt: skip
    patch = None
    for frame, row in zip(result.dump(), result.thermo, strict=True):
        face, z, area = frame["type"] == 3, frame["zu"], frame["c_f"]
        inside = face & (z >= 5 - 0.1 * row["Step"])
        assert get(row, "f4") == pytest.approx(area[inside].sum(), rel=1e-12)
        assert get(row, "f3") == pytest.approx(-0.01 * get(row, "f4"), rel=1e-12)
        patch = face & (z >= 4) if patch is None else patch
        assert get(row, "fixed") == pytest.approx(area[patch].sum(), rel=1e-12)
    assert get(result.thermo[-1], "f4") > 2 * get(result.thermo[0], "f4") > 0
    assert (patch != (face & (z >= 4))).any()


# --- closed forms ---------------------------------------------------------------------------------


def at_rest(scenes, extra, steps=400, dt=1.0, options="", level=1):
    scene = scenes.single_cell(level=level, boundary="s s s", options="rotate 3 rest 1")
    return (
        scene.head() + BARE + GROUPS + LIST + CELL + scene.volume()
        + extra.replace("TENSION", f"fix ten all dcm/tension {scene.map} tension")
        + scene.motion(options=f"tolerance 1e-12 {options}")
        + "compute c all dcm/cell volume volume0 area pressure\n"
        + scenes.thermo(["V=C_c[1][1]", "V0=C_c[1][2]", "A=C_c[1][3]", "p=C_c[1][4]"], steps)
        + f"timestep {dt}\nrun {steps}\n"
    )  # fmt: skip


@pytest.mark.parametrize("P", [0.3, -0.2])
@pytest.mark.parametrize("how", ["", "by variable", "implicit"])
def test_pressure_around_a_cell_is_pressure_in_it(lmp, scenes, P, how):
    """At rest the cell's own pressure, -K_V ln(V/V0), is that of the medium."""
    value = "v_P" if how == "by variable" else P
    extra = f"variable P equal {P}\n" + load(f"pressure {value}")
    options, dt = ("scheme implicit", 50.0) if how == "implicit" else ("", 1.0)
    steps = 40 if how == "implicit" else 400
    row = lmp(at_rest(scenes, extra, steps, dt, options)).thermo[-1]
    assert get(row, "p") == pytest.approx(P, rel=1e-9)
    assert get(row, "V") == pytest.approx(get(row, "V0") * math.exp(-P / K_V), rel=1e-9)


@pytest.mark.parametrize("P", [0.05, -0.05])
@pytest.mark.parametrize("how", ["explicit", "implicit", "minimize"])
def test_laplace_law(lmp, scenes, P, how):
    """3 (p - P) V = 2 T A on any mesh, and p - P = 2T/R on a ball, 0.38 % off with 162 nodes."""
    T, level = 0.2, 2
    options, dt, steps = ("scheme implicit", 50.0, 80) if how == "implicit" else ("", 1.0, 400)
    deck = at_rest(scenes, load(f"pressure {P}") + f"TENSION {T}\n", steps, dt, options, level)
    if how == "minimize":
        deck = deck.partition("timestep")[0]
        deck += "timestep 0.05\nmin_style fire\nminimize 0 1e-8 20000 100000\n"
    row = lmp(deck).thermo[-1]
    p, V, A = (get(row, k) for k in ("p", "V", "A"))
    assert 3 * (p - P) * V == pytest.approx(2 * T * A, rel=1e-4)
    assert p - P == pytest.approx(2 * T / math.cbrt(0.75 * V / math.pi), rel=0.005)
    assert V == pytest.approx(get(row, "V0") * math.exp(-p / K_V), rel=1e-9)


def test_a_pulled_cell_moves_as_a_whole(lmp, scenes):
    """A dead traction on all of a ball against the medium: velocity t / friction_ecm."""
    t, ecm = 0.02, 1.0
    scene = scenes.single_cell(level=2, boundary="f f f", options="rest 1")
    result = lmp(
        scene.head() + BARE + LIST + CELL + scene.volume() + load(f"vector 0 0 {t}")
        + scene.motion() + scenes.dump("id type vx vy vz") + "run 0\n"
    )  # fmt: skip
    frame = result.dump()[0]
    v = frame.v[frame["type"] == 2]
    np.testing.assert_allclose(v, np.broadcast_to([0, 0, t / ecm], v.shape), rtol=0, atol=1e-9)


# --- virial ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("options", ["pressure 0.3", "pressure 0.3 vector 0.1 0.2 0.3 region ball"])
def test_virial(lmp, scenes, mesh, options):
    """As of fix addforce: off by default; force times unwrapped position; a pressure has -3 P V.

    Between the two runs atoms beyond the border are wrapped: the same faces are in the region.
    """
    faces, files = mesh
    deck = perturbed(scenes) + VARIABLES + load(options)
    deck += "compute p all pressure NULL fix\ncompute a all stress/atom NULL fix\n"
    deck += "compute s all reduce sum c_a[*]\n"
    columns = [f"p{k}=c_p[{k}]*vol" for k in range(1, 7)]
    columns += [f"s{k}=-c_s[{k}]" for k in range(1, 7)]
    deck += scenes.dump("id type x y z xu yu zu fx fy fz") + scenes.thermo(["step", *columns])
    result = lmp(deck + "run 0\nfix_modify load virial yes\nrun 0\n", files=files)
    off, on = result.runs
    assert all(get(off[0], f"{c}{k}") == 0.0 for c in "ps" for k in range(1, 7))
    frame = result.dump()[0]
    nodes = frame["type"] == 2
    x, f = frame.x[nodes], frame.f[nodes]
    # of a face: its force at its centroid, which is the mean of the corners
    S = area_vectors(x, faces)
    center = x[faces].mean(axis=1)
    inside = in_box(frame)[frame["type"] == 3]
    if "region" in options:
        chosen = np.linalg.norm(inside - [19, 5, 5], axis=1) <= 5
        F = np.linalg.norm(S, axis=1)[:, None] * [0.1, 0.2, 0.3] - 0.3 * S
        assert 3 < chosen.sum() < len(S) - 3
        F = F * chosen[:, None]
    else:
        F = -0.3 * S
        a, b, c = corners(x, faces)
        volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
        assert (x * f).sum() == pytest.approx(-3 * 0.3 * volume, rel=1e-12)
    W = np.einsum("ni,nj->ij", center, F)
    expected = [W[0, 0], W[1, 1], W[2, 2], W[0, 1], W[0, 2], W[1, 2]]
    for k in range(6):
        assert get(on[0], f"p{k + 1}") == pytest.approx(expected[k], rel=1e-11, abs=1e-11)
        assert get(on[0], f"s{k + 1}") == pytest.approx(expected[k], rel=1e-11, abs=1e-11)


# --- ranks and restart ----------------------------------------------------------------------------


def doublet(scenes, boundary):
    """Two adhering cells, a load of each kind."""
    scene = scenes.doublet(level=1, boundary=boundary, gap=-0.4, box=(27.0, 14.0, 14.0))
    shift = "displace_atoms all move 26 13 13\n" if boundary == "p p p" else ""
    fixes = (
        CELL + scene.volume() + POLARITY + GROUPS + "group left molecule 1\n"
        + "variable P equal 0.01+0.001*step\nvariable t atom 0.02*sin(0.3*y)\n"
        + "variable side equal 3+0.02*step\n"
        + "region half block INF INF INF INF -100 0 move NULL NULL v_side units box\n"
        + load("pressure v_P faces lateral basal") + load("vector v_t 0 0.01 region half", id="x")
        + load("pressure -0.02", "left", "one")
        + "".join(f"fix_modify {id} virial yes\n" for id in ("load", "x", "one"))
        + scene.motion() + "timestep 1.0\ncompute v all pressure NULL virial\n"
    )  # fmt: skip
    columns = [f"w{k}=c_v[{k}]" for k in range(1, 7)] + SUMS
    columns += [f"{id}{k}=f_{id}[{k}]" for id in ("x", "one") for k in range(1, 5)]
    output = scenes.dump("id mol type xu yu zu vx vy vz fx fy fz", 10)
    return scene, shift, fixes + output + scenes.thermo(["pe", *columns], 10)


@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_1_2_3_and_4_ranks_agree(lmp, scenes, boundary):
    scene, shift, fixes = doublet(scenes, boundary)
    deck = scene.head() + shift + scene.cortex() + scene.contact() + fixes + "run 60\n"
    one = lmp(deck)
    frames = one.dump()
    assert np.abs(frames[-1].x - frames[0].x).max() > 0.1
    assert all(abs(get(one.thermo[-1], f"{id}4")) > 10 for id in ("f", "x", "one"))
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_)
        for a, b in zip(frames, other.dump(), strict=True):
            assert (a["id"] == b["id"]).all()
            assert np.abs(a.x - b.x).max() < 1e-9
        for a, b in zip(one.thermo, other.thermo, strict=True):
            for key in a:
                assert b[key] == pytest.approx(a[key], rel=1e-8, abs=1e-9), (np_, key)


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_is_bit_for_bit(lmp, scenes, np_):
    scene, _, fixes = doublet(scenes, "f f f")
    run = "processors * 1 1\n"
    whole_run = lmp(
        run + scene.head() + scene.cortex() + scene.contact() + fixes + "restart 30 r.*\nrun 60\n",
        np=np_,
    )
    rest = lmp(
        run + "read_restart r.30\n" + scene.cortex()
        + f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
        + fixes + "restart 30 r.*\nrun 30\n",
        np=np_, files={"r.30": whole_run.path / "r.30"},
    )  # fmt: skip
    for a, b in zip(whole_run.dump()[3:], rest.dump(), strict=True):
        assert a.step == b.step
        for name in a.names:
            assert (a[name] == b[name]).all(), (a.step, name)
    for a, b in zip(whole_run.thermo[3:], rest.thermo, strict=True):
        assert {k: (a[k], b[k]) for k in a if a[k] != b[k]} == {}


# --- hard cases -----------------------------------------------------------------------------------


def test_daughters_bear_the_load(lmp, scenes):
    """A group of one cell's faces goes on to the faces of both daughters."""
    scene = scenes.Scene(20.0, "f f f")
    scene.dcm(-7.0, 0.0, 0.0, 6.0)
    scene.dcm(7.0, 0.0, 0.0, 6.0)
    result = lmp(
        scene.head() + scene.forces() + "neighbor 1.0 multi\ngroup mother molecule 1\n"
        + f"fix grow mother dcm/growth {scene.map} seed 1 cycle_time 10 newborn 460 rounding 0 1\n"
        + "fix divide mother dcm/division seed 1\n" + load("pressure 0.01", "mother")
        + scene.motion() + "compute c all dcm/cell area molecule\n"
        + scenes.thermo(["area=f_load[4]", "cells=f_divide[1]"]) + "timestep 1.0\nrun 15\n"
        + "compute f mother dcm/face area\ncompute sum mother reduce sum c_f\n"
        + "compute g all dcm/face area\ncompute all all reduce sum c_g\n"
        + scenes.thermo(["a=f_load[4]", "b=c_sum", "all=c_all", "cells=f_divide[1]"]) + "run 0\n"
    )  # fmt: skip
    row = result.thermo[-1]
    assert get(row, "cells") >= 1
    assert get(row, "a") == pytest.approx(get(row, "b"), rel=1e-12)
    assert 1.2 < get(row, "a") / get(result.thermo[0], "area")  # more surface than the mother had
    assert get(row, "a") < get(row, "all") - 300  # and none of the other cell


def test_a_value_that_is_no_number(lmp, scenes):
    scene = scenes.single_cell()
    for formula, message in (
        ("equal 1e300*1e300*(step>2)", "variable P gives the pressure .* at step 0; it must be"),
        ("atom 1e300*exp(800)*x", "variable P gives the pressure .* for atom .* at step 0"),
    ):
        extra = f"variable P {formula}\n" + load("pressure v_P")
        fails(lmp, whole(scene, extra=extra), "Fix dcm/traction: " + message)


def test_a_value_that_becomes_no_number(lmp, scenes):
    scene = scenes.single_cell()
    extra = "variable P equal exp(300*step)\n" + load("pressure 1e-9*v_P".replace("1e-9*", ""))
    extra = extra.replace("exp(300*step)", "1e-9*exp(300*step)*(step>2)")
    result = lmp.run(whole(scene, extra=extra) + "timestep 1e-6\nthermo 1\nrun 10\n")
    (error,) = lines_of_error(result)
    assert "Fix dcm/traction: variable P gives the pressure" in error
    assert [row["Step"] for row in result.thermo] == [0, 1, 2]


BAD = {
    # options, message
    "nothing": ("", "give 'pressure P', 'vector TX TY TZ' or both"),
    "no load": ("faces apical", "give 'pressure P', 'vector TX TY TZ' or both"),
    "word": ("pressure much", "pressure is 'much', expected a number"),
    "infinite": ("pressure inf", "pressure is 'inf', expected a number"),
    "missing value": ("pressure", "keyword pressure needs a value"),
    "two of three": ("vector 1 2", "keyword vector needs 3 values, got 2"),
    "word in a vector": ("vector 1 2 up", "vector z is 'up', expected a number"),
    "unknown keyword": ("pressure 1 stress 2", "unknown keyword stress.*known: .*vector"),
    "no name": ("pressure v_", "pressure is v_, must be a number, or v_NAME"),
    "no variable": ("pressure v_none", "pressure: there is no equal-style or atom-style"),
    "wrong style": ("vector 0 0 v_word", "vector z: there is no .* variable word"),
    "no region": ("pressure 1 region nowhere", "there is no region nowhere"),
    "region without": ("pressure 1 region", "keyword region needs a value"),
    "no surface": ("pressure 1 faces top", "faces must be lateral, .* junction or basal, not top"),
    "surface without": ("pressure 1 faces", "keyword faces needs a value"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_options(lmp, scenes, name):
    options, pattern = BAD[name]
    extra = "variable word string much\n" + load(options)
    fails(lmp, whole(scenes.single_cell(), extra=extra), "Fix dcm/traction: .*" + pattern)


def test_what_it_needs(lmp, scenes):
    scene = scenes.single_cell()
    fails(lmp, whole(scene, cell="", volume="", motion="", contact="", extra=load("pressure 1")),
          "Fix dcm/traction.* fix dcm/cell")  # fmt: skip
    atoms = "region box block 0 1 0 1 0 1\ncreate_box 1 box\nmass 1 1.0\n"
    fails(lmp, atoms + load("pressure 1"), "Fix dcm/traction.*atom_style dcm")
    nodes = "group nodes type 2\n" + load("pressure 1", "nodes")
    fails(lmp, whole(scene, extra=nodes), "Fix dcm/traction: group nodes holds .* but no face")
