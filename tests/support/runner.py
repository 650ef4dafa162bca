"""Run decks through the real lmp, and read what they leave.

Environment, all set by tools/test: DCM_LMP (the lmp executable), LAMMPS_PLUGIN_PATH or DCM_BUILD
(the folder that holds dcmplugin.so), optionally DCM_MPIEXEC (mpirun).
"""

import contextlib
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from .parameters import PARAMETER_TEXT, PARAMETERS

ROOT = Path(__file__).resolve().parents[2]
TIMEOUT = 300  # s, for one run of lmp


class Frame:
    """One frame of a dump: step, box bounds, one array per column, rows sorted by id."""

    def __init__(self, step, box, names, rows):
        order = sorted(range(len(rows)), key=lambda r: int(rows[r][names.index("id")]))
        self.step, self.box, self.names = step, box, names
        self.columns = {
            name: np.array([_number(rows[r][k]) for r in order]) for k, name in enumerate(names)
        }

    def __getitem__(self, name):
        return self.columns[name]

    def vectors(self, *names):
        """Array (atoms, len(names))."""
        return np.stack([self.columns[n] for n in names], axis=1)

    @property
    def x(self):
        """Unwrapped positions if the dump has them, else wrapped ones."""
        names = ("xu", "yu", "zu") if "xu" in self.columns else ("x", "y", "z")
        return self.vectors(*names)

    @property
    def f(self):
        return self.vectors("fx", "fy", "fz")

    @property
    def v(self):
        return self.vectors("vx", "vy", "vz")


def _number(text):
    return float.fromhex(text) if "0x" in text else float(text)


def read_dump(path):
    """All frames of a text dump (style custom)."""
    frames, lines = [], Path(path).read_text().splitlines()
    k = 0
    while k < len(lines):
        assert lines[k] == "ITEM: TIMESTEP", lines[k]
        step, natoms = int(lines[k + 1]), int(lines[k + 3])
        box = np.array([[_number(w) for w in lines[k + 5 + d].split()] for d in range(3)])
        names = lines[k + 8].split()[2:]
        rows = [lines[k + 9 + n].split() for n in range(natoms)]
        frames.append(Frame(step, box, names, rows))
        k += 9 + natoms
    return frames


class Result:
    """What a run left: returncode, out, err, log (text), path (its folder), and the thermo lines.

    thermo: one dict (column -> value) per thermo line, all runs of the deck one after the other;
    runs: the same, one list per run.
    """

    def __init__(self, returncode, out, err, path, command):
        self.returncode, self.out, self.err, self.path = returncode, out, err, path
        self.command = command
        log = path / "log.lammps"
        self.log = log.read_text() if log.exists() else ""
        self.runs = self._thermo()
        self.thermo = [row for run in self.runs for row in run]

    def _thermo(self):
        runs, names = [], None
        for line in self.log.splitlines():
            words = line.split()
            if words and words[0] == "Step":
                names = words
                runs.append([])
            elif line.startswith("Loop time"):
                names = None
            elif names and len(words) == len(names):
                with contextlib.suppress(ValueError):  # a warning among the lines
                    runs[-1].append(dict(zip(names, map(float, words))))
        return runs

    def dump(self, name="dump.txt"):
        """Frames of a dump file of this run."""
        return read_dump(self.path / name)

    @property
    def error(self):
        """The lines of LAMMPS' error message, '' if there is none."""
        lines = self.out.splitlines()
        start = [k for k, line in enumerate(lines) if "ERROR" in line]
        return "\n".join(lines[start[0] :]) if start else ""

    def tail(self):
        return f"{self.command} in {self.path} returned {self.returncode}\n" + "\n".join(
            self.out.splitlines()[-25:] + self.err.splitlines()[-15:]
        )


class Runner:
    """lmp(deck): run a deck, an error fails the test; lmp.run(deck): the caller looks at it."""

    def __init__(self, folder):
        self.folder, self.count = folder, 0
        self.lmp = os.environ.get("DCM_LMP")
        plugins = os.environ.get("LAMMPS_PLUGIN_PATH") or os.environ.get("DCM_BUILD")
        if not self.lmp or not plugins:
            pytest.fail(
                "DCM_LMP and LAMMPS_PLUGIN_PATH are not set; run these tests with tools/test, "
                "for example: tools/test tests/styles -k ranks",
                pytrace=False,
            )
        if not os.access(self.lmp, os.X_OK):
            pytest.fail(f"DCM_LMP={self.lmp} is no executable; use tools/test", pytrace=False)
        if not any((Path(p) / "dcmplugin.so").exists() for p in plugins.split(":")):
            pytest.fail(f"no dcmplugin.so in {plugins}; use tools/test", pytrace=False)
        self.env = {
            **os.environ,
            "LAMMPS_PLUGIN_PATH": plugins,
            "LAMMPS_POTENTIALS": str(ROOT / "potentials"),
            "OMP_NUM_THREADS": "1",
            "OMPI_ALLOW_RUN_AS_ROOT": "1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_hwloc_base_binding_policy": "none",
            "OMPI_MCA_mpi_yield_when_idle": "1",  # more ranks than cores
        }

    def __call__(self, deck, np=1, vars=None, files=None, check=True, cwd=None, timeout=TIMEOUT):
        """Run `deck` (text, or the Path of a file) in a new folder, or in `cwd`.

        vars: index variables; a list gives several values. files: name -> text (or a Path to
        copy), written to the folder first. check: fail the test if lmp does not return 0.
        """
        self.count += 1
        path = Path(cwd) if cwd else self.folder / f"run{self.count}"
        path.mkdir(parents=True, exist_ok=True)
        (path / "log.lammps").unlink(missing_ok=True)
        for name, text in {PARAMETERS: PARAMETER_TEXT, **(files or {})}.items():
            if isinstance(text, Path):
                shutil.copy(text, path / name)
            else:
                (path / name).write_text(text)
        deck_path = path / "in.test"
        deck_path.write_text(deck.read_text() if isinstance(deck, Path) else deck)

        command = [self.lmp, "-in", "in.test", "-nocite"]
        for name, value in (vars or {}).items():
            values = value if isinstance(value, (list, tuple)) else [value]
            command += ["-var", name, *map(str, values)]
        if np > 1:
            mpirun = os.environ.get("DCM_MPIEXEC", "mpirun")
            command = [mpirun, "-np", str(np), *command]
        try:
            done = subprocess.run(
                command,
                cwd=path,
                env=self.env,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                timeout=timeout,
            )
        except subprocess.TimeoutExpired as late:
            out = (late.stdout or b"").decode(errors="replace")
            pytest.fail(f"{' '.join(command)} in {path} took more than {timeout} s:\n{out[-2000:]}")
        result = Result(done.returncode, done.stdout, done.stderr, path, " ".join(command))
        if check and result.returncode != 0:
            pytest.fail(result.tail(), pytrace=False)
        return result

    def run(self, deck, **options):
        """The same without a check of the return code."""
        return self(deck, check=False, **options)
