"""What a case is, and how one of each kind is made from a seed."""

import dataclasses
from pathlib import Path

import numpy as np

from . import mutate, seeds
from .grammar import PARAMETERS, Deck, parameter_text
from .judge import GUARDED, KEEP


@dataclasses.dataclass(frozen=True)
class Case:
    kind: str
    seed: int
    deck: str
    files: dict = dataclasses.field(default_factory=dict)  # name -> bytes
    whole: dict = dataclasses.field(default_factory=dict)  # those of them that were damaged, before
    np: int = 1
    compare: bool = False  # other numbers of ranks must end alike

    def with_deck(self, deck):
        return dataclasses.replace(self, deck=deck)

    def with_file(self, name, data):
        return dataclasses.replace(self, files={**self.files, name: data})

    def write(self, path):
        path = Path(path)
        path.mkdir(parents=True, exist_ok=True)
        (path / "in.deck").write_bytes(self.deck.encode("latin1"))
        for name, data in self.files.items():
            (path / name).write_bytes(data)


def read_case(path):
    """A case from a folder, as it is kept in the corpus."""
    path = Path(path)
    files = {f.name: f.read_bytes() for f in path.iterdir() if f.name not in ("in.deck", "README")}
    np_ = 1
    deck = (path / "in.deck").read_bytes().decode("latin1")
    for line in deck.splitlines():
        if line.startswith("# ranks "):
            np_ = int(line.split()[2])
    files.setdefault(PARAMETERS, parameter_text().encode())
    return Case("corpus", 0, deck, files, np=np_, compare="# compare" in deck)


class Maker:
    """Cases by kind and seed: the same seed makes the same case."""

    def __init__(self, judge):
        self.judge, self.made = judge, None
        self.values = parameter_text().encode()

    @property
    def seeds(self):
        if self.made is None:
            self.made = seeds.Seeds(self.judge, Case)
        return self.made

    def __call__(self, kind, seed):
        rng = np.random.default_rng([KINDS.index(kind), seed])
        made = getattr(self, kind)(rng)
        made.setdefault("files", {})
        made["files"] = {
            PARAMETERS: self.values, **dict.fromkeys(GUARDED, KEEP), **made["files"],
        }  # fmt: skip
        if "np" not in made and rng.random() < (0.0 if made.get("compare") else 0.15):
            made["np"] = int(rng.integers(2, 5))
        return Case(kind=kind, seed=seed, **made)

    # --- decks ----------------------------------------------------------------------------------

    def deck(self, rng):
        """Commands that a user could write; most run, and alike on any number of ranks."""
        return dict(deck=Deck(rng).text(acts=rng.random() < 0.6), compare=True)

    def wild(self, rng):
        """The same with absurd words among them."""
        return dict(deck=Deck(rng, wild=float(rng.choice([0.005, 0.02, 0.1]))).text())

    def words(self, rng):
        """A whole deck with words and lines changed like any text."""
        text = Deck(rng).text(acts=bool(rng.random() < 0.3)).encode()
        text = mutate.text(rng, text).decode("latin1")
        # what would take the machine and not the program
        lines = [line for line in text.split("\n") if not long(line)]
        return dict(deck="\n".join(lines) + "\n")

    # --- files ----------------------------------------------------------------------------------

    def one_file(self, name, data, deck, rng, change=mutate.text):
        return dict(deck=deck + seeds.END, whole={name: data}, files={name: change(rng, data)})

    def data(self, rng):
        fixes = mutate.pick(rng, [seeds.SIMPLE, seeds.FIXES])
        return self.one_file("cells.data", self.seeds.data, seeds.reading_deck(fixes), rng)

    def rest(self, rng):
        deck = seeds.reading_deck(more="fix_modify cell rest/read cells.rest\n")
        made = self.one_file("cells.rest", self.seeds.rest, deck, rng)
        made["files"]["cells.data"] = self.seeds.data
        return made

    def restart(self, rng):
        first, stop = mutate.pick(rng, self.seeds.records)
        made = self.one_file("cells.restart", self.seeds.restart, seeds.restart_deck(), rng,
                             lambda r, data: mutate.binary(r, data, first, stop - 7))  # fmt: skip
        made["whole"] = {}
        return made

    def mesh(self, rng):
        name = mutate.pick(rng, sorted(self.seeds.meshes))
        scale = mutate.pick(rng, ["volume", "nodes"])
        command = (f"create_cells single hep dcm 0 0 0 6 dcm hep 1 2 3 1 1 mesh file {name} "
                   f"scale {scale} rest 0.95\n")  # fmt: skip
        return self.one_file(name, self.seeds.meshes[name], seeds.create_deck(command), rng)

    def table(self, rng):
        command = ("create_cells table cells.txt dcm hep 1 2 3 1 1 cbm cbm 4 mesh icosphere 1 "
                   "rotate 1 rest 0.95\n")  # fmt: skip
        return self.one_file("cells.txt", seeds.TABLE.encode(), seeds.create_deck(command), rng)

    def parameters(self, rng):
        return self.one_file(PARAMETERS, self.values, seeds.whole_deck(), rng)


KINDS = ["deck", "wild", "words", "data", "rest", "restart", "mesh", "table", "parameters"]


def long(line):
    """A line that asks for so much work or room that no program could do it at once."""
    words = line.split()
    try:
        if words[:1] == ["run"]:
            return float(words[1]) > 20
        if "icosphere" in words:
            return float(words[words.index("icosphere") + 1]) > 3
    except (ValueError, IndexError):
        pass
    return words[:1] in (["minimize"], ["shell"], ["jump"], ["next"])
