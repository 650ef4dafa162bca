"""What the runs come to, as text and as the CSV files of doc/accuracy."""
import csv
import math
import textwrap
from dataclasses import astuple, fields

import numpy as np

from .errors import Row, beaten, cheapest, front, heads, measure, orders
from .knobs import knobs_of
from .scenes import SCENES

TARGETS = (0.05, 0.01)
TIME = ("time", "solver")     # kinds of knobs of the motion: compared with one reference


def percent(value, digits=2):
    """Text of a relative number, in percent."""
    return "-" if value != value else f"{100.0 * value:.{digits}g}"


def number(value):
    return "-" if value is None or value != value else f"{value:.3g}"


class Map:
    """Everything measured of a scene. knobs; rows: of each knob, by name; motion: heads of all
    knobs of the motion against the time reference (front, defaults)."""

    def __init__(self, scene, look, full=False):
        self.scene, self.look = scene, look
        self.knobs = knobs_of(scene, full)
        self.rows = {k.name: measure(k, look) for k in self.knobs}
        self.heads = {name: heads(rows) for name, rows in self.rows.items()}
        self.motion = self.against_time()

    def against_time(self):
        """Heads of every value of the motion's knobs, all against the finest explicit steps; what
        has not all quantities that the default has is left out, as a shorter run is no cheaper."""
        fine = next((k for k in self.knobs if k.kind == "time" and k.reference), None)
        found = {}
        for knob in self.knobs:
            if fine is None or knob.kind not in TIME or knob.name.endswith("law dmt"):
                continue
            same = type(knob)(knob.name, knob.scene, knob.kind, knob.values, fine.reference,
                              fine.check, fine.ratio, knob.order)
            for head in heads(measure(same, self.look)):
                found.setdefault(head.row.label, head)
        heads_ = [h for h in found.values() if h.known]
        like = next((h.known for h in heads_ if h.row.default), None)
        return [h for h in heads_ if like is None or h.known == like]

    def front(self):
        """Heads of the motion on the front, cheap to dear."""
        points = [(h.row.relative, h.row.cost) for h in self.motion]
        return [self.motion[k] for k in front(points)]

    def default(self):
        """Head of the default among the motion's, None if it was not run."""
        return next((h for h in self.motion if h.row.default), None)

    def better_than_default(self):
        """Heads of the motion that are clearly better than the default in both."""
        default = self.default()
        if default is None:
            return []
        points = [(h.row.relative, h.row.cost) for h in self.motion]
        return [self.motion[k] for k in beaten((default.row.relative, default.row.cost), points)]

    def budget(self):
        """Heads at the default, one per knob that has an error there: step once, then others."""
        found, kinds = [], set()
        for knob in self.knobs:
            if knob.kind in ("model", "cost") or "law" in knob.name:
                continue
            for head in self.heads[knob.name]:
                if head.row.default and head.row.relative == head.row.relative:
                    if knob.kind == "time" and "time" in kinds:
                        continue
                    kinds.add(knob.kind)
                    found.append(head)
        return found

    def unit(self):
        return "s/h" if SCENES[self.scene].hours else "s"

    def summary(self):
        """What the default leaves: dict of texts, a row of the summary table."""
        default = self.default()
        mesh = next((h for h in self.heads.get("mesh", []) if h.row.default), None)
        found = {"scene": self.scene, "default costs": "-", "steps": "-", "median": "-"}
        if default:
            found |= {"default costs": f"{number(default.row.cost)} {self.unit()}",
                      "steps": f"{percent(default.row.relative)} ({default.which})",
                      "median": percent(default.median)}
        elif self.budget():
            found["default costs"] = f"{number(self.budget()[0].row.cost)} {self.unit()}"
        found |= {"mesh": "-", "one orientation": "-"}
        if mesh:
            found |= {"mesh": f"{percent(mesh.row.relative)} ({mesh.which})",
                      "one orientation": f"{percent(mesh.row.low)} to {percent(mesh.row.high)}"}
        found["half the error"] = self.half()
        return found

    def costs(self):
        """What 5 % and 1 % cost: dict of texts."""
        found = {"scene": self.scene}
        for name, heads_ in (("steps", self.motion), ("mesh", self.heads.get("mesh", []))):
            known = [h.row for h in heads_ if h.row.relative == h.row.relative]
            least = min(known, key=lambda r: r.relative, default=None)
            for target in TARGETS:
                best = cheapest(known, target)
                found[f"{100 * target:g} %, {name}"] = (
                    f"{number(best.cost)} {self.unit()}: {best.label}" if best else
                    f"not reached; {percent(least.relative)} %: {number(least.cost)} {self.unit()}"
                    if least else "-")
        return found

    def table(self):
        """Rows of the scene's table: setting, value, error, its quantity, median, band, time,
        steps, and what it is."""
        ahead, found = {id(h.row) for h in self.front()}, []
        best = {h.row.label for h in self.motion if id(h.row) in ahead}
        for knob in self.knobs:
            for head in self.heads[knob.name]:
                row = head.row
                if row.note:
                    found.append([knob.name, row.label, "failed", "", "", "", "", "", ""])
                    continue
                marks = ["default"] * row.default
                marks += ["front"] * (knob.kind in TIME and row.label in best)
                marks += ["below ref"] * bool(row.relative <= row.uncertain)
                band = f"{percent(row.low)} to {percent(row.high)}" if row.runs > 1 else ""
                found.append([knob.name, row.label, percent(row.relative), row.quantity,
                              percent(head.median), band, number(row.cost), f"{row.steps:.0f}",
                              ", ".join(marks)])
        return found

    def half(self):
        """What half of the largest error at the default would cost, as a factor."""
        budget = self.budget()
        if not budget:
            return "-"
        worst = max(budget, key=lambda h: h.row.relative)
        rows = [h.row for h in self.heads[worst.row.knob]]
        if worst.row.kind in TIME:
            rows = [h.row for h in self.motion]
        best = cheapest(rows, 0.5 * worst.row.relative)
        if best is None:
            return f"{worst.row.knob}: finer than what was run"
        return f"{number(best.cost / worst.row.cost)} x: {best.label}"


def order_rows(map_):
    """(knob, expected, quantity, orders from coarse to fine) of what has an order."""
    found = []
    for knob in map_.knobs:
        if knob.order is None:
            continue
        finest = 0.0
        if knob.kind == "space":
            finest = 0.5 * min(v.x for v in knob.values)
        for q in SCENES[map_.scene].quantities:
            mine = [r for r in map_.rows[knob.name] if r.quantity == q.name]
            steps = orders(mine, finest)
            if steps:
                found.append((knob.name, f"{knob.order:.2g}", q, [p for _, _, p in steps]))
    return found


def order_table(map_):
    """Rows of the table of orders: scene, setting, expected, median over the head quantities of
    the order between the two finest values, the same one pair coarser, smallest and largest, how
    many quantities."""
    found, rows = [], order_rows(map_)
    for name, expected in dict.fromkeys((r[0], r[1]) for r in rows):
        steps = [r[3] for r in rows if r[0] == name and r[2].head]
        last = [s[-1] for s in steps if s and math.isfinite(s[-1])]
        before = [s[-2] for s in steps if len(s) > 1 and math.isfinite(s[-2])]
        if last:
            found.append([map_.scene, name, expected, f"{np.median(last):.2f}",
                          f"{np.median(before):.2f}" if before else "-",
                          f"{min(last):.2f} to {max(last):.2f}", len(last)])
    return found


ADHESION = [q for q in SCENES["doublet"].quantities if q.of != "distance"]


def adhesion(map_):
    """Rows of what two cells that adhere come to with steps of each length: values, not errors."""
    found = []
    for name in ("dt, explicit", "dt, implicit", "dt, explicit, law dmt"):
        knob = next(k for k in map_.knobs if k.name == name)
        ends = [(v.label, v.changes) for v in knob.values]
        if name != "dt, implicit":
            ends.append((f"{knob.reference['step']} s", knob.reference))
        for label, changes in ends:
            result = map_.look(knob.runs(changes)[0])
            if result and not result.note:
                law = changes.get("law", "foundation")
                found.append([law, label, *(f"{result.values[q.of][''][0]:.4g}" for q in ADHESION)])
    return found


def write(path, names, rows):
    """A CSV file."""
    with open(path, "w", encoding="ascii", newline="") as handle:
        writer = csv.writer(handle, lineterminator="\n")
        writer.writerow(names)
        writer.writerows(rows)


def plain(value):
    """Numbers of three digits, so that files do not change in the last ones."""
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.4g}"
    return value


def write_all(maps, folder):
    """points.csv, summary.csv, costs.csv, orders.csv, off_front.csv, failed.csv, a table of every
    scene, and adhesion.csv of the doublet."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = [row for m in maps for part in m.rows.values() for row in part]
    write(folder / "points.csv", [f.name for f in fields(Row)],
          [[plain(v) for v in astuple(row)] for row in rows])
    for name, table in (("summary", [m.summary() for m in maps]),
                        ("costs", [m.costs() for m in maps])):
        write(folder / f"{name}.csv", list(table[0]), [list(t.values()) for t in table])
    for m in maps:
        time = "s of CPU / h" if SCENES[m.scene].hours else "s of CPU"
        write(folder / f"{m.scene}.csv", ["setting", "value", "error, %", "of", "median, %",
                                          "one orientation, %", time, "steps", "is"], m.table())
        if m.scene == "doublet":
            write(folder / "adhesion.csv", ["law", "steps", *(q.name for q in ADHESION)],
                  adhesion(m))
    write(folder / "orders.csv", ["scene", "setting", "expected", "found", "one pair coarser",
                                  "smallest to largest", "quantities"],
          [r for m in maps for r in order_table(m)])
    off = []
    for m in maps:
        default = m.default()
        for h in m.better_than_default():
            off.append([m.scene, default.row.label, percent(default.row.relative),
                        number(default.row.cost), h.row.label, percent(h.row.relative),
                        number(h.row.cost)])
    write(folder / "off_front.csv", ["scene", "default", "error, %", "costs, s/h or s", "better",
                                     "its error, %", "costs, s/h or s"], off)
    failed = sorted({(r.scene, r.knob, r.label, r.note) for r in rows if r.note})
    write(folder / "failed.csv", ["scene", "setting", "value", "why"], failed)


SECTION = """{name}
{line}

{what}

.. image:: /img/accuracy_{name}.png
   :alt: error against time of the settings in this scene, and what the default's error is made of

.. csv-table::
   :file: {name}.csv
   :header-rows: 1

"""


def sections(maps):
    """The part of the manual's page that has a picture and a table per scene: text."""
    found = ""
    for m in maps:
        scene = SCENES[m.scene]
        values = ", ".join(f"*{k}* {v}" for k, v in scene.settings({}).items() if v)
        what = (f"{scene.about[0].upper()}{scene.about[1:]}.  Radius of the cells "
                f"{scene.radius:g} um.  Defaults: {values}.")
        found += SECTION.format(name=m.scene, line="^" * len(m.scene),
                                what=textwrap.fill(what, 98, break_on_hyphens=False))
    return found


def text(map_):
    """All of a scene as a plain table: relative errors in percent."""
    scene = SCENES[map_.scene]
    lines = [f"=== {map_.scene}: {scene.about}; radius {scene.radius:g} um; times in s of CPU "
             + ("per hour of biology" if scene.hours else "per run"),
             "defaults: " + " ".join(f"{k}={v}" for k, v in scene.settings({}).items() if v),
             "errors in percent; (low-high): of single orientations; ref: uncertainty of the "
             "reference"]
    for knob in map_.knobs:
        lines.append(f"--- {knob.name}")
        for head in map_.heads[knob.name]:
            row = head.row
            mark = "*" if row.default else " "
            if row.note:
                lines.append(f" {mark}{row.label:28s} FAILED: {row.note[:100]}")
                continue
            parts = []
            for r in head.rows:
                if r.relative != r.relative:
                    continue
                band = f" ({percent(r.low)}-{percent(r.high)})" if r.runs > 1 else ""
                parts.append(f"{r.quantity} {percent(r.relative)}{band}")
            lines.append(f" {mark}{row.label:28s} {number(row.cost):>8s} s {row.steps:8.0f} steps: "
                         + "; ".join(parts))
        known = {r.quantity: r.uncertain for r in map_.rows[knob.name] if np.isfinite(r.uncertain)}
        if known:
            lines.append("  ref: " + "; ".join(f"{q} {percent(u)}" for q, u in known.items()))
    lines.append("orders (expected: found, coarse to fine):")
    lines += [f"  {name:20s} {q.name:34s} {expected:>5s}: "
              + "; ".join("-" if math.isnan(p) else f"{p:.2f}" for p in steps)
              for name, expected, q, steps in order_rows(map_)]
    lines.append("front of steps: " + "; ".join(
        f"{h.row.label} {percent(h.row.relative)} % {number(h.row.cost)} s" for h in map_.front()))
    lines += [f"default beaten by {h.row.label}: {percent(h.row.relative)} % {number(h.row.cost)} s"
              for h in map_.better_than_default()]
    lines += [f"{k}: {v}" for k, v in (map_.summary() | map_.costs()).items()]
    return "\n".join(lines) + "\n"
