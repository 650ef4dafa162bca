"""Files for ParaView and OVITO, and pages for a browser."""
import base64
import io
import json
import shutil
import subprocess
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest

from lammps_dcm.__main__ import main
from support.runner import ROOT
from support.scenes import Scene

COLUMNS = "id mol type kind radius x y z v1 v2 v3 region volume0"
DECK = """
compute atoms all property/atom kind vertex1 vertex2 vertex3
compute cell all dcm/cell volume area pressure contact_area
compute face all dcm/face contact_area stress
fix move all dcm/motion MAP
dump all all custom 5 all.dump id mol type x y z radius vx vy vz c_atoms[*] c_cell[*] c_face[*]
dump_modify all format float %.15g time yes colname c_atoms[1] kind colname c_atoms[2] v1 &
  colname c_atoms[3] v2 colname c_atoms[4] v3 colname c_cell[3] pressure &
  colname c_face[1] contact_area colname c_face[2] stress
timestep 0.5
run 10
"""


@pytest.fixture(scope="module")
def run(lmp_module, scenes):
    """Three cells and a sphere in a periodic box, two of the cells across its borders."""
    s = Scene(box=12.0, boundary="p p p", level=2)
    s.dcm(0, 0, 0, 4.0)
    s.dcm(7.5, 0, 0, 4.0)
    s.dcm(-5, 11, 11, 3.5)
    s.cbm(0, 0, 7.0, 3.2)
    deck = s.head() + s.forces() + DECK.replace("MAP", s.map)
    return lmp_module(deck).path


def series(folder, part):
    """(times, files) of a .pvd file."""
    entries = ElementTree.parse(folder / f"{part}.pvd").getroot().iter("DataSet")
    found = [(float(e.get("timestep")), folder / e.get("file")) for e in entries]
    return [t for t, _ in found], [f for _, f in found]


def test_volumes_are_those_of_the_run(run, tmp_path):
    import pyvista

    assert main(["export", str(run / "all.dump"), "-o", str(tmp_path / "vtk")]) == 0
    times, files = series(tmp_path / "vtk", "cells")
    assert times == [0.0, 2.5, 5.0]    # s, of the dump
    for file in files:
        cells = pyvista.read(file)
        data = cells.cell_data
        for cell in (1, 2, 3):
            one = data["cell"] == cell
            surface = cells.extract_cells(one).extract_surface(algorithm="dataset_surface")
            assert surface.n_open_edges == 0 and np.ptp(surface.points, axis=0).max() < 8.5
            # compute dcm/cell: volume, area, pressure, on the center atom, here on all its faces
            assert surface.volume == pytest.approx(data["c_cell[1]"][one][0], rel=1e-6)
            assert data["cell_volume"][one] == pytest.approx(data["c_cell[1]"][one], rel=1e-6)
            assert data["cell_area"][one] == pytest.approx(data["c_cell[2]"][one], rel=1e-6)
            assert data["area"][one].sum() == pytest.approx(data["c_cell[2]"][one][0], rel=1e-6)
            assert data["contact_area"][one].sum() == pytest.approx(
                data["c_cell[4]"][one][0], rel=1e-6, abs=1e-9)
            assert data["cell_pressure"][one] == pytest.approx(data["pressure"][one])
    # faces carry their own stress, nodes their velocity
    assert len(np.unique(data["stress"])) > 10 and "c_cell[1]" not in cells.point_data
    assert np.abs(cells.point_data["velocity"]).max() > 0.0
    spheres = pyvista.read(series(tmp_path / "vtk", "spheres")[1][-1])
    assert spheres["radius"].tolist() == [3.2] and spheres["cell"].tolist() == [4]
    assert spheres["c_cell[1]"] == pytest.approx([4 / 3 * np.pi * 3.2**3])
    assert not (tmp_path / "vtk" / "tracers.pvd").exists()
    assert pyvista.get_reader(tmp_path / "vtk" / "cells.pvd").time_values == times


def test_contact_areas_of_pairs_add_up(run):
    """The first cell touches the second and the sphere, the third nobody. The areas of a cell's
    contacts in the graph add up to what compute dcm/cell says: a contact counts with the same area
    on both faces, and here no face is in contact with two cells."""
    import lammps_dcm

    u = lammps_dcm.load(dump=run / "all.dump")
    graph = lammps_dcm.neighbor_graph(u, -1)
    atoms, data = lammps_dcm.AtomBook(u).frame(), u.trajectory.ts.data
    areas = {int(atoms.mol[k]): data["c_cell[4]"][k] for k in np.flatnonzero(atoms.kind == 2)}
    assert areas[1] > 1.0 and sorted(map(sorted, graph.edges)) == [[1, 2], [1, 4]]
    for cell, area in areas.items():
        total = sum(e["contact_area"] for _, _, e in graph.edges(cell, data=True))
        assert total == pytest.approx(area, rel=1e-6, abs=1e-9)


def test_dump_of_the_manual(lmp, tmp_path):
    """The deck lines of the page howto_paraview, in the deck of first steps."""
    page = (ROOT / "doc" / "howto_paraview.rst").read_text()
    lines = page.partition("Of all atoms::\n")[2].partition("\n*kind*")[0]
    for name in ("face", "cell"):    # the deck has computes of these names
        lines = lines.replace(f"compute       {name} ", f"compute       seen_{name} ")
        lines = lines.replace(f"c_{name}[", f"c_seen_{name}[")
    deck = (ROOT / "doc" / "first_steps" / "in.first_steps").read_text()
    head, rest = deck.split("timestep ", 1)
    result = lmp(f"{head}{lines}\ntimestep {rest}".replace("run             300", "run 100"),
                 vars={"level": 1})
    assert main(["export", str(result.path / "tissue.dump"), "-o", str(tmp_path / "v")]) == 0
    import pyvista

    times, files = series(tmp_path / "v", "cells")
    data = pyvista.read(files[-1]).cell_data
    assert times == [0.0, 100.0]
    assert data["volume"] == pytest.approx(data["cell_volume"], rel=1e-6)
    assert {"contact_area", "stress", "region", "cell_pressure", "velocity"} <= set(data.keys())


def test_times_of_a_dump_without_any(scene, tmp_path, capsys):
    scene.dcm((0, 0, 0), 5.0, level=1)
    (tmp_path / "dump").write_text(scene.frame(0, COLUMNS) + scene.frame(40, COLUMNS)
                                   + scene.frame(90, COLUMNS))
    words = ["export", str(tmp_path / "dump"), "-o", str(tmp_path / "vtk")]
    assert main(words) == 0
    assert "--dt" in capsys.readouterr().out
    assert series(tmp_path / "vtk", "cells")[0] == [0, 40, 90]
    assert main([*words, "--dt", "0.25", "--every", "2"]) == 0
    assert "--dt" not in capsys.readouterr().out
    assert series(tmp_path / "vtk", "cells")[0] == [0, 22.5]
    assert main([*words, "--dt", "0.25", "--frame", "1"]) == 0
    assert series(tmp_path / "vtk", "cells")[0] == [10]


def test_all_files_have_the_same_arrays(scene, tmp_path):
    """A column that is zero at first is on the nodes in all frames; the sphere comes late."""
    import pyvista

    scene.dcm((0, 0, 0), 5.0, level=1)
    scene.cbm((9, 0, 0), 3.0)
    late = lambda r: r["kind"] == 3 and 2.0    # noqa: E731
    text = scene.frame(0, COLUMNS, keep=lambda r: r["kind"] != 1, q=lambda r: 0.0)
    text += scene.frame(1, COLUMNS, q=lambda r: float(late(r)))
    (tmp_path / "dump").write_text(text)
    assert main(["export", str(tmp_path / "dump"), "-o", str(tmp_path / "v")]) == 0
    first, second = map(pyvista.read, series(tmp_path / "v", "cells")[1])
    assert first.array_names == second.array_names and "q" in first.point_data
    assert first["q"].tolist() == [0.0] * 42 and second["q"].tolist() == [2.0] * 42
    times, files = series(tmp_path / "v", "spheres")
    assert times == [0, 1] and [pyvista.read(f).n_points for f in files] == [0, 1]


def test_spheres_as_surfaces(scene, tmp_path):
    import pyvista

    scene.cbm((9, 0, 0), 3.0)
    scene.cbm((0, 0, 0), 2.0)
    (tmp_path / "dump").write_text(scene.frame(0, COLUMNS))
    assert main(["export", str(tmp_path / "dump"), "-o", str(tmp_path / "v"), "--spheres",
                 "glyphs"]) == 0
    made = pyvista.read(series(tmp_path / "v", "spheres")[1][0])
    one = made.points[made["cell"] == 1]
    assert np.linalg.norm(one - [9, 0, 0], axis=1) == pytest.approx(3.0, rel=1e-6)
    assert not (tmp_path / "v" / "cells.pvd").exists()
    # OVITO reads neither appended nor compressed arrays
    text = (tmp_path / "v" / "spheres.00000.vtp").read_text()
    assert "appended" not in text and "compressor" not in text


def test_a_data_file_alone(scene, tmp_path):
    import pyvista

    scene.dcm((0, 0, 0), 5.0, level=1)
    data = scene.data_file(tmp_path / "data")
    assert main(["export", "--data", str(data), "-o", str(tmp_path / "v")]) == 0
    assert pyvista.read(tmp_path / "v" / "cells.00000.vtp").n_cells == 80


@pytest.mark.parametrize("words, says", [
    ("--every 0", "--every"), ("--dt -1", "--dt"), ("--frame 9", "there are 1 frames"),
    ("--rename kind=a,v1=b", "nothing to export"), ("--html p.html --color wine", "--color wine"),
    ("-o dump", "dump")])
def test_messages(words, says, scene, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    scene.dcm((0, 0, 0), 5.0, level=0)
    (tmp_path / "dump").write_text(scene.frame(0, COLUMNS))
    assert main(["export", "dump", *words.split()]) == 1
    assert says in capsys.readouterr().err
    assert not list(tmp_path.glob("*/*.pvd")) and not (tmp_path / "p.html").exists()


# ---------------------------------------------------------------------- in a browser

@pytest.fixture
def page(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=2)
    scene.cbm((9, 0, 0), 4.0)
    (tmp_path / "dump").write_text(scene.frame(0, COLUMNS) + scene.frame(7, COLUMNS))
    path = tmp_path / "page.html"
    assert main(["export", str(tmp_path / "dump"), "--html", str(path), "--color", "type",
                 "--names", "1=hep & co"]) == 0
    return path


def test_page_has_the_scene_and_needs_no_network(page):
    text = page.read_text()
    assert "<title>step 7</title>" in text and "hep &amp; co" in text
    assert not [w for w in ('<script src="http', "<link") if w in text]
    encoded = text.partition('const base64Str = "')[2].partition('"')[0]
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(encoded))) as archive:
        scene = json.loads(archive.read("index.json"))

    def arrays(node):
        points = node.get("properties", {}).get("points")
        found = [points] if points else []
        return found + [a for child in node.get("dependencies", []) for a in arrays(child)]

    sizes = []
    for points in arrays(scene["scene"]):
        content = base64.b64decode(scene["hashes"][points["hash"]]["content"])
        x = np.frombuffer(content, {"Float32Array": "f4", "Float64Array": "f8"}[
            points["dataType"]]).reshape(-1, 3)
        sizes.append(np.round([x[:, 2].min(), x[:, 2].max()], 3).tolist())
    assert [-5.0, 5.0] in sizes and [-4.0, 4.0] in sizes    # the cell, the sphere


@pytest.mark.skipif(not shutil.which("chromium"), reason="no chromium (Debian: chromium)")
def test_browser_draws_the_page(page, tmp_path):
    from matplotlib.image import imread

    picture = tmp_path / "page.png"
    subprocess.run(
        ["chromium", "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--hide-scrollbars", "--window-size=500,400",
         f"--user-data-dir={tmp_path}", "--virtual-time-budget=20000",
         f"--screenshot={picture}", page.as_uri()],
        capture_output=True, timeout=120, check=True)
    pixels = imread(picture)[:, :, :3]
    drawn = pixels.min(axis=2) < 0.8
    drawn[:80, :150] = False    # the legend
    rows, columns = np.nonzero(drawn)
    # from x = -5 to 13, y = -5 to 5
    assert np.ptp(columns) / np.ptp(rows) == pytest.approx(18 / 10, rel=0.05)
