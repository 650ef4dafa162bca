"""What every atom is in one frame: cell, kind, type, face.

Division, death and conversion give atom IDs of cells that are gone to others, so that an atom ID
says nothing about the cell. The molecule ID does: it is never used again. What an atom is comes
from the columns of the frame itself; what the frame lacks comes from the Universe (data file, or
the first frame that had the atom), but only for cells that the frame shows to be the same.
"""
import warnings

import numpy as np

from .topology import CENTER, FACE, NODE, SPHERE, TRACER, type_names

WITHOUT_MOL = ("the dump has no column mol: cells are taken to be those of the data file, which is "
               "wrong once one divides, dies or is converted: add mol to `dump custom`")


class AtomBook:
    """What a Universe tells about its atoms beside the frames; `frame()` joins it with one."""

    def __init__(self, universe):
        self.universe = universe
        atoms = universe.atoms
        self.ids, self.mol = atoms.ids, atoms.resids
        self.labels = getattr(universe.trajectory, "labels", {})
        n = len(self.ids)
        self.type = np.array([str(t) for t in atoms.types], dtype=object)
        self.kind = getattr(atoms, "kinds", np.zeros(n, dtype=int))
        self.region = getattr(atoms, "regions", np.zeros(n, dtype=int))
        self.vertices = getattr(atoms, "vertices", np.zeros((n, 3), dtype=int))
        self.radius = getattr(atoms, "radii", np.zeros(n))
        self.volume0 = getattr(atoms, "volumes0", np.zeros(n))
        # an atom type has one kind of atoms, so that it tells that of an atom not known otherwise
        pairs = {(t, k) for t, k in zip(self.type, self.kind) if k > 0 and t != "0"}
        self.kind_of_type = {t: k for t, k in pairs if sum(t == other for other, _ in pairs) == 1}
        self._warned = set()

    def frame(self):
        """FrameAtoms of the Universe's current frame."""
        return FrameAtoms(self, self.universe.trajectory.ts)

    def warn(self, text, where):
        """Warn, once per text, about the frame `where`."""
        if text not in self._warned:
            self._warned.add(text)
            warnings.warn(f"{where}: {text}", stacklevel=3)


class FrameAtoms:
    """Atoms of one frame, an entry per slot.

    there: (n,) bool. mol, kind: (n,) int, 0 unknown or absent. type: (n,) text, "0" unknown.
    vertices: (n, 3) atom IDs of a face's nodes, 0 unknown. region: (n,) int, -1 unknown. radius,
    um, and volume0, um^3: (n,), NaN unknown. own: (n,) bool, the book's atom is this one: where
    the frame has no column for it, kind, vertices, region, radius and volume0 are the book's.
    has_mol: the frame tells cells apart.
    """

    def __init__(self, book, ts):
        self.book, self.data, self.where = book, ts.data, f"frame {ts.frame}"
        self.xyz = ts.data["xyz"]
        self.there = ~np.isnan(self.xyz[:, 0])
        self.has_mol = "mol" in ts.data
        self.mol = self._whole("mol", np.where(self.there, book.mol, 0))
        self.type = self._types()
        told = self._whole("kind", np.zeros(len(self.mol), dtype=int))
        if "type" in ts.data:
            words, at = np.unique(self.type, return_inverse=True)
            by_type = np.array([book.kind_of_type.get(t, 0) for t in words], dtype=int)[at]
            told = np.where((told == 0) & self.there, by_type, told)
        self.own = self._own(told)
        self.kind = np.where((told == 0) & self.own, book.kind, told)
        if "type" not in ts.data:
            self.type = np.where(self.own, book.type, "0").astype(object)
        vertices = [self._whole(v, np.where(self.own, b, 0))
                    for v, b in zip(("v1", "v2", "v3"), book.vertices.T)]
        self.vertices = np.stack(vertices, axis=1)
        self.region = self._whole("region", np.where(self.own, book.region, -1))
        self.radius = self._number("radius")
        self.volume0 = self._number("volume0")

    def _whole(self, name, otherwise):
        """Column `name` as integers, `otherwise` where the frame has none, 0 for absent atoms."""
        if name not in self.data:
            return otherwise
        column = self.data[name]
        known = ~np.isnan(column)
        return np.where(known, np.where(known, column, 0).astype(int),
                        np.where(self.there, otherwise, 0))

    def _number(self, name):
        own = np.where(self.own, getattr(self.book, name), np.nan)
        own[~(own > 0.0)] = np.nan
        if name not in self.data:
            return own
        return np.where(np.isnan(self.data[name]), own, self.data[name])

    def _types(self):
        if "type" not in self.data:
            return np.full(len(self.mol), "0", dtype=object)
        return type_names(self.data["type"], self.book.labels)

    def _own(self, told):
        """Atoms of cells that are as the book has them; told: kinds from the frame, 0 unknown.

        A cell is not if one of its atoms is another cell's in the book, or of another kind there.
        An atom of a type that nobody knows has its old kind only if all its cell's atoms do have
        their old IDs: it was given a new type, not replaced.
        """
        book, cells = self.book, self.there & (self.mol > 0)
        same = cells & (self.mol == book.mol)
        top = int(max(self.mol.max(initial=0), book.mol.max(initial=0))) + 1
        strange = np.bincount(self.mol[cells & ~same], minlength=top)
        strange += np.bincount(self.mol[same & (told > 0) & (told != book.kind)], minlength=top)
        if "type" in self.data:
            whole = np.bincount(self.mol[same], minlength=top) == np.bincount(
                book.mol[book.mol > 0], minlength=top)
            new = same & (told == 0) & (self.type != book.type) & ~whole[self.mol]
            strange += np.bincount(self.mol[new], minlength=top)
        self.changed = strange > 0    # by molecule ID
        return same & ~self.changed[self.mol]

    def require_cells(self):
        """An error if the frame does not tell which cell an atom belongs to, a warning if it may
        not tell it."""
        if self.has_mol:
            return
        lost = self.there & ~self.own & (self.kind != TRACER)
        if lost.any():
            raise ValueError(
                f"{self.where}: the dump has no column mol, and atom ID {self.book.ids[lost][0]} "
                "is not what it is in the data file: cells have come or gone and cannot be told "
                "apart: add mol to `dump custom`")
        self.book.warn(WITHOUT_MOL, self.where)

    def spheres(self):
        """Slots of the center-based cells."""
        return np.flatnonzero(self.there & (self.kind == SPHERE))

    def sphere_radii(self, spheres):
        """Radii (s,), um, of center-based cells at slots `spheres`; NaN, and a warning, where they
        are not known."""
        radius = self.radius[spheres]
        if np.isnan(radius).any():
            self.book.warn(f"the radius of cell {self.mol[spheres][np.isnan(radius)][0]} is not "
                           "known: dump the column radius", self.where)
        elif "radius" not in self.data and not np.isin(self.mol[spheres], self.book.mol).all():
            self.book.warn("cells are born, so they grow, and radii in the data file hold for its "
                           "own moment only: dump the column radius", self.where)
        return radius

    def tracers(self):
        """Slots of the tracers."""
        return np.flatnonzero(self.there & (self.kind == TRACER))

    def cells(self):
        """Molecule IDs (c,) of the deformable cells and slots (c,) of their centers, -1 if the
        dump leaves it out."""
        self.require_cells()
        part = self.there & np.isin(self.kind, (CENTER, NODE, FACE)) & (self.mol > 0)
        ids = np.unique(self.mol[part])
        centers = np.full(len(ids), -1)
        middle = np.flatnonzero(part & (self.kind == CENTER))
        centers[np.searchsorted(ids, self.mol[middle])] = middle
        unknown = self.there & (self.kind == 0) & (self.mol > 0)
        if unknown.any():
            self.book.warn(f"what the atoms of cell {self.mol[unknown].min()} are is not known: "
                           "dump the column kind (compute property/atom)", self.where)
        return ids, centers

    def faces(self, cells):
        """Slots (m,), cells (m,) as rows of `cells`, and vertices (m, 3), atom IDs, of the faces
        of deformable cells with molecule IDs `cells` (sorted). A dump without face atoms of a cell
        is fine as long as the book knows them."""
        here = self.there & (self.kind == FACE) & (self.mol > 0)
        top = int(max(self.mol.max(initial=0), self.book.mol.max(initial=0))) + 1
        shown = np.zeros(top, dtype=bool)
        shown[self.mol[here]] = True
        live = np.zeros(top, dtype=bool)
        live[cells] = True
        hidden = (~self.there & (self.book.kind == FACE) & live[self.book.mol]
                  & ~shown[self.book.mol] & ~self.changed[self.book.mol])
        slots = np.flatnonzero(here | hidden)
        mol = np.where(hidden, self.book.mol, self.mol)[slots]
        vertices = np.where(hidden[:, None], self.book.vertices, self.vertices)[slots]
        return slots, np.searchsorted(cells, mol), vertices
