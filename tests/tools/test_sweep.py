"""tools/sweep, with runs that are faked by a few lines of shell, and one real sweep."""
import csv
import importlib.util
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DECK = '''variable W index 0.1
variable seed index 1
print "adhesion ${W}: area $(v_a) um^2, angle $(acos(v_b)) degrees"
if "$(v_x)" then "print 'not reached: $(v_y)'"
print """
of all: $(v_p:%.2f) $(v_q:%.2f)
${nothing}
"""
'''
# the value of -var W, squared; W = 3 breaks unless there is `mended`
FAKE = '''#!/bin/bash
while [ $# -gt 0 ]; do [ "$1" = -var ] && declare "$2=$3"; shift; done
echo run >>"$CALLS"
printf 'adhesion %s: area 0 um^2, angle 0 degrees\\nStep f_x Temp\\n 0 1 2\\n' "$W"
printf 'WARNING: of three\\n10 %s 5\\nLoop time of 1 on 1 procs\\n' "$W"
if [ "$W" = 3 ] && [ ! -e "$MENDED" ]; then echo "ERROR: too sticky"; exit 1; fi
echo "adhesion $W: area $((W * W)) um^2, angle ${seed:-7} degrees"
printf '\\nof all: 1.00 2.50\\nsomething\\n'
'''


@pytest.fixture
def sweep(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools/lib"))
    spec = importlib.util.spec_from_file_location("sweep", ROOT / "tools/lib/sweep.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "PAUSE", 0.01)
    return module


@pytest.fixture
def command(sweep, tmp_path, monkeypatch):
    """Function: words -> (exit status, what was said); .deck, .folder, .calls()."""
    monkeypatch.setenv("CALLS", str(tmp_path / "calls"))
    monkeypatch.setenv("MENDED", str(tmp_path / "mended"))
    deck, lmp = tmp_path / "in.sticky", tmp_path / "lmp"
    deck.write_text(DECK)
    lmp.write_text(FAKE)
    lmp.chmod(0o755)

    def call(*words, lmp=lmp, deck=deck):
        said = []
        status = sweep.main([str(deck), *words, "--root", str(tmp_path), "--lmp", str(lmp),
                             "--cores", "2"], said.append)
        return status, "\n".join(said)

    call.deck, call.folder = deck, tmp_path / "runs/sweep_sticky"
    call.calls = lambda: len((tmp_path / "calls").read_text().splitlines())
    return call


def table(folder):
    with open(folder / "sweep.csv", newline="") as file:
        return list(csv.DictReader(file))


def test_every_combination_in_one_table(command):
    status, said = command("-var", "W", "2,10", "-var", "seed", "1,5")
    assert status == 0 and command.calls() == 4
    rows = table(command.folder)
    assert [(r["W"], r["seed"]) for r in rows] == [("2", "1"), ("2", "5"), ("10", "1"), ("10", "5")]
    for r in rows:
        assert float(r["area"]) == float(r["W"]) ** 2 and r["angle"] == r["seed"]
        assert (r["of all"], r["of all 2"]) == ("1.00", "2.50")
        assert (r["Step"], r["f_x"], r["Temp"]) == ("10", r["W"], "5") and r["outcome"] == "done"
    assert "4 of 4" in said and "2: area" in said
    assert (command.folder / "W_10.seed_5/in.sticky").read_text() == DECK


def test_finished_runs_are_skipped_and_values_join(command):
    command("-var", "W", "2")
    (command.folder / "W_2/state").rename(command.folder / "kept")    # as if stopped on the way
    (command.folder / "W_2/rest").write_text("of the run that was stopped")
    command("-var", "W", "2,4")
    assert command.calls() == 3 and not (command.folder / "W_2/rest").exists()
    status, said = command("-var", "W", "2,4,5")
    assert command.calls() == 4 and "2 of them there already" in said
    assert [r["W"] for r in table(command.folder)] == ["2", "4", "5"]
    assert command("--report")[0] == 0 and command.calls() == 4


def test_a_run_that_fails_does_not_stop_the_others(command, tmp_path):
    status, said = command("-var", "W", "3,4")
    assert status == 1 and "ERROR: too sticky" in said and "1 of 2 runs failed" in said
    assert [(r["W"], r["outcome"], r["of all"]) for r in table(command.folder)] == [
        ("3", "failed", ""), ("4", "done", "1.00")]
    command("-var", "W", "3,4")
    assert command.calls() == 2
    (tmp_path / "mended").touch()
    assert command("-var", "W", "3,4", "--again")[0] == 0
    assert command.calls() == 3 and table(command.folder)[0]["outcome"] == "done"


def test_results_of_another_deck_are_not_mixed_in(command):
    command("-var", "W", "2")
    command.deck.write_text(DECK + "# changed\n")
    with pytest.raises(ValueError, match="not what it was"):
        command("-var", "W", "2,4")
    assert command.calls() == 1
    assert command("-var", "W", "2,4", "--again")[0] == 0 and command.calls() == 3


@pytest.mark.parametrize("words, says", [
    ("-var w 1", "no variable w"), ("-var W 1,,2", "a value is empty"), ("", "at least one -var"),
    ("-var W 1 -var W 2", "given twice"), ("-var W 1 --jobs 0", "--jobs"),
    ("-var W 1/2,1:2", "same folder name"), ("--report", "there is no sweep")])
def test_messages(command, words, says):
    with pytest.raises(ValueError, match=says):
        command(*words.split())
    assert not command.folder.exists()


def test_folders_of_others_are_left_alone(command, tmp_path):
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis/W_2").write_text("years")
    with pytest.raises(ValueError, match="of no sweep"):
        command("-var", "W", "2", "-o", str(tmp_path / "thesis"))
    assert (tmp_path / "thesis/W_2").read_text() == "years"
    with pytest.raises(ValueError, match="no such deck"):
        command("-var", "W", "2", deck=tmp_path / "nowhere")


def test_two_sweeps_of_one_folder(command, sweep, monkeypatch):
    def second(*args):
        with pytest.raises(ValueError, match="another sweep"):
            command("-var", "W", "2")
    monkeypatch.setattr(sweep, "work", second)
    with pytest.raises(ValueError, match="no run"):    # nothing ran in the first
        command("-var", "W", "2")


def test_labels(sweep):
    deck = 'print "length at rest, at the end: $(v_a) $(v_b) um; 7 cells ${n}, height h=$(v_h)"\n'
    ((pattern, labels),) = sweep.prints_of(deck)
    assert labels == ["length at rest, at the end", "length at rest, at the end", "7 cells",
                      "height h"]
    line = "length at rest, at the end: 1e-5 -2.5 um; 7 cells 3, height h=4"
    assert pattern.fullmatch(line).groups() == ("1e-5", "-2.5", "3", "4")
    assert sweep.prints_of("# print 'no $(v_x)'\nprint ''\nprint 'nothing'") == []


def test_rounds_of_a_loop(sweep):
    """All rounds of a print in a loop, in their order; of very long loops the last one."""
    deck = ('print "pull $(v_a): length $(v_b*(1-sqrt((v_c+(v_d))^2))) um; has &\n$(v_e) um"\n'
            'print "end $(v_f)"\n')
    prints = sweep.prints_of(deck)
    out = [f"pull {k}: length {2 * k} um; has {3 * k} um" for k in (1, 2)] + ["end 7"]
    assert sweep.results(out, prints)[0] == {
        "pull": "2", "length": "4", "has": "6",
        "pull, round 1": "1", "length, round 1": "2", "has, round 1": "3",
        "pull, round 2": "2", "length, round 2": "4", "has, round 2": "6", "end": "7"}
    out = [f"pull {k}: length {2 * k} um; has {3 * k} um" for k in range(51)]
    assert sweep.results(out, prints)[0] == {"pull": "50", "length": "100", "has": "150"}


def test_the_real_program(sweep, tmp_path, monkeypatch):
    monkeypatch.setenv("LAMMPS_POTENTIALS", str(ROOT / "potentials"))
    words = [str(ROOT / "examples/single/in.single"), "-var", "load", "0.5,1.0", "-var", "hold",
             "20", "-var", "image", "no", "--root", str(tmp_path), "--lmp", os.environ["DCM_LMP"],
             "--cores", "1"]
    assert sweep.main(words, lambda text: None) == 0
    weak, strong = table(tmp_path / "runs/sweep_single")
    name = "displacement of each loaded node w"
    # twice the load, nearly twice the way: the cell is nearly linear at a tenth of its radius
    assert float(strong[name]) == pytest.approx(2 * float(weak[name]), rel=0.2)
