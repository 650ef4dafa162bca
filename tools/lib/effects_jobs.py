"""What tools/bench effects has to do: one job per deck and count, and where results are kept."""

import hashlib
import json
from dataclasses import dataclass

from effects_decks import SCENES, STEPS, deck

COUNTED = "block"    # the scene in which the messages and the memory of each effect are counted


class Store:
    """Results by key in one file, so that a benchmark that was stopped goes on where it was."""

    def __init__(self, path):
        self.path = path
        self.known = json.loads(path.read_text()) if path.is_file() else {}

    def put(self, key, value):
        self.known[key] = value
        part = self.path.with_suffix(".part")
        part.write_text(json.dumps(self.known, indent=1, sort_keys=True))
        part.replace(self.path)


@dataclass(frozen=True)
class Job:
    """One deck and what is counted in it: instructions, counts or seconds."""

    kind: str
    scene: str
    what: str
    fields: tuple    # sorted items, so that equal decks are one job
    steps: int = STEPS
    acts: str = ""
    per: str = "step"

    def deck(self, steps=None):
        return deck(SCENES[self.scene], dict(self.fields), steps or self.steps, self.acts)

    def key(self, build):
        text = f"{self.kind} {self.scene} {self.steps} {self.per} {build}\n{self.deck()}"
        return hashlib.sha256(text.encode()).hexdigest()[:16]


def items(fields):
    return tuple(sorted((fields or {}).items()))


def jobs_of(effect, scene, kind):
    """Jobs of one row: variant (base, named, idle, idle_base) -> Job."""
    steps = SCENES[scene].timed if kind == "seconds" else STEPS
    variants = {"base": effect.base, "named": effect.named}
    if effect.idle is not None:
        base = effect.base if effect.idle_base is None else effect.idle_base
        variants |= {"idle_base": base, "idle": effect.idle}
    if kind == "counts" and scene != COUNTED:
        return {}
    if kind == "seconds":
        if effect.per == "event":
            return {}
        variants = {k: variants[k] for k in ("base", "named")}
    made = {}
    for variant, fields in variants.items():
        named = variant == "named"
        per = effect.per if variant in ("base", "named") else "step"
        made[variant] = Job(kind, scene, f"{effect.name}: {variant}", items(fields), steps,
                            effect.acts if named else "", per)
    return made


def base_job(kind, scene):
    return Job(kind, scene, "the deck without any effect", ())
