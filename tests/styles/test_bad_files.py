"""Damaged data and restart files, also on two ranks: one error; files stay."""

import re
from pathlib import Path

import pytest

from support.bad_decks import fails, whole
from support.cycle_decks import counting


@pytest.fixture(scope="module")
def saved(lmp_module, scenes):
    """Data and restart file of a doublet, and the text of the data file."""
    done = lmp_module(
        whole(scenes.doublet()) + "write_data cells.data nocoeff\nwrite_restart cells.restart\n"
    )
    return done.path, (done.path / "cells.data").read_text()


def reading(scene, options=""):
    """The deck that reads cells.data."""
    head = f"units lj\natom_style dcm\nnewton on\nboundary s s s\nread_data cells.data {options}\n"
    return whole(scene, head=head)


def edit(text, change):
    """Apply `change` to the words of each line of the section Atoms; None removes the atom."""
    lines, section, count, gone = [], "", 0, set()
    for line in text.splitlines():
        words = line.split()
        if words and words[0].isalpha():
            section = words[0]
        elif section == "Atoms" and words:
            tag, words = words[0], change(words)
            if words is None:
                gone.add(tag)
                continue
            count += 1
            line = " ".join(words)
        elif section == "Velocities" and words and words[0] in gone:
            continue
        lines.append(line)
    return re.sub(r"\d+ atoms", f"{count} atoms", "\n".join(lines) + "\n", count=1)


def with_column(test, column, value):
    def change(words):
        if test(words):
            words[column] = value
        return words

    return change


def first(kind):
    """The first atom of a kind."""
    seen = []

    def test(words):
        if words[3] == kind and not seen:
            seen.append(words[0])
            return True
        return False

    return test


def data_changes():
    # columns: id mol type kind radius x y z v1 v2 v3 region volume0
    def flipped():
        test = first("4")

        def change(words):
            if test(words):
                words[8], words[9] = words[9], words[8]
            return words

        return change

    def inverted(words):
        if words[3] == "4":
            words[8], words[9] = words[9], words[8]
        return words

    def open_face():
        test = first("4")
        return lambda words: None if test(words) else words

    def no_center():
        test = first("2")
        return lambda words: None if test(words) else words

    def two_centers():
        test = first("3")

        def change(words):
            if test(words):
                words[2:4], words[12] = ["1", "2"], "900.0"
            return words

        return change

    return {
        "no center": (no_center, "belongs to cell 1, which has no center", "delete whole cells"),
        "two centers": (two_centers, "cell 1 has two center"),
        "flipped face": (flipped, "cell 1 is not closed or some faces are flipped"),
        "all flipped": (lambda: inverted, "cell [12] has volume -.*flip the mesh"),
        "missing face": (open_face, "cell 1 has .* nodes and .* faces; a closed surface"),
        "missing vertex": (lambda: with_column(first("4"), 8, "99999"), "vertex 99999 of face"),
        "kind": (lambda: with_column(first("3"), 3, "7"), "atom .* has kind 7, must be 1 to 5"),
        "region": (lambda: with_column(first("4"), 11, "9"), "has region 9, must be 0 to 4"),
        "radius": (lambda: with_column(first("4"), 4, "-1"), "has radius -1"),
        "volume0": (lambda: with_column(first("2"), 12, "0"), "rest volume 0, must be positive"),
        "vertex zero": (lambda: with_column(first("4"), 8, "0"), "vertex ID 0, must be positive"),
        "nan": (lambda: with_column(first("3"), 5, "nan"), "nan"),
        "text": (lambda: with_column(first("3"), 5, "left"), "left"),
    }


@pytest.mark.parametrize("case", data_changes())
def test_data_file(lmp, scenes, saved, case):
    make, *patterns = data_changes()[case]
    files = {"cells.data": edit(saved[1], make())}
    fails(lmp, reading(scenes.doublet()), *patterns, files=files)


def test_data_file_truncated(lmp, scenes, saved):
    for part in (0.2, 0.5, 0.8):
        text = saved[1][: int(part * len(saved[1]))]
        fails(lmp, reading(scenes.doublet()), files={"cells.data": text})


def test_errors_on_two_ranks(lmp, scenes, saved):
    """One error line too if all ranks find the same."""
    scene = scenes.doublet()
    files = {"cells.data": edit(saved[1], data_changes()["flipped face"][0]())}
    fails(lmp, reading(scene), "not closed", files=files, np=2)
    fails(lmp, whole(scene, motion=scene.motion(options="x 1")), "unknown keyword x", np=2)
    contact = f"pair_style dcm/contact\npair_coeff * * none.dcm {scene.NAMES}\n"
    fails(lmp, whole(scene, contact=contact), "none.dcm", np=2)


def test_restart_without_plugin(lmp, saved):
    lmp.env = {**lmp.env, "LAMMPS_PLUGIN_PATH": ""}
    files = {"cells.restart": saved[0] / "cells.restart"}
    fails(lmp, "read_restart cells.restart\n", "dcm", "[Uu]n(known|recognized)", files=files)
    deck = "atom_style dcm\n"
    fails(lmp, deck, "dcm", "[Uu]n(known|recognized)")


def test_restart_without_coefficients(lmp, saved):
    """Cell types come again from pair_coeff."""
    files = {"cells.restart": saved[0] / "cells.restart"}
    deck = "read_restart cells.restart\nfix cell all dcm/cell\n"
    fails(lmp, deck, "[Pp]air.*coeff", files=files)


# --- rest files -----------------------------------------------------------------------------------

NEDGES = 2 * 120    # of two cells of 42 nodes; as many hinges


@pytest.fixture(scope="module")
def rested(lmp_module, scenes):
    """A data file and the lines of its rest file."""
    deck = whole(scenes.doublet()) + "run 0\nwrite_data cells.data nocoeff\n"
    path = lmp_module(deck + "fix_modify cell rest/write cells.rest\n").path
    return (path / "cells.data").read_text(), (path / "cells.rest").read_text().splitlines()


def rest_changes(lines):
    body = [line for line in lines if not line.startswith("#")]
    edge = next(line for line in body if len(line.split()) == 3)
    hinge = next(line for line in body if len(line.split()) == 5)
    half = lines[: len(lines) // 2]
    return {
        "cut": (half, "names [0-9]+ of 240 edges and [0-9]+ of 240 hinges: it was cut short"),
        "empty": ([], "names 0 of 240 edges"),
        "header only": (lines[:1], "names 0 of 240 edges"),
        "line taken out": ([x for x in lines if x != edge], "is damaged.* 239 edges and 240"),
        "value changed": ([x.replace(edge, edge + "1") for x in lines], "is damaged"),
        "no last line, edge out": ([x for x in lines[:-1] if x != edge], "names 239 of 240 edges"),
        "no last line, hinge out": ([x for x in lines[:-1] if x != hinge],
                                    "240 of 240 edges and 239 of 240 hinges"),
        "edge twice": ([*lines[:-1], edge], "names an edge or hinge twice"),
        "edge turned": ([*lines[:-1], " ".join([*edge.split()[1::-1], "3"])],
                        "names an edge or hinge twice"),
        "unknown ID": ([*lines[:-1], "5 2000000000 3.0"], "only 480 of the 481 .*another data"),
        "ID beyond the map": ([*lines[:-1], "5 99999 3.0"], "only 480 of the 481"),
        "ID zero": ([*lines[:-1], "0 5 3.0"], "only 480 of the 481"),
        "ID negative": ([*lines[:-1], "-4 5 3.0"], "only 480 of the 481"),
        "hinge of nodes": ([*lines[:-1], "2 -3 4 5 0.1"], "only 480 of the 481"),
        "no edge": ([*lines[:-1], "2 3 4 3.0"], "expected 2 or 4 tags"),
        "length zero": ([*lines[:-1], " ".join([*edge.split()[:2], "0"])], "bad rest value"),
        "text": ([*lines[:-1], "rest"], "'rest'"),
    }


REST = list(rest_changes(["2 3 1.0", "2 3 4 5 0.1"]))


@pytest.mark.parametrize("case", REST)
def test_rest_file(lmp, scenes, rested, case):
    lines, *patterns = rest_changes(rested[1])[case]
    deck = reading(scenes.doublet()) + "fix_modify cell rest/read cells.rest\n"
    text = "".join(line + "\n" for line in lines)
    files = {"cells.data": rested[0], "cells.rest": text}
    fails(lmp, deck, "Fix dcm/cell", "cells.rest", *patterns, files=files)


@pytest.mark.parametrize("case", ["cut", "unknown ID", "edge twice"])
def test_rest_file_three_ranks(lmp, scenes, rested, case):
    lines, *patterns = rest_changes(rested[1])[case]
    deck = reading(scenes.doublet()) + "fix_modify cell rest/read cells.rest\n"
    files = {"cells.data": rested[0], "cells.rest": "".join(line + "\n" for line in lines)}
    fails(lmp, deck, *patterns, files=files, np=3)


def test_rest_file_as_editors_leave_it(lmp, scenes, rested):
    """Blank lines, Windows line ends and a mark change nothing; nor does the order, without the
    last line. The file that is written again is the same."""
    data, lines = rested
    kept = {
        "as written": "\n".join(lines) + "\n",
        "blank lines": "\n\n".join(lines) + "\n  \r\n \n",
        "windows": "\r\n".join(lines) + "\r\n",
        "mac": "\r".join(lines) + "\r",
        "mark": "\ufeff" + "\n".join(lines) + "\n",
        "order": "\n".join(reversed(lines[:-1])) + "\n",
    }
    deck = reading(scenes.doublet()) + "fix_modify cell rest/read cells.rest\n"
    deck += "fix_modify cell rest/write again.rest\n"
    for name, text in kept.items():
        (lmp.folder / "cells.rest").write_bytes(text.encode())
        done = lmp(deck, files={"cells.data": data, "cells.rest": lmp.folder / "cells.rest"})
        assert (done.path / "again.rest").read_text().splitlines() == lines, name


def test_rest_file_partial(lmp, scenes, rested):
    """Said so, some edges and hinges may keep theirs."""
    data, lines = rested
    edges = [line for line in lines if len(line.split()) == 3 and line[0] != "#"]
    a, b, length = edges[7].split()
    files = {"cells.data": data, "cells.rest": "\n".join(lines) + "\n",
             "some.rest": f"{a} {b} {2 * float(length):.17g}\n"}  # fmt: skip
    deck = reading(scenes.doublet()) + "fix_modify cell rest/read cells.rest\n"
    deck += "fix_modify cell rest/read some.rest partial\nfix_modify cell rest/write new.rest\n"
    now = (lmp(deck, files=files).path / "new.rest").read_text().splitlines()
    changed = {x for x in now if x not in lines}
    assert {x for x in changed if x[0] != "#"} == {f"{a} {b} {2 * float(length):.17g}"}


def test_rest_file_before_the_first_run(lmp, scenes, rested):
    """A data file has no rest lengths: there is nothing to write yet."""
    deck = reading(scenes.doublet()) + "fix_modify cell rest/write new.rest\n"
    result = fails(lmp, deck, "240 of 240 edges have no rest length yet; do a 'run 0' before",
                   files={"cells.data": rested[0]})
    assert not (result.path / "new.rest").exists()


# --- output ---------------------------------------------------------------------------------------

FULL = Path("/dev/full")    # every write fails: no space left on device
needs_full = pytest.mark.skipif(not FULL.exists(), reason="no /dev/full")


@needs_full
@pytest.mark.parametrize("np", [1, 2])
def test_rest_file_disk_full(lmp, scenes, np):
    deck = whole(scenes.doublet()) + "run 0\nfix_modify cell rest/write /dev/full\n"
    result = lmp.run(deck, np=np)
    assert "Fix dcm/cell: cannot write rest-state file /dev/full: No space left" in result.error
    assert FULL.is_char_device()


def test_rest_file_folder_missing(lmp, scenes):
    deck = whole(scenes.doublet()) + "run 0\nfix_modify cell rest/write none/cells.rest\n"
    assert "cannot write rest-state file none/cells.rest: No such file" in lmp.run(deck).error


def test_rest_file_keeps_the_old_one(lmp, scenes):
    """A new file takes the place of the old one when it is whole; here it cannot be begun."""
    deck = whole(scenes.doublet()) + "run 0\nshell mkdir cells.rest.part\n"
    result = lmp.run(deck + "fix_modify cell rest/write cells.rest\n", files={"cells.rest": "old"})
    assert "cannot write rest-state file cells.rest" in result.error
    assert (result.path / "cells.rest").read_text() == "old"


def test_rest_file_through_a_link(lmp, scenes):
    deck = whole(scenes.doublet()) + "run 0\nshell ln -s real.rest link.rest\n"
    path = lmp(deck + "fix_modify cell rest/write link.rest\n").path
    assert (path / "link.rest").is_symlink() and not (path / "real.rest").is_symlink()
    assert (path / "real.rest").read_text().startswith("# LAMMPS-DCM rest state")
    assert not (path / "real.rest.part").exists()


LOGS = {
    "division": ("fix grow all dcm/growth {map} seed 1 cycle_time 4 rounding 0 1\n"
                 "fix f all dcm/division seed 3 log /dev/full\n", "Fix dcm/division"),
    "death": ("fix f all dcm/death age 1 log /dev/full\n", "Fix dcm/death"),
}


@needs_full
@pytest.mark.parametrize("case", LOGS)
def test_log_disk_full(lmp, scenes, case):
    """The header of a log is the first that does not fit."""
    text, style = LOGS[case]
    scene = scenes.doublet()
    contact = scene.contact().replace("neighbor 0.6", "neighbor 1.0")
    fails(lmp, whole(scene, contact=contact, extra=text.format(map=scene.map)),
          f"{style}: cannot write to log /dev/full: No space left")


LIMIT = """\
unset LD_PRELOAD  # that of sanitizers
P=$PPID
while [ "$(cat /proc/$P/comm)" != lmp ]; do P=$(ps -o ppid= -p $P | tr -d " ") || exit; done
prlimit --pid $P --fsize=1024
"""


def small_disk(lmp, monkeypatch):
    """Command for a deck after which files of lmp take no more than 1024 bytes, as on a disk that
    fills during the run."""
    wrapper = lmp.folder / "small_disk"    # which ignores the signal that comes with it
    wrapper.write_text(f'#!/bin/sh\ntrap "" XFSZ\nexec {lmp.lmp} -log none "$@"\n')
    wrapper.chmod(0o755)
    monkeypatch.setattr(lmp, "lmp", str(wrapper))
    return "shell sh limit.sh\n"


def test_a_run_that_fails_in_set_up_leaves_the_log(lmp, scenes):
    """The events of an earlier run go when a step begins, not before."""
    scene = scenes.doublet()
    deck = scene.head() + scene.forces() + "fix death all dcm/death age 1e9 log d.log\n"
    old = {"d.log": "# of an earlier run\n1 2 3\n"}
    pull = "fix pull all addforce 1e6 0 0\n"
    failed = lmp.run(deck + pull + scene.motion() + "timestep 1\nrun 1\n", files=old)
    assert failed.returncode != 0 and "dcm/motion" in failed.error and not failed.thermo[1:]
    assert (failed.path / "d.log").read_text() == old["d.log"]
    none = lmp(deck + scene.motion() + "timestep 0.1\nrun 0\n", files=old)
    assert (none.path / "d.log").read_text() == old["d.log"]
    ran = lmp(deck + scene.motion() + "timestep 0.1\nrun 1\n", files=old)
    log = (ran.path / "d.log").read_text()
    assert log.startswith("# LAMMPS-DCM death log") and "1 2 3" not in log


def test_disk_fills_while_cells_die(lmp, monkeypatch):
    """One error with the style, the file and the reason; what was written before stays."""
    deck = counting(60, "cycle_time 1e9") + "fix death all dcm/death rate 1e-2 seed 3 log d.log\n"
    whole_log = (lmp(deck + "run 400\n").path / "d.log").read_text()
    assert len(whole_log) > 1500
    result = lmp.run(small_disk(lmp, monkeypatch) + deck + "run 400\n", files={"limit.sh": LIMIT})
    assert result.returncode != 0
    assert "Fix dcm/death: cannot write to log d.log: File too large" in result.error
    written = (result.path / "d.log").read_text()
    assert 900 < len(written) <= 1024 and whole_log.startswith(written)


def test_disk_fills_while_a_rest_file_is_written(lmp, scenes, monkeypatch):
    """The file of before stays, and nothing half done beside it."""
    deck = whole(scenes.doublet()) + "run 0\nfix_modify cell rest/write cells.rest\n"
    result = lmp.run(small_disk(lmp, monkeypatch) + deck,
                     files={"cells.rest": "old", "limit.sh": LIMIT})
    assert "Fix dcm/cell: cannot write rest-state file cells.rest: File too large" in result.error
    assert (result.path / "cells.rest").read_text() == "old"
    assert not list(result.path.glob("cells.rest?*"))
