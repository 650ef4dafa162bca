"""Which setting takes which values in which scene, one at a time, all others at their defaults."""
from dataclasses import dataclass

from .points import Point


@dataclass(frozen=True)
class Value:
    """label: as the user writes it; x: number that the order refers to, None if there is none;
    changes: settings; against: changes of the runs it is compared with, None for the knob's."""

    label: str
    x: float | None
    changes: dict
    against: dict | None = None


@dataclass(frozen=True)
class Knob:
    """Values of a setting in a scene.

    values: coarse to fine
    reference: changes of the runs that all values are compared with; None: each has its own
    check, ratio: changes of the second finest ones, which tell the uncertainty of the reference,
        and by how much smaller the reference's error is than theirs
    order: expected of the error in x
    seeds: orientations of the meshes that means are over
    paired: runs are compared with the reference of the same orientation, and the error is the root
        mean square over orientations; else their means are
    kind: time (steps, all against one reference, so that they can be compared among each other),
        solver, space, look, division, marks, border; model (a difference, not an error); cost (no
        error but round-off)
    """

    name: str
    scene: str
    kind: str
    values: tuple
    reference: dict | None
    check: dict | None = None
    ratio: float = 2.0
    order: float | None = None
    seeds: tuple = ({},)
    paired: bool = False

    def runs(self, changes):
        """Points with these changes, one per orientation."""
        return [Point.of(self.scene, **(changes | seed)) for seed in self.seeds]

    def points(self):
        """Every point that the knob needs."""
        every = [v.changes for v in self.values]
        every += [v.against for v in self.values if v.against is not None]
        every += [c for c in (self.reference, self.check) if c is not None]
        return [p for changes in every for p in self.runs(changes)]

    def is_default(self, value):
        return self.runs(value.changes)[0] == Point.of(self.scene, **self.seeds[0])


TIGHT = "1e-8"
AUTO = ("0.1", "0.05", "0.02", "0.01", "0.005", "0.0025")
NODES = {"1": 42, "2": 162, "3": 642, "4": 2562, "5": 10242}


def motion_knobs(scene, explicit, implicit, finest, longest, auto=AUTO, tolerances=True):
    """Knobs of fix dcm/motion: steps of three schemes against explicit steps of `finest` s, and
    the tolerance of the solver. explicit, implicit: steps in s; longest: `max` of dt auto that are
    tried at the default tol."""
    found, fine = [], dict(step=f"explicit {finest:g}", tolerance=TIGHT)
    near = dict(step=f"explicit {2 * finest:g}", tolerance=TIGHT)
    for kind, steps in (("explicit", explicit), ("implicit", implicit)):
        values = tuple(Value(f"{kind} {dt:g} s", dt, dict(step=f"{kind} {dt:g}")) for dt in steps)
        found.append(Knob(f"dt, {kind}", scene, "time", values, fine, near, order=1.0))
    # a step may leave X sqrt(h/B) and leaves about h^2: h as X^(2/3), errors of first order in h
    values = tuple(Value(f"auto tol {x}", float(x), dict(step=f"auto {x}")) for x in auto)
    found.append(Knob("dt auto tol", scene, "time", values, fine, near, order=2.0 / 3.0))
    values = tuple(Value(f"accuracy {a}", float(a), dict(step=f"accuracy {a}"))
                   for a in ("0.1", "0.05", "0.02", "0.01", "0.005"))
    found.append(Knob("accuracy", scene, "time", values, fine, near, order=1.0))
    if longest:
        values = tuple(Value(f"max {m} s", float(m), dict(step="auto 0.02", longest=m))
                       for m in longest)
        found.append(Knob("dt auto max", scene, "time", values, fine, near))
    if tolerances:
        values = tuple(Value(f"tolerance {t}", float(t), dict(tolerance=t))
                       for t in ("1e-1", "1e-2", "1e-3", "1e-4", "1e-5", "1e-6"))
        found.append(Knob("solver tolerance", scene, "solver", values, dict(tolerance="1e-10"),
                          dict(tolerance="1e-8"), ratio=100.0, order=1.0))
    return found


def mesh(scene, finest, seeds, name="mesh", **also):
    """Levels 1 to `finest` of the icosphere against the finest, means over orientations."""
    values = tuple(Value(f"{NODES[str(k)]} nodes", 2.0**-k, dict(level=str(k)) | also)
                   for k in range(1, finest))
    return Knob(name, scene, "space", values, dict(level=str(finest)) | also,
                dict(level=str(finest - 1)) | also, 4.0, 2.0, seeds)


def turned(*seeds):
    return tuple(dict(seed=str(s)) for s in seeds)


PAIRS = tuple(dict(seed=str(a), other=str(b)) for a, b in
              ((3, 11), (5, 7), (13, 17), (23, 29), (31, 37), (41, 43)))


def doublet(full):
    rest = dict(pull="no")
    knobs = motion_knobs("doublet", (0.25,), (0.5, 1, 2, 4, 8), 0.0625, ())
    # the pull counts steps of one length: with dt auto only the rest is there
    knobs = [k if k.name not in ("dt auto tol", "accuracy") else Knob(
        k.name, k.scene, k.kind, tuple(Value(v.label, v.x, v.changes | rest) for v in k.values),
        k.reference, k.check, k.ratio, k.order) for k in knobs]
    # a contact that grows: its rim moves face by face, which mean velocities of cells do not tell
    for name, more in (("dt auto max", {}), ("dt auto max, friction 50", dict(friction="50"))):
        fine = more | dict(tolerance=TIGHT) | rest
        knobs.append(Knob(name, "doublet", "time", tuple(
            Value(f"max {m} s", float(m), more | dict(step="auto 0.02", longest=str(m)) | rest)
            for m in (60, 30, 20, 10, 5, 2)), fine | dict(step="explicit 0.0625" if not more else
                                                          "explicit 0.25"),
            fine | dict(step="explicit 0.125" if not more else "explicit 0.5"), order=1.0))
    top = 4 if full else 3
    knobs.append(mesh("doublet", top, PAIRS if not full else PAIRS[:3]))
    knobs.append(mesh("doublet", top, PAIRS if not full else PAIRS[:3], "mesh at h0 0.8", h0="0.8"))
    knobs.append(Knob("h0 / edge", "doublet", "space", tuple(
        Value(f"h0 {h} um, 162 nodes", float(h) / 1.82, dict(h0=h) | rest,
              dict(h0=h, level=str(top)) | rest)
        for h in ("0.1", "0.2", "0.3", "0.4", "0.6", "0.8")), None, seeds=PAIRS[:4]))
    knobs.append(Knob("layer", "doublet", "model", tuple(
        Value(f"layer {x} um", float(x), dict(layer=x)) for x in ("0.4", "0.2", "0.1", "0.05")),
        dict(layer="0.025"), dict(layer="0.05"), order=1.0))
    knobs.append(Knob("law", "doublet", "model", tuple(
        Value(f"law {x}", None, dict(law=x)) for x in ("foundation", "dmt", "maugis")), {}))
    knobs.append(facing("doublet"))
    for law in ("dmt",):
        knobs.append(Knob(f"dt, explicit, law {law}", "doublet", "time", tuple(
            Value(f"explicit {dt:g} s", dt, dict(law=law, step=f"explicit {dt:g}"))
            for dt in (2, 1, 0.5)), dict(law=law, step="explicit 0.125", tolerance=TIGHT),
            dict(law=law, step="explicit 0.25", tolerance=TIGHT), order=1.0))
    knobs.append(Knob("Gauss points, law maugis", "doublet", "space", tuple(
        Value(f"points {n}", None, dict(law="maugis", points=n)) for n in ("1", "2", "3")),
        dict(law="maugis", points="4"), dict(law="maugis", points="3"), ratio=2.0))
    return knobs


def facing(scene):
    """Angles between which tilted faces fade out, against the default, 40 to 50 degrees."""
    return Knob("facing window", scene, "model", tuple(
        Value(f"facing {a}", None, dict(facing=a))
        for a in ("20 30", "30 40", "35 55", "45 60", "60 75", "75 89")), {})


def compress(full):
    knobs = motion_knobs("compress", (0.5, 0.25, 0.125), (20, 10, 8, 4, 2, 1, 0.5), 0.03125,
                         ("60", "30", "20", "10", "5", "2"))
    top = 5 if full else 4
    knobs.append(mesh("compress", top, turned(3, 5, 7, 11)))
    knobs.append(Knob("layer", "compress", "model", tuple(
        Value(f"layer {x} um", float(x), dict(layer=x)) for x in ("0.4", "0.2", "0.1", "0.05")),
        dict(layer="0.025"), dict(layer="0.05"), order=1.0))
    knobs.append(Knob("law", "compress", "model", tuple(
        Value(f"law {x}", None, dict(law=x)) for x in ("foundation", "dmt", "maugis")), {}))
    return knobs


def spheroid(full):
    knobs = motion_knobs("spheroid", (2, 1, 0.5), (60, 20, 10, 5, 2, 1), 0.25,
                         ("120", "60", "30", "20", "10"))
    knobs.append(mesh("spheroid", 5 if full else 4, turned(1, 2, 3, 4)))
    knobs.append(facing("spheroid"))
    knobs.append(Knob("tolerance of division", "spheroid", "division", tuple(
        Value(f"tolerance {t}", float(t) if float(t) > 1e-4 else None, dict(division=t))
        for t in ("0.1", "0.01", "0.003", "1e-3", "3e-4", "1e-5")), dict(division="1e-4"),
        dict(division="3e-4"), ratio=3.0, order=1.0))
    return knobs


def bile_duct(full):
    knobs = motion_knobs("bile_duct", (2, 1), (60, 20, 10, 5, 2.5), 0.25,
                         ("120", "60", "30", "20", "10"))
    knobs.append(facing("bile_duct"))
    knobs.append(mesh("bile_duct", 4, turned(1, 2, 3) if full else turned(1, 2)))
    knobs.append(Knob("neighbor skin", "bile_duct", "cost", tuple(
        Value(f"skin {x} um", float(x), dict(skin=x)) for x in ("0.3", "0.5", "1.0", "1.5", "2.0")),
        {}))
    knobs.append(Knob("neighbor skin, tight", "bile_duct", "cost", tuple(
        Value(f"skin {x} um, tolerance 1e-12", float(x),
              dict(skin=x, step="implicit 10", tolerance="1e-12")) for x in ("0.3", "0.5", "2.0")),
        dict(step="implicit 10", tolerance="1e-12")))
    return knobs


def lumen(full):
    knobs = motion_knobs("lumen", (1, 0.5), (10, 5, 2.5, 1), 0.25, ("60", "20", "10", "5"))
    knobs.append(mesh("lumen", 4 if full else 3, turned(1, 2, 3, 4)))
    # when a cell has a face marked decides when the lumen opens: there is no order
    fine = dict(step="implicit 1")
    for fix in ("osmosis", "polarity"):
        knobs.append(Knob(f"every, fix dcm/{fix}", "lumen", "look", tuple(
            Value(f"every {n}, steps of 1 s", float(n), fine | {fix: str(n)})
            for n in (60, 20, 10, 5, 2)), fine | {fix: "1"}, fine | {fix: "2"}))
    knobs.append(Knob("longest, fix dcm/osmosis", "lumen", "time", tuple(
        Value(f"longest {x} s", float(x), dict(fluid=x)) for x in ("60", "20", "10", "5", "2")),
        dict(step="explicit 0.25", tolerance=TIGHT), dict(step="explicit 0.5", tolerance=TIGHT)))
    tracer = dict(marks="tracer", substeps="10")
    knobs.append(Knob("tracers", "lumen", "marks", tuple(
        Value(f"{n} tracers a cell", float(n), tracer | dict(number=str(n)))
        for n in ((60, 125, 250, 500, 1000) + ((2000,) if full else ()))),
        tracer | dict(number="4000" if full else "2000"),
        tracer | dict(number="2000" if full else "1000"), 2.0**0.5, -0.5, turned(1, 2, 3), True))
    # marks depend on where tracers are at a look: substeps are part of the model
    knobs.append(Knob("steps of tracers", "lumen", "model", tuple(
        Value(f"{n} substeps", 1.0 / n, dict(marks="tracer", substeps=str(n)))
        for n in (1, 2, 5, 20, 40)), dict(marks="tracer", substeps="10"), seeds=turned(1, 2, 3),
        paired=True))
    knobs.append(Knob("marks", "lumen", "model", (
        Value("marks flood", None, {}), Value("marks tracer", None, tracer)), {},
        seeds=turned(1, 2, 3), paired=True))
    return knobs


def migration(full):
    knobs = motion_knobs("migration", (2, 1, 0.5), (20, 10, 5, 2, 1), 0.125, ())
    knobs.append(mesh("migration", 4 if full else 3, turned(3, 5, 7, 11)))
    return knobs


def border(full):
    values = tuple(Value(f"border {b}", None, dict(border=b)) for b in ("none", "0", "1", "2", "3"))
    return [Knob("border", "border", "border", values, dict(border="all"),
                 seeds=turned(1, 2, 3) if full else turned(1, 2), paired=True)]


SETS = dict(doublet=doublet, compress=compress, spheroid=spheroid, bile_duct=bile_duct, lumen=lumen,
            migration=migration, border=border)


def knobs_of(scene, full=False):
    """Knobs of a scene."""
    return SETS[scene](full)
