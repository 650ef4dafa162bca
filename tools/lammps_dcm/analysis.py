"""Analyses of deformable cells: volume, area, pressure, faces, mesh quality, contacts.

All are MDAnalysis AnalysisBase classes: build with a Universe of `lammps_dcm.load`, call `run()`
(start, stop, step, frames as usual), read `results`. A cell is its molecule ID in each frame (see
frame_atoms.py): columns are the cells of all analysed frames together, rows the frames; what does
not exist in a frame is NaN. They work on the double-precision columns of the dump, not on the
single-precision `positions`.
"""
import numpy as np
from MDAnalysis.analysis.base import AnalysisBase
from MDAnalysis.lib.distances import capped_distance, self_capped_distance

from .frame_atoms import AtomBook
from .mesh import Mesh
from .topology import CENTER, FACE
from .triangles import tetrahedron_volumes, triangle_quality, triangle_vectors


class MeshAnalysis(AnalysisBase):
    """Common part of the analyses: `mesh()` of the current frame, and tables of what `_put` gets.

    results.cells: (n,) molecule IDs of all deformable cells in the analysed frames, sorted;
    results.present: (frames, n) bool, the frame has the cell as a deformable one; results.steps,
    results.times: (frames,) LAMMPS step and s. book: AtomBook of the Universe, if several analyses
    shall share it; it warns once.
    """

    def __init__(self, universe, book=None, **kwargs):
        super().__init__(universe.trajectory, **kwargs)
        self.universe = universe
        self.book = book or AtomBook(universe)
        kinds, data = self.book.kind, universe.trajectory.ts.data
        if not (kinds == FACE).any() and "kind" not in data:
            raise ValueError("no face atoms are known: open the trajectory together with its data "
                             "file, lammps_dcm.load(data, dump), or dump the columns id mol type "
                             "kind v1 v2 v3 (compute property/atom, dump_modify colname)")

    def _prepare(self):
        self.results.steps = np.zeros(self.n_frames, dtype=int)
        self.results.times = np.zeros(self.n_frames)
        self._cells = []     # per frame: molecule IDs
        self._values = {}    # name -> per frame an array, an entry per cell

    def mesh(self):
        """Mesh of the current frame; notes step, time and cells of the frame."""
        self.results.steps[self._frame_index] = self._ts.data.get("step", 0)
        self.results.times[self._frame_index] = self._ts.time
        mesh = Mesh(self.book.frame())
        self._cells.append(mesh.ids)
        self.warn_cells(mesh, ~mesh.known, "the vertices of its faces are not known: dump the "
                        "columns v1 v2 v3 (compute property/atom)")
        return mesh

    def _put(self, **values):
        """Keep, for the table of that name, an entry (of any shape) per cell of the frame."""
        for name, column in values.items():
            self._values.setdefault(name, []).append(column)

    def _conclude(self):
        ids = np.unique(np.concatenate([np.zeros(0, dtype=int), *self._cells]))
        self.results.cells = ids
        self.results.present = np.zeros((self.n_frames, len(ids)), dtype=bool)
        for name, columns in self._values.items():
            first = columns[0]
            absent = 0 if first.dtype.kind == "i" else np.nan
            table = np.full((self.n_frames, len(ids), *first.shape[1:]), absent, first.dtype)
            for k, column in enumerate(columns):
                table[k, np.searchsorted(ids, self._cells[k])] = column
            self.results[name] = table
        for k, here in enumerate(self._cells):
            self.results.present[k, np.searchsorted(ids, here)] = True

    def warn_cells(self, mesh, which, text):
        """Warn once per text about the cells in the bool array `which`."""
        if which.any():
            names = ", ".join(map(str, mesh.ids[which][:5]))
            self.book.warn(text, f"{mesh.atoms.where}: cell {names}"
                           f"{' ...' if which.sum() > 5 else ''}")

    def warn_missing(self, mesh):
        """Warn about cells some of whose nodes are not in the dump."""
        self.warn_cells(mesh, mesh.known & ~mesh.complete,
                        "nodes are missing in the dump: dump all atoms")


def mean_of_nodes(mesh):
    """Mean of the nodes of every cell, (c, 3), relative to mesh.origin, um."""
    n = len(mesh.ids)
    nodes, at = np.unique(mesh.vertices, return_index=True)
    cell = mesh.cell[at // 3]
    count = np.maximum(np.bincount(cell, minlength=n), 1)
    corner = mesh.corners.reshape(-1, 3)[at]
    return np.stack([np.bincount(cell, c, minlength=n) / count for c in corner.T], axis=1)


def measure_cells(mesh):
    """Volume (c,), um^3, area (c,), um^2, and mean of the nodes (c, 3), um, of the cells of a Mesh,
    NaN where nodes are missing or the surface is open; leaky: (c,) bool, the latter."""
    n = len(mesh.ids)
    vectors = triangle_vectors(mesh.corners)
    area = np.bincount(mesh.cell, np.linalg.norm(vectors, axis=1), minlength=n)
    volume = np.bincount(mesh.cell, tetrahedron_volumes(mesh.corners), minlength=n)
    open_ = np.linalg.norm([np.bincount(mesh.cell, v, minlength=n) for v in vectors.T], axis=0)
    leaky = mesh.complete & (open_ > 1e-9 * area)
    good = mesh.complete & ~leaky
    center = np.where(good[:, None], mesh.origin + mean_of_nodes(mesh), np.nan)
    return np.where(good, volume, np.nan), np.where(good, area, np.nan), center, leaky


class CellVolume(MeshAnalysis):
    """Volume and surface of every deformable cell.

    results.volume: (frames, cells), um^3, the signed sum of tetrahedra; results.area: (frames,
    cells), um^2; results.center: (frames, cells, 3), um, mean of the nodes, next to the center
    atom. A cell with missing nodes or an open surface gets NaN and a warning.
    """

    def _single_frame(self):
        self._measure(self.mesh())

    def _measure(self, mesh):
        volume, area, center, leaky = measure_cells(mesh)
        self.warn_missing(mesh)
        self.warn_cells(mesh, leaky, "the surface is not closed: faces are missing in the dump or "
                        "data file: dump all atoms")
        self._put(volume=volume, area=area, center=center)
        return volume


class CellPressure(CellVolume):
    """Pressure p = -K_V ln(V/V0) of every deformable cell (S1 eq 6), plus all of CellVolume.

    bulk_modulus: K_V, kPa, one number or a dict of atom type of the cell's center -> number.
    results.pressure: (frames, cells), kPa; results.volume0: (frames, cells), um^3, from a dump
    column `volume0` if there, else from the data file; that holds until a cell grows.
    """

    def __init__(self, universe, bulk_modulus, **kwargs):
        super().__init__(universe, **kwargs)
        self.modulus_of_type = {}
        if isinstance(bulk_modulus, dict):
            self.modulus_of_type = {str(k): float(v) for k, v in bulk_modulus.items()}
            self._moduli(self.book.type[self.book.kind == CENTER])
            given = np.array(list(self.modulus_of_type.values()))
        else:
            given = np.array([float(bulk_modulus)])
            self.modulus = given[0]
        if not (np.isfinite(given) & (given > 0.0)).all():
            raise ValueError(f"bulk_modulus is {bulk_modulus}: it must be positive, kPa")

    def _moduli(self, types):
        """Bulk moduli of cells whose centers have `types`."""
        if not self.modulus_of_type:
            return np.full(len(types), self.modulus)
        lacking = sorted(set(types) - set(self.modulus_of_type))
        if lacking:
            raise ValueError(f"bulk_modulus has no entry for center type {', '.join(lacking)}; it "
                             f"has {', '.join(self.modulus_of_type)}")
        return np.array([self.modulus_of_type[t] for t in types])

    def _measure(self, mesh):
        volume = super()._measure(mesh)
        pressure, volume0 = self.pressures(mesh, volume)
        self._put(pressure=pressure, volume0=volume0)
        return volume

    def pressures(self, mesh, volume):
        """Pressures, kPa, and rest volumes, um^3, (c,) each, of the cells of a Mesh with volumes
        (c,), um^3."""
        volume0 = np.where(mesh.centers >= 0, mesh.atoms.volume0[mesh.centers], np.nan)
        volume0 = np.where(volume0 > 0.0, volume0, np.nan)
        self.warn_cells(mesh, np.isnan(volume0) & ~np.isnan(volume), "no rest volume: load the "
                        "data file too, or dump the column volume0")
        if "volume0" not in mesh.atoms.data:
            self.warn_cells(mesh, ~np.isin(mesh.ids, self.book.mol), "born after the data file was "
                            "written, so cells grow, and its rest volumes hold for its own moment "
                            "only: dump the column volume0 (compute property/atom)")
        self.warn_cells(mesh, volume <= 0.0, "the volume is not positive: the cell is inside out")
        with np.errstate(divide="ignore", invalid="ignore"):
            pressure = -self._moduli(mesh.types) * np.log(volume / volume0)
        return np.where(volume > 0.0, pressure, np.nan), volume0


class FaceArea(MeshAnalysis):
    """Area of every face. A column is a face of a cell: results.faces: (faces,) atom IDs;
    results.cell: (faces,) molecule IDs; the same atom ID may occur with several cells, one after
    the other. results.area: (frames, faces), um^2; results.regions: (frames, faces), region of the
    face, -1 where it is absent or the region is not known."""

    def _prepare(self):
        super()._prepare()
        self._faces = []    # per frame: cell and ID (f, 2), area, region

    def _single_frame(self):
        mesh = self.mesh()
        key = np.stack([mesh.ids[mesh.cell], self.book.ids[mesh.faces]], axis=1)
        area = np.linalg.norm(triangle_vectors(mesh.corners), axis=1)
        self._faces.append((key, area, mesh.atoms.region[mesh.faces]))

    def _conclude(self):
        super()._conclude()
        every = np.concatenate([np.zeros((0, 2), dtype=int), *[key for key, _, _ in self._faces]])
        faces, at = np.unique(every, axis=0, return_inverse=True)
        self.results.cell, self.results.faces = faces.T
        self.results.area = np.full((self.n_frames, len(faces)), np.nan)
        self.results.regions = np.full((self.n_frames, len(faces)), -1)
        frame = np.repeat(np.arange(self.n_frames), [len(key) for key, _, _ in self._faces])
        for name, n in (("area", 1), ("regions", 2)):
            self.results[name][frame, at] = np.concatenate([f[n] for f in self._faces])


class CellQuality(MeshAnalysis):
    """Quality of the triangles of every cell, 4 sqrt(3) A / (sum of squared edges): 1 for an
    equilateral one, 0 for one without area.

    results.worst, results.median: (frames, cells); results.worst_face: (frames, cells), atom ID of
    the worst face, 0 where unknown. A cell with missing nodes gets NaN and a warning.
    """

    def _single_frame(self):
        mesh = self.mesh()
        n = len(mesh.ids)
        self.warn_missing(mesh)
        quality = triangle_quality(mesh.corners)
        order = np.lexsort((quality, mesh.cell))
        begin = np.searchsorted(mesh.cell[order], np.arange(n + 1))
        worst, median, face = np.full(n, np.nan), np.full(n, np.nan), np.zeros(n, dtype=int)
        for cell in np.flatnonzero(mesh.complete):
            own = order[begin[cell]:begin[cell + 1]]    # the worst first
            worst[cell], median[cell] = quality[own[0]], np.median(quality[own])
            face[cell] = self.book.ids[mesh.faces[own[0]]]
        self._put(worst=worst, median=median, worst_face=face)


class CellContacts(MeshAnalysis):
    """Contact area and neighbors of every cell.

    column: per-face contact area in the dump, um^2 (`compute dcm/face`; name it with
    lammps_dcm.load(rename=...)). results.contact_area: (frames, cells), um^2, its sum over the
    cell; results.fraction: the same over the cell's area. Both stay NaN without the column.
    results.neighbors: per frame an array (pairs, 2) of molecule IDs, CBM cells included, smaller
    first, whose surfaces come within `cutoff` (um; by default the mean edge length), a face
    counting as its centroid: a geometric criterion, not a force.
    With shares, results.shared: per frame an array (pairs, 2) of molecule IDs that share contact
    area, and results.shared_area: per frame (pairs,), um^2. The dump does not tell the partner of a
    face: all its contact area counts for the nearest surface of another cell, within two mean
    edges, and that of two cells is the mean of both sides, of a cell and a sphere that of the
    faces. Both are empty without the column.
    """

    def __init__(self, universe, column="contact_area", cutoff=None, shares=False, **kwargs):
        super().__init__(universe, **kwargs)
        self.column, self.cutoff, self.shares = column, cutoff, shares

    def _prepare(self):
        super()._prepare()
        self.results.neighbors = []
        if self.shares:
            self.results.shared, self.results.shared_area = [], []

    def _single_frame(self):
        mesh = self.mesh()
        n, data = len(mesh.ids), self._ts.data
        contact = total = np.full(n, np.nan)
        if self.column in data:
            share = np.nan_to_num(data[self.column][mesh.faces])
            area = np.linalg.norm(triangle_vectors(mesh.corners), axis=1)
            contact = np.where(mesh.complete, np.bincount(mesh.cell, share, minlength=n), np.nan)
            total = np.where(mesh.complete, np.bincount(mesh.cell, area, minlength=n), np.nan)
        self._put(contact_area=contact, fraction=contact / total)
        surfaces = _Surfaces(mesh, self._ts.dimensions)
        self.results.neighbors.append(surfaces.near(self.cutoff))
        if not self.shares:
            return
        if self.column in data:
            pairs, area = surfaces.shared(share)
            lost = share.sum() - area.sum()
            if lost > 0.01 * share.sum():
                self.book.warn(f"{lost:.3g} of {share.sum():.3g} um^2 of contact area are farther "
                               "than two mean edges from any other cell: are all cells in the "
                               "dump?", mesh.atoms.where)
        else:
            pairs, area = np.zeros((0, 3), dtype=int), np.zeros(0)
        cells, at = np.unique(np.sort(pairs[:, :2], axis=1), axis=0, return_inverse=True)
        sides = np.bincount(at, np.where(pairs[:, 2] > 0, 1.0, 0.5) * area, minlength=len(cells))
        self.results.shared.append(cells)
        self.results.shared_area.append(sides)


class _Surfaces:
    """Faces, as their centroids, and spheres of one frame, to find what is near."""

    def __init__(self, mesh, dimensions):
        self.dimensions, data = dimensions, mesh.atoms.data
        self.periodic = data["periodic"]
        spheres = mesh.atoms.spheres()
        radius = np.nan_to_num(mesh.atoms.sphere_radii(spheres))
        edges = mesh.corners - np.roll(mesh.corners, 1, axis=1)
        self.largest = radius.max(initial=0.0)
        self.edge = np.linalg.norm(edges, axis=2).mean() if len(edges) else 0.05 * self.largest
        faces = mesh.origin[mesh.cell] + mesh.corners.mean(axis=1)
        self.faces, self.spheres = len(faces), len(spheres)
        self.points = np.vstack([faces, data["xyz"][spheres]]).astype(np.float32)
        self.reach = np.append(np.zeros(len(faces)), radius)
        self.owner = np.append(mesh.ids[mesh.cell], mesh.atoms.mol[spheres])

    def box(self, farthest):
        """Box for searches up to `farthest`, um, None if nothing is periodic."""
        if not self.periodic.any():
            return None
        box = self.dimensions.copy()
        # room on open axes, so that no image is in reach there
        extent = np.ptp(self.points, axis=0)
        box[:3] = np.where(self.periodic, box[:3], extent + 2.0 * farthest)
        return box

    def near(self, cutoff=None):
        """Pairs (m, 2) of molecule IDs whose surfaces come within `cutoff`, um."""
        cutoff = self.edge if cutoff is None else cutoff
        farthest = cutoff + 2.0 * self.largest
        if not len(self.points) or not cutoff + self.largest > 0.0:
            return np.zeros((0, 2), dtype=int)
        faces, middles, box = self.points[:self.faces], self.points[self.faces:], self.box(farthest)
        pairs, _ = self_capped_distance(faces, cutoff, box=box)
        found = [pairs]
        if self.spheres:    # apart from the faces: spheres reach farther, but are few
            pairs, distance = capped_distance(middles, self.points, farthest, box=box)
            pairs[:, 0] += self.faces
            found.append(pairs[distance <= self.reach[pairs].sum(axis=1) + cutoff])
        cells = self.owner[np.concatenate(found)]
        return np.unique(np.sort(cells[cells[:, 0] != cells[:, 1]], axis=1), axis=0)

    def shared(self, area):
        """Contact areas (m,), um^2, of faces, each with (cell, cell of the nearest other surface,
        1 if that is a sphere), (m, 3); area: (faces,), um^2."""
        rows = np.flatnonzero(area > 0.0)
        farthest = 2.0 * self.edge + self.largest
        if not len(rows):
            return np.zeros((0, 3), dtype=int), np.zeros(0)
        pairs, distance = capped_distance(self.points[rows], self.points, farthest,
                                          box=self.box(farthest))
        pairs[:, 0] = rows[pairs[:, 0]]
        gap = distance - self.reach[pairs[:, 1]]
        other = (self.owner[pairs[:, 0]] != self.owner[pairs[:, 1]]) & (gap <= 2.0 * self.edge)
        pairs, gap = pairs[other], gap[other]
        order = np.lexsort((gap, pairs[:, 0]))
        face, first = np.unique(pairs[order, 0], return_index=True)
        partner = pairs[order[first], 1]
        return np.column_stack([self.owner[face], self.owner[partner], partner >= self.faces]), \
            area[face]
