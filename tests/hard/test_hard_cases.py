"""Hard cases: the program continues with a sound result or stops with one clear error.

Sound: no NaN in a dump, every surface closed with a positive volume near its rest volume, no node
deep inside another cell.
"""

import re

import numpy as np
import pytest

from support.meshes import icosphere

TIME = 20  # s, for one run
COLUMNS = "id mol type c_p[1] c_p[2] c_p[3] c_p[4] xu yu zu"

# --- decks ----------------------------------------------------------------------------------------


def deck(scene, steps, dt=1.0, *, cortex="", contact="", extra="", motion=None, every=50):
    """A complete deck with a dump that tells faces, nodes and vertices."""
    return (
        scene.head()
        + (cortex or scene.cortex())
        + (contact or scene.contact())
        + "fix cell all dcm/cell\n"
        + scene.volume()
        + (scene.motion(options="") if motion is None else motion)
        + extra
        + "compute p all property/atom kind vertex1 vertex2 vertex3\n"
        + f"dump d all custom {every} dump.txt {COLUMNS}\ndump_modify d sort id\n"
        + "thermo_style custom step ebond edihed f_volume f_motion[1]\nthermo_modify norm no\n"
        + f"thermo {every}\ntimestep {dt!r}\nrun {steps}\n"
    )


def cell_group(cell):
    return f"group cell{cell} molecule {cell}\n"


def node_force(cells, force, nodes):
    """`force` (nN) along x on each cell of `cells`, shared by its nodes; alternating signs."""
    text = ""
    for n, cell in enumerate(cells):
        sign = 1 if n % 2 else -1
        text += (
            f"group n{cell} molecule {cell}\ngroup nodes type 2\n"
            f"group pull{cell} intersect n{cell} nodes\n"
            f"fix pull{cell} pull{cell} addforce {sign * force / nodes!r} 0 0\n"
        )
    return text


# --- checks ---------------------------------------------------------------------------------------


class Surface:
    """Nodes and triangles of one cell in one frame; box: lengths of a periodic box."""

    def __init__(self, frame, cell, box=None):
        self.box = box
        mine = frame["mol"] == cell
        kind = frame["c_p[1]"]
        is_node, is_face = mine & (kind == 3), mine & (kind == 4)
        self.x = frame.x[is_node]
        tags = frame["id"][is_node].astype(int)
        index = {tag: n for n, tag in enumerate(tags)}
        vertex = frame.vectors("c_p[2]", "c_p[3]", "c_p[4]")[is_face].astype(int)
        self.faces = np.array([[index[v] for v in face] for face in vertex])

    def near(self, points):
        """Move a group of points by whole boxes, so that its mean comes closest."""
        if self.box is None:
            return points
        shift = points.mean(axis=0) - self.x.mean(axis=0)
        return points - self.box * np.round(shift / self.box)

    @property
    def volume(self):
        a, b, c = (self.x[self.faces[:, k]] - self.x[0] for k in range(3))
        return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0

    def closed(self):
        """Every edge once in each direction."""
        half = {(f[k], f[(k + 1) % 3]) for f in self.faces for k in range(3)}
        return len(half) == 3 * len(self.faces) and all((b, a) in half for a, b in half)

    def inside(self, points):
        """Which points lie inside, by the solid angle of the surface."""
        p = self.near(points)
        a, b, c = (self.x[None, self.faces[:, k]] - p[:, None] for k in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
        dot = lambda u, v: np.einsum("ijk,ijk->ij", u, v)  # noqa: E731
        top = dot(a, np.cross(b, c))
        low = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la
        return 2.0 * np.arctan2(top, low).sum(axis=1) > 2.0 * np.pi

    def depth(self, points):
        """How far the deepest of the points lies inside, to about a tenth of an edge."""
        p = self.near(points)[self.inside(points)]
        if not len(p):
            return 0.0
        grid = [(i, j, 6 - i - j) for i in range(7) for j in range(7 - i)]
        surface = np.einsum("sk,fkd->sfd", np.array(grid) / 6.0, self.x[self.faces])
        near = np.linalg.norm(p[:, None] - surface.reshape(1, -1, 3), axis=2)
        return near.min(axis=1).max()


def frames_of(result):
    frames = result.dump() if (result.path / "dump.txt").exists() else []
    for frame in frames:
        assert np.isfinite(frame.x).all(), f"NaN at step {frame.step}"
    return frames


def sound(result, volume=(0.5, 1.5), depth=None, box=None):
    """The run ended and left sound cells in its last frame; returns the surfaces."""
    assert result.returncode == 0, result.tail()
    for row in result.thermo:
        assert np.isfinite(list(row.values())).all(), row
    first, *_, last = frames_of(result)
    cells = sorted(set(last["mol"][last["c_p[1]"] == 3].astype(int)))
    start = {c: Surface(first, c, box) for c in cells}
    end = {c: Surface(last, c, box) for c in cells}
    for c in cells:
        assert end[c].closed()
        ratio = end[c].volume / start[c].volume
        assert volume[0] < ratio < volume[1], f"cell {c}: volume {ratio} of that at the start"
    for a in cells:
        for b in cells:
            edges = end[b].x[end[b].faces]
            edge = np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1).mean()
            if a != b:
                assert end[b].depth(end[a].x) < (depth or 0.75 * edge), f"cell {a} is inside {b}"
    return end


def stops(result, *patterns):
    """The run ended in one error line with all patterns, and wrote no NaN."""
    assert result.returncode != 0, result.tail()
    errors = [line for line in result.out.splitlines() if "ERROR" in line]
    assert len(errors) == 1, result.tail()
    for pattern in patterns:
        assert re.search(pattern, errors[0]), errors[0]
    frames_of(result)


NAMED = (r"dcm/", r"cells? \d+", r"step \d+", r"(reduce|smaller) (the )?time ?step|[;:,] ")


def sound_or_stops(result, *patterns, **limits):
    """Either; the error names style, cell, step and remedy. Returns True if sound."""
    if result.returncode == 0:
        sound(result, **limits)
        return True
    stops(result, *NAMED, *patterns)
    return False


# --- meshes with slivers --------------------------------------------------------------------------


def sliver_mesh(kind):
    """An icosphere with needles (a short edge) or caps (a node almost on the opposite edge)."""
    x, faces = icosphere(2)
    for n in (20, 60, 100):
        face = next(f for f in faces if n in f)
        a, b = [i for i in face if i != n]
        goal = x[a] if kind == "needle" else 0.5 * (x[a] + x[b])
        x[n] = goal + (0.05 if kind == "needle" else 0.02) * (x[n] - goal)
    text = f"OFF\n{len(x)} {len(faces)} 0\n" + "".join(
        " ".join(f"{c:.12g}" for c in node) + "\n" for node in x
    )
    text += "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)
    return text, len(x), len(faces)


@pytest.mark.parametrize("kind", ["needle", "cap"])
def test_slivers(lmp, scenes, kind):
    text, nodes, faces = sliver_mesh(kind)
    scene = scenes.Scene(25.0)
    for x in (-5.95, 5.95):
        scene.dcm(x, 0.0, 0.0, 6.0, mesh=("sliver.off", nodes, faces))
    result = lmp.run(deck(scene, 300), files={"sliver.off": text}, timeout=TIME)
    sound(result)


# --- forces far beyond what cells can bear --------------------------------------------------------


@pytest.mark.parametrize("force", [50.0, 500.0, 5000.0])
def test_crushed_between_spheres(lmp, scenes, force):
    scene = scenes.Scene(40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(-11.0, 0.0, 0.0, 5.0)
    scene.cbm(11.0, 0.0, 0.0, 5.0)
    push = (
        "group left molecule 2\ngroup right molecule 3\n"
        f"fix l left addforce {force} 0 0\nfix r right addforce {-force} 0 0\n"
    )
    result = lmp.run(deck(scene, 600, extra=push), timeout=TIME)
    sound_or_stops(result, volume=(0.3, 1.5))


@pytest.mark.parametrize("force", [50.0, 500.0])
def test_crushed_between_cells(lmp, scenes, force):
    scene = scenes.Scene(40.0, level=2)
    for x in (-11.9, 0.0, 11.9):
        scene.dcm(x, 0.0, 0.0, 6.0)
    push = node_force((3, 1), force, 162)
    result = lmp.run(deck(scene, 600, extra=push), timeout=TIME)
    sound_or_stops(result, volume=(0.3, 1.5))


@pytest.mark.parametrize("force", [1.0, 20.0, 400.0])
def test_sphere_pressed_into_cell(lmp, scenes, force):
    scene = scenes.Scene(40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(8.9, 0.0, 0.0, 3.0)
    push = f"group ball molecule 2\nfix push ball addforce {-force} 0 0\n"
    result = lmp.run(deck(scene, 500, extra=push), timeout=TIME)
    sound_or_stops(result)


@pytest.mark.parametrize("force", [5.0, 50.0, 500.0])
def test_doublet_torn_apart(lmp, scenes, force):
    scene = scenes.doublet(level=2, gap=-0.3, box=60.0)
    result = lmp.run(deck(scene, 600, extra=node_force((1, 2), force, 162)), timeout=TIME)
    sound_or_stops(result)


@pytest.mark.parametrize("force", [1.0, 30.0, 1000.0])
def test_one_node_pulled_out(lmp, scenes, force):
    scene = scenes.single_cell(level=2, box=60.0)
    pull = f"group tip id 10\nfix tip tip addforce 0 0 {force}\n"
    result = lmp.run(deck(scene, 400, extra=pull), timeout=TIME)
    sound_or_stops(result)


# --- adhesion -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "law, work",
    [("dmt", 0.0), ("dmt", 0.1), ("dmt", 1.0), ("dmt", 10.0), ("maugis", 0.0), ("maugis", 0.1),
     ("maugis", 1.0)],
)  # fmt: skip
def test_adhesion(lmp, scenes, law, work):
    """Cells without adhesion stay apart, others come closer, or the run stops."""
    scene = scenes.doublet(level=2, gap=-0.1, box=25.0)
    contact = scene.contact(f"law {law}", f"W {work}")
    result = lmp.run(deck(scene, 400, contact=contact), timeout=TIME)
    if sound_or_stops(result):
        cells = [Surface(result.dump()[-1], cell).x.mean(axis=0) for cell in (1, 2)]
        distance = np.linalg.norm(cells[1] - cells[0])
        assert (distance < 11.8) if work > 0.0 else (11.9 <= distance < 12.1), distance
    else:
        assert work > 0.1


@pytest.mark.parametrize("work", [5.0, 10.0])
def test_adhesion_wider_than_the_cell(lmp, scenes, work):
    """Law maugis would turn such an adhesion into a repulsion: it refuses."""
    scene = scenes.doublet(level=2, gap=-0.1, box=25.0)
    contact = scene.contact("law maugis", f"W {work}")
    result = lmp.run(deck(scene, 1, contact=contact), timeout=TIME)
    stops(result, "too strong for law maugis", "E_contact")


@pytest.mark.parametrize("level", [2, 3])
def test_slack_thin_cortex(lmp, scenes, level):
    """Surfaces of limp cells wrinkle and run into each other: detected, or sound."""
    scene = scenes.Scene(25.0, level=level)
    for x in (-5.95, 5.95):
        scene.dcm(x, 0.0, 0.0, 6.0, options="rotate 3 rest 1.0")
    limp = "E_cor 2 h_cor 0.3"
    result = lmp.run(
        deck(scene, 1500 if level == 2 else 300, cortex=scene.cortex(limp, limp)), timeout=60
    )
    sound_or_stops(result)


# --- time step ------------------------------------------------------------------------------------


@pytest.mark.parametrize("dt", [10.0, 100.0, 1000.0])
def test_time_step(lmp, scenes, dt):
    scene = scenes.doublet(level=2, gap=-0.3, box=25.0)
    result = lmp.run(deck(scene, 300, dt), timeout=TIME)
    sound_or_stops(result, "timestep")


def test_time_step_that_inverts(lmp, scenes):
    """With the limit on displacements lifted, inverted cells are found all the same."""
    scene = scenes.doublet(level=2, gap=-0.3, box=25.0)
    motion = scene.motion(options="maxmove 1e9")
    result = lmp.run(deck(scene, 100, 300.0, motion=motion, every=1), timeout=TIME)
    stops(result, r"dcm/", r"cells? \d+")


# --- boxes ----------------------------------------------------------------------------------------


def test_periodic_corner(lmp, scenes):
    """Two cells around the corner of a periodic box, on 1, 2 and 4 ranks."""
    scene = scenes.Scene(16.0, "p p p", level=1)
    scene.dcm(15.5, 15.0, 15.8, 6.0)
    scene.dcm(-4.7, 15.2, -15.9, 6.0)
    text = deck(scene, 20, every=10)
    ends = [sound(lmp.run(text, np=n, timeout=60), box=32.0) for n in (1, 2, 4)]
    for other in ends[1:]:
        for cell, surface in ends[0].items():
            assert abs(other[cell].x - surface.x).max() < 1e-4, "beyond the digits of the dump"
            assert abs(other[cell].volume / surface.volume - 1.0) < 1e-5


def test_shrink_wrapped_border(lmp, scenes):
    """Box faces follow cells that are pushed outwards."""
    scene = scenes.doublet(level=2, gap=-0.1, box=12.0)
    sound(lmp.run(deck(scene, 300, extra=node_force((1, 2), 5.0, 162)), timeout=TIME))


def test_fixed_border(lmp, scenes):
    """Cells that fit stay; atoms pushed out of a fixed box are lost, and LAMMPS says so."""
    scene = scenes.doublet(level=2, gap=-0.1, boundary="f f f", box=12.2)
    sound(lmp.run(deck(scene, 200), timeout=TIME))
    result = lmp.run(deck(scene, 2000, extra=node_force((1, 2), 50.0, 162)), timeout=TIME)
    stops(result, r"[Ll]ost atoms|cell \d.* at step \d+.*lost through a fixed boundary")


def test_unequal_sizes(lmp, scenes):
    scene = scenes.Scene(40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 12.0)
    scene.dcm(13.9, 0.0, 0.0, 2.0)
    sound(lmp.run(deck(scene, 400), timeout=TIME))


def test_unequal_sizes_pressed(lmp, scenes):
    scene = scenes.Scene(40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 12.0)
    scene.dcm(13.9, 0.0, 0.0, 2.0)
    push = node_force((2,), 20.0, 162)
    sound_or_stops(lmp.run(deck(scene, 400, extra=push), timeout=TIME), depth=4.0)


# --- groups ---------------------------------------------------------------------------------------


def test_fixed_cell(lmp, scenes):
    """A cell outside the group of fix dcm/motion stays to the last bit, its partner moves."""
    scene = scenes.doublet(level=2, gap=-0.3, box=25.0)
    motion = cell_group(2) + scene.motion(group="cell2", options="")
    result = lmp.run(deck(scene, 200, motion=motion), timeout=TIME)
    sound(result)
    first, *_, last = result.dump()
    node = first["c_p[1]"] == 3
    still, moved = node & (first["mol"] == 1), node & (first["mol"] == 2)
    assert (first.x[still] == last.x[still]).all()
    assert abs(first.x[moved] - last.x[moved]).max() > 1e-3


def test_empty_group(lmp, scenes):
    scene = scenes.doublet(level=1, box=25.0)
    motion = "group none empty\n" + scene.motion(group="none", options="")
    stops(lmp.run(deck(scene, 10, motion=motion), timeout=TIME), "dcm/motion: group none holds no")


def test_group_cleared_between_runs(lmp, scenes):
    scene = scenes.doublet(level=1, box=25.0)
    motion = cell_group(2) + scene.motion(group="cell2", options="")
    text = deck(scene, 10, motion=motion, every=5) + "group cell2 clear\nrun 10\n"
    stops(lmp.run(text, timeout=TIME), "dcm/motion: group cell2 holds no")


def test_cell_deleted(lmp, scenes):
    """A whole cell may go between runs; a part of one may not; nor may all."""
    scene = scenes.doublet(level=1, gap=-0.3, box=25.0)
    text = deck(scene, 20, every=10) + cell_group(1)
    gone = "delete_atoms group cell1 bond yes\nrun 20\n"
    result = lmp.run(text + gone, timeout=TIME)
    assert result.returncode == 0, result.tail()
    last = frames_of(result)[-1]
    assert set(last["mol"]) == {2}
    assert Surface(last, 2).closed()

    some = "group part id 2:20\ndelete_atoms group part bond yes\nrun 20\n"
    stops(lmp.run(text + some, timeout=TIME), r"dcm/", r"cell \d|face \d")

    center = "group part id 1\ndelete_atoms group part bond yes\nrun 20\n"
    stops(lmp.run(text + center, timeout=TIME), "cell 1, which has no center atom")

    every = "delete_atoms group all bond yes\nrun 20\n"
    stops(lmp.run(text + every, timeout=TIME), "dcm/")
