"""Polarity of deformable cells: apical and polar vectors, regions of faces, their heredity."""

import numpy as np
import pytest

from support.bad_decks import fails, lines_of_error, whole
from support.cycle_decks import growth, same
from support.divisions import read_log

LATERAL, POLAR, APICAL, JUNCTION, BASAL = range(5)  # numbers of doc page atom_style_dcm
CENTER, NODE, FACE = 2, 3, 4
SEEN = "c_c[1] c_c[2] c_c[3] c_c[4] c_c[5] c_c[6] c_c[7] c_c[8]"
COLUMNS = f"id mol type c_k c_f[1] c_f[2] c_f[3] {SEEN} xu yu zu vx vy vz fx fy fz"
THETA = 0.05  # default of keyword free


def polarity(options="", group="all", name="polarity"):
    return f"fix {name} {group} dcm/polarity seed 11 {options}\n"


def outputs(scenes, every=1):
    return (
        "timestep 1.0\n"
        "compute k all property/atom kind\n"
        "compute f all dcm/face area contact_area region\n"
        "compute c all dcm/cell ax ay az px py pz apical_area junction_area\n"
        + scenes.dump(COLUMNS, every)
        + "thermo_style custom step atoms"
        + "".join(f" f_polarity[{k}]" for k in range(1, 6))
        + f"\nthermo_modify norm no format float %.17g\nthermo {every}\n"
    )


def deck_of(scene, scenes, options="", *, before="", extra="", motion=None, every=1):
    """All laws, polarity before motion, a dump of vectors and regions."""
    return (
        scene.head()
        + scene.forces()
        + before
        + polarity(options)
        + (scene.motion() if motion is None else motion)
        + extra
        + outputs(scenes, every)
    )


class Seen:
    """What a frame says of one cell."""

    def __init__(self, frame, molecule=1):
        mine = frame["mol"] == molecule
        face, node = mine & (frame["c_k"] == FACE), mine & (frame["c_k"] == NODE)
        center = mine & (frame["c_k"] == CENTER)
        self.A = frame.vectors("c_c[1]", "c_c[2]", "c_c[3]")[center][0]
        self.P = frame.vectors("c_c[4]", "c_c[5]", "c_c[6]")[center][0]
        self.apical_area, self.junction_area = (frame[f"c_c[{k}]"][center][0] for k in (7, 8))
        self.area, self.contact = frame["c_f[1]"][face], frame["c_f[2]"][face]
        self.region = frame["c_f[3]"][face].astype(int)
        self.center = frame.x[node].mean(axis=0)
        d = frame.x[face] - self.center
        self.N = d / np.linalg.norm(d, axis=1)[:, None]

    def free_direction(self, weights=None):
        """The normalized sum of N over free faces, and its length."""
        free = self.contact < THETA * self.area
        total = (self.N[free] * (1.0 if weights is None else weights[free, None])).sum(axis=0)
        return total / np.linalg.norm(total), np.linalg.norm(total)

    def cones(self, A, P, polar=0.7, apical=0.7, basal=0.7, ribbon=(2.0, 2.0)):
        """Regions by the definitions."""
        up, along = self.N @ A, np.abs(self.N @ P)
        ribbon = (up > ribbon[0]) & (up < ribbon[1])
        return np.select(
            [ribbon, up > apical, along > polar, up < -basal], [JUNCTION, APICAL, POLAR, BASAL]
        )

    def check(self):
        assert abs(np.linalg.norm(self.A) - 1.0) < 4e-16
        assert abs(np.linalg.norm(self.P) - 1.0) < 4e-16
        assert abs(self.A @ self.P) < 1e-15
        return self


def unit(*v):
    return np.array(v, dtype=float) / np.linalg.norm(v)


# --- vectors and regions --------------------------------------------------------------------------


def test_step_0(lmp, scenes):
    """Given vectors and the regions of the cones are there before the first forces."""
    scene = scenes.single_cell(level=2)
    options = "init toward 30 10 -20 polar 0.6 apical 0.5 basal 0.8 junction 0.2 0.5"
    result = lmp(deck_of(scene, scenes, options) + "run 0\n")
    cell = Seen(result.dump()[0]).check()
    assert np.allclose(cell.A, unit(*(np.array([30, 10, -20]) - cell.center)), atol=1e-12)
    expected = cell.cones(cell.A, cell.P, 0.6, 0.5, 0.8, (0.2, 0.5))
    assert np.array_equal(cell.region, expected)
    assert set(expected) == {LATERAL, POLAR, APICAL, JUNCTION, BASAL}
    for region, area, column in ((APICAL, cell.apical_area, 2), (JUNCTION, cell.junction_area, 3)):
        total = cell.area[cell.region == region].sum()
        assert abs(area / total - 1.0) < 1e-9
        assert result.thermo[0][f"f_polarity[{column}]"] == area
    assert result.thermo[0]["f_polarity[1]"] == 1.0


def test_belt(lmp, scenes):
    scene = scenes.single_cell(level=2)
    options = "init toward 0 0 50 form belt polar 0.4 basal none"
    cell = Seen(lmp(deck_of(scene, scenes, options) + "run 0\n").dump()[0])
    up, along = cell.N @ cell.A, np.abs(cell.N @ cell.P)
    assert np.array_equal(cell.region == APICAL, up > 0.7)
    assert np.array_equal(cell.region == POLAR, (up <= 0.7) & (along < 0.4))
    assert set(cell.region) == {LATERAL, POLAR, APICAL}


@pytest.mark.parametrize("level, nodes", [(2, 162), (3, 642), (4, 2562)])
def test_ribbon_at_every_mesh(lmp, scenes, level, nodes):
    """junction auto: by area one to two rows of faces (0.87 edges high) thick; no apical face has an
    edge in common with one below the ribbon.
    """
    scene = scenes.single_cell(level=level)
    text = deck_of(scene, scenes, "init variable v_a v_b v_b apical 0.8 junction auto polar 0.99",
                   before="variable a atom 1\nvariable b atom 0.3\n")  # fmt: skip
    text += "compute v all property/atom vertex1 vertex2 vertex3\n"
    text += "dump v all custom 1 v.txt id mol c_k c_v[*]\nrun 0\n"
    result = lmp(text)
    cell, frame = Seen(result.dump()[0]), result.dump("v.txt")[0]
    face = frame["c_k"] == FACE
    assert (frame["c_k"] == NODE).sum() == nodes
    vertices = frame.vectors("c_v[1]", "c_v[2]", "c_v[3]")[face].astype(int)
    edges = {}
    for f, v in enumerate(vertices):
        for k in range(3):
            edges.setdefault(frozenset((v[k], v[k - 1])), []).append(f)
    for pair in edges.values():
        regions = {cell.region[f] for f in pair}
        assert not (APICAL in regions and regions - {APICAL, JUNCTION})
    where = {int(tag): n for n, tag in enumerate(result.dump()[0]["id"])}
    x = result.dump()[0].x
    edge = np.mean([np.linalg.norm(np.subtract(*(x[where[v]] for v in e))) for e in edges])
    angle = np.arccos(0.8) + 0.6 * edge / 6.0  # middle of the ribbon
    rows = cell.junction_area / (2 * np.pi * 6.0 * np.sin(angle)) / (np.sqrt(0.75) * edge)
    assert 1.0 < rows < 2.0


def test_doublet(lmp, scenes):
    """A is the direction of the free faces of the step before, along the axis and away from the
    other cell; regions follow it.
    """
    scene = scenes.doublet(level=2)
    frames = lmp(deck_of(scene, scenes, "init random every 1") + "run 12\n").dump()
    for before, now in zip(frames[:-1], frames[1:], strict=True):
        for molecule, side in ((1, -1.0), (2, 1.0)):
            old, cell = Seen(before, molecule), Seen(now, molecule).check()
            expected, _ = old.free_direction()
            assert np.allclose(cell.A, expected, atol=1e-8)
            # unless more faces of the rim of the contact are free on one side than on the other
            assert cell.A[0] * side > np.cos(6.0 / old.free_direction()[1])
            assert np.array_equal(cell.region, old.cones(cell.A, cell.P))
            if before.step > 0:  # P keeps what is perpendicular to A
                rest = old.P - (old.P @ cell.A) * cell.A
                assert np.allclose(cell.P, rest / np.linalg.norm(rest), atol=1e-12)


def test_weight_area(lmp, scenes):
    scene = scenes.doublet(level=1)
    frames = lmp(deck_of(scene, scenes, "weight area every 1") + "run 2\n").dump()
    old, cell = Seen(frames[1]), Seen(frames[2])
    expected, _ = old.free_direction(old.area - old.contact)
    assert np.allclose(cell.A, expected, atol=1e-8)
    assert not np.allclose(cell.A, old.free_direction()[0], atol=1e-6)


def test_every(lmp, scenes):
    """Between looks, which are at multiples of N, nothing changes; the first step is a look."""
    scene = scenes.doublet(level=1)
    frames = lmp(deck_of(scene, scenes, "init toward 0 40 0 every 4") + "run 9\n").dump()
    seen = [Seen(frame) for frame in frames]
    changed = [
        now.step
        for now, a, b in zip(frames[1:], seen[:-1], seen[1:], strict=True)
        if not np.array_equal(a.A, b.A)
    ]
    assert changed == [1, 4, 8]


def test_init_free(lmp, scenes):
    """No vector and no region before the first look, then that of the free faces."""
    scene = scenes.doublet(level=1)
    result = lmp(deck_of(scene, scenes, "init free every 5") + "run 5\n")
    first, second = Seen(result.dump()[0]), Seen(result.dump()[1]).check()
    assert not first.A.any() and not first.P.any() and set(first.region) == {LATERAL}
    assert np.allclose(second.A, first.free_direction()[0], atol=1e-8)
    assert [row["f_polarity[1]"] for row in result.thermo] == [0, 2, 2, 2, 2, 2]


def test_kept_if_free_all_around(lmp, scenes):
    """A sum that vanishes says nothing."""
    scene = scenes.single_cell(level=2)
    frames = lmp(deck_of(scene, scenes, "init toward 10 20 30 every 1") + "run 5\n").dump()
    cells = [Seen(frame) for frame in frames]
    for old, cell in zip(cells[:-1], cells[1:], strict=True):
        assert old.free_direction()[1] < 0.5
        assert np.array_equal(cell.A, cells[0].A) and np.array_equal(cell.P, cells[0].P)


def test_kept_without_free_face(lmp, scenes):
    """A cell with a sphere before each of its faces."""
    nodes, faces = scenes.icosphere(1)
    scene = scenes.Scene(20.0, "f f f")
    scene.dcm(0.0, 0.0, 0.0, 6.0, options="rest 1")
    middle = 6.0 * nodes[faces].mean(axis=1)
    for x in middle + 1.2 * middle / np.linalg.norm(middle, axis=1)[:, None]:
        scene.cbm(*x, 1.3)
    text = deck_of(scene, scenes, "init toward 0 0 90 every 1", motion="")
    result = lmp(text + "run 3\n")
    for frame in result.dump():
        cell = Seen(frame)
        assert (cell.contact > THETA * cell.area).all()
        assert np.allclose(cell.A, [0.0, 0.0, 1.0], atol=1e-12)
    assert [row["f_polarity[5]"] for row in result.thermo] == [0, 1, 1, 1]


def test_turned(lmp, scenes):
    """Vectors that turn by more than 30 degrees in a look are counted."""
    scene = scenes.doublet(level=1)
    # the left cell turns by 90 degrees in step 1, the right one by much less
    result = lmp(deck_of(scene, scenes, "init toward 6 60 0 every 1") + "run 3\n")
    angles = [np.degrees(np.arccos(Seen(result.dump()[0], m).A @ Seen(result.dump()[1], m).A))
              for m in (1, 2)]  # fmt: skip
    counts = [row["f_polarity[4]"] for row in result.thermo]
    assert counts[:3] == [0, sum(angle > 30.0 for angle in angles), 0]
    assert counts[1] > 0


@pytest.mark.parametrize("axis", range(3))
def test_plane(lmp, scenes, axis):
    """In a planar scene nothing points out of it, and P is one of the two ways along it."""
    scene = scenes.hybrid(level=1, boundary="f f f", box=26.0)
    name = "xyz"[axis]
    frames = lmp(deck_of(scene, scenes, f"plane {name} every 1") + "run 4\n").dump()
    for frame in frames:
        for molecule in (1, 2, 3):
            cell = Seen(frame, molecule).check()
            assert cell.A[axis] == 0.0 and cell.P[axis] == 0.0
            side = np.cross(np.eye(3)[axis], cell.A)
            assert np.array_equal(cell.P, side) or np.array_equal(cell.P, -side)
    for molecule in (1, 2, 3):  # P does not jump from the one to the other
        p = [Seen(frame, molecule).P for frame in frames[1:]]
        assert all(a @ b > 0 for a, b in zip(p[:-1], p[1:], strict=True))


# --- groups ---------------------------------------------------------------------------------------


def test_two_fixes(lmp, scenes):
    """Each its own cells; others have neither vector nor region."""
    scene = scenes.hybrid(level=1, boundary="f f f", box=26.0)
    groups = "group one molecule 1\ngroup two molecule 2\n"
    text = deck_of(scene, scenes, "").replace(
        polarity(""),
        groups
        + polarity("init toward 0 0 90", "one")
        + polarity("init toward 90 0 0 apical 0.3 every 1", "two", "second"),
    )
    frames = lmp(text + "run 2\n").dump()
    one, two, three = (Seen(frames[0], m) for m in (1, 2, 3))
    assert one.A[2] > 0.99 and two.A[0] > 0.99
    assert np.array_equal(one.region, one.cones(one.A, one.P))
    assert np.array_equal(two.region, two.cones(two.A, two.P, apical=0.3, basal=0.3))
    for frame in frames:
        three = Seen(frame, 3)
        assert not three.A.any() and not three.P.any() and set(three.region) == {LATERAL}


def test_leaving_and_joining(lmp, scenes):
    """A cell that joins the group gets its vectors in the next step, one that leaves loses them."""
    scene = scenes.doublet(level=1)
    text = deck_of(scene, scenes, "").replace(
        polarity(""), "group some molecule 1\n" + polarity("init toward 0 80 0 every 10", "some")
    )
    text += "run 2\ngroup some clear\ngroup some molecule 2\nrun 2\n"
    result = lmp(text)
    frames = result.dump()
    assert [frame.step for frame in frames] == [0, 1, 2, 3, 4]
    assert Seen(frames[2], 1).A.any() and not Seen(frames[2], 2).A.any()
    old, new = Seen(frames[3], 1), Seen(frames[3], 2).check()
    assert not old.A.any() and not old.P.any() and set(old.region) == {LATERAL}
    assert old.apical_area == 0.0
    assert new.A[1] > 0.9 and APICAL in new.region
    assert result.thermo[-1]["f_polarity[1]"] == 1.0


# --- cells that divide or change their form -------------------------------------------------------


def dividing(scenes, options="", *, cycle=30, plane="polarity", rounding="rounding 0.2 0.98"):
    scene = scenes.single_cell(level=1, boundary="f f f", box=20.0, options="rotate 3 rest 1")
    scene.NAMES = scene.NAMES.replace("hepatoblast_cbm", "NULL")
    before = growth(scene, f"cycle_time {cycle} {rounding}")
    before += f"fix divide all dcm/division seed 7 plane {plane} log div.log\n"
    return scene, before, deck_of(
        scene, scenes, "init toward 5 20 60 freeze 5 every 1 " + options, before=before
    )


def test_division(lmp, scenes):
    """Daughters lie along P of the mother, have her A and P, and keep A for the given time."""
    _, _, text = dividing(scenes)
    result = lmp(text + "run 45\n")
    (row,) = read_log(result.path)
    frames = {frame.step: frame for frame in result.dump()}
    born = row["step"]
    mother = Seen(frames[born - 1])
    assert np.allclose(row["axis"], mother.P, atol=1e-8)
    last = born + 5 - 1  # looks before the time is over
    for step in range(born, last + 1):
        for molecule in row["daughters"]:
            cell = Seen(frames[step], molecule).check()
            assert np.array_equal(cell.A, mother.A) and np.array_equal(cell.P, mother.P)
    for molecule, side in zip(row["daughters"], (1.0, -1.0), strict=True):
        cell = Seen(frames[last + 1], molecule)
        assert np.allclose(cell.A, Seen(frames[last], molecule).free_direction()[0], atol=1e-8)
        assert side * (cell.A @ row["axis"]) > 0.9  # away from the sister
    assert result.thermo[-1]["f_polarity[1]"] == 2.0


def test_division_of_cells_without_polarity(lmp, scenes):
    """plane polarity without a vector is a random plane, that of plane random."""
    axes = []
    for plane in ("polarity", "random"):
        _, _, text = dividing(scenes, plane=plane)
        text = text.replace("fix polarity all", "group none empty\nfix polarity none")
        (row,) = read_log(lmp(text + "run 31\n").path)
        axes.append(row["axis"])
    assert np.array_equal(axes[0], axes[1])


def test_frozen_while_rounding(lmp, scenes):
    """Cells that touch while they round up keep their vectors; others turn."""
    found = {}
    for cycle in (0, 60):
        scene = scenes.doublet(level=1, gap=6.0, boundary="f f f", box=25.0)
        scene.NAMES = scene.NAMES.replace("hepatoblast_cbm", "NULL")
        before = growth(scene, f"cycle_time {cycle} rounding 0.5 0.98") if cycle else ""
        text = deck_of(scene, scenes, "init toward 0 0 90 every 1", before=before)
        text += "group left molecule 1\nrun 32\ndisplace_atoms left move 5 0 0\n"
        text += "variable gap equal 0\n" if not cycle else ""
        frames = lmp(text + "run 4\n").dump()
        first, last = Seen(frames[0]), Seen(frames[-1])
        assert last.contact.sum() > 1.0
        found[cycle] = np.array_equal(first.A, last.A)
    assert found == {0: False, 60: True}


def test_conversion(lmp, scenes):
    """A sphere has no polarity; deformable again, the cell begins anew."""
    scene = scenes.single_cell(level=1, boundary="f f f", box=20.0)
    before = (
        "variable form atom ternary(step<5,1,ternary(step<10,-1,1))\n"
        "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_form every 5 "
        "mesh icosphere 1\n"
    )
    text = deck_of(scene, scenes, "init toward 0 60 0 every 50", before=before)
    text = text.replace("neighbor 0.6", "neighbor 1.0") + "run 12\n"
    frames = {frame.step: frame for frame in lmp(text).dump()}
    for step, frame in frames.items():
        kinds = set(frame["c_k"])
        if step < 5 or step > 10:
            cell = Seen(frame).check()
            assert cell.A[1] > 0.99
            assert np.array_equal(cell.region == APICAL, cell.N @ cell.A > 0.7)
        elif step < 10:
            assert kinds == {1.0}
            assert not frame.vectors("c_c[1]", "c_c[2]", "c_c[3]").any()
        else:
            assert not Seen(frame).A.any() and set(Seen(frame).region) == {LATERAL}


# --- processes and restart ------------------------------------------------------------------------


def tissue(scenes):
    return scenes.hybrid(level=1, boundary="p p p", box=(26.0, 26.0, 13.0), shift=(3.0, 2.0, 0.5))


@pytest.mark.parametrize("options", ["init random junction auto", "init free weight area plane z"])
def test_ranks_agree(lmp, scenes, options):
    """Regions of all faces are the same, and vectors to the tolerance of the solver."""
    text = deck_of(tissue(scenes), scenes, options + " every 2", every=5) + "run 20\n"
    found = [lmp(text, np=np_).dump() for np_ in (1, 2, 3, 4)]
    for frames in found[1:]:
        for a, b in zip(found[0], frames, strict=True):
            assert np.array_equal(a["c_f[3]"], b["c_f[3]"])
            for name in SEEN.split():
                assert np.allclose(a[name], b[name], atol=1e-8)
    assert {APICAL, POLAR} <= set(found[0][-1]["c_f[3]"].astype(int))


@pytest.mark.parametrize("np_", [1, 2])
def test_restart(lmp, scenes, np_):
    """From step 7, between two looks, and from step 0."""
    text = "processors * 1 1\n" + deck_of(
        tissue(scenes), scenes, "init random junction auto every 5"
    )
    for at, steps in ((7, 20), (0, 6)):
        tail = f"restart {at} r.*\n" if at else "run 0\nwrite_restart r.0\n"
        straight = lmp(text + tail + f"run {steps}\n", np=np_)
        old = {frame.step: frame for frame in straight.dump()}
        for frame in continued(lmp, text, tissue(scenes), straight, at, steps, np_).dump()[1:]:
            same(old[frame.step], frame, COLUMNS)
        assert set(frame["c_f[3]"].astype(int)) >= {APICAL, JUNCTION}


def continued(lmp, text, scene, straight, at, steps, np_=1):
    """A run that goes on from the restart file of another one at step `at`."""
    text = text.replace(scene.head(), f"read_restart r.{at}\n").replace(scene.cortex(), "")
    text = text.replace("pair_style dcm/contact \n", "")
    text += f"restart {at} r.*\n" if at else ""  # lists are rebuilt where a restart is written
    files = {f"r.{at}": straight.path / f"r.{at}"}
    return lmp(text + f"run {steps - at}\n", np=np_, files=files)


@pytest.mark.parametrize("at", [24, 30, 32, 35])
def test_restart_of_a_dividing_cell(lmp, scenes, at):
    """In the mother's rounding up, in the step of the division, while her daughters' vectors stay,
    and at the end of that time.
    """
    scene, _, text = dividing(scenes)
    straight = lmp(text + f"restart {at} r.*\nrun 42\n")
    (row,) = read_log(straight.path)
    assert row["step"] == 30
    old = {frame.step: frame for frame in straight.dump()}
    for frame in continued(lmp, text, scene, straight, at, 42).dump()[1:]:
        same(old[frame.step], frame, COLUMNS)
    turned = [Seen(old[step], row["daughters"][0]).A for step in (34, 35, 42)]
    assert np.array_equal(turned[0], Seen(old[29]).A) and not np.array_equal(turned[0], turned[2])


# --- bad input ------------------------------------------------------------------------------------

BAD = {
    # keywords, pattern
    "polar 0": "polar is 0, must be above 0 and below 1",
    "polar 1": "polar is 1, must be above 0 and below 1",
    "apical 1.2": "apical is 1.2, must be above 0 and below 1",
    "basal -0.3": "basal is -0.3, must be above 0 and below 1",
    "free 1": "free is 1, must be above 0 and below 1",
    "apical high": "apical is 'high', expected a number",
    "junction 0.5 0.5": "junction is 0.5 0.5, an empty ribbon; the first cosine must be below",
    "junction 0.5 0.1": "junction is 0.5 0.1, an empty ribbon",
    "junction 0.5 1.0": "junction is 1.0, must be two cosines above -1 and below 1, auto or none",
    "form ring": "form must be cone or belt, not ring",
    "weight mass": "weight must be count or area, not mass",
    "plane w": "plane must be none, x, y or z, not w",
    "init up": "init must be random, free, toward x y z or variable v_x v_y v_z, not up",
    "init toward 1 2": "init",
    "init variable 1 2 3": "init is 1, expected an atom-style variable v_NAME",
    "init variable v_a v_a v_none": "there is no atom-style variable none",
    "freeze -1": "freeze is -1, must be zero or positive",
    "every 0": "every.*0",
    "seeds 3": "unknown keyword seeds; known: seed polar form apical",
    "init variable v_o v_o v_o": "init variable gives cell 1 the apical vector 0 0 0 at step 0",
    "init variable v_a v_a v_a plane z": "1 1 1 at step 0, not perpendicular to z; remove plane z",
}


@pytest.mark.parametrize("case", BAD)
def test_bad_keywords(lmp, scenes, case):
    variables = "variable a atom 1.0\nvariable o atom 0.0\n"
    deck = whole(scenes.single_cell(), extra=variables + polarity(case))
    fails(lmp, deck, "Fix dcm/polarity: .*" + BAD[case])


def test_bad_toward_own_center(lmp, scenes):
    """A cell that lies at the point, or above it in a planar scene, has no direction to it."""
    scene = scenes.single_cell(options="rest 1")
    for options in ("init toward 0 0 5 plane z", "init toward 0 0 0"):
        deck = whole(scene, extra=polarity(options))
        fails(lmp, deck, "Fix dcm/polarity: init toward gives cell 1 the apical vector")


def test_bad_decks(lmp, scenes):
    scene = scenes.single_cell()
    fix = polarity("")
    style = "Fix dcm/polarity: "
    fails(lmp, whole(scene, extra=fix.replace("seed 11", "")), style + "keyword seed is missing")
    alone = whole(scene, extra=fix, contact="comm_modify cutoff 14\n")
    fails(lmp, alone, style + "which faces are free is known to pair_style dcm/contact; add it")
    after = whole(scene, motion=scene.motion() + fix)
    fails(lmp, after, style + "fix polarity stands after fix motion .dcm/motion., .*define it before")
    grow = whole(scene, extra=fix + growth(scene, "cycle_time 900"))
    fails(lmp, grow, style + "fix polarity stands before fix growth .dcm/growth.*define it after")
    cell = whole(scene, cell="", extra=fix + "fix cell all dcm/cell\n")
    fails(lmp, cell, style + "fix polarity stands before fix cell .dcm/cell.*define it after")
    none = whole(scene, cell="", volume="", cortex="", motion="", extra=fix)
    fails(lmp, none, "needs a fix dcm/cell")
    two = whole(scene, extra=fix + polarity("", name="second"))
    fails(lmp, two, style + "cell 1 is in the groups of fix polarity and fix second; groups .*must")


def test_bad_common_cell_in_a_run(lmp, scenes):
    """A cell that another group takes in between two runs, or later, is found as well."""
    scene = scenes.doublet()
    groups = "group a molecule 1\ngroup b molecule 2\n"
    deck = whole(scene, extra=groups + polarity("", "a") + polarity("", "b", "second"))
    result = lmp.run(deck + "timestep 1.0\nrun 1\ngroup b molecule 1\nrun 1\n")
    assert result.returncode != 0
    assert len(lines_of_error(result)) == 1
    assert "cell 1 is in the groups of fix polarity and fix second" in result.error


def test_narrow_ribbon(lmp, scenes):
    """A ribbon narrower than half an edge has gaps: a warning, once."""
    scene = scenes.single_cell()
    deck = whole(scene, extra=polarity("junction 0.60 0.65 every 1"))
    result = lmp(deck + "timestep 1.0\nrun 3\n")
    assert result.out.count("the ribbon of tight junctions of cell 1 is") == 1
    assert "ribbon" not in lmp(deck.replace("0.60 0.65", "auto") + "timestep 1.0\nrun 3\n").out


def test_plane_polarity_needs_polarity(lmp, scenes):
    scene, _, text = dividing(scenes)
    lines = [line for line in text.splitlines() if "polarity all" not in line]
    text = "\n".join(lines).split("compute k")[0]
    fails(lmp, text, "Fix dcm/division: plane polarity needs a fix dcm/polarity, whose polar vector")
