"""Cell types named once per deck, or per style; what a style needs is checked when a run starts."""

import re

import numpy as np
import pytest

from support.bad_decks import RUN, fails, lines_of_error, whole
from support.cycle_decks import growth, same

COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"
CELL = "fix cell all dcm/cell\n"


def once(scene, deck):
    """The deck with its cell types named by fix dcm/cell only."""
    types = f"fix cell all dcm/cell types {scene.map}\n"
    assert CELL in deck
    cortex = f"{scene.parameters} hepatoblast"
    rest = deck.replace(CELL, types, 1).split(types)
    return types.join(part.replace(scene.map, "").replace(cortex, "hepatoblast") for part in rest)


def everything(scene, cell="middle"):
    """A deck of all styles that read parameters; where fix dcm/cell stands."""
    place = {name: CELL if name == cell else "" for name in ("first", "middle", "last")}
    return (
        scene.head()
        + place["first"]
        + scene.cortex("gamma 3.5")
        + scene.contact(coeff="W 0.08")
        + place["middle"]
        + scene.volume("K_V 2.25")
        + growth(scene, "cycle_time 900 K_V 2 compression 0.1 2")
        + scene.motility(options="D 2e-3")
        + scene.motion(options="tolerance 1e-10")
        + place["last"]
    )


# --- one form or the other ------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("cell", ["first", "middle", "last"])
def test_same_run(lmp, scenes, cell, np_):
    """Named once, wherever, or with each style: the same numbers to the last bit."""
    scene = scenes.hybrid()
    deck = everything(scene, cell)
    new = once(scene, deck)
    assert new.count("test.dcm") == 1
    tail = scenes.dump(COLUMNS, 5) + scenes.thermo(["pe", "press"], 5) + "timestep 1.0\nrun 10\n"
    a, b = (lmp(text + tail, np=np_) for text in (deck, new))
    for old, now in zip(a.dump(), b.dump(), strict=True):
        same(old, now, COLUMNS)
    assert a.thermo == b.thermo
    assert np.abs(a.dump()[-1].f).max() > 0.0


def test_own_names_come_first(lmp, scenes):
    """A style with names of its own uses these, the others those of the deck."""
    scene = scenes.doublet()
    soft = "celltype hepatoblast\n  K_V 0.5\n"
    deck = once(scene, whole(scene))
    mine = deck.replace("dcm/volume ", "dcm/volume soft.dcm hepatoblast NULL NULL NULL ")
    keyword = deck.replace("dcm/volume ", "dcm/volume K_V 0.5 ")
    tail = scenes.thermo(["p=f_volume[1]", "pe"]) + RUN
    found = [lmp(text + tail, files={"soft.dcm": soft}).thermo for text in (mine, keyword, deck)]
    assert found[0] == found[1]
    assert found[0] != found[2]


def test_types_may_change_between_runs(lmp, scenes):
    """Each run takes the cell types of the deck as they are then."""
    scene = scenes.single_cell()
    soft = "celltype hepatoblast\n E_cor 1\n h_cor 0.5\n gamma 4\n K_V 0.5\n friction_ecm 1\n"
    deck = once(scene, whole(scene, contact="comm_modify cutoff 14\n"))
    deck += scenes.thermo(["pe", "ebond", "p=f_volume[1]"]) + "timestep 1.0\n"
    again = f"unfix cell\nfix cell all dcm/cell types soft.dcm {scene.NAMES.replace('_cbm', '')}\n"
    files = {"soft.dcm": soft}
    both = lmp(deck + "run 0\n" + again + "run 0\n", files=files)
    softer = deck.replace("types test.dcm", "types soft.dcm").replace("_cbm", "")
    soft_only = lmp(softer + "run 0\n", files=files)
    assert both.runs[1] == soft_only.runs[0]
    assert both.runs[1] != both.runs[0]


def test_spheres_only(lmp, scenes):
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(11.0, 0.0, 0.0, 6.0)
    deck = whole(scene, cortex="", volume="")
    tail = scenes.dump(COLUMNS) + RUN
    for old, now in zip(lmp(deck + tail).dump(), lmp(once(scene, deck) + tail).dump(), strict=True):
        same(old, now, COLUMNS)


def test_restart(lmp, scenes):
    """Cortex coefficients are in the restart file, those of the pair style come again."""
    scene = scenes.doublet()
    deck = once(scene, whole(scene, head="")) + "timestep 1.0\n"
    tail = scenes.dump(COLUMNS, 5) + "restart 5 r.*\n"
    a = lmp(scene.head() + deck + tail + "run 10\n")
    again = "read_restart r.5\n" + deck[deck.index("pair_coeff") :]
    b = lmp(again + tail + "run 5\n", files={"r.5": a.path / "r.5"})
    for old, now in zip(a.dump()[1:], b.dump(), strict=True):
        same(old, now, COLUMNS)


def test_write_data(lmp, scenes):
    """A data file holds the values, not the name alone."""
    scene = scenes.single_cell()
    deck = once(scene, whole(scene, contact="comm_modify cutoff 14\n"))
    text = (lmp(deck + RUN + "write_data x.data\n").path / "x.data").read_text()
    assert re.search(r"^1 NULL hepatoblast E_cor 5 h_cor 0.5 gamma 4 stiffness area", text, re.M)
    assert re.search(r"^1 NULL hepatoblast E_cor 5 h_cor 0.5 nu_cor 0.5 rest mesh", text, re.M)


# --- errors ---------------------------------------------------------------------------------------

NEITHER = "expected cell-type names: say 'fix cell all dcm/cell types FILE name1 ... nameN' once"
STYLES = {
    "volume": "Fix dcm/volume",
    "motion": "Fix dcm/motion",
    "motility": "Fix dcm/motility",
    "growth": "Fix dcm/growth",
    "contact": "Pair style dcm/contact",
    "bond": "Bond style dcm/cortex",
    "dihedral": "Dihedral style dcm/bend",
}


def bare(scene, style):
    """A deck in the old form, but for one style, which has no names."""
    map_, one = scene.map, f"{scene.parameters} hepatoblast"
    parts = {
        "volume": {"volume": scene.volume().replace(map_, "")},
        "motion": {"motion": scene.motion().replace(map_, "")},
        "motility": {"extra": scene.motility().replace(map_, "")},
        "growth": {"extra": growth(scene, "").replace(map_, "")},
        "contact": {"contact": scene.contact().replace(map_, "")},
        "bond": {"cortex": scene.cortex().replace(one, "hepatoblast", 1)},
        "dihedral": {"cortex": "hepatoblast".join(scene.cortex().rsplit(one, 1))},
    }
    return whole(scene, **parts[style])


@pytest.mark.parametrize("style", STYLES)
def test_no_names_anywhere(lmp, scenes, style):
    message = STYLES[style] + ": " + re.escape(NEITHER)
    fails(lmp, bare(scenes.doublet(), style), message, "FILE name")


MISSPELLED = {
    # text in a deck of the new form, what it becomes, patterns
    "volume": ("dcm/volume ", "dcm/volume K_W 2 ",
               "Fix dcm/volume: expected a keyword .known: K_V form. or FILE name1", "K_W"),
    "volume later": ("dcm/volume ", "dcm/volume K_V 2 frm voronoi",
                     "Fix dcm/volume: unknown keyword frm; known: K_V form"),
    "motion": ("dcm/motion  tolerance", "dcm/motion tolernce",
               "Fix dcm/motion: expected a keyword .*tolerance.* or FILE name1", "tolernce"),
    "motion, many words": ("dcm/motion  tolerance 1e-12",
                           "dcm/motion tolernce 1e-4 maxiter 9 floor 0",
                           "Fix dcm/motion: cannot open parameter file tolernce",
                           "If no file was meant: known keywords are friction_ecm tolerance"),
    "pair": ("pair_coeff * *", "pair_coeff * * w 0.1", "Pair.*expected a keyword .*W",
             "FILE name1"),
    "bond": ("bond_coeff 1 hepatoblast", "bond_coeff 1 hepatoblast gama 3",
             "Bond.*cannot open parameter file hepatoblast", "keywords are E_cor h_cor gamma"),
    "bond type": ("bond_coeff 1 hepatoblast", "bond_coeff 1 hepatoblst",
                  "Bond.*unknown cell type hepatoblst; parameter file test.dcm has: hepatoblast"),
    "dihedral type": ("dihedral_coeff 1 hepatoblast rest mesh", "dihedral_coeff 1 liver",
                      "Dihedral.*unknown cell type liver; parameter file test.dcm has:"),
    "cell": ("types test.dcm", "type test.dcm", "Fix dcm/cell: unknown keyword type; known: types"),
    "cell file": ("types test.dcm", "types none.dcm", "Fix dcm/cell.*cannot open.*none.dcm"),
    "cell names": ("hepatoblast_cbm", "", "Fix dcm/cell: expected FILE.* 4 cell-type names"),
    "cell name": ("hepatoblast_cbm", "liver", "Fix dcm/cell: unknown cell type liver; .*has:"),
}  # fmt: skip


@pytest.mark.parametrize("case", MISSPELLED)
def test_misspelled(lmp, scenes, case):
    """Whoever errs in the new form is told of both."""
    scene = scenes.doublet()
    old, now, *patterns = MISSPELLED[case]
    deck = once(scene, whole(scene))
    assert old in deck
    fails(lmp, deck.replace(old, now, 1), *patterns)


def test_no_such_name_without_file(lmp, scenes):
    scene = scenes.single_cell()
    deck = once(scene, whole(scene, contact="")).replace("types test.dcm", "types NULL")
    deck = deck.replace("bond_coeff 1 hepatoblast", "bond_coeff 1 liver E_cor 5 h_cor 0.5 gamma 4")
    unknown = "Bond style dcm/cortex: unknown cell type liver; fix dcm/cell has: hepatoblast"
    fails(lmp, deck, unknown)


# --- checked when a run starts, in whatever order the deck is written -----------------------------

LIMP = "celltype hepatoblast\n  friction_ecm 1.0\ncelltype hepatoblast_cbm\n  friction_ecm 1.0\n"


def still_deck(scene, fixes, before):
    """Cells at rest, with the fixes before or after they are made."""
    cells = "\n".join(scene.cells) + "\n"
    head = scene.head()
    empty = head.replace(cells, "")
    assert empty != head
    comm = "comm_modify cutoff 14\n"
    fixes = CELL + fixes
    return empty + comm + (fixes + cells if before else cells + fixes) + scene.cortex()


@pytest.mark.parametrize("before", [False, True], ids=["after", "before"])
@pytest.mark.parametrize("value", ["missing", "-2", "0", "-2 in the file", "missing, named once"])
def test_bulk_modulus(lmp, scenes, value, before):
    """Without a bulk modulus cells have no pressure: never silently, whatever comes first."""
    scene = scenes.single_cell()
    names = f"limp.dcm {scene.NAMES}"
    limp = LIMP.replace("friction", "K_V -2\n  friction", 1) if "file" in value else LIMP
    fix = f"fix volume all dcm/volume {names}\n"
    if value in ("-2", "0"):
        fix = fix.replace("\n", f" K_V {value}\n")
    deck = still_deck(scene, fix, before)
    if "once" in value:
        deck = deck.replace(CELL, f"fix cell all dcm/cell types {names}\n").replace(
            f"dcm/volume {names}", "dcm/volume"
        )
    what = "no value of K_V for cell type hepatoblast; add" if "missing" in value else "K_V.* is"
    fails(lmp, deck, "Fix dcm/volume: " + what, files={"limp.dcm": limp})


def test_volume_before_cells(lmp, scenes):
    """Defined before the cells, fix dcm/volume does what it does after them."""
    scene = scenes.single_cell()
    decks = [still_deck(scene, scene.volume(), before) for before in (False, True)]
    tail = scenes.thermo(["pe", "p=f_volume[1]"]) + "run 0\n"
    after, before = (lmp(deck + tail).thermo for deck in decks)
    assert after == before
    assert before[0]["v_p"] != 0.0


def test_bulk_modulus_of_a_cell_that_comes_in_the_run(lmp, scenes):
    """A sphere becomes deformable, and its new type has no bulk modulus."""
    scene = scenes.Scene(20.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    deck = still_deck(scene, f"fix volume all dcm/volume limp.dcm {scene.NAMES}\n", False)
    deck += growth(scene, "") + "region in block -5 5 -5 5 -5 5\n"
    deck += "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 region in in every 5\n"
    result = lmp.run(deck + "thermo 1\ntimestep 1.0\nrun 9\n", files={"limp.dcm": LIMP})
    assert result.returncode != 0, result.tail()
    assert len(lines_of_error(result)) == 1, result.tail()
    message = result.error.replace("\n", " ")
    assert re.search("Fix dcm/volume: no value of K_V for cell type hepatoblast; add", message)
    assert len(result.thermo) == 5, result.tail()


@pytest.mark.parametrize("before", [False, True], ids=["after", "before"])
def test_motility_needs_values_of_cells_only(lmp, scenes, before):
    """Types of nodes and faces need no D; a type of cells does, whatever comes first."""
    scene = scenes.single_cell()
    files = {"limp.dcm": LIMP.replace("friction", "D 1e-3\n  friction", 1)}
    fix = "fix motility all dcm/motility limp.dcm {0} {1} {1} {1} seed 1\n"
    good = still_deck(scene, fix.format("hepatoblast", "hepatoblast_cbm"), before)
    lmp(good + RUN, files=files)
    bad = still_deck(scene, fix.format("hepatoblast_cbm", "hepatoblast"), before)
    fails(lmp, bad, "Fix dcm/motility: no value of D for cell type hepatoblast_cbm", files=files)


@pytest.mark.parametrize("before", [False, True], ids=["after", "before"])
@pytest.mark.parametrize("text", ["plane z 1 group some", "pressure 1 over some"])
def test_confine_group_may_come_later(lmp, scenes, text, before):
    """Groups are looked up when a run starts, those deleted since are missed."""
    scene = scenes.single_cell()
    fix, group = f"fix c all dcm/confine {text}\n", "group some type 1\n"
    deck = still_deck(scene, scene.volume() + (fix + group if before else group + fix), False)
    lmp(deck + RUN)
    gone = "Fix dcm/confine: (group|over): there is no group some"
    fails(lmp, deck + "group some delete\n", gone)
