"""Bookkeeping of tools/study, with runs that are faked by a few lines of Python."""
import importlib.util
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FAKE = '''import sys, pathlib
args = sys.argv[1:]
var = {args[k + 1]: args[k + 2] for k, w in enumerate(args) if w == "-var"}
here = pathlib.Path(".")
with open(here / "calls", "a") as calls:
    calls.write(" ".join(args) + "\\n")
off = [e for e in ("directed", "osmosis", "differentiation") if var.get(e) == "no"]
area = 1.0 if "osmosis" in off else 20.0 if off else 100.0 + int(var["seed"])
if var.get("constriction") == "no" and not off:
    area *= 1.2
hours = float(var.get("hours", 8))
first = 0
if "from" in var:
    first = int(var["from"].split(".")[1])
stop = 4 if "break" in sys.argv[0] and not (here / "mended").exists() else hours
lines = ["# faked", "# step hour lumens volume wall section closure around "
         "pressure cells cholangiocytes"]
for quarter in range(4 * first, int(4 * stop) + 1):
    hour = quarter / 4
    lines.append(f"{quarter * 900} {hour} 1 0 0 {area * hour / hours} 0.02 4 0.2 20 5")
(here / "lumen.txt").write_text("\\n".join(lines) + "\\n")
(here / "division.log").write_text("# head\\n" + "".join(f"{k} {k} {k} x\\n" for k in range(3)))
for k in range(1, int(stop) + 1):
    (here / f"day.{k}.restart").write_text("state" * 9)
if stop != hours:
    print("ERROR: the sky falls")
    sys.exit(1)
'''


@pytest.fixture
def study():
    spec = importlib.util.spec_from_file_location("study", ROOT / "tools/lib/study.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["study"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def command(study, tmp_path):
    """Function that runs the study with a fake program: words -> exit status."""
    deck = tmp_path / "root/examples/bile_duct_day"
    deck.mkdir(parents=True)
    (deck / "in.bile_duct_day").write_text("# a deck\n")

    def call(words, program="fake"):
        path = tmp_path / f"{program}.py"
        path.write_text(FAKE)
        return study.main(["--root", str(tmp_path / "root"), "--lmp", f"{sys.executable} {path}",
                           "--pause", "0.02", "--jobs", "2", *words.split()])

    call.folder = tmp_path / "root/runs/study_lumen"
    return call


def calls(folder):
    return (folder / "calls").read_text().splitlines()


def test_the_matrix(study):
    rows = study.matrix()
    assert len(rows) == 18
    assert len({tuple(sorted(v.items())) for v in rows.values()}) == 18
    assert all(rows["all"][e] == "yes" for e in study.EFFECTS)
    assert rows["no_osmosis"] == rows["all"] | {"osmosis": "no"}
    assert set(rows["none"].values()) == {"no"}
    assert rows["at_once"]["differentiation"] == "now" and rows["tracer"]["marks"] == "tracer"
    assert len(study.chosen_rows("five")) == 5
    assert list(study.chosen_rows("all,tracer")) == ["all", "tracer"]


def test_five_rows_their_table_and_verdict(command, capsys):
    assert command("--rows five --seeds 1,2,3") == 0
    said = capsys.readouterr().out
    assert "verdict: the published outcome is found" in said
    assert "15 of 15 runs done" in said or "runs done" in said
    lines = (command.folder / "table.csv").read_text().splitlines()
    assert len(lines) == 6
    row = dict(zip(lines[0].split(","), lines[1].split(",")))
    # the area grows evenly to 101, 102, 103; the mean of the quarters 7.75 and 8 h is 1/64 less
    assert (row["row"], row["seeds"]) == ("all", "3")
    assert float(row["area"]) == pytest.approx(102 * (1 - 1 / 64))
    assert float(row["sd"]) == pytest.approx(1 - 1 / 64)
    assert float(row["divisions"]) == 3
    assert (command.folder / "area.png").stat().st_size > 1000


def test_finished_runs_are_skipped(command):
    assert command("--rows all,no_osmosis --seeds 1") == 0
    assert command("--rows all,no_osmosis --seeds 1,2") == 0
    assert len(calls(command.folder / "all.seed1")) == 1
    assert len(calls(command.folder / "all.seed2")) == 1


def test_a_broken_run_goes_on_from_its_restart_then_is_given_up(command, capsys):
    assert command("--rows no_osmosis --seeds 1", "break") == 0
    folder = command.folder / "no_osmosis.seed1"
    said = capsys.readouterr().out
    assert "once more from day.4.restart" in said and "the sky falls" in said
    first, second, *more = calls(folder)
    assert "from" not in first and second.endswith("-var from day.4.restart")
    assert "1 failed" in said and "the sky falls" in (folder / "failed").read_text()
    tries = len(calls(folder))
    assert command("--rows no_osmosis --seeds 1", "break") == 0    # not again by itself
    assert len(calls(folder)) == tries
    (folder / "mended").touch()
    assert command("--rows no_osmosis --seeds 1 --again", "break") == 0
    assert (folder / "done").exists() and not (folder / "failed").exists()


def test_histories_of_attempts_are_joined(study, command):
    assert command("--rows all --seeds 1", "break") == 0
    (command.folder / "all.seed1/mended").touch()
    assert command("--rows all --seeds 1 --again", "break") == 0
    run = study.Run("all", 1, command.folder / "all.seed1", {})
    assert run.history()["hour"] == [k / 4 for k in range(33)]
    assert run.divisions() == 3


def test_a_half_written_restart_is_not_taken(study, tmp_path):
    (tmp_path / "day.1.restart").write_bytes(b"x" * 1000)
    (tmp_path / "day.2.restart").write_bytes(b"x" * 10)
    assert study.Run("all", 1, tmp_path, {}).restart().name == "day.1.restart"


def table(study, **areas):
    return {name: dict(seeds=3, failed=0, lumens=1.0, closure=0.02, area=area)
            for name, area in areas.items()}


@pytest.mark.parametrize("change, failing", [
    ({}, 0), (dict(no_directed=60), 1), (dict(no_osmosis=6), 1), (dict(no_constriction=30), 1),
    (dict(all=0.0, no_directed=0.0, no_osmosis=0.0, no_differentiation=0.0,
          no_constriction=0.0), 6)])
def test_verdict(study, change, failing):
    areas = dict(all=100, no_directed=30, no_osmosis=1, no_differentiation=40,
                 no_constriction=120) | change
    results = [passed for _, passed in study.verdict(table(study, **areas))]
    assert results.count(False) == failing and None not in results


def test_verdict_says_what_is_not_known(study):
    results = study.verdict(table(study, all=100))
    assert [p for _, p in results].count(None) == 5
    assert "not complete" in study.report_text(
        {"all": dict.fromkeys(("seeds", "failed", "sd", *study.MEASURES), 1.0)
         | dict(seeds=3, failed=0, area=50.0, closure=0.01)})


def test_other_variables_do_not_mix(command, capsys):
    assert command("--rows all --seeds 1") == 0
    assert command("--rows all --seeds 1 --hours 4") == 1
    assert "--folder" in capsys.readouterr().err


@pytest.mark.parametrize("words, says", [
    ("--rows best", "no row best"), ("--seeds 0", "--seeds"), ("--seeds a", "--seeds"),
    ("--jobs 0", "--jobs"), ("--hours -1", "--hours"), ("--set Posm=0.3", "--folder")])
def test_messages(command, words, says, capsys):
    assert command(words) == 1
    assert says in capsys.readouterr().err
