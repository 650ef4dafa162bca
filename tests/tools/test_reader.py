"""Data files and dumps: every column, changing atom counts, damaged files, messages."""
import gzip
import pickle

import numpy as np
import pytest

import lammps_dcm
from lammps_dcm.reader import DCMDumpReader, DumpError, DumpFile
from lammps_dcm.topology import DataFileError, read_data


@pytest.fixture
def pair(scene):
    """A deformable cell of 12 nodes and a sphere."""
    scene.dcm((0, 0, 0), 5.0, level=0)
    scene.cbm((20, 0, 0), 6.0)
    return scene


def write(path, *frames):
    path.write_text("".join(frames))
    return path


@pytest.mark.parametrize("images", [False, True])
def test_data_file(pair, tmp_path, images):
    data = read_data(pair.data_file(tmp_path / "data.x", images=images))
    assert list(data.atoms["id"]) == list(range(1, 35))    # center, 12 nodes, 20 faces, sphere
    assert np.bincount(data.atoms["kind"]).tolist() == [0, 1, 1, 12, 20]
    assert data.sections["Bonds"].shape == (30, 4)
    assert data.sections["Something New"] == [["1", "two", "3"]]
    assert ("ix" in data.atoms) == images
    assert data.box.tolist() == [[-50, 50]] * 3


def test_topology(pair, tmp_path):
    u = lammps_dcm.load(pair.data_file(tmp_path / "data.x"))
    assert u.select_atoms("kind 4").n_atoms == 20
    assert u.select_atoms("prop radius > 5").resids.tolist() == [2]
    assert u.atoms.volumes0[0] == 500.0 and u.atoms.volumes0[1:].sum() == 0.0
    assert u.atoms.types[[0, 1, 13, 33]].tolist() == ["1", "2", "3", "4"]
    assert len(u.bonds) == 30
    assert set(u.bonds[0].atoms.kinds) == {3}
    face = u.atoms[13]
    assert u.atoms.positions[face.vertex_tags - 1].mean(axis=0) == pytest.approx(face.position,
                                                                                 abs=1e-5)
    assert u.trajectory.ts.velocities[:, 0] == pytest.approx(0.5 * np.arange(1, 35))
    assert u.dimensions.tolist() == [100, 100, 100, 90, 90, 90]


def test_every_column_at_its_atom(pair, tmp_path):
    dump = write(tmp_path / "d", pair.frame(0, shuffle=1, c_face=lambda r: r["id"] / 3,
                                            label=lambda r: f"a{r['id']}", vx=lambda r: r["id"],
                                            vy=lambda r: 0.0, vz=lambda r: 1.0),
                 pair.frame(7, shuffle=2, q=lambda r: -r["id"]))
    u = lammps_dcm.load(pair.data_file(tmp_path / "data.x"), dump, dt=2.0)
    ts = u.trajectory[0]
    assert ts.data["c_face"] == pytest.approx(np.arange(1, 35) / 3, rel=1e-15)    # double
    assert ts.data["label"][4] == "a5"
    assert ts.velocities[4].tolist() == [5, 0, 1]
    ts = u.trajectory[1]
    assert ts.data["q"].tolist() == [-k for k in range(1, 35)]
    assert "c_face" not in ts.data and not ts.has_velocities
    assert (ts.data["step"], ts.time, ts.frame) == (7, 14.0, 1)


def test_atoms_come_and_go(pair, tmp_path):
    dump = write(tmp_path / "d", pair.frame(0), pair.frame(1, keep=lambda r: r["id"] <= 5),
                 pair.frame(2, keep=lambda r: r["id"] != 3), pair.frame(3))
    u = lammps_dcm.load(pair.data_file(tmp_path / "data.x"), dump)
    there = [int((~np.isnan(ts.positions[:, 0])).sum()) for ts in u.trajectory]
    assert there == [34, 5, 33, 34]
    assert np.isnan(u.trajectory[2].positions[2]).all()
    assert u.trajectory[2].positions[3] == pytest.approx(u.trajectory[0].positions[3].copy())
    assert np.isnan(u.trajectory[1].data["x"][5:]).all()


def test_cells_born_after_the_data_file(pair, tmp_path):
    data = pair.data_file(tmp_path / "data.x")
    old = len(pair.rows)
    pair.dcm((0, 20, 0), 4.0, level=0)
    columns = "id mol type kind x y z v1 v2 v3 volume0"
    dump = write(tmp_path / "d", pair.frame(0, columns, keep=lambda r: r["id"] <= old),
                 pair.frame(5, columns))
    u = lammps_dcm.load(data, dump)
    assert u.atoms.n_atoms == old + 33
    assert np.isnan(u.trajectory[0].positions[old:]).all()
    assert (u.atoms.kinds[old:] == 4).sum() == 20
    assert set(u.atoms.resids[old:]) == {3}
    assert u.atoms.types[old] == "1" and u.atoms.volumes0[old] == 500.0


def test_dump_alone_and_renamed_columns(pair, tmp_path):
    columns = "id mol type x y z"
    dump = write(tmp_path / "d", pair.frame(0, columns, **{
        "c_k[1]": lambda r: r["kind"], "vertex1": lambda r: r["v1"],
        "vertex2": lambda r: r["v2"], "vertex3": lambda r: r["v3"]}))
    u = lammps_dcm.load(dump=dump, rename={"c_k[1]": "kind"})
    assert np.bincount(u.atoms.kinds).tolist() == [0, 1, 1, 12, 20]
    assert u.atoms.vertices[13].tolist() == [pair.rows[13][v] for v in ("v1", "v2", "v3")]


def test_random_access_equals_sequential(pair, tmp_path):
    dump = write(tmp_path / "d", *[pair.frame(k, shuffle=k, q=lambda r, k=k: k * r["id"])
                                   for k in range(6)])
    u = lammps_dcm.load(pair.data_file(tmp_path / "data.x"), dump)
    sequential = [ts.data["q"].copy() for ts in u.trajectory]
    for k in (5, 0, 3, -2):
        assert (u.trajectory[k].data["q"] == sequential[k]).all()
    assert [ts.frame for ts in u.trajectory[1:5:2]] == [1, 3]
    again = pickle.loads(pickle.dumps(u))
    assert (again.trajectory[4].data["q"] == sequential[4]).all()


def test_scaled_unwrapped_and_triclinic_coordinates(make_scene, tmp_path):
    scene = make_scene(((-10, 10), (0, 40), (5, 6)))
    scene.cbm((0, 0, 0), 1.0)
    text = scene.frame(0, "id type", xs=lambda r: 0.25, ys=lambda r: 0.5, zs=lambda r: 0.1)
    u = lammps_dcm.load(dump=write(tmp_path / "a", text))
    assert u.atoms.positions[0] == pytest.approx([-5, 20, 5.1], abs=1e-5)
    text = scene.frame(0, "id x y z", xu=lambda r: 77.0, yu=lambda r: 1.0, zu=lambda r: 2.0)
    u = lammps_dcm.load(dump=write(tmp_path / "b", text))
    assert u.atoms.positions[0].tolist() == [77, 1, 2]
    # bounds of a box 20 x 40 x 1 with xy = 4, xz = -2, yz = 3: LAMMPS widens x by -2..4, y by 3
    text = scene.frame(0, "id type", xs=lambda r: 0.5, ys=lambda r: 0.5, zs=lambda r: 0.5)
    text = text.replace("BOX BOUNDS pp pp pp\n-10 10\n0 40\n5 6",
                        "BOX BOUNDS xy xz yz pp pp ff\n-12 14 4\n0 43 -2\n5 6 3")
    u = lammps_dcm.load(dump=write(tmp_path / "c", text))
    assert u.atoms.positions[0] == pytest.approx([-10 + 10 + 2 - 1, 20 + 1.5, 5.5], abs=1e-5)
    assert u.trajectory.ts.data["periodic"].tolist() == [True, True, False]
    assert u.dimensions[:3] == pytest.approx([20, np.hypot(4, 40), np.sqrt(4 + 9 + 1)])


@pytest.mark.parametrize("lost", [1, 10, 400])
def test_truncated_last_frame_is_left_out_and_named(pair, tmp_path, lost):
    text = pair.frame(0) + pair.frame(9)
    dump = tmp_path / "d"
    dump.write_text(text[:-lost])
    with pytest.warns(UserWarning, match=r"last frame \(1\) is not complete.*step 9"):
        u = lammps_dcm.load(pair.data_file(tmp_path / "data.x"), dump)
    assert len(u.trajectory) == 1


def test_truncated_header_and_only_frame(pair, tmp_path):
    dump = write(tmp_path / "d", pair.frame(0), "ITEM: TIMESTEP\n9\nITEM: NUM")
    with pytest.warns(UserWarning, match="header is cut short"):
        assert len(DumpFile(dump)) == 1
    dump.write_text(pair.frame(0)[:-30])
    with pytest.raises(DumpError, match="not complete"):
        DumpFile(dump)


def test_frame_damaged_in_the_middle(pair, tmp_path):
    dump = write(tmp_path / "d", pair.frame(0), pair.frame(1)[:-40] + "\n", pair.frame(2))
    u = lammps_dcm.load(pair.data_file(tmp_path / "data.x"), dump)
    with pytest.raises(DumpError, match="frame 1.*cut short or damaged"):
        u.trajectory[1]
    assert u.trajectory[2].data["step"] == 2


def test_gz(pair, tmp_path):
    text = "".join(pair.frame(k, shuffle=k) for k in range(3)).encode()
    (tmp_path / "d.gz").write_bytes(gzip.compress(text))
    u = lammps_dcm.load(pair.data_file(tmp_path / "data.x"), tmp_path / "d.gz")
    assert [ts.data["step"] for ts in u.trajectory] == [0, 1, 2]
    assert u.trajectory[0].positions[33].tolist() == [20, 0, 0]
    packed = gzip.compress(text)
    (tmp_path / "cut.gz").write_bytes(packed[:len(packed) * 3 // 4])
    with pytest.warns(UserWarning):
        assert 1 <= len(DumpFile(tmp_path / "cut.gz")) < 3


def test_frames_across_read_chunks(tmp_path):
    one = "ITEM: TIMESTEP\n0\n" + "x" * 1000 + "\n"
    (tmp_path / "d").write_text(one * 9000)    # 9 MB, chunks of 4 MiB
    from lammps_dcm.reader import find_frames
    with open(tmp_path / "d", "rb") as handle:
        assert find_frames(tmp_path / "d", handle) == [len(one) * k for k in range(9001)]


def test_reader_alone_uses_id_minus_one(pair, tmp_path):
    dump = write(tmp_path / "d", pair.frame(0, keep=lambda r: r["id"] > 30))
    reader = DCMDumpReader(dump)
    assert reader.n_atoms == 34
    assert np.isnan(reader.ts.positions[:30]).all() and not np.isnan(reader.ts.positions[30:]).any()


def test_dump_messages(pair, tmp_path):
    data = pair.data_file(tmp_path / "data.x")
    with pytest.raises(FileNotFoundError, match="no file .*gone.*holds data.x"):
        lammps_dcm.load(data, tmp_path / "gone")
    with pytest.raises(DumpError, match="this is a data file"):
        lammps_dcm.load(data, data)
    with pytest.raises(DumpError, match="no 'ITEM: TIMESTEP': not a text dump"):
        lammps_dcm.load(data, write(tmp_path / "d", "nothing of the kind"))
    with pytest.raises(DumpError, match="no column 'id'"):
        lammps_dcm.load(data, write(tmp_path / "d", pair.frame(0, "type x y z")))
    with pytest.raises(DumpError, match="no coordinates among the columns id type"):
        lammps_dcm.load(data, write(tmp_path / "d", pair.frame(0, "id type")))
    double = pair.frame(0, keep=lambda r: r["id"] in (5, 6)).replace("\n6 ", "\n5 ")
    with pytest.raises(DumpError, match="occurs twice"):
        lammps_dcm.load(data, write(tmp_path / "d", double))
    pair.cbm((30, 0, 0), 1.0)    # born in frame 1 while another one leaves: same count
    frames = [pair.frame(0, keep=lambda r: r["id"] <= 34),
              pair.frame(1, keep=lambda r: r["id"] > 1),
              pair.frame(2, keep=lambda r: r["id"] <= 34)]
    dump = write(tmp_path / "d", *frames)
    with pytest.raises(DumpError, match="35 has no slot.*scan='all'"):
        lammps_dcm.load(data, dump).trajectory[1]
    assert lammps_dcm.load(data, dump, scan="all").atoms.n_atoms == 35


def test_data_messages(pair, tmp_path):
    path = pair.data_file(tmp_path / "data.x")
    text = path.read_text()
    for change, says in (
            (lambda t: t.replace("Atoms # dcm", "Atoms # full"), "style 'full'"),
            (lambda t: t.replace("34 atoms", "35 atoms"), "announces 35 atoms"),
            (lambda t: t.split("Atoms")[0], "no Atoms section.*dump="),
            (lambda t: t.replace("\n34 2 4 1 6 ", "\n34 2 4 1 "), "columns, expected 13"),
            (lambda t: t.replace("\n34 2 4 1 6 ", "\n34 2 4 1 six "), "column radius"),
            (lambda t: t.replace("\n34 2 4 1 6 ", "\n33 2 4 1 6 "), "33 occurs twice")):
        path.write_text(change(text))
        with pytest.raises(DataFileError, match=says):
            read_data(path)


def test_times_that_the_dump_has(tmp_path):
    """`dump_modify time yes` writes each frame's time in front of its step; steps may differ in
    length."""
    path = tmp_path / "t.dump"
    path.write_text("".join(
        f"ITEM: TIME\n{time}\nITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n1\n"
        "ITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\nITEM: ATOMS id mol type x y z\n1 1 4 1 2 3\n"
        for step, time in ((0, 0), (3, 77.5), (4, 137.5))))
    dump = DumpFile(path)
    assert [dump.frame(n).time for n in range(3)] == [0.0, 77.5, 137.5]
    assert [dump.frame(n).step for n in range(3)] == [0, 3, 4]
