"""Does `fix dcm/motion accuracy A` keep its promise on scenes that it was not made with, and what
does it cost against the best setting found by hand? tools/accuracy --verify."""
import csv
import math
import re
import shutil

import numpy as np

from . import decks
from .decks import EXAMPLES, MANY, put, swap, until
from .errors import error
from .points import Point
from .scenes import CELL_DUMP, SCENES, Migration, Quantity, Scene, diameter

TIGHT = "1e-8"
ACCURACIES = ("0.05", "0.02", "0.01")
BY_HAND = (*(f"implicit {dt}" for dt in ("60", "20", "10", "5", "2")),
           *(f"auto {x}" for x in ("0.1", "0.05", "0.02", "0.01", "0.005", "0.0025")))
FRAMES = 5       # times at which runs are compared
MOST = 1.5       # times the cost of the best setting by hand


def history(path):
    """Values of a dump with the columns of CELL_DUMP, by cell and frame, without the first frame:
    pressure, area, way and, as scale, diameter."""
    found = decks.frames(path)
    start = {m: np.array(w) for m, *w in zip(*(found[0][1][c] for c in ("mol", *"xyz")))}
    values = {"pressure": {}, "area": {}, "way": {}}
    for frame, (_, rows) in enumerate(found):
        for m, x, y, z, p, a in zip(*(rows[c] for c in ("mol", *"xyz", "pressure", "area"))):
            key, place = f"{m:.0f}.{frame}", np.array([x, y, z])
            start.setdefault(m, place)
            if frame == 0:
                continue
            values["pressure"][key], values["area"][key] = [float(p)], [float(a)]
            values["way"][key] = [float(v) for v in place - start[m]]
    return values | {"diameter": diameter(found[0][1]["volume"])}


# the atoms that stand for cells
MAPPED = """compute         kinds all property/atom kind
variable        stands atom (c_kinds>0)*(c_kinds<3)
group           mapped dynamic all var stands every 1
"""


class Unseen(Scene):
    """A shipped example with other parameters, by the pressures, contact areas and places of its
    cells at FRAMES times.

    deck: below examples; seconds: that are run; fine: step of the explicit reference; edits:
    (begin of a line, line in its place); options: of the command line; files: beside the deck."""

    quantities = (Quantity("pressure", "pressure", "kPa"),
                  Quantity("contact area", "area", "um^2"),
                  Quantity("center / diameter", "way", "um", "diameter"))
    defaults = dict(level="")

    def __init__(self, name, about, deck, seconds, fine, edits=(), options=(), files=(),
                 stop="run"):
        self.name, self.about, self.deck, self.stop = name, about, deck, stop
        self.hours = seconds / 3600.0
        self.seconds, self.fine, self.edits = seconds, fine, edits
        self.options, self.files = options, files

    def write(self, folder, s):
        text = until(decks.example(self.deck), self.stop)
        text = re.sub(r"^(dump\S*|thermo|thermo_style|reset_timestep)\s.*$", "", text, flags=re.M)
        for begin, line in self.edits:
            text = swap(text, begin, line)
        group = re.search(r"^fix\s+move\s+(\S+)\s+dcm/motion(.*)$", text, re.M)
        friction = re.search(r"friction_ecm \S+( floor \S+)?", group.group(2))
        text = swap(text, "fix move", f"fix move {group.group(1)} dcm/motion "
                    f"{friction.group(0) if friction else ''} {self.move(s)} "
                    f"stop {self.seconds:g}")
        text = swap(text, "timestep", decks.timestep(s["step"]))
        dump = put(CELL_DUMP, "map centers", "map mapped")
        text += put(dump.format(many=MANY, every=f"{self.seconds / FRAMES:g}"),
                    "compute         map all", MAPPED + "compute         map all")
        (folder / "in.run").write_text(text + f"thermo 1000\nrun {MANY}\n")
        for file in self.files:
            shutil.copy(EXAMPLES / file, folder)
        level = ["-var", "level", s["level"]] if s["level"] else []
        return [*self.options, *level]

    def read(self, folder):
        return history(folder / "cells.dump")

    def weight(self, settings):
        return self.hours


class Crawl(Migration):
    """The migration of the map, faster and with another contact law."""

    name, fine = "crawl", 0.25
    quantities = (Quantity("way of the crawler", "way", "um"),
                  Quantity("pressure", "pressure", "kPa"))

    def write(self, folder, settings):
        words = super().write(folder, settings | dict(law="foundation"))
        return [*words, "-var", "F", "20", "-var", "D", "5e-3", "-var", "seed", "5"]


NO = ("-var", "image", "no")
DIVIDING = ("-var", "level", "1", "-var", "movie", "no")
EXPERIMENT = ("experiments/start.lmp", "experiments/cell.lmp", "experiments/experiments.dcm")
FIRST = (
    Unseen("crowd", "cells grow and divide in a periodic box that they fill", "crowd/in.crowd",
           900, 1.0, options=NO, files=["crowd/cells.txt"]),
    Unseen("drops", "two cells with surface tension adhere", "tension/in.tension", 2000, 0.1,
           options=("-var", "w", "0.4", *NO)),
    Unseen("pushed", "spheres push a cell from two sides", "contact/in.border", 2000, 0.25,
           options=NO,
           edits=[("pair_coeff", "pair_coeff * * W 0 friction_normal 20 friction_tangential 20")]),
    Unseen("birth", "a cell divides, its daughters part", "division/in.division", 1500, 0.25,
           options=("-var", "level", "2", *NO)),
    Unseen("slow pair", "two cells adhere against high friction", "doublet/in.doublet", 6000, 0.5,
           options=("-var", "friction", "50", "-var", "law", "foundation", *NO)),
    Unseen("small pair", "two small cells of strong adhesion", "doublet/in.doublet", 2000, 0.125,
           edits=[("pair_coeff", "pair_coeff * * W 0.4 friction_normal 10 friction_tangential 10")],
           options=("-var", "R", "4.5", *NO)),
    Unseen("spheroid of 42", "one cell becomes four in 4.6 h, 42 nodes", "spheroid/in.spheroid",
           16560, 0.5, options=("-var", "cycle", "7200", "-var", "seed", "7", *DIVIDING)),
    Unseen("layer", "a cell grows in a pressed layer of cells and spheres",
           "resolution/in.resolution", 900, 0.5, files=["resolution/cells.txt"],
           options=NO, stop="run 1000000000"),
    Unseen("mother", "a cell that does not round up grows and divides", "acinus/in.acinus", 5400,
           0.5, edits=[("fix two", "")], files=["acinus/cells.txt"]),
    Crawl(),
)
# written when the accuracy of the program had got its present form, and not changed since
SECOND = (
    Unseen("other crowd", "the crowd with another seed and shorter cycles", "crowd/in.crowd", 900,
           1.0, options=("-var", "seed", "8", "-var", "cycle", "2400", *NO),
           files=["crowd/cells.txt"]),
    Unseen("wet drops", "two small drops that adhere strongly", "tension/in.tension", 1500, 0.1,
           options=("-var", "w", "0.8", "-var", "R", "5", "-var", "seed", "9")),
    Unseen("pushed stickily", "spheres push a cell that they adhere to", "contact/in.border", 2000,
           0.25, options=("-var", "W", "0.1", "-var", "law", "dmt", "-var", "force", "2")),
    Unseen("other birth", "a cell of a longer cycle divides",
           "division/in.division", 2400, 0.25, options=("-var", "level", "2", "-var", "cycle",
                                                        "2000", *NO)),
    Unseen("maugis pair", "two cells adhere by the law of Maugis", "doublet/in.doublet", 3000, 0.25,
           options=("-var", "friction", "20", "-var", "law", "maugis", "-var", "seed", "11", *NO)),
    Unseen("large pair", "two large cells of weak adhesion", "doublet/in.doublet", 3000, 0.25,
           edits=[("pair_coeff", "pair_coeff * * W 0.05 friction_normal 5 friction_tangential 5")],
           options=("-var", "R", "9", *NO)),
    Unseen("other spheroid of 42", "one cell becomes four in 3 h, 42 nodes",
           "spheroid/in.spheroid", 10800, 0.5,
           options=("-var", "cycle", "5000", "-var", "seed", "3", *DIVIDING)),
    Unseen("other mother", "the mother of another seed, law dmt", "acinus/in.acinus", 5400, 0.5,
           edits=[("fix two", "")], options=("-var", "seed", "4", "-var", "law", "dmt"),
           files=["acinus/cells.txt"]),
    Unseen("shock", "a cell swells by a third beside one that does not", "experiments/in.shock", 60,
           0.02, edits=[("thermo_modify", "")], files=EXPERIMENT),
    Unseen("thirteen", "thirteen cells round up to a spheroid", "experiments/in.compress", 600, 0.1,
           options=NO, files=[*EXPERIMENT, "experiments/compress.cells"]),
)
UNSEEN = {scene.name: scene for scene in FIRST + SECOND}
SCENES |= UNSEEN


def fine(scene):
    return dict(step=f"explicit {scene.fine:g}", tolerance=TIGHT)


def points():
    """All runs."""
    steps = [*BY_HAND, *(f"accuracy {a}" for a in ACCURACIES)]
    return [Point.of(s.name, **changes) for s in UNSEEN.values()
            for changes in (fine(s), *(dict(step=x, longest="60") for x in steps))]


def there(scene, reference):
    """Quantities of a scene that are not zero all the time, as contacts are of cells that do not
    touch."""
    return [q for q in scene.quantities if np.any([*reference.values[q.of].values()])]


def errors_of(scene, result, reference):
    """Relative error of each quantity, NaN where cells or events are not the same."""
    return {q.name: error(q, result.values, reference.values)[1]
            for q in there(scene, reference)}


def judge(look):
    """Rows: scene, accuracy, quantities within it and all, largest error and its quantity, CPU
    seconds, cheapest setting by hand that keeps it and its seconds. look: point -> result."""
    rows = []
    for scene in UNSEEN.values():
        reference = look(Point.of(scene.name, **fine(scene)))
        if reference is None or reference.note:
            rows.append([scene.name, "", 0, 0, math.nan,
                         reference.note if reference else "not run", math.nan, "", math.nan])
            continue
        hand = [(step, *outcome(scene, step, reference, look)) for step in BY_HAND]
        for a in ACCURACIES:
            found, seconds = outcome(scene, f"accuracy {a}", reference, look)
            within = sum(e <= float(a) for e in found.values())
            worst = max(found, key=lambda n, of=found: -1.0 if math.isnan(of[n]) else of[n])
            good = [(s, step) for step, e, s in hand
                    if all(x <= float(a) for x in e.values())]
            best = min(good, default=(math.nan, "none"))
            rows.append([scene.name, a, within, len(found), found[worst], worst, seconds, best[1],
                         best[0]])
    return rows


def outcome(scene, step, reference, look):
    """(relative error of each quantity, CPU seconds) of a run; NaN if it failed."""
    result = look(Point.of(scene.name, step=step, longest="60"))
    if result is None or result.note:
        return {q.name: math.nan for q in there(scene, reference)}, math.nan
    return errors_of(scene, result, reference), result.seconds


NAMES = ("scene", "accuracy", "kept", "quantities", "largest error", "of", "CPU s",
         "best by hand", "its CPU s")


def verdict(rows):
    """Lines for both sets: share of quantities within the promise, cost against the best setting
    by hand."""
    lines = []
    for title, scenes in (("first ten", FIRST), ("second ten", SECOND)):
        names = {scene.name for scene in scenes}
        lines += [f"{title}, {line}" for line in promises([r for r in rows if r[0] in names])]
    return lines


def promises(rows):
    """A line for each accuracy."""
    lines = []
    for a in ACCURACIES:
        mine = [r for r in rows if r[1] == a]
        kept, every = sum(r[2] for r in mine), sum(r[3] for r in mine)
        ratios = sorted(r[6] / r[8] for r in mine if r[8] == r[8] and r[6] == r[6])
        dear = sum(x > MOST for x in ratios)
        middle = ratios[len(ratios) // 2] if ratios else math.nan
        lines.append(f"accuracy {a}: {kept} of {every} quantities within it; CPU time against the "
                     f"best setting by hand that keeps it: {middle:.2f} times (median of "
                     f"{len(ratios)} scenes), more than {MOST:g} times in {dear}")
    return lines


def plain(value):
    """A cell of the table."""
    if not isinstance(value, float):
        return value
    return "-" if math.isnan(value) else f"{value:.3g}"


def table(rows):
    """The rows as text."""
    return "\n".join("  ".join(f"{plain(v)!s:>{max(9, len(n))}}" for n, v in zip(NAMES, row))
                     for row in [NAMES, *rows])


def write(rows, path):
    """The rows as CSV."""
    with open(path, "w", newline="", encoding="ascii") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(NAMES)
        writer.writerows([plain(v) for v in row] for row in rows)
