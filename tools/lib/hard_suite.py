"""The suite of hard cases: all scenes in all ways, resumable; table, pictures, page of the manual.

A result is FOLDER/SCENE.SCHEME.RANKS.json; FOLDER/SCENE.dump is the frame that the picture shows.
"""

import argparse
import csv
import json
import math
import shutil
import sys
import time
import traceback
from dataclasses import asdict
from pathlib import Path

from hard import families
from hard.suite import RANKS, SCENES, SCHEMES, Case, Measured, perform

from lammps_dcm.__main__ import main as lammps_dcm
from support import scenes as shared_scenes
from support.runner import Runner


def clock(seconds):
    """Text such as 1 h 05 min."""
    minutes = max(0, round(seconds / 60.0))
    return f"{minutes // 60} h {minutes % 60:02d} min" if minutes >= 60 else f"{minutes} min"


class Way:
    """One scene with one scheme on one number of ranks, and its result if there is one."""

    def __init__(self, scene, scheme, ranks, folder):
        self.scene, self.scheme, self.ranks, self.folder = scene, scheme, ranks, folder
        self.path = folder / f"{scene.name}.{scheme}.{ranks}.json"
        self.result = None
        if self.path.exists():
            try:
                self.result = json.loads(self.path.read_text())
            except ValueError:  # cut short
                self.path.unlink()

    @property
    def name(self):
        return f"{self.scene.name}, {self.scheme}, {self.ranks} rank{'s' * (self.ranks > 1)}"

    @property
    def measured(self):
        return [Measured(**m) for m in self.result["measured"]] if self.result else []

    @property
    def good(self):
        return bool(self.result) and self.result["good"]

    def run(self, full):
        """Run and judge; what is left behind is a result."""
        runs = self.folder / "runs" / f"{self.scene.name}.{self.scheme}.{self.ranks}"
        shutil.rmtree(runs, ignore_errors=True)
        runs.mkdir(parents=True)
        case = Case(
            Runner(runs),
            shared_scenes,
            self.ranks,
            self.scheme,
            full,
            timeout=7200.0 if full else 600.0,
        )
        begun = time.time()
        try:
            perform(self.scene, case)
        except KeyboardInterrupt:
            raise
        except BaseException as fault:  # a time limit is one of pytest's own
            case.outcomes.append("error: " + (str(fault) or traceback.format_exc()))
        seconds = time.time() - begun
        self.result = dict(
            measured=[asdict(m) for m in case.measured],
            good=case.good,
            outcome=case.outcome,
            seconds=seconds,
            faults=case.faults(),
        )
        shown = self.folder / f"{self.scene.name}.dump"
        best = not shown.exists() or (self.scheme, self.ranks) == (self.scene.schemes[-1], 1)
        dump = Path(case.picture) if case.picture else None
        if best and dump and dump.exists() and dump.stat().st_size > 0:
            shown.write_text(last_frame(dump))
        part = self.path.with_suffix(".part")
        part.write_text(json.dumps(self.result, indent=1))
        part.rename(self.path)
        if case.good:
            shutil.rmtree(runs)
        return self


def last_frame(path):
    text = path.read_text()
    return text[text.rindex("ITEM: TIMESTEP") :]


def width(m):
    """Of the bounds of a measured value; of a one-sided one its size."""
    if math.isfinite(m.least) and math.isfinite(m.most):
        return m.most - m.least
    return max(abs(m.most) if math.isfinite(m.most) else abs(m.least), abs(m.value))


def rank_faults(ways):
    """Values that differ between numbers of ranks by more than they may, of one scheme: texts."""
    found = []
    done = [w for w in ways if w.result]
    for rows in zip(*(w.measured for w in done)):
        values = [m.value for m in rows]
        most = max(m.rank_spread * width(m) for m in rows) + 1e-12
        if not max(values) - min(values) <= most:
            texts = ", ".join(f"{v:.8g} on {w.ranks}" for v, w in zip(values, done))
            found.append(f"{rows[0].name} depends on the number of ranks: {texts}")
    if len({len(w.measured) for w in done}) > 1:
        found.append("other outcomes on other numbers of ranks")
    return found


class Suite:
    """All ways of all scenes that were asked for."""

    def __init__(self, scenes, schemes, ranks, folder, full):
        self.scenes, self.folder, self.full = scenes, folder, full
        folder.mkdir(parents=True, exist_ok=True)
        self.ways = [
            Way(s, scheme, n, folder)
            for s in scenes
            for scheme in s.schemes
            for n in s.ranks
            if scheme in schemes and n in ranks
        ]

    def of(self, scene, scheme=None):
        return [w for w in self.ways if w.scene is scene and scheme in (None, w.scheme)]

    def run(self, again, say=print):
        """Run what has no result."""
        todo = [w for w in self.ways if again or not w.result]
        todo.sort(key=lambda way: way.ranks)  # so that every scene has a result soon
        begun = time.time()
        for k, way in enumerate(todo):
            way.run(self.full)
            left = (time.time() - begun) / (k + 1) * (len(todo) - k - 1)
            say(
                f"[hard {time.strftime('%H:%M')}] {k + 1} of {len(todo)}: {way.name}: "
                f"{'right' if way.good else 'WRONG'}, {way.result['seconds']:.0f} s; time left: "
                f"{clock(left)}",
                flush=True,
            )
            for fault in way.result["faults"]:
                say(f"    {fault.splitlines()[0]}", flush=True)

    def faults(self, scene):
        """Everything that is wrong with a scene."""
        found = []
        for scheme in scene.schemes:
            ways = self.of(scene, scheme)
            found += [
                f"{w.scheme}, {w.ranks}: {f}" for w in ways if w.result for f in w.result["faults"]
            ]
            found += [f"{scheme}: {f}" for f in rank_faults(ways)]
        return found

    def verdict(self, scene):
        done = [w for w in self.of(scene) if w.result]
        if not done:
            return "not run"
        if self.faults(scene) or not all(w.good for w in done):
            return "WRONG"
        return "right"

    def rows(self):
        """One row per measured value and way."""
        for way in self.ways:
            for m in way.measured:
                yield dict(
                    scene=way.scene.name,
                    scheme=way.scheme,
                    ranks=way.ranks,
                    measured=m.name,
                    value=m.value,
                    least=m.least,
                    most=m.most,
                    unit=m.unit,
                    right=m.good,
                )

    def write(self):
        """table.csv, table.txt; returns the text."""
        rows = list(self.rows())
        with open(self.folder / "table.csv", "w", newline="", encoding="utf-8") as out:
            table = csv.DictWriter(
                out,
                ["scene", "scheme", "ranks", "measured", "value", "least", "most", "unit", "right"],
            )
            table.writeheader()
            table.writerows(rows)
        lines = []
        for scene in self.scenes:
            ways = [w for w in self.of(scene) if w.result]
            seconds = sum(w.result["seconds"] for w in ways)
            lines.append(
                f"{self.verdict(scene):8s} {scene.name:40s} {len(ways)} of "
                f"{len(self.of(scene))} ways, {sum(len(w.measured) for w in ways)} values, "
                f"{seconds:.0f} s"
            )
            lines += [f"         {fault.splitlines()[0]}" for fault in self.faults(scene)]
        text = "\n".join(lines) + "\n"
        (self.folder / "table.txt").write_text(text)
        return text

    def draw(self):
        """A picture of each scene, by the project's own renderer."""
        for scene in self.scenes:
            dump, picture = (self.folder / f"{scene.name}{end}" for end in (".dump", ".png"))
            if not dump.exists() or (
                picture.exists() and picture.stat().st_mtime > dump.stat().st_mtime
            ):
                continue
            how = (
                ["--section", scene.section]
                if scene.section
                else ["--view", scene.view, "--color", "cell", "--edges"]
            )
            words = ["render", str(dump), *how, "--size", "480", "-o", str(picture)]
            if lammps_dcm(words):  # imported once: it loads VTK
                print(f"[hard] no picture of {scene.name}")


# ---------------------------------------------------------------------- the page of the manual

INTRO = """.. This page is written by tools/hard --page.

Hard cases
==========

The package goes on with a right result, or stops with one error that names style, cell, step,
value and remedy. {count} scenes in which that is hard are run on 1, 2, 3 and 4 ranks, with the
explicit and the implicit step of :doc:`fix dcm/motion <fix_dcm_motion>`::

   tools/hard                        # all scenes, all ways; can be stopped and called again
   tools/hard crushed_to_40_percent  # one
   tools/hard --full                 # the long versions
   tools/hard --page                 # and this page

Each scene has a criterion: measured values, and between which bounds they are right. Bounds
follow from the laws or from a run that the case is compared with (half the step, the next mesh, a
free cell), never from a run of the case itself. All scenes also ask for finite numbers in every
frame, closed surfaces, forces that add up to those from outside, and cells that are in each other
by no more than a stated depth; the table has the worst of what was found on all numbers of ranks.
Values on different numbers of ranks agree to a hundredth of the width of the bounds, unless the
value is a residual. The scenes are functions in ``tests/hard``; ``tools/test tests/hard`` runs
each in two of the eight ways.

This page shows the {version} versions.  {summary}

"""


def number(value):
    return "--" if not math.isfinite(value) else f"{value:.4g}"


def bounds(m):
    if math.isfinite(m.least) and math.isfinite(m.most):
        return number(m.least) if m.least == m.most else f"{number(m.least)} to {number(m.most)}"
    return f"at most {number(m.most)}" if math.isfinite(m.most) else f"at least {number(m.least)}"


def badness(m):
    """How near to its bounds a value is; above 1: beyond."""
    if math.isfinite(m.least) and math.isfinite(m.most):
        half = 0.5 * (m.most - m.least)
        return abs(m.value - 0.5 * (m.least + m.most)) / half if half > 0 else abs(m.value - m.most)
    return m.value - m.most if math.isfinite(m.most) else m.least - m.value


def worst_values(ways):
    """Measured values by name, each the worst of all ways; a name that comes twice, too."""
    found = {}
    for way in ways:
        for m in way.measured:
            if m.name not in found or badness(m) > badness(found[m.name]):
                found[m.name] = m
    return found


def plain(text):
    """Text without what reStructuredText would read as markup."""
    for sign in "\\*`|_":
        text = text.replace(sign, "\\" + sign)
    return text


def section(suite, scene):
    """The lines of a scene on the page."""
    title = scene.name.replace("_", " ").capitalize()
    lines = [title, "^" * len(title), ""]
    if (suite.folder / f"{scene.name}.png").exists():
        lines += [
            f".. image:: img/hard/{scene.name}.png",
            "   :width: 220px",
            "   :align: right",
            f"   :alt: {title}",
            "",
        ]
    lines += [scene.sentence, "", f"*Right if:* {scene.criterion}", ""]
    outcomes = sorted({w.result["outcome"] for w in suite.of(scene) if w.result})
    seconds = sum(w.result["seconds"] for w in suite.of(scene) if w.result)
    done = sum(bool(w.result) for w in suite.of(scene))
    lines += [
        f"*Outcome:* **{suite.verdict(scene)}** in {done} of {len(suite.of(scene))} ways "
        f"({seconds:.0f} s): "
        + "; ".join(plain(" ".join(o.split())) for o in outcomes)
        + ".",
        "",
    ]
    for fault in suite.faults(scene):
        lines += [f"*Wrong:* {plain(' '.join(fault.split()))}", ""]
    by_scheme = {s: worst_values(suite.of(scene, s)) for s in scene.schemes}
    names = list(dict.fromkeys(n for values in by_scheme.values() for n in values))
    if names:
        lines += [
            ".. list-table::",
            "   :header-rows: 1",
            "   :widths: 40 24 18 18",
            "",
            "   * - measured",
            "     - right",
            "     - explicit",
            "     - implicit",
        ]
        for name in names:
            some = next(v[name] for v in by_scheme.values() if name in v)
            unit = f" ({some.unit})" if some.unit else ""
            lines += [f"   * - {plain(name)}{plain(unit)}", f"     - {bounds(some)}"]
            for scheme in SCHEMES:
                m = by_scheme.get(scheme, {}).get(name)
                lines.append(f"     - {number(m.value) if m else chr(92) + ' '}")
        lines.append("")
    return lines


def write_page(suite, root):
    """doc/hard_cases.rst and doc/img/hard."""
    images = root / "doc/img/hard"
    images.mkdir(parents=True, exist_ok=True)
    done = [w for w in suite.ways if w.result]
    right = sum(suite.verdict(s) == "right" for s in suite.scenes)
    summary = (
        f"{right} of {len(suite.scenes)} scenes are right; {len(done)} of {len(suite.ways)} ways, "
        f"{sum(len(w.measured) for w in done)} measured values."
    )
    for ranks in RANKS:
        all_ways = [w for w in suite.ways if w.ranks == ranks]
        left = sum(not w.result for w in all_ways)
        if left:
            summary += f" Not run on {ranks} rank{'s' * (ranks > 1)}: {left} of {len(all_ways)}."
    text = INTRO.format(
        count=len(suite.scenes), version="long" if suite.full else "quick", summary=summary
    )
    lines, family = [], None
    for scene in suite.scenes:
        if scene.family != family:
            family = scene.family
            lines += [family, "-" * len(family), ""]
        lines += section(suite, scene)
        picture = suite.folder / f"{scene.name}.png"
        if picture.exists():
            shrink(picture, images / picture.name)
    (root / "doc/hard_cases.rst").write_text(text + "\n".join(lines))


def shrink(source, target):
    """A small picture with few colors."""
    from PIL import Image

    with Image.open(source) as image:
        image = image.convert("RGB")
        image.thumbnail((320, 320))
        image.quantize(48).save(target, optimize=True)


# ---------------------------------------------------------------------- command line


def main(words=None):
    """Run the command line; returns the exit status."""
    parser = argparse.ArgumentParser(prog="tools/hard")
    parser.add_argument("scene", nargs="*")
    parser.add_argument("--root", type=Path, required=True)
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--ranks", default=",".join(map(str, RANKS)))
    parser.add_argument("--schemes", default=",".join(SCHEMES))
    parser.add_argument("--folder", type=Path)
    for flag in ("again", "report", "page", "list"):
        parser.add_argument(f"--{flag}", action="store_true")
    args = parser.parse_args(words)
    every = dict(families.in_order())
    unknown = [n for n in args.scene if n not in every]
    if unknown:
        parser.error(f"there is no scene {unknown[0]}; tools/hard --list has them")
    scenes = [every[n] for n in args.scene] or list(every.values())
    if args.list:
        for scene in scenes:
            print(f"{scene.name}\n    {scene.sentence}")
        return 0
    folder = args.folder or args.root / ("runs/hard_full" if args.full else "runs/hard")
    ranks = [int(n) for n in args.ranks.split(",")]
    suite = Suite(scenes, args.schemes.split(","), ranks, folder, args.full)
    try:
        if not args.report:
            suite.run(args.again)
    except KeyboardInterrupt:
        print("[hard] stopped; call it again to go on")
        return 130
    text = suite.write()
    suite.draw()
    if args.page:
        whole = Suite(list(SCENES.values()), SCHEMES, RANKS, folder, args.full)
        write_page(whole, args.root)
    print(text, end="")
    verdicts = [suite.verdict(s) for s in scenes]
    wrong = verdicts.count("WRONG")
    print(
        f"[hard] {verdicts.count('right')} of {len(scenes)} scenes right, {wrong} wrong, "
        f"{verdicts.count('not run')} not run; {folder}/table.txt"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
