"""Work of adhesion by cell type and region of both faces: which line of the parameter file counts,
and that junctions stick more and apical faces less.
"""

import re

import numpy as np
import pytest

from support.data_files import section
from support.divisions import FACE
from support.parameters import PARAMETER_TEXT

REGIONS = ("lateral", "polar", "apical", "junction", "basal")
READ = "units lj\natom_style dcm\nnewton on\nboundary f f f\nread_data x.data\n"
COLUMNS = "id mol type fx fy fz"

# the parameters of the tests, without lines of two hepatoblasts
BARE = re.sub(r"adhesion hepatoblast hepatoblast .*\n", "", PARAMETER_TEXT)


def scene_of(scenes, kind):
    """Two cells in contact along x; the second is deformable or a sphere."""
    if kind == "dcm":
        return scenes.doublet(gap=-0.2, boundary="f f f")
    scene = scenes.Scene(20.0, "f f f")
    scene.dcm(-6.0, 0.0, 0.0, 6.0)
    scene.cbm(5.8, 0.0, 0.0, 6.0)
    return scene


def painted(lmp, scene, regions):
    """Data file in which all faces of a cell have one region, by molecule."""
    text = (lmp(scene.head() + "write_data x.data nofix nocoeff\n").path / "x.data").read_text()
    atoms = [line.split() for line in section(text.replace("Atoms # dcm", "Atoms"), "Atoms")]
    for row in atoms:  # id mol type kind radius x y z v1 v2 v3 region ...
        if int(row[3]) == FACE:
            row[11] = str(REGIONS.index(regions[int(row[1]) - 1]))
    start, _, rest = text.partition("Atoms # dcm\n\n")
    lines = "\n".join(" ".join(row) for row in atoms)
    return f"{start}Atoms # dcm\n\n{lines}\n\n" + rest.partition("\n\n")[2]


def forces(lmp, scenes, scene, data, lines="", coeff=""):
    text = BARE + lines
    contact = scene.contact(coeff=coeff).replace("neighbor 0.6", "neighbor 1.2")  # necks of spheres
    deck = READ + contact + "fix cell all dcm/cell\n" + scenes.dump(COLUMNS)
    (frame,) = lmp(deck + "run 0\n", files={"x.data": data, "test.dcm": text}).dump()
    return frame.f


# what a file may say of two cells of type hepatoblast, by how much it says, and values that tell
# the lines apart

HEP = "hepatoblast"
ALL = {
    "types": (HEP, HEP, 0.10),
    "apical": (HEP + ":apical", HEP, 0.02),
    "junction": (HEP, HEP + ":junction", 0.25),
    "junctions": (HEP + ":junction", HEP + ":junction", 0.30),
    "apical basal": (HEP + ":basal", HEP + ":apical", 0.05),
}
COUNTS = [
    # regions of the two cells, the line that counts of those there
    (("lateral", "lateral"), ALL, "types"),
    (("lateral", "polar"), ALL, "types"),
    (("basal", "basal"), ALL, "types"),
    (("apical", "lateral"), ALL, "apical"),
    (("polar", "apical"), ALL, "apical"),
    (("apical", "apical"), ALL, "apical"),
    (("junction", "lateral"), ALL, "junction"),
    (("basal", "junction"), ALL, "junction"),
    (("junction", "junction"), ALL, "junctions"),
    (("apical", "basal"), ALL, "apical basal"),
    (("basal", "apical"), ALL, "apical basal"),
    # one line names the region of the one face, another that of the other: the lower value
    (("apical", "junction"), ALL, "apical"),
    (("junction", "apical"), ALL, "apical"),
    # with fewer lines the next one counts
    (("junction", "junction"), ("types", "junction"), "junction"),
    (("junction", "junction"), ("types",), "types"),
    (("apical", "basal"), ("types", "apical"), "apical"),
]


@pytest.mark.parametrize("case", range(len(COUNTS)))
def test_line_that_counts(lmp, scenes, case):
    """Forces are those of the value of that line, given for everything; whatever the order of the
    lines in the file.
    """
    regions, names, counts = COUNTS[case]
    scene = scene_of(scenes, "dcm")
    data = painted(lmp, scene, regions)
    lines = ["adhesion {} {} {}\n".format(*ALL[name]) for name in names]
    expected = forces(lmp, scenes, scene, data, coeff=f"W {ALL[counts][2]}")
    assert np.abs(expected).max() > 0.01
    for order in (lines, lines[::-1]):
        assert np.array_equal(forces(lmp, scenes, scene, data, "".join(order)), expected)
    other = [name for name in ALL if name != counts][0]
    assert not np.array_equal(
        forces(lmp, scenes, scene, data, coeff=f"W {ALL[other][2]}"), expected
    )


@pytest.mark.parametrize("region, W", [("apical", 0.03), ("junction", 0.2), ("basal", 0.1)])
def test_against_a_sphere(lmp, scenes, region, W):
    """Two types, the region of the second one named; a sphere has no regions: it is lateral."""
    lines = (
        "adhesion hepatoblast hepatoblast 0.5\n"
        "adhesion hepatoblast_cbm hepatoblast 0.1\n"
        "adhesion hepatoblast_cbm hepatoblast:apical 0.03\n"
        "adhesion hepatoblast:junction hepatoblast_cbm:lateral 0.2\n"
        "adhesion hepatoblast:junction hepatoblast_cbm 0.4\n"
    )
    scene = scene_of(scenes, "cbm")
    data = painted(lmp, scene, [region])
    expected = forces(lmp, scenes, scene, data, coeff=f"W {W}")
    assert np.abs(expected).max() > 0.01
    assert np.array_equal(forces(lmp, scenes, scene, data, lines), expected)


def test_twice_with_two_values(lmp, scenes):
    """Which one is meant? In either order of the two sides an error; the same value is none."""
    scene = scene_of(scenes, "dcm")
    data = painted(lmp, scene, ("apical", "basal"))
    lines = (
        "adhesion hepatoblast hepatoblast 0.1\n"
        "adhesion hepatoblast:apical hepatoblast:basal 0.04\n"
        "adhesion hepatoblast:basal hepatoblast:apical 0.04\n"
    )
    found = forces(lmp, scenes, scene, data, lines)
    assert np.array_equal(found, forces(lmp, scenes, scene, data, coeff="W 0.04"))
    with pytest.raises(pytest.fail.Exception, match="has the value 0.04 above already"):
        forces(lmp, scenes, scene, data, lines.replace("apical 0.04", "apical 0.05"))


def test_regions_are_no_types(lmp, scenes):
    """Lines of regions alone do not stand for the two types."""
    scene = scene_of(scenes, "dcm")
    data = painted(lmp, scene, ("apical", "apical"))
    text = BARE + "adhesion hepatoblast:apical hepatoblast:apical 0.02\n"
    deck = READ + scene.contact() + "fix cell all dcm/cell\nrun 0\n"
    result = lmp.run(deck, files={"x.data": data, "test.dcm": text})
    assert result.returncode != 0
    assert "no adhesion between cell types hepatoblast and hepatoblast" in result.error


def test_maugis_knows_the_strongest_region(lmp, scenes):
    """Law maugis ends a run at its start if adhesion is too strong anywhere on the surface."""
    scene = scene_of(scenes, "dcm")
    data = painted(lmp, scene, ("lateral", "lateral"))
    lines = (
        "adhesion hepatoblast hepatoblast 0.01\nadhesion hepatoblast hepatoblast_cbm 0.01\n"
        "adhesion hepatoblast_cbm hepatoblast_cbm 0.01\n"
    )
    strong = "adhesion hepatoblast:junction hepatoblast:junction 50\n"
    deck = READ + scene.contact("law maugis") + "fix cell all dcm/cell\nrun 0\n"
    text = re.sub(r"adhesion .*\n", "", PARAMETER_TEXT) + lines
    lmp(deck, files={"x.data": data, "test.dcm": text})
    result = lmp.run(deck, files={"x.data": data, "test.dcm": text + strong})
    assert result.returncode != 0
    assert "adhesion W = 50 of atom types 3 and 3 is too strong" in result.error


def test_junctions_stick_more_apical_faces_less(lmp, scenes):
    """The shipped cell type: contact area of a doublet after some minutes, faces all apical, all
    of the ribbon, or neither.
    """
    area = {}
    for other in ("cholangiocyte", "hepatoblast"):
        for region in ("apical", "junction", "lateral"):
            scene = scene_of(scenes, "dcm")
            data = painted(lmp, scene, (region, region))
            scene.parameters = "bile_duct.dcm"
            scene.NAMES = "hepatoblast hepatoblast hepatoblast hepatoblast_cbm"
            if other == "cholangiocyte":
                scene.NAMES = scene.NAMES.replace("hepatoblast ", "cholangiocyte ")
            deck = (
                READ.replace("x.data", "x.data extra/bond/per/atom 8 extra/dihedral/per/atom 8")
                + scene.forces()
                + scene.motion()
                + "compute f all dcm/face contact_area\ncompute a all reduce sum c_f\n"
                + scenes.thermo(["c_a"], 100)
                + "timestep 1.0\nrun 200\n"
            )
            area[other, region] = lmp(deck, files={"x.data": data}).thermo[-1]["c_a"]
    mine = {region: value for (name, region), value in area.items() if name == "cholangiocyte"}
    assert mine["apical"] < 0.9 * mine["lateral"]
    assert mine["junction"] > 1.1 * mine["lateral"]
    # hepatoblasts do not know regions, and a cholangiocyte that is lateral all over is one of them
    assert len({area["hepatoblast", region] for region in ("apical", "junction", "lateral")}) == 1
    assert area["hepatoblast", "lateral"] == mine["lateral"]
