"""Groups without cells, and cells deleted between runs: one error, or a run that is right."""

import pytest

from hard.suite import Case

NOTHING = "dcm/motion: group {} holds no"


@pytest.fixture
def case(lmp, scenes):
    return Case(lmp, scenes)


def deck(case, group="all", before=""):
    scene = case.scenes.doublet(level=1, gap=-0.3, box=25.0)
    return case.deck(scene, 20.0, 1.0, before=before, group=group)


def stops(case, text, *patterns):
    run = case.run(text, fails=True)
    case.stopped(run, *patterns)
    assert case.good, case.faults()


def test_empty_group(case):
    stops(case, deck(case, "none", "group none empty\n"), NOTHING.format("none"))


def test_group_cleared_between_runs(case):
    text = deck(case, "second", "group second molecule 2\n")
    stops(case, text + "group second clear\nrun 10\n", NOTHING.format("second"))


def test_whole_cell_deleted(case):
    """The other cell goes on."""
    gone = "group cell1 molecule 1\ndelete_atoms group cell1 bond yes\nrun 20\n"
    run = case.run(deck(case) + gone)
    assert list(run.last.cells) == [2]
    case.sound(run, volume=(0.9, 1.0))
    assert case.good, case.faults()


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("group part id 2:20", r"dcm/.*(cell|face) \d"),
        ("group part id 1", "cell 1, which has no center atom"),
    ],
)
def test_not_a_whole_cell_deleted(case, what, message):
    """One error, which names what is missing."""
    stops(case, deck(case) + f"{what}\ndelete_atoms group part bond yes\nrun 20\n", message)


def test_all_cells_deleted(case):
    """The empty box goes on: it can be written, and others may come."""
    gone = "group part union all\ndelete_atoms group part bond yes\nrun 20\nwrite_restart r.none\n"
    run = case.run(deck(case) + gone)
    assert not run.last.cells
    assert (run.path / "r.none").stat().st_size > 0
