"""fix dcm/osmosis: marks, pressure, work; closed forms, ranks, restart."""

import math

import numpy as np
import pytest

from support.data_files import section

FOREVER = 1e9
VECTOR = ("area", "faces", "cells", "volume", "pressure", "force", "closure", "lost", "solute")
KV, SURFACE = 2.5, 4.0  # of support/parameters.py


def osmosis(options, group="all", id="osm"):
    return f"fix {id} {group} dcm/osmosis {options}\n"


def everywhere(r=100.0):
    """All faces within r of the origin are sources, in contact or not."""
    return f"marks flood starter 0 0 0 {r} {FOREVER}"


def values(scenes, every=1, extra=(), id="osm"):
    names = [f"{name}=f_{id}[{n}]" for n, name in enumerate(VECTOR, 1)] + [f"work=f_{id}"]
    return scenes.thermo([*names, *extra], every)


def get(row, name):
    return row["v_" + name]


def with_regions(lmp, scene, pick, setup=""):
    """Data file of the scene in which faces are apical if pick(molecule, centroid)."""
    data = lmp(scene.head() + setup + "write_data x.data nofix nocoeff\n").path / "x.data"
    text = data.read_text()
    atoms = [line.split() for line in section(text.replace("Atoms # dcm", "Atoms"), "Atoms")]
    # id mol type kind radius x y z v1 v2 v3 region volume0 ix iy iz
    for row in atoms:
        if int(row[3]) == 4:
            row[11] = "2" if pick(int(row[1]), np.array(row[5:8], dtype=float)) else "0"
    start, _, rest = text.partition("Atoms # dcm\n\n")
    end = rest.partition("\n\n")[2]
    lines = "\n".join(" ".join(row) for row in atoms)
    return f"{start}Atoms # dcm\n\n{lines}\n\n{end}"


def read(boundary="s s s"):
    return (
        f"units lj\natom_style dcm\nnewton on\nboundary {boundary}\n"
        "read_data x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
    )


# --- pressure -------------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("P", [0.0, 0.3])
def test_pressure_all_around_one_cell(lmp, scenes, P, np_):
    """Like an outer pressure: p = P + 2T/R at rest, and V = V0 exp(-p/K_V); nothing moves on.

    On a mesh 2T/R is exactly -W/(3V), W being the virial of its edges: hinges have none.
    """
    scene = scenes.single_cell(level=2)
    result = lmp(
        scene.head() + scene.forces() + osmosis(f"pressure {P} {everywhere()}")
        + scene.motion(options="tolerance 1e-12")
        + "compute c all dcm/cell volume volume0 pressure area\n"
        + "compute v all reduce sum c_c[*]\n"
        + "compute edges all pressure NULL bond\n"
        + scenes.dump("id mol type xu yu zu vx vy vz fx fy fz", 600)
        + values(scenes, 600, [*(f"c{k}=c_v[{k}]" for k in (1, 2, 3, 4)), "W=3*c_edges*vol"])
        + "timestep 1.0\nrun 600\n",
        np=np_,
    )  # fmt: skip
    last, frame = result.thermo[-1], result.dump()[-1]
    V, V0, p, S = (get(last, f"c{k}") for k in (1, 2, 3, 4))
    assert V == pytest.approx(V0 * math.exp(-p / KV), rel=1e-12)
    assert p == pytest.approx(P - get(last, "W") / (3 * V), rel=1e-6)
    R, scale = math.cbrt(0.75 * V / math.pi), p * S
    assert np.abs(frame.f.sum(axis=0)).max() < 1e-13 * scale
    assert np.abs(np.cross(frame.x, frame.f).sum(axis=0)).max() < 1e-13 * R * scale
    assert get(last, "pressure") == P
    # the marked faces look out of the cell: what they enclose counts against the lumen
    assert get(last, "volume") == pytest.approx(-V, rel=1e-12)
    assert get(last, "area") == pytest.approx(S, rel=1e-12)
    assert (get(last, "faces"), get(last, "cells")) == (320, 1)
    assert get(last, "closure") < 1e-13 and get(last, "force") <= 1e-12 * P * S
    assert "the lumen is open" in result.out
