"""Lumens and polarity from dumps, against closed forms."""
import csv

import numpy as np
import pytest

import lammps_dcm
from lammps_dcm.__main__ import main
from lammps_dcm.lumen import cut, linked, measure
from support.meshes import icosphere

MESH = "id mol type kind x y z v1 v2 v3"
CENTERS = {"ax": 0.0, "ay": 0.0, "az": 0.0, "px": 0.0, "py": 0.0, "pz": 0.0}


def sphere(radius, center=(0, 0, 0), level=2, inverted=True):
    """Corners (m, 3, 3), vertices and enclosed volume of an icosphere; inverted: normals inward, as
    those of the cells around a lumen."""
    nodes, faces = icosphere(level)
    faces = faces[:, ::-1] if inverted else faces
    corners = (radius * nodes + np.asarray(center, dtype=float))[faces]
    volume = abs(np.linalg.det(radius * nodes[faces]).sum()) / 6.0
    return corners, faces, volume


@pytest.mark.parametrize("level", [1, 2, 3])
def test_inverted_icosphere_is_a_closed_lumen(level):
    corners, faces, volume = sphere(4.0, (30, -20, 7), level)
    lumen = measure(corners, np.zeros(len(faces)), plane=(2, 7.0))
    assert lumen["volume"] == pytest.approx(volume, rel=1e-12)
    assert lumen["closure"] < 1e-14
    assert lumen["covered"] == pytest.approx(1.0, abs=1e-12)
    assert (lumen["x"], lumen["y"], lumen["z"]) == pytest.approx((30, -20, 7), abs=1e-12)
    assert lumen["wall"] == pytest.approx(np.linalg.norm(np.cross(
        corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2)


def polygon(points):
    """Area of the convex polygon whose corners `points` (k, 2) are in any order."""
    p = points - points.mean(axis=0)
    p = p[np.argsort(np.arctan2(p[:, 1], p[:, 0]))]
    return 0.5 * np.abs((p[:, 0] * np.roll(p[:, 1], -1) - p[:, 1] * np.roll(p[:, 0], -1)).sum())


@pytest.mark.parametrize("axis, at", [(0, 0.3), (1, -1.1), (2, 0.05)])
def test_section_is_the_polygon_of_the_cut(axis, at):
    corners, faces, _ = sphere(4.0, level=2)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    crossings = []    # of every edge with the plane, by hand
    for face in corners:
        for u, v in zip(face, np.roll(face, -1, axis=0)):
            if (u[axis] - at) * (v[axis] - at) < 0:
                x = u + (at - u[axis]) / (v[axis] - u[axis]) * (v - u)
                crossings.append((x[a], x[b]))
    lumen = measure(corners, np.zeros(len(faces)), plane=(axis, at))
    assert lumen["section"] == pytest.approx(polygon(np.array(crossings)), rel=1e-12)
    assert lumen["circularity"] == pytest.approx(1.0, abs=0.03)
    inside_out = measure(corners[:, ::-1], np.zeros(len(faces)), plane=(axis, at))
    assert inside_out["section"] == pytest.approx(-lumen["section"], rel=1e-12)


def tube(radius, low, high, sides=24, rows=6):
    """A prism without lids around the z axis, normals inward: corners (m, 3, 3)."""
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    z = np.linspace(low, high, rows + 1)
    ring = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    found = []
    for k in range(sides):
        for m in range(rows):
            a, b = (*ring[k], z[m]), (*ring[k + 1], z[m])
            c, d = (*ring[k + 1], z[m + 1]), (*ring[k], z[m + 1])
            found += [(a, c, b), (a, d, c)]
    return np.array(found)


def test_tube_in_a_slab():
    corners = tube(5.0, -3.0, 3.0)
    section = 0.5 * 24 * 25.0 * np.sin(2 * np.pi / 24)
    lumen = measure(corners, np.zeros(len(corners)), plane=(2, 0.1), slab=(-3.0, 3.0))
    assert lumen["section"] == pytest.approx(section, rel=1e-12)
    assert lumen["volume"] == pytest.approx(6.0 * section, rel=1e-12)
    assert lumen["closure"] < 1e-14
    # cut off: less of it counts, through the middle of faces
    short = measure(corners, np.zeros(len(corners)), plane=(2, 0.1), slab=(-1.7, 2.2))
    assert short["volume"] == pytest.approx(3.9 * section, rel=1e-12)
    assert short["wall"] == pytest.approx(3.9 / 6.0 * lumen["wall"], rel=1e-12)
    assert short["section"] == lumen["section"]
    # without one of its sides: the missing chord over the length of the others
    chord = 2 * 5.0 * np.sin(np.pi / 24)
    lumen = measure(corners[12:], np.zeros(len(corners) - 12), plane=(2, 0.1), slab=(-3.0, 3.0))
    assert lumen["closure"] == pytest.approx(1 / 23, rel=1e-12)
    assert lumen["circularity"] == pytest.approx(
        4 * np.pi * lumen["section"] / (23 * chord) ** 2, rel=1e-12)


def test_solid_angles():
    from lammps_dcm.lumen import solid_angle

    octant = np.eye(3) * [1.0, 2.0, 0.5]
    assert solid_angle(octant[None]) == pytest.approx([0.125], abs=1e-14)
    assert solid_angle(octant[None, ::-1]) == pytest.approx([-0.125], abs=1e-14)
    side = np.array([[(1, -1, -1), (1, 1, -1), (1, 1, 1)], [(1, -1, -1), (1, 1, 1), (1, -1, 1)]])
    assert solid_angle(side.astype(float)).sum() == pytest.approx(1 / 6, abs=1e-14)
    # a square tube of half width d, cut off at -h and h
    d, h = 5.0 / np.sqrt(2.0), 2.0
    lumen = measure(tube(5.0, -3.0, 3.0, sides=4), np.zeros(48), (2, 0.0), (-h, h))
    assert lumen["covered"] == pytest.approx(
        4.0 * np.arctan(h / np.sqrt(2.0 * d * d + h * h)) / np.pi, rel=1e-12)


def test_segments_have_the_outside_on_their_left():
    corners, _, _ = sphere(2.0, inverted=False)
    _, ends = cut(corners, 2, 0.1)
    step = ends[:, 1] - ends[:, 0]
    left = np.stack([-step[:, 1], step[:, 0]], axis=1)
    assert ((left * ends[:, 0, :2]).sum(axis=1) > 0.0).all()


def test_components():
    a, faces, _ = sphere(3.0, (0, 0, 0))
    b, _, _ = sphere(2.0, (12, 0, 0))
    corners, vertices = np.concatenate([a, b]), np.concatenate([faces, faces + 1000])
    found = linked(corners, vertices, np.repeat([0, 1], len(faces)))
    assert found[:len(a)].tolist() == [found[0]] * len(a)
    assert found[len(a):].tolist() == [1 - found[0]] * len(a)


def test_walls_of_two_cells_across_a_gap_are_one_lumen():
    # the two halves of a sphere belong to different cells and share no node
    corners, faces, _ = sphere(3.0)
    upper = corners.mean(axis=1)[:, 2] > 0
    assert linked(corners, np.where(upper[:, None], faces + 1000, faces), upper).max() == 0
    # facing away from each other they are not
    assert linked(corners[:, ::-1] * [1, 1, 1], faces + 1000 * upper[:, None],
                  np.zeros(len(faces))).max() == 1


@pytest.fixture
def ring(scene, tmp_path):
    """Four cells around the z axis; what faces the axis is marked."""
    for n in range(4):
        angle = np.pi / 2 * n
        scene.dcm((6 * np.cos(angle), 6 * np.sin(angle), 0), (4.3, 4.3, 4.3), level=3)
    vectors = {1: (-1, 0, 0), 2: (0, -1, 0), 3: (1, 0, 0), 4: (0, 1, 0)}
    extra = {name: (lambda r, k=k: vectors[r["mol"]][k] if r["kind"] == 2 else 0)
             for k, name in enumerate(("ax", "ay", "az"))}
    extra |= {"px": lambda r: -extra["ay"](r), "py": extra["ax"], "pz": lambda r: 0.0}
    extra["mark"] = lambda r: float(r["kind"] == 4 and np.hypot(r["x"], r["y"]) < 4.2
                                    and abs(r["z"]) < 2.5)
    (tmp_path / "dump").write_text(scene.frame(0, MESH, **{**extra, "mark": lambda r: 0.0})
                                   + scene.frame(7200, MESH, **extra))
    return [str(tmp_path / "dump"), "--data", str(scene.data_file(tmp_path / "data"))]


def test_lumen_table_and_plot(ring, tmp_path):
    out, plot = tmp_path / "l.csv", tmp_path / "l.png"
    assert main(["lumen", *ring, "--plane", "z", "--slab", "-3", "3", "-o", str(out), "--plot",
                 str(plot)]) == 0
    closed, lumen = csv.DictReader(out.open())
    assert (closed["lumens"], closed["volume"], closed["cells"]) == ("0", "0", "0")
    assert (lumen["lumens"], lumen["cells"], lumen["step"]) == ("1", "4", "7200")
    assert closed["covered"] == "0" and 0.3 < float(lumen["covered"]) < 1.0    # not up and down
    assert 5.0 < float(lumen["section"]) < 4.3 ** 2
    assert float(lumen["closure"]) < 1e-2    # symmetric, so that what is missing cancels
    assert (float(lumen["x"]), float(lumen["y"])) == pytest.approx((0, 0), abs=1e-6)
    assert plot.stat().st_size > 1000


def test_a_lumen_across_a_periodic_border(make_scene, tmp_path):
    scene = make_scene(((-20, 20), (-20, 20), (-20, 20)))
    for n in range(4):
        angle = np.pi / 2 * n
        scene.dcm((19 + 6 * np.cos(angle), 6 * np.sin(angle), 0), 4.3, level=2)
    mark = {"mark": lambda r: float(r["kind"] == 4 and abs(r["z"]) < 2.5 and np.hypot(
        (r["x"] - 19 + 20) % 40 - 20, r["y"]) < 4.2)}
    (tmp_path / "dump").write_text(scene.frame(0, MESH, wrap=True, **mark))
    u = lammps_dcm.load(dump=tmp_path / "dump")
    results = lammps_dcm.Lumens(u, plane=(2, 0.0)).run().results
    assert results.number.tolist() == [1] and results.cells.tolist() == [4]
    assert 5.0 < results.section[0] < 4.3 ** 2


def test_components_of_the_dump_are_used(ring, tmp_path):
    text = (tmp_path / "dump").read_text().splitlines()
    head = text.index(next(line for line in text if line.endswith("mark")))
    lines = text[:head] + [text[head] + " lumen"]
    for line in text[head + 1:]:
        if line.endswith("mark"):
            line += " lumen"
        elif len(line.split()) > 10:
            line += " 2" if line.split()[-1] == "1" and line.split()[1] in "12" else " 0"
        lines.append(line)
    (tmp_path / "with").write_text("\n".join(lines) + "\n")
    u = lammps_dcm.load(tmp_path / "data", tmp_path / "with")
    assert lammps_dcm.Lumens(u).run().results.cells.tolist() == [0, 2]


def test_polarity_angles_and_order(ring, tmp_path):
    out, order = tmp_path / "p.csv", tmp_path / "o.csv"
    assert main(["polarity", *ring, "--plane", "z", "--lumen", "-o", str(out), "--order",
                 str(order)]) == 0
    rows = [r for r in csv.DictReader(out.open()) if r["step"] == "7200"]
    assert [float(r["between"]) for r in rows] == pytest.approx([90.0] * 4)
    assert [float(r["apical_angle"]) % 360 for r in rows] == pytest.approx([180, 270, 0, 90])
    assert [float(r["to_lumen"]) for r in rows] == pytest.approx([0.0] * 4, abs=1e-4)
    last = list(csv.DictReader(order.open()))[1]
    assert float(last["polar_order"]) == pytest.approx(0.0, abs=1e-12)
    assert float(last["nematic_order"]) == pytest.approx(0.25)    # in all directions of a plane
    assert float(last["lumen_order"]) == pytest.approx(1.0, abs=1e-9)


def test_order_of_parallel_vectors():
    from lammps_dcm.polarity import order

    assert order(np.tile([0.0, 0.6, 0.8], (5, 1))) == pytest.approx((1.0, 1.0))
    assert order(np.array([[1.0, 0, 0], [-1, 0, 0]])) == pytest.approx((0.0, 1.0))
    assert np.isnan(order(np.full((2, 3), np.nan))).all()


@pytest.mark.parametrize("words, says", [
    ("lumen --slab -1 1", "--plane"), ("lumen --plane q", "plane 'q'"),
    ("lumen --plane z --slab 1 -1", "lower end"), ("lumen --rename mark=other", "column mark"),
    ("polarity --rename ax=other", "column ax")])
def test_messages(ring, words, says, capsys):
    command, *options = words.split()
    assert main([command, *ring, *options]) == 1
    assert says in capsys.readouterr().err


# ---------------------------------------------------------------------- sections

def test_section_of_the_ring(ring):
    from lammps_dcm.section import make_section

    u = lammps_dcm.load(ring[2], ring[0])
    u.trajectory[1]
    section = make_section(u, 2, 0.1)
    assert len(section.cells) == 4 and len(section.arrows) == 4 and not section.circles
    for loop, _ in section.cells:    # the cut of an icosphere of radius 4.3
        away = np.linalg.norm(loop - loop.mean(axis=0), axis=1)
        assert away == pytest.approx(4.3, abs=0.1)
    (lumen,) = section.lumens    # all of its wall, once around the axis
    assert sorted(map(tuple, lumen)) == sorted(map(tuple, section.walls.reshape(-1, 2)))
    turn = np.diff(np.unwrap(np.arctan2(*lumen.T[::-1])))
    assert turn.sum() == pytest.approx(2 * np.pi, abs=0.5)
    x0, x1, y0, y1 = section.window(margin=0.0)
    assert (x0, x1) == pytest.approx((-10.3, 10.3), abs=0.1)
    u.trajectory[0]
    assert not make_section(u, 2, 0.1).lumens


def test_chain_makes_loops_of_segments_in_any_order():
    from lammps_dcm.section import chain

    square = np.array([[(0, 0), (1, 0)], [(1, 0), (1, 1)], [(1, 1), (0, 1)], [(0, 1), (0, 0)]])
    both = np.concatenate([square, square + 5.0])[[3, 6, 1, 0, 7, 2, 4, 5]]
    loops = chain(both, 1e-6)
    assert sorted(len(p) for p in loops) == [8, 8]
    assert sorted(p.mean() for p in loops) == [0.5, 5.5]


def test_render_sections(ring, tmp_path, capsys):
    from matplotlib.image import imread

    out = tmp_path / "s.png"
    assert main(["render", *ring, "--section", "z=0.1", "--frame", "all", "--size", "300", "-o",
                 str(out), "--names", "1=cholangiocyte"]) == 0
    first, second = (imread(tmp_path / f"s.0000{k}.png")[:, :, :3] for k in (0, 1))
    assert first.shape == second.shape == (300, 300, 3)
    blue = np.array([0x8f, 0xd3, 0xf4]) / 255    # the lumen, in the middle of the second only
    middle = (slice(145, 165), slice(140, 160))
    assert np.abs(np.median(second[middle], axis=(0, 1)) - blue).max() < 0.02
    assert np.abs(np.median(first[middle], axis=(0, 1)) - 1.0).max() < 0.02
    for words, says in (("--section q", "plane 'q'"), ("--section z=99", "meets no cell"),
                        ("--section z --window 1 0 0 1", "--window")):
        assert main(["render", *ring, *words.split(), "-o", str(out)]) == 1
        assert says in capsys.readouterr().err
