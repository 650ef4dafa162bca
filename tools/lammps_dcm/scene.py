"""Build start configurations: tables of cells for the LAMMPS command `create_cells table FILE`.

A cells table is text, one cell a line, `#` starts a comment:

    typename kind x y z radius

`kind` is `dcm` (deformable cell: center, nodes, faces) or `cbm` (centre-based cell: one sphere);
lengths are in um. Every builder here returns a list of `Cell` and is deterministic: the same
arguments, seed included, give the same table.
"""
import argparse
import math
import shlex
from dataclasses import dataclass, replace

import numpy as np
from tqdm import tqdm

from . import labels
from .text import read_text, write_text

KINDS = ("dcm", "cbm")


class SceneError(ValueError):
    """A scene cannot be built from the given numbers; the message names the option to change."""


@dataclass(frozen=True)
class Cell:
    """One biological cell: type name, kind (`dcm` or `cbm`), centre (um) and radius (um)."""

    type: str
    kind: str
    x: float
    y: float
    z: float
    radius: float


# ---------------------------------------------------------------------- geometry

def ring_count(rho, radius, gap):
    """Most cells of `radius` that fit on a circle of radius `rho` (um), `gap` apart."""
    s = radius * (1.0 + gap) / rho
    if s > 1.0:
        raise SceneError(f"a circle of radius {rho:g} um is too small for two cells of radius "
                         f"{radius:g} um: take a larger vein or smaller cells")
    return int(math.floor(math.pi / math.asin(s) + 1e-9))


def settle(x, radius, fixed, gap=0.0, steps=3000):
    """Close the voids between circles: pull cells to the axis, let them push each other apart.

    Overdamped in the plane: unit stiffness per overlap, plus an inward pull on every free cell
    that fades to zero over the first two thirds of `steps`; it stops at the first step after
    that where no overlap exceeds 1e-4 of a diameter. x: (n, 2), um; radius: (n,), um; fixed:
    (n,) bool; gap: as everywhere. Returns new positions (n, 2), um.
    """
    from scipy.spatial import cKDTree

    x = x.copy()
    size = radius * (1.0 + gap)
    free = ~fixed[:, None]
    skin = 0.5 * size.min()
    listed = None
    fade = 2 * steps // 3
    for step in tqdm(range(steps), desc="settling", leave=False, disable=None):
        if listed is None or np.abs(x - listed).max() > skin / 3.0:
            i, j = cKDTree(x).query_pairs(2.0 * size.max() + skin, output_type="ndarray").T
            listed = x.copy()
        d = x[j] - x[i]
        r = np.linalg.norm(d, axis=1)
        overlap = np.maximum(size[i] + size[j] - r, 0.0)
        if step > fade and (overlap / (size[i] + size[j])).max() < 1e-4:
            break
        push = (overlap / r)[:, None] * d
        move = np.zeros_like(x)
        np.add.at(move, j, push)
        np.add.at(move, i, -push)
        pull = 0.01 * size.mean() * max(0.0, 1.0 - step / fade)
        move -= pull * x / np.linalg.norm(x, axis=1)[:, None]
        x += free * 0.2 * move
    return x


def jittered(cells, jitter, seed, planar=True):
    """Move every cell by a uniform random step of at most `jitter` x its radius per axis."""
    if jitter < 0.0:
        raise SceneError(f"--jitter is {jitter:g}: it must be zero or positive")
    if jitter == 0.0:
        return cells
    step = np.random.default_rng(seed).uniform(-1.0, 1.0, (len(cells), 3)) * jitter
    if planar:
        step[:, 2] = 0.0
    return [replace(c, x=c.x + s[0] * c.radius, y=c.y + s[1] * c.radius, z=c.z + s[2] * c.radius)
            for c, s in zip(cells, step)]


def worst_overlap(cells):
    """Largest (R_i + R_j - d) / (R_i + R_j) over all pairs; negative if nothing touches."""
    from scipy.spatial import cKDTree

    if len(cells) < 2:
        return -math.inf
    x = np.array([[c.x, c.y, c.z] for c in cells])
    r = np.array([c.radius for c in cells])
    pairs = cKDTree(x).query_pairs(2.5 * r.max(), output_type="ndarray")
    if not len(pairs):
        return -math.inf
    i, j = pairs.T
    return float((1.0 - np.linalg.norm(x[i] - x[j], axis=1) / (r[i] + r[j])).max())


# ---------------------------------------------------------------------- scenes

DUCT_SIZES = {
    "quick": dict(endothelium=7, rings=3, dcm_rings=1, sector=360.0),
    "full": dict(endothelium=16, rings=10, dcm_rings=3, sector=140.0),
    # for a lumen: a patch of deformable cells, three rings deep, in which it can open
    "lumen": dict(endothelium=7, rings=4, dcm_rings=3, sector=82.0, cholangiocytes=3),
    "lumen-full": dict(endothelium=16, rings=10, dcm_rings=3, sector=140.0, cholangiocytes=5),
}


def duct(size="quick", endothelium=None, rings=None, dcm_rings=None, sector=None, radius=6.0,
         vein_radius=4.0, mesenchyme_radius=4.0, mesenchyme_rings=1, gap=0.0, settled=True,
         cholangiocytes=None, jitter=0.0, seed=1):
    """Portal vein in cross-section: concentric circles in the plane z = 0 (S1 "Initialization").

    From the axis outward: one ring of `endothelium` cells that touch each other, mesenchyme,
    `rings` rings of hepatoblasts, every ring holding as many cells as fit on its circle.
    Hepatoblasts of the first `dcm_rings` rings whose angle lies within `sector` degrees, centered
    on +x, are DCM, all others CBM. The last ring has the type `outer`, so that a deck can push it
    inward. `settled` closes the voids between the rings (endothelium stays). Radii in um.

    `cholangiocytes` of the DCM have the type of that name: those nearest to the point next to the
    mesenchyme where three DCM meet, where a lumen can begin. They are the first cells of the table,
    the three that meet before all others.
    """
    preset = DUCT_SIZES.get(size)
    if preset is None:
        raise SceneError(f"unknown duct size '{size}': use one of {', '.join(DUCT_SIZES)}")
    endothelium = preset["endothelium"] if endothelium is None else endothelium
    rings = preset["rings"] if rings is None else rings
    dcm_rings = preset["dcm_rings"] if dcm_rings is None else dcm_rings
    sector = preset["sector"] if sector is None else sector
    if cholangiocytes is None:
        cholangiocytes = preset.get("cholangiocytes", 0)
    if endothelium < 3:
        raise SceneError(f"--endothelium is {endothelium}: a closed vein takes at least 3 cells")
    if not 0 <= dcm_rings < rings:
        raise SceneError(f"--dcm-rings is {dcm_rings} and --rings {rings}: the last ring is the "
                         "border that is pushed inward, so 0 <= dcm-rings < rings")
    check_positive(radius=radius, vein_radius=vein_radius, mesenchyme_radius=mesenchyme_radius)
    check_gap(gap)

    layers = [("endothelium", vein_radius, False)]
    layers += [("mesenchyme", mesenchyme_radius, False)] * mesenchyme_rings
    layers += [("outer" if k == rings - 1 else "hepatoblast", radius, k < dcm_rings)
               for k in range(rings)]
    # rings turned at random: in line, they would settle into a hexagon
    turn = np.random.default_rng(seed).uniform(size=len(layers))
    cells, rho, below = [], 0.0, 0.0
    for k, (name, r, deformable) in enumerate(layers):
        if k == 0:
            rho, n = r * (1.0 + gap) / math.sin(math.pi / endothelium), endothelium
        else:
            rho += (below + r) * (1.0 + gap)
            n = ring_count(rho, r, gap)
        below = r
        for m in range(n):
            degrees = 360.0 * ((m + turn[k]) / n % 1.0)
            inside = min(degrees, 360.0 - degrees) <= 0.5 * sector + 1e-9
            t = math.radians(degrees)
            cells.append(Cell(name, "dcm" if deformable and inside else "cbm",
                              rho * math.cos(t), rho * math.sin(t), 0.0, r))
    cells = cells[:endothelium] + jittered(cells[endothelium:], jitter, seed)
    if settled:
        x = settle(np.array([[c.x, c.y] for c in cells]), np.array([c.radius for c in cells]),
                   np.array([c.type == "endothelium" for c in cells]), gap)
        cells = [replace(c, x=px, y=py) for c, (px, py) in zip(cells, x)]
    return with_cholangiocytes(cells, cholangiocytes) if cholangiocytes else cells


def meeting_points(cells, apart=1.5):
    """Triangles (t, 3) of cells that meet in a point of the plane z = 0 (Delaunay), without those
    with two cells farther apart than `apart` times their summed radii."""
    from scipy.spatial import Delaunay

    x = np.array([[c.x, c.y] for c in cells])
    r = np.array([c.radius for c in cells])
    triangles = Delaunay(x).simplices
    next_ = np.roll(triangles, 1, axis=1)
    length = np.linalg.norm(x[triangles] - x[next_], axis=2)
    return triangles[(length < apart * (r[triangles] + r[next_])).all(axis=1)]


def with_cholangiocytes(cells, number):
    """`cells` with `number` DCM turned cholangiocytes and put first, see duct()."""
    deformable = np.array([c.kind == "dcm" for c in cells])
    if not 3 <= number <= deformable.sum():
        raise SceneError(f"--cholangiocytes is {number}: a lumen begins between at least 3 of the "
                         f"{deformable.sum()} deformable cells; 0 for none")
    x = np.array([[c.x, c.y] for c in cells])
    mesenchyme = np.array([c.type == "mesenchyme" for c in cells])
    triangles = meeting_points(cells)
    inner = np.zeros(len(cells), dtype=bool)    # those next to the mesenchyme
    inner[triangles[mesenchyme[triangles].any(axis=1)]] = True
    inner &= deformable
    close = meeting_points(cells, 1.1)
    meeting = close[deformable[close].all(axis=1) & (inner[close].sum(axis=1) >= 2)]
    if not len(meeting):
        raise SceneError("nowhere next to the mesenchyme do three deformable cells meet: raise "
                         "--dcm-rings to 2 or more, or --sector")
    points = x[meeting].mean(axis=1)
    at = np.abs(np.arctan2(points[:, 1], points[:, 0])).argmin()
    far = np.linalg.norm(x - points[at], axis=1)
    far[meeting[at]] -= 1e6    # these three first
    far[~deformable] = np.inf
    first = np.argsort(far, kind="stable")[:number]
    rest = [c for k, c in enumerate(cells) if k not in first]
    return [replace(cells[k], type="cholangiocyte") for k in first] + rest


def ring(cells=8, radius=6.0, kind="dcm", type="hepatoblast", around=0, gap=0.0, jitter=0.0,
         seed=1):
    """`cells` equal cells on one circle in the plane z = 0, each touching its two neighbors, and
    `around` rings of spheres of type sphere around them, the last one of type outer.
    """
    if cells < 3:
        raise SceneError(f"--cells is {cells}: a ring takes at least 3")
    if around < 0:
        raise SceneError(f"--around is {around}: it must not be negative")
    check_positive(radius=radius)
    check_gap(gap)
    rho = radius * (1.0 + gap) / math.sin(math.pi / cells)
    made = [Cell(type, kind, rho * math.cos(t), rho * math.sin(t), 0.0, radius)
            for t in 2.0 * math.pi * np.arange(cells) / cells]
    for k in range(around):
        rho += 2.0 * radius * (1.0 + gap) * math.sqrt(0.75)
        n = ring_count(rho, radius, gap)
        made += [Cell("outer" if k == around - 1 else "sphere", "cbm", rho * math.cos(t),
                      rho * math.sin(t), 0.0, radius)
                 for t in 2.0 * math.pi * (np.arange(n) + 0.5 * k) / n]
    return jittered(made, jitter, seed)


def spheroid(cells=55, dcm=13, radius=6.0, type="hepatoblast", gap=0.0, jitter=0.0, seed=1):
    """The `cells` sites of a close-packed (fcc) lattice nearest to a site, inner `dcm` ones DCM.

    Ties in distance are broken by coordinates. Whole shells: 1, 13, 19, 43, 55, 79, 87, 135, 141.
    """
    if cells < 1 or not 0 <= dcm <= cells:
        raise SceneError(f"--cells is {cells} and --dcm {dcm}: give 0 <= dcm <= cells, cells >= 1")
    check_positive(radius=radius)
    check_gap(gap)
    half = int(math.ceil((3.0 * cells) ** (1.0 / 3.0))) + 2
    ijk = np.array(np.meshgrid(*[np.arange(-half, half + 1)] * 3, indexing="ij")).reshape(3, -1).T
    ijk = ijk[ijk.sum(axis=1) % 2 == 0]
    order = np.lexsort((ijk[:, 2], ijk[:, 1], ijk[:, 0], (ijk**2).sum(axis=1)))[:cells]
    sites = ijk[order] * (math.sqrt(2.0) * radius * (1.0 + gap))
    made = [Cell(type, "dcm" if n < dcm else "cbm", *map(float, s), radius)
            for n, s in enumerate(sites)]
    return jittered(made, jitter, seed, planar=False)


def ball(radius=5.5, kind="dcm", type="cholangiocyte", around=3, size=3.5, gap=0.0, jitter=0.0,
         seed=1):
    """One cell at the origin in a ball of spheres of radius `size` (um) and type sphere.

    They lie on `around` shells, on each as many points of a Fibonacci spiral as stand `gap` apart;
    a shell lies in the hollows of the one below, 0.82 of a diameter above it.
    """
    if around < 0:
        raise SceneError(f"--around is {around}: it must not be negative")
    check_positive(radius=radius, size=size)
    check_gap(gap)
    made = [Cell(type, kind, 0.0, 0.0, 0.0, radius)]
    rng = np.random.default_rng(seed)
    rho = (radius + size) * (1.0 + gap)
    for _ in range(around):
        # neighbors on a spiral of n points are at least 3.09 / sqrt(n) apart, in units of rho
        n = max(1, int((3.09 * rho / (2.0 * size * (1.0 + gap))) ** 2))
        z = 1.0 - (2.0 * np.arange(n) + 1.0) / n
        angle = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(n) + 2.0 * math.pi * rng.uniform()
        flat = np.sqrt(1.0 - z * z)
        points = rho * np.column_stack([flat * np.cos(angle), flat * np.sin(angle), z])
        made += [Cell("sphere", "cbm", *map(float, x), size) for x in points]
        rho += 2.0 * size * (1.0 + gap) * math.sqrt(2.0 / 3.0)
    return made[:1] + jittered(made[1:], jitter, seed, planar=False)


def sheet(cells=61, window=None, radius=6.0, type="hepatoblast", gap=0.0, jitter=0.0, seed=1):
    """Monolayer patch on the plane z = 0: hexagonal, centres at z = radius, DCM in the middle.

    The `cells` sites nearest to the z axis; ties are broken by coordinates. Whole hexagons: 1, 7,
    19, 37, 61. Cells whose centre is within `window` (um) of the axis are DCM, all others CBM; by
    default the middle cell and its six neighbors, none if it is negative. jitter: along x and y.
    """
    if cells < 1:
        raise SceneError(f"--cells is {cells}: a sheet takes at least 1")
    check_positive(radius=radius)
    check_gap(gap)
    spacing = 2.0 * radius * (1.0 + gap)
    window = 1.01 * spacing if window is None else window
    if not math.isfinite(window):
        raise SceneError(f"--window is {window:g}: it must be a number")
    half = int(math.ceil(math.sqrt(cells))) + 2
    i, j = np.array(np.meshgrid(*[np.arange(-half, half + 1)] * 2, indexing="ij")).reshape(2, -1)
    far = i * i + i * j + j * j    # squared distance in spacings, exact
    order = np.lexsort((j, i, far))[:cells]
    made = [Cell(type, "dcm" if spacing * math.sqrt(far[k]) <= window + 1e-9 * radius else "cbm",
                 float(spacing * (i[k] + 0.5 * j[k])), float(spacing * math.sqrt(0.75) * j[k]),
                 float(radius), radius) for k in order]
    return jittered(made, jitter, seed)


def crowd(side=2, radius=4.9, type="hepatoblast", gap=0.0, jitter=0.0, seed=1):
    """Cells that fill a periodic cube: face-centered cubic, side^3 x 4 DCM, cube from 0 to `side`
    lattice constants of 2 sqrt(2) radius (1 + gap).
    """
    if side < 1:
        raise SceneError(f"--side is {side}: a crowd takes at least 1")
    check_positive(radius=radius)
    check_gap(gap)
    a = 2.0 * math.sqrt(2.0) * radius * (1.0 + gap)
    corners = np.array(np.meshgrid(*[np.arange(side)] * 3, indexing="ij")).reshape(3, -1).T
    base = np.array([(0.25, 0.25, 0.25), (0.75, 0.75, 0.25), (0.75, 0.25, 0.75),
                     (0.25, 0.75, 0.75)])
    x = a * (corners[:, None, :] + base[None, :, :]).reshape(-1, 3)
    made = [Cell(type, "dcm", *map(float, xk), radius) for xk in x]
    return jittered(made, jitter, seed, planar=False)


def doublet(radius=6.0, kind="dcm", type="hepatoblast", distance=None, gap=0.0):
    """Two equal cells on the x axis, mirror images in the plane x = 0.

    distance: of the centres, um; by default 2 x radius x (1 + gap).
    """
    check_positive(radius=radius)
    if distance is None:
        check_gap(gap)
        distance = 2.0 * radius * (1.0 + gap)
    check_positive(distance=distance)
    return [Cell(type, kind, s * 0.5 * distance, 0.0, 0.0, radius) for s in (-1.0, 1.0)]


def check_positive(**values):
    """Raise SceneError unless every value is finite and positive."""
    for name, value in values.items():
        if not (math.isfinite(value) and value > 0.0):
            raise SceneError(f"--{name.replace('_', '-')} is {value:g}: it must be positive")


def check_gap(gap):
    """Raise SceneError unless -0.25 < gap < 1: LAMMPS refuses an overlap beyond half a radius."""
    if not -0.25 < gap < 1.0:
        raise SceneError(f"--gap is {gap:g}: give a fraction of the summed radii between -0.25 "
                         "(overlap of half a radius) and 1")


# ---------------------------------------------------------------------- table files

def summary(cells):
    """One line per (type, kind) with its count, then the bounding box, as a list of strings."""
    counts = {}
    for c in cells:
        counts[c.type, c.kind] = counts.get((c.type, c.kind), 0) + 1
    lines = [f"{name} {kind}: {n}" for (name, kind), n in counts.items()]
    lo = [min(getattr(c, a) - c.radius for c in cells) for a in "xyz"]
    hi = [max(getattr(c, a) + c.radius for c in cells) for a in "xyz"]
    box = " ".join(f"{a:.4g} {b:.4g}" for a, b in zip(lo, hi))
    return lines + [f"{len(cells)} cells; they reach from/to (x, y, z, um): {box}"]


def write_table(cells, path, command=None):
    """Write a cells table; `command` is recorded in the header. Lengths in um."""
    head = ["# Cells table for `create_cells table FILE`; lengths in um."]
    if command:
        head.append(f"# Made by: {command}")
    head += [f"# {line}" for line in summary(cells)]
    head.append("# typename kind x y z radius")
    rows = [f"{c.type} {c.kind} {c.x + 0.0:.6f} {c.y + 0.0:.6f} {c.z + 0.0:.6f} {c.radius:g}"
            .replace("-0.000000", "0.000000") for c in cells]
    write_text(path, "\n".join(head + rows) + "\n")


def read_table(path):
    """Read a cells table back into a list of Cell; errors name the line."""
    cells = []
    for n, line in enumerate(read_text(path).splitlines(), 1):
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        try:
            name, kind, *numbers = words
            x, y, z, r = map(float, numbers)
        except ValueError:
            raise SceneError(f"{path}:{n}: expected 'typename kind x y z radius', got '{line}'") \
                from None
        if kind not in KINDS:
            raise SceneError(f"{path}:{n}: kind '{kind}' is neither dcm nor cbm")
        cells.append(Cell(name, kind, x, y, z, r))
    return cells


# ---------------------------------------------------------------------- command line

def add_arguments(parser):
    """Add `scene` sub-commands and their options to an argparse parser."""
    sub = parser.add_subparsers(dest="scene", required=True, metavar="duct|ring|spheroid|"
                                "ball|sheet|crowd|doublet|labels")
    helpers = argparse.ArgumentDefaultsHelpFormatter

    def scene_parser(name, build, text):
        p = sub.add_parser(name, help=text, description=build.__doc__, formatter_class=helpers)
        p.set_defaults(build=build)
        p.add_argument("-o", "--output", default="cells.txt", help="cells table to write")
        p.add_argument("--radius", type=float, default=6.0, help="hepatoblast radius, um")
        p.add_argument("--gap", type=float, default=0.0, help="free distance between neighbors "
                       "as a fraction of their summed radii; negative for overlap")
        return p

    def randomness(p):
        p.add_argument("--jitter", type=float, default=0.0,
                       help="random shift per axis, fraction of the cell's radius")
        p.add_argument("--seed", type=int, default=1, help="seed of jitter and ring rotation")

    def one_type(p, kind=True):
        p.add_argument("--type", default="hepatoblast", help="cell type name")
        if kind:
            p.add_argument("--kind", choices=KINDS, default="dcm", help="kind of the cells")

    p = scene_parser("duct", duct, "portal vein with mesenchyme and hepatoblasts around it")
    p.add_argument("--size", choices=list(DUCT_SIZES), default="quick",
                   help="preset for the options that show None")
    p.add_argument("--endothelium", type=int, help="cells in the innermost ring")
    p.add_argument("--rings", type=int, help="rings of hepatoblasts, the border ring included")
    p.add_argument("--dcm-rings", type=int, help="first rings of hepatoblasts that are DCM")
    p.add_argument("--sector", type=float, help="angle, centered on +x, in which they are, degree")
    p.add_argument("--vein-radius", type=float, default=4.0, help="endothelium cell radius, um")
    p.add_argument("--mesenchyme-radius", type=float, default=4.0, help="their radius, um")
    p.add_argument("--no-settle", dest="settled", action="store_false",
                   help="keep exact circles, with the voids between them")
    p.add_argument("--mesenchyme-rings", type=int, default=1, help="rings of mesenchyme")
    p.add_argument("--cholangiocytes", type=int, help="so many DCM around a point next to the "
                   "mesenchyme are cholangiocytes")
    randomness(p)
    p = scene_parser("ring", ring, "one circle of equal cells")
    p.add_argument("--cells", type=int, default=8, help="number of cells")
    p.add_argument("--around", type=int, default=0, help="rings of spheres around them")
    one_type(p)
    randomness(p)
    p = scene_parser("spheroid", spheroid, "close-packed ball of cells, DCM inside")
    p.add_argument("--cells", type=int, default=55, help="number of cells")
    p.add_argument("--dcm", type=int, default=13, help="how many of them, from inside, are DCM")
    one_type(p, kind=False)
    randomness(p)
    p = scene_parser("ball", ball, "one cell in a ball of spheres")
    p.set_defaults(radius=5.5)
    p.add_argument("--around", type=int, default=3, help="shells of spheres around it")
    p.add_argument("--size", type=float, default=3.5, help="radius of these spheres, um")
    p.add_argument("--kind", choices=KINDS, default="dcm", help="kind of the cell")
    p.add_argument("--type", default="cholangiocyte", help="its type name")
    randomness(p)
    p = scene_parser("sheet", sheet, "hexagonal monolayer patch on the plane z = 0, DCM inside")
    p.add_argument("--cells", type=int, default=61, help="number of cells")
    p.add_argument("--window", type=float, help="DCM up to this distance of a centre from the "
                   "middle, um; None: the middle cell and its neighbors")
    one_type(p, kind=False)
    randomness(p)
    p = scene_parser("crowd", crowd, "cells that fill a periodic cube, all DCM")
    p.add_argument("--side", type=int, default=2, help="cubes of four cells along each side")
    one_type(p, kind=False)
    randomness(p)
    p = scene_parser("doublet", doublet, "two cells side by side")
    p.add_argument("--distance", type=float, help="of the centres, um; None: 2 radius (1 + gap)")
    one_type(p)
    p = sub.add_parser("labels", help="cells of a labelled image, each with a mesh of its own",
                       formatter_class=helpers)
    labels.add_arguments(p)


def run(args, words):
    """Build the scene chosen on the command line (`words`: its arguments) and write its table."""
    command = "python -m lammps_dcm " + shlex.join(words)
    if args.scene == "labels":    # the only one that takes more than a table
        labels.run(args, command)
        return
    skip = {"command", "scene", "build", "output", "run"}
    cells = args.build(**{k: v for k, v in vars(args).items() if k not in skip})
    overlap = worst_overlap(cells)
    if overlap > 0.25:
        raise SceneError(f"two cells overlap by {overlap:.2f} of their summed radii, LAMMPS "
                         "refuses more than 0.25: reduce --jitter or raise --gap")
    write_table(cells, args.output, command)
    print("\n".join(summary(cells)))
    print(f"wrote {args.output}")
