"""Bad meshes and arguments of create_cells: one error that names value and remedy; files stay."""

import numpy as np
import pytest

from support.bad_decks import fails, whole

# --- meshes ---------------------------------------------------------------------------------------


def octahedron():
    nodes = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [
        (0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5),
    ]  # fmt: skip
    return nodes, faces


def off(nodes, faces):
    return (
        f"OFF\n{len(nodes)} {len(faces)} 0\n"
        + "".join(f"{x} {y} {z}\n" for x, y, z in nodes)
        + "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)
    )


def bad_meshes():
    nodes, faces = octahedron()
    two = [(x + 5, y, z) for x, y, z in nodes]
    pinched = nodes + [(x + 2, y, z) for i, (x, y, z) in enumerate(nodes) if i != 1]
    new = {1: 0, **{i: 6 + n for n, i in enumerate(i for i in range(6) if i != 1)}}
    text = off(nodes, faces)
    return {
        "open": (off(nodes, faces[:-1]), "open|one face|border"),
        "one face flipped": (off(nodes, faces[:-1] + [faces[-1][::-1]]), "flip"),
        "all faces flipped": (off(nodes, [f[::-1] for f in faces]), "inside out.*flip"),
        "edge of three faces": (off(nodes + [(2, 2, 2)], faces + [(0, 2, 6)]), "face|edge"),
        "touching at a node": (
            off(pinched, faces + [tuple(new[i] for i in f) for f in faces]),
            "manifold|touch",
        ),
        "two components": (
            off(nodes + two, faces + [tuple(i + 6 for i in f) for f in faces]),
            "component",
        ),
        "flat face": (off(nodes[:4] + [(0.5, 0.5, 0.0)] + nodes[5:], faces), "degenerate"),
        "node twice in a face": (off(nodes, faces[:-1] + [(0, 0, 5)]), "face"),
        "unused node": (off(nodes + [(3, 3, 3)], faces), "node"),
        "index too large": (off(nodes, faces[:-1] + [(0, 3, 6)]), "index 6"),
        "truncated in nodes": ("\n".join(text.splitlines()[:5]), "truncated"),
        "truncated in faces": ("\n".join(text.splitlines()[:12]), "truncated"),
        "empty": ("", "empty"),
        "text": (text.replace("1 0 0", "one 0 0", 1), "'one' is not a finite number"),
        "nan": (text.replace("1 0 0", "nan 0 0", 1), "'nan' is not a finite number"),
        "no OFF": (text.replace("OFF", "FFO"), "OFF"),
    }


def through_itself():
    """An octahedron whose top is pulled out below its bottom: closed, of positive volume."""
    nodes, faces = octahedron()
    nodes = [*nodes, (0.3, 0.3, 0.9)]
    a, b, c = faces[0]
    faces = [*faces[1:], (a, b, 6), (b, c, 6), (c, a, 6)]
    nodes[6] = (-0.5, -0.5, -1.5)    # this corner stands out of the opposite face
    return nodes, faces


def test_surface_through_itself(lmp, scenes):
    scene = scenes.Scene()
    scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=("bad.off", 7, 10))
    nodes, faces = through_itself()
    fails(lmp, whole(scene), "Create_cells: bad mesh bad.off: the surface runs through itself",
          "at faces", files={"bad.off": off(nodes, faces)})  # fmt: skip


def as_written():
    """The octahedron as programs and editors write it."""
    nodes, faces = octahedron()
    text = off(nodes, faces)
    obj = "".join(f"v {x} {y} {z}\n" for x, y, z in nodes)
    obj += "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
    joined = obj.replace("f 1 ", "f 1 \\\n  ").replace("v -1 0", "v -1 \\\n0")
    return {
        "plain.off": text,
        "bom.off": "\ufeff" + text,
        "lower.off": text.replace("OFF", "off"),
        "glued.off": text.replace("OFF\n", "OFF"),
        "windows.off": text.replace("\n", "\r\n"),
        "mac.off": text.replace("\n", "\r"),
        "no_end.off": text.rstrip("\n"),
        "plain.obj": obj,
        "bom.obj": "\ufeff" + obj,
        "joined.obj": joined,
        "joined_windows.obj": joined.replace("\n", "\r\n"),
        "mac.obj": obj.replace("\n", "\r"),
    }


@pytest.mark.parametrize("name", as_written())
def test_mesh_file_as_written(lmp, scenes, name):
    """Nodes where the file has them: an octahedron of unit half axes, volume 4/3, at radius 6."""
    scene = scenes.Scene(boundary="p p p")
    scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=(name, 6, 8), options="scale nodes")
    (lmp.folder / name).write_bytes(as_written()[name].encode())
    deck = scene.head() + "write_dump all custom d.txt id type x y z modify format float %.17g\n"
    frame = lmp(deck, files={name: lmp.folder / name}).dump("d.txt")[0]
    found = frame.x[frame["type"] == 2]
    expected = 6.0 * np.array(octahedron()[0], dtype=float)
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("case", bad_meshes())
def test_mesh_file(lmp, scenes, case):
    text, pattern = bad_meshes()[case]
    scene = scenes.Scene()
    scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=("bad.off", 6, 8))
    fails(lmp, whole(scene), "Create_cells", pattern, files={"bad.off": text})


def test_mesh_file_missing(lmp, scenes):
    scene = scenes.Scene()
    scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=("none.off", 6, 8))
    fails(lmp, whole(scene), "Create_cells", "cannot open mesh file none.off", "check its name")


# --- create_cells ---------------------------------------------------------------------------------

CELL = "create_cells single hep dcm 0 0 0 6 dcm hep 1 2 3 1 1 mesh icosphere 1"
CREATE = {
    "radius negative": (CELL.replace(" 6 ", " -6 "), "radius is -6", "positive"),
    "radius zero": (CELL.replace(" 6 ", " 0 "), "radius is 0", "positive"),
    "radius nan": (CELL.replace(" 6 ", " nan "), "'?nan'?", "number|finite"),
    "radius text": (CELL.replace(" 6 ", " six "), "'six' is not a number"),
    "position text": (CELL.replace("0 0 0", "0 a 0"), "'a' is not a number"),
    "unknown keyword": (CELL + " spin 3", "unknown keyword spin", "known: "),
    "unknown mesh": (CELL.replace("icosphere 1", "cube 1"),
                     "mesh must be icosphere LEVEL or file PATH, not cube"),
    "level text": (CELL.replace("icosphere 1", "icosphere one"), "one"),
    "level too large": (CELL.replace("icosphere 1", "icosphere 9"), "9", "level"),
    "level negative": (CELL.replace("icosphere 1", "icosphere -1"), "-1", "level"),
    "rest zero": (CELL + " rest 0", "rest is 0", "above 0"),
    "rest text": (CELL + " rest x", "rest is 'x', expected a number"),
    "rotate text": (CELL + " rotate x", "x"),
    "rotate zero": (CELL + " rotate 0", "rotate.*positive"),
    "scale text": (CELL + " scale x", "scale must be volume, nodes or none, not x"),
    "atom type text": (CELL.replace("hep 1 2 3", "hep one 2 3"), "dcm is 'one', expected a number"),
    "atom type too large": (CELL.replace("hep 1 2 3", "hep 1 2 9"), "dcm is 9.*type of 1 to 4",
                            "create_box"),
    "atom types equal": (CELL.replace("hep 1 2 3", "hep 1 2 2"), "three different"),
    "no types": ("create_cells single hep dcm 0 0 0 6 mesh icosphere 1", "no atom types for"),
    "no values": ("create_cells", "[Cc]reate_cells"),
    "outside box": (CELL.replace("0 0 0", "90 0 0"), "outside the box", "enlarge"),
    "table missing": ("create_cells table none.txt " + CELL[35:], "cannot open.*none.txt"),
    "table empty": ("create_cells table empty.txt " + CELL[35:], "empty.txt names no cell"),
    "table row": ("create_cells table row.txt " + CELL[35:], "row.txt", "expected NAME"),
    "unknown source": (CELL.replace("single", "many"), "many"),
}


@pytest.mark.parametrize("case", CREATE)
def test_create_cells(lmp, scenes, case):
    command, *patterns = CREATE[case]
    scene = scenes.Scene(boundary="f f f")
    scene.cells = [command]
    files = {"empty.txt": "# none\n", "row.txt": "hep dcm 0 0\n"}
    fails(lmp, whole(scene), "[Cc]reate_cells", *patterns, files=files)
