"""fix dcm/motion, motility and confine: what free cells do, and cells that are held."""

import math

import numpy as np
import pytest

G_ECM, D = 1.0, 1e-4  # test.dcm of support/parameters.py


def sphere_friction(radius):
    return G_ECM * 4 * math.pi * radius**2


def test_fixed_cells_stay(lmp, scenes):
    """Cells outside the group do not move at all, and resist those that push on them."""
    scene = scenes.Scene((30.0, 15.0, 15.0), "p p p")
    scene.dcm(-12.0, 0.0, 0.0, 6.0)
    scene.dcm(-0.5, 0.0, 0.0, 6.0)
    scene.cbm(10.0, 0.0, 0.0, 5.0)
    result = lmp(
        scene.head()
        + scene.forces()
        + "group mobile molecule 2\nfix push mobile addforce 0.05 0.0 0.0\n"
        + scene.motion("mobile")
        + scenes.dump(every=20)
        + "timestep 1.0\nrun 60\n"
    )
    frames = result.dump()
    held = frames[0]["mol"] != 2
    exact = held & (frames[0]["type"] != 1)  # a center is the sum of its nodes, to round-off
    for frame in frames:
        assert (frame.x[exact] == frames[0].x[exact]).all()
        assert np.abs(frame.x[held] - frames[0].x[held]).max() < 1e-13
        assert (frame.v[held] == 0).all()
    assert np.abs(frames[-1].x[~held] - frames[0].x[~held]).max() > 0.05
    sphere = frames[-1].f[frames[0]["mol"] == 3]
    assert abs(sphere[0, 0]) > 0.1  # it feels the cell, and stays


@pytest.mark.parametrize("np_", [1, 2])
def test_a_sphere_pushed_by_a_force(lmp, scenes, np_):
    """v = F/(g 4 pi R^2)."""
    R, F, steps, dt = 4.0, np.array([3.0, -2.0, 1.0]), 50, 0.5
    scene = scenes.Scene(20.0, "p p p")
    scene.cbm(-1.0, 2.0, 3.0, R)
    result = lmp(
        scene.head()
        + scene.contact()
        + "fix cell all dcm/cell\n"
        + f"fix push all addforce {scenes.words(*F)}\n"
        + scene.motion()
        + scenes.dump(every=steps)
        + f"timestep {dt}\nrun {steps}\n",
        np=np_,
    )
    first, last = result.dump()
    v = F / sphere_friction(R)
    assert last.v[0] == pytest.approx(v, rel=1e-12)
    assert last.x[0] - first.x[0] == pytest.approx(v * dt * steps, rel=1e-12)


def test_a_cell_pushed_evenly(lmp, scenes):
    """It moves with F/(g A), however stiff, straight ahead."""
    scene = scenes.single_cell(level=2, boundary="p p p", options="scale nodes rest 1.0")
    result = lmp(
        scene.head()
        + scene.cortex()
        + "comm_modify cutoff 8\nfix cell all dcm/cell\n"
        + scene.volume()
        + "group nodes type 2\nfix push nodes addforce 0.01 0.0 0.0\n"
        + scene.motion()
        + "compute cells all dcm/cell area vx vy vz\n"
        + scenes.thermo(
            ["A=C_cells[1][1]", "vx=C_cells[1][2]", "vy=C_cells[1][3]", "vz=C_cells[1][4]"]
        )
        + "timestep 0.1\nrun 1\n"
    )
    row = result.thermo[-1]
    # not all nodes have the same share of the area, hence the per mille
    assert row["v_vx"] == pytest.approx(162 * 0.01 / (G_ECM * row["v_A"]), rel=1e-3)
    assert max(abs(row["v_vy"]), abs(row["v_vz"])) < 1e-12 * row["v_vx"]


# --- plane ----------------------------------------------------------------------------------------


def test_plane_brings_a_sphere_back(lmp, scenes):
    """d(t) = d0 (1 - K dt/Gamma)^n, Euler step by step."""
    R, K, dt, steps = 3.0, 10.0, 1.0, 40
    scene = scenes.Scene(20.0, "p p p")
    scene.cbm(1.0, 2.0, 1.7, R)
    result = lmp(
        scene.head()
        + scene.contact()
        + "fix cell all dcm/cell\n"
        + f"fix plane all dcm/confine plane z {K} at 0.5\n"
        + scene.motion()
        + scenes.dump(every=1)
        + f"timestep {dt}\nrun {steps}\n"
    )
    for frame in result.dump():
        expected = 0.5 + 1.2 * (1 - K * dt / sphere_friction(R)) ** frame.step
        assert frame.x[0] == pytest.approx([1.0, 2.0, expected], rel=1e-10)


def test_plane_brings_a_cell_back(lmp, scenes):
    scene = scenes.Scene(20.0, "s s s")
    scene.dcm(1.0, 2.0, 1.5, 6.0)
    result = lmp(
        scene.head()
        + scene.cortex()
        + "fix cell all dcm/cell\n"
        + scene.volume()
        + "fix plane all dcm/confine plane z 20.0 at 1.0\n"
        + scene.motion()
        + scenes.dump("id type xu yu zu", 50)
        + scenes.thermo(["far=f_plane[3]"], 50)
        + "timestep 1.0\nrun 300\n"
    )
    frames = result.dump()
    z = [frame.x[0, 2] for frame in frames]
    assert frames[0]["type"][0] == 1 and z[0] == pytest.approx(1.5, abs=1e-12)
    away = np.array(z) - 1.0
    assert (away[1:] < away[:-1]).all() and (away > 0).all()
    # one exponential: the whole cell has the friction g A
    rates = away[1:] / away[:-1]
    area = 4 * math.pi * 36
    assert rates == pytest.approx(math.exp(-20.0 * 50 / area), rel=0.1)
    assert [row["v_far"] for row in result.thermo] == pytest.approx(away, rel=1e-6, abs=1e-12)
    assert frames[-1].x[0, :2] == pytest.approx([1.0, 2.0], abs=0.02)


# --- motility -------------------------------------------------------------------------------------


def free_spheres(scenes, n, boundary="p p p"):
    side = math.ceil(n ** (1 / 3))
    scene = scenes.Scene(4.0 * side + 2, boundary)
    rng = np.random.default_rng(1)
    for k in range(n):
        place = 8.0 * (np.array([k % side, k // side % side, k // side**2]) - (side - 1) / 2)
        scene.cbm(*place, rng.uniform(1.5, 3.0))
    return scene


@pytest.mark.parametrize(
    "options",
    ["", "persistence 3.0", "plane z", "bias 1 0 0 2.0", "interval 5",
     "interval 5 persistence 3.0"],
)
def test_free_spheres_diffuse(lmp, scenes, options):
    """MSD = 2 D t per direction within three standard errors; bias: drift F/Gamma."""
    n, steps, dt = 216, 200, 1.0
    scene = free_spheres(scenes, n)
    result = lmp(
        scene.head()
        + "fix cell all dcm/cell\n"
        + scene.motility(seed=11, options=options)
        + scene.motion()
        + scenes.dump("id type radius xu yu zu", steps)
        + f"comm_modify cutoff 8\ntimestep {dt}\nrun {steps}\n"
    )
    first, last = result.dump()
    moved = last.x - first.x
    t = steps * dt
    directions = [0, 1] if "plane" in options else [0, 1, 2]
    if "plane" in options:
        assert (moved[:, 2] == 0).all()
    if "bias" in options:
        moved[:, 0] -= 2.0 / (G_ECM * 4 * math.pi * first["radius"] ** 2) * t
    # started from the stationary distribution: <x^2> = 2 D (t - tau (1 - exp(-t/tau)))
    tau = 3.0 if "persistence" in options else 0.0
    expected = 2 * D * (t - tau * (1 - math.exp(-t / tau)) if tau else t)
    for k in directions:
        square = moved[:, k] ** 2
        error = expected * math.sqrt(2 / n)
        assert abs(square.mean() - expected) < 3 * error, (k, square.mean(), expected)
        assert abs(moved[:, k].mean()) < 3 * math.sqrt(expected / n)
    total = (moved[:, directions] ** 2).mean()
    assert abs(total - expected) < 3 * expected * math.sqrt(2 / (n * len(directions)))
    # independent directions and cells
    assert abs((moved[:, 0] * moved[:, 1]).mean()) < 3 * expected / math.sqrt(n)
    assert abs((moved[1:, 0] * moved[:-1, 0]).mean()) < 3 * expected / math.sqrt(n)


def test_diffusion_by_steps(lmp, scenes):
    """Steps of a run are independent, and normal with variance 2 D dt: 10,800 x 3 of them."""
    n, steps, dt = 216, 50, 2.0
    scene = free_spheres(scenes, n)
    result = lmp(
        scene.head()
        + "fix cell all dcm/cell\n"
        + scene.motility(seed=5)
        + scene.motion()
        + scenes.dump("id type xu yu zu", 1)
        + f"comm_modify cutoff 8\ntimestep {dt}\nrun {steps}\n"
    )
    x = np.array([frame.x for frame in result.dump()])
    step = np.diff(x, axis=0) / math.sqrt(2 * D * dt)
    samples = step.size
    assert abs((step**2).mean() - 1) < 3 * math.sqrt(2 / samples)
    assert abs((step**4).mean() - 3) < 3 * math.sqrt(96 / samples)
    assert abs((step[1:] * step[:-1]).mean()) < 3 / math.sqrt(samples)


def test_free_deformable_cells_diffuse(lmp, scenes):
    """24 cells of 42 nodes: MSD of their centers within three standard errors."""
    side, steps = 3, 60
    scene = scenes.Scene(24.0, "p p p")
    for k in range(24):
        place = 15.0 * (np.array([k % side, k // side % side, k // side**2]) - 1.0)
        scene.dcm(*place, 6.0, options="rotate 3 rest 1.0")
    result = lmp(
        scene.head()
        + scene.cortex()
        + "fix cell all dcm/cell\n"
        + scene.volume()
        + scene.motility(seed=9)
        + scene.motion()
        + "comm_modify cutoff 8\n"
        + "group centers type 1\n"
        + scenes.dump("id type xu yu zu", 1, group="centers")
        + f"timestep 1.0\nrun {steps}\n"
    )
    x = np.array([frame.x for frame in result.dump()])
    assert x.shape == (steps + 1, 24, 3)
    moved = (x[-1] - x[0]) ** 2
    expected = 2 * D * steps
    assert abs(moved.mean() - expected) < 3 * expected * math.sqrt(2 / moved.size)
    step = np.diff(x, axis=0) ** 2 / (2 * D)
    assert abs(step.mean() - 1) < 3 * math.sqrt(2 / step.size)


def test_same_trajectory_on_1_2_and_4_ranks(lmp, scenes):
    """Random numbers belong to cell and step, not to ranks."""
    scene = free_spheres(scenes, 30)
    scene.dcm(0.0, 0.0, 0.0, 2.0)
    deck = (
        scene.head()
        + scene.cortex()
        + "fix cell all dcm/cell\n"
        + scene.volume()
        + scene.motility(seed=3, options="D 0.1 persistence 2.0")
        + scene.motion(options="tolerance 1e-12 maxmove 1.0")
        + "comm_modify cutoff 8\n"
        + scenes.dump(every=20)
        + "timestep 1.0\nrun 40\n"
    )
    one = lmp(deck).dump()
    assert np.abs(one[-1].x - one[0].x).max() > 1.0
    for np_ in (2, 4):
        for a, b in zip(one, lmp(deck, np=np_).dump(), strict=True):
            assert np.abs(a.x - b.x).max() < 1e-11
