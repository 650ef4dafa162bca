"""tools/sweep: a deck for all combinations of values of its variables; one table. Standard library
only.

Every run has a folder of its own, such as W_0.1.seed_2, with the deck and all it needs, `out.txt`
(what LAMMPS prints) and `state`: a line of JSON with the variables, a hash of the inputs, the
outcome (done, failed) and the seconds it took.
"""
import argparse
import csv
import fcntl
import hashlib
import itertools
import json
import os
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from run_deck import REFERENCE, copy_files, name_of, needed_files, unknown_variables

PRINT = re.compile(r"\bprint\s+(?:\"\"\"(.*?)\"\"\"|\"([^\"]*)\"|'([^']*)')", re.DOTALL)
ROUNDS = 50    # of a loop that prints
PAUSE = 0.2    # s between two looks at the running processes


def combinations(given):
    """List of dicts name -> value, from (name, "value,value") pairs."""
    names = [name for name, _ in given]
    for name, text in given:
        if not all(v.strip() for v in text.split(",")):
            raise ValueError(f"-var {name} {text}: a value is empty")
        if names.count(name) > 1:
            raise ValueError(f"-var {name}: given twice; put all values into one: "
                             f"-var {name} {text},...")
    values = [dict.fromkeys(v.strip() for v in text.split(",")) for _, text in given]
    return [dict(zip(names, combination)) for combination in itertools.product(*values)]


def folder_name(variables):
    """Name of the folder of a run: W_0.1.seed_2; what does not fit a file name becomes -."""
    parts = [f"{n}_{re.sub(r'[^A-Za-z0-9.+_-]+', '-', v)}" for n, v in variables.items()]
    return ".".join(parts)


# ---------------------------------------------------------------------- what a run tells

def label_of(text):
    """The label of a number from the `text` before it: all of it if it ends in a colon, else what
    follows the last comma, colon or semicolon."""
    text = " ".join(text.split())
    if text.endswith(":"):
        return text.rstrip(": ")
    return re.split(r"[,;:]", text)[-1].strip(" =()")


def prints_of(text):
    """What a deck prints: list of (regular expression of a line, labels of its values)."""
    found = []
    text = re.sub(r"&[ \t]*\n", " ", re.sub(r"(?m)^\s*#.*$", "", text))
    for m in PRINT.finditer(text):
        for line in (m.group(1) or m.group(2) or m.group(3) or "").splitlines():
            pieces, values, at = [], [], 0
            for reference in REFERENCE.finditer(line):
                pieces.append(line[at:reference.start()])
                values.append(reference.group())
                at = reference.end()
            pieces.append(line[at:])
            if not values or not "".join(pieces).strip():
                continue
            labels, last = [], ""
            for piece in pieces[:-1]:
                label = label_of(piece)
                labels.append(label if label and re.search(r"[A-Za-z]", label) else last)
                last = labels[-1]
            found.append((re.compile(r"\s*(\S+?)\s*".join(re.escape(p.strip()) for p in pieces)
                                     + r"\s*"), labels))
    return found


def last_thermo(lines):
    """Dict of the last line of thermo output, {} if there is none."""
    names, row = None, {}
    for line in lines:
        words = line.split()
        if words[:1] == ["Step"]:
            names = words
        elif line.startswith("Loop time"):
            names = None
        elif names and len(words) == len(names):
            try:
                row = dict(zip(names, map(float, words)))
            except ValueError:
                continue    # a warning
    return row


def results(out, prints):
    """(printed, thermo): values by label, the last of each, from the lines that LAMMPS printed; of
    a loop of at most ROUNDS also those of each round."""
    printed = {}
    for pattern, labels in prints:
        found = [m.groups() for line in out if (m := pattern.fullmatch(line.strip()))]
        rounds = found if 1 < len(found) <= ROUNDS else []
        for k, values in [("", v) for v in found[-1:]] + list(enumerate(rounds, 1)):
            for label, value in zip(labels, values):
                label = (label or "value") + (f", round {k}" if k else "")
                name, n = label, 1
                while name in printed:
                    n += 1
                    name = f"{label} {n}"
                printed[name] = value
    return printed, {k: f"{v:.10g}" for k, v in last_thermo(out).items()}


# ---------------------------------------------------------------------- runs

class Run:
    """One run. variables: dict; folder: Path; inputs: hash of what it needs."""

    def __init__(self, parent, variables, deck):
        self.variables, self.deck = variables, deck
        self.folder = parent / folder_name(variables)
        self.inputs = hashlib.sha256()
        for file in sorted(needed_files(deck, variables.items())):
            self.inputs.update(str(file).encode() + (deck.parent / file).read_bytes())
        self.inputs = self.inputs.hexdigest()[:16]
        self.child = None

    def state(self):
        """Dict, {} if the run has not ended."""
        try:
            return json.loads((self.folder / "state").read_text())
        except (OSError, ValueError):
            return {}

    def open(self, again):
        """Whether it is to be run; an error if its folder has another run's results."""
        state = self.state()
        if state and state["variables"] != self.variables:
            raise ValueError(f"{self.folder} is of the values {state['variables']}: give another "
                             "-o")
        if state and state["inputs"] != self.inputs:
            if not again:
                raise ValueError(f"{self.deck} or a file it reads is not what it was for "
                                 f"{self.folder}: give another -o, or --again to run it anew")
            return True
        return not state or (again and state["outcome"] == "failed")

    def start(self, lmp, np):
        """Begin from nothing."""
        if self.folder.exists():
            for file in sorted(self.folder.rglob("*"), reverse=True):
                file.rmdir() if file.is_dir() and not file.is_symlink() else file.unlink()
        self.folder.mkdir(parents=True, exist_ok=True)
        copy_files(self.deck, self.folder, self.variables.items())
        words = [*(["mpirun", "-np", str(np)] if np > 1 else []), *shlex.split(lmp),
                 "-in", self.deck.name, "-log", f"log.{name_of(self.deck)}"]
        for name, value in self.variables.items():
            words += ["-var", name, value]
        self.begun = time.monotonic()
        with open(self.folder / "out.txt", "w") as out:
            self.child = subprocess.Popen(words, cwd=self.folder, stdin=subprocess.DEVNULL,
                                          stdout=out, stderr=subprocess.STDOUT)

    def ended(self):
        """Whether the process has ended; if so, its outcome is noted."""
        status = self.child.poll()
        if status is None:
            return False
        state = {"outcome": "failed" if status else "done", "variables": self.variables,
                 "inputs": self.inputs, "seconds": round(time.monotonic() - self.begun, 2)}
        if status:
            lines = self.output()
            state["error"] = next((s for s in lines if "ERROR" in s),
                                  lines[-1] if lines else f"status {status}, no output").strip()
        part = self.folder / "state.part"
        part.write_text(json.dumps(state) + "\n")
        part.rename(self.folder / "state")
        return True

    def output(self):
        try:
            return (self.folder / "out.txt").read_text(errors="replace").splitlines()
        except OSError:
            return []


def work(runs, lmp, np, jobs, say):
    """Run `runs`, `jobs` at a time."""
    waiting, running, begun = list(runs), [], time.monotonic()
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                running.append(waiting.pop(0))
                running[-1].start(lmp, np)
            time.sleep(PAUSE)
            for run in [r for r in running if r.ended()]:
                running.remove(run)
                made = len(runs) - len(waiting) - len(running)
                left = (time.monotonic() - begun) / made * (len(runs) - made)
                state = run.state()
                say(f"[sweep {time.strftime('%H:%M:%S')}] {made} of {len(runs)}: {run.folder.name} "
                    f"{state['outcome']} in {state['seconds']:.1f} s; about {left:.0f} s left"
                    + (f"\n  {state['error']}" if "error" in state else ""))
    finally:
        for run in running:
            run.child.terminate()
        for run in running:
            run.child.wait()


# ---------------------------------------------------------------------- the table

def all_runs(folder, deck):
    """The runs of a sweep's folder, also those of earlier calls: list of (variables, state,
    printed, thermo), by their variables."""
    text = "\n".join((deck.parent / f).read_text(errors="replace") for f in needed_files(deck))
    prints, rows = prints_of(text), []
    for path in folder.glob("*/state"):
        state = json.loads(path.read_text())
        out = (path.parent / "out.txt").read_text(errors="replace").splitlines()
        rows.append((state["variables"], state, *results(out, prints)))

    def number(value):
        try:
            return 0, float(value), ""
        except ValueError:
            return 1, 0.0, value
    return sorted(rows, key=lambda row: [(n, number(v)) for n, v in row[0].items()])


def columns_of(dicts):
    """The keys of dicts, in the order in which they appear."""
    return list(dict.fromkeys(itertools.chain.from_iterable(dicts)))


def write_table(rows, folder, say):
    """sweep.csv with everything; sweep.txt, also printed, with what the deck prints, or the thermo
    line of a deck that prints nothing."""
    names, printed, thermo = (columns_of(r[k] for r in rows) for k in (0, 2, 3))
    taken = {*names, *printed, "outcome", "seconds"}
    with open(folder / "sweep.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow([*names, "outcome", "seconds", *printed,
                        *(f"{t} (thermo)" if t in taken else t for t in thermo)])
        for variables, state, values, line in rows:
            table.writerow([*(variables.get(n, "") for n in names), state["outcome"],
                            state["seconds"], *(values.get(p, "") for p in printed),
                            *(line.get(t, "") for t in thermo)])
    shown, at = (printed, 2) if printed else (thermo, 3)
    lines = [f"{k + 1}: {name}" for k, name in enumerate(shown)]
    head = [*names, *(f"[{k + 1}]" for k in range(len(shown))), "outcome"]
    body = [[*(r[0].get(n, "") for n in names), *(r[at].get(s, "") for s in shown),
             r[1]["outcome"]] for r in rows]
    widths = [max(len(line[k]) for line in [head, *body]) for k in range(len(head))]
    lines += ["", *("  ".join(w.rjust(n) for w, n in zip(line, widths)) for line in [head, *body])]
    (folder / "sweep.txt").write_text("\n".join(lines) + "\n")
    say("\n".join(lines))


# ---------------------------------------------------------------------- command line

def arguments(words):
    parser = argparse.ArgumentParser(prog="tools/sweep", description="see tools/sweep --help")
    parser.add_argument("deck", type=Path)
    parser.add_argument("-var", nargs=2, action="append", default=[],
                        metavar=("NAME", "VALUE,VALUE,..."))
    parser.add_argument("-o", dest="folder", type=Path)
    parser.add_argument("-np", type=int, default=1)
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--again", action="store_true")
    for name, kind in (("--root", Path), ("--lmp", str), ("--cores", int)):
        parser.add_argument(name, type=kind, required=True, help=argparse.SUPPRESS)
    return parser.parse_args(words)


def main(words, say=lambda text: print(text, flush=True)):
    args = arguments(words)
    if not args.deck.is_file():
        raise ValueError(f"no such deck: {args.deck}")
    deck = args.deck.resolve()
    if args.np < 1 or (args.jobs is not None and args.jobs < 1):
        raise ValueError("-np and --jobs: give a number of 1 or more")
    folder = (args.folder or args.root / "runs" / f"sweep_{name_of(deck)}").resolve()
    if args.report:
        if not folder.is_dir():
            raise ValueError(f"there is no sweep in {folder}")
    else:
        if not args.var:
            raise ValueError("give at least one -var NAME VALUE,VALUE,...")
        if unknown := unknown_variables(deck, [name for name, _ in args.var]):
            raise ValueError(f"the deck has no variable {unknown[0]}")
        runs = [Run(folder, variables, deck) for variables in combinations(args.var)]
        if len({run.folder for run in runs}) < len(runs):
            raise ValueError("two combinations have the same folder name: use values that differ "
                             "in letters, digits, or . + _ -")
        foreign = folder.is_dir() and any(folder.iterdir()) and not (folder / ".sweep").exists()
        if foreign:
            raise ValueError(f"{folder} has files that are of no sweep: give another -o")
        folder.mkdir(parents=True, exist_ok=True)
        with open(folder / ".sweep", "a") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise ValueError(f"another sweep is going on in {folder}") from None
            todo = [run for run in runs if run.open(args.again)]
            jobs = args.jobs or max(1, args.cores // args.np)
            say(f"{len(runs)} runs in {folder}, {len(runs) - len(todo)} of them there already; "
                f"{min(jobs, len(todo))} at a time")
            work(todo, args.lmp, args.np, jobs, say)
    rows = all_runs(folder, deck)
    if not rows:
        raise ValueError(f"no run in {folder} has ended")
    write_table(rows, folder, say)
    failed = [row for row in rows if row[1]["outcome"] == "failed"]
    say(f"table: {os.path.relpath(folder)}/sweep.csv"
        + (f"; {len(failed)} of {len(rows)} runs failed, --again tries them anew" if failed
           else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except ValueError as err:
        sys.exit(f"[dcm] ERROR: {err}")
    except KeyboardInterrupt:
        sys.exit("\nstopped; the same command goes on with what is missing")
