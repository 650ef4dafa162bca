"""Cells tables: geometry, files, messages."""
import itertools
import math

import pytest

from lammps_dcm import scene
from lammps_dcm.__main__ import main


def distance(a, b):
    return math.dist((a.x, a.y, a.z), (b.x, b.y, b.z))


def overlap_by_loop(cells):
    return max(1 - distance(a, b) / (a.radius + b.radius)
               for a, b in itertools.combinations(cells, 2))


def count(cells, **wanted):
    return sum(all(getattr(c, k) == v for k, v in wanted.items()) for c in cells)


@pytest.mark.parametrize("size, dcm, cbm", [("quick", (10, 14), (60, 100)),
                                            ("full", (28, 32), (470, 530))])
def test_duct_sizes(size, dcm, cbm):
    cells = scene.duct(size)
    assert dcm[0] <= count(cells, kind="dcm") <= dcm[1]
    assert cbm[0] <= count(cells, kind="cbm") <= cbm[1]
    assert {c.type for c in cells} == {"endothelium", "mesenchyme", "hepatoblast", "outer"}
    assert {c.type for c in cells if c.kind == "dcm"} == {"hepatoblast"}
    assert all(c.z == 0.0 for c in cells)
    assert overlap_by_loop(cells) < 0.01


def test_duct_layers_and_vein():
    cells = scene.duct("quick", settled=False)
    rho = {t: [math.hypot(c.x, c.y) for c in cells if c.type == t]
           for t in ("endothelium", "mesenchyme", "hepatoblast", "outer")}
    assert max(rho["endothelium"]) < min(rho["mesenchyme"])
    assert max(rho["mesenchyme"]) < min(rho["hepatoblast"])
    assert max(rho["hepatoblast"]) < min(rho["outer"])
    # 7 touching circles of radius 4: their centres lie on a circle of radius 4 / sin(180/7)
    assert rho["endothelium"] == pytest.approx([9.2190597] * 7, abs=1e-6)
    # next rings touch the ring below along a radius: 9.219 + 4 + 4, then + 4 + 6
    assert rho["mesenchyme"] == pytest.approx([17.2190597] * len(rho["mesenchyme"]), abs=1e-6)
    # as many as fit: 180 / asin(4 / 17.219) degrees = 13.4
    assert len(rho["mesenchyme"]) == 13
    assert overlap_by_loop(cells) <= 1e-12


def test_settling_closes_voids_and_keeps_the_vein():
    loose, tight = scene.duct("full", settled=False), scene.duct("full")
    far = [sum(math.hypot(c.x, c.y) for c in cells) for cells in (loose, tight)]
    assert far[1] < 0.98 * far[0]
    assert [c for c in loose if c.type == "endothelium"] == [c for c in tight
                                                             if c.type == "endothelium"]


def test_sector_and_dcm_rings():
    cells = scene.duct("full", sector=90.0, dcm_rings=1, settled=False)
    dcm = [c for c in cells if c.kind == "dcm"]
    assert dcm and all(abs(math.atan2(c.y, c.x)) <= math.pi / 4 + 1e-9 for c in dcm)
    assert not count(scene.duct("quick", dcm_rings=0), kind="dcm")


@pytest.mark.parametrize("size, seed, dcm, cbm, cholangiocytes", [
    ("lumen", 5, 14, 99, 3), ("lumen-full", 1, 31, 486, 5)])
def test_duct_in_which_a_lumen_can_begin(size, seed, dcm, cbm, cholangiocytes):
    cells = scene.duct(size, gap=-0.05, seed=seed)
    assert (count(cells, kind="dcm"), count(cells, kind="cbm")) == (dcm, cbm)
    first = cells[:cholangiocytes]
    assert all((c.type, c.kind) == ("cholangiocyte", "dcm") for c in first)
    assert count(cells, type="cholangiocyte") == cholangiocytes
    # the first three meet: each touches both others; two of them touch the mesenchyme
    close = [distance(a, b) / (a.radius + b.radius) for a, b in
             itertools.combinations(first[:3], 2)]
    assert max(close) < 1.1
    mesenchyme = [c for c in cells if c.type == "mesenchyme"]
    assert sum(min(distance(c, m) for m in mesenchyme) < 1.15 * (c.radius + 4.0)
               for c in first[:3]) == 2
    # whatever touches one of them is deformable or mesenchyme: no lumen is walled by spheres
    for c in first:
        assert all(o.kind == "dcm" or o.type == "mesenchyme" for o in cells
                   if distance(c, o) < 1.2 * (c.radius + o.radius))


def test_same_seed_same_table_other_seed_other_table():
    assert scene.duct(jitter=0.05, seed=3) == scene.duct(jitter=0.05, seed=3)
    assert scene.duct(jitter=0.05, seed=3) != scene.duct(jitter=0.05, seed=4)


def test_ring_spheroid_doublet():
    ring = scene.ring(cells=6, radius=5.0)
    assert all(math.hypot(c.x, c.y) == pytest.approx(10.0) for c in ring)    # a hexagon
    ball = scene.spheroid(cells=13, dcm=1, radius=5.0)
    assert (count(ball, kind="dcm"), count(ball, kind="cbm")) == (1, 12)
    assert [distance(ball[0], c) for c in ball[1:]] == pytest.approx([10.0] * 12)
    assert overlap_by_loop(scene.spheroid(cells=141)) <= 1e-9
    a, b = scene.doublet(radius=5.0, gap=0.1)
    assert (a.x, b.x) == pytest.approx((-5.5, 5.5))
    a, b = scene.doublet(radius=5.0, distance=9.0)
    assert distance(a, b) == pytest.approx(9.0)


def test_ball():
    cells = scene.ball(radius=5.5, around=3, size=3.5, gap=-0.05)
    assert [c.kind for c in cells].count("dcm") == 1 and cells[0].radius == 5.5
    # shells lie where their distance says, and no two cells overlap more than LAMMPS takes
    shells = sorted({round(math.dist((c.x, c.y, c.z), (0, 0, 0)), 6) for c in cells[1:]})
    assert shells == pytest.approx([8.55 + k * 6.65 * math.sqrt(2 / 3) for k in range(3)])
    assert scene.worst_overlap(cells) < 0.25
    assert len(scene.ball(around=0)) == 1


def test_sheet():
    cells = scene.sheet(cells=19, radius=5.0)
    assert all(c.z == 5.0 for c in cells)
    # middle, six neighbors at 10, then six at 10 sqrt(3) and six at 20
    rho = sorted(math.hypot(c.x, c.y) for c in cells)
    assert rho == pytest.approx([0] + [10] * 6 + [17.3205081] * 6 + [20] * 6, abs=1e-6)
    assert max(overlap_by_loop(scene.sheet(cells=n)) for n in (7, 40, 300)) <= 1e-9
    assert {math.hypot(c.x, c.y) <= 10.001 for c in cells if c.kind == "dcm"} == {True}
    assert count(cells, kind="dcm") == 7
    assert count(scene.sheet(19, radius=5.0, window=18.0), kind="dcm") == 13
    assert count(scene.sheet(19, radius=5.0, window=20.0), kind="dcm") == 19
    assert count(scene.sheet(19, radius=5.0, window=0.0), kind="dcm") == 1
    assert count(scene.sheet(19, radius=5.0, window=-1.0), kind="dcm") == 0
    wide = scene.sheet(cells=7, radius=5.0, gap=0.1, jitter=0.01)
    assert all(c.z == 5.0 for c in wide) and count(wide, kind="dcm") == 7
    assert math.hypot(wide[1].x, wide[1].y) == pytest.approx(11.0, abs=0.2)


def test_table_round_trip(tmp_path):
    cells, path = scene.duct(), tmp_path / "cells.txt"
    scene.write_table(cells, path, "a command")
    again = scene.read_table(path)
    assert "# Made by: a command" in path.read_text()
    assert len(again) == len(cells)
    for a, b in zip(cells, again):
        assert (a.type, a.kind, a.radius) == (b.type, b.kind, b.radius)
        assert distance(a, b) < 1e-5


def test_shipped_tables_are_what_their_command_makes(tmp_path):
    import shlex
    from pathlib import Path
    for path in (Path(__file__).parents[2] / "examples").glob("bile_duct*/cells.*.txt"):
        command = path.read_text().splitlines()[1].split("lammps_dcm ", 1)[1]
        words = shlex.split(command)
        words[words.index("-o") + 1] = str(tmp_path / path.name)
        assert main(words) == 0
        old, new = scene.read_table(path), scene.read_table(tmp_path / path.name)
        assert [(c.type, c.kind) for c in old] == [(c.type, c.kind) for c in new]
        assert max(distance(a, b) for a, b in zip(old, new)) < 0.05


@pytest.mark.parametrize("words, says", [
    ("duct --gap -2", "--gap"), ("duct --dcm-rings 9", "--dcm-rings"),
    ("duct --radius 0", "--radius"), ("duct --radius nan", "--radius"),
    ("duct --cholangiocytes 2", "--cholangiocytes"), ("duct --cholangiocytes 3", "--dcm-rings"),
    ("duct --endothelium 2", "--endothelium"), ("duct --jitter -1", "--jitter"),
    ("ring --cells 2", "--cells"), ("ball --around -1", "--around"), ("ball --size 0", "--size"),
    ("spheroid --dcm 99", "--dcm"),
    ("sheet --cells 0", "--cells"), ("sheet --window nan", "--window"),
    ("doublet --distance 2", "overlap"), ("ring -o /nowhere/cells.txt", "/nowhere")])
def test_bad_options_name_themselves(words, says, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["scene", *words.split()]) == 1
    assert says in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("line", ["hepatoblast dcm 0 0 0", "hepatoblast blob 0 0 0 6",
                                  "hepatoblast dcm 0 0 zero 6"])
def test_bad_table_names_the_line(line, tmp_path):
    path = tmp_path / "cells.txt"
    path.write_text(f"# head\n{line}\n")
    with pytest.raises(scene.SceneError, match="cells.txt:2"):
        scene.read_table(path)


def test_names_that_are_not_ascii(tmp_path, capsys):
    """In the file's name, and so in the command line that its header keeps."""
    path = tmp_path / "zellen_\u00fc.txt"
    assert main(["scene", "doublet", "-o", str(path)]) == 0
    text = path.read_bytes().decode("utf-8")
    assert "zellen_\u00fc.txt" in text.splitlines()[1]
    assert len(scene.read_table(path)) == 2
    path.write_text("\ufeff# gr\u00f6\u00dfe\n\u00e9 dcm 0 0 0 6\n", encoding="utf-8")
    assert scene.read_table(path)[0].type == "\u00e9"


def test_a_table_that_cannot_be_written_leaves_the_old_one(tmp_path, capsys):
    path = tmp_path / "cells.txt"
    path.write_text("old")
    (tmp_path / "cells.txt.part").mkdir()
    assert main(["scene", "doublet", "-o", str(path)]) == 1
    assert "lammps_dcm scene:" in capsys.readouterr().err
    assert path.read_text() == "old"
    assert main(["scene", "doublet", "-o", str(tmp_path / "none" / "cells.txt")]) == 1
