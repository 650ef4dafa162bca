"""fix dcm/motion scheme implicit and dt auto: the explicit scheme's motion, with large steps."""

import numpy as np
import pytest

from support.bad_decks import fails
from support.cycle_decks import growth, same

G_ECM = 1.0    # of support/parameters.py
COLUMNS = "id mol type xu yu zu vx vy vz fx fy fz"


def pair_of_cells(scenes, options, dt, seconds, more="", level=1):
    """Two cells that adhere and come to rest; the last frame has where that has led."""
    scene = scenes.doublet(level=level)
    steps = round(seconds / dt)
    return (
        scene.head() + scene.forces() + scene.motion(options=f"tolerance 1e-12 {options}") + more
        + scenes.dump(COLUMNS, steps) + scenes.thermo(["p=f_volume[1]", "ebond", "time"], steps)
        + f"timestep {dt!r}\nrun {steps}\n"
    )


def error(result, reference):
    a, b = result.dump()[-1], reference.dump()[-1]
    nodes = b["type"] == 2
    return np.sqrt(np.mean(np.sum((a.x[nodes] - b.x[nodes]) ** 2, axis=1)))


def test_first_order_in_the_step(lmp, scenes):
    """The error against a fine explicit run halves with the step: backward Euler's order."""
    reference = lmp(pair_of_cells(scenes, "", 0.05, 64.0))
    errors = [error(lmp(pair_of_cells(scenes, "scheme implicit", dt, 64.0)), reference)
              for dt in (4.0, 2.0, 1.0)]
    moved = reference.dump()
    nodes = moved[0]["type"] == 2
    assert errors[0] < 0.1 * np.abs(moved[-1].x[nodes] - moved[0].x[nodes]).max()
    for large, small in zip(errors, errors[1:]):
        assert 1.7 < large / small < 2.3, errors


@pytest.mark.parametrize("dt", [10.0, 40.0])
def test_large_steps_end_at_the_same_rest(lmp, scenes, dt):
    """Steps 5 and 20 times as long as the explicit scheme stands lead to the same state of rest,
    but for how facet lies on facet when the cells come to rest."""
    run = "scheme implicit maxmove 1"
    long = lmp(pair_of_cells(scenes, run, dt, 16000.0))
    short = lmp(pair_of_cells(scenes, run, 4.0, 16000.0))
    assert "maxmove" in lmp.run(pair_of_cells(scenes, "", dt, 16000.0)).error    # explicit
    for name in ("v_p", "E_bond"):
        assert long.thermo[-1][name] == pytest.approx(short.thermo[-1][name], rel=0.01)


@pytest.mark.parametrize("options", ["scheme implicit", "scheme implicit dt auto tol 0.02 max 20",
                                     "scheme implicit accuracy 0.02 dt auto max 20"])
@pytest.mark.parametrize("boundary", ["f f f", "p p p"])
def test_1_2_3_and_4_ranks_agree(lmp, scenes, options, boundary):
    """Cells of both kinds in contact; the same steps are chosen on any number of ranks."""
    scene = scenes.hybrid(level=1, boundary=boundary, box=(27.0, 27.0, 14.0), shift=(3.0, 2.0, 0.5))
    deck = (scene.head() + scene.forces() + scene.motion(options=f"tolerance 1e-13 {options}")
            + scenes.dump(COLUMNS, 20)
            + scenes.thermo(["p=f_volume[1]", "ebond", "time", "dt"], 20)
            + "timestep 4.0\nrun 60\n")
    one = lmp(deck)
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_)
        for a, b in zip(one.dump(), other.dump(), strict=True):
            assert np.abs(a.x - b.x).max() < 1e-8    # um
        for a, b in zip(one.thermo, other.thermo, strict=True):
            for key in a:
                assert b[key] == pytest.approx(a[key], rel=1e-8), (np_, a["Step"], key)


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("options", ["scheme implicit", "scheme implicit dt auto tol 0.01 max 20",
                                     "scheme implicit accuracy 0.01 dt auto max 20"])
def test_restart_is_bit_for_bit(lmp, scenes, np_, options):
    scene = scenes.hybrid(level=1, boundary="f f f", box=(27.0, 27.0, 14.0), shift=(3.0, 2.0, 0.5))
    rest = ("fix cell all dcm/cell\n" + scene.volume() + growth(scene, "cycle_time 4e3")
            + scene.motion(options=options) + scenes.dump(COLUMNS, 20)
            + scenes.thermo(["p=f_volume[1]", "ebond", "time", "dt"], 20)
            + "restart 30 r.*\n")
    whole = lmp(scene.head() + scene.cortex() + scene.contact() + "timestep 2.0\n" + rest
                + "run 60\n", np=np_)
    again = lmp(f"read_restart r.30\npair_coeff * * {scene.map}\nneighbor 0.6 multi\n" + rest
                + "run 30\n", np=np_, files={"r.30": whole.path / "r.30"})
    assert whole.thermo[-1]["Step"] == again.thermo[-1]["Step"] == 60
    same(whole.dump()[-1], again.dump()[-1], COLUMNS)
    assert whole.thermo[-1] == again.thermo[-1]


def test_two_runs_are_one(lmp, scenes):
    """A run that is split goes on with the step it had."""
    def deck(runs):
        scene = scenes.doublet()
        return (scene.head() + scene.forces()
                + scene.motion(options="tolerance 1e-12 scheme implicit dt auto tol 0.01 max 20")
                + scenes.dump(COLUMNS, 40) + "timestep 2.0\n" + runs)

    one, two = lmp(deck("run 40\n")), lmp(deck("run 17\nrun 23\n"))    # lists are built anew
    assert np.abs(one.dump()[-1].x - two.dump()[-1].x).max() < 1e-9


def growing_cell(scenes, options, hours, dt, more=""):
    scene = scenes.single_cell(level=2, boundary="f f f", box=15.0)
    return (scene.head() + scene.cortex() + "comm_modify cutoff 8\nfix cell all dcm/cell\n"
            + scene.volume() + growth(scene, "cycle_time 3600 cycle_sd 0")
            + scene.motion(options=options)
            + scenes.thermo(["p=f_volume[1]", "t=time", "ready=f_growth[3]"], 100000) + more
            + f"timestep {dt}\nrun {round(hours * 3600 / dt)}\n")


def test_growth_is_seen_ahead(lmp, scenes):
    """The rest volume grows within a step. With steps of 30 s the pressure of a cell that grows 20
    times too fast is that of steps of 0.5 s to 1 %; with the rest state of the step's begin it
    would lag by one step of growth, which alone is K_V dV0/V0, several percent of it."""
    fine = lmp(growing_cell(scenes, "tolerance 1e-10", 0.5, 0.5)).thermo[-1]
    coarse = lmp(growing_cell(scenes, "tolerance 1e-10 scheme implicit", 0.5, 30.0)).thermo[-1]
    assert coarse["v_t"] == pytest.approx(fine["v_t"]) == 1800.0
    assert coarse["v_p"] == pytest.approx(fine["v_p"], rel=0.01)


def test_a_phase_ends_with_a_step(lmp, scenes):
    """Growth ends after 0.95 of the cycle, 3420 s, and the cell is ready after 3600 s: exactly."""
    result = lmp(growing_cell(
        scenes, "scheme implicit dt auto tol 0.05 max 50 stop 3600", 100, 1.0,
        "thermo 1\n"))
    times = [(row["v_t"], row["v_ready"]) for row in result.thermo]
    assert any(t == pytest.approx(3420.0, abs=1e-6) for t, _ in times)
    assert times[-1] == (pytest.approx(3600.0, abs=1e-6), 1.0)
    assert all(ready == 0.0 for t, ready in times if t < 3599.9)


def test_runs_stop_at_a_time(lmp, scenes):
    """The last step ends there, thermo output included; the next run goes on."""
    scene = scenes.doublet()
    result = lmp(
        scene.head() + scene.forces()
        + scene.motion(options="scheme implicit dt auto tol 0.01 max 20 stop 77.7")
        + scenes.thermo(["time", "dt"], 1000) + "timestep 2.0\nrun 100000\n"
        + "fix_modify motion stop 200\nrun 100000\n"
        + "fix_modify motion stop 100\nrun 100000\n")    # it is over
    last = [run[-1]["Time"] for run in result.runs]
    assert last == [pytest.approx(77.7, abs=1e-9), pytest.approx(200.0, abs=1e-9),
                    pytest.approx(200.0, abs=1e-9)]
    warned = [w for w in result.out.splitlines() if "WARNING" in w and "ends at once" in w]
    assert len(warned) == 1 and "stop 100 is not after the time 200" in warned[0]
    fixed = lmp(scene.head() + scene.forces() + scene.motion(options="stop 9")
                + scenes.thermo(["time"], 1000) + "timestep 2.0\nrun 100000\n")
    assert fixed.thermo[-1]["Time"] == 10.0    # a timestep of given length is not cut


@pytest.mark.parametrize("np_", [1, 2])
def test_wall_time_that_is_left(lmp, scenes, np_):
    """By the time of a run, by its steps where these end it: against LAMMPS' wall time."""
    scene = scenes.doublet()
    result = lmp(
        scene.head() + scene.forces()
        + scene.motion(options="scheme implicit dt auto tol 0.002 max 2 stop 50")
        + scenes.thermo(["time", "cpu", "cpuremain", "left=f_motion[13]"]) + "timestep 1.0\n"
        + "run 100000\nfix_modify motion stop 100\nrun 100000\n"
        + "fix_modify motion stop 1e9\nrun 30\n", np=np_)
    ends = [50.0, 100.0, None]
    for rows, end in zip(result.runs, ends, strict=True):
        assert len(rows) > 20
        for row in rows[1:]:
            share = 0.0
            if end and row["Time"] < end - 1e-9:
                share = (end - row["Time"]) / (row["Time"] - rows[0]["Time"])
            if not end:
                share = (rows[-1]["Step"] - row["Step"]) / (row["Step"] - rows[0]["Step"])
            assert row["v_left"] == pytest.approx(share * row["CPU"], rel=0.05, abs=2e-3 * share)
        assert rows[0]["v_left"] == 0.0 and rows[-1]["v_left"] == pytest.approx(0.0, abs=1e-9)
        assert any(row["v_left"] > 0.0 for row in rows)


def test_dumps_by_time_are_met(lmp, scenes):
    """... and have the values of that step, not of the last one that was printed."""
    scene = scenes.doublet()
    result = lmp(
        scene.head() + scene.forces()
        + scene.motion(options="scheme implicit dt auto tol 0.01 max 20 stop 60")
        + "compute c all dcm/cell volume\ncompute x all property/atom xu\n"
        + "dump d all custom 1000 d.txt id xu c_x c_c\n"
        + "dump_modify d every/time 15 time yes sort id format float %.17g\n"
        + scenes.thermo(["time", "v=C_c[1]"], 100000) + "timestep 2.0\nrun 100000\n")
    text = (result.path / "d.txt").read_text().splitlines()
    times = [float(text[k + 1]) for k, line in enumerate(text) if line == "ITEM: TIME"]
    assert times == pytest.approx([0.0, 15.0, 30.0, 45.0, 60.0], abs=1e-9)
    rows = [line.split() for line in text if len(line.split()) == 4 and line[0].isdigit()]
    assert len(rows) > 1000 and all(row[1] == row[2] for row in rows)


def energy_balance(lmp, scenes, dt, seconds=48):
    """Elastic energy that a stretched cell loses as it relaxes, from 20 s on, and the sum of dt F.v
    over the steps."""
    scene = scenes.single_cell(level=2, boundary="f f f", box=15.0)
    result = lmp(
        scene.head() + scene.cortex() + "comm_modify cutoff 8\nfix cell all dcm/cell\n"
        + scene.volume() + "group nodes type 2\n"
        + "displace_atoms all ramp x 0 1.5 x -6 6\n"
        + scene.motion(options="tolerance 1e-12 scheme implicit maxmove 1")
        + "variable fv atom fx*vx+fy*vy+fz*vz\ncompute power nodes reduce sum v_fv\n"
        + scenes.thermo(["pe", "E=ebond+edihed+f_volume", "p=c_power"])
        + f"timestep 0.1\nrun 200\ntimestep {dt}\nrun {round(seconds / dt)}\n").thermo
    result = [row for row in result if row["Step"] >= 200][-round(seconds / dt) - 1:]
    lost = result[0]["v_E"] - result[-1]["v_E"]
    return lost, dt * sum(row["v_p"] for row in result[:-1])


def test_energy_balance_is_of_first_order(lmp, scenes):
    """What a relaxing cell loses of its elastic energy is the work of its forces along its motion.
    Euler takes the force at the begin of the step: the gap halves with the step."""
    gaps = []
    for dt in (4.0, 2.0, 1.0, 0.5):
        lost, work = energy_balance(lmp, scenes, dt)
        assert lost > 0.1 and work > 0.0, (lost, work)
        gaps.append(abs(work - lost) / lost)
    assert gaps[-1] < 0.02
    for coarse, fine in zip(gaps, gaps[1:], strict=False):
        assert 1.6 < coarse / fine < 2.4, gaps


def test_stiffness_moves_no_center_of_friction(lmp, scenes):
    """Two equal spheres that attract each other keep the mean of their positions: stiffness, like
    forces between cells, adds up to nothing."""
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(-4.6, 0.3, -0.2, 5.0)
    scene.cbm(4.6, -0.3, 0.2, 5.0)
    result = lmp(scene.head() + scene.contact() + "fix cell all dcm/cell\n"
                 + scene.motion(options="tolerance 1e-14 scheme implicit")
                 + scenes.dump(COLUMNS, 10) + "timestep 50.0\nrun 20\n")
    first, last = result.dump()[0], result.dump()[-1]
    assert np.abs((last.x - first.x).mean(axis=0)).max() < 1e-12
    assert np.abs(last.x - first.x).max() > 0.01


def adhering(lmp, scenes, layer, longest):
    """The end of 400 steps in which two cells of layers so thick (um) adhere and come to rest; m is
    the longest way of a node in a step, in edges."""
    scene = scenes.doublet(level=2)
    return lmp(
        scene.head() + "group a molecule 1\ngroup b molecule 2\n" + scene.cortex()
        + scene.contact("law foundation", f"layer {layer}") + "fix cell all dcm/cell\n"
        + scene.volume()
        + scene.motion(options="scheme implicit tolerance 1e-3 "
                       f"dt auto tol 0.02 max {longest}")
        + scenes.thermo(["p=f_volume[1]", "d=xcm(b,x)-xcm(a,x)", "h=dt", "m=f_motion[4]"], 50)
        + "timestep 1.0\nrun 400\n").thermo[-1]  # fmt: skip


def test_stiff_contacts_take_the_same_steps(lmp, scenes):
    """Layers a tenth as thick are ten times as stiff, 119 kPa/um: friction over stiffness is 0.4 s.
    The cells come to the same rest in steps of 20 s."""
    soft, stiff = (adhering(lmp, scenes, layer, 20) for layer in (0.25, 0.025))
    assert soft["v_h"] == stiff["v_h"] == 20.0
    assert stiff["v_p"] == pytest.approx(soft["v_p"], rel=0.01)
    assert stiff["v_d"] == pytest.approx(soft["v_d"], rel=0.01)


@pytest.mark.parametrize("layer, longest", [(0.25, 60), (0.1, 60), (0.025, 20)])
def test_nodes_come_to_rest(lmp, scenes, layer, longest):
    """The stiffness of contacts knows how faces tilt: without it nodes go a tenth of an edge and
    more to and fro, step by step, while the cells as a whole rest."""
    end = adhering(lmp, scenes, layer, longest)
    assert end["v_h"] == longest
    assert end["v_m"] < 0.002


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_a_plane_may_be_as_stiff_as_it_likes(lmp, scenes, np_):
    """Backward Euler: a step divides the distance from the plane by 1 + dt K/Gamma, Gamma = g A, of
    a sphere and of a cell held by the mean of its nodes; here by 450 and 200, where explicit steps
    overshoot."""
    K, dt, radii = 1.5e3, 60.0, (6.0, 4.0)
    scene = scenes.Scene(20.0, "f f f")
    scene.dcm(0.0, 0.0, 3.0, radii[0], options="rotate 3 rest 1.0")
    scene.cbm(14.0, 0.0, -4.0, radii[1])

    def deck(options):
        return (
            scene.head() + scene.forces() + f"fix plane all dcm/confine plane z {K}\n"
            + scene.motion(options=f"tolerance 1e-13 maxmove 10 {options}")
            + "group cells type 1 4\ncompute of cells dcm/cell z area\n"
            + scenes.dump("id c_of[1] c_of[2]", 1, group="cells") + f"timestep {dt}\nrun 2\n"
        )  # fmt: skip

    frames = lmp(deck("scheme implicit"), np=np_).dump()
    for k, within in ((0, 0.1), (1, 1e-9)):    # the cell is bent: nodes have unlike shares of A
        z = [frame["c_of[1]"][k] for frame in frames]
        area = frames[0]["c_of[2]"][k]
        for before, after in zip(z, z[1:]):
            assert before / after == pytest.approx(1.0 + dt * K / (G_ECM * area), rel=within)
    run = lmp.run(deck(""))
    assert "maxmove" in run.error or abs(run.dump()[-1]["c_of[1]"][1]) > 4.0


BAD = {
    "no tol": ("scheme implicit dt auto max 3", "dt auto needs tol"),
    "explicit": ("scheme explicit dt auto tol 0.1", "dt auto does not go with scheme explicit"),
    "min above max": ("scheme implicit dt auto tol 0.1 min 3 max 2", "min is 3, above max 2"),
    "tol": ("scheme implicit dt auto tol 0", "dt auto tol is 0.*positive"),
    "max": ("scheme implicit dt auto tol 1 max x", "dt auto max is 'x'"),
    "dt": ("scheme implicit dt 3", "dt must be auto"),
    "scheme": ("scheme x", "scheme must be explicit or implicit, not x"),
    "stop": ("stop -1", "stop is -1.*positive"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_arguments(lmp, scenes, name):
    options, message = BAD[name]
    scene = scenes.doublet()
    fails(lmp, scene.head() + scene.forces() + scene.motion(options=options), message)


def test_who_does_not_go_with_it(lmp, scenes):
    scene = scenes.doublet()
    start = scene.head() + scene.forces()
    motion = scene.motion(options="scheme implicit dt auto tol 0.1")
    fails(lmp, start + scene.motility() + motion, "dt auto.*dcm/motility")
    fails(lmp, start + motion + "fix r all dt/reset 1 0.1 1 0.1\n", "dt/reset.*unfix one")
