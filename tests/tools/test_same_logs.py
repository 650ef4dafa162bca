"""tools/same-logs: what counts as a difference, and what the prepared decks hold. No lmp needed."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
spec = importlib.util.spec_from_file_location("same_logs", ROOT / "tools/lib/same_logs.py")
same_logs = importlib.util.module_from_spec(spec)
spec.loader.exec_module(same_logs)

LOG = """\
LAMMPS (4 Feb 2025)
Per MPI rank memory allocation (min/avg/max) = 6.2 | 6.2 | 6.2 Mbytes
   Step        f_volume[1]      f_move[5]      CPU
       0   0.10000000000000001  0.5     0
WARNING: something among the rows
      10   0.20000000000000001  0.6     1.5
Loop time of 1.5 on 1 procs for 10 steps with 42 atoms
   Step        f_volume[1]      f_move[5]      CPU
      10   0.20000000000000001  0.6     0
      20   0.29999999999999999  0.7     1.4
Loop time of 1.4 on 1 procs for 10 steps with 42 atoms
"""


def differences(new, old=LOG):
    return list(same_logs.compare_logs(old, new))


def test_rows_of_every_run():
    runs = same_logs.thermo(LOG)
    assert [[row[0] for row in rows] for _, rows in runs] == [["0", "10"], ["10", "20"]]
    assert runs[0][0] == ["Step", "f_volume[1]", "f_move[5]", "CPU"]


def test_same():
    assert differences(LOG) == []


def test_last_digit():
    new = LOG.replace("0.29999999999999999", "0.30000000000000004")
    (text,) = differences(new)
    assert text == "run 2, step 20: f_volume[1] 0.29999999999999999, now 0.30000000000000004"


def test_wall_times_do_not_count():
    new = LOG.replace("0.7     1.4", "0.9     2.8").replace("Loop time of 1.5", "Loop time of 9")
    assert new != LOG
    assert differences(new) == []


@pytest.mark.parametrize("row", ["      10   0.2", "      20"])
def test_missing_row(row):
    lines = LOG.splitlines()
    lines.remove([line for line in lines if line.startswith(row)][-1])
    assert "run 2: 2 rows, now 1" in differences("\n".join(lines))


def test_ended_in_an_error():
    new = LOG[: LOG.index("      20")] + "ERROR: Fix dcm/motion: too large a step\n"
    assert differences(new) == ["run 2: 2 rows, now 1"]


def test_missing_run():
    new = LOG[: LOG.rindex("   Step")]
    assert differences(new) == ["2 runs with thermo output, now 1"]


def test_other_columns():
    new = LOG.replace("f_volume[1]", "f_volume[2]")
    assert len(differences(new)) == 2  # one a run
    assert "columns Step f_volume[1]" in differences(new)[0]


def test_text_files():
    old = "# step time\n10 1.5 3\n20 2.5 4\n"
    compare = same_logs.compare_texts
    assert list(compare("d.log", old, old)) == []
    assert list(compare("d.log", old, old.replace("2.5", "2.6"))) == [
        "d.log, line 3, word 2: 2.5, now 2.6"
    ]
    assert list(compare("d.log", old, old + "30 3.5 5\n")) == ["d.log: 3 lines, now 4"]


def test_folders(tmp_path):
    """A file that is not written any more, and one that was not there before."""
    folders = tmp_path / "old", tmp_path / "new"
    for folder in folders:
        folder.mkdir()
        (folder / "log.lammps").write_text(LOG)
    assert list(same_logs.compare_folders(*folders)) == []
    (folders[0] / "death.log").write_text("1\n")
    (folders[1] / "other.log").write_text("1\n")
    assert list(same_logs.compare_folders(*folders)) == [
        "death.log is missing now",
        "other.log was not written before",
    ]


def test_prepared_deck():
    """All digits after each thermo_style, in its own way continued; rows often enough."""
    deck = "thermo_style custom step &\n pe\nthermo_modify norm no\nthermo 600\nrun 20\n"
    assert same_logs.with_all_digits(deck).splitlines() == [
        "thermo_style custom step &",
        " pe",
        "thermo_modify format float %.17g",
        "thermo 10",
        "thermo_modify norm no",
        "thermo 10",
        "run 20",
    ]


def test_every_shipped_deck_is_known():
    """No deck of the table that is gone, no example forgotten."""
    decks = same_logs.decks_of_this_tree()
    assert set(same_logs.SHORT) <= set(decks)
    assert {path.name[3:] for path in (ROOT / "examples").glob("*/in.*")} == set(same_logs.SHORT)


def test_columns_that_look_like_wall_times_count():
    """f_move[2] is a number of iterations, f_move[5] a wall time."""
    old = LOG.replace("f_move[5]", "f_move[2]")
    new = old.replace("0.7     1.4", "0.9     1.4")
    assert differences(new, old) == ["run 2, step 20: f_move[2] 0.7, now 0.9"]
