"""Parts of decks in which cells grow, divide, die or change their form; used by test_growth.py,
test_population.py, test_death.py, test_convert.py."""

import numpy as np


def sphere(radius):
    return 4.0 / 3.0 * np.pi * np.asarray(radius) ** 3


def growth(scene, options, group="all"):
    return f"fix growth {group} dcm/growth {scene.map} seed 3 {options}\n"


def counting(cells, options, radius=5.0, names=None):
    """Cells that only count: spheres on a grid, no contact, no motion."""
    n = int(np.ceil(cells ** (1 / 3)))
    a = 8.0 * n
    create = ""
    for k in range(cells):
        place = [16.0 * (m + 0.5) - a for m in (k % n, k // n % n, k // n**2)]
        create += "create_cells single cbm cbm {} {} {} {} cbm cbm 4\n".format(*place, radius)
    return (
        "units lj\natom_style dcm\nnewton on\nboundary f f f\n"
        f"region box block {-a} {a} {-a} {a} {-a} {a}\n"
        "create_box 4 box bond/types 1 dihedral/types 1\nmass * 1.0\n"
        + create
        + "comm_modify cutoff 5\nneighbor 0.6 bin\ntimestep 1.0\n"
        + f"fix growth all dcm/growth NULL {names or 'd d d c'} seed 3 {options}\n"
    )


def same(a, b, columns, skip=""):
    """Two frames agree bit for bit."""
    assert a.step == b.step
    for name in columns.split():
        if name in skip.split():
            continue
        different = np.flatnonzero(a[name] != b[name])
        assert not len(different), (a.step, name, len(different), a["type"][different][:5])


def topology_counts(result):
    """Atoms, bonds and dihedrals of the last thermo line."""
    row = result.thermo[-1]
    return tuple(int(row[name]) for name in ("Atoms", "Bonds", "Diheds"))
