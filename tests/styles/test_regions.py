"""Regions of faces at a division: daughters have those of the mother's surface they come from."""

import numpy as np
import pytest

from support.data_files import section
from support.divisions import FACE, NODE, Cell, frame_at, molecules, read_log, scene_of

LATERAL, APICAL = 0, 2  # numbers of doc page atom_style_dcm
COLUMNS = (
    "id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_c[1] c_c[2] c_c[3] xu yu zu vx vy vz fx fy fz"
)


def data_with_regions(lmp, scenes, top):
    """Data file of one cell whose faces with centroids that `top` picks are apical."""
    scene = scene_of(scenes, 15.0, "f f f")
    scene.dcm(0.0, 0.0, 0.0, 6.0, options="rotate 3 rest 1")
    data = lmp(scene.head() + "write_data x.data nofix nocoeff\n").path / "x.data"
    text = data.read_text()
    atoms = [line.split() for line in section(text.replace("Atoms # dcm", "Atoms"), "Atoms")]
    # id mol type kind radius x y z v1 v2 v3 region volume0 ix iy iz
    for row in atoms:
        if int(row[3]) == FACE:
            assert int(row[11]) == LATERAL
            row[11] = str(APICAL if top(np.array(row[5:8], dtype=float)) else LATERAL)
    start, _, rest = text.partition("Atoms # dcm\n\n")
    end = rest.partition("\n\n")[2]
    lines = "\n".join(" ".join(row) for row in atoms)
    return scene, f"{start}Atoms # dcm\n\n{lines}\n\n{end}"


def divide(lmp, scenes, plane, top, np_):
    scene, data = data_with_regions(lmp, scenes, top)
    deck = (
        "units lj\natom_style dcm\nnewton on\nboundary f f f\n"
        "read_data x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
        + scene.cortex()
        + scene.contact()
        + "fix cell all dcm/cell\n"
        + scene.volume()
        + f"fix grow all dcm/growth {scene.map} seed 5 cycle_time 40\n"
        + f"fix divide all dcm/division seed 7 log div.log plane given {plane}\n"
        + scene.motion(options="")
        + "timestep 1.0\n"
        + "compute p all property/atom kind vertex1 vertex2 vertex3 region\n"
        + "compute c all dcm/cell volume volume0 contact_area\n"
        + scenes.dump(COLUMNS, 1)
        + "run 41\n"
    )
    return lmp(deck, np=np_, files={"x.data": data})


def regions(frame, molecule):
    mine = (frame["mol"] == molecule) & (frame["c_p[1]"] == FACE)
    return frame["c_p[5]"][mine].astype(int)


def distances(cell, point):
    """From a point to each face of a cell: to its plane where the foot lies within, else to an
    edge.
    """
    a, b, c = cell.corners
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n, axis=1)[:, None]
    height = ((point - a) * n).sum(axis=1)
    foot = point - height[:, None] * n
    within, edge = np.ones(len(a), dtype=bool), np.full(len(a), np.inf)
    for u, w in ((a, b), (b, c), (c, a)):
        e = w - u
        within &= (np.cross(e, foot - u) * n).sum(axis=1) >= 0.0
        t = np.clip(((point - u) * e).sum(axis=1) / (e * e).sum(axis=1), 0.0, 1.0)
        edge = np.minimum(edge, np.linalg.norm(point - u - t[:, None] * e, axis=1))
    return np.where(within, np.abs(height), edge)


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("plane", ["1 0 0", "0 0 1"])
def test_daughters_inherit_regions(lmp, scenes, plane, np_):
    """The mother is apical above, z > 0. A daughter's face nearer to her surface than to the new
    plane has the region of her nearest face, one nearer to the plane is lateral.
    """
    result = divide(lmp, scenes, plane, lambda x: x[2] > 0.0, np_)
    (row,) = read_log(result.path)
    before, frame = frame_at(result, row["step"] - 1), frame_at(result, row["step"])
    mother, old = Cell(before, 1, at=1.0), regions(before, 1)
    assert set(old) == {LATERAL, APICAL} and len(old) == 80
    assert molecules(frame) == [2, 3]
    normal = np.array([float(x) for x in plane.split()])
    point = mother.centroid  # a round cell is halved at its center
    seen = {"surface": 0, "plane": 0}
    for molecule, side in ((2, 1.0), (3, -1.0)):
        cell, new = Cell(frame, molecule), regions(frame, molecule)
        assert side * (cell.centroid - point) @ normal > 1.0
        assert set(new) <= {LATERAL, APICAL}
        for middle, region in zip(sum(cell.corners) / 3.0, new, strict=True):
            from_plane = abs((middle - point) @ normal)
            far = distances(mother, middle)
            nearest = far.min()
            if abs(from_plane - nearest) < 0.05:
                continue  # as near to the one as to the other
            if from_plane < nearest:
                assert region == LATERAL
                seen["plane"] += 1
                continue
            candidates = set(old[far < nearest + 0.01])
            assert region in candidates
            seen["surface"] += len(candidates) == 1
        # no farther down than the mother was apical: faces across z = 0 count to either side
        height = (sum(cell.corners) / 3.0)[:, 2]
        lowest = min(p[old == APICAL][:, 2].min() for p in mother.corners)
        assert (height[new == APICAL] > lowest).all()
        apical = (new == APICAL).sum()
        assert apical > 20 if plane == "1 0 0" or side > 0 else apical < 5
    assert min(seen.values()) > 20


def test_a_lateral_mother_has_lateral_daughters(lmp, scenes):
    result = divide(lmp, scenes, "1 0 0", lambda x: False, 1)
    frame = frame_at(result, 41)
    for molecule in (2, 3):
        assert set(regions(frame, molecule)) == {LATERAL}


def test_same_regions_on_ranks(lmp, scenes):
    """By face; and they stay with the faces in the steps that follow."""
    found = []
    for np_ in (1, 2, 4):
        result = divide(lmp, scenes, "1 1 1", lambda x: x[2] > 2.0, np_)
        at, after = frame_at(result, 40), frame_at(result, 41)
        assert np.array_equal(at["c_p[5]"], after["c_p[5]"])
        found.append(after["c_p[5]"])
        assert (at["c_p[1]"] == NODE).sum() == 84
    assert APICAL in found[0]
    assert np.array_equal(found[0], found[1]) and np.array_equal(found[0], found[2])
