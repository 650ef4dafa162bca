"""Surface meshes in files: read in whatever form other programs write, written as OFF or OBJ for
`create_cells ... mesh file`, or as STL, PLY, VTP or VTK for other programs.

A surface is (nodes (n, 3), float; faces (m, 3), rows of nodes). No doubled node is merged and no
face turned here: that is mesh_convert.py's.
"""
import warnings
from pathlib import Path

import numpy as np

from .text import write_text

BY_TRIMESH = (".stl", ".ply", ".obj", ".off")
BY_PYVISTA = (".vtp", ".vtk", ".vtu")
WRITTEN = (".off", ".obj", ".stl", ".ply", ".vtp", ".vtk")


class MeshFileError(ValueError):
    """A mesh file that cannot be read or written; the message names file and remedy."""


def read_surface(path):
    """Triangles of a mesh file, told by its ending: STL, PLY, OBJ, OFF, VTP, VTK, VTU and whatever
    else meshio reads. Polygons are cut into triangles; of a mesh of volumes the surface is taken.
    Returns nodes (n, 3), float, and faces (m, 3), int."""
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"no file {path}")
    ending = path.suffix.lower()
    try:
        if ending in BY_TRIMESH:
            nodes, faces = _by_trimesh(path)
        elif ending in BY_PYVISTA:
            nodes, faces = _by_pyvista(path)
        else:
            nodes, faces = _by_meshio(path, ending)
    except MeshFileError:
        raise
    except Exception as err:    # each library has its own errors for a damaged file
        words = str(err).splitlines() or [type(err).__name__]
        raise MeshFileError(f"{path}: cannot be read as {ending or 'a mesh'} ({words[0]}): is the "
                            "file whole, and its ending right? Export it again") from None
    if not len(faces):
        raise MeshFileError(f"{path}: has {len(nodes)} nodes and no faces: it is a cloud of "
                            "points, reconstruct the surface")
    return nodes, faces


def _by_trimesh(path):
    import trimesh

    found = trimesh.load(path, process=False, force="mesh")
    return np.asarray(found.vertices, dtype=float), np.asarray(found.faces, dtype=int)


def _by_pyvista(path):
    import pyvista

    with warnings.catch_warnings():
        warnings.simplefilter("error")    # VTK goes on with what it could read
        found = pyvista.read(path)
    if isinstance(found, pyvista.MultiBlock):
        raise MeshFileError(f"{path}: has several blocks: save one of them as a .vtp file")
    if not isinstance(found, pyvista.PolyData):
        found = found.extract_surface(algorithm="dataset_surface")
    found = found.triangulate()
    return np.asarray(found.points, dtype=float), found.faces.reshape(-1, 4)[:, 1:].astype(int)


def _by_meshio(path, ending):
    import meshio

    if ending not in meshio.extension_to_filetypes:
        known = " ".join(sorted({*BY_TRIMESH, *BY_PYVISTA}))
        raise MeshFileError(f"{path}: unknown ending '{ending}': it must be one of {known}, or one "
                            "that meshio knows")
    found = meshio.read(path)
    pieces = [block.data for block in found.cells if block.type == "triangle"]
    pieces += [block.data[:, corners] for block in found.cells if block.type == "quad"
               for corners in ((0, 1, 2), (0, 2, 3))]
    faces = np.concatenate([np.zeros((0, 3), dtype=int), *pieces]).astype(int)
    nodes = np.asarray(found.points, dtype=float)
    return np.pad(nodes, ((0, 0), (0, 3 - nodes.shape[1]))), faces


def write_surface(path, nodes, faces):
    """Write a surface, in the form that the ending tells: .off or .obj, text with all digits, for
    create_cells; .stl, .ply, .vtp or .vtk through pyvista, which keeps six digits in .stl and
    .ply."""
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in WRITTEN:
        raise MeshFileError(f"{path}: unknown ending '{ending}': create_cells reads .off and .obj; "
                            f"all that are written: {' '.join(WRITTEN)}")
    if ending in (".off", ".obj"):
        head = ["OFF", f"{len(nodes)} {len(faces)} 0"] if ending == ".off" else []
        node, face, first = ("", "3 ", 0) if ending == ".off" else ("v ", "f ", 1)
        rows = [node + " ".join(f"{x:.17g}" for x in point) for point in nodes]
        rows += [face + " ".join(str(i + first) for i in corners) for corners in faces]
        write_text(path, "\n".join(head + rows) + "\n")
        return
    poly_data(nodes, faces).save(path)


def poly_data(nodes, faces):
    """A surface as pyvista.PolyData."""
    import pyvista

    return pyvista.PolyData(np.asarray(nodes, dtype=float),
                            np.column_stack([np.full(len(faces), 3), faces]).ravel())
