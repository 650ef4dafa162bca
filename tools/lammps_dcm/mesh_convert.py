"""`mesh`: convert surface meshes of other programs for `create_cells ... mesh file`, or check them.
"""
from pathlib import Path

import numpy as np

from .mesh_check import (
    components,
    doubled_nodes,
    edge_groups,
    enclosed_volume,
    find_doubts,
    find_faults,
    measure_surface,
    size_of,
)
from .mesh_file import WRITTEN, MeshFileError, read_surface, write_surface

# of the size of the mesh: STL has each node once per face, in single precision
MERGE = 1e-6


def repaired(nodes, faces, largest=False):
    """A surface with doubled nodes merged, faces without area by name and double faces removed, and
    faces turned alike and outward; largest: only the part of the largest volume.

    Returns nodes (n, 3), faces (m, 3) and a list of sentences on what was done. Holes are not
    closed.
    """
    done = []
    if not np.isfinite(nodes).all() or not len(faces):
        return nodes, faces, done
    near = doubled_nodes(nodes, MERGE * size_of(nodes))
    if len(near):
        group = components(near, len(nodes))
        first = np.unique(group, return_index=True)[1]
        done.append(f"merged {len(nodes)} nodes to {len(first)}")
        order = np.argsort(first)    # nodes keep the order in which they first occur
        number = np.empty(len(first), dtype=int)
        number[order] = np.arange(len(first))
        nodes, faces = nodes[first[order]], number[group][faces]
    flat = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    once = np.zeros(len(faces), dtype=bool)
    once[np.unique(np.sort(faces, axis=1), axis=0, return_index=True)[1]] = True
    keep = once & ~flat
    if not keep.all():
        done.append(f"removed {(~keep).sum()} faces that name a node twice or occur twice")
        faces = faces[keep]
    faces, turned = turned_alike(faces)
    if turned:
        done.append(f"turned {turned} faces, so that all are oriented alike")
    if largest:
        part = components(edge_groups(faces)[0], len(nodes))[faces[:, 0]]
        parts = np.unique(part)
        volumes = [abs(enclosed_volume(nodes, faces[part == p])) for p in parts]
        if len(parts) > 1:
            done.append(f"kept the largest of {len(parts)} parts")
        faces = faces[part == parts[int(np.argmax(volumes))]]
    used = np.unique(faces)
    if len(used) < len(nodes):
        done.append(f"removed {len(nodes) - len(used)} nodes that no face uses")
        faces, nodes = np.searchsorted(used, faces), nodes[used]
    if len(faces) and enclosed_volume(nodes, faces) < 0.0:
        done.append("turned all faces, the mesh was inside out")
        faces = faces[:, ::-1]
    return nodes, faces, done


def turned_alike(faces):
    """Faces of each part turned so that any two that share an edge run along it in opposite
    directions, where that is possible, and the number of faces that were turned."""
    import trimesh

    surface = trimesh.Trimesh(np.zeros((int(faces.max(initial=0)) + 1, 3)), faces, process=False)
    trimesh.repair.fix_winding(surface)
    made = np.asarray(surface.faces, dtype=int)
    same = (made == faces).all(axis=1) | (made == np.roll(faces, 1, axis=1)).all(axis=1) | (
        made == np.roll(faces, 2, axis=1)).all(axis=1)
    return made, int((~same).sum())


def report(measures):
    """Lines that tell the measures of a mesh (mesh_check.measure_surface)."""
    x, y, z = measures["size"]
    few, many = measures["valence"]
    return [f"{measures['nodes']} nodes, {measures['faces']} faces, {few} to {many} edges at a "
            "node",
            f"volume {measures['volume']:.6g} um^3, area {measures['area']:.6g} um^2, "
            f"mean edge {measures['mean_edge']:.4g} um",
            f"size {x:.5g} x {y:.5g} x {z:.5g} um, radius {measures['radius']:.6g} um (sphere of "
            "this volume)",
            f"quality of faces: worst {measures['worst']:.3g}, median {measures['median']:.3g}"]


def words(*numbers):
    """Numbers for a deck, with all digits."""
    return " ".join(repr(float(x)) for x in numbers)


def create_command(path, measures, name="NAME", atom_types="1 2 3 1 1", options=""):
    """The create_cells line that puts a mesh file where and as large as it is: create_cells moves
    the mean node to x, y, z and, with `scale volume`, gives the volume of a sphere of radius R."""
    return (f"create_cells single {name} dcm {words(*measures['middle'], measures['radius'])} "
            f"dcm {name} {atom_types} mesh file {path} scale volume{options and ' ' + options}")


# ---------------------------------------------------------------------- command line

def add_arguments(parser):
    """Options of `mesh`."""
    sub = parser.add_subparsers(dest="action", required=True, metavar="convert|check")
    p = sub.add_parser("convert", help="read a mesh file, mend it, check it and write it anew",
                       description="Read a surface mesh (STL, PLY, OBJ, OFF, VTP, VTK, VTU and "
                       "what else meshio reads), merge doubled nodes, turn its faces outward, "
                       "check that it can be a cell, and write it.")
    p.add_argument("input", metavar="IN")
    p.add_argument("output", metavar="OUT", help=".off or .obj for create_cells; also "
                   + " ".join(e for e in WRITTEN if e not in (".off", ".obj")))
    p.add_argument("--scale", type=float, default=1.0, metavar="FACTOR", help="to um: 0.001 for a "
                   "file in nm, 1000 for mm (default: %(default)g)")
    p.add_argument("--nodes", type=int, metavar="N", help="remesh to about N nodes, evenly spread, "
                   "of the same volume")
    p.add_argument("--largest", action="store_true", help="of several parts keep the one of the "
                   "largest volume")
    p = sub.add_parser("check", help="check mesh files as they are",
                       description="Say what create_cells would refuse, and measures. Exit code 1 "
                       "if a file cannot be a cell.")
    p.add_argument("files", nargs="+", metavar="FILE")


def run(args, words_):
    """Convert or check what the command line asks for."""
    (convert if args.action == "convert" else check)(args)


def convert(args):
    """`mesh convert`."""
    if not (np.isfinite(args.scale) and args.scale > 0.0):
        raise MeshFileError(f"--scale {args.scale:g}: the factor must be positive")
    if Path(args.output).suffix.lower() not in WRITTEN:
        raise MeshFileError(f"{args.output}: its name must end in one of {' '.join(WRITTEN)}")
    nodes, faces = read_surface(args.input)
    nodes, faces, done = repaired(args.scale * nodes, faces, args.largest)
    faults = find_faults(nodes, faces)
    if faults:
        raise MeshFileError(f"{args.input}: cannot be a cell:\n" + "\n".join(
            f"  {fault}" for fault in faults))
    if args.nodes is not None:
        from .remesh import remeshed

        before = len(nodes)
        nodes, faces = remeshed(nodes, faces, args.nodes)
        done.append(f"remeshed {before} nodes to {len(nodes)}, at the same volume")
    measures = measure_surface(nodes, faces)
    write_surface(args.output, nodes, faces)
    for line in [*done, *report(measures), *(f"warning: {d}" for d in find_doubts(measures))]:
        print(line)
    print(f"wrote {args.output}")
    if Path(args.output).suffix.lower() in (".off", ".obj"):
        print("where and as large as it is in the file, in a deck:\n  "
              + create_command(args.output, measures))


def check(args):
    """`mesh check`."""
    bad = 0
    for name in args.files:
        try:
            nodes, faces = read_surface(name)
            faults = find_faults(nodes, faces)
        except (MeshFileError, OSError) as err:
            faults = [str(err).removeprefix(f"{name}: ")]
        bad += bool(faults)
        print(f"{name}: {'cannot be a cell' if faults else 'sound'}")
        lines = list(faults)
        if not faults:
            measures = measure_surface(nodes, faces)
            lines = report(measures) + [f"warning: {d}" for d in find_doubts(measures)]
        for line in lines:
            print(f"  {line}")
    if bad:
        raise MeshFileError(f"{bad} of {len(args.files)} files cannot be a cell")
