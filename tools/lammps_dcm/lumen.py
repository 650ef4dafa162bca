"""Lumens: what the marked faces of cells enclose, in every frame.

A lumen is a connected set of marked faces (column `mark` of the dump, from `compute dcm/face`);
its wall is seen from inside, so its outward normals are the reversed ones of the faces. In a
planar tissue it is an open tube; then its section in a plane says how large it is.
"""
import sys

import numpy as np

from .analysis import MeshAnalysis
from .inputs import add_input, load_run
from .mesh import minimum_image
from .table import write_columns
from .triangles import triangle_vectors

AXES = "xyz"
COLUMNS = ("volume", "wall", "section", "closure", "cells", "circularity", "x", "y", "z",
           "covered")


# ---------------------------------------------------------------------- geometry

def linked(corners, vertices, cell, reach=1.2):
    """Components (m,) of faces, numbered from 0: two are linked if they share an edge, or belong
    to different cells, come within `reach` mean edges of each other (centroids) and neither is
    behind the other.

    corners: (m, 3, 3), um; vertices: (m, 3), any names of nodes; cell: (m,).
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    m = len(corners)
    if not m:
        return np.zeros(0, dtype=int)
    edges = np.sort(np.stack([vertices, np.roll(vertices, -1, axis=1)], axis=2).reshape(-1, 2))
    face = np.repeat(np.arange(m), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    same = (edges[order][1:] == edges[order][:-1]).all(axis=1)
    pairs = [np.stack([face[order][:-1][same], face[order][1:][same]], axis=1)]
    middle = corners.mean(axis=1)
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean()
    near = cKDTree(middle).query_pairs(reach * edge, output_type="ndarray").reshape(-1, 2)
    near = near[cell[near[:, 0]] != cell[near[:, 1]]]
    normal = triangle_vectors(corners)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    d = middle[near[:, 1]] - middle[near[:, 0]]
    before = np.einsum("ij,ij->i", d, normal[near[:, 0]]) > -0.3 * edge
    before &= np.einsum("ij,ij->i", d, normal[near[:, 1]]) < 0.3 * edge
    pairs = np.concatenate([*pairs, near[before]])
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(m, m))
    return connected_components(graph, directed=False)[1]


def cut(corners, axis, at):
    """Where triangles (m, 3, 3) meet the plane `axis` = `at`: rows (k,) of those that do, and
    their oriented segments (k, 2, 3), um, the outside of the surface to their left as seen from
    the positive side of the axis.
    """
    height = corners[:, :, axis] - at
    up = height >= 0.0
    rows = np.flatnonzero(up.any(axis=1) & ~up.all(axis=1))
    ends = np.zeros((len(rows), 2, 3))
    here = np.arange(len(rows))
    for k in range(3):
        u, v = corners[rows, k], corners[rows, (k + 1) % 3]
        a, b = height[rows, k], height[rows, (k + 1) % 3]
        crosses = up[rows, k] != up[rows, (k + 1) % 3]
        t = np.where(crosses, a / np.where(crosses, a - b, 1.0), 0.0)
        point = u + t[:, None] * (v - u)
        rising = crosses & (b >= 0.0)    # the segment begins where an edge comes up
        ends[here[rising], 0] = point[rising]
        falling = crosses & (a >= 0.0)
        ends[here[falling], 1] = point[falling]
    return rows, ends


def in_plane(axis):
    """The two other axes, so that they and `axis` are right-handed."""
    return (axis + 1) % 3, (axis + 2) % 3


def clipped(corners, axis, low, high):
    """Triangles (k, 3, 3) of the parts of `corners` (m, 3, 3) with low <= x[axis] <= high."""
    inside = (corners[:, :, axis] >= low).all(axis=1) & (corners[:, :, axis] <= high).all(axis=1)
    outside = (corners[:, :, axis] < low).all(axis=1) | (corners[:, :, axis] > high).all(axis=1)
    pieces = [corners[inside]]
    for polygon in corners[~inside & ~outside]:
        for sign, bound in ((1.0, low), (-1.0, high)):
            kept = []
            for p, q in zip(polygon, np.roll(polygon, -1, axis=0)):
                a, b = sign * (p[axis] - bound), sign * (q[axis] - bound)
                if a >= 0.0:
                    kept.append(p)
                if (a >= 0.0) != (b >= 0.0):
                    kept.append(p + a / (a - b) * (q - p))
            polygon = np.array(kept).reshape(-1, 3)
        fan = [[polygon[0], polygon[k - 1], polygon[k]] for k in range(2, len(polygon))]
        pieces.append(np.array(fan).reshape(-1, 3, 3))
    return np.concatenate(pieces)


def solid_angle(corners):
    """Part of all directions, seen from the origin, that triangles (m, 3, 3) cover: (m,), negative
    for those that show the origin their front (van Oosterom and Strackee 1983)."""
    length = np.linalg.norm(corners, axis=2)
    below = length.prod(axis=1)
    for k in range(3):
        below += length[:, k] * (corners[:, k - 1] * corners[:, k - 2]).sum(axis=1)
    return np.arctan2(np.linalg.det(corners), below) / (2.0 * np.pi)


def measure(corners, cell, plane=None, slab=None):
    """Measures of one lumen with wall `corners` (m, 3, 3), um, of the cells `cell` (m,).

    plane: (axis, position) of the section, um. slab: (low, high), um, along the plane's axis: the
    lumen is a tube open at both ends, of which volume and wall are those between them; without it,
    it is closed all around. Returns a dict of
    COLUMNS: volume, um^3; wall, um^2; section, um^2, NaN without plane; closure, what is missing of
    the outline (tube) or of the wall, as a fraction; cells: how many; circularity 4 pi S / L^2 of
    the section; x, y, z: centroid of the wall; covered: part of all directions in which there is
    wall, seen from the centroid.
    """
    middle = corners.mean(axis=1)
    vectors = triangle_vectors(corners)
    area = np.linalg.norm(vectors, axis=1)
    center = (area[:, None] * middle).sum(axis=0) / area.sum()
    result = dict(cells=len(np.unique(cell)), section=np.nan, circularity=np.nan)
    result.update(zip(AXES, center))
    if plane is not None:
        axis, at = plane
        a, b = in_plane(axis)
        _, ends = cut(corners, axis, at)
        begin, end = ends[:, 0] - center, ends[:, 1] - center
        result["section"] = 0.5 * (begin[:, a] * end[:, b] - begin[:, b] * end[:, a]).sum()
        length = np.linalg.norm(end - begin, axis=1).sum()
        missing = np.linalg.norm((end - begin).sum(axis=0))
        result["circularity"] = (4.0 * np.pi * result["section"] / length**2 if length > 0.0
                                 else 0.0)
    if slab is not None:
        a, b = in_plane(plane[0])
        parts = clipped(corners, plane[0], *slab)
        vectors, middle = triangle_vectors(parts), parts.mean(axis=1)
        # of the field (x, y, 0)/2 through the wall: the open ends do not count
        arm = middle - center
        result["volume"] = -0.5 * (vectors[:, [a, b]] * arm[:, [a, b]]).sum()
        result["closure"] = missing / length if length > 0.0 else 0.0
        corners = parts
    else:
        result["volume"] = -(vectors * (middle - center)).sum() / 3.0
        result["closure"] = np.linalg.norm(vectors.sum(axis=0)) / area.sum()
    result["wall"] = np.linalg.norm(vectors, axis=1).sum()
    result["covered"] = -solid_angle(corners - center).sum()
    return result


# ---------------------------------------------------------------------- analysis

class Lumens(MeshAnalysis):
    """Lumens of every frame, the largest wall first.

    mark: dump column, positive where a face is marked; component: dump column with the number of
    the lumen of a face, from `compute dcm/lumen`; if the dump lacks it, lumens are found here.
    plane, slab: see measure(). smallest: least wall of a lumen, um^2.
    results.number: (frames,); results.lumens: per frame a list of dicts, see measure(); results.
    volume, wall, section, closure, cells, circularity, x, y, z, covered: (frames,), those of the
    largest, zeros (closure, circularity and place: NaN) where there is none.
    """

    def __init__(self, universe, mark="mark", component="lumen", plane=None, slab=None,
                 smallest=0.0, **kwargs):
        super().__init__(universe, **kwargs)
        if slab is not None and plane is None:
            raise ValueError("a slab needs a plane: its axis is the tube's")
        if slab is not None and not slab[0] < slab[1]:
            raise ValueError(f"slab {slab[0]:g} {slab[1]:g}: give the lower end first")
        self.mark, self.component = mark, component
        self.plane, self.slab, self.smallest = plane, slab, smallest

    def _prepare(self):
        super()._prepare()
        self.results.lumens = []

    def _single_frame(self):
        self.results.lumens.append(self.find(self.mesh()))

    def find(self, mesh):
        """Lumens of a Mesh as a list of dicts, each with `faces`, its rows of mesh.faces."""
        marked = marked_rows(mesh, self.mark, self._ts.data)
        if not len(marked):
            return []
        corners = unwrapped(mesh, marked)
        if self.component in self._ts.data:
            number = self._ts.data[self.component][mesh.faces[marked]]
            marked, corners = marked[number > 0], corners[number > 0]
            component = np.unique(number[number > 0], return_inverse=True)[1]
        else:
            component = linked(corners, mesh.vertices[marked], mesh.cell[marked])
        found = []
        for n in range(component.max(initial=-1) + 1):
            own = component == n
            lumen = measure(corners[own], mesh.cell[marked[own]], self.plane, self.slab)
            lumen["faces"] = marked[own]
            lumen["whole"] = np.linalg.norm(triangle_vectors(corners[own]), axis=1).sum()
            found.append(lumen)
        found.sort(key=lambda one: -one["whole"])
        return [one for one in found if one["whole"] > self.smallest]

    def _conclude(self):
        super()._conclude()
        lumens = self.results.lumens
        self.results.number = np.array([len(found) for found in lumens])
        for name in COLUMNS:
            none = np.nan if name in ("closure", "circularity", *AXES) else 0.0
            self.results[name] = np.array([found[0][name] if found else none for found in lumens])


def marked_rows(mesh, mark, data):
    """Rows of mesh.faces that are marked; data: columns of the frame."""
    if mark not in data:
        raise ValueError(f"the dump has no column {mark}: add `mark` of compute dcm/face, or name "
                         f"it with --rename COLUMN={mark}")
    return np.flatnonzero(np.nan_to_num(data[mark][mesh.faces].astype(float)) > 0.0)


def lumen_faces(universe, mesh, book, mark="mark"):
    """Number (m,) of the lumen that each face of a Mesh is at, -1: none; the largest is 0."""
    finder = Lumens(universe, mark=mark, book=book)
    finder._ts = universe.trajectory.ts
    number = np.full(len(mesh.faces), -1)
    for n, lumen in enumerate(finder.find(mesh)):
        number[lumen["faces"]] = n
    return number


def unwrapped(mesh, rows):
    """Corners (m, 3, 3), um, of faces in one image of a periodic box, that of the first."""
    data = mesh.atoms.data
    own = mesh.origin[mesh.cell[rows]]
    origin = own[0] + minimum_image(own - own[0], data["box"], data["tilt"], data["periodic"])
    return mesh.corners[rows] + origin[:, None, :]


# ---------------------------------------------------------------------- command line

def parse_plane(text):
    """(axis, position) from `z` or `z=1.5`."""
    axis, _, at = text.partition("=")
    try:
        return AXES.index(axis), float(at or 0.0)
    except ValueError:
        raise ValueError(f"plane '{text}': write x, y or z, or z=1.5 (um)") from None


def add_arguments(parser):
    """Options of `lumen`."""
    parser.epilog = ("A row per frame: number of lumens, then volume, wall, section, closure, "
                     "cells around, circularity, place and covered solid angle of the "
                     "largest.")
    add_input(parser, pressures=False)
    parser.add_argument("--plane", metavar="AXIS[=AT]", help="plane of the section, such as z")
    parser.add_argument("--slab", nargs=2, type=float, metavar=("LOW", "HIGH"), help="the lumen is "
                        "a tube along the plane's axis, marked between these (um)")
    parser.add_argument("--smallest", type=float, default=0.0, help="least wall of a lumen, um^2")
    parser.add_argument("-o", "--output", help="CSV file; by default the screen")
    parser.add_argument("--plot", help="picture of size and number of cells over time")


def plot(path, times, results, title=""):
    """Curves over the time: section (or volume) of the largest lumen, cells around it."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    section = np.isfinite(results.section).any()
    figure, (upper, lower) = pyplot.subplots(2, 1, sharex=True, figsize=(7, 5),
                                             height_ratios=(2, 1), layout="constrained")
    values = results.section if section else results.volume
    unit, scale = ("h", 3600.0) if np.max(times, initial=0.0) > 7200.0 else ("min", 60.0)
    upper.fill_between(times / scale, values, color="#7fd3f7", alpha=0.6)
    upper.plot(times / scale, values, color="#1f6fe0")
    upper.set_ylabel("area of the section, um$^2$" if section else "volume, um$^3$")
    upper.set_ylim(bottom=0.0)
    lower.step(times / scale, results.cells, where="post", color="#444444", label="cells around it")
    lower.step(times / scale, results.number, where="post", color="#e45756", label="lumens")
    lower.set_xlabel(f"time, {unit}")
    lower.legend()
    upper.set_title(title or "the largest lumen")
    figure.savefig(path, dpi=120)
    pyplot.close(figure)


def run(args, words):
    """Write the table, and the plot, that the command line asks for."""
    plane = None if args.plane is None else parse_plane(args.plane)
    if args.slab is not None and plane is None:
        raise ValueError("--slab needs --plane: its axis is the tube's")
    universe = load_run(args, "all")
    results = Lumens(universe, plane=plane, slab=args.slab, smallest=args.smallest).run(
        verbose=sys.stderr.isatty()).results
    write_columns(args.output, {"step": results.steps, "time": results.times,
                                "lumens": results.number} | {n: results[n] for n in COLUMNS})
    if args.plot:
        plot(args.plot, results.times, results)
    for name in filter(None, (args.output, args.plot)):
        print(f"wrote {name}")
