"""Decks with deformable cells and tracers (fix dcm/tracer), and where tracers are: judged by the
solid angle of surfaces, which the code under test does not use."""

import re

import numpy as np

TYPE = 5
CENTER, NODE, FACE, TRACER = 2, 3, 4, 5  # kinds
COLUMNS = "id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6] xu yu zu"
NAMES = [
    "inside",
    "outside",
    "exits",
    "swept",
    "caught",
    "rejected",
    "capped",
    "deleted",
    "blocked",
]


APICAL = 2


class Deck:
    """Deformable cells and tracers of atom type 5; parts of a deck in their order."""

    def __init__(self, lmp, scenes, scene, apical=None, more=""):
        """apical: which faces, by centroid and cell, let tracers out; more: cell types of atom
        types beyond that of tracers."""
        self.scenes, self.scene = scenes, scene
        scene.NAMES = f"hepatoblast hepatoblast hepatoblast NULL NULL {more}".strip()
        self.boundary = scene.boundary
        made = lmp(
            scene.head().replace("create_box 4", f"create_box {len(scene.NAMES.split())}")
            + "write_data x.data nofix nocoeff\n"
        )
        start, _, rest = (made.path / "x.data").read_text().partition("Atoms # dcm\n\n")
        rows, end = rest.split("\n\n", 1)
        velocities, _, end = end.partition("Bonds")
        assert velocities.split()[0] == "Velocities"
        end = "Bonds" + end
        start = re.sub(r"(\S+) (\S+) ([xyz]lo)", r"-30 30 \3", start)
        rows = [line.split() for line in rows.splitlines()]
        # id mol type kind radius x y z v1 v2 v3 region volume0 ix iy iz
        for row in rows:
            if int(row[3]) == FACE and apical and apical(np.array(row[5:8], float), int(row[1])):
                row[11] = str(APICAL)
        self.rows, self.start, self.end = rows, start, end

    def data(self, tracers=()):
        """Data file; tracers: (x, y, z, home)."""
        first = max(int(row[0]) for row in self.rows) + 1
        more = [
            f"{first + n} 0 {TYPE} {TRACER} 0 {x} {y} {z} {home} 0 0 0 0 0 0 0"
            for n, (x, y, z, home) in enumerate(tracers)
        ]
        n = len(self.rows)
        start = self.start.replace(f"{n} atoms", f"{n + len(more)} atoms")
        lines = [" ".join(row) for row in self.rows] + more
        return start + "Atoms # dcm\n\n" + "\n".join(lines) + "\n\n" + self.end

    def files(self, tracers=()):
        return {"x.data": self.data(tracers)}

    def head(self, read="read_data x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"):
        return f"units lj\natom_style dcm\nnewton on\nboundary {self.boundary}\n{read}"

    def __call__(
        self,
        tracer,
        steps,
        *,
        head=None,
        before="",
        motion="",
        dump=True,
        every=1,
        group="all",
        after="",
        laws=None,
    ):
        return (
            (self.head() if head is None else head)
            + (self.scene.forces() if laws is None else laws)
            + before
            + (f"fix tracer {group} dcm/tracer type {TYPE} {tracer}\n" if tracer else "")
            + (motion or self.scene.motion())
            + "timestep 1.0\n"
            + output(self.scenes, every, dump, bool(tracer))
            + after
            + (f"run {steps}\n" if steps else "")
        )


def output(scenes, every, dump, tracer=True):
    columns = ["atoms", "elapsed"] + (
        [f"{n}=f_tracer[{k + 1}]" for k, n in enumerate(NAMES)] if tracer else []
    )
    return (
        "compute p all property/atom kind vertex1 vertex2 vertex3 home host\n"
        + (scenes.dump(COLUMNS, every) if dump else "")
        + scenes.thermo(columns, every)
    )


def winding(x, corners):
    """Solid angle of a closed surface seen from points x, over 4 pi."""
    lo, hi = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    near = np.flatnonzero(((x >= lo) & (x <= hi)).all(axis=1))
    if len(near) < len(x):
        result = np.zeros(len(x))
        if len(near):
            result[near] = winding(x[near], corners)
        return result
    a, b, c = (corners[None, :, k] - x[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    triple = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    below = (
        la * lb * lc
        + np.einsum("ijk,ijk->ij", a, b) * lc
        + np.einsum("ijk,ijk->ij", b, c) * la
        + np.einsum("ijk,ijk->ij", c, a) * lb
    )
    return np.arctan2(triple, below).sum(axis=1) / (2 * np.pi)


def surfaces(frame):
    """Corners (faces, 3, 3) of each deformable cell of a frame."""
    kind, place = frame["c_p[1]"], {int(tag): n for n, tag in enumerate(frame["id"])}
    cells = {}
    for mol in np.unique(frame["mol"][kind == FACE]):
        rows = np.flatnonzero((kind == FACE) & (frame["mol"] == mol))
        vertices = frame.vectors("c_p[2]", "c_p[3]", "c_p[4]")[rows].astype(int)
        cells[int(mol)] = frame.x[np.vectorize(place.get)(vertices)]
    return cells


def tracers(frame):
    rows = np.flatnonzero(frame["c_p[1]"] == TRACER)
    return (
        frame["id"][rows].astype(int),
        frame.x[rows],
        frame["c_p[5]"][rows].astype(int),
        frame["c_p[6]"][rows].astype(int),
    )


def right_places(frames, period=None):
    """Tracers of each frame are among the surfaces of the frame before, against which they were
    moved; new cells, among those of their own. period: lengths of a periodic box."""
    for before, frame in zip(frames[:-1], frames[1:], strict=True):
        cells = {**surfaces(frame), **surfaces(before)}
        _, places, home, host = tracers(frame)
        now = set(surfaces(frame))
        assert set(home) <= {0, *now}
        for mol in now:
            x = places
            if period is not None:  # the image next to the cell
                away = places - cells[mol].mean(axis=(0, 1))
                x = places - period * np.round(away / period)
            inside = winding(x, cells[mol]) > 0.5
            assert not np.count_nonzero(~inside & (home == mol)), (frame.step, mol)
            assert not np.count_nonzero(inside & (home == 0) & (host == 0)), (frame.step, mol)


def same_tracers(a, b):
    assert a.step == b.step
    for one, other in zip(tracers(a), tracers(b), strict=True):
        assert np.array_equal(one, other), a.step
