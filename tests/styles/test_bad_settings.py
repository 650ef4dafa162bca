"""Settings of LAMMPS, groups, atoms and lengths that styles cannot work with: one error before the
first step that names value and remedy."""

import re

import pytest

from support.bad_decks import fails, whole

# --- settings -------------------------------------------------------------------------------------

SETTINGS = {
    "delay": (
        "neigh_modify every 1 delay 100 check yes\n",
        "neigh_modify delay 100 every 1",
        "'neigh_modify delay 0 every 1 check yes'",
    ),
    "every": ("neigh_modify every 10 delay 0 check yes\n", "neigh_modify delay 0 every 10"),
    "every, no check": ("neigh_modify every 20 delay 0 check no\n", "delay 0 every 20"),
    "delay 10": ("neigh_modify every 5 delay 10\n", "neigh_modify delay 10 every 5"),
    "once": ("neigh_modify once yes\n", "remove 'neigh_modify once yes'"),
    "exclude": (
        "neigh_modify exclude molecule/inter all\n",
        "exclude molecule/inter all would",
        "exclude none",
    ),
    "include": ("group some molecule 1\nneigh_modify include some\n", "neigh_modify include some"),
}


@pytest.mark.parametrize("case", SETTINGS)
def test_neighbor(lmp, scenes, case):
    """Lists that may be older than cells have moved: contacts would be missed without a word."""
    text, *patterns = SETTINGS[case]
    fails(lmp, whole(scenes.doublet(), extra=text), *patterns)


@pytest.mark.parametrize(
    "setting, told",
    [
        ("group left right", "exclude group left right"),
        ("molecule/inter both", "exclude molecule/inter both"),
    ],
)
def test_neighbor_exclude_some(lmp, scenes, setting, told):
    """Contacts between some cells left out: allowed, for bodies that stay apart, and told once a
    run; the cells then do not feel each other."""
    scene = scenes.Scene(30.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(11.0, 0.0, 0.0, 6.0)
    parts = {"cortex": "", "volume": "", "cell": "fix cell all dcm/cell\n"}
    groups = "group left molecule 1\ngroup right molecule 2\ngroup both molecule 1 2\n"
    tail = "thermo_style custom step fmax\nrun 0\n"
    touching = lmp(whole(scene, extra=groups, **parts) + tail)
    setting = f"{groups}neigh_modify exclude {setting}\n"
    apart = lmp(whole(scene, extra=setting, **parts) + tail)
    warned = [w for w in apart.out.splitlines() if "WARNING" in w and "do not touch" in w]
    assert len(warned) == 1 and told in warned[0] and "exclude none" in warned[0]
    assert "do not touch" not in touching.out
    assert touching.thermo[-1]["Fmax"] > 0.1 and apart.thermo[-1]["Fmax"] == 0.0


def test_neighbor_of_spheres(lmp, scenes):
    scene = scenes.Scene(30.0, "f f f")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    scene.cbm(11.9, 0.0, 0.0, 6.0)
    parts = {"cortex": "", "volume": "", "cell": "fix cell all dcm/cell\n"}
    fails(lmp, whole(scene, extra=SETTINGS["delay"][0], **parts), *SETTINGS["delay"][1:])


def test_neighbor_every_step(lmp, scenes):
    """Rebuilding without a check is slow, not wrong."""
    lmp(whole(scenes.doublet(), extra="neigh_modify delay 0 every 1 check no\n") + "run 2\n")


def test_dimension(lmp, scenes):
    scene = scenes.doublet(boundary="p p p")
    head = scene.head().replace("region", "dimension 2\nregion", 1)
    fails(lmp, whole(scene, head=head), "dimension is 2, must be 3")


def test_dimension_of_spheres(lmp, scenes):
    scene = scenes.Scene(30.0, "p p p")
    scene.cbm(0.0, 0.0, 0.0, 6.0)
    head = scene.head().replace("region", "dimension 2\nregion", 1)
    fails(lmp, whole(scene, head=head, cortex="", volume=""), "dimension is 2, must be 3")


# --- atoms that commands make ---------------------------------------------------------------------

ATOM = "create_atoms 4 single 0 15 0\nset type 4 diameter 5 mol 9\n"


@pytest.mark.parametrize("np", [1, 3])
def test_create_atoms(lmp, scenes, np):
    """Before the first run, and between two."""
    scene = scenes.doublet(boundary="f f f")
    fails(lmp, whole(scene, extra=ATOM), "atom 247 has kind 0", "create_cells", np=np)
    result = lmp.run(whole(scene) + "run 1\n" + ATOM + "run 1\n", np=np)
    assert "atom 247 has kind 0" in result.error, result.tail()
    assert "make cells with create_cells" in result.error.replace("\n", " ")


def test_deposited_atom(lmp, scenes):
    """Made in a run: an error at that step."""
    extra = (
        "region top block -5 5 10 15 -5 5\nfix drop all deposit 1 4 5 12345 region top near 1.0\n"
    )
    deck = whole(scenes.doublet(boundary="f f f"), extra=extra) + "timestep 0.1\nrun 20\n"
    result = lmp.run(deck)
    assert result.returncode != 0
    assert "Fix dcm/cell: atom 247 has kind 0 at step" in result.error, result.tail()


# --- groups ---------------------------------------------------------------------------------------

GROUPS = {
    # style, its arguments without the names, atoms in the group, patterns
    "growth": ("dcm/growth", "{map} seed 3 cycle_time 200", "type 2 3", "no center or sphere"),
    "death": ("dcm/death", "age 100", "type 2 3", "no center or sphere"),
    "volume": ("dcm/volume", "{map}", "type 2 3", "no center, which"),
    "tension": ("dcm/tension", "{map} tension 0.1", "type 3", "no center, which"),
    "motility": ("dcm/motility", "{map} seed 7", "type 2", "no center or sphere"),
    "confine": ("dcm/confine", "plane z 1.0", "type 2 3", "no center or sphere"),
    "motion": ("dcm/motion", "{map}", "type 1 3", "no node or sphere"),
    "one cell's nodes": ("dcm/volume", "{map}", "id 2:43", "no center, which"),
}


@pytest.mark.parametrize("case", GROUPS)
def test_group(lmp, scenes, case):
    """A group through which a style would act on nothing, though it holds atoms of cells."""
    style, options, atoms, pattern = GROUPS[case]
    scene = scenes.doublet()
    text = f"group g {atoms}\nfix f g {style} {options.format(map=scene.map)}\n"
    part = {"dcm/volume": "volume", "dcm/motion": "motion"}.get(style, "extra")
    fails(
        lmp,
        whole(scene, **{part: text}),
        f"Fix {style}",
        "group g holds .* atoms",
        pattern,
        "group g molecule",
    )


COMPUTES = {
    "dcm/cell volume": ("type 2 3", "no center or sphere"),
    "dcm/face area": ("type 1 2", "no face"),
}


@pytest.mark.parametrize("case", COMPUTES)
def test_group_of_a_compute(lmp, scenes, case):
    """Values would be zeros."""
    atoms, pattern = COMPUTES[case]
    extra = f"group g {atoms}\ncompute c g {case}\n"
    tail = "dump d all custom 1 d.txt id c_c\n" if "face" in case else ""
    fails(lmp, whole(scenes.doublet(), extra=extra + tail), f"Compute {case.split()[0]}", pattern,
          "group g holds")  # fmt: skip


def test_motion_of_a_dynamic_group(lmp, scenes):
    """Atoms that join between two rebuilds of the lists would move from the next one on."""
    scene = scenes.doublet()
    text = "variable right atom x>0\ngroup g dynamic all var right every 1\n"
    fails(lmp, whole(scene, motion=text + scene.motion("g")), "Fix dcm/motion: group g is dynamic",
          "static group")  # fmt: skip


def test_group_without_atoms(lmp, scenes):
    """Cells of a group may come later."""
    scene = scenes.doublet()
    extra = f"group g molecule 77\nfix f g dcm/growth {scene.map} seed 3 cycle_time 200\n"
    lmp(whole(scene, extra=extra) + "run 1\n")


# --- lengths of another unit ----------------------------------------------------------------------


def scaled(scenes, factor, **parts):
    """The doublet with its lengths in another unit, and parameters as they were."""
    scene = scenes.doublet(
        radius=6.0 * factor,
        gap=-0.1 * factor,
        box=20.0 * factor,
        boundary=parts.pop("boundary", "s s s"),
    )
    return scene, whole(scene, **parts)


@pytest.mark.parametrize("np", [1, 3])
@pytest.mark.parametrize("factor, radius", [(1e-3, "0.00[56]"), (1e-6, "[56].*e-06")])
@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_unit_of_lengths(lmp, scenes, factor, radius, boundary, np):
    """Cells in mm or m with h0 and skin in um: an error, no search for ghosts without an end."""
    _, deck = scaled(scenes, factor, boundary=boundary)
    fails(
        lmp,
        deck,
        "Pair style dcm/contact: h0 is 0.35 .h0 auto",
        f"cell radius, which is {radius}",
        "in one unit",
        np=np,
    )


LENGTHS = {
    # pair_style arguments, neighbor, patterns
    "h0": ("h0 1e6", "0.6", "h0 is 1e.06, must be below a cell radius, which is [56]"),
    "range": ("range 1e6", "0.6", "range is 1e.06, must be below a cell's diameter"),
    "growth": ("growth 1e6", "0.6", "growth is 1e6, must be at most 100"),
    "layer": ("law foundation", "0.6", "layer of cell type hepatoblast is 7, must be below a cell"),
    "skin": ("", "1000", "skin is 1000, .* times the largest cell radius .[56]", "Set 'neighbor"),
}


@pytest.mark.parametrize("case", LENGTHS)
@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_lengths(lmp, scenes, case, boundary):
    style, skin, *patterns = LENGTHS[case]
    scene = scenes.doublet(boundary=boundary)
    coeff = "layer 7" if case == "layer" else ""
    contact = scene.contact(style, coeff).replace("neighbor 0.6", f"neighbor {skin}")
    fails(lmp, whole(scene, contact=contact), *patterns)


def test_unit_of_lengths_of_spheres(lmp, scenes):
    """They have no h0; the skin tells."""
    scene = scenes.Scene(20.0e-6, "p p p")
    scene.cbm(0.0, 0.0, 0.0, 6.0e-6)
    fails(
        lmp, whole(scene, cortex="", volume=""), "skin is 0.6, 1e.05 times the largest cell radius"
    )


def test_unit_of_the_layer(lmp, scenes):
    """The default is a length in um as well."""
    scene = scenes.doublet(radius=6e-3, gap=-1e-4, box=20e-3)
    contact = scene.contact("law foundation h0 0.0008 range 0.003").replace("0.6", "0.0006")
    fails(lmp, whole(scene, contact=contact), "layer of cell type hepatoblast is 0.1 .the default")


def test_unit_of_lengths_given(lmp, scenes):
    """In mm with lengths of the pair style in mm: the same numbers as in um, scaled."""
    one, deck = scaled(scenes, 1.0, motion="")
    result = lmp(deck + scenes.thermo(["ebond", "f_volume"]) + "run 0\n").thermo[-1]
    scene, deck = scaled(scenes, 1e-3, motion="")
    contact = scene.contact("h0 0.0008 range 0.003").replace("neighbor 0.6", "neighbor 0.0006")
    small = lmp(whole(scene, contact=contact, motion="") + scenes.thermo(["ebond", "f_volume"])
                + "run 0\n").thermo[-1]  # fmt: skip
    assert small["E_bond"] == pytest.approx(1e-6 * result["E_bond"], rel=1e-6)
    assert one is not None


# --- cells that start in each other ---------------------------------------------------------------


@pytest.mark.parametrize("np", [1, 2, 3])
def test_start_overlap_below_half(lmp, scenes, np):
    """By 0.35 of the radius: the start is at fault, not the time step. One error, whichever
    processes see it, with the depth: that of the spheres less the sagitta of two faces."""
    scene = scenes.doublet(level=2, gap=-2.1, box=25.0)
    result = fails(
        lmp, whole(scene), "cells 1 and 2 overlap at the start of the run", "move them apart", np=np
    )
    assert "timestep" not in result.error
    depth, limit = re.search(r"by ([\d.]+) at step 0, more than ([\d.]+);", result.error).groups()
    assert float(limit) < float(depth) < 2.1 and float(depth) > 1.6


# --- a box that gets too small --------------------------------------------------------------------


@pytest.mark.parametrize("np", [1, 3])
def test_box_shrinks_in_a_run(lmp, scenes, np):
    """Closest images are unique as long as a cell stays away from itself around the box: one that
    is made smaller while cells keep their size ends the run when they span 0.9 of it."""
    scene = scenes.Scene((14.0, 20.0, 20.0), "p p p")
    scene.dcm(0.0, 0.0, 0.0, 6.0)
    extra = "fix def all deform 1 x final -6 6 remap none\n"
    deck = whole(scene, extra=extra) + "timestep 0.1\nthermo 1\nrun 100\n"
    result = lmp.run(deck, np=np, timeout=60)
    found = re.search(r"cell 1 spans 0\.9.* box length at step ([0-9]+)", result.error)
    # 12 um across: 0.9 of 13.3 um, which the box has after 92 steps from 28 to 12
    assert found and 86 <= int(found.group(1)) <= 100, result.tail()
