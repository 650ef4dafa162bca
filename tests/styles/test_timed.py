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
