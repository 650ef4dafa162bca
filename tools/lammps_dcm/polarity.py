"""Apical and polar vectors of cells: angles of each, and how far all agree."""
import sys

import numpy as np

from .analysis import MeshAnalysis, mean_of_nodes
from .inputs import add_input, load_run
from .lumen import AXES, Lumens, parse_plane
from .mesh import minimum_image
from .table import cell_columns, write_columns

APICAL, POLAR = ("ax", "ay", "az"), ("px", "py", "pz")
DEGREES = 180.0 / np.pi


def angle(u, v):
    """Angles (n,), degree, between vectors (n, 3); NaN where one is zero."""
    sine = np.linalg.norm(np.cross(u, v), axis=1)
    cosine = np.einsum("ij,ij->i", u, v)
    some = (np.linalg.norm(u, axis=1) > 0.0) & (np.linalg.norm(v, axis=1) > 0.0)
    return np.where(some, DEGREES * np.arctan2(sine, cosine), np.nan)


def order(vectors):
    """Order of unit vectors (n, 3), NaN rows left out: polar |mean|, and nematic, the largest
    eigenvalue of the mean of (3 u u - 1)/2: 1 all along one line, 0 in all directions."""
    u = vectors[np.isfinite(vectors).all(axis=1)]
    if not len(u):
        return np.nan, np.nan
    nematic = 1.5 * np.einsum("ni,nj->ij", u, u) / len(u) - 0.5 * np.eye(3)
    return np.linalg.norm(u.mean(axis=0)), np.linalg.eigvalsh(nematic)[-1]


class CellPolarity(MeshAnalysis):
    """Apical vector A and polar vector P of every deformable cell, from the columns ax ay az px py
    pz of its center atom (`compute dcm/cell`).

    axis: 0, 1 or 2: also the angles of A and P in the plane across this axis. lumen: dict of
    arguments of Lumens, or None: also where the largest lumen is.
    results.apical, results.polar: (frames, cells, 3), NaN for cells without; results.between:
    angle of A and P, degree; results.apical_angle, results.polar_angle: in the plane, -180 to 180;
    results.to_lumen: angle between A and the direction from the cell's center to the middle of the
    largest lumen; results.polar_order, results.nematic_order, results.lumen_order: (frames,), of
    all apical vectors, see order(); lumen_order: mean cosine of to_lumen.
    """

    def __init__(self, universe, axis=None, lumen=None, **kwargs):
        super().__init__(universe, **kwargs)
        self.axis = axis
        self.lumens = None if lumen is None else Lumens(universe, book=self.book, **lumen)

    def _prepare(self):
        super()._prepare()
        for name in ("polar_order", "nematic_order", "lumen_order"):
            self.results[name] = np.full(self.n_frames, np.nan)

    def _vectors(self, mesh, names):
        data = self._ts.data
        missing = [name for name in names if name not in data]
        if missing:
            raise ValueError(f"the dump has no column {missing[0]}: add {' '.join(names)} of "
                             "compute dcm/cell, or name them with --rename COLUMN=NAME,...")
        values = np.stack([data[name][mesh.centers] for name in names], axis=1).astype(float)
        length = np.linalg.norm(values, axis=1)
        good = (mesh.centers >= 0) & (length > 0.0)
        return np.where(good[:, None], values / np.where(good, length, 1.0)[:, None], np.nan)

    def _single_frame(self):
        mesh, k = self.mesh(), self._frame_index
        apical, polar = self._vectors(mesh, APICAL), self._vectors(mesh, POLAR)
        put = dict(apical=apical, polar=polar, between=angle(apical, polar))
        if self.axis is not None:
            a, b = (self.axis + 1) % 3, (self.axis + 2) % 3
            put["apical_angle"] = DEGREES * np.arctan2(apical[:, b], apical[:, a])
            put["polar_angle"] = DEGREES * np.arctan2(polar[:, b], polar[:, a])
        if self.lumens is not None:
            self.lumens._ts = self._ts
            found = self.lumens.find(mesh)
            to = np.full(len(mesh.ids), np.nan)
            if found:
                middle = np.array([found[0][name] for name in AXES])
                center, data = mesh.origin + mean_of_nodes(mesh), self._ts.data
                d = minimum_image(middle - center, data["box"], data["tilt"], data["periodic"])
                if self.axis is not None:
                    d[:, self.axis] = 0.0
                to = angle(apical, d)
                known = np.isfinite(to)
                if known.any():
                    self.results.lumen_order[k] = np.cos(to[known] / DEGREES).mean()
            put["to_lumen"] = to
        self._put(**put)
        self.results.polar_order[k], self.results.nematic_order[k] = order(apical)


# ---------------------------------------------------------------------- command line

def add_arguments(parser):
    """Options of `polarity`."""
    parser.epilog = ("A row per cell that has an apical vector and frame: A, P, the angle between "
                     "them, their angles in the plane (with --plane), and the angle between A and "
                     "the direction to the largest lumen (with --lumen), all in degree. --order: a "
                     "row per frame with the order of all apical vectors.")
    add_input(parser, pressures=False)
    parser.add_argument("--plane", metavar="AXIS", help="planar tissue: its normal, such as z")
    parser.add_argument("--lumen", action="store_true", help="the dump has the column mark: angles "
                        "to the largest lumen")
    parser.add_argument("-o", "--output", help="CSV file; by default the screen")
    parser.add_argument("--order", help="CSV file of the order parameters")


def run(args, words):
    """Write the tables that the command line asks for."""
    plane = None if args.plane is None else parse_plane(args.plane)
    universe = load_run(args, "all")
    results = CellPolarity(universe, None if plane is None else plane[0],
                           dict(plane=plane) if args.lumen else None).run(
        verbose=sys.stderr.isatty()).results
    for names, vector in ((APICAL, "apical"), (POLAR, "polar")):
        for n, name in enumerate(names):
            results[name] = results[vector][:, :, n]
    results.present &= np.isfinite(results.ax)
    write_columns(args.output, cell_columns(results, (
        *APICAL, *POLAR, "between", "apical_angle", "polar_angle", "to_lumen")))
    if args.order:
        write_columns(args.order, {name: results[name] for name in (
            "steps", "times", "polar_order", "nematic_order", "lumen_order")})
    for name in filter(None, (args.output, args.order)):
        print(f"wrote {name}")
