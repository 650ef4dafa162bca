"""Pictures of a frame: surfaces of deformable cells and spheres, without a display.

VTK (through pyvista) draws where it can; elsewhere matplotlib does, slower and plainer.
"""
import multiprocessing
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from .analysis import CellPressure
from .frame_atoms import AtomBook
from .inputs import add_input, bulk_modulus_of, chosen_frames, load_run, pairs
from .lumen import lumen_faces, marked_rows
from .mesh import Mesh
from .section import REGION_COLORS, WALL
from .topology import CENTER, FACE, NODE, REGION_NAMES, SPHERE
from .triangles import triangle_vectors

VIEWS = {"xy": (0, 0, 1), "xz": (0, -1, 0), "yz": (1, 0, 0), "iso": (1, -1, 0.8)}
UP = {"xy": (0, 1, 0), "xz": (0, 0, 1), "yz": (0, 0, 1), "iso": (0, 0, 1)}
PALETTE = ["#4c78a8", "#f58518", "#54a24b", "#e45756", "#72b7b2", "#eeca3b", "#b279a2", "#ff9da6",
           "#9d755d", "#bab0ac"]
GREY = 0.75
# lumens, the largest first
LUMENS = ["#1c7ed6", "#a61e4d", "#5f3dc4", "#087f5b"]
FAINT = 0.2    # opacity of cells around a lumen that is drawn


@dataclass
class Picture:
    """What to draw. points (n, 3) um and triangles (m, 3) rows of points: the surfaces; centers
    (s, 3), radii (s,) um: spheres; dots (t, 3): tracers; face_rgb (m, 3), sphere_rgb (s, 3);
    bar: None or (title, low, high) of a color scale; legend: dict of label -> color; title;
    solid (m,): faces of a lumen, drawn opaque where cells are translucent."""

    points: np.ndarray
    triangles: np.ndarray
    centers: np.ndarray
    radii: np.ndarray
    dots: np.ndarray
    face_rgb: np.ndarray
    sphere_rgb: np.ndarray
    bar: tuple
    legend: dict
    title: str
    solid: np.ndarray


def categories(face_values, sphere_values, label, called=None, known=()):
    """Palette colors of values: ((m, 3), (s, 3), legend of at most ten); called: value -> name.
    known: values that may occur in other frames, so that each keeps its color."""
    from matplotlib.colors import to_rgb

    names, at = np.unique(np.append(face_values, sphere_values).astype(str), return_inverse=True)
    order = sorted({*names.tolist(), *known}, key=lambda name: (len(name), name))
    color = {name: PALETTE[n % len(PALETTE)] for n, name in enumerate(order)}
    rgb = np.array([to_rgb(color[name]) for name in names]).reshape(-1, 3)[at]
    legend = {(called or {}).get(name, f"{label} {name}".strip()): color[name]
              for name in order if name in names} if len(names) <= len(PALETTE) else {}
    return rgb[:len(face_values)], rgb[len(face_values):], legend


def named_colors(names, colors, on_spheres):
    """Colors of names (m,) from a dict, spheres gray: ((m, 3), (s, 3), legend of those there)."""
    from matplotlib.colors import to_rgb

    rgb = np.array([to_rgb(colors[name]) for name in names]).reshape(-1, 3)
    there = set(names)
    return rgb, np.full((on_spheres, 3), GREY), {n: c for n, c in colors.items() if n in there}


def cell_colors(face_cells, sphere_cells):
    """Palette colors of molecule IDs, ((m, 3), (s, 3)): a cell keeps its color while others come
    and go."""
    from matplotlib.colors import to_rgb

    palette = np.array([to_rgb(c) for c in PALETTE])
    return palette[(face_cells - 1) % len(PALETTE)], palette[(sphere_cells - 1) % len(PALETTE)]


def scale(face_values, sphere_values, title, limits, cmap):
    """Colors of numbers, NaN in gray: ((m, 3), (s, 3), bar)."""
    import matplotlib

    values = np.append(face_values, sphere_values).astype(float)
    known = np.isfinite(values)
    if limits is None:
        limits = (values[known].min(), values[known].max()) if known.any() else (0.0, 1.0)
    low, high = limits
    if high - low <= 1e-9 * max(abs(low), abs(high)):    # equal but for round-off
        margin = 0.01 * abs(low) or 1.0
        low, high = low - margin, high + margin
    t = np.clip((np.where(known, values, low) - low) / (high - low), 0.0, 1.0)
    rgb = np.where(known[:, None], matplotlib.colormaps[cmap](t)[:, :3], GREY)
    return rgb[:len(face_values)], rgb[len(face_values):], (title, low, high)


def column_values(universe, mesh, spheres, name):
    """A dump column on faces and spheres; where faces have nothing, the value of the center."""
    data = universe.trajectory.ts.data
    if name not in data or np.ndim(data[name]) != 1:
        columns = [c for c, v in data.items() if np.ndim(v) == 1 and len(v) == len(universe.atoms)]
        raise ValueError(f"--color {name}: neither cell, type, region, mark, pressure, contact nor "
                         f"a column of the dump, which has {' '.join(columns)}")
    return mesh.face_column(name), data[name][spheres]


def make_picture(universe, color="type", limits=None, cmap="viridis", bulk_modulus=None,
                 names=None, book=None, lumen=False):
    """Picture of the current frame of a Universe, colored by `color` (see the command's help).
    lumen: the walls of lumens in colors of their own. book: AtomBook of the Universe, to be shared
    by several pictures."""
    book = book or AtomBook(universe)
    ts, atoms = universe.trajectory.ts, book.frame()
    xyz, spheres = atoms.xyz, atoms.spheres()
    radii = atoms.sphere_radii(spheres)
    spheres, radii = spheres[~np.isnan(radii)], radii[~np.isnan(radii)]
    parts = atoms.there & np.isin(atoms.kind, (CENTER, NODE, FACE))
    mesh = Mesh(atoms) if parts.any() else None
    if mesh is None and not len(spheres):
        raise ValueError("nothing to draw: no faces and no spheres are known; give --data FILE")
    if mesh is None:
        points, triangles = np.zeros((0, 3)), np.zeros((0, 3), dtype=int)
        molecule, types = np.zeros(0, dtype=int), np.zeros(0, dtype=object)
    else:
        if not mesh.known.all():
            book.warn(f"cell {mesh.ids[~mesh.known][0]}: the vertices of its faces are not known, "
                      "so it is not drawn: dump the columns v1 v2 v3 (compute property/atom)",
                      atoms.where)
        _, points, triangles = mesh.surface()
        molecule, types = mesh.ids[mesh.cell], mesh.types[mesh.cell]

    bar, legend, nothing = None, {}, np.full(len(spheres), np.nan)
    if color == "cell":
        atoms.require_cells()
        face_rgb, sphere_rgb = cell_colors(molecule, atoms.mol[spheres])
    elif color == "type":
        face_rgb, sphere_rgb, legend = categories(
            types, atoms.type[spheres], "type", names,
            known=book.type[np.isin(book.kind, (CENTER, SPHERE))].tolist())
    elif mesh is None:
        raise ValueError(f"--color {color}: the frame has no deformable cells; use type or cell")
    elif color == "region":
        regions = [REGION_NAMES.get(int(r), "?") for r in atoms.region[mesh.faces]]
        face_rgb, sphere_rgb, legend = named_colors(regions, REGION_COLORS, len(spheres))
    elif color == "mark":
        marked = np.full(len(mesh.faces), "not marked", dtype=object)
        marked[marked_rows(mesh, "mark", ts.data)] = "marked"
        face_rgb, sphere_rgb, legend = named_colors(
            marked, {"marked": WALL, "not marked": "#cfe3dc"}, len(spheres))
    elif color == "pressure":
        if bulk_modulus is None:
            raise ValueError("--color pressure: give the bulk modulus, --bulk-modulus K_V (kPa)")
        frame = ts.frame
        run = CellPressure(universe, bulk_modulus, book=book).run(frames=[frame])
        universe.trajectory[frame]    # run() ends at frame 0
        face_rgb, sphere_rgb, bar = scale(run.results.pressure[0][mesh.cell], nothing,
                                          "pressure, kPa", limits, cmap)
    elif color == "contact":
        if "contact_area" not in ts.data:
            raise ValueError("--color contact: the dump has no column contact_area: add it from "
                             "compute dcm/face, or name it with --rename COLUMN=contact_area")
        area = np.linalg.norm(triangle_vectors(mesh.corners), axis=1)
        face_rgb, sphere_rgb, bar = scale(ts.data["contact_area"][mesh.faces] / area, nothing,
                                          "contact area / face area", limits or (0, 1), cmap)
    else:
        faces, on_spheres = column_values(universe, mesh, spheres, color)
        face_rgb, sphere_rgb, bar = scale(faces, on_spheres, color, limits, cmap)
    solid = np.zeros(len(triangles), dtype=bool)
    if lumen and mesh is not None:
        from matplotlib.colors import to_rgb

        number = lumen_faces(universe, mesh, book)
        solid = number >= 0
        palette = np.array([to_rgb(c) for c in LUMENS])
        face_rgb[solid] = palette[number[solid] % len(LUMENS)]
        for n in range(min(number.max(initial=-1) + 1, len(LUMENS))):
            legend[f"lumen {n + 1}"] = LUMENS[n]
    return Picture(points, triangles, xyz[spheres], radii, xyz[atoms.tracers()],
                   face_rgb, sphere_rgb, bar, legend, f"step {ts.data.get('step', 0)}", solid)


def build_plotter(picture, view="xy", size=1200, edges=False, opacity=1.0, round_=40):
    """Off-screen pyvista.Plotter with the surfaces, spheres and tracers of a Picture, without text;
    round_: sides of a sphere."""
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=(size, size))
    plotter.set_background("white")
    light = dict(smooth_shading=True, specular=0.2, specular_power=10)
    for part, alpha in ((picture.solid, 1.0), (~picture.solid, opacity)):
        if not part.any():
            continue
        triangles = picture.triangles[part]
        faces = np.column_stack([np.full(len(triangles), 3), triangles])
        surface = pyvista.PolyData(picture.points, faces.ravel())
        surface.cell_data["rgb"] = (255 * picture.face_rgb[part]).astype(np.uint8)
        plotter.add_mesh(surface, scalars="rgb", rgb=True, opacity=alpha, show_edges=edges,
                         edge_opacity=0.5, line_width=1, **light)
    if len(picture.centers):
        cloud = pyvista.PolyData(picture.centers)
        cloud["radius"] = picture.radii
        cloud["rgb"] = (255 * picture.sphere_rgb).astype(np.uint8)
        ball = pyvista.Sphere(radius=1.0, theta_resolution=round_, phi_resolution=round_)
        plotter.add_mesh(cloud.glyph(geom=ball, scale="radius", orient=False, factor=1.0),
                         scalars="rgb", rgb=True, opacity=opacity if picture.solid.any() else 1.0,
                         **light)
    if len(picture.dots):
        plotter.add_points(picture.dots, color="crimson", point_size=4)
    plotter.enable_parallel_projection()
    plotter.view_vector(VIEWS[view], UP[view])
    plotter.camera.zoom(1.2 if view != "iso" else 1.1)
    return plotter


def draw_vtk(picture, output, view="xy", size=1200, edges=False, opacity=1.0, cmap="viridis"):
    """Draw with VTK, off screen, into a PNG file."""
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)    # it complains of a missing display
    import pyvista

    plotter = build_plotter(picture, view, size, edges, opacity)
    if picture.bar:
        title, low, high = picture.bar
        plotter.add_mesh(pyvista.PolyData(np.zeros((1, 3))), scalars=[low], clim=(low, high),
                         cmap=cmap, opacity=0.0, show_scalar_bar=True, reset_camera=False,
                         scalar_bar_args=dict(title=title, color="black", n_labels=5))
    font = max(6, size // 110)
    for n, (label, rgb) in enumerate([(picture.title, "black"), *picture.legend.items()]):
        plotter.add_text(label, position=(font, size - (n + 1) * 2.4 * font), color=rgb,
                         font_size=font)
    plotter.screenshot(str(output))
    plotter.close()


def draw_matplotlib(picture, output, view="xy", size=1200, edges=False, opacity=1.0,
                    cmap="viridis"):
    """Draw with matplotlib into an image file; spheres are coarse, faces flat."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 17), np.linspace(0, np.pi, 9))
    grid = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=-1)
    quads = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2)
    quads = quads.reshape(-1, 4, 3)
    towards = np.array(VIEWS[view], dtype=float) / np.linalg.norm(VIEWS[view])
    corners = picture.points[picture.triangles]
    normals = triangle_vectors(corners) if len(corners) else np.zeros((0, 3))
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    polygons, colors = list(corners), [picture.face_rgb * shade(normals @ towards)]
    dark = shade(quads.mean(axis=1) @ towards)
    for center, radius, rgb in zip(picture.centers, picture.radii, picture.sphere_rgb):
        polygons += list(center + radius * quads)
        colors.append(rgb * dark)
    figure = pyplot.figure(figsize=(size / 120, size / 120), dpi=120)
    axes = figure.add_subplot(projection="3d", proj_type="ortho")
    alpha = np.full(len(polygons), opacity)
    alpha[:len(corners)][picture.solid] = 1.0
    colors = np.column_stack([np.vstack(colors), alpha])
    axes.add_collection3d(Poly3DCollection(polygons, facecolors=colors,
                                           edgecolors="k" if edges else "none", linewidths=0.2))
    if len(picture.dots):
        axes.scatter(*picture.dots.T, s=2, c="crimson")
    everything = np.vstack(polygons)
    axes.set(**{f"{a}lim": (lo, hi) for a, lo, hi in
                zip("xyz", everything.min(axis=0), everything.max(axis=0))})
    axes.set_box_aspect(np.ptp(everything, axis=0), zoom=1.25)
    axes.view_init(**{"xy": dict(elev=90, azim=-90), "xz": dict(elev=0, azim=-90),
                      "yz": dict(elev=0, azim=0), "iso": dict(elev=30, azim=-45)}[view])
    axes.set_axis_off()
    axes.set_title(picture.title)
    if picture.bar:
        title, low, high = picture.bar
        norm = matplotlib.colors.Normalize(low, high)
        figure.colorbar(matplotlib.cm.ScalarMappable(norm, cmap), ax=axes, shrink=0.5, label=title)
    for label, rgb in picture.legend.items():
        axes.plot([], [], [], "o", color=rgb, label=label)
    if picture.legend:
        axes.legend(loc="upper right")
    figure.savefig(output)
    pyplot.close(figure)


def shade(cosine):
    """Brightness (n, 1) of surfaces whose normal has `cosine` (n,) with the line of sight."""
    return (0.45 + 0.55 * np.clip(np.abs(cosine), 0.0, 1.0))[:, None]


def draw(picture, output, engine="auto", **options):
    """Draw with engine `vtk`, `matplotlib` or `auto` (VTK, if that fails matplotlib).

    VTK runs in a child process: without a usable OpenGL it may end the process it runs in.
    Returns the name of the engine that drew.
    """
    if engine != "matplotlib":
        child = multiprocessing.get_context("fork").Process(
            target=_child, args=(picture, output, options))
        child.start()
        child.join()
        if child.exitcode == 0 and Path(output).exists():
            return "vtk"
        if engine == "vtk":
            raise ValueError("VTK could not draw here: install pyvista and a software OpenGL "
                             "(Debian: libegl1 libgl1-mesa-dri), or use --engine matplotlib")
        print("VTK could not draw here, matplotlib does", file=sys.stderr)
    draw_matplotlib(picture, output, **options)
    return "matplotlib"


def _child(picture, output, options):
    try:
        draw_vtk(picture, output, **options)
    except Exception as err:
        print(f"VTK: {type(err).__name__}: {err}", file=sys.stderr)
        sys.exit(1)


# ---------------------------------------------------------------------- command line

def add_coloring(parser):
    """The options that say how cells look, shared with `export --html`."""
    parser.add_argument("--color", default="type", help="type, cell, region, mark, pressure, "
                        "contact, or any column of the dump (default: %(default)s)")
    parser.add_argument("--names", metavar="TYPE=NAME,...", help="names of atom types (of "
                        "centers and spheres) for the legend")
    parser.add_argument("--limits", nargs=2, type=float, metavar=("LOW", "HIGH"),
                        help="ends of the color scale; by default those of the values")
    parser.add_argument("--cmap", default="viridis", help="matplotlib color map")
    parser.add_argument("--view", choices=list(VIEWS), default="xy", help="plane that is seen")
    parser.add_argument("--edges", action="store_true", help="draw the mesh")
    parser.add_argument("--lumen", action="store_true", help="the marked walls of lumens (dump "
                        "column mark) in a color of their own, cells translucent")
    parser.add_argument("--opacity", type=float, help="of the deformable cells; default 1, with "
                        f"--lumen {FAINT:g}, and then of spheres too")


def chosen_picture(args, universe, book):
    """Picture of the current frame as add_coloring's options ask for it."""
    return make_picture(universe, args.color, args.limits, args.cmap,
                        bulk_modulus_of(args.bulk_modulus), pairs(args.names, "--names"), book,
                        args.lumen)


def chosen_opacity(args):
    """Opacity of deformable cells that add_coloring's options ask for."""
    return args.opacity if args.opacity is not None else FAINT if args.lumen else 1.0


def add_arguments(parser):
    """Options of `render`."""
    add_input(parser)
    parser.add_argument("--frame", default="-1", help="number from 0, from the end if negative, "
                        "or all: one numbered picture each (default: %(default)s)")
    parser.add_argument("-o", "--output", default="frame.png", help="default: %(default)s")
    add_coloring(parser)
    parser.add_argument("--section", metavar="AXIS[=AT]", help="cut by the plane across this axis, "
                        "drawn flat: regions of the surface, lumens (dump column mark), apical "
                        "vectors (ax ay az), tracers")
    parser.add_argument("--window", nargs=4, type=float, metavar=("X0", "X1", "Y0", "Y1"),
                        help="what a section shows, um; by default all deformable cells")
    parser.add_argument("--size", type=int, default=1200, help="width and height, pixel")
    parser.add_argument("--engine", choices=["auto", "vtk", "matplotlib"], default="auto")


def run(args, words):
    """Render what the command line asks for."""
    universe = load_run(args, args.frame)
    book = AtomBook(universe)
    count = len(universe.trajectory)
    frames = chosen_frames(args.frame, count)
    output = Path(args.output)
    if args.section:
        run_sections(args, universe, book, frames, output)
        return
    opacity = chosen_opacity(args)
    for frame in tqdm(frames, desc="rendering", disable=None if len(frames) > 1 else True):
        universe.trajectory[frame]
        picture = chosen_picture(args, universe, book)
        name = numbered(output, args.frame, frame)
        engine = draw(picture, name, args.engine, view=args.view, size=args.size,
                      edges=args.edges, opacity=opacity, cmap=args.cmap)
        if len(frames) == 1:
            print(f"wrote {name} ({engine}, {picture.title}, frame {frame} of {count})")
    if len(frames) > 1:
        print(f"wrote {len(frames)} pictures {output.with_stem(output.stem + '.NNNNN')}")


def numbered(output, asked, frame):
    """Name of the picture of `frame`, with --frame `asked`."""
    return output if asked != "all" else output.with_stem(f"{output.stem}.{frame:05d}")


def run_sections(args, universe, book, frames, output):
    """Draw sections; all frames show the same window."""
    from .lumen import parse_plane
    from .section import draw_section, make_section

    axis, at = parse_plane(args.section)
    names, window = pairs(args.names, "--names"), args.window
    if window is None:
        ends = []
        for frame in {frames[0], frames[-1]}:
            universe.trajectory[frame]
            ends.append(make_section(universe, axis, at, book).window())
        low, high = np.min(ends, axis=0), np.max(ends, axis=0)
        half = 0.5 * max(high[1] - low[0], high[3] - low[2])
        x, y = 0.5 * (low[0] + high[1]), 0.5 * (low[2] + high[3])
        window = (x - half, x + half, y - half, y + half)
    elif not (window[0] < window[1] and window[2] < window[3]):
        raise ValueError("--window: give X0 < X1 and Y0 < Y1")
    for frame in tqdm(frames, desc="rendering", disable=None if len(frames) > 1 else True):
        universe.trajectory[frame]
        draw_section(make_section(universe, axis, at, book), numbered(output, args.frame, frame),
                     args.size, window, names)
    print(f"wrote {output}" if args.frame != "all" else
          f"wrote {len(frames)} pictures {output.with_stem(output.stem + '.NNNNN')}")
