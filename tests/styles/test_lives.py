"""Several lives in one process: instances side by side, `clear` and a new start, errors that the
caller catches and goes on from, the plugin loaded twice, partitions, rerun."""

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from support.bad_decks import lines_of_error, whole
from support.library import run_script
from support.parameters import PARAMETER_TEXT, PARAMETERS

FILES = {PARAMETERS: PARAMETER_TEXT}
KEYS = ("pe", "ebond", "edihed", "press", "atoms")
HISTORY = "law maugis branch history"


def decks(scenes):
    """Two decks with different numbers of cells and atom types, contact with memory in one."""
    a, b = scenes.doublet(gap=-0.2), scenes.hybrid()
    end = "timestep 0.5\nthermo 1\nthermo_modify norm no\n"
    return (
        whole(a, contact=a.contact(HISTORY)) + end,
        whole(b, extra=b.motility(seed=5), contact=b.contact("law foundation")) + end,
    )


def alone(lmp, scenes, deck, steps):
    """The last thermo line of a deck in an lmp of its own, as the library gives it."""
    result = lmp(deck + scenes.thermo(list(KEYS)) + f"run {steps}\n")
    return [result.thermo[-1][name] for name in ("PotEng", "E_bond", "E_dihed", "Press", "Atoms")]


# --- instances in one process ---------------------------------------------------------------------


def test_two_instances_take_turns(lmp, scenes):
    """Each comes to the numbers that it comes to alone, bit for bit."""
    first, second = decks(scenes)
    split = [alone(lmp, scenes, d + "run 3\n", 3) for d in (first, second)]
    found = run_script(lmp, f"""
a, b = Lammps("log.a"), Lammps("log.b")
assert not a({first!r})
assert not b({second!r})
for _ in range(2):
    assert not a("run 3") and not b("run 3")
found["a"], found["b"] = a.thermo(*{KEYS!r}), b.thermo(*{KEYS!r})
a.close()
b.close()
""", FILES)  # fmt: skip
    assert found["a"] == split[0] and found["b"] == split[1]


def test_one_instance_ends_and_another_begins(lmp, scenes):
    """What a closed instance leaves, its memory that a new one is given among it, harms nobody."""
    first, second = decks(scenes)
    expected = [alone(lmp, scenes, d, 3) for d in (first, second)]
    found = run_script(lmp, f"""
a, b = Lammps("log.a"), Lammps("log.b")
assert not a({first!r}) and not b({second!r})
a.close()
assert not b("run 3")
found["b"] = b.thermo(*{KEYS!r})
for n in range(3):
    c = Lammps("log.c")
    assert not c({first!r} + "run 3")
    found[f"c{{n}}"] = c.thermo(*{KEYS!r})
    c.close()
b.close()
""", FILES)  # fmt: skip
    assert found["b"] == expected[1]
    assert found["c0"] == found["c1"] == found["c2"] == expected[0]


# --- errors that are caught -----------------------------------------------------------------------

ERRORS = {
    # what goes wrong in a deck that has run 1 step; the message
    "keyword": ("fix new all dcm/death ages 3", "unknown keyword ages"),
    "file": ("fix_modify cell rest/read none.rest", "cannot open rest-state file none.rest"),
    "init": ("fix new all dcm/death region none\nrun 1", "there is no region none"),
    "step": ("timestep 1e6\nrun 2", "step"),
}  # fmt: skip


@pytest.mark.parametrize("case", ERRORS)
def test_after_an_error_a_new_start(lmp, scenes, case):
    """`clear` after the error: the second life is like a first one."""
    first, second = decks(scenes)
    expected = [alone(lmp, scenes, d, 3) for d in (first, second)]
    bad, pattern = ERRORS[case]
    found = run_script(lmp, f"""
a = Lammps("log.a")
assert not a({first!r} + "run 1")
found["error"] = a({bad!r})
a("clear")
found["again"] = a({first!r} + "run 3")
found["a"] = a.thermo(*{KEYS!r})
a("clear")
assert not a({second!r} + "run 3")
found["b"] = a.thermo(*{KEYS!r})
a.close()
""", FILES)  # fmt: skip
    assert re.search(pattern, found["error"]), found
    assert found["again"] == ""
    assert found["a"] == expected[0] and found["b"] == expected[1]


@pytest.mark.parametrize("case", ["keyword", "file"])
def test_after_an_error_the_same_life(lmp, scenes, case):
    """A command that is refused has changed nothing: the run goes on as if it was not there."""
    first, _ = decks(scenes)
    expected = alone(lmp, scenes, first + "run 1\n", 3)
    bad, pattern = ERRORS[case]
    found = run_script(lmp, f"""
a = Lammps("log.a")
assert not a({first!r} + "run 1")
found["error"] = a({bad!r})
found["again"] = a("run 3")
found["a"] = a.thermo(*{KEYS!r})
a.close()
""", FILES)  # fmt: skip
    assert re.search(pattern, found["error"]) and found["again"] == ""
    assert found["a"] == expected


def test_after_an_error_of_init_the_same_life(lmp, scenes):
    """The fix that could not begin is taken out, and the run goes on."""
    first, _ = decks(scenes)
    expected = alone(lmp, scenes, first + "run 1\n", 3)
    bad, pattern = ERRORS["init"]
    found = run_script(lmp, f"""
a = Lammps("log.a")
assert not a({first!r} + "run 1")
found["error"] = a({bad!r})
found["again"] = a("unfix new\\nrun 3")
found["a"] = a.thermo(*{KEYS!r})
a.close()
""", FILES)  # fmt: skip
    assert re.search(pattern, found["error"]) and found["again"] == ""
    assert found["a"] == expected


# --- in one deck ----------------------------------------------------------------------------------


@pytest.mark.parametrize("np_", [1, 2])
def test_clear_and_again(lmp, scenes, np_):
    """One deck, its other, and it once more: the same lines as the first time."""
    first, second = decks(scenes)
    tail = scenes.thermo(["pe", "press", "ebond"]).replace("variable", "#") + "run 4\nclear\n"
    result = lmp(first + tail + second + tail + first + tail, np=np_)
    assert len(result.runs) == 3 and result.runs[0] == result.runs[2]


@pytest.mark.parametrize("when", ["at once", "after a run"])
def test_plugin_loaded_twice(lmp, scenes, when):
    """As by LAMMPS_PLUGIN_PATH and once more by a deck of habit."""
    folder = next(p for p in lmp.env["LAMMPS_PLUGIN_PATH"].split(":")
                  if (Path(p) / "dcmplugin.so").exists())  # fmt: skip
    load = f"plugin load {folder}/dcmplugin.so\n"
    first, _ = decks(scenes)
    end = scenes.thermo(["pe", "press"]) + "run 3\n"
    expected = lmp(first + end).runs[-1]
    if when == "at once":
        found = lmp(load + load + first + end).runs[-1]
    else:
        deck = first + "run 1\n" + load + "clear\n" + load + first + end
        found = lmp(deck).runs[-1]
    assert found == expected


# --- partitions -----------------------------------------------------------------------------------


def partitioned(lmp, deck, np=2):
    lmp.count += 1
    path = lmp.folder / f"partitions{lmp.count}"
    path.mkdir()
    for name, text in {**FILES, "in.test": deck}.items():
        (path / name).write_text(text)
    command = [os.environ.get("DCM_MPIEXEC", "mpirun"), "-np", str(np), lmp.lmp, "-partition",
               f"2x{np // 2}", "-in", "in.test", "-nocite", "-plog", "log.p"]  # fmt: skip
    return path, subprocess.run(
        command, cwd=path, env=lmp.env, stdin=subprocess.DEVNULL, capture_output=True, text=True,
        timeout=120,
    )  # fmt: skip


def lines_of_thermo(text):
    return re.findall(r"^ +\d+(?: +[-+.e\d]+){3} *$", text, re.M)


@pytest.mark.parametrize("np_", [2, 4])
def test_partitions(lmp, scenes, np_):
    """Two replicas with another gap each: the lines of two runs one after the other."""
    end = scenes.thermo(["pe", "press", "ebond"]) + "run 4\n"
    parts = [whole(scenes.doublet(gap=g)) + "timestep 0.5\n" for g in (-0.1, -0.3)]
    expected = [lmp(part + end, np=np_ // 2).log for part in parts]
    (lmp.folder / "one.in").write_text(parts[0] + end)
    (lmp.folder / "two.in").write_text(parts[1] + end)
    path, done = partitioned(
        lmp, f"variable d world {lmp.folder}/one.in {lmp.folder}/two.in\ninclude ${{d}}\n", np_
    )
    assert done.returncode == 0, done.stdout + done.stderr
    for n in range(2):
        found = lines_of_thermo((path / f"log.p.{n}").read_text())
        assert len(found) == 5 and found == lines_of_thermo(expected[n])


def test_error_in_one_partition(lmp, scenes):
    """It ends all of them, with one message that says why."""
    good = whole(scenes.doublet()) + "timestep 0.5\nrun 4\n"
    bad = whole(scenes.doublet()) + "fix d all dcm/death region none\nrun 4\n"
    (lmp.folder / "one.in").write_text(good)
    (lmp.folder / "two.in").write_text(bad)
    path, done = partitioned(
        lmp, f"variable d world {lmp.folder}/one.in {lmp.folder}/two.in\ninclude ${{d}}\n"
    )
    assert done.returncode != 0
    text = done.stdout + (path / "log.p.1").read_text()
    assert "Fix dcm/death: there is no region none" in text


# --- replicate and rerun --------------------------------------------------------------------------


def test_replicate_with_the_plugin(lmp, scenes):
    """LAMMPS cannot: it says so, and the manual tells what to do instead."""
    result = lmp.run(whole(scenes.doublet(boundary="p p p")) + "replicate 2 1 1\n")
    assert result.returncode != 0 and len(lines_of_error(result)) == 1, result.tail()


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("law", ["law dmt", HISTORY])
def test_rerun(lmp, scenes, law, np_):
    """Energies and pressures of a trajectory, contact with memory among them: what has touched in
    the frame before is remembered as in the run."""
    scene = scenes.doublet(gap=0.15)
    parts = dict(contact=scene.contact(f"{law} h0 0.1"))
    pull = "group two molecule 2\nfix pull two addforce -0.4 0 0\n"
    out = scenes.thermo(["pe", "ebond", "press", "fx=f_volume[1]"])
    first = lmp(
        whole(scene, **parts, extra=pull) + "timestep 0.5\n" + out
        + scenes.dump("id type xu yu zu") + "run 12\n", np=np_,
    )  # fmt: skip
    again = lmp(
        whole(scene, **parts, motion="") + "timestep 0.5\n" + out
        + "rerun dump.txt dump x y z\n", np=np_, files={"dump.txt": first.path / "dump.txt"},
    )  # fmt: skip
    assert [row["Step"] for row in again.thermo] == [row["Step"] for row in first.thermo]
    for a, b in zip(first.thermo, again.thermo, strict=True):
        for name in ("PotEng", "E_bond", "v_fx"):
            assert b[name] == pytest.approx(a[name], rel=1e-9, abs=1e-12), (a["Step"], name)
    assert np.ptp([row["E_bond"] for row in first.thermo]) > 0
