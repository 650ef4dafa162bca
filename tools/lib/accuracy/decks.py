"""Text of the shipped examples, with lines of it replaced; what a changed example no longer has
is an error and not left out in silence."""
import re
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[3]
EXAMPLES = ROOT / "examples"
MANY = 1000000000    # steps: runs end at a time


class DeckChanged(ValueError):
    """An example has not the line that was to be replaced."""


def example(path):
    """Text of a file below examples, one command a line (continued lines are joined), without
    pictures and trajectories, whose times would be those of steps as well."""
    text = re.sub(r"&[ \t]*\n\s*", "", (EXAMPLES / path).read_text(encoding="ascii"))
    return re.sub(r"^(variable\s+(?:image|movie)\s+index\s+)yes", r"\1no", text, flags=re.M)


def swap(text, begin, new, count=1):
    """`text` with the whole lines that begin with `begin` (white space as one blank) replaced."""
    pattern = r"\s+".join(map(re.escape, begin.split()))
    result, found = re.subn(rf"^{pattern}.*$", lambda _: new, text, flags=re.M)
    if found != count:
        raise DeckChanged(f"{found} lines instead of {count} begin with '{begin}': the example has "
                          "changed, and tools/lib/accuracy/scenes.py with it has to")
    return result


def put(text, old, new):
    """`text` with `new` in all places of `old`, which it must have."""
    if old not in text:
        raise DeckChanged(f"'{old}' is not there: the example has changed, and "
                          "tools/lib/accuracy/scenes.py with it has to")
    return text.replace(old, new)


def until(text, begin):
    """`text` up to the line that begins with `begin`."""
    pattern = r"\s+".join(map(re.escape, begin.split()))
    match = re.search(rf"^{pattern}", text, flags=re.M)
    if not match:
        raise DeckChanged(f"no line begins with '{begin}': the example has changed, and "
                          "tools/lib/accuracy/scenes.py with it has to")
    return text[: match.start()]


def motion(step, tolerance, longest="60"):
    """Keywords of fix dcm/motion. step: `accuracy A`, `auto X`, `implicit DT` or `explicit DT`;
    longest step of the first two in s. The first one chooses the tolerance of the solver."""
    kind, value = step.split()
    if kind == "accuracy":
        return f"scheme implicit accuracy {value} dt auto max {longest}"
    if kind == "auto":
        return f"scheme implicit tolerance {tolerance} dt auto tol {value} max {longest}"
    return f"scheme {kind} tolerance {tolerance}" + (" maxmove 1" if kind == "implicit" else "")


def chosen(step):
    """Does the program choose the steps?"""
    return step.split()[0] in ("accuracy", "auto")


def timestep(step):
    """Command timestep for `step`: one second, the shortest step, where it is chosen."""
    return "timestep        " + ("1.0" if chosen(step) else step.split()[1])


def pair(settings):
    """Command pair_style for settings law, h0, points and facing (empty: the default)."""
    words = ["pair_style      dcm/contact law", settings["law"]]
    for name in ("h0", "points", "facing"):
        if settings.get(name):
            words += [name, settings[name]]
    return " ".join(words)


def frames(path):
    """Frames of a dump: list of (time, name of column -> array); without `time yes` the time is
    that of the step."""
    found, lines = [], Path(path).read_text(encoding="ascii").splitlines()
    at = [k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS")]
    timed = any(line == "ITEM: TIME" for line in lines)
    times = [float(lines[k + 1]) for k, line in enumerate(lines)
             if line == ("ITEM: TIME" if timed else "ITEM: TIMESTEP")]
    for time, k in zip(times, at, strict=True):
        rest = (j for j in range(k + 1, len(lines)) if lines[j].startswith("ITEM:"))
        end = next(rest, len(lines))
        rows = np.array([line.split() for line in lines[k + 1:end]], float)
        found.append((time, dict(zip(lines[k].split()[2:], rows.T, strict=True))))
    return found


def marked(text, word):
    """Numbers of printed lines `WORD key values...`: key -> list of floats."""
    return {key: [float(v) for v in values.split()] for key, values in
            re.findall(rf"^{word} (\S+) ([-+.\deE ]+|.*nan.*)$", text, flags=re.M)}
