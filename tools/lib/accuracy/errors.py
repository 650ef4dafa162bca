"""Errors of runs against a reference, their uncertainty, orders of convergence, and the front of
what no other run beats in both error and time."""
import math
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from .scenes import SCENES

CLEAR = 3.0       # an error counts for an order if it is so many times the reference's uncertainty
# one run beats another if error and time are both less than this of the other's: times scatter by
# a quarter from one run to the next
BETTER_ERROR, BETTER_TIME = 0.9, 0.75


def mean_of(results):
    """Mean of the values of several results: name -> key -> array; only what all of them have."""
    first, found = results[0].values, {}
    for name, cells in first.items():
        tables = [r.values.get(name, {}) for r in results]
        keys = [k for k in cells if all(k in t for t in tables)]
        if len(keys) == len(cells) == max(map(len, tables)):
            found[name] = {k: np.mean([t[k] for t in tables], axis=0) for k in keys}
    return found


def rms(cells):
    """Root mean square, over cells, of the length of their values."""
    return math.sqrt(np.mean([np.sum(np.square(v)) for v in cells.values()]))


def error(quantity, values, reference):
    """(in its unit, relative) of values against a reference; NaN if one of them has not the
    quantity, or not the same cells or events."""
    found, right = values.get(quantity.of), reference.get(quantity.of)
    if not found or not right or found.keys() != right.keys():
        return math.nan, math.nan
    own = rms({k: np.subtract(found[k], right[k]) for k in right})
    scale = rms(reference[quantity.scale]) if quantity.scale else rms(right)
    return own, own / scale if scale > 0.0 else math.nan


@dataclass
class Row:
    """One value of a knob, one quantity. own, relative: error of the mean over orientations, in
    the quantity's unit and relative; low, high: smallest and largest relative one of a single
    orientation; uncertain: what the reference may be off, relative; seconds: user CPU time of a
    run; cost: the same per hour of biology, or per run."""

    scene: str
    knob: str
    kind: str
    label: str
    x: float | None
    quantity: str
    unit: str
    head: bool
    own: float = math.nan
    relative: float = math.nan
    low: float = math.nan
    high: float = math.nan
    uncertain: float = math.nan
    seconds: float = math.nan
    cost: float = math.nan
    steps: float = math.nan
    runs: int = 0
    default: bool = False
    note: str = ""


def good(results):
    """Results of runs that came to their end, None if one is missing or failed."""
    return results if results and all(r is not None and not r.note for r in results) else None


def pairs(q, results, reference):
    """Errors of runs, each against the reference of the same orientation: (runs, 2), in the
    quantity's unit and relative."""
    return np.array([error(q, r.values, right.values) for r, right in zip(results, reference)])


def root_mean_square(values):
    return np.sqrt(np.mean(np.square(values), axis=0))


def uncertainty(q, knob, right, reference, check):
    """Of the mean `right` of the reference's runs, relative: what the next coarser runs say, and
    the standard error of a mean over orientations; NaN if nothing tells it."""
    found = math.nan
    if check and knob.paired:
        return root_mean_square(pairs(q, check, reference))[1] / (knob.ratio - 1.0)
    if check:
        found = error(q, mean_of(check), right)[1] / (knob.ratio - 1.0)
    if len(reference) > 1 and not knob.paired:
        each = [error(q, r.values, right)[1] for r in reference]
        scatter = math.sqrt(np.mean(np.square(each)) / (len(each) - 1))
        found = scatter if math.isnan(found) else math.hypot(found, scatter)
    return found


def measure(knob, look):
    """Rows of a knob: each value and quantity. look: point -> result or None."""
    scene, rows = SCENES[knob.scene], []

    def runs(changes):
        return [look(p) for p in knob.runs(changes)]

    for value in knob.values:
        found = runs(value.changes)
        if all(r is None for r in found):
            continue
        against = knob.reference if value.against is None else value.against
        reference = good(runs(against)) if against is not None else None
        check = good(runs(knob.check)) if knob.check is not None else None
        note = next((r.note for r in found if r and r.note), "")
        found = good(found)
        for q in scene.quantities:
            row = Row(knob.scene, knob.name, knob.kind, value.label, value.x, q.name, q.unit,
                      q.head, default=knob.is_default(value), note=note)
            rows.append(row)
            if not found:
                continue
            row.runs = len(found)
            row.seconds = float(np.mean([r.seconds for r in found]))
            row.cost = row.seconds / (scene.hours or 1.0)
            row.steps = float(np.mean([r.steps for r in found]))
            if not reference:
                continue
            right = mean_of(reference)
            row.own, row.relative = error(q, mean_of(found), right)
            single = [error(q, r.values, right)[1] for r in found]
            if knob.paired:
                both = pairs(q, found, reference)
                row.own, row.relative = map(float, root_mean_square(both))
                single = list(map(float, both[:, 1]))
            row.low, row.high = min(single), max(single)
            row.uncertain = uncertainty(q, knob, right, reference, check)
    return rows


@dataclass
class Head:
    """The head quantities of one value of a knob together: the largest relative error of the mean,
    and the band of single orientations of that quantity. which: its name."""

    row: Row
    rows: list = field(default_factory=list)

    @property
    def which(self):
        return self.row.quantity

    @property
    def known(self):
        """Names of the head quantities that were measured."""
        return {r.quantity for r in self.rows if r.head and r.relative == r.relative}

    @property
    def median(self):
        """Median of the relative errors of the head quantities."""
        known = [r.relative for r in self.rows if r.head and r.relative == r.relative]
        return float(np.median(known)) if known else math.nan


def heads(rows):
    """One Head per knob and value, in the order of the rows."""
    groups = {}
    for row in rows:
        groups.setdefault((row.scene, row.knob, row.label), []).append(row)
    found = []
    for group in groups.values():
        known = [r for r in group if r.head and r.relative == r.relative]
        worst = max(known, key=lambda r: r.relative) if known else group[0]
        found.append(Head(worst, group))
    return found


def order_of(x1, e1, x2, e2, finest=0.0):
    """Order p of errors C (x^p - finest^p), from two of them; `finest` is the x of the reference.
    NaN if there is none between -4 and 8."""
    if min(e1, e2) <= 0.0 or x1 == x2:
        return math.nan

    def off(p):
        if finest == 0.0:
            return p * math.log(x1 / x2) - math.log(e1 / e2)
        one, two = (abs(math.expm1(p * math.log(x / finest))) for x in (x1, x2))
        return math.log(one / two) - math.log(e1 / e2)

    grid = np.linspace(-4.0, 8.0, 60)    # no grid point at 0, where x^p - finest^p is 0
    values = [off(p) for p in grid]
    for a, b, fa, fb in zip(grid, grid[1:], values, values[1:]):
        if fa * fb <= 0.0:
            return float(brentq(off, a, b))
    return math.nan


def orders(rows, finest=0.0):
    """Orders between successive values of one knob and quantity, where both errors are clear:
    list of (label, label, order), coarse to fine."""
    clear = [r for r in rows if r.x and r.relative > 0.0
             and not r.relative < CLEAR * r.uncertain]
    return [(a.label, b.label, order_of(a.x, a.relative, b.x, b.relative, finest))
            for a, b in zip(clear, clear[1:])]


def front(points):
    """Indices of (error, time) that no other beats, by time."""
    found, least = [], math.inf
    for k in sorted(range(len(points)), key=lambda k: (points[k][1], points[k][0])):
        if points[k][0] < least:
            found.append(k)
            least = points[k][0]
    return found


def beaten(point, points):
    """Indices of points that clearly beat (error, time) of `point`, see BETTER_ERROR."""
    return [k for k, (e, t) in enumerate(points)
            if e < BETTER_ERROR * point[0] and t < BETTER_TIME * point[1]]


def cheapest(rows, target):
    """The cheapest of the rows with a relative error of at most `target`, None if there is none;
    the reference's uncertainty counts."""
    fit = [r for r in rows if max(r.relative, r.uncertain if r.uncertain == r.uncertain else 0.0)
           <= target]
    return min(fit, key=lambda r: r.cost) if fit else None
