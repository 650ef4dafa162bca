"""Pictures, tables and log plots through the command line."""
import csv

import numpy as np
import pytest

from lammps_dcm.__main__ import main
from lammps_dcm.log import read_log

LOG = """LAMMPS (4 Feb 2025)
   Step          Temp          Press
         0   1             2
        10   1.5           3
WARNING: something happened
        20   2             4
Loop time of 0.1 on 1 procs
   Step          Temp          Press
        20   2             4
        30   2.5           5
Loop time of 0.1 on 1 procs
"""


@pytest.fixture
def files(scene, tmp_path):
    scene.dcm((-5, 0, 0), 5.0, level=2, volume0=520.0)
    scene.dcm((5, 0, 0), 5.0, level=2, volume0=500.0)
    scene.cbm((0, 9, 0), 4.0)
    extra = {"contact_area": lambda r: 0.1 if r["x"] > 4 else 0.0}
    (tmp_path / "dump").write_text(scene.frame(0, **extra) + scene.frame(50, **extra))
    return [str(tmp_path / "dump"), "--data", str(scene.data_file(tmp_path / "data"))]


def picture(path):
    """Pixels (h, w, 3) of a PNG in 0..1."""
    from matplotlib.image import imread

    return imread(path)[:, :, :3]


@pytest.mark.parametrize("engine", ["auto", "matplotlib"])
def test_render_shows_cells_where_they_are(files, tmp_path, engine):
    out = tmp_path / "p.png"
    assert main(["render", *files, "-o", str(out), "--engine", engine, "--size", "400",
                 "--color", "cell"]) == 0
    pixels = picture(out)
    colored = np.ptp(pixels, axis=2) > 0.15
    rows, columns = np.nonzero(colored)
    assert colored.mean() > 0.1
    # DCM from x = -10 to 10, y = -5 to 5; sphere up to y = 13: wider than high, sphere on top
    aspect = np.ptp(columns) / np.ptp(rows)
    assert aspect == pytest.approx(20 / 18, rel=0.05)
    top = colored[rows.min():rows.min() + np.ptp(rows) // 6].nonzero()[1]
    middle = (columns.min() + columns.max()) / 2
    assert abs(top.mean() - middle) < 0.05 * np.ptp(columns)


@pytest.mark.parametrize("color", ["type", "region", "pressure", "contact", "x"])
def test_every_coloring(files, tmp_path, color):
    out = tmp_path / "p.png"
    assert main(["render", *files, "-o", str(out), "--color", color, "--size", "200", "--frame",
                 "0", "--bulk-modulus", "2.5", "--engine", "matplotlib"]) == 0
    assert picture(out).std() > 0.01


@pytest.fixture
def around(scene, tmp_path):
    """Two cells side by side; of the faces toward the middle those near the axis are marked."""
    scene.dcm((-5, 0, 0), 5.0, level=3)
    scene.dcm((5, 0, 0), 5.0, level=3)
    marked = lambda r: float(r["kind"] == 4 and abs(r["x"]) < 1.0)    # noqa: E731
    (tmp_path / "dump").write_text(scene.frame(
        0, mark=marked, region=lambda r: 2.0 * marked(r)) + scene.frame(
        9, mark=lambda r: 0.0, region=lambda r: 0.0))
    return [str(tmp_path / "dump"), "--data", str(scene.data_file(tmp_path / "data"))]


def test_lumens_regions_and_marks_in_space(around):
    from matplotlib.colors import to_rgb

    import lammps_dcm
    from lammps_dcm.render import LUMENS, make_picture

    u = lammps_dcm.load(around[2], around[0])
    u.trajectory[0]
    picture = make_picture(u, lumen=True)
    x = picture.points[picture.triangles].mean(axis=1)[:, 0]
    assert 20 < picture.solid.sum() and (picture.solid == (abs(x) < 1.0)).all()
    assert (picture.face_rgb[picture.solid] == to_rgb(LUMENS[0])).all()    # both walls: one lumen
    assert "lumen 1" in picture.legend and "lumen 2" not in picture.legend
    for color, one in (("region", "apical"), ("mark", "marked")):
        picture = make_picture(u, color)
        mine = (picture.face_rgb == to_rgb(picture.legend[one])).all(axis=1)
        assert (mine == (abs(x) < 1.0)).all() and not picture.solid.any()
    u.trajectory[1]
    picture = make_picture(u, lumen=True)
    assert not picture.solid.any() and "lumen 1" not in picture.legend


@pytest.mark.parametrize("engine", ["auto", "matplotlib"])
def test_the_lumen_shows_through_the_cells(around, tmp_path, engine):
    """Seen along x a cell stands in front of it; without --lumen it hides it."""
    def blue(*options):
        out = tmp_path / "p.png"
        assert main(["render", *around, "-o", str(out), "--engine", engine, "--size", "300",
                     "--view", "yz", "--frame", "0", *options]) == 0
        middle = picture(out)[130:170, 130:170].reshape(-1, 3)
        return np.median(middle[:, 2] - middle[:, 0])

    assert blue("--lumen", "--names", "1=a") > blue("--color", "region") + 0.1


def test_pressure_is_that_of_the_frame(scene, tmp_path):
    import lammps_dcm
    from lammps_dcm.render import make_picture

    scene.dcm((0, 0, 0), 5.0, level=1, volume0=520.0)
    (tmp_path / "dump").write_text(scene.frame(0) + scene.frame(
        8, "id x y", z=lambda r: 1.1 * r["z"]))
    u = lammps_dcm.load(scene.data_file(tmp_path / "data"), tmp_path / "dump")
    bars = []
    for frame in (1, 0):
        u.trajectory[frame]
        picture = make_picture(u, "pressure", bulk_modulus=2.5)
        assert picture.title == f"step {8 * frame}"
        assert np.ptp(picture.points[:, 2]) == pytest.approx(10.0 * (1.1 if frame else 1.0))
        bars.append(sum(picture.bar[1:]) / 2)
    assert bars[1] - bars[0] == pytest.approx(2.5 * np.log(1.1), rel=1e-9)


def test_legend_names(files):
    import lammps_dcm
    from lammps_dcm.render import make_picture

    u = lammps_dcm.load(files[2], files[0])
    assert list(make_picture(u, names={"4": "outer"}).legend) == ["type 1", "outer"]


def test_colors_of_types(files, tmp_path, capfd):
    """--colors reaches sphere and legend, and leaves the other type as it is."""
    import lammps_dcm
    from lammps_dcm.render import make_picture

    u = lammps_dcm.load(files[2], files[0])
    before = make_picture(u)
    after = make_picture(u, names={"4": "outer"}, colors={"4": "#ff0000"})
    assert after.sphere_rgb.tolist() == [[1.0, 0.0, 0.0]] * len(before.sphere_rgb)
    assert after.legend == {"type 1": before.legend["type 1"], "outer": "#ff0000"}
    assert np.array_equal(after.face_rgb, before.face_rgb)
    words = ["render", files[0], "--data", files[2], "-o", str(tmp_path / "p.png")]
    assert main([*words, "--colors", "4=reddish"]) != 0
    assert "reddish is no color" in capfd.readouterr().err


def test_auto_falls_back_to_matplotlib(files, tmp_path, monkeypatch, capfd):
    from lammps_dcm import drawing

    def crash(*args, **kwargs):
        import os
        os.kill(os.getpid(), 9)

    monkeypatch.setattr(drawing, "draw_vtk", crash)
    assert main(["render", *files, "-o", str(tmp_path / "p.png"), "--size", "200"]) == 0
    assert "matplotlib" in capfd.readouterr().out
    assert picture(tmp_path / "p.png").std() > 0.01


def test_all_frames(files, tmp_path):
    assert main(["render", *files, "-o", str(tmp_path / "p.png"), "--size", "100", "--frame",
                 "all", "--engine", "matplotlib"]) == 0
    assert sorted(p.name for p in tmp_path.glob("*.png")) == ["p.00000.png", "p.00001.png"]


@pytest.mark.parametrize("words, says", [
    ("--frame 9", "there are 2 frames"), ("--color wine", "--color wine"),
    ("--color pressure", "--bulk-modulus"), ("--bulk-modulus 1=x --color pressure", "--bulk-mod"),
    ("--lumen", "column mark"), ("--color mark", "column mark"),
    ("--rename q", "--rename q"), ("--data /nowhere/data", "/nowhere/data"),
    ("--rename contact_area=q --color contact", "compute dcm/face")])
def test_render_messages(files, tmp_path, words, says, capsys):
    assert main(["render", *files, "-o", str(tmp_path / "p.png"), *words.split()]) == 1
    assert says in capsys.readouterr().err
    assert not (tmp_path / "p.png").exists()


def test_cells_table(files, tmp_path):
    out = tmp_path / "t.csv"
    assert main(["cells", *files, "-o", str(out), "--bulk-modulus", "2.5"]) == 0
    rows = list(csv.DictReader(out.open()))
    assert [(r["step"], r["cell"]) for r in rows] == [("0", "1"), ("0", "2"), ("50", "1"),
                                                      ("50", "2")]
    for r, rest in zip(rows, (520.0, 500.0) * 2):
        assert float(r["volume"]) == pytest.approx(0.9662 * 4 / 3 * np.pi * 125, rel=1e-4)
        assert float(r["pressure"]) == pytest.approx(2.5 * np.log(rest / float(r["volume"])),
                                                     rel=1e-6)


def test_quality_table(files, tmp_path, capsys):
    assert main(["quality", *files]) == 0
    rows = list(csv.DictReader(capsys.readouterr().out.splitlines()))
    assert [(r["step"], r["cell"]) for r in rows] == [("50", "1"), ("50", "2")]
    assert all(0.9 < float(r["worst"]) < float(r["median"]) < 1.0 for r in rows)
    out = tmp_path / "q.csv"
    assert main(["quality", *files[1:], "-o", str(out)]) == 0    # the data file alone
    assert len(out.read_text().splitlines()) == 3
    assert main(["quality", *files, "--frame", "all", "-o", str(out)]) == 0
    assert len(out.read_text().splitlines()) == 5
    assert main(["quality", *files, "--frame", "7"]) == 1
    assert "there are 2 frames" in capsys.readouterr().err


def test_log(tmp_path, capsys):
    path = tmp_path / "log.lammps"
    path.write_text(LOG)
    assert read_log(path)["Step"].tolist() == [0, 10, 20, 20, 30]
    assert read_log(path)["Press"].tolist() == [2, 3, 4, 4, 5]
    assert main(["log", str(path), "-o", str(tmp_path / "l.png"), "--csv",
                 str(tmp_path / "l.csv")]) == 0
    assert picture(tmp_path / "l.png").std() > 0.01
    assert (tmp_path / "l.csv").read_text().splitlines()[:2] == ["Step,Temp,Press", "0,1,2"]
    assert main(["log", str(path), "--columns", "Volume"]) == 1
    assert "there are Step Temp Press" in capsys.readouterr().err
    assert main(["log", str(tmp_path / "gone")]) == 1
