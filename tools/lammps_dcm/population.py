"""How many cells there are: what the logs of a run tell together.

The log of fix dcm/division names cells that divide and their daughters, that of fix dcm/death cells
that die. A cell that does neither is in no log, so that they tell how the number of cells changes,
but not how many there are. The thermo output of the run does.
"""
import re
from pathlib import Path

import numpy as np

from .log import read_log


def cells_in_run(path):
    """Steps (m,) and numbers of cells (m,) in the LAMMPS log of a run: the thermo column f_ID of
    its fix ID dcm/growth. A ValueError says what is missing."""
    table = read_log(path)
    text = Path(path).read_text(errors="replace")
    fixes = dict.fromkeys(re.findall(r"^fix\s+(\S+)\s+\S+\s+dcm/growth\s", text, re.M))
    if not fixes:
        raise ValueError(f"{path}: the deck in it has no fix dcm/growth")
    column = next((f"f_{name}" for name in fixes if f"f_{name}" in table), None)
    if column is None:
        raise ValueError(f"{path}: the thermo output has no number of cells: add "
                         f"{' or '.join(f'f_{name}' for name in fixes)} to thermo_style")
    return table["Step"].astype(int), np.rint(table[column]).astype(int)


def cells_in_no_log(tree, steps, numbers):
    """Number of cells of a run that are not in its Lineage, since they were there from the start
    and neither divided nor died; steps, numbers: of cells_in_run. A ValueError if the logs of
    divisions and deaths leave out some, or are of another run."""
    others = numbers - tree.named(steps)
    wrong = np.flatnonzero((others != others[0]) | (others < 0))
    if len(wrong):
        k = wrong[0]
        raise ValueError(f"at step {steps[k]} the run has {numbers[k]} cells, "
                         f"{numbers[k] - others[k] + max(others[0], 0)} by the logs of divisions "
                         "and deaths: one of them is missing or of another run")
    return int(others[0])


def print_population(tree, problem, has_deaths, checked):
    """Print the numbers of cells at both ends and the growth rate, as far as they are known.

    problem: why tree.others is not known, if so; has_deaths: there is a log of deaths; checked: the
    thermo output agrees with the logs."""
    times, number = tree.counts()
    if tree.others is None:
        gone = np.isfinite(tree.death).sum()
        print(f"divisions: {np.isfinite(tree.division).sum()}" +
              (f", deaths: {gone}" if has_deaths else ""))
        print(f"number of cells and growth rate: not known ({problem})")
        return
    unless = "" if has_deaths or checked else ", if none died (no log of deaths)"
    print(f"cells: {number[0]} at {times[0]:g} s, {number[-1]} at {tree.end:g} s{unless}")
    k, _ = tree.growth_fit()
    if np.isfinite(k):
        doubling = f", doubling time {np.log(2.0) / k:.6g} s" if k > 0.0 else ""
        print(f"growth rate {k:.6g} 1/s{doubling}{unless}")
