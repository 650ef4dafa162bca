"""Who descends from whom: logs of fix dcm/division and fix dcm/death, family trees, growth.

    from lammps_dcm import Lineage, read_deaths, read_divisions
    tree = Lineage(read_divisions("division.log"), read_deaths("death.log"))
    print(tree.cycle_time, tree.growth_fit())
"""
import warnings
from pathlib import Path

import numpy as np

from .population import cells_in_no_log, cells_in_run, print_population
from .table import write_columns

DIVISION_COLUMNS = ("step", "time", "mother", "daughter1", "daughter2", "generation", "kind",
                    "axis_x", "axis_y", "axis_z", "volume", "volume1", "volume2", "iterations",
                    "pressure_before", "pressure")
DEATH_COLUMNS = ("step", "time", "cell", "kind", "reason", "volume")
NEEDED = ("step", "time", "mother", "daughter1", "daughter2", "cell")
WHOLE = ("step", "mother", "daughter1", "daughter2", "cell", "generation")
TEXT = ("kind", "reason")
RESTARTED = "a restarted run may have taken another course: remove the lines it replaces"


class LineageError(ValueError):
    """Logs that cannot be read or contradict each other; the message names log, line and cell."""


# ---------------------------------------------------------------------- logs

def value_of(name, word):
    """A word of column `name` as int, float or text; text, too, for a column not known here."""
    if name in WHOLE:
        return int(word)
    known = name in DIVISION_COLUMNS or name in DEATH_COLUMNS
    return float(word) if known and name not in TEXT else word


def read_events(path, style, columns, key):
    """Rows of a log of `style`, one per step and cell `key`, sorted by step: a recarray.

    Its fields are `line` (in the file), `columns` and whatever else the log has, found by the
    names in the last header line before a row. Optional columns that the log lacks are NaN, -1
    (generation) or "". Lines written twice, by a run and by its restart: the last one counts. A
    last line that is cut short is left out with a warning; any other one is a LineageError.
    """
    if not Path(path).exists():
        raise FileNotFoundError(f"no file {path}: give the log that fix {style} writes")
    text = Path(path).read_text(encoding="utf-8", errors="replace")
    lines = text.split("\n")    # the piece after the last newline is empty, or an unfinished line
    names, found, others = None, {}, []
    for n, line in enumerate(lines, 1):
        words = line.split()
        if not words:
            continue
        if words[0].startswith("#"):
            names = line.replace("#", " ").split()
            continue
        if names is None:
            raise LineageError(f"{path}:{n}: no header line '# {' '.join(columns)}' above: is it a "
                               f"log of fix {style}?")
        lacking = [c for c in columns if c in NEEDED and c not in names]
        if lacking:
            raise LineageError(f"{path}:{n}: the header line above names no column {lacking[0]}: "
                               f"is it a log of fix {style}?")
        try:
            if len(words) != len(names):
                raise ValueError(f"{len(words)} values in {len(names)} columns")
            row = {name: value_of(name, word) for name, word in zip(names, words)}
            problem = "no end of line" if n == len(lines) else None
        except ValueError as err:
            row, problem = None, str(err)
        if problem:
            if not any(map(str.strip, lines[n:])):
                warnings.warn(f"{path}:{n}: the last line is not complete ({problem}): LAMMPS was "
                              "stopped while writing it, or still runs; it is left out",
                              stacklevel=2)
                break
            raise LineageError(f"{path}:{n}: {problem}: the line is damaged, repair or remove it")
        others += [c for c in names if c not in columns and c not in others]
        at = row["step"], row[key]
        found.pop(at, None)    # the last one counts, also for its place in the order
        found[at] = {"line": n, **row}
    rows = sorted(found.values(), key=lambda row: row["step"])
    arrays = [np.array([row["line"] for row in rows], dtype=int)]
    for name in (*columns, *others):
        if name in WHOLE:
            arrays.append(np.array([row.get(name, -1) for row in rows], dtype=int))
        elif name in TEXT:
            arrays.append(np.array([row.get(name, "") for row in rows], dtype=object))
        else:
            column = [row.get(name, "nan") for row in rows]
            try:
                arrays.append(np.array(column, dtype=float))
            except ValueError:
                arrays.append(np.array(column, dtype=object))
    return np.rec.fromarrays(arrays, names=["line", *columns, *others])


def read_divisions(path):
    """Divisions in a log of fix dcm/division: recarray with the fields DIVISION_COLUMNS and
    `line`, see read_events; time in s, volumes in um^3, pressures in kPa."""
    return read_events(path, "dcm/division", DIVISION_COLUMNS, "mother")


def read_deaths(path):
    """Deaths in a log of fix dcm/death: recarray with the fields DEATH_COLUMNS and `line`, see
    read_events; time in s, volume in um^3."""
    return read_events(path, "dcm/death", DEATH_COLUMNS, "cell")


# ---------------------------------------------------------------------- family trees

class Lineage:
    """Family trees of n cells, one row a cell, mothers before their daughters.

    divisions, deaths: of read_divisions and read_deaths, either may be None. initial: molecule
    IDs of cells that were there from the start, known or not from the logs. begin, end: of the
    simulation, s; by default 0 and the last event. names: of the two logs, for messages.

    A daughter may go on under the molecule ID of its mother; that is a new row. Arrays (n,):
    cell: molecule ID; parent: row of the mother, -1 for roots; generation: 0 for roots, or what
    the log implies; birth, division, death: s, NaN where it did not happen, or not in the logs;
    cycle_time: division - birth, s, so NaN for roots; pressure: largest of the own division, kPa;
    iterations: of the own division; both NaN unless a deformable cell divided. children: list of
    tuples of rows. roots: (r,) rows. A LineageError tells which line contradicts which.

    others: number of cells without a row, there from the start and in no log: 0, unless you set it,
    which counts(), living() and growth_fit() need to be right; None: not known, they are left out.
    """

    def __init__(self, divisions=None, deaths=None, initial=(), begin=0.0, end=None,
                 names=("division log", "death log")):
        self._rows, self._now, self._names = [], {}, names
        for cell in initial:
            if int(cell) in self._now:
                raise LineageError(f"cell {cell} occurs twice among the initial cells")
            self._add(int(cell), -1, 0, "the list of initial cells")
        events = [(row.step, 0, row) for row in (() if divisions is None else divisions)]
        events += [(row.step, 1, row) for row in (() if deaths is None else deaths)]
        for _, which, event in sorted(events, key=lambda e: e[:2]):
            (self._die if which else self._divide)(event, f"{names[which]}:{event.line}")
        rows = self._rows
        self.cell = np.array([r["cell"] for r in rows], dtype=int)
        self.parent = np.array([r["parent"] for r in rows], dtype=int)
        self.generation = np.array([r["generation"] for r in rows], dtype=int)
        for name in ("birth", "division", "death", "pressure", "iterations"):
            setattr(self, name, np.array([r[name] for r in rows], dtype=float))
        self.children = [r["children"] for r in rows]
        self.roots = np.flatnonzero(self.parent < 0)
        self.cycle_time = self.division - self.birth
        self.others = 0
        self._changes = np.array([(step, 1 - 2 * which) for step, which, _ in events],
                                 dtype=int).reshape(-1, 2)
        times = [event.time for _, _, event in events]
        self.begin = float(begin)
        self.end = float(max(times, default=self.begin) if end is None else end)
        if times and not self.begin <= min(times) <= max(times) <= self.end:
            raise LineageError(f"events from {min(times):g} to {max(times):g} s, but the "
                               f"simulation is said to go from {self.begin:g} to {self.end:g} s")

    def __len__(self):
        return len(self._rows)

    def _add(self, cell, parent, generation, where, birth=np.nan):
        self._now[cell] = len(self._rows)
        self._rows.append(dict(cell=cell, parent=parent, generation=generation, birth=birth,
                               division=np.nan, death=np.nan, pressure=np.nan, iterations=np.nan,
                               children=(), where=where, fate=None))
        return self._now[cell]

    def _living(self, cell, act, where):
        """Row of a cell that acts now; one that nobody mentioned before becomes a root."""
        if cell not in self._now:
            return self._add(int(cell), -1, 0, where)
        row = self._now[cell]
        if self._rows[row]["fate"]:
            raise LineageError(f"{where}: cell {cell} {act}, but it {self._rows[row]['fate']}; "
                               f"{RESTARTED}")
        return row

    def _divide(self, event, where):
        told = event.generation    # of the daughters, -1 if the log does not say
        mother = self._living(event.mother, "divides", where)
        row = self._rows[mother]
        if row["parent"] < 0 and told > 0:
            row["generation"] = told - 1
        generation = row["generation"] + 1
        if told not in (-1, generation):
            warnings.warn(f"{where}: the daughters of cell {event.mother} are of generation "
                          f"{generation} by the log's earlier lines, not {told}", stacklevel=2)
        if event.daughter1 == event.daughter2:
            raise LineageError(f"{where}: both daughters of cell {event.mother} are cell "
                               f"{event.daughter1}")
        row.update(division=event.time, fate=f"divided at {where}")
        if event.kind != "cbm":
            row.update(pressure=event.pressure, iterations=event.iterations)
        for cell in (event.daughter1, event.daughter2):
            if cell in self._now and cell != event.mother:
                known = self._rows[self._now[cell]]["where"]
                raise LineageError(f"{where}: cell {cell} is born, but it was there before, see "
                                   f"{known}; {RESTARTED}")
        row["children"] = tuple(self._add(int(cell), mother, generation, where, event.time)
                                for cell in (event.daughter1, event.daughter2))

    def _die(self, event, where):
        row = self._rows[self._living(event.cell, "dies", where)]
        row.update(death=event.time, fate=f"died at {where}")

    def row(self, cell):
        """Last row of molecule ID `cell`."""
        if cell not in self._now:
            raise LineageError(f"no cell {cell} in the logs")
        return self._now[cell]

    def named(self, steps):
        """Number of cells with a row that live after LAMMPS steps `steps` (m,)."""
        step, change = self._changes.T
        return len(self.roots) + (change * (step <= np.reshape(steps, (-1, 1)))).sum(axis=1)

    def counts(self):
        """Times (m,), s, and numbers of living cells (m,) from then on: the begin, and every time
        at which the number changes."""
        gone = np.concatenate([self.division, self.death])
        times = np.concatenate([self.birth, gone])
        change = np.repeat([1, -1], [len(self.birth), len(gone)])
        change = change[~np.isnan(times)]
        moments, at = np.unique(times[~np.isnan(times)], return_inverse=True)
        start = len(self.roots) + (self.others or 0)
        number = start + np.cumsum(np.bincount(at, change, minlength=len(moments)))
        number = np.rint(number).astype(int)
        if not len(moments) or moments[0] > self.begin:
            moments = np.append(self.begin, moments)
            number = np.append(start, number)
        keep = np.append(True, np.diff(number) != 0)
        return moments[keep], number[keep]

    def living(self, times):
        """Number of living cells at `times` (any shape), s; an event counts from its time on."""
        moments, number = self.counts()
        at = np.searchsorted(moments, times, side="right") - 1
        return number[np.maximum(at, 0)]

    def growth_fit(self, begin=None, end=None):
        """(k, N0) of N(t) = N0 exp(k t), k in 1/s: least squares of ln N at the points of counts()
        within begin..end (s, both included). (NaN, NaN) for less than two points with N > 0."""
        times, number = self.counts()
        use = number > 0
        use &= times >= (self.begin if begin is None else begin)
        use &= times <= (self.end if end is None else end)
        if use.sum() < 2:
            return np.nan, np.nan
        t, log = times[use], np.log(number[use])
        d = t - t.mean()
        k = float(d @ log / (d @ d))
        return k, float(np.exp(log.mean() - k * t.mean()))

    def by_generation(self):
        """Dict of arrays (generations,): generation, cells, divided, died, cycle_mean and cycle_sd
        (s; sample sd), pressure (kPa) and iterations (means over the divisions of these cells)."""
        names = ("generation", "cells", "divided", "died", "cycle_mean", "cycle_sd", "pressure",
                 "iterations")
        rows = []
        for generation in np.unique(self.generation):
            here = self.generation == generation
            cycle = known(self.cycle_time[here])
            rows.append((generation, here.sum(), len(known(self.division[here])),
                         len(known(self.death[here])), mean(cycle),
                         cycle.std(ddof=1) if len(cycle) > 1 else np.nan,
                         mean(known(self.pressure[here])), mean(known(self.iterations[here]))))
        columns = np.array(rows, dtype=float).reshape(-1, len(names)).T
        return {name: c.astype(int) if k < 4 else c
                for k, (name, c) in enumerate(zip(names, columns))}

    def layout(self):
        """Heights (n,) of the branches in a drawing: leaves 0, 1, 2, ..., a mother in the middle of
        her daughters, one tree after the other; NaN for roots that neither divide nor die."""
        height = np.full(len(self), np.nan)
        leaves = 0
        for root in self.roots:
            if np.isnan(self.division[root]) and np.isnan(self.death[root]):
                continue
            stack = [root]
            while stack:
                row = stack.pop()
                if self.children[row]:
                    stack += reversed(self.children[row])
                else:
                    height[row] = leaves
                    leaves += 1
        for row in range(len(self) - 1, -1, -1):    # daughters have larger rows
            if self.children[row]:
                height[row] = np.mean(height[list(self.children[row])])
        return height


def known(values):
    """Those of `values` (n,) that are not NaN."""
    return values[~np.isnan(values)]


def mean(values):
    """Mean of `values` (n,), NaN of none."""
    return values.mean() if len(values) else np.nan


# ---------------------------------------------------------------------- picture

def draw(tree, output):
    """Draw the trees, time to the right, and the number of cells below, into an image file."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import LineCollection

    height = tree.layout()
    shown = ~np.isnan(height)
    leaves = int(np.nanmax(height, initial=0.0)) + 1
    span = tree.end - tree.begin or 1.0
    unit, second = ("h", 3600.0) if span > 2 * 3600.0 else ("s", 1.0)
    first = np.where(np.isnan(tree.birth), tree.begin, tree.birth) / second
    gone = np.where(np.isnan(tree.division), tree.death, tree.division) / second
    # beyond the end, that daughters of the last division are seen
    last = np.where(np.isnan(gone), (tree.end + 0.03 * span) / second, gone)
    generations = np.unique(tree.generation)
    cmap = matplotlib.colormaps["viridis"]
    depth = max(np.ptp(generations), 1)
    color = {g: cmap(0.9 * (g - generations[0]) / depth) for g in generations}

    high = float(np.clip(0.17 * leaves + 0.6, 2.2, 17.0))
    figure, (top, low) = pyplot.subplots(
        2, 1, sharex=True, figsize=(9, high + 2.2), layout="constrained",
        gridspec_kw=dict(height_ratios=(high, 1.7)))
    width = 1.8 if leaves <= 100 else 1.0
    segments, colors = [], []
    for row in np.flatnonzero(shown):
        segments.append([(first[row], height[row]), (last[row], height[row])])
        colors.append(color[tree.generation[row]])
        for child in tree.children[row]:
            segments.append([(last[row], height[row]), (last[row], height[child])])
            colors.append(color[tree.generation[child]])
    top.add_collection(LineCollection(segments, colors=colors, linewidths=width,
                                      capstyle="projecting"))
    dead = shown & ~np.isnan(tree.death)
    if dead.any():
        top.plot(last[dead], height[dead], "x", color="crimson", ms=6 if leaves <= 100 else 4,
                 mew=1.5, label="death", zorder=3)
    for row in np.flatnonzero(shown) if leaves <= 100 else ():
        leaf = not tree.children[row]
        top.annotate(str(tree.cell[row]), (last[row] if leaf else 0.5 * (first[row] + last[row]),
                                           height[row]), fontsize=6, clip_on=False,
                     xytext=(6, 0) if leaf else (0, 1), textcoords="offset points",
                     ha="left" if leaf else "center", va="center" if leaf else "bottom")
    step = -(-len(generations) // 10)
    for g in generations[::step]:
        top.plot([], [], color=color[g], lw=2.5, label=f"generation {g}")
    top.legend(loc="upper left", bbox_to_anchor=(1.04, 1.0), fontsize=8, frameon=False)
    top.set_ylim(leaves - 0.4, -0.6)
    top.set_yticks([])
    for side in ("left", "right", "top"):
        top.spines[side].set_visible(False)
    others = int((~shown).sum()) + (tree.others or 0)
    total = len(tree) + (tree.others or 0)
    in_logs = " in the logs" if tree.others is None else ""
    top.set_title(f"{total} cells{in_logs}, {len(known(tree.division))} divisions, "
                  f"{len(known(tree.death))} deaths" +
                  (f"; not drawn: {others} that neither divide nor die" if others else ""),
                  fontsize=9)

    times, number = tree.counts()
    unknown = tree.others is None
    if unknown:
        number = number - number[0]
    low.step(np.append(times, tree.end) / second, np.append(number, number[-1]), where="post",
             color="black", lw=1.3)
    k, n0 = tree.growth_fit()
    if np.isfinite(k) and not unknown:
        t = np.linspace(tree.begin, tree.end, 100)
        low.plot(t / second, n0 * np.exp(k * t), "--", color="crimson", lw=1,
                 label=f"rate {k:.3g} 1/s")
        low.legend(fontsize=8, frameon=False)
    low.set_ylim(None if number.min() < 0 else 0, None)
    low.yaxis.get_major_locator().set_params(integer=True)
    low.set_xlabel(f"time ({unit})")
    low.set_ylabel("change of the\nnumber of cells" if unknown else "living cells")
    low.set_xlim(tree.begin / second, (tree.end + 0.03 * span) / second)
    figure.savefig(output, dpi=130)
    pyplot.close(figure)


# ---------------------------------------------------------------------- command line

HEADS = {"generation": "generation", "cells": "cells", "divided": "divided", "died": "died",
         "cycle_mean": "cycle[s]", "cycle_sd": "sd[s]", "pressure": "pressure[kPa]",
         "iterations": "iterations"}
EPILOG = """\
The table has a line per generation. cells: that belonged to it, not known (-) for cells there from
the start unless --initial or --thermo tells their number; cycle, sd: mean and standard
deviation of the time from birth to division, which cells that were there from the start do not
have; pressure, iterations: means over the divisions of its deformable cells, of the largest
pressure (kPa) and of the iterations of rounding up. The picture shows a branch per cell from
birth to division or death (a cross), up to 100 branches with their molecule IDs; those of living
cells run a little beyond the end. Below are the number of living cells and an exponential fitted
to it, or, if the number at the start is not known, its change."""


def print_table(columns):
    """Print a dict of equally long columns; `-` where a number is NaN."""
    rows = [[HEADS[name] for name in columns]]
    rows += [["-" if np.isnan(v) else f"{v:.6g}" for v in row] for row in zip(*columns.values())]
    widths = [max(map(len, column)) for column in zip(*rows)]
    for row in rows:
        print("  ".join(word.rjust(width) for word, width in zip(row, widths)))


def add_arguments(parser):
    """Options of `lineage`."""
    parser.epilog = EPILOG
    parser.add_argument("log", metavar="DIVISION_LOG", help="log of fix dcm/division")
    parser.add_argument("--death", metavar="FILE", help="log of fix dcm/death of the same run")
    parser.add_argument("--initial", type=int, metavar="N", help="cells 1 to N, and no others, "
                        "were there from the start")
    parser.add_argument("--thermo", metavar="FILE", help="LAMMPS log of the same run, with the "
                        "number of cells (f_ID of fix ID dcm/growth) in its thermo output")
    parser.add_argument("--begin", type=float, default=0.0, help="of the simulation, s "
                        "(default: %(default)g)")
    parser.add_argument("--end", type=float, help="of the simulation, s; by default the last event")
    parser.add_argument("--csv", help="write a line per cell to this file, too: cell, parent "
                        "(0: none), generation, birth, division, death, cycle_time")
    parser.add_argument("-o", "--output", default="lineage.png", help="default: %(default)s")


def run(args, words):
    """Print the table and draw the trees the command line asks for."""
    logs = [Path(p).resolve() for p in (args.log, args.death, args.thermo) if p]
    for path in (args.output, args.csv):
        if path and Path(path).resolve() in logs:
            raise ValueError(f"{path} is one of the logs: give another file for the result")
    divisions = read_divisions(args.log)
    deaths = None if args.death is None else read_deaths(args.death)
    tree = Lineage(divisions, deaths, range(1, (args.initial or 0) + 1), args.begin, args.end,
                   (args.log, args.death))
    if not len(tree):
        raise ValueError(f"{args.log}: no division yet; with --initial N there is something to "
                         "count")
    problem = count_others(tree, args)
    print_table(generations_of(tree))
    print_population(tree, problem, deaths is not None, args.thermo is not None)
    draw(tree, args.output)
    if args.csv:
        mother = np.where(tree.parent >= 0, tree.cell[tree.parent], 0)
        write_columns(args.csv, dict(cell=tree.cell, parent=mother, generation=tree.generation,
                                     birth=tree.birth, division=tree.division, death=tree.death,
                                     cycle_time=tree.cycle_time))
    print(f"wrote {args.output}")


def count_others(tree, args):
    """Set tree.others from what the command line says; returns why it stays unknown, or None."""
    tree.others = None
    if args.thermo is not None:
        try:
            tree.others = cells_in_no_log(tree, *cells_in_run(args.thermo))
        except ValueError as err:
            return str(err)
        return None
    if args.initial is None:
        return ("a cell that neither divides nor dies is in no log: give --initial N, or --thermo "
                "LOG of LAMMPS")
    tree.others = 0
    if len(tree.roots) > args.initial:
        stranger = next(c for c in tree.cell[tree.roots] if c > args.initial)
        raise LineageError(f"cell {stranger} has no mother in {args.log} and is not among the "
                           f"cells 1 to {args.initial} of --initial")
    return None


def generations_of(tree):
    """tree.by_generation() with the cells in no log, which belong to generation 0 unless the tree
    begins in the middle of another one; then, and if their number is not known, NaN."""
    table = tree.by_generation()
    first = np.isin(table["generation"], tree.generation[tree.roots])
    if tree.others == 0:
        return table
    if tree.others is None or (tree.generation[tree.roots] > 0).any():
        table["cells"] = np.where(first, np.nan, table["cells"])
    else:
        table["cells"] = table["cells"] + tree.others * first
    return table
