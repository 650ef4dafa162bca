"""Scenes with two cell types, and decks' parts that several families share."""

from support.parameters import CONTACT, CORTEX, FRICTION, adhesion, cell_type
from support.scenes import Scene, words


class TwoTypes(Scene):
    """Cells of types `a` (atom types 1 2 3) and `b` (4 5 6), sphere type 7 as b; parameter file of
    its own, which files() gives. changes: values of b, all of them if `both`."""

    def __init__(self, box=20.0, boundary="s s s", level=1, W=0.1, a=None, b=None):
        super().__init__(box, boundary, level, parameters="two.dcm")
        values = CORTEX | CONTACT | FRICTION
        self.text = cell_type("a", **values | (a or {})) + cell_type("b", **values | (b or {}))
        self.text += "".join(f"adhesion {p} {q} {W}\n" for p, q in ("aa", "ab", "bb"))

    NAMES = "a a a b b b b"

    def files(self, **more):
        return {"two.dcm": self.text, **more}

    def cell(self, kind, x, y, z, radius, level=None, options="rotate 3 rest 0.95"):
        level = self.level if level is None else level
        first = 1 if kind == "a" else 4
        types = f"{first} {first + 1} {first + 2} {first // 3 + 1} {first // 3 + 1}"
        self.cells.append(
            f"create_cells single hep dcm {words(x, y, z, radius)} dcm hep {types} "
            f"mesh icosphere {level} {options}"
        )
        return self._tag(1 + 30 * 4**level + 2)

    def head(self):
        text = super().head()
        return text.replace(
            "create_box 4 box bond/types 1 dihedral/types 1",
            "create_box 7 box bond/types 2 dihedral/types 2",
        )

    def cortex(self, bond="", bend="rest mesh"):
        lines = "".join(
            f"bond_coeff {n} {self.parameters} {name} {bond}\n"
            f"dihedral_coeff {n} {self.parameters} {name} {bend}\n"
            for n, name in ((1, "a"), (2, "b"))
        )
        return "bond_style dcm/cortex\ndihedral_style dcm/bend\n" + lines


def push(cell, force, nodes, node_type=2, axis=0):
    """A force (nN) on a deformable cell, shared by its nodes."""
    parts = ["0"] * 3
    parts[axis] = repr(float(force / nodes))
    return (
        f"group cell{cell} molecule {cell}\ngroup nodes{node_type} type {node_type}\n"
        f"group push{cell}{axis} intersect cell{cell} nodes{node_type}\n"
        f"fix push{cell}{axis} push{cell}{axis} addforce {' '.join(parts)}\n"
    )


def one_type(**changes):
    """Text of the tests' parameter file with other values: E_cor, gamma, ..., W."""
    W = changes.pop("W", 0.1)
    values = CORTEX | CONTACT | FRICTION | dict(D=1e-4) | changes
    spheres = {k: v for k, v in values.items() if k not in CORTEX or k == "K_V"}
    return (
        cell_type("hepatoblast", **values) + cell_type("hepatoblast_cbm", **spheres) + adhesion(W)
    )
