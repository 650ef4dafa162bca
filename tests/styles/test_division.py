"""Division of cells: daughters, their place, planes, ranks, restart files, books.

A cell of radius 6 um with a cycle of 100 s divides at step 100 (dt 1 s).
"""

import re

import numpy as np
import pytest

from support.data_files import section
from support.divisions import (
    NODE,
    PERIOD,
    Cell,
    balanced,
    deck,
    fixes,
    frame_at,
    frames_of,
    molecules,
    output,
    read_log,
    scene_of,
)

# --- one division ---------------------------------------------------------------------------------


@pytest.fixture(scope="module", params=[1, 2])
def alone(request, lmp_module, scenes):
    """One cell that divides, every step dumped: (result, mother when it divides, daughters)."""
    scene = scene_of(scenes, 15.0, level=request.param)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    result = lmp_module(deck(scene, scenes, PERIOD + 50))
    mother = Cell(frame_at(result, PERIOD - 1), 1, at=1.0)  # moved on before it divides
    frame = frame_at(result, PERIOD)
    assert molecules(frame) == [2, 3]
    return result, mother, [Cell(frame, n) for n in (2, 3)]


def test_volumes(alone):
    result, mother, daughters = alone
    (row,) = read_log(result.path)
    assert (row["step"], row["mother"], row["daughters"]) == (PERIOD, 1, (2, 3))
    assert (row["generation"], row["kind"]) == (1, "dcm")
    assert row["volume"] == pytest.approx(mother.volume, rel=1e-7)
    for d, logged in zip(daughters, row["volumes"], strict=True):
        assert d.volume == pytest.approx(logged, rel=1e-7)
        assert d.volume == pytest.approx(0.5 * mother.volume, rel=2e-6)
        assert d.volume0 == 0.5 * mother.volume0  # to the last bit
    assert mother.volume0 == pytest.approx(2.0 * 4.0 / 3.0 * np.pi * 6.0**3, rel=1e-12)


def test_meshes(alone):
    _, mother, daughters = alone
    for d in daughters:
        d.check()
        assert len(d.x) == len(mother.x)
        assert d.quality > 0.6


def test_daughters_lie_in_the_mothers_space(alone):
    """Nodes stick out of envelope and plane by less than 0.04 of a radius, and as reported.

    That is below the smallest range of adhesion, 0.35 um.
    """
    result, mother, daughters = alone
    (row,) = read_log(result.path)
    center = mother.centroid
    worst = 0.0
    for d, sign in zip(daughters, (1.0, -1.0), strict=True):
        # the plane that halves a round cell goes through its center
        beyond = -(sign * (d.x - center) @ row["axis"]).min()
        outside = -mother.depth(d.x).min()
        worst = max(worst, beyond / d.radius, outside / d.radius)
        assert max(outside, beyond) < 0.04 * d.radius < 0.35
        assert sign * (d.centroid - center) @ row["axis"] > 0.4 * d.radius
    assert result.thermo[-1]["f_divide[5]"] == pytest.approx(worst, rel=0.1)
    assert result.thermo[-1]["f_divide[6]"] == pytest.approx(
        min(d.quality for d in daughters), rel=1e-6
    )


def test_no_net_force_no_momentum(alone):
    result, mother, daughters = alone
    for frame in frames_of(result).values():
        assert balanced(frame), frame.step
    # the daughters' common center stays the mother's, and stays where it is
    center = sum(d.centroid for d in daughters) / 2.0
    assert np.linalg.norm(center - mother.centroid) < 0.01 * mother.radius
    last = frame_at(result, PERIOD + 50)
    later = sum(Cell(last, n).centroid for n in (2, 3)) / 2.0
    assert np.linalg.norm(later - center) < 0.01 * mother.radius
    for step in (PERIOD, PERIOD + 1, PERIOD + 2):
        frame = frame_at(result, step)
        node = frame["c_p[1]"] == NODE
        momentum = np.linalg.norm(frame.v[node].sum(axis=0))
        assert momentum < 1e-3 * np.linalg.norm(frame.v[node], axis=1).sum(), step


def test_sisters_adhere(alone):
    """They are in contact from the first step on."""
    result, _, _ = alone
    for step in (*range(PERIOD, PERIOD + 10), PERIOD + 30, PERIOD + 50):
        frame = frame_at(result, step)
        one, two = (Cell(frame, n) for n in (2, 3))
        assert one.contact > one.radius**2 and two.contact > one.radius**2, step
    assert np.linalg.norm(one.centroid - two.centroid) < 1.6 * one.radius


def test_adhesion_of_sisters(lmp, scenes):
    """W takes from the force between newborn sisters, and keeps them together later."""
    force, area, distance = [], [], []
    for work in (0.0, 0.1):
        scene = scene_of(scenes, 20.0)
        scene.dcm(0.0, 0.0, 0.0, 6.0)
        contact = scene.contact("h0 0.4", f"W {work}")
        text = deck(scene, scenes, PERIOD, every=PERIOD, contact=contact)
        result = lmp(
            text + "thermo_style one\nunfix divide\nunfix grow\nrun 4000\n"
        )
        (row,) = read_log(result.path)
        newborn, later = frame_at(result, PERIOD), list(frames_of(result).values())[-1]
        force.append(Cell(newborn, 2).f.sum(axis=0) @ row["axis"])
        one, two = (Cell(later, n) for n in (2, 3))
        area.append(one.contact)
        distance.append(np.linalg.norm(one.centroid - two.centroid))
    assert force[0] > force[1] + 1.0  # nN
    assert area[1] > area[0] + 1.0 and distance[1] < distance[0] - 0.1, (area, distance)


def test_same_tags_are_used_again(alone):
    """Tags have no gaps, molecule IDs are new."""
    result, mother, _ = alone
    last = list(frames_of(result).values())[-1]
    size = 1 + len(mother.x) + len(mother.faces)
    assert (np.sort(last["id"]) == np.arange(1, 2 * size + 1)).all()
    assert set(last["mol"]) == {2, 3}


# --- among others ---------------------------------------------------------------------------------


def test_neighbors_are_not_torn(lmp, scenes):
    """A cell with six neighbors divides; none of their nodes moves by a tenth of a radius."""
    scene = scene_of(scenes, 25.0)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    for k in range(3):
        for sign in (-1.0, 1.0):
            at = [0.0, 0.0, 0.0]
            at[k] = sign * 11.9
            scene.dcm(*at, 6.0)
    result = lmp(
        deck(scene, scenes, PERIOD + 5, before="group mother molecule 1\n", group="mother")
    )
    assert [row["mother"] for row in read_log(result.path)] == [1]
    before, at, after = (frame_at(result, PERIOD + k) for k in (-1, 0, 1))
    assert molecules(after) == [2, 3, 4, 5, 6, 7, 8, 9]
    for n in range(2, 8):
        cells = [Cell(frame, n) for frame in (before, at, after)]
        assert cells[0].contact > 0.0 and cells[1].contact > 0.0 and cells[2].contact > 0.0
        for a, b in zip(cells, cells[1:]):
            assert np.linalg.norm(b.x - a.x, axis=1).max() < 0.1 * a.radius
    for frame in frames_of(result).values():
        assert balanced(frame), frame.step
    for n in (8, 9):
        Cell(after, n).check()


def test_all_in_one_step(lmp, scenes):
    """Five cells divide in the same step: molecules in the order of the mothers."""
    scene = scene_of(scenes, 35.0)
    for x, y, z in ((0, 0, 0), (11.9, 0, 0), (0, 11.9, 0), (-11.9, 0, 0), (0, 0, 20)):
        scene.dcm(x, y, z, 6.0)
    result = lmp(deck(scene, scenes, PERIOD + 10, every=10))
    rows = read_log(result.path)
    assert [(row["step"], row["mother"]) for row in rows] == [(PERIOD, n) for n in range(1, 6)]
    assert [row["daughters"] for row in rows] == [(k, k + 1) for k in range(6, 16, 2)]
    frame = frame_at(result, PERIOD)
    assert molecules(frame) == list(range(6, 16))
    assert len(set(frame["id"])) == len(frame["id"])
    assert balanced(frame)
    for row in rows:
        for n, volume in zip(row["daughters"], row["volumes"], strict=True):
            cell = Cell(frame, n)
            cell.check()
            assert cell.volume == pytest.approx(volume, rel=1e-7)
            assert 2.0 * volume == pytest.approx(row["volume"], rel=2e-6)


# --- planes ---------------------------------------------------------------------------------------


def along(result, row):
    """Cosine of the angle between the line from daughter 2 to 1 and the axis."""
    one, two = (Cell(frame_at(result, row["step"]), n).centroid for n in row["daughters"])
    return (one - two) @ row["axis"] / np.linalg.norm(one - two)


def test_plane_given(lmp, scenes):
    scene = scene_of(scenes, 15.0)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    result = lmp(deck(scene, scenes, PERIOD, every=50, plane="plane given 1 -2 2"))
    (row,) = read_log(result.path)
    assert row["axis"] == pytest.approx(np.array([1.0, -2.0, 2.0]) / 3.0, abs=1e-8)
    assert along(result, row) > 0.999


def second_moment(cell):
    """Of the enclosed volume, about its centroid; independent of the package."""
    a, b, c = (p - cell.centroid for p in cell.corners)
    w = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    s = a + b + c
    outer = lambda u: np.einsum("i,ij,ik->jk", w, u, u)  # noqa: E731
    return (outer(a) + outer(b) + outer(c) + outer(s)) / 20.0


@pytest.mark.parametrize("direction", [(1, 0, 0), (2, -1, 3)])
def test_plane_long(lmp, scenes, direction):
    """The longest axis of the body, found here from the volume's second moment."""
    nodes, faces = scenes.icosphere(2)
    axis = np.array(direction, dtype=float) / np.linalg.norm(direction)
    nodes = nodes + 0.7 * np.outer(nodes @ axis, axis)
    scene = scene_of(scenes, 20.0)
    scene.dcm(
        0.0, 0.0, 0.0, 6.0, mesh=("long.off", len(nodes), len(faces)), options="rest 0.95"
    )
    result = lmp(
        deck(scene, scenes, 20, cycle=20, plane="plane long"),
        files={"long.off": scenes.off(nodes, faces)},
    )
    (row,) = read_log(result.path)
    mother = Cell(frame_at(result, 19), 1, at=1.0)
    values, vectors = np.linalg.eigh(second_moment(mother))
    assert values[2] > 1.3 * values[1], "the mother is not long any more"
    assert abs(vectors[:, 2] @ row["axis"]) == pytest.approx(1.0, abs=1e-7)
    assert abs(axis @ row["axis"]) > 0.999
    assert along(result, row) > 0.999


def test_plane_variable(lmp, scenes):
    """Atom-style variables, here the direction from the origin to the cell."""
    scene = scene_of(scenes, 30.0)
    places = ((12.0, 3.0, 0.0), (-8.0, 8.0, 8.0), (0.0, -10.0, -5.0))
    for at in places:
        scene.dcm(*at, 6.0)
    variables = "variable ax atom x\nvariable ay atom y\nvariable az atom 2*z\n"
    result = lmp(
        deck(
            scene, scenes, PERIOD, every=50, before=variables, plane="plane variable v_ax v_ay v_az"
        )
    )
    rows = read_log(result.path)
    assert len(rows) == 3
    for row, at in zip(rows, places, strict=True):
        wanted = np.array(at) * [1.0, 1.0, 2.0]
        assert row["axis"] @ wanted / np.linalg.norm(wanted) > 0.999
        assert along(result, row) > 0.999


def grid_of_spheres(scene, n, spacing):
    for i in range(n**3):
        at = np.array([i % n, i // n % n, i // n // n]) - 0.5 * (n - 1)
        scene.cbm(*(spacing * at), 5.0)


def spheres_deck(scene, scenes, steps, plane="", cycle=PERIOD):
    return (
        scene.head()
        + f"pair_style dcm/contact\npair_coeff * * {scene.map}\nneighbor 0.8 bin\n"
        + "fix cell all dcm/cell\n"
        + f"fix grow all dcm/growth {scene.map} seed 5 cycle_time {cycle}\n"
        + f"fix divide all dcm/division seed 7 log div.log {plane}\n"
        + scene.motion()
        + "timestep 1.0\n"
        + scenes.dump("id mol type radius xu yu zu vx vy vz fx fy fz", 1)
        + f"run {steps}\n"
    )


def test_planes_at_random_are_isotropic(lmp, scenes):
    """216 center-based cells: means of axes and of their products, within 4 standard errors."""
    scene = scenes.Scene(60.0)
    scene.NAMES = "NULL NULL NULL hepatoblast_cbm"
    grid_of_spheres(scene, 6, 18.0)
    result = lmp(spheres_deck(scene, scenes, 4, cycle=4))
    axes = np.array([row["axis"] for row in read_log(result.path)])
    n = len(axes)
    assert n == 216
    assert np.linalg.norm(axes, axis=1) == pytest.approx(1.0, abs=1e-7)
    assert np.abs(axes.mean(axis=0)).max() < 4.0 * np.sqrt(1.0 / 3.0 / n)
    moment = axes.T @ axes / n
    assert np.abs(np.diag(moment) - 1.0 / 3.0).max() < 4.0 * np.sqrt(4.0 / 45.0 / n)
    assert np.abs(moment[np.triu_indices(3, 1)]).max() < 4.0 * np.sqrt(1.0 / 15.0 / n)


def test_random_planes_depend_on_the_seed(lmp, scenes):
    axes = []
    for plane, seed in (("plane random", 7), ("", 7), ("", 8)):
        scene = scene_of(scenes, 15.0)
        scene.dcm(0.0, 0.0, 0.0, 6.0)
        text = deck(scene, scenes, 10, every=10, cycle=10, plane=plane)
        result = lmp(text.replace("dcm/division seed 7", f"dcm/division seed {seed}"))
        (row,) = read_log(result.path)
        assert along(result, row) > 0.999
        axes.append(row["axis"])
    assert (axes[0] == axes[1]).all()
    assert abs(axes[0] @ axes[2]) < 0.99


# --- center-based cells ---------------------------------------------------------------------------


@pytest.mark.parametrize("mode", ["cbm soften 50", "cbm truncate 2"])
def test_spheres_divide_in_their_space(lmp, scenes, mode):
    """Half the volume each, within the mother; the sisters' contact is held back, then is not."""
    scene = scenes.Scene(20.0, "f f f")
    scene.NAMES = "NULL NULL NULL hepatoblast_cbm"
    scene.cbm(0.0, 0.0, 0.0, 5.0)
    result = lmp(spheres_deck(scene, scenes, 195, mode))
    (row,) = read_log(result.path)
    assert (row["step"], row["kind"], row["daughters"]) == (PERIOD, "cbm", (2, 3))
    mother, newborn = frame_at(result, PERIOD - 1), frame_at(result, PERIOD)
    big, small = mother["radius"][0], newborn["radius"]
    assert big == pytest.approx(5.0 * np.cbrt(2.0), rel=1e-9)
    assert small == pytest.approx(np.full(2, 5.0), rel=1e-9)
    assert np.linalg.norm(newborn.x, axis=1) + small == pytest.approx(np.full(2, big), rel=1e-9)
    forces = []
    for frame in frames_of(result).values():
        assert balanced(frame) or np.abs(frame.f).max() == 0.0
        if frame.step >= PERIOD:
            one = frame.x[0] - frame.x[1]
            forces.append(frame.f[0] @ one / np.linalg.norm(one))
    most = 2.0 if "truncate" in mode else np.inf
    assert 0.0 < forces[0] <= most * (1 + 1e-12)
    assert max(forces[:-1]) <= most * (1 + 1e-12) and max(forces) < 50.0
    # they are pushed apart, and harder the longer they have been apart with `soften`
    last = list(frames_of(result).values())[-1].x
    assert np.linalg.norm(last[0] - last[1]) > 1.01 * np.linalg.norm(newborn.x[0] - newborn.x[1])
    if "soften" in mode:
        assert forces[0] < 2e-3 * forces[50] and forces[25] < 0.6 * forces[50]
        assert max(forces) < 1.5 * forces[50]  # the spheres grow again


# --- ranks ----------------------------------------------------------------------------------------


def crowd(scenes, boundary="p p p", shift=(3.0, 2.0, 0.5)):
    """Three deformable and four center-based cells across the borders of ranks, with some room."""
    scene = scenes.Scene((30.0, 30.0, 20.0), boundary)
    sx, sy, sz = shift
    for x, y in ((0.0, 8.2), (-7.1, -4.1), (7.1, -4.1)):
        scene.dcm(x + sx, y + sy, sz, 6.0)
    for x, y in ((-12.0, 9.0), (12.0, 9.0), (0.0, -15.0), (-19.0, -3.0)):
        scene.cbm(x + sx, y + sy, 0.2 + sz, 5.0)
    return scene, scene.contact().replace("neighbor 0.6", "neighbor 0.8")


def agree(lmp, text, least):
    one = lmp(text)
    rows = read_log(one.path)
    assert len(rows) >= least and len({row["step"] for row in rows}) > 2
    for np_ in (2, 4):
        other = lmp(text, np=np_)
        assert (other.path / "div.log").read_bytes() == (one.path / "div.log").read_bytes()
        for a, b in zip(frames_of(one).values(), frames_of(other).values(), strict=True):
            assert a.step == b.step
            for name in ("id", "mol", "type"):
                assert (a[name] == b[name]).all(), (np_, a.step, name)
            assert np.abs(a.x - b.x).max() < 1e-9, (np_, a.step)
    return rows


@pytest.mark.parametrize("boundary", ["f f f", "p p p", "s s s"])
def test_1_2_and_4_ranks_agree(lmp, scenes, boundary):
    """Tags, molecules, the log to the byte, positions to 1e-9 um."""
    scene, contact = crowd(scenes, boundary)
    text = deck(
        scene, scenes, 120, every=10, contact=contact, growth="cycle_sd 10",
        extra="comm_style brick\n",
    )  # fmt: skip
    assert {row["kind"] for row in agree(lmp, text, 5)} == {"dcm", "cbm"}


@pytest.mark.parametrize("boundary", ["p p p", "s s s"])
def test_1_2_and_4_ranks_agree_on_tiles(lmp, scenes, boundary):
    """Without center-based cells: LAMMPS has no contact history with comm_style tiled."""
    scene = scene_of(scenes, 30.0, boundary)
    for at in ((0, 8.2, 0), (-7.1, -4.1, 0), (7.1, -4.1, 0), (15, 15, 15)):
        scene.dcm(at[0] + 3.0, at[1] + 2.0, at[2] + 0.5, 6.0)
    extra = "comm_style tiled\nfix balance all balance 20 1.05 rcb\n"
    text = deck(scene, scenes, 120, every=10, growth="cycle_sd 10", extra=extra)
    agree(lmp, text, 3)


# --- place in the box -----------------------------------------------------------------------------


@pytest.mark.parametrize("shift", [(7.31, -4.17, 2.93), (24.97, 25.03, -24.99)])
def test_place_in_the_box_changes_nothing(lmp, scenes, shift):
    """Two generations elsewhere, and across a corner: the same cells, but for round-off."""

    def last(at):
        scene = scene_of(scenes, 25.0, "p p p")
        scene.dcm(*(1.0 + np.array(at)), 6.0)
        result = lmp(deck(scene, scenes, 2 * PERIOD + 10, every=10))
        assert len(read_log(result.path)) == 3
        return frame_at(result, 2 * PERIOD + 10)

    one, other = last((0.0, 0.0, 0.0)), last(shift)
    for name in ("id", "mol", "type"):
        assert (one[name] == other[name]).all(), name
    way = (other.x - one.x - shift + 25.0) % 50.0 - 25.0
    assert np.abs(way).max() < 1e-9


# --- restart files --------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("at", [PERIOD // 2, PERIOD - 1, PERIOD, PERIOD + 1, PERIOD + 10])
def test_restart_is_bit_for_bit(lmp, scenes, at, np_):
    """Between divisions, in the step before, the step of it, and as the daughters relax.

    """
    scene, contact = crowd(scenes)
    processors = "processors * 1 1\n"
    columns = "id mol type radius xu yu zu vx vy vz fx fy fz"
    end = max(PERIOD + 20, at + 15)

    def rest(first):
        return (
            fixes(scene)
            + output(scenes, 5, columns)
            + f"restart {at} r.*\nrun {end if first else end - at}\n"
        )

    whole = lmp(processors + scene.head() + scene.cortex() + contact + rest(True), np=np_)
    assert len(read_log(whole.path)) == 7
    again = lmp(
        processors
        + f"read_restart r.{at}\npair_coeff * * {scene.map}\nneighbor 0.8 multi\n"
        + rest(False),
        np=np_,
        files={f"r.{at}": whole.path / f"r.{at}"},
    )
    expected = {frame.step: frame for frame in whole.dump()}
    found = [frame for frame in again.dump() if frame.step in expected and frame.step > at]
    assert found[-1].step == end // 5 * 5
    for frame in found:
        for name in columns.split():
            different = np.flatnonzero(expected[frame.step][name] != frame[name])
            assert not len(different), (
                f"step {frame.step}: {name} of {len(different)} atoms differs, by up to "
                f"{np.abs(expected[frame.step][name] - frame[name]).max():.3g}"
            )
    lines = [line for line in (whole.path / "div.log").read_text().splitlines() if line[0] != "#"]
    more = [line for line in (again.path / "div.log").read_text().splitlines() if line[0] != "#"]
    assert more == (lines if at < PERIOD else [])
    for key, value in whole.thermo[-1].items():
        assert again.thermo[-1][key] == value, key


# --- books ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
def test_counts_after_generations(lmp, scenes, np_):
    """Three generations: eight cells, every atom, bond and dihedral there once."""
    scene = scene_of(scenes, 25.0)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    text = deck(scene, scenes, 600, every=200, cycle=200)
    result = lmp(text + "write_data out.data nofix nocoeff\n", np=np_)
    last = list(frames_of(result).values())[-1]
    assert molecules(last) == list(range(8, 16))
    for n in range(8, 16):
        Cell(last, n).check()
    head, _, body = (result.path / "out.data").read_text().partition("Atoms")
    count = {w[1]: int(w[0]) for w in (line.split() for line in head.splitlines()) if len(w) == 2}
    assert (count["atoms"], count["bonds"], count["dihedrals"]) == (8 * 123, 8 * 120, 8 * 120)
    owner = dict(zip(last["id"].astype(int), last["mol"].astype(int)))
    bonds = [line.split()[2:4] for line in section(body, "Bonds")]
    assert len({frozenset(b) for b in bonds}) == len(bonds) == 8 * 120
    assert all(owner[int(a)] == owner[int(b)] for a, b in bonds)
    dihedrals = [line.split()[2:6] for line in section(body, "Dihedrals")]
    assert len({frozenset(d[1:3]) for d in dihedrals}) == len(dihedrals) == 8 * 120
    assert all(len({owner[int(a)] for a in d}) == 1 for d in dihedrals)
    generations = [row["generation"] for row in read_log(result.path)]
    assert generations == [1, 2, 2, 3, 3, 3, 3]


def test_too_few_slots(lmp, scenes):
    """A data file of an octahedron has three slots per node; daughters need four. Said at setup."""
    nodes = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
    faces = [(x, y, z) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    faces = [f if (f[0] + f[1] + f[2]) % 2 == 0 else f[::-1] for f in faces]
    scene = scene_of(scenes, 15.0)
    scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=("eight.off", 6, 8))
    head = scene.head().replace(" extra/bond/per/atom 8 extra/dihedral/per/atom 8", "")
    written = lmp(
        head + "write_data out.data nofix nocoeff\n",
        files={"eight.off": scenes.off(nodes, faces)},
    )
    for slots in ("", " extra/bond/per/atom 4 extra/dihedral/per/atom 4"):
        result = lmp.run(
            f"units lj\natom_style dcm\nnewton on\nboundary s s s\nread_data out.data{slots}\n"
            + scene.cortex()
            + scene.contact("h0 1.0 range 5.0")
            + fixes(scene)
            + "run 1\n",
            files={"out.data": written.path / "out.data"},
        )
        if slots:
            assert result.returncode == 0, result.tail()
            continue
        assert result.returncode != 0
        assert re.search(
            r"dcm/division: a node needs 4 bond and 4 dihedral slots, there are 3 and 3; add "
            r"'extra/bond/per/atom 4 extra/dihedral/per/atom 4' to create_box or read_data",
            result.error,
        ), result.error


def test_groups_are_inherited(lmp, scenes):
    """Each sort of atoms of a daughter is in the groups in which all those of its mother are."""
    scene = scene_of(scenes, 25.0)
    scene.dcm(-7.0, 0.0, 0.0, 6.0)
    scene.dcm(7.0, 0.0, 0.0, 6.0)
    before = "group left molecule 1\ngroup nodes type 2\ngroup centers type 1\n"
    groups = "left nodes centers all"
    extra = "".join(
        f"variable n_{g} equal count({g})\n" for g in groups.split()
    ) + "fix count all ave/time 1 1 1 " + " ".join(
        f"v_n_{g}" for g in groups.split()
    ) + " file count.txt\n"
    result = lmp(deck(scene, scenes, PERIOD, every=PERIOD, before=before, extra=extra))
    rows = [line.split() for line in (result.path / "count.txt").read_text().splitlines()]
    counts = {int(r[0]): [int(float(x)) for x in r[1:]] for r in rows if r[0] != "#"}
    assert counts[PERIOD - 1] == [123, 84, 2, 246]
    assert counts[PERIOD] == [246, 168, 4, 492]


@pytest.mark.parametrize(
    "old, new, message",
    [
        ("dcm/division seed 7", "dcm/division", "keyword seed is missing"),
        ("log div.log", "plane given 0 0 0", "has no direction"),
        ("log div.log", "plane sideways",
         "plane must be random, long, polarity, given x y z or variable"),
        ("log div.log", "plane variable v_a v_b v_c", "no atom-style variable a"),
        ("log div.log", "cbm soft 3", "cbm must be soften T or truncate F"),
        ("log div.log", "log nowhere/div.log", "cannot open log nowhere/div.log"),
        ("log div.log", "tolerance 0.5", "must be at most 0.1"),
        ("log div.log", "maxiter 3", "raise maxiter"),
        ("log div.log", "colour red", "unknown keyword colour"),
        ("timestep", "fix second all dcm/division seed 3\ntimestep", "at most one"),
    ],
)  # fmt: skip
def test_bad_input(lmp, scenes, old, new, message):
    scene = scene_of(scenes, 15.0)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    text = deck(scene, scenes, 10, every=10, cycle=10)
    assert text.count(old) == 1
    result = lmp.run(text.replace(old, new))
    assert result.returncode != 0
    assert message in result.error, result.error
