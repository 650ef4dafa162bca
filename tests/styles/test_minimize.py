"""Energy minimization: which styles relax cells, to which state, and which are refused."""

import re

import numpy as np
import pytest

from support.bad_decks import fails, whole
from support.cycle_decks import same

COLUMNS = "id mol type xu yu zu vx vy vz fx fy fz"
K_V = 2.5  # of hepatoblast in the parameter file of the tests
FTOL = 1e-9  # nN, length of the vector of all forces
FRICTION = 1.0  # friction_ecm, nN s/um^3
KIND = "compute p all property/atom kind vertex1 vertex2 vertex3\n"
SHAPE = "id mol type xu yu zu vx vy vz fx fy fz c_p[1] c_p[2] c_p[3] c_p[4]"
MINIMIZE = "timestep 0.05\nmin_style fire\nminimize 0 {} {} 100000\n"


def relax(ftol=FTOL, steps=20000):
    return MINIMIZE.format(ftol, steps)


def one(scenes, boundary="f f f"):
    """A cell with prestress; head, fixes."""
    scene = scenes.single_cell(boundary=boundary, options="rotate 3 rest 0.9")
    fixes = "comm_modify cutoff 12\nfix cell all dcm/cell\n" + scene.volume()
    fixes += "compute of all dcm/cell volume pressure volume0 area\n" + KIND
    return scene, scene.head() + scene.cortex(), fixes


def two(scenes, contact="", boundary="f f f", gap=-1.0):
    """Two cells that overlap at the start."""
    scene = scenes.doublet(boundary=boundary, gap=gap)
    fixes = "fix cell all dcm/cell\n" + scene.volume() + KIND
    fixes += "compute of all dcm/cell volume pressure volume0 contact_area\n"
    return scene, scene.head() + scene.cortex() + scene.contact(contact), fixes


def cell_columns(scenes, file="cells.txt", every=1):
    return "group cells type 1 4\n" + scenes.dump(
        "id mol type c_of[1] c_of[2] c_of[3] c_of[4] xu yu zu", every, file, "cells"
    )


def last(result, file="cells.txt"):
    return result.dump(file)[-1]


# --- one cell -------------------------------------------------------------------------------------


def volume_of(frame):
    """Inside the mesh, and the sum of force times position, by atom IDs."""
    x = dict(zip(frame["id"].astype(int), frame.x, strict=True))
    faces = frame["c_p[1]"] == 4
    corners = frame.vectors("c_p[2]", "c_p[3]", "c_p[4]")[faces].astype(int)
    a, b, c = (np.array([x[v] for v in corners[:, k]]) for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


@pytest.fixture(scope="module")
def relaxed(lmp_module, scenes):
    """By fire on one rank, and by the motion of a long run."""
    scene, head, fixes = one(scenes)
    show = cell_columns(scenes, every=100000) + scenes.dump(SHAPE, 100000)
    fire = lmp_module(head + fixes + show + scenes.thermo(["fnorm"], 1000) + relax())
    motion = scene.motion(options="tolerance 1e-12") + "timestep 1.0\n"
    run = lmp_module(
        head + fixes + motion + scenes.dump(SHAPE, 800) + cell_columns(scenes, every=800)
        + "run 800\n"
    )  # fmt: skip
    return fire, run


def test_one_cell_as_after_a_long_run(relaxed):
    """Volume and pressure.

    The energy holds K_V/(2 V) dV^2, so forces that are left, of length F, leave the volume off by
    at most dV with K_V dV^2/V < F s, where s is how far they can move the nodes: s < F/k with k
    the softest stiffness of the mesh that is no rigid motion. Taken is k = 1e-6 nN/um, far below
    that of springs and hinges (k_s = 2.9, bending 0.05): dV < F sqrt(V/(K_V k)).
    """
    fire, run = relaxed
    p = {}
    for name, result in (("fire", fire), ("run", run)):
        frame = result.dump()[-1]
        force = np.linalg.norm(frame.f)
        assert force < 1e-7, name  # at rest
        cell = last(result)
        V, pressure, V0 = (cell[f"c_of[{k}]"][0] for k in (1, 2, 3))
        assert V == pytest.approx(volume_of(frame), rel=1e-11)  # faces have followed
        assert pressure == pytest.approx(-K_V * np.log(V / V0), rel=1e-10)
        p[name] = (V, pressure, force * np.sqrt(V / (K_V * 1e-6)))
    assert p["fire"][1] > 0.1  # the cortex presses
    assert np.linalg.norm(fire.dump()[0].f) > 1.0  # there was something to relax
    bound = p["fire"][2] + p["run"][2]
    assert bound < 1e-3 * p["run"][0]
    assert abs(p["fire"][0] - p["run"][0]) < bound
    assert abs(p["fire"][1] - p["run"][1]) < K_V / p["run"][0] * bound


def test_forces_in_balance_with_the_cortex(relaxed):
    """Springs and pressure at rest: sum over the edges of k l (l - l0) = 3 p V; hinges have none.

    (l0 = 0.9 of the length in the round cell, by icosphere; k = 2/sqrt3 E h.)
    """
    frame, cell = relaxed[0].dump()[-1], last(relaxed[0])
    start = relaxed[0].dump()[0]
    faces = frame["c_p[1]"] == 4
    corners = frame.vectors("c_p[2]", "c_p[3]", "c_p[4]")[faces].astype(int)
    edges = {tuple(sorted((f[k], f[(k + 1) % 3]))) for f in corners for k in range(3)}
    assert len(edges) == 120
    place = [dict(zip(f["id"].astype(int), f.x, strict=True)) for f in (start, frame)]
    rest, now = (
        np.array([np.linalg.norm(x[a] - x[b]) for a, b in sorted(edges)]) for x in place
    )
    k = 2 / 3**0.5 * 5.0 * 0.5
    virial = (k * now * (now - 0.9 * rest)).sum()
    V, p = cell["c_of[1]"][0], cell["c_of[2]"][0]
    # what is left of the forces moves the sum by at most |F| |x|
    left = np.linalg.norm(frame.f) * 6.0 * 42**0.5
    assert 3 * p * V == pytest.approx(virial, abs=left + 1e-9 * virial)


@pytest.mark.parametrize("style", ["fire", "quickmin"])
def test_run_after_it_starts_at_rest(lmp, scenes, style):
    """|v| < F/g: every node has at least the friction g of a third of its faces with the medium."""
    scene, head, fixes = one(scenes)
    deck = head + fixes + relax(1e-6).replace("fire", style) + scene.motion()
    deck += scenes.dump(SHAPE, 1) + "timestep 1.0\nrun 5\n"
    result = lmp(deck)
    first = result.dump()[0]
    faces = first["c_p[1]"] == 4
    corners = first.vectors("c_p[2]", "c_p[3]", "c_p[4]")[faces].astype(int)
    x = dict(zip(first["id"].astype(int), first.x, strict=True))
    a, b, c = (np.array([x[v] for v in corners[:, k]]) for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    around = dict.fromkeys(np.unique(corners), 0.0)
    for row, size in zip(corners, area, strict=True):
        for v in row:
            around[v] += size / 3
    for frame in result.dump():
        force = np.linalg.norm(frame.f)
        assert force < 1.01e-6
        assert np.linalg.norm(frame.v, axis=1).max() <= force / (FRICTION * min(around.values()))


@pytest.mark.parametrize("np_", [2, 3, 4])
def test_one_cell_on_ranks(lmp, scenes, relaxed, np_):
    """The first iterations to round-off; in the end the same state."""
    scene, head, fixes = one(scenes)
    few = relax(0, 40)
    show = scenes.dump(SHAPE, 20)
    a, b = (lmp(head + fixes + show + few, np=n).dump() for n in (1, np_))
    assert [f.step for f in a] == [f.step for f in b] == [0, 20, 40]
    assert np.abs(a[-1].x - a[0].x).max() > 0.05
    for p, q in zip(a, b, strict=True):
        same(p, q, "id mol type")
        assert np.abs(p.x - q.x).max() < 1e-10
    result = lmp(head + fixes + cell_columns(scenes, every=100000) + relax(), np=np_)
    expected, found = last(relaxed[0]), last(result)
    for k in (1, 2, 3, 4):
        assert found[f"c_of[{k}]"] == pytest.approx(expected[f"c_of[{k}]"], rel=1e-6), k


def test_cg_agrees_where_there_is_an_energy(lmp, scenes, relaxed):
    """Cortex, bending and pressure of one cell derive from an energy."""
    scene, head, fixes = one(scenes)
    deck = head + fixes + cell_columns(scenes, every=100000) + scenes.dump(SHAPE, 100000)
    result = lmp(deck + "min_style cg\nminimize 0 1e-7 20000 100000\n")
    assert np.linalg.norm(result.dump()[-1].f) < 1e-4  # where the energy has no digits left
    expected, found = last(relaxed[0]), last(result)
    for k in (1, 2):
        assert found[f"c_of[{k}]"] == pytest.approx(expected[f"c_of[{k}]"], rel=1e-4), k


def test_across_a_periodic_border(lmp, scenes, relaxed):
    """A cell that straddles the border comes to the same state."""
    scene = scenes.Scene(15.0, "p p p")
    scene.dcm(14.0, -13.0, 15.0, 6.0, options="rotate 3 rest 0.9")
    _, _, fixes = one(scenes)
    deck = scene.head() + scene.cortex() + fixes + cell_columns(scenes, every=100000) + relax()
    expected, found = last(relaxed[0]), last(lmp(deck, np=2))
    for k in (1, 2, 3, 4):
        assert found[f"c_of[{k}]"] == pytest.approx(expected[f"c_of[{k}]"], rel=1e-6), k


# --- cells in contact -----------------------------------------------------------------------------


# Contacts derive from no energy; their forces jump where a pair of faces comes into reach: below
# a few thousandths of the start's 14 nN the last of them fall slowly.
LEFT = 5e-3  # nN


def pressure_bound(frame, volume, radius=6.0):
    """What the forces that are left may move the pressure by.

    The virial of a cell, sum of f x = 3 p V less that of springs and contacts, is at most |f| |x|.
    """
    return np.linalg.norm(frame.f) * radius * (frame["type"] == 2).sum() ** 0.5 / (3 * volume)


@pytest.fixture(scope="module")
def pair_relaxed(lmp_module, scenes):
    """Two cells by fire, then the motion that is left; and the motion without fire."""
    scene, head, fixes = two(scenes)
    show = cell_columns(scenes, every=50) + scenes.dump(COLUMNS, 50)
    tail = scene.motion() + show + "timestep 1.0\nreset_timestep 0\nrun 50\n"
    return lmp_module(head + fixes + relax(LEFT, 5000) + tail), lmp_module(head + fixes + tail)


def test_two_cells_in_contact(pair_relaxed):
    """Forces, and with the same friction velocities, fall by more than a factor of a thousand."""
    fire, run = pair_relaxed
    a, b = fire.dump()
    start, later = run.dump()
    assert np.linalg.norm(start.f) > 10.0
    assert np.linalg.norm(a.f) < 1.01 * LEFT
    speed = [np.linalg.norm(frame.v, axis=1).max() for frame in (start, a)]
    assert speed[1] < 1e-3 * speed[0]
    assert np.abs(later.x - start.x).max() > 0.5
    assert np.abs(b.x - a.x).max() < 0.01
    cells = fire.dump("cells.txt")[0]
    assert (cells["c_of[4]"] > 10.0).all()  # contact area
    V, p, V0 = (cells[f"c_of[{k}]"] for k in (1, 2, 3))
    assert p == pytest.approx(-K_V * np.log(V / V0), rel=1e-10)
    # equal cells with equal meshes, though not mirror images
    assert p[0] == pytest.approx(p[1], rel=0.01)


def test_two_cells_come_where_a_long_run_comes(lmp, scenes, pair_relaxed):
    """Pressures of the two ways agree within what the forces left in each may make."""
    scene, head, fixes = two(scenes)
    deck = head + fixes + scene.motion(options="") + cell_columns(scenes, every=1500)
    run = lmp(deck + scenes.dump(COLUMNS, 1500) + "timestep 1.0\nrun 1500\n")
    found, expected = pair_relaxed[0].dump("cells.txt")[0], last(run)
    V = expected["c_of[1]"][0]
    bound = sum(pressure_bound(f, V) for f in (pair_relaxed[0].dump()[0], run.dump()[-1]))
    p = expected["c_of[2]"]
    assert bound < 0.1 * p[0]
    assert found["c_of[2]"] == pytest.approx(p, abs=bound)


@pytest.mark.parametrize("np_", [2, 3, 4])
def test_two_cells_on_ranks(lmp, scenes, pair_relaxed, np_):
    """The first iterations to round-off; in the end the same pressures."""
    scene, head, fixes = two(scenes)
    show = scenes.dump(COLUMNS, 20)
    a, b = (lmp(head + fixes + show + relax(0, 40), np=n).dump() for n in (1, np_))
    assert np.abs(a[-1].x - a[0].x).max() > 0.1
    for p, q in zip(a, b, strict=True):
        same(p, q, "id mol type")
        assert np.abs(p.x - q.x).max() < 1e-9
    show = cell_columns(scenes, every=100000) + scenes.dump(COLUMNS, 100000)
    result = lmp(head + fixes + show + relax(LEFT, 5000), np=np_)
    expected, found = pair_relaxed[0].dump("cells.txt")[0], last(result)
    assert np.linalg.norm(result.dump()[-1].f) < 1.01 * LEFT
    bound = 2 * pressure_bound(result.dump()[-1], found["c_of[1]"][0])
    assert found["c_of[2]"] == pytest.approx(expected["c_of[2]"], abs=bound)


def test_before_and_after_a_run(lmp, scenes):
    """run, minimize, run, minimize in one deck; nothing is lost, the second finds rest again."""
    scene, head, fixes = two(scenes, gap=-0.5)
    thermo = scenes.thermo(["atoms", "fnorm"], 100)
    deck = head + fixes + scene.motion() + thermo + "timestep 1.0\nrun 10\n" + relax(LEFT, 5000)
    deck += "run 10\ndisplace_atoms all random 0.05 0.05 0.05 4\n" + relax(LEFT, 5000) + "run 10\n"
    result = lmp(deck)
    norms = [(run[0]["Fnorm"], run[-1]["Fnorm"]) for run in result.runs]
    assert len(norms) == 5
    assert norms[0][0] > 1.0 and norms[1][1] < 1.01 * LEFT and norms[3][1] < 1.01 * LEFT
    assert norms[2][1] < 1.5 * LEFT and norms[4][1] < 1.5 * LEFT  # it stays at rest
    assert norms[3][0] > 100 * LEFT  # there was something to do
    assert {row["Atoms"] for row in result.thermo} == {246}


@pytest.mark.parametrize("np_", [1, 2])
def test_after_read_restart(lmp, scenes, np_):
    """The minimization of a restarted deck goes the way of that without restart."""
    scene, head, fixes = two(scenes)
    show = scenes.dump(COLUMNS, 50)
    grid = "processors * 1 1\n"
    first = lmp(grid + head + fixes + scene.motion() + "timestep 1.0\nrestart 10 r.*\nrun 10\n"
                + "reset_timestep 50\n" + show + relax(0, 50), np=np_)  # fmt: skip
    coeff = f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
    again = lmp(grid + "read_restart r.10\n" + coeff + fixes + scene.motion() + "timestep 1.0\n"
                + "reset_timestep 50\n" + show + relax(0, 50), np=np_,
                files={"r.10": first.path / "r.10"})  # fmt: skip
    a, b = first.dump(), again.dump()
    assert [f.step for f in a] == [f.step for f in b] == [50, 100]
    assert np.abs(a[1].x - a[0].x).max() > 0.05
    assert np.abs(a[0].x - b[0].x).max() == 0.0
    assert np.abs(a[1].x - b[1].x).max() < 1e-10


def test_confine_takes_part(lmp, scenes):
    """A plane at z = 0.7 draws the cell there: K (z - 0.7) is what is left of the forces."""
    scene, head, fixes = one(scenes)
    deck = head + fixes + "fix plane all dcm/confine plane z 2.0 at 0.7\n"
    deck += scenes.dump(COLUMNS, 100000) + relax(1e-6)
    a, b = (frame for frame in lmp(deck).dump())
    nodes = a["type"] == 2
    assert abs(a.x[nodes].mean(axis=0)[2]) < 1e-9
    left = np.linalg.norm(b.f)
    assert left < 1.01e-6
    assert b.x[nodes].mean(axis=0) == pytest.approx([0, 0, 0.7], abs=1e-9 + 42**0.5 * left / 2.0)


def test_setforce_holds_nodes(lmp, scenes):
    scene, head, fixes = one(scenes)
    deck = head + fixes + "variable left atom x<-3\ngroup nodes type 2\ngroup left variable left\n"
    deck += "group held intersect nodes left\nfix hold held setforce 0 0 0\n"
    deck += scenes.dump(COLUMNS, 100000) + relax(1e-6)
    a, b = lmp(deck).dump()
    nodes = a["type"] == 2
    held = nodes & (a.x[:, 0] < -3)
    assert 0 < held.sum() < nodes.sum() / 2
    assert np.array_equal(a.x[held], b.x[held])
    assert np.abs(b.x[nodes & ~held] - a.x[nodes & ~held]).max() > 0.1


def test_growth_and_motility_rest(lmp, scenes):
    """A minimization is no time: nothing grows and nobody walks, or it would never end."""
    scene, head, fixes = one(scenes)
    deck = head + fixes + f"fix growth all dcm/growth {scene.map} seed 3 cycle_time 1000\n"
    deck += scene.motility(options="D 1e-2") + scene.motion() + cell_columns(scenes, every=100000)
    result = lmp(deck + scenes.thermo(["fnorm"], 100000) + relax(1e-6))
    first, end = result.dump("cells.txt")[0], last(result)
    assert end.step > first.step
    assert end["c_of[3]"][0] == first["c_of[3]"][0]
    assert result.thermo[-1]["Fnorm"] < 1.01e-6


# --- what is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize("style", ["cg", "sd", "hftn"])
def test_line_searches_are_refused_with_contact(lmp, scenes, style):
    run = f"min_style {style}\nminimize 0 1e-6 10 10\n"
    fails(lmp, whole(scenes.doublet()), f"Fix dcm/cell: min_style {style} follows the energy",
          "use 'min_style fire'", run=run)  # fmt: skip


def test_box_relax_is_refused_with_contact(lmp, scenes):
    deck = whole(scenes.doublet(boundary="p p p"), extra="fix box all box/relax iso 0.0\n")
    fails(lmp, deck, "Fix dcm/cell: min_style cg follows the energy",
          run="min_style cg\nminimize 0 1e-6 10 10\n")  # fmt: skip
    fails(lmp, deck, "box/relax", run="min_style fire\nminimize 0 1e-6 10 10\n")  # by LAMMPS


@pytest.mark.parametrize("dt", [2, 5])
def test_too_large_a_timestep(lmp, scenes, dt):
    """LAMMPS' damped styles bound the way of an atom, but not in the first iteration."""
    deck = whole(scenes.doublet(gap=-1.0), extra=f"timestep {dt}\n")
    result = lmp.run(deck + "min_style fire\nminimize 0 1e-6 10 10\n")
    grown = "Pair style dcm/contact: the face .* has grown .* minimize with a smaller timestep than"
    inverted = "Fix dcm/cell: cell . has volume -.* at step .*a time step too large"
    assert result.returncode != 0
    assert re.search(f"{grown}|{inverted}", result.error), result.tail()


def test_spheres_have_an_energy(lmp, scenes):
    """cg relaxes spheres, to where the JKR force of the pair is zero, as fire does."""
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(-4.7, 0.1, 0.0, 5.0)
    scene.cbm(4.7, 0.0, 0.0, 5.0)
    found = []
    for style in ("cg", "fire"):
        deck = scene.head() + scene.contact() + scenes.dump("id x y z fx fy fz", 100000)
        deck += f"min_style {style}\nminimize 0 1e-6 1000 10000\n"
        last_frame = lmp(deck).dump()[-1]
        assert np.abs(last_frame.vectors("fx", "fy", "fz")).max() < 1e-4
        found.append(np.linalg.norm(np.diff(last_frame.x, axis=0)))
    # contact radius a at zero force: a^3 = (9 pi/2) W R^2/E*... from 4 E a^3/(3 R) =
    # sqrt(8 pi W E a^3), and the overlap a^2/R - sqrt(2 pi W a/E)
    E, R, W = 0.45 / (2 * (1 - 0.4**2)), 2.5, 0.1
    a = (8 * np.pi * W * E * (3 * R / (4 * E)) ** 2) ** (1 / 3)
    overlap = a**2 / R - np.sqrt(2 * np.pi * W * a / E)
    assert overlap > 0
    for distance in found:
        assert distance == pytest.approx(10 - overlap, abs=1e-3)
