"""The study of the lumen: a matrix of runs, resumable; its table, plot and verdict.

Every run has a folder of its own, ROW.seedN, with the deck and all it needs. `done` in it says that
it is complete, `failed` that it stopped with an error twice at the same place.
"""
import argparse
import csv
import itertools
import os
import shutil
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

# ---- acceptance, written down before the first run. The source says: a lumen needs directed
# division, local osmosis and timed differentiation together; constriction only moderately affects
# its size. The numbers are ours.
FACTOR = 2.0            # area(all) over area of each row that lacks one of the three, at least
CLOSED = 0.05           # area without osmosis over area(all), at most
MODERATE = 0.35         # |area(no constriction) - area(all)| over area(all), at most
LUMENS, CLOSURE = 1, 0.1    # lumens of `all`, and the missing part of its outline, at most
LEAST = 5.0             # um^2: a smaller section is no lumen
END = 0.5               # h: the area at the end is the mean over the last half hour
MIDDLE = 0.25, 0.75     # parts of the run: the area in the middle is the mean between these

EFFECTS = ("directed", "osmosis", "differentiation", "constriction")
FIVE = ("all", *(f"no_{effect}" for effect in EFFECTS))


def matrix():
    """All rows: name -> variables of the deck."""
    found = {}
    for values in itertools.product(("yes", "no"), repeat=len(EFFECTS)):
        off = [e for e, v in zip(EFFECTS, values) if v == "no"]
        name = "all" if not off else "none" if len(off) == len(EFFECTS) else "no_" + "_".join(off)
        found[name] = dict(zip(EFFECTS, values))
    everything = dict.fromkeys(EFFECTS, "yes")
    found["at_once"] = everything | {"differentiation": "now"}
    found["tracer"] = everything | {"marks": "tracer"}
    return found


def chosen_rows(text):
    """Rows that --rows means: name -> variables."""
    every = matrix()
    if text == "all":
        return every
    names = FIVE if text == "five" else text.split(",")
    unknown = [n for n in names if n not in every]
    if unknown:
        raise ValueError(f"--rows {text}: no row {unknown[0]}; there are all, five and, alone or "
                         f"with commas between them, {' '.join(every)}")
    return {n: every[n] for n in names}


# ---------------------------------------------------------------------- one run

@dataclass
class Run:
    """One run of the study. folder: its folder; variables: of the deck, seed included."""

    row: str
    seed: int
    folder: Path
    variables: dict

    @property
    def name(self):
        return f"{self.row}.seed{self.seed}"

    @property
    def done(self):
        return (self.folder / "done").exists()

    @property
    def failed(self):
        return (self.folder / "failed").exists()

    def prepare(self, deck, again=False, files=()):
        """Make the folder; `again`: forget a failure; `files`: take the place of the deck's."""
        self.folder.mkdir(parents=True, exist_ok=True)
        given = " ".join(f"{k}={v}" for k, v in sorted(self.variables.items()))
        note = self.folder / "variables"
        if note.exists() and note.read_text().strip() != given:
            raise ValueError(f"{self.folder} is of a run with other variables ({note.read_text()}"
                             f", now {given}): give another --folder")
        note.write_text(given + "\n")
        for file in Path(deck).parent.iterdir():
            if file.is_file() and not file.name.startswith("log."):
                shutil.copy(file, self.folder)
        for file in files:
            shutil.copy(file, self.folder)
        if again:
            for name in ("failed", "broken_at"):
                (self.folder / name).unlink(missing_ok=True)

    def restart(self):
        """Newest restart file, None if there is none; a file that is still being written or cut
        short is smaller than the others of the run."""
        files = [f for f in self.folder.glob("*.restart") if f.stat().st_size > 0]
        if not files:
            return None
        most = max(f.stat().st_size for f in files)
        whole = [f for f in files if f.stat().st_size > 0.5 * most]
        return max(whole, key=lambda f: (f.stat().st_mtime, f.name))

    def command(self, lmp, deck):
        """Command line; history and log of an earlier attempt are kept beside the new ones."""
        words = [*lmp, "-in", Path(deck).name, "-log", "log.study"]
        for name, value in self.variables.items():
            words += ["-var", name, str(value)]
        restart = self.restart()
        for name in ("lumen.txt", "log.study", "division.log", "lumen.dump"):
            old = self.folder / name
            if old.exists() and (restart or name == "log.study"):
                n = 1 + len(list(self.folder.glob(f"{name}.*")))
                old.rename(self.folder / f"{name}.{n:03d}")
        return words + (["-var", "from", restart.name] if restart else [])

    def finish(self, status):
        """After the run ended with `status`: notes it; returns True if it may be tried again."""
        if status == 0:
            (self.folder / "done").touch()
            return False
        hour, at = (self.history().get("hour") or [-1.0])[-1], self.folder / "broken_at"
        if at.exists() and hour <= float(at.read_text()):
            (self.folder / "failed").write_text(self.message())
            return False
        at.write_text(f"{hour}")
        return True

    def message(self):
        """The error in the output of the run."""
        out = self.folder / "out.study"
        lines = out.read_text(errors="replace").splitlines() if out.exists() else []
        return next((line for line in lines if "ERROR" in line),
                    lines[-1] if lines else "no output")

    def history(self):
        """Columns of lumen.txt, of all attempts: dict of name -> list, sorted by step; of a step
        that was run twice the later attempt counts."""
        rows, names = {}, None
        for file in [*sorted(self.folder.glob("lumen.txt.*")), self.folder / "lumen.txt"]:
            if not file.exists():
                continue
            for line in file.read_text(errors="replace").splitlines():
                if line.startswith("#"):
                    words = line[1:].split()
                    if words[:1] == ["step"]:
                        names = words
                    continue
                try:
                    values = [float(w) for w in line.split()]
                except ValueError:
                    continue    # cut short
                if names and len(values) == len(names):
                    rows[values[0]] = values
        table = [rows[step] for step in sorted(rows)]
        return {n: [r[k] for r in table] for k, n in enumerate(names or [])}

    def divisions(self):
        """Number of divisions, of all attempts."""
        events = set()
        for file in self.folder.glob("division.log*"):
            for line in file.read_text(errors="replace").splitlines():
                if line.strip() and not line.startswith("#"):
                    events.add(tuple(line.split()[:3]))    # step, time, mother: once each
        return len(events)


# ---------------------------------------------------------------------- running

def clock(seconds):
    """Text such as 1 h 05 min."""
    minutes = max(0, round(seconds / 60.0))
    return f"{minutes // 60} h {minutes % 60:02d} min" if minutes >= 60 else f"{minutes} min"


class Study:
    """Runs the runs that are not done, `jobs` at a time."""

    def __init__(self, runs, deck, lmp, jobs, hours, again=False, pause=2.0, say=print,
                 files=()):
        self.runs, self.deck, self.lmp, self.jobs, self.hours = runs, deck, lmp, jobs, hours
        self.pause, self.say = pause, say
        for run in runs:
            run.prepare(deck, again, files)
        self.begun, self.at_start = time.time(), None

    def simulated(self):
        """Hours of all runs together that are behind us."""
        total = 0.0
        for run in self.runs:
            if run.done:
                total += self.hours
            elif not run.failed:
                hour = run.history().get("hour") or [0.0]
                total += min(max(hour[-1], 0.0), self.hours)
        return total

    def progress(self, running):
        """One line: how many runs are done, which run, time left."""
        now, every = self.simulated(), self.hours * sum(not r.failed for r in self.runs)
        self.at_start = now if self.at_start is None else self.at_start
        elapsed, made = time.time() - self.begun, now - self.at_start
        left = clock(elapsed * (every - now) / made) if made > 0.0 else "not known yet"
        names = ", ".join(f"{r.name} {(r.history().get('hour') or [0])[-1]:.1f} h" for r in running)
        failed = sum(r.failed for r in self.runs)
        return (f"[study {time.strftime('%H:%M')}] {sum(r.done for r in self.runs)} of "
                f"{len(self.runs)} runs done{f', {failed} failed' if failed else ''}; running: "
                f"{names or 'none'} of {self.hours:g} h; time left: {left}")

    def run(self):
        """Run all; children are ended if this is interrupted."""
        waiting = [r for r in self.runs if not r.done and not r.failed]
        children, told = {}, 0.0
        try:
            while waiting or children:
                while waiting and len(children) < self.jobs:
                    run = waiting.pop(0)
                    words = run.command(self.lmp, self.deck)
                    with open(run.folder / "out.study", "w", encoding="utf-8") as out:
                        children[run.name] = (run, subprocess.Popen(
                            words, cwd=run.folder, stdout=out, stderr=subprocess.STDOUT))
                for name, (run, child) in list(children.items()):
                    if child.poll() is None:
                        continue
                    del children[name]
                    if run.finish(child.returncode):
                        self.say(f"[study] {name} stopped: {run.message()}; once more from "
                                 f"{run.restart().name if run.restart() else 'its beginning'}")
                        waiting.append(run)
                    told = 0.0
                if time.time() - told > 60.0:
                    told = time.time()
                    self.say(self.progress([run for run, _ in children.values()]))
                time.sleep(self.pause)
        finally:
            for _, child in children.values():
                child.terminate()
            for _, child in children.values():
                child.wait()


# ---------------------------------------------------------------------- results

MEASURES = ("area", "middle", "torn", "largest", "lumens", "closure", "around",
            "cholangiocytes", "cells", "divisions")


def measures(run):
    """What a run that is done comes to, see MEASURES; None without a history."""
    history = run.history()
    if not history.get("section"):
        return None
    last = history["hour"][-1]
    end = [k for k, h in enumerate(history["hour"]) if h > last - END]
    middle = [k for k, h in enumerate(history["hour"])
              if MIDDLE[0] * last <= h <= MIDDLE[1] * last]

    def mean(name, rows=end):    # over time: rows are as far apart as the steps are long
        if name not in history or not rows:
            return float("nan")
        hours, values = ([history[n][k] for k in rows] for n in ("hour", name))
        if hours[-1] == hours[0]:
            return statistics.fmean(values)
        return sum(0.5 * (a + b) * (t - s) for a, b, s, t in
                   zip(values, values[1:], hours, hours[1:])) / (hours[-1] - hours[0])

    # marks that have reached the outside through a torn wall enclose the tissue: less than nothing
    torn = any(v < -LEAST for v in history["section"])
    return dict(area=mean("section"), middle=mean("section", middle), torn=float(torn),
                largest=max(history["section"]), lumens=mean("lumens"),
                closure=mean("closure"), around=mean("around"),
                cholangiocytes=history.get("cholangiocytes", [float("nan")])[-1],
                cells=history.get("cells", [float("nan")])[-1], divisions=run.divisions())


def summarize(runs):
    """Rows of the table: name -> dict with the number of runs that are done (`seeds`) and failed,
    and of each of MEASURES its mean and, of the area, the standard deviation `sd`."""
    rows = {}
    for run in runs:
        row = rows.setdefault(run.row, dict(found=[], failed=0))
        row["failed"] += run.failed
        values = measures(run) if run.done else None
        if values:
            row["found"].append(values)
    table = {}
    for name, row in rows.items():
        found = row["found"]
        table[name] = dict(seeds=len(found), failed=row["failed"])
        for measure in MEASURES:
            values = [f[measure] for f in found]
            table[name][measure] = statistics.fmean(values) if values else float("nan")
        table[name]["sd"] = (statistics.stdev(f["area"] for f in found) if len(found) > 1
                             else float("nan"))
    return table


def verdict(table):
    """Statements of the acceptance test: list of (text, True, False or None where rows lack)."""
    def area(name):
        return table[name]["area"] if table.get(name, {}).get("seeds") else None

    whole = area("all")
    found = [(f"everything on: a lumen of more than {LEAST:g} um^2",
              None if whole is None else whole > LEAST)]
    for effect in ("directed", "osmosis", "differentiation"):
        less = area(f"no_{effect}")
        known = whole is not None and less is not None
        text = f"area(all) > {FACTOR:g} x area(no {effect})"
        found.append((f"{text}: {whole:.1f}, {less:.1f} um^2" if known else text,
                      whole > FACTOR * less and whole > LEAST if known else None))
    less = area("no_osmosis")
    known = whole is not None and less is not None
    found.append((f"area(no osmosis) < {100 * CLOSED:g} % of area(all)",
                  less < CLOSED * whole if known else None))
    less = area("no_constriction")
    known = whole is not None and less is not None
    text = f"area without constriction within {100 * MODERATE:g} % of area(all)"
    found.append((f"{text}: {100 * (less / whole - 1.0):+.0f} %" if known and whole > 0 else text,
                  abs(less - whole) < MODERATE * whole if known else None))
    if whole is None:
        found.append((f"lumens(all) = {LUMENS}, closure < {CLOSURE:g}", None))
    else:
        lumens, closure = table["all"]["lumens"], table["all"]["closure"]
        found.append((f"lumens(all) = {LUMENS}, closure < {CLOSURE:g}: {lumens:.2f}, {closure:.3f}",
                      abs(lumens - LUMENS) < 0.05 and closure < CLOSURE))
    return found


def report_text(table):
    """Table and verdict as text."""
    names = ("area", "sd", *MEASURES[1:])
    lines = [f"{'row':32s} {'seeds':>6s}" + "".join(f"{n:>15s}" for n in names)]
    for name, row in table.items():
        line = f"{name:32s} {row['seeds']:6d}" + "".join(
            f"{row[n]:15.3g}" if row[n] == row[n] else f"{'-':>15s}" for n in names)
        lines.append(line + (f"   {row['failed']} failed" if row["failed"] else ""))
    lines += ["",
              "areas of the section in um^2, means over the seeds: of the end, with its standard",
              "deviation sd, and of the middle half of the run; torn: part of the runs whose marks",
              "have reached the outside",
              "", "against the published outcome (acceptance numbers: tools/lib/study.py):"]
    results = verdict(table)
    for text, passed in results:
        word = "not known" if passed is None else "yes" if passed else "NO"
        lines.append(f"  {word:10s} {text}")
    passes = [p for _, p in results]
    lines.append("verdict: " + ("the published outcome is found" if all(passes) else
                                "not complete" if None in passes and False not in passes else
                                "the published outcome is NOT found"))
    return "\n".join(lines)


def plot(path, runs):
    """Area over time: mean of the seeds, and the range, of the five rows."""
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(8, 5), layout="constrained")
    colors = dict(zip(FIVE, ("#111111", "#1c7ed6", "#e03131", "#2b8a3e", "#f08c00")))
    for row in FIVE:
        curves = [r.history() for r in runs if r.row == row]
        curves = [(c["hour"], c["section"]) for c in curves if c.get("section")]
        if not curves:
            continue
        hours = np.arange(0.0, min(h[-1] for h, _ in curves) + 1e-9, 1.0 / 60.0)
        values = np.array([np.interp(hours, h, s) for h, s in curves])
        axes.plot(hours, values.mean(axis=0), color=colors[row], lw=2,
                  label=f"{row.replace('_', ' ')} ({len(curves)})")
        axes.fill_between(hours, values.min(axis=0), values.max(axis=0), color=colors[row],
                          alpha=0.15, lw=0)
    axes.set(xlabel="time, h", ylabel="section of the largest lumen, um$^2$", ylim=(0, None))
    axes.legend(title="row (seeds)")
    figure.savefig(path, dpi=120)
    pyplot.close(figure)


def report(runs, folder, say=print):
    """Write table.csv, table.txt and area.png, and print the table."""
    table = summarize(runs)
    with open(folder / "table.csv", "w", encoding="ascii", newline="") as handle:
        writer = csv.writer(handle)
        names = ("seeds", "failed", "area", "sd", *MEASURES[1:])
        writer.writerow(["row", *names])
        writer.writerows([name, *(row[n] for n in names)] for name, row in table.items())
    text = report_text(table)
    (folder / "table.txt").write_text(text + "\n")
    plot(folder / "area.png", runs)
    say(text)
    for run in runs:
        if run.failed:
            say(f"failed: {run.name}: {(run.folder / 'failed').read_text().strip()}")
    say(f"in {folder}: table.csv, table.txt, area.png")
    return table


# ---------------------------------------------------------------------- command line

def parse(words):
    """Options of the command."""
    parser = argparse.ArgumentParser(prog="tools/study lumen")
    parser.add_argument("--root", type=Path, required=True)
    parser.add_argument("--lmp", required=True)
    parser.add_argument("--rows", default="all")
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--hours", type=float)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE")
    parser.add_argument("--with", nargs="+", default=[], type=Path, dest="files")
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--pause", type=float, default=2.0, help=argparse.SUPPRESS)
    args = parser.parse_args(words)
    if args.jobs < 1:
        raise ValueError(f"--jobs {args.jobs}: at least 1")
    if args.hours is not None and not args.hours > 0.0:
        raise ValueError(f"--hours {args.hours:g}: must be positive")
    args.rows = chosen_rows(args.rows)
    try:
        args.seeds = [int(s) for s in args.seeds.split(",")]
        args.set = dict(word.split("=", 1) for word in args.set)
    except ValueError:
        raise ValueError("--seeds takes whole numbers with commas between them, --set takes "
                         "NAME=VALUE ...") from None
    if args.set and args.folder is None:
        raise ValueError("--set changes the runs: give them a --folder of their own")
    if min(args.seeds) < 1:
        raise ValueError("--seeds: positive numbers")
    return args


def main(words=None):
    """Run the study that the command line asks for; returns the exit status."""
    try:
        args = parse(sys.argv[1:] if words is None else words)
        folder = (args.folder or args.root / "runs" / "study_lumen").resolve()
        extra = dict(args.set) | ({} if args.hours is None else {"hours": f"{args.hours:g}"})
        runs = [Run(row, seed, folder / f"{row}.seed{seed}", variables | extra | {"seed": seed})
                for seed in args.seeds for row, variables in args.rows.items()]
        folder.mkdir(parents=True, exist_ok=True)
        if not args.report:
            deck = args.root / "examples" / "bile_duct_day" / "in.bile_duct_day"
            Study(runs, deck, args.lmp.split(), args.jobs, args.hours or 8.0, args.again,
                  args.pause, files=args.files).run()
        report(runs, folder)
    except KeyboardInterrupt:
        print("[study] stopped; the same command goes on from here")
        return 130
    except (ValueError, OSError) as err:
        print(f"tools/study: {err}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
