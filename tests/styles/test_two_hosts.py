"""Two ranks on two hosts (network namespaces, Open MPI over TCP) do what they do on one."""

import os
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "tools/two-hosts"
NOT_PERMITTED = 77


@pytest.fixture
def two_hosts(lmp):
    """Runs in the folder of a run that has been, with a log and dump of its own."""

    def run(path):
        command = [str(SCRIPT), "-in", "in.test", "-nocite", "-log", "log.two",
                   "-var", "dump", "two"]
        done = subprocess.run(
            command, cwd=path, env=lmp.env, capture_output=True, text=True, timeout=300, check=False
        )
        if done.returncode == NOT_PERMITTED:
            pytest.skip(done.stdout.strip().splitlines()[-1])
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
        return path / "two"

    return run


def test_two_hosts_are_two(two_hosts, lmp):
    """The script starts its program once on each of two hosts with different names."""
    lmp.env["DCM_LMP"] = "/bin/uname"
    done = subprocess.run(
        [str(SCRIPT), "-n"], env=lmp.env, capture_output=True, text=True, timeout=60, check=False
    )
    if done.returncode == NOT_PERMITTED:
        pytest.skip(done.stdout.strip().splitlines()[-1])
    names = done.stdout.split()
    assert len(names) == 2 and names[0] != names[1] and os.uname().nodename not in names


@pytest.mark.parametrize("scheme", ["explicit", "implicit dt auto tol 0.05 max 4"])
def test_the_same_on_two_hosts(two_hosts, lmp, scenes, scheme):
    """Bit for bit: cells shared by both ranks, contacts, solver and chosen steps."""
    scene = scenes.doublet(boundary="p p p", box=15.0)
    deck = scene.head() + scene.forces() + scene.motion(options=f"scheme {scheme}")
    deck += "variable dump index one\ndump d all custom 5 ${dump} id x y z vx vy vz fx fy fz\n"
    deck += "dump_modify d sort id format float %.17g\ntimestep 1.0\nrun 20\n"
    one = lmp(deck, np=2)
    assert (one.path / "one").read_text() == two_hosts(one.path).read_text()
