"""Bad meshes and arguments of create_cells: one error that names value and remedy; files stay."""

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
    "scale text": (CELL + " scale x", "scale must be volume or nodes, not x"),
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
