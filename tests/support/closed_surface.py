"""Geometry of a closed triangulated surface, in numpy; independent of the package."""

from functools import cached_property

import numpy as np


class ClosedSurface:
    """x: nodes (n, 3); faces: rows of x (m, 3), counter-clockwise seen from outside."""

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
    def closed(self):
        """Every edge once in each direction, the topology of a sphere, every node in use."""
        half = {(f[k], f[(k + 1) % 3]) for f in self.faces for k in range(3)}
        return (
            len(half) == 3 * len(self.faces)
            and all((b, a) in half for a, b in half)
            and len(self.x) - len(half) // 2 + len(self.faces) == 2
        )
