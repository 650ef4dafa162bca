"""Scenes and effects of tools/bench effects: which decks are compared.

A deck is TEMPLATE with fields filled in: those of the scene, then those an effect changes. Every
style of the package is in the list EFFECTS (or in BASE, with the reason); a new one without an
entry ends the tool and a test with a message that says what to add.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

STEPS = 10    # of a run whose instructions are counted; events happen in the last

# atom types: deformable cells 1 center, 2 node, 3 face, and 4, 5, 6 of another cell type; spheres
# 7; tracers 8; fixed spheres 9. A name NULL stands for types that the deck does not need
TEMPLATE = """\
units           lj
atom_style      dcm
newton          on
special_bonds   lj/coul 1 1 1
boundary        s s s
region          box block {box}
create_box      9 box bond/types 1 dihedral/types 1 extra/bond/per/atom 8 extra/dihedral/per/atom 8
mass            * 1.0
create_cells    table cells.txt mesh icosphere {level} rotate 3 rest 0.95 &
                dcm cell 1 2 3 1 1 dcm other {second} 1 1 cbm sphere 7 cbm wall 9
group           none empty
group           one molecule {one}
group           dcm type 1 2 3 4 5 6
group           centers type 1 4
group           cells type 1 4 7 9
group           others subtract dcm one
group           wall type 9
group           mobile subtract all wall
{cell}
{bond}
{dihedral}
{pair}
neighbor        1.0 multi
neigh_modify    delay 0 every 1 check yes
{volume}
{effect}
{move}
{after}
timestep        {dt}
thermo_style    {thermo_style}
thermo_modify   norm no
thermo          {thermo}
run             {steps}
"""
DEFAULTS = dict(
    second="1 2 3",
    cell="fix cell all dcm/cell types {file} cholangiocyte cholangiocyte cholangiocyte "
         "{other} {other} {other} {sphere} NULL {wall}",
    file="bile_duct.dcm",
    other="NULL",
    bond="bond_style dcm/cortex\nbond_coeff 1 cholangiocyte",
    dihedral="dihedral_style dcm/bend\ndihedral_coeff 1 cholangiocyte {hinge}",
    hinge="",
    pair="pair_style dcm/contact {contact}\npair_coeff * * {coeff}",
    contact="",
    coeff="",
    volume="fix volume all dcm/volume {pressure}",
    pressure="",
    effect="",
    move="fix move mobile dcm/motion {motion}",
    after="",
    thermo_style="custom step",
)


@dataclass(frozen=True)
class Scene:
    """A tissue: `cells` is its table for create_cells, `fields` what it fills into the template."""

    name: str
    about: str
    cells: str
    fields: dict
    timed: int    # steps whose time is taken with --seconds


def _table(where, radius=6.0):
    """Cells table of deformable cells; every other one may be given another type."""
    return "".join(f"{'cell' if k % 2 else 'other'} dcm {x:g} {y:g} {z:g} {radius:g}\n"
                   for k, (x, y, z) in enumerate(where))


def _duct():
    """The quick bile-duct scene: its deformable cells in turn cell and other, outer spheres 7."""
    rows, number = [], 0
    for line in (ROOT / "examples/bile_duct/cells.quick.txt").read_text().splitlines():
        if line.startswith("#"):
            continue
        name, kind, *rest = line.split()
        if kind == "dcm":
            name, number = ("cell" if number % 2 else "other"), number + 1
        else:
            name = "wall" if name == "endothelium" else "sphere"
        rows.append(" ".join([name, kind, *rest]))
    return "\n".join(rows) + "\n"


NONE = dict(sphere="NULL", wall="NULL", one="1")
SCENES = {scene.name: scene for scene in [
    Scene("pair", "two cells of 162 nodes that touch; explicit steps of 0.5 s",
          _table([(-5.85, 0, 0), (5.85, 0, 0)]),
          dict(NONE, box="-20 20 -20 20 -20 20", level="2", dt="0.5",
               motion="scheme explicit"), 1000),
    Scene("block", "a block of 8 cells of 42 nodes; implicit steps of 1 s",
          _table([(5.85 * x, 5.85 * y, 5.85 * z)
                  for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]),
          dict(NONE, box="-20 20 -20 20 -20 20", level="1", dt="1.0",
               motion="scheme implicit"), 400),
    Scene("duct", "the bile duct, quick size: 14 cells of 162 nodes, 66 spheres; chosen steps",
          _duct(),
          dict(box="-75 75 -75 75 -15 15", level="2", dt="1.0", sphere="hepatoblast_cbm",
               wall="endothelium", one="21",
               motion="dt auto tol 0.02 max 60"), 60),
]}  # fmt: skip


@dataclass(frozen=True)
class Effect:
    """What is compared: the deck with the fields `named` against that with the fields `base`.

    styles: of the package, as listed by registered(), that this row is about
    idle: fields with which the style is there and has nothing to do, against `idle_base` (or base)
    note: why it has nothing to do, where its line does not tell
    per: "step", or "event": it happens once, in the last step
    acts: an equal-style reference that is not zero at the end if the effect happened
    """

    name: str
    styles: tuple
    named: dict = field(default_factory=dict)
    base: dict = field(default_factory=dict)
    idle: dict = None
    idle_base: dict = None
    note: str = ""
    per: str = "step"
    acts: str = ""
    scenes: tuple = tuple(SCENES)


def fixes(*lines):
    """Field `effect` with these lines."""
    return {"effect": "\n".join(lines)}


# nothing of a deck with cells works without these
BASE = {
    "atom_style dcm": "every deck has it: atoms, ghosts and messages of the scene are its",
    "command create_cells": "acts before the run only",
}

BARE = dict(cell="", bond="bond_style zero nocoeff\nbond_coeff *", volume="", move="",
            dihedral="dihedral_style zero nocoeff\ndihedral_coeff *",
            pair="pair_style none\ncomm_modify cutoff 8.0")
CELL = "fix cell all dcm/cell types bile_duct.dcm" + 6 * " cholangiocyte" + " {sphere} NULL {wall}"
SPHERE = dict(sphere="hepatoblast_cbm")
POLARITY = "fix polarity dcm dcm/polarity seed 1 apical 0.8 junction auto init toward 0.5 0.7 0.9"
NO_POLARITY = POLARITY.replace(" dcm dcm/", " none dcm/")
OSMOSIS = "fix osmosis dcm dcm/osmosis pressure 0.1 marks flood slab z -3 3 starter apical 1e9"
TRACER = "fix tracer dcm dcm/tracer type 8 number 100 D 0.04 seed 1"
# the cell has nearly twice the volume of a newborn one: it is ready after a second
READY = "fix growth one dcm/growth seed 1 cycle_time 10 newborn 460 rounding 0 1"
GROWTH = "fix growth all dcm/growth seed 1 cycle_time 86400"
SIGNAL = "fix signal others dcm/signal from one to 4 5 6 time 7200 lumen no"
TYPES = dict(second="4 5 6", other="hepatoblast")
CONVERT = "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 7 rest 0.95"
REGIONS = "region nowhere sphere 1000 1000 1000 1\nregion everywhere sphere 0 0 0 1000"
NOBODY = " region nowhere everywhere every 1"
READ = "fix read all ave/time 1 1 1 {0}"


def reads(style, group, values, count, kind=""):
    """Field `after`: a compute of per-atom (or other) values, summed in each step."""
    parts = " ".join(f"c_c[{k}]" for k in range(1, count + 1))
    return dict(after=f"compute c {group} {style} {values}\n"
                      f"compute s {group} reduce sum {parts}{kind}\n" + READ.format("c_s[*]"))


EFFECTS = [
    # ---- what cells are made of
    Effect("table of cells", ("fix dcm/cell",), dict(BARE, cell=CELL), BARE),
    Effect("cortex", ("bond_style dcm/cortex",), {}, dict(bond=BARE["bond"])),
    Effect("bending", ("dihedral_style dcm/bend",), {}, dict(dihedral=BARE["dihedral"])),
    Effect("bending, rest mesh", ("dihedral_style dcm/bend",), dict(hinge="rest mesh")),
    Effect("pressure of cells", ("fix dcm/volume",), {}, dict(volume=""),
           idle=fixes("fix idle none dcm/volume"), idle_base={}),
    Effect("pressure, form voronoi", ("fix dcm/volume",), dict(pressure="form voronoi")),
    Effect("half the cells of another type", ("fix dcm/cell",), TYPES),
    # ---- contact
    Effect("contact", ("pair_style dcm/contact",), {}, dict(pair=BARE["pair"])),
    Effect("contact, friction", ("pair_style dcm/contact",), dict(motion="scheme implicit"),
           dict(motion="scheme implicit", coeff="friction_normal 0 friction_tangential 0")),
    Effect("contact, law dmt", ("pair_style dcm/contact",), dict(contact="law dmt")),
    Effect("contact, law maugis", ("pair_style dcm/contact",), dict(contact="law maugis")),
    Effect("law maugis, branch history", ("pair_style dcm/contact",),
           dict(contact="law maugis branch history"), dict(contact="law maugis")),
    Effect("law maugis, points 4", ("pair_style dcm/contact",),
           dict(contact="law maugis points 4"), dict(contact="law maugis")),
    Effect("contact, facing", ("pair_style dcm/contact",), dict(contact="facing 45 60")),
    Effect("contact, concave negative", ("pair_style dcm/contact",),
           dict(contact="concave negative")),
    Effect("contact, shared space in every step", ("pair_style dcm/contact",), dict(thermo="1")),
    # ---- motion
    Effect("motion", ("fix dcm/motion",), {}, dict(move="")),
    Effect("motion, implicit", ("fix dcm/motion",), dict(motion="scheme implicit"),
           dict(motion="scheme explicit")),
    Effect("motion, dt auto", ("fix dcm/motion",), dict(motion="dt auto tol 0.02 max 60"),
           dict(motion="scheme implicit")),
    Effect("motion, accuracy 0.02", ("fix dcm/motion",), dict(motion="accuracy 0.02"),
           dict(motion="scheme implicit")),
    Effect("motion, maxmove shrink", ("fix dcm/motion",),
           dict(motion="scheme explicit maxmove 0.25 shrink"),
           dict(motion="scheme explicit maxmove 0.25")),
    Effect("motion, tolerance 1e-6", ("fix dcm/motion",),
           dict(motion="scheme implicit tolerance 1e-6"), dict(motion="scheme implicit")),
    Effect("motion, precondition none", ("fix dcm/motion",),
           dict(motion="scheme implicit precondition none"), dict(motion="scheme implicit")),
    # ---- forces
    Effect("a body that moves", ("fix dcm/move",), fixes("fix push one dcm/move linear 0 0 0.01"),
           idle=fixes("fix push none dcm/move linear 0 0 0.01")),
    Effect("tension", ("fix dcm/tension",), fixes("fix tension all dcm/tension tension 0.1"),
           idle=fixes("fix tension all dcm/tension tension 0")),
    Effect("traction", ("fix dcm/traction",), fixes("fix push dcm dcm/traction pressure 0.1"),
           idle=fixes("fix push none dcm/traction pressure 0.1")),
    Effect("traction, a variable in a region", ("fix dcm/traction",),
           fixes(REGIONS, "variable t atom 0.01*z", "group faces type 3 6",
                 "fix push faces dcm/traction vector 0 0 v_t region everywhere faces lateral"),
           fixes("fix push dcm dcm/traction pressure 0.1")),
    Effect("factors on rest states", ("fix dcm/adapt",),
           fixes("variable f equal 1+1e-4*step", "fix adapt dcm dcm/adapt volume0 v_f rest v_f"),
           idle=fixes("variable f equal 1+1e-4*step",
                      "fix adapt none dcm/adapt volume0 v_f rest v_f")),
    Effect("factors on rest states, regions", ("fix dcm/adapt",),
           fixes(POLARITY, "variable f atom 1+1e-4*step",
                 "fix adapt dcm dcm/adapt rest v_f faces apical junction every 10"),
           fixes(POLARITY)),
    Effect("remeshing, looks", ("fix dcm/remesh",), fixes("fix remesh dcm dcm/remesh every 1"),
           idle=fixes("fix remesh none dcm/remesh every 1")),
    Effect("plane", ("fix dcm/confine",), fixes("fix plane all dcm/confine plane z 10.0"),
           idle=fixes("fix plane none dcm/confine plane z 10.0")),
    Effect("background pressure", ("fix dcm/confine",),
           fixes("fix press cells dcm/confine pressure 0.2 over dcm"),
           idle=fixes("fix press cells dcm/confine pressure 0.2 over dcm hold yes")),
    Effect("motility", ("fix dcm/motility",),
           fixes("fix crawl all dcm/motility seed 1 interval 10"),
           idle=fixes("fix crawl all dcm/motility seed 1 interval 10 D 0")),
    Effect("motility, persistence", ("fix dcm/motility",),
           fixes("fix crawl all dcm/motility seed 1 interval 10 persistence 600"),
           idle=fixes("fix crawl none dcm/motility seed 1 interval 10")),
    # ---- the life of cells
    Effect("growth", ("fix dcm/growth",), fixes(GROWTH),
           idle=fixes("fix growth all dcm/growth seed 1 cycle_time 0")),
    Effect("growth, a cycle of 1e12 s", ("fix dcm/growth",),
           fixes("fix growth all dcm/growth seed 1 cycle_time 1e12"),
           idle=fixes("fix growth none dcm/growth seed 1 cycle_time 86400")),
    Effect("growth slowed by compression", ("fix dcm/growth",),
           fixes(GROWTH + " compression 0.3 1 K_V 2.5"), fixes(GROWTH)),
    Effect("growth, until volume", ("fix dcm/growth",), fixes(GROWTH + " until volume"),
           fixes(GROWTH)),
    Effect("growth, part of the cells", ("fix dcm/growth",),
           fixes(GROWTH + " proliferating cholangiocyte 0.5"), fixes(GROWTH)),
    Effect("growth, types that divide differently", ("fix dcm/growth",),
           dict(TYPES, file="cycles.dcm", **fixes("fix growth all dcm/growth seed 1")),
           dict(TYPES, **fixes(GROWTH))),
    Effect("division of a cell", ("fix dcm/division",),
           fixes(READY, "fix divide all dcm/division seed 1 every {last}"), fixes(READY),
           idle=fixes(GROWTH, "fix divide all dcm/division seed 1"), idle_base=fixes(GROWTH),
           note="no cell gets ready",
           per="event", acts="f_divide[1]"),
    Effect("death, shrinking", ("fix dcm/death",), fixes("fix die one dcm/death all shrink 1e6"),
           idle=fixes("fix die all dcm/death age 1e12"), idle_base={}),
    Effect("death, by lot", ("fix dcm/death",), fixes("fix die all dcm/death rate 1e-12 seed 1"),
           idle=fixes("fix die none dcm/death all"), idle_base={}),
    Effect("death of a cell", ("fix dcm/death",), fixes("fix die one dcm/death all every {last}"),
           per="event", acts="f_die"),
    Effect("conversion, nobody near", ("fix dcm/convert",),
           dict(SPHERE, **fixes(REGIONS, CONVERT + NOBODY)), SPHERE,
           idle=dict(SPHERE, **fixes(REGIONS, CONVERT.replace(" all ", " none ") + NOBODY))),
    Effect("conversion by pressure, nobody", ("fix dcm/convert",),
           dict(SPHERE, **fixes(CONVERT + " pressure 1000 -1000 every 1")),
           dict(SPHERE, **fixes(REGIONS, CONVERT + NOBODY))),
    Effect("conversion by strain, nobody", ("fix dcm/convert",),
           dict(SPHERE, **fixes(CONVERT + " strain 0.29 -1000 every 1")),
           dict(SPHERE, **fixes(REGIONS, CONVERT + NOBODY))),
    Effect("conversion of a cell", ("fix dcm/convert",),
           dict(SPHERE, **fixes(
               "variable form atom -1",
               CONVERT.replace(" all ", " one ") + " variable v_form every {last}")), SPHERE,
           per="event", acts="f_convert[2]"),
    # ---- lumens
    Effect("polarity", ("fix dcm/polarity",), fixes(POLARITY),
           idle=fixes(NO_POLARITY)),
    Effect("polarity, every 1", ("fix dcm/polarity",), fixes(POLARITY + " every 1"),
           fixes(POLARITY + " every 10")),
    Effect("constriction", ("fix dcm/constriction",),
           fixes(POLARITY, "fix tight dcm dcm/constriction when born ramp 300"), fixes(POLARITY),
           idle=fixes(POLARITY, "fix tight dcm dcm/constriction when time 1e12")),
    Effect("tracers, 100 a cell", ("fix dcm/tracer",), fixes(POLARITY, TRACER), fixes(POLARITY),
           idle=fixes(POLARITY, TRACER.replace("number 100", "number 0")), acts="f_tracer[1]"),
    Effect("osmosis", ("fix dcm/osmosis",), fixes(POLARITY, OSMOSIS), fixes(POLARITY),
           idle=fixes(NO_POLARITY, OSMOSIS), idle_base=fixes(NO_POLARITY),
           note="no cell is polar", acts="f_osmosis[1]"),
    Effect("osmosis, every 1", ("fix dcm/osmosis",), fixes(POLARITY, OSMOSIS + " every 1"),
           fixes(POLARITY, OSMOSIS + " every 10")),
    Effect("osmosis, solute", ("fix dcm/osmosis",),
           fixes(POLARITY, OSMOSIS.replace("pressure 0.1", "solute rate 1e-4 kT 2.577")),
           fixes(POLARITY, OSMOSIS)),
    Effect("osmosis, marks by tracers", ("fix dcm/osmosis",),
           fixes(POLARITY, TRACER, "fix osmosis dcm dcm/osmosis pressure 0.1 marks tracer"),
           fixes(POLARITY, TRACER)),
    Effect("signal", ("fix dcm/signal",), dict(TYPES, **fixes(SIGNAL)), TYPES,
           idle=dict(TYPES, **fixes(SIGNAL.replace("from one", "from none")))),
    # ---- output
    Effect("values of cells", ("compute dcm/cell",),
           reads("dcm/cell", "centers", "volume area pressure contact_area", 4),
           idle=dict(after="compute c centers dcm/cell volume area pressure contact_area"),
           note="nobody reads it"),
    Effect("values of cells, neighbors", ("compute dcm/cell",),
           reads("dcm/cell", "centers", "volume area pressure neighbors", 4),
           reads("dcm/cell", "centers", "volume area pressure contact_area", 4)),
    Effect("values of faces", ("compute dcm/face",),
           reads("dcm/face", "dcm", "area contact_area", 2),
           idle=dict(after="compute c dcm dcm/face area contact_area"), note="nobody reads it"),
    Effect("values of faces, stress", ("compute dcm/face",),
           reads("dcm/face", "dcm", "area stress", 2),
           reads("dcm/face", "dcm", "area contact_area", 2)),
    Effect("pairs of cells in contact", ("compute dcm/contact/local",),
           reads("dcm/contact/local", "cells", "area fx fy fz", 4, " inputs local"),
           idle=dict(after="compute c cells dcm/contact/local area fx fy fz"),
           note="nobody reads it"),
    Effect("measures of lumens", ("compute dcm/lumen",),
           dict(fixes(POLARITY, OSMOSIS),
                after="compute lumen all dcm/lumen\n" + READ.format("c_lumen[1] c_lumen[4]")),
           fixes(POLARITY, OSMOSIS),
           idle=dict(fixes(POLARITY, OSMOSIS), after="compute lumen all dcm/lumen"),
           note="nobody reads it"),
]


def registered(code=ROOT / "src/DCM"):
    """Styles of the package: name, as a deck and EFFECTS call it -> header that registers it."""
    words = {"Atom": "atom_style", "Pair": "pair_style", "Bond": "bond_style",
             "Dihedral": "dihedral_style"}
    return {f"{words.get(kind, kind.lower())} {name}": header
            for header in sorted(code.glob("*.h"))
            for kind, name in re.findall(r"^(\w+)Style\(([\w/]+),", header.read_text(), re.M)}


def missing(styles):
    """Of `styles` those without an entry, and entries of styles that are not there."""
    listed = {style for effect in EFFECTS for style in effect.styles} | set(BASE)
    return sorted(set(styles) - listed), sorted(listed - set(styles))


def options(style, header):
    """Keywords of the style's page that a row of EFFECTS has in a deck, and those that none has."""
    page = ROOT / "doc" / f"{header.stem}.rst"
    text = page.read_text().partition("Examples\n")[0] if page.is_file() else ""
    known = dict.fromkeys(w for line in re.findall(r"^ {7}(\*\w.*)", text, re.M)
                          for w in re.findall(r"\*(\w+)\*", line.partition("value")[0]))
    used = " ".join(" ".join(variant.values()) for effect in EFFECTS if style in effect.styles
                    for variant in (effect.base, effect.named, effect.idle or {}))
    return ([k for k in known if re.search(rf"\b{k}\b", used)],
            [k for k in known if not re.search(rf"\b{k}\b", used)])


def deck(scene, fields, steps, acts=""):
    """Text of the deck of `scene` with the changed `fields`; fields may name others in braces."""
    values = dict(DEFAULTS, thermo=str(steps), **scene.fields)
    values |= fields | {"steps": str(steps), "last": str(STEPS)}
    if acts:
        values["thermo_style"] = f"custom step {acts}"
    text = TEMPLATE
    for _ in range(5):    # a field that names a field that names one
        text = re.sub(r"\{(\w+)\}", lambda match: values[match[1]], text)
    assert "{" not in text, text
    return text
