"""tools/check layers: a law knows the standard library, Eigen and other laws, nothing else.

Run from the root of the repository; standard library only.
"""

import re
import sys
from pathlib import Path

LAW = Path("src/DCM/law")
MPI = {"friction_comm.h", "cell_sharing.h"}  # the two that speak MPI


def fault(header, name, quoted):
    """What is wrong with one #include of a law, or None."""
    if quoted:
        return None if "/" not in name and (LAW / name).is_file() else "not a law in this folder"
    if re.fullmatch(r"[a-z0-9_]+|Eigen/\w+", name) or (name == "mpi.h" and header.name in MPI):
        return None
    return "neither the standard library nor Eigen"


def main():
    headers = sorted(LAW.iterdir())
    faults = [f"{path}: a law is a header" for path in headers if path.suffix != ".h"]
    for header in headers:
        for number, line in enumerate(header.read_text().splitlines(), 1):
            found = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
            reason = found and fault(header, found[2], found[1] == '"')
            if reason:
                faults.append(f"{header}:{number}: {found[2]}: {reason}")
    for text in faults:
        print(text)
    sys.exit(1 if faults or not headers else 0)


if __name__ == "__main__":
    main()
