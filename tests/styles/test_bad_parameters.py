"""Bad parameters of cortex and contact: one error that names style, value and remedy."""

import pytest

from support.bad_decks import fails, whole

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
    "keyword": ("", "glue 1", "pair_coeff: unknown keyword glue; known"),
    "no value": ("", "W", "keyword W needs a value"),
    "style keyword": ("glue 1", "", "unknown keyword glue; known"),
    "law": ("law hertz", "", "law must be dmt, maugis or foundation, not hertz"),
    "branch": ("branch x", "", "branch must be cutoff or history, not x"),
    "branch dmt": ("branch history", "", "history is for law maugis"),
    "branch foundation": ("law foundation branch history", "", "history is for law maugis"),
    "layer": ("law foundation", "layer 0", "layer is 0.*positive"),
    "layer text": ("law foundation", "layer thin", "layer is 'thin'.*number"),
    "layer dmt": ("", "layer 0.2", "layer is for law foundation; law dmt has no layer, remove it"),
    "layer maugis": ("law maugis", "layer 0.2", "layer is for law foundation; law maugis has"),
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
    "facing, one": ("facing 40", "", "facing needs 2 values, got 1"),
    "facing, swapped": ("facing 50 40", "", "facing is .*0 <= A1 < A2 <= 90"),
    "facing, far": ("facing 50 100", "", "facing is 100.*0 <= A1 < A2 <= 90"),
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
    "adhesion of a misspelled type": ("* * typo.dcm a a a a",
                                      "typo.dcm: adhesion names the unknown cell type aa.*has: a"),
    "adhesion of a missing type": ("* * gone.dcm a a a a", "names the unknown cell type b"),
    "adhesion twice": ("* * two.dcm a a a a",
                       "'adhesion b a 0.2': it has the value 0.1 above already; remove one"),
    "adhesion of regions twice": ("* * regs.dcm a a a a", "it has the value 0.1 above already"),
    "value twice": ("* * value.dcm a a a a", "'E_contact 2': it has the value 1 above already"),
    "type twice": ("* * types.dcm a a a a", "'celltype a': there is a cell type of this name"),
    "region in a type": ("* * colon.dcm a a a a", "'celltype a:apical'.*':' stands before a reg"),
    "type NULL": ("* * null.dcm a a a a", "'celltype NULL'.*NULL for no cell type"),
}  # fmt: skip
FILES = {
    "soft.dcm": "celltype a\n nu_contact 0.4\nadhesion a a 0.1\n",
    "bare.dcm": "celltype a\n E_contact 1\n nu_contact 0.4\n",
    "nan.dcm": "celltype a\n E_contact nan\n",
    "neg.dcm": "celltype a\n E_contact -1\n nu_contact 0.4\nadhesion a a 0.1\n",
    "key.dcm": "celltype a\n E_contcat 1\n",
    "adh.dcm": "celltype a\n E_contact 1\nadhesion a a -1\n",
    "reg.dcm": "celltype a\n E_contact 1\nadhesion a:top a 1\n",
    "typo.dcm": "celltype a\n E_contact 1\n nu_contact 0.4\nadhesion a a 1\n"
                "adhesion aa:apical a 0\n",
    "gone.dcm": "celltype a\n E_contact 1\n nu_contact 0.4\nadhesion a a 1\nadhesion a b 0\n",
    "two.dcm": "celltype a\ncelltype b\nadhesion a b 0.1\nadhesion b a 0.2\n",
    "regs.dcm": "celltype a\nadhesion a:apical a:basal 0.1\nadhesion a:basal a:apical 0.2\n",
    "value.dcm": "celltype a\n E_contact 1\n E_contact 2\nadhesion a a 1\n",
    "types.dcm": "celltype a\n E_contact 1\ncelltype a\n nu_contact 0.4\nadhesion a a 1\n",
    "colon.dcm": "celltype a:apical\n E_contact 1\n",
    "null.dcm": "celltype NULL\n E_contact 1\n",
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


def test_file_as_editors_leave_it(lmp, scenes):
    """A mark before the first line, Windows and old Mac line ends, a value repeated: read alike."""
    scene, result = scenes.doublet(), []
    text = (
        "celltype a\n E_contact 5\n nu_contact 0.4\n friction_normal 50\n"
        " friction_tangential 50\n nu_contact 0.4\nadhesion a a 0.1\nadhesion a a 0.1\n"
    )
    contact = "pair_style dcm/contact\npair_coeff * * file.dcm a a a a\nneighbor 0.6 multi\n"
    deck = whole(scene, contact=contact, motion="") + scenes.thermo(["press"]) + "run 0\n"
    for changed in (text, "\ufeff" + text, text.replace("\n", "\r\n"), text.replace("\n", "\r")):
        (lmp.folder / "file.dcm").write_bytes(changed.encode())
        done = lmp(deck, files={"file.dcm": lmp.folder / "file.dcm"})
        result.append(done.thermo[-1]["Press"])
    assert result[0] != 0 and len(set(result)) == 1
