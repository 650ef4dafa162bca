"""Versions that agree, the wheel, help and tab completion of every command."""
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import lammps_dcm
from lammps_dcm.__main__ import COMMANDS, main

ROOT = Path(__file__).parents[2]
TOOLS = sorted(p.name for p in (ROOT / "tools").iterdir()
               if p.is_file() and os.access(p, os.X_OK))


def test_one_version_everywhere():
    header = (ROOT / "src/DCM/dcm_version.h").read_text()
    version = re.search(r'^#define DCM_VERSION "(\d+\.\d+\.\d+)"$', header, re.M).group(1)
    changes = (ROOT / "CHANGELOG.md").read_text()
    assert re.search(r"^## (\S+)", changes, re.M).group(1) == version
    assert f"tools/lammps_dcm {lammps_dcm.__version__}" in changes
    citation = (ROOT / "CITATION.cff").read_text()
    assert re.search(r"^version: (\S+)$", citation, re.M).group(1) == version


def pip(*words, **more):
    return subprocess.run([sys.executable, "-m", "pip", "--disable-pip-version-check", *words],
                          capture_output=True, text=True, timeout=300, **more)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel of tools, built from a copy, since setuptools leaves files behind. Without network
    and without setuptools 70.1 or the package wheel beside the tests none can be built."""
    folder = tmp_path_factory.mktemp("wheel")
    shutil.copytree(ROOT / "tools", folder / "tools", ignore=shutil.ignore_patterns("__pycache__"))
    done = pip("wheel", "--no-deps", "-w", str(folder / "made"), str(folder / "tools"))
    if done.returncode and re.search("No matching distribution|connection|resolve", done.stderr):
        done = pip("wheel", "--no-deps", "--no-build-isolation", "-w", str(folder / "made"),
                   str(folder / "tools"))
        if "bdist_wheel" in done.stderr:
            pytest.skip("no network and no package wheel: nothing here can build one")
    assert done.returncode == 0, done.stderr
    (made,) = (folder / "made").glob("*.whl")
    return made


def test_wheel_has_all_and_no_more(wheel):
    assert wheel.name == f"lammps_dcm-{lammps_dcm.__version__}-py3-none-any.whl"
    names = set(zipfile.ZipFile(wheel).namelist())
    modules = {f"lammps_dcm/{p.name}" for p in (ROOT / "tools/lammps_dcm").glob("*.py")}
    assert {n for n in names if ".dist-info/" not in n} == modules


def test_wheel_works_elsewhere(wheel, tmp_path):
    done = pip("install", "--no-deps", "--no-index", "--target", str(tmp_path / "site"), str(wheel))
    assert done.returncode == 0, done.stderr
    env = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
    for words in (["--version"], ["scene", "doublet", "-o", "cells.txt"]):
        done = subprocess.run([sys.executable, "-m", "lammps_dcm", *words], cwd=tmp_path, env=env,
                              capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        if words == ["--version"]:
            assert done.stdout.split() == ["lammps_dcm", lammps_dcm.__version__]
    assert len((tmp_path / "cells.txt").read_text().splitlines()) >= 2
    assert (tmp_path / "site/bin/lammps-dcm").exists()


@pytest.mark.parametrize("name", TOOLS)
def test_every_tool_has_help(name, tmp_path):
    done = subprocess.run([ROOT / "tools" / name, "--help"], cwd=tmp_path, capture_output=True,
                          text=True, timeout=60, stdin=subprocess.DEVNULL)
    assert done.returncode == 0 and name in done.stdout
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help(name, capsys):
    with pytest.raises(SystemExit) as end:
        main([name, "--help"])
    assert end.value.code == 0 and f"lammps_dcm {name}" in capsys.readouterr().out


def complete(function, *words):
    """What bash would offer for the last of `words`."""
    script = (f"source tools/completion.bash; COMP_WORDS=({' '.join(words)}); "
              f"COMP_CWORD={len(words) - 1}; {function}; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
    done = subprocess.run(["bash", "-c", script], cwd=ROOT, capture_output=True, text=True,
                          timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_tab_completion(tmp_path):
    assert complete("_dcm_tool", "tools/run", "--over") == ["--overwrite"]
    assert complete("_dcm_tool", "tools/sweep", "examples/te") == [
        "examples/tension", "examples/tension/in.tension"]
    assert complete("_dcm_tool", "tools/run", "examples/tension/in.tension", "-var", "spr") == [
        "springs"]
    program = tmp_path / "lammps-dcm"
    program.write_text(f"#!/bin/sh\nexec {sys.executable} -m lammps_dcm \"$@\"\n")
    program.chmod(0o755)
    assert complete("_dcm_package", str(program), "lin") == ["lineage"]
    assert complete("_dcm_package", str(program), "render", "--mov") == ["--movie"]


def test_completion_knows_every_tool():
    text = (ROOT / "tools/completion.bash").read_text()
    named = re.search(r"for _dcm_name in (.*?);", text, re.S).group(1).replace("\\\n", " ").split()
    assert named == TOOLS
