"""Contact law foundation at deck level: pressure of flats, force of spheres, cells kept apart."""

import math

import numpy as np
import pytest

from support.bad_decks import whole
from support.meshes import cube, off

E, NU, W = 5.0, 0.4, 0.1  # of support.parameters


def stiffness(layer, other=None):
    other = layer if other is None else other
    return 1 / ((layer + other) * (1 - NU**2) / E)


BARE = "bond_style zero nocoeff\nbond_coeff *\ndihedral_style zero nocoeff\ndihedral_coeff *\n"


@pytest.mark.parametrize("layer", [0.25, 0.1])
@pytest.mark.parametrize("overlap", [0.02, 0.3])
@pytest.mark.parametrize("rmax", [100, 1000])
def test_flats_repel_with_k_times_overlap(lmp, scenes, layer, overlap, rmax):
    """Two cubes side against side. On the faces away from edges, which are flat, the pressure is k
    delta whatever the radius rmax of their spheres; these stand out of a face by less than its
    size^2/2R."""
    nodes, faces = cube(8)
    scene = scenes.Scene(25.0)
    side = 6.0
    x = side - overlap / 2
    mesh = ("cube.off", len(nodes), len(faces))
    for sign in (-1, 1):  # meshes that do not coincide
        y, z = (0.31, 0.17) if sign > 0 else (0.0, 0.0)
        scene.dcm(sign * x, y, z, side * math.sqrt(3), mesh=mesh, options="scale nodes")
    result = lmp(
        scene.head()
        + BARE
        + scene.contact(f"law foundation rmax {rmax} h0 0.1 range 1.0", f"W 0 layer {layer}")
        + "fix cell all dcm/cell\ncompute s all dcm/face area stress\n"
        + scenes.dump("id mol type xu yu zu c_s[1] c_s[2]", 1)
        + "run 0\n",
        files={"cube.off": off(nodes, faces)},
    )
    frame = result.dump()[0]
    middle = np.hypot(frame["yu"], frame["zu"]) < 0.5 * side
    inner = (frame["type"] == 3) & (np.abs(frame["xu"]) < 1.0) & middle
    assert inner.sum() > 20
    slack = 1.5**2 / (6.0 * rmax) / overlap
    assert frame["c_s[2]"][inner] == pytest.approx(stiffness(layer) * overlap, rel=slack)
    assert f"to {stiffness(layer):.6g}\n" in result.log  # the stiffest, of two deformable cells


@pytest.mark.parametrize("law", ["dmt", "foundation"])
@pytest.mark.parametrize("overlap", [0.02, 0.0, -0.05])
def test_meshes_that_coincide_lose_no_contact(lmp, scenes, law, overlap):
    """Two cubes side against side with equal triangles: the same area in contact and the same force
    as with one of them displaced by a millionth of its size."""
    nodes, faces = cube(6)
    side = 6.0
    mesh = ("cube.off", len(nodes), len(faces))
    results = []
    for shift in (0.0, 1e-5):
        scene = scenes.Scene(25.0)
        for sign in (-1, 1):
            x = sign * (side - overlap / 2)
            place = (x, (sign > 0) * shift, (sign > 0) * 0.7 * shift)
            scene.dcm(*place, side * math.sqrt(3), mesh=mesh, options="scale nodes")
        result = lmp(
            scene.head()
            + BARE
            + scene.contact(f"law {law} h0 0.2 range 1.0", f"W {W}")
            + "fix cell all dcm/cell\ncompute p all pair dcm/contact\ngroup one molecule 1\n"
            + "compute f one reduce sum fx\n"
            + scenes.thermo(["area=c_p[3]", "force=c_f"])
            + "run 0\n",
            files={"cube.off": off(nodes, faces)},
        )
        results.append(result.thermo[0])
    exact, near = results
    assert exact["v_area"] == pytest.approx(near["v_area"], rel=1e-4)
    assert exact["v_area"] > 0.95 * (2 * side) ** 2
    assert exact["v_force"] == pytest.approx(near["v_force"], rel=1e-4, abs=1e-4)


def test_layers_of_two_types(lmp, scenes):
    """Each type's own layer from the parameter file, 0.1 um for one that names none."""
    scene = scenes.doublet()
    text = "celltype a\n E_contact 5\n nu_contact 0.4\n layer 0.25\ncelltype b\n E_contact 5\n" \
        " nu_contact 0.4\n"  # fmt: skip
    contact = (
        "pair_style dcm/contact law foundation\n"
        "pair_coeff * * layers.dcm NULL NULL a b W 0\nneighbor 0.6 multi\n"
    )
    result = lmp(whole(scene, contact=contact) + "run 0\n", files={"layers.dcm": text})
    assert f"per area {stiffness(0.25):.6g} to {stiffness(0.1):.6g}" in result.log


@pytest.mark.parametrize("np_", [1, 2, 3, 4])
def test_force_of_spheres_and_pull_off(lmp, scenes, np_):
    """Nodes on exact spheres: the stress of the law over their gap (pi k R delta^2 - 2 pi W R for
    spheres that are large against h0), most negative at first touch, within the 1e-3 of radii
    fitted to a mesh of 162 nodes, of both attraction and repulsion."""
    R, h0 = 6.0, 0.4
    shifts = [-0.35, -0.2, 0.0, 0.05, 0.2] if np_ == 1 else [0.0, 0.05]
    scene = scenes.Scene((30.0, 15.0, 15.0), "p p p", level=2)
    scene.dcm(-R, 0.0, 0.0, R, options="scale nodes rotate 3")
    scene.dcm(R, 0.0, 0.0, R, options="scale nodes rotate 5")
    deck = (
        scene.head()
        + BARE
        + scene.contact(f"law foundation h0 {h0} range 2.0", f"W {W} layer 0.25")
        + "fix cell all dcm/cell\ngroup left molecule 1\ncompute f left reduce sum fx\n"
        + scenes.thermo(["f=c_f"])
    )
    at = 0.0
    for overlap in shifts:
        deck += f"displace_atoms left move {overlap - at!r} 0 0 units box\nrun 0\n"
        at = overlap
    forces = [-row["v_f"] for row in lmp(deck, np=np_).thermo]
    k, Re = stiffness(0.25), R / 2
    strength = k * h0 * (1 - math.sqrt(1 - 2 * W / (k * h0**2)))
    for overlap, force in zip(shifts, forces, strict=True):
        # at local overlap o: surfaces at height (2 R - overlap + o)/2 over the spheres' middles
        width = (overlap + h0) / 10000
        local = [overlap - width * (i + 0.5) for i in range(10000)]
        expected = sum(
            max(k * o, -strength) * math.pi * (2 * R - overlap + o) / 2 * width for o in local
        )
        parts = 2 * math.pi * W * Re + math.pi * k * Re * max(0.0, overlap) ** 2
        assert force == pytest.approx(expected, abs=3e-3 * parts)
    if np_ == 1:
        assert min(forces) == forces[shifts.index(0.0)]


def squeezed(scenes, law, coeff="", level=2, steps=500, scale=0.74):
    """Eight cells in a periodic cube that shrinks around them."""
    scene = scenes.Scene(12.2, "p p p", level)
    for x in (-6.1, 6.1):
        for y in (-6.1, 6.1):
            for z in (-6.1, 6.1):
                scene.dcm(x, y, z, 6.0)
    return (
        whole(scene, contact=scene.contact(law, coeff), motion=scene.motion(options=""))
        + "compute volumes all dcm/cell volume\ncompute all all reduce sum c_volumes\n"
        + f"fix squeeze all deform 1 x scale {scale} y scale {scale} z scale {scale} remap x\n"
        + scenes.thermo(["filled=c_all/vol", "pressure=f_volume[1]"], 100)
        + f"timestep 1.0\nrun {steps}\n"
    )


def test_squeezed_cells_keep_apart(lmp, scenes):
    """The cells of a shrinking cube take no more than its space."""
    rows = lmp(squeezed(scenes, "law foundation")).thermo
    print([(round(row["v_filled"], 4), round(row["v_pressure"], 3)) for row in rows])
    assert rows[-1]["v_pressure"] > 0.6
    assert max(row["v_filled"] for row in rows) < 1.01
