"""Small scenes and parts of decks that the tests share; also the fixture `scenes`."""

import numpy as np

from .meshes import icosphere, off
from .parameters import PARAMETERS
from .runner import read_dump

__all__ = [
    "Scene", "doublet", "dump", "hybrid", "icosphere", "off", "read_dump", "single_cell", "thermo",
    "words",
]  # fmt: skip


def words(*numbers):
    """Numbers for a deck, exact."""
    return " ".join(repr(float(x)) for x in numbers)


class Scene:
    """Text of a deck, part by part. One cell type: atom types 1 center, 2 node, 3 face, 4 sphere.

    s = Scene(box=20); s.dcm(-5, 0, 0, 6); s.cbm(5, 0, 0, 6); deck = s.head() + s.forces() + ...
    """

    NAMES = "hepatoblast hepatoblast hepatoblast hepatoblast_cbm"

    def __init__(self, box=20.0, boundary="s s s", level=1, parameters=PARAMETERS):
        self.box = [float(a) for a in np.broadcast_to(box, 3)]  # half lengths
        self.boundary, self.level, self.parameters = boundary, level, parameters
        self.cells, self.tags, self.next_tag = [], [], 1

    def dcm(self, x, y, z, radius, level=None, mesh=None, options="rotate 3 rest 0.95"):
        """Deformable cell of an icosphere or a mesh file; returns the tag of its center."""
        level = self.level if level is None else level
        shape = f"file {mesh[0]}" if mesh else f"icosphere {level}"
        self.cells.append(
            f"create_cells single hep dcm {words(x, y, z, radius)} dcm hep 1 2 3 1 1 "
            f"mesh {shape} {options}"
        )
        nodes, faces = mesh[1:] if mesh else (10 * 4**level + 2, 20 * 4**level)
        return self._tag(1 + nodes + faces)

    def cbm(self, x, y, z, radius):
        """Center-based cell; returns its tag."""
        self.cells.append(f"create_cells single cbm cbm {words(x, y, z, radius)} cbm cbm 4")
        return self._tag(1)

    def _tag(self, natoms):
        tag, self.next_tag = self.next_tag, self.next_tag + natoms
        return tag

    def head(self):
        """Box and cells."""
        a, b, c = self.box
        return (
            "units lj\natom_style dcm\nnewton on\n"
            f"boundary {self.boundary}\n"
            f"region box block {words(-a, a, -b, b, -c, c)}\n"
            "create_box 4 box bond/types 1 dihedral/types 1 "
            "extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
            "mass * 1.0\n" + "\n".join(self.cells) + "\n"
        )

    @property
    def map(self):
        return f"{self.parameters} {self.NAMES}"

    def cortex(self, bond="", bend="rest mesh"):
        return (
            "bond_style dcm/cortex\n"
            f"bond_coeff 1 {self.parameters} hepatoblast {bond}\n"
            "dihedral_style dcm/bend\n"
            f"dihedral_coeff 1 {self.parameters} hepatoblast {bend}\n"
        )

    def contact(self, style="", coeff=""):
        """Law dmt, unless style says: most tests know its closed forms."""
        if "law" not in style:
            style = f"law dmt {style}"
        return (
            f"pair_style dcm/contact {style}\npair_coeff * * {self.map} {coeff}\n"
            "neighbor 0.6 multi\n"
        )

    def volume(self, options=""):
        return f"fix volume all dcm/volume {self.map} {options}\n"

    def motility(self, seed=7, options=""):
        return f"fix motility all dcm/motility {self.map} seed {seed} {options}\n"

    def motion(self, group="all", options="tolerance 1e-12"):
        """Of scheme explicit, whose velocities are those of the forces, unless options say."""
        if "scheme" not in options:
            options = f"{options} scheme explicit"
        return f"fix motion {group} dcm/motion {self.map} {options}\n"

    def forces(self, contact="", **options):
        """All laws of cells in contact, without motion."""
        return (
            self.cortex(**options)
            + self.contact(contact)
            + "fix cell all dcm/cell\n"
            + self.volume()
        )


def dump(
    columns="id mol type xu yu zu vx vy vz fx fy fz", every=1, file="dump.txt", group="all"
):
    """A dump in which every number is exact."""
    formats = "".join(
        f"dump_modify {file} format {k} %.17g\n"
        for k, name in enumerate(columns.split(), 1)
        if name not in ("id", "mol", "type", "proc", "ix", "iy", "iz")
    )
    return (
        f"dump {file} {group} custom {every} {file} {columns}\n"
        f"dump_modify {file} sort id\n" + formats
    )


def thermo(columns, every=1):
    """Thermo output in full precision; columns: thermo keywords, or name=formula."""
    names, text = [], ""
    for column in columns:
        if "=" in column:
            name, formula = column.split("=", 1)
            text += f"variable {name} equal {formula}\n"
            names.append("v_" + name)
        else:
            names.append(column)
    return (
        text + f"thermo_style custom step {' '.join(names)}\n"
        "thermo_modify norm no format float %.17g\n"
        f"thermo {every}\n"
    )


def single_cell(level=1, radius=6.0, box=15.0, boundary="s s s", options="rotate 3 rest 0.95"):
    """One deformable cell around the origin."""
    scene = Scene(box, boundary, level)
    scene.dcm(0.0, 0.0, 0.0, radius, options=options)
    return scene


def doublet(level=1, radius=6.0, gap=-0.1, boundary="s s s", box=20.0):
    """Two deformable cells along x, `gap` um between their mean surfaces."""
    scene = Scene(box, boundary, level)
    d = radius + gap / 2
    scene.dcm(-d, 0.0, 0.0, radius)
    scene.dcm(d, 0.0, 0.0, radius)
    return scene


def hybrid(level=1, boundary="s s s", box=(26.0, 26.0, 13.0), shift=(0.0, 0.0, 0.0)):
    """Three deformable and four center-based cells, touching."""
    scene = Scene(box, boundary, level)
    sx, sy, sz = shift
    for x, y in ((0.0, 6.8), (-5.9, -3.4), (5.9, -3.4)):
        scene.dcm(x + sx, y + sy, 0.0 + sz, 6.0)
    for x, y in ((-11.0, 7.0), (11.0, 7.0), (0.0, -13.0), (-16.0, -1.5)):
        scene.cbm(x + sx, y + sy, 0.2 + sz, 5.0)
    return scene
