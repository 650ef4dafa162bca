"""create_cells with meshes at their own size and place: files, folders, tables; what is refused."""

import numpy as np
import pytest

from support.bad_decks import fails, whole
from support.meshes import cube, icosphere, off
from support.parameters import CORTEX

# three cells of different meshes that touch nowhere, one of them far from round
BALL, BRICK = icosphere(2), cube(4)
CELLS = {
    "a.off": (5.0 * BALL[0] + [-8.0, 0.0, 1.0], BALL[1]),
    "b.off": (BRICK[0] * [3.0, 5.0, 7.0] + [2.0, 0.5, 0.0], BRICK[1]),
    "c.obj": (4.0 * icosphere(1)[0] + [10.0, 0.0, 0.0], icosphere(1)[1]),
}
TYPES = "dcm hep 1 2 3 1 1"
SEEN = (
    "write_dump all custom d.txt id mol type xu yu zu modify sort id format float %.17g\n"
    "compute cells all dcm/cell volume volume0\n"
)


def obj(nodes, faces):
    rows = ["v " + " ".join(f"{x:.17g}" for x in node) for node in nodes]
    return "\n".join(rows + ["f {} {} {}".format(*(np.array(f) + 1)) for f in faces]) + "\n"


def text(name, mesh):
    return obj(*mesh) if name.endswith(".obj") else off(*mesh)


def volume(nodes, faces):
    a, b, c = (nodes[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij", a, np.cross(b, c)) / 6


@pytest.fixture
def folder(lmp):
    """Folder `cells` in that of the run, with the meshes and a file that is none."""
    path = lmp.folder / "given" / "cells"
    path.mkdir(parents=True)
    for name, mesh in CELLS.items():
        (path / name).write_text(text(name, mesh))
    (path / "notes.txt").write_text("of the microscope\n")
    return path


def scene_of(scenes, command, boundary="f f f", box=20.0):
    scene = scenes.Scene(box=box, boundary=boundary)
    scene.cells = [command]
    return scene


def table(path):
    """A table with the cells of the folder in the order of their names, moved to two places."""
    return (
        f"hep dcm 1 0 0 {path}/a.off\nhep dcm 1 0 0 {path}/b.off    # a brick\n"
        f"hep dcm 1 0 0 {path}/c.obj\n"
    )


@pytest.mark.parametrize("ranks", [1, 2, 4])
@pytest.mark.parametrize("how", ["folder", "files", "table", "scale none"])
def test_where_the_files_have_them(lmp, scenes, folder, how, ranks):
    """All nodes where the files have them, moved by 1 along x, on any number of processes and in
    whatever way they are named; one cell a file, in the order of their names, all tags in a row."""
    names = " ".join(f"{folder}/{name}" for name in CELLS)
    command = {
        "folder": f"create_cells meshes hep 1 0 0 {folder} {TYPES}",
        "files": f"create_cells meshes hep 1 0 0 {names} {TYPES}",
        "table": f"create_cells table cells.txt {TYPES}",
        "scale none": "\n".join(
            f"create_cells single hep dcm 1 0 0 0 {TYPES} mesh file {folder}/{name} scale none"
            for name in CELLS
        ),
    }[how]
    result = lmp(
        scene_of(scenes, command).head() + SEEN, np=ranks, files={"cells.txt": table(folder)}
    )
    frame = result.dump("d.txt")[0]
    first = 1
    for n, (nodes, faces) in enumerate(CELLS.values(), 1):
        mine = frame["mol"] == n
        size = 1 + len(nodes) + len(faces)
        assert frame["id"][mine].tolist() == list(range(first, first + size))
        first += size
        place = nodes + [1.0, 0.0, 0.0]
        middle, faces = place.mean(axis=0), place[np.array(faces)].mean(axis=1)
        for type, expected in ((1, middle[None]), (2, place), (3, faces)):
            assert frame.x[mine & (frame["type"] == type)] == pytest.approx(expected, abs=1e-12)
    assert first - 1 == len(frame["id"])
    if how != "scale none":
        counts = sorted(len(nodes) for nodes, _ in CELLS.values())
        nodes = f"{counts[0]} to {counts[-1]} nodes"
        assert f"Created 3 deformable cells of {nodes} and 0 center-based" in result.log


@pytest.mark.parametrize("ranks", [1, 4])
def test_through_a_periodic_border(lmp, scenes, folder, ranks):
    """Cells that stick out of the box are whole in unwrapped coordinates."""
    command = f"create_cells meshes hep 14 -13 12 {folder} {TYPES}"
    scene = scene_of(scenes, command, boundary="p p p", box=(20.0, 15.0, 16.0))
    deck = whole(scene, extra=SEEN + "thermo_style custom step c_cells[1]\n") + "run 0\n"
    frame = lmp(deck, np=ranks).dump("d.txt")[0]
    for n, (nodes, _) in enumerate(CELLS.values(), 1):
        moved = frame.x[(frame["mol"] == n) & (frame["type"] == 2)] - nodes
        # all nodes by the same way, which is the given one but for box lengths
        assert moved == pytest.approx(np.broadcast_to(moved[0], moved.shape), abs=1e-9)
        turns = (moved[0] - [14.0, -13.0, 12.0]) / [40.0, 30.0, 32.0]
        assert turns == pytest.approx(np.rint(turns), abs=1e-12)


def test_state_of_rest(lmp, scenes, folder):
    """Rest volumes are those of the meshes, so that cells start without pressure, and rest lengths
    the given part of the edges: springs k have the energy k/2 (1 - rest)^2 times their squares."""
    command = f"create_cells meshes hep 0 0 0 {folder} {TYPES} rest 0.9"
    deck = whole(
        scene_of(scenes, command),
        extra="compute cells all dcm/cell volume volume0 pressure\n"
        "dump d all custom 1 v.txt id type c_cells[*]\ndump_modify d format float %.17g\n"
        "thermo_style custom step ebond\nthermo_modify norm no format float %.17g\n",
    )
    result = lmp(deck + "run 0\n")
    frame = result.dump("v.txt")[0]
    centers = frame["type"] == 1
    expected = [volume(nodes, np.array(faces)) for nodes, faces in CELLS.values()]
    for column in ("c_cells[1]", "c_cells[2]"):
        assert frame[column][centers] == pytest.approx(expected, rel=1e-12)
    assert frame["c_cells[3]"][centers] == pytest.approx(0.0, abs=1e-9)
    squares = 0.0
    for nodes, faces in CELLS.values():
        edges = np.sort(np.array(faces)[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        edges = np.unique(edges, axis=0)
        squares += ((nodes[edges[:, 0]] - nodes[edges[:, 1]]) ** 2).sum()
    k = 2 / np.sqrt(3) * CORTEX["E_cor"] * CORTEX["h_cor"]
    assert result.thermo[0]["E_bond"] == pytest.approx(k / 2 * 0.1**2 * squares, rel=1e-9)


def open_mesh():
    nodes, faces = CELLS["b.off"]
    return nodes, faces[:-1]


def inside_out():
    nodes, faces = CELLS["b.off"]
    return nodes, np.array(faces)[:, ::-1]


def one_flipped():
    nodes, faces = CELLS["b.off"]
    faces = np.array(faces)
    faces[3] = faces[3, ::-1]
    return nodes, faces


def crossing():
    """One node of the ball pulled through the other side."""
    nodes, faces = CELLS["a.off"]
    nodes = np.array(nodes)
    middle = nodes.mean(axis=0)
    nodes[7] = middle - 1.5 * (nodes[7] - middle)
    return nodes, faces


def two_parts():
    nodes, faces = CELLS["b.off"]
    return np.vstack([nodes, nodes + 12.0]), np.vstack([faces, np.array(faces) + len(nodes)])


BAD = {
    "open": (open_mesh, "bad mesh .*bad.off of cell 2: the surface is open", "face"),
    "inside out": (inside_out, "bad.off of cell 2: the mesh is inside out", "flip all faces"),
    "one face flipped": (one_flipped, "bad.off of cell 2: .*not oriented alike", "flip one"),
    "through itself": (crossing, "bad.off of cell 2: the surface runs through itself at faces"),
    "two parts": (two_parts, "bad.off of cell 2: the mesh has more than one component"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_mesh_among_good_ones(lmp, scenes, folder, case):
    make, *patterns = BAD[case]
    (folder / "bad.off").write_text(off(*make()))
    command = f"create_cells meshes hep 0 0 0 {folder}/c.obj {folder}/bad.off {TYPES}"
    fails(lmp, whole(scene_of(scenes, command)), *patterns)


def test_all_bad_files_are_named(lmp, scenes, folder):
    (folder / "bad.off").write_text(off(*open_mesh()))
    (folder / "d.off").write_text("OFF\n3 1")
    command = f"create_cells meshes hep 0 0 0 {folder} none.off {TYPES}"
    fails(lmp, whole(scene_of(scenes, command)), "bad mesh .*bad.off of cell 3",
          "bad are also 2 more: .*d.off none.off")  # fmt: skip


def test_overlap(lmp, scenes, folder):
    """A ball reaches 0.6 um into a brick: that is what the error says, and more than it may; what
    may overlap is what the keyword says."""
    deep = "".join(f"{folder}/{name} " for name in ("a.off", "b.off"))
    nodes, faces = CELLS["a.off"]
    nodes = nodes + [-1.0 + 0.6 - nodes[:, 0].max(), 0.0, 0.0]    # the brick begins at -1
    (folder / "a.off").write_text(off(nodes, faces))
    command = f"create_cells meshes hep 0 0 0 {deep} {TYPES}"
    result = fails(lmp, whole(scene_of(scenes, command)), r"cell 1 \(.*a.off\) is [\d.]+ deep",
                   r"inside cell 2 \(.*b.off\), more than", "mend the meshes|overlap")  # fmt: skip
    depth = float(result.error.split(" is ")[1].split()[0])
    assert depth == pytest.approx(0.6, abs=1e-3)
    lmp(scene_of(scenes, command + f" overlap {depth + 0.01}").head())
    fails(lmp, whole(scene_of(scenes, command + f" overlap {depth - 0.01}")), "deep", "more than")


@pytest.mark.parametrize("ranks", [1, 3])
def test_overlap_through_a_periodic_border(lmp, scenes, folder, ranks):
    """Two copies of a ball, a box length less 9 um apart: 1 um of them overlaps at the border."""
    nodes, faces = BALL
    for name, x in (("e.off", -5.5), ("f.off", 5.5)):
        (folder / name).write_text(off(5.0 * nodes + [x, 0.0, 0.0], faces))
    command = f"create_cells meshes hep 0 0 0 {folder}/e.off {folder}/f.off {TYPES}"
    fails(lmp, whole(scene_of(scenes, command, boundary="p p p", box=10.0)),
          r"cell \d \(.*\) is [\d.]+ deep.* inside cell", np=ranks)  # fmt: skip
    lmp(scene_of(scenes, command, boundary="f f f", box=20.0).head(), np=ranks)


def test_twice_the_same(lmp, scenes, folder):
    """Surfaces that coincide have no node inside each other, and are refused all the same."""
    command = f"create_cells meshes hep 0 0 0 {folder}/c.obj {folder}/c.obj {TYPES}"
    fails(lmp, whole(scene_of(scenes, command)), "cell [12] .*deep inside cell [12]")


OTHER = {
    "outside": (f"meshes hep 0 0 12 {{folder}} {TYPES}",
                r"cell \d \(.*\): node \d+ at .* outside the box", "enlarge the box or move"),
    "no meshes": (f"meshes hep 0 0 0 empty {TYPES}", "folder empty has no mesh", "off or .obj"),
    "unknown kind": (f"meshes hep 0 0 0 x.stl {TYPES}", "x.stl is of unknown kind"),
    "rotate": (f"meshes hep 0 0 0 {{folder}} {TYPES} rotate 3", "remove keyword rotate"),
    "scale": (f"meshes hep 0 0 0 {{folder}} {TYPES} scale volume", "remove keyword scale"),
    "mesh": (f"meshes hep 0 0 0 {{folder}} {TYPES} mesh icosphere 2", "remove keyword mesh"),
    "place": (f"meshes hep 0 0 {{folder}} a.off {TYPES}", "is not a number"),
    "no path": (f"meshes hep 0 0 0 {TYPES}", "name mesh files, or folders"),
    "icosphere of no size": (f"single hep dcm 0 0 0 6 {TYPES} scale none", "add 'mesh file PATH'"),
    "turned": (f"single hep dcm 0 0 0 0 {TYPES} mesh file {{folder}}/a.off scale none rotate 1",
               "remove keyword rotate"),
    "no types": ("meshes hep 0 0 0 {folder} dcm other 1 2 3 1 1", "no atom types for deformable"),
    "sphere": (f"single hep cbm 0 0 0 {{folder}}/a.off {TYPES}", "is not a number"),
    "overlap": (f"meshes hep 0 0 0 {{folder}} {TYPES} overlap 0", "overlap is 0", "positive"),
}  # fmt: skip


@pytest.mark.parametrize("case", OTHER)
def test_refused(lmp, scenes, folder, case):
    command, *patterns = OTHER[case]
    scene = scene_of(scenes, "shell mkdir empty\ncreate_cells " + command.format(folder=folder),
                     box=(20.0, 20.0, 13.0))  # fmt: skip
    fails(lmp, whole(scene), "[Cc]reate_cells", *patterns)
