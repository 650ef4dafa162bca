"""Growth of rest volumes, rest lengths and radii; rounding up; slowing by compression."""

import numpy as np
import pytest

from support.cycle_decks import growth, same, sphere
from support.parameters import FILES, PLAIN

COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"
STIFFNESS = 2 / 3**0.5 * 5.0 * 0.5  # k_s = 2/sqrt3 E h
AREA_MODULUS = 0.8756 * STIFFNESS  # of an icosphere's net of springs: sum of l^2/(4 area), over k_s
K_V = 2.5


def cell_dump(scenes, every):
    """Values of each cell, at the centers and spheres."""
    return (
        "group cells type 1 4\n"
        "compute of cells dcm/cell volume0 volume pressure\n"
        + scenes.dump("id mol type c_of[1] c_of[2] c_of[3]", every, "cells.txt", "cells")
    )


def rest_lengths(path):
    lines = [line.split() for line in path.read_text().splitlines() if line[0] != "#"]
    return np.array([float(w[2]) for w in lines if len(w) == 3])


def expected_factor(law, progress):
    """V0 over V0 at birth; the last 5 % of the cycle are for rounding up."""
    p = np.minimum(progress / 0.95, 1.0)
    return 1 + p if law == "linear" else 2.0**p


@pytest.mark.parametrize("law", ["linear", "exponential"])
def test_rest_state_follows_the_law(lmp, scenes, law):
    """V0 by the law, every l0 by its third root, then 1 to 0.95 in the last 5 %; nodes at rest."""
    scene = scenes.single_cell(boundary="f f f")
    scene.cbm(11.0, 11.0, 11.0, 3.0)
    stops = [0, 30, 95, 97, 100, 120]
    deck = scene.head() + scene.cortex() + "fix cell all dcm/cell\ncomm_modify cutoff 12\n"
    deck += growth(scene, f"cycle_time 100 law {law}") + cell_dump(scenes, 1)
    deck += scenes.dump("id type radius", 1, "radius.txt") + "timestep 1.0\n"
    for stop in stops:
        deck += f"run {stop} upto\nfix_modify cell rest/write rest.{stop}\n"
    result = lmp(deck)
    first = None
    for frame in result.dump("cells.txt"):
        first = first or frame
        factor = expected_factor(law, frame.step / 100)
        assert frame["c_of[1]"] == pytest.approx(factor * first["c_of[1]"], rel=1e-12)
    for frame in result.dump("radius.txt"):
        radius = frame["radius"][frame["type"] == 4]
        factor = expected_factor(law, frame.step / 100)
        assert radius == pytest.approx([3.0 * factor ** (1 / 3)], rel=1e-12)
    l0 = rest_lengths(result.path / "rest.0")
    assert len(l0) == 120
    for stop in stops:
        short = 1 - 0.05 * min(max(stop - 95, 0) / 5, 1)
        factor = short * expected_factor(law, stop / 100) ** (1 / 3)
        assert rest_lengths(result.path / f"rest.{stop}") == pytest.approx(factor * l0, rel=1e-12)


def test_free_cell_reaches_twice_and_rounds_up(lmp, scenes):
    """No pressure while it grows, p = 4 K_A eps/R at the end, below 0.2 kPa.

    The virial of springs in balance with a pressure, 3 p V = sum k l (l - l0), makes it exact for
    finite strain with eps = (l - l0)/l at the present l and R; these yield to the pressure as
    (V/V0)^(1/3), V/V0 = exp(-p/K_V).
    """
    scene = scenes.single_cell(level=2, boundary="f f f", options="rotate 3 rest 1")
    deck = scene.head() + scene.cortex() + "comm_modify cutoff 12\nfix cell all dcm/cell\n"
    deck += scene.volume() + growth(scene, "cycle_time 1500") + scene.motion()
    deck += cell_dump(scenes, 75) + "timestep 1.0\nrun 1575\n"
    frames = lmp(deck).dump("cells.txt")
    table = np.array([[f.step, *(f[f"c_of[{k}]"][0] for k in (1, 2, 3))] for f in frames])
    at = {int(row[0]): row[1:] for row in table}
    V0, V, p = at[1350]
    assert abs(p) < 0.01 and V == pytest.approx(V0, rel=0.005)
    V0, V, p = at[1500]  # end of the cycle
    assert V0 == pytest.approx(2 * at[0][0], rel=1e-12)
    assert p > 0
    V0, V, p = frames[-1]["c_of[1]"][0], frames[-1]["c_of[2]"][0], frames[-1]["c_of[3]"][0]
    R, expected = 6.0 * 2 ** (1 / 3), 0.0
    for _ in range(50):
        shrunk = np.exp(-expected / K_V / 3)
        expected = 4 * AREA_MODULUS * (1 - 0.95 / shrunk) / (R * shrunk)
    assert p == pytest.approx(expected, rel=0.03)
    assert table[:, 3].max() < 0.2
    assert V == pytest.approx(V0 * np.exp(-p / K_V), rel=1e-6)


@pytest.mark.parametrize("until", ["rest", "volume"])
def test_until_volume(lmp, scenes, until):
    """A cell under the tension of its cortex is smaller than V0: which of the two has to double?"""
    scene = scenes.single_cell(boundary="f f f", options="rotate 3 rest 0.95")
    deck = scene.head() + scene.cortex() + "comm_modify cutoff 12\nfix cell all dcm/cell\n"
    deck += scene.volume() + growth(scene, f"cycle_time 400 until {until}") + scene.motion()
    deck += cell_dump(scenes, 1) + scenes.thermo(["n=f_growth[2]"]) + "timestep 1.0\nrun 450\n"
    result = lmp(deck)
    begin = next(int(row["Step"]) for row in result.thermo if row["v_n"] == 1)  # rounding up
    frames = {f.step: [f[f"c_of[{k}]"][0] for k in (1, 2)] for f in result.dump("cells.txt")}
    born = frames[0][0]
    V0, V = frames[begin]
    if until == "rest":
        assert begin == 380 and V0 == pytest.approx(2 * born, rel=1e-12) and V < 1.99 * born
    else:
        # it looks at the volume that the last step has left
        V_born = frames[0][1]
        assert begin > 380 and frames[begin - 1][1] >= 2 * V_born > frames[begin - 2][1]
        assert 2 * born < V0 < 2.5 * born


def hill_growth(strain_of, half, exponent, duration, steps=20000):
    """Fine integration of df/dt = Hill(strain(f)), f(0) = 1, time in growth phases."""
    f, dt = 1.0, duration / steps

    def rate(f):
        return 1 / (1 + (max(strain_of(f), 0.0) / half) ** exponent)

    for _ in range(steps):
        f += dt * rate(f + 0.5 * dt * rate(f))
    return f


def test_compression_slows_deformable_cells(lmp, scenes):
    """Nodes that cannot move: V stays, strain 1 - V/V0 grows with V0."""
    scene = scenes.single_cell(boundary="f f f", options="rotate 3 rest 1")
    deck = scene.head() + scene.cortex() + "comm_modify cutoff 12\nfix cell all dcm/cell\n"
    deck += growth(scene, "cycle_time 2000 compression 0.1 2") + cell_dump(scenes, 475)
    frames = lmp(deck + "timestep 1.0\nrun 1900\n").dump("cells.txt")
    for frame in frames[1:]:
        expected = hill_growth(lambda f: 1 - 1 / f, 0.1, 2, frame.step / 1900)
        found = frame["c_of[1]"][0] / frames[0]["c_of[1]"][0]
        assert found == pytest.approx(expected, rel=1e-3)
    assert frames[-1]["c_of[1]"][0] < 1.5 * frames[0]["c_of[1]"][0]


def test_compression_slows_spheres(lmp, scenes):
    """Two fixed spheres: Hertz force F, strain p/K_V with p = F d/2 / (3 V)."""
    scene = scenes.Scene(20.0, "f f f", parameters=PLAIN)
    d = 9.5
    scene.cbm(-d / 2, 0.0, 0.0, 5.0)
    scene.cbm(d / 2, 0.0, 0.0, 5.0)
    deck = scene.head() + f"pair_style dcm/contact growth 1.3\npair_coeff * * {scene.map} "
    deck += "a1 0 a2 0 a3 0 a4 0\nneighbor 0.6 multi\nfix cell all dcm/cell\n"
    deck += growth(scene, "cycle_time 2000 compression 0.002 2")
    deck += scenes.dump("id radius fx", 475) + "timestep 1.0\nrun 1900\n"
    frames = lmp(deck, files=FILES).dump()
    modulus = 0.45 / (2 * (1 - 0.4**2))

    def force(R):
        return 4 / 3 * modulus * (R / 2) ** 0.5 * (2 * R - d) ** 1.5

    def strain(f):
        R = 5.0 * f ** (1 / 3)
        return force(R) * d / 2 / (3 * sphere(R)) / K_V

    for frame in frames:
        expected = hill_growth(strain, 0.002, 2, frame.step / 1900)
        assert frame["fx"][1] == pytest.approx(force(frame["radius"][1]), rel=1e-9)
        assert sphere(frame["radius"]) / sphere(5.0) == pytest.approx([expected] * 2, rel=1e-3)
    assert expected < 1.8


# --- ranks, restarts ------------------------------------------------------------------------------


def tissue(scenes, boundary="p p p"):
    """Three deformable and four center-based cells in contact, growing and rounding up."""
    scene = scenes.hybrid(level=1, boundary=boundary, box=(27.0, 27.0, 18.0), shift=(3.0, 2.0, 0.5))
    scene.parameters = PLAIN
    rest = scene.contact() + "fix cell all dcm/cell\n" + scene.volume()
    rest += growth(scene, "cycle_time 200 cycle_sd 4 compression 0.1 2")
    return scene, rest + scene.motion() + "timestep 1.0\n"


def test_radii_of_ghosts(lmp, scenes):
    """Two spheres on either side of a border between ranks, growing: the force of one rank."""
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(-4.9, 0.3, 0.2, 5.0)
    scene.cbm(4.9, 0.3, 0.2, 5.0)
    deck = "processors * 1 1\n" + scene.head() + scene.contact() + "fix cell all dcm/cell\n"
    deck += growth(scene, "cycle_time 100") + "timestep 1.0\n"
    deck += scenes.dump("id proc radius fx fy fz", 1) + "run 90\n"
    one, two = lmp(deck).dump(), lmp(deck, np=2).dump()
    assert set(two[0]["proc"]) == {0, 1}
    assert one[-1]["radius"][0] > 6.0
    assert np.abs(np.diff([f["fx"][0] for f in one])).min() > 0
    for a, b in zip(one, two, strict=True):
        assert np.array_equal(a["radius"], b["radius"])
        assert b.f == pytest.approx(a.f, rel=1e-12, abs=1e-14)


def test_1_2_and_4_ranks_agree(lmp, scenes):
    scene, rest = tissue(scenes)
    deck = scene.head() + scene.cortex() + rest + scenes.dump(COLUMNS, 65)
    deck += cell_dump(scenes, 65) + "run 195\n"
    one = lmp(deck, files=FILES)
    for np_ in (2, 4):
        other = lmp(deck, np=np_, files=FILES)
        for a, b in zip(one.dump(), other.dump(), strict=True):
            assert np.abs(a.x - b.x).max() < 1e-9
        for a, b in zip(one.dump("cells.txt"), other.dump("cells.txt"), strict=True):
            assert a["c_of[1]"] == pytest.approx(b["c_of[1]"], rel=1e-14)
            assert a["c_of[3]"] == pytest.approx(b["c_of[3]"], abs=1e-9)


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("at", [75, 195])
def test_restart_is_bit_for_bit(lmp, scenes, np_, at):
    """In the middle of growth, and of rounding up (190 to 200)."""
    scene, rest = tissue(scenes)
    tail = scenes.dump(COLUMNS, 5) + cell_dump(scenes, 5) + scenes.thermo(["n=f_growth[2]"])
    tail += f"restart {at} r.*\n"
    processors = "processors * 1 1\n"
    head = processors + scene.head() + scene.cortex()
    whole = lmp(head + rest + tail + f"run {at + 15}\n", np=np_, files=FILES)
    deck = f"read_restart r.{at}\npair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
    again = lmp(
        processors + deck + rest.replace(scene.contact(), "") + tail + "run 15\n",
        np=np_,
        files={**FILES, f"r.{at}": whole.path / f"r.{at}"},
    )
    assert (whole.thermo[at]["v_n"] > 0) == (at == 195)
    for name, columns in (("dump.txt", COLUMNS), ("cells.txt", "c_of[1] c_of[2] c_of[3]")):
        expected, found = whole.dump(name)[-4:], again.dump(name)
        for a, b in zip(expected, found, strict=True):
            same(a, b, columns)
