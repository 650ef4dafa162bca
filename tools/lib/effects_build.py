"""The plugin with only the styles that the decks of tools/bench effects always name.

A copy of src without the other styles' files, and without what only these include, is built beside
the results: what a style costs that is in the program and not in the deck shows in the difference.
"""

import os
import re
import shutil
import subprocess
import sys

from effects_decks import ROOT, registered

NEEDED = {"atom_style dcm", "command create_cells", "bond_style dcm/cortex",
          "dihedral_style dcm/bend", "pair_style dcm/contact", "fix dcm/cell", "fix dcm/volume",
          "fix dcm/motion"}


def files_of(header):
    """Files of a style: fix_dcm_x.h, .cpp and parts of it such as fix_dcm_x_marks.cpp."""
    return [header, *header.parent.glob(f"{header.stem}.cpp"),
            *header.parent.glob(f"{header.stem}_*.cpp")]


def prune(code):
    """Delete from the folder `code` the styles that are not NEEDED; returns the names of all files
    that went."""
    gone = []
    for style, header in registered(code).items():
        if style not in NEEDED:
            gone += files_of(header)
    for path in gone:
        path.unlink()
    while True:    # shared files that nobody is left to include
        text = "".join(p.read_text() for p in code.glob("*.*") if p.suffix in (".h", ".cpp"))
        included = re.findall(r'#include "(\w+)\.h"', text)
        idle = [h for h in code.glob("dcm_*.h")
                if included.count(h.stem) <= h.with_suffix(".cpp").is_file()]
        files = [f for h in idle for f in (h, h.with_suffix(".cpp")) if f.is_file()]
        if not files:
            return sorted(path.name for path in gone)
        for path in files:
            path.unlink()
        gone += files


def build(folder):
    """Build that plugin in folder/unnamed, if the sources changed; returns its folder."""
    place = folder / "unnamed"
    for name in ("src", "CMakeLists.txt"):
        source, copy = ROOT / name, place / "new" / name
        if source.is_dir():
            shutil.copytree(source, copy, dirs_exist_ok=True)
        else:
            shutil.copy2(source, copy)
    gone = prune(place / "new/src/DCM")
    old = place / "source"
    if not old.is_dir() or subprocess.run(["diff", "-rq", old, place / "new"], check=False,
                                          capture_output=True).returncode:
        shutil.rmtree(old, ignore_errors=True)
        (place / "new").rename(old)
    shutil.rmtree(place / "new", ignore_errors=True)
    print(f"the program without {len(gone)} files: {', '.join(gone)}", flush=True)
    made = place / "build"
    settings = {"LAMMPS_SOURCE_DIR": os.environ["LAMMPS_SOURCE_DIR"], "DCM_TESTS": "OFF",
                "LAMMPS_SIZES": os.environ.get("LAMMPS_SIZES", "SMALLBIG"), "DCM_NATIVE": "OFF"}
    for command in (["cmake", "-S", old, "-B", made, *(f"-D{k}={v}" for k, v in settings.items())],
                    ["cmake", "--build", made, "--parallel", os.environ.get("DCM_JOBS", "2")]):
        with open(place / "build.log", "a") as log:
            if subprocess.run(command, stdout=log, stderr=log, check=False).returncode:
                sys.exit(f"the program without the other styles did not build: {log.name}")
    return made
