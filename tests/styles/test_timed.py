"""The table at the end of a run, what each style of this package in the deck took, and what the
styles tell of the run."""

import math
import re

import numpy as np
import pytest

from support.bad_decks import whole

ROW = re.compile(r"^  (\S.*?) +([\d.e+-]+) +([\d.e+-]+)? +([\d.]+) %(?:  (.*))?$", re.M)
TITLE = "Time of the DCM styles"


def tables(result):
    """Per run: name -> (mean, largest or None, percent, words)."""
    found = []
    for part in result.log.split(TITLE)[1:]:
        rows = ROW.findall(part.split("Total wall time")[0])
        assert len({name for name, *_ in rows}) == len(rows)
        found.append({
            name: (float(mean), float(most) if most else None, float(share), words)
            for name, mean, most, share, words in rows
        })  # fmt: skip
    return found


@pytest.mark.parametrize("np_", [1, 3])
def test_every_named_style_and_no_other(lmp, scenes, np_):
    scene = scenes.doublet()
    deck = whole(scene) + "run 0\nrun 20\nrun 20 post no\n"
    first, second = tables(lmp(deck, np=np_))
    for table in (first, second):
        styles = {name.split()[-1] for name in table}
        assert styles == {"dcm/cortex", "dcm/bend", "dcm/contact", "dcm/cell", "dcm/volume",
                          "dcm/motion", "others"}  # fmt: skip
        for name, (mean, most, _, _) in table.items():
            assert mean > 0.0, name
            assert most is None or most >= 0.999 * mean, name
        assert sum(share for _, _, share, _ in table.values()) == pytest.approx(100.0, abs=0.5)
    # one in the set-up
    words = {name.split()[-1]: row[3] for name, row in first.items()}
    assert re.match(r"21 solves of [\d.]+ iterations", words["dcm/motion"])
    assert re.match(r"\d+ contacts at the end, neighbor lists: \d+", words["dcm/contact"])


def test_minimization(lmp, scenes):
    scene = scenes.single_cell()
    deck = whole(scene) + "min_style fire\nminimize 0.0 1e-12 10 10\n"
    (table,) = tables(lmp(deck))
    assert table["fix cell dcm/cell"][0] > 0.0


def test_computes_are_in_it_and_each_second_once(lmp, scenes):
    """Computes that output and fixes read have rows; shares sum to 100 percent all the same."""
    scene = scenes.doublet()
    deck = whole(scene) + (
        "compute cells all dcm/cell volume contact_area\n"
        "compute faces all dcm/face area stress\n"
        "compute idle all dcm/face area\n"
        "compute sums all reduce sum c_cells[1] c_faces[1]\n"
        "fix read all ave/time 1 1 1 c_sums[*]\n"
        "run 0\nrun 20\n"
    )
    (table,) = tables(lmp(deck))
    assert table["compute cells dcm/cell"][0] > 0.0
    assert table["compute faces dcm/face"][0] > 0.0
    assert table["compute idle dcm/face"][0] == 0.0  # nobody reads it, in the run
    assert sum(share for _, _, share, _ in table.values()) == pytest.approx(100.0, abs=0.5)


def test_a_style_is_not_charged_for_a_compute_it_reads(lmp, scenes):
    """fix dcm/death reads computes in each step, which is most of the run: were their seconds its
    own as well, shares would sum to more than 100 percent."""
    scene = scenes.single_cell()
    names = [f"c{k}" for k in range(100)]
    deck = whole(scene) + (
        "".join(f"compute {name} all dcm/cell volume area pressure\n" for name in names)
        + "variable none atom " + "+".join(f"c_{name}[1]" for name in names) + "<0\n"
        "fix squeezed all dcm/death variable v_none\n"
        "run 50\n"
    )
    (table,) = tables(lmp(deck))
    assert all(table[f"compute {name} dcm/cell"][0] > 0.0 for name in names)
    assert table["fix squeezed dcm/death"][0] > 0.0
    round_off = 0.05 * len(table)
    assert sum(share for _, _, share, _ in table.values()) == pytest.approx(100.0, abs=round_off)


# --- what is told of a run ------------------------------------------------------------------------


def notes(result):
    """Lines below each table: list per run."""
    found = []
    for part in result.log.split(TITLE)[1:]:
        lines, inside = [], False
        for line in part.splitlines():
            if line == "Of this run":
                inside = True
            elif inside and line.startswith("  "):
                lines.append(line)
            elif inside:
                break
        found.append(lines)
    return found


def line_of(lines, begin):
    (found,) = [line.strip() for line in lines if line.strip().startswith(begin)]
    return found


def quality(corners):
    a, b, c = corners
    sides = sum(np.sum((p - q) ** 2) for p, q in ((a, b), (b, c), (c, a)))
    return 2 * math.sqrt(3) * np.linalg.norm(np.cross(b - a, c - a)) / sides


MOVE = (
    r"largest move (\S+): (node|sphere) (\d+) of cell (\d+) at step (\d+), (\S+) of its "
    r"(?:mean edge length|radius), maxmove is (\S+)"
)


@pytest.mark.parametrize("np_", [1, 3])
def test_largest_move_and_worst_triangle(lmp, scenes, np_):
    """Of all steps of the run: against a dump of every step."""
    nodes, mesh = scenes.icosphere(1)
    scene = scenes.Scene(20.0)
    for x in (-6.0, 6.2):
        scene.dcm(x, 0.0, 0.0, 6.0, mesh=("cell.off", 42, 80), options="scale nodes rest 0.95")
    scene.cbm(0.0, 11.0, 0.0, 4.0)
    head = scene.head() + (
        "group nodes type 2\ndisplace_atoms nodes random 0.5 0.5 0.5 12 units box\n"
    )
    deck = whole(scene, head=head) + "timestep 0.02\n" + scenes.dump(
        columns="id mol type xu yu zu", file="all.txt"
    ) + "run 10\nrun 0\nrun 10\n"  # fmt: skip
    result = lmp(deck, np=np_, files={"cell.off": scenes.off(nodes, mesh)})
    told, frames = notes(result), result.dump("all.txt")
    assert len(told) == 2
    for lines, first in zip(told, (0, 10)):
        move, kind, tag, cell, step, ratio, limit = re.fullmatch(
            MOVE, line_of(lines, "largest move")
        ).groups()
        best = {"node": 0.0, "sphere": 0.0}
        where = {}
        for n in range(first, first + 10):
            a, b = frames[n], frames[n + 1]
            d = np.linalg.norm(b.vectors("xu", "yu", "zu") - a.vectors("xu", "yu", "zu"), axis=1)
            for name, kind_type in (("node", 2), ("sphere", 4)):
                d_kind = np.where(a["type"] == kind_type, d, 0.0)
                k = int(np.argmax(d_kind))
                if d_kind[k] > best[name]:
                    best[name], where[name] = d_kind[k], (int(a["id"][k]), int(a["mol"][k]), n + 1)
        assert kind == "node"  # moved far by the deck
        assert float(limit) == 0.25 and 0.0 < float(ratio) < 0.25
        # meshes are of one size, so that the largest move is about the largest in edges
        assert float(move) == pytest.approx(best["node"], rel=0.02)
        if first == 0:
            assert (int(tag), int(cell), int(step)) == where["node"]

    # the worst triangle of the state that the run left
    last = result.dump("all.txt")[20]
    found = re.fullmatch(
        r"worst triangle: face (\d+) of cell (\d+), quality (\S+) \(1: equilateral\)",
        line_of(told[1], "worst triangle"),
    ).groups()
    x, ids = last.vectors("xu", "yu", "zu"), last["id"].astype(int)
    place = {tag: x[n] for n, tag in enumerate(ids)}
    worst = {}
    for cell, center in ((1, 1), (2, 124)):
        for n, face in enumerate(mesh):  # center, nodes, faces
            worst[quality([place[center + 1 + v] for v in face])] = (center + 43 + n, cell)
    assert float(found[2]) == pytest.approx(min(worst), rel=0.01)
    assert (int(found[0]), int(found[1])) == worst[min(worst)]


@pytest.mark.parametrize("np_", [1, 2])
def test_largest_overlap(lmp, scenes, np_):
    """As in the output of the pair style in each step, that is the largest overlap of two faces."""
    scene = scenes.doublet(gap=-0.6)
    deck = whole(scene) + "compute pair all pair dcm/contact\n" + scenes.thermo(
        ["deep=c_pair[5]"]
    ) + "timestep 0.02\nrun 10\n"  # fmt: skip
    result = lmp(deck, np=np_)
    (lines,) = notes(result)
    depth, a, b, step, of_h0, h0, share = re.fullmatch(
        r"largest overlap (\S+): cells (\d+) and (\d+) at step (\d+), (\S+) of h0 (\S+), (\S+) of "
        r"what ends the run", line_of(lines, "largest overlap")
    ).groups()  # fmt: skip
    assert (a, b) == ("1", "2")
    overlaps = [row["v_deep"] for row in result.thermo]
    assert float(depth) == pytest.approx(max(overlaps), rel=0.01) and float(depth) > 0.1
    assert overlaps[int(step)] == max(overlaps)
    assert float(of_h0) == pytest.approx(float(depth) / float(h0), rel=0.1)
    assert 0.0 < float(share) < 1.0


@pytest.mark.parametrize("np_", [1, 2])
def test_new_lists_and_why(lmp, scenes, np_):
    """Those of LAMMPS' own count; for a restart file, for a fix that asks for one, for distance."""
    scene = scenes.hybrid()
    deck = whole(
        scene, head=scene.head() + "group one molecule 7\n",
        extra="fix end one dcm/death all every 3\n",
    ) + "timestep 0.1\nrestart 4 a.rst b.rst\nrun 10\n"  # fmt: skip
    result = lmp(deck, np=np_)
    (lines,) = notes(result)
    text = line_of(lines, "new neighbor lists")
    total = int(re.search(r"^Neighbor list builds = (\d+)", result.log, re.M).group(1))
    assert re.match(rf"new neighbor lists: {total} in 10 steps", text), text
    assert ", 2 for restart files" in text
    assert ", 1 for fix end" in text
    assert text.endswith("; dangerous 0")


def test_lists_of_a_deck_that_makes_them_in_each_step(lmp, scenes):
    scene = scenes.doublet()
    deck = whole(scene) + "neigh_modify every 1 delay 0 check no\nrun 30\n"
    (lines,) = notes(lmp(deck))
    assert line_of(lines, "new neighbor lists") == (
        "new neighbor lists: 30 in 30 steps, 30 as neigh_modify check no says; dangerous 0"
    )
    assert not [line for line in lines if "advice" in line]


def test_advice_where_something_is_bad(lmp, scenes):
    """Slivers and cells deep in each other: one line each, and none in a good run."""
    (lines,) = notes(lmp(whole(scenes.doublet()) + "timestep 0.01\nrun 5\n"))
    assert not [line for line in lines if "advice" in line], lines

    deck = whole(scenes.doublet(gap=-1.2)) + "timestep 1e-5\nrun 5\n"
    (lines,) = notes(lmp(deck))
    advice = [line for line in lines if "advice" in line]
    assert len(advice) == 1 and "apart" in advice[0], lines

    scene = scenes.single_cell()
    head = scene.head() + "displace_atoms all ramp y -60 60 y -6 6\n"
    deck = whole(scene, head=head, contact="comm_modify cutoff 100\n") + "timestep 1e-5\nrun 5\n"
    (lines,) = notes(lmp(deck))
    advice = [line for line in lines if "advice" in line]
    assert len(advice) == 1 and "slivers" in advice[0], lines


def test_a_step_near_the_limit(lmp, scenes):
    scene = scenes.single_cell()
    ratio = re.search(MOVE, "\n".join(
        notes(lmp(whole(scene) + "timestep 0.05\nrun 1\n"))[0])).group(6)  # fmt: skip
    limit = f"tolerance 1e-12 maxmove {1.1 * float(ratio)}"
    for shrink, expected in (("", 1), (" shrink", 0)):
        motion = scene.motion(options=limit + shrink)
        deck = whole(scene, motion=motion) + "timestep 0.05\nrun 1\n"
        (lines,) = notes(lmp(deck))
        assert sum("a smaller timestep" in line for line in lines) == expected, lines


def test_of_spheres_and_of_a_minimization(lmp, scenes):
    """No faces, no moves of fix dcm/motion: no such lines."""
    scene = scenes.Scene(15.0, "p p p")
    scene.cbm(0.0, 0.0, 0.0, 3.0)
    scene.cbm(5.5, 0.0, 0.0, 3.0)
    bare = "bond_style zero nocoeff\nbond_coeff *\ndihedral_style zero nocoeff\ndihedral_coeff *\n"
    deck = scene.head() + bare + scene.contact() + "fix cell all dcm/cell\n" + (
        scene.motion() + "timestep 0.01\nrun 5\n"
    )
    (lines,) = notes(lmp(deck))
    assert "sphere" in line_of(lines, "largest move")
    assert not [line for line in lines if "triangle" in line or "overlap" in line]

    scene = scenes.single_cell()
    (lines,) = notes(lmp(whole(scene) + "min_style fire\nminimize 0.0 1e-12 10 10\n"))
    assert line_of(lines, "worst triangle")
    assert not [line for line in lines if "largest move" in line]
