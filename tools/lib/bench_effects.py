"""tools/bench effects: what an effect adds to a step, named, named but idle, and unnamed.

The decks are in effects_decks.py. Instructions are those inside LAMMPS' loop over steps, counted
by callgrind, so that set-up drops out; messages the difference of two run lengths on two ranks
(count_messages.c); memory what is allocated at the end of a run, per rank. All three are counts:
they do not depend on what else the machine does. Seconds (--seconds) are user CPU time in the loop.

Standard library only; expects the environment that tools/bench sets (DCM_LMP, LAMMPS_PLUGIN_PATH).
"""

import argparse
import hashlib
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path

import effects_build
from effects_decks import EFFECTS, ROOT, SCENES, STEPS, missing, registered
from effects_jobs import Store, base_job, jobs_of
from effects_tables import LIMIT, UNNAMED, Tables, machine, over, percent_of, unlike, write

PAIRS = 3    # runs with and without, in turn, of --seconds


def build_of(folder):
    """Which plugin: results of another one do not count."""
    plugin = Path(folder) / "dcmplugin.so"
    if not plugin.is_file():
        sys.exit(f"no {plugin}; use tools/bench effects, which builds it")
    return hashlib.sha256(plugin.read_bytes()).hexdigest()[:12]


# ---- runs


class Runs:
    """Run decks of jobs in a folder with the plugin of another folder."""

    def __init__(self, folder, plugins):
        self.folder, self.plugins = folder, str(plugins)
        self.shim = folder.parent / "count_messages.so"

    def lmp(self, text, scene, front=(), env=None, ranks=1):
        """Run a deck; returns its log and what it wrote to stderr."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        (self.folder / "in.deck").write_text(text)
        (self.folder / "cells.txt").write_text(SCENES[scene].cells)
        parameters = (ROOT / "potentials/bile_duct.dcm").read_text()
        (self.folder / "bile_duct.dcm").write_text(parameters)
        (self.folder / "cycles.dcm").write_text(cycles(parameters))
        mpi = ["mpirun", "-np", str(ranks), "env"] if ranks > 1 else ["env"]
        command = [*mpi, *(f"{k}={v}" for k, v in (env or {}).items()), *front,
                   os.environ["DCM_LMP"], "-in", "in.deck", "-screen", "none", "-nocite"]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True,
                              check=False, env=os.environ | {"LAMMPS_PLUGIN_PATH": self.plugins})
        log = (self.folder / "log.lammps").read_text()
        if done.returncode or "Loop time" not in log:
            raise RuntimeError(f"{log[-1500:]}{done.stdout[-800:]}{done.stderr[-800:]}"
                               f"the deck is in {self.folder}")
        return log, done.stderr

    def instructions(self, job):
        """Instructions a step (an event: in all), iterations of a solve, what `acts` came to."""
        front = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
                 "--toggle-collect=LAMMPS_NS::Verlet::run(int)"]
        log, err = self.lmp(job.deck(), job.scene, front)
        total = int(re.search(r"Collected : (\d+)", err)[1])
        found = {"instructions": total / job.steps, "iterations": iterations(log)}
        if job.acts:
            found["acts"] = last_row(log)[1]
        return found

    def counts(self, job):
        """Messages and bytes a step of a rank (an event: of its step), bytes allocated a rank."""
        short, long = (job.steps - 1, job.steps) if job.per == "event" else (STEPS, 3 * STEPS)
        rows = [self.counted(job, steps) for steps in (short, long)]
        sent = [(b - a) / (long - short) for a, b in zip(*rows)]
        last = rows[1] if job.per == "event" else rows[0]
        return {"messages": sum(sent[0:10:2]), "bytes": sum(sent[1:10:2]), "heap": last[12]}

    def counted(self, job, steps):
        env = {"LD_PRELOAD": self.shim, "DCM_COUNTS": "counts"}
        self.lmp(job.deck(steps), job.scene, env=env, ranks=2)
        ranks = [list(map(int, (self.folder / f"counts.{p}").read_text().split())) for p in (0, 1)]
        return [sum(column) / 2 for column in zip(*ranks)]

    def seconds(self, job):
        """User CPU seconds in the loop over steps, a step."""
        log, _ = self.lmp(job.deck(), job.scene)
        return loop_seconds(log) / job.steps


def cycles(parameters):
    """The parameter file with cycle times that differ from type to type."""
    for name, time_ in (("hepatoblast", 86400), ("cholangiocyte", 43200)):
        parameters = re.sub(rf"^(celltype {name}\b.*)$", rf"\1\n  cycle_time {time_}", parameters,
                            flags=re.MULTILINE)
    return parameters


def iterations(log):
    """Mean iterations of a solve of the last run, None without fix dcm/motion."""
    found = re.findall(r"solves of ([\d.]+) iterations", log)
    return float(found[-1]) if found else None


def last_row(log):
    return [float(w) for w in log[:log.rindex("Loop time")].rstrip().splitlines()[-1].split()]


def loop_seconds(log):
    wall = float(re.findall(r"Loop time of (\S+)", log)[-1])
    return wall * float(re.findall(r"([\d.]+)% CPU use", log)[-1]) / 100


class Progress:
    """Lines with the time that is left, from what runs of each kind and scene took so far."""

    def __init__(self, jobs):
        self.left = list(jobs)
        self.total = len(self.left)
        self.took = {}

    def done(self, job, seconds, text):
        self.took.setdefault((job.kind, job.scene), []).append(seconds)
        self.left.remove(job)
        mean = {k: statistics.mean(v) for k, v in self.took.items()}
        usual = statistics.mean(s for v in self.took.values() for s in v)
        left = sum(mean.get((j.kind, j.scene), usual) for j in self.left)
        print(f"[{self.total - len(self.left):4d}/{self.total}] {job.scene:5s} {job.kind:12s} "
              f"{job.what:48s} {text:24s} {left / 60:5.1f} min left", flush=True)


def text_of(found):
    if "instructions" in found:
        return f"{found['instructions'] / 1e6:.2f} million a step"
    return f"{found['messages']:.1f} messages a step"


def measure(jobs, runs, store, build):
    """Do the jobs whose results are not there yet; decks that fail are told and left out."""
    todo = {}
    for job in jobs:
        if job.key(build) not in store.known:
            todo.setdefault(job.key(build), job)
    progress, failed = Progress(todo.values()), []
    for key, job in todo.items():
        begin = time.perf_counter()
        try:
            found = getattr(runs, job.kind)(job)
        except RuntimeError as error:
            failed.append(job)
            print(f"{job.scene}, {job.what} failed:\n{error}", file=sys.stderr)
            shutil.copytree(runs.folder, runs.folder.parent / f"failed.{key}", dirs_exist_ok=True)
            progress.done(job, time.perf_counter() - begin, "FAILED")
            continue
        if job.acts and not found.get("acts", 1.0):
            failed.append(job)
            print(f"{job.scene}, {job.what}: {job.acts} is 0: the effect did not happen",
                  file=sys.stderr)
        store.put(key, found)
        progress.done(job, time.perf_counter() - begin, text_of(found))
    return failed


def measure_seconds(rows, runs, store, build):
    """User CPU time with and without, in turn: the ratio is the median of PAIRS."""
    todo = [(e, s) for e, s in rows if (j := jobs_of(e, s, "seconds"))
            and "s" + j["named"].key(build) + j["base"].key(build) not in store.known]
    begin = time.perf_counter()
    for n, (effect, scene) in enumerate(todo, 1):
        jobs = jobs_of(effect, scene, "seconds")
        try:
            pairs = [(runs.seconds(jobs["base"]), runs.seconds(jobs["named"]))
                     for _ in range(PAIRS)]
        except RuntimeError as error:    # a deck without cortex, say, does not stand so many steps
            print(f"{scene}, {effect.name}: no time:\n{error}", file=sys.stderr)
            continue
        store.put("s" + jobs["named"].key(build) + jobs["base"].key(build), pairs)
        left = (time.perf_counter() - begin) / n * (len(todo) - n)
        print(f"[{n:4d}/{len(todo)}] {scene:5s} seconds      {effect.name:48s} "
              f"{percent_of(pairs):+6.1f} %  {left / 60:5.1f} min left", flush=True)


# ---- command line


def options_of(arguments):
    parser = argparse.ArgumentParser(
        prog="tools/bench effects",
        description="What an effect adds to a step: instructions, memory, messages, time.")
    parser.add_argument("--unnamed", action="store_true",
                        help="against a program without the styles that the base decks do not name")
    parser.add_argument("--seconds", action="store_true",
                        help="user CPU time in turn; wants an idle machine")
    parser.add_argument("--only", default="", help="rows whose effect or style contains this")
    parser.add_argument("--scenes", default=",".join(SCENES), help="default: all")
    parser.add_argument("--folder", type=Path, default=ROOT / "runs/effects",
                        help="results; what is there is not measured again (default: runs/effects)")
    parser.add_argument("--page", action="store_true", help="write the tables of doc/effects.rst")
    parser.add_argument("--list", action="store_true", help="list the effects, measure nothing")
    return parser.parse_args(arguments)


def require_entries():
    """Every style of the package has an entry, or the tool ends with what to add."""
    without, gone = missing(registered())
    if without or gone:
        sys.exit("\n".join(
            [f"{style} has no entry: add an Effect to tools/lib/effects_decks.py, with a deck that "
             f"names it, one in which it has nothing to do, and one without" for style in without]
            + [f"{style} has an entry in tools/lib/effects_decks.py but no header in src/DCM "
               f"registers it: remove it" for style in gone]))


def main(arguments=None):
    wanted = options_of(arguments)
    require_entries()
    unknown = set(wanted.scenes.split(",")) - set(SCENES)
    if unknown:
        sys.exit(f"unknown scenes {', '.join(sorted(unknown))}; there are {', '.join(SCENES)}")
    rows = [(effect, scene) for scene in wanted.scenes.split(",") for effect in EFFECTS
            if scene in effect.scenes and wanted.only in f"{effect.name} {' '.join(effect.styles)}"]
    if not rows:
        sys.exit(f"no effect or style contains '{wanted.only}'; see --list")
    if wanted.list:
        for effect in (e for e in EFFECTS if e in [effect for effect, _ in rows]):
            print(f"{effect.name:40s} {' '.join(effect.styles)}")
        return
    folder = wanted.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    store, plugins = Store(folder / "results.json"), os.environ["LAMMPS_PLUGIN_PATH"]
    build, runs = build_of(plugins), Runs(folder / "run", plugins)
    subprocess.run(["mpicc", "-O1", "-shared", "-fPIC", "-o", runs.shim,
                    ROOT / "tools/lib/count_messages.c"], check=True)
    base = [base_job(kind, scene) for kind in ("instructions", "counts")
            for scene in wanted.scenes.split(",")]
    failed = []
    if wanted.unnamed:
        place = effects_build.build(folder)
        failed += measure(base, runs, store, build)
        failed += measure(base, Runs(folder / "run", place), store, build_of(place))
        store.put("few", build_of(place))
    elif wanted.seconds:
        measure_seconds(rows, runs, store, build)
    else:
        failed += measure(base + [job for effect, scene in rows
                                  for kind in ("instructions", "counts")
                                  for job in jobs_of(effect, scene, kind).values()],
                          runs, store, build)
    report(Tables(store, build), store, ROOT / "doc/effects" if wanted.page else folder)
    if failed:
        sys.exit(f"{len(failed)} decks failed, see above")


def report(tables, store, where):
    """Write the tables, and print what costs more than it may."""
    made = {"named": tables.named(), "events": tables.events(), "idle": tables.idle(),
            "scenes": tables.scenes(), "options": tables.options(),
            "unnamed": tables.unnamed(store.known.get("few", ""))}
    made = {name: list(rows) for name, rows in made.items()}
    for name, rows in made.items():
        write(where, name, rows)
    (where / "measured.txt").write_text(machine() + "\n")
    dear, there = over(made["idle"]), unlike(made["unnamed"])
    for row in dear:
        print(f"idle and over {LIMIT} % of a step: {', '.join(row)}")
    for row in there:
        print(f"not in the deck, and yet over {UNNAMED} % or a message: {', '.join(row)}")
    print(f"tables: {where}; results: {store.path}\nidle_over_limit: {len(dear)}")


if __name__ == "__main__":
    main()
