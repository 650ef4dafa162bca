"""Lineages: logs written out here, with the answers derived by hand."""
import csv
import math
from pathlib import Path

import numpy as np
import pytest

from lammps_dcm import Lineage, read_deaths, read_divisions
from lammps_dcm.__main__ import main
from lammps_dcm.lineage import LineageError

# 1 divides at 1000 s into 3 and 4; 3 at 2500 s into 5 and 6; 4 at 4000 s into 7 and 8; 5 dies
HEAD = """# LAMMPS-DCM division log; units um nN s
# step time mother daughter1 daughter2 generation kind axis_x axis_y axis_z volume volume1 volume2 \
iterations pressure_before pressure
"""
ROWS = ["100 1000 1 3 4 1 dcm 1 0 0 1800 900 890 10 0.1 0.5\n",
        "250 2500 3 5 6 2 dcm 0 1 0 1800 900 890 20 0.1 0.3\n",
        "400 4000 4 7 8 2 dcm 0 0 1 1800 900 890 40 0.1 0.5\n"]
DEATHS = """# LAMMPS-DCM death log; units um nN s
# step time cell kind reason volume
300 3000 5 dcm volume 120.5
"""


@pytest.fixture
def logs(tmp_path):
    (tmp_path / "division.log").write_text(HEAD + "".join(ROWS))
    (tmp_path / "death.log").write_text(DEATHS)
    return tmp_path / "division.log", tmp_path / "death.log"


def divisions(tmp_path, *rows, head=HEAD):
    (tmp_path / "d.log").write_text(head + "".join(rows))
    return read_divisions(tmp_path / "d.log")


def short(step, mother, *daughters, generation=1, kind="dcm"):
    return (f"{step} {10 * step} {mother} {daughters[0]} {daughters[1]} {generation} {kind} "
            "1 0 0 1800 900 890 10 0.1 0.5\n")


def test_logs_are_read_by_name(logs):
    log = read_divisions(logs[0])
    assert log.step.tolist() == [100, 250, 400] and log.line.tolist() == [3, 4, 5]
    assert log.kind.tolist() == ["dcm"] * 3 and log.axis_y.tolist() == [0, 1, 0]
    assert log.pressure.tolist() == [0.5, 0.3, 0.5] and log.iterations.tolist() == [10, 20, 40]
    death = read_deaths(logs[1])
    assert (death.cell[0], death.reason[0], death.volume[0]) == (5, "volume", 120.5)


def test_other_order_more_and_fewer_columns(tmp_path):
    log = divisions(tmp_path, "8 dcm 3 2 1 0.5 left 100\n",
                    head="# a log\n#time kind daughter2 daughter1 mother skew side step\n")
    assert (log.step[0], log.time[0], log.mother[0]) == (100, 8.0, 1)
    assert (log.daughter1[0], log.daughter2[0]) == (2, 3)
    assert log["skew"].tolist() == [0.5] and log["side"].tolist() == ["left"]
    assert math.isnan(log.pressure[0]) and log.generation[0] == -1
    assert Lineage(log).generation.tolist() == [0, 1, 1]


def test_restart_repeats_lines_and_header(tmp_path):
    again = ROWS[1].replace("0.3", "0.7")
    log = divisions(tmp_path, *ROWS[:2], HEAD, again, ROWS[2])
    assert log.mother.tolist() == [1, 3, 4]
    assert log.pressure.tolist() == [0.5, 0.7, 0.5]
    assert log.line.tolist() == [3, 7, 8]
    assert Lineage(log).cell.tolist() == [1, 3, 4, 5, 6, 7, 8]


@pytest.mark.parametrize("lost", [1, 3, 20, len(ROWS[2]) - 1])
def test_cut_last_line_is_left_out_with_a_warning(tmp_path, lost):
    with pytest.warns(UserWarning, match="d.log:5: the last line is not complete"):
        log = divisions(tmp_path, *ROWS[:2], ROWS[2][:-lost])
    assert log.mother.tolist() == [1, 3]


@pytest.mark.parametrize("rows, says", [
    ([ROWS[0], ROWS[1][:20] + "\n", ROWS[2]], "d.log:4: 7 values in 16 columns"),
    ([ROWS[0], ROWS[1].replace("dcm 0", "dcm zero"), ROWS[2]], "d.log:4: .*zero"),
    ([ROWS[0], ROWS[1][:20] + HEAD, ROWS[2]], "d.log:4: .*damaged")])
def test_damage_in_the_middle_is_an_error(tmp_path, rows, says):
    with pytest.raises(LineageError, match=says):
        divisions(tmp_path, *rows)


def test_wrong_files(tmp_path, logs):
    with pytest.raises(LineageError, match="death.log:3: .*no column mother"):
        read_divisions(logs[1])
    with pytest.raises(LineageError, match="d.log:1: no header line"):
        divisions(tmp_path, *ROWS, head="")
    with pytest.raises(FileNotFoundError, match="gone.*fix dcm/death"):
        read_deaths(tmp_path / "gone")


def test_tree(logs):
    tree = Lineage(read_divisions(logs[0]), read_deaths(logs[1]), initial=(1, 2), end=5000.0)
    assert tree.cell.tolist() == [1, 2, 3, 4, 5, 6, 7, 8]
    assert tree.parent.tolist() == [-1, -1, 0, 0, 2, 2, 3, 3]
    assert tree.children == [(2, 3), (), (4, 5), (6, 7), (), (), (), ()]
    assert tree.generation.tolist() == [0, 0, 1, 1, 2, 2, 2, 2]
    assert tree.roots.tolist() == [0, 1] and tree.row(6) == 5 and len(tree) == 8
    nan = np.nan
    np.testing.assert_array_equal(tree.birth, [nan, nan, 1000, 1000, 2500, 2500, 4000, 4000])
    np.testing.assert_array_equal(tree.division, [1000, nan, 2500, 4000, nan, nan, nan, nan])
    np.testing.assert_array_equal(tree.death, [nan] * 4 + [3000] + [nan] * 3)
    np.testing.assert_array_equal(tree.cycle_time, [nan, nan, 1500, 3000] + [nan] * 4)
    # leaves 5 6 7 8 at 0 1 2 3; 3 in the middle of 5 and 6, and so on; 2 is not drawn
    np.testing.assert_array_equal(tree.layout(), [1.5, nan, 0.5, 2.5, 0, 1, 2, 3])


def test_number_of_cells(logs):
    tree = Lineage(read_divisions(logs[0]), read_deaths(logs[1]), initial=(1, 2), end=5000.0)
    times, number = tree.counts()
    assert times.tolist() == [0, 1000, 2500, 3000, 4000]
    assert number.tolist() == [2, 3, 4, 3, 4]
    assert tree.living([0, 999, 1000, 2999, 3000, 9000]).tolist() == [2, 2, 3, 4, 3, 4]
    assert Lineage(read_divisions(logs[0])).counts()[1].tolist() == [1, 2, 3, 4]
    assert Lineage(deaths=read_deaths(logs[1])).counts()[1].tolist() == [1, 0]


def test_table_by_generation(logs):
    table = Lineage(read_divisions(logs[0]), read_deaths(logs[1]), (1, 2)).by_generation()
    assert [table[c].tolist() for c in ("generation", "cells", "divided", "died")] == [
        [0, 1, 2], [2, 2, 4], [1, 2, 0], [0, 0, 1]]
    nan = np.nan    # cycles 1500 and 3000 s: mean 2250, sd 750 sqrt(2)
    np.testing.assert_allclose(table["cycle_mean"], [nan, 2250, nan])
    np.testing.assert_allclose(table["cycle_sd"], [nan, 750 * 2**0.5, nan])
    np.testing.assert_allclose(table["pressure"], [0.5, 0.4, nan])
    np.testing.assert_allclose(table["iterations"], [10, 30, nan])


def test_growth_rate_of_doubling(tmp_path):
    # every cell divides every 1000 s: 1 2 4 8, ln N = ln 2 t / 1000 s exactly
    rows, following = [], 2
    for generation in (1, 2, 3):
        for mother in range(2 ** (generation - 1), 2**generation):
            rows.append(short(100 * generation, mother, following, following + 1,
                              generation=generation))
            following += 2
    tree = Lineage(divisions(tmp_path, *rows))
    assert tree.counts()[1].tolist() == [1, 2, 4, 8]
    assert tree.growth_fit() == pytest.approx((math.log(2) / 1000, 1.0), rel=1e-12)
    assert tree.growth_fit(begin=1000, end=2000)[0] == pytest.approx(math.log(2) / 1000)
    assert np.isnan(tree.growth_fit(begin=2500)[0])
    assert tree.cycle_time[1:7].tolist() == [1000] * 6


def test_daughter_keeps_the_name_of_its_mother(tmp_path):
    log = divisions(tmp_path, short(10, 1, 1, 2), short(20, 1, 1, 3, generation=2))
    tree = Lineage(log)
    assert tree.cell.tolist() == [1, 1, 2, 1, 3] and tree.parent.tolist() == [-1, 0, 0, 1, 1]
    assert tree.cycle_time[1] == 100 and tree.row(1) == 3
    assert tree.counts()[1].tolist() == [1, 2, 3]


def test_later_log_of_a_series_and_spheres(tmp_path):
    tree = Lineage(divisions(tmp_path, short(10, 8, 11, 12, generation=4, kind="cbm")), initial=[8])
    assert tree.generation.tolist() == [3, 4, 4]
    assert np.isnan(tree.pressure[0]) and np.isnan(tree.iterations[0])
    with pytest.warns(UserWarning, match="d.log:4: .*cell 11 are of generation 5.* not 1"):
        Lineage(divisions(tmp_path, short(10, 8, 11, 12, generation=4), short(20, 11, 13, 14)),
                names=("d.log", ""))


@pytest.mark.parametrize("rows, deaths, says", [
    ([short(10, 1, 2, 3), short(20, 4, 5, 3)], [], "d:4: cell 3 is born, .* d:3"),
    ([short(10, 1, 2, 3), short(20, 1, 4, 5)], [], "d:4: cell 1 divides, but it divided at d:3"),
    ([short(10, 1, 2, 3), short(30, 2, 4, 5)], ["20 200 2"],
     "d:4: cell 2 divides, but it died at k:2"),
    ([short(10, 1, 2, 3)], ["20 200 1"], "k:2: cell 1 dies, but it divided at d:3"),
    ([], ["20 200 1", "30 300 1"], "k:3: cell 1 dies, but it died at k:2"),
    ([short(10, 1, 2, 2)], [], "d:3: both daughters of cell 1 are cell 2")])
def test_contradictions_name_log_line_and_cell(tmp_path, rows, deaths, says):
    log = divisions(tmp_path, *rows)
    (tmp_path / "k").write_text("# step time cell\n" + "".join(d + "\n" for d in deaths))
    with pytest.raises(LineageError, match=says):
        Lineage(log, read_deaths(tmp_path / "k"), names=("d", "k"))


def test_contradictions_of_the_caller(logs):
    log = read_divisions(logs[0])
    with pytest.raises(LineageError, match="cell 3 is born, but .*initial cells"):
        Lineage(log, initial=(1, 2, 3))
    with pytest.raises(LineageError, match="twice among the initial"):
        Lineage(log, initial=(1, 1))
    with pytest.raises(LineageError, match="from 1000 to 4000 s.*from 0 to 3000 s"):
        Lineage(log, end=3000.0)
    with pytest.raises(LineageError, match="no cell 77"):
        Lineage(log).row(77)


# ---------------------------------------------------------------------- command line

def test_command(logs, tmp_path, capsys):
    out, table = tmp_path / "tree.png", tmp_path / "cells.csv"
    assert main(["lineage", str(logs[0]), "--death", str(logs[1]), "--initial", "2", "-o", str(out),
                 "--csv", str(table)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["generation", "cells", "divided", "died", "cycle[s]", "sd[s]",
                                "pressure[kPa]", "iterations"]
    assert [line.split() for line in lines[1:4]] == [
        ["0", "2", "1", "0", "-", "-", "0.5", "10"],
        ["1", "2", "2", "0", "2250", "1060.66", "0.4", "30"],
        ["2", "4", "0", "1", "-", "-", "-", "-"]]
    assert lines[4] == "cells: 2 at 0 s, 4 at 4000 s"
    rows = list(csv.DictReader(table.open()))
    assert [r["cell"] for r in rows] == list("12345678")
    assert [r["parent"] for r in rows] == list("00113344")
    assert rows[2]["birth"] == "1000" and rows[2]["cycle_time"] == "1500"
    assert rows[4]["death"] == "3000"


def red(path):
    """Number of pixels in the color of deaths."""
    from matplotlib.image import imread

    pixels = imread(path)[:, :, :3]
    return (np.abs(pixels - np.array([220, 20, 60]) / 255) < 0.02).all(axis=2).sum()


def test_picture_marks_deaths(logs, tmp_path):
    from lammps_dcm.lineage import draw

    log, death = read_divisions(logs[0]), read_deaths(logs[1])
    for name, tree in (("with", Lineage(log, death)), ("without", Lineage(log))):
        tree.growth_fit = lambda: (np.nan, np.nan)    # it has the same color
        draw(tree, tmp_path / f"{name}.png")
    assert red(tmp_path / "with.png") > 20 and red(tmp_path / "without.png") == 0


@pytest.mark.parametrize("generations, leaves", [(1, 2), (8, 256)])
def test_small_and_large_pictures(tmp_path, generations, leaves):
    from matplotlib.image import imread

    rows = [short(100 * g, m, 2 * m, 2 * m + 1, generation=g) for g in range(1, generations + 1)
            for m in range(2 ** (g - 1), 2**g)]
    log = divisions(tmp_path, *rows)
    assert np.nanmax(Lineage(log).layout()) == leaves - 1
    out = tmp_path / "tree.png"
    assert main(["lineage", str(tmp_path / "d.log"), "-o", str(out)]) == 0
    pixels = imread(out)[:, :, :3]
    colored = np.ptp(pixels, axis=2) > 0.15
    assert colored.sum() > 200 and pixels.shape[0] < 3000
    if leaves > 2:    # the tree reaches over most of the height
        assert np.ptp(colored.nonzero()[0]) > 0.8 * pixels.shape[0]


@pytest.mark.parametrize("words, says", [
    (["{d}", "--death", "{d}"], "no column cell"), (["{d}", "-o", "{d}"], "one of the logs"),
    (["{d}", "--csv", "{d}"], "one of the logs"), (["{d}", "--end", "10"], "events from 1000"),
    (["{e}"], "no division yet"), (["/nowhere/log"], "/nowhere/log")])
def test_messages(logs, tmp_path, words, says, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty.log").write_text(HEAD)
    before = logs[0].read_text()
    words = [w.format(d=logs[0], e=tmp_path / "empty.log") for w in words]
    assert main(["lineage", *words]) == 1
    assert says in capsys.readouterr().err
    assert logs[0].read_text() == before and not (tmp_path / "lineage.png").exists()


def test_undivided_cells_alone(tmp_path, capsys):
    (tmp_path / "empty.log").write_text(HEAD)
    assert main(["lineage", str(tmp_path / "empty.log"), "--initial", "5", "-o",
                 str(tmp_path / "t.png")]) == 0
    assert "cells: 5 at 0 s, 5 at 0 s" in capsys.readouterr().out


# ---------------------------------------------------------------------- number of cells

# cells 1 and 2 at first, of which 2 never divides, and 5 dies: 2 3 4 3 4
RUN = """LAMMPS (4 Feb 2025)
fix book all dcm/growth NULL d d d seed 1 cycle_time 1000
   Step         f_book          CPU
         0   2              0
       100   3              0.1
       200   3              0.2
WARNING: something happened
       300   3              0.3
       400   4              0.3
Loop time of 0.1 on 1 procs
"""


def lineage(tmp_path, capsys, *words):
    """What the command prints."""
    assert main(["lineage", *map(str, words), "-o", str(tmp_path / "t.png")]) == 0
    return capsys.readouterr().out


def numbers(said):
    """Lines about how many cells there are, and the column cells of the table."""
    lines = said.splitlines()
    table = [line.split()[1] for line in lines[1:] if line.split()[0] in "0123"]
    return [s for s in lines if s.startswith(("cells:", "growth", "number", "divisions"))], table


def test_number_of_cells_is_not_known_from_the_log_of_divisions(logs, tmp_path, capsys):
    lines, table = numbers(lineage(tmp_path, capsys, logs[0]))
    assert lines == ["divisions: 3", "number of cells and growth rate: not known (a cell that "
                     "neither divides nor dies is in no log: give --initial N, or --thermo LOG of "
                     "LAMMPS)"]
    assert table == ["-", "2", "4"]    # daughters are all in the log
    lines, _ = numbers(lineage(tmp_path, capsys, logs[0], "--death", logs[1]))
    assert lines[0] == "divisions: 3, deaths: 1" and "not known" in lines[1] and len(lines) == 2


def test_number_of_cells_from_the_run(logs, tmp_path, capsys):
    run = tmp_path / "log.lammps"
    run.write_text(RUN)
    lines, table = numbers(lineage(tmp_path, capsys, logs[0], "--death", logs[1], "--thermo", run))
    assert lines[0] == "cells: 2 at 0 s, 4 at 4000 s" and table == ["2", "2", "4"]
    # ln N at 0 1000 2500 3000 4000 s: 2 3 4 3 4
    k = np.polyfit([0, 1000, 2500, 3000, 4000], np.log([2, 3, 4, 3, 4]), 1)[0]
    assert lines[1] == f"growth rate {k:.6g} 1/s, doubling time {np.log(2) / k:.6g} s"
    # the same as with all cells named
    again, _ = numbers(lineage(tmp_path, capsys, logs[0], "--death", logs[1], "--initial", 2))
    assert again == lines


def test_deaths_without_a_log_show_in_the_run(logs, tmp_path, capsys):
    run = tmp_path / "log.lammps"
    run.write_text(RUN)
    lines, table = numbers(lineage(tmp_path, capsys, logs[0], "--thermo", run))
    assert lines[0] == "divisions: 3" and len(lines) == 2 and table[0] == "-"
    assert "not known (at step 300 the run has 3 cells, 4 by the logs of divisions and deaths: " \
        "one of them is missing or of another run)" in lines[1]
    lines, _ = numbers(lineage(tmp_path, capsys, logs[0], "--initial", 2))
    assert lines[0] == "cells: 2 at 0 s, 5 at 4000 s, if none died (no log of deaths)"


def test_continued_run_tells_the_number_at_the_start(logs, tmp_path, capsys):
    """The LAMMPS log of the second half: the logs of divisions and deaths have both halves."""
    run = tmp_path / "log.lammps"
    run.write_text("\n".join(line for line in RUN.splitlines() if line.split()[0] not in
                             ("0", "100", "200")) + "\n")
    lines, _ = numbers(lineage(tmp_path, capsys, logs[0], "--death", logs[1], "--thermo", run))
    assert lines[0] == "cells: 2 at 0 s, 4 at 4000 s"


@pytest.mark.parametrize("change, says", [
    (("f_book", "f_other"), "no number of cells: add f_book to thermo_style"),
    (("dcm/growth", "dcm/volume"), "no fix dcm/growth"), (("Step", "Time"), "no thermo output")])
def test_run_that_does_not_tell(logs, tmp_path, capsys, change, says):
    (tmp_path / "log.lammps").write_text(RUN.replace(*change))
    said = lineage(tmp_path, capsys, logs[0], "--thermo", tmp_path / "log.lammps")
    assert "not known (" in said and says in said


def test_initial_cells_that_the_log_contradicts(logs, tmp_path, capsys):
    assert main(["lineage", str(logs[0]), "--initial", "0", "-o", str(tmp_path / "t.png")]) == 1
    assert "cell 1 has no mother in " in capsys.readouterr().err


def test_tools_run_gives_the_run_to_lineage():
    """tools/run has the LAMMPS log, which tells what the log of divisions cannot."""
    text = (Path(__file__).resolve().parents[2] / "tools" / "run").read_text()
    call = text[text.index("lammps_dcm lineage"):].split("|| true")[0]
    assert "--thermo" in call and "death.log" in text
