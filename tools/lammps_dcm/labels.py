"""`scene labels`: a mesh for each label of a segmented image, and the deck lines that put each cell
where it is in the image.

An image is an array (slices z, rows y, columns x) of whole numbers, 0 outside. Voxel (0, 0, 0)
begins at the origin, so that its middle is half a voxel from it.
"""
import warnings
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from tqdm import tqdm

from .mesh_check import edge_groups, enclosed_volume, find_doubts, find_faults, measure_surface
from .mesh_convert import words
from .mesh_file import write_surface
from .remesh import at_volume, remeshed, smoothed
from .text import write_text

BLURS = (0.0, 0.7, 1.0, 1.5)    # [ours] voxels; the least that gives a surface without handles
MARGIN = 3    # voxels around a mask, of which a blur of 1.5 changes no more
SPECKS = 0.05    # [ours] a label may have loose parts up to this fraction; the rest is one cell


class LabelError(ValueError):
    """An image, or labels of it, that cannot be made cells; the message names them and a remedy."""


@dataclass
class LabelCell:
    """One cell of an image: label, nodes (n, 3), um, faces (m, 3), volume of its voxels, um^3, and
    notes, what was changed."""

    label: int
    nodes: np.ndarray
    faces: np.ndarray
    volume: float
    notes: list = field(default_factory=list)


def read_labels(path):
    """Labels (z, y, x), int, of a .tif, .tiff or .npy file."""
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"no file {path}")
    ending = path.suffix.lower()
    try:
        if ending == ".npy":
            image = np.load(path, allow_pickle=False)
        elif ending in (".tif", ".tiff"):
            from skimage.io import imread

            image = imread(path)
        else:
            raise LabelError(f"{path}: its name must end in .tif, .tiff or .npy")
    except LabelError:
        raise
    except Exception as err:    # those of the image libraries differ
        raise LabelError(f"{path}: cannot be read ({err}): is the file whole?") from None
    if image.ndim != 3 or min(image.shape) < 2:
        raise LabelError(f"{path}: has the shape {image.shape}: give one stack of slices, (z, y, "
                         "x), one channel, one time")
    if image.dtype == bool:
        raise LabelError(f"{path}: is a mask of True and False: give each cell a number, for "
                         "instance with skimage.measure.label")
    if image.dtype.kind == "f" and np.isfinite(image).all() and (image == np.rint(image)).all():
        image = image.astype(int)
    if image.dtype.kind not in "iu":
        raise LabelError(f"{path}: its values are not whole numbers: save the labels, not the "
                         "intensities")
    if image.min() < 0 or image.max() == 0:
        raise LabelError(f"{path}: labels must be 0 outside and positive in cells; they are "
                         f"{image.min()} to {image.max()}")
    return image.astype(np.int64)


def one_cell(mask, label, corner, voxel, nodes=642, smoothing=50):
    """LabelCell of a mask (z, y, x) whose first voxel is number `corner` (z, y, x) of the image.

    voxel: (3,), um, along x, y, z. The largest part of the mask is taken, holes inside it are
    filled. Marching cubes give a surface halfway between inside and outside, Taubin's filter takes
    the steps of the voxels out of it, and it is remeshed to about `nodes` nodes. The volume is
    that of the voxels. Voxels that touch by an edge or a corner make small handles: where there are
    any, the mask is blurred first, with a note. LabelError if even this is no sphere-like surface.
    """
    from scipy import ndimage
    from skimage.measure import marching_cubes

    notes = []
    parts, count = ndimage.label(mask)
    if count > 1:
        sizes = np.bincount(parts.ravel())[1:]
        loose = sizes.sum() - sizes.max()
        if loose > SPECKS * sizes.sum():
            raise LabelError(f"consists of {count} parts, of which the largest has {sizes.max()} "
                             f"of {sizes.sum()} voxels: give each cell a label of its own")
        notes.append(f"left out {loose} voxels in {count - 1} loose parts")
        mask = parts == sizes.argmax() + 1
    filled = ndimage.binary_fill_holes(mask)
    if filled.sum() > mask.sum():
        notes.append(f"filled {filled.sum() - mask.sum()} voxels inside")
    steps = np.asarray(voxel, dtype=float)
    problem = ""
    for blur in BLURS:
        field = np.pad(filled, MARGIN).astype(np.float32)
        if blur:
            field = ndimage.gaussian_filter(field, blur)
        parts, _ = ndimage.label(field > 0.5)    # what comes off is lost
        field[(parts > 0) & (parts != np.bincount(parts.ravel())[1:].argmax() + 1)] = 0.0
        points, faces, _, _ = marching_cubes(field, 0.5, allow_degenerate=False)
        # x, y, z is z, y, x turned round
        points = (points.astype(float) + 0.5 - MARGIN + corner)[:, ::-1] * steps
        faces = faces.astype(int)
        if enclosed_volume(points, faces) < 0.0:
            faces = faces[:, ::-1]
        faults = find_faults(points, faces)
        if not faults:
            break
        problem = problem or faults[0]
    else:
        raise LabelError(f"its surface cannot be a cell: {problem}")
    if problem:
        notes.append(f"blurred by {blur:g} voxels, since {problem.partition(':')[0]}")
    if smoothing:
        points = smoothed(points, faces, smoothing)
    points, faces = remeshed(points, faces, nodes)
    volume = float(filled.sum() * steps.prod())
    return LabelCell(label, at_volume(points, faces, volume), faces, volume, notes)


def cells_of_image(image, voxel, nodes=642, smoothing=50, without=(), smallest=100):
    """LabelCells of all labels of an image (z, y, x), in the order of the labels.

    voxel: (3,), um, along x, y, z. without: labels to leave out; those of fewer than `smallest`
    voxels are left out with a warning. A label at the border of the image is cut there, with a
    warning. LabelError names all labels that cannot be cells.
    """
    from scipy import ndimage

    counts = np.bincount(image.ravel())
    labels = [int(n) for n in np.flatnonzero(counts) if n and n not in set(without)]
    small = [n for n in labels if counts[n] < smallest]
    if small:
        warnings.warn(f"{_listed(small)} left out: fewer than {smallest} voxels", stacklevel=2)
    labels = [n for n in labels if counts[n] >= smallest]
    places = ndimage.find_objects(image)
    cut = [n for n in labels if any(s.start == 0 or s.stop == size for s, size in
                                    zip(places[n - 1], image.shape))]
    if cut:
        warnings.warn(f"{_listed(cut)} at the border of the image: cut flat there; --without "
                      "leaves labels out", stacklevel=2)
    cells, bad = [], []
    for n in tqdm(labels, desc="meshing labels", disable=None if len(labels) > 1 else True):
        place = places[n - 1]
        try:
            cells.append(one_cell(image[place] == n, n, np.array([s.start for s in place]), voxel,
                                  nodes, smoothing))
        except ValueError as err:
            bad.append(f"  label {n} {err}")
    if bad:
        numbers = ",".join(line.split()[1] for line in bad)
        raise LabelError(f"{len(bad)} of {len(labels)} labels cannot be cells; mend the image, or "
                         f"leave them out with --without {numbers}:\n" + "\n".join(bad))
    if not cells:
        raise LabelError("no label is left")
    return cells


def _listed(labels):
    return (f"label{'s' if len(labels) > 1 else ''} {', '.join(map(str, labels[:8]))}"
            f"{' ...' if len(labels) > 8 else ''}")


def bond_slots(faces):
    """Most bonds that create_cells stores at one node of a mesh, as dcm_cell_builder.cpp shares
    them out."""
    stored = np.zeros(int(faces.max()) + 1, dtype=int)
    for a, b in edge_groups(faces)[0]:
        stored[a if stored[a] <= stored[b] else b] += 1
    return int(stored.max())


def write_cells(cells, folder, command="", type="hepatoblast", atom_types="1 2 3 1 1",
                options="rest 0.95", margin=2.0):
    """Write cell_LABEL.off for each LabelCell, and in.cells, the deck lines that create them at
    their own place and size, in the order of their labels. margin: free room in the box that a
    comment proposes, um. Returns the lines."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    digits = max(len(str(cell.label)) for cell in cells)
    rows, slots = [f"create_cells    meshes {type} 0 0 0 &"], 0
    for cell in cells:
        name = f"cell_{cell.label:0{digits}d}.off"
        write_surface(folder / name, cell.nodes, cell.faces)
        slots = max(slots, bond_slots(cell.faces))
        rows.append(f"                ${{meshes}}/{name} &")
    rows.append(f"                dcm {type} {atom_types} {options}".rstrip())
    low = np.min([cell.nodes.min(axis=0) for cell in cells], axis=0) - margin
    high = np.max([cell.nodes.max(axis=0) for cell in cells], axis=0) + margin
    box = " ".join(f"{a:.6g} {b:.6g}" for a, b in zip(low, high))
    head = ["# Cells of an image at their own place and size; lengths in um."]
    head += [f"# Made by: {command}"] if command else []
    head += ["# Before it, the deck needs a box with room for them, such as",
             f"#   region box block {box}",
             "#   create_box 3 box bond/types 1 dihedral/types 1 "
             f"extra/bond/per/atom {slots} extra/dihedral/per/atom {slots}",
             f"variable meshes index {folder}    # where the mesh files are, seen from the run"]
    lines = head + rows
    write_text(folder / "in.cells", "\n".join(lines) + "\n")
    return lines


# ---------------------------------------------------------------------- command line

def add_arguments(parser):
    """Options of `scene labels`."""
    parser.description = ("Write a mesh for each label of a segmented image, an array (z, y, x) "
                          "with 0 outside, and the lines of a deck that create the cells at their "
                          "own place and size.")
    parser.add_argument("image", metavar="IMAGE", help=".tif, .tiff or .npy")
    parser.add_argument("-o", "--output", default="cells", metavar="FOLDER",
                        help="for meshes and deck")
    parser.add_argument("--voxel", type=float, nargs="+", required=True, metavar="UM",
                        help="size of a voxel: one length, or those along x, y and z")
    parser.add_argument("--nodes", type=int, default=642, help="of each cell, about")
    parser.add_argument("--smooth", type=int, default=50, metavar="N",
                        help="rounds of Taubin's filter")
    parser.add_argument("--smallest", type=int, default=100, metavar="VOXELS",
                        help="labels of fewer voxels are left out")
    parser.add_argument("--without", default="", metavar="LABEL,...", help="labels to leave out")
    parser.add_argument("--type", default="hepatoblast", help="cell type name")
    parser.add_argument("--atom-types", default="1 2 3 1 1",
                        help="of center, nodes, faces; bond and dihedral type")
    parser.add_argument("--options", default="rest 0.95", help="further keywords of create_cells")


def run(args, command):
    """Write what the command line asks for; command: the line itself."""
    voxel = np.array(args.voxel * 3 if len(args.voxel) == 1 else args.voxel)
    if len(voxel) != 3 or not (np.isfinite(voxel) & (voxel > 0.0)).all():
        raise LabelError(f"--voxel {words(*args.voxel)}: give one length, or those along x, y and "
                         "z, um, positive")
    try:
        without = [int(w) for w in args.without.split(",") if w]
    except ValueError:
        raise LabelError(f"--without {args.without}: give labels, such as 3,17") from None
    if any(c.isspace() for c in args.output):
        raise LabelError(f"-o '{args.output}': LAMMPS takes no blanks in names of mesh files")
    if args.nodes < 12 or args.smooth < 0:
        raise LabelError(f"--nodes {args.nodes} --smooth {args.smooth}: give 12 nodes or more, and "
                         "no negative number")
    if len(args.atom_types.split()) != 5:
        raise LabelError(f"--atom-types '{args.atom_types}': give those of center, nodes and faces "
                         "and the bond and dihedral type, such as '1 2 3 1 1'")
    cells = cells_of_image(read_labels(args.image), voxel, args.nodes, args.smooth, without,
                           args.smallest)
    write_cells(cells, args.output, command, args.type, args.atom_types, args.options)
    for cell in cells:
        doubts = find_doubts(measure_surface(cell.nodes, cell.faces))
        for note in [*cell.notes, *doubts]:
            print(f"label {cell.label}: {note}")
    volumes = [cell.volume for cell in cells]
    print(f"{len(cells)} cells of {min(volumes):.4g} to {max(volumes):.4g} um^3")
    print(f"wrote {args.output}/in.cells and the meshes: `include {args.output}/in.cells` in a "
          "deck, see its first lines")
