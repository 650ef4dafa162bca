"""Analyses of deformable cells: volume, area, pressure, faces, mesh quality, contacts.

All are MDAnalysis AnalysisBase classes: build with a Universe of `lammps_dcm.load`, call `run()`
(start, stop, step, frames as usual), read `results`. Arrays have one row per analysed frame; what
does not exist in a frame is NaN. They work on the double-precision columns of the dump, not on
the single-precision `positions`.
"""
import warnings

import numpy as np
from MDAnalysis.analysis.base import AnalysisBase
from MDAnalysis.lib.distances import capped_distance, self_capped_distance

from .topology import CENTER, FACE, SPHERE, slot_lookup


def minimum_image(d, box, tilt, periodic):
    """Differences d (n, 3) moved by box vectors along periodic axes to their nearest image.

    box: (3, 2), tilt: (3,) xy xz yz, periodic: (3,) bool. Exact for |d| below half the box.
    """
    cell = np.diag(box[:, 1] - box[:, 0])
    cell[1, 0], cell[2, 0], cell[2, 1] = tilt
    for axis in (2, 1, 0):
        if periodic[axis]:
            d = d - np.round(d[:, axis] / cell[axis, axis])[:, None] * cell[axis]
    return d


def triangle_vectors(corners):
    """Vector areas (outward, length = area), shape (n, 3), of triangles (n, 3 corners, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return 0.5 * np.cross(b - a, c - a)


def tetrahedron_volumes(corners):
    """Signed volumes (n,) of tetrahedra from the origin to triangles (n, 3 corners, 3)."""
    return np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0


def triangle_quality(corners):
    """4 sqrt(3) A / (sum of squared edges), (n,), of triangles (n, 3 corners, 3): 1 equilateral, 0
    without area."""
    area = np.linalg.norm(triangle_vectors(corners), axis=1)
    squares = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=(1, 2))
    return 4.0 * 3.0**0.5 * area / np.where(squares > 0.0, squares, 1.0)


class Mesh:
    """Faces of all deformable cells in one frame.

    faces: (m,) slots of the face atoms; cell: (m,) row of the cell; vertices: (m, 3) slots of the
    nodes; corners: (m, 3, 3) node positions relative to `origin` (cells, 3), um, unwrapped;
    complete: (cells,) bool, False where nodes of the cell are missing.
    """

    def __init__(self, cells, ts):
        data = ts.data
        xyz = data["xyz"]
        there = ~np.isnan(xyz[:, 0])
        faces, cell, tags = cells.faces, cells.cell_of_face, cells.vertex_tags
        if there[faces].any():    # a dump without face atoms is fine: the topology knows them
            keep = there[faces]
            faces, cell, tags = faces[keep], cell[keep], tags[keep]
        if all(v in data for v in ("v1", "v2", "v3")):
            now = np.stack([data[v][faces] for v in ("v1", "v2", "v3")], axis=1)
            known = ~np.isnan(now).any(axis=1)
            tags = np.where(known[:, None], np.nan_to_num(now).astype(int), tags)
        inside = (tags > 0) & (tags < len(cells.slots))
        vertices = np.where(inside, cells.slots[np.where(inside, tags, 0)], -1)
        good = (vertices >= 0).all(axis=1)
        good[good] = there[vertices[good]].all(axis=1)
        n = len(cells.ids)
        count = np.bincount(cell, minlength=n)
        self.complete = (count > 0) & (np.bincount(cell[good], minlength=n) == count)
        self.faces, self.cell, self.vertices = faces[good], cell[good], vertices[good]
        self.origin = np.full((n, 3), np.nan)
        first, at = np.unique(self.cell, return_index=True)
        self.origin[first] = xyz[self.vertices[at, 0]]
        centered = (cells.centers >= 0) & there[cells.centers]
        self.origin[centered] = xyz[cells.centers[centered]]
        d = xyz[self.vertices] - self.origin[self.cell][:, None, :]
        self.corners = minimum_image(d.reshape(-1, 3), data["box"], data["tilt"],
                                     data["periodic"]).reshape(-1, 3, 3)


class Cells:
    """Deformable cells of a Universe: ids (n,) molecule IDs; centers (n,) slots, -1 if unknown;
    faces (m,) slots; cell_of_face (m,) rows in ids; vertex_tags (m, 3)."""

    def __init__(self, universe):
        atoms = universe.atoms
        kinds = getattr(atoms, "kinds", None)
        if kinds is None or not (kinds == FACE).any():
            raise ValueError("no face atoms are known: open the trajectory together with its data "
                             "file, lammps_dcm.load(data, dump), or dump the columns id mol type "
                             "kind v1 v2 v3 (compute property/atom, dump_modify colname)")
        self.faces = np.flatnonzero(kinds == FACE)
        self.vertex_tags = atoms.vertices[self.faces]
        molecules = atoms.resids
        self.ids, self.cell_of_face = np.unique(molecules[self.faces], return_inverse=True)
        self.slots = slot_lookup(atoms.ids)
        self.centers = np.full(len(self.ids), -1)
        middle = np.flatnonzero((kinds == CENTER) & np.isin(molecules, self.ids))
        self.centers[np.searchsorted(self.ids, molecules[middle])] = middle
        self.types = np.array([str(atoms.types[c]) if c >= 0 else "0" for c in self.centers],
                              dtype=object)


class MeshAnalysis(AnalysisBase):
    """Common part of the analyses: `self.cells`, and `self.mesh()` of the current frame.

    results.cells: (n,) molecule IDs; results.steps, results.times: (frames,) LAMMPS step and s.
    """

    def __init__(self, universe, **kwargs):
        super().__init__(universe.trajectory, **kwargs)
        self.universe = universe
        self.cells = Cells(universe)

    def _per_cell(self, *names, width=()):
        for name in names:
            self.results[name] = np.full((self.n_frames, len(self.cells.ids), *width), np.nan)

    def _prepare(self):
        self.results.cells = self.cells.ids
        self.results.steps = np.zeros(self.n_frames, dtype=int)
        self.results.times = np.zeros(self.n_frames)
        self._warned = set()

    def mesh(self):
        """Mesh of the current frame; notes step and time of the frame."""
        self.results.steps[self._frame_index] = self._ts.data.get("step", 0)
        self.results.times[self._frame_index] = self._ts.time
        return Mesh(self.cells, self._ts)

    def warn_cells(self, which, text):
        """Warn once per text about the cells in the bool array `which`."""
        if which.any() and text not in self._warned:
            self._warned.add(text)
            names = ", ".join(map(str, self.cells.ids[which][:5]))
            warnings.warn(f"frame {self._ts.frame}: cell {names}"
                          f"{' ...' if which.sum() > 5 else ''}: {text}")


class CellVolume(MeshAnalysis):
    """Volume and surface of every deformable cell.

    results.volume: (frames, cells), um^3, the signed sum of tetrahedra; results.area: (frames,
    cells), um^2; results.center: (frames, cells, 3), um, mean of the nodes, next to the center
    atom. A cell with missing nodes or an open surface gets NaN and a warning.
    """

    def _prepare(self):
        super()._prepare()
        self._per_cell("volume", "area")
        self._per_cell("center", width=(3,))

    def _single_frame(self):
        mesh = self.mesh()
        k, n = self._frame_index, len(self.cells.ids)
        vectors = triangle_vectors(mesh.corners)
        areas = np.linalg.norm(vectors, axis=1)
        area = np.bincount(mesh.cell, areas, minlength=n)
        volume = np.bincount(mesh.cell, tetrahedron_volumes(mesh.corners), minlength=n)
        open_ = np.linalg.norm([np.bincount(mesh.cell, v, minlength=n) for v in vectors.T], axis=0)
        seen = np.bincount(mesh.cell, minlength=n) > 0
        self.warn_cells(seen & ~mesh.complete, "nodes are missing in the dump: dump all atoms")
        leaky = mesh.complete & (open_ > 1e-9 * area)
        self.warn_cells(leaky, "the surface is not closed: faces are missing in the dump or data "
                               "file: dump all atoms")
        good = mesh.complete & ~leaky
        self.results.volume[k, good] = volume[good]
        self.results.area[k, good] = area[good]
        nodes, at = np.unique(mesh.vertices, return_index=True)
        cell = mesh.cell[at // 3]
        count = np.maximum(np.bincount(cell, minlength=n), 1)
        corner = mesh.corners.reshape(-1, 3)[at]
        mean = np.stack([np.bincount(cell, c, minlength=n) / count for c in corner.T], axis=1)
        self.results.center[k, good] = (mesh.origin + mean)[good]


class CellPressure(CellVolume):
    """Pressure p = -K_V ln(V/V0) of every deformable cell (S1 eq 6), plus all of CellVolume.

    bulk_modulus: K_V, kPa, one number or a dict of atom type of the cell's center -> number.
    results.pressure: (frames, cells), kPa; results.volume0: (frames, cells), um^3, from a dump
    column `volume0` if there, else from the data file.
    """

    def __init__(self, universe, bulk_modulus, **kwargs):
        super().__init__(universe, **kwargs)
        if isinstance(bulk_modulus, dict):
            given = {str(k): float(v) for k, v in bulk_modulus.items()}
            lacking = sorted(set(self.cells.types) - set(given))
            if lacking:
                raise ValueError(f"bulk_modulus has no entry for center type "
                                 f"{', '.join(lacking)}; it has {', '.join(given) or 'none'}")
            self.bulk_modulus = np.array([given[t] for t in self.cells.types])
        else:
            self.bulk_modulus = np.full(len(self.cells.ids), float(bulk_modulus))
        if not (np.isfinite(self.bulk_modulus) & (self.bulk_modulus > 0.0)).all():
            raise ValueError(f"bulk_modulus is {bulk_modulus}: it must be positive, kPa")

    def _prepare(self):
        super()._prepare()
        self._per_cell("pressure", "volume0")

    def _single_frame(self):
        super()._single_frame()
        k, known = self._frame_index, self.cells.centers >= 0
        at = self.cells.centers[known]
        rest = self.universe.atoms.volumes0[at]
        if "volume0" in self._ts.data:
            now = self._ts.data["volume0"][at]
            rest = np.where(np.isnan(now), rest, now)
        volume0 = np.full(len(self.cells.ids), np.nan)
        volume0[known] = np.where(rest > 0.0, rest, np.nan)
        volume = self.results.volume[k]
        self.warn_cells(np.isnan(volume0) & ~np.isnan(volume), "no rest volume: load the data "
                        "file too, or dump the column volume0")
        self.warn_cells(volume <= 0.0, "the volume is not positive: the cell is inside out")
        self.results.volume0[k] = volume0
        with np.errstate(divide="ignore", invalid="ignore"):
            pressure = -self.bulk_modulus * np.log(volume / volume0)
        self.results.pressure[k] = np.where(volume > 0.0, pressure, np.nan)


class FaceArea(MeshAnalysis):
    """Area of every face: results.area (frames, faces), um^2; results.faces: (faces,) atom IDs;
    results.cell: (faces,) molecule IDs; results.regions: (faces,) region of the face at load."""

    def _prepare(self):
        super()._prepare()
        atoms = self.universe.atoms
        self.results.faces = atoms.ids[self.cells.faces]
        self.results.cell = self.cells.ids[self.cells.cell_of_face]
        self.results.regions = atoms.regions[self.cells.faces]
        self.results.area = np.full((self.n_frames, len(self.cells.faces)), np.nan)

    def _single_frame(self):
        mesh = self.mesh()
        at = np.searchsorted(self.cells.faces, mesh.faces)
        self.results.area[self._frame_index, at] = np.linalg.norm(
            triangle_vectors(mesh.corners), axis=1)


class CellQuality(MeshAnalysis):
    """Quality of the triangles of every cell, 4 sqrt(3) A / (sum of squared edges): 1 for an
    equilateral one, 0 for one without area.

    results.worst, results.median: (frames, cells); results.worst_face: (frames, cells), atom ID of
    the worst face, 0 where unknown. A cell with missing nodes gets NaN and a warning.
    """

    def _prepare(self):
        super()._prepare()
        self._per_cell("worst", "median")
        self.results.worst_face = np.zeros((self.n_frames, len(self.cells.ids)), dtype=int)

    def _single_frame(self):
        mesh = self.mesh()
        k, n = self._frame_index, len(self.cells.ids)
        seen = np.bincount(mesh.cell, minlength=n) > 0
        self.warn_cells(seen & ~mesh.complete, "nodes are missing in the dump: dump all atoms")
        quality = triangle_quality(mesh.corners)
        order = np.lexsort((quality, mesh.cell))
        begin = np.searchsorted(mesh.cell[order], np.arange(n + 1))
        for cell in np.flatnonzero(mesh.complete):
            own = order[begin[cell]:begin[cell + 1]]    # the worst first
            self.results.worst[k, cell] = quality[own[0]]
            self.results.median[k, cell] = np.median(quality[own])
            self.results.worst_face[k, cell] = self.universe.atoms.ids[mesh.faces[own[0]]]


class CellContacts(MeshAnalysis):
    """Contact area and neighbours of every cell.

    column: per-face contact area in the dump, um^2 (`compute dcm/face`; name it with
    lammps_dcm.load(rename=...)). results.contact_area: (frames, cells), um^2, its sum over the
    cell; results.fraction: the same over the cell's area. Both stay NaN without the column.
    results.neighbors: per frame an array (pairs, 2) of molecule IDs, CBM cells included, smaller
    first, whose surfaces come within `cutoff` (um; by default the mean edge length), a face
    counting as its centroid: a geometric criterion, not a force.
    """

    def __init__(self, universe, column="contact_area", cutoff=None, **kwargs):
        super().__init__(universe, **kwargs)
        self.column, self.cutoff = column, cutoff
        self.spheres = np.flatnonzero(universe.atoms.kinds == SPHERE)

    def _prepare(self):
        super()._prepare()
        self._per_cell("contact_area", "fraction")
        self.results.neighbors = []

    def _single_frame(self):
        mesh = self.mesh()
        k, n, data = self._frame_index, len(self.cells.ids), self._ts.data
        if self.column in data:
            share = np.nan_to_num(data[self.column][mesh.faces])
            area = np.linalg.norm(triangle_vectors(mesh.corners), axis=1)
            total = np.bincount(mesh.cell, area, minlength=n)
            contact = np.where(mesh.complete, np.bincount(mesh.cell, share, minlength=n), np.nan)
            self.results.contact_area[k] = contact
            self.results.fraction[k] = contact / np.where(mesh.complete, total, np.nan)
        self.results.neighbors.append(self._near(mesh, data))

    def _near(self, mesh, data):
        """Pairs (m, 2) of molecule IDs within the cutoff."""
        cutoff = self.cutoff
        if cutoff is None:
            edges = mesh.corners - np.roll(mesh.corners, 1, axis=1)
            spheres_only = 0.05 * self.universe.atoms.radii.max(initial=0.0)
            cutoff = np.linalg.norm(edges, axis=2).mean() if len(edges) else spheres_only
        spheres = self.spheres[~np.isnan(data["xyz"][self.spheres, 0])]
        radius = np.nan_to_num(data["radius"][spheres] if "radius" in data
                               else self.universe.atoms.radii[spheres])
        faces = (mesh.origin[mesh.cell] + mesh.corners.mean(axis=1)).astype(np.float32)
        middles = data["xyz"][spheres].astype(np.float32)
        everything = np.vstack([faces, middles])
        if not len(everything) or not cutoff + radius.max(initial=0.0) > 0.0:
            return np.zeros((0, 2), dtype=int)
        reach = np.append(np.zeros(len(faces)), radius)
        owner = np.append(self.cells.ids[mesh.cell], self.universe.atoms.resids[spheres])
        farthest = cutoff + 2.0 * radius.max(initial=0.0)
        box = self._ts.dimensions.copy() if data["periodic"].any() else None
        if box is not None:    # room on open axes, so that no image is in reach there
            extent = np.ptp(everything, axis=0)
            box[:3] = np.where(data["periodic"], box[:3], extent + 2.0 * farthest)
        pairs, _ = self_capped_distance(faces, cutoff, box=box)
        found = [pairs]
        if len(spheres):    # apart from the faces: spheres reach farther, but are few
            pairs, distance = capped_distance(middles, everything, farthest, box=box)
            pairs[:, 0] += len(faces)
            found.append(pairs[distance <= reach[pairs].sum(axis=1) + cutoff])
        cells = owner[np.concatenate(found)]
        return np.unique(np.sort(cells[cells[:, 0] != cells[:, 1]], axis=1), axis=0)
