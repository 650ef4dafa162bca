"""Damaged data and restart files, also on two ranks: one error; files stay."""

import re

import pytest

from support.bad_decks import fails, whole


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
