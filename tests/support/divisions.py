"""Decks, logs and cells for the tests of division, here and in tests/hard."""

import numpy as np

from support.closed_surface import ClosedSurface

PERIOD = 100  # s, cycle time and step of the first division
COLUMNS = "id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_c[1] c_c[2] c_c[3] xu yu zu vx vy vz fx fy fz"
CENTER, NODE, FACE = 2, 3, 4  # c_p[1]

# --- decks ----------------------------------------------------------------------------------------


def scene_of(scenes, *args, **options):
    """Scene(...) without a type for center-based cells, for which pair_style would make room."""
    scene = scenes.Scene(*args, **options)
    scene.NAMES = "hepatoblast hepatoblast hepatoblast NULL"
    return scene


def fixes(scene, *, group="all", cycle=PERIOD, growth="", plane="", options="tolerance 1e-12"):
    return (
        "fix cell all dcm/cell\n"
        + scene.volume()
        + f"fix grow {group} dcm/growth {scene.map} seed 5 cycle_time {cycle} {growth}\n"
        + f"fix divide all dcm/division seed 7 log div.log {plane}\n"
        + scene.motion(options=options)
        + "timestep 1.0\n"
    )


def output(scenes, every, columns=COLUMNS):
    return (
        "compute p all property/atom kind vertex1 vertex2 vertex3\n"
        "compute c all dcm/cell volume volume0 contact_area\n"
        + scenes.dump(columns, every)
        + "thermo_style custom step atoms f_grow f_divide[1] f_divide[2] f_divide[5] f_divide[6]\n"
        + "thermo_modify norm no format float %.17g\n"
        + f"thermo {every}\n"
    )


def deck(scene, scenes, steps, *, every=1, before="", contact="", extra="", **options):
    """A complete deck; before: ahead of the fixes, extra: ahead of the run."""
    return (
        scene.head()
        + scene.cortex()
        + (contact or scene.contact())
        + before
        + fixes(scene, **options)
        + extra
        + output(scenes, every)
        + f"run {steps}\n"
    )


def read_log(path):
    """Rows of a division log: dict of step, mother, daughters, axis, volumes ..."""
    rows = []
    for line in (path / "div.log").read_text().splitlines():
        if line.startswith("#"):
            continue
        w = line.split()
        rows.append({
            "step": int(w[0]), "mother": int(w[2]), "daughters": (int(w[3]), int(w[4])),
            "generation": int(w[5]), "kind": w[6], "axis": np.array(w[7:10], dtype=float),
            "volume": float(w[10]), "volumes": (float(w[11]), float(w[12])),
        })  # fmt: skip
    return rows


# --- cells of a frame -----------------------------------------------------------------------------


class Cell(ClosedSurface):
    """Nodes and faces of one deformable cell in a frame; at: dt to move the nodes on by."""

    def __init__(self, frame, molecule, at=0.0):
        mine = frame["mol"] == molecule
        node, face = (mine & (frame["c_p[1]"] == kind) for kind in (NODE, FACE))
        assert node.any(), f"no cell {molecule} at step {frame.step}"
        self.x = frame.x[node] + at * frame.v[node]
        self.f, self.v = frame.f[node], frame.v[node]
        index = {tag: n for n, tag in enumerate(frame["id"][node].astype(int))}
        vertex = frame.vectors("c_p[2]", "c_p[3]", "c_p[4]")[face].astype(int)
        self.faces = np.array([[index[v] for v in f] for f in vertex])
        center = frame["c_p[1]"] == CENTER
        self.volume0, self.contact = (frame[c][mine & center][0] for c in ("c_c[2]", "c_c[3]"))

    def check(self):
        """Closed, oriented, of the topology of a sphere, every node in use."""
        assert self.closed
        assert set(self.faces.ravel()) == set(range(len(self.x)))
        assert self.volume > 0.0

    def depth(self, points):
        """How deep the points lie inside, negative outside."""
        a, b, c = (p[None] - points[:, None] for p in self.corners)
        la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
        dot = lambda u, v: np.einsum("ijk,ijk->ij", u, v)  # noqa: E731
        top = dot(a, np.cross(b, c))
        low = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la
        inside = 2.0 * np.arctan2(top, low).sum(axis=1) > 2.0 * np.pi
        distance = np.array([self._distance(p) for p in points])
        return np.where(inside, distance, -distance)

    def _distance(self, p):
        """To the nearest triangle: to its plane where the foot lies within, else to an edge."""
        a, b, c = self.corners
        n = np.cross(b - a, c - a)
        n /= np.linalg.norm(n, axis=1)[:, None]
        height = ((p - a) * n).sum(axis=1)
        foot = p - height[:, None] * n
        within = np.ones(len(a), dtype=bool)
        nearest = np.inf
        for u, w in ((a, b), (b, c), (c, a)):
            e = w - u
            within &= (np.cross(e, foot - u) * n).sum(axis=1) >= 0.0
            t = np.clip(((p - u) * e).sum(axis=1) / (e * e).sum(axis=1), 0.0, 1.0)
            nearest = min(nearest, np.linalg.norm(p - u - t[:, None] * e, axis=1).min())
        return min(nearest, np.abs(height[within]).min() if within.any() else np.inf)


def molecules(frame):
    return sorted(set(frame["mol"].astype(int)))


def frames_of(result):
    """Its frames by step, read once."""
    if not hasattr(result, "frames"):
        result.frames = {frame.step: frame for frame in result.dump()}
    return result.frames


def frame_at(result, step):
    return frames_of(result)[step]


def balanced(frame):
    """Forces sum to zero to round-off."""
    return np.abs(frame.f.sum(axis=0)).max() < 1e-12 * np.abs(frame.f).sum()
