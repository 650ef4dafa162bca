"""Cells as objects of other libraries: pyvista, trimesh, networkx, pandas.

Each library is loaded when its function is called. What they show is the state of one frame, or of
all for `cells_frame`, told as everywhere by the columns of the dump (frame_atoms.py).
"""
import numpy as np

from .analysis import CellContacts, CellPressure, measure_cells
from .frame_atoms import AtomBook
from .mesh import Mesh
from .reader import COORDINATES, DumpError, DumpFile
from .shape import CellShape
from .topology import CENTER, FACE, NODE, SPHERE
from .triangles import triangle_vectors

# columns that say what an atom is or where: they have a name of their own in what is made here
KNOWN = {"id", "mol", "type", "kind", "v1", "v2", "v3", "region", "ix", "iy", "iz", "dt",
         "time_offset", *(c for names in COORDINATES for c in names)}
# three columns that are one vector
VECTORS = {"velocity": ("vx", "vy", "vz"), "force": ("fx", "fy", "fz"),
           "apical": ("ax", "ay", "az"), "polar": ("px", "py", "pz"),
           "normal": ("nx", "ny", "nz")}


def at_frame(universe_or_mesh, frame, book=None):
    """Mesh of a frame; universe_or_mesh: a Universe, which is moved to `frame` (None: stays), or a
    Mesh, which is of a frame already."""
    if isinstance(universe_or_mesh, Mesh):
        return universe_or_mesh
    if frame is not None:
        universe_or_mesh.trajectory[frame]
    return Mesh((book or AtomBook(universe_or_mesh)).frame())


# ---------------------------------------------------------------------- pyvista

def numeric_columns(data, count):
    """Names of the columns of a frame that are numbers and say neither what an atom is nor where
    it is."""
    return [name for name, values in data.items() if name not in KNOWN and np.ndim(values) == 1
            and len(values) == count and values.dtype != object]


def column_homes(mesh):
    """Where each column has values: dict of name -> set of "node", "face", "center"; that of a
    column which is zero everywhere is empty."""
    atoms, homes = mesh.atoms, {}
    for name in numeric_columns(atoms.data, len(atoms.kind)):
        there = atoms.there & (np.nan_to_num(atoms.data[name]) != 0.0)
        homes[name] = {home for home, kind in (("node", NODE), ("face", FACE), ("center", CENTER))
                       if (there & (atoms.kind == kind)).any()}
    return homes


def merged_homes(first, second):
    """Homes of columns that several frames have together."""
    return {name: first.get(name, set()) | second.get(name, set()) for name in first | second}


def with_vectors(columns):
    """Dict of columns in which the three of a vector are one of shape (n, 3)."""
    columns = dict(columns)
    for vector, names in VECTORS.items():
        if all(name in columns for name in names):
            columns[vector] = np.stack([columns.pop(name) for name in names], axis=1)
    return columns


def type_numbers(book, types):
    """Atom types as whole numbers, 0 for unknown ones: labels as the numbers that the data file
    gives them, or else in the order of the alphabet."""
    names = sorted(set(book.type.tolist()) - {"0"})
    numbers = {label: int(number) for number, label in book.labels.items()}
    if not numbers and not all(name.isdigit() for name in names):
        numbers = {name: k for k, name in enumerate(names, 1)}
    return np.array([numbers.get(t, int(t) if t.isdigit() else 0) for t in types], dtype=int)


def to_pyvista(universe_or_cells, frame=None, bulk_modulus=None, homes=None, book=None):
    """Surfaces, spheres and tracers of a frame as a pyvista.MultiBlock.

    universe_or_cells: a Universe of `lammps_dcm.load`, or a Mesh. frame: number of the frame; None:
    the current one. bulk_modulus: as in CellPressure, for `cell_pressure`; without it that is the
    dump column `pressure`, if there is one. homes: of `column_homes`, if several frames shall
    have the same arrays. book: AtomBook, to be shared by several calls.

    Block "cells": PolyData of triangles, whole across periodic borders, in double precision.
    cell_data, one value per face: cell (molecule ID), face (atom ID), type (atom type of the cell's
    center), region, area (um^2), cell_volume (um^3), cell_area (um^2), cell_pressure (kPa),
    cell_center (3, um), and each column of the dump that has values on faces or on centers; those
    of a center are on all faces of its cell. point_data: node (atom ID) and each column that has
    values on nodes. Columns vx vy vz, fx fy fz, ax ay az, px py pz, nx ny nz are the vectors
    velocity, force, apical, polar, normal.
    Block "spheres": points of the center-based cells with radius (um), cell, atom, type and all
    columns. Block "tracers": points with atom, type and all columns.
    field_data of all: step and TimeValue (s). A cell that cannot be measured has NaN, with a
    warning, as in CellVolume. ValueError if cells cannot be told apart.
    """
    import pyvista

    book = book or (universe_or_cells.atoms.book if isinstance(universe_or_cells, Mesh)
                    else AtomBook(universe_or_cells))
    mesh = at_frame(universe_or_cells, frame, book)
    atoms = mesh.atoms
    homes = column_homes(mesh) if homes is None else homes
    blocks = pyvista.MultiBlock()
    blocks["cells"] = _surface(pyvista, mesh, bulk_modulus, homes)
    spheres = atoms.spheres()
    radii = atoms.sphere_radii(spheres)
    spheres, radii = spheres[~np.isnan(radii)], radii[~np.isnan(radii)]
    blocks["spheres"] = _points(pyvista, atoms, spheres, homes, cell=atoms.mol[spheres],
                                radius=radii)
    blocks["tracers"] = _points(pyvista, atoms, atoms.tracers(), homes)
    for block in blocks:
        block.field_data["step"] = [int(atoms.data.get("step", 0))]
        block.field_data["TimeValue"] = [float(book.universe.trajectory.ts.time)]
    return blocks


def _surface(pyvista, mesh, bulk_modulus, homes):
    """PolyData of the surfaces, see to_pyvista."""
    atoms, book = mesh.atoms, mesh.atoms.book
    if not mesh.known.all():
        book.warn(f"cell {mesh.ids[~mesh.known][0]}: the vertices of its faces are not known, so "
                  "it is left out: dump the columns v1 v2 v3 (compute property/atom)", atoms.where)
    nodes, points, triangles = mesh.surface()
    made = pyvista.PolyData(points, np.column_stack([np.full(len(triangles), 3),
                                                     triangles]).ravel())
    volume, area, center, _ = measure_cells(mesh)
    here = {name: home for name, home in homes.items() if name in atoms.data}
    values = {name: mesh.face_column(name) if "face" not in home else
              atoms.data[name][mesh.faces] for name, home in here.items()
              if home != {"node"}}
    values = with_vectors(values) | {
        "cell": mesh.ids[mesh.cell], "face": book.ids[mesh.faces],
        "type": type_numbers(book, mesh.types)[mesh.cell], "region": atoms.region[mesh.faces],
        "area": np.linalg.norm(triangle_vectors(mesh.corners), axis=1),
        "cell_volume": volume[mesh.cell], "cell_area": area[mesh.cell],
        "cell_center": center[mesh.cell]}
    pressure = cell_pressures(mesh, bulk_modulus, volume)
    if pressure is not None:
        values["cell_pressure"] = pressure[mesh.cell]
    _put(made.cell_data, values)
    _put(made.point_data, {"node": book.ids[nodes]} | with_vectors(
        {name: atoms.data[name][nodes] for name, home in here.items() if "node" in home}))
    return made


def _points(pyvista, atoms, slots, homes, **values):
    """PolyData of points, see to_pyvista."""
    made = pyvista.PolyData(atoms.xyz[slots]) if len(slots) else pyvista.PolyData()
    columns = with_vectors({name: atoms.data[name][slots] for name in homes if name in atoms.data})
    values = columns | values | {"atom": atoms.book.ids[slots],
                                 "type": type_numbers(atoms.book, atoms.type[slots])}
    _put(made.point_data, values)
    return made


def _put(attributes, columns):
    """Add columns to the cell_data or point_data of a PolyData, which may be empty."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    for name, column in columns.items():
        if len(column):
            attributes[name] = column
            continue
        empty = numpy_to_vtk(np.zeros(column.shape[1:], dtype=column.dtype)[None, ...])
        empty.SetNumberOfTuples(0)    # pyvista refuses arrays without values
        empty.SetName(name)
        attributes.VTKObject.AddArray(empty)


def cell_pressures(mesh, bulk_modulus, volume):
    """Pressures (c,), kPa, of the cells of a Mesh: -K_V ln(V/V0), or the dump column `pressure` of
    their centers; None if neither is known. volume: (c,), um^3."""
    if bulk_modulus is None:
        if "pressure" not in mesh.atoms.data:
            return None
        return mesh.center_column("pressure")
    law = CellPressure(mesh.atoms.book.universe, bulk_modulus, book=mesh.atoms.book)
    return law.pressures(mesh, volume)[0]


# ---------------------------------------------------------------------- trimesh

def to_trimesh(universe_or_cells, frame=None, book=None):
    """Surfaces of the deformable cells of a frame: dict of molecule ID -> trimesh.Trimesh, um.

    universe_or_cells, frame, book: as in to_pyvista. Vertices are in double precision, whole across
    periodic borders; metadata: cell, type, faces (atom IDs of the faces, in their order). A cell
    with missing nodes is left out, with a warning.
    """
    import trimesh

    mesh = at_frame(universe_or_cells, frame, book)
    atoms, found = mesh.atoms, {}
    nodes, points, triangles = mesh.surface()
    for c, cell in enumerate(mesh.ids):
        if not mesh.complete[c]:
            atoms.book.warn(f"cell {cell}: nodes are missing in the dump: it is left out: dump all "
                            "atoms", atoms.where)
            continue
        own = mesh.cell == c
        used, faces = np.unique(triangles[own], return_inverse=True)
        found[int(cell)] = trimesh.Trimesh(
            points[used], faces.reshape(-1, 3), process=False,
            metadata={"cell": int(cell), "type": mesh.types[c],
                      "faces": atoms.book.ids[mesh.faces[own]]})
    return found


# ---------------------------------------------------------------------- networkx

PAIR = ("molecule1", "molecule2", "area")    # values of compute dcm/contact/local


def recorded_contacts(dump, step):
    """Rows of a step in a `dump local` of compute dcm/contact/local: dict of column -> array.

    dump: path, or DumpFile (rename gives columns their names).
    """
    file = dump if isinstance(dump, DumpFile) else DumpFile(dump)
    try:
        for number in range(len(file)):
            frame = file.frame(number)
            if frame.step != step:
                continue
            missing = [name for name in PAIR if name not in frame.columns]
            if missing:
                raise DumpError(f"{frame.where}: no column {', '.join(missing)}: dump the values "
                                f"{' '.join(PAIR)} of compute dcm/contact/local, and give columns "
                                "these names by `dump_modify ID colname`")
            return frame.table()
    finally:
        file.close()
    raise DumpError(f"{file.path}: no step {step}: dump atoms and contacts in the same steps")


def neighbor_graph(universe, frame=None, column="contact_area", cutoff=None, contacts=None):
    """Which cells of a frame touch, as a networkx.Graph.

    Nodes: molecule IDs of all cells, with kind ("dcm" or "cbm"), type and center (3,), um. Edges:
    pairs of cells, with contact_area, um^2, NaN where it is not known.

    With the dump column `column` on faces (`contact_area` of compute dcm/face), those pairs that
    share contact area. The dump does not tell the partner of a face: the whole area of a face
    counts for the cell whose surface is nearest to it, and that of a pair is the mean of both sides
    (between a deformable cell and a sphere: that of the faces). Two spheres are joined, without an
    area, if they overlap or are within the cutoff. Without the column all pairs within `cutoff`
    (um, default: the mean edge) are joined, see CellContacts. Columns needed: id mol type x y z,
    kind and v1 v2 v3 or the data file, radius for spheres, and contact_area.

    contacts: a `dump local` of compute dcm/contact/local that has the step, as in
    recorded_contacts(): the edges are its pairs with an area above zero, with all its other columns
    (force, normal, ...) as attributes; column and cutoff are not used.
    """
    import networkx

    if frame is not None:
        universe.trajectory[frame]
    frame = universe.trajectory.frame
    if contacts is None:
        found = CellContacts(universe, column, cutoff, shares=True).run(frames=[frame])
        universe.trajectory[frame]    # run() ends at frame 0
    atoms = (AtomBook(universe) if contacts is not None else found.book).frame()
    mesh = Mesh(atoms)
    graph = networkx.Graph(frame=frame, step=int(atoms.data.get("step", 0)),
                           time=float(universe.trajectory.ts.time))
    center = measure_cells(mesh)[2]
    for c, cell in enumerate(mesh.ids.tolist()):
        graph.add_node(cell, kind="dcm", type=mesh.types[c], center=center[c])
    for slot in np.flatnonzero(atoms.there & (atoms.kind == SPHERE)):
        graph.add_node(int(atoms.mol[slot]), kind="cbm", type=atoms.type[slot],
                       center=atoms.xyz[slot])
    if contacts is not None:
        rows = recorded_contacts(contacts, graph.graph["step"])
        ends = [rows.pop(name).astype(int).tolist() for name in PAIR[:2]]
        rows["contact_area"] = rows.pop("area")
        for a, b, *values in zip(*ends, *rows.values()):
            more = dict(zip(rows, map(float, values)))
            if more["contact_area"] > 0.0:
                graph.add_edge(a, b, **more)
        return graph
    results = found.results
    kind = networkx.get_node_attributes(graph, "kind")
    for a, b in results.neighbors[0].tolist():
        if column not in atoms.data or kind[a] == kind[b] == "cbm":
            graph.add_edge(a, b, contact_area=float("nan"))
    for (a, b), area in zip(results.shared[0].tolist(), results.shared_area[0].tolist()):
        graph.add_edge(a, b, contact_area=area)
    return graph


# ---------------------------------------------------------------------- pandas

def cells_frame(universe, bulk_modulus=None, frames=None, verbose=False):
    """Measures of all deformable cells in all frames as a pandas.DataFrame, a row per cell and
    frame.

    bulk_modulus: as in CellPressure; without it the pressure is that of the dump column `pressure`
    of the centers (compute dcm/cell), or NaN. frames: numbers of the frames, None for all.
    Columns: frame, step, time (s), cell (molecule ID), type, volume (um^3), area (um^2), pressure
    (kPa), x, y, z (um, mean of the nodes), sphericity, asphericity, shape_index, half_axis_1 to
    half_axis_3 (um, longest first), axis_1_x to axis_3_z; their definitions: see CellShape.
    """
    import pandas

    frames = range(len(universe.trajectory)) if frames is None else list(frames)
    analysis = _CellsFrame(universe, bulk_modulus).run(frames=list(frames), verbose=verbose)
    results = analysis.results
    row, cell = np.nonzero(results.present)
    table = {"frame": np.asarray(list(frames), dtype=int)[row], "step": results.steps[row],
             "time": results.times[row], "cell": results.cells[cell],
             "type": results.type[row, cell]}
    for name in ("volume", "area", "pressure"):
        table[name] = results[name][row, cell]
    table |= dict(zip("xyz", results.center[row, cell].T))
    for name in ("sphericity", "asphericity", "shape_index"):
        table[name] = results[name][row, cell]
    for k in range(3):
        table[f"half_axis_{k + 1}"] = results.half_axes[row, cell, k]
    for k in range(3):
        for axis, values in zip("xyz", results.axes[row, cell, k].T):
            table[f"axis_{k + 1}_{axis}"] = values
    return pandas.DataFrame(table)


class _CellsFrame(CellShape):
    """CellShape with the types and pressures of the cells."""

    def __init__(self, universe, bulk_modulus, **kwargs):
        super().__init__(universe, **kwargs)
        self.bulk_modulus = bulk_modulus

    def _measure(self, mesh):
        volume = super()._measure(mesh)
        pressure = cell_pressures(mesh, self.bulk_modulus, volume)
        self._put(type=mesh.types,
                  pressure=np.full(len(mesh.ids), np.nan) if pressure is None else pressure)
        return volume
