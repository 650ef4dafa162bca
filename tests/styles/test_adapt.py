"""fix dcm/adapt: factors on rest volumes and rest lengths, cells, regions, ranks, restart."""

import math

import numpy as np
import pytest

from support.bad_decks import fails, lines_of_error, whole

CELL = "fix cell all dcm/cell\n"
POLARITY = (
    "fix pol all dcm/polarity seed 3 init toward 0 0 99 apical 0.5 junction 0.2 0.5 every 1\n"
)
K_V = 2.5
MEANS = [f"a{k}=f_ad[{k}]" for k in (1, 2, 3)]


def adapt(options, group="all", id="ad"):
    return f"fix {id} {group} dcm/adapt {options}\n"


def get(row, name):
    return row["v_" + name]


def rest_lengths(result, name):
    """(atom, atom) -> rest length, from a file of rest/write."""
    rows = [line.split() for line in (result.path / name).read_text().splitlines()]
    return {(int(r[0]), int(r[1])): float(r[2]) for r in rows if len(r) == 3 and r[0] != "#"}


# --- one cell -------------------------------------------------------------------------------------


@pytest.mark.parametrize("F", ["1.3", "v_time", "v_place"])
def test_volume0(lmp, scenes, F):
    """The pressure of the first step is that of V0 F; at rest V is V0 F; rest lengths stay."""
    scene = scenes.single_cell(boundary="s s s", options="rest 1")
    result = lmp(
        scene.head() + scene.cortex() + "comm_modify cutoff 12\n" + CELL + scene.volume()
        + "bond_style zero nocoeff\nbond_coeff *\n"
        + "variable time equal 1.3\nvariable place atom 1.3+0.1*x\n"
        + "fix_modify cell rest/write before\n" + adapt(f"volume0 {F}") + scene.motion()
        + "compute c all dcm/cell volume volume0 pressure volume0_factor\n"
        + scenes.thermo([*MEANS, *(f"c{k}=C_c[1][{k}]" for k in (1, 2, 3, 4))], 400)
        + "timestep 1.0\nrun 400\nfix_modify cell rest/write after\n"
    )  # fmt: skip
    first, last = result.thermo[0], result.thermo[-1]
    ball = 4 / 3 * math.pi * 6.0**3
    for row in (first, last):
        assert get(row, "c2") == pytest.approx(1.3 * ball, rel=1e-12)
        assert get(row, "c3") == pytest.approx(
            -K_V * math.log(get(row, "c1") / (1.3 * ball)), rel=1e-9, abs=1e-9
        )
        assert (get(row, "a1"), get(row, "a2"), get(row, "c4")) == pytest.approx((1.3, 1, 1.3))
    assert get(first, "c1") == pytest.approx(ball, rel=1e-12)
    assert get(last, "c1") == pytest.approx(1.3 * ball, rel=1e-3)  # bending holds on a little
    assert rest_lengths(result, "before") == rest_lengths(result, "after")


def test_rest_is_a_cell_made_with_other_rest_lengths(lmp, scenes):
    """Forces and way of a cell with rest 0.95 and factor 0.8 are those of one made with 0.76."""
    frames = []
    for made, extra in ((0.95, adapt("rest 0.8")), (0.76, "")):
        scene = scenes.single_cell(boundary="s s s", options=f"rotate 3 rest {made}")
        result = lmp(
            scene.head() + scene.forces() + extra + scene.motion()
            + scenes.dump("id xu yu zu fx fy fz", 10) + "timestep 1.0\nrun 20\n"
        )  # fmt: skip
        frames.append(result.dump())
    for a, b in zip(*frames, strict=True):
        assert np.abs(a.x - b.x).max() < 1e-10
        assert np.abs(a.f - b.f).max() < 1e-10 * np.abs(b.f).max()
    assert np.abs(frames[0][0].x - frames[0][-1].x).max() > 0.01


def test_a_factor_that_comes_back(lmp, scenes):
    """Of the cell without the fix, not of the step before."""
    scene = scenes.single_cell(boundary="s s s")
    result = lmp(
        scene.head() + scene.forces() + "variable f equal 1+0.2*sin(step*PI/10)\n"
        + "variable g equal 1/v_f\nfix_modify cell rest/write 0\n"
        + adapt("rest v_f volume0 v_g") + scene.motion()
        + "compute c all dcm/cell volume0 rest_factor volume0_factor\n"
        + scenes.thermo([*MEANS, "V0=C_c[1][1]", "l=C_c[1][2]", "v=C_c[1][3]"], 1)
        + "timestep 1.0\nrun 5\nfix_modify cell rest/write 5\n"
        + "run 15\nfix_modify cell rest/write 20\n"
    )  # fmt: skip
    start = get(result.thermo[0], "V0")
    for row in result.thermo:
        f = 1 + 0.2 * math.sin(row["Step"] * math.pi / 10)
        assert get(row, "V0") == pytest.approx(start / f, rel=1e-12)
        assert (get(row, "a2"), get(row, "l")) == pytest.approx((f, f), rel=1e-12)
        assert (get(row, "a1"), get(row, "v")) == pytest.approx((1 / f, 1 / f), rel=1e-12)
    before, middle, after = (rest_lengths(result, n) for n in ("0", "5", "20"))
    for edge, l0 in before.items():
        assert middle[edge] == pytest.approx(1.2 * l0, rel=1e-12)
        assert after[edge] == pytest.approx(l0, rel=1e-12)


def test_deleted_and_named_again(lmp, scenes):
    """As fix adapt: what there is stays, and is factor 1 for the next."""
    scene = scenes.single_cell(boundary="s s s")
    result = lmp(
        scene.head() + scene.forces() + adapt("rest 0.9 volume0 1.2")
        + "compute c all dcm/cell volume0\n" + scenes.thermo(["V0=C_c[1]"])
        + "run 0\nfix_modify cell rest/write 1\nunfix ad\nrun 0\nfix_modify cell rest/write 2\n"
        + adapt("rest 0.9") + "run 0\nfix_modify cell rest/write 3\n"
    )  # fmt: skip
    V0 = [get(run[0], "V0") for run in result.runs]
    assert V0[1] == V0[0] == V0[2]
    one, two, three = (rest_lengths(result, str(k)) for k in (1, 2, 3))
    assert one == two
    assert all(three[e] == pytest.approx(0.9 * one[e], rel=1e-12) for e in one)


# --- cells and regions ----------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_each_cell_has_its_own(lmp, scenes, np_):
    """An atom-style variable is that at the centers; cells outside of the group have none."""
    scene = scenes.Scene((30.0, 20.0, 20.0), "s s s")
    for n in range(3):
        scene.dcm(-14.0 + 14.0 * n, 0.0, 0.0, 6.0)
    names = "volume0 rest_factor volume0_factor"
    result = lmp(
        scene.head() + scene.forces() + "group two molecule 1 3\n"
        + "variable f atom 1+0.01*x\nvariable g atom 2-0.01*x\n"
        + adapt("volume0 v_f rest v_g", "two") + f"compute c all dcm/cell {names}\n"
        + scenes.thermo([f"c{m}{k}=C_c[{m}][{k}]" for m in (1, 124, 247) for k in (1, 2, 3)])
        + "run 0\n",
        np=np_,
    )  # fmt: skip
    (row,) = result.thermo
    ball = 4 / 3 * math.pi * 6.0**3
    for m, f, g in ((1, 0.86, 2.14), (124, 1, 1), (247, 1.14, 1.86)):
        got = [get(row, f"c{m}{k}") for k in (1, 2, 3)]
        assert got == pytest.approx([f * ball, g, f], rel=1e-9)


def edges_in(frame, regions):
    """Edges both of whose faces are in one of the regions: tags in order."""
    face = frame["type"] == 3
    around = {}
    vertices = frame.vectors("c_p[1]", "c_p[2]", "c_p[3]").astype(int)[face]
    for v, r in zip(vertices, frame["c_r"][face], strict=True):
        for k in range(3):
            around.setdefault(tuple(sorted((v[k], v[(k + 1) % 3]))), []).append(r in regions)
    assert all(len(two) == 2 for two in around.values())
    return {edge for edge, two in around.items() if all(two)}


@pytest.mark.parametrize("np_", [1, 2])
def test_edges_of_regions(lmp, scenes, np_):
    """Edges between two faces of the regions have the factor of the step; when the regions turn,
    those that are left behind have their own rest lengths again, to the last bit."""
    scene = scenes.single_cell(boundary="s s s", level=2)
    around = POLARITY.replace("0 0 99", "99 0 0")
    write = "fix_modify cell rest/write "
    result = lmp(
        scene.head() + scene.forces() + "variable f equal 0.9-0.01*step\n" + write + "0\n"
        + POLARITY + adapt("rest v_f faces apical junction every 1")
        + "compute r all dcm/face region\n"
        + "compute p all property/atom vertex1 vertex2 vertex3\n"
        + scenes.dump("id type xu yu zu c_r c_p[1] c_p[2] c_p[3]") + scenes.thermo(MEANS)
        + f"run 5\n{write} 5\n{around}run 3\n{write} 8\n",
        np=np_,
    )  # fmt: skip
    rests = {n: rest_lengths(result, n) for n in ("0", "5", "8")}
    frames = {frame.step: frame for frame in reversed(result.dump())}  # 5: before they turn
    chosen = {n: edges_in(frames[int(n)], (2, 3)) for n in ("5", "8")}
    assert 20 < len(chosen["5"]) < 400 and 20 < len(chosen["8"] - chosen["5"])
    for n in ("5", "8"):
        factor = 0.9 - 0.01 * int(n)
        for edge, l0 in rests["0"].items():
            if edge in chosen[n]:
                assert rests[n][edge] == pytest.approx(factor * l0, rel=1e-13)
            else:
                assert rests[n][edge] == l0
        row = result.runs[0 if n == "5" else 1][-1]
        assert get(row, "a3") == len(chosen[n])
        assert get(row, "a2") == pytest.approx(factor)


def test_every(lmp, scenes):
    """Edges are looked for in steps that are multiples of N, the factor is that of each step."""
    scene = scenes.single_cell(boundary="s s s", level=2)
    result = lmp(
        scene.head() + scene.forces() + POLARITY
        + adapt("rest 0.9 faces apical every 4") + scenes.thermo(MEANS) + "run 5\n"
    )  # fmt: skip
    assert [get(row, "a3") > 0 for row in result.thermo] == [False] * 4 + [True] * 2


def test_regions_and_whole_cells_multiply(lmp, scenes):
    scene = scenes.single_cell(boundary="s s s", level=2)
    result = lmp(
        scene.head() + scene.forces() + POLARITY + "fix_modify cell rest/write 0\n"
        + "variable g equal 0.9+0.01*step\n" + adapt("rest 0.7 faces apical every 1")
        + adapt("rest v_g", id="whole") + scenes.thermo(MEANS)
        + "run 4\nfix_modify cell rest/write 4\n"
    )  # fmt: skip
    before, after = rest_lengths(result, "0"), rest_lengths(result, "4")
    ratios = [after[e] / before[e] / 0.94 for e in before]
    few = sum(abs(r - 0.7) < 1e-12 for r in ratios)
    assert few == get(result.thermo[-1], "a3") > 20
    assert few + sum(abs(r - 1) < 1e-12 for r in ratios) == len(ratios)


def test_daughters_inherit(lmp, scenes):
    """Half of the mother's rest volume each, which has the factor already."""
    scene = scenes.single_cell(boundary="f f f", box=20.0)
    result = lmp(
        scene.head() + scene.forces() + "neighbor 1.0 multi\ngroup late empty\n"
        + f"fix grow late dcm/growth {scene.map} seed 1 cycle_time 1000 newborn 545 rounding 0 1\n"
        + "fix divide late dcm/division seed 1\n" + adapt("volume0 1.2 rest 1.1")
        + scene.motion() + "compute c all dcm/cell volume0\ncompute s all reduce sum c_c\n"
        + scenes.thermo(["V0=c_s", "cells=f_divide[1]", *MEANS], 1)
        + "timestep 1.0\nrun 1\ngroup late union late all\nrun 20\n"
    )  # fmt: skip
    mother, row = get(result.runs[0][0], "V0"), result.runs[1][-1]
    assert mother == pytest.approx(1.2 * 4 / 3 * math.pi * 6.0**3, rel=1e-12)
    assert get(row, "cells") == 1
    assert (get(row, "a1"), get(row, "a2")) == pytest.approx((1.2, 1.1), rel=1e-12)
    assert 1.0 <= get(row, "V0") / mother < 1.04  # they have grown for some seconds


# --- ranks and restart ----------------------------------------------------------------------------


def doublet(scenes, boundary):
    scene = scenes.doublet(level=1, boundary=boundary, gap=-0.4, box=(27.0, 14.0, 14.0))
    shift = "displace_atoms all move 26 13 13\n" if boundary == "p p p" else ""
    toward = POLARITY.replace("toward 0 0 99", "toward 3 30 8").replace("every 1", "every 10")
    fixes = (
        CELL + scene.volume() + toward + "variable f equal 1-0.004*step\n"
        + "variable g atom 1+0.005*step*(id>100)\n"
        + adapt("volume0 v_g rest 0.95") + adapt("rest v_f faces apical junction", id="cap")
        + scene.motion() + "timestep 1.0\n"
        + "compute c all dcm/cell volume0 rest_factor volume0_factor\n"
    )  # fmt: skip
    columns = MEANS + [f"b{k}=f_cap[{k}]" for k in (1, 2, 3)]
    columns += [f"c{m}{k}=C_c[{m}][{k}]" for m in (1, 124) for k in (1, 2, 3)]
    output = scenes.dump("id mol type xu yu zu vx vy vz fx fy fz", 10)
    return scene, shift, fixes + output + scenes.thermo(["pe", *columns], 10)


@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_1_2_3_and_4_ranks_agree(lmp, scenes, boundary):
    scene, shift, fixes = doublet(scenes, boundary)
    deck = scene.head() + shift + scene.cortex() + scene.contact() + fixes + "run 60\n"
    one = lmp(deck)
    frames = one.dump()
    assert np.abs(frames[-1].x - frames[0].x).max() > 0.1
    assert get(one.thermo[-1], "b3") > 10
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
    # step 35: between two looks for edges
    whole_run = lmp(
        run + scene.head() + scene.cortex() + scene.contact() + fixes + "restart 35 r.*\nrun 60\n",
        np=np_,
    )
    rest = lmp(
        run + "read_restart r.35\n" + scene.cortex()
        + f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
        + fixes + "restart 35 r.*\nrun 25\n",
        np=np_, files={"r.35": whole_run.path / "r.35"},
    )  # fmt: skip
    for a in rest.dump()[1:] if rest.dump()[0].step == 35 else rest.dump():
        b = next(frame for frame in whole_run.dump() if frame.step == a.step)
        for name in a.names:
            assert (a[name] == b[name]).all(), (a.step, name)
    last, same = rest.thermo[-1], whole_run.thermo[-1]
    assert {k: (last[k], same[k]) for k in last if last[k] != same[k]} == {}


# --- hard cases -----------------------------------------------------------------------------------


def test_a_growing_cell(lmp, scenes):
    """Its rest volume is that of fix dcm/growth; its rest lengths may have a factor."""
    scene = scenes.single_cell()
    growth = f"fix grow all dcm/growth {scene.map} seed 1 cycle_time 1000\n"
    fails(lmp, whole(scene, extra=growth + adapt("volume0 1.2")),
          "Fix dcm/adapt: a fix dcm/growth sets the rest volume of cell 1")  # fmt: skip
    lmp(whole(scene, extra=growth + adapt("rest 0.9")) + "timestep 1.0\nrun 2\n")


def test_a_factor_that_becomes_negative(lmp, scenes):
    scene = scenes.single_cell()
    extra = "variable f equal 1-0.5*step\n" + adapt("rest v_f")
    result = lmp.run(whole(scene, extra=extra) + "timestep 1e-6\nthermo 1\nrun 10\n")
    (error,) = lines_of_error(result)
    assert "Fix dcm/adapt: variable f gives cell 1 the rest length factor 0 at step 2" in error
    assert [row["Step"] for row in result.thermo] == [0, 1]


def test_two_on_one_cell(lmp, scenes):
    scene = scenes.doublet()
    groups = "group a molecule 1\ngroup b molecule 2\n"
    both = groups + adapt("volume0 1.1") + adapt("volume0 1.2", "b", "other")
    fails(lmp, whole(scene, extra=both),
          "Fix dcm/adapt: fixes ad and other both set the rest volume of cell 2")  # fmt: skip
    rest = groups + adapt("rest 1.1") + adapt("rest 1.2 volume0 2", "a", "other")
    fails(lmp, whole(scene, extra=rest), "both set the rest lengths of cell 1")
    lmp(whole(scene, extra=groups + adapt("rest 1.01", "a") + adapt("rest 0.99", "b", "other"))
        + "timestep 1.0\nrun 1\n")  # fmt: skip


def test_order(lmp, scenes):
    scene = scenes.single_cell()
    late = scene.motion() + adapt("rest 0.9")
    fails(lmp, whole(scene, motion=late), "Fix dcm/adapt.*before")


BAD = {
    "nothing": ("", "give 'volume0 F', 'rest F' or both"),
    "faces alone": ("volume0 1.1 faces apical", "keyword faces needs keyword rest"),
    "every alone": ("rest 1.1 every 5", "keyword every needs keyword faces"),
    "zero": ("rest 0", "rest is 0, must be a positive number, or v_NAME"),
    "negative": ("volume0 -1", "volume0 is -1, must be a positive number, or v_NAME"),
    "word": ("volume0 much", "volume0 is 'much', expected a number"),
    "missing value": ("rest", "keyword rest needs a value"),
    "no surface": ("rest 0.9 faces top", "faces must be lateral, .* junction or basal, not top"),
    "no variable": ("rest v_none", "rest: there is no .* variable none"),
    "wrong style": ("volume0 v_word", "volume0: there is no .* variable word"),
    "not positive": ("rest v_low", "variable low gives cell 1 the rest length factor -1 at step 0"),
    "every": ("rest 0.9 faces apical every 0", "every is 0, must be"),
    "unknown keyword": ("rest 0.9 tension 1", "unknown keyword tension; known: volume0 rest"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_options(lmp, scenes, name):
    options, pattern = BAD[name]
    extra = "variable word string much\nvariable low atom -1\n" + adapt(options)
    fails(lmp, whole(scenes.single_cell(), extra=extra), "Fix dcm/adapt: .*" + pattern)


def test_what_it_needs(lmp, scenes):
    scene = scenes.single_cell()
    fails(lmp, whole(scene, cell="", volume="", motion="", contact="", extra=adapt("rest 0.9")),
          "Fix dcm/adapt.* fix dcm/cell")  # fmt: skip
