"""LAMMPS as a library, through its C interface as LAMMPS' own Python module calls it: several
instances in one process, and errors that the caller catches.

Scripts for it run in a process of their own, by `run_script`: they find `Lammps` defined.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HEAD = '''
import ctypes, json, sys
lib = ctypes.CDLL(sys.argv[1], ctypes.RTLD_GLOBAL)
lib.lammps_open_no_mpi.restype = ctypes.c_void_p
lib.lammps_get_thermo.restype = ctypes.c_double


class Lammps:
    def __init__(self, log):
        words = ["lmp", "-log", log, "-screen", "none", "-nocite"]
        words = (ctypes.c_char_p * len(words))(*[w.encode() for w in words])
        self.handle = ctypes.c_void_p(lib.lammps_open_no_mpi(len(words), words, None))

    def __call__(self, text):
        """Commands, line by line, up to the first error: its message, or ''."""
        for line in text.splitlines():
            lib.lammps_command(self.handle, line.encode())
            if lib.lammps_has_error(self.handle):
                message = ctypes.create_string_buffer(4000)
                lib.lammps_get_last_error_message(self.handle, message, 4000)
                return message.value.decode().strip()
        return ""

    def thermo(self, *names):
        return [lib.lammps_get_thermo(self.handle, name.encode()) for name in names]

    def close(self):
        lib.lammps_close(self.handle)


found = {}
'''
TAIL = "\nprint('FOUND', json.dumps(found))\n"


def run_script(lmp, script, files=(), timeout=120):
    """Run a script in a new folder; what it has put into `found`."""
    library = Path(lmp.lmp).resolve().parent / "liblammps.so"
    if not library.exists():
        pytest.skip(f"no {library}: this lmp is linked without a library, or a sanitizer wraps it")
    lmp.count += 1
    path = lmp.folder / f"script{lmp.count}"
    path.mkdir()
    for name, text in dict(files).items():
        (path / name).write_text(text)
    (path / "script.py").write_text(HEAD + script + TAIL)
    done = subprocess.run(
        [sys.executable, "script.py", str(library)], cwd=path, env={**os.environ, **lmp.env},
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=timeout,
    )  # fmt: skip
    text = f"{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    assert done.returncode == 0, text
    found = [line for line in done.stdout.splitlines() if line.startswith("FOUND ")]
    assert found, text
    return json.loads(found[-1][6:])
