"""Meshes of other programs: reading, mending, checking, and what LAMMPS makes of them."""
import meshio
import numpy as np
import pytest

from lammps_dcm.__main__ import main
from lammps_dcm.mesh_check import find_faults, measure_surface, pinched_nodes, self_crossings
from lammps_dcm.mesh_convert import repaired
from lammps_dcm.mesh_file import read_surface, write_surface
from support.meshes import cube, icosphere, off


def ball(level=2, half=(5.0, 5.0, 5.0), middle=(3.0, 1.0, -2.0)):
    nodes, faces = icosphere(level)
    return nodes * half + middle, faces


def volume_of(nodes, faces):
    nodes = nodes - nodes[0]
    return sum(np.linalg.det(nodes[f]) for f in faces) / 6


def stl(nodes, faces):
    """Text of an STL file: each face has corners of its own, single precision."""
    out = ["solid cell"]
    for f in faces:
        out += ["facet normal 0 0 0", "outer loop"]
        out += ["vertex " + " ".join(f"{x:.7g}" for x in nodes[i]) for i in f]
        out += ["endloop", "endfacet"]
    return "\n".join([*out, "endsolid cell"]) + "\n"


@pytest.mark.parametrize("ending", ["off", "obj", "stl", "ply", "vtp", "vtk"])
def test_written_and_read(ending, tmp_path):
    nodes, faces = ball()
    write_surface(tmp_path / f"a.{ending}", nodes, faces)
    again, triangles = read_surface(tmp_path / f"a.{ending}")
    assert triangles.shape == (320, 3)
    # STL and PLY are written in single precision
    tolerance = 1e-6 if ending in ("stl", "ply") else 0.0
    assert again[triangles] == pytest.approx(nodes[faces], rel=tolerance, abs=tolerance)


@pytest.mark.parametrize("ending", ["vtu", "msh", "inp"])
def test_what_meshio_reads(ending, tmp_path):
    nodes, faces = ball()
    meshio.write(tmp_path / f"a.{ending}", meshio.Mesh(nodes, [("triangle", faces)]))
    again, triangles = read_surface(tmp_path / f"a.{ending}")
    assert volume_of(again, triangles) == pytest.approx(volume_of(nodes, faces), rel=1e-12)


def test_quads_are_cut(tmp_path):
    (tmp_path / "cube.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x in (0, 2) for y in (0, 2) for z in (0, 2))
        + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")
    nodes, faces, _ = repaired(*read_surface(tmp_path / "cube.obj"))
    assert (nodes.shape, faces.shape) == ((8, 3), (12, 3))
    assert volume_of(nodes, faces) == pytest.approx(8.0) and not find_faults(nodes, faces)


def test_stl_becomes_a_cell(lmp, tmp_path, capsys):
    """STL of an ellipsoid in nm -> convert -> create_cells in lmp: volume and place are those of
    the mesh. 1e-6: the file has seven digits."""
    nodes, faces = ball(3, (7.0, 5.0, 4.0))
    (tmp_path / "cell.stl").write_text(stl(1000.0 * nodes, faces))
    words = ["mesh", "convert", str(tmp_path / "cell.stl"), str(tmp_path / "cell.off")]
    assert main([*words, "--scale", "0.001"]) == 0
    out = capsys.readouterr().out
    assert "merged 3840 nodes to 642" in out
    line = out.splitlines()[-1].replace("NAME", "hep").replace(str(tmp_path) + "/", "")
    deck = f"""units lj
atom_style dcm
boundary s s s
region box block -15 15 -15 15 -15 15
create_box 3 box bond/types 1 dihedral/types 1
mass * 1.0
{line}
fix cell all dcm/cell
compute cell all dcm/cell volume area x y z
dump end all custom 1 end.dump id type c_cell[*]
dump_modify end format float %.15g
comm_modify cutoff 12
run 0
"""
    result = lmp(deck, files={"cell.off": tmp_path / "cell.off"})
    frame = result.dump("end.dump")[-1]
    center = frame["type"] == 1
    volume, area, *place = (frame[f"c_cell[{k}]"][center][0] for k in range(1, 6))
    assert volume == pytest.approx(volume_of(nodes, faces), rel=1e-6)
    measures = measure_surface(nodes, faces)
    assert area == pytest.approx(measures["area"], rel=1e-6)
    assert place == pytest.approx(nodes.mean(axis=0), abs=1e-5)


def test_measures(tmp_path):
    nodes, faces = cube(2)
    m = measure_surface(3.0 * nodes + 7.0, faces)
    assert (m["nodes"], m["faces"]) == (26, 48)
    assert (m["volume"], m["area"]) == (pytest.approx(216.0), pytest.approx(216.0))
    # 48 sides of squares of 3, shared by two, and 24 diagonals
    assert m["mean_edge"] == pytest.approx((48 * 3.0 + 24 * 3.0 * 2**0.5) / 72)
    assert m["size"].tolist() == [6.0] * 3 and m["middle"] == pytest.approx([7.0] * 3)
    assert m["radius"] == pytest.approx((0.75 * 216 / np.pi) ** (1 / 3))
    assert m["reach"] == pytest.approx(3.0 * 3**0.5)
    # half a square: 4 sqrt(3) (s^2/2) / (s^2 + s^2 + 2 s^2)
    assert m["worst"] == m["median"] == pytest.approx(3**0.5 / 2)


def test_mending():
    nodes, faces = ball(1)
    doubled = np.concatenate([nodes[faces].reshape(-1, 3), [[9, 9, 9]]])
    triangles = np.arange(240).reshape(-1, 3)
    triangles[::3] = triangles[::3, ::-1]    # every third the other way round
    triangles = np.concatenate([triangles, triangles[:2], [[0, 0, 1]]])
    made, mended, done = repaired(doubled, triangles)
    assert (made.shape, mended.shape) == ((42, 3), (80, 3))
    assert not find_faults(made, mended)
    assert volume_of(made, mended) == pytest.approx(volume_of(nodes, faces), rel=1e-12)
    assert ["merged 241 nodes to 43", "removed 3 faces"] == [
        done[0], " ".join(done[1].split()[:3])]
    assert any("turned" in d for d in done) and any("no face uses" in d for d in done)


def bad_meshes():
    """Name -> (nodes, faces, words of the message). What LAMMPS says: see the next test."""
    nodes, faces = icosphere(1)
    far = np.concatenate([nodes, 0.5 * nodes + 4.0])
    both = np.concatenate([faces, faces + 42])
    pinched = np.concatenate([nodes, nodes + 2 * nodes[0]])    # mirror images that share node 0
    opposite = 42 + int(np.argmin(((nodes + nodes[0]) ** 2).sum(axis=1)))
    one_node = np.where(faces + 42 == opposite, 0, faces + 42)
    one_node[one_node > opposite] -= 1
    flat = nodes.copy()
    a, b, c = faces[0]
    flat[a] = 0.5 * (flat[b] + flat[c])
    pulled = nodes.copy()
    pulled[0] *= -3.0
    loose = np.concatenate([nodes, [[3.0, 3.0, 3.0]]])
    edge = np.concatenate([faces, [[*faces[0][:2], 42]]])
    twice = np.concatenate([faces, [[1, 1, 2]]])
    cut = np.concatenate([nodes, nodes[:1]])
    split = faces.copy()
    split[np.flatnonzero((faces == 0).any(axis=1))[0]] = np.where(
        faces[np.flatnonzero((faces == 0).any(axis=1))[0]] == 0, 42, faces[
            np.flatnonzero((faces == 0).any(axis=1))[0]])
    inf = nodes.copy()
    inf[3, 1] = np.inf
    return {
        "sound": (nodes, faces, None),
        "open": (nodes, faces[:-1], "the surface is open: 3 edges"),
        "one turned": (nodes, np.concatenate([faces[:-1], faces[-1:, ::-1]]), "not oriented alike"),
        "inside out": (nodes, faces[:, ::-1], "inside out"),
        "two parts": (far, both, "has 2 components"),
        "pinched": (np.delete(pinched, opposite, axis=0), np.concatenate([faces, one_node]),
                    "touches itself at 1 node"),
        "flat face": (flat, faces, "degenerate"),
        "through itself": (pulled, faces, "runs through itself"),
        "unused node": (loose, faces, "1 nodes are in no face"),
        "edge of three": (loose, edge, "not a manifold"),
        "node twice": (nodes, twice, "1 faces name a node twice"),
        "doubled node": (cut, split, "in the same place"),
        "not finite": (inf, faces, "not finite"),
        "torus": (*torus(), "1 handle"),
    }


def torus(n=12, m=8):
    u, v = np.meshgrid(2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m, indexing="ij")
    r = 3.0 + np.cos(v)
    nodes = np.stack([r * np.cos(u), r * np.sin(u), np.sin(v)], axis=-1).reshape(-1, 3)
    at = lambda i, j: (i % n) * m + j % m    # noqa: E731
    faces = [t for i in range(n) for j in range(m) for t in (
        (at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))]
    return nodes, np.array(faces)


@pytest.mark.parametrize("name", bad_meshes())
def test_faults_are_those_of_create_cells(name, lmp, tmp_path):
    """Whatever LAMMPS refuses the check names, and nothing else."""
    nodes, faces, says = bad_meshes()[name]
    faults = find_faults(nodes, faces)
    assert (not faults) if says is None else any(says in fault for fault in faults), faults
    deck = ("units lj\natom_style dcm\nregion box block -15 15 -15 15 -15 15\n"
            "create_box 3 box bond/types 1 dihedral/types 1\n"
            "create_cells single hep dcm 0 0 0 3 dcm hep 1 2 3 1 1 mesh file m.off\n")
    result = lmp.run(deck, files={"m.off": off(nodes, faces)})
    assert (result.returncode == 0) == (not faults), result.tail()
    assert ("Create_cells" in result.error) == bool(faults)


def test_crossings_against_all_pairs():
    """Two tetrahedra through each other, and a mesh of 320 faces of which a part is pushed
    through the rest: the sweep finds what a loop over all pairs finds."""
    nodes, faces = icosphere(2)
    pushed = nodes.copy()
    pushed[nodes[:, 0] > 0.8] -= [2.2, 0.1, 0.2]

    def pierced(p, q, t):
        a, b, c = pushed[t]
        m = np.array([q - p, a - b, a - c]).T
        if abs(np.linalg.det(m)) < 1e-12:
            return False
        s, u, v = np.linalg.solve(m, a - p)
        return 0 < s < 1 and u > 0 and v > 0 and u + v < 1

    found = []
    for i in range(len(faces)):
        for j in range(i):
            for f, g in ((faces[i], faces[j]), (faces[j], faces[i])):
                sides = [(f[k], f[k - 1]) for k in range(3)]
                if any(p not in g and q not in g and pierced(pushed[p], pushed[q], g)
                       for p, q in sides):
                    found.append((j, i))
    assert len(found) > 10
    assert self_crossings(pushed, faces).tolist() == sorted(map(list, set(found)))
    assert not len(self_crossings(nodes, faces)) and not len(pinched_nodes(faces))


def test_remeshing(tmp_path, capsys):
    """A UV sphere, 30 edges at its poles, to 162 nodes: the volume stays, triangles are good."""
    import pyvista

    pyvista.Sphere(radius=5.0).save(tmp_path / "uv.stl")
    before = volume_of(*repaired(*read_surface(tmp_path / "uv.stl"))[:2])
    out = tmp_path / "uv.obj"
    assert main(["mesh", "convert", str(tmp_path / "uv.stl"), str(out)]) == 0
    assert "warning: nodes have" in capsys.readouterr().out
    assert main(["mesh", "convert", str(tmp_path / "uv.stl"), str(out), "--nodes", "162"]) == 0
    assert "warning" not in capsys.readouterr().out
    nodes, faces = read_surface(out)
    assert not find_faults(nodes, faces)
    measures = measure_surface(nodes, faces)
    assert measures["nodes"] == pytest.approx(162, abs=8)
    assert measures["volume"] == pytest.approx(before, rel=1e-9)
    assert measures["worst"] > 0.5 and measures["valence"][1] <= 8


def test_the_largest_part(tmp_path, capsys):
    nodes, faces, _ = bad_meshes()["two parts"]
    write_surface(tmp_path / "two.ply", nodes, faces)
    words = ["mesh", "convert", str(tmp_path / "two.ply"), str(tmp_path / "one.off")]
    assert main(words) == 1
    assert "--largest" in capsys.readouterr().err
    assert not (tmp_path / "one.off").exists()
    assert main([*words, "--largest"]) == 0
    assert len(read_surface(tmp_path / "one.off")[0]) == 42


def test_check_command(tmp_path, capsys):
    good, bad = tmp_path / "good.off", tmp_path / "bad.off"
    good.write_text(off(*ball()))
    bad.write_text(off(*bad_meshes()["open"][:2]))
    assert main(["mesh", "check", str(good)]) == 0
    assert "good.off: sound" in capsys.readouterr().out
    assert main(["mesh", "check", str(good), str(bad), str(tmp_path / "gone.off")]) == 1
    out, err = capsys.readouterr()
    assert "bad.off: cannot be a cell" in out and "gone.off: cannot be a cell" in out
    assert "2 of 3 files" in err


@pytest.mark.parametrize("name, text, says", [
    ("a.off", "OFF\n3 1", "a.off"), ("a.stl", "solid x\n", "a.stl"), ("a.vtp", "<VTK", "a.vtp"),
    ("a.xyz", "1 2 3", "'.xyz'"), ("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty "
     "float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n", "a.ply"),
    ("a.obj", "v 0 0 0\nv 1 0 0\n", "a.obj")])
def test_files_that_cannot_be_read(name, text, says, tmp_path, capsys):
    (tmp_path / name).write_text(text)
    assert main(["mesh", "convert", str(tmp_path / name), str(tmp_path / "o.off")]) == 1
    assert says in capsys.readouterr().err
    assert not (tmp_path / "o.off").exists()


@pytest.mark.parametrize("words, says", [
    ("gone.stl o.off", "no file gone.stl"), ("a.off o.xyz", "o.xyz"), ("a.off o", "must end in"),
    ("a.off o.off --scale 0", "--scale"), ("a.off o.off --scale nan", "--scale"),
    ("a.off o.off --nodes 5", "12 or more")])
def test_bad_words(words, says, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.off").write_text(off(*ball()))
    assert main(["mesh", "convert", *words.split()]) == 1
    assert says in capsys.readouterr().err
    assert not (tmp_path / "o.off").exists()
