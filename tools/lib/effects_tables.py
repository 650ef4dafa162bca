"""Tables of tools/bench effects, as CSV for the manual's page doc/effects.rst."""

import csv
import os
import platform
import re
import statistics
import subprocess
import time
from pathlib import Path

from effects_decks import EFFECTS, SCENES, STEPS, options, registered
from effects_jobs import COUNTED, base_job, jobs_of

LIMIT = 0.5      # percent of a step that an effect with nothing to do may take
UNNAMED = 0.1    # percent between the program with and without the styles no deck names


def percent_of(pairs):
    return statistics.median(100.0 * (b - a) / a for a, b in pairs)


def number(value, digits=2):
    """Short text of a number; what is exactly nothing is 0."""
    if value is None:
        return ""
    if value == 0.0:
        return "0"
    return f"{value:+.{digits}f}" if round(value, digits) else f"{value:+.1g}"


class Tables:
    """Rows of the manual's tables from the results."""

    def __init__(self, store, build):
        self.store, self.build = store, build

    def get(self, effect, scene, kind, variant):
        job = jobs_of(effect, scene, kind).get(variant)
        return self.store.known.get(job.key(self.build)) if job else None

    def added(self, effect, scene, kind, what, variants=("base", "named")):
        """What is added, and in percent of the scene's deck; None while it was not measured."""
        a, b = (self.get(effect, scene, kind, v) for v in variants)
        if not a or not b or scene not in effect.scenes:
            return None, None
        scenes = self.store.known.get(base_job(kind, scene).key(self.build))
        difference = b[what] - a[what]
        return difference, 100.0 * difference / scenes[what] if scenes else None

    def seconds(self, effect, scene):
        jobs = jobs_of(effect, scene, "seconds")
        if not jobs:
            return None
        pairs = self.store.known.get(
            "s" + jobs["named"].key(self.build) + jobs["base"].key(self.build))
        return percent_of(pairs) if pairs else None

    def counts(self, effect, variants=("base", "named")):
        """KiB a process, messages and bytes a step, in one scene."""
        heap, messages, size = (self.added(effect, COUNTED, "counts", what, variants)[0]
                                for what in ("heap", "messages", "bytes"))
        return [number(None if heap is None else heap / 1024, 1), number(messages, 1),
                number(size, 0)]

    def named(self):
        yield ["effect", "style", *(f"{s}, %" for s in SCENES), "iterations", "KiB", "messages",
               "bytes", *(f"time {s}, %" for s in SCENES)]
        for effect in EFFECTS:
            if effect.per == "event":
                continue
            shares = [number(self.added(effect, s, "instructions", "instructions")[1])
                      for s in SCENES]
            was, now = (self.get(effect, COUNTED, "instructions", v) for v in ("base", "named"))
            both = [f"{x['iterations']:.1f}" if x["iterations"] else "none"
                    for x in (was, now)] if was and now else []
            yield [effect.name, effect.styles[0], *shares, " to ".join(both),
                   *self.counts(effect), *(number(self.seconds(effect, s), 0) for s in SCENES)]

    def events(self):
        yield ["event", "style", *(f"{s}, million" for s in SCENES),
               *(f"{s}, steps" for s in SCENES), "messages", "bytes"]
        for effect in EFFECTS:
            if effect.per != "event":
                continue
            found = [self.added(effect, s, "instructions", "instructions") for s in SCENES]
            yield [effect.name, effect.styles[0],
                   *(number(None if a is None else a * STEPS / 1e6) for a, _ in found),
                   *(number(None if p is None else p * STEPS / 100) for _, p in found),
                   *self.counts(effect)[1:]]

    def idle(self):
        """Rows of effects with nothing to do; those beyond the limit end with the word over."""
        yield ["style", "in the deck", *(f"{s}, %" for s in SCENES), "KiB", "messages", "bytes"]
        for effect in EFFECTS:
            if effect.idle is None:
                continue
            variants = ("idle_base", "idle")
            shares = [self.added(effect, s, "instructions", "instructions", variants)[1]
                      for s in SCENES]
            line = (effect.idle.get("after") or effect.idle["effect"]).splitlines()[-1]
            what = line.split(" ", 2)[2] + (f" ({effect.note})" if effect.note else "")
            yield [effect.styles[0], what,
                   *(number(s, 3) for s in shares), *self.counts(effect, variants)]

    def scenes(self):
        yield ["scene", "what", "million instructions a step", "iterations", "KiB a process",
               "messages", "bytes"]
        for scene in SCENES.values():
            jobs = {k: base_job(k, scene.name) for k in ("instructions", "counts")}
            found = {k: self.store.known.get(j.key(self.build)) for k, j in jobs.items()}
            a, b = found["instructions"], found["counts"]
            yield [scene.name, scene.about, f"{a['instructions'] / 1e6:.2f}" if a else "",
                   f"{a['iterations']:.1f}" if a else "",
                   *([f"{b['heap'] / 1024:.0f}", f"{b['messages']:.0f}", f"{b['bytes']:.0f}"]
                     if b else ["", "", ""])]

    def unnamed(self, few):
        """Per scene: the program with all styles, and that of build `few` with the needed ones."""
        yield ["scene", "instructions, all styles", "needed ones only", "%", "bytes allocated",
               "messages", "bytes sent"]
        for scene in SCENES:
            found = [self.store.known.get(base_job(kind, scene).key(build))
                     for build in (self.build, few) for kind in ("instructions", "counts")]
            if None in found:
                continue
            a, p, b, q = found
            share = 100.0 * (a["instructions"] - b["instructions"]) / b["instructions"]
            yield [scene, f"{a['instructions'] * STEPS:.0f}", f"{b['instructions'] * STEPS:.0f}",
                   number(share, 4),
                   *(number(p[k] - q[k], 1) for k in ("heap", "messages", "bytes"))]

    def options(self):
        yield ["style", "options with a row", "options without"]
        for style, header in registered().items():
            yield [style, *(", ".join(names) for names in options(style, header))]


def over(rows):
    """Rows of idle() beyond the limit in a scene."""
    rows = list(rows)
    places = [k for k, head in enumerate(rows[0]) if head.endswith("%")]
    return [row for row in rows[1:] if any(row[k] and float(row[k]) > LIMIT for k in places)]


def unlike(rows):
    """Rows of unnamed() in which the styles that the deck does not name cost something."""
    return [row for row in list(rows)[1:]
            if abs(float(row[3])) > UNNAMED or (row[5], row[6]) != ("0", "0")]


def write(folder, name, rows):
    """A table as CSV; the manual takes none without a row."""
    folder.mkdir(parents=True, exist_ok=True)
    if len(rows) == 1:
        rows = [*rows, ["not measured"] + [""] * (len(rows[0]) - 1)]
    with open(folder / f"{name}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def machine():
    """Date, processor and compiler, for the page."""
    info = Path("/proc/cpuinfo")
    models = re.findall(r"model name\s*: (.*)", info.read_text()) if info.is_file() else []
    name = models[0] if models else platform.machine()
    compiler = subprocess.run(["c++", "--version"], capture_output=True, text=True, check=False)
    return (f"{time.strftime('%d %B %Y').lstrip('0')}, {os.cpu_count()} cores of {name}, "
            f"{compiler.stdout.splitlines()[0] if compiler.stdout else 'unknown compiler'}")
