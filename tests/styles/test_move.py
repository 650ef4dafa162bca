"""fix dcm/move: bodies at a given velocity, and what the others do to them."""

import numpy as np
import pytest

from support.bad_decks import fails

G_ECM = 1.0    # of support/parameters.py
R = 5.0
SCHEMES = ["explicit", "implicit"]
FAR = "neighbor 2.0 multi\n"    # for the necks of spheres
DRAG = "compute free all dcm/cell free_area\n" + "".join(
    f"variable load{a} atom -{G_ECM}*c_free*v{a}\ncompute load{a} others reduce sum v_load{a}\n"
    for a in "xyz")


def spheres(scenes, move, scheme="explicit"):
    """Two spheres beside each other along x that rub and push; the first one is moved. Forces on
    it, against the drag of the surroundings on the other one."""
    scene = scenes.Scene(30.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, R)
    scene.cbm(2 * R - 0.2, 1.0, 0.5, R)
    return (
        scene.head()
        + "bond_style zero nocoeff\nbond_coeff *\ndihedral_style zero nocoeff\n"
        + "dihedral_coeff *\n"
        + scene.contact("law dmt", "friction_normal 3 friction_tangential 5")
        + FAR + "fix cell all dcm/cell\ngroup body id 1\ngroup others subtract all body\n"
        + f"fix body body dcm/move {move}\n"
        + scene.motion("others", f"tolerance 1e-13 maxmove 5 scheme {scheme}")
        + DRAG
    )


LOADS = ["c_loadx", "c_loady", "c_loadz", "f_body[1]", "f_body[2]", "f_body[3]"]


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("move", ["linear 0.01 0.004 -0.002", "rotate 0 1 0 0 0 1 2e-3",
                                  "linear 0.01 0 0 rotate 0 0 0 1 1 1 4e-3"])
def test_load_is_the_drag_of_what_is_pushed(lmp, scenes, move, scheme, np_):
    """What pushes and rubs the free sphere is balanced by its friction with the surroundings, so
    that this is the load of the moved one, whatever the law of contact."""
    rows = lmp(spheres(scenes, move, scheme)
               + scenes.thermo(LOADS, 20) + "timestep 0.5\nrun 200\n", np=np_).thermo
    loads = np.array([[row[c] for c in LOADS] for row in rows])
    assert np.abs(loads[:, 0]).max() > 0.1
    np.testing.assert_allclose(loads[:, 3:], loads[:, :3], rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_pushed_sphere_follows(lmp, scenes, scheme):
    """Without friction in the contact the free sphere comes to move as fast as the one that pushes
    it along the line of their centers."""
    scene = scenes.Scene(30.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, R)
    scene.cbm(2 * R - 0.2, 0.0, 0.0, R)
    names = ["vx1=vx[1]", "vx2=vx[2]", "x=x[1]"]
    smooth = scene.contact("law dmt", "friction_normal 0 friction_tangential 0")
    rows = lmp(scene.head() + scene.cortex() + smooth + FAR
               + "fix cell all dcm/cell\ngroup body id 1\nfix body body dcm/move linear 0.01 0 0\n"
               + scene.motion("all", f"tolerance 1e-12 scheme {scheme}")
               + scenes.thermo([*names, "f_body[1]"], 100)
               + "timestep 1.0\nrun 2000\n").thermo
    assert rows[-1]["v_x"] == pytest.approx(20.0, rel=1e-12)
    assert rows[-1]["v_vx1"] == 0.01
    assert rows[-1]["v_vx2"] == pytest.approx(0.01, rel=1e-4)
    assert rows[-1]["f_body[1]"] < -0.5


@pytest.mark.parametrize("np_", [1, 3])
def test_turns_exactly(lmp, scenes, np_):
    """A deformable cell that is turned is rigid: after a quarter, a half and a whole turn its nodes
    are where a rotation of the first frame has them, in steps of any length; faces and centers go
    with their nodes, and a body among others in a periodic box does as well."""
    scene = scenes.Scene(20.0, "p p p")    # the body crosses the border of the box
    scene.dcm(17.0, 0.0, 0.0, 5.0)
    scene.cbm(-8.0, 14.0, 14.0, R)
    deck = (scene.head() + scene.forces() + FAR + "group body molecule 1\n"
            + "fix body body dcm/move rotate 12 0 0 0 0 1 $(PI/200)\n"
            + scene.motion("all", "maxmove 5")
            + scenes.dump("id type xu yu zu", 1))
    frames = lmp(deck + "timestep 10.0\nrun 10\ntimestep 2.5\nrun 40\ntimestep 100\nrun 2\n",
                 np=np_).dump()
    first = frames[0]
    body = first["type"] < 4
    x0 = np.array([first["xu"] - 12.0, first["yu"], first["zu"]])[:, body]
    for frame, angle in ((frames[10], np.pi / 2), (frames[50], np.pi), (frames[52], 2 * np.pi)):
        x = np.array([frame["xu"] - 12.0, frame["yu"], frame["zu"]])[:, body]
        c, s = np.cos(angle), np.sin(angle)
        np.testing.assert_allclose(x, [c * x0[0] - s * x0[1], s * x0[0] + c * x0[1], x0[2]],
                                   atol=1e-9)


def pressed(scenes, steps, more=""):
    """A plate, a large sphere, comes down on three cells and a sphere and turns; its velocity is
    that of a variable."""
    scene = scenes.hybrid(level=1, boundary="f f f", box=(27.0, 27.0, 34.0))
    scene.cbm(0.0, 0.0, 23.5, 18.5)
    plate = scene.next_tag - 1
    fixes = (
        "fix cell all dcm/cell\n" + scene.volume() + f"group plate id {plate}\n"
        + "variable down equal -0.01*(1+sin(0.05*time))\nvariable turn equal 1e-3*cos(0.02*time)\n"
        + "group cells subtract all plate\nfix floor cells dcm/confine plane z 2.0\n"
        + "fix press plate dcm/move linear 0 0 v_down rotate 0 0 0 0 1 1 v_turn\n"
        + scene.motion("all", "tolerance 1e-12 scheme implicit dt auto tol 0.02 min 0.5 max 4")
        + "timestep 1.0\n"
    )
    out = (scenes.dump("id type xu yu zu vx vy vz", 10)
           + scenes.thermo([f"f_press[{k}]" for k in range(1, 7)], 10))
    contact = scene.contact("law foundation", "friction_normal 3 friction_tangential 5") + FAR
    return scene, (scene.head() + scene.cortex() + contact + fixes + out + more
                   + f"run {steps}\n"), fixes, out, contact


def same(a, b, exact):
    for one, two in zip(a.dump(), b.dump(), strict=True):
        for c in ("xu", "yu", "zu", "vx", "vy", "vz"):
            if exact:
                assert np.array_equal(one[c], two[c]), (one.step, c)
            else:
                np.testing.assert_allclose(two[c], one[c], atol=1e-7)
    for one, two in zip(a.thermo, b.thermo, strict=True):
        for k in range(1, 7):
            name = f"f_press[{k}]"
            if exact:
                assert one[name] == two[name]
            else:
                assert two[name] == pytest.approx(one[name], rel=1e-6, abs=1e-6)


def test_ranks_agree(lmp, scenes):
    _, deck, *_ = pressed(scenes, 60)
    one = lmp(deck)
    assert one.thermo[-1]["f_press[3]"] > 0.5
    for np_ in (2, 3, 4):
        same(one, lmp(deck, np=np_), exact=False)


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_is_bit_for_bit(lmp, scenes, np_):
    scene, deck, fixes, out, contact = pressed(scenes, 60, "restart 30 r.*\n")
    whole = lmp("processors * 1 1\n" + deck, np=np_)
    coeff = contact[contact.index("pair_coeff"):]
    rest = lmp("processors * 1 1\nread_restart r.30\n" + coeff + fixes + out
               + "restart 30 r.*\nrun 30\n", np=np_, files={"r.30": whole.path / "r.30"})
    frames = [f for f in whole.dump() if f.step >= 30]
    for one, two in zip(frames, rest.dump(), strict=True):
        for c in ("xu", "yu", "zu", "vx", "vy", "vz"):
            assert np.array_equal(one[c], two[c]), (one.step, c)
    for one, two in zip(whole.thermo[3:], rest.thermo, strict=True):
        for k in range(1, 7):
            assert one[f"f_press[{k}]"] == two[f"f_press[{k}]"]


def test_velocity_of_each_atom(lmp, scenes):
    """An atom-style variable stretches a body: x grows as exp(0.01 t) in short steps."""
    scene = scenes.Scene(30.0, "f f f")
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    deck = (scene.head() + scene.forces() + "variable v atom 0.01*x\n"
            + "fix body all dcm/move linear v_v 0 0\n" + scene.motion())
    deck += scenes.dump("id type xu yu zu", 100) + "timestep 0.1\nrun 100\n"
    first, last = lmp(deck).dump()
    nodes = first["type"] == 2
    np.testing.assert_allclose(last["xu"][nodes], 1.001**100 * first["xu"][nodes], rtol=1e-9)
    np.testing.assert_allclose(last["yu"][nodes], first["yu"][nodes], atol=1e-12)


def test_too_fast_a_plate_is_told(lmp, scenes):
    """A plate is large, the cells before it are not: the step is measured with their edges."""
    scene = scenes.Scene(60.0, "f f f")
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(0.0, 0.0, 47.0, 40.0)
    result = lmp.run(scene.head() + scene.forces() + FAR + "group plate type 4\n"
                     + "fix press plate dcm/move linear 0 0 -2\n" + scene.motion()
                     + "timestep 1.0\nrun 1\n")
    assert result.returncode != 0
    assert "would move by 2 at step" in result.error and "maxmove" in result.error


def test_a_velocity_that_is_ignored_is_told(lmp, scenes):
    scene = scenes.doublet()
    deck = (scene.head() + scene.forces() + "group still molecule 2\n"
            + "group moves subtract all still\n" + scene.motion("moves"))
    assert "stay where they are" not in lmp(deck + "run 1\n").log
    log = lmp(deck + "velocity still set 0.1 0 0\nrun 1\n").log
    assert "velocity 0.1 0 0 and will stay where they are all the same; fix dcm/move" in log


BAD = {
    "nothing": ("", "give 'linear Vx Vy Vz'"),
    "two": ("linear 1 2", "linear needs 3 values, got 2"),
    "text": ("linear 1 2 fast", "velocity is 'fast', expected a number"),
    "no axis": ("rotate 0 0 0 0 0 0 1", "rotate is 0.*an axis that is not 0 0 0"),
    "no variable": ("linear 0 0 v_none", "velocity: there is no .*variable none"),
    "not a number": ("linear 0 0 v_bad", "variable bad gives the velocity"),
    "of an atom": ("rotate 0 0 0 0 0 1 v_each", "variable each gives the rate .* for atom"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_arguments(lmp, scenes, case):
    words, pattern = BAD[case]
    scene = scenes.doublet()
    fails(lmp, scene.head() + scene.forces() + "variable bad equal 1e300*1e300\n"
          + "variable each atom 1e300*1e300+x\ngroup one molecule 1\n"
          + f"fix push one dcm/move {words}\n" + scene.motion(), "Fix dcm/move", pattern)


def test_bad_velocity_in_a_run(lmp, scenes):
    scene = scenes.doublet()
    fails(lmp, scene.head() + scene.forces() + "variable v equal 1/(time-time)\n"
          + "group one molecule 1\nfix push one dcm/move linear 0 0 v_v\n" + scene.motion(),
          "[Dd]ivide by 0|variable v gives the velocity")


def test_bad_decks(lmp, scenes):
    scene = scenes.doublet()
    start = scene.head() + scene.forces() + "group one molecule 1\n"
    move = "fix push one dcm/move linear 0 0 0.1\n"
    fails(lmp, start + move, "Fix dcm/move push: there is no fix dcm/motion")
    fails(lmp, start + scene.motion() + move, "Fix dcm/move: fix push stands after fix motion")
    fails(lmp, start + move + "fix more all dcm/move linear 0.1 0 0\n" + scene.motion(),
          "in the group of another fix dcm/move")
    fails(lmp, start + "group nodes type 3\nfix push nodes dcm/move linear 0 0 1\n"
          + scene.motion(), "Fix dcm/move")
    fails(lmp, start + "fix old one move linear 0 0 1\n" + scene.motion(), "fix dcm/move")


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("how", ["rests", "moves"])
def test_h0_of_the_others(lmp, scenes, how, np_):
    """The range of adhesion follows the edges of the cells that are solved for, not those of a
    slab with a mesh of its own."""
    scene = scenes.Scene(45.0, "f f f", level=2)
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    alone = lmp(scene.head() + scene.forces() + scene.motion() + "run 0\n").log
    scene.dcm(0.0, 0.0, -25.0, 15.0, level=1)
    both = scene.head() + scene.forces() + "group slab molecule 2\ngroup cell molecule 1\n"
    slab = {"rests": scene.motion("cell"),
            "moves": "fix push slab dcm/move linear 0 0 0.1\n" + scene.motion()}[how]

    def chosen(log):
        line = next(line for line in log.splitlines() if "mean edge" in line)
        return [float(line.split(word)[1].split(",")[0]) for word in ("mean edge", "h0")]

    assert chosen(lmp(both + slab + "run 0\n", np=np_).log) == pytest.approx(chosen(alone), 1e-5)
    with_slab = chosen(lmp(both + scene.motion() + "run 0\n", np=np_).log)
    assert with_slab[0] > 1.5 * chosen(alone)[0]
