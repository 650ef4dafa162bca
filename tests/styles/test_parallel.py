"""The same on any number of ranks; mirror symmetry."""

import numpy as np
import pytest

STEPS = 200


def migrating_scene(scenes, boundary):
    """Three deformable and four center-based cells, crossing rank borders as they go.

    In a fixed or periodic box the bias carries the whole tissue by some 4 um.  A shrink-wrapped box
    and the borders in it would go along, so there the upper row slides over the lower one.  The
    solver tolerance of 1e-12 keeps what CG leaves over below what is compared (with the default of
    1e-6 ranks agree to about 1e-6).
    """
    shift = {"f f f": (3.0, 2.0, 0.5), "p p p": (22.0, 9.0, 10.0), "s s s": (0.0, 0.0, 0.0)}
    scene = scenes.hybrid(
        level=1, boundary=boundary, box=(27.0, 27.0, 14.0), shift=shift[boundary]
    )
    if boundary == "s s s":
        motility = (
            "group upper molecule 1 4 5\ngroup lower subtract all upper\n"
            f"fix right upper dcm/motility {scene.map} seed 7 D 1e-3 bias 1 0 0 16.0\n"
            f"fix left lower dcm/motility {scene.map} seed 8 D 1e-3 bias -1 0 0 16.0\n"
        )
    else:
        motility = scene.motility(options="D 1e-3 bias 1 0.7 0.3 8.0")
    return (
        scene.head()
        + scene.forces()
        + motility
        + scene.motion(options="tolerance 1e-12")
        + "comm_style brick\ntimestep 1.0\n"
    )


@pytest.mark.parametrize("boundary", ["f f f", "p p p", "s s s"])
def test_1_2_and_4_ranks_agree(lmp, scenes, boundary):
    deck = migrating_scene(scenes, boundary)
    deck += scenes.dump("id mol type proc xu yu zu vx vy vz fx fy fz", STEPS // 4)
    deck += scenes.thermo(["p=f_volume[1]", "press", "ebond"], STEPS // 4) + f"run {STEPS}\n"
    one = lmp(deck)
    frames = one.dump()
    for np_ in (2, 4):
        other = lmp(deck, np=np_)
        for a, b in zip(frames, other.dump(), strict=True):
            assert a.step == b.step
            assert (a["id"] == b["id"]).all()  # tags
            assert (a["mol"] == b["mol"]).all() and (a["type"] == b["type"]).all()
            assert np.abs(a.x - b.x).max() < 1e-9  # um
        last = other.dump()
        moved = np.flatnonzero(last[0]["proc"] != last[-1]["proc"])
        assert len(set(last[0]["proc"])) == np_
        kinds = set(last[0]["type"][moved])
        assert kinds >= {2, 3}, "no node or face changed its rank"
        for a, b in zip(one.thermo, other.thermo, strict=True):
            for key in a:
                assert b[key] == pytest.approx(a[key], rel=1e-9), (np_, a["Step"], key)


@pytest.mark.parametrize("options, dt, steps, bound", [
    ("", 1.0, 500, 1e-9), ("scheme implicit maxmove 1", 20.0, 50, 1e-7),
    ("scheme implicit maxmove 3", 200.0, 20, 1e-7)])    # factors of K are in single precision
def test_mirror_images_stay_mirror_images(lmp, scenes, options, dt, steps, bound):
    """Two cells, meshes and places each other's mirror image in x = 0, adhere; also in steps ten
    and a hundred times as long as the explicit scheme stands."""
    nodes, faces = scenes.icosphere(2)
    q, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    nodes = nodes @ (q * np.sign(np.linalg.det(q)))
    files = {
        "left.off": scenes.off(nodes, faces),
        "right.off": scenes.off(nodes * [-1, 1, 1], faces[:, [0, 2, 1]]),
    }
    scene = scenes.Scene((20.0, 12.0, 12.0), "s s s")
    for name, x in (("left.off", -5.95), ("right.off", 5.95)):
        scene.dcm(x, 0.0, 0.0, 6.0, mesh=(name, len(nodes), len(faces)), options="rest 0.95")
    deck = (
        scene.head()
        + scene.forces()
        + scene.motion(options=f"tolerance 1e-12 {options}")
        + scenes.dump("id mol type x y z vx vy vz fx fy fz", steps // 5)
        + scenes.thermo(["press"], steps // 5)
        + f"timestep {dt}\nrun {steps}\n"
    )
    frames = lmp(deck, files=files).dump()
    flip = np.array([-1, 1, 1])
    for frame in frames:
        left, right = frame["mol"] == 1, frame["mol"] == 2
        assert np.abs(frame.x[left] - frame.x[right] * flip).max() < bound
    first, last = frames[0], frames[-1]
    assert np.abs(last.x - first.x).max() > 0.1  # something happened
