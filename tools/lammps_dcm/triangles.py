"""Geometry of triangles: areas, volumes, quality."""
import numpy as np


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
