"""fix dcm/constriction: which edges, the ramp, let go to divide, and what others do meanwhile. Fix
dcm/mark (tests/probe) gives regions by height and the area at a lumen."""

import os
from pathlib import Path

import numpy as np
import pytest

from support.bad_decks import fails, whole
from support.cycle_decks import same
from support.parameters import CORTEX

APICAL, JUNCTION = 2, 3  # regions, doc page atom_style_dcm
ALL_APICAL = f"band {APICAL} -2 2"
NAMES = ["cells", "ribbon", "cap", "factor"]
COLUMNS = "id mol type xu yu zu vx vy vz fx fy fz c_life[1] c_life[2]"


@pytest.fixture
def lmp(lmp):
    """Runner with the plugin that has fix dcm/mark."""
    folder = Path(os.environ["DCM_BUILD"]) / "extend"
    assert (folder / "dcmplugin.so").exists(), f"no dcmplugin.so in {folder}; use tools/test"
    lmp.env["LAMMPS_PLUGIN_PATH"] = str(folder)
    return lmp


def constriction(options="", group="all"):
    return f"fix tight {group} dcm/constriction {options}\n"


def mark(options, group="all"):
    return f"fix mark {group} dcm/mark {options}\n"


def output(scenes, every=1):
    columns = [f"{name}=f_tight[{k}]" for k, name in enumerate(NAMES, 1)]
    return (
        "compute life all dcm/cell constricted constriction\n"
        + scenes.dump(COLUMNS, every)
        + scenes.thermo(columns, every)
        + "timestep 1.0\n"
    )


def runs(*steps):
    """Run to each of these steps, and write the rest lengths there."""
    return "".join(f"run {n} upto\nfix_modify cell rest/write rest.{n}\n" for n in steps)


def rest_lengths(result, step):
    """(atom, atom) -> rest length."""
    edges = {}
    for line in (result.path / f"rest.{step}").read_text().splitlines():
        words = line.split()
        if len(words) == 3 and words[0] != "#":
            edges[int(words[0]), int(words[1])] = float(words[2])
    assert edges
    return edges


def ratios(result, step, other, of=None):
    """Rest lengths over those of another step, or another run."""
    a, b = rest_lengths(result, step), rest_lengths(of or result, other)
    assert a.keys() == b.keys()
    return {edge: a[edge] / b[edge] for edge in a}


def all_are(ratios_, value, rel):
    for edge, ratio in ratios_.items():
        assert ratio == pytest.approx(value, rel=rel), edge


def edges_by_region(frame, region_of):
    """Edges whose two faces have the same region, by region: (atom, atom) -> region."""
    face = frame["c_p[1]"] == 4
    tags = frame["id"].astype(int)
    vertices = frame.vectors("c_p[2]", "c_p[3]", "c_p[4]").astype(int)[face]
    middle, mol = frame.x[face], frame["mol"][face]
    around = {}
    for v, x, m in zip(vertices, middle, mol, strict=True):
        node = np.isin(tags, vertices[mol == m])
        r = x - frame.x[node].mean(axis=0)
        for k in range(3):
            edge = tuple(sorted((v[k], v[(k + 1) % 3])))
            around.setdefault(edge, []).append(region_of(r[2] / np.linalg.norm(r)))
    assert all(len(two) == 2 for two in around.values())
    return {edge: two[0] if two[0] == two[1] else None for edge, two in around.items()}


# --- edges, ramp ----------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2, 3, 4])
def test_edges_of_ribbon_and_cap(lmp, scenes, np_):
    """Both faces in the ribbon: 0.5, both in the cap: 0.7; n steps of a ramp of T steps do n/T of
    it, and the first of them is the step in which the lumen appears.
    """
    band = f"band {JUNCTION} 0.2 0.55 band {APICAL} 0.55 2"
    deck = whole(
        scenes.single_cell(level=2),
        motion="",
        extra=mark(f"steps 3 1000 {band}") + constriction("ramp 10"),
    )
    deck += "compute p all property/atom kind vertex1 vertex2 vertex3\n"
    deck += output(scenes).replace(COLUMNS, COLUMNS + " c_p[1] c_p[2] c_p[3] c_p[4]")
    result = lmp(deck + runs(2, 3, 7, 12, 15), np=np_)

    def region_of(height):
        return APICAL if height > 0.55 else JUNCTION if height > 0.2 else 0

    region = edges_by_region(result.dump()[0], region_of)
    count = {r: sum(region[e] == r for e in region) for r in (JUNCTION, APICAL)}
    assert min(count.values()) > 20
    for step in (3, 7, 12, 15):
        part = min(1.0, (step - 2) / 10)
        factor = {JUNCTION: 1 - 0.5 * part, APICAL: 1 - 0.3 * part, 0: 1.0, None: 1.0}
        for edge, ratio in ratios(result, step, 2).items():
            assert ratio == pytest.approx(factor[region[edge]], rel=1e-14)
        (row,) = [row for row in result.thermo if row["Step"] == step][-1:]
        assert (row["v_cells"], row["v_ribbon"]) == (1, count[JUNCTION])
        assert row["v_cap"] == count[APICAL]
        mean = sum(count[r] * factor[r] for r in count) / sum(count.values())
        assert row["v_factor"] == pytest.approx(mean, rel=1e-13)
    first = next(row for row in result.thermo if row["Step"] == 2)
    assert [first[f"v_{name}"] for name in NAMES] == [0, 0, 0, 1]
    last = result.dump()[-1]
    center = last["type"] == 1
    assert last["c_life[1]"][center] == 3.0 and last["c_life[2]"][center] == 1.0


@pytest.mark.parametrize("factor", [0.9, 0.7])
def test_a_whole_sphere(lmp, scenes, factor):
    """All edges d times as long at rest. In the sphere of radius s R0 the springs do the work
    k (s - d) sum(l^2) ds, the pressure that of p dV, p = -3 K_V ln s. The edges of an icosphere
    are not alike, which makes it stiffer by 1.1 % (K_A = 0.8756 k_s, without 0.8660).
    """
    scene = scenes.single_cell(level=2, options="rest 1")
    deck = whole(scene, extra=mark(ALL_APICAL) + constriction(f"cap {factor} ramp 100"))
    deck += output(scenes, 100) + runs(0, 800)
    result = lmp(deck)
    first, last = result.dump()[0], result.dump()[-1]
    node = first["type"] == 2
    radius = [np.linalg.norm(f.x[node] - f.x[node].mean(axis=0), axis=1).mean()
              for f in (first, last)]  # fmt: skip
    assert np.abs(last.v).max() < 1e-7  # at rest
    k = 2 / np.sqrt(3) * CORTEX["E_cor"] * CORTEX["h_cor"]
    squares = sum(l0**2 for l0 in rest_lengths(result, 0).values())
    volume = first_volume(first, node)
    low, high = factor, 1.0
    while high - low > 1e-12:
        s = 0.5 * (low + high)
        inward = k * (s - factor) * squares > -3 * CORTEX["K_V"] * np.log(s) * 3 * volume * s**2
        low, high = (low, s) if inward else (s, high)
    assert 1 - radius[1] / radius[0] == pytest.approx(1 - low, rel=0.02)
    assert 1 - low > 0.01


def first_volume(frame, node):
    """Enclosed by the nodes of the only cell, a ball's mesh."""
    from scipy.spatial import ConvexHull

    return ConvexHull(frame.x[node]).volume


def test_born_and_time(lmp, scenes):
    for when, first in (("born", 1), ("time 5.5", 6)):
        deck = whole(scenes.single_cell(), motion="",
                     extra=mark(ALL_APICAL) + constriction(f"ramp 4 when {when}"))  # fmt: skip
        rows = lmp(deck + output(scenes) + "run 12\n").thermo
        for n, row in enumerate(rows):
            part = min(max(n - first + 1, 0) / 4, 1.0)
            assert row["v_factor"] == pytest.approx(1 - 0.3 * part, rel=1e-14)


def test_every(lmp, scenes):
    """Cells are looked at in multiples of N, the ramp goes on in each step."""
    deck = whole(scenes.single_cell(), motion="",
                 extra=mark(f"{ALL_APICAL} steps 3 9")
                 + constriction("ramp 8 every 5"))  # fmt: skip
    rows = lmp(deck + output(scenes) + "run 10\n").thermo
    found = [row["v_factor"] for row in rows]
    assert found == pytest.approx([1.0] * 5 + [1 - 0.3 * n / 8 for n in range(1, 7)], rel=1e-14)


def test_group_and_cells_without_edges(lmp, scenes):
    """A cell outside the group does not constrict, nor does one without any ribbon or cap: its
    turn comes when it has one."""
    deck = whole(
        scenes.doublet(gap=4.0),
        motion="",
        extra="group one molecule 1\n" + mark("") + constriction("ramp 4", "one"),
    )
    deck += output(scenes) + runs(0, 5)
    deck += f"fix mark all dcm/mark {ALL_APICAL}\n" + runs(10)
    result = lmp(deck)
    assert set(ratios(result, 5, 0).values()) == {1.0}
    last = ratios(result, 10, 0)
    for edge, ratio in last.items():
        assert ratio == pytest.approx(0.7 if edge[0] < 123 else 1.0, rel=1e-14)
    assert {edge[0] < 123 for edge in last} == {True, False}


def test_once_only(lmp, scenes):
    """The lumen closes and opens again, and the cell turns: the same edges and lengths."""
    deck = whole(
        scenes.single_cell(level=2),
        motion="",
        extra=mark(f"steps 2 6 band {APICAL} 0.5 2") + constriction("ramp 5"),
    )
    deck += output(scenes) + runs(0, 10)
    deck += f"fix mark all dcm/mark band 0 -2 2 band {APICAL} -2 -0.5\n" + runs(30)
    result = lmp(deck)
    assert rest_lengths(result, 30) == rest_lengths(result, 10)
    found = ratios(result, 10, 0).values()
    assert 20 < sum(ratio < 0.99 for ratio in found) < len(found) / 2


# --- growth, release, division, death, conversion -------------------------------------------------


def growing(scenes, options, *, cycle=100, tight="ramp 10", more="", steps=(), **parts):
    scene = scenes.single_cell()
    scene.NAMES = "hepatoblast hepatoblast hepatoblast NULL"  # no room for large spheres
    extra = mark(ALL_APICAL) if tight else ""
    extra = f"fix grow all dcm/growth {scene.map} seed 3 cycle_time {cycle} {options}\n" + extra
    extra += more + (constriction(tight) if tight else "")
    out = output(scenes, 5) if tight else "timestep 1.0\n"
    return whole(scene, motion="", extra=extra, **parts) + out + runs(*steps)


def test_growth_acts_on_both(lmp, scenes):
    """Growth scales rest lengths, constricted or not: the factor stays, and when it is over, when
    the cell rounds up, they are those without constriction. 95 steps round 95 times: 1e-13.
    """
    steps = (4, 20, 80, 96, 120)
    tight = lmp(growing(scenes, "rounding 0.2 0.95", steps=steps))
    free = lmp(growing(scenes, "rounding 0.2 0.95", tight="", steps=steps))
    expected = {4: 1 - 0.3 * 0.4, 20: 0.7, 80: 0.73, 96: 1.0, 120: 1.0}
    for step in steps:
        for ratio in ratios(tight, step, step, free).values():
            assert ratio == pytest.approx(expected[step], rel=1e-13), step


def test_release_no(lmp, scenes):
    steps = (20, 120)
    tight = lmp(growing(scenes, "rounding 0.2 0.95", tight="ramp 10 release no", steps=steps))
    free = lmp(growing(scenes, "rounding 0.2 0.95", tight="", steps=steps))
    for step in steps:
        all_are(ratios(tight, step, step, free), 0.7, 1e-13)


def test_release_at_once_when_the_cell_divides(lmp, scenes):
    """Without time to round up, the cell is ready in the step in which it would begin to."""
    steps = (90, 101)
    tight = lmp(growing(scenes, "rounding 0 1", tight="ramp 30", steps=steps))
    free = lmp(growing(scenes, "rounding 0 1", tight="", steps=steps))
    all_are(ratios(tight, 90, 90, free), 0.7, 1e-13)
    all_are(ratios(tight, 101, 101, free), 1.0, 1e-13)


@pytest.mark.parametrize("np_", [1, 2])
def test_release_and_unfix_give_the_lengths_back(lmp, scenes, np_):
    """Nothing else changes them: the same to the last bit, and then once again."""
    deck = whole(scenes.single_cell(), motion="", extra=mark(ALL_APICAL) + constriction("ramp 7"))
    deck += output(scenes) + runs(0, 5, 20)
    deck += "undump dump.txt\nuncompute life\nthermo_style one\nunfix tight\n" + runs(21)
    deck += constriction("ramp 7 cap 0.9") + runs(40)
    result = lmp(deck, np=np_)
    all_are(ratios(result, 20, 0), 0.7, 1e-14)
    assert rest_lengths(result, 21) == rest_lengths(result, 0)
    all_are(ratios(result, 40, 0), 0.9, 1e-14)


def test_daughters_begin_anew(lmp, scenes):
    """Born with the rest lengths they have without constriction (1e-6: of the sub-simulation, whose
    mother differs in the last digits), and constricted when their own turn comes.
    """
    found = []
    for tight in ("ramp 10 when lumen", ""):
        divide = "fix divide all dcm/division seed 7\n"
        deck = growing(scenes, "rounding 0.2 0.95", tight=tight, more=divide, steps=(100,))
        if tight:
            deck = deck.replace(mark(ALL_APICAL), mark(f"steps 1 60 {ALL_APICAL}"))
            deck += f"fix mark all dcm/mark {ALL_APICAL}\n" + runs(112)
        found.append(lmp(deck))
    tight, free = found
    all_are(ratios(tight, 100, 100, free), 1.0, 1e-6)
    row = next(row for row in tight.thermo if row["Step"] == 100)
    assert row["v_cells"] == row["v_cap"] == 0
    last = tight.thermo[-1]
    assert last["v_cells"] == 2 and last["v_factor"] == pytest.approx(0.7, rel=1e-12)


def test_a_tense_mother_without_release(lmp, scenes):
    """Daughters take their rest lengths from hers; without constriction these are slack, and the
    division shortens them."""
    found = []
    for tight in ("ramp 10 release no", ""):
        divide = "fix divide all dcm/division seed 7\n"
        found.append(
            lmp(growing(scenes, "rounding 0.2 0.95", tight=tight, more=divide, steps=(100,)))
        )
    mean = [np.mean(list(rest_lengths(result, 100).values())) for result in found]
    assert 0.7 < mean[0] / mean[1] < 0.9


def test_a_cell_that_changes_its_form_begins_anew(lmp, scenes):
    scene = scenes.single_cell(boundary="f f f")
    contact = scene.contact().replace("neighbor 0.6", "neighbor 1.5")
    extra = "variable form atom (step>10)*(step<20)*(-2)+1\n"
    extra += "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_form every 1 "
    extra += "mesh icosphere 1\n"
    extra += mark(ALL_APICAL) + constriction("ramp 4 when born")
    deck = whole(scene, motion="", contact=contact, extra=extra)
    rows = lmp(deck + output(scenes) + "run 30\n").thermo
    found = [row["v_cells"] for row in rows]
    assert found[10] == 1 and found[15] == 0
    # its new faces are lateral: nothing to constrict
    assert found[30] == 0 and rows[30]["v_factor"] == 1.0


def test_a_dying_cell_keeps_its_factor(lmp, scenes):
    """Death scales rest lengths as well; cells that die do not begin."""
    found = []
    for tight in (True, False):
        extra = mark(f"steps 1 99 {ALL_APICAL}") if tight else ""
        extra += "fix death all dcm/death age 5 shrink 40\n"
        extra += constriction("ramp 10") if tight else ""
        deck = whole(scenes.single_cell(), motion="", extra=extra)
        found.append(lmp(deck + "timestep 1.0\n" + runs(3, 20)))
    all_are(ratios(found[0], 20, 20, found[1]), 0.7, 1e-13)


# --- ranks and restart ----------------------------------------------------------------------------


def moving(scenes, steps, options="ramp 30"):
    scene = scenes.doublet(level=2)
    band = f"band {JUNCTION} 0.2 0.55 band {APICAL} 0.55 2"
    return (
        "processors * 1 1\n" + scene.head() + scene.cortex() + "pair_style dcm/contact\n",
        f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\nfix cell all dcm/cell\n"
        + scene.volume()
        + scene.motility(options="D 1e-3 bias 1 0.7 0.3 8.0")
        + mark(f"steps 5 999 {band}")
        + constriction(options)
        + scene.motion()
        + output(scenes, 10)
        + f"run {steps}\nfix_modify cell rest/write rest.{steps}\n",
    )


def test_ranks_agree(lmp, scenes):
    deck = "".join(moving(scenes, 60)).replace("processors * 1 1\n", "")
    one = lmp(deck)
    assert one.thermo[-1]["v_cells"] == 2
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_)
        assert rest_lengths(other, 60) == rest_lengths(one, 60)
        for a, b in zip(one.thermo, other.thermo, strict=True):
            assert a == pytest.approx(b, rel=1e-12)
        for a, b in zip(one.dump(), other.dump(), strict=True):
            assert np.abs(a.x - b.x).max() < 1e-9, a.step


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_is_bit_for_bit(lmp, scenes, np_):
    """A run that goes on from the middle of the ramp."""
    start, rest = moving(scenes, 60)
    rest = rest.replace("timestep", "restart 20 r.*\ntimestep")
    first = lmp(start + rest, np=np_)
    band = rest[rest.index(" band") : rest.index("\n", rest.index(" band"))]
    again = lmp(
        "processors * 1 1\nread_restart r.20\n"
        + rest.replace(band, "").replace("run 60", "run 40"),
        np=np_,
        files={"r.20": first.path / "r.20"},
    )
    expected, found = first.dump()[2:], again.dump()
    assert [frame.step for frame in found] == [20, 30, 40, 50, 60]
    for a, b in zip(expected, found, strict=True):
        same(a, b, COLUMNS)
    assert 0.5 < first.thermo[2]["v_factor"] < 0.9
    assert again.thermo == first.thermo[2:]
    assert rest_lengths(again, 60) == rest_lengths(first, 60)


def test_another_id_after_a_restart(lmp, scenes):
    """The edges in the file are not found under it: an error, and not cells shortened for good."""
    start, rest = moving(scenes, 30)
    rest = rest.replace("timestep", "restart 20 r.*\ntimestep")
    first = lmp(start + rest)
    band = rest[rest.index(" band") : rest.index("\n", rest.index(" band"))]
    named = constriction("ramp 30").split()[1]
    deck = "read_restart r.20\n" + rest.replace(band, "")
    deck = deck.replace(f"fix {named} ", "fix other ").replace(f"f_{named}", "f_other")
    again = lmp(deck, check=False, files={"r.20": first.path / "r.20"})
    assert "cell 1 of the restart file is constricted" in again.out
    assert "under the ID other" in again.out and "Step" not in again.out.split("ERROR")[0][-400:]


# --- bad input ------------------------------------------------------------------------------------

STYLE = "Fix dcm/constriction"
CASES = {
    "cap 0": ("cap 0", "cap is 0.*positive"),
    "cap 1.1": ("cap 1.1", "cap is 1.1, must be above 0 and at most 1"),
    "ribbon -1": ("ribbon -1", "ribbon is -1.*positive"),
    "ribbon 2": ("ribbon 2", "ribbon is 2, must be above 0 and at most 1"),
    "ribbon text": ("ribbon x", "ribbon is 'x'.*number"),
    "ramp -1": ("ramp -1", "ramp is -1.*zero or positive"),
    "when": ("when never", "when must be lumen, born or time t, not never"),
    "time text": ("when time x", "when time is 'x'.*number"),
    "release": ("release maybe", "release must be no or yes, not maybe"),
    "every 0": ("every 0", "every is 0.*positive whole number"),
    "keyword": ("x 1", "unknown keyword x; known: cap ribbon ramp when release every"),
    "no lumen": ("", "nothing marks the faces at a lumen.*fix dcm/osmosis.*when born"),
    "twice": ("when born\nfix b all dcm/constriction when born",
              "cells have a value constricted already, of another style"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_bad(lmp, scenes, case):
    text, pattern = CASES[case]
    extra = f"fix a all dcm/constriction {text}\n"
    fails(lmp, whole(scenes.doublet(), extra=extra), f"{STYLE}: {pattern}")


def test_order(lmp, scenes):
    scene = scenes.doublet()
    tight = constriction("when born")
    fails(lmp, whole(scene, motion=scene.motion() + tight),
          f"{STYLE}: fix tight stands after fix motion.*define it before fix motion")  # fmt: skip
    grow = f"fix grow all dcm/growth {scene.map} seed 3 cycle_time 100\n"
    fails(lmp, whole(scene, extra=tight + grow),
          f"{STYLE}: fix tight stands before fix grow .dcm/growth.*")  # fmt: skip


def test_a_ramp_shorter_than_a_step(lmp, scenes):
    deck = whole(scenes.single_cell(), motion="", extra=constriction("ramp 0.25 when born"))
    result = lmp(deck + "timestep 1.0\nrun 1\nrun 1\n")
    text = "ramp is 0.25, shorter than the timestep 1: rest lengths jump to 0.5 (ribbon) and 0.7"
    assert result.out.count("WARNING: " + STYLE + ": " + text) == 1


# --- with the styles that give regions and marks --------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
def test_with_polarity_and_osmosis(lmp, scenes, np_):
    """Two polar cells with a lumen constrict in the step in which their faces are marked: the edges
    between two faces of the regions of that moment, whatever the regions become."""
    scene = scenes.doublet(level=2)
    extra = (
        "fix polar all dcm/polarity seed 3 init toward 0 0 0 apical 0.5 junction 0.2 0.5 every 1 "
        "freeze 0\n" + constriction("ramp 5")
        + "fix osm all dcm/osmosis pressure 0.05 marks flood starter 0 0 0 8 1e9\n"
    )  # fmt: skip
    deck = whole(scene, extra=extra)
    deck += "compute p all property/atom kind vertex1 vertex2 vertex3 region\n"
    deck += output(scenes).replace(COLUMNS, COLUMNS + " c_p[1] c_p[2] c_p[3] c_p[4] c_p[5]")
    result = lmp(deck + "run 12\n", np=np_)
    frames = result.dump()
    began = {float(f["c_life[1]"][f["type"] == 1][0]) for f in frames}
    assert len(began) == 2 and min(began) == -1.0
    start = int(max(began))
    assert [row["v_cells"] for row in result.thermo] == [0] * start + [2] * (13 - start)
    frame = frames[start]
    face = frame["type"] == 3
    region = dict(zip(frame["id"][face].astype(int), frame["c_p[5]"][face], strict=True))
    around = {}
    for tag, v in zip(
        frame["id"][face].astype(int),
        frame.vectors("c_p[2]", "c_p[3]", "c_p[4]")[face].astype(int),
        strict=True,
    ):
        for k in range(3):
            around.setdefault(tuple(sorted((v[k], v[(k + 1) % 3]))), []).append(region[tag])
    ribbon, cap = (
        sum(two[0] == two[1] == r for two in around.values()) for r in (JUNCTION, APICAL)
    )
    assert ribbon > 10 and cap > 10
    for row in result.thermo[start:]:
        assert (row["v_ribbon"], row["v_cap"]) == (ribbon, cap)
