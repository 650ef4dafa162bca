"""Decks that must end in one error, before the first step; used by test_bad_*.py."""

import re

KEEP = "keep this"
GUARDED = ("keep.data", "keep.restart", "keep.txt")
TAIL = "write_data keep.data\nwrite_restart keep.restart\nprint lost file keep.txt\n"
RUN = "timestep 1.0\nthermo 1\nrun 2\n"


def lines_of_error(result):
    return [line for line in result.out.splitlines() if "ERROR" in line]


def fails(lmp, deck, *patterns, run=True, files=None, **options):
    """Run a deck that must end in exactly one error with all patterns in its message."""
    files = {**dict.fromkeys(GUARDED, KEEP), **(files or {})}
    tail = RUN if run is True else (run or "")
    result = lmp.run(deck + tail + TAIL, files=files, timeout=60, **options)
    assert result.returncode != 0, "no error:\n" + result.tail()
    errors = lines_of_error(result)
    assert len(errors) == 1, result.tail()
    assert "Segmentation" not in result.err, result.tail()
    assert not result.thermo, "the error came after the first step:\n" + result.tail()
    message = result.error.replace("\n", " ")
    for pattern in patterns:
        assert re.search(pattern, message), f"no '{pattern}' in: {message}"
    for name in GUARDED:
        assert (result.path / name).read_text() == KEEP, f"{name} was overwritten"
    return result


def whole(scene, **replace):
    """A complete deck, with some of its parts replaced."""
    parts = {
        "head": scene.head(),
        "cortex": scene.cortex(),
        "contact": scene.contact(),
        "cell": "fix cell all dcm/cell\n",
        "volume": scene.volume(),
        "extra": "",
        "motion": scene.motion(),
    }
    unknown = set(replace) - set(parts)
    assert not unknown, unknown
    return "".join({**parts, **replace}.values())
