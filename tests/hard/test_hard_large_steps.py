"""Hard cases of test_hard_cases.py in steps ten and a hundred times as long as the explicit scheme
stands (some 2 s for cells of 162 nodes), and with steps chosen by their error: a sound result, or
one clear error."""

import numpy as np
import pytest

from hard.test_hard_cases import TIME, Surface, deck, node_force, sound, sound_or_stops

FIXED = {"10x": ("maxmove 1", 20.0, 30), "100x": ("maxmove 1", 200.0, 10)}
AUTO = "dt auto tol 0.02 max 60 stop 600"


def run(lmp, scene, name, extra="", **more):
    options, dt, steps = FIXED.get(name, (AUTO, 1.0, 100000))
    motion = scene.motion(options=f"scheme implicit tolerance 1e-3 {options}")
    every = 1 if name in FIXED else 5
    return lmp.run(deck(scene, steps, dt, motion=motion, extra=extra, every=every, **more),
                   timeout=3 * TIME)


STEPS = pytest.mark.parametrize("name", ["10x", "100x", "auto"])


@STEPS
@pytest.mark.parametrize("law", ["dmt", "foundation"])
def test_doublet(lmp, scenes, name, law):
    """Cells that adhere must come to rest."""
    scene = scenes.doublet(level=2, gap=-0.3, box=25.0)
    result = run(lmp, scene, name, contact=scene.contact(f"law {law}"))
    assert result.returncode == 0, result.tail()
    sound(result)
    cells = [Surface(result.dump()[-1], cell).x.mean(axis=0) for cell in (1, 2)]
    assert 9.0 < np.linalg.norm(cells[1] - cells[0]) < 11.8


@STEPS
@pytest.mark.parametrize("force", [5.0, 50.0, 500.0])
def test_doublet_torn_apart(lmp, scenes, name, force):
    scene = scenes.doublet(level=2, gap=-0.3, box=600.0)
    sound_or_stops(run(lmp, scene, name, node_force((1, 2), force, 162)))


@STEPS
@pytest.mark.parametrize("force", [5.0, 50.0, 5000.0])
def test_crushed_between_spheres(lmp, scenes, name, force):
    """Cells bear 5 nN: no step may be too long for that."""
    scene = scenes.Scene(40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(-11.0, 0.0, 0.0, 5.0)
    scene.cbm(11.0, 0.0, 0.0, 5.0)
    push = (
        "group left molecule 2\ngroup right molecule 3\n"
        f"fix l left addforce {force} 0 0\nfix r right addforce {-force} 0 0\n"
    )
    whole = sound_or_stops(run(lmp, scene, name, push), volume=(0.3, 1.5))
    assert whole or force > 5.0


@STEPS
@pytest.mark.parametrize("force", [1.0, 400.0])
def test_sphere_pressed_into_cell(lmp, scenes, name, force):
    scene = scenes.Scene(40.0, level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(8.9, 0.0, 0.0, 3.0)
    push = f"group ball molecule 2\nfix push ball addforce {-force} 0 0\n"
    whole = sound_or_stops(run(lmp, scene, name, push))
    assert whole or force > 1.0


@STEPS
@pytest.mark.parametrize("force", [1.0, 1000.0])
def test_one_node_pulled_out(lmp, scenes, name, force):
    scene = scenes.single_cell(level=2, box=600.0)
    pull = f"group tip id 10\nfix tip tip addforce 0 0 {force}\n"
    whole = sound_or_stops(run(lmp, scene, name, pull))
    assert whole or force > 1.0
