"""fix dcm/signal: time of contact, fate, and the daughters' types and groups; fix_modify retype.
Fix dcm/mark (tests/probe) stands in for a lumen.

Cell 1 is made a cholangiocyte by fix_modify retype and signals to cell 2, a hepatoblast that
touches it. Cells do not move unless a test says so, so that the contact stays."""

import os
from pathlib import Path

import numpy as np
import pytest

from support.bad_decks import fails
from support.cycle_decks import same
from support.data_files import section
from support.parameters import CONTACT, CORTEX, FRICTION, cell_type

HEPATOBLAST, CHOLANGIOCYTE = (1, 2, 3), (5, 6, 7)  # atom types of center, node, face
CYCLE, NEW_CYCLE = 50, 400  # s; the first cell to divide does so in step 50
COLUMNS = "id mol type xu yu zu vx vy vz fx fy fz v_in c_life[1] c_life[2] c_life[3] c_life[4]"
IN, SIGNAL, FATE, CYCLE_TIME, MOTHER = "v_in", *(f"c_life[{k}]" for k in range(1, 5))

FILE = "signal.dcm"
TEXT = (
    cell_type("hepatoblast", **CORTEX, **CONTACT, **FRICTION, D=1e-4, cycle_time=CYCLE)
    + cell_type("cholangiocyte", **CORTEX, **CONTACT, **FRICTION, D=1e-4, cycle_time=NEW_CYCLE)
    + "adhesion hepatoblast hepatoblast 0.1\nadhesion hepatoblast cholangiocyte 0.1\n"
    + "adhesion cholangiocyte cholangiocyte 0.1\n"
)
FILES = {FILE: TEXT}


@pytest.fixture
def lmp(lmp):
    """Runner with the plugin that has fix dcm/mark."""
    folder = Path(os.environ["DCM_BUILD"]) / "extend"
    assert (folder / "dcmplugin.so").exists(), f"no dcmplugin.so in {folder}; use tools/test"
    lmp.env["LAMMPS_PLUGIN_PATH"] = str(folder)
    return lmp


class Tissue:
    """Parts of a deck with the two cells and room for the types of both cell types."""

    def __init__(self, scenes, gap=-0.4):
        self.scenes = scenes
        self.scene = scenes.doublet(gap=gap, boundary="f f f", box=25.0)
        self.scene.parameters = FILE
        hep, chol = "hepatoblast " * 3, "cholangiocyte " * 3
        self.scene.NAMES = f"{hep}NULL {chol}".strip()

    def head(self):
        return (
            self.scene.head()
            .replace("create_box 4", "create_box 7")
            .replace("bond/types 1 dihedral/types 1", "bond/types 2 dihedral/types 2")
        )

    def laws(self):
        scene = self.scene
        cortex = scene.cortex()
        for line in cortex.splitlines():
            if "_coeff 1" in line:
                cortex += line.replace("_coeff 1", "_coeff 2") + "\n"
        return cortex + scene.contact() + "fix cell all dcm/cell\n"

    def cells(self, signal, *, growth="", lumen="", division=True, retype=True, motion=""):
        """Everything but the run."""
        scene = self.scene
        deck = "group cholangio molecule 1\ngroup bile type 5 6 7\n"
        if retype:
            deck = (
                "fix_modify cell retype to 5 6 7 molecule 1\n"
                "group cholangio molecule 1\ngroup bile type 5 6 7\n"
            )
        return (
            deck
            + scene.volume()
            + (f"fix grow all dcm/growth {scene.map} seed 3 {growth}\n" if division else "")
            + ("fix divide all dcm/division seed 7\n" if division else "")
            + (f"fix mark all dcm/mark {lumen}\n" if lumen is not None else "")
            + f"fix signal all dcm/signal from cholangio to 5 6 7 {signal}\n"
            + motion
        )

    def output(self, every=1):
        names = ["counting", "fated", "switched", "longest"]
        return (
            "variable in atom gmask(cholangio)+10*gmask(bile)\n"
            + "compute life all dcm/cell signal fate cycle_time mother\n"
            + self.scenes.dump(COLUMNS, every)
            + self.scenes.thermo([f"{n}=f_signal[{k}]" for k, n in enumerate(names, 1)], every)
            + "timestep 1.0\n"
        )

    def deck(self, signal, steps, *, every=1, **options):
        return (
            self.head()
            + self.laws()
            + self.cells(signal, **options)
            + self.output(every)
            + f"run {steps}\n"
        )


def cells(frame):
    """Molecule -> values of its center."""
    center = np.isin(frame["type"], (HEPATOBLAST[0], CHOLANGIOCYTE[0]))
    return {
        int(frame["mol"][row]): {name: frame[name][row] for name in (*COLUMNS.split(),)}
        for row in np.flatnonzero(center)
    }


def types_of(frame, molecule):
    return sorted({int(t) for t in frame["type"][frame["mol"] == molecule]})


def daughters(frame, mother):
    return [m for m, cell in cells(frame).items() if cell[MOTHER] == mother]


# --- counting -------------------------------------------------------------------------------------


def test_time_counts_to_the_step(lmp, scenes):
    """T of contact are T/dt steps, by the contact at the end of the step before; the first is that
    of setup. The cell that signals counts nothing."""
    result = lmp(Tissue(scenes).deck("area 0.001 time 7", 12), files=FILES)
    for frame, row in zip(result.dump(), result.thermo, strict=True):
        two = cells(frame)
        assert two[2][SIGNAL] == min(frame.step, 7)
        assert two[2][FATE] == (frame.step >= 7)
        assert two[1][SIGNAL] == two[1][FATE] == 0
        assert types_of(frame, 1) == [*CHOLANGIOCYTE] and types_of(frame, 2) == [*HEPATOBLAST]
        counting = 0 < frame.step < 7
        assert [row["v_counting"], row["v_fated"]] == [counting, frame.step >= 7]
        assert row["v_longest"] == (frame.step if counting else 0)


def test_every(lmp, scenes):
    """Every third step the contact counts for three."""
    result = lmp(Tissue(scenes).deck("area 0.001 time 7 every 3", 12), files=FILES)
    for frame in result.dump():
        assert cells(frame)[2][SIGNAL] == min(3 * ((frame.step + 2) // 3), 9)
        assert cells(frame)[2][FATE] == (frame.step >= 7)


def test_area(lmp, scenes):
    """Below and above the part of the cell's area that is in contact, by compute dcm/cell."""
    tissue = Tissue(scenes)
    look = "compute part all dcm/cell contact_area area\n"
    plain = tissue.deck("area 0.001 time 7", 1) + look + scenes.dump(
        "id mol type c_part[1] c_part[2]", 1, file="part.txt"
    ) + "run 1\n"  # fmt: skip
    frame = lmp(plain, files=FILES).dump("part.txt")[0]
    row = np.flatnonzero((frame["type"] == 1) & (frame["mol"] == 2))[0]
    share = frame["c_part[1]"][row] / frame["c_part[2]"][row]
    assert 0.01 < share < 0.2
    for factor, counts in ((0.999, 1), (1.001, 0)):
        deck = tissue.deck(f"area {factor * share} time 7", 3)
        assert cells(lmp(deck, files=FILES).dump()[-1])[2][SIGNAL] == 3 * counts


def test_no_contact_no_signal(lmp, scenes):
    result = lmp(Tissue(scenes, gap=6.0).deck("area 0 time 0", 5), files=FILES)
    assert cells(result.dump()[-1])[2][FATE] == 0


@pytest.mark.parametrize("lapse", ["reset", "hold"])
def test_lapse(lmp, scenes, lapse):
    """A lumen in steps 3 to 8 and from 12 on."""
    tissue = Tissue(scenes)
    deck = tissue.deck(f"area 0.001 time 10 lapse {lapse}", 8, lumen="steps 3 8")
    deck += "fix mark all dcm/mark steps 12 99\nrun 18\n"
    result = lmp(deck, files=FILES)
    found = {frame.step: cells(frame)[2][SIGNAL] for frame in result.dump()}
    for step in range(2, 9):
        assert found[step] == step - 2
    kept = 6 if lapse == "hold" else 0
    assert found[10] == kept
    for step in range(12, 27):
        assert found[step] == min(kept + step - 11, 10)  # until its fate is decided


def test_no_lumen(lmp, scenes):
    """It counts at a lumen only, unless told otherwise."""
    tissue = Tissue(scenes)
    away = lmp(tissue.deck("area 0.001 time 7", 5, lumen="area 0"), files=FILES)
    assert cells(away.dump()[-1])[2][SIGNAL] == 0
    never = lmp(tissue.deck("area 0.001 time 7 lumen no", 5, lumen=None), files=FILES)
    assert cells(never.dump()[-1])[2][SIGNAL] == 5


# --- division -------------------------------------------------------------------------------------


def test_daughters_of_a_fated_cell(lmp, scenes):
    """Types, groups and cycle time of both; those of other cells stay. They begin to count anew."""
    result = lmp(Tissue(scenes).deck("area 0.001 time 7", CYCLE + 3), files=FILES)
    before, after = result.dump()[CYCLE - 1], result.dump()[-1]
    assert sorted(cells(before)) == [1, 2] and cells(before)[2][CYCLE_TIME] == CYCLE
    assert sorted(cells(after)) == [1, 3, 4] and daughters(after, 2) == [3, 4]
    for molecule in (3, 4):
        cell = cells(after)[molecule]
        assert cell[CYCLE_TIME] == NEW_CYCLE
        assert cell[SIGNAL] == cell[FATE] == 0
        assert types_of(after, molecule) == [*CHOLANGIOCYTE]
    # in group cholangio, that signals, and in bile, like all others of the type
    assert set(after[IN]) == {11} and set(before[IN][before["mol"] == 2]) == {0}
    assert cells(after)[1][CYCLE_TIME] == NEW_CYCLE
    assert result.thermo[CYCLE - 1]["v_switched"] == 0
    assert result.thermo[-1]["v_switched"] == 1


@pytest.mark.parametrize("options", ["time 60", "time inf", "time 7 lumen no area 0.9"])
def test_daughters_of_a_cell_without_fate(lmp, scenes, options):
    """Not long enough, never, and never enough contact: hepatoblasts, which count from zero."""
    area = "" if "area" in options else "area 0.001"
    result = lmp(Tissue(scenes).deck(f"{area} {options}", CYCLE + 3), files=FILES)
    after = result.dump()[-1]
    for molecule in daughters(after, 2):
        assert types_of(after, molecule) == [*HEPATOBLAST]
        assert cells(after)[molecule][CYCLE_TIME] == CYCLE
        assert cells(after)[molecule][SIGNAL] <= 3
        assert set(after[IN][after["mol"] == molecule]) == {0}
    assert result.thermo[-1]["v_switched"] == 0


def test_time_0(lmp, scenes):
    """The first contact, then the next division: even when it comes and goes in one step."""
    result = lmp(
        Tissue(scenes).deck("area 0.001 time 0", CYCLE + 1, lumen="steps 5 5"), files=FILES
    )
    frames = result.dump()
    assert [cells(frame)[2][FATE] for frame in frames[3:7]] == [0, 0, 1, 1]
    assert types_of(frames[CYCLE - 1], 2) == [*HEPATOBLAST]
    assert all(types_of(frames[-1], m) == [*CHOLANGIOCYTE] for m in daughters(frames[-1], 2))


def test_fate_in_the_step_of_the_division(lmp, scenes):
    for time, types in ((CYCLE, CHOLANGIOCYTE), (CYCLE + 1, HEPATOBLAST)):
        result = lmp(Tissue(scenes).deck(f"area 0.001 time {time}", CYCLE + 1), files=FILES)
        last = result.dump()[-1]
        assert all(types_of(last, m) == [*types] for m in daughters(last, 2))


def test_join_leave_and_bond_types(lmp, scenes):
    tissue = Tissue(scenes)
    deck = tissue.deck("area 0.001 time 7 leave left join right", CYCLE + 1)
    deck = deck.replace("to 5 6 7 area", "to 5 6 7 2 2 area").replace(
        "fix grow", "group left molecule 1 2\ngroup right molecule 1\nfix grow", 1
    )
    deck = deck.replace("variable in atom ", "variable in atom 100*gmask(left)+1000*gmask(right)+")
    result = lmp(deck + "write_data out.data\n", files=FILES)
    last = result.dump()[-1]
    for molecule in daughters(last, 2):
        assert set(last[IN][last["mol"] == molecule]) == {1011}
    assert set(last[IN][last["mol"] == 1]) == {1111}
    text = (result.path / "out.data").read_text()
    mol = dict(zip(last["id"].astype(int), last["mol"].astype(int), strict=True))
    for name in ("Bonds", "Dihedrals"):
        found = {(mol[int(row.split()[2])], int(row.split()[1])) for row in section(text, name)}
        assert found == {(1, 1), (3, 2), (4, 2)}


def test_regions_of_daughters(lmp, scenes):
    """As of any division: from the mother's surface, lateral at the new plane."""
    tissue = Tissue(scenes)
    deck = tissue.deck("area 0.001 time 7", CYCLE + 1, lumen="band 2 -2 2")
    look = "compute region all property/atom region\n"
    look += scenes.dump("id mol type c_region", CYCLE + 1, file="region.txt")
    deck = deck.replace(f"run {CYCLE + 1}", look + f"run {CYCLE + 1}")
    frame = lmp(deck, files=FILES).dump("region.txt")[-1]
    for molecule in (3, 4):
        face = (frame["mol"] == molecule) & (frame["type"] == CHOLANGIOCYTE[2])
        assert face.sum() == 80 and set(frame["c_region"][face]) == {0.0, 2.0}


def test_the_new_cells_signal_on(lmp, scenes):
    """Cell 2 switches; its daughters are in the group and count for nothing else."""
    result = lmp(Tissue(scenes).deck("area 0.001 time 7", CYCLE + 3), files=FILES)
    assert result.thermo[-1]["v_counting"] == result.thermo[-1]["v_fated"] == 0


@pytest.mark.parametrize("np_", [1, 2])
def test_types_that_are_empty_at_first(lmp, scenes, np_):
    """Cells of the old type signal; the first cells of the new type have contacts, pressure and
    friction like all others."""
    tissue = Tissue(scenes)
    deck = tissue.deck("area 0.001 time 7", CYCLE + 10, retype=False, motion=tissue.scene.motion())
    deck += "compute more all dcm/cell contact_area pressure\n"
    deck += scenes.dump("id mol type c_more[1] c_more[2]", 1, file="more.txt") + "run 0\n"
    result = lmp(deck, np=np_, files=FILES)
    last, more = result.dump()[-1], result.dump("more.txt")[-1]
    switched = [m for m in cells(last) if types_of(last, m) == [*CHOLANGIOCYTE]]
    assert switched == daughters(last, 2) and len(switched) == 2
    for molecule in switched:
        mine = (last["mol"] == molecule) & (last["type"] == CHOLANGIOCYTE[0])
        assert more["c_more[1]"][mine] > 1.0 and more["c_more[2]"][mine] > 0.0
        node = (last["mol"] == molecule) & (last["type"] == CHOLANGIOCYTE[1])
        assert 1e-5 < np.abs(last.v[node]).max() < 0.1


def test_new_types_not_in_growth(lmp, scenes):
    """A type that fix dcm/growth does not name does not grow: quiescent daughters."""
    tissue = Tissue(scenes)
    deck = tissue.deck("area 0.001 time 7", CYCLE + 5)
    names = f"dcm/growth {tissue.scene.map}"
    deck = deck.replace(
        names, names.replace("cholangiocyte " * 2 + "cholangiocyte", "NULL NULL NULL")
    )
    deck += "variable n equal f_grow\nprint 'growing $n'\n"
    result = lmp(deck, files=FILES)
    assert "growing 0" in result.log
    assert all(cells(result.dump()[-1])[m][CYCLE_TIME] == 0 for m in (1, 3, 4))


def test_center_based_cells_do_not_switch(lmp, scenes):
    tissue = Tissue(scenes)
    tissue.scene.cells[1] = "create_cells single cbm cbm 5.8 0 0 6 cbm cbm 4"
    tissue.scene.NAMES = tissue.scene.NAMES.replace("NULL", "hepatoblast")
    deck = tissue.deck("area 0 time 0", 60).replace("neighbor 0.6", "neighbor 2.5")
    result = lmp(
        deck.replace("dcm/division seed 7", "dcm/division seed 7 cbm soften 50"), files=FILES
    )
    last = result.dump()[-1]
    assert sorted(last["type"][last["mol"] > 1].astype(int)) == [4, 4]
    assert result.thermo[-1]["v_switched"] == 0


# --- ranks, restart -------------------------------------------------------------------------------


def moving(scenes, steps):
    tissue = Tissue(scenes)
    motion = tissue.scene.motility(options="D 1e-3 bias 1 0.7 0.3 8.0") + tissue.scene.motion()
    deck = tissue.deck("area 0.001 time 30", steps, every=10, motion=motion)
    cut = deck.index("pair_coeff")
    return deck[:cut], deck[cut:]


def test_ranks_agree(lmp, scenes):
    deck = "".join(moving(scenes, 70))
    one = lmp(deck, files=FILES)
    assert one.thermo[-1]["v_switched"] == 1
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_, files=FILES)
        assert other.thermo == one.thermo
        for a, b in zip(one.dump(), other.dump(), strict=True):
            for name in ("id", "mol", "type", IN, SIGNAL, FATE, CYCLE_TIME):
                assert (a[name] == b[name]).all(), (name, a.step)
            assert np.abs(a.x - b.x).max() < 1e-8, a.step


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_is_bit_for_bit(lmp, scenes, np_):
    """A run that goes on while the time is counted, and one after the fate is decided."""
    start, rest = moving(scenes, 70)
    rest = rest.replace("timestep", "restart 20 r.*\ntimestep")
    start = "processors * 1 1\n" + start
    first = lmp(start + rest, np=np_, files=FILES)
    groups = "fix_modify cell retype to 5 6 7 molecule 1\n"
    groups += "group cholangio molecule 1\ngroup bile type 5 6 7\n"
    assert groups in rest
    for step in (20, 40):
        again = lmp(
            f"processors * 1 1\nread_restart r.{step}\n"
            + rest.replace(groups, "").replace("run 70", f"run {70 - step}"),
            np=np_,
            files={**FILES, f"r.{step}": first.path / f"r.{step}"},
        )
        expected, found = first.dump()[step // 10 :], again.dump()
        assert len(found) == (70 - step) // 10 + 1
        for a, b in zip(expected, found, strict=True):
            same(a, b, COLUMNS)
        assert again.thermo == first.thermo[step // 10 :]
    assert cells(first.dump()[2])[2][SIGNAL] == 20 and cells(first.dump()[4])[2][FATE] == 1


# --- fix_modify retype ----------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2, 3, 4])
def test_retype_whole_cells(lmp, scenes, np_):
    """All atoms of a cell take the type of their kind, groups and bond types; others stay."""
    tissue = Tissue(scenes)
    deck = tissue.head() + tissue.laws() + tissue.scene.volume()
    deck += "group right molecule 2\ngroup other id 1\n"
    deck += "fix_modify cell retype to 5 6 7 2 2 group right join other leave right\n"
    deck += "variable in atom gmask(right)+10*gmask(other)\n" + scenes.dump("id mol type v_in")
    deck += "run 0\nwrite_data out.data\n"
    result = lmp(deck, np=np_, files=FILES)
    frame = result.dump()[0]
    assert types_of(frame, 1) == [*HEPATOBLAST] and types_of(frame, 2) == [*CHOLANGIOCYTE]
    assert [(frame["type"] == t).sum() for t in CHOLANGIOCYTE] == [1, 42, 80]
    assert set(frame[IN][frame["mol"] == 2]) == {10}
    assert (frame[IN][frame["mol"] == 1] > 0).sum() == 1
    text = (result.path / "out.data").read_text()
    kinds = [int(line.split()[1]) for line in section(text, "Bonds")]
    assert kinds.count(1) == kinds.count(2) == 120


def test_retype_between_runs(lmp, scenes):
    """Growth takes the cycle time of the new type, at the same place in the cycle."""
    tissue = Tissue(scenes)
    deck = tissue.deck("time inf", 20, every=20, retype=False)
    deck += "fix_modify cell retype to 5 6 7 molecule 2\nrun 20\n"
    deck += "compute progress all dcm/cell progress\n"
    deck += scenes.dump("id mol type c_progress", 1, file="progress.txt") + "run 0\n"
    result = lmp(deck, files=FILES)
    last = cells(result.dump()[-1])
    assert (last[1][CYCLE_TIME], last[2][CYCLE_TIME]) == (CYCLE, NEW_CYCLE)
    frame = result.dump("progress.txt")[-1]
    center = np.flatnonzero(frame["type"] == CHOLANGIOCYTE[0])[0]
    assert frame["c_progress"][center] == pytest.approx(20 / CYCLE + 20 / NEW_CYCLE, rel=1e-12)


RETYPE = "Fix_modify retype"
RETYPE_CASES = {
    "no cells": ("to 5 6 7", f"{RETYPE}: name the cells: molecule M or group GROUP"),
    "no types": ("molecule 1", f"{RETYPE}: keyword to is missing"),
    "short": ("to 5 6", f"{RETYPE}: keyword to needs 3 values, got 2"),
    "type": ("to 5 6 9 molecule 1", f"{RETYPE}: to is 9, must be a type of 1 to 7"),
    "same": ("to 5 5 7 molecule 1", f"{RETYPE}: atom type 5 is to be the type of centers and"),
    "kind": ("to 5 3 7 molecule 1", f"{RETYPE}: atom type 3 is to be the type of nodes but"),
    "molecule": ("to 5 6 7 molecule 9", f"{RETYPE}: there is no deformable cell 9"),
    "group": ("to 5 6 7 group x", f"{RETYPE}: there is no group x"),
    "empty": ("to 5 6 7 group none", f"{RETYPE}: no center of a deformable cell is in group none"),
    "join": ("to 5 6 7 molecule 1 join x", f"{RETYPE}: there is no group x"),
    "all": ("to 5 6 7 molecule 1 leave all", f"{RETYPE}: every atom is in group all"),
    "both": ("to 5 6 7 molecule 1 join one leave one", f"{RETYPE}: cells cannot join and leave"),
    "keyword": ("to 5 6 7 x 1", f"{RETYPE}: to is 'x', expected a number"),
}  # fmt: skip


@pytest.mark.parametrize("case", RETYPE_CASES)
def test_bad_retype(lmp, scenes, case):
    text, pattern = RETYPE_CASES[case]
    tissue = Tissue(scenes)
    deck = tissue.head() + tissue.laws() + tissue.scene.volume()
    deck += f"group none molecule 77\ngroup one molecule 1\nfix_modify cell retype {text}\n"
    fails(lmp, deck, pattern, files=FILES)


# --- bad input ------------------------------------------------------------------------------------

STYLE = "Fix dcm/signal"
USUAL = "from one to 5 6 7 time 10"
CASES = {
    "area 1.1": (f"{USUAL} area 1.1", "area is 1.1, must be a part of the cell's area, 0 to 1"),
    "area -1": (f"{USUAL} area -1", "area is -1.*zero or positive"),
    "time -1": (USUAL.replace("10", "-1"), "time is -1.*zero or positive"),
    "time text": (USUAL.replace("10", "never"), "time is 'never', expected a number"),
    "no time": ("from one to 5 6 7", "keyword time is missing"),
    "no from": ("to 5 6 7 time 1", "keyword from is missing"),
    "no to": ("from one time 1", "keyword to is missing"),
    "no group": ("from x to 5 6 7 time 1", "there is no group x"),
    "group all": ("from all to 5 6 7 time 1", "every atom is in group all"),
    "dynamic": ("from some to 5 6 7 time 1", "group some is dynamic.*use a static group"),
    "to sphere": ("from one to 4 6 7 time 1", "atom type 4 is .* but holds spheres"),
    "to face": ("from one to 5 3 7 time 1", "atom type 3 is to be the type of nodes but"),
    "to same": ("from one to 5 6 6 time 1", "atom type 6 is to be the type of nodes and of faces"),
    "to bond": ("from one to 5 6 7 9 1 time 1", "to is 9, must be a type of 1 to 2"),
    "lumen": (f"{USUAL} lumen maybe", "lumen must be no or yes, not maybe"),
    "lapse": (f"{USUAL} lapse keep", "lapse must be reset or hold, not keep"),
    "every": (f"{USUAL} every 0", "every is 0.*positive whole number"),
    "keyword": (f"{USUAL} x 1", "unknown keyword x; known: to join leave from area time lumen"),
    "no lumen": (USUAL, "nothing marks the faces at a lumen.*fix dcm/osmosis.*lumen no"),
    "twice": (f"{USUAL} lumen no\nfix b all dcm/signal {USUAL}",
              "cells have a value signal already, of another style"),
}  # fmt: skip


def bad_deck(tissue, text, *, laws=None, after=""):
    scene = tissue.scene
    return (
        tissue.head()
        + (laws or tissue.laws())
        + scene.volume()
        + "group one molecule 1\nvariable any atom 1\ngroup some dynamic all var any every 1\n"
        + f"fix a all dcm/signal {text}\n"
        + scene.motion()
        + after
    )


@pytest.mark.parametrize("case", CASES)
def test_bad(lmp, scenes, case):
    text, pattern = CASES[case]
    tissue = Tissue(scenes)
    if case == "to sphere":
        tissue.scene.cbm(0.0, 18.0, 0.0, 5.0)
        tissue.scene.NAMES = tissue.scene.NAMES.replace("NULL", "hepatoblast")
    fails(lmp, bad_deck(tissue, text), f"{STYLE}: {pattern}", files=FILES)


def test_bad_surroundings(lmp, scenes):
    tissue = Tissue(scenes)
    usual = f"{USUAL} lumen no"
    laws = tissue.laws().replace("cholangiocyte cholangiocyte cholangiocyte", "NULL NULL NULL")
    fails(lmp, bad_deck(tissue, usual, laws=laws),
          f"{STYLE}: the new faces' atom type 7 has no cell type", files=FILES)  # fmt: skip
    cortex = tissue.laws().split("pair_style")[0] + "comm_modify cutoff 12\nfix cell all dcm/cell\n"
    fails(lmp, bad_deck(tissue, usual, laws=cortex),
          f"{STYLE}: nothing measures contact .*pair_style dcm/contact", files=FILES)  # fmt: skip
    fails(lmp, bad_deck(tissue, usual, after=f"fix b all dcm/signal {usual}\nunfix a\n"),
          f"{STYLE}: fix b stands after fix motion.*before fix motion", files=FILES)  # fmt: skip
    grow = f"fix grow all dcm/growth {tissue.scene.map} seed 3\n"
    fails(lmp, bad_deck(tissue, usual + "\n" + grow.strip()),
          f"{STYLE}: fix a stands before fix grow .dcm/growth.", files=FILES)  # fmt: skip


def test_without_division(lmp, scenes):
    """Nothing would ever switch: one warning."""
    deck = Tissue(scenes).deck("time 5", 1, division=False)
    deck = deck.replace(" cycle_time mother", " birth mother")
    result = lmp(deck, files=FILES)
    assert result.out.count("there is no fix dcm/division: all keep theirs") == 1


# --- with the styles that give regions and marks --------------------------------------------------


def test_with_polarity_and_osmosis(lmp, scenes):
    """Steps in which fix dcm/osmosis has marked faces of the cell count; its daughters switch."""
    tissue = Tissue(scenes)
    lumen = (
        "fix polar all dcm/polarity seed 3 init toward 0 0 0 every 1\n"
        "fix osm all dcm/osmosis pressure 0.05 marks flood secrete cholangio "
        "starter 0 0 0 8 1e9 every 4\n"
    )
    deck = tissue.deck("area 0.001 time 20", CYCLE + 5, lumen=None, motion=tissue.scene.motion())
    deck = deck.replace("fix signal", lumen + "fix signal")
    look = "compute marked all dcm/cell marked_area\n"
    look += scenes.dump("id mol type c_marked", 1, file="marked.txt")
    deck = deck.replace("timestep", look + "timestep")
    result = lmp(deck, files=FILES)
    count = 0
    for frame, marks in zip(result.dump(), result.dump("marked.txt"), strict=True):
        if frame.step >= CYCLE:
            break
        row = np.flatnonzero((marks["mol"] == 2) & (marks["type"] == 1))[0]
        marked = marks["c_marked"][row] > 0.0
        if frame.step > 0:
            count = min(count + 1, 20) if marked or count == 20 else 0
        assert cells(frame)[2][SIGNAL] == count
    assert count == 20
    last = result.dump()[-1]
    assert all(types_of(last, m) == [*CHOLANGIOCYTE] for m in daughters(last, 2))
