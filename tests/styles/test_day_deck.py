"""The deck examples/bile_duct_day, shortened: it goes on from its restart files, and every effect
can be switched."""
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "examples/bile_duct_day"
FILES = {name: FOLDER / name for name in ("scene.bile_duct_day", "cells.quick.txt")}
SHORT = {"rest": 0.02, "hours": 0.05}    # hours: 72 s of rest, 180 s of the day
DECK = (FOLDER / "in.bile_duct_day").read_text()


def rows(path):
    lines = (path / "lumen.txt").read_text().splitlines()
    return {int(line.split()[0]): line for line in lines if not line.startswith("#")}


def saved(path):
    """Restart files of a run, by their step."""
    return {int(f.name.split(".")[1]): f for f in path.glob("day.*.restart")}


@pytest.mark.parametrize("phase", ["rest", "day"])
def test_it_goes_on_from_a_restart_file(lmp, phase):
    """... of either phase, with the same steps; in that of rest the point where the cholangiocytes
    meet is found anew."""
    variables = {**SHORT, "save": 5}
    whole = lmp(DECK, files=FILES, vars=variables)
    first = min(rows(whole.path))    # step of the day
    files = saved(whole.path)
    step = min(files) if phase == "rest" else max(n for n in files if n < max(rows(whole.path)))
    assert (step < first - 2) == (phase == "rest")
    name = files[step].name
    rest = lmp(DECK, files={**FILES, name: files[step]}, vars={**variables, "from": name})
    expected = {n: row for n, row in rows(whole.path).items() if n > step}
    assert expected and {n: row for n, row in rows(rest.path).items() if n > step} == expected


def test_a_restart_file_that_is_not_there(lmp):
    assert "nothing.restart" in lmp.run(DECK, files=FILES,
                                        vars={**SHORT, "from": "nothing.restart"}).error


@pytest.mark.parametrize("variables", [
    {"directed": "no", "osmosis": "no", "differentiation": "no", "constriction": "no"},
    {"marks": "tracer"}, {"dilute": 30}, {"differentiation": "now"},
    {"motion": "scheme explicit", "save": 1000}], ids=str)
def test_effects_can_be_switched(lmp, variables):
    run = lmp(DECK, files=FILES, vars={**SHORT, "hours": 0.02, **variables})
    last = run.thermo[-1]
    assert last["v_hour"] == pytest.approx(0.02, abs=1e-9)
    assert last["v_ncells"] == 14 and last["c_chol"] == 3
