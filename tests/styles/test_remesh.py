"""fix dcm/remesh: what stays of a cell whose mesh is made anew, ranks, restart, bad input."""

import numpy as np
import pytest

from support.bad_decks import fails, whole

CELL = "fix cell all dcm/cell\n"
COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"
COUNTS = ["cells", "flips", "slides", "moves", "left", "quality", "distance", "volume"]
CENTER, NODE, FACE = 1, 2, 3


def quality(x, faces):
    a, b, c = (x[faces[:, k]] for k in range(3))
    sides = sum(((p - q) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a)))
    return 2 * 3**0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1) / sides


def worn(scenes, level=2, shear=1.3):
    """A ball whose nodes have flowed, as a mesh file: (name, text, nodes, faces)."""
    x, faces = scenes.icosphere(level)
    x[:, 0] += shear * x[:, 1]
    x /= np.linalg.norm(x, axis=1)[:, None]
    return "worn.off", scenes.off(x, faces), len(x), len(faces)


def worn_cells(scenes, boundary="s s s", at=((0.0, 0.0, 0.0),), box=16.0):
    name, text, nodes, faces = worn(scenes)
    scene = scenes.Scene(box, boundary, 2)
    for place in at:
        scene.dcm(*place, 6.0, mesh=(name, nodes, faces), options="rotate 3 rest 0.95")
    return scene, {name: text}


def counts(every=1):
    return [f"{name}=f_remesh[{k}]" for k, name in enumerate(COUNTS, 1)]


def remesh(options="every 10 quality 0.6 goal 0.65", group="all"):
    return f"fix remesh {group} dcm/remesh {options}\n"


def surface(frame):
    """Nodes and faces (indices) of a dump with id type xu yu zu and the vertices of faces."""
    ids = frame["id"].astype(int)
    place = {tag: k for k, tag in enumerate(ids)}
    faces = frame.vectors("c_p[1]", "c_p[2]", "c_p[3]")[frame["type"] == FACE].astype(int)
    return frame.vectors("xu", "yu", "zu"), np.array([[place[v] for v in f] for f in faces])


def enclosed(x, faces):
    a, b, c = (x[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


# --- one cell -------------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2, 4])
@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_what_stays(lmp, scenes, np_, boundary):
    """At the step of a remeshing: volume, place, numbers, pressure; a closed surface; bonds and
    dihedrals that fit the faces, which the next run would not begin without. In a periodic box the
    cell lies in its corner."""
    at = (0.0, 0.0, 0.0) if boundary == "s s s" else (15.5, -15.0, 15.8)
    scene, files = worn_cells(scenes, boundary, [at])
    deck = scene.head() + scene.forces()
    tail = (
        scene.motion(options="tolerance 1e-10") + "timestep 1.0\n"
        + "compute c all dcm/cell volume pressure area\n"
        + "compute p all property/atom vertex1 vertex2 vertex3\n"
        + scenes.dump("id mol type xu yu zu c_p[1] c_p[2] c_p[3]", 10)
    )  # fmt: skip
    cell = [f"{name}=C_c[1][{k}]" for k, name in enumerate(["volume", "pressure", "area"], 1)]
    without = lmp(deck + tail + scenes.thermo(cell) + "run 10\n", files=files)
    with_it = lmp(
        deck + remesh("every 10 quality 0.6 goal 0.65 log remesh.log") + tail
        + scenes.thermo([*cell, *(f"n_{c}" for c in counts())]) + "run 10\nrun 10\n",
        np=np_, files=files)  # fmt: skip
    old, new = without.thermo[-1], with_it.runs[0][-1]
    assert new["v_n_cells"] == 1 and new["v_n_flips"] > 5
    assert new["v_n_quality"] >= 0.6
    assert with_it.runs[0][-2]["v_n_quality"] < 0.56
    assert 0 < new["v_n_distance"] <= 0.1
    assert new["v_volume"] == pytest.approx(old["v_volume"], rel=1e-7)
    assert new["v_pressure"] == pytest.approx(old["v_pressure"], rel=1e-4)
    assert new["v_area"] == pytest.approx(old["v_area"], rel=2e-3)

    a, b = without.dump()[-1], with_it.dump()[1]
    assert (a["id"] == b["id"]).all() and (a["type"] == b["type"]).all()
    (x, _), (y, now) = surface(a), surface(b)
    assert enclosed(y - y[0], now) == pytest.approx(new["v_volume"], rel=1e-9)
    assert quality(y, now).min() == pytest.approx(new["v_n_quality"], rel=1e-9)
    nodes = a["type"] == NODE
    assert np.abs(x[nodes].mean(axis=0) - y[nodes].mean(axis=0)).max() < 0.1
    stay = np.abs(x[nodes] - y[nodes]).max(axis=1) < 1e-9
    assert 0.5 * nodes.sum() < stay.sum() < nodes.sum()
    sides = [tuple(f[[k, (k + 1) % 3]]) for f in now for k in range(3)]
    assert len(set(sides)) == len(sides) and {(q, p) for p, q in sides} == set(sides)
    assert len(sides) == 2 * 3 * (nodes.sum() - 2)  # a sphere
    # faces lie between their nodes, the center among them
    assert np.abs(y[b["type"] == FACE] - y[now].mean(axis=1)).max() < 1e-9
    assert np.abs(y[b["type"] == CENTER] - y[nodes].mean(axis=0)).max() < 1e-9
    log = (with_it.path / "remesh.log").read_text().splitlines()
    assert [line.split()[0] for line in log if line[0] != "#"] == ["10"]
    assert with_it.runs[1][-1]["v_n_cells"] == 1  # good from then on


def test_uniform_strain_is_carried(lmp, scenes):
    """Rest lengths of a cell that is held in place are 0.95 of all edges, old and new."""
    scene, files = worn_cells(scenes)
    result = lmp(
        scene.head() + scene.forces() + remesh("every 1 quality 0.6 goal 0.65")
        + "timestep 1.0\n" + "compute p all property/atom vertex1 vertex2 vertex3\n"
        + scenes.dump("id mol type xu yu zu c_p[1] c_p[2] c_p[3]", 1)
        + scenes.thermo(counts()) + "run 1\nfix_modify cell rest/write after\n", files=files,
    )  # fmt: skip
    assert result.thermo[-1]["v_flips"] > 0
    frame = result.dump()[-1]
    place = dict(zip(frame["id"].astype(int), frame.vectors("xu", "yu", "zu"), strict=True))
    rows = [line.split() for line in (result.path / "after").read_text().splitlines()]
    lengths = [(int(r[0]), int(r[1]), float(r[2])) for r in rows if len(r) == 3 and r[0] != "#"]
    assert len(lengths) == 480
    ratio = [l0 / np.linalg.norm(place[a] - place[b]) for a, b, l0 in lengths]
    assert ratio == pytest.approx([0.95] * 480, rel=1e-6)


def test_flow(lmp, scenes):
    """A soft cell in a shear flow: its faces get worse than the fix lets them become."""
    worst = {}
    for name, fix in (("without", ""), ("with", remesh("every 10 energy 10"))):
        scene = scenes.single_cell(level=2, box=30.0, options="rotate 3 rest 1")
        result = lmp(
            scene.head() + scene.cortex(bond="E_cor 0.2") + scene.contact() + CELL
            + scene.volume() + fix + scene.motion(options="tolerance 1e-10 maxmove 1")
            + "group nodes type 2\nvariable fx atom 0.1*y\nfix flow nodes addforce v_fx 0 0\n"
            + "compute p all property/atom vertex1 vertex2 vertex3\ntimestep 1.0\n"
            + scenes.dump("id mol type xu yu zu c_p[1] c_p[2] c_p[3]", 10)
            + (scenes.thermo(counts(), 10) if fix else "") + "run 400\n"
        )  # fmt: skip
        worst[name] = min(quality(*surface(frame)).min() for frame in result.dump())
    assert result.thermo[-1]["v_cells"] >= 3
    assert worst["without"] < 0.3
    assert worst["with"] > 0.33


# --- ranks and restart ----------------------------------------------------------------------------

PAIR = [(-5.9, 0.3, 0.2), (5.9, 0.0, 0.0)]


def tissue(scene):
    return (
        scene.head() + scene.forces() + remesh()
        + scene.motion(options="tolerance 1e-12") + "timestep 0.5\n"
    )  # fmt: skip


def test_ranks_agree(lmp, scenes):
    scene, files = worn_cells(scenes, at=PAIR)
    deck = tissue(scene) + scenes.dump(COLUMNS, 5) + scenes.thermo(counts(), 5) + "run 20\n"
    one = lmp(deck, files=files)
    assert one.thermo[-1]["v_cells"] == 2 and one.thermo[-1]["v_moves"] >= 0
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_, files=files)
        for name in COUNTS[:5]:
            assert other.thermo[-1]["v_" + name] == one.thermo[-1]["v_" + name]
        for a, b in zip(one.dump(), other.dump(), strict=True):
            assert (a["id"] == b["id"]).all()
            assert np.abs(a.x - b.x).max() < 1e-8
            assert np.abs(a.f - b.f).max() < 1e-6


def test_among_cells_that_live(lmp, scenes):
    """Cells grow, divide, die and turn apical while all of them are looked at in each step: the
    same is done on any number of processes, also in the steps in which cells divide."""
    deck = None
    logs = []
    for np_ in (1, 2, 4):
        scene = scenes.Scene(40.0, "p p p", 1)
        for x in (-5.85, 5.85):
            scene.dcm(x, 0.0, 0.0, 6.0)
        deck = (
            scene.head() + scene.cortex() + scene.contact("law foundation growth 3")
            + f"neighbor 1.2 multi\nfix cell all dcm/cell types {scene.map}\n" + scene.volume()
            + "fix growth all dcm/growth seed 3 cycle_time 40 cycle_sd 4\n"
            + "fix division all dcm/division seed 4\n"
            + "fix death all dcm/death age 55 every 5\n"
            + "fix pol all dcm/polarity seed 3 init toward 0 0 0 apical 0.5 junction 0.2 0.5 "
            + "every 5\n"
            + remesh("every 1 quality 0.85 goal 0.9 distance 0.2 energy 2 log remesh.log")
            + scene.motion(options="tolerance 1e-10 scheme implicit maxmove 2") + "timestep 1.0\n"
            + scenes.thermo(["atoms", "bonds", *counts()], 10) + "run 45\nrun 35\n"
        )  # fmt: skip
        result = lmp(deck, np=np_)
        rows = [line.split() for line in (result.path / "remesh.log").read_text().splitlines()]
        logs.append(([row[:6] for row in rows if row[0] != "#"], result.thermo[-1]))
    done, last = logs[0]
    assert len(done) > 3 and sum(int(row[3]) + int(row[5]) for row in done) > 0
    assert last["Bonds"] > 240
    for other, end in logs[1:]:
        assert other == done
        assert end["Atoms"] == last["Atoms"]


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("at", [5, 15])
def test_restart_is_bit_for_bit(lmp, scenes, np_, at):
    """Before the remeshing of step 10, and after it."""
    scene, files = worn_cells(scenes, "f f f", at=PAIR)
    processors = "processors * 1 1\n"
    output = scenes.dump(COLUMNS, 5) + scenes.thermo(counts(), 5)
    first = lmp(processors + tissue(scene) + output + f"restart {at} r.*\nrun 30\n", np=np_,
                files=files)  # fmt: skip
    rest = lmp(
        processors + f"read_restart r.{at}\npair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
        + CELL + scene.volume() + remesh() + scene.motion(options="tolerance 1e-12")
        + "timestep 0.5\n" + output + f"restart {at} r.*\nrun {30 - at}\n",
        np=np_, files={f"r.{at}": first.path / f"r.{at}"},
    )  # fmt: skip
    assert first.thermo[-1]["v_cells"] >= 2
    for name in COUNTS[:5]:
        assert rest.thermo[-1]["v_" + name] == first.thermo[-1]["v_" + name]
    expected = [frame for frame in first.dump() if frame.step >= at]
    for a, b in zip(expected, rest.dump(), strict=True):
        for name in COLUMNS.split():
            assert (a[name] == b[name]).all(), (a.step, name)


def test_nothing_to_do(lmp, scenes):
    """Good meshes: the trajectory is the same to the last bit."""
    ends = []
    for fix in ("", remesh("every 1")):
        scene = scenes.doublet(level=1)
        deck = scene.head() + scene.forces() + fix + scene.motion() + "timestep 1.0\n"
        ends.append(lmp(deck + scenes.dump(COLUMNS, 20) + "run 40\n").dump())
    for a, b in zip(*ends, strict=True):
        for name in COLUMNS.split():
            assert (a[name] == b[name]).all()


# --- groups ---------------------------------------------------------------------------------------


def test_group_and_nodes_of_other_groups(lmp, scenes):
    """Only cells of the group; nodes in a group of their own stay in it, and where they are."""
    scene, files = worn_cells(scenes, at=[(-8.0, 0.0, 0.0), (8.0, 0.0, 0.0)], box=20.0)
    result = lmp(
        scene.head() + scene.forces() + "group one molecule 1\n"
        + "region tip block INF -12.5 INF INF INF INF\ngroup nodes type 2\n"
        + "group there region tip\ngroup tip intersect there nodes\n"
        + remesh("every 1 quality 0.6 goal 0.7", "one") + "timestep 1.0\n"
        + "variable tip atom gmask(tip)\n"
        + "compute p all property/atom vertex1 vertex2 vertex3\n"
        + scenes.dump("id mol type xu yu zu v_tip c_p[1] c_p[2] c_p[3]", 1)
        + scenes.thermo(counts()) + "run 1\n", files=files,
    )  # fmt: skip
    a, b = result.dump()
    assert result.thermo[-1]["v_cells"] == 1
    tip = a["v_tip"] == 1
    assert tip.sum() > 5
    assert (a["v_tip"] == b["v_tip"]).all()
    x, y = (frame.vectors("xu", "yu", "zu") for frame in (a, b))
    assert (x[tip] == y[tip]).all()
    changed = (a.vectors("c_p[1]", "c_p[2]", "c_p[3]") != b.vectors(
        "c_p[1]", "c_p[2]", "c_p[3]")).any(axis=1)  # fmt: skip
    assert set(a["mol"][changed].astype(int)) == {1}


def border(faces, mark):
    """Edges between marked and other faces, seen from the marked ones."""
    sides = {tuple(f[[k, (k + 1) % 3]]): m for f, m in zip(faces, mark, strict=True)
             for k in range(3)}  # fmt: skip
    return {side for side, m in sides.items() if m and not sides[side[::-1]]}


@pytest.mark.parametrize("np_", [1, 3])
def test_marks_of_a_lumen(lmp, scenes, np_):
    """The edges at which they end are the same, and what is marked is; nodes there may slide."""
    scene, files = worn_cells(scenes, at=PAIR)
    result = lmp(
        scene.head() + scene.forces()
        + "fix osm all dcm/osmosis pressure 0.01 marks flood slab z -2.5 2.5 "
        + "starter 0 0 0 99 1e9 every 100\n"
        + remesh("every 1 quality 0.6 goal 0.7 energy 1") + "timestep 1.0\n"
        + "compute m all dcm/face mark\ncompute p all property/atom vertex1 vertex2 vertex3\n"
        + scenes.dump("id mol type xu yu zu c_m c_p[1] c_p[2] c_p[3]", 1)
        + scenes.thermo(counts()) + "run 1\n", np=np_, files=files,
    )  # fmt: skip
    assert result.thermo[-1]["v_cells"] == 2 and result.thermo[-1]["v_flips"] > 10
    (x, before), (y, after) = (surface(frame) for frame in result.dump())
    marks = [frame["c_m"][frame["type"] == FACE] > 0.5 for frame in result.dump()]
    assert 20 < marks[0].sum() < 400
    assert (marks[0] == marks[1]).all()
    assert border(before, marks[0]) == border(after, marks[1])
    assert (before != after).any(axis=1).sum() > 20
    areas = [np.linalg.norm(np.cross(p[f[m][:, 1]] - p[f[m][:, 0]], p[f[m][:, 2]] - p[f[m][:, 0]]),
                            axis=1).sum() for p, f, m in ((x, before, marks[0]),
                                                          (y, after, marks[1]))]  # fmt: skip
    assert areas[1] == pytest.approx(areas[0], rel=0.02)


# --- bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize("options, patterns", [
    ("quality 1.2", ["dcm/remesh", "quality is 1.2", "below 1"]),
    ("quality 0", ["quality is 0", "positive"]),
    ("goal 0.3 quality 0.5", ["goal 0.3 is below quality 0.5"]),
    ("longest 1.2", ["longest is 1.2", "above 1.5"]),
    ("distance 0.8", ["distance is 0.8", "at most 0.5"]),
    ("angle 120", ["angle is 120", "at most 90"]),
    ("energy -1", ["energy is -1", "positive"]),
    ("carry all", ["carry", "strain or load"]),
    ("every 0", ["every is 0"]),
    ("often 3", ["often", "every"]),
])
def test_bad_arguments(lmp, scenes, options, patterns):
    fails(lmp, whole(scenes.single_cell(), extra=remesh(options)), *patterns)


@pytest.mark.parametrize("other, patterns", [
    ("fix tense all dcm/adapt rest 0.9 faces apical\n", ["fix tense .dcm/adapt.", "take one of"]),
    ("fix tight all dcm/constriction when born\n",
     ["dcm/remesh", "fix tight .dcm/constriction.", "take one of"]),
    (remesh().replace("remesh all", "again all"), ["There is a fix dcm/remesh already"]),
])
def test_styles_that_do_not_go_together(lmp, scenes, other, patterns):
    fails(lmp, whole(scenes.single_cell(), extra=remesh() + other), *patterns)


def test_not_with_branch_history(lmp, scenes):
    scene = scenes.single_cell()
    fails(lmp, whole(scene, contact=scene.contact("law maugis branch history"), extra=remesh()),
          "dcm/remesh", "branch history", "take one of")  # fmt: skip
