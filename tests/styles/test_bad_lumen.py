"""What a hostile deck does to the styles of lumens: one error that names style, value and
remedy, or a right result; values asked for between runs, times set back, borders of periodic
boxes."""

from pathlib import Path

import pytest

from support.bad_decks import fails, lines_of_error, whole

ROOT = Path(__file__).resolve().parents[2]
FLOOD = "fix osm all dcm/osmosis pressure {} marks flood starter 0 0 0 100 1e9 "
POLARITY = "fix pol all dcm/polarity seed 3 init {}\n"
VALUES = (
    "variable h atom 1e300\nvariable t atom 1e-300\nvariable o atom 0.0\n"
    "compute axes all dcm/cell ax ay az\ncompute most all reduce max c_axes[*]\n"
)


# --- keywords -------------------------------------------------------------------------------------

OSMOSIS = {
    "pressure v_": ("pressure v_ marks flood", "pressure is v_, must be a number, or v_NAME"),
    "slab outside": ("pressure 1 marks flood slab z 100 200",
                     "no face of group all lies in slab z 100 200.*move the slab"),
    "slab between faces": ("pressure 1 marks flood slab z 6.5 7", "no face of group all lies in"),
    "starter": ("pressure 1 marks flood starter 1e300 0 0 1 1",
                "starter 1e.300 0 0 lies outside the periodic box"),
}  # fmt: skip
TRACER = {
    "number": ("number 1e6 D 0.02 seed 5", "number is 1e6, must be a whole number of 0 to 100000"),
    "substeps": ("number 5 D 0.02 seed 5 substeps 1e9", "substeps is 1e9, must be .* 1 to 1000"),
    "D": ("number 5 D 1e5 seed 5", "tracers move up to .* more than 100 edges.*reduce D"),
    "slab": ("number 5 D 0.02 seed 5 slab z 12 20", "slab z 12 20 reaches across the border"),
}


@pytest.mark.parametrize("name", OSMOSIS)
def test_osmosis_keywords(lmp, scenes, name):
    text, pattern = OSMOSIS[name]
    scene = scenes.single_cell(boundary="p p p" if name == "starter" else "s s s")
    extra = POLARITY.format("random") + f"fix osm all dcm/osmosis {text}\n"
    fails(lmp, whole(scene, extra=extra), "Fix dcm/osmosis: .*" + pattern)


@pytest.mark.parametrize("name", TRACER)
def test_tracer_keywords(lmp, scenes, name):
    text, pattern = TRACER[name]
    scene = scenes.single_cell(boundary="p p p" if name == "slab" else "s s s")
    scene.NAMES = "hepatoblast hepatoblast hepatoblast NULL"
    extra = f"fix tra all dcm/tracer type 4 {text}\n"
    fails(lmp, whole(scene, extra=extra), "Fix dcm/tracer: .*" + pattern)


@pytest.mark.parametrize("given", ["v_P pressure 0.2", "0.2 pressure v_P"])
def test_two_pressures(lmp, scenes, given):
    extra = "variable P equal 0.1\n" + FLOOD.format(given) + "\n"
    fails(lmp, whole(scenes.single_cell(), extra=extra), "dcm/osmosis: keyword pressure is .*twice")


def test_a_starter_far_away(lmp, scenes):
    extra = "fix osm all dcm/osmosis pressure 0.1 marks flood starter 90 0 0 2 9\n"
    result = lmp(whole(scenes.single_cell(), extra=extra) + "timestep 1.0\nrun 1\n")
    assert "no face of group all lies within 2 of the starter's point 90 0 0" in result.out


@pytest.mark.parametrize("init", ["toward 1e300 0 0", "variable v_h v_o v_o",
                                  "variable v_t v_o v_o"])  # fmt: skip
@pytest.mark.parametrize("plane", ["none", "z"])
def test_huge_and_tiny_vectors_have_a_direction(lmp, scenes, init, plane):
    """Their squares are no numbers. A hang once, with a plane."""
    extra = VALUES + POLARITY.format(f"{init} plane {plane}")
    axes = [f"a{k}=c_most[{k}]" for k in (1, 2, 3)]
    result = lmp(whole(scenes.single_cell(), extra=extra) + scenes.thermo(axes)
                 + "timestep 1.0\nrun 0\n", timeout=60)  # fmt: skip
    assert [result.thermo[0][f"v_a{k}"] for k in (1, 2, 3)] == pytest.approx([1, 0, 0], abs=1e-15)


def test_a_point_that_has_no_closest_image(lmp, scenes):
    scene = scenes.single_cell(boundary="p p p")
    fails(lmp, whole(scene, extra=POLARITY.format("toward 1e300 0 0")),
          "Fix dcm/polarity: init toward 1e.300 0 0 lies outside the periodic box.*in the box")


# --- between runs ---------------------------------------------------------------------------------

ASKED = {
    # what the deck does, what it asks for then, style, message
    "marks": ("unfix osm", "c_lum", "Compute dcm/lumen: the style that marks faces was removed"),
    "mark": ("unfix osm", "c_face[1]", "Compute dcm/face: the style that marks faces was removed"),
    "cell": ("unfix cell", "c_lum", "Compute dcm/lumen: fix dcm/cell was removed"),
    "pair": ("pair_style none", "c_lum", "Compute dcm/lumen: pair_style dcm/contact was removed"),
    "atoms": ("group two molecule 2\ndelete_atoms group two bond yes", "c_lum",
              "Compute dcm/lumen: atoms were added, deleted"),
}  # fmt: skip
FIXES = {
    "osm cell": ("unfix cell", "f_osm[1]", "Fix dcm/osmosis: fix dcm/cell was removed"),
    "osm pair": ("pair_style none", "f_osm[1]", "Fix dcm/osmosis: pair_style dcm/contact was"),
    "pol cell": ("unfix cell", "f_pol[2]", "Fix dcm/polarity: fix dcm/cell was removed"),
    "con cell": ("unfix cell", "f_con[2]", "Fix dcm/constriction: fix dcm/cell was removed"),
    "con atoms": ("group two molecule 2\ndelete_atoms group two bond yes", "f_con[2]",
                  "Fix dcm/constriction: atoms were added, deleted"),
}  # fmt: skip


def measured(scenes):
    return whole(
        scenes.doublet(),
        extra=POLARITY.format("random junction auto") + FLOOD.format(0.1) + "\n"
        + "fix con all dcm/constriction when born\n"
        + "compute lum all dcm/lumen\ncompute face all dcm/face mark region\n",
    ) + "timestep 1.0\nthermo_style custom step\nrun 2\n"  # fmt: skip


@pytest.mark.parametrize("name", [*ASKED, *FIXES])
def test_values_of_what_the_deck_has_removed(lmp, scenes, name):
    """A crash once: pointers to styles that were gone."""
    change, value, message = (ASKED | FIXES)[name]
    ask = f"write_dump all custom x.txt id {value}" if name in ASKED else f"print '$({value})'"
    result = lmp.run(measured(scenes) + f"{change}\n{ask}\n")
    assert result.returncode == 1 and len(lines_of_error(result)) == 1, result.tail()
    assert message in result.error and "run 0" in result.error, result.error


def test_values_of_what_stays(lmp, scenes):
    """Between runs, and after files are written on one process, nothing has changed."""
    asking = "print 'asked $(c_lum[1]) $(f_osm[1]) $(f_pol[1]) $(f_con[2])'\n"
    result = lmp(measured(scenes) + asking + "write_restart x.restart\n" + asking)
    said = [line for line in result.out.splitlines() if line.startswith("asked")]
    assert len(said) == 2 and said[0] == said[1] and said[0].split()[1] != "0"


# --- times ----------------------------------------------------------------------------------------


def test_ramp_and_solute_go_on_when_the_step_is_reset(lmp, scenes):
    """Negative times made a negative pressure, or one that grows without bounds."""
    for options in ("pressure 0.1 ramp 40", "solute rate 1e-5 kT 2 loss 8"):
        fix = f"fix osm all dcm/osmosis {options} marks flood starter 0 0 0 100 1e9 every 1\n"
        deck = whole(scenes.single_cell(), extra=fix) + scenes.thermo(
            ["P=f_osm[5]", "n=f_osm[9]"]) + "timestep 1.0\n"  # fmt: skip
        straight = lmp(deck + "run 20\nrun 10\n").runs[1]
        reset = lmp(deck + "run 20\nreset_timestep 3\nrun 10\n").runs[1]
        for a, b in zip(straight, reset, strict=True):
            assert b["v_P"] == pytest.approx(a["v_P"], rel=1e-12)
            assert b["v_n"] == pytest.approx(a["v_n"], rel=1e-12)
        assert "ramp" not in options or straight[-1]["v_P"] == pytest.approx(0.075, rel=1e-12)


# --- a slab across the border ---------------------------------------------------------------------


def test_slab_across_a_periodic_border(lmp, scenes):
    """The same cell in the middle and at the border: the same marks, volume and section."""
    found = []
    for z in (0.0, 15.0):
        scene = scenes.Scene(15.0, "p p p", 1)
        scene.dcm(0.0, 0.0, z, 6.0)
        fix = (f"fix osm all dcm/osmosis pressure 0.1 marks flood slab z {z - 3} {z + 3} "
               f"starter 0 0 {z} 100 1e9\n"
               f"compute lum all dcm/lumen plane z {z} slab {z - 2} {z + 2}\n")  # fmt: skip
        names = [f"o{k}=f_osm[{k}]" for k in (1, 2, 4)] + [f"l{k}=c_lum[{k}]" for k in range(1, 8)]
        result = lmp(whole(scene, extra=fix) + scenes.thermo(names) + "timestep 1.0\nrun 2\n")
        found.append(result.thermo[-1])
    assert found[0]["v_o2"] > 20 and abs(found[0]["v_l4"]) > 50.0
    for name, value in found[0].items():
        assert found[1][name] == pytest.approx(value, rel=1e-9, abs=1e-9), name


# --- examples -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name, value", [
    ("size", "big"), ("directed", "maybe"), ("osmosis", "maybe"), ("constriction", "maybe"),
    ("differentiation", "maybe"), ("marks", "maybe"),
])  # fmt: skip
def test_wrong_choice_in_the_day_of_the_duct(lmp, name, value):
    result = lmp.run(ROOT / "examples/bile_duct_day/in.bile_duct_day", vars={name: value})
    assert result.returncode == 1
    said = [line for line in result.out.splitlines() if line.startswith("ERROR")]
    assert said == [line for line in said if f"ERROR: {name} is {value}, use " in line] and said


def test_the_day_goes_on_from_a_missing_file(lmp):
    folder = ROOT / "examples/bile_duct_day"
    result = lmp.run(folder / "in.bile_duct_day", vars={"from": "none.restart"},
                     files={"scene.bile_duct_day": folder / "scene.bile_duct_day"})  # fmt: skip
    assert result.returncode == 1 and len(lines_of_error(result)) == 1
    assert "Cannot open restart file none.restart" in result.error
