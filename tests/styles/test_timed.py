"""The table at the end of a run: what each style of this package in the deck took."""

import re

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
