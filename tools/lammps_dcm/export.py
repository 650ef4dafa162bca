"""`export`: cells of a run as VTK files for ParaView and OVITO, or as a page for a browser."""
from pathlib import Path
from xml.sax.saxutils import quoteattr

from tqdm import tqdm

from .frame_atoms import AtomBook
from .inputs import add_input, bulk_modulus_of, chosen_frames, load_run
from .interop import column_homes, merged_homes, to_pyvista
from .mesh import Mesh
from .render import add_coloring, chosen_opacity, chosen_picture
from .text import write_text

PARTS = ("cells", "spheres", "tracers")


def write_series(path, times, files):
    """Write a .pvd file: ParaView's list of files and their times, s."""
    rows = [f'    <DataSet timestep="{time:.17g}" file={quoteattr(name)}/>'
            for time, name in zip(times, files)]
    head = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>"]
    write_text(path, "\n".join([*head, *rows, "  </Collection>", "</VTKFile>", ""]))


def shared_homes(universe, frames, book):
    """Where columns have values (interop.column_homes), in the first, middle and last of `frames`
    together, so that all files of a series have the same arrays."""
    homes = {}
    for frame in sorted({frames[0], frames[len(frames) // 2], frames[-1]}):
        universe.trajectory[frame]
        homes = merged_homes(homes, column_homes(Mesh(book.frame())))
    return homes


def as_glyphs(points, sides=24):
    """Spheres as surfaces: PolyData of points with `radius` -> PolyData of triangles."""
    import pyvista

    if not points.n_points:
        return points
    ball = pyvista.Sphere(radius=1.0, theta_resolution=sides, phi_resolution=sides)
    made = points.glyph(geom=ball, scale="radius", orient=False, factor=1.0)
    made.field_data.update(points.field_data)
    return made


def export_frames(universe, folder, frames, bulk_modulus=None, glyphs=False, book=None):
    """Write cells, spheres and tracers of `frames` into `folder`: PART.NNNNN.vtp a frame and
    PART.pvd for all; parts that no frame has are left out. The .pvd files are written also if this
    is interrupted. Returns a dict of part -> number of files."""
    folder, book = Path(folder), book or AtomBook(universe)
    frames = list(frames)
    homes = shared_homes(universe, frames, book)
    folder.mkdir(parents=True, exist_ok=True)
    times, files, sizes = [], {part: [] for part in PARTS}, dict.fromkeys(PARTS, 0)
    try:
        for frame in tqdm(frames, desc="exporting", disable=None if len(frames) > 1 else True):
            blocks = to_pyvista(universe, frame, bulk_modulus, homes, book)
            for part in PARTS:
                block = as_glyphs(blocks[part]) if glyphs and part == "spheres" else blocks[part]
                name = f"{part}.{frame:05d}.vtp"
                save(block, folder / name)
                files[part].append(name)
                sizes[part] += block.n_points
            times.append(float(universe.trajectory.ts.time))
    finally:
        for part in PARTS:
            if sizes[part]:
                write_series(folder / f"{part}.pvd", times, files[part])
            else:
                for name in files[part]:
                    (folder / name).unlink()
                (folder / f"{part}.pvd").unlink(missing_ok=True)
    return {part: len(files[part]) for part in PARTS if sizes[part]}


def save(block, path):
    """Write PolyData as a .vtp file, uncompressed and with its arrays in place, since OVITO reads
    no other; an old file stays as it is if this fails."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    part = path.with_name(path.name + ".part")
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(part))
    writer.SetInputData(block)
    writer.SetDataModeToBinary()
    writer.SetCompressorTypeToNone()
    if not writer.Write():
        part.unlink(missing_ok=True)
        raise OSError(f"{path}: cannot be written: is the disk full?")
    part.replace(path)


# ---------------------------------------------------------------------- command line

def add_arguments(parser):
    """Options of `export`."""
    parser.epilog = ("Writes PART.NNNNN.vtp per frame and PART.pvd, the time series, for the parts "
                     "cells, spheres and tracers. In ParaView open the .pvd files.")
    add_input(parser)
    parser.add_argument("--frame", default="all", help="number from 0, from the end if negative, "
                        "or all (default: %(default)s; with --html: the last)")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="every Nth frame")
    parser.add_argument("--dt", type=float, metavar="SECONDS", help="length of a step, for times "
                        "in seconds, unless the dump has times (dump_modify time yes)")
    parser.add_argument("-o", "--output", default="export", metavar="FOLDER",
                        help="default: %(default)s")
    parser.add_argument("--spheres", choices=["points", "glyphs"], default="points",
                        help="center-based cells as points with a radius, or as surfaces "
                        "(default: %(default)s)")
    parser.add_argument("--html", metavar="FILE", help="instead, write one frame into an HTML file "
                        "that a browser shows and turns; the options below say how it looks")
    add_coloring(parser)


def run(args, words):
    """Write what the command line asks for."""
    if args.every < 1:
        raise ValueError(f"--every {args.every}: give 1 or more")
    if args.dt is not None and not 0.0 < args.dt < float("inf"):
        raise ValueError(f"--dt {args.dt:g}: the length of a step must be positive, s")
    asked = "-1" if args.html and args.frame == "all" else args.frame
    universe = load_run(args, asked)
    book = AtomBook(universe)
    frames = list(chosen_frames(asked, len(universe.trajectory)))[::args.every]
    if args.html:
        from .browser import write_html

        universe.trajectory[frames[0]]
        picture = chosen_picture(args, universe, book)
        write_html(picture, args.html, args.cmap, view=args.view, edges=args.edges,
                   opacity=chosen_opacity(args))
        print(f"wrote {args.html}: {picture.title}, {len(picture.triangles)} faces, "
              f"{len(picture.centers)} spheres, {Path(args.html).stat().st_size / 1e6:.1f} MB")
        return
    written = export_frames(universe, args.output, frames, bulk_modulus_of(args.bulk_modulus),
                            args.spheres == "glyphs", book)
    if not written:
        raise ValueError("nothing to export: no faces, spheres or tracers are known; give --data "
                         "FILE, or dump kind, v1 v2 v3 and radius (compute property/atom)")
    for part, count in written.items():
        print(f"wrote {args.output}/{part}.pvd: {count} frame{'s' if count > 1 else ''}")
    if args.dump and args.dt is None and not has_times(universe):
        print("times are steps: give --dt SECONDS, the length of a step, or add "
              "`dump_modify ID time yes` to the deck")


def has_times(universe):
    """Whether the frames of a dump tell their time."""
    return universe.trajectory.dump.frame(0).time is not None
