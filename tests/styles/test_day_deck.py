"""The deck examples/bile_duct_day, shortened: it goes on from its restart files, and every effect
can be switched."""
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "examples/bile_duct_day"
FILES = {name: FOLDER / name for name in ("scene.bile_duct_day", "cells.quick.txt")}
SHORT = {"rest": 0.02, "hours": 0.05}    # hours: 72 steps of rest, 180 of the day


def deck(restart=100):
    text = (FOLDER / "in.bile_duct_day").read_text()
    often = "restart         3600 day.*.restart"
    assert often in text
    return text.replace(often, f"restart {restart} day.*.restart")


def rows(path):
    lines = (path / "lumen.txt").read_text().splitlines()
    return {int(line.split()[0]): line for line in lines if not line.startswith("#")}


def test_it_goes_on_from_a_restart_file(lmp):
    whole = lmp(deck(), files=FILES, vars=SHORT)
    files = {**FILES, "day.200.restart": whole.path / "day.200.restart"}
    rest = lmp(deck(), files=files, vars={**SHORT, "from": "day.200.restart"})
    assert set(rows(rest.path)) == {240}
    assert rows(rest.path)[240] == rows(whole.path)[240]


def test_a_restart_file_of_the_rest_phase(lmp):
    # the point where the cholangiocytes meet is found anew
    short = {**SHORT, "hours": 0.02}
    whole = lmp(deck(50), files=FILES, vars=short)
    files = {**FILES, "day.50.restart": whole.path / "day.50.restart"}
    rest = lmp(deck(1000), files=files, vars={**short, "from": "day.50.restart"})
    assert rows(whole.path) and rows(rest.path) == rows(whole.path)


def test_a_restart_file_that_is_not_there(lmp):
    assert "nothing.restart" in lmp.run(deck(), files=FILES,
                                        vars={**SHORT, "from": "nothing.restart"}).error


@pytest.mark.parametrize("variables", [
    {"directed": "no", "osmosis": "no", "differentiation": "no", "constriction": "no"},
    {"marks": "tracer"}, {"dilute": 30}, {"differentiation": "now"}], ids=str)
def test_effects_can_be_switched(lmp, variables):
    run = lmp(deck(1000), files=FILES, vars={**SHORT, "hours": 0.02, **variables})
    last = run.thermo[-1]
    assert last["Step"] == 144 and last["v_ncells"] == 14 and last["c_chol"] == 3
