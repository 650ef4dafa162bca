"""Parameter files of the tests' own, so that their closed forms outlive changes in potentials/.
Shipped files are found through LAMMPS_POTENTIALS: Scene(parameters=...)."""


def cell_type(name, **values):
    """Lines of a cell type in a parameter file."""
    return f"celltype {name}\n" + "".join(f"  {key} {value}\n" for key, value in values.items())


def adhesion(W):
    """Lines of the adhesion between the cell types of the tests, nN/um."""
    pairs = (("", ""), ("", "_cbm"), ("_cbm", "_cbm"))
    return "".join(f"adhesion hepatoblast{a} hepatoblast{b} {W}\n" for a, b in pairs)


CORTEX = dict(E_cor=5.0, h_cor=0.5, nu_cor=0.5, gamma=4.0, K_V=2.5)
CONTACT = dict(E_contact=5.0, nu_contact=0.4)
FRICTION = dict(friction_normal=50.0, friction_tangential=50.0, friction_ecm=1.0)

# every run finds this one in its folder
PARAMETERS = "test.dcm"
PARAMETER_TEXT = (
    cell_type("hepatoblast", **CORTEX, **CONTACT, **FRICTION, D=1e-4)
    + cell_type("hepatoblast_cbm", **CONTACT | {"E_contact": 0.45}, **FRICTION, D=1e-4)
    + adhesion(0.1)
)

# spheres without adhesion and with little friction
PLAIN = "plain.dcm"
PLAIN_TEXT = (
    cell_type("hepatoblast", **CORTEX, **CONTACT, **FRICTION)
    + cell_type(
        "hepatoblast_cbm", K_V=2.5, E_contact=0.45, nu_contact=0.4, friction_normal=1.0,
        friction_tangential=1.0, friction_ecm=0.1,
    )
    + adhesion(0.0)
)  # fmt: skip
FILES = {PLAIN: PLAIN_TEXT}
