"""Shape, strain and mean stress of whole cells, compute dcm/cell."""

import math

import numpy as np
import pytest

from support.bad_decks import whole

BARE = "bond_style zero nocoeff\nbond_coeff *\ndihedral_style zero nocoeff\ndihedral_coeff *\n"
LIST = "comm_modify cutoff 12\n"
CELL = "fix cell all dcm/cell\n"
SIX = ("xx", "yy", "zz", "xy", "xz", "yz")
ROWS, COLUMNS = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)
STRESS = [f"s{k}" for k in SIX]
STRAIN = [f"e{k}" for k in SIX]
SHAPE = ["axis1", "axis2", "axis3", "long_x", "long_y", "long_z", "asphericity", "acylindricity",
         "anisotropy", "sphericity", "shape_index"]  # fmt: skip
ALL = ["volume", "area", "volume0", *SHAPE, *STRAIN, *STRESS]


def columns(values, tags):
    """Thermo columns NAME_n of the n-th cell."""
    return [f"{v}_{n}=C_c[{tag}][{k}]" for n, tag in enumerate(tags)
            for k, v in enumerate(values, 1)]  # fmt: skip


def compute(values=ALL):
    return f"compute c all dcm/cell {' '.join(values)}\n"


def measured(result, values, n=0, step=-1):
    row = result.thermo[step]
    return {v: row[f"v_{v}_{n}"] for v in values}


def tensor(got, letter):
    m = np.zeros((3, 3))
    for name, i, j in zip(SIX, ROWS, COLUMNS):
        m[i, j] = m[j, i] = got[letter + name]
    return m


def variance(nodes, faces):
    """Of position in the body, by the quadrature of tetrahedra that is exact for squares: a second
    way, not that of the law."""
    corners = nodes[faces]
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    tets = np.concatenate([np.zeros((len(faces), 1, 3)), corners], axis=1)
    a, b = (5 + 3 * math.sqrt(5)) / 20, (5 - math.sqrt(5)) / 20
    points = np.einsum("qk,nkd->nqd", np.full((4, 4), b) + (a - b) * np.eye(4), tets)
    V = volumes.sum()
    mean = np.einsum("n,nqd->d", volumes / 4, points) / V
    square = np.einsum("n,nqd,nqe->de", volumes / 4, points, points) / V
    return square - np.outer(mean, mean), V


@pytest.fixture(scope="module")
def long_mesh(scenes):
    """An ellipsoid 2 : 1 : 1, turned, and the map of the unit sphere to it."""
    nodes, faces = scenes.icosphere(2)
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    F = turn @ np.diag([8.0, 4.0, 4.0]) @ turn.T
    return nodes @ F.T, faces, F


# --- shape ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 3])
def test_an_ellipsoid_across_the_border(lmp, scenes, long_mesh, np_):
    nodes, faces, F = long_mesh
    scene = scenes.Scene(20.0, "p p p")
    tag = scene.dcm(19.0, 2.0, -18.0, 1.0, mesh=("cell.off", len(nodes), len(faces)), options="")
    deck = scene.head() + BARE + LIST + CELL + compute() + scenes.thermo(columns(ALL, [tag]))
    got = measured(
        lmp(deck + "run 0\n", np=np_, files={"cell.off": scenes.off(nodes, faces)}), ALL
    )

    # create_cells makes the radius, of the ball of the same volume, 1
    volume = variance(nodes, faces)[1]
    scale = (3 * volume / (4 * math.pi)) ** (-1 / 3)
    C = variance(scale * nodes, faces)[0]
    values, vectors = np.linalg.eigh(C)
    axes = np.sqrt(5 * values[::-1])
    assert [got[f"axis{k}"] for k in (1, 2, 3)] == pytest.approx(axes, rel=1e-9)
    assert axes == pytest.approx([2 * axes[2], axes[2], axes[2]], rel=1e-9)  # linear map of a ball
    along = np.array([got[f"long_{k}"] for k in "xyz"])
    assert abs(along @ vectors[:, 2]) == pytest.approx(1.0, abs=1e-9)
    assert along[np.argmax(np.abs(along))] > 0.0
    # lambda in the ratio 4 : 1 : 1, hence (3 / 6)^2
    assert got["asphericity"] == pytest.approx(values[2] - values[0], rel=1e-9)
    assert got["acylindricity"] == pytest.approx(0.0, abs=1e-9)
    assert got["anisotropy"] == pytest.approx(0.25, rel=1e-9)
    assert got["sphericity"] == pytest.approx(
        (36 * math.pi * got["volume"] ** 2) ** (1 / 3) / got["area"], rel=1e-12)  # fmt: skip
    assert got["shape_index"] == pytest.approx(
        got["area"] / got["volume"] ** (2 / 3), rel=1e-12)  # fmt: skip
    R = (3 * got["volume0"] / (4 * math.pi)) ** (1 / 3)
    strain = vectors @ np.diag(np.log(np.sqrt(5 * values) / R)) @ vectors.T
    assert tensor(got, "e") == pytest.approx(strain, abs=1e-9)
    # a prolate spheroid of 2 : 1 has 1.07683 times the area of the ball of its volume; a coarse
    # mesh a little more
    assert 1 / got["sphericity"] == pytest.approx(1.07683, abs=0.02)
    assert 1 / got["sphericity"] > 1.07683


def test_a_sphere_has_the_closed_values(lmp, scenes):
    scene = scenes.Scene(10.0)
    tag = scene.cbm(0.0, 0.0, 0.0, 3.0)
    deck = scene.head() + BARE + LIST + compute() + scenes.thermo(columns(ALL, [tag])) + "run 0\n"
    got = measured(lmp(deck), ALL)
    assert [got[k] for k in SHAPE] == pytest.approx(
        [3, 3, 3, 0, 0, 0, 0, 0, 0, 1, (36 * math.pi) ** (1 / 3)], rel=1e-12)  # fmt: skip
    assert all(got[k] == 0.0 for k in (*STRAIN, *STRESS))


# --- stress ---------------------------------------------------------------------------------------



def inside(scene):
    """One more force of the cell's own."""
    return f"fix tension all dcm/tension {scene.map} tension 0.2\n"


def perturbed(scenes):
    """A cell across a border, far from rest."""
    scene = scenes.Scene(20.0, "p p p")
    tag = scene.dcm(19.0, 2.0, 3.0, 6.0)
    head = scene.head() + (
        "group nodes type 2\ndisplace_atoms nodes random 0.4 0.4 0.4 47 units box\n"
    )
    return scene, head, tag


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_pressure_from_outside_whatever_is_within(lmp, scenes, np_):
    """-P in all directions, to the last digits: cortex, bending, tension, volume do not enter."""
    scene, head, tag = perturbed(scenes)
    deck = whole(
        scene, head=head, motion=inside(scene) + "fix load all dcm/traction pressure 0.3\n"
    ) + compute() + scenes.thermo(columns(ALL, [tag])) + "run 0\n"  # fmt: skip
    got = measured(lmp(deck, np=np_), ALL)
    assert tensor(got, "s") == pytest.approx(-0.3 * np.eye(3), abs=1e-11)


@pytest.mark.parametrize("np_", [1, 2])
def test_two_cells_in_contact_have_the_virial_of_the_pair_style(lmp, scenes, np_):
    """Sum of V s over both, and force times distance of their centers: all of what LAMMPS has."""
    scene = scenes.doublet(gap=-0.6)
    head = scene.head() + (
        "group nodes type 2\ngroup first molecule 1\ngroup one intersect first nodes\n"
        "displace_atoms nodes random 0.2 0.2 0.2 9 units box\n"
        "compute push one reduce sum fx fy fz\n"
    )
    values = ["volume", "x", "y", "z", *STRESS]
    deck = whole(scene, head=head) + compute(values) + "compute pair all pressure NULL pair\n" + (
        scenes.thermo([*columns(values, [1, 124]), *(f"f{k}=c_push[{k}]" for k in (1, 2, 3)),
                       *(f"w{n}=c_pair[{k}]*vol" for k, n in enumerate(SIX, 1))])  # fmt: skip
        + "run 0\n"
    )
    result = lmp(deck, np=np_)
    got = [measured(result, values, n) for n in (0, 1)]
    force = np.array([result.thermo[-1][f"v_f{k}"] for k in (1, 2, 3)])
    apart = np.array([got[0][k] - got[1][k] for k in "xyz"])
    outer = np.outer(force, apart)
    total = sum(g["volume"] * tensor(g, "s") for g in got) + (outer + outer.T) / 2
    virial = tensor({"w" + n: result.thermo[-1]["v_w" + n] for n in SIX}, "w")
    assert np.linalg.norm(force) > 0.1
    assert total == pytest.approx(virial, rel=1e-9, abs=1e-9 * np.abs(virial).max())


def test_a_cell_between_two_plates(lmp, scenes):
    """Force F on the nodes at the top, -F at the bottom: s_zz = -F h / V, all else zero but what
    the places of these nodes make."""
    scene, head, tag = perturbed(scenes)
    head += (
        "region up block INF INF INF INF 6.5 INF units box\n"
        "region down block INF INF INF INF INF -0.5 units box\n"
        "group top region up\ngroup up intersect top nodes\n"
        "group bottom region down\ngroup down intersect bottom nodes\n"
        "variable nup equal count(up)\nvariable ndown equal count(down)\n"
        "variable above equal xcm(up,z)\nvariable below equal xcm(down,z)\n"
    )
    F = 0.9
    deck = whole(
        scene, head=head,
        motion=inside(scene) + f"variable push equal -{F}/v_nup\nvariable hold equal {F}/v_ndown\n"
        "fix up up addforce 0 0 v_push\nfix down down addforce 0 0 v_hold\n",
    )  # fmt: skip
    result = lmp(
        deck + compute() + scenes.thermo([*columns(ALL, [tag]), "h=v_above-v_below"]) + "run 0\n"
    )
    got, h = measured(result, ALL), result.thermo[-1]["v_h"]
    assert 4.0 < h < 12.0
    assert got["szz"] == pytest.approx(-F * h / got["volume"], rel=1e-9)
    assert [got["sxx"], got["syy"], got["sxy"]] == pytest.approx([0, 0, 0], abs=1e-11)


@pytest.mark.parametrize("np_", [1, 2])
def test_nodes_that_are_held_have_what_holds_them(lmp, scenes, np_):
    """Left out of fix dcm/motion, or with fix setforce: the same."""
    scene, head, tag = perturbed(scenes)
    head += (
        "region side block INF INF INF INF 5 INF units box\ngroup side region side\n"
        "group held intersect side nodes\ngroup free subtract all held\n"
    )
    out = compute() + scenes.thermo(columns(ALL, [tag])) + "run 0\n"
    left_out = whole(scene, head=head, motion=scene.motion("free")) + out
    by_force = whole(scene, head=head, motion="fix hold held setforce 0 0 0\n" + scene.motion())
    one = tensor(measured(lmp(left_out, np=np_), ALL), "s")
    two = tensor(measured(lmp(by_force + out, np=np_), ALL), "s")
    assert np.abs(one).max() > 0.01
    assert one == pytest.approx(two, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("np_", [1, 4])
def test_stress_of_two_spheres(lmp, scenes, np_):
    """-F d / (2 V) along the line of centers, and minus the pressure in the mean."""
    scene = scenes.Scene(15.0)
    x = np.array([[-2.0, -1.0, 0.5], [2.0, 2.0, 1.5]])
    radius = (3.0, 2.5)
    tags = [scene.cbm(*place, r) for place, r in zip(x, radius)]
    values = ["pressure", "volume", *STRESS]
    deck = scene.head() + BARE + scene.contact() + compute(values) + scenes.thermo(
        [*columns(values, tags), *(f"f{k}=f{k}[1]" for k in "xyz")]
    ) + "run 0\n"  # fmt: skip
    result = lmp(deck, np=np_)
    force = np.array([result.thermo[-1][f"v_f{k}"] for k in "xyz"])
    d = x[1] - x[0]
    assert force @ d != 0.0
    for n in range(2):
        got = measured(result, values, n)
        outer = np.outer(force, d) / (2 * got["volume"])  # of a push apart: negative
        assert tensor(got, "s") == pytest.approx(outer, rel=1e-10, abs=1e-14)
        assert np.trace(tensor(got, "s")) / 3 == pytest.approx(-got["pressure"], rel=1e-10)


# --- together -------------------------------------------------------------------------------------


def test_ranks_agree(lmp, scenes):
    """Two deformable cells and spheres that push and move, one of them stretched."""
    scene = scenes.hybrid(boundary="p p p")
    tags = [1, 124, 247, 370, 371]
    head = scene.head() + (
        "group one molecule 1\ndisplace_atoms one ramp y -2 2 y -1 15 units box\n"
    )
    names = [v for v in ALL if not v.startswith("long_")]
    deck = whole(scene, head=head) + compute(names) + (
        scenes.thermo(columns(names, tags), every=5) + "timestep 0.05\nrun 10\n"
    )
    runs = [lmp(deck, np=n) for n in (1, 2, 4)]
    for n in range(len(tags)):
        one = measured(runs[0], names, n)
        size = max(abs(one[k]) for k in STRESS)
        assert size > 0.0
        for other in runs[1:]:
            two = measured(other, names, n)
            for k in names:
                limit = 1e-6 * size if k in STRESS else 1e-8
                assert two[k] == pytest.approx(one[k], rel=1e-8, abs=limit), (n, k)
    assert measured(runs[0], names)["anisotropy"] > 0.005


@pytest.mark.parametrize("np_", [1, 2])
def test_means_over_time_and_cells(lmp, scenes, np_):
    """fix ave/time of a reduction, fix ave/atom and compute reduce: of the same numbers."""
    scene = scenes.doublet(gap=-0.6)
    deck = whole(scene) + (
        "compute c all dcm/cell sxx anisotropy\n"
        "group centers type 1\n"
        "compute sum centers reduce ave c_c[1] c_c[2]\n"
        "fix each all ave/time 1 1 1 c_sum[*] file each.txt format ' %.17g'\n"
        "fix time all ave/time 1 4 4 c_sum[*]\n"
        "fix atom centers ave/atom 1 4 4 c_c[1] c_c[2]\n"
        "compute late centers reduce ave f_atom[1] f_atom[2]\n"
        + scenes.thermo(["ts=f_time[1]", "tk=f_time[2]", "as=c_late[1]", "ak=c_late[2]"], every=4)
        + "timestep 0.1\nrun 8\n"
    )
    result = lmp(deck, np=np_)
    each = np.loadtxt(result.path / "each.txt")
    assert each[:, 0].tolist() == list(range(9))
    for k, key in enumerate("sk", 1):
        mean = each[5:9, k].mean()
        assert abs(mean) > 1e-8
        assert result.thermo[-1][f"v_t{key}"] == pytest.approx(mean, rel=1e-10)
        assert result.thermo[-1][f"v_a{key}"] == pytest.approx(mean, rel=1e-10)


def test_nothing_in_a_deck_of_others(lmp, scenes):
    """Values that are not asked for are not measured: a deck of volumes sends and computes what it
    did. Counted by the forces: none of them changes."""
    scene = scenes.hybrid()
    out = scenes.dump(file="f.txt", columns="id fx fy fz vx vy vz")
    plain = whole(scene) + "compute c all dcm/cell volume\n" + out + "run 3\n"
    all_of_it = whole(scene) + compute() + "compute s all reduce sum c_c[*]\n" + out + (
        scenes.thermo(["s=c_s[1]"]) + "run 3\n"
    )
    a, b = (lmp(deck).dump("f.txt") for deck in (plain, all_of_it))
    for one, two in zip(a, b, strict=True):
        for k in ("fx", "fy", "fz", "vx", "vy", "vz"):
            assert np.array_equal(one[k], two[k])
