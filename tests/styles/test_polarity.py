"""Polarity of deformable cells: apical and polar vectors, regions of faces, their heredity."""

import numpy as np
import pytest

from support.bad_decks import whole
from support.divisions import FACE

LATERAL, POLAR, APICAL, JUNCTION, BASAL = range(5)  # numbers of doc page atom_style_dcm
COLUMNS = "id mol type c_p[1] c_p[2] c_p[3] c_p[4] c_f[1] c_f[2] c_f[3] c_c[*] xu yu zu"
A, P = ("c_c[1]", "c_c[2]", "c_c[3]"), ("c_c[4]", "c_c[5]", "c_c[6]")


def polarity(options="", group="all", name="polarity"):
    return f"fix {name} {group} dcm/polarity seed 11 {options}\n"


def deck_of(scene, options="", extra="", every=1, **parts):
    """A deck with all laws, polarity before motion, and a dump of vectors and regions."""
    return (
        scene.head()
        + scene.forces()
        + extra
        + polarity(options)
        + scene.motion()
        + outputs(every)
    )


def outputs(every=1):
    return (
        "timestep 1.0\n"
        "compute p all property/atom kind vertex1 vertex2 vertex3\n"
        "compute f all dcm/face area contact_area region\n"
        "compute c all dcm/cell ax ay az px py pz apical_area junction_area\n"
        f"dump dump.txt all custom {every} dump.txt {COLUMNS}\n"
        "dump_modify dump.txt sort id format float %.17g\n"
    )
