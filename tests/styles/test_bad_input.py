"""Bad input: one error that names style, value and remedy, before the first step; files stay."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

KEEP = "keep this"
GUARDED = ("keep.data", "keep.restart", "keep.txt")
TAIL = "write_data keep.data\nwrite_restart keep.restart\nprint lost file keep.txt\n"
ROOT = Path(__file__).resolve().parents[2]


def lines_of_error(result):
    return [line for line in result.out.splitlines() if "ERROR" in line]


def fails(lmp, deck, *patterns, run=True, files=None, **options):
    """Run a deck that must end in exactly one error with all patterns in its message."""
    files = {**{name: KEEP for name in GUARDED}, **(files or {})}
    tail = "timestep 1.0\nthermo 1\nrun 2\n" if run is True else (run or "")
    result = lmp.run(deck + tail + TAIL, files=files, timeout=60, **options)
    assert result.returncode != 0, "no error:\n" + result.tail()
    errors = lines_of_error(result)
    assert len(errors) == 1, result.tail()
    assert "Segmentation" not in result.err, result.tail()
    assert not result.thermo, "the error came after the first step:\n" + result.tail()
    message = result.error.replace("\n", " ")
    for pattern in patterns:
        assert re.search(pattern, message), f"no '{pattern}' in: {message}"
    for name in GUARDED:
        assert (result.path / name).read_text() == KEEP, f"{name} was overwritten"
    return result


def whole(scene, **replace):
    """A complete deck, with some of its parts replaced."""
    parts = {
        "head": scene.head(),
        "cortex": scene.cortex(),
        "contact": scene.contact(),
        "cell": "fix cell all dcm/cell\n",
        "volume": scene.volume(),
        "extra": "",
        "motion": scene.motion(),
    }
    unknown = set(replace) - set(parts)
    assert not unknown, unknown
    return "".join({**parts, **replace}.values())


# --- meshes ---------------------------------------------------------------------------------------


def octahedron():
    nodes = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [
        (0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5),
    ]  # fmt: skip
    return nodes, faces


def off(nodes, faces):
    return (
        f"OFF\n{len(nodes)} {len(faces)} 0\n"
        + "".join(f"{x} {y} {z}\n" for x, y, z in nodes)
        + "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)
    )


def bad_meshes():
    nodes, faces = octahedron()
    two = [(x + 5, y, z) for x, y, z in nodes]
    pinched = nodes + [(x + 2, y, z) for i, (x, y, z) in enumerate(nodes) if i != 1]
    new = {1: 0, **{i: 6 + n for n, i in enumerate(i for i in range(6) if i != 1)}}
    text = off(nodes, faces)
    return {
        "open": (off(nodes, faces[:-1]), "open|one face|border"),
        "one face flipped": (off(nodes, faces[:-1] + [faces[-1][::-1]]), "flip"),
        "all faces flipped": (off(nodes, [f[::-1] for f in faces]), "inside out.*flip"),
        "edge of three faces": (off(nodes + [(2, 2, 2)], faces + [(0, 2, 6)]), "face|edge"),
        "touching at a node": (
            off(pinched, faces + [tuple(new[i] for i in f) for f in faces]),
            "manifold|touch",
        ),
        "two components": (
            off(nodes + two, faces + [tuple(i + 6 for i in f) for f in faces]),
            "component",
        ),
        "flat face": (off(nodes[:4] + [(0.5, 0.5, 0.0)] + nodes[5:], faces), "degenerate"),
        "node twice in a face": (off(nodes, faces[:-1] + [(0, 0, 5)]), "face"),
        "unused node": (off(nodes + [(3, 3, 3)], faces), "node"),
        "index too large": (off(nodes, faces[:-1] + [(0, 3, 6)]), "index 6"),
        "truncated in nodes": ("\n".join(text.splitlines()[:5]), "truncated"),
        "truncated in faces": ("\n".join(text.splitlines()[:12]), "truncated"),
        "empty": ("", "empty"),
        "text": (text.replace("1 0 0", "one 0 0", 1), "'one' is not a finite number"),
        "nan": (text.replace("1 0 0", "nan 0 0", 1), "'nan' is not a finite number"),
        "no OFF": (text.replace("OFF", "FFO"), "OFF"),
    }


@pytest.mark.parametrize("case", bad_meshes())
def test_mesh_file(lmp, scenes, case):
    text, pattern = bad_meshes()[case]
    scene = scenes.Scene()
    scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=("bad.off", 6, 8))
    fails(lmp, whole(scene), "Create_cells", pattern, files={"bad.off": text})


def test_mesh_file_missing(lmp, scenes):
    scene = scenes.Scene()
    scene.dcm(0.0, 0.0, 0.0, 6.0, mesh=("none.off", 6, 8))
    fails(lmp, whole(scene), "Create_cells", "cannot open mesh file none.off", "check its name")


# --- create_cells ---------------------------------------------------------------------------------

CELL = "create_cells single hep dcm 0 0 0 6 dcm hep 1 2 3 1 1 mesh icosphere 1"
CREATE = {
    "radius negative": (CELL.replace(" 6 ", " -6 "), "radius is -6", "positive"),
    "radius zero": (CELL.replace(" 6 ", " 0 "), "radius is 0", "positive"),
    "radius nan": (CELL.replace(" 6 ", " nan "), "'?nan'?", "number|finite"),
    "radius text": (CELL.replace(" 6 ", " six "), "'six' is not a number"),
    "position text": (CELL.replace("0 0 0", "0 a 0"), "'a' is not a number"),
    "unknown keyword": (CELL + " spin 3", "unknown keyword spin", "known: "),
    "unknown mesh": (CELL.replace("icosphere 1", "cube 1"), "unknown mesh cube", "icosphere"),
    "level text": (CELL.replace("icosphere 1", "icosphere one"), "one"),
    "level too large": (CELL.replace("icosphere 1", "icosphere 9"), "9", "level"),
    "level negative": (CELL.replace("icosphere 1", "icosphere -1"), "-1", "level"),
    "rest zero": (CELL + " rest 0", "rest is 0", "above 0"),
    "rest text": (CELL + " rest x", "'x' is not a number"),
    "rotate text": (CELL + " rotate x", "x"),
    "rotate zero": (CELL + " rotate 0", "rotate.*positive"),
    "scale text": (CELL + " scale x", "scale is x", "volume or nodes"),
    "atom type text": (CELL.replace("hep 1 2 3", "hep one 2 3"), "'one' is not a type"),
    "atom type too large": (CELL.replace("hep 1 2 3", "hep 1 2 9"), "type 9", "create_box"),
    "atom types equal": (CELL.replace("hep 1 2 3", "hep 1 2 2"), "three different"),
    "no types": ("create_cells single hep dcm 0 0 0 6 mesh icosphere 1", "no atom types for"),
    "no values": ("create_cells", "[Cc]reate_cells"),
    "outside box": (CELL.replace("0 0 0", "90 0 0"), "outside the box", "enlarge"),
    "table missing": ("create_cells table none.txt " + CELL[35:], "cannot open.*none.txt"),
    "table empty": ("create_cells table empty.txt " + CELL[35:], "empty.txt names no cell"),
    "table row": ("create_cells table row.txt " + CELL[35:], "row.txt", "expected NAME"),
    "unknown source": (CELL.replace("single", "many"), "many"),
}


@pytest.mark.parametrize("case", CREATE)
def test_create_cells(lmp, scenes, case):
    command, *patterns = CREATE[case]
    scene = scenes.Scene(boundary="f f f")
    scene.cells = [command]
    files = {"empty.txt": "# none\n", "row.txt": "hep dcm 0 0\n"}
    fails(lmp, whole(scene), "[Cc]reate_cells", *patterns, files=files)


# --- parameters -----------------------------------------------------------------------------------

BOND = "bond_coeff 1 bile_duct.dcm hepatoblast "
BEND = "dihedral_coeff 1 bile_duct.dcm hepatoblast "


def cortex(bond="", bend="", style=""):
    return (
        f"bond_style dcm/cortex {style}\n{bond or BOND}\n"
        f"dihedral_style dcm/bend\n{bend or BEND}\n"
    )


PARAMETERS = {
    # part of the deck, its text, patterns
    "E_cor negative": ("cortex", cortex(BOND + "E_cor -1"), "Bond.*E_cor.* -1.*positive"),
    "E_cor zero": ("cortex", cortex(BOND + "E_cor 0"), "Bond.*E_cor.* 0.*positive"),
    "E_cor nan": ("cortex", cortex(BOND + "E_cor nan"), "Bond.*E_cor is 'nan'.*number"),
    "E_cor inf": ("cortex", cortex(BOND + "E_cor inf"), "Bond.*E_cor is 'inf'.*number"),
    "E_cor huge": ("cortex", cortex(BOND + "E_cor 1e999"), "Bond.*E_cor"),
    "E_cor text": ("cortex", cortex(BOND + "E_cor soft"), "Bond.*E_cor is 'soft'.*number"),
    "E_cor no value": ("cortex", cortex(BOND + "E_cor"), "Bond.*E_cor needs a value"),
    "h_cor negative": ("cortex", cortex(BOND + "h_cor -1"), "Bond.*h_cor.* -1.*positive"),
    "gamma negative": ("cortex", cortex(BOND + "gamma -1"), "Bond.*gamma.* -1"),
    "bond keyword": ("cortex", cortex(BOND + "spring 1"), "Bond.*unknown keyword spring; known"),
    "stiffness text": ("cortex", cortex(BOND + "stiffness x"), "Bond.*stiffness.*area.*young.*x"),
    "bond file": ("cortex", cortex("bond_coeff 1 none.dcm hepatoblast"), "Bond.*none.dcm.*path"),
    "bond type name": ("cortex", cortex("bond_coeff 1 bile_duct.dcm liver"),
                       "Bond.*unknown cell type liver.*hepatoblast"),
    "bond no name": ("cortex", cortex("bond_coeff 1 bile_duct.dcm"), "Bond.*expected.*cell-type"),
    "bond without moduli": ("cortex", cortex("bond_coeff 1 bile_duct.dcm mesenchyme"),
                            "Bond.*no value of E_cor for cell type mesenchyme; add"),
    "bond type text": ("cortex", cortex("bond_coeff one bile_duct.dcm hepatoblast"), "one"),
    "bond style arguments": ("cortex", cortex(style="fast"), "fast|[Ii]llegal"),
    "no bond_coeff": ("cortex", cortex("#", "#"), "[Bb]ond coeffs? .*not set"),
    "no dihedral_coeff": ("cortex", cortex(bend="#"), "[Dd]ihedral coeffs? .*not set"),
    "nu_cor": ("cortex", cortex(bend=BEND + "nu_cor 1.5"), "Dihedral.*nu_cor.*1.5.*between"),
    "nu_cor text": ("cortex", cortex(bend=BEND + "nu_cor x"), "Dihedral.*nu_cor is 'x'"),
    "bend h_cor": ("cortex", cortex(bend=BEND + "h_cor -1"), "Dihedral.*h_cor.*-1.*positive"),
    "bend keyword": ("cortex", cortex(bend=BEND + "k 1"), "Dihedral.*unknown keyword k; known"),
    "bend rest": ("cortex", cortex(bend=BEND + "rest x"), "Dihedral.*rest must be flat or mesh"),
}  # fmt: skip


@pytest.mark.parametrize("case", PARAMETERS)
def test_cortex(lmp, scenes, case):
    part, text, *patterns = PARAMETERS[case]
    fails(lmp, whole(scenes.single_cell(), **{part: text}), *patterns)


CONTACT = {
    # pair_style arguments, pair_coeff arguments after the names, patterns
    "E_contact": ("", "E_contact -1", "E_contact is -1.*positive"),
    "E_contact nan": ("", "E_contact nan", "E_contact is 'nan'.*number"),
    "E_contact text": ("", "E_contact hard", "E_contact is 'hard'.*number"),
    "nu_contact": ("", "nu_contact 0.7", "nu_contact.*0.7.*at most 0.5"),
    "W negative": ("", "W -0.1", "W is -0.1.*zero or positive"),
    "W text": ("", "W glue", "W is 'glue'.*number"),
    "friction": ("", "friction_normal -1", "friction_normal.*-1.*zero or positive"),
    "keyword": ("", "glue 1", "unknown pair_coeff keyword glue; known"),
    "no value": ("", "W", "keyword W needs a value"),
    "style keyword": ("glue 1", "", "unknown keyword glue; known"),
    "law": ("law hertz", "", "law is hertz.*dmt maugis"),
    "branch": ("branch x", "", "branch is x.*cutoff history"),
    "branch dmt": ("branch history", "", "history is for law maugis"),
    "points": ("points 5", "", "points is 5.*1 to 4"),
    "points text": ("points x", "", "x"),
    "h0": ("h0 -1", "", "h0 is -1.*positive"),
    "h0 text": ("h0 x", "", "h0 is 'x'.*number"),
    "h0 auto": ("h0 auto", "", "h0 auto needs a value"),
    "rmax": ("rmax 0.5", "", "rmax is 0.5.*at least 1"),
    "rmax text": ("rmax x", "", "rmax is 'x'.*number"),
    "range": ("range 0", "", "range is 0.*positive"),
    "range below h0": ("h0 0.2 range 0.1", "", "range is 0.1.*below h0"),
    "maxoverlap": ("maxoverlap -1", "", "maxoverlap is -1.*positive"),
    "growth": ("growth 0.9", "", "growth is 0.9.*at least 1"),
}


@pytest.mark.parametrize("case", CONTACT)
def test_contact(lmp, scenes, case):
    style, coeff, *patterns = CONTACT[case]
    scene = scenes.doublet()
    fails(lmp, whole(scene, contact=scene.contact(style, coeff)), "Pair style dcm/contact",
          *patterns)  # fmt: skip


PAIR_COEFF = {
    "file missing": ("* * none.dcm {names}", "Pair.*cannot open.*none.dcm.*path"),
    "unknown type": ("* * bile_duct.dcm liver liver liver liver",
                     "Pair.*unknown cell type liver.*hepatoblast"),
    "too few names": ("* * bile_duct.dcm hepatoblast", "Pair.*4 cell-type names"),
    "one pair": ("1 2 bile_duct.dcm {names}", "[Pp]air_coeff must start with"),
    "no modulus": ("* * soft.dcm a a a a", "Pair.*no value of E_contact for cell type a; add"),
    "no adhesion": ("* * bare.dcm a a a a", "Pair.*no adhesion between cell types a and a; add"),
    "file nan": ("* * nan.dcm a a a a", "Pair.*E_contact is 'nan'.*number"),
    "file negative": ("* * neg.dcm a a a a", "Pair.*E_contact of cell type a is -1.*positive"),
    "file keyword": ("* * key.dcm a a a a", "Pair.*key.dcm.*E_contcat 1.*known keywords"),
    "file adhesion": ("* * adh.dcm a a a a", "Pair.*adhesion is -1.*zero or positive"),
    "file region": ("* * reg.dcm a a a a", "Pair.*unknown region top; known"),
}  # fmt: skip
FILES = {
    "soft.dcm": "celltype a\n nu_contact 0.4\nadhesion a a 0.1\n",
    "bare.dcm": "celltype a\n E_contact 1\n nu_contact 0.4\n",
    "nan.dcm": "celltype a\n E_contact nan\n",
    "neg.dcm": "celltype a\n E_contact -1\n nu_contact 0.4\nadhesion a a 0.1\n",
    "key.dcm": "celltype a\n E_contcat 1\n",
    "adh.dcm": "celltype a\n E_contact 1\nadhesion a a -1\n",
    "reg.dcm": "celltype a\n E_contact 1\nadhesion a:top a 1\n",
}


@pytest.mark.parametrize("case", PAIR_COEFF)
def test_pair_coeff(lmp, scenes, case):
    text, *patterns = PAIR_COEFF[case]
    scene = scenes.doublet()
    contact = f"pair_style dcm/contact\npair_coeff {text.format(names=scene.NAMES)}\n"
    fails(lmp, whole(scene, contact=contact + "neighbor 0.4 multi\n"), *patterns, files=FILES)


def test_no_pair_coeff(lmp, scenes):
    contact = "pair_style dcm/contact\nneighbor 0.4 multi\n"
    fails(lmp, whole(scenes.doublet(), contact=contact), "[Pp]air coeffs are not set|pair_coeff")


# --- fixes and computes ---------------------------------------------------------------------------

VOLUME = "fix volume all dcm/volume {map} "
MOTION = "fix motion all dcm/motion {map} "
MOTILITY = "fix motility all dcm/motility {map} "
CONFINE = "fix confine all dcm/confine "
FIXES = {
    "K_V negative": (VOLUME + "K_V -1", "Fix dcm/volume: K_V is -1.*positive"),
    "K_V zero": (VOLUME + "K_V 0", "Fix dcm/volume: K_V is 0.*positive"),
    "K_V nan": (VOLUME + "K_V nan", "Fix dcm/volume: K_V is 'nan'.*number"),
    "K_V text": (VOLUME + "K_V soft", "Fix dcm/volume: K_V is 'soft'.*number"),
    "volume form": (VOLUME + "form x", "Fix dcm/volume: form must be gradient or voronoi, not x"),
    "volume keyword": (VOLUME + "x 1", "Fix dcm/volume: unknown keyword x; known"),
    "volume file": ("fix v all dcm/volume none.dcm a a a a", "Fix dcm/volume.*none.dcm.*path"),
    "volume type": ("fix v all dcm/volume bile_duct.dcm a a a a", "Fix dcm/volume.*cell type a"),
    "volume names": ("fix v all dcm/volume bile_duct.dcm", "Fix dcm/volume: expected"),
    "volume modulus": ("fix v all dcm/volume bile_duct.dcm mesenchyme NULL NULL NULL",
                       "Fix dcm/volume: no value of K_V for cell type mesenchyme"),
    "volume twice": (VOLUME + "\n" + VOLUME.replace("fix volume", "fix again"),
                     "Fix dcm/volume: fixes .* both act on cell 1"),
    "friction negative": (MOTION + "friction_ecm -1", "Fix dcm/motion.*friction_ecm.*-1"),
    "friction nan": (MOTION + "friction_ecm nan", "Fix dcm/motion: friction_ecm is 'nan'"),
    "friction text": (MOTION + "friction_ecm x", "Fix dcm/motion: friction_ecm is 'x'"),
    "tolerance": (MOTION + "tolerance 0", "Fix dcm/motion: tolerance is 0.*positive"),
    "tolerance large": (MOTION + "tolerance 2", "Fix dcm/motion: tolerance is 2.*below 1"),
    "tolerance text": (MOTION + "tolerance x", "Fix dcm/motion: tolerance is 'x'"),
    "maxiter": (MOTION + "maxiter 1.5", "Fix dcm/motion: maxiter is 1.5.*whole"),
    "maxiter text": (MOTION + "maxiter x", "Fix dcm/motion: maxiter is 'x'"),
    "maxmove": (MOTION + "maxmove -1", "Fix dcm/motion: maxmove is -1.*positive"),
    "maxmove text": (MOTION + "maxmove x", "Fix dcm/motion: maxmove is 'x'"),
    "floor": (MOTION + "floor 2", "Fix dcm/motion: floor is 2, must be 0 to 1"),
    "precondition": (MOTION + "precondition x", "Fix dcm/motion: unknown precondition x; known"),
    "motion keyword": (MOTION + "x 1", "Fix dcm/motion: unknown keyword x; known"),
    "motion file": ("fix m all dcm/motion none.dcm a a a a", "Fix dcm/motion.*none.dcm.*path"),
    "motion type": ("fix m all dcm/motion bile_duct.dcm a a a a", "Fix dcm/motion.*cell type a"),
    "motion names": ("fix m all dcm/motion", "Fix dcm/motion: expected"),
    "motion NULL": ("fix m all dcm/motion bile_duct.dcm NULL NULL NULL NULL",
                    "Fix dcm/motion: atom type 2 holds nodes.*NULL"),
    "motion twice": (MOTION + "\n" + MOTION.replace("fix motion", "fix again"),
                     "Fix dcm/motion: there are two"),
    "motion and nve": (MOTION + "\nfix nve all nve", "Fix dcm/motion and fix nve.*unfix one"),
    "motility seed": (MOTILITY, "Fix dcm/motility: add 'seed S'"),
    "motility seed text": (MOTILITY + "seed x", "Fix dcm/motility: seed is 'x', expected"),
    "motility seed negative": (MOTILITY + "seed -1", "Fix dcm/motility: seed is '-1'"),
    "motility D": (MOTILITY + "seed 1 D -1", "Fix dcm/motility: D is -1"),
    "motility D nan": (MOTILITY + "seed 1 D nan", "Fix dcm/motility: D is 'nan'"),
    "motility D text": (MOTILITY + "seed 1 D x", "Fix dcm/motility: D is 'x'"),
    "motility bias": (MOTILITY + "seed 1 bias 0 0 0 1", "Fix dcm/motility.*bias is zero"),
    "motility bias text": (MOTILITY + "seed 1 bias 0 x 0 1", "Fix dcm/motility: bias is 'x'"),
    "motility bias short": (MOTILITY + "seed 1 bias 0 0", "Fix dcm/motility.*bias needs 4"),
    "motility persistence": (MOTILITY + "seed 1 persistence 0", "persistence is 0.*positive"),
    "motility plane": (MOTILITY + "seed 1 plane w", "Fix dcm/motility: plane must be x, y or z"),
    "motility keyword": (MOTILITY + "seed 1 x 1", "Fix dcm/motility: unknown keyword x; known"),
    "motility names": ("fix m all dcm/motility", "Fix dcm/motility: expected"),
    "confine nothing": (CONFINE, "Fix dcm/confine: give 'pressure"),
    "confine pressure": (CONFINE + "pressure -1 over all", "Fix dcm/confine: pressure is -1"),
    "confine text": (CONFINE + "pressure x over all", "Fix dcm/confine: pressure is 'x'"),
    "confine nan": (CONFINE + "pressure nan over all", "Fix dcm/confine: pressure is 'nan'"),
    "confine over": (CONFINE + "pressure 1", "Fix dcm/confine: pressure needs 'over GROUP'"),
    "confine group": (CONFINE + "pressure 1 over none", "Fix dcm/confine: over: there is no group"),
    "confine axis": (CONFINE + "pressure 1 over all axis w", "Fix dcm/confine: axis must be"),
    "confine center": (CONFINE + "pressure 1 over all center 0 x", "confine: center is 'x'"),
    "confine tau": (CONFINE + "pressure 1 over all tau 0", "Fix dcm/confine: tau is 0.*positive"),
    "confine tau short": (CONFINE + "pressure 1 over all tau 1", "tau is 1, must be at least 10"),
    "confine limit": (CONFINE + "pressure 1 over all limit x", "Fix dcm/confine: limit is 'x'"),
    "confine area": (CONFINE + "pressure 1 over all area -1", "Fix dcm/confine: area is -1"),
    "confine plane": (CONFINE + "plane z x", "Fix dcm/confine: plane force constant is 'x'"),
    "confine plane axis": (CONFINE + "plane w 1", "Fix dcm/confine: plane must be x, y or z"),
    "confine at": (CONFINE + "plane z 1 at x", "Fix dcm/confine: at is 'x'"),
    "confine keyword": (CONFINE + "x 1", "Fix dcm/confine: unknown keyword x; known"),
    "confine short": (CONFINE + "pressure", "Fix dcm/confine: keyword pressure needs 1 value"),
    "cell keyword": ("fix c all dcm/cell x", "Fix dcm/cell: unknown keyword x"),
    "cell group": ("group g empty\nfix c g dcm/cell", "Fix dcm/cell must have group all, not g"),
    "cell twice": ("fix c all dcm/cell\nfix d all dcm/cell", "fix dcm/cell already.*exactly one"),
    "compute cell": ("compute c all dcm/cell mass", "Compute dcm/cell: unknown value mass; known"),
    "compute cell none": ("compute c all dcm/cell", "Compute dcm/cell: no values given; known"),
    "compute face": ("compute c all dcm/face mass", "Compute dcm/face: unknown value mass; known"),
    "compute face none": ("compute c all dcm/face", "Compute dcm/face: no values given; known"),
}  # fmt: skip


@pytest.mark.parametrize("case", FIXES)
def test_fix(lmp, scenes, case):
    text, *patterns = FIXES[case]
    scene = scenes.doublet()
    text = text.format(map=scene.map) + "\n"
    drop = {"extra": text}
    for part, style in (("volume", "dcm/volume"), ("motion", "dcm/motion"), ("cell", "dcm/cell")):
        if re.search(style + r"\b", text) and "compute" not in text:
            drop[part] = ""
    fails(lmp, whole(scene, **drop), *patterns)


@pytest.mark.parametrize("users", ["volume", "motion", "contact", "compute", "confine", "motility"])
def test_no_fix_cell(lmp, scenes, users):
    """Each style that needs the bookkeeping asks for it."""
    scene = scenes.doublet()
    none = {"cell": "", "volume": "", "motion": "", "contact": ""}
    part = {
        "volume": {"volume": scene.volume()},
        "motion": {"motion": scene.motion()},
        "contact": {"contact": scene.contact()},
        "compute": {"extra": "compute c all dcm/cell volume\n"},
        "confine": {"extra": "fix c all dcm/confine plane z 1\n"},
        "motility": {"extra": scene.motility()},
    }[users]  # fmt: skip
    fails(lmp, whole(scene, **{**none, **part}), "dcm/", "add 'fix cell all dcm/cell'")


def test_timestep(lmp, scenes):
    for dt in ("0.0", "-1.0"):
        run = f"timestep {dt}\nthermo 1\nrun 2\n"
        fails(lmp, whole(scenes.single_cell()), "timestep", dt.rstrip("0").rstrip("."), run=run)


def test_newton_off(lmp, scenes):
    for newton in ("off", "on off", "off on"):
        deck = whole(scenes.doublet()).replace("newton on", f"newton {newton}")
        fails(lmp, deck, "needs newton on")


# --- styles without atom_style dcm ----------------------------------------------------------------

FOREIGN = {
    "bond": "bond_style dcm/cortex\nbond_coeff 1 bile_duct.dcm hepatoblast",
    "dihedral": "dihedral_style dcm/bend\ndihedral_coeff 1 bile_duct.dcm hepatoblast",
    "pair": "pair_style dcm/contact\npair_coeff * * bile_duct.dcm hepatoblast",
    "cell": "fix f all dcm/cell",
    "volume": "fix f all dcm/volume bile_duct.dcm hepatoblast",
    "motion": "fix f all dcm/motion bile_duct.dcm hepatoblast",
    "motility": "fix f all dcm/motility bile_duct.dcm hepatoblast seed 1",
    "confine": "fix f all dcm/confine plane z 1",
    "compute cell": "compute c all dcm/cell volume",
    "compute face": "compute c all dcm/face area",
    "create_cells": "create_cells single a dcm 0 0 0 1 dcm a 1 2 3 1 1 mesh icosphere 1",
}


@pytest.mark.parametrize("style", FOREIGN)
def test_no_atom_style(lmp, scenes, style):
    head = (
        "units lj\natom_style full\nregion b block -5 5 -5 5 -5 5\n"
        "create_box 1 b bond/types 1 dihedral/types 1\nmass 1 1\ncreate_atoms 1 single 0 0 0\n"
    )
    fails(lmp, head + FOREIGN[style] + "\n", "dcm", "needs atom_style dcm", "full")


# --- data and restart files -----------------------------------------------------------------------

RUN = "timestep 1.0\nthermo 1\nrun 2\n"


@pytest.fixture(scope="module")
def saved(lmp_module, scenes):
    """Data and restart file of a doublet, and the text of the data file."""
    done = lmp_module(
        whole(scenes.doublet()) + "write_data cells.data nocoeff\nwrite_restart cells.restart\n"
    )
    return done.path, (done.path / "cells.data").read_text()


def reading(scene, options=""):
    """The deck that reads cells.data."""
    head = f"units lj\natom_style dcm\nnewton on\nboundary s s s\nread_data cells.data {options}\n"
    return whole(scene, head=head)


def edit(text, change):
    """Apply `change` to the words of each line of the section Atoms; None removes the atom."""
    lines, section, count, gone = [], "", 0, set()
    for line in text.splitlines():
        words = line.split()
        if words and words[0].isalpha():
            section = words[0]
        elif section == "Atoms" and words:
            tag, words = words[0], change(words)
            if words is None:
                gone.add(tag)
                continue
            count += 1
            line = " ".join(words)
        elif section == "Velocities" and words and words[0] in gone:
            continue
        lines.append(line)
    return re.sub(r"\d+ atoms", f"{count} atoms", "\n".join(lines) + "\n", count=1)


def with_column(test, column, value):
    def change(words):
        if test(words):
            words[column] = value
        return words

    return change


def first(kind):
    """The first atom of a kind."""
    seen = []

    def test(words):
        if words[3] == kind and not seen:
            seen.append(words[0])
            return True
        return False

    return test


def data_changes():
    # columns: id mol type kind radius x y z v1 v2 v3 region volume0
    def flipped():
        test = first("4")

        def change(words):
            if test(words):
                words[8], words[9] = words[9], words[8]
            return words

        return change

    def inverted(words):
        if words[3] == "4":
            words[8], words[9] = words[9], words[8]
        return words

    def open_face():
        test = first("4")
        return lambda words: None if test(words) else words

    def no_center():
        test = first("2")
        return lambda words: None if test(words) else words

    def two_centers():
        test = first("3")

        def change(words):
            if test(words):
                words[2:4], words[12] = ["1", "2"], "900.0"
            return words

        return change

    return {
        "no center": (no_center, "belongs to cell 1, which has no center", "delete whole cells"),
        "two centers": (two_centers, "cell 1 has two center"),
        "flipped face": (flipped, "cell 1 is not closed or some faces are flipped"),
        "all flipped": (lambda: inverted, "cell [12] has volume -.*flip the mesh"),
        "missing face": (open_face, "cell 1 has .* nodes and .* faces; a closed surface"),
        "missing vertex": (lambda: with_column(first("4"), 8, "99999"), "vertex 99999 of face"),
        "kind": (lambda: with_column(first("3"), 3, "7"), "atom .* has kind 7, must be 1 to 5"),
        "region": (lambda: with_column(first("4"), 11, "9"), "has region 9, must be 0 to 3"),
        "radius": (lambda: with_column(first("4"), 4, "-1"), "has radius -1"),
        "volume0": (lambda: with_column(first("2"), 12, "0"), "rest volume 0, must be positive"),
        "vertex zero": (lambda: with_column(first("4"), 8, "0"), "vertex ID 0, must be positive"),
        "nan": (lambda: with_column(first("3"), 5, "nan"), "nan"),
        "text": (lambda: with_column(first("3"), 5, "left"), "left"),
    }


@pytest.mark.parametrize("case", data_changes())
def test_data_file(lmp, scenes, saved, case):
    make, *patterns = data_changes()[case]
    files = {"cells.data": edit(saved[1], make())}
    fails(lmp, reading(scenes.doublet()), *patterns, files=files)


def test_data_file_truncated(lmp, scenes, saved):
    for part in (0.2, 0.5, 0.8):
        text = saved[1][: int(part * len(saved[1]))]
        fails(lmp, reading(scenes.doublet()), files={"cells.data": text})


def test_errors_on_two_ranks(lmp, scenes, saved):
    """One error line too if all ranks find the same."""
    scene = scenes.doublet()
    files = {"cells.data": edit(saved[1], data_changes()["flipped face"][0]())}
    fails(lmp, reading(scene), "not closed", files=files, np=2)
    fails(lmp, whole(scene, motion=scene.motion(options="x 1")), "unknown keyword x", np=2)
    contact = f"pair_style dcm/contact\npair_coeff * * none.dcm {scene.NAMES}\n"
    fails(lmp, whole(scene, contact=contact), "none.dcm", np=2)


def test_restart_without_plugin(lmp, saved):
    lmp.env = {**lmp.env, "LAMMPS_PLUGIN_PATH": ""}
    files = {"cells.restart": saved[0] / "cells.restart"}
    fails(lmp, "read_restart cells.restart\n", "dcm", "[Uu]n(known|recognized)", files=files)
    deck = "atom_style dcm\n"
    fails(lmp, deck, "dcm", "[Uu]n(known|recognized)")


def test_restart_without_coefficients(lmp, saved):
    """Cell types come again from pair_coeff."""
    files = {"cells.restart": saved[0] / "cells.restart"}
    deck = "read_restart cells.restart\nfix cell all dcm/cell\n"
    fails(lmp, deck, "[Pp]air.*coeff", files=files)


# --- scenes that cannot be --------------------------------------------------------------------------


def test_ghost_cutoff(lmp, scenes):
    scene = scenes.doublet()
    result = fails(
        lmp,
        whole(scene, contact="comm_modify cutoff 0.5\n" + scene.contact()),
        "ghost cutoff 0.5 is too small",
        "set 'comm_modify cutoff [0-9.]+'",
    )
    needed = re.search(r"set 'comm_modify cutoff ([0-9.]+)'", result.error).group(1)
    lmp(whole(scene, contact=f"comm_modify cutoff {needed}\n" + scene.contact()) + RUN)


def test_box_too_small(lmp, scenes):
    scene = scenes.single_cell(box=10.0, boundary="p p p")
    fails(lmp, whole(scene), "cell 1 spans 0.[56].* of a periodic box", "at least two cells wide")


OVERLAP = {
    "dcm dcm": (("dcm", 0.0, 6.0), ("dcm", 6.0, 6.0), "cells 1 and 2 overlap by about 1"),
    "same place": (("dcm", 0.0, 6.0), ("dcm", 0.0, 6.0), "cells 1 and 2 overlap"),
    "inside": (("dcm", 0.0, 9.0), ("dcm", 0.0, 3.0), "cells 1 and 2 overlap"),
    "dcm cbm": (("dcm", 0.0, 6.0), ("cbm", 6.0, 6.0), "cells 1 and 2 overlap by about 0.9"),
    "cbm inside": (("dcm", 0.0, 9.0), ("cbm", 1.0, 3.0), "cells 1 and 2 overlap"),
}


@pytest.mark.parametrize("case", OVERLAP)
def test_start_overlap(lmp, scenes, case):
    *cells, pattern = OVERLAP[case]
    scene = scenes.Scene(30.0, level=2)
    for kind, x, radius in cells:
        getattr(scene, kind)(x, 0.0, 0.0, radius)
    fails(lmp, whole(scene), "Pair style dcm/contact", pattern, "move them apart")


def test_start_overlap_spheres(lmp, scenes):
    """Spheres may overlap far, as after a division: a warning; but not be in the same place."""
    scene = scenes.Scene(30.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(6.0, 0.0, 0.0, 6.0)
    parts = {"cortex": "", "volume": "", "cell": "fix cell all dcm/cell\n"}
    result = lmp(whole(scene, **parts) + "timestep 0.01\n" + "run 0\n")
    assert "1 pairs of center-based cells start with an overlap of more than half" in result.log

    scene = scenes.Scene(30.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    fails(lmp, whole(scene, **parts), "Pair style dcm/contact", "cells 1 and 2")


def test_start_overlap_two_ranks(lmp, scenes):
    scene = scenes.Scene(30.0, level=2)
    scene.dcm(-3.0, 0.0, 0.0, 6.0)
    scene.dcm(3.0, 0.0, 0.0, 6.0)
    fails(lmp, whole(scene), "cells 1 and 2 overlap", "move them apart", np=2)


# --- plugin of another LAMMPS -----------------------------------------------------------------------


def test_other_version(lmp, tmp_path):
    """A plugin for another LAMMPS says so instead of crashing; here only its entry point."""
    cache = Path(lmp.env["LAMMPS_PLUGIN_PATH"].split(":")[0]) / "CMakeCache.txt"
    compiler = shutil.which("mpicxx")
    found = re.search(r"LAMMPS_SOURCE_DIR:PATH=(.*)", cache.read_text() if cache.exists() else "")
    if not found or not compiler:
        pytest.skip("no build folder with a LAMMPS source next to the plugin, or no mpicxx")
    other = tmp_path / "other"
    other.mkdir()
    (other / "dcm_style_headers.h").write_text("")
    command = [compiler, "-std=c++17", "-shared", "-fPIC", "-DLAMMPS_SMALLBIG", "-DLMP_PLUGIN",
               "-DOMPI_SKIP_MPICXX=1", "-DDCM_LAMMPS_VERSION=20200101", f"-I{other}",
               f"-I{found.group(1)}", str(ROOT / "src/plugin/dcmplugin.cpp"),
               "-o", str(other / "dcmplugin.so")]  # fmt: skip
    subprocess.run(command, check=True, timeout=300)
    lmp.env = {**lmp.env, "LAMMPS_PLUGIN_PATH": ""}
    result = lmp.run(f"plugin load {other}/dcmplugin.so\natom_style dcm\n")
    text = result.out + result.err
    assert "compiled for LAMMPS version 20200101, this LAMMPS is version" in text
    assert "Rebuild the plugin with cmake -D LAMMPS_SOURCE_DIR" in text
    assert result.returncode == 1, result.tail()
    assert re.search("dcm", result.error), result.tail()
