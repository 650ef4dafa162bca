"""Surfaces of the deformable cells in one frame."""
import numpy as np

from .topology import slot_lookup


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


class Mesh:
    """Surfaces of all deformable cells in one frame; atoms: FrameAtoms.

    ids: (c,) molecule IDs of the cells that are there; centers: (c,) slots, -1 where the dump
    leaves the center out; types: (c,) atom types of the centers, "0" unknown. faces: (m,) slots of
    the face atoms; cell: (m,) row of the cell; vertices: (m, 3) slots of the nodes; corners: (m, 3,
    3) node positions relative to `origin` (c, 3), um, unwrapped; complete: (c,) bool, False where
    nodes of the cell are missing; known: (c,) bool, False where the vertices of all its faces are
    not known.
    """

    def __init__(self, atoms):
        self.atoms, data = atoms, atoms.data
        xyz, there = atoms.xyz, atoms.there
        self.ids, self.centers = atoms.cells()
        self.types = np.where(self.centers >= 0, atoms.type[self.centers], "0").astype(object)
        faces, cell, tags = atoms.faces(self.ids)
        slots = slot_lookup(atoms.book.ids)
        inside = (tags > 0) & (tags < len(slots))
        vertices = np.where(inside, slots[np.where(inside, tags, 0)], -1)
        good = (vertices >= 0).all(axis=1)
        good[good] = there[vertices[good]].all(axis=1)
        n = len(self.ids)
        count = np.bincount(cell, minlength=n)
        self.known = np.bincount(cell[(tags > 0).all(axis=1)], minlength=n) > 0
        self.complete = (count > 0) & (np.bincount(cell[good], minlength=n) == count)
        self.faces, self.cell, self.vertices = faces[good], cell[good], vertices[good]
        self.origin = np.full((n, 3), np.nan)
        first, at = np.unique(self.cell, return_index=True)
        self.origin[first] = xyz[self.vertices[at, 0]]
        centered = self.centers >= 0
        self.origin[centered] = xyz[self.centers[centered]]
        d = xyz[self.vertices] - self.origin[self.cell][:, None, :]
        self.corners = minimum_image(d.reshape(-1, 3), data["box"], data["tilt"],
                                     data["periodic"]).reshape(-1, 3, 3)

    def surface(self):
        """The surfaces as points and triangles: nodes (p,) slots of the nodes that faces name;
        points (p, 3), um, whole cells across periodic borders; triangles (m, 3) rows of points, in
        the order of `faces`."""
        nodes, at, triangles = np.unique(self.vertices, return_index=True, return_inverse=True)
        points = self.origin[self.cell[at // 3]] + self.corners.reshape(-1, 3)[at]
        return nodes, points, triangles.reshape(-1, 3)

    def face_column(self, name):
        """Values (m,) of a dump column on the faces; where faces have nothing, those of the
        centers of their cells (compute dcm/cell)."""
        values = self.atoms.data[name]
        faces = values[self.faces]
        if not np.nan_to_num(faces.astype(float)).any():
            faces = self.center_column(name)[self.cell]
        return faces

    def center_column(self, name):
        """Values (c,) of a dump column on the centers, NaN where the dump leaves the center out."""
        return np.where(self.centers >= 0, self.atoms.data[name][self.centers], np.nan)
