"""Sphinx configuration: python -m sphinx -n -W -b html doc build/doc

Pages are written like those of the LAMMPS manual, so that they can move there unchanged: a
reference such as :doc:`read_data <read_data>` to a page that is not part of this folder becomes
a link into LAMMPS' manual, if the page is listed in LAMMPS_PAGES; any other name is an error.
"""

import re
from pathlib import Path

from docutils import nodes
from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Name, Number, String, Text

project = "LAMMPS-DCM"
author = "the LAMMPS-DCM developers"
copyright = author
header = Path(__file__).parents[1] / "src/DCM/dcm_version.h"
version = release = re.search(r'DCM_VERSION "(.+)"', header.read_text()).group(1)

extensions = ["sphinx.ext.mathjax"]
exclude_patterns = ["_build", "first_steps"]
html_theme = "alabaster"
html_theme_options = {"page_width": "1100px", "description": "Deformable cells for LAMMPS"}
html_copy_source = False
highlight_language = "none"
numfig = False

LAMMPS_MANUAL = "https://docs.lammps.org/"
LAMMPS_PAGES = set(
    """
    Build_cmake atom_style balance boundary change_box comm_modify compute compute_bond_local
    compute_gyration_shape compute_pair compute_pair_local compute_pe_atom compute_property_atom compute_reduce
    create_box delete_atoms
    displace_atoms dump dump_image dump_modify fix fix_adapt fix_addforce fix_ave_atom fix_ave_histo fix_ave_time fix_balance
    fix_box_relax fix_halt fix_indent fix_modify fix_move fix_nve fix_property_atom fix_setforce
    fix_wall fix_wall_region group mass minimize neigh_modify neighbor newton pair_granular plugin read_data
    read_restart region replicate reset_timestep restart run run_style set special_bonds thermo
    thermo_modify thermo_style timestep units variable velocity write_data write_dump write_restart
    """.split()
)


def link_to_lammps(app, env, node, contnode):
    """Resolve :doc: references to pages of the LAMMPS manual."""
    target = node.get("reftarget", "")
    if node.get("reftype") != "doc" or target not in LAMMPS_PAGES:
        return None
    reference = nodes.reference("", "", internal=False, refuri=f"{LAMMPS_MANUAL}{target}.html")
    reference += contnode
    return reference


class LAMMPSLexer(RegexLexer):
    """Enough of LAMMPS' input script language to color it: code-block:: LAMMPS."""

    name = "LAMMPS"
    aliases = ["lammps"]
    tokens = {
        "root": [
            (r"#.*?$", Comment.Single),
            (r"^([ \t]*)([A-Za-z_]+)\b", bygroups(Text, Keyword)),
            (r"\$\([^)]*\)|\$\{\w+\}|\$\w|\b[vcfC]_\w+", Name.Variable),
            (r'"""(.|\n)*?"""|"[^"\n]*"|\'[^\'\n]*\'', String),
            (r"(?<![\w.])[-+]?\d+(\.\d*)?([eE][-+]?\d+)?(?![\w.])", Number),
            (r"\w+", Text),
            (r".|\n", Text),
        ]
    }


def setup(app):
    """Register what the pages need beyond Sphinx."""
    app.connect("missing-reference", link_to_lammps)
    app.add_lexer("LAMMPS", LAMMPSLexer)
