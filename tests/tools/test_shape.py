"""Shapes of cells against closed forms, and the table of all of them."""
import numpy as np
import pytest

import lammps_dcm
from lammps_dcm.shape import volume_moments
from support.meshes import cube, icosphere


def test_moments_of_a_box():
    """Exact: a box of half sides a, b, c has the second moments a^2/3, b^2/3, c^2/3."""
    nodes, faces = cube(2)
    half, middle = np.array([1.0, 2.0, 5.0]), np.array([3.0, -4.0, 7.0])
    corners = (nodes * half + middle)[faces]
    twice = np.concatenate([corners, corners + 100.0])
    centroid, tensor = volume_moments(twice, np.repeat([0, 1], len(faces)), 2)
    assert centroid[0] == pytest.approx(middle, rel=1e-12)
    assert centroid[1] == pytest.approx(middle + 100.0, rel=1e-12)
    for t in tensor:
        assert np.diag(np.diag(t)) == pytest.approx(t, abs=1e-9)
        assert np.diag(t) == pytest.approx(half**2 / 3.0, rel=1e-9)


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def test_ellipsoid(scene, tmp_path):
    """An affine image of a mesh has moments that scale exactly; the mesh itself is smaller than
    the ball through its nodes by its flat faces, at level 3 by 0.9 % in volume, so by less than
    1 % in size."""
    nodes, faces = icosphere(3)
    half = np.array([9.0, 6.0, 3.0])
    unit = scene.dcm((0, 0, 0), 1.0, level=3)
    long = scene.dcm((20, 0, 0), half, level=3)
    for row in scene.rows:    # turn the second about its middle
        if row["mol"] == long:
            x = turn(0.5) @ (np.array([row["x"], row["y"], row["z"]]) - [20, 0, 0]) + [20, 0, 0]
            row["x"], row["y"], row["z"] = x
    u = lammps_dcm.load(scene.data_file(tmp_path / "data"))
    r = lammps_dcm.CellShape(u).run().results
    assert r.cells.tolist() == [unit, long]
    ball, made = r.half_axes[0]
    assert ball == pytest.approx([ball[0]] * 3, rel=1e-9)    # icosahedral: all axes alike
    assert ball[0] == pytest.approx(1.0, abs=0.01) and ball[0] < 1.0
    assert made == pytest.approx(half * ball[0], rel=1e-9)
    assert r.axes[0, 1] == pytest.approx(
        np.array([turn(0.5) @ [1, 0, 0], turn(0.5) @ [0, 1, 0], [0, 0, 1]]), abs=1e-6)
    assert r.centroid[0, 1] == pytest.approx([20, 0, 0], abs=1e-9)
    # 1.5 sum (l - mean)^2 / (sum l)^2 of l = a^2/5
    moment = half**2
    expected = 1.5 * ((moment - moment.mean()) ** 2).sum() / moment.sum() ** 2
    assert r.asphericity[0] == pytest.approx([0.0, expected], abs=1e-9)
    # volumes 4/3 pi abc; the surface of the ellipsoid from its integral (Knud Thomsen's form is
    # within 1.1 %, and the faces take another half percent)
    p = 1.6075
    area = 4 * np.pi * (((9.0 * 6) ** p + (9.0 * 3) ** p + (6.0 * 3) ** p) / 3) ** (1 / p)
    volume = 4 / 3 * np.pi * half.prod()
    assert r.sphericity[0, 1] == pytest.approx(
        np.pi ** (1 / 3) * (6 * volume) ** (2 / 3) / area, rel=0.02)
    assert r.shape_index[0, 0] == pytest.approx((36 * np.pi) ** (1 / 3), rel=0.01)
    assert (r.shape_index * r.sphericity)[0] == pytest.approx([(36 * np.pi) ** (1 / 3)] * 2)
    assert 0.99 < r.sphericity[0, 0] < 1.0


def test_icosahedron_closed_form(scene, tmp_path):
    """From V = 5 (3 + sqrt 5) e^3 / 12 and A = 5 sqrt(3) e^2: (pi (3 + sqrt 5)^2 / (60 sqrt
    3))^(1/3)."""
    scene.dcm((1, 2, 3), 5.0, level=0)
    u = lammps_dcm.load(scene.data_file(tmp_path / "data"))
    r = lammps_dcm.CellShape(u).run().results
    expected = (np.pi * (3 + 5**0.5) ** 2 / (60 * 3**0.5)) ** (1 / 3)
    assert r.sphericity[0, 0] == pytest.approx(expected, rel=1e-12)


def test_table_of_all_frames(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=2, volume0=520.0)
    scene.dcm((20, 0, 0), (5.0, 4.0, 6.0), level=2, volume0=500.0)
    columns = "id mol type x y z"
    (tmp_path / "dump").write_text(
        scene.frame(0, columns) + scene.frame(7, columns, keep=lambda r: r["mol"] == 2))
    u = lammps_dcm.load(scene.data_file(tmp_path / "data"), tmp_path / "dump", dt=0.5)
    table = lammps_dcm.cells_frame(u, 2.5)
    assert table[["frame", "step", "time", "cell"]].values.tolist() == [
        [0, 0, 0, 1], [0, 0, 0, 2], [1, 7, 3.5, 2]]
    assert table.volume[2] == pytest.approx(table.volume[1], rel=1e-12)
    assert table.volume[1] == pytest.approx(table.volume[0] * 120 / 125, rel=1e-12)
    assert table.pressure.values == pytest.approx(
        2.5 * np.log(np.array([520, 500, 500]) / table.volume), rel=1e-12)
    assert table.half_axis_1[1] / table.half_axis_3[1] == pytest.approx(6 / 4, rel=1e-9)
    assert table.loc[1, ["axis_1_x", "axis_1_y", "axis_1_z"]].tolist() == pytest.approx(
        [0, 0, 1], abs=1e-9)
    assert table.loc[1, ["x", "y", "z"]].tolist() == pytest.approx([20, 0, 0], abs=1e-9)
    assert len(lammps_dcm.cells_frame(u, frames=[1])) == 1
    assert lammps_dcm.cells_frame(u).pressure.isna().all()


def test_a_cell_that_cannot_be_measured_is_nan(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=1)
    missing = scene.rows[3]["id"]
    (tmp_path / "dump").write_text(scene.frame(0, "id mol x y z",
                                               keep=lambda r: r["id"] != missing))
    u = lammps_dcm.load(scene.data_file(tmp_path / "data"), tmp_path / "dump")
    with pytest.warns(UserWarning, match="nodes are missing"):
        table = lammps_dcm.cells_frame(u)
    assert table[["volume", "sphericity", "asphericity", "half_axis_1", "axis_1_x"]].isna().all(
        axis=None)
