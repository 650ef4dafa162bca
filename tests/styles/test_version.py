"""The version of the package: in the log, in the restart file, and in the log of who reads it."""
import re
from pathlib import Path

HEADER = Path(__file__).parents[2] / "src/DCM/dcm_version.h"
VERSION = re.search(r'DCM_VERSION "(.+)"', HEADER.read_text()).group(1)


def test_version_in_log_and_restart_file(lmp, scenes):
    scene = scenes.doublet()
    head = scene.head() + "fix cell all dcm/cell\n" + scene.cortex() + scene.volume()
    first = lmp(head + scene.motion(options="") + "comm_modify cutoff 12\nrun 1\n"
                "write_restart r.1\n")
    assert f"Fix dcm/cell: version {VERSION} of the package DCM" in first.log
    data = (first.path / "r.1").read_bytes()
    assert data.count(VERSION.encode()) == 1
    go_on = ("read_restart r.1\ncomm_modify cutoff 12\nfix cell all dcm/cell\n" + scene.volume()
             + scene.motion(options="") + "run 1\n")
    same = lmp(go_on, files={"r.1": first.path / "r.1"})
    assert "the restart file is of version" not in same.log
