"""Surfaces with fewer or better triangles, of the same volume."""
import numpy as np

from .mesh_check import enclosed_volume, find_faults
from .mesh_file import poly_data

DENSITY = 12    # nodes to choose from for each that is kept, so that clusters are round


def smoothed(nodes, faces, iterations=50, pass_band=0.1):
    """Nodes of a surface without the steps of voxels (Taubin's filter, which does not shrink), at
    the volume they had."""
    surface = poly_data(nodes, faces).smooth_taubin(n_iter=iterations, pass_band=pass_band)
    return at_volume(np.asarray(surface.points, dtype=float), faces, enclosed_volume(nodes, faces))


def at_volume(nodes, faces, volume):
    """Nodes of a closed surface scaled about their mean, so that it encloses `volume`."""
    middle = nodes.mean(axis=0)
    factor = np.cbrt(volume / enclosed_volume(nodes, faces))
    return middle + factor * (nodes - middle)


def remeshed(nodes, faces, count):
    """The surface with about `count` nodes evenly spread, of the same volume: (nodes, faces).

    Nodes are joined into clusters of equal area (pyacvd), each of which becomes a node: its
    triangles are nearly equilateral. Where that gives no sound surface, as at thin places, edges
    are contracted instead (VTK's quadric decimation), which keeps shapes better and triangles
    worse. ValueError if neither does.
    """
    if count < 12:
        raise ValueError(f"a cell of {count} nodes: give 12 or more")
    volume, problem = enclosed_volume(nodes, faces), ""
    for method in (_clustered, _contracted):
        found = method(nodes, faces, count)
        if found is None:
            continue
        new, triangles = found
        new = new.astype(float)
        if len(triangles) and enclosed_volume(new, triangles) < 0.0:
            triangles = triangles[:, ::-1]
        faults = find_faults(new, triangles) if len(triangles) else ["no faces are left"]
        if not faults:
            return at_volume(new, triangles, volume), triangles
        problem = faults[0]
    raise ValueError(f"no sound surface of {count} nodes was found ({problem}): take more nodes")


def _clustered(nodes, faces, count):
    """Clusters of a refined surface, see remeshed()."""
    import warnings

    import pyacvd

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")    # it uses names that pyvista is about to drop
        clusters = pyacvd.Clustering(poly_data(nodes, faces))
        times = np.log(DENSITY * count / len(nodes)) / np.log(4.0)
        if times > 0.0:
            clusters.subdivide(int(np.ceil(times)))
        clusters.cluster(count)
        made = clusters.create_mesh()
    return made.points, made.faces.reshape(-1, 4)[:, 1:].astype(int)


def _contracted(nodes, faces, count):
    """Contracted edges, see remeshed(); None if there are too few nodes for that."""
    wanted = 2 * count - 4
    if wanted >= len(faces):
        return None
    made = poly_data(nodes, faces).decimate(1.0 - wanted / len(faces), volume_preservation=True)
    return made.points, made.faces.reshape(-1, 4)[:, 1:].astype(int)
