"""Contact laws at deck level: Hertz and JKR, pair_style granular, balance of forces and torques."""

import math
import re

import numpy as np
import pytest

E_FACE, NU, W = 5.0, 0.4, 0.1  # test.dcm of support/parameters.py
E_SPHERE = 0.45


def effective(Ea, Eb):
    return 1 / ((1 - NU**2) / Ea + (1 - NU**2) / Eb)


# --- two spheres ----------------------------------------------------------------------------------


def jkr_radius(delta, E, R, sigma):
    """Contact radius on the stable branch, by bisection."""

    def overlap(a):
        return a * a / R - math.sqrt(2 * math.pi * sigma * a / E)

    lo = (math.pi * sigma * R**2 / (8 * E)) ** (1 / 3)  # where the overlap is least
    hi = 10 * math.sqrt(R * (abs(delta) + 1))
    assert overlap(lo) <= delta
    for _ in range(200):
        mid = (lo + hi) / 2
        lo, hi = (mid, hi) if overlap(mid) < delta else (lo, mid)
    return (lo + hi) / 2


def jkr_force(delta, E, R, sigma):
    a = jkr_radius(delta, E, R, sigma)
    return 4 * E * a**3 / (3 * R) - math.sqrt(8 * math.pi * sigma * E * a**3)


R1, R2 = 5.0, 4.0
R_EFF = R1 * R2 / (R1 + R2)
PUSH = "fix slide second move linear {} 0 0\nrun {}\nunfix slide\n"


def approach_and_leave(lines, columns, scenes):
    """From a gap of 0.3 to an overlap of 1.5 in 360 steps, then away to a gap of 0.8."""
    return (
        lines
        + "timestep 1.0\ngroup second id 2\n"
        + scenes.thermo(["x1=x[1]", "x2=x[2]", "f1=fx[1]", "f2=fx[2]", "fy=fy[2]", *columns])
        + PUSH.format(-0.005, 360)
        + PUSH.format(0.005, 460)
    )


def dcm_spheres(scenes, adhesion):
    scene = scenes.Scene(20.0, "p p p")
    scene.cbm(-R1, 0.0, 0.0, R1)
    scene.cbm(R2 + 0.3, 0.0, 0.0, R2)
    # the neck may get as long as the skin
    lines = (
        scene.head()
        + "bond_style none\npair_style dcm/contact\n"
        + f"pair_coeff * * {scene.map} W {adhesion!r}\nneighbor 1.2 bin\n"
    )
    return approach_and_leave(
        lines + "compute virial all pressure NULL virial\n", ["pe", "virial=c_virial"], scenes
    )


@pytest.mark.parametrize("adhesion", [0.0, 0.1])
def test_two_spheres_are_jkr(lmp, scenes, adhesion):
    result = lmp(dcm_spheres(scenes, adhesion))
    E = effective(E_SPHERE, E_SPHERE)
    pull_off = -((3 * (math.pi * adhesion / (8 * E)) ** 2 * R_EFF) ** (1 / 3))
    touched, checked = False, {True: 0, False: 0}
    for row in result.thermo:
        delta = R1 + R2 - (row["v_x2"] - row["v_x1"])
        if min(abs(delta), abs(delta - pull_off)) < 1e-9:
            continue  # which side of the threshold is round-off
        touched = delta > 0 or (touched and delta > pull_off)
        force = jkr_force(delta, E, R_EFF, adhesion) if touched else 0.0
        scale = 1.5 * math.pi * max(adhesion, 0.01) * R_EFF
        assert row["v_f2"] == pytest.approx(force, abs=1e-10 * scale, rel=1e-10), (delta, touched)
        assert row["v_f1"] == -row["v_f2"] and row["v_fy"] == 0
        checked[touched] += 1
    assert min(checked.values()) > 50
    strongest = min(row["v_f2"] for row in result.thermo)
    if adhesion:
        assert -1.5 * math.pi * adhesion * R_EFF <= strongest * (1 - 1e-12)
        assert strongest == pytest.approx(-1.5 * math.pi * adhesion * R_EFF, rel=1e-3)
    else:
        assert strongest == 0.0


@pytest.mark.parametrize("overlap", [0.1, 0.32, 0.49])
def test_pressure_of_packed_spheres(lmp, scenes, overlap):
    """A close packing, overlaps in radii: each of 12 contacts at distance d carries P d^2/2 sqrt 2,
    by which the page says how soft center-based cells are. By the virial: 3 P V = 6 F d, with
    V = d^3/sqrt 2."""
    R = 6.0
    d = R * (2 - overlap)
    edge = math.sqrt(2) * d
    scene = scenes.Scene(edge, "p p p")
    for n in np.ndindex(2, 2, 2):
        for corner in ((0, 0, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 0.5, 0)):
            scene.cbm(*(edge * (np.add(n, corner) - 0.9)), R)
    deck = scene.head() + scene.contact("", "W 0") + "fix cell all dcm/cell\n"
    row = lmp(deck + scenes.thermo(["c_thermo_press"]) + "run 0\n").thermo[0]
    hertz = 4 / 3 * effective(E_SPHERE, E_SPHERE) * math.sqrt(R / 2) * (overlap * R) ** 1.5
    assert row["c_thermo_press"] == pytest.approx(2 * math.sqrt(2) * hertz / d**2, rel=1e-9)


def test_two_spheres_against_granular_jkr(lmp, scenes):
    """The same motion with LAMMPS' own JKR (gamma there is half the work of adhesion)."""
    granular = f"""
units lj
atom_style sphere
atom_modify map yes
newton on
boundary p p p
region box block -20 20 -20 20 -20 20
create_box 1 box
create_atoms 1 single {-R1} 0 0
create_atoms 1 single {R2 + 0.3} 0 0
set atom 1 diameter {2 * R1}
set atom 2 diameter {2 * R2}
set group all density 1.0
pair_style granular
pair_coeff * * jkr {E_SPHERE} 0.0 {NU} {W / 2} tangential linear_nohistory 0.0 0.0 damping velocity
neighbor 1.2 bin
comm_modify vel yes
"""
    ours = lmp(dcm_spheres(scenes, W))
    theirs = lmp(approach_and_leave(granular, [], scenes))
    assert len(ours.thermo) == len(theirs.thermo) == 822
    E = effective(E_SPHERE, E_SPHERE)
    pull_off = -((3 * (math.pi * W / (8 * E)) ** 2 * R_EFF) ** (1 / 3))
    scale = 1.5 * math.pi * W * R_EFF
    kinds = set()
    for a, b in zip(ours.thermo, theirs.thermo):
        delta = R1 + R2 - (a["v_x2"] - a["v_x1"])
        assert b["v_x2"] - b["v_x1"] == pytest.approx(R1 + R2 - delta, rel=1e-14)
        if min(abs(delta), abs(delta - pull_off)) < 1e-9:
            continue
        assert a["v_f2"] == pytest.approx(b["v_f2"], rel=1e-7, abs=1e-7 * scale), delta
        kinds.add((delta > 0, a["v_f2"] > 0, a["v_f2"] < 0))
    # before touch or after pull-off; neck; overlap pulling; overlap pushing
    assert kinds == {(0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 1, 0)}


def test_energy_of_two_spheres(lmp, scenes):
    """pe by the trapezoidal rule over the force; the pressure is that of the pair's virial."""
    rows = lmp(dcm_spheres(scenes, W)).runs[1]
    rows = [row for row in rows if row["v_f2"] != 0]
    x, f, pe = (np.array([row[k] for row in rows]) for k in ("v_x2", "v_f2", "PotEng"))
    work = np.cumsum((f[1:] + f[:-1]) / 2 * np.diff(x))
    assert np.abs(pe[1:] - pe[0] + work).max() < 1e-5 * np.ptp(pe)
    for row in rows:
        virial = row["v_f2"] * (row["v_x2"] - row["v_x1"]) / 3 / 40**3
        assert row["v_virial"] == pytest.approx(virial, rel=1e-10)


# --- surfaces -------------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("law", ["dmt", "maugis"])
@pytest.mark.parametrize("overlap", [0.02, 0.1])
def test_two_icospheres_are_hertz(lmp, scenes, overlap, law, np_):
    """Nodes on exact spheres, no adhesion: at 162 nodes the force is Hertz' within 5e-4."""
    R = 6.0
    scene = scenes.Scene((30.0, 15.0, 15.0), "p p p", level=2)
    d = R * (2 - overlap)
    scene.dcm(-d / 2, 0.0, 0.0, R, options="scale nodes rotate 3")
    scene.dcm(d / 2, 0.0, 0.0, R, options="scale nodes rotate 3")
    result = lmp(
        scene.head()
        + "bond_style zero nocoeff\nbond_coeff *\ndihedral_style zero nocoeff\ndihedral_coeff *\n"
        + scene.contact(f"law {law} h0 0.1 range {3 * overlap * R!r}", "W 0.0")
        + "fix cell all dcm/cell\n"
        + "group left molecule 1\ncompute f left reduce sum fx fy fz\n"
        + scenes.thermo(["fx=c_f[1]", "fy=c_f[2]", "fz=c_f[3]"])
        + "run 0\n",
        np=np_,
    )
    row = result.thermo[0]
    hertz = 4 / 3 * effective(E_FACE, E_FACE) * math.sqrt(R / 2) * (overlap * R) ** 1.5
    assert row["v_fx"] == pytest.approx(-hertz, rel=5e-4)
    assert math.hypot(row["v_fy"], row["v_fz"]) < 5e-4 * hertz


@pytest.mark.parametrize("law", ["dmt", "maugis", "foundation"])
def test_free_doublet_has_no_net_force_and_torque(lmp, scenes, law):
    """All laws, before and after some motion, over a periodic border, 1 and 2 ranks."""
    scene = scenes.doublet(level=2, boundary="p p p", box=(25.0, 25.0, 25.0))
    scene.cells[0] = scene.cells[0].replace("rotate 3", "rotate 5")
    deck = (
        scene.head()
        + scene.forces(f"law {law}", bend="rest flat")
        + scene.motion()
        + "group second molecule 2\n"
        + scenes.dump("id mol type xu yu zu fx fy fz", 20)
        + "timestep 0.5\nrun 40\n"
    )
    for np_ in (1, 2):
        frames = lmp(deck, np=np_).dump()
        assert [frame.step for frame in frames] == [0, 20, 40]
        for frame in frames:
            x, f = frame.x, frame.f
            scale = np.linalg.norm(f, axis=1).sum()
            assert scale > 1
            on_second = np.linalg.norm(f[frame["mol"] == 2].sum(axis=0))
            assert on_second > 1e-4 * scale  # they do act on each other
            assert np.abs(f.sum(axis=0)).max() < 1e-12 * scale
            assert np.abs(np.cross(x, f).sum(axis=0)).max() < 1e-12 * scale * 6.0


def test_hybrid_scene_has_no_net_force(lmp, scenes):
    """Surface on sphere and sphere on sphere too."""
    scene = scenes.hybrid(level=1, boundary="p p p")
    result = lmp(
        scene.head()
        + scene.forces()
        + scene.motion()
        + scenes.dump("id mol type xu yu zu fx fy fz", 20)
        + "timestep 0.5\nrun 20\n"
    )
    for frame in result.dump():
        f = frame.f
        scale = np.linalg.norm(f, axis=1).sum()
        assert np.abs(f.sum(axis=0)).max() < 1e-12 * scale
        spheres = np.linalg.norm(f[frame["type"] == 4], axis=1)
        assert (spheres > 1e-3).all()


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("then", ["contact", "zero"])
def test_what_it_sets_in_lammps_goes_with_it(lmp, scenes, then, np_):
    """Ghost cutoff, exclusions and collections: the next pair style finds those of the deck."""
    scene = scenes.doublet(boundary="f f f")
    first = scene.contact("law foundation h0 0.25 range 0.6")
    nexts, seen = {
        "contact": (scene.contact("law foundation h0 0.25 range 4.0"), r"cutoff set to ([\d.]+)"),
        "zero": (
            "pair_style zero 4.0\npair_coeff * *\ncomm_modify cutoff 15\n",
            r"Total # of neighbors = (\d+)",
        ),
    }[then]
    found = []
    for start in (first + "run 0\npair_style none\n", "neighbor 0.6 multi\n"):
        deck = scene.head() + scene.cortex() + "fix cell all dcm/cell\n" + scene.volume()
        result = lmp(deck + start + nexts + "run 0\n", np=np_)
        found.append(float(re.findall(seen, result.out)[-1]))
    assert found[0] == found[1] > 0.0


# --- tilted faces ---------------------------------------------------------------------------------


@pytest.mark.parametrize("sphere", [False, True])
def test_facing(lmp, scenes, sphere):
    """Two bodies of radius 6 that overlap by less than 2 um touch where their surfaces are tilted
    by less than acos(5/6) = 34 degrees: what is given above that changes nothing, and faces that
    would have to be tilted by less than a hundredth of a degree do not touch."""

    def forces(style):
        scene = scenes.Scene(20.0, "s s s", level=2)
        scene.dcm(-5.5, 0.0, 0.0, 6.0)
        if sphere:
            scene.cbm(5.5, 0.4, 0.3, 6.0)
        else:
            scene.dcm(5.5, 0.4, 0.3, 6.0)
        result = lmp(scene.head() + scene.cortex() + scene.contact(f"law foundation {style}")
                     + "fix cell all dcm/cell\n" + scenes.dump("id fx fy fz", 1)
                     + "compute c all dcm/cell contact_area\ncompute a all reduce sum c_c\n"
                     + scenes.thermo(["c_a"]) + "run 0\n")
        frame = result.dump()[0]
        return (np.array([frame[c] for c in ("fx", "fy", "fz")]), result.thermo[0]["c_a"])

    usual, area = forces("")
    assert area > 5.0
    for style in ("facing 40 50", "facing 60 70", "facing 89 90"):
        other, same = forces(style)
        assert np.array_equal(other, usual) and same == area, style
    assert 0.0 < forces("facing 5 15")[1] < 0.8 * area
    assert forces("facing 0 0.01")[1] == 0.0
