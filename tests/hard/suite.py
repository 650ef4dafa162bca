"""The hard-case suite: what a scene is, and what it is run in.

A scene is a function of a Case. Its docstring has one sentence for the reader, an empty line,
and its criterion. It makes decks, runs them with case.run(), and says with case.check() what it
measured and between which bounds that is right. tests/hard/test_hard_scenes.py runs each scene
in two ways, tools/hard all of them in all ways and writes the table and the page of the manual."""

import contextlib
import re
from dataclasses import dataclass, field

import numpy as np

from hard.surfaces import deepest_overlap, deepest_sphere, read_snapshots
from support.runner import Result

SCHEMES = ("explicit", "implicit")
RANKS = (1, 2, 3, 4)

# kPa/um, stiffness of law foundation between two cells of the tests' parameter file, which the
# bounds of depths are made of: decks of the suite state the layer
LAYER, E_CONTACT, NU_CONTACT = 0.25, 5.0, 0.4
STIFFNESS = E_CONTACT / (2.0 * LAYER * (1.0 - NU_CONTACT**2))

SCENES = {}


@dataclass
class Scene:
    """A scene of the suite. family: heading in the manual; view, section: of its picture; schemes:
    with which it makes sense; quick: the only one with which the tests run it, others take long."""

    name: str
    family: str
    sentence: str
    criterion: str
    function: object
    view: str = "xy"
    section: str = ""
    schemes: tuple = SCHEMES
    ranks: tuple = RANKS
    quick: str = ""


def hard(family, **options):
    """Decorator: the function is a scene of the suite."""

    def enter(function):
        sentence, _, criterion = function.__doc__.partition("\n\n")
        tidy = lambda text: " ".join(text.split())  # noqa: E731
        name = function.__name__
        SCENES[name] = Scene(name, family, tidy(sentence), tidy(criterion), function, **options)
        return function

    return enter


@dataclass
class Measured:
    """A measured value and the bounds between which it is right."""

    name: str
    value: float
    least: float
    most: float
    unit: str = ""
    rank_spread: float = (
        0.01  # what may differ between numbers of ranks, of the width of the bounds
    )

    @property
    def good(self):
        return bool(self.least <= self.value <= self.most)  # no number is not

    def __str__(self):
        low = f"{self.least:.4g} <= " if np.isfinite(self.least) else ""
        high = f" <= {self.most:.4g}" if np.isfinite(self.most) else ""
        return f"{self.name}: {low}{self.value:.6g}{high} {self.unit}".strip()


@dataclass
class Case:
    """A scene in one way of running: number of ranks, scheme; full: long versions, all checks."""

    lmp: object  # support.runner.Runner
    scenes: object  # support.scenes
    ranks: int = 1
    scheme: str = "explicit"
    full: bool = False
    timeout: float = 120.0
    measured: list = field(default_factory=list)
    outcomes: list = field(default_factory=list)
    picture: object = None  # path of a dump
    log: list = field(default_factory=list)

    @property
    def implicit(self):
        return self.scheme == "implicit"

    def pick(self, explicit, implicit):
        """What depends on the scheme, a time step for instance."""
        return implicit if self.implicit else explicit

    # ---- decks

    def motion(self, scene, options="", group="all"):
        """fix dcm/motion; solved tightly enough that ranks agree."""
        return scene.motion(group, f"scheme {self.scheme} tolerance 1e-8 {options}")

    def contact(self, scene, style="", coeff=""):
        """Law foundation with the layer the bounds of depths are made of."""
        layer = "" if "law" in style and "foundation" not in style else f"layer {LAYER}"
        style = style if "law" in style else f"law foundation {style}"
        return scene.contact(style, coeff if "layer" in coeff else f"{layer} {coeff}")

    def deck(
        self,
        scene,
        time,
        dt,
        *,
        frames=4,
        cortex=None,
        contact=None,
        volume="",
        motion=None,
        before="",
        extra="",
        thermo=(),
        group="all",
        maxmove="",
        settle=None,
        then="",
        auto="",
    ):
        """A complete deck that covers `time` in steps of dt, with so many frames in its dump;
        negative: at logarithmic distances, for what decays.

        before: ahead of the fixes; extra: ahead of fix dcm/motion; thermo: more columns,
        name=formula. settle: (time, dt) of a run before, whose frames do not count; then: commands
        between the two. auto: keywords of dt auto, for steps chosen by their error (implicit).
        """
        steps = max(1, round(time / dt))
        every = max(1, steps // frames) if frames > 0 else 1
        options = f"maxmove {maxmove}" if maxmove else ""
        run = f"run {steps // every * every}\n"
        if auto:
            options += f" dt auto {auto} stop {time!r}"
            run = f"dump_modify d every/time {time / frames!r}\nrun 100000000\n"
            every = 1
        has_dcm = cortex is not None or any("single hep" in c for c in scene.cells)
        return (
            scene.head()
            + ((scene.cortex() if cortex is None else cortex) if has_dcm else "")
            + (self.contact(scene) if contact is None else contact)
            + before
            + "fix cell all dcm/cell\n"
            + ((volume or scene.volume()) if has_dcm else "")
            + extra
            + (self.motion(scene, options, group) if motion is None else motion)
            + (
                f"timestep {settle[1]!r}\nrun {round(settle[0] / settle[1])}\nreset_timestep 0\n"
                if settle
                else ""
            )
            + then
            + self.output((steps, -frames) if frames < 0 else every, has_dcm, thermo)
            + f"timestep {dt!r}\n"
            + run
        )

    def output(self, every, has_dcm=True, thermo=()):
        """Dump and thermo of a deck. The dump holds all that the measures need."""
        names = {
            "c_p[1]": "kind",
            "c_p[2]": "v1",
            "c_p[3]": "v2",
            "c_p[4]": "v3",
            "c_p[5]": "volume0",
        }
        colnames = " ".join(f"colname {a} {b}" for a, b in names.items())
        often = every
        text = ""
        if isinstance(every, tuple):  # steps, frames
            text = f"variable often equal logfreq3(1,{every[1]},{every[0]})\n"
            often, every = "v_often", 1000000
        text += (
            "compute p all property/atom kind vertex1 vertex2 vertex3 volume0\n"
            f"dump d all custom {every} dump.txt id mol type radius xu yu zu vx vy vz fx fy fz "
            + " ".join(names)
            + f"\ndump_modify d sort id time yes {colnames} format float %.17g first yes"
            + (f" every {often}\n" if often != every else "\n")
        )
        columns = []
        for column in thermo:
            name, _, formula = column.partition("=")
            text += f"variable {name} equal {formula}\n" if formula else ""
            columns.append(f"v_{name}" if formula else name)
        energies = "ebond edihed f_volume" if has_dcm else ""
        return text + (
            f"thermo_style custom step time atoms {energies} epair f_motion[*] "
            + " ".join(columns)
            + "\n"
            f"thermo_modify norm no format float %.17g\nthermo {often}\n"
        )

    # ---- running

    def run(self, deck, files=None, ranks=None, show=False, fails=False):
        """Run a deck; a LAMMPS error makes the case fail unless the scene expects one (fails)."""
        result = self.lmp.run(deck, np=ranks or self.ranks, files=files, timeout=self.timeout)
        result.__class__ = Run
        result.thermo = result.runs[-1] if result.runs else []
        self.log.append(str(result.path))
        if not fails and result.returncode != 0:
            self.outcomes.append("error: " + (result.error or result.tail()))
            raise Stopped(self.outcomes[-1])
        if show or self.picture is None:
            self.picture = result.path / "dump.txt"
        return result

    # ---- judging

    def check(self, name, value, most=np.inf, least=-np.inf, unit="", spread=0.01):
        """Note a measured value; most, least: where it is right."""
        self.measured.append(Measured(name, float(value), float(least), float(most), unit, spread))

    def close(self, name, value, expected, rel=None, tol=None, unit="", spread=0.01):
        """The same for a value that is to be near another."""
        width = tol if tol is not None else rel * abs(expected)
        self.check(name, value, expected + width, expected - width, unit, spread)

    def sound(
        self,
        run,
        *,
        depth=0.25,
        quality=0.05,
        volume=None,
        force=(0.0, 0.0, 0.0),
        periodic=False,
        balanced=True,
    ):
        """What holds in every scene, in the last frame (finite numbers: in all of them).

        depth: deepest overlap in mean edges, 0.25 is what the pair style warns from (0.3 of the
        0.75 that end a run); volume: bounds of V/V0 from the pressures a scene can have; force:
        the external one."""
        self.note("sound")
        last = run.last
        finite = all(
            np.isfinite(frame[name]).all()
            for frame in run.frames
            for name in ("xu", "yu", "zu", "vx", "vy", "vz", "fx", "fy", "fz")
        )
        finite &= all(np.isfinite(list(row.values())).all() for row in run.thermo)
        self.check("numbers that are not finite", 0 if finite else 1, most=0)
        cells = last.cells.values()
        if cells:
            broken = sum(not c.closed or not c.volume > 0.0 for c in cells)
            self.check("surfaces not closed", broken, most=0)
            self.check("worst face", min(c.quality for c in cells), least=quality, spread=0.05)
            if volume:
                rest = {int(m): v for m, v in zip(last["mol"], last["volume0"]) if v > 0.0}
                ratios = [c.volume / rest[c.molecule] for c in cells]
                self.check("smallest V/V0", min(ratios), least=volume[0], most=volume[1])
                self.check("largest V/V0", max(ratios), least=volume[0], most=volume[1])
        if len(cells) > 1 and depth:
            deep, _ = deepest_overlap(last, periodic)
            self.check("deepest overlap", deep, most=depth, unit="edges", spread=0.05)
        if cells and last.spheres:
            self.check("depth of spheres", deepest_sphere(last), most=0.9, unit="R", spread=0.05)
        if balanced:
            f = last.f[last.moving]
            off = np.abs(f.sum(axis=0) - np.array(force)).max()
            # sums of 1e3 to 1e5 terms in double precision
            self.check("sum of forces", off / max(np.abs(f).sum(), 1e-30), most=1e-9, spread=1.0)

    def stopped(self, run, *patterns):
        """The run ended in an error that has all patterns, in a step one on each process that sees
        it, before the first step one in all; no frame has a NaN."""
        errors = sorted(
            {line.partition(": ")[2] for line in run.out.splitlines() if "ERROR" in line}
        )
        self.check("return code", run.returncode != 0, least=1)
        self.check(
            "error lines", len(errors), least=1, most=self.ranks if run.thermo else 1, spread=1.0
        )
        text = errors[0] if errors else ""
        for pattern in patterns:
            says = sum(bool(re.search(pattern, e)) for e in errors) == len(errors) > 0
            self.check(f"the error says /{pattern}/", says, least=1)
        self.check(
            "numbers that are not finite",
            sum(not np.isfinite(f.x).all() for f in run.frames),
            most=0,
        )
        self.note("stops: " + re.sub(r"\s*\(.*?\.cpp:\d+\)", "", text))

    def note(self, outcome):
        """Each outcome once; numbers of the messages may differ from run to run."""
        if outcome not in self.outcomes:
            self.outcomes.append(outcome)

    @property
    def outcome(self):
        return "; ".join(self.outcomes)

    @property
    def good(self):
        return not self.faults()

    def faults(self):
        return [str(m) for m in self.measured if not m.good] + [
            o for o in self.outcomes if o.startswith("error")
        ]


# error of a run that may stop: style, cell, step and remedy
NAMED = (r"dcm/", r"cells? \d+", r"step \d+", r"reduce|smaller|use |raise|give|[;:,] ")


class Stopped(Exception):
    """A run of a scene ended in an error that the scene did not ask for."""


class Run(Result):
    """A run of a scene, with the frames of its dump."""

    @property
    def frames(self):
        if not hasattr(self, "_frames"):
            path = self.path / "dump.txt"
            self._frames = read_snapshots(path) if path.exists() else []
        return self._frames

    @property
    def first(self):
        return self.frames[0]

    @property
    def last(self):
        return self.frames[-1]


def perform(scene, case):
    """Run and judge; returns the case."""
    with contextlib.suppress(Stopped):
        scene.function(case)
    return case
