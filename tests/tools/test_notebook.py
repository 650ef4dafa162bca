"""The notebook of the page on Python runs from top to bottom, and its numbers hold."""
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOK = ROOT / "doc/howto_python/pair.ipynb"
CHECKS = """
import json
print("FOUND", json.dumps(dict(contact=history[:, 3].tolist(), more=more, area=float(area.sum()),
                               faces=len(triangles), pressure=history[-1, 1:3].tolist())))
"""


def sources(kind):
    return ["".join(c["source"]) for c in json.loads(NOTEBOOK.read_text())["cells"]
            if c["cell_type"] == kind]


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("notebook")
    build = Path(os.environ["DCM_LMP"]).resolve().parent
    source = Path(os.environ.get("LAMMPS_SOURCE_DIR", build.parent / "source/src"))
    module = source.parent / "python"
    if not (module / "lammps").is_dir() or not (build / "liblammps.so").exists():
        pytest.skip("this lmp has no Python module or no shared library beside it")
    (folder / "cells.py").write_text("\n\n".join(sources("code")) + CHECKS)
    env = {**os.environ, "PYTHONPATH": f"{ROOT / 'tools'}:{module}", "MPLBACKEND": "Agg",
           "LD_LIBRARY_PATH": str(build), "LAMMPS_POTENTIALS": str(ROOT / "potentials")}
    env.setdefault("LAMMPS_PLUGIN_PATH", env.get("DCM_BUILD", ""))
    run = subprocess.run([sys.executable, "cells.py"], cwd=folder, env=env, capture_output=True,
                         text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr
    found = next(line for line in run.stdout.splitlines() if line.startswith("FOUND"))
    return folder, run.stdout, json.loads(found.removeprefix("FOUND"))


def test_it_runs_and_says_what_it_should(done):
    folder, said, found = done
    assert "with fix dcm/cell: True" in said
    # two icospheres of level 2: 320 faces and 162 nodes each, a center
    assert found["faces"] == 640 and f"{2 * (320 + 162 + 1)} atoms" in said
    assert {p.name for p in folder.iterdir()} >= {"pair.png", "contact.png", "pair.dump"}


def test_the_cells_behave(done):
    contact, found = done[2]["contact"], done[2]
    assert 0 < contact[0] < contact[-1] < found["more"]    # they spread on each other
    # the cells are alike, but for the orientation of their meshes
    assert found["pressure"][0] == pytest.approx(found["pressure"][1], rel=0.05)
    assert found["pressure"][0] > 0
    # a bit more than two spheres of 6 um, less the flat triangles of the mesh: 4 % of the area
    assert found["area"] == pytest.approx(2 * 4 * 3.14159 * 36, rel=0.05)


def test_an_error_is_an_exception(done):
    assert "ERROR: Fix dcm/volume" in done[1] and "soft" in done[1]


def test_what_git_keeps_is_clean():
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    for cell in cells:
        assert cell["cell_type"] == "markdown" or (cell["outputs"] == [] and not
                                                   cell["execution_count"])
