"""fix dcm/tension: force, energy, Laplace's law, values by type and region, ranks, restart."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from support.bad_decks import fails, lines_of_error, whole
from support.parameters import CONTACT, CORTEX, FRICTION, adhesion, cell_type

DECK = Path(__file__).resolve().parents[2] / "examples" / "tension" / "in.tension"
REGIONS = ("lateral", "polar", "apical", "junction", "basal")
BARE = "bond_style zero nocoeff\nbond_coeff *\ndihedral_style zero nocoeff\ndihedral_coeff *\n"
COLUMNS = "id mol type xu yu zu vx vy vz fx fy fz"
LIST = "comm_modify cutoff 12\n"
CELL = "fix cell all dcm/cell\n"
POLARITY = "fix pol all dcm/polarity seed 3 init toward 3 30 8 junction 0.2 0.7 basal 0.6\n"
ACTING = {"lateral": 0.2, "polar": 0.3, "apical": 0.5, "junction": 0.7, "basal": 0.1}


def tension(scene, options="tension 0.2", group="all", id="ten"):
    return f"fix {id} {group} dcm/tension {scene.map} {options}\n"


def by_region(values=ACTING):
    return " ".join(f"tension:{region} {T}" for region, T in values.items())


def energies(extra=()):
    return [*(f"{r}=f_ten[{n}]" for n, r in enumerate(REGIONS, 1)), "all=f_ten", *extra]


def get(row, name):
    return row["v_" + name]


def bare(scenes, level=1, boundary="s s s", options="rotate 3 rest 0.95", **scene_options):
    """A cell of volume pressure alone; nothing else but what the tests add."""
    scene = scenes.single_cell(level=level, boundary=boundary, options=options, **scene_options)
    return scene, scene.head() + BARE + LIST + CELL + scene.volume()


def triangles(x, faces):
    return (x[faces[:, k]] for k in range(3))


def areas_of(x, faces):
    a, b, c = triangles(x, faces)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def tension_force(x, faces, T):
    """-T grad A: half of each side, turned inward in the plane of the face."""
    a, b, c = triangles(x, faces)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    f = np.zeros_like(x)
    for k, side in enumerate((c - b, a - c, b - a)):
        np.add.at(f, faces[:, k], -0.5 * np.asarray(T)[..., None] * np.cross(normal, side))
    return f


# --- force and energy -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def mesh(scenes):
    nodes, faces = scenes.icosphere(1)
    return faces, {"cell.off": scenes.off(nodes, faces)}


def perturbed(scenes):
    scene = scenes.Scene(20.0, "p p p")
    scene.dcm(19.0, 2.0, 3.0, 6.0, mesh=("cell.off", 42, 80), options="scale nodes rest 0.95")
    return scene, scene.head() + BARE + (
        "group nodes type 2\ndisplace_atoms nodes random 0.4 0.4 0.4 4711 units box\n" + LIST + CELL
    )


def test_force_energy_and_regions(lmp, scenes, mesh):
    """Against the formulas, each face with the tension of its region; across a periodic border."""
    faces, files = mesh
    scene, deck = perturbed(scenes)
    result = lmp(
        deck.replace(LIST, "") + scene.contact() + POLARITY + tension(scene, by_region())
        + "compute face all dcm/face area region\ncompute e all pe/atom fix\n"
        + "compute sum all reduce sum c_e\n"
        + scenes.dump("id type xu yu zu fx fy fz c_face[1] c_face[2] c_e")
        + scenes.thermo(["pe", *energies(["peratom=c_sum"])]) + "run 0\n",
        files=files,
    )  # fmt: skip
    frame, row = result.dump()[0], result.thermo[0]
    nodes, face = frame["type"] == 2, frame["type"] == 3
    region = frame["c_face[2]"][face].astype(int)
    assert set(region) == {0, 1, 2, 3, 4}
    T = np.array(list(ACTING.values()))[region]
    x = frame.x[nodes]
    force = tension_force(x, faces, T)
    scale = np.abs(force).max()
    assert np.abs(frame.f[nodes] - force).max() < 1e-13 * scale
    assert np.abs(frame.f[nodes].sum(axis=0)).max() < 1e-13 * scale
    assert np.abs(np.cross(x, frame.f[nodes]).sum(axis=0)).max() < 1e-12 * scale
    energy = T * areas_of(x, faces)
    for n, name in enumerate(REGIONS):
        assert get(row, name) == pytest.approx(energy[region == n].sum(), rel=1e-13)
    for total in (get(row, "all"), row["PotEng"], get(row, "peratom")):
        assert total == pytest.approx(energy.sum(), rel=1e-13)
    assert np.abs(frame["c_e"][face] - energy).max() < 1e-13 * energy.max()
    assert (frame["c_e"][~face] == 0.0).all()


def test_force_is_minus_gradient_of_energy(lmp, scenes, mesh):
    h, nodes = 1e-4, [2, 17, 43]
    scene, deck = perturbed(scenes)
    deck += tension(scene) + scenes.thermo(["pe"]) + scenes.dump("id xu yu zu fx fy fz")
    deck += "run 0\nundump dump.txt\nneigh_modify delay 0 every 1 check no\n"
    for node in nodes:
        deck += f"group one id {node}\n"
        for axis in range(3):
            for k, then in ((1, "run 0\n"), (-2, "run 0\n"), (1, "")):
                step = " ".join(map(repr, (k * h * np.eye(3)[axis]).tolist()))
                deck += f"displace_atoms one move {step} units box\n" + then
        deck += "group one delete\n"
    result = lmp(deck, files=mesh[1])
    frame = result.dump()[0]
    pe = [run[0]["PotEng"] for run in result.runs[1:]]
    numerical = -(np.array(pe[0::2]) - np.array(pe[1::2])) / (2 * h)
    exact = np.array([frame.f[frame["id"] == node][0] for node in nodes]).ravel()
    assert np.abs(numerical - exact).max() < 1e-7 * np.abs(exact).max()


def test_virial(lmp, scenes, mesh):
    """-dE/dV in each direction by a box that is scaled; the trace is -2 T A."""
    h = 1e-5
    scene, deck = perturbed(scenes)
    deck += tension(scene) + "compute p all pressure NULL fix\ncompute a all stress/atom NULL fix\n"
    deck += "compute s all reduce sum c_a[*]\n"
    deck += scenes.thermo(["pe", "vol", *(f"p{k}=c_p[{k}]" for k in range(1, 7)),
                           *(f"s{k}=-c_s[{k}]/vol" for k in range(1, 7))]) + "run 0\n"  # fmt: skip
    for axis in "xyz":
        for factor in (1 + h, (1 - h) / (1 + h), 1 / (1 - h)):
            deck += f"change_box all {axis} scale {factor!r} remap\nrun 0\n"
    runs = [run[0] for run in lmp(deck, files=mesh[1]).runs]
    first = runs[0]
    p = [get(first, f"p{k}") for k in range(1, 7)]
    assert sum(p[:3]) * first["Volume"] == pytest.approx(-2 * first["PotEng"], rel=1e-12)
    for k in range(3):
        up, down = runs[1 + 3 * k], runs[2 + 3 * k]
        numerical = -(up["PotEng"] - down["PotEng"]) / (up["Volume"] - down["Volume"])
        assert p[k] == pytest.approx(numerical, rel=1e-6)
    for k in range(6):
        assert get(first, f"s{k + 1}") == pytest.approx(p[k], rel=1e-12, abs=1e-14)


def test_energy_is_work(lmp, scenes):
    """What tension and pressure lose on the way is the work of the forces, to second order."""
    scene, deck = bare(scenes, options="scale nodes rest 1")
    errors = []
    for dt in (0.2, 0.1):
        result = lmp(
            deck + "group nodes type 2\ndisplace_atoms nodes random 0.4 0.4 0.4 4711 units box\n"
            + tension(scene, "tension 0.5") + scene.motion()
            + scenes.dump("id xu yu zu fx fy fz", group="nodes")
            + scenes.thermo(["E=f_ten+f_volume"]) + f"timestep {dt}\nrun {round(4 / dt)}\n"
        )  # fmt: skip
        E = np.array([get(row, "E") for row in result.thermo])
        frames = result.dump()
        work = sum((0.5 * (a.f + b.f) * (b.x - a.x)).sum() for a, b in zip(frames, frames[1:]))
        assert (np.diff(E) < 0.0).all() and E[0] - E[-1] > 1.0
        errors.append(abs(work / (E[0] - E[-1]) - 1))
    assert errors[0] < 0.01
    assert 3.0 < errors[0] / errors[1] < 5.0


# --- Laplace --------------------------------------------------------------------------------------


def laplace(scenes, level, dt, seconds, T=0.2):
    scene, deck = bare(scenes, level=level, options="rotate 3 rest 1")
    return (
        deck + tension(scene, f"tension {T}") + scene.motion(options="tolerance 1e-10")
        + "compute c all dcm/cell volume area\n"
        + "variable fx atom fx*x+fy*y+fz*z\ncompute virial all reduce sum v_fx\n"
        + scenes.thermo(["p=f_volume[1]", "V=C_c[1][1]", "A=C_c[1][2]", "E=f_ten", "rF=c_virial"],
                        10**6)
        + f"timestep {dt}\nrun {round(seconds / dt)}\n"
    )  # fmt: skip


def test_laplace_law(lmp, scenes):
    """p = 2T/R at rest, R of the volume, to second order in the edge; p 3V - 2TA = sum of r.F."""
    T, errors = 0.2, []
    for level, dt in ((1, 1.0), (2, 1.0), (3, 0.5)):
        row = lmp(laplace(scenes, level, dt, 100)).thermo[-1]
        p, V, A = (get(row, k) for k in ("p", "V", "A"))
        assert get(row, "E") == pytest.approx(T * A, rel=1e-13)
        assert abs(get(row, "rF")) < 1e-4 * T * A  # nearly at rest
        assert 3 * p * V - get(row, "rF") == pytest.approx(2 * T * A, rel=1e-11)
        errors.append(p * math.cbrt(0.75 * V / math.pi) / (2 * T) - 1)
    assert errors[1] < 0.005  # 162 nodes
    orders = -np.diff(np.log2(errors))
    assert orders == pytest.approx([2.0, 2.0], abs=0.1)


def test_springs_beside_it(lmp, scenes):
    """At rest the pressure carries springs and surface tension together."""
    scene = scenes.single_cell(level=1, boundary="p p p")
    row = lmp(
        scene.head() + scene.cortex() + LIST + CELL + scene.volume() + tension(scene)
        + scene.motion() + "compute e all pressure NULL bond\ncompute c all dcm/cell volume\n"
        + scenes.thermo(["p=f_volume[1]", "edges=c_e*vol", "V=C_c[1]", "E=f_ten"], 1000)
        + "timestep 1.0\nrun 1000\n"
    ).thermo[-1]  # fmt: skip
    springs = -get(row, "edges") / get(row, "V")
    area = 2 * get(row, "E") / (3 * get(row, "V"))
    assert min(springs, area) > 0.01
    assert get(row, "p") == pytest.approx(springs + area, rel=1e-9)


def test_minimize(lmp, scenes):
    """An ellipsoid becomes round; energy and force belong together or this would not end."""
    scene, deck = bare(scenes, boundary="f f f", options="rotate 3 rest 1")
    result = lmp(
        deck + "group nodes type 2\ndisplace_atoms nodes ramp x -1.5 1.5 x -6 6 units box\n"
        + tension(scene) + "compute c all dcm/cell volume area\n"
        + scenes.thermo(["pe", "p=f_volume[1]", "V=C_c[1][1]", "A=C_c[1][2]"], 10**6)
        + "timestep 0.05\nmin_style fire\nminimize 0 1e-9 20000 100000\n"
    )  # fmt: skip
    first, last = result.thermo[0], result.thermo[-1]
    p, V, A = (get(last, k) for k in ("p", "V", "A"))
    assert last["PotEng"] < first["PotEng"]
    assert p == pytest.approx(2 * 0.2 * A / (3 * V), rel=1e-7)
    sphericity = A / (36 * math.pi * V**2) ** (1 / 3)
    assert sphericity < 1.04  # 1.039 of an icosphere of 42 nodes; 1.057 at the start


# --- two cells that adhere ------------------------------------------------------------------------


def test_doublet_deck(lmp):
    """Early on: the angle opens toward that of Young and Dupre, measured in two ways."""
    result = lmp("variable settle index 200\nvariable dt index 1.0\n" + DECK.read_text())
    text = result.out
    expected, shape, area = (
        float(re.search(pattern + r": +([\d.]+) degrees", text)[1])
        for pattern in ("Young and Dupre", "length and volume", "area in contact")
    )
    assert expected == pytest.approx(math.degrees(math.acos(0.7)), abs=0.01)
    assert 10.0 < shape < expected and 20.0 < area < expected


def test_doublet_without_springs(lmp):
    """Nothing holds the mesh in a contact: the run ends with an error, as the page says."""
    result = lmp.run("variable settle index 200\nvariable springs index 0\n" + DECK.read_text())
    assert "has grown to radius" in result.out and result.returncode != 0
    assert "the mesh loses its order" in result.out


# --- where the values come from -------------------------------------------------------------------

OWN = "own.dcm"


def parameter_file(**values):
    lines = {k.replace("_", ":"): v for k, v in values.items()}
    return {
        OWN: cell_type("hepatoblast", **CORTEX, **CONTACT, **FRICTION, **lines)
        + cell_type("hepatoblast_cbm", **CONTACT, **FRICTION)
        + adhesion(0.1)
    }


ORDER = {
    # parameter file, deck: tension of lateral faces, of apical faces
    "file": (dict(tension=0.2), "", 0.2, 0.2),
    "region of the file": (dict(tension=0.2, tension_apical=0.5), "", 0.2, 0.5),
    "every region": ({f"tension_{r}": T for r, T in ACTING.items()}, "", 0.2, 0.5),
    "deck": (dict(tension=0.2, tension_apical=0.5), "tension 0.3", 0.3, 0.3),
    "region of the deck": (dict(tension=0.2), "tension:apical 0.4", 0.2, 0.4),
    "both": (dict(tension_apical=0.5), "tension:apical 0.4 tension 0.3", 0.3, 0.4),
    "variables": (dict(), "tension v_T tension:apical v_U", 0.25, 0.35),
    "none of it": (dict(), "tension 0.2 tension:apical 0", 0.2, 0.0),
}  # fmt: skip


@pytest.mark.parametrize("once", [True, False])
@pytest.mark.parametrize("name", ORDER)
def test_which_value_counts(lmp, scenes, name, once):
    values, options, lateral, apical = ORDER[name]
    scene = scenes.single_cell()
    scene.parameters = OWN
    types = f"types {scene.map}" if once else ""
    result = lmp(
        scene.head() + BARE + scene.contact(coeff="W 0.1")
        + "variable T equal 0.25\nvariable U equal 0.35\n"
        + f"fix cell all dcm/cell {types}\n" + POLARITY
        + f"fix ten all dcm/tension {'' if once else scene.map} {options}\n"
        + "compute face all dcm/face area region\n"
        + "variable l atom c_face[1]*(c_face[2]==0)\nvariable a atom c_face[1]*(c_face[2]==2)\n"
        + "compute A all reduce sum v_l v_a\n"
        + scenes.thermo(["A=c_A[1]", "B=c_A[2]", *energies()]) + "run 0\n",
        files=parameter_file(**values),
    )  # fmt: skip
    row = result.thermo[0]
    assert min(get(row, "A"), get(row, "B")) > 10.0
    assert get(row, "lateral") == pytest.approx(lateral * get(row, "A"), rel=1e-12)
    assert get(row, "apical") == pytest.approx(apical * get(row, "B"), rel=1e-12)


def test_types_and_groups(lmp, scenes):
    """NULL and cells outside of the group have none; tensions of two fixes add."""
    scene = scenes.Scene((40.0, 20.0, 20.0), level=1)
    for n in range(3):
        scene.dcm(-20.0 + 20.0 * n, 0.0, 0.0, 6.0)
    scene.cbm(0.0, 15.0, 0.0, 4.0)
    deck = (
        scene.head() + BARE + LIST + "set mol 2 type/fraction 4 0 1\ngroup two molecule 1 2\n"
        + "group first molecule 1\n" + CELL
        + tension(scene, "tension 0.2", "two") + tension(scene, "tension 0.1", "first", "more")
        + scenes.thermo(["a=f_ten", "b=f_more", "pe"]) + "run 0\n"
    )  # fmt: skip
    row = lmp(deck).thermo[0]
    assert get(row, "a") == pytest.approx(4 * get(row, "b"), rel=1e-12)
    assert row["PotEng"] == pytest.approx(get(row, "a") + get(row, "b"), rel=1e-13)
    scene.NAMES = "NULL hepatoblast hepatoblast hepatoblast_cbm"
    without = deck.replace(tension(scenes.single_cell(), "tension 0.2", "two"), tension(scene))
    fails(lmp, without, "Fix dcm/tension: no deformable cell has its center in group all and a")


def test_a_variable_in_time(lmp, scenes):
    scene, deck = bare(scenes)
    rows = lmp(
        deck + "variable T equal 0.1+0.01*step\n" + tension(scene, "tension v_T")
        + scene.motion() + "compute c all dcm/cell area\n"
        + scenes.thermo(["E=f_ten", "A=C_c[1]"]) + "timestep 1.0\nrun 10\n"
    ).thermo  # fmt: skip
    for row in rows:
        T = 0.1 + 0.01 * row["Step"]
        assert get(row, "E") == pytest.approx(T * get(row, "A"), rel=1e-12)


@pytest.mark.parametrize("np_", [1, 2])
def test_a_variable_in_space(lmp, scenes, mesh, np_):
    """Evaluated at the face atoms, where they are; of one region and of all others."""
    faces, files = mesh
    scene, deck = perturbed(scenes)
    result = lmp(
        deck.replace(LIST, "") + scene.contact() + POLARITY
        + "variable T atom 0.2+0.01*y\nvariable U equal 0.4\n"
        + tension(scene, "tension v_T tension:apical v_U") + "compute r all dcm/face region\n"
        + scenes.dump("id type xu yu zu y fx fy fz c_r") + scenes.thermo(energies()) + "run 0\n",
        files=files, np=np_,
    )  # fmt: skip
    frame, row = result.dump()[0], result.thermo[0]
    nodes, face = frame["type"] == 2, frame["type"] == 3
    x, region = frame.x[nodes], frame["c_r"][face]
    T = np.where(region == 2, 0.4, 0.2 + 0.01 * frame["y"][face])
    force = tension_force(x, faces, T)
    assert np.abs(frame.f[nodes] - force).max() < 1e-13 * np.abs(force).max()
    assert get(row, "all") == pytest.approx((T * areas_of(x, faces)).sum(), rel=1e-13)


# --- ranks and restart ----------------------------------------------------------------------------


def doublet(scenes, boundary):
    """Two adhering cells whose surface tension differs by region: springs have to hold that."""
    scene = scenes.doublet(level=1, boundary=boundary, gap=-0.4, box=(27.0, 14.0, 14.0))
    shift = "displace_atoms all move 26 13 13\n" if boundary == "p p p" else ""
    fixes = (
        CELL + scene.volume() + POLARITY + "variable T equal 0.3+0.001*step\n"
        + tension(scene, "tension 0.2 tension:apical 0.4 tension:junction v_T")
        + scene.motion() + "compute region all dcm/face region\n"
        + "timestep 1.0\ncompute v all pressure NULL virial\ncompute e all pe/atom fix\n"
    )  # fmt: skip
    virial = [f"w{k}=c_v[{k}]" for k in range(1, 7)]
    output = scenes.dump(COLUMNS + " c_region c_e", 10)
    return scene, shift, fixes + output + scenes.thermo(["pe", *virial, *energies()], 10)


@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_1_2_3_and_4_ranks_agree(lmp, scenes, boundary):
    scene, shift, fixes = doublet(scenes, boundary)
    deck = scene.head() + shift + scene.cortex() + scene.contact() + fixes + "run 60\n"
    one = lmp(deck)
    frames = one.dump()
    assert {0, 1, 2, 3, 4} == set(frames[-1]["c_region"][frames[-1]["type"] == 3])
    assert np.abs(frames[-1].x - frames[0].x).max() > 0.1
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_)
        for a, b in zip(frames, other.dump(), strict=True):
            assert (a["id"] == b["id"]).all() and (a["c_region"] == b["c_region"]).all()
            assert np.abs(a.x - b.x).max() < 1e-9
            assert np.abs(a["c_e"] - b["c_e"]).max() < 1e-9
        for a, b in zip(one.thermo, other.thermo, strict=True):
            for key in a:
                assert b[key] == pytest.approx(a[key], rel=1e-8, abs=1e-11), (np_, key)


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
        np=np_,
        files={"r.30": whole_run.path / "r.30"},
    )  # fmt: skip
    for a, b in zip(whole_run.dump()[3:], rest.dump(), strict=True):
        assert a.step == b.step
        for name in a.names:
            assert (a[name] == b[name]).all(), (a.step, name)
    for a, b in zip(whole_run.thermo[3:], rest.thermo, strict=True):
        assert {k: (a[k], b[k]) for k in a if a[k] != b[k]} == {}


# --- hard cases -----------------------------------------------------------------------------------


def test_triangles_without_area(lmp, scenes):
    """Two faces whose corners coincide have no force, and the others have theirs."""
    scene, deck = bare(scenes)
    result = lmp(
        deck.replace(scene.volume(), "") + tension(scene)
        + "compute p all property/atom vertex1 vertex2 vertex3\n"
        + scenes.dump("id type xu yu zu fx fy fz c_p[1] c_p[2] c_p[3]")
        + scenes.thermo(["pe"]) + "run 0\n"
        + "set atom 14 x $(x[2]:%.17g) y $(y[2]:%.17g) z $(z[2]:%.17g)\nrun 1 pre no\n"
    )  # fmt: skip
    assert result.dump()[0].step == 0
    last = result.dump()[-1]
    nodes, face = last["type"] == 2, last["type"] == 3
    faces = last.vectors("c_p[1]", "c_p[2]", "c_p[3]")[face].astype(int) - 2
    x = last.x[nodes]
    area = areas_of(x, faces)
    assert (area == 0.0).sum() == 2
    assert np.isfinite(last.f).all()
    kept = faces[area > 0.0]
    force = tension_force(x, kept, np.full(len(kept), 0.2))
    assert np.abs(last.f[nodes] - force).max() < 1e-13 * np.abs(force).max()
    assert result.thermo[-1]["PotEng"] == pytest.approx(0.2 * area.sum(), rel=1e-13)


def test_huge_tension(lmp, scenes):
    scene, deck = bare(scenes)
    deck += tension(scene, "tension 1e6") + scene.motion()
    fails(lmp, deck, "Fix dcm/motion: .*cell 1.*maxmove")


def test_a_tension_that_becomes_negative(lmp, scenes):
    scene, deck = bare(scenes)
    result = lmp.run(
        deck + "variable T equal 0.125-0.0625*step\n"
        + tension(scene, "tension:basal 0.1 tension v_T")
        + scene.motion() + scenes.thermo(["pe"]) + "timestep 1.0\nrun 10\n"
    )  # fmt: skip
    (error,) = lines_of_error(result)
    assert "Fix dcm/tension: variable T gives the tension -0.0625 at step 3; it must be" in error
    assert [row["Step"] for row in result.thermo] == [0, 1, 2]


BAD = {
    # options, message
    "negative": ("tension -0.1", "tension is -0.1, must be zero or positive"),
    "negative region": ("tension 0.1 tension:basal -1", "tension:basal is -1, must be zero or pos"),
    "word": ("tension much", "tension is 'much', expected a number"),
    "infinite": ("tension inf", "tension is 'inf', expected a number"),
    "missing value": ("tension", "tension"),
    "unknown region": ("tension 0.1 tension:top 0.2", "unknown keyword tension:top.*tension:api"),
    "unknown keyword": ("tension 0.1 stress 0.2", "unknown keyword stress"),
    "no value": ("", "no value of tension for cell type hepatoblast; add it to"),
    "some regions": ("tension:apical 0.1", "no value of tension for cell type hepatoblast"),
    "variable": ("tension v_", "tension is v_, must be a number, or v_NAME of an equal-style"),
    "no variable": ("tension v_none", "there is no equal-style or atom-style variable none"),
    "wrong style": ("tension v_word", "there is no equal-style or atom-style variable word"),
    "atom style": ("tension v_atomic", "variable atomic gives the tension -.* at step 0; it must"),
    "not a number": ("tension v_nan", "variable nan gives the tension .* at step 0; it must be"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_options(lmp, scenes, name):
    options, pattern = BAD[name]
    scene = scenes.single_cell()
    extra = "variable word string x\nvariable atomic atom -1-x*x\n"
    extra += "variable nan equal 1e300*1e300\n" + tension(scene, options)
    fails(lmp, whole(scene, extra=extra), "Fix dcm/tension: .*" + pattern)


def test_bad_parameter_file(lmp, scenes):
    scene = scenes.single_cell()
    scene.parameters = OWN
    for values, pattern in (
        (dict(tension=-0.1), "tension of cell type hepatoblast is -0.1, must be zero or positive"),
        (dict(tension=0.1, tension_basal=-1), "tension:basal of cell type hepatoblast is -1"),
        (dict(tension_top=0.1), "tension:top 0.1': expected .*known keywords: .*tension:basal"),
    ):
        extra = tension(scene, "")
        fails(lmp, whole(scene, extra=extra), pattern, files=parameter_file(**values))


def test_what_it_needs(lmp, scenes):
    scene = scenes.single_cell()
    fails(lmp, whole(scene, cell="", volume="", motion="", contact="", extra=tension(scene)),
          "Fix dcm/tension.* fix dcm/cell")  # fmt: skip
    atoms = "region box block 0 1 0 1 0 1\ncreate_box 1 box\nmass 1 1.0\n"
    fails(lmp, atoms + "fix ten all dcm/tension tension 0.1\n",
          "Fix dcm/tension.*atom_style dcm")  # fmt: skip
    empty = whole(scene, extra="group none empty\n" + tension(scene, group="none"))
    fails(lmp, empty, "Fix dcm/tension: no deformable cell has its center in group none")


def test_large_steps_of_the_implicit_scheme(lmp, scenes):
    """A cell of tension and pressure alone comes to the same rest in steps of 100 s, thirty times
    what the explicit scheme stands, but for how far its nodes have drifted within the surface."""
    found = []
    for options, dt, steps in (("", 1.0, 3000), ("scheme implicit", 100.0, 30)):
        scene, start = bare(scenes, level=2)
        result = lmp(start + tension(scene) + scene.motion(options=f"tolerance 1e-10 {options}")
                     + scenes.thermo(["p=f_volume[1]"], steps) + f"timestep {dt}\nrun {steps}\n")
        found.append(get(result.thermo[-1], "p"))
    assert found[1] == pytest.approx(found[0], rel=1e-3)
