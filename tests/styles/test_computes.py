"""compute dcm/cell and compute dcm/face through the real lmp."""

import math

import numpy as np
import pytest

from support.meshes import icosphere

HEAD = """
units lj
atom_style dcm
newton on
boundary p p p
region b block -16 16 -12 12 -12 12
create_box 4 b bond/types 1 dihedral/types 1
mass * 1.0
"""
DCM = "create_cells single hep dcm {} {} {} {} dcm hep 1 2 3 1 1 mesh icosphere {} {}\n"
CBM = "create_cells single m cbm {} {} {} {} cbm m 4\n"
CORTEX = """
bond_style dcm/cortex
bond_coeff 1 NULL hep E_cor 5 h_cor 0.5 gamma 4
dihedral_style dcm/bend
dihedral_coeff 1 NULL hep E_cor 5 h_cor 0.5 nu_cor 0.5
"""
CONTACT = """
neighbor 0.4 bin
pair_style dcm/contact law dmt h0 auto 0.02
pair_coeff * * NULL NULL NULL hep m E_contact {} nu_contact 0.5 W {} &
  friction_normal 50 friction_tangential 50
"""
VOLUME = "fix vol all dcm/volume NULL hep NULL NULL NULL K_V 2.5\n"
MOTION = "fix move all dcm/motion NULL NULL hep NULL m friction_ecm 1 tolerance 1e-13\n"
CELL_VALUES = (
    "volume volume0 area pressure x y z vx vy vz contact_area free_area neighbors kind molecule"
)


def contact(E=5.0, W=0.1):
    return CONTACT.format(E, W)


def thermo(columns):
    """Columns by name as equal-style variables, in full precision."""
    text = "".join(f"variable {name} equal {formula}\n" for name, formula in columns.items())
    names = " ".join("v_" + name for name in columns)
    return text + (
        f"thermo_style custom step {names}\n"
        "thermo_modify norm no format float %.16g\n"
        "thermo 10\n"
    )


def cell_columns(values, atoms, compute="cells"):
    """Columns VALUE_n of the n-th of `atoms` (center or sphere IDs)."""
    values = values.split()
    cell = "C_{}[{}][{}]" if len(values) > 1 else "C_{}[{}]"
    return {
        f"{value}_{n}": cell.format(compute, atom, k + 1)
        for n, atom in enumerate(atoms)
        for k, value in enumerate(values)
    }


def last(result):
    assert result.returncode == 0, result.out
    return {key[2:] if key.startswith("v_") else key: x for key, x in result.thermo[-1].items()}


def measure(nodes, faces):
    a, b, c = (nodes[faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6, area


# --- geometry -------------------------------------------------------------------------------------


@pytest.mark.parametrize("level, ratio", [(1, None), (2, 0.9662), (3, 0.9914), (4, 0.9978)])
def test_icosphere_volume_and_area(lmp, level, ratio):
    nodes, faces = icosphere(level)
    volume, area = measure(nodes, faces)
    if ratio:
        assert volume / (4 / 3 * math.pi) == pytest.approx(ratio, abs=5e-5)
    # through a periodic boundary
    deck = (
        HEAD
        + DCM.format(15.5, -1, 11.9, 3, level, "scale nodes rotate 3")
        + "fix cell all dcm/cell\n"
        + "comm_modify cutoff 6\n"
        + "compute cells all dcm/cell volume volume0 area pressure x y z kind molecule\n"
        + thermo(cell_columns("volume volume0 area pressure x y z kind molecule", [1]))
        + "run 0\n"
    )
    row = last(lmp.run(deck))
    assert row["volume_0"] == pytest.approx(27 * volume, rel=1e-12)
    assert row["volume0_0"] == pytest.approx(27 * volume, rel=1e-12)
    assert row["area_0"] == pytest.approx(9 * area, rel=1e-12)
    assert [row[k + "_0"] for k in "xyz"] == pytest.approx([15.5, -1, 11.9], abs=1e-12)
    assert (row["kind_0"], row["molecule_0"], row["pressure_0"]) == (2, 1, 0)


def test_faces_of_an_icosphere(lmp):
    nodes, faces = icosphere(2)
    _, area = measure(nodes, faces)
    deck = (
        HEAD
        + DCM.format(0, 0, 0, 3, 2, "scale nodes rotate 3")
        + "fix cell all dcm/cell\ncomm_modify cutoff 6\n"
        + """
compute f all dcm/face area nx ny nz curvature region
variable nx atom c_f[1]*c_f[2]
variable ny atom c_f[1]*c_f[3]
variable nz atom c_f[1]*c_f[4]
variable outward atom c_f[2]*x+c_f[3]*y+c_f[4]*z
group faces type 3
group rest subtract all faces
compute s all reduce sum c_f[1] v_nx v_ny v_nz c_f[6]
compute lo faces reduce min c_f[5] v_outward
compute hi faces reduce max c_f[5]
compute other rest reduce maxabs c_f[1] c_f[2] c_f[5]
"""
        + thermo(
            {
                "area": "c_s[1]",
                "sx": "c_s[2]",
                "sy": "c_s[3]",
                "sz": "c_s[4]",
                "region": "c_s[5]",
                "klow": "c_lo[1]",
                "khigh": "c_hi",
                "out": "c_lo[2]",
                "other": "c_other[1]+c_other[2]+c_other[3]",
            }
        )
        + "run 0\n"
    )
    row = last(lmp.run(deck))
    assert row["area"] == pytest.approx(9 * area, rel=1e-12)
    assert max(abs(row[k]) for k in ("sx", "sy", "sz")) < 1e-12 * row["area"]
    assert row["out"] > 2.9  # normals point outward
    # scalar curvature 2/R to second order in the edge length
    assert row["klow"] == pytest.approx(2 / 3, rel=5e-3)
    assert row["khigh"] == pytest.approx(2 / 3, rel=5e-3)
    assert row["region"] == 0 and row["other"] == 0


def test_pressure_of_a_stretched_cell(lmp):
    # stretched by 5 % along x about its center: V/V0 = 1.05
    deck = (
        HEAD
        + DCM.format(0, 0, 0, 3, 2, "")
        + DCM.format(0, 0, 9, 3, 2, "")
        + """
group one molecule 1
displace_atoms one ramp x -0.5 0.5 x -10 10
fix cell all dcm/cell
comm_modify cutoff 6
compute cells all dcm/cell pressure
compute mine one dcm/cell volume pressure
"""
        + VOLUME
        + thermo(
            {
                **cell_columns("pressure", [1, 484]),
                **{f"all{k}": f"c_cells[{k}]" for k in range(1, 7)},
                **{f"one{k}": f"c_mine[{k}]" for k in range(1, 7)},
                "outside": "C_mine[484][1]",
            }
        )
        + "run 0\n"
    )
    row = last(lmp.run(deck))
    p = -2.5 * math.log(1.05)
    V = 36 * math.pi
    assert row["pressure_0"] == pytest.approx(p, rel=1e-9)
    assert abs(row["pressure_1"]) < 1e-12
    assert [row[f"all{k}"] for k in range(1, 7)] == pytest.approx(
        [2, p / 2, 0, 0, 0, 2.05 * V], rel=1e-9, abs=1e-12
    )
    assert [row[f"one{k}"] for k in range(1, 7)] == pytest.approx(
        [1, p, p, 0, 0, 1.05 * V], rel=1e-9
    )
    assert row["outside"] == 0


# --- center-based cells ---------------------------------------------------------------------------


def hertz(E, R, delta):
    return 4 / 3 * E * math.sqrt(R) * delta**1.5


def test_pressure_of_two_spheres(lmp):
    R1, R2, d, E = 3.0, 2.0, 4.8, 5.0
    R, delta = R1 * R2 / (R1 + R2), R1 + R2 - d
    F = hertz(E / 2 / 0.75, R, delta)
    deck = (
        HEAD
        + CBM.format(-1, 0, 0, R1)
        + CBM.format(-1 + d, 0, 0, R2)
        + contact(E, 0.0)
        + f"compute cells all dcm/cell {CELL_VALUES}\n"
        + thermo({**cell_columns(CELL_VALUES, [1, 2]), "mean": "c_cells[5]", "n": "c_cells[4]"})
        + "run 0\n"
    )
    row = last(lmp.run(deck))
    for n, r in enumerate((R1, R2)):
        V = 4 / 3 * math.pi * r**3
        assert row[f"volume_{n}"] == pytest.approx(V, rel=1e-12)
        assert row[f"area_{n}"] == pytest.approx(4 * math.pi * r * r, rel=1e-12)
        assert row[f"pressure_{n}"] == pytest.approx(F * d / 2 / (3 * V), rel=1e-9)
        assert row[f"contact_area_{n}"] == pytest.approx(math.pi * R * delta, rel=1e-9)
        assert row[f"free_area_{n}"] == pytest.approx(
            4 * math.pi * r * r - math.pi * R * delta, rel=1e-9
        )
        assert (row[f"neighbors_{n}"], row[f"kind_{n}"], row[f"molecule_{n}"]) == (1, 1, n + 1)
    assert row["n"] == 2
    assert row["mean"] == pytest.approx((row["pressure_0"] + row["pressure_1"]) / 2, rel=1e-12)


@pytest.mark.parametrize("np_", [1, 4])
def test_sphere_pressures_add_up_to_the_virial(lmp, np_):
    # sum V p = (1/3) sum over pairs F d, which is box volume times LAMMPS' virial pressure
    random = np.random.default_rng(5)
    grid = [(x, y, z) for x in range(4) for y in range(4) for z in range(3)]
    place = [4.6 * np.array(g) - [14, 9, 7] + random.uniform(-0.4, 0.4, 3) for g in grid]
    cells = "".join(CBM.format(*x, random.uniform(2.2, 2.8)) for x in place)
    deck = (
        HEAD
        + cells
        + contact()
        + """
compute cells all dcm/cell volume pressure
variable energy atom c_cells[1]*c_cells[2]
compute sum all reduce sum v_energy
compute virial all pressure NULL virial
"""
        + thermo({"pv": "c_sum", "virial": "c_virial*vol", "n": "c_cells[4]", "p": "c_cells[5]"})
        + "run 0\n"
    )
    row = last(lmp.run(deck, np=np_))
    assert row["n"] == 48
    assert abs(row["pv"]) > 1
    assert row["pv"] == pytest.approx(row["virial"], rel=1e-10)


def test_sphere_between_deformable_cells(lmp):
    # force on the faces and on the sphere is the same; the arm is R less half the overlap
    R = 3.0
    deck = (
        HEAD
        + DCM.format(-5.7, 0, 0, R, 3, "scale nodes rotate 3")
        + CBM.format(0, 0, 0, R)
        + contact(5.0, 0.0)
        + "fix cell all dcm/cell\n"
        + """
compute cells all dcm/cell pressure contact_area free_area neighbors
compute f all dcm/face area contact_area free_area stress
variable push atom c_f[1]*c_f[4]
compute sum all reduce sum c_f[1] c_f[2] c_f[3] v_push
"""
        + thermo(
            {
                **cell_columns("pressure contact_area free_area neighbors", [1, 1924]),
                **{name: f"c_sum[{k + 1}]" for k, name in enumerate(["A", "C", "F", "force"])},
                "fx": "fx[1924]",
            }
        )
        + "run 0\n"
    )
    row = last(lmp.run(deck))
    assert row["contact_area_0"] == pytest.approx(row["C"], rel=1e-12) and row["C"] > 0
    assert row["contact_area_1"] == pytest.approx(row["C"], rel=1e-12)
    assert row["free_area_0"] == pytest.approx(row["F"], rel=1e-12)
    assert row["F"] + row["C"] == pytest.approx(row["A"], rel=1e-3)
    assert row["neighbors_0"] == row["neighbors_1"] == 1
    F = hertz(5.0 / 2 / 0.75, R / 2, 0.3)
    assert row["force"] == pytest.approx(F, rel=0.02)
    assert row["fx"] == pytest.approx(row["force"], rel=1e-2)
    arm = row["pressure_1"] * 4 * math.pi * R**3 / row["force"]
    assert arm == pytest.approx(R - 0.15, abs=2e-3)


# --- neighbors ------------------------------------------------------------------------------------

ROW = (
    HEAD
    + DCM.format(-9, 0, 0, 2.05, 2, "rotate 1")
    + DCM.format(-5, 0, 0, 2.05, 2, "rotate 2")
    + CBM.format(-1, 0, 0, 2.05)
    + CBM.format(3, 0, 0, 2.05)
    + DCM.format(7, 0, 0, 2.05, 2, "rotate 3")
    + DCM.format(7, 8, 0, 2.05, 2, "rotate 3")
)
ROW_ATOMS = [1, 484, 967, 968, 969, 1452]


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_neighbors_in_a_row(lmp, np_):
    deck = (
        ROW
        + contact()
        + "fix cell all dcm/cell\ncompute cells all dcm/cell neighbors\n"
        + thermo(cell_columns("neighbors", ROW_ATOMS))
        + "run 0\n"
    )
    row = last(lmp.run(deck, np=np_))
    assert [row[f"neighbors_{n}"] for n in range(6)] == [1, 2, 2, 2, 1, 0]


# --- on any number of ranks, with motion ----------------------------------------------------------


def test_ranks_agree(lmp):
    deck = (
        ROW
        + CORTEX
        + contact()
        + "fix cell all dcm/cell\n"
        + VOLUME
        + MOTION
        + f"""
compute cells all dcm/cell {CELL_VALUES}
compute f all dcm/face area contact_area free_area stress curvature nx ny nz region
compute sum all reduce sumsq c_f[*]
timestep 0.05
"""
        + thermo(
            {
                **cell_columns(CELL_VALUES, ROW_ATOMS),
                **{f"g{k}": f"c_cells[{k}]" for k in range(1, 7)},
                **{f"f{k}": f"c_sum[{k}]" for k in range(1, 10)},
            }
        )
        + "run 20\n"
    )
    one = lmp.run(deck)
    first = last(one)
    assert first["Step"] == 20 and first["vx_0"] != 0 and first["f4"] > 0
    fastest = max(abs(one.thermo[0][f"v_v{k}_0"]) for k in "xyz")
    for np_ in (2, 4):
        other = lmp.run(deck, np=np_)
        assert other.returncode == 0, other.out
        for a, b in zip(one.thermo, other.thermo, strict=True):
            for key in a:
                # forces and velocities are far more sensitive to positions than these to the
                # order of sums: only at the same positions do they agree as well
                size, rel = 1.0, 1e-9
                if key[2:5] in ("vx_", "vy_", "vz_"):
                    size = fastest
                    rel = 1e-9 if a["Step"] == 0 else 1e-6
                elif key == "v_f4" and a["Step"] > 0:
                    rel = 1e-6
                assert b[key] == pytest.approx(a[key], rel=rel, abs=rel * size), (np_, key)


def test_values_are_of_this_step(lmp):
    # the last line of a run and the first of a run from there are computed alike
    deck = (
        ROW
        + CORTEX
        + contact()
        + "fix cell all dcm/cell\n"
        + VOLUME
        + MOTION
        + f"compute cells all dcm/cell {CELL_VALUES}\ntimestep 0.2\n"
        + thermo(cell_columns(CELL_VALUES, ROW_ATOMS))
        + "run 13\nrun 0\n"
    )
    result = lmp.run(deck)
    assert result.returncode == 0, result.out
    a, b = result.thermo[-2:]
    assert a["Step"] == b["Step"] == 13
    for key in a:
        assert b[key] == pytest.approx(a[key], rel=1e-7, abs=1e-9), key


# --- bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "lines, words",
    [
        ("compute c all dcm/cell volum", ["dcm/cell", "volum", "known: volume"]),
        ("compute c all dcm/cell", ["dcm/cell", "no values"]),
        ("compute c all dcm/face area stres", ["dcm/face", "stres", "known: area"]),
        ("compute c all dcm/face", ["dcm/face", "no values"]),
        ("fix cell all dcm/cell\ncompute c all dcm/cell neighbors", ["neighbors", "pair_style"]),
        ("fix cell all dcm/cell\ncompute c all dcm/face stress", ["stress", "pair_style"]),
        ("compute c all dcm/cell volume", ["dcm/cell", "fix cell all dcm/cell"]),
        ("compute c all dcm/face area", ["dcm/face", "fix cell all dcm/cell"]),
    ],
)
def test_errors(lmp, lines, words):
    deck = HEAD + DCM.format(0, 0, 0, 3, 1, "") + "comm_modify cutoff 6\n" + lines + "\nrun 0\n"
    result = lmp.run(deck)
    assert result.returncode != 0
    text = [line for line in result.out.splitlines() if "ERROR" in line]
    assert len(text) >= 1
    for word in words:
        assert word in text[0], text[0]


@pytest.mark.parametrize("style", ["dcm/cell volume", "dcm/face area"])
def test_needs_the_atom_style(lmp, style):
    deck = (
        "region b block 0 1 0 1 0 1\ncreate_box 1 b\nmass 1 1.0\n" f"compute c all {style}\nrun 0\n"
    )
    result = lmp.run(deck)
    assert result.returncode != 0
    assert "atom_style dcm" in result.out
