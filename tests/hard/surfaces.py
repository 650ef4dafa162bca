"""What the dump of a hard case says: nodes, faces, cells, forces; independent of the package."""

from functools import cached_property

import numpy as np

NODE, FACE, SPHERE = 3, 4, 1  # column kind


class Snapshot:
    """One frame of a dump: arrays by column, rows sorted by atom ID; time and box."""

    def __init__(self, step, time, box, names, table):
        self.step, self.time, self.box = step, time, box
        table = table[np.argsort(table[:, names.index("id")], kind="stable")]
        self.columns = {name: table[:, k] for k, name in enumerate(names)}

    def __getitem__(self, name):
        return self.columns[name]

    def __contains__(self, name):
        return name in self.columns

    def vectors(self, *names):
        return np.stack([self.columns[n] for n in names], axis=1)

    @cached_property
    def x(self):
        return self.vectors("xu", "yu", "zu")

    @cached_property
    def v(self):
        return self.vectors("vx", "vy", "vz")

    @cached_property
    def f(self):
        return self.vectors("fx", "fy", "fz")

    @cached_property
    def moving(self):
        """Which atoms are nodes or spheres."""
        return (self["kind"] == NODE) | (self["kind"] == SPHERE)

    @cached_property
    def cells(self):
        """Deformable cells by molecule ID."""
        return {int(m): Surface(self, m) for m in np.unique(self["mol"][self["kind"] == NODE])}

    @cached_property
    def spheres(self):
        """Center and radius of the center-based cells, by molecule ID."""
        rows = np.flatnonzero(self["kind"] == SPHERE)
        return {int(self["mol"][r]): (self.x[r], self["radius"][r]) for r in rows}

    @property
    def lengths(self):
        return self.box[:, 1] - self.box[:, 0]


def read_snapshots(path):
    """All frames of a text dump written with `dump_modify time yes`."""
    frames = []
    before, *parts = path.read_text().split("ITEM: TIMESTEP\n")
    for part in parts:  # the time stands before its frame
        head, _, body = part.partition("ITEM: ATOMS ")
        names, _, rows = body.partition("\n")
        lines = head.splitlines()
        step = int(lines[0])
        time = before.rpartition("ITEM: TIME\n")[2].split()
        time = float(time[0]) if len(time) == 1 else np.nan
        at = next(k for k, line in enumerate(lines) if line.startswith("ITEM: BOX"))
        box = np.array([line.split()[:2] for line in lines[at + 1 : at + 4]], dtype=float)
        names = names.split()
        rows = rows.partition("ITEM:")[0]  # of the next frame
        table = np.array(rows.split(), dtype=float).reshape(-1, len(names))
        before = part
        frames.append(Snapshot(step, time, box, names, table))
    return frames


class Surface:
    """The closed surface of one deformable cell in a frame."""

    def __init__(self, frame, molecule):
        mine = frame["mol"] == molecule
        self.frame, self.molecule = frame, int(molecule)
        self.rows = np.flatnonzero(mine & (frame["kind"] == NODE))
        faces = np.flatnonzero(mine & (frame["kind"] == FACE))
        self.x = frame.x[self.rows]
        index = {tag: n for n, tag in enumerate(frame["id"][self.rows].astype(int))}
        vertices = frame.vectors("v1", "v2", "v3")[faces].astype(int)
        self.faces = np.array([[index[v] for v in face] for face in vertices])

    @cached_property
    def edges(self):
        half = np.sort(np.vstack([self.faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
        return np.unique(half, axis=0)

    @cached_property
    def corners(self):
        return tuple(self.x[self.faces[:, k]] for k in range(3))

    @cached_property
    def area_vectors(self):
        a, b, c = self.corners
        return 0.5 * np.cross(b - a, c - a)

    @cached_property
    def areas(self):
        return np.linalg.norm(self.area_vectors, axis=1)

    @cached_property
    def volume(self):
        a, b, c = (p - self.x[0] for p in self.corners)
        return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0

    @cached_property
    def centroid(self):
        """Of the enclosed volume."""
        a, b, c = (p - self.x[0] for p in self.corners)
        w = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
        return self.x[0] + (w[:, None] * (a + b + c) / 4.0).sum(axis=0) / w.sum()

    @property
    def radius(self):
        return np.cbrt(0.75 * self.volume / np.pi)

    @cached_property
    def mean_edge(self):
        d = self.x[self.edges[:, 1]] - self.x[self.edges[:, 0]]
        return np.linalg.norm(d, axis=1).mean()

    @property
    def quality(self):
        """Of the worst face; 1: equilateral, 0: no area."""
        a, b, c = self.corners
        sides = sum(((p - q) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a)))
        return (4.0 * np.sqrt(3.0) * self.areas / sides).min()

    @property
    def extent(self):
        return np.ptp(self.x, axis=0)

    @property
    def closed(self):
        """Every edge once in each direction, the topology of a sphere, every node in use."""
        half = {(f[k], f[(k + 1) % 3]) for f in self.faces for k in range(3)}
        return (
            len(half) == 3 * len(self.faces)
            and all((b, a) in half for a, b in half)
            and len(self.x) - len(half) // 2 + len(self.faces) == 2
        )

    def near(self, points, lengths=None):
        """A group of points moved by whole periods, so that its mean comes closest."""
        if lengths is None:
            return points
        shift = points.mean(axis=0) - self.x.mean(axis=0)
        return points - lengths * np.round(shift / lengths)

    def inside(self, points):
        """Which points lie inside: by the winding number."""
        found = np.zeros(len(points), dtype=bool)
        low, high = self.x.min(axis=0), self.x.max(axis=0)
        maybe = np.flatnonzero(((points > low) & (points < high)).all(axis=1))
        for some in np.array_split(maybe, max(1, len(maybe) * len(self.faces) // 200000)):
            a, b, c = (p[None] - points[some][:, None] for p in self.corners)
            la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
            dot = lambda u, v: np.einsum("ijk,ijk->ij", u, v)  # noqa: E731
            top = dot(a, np.cross(b, c))
            low_ = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la
            found[some] = 2.0 * np.arctan2(top, low_).sum(axis=1) > 2.0 * np.pi
        return found

    def depth(self, points):
        """How deep the deepest of the points lies inside, 0 if none does."""
        deep = points[self.inside(points)]
        return max((self.distance(p) for p in deep), default=0.0)

    def distance(self, point):
        """Of a point to the surface: to the plane of a face where the foot lies in it, else to an
        edge."""
        a, b, c = self.corners
        n = self.area_vectors / self.areas[:, None]
        height = ((point - a) * n).sum(axis=1)
        foot = point - height[:, None] * n
        within = np.ones(len(a), dtype=bool)
        nearest = np.inf
        for u, w in ((a, b), (b, c), (c, a)):
            e = w - u
            within &= (np.cross(e, foot - u) * n).sum(axis=1) >= 0.0
            t = np.clip(((point - u) * e).sum(axis=1) / (e * e).sum(axis=1), 0.0, 1.0)
            nearest = min(nearest, np.linalg.norm(point - u - t[:, None] * e, axis=1).min())
        return min(nearest, np.abs(height[within]).min() if within.any() else np.inf)


def deepest_overlap(frame, periodic=False):
    """How deep a node or the middle of a face of a deformable cell lies in another, in mean edges
    of the cell of the two whose edges are shorter; with the two molecule IDs."""
    worst, who = 0.0, (0, 0)
    lengths = frame.lengths if periodic else None
    cells = list(frame.cells.values())
    for a in cells:
        points = np.vstack([a.x, sum(a.corners) / 3.0])
        reach = np.linalg.norm(a.extent)
        for b in cells:
            if a is b:
                continue
            moved = b.near(points, lengths)
            apart = np.linalg.norm(moved.mean(axis=0) - b.x.mean(axis=0))
            if apart > 0.5 * (reach + np.linalg.norm(b.extent)):
                continue
            depth = b.depth(moved) / min(a.mean_edge, b.mean_edge)
            if depth > worst:
                worst, who = depth, (a.molecule, b.molecule)
    return worst, who


def deepest_sphere(frame):
    """How deep a sphere's center lies in a cell, or a face's middle in a sphere, in radii of the
    sphere: 1 and more is through."""
    worst = 0.0
    for center, radius in frame.spheres.values():
        for cell in frame.cells.values():
            if cell.inside(center[None])[0]:
                return 1.0
            apart = np.linalg.norm(sum(cell.corners) / 3.0 - center, axis=1).min()
            worst = max(worst, 1.0 - apart / radius)
    return worst


def free_areas(frame):
    """Per atom: a third of the faces around a node, free of contact (column `covered`, if any)."""
    areas = np.zeros(len(frame["id"]))
    for cell in frame.cells.values():
        np.add.at(areas, cell.rows[cell.faces], (cell.areas / 3.0)[:, None])
    return areas


def dissipation(frame, gamma, friction):
    """Power that goes into isotropic dashpots of the edges and friction with the surroundings of
    cells that touch nothing."""
    power = (friction * free_areas(frame) * (frame.v**2).sum(axis=1)).sum()
    for cell in frame.cells.values():
        v = frame.v[cell.rows]
        power += gamma * ((v[cell.edges[:, 1]] - v[cell.edges[:, 0]]) ** 2).sum()
    return power
