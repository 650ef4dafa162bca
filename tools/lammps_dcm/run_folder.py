"""What a run left in its folder: the trajectory and the data file to draw."""
from pathlib import Path

TRAJECTORIES = ("*.dump", "*.dump.gz", "*.lammpstrj")
SHAPES = {"kind", "v1", "v2", "v3"}


def columns_of(path):
    """Names of the columns of a text dump, of its first frame; empty if it is none."""
    from .topology import open_text

    try:
        with open_text(path) as file:
            for _, line in zip(range(20), file):
                if line.startswith("ITEM: ATOMS"):
                    return set(line.split()[2:])
    except (OSError, UnicodeDecodeError, EOFError):
        pass
    return set()


def is_data(path):
    """Whether a file is a data file of LAMMPS with cells."""
    with open(path, errors="replace") as file:
        head = [line for _, line in zip(range(40), file)]
    return bool(head) and head[0].startswith("LAMMPS data file") and any(
        line.startswith("Atoms") and "dcm" in line for line in head + _atoms_line(path))


def _atoms_line(path):
    with open(path, errors="replace") as file:
        return [line for line in file if line.startswith("Atoms")][:1]


def find_run(folder, data=None):
    """(dump or None, data file or None) of a run's folder. The dump is the largest one that tells
    the shapes of cells, or without one the largest of positions if there is a data file."""
    folder, found = Path(folder), []
    datas = [p for p in sorted(folder.glob("*.data")) if is_data(p)]
    data = data or (str(max(datas, key=lambda p: p.stat().st_size)) if datas else None)
    for pattern in TRAJECTORIES:
        for path in folder.glob(pattern):
            columns = columns_of(path)
            shaped = columns >= SHAPES
            if "id" in columns and columns & {"x", "xu", "xs", "xsu"} and (shaped or data):
                found.append((shaped, path.stat().st_size, str(path)))
    if not found and data is None:
        raise ValueError(f"{folder}: there is no dump with the columns id mol type x y z kind v1 "
                         "v2 v3 (compute property/atom), and no data file: nothing to draw")
    if not found:
        return None, data
    shaped, _, dump = max(found)
    # cells that come and go are not those of the data file, and the dump tells all by itself
    return dump, None if shaped else data
