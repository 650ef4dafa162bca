"""fix dcm/tracer with the other styles of a lumen: polarity gives the drift, osmosis asks which
faces tracers are near to, cells divide, differentiate and change their form; periodic boxes and
tiled ranks."""

import math

import numpy as np
import pytest

from support.bad_decks import fails
from support.tracers import FACE, Deck, right_places, surfaces, tracers, winding

GOOD = "number 100 D 0.02 seed 7 "


def toward_origin(x, cell):
    return abs(x[0]) < 2.5


def cycle(scene, time=40):
    return (
        f"fix grow all dcm/growth {scene.map} seed 5 cycle_time {time}\n"
        "fix divide all dcm/division seed 7\n"
    )


def inside_of(frame):
    """Molecule -> number of tracers whose home it is."""
    homes = tracers(frame)[2]
    return {mol: int((homes == mol).sum()) for mol in surfaces(frame)}


@pytest.mark.parametrize("np_", [1, 2])
def test_drift(lmp, scenes, np_):
    """u t along the apical vector in the cell, nothing outside; both within three standard
    errors."""
    u, D, steps = 0.2, 0.002, 5
    deck = Deck(lmp, scenes, scenes.single_cell(level=1))
    rng = np.random.default_rng(2)
    outside = [(*x, 0) for x in 9.0 + 3.0 * rng.random((1000, 3))]
    A = np.array([2.0, -1.0, 2.0]) / 3.0
    polarity = "fix pol all dcm/polarity seed 1 junction none init toward 200 -100 200\n"
    result = lmp(
        deck(f"number 3000 D {D} seed 3 drift {u}", steps, before=polarity,
             motion=deck.scene.motion() + "compute a all dcm/cell ax ay az\n"),
        np=np_, files=deck.files(outside),
    )  # fmt: skip
    first, last = (tracers(frame) for frame in (result.dump()[0], result.dump()[-1]))
    assert np.array_equal(first[0], last[0])
    way, home = last[1] - first[1], first[2]
    # those in the middle have not met the surface: the longest way is u t + 4.5 sqrt(2 D dt) steps
    longest = u * steps + 4.5 * math.sqrt(2.0 * D) * steps
    corners = surfaces(result.dump()[0])[1]
    far = np.min(np.linalg.norm(corners.mean(axis=1), axis=1)) - longest
    middle = (home == 1) & (np.linalg.norm(first[1], axis=1) < far)
    for some, mean in ((middle, u * steps * A), (home == 0, 0.0 * A)):
        assert some.sum() > 100
        error = math.sqrt(2.0 * D * steps / some.sum())
        assert np.abs(way[some].mean(axis=0) - mean).max() < 3.0 * error


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("topup", ["no", "yes"])
def test_daughters_share_or_are_filled_up(lmp, scenes, topup, np_):
    """Closed cells: nothing is lost; a daughter has what was in her half, or n."""
    scene = scenes.doublet(level=1, gap=0.3)
    deck = Deck(lmp, scenes, scene)
    result = lmp(
        deck(GOOD + f"topup {topup}", 60, before=cycle(scene), motion=scene.motion(options="")),
        np=np_,
        files=deck.files(),
    )
    frames = result.dump()
    right_places(frames)
    count = inside_of(frames[-1])
    assert len(count) == 4 and result.thermo[-1]["v_exits"] == 0
    if topup == "yes":
        assert set(count.values()) == {100}
    else:
        assert sum(count.values()) == 200
        # about half: five standard deviations of 100 throws, and a daughter is half of the volume
        # to a few parts in a hundred
        assert all(abs(n - 50) < 25 + 5 for n in count.values())


@pytest.mark.parametrize("death", ["delete", "release"])
@pytest.mark.parametrize("np_", [1, 2])
def test_conversion(lmp, scenes, death, np_):
    """A cell that becomes a sphere loses its tracers as if it died, and back in its deformable form
    is given n; those outside are pushed out of the new surface."""
    scene = scenes.doublet(level=1, gap=0.3)
    deck = Deck(lmp, scenes, scene, toward_origin)
    convert = (
        "neighbor 0.8 multi\n"
        "variable form atom (mol==1)+(mol==2)*(1-2*(step>=10)*(step<20))\n"
        "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_form every 10 "
        "mesh icosphere 1 rest 0.95\n"
    )
    scene.NAMES = scene.NAMES.replace("NULL", "hepatoblast_cbm", 1)
    result = lmp(
        deck(GOOD + f"death {death} topup yes", 30, before=convert,
             motion=scene.motion(options="")),
        np=np_, files=deck.files(),
    )  # fmt: skip
    frames = {frame.step: frame for frame in result.dump()}
    rows = {row["Step"]: row for row in result.thermo}
    for a in (1, 11, 21):
        right_places([frames[k] for k in range(a, a + 9)])
    _, x, home, _ = tracers(frames[20])  # the new surface, in the step in which it came
    inside = winding(x, surfaces(frames[20])[2]) > 0.5
    assert np.array_equal(inside[home != 1], home[home != 1] == 2)
    assert len(surfaces(frames[15])) == 1 and len(surfaces(frames[20])) == 2
    assert not (tracers(frames[15])[2] == 2).any()
    lost = inside_of(frames[9])[2]
    deleted = rows[11]["v_deleted"]
    if death == "delete":
        assert 0 < deleted <= lost
    else:
        assert deleted == 0
    total = [rows[k]["v_inside"] + rows[k]["v_outside"] for k in (9, 15, 25)]
    assert total == [200, 200 - deleted, 300 - deleted]
    assert inside_of(frames[20])[2] == 100


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_periodic_box(lmp, scenes, np_):
    """Cells on a corner of the box, tracers in and out across its sides."""
    scene = scenes.doublet(level=1, gap=0.3, boundary="p p p")
    deck = Deck(lmp, scenes, scene, toward_origin)
    shift = "displace_atoms all move 30 30 30\n"
    result = lmp(
        deck("number 500 D 0.1 seed 7 slits open", 60, before=shift), np=np_, files=deck.files()
    )
    frames = result.dump()
    right_places(frames, period=60.0)
    last = result.thermo[-1]
    assert last["v_inside"] + last["v_outside"] == 1000
    assert last["v_exits"] == last["v_outside"] > 20
    # both cells lie on two of the borders, the gap between them on the third
    for x in surfaces(frames[-1]).values():
        assert (x[..., 1:].min(axis=(0, 1)) < 30).all() and (x[..., 1:].max(axis=(0, 1)) > 30).all()


def test_periodic_ranks_agree(lmp, scenes):
    scene = scenes.doublet(level=1, gap=0.3, boundary="p p p")
    deck = Deck(lmp, scenes, scene, toward_origin)
    text = deck(
        "number 300 D 0.1 seed 7 slits open", 40, before="displace_atoms all move 30 30 30\n",
        motion="fix one all move linear 0.02 0.01 0.0\n", every=10,
    )  # fmt: skip
    one = lmp(text, files=deck.files()).dump()
    for np_ in (2, 4):
        for a, b in zip(one, lmp(text, files=deck.files(), np=np_).dump(), strict=True):
            for p, q in zip(tracers(a), tracers(b), strict=True):
                # moved across a border by a period, positions round differently
                assert np.abs(p - q).max() < 1e-9


def test_tiled_ranks(lmp, scenes):
    """LAMMPS cannot tell the owner of a new tracer on tiles."""
    scene = scenes.doublet(level=1, gap=0.3)
    deck = Deck(lmp, scenes, scene, toward_origin)
    tiles = "comm_style tiled\n"
    result = lmp.run(deck("number 300 D 0.1 seed 7 slits open", 60, before=tiles), np=2,
                     files=deck.files())  # fmt: skip
    assert "Fix dcm/tracer needs 'comm_style brick'" in result.error


# --- osmosis and signal ---------------------------------------------------------------------------


def distance(x, corners):
    """Distances of points (n, 3) from triangles (m, 3, 3) and which points are in front, (n, m)."""
    a, b, c = (corners[None, :, k] for k in range(3))
    p = x[:, None]
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    height = ((p - a) * normal).sum(axis=-1)
    flat = p - height[..., None] * normal
    within = np.ones(height.shape, bool)
    least = np.full(height.shape, np.inf)
    for s, e in ((a, b), (b, c), (c, a)):
        within &= (np.cross(e - s, flat - s) * normal).sum(axis=-1) >= 0.0
        t = np.clip(((p - s) * (e - s)).sum(axis=-1) / ((e - s) ** 2).sum(axis=-1), 0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(p - s - t[..., None] * (e - s), axis=-1))
    return np.where(within, np.abs(height), least), height >= 0.0


@pytest.mark.parametrize("np_", [1, 2, 4])
@pytest.mark.parametrize("range_", [1.2, 4.0])
def test_marks_by_tracers(lmp, scenes, np_, range_):
    """A ring of four cells around tracers: the free faces that one of them is near to and in front
    of are marked, all of them and no others; by distances computed here."""
    scene = scenes.Scene((28.0, 28.0, 16.0), "s s s", 1)
    d = 5.9 * math.sqrt(2)
    for k in range(4):
        phi = 0.1 + k * math.pi / 2
        scene.dcm(d * math.cos(phi), d * math.sin(phi), 0.0, 6.0, options=f"rotate {k + 1} rest 1")
    deck = Deck(lmp, scenes, scene)
    rng = np.random.default_rng(4)
    some = [(*(2.0 * rng.random(2) - 1.0), 6.0 * rng.random() - 3.0, 0) for _ in range(60)]
    osmosis = (
        f"fix osm all dcm/osmosis pressure 0.0 marks tracer range {range_} every 1\n"
        "compute f all dcm/face mark contact_area area\n"
    )
    columns = "id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6] c_f[1] c_f[2] c_f[3] xu yu zu"
    result = lmp(
        deck("number 0 D 0.05 seed 7", 0, motion=osmosis, dump=False)
        + scenes.dump(columns, 1) + "run 4\n",
        np=np_, files=deck.files(some),
    )  # fmt: skip
    frames = result.dump()  # nothing moves the cells
    expected = np.zeros(0)
    for frame in frames[1:]:
        kind = frame["c_p[1]"]
        face = np.flatnonzero(kind == FACE)
        place = {int(tag): n for n, tag in enumerate(frame["id"])}
        vertices = frame.vectors("c_p[2]", "c_p[3]", "c_p[4]")[face].astype(int)
        corners = frame.x[np.vectorize(place.get)(vertices)]
        _, x, home, host = tracers(frame)
        assert (home == 0).all() and (host == 0).all()
        far, front = distance(x, corners)
        # marks stay where they are; nothing here is close to the border of being free
        part = frame["c_f[2]"][face] / frame["c_f[3]"][face]
        near = ((far <= range_) & front).any(axis=0)
        if not len(expected):
            expected = np.zeros(len(face), bool)
        expected = (near & (part < 0.05)) | (expected & (part <= 0.5))
        assert np.array_equal(frame["c_f[1]"][face] == 1, expected), frame.step
    assert 4 < expected.sum() < len(expected) / 2


@pytest.mark.parametrize("np_", [1, 2])
def test_cells_that_differentiate_secrete(lmp, scenes, np_):
    """Cell 1 secretes; cell 2 has received its signal and divides: her daughters join the group in
    that step and are given n each."""
    scene = scenes.doublet(level=1, gap=0.2)
    deck = Deck(lmp, scenes, scene, toward_origin, more="hepatoblast hepatoblast hepatoblast")
    before = (
        "group bile molecule 1\n"
        + cycle(scene).replace("cycle_time 40", "cycle_time 40 cycle_sd 0")
        + ""
    )
    # signal stands after osmosis and tracers
    signal = "fix signal all dcm/signal from bile to 6 7 8 time 0 area 0.001 lumen no\n"
    result = lmp(
        deck(GOOD, 55, before=before, group="bile", motion=signal + scene.motion(options="")),
        np=np_, files=deck.files(),
    )  # fmt: skip
    frames = result.dump()
    right_places(frames)
    start, end = inside_of(frames[0]), inside_of(frames[-1])
    assert start == {1: 100, 2: 0} and len(end) == 4
    last = frames[-1]
    kind, types = last["c_p[1]"], last["type"]
    new = {int(m) for m in last["mol"][(kind == FACE) & (types == 8)]}
    old = {int(m) for m in last["mol"][(kind == FACE) & (types == 3)]}
    assert len(new) == 2 and len(old) == 2
    born = next(f for f in frames if new <= set(surfaces(f)))
    assert all(inside_of(born)[m] == 100 for m in new)
    # those of cell 1, which are in the group as well, share hers
    total = result.thermo[-1]["v_inside"] + result.thermo[-1]["v_outside"]
    assert total == 300


def test_comm_mode_multi(lmp, scenes):
    deck = Deck(lmp, scenes, scenes.doublet(level=1, gap=0.3))
    fails(
        lmp, deck(GOOD, 0, dump=False, before="comm_modify mode multi\n"),
        "Fix dcm/tracer needs 'comm_modify mode single'", run="run 1\n", files=deck.files(),
    )  # fmt: skip
