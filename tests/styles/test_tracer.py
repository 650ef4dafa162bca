"""fix dcm/tracer: no leaks in a moving, dividing tissue, judged by the solid angle; ranks and
restart to the last bit; neighbor lists as without tracers; the life of their cells; bad input."""

import numpy as np
import pytest

from support.bad_decks import fails
from support.tracers import NAMES, TYPE, Deck, right_places, same_tracers, surfaces, tracers

GOOD = "number 100 D 0.02 seed 7 "


def toward_origin(x, cell):
    """Faces that open on what is between two cells at x = -6 and 6, without the flat middle."""
    return abs(x[0]) < 2.5


@pytest.fixture
def doublet(lmp, scenes):
    return Deck(lmp, scenes, scenes.doublet(level=1, gap=0.3), toward_origin)


# two cells that swing along x, to and from each other: surfaces are the same on any number of ranks

SWING = (
    "group cells type 1 2 3\ngroup left molecule 1\ngroup right molecule 2\n"
    "fix one left move wiggle 0.3 0.05 0.02 40.0\nfix two right move wiggle -0.3 0.03 0.0 40.0\n"
)


def test_closed_cells_keep_them(lmp, scenes):
    deck = Deck(lmp, scenes, scenes.doublet(level=1, gap=0.3))
    result = lmp(deck(GOOD, 50), files=deck.files())
    frames = result.dump()
    right_places(frames)
    assert result.thermo[-1]["v_inside"] == 200 and result.thermo[-1]["v_exits"] == 0
    moved = np.linalg.norm(tracers(frames[-1])[1] - tracers(frames[0])[1], axis=1)
    assert (moved > 0.1).mean() > 0.9


def test_ranks_agree_to_the_last_bit(lmp, doublet):
    deck = doublet("number 500 D 0.1 seed 7 slits open", 100, motion=SWING, every=10)
    one = lmp(deck, files=doublet.files())
    last = one.thermo[-1]
    assert last["v_exits"] > 20 and last["v_swept"] > 20 and last["v_outside"] > 20
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_, files=doublet.files())
        for a, b in zip(one.dump(), other.dump(), strict=True):
            same_tracers(a, b)
        for name in NAMES:
            assert other.thermo[-1][f"v_{name}"] == last[f"v_{name}"], name


@pytest.mark.parametrize("np_", [1, 4])
def test_swinging_cells_do_not_leak(lmp, doublet, np_):
    result = lmp(
        doublet("number 500 D 0.1 seed 3", 100, motion=SWING), np=np_, files=doublet.files()
    )
    right_places(result.dump())
    assert result.thermo[-1]["v_outside"] > 20


def test_gap_closes_on_a_thousand(lmp, scenes):
    """Cells of 642 nodes 0.1 um apart close on tracers in the gap, overlap, and part again."""
    deck = Deck(lmp, scenes, scenes.doublet(level=3, gap=0.1))
    rng = np.random.default_rng(3)
    # within 0.9 um of the axis the two spheres are 0.1 to 0.24 um apart
    r, phi = 0.9 * np.sqrt(rng.random(1000)), 2 * np.pi * rng.random(1000)
    some = [
        (0.06 * (u - 0.5), a * np.cos(b), a * np.sin(b), 0)
        for a, b, u in zip(r, phi, rng.random(1000), strict=True)
    ]
    swing = SWING.replace("0.3 0.05 0.02", "0.15 0.0 0.0").replace("-0.3 0.03 0.0", "-0.15 0.0 0.0")
    result = lmp(
        deck("number 0 D 1e-4 seed 7 slits open", 40, motion=swing), files=deck.files(some)
    )
    frames = result.dump()
    for n in (6, 11, 40):
        right_places(frames[n - 1 : n + 1])
    last = result.thermo[-1]
    assert last["v_swept"] > 1000  # most are squeezed out sideways; the rest is caught and let free
    assert last["v_caught"] == 0 and last["v_outside"] == 1000


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_to_the_last_bit(lmp, scenes, np_):
    """Also of tracers that are caught."""
    deck = Deck(lmp, scenes, scenes.doublet(level=1, gap=0.1), toward_origin)
    some = [(0.001 * k, 0.1, 0.1, 0) for k in range(-20, 20)]
    text = "number 200 D 0.05 seed 7"
    whole = lmp(
        deck(text, 40, motion=SWING, every=5, after="restart 10 r.*\n"),
        np=np_,
        files=deck.files(some),
    )
    frames = whole.dump()
    assert np.count_nonzero(tracers(frames[2])[3]) > 0
    head = deck.head("read_restart r.10\n")
    rest = lmp(
        deck(text, 30, head=head, motion=SWING, every=5, after="restart 10 r.*\n"),
        np=np_,
        files={"r.10": whole.path / "r.10"},
    )
    for a, b in zip(frames[2:], rest.dump(), strict=True):
        same_tracers(a, b)
    for name in NAMES:
        assert rest.thermo[-1][f"v_{name}"] == whole.thermo[-1][f"v_{name}"], name


def test_neighbor_lists_do_not_notice(lmp, doublet):
    """As many rebuilds and ghosts with tracers as without."""

    def count(result, what):
        line = next(line for line in result.log.splitlines() if line.startswith(what))
        return line.split()[-1] if "builds" in what else line.split()[1]

    swing = SWING.replace("40.0", "80.0")
    a = lmp(doublet("", 80, motion=swing, dump=False), files=doublet.files())
    b = lmp(doublet("number 500 D 0.1 seed 7", 80, motion=swing, dump=False), files=doublet.files())
    assert count(a, "Neighbor list builds") == count(b, "Neighbor list builds") != "0"
    assert count(a, "Total # of neighbors") == count(b, "Total # of neighbors")
    a = lmp(doublet("", 1, dump=False), files=doublet.files(), np=2)
    b = lmp(doublet("number 500 D 0.1 seed 7", 1, dump=False), files=doublet.files(), np=2)
    assert count(a, "Nghost:") == count(b, "Nghost:")


def test_later_members_of_the_group(lmp, doublet):
    result = lmp(
        doublet(GOOD, 5, before="group secreting molecule 1\n", group="secreting")
        + "group secreting molecule 2\nrun 5\n",
        files=doublet.files(),
    )
    first, last = result.thermo[0], result.thermo[-1]
    assert [row["v_inside"] + row["v_outside"] for row in (first, last)] == [100, 200]
    frames = result.dump()
    assert set(tracers(frames[4])[2]) <= {0, 1} and 2 in tracers(frames[-1])[2]
    right_places(frames[:6])


@pytest.mark.parametrize("death", ["delete", "release"])
def test_death(lmp, doublet, death):
    kill = (
        "group two molecule 2\nvariable dies atom step>3\nfix death two dcm/death variable v_dies\n"
    )
    result = lmp(doublet(GOOD + f"death {death}", 8, before=kill), files=doublet.files())
    last = result.thermo[-1]
    total = last["v_inside"] + last["v_outside"]
    assert last["v_deleted"] == (100 if death == "delete" else 0)
    assert total == 200 - last["v_deleted"]
    assert not (tracers(result.dump()[-1])[2] == 2).any()


def test_slab(lmp, doublet):
    result = lmp(doublet(GOOD.replace("0.02", "0.1") + "slab z -2 2", 30), files=doublet.files())
    for frame in result.dump():
        assert np.abs(tracers(frame)[1][:, 2]).max() <= 2.0 + 1e-6


@pytest.mark.parametrize("far", ["delete", "reflect"])
def test_far(lmp, doublet, far):
    """Tracers that begin outside, 4 um and more from the cells."""
    some = [(0.0, 16.0 + 0.1 * k, 0.0, 0) for k in range(10)]
    result = lmp(doublet(f"number 0 D 0.5 seed 1 far 11 {far}", 60), files=doublet.files(some))
    last = result.thermo[-1]
    if far == "delete":
        assert last["v_deleted"] > 0 and last["v_deleted"] + last["v_outside"] == 10
    else:
        assert last["v_outside"] == 10
        # the plane is 11 above the highest node of one of the looks; some begin above it
        frames = result.dump()
        nodes = max(x[..., 1].max() for frame in frames for x in surfaces(frame).values())
        begun = tracers(frames[0])[1][:, 1].max()
        assert tracers(frames[-1])[1][:, 1].max() <= max(nodes + 11, begun)


def test_data_file_keeps_places_and_homes(lmp, doublet):
    first = lmp(doublet(GOOD, 20) + "write_data y.data nofix nocoeff\n", files=doublet.files())
    again = lmp(
        doublet(GOOD, 0, head=doublet.head().replace("x.data", "y.data")) + "run 0\n",
        files={"y.data": first.path / "y.data"},
    )
    a, b = tracers(first.dump()[-1]), tracers(again.dump()[0])
    for one, other in zip(a, b, strict=True):  # IDs, places, homes, hosts
        assert np.array_equal(one, other[: len(one)])
    # cells that have lost some are filled up
    assert again.thermo[0]["v_inside"] == 200 and again.thermo[0]["v_outside"] > 0


@pytest.mark.parametrize("np_", [1, 4])
def test_dividing_tissue(lmp, scenes, np_):
    scene = scenes.doublet(level=1, gap=0.3)
    deck = Deck(lmp, scenes, scene, toward_origin)
    life = (
        f"fix grow all dcm/growth {scene.map} seed 5 cycle_time 40\n"
        "fix divide all dcm/division seed 7\n"
    )
    result = lmp(
        deck("number 300 D 0.05 seed 3", 60, before=life, motion=scene.motion(options="")),
        np=np_,
        files=deck.files(),
    )
    frames = result.dump()
    assert len(surfaces(frames[-1])) == 4
    right_places(frames)
    last = result.thermo[-1]
    assert last["v_inside"] + last["v_outside"] == 600 and last["v_exits"] > 0


@pytest.mark.parametrize("text, message", [
    ("D 0.1 seed 1", "Fix dcm/tracer: keyword number is missing"),
    ("number 5 seed 1", "Fix dcm/tracer: keyword D is missing"),
    ("number 5 D 0.1", "Fix dcm/tracer: keyword seed is missing"),
    ("number -1 D 0.1 seed 1", "Fix dcm/tracer: number is -1"),
    (GOOD.replace("D 0.02", "D -0.1"), "Fix dcm/tracer: D is -0.1"),
    (GOOD + "x 1", "Fix dcm/tracer: unknown keyword x"),
    (GOOD + "slab z 2 1", "Fix dcm/tracer: slab is .*1.*above its low end, 2"),
    (GOOD + "slab z 100 200", "slab z 100 200 lies outside the box"),
    (GOOD + "slits x", "slits must be shut or open"),
    (GOOD + "far 3 x", "must be delete or reflect"),
    (GOOD + "death x", "death must be delete or release"),
    (GOOD + "free 1.5", "free is 1.5, must be below 1"),
    (GOOD + "drift 0.1", "Fix dcm/tracer: drift is along the polarity.*fix dcm/polarity"),
    (GOOD + "D 0.1", "Fix dcm/tracer: keyword D is there twice"),
])  # fmt: skip
def test_bad_keywords(lmp, doublet, text, message):
    fails(lmp, doublet(text, 0, dump=False), message, files=doublet.files(), run="run 1\n")


def test_bad_type(lmp, doublet):
    deck = doublet(GOOD, 0, dump=False).replace(f"dcm/tracer type {TYPE}", "dcm/tracer type 2")
    fails(lmp, deck, "atom type 2 holds atoms that are no tracers", files=doublet.files())


def test_bad_decks(lmp, doublet):
    def bad(deck, *patterns, tracers=(), **options):
        fails(lmp, deck, *patterns, run="run 1\n", files=doublet.files(tracers), **options)

    bad(
        doublet(
            "",
            0,
            dump=False,
            motion=doublet.scene.motion() + f"fix tracer all dcm/tracer type {TYPE} {GOOD}\n",
        ),
        "stands after fix motion .dcm/motion.",
    )
    bad(
        doublet(GOOD, 0, dump=False, before=f"fix t all dcm/tracer type {TYPE} {GOOD}\n"),
        "there is one already .ID t",
    )
    bad(
        doublet(GOOD, 0, dump=False),
        "tracer .* has home 9, but there is no deformable cell 9",
        tracers=[(6.0, 0.0, 0.0, 9)],
    )
    bad(
        doublet(GOOD, 0, dump=False),
        "has home 2 but is .* outside that cell",
        tracers=[(-6.0, 0.0, 0.0, 2)],
    )
    bad(
        doublet(GOOD, 0, dump=False),
        "home 0 .outside. but is .* deep in cell 1",
        tracers=[(-6.0, 0.0, 0.0, 0)],
    )
    bad(
        doublet(GOOD.replace("0.02", "10"), 0, dump=False),
        "with D 10 and a timestep of 1",
        "comm_modify cutoff",
        np=2,
    )
    bad(
        doublet(GOOD, 0, dump=False) + "set type 5 mol 1\n",
        "Fix dcm/tracer: tracer .* has molecule ID 1, must be 0",
        tracers=[(-6.0, 0.0, 0.0, 1)],
    )
    named = doublet(GOOD, 0, dump=False).replace("NULL NULL", "NULL hepatoblast", 4)
    bad(named, "atom type 5 of tracers has a cell type in pair_coeff")


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_cells_at_rest_with_far_ghosts(lmp, scenes, np_):
    """Ghosts reach so far that vertices of the last faces are other periodic images: such faces,
    stretched across the box, are no walls. Nothing moves, so nothing is swept over."""
    scene = scenes.Scene(24.0, "p p p", 1)
    scene.dcm(-8.4, -1.4, 1.0, 5.9)
    scene.dcm(3.4, -1.4, 1.0, 5.8)
    deck = Deck(lmp, scenes, scene)
    text = deck("number 100 D 0.02 seed 5", 3, before="comm_modify cutoff 30\n", motion="\n")
    text = text.replace("timestep 1.0", "timestep 0.005")
    data = deck.data().replace("-30 30", "-24 24")
    result = lmp(text, np=np_, files={"x.data": data})
    right_places(result.dump())
    row = result.thermo[-1]
    assert row["v_inside"] == 200 and row["v_swept"] == row["v_exits"] == row["v_blocked"] == 0
