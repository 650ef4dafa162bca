"""All scenes of the suite, in the order of the manual's page."""

import importlib

from hard.suite import SCENES

for family in ("shape", "contact", "force", "box", "time", "life"):
    importlib.import_module(f"hard.scenes_{family}")


def in_order():
    """(name, scene) of all."""
    return list(SCENES.items())
