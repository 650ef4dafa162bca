"""Sections: cells of one frame cut by a plane, with the regions of their surface and the lumen.

Drawn flat with matplotlib, since in a planar tissue the tops of the cells hide what is between
them.
"""
from dataclasses import dataclass, field

import numpy as np

from .lumen import cut, in_plane, lumen_faces
from .mesh import Mesh
from .topology import REGION_NAMES

# pale, so that the outlines tell
TYPE_COLORS = ["#cfe3dc", "#f6d6a8", "#d9d2e9", "#e9dcc9", "#f4cccc", "#d0e0f0", "#e6e6e6",
               "#fde2ec", "#dfe8c5", "#e2d6cd"]
REGION_COLORS = {"lateral": "#8a8f94", "polar": "#4c78a8", "apical": "#e03131",
                 "junction": "#f0a202", "basal": "#2b8a3e", "?": "#000000"}
LUMEN, WALL, TRACER = "#8fd3f4", "#0b5fa5", "#a61e4d"


@dataclass
class Section:
    """What to draw, in the two coordinates across the plane, um. cells: list of (polygon (k, 2),
    type); lines: list of (segments (k, 2, 2), region name); circles: list of (center (2,), radius,
    type); lumens: list of polygons (k, 2); walls: (k, 2, 2) segments of marked faces; arrows: (a,
    4), center and apical vector; dots: (t, 2) tracers; title."""

    cells: list = field(default_factory=list)
    lines: list = field(default_factory=list)
    circles: list = field(default_factory=list)
    lumens: list = field(default_factory=list)
    walls: np.ndarray = field(default_factory=lambda: np.zeros((0, 2, 2)))
    arrows: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    dots: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    title: str = ""

    def window(self, margin=4.0):
        """(x low, x high, y low, y high) of a square around the deformable cells, um."""
        points = [p for p, _ in self.cells] or [c[None, :] for c, _, _ in self.circles]
        if not points:
            raise ValueError("the plane of --section meets no cell: give another position")
        points = np.concatenate(points)
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        half = 0.5 * np.ptp(points, axis=0).max() + margin
        return (middle[0] - half, middle[0] + half, middle[1] - half, middle[1] + half)


def chain(segments, gap=np.inf):
    """Polygons, a list of (k, 2), that oriented segments (n, 2, 2) make: the end of each is joined
    to the nearest beginning that is left, if it is within `gap`, um."""
    left = np.ones(len(segments), dtype=bool)
    found = []
    while left.any():
        now = np.flatnonzero(left)[0]
        loop = []
        while True:
            left[now] = False
            loop += [segments[now, 0], segments[now, 1]]
            if not left.any():
                break
            rest = np.flatnonzero(left)
            away = np.linalg.norm(segments[rest, 0] - segments[now, 1], axis=1)
            if away.min() > gap:
                break
            now = rest[away.argmin()]
        found.append(np.array(loop))
    return found


def make_section(universe, axis, at=0.0, book=None, mark="mark", thickness=1.5):
    """Section of the current frame by the plane x[axis] = at, um. thickness: tracers this near the
    plane are drawn."""
    from .frame_atoms import AtomBook

    book = book or AtomBook(universe)
    ts, atoms = universe.trajectory.ts, book.frame()
    u, v = flat = in_plane(axis)
    section = Section(title=f"{ts.time / 3600.0:.2f} h" if ts.time >= 3600.0
                      else f"{ts.time / 60.0:.0f} min")
    spheres = atoms.spheres()
    for slot, radius in zip(spheres, atoms.sphere_radii(spheres)):
        depth = atoms.xyz[slot, axis] - at
        if radius > abs(depth):
            section.circles.append((atoms.xyz[slot][list(flat)], np.sqrt(radius**2 - depth**2),
                                    str(atoms.type[slot])))
    mesh = Mesh(atoms)
    if len(mesh.faces):
        corners = mesh.corners + mesh.origin[mesh.cell][:, None, :]
        rows, ends = cut(corners, axis, at)
        ends = ends[:, :, list(flat)]
        for cell in np.unique(mesh.cell[rows]):
            own = ends[mesh.cell[rows] == cell]
            for loop in chain(own, 1e-6):
                section.cells.append((loop, str(mesh.types[cell])))
        region = atoms.region[mesh.faces[rows]]
        for number in np.unique(region):
            name = REGION_NAMES.get(int(number), "?")
            section.lines.append((ends[region == number], name))
        if mark in ts.data:
            number = lumen_faces(universe, mesh, book, mark)
            section.walls = ends[number[rows] >= 0]
            for n in range(number.max(initial=-1) + 1):
                own = ends[number[rows] == n]
                if len(own) > 2:
                    section.lumens += chain(own)
        data, centers = ts.data, mesh.centers[mesh.centers >= 0]
        if all(f"a{c}" in data for c in "xyz"):
            vectors = np.stack([data[f"a{'xyz'[k]}"][centers] for k in flat], axis=1).astype(float)
            some = np.nan_to_num(np.linalg.norm(vectors, axis=1)) > 0.0
            section.arrows = np.hstack([atoms.xyz[centers][:, list(flat)], vectors])[some]
    tracers = atoms.xyz[atoms.tracers()]
    section.dots = tracers[np.abs(tracers[:, axis] - at) < thickness][:, list(flat)]
    return section


def draw_section(section, output, size=1000, window=None, names=None, note=None):
    """Draw into an image file. window: see Section.window(); names: type -> name for the legend;
    note: second line of the title."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import LineCollection, PatchCollection, PolyCollection
    from matplotlib.lines import Line2D
    from matplotlib.patches import Circle, Patch

    names = names or {}
    x0, x1, y0, y1 = window or section.window()
    types = sorted({t for _, t in section.cells} | {t for *_, t in section.circles} | set(names),
                   key=lambda t: (len(t), t))
    called = {t: names.get(t, f"type {t}") for t in types}    # types of one name look alike
    order = list(dict.fromkeys(called.values()))
    color = {t: TYPE_COLORS[order.index(called[t]) % len(TYPE_COLORS)] for t in types}
    figure = pyplot.figure(figsize=(size / 100, size / 100), dpi=100)
    axes = figure.add_axes((0.0, 0.0, 1.0, 0.94))
    point = 0.94 * size / 100 * 72 / (y1 - y0)    # points per um
    thin, thick = max(0.5, 0.12 * point), max(1.0, 0.3 * point)
    if section.circles:
        patches = [Circle(c, r) for c, r, _ in section.circles]
        axes.add_collection(PatchCollection(patches, facecolors=[
            color[t] for *_, t in section.circles], edgecolors="#b5b5b5", linewidths=thin,
            alpha=0.6))
    if section.cells:
        axes.add_collection(PolyCollection([p for p, _ in section.cells], facecolors=[
            color[t] for _, t in section.cells], edgecolors="none"))
    if section.lumens:
        axes.add_collection(PolyCollection(section.lumens, facecolors=LUMEN, edgecolors="none"))
    handles = []
    if len(section.walls):
        axes.add_collection(LineCollection(section.walls, colors=WALL, linewidths=2.6 * thick,
                                           capstyle="round"))
    lines = sorted(section.lines, key=lambda one: one[1] != "lateral")
    for segments, name in lines:
        axes.add_collection(LineCollection(segments, colors=REGION_COLORS[name], linewidths=(
            0.6 * thick if name == "lateral" else thick), capstyle="round"))
        handles.append(Line2D([], [], color=REGION_COLORS[name], lw=4, label=name))
    if len(section.walls):
        handles.append(Line2D([], [], color=WALL, lw=7, label="wall of the lumen (marked)"))
        handles.append(Patch(color=LUMEN, label="lumen"))
    if len(section.dots):
        axes.scatter(*section.dots.T, s=(0.25 * point) ** 2 + 1.0, c=TRACER, lw=0)
        handles.append(Line2D([], [], color=TRACER, marker="o", lw=0, label="tracers"))
    if len(section.arrows):
        axes.quiver(*section.arrows.T, angles="xy", scale_units="xy", scale=0.4, width=0.003,
                    color="#333333", zorder=5)
        handles.append(Line2D([], [], color="#333333", marker=r"$\rightarrow$", ms=12, lw=0,
                              label="apical vector"))
    shown = {t for _, t in section.cells} | {t for *_, t in section.circles}
    colors = {called[t]: color[t] for t in types if t in shown}
    handles = [Patch(facecolor=c, edgecolor="#b5b5b5", label=name)
               for name, c in colors.items()] + handles
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
    axes.set_axis_off()
    bar = 10.0 if x1 - x0 > 25.0 else 2.0
    left, low = x0 + 0.03 * (x1 - x0), y0 + 0.03 * (y1 - y0)
    axes.plot([left, left + bar], [low, low], color="k", lw=3)
    axes.text(left + 0.5 * bar, low + 0.008 * (y1 - y0), f"{bar:g} um", ha="center", va="bottom",
              fontsize=size / 70)
    figure.text(0.03, 0.985, section.title + (f"   {note}" if note else ""), va="top",
                fontsize=size / 50)
    if handles:
        axes.legend(handles=handles, loc="upper right", fontsize=size / 90, framealpha=0.85)
    figure.savefig(output)
    pyplot.close(figure)
