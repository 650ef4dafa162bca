"""Cells as objects of pyvista, trimesh and networkx."""
import numpy as np
import pytest

import lammps_dcm
from support.meshes import icosphere

COLUMNS = "id mol type kind radius x y z v1 v2 v3 region volume0"


def ideal_volume(shape, level=2):
    """Volume of an icosphere stretched to half-axes `shape`, from its tetrahedra."""
    nodes, faces = icosphere(level)
    nodes = nodes * np.broadcast_to(shape, 3)
    return sum(np.linalg.det(nodes[f]) for f in faces) / 6


@pytest.fixture
def tissue(scene, tmp_path):
    """Two deformable cells, the second across the border of the box, a sphere and a tracer."""
    scene.dcm((0, 0, 0), 5.0, level=2, volume0=520.0)
    scene.dcm((49, 48, -50), (6.0, 5.0, 4.0), level=2, volume0=500.0)
    scene.cbm((0, 9, 0), 4.0)
    scene.add(0, 4, 5, 0.1, (1, 2, 30))
    only = lambda kind, value: lambda r: value(r) if r["kind"] == kind else 0.0    # noqa: E731
    (tmp_path / "dump").write_text(scene.frame(
        40, COLUMNS, wrap=True, contact_area=only(4, lambda r: r["id"]),
        pressure=only(2, lambda r: 0.25 * r["mol"]), charge=only(3, lambda r: -r["id"]),
        vx=lambda r: 1.0, vy=lambda r: 2.0, vz=lambda r: float(r["id"]), none=lambda r: 0.0))
    return lammps_dcm.load(dump=tmp_path / "dump", dt=0.5)


def test_pyvista_has_everything_where_it_belongs(tissue, scene):
    blocks = lammps_dcm.to_pyvista(tissue, 0)
    cells, spheres, tracers = (blocks[name] for name in ("cells", "spheres", "tracers"))
    assert (cells.n_points, cells.n_cells) == (2 * 162, 2 * 320)
    assert cells.points.dtype == np.float64
    row = {r["id"]: r for r in scene.rows}
    data = cells.cell_data
    assert data["contact_area"].tolist() == data["face"].tolist()
    assert all(row[f]["mol"] == c for f, c in zip(data["face"], data["cell"]))
    assert data["pressure"] == pytest.approx(0.25 * data["cell"])    # of the centers
    assert data["cell_pressure"] == pytest.approx(0.25 * data["cell"])
    assert data["volume0"] == pytest.approx(np.where(data["cell"] == 1, 520.0, 500.0))
    assert set(data["type"]) == {1} and set(data["region"]) == {0}
    points = cells.point_data
    assert points["charge"].tolist() == (-points["node"]).tolist()
    assert points["velocity"].shape == (324, 3)
    assert points["velocity"][:, 2] == pytest.approx(points["node"])
    assert "charge" not in data and "pressure" not in points and "contact_area" not in points
    assert (data["none"] == 0.0).all()    # an empty column is there, and on the faces
    assert cells.field_data["step"][0] == 40 and cells.field_data["TimeValue"][0] == 20.0
    # the triangle of each face joins the nodes it names
    corners = points["node"][cells.faces.reshape(-1, 4)[:, 1:]]
    assert all(corner.tolist() == [row[f][v] for v in ("v1", "v2", "v3")]
               for f, corner in zip(data["face"], corners))
    assert spheres.points.tolist() == [[0, 9, 0]] and spheres["radius"].tolist() == [4.0]
    assert spheres["cell"].tolist() == [3]
    assert tracers.points == pytest.approx(np.array([[1, 2, 30]]))


def test_cells_are_whole_across_periodic_borders(tissue):
    cells = lammps_dcm.to_pyvista(tissue)["cells"]
    volume = {1: ideal_volume(5.0), 2: ideal_volume((6, 5, 4))}
    for cell, expected in volume.items():
        one = cells.extract_cells(cells.cell_data["cell"] == cell).extract_surface(
            algorithm="dataset_surface")
        assert one.n_open_edges == 0 and one.volume == pytest.approx(expected, rel=1e-6)
        assert cells.cell_data["cell_volume"][cells.cell_data["cell"] == cell] == pytest.approx(
            expected, rel=1e-12)
        assert np.ptp(one.points, axis=0).max() < 12.01    # not torn over the box of 100 um


def test_a_mesh_gives_the_same_as_its_universe(tissue):
    from lammps_dcm.mesh import Mesh

    a = lammps_dcm.to_pyvista(tissue, 0)["cells"]
    b = lammps_dcm.to_pyvista(Mesh(lammps_dcm.AtomBook(tissue).frame()))["cells"]
    assert a == b


def test_pressure_from_the_modulus(tissue):
    data = lammps_dcm.to_pyvista(tissue, bulk_modulus=2.5)["cells"].cell_data
    rest = np.where(data["cell"] == 1, 520.0, 500.0)
    assert data["cell_pressure"] == pytest.approx(2.5 * np.log(rest / data["cell_volume"]))


def test_trimesh(tissue):
    found = lammps_dcm.to_trimesh(tissue, 0)
    assert sorted(found) == [1, 2]
    for cell, expected in ((1, ideal_volume(5.0)), (2, ideal_volume((6, 5, 4)))):
        assert found[cell].is_watertight and found[cell].is_winding_consistent
        assert found[cell].volume == pytest.approx(expected, rel=1e-12)
        assert found[cell].metadata["cell"] == cell
        assert len(found[cell].metadata["faces"]) == 320


def test_types_with_labels(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=0, type=1)
    text = scene.frame(0, "id mol kind x y z v1 v2 v3",
                       type=lambda r: {1: "hep", 2: "node", 3: "face"}[r["type"]])
    (tmp_path / "dump").write_text(text)
    cells = lammps_dcm.to_pyvista(lammps_dcm.load(dump=tmp_path / "dump"))["cells"]
    assert set(cells.cell_data["type"]) == {2}    # face hep node: the order of the alphabet


@pytest.fixture
def row_of_cells(scene, tmp_path):
    """Two cells and a sphere in a row along x, with caps in contact, and a sphere far away."""
    for x in (-5.05, 5.05):
        scene.dcm((x, 0, 0), 5.0, level=3)
    scene.cbm((13.9, 0, 0), 3.8)
    scene.cbm((0, 40, 0), 4.0)

    def area(r):
        if r["kind"] != 4:
            return 0.0
        between, outer = abs(r["x"]) < 0.5, r["x"] > 9.6
        return (0.3 if r["mol"] == 1 else 0.1) * between + 0.2 * outer

    (tmp_path / "dump").write_text(scene.frame(3, COLUMNS, contact_area=area))
    faces = [r for r in scene.rows if r["kind"] == 4]
    caps = [sum(r["mol"] == 1 and abs(r["x"]) < 0.5 for r in faces),
            sum(r["mol"] == 2 and abs(r["x"]) < 0.5 for r in faces),
            sum(r["x"] > 9.6 for r in faces)]
    assert min(caps) > 3
    return lammps_dcm.load(dump=tmp_path / "dump"), caps


def test_neighbor_graph_with_areas(row_of_cells):
    u, (left, right, outer) = row_of_cells
    graph = lammps_dcm.neighbor_graph(u, 0)
    assert sorted(graph.nodes) == [1, 2, 3, 4]
    assert [graph.nodes[n]["kind"] for n in (1, 2, 3, 4)] == ["dcm", "dcm", "cbm", "cbm"]
    assert sorted(map(sorted, graph.edges)) == [[1, 2], [2, 3]]
    # the mean of both sides; of the faces alone next to a sphere
    assert graph.edges[1, 2]["contact_area"] == pytest.approx(0.5 * (0.3 * left + 0.1 * right))
    assert graph.edges[2, 3]["contact_area"] == pytest.approx(0.2 * outer)
    assert graph.nodes[1]["center"] == pytest.approx([-5.05, 0, 0], abs=1e-9)
    assert graph.graph["step"] == 3


def test_neighbor_graph_by_distance(row_of_cells):
    u, _ = row_of_cells
    graph = lammps_dcm.neighbor_graph(u, column="not there")
    assert sorted(map(sorted, graph.edges)) == [[1, 2], [2, 3]]
    assert np.isnan(graph.edges[1, 2]["contact_area"])
    assert not lammps_dcm.neighbor_graph(u, column="not there", cutoff=0.05).edges


def pairs(step, names, *rows):
    """A frame of a `dump local`."""
    return (f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ENTRIES\n{len(rows)}\n"
            "ITEM: BOX BOUNDS ss ss ss\n-50 50\n-50 50\n-50 50\n"
            f"ITEM: ENTRIES {names}\n" + "".join(f"{row} \n" for row in rows))


def test_neighbor_graph_of_recorded_contacts(row_of_cells, tmp_path):
    u, _ = row_of_cells
    path, names = tmp_path / "contacts", "molecule1 molecule2 area fx"
    path.write_text(pairs(0, names) + pairs(3, names, "1 2 4.5 -0.25", "1 3 0 0.5", "3 4 2 1"))
    graph = lammps_dcm.neighbor_graph(u, 0, contacts=path)
    assert sorted(graph.nodes) == [1, 2, 3, 4]    # those that touch nothing as well
    assert {tuple(sorted(e)): graph.edges[e] for e in graph.edges} == {
        (1, 2): {"contact_area": 4.5, "fx": -0.25}, (3, 4): {"contact_area": 2.0, "fx": 1.0}}


@pytest.mark.parametrize("text, words", [
    (pairs(0, "molecule1 molecule2 area"), "no step 3: dump atoms and contacts"),
    (pairs(3, "c_c[1] c_c[2] area", "1 2 3"), "no column molecule1, molecule2: .*colname"),
    (pairs(3, "molecule1 molecule2 area", "1 2 3", "1 2")[:-2], "not complete|cut short")])
def test_recorded_contacts_that_do_not_fit(row_of_cells, tmp_path, text, words):
    u, _ = row_of_cells
    (tmp_path / "contacts").write_text(text)
    with pytest.raises(ValueError, match=words):
        lammps_dcm.neighbor_graph(u, 0, contacts=tmp_path / "contacts")


def test_area_far_from_any_cell_is_told(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0, level=2)
    (tmp_path / "dump").write_text(scene.frame(0, COLUMNS, contact_area=lambda r: 1.0))
    u = lammps_dcm.load(dump=tmp_path / "dump")
    with pytest.warns(UserWarning, match="320 of 320 um.2 of contact area"):
        assert not lammps_dcm.neighbor_graph(u).edges
