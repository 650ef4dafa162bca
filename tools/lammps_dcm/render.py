"""Pictures and movies of a run: surfaces of deformable cells and spheres, without a display.

What is seen of a frame, in which colors; drawing.py draws it.
"""
import contextlib
import tempfile
from pathlib import Path

import numpy as np
from tqdm import tqdm

from .analysis import CellPressure
from .drawing import VIEWS, Picture, draw_all, window_of
from .frame_atoms import AtomBook
from .inputs import add_input, bulk_modulus_of, chosen_frames, load_run, pairs
from .lumen import lumen_faces, marked_rows
from .mesh import Mesh
from .run_folder import find_run
from .section import REGION_COLORS, WALL
from .topology import CENTER, FACE, NODE, REGION_NAMES, SPHERE
from .triangles import triangle_vectors

PALETTE = ["#4c78a8", "#f58518", "#54a24b", "#e45756", "#72b7b2", "#eeca3b", "#b279a2", "#ff9da6",
           "#9d755d", "#bab0ac"]
GREY = 0.75
# lumens, the largest first
LUMENS = ["#1c7ed6", "#a61e4d", "#5f3dc4", "#087f5b"]
UNITS = {"stress": "kPa", "curvature": "1/um", "volume": "um^3", "area": "um^2",
         "contact_area": "um^2"}
FAINT = 0.2    # opacity of cells around a lumen that is drawn
FRAMES = 30    # of a movie, unless --frames says otherwise
SLOW_FRAMES = 10    # where matplotlib draws it
FLAT = 0.5    # a scene whose height is below this part of its width is seen from above


def categories(face_values, sphere_values, label, called=None, known=(), colors=None):
    """Palette colors of values: ((m, 3), (s, 3), legend of at most ten); called: value -> name.
    known: values that may occur in other frames, so that each keeps its color; colors: value ->
    color in place of that of the palette."""
    from matplotlib.colors import to_rgb

    names, at = np.unique(np.append(face_values, sphere_values).astype(str), return_inverse=True)
    order = sorted({*names.tolist(), *known}, key=lambda name: (len(name), name))
    color = {name: PALETTE[n % len(PALETTE)] for n, name in enumerate(order)} | (colors or {})
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
    """Colors of numbers, NaN in gray: ((m, 3), (s, 3), bar, numbers)."""
    import matplotlib

    values = np.append(face_values, sphere_values).astype(float)
    known = np.isfinite(values)
    if limits is None:
        limits = (values[known].min(), values[known].max()) if known.any() else (0.0, 1.0)
    low, high = limits
    low, high = (0.0 if abs(v) < 1e-9 * max(abs(low), abs(high)) else v for v in (low, high))
    if high - low <= 1e-9 * max(abs(low), abs(high)):    # equal but for round-off
        margin = 0.01 * abs(low) or 1.0
        low, high = low - margin, high + margin
    t = np.clip((np.where(known, values, low) - low) / (high - low), 0.0, 1.0)
    rgb = np.where(known[:, None], matplotlib.colormaps[cmap](t)[:, :3], GREY)
    return (rgb[:len(face_values)], rgb[len(face_values):], (title, low, high),
            (face_values, sphere_values))


def one_scale(pictures, cmap):
    """Color the numbers of all pictures by the same scale, that of the second half of them."""
    scaled = [p for p in pictures if p.values]
    if not scaled:
        return
    late = scaled[len(scaled) // 2:]    # cells begin without pressure, and far from rest
    limits = min(p.bar[1] for p in late), max(p.bar[2] for p in late)
    for p in scaled:
        solid = p.face_rgb[p.solid]
        p.face_rgb, p.sphere_rgb, p.bar, _ = scale(*p.values, p.bar[0], limits, cmap)
        p.face_rgb[p.solid] = solid


def time_text(seconds):
    """Time as text, in the unit that fits."""
    if abs(seconds) < 180.0:
        return f"{seconds:.3g} s"
    return f"{seconds / 60.0:.1f} min" if abs(seconds) < 7200.0 else f"{seconds / 3600.0:.2f} h"


def telling_color(universe, book):
    """What the cells of the current frame are best told apart by: a value of --color."""
    atoms, data = book.frame(), universe.trajectory.ts.data

    def differ(values):
        values = values[np.isfinite(values)]
        return len(values) > 1 and np.ptp(values) > 1e-9 * np.abs(values).max()

    faces = atoms.there & (atoms.kind == FACE)
    centers = atoms.there & np.isin(atoms.kind, (CENTER, SPHERE))
    shaped = atoms.there & (atoms.kind == CENTER)
    if faces.any() and "mark" in data and (data["mark"][faces] > 0).any():
        return "region" if (atoms.region[faces] > 0).any() else "mark"
    if "generation" in data and differ(data["generation"][centers]):
        return "generation"
    if len(set(atoms.type[centers])) > 1:
        return "type"
    if (atoms.region[faces] > 0).any():
        return "region"
    if "pressure" in data and differ(data["pressure"][shaped]):
        return "pressure"
    if centers.sum() > 1:
        return "cell"
    for name in ("stress", "curvature"):
        if name in data and differ(data[name][faces]):
            return name
    return "type"


def telling_view(universe, book):
    """From above if the scene is flat, else aslant."""
    atoms = book.frame()
    cells = atoms.there & np.isin(atoms.kind, (CENTER, NODE, SPHERE))
    radius = np.nan_to_num(np.where(atoms.kind == SPHERE, atoms.radius, 0.0))[cells, None]
    xyz = atoms.xyz[cells]
    if not len(xyz):
        return "xy"
    size = (xyz + radius).max(axis=0) - (xyz - radius).min(axis=0)
    return "xy" if size[2] < FLAT * size[:2].max() else "iso"


def column_values(universe, mesh, spheres, name):
    """A dump column on faces and spheres; where faces have nothing, the value of the center."""
    data = universe.trajectory.ts.data
    if name not in data or np.ndim(data[name]) != 1:
        columns = [c for c, v in data.items() if np.ndim(v) == 1 and len(v) == len(universe.atoms)]
        raise ValueError(f"--color {name}: neither cell, type, region, mark, pressure, contact nor "
                         f"a column of the dump, which has {' '.join(columns)}")
    return mesh.face_column(name), data[name][spheres]


def generations(universe, mesh, spheres):
    """Column generation on faces and spheres, whole numbers."""
    data = universe.trajectory.ts.data
    if "generation" not in data:
        raise ValueError("--color generation: the dump has no column generation: add it from "
                         "compute dcm/cell")
    faces = mesh.face_column("generation") if mesh is not None else np.zeros(0)
    return [np.nan_to_num(v).astype(int) for v in (faces, data["generation"][spheres])]


def make_picture(universe, color="type", limits=None, cmap="viridis", bulk_modulus=None,
                 names=None, book=None, lumen=False, dt=None, colors=None):
    """Picture of the current frame of a Universe, colored by `color` (see the command's help).
    lumen: the walls of lumens in colors of their own. book: AtomBook of the Universe, to be shared
    by several pictures. dt: length of a step, s, of a dump without times. colors: atom type ->
    color, with color="type"."""
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

    bar, values, legend, nothing = None, None, {}, np.full(len(spheres), np.nan)
    if color == "cell":
        atoms.require_cells()
        face_rgb, sphere_rgb = cell_colors(molecule, atoms.mol[spheres])
    elif color == "type":
        face_rgb, sphere_rgb, legend = categories(
            types, atoms.type[spheres], "type", names,
            known=book.type[np.isin(book.kind, (CENTER, SPHERE))].tolist(), colors=colors)
    elif color == "generation":
        faces, on_spheres = generations(universe, mesh, spheres)
        face_rgb, sphere_rgb, legend = categories(faces, on_spheres, "generation",
                                                  known=map(str, range(len(PALETTE))))
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
        if bulk_modulus is not None:
            frame = ts.frame
            run = CellPressure(universe, bulk_modulus, book=book).run(frames=[frame])
            universe.trajectory[frame]    # run() ends at frame 0
            pressure = run.results.pressure[0][mesh.cell]
        elif "pressure" in ts.data:
            pressure = mesh.face_column("pressure")
        else:
            raise ValueError("--color pressure: dump the column pressure (compute dcm/cell), or "
                             "give the bulk modulus, --bulk-modulus K_V (kPa)")
        face_rgb, sphere_rgb, bar, values = scale(pressure, nothing, "pressure, kPa", limits, cmap)
    elif color == "contact":
        if "contact_area" not in ts.data:
            raise ValueError("--color contact: the dump has no column contact_area: add it from "
                             "compute dcm/face, or name it with --rename COLUMN=contact_area")
        area = np.linalg.norm(triangle_vectors(mesh.corners), axis=1)
        face_rgb, sphere_rgb, bar, values = scale(
            ts.data["contact_area"][mesh.faces] / area, nothing, "contact area / face area",
            limits or (0, 1), cmap)
    else:
        faces, on_spheres = column_values(universe, mesh, spheres, color)
        unit = UNITS.get(color)
        face_rgb, sphere_rgb, bar, values = scale(
            faces, on_spheres, f"{color}, {unit}" if unit else color, limits, cmap)
    solid = np.zeros(len(triangles), dtype=bool)
    if lumen and mesh is not None:
        from matplotlib.colors import to_rgb

        number = lumen_faces(universe, mesh, book)
        solid = number >= 0
        palette = np.array([to_rgb(c) for c in LUMENS])
        face_rgb[solid] = palette[number[solid] % len(LUMENS)]
        for n in range(min(number.max(initial=-1) + 1, len(LUMENS))):
            legend[f"lumen {n + 1}"] = LUMENS[n]
    step = ts.data.get("step", 0)
    seconds = ts.data.get("seconds", None if dt is None else step * dt)
    title = f"step {step}" if seconds is None else time_text(seconds)
    return Picture(points, triangles, xyz[spheres], radii, xyz[atoms.tracers()],
                   face_rgb, sphere_rgb, bar, legend, title, solid, values)


# ---------------------------------------------------------------------- command line

def type_colors(text):
    """Dict of atom type -> color from the text of --colors."""
    from matplotlib.colors import is_color_like

    colors = pairs(text, "--colors")
    for color in colors.values():
        if not is_color_like(color):
            raise ValueError(f"--colors {text}: {color} is no color: give a name, such as crimson, "
                             "or #rrggbb")
    return colors


def add_coloring(parser, color="type", view="xy"):
    """The options that say how cells look, shared with `export --html`."""
    parser.add_argument("--color", default=color, help="type, cell, region, mark, pressure, "
                        "contact, any column of the dump, such as generation or stress, or auto: "
                        "what tells the cells apart (default: %(default)s)")
    parser.add_argument("--names", metavar="TYPE=NAME,...", help="names of atom types (of "
                        "centers and spheres) for the legend")
    parser.add_argument("--colors", metavar="TYPE=COLOR,...", help="colors of atom "
                        "types, as matplotlib names them, with --color type")
    parser.add_argument("--limits", nargs=2, type=float, metavar=("LOW", "HIGH"),
                        help="ends of the color scale; by default those of the values")
    parser.add_argument("--cmap", default="viridis", help="matplotlib color map")
    parser.add_argument("--view", choices=[*VIEWS, "auto"], default=view, help="plane that is "
                        "seen, or auto: xy if the scene is flat, else iso (default: %(default)s)")
    parser.add_argument("--edges", action="store_true", help="draw the mesh")
    parser.add_argument("--lumen", action="store_true", help="the marked walls of lumens (dump "
                        "column mark) in a color of their own, cells translucent")
    parser.add_argument("--opacity", type=float, help="of the deformable cells; default 1, with "
                        f"--lumen {FAINT:g}, and then of spheres too")


def decide(args, universe, book):
    """Replace `auto` in add_coloring's options by what fits the current frame."""
    if args.color == "auto":
        args.color = telling_color(universe, book)
    if args.view == "auto":
        args.view = telling_view(universe, book)


def chosen_picture(args, universe, book):
    """Picture of the current frame as add_coloring's options ask for it."""
    decide(args, universe, book)
    return make_picture(universe, args.color, args.limits, args.cmap,
                        bulk_modulus_of(args.bulk_modulus), pairs(args.names, "--names"), book,
                        args.lumen, args.dt, type_colors(args.colors))


def chosen_opacity(args):
    """Opacity of deformable cells that add_coloring's options ask for."""
    return args.opacity if args.opacity is not None else FAINT if args.lumen else 1.0


def add_arguments(parser):
    """Options of `render`."""
    add_input(parser)
    parser.epilog = ("In place of the dump the folder of a run may be named: then what tells most "
                     "is drawn of the dump or data file in it.")
    parser.add_argument("--frame", default="-1", help="number from 0, from the end if negative, "
                        "or all: one numbered picture each (default: %(default)s)")
    parser.add_argument("-o", "--output", default="frame.png", help="default: %(default)s")
    parser.add_argument("--movie", metavar="FILE", help="a movie as well, .gif or .mp4")
    parser.add_argument("--frames", type=int, default=FRAMES, metavar="N", help="at most so many "
                        "frames of the dump, evenly spread, are in it (default: %(default)s)")
    parser.add_argument("--dt", type=float, metavar="SECONDS", help="length of a step, for the "
                        "time in the picture, unless the dump has times (dump_modify time yes)")
    add_coloring(parser)
    parser.add_argument("--section", metavar="AXIS[=AT]", help="cut by the plane across this axis, "
                        "drawn flat: regions of the surface, lumens (dump column mark), apical "
                        "vectors (ax ay az), tracers")
    parser.add_argument("--window", nargs=4, type=float, metavar=("X0", "X1", "Y0", "Y1"),
                        help="what a section shows, um; by default all deformable cells")
    parser.add_argument("--size", type=int, default=1200, help="width and height, pixel; a movie "
                        "has half of it, and its height as the scene needs")
    parser.add_argument("--engine", choices=["auto", "vtk", "matplotlib"], default="auto")


def evenly(count, most):
    """At most `most` of the numbers 0 to count - 1, the first and the last among them."""
    return sorted({round(k) for k in np.linspace(0, count - 1, min(count, max(2, most)))})


def run(args, words):
    """Render what the command line asks for."""
    if args.dump is not None and Path(args.dump).is_dir():
        args.dump, args.data = find_run(args.dump, args.data)
    if args.movie and not args.dump:
        args.movie = None    # a data file is one frame
    universe = load_run(args, "all" if args.movie else args.frame)
    book = AtomBook(universe)
    count = len(universe.trajectory)
    frames = chosen_frames(args.frame, count)
    output = Path(args.output)
    if args.section:
        run_sections(args, universe, book, frames, output)
        return
    universe.trajectory[frames[-1]]
    decide(args, universe, book)
    moving = evenly(count, args.frames) if args.movie else []
    pictures = {}
    for frame in tqdm(sorted({*frames, *moving}), desc="reading", disable=None if count > 1 else
                      True, leave=False):
        universe.trajectory[frame]
        with nothing_to_draw(frame not in frames):
            pictures[frame] = chosen_picture(args, universe, book)
    if args.limits is None and len(frames) > 1:
        one_scale([pictures[f] for f in frames], args.cmap)
    options = dict(view=args.view, edges=args.edges, opacity=chosen_opacity(args), cmap=args.cmap)
    names = [numbered(output, args.frame, frame) for frame in frames]
    window = window_of([pictures[f] for f in frames], args.view, args.size)
    engine = draw_all([pictures[f] for f in frames], names, args.engine, window=window, **options)
    if len(frames) == 1:
        print(f"wrote {names[0]} ({engine}, {pictures[frames[0]].title}, frame {frames[0]} of "
              f"{count}, color {args.color})")
    else:
        print(f"wrote {len(frames)} pictures {output.with_stem(output.stem + '.NNNNN')}")
    if len(pictures) > 1 and args.movie:
        draw_movie([pictures[f] for f in moving if f in pictures], args, engine, options)


@contextlib.contextmanager
def nothing_to_draw(allowed):
    """A frame without cells is no error if `allowed`: it is left out."""
    try:
        yield
    except ValueError:
        if not allowed:
            raise


def draw_movie(pictures, args, engine, options):
    """Draw `pictures`, all in one window, and make a movie of them."""
    from .movie import make_movie

    if engine == "matplotlib":
        pictures = [pictures[k] for k in evenly(len(pictures), SLOW_FRAMES)]
    if args.limits is None:
        one_scale(pictures, args.cmap)
    size = 2 * max(50, args.size // 4)
    window = window_of(pictures, args.view, size, square=False)
    with tempfile.TemporaryDirectory(prefix="dcm-movie.") as folder:
        names = [Path(folder) / f"{n:05d}.png" for n in range(len(pictures))]
        draw_all(pictures, names, engine, window=window, **options)
        make_movie([str(n) for n in names], args.movie, fps=max(4.0, len(names) / 8.0))
    size = Path(args.movie).stat().st_size / 2**20
    print(f"wrote {args.movie}: {len(pictures)} frames, {size:.1f} MB")


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
