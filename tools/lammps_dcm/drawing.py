"""Drawing of pictures of a frame, without a display: VTK (through pyvista) where it can, elsewhere
matplotlib, slower and plainer.

The scene fills the picture, seen without perspective, so that a scale bar holds everywhere; above
it is room for time and legend, below it for scale bar and color scale.
"""
import math
import multiprocessing
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .triangles import triangle_vectors

VIEWS = {"xy": (0, 0, 1), "xz": (0, -1, 0), "yz": (1, 0, 0), "iso": (1, -1, 0.8)}
UP = {"xy": (0, 1, 0), "xz": (0, 0, 1), "yz": (0, 0, 1), "iso": (0, 0, 1)}
MARGIN = 0.03    # of the picture, free at its sides
LINE = 0.022    # height of a line of text, of the picture
SMALL = 800    # pixel: pictures up to this width, those of movies, are drawn faster and coarser


@dataclass
class Picture:
    """What to draw. points (n, 3) um and triangles (m, 3) rows of points: the surfaces; centers
    (s, 3), radii (s,) um: spheres; dots (t, 3): tracers; face_rgb (m, 3), sphere_rgb (s, 3);
    bar: None or (title, low, high) of a color scale; legend: dict of label -> color; title;
    solid (m,): faces of a lumen, drawn opaque where cells are translucent; values: None, or the
    numbers (m,), (s,) that the scale colors."""

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
    values: tuple = None


def axes_of(view):
    """Unit vectors (3, 3) to the right, up and toward the eye."""
    eye = np.array(VIEWS[view], dtype=float) / np.linalg.norm(VIEWS[view])
    right = np.cross(UP[view], eye)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right), eye])


def extent(picture, view):
    """Lowest and highest coordinates (2, 3), um, of all that is drawn, along axes_of(view)."""
    axes = axes_of(view)
    low, high = [np.full(3, np.inf)], [np.full(3, -np.inf)]
    for points, radii in ((picture.points, 0.0), (picture.centers, picture.radii[:, None]),
                          (picture.dots, 0.0)):
        if len(points):
            along = points @ axes.T
            low.append((along - radii).min(axis=0))
            high.append((along + radii).max(axis=0))
    return np.array([np.min(low, axis=0), np.max(high, axis=0)])


@dataclass
class Window:
    """What a picture shows: middle (3,), um, in the coordinates of axes_of(view); um_per_pixel;
    width and height, pixel."""

    middle: np.ndarray
    um_per_pixel: float
    width: int
    height: int


def fit(extents, size, lines=1, bar=False, square=True):
    """Window that holds all `extents`. size: the larger side, pixel; lines: of text above the
    scene; bar: whether there is a color scale below it; square: else as high as it needs."""
    low, high = np.min([e[0] for e in extents], axis=0), np.max([e[1] for e in extents], axis=0)
    wide, tall = np.maximum((high - low)[:2], 1e-9)
    above, below = (0.5 + 1.3 * lines) * LINE, (6.0 if bar else 3.0) * LINE
    room = size * (1.0 - 2 * MARGIN)
    inside = size * (1.0 - above - below - 2 * MARGIN)
    scale = max(wide / room, tall / inside)
    height = size if square else min(size, round(size * (above + below + 2 * MARGIN)
                                                 + tall / scale))
    middle = 0.5 * (low + high)
    middle[1] += 0.5 * size * (above - below) * scale
    return Window(middle, scale, size, 2 * round(height / 2))


def nice_length(most):
    """The largest of 1, 2, 5 times a power of ten that is not above `most`."""
    power = 10.0 ** math.floor(math.log10(most))
    return max(f * power for f in (1, 2, 5) if f * power <= most * (1 + 1e-12))


def build_plotter(picture, view="xy", window=None, size=1200, edges=False, opacity=1.0, round_=40,
                  plotter=None):
    """Off-screen pyvista.Plotter with the surfaces, spheres and tracers of a Picture, without text;
    window: by default one that fits; round_: sides of a sphere; plotter: one to be used again, of
    the same window, which saves half of the time."""
    import pyvista

    window = window or fit([extent(picture, view)], size)
    if plotter is None:
        plotter = pyvista.Plotter(off_screen=True, window_size=(window.width, window.height))
        plotter.set_background("white")
        # smooth edges take half of the time
        plotter.render_window.SetMultiSamples(4 if window.width > SMALL else 0)
    else:
        for title in list(plotter.scalar_bars.keys()):
            plotter.remove_scalar_bar(title, render=False)
        plotter.clear_actors()
    plotter.suppress_rendering = True    # each addition to a plotter that was used would draw it
    light = dict(smooth_shading=True, ambient=0.2, diffuse=0.9, specular=0.15, specular_power=10)
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
    axes, (low, high) = axes_of(view), extent(picture, view)
    camera, focus = plotter.camera, window.middle @ axes
    far = 10.0 + 2 * np.linalg.norm(high - low)
    camera.focal_point, camera.position, camera.up = focus, focus + far * axes[2], axes[1]
    camera.parallel_scale = 0.5 * window.height * window.um_per_pixel
    plotter.renderer.ResetCameraClippingRange()
    return plotter


def add_scale_bar(plotter, window):
    """A bar in the lower left corner, of a round number of um."""
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkRenderingCore import vtkActor2D, vtkPolyDataMapper2D

    length = nice_length(0.25 * window.width * window.um_per_pixel)
    unit = LINE * window.width
    x, y, wide, thick = unit, unit, length / window.um_per_pixel, max(2.0, 0.2 * unit)
    points, cells, data = vtkPoints(), vtkCellArray(), vtkPolyData()
    cells.InsertNextCell(4)
    for k, (px, py) in enumerate(((0, 0), (wide, 0), (wide, thick), (0, thick))):
        points.InsertNextPoint(x + px, y + py, 0.0)
        cells.InsertCellPoint(k)
    data.SetPoints(points)
    data.SetPolys(cells)
    mapper, actor = vtkPolyDataMapper2D(), vtkActor2D()
    mapper.SetInputData(data)
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.0, 0.0, 0.0)
    plotter.renderer.AddActor(actor)
    plotter.add_text(f"{length:g} um", position=(x, y + 1.6 * thick), color="black",
                     font_size=font_of(window))


def font_of(window):
    """Size of text: pyvista draws a line of about twice as many pixels."""
    return max(5, round(0.46 * LINE * window.width))


def draw_vtk(picture, output, view="xy", window=None, size=1200, edges=False, opacity=1.0,
             cmap="viridis", plotter=None):
    """Draw with VTK, off screen, into a PNG file; returns the plotter, to be used again."""
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)    # it complains of a missing display
    import pyvista

    window = window or window_of([picture], view, size)
    round_ = 40 if window.width > SMALL else 20
    plotter = build_plotter(picture, view, window, size, edges, opacity, round_, plotter)
    unit = LINE * window.width
    if picture.bar:
        title, low, high = picture.bar
        plotter.add_mesh(pyvista.PolyData(window.middle[None, :] @ axes_of(view)), scalars=[low],
                         clim=(low, high), cmap=cmap, opacity=0.0, show_scalar_bar=True,
                         reset_camera=False, scalar_bar_args=dict(
                             title=" ", color="black", n_labels=3, fmt="%.3g",
                             position_x=0.5, position_y=0.3 * unit / window.height, width=0.4,
                             height=3.4 * unit / window.height, title_font_size=1,
                             label_font_size=round(0.9 * unit)))
        plotter.add_text(title, position=(0.5 * window.width, 4.0 * unit), color="black",
                         font_size=font_of(window))
    for n, (label, rgb) in enumerate([(picture.title, "black"), *picture.legend.items()]):
        plotter.add_text(label, position=(unit, window.height - (1.6 + 1.3 * n) * unit), color=rgb,
                         font_size=font_of(window))
    add_scale_bar(plotter, window)
    plotter.suppress_rendering = False
    plotter.render()
    plotter.screenshot(str(output))
    return plotter


def window_of(pictures, view, size, square=True):
    """Window that all pictures fit in, with their text."""
    return fit([extent(p, view) for p in pictures], size, 1 + max(len(p.legend) for p in pictures),
               any(p.bar for p in pictures), square)


def draw_matplotlib(picture, output, view="xy", window=None, size=1200, edges=False, opacity=1.0,
                    cmap="viridis"):
    """Draw with matplotlib into an image file; spheres are coarse, faces flat, and what is seen is
    always the whole scene."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import PolyCollection

    window = window or window_of([picture], view, size)
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 17), np.linspace(0, np.pi, 9))
    grid = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=-1)
    quads = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2)
    quads = quads.reshape(-1, 4, 3)
    axes = axes_of(view)
    corners = picture.points[picture.triangles]
    normals = triangle_vectors(corners) if len(corners) else np.zeros((0, 3))
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    polygons, colors = list(corners @ axes.T), [picture.face_rgb * shade(normals @ axes[2])]
    dark = shade(quads.mean(axis=1) @ axes[2])
    for center, radius, rgb in zip(picture.centers, picture.radii, picture.sphere_rgb):
        polygons += list((center + radius * quads) @ axes.T)
        colors.append(rgb * dark)
    alpha = np.full(len(polygons), opacity)
    alpha[:len(corners)][picture.solid] = 1.0
    colors = np.column_stack([np.vstack(colors), alpha])
    order = np.argsort([p[:, 2].mean() for p in polygons], kind="stable")    # the nearest last
    figure = pyplot.figure(figsize=(window.width / 120, window.height / 120), dpi=120)
    plane = figure.add_axes((0, 0, 1, 1))
    plane.add_collection(PolyCollection(
        [polygons[k][:, :2] for k in order], facecolors=colors[order], linewidths=0.2,
        edgecolors="k" if edges else "none", antialiased=bool(edges)))
    if len(picture.dots):
        plane.scatter(*(picture.dots @ axes.T)[:, :2].T, s=2, c="crimson", zorder=3)
    half = 0.5 * window.um_per_pixel * np.array([window.width, window.height])
    plane.set(xlim=(window.middle[0] - half[0], window.middle[0] + half[0]),
              ylim=(window.middle[1] - half[1], window.middle[1] + half[1]))
    plane.set_axis_off()
    unit, text = LINE * window.width, 0.6 * LINE * window.width
    for n, (label, rgb) in enumerate([(picture.title, "black"), *picture.legend.items()]):
        figure.text(LINE, 1 - (1.6 + 1.3 * n) * unit / window.height, label, color=rgb,
                    fontsize=text)
    if picture.bar:
        title, low, high = picture.bar
        place = figure.add_axes((0.52, 2.4 * unit / window.height, 0.44, unit / window.height))
        norm = matplotlib.colors.Normalize(low, high)
        bar = figure.colorbar(matplotlib.cm.ScalarMappable(norm, cmap), cax=place,
                              orientation="horizontal")
        bar.set_label(title, fontsize=text)
        bar.ax.tick_params(labelsize=0.9 * text)
    length = nice_length(0.25 * window.width * window.um_per_pixel)
    wide = length / window.um_per_pixel / window.width
    figure.add_artist(matplotlib.patches.Rectangle(
        (LINE, unit / window.height), wide, 0.2 * unit / window.height, color="black"))
    figure.text(LINE, 1.4 * unit / window.height, f"{length:g} um", fontsize=text)
    figure.savefig(output)
    pyplot.close(figure)


def shade(cosine):
    """Brightness (n, 1) of surfaces whose normal has `cosine` (n,) with the line of sight."""
    return (0.45 + 0.55 * np.clip(np.abs(cosine), 0.0, 1.0))[:, None]


def draw_all(pictures, outputs, engine="auto", **options):
    """Draw pictures into files with engine `vtk`, `matplotlib` or `auto` (VTK, if that fails
    matplotlib). They show the same window unless `options` names another.

    VTK runs in a child process: without a usable OpenGL it may end the process it runs in.
    Returns the name of the engine that drew.
    """
    if engine != "matplotlib":
        child = multiprocessing.get_context("fork").Process(
            target=_child, args=(pictures, outputs, options))
        child.start()
        child.join()
        if child.exitcode == 0 and all(Path(output).exists() for output in outputs):
            return "vtk"
        if engine == "vtk":
            raise ValueError("VTK could not draw here: install pyvista and a software OpenGL "
                             "(Debian: libegl1 libgl1-mesa-dri), or use --engine matplotlib")
        print("VTK could not draw here, matplotlib does", file=sys.stderr)
    for picture, output in zip(pictures, outputs):
        draw_matplotlib(picture, output, **options)
    return "matplotlib"


def _child(pictures, outputs, options):
    plotter = None
    try:
        for picture, output in zip(pictures, outputs):
            plotter = draw_vtk(picture, output, **options, plotter=plotter)
    except Exception as err:
        print(f"VTK: {type(err).__name__}: {err}", file=sys.stderr)
        sys.exit(1)
