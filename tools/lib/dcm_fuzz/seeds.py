"""Whole inputs that cases of files damage: made once in a session, by the program itself."""

import sys
from pathlib import Path

from .grammar import PARAMETERS, TYPES, parameter_text

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests"))
from support import meshes  # noqa: E402

HEAD = "units lj\natom_style dcm\nnewton on\nboundary {boundary}\n"
ROOM = "extra/bond/per/atom 8 extra/dihedral/per/atom 8"
BOX = (
    "region box block -25 25 -15 15 -14 14\n"
    f"create_box 8 box bond/types 2 dihedral/types 2 {ROOM}\nmass * 1.0\n"
)
MADE = (
    "create_cells single hep dcm -5.9 0.1 0 6 dcm hep 1 2 3 1 1 mesh icosphere 1 rest 0.95\n"
    "create_cells single chol dcm 5.9 0 0.2 6 dcm chol 6 7 8 2 2 mesh icosphere 1 rotate 4\n"
    "create_cells single cbm cbm 17 0 0 5 cbm cbm 4\n"
)
LAWS = f"""bond_style dcm/cortex
bond_coeff 1 {PARAMETERS} hepatoblast
bond_coeff 2 {PARAMETERS} chol
dihedral_style dcm/bend
dihedral_coeff 1 {PARAMETERS} hepatoblast rest mesh
dihedral_coeff 2 {PARAMETERS} chol
pair_style dcm/contact law maugis branch history
"""
COEFF = "pair_coeff * *\nneighbor 0.8 multi\n"
CELL = f"fix cell all dcm/cell types {PARAMETERS} {TYPES}\n"
FIXES = """group bile type 6 7 8
fix volume all dcm/volume
fix motility all dcm/motility seed 7 persistence 20
fix tension all dcm/tension
fix growth all dcm/growth seed 5 cycle_time 8 cycle_sd 1 rounding 0.2 0.95
fix division all dcm/division seed 7 log division.log
fix death all dcm/death age 1e6 log death.log
fix polarity all dcm/polarity seed 3 junction auto
fix tracer bile dcm/tracer type 5 number 10 D 0.02 seed 5
fix osmosis all dcm/osmosis pressure 0.05 marks flood starter apical 50 secrete bile
fix constriction all dcm/constriction when born ramp 20
fix signal all dcm/signal from bile to 6 7 8 2 2 time 50
fix confine all dcm/confine plane z 1.0
fix motion all dcm/motion tolerance 1e-10
"""
OUTPUT = """compute c all dcm/cell volume pressure
compute cs all reduce sum c_c[*]
thermo_style custom step atoms ebond edihed c_cs[*]
thermo_modify norm no flush yes
thermo 1
timestep 0.5
"""
END = "run 3\nwrite_dump all custom last.dump id x y z vx vy vz fx fy fz\n"
SIMPLE = "fix volume all dcm/volume\nfix motion all dcm/motion tolerance 1e-10\n"


def head(boundary="s s s"):
    return HEAD.format(boundary=boundary)


def whole_deck(fixes=FIXES):
    return head() + BOX + MADE + LAWS + CELL + COEFF + fixes + OUTPUT


def reading_deck(fixes=SIMPLE, more=""):
    return head() + f"read_data cells.data {ROOM}\n" + LAWS + CELL + COEFF + fixes + more + OUTPUT


def restart_deck(fixes=FIXES):
    return "read_restart cells.restart\n" + CELL + COEFF + fixes + OUTPUT


def create_deck(command):
    return head() + BOX + command + LAWS + CELL + COEFF + SIMPLE + OUTPUT


def obj(nodes, faces, style="{}"):
    lines = ["# mesh", "o cell"] + [f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in nodes]
    lines += ["vn 0 0 1", "vt 0 0", "s off", "usemtl none"]
    lines += ["f " + " ".join(style.format(k + 1) for k in face) for face in faces]
    return "\n".join(lines) + "\n"


def mesh_files():
    """Name -> text of whole meshes."""
    sphere, box = meshes.icosphere(1), meshes.cube(2)
    tetrahedron = ([(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)],
                   [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])  # fmt: skip
    return {
        "sphere.off": meshes.off(*sphere), "box.off": meshes.off(*box),
        "four.off": meshes.off(*map(list, tetrahedron)).replace(".17g", "g"),
        "sphere.obj": obj(*sphere), "box.obj": obj(*box, "{0}//1"), "bar.obj": obj(*box, "{0}/1/1"),
    }  # fmt: skip


TABLE = """# typename kind x y z radius
hep dcm -5.9 0.1 0 6
hep dcm 5.9 0 0.2 6   # the second
cbm cbm 17 0 0 5
cbm cbm 0 10.5 0 4
"""


def records(data):
    """First and last byte of each record of the package: magic, style, version, size, checksums
    (dcm_record.h). What LAMMPS itself writes around them has no checksum."""
    found, at = [], data.find(b"DCM-re2\n")
    while at >= 0:
        size = int.from_bytes(data[at + 56 : at + 64], "little")
        found.append((at, at + 80 + size))
        at = data.find(b"DCM-re2\n", at + 1)
    return found


class Seeds:
    """Data, rest and restart files, made by the program."""

    def __init__(self, judge, case):
        deck = whole_deck() + (
            "run 6\nwrite_data cells.data nofix nocoeff\n"
            "fix_modify cell rest/write cells.rest\nwrite_restart cells.restart\n"
        )
        path = Path(judge.folder) / "seeds"
        made = case(kind="seeds", seed=0, deck=deck, files={PARAMETERS: parameter_text().encode()})
        code, out, err = judge.start(made, path)
        if code:
            raise SystemExit(f"the whole inputs cannot be made:\n{out[-3000:]}\n{err[-2000:]}")
        self.data, self.rest, self.restart = (
            (path / f"cells.{name}").read_bytes() for name in ("data", "rest", "restart")
        )
        self.records = records(self.restart)
        self.meshes = {name: text.encode() for name, text in mesh_files().items()}
