"""Which cell an atom belongs to in a frame: IDs that pass from cell to cell, and what is told when
it is not known."""
import warnings

import numpy as np
import pytest

import lammps_dcm

ALL = "id mol type kind x y z v1 v2 v3"


def load(tmp_path, scene, *frames, **options):
    (tmp_path / "dump").write_text("".join(frames))
    return lammps_dcm.load(scene.data_file(tmp_path / "data"), tmp_path / "dump", **options)


def volumes(universe):
    """Per frame a dict of molecule ID -> volume, of the cells that are present."""
    r = lammps_dcm.CellVolume(universe).run().results
    return [{int(c): v for c, v, here in zip(r.cells, row, p) if here}
            for row, p in zip(r.volume, r.present)]


@pytest.fixture
def start(scene):
    """Cells 1 and 2, of 12 nodes: atoms 1 to 33 and 34 to 66."""
    scene.dcm((-10, 0, 0), 5.0, level=0)
    scene.dcm((10, 0, 0), 5.0, level=0)
    return scene


def icosahedron(radius):
    return 5 * (3 + 5**0.5) / 12 * (radius / np.sin(2 * np.pi / 5)) ** 3


def test_ids_pass_to_daughters(start, make_scene, tmp_path):
    """Cells 1 and 2 die, 3 to 5 get their atom IDs: nothing of 1 and 2 remains."""
    later = make_scene()
    for k, radius in enumerate((3.0, 4.0, 6.0)):
        later.dcm((15.0 * k - 15, 0, 0), radius, level=0)
    for r in later.rows:
        r["mol"] += 2
    first, last = volumes(load(tmp_path, start, start.frame(0, ALL), later.frame(1, ALL)))
    assert first == pytest.approx({1: icosahedron(5), 2: icosahedron(5)}, rel=1e-12)
    assert last == pytest.approx({3: icosahedron(3), 4: icosahedron(4), 5: icosahedron(6)})


def test_same_number_of_atoms_but_other_cells(start, make_scene, tmp_path):
    """One dies, one divides: as many atoms, with the same IDs."""
    later = make_scene()
    later.dcm((-10, 0, 0), 3.0, level=0)
    later.dcm((10, 0, 0), 4.0, level=0)
    for r in later.rows:
        r["mol"] += 2
    frames = (start.frame(0, "id mol type x y z"), later.frame(1, "id mol type x y z"))
    with pytest.warns(UserWarning, match="cell 3, 4: the vertices of its faces are not known"):
        first, last = volumes(load(tmp_path, start, *frames))
    assert first == pytest.approx({1: icosahedron(5), 2: icosahedron(5)}, rel=1e-12)
    assert last.keys() == {3, 4} and np.isnan(list(last.values())).all()


@pytest.mark.parametrize("columns", [ALL, "id mol type x y z", "id mol kind x y z"])
def test_conversion_keeps_the_molecule_id(start, make_scene, tmp_path, columns):
    """Cell 1 becomes a sphere that has the atom ID of its center, then deformable again, finer."""
    start.cbm((0, 20, 0), 4.0)    # 3: so that the data file knows the type of spheres
    sphere = make_scene()
    sphere.cbm((-10, 0, 0), 5.0)
    finer = make_scene()
    finer.dcm((-10, 0, 0), 4.0, level=1)
    u = load(tmp_path, start, start.frame(0, columns), sphere.frame(1, columns),
             finer.frame(2, columns), start.frame(3, columns))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = volumes(u)
    assert [set(f) for f in found] == [{1, 2}, set(), {1}, {1, 2}]
    assert found[0][1] == pytest.approx(icosahedron(5)) and found[3][1] == found[0][1]
    if columns == ALL:
        a = lammps_dcm.load(finer.data_file(tmp_path / "finer"))
        assert found[2][1] == lammps_dcm.CellVolume(a).run().results.volume[0, 0]
    else:
        assert np.isnan(found[2][1])


def test_retyped_cell_is_the_same_cell(start, tmp_path):
    """Types 6 to 8 are in no data file; all atoms of the cell have their IDs, so it is known."""
    new = {"type": lambda r: r["type"] + 5 if r["mol"] == 2 else r["type"]}
    u = load(tmp_path, start, start.frame(0, "id mol type x y z"),
             start.frame(1, "id mol x y z", **new))
    r = lammps_dcm.CellPressure(u, {"1": 1.0, "6": 3.0}).run().results
    assert r.volume[1] == pytest.approx([icosahedron(5)] * 2)
    assert r.pressure[1] / r.pressure[0] == pytest.approx([1.0, 3.0])
    with pytest.raises(ValueError, match="no entry for center type 6"):
        lammps_dcm.CellPressure(u, {"1": 1.0}).run()


def test_labels_of_types(start, tmp_path):
    """A data file with labels and a dump with numbers mean the same types."""
    data = start.data_file(tmp_path / "data")
    head, rest = data.read_text().split("Atoms # dcm\n\n")
    label = {"1": "center", "2": "node", "3": "face"}
    body, tail = rest.split("\n\nVelocities")
    lines = [line.split() for line in body.splitlines()]
    body = "\n".join(" ".join([*w[:2], label[w[2]], *w[3:]]) for w in lines)
    named = "Atom Type Labels\n\n" + "".join(f"{k} {v}\n" for k, v in label.items())
    data.write_text(f"{head}{named}4 other\n\nAtoms # dcm\n\n{body}\n\nVelocities{tail}")
    (tmp_path / "dump").write_text(start.frame(0, "id mol type x y z"))
    r = lammps_dcm.CellPressure(lammps_dcm.load(data, tmp_path / "dump"), {"center": 1.0}).run()
    assert np.isfinite(r.results.pressure).all()


def test_births_without_mol_are_an_error(start, tmp_path):
    first = start.frame(0)
    u = load(tmp_path, start, first)
    with pytest.warns(UserWarning, match="no column mol.*add mol"):
        assert set(volumes(u)[0]) == {1, 2}
    data = start.data_file(tmp_path / "data")
    start.dcm((0, 20, 0), 3.0, level=0)
    (tmp_path / "dump").write_text(first + start.frame(1))
    with pytest.warns(UserWarning), pytest.raises(ValueError, match="frame 1: .*atom ID 67 .*mol"):
        volumes(lammps_dcm.load(data, tmp_path / "dump"))
    # an atom ID whose type shows that it is another atom
    (tmp_path / "dump").write_text(start.frame(1, "id x y z", keep=lambda r: r["id"] <= 66,
                                               type=lambda r: 1 if r["id"] == 40 else r["type"]))
    with pytest.raises(ValueError, match="frame 0: .*atom ID 34 .*add mol"):
        volumes(lammps_dcm.load(data, tmp_path / "dump"))


def test_rest_volumes_of_growing_cells(start, make_scene, tmp_path):
    later = make_scene()
    later.dcm((-10, 0, 0), 5.0, level=0)
    later.dcm((10, 0, 0), 5.0, level=0)
    for r in later.rows:
        r["mol"] += 5 * (r["mol"] == 2)
    u = load(tmp_path, start, start.frame(0, ALL), later.frame(1, ALL))
    with pytest.warns(UserWarning, match="cell 7: born after the data file .*column volume0"):
        r = lammps_dcm.CellPressure(u, 1.0).run().results
    assert r.cells.tolist() == [1, 2, 7]
    assert np.isnan(r.pressure).tolist() == [[False, False, True], [False, True, True]]
    assert np.isnan(r.volume).tolist() == [[False, False, True], [False, True, False]]


def test_one_frame_on_the_command_line(start, make_scene, tmp_path, capsys):
    """The frame asked for is searched for atom IDs although it has as many atoms as the first."""
    from lammps_dcm.__main__ import main

    later = make_scene()
    for x in (-10, 0, 10):
        later.dcm((x, 0, 0), 3.0, level=0)
    moved = later.frame(1, ALL, keep=lambda r: r["mol"] > 1)
    data = start.data_file(tmp_path / "data")
    (tmp_path / "dump").write_text(start.frame(0, ALL) + moved + start.frame(2, ALL))
    words = [str(tmp_path / "dump"), "--data", str(data)]
    assert main(["quality", *words, "--frame", "1"]) == 0
    assert [line.split(",")[1] for line in capsys.readouterr().out.splitlines()[1:]] == ["2", "3"]
    assert main(["cells", *words]) == 0
    rows = [line.split(",")[:2] for line in capsys.readouterr().out.splitlines()[1:]]
    assert rows == [["0", "1"], ["0", "2"], ["1", "2"], ["1", "3"], ["2", "1"], ["2", "2"]]
