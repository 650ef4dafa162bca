"""Shape of cells: how round, how long, which way.

The moments are those of the enclosed volume, so that they do not depend on how the mesh is divided.
"""
import numpy as np

from .analysis import CellVolume
from .triangles import tetrahedron_volumes


def volume_moments(corners, cell, n):
    """Centroids (n, 3), um, and gyration tensors (n, 3, 3), um^2, of the volumes that closed
    surfaces enclose; corners (m, 3 corners, 3), um; cell (m,): the surface of a triangle, 0 to
    n - 1. NaN where there is no volume."""
    volumes = tetrahedron_volumes(corners)
    sums = corners.sum(axis=1)

    def total(values):
        return np.stack([np.bincount(cell, v, minlength=n) for v in values.T], axis=1)

    with np.errstate(divide="ignore", invalid="ignore"):
        volume = np.bincount(cell, volumes, minlength=n)[:, None]
        centroid = total(volumes[:, None] * sums / 4.0) / volume
        # of a tetrahedron with corners 0, p1, p2, p3: V/20 (sum of p p^T + (sum of p)(sum of p)^T)
        second = np.einsum("mki,mkj->mij", corners, corners) + sums[:, :, None] * sums[:, None, :]
        second = total((volumes[:, None, None] * second / 20.0).reshape(-1, 9)) / volume
    return centroid, second.reshape(n, 3, 3) - centroid[:, :, None] * centroid[:, None, :]


class CellShape(CellVolume):
    """Shape of every deformable cell, plus all of CellVolume.

    results.sphericity: pi^(1/3) (6 V)^(2/3) / A, 1 for a sphere, less for all else;
    results.shape_index: A / V^(2/3), (36 pi)^(1/3) = 4.836 for a sphere;
    results.asphericity: 1.5 (sum of (l_k - mean l)^2) / (sum of l)^2 with the principal moments
    l_k of the gyration tensor of the volume, as MDAnalysis defines it: 0 for a sphere or a cube,
    1 for a rod. (frames, cells) each.
    results.half_axes: (frames, cells, 3), um, sqrt(5 l_k), the longest first: for an ellipsoid its
    half-axes. results.axes: (frames, cells, 3, 3), a unit vector in each row, in the same order;
    the largest component of each is positive. results.centroid: (frames, cells, 3), um, of the
    volume. A cell without a volume gets NaN, as in CellVolume.
    """

    def _measure(self, mesh):
        n = len(mesh.ids)
        volume = super()._measure(mesh)
        area = self._values["area"][-1]
        centroid, tensor = volume_moments(mesh.corners, mesh.cell, n)
        good = volume > 0.0
        moments, axes = np.full((n, 3), np.nan), np.full((n, 3, 3), np.nan)
        values, vectors = np.linalg.eigh(tensor[good])
        moments[good] = np.maximum(values[:, ::-1], 0.0)
        rows = vectors.transpose(0, 2, 1)[:, ::-1]
        largest = np.take_along_axis(rows, np.abs(rows).argmax(axis=2)[:, :, None], axis=2)
        axes[good] = rows * np.sign(largest)
        total = moments.sum(axis=1)
        spread = ((moments - total[:, None] / 3.0) ** 2).sum(axis=1)
        size = np.cbrt(np.where(good, volume, np.nan)) ** 2
        self._put(sphericity=np.cbrt(36.0 * np.pi) * size / area, shape_index=area / size,
                  asphericity=1.5 * spread / total**2,
                  half_axes=np.sqrt(5.0 * moments), axes=axes,
                  centroid=np.where(good[:, None], mesh.origin + centroid, np.nan))
        return volume
