"""For tools/run and tools/sweep: which files a deck needs, and on how many ranks it runs best.

Standard library only: tools/run calls this with the python3 of the system.

  python3 run_deck.py files DECK [-var NAME VALUE ...]        the files beside DECK that it reads
  python3 run_deck.py ranks DECK CORES LMP [-var ...]         number of ranks, and why
  python3 run_deck.py unknown DECK [-var ...]                 variables that DECK does not have
"""
import glob
import itertools
import os
import queue
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

# On two idle cores two ranks take two thirds of the time of one with 7,000 atoms (14 cells of 162
# nodes); with 1,000 atoms the messages of the solver take longer than what they save. Between the
# two it makes little difference.
ATOMS_FOR_TWO = 5000
GROWS = re.compile(r"\bdcm/(division|convert)\b")    # small at the start, not at the end
LONGEST = 20.0    # s: a scene that takes longer to build is large
MOST_TEXT = 2**20    # bytes of a file that is searched for names of others
MESHES = (".off", ".obj")    # name no others

OUTPUT = ("dump", "dump_modify", "write_data", "write_dump", "write_restart", "restart", "log",
          "undump", "thermo_style")
VARIABLE = re.compile(r"\bvariable\s+(\w+)\s+(?:index|string)\s+([^\"#&\n]+)")
NESTED = "[^()]"    # parentheses in a formula, eight deep
for _ in range(8):
    NESTED = rf"(?:[^()]|\({NESTED}*\))"
REFERENCE = re.compile(rf"\$\{{(\w+)\}}|\$\({NESTED}*\)|\$(\w)")


def name_of(deck):
    """Name of a deck, in.NAME or NAME.lmp: that of its results."""
    name = Path(deck).name
    return name[3:] if name.startswith("in.") and len(name) > 3 else Path(name).stem


def statements(text):
    """Commands of a deck: comments and line ends with & removed, those in quotes apart."""
    text = re.sub(r"(?m)#.*$", "", text)
    text = re.sub(r"&[ \t]*\n", " ", text)
    return [s for s in (s.strip() for s in re.split(r"[\"\n]", text)) if s]


def input_words(text):
    """Words of a deck that may be names of files it reads."""
    for statement in statements(text):
        if statement.split()[0] in OUTPUT:
            continue
        if statement.startswith("fix "):
            statement = re.sub(r"\s(file|log|append)\s+\S+", " ", statement)
        hidden = REFERENCE.sub(lambda m: m.group().replace(" ", ""), statement)
        yield from re.split(r"[\s',;=]+", hidden)


def patterns(word, values):
    """Patterns of `glob` that a word stands for, its variables replaced by their `values` (name ->
    list), by * if they are not known."""
    pieces, at = [], 0
    for m in REFERENCE.finditer(word):
        pieces.append([glob.escape(word[at:m.start()])])
        known = values.get(m.group(1) or m.group(2) or "")
        pieces.append([glob.escape(v) for v in known] if known else ["*"])
        at = m.end()
    pieces.append([glob.escape(word[at:])])
    found = ["".join(p) for p in itertools.islice(itertools.product(*pieces), 100)]
    return [p for p in found if p.strip("*./?") and not p.startswith("/") and ".." not in p]


def needed_files(deck, variables=()):
    """Paths, relative to the deck's folder, of the deck and of the files beside it that it reads:
    those whose names stand in it, in a file it reads or in after.sh, and after.sh.

    variables: (name, value) of the command line. Names with variables in them are followed as far
    as a deck gives their values by index or string; the others stand for any text.
    """
    folder, given = Path(deck).resolve().parent, dict(variables)
    wanted = [Path(Path(deck).name)]
    if (folder / "after.sh").is_file():
        wanted.append(Path("after.sh"))
    texts, values = [], {}
    for file in wanted:    # grows
        path = folder / file
        if path.stat().st_size > MOST_TEXT or path.suffix in MESHES:
            continue
        text = path.read_text(errors="replace")
        if "\0" in text:    # binary, as a restart file
            continue
        texts.append(text)
        for name, words in VARIABLE.findall(text):
            values.setdefault(name, []).extend(words.split())
        values.update((name, [value]) for name, value in given.items())
        # a value may come from a file that was read later than the one that uses it
        for word in sorted(set(itertools.chain.from_iterable(map(input_words, texts)))):
            for pattern in patterns(word, values):
                for found in glob.glob(pattern, root_dir=folder):
                    here = Path(os.path.normpath(found))
                    inside = sorted((folder / here).glob("*"))    # create_cells meshes FOLDER
                    for path in [folder / here, *(p for p in inside if p.suffix in MESHES)]:
                        if path.is_file() and path.relative_to(folder) not in wanted:
                            wanted.append(path.relative_to(folder))
    return [w for w in wanted if not w.name.startswith("log.") and w.suffix != ".png"]


def copy_files(deck, folder, variables=()):
    """Copy what `deck` needs into `folder`; returns the relative paths."""
    files = needed_files(deck, variables)
    for file in files:
        target = Path(folder) / file
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(Path(deck).resolve().parent / file, target)
    return files


def unknown_variables(deck, names):
    """Those of `names` that neither the deck nor what it reads has a variable for."""
    folder, text = Path(deck).resolve().parent, ""
    for file in needed_files(deck):
        if (folder / file).stat().st_size <= MOST_TEXT:
            text += (folder / file).read_text(errors="replace") + "\n"
    def there(name):
        word = re.escape(name)
        short = rf"|\${word}(?!\w)" if len(name) == 1 else ""
        return re.search(rf"\bvariable[\s,]+{word}\b|\bis_defined\(variable,\s*{word}\)"
                         rf"|\$\{{{word}\}}|\bv_{word}\b{short}", text)
    return [n for n in names if not there(n)]


# ---------------------------------------------------------------------- how large is it?

CREATED = re.compile(r"^Created (\d+) deformable cells(?: of (?:\d+ to )?(\d+) nodes)? and (\d+) "
                     "center-based")
ATOMS = re.compile(r"^(?:Created | +)(\d+) atoms")
AT_WORK = re.compile(r"^(ERROR|Neighbor list info|Setting up|Per MPI rank| *Step |Loop time)")


def atoms_so_far(lines):
    """Atoms of the scene whose making `lines` of LAMMPS' output tell."""
    atoms = 0
    for line in lines:
        if m := CREATED.match(line):
            cells, nodes, spheres = (int(n or 0) for n in m.groups())
            atoms += cells * max(0, 3 * nodes - 3) + spheres    # nodes, 2 nodes - 4 faces, center
        elif m := ATOMS.match(line):
            atoms += int(m.group(1))
    return atoms


def count_atoms(deck, lmp, variables=()):
    """Atoms with which a deck begins, or enough for two ranks: LAMMPS builds the scene in a folder
    that is removed, and is stopped before the first step. None if that takes too long."""
    words = [lmp, "-in", Path(deck).name, "-log", "none", "-nonbuf"]
    for name, value in variables:
        words += ["-var", name, value]
    with tempfile.TemporaryDirectory(prefix="dcm-size.") as folder:
        copy_files(deck, folder, variables)
        child = subprocess.Popen(words, cwd=folder, stdin=subprocess.DEVNULL, text=True,
                                 errors="replace", stdout=subprocess.PIPE,
                                 stderr=subprocess.DEVNULL)
        lines, arrived, end = [], queue.Queue(), time.monotonic() + LONGEST
        threading.Thread(target=lambda: [*map(arrived.put, child.stdout), arrived.put(None)],
                         daemon=True).start()
        try:
            while (line := arrived.get(timeout=max(0.0, end - time.monotonic()))) is not None:
                lines.append(line)
                if AT_WORK.match(line) or atoms_so_far(lines) >= ATOMS_FOR_TWO:
                    break
            return atoms_so_far(lines)
        except queue.Empty:
            return None
        finally:
            child.kill()
            child.wait()


def choose_ranks(deck, lmp, cores, variables=()):
    """(ranks, reason): 1 for a small deck, whose messages would take longer than they save, else
    2, as far as there are cores."""
    if cores < 2:
        return 1, "there is one core"
    folder = Path(deck).resolve().parent
    for file in needed_files(deck, variables):
        if (folder / file).stat().st_size <= MOST_TEXT and any(
                GROWS.search(s) for s in statements((folder / file).read_text(errors="replace"))):
            return 2, "its cells divide or change their form"
    atoms = count_atoms(deck, lmp, variables)
    if atoms is None:
        return 2, "a large scene"
    return (2, f"{atoms} atoms or more") if atoms >= ATOMS_FOR_TWO else (1, f"{atoms} atoms")


def variables_of(words):
    """(name, value) pairs of words -var NAME VALUE ..."""
    return [(words[k + 1], words[k + 2]) for k in range(0, len(words), 3)]


def main(words):
    command, deck, *rest = words
    if command == "files":
        print(*needed_files(deck, variables_of(rest)), sep="\n")
    elif command == "unknown":
        print(*unknown_variables(deck, [name for name, _ in variables_of(rest)]))
    else:
        cores, lmp, *rest = rest
        print(*choose_ranks(deck, lmp, int(cores), variables_of(rest)))


if __name__ == "__main__":
    main(sys.argv[1:])
