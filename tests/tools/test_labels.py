"""From a labelled image to cells that LAMMPS runs."""
import re
import subprocess
import sys

import numpy as np
import pytest
import tifffile

from lammps_dcm import labels
from lammps_dcm.__main__ import main
from lammps_dcm.mesh_check import enclosed_volume, find_faults
from lammps_dcm.mesh_file import read_surface
from lammps_dcm.topology import read_data
from support.runner import ROOT

VOXEL = np.array([0.3, 0.3, 0.45])    # um, along x, y, z


def ball_image(shape, balls):
    """Labels (z, y, x) of balls (label, middle (x, y, z), radius), um: a voxel is in the first
    whose middle is within the radius."""
    z, y, x = (v[..., None] for v in np.indices(shape))
    middles = (np.concatenate([x, y, z], axis=-1) + 0.5) * VOXEL
    image = np.zeros(shape, dtype=np.uint16)
    for label, middle, radius in balls:
        inside = ((middles - middle) ** 2).sum(axis=-1) < radius**2
        image[inside & (image == 0)] = label
    return image


RADIUS = 5.0
BALLS = [(3, (6.5, 6.6, 6.7), RADIUS), (70, (16.3, 6.6, 6.7), RADIUS)]    # 9.8 um apart: they touch
SHAPE = (30, 44, 76)
# the cap that two balls of radius R at distance d share: volume pi (4 R + d)(2 R - d)^2 / 12
LENS = np.pi * (4 * RADIUS + 9.8) * (2 * RADIUS - 9.8) ** 2 / 12


@pytest.fixture(scope="module")
def image():
    return ball_image(SHAPE, BALLS)


def cells_of(folder):
    return {int(p.stem.split("_")[1]): read_surface(p) for p in folder.glob("*.off")}


@pytest.mark.parametrize("ending", ["tif", "npy"])
def test_two_balls_that_touch(ending, image, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    if ending == "tif":
        tifffile.imwrite("two.tif", image)
    else:
        np.save("two.npy", image)
    assert main(["scene", "labels", f"two.{ending}", "--voxel", *map(str, VOXEL), "--nodes", "162",
                 "-o", "made"]) == 0
    made = cells_of(tmp_path / "made")
    assert sorted(made) == [3, 70]
    exact = 4 / 3 * np.pi * RADIUS**3
    for (label, middle, radius), share in zip(BALLS, (0.0, LENS)):
        nodes, faces = made[label]
        assert not find_faults(nodes, faces)
        assert len(nodes) == pytest.approx(162, abs=8)
        volume = enclosed_volume(nodes, faces)
        # kept to round-off
        assert volume == pytest.approx((image == label).sum() * VOXEL.prod(), rel=1e-12)
        # voxels on the surface are in or out at random: an error of sqrt(4 pi R^2 / h^2) h^3 with
        # h the edge of a voxel of the same volume, 0.4 % here; three times that
        h = np.cbrt(VOXEL.prod())
        assert volume == pytest.approx(exact - share, abs=3 * np.sqrt(4 * np.pi) * RADIUS * h**2)
        # the surface is within a voxel of the ball, flat faces of 162 nodes take 2 % of its radius
        distance = np.linalg.norm(nodes - middle, axis=1)
        assert abs(distance - radius).max() < VOXEL.max() + 0.02 * radius
        assert nodes.mean(axis=0) == pytest.approx(middle, abs=VOXEL.max())
    # they touch: at the plane between them, to a voxel and a half
    assert made[70][0][:, 0].min() - made[3][0][:, 0].max() == pytest.approx(0, abs=1.5 * 0.3)


def test_lammps_puts_them_where_they_are(image, tmp_path, lmp, scenes):
    np.save(tmp_path / "two.npy", image)
    folder = tmp_path / "made"
    assert main(["scene", "labels", str(tmp_path / "two.npy"), "--voxel", *map(str, VOXEL),
                 "--nodes", "162", "--type", "hep", "-o", str(folder)]) == 0
    text = (folder / "in.cells").read_text()
    box = re.search(r"#   (region box .*)\n#   (create_box .*)\n", text)
    s = scenes.Scene()
    head = (f"units lj\natom_style dcm\nnewton on\nboundary s s s\n{box[1]}\n"
            + box[2].replace("create_box 3", "create_box 4") + "\nmass * 1.0\n")
    deck = f"""{head}include made/in.cells
{s.forces()}
fix move all dcm/motion {s.map}
compute cell all dcm/cell volume x y z pressure
dump end all custom 20 end.dump id mol type c_cell[*]
dump_modify end format float %.15g
timestep 0.5
run 20
"""
    files = {}
    cwd = tmp_path / "run"
    (cwd / "made").mkdir(parents=True)
    for path in folder.iterdir():
        (cwd / "made" / path.name).write_text(
            path.read_text().replace(f"variable meshes index {folder}",
                                     "variable meshes index made"))
    first, last = lmp(deck, cwd=cwd, files=files).dump("end.dump")
    for k, (label, (nodes, faces)) in enumerate(sorted(cells_of(folder).items())):
        center = first["type"] == 1
        assert first["mol"][center].tolist() == [1, 2]
        assert first["c_cell[1]"][center][k] == pytest.approx(
            enclosed_volume(nodes, faces), rel=1e-9), label
        place = [first[f"c_cell[{n}]"][center][k] for n in (2, 3, 4)]
        assert place == pytest.approx(nodes.mean(axis=0), abs=1e-9)
        # it is a cell: its cortex is under tension and presses it, it neither bursts nor shrinks
        assert last["c_cell[5]"][last["type"] == 1][k] > 0.0
        assert last["c_cell[1]"][last["type"] == 1][k] == pytest.approx(
            enclosed_volume(nodes, faces), rel=0.1)


def test_bond_slots_are_those_lammps_needs(lmp, tmp_path):
    """One slot less in create_box, and create_cells asks for the number that bond_slots tells."""
    from support.meshes import icosphere, off

    nodes, faces = icosphere(2)
    slots = labels.bond_slots(faces)
    deck = ("units lj\natom_style dcm\nregion box block -9 9 -9 9 -9 9\ncreate_box 4 box "
            "bond/types 1 dihedral/types 1 extra/bond/per/atom {0} extra/dihedral/per/atom {0}\n"
            "create_cells single a cbm 5 5 5 1 cbm a 4\n"
            "create_cells single hep dcm 0 0 0 3 dcm hep 1 2 3 1 1 mesh file m.off\n")
    assert lmp.run(deck.format(slots), files={"m.off": off(nodes, faces)}).returncode == 0
    result = lmp.run(deck.format(slots - 1), files={"m.off": off(nodes, faces)})
    assert f"a node needs {slots} bond" in result.error


def test_axes_of_the_image():
    """Which axis of the array is which, and no mirror image: a box of three different sides that
    lacks one corner."""
    image = np.zeros((20, 30, 40), dtype=int)
    image[4:16, 8:22, 5:35] = 1
    image[4:8, 8:12, 5:9] = 0    # one corner is missing: x, y, z low
    cell, = labels.cells_of_image(image, (0.2, 0.4, 0.5), nodes=642)
    # voxels 5 to 34 of 0.2 um along x
    assert cell.nodes.min(axis=0) == pytest.approx([1.0, 3.2, 2.0], abs=0.3)
    assert cell.nodes.max(axis=0) == pytest.approx([7.0, 8.8, 8.0], abs=0.3)
    corners = np.array([[x, y, z] for x in (1.0, 7.0) for y in (3.2, 8.8) for z in (2.0, 8.0)])
    gaps = [np.linalg.norm(cell.nodes - c, axis=1).min() for c in corners]
    assert np.argmax(gaps) == 0 and gaps[0] > 1.3 * max(gaps[1:])


def test_specks_holes_and_borders(image, tmp_path):
    from scipy import ndimage

    spoiled = image.copy()
    inside = ndimage.binary_erosion(image == 3, iterations=6)
    hole = np.argwhere(inside)[0]
    spoiled[tuple(hole)] = 0                  # a hole
    spoiled[0, 40, 70:75] = 3                 # a speck
    spoiled[25:, :4, :4] = 9                  # a label at the border, below --smallest
    with pytest.warns(UserWarning, match="label 9 left out"), \
            pytest.warns(UserWarning, match="label 3 at the border"):    # the speck
        first, _ = labels.cells_of_image(spoiled, VOXEL, nodes=162)
    assert first.volume == pytest.approx((image == 3).sum() * VOXEL.prod(), rel=1e-12)
    assert any("5 voxels" in n for n in first.notes) and any("filled 1" in n for n in first.notes)
    with pytest.warns(UserWarning, match="labels 3, 70 at the border"):
        assert len(labels.cells_of_image(image[:16], VOXEL, nodes=162)) == 2
    assert len(labels.cells_of_image(image, VOXEL, nodes=42, without=[70])) == 1


def test_voxels_that_touch_by_an_edge():
    """A bridge of two voxels that touch by an edge only closes a handle, which is no feature of the
    cell; blurring removes it, and the volume stays that of the voxels."""
    image = np.zeros((24, 24, 24), dtype=int)
    image[4:20, 4:20, 4:20] = 1
    image[4:20, 10:14, 12:] = 0    # a notch; across its mouth:
    image[11, 10:12, 18] = image[12, 11, 18] = image[12, 12:14, 19] = 1
    cell, = labels.cells_of_image(image, (0.5, 0.5, 0.5), nodes=642)
    assert any("blurred by" in note for note in cell.notes)
    assert not find_faults(cell.nodes, cell.faces)
    assert cell.volume == pytest.approx(image.sum() * 0.125, rel=1e-12)
    plain = image.copy()
    plain[:, 10:14, 12:] = 0
    cell, = labels.cells_of_image(plain, (0.5, 0.5, 0.5), nodes=642)
    assert not cell.notes


def test_the_tissue_of_the_manual(lmp, tmp_path):
    """doc/labels: cells that fill a ball, run as the page on tools says, on two ranks."""
    folder = ROOT / "doc" / "labels"
    cwd = tmp_path / "run"
    cwd.mkdir()
    subprocess.run([sys.executable, folder / "tissue.py"], cwd=cwd, check=True)
    image = np.load(cwd / "tissue.npy")
    cells = labels.cells_of_image(image, (0.5,) * 3, nodes=162)
    labels.write_cells(cells, cwd / "cells")
    text = (cwd / "cells" / "in.cells").read_text()
    (cwd / "cells" / "in.cells").write_text(text.replace(str(cwd / "cells"), "cells"))
    result = lmp(folder / "in.tissue", cwd=cwd, np=2, vars={"steps": 20})
    assert f"Created {len(cells)} deformable cells of " in result.log
    data = read_data(cwd / "tissue.data")
    centers = data.atoms["kind"] == 2
    expected = [(image == c.label).sum() * 0.125 for c in cells]
    assert data.atoms["volume0"][centers] == pytest.approx(expected, rel=1e-9)


def test_labels_that_cannot_be_cells_are_all_named(image):
    spoiled = image.copy()
    z, y, x = np.indices(SHAPE)
    spoiled[(np.hypot(x - 54, y - 22) < 4) & (spoiled == 70)] = 0    # a tunnel
    spoiled[:, :, 19:23][spoiled[:, :, 19:23] == 3] = 0              # two halves
    with pytest.raises(labels.LabelError) as err:
        labels.cells_of_image(spoiled, VOXEL, nodes=162)
    text = str(err.value)
    assert "2 of 2 labels" in text and "--without 3,70" in text
    assert "label 3 consists of 2 parts" in text and "label 70 its surface" in text
    assert "handle" in text


@pytest.mark.parametrize("values, says", [
    (np.zeros((4, 4, 4), int), "0 outside"), (np.ones((4, 4), int), "(z, y, x)"),
    (np.ones((3, 4, 4, 4), int), "(z, y, x)"), (np.ones((4, 4, 4), bool), "skimage.measure.label"),
    (np.full((4, 4, 4), 0.5), "whole numbers"), (np.full((4, 4, 4), -1), "0 outside"),
    (np.ones((4, 4, 4), int), "no label is left")])
@pytest.mark.filterwarnings("ignore:label 1 left out")
def test_images_that_are_none(values, says, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    np.save("a.npy", values)
    assert main(["scene", "labels", "a.npy", "--voxel", "1"]) == 1
    assert says in capsys.readouterr().err
    assert not (tmp_path / "cells").exists()


@pytest.mark.parametrize("words, says", [
    ("gone.tif --voxel 1", "no file gone.tif"), ("a.npy --voxel 0", "--voxel"),
    ("a.npy --voxel 1 2", "--voxel"), ("a.npy --voxel 1 --without x", "--without"),
    ("a.npy --voxel 1 --nodes 3", "--nodes"), ("a.npy --voxel 1 --atom-types 1", "--atom-types"),
    ("a.png --voxel 1", "must end in"), ("b.npy --voxel 1", "cannot be read"),
    ("b.tif --voxel 1", "cannot be read")])
def test_bad_words(words, says, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    np.save("a.npy", np.ones((9, 9, 9), int))
    for name in ("a.png", "b.npy", "b.tif"):
        (tmp_path / name).write_text("no image")
    assert main(["scene", "labels", *words.split()]) == 1
    assert says in capsys.readouterr().err
