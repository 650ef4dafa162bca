"""Analyses against closed forms."""
import numpy as np
import pytest

import lammps_dcm
from support.meshes import icosphere


def make(scene, tmp_path, *frames, wrap=False, **options):
    (tmp_path / "dump").write_text("".join(frames))
    return lammps_dcm.load(scene.data_file(tmp_path / "data", wrap), tmp_path / "dump", **options)


@pytest.mark.parametrize("level, ratio", [(2, 0.9662), (3, 0.9914), (4, 0.9978)])
def test_icosphere_volume(scene, tmp_path, level, ratio):
    scene.dcm((1, 2, 3), 5.0, level=level)
    r = lammps_dcm.CellVolume(lammps_dcm.load(scene.data_file(tmp_path / "d"))).run().results
    assert r.volume[0, 0] / (4 / 3 * np.pi * 125) == pytest.approx(ratio, abs=5e-5)
    assert r.center[0, 0] == pytest.approx([1, 2, 3], abs=1e-9)


def test_icosahedron_closed_form(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=0)
    edge = 5.0 / np.sin(2 * np.pi / 5)
    u = make(scene, tmp_path, scene.frame(3))
    r = lammps_dcm.CellVolume(u).run().results
    assert r.volume[0, 0] == pytest.approx(5 * (3 + 5**0.5) / 12 * edge**3, rel=1e-12)
    assert r.area[0, 0] == pytest.approx(5 * 3**0.5 * edge**2, rel=1e-12)
    assert (r.cells.tolist(), r.steps.tolist(), r.times.tolist()) == ([1], [3], [3.0])
    r = lammps_dcm.FaceArea(u).run().results
    assert r.area[0] == pytest.approx([3**0.5 / 4 * edge**2] * 20, rel=1e-12)
    assert r.faces.tolist() == list(range(14, 34))


def test_affine_image_scales_volume_exactly(scene, tmp_path):
    scene.dcm((0, 0, 0), (5.0, 4.0, 6.0), level=2)
    scene.dcm((20, 0, 0), 1.0, level=2)
    r = lammps_dcm.CellVolume(make(scene, tmp_path, scene.frame(0))).run().results
    assert r.volume[0, 0] / r.volume[0, 1] == pytest.approx(120.0, rel=1e-12)


@pytest.mark.parametrize("center", [(0, 0, 0), (50, 50, 50), (-49, 3, 47.5)])
def test_cell_across_periodic_boundaries(scene, tmp_path, center):
    scene.dcm(center, 5.0, level=2)
    nodes, faces = icosphere(2)
    a, b, c = (5 * nodes[faces[:, k]] for k in range(3))
    expected = sum(np.linalg.det([p, q, s]) for p, q, s in zip(a, b, c)) / 6
    for wrap in (False, True):
        r = lammps_dcm.CellVolume(make(scene, tmp_path, scene.frame(0, wrap=wrap))).run().results
        assert r.volume[0, 0] == pytest.approx(expected, rel=1e-12)
    u = lammps_dcm.load(scene.data_file(tmp_path / "wrapped", wrap=True))
    assert lammps_dcm.CellVolume(u).run().results.volume[0, 0] == pytest.approx(expected, rel=1e-12)


def test_open_boundaries_are_not_folded(make_scene, tmp_path):
    scene = make_scene(((-5, 5),) * 3)    # the cell spans the whole shrink-wrapped box
    scene.dcm((0, 0, 0), 5.0, level=2)
    u = make(scene, tmp_path, scene.frame(0, flags="ss ss ss"))
    volume = lammps_dcm.CellVolume(u).run().results.volume[0, 0]
    assert volume == pytest.approx(0.9662 * 4 / 3 * np.pi * 125, rel=1e-4)


def test_tilted_box(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=1)
    straight = scene.frame(0)
    shift = {"x": 100.0 - 20.0, "y": 100.0, "z": 0.0}    # one a and one b

    def moved(axis):
        return lambda r: r[axis] + (shift[axis] if r["z"] > 0 else 0.0)

    tilted = scene.frame(1, x=moved("x"), y=moved("y"), z=lambda r: r["z"], columns="id")
    tilted = tilted.replace("BOX BOUNDS pp pp pp\n-50 50\n-50 50\n-50 50",
                            "BOX BOUNDS xy xz yz pp pp pp\n-70 50 -20\n-50 50 0\n-50 50 0")
    r = lammps_dcm.CellVolume(make(scene, tmp_path, straight, tilted)).run().results
    assert r.volume[1, 0] == pytest.approx(r.volume[0, 0], rel=1e-12)


def test_pressure(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=2, type=1, volume0=600.0)
    scene.dcm((20, 0, 0), 5.0, level=2, type=4, volume0=450.0)
    u = make(scene, tmp_path, scene.frame(0))
    volume = lammps_dcm.CellVolume(u).run().results.volume[0]
    r = lammps_dcm.CellPressure(u, 2.5).run().results
    assert r.pressure[0] == pytest.approx([2.5 * np.log(600.0 / volume[0]),
                                           2.5 * np.log(450.0 / volume[1])], rel=1e-12)
    assert r.pressure[0, 0] > 0 > r.pressure[0, 1]
    mixed = lammps_dcm.CellPressure(u, {"1": 2.5, 4: 5.0}).run().results.pressure[0]
    assert mixed == pytest.approx(r.pressure[0] * [1, 2], rel=1e-12)
    with pytest.raises(ValueError, match="no entry for center type 4"):
        lammps_dcm.CellPressure(u, {1: 2.5})
    with pytest.raises(ValueError, match="positive"):
        lammps_dcm.CellPressure(u, -1.0)


def test_rest_volume_of_the_frame_wins(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=2, volume0=600.0)
    u = make(scene, tmp_path, scene.frame(0), scene.frame(1, volume0=lambda r: 2 * r["volume0"]))
    p = lammps_dcm.CellPressure(u, 1.0).run().results.pressure[:, 0]
    assert p[1] - p[0] == pytest.approx(np.log(2.0), rel=1e-12)


def test_cell_that_comes_late_or_lacks_nodes(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=1)
    scene.dcm((20, 0, 0), 5.0, level=1)
    node = scene.rows[5]["id"]
    u = make(scene, tmp_path, scene.frame(0, keep=lambda r: r["mol"] == 1), scene.frame(1),
             scene.frame(2, keep=lambda r: r["id"] != node),
             scene.frame(3, keep=lambda r: r["kind"] == 3))    # nodes alone are enough
    with pytest.warns(UserWarning, match="cell 1: nodes are missing"):
        volume = lammps_dcm.CellVolume(u).run().results.volume
    assert np.isnan(volume).tolist() == [[False, True], [False, False], [True, False],
                                         [False, False]]
    assert volume[3] == pytest.approx(volume[1], rel=1e-12)


def test_surface_with_a_hole(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=1)
    u = make(scene, tmp_path, scene.frame(0, keep=lambda r: r["id"] != scene.rows[-1]["id"]))
    with pytest.warns(UserWarning, match="not closed"):
        assert np.isnan(lammps_dcm.CellVolume(u).run().results.volume[0, 0])


def test_connectivity_of_the_frame_wins(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=0)
    flip = {"v1": lambda r: r["v2"], "v2": lambda r: r["v1"], "v3": lambda r: r["v3"]}
    u = make(scene, tmp_path, scene.frame(0), scene.frame(1, **flip))
    volume = lammps_dcm.CellVolume(u).run().results.volume[:, 0]
    assert volume[1] == pytest.approx(-volume[0], rel=1e-12)
    with pytest.warns(UserWarning, match="inside out"):
        assert np.isnan(lammps_dcm.CellPressure(u, 1.0).run().results.pressure[1, 0])


def test_slices_of_frames(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=0)
    frames = [scene.frame(k, x=lambda r, k=k: r["x"] * (1 + k), columns="id y z") for k in range(5)]
    u = make(scene, tmp_path, *frames)
    r = lammps_dcm.CellVolume(u).run(start=1, step=2).results
    assert r.volume[1, 0] / r.volume[0, 0] == pytest.approx(2.0, rel=1e-12)
    assert r.steps.tolist() == [1, 3]


def test_contacts(scene, tmp_path):
    scene.dcm((-48, 0, 0), 5.0, level=2)       # touches 2 through the boundary, and 3
    scene.dcm((42.1, 0, 0), 5.0, level=2)
    scene.cbm((-36.9, 0, 0), 6.0)
    scene.cbm((-24.8, 0, 0), 6.0)              # touches 3 only
    scene.dcm((0, 30, 0), 5.0, level=2)        # touches nobody
    text = scene.frame(0, **{"c_f[2]": lambda r: 0.25 if r["kind"] == 4 and r["mol"] == 2 else 0})
    u = make(scene, tmp_path, text, rename={"c_f[2]": "contact_area"})
    r = lammps_dcm.CellContacts(u, cutoff=0.6).run().results
    assert r.neighbors[0].tolist() == [[1, 2], [1, 3], [3, 4]]
    assert r.contact_area[0] == pytest.approx([0.0, 320 * 0.25, 0.0])
    area = lammps_dcm.CellVolume(u).run().results.area[0]
    assert r.fraction[0, 1] == pytest.approx(80.0 / area[1])
    open_box = make(scene, tmp_path, scene.frame(0, flags="ff pp ff"))
    r = lammps_dcm.CellContacts(open_box, cutoff=0.6).run().results
    assert r.neighbors[0].tolist() == [[1, 3], [3, 4]]
    assert np.isnan(r.contact_area).all()


def test_quality_of_single_triangles():
    from lammps_dcm.analysis import triangle_quality

    # base 2, height h: area h, sum of squares 4 + 2 (1 + h^2)
    corners = np.array([[(-1, 0, 0), (1, 0, 0), (0, h, 0)] for h in (3**0.5, 1.0, 1e-3, 0.0)])
    expected = [1.0, 4 * 3**0.5 / 8, 4 * 3**0.5 * 1e-3 / (6 + 2e-6), 0.0]
    assert triangle_quality(corners) == pytest.approx(expected, rel=1e-12)
    assert triangle_quality(np.zeros((1, 3, 3))) == [0.0]


def test_quality_of_an_icosahedron_and_a_sliver(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=0)
    scene.dcm((49, 0, 0), 5.0, level=0)    # across the boundary
    a, b = scene.rows[1], scene.rows[12]    # nodes 0 and 11 of cell 1, an edge
    frame = scene.frame(0, wrap=True)
    a.update({x: b[x] + 0.05 * (a[x] - b[x]) for x in "xyz"})
    u = make(scene, tmp_path, frame, scene.frame(1, wrap=True))
    r = lammps_dcm.CellQuality(u).run().results
    assert r.worst[0] == pytest.approx([1.0, 1.0], rel=1e-12)
    # edges 1 and angle 60 degrees: with sides 0.05 and 1 the third has the square 1.0025 - 0.05,
    # the area is 0.025 sin 60, so 4 sqrt(3) A = 0.15; 15 of 20 faces are as before
    assert r.worst[1] == pytest.approx([0.15 / (0.0025 + 1 + 0.9525), 1.0], rel=1e-12)
    assert r.median == pytest.approx(np.ones((2, 2)), rel=1e-12)
    bad = next(f for f in scene.rows if f["id"] == r.worst_face[1, 0])
    assert {a["id"], b["id"]} < {bad[v] for v in ("v1", "v2", "v3")}


def test_quality_lacks_nodes(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=1)
    u = make(scene, tmp_path, scene.frame(0, keep=lambda r: r["id"] != 6))
    with pytest.warns(UserWarning, match="cell 1: nodes are missing"):
        assert np.isnan(lammps_dcm.CellQuality(u).run().results.worst[0, 0])


def test_no_faces_teaches(scene, tmp_path):
    scene.cbm((0, 0, 0), 5.0)
    (tmp_path / "dump").write_text(scene.frame(0))
    with pytest.raises(ValueError, match="together with its data file"):
        lammps_dcm.CellVolume(lammps_dcm.load(dump=tmp_path / "dump"))
