"""Bad input of the cell cycle's fixes: one error that names style, value and remedy."""

import pytest

from support.bad_decks import fails, whole
from support.cycle_decks import counting

GROWTH = "fix growth all dcm/growth {map} "
GOOD = GROWTH + "seed 1 cycle_time 1000\n"
DIVISION = GOOD + "fix division all dcm/division "
DEATH = GOOD + "fix death all dcm/death "
CONVERT = GOOD + "fix convert all dcm/convert "
TYPES = CONVERT + "dcm 1 2 3 1 1 cbm 4 "
REGION = "region r block EDGE EDGE EDGE EDGE EDGE EDGE\n"

CASES = {
    # growth
    "growth seed": (GROWTH, "Fix dcm/growth: keyword seed is missing; give a positive"),
    "growth seed 0": (GROWTH + "seed 0", "Fix dcm/growth: seed is 0.*positive"),
    "growth seed 1.5": (GROWTH + "seed 1.5", "Fix dcm/growth: seed is 1.5.*whole"),
    "growth seed text": (GROWTH + "seed x", "Fix dcm/growth: seed is 'x'.*number"),
    "growth keyword": (GROWTH + "seed 1 x 1", "Fix dcm/growth: unknown keyword x; known"),
    "growth short": (GROWTH + "seed 1 rounding 0.1", "Fix dcm/growth: keyword rounding needs 2"),
    "growth names": ("fix growth all dcm/growth bile_duct.dcm", "Fix dcm/growth: expected"),
    "growth file": ("fix g all dcm/growth none.dcm a a a a seed 1", "Fix dcm/growth.*none.dcm"),
    "growth type": ("fix g all dcm/growth bile_duct.dcm a a a a seed 1",
                    "Fix dcm/growth.*cell type a"),
    "growth twice": (GOOD + GOOD.replace("fix growth", "fix again"),
                     "fix dcm/growth already .ID growth.*at most one"),
    "growth law": (GROWTH + "seed 1 law x", "Fix dcm/growth: law must be linear or exponential"),
    "growth until": (GROWTH + "seed 1 until x", "Fix dcm/growth: until must be rest or volume"),
    "growth age": (GROWTH + "seed 1 age x", "Fix dcm/growth: age must be zero or random, not x"),
    "growth cycle": (GROWTH + "seed 1 cycle_time -1", "Fix dcm/growth: cycle_time.*-1"),
    "growth cycle nan": (GROWTH + "seed 1 cycle_time nan", "Fix dcm/growth: cycle_time is 'nan'"),
    "growth cycle sd": (GROWTH + "seed 1 cycle_time 9 cycle_sd -1", "Fix dcm/growth: cycle_sd.*-1"),
    "growth half": (GROWTH + "seed 1 compression 0 1", "Fix dcm/growth: compression is 0.*pos"),
    "growth exponent": (GROWTH + "seed 1 compression 1 -2", "Fix dcm/growth: compression is -2"),
    "growth rounding": (GROWTH + "seed 1 rounding 0.6 0.9", "Fix dcm/growth: rounding is 0.6 0.9"),
    "growth factor": (GROWTH + "seed 1 rounding 0.1 1.1", "rounding is 0.1 1.1.*0.5 to 1"),
    "growth newborn": (GROWTH + "seed 1 newborn 0", "Fix dcm/growth: newborn is 0.*positive"),
    "growth newborn size": (GROWTH + "seed 1 cycle_time 9 newborn 100",
                            "Fix dcm/growth: cell 1 has rest volume .* newborn 100"),
    "fraction": (GROWTH + "seed 1 proliferating hepatoblast 1.5",
                 "Fix dcm/growth: proliferating fraction of hepatoblast is 1.5, must be 0 to 1"),
    "fraction negative": (GROWTH + "seed 1 proliferating hepatoblast -0.5",
                          "proliferating is -0.5"),
    "fraction type": (GROWTH + "seed 1 proliferating liver 0.5",
                      "Fix dcm/growth: proliferating: no atom type has the cell type liver"),
    # division
    "division seed": (DIVISION, "Fix dcm/division: keyword seed is missing; give a positive"),
    "division keyword": (DIVISION + "x 1", "Fix dcm/division: unknown keyword x; known"),
    "division short": (DIVISION + "seed", "Fix dcm/division: keyword seed needs a value"),
    "division plane": (DIVISION + "seed 1 plane x",
                       "Fix dcm/division: plane must be random, long.*not x"),
    "division given": (DIVISION + "seed 1 plane given 0 0 0", "plane given 0 0 0.*give the normal"),
    "division variable": (DIVISION + "seed 1 plane variable x y z", "Fix dcm/division.*v_"),
    "division no variable": (DIVISION + "seed 1 plane variable v_x v_x v_x",
                             "Fix dcm/division.*variable.*x"),
    "division cbm": (DIVISION + "seed 1 cbm x 1",
                     "Fix dcm/division: cbm must be soften T or trunc"),
    "division soften": (DIVISION + "seed 1 cbm soften 0",
                        "Fix dcm/division: soften is 0.*positive"),
    "division tolerance": (DIVISION + "seed 1 tolerance 1", "Fix dcm/division: tolerance is 1"),
    "division maxiter": (DIVISION + "seed 1 maxiter 0", "Fix dcm/division: maxiter is 0"),
    "division twice": (DIVISION + "seed 1\nfix again all dcm/division seed 1",
                       "fix dcm/division already .ID division.*at most one"),
    "division log": (DIVISION + "seed 1 log none/x.log",
                     "Fix dcm/division: cannot open log none/x"),
    # death
    "death nobody": (DEATH, "Fix dcm/death: who dies. give all, region, age, variable or rate"),
    "death keyword": (DEATH + "x 1", "Fix dcm/death: unknown keyword x; known"),
    "death short": (DEATH + "age", "Fix dcm/death: keyword age needs a value"),
    "death region": (DEATH + "region none", "Fix dcm/death: there is no region none"),
    "death variable": (DEATH + "variable x", "Fix dcm/death.*v_"),
    "death no variable": (DEATH + "variable v_x", "Fix dcm/death.*variable.*x"),
    "death equal variable": ("variable x equal 1\n" + DEATH + "variable v_x", "Fix dcm/death.*x"),
    "death age": (DEATH + "age -1", "Fix dcm/death: age is -1"),
    "death rate": (DEATH + "rate 1e-3", "Fix dcm/death: rate needs keyword seed"),
    "death rate large": (DEATH + "rate 0.01 seed 1 every 20",
                         "Fix dcm/death: rate 0.01 means 0.2 deaths.*reduce rate or every"),
    "death rate text": (DEATH + "rate x seed 1", "Fix dcm/death: rate is 'x'.*number"),
    "death shrink": (DEATH + "all shrink 0", "Fix dcm/death: shrink is 0.*positive"),
    "death every": (DEATH + "all every 1.5", "Fix dcm/death: every is 1.5.*whole"),
    "death log": (DEATH + "age 9e9 log none/x.log", "Fix dcm/death: cannot open log none/x.log"),
    # convert
    "convert types": (CONVERT, "Fix dcm/convert: give the types of both forms: dcm Tcenter"),
    "convert type 9": (CONVERT + "dcm 1 2 9 1 1 cbm 4", "Fix dcm/convert: dcm is 9.*1 to 4"),
    "convert type 0": (CONVERT + "dcm 1 2 3 1 1 cbm 0", "Fix dcm/convert: cbm is 0"),
    "convert bond type": (CONVERT + "dcm 1 2 3 2 1 cbm 4", "Fix dcm/convert: dcm is 2.*1 to 1"),
    "convert short": (CONVERT + "dcm 1 2 3", "Fix dcm/convert: keyword dcm needs 5 values"),
    "convert no rule": (TYPES, "Fix dcm/convert: give one rule of region, near, .*strain, not 0"),
    "convert two rules": (REGION + TYPES + "region r r near all 1 2", "give one rule.* not 2"),
    "convert keyword": (TYPES + "x 1", "Fix dcm/convert: unknown keyword x; known"),
    "convert region": (TYPES + "region none none", "Fix dcm/convert: there is no region none"),
    "convert group": (TYPES + "near none 1 2", "Fix dcm/convert: there is no group none"),
    "convert near": (TYPES + "near all 3 2", "near: the second distance, 2, is below the first, 3"),
    "convert variable": (TYPES + "variable v_x", "Fix dcm/convert.*variable.*x"),
    "convert lumen short": (TYPES + "lumen osm 1", "Fix dcm/convert: keyword lumen needs 3 values"),
    "convert lumen": (TYPES + "lumen osm 9 8", "lumen: the second distance, 8, is below the f.* 9"),
    "convert lumen fix": (TYPES + "lumen osm 8 9", "lumen: there is no fix osm; name the fix dcm"),
    "convert lumen volume": (TYPES + "lumen volume 8 9",
                             "lumen: fix volume .dcm/volume. marks no faces.*dcm/osmosis"),
    "convert lumen zero": (TYPES + "lumen osm 0 9", "Fix dcm/convert: lumen is 0.*positive"),
    "convert pressure": (TYPES + "pressure 0.1 0.2",
                         "pressure: the second number, 0.2, .* is above the first, 0.1"),
    "convert pressure zero": (TYPES + "pressure 0 -1", "Fix dcm/convert: pressure is 0.*positive"),
    "convert pressure nan": (TYPES + "pressure 0.1 nan", "Fix dcm/convert: pressure is 'nan'"),
    "convert strain": (TYPES + "strain 0.1 0.2", "strain: the second number, 0.2, .*first, 0.1"),
    "convert strain deep": (TYPES + "strain 0.3 0.2", "first number, 0.3, must be below 0.3: sph"),
    "convert strain short": (TYPES + "strain 0.1", "Fix dcm/convert: keyword strain needs 2 val"),
    "convert measure and place": (TYPES + "strain 0.1 0 near all 1 2", "give one rule.*not 2"),
    "convert hold": (TYPES + "near all 1 2 hold -1", "Fix dcm/convert: hold is -1"),
    "convert mesh": (TYPES + "near all 1 2 mesh file 2", "mesh must be icosphere LEVEL, not file"),
    "convert level": (TYPES + "near all 1 2 mesh icosphere 9", "mesh is 9.*1 to 5"),
    "convert rest": (TYPES + "near all 1 2 rest 0", "Fix dcm/convert: rest is 0.*positive"),
    "convert every": (TYPES + "near all 1 2 every 0", "Fix dcm/convert: every is 0"),
    # without growth
    "division alone": ("fix d all dcm/division seed 1",
                       "Fix dcm/division: nothing in the deck makes cells ready.*dcm/growth"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_bad(lmp, scenes, case):
    text, *patterns = CASES[case]
    scene = scenes.doublet()
    contact = scene.contact().replace("neighbor 0.6", "neighbor 0.8")  # spheres that come late
    extra = text.format(map=scene.map) + "\n"
    fails(lmp, whole(scene, contact=contact, extra=extra), *patterns)


@pytest.mark.parametrize("fix", ["division seed 1", "death age 9", "convert {types}"])
def test_before_the_pair_style(lmp, scenes, fix):
    """Contact history has to leave its local indices before cells come and go."""
    scene = scenes.hybrid()
    fix = fix.format(types="dcm 1 2 3 1 1 cbm 4 near all 1 2")
    text = "fix cell all dcm/cell\n" + GOOD.format(map=scene.map) + f"fix one all dcm/{fix}\n"
    deck = whole(scene, cell="", cortex=text + scene.cortex())
    fails(lmp, deck, f"Fix dcm/{fix.split()[0]}: define pair_style dcm/contact before this fix")


@pytest.mark.parametrize("np_", [1, 2])
def test_slots_for_spheres_only(lmp, scenes, np_):
    """Spheres are to become deformable, but atoms have no room for edges."""
    scene = scenes.Scene()
    deck = counting(8, "cycle_time 100") + "fix cell all dcm/cell\n"
    deck += scene.cortex() + scene.volume()
    deck += "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 near all 1 2 mesh icosphere 1\n"
    fails(lmp, deck, "Fix dcm/convert: a node needs [0-9]+ bond", "extra/bond/per/atom", np=np_)


def test_slots_after_read_data(lmp, scenes):
    """A data file of spheres that was read without room for the edges."""
    scene = scenes.Scene(20.0, "p p p")
    scene.cbm(0.0, 0.0, 0.0, 5.0)
    data = lmp(scene.head() + "write_data x.data nofix nocoeff\n").path / "x.data"
    deck = (
        "units lj\natom_style dcm\nnewton on\nboundary p p p\nread_data x.data\n"
        + scene.cortex()
        + "comm_modify cutoff 10\nfix cell all dcm/cell\n"
        + scene.volume()
        + GOOD.format(map=scene.map)
        + "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 near all 1 2\n"
    )
    fails(lmp, deck, "Fix dcm/convert: a node needs", files={"x.data": data})


@pytest.mark.parametrize("rule", ["strain 0.1 0.05", "pressure 0.1 0.05"])
def test_convert_after_motion(lmp, scenes, rule):
    """What cells are measured by has to be that of the last forces."""
    scene = scenes.hybrid()
    late = f"fix late all dcm/convert dcm 1 2 3 1 1 cbm 4 {rule}\n"
    deck = whole(scene, motion=scene.motion() + late)
    fails(lmp, deck, f"Fix dcm/convert: {rule.split()[0]}: fix late stands after fix motion")


def test_convert_by_forces_without_contact(lmp, scenes):
    scene = scenes.hybrid()
    rule = "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 pressure 0.1 0.05\n"
    deck = whole(scene, contact="comm_modify cutoff 14\n", extra=rule)
    fails(lmp, deck, "Fix dcm/convert: pressure needs pair_style dcm/contact, which knows the for")


def test_convert_without_fix_cell(lmp, scenes):
    deck = counting(8, "cycle_time 100").replace(
        "dihedral/types 1", "dihedral/types 1 extra/bond/per/atom 8 extra/dihedral/per/atom 8"
    )
    deck += "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 near all 1 2\n"
    fails(lmp, deck, "Fix dcm/convert needs a fix dcm/cell; add 'fix cell all dcm/cell'")


def test_two_cells_with_one_molecule(lmp, scenes):
    deck = counting(8, "cycle_time 100") + "set atom 3 mol 2\n"
    fails(lmp, deck, "Fix dcm/growth: two cells have molecule ID 2; every cell needs")


def test_death_without_fix_cell_for_spheres_is_fine(lmp):
    result = lmp(counting(8, "cycle_time 100") + "fix death all dcm/death age 5\nrun 6\n")
    assert "Loop time" in result.log
