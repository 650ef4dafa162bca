"""Populations of center-based cells that divide: numbers, lineage, sisters, restarts."""

from math import erf

import numpy as np
import pytest

from lammps_dcm import Lineage, read_divisions
from support.cycle_decks import counting, growth, same, sphere
from support.parameters import FILES, PLAIN

COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"
DIVIDE = "fix division all dcm/division seed 4 log division.log "


def cells_thermo(scenes, every):
    return scenes.thermo(["atoms", "n=f_growth", "births=f_growth[6]", "deaths=f_growth[7]"], every)


# --- numbers --------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ["linear", "exponential"])
def test_doubles_at_every_cycle_time(lmp, scenes, law):
    deck = counting(3, f"cycle_time 100 law {law}") + DIVIDE + "\n"
    rows = lmp(deck + cells_thermo(scenes, 1) + "run 650\n").thermo
    for row in rows:
        n = 3 * 2 ** int(row["Step"] // 100)
        assert row["Atoms"] == row["v_n"] == n
        assert row["v_births"] == 2 * (n - 3) and row["v_deaths"] == 0


def test_cycle_times_vary(lmp, scenes):
    """First divisions: N0 Phi((t - m)/s); second, after two times: 2 N0 Phi((t - 2m)/(s sqrt2)).

    Deviations: binomial, and at most 1 per founder, as it has 0 to 2 second divisions. A division
    waits for the end of its step, on average half a step.
    """
    N0, m, s = 400, 500.0, 50.0
    deck = counting(N0, f"cycle_time {m} cycle_sd {s}") + DIVIDE + "\n"
    result = lmp(deck + cells_thermo(scenes, 50) + "run 1100\n")
    log = read_divisions(result.path / "division.log")

    def normal(z):
        return 0.5 * (1 + erf(z / 2**0.5))

    for t in (450, 500, 530, 950, 1000, 1050):
        z = t + 0.5
        p1, p2 = normal((z - m) / s), normal((z - 2 * m) / (s * 2**0.5))
        done = log.time <= t
        assert (done & (log.generation == 1)).sum() == pytest.approx(
            N0 * p1, abs=3 * (N0 * p1 * (1 - p1)) ** 0.5 + 0.5
        )
        seconds = (done & (log.generation == 2)).sum()
        assert seconds == pytest.approx(2 * N0 * p2, abs=3 * (N0 * 4 * p2 * (1 - p2)) ** 0.5 + 2)

    # a full cycle of every founder's first daughters has been seen, except late ones
    tree = Lineage(log)
    times = tree.cycle_time[(tree.generation == 1) & (tree.birth < 430)]
    early = times[~np.isnan(times)]
    assert len(early) > 30
    error = s / len(early) ** 0.5
    assert early.mean() == pytest.approx(m + 0.5, abs=3 * error)
    assert early.std() == pytest.approx(s, abs=3 * error / 2**0.5)


@pytest.mark.parametrize("f", [1.0, 0.5, 0.25])
def test_proliferating_fraction(lmp, scenes, f):
    """N = N0 2^(f t/T).

    With a rate b of divisions, the number of cycling cells C = f N changes by f b = b - h C, so
    cells leave the cycle at the rate h = (1 - f) b/C, whatever their age. b(t) = 2 b(t - T)
    exp(-h T) and N ~ exp(k t), b = k N give kT = ln 2 - (1 - f) kT/f, thus kT = f ln 2. Ages a of
    cycling cells then are spread as 2^(-a/T): the start. Error: that of a Yule process of the
    cycling cells, which is an upper bound, as their cycle times do not vary.
    """
    N0, T = 600, 100
    u = (np.arange(N0) + 0.5) / N0
    age = -np.log2(1 - u / 2)  # of a distribution function 2 (1 - 2^-a)
    born = float(sphere(4.0))
    create = ""
    for k, radius in enumerate(4.0 * (1 + age) ** (1 / 3)):  # linear law: V = V_born (1 + a)
        create += f"create_cells single cbm cbm {8.0 * k - 8 * N0 / 2 + 1} 0 0 {radius} cbm cbm 4\n"
    a = 8 * N0
    deck = (
        "units lj\natom_style dcm\nnewton on\nboundary f f f\n"
        f"region box block {-a} {a} -20 20 -20 20\ncreate_box 4 box bond/types 1 dihedral/types 1\n"
        f"mass * 1.0\n{create}comm_modify cutoff 5\nneighbor 2 bin\ntimestep 1.0\n"
        f"fix growth all dcm/growth NULL d d d c seed 3 cycle_time {T} newborn {born!r} "
        f"rounding 0 1 proliferating c {f}\n" + DIVIDE + "\n"
    )
    deck += scenes.thermo(["n=f_growth", "resting=f_growth[4]"], 50) + f"run {2 * T}\n"
    result = lmp(deck)
    for row in result.thermo[1:]:
        n, expected = row["v_n"], 2 ** (f * row["Step"] / T)
        error = 3 * ((1 - 1 / expected) / (f * N0)) ** 0.5
        assert n / N0 == pytest.approx(expected, rel=error)
        # divisions of this step come after the choice: two growing daughters for one mother
        assert abs(row["v_resting"] - (1 - f) * n) <= 0.5 + 0.02 * n
    assert result.thermo[-1]["v_n"] / N0 != pytest.approx((1 + f) ** 2, rel=0.02) or f == 1.0


def test_counts_after_divisions_and_deaths(lmp, scenes):
    """100 divisions, then 50 removals: 100 cells, then 200, then 150, none twice."""
    deck = counting(100, "cycle_time 20") + DIVIDE + "\n"
    deck += "variable pick atom mol>100&&mol<=150\n"
    deck += "fix death all dcm/death variable v_pick every 30\n"
    deck += cells_thermo(scenes, 1) + scenes.dump("id mol type radius", 35) + "run 35\n"
    result = lmp(deck)
    for row in result.thermo:
        n = 100 if row["Step"] < 20 else 200 if row["Step"] < 30 else 150
        assert row["Atoms"] == row["v_n"] == n
    assert row["v_births"] == 200 and row["v_deaths"] == 50
    frame = result.dump()[-1]
    assert sorted(frame["mol"]) == list(range(151, 301))
    assert len(set(frame["id"])) == 150 and frame["id"].max() <= 200


# --- the same on any number of ranks --------------------------------------------------------------


def clump(scenes, options, division, contact="growth 1.35"):
    """Eight spheres in contact in a fixed box."""
    scene = scenes.Scene(40.0, "f f f", parameters=PLAIN)
    for k in range(8):
        x, y, z = (-4.9 + 9.8 * (k >> m & 1) for m in range(3))
        scene.cbm(x + 0.3, y - 0.2, z + 0.1, 5.0)
    rest = "fix cell all dcm/cell\n" + growth(scene, options)
    rest += DIVIDE + division + "\n" + scene.motion() + "timestep 1.0\n"
    return scene, f"pair_style dcm/contact {contact}\n", rest


@pytest.mark.parametrize("balance", ["", "fix balance all balance 20 1.02 shift xyz 5 1.02\n"])
def test_lineage_on_ranks(lmp, scenes, balance):
    """In contact; the borders between ranks move along."""
    scene, pair, rest = clump(scenes, "cycle_time 150 cycle_sd 20", "cbm soften 40")
    deck = scene.head() + pair + f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n" + rest
    deck += balance + scenes.dump(COLUMNS, 50) + "run 400\n"
    one = lmp(deck, files=FILES)
    log = (one.path / "division.log").read_bytes()
    assert log.count(b"\n") > 20
    for np_ in (2, 4):
        other = lmp(deck, np=np_, files=FILES)
        assert (other.path / "division.log").read_bytes() == log
        a, b = one.dump()[-1], other.dump()[-1]
        assert np.array_equal(a["mol"], b["mol"]) and np.array_equal(a["radius"], b["radius"])
        assert np.abs(a.x - b.x).max() < 1e-9


def test_lineage_on_tiled_ranks(lmp, scenes):
    """Without contact, whose history LAMMPS cannot send back with comm_style tiled."""
    deck = counting(20, "cycle_time 100 cycle_sd 20 proliferating c 0.7") + DIVIDE + "\n"
    deck += "comm_style tiled\nfix balance all balance 20 1.02 rcb\n"
    deck += "fix death all dcm/death rate 1e-3 seed 5 log death.log\n"
    deck += scenes.dump("id mol radius x y z proc", 400) + "run 400\n"
    one = lmp(deck)
    for np_ in (2, 4):
        other = lmp(deck, np=np_)
        for name in ("division.log", "death.log"):
            assert (other.path / name).read_bytes() == (one.path / name).read_bytes()
        a, b = one.dump()[-1], other.dump()[-1]
        same(a, b, "id mol radius x y z")
        assert len(set(b["proc"])) == np_


# --- sisters --------------------------------------------------------------------------------------


def sisters(lmp, scenes, division):
    """One sphere that divides at step 200; frames from there on."""
    scene = scenes.Scene(20.0, "f f f", parameters=PLAIN)
    scene.cbm(0.5, -0.3, 0.2, 5.0)
    deck = scene.head() + "pair_style dcm/contact growth 1.35\n"
    deck += f"pair_coeff * * {scene.map} a1 0 a2 0 a3 0 a4 0\nneighbor 0.6 multi\n"
    deck += "fix cell all dcm/cell\n" + growth(scene, "cycle_time 200")
    deck += "fix division all dcm/division seed 4 " + division + "\n" + scene.motion()
    deck += scenes.dump(COLUMNS, 1) + scenes.thermo(["held=f_division[7]"])
    result = lmp(deck + "timestep 1.0\nrun 399\n", files=FILES)
    return [f for f in result.dump() if f.step >= 200], result


def overlap(frame):
    return frame["radius"].sum() - np.linalg.norm(frame.x[1] - frame.x[0])


def hertz(frame):
    """Force of two equal spheres without adhesion; E of each 0.45, nu 0.4."""
    modulus = 0.45 / (2 * (1 - 0.4**2))
    return 4 / 3 * modulus * (frame["radius"][0] / 2) ** 0.5 * max(overlap(frame), 0.0) ** 1.5


def check_birth(frame):
    """Volume and momentum of the mother, within the sphere that she was."""
    assert len(frame["id"]) == 2
    assert sphere(frame["radius"]).sum() == pytest.approx(2 * sphere(5.0), rel=1e-12)
    middle = frame.x.mean(axis=0)
    assert middle == pytest.approx([0.5, -0.3, 0.2], abs=1e-12)
    reach = np.linalg.norm(frame.x - middle, axis=1) + frame["radius"]
    assert reach == pytest.approx([5.0 * 2 ** (1 / 3)] * 2, rel=1e-12)


def check_balance(frames):
    for frame in frames:
        scale = max(np.abs(frame.f).max(), 1e-6)
        assert np.abs(frame.f.sum(axis=0)).max() < 1e-12 * scale
        assert np.abs(frame.v.sum(axis=0)).max() < 1e-9 * max(np.abs(frame.v).max(), 1e-9)


def test_truncated_sisters(lmp, scenes):
    most = 4.0
    frames, result = sisters(lmp, scenes, f"cbm truncate {most}")
    check_birth(frames[0])
    check_balance(frames)
    assert hertz(frames[0]) > 1.5 * most
    for frame in frames:
        force = np.linalg.norm(frame.f[0])
        assert force <= most * (1 + 1e-12)
        assert force == pytest.approx(min(most, hertz(frame)), rel=1e-9)
    assert overlap(frames[-1]) < 0.5 * overlap(frames[0])
    held = {int(row["Step"]): row["v_held"] for row in result.thermo}
    free = next(f.step for f in frames if hertz(f) < most)
    assert held[free] == 1 and held[free + 1] == 0  # seen at the start of the next step


def test_softened_sisters(lmp, scenes):
    """Modulus times (t - t_birth)/T, at least 1e-3."""
    frames, result = sisters(lmp, scenes, "cbm soften 80")
    check_birth(frames[0])
    check_balance(frames)
    for frame in frames:
        part = min(1.0, max(1e-3, (frame.step - 200) / 80))
        assert np.linalg.norm(frame.f[0]) == pytest.approx(part * hertz(frame), rel=1e-9)
    assert overlap(frames[-1]) < 0.5 * overlap(frames[0])
    held = {int(row["Step"]): row["v_held"] for row in result.thermo}
    assert held[279] == 1 and held[280] == 0


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("division", ["cbm soften 100", "cbm truncate 0.5"])
def test_restart_while_sisters_are_held_back(lmp, scenes, np_, division):
    scene, pair, rest = clump(scenes, "cycle_time 100 cycle_sd 5", division)
    tail = scenes.dump(COLUMNS, 10) + scenes.thermo(["held=f_division[7]", "n=f_growth[1]"], 10)
    tail += "restart 120 r.*\n"
    coeff = f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
    head = "processors * 1 1\n"
    whole = lmp(head + scene.head() + pair + coeff + rest + tail + "run 230\n", np=np_, files=FILES)
    again = lmp(
        head + "read_restart r.120\n" + coeff + rest + tail + "run 110\n",
        np=np_,
        files={**FILES, "r.120": whole.path / "r.120"},
    )
    assert whole.thermo[12]["v_held"] > 0
    expected, found = whole.dump()[12:], again.dump()
    assert len(found) == 12 and len(found[-1]["id"]) > 16
    for a, b in zip(expected, found, strict=True):
        same(a, b, COLUMNS)
    assert [row["v_held"] for row in whole.thermo[12:]] == [row["v_held"] for row in again.thermo]
    first, second = ((r.path / "division.log").read_text() for r in (whole, again))
    rows = [line for line in first.splitlines(True) if line[0] != "#"]
    rows = [line for line in rows if int(line.split()[0]) > 120]
    assert second.endswith("".join(rows)) and rows
