"""Bookkeeping of tools/hard, with scenes that run nothing."""

import importlib.util
import json
import sys
from pathlib import Path

import pytest

from hard.suite import Scene

ROOT = Path(__file__).parents[2]


@pytest.fixture
def tool(monkeypatch):
    monkeypatch.setenv("DCM_LMP", sys.executable)
    monkeypatch.setenv("LAMMPS_PLUGIN_PATH", "")
    spec = importlib.util.spec_from_file_location("hard_suite", ROOT / "tools/lib/hard_suite.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "Runner", lambda folder: None)
    return module


class Calls:
    def __init__(self):
        self.ways = []


def suite_of(tool, folder, function, **options):
    scene = Scene("a_scene", "Family", "A sentence.", "A criterion.", function, **options)
    return scene, tool.Suite([scene], tool.SCHEMES, [1, 2], folder, False)


def quiet(*_words, **_options):
    pass


def test_runs_once_and_goes_on(tool, tmp_path):
    """What has a result is skipped; a result that is cut short is not one; ranks in their order."""
    calls = Calls()

    def function(case):
        calls.ways.append((case.scheme, case.ranks))
        case.check("value", 1.0, most=2.0, least=0.0)
        case.note("sound")

    scene, suite = suite_of(tool, tmp_path, function)
    suite.run(False, quiet)
    assert calls.ways == [("explicit", 1), ("implicit", 1), ("explicit", 2), ("implicit", 2)]
    assert suite.verdict(scene) == "right"
    (tmp_path / "a_scene.implicit.2.json").write_text('{"measured": [')
    scene, again = suite_of(tool, tmp_path, function)
    again.run(False, quiet)
    assert calls.ways[4:] == [("implicit", 2)]
    assert "right    a_scene" in again.write() and "4 of 4 ways, 4 values" in again.write()
    assert len((tmp_path / "table.csv").read_text().splitlines()) == 5
    assert not list((tmp_path / "runs").iterdir())


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (lambda case: 3.0, "value: 0 <= 3 <= 2"),
        (lambda case: float("nan"), "value: 0 <= nan <= 2"),
        (lambda case: 1.0 + 0.1 * case.ranks, "value depends on the number of ranks: 1.1 on 1"),
    ],
)
def test_what_is_wrong(tool, tmp_path, value, message):
    """Out of its bounds, no number, or another value on another number of ranks."""
    scene, suite = suite_of(
        tool, tmp_path, lambda case: case.check("value", value(case), most=2.0, least=0.0)
    )
    suite.run(False, quiet)
    assert suite.verdict(scene) == "WRONG"
    assert message in suite.write()


def test_a_fault_of_the_scene_is_a_result(tool, tmp_path):
    scene, suite = suite_of(tool, tmp_path, lambda case: 1 / 0)
    suite.run(False, quiet)
    assert suite.verdict(scene) == "WRONG"
    assert (
        "division by zero"
        in json.loads((tmp_path / "a_scene.explicit.1.json").read_text())["outcome"]
    )
    assert (tmp_path / "runs/a_scene.explicit.1").exists()  # kept, to look at


def test_page(tool, tmp_path):
    """Sentence, criterion, bounds and the worst value of each scheme."""

    def function(case):
        case.check("a_value*", 1.0 + case.ranks * 1e-3, most=2.0, least=0.0, unit="um")
        case.note("stops: `x_1` at step 3")

    scene, suite = suite_of(tool, tmp_path, function, schemes=("implicit",))
    suite.run(False, quiet)
    (tmp_path / "doc").mkdir()
    tool.write_page(suite, tmp_path)
    page = (tmp_path / "doc/hard_cases.rst").read_text()
    for text in (
        "Family\n------\n",
        "A scene\n^^^^^^^\n",
        "A sentence.",
        "*Right if:* A criterion.",
        r"a\_value\* (um)",
        "0 to 2",
        "- 1.002",
        "**right** in 2 of 2 ways",
        r"stops: \`x\_1\` at step 3",
        "1 of 1 scenes are right",
    ):
        assert text in page, text
    assert "Not run" not in page
    (tmp_path / "a_scene.implicit.2.json").unlink()
    tool.write_page(suite_of(tool, tmp_path, function, schemes=("implicit",))[1], tmp_path)
    page = (tmp_path / "doc/hard_cases.rst").read_text()
    assert "1 of 2 ways, 1 measured values. Not run on 2 ranks: 1 of 1." in page
