"""tools/same-logs: does a plugin give the numbers of a recorded one, to the last digit?

`record` runs every deck on 1, 2 and 4 ranks and keeps decks, logs and text output in a folder;
`compare` runs the decks of that folder with another plugin and compares.  Standard library only;
expects the environment that tools/same-logs sets (DCM_LMP, LAMMPS_PLUGIN_PATH).
"""

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENES = Path(__file__).resolve().parent / "same_logs"
TIMEOUT = 600  # s, for one run

# Settings (-var) that make the shipped decks short; those of this script, in.* in SCENES, are.
# A deck that is not named here runs as it is.
SHORT = {
    "acinus": {"hours": 0.02, "start": 30},
    "aspirate": {"level": 2, "steps": 2, "settle": 10, "image": "no"},
    "bench": {"size": "quick", "warm": 30, "timed": 20},
    "bile_duct": {"size": "quick", "hours": 0.015, "tau": 20, "image": "no"},
    "bile_duct_day": {"rest": 0.02, "hours": 0.03},
    "border": {"level": 2, "settle": 60, "image": "no"},
    "calibrate": {"kind": "cbm", "steps": 2, "hold": 60, "image": "no"},
    "chemotaxis": {"n": 20, "hours": 0.2, "image": "no"},
    "compress": {"level": 1, "settle": 20, "hold": 20, "steps": 1, "image": "no"},
    "contract": {"level": 2, "ramp": 5, "hold": 5, "image": "no"},
    "crowd": {"hours": 0.0225, "cycle": 200, "death": 2e-3, "image": "no"},
    "division": {"level": 2, "steps": 200, "image": "no"},
    "doublet": {"level": 1, "settle": 150, "press": 0.5, "rate": 0.05, "image": "no"},
    "fill": {"level": 1, "n": 3, "duration": 400, "scale": 0.85, "image": "no"},
    "import": {"time": 5, "image": "no"},
    "indent": {"level": 2, "settle": 10, "steps": 1, "image": "no"},
    "lumen": {"shut": 100, "start": 50, "hold": 100, "more": 50, "movie": "no"},
    "migration": {"duration": 150, "persistence": 40, "image": "no"},
    "monolayer": {"hours": 0.05, "cycle": 700, "movie": "no"},
    "plates": {"level": 2, "steps": 2, "settle": 40, "image": "no"},
    "resolution": {"border": 0, "hours": 0.01, "image": "no"},
    "rheometer": {"level": 1, "settle": 20, "rate": 0.01, "hold": 20, "image": "no"},
    "shock": {"level": 1, "time": 10, "image": "no"},
    "single": {"hold": 10, "image": "no"},
    "sorting": {"hours": 0.5, "image": "no"},
    "spheroid": {"level": 1, "hours": 0.15, "cycle": 180, "movie": "no"},
    "spread": {"level": 1, "time": 100, "image": "no"},
    "stretch": {"level": 1, "on": 10, "off": 10, "image": "no"},
    "tension": {"level": 1, "settle": 100, "image": "no"},
}
EVERY = 10  # steps between two lines of thermo output, whatever the deck says

# columns of thermo output that are wall times; fixes and computes have these names in every deck
TIMINGS = {"CPU", "T/CPU", "S/CPU", "CPULeft", "Part", "TimeoutLeft", "f_division[4]"}
TIMINGS |= {"f_move[5]", "f_move[6]", "f_move[7]", "f_move[13]", "c_contact[4]"}

LOG = "log.lammps"
ATOMS = "atoms.txt"
# not compared: binary files, and data files, in which the order of the atoms has no meaning
UNREAD = {".restart", ".data", ".png"}
MOST = 8  # differences of one run that are printed

# --- decks ----------------------------------------------------------------------------------------


def decks_of_this_tree():
    """{name: path}: shipped examples and the scenes beside this script."""
    paths = sorted(ROOT.glob("examples/*/in.*")) + sorted(SCENES.glob("in.*"))
    return {path.name.removeprefix("in."): path for path in paths}


def with_all_digits(text):
    """Text of a deck, or of a file it includes, that prints all digits every EVERY steps."""
    lines, command = [], ""
    for line in text.splitlines():
        command += line
        if line.rstrip().endswith("&"):
            lines.append(line)
            continue
        lines.append(f"thermo {EVERY}" if re.match(r"\s*thermo\s", command) else line)
        # a new style forgets the format
        if re.match(r"\s*thermo_style\s", command):
            lines += ["thermo_modify format float %.17g", f"thermo {EVERY}"]
        command = ""
    return "\n".join(lines) + "\n"


def prepare(deck, folder):
    """Copy a deck, with the files beside it and the parameter files, to `folder`, ready to run."""
    folder.mkdir(parents=True)
    for item in [deck, *deck.parent.iterdir(), *(ROOT / "potentials").glob("*.dcm")]:
        if item.is_dir() and item.name != "__pycache__":    # meshes
            shutil.copytree(item, folder / item.name)
        elif item == deck or item.is_file() and not item.name.startswith(("log.", "in.")):
            shutil.copy(item, folder)
            if item.suffix not in UNREAD and "thermo_style" in item.read_text():
                (folder / item.name).write_text(with_all_digits(item.read_text()))
    with open(folder / deck.name, "a") as file:
        file.write(
            f"write_dump all custom {ATOMS} id mol type radius xu yu zu vx vy vz "
            "modify sort id format float %.17g\n"
        )


# --- running --------------------------------------------------------------------------------------


def run(name, settings, ranks, folder):
    """Run a prepared deck in its folder; returns '' or why it failed, and the seconds it took."""
    command = ["mpirun", "-np", str(ranks), os.environ["DCM_LMP"], "-in", f"in.{name}"]
    command += ["-log", LOG, "-nocite"]
    for key, value in settings.items():
        command += ["-var", key, str(value)]
    # the recorded parameter files, and no busy waiting of more ranks than cores
    env = {**os.environ, "LAMMPS_POTENTIALS": str(folder), "OMPI_MCA_mpi_yield_when_idle": "1"}
    start = time.monotonic()
    failure = ""
    try:
        done = subprocess.run(
            command, cwd=folder, env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, errors="replace", timeout=TIMEOUT,
        )  # fmt: skip
        if done.returncode != 0:
            lines = done.stdout.splitlines()
            errors = [line for line in lines if line.startswith("ERROR")]
            failure = f"lmp returned {done.returncode}: " + (errors or lines[-3:] or ["?"])[0]
    except subprocess.TimeoutExpired:
        failure = f"stopped after {TIMEOUT} s"
    return failure, time.monotonic() - start


def keep(source, inputs, target):
    """Move what a run wrote, as far as it is compared, to `target`."""
    target.mkdir(parents=True, exist_ok=True)
    for item in source.iterdir():
        if item.name not in inputs and item.suffix not in UNREAD:
            shutil.move(item, target / item.name)


# --- comparing ------------------------------------------------------------------------------------


def thermo(log):
    """Thermo output of a log: one (columns, rows) per run, every entry a string."""
    runs, columns = [], None
    for line in log.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            columns = words
            runs.append((columns, []))
        elif line.startswith(("Loop time", "ERROR")):
            columns = None
        elif columns and len(words) == len(columns) and re.fullmatch(r"\d+", words[0]):
            runs[-1][1].append(words)
    return runs


def compare_logs(old, new):
    """Differences of two logs, a text for each; columns that are wall times do not count."""
    before, after = thermo(old), thermo(new)
    if len(before) != len(after):
        yield f"{len(before)} runs with thermo output, now {len(after)}"
    for number, (a, b) in enumerate(zip(before, after), 1):
        (names, rows), (new_names, new_rows) = a, b
        if names != new_names:
            yield f"run {number}: columns {' '.join(names)}, now {' '.join(new_names)}"
        if len(rows) != len(new_rows):
            yield f"run {number}: {len(rows)} rows, now {len(new_rows)}"
        for row, new_row in zip(rows, new_rows):
            now = dict(zip(new_names, new_row))
            for name, value in zip(names, row):
                if name not in TIMINGS and name in now and now[name] != value:
                    yield f"run {number}, step {row[0]}: {name} {value}, now {now[name]}"


def compare_texts(name, old, new):
    """Differences of two text files, a text for each."""
    before, after = old.splitlines(), new.splitlines()
    if len(before) != len(after):
        yield f"{name}: {len(before)} lines, now {len(after)}"
    for number, (line, new_line) in enumerate(zip(before, after), 1):
        words, new_words = line.split(), new_line.split()
        if len(words) != len(new_words):
            yield f"{name}, line {number}: {len(words)} words, now {len(new_words)}"
        for column, (word, new_word) in enumerate(zip(words, new_words), 1):
            if word != new_word:
                yield f"{name}, line {number}, word {column}: {word}, now {new_word}"


def compare_folders(old, new):
    """Differences of what two runs left: the log first, then the other files by name."""
    names = {path.name for path in old.iterdir()}
    new_names = {path.name for path in new.iterdir()}
    for name in sorted(names | new_names, key=lambda name: (name != LOG, name)):
        if name not in new_names:
            yield f"{name} is missing now"
        elif name not in names:
            yield f"{name} was not written before"
        else:
            texts = ((folder / name).read_text(errors="replace") for folder in (old, new))
            yield from compare_logs(*texts) if name == LOG else compare_texts(name, *texts)


# --- the two commands -----------------------------------------------------------------------------


class Progress:
    """One line for every run that ends, with the time since the start."""

    def __init__(self, total):
        self.start, self.total, self.done, self.lock = time.monotonic(), total, 0, threading.Lock()

    def line(self, name, ranks, seconds, verdict):
        with self.lock:
            self.done += 1
            head = f"[{self.done:2d}/{self.total}, {time.monotonic() - self.start:5.1f} s]"
            what = f"{name} on {ranks} rank{'s' if ranks > 1 else ''}"
            print(f"{head} {what:24s} {seconds:5.1f} s  {verdict}", flush=True)


def run_all(jobs, cores, task):
    """task(name, ranks) for all jobs, as many at once as there are cores; returns the results."""
    results = {}
    for ranks in sorted({ranks for _, ranks in jobs}, reverse=True):
        some = [job for job in jobs if job[1] == ranks]
        with ThreadPoolExecutor(max(1, cores // ranks)) as pool:
            results |= zip(some, pool.map(lambda job: task(*job), some))
    return results


def plugin():
    """What runs: (path, checksum) of the plugin."""
    path = Path(os.environ["LAMMPS_PLUGIN_PATH"].split(":")[0]).resolve() / "dcmplugin.so"
    if not path.is_file():
        sys.exit(f"same-logs: there is no {path}: build the plugin, or give its folder to --plugin")
    return str(path), hashlib.sha256(path.read_bytes()).hexdigest()[:12]


def chosen(names, known, where):
    """The decks asked for, all if none is."""
    for name in names:
        if name not in known:
            sys.exit(f"same-logs: there is no deck {name} {where}: {' '.join(sorted(known))}")
    return names or sorted(known)


def record(options):
    """Run the decks and keep everything in the folder; returns the exit code."""
    decks = decks_of_this_tree()
    names = chosen(options.decks, decks, "in this tree")
    book = options.folder / "recorded.json"
    recorded = json.loads(book.read_text()) if book.exists() else {"decks": {}}
    known = sorted(set(names) & set(recorded["decks"]))
    if known:
        sys.exit(f"same-logs: {options.folder} holds {' '.join(known)} already; choose a new "
                 "folder")
    path, checksum = plugin()
    if recorded.get("checksum", checksum) != checksum:
        sys.exit(f"same-logs: {options.folder} was recorded with another plugin, "
                 f"{recorded['plugin']}")
    for name in names:
        shutil.rmtree(options.folder / "decks" / name, ignore_errors=True)  # of a failed attempt
        prepare(decks[name], options.folder / "decks" / name)
    progress = Progress(len(names) * len(options.ranks))

    def task(name, ranks):
        inputs = options.folder / "decks" / name
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / name
            shutil.copytree(inputs, folder)
            failure, seconds = run(name, SHORT.get(name, {}), ranks, folder)
            rows = 0
            if (folder / LOG).exists():
                rows = sum(len(rows) for _, rows in thermo((folder / LOG).read_text()))
            failure = failure or ("" if rows else "no thermo output")
            keep(folder, os.listdir(inputs), options.folder / "results" / f"{name}.{ranks}")
        progress.line(name, ranks, seconds, failure or f"{rows} rows")
        return failure

    failures = run_all([(n, r) for n in names for r in options.ranks], options.jobs, task)
    for name in names:
        if not any(failures[name, ranks] for ranks in options.ranks):
            recorded["decks"][name] = {"settings": SHORT.get(name, {}), "ranks": options.ranks}
    recorded |= {"plugin": path, "checksum": checksum, "date": time.strftime("%Y-%m-%d %H:%M")}
    book.write_text(json.dumps(recorded, indent=1) + "\n")
    failed = sorted({name for (name, _), failure in failures.items() if failure})
    if failed:
        print(f"FAILED and not recorded: {' '.join(failed)}")
        return 1
    print(f"recorded {len(names)} decks in {options.folder}, plugin {path} ({checksum})")
    return 0


def compare(options):
    """Run the recorded decks and compare; returns the exit code."""
    book = options.folder / "recorded.json"
    if not book.exists():
        sys.exit(f"same-logs: {options.folder} is no folder of tools/same-logs record")
    recorded = json.loads(book.read_text())
    names = chosen(options.decks, recorded["decks"], f"in {options.folder}")
    path, checksum = plugin()
    print(f"recorded: {recorded['plugin']} ({recorded['checksum']}), {recorded['date']}")
    print(f"now:      {path} ({checksum})")
    scratch = Path(tempfile.mkdtemp(prefix="same-logs-"))
    jobs = [(n, r) for n in names for r in recorded["decks"][n]["ranks"] if r in options.ranks]
    progress = Progress(len(jobs))

    def task(name, ranks):
        inputs, folder = options.folder / "decks" / name, scratch / f"{name}.{ranks}.run"
        if options.own_decks:
            decks = decks_of_this_tree()
            if name not in decks:
                return [f"there is no deck {name} in this tree"]
            prepare(decks[name], folder)
        else:
            shutil.copytree(inputs, folder)
        given = os.listdir(folder)
        failure, seconds = run(name, recorded["decks"][name]["settings"], ranks, folder)
        new = scratch / f"{name}.{ranks}"
        keep(folder, given, new)
        shutil.rmtree(folder)
        differences = [failure] if failure else []
        differences += compare_folders(options.folder / "results" / f"{name}.{ranks}", new)
        verdict = f"{len(differences)} DIFFERENCES" if differences else "identical"
        progress.line(name, ranks, seconds, verdict)
        return differences

    different = {job: found for job, found in run_all(jobs, options.jobs, task).items() if found}
    if not different:
        shutil.rmtree(scratch)
        print(f"IDENTICAL: {len(jobs)} runs of {len(names)} decks, to the last digit")
        return 0
    for (name, ranks), found in sorted(different.items()):
        print(f"\n{name} on {ranks} rank{'s' if ranks > 1 else ''}: {len(found)} differences")
        print("\n".join(f"  {text}" for text in found[:MOST]))
        if len(found) > MOST:
            print(f"  ... and {len(found) - MOST} more")
    print(f"\nDIFFERENT: {len(different)} of {len(jobs)} runs; what they wrote is in {scratch}")
    return 1


def main():
    parser = argparse.ArgumentParser(prog="tools/same-logs")
    parser.add_argument("command", choices=["record", "compare"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("decks", nargs="*", metavar="DECK")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--ranks", default="1,2,4")
    parser.add_argument("--own-decks", action="store_true")
    options = parser.parse_intermixed_args()
    options.folder = options.folder.resolve()
    options.ranks = [int(ranks) for ranks in options.ranks.split(",")]
    sys.exit(record(options) if options.command == "record" else compare(options))


if __name__ == "__main__":
    main()
