"""The pressure is -dE/dV of the conservative part, and the same on any number of ranks."""

import numpy as np
import pytest

H = 1e-5  # relative change of a length


def scene_and_laws(scenes, form=""):
    """Two cells and two spheres in contact; surfaces without contact, which has no energy."""
    scene = scenes.Scene((24.0, 20.0, 18.0), "p p p", level=1)
    scene.dcm(-7.0, 3.0, 0.0, 6.0, options="rotate 3 rest 0.93")
    scene.dcm(21.0, -17.0, 15.0, 5.0, options="rotate 3 rest 0.97")  # over three borders
    scene.cbm(8.0, 8.0, 0.0, 4.0)
    scene.cbm(14.0, 11.0, 2.0, 4.5)
    scene.NAMES = "NULL NULL NULL hepatoblast_cbm"
    spheres = scene.contact()
    scene.NAMES = scenes.Scene.NAMES
    return scene.head() + (
        "group nodes type 2\ndisplace_atoms nodes random 0.2 0.2 0.2 4711 units box\n"
        + scene.cortex(bend="rest flat")
        + spheres
        + "fix cell all dcm/cell\ncomm_modify cutoff 14\n"
        + scene.volume()
        + "compute virial all pressure NULL virial\n"
        + "compute pair all pressure NULL pair\ncompute bond all pressure NULL bond\n"
        + "compute bend all pressure NULL dihedral\ncompute fix all pressure NULL fix\n"
    )


COLUMNS = ["pe", "vol", "p=c_virial"] + [f"p{k}=c_virial[{k}]" for k in (1, 2, 3)]


def test_pressure_is_minus_gradient_of_energy(lmp, scenes):
    deck = scene_and_laws(scenes) + scenes.thermo(COLUMNS) + "run 0\n"
    ways = ("x", "y", "z", "x y z")
    for way in ways:
        for factor in (1 + H, (1 - H) / (1 + H), 1 / (1 - H)):
            deck += "change_box all " + " ".join(f"{k} scale {factor!r}" for k in way.split())
            deck += " remap\nrun 0\n"
    runs = [run[0] for run in lmp(deck).runs]
    first = runs[0]
    assert abs(first["v_p"]) > 1e-3
    for n, way in enumerate(ways):
        up, down, back = runs[1 + 3 * n : 4 + 3 * n]
        assert back["PotEng"] == pytest.approx(first["PotEng"], rel=1e-12)
        numerical = -(up["PotEng"] - down["PotEng"]) / (up["Volume"] - down["Volume"])
        exact = first["v_p"] if way == "x y z" else first[f"v_p{n + 1}"]
        assert numerical == pytest.approx(exact, rel=1e-6), way


def test_each_law_has_its_share(lmp, scenes):
    """Edges pull, compressed volumes push, spheres as they are; angles alone do not count."""
    names = ("pair", "bond", "bend", "fix")
    columns = ["p=c_virial"] + [f"{k}=c_{k}" for k in names]
    row = lmp(scene_and_laws(scenes) + scenes.thermo(columns) + "run 0\n").thermo[0]
    assert row["v_p"] == pytest.approx(sum(row[f"v_{k}"] for k in names), rel=1e-12)
    assert abs(row["v_bend"]) < 1e-12 * abs(row["v_bond"])
    assert min(abs(row[f"v_{k}"]) for k in ("pair", "bond", "fix")) > 1e-6


@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_pressure_of_a_doublet_on_1_2_and_4_ranks(lmp, scenes, boundary):
    """All laws, with contact; the virial of forces that balance does not depend on who adds up."""
    scene = scenes.doublet(level=2, boundary=boundary, gap=-0.3)
    scene.cells = [cell.replace(" 0.0 0.0 6.0", " 19.0 0.0 6.0") for cell in scene.cells]
    if boundary == "s s s":
        scene.box = [20.0, 30.0, 20.0]
    columns = [f"p{k}=c_virial[{k}]" for k in range(1, 7)]
    deck = (
        scene.head()
        + scene.forces()
        + "compute virial all pressure NULL virial\n"
        + scenes.thermo(columns)
        + "run 0\n"
    )
    rows = [lmp(deck, np=n).thermo[0] for n in (1, 2, 4)]
    values = np.array([[row[f"v_p{k}"] for k in range(1, 7)] for row in rows])
    scale = np.abs(values).max()
    assert scale > 1e-3
    assert np.abs(values - values[0]).max() < 1e-12 * scale
