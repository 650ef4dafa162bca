"""Random decks from the package's commands and from those of LAMMPS that touch cells.

`wild` is the share of words that are absurd; at 0 every deck is one that a user could write, and
most of them should run.
"""

import numpy as np

from .mutate import ABSURD, pick

TYPES = "hepatoblast hepatoblast hepatoblast hepatoblast_cbm NULL chol chol chol"
PARAMETERS = "test.dcm"
REGIONS = ("lateral", "polar", "apical", "junction", "basal")
TRACER = 5


def _cell_type(name, **values):
    return f"celltype {name}\n" + "".join(f"  {key} {value}\n" for key, value in values.items())


def parameter_text():
    common = dict(
        E_cor=5.0, h_cor=0.5, nu_cor=0.5, gamma=4.0, K_V=2.5, tension=0.1, E_contact=5.0,
        nu_contact=0.4, layer=0.25, friction_normal=50.0, friction_tangential=50.0,
        friction_ecm=1.0, D=1e-4, cycle_time=1000, cycle_sd=100,
    )  # fmt: skip
    names = ("hepatoblast", "hepatoblast_cbm", "chol")
    text = "# DATE: 2026-11-26 UNITS: um nN s CONTRIBUTOR: tools/fuzz\n"
    text += "".join(_cell_type(n, **common, **{"tension:apical": 0.2}) for n in names)
    for k, a in enumerate(names):
        text += "".join(f"adhesion {a} {b} 0.1\n" for b in names[k:])
    return text + "adhesion hepatoblast:apical chol 0.02\n"


class Deck:
    def __init__(self, rng, wild=0.0):
        self.rng, self.wild = rng, wild
        self.out, self.fixes, self.computes, self.cells, self.has = [], {}, [], [], set()
        self.runs = 0

    # --- words ----------------------------------------------------------------------------------

    def absurd(self):
        return self.rng.random() < self.wild

    def maybe(self, p):
        return self.rng.random() < p

    def number(self, low, high):
        """Evenly between two numbers, or by magnitude if both are positive and far apart."""
        if self.absurd():
            return pick(self.rng, ABSURD)
        if low > 0 and high > 20 * low:
            return f"{np.exp(self.rng.uniform(np.log(low), np.log(high))):.4g}"
        return f"{self.rng.uniform(low, high):.4g}"

    def whole(self, low, high):
        return pick(self.rng, ABSURD) if self.absurd() else str(self.rng.integers(low, high + 1))

    def one(self, *words):
        return pick(self.rng, ABSURD) if self.absurd() else pick(self.rng, words)

    def some(self, p, *options):
        """Options of a style, each with probability p, in any order."""
        chosen = [o for o in options if self.maybe(p)]
        self.rng.shuffle(chosen)
        text = " ".join(o() if callable(o) else o for o in chosen)
        if self.absurd():
            text += " " + pick(self.rng, [*ABSURD, "every", "seed 1", "log", "types"])
        return text

    def point(self, most=15.0):
        return " ".join(self.number(-most, most) for _ in range(3))

    def group(self):
        return self.one(*["all"] * 6, "deformable", "spheres", "first", "right", "centers")

    def say(self, lines):
        self.out += [" ".join(line.split()) for line in lines.split("\n") if line.strip()]

    # --- scene ----------------------------------------------------------------------------------

    def scene(self):
        rng = self.rng
        self.boundary = pick(rng, ["s s s", "s s s", "p p p", "p p p", "f f f", "p p f", "p s f",
                                   "m m m"])  # fmt: skip
        box = [float(b) for b in rng.uniform(18, 28, 3)]
        self.box = [self.number(b, b) for b in box]
        a, b, c = self.box
        self.say("units lj")
        self.say(self.one("atom_style dcm"))
        self.say("newton on")
        if self.maybe(0.2):
            self.say("special_bonds lj/coul 1 1 1")
        if self.maybe(0.15):
            self.say(self.one("comm_style brick", "comm_style tiled"))
        if self.maybe(0.1):
            self.say(self.one("processors * 1 1", "processors 1 * *", "processors * * *"))
        self.say(f"boundary {self.one(self.boundary)}")
        self.say(f"region box block -{a} {a} -{b} {b} -{c} {c}".replace("--", "-"))
        self.say(
            f"create_box {self.whole(8, 8)} box bond/types {self.whole(2, 2)} dihedral/types 2 "
            f"extra/bond/per/atom {self.whole(8, 8)} extra/dihedral/per/atom {self.whole(8, 8)}"
        )
        self.say("mass * 1.0")
        places = self.places()
        for n, (x, y, z) in enumerate(places):
            self.create(x, y, z, deformable=n == 0 or self.maybe(0.7))
        self.say("group deformable type 1 2 3 6 7 8")
        self.say("group spheres type 4")
        self.say("group centers type 1 4 6")
        self.say("group first molecule 1")
        self.say("group right molecule > 1")
        self.say("group patch empty")

    def places(self):
        """Cells that touch a little, on a line, in a triangle or on a grid."""
        rng, d = self.rng, 12.0 * self.rng.uniform(0.97, 1.1)
        shift = rng.uniform(-3, 3, 3)
        which = [
            [(0, 0, 0)],
            [(-d / 2, 0, 0), (d / 2, 0, 0)],
            [(0, 0.58 * d, 0), (-d / 2, -0.29 * d, 0), (d / 2, -0.29 * d, 0)],
            [(x * d / 2, y * d / 2, 0) for x in (-1, 1) for y in (-1, 1)],
        ]
        return [np.array(p) + shift for p in pick(rng, which)]

    def create(self, x, y, z, deformable=True):
        place = " ".join(self.number(p, p) for p in (x, y, z))
        radius = self.number(5.5, 6.0)
        if not deformable:
            self.say(f"create_cells single cbm cbm {place} {radius} cbm cbm {self.whole(4, 4)}")
            self.has.add("sphere")
            return
        types, name = pick(self.rng, [("1 2 3 1 1", "hep"), ("6 7 8 2 2", "chol")])
        options = self.some(
            0.6, lambda: f"rotate {self.whole(1, 99)}", lambda: f"rest {self.number(0.9, 1.0)}",
            lambda: f"scale {self.one('volume', 'nodes')}",
        )  # fmt: skip
        level = self.whole(1, 2) if self.maybe(0.1) else self.whole(1, 1)
        self.say(
            f"create_cells single {name} dcm {place} {radius} dcm {name} {types} "
            f"mesh icosphere {level} {options}"
        )
        self.has.add("chol" if name == "chol" else "hep")

    # --- laws -----------------------------------------------------------------------------------

    def laws(self):
        lines = []
        for style, command, options in (
            ("dcm/cortex", "bond", [
                lambda: f"gamma {self.number(0.5, 10)}", lambda: f"E_cor {self.number(1, 10)}",
                lambda: f"h_cor {self.number(0.2, 1)}",
                lambda: f"stiffness {self.one('area', 'young')}",
                lambda: f"dashpot {self.one('isotropic', 'projected')}"]),
            ("dcm/bend", "dihedral", [
                lambda: f"rest {self.one('flat', 'mesh')}", lambda: f"nu_cor {self.number(0, 0.5)}",
                lambda: f"E_cor {self.number(1, 10)}"]),
        ):  # fmt: skip
            lines.append(f"{command}_style {style}")
            for n, name in ((1, "hepatoblast"), (2, "chol")):
                lines.append(f"{command}_coeff {n} {PARAMETERS} {name} {self.some(0.25, *options)}")
        law = self.one("dmt", "maugis", "foundation")
        style = self.some(
            0.25, lambda: f"points {self.whole(1, 4)}", lambda: f"h0 {self.number(0.05, 0.5)}",
            lambda: f"h0 auto {self.number(0.05, 0.5)}", lambda: f"rmax {self.number(1, 10)}",
            lambda: f"range {self.number(2.0, 3.0)} maxoverlap {self.number(1.5, 2.0)}",
            lambda: f"concave {self.one('flat', 'negative')}",
            lambda: f"growth {self.number(1, 3)}",
            lambda: f"facing {self.number(0, 40)} {self.number(41, 90)}",
        )  # fmt: skip
        if law == "maugis" and self.maybe(0.5):
            style += f" branch {self.one('cutoff', 'history')}"
        self.contact = f"pair_style dcm/contact law {law} {style}"
        lines.append(self.contact)
        self.coeff = f"pair_coeff * * {self.names()} " + self.some(
            0.15, lambda: f"W {self.number(0.01, 0.3)}", lambda: f"E_contact {self.number(1, 10)}",
            lambda: f"friction_normal {self.number(1, 100)}", lambda: f"a1 {self.number(0, 1)}",
            lambda: f"a{self.whole(2, 4)} {self.number(-1, 1)}",
            *[lambda: f"layer {self.number(0.05, 0.5)}"] * (law == "foundation" or bool(self.wild)),
        )  # fmt: skip
        lines.append(self.coeff)
        self.rebuild = f"neighbor {self.number(0.6, 1.5)} {self.one('multi', 'multi', 'bin')}"
        lines.append(self.rebuild)
        if self.maybe(0.1):
            lines.append(f"comm_modify cutoff {self.number(20, 30)}")
        if self.maybe(0.15 if self.wild else 0.03):
            lines.append(f"neigh_modify {self.neigh()}")
        if self.maybe(0.1 * bool(self.wild)):
            self.rng.shuffle(lines)
        for line in lines:
            self.say(line)

    def neigh(self):
        return self.some(
            0.4, lambda: f"delay {self.whole(0, 5)}", lambda: f"every {self.whole(1, 5)}",
            lambda: f"check {self.one('yes', 'no')}", lambda: f"once {self.one('no', 'yes')}",
            lambda: f"one {self.whole(2000, 5000)}",
        ) or "delay 0"  # fmt: skip

    def names(self):
        """The map of a style, or nothing where fix dcm/cell has one."""
        if self.mapped and self.maybe(0.8):
            return ""
        return f"{self.one(PARAMETERS)} {TYPES}"

    # --- fixes ----------------------------------------------------------------------------------

    def fix(self, name, line):
        self.fixes[name] = " ".join(f"fix {name} {line}".split())
        self.say(self.fixes[name])

    def cell(self):
        types = f"types {PARAMETERS} {TYPES}" if self.mapped else ""
        self.fix("cell", f"all dcm/cell {types}")

    def volume(self):
        self.fix("volume", f"{self.group()} dcm/volume {self.names()} " + self.some(
            0.2, lambda: f"K_V {self.number(0.5, 10)}",
            lambda: f"form {self.one('gradient', 'voronoi')}"))  # fmt: skip

    def motion(self):
        scheme = self.one("explicit", "implicit")
        options = [
            lambda: f"friction_ecm {self.number(0.1, 10)}", lambda: f"floor {self.number(0, 1)}",
            lambda: f"precondition {self.one('block', 'jacobi', 'none')}",
            lambda: f"maxmove {self.number(0.3, 1)} {self.one('', 'shrink')}",
            lambda: f"maxiter {self.whole(500, 5000)}", lambda: f"stop {self.number(1, 50)}",
        ]  # fmt: skip
        accuracy = ""
        if scheme == "implicit" or self.absurd():
            accuracy = self.some(0.3, lambda: f"accuracy {self.number(0.001, 0.2)}")
            tol = "" if accuracy and self.maybe(0.8) else f"tol {self.number(0.005, 0.1)}"
            options.append(lambda: f"dt auto {tol} "
                           + self.some(0.5, lambda: f"min {self.number(0.001, 0.1)}",
                                       lambda: f"max {self.number(1, 60)}"))  # fmt: skip
        # the group of spheres would leave nodes that do not move: a warning at most
        self.fix("motion", f"{self.one('all', 'all', 'all', 'deformable')} dcm/motion "
                 f"{self.names()} scheme {scheme} tolerance {self.number(1e-10, 1e-10)} {accuracy} "
                 + self.some(0.2, *options))  # fmt: skip

    def motility(self):
        self.fix("motility", f"{self.group()} dcm/motility {self.names()} "
                 f"seed {self.whole(1, 99)} " + self.some(
                     0.4, lambda: f"D {self.number(1e-5, 1e-2)}",
                     lambda: f"bias {self.point(1)} {self.number(0, 5)}",
                     lambda: f"persistence {self.number(1, 100)}",
                     lambda: f"interval {self.number(0.1, 20)}",
                     lambda: f"plane {self.one('x', 'y', 'z')}",
                     lambda: f"friction_ecm {self.number(0.1, 3)}"))  # fmt: skip

    def tension(self):
        self.fix("tension", f"{self.group()} dcm/tension {self.names()} " + self.some(
            0.5, lambda: f"tension {self.number(0.01, 0.5)}",
            lambda: f"tension:{self.one(*REGIONS)} {self.number(0, 0.5)}",
            "tension v_ramp"))  # fmt: skip

    def traction(self):
        p, x, y, z = (self.one(self.number(-0.1, 0.1), "v_ramp", "v_px") for _ in range(4))
        load = self.one(f"pressure {p}", f"vector {x} {y} {z}", f"pressure {p} vector {x} {y} {z}")
        self.fix("traction", f"{self.group()} dcm/traction {load} " + self.some(
            0.3, "region half", lambda: f"faces {self.one('lateral', 'apical basal')}"))

    def move(self):
        x, y, z, w = (self.one(self.number(-0.1, 0.1), "v_ramp", "v_px") for _ in range(4))
        turn = f"rotate {self.number(-9, 9)} 0 1 {self.one('0 0 1', '1 1 0', '0 0 0')} {w}"
        how = self.one(f"linear {x} {y} {z}", turn, f"linear 0 {y} 0 {turn}")
        self.fix("push", f"{self.group()} dcm/move {how}")

    def adapt(self):
        volume, rest = (self.one(self.number(0.8, 1.2), "v_near1") for _ in range(2))
        what = self.one(f"volume0 {volume}", f"rest {rest}", f"volume0 {volume} rest {rest}",
                        f"rest {rest} faces apical junction every {self.whole(1, 5)}")  # fmt: skip
        self.fix("adapt", f"{self.group()} dcm/adapt {what}")

    def remesh(self):
        quality = self.number(0.3, 0.9)
        self.fix("remesh", f"{self.group()} dcm/remesh every {self.whole(1, 5)} quality {quality} "
                 f"goal {self.one(0.9, 0.95)} distance {self.number(0.02, 0.4)} "
                 f"energy {self.number(0.05, 5)} carry {self.one('strain', 'load')}")  # fmt: skip

    def confine(self):
        pressure = self.maybe(0.5)
        what = (f"pressure {self.number(0.01, 0.3)} over deformable" if pressure else
                f"plane {self.one('x', 'y', 'z')} {self.number(0.1, 10)}")  # fmt: skip
        options = [
            lambda: f"tau {self.number(20, 600)}", lambda: f"axis {self.one('x', 'y', 'z')}",
            lambda: f"center {self.number(-3, 3)} {self.number(-3, 3)}",
            lambda: f"limit {self.number(1, 10)}", lambda: f"area {self.number(50, 300)}",
            lambda: f"hold {self.one('yes', 'no')}",
        ]  # fmt: skip
        if not pressure and not self.wild:
            options = [lambda: f"at {self.number(-3, 3)}"]
        self.fix("confine", f"all dcm/confine {what} {self.some(0.2, *options)}")

    def growth(self):
        self.fix("growth", f"{self.group()} dcm/growth {self.names()} seed {self.whole(1, 99)} "
                 + self.some(
                     0.5, lambda: f"cycle_time {self.number(3, 200)}",
                     lambda: f"cycle_sd {self.number(0, 1)}",
                     lambda: f"law {self.one('linear', 'exponential')}",
                     lambda: f"compression {self.number(0.05, 0.5)} {self.number(1, 4)}",
                     lambda: f"rounding {self.number(0, 0.5)} {self.number(0.5, 1)}",
                     lambda: f"until {self.one('rest', 'volume')}",
                     *[lambda: f"newborn {self.number(400, 450)}"] * bool(self.wild),
                     lambda: f"age {self.one('zero', 'random')}",
                     lambda: f"proliferating hepatoblast {self.number(0, 1)}"))  # fmt: skip

    def division(self):
        self.fix("division", f"all dcm/division seed {self.whole(1, 99)} " + self.some(
            0.4, lambda: "plane " + self.one("random", "long", f"given {self.point(1)}",
                                             "variable v_px v_py v_pz"),
            lambda: f"cbm {self.one('soften', 'truncate')} {self.number(1, 300)}",
            lambda: f"tolerance {self.number(1e-3, 0.1)}", lambda: f"maxiter {self.whole(50, 500)}",
            lambda: f"every {self.whole(1, 3)}", "log division.log"))  # fmt: skip

    def death(self):
        what = self.one("all", f"age {self.number(0, 5)}", "region half", "variable v_odd",
                        f"rate {self.number(0.005, 0.03)} seed 3")  # fmt: skip
        self.fix("death", f"{self.one('first', 'right', 'spheres', 'patch')} dcm/death {what} "
                 + self.some(0.4, lambda: f"shrink {self.number(1, 100)}",
                             lambda: f"every {self.whole(1, 3)}", "log death.log"))  # fmt: skip

    def convert(self):
        lumen = "osmosis" in self.fixes or bool(self.wild)
        rule = self.one(*["lumen osmosis 12 18"] * lumen, "region inner half", "variable v_form",
                        f"near first {self.number(5, 15)} {self.number(15, 25)}",
                        f"pressure {self.number(0.02, 0.1)} {self.number(-0.02, 0.02)}",
                        f"strain {self.number(0.1, 0.2)} {self.number(0, 0.1)}")  # fmt: skip
        self.fix("convert", f"{self.group()} dcm/convert dcm 1 2 3 1 1 cbm 4 {rule} " + self.some(
            0.4, lambda: f"mesh icosphere {self.whole(1, 1)}",
            lambda: f"rest {self.number(0.9, 1)}", lambda: f"every {self.whole(1, 3)}",
            lambda: f"hold {self.number(0, 5)}", lambda: f"seed {self.whole(1, 99)}"))  # fmt: skip
        if self.maybe(0.2):
            self.fix("again", f"{self.group()} dcm/convert dcm 1 2 3 1 1 cbm 4 "
                     + self.one("region inner half", "variable v_form"))  # fmt: skip

    def polarity(self):
        self.fix("polarity", f"{self.group()} dcm/polarity seed {self.whole(1, 99)} " + self.some(
            0.3, lambda: f"polar {self.number(0.3, 0.9)}",
            lambda: f"form {self.one('cone', 'belt')}",
            lambda: f"apical {self.number(0.6, 0.9)}",
            lambda: "basal " + self.one("none", self.number(0.6, 0.9)),
            lambda: "junction " + self.one("auto", "none", "0.2 0.5"),
            lambda: f"free {self.number(0.02, 0.5)}",
            lambda: f"sees {self.one('all', 'outside', 'lumen')}",
            lambda: f"weight {self.one('count', 'area')}",
            lambda: f"plane {self.one('none', 'x', 'y', 'z')}",
            lambda: "init " + self.one("random", "free", f"toward {self.point(5)}",
                                       "variable v_px v_py v_pz"),
            lambda: f"freeze {self.number(1, 100)}",
            lambda: f"every {self.whole(1, 3)}"))  # fmt: skip

    def osmosis(self):
        dilute = self.one("", "", f"dilute {self.number(10, 1000)}")
        what = self.one(
            f"pressure {self.number(0.01, 0.3)} {dilute}",
            "pressure v_ramp",
            f"solute rate {self.number(1e-6, 1e-3)} kT 2.5 "
            + self.some(0.7, "loss 100", lambda: f"least {self.number(0.1, 20)}"),
        )
        apical = ["apical 50"] * ("polarity" in self.fixes or bool(self.wild))
        marks = "tracer" if "tracer" in self.fixes and self.maybe(0.5) else "flood"
        self.fix("osmosis", f"{self.group()} dcm/osmosis {what} marks {self.one(marks)} "
                 + self.some(
                     0.3, lambda: "starter " + self.one(f"{self.point(3)} {self.number(3, 50)} "
                                                        f"{self.number(1, 99)}", *apical),
                     lambda: f"slab z {self.number(-5, -1)} {self.number(1, 5)}",
                     lambda: f"free {self.number(0.01, 0.5)}",
                     lambda: f"range {self.number(1, 10)}", lambda: f"secrete {self.group()}",
                     lambda: f"weight {self.one('free', 'full')}",
                     lambda: f"memory {self.one('yes', 'no')}",
                     lambda: f"ramp {self.number(1, 100)}", lambda: f"every {self.whole(1, 3)}",
                     lambda: f"longest {self.number(1, 100)}"))  # fmt: skip

    def constriction(self):
        lumen = ["lumen"] * ("osmosis" in self.fixes or bool(self.wild))
        if not lumen:
            lumen = ["born"]
            self.fix("constriction", "all dcm/constriction when born")
            return
        self.fix("constriction", f"{self.group()} dcm/constriction " + self.some(
            0.5, lambda: f"cap {self.number(0.5, 1)}", lambda: f"ribbon {self.number(0.5, 1)}",
            lambda: f"ramp {self.number(1, 300)}",
            lambda: "when " + self.one("born", *lumen, f"time {self.number(0, 5)}"),
            lambda: f"release {self.one('yes', 'no')}",
            lambda: f"every {self.whole(1, 3)}"))  # fmt: skip

    def signal(self):
        self.fix("signal", f"right dcm/signal from {self.one('first', 'patch')} to 6 7 8 "
                 f"{self.one('2 2', '')} time {self.one('0', '5', 'inf')} "
                 f"{'' if 'osmosis' in self.fixes else 'lumen no'} " + self.some(
                     0.4, lambda: f"area {self.number(0, 0.2)}",
                     lambda: f"lapse {self.one('reset', 'hold')}",
                     lambda: f"every {self.whole(1, 3)}", "join patch"))  # fmt: skip

    def tracer(self):
        self.fix("tracer", f"{self.group()} dcm/tracer type {self.whole(TRACER, TRACER)} "
                 f"number {self.whole(0, 20)} D {self.number(0.001, 0.1)} "
                 f"seed {self.whole(1, 99)} " + self.some(
                     0.25, lambda: f"drift {self.number(0, 0.5)}",
                     lambda: f"substeps {self.whole(1, 5)}",
                     lambda: f"slab z {self.number(-9, -5)} {self.number(5, 9)}",
                     lambda: f"bounce {self.whole(1, 40)}",
                     lambda: f"far {self.number(5, 30)} {self.one('delete', 'reflect')}",
                     lambda: f"slits {self.one('shut', 'open')}",
                     lambda: f"free {self.number(0.01, 0.3)}",
                     lambda: f"topup {self.one('yes', 'no')}",
                     lambda: f"death {self.one('delete', 'release')}"))  # fmt: skip

    def others(self):
        """Fixes of LAMMPS beside those of the package."""
        line = self.one(
            "all addforce 0.1 0 0", "first setforce 0 NULL 0", "all deform 1 x scale 0.99 remap x",
            "all balance 2 1.05 shift xyz 5 1.1", "all halt 3 v_ramp > 1e9",
            "all momentum 2 linear 1 1 1",
            "all nve", "all print 1 'x'", "all property/atom d_q ghost yes",
            "all ave/time 1 1 1 f_cell file ave.txt", "all viscous 0.1",
            "all recenter INIT INIT INIT", "all spring/self 1.0", "all store/state 1 x y z",
            "all wall/reflect zlo EDGE", "all bond/create 1 2 2 0.1 1",
            "all bond/break 1 1 0.1", "all deposit 1 4 1 77 region half",
            "all evaporate 1 1 half 9",
        )  # fmt: skip
        self.fix("other", line)

    EFFECTS = ("motility", "tension", "traction", "adapt", "confine", "growth", "division", "death",
               "polarity", "tracer", "osmosis", "constriction", "signal", "convert",
               "move", "remesh")  # fmt: skip

    def effects(self):
        chosen = [name for name in self.EFFECTS if self.maybe(0.2)]
        if "division" in chosen and "growth" not in chosen and self.maybe(0.9):
            chosen.insert(chosen.index("division"), "growth")
        if "constriction" in chosen and "polarity" not in chosen and self.maybe(0.9):
            chosen.insert(0, "polarity")
        if {"constriction", "tracer"} & set(chosen) and "remesh" in chosen and not self.wild:
            chosen.remove("remesh")  # an error of init()
        if self.maybe(0.15 if self.wild else 0.05):
            chosen.append("others")
        if self.wild and self.maybe(0.2):
            self.rng.shuffle(chosen)
        return chosen

    def variables(self):
        for line in (
            "variable ramp equal 0.01*step", "variable near1 atom 1+0.01*x",
            "variable px atom 0.3", "variable py atom id", "variable pz atom -0.2",
            "variable odd atom (mol%2)==1", "variable form atom x>0",
            "region half block 0 INF INF INF INF INF", "region inner block 3 INF INF INF INF INF",
        ):  # fmt: skip
            self.say(line)

    # --- output ---------------------------------------------------------------------------------

    CELL = [
        "volume", "volume0", "area", "pressure", "x", "y", "z", "vx", "vy", "vz", "contact_area",
        "free_area", "neighbors", "kind", "molecule", "mother", "generation", "birth", "phase",
        "axis1", "axis3", "long_x", "asphericity", "acylindricity", "anisotropy", "sphericity",
        "shape_index", "exx", "exy", "sxx", "szz", "syz",
    ]  # fmt: skip
    COLUMNS = {
        "growth": ["progress"], "polarity": ["ax", "px", "apical_area"],
        "osmosis": ["marked_area"], "constriction": ["constricted", "constriction"],
        "signal": ["signal", "fate"], "tracer": ["secretes"],
    }  # fmt: skip
    FACE = ["area", "contact_area", "free_area", "stress", "curvature", "nx", "ny", "nz", "region"]
    PAIR = ["molecule1", "molecule2", "force", "fx", "fy", "fz", "normal"]
    SCALARS = {
        "growth": ["f_growth"], "division": ["f_division[1]", "f_division[2]"],
        "death": ["f_death"], "tracer": ["f_tracer[1]", "f_tracer[2]"],
        "osmosis": ["f_osmosis[1]", "f_osmosis[5]"], "volume": ["f_volume[1]"],
        "signal": ["f_signal[1]"], "constriction": ["f_constriction[1]"],
        "polarity": ["f_polarity[1]"], "confine": ["f_confine[1]"], "motion": ["f_motion[1]"],
    }  # fmt: skip

    def output(self):
        rng, columns = self.rng, ["atoms", "bonds", "dihedrals", "ebond", "edihed"]
        known = [*self.CELL, *(c for f in self.fixes for c in self.COLUMNS.get(f, []))]
        values = " ".join(self.one(*known) for _ in range(rng.integers(1, 5)))
        self.say(f"compute c all dcm/cell volume {values}")
        self.say("compute cs all reduce sum c_c[1] c_c[2]")
        columns += ["c_cs[1]", "c_cs[2]"]
        if self.maybe(0.3):
            values = " ".join(self.one(*self.FACE) for _ in range(rng.integers(1, 4)))
            self.say(f"compute f all dcm/face area {values}")
            self.say("compute fs all reduce sum c_f[1]")
            columns.append("c_fs")
        if self.maybe(0.3):
            self.say(f"compute pairs all dcm/contact/local area {self.one(*self.PAIR)}")
            self.say("compute ps all reduce sum c_pairs[1] c_pairs[2] inputs local")
            columns += ["c_ps[1]", "c_ps[2]"]
        if "osmosis" in self.fixes and self.maybe(0.5):
            self.say("compute lumen all dcm/lumen " + self.some(
                0.3, lambda: f"plane z {self.number(-1, 1)}", lambda: f"min {self.number(1, 20)}",
                lambda: f"range {self.number(1, 9)}"))  # fmt: skip
            columns += ["c_lumen[1]"]
        for name in self.fixes:
            if name in self.SCALARS and self.maybe(0.5):
                columns += self.SCALARS[name]
        self.say("thermo_style custom step " + " ".join(columns))
        self.say("thermo_modify norm no format float %.12g flush yes lost/bond ignore")
        self.say("thermo 1")
        if self.maybe(0.2):
            self.say("dump d all custom 1 all.dump id mol type x y z vx fx c_c[*]")
        if self.maybe(0.05):
            self.say("dump i all image 2 i.*.ppm type v_diameter fix cell type 3 0.05 size 50 50")
            self.out.insert(-1, "variable diameter atom 1.0")

    def run(self, most=4):
        self.say(f"timestep {self.number(0.05, 2.0)}")
        self.say(f"run {self.rng.integers(0, most + 1)}")

    # --- what happens between runs ----------------------------------------------------------------

    def act(self):
        self.say(self.one(*self.acts()))

    def acts(self):
        name = pick(self.rng, [*self.fixes])
        g = self.group()
        some = self.some
        return [
            f"unfix {name}", f"unfix {name}\n{self.fixes[name]}", "reset_timestep 0",
            f"delete_atoms group {g} bond {self.one('yes', 'no')} "
            f"compress {self.one('no', 'yes')}",
            "delete_atoms group right bond yes compress no",
            f"displace_atoms {g} move {self.point(3)}",
            f"displace_atoms {g} rotate 0 0 0 0 0 1 {self.number(0, 360)}",
            f"change_box all x scale {self.number(0.5, 2)} y scale {self.number(0.8, 1.2)} "
            f"{self.one('', 'remap')}",
            f"change_box all boundary {self.one('p p p', 's s s', 'f f f')}",
            "change_box all triclinic", "reset_atoms id", "reset_atoms mol all",
            "reset_atoms image all",
            f"create_bonds many all all 1 {self.number(0.1, 1)} {self.number(1, 3)}",
            "create_bonds single/bond 1 2 9", "delete_bonds all bond 1",
            f"delete_bonds {g} bond 1 remove", "delete_bonds all multi any remove special",
            f"create_atoms {self.whole(1, 5)} single {self.point()}",
            "create_atoms 4 random 2 77 half", f"group {self.one('first', 'patch')} clear",
            f"group patch molecule {self.whole(1, 4)}", f"group patch type {self.whole(1, 8)}",
            "group first delete", "group moving dynamic all every 1 var odd",
            f"set group {g} mol {self.whole(0, 9)}", f"set group {g} type {self.whole(1, 8)}",
            f"set atom {self.whole(1, 99)} x {self.number(-9, 9)}",
            f"set group {g} image {self.whole(-1, 1)} 0 0", f"set group {g} diameter 1.0",
            f"set group {g} velocity 0 0 0", "mass * 2.0",
            f"neigh_modify {self.neigh()}", f"neighbor {self.number(0.3, 2)} {self.one('bin')}",
            f"comm_modify cutoff {self.number(5, 20)}", "comm_style tiled\nbalance 1.0 rcb",
            f"balance 1.0 shift {self.one('x', 'xyz', 'z')} 5 1.05", "newton off",
            f"fix_modify cell retype to 6 7 8 {self.one('2 2', '')} "
            f"molecule {self.whole(1, 3)} {some(0.3, 'join patch', 'leave first')}",
            f"fix_modify cell retype to 1 2 3 1 1 group {g}",
            "fix_modify cell rest/write new.rest",
            "fix_modify cell rest/write new.rest\nfix_modify cell rest/read new.rest",
            "fix_modify cell rest/read none.rest", f"fix_modify motion stop {self.number(1, 99)}",
            "fix_modify confine hold yes", f"fix_modify {name} {self.one('virial', 'energy')} yes",
            f"pair_style none\n{self.contact}\n{self.coeff}", "pair_style none",
            "bond_style none", "dihedral_style none", self.coeff, "replicate 2 1 1",
            "minimize 1e-4 1e-4 3 5", "write_data new.data\nread_data new.data add append",
            f"min_style {self.one('cg', 'fire', 'sd')}\nminimize 0 0 2 5",
            f"region half delete\nregion half sphere {self.point()} {self.number(5, 50)}",
            "variable odd delete", "variable odd atom id",
            f"variable form atom {self.number(-1, 1)}",
            "variable ramp equal 1/0", f"variable ramp equal {self.number(-1, 1)}",
            "compute c2 all dcm/cell volume phase\nthermo_style custom step",
            "uncompute c", "print '$(f_cell)'", "print '$(c_cs[1])'", "run 0 pre no",
            "run 2 pre no post no", "write_dump all custom x.dump id c_c[*]",
            "write_dump all custom x.dump id fx", "info all out log",
            "reset_atoms id sort yes", "run_style verlet", "run_style respa 2 2 bond 1",
            "timestep 1000", "timestep 1e-9", "dump_modify d every 2",
            f"create_cells single cbm cbm {self.point()} 3.0 cbm cbm 4",
            f"create_cells single hep dcm {self.point()} 4.0 dcm hep 1 2 3 1 1 mesh icosphere 1",
            *self.lives(), *(self.random_acts(g) if self.wild else []),
        ]  # fmt: skip

    def random_acts(self, g):
        """What LAMMPS does otherwise on other numbers of ranks."""
        return [f"displace_atoms {g} random 0.1 0.1 0.1 7", f"velocity {g} create 1.0 7",
                "package omp 1", "fix langevin all langevin 1 1 1 3"]  # fmt: skip

    def lives(self):
        """Stop and go on from a file."""
        again = [self.rebuild, *self.fixes.values()]
        if self.wild and self.maybe(0.5):
            self.rng.shuffle(again)
        after = "\n".join(again)
        laws = "\n".join(line for line in self.out
                         if line.startswith(("bond_", "dihedral_", "pair_")))  # fmt: skip
        variables = "\n".join(line for line in self.out if line.startswith("region half"))
        head = f"units lj\natom_style dcm\nnewton on\nboundary {self.boundary}\n"
        restart = f"write_restart new.restart\nclear\nread_restart new.restart\n{variables}\n"
        groups = "\n".join(line for line in self.out if line.startswith("group "))
        data = (
            f"write_data new.data nofix nocoeff\nclear\n{head}read_data new.data "
            f"extra/bond/per/atom 8 extra/dihedral/per/atom 8\n{groups}\n{variables}\n{laws}\n"
        )
        end = "\ntimestep 0.5\nthermo 1\n"
        return [
            f"{restart}{self.coeff}\n{after}{end}", f"{restart}{after}{end}",
            f"{data}{after}{end}", f"{data}fix cell all dcm/cell\nrun 0\n",
            f"fix_modify cell rest/write new.rest\n{data}{after}\n"
            f"fix_modify cell rest/read new.rest{end}",
            f"clear\n{head}", "write_restart new.restart\nread_restart new.restart",
            "dump r all custom 1 r.dump id type x y z\nrun 2\nundump r\n"
            "rerun r.dump dump x y z", "write_dump all custom r.dump id type x y z\n"
            "rerun r.dump dump x y z", "write_dump all custom r.dump id type x y z\n"
            "read_dump r.dump 0 x y z", "write_restart r.*.restart",
        ]  # fmt: skip

    # --- the whole deck -------------------------------------------------------------------------

    def text(self, acts=True):
        self.mapped = self.maybe(0.6)
        self.scene()
        self.variables()
        order = ["laws", "cell", "volume", *self.effects(), "motion"]
        if self.maybe(0.15 if self.wild else 0.03):  # any order of the fixes
            tail = order[2:]
            self.rng.shuffle(tail)
            order = order[:2] + tail
        if self.wild and self.maybe(0.15):
            self.rng.shuffle(order)
            order.remove(pick(self.rng, order))
            if "cell" not in order:
                self.fixes["cell"] = "fix cell all dcm/cell"
            if "laws" not in order:
                self.contact = self.coeff = self.rebuild = "pair_style none"
        for part in order:
            getattr(self, part)()
        self.output()
        self.run()
        if acts:
            for _ in range(int(self.rng.integers(0, 4))):
                self.act()
                self.run(3)
        self.say("write_dump all custom last.dump id x y z vx vy vz fx fy fz")
        return "\n".join(self.out) + "\n"
