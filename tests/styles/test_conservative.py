"""Cortex, bending and volume at deck level: closed forms, energies, gradients, virial."""

import math

import numpy as np
import pytest

# test.dcm of support/parameters.py, celltype hepatoblast
E_COR, H_COR, NU_COR, K_V = 5.0, 0.5, 0.5, 2.5
K_S = 2 / math.sqrt(3) * E_COR * H_COR
K_B = E_COR * H_COR**3 / (12 * (1 - NU_COR**2))
R = 6.0


# --- the laws in numpy, from the formulas of the doc pages ----------------------------------------


def edges_of(faces):
    return np.array(sorted({tuple(sorted((f[k - 1], f[k]))) for f in faces for k in range(3)}))


def hinges_of(faces):
    """Rows (apex of face 1, edge from, edge to, apex of face 2)."""
    apex = {(f[k], f[(k + 1) % 3]): f[(k + 2) % 3] for f in faces for k in range(3)}
    return np.array([(apex[i, j], i, j, apex[j, i]) for i, j in apex if i < j])


def cortex_force(x, edges, l0):
    d = x[edges[:, 1]] - x[edges[:, 0]]
    length = np.linalg.norm(d, axis=1)
    force = -K_S * ((length - l0) / length)[:, None] * d
    f = np.zeros_like(x)
    np.add.at(f, edges[:, 1], force)
    np.add.at(f, edges[:, 0], -force)
    return f, 0.5 * K_S * ((length - l0) ** 2).sum()


def volume_of(x, faces):
    a, b, c = (x[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def volume_force(x, faces, V0):
    a, b, c = (x[faces[:, k]] for k in range(3))
    V = volume_of(x - x.mean(axis=0), faces)
    p = -K_V * math.log(V / V0)
    f = np.zeros_like(x)
    for k in range(3):
        np.add.at(f, faces[:, k], p / 6 * np.cross(b - a, c - a))
    return f, K_V * (V * math.log(V / V0) - V + V0), p, V


def angles(x, hinges):
    i, j, k, m = (x[hinges[:, n]] for n in range(4))  # edge from j to k
    n1, n2 = np.cross(k - j, i - j), np.cross(j - k, m - k)
    e = (k - j) / np.linalg.norm(k - j, axis=1)[:, None]
    sine = np.einsum("ij,ij->i", np.cross(n1, n2), e)
    return np.arctan2(sine, np.einsum("ij,ij->i", n1, n2))


def bending_energy(x, hinges, theta0):
    return K_B * (1 - np.cos(angles(x, hinges) - theta0)).sum()


def numerical_gradient(energy, x, h=1e-5):
    g = np.zeros_like(x)
    for index in np.ndindex(*x.shape):
        up, down = x.copy(), x.copy()
        up[index] += h
        down[index] -= h
        g[index] = (energy(up) - energy(down)) / (2 * h)
    return g


# --- a perturbed cell -----------------------------------------------------------------------------


def perturbed_deck(scenes, laws):
    """One cell of 42 nodes, every node displaced by up to 0.4 um; rest state: 0.95, the mesh."""
    scene = scenes.Scene(20.0, "p p p")
    scene.dcm(1.0, 2.0, 3.0, R, mesh=("cell.off", 42, 80), options="scale nodes rest 0.95")
    deck = scene.head() + (
        "group nodes type 2\ndisplace_atoms nodes random 0.4 0.4 0.4 4711 units box\n"
        "comm_modify cutoff 8\nfix cell all dcm/cell\n"
    )
    if "bond" in laws:
        deck += f"bond_style dcm/cortex\nbond_coeff 1 {scene.parameters} hepatoblast\n"
    else:
        deck += "bond_style zero nocoeff\nbond_coeff *\n"
    if "bend" in laws:
        deck += (
            "dihedral_style dcm/bend\n"
            f"dihedral_coeff 1 {scene.parameters} hepatoblast rest {laws['bend']}\n"
        )
    else:
        deck += "dihedral_style zero nocoeff\ndihedral_coeff *\n"
    if "volume" in laws:
        deck += scene.volume(laws["volume"])
    deck += scenes.thermo(
        ["pe", "ebond", "edihed"] + (["p=f_volume[1]", "U=f_volume"] if "volume" in laws else [])
    )
    deck += scenes.dump("id type x y z fx fy fz")
    return deck


@pytest.fixture(scope="module")
def mesh(scenes):
    nodes, faces = scenes.icosphere(1)
    return nodes, faces, {"cell.off": scenes.off(nodes, faces)}


def nodes_of(frame):
    pick = frame["type"] == 2
    return frame.x[pick], frame.f[pick], frame["id"][pick]


def close(actual, expected, rel=1e-12):
    scale = np.abs(expected).max()
    assert scale > 0
    assert np.abs(actual - expected).max() <= rel * scale


def test_cortex_force_and_energy(lmp, scenes, mesh):
    rest, faces, files = mesh
    result = lmp(perturbed_deck(scenes, {"bond": ""}) + "run 0\n", files=files)
    x, f, _ = nodes_of(result.dump()[0])
    edges = edges_of(faces)
    l0 = 0.95 * R * np.linalg.norm(rest[edges[:, 1]] - rest[edges[:, 0]], axis=1)
    force, energy = cortex_force(x, edges, l0)
    close(f, force)
    assert result.thermo[0]["E_bond"] == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize("rest", ["flat", "mesh"])
def test_bending_force_and_energy(lmp, scenes, mesh, rest):
    nodes, faces, files = mesh
    result = lmp(perturbed_deck(scenes, {"bend": rest}) + "run 0\n", files=files)
    x, f, _ = nodes_of(result.dump()[0])
    hinges = hinges_of(faces)
    theta0 = angles(nodes, hinges) if rest == "mesh" else 0.0
    assert (angles(nodes, hinges) > 0).all()  # convex is positive
    assert result.thermo[0]["E_dihed"] == pytest.approx(
        bending_energy(x, hinges, theta0), rel=1e-11
    )
    close(f, -numerical_gradient(lambda y: bending_energy(y, hinges, theta0), x), rel=1e-7)


def test_volume_force_pressure_and_energy(lmp, scenes, mesh):
    nodes, faces, files = mesh
    result = lmp(perturbed_deck(scenes, {"volume": ""}) + "run 0\n", files=files)
    x, f, _ = nodes_of(result.dump()[0])
    force, energy, p, _ = volume_force(x, faces, R**3 * volume_of(nodes, faces))
    assert abs(p) > 1e-3
    close(f, force)
    assert result.thermo[0]["v_p"] == pytest.approx(p, rel=1e-11)
    assert result.thermo[0]["v_U"] == pytest.approx(energy, rel=1e-10)


def test_voronoi_form_of_the_volume_force(lmp, scenes):
    """On the round icosphere p S N: S sums to the area; N is radial to second order."""
    scene = scenes.Scene(20.0, "p p p")
    scene.dcm(0.0, 0.0, 0.0, R, level=2, options="scale nodes")
    result = lmp(
        scene.head()
        + "group nodes type 2\ngroup center type 1\ncomm_modify cutoff 8\nfix cell all dcm/cell\n"
        + "bond_style zero nocoeff\nbond_coeff *\ndihedral_style zero nocoeff\ndihedral_coeff *\n"
        + "displace_atoms nodes ramp x -0.5 0.5 x -10 10\n"
        + scene.volume("form voronoi")
        + "compute cells all dcm/cell area\n"
        + scenes.thermo(["p=f_volume[1]", "area=C_cells[1]"])
        + scenes.dump("id type x y z fx fy fz")
        + "run 0\n"
    )
    x, f, _ = nodes_of(result.dump()[0])
    row = result.thermo[0]
    assert row["v_p"] == pytest.approx(-K_V * math.log(1.05), rel=1e-12)
    sizes = np.linalg.norm(f, axis=1)
    assert sizes.sum() == pytest.approx(-row["v_p"] * row["v_area"], rel=1e-12)
    assert (np.einsum("ij,ij->i", f, x) < 0).all()  # p < 0 pulls inward


def test_force_is_minus_gradient_of_energy(lmp, scenes, mesh):
    """Central differences of pe at deck level, all conservative laws together."""
    h, nodes = 1e-4, [2, 9, 17, 30, 43]
    deck = perturbed_deck(scenes, {"bond": "", "bend": "mesh", "volume": ""}) + "run 0\n"
    deck += "undump dump.txt\nneigh_modify delay 0 every 1 check no\n"
    for node in nodes:
        deck += f"group one id {node}\n"
        for axis in range(3):
            for k, then in ((1, "run 0\n"), (-2, "run 0\n"), (1, "")):
                step = " ".join(map(repr, (k * h * np.eye(3)[axis]).tolist()))
                deck += f"displace_atoms one move {step} units box\n" + then
        deck += "group one delete\n"
    result = lmp(deck, files=mesh[2])
    _, f, ids = nodes_of(result.dump()[0])
    pe = [run[0]["PotEng"] for run in result.runs[1:]]
    assert len(pe) == 2 * 3 * len(nodes)
    numerical = -(np.array(pe[0::2]) - np.array(pe[1::2])) / (2 * h)
    exact = np.array([f[np.flatnonzero(ids == node)[0]] for node in nodes]).ravel()
    close(numerical, exact, rel=1e-6)


# --- uniform scaling: Laplace ---------------------------------------------------------------------


@pytest.mark.parametrize("level, rel", [(2, 0.017), (3, 0.0042), (4, 0.00105)])
def test_inflated_icosphere(lmp, scenes, level, rel):
    """Blown up by eps it holds p = 4 K_A eps/R, K_A = 0.8756 k_s to second order in the edge."""
    eps = 1e-5
    scene = scenes.Scene(20.0, "p p p")
    options = f"scale nodes rest {1 / (1 + eps)!r}"
    scene.dcm(0.0, 0.0, 0.0, R * (1 + eps), level=level, options=options)
    result = lmp(
        scene.head()
        + scene.cortex(bend="rest flat")
        + "comm_modify cutoff 8\nfix cell all dcm/cell\n"
        + "compute p all pressure NULL bond\ncompute b all pressure NULL dihedral\n"
        + "compute cells all dcm/cell volume\n"
        + scenes.thermo(["pV=c_p*vol", "bend=c_b*vol", "V=C_cells[1]"])
        + "run 0\n"
    )
    row = result.thermo[0]
    p = -row["v_pV"] / row["v_V"]  # what the volume must hold: the total virial is zero
    assert p == pytest.approx(4 * 0.8756 * K_S * eps / R, rel=rel)
    # an energy of angles alone does not change with the size
    assert abs(row["v_bend"]) < 1e-12 * abs(row["v_pV"])


def test_laplace_at_rest(lmp, scenes):
    """At rest, pressure times 3V balances the tension of all edges; and nothing moves."""
    scene = scenes.single_cell(level=1, boundary="p p p")
    _, faces = scenes.icosphere(1)
    result = lmp(
        scene.head()
        + scene.cortex(bend="rest mesh")
        + "comm_modify cutoff 8\nfix cell all dcm/cell\n"
        + scene.volume()
        + scene.motion()
        + "compute p all pressure NULL bond\ncompute cells all dcm/cell volume\n"
        + scenes.thermo(["p=f_volume[1]", "pV=c_p*vol", "V=C_cells[1]", "move=f_motion[4]"], 100)
        + "timestep 1.0\nrun 1000\n"
    )
    row = result.thermo[-1]
    assert row["v_p"] > 0.01  # rest 0.95: tension
    assert row["v_p"] * row["v_V"] == pytest.approx(-row["v_pV"], rel=1e-9)
    assert row["v_move"] < 1e-9
