"""tools/check docs: every style has a page in the manual, and every such page a style.

Run from the root of the repository; standard library only.
"""

import fnmatch
import re
import sys
from pathlib import Path

CODE, DOC = Path("src/DCM"), Path("doc")
STYLE = re.compile(r"^(\w+)Style\(([\w/]+),[^)]*\)", re.MULTILINE)
# how the manual's index calls a style, where it is not the name of the macro
WORDS = {"Command": "", "Atom": "atom_style ", "Pair": "pair_style ", "Bond": "bond_style ",
         "Dihedral": "dihedral_style "}


def page_of(header, kind):
    """The page of a header is named as the header; an atom style's by the command."""
    return "atom_style" + header.stem.removeprefix("atom_vec") if kind == "Atom" else header.stem


def main():
    faults, pages = [], set()
    index = (DOC / "index.rst").read_text().split()
    for header in sorted(CODE.glob("*.h")):
        for kind, name in STYLE.findall(header.read_text()):
            page = page_of(header, kind)
            pages.add(page)
            path = DOC / f"{page}.rst"
            if not path.is_file():
                faults.append(f"{header}: {kind} style {name} has no page {path}")
                continue
            entry = ".. index:: " + WORDS.get(kind, f"{kind.lower()} ") + name
            if entry not in path.read_text().splitlines():
                faults.append(f"{path}: has no line '{entry}'")
            if not any(fnmatch.fnmatch(page, pattern) for pattern in index):
                faults.append(f"{path}: not in {DOC}/index.rst")
    for path in DOC.glob("*_dcm_*.rst"):
        if path.stem not in pages:
            faults.append(f"{path}: no header in {CODE} has a style of this page")
    for fault in faults:
        print(fault)
    sys.exit(1 if faults or not pages else 0)


if __name__ == "__main__":
    main()
