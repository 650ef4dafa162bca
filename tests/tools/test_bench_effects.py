"""Bookkeeping of tools/bench effects: the list of styles, decks, results, tables. No run of lmp."""

import re
import shutil

import bench_effects
import effects_build
import effects_decks
import effects_tables
import pytest
from bench_effects import measure
from effects_decks import BASE, EFFECTS, ROOT, SCENES, Effect, deck, missing, registered
from effects_jobs import Job, Store, base_job, jobs_of
from effects_tables import Tables

LOG = """\
   Step
         0
        10            7.5
Loop time of 2.5 on 1 procs for 10 steps with 1000 atoms

80.0% CPU use with 1 MPI tasks x 1 OpenMP threads
  fix move dcm/motion       0.1       0.1  40.7 %  11 solves of 3.7 iterations
"""


# --- the list -------------------------------------------------------------------------------------


def test_every_style_of_the_package_has_an_entry():
    without, gone = missing(registered())
    assert not without, f"add an Effect to tools/lib/effects_decks.py for {', '.join(without)}"
    assert not gone, f"no header in src/DCM registers {', '.join(gone)}"


def test_a_new_style_ends_the_tool(tmp_path, monkeypatch):
    code = tmp_path / "DCM"
    shutil.copytree(ROOT / "src/DCM", code)
    (code / "fix_dcm_new.h").write_text("FixStyle(dcm/new,DCMTimedFix<FixDCMNew>);\n")
    monkeypatch.setattr(bench_effects, "registered", lambda: registered(code))
    with pytest.raises(SystemExit, match="fix dcm/new has no entry: add an Effect"):
        bench_effects.require_entries()
    (code / "fix_dcm_new.h").unlink()
    (code / "fix_dcm_death.h").unlink()
    with pytest.raises(SystemExit, match="fix dcm/death has an entry .* remove it"):
        bench_effects.require_entries()


def test_every_style_that_acts_in_a_step_is_in_the_table_of_times():
    for style, header in registered().items():
        if style in BASE:
            continue
        macro = re.search(r"^\w+Style\([\w/]+,(.*)\);", header.read_text(), re.MULTILINE)[1]
        assert macro.startswith("DCMTimed"), f"{header.name} registers {macro} without a watch"


def test_every_style_with_an_entry_can_be_idle_or_is_of_every_step():
    """Only what always works has no deck in which it has nothing to do."""
    idle = {style for effect in EFFECTS if effect.idle is not None for style in effect.styles}
    always = {"fix dcm/cell", "fix dcm/motion", "bond_style dcm/cortex", "dihedral_style dcm/bend",
              "pair_style dcm/contact"}
    assert set(registered()) - set(BASE) - idle == always


# --- decks ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", SCENES)
def test_decks_differ_in_what_is_compared_and_name_the_style(scene):
    names = [effect.name for effect in EFFECTS]
    assert len(set(names)) == len(names)
    for effect in EFFECTS:
        found = {v: job.deck() for v, job in jobs_of(effect, scene, "instructions").items()}
        # a row about motion may be what a scene has anyway
        if found["base"].replace("scheme explicit", "") == found["named"]:
            continue
        assert all(style.split()[1] in found["named"] for style in effect.styles), effect.name
        if "idle" in found:
            assert found["idle"] != found["idle_base"], effect.name


def test_the_event_is_in_the_last_step_of_the_run():
    effect = next(e for e in EFFECTS if e.name == "death of a cell")
    job = jobs_of(effect, "pair", "instructions")["named"]
    assert "every 10\n" in job.deck() and "run             10\n" in job.deck()
    assert "every 10\n" in job.deck(9) and "run             9\n" in job.deck(9)


def test_types_that_divide_differently_have_cycle_times_of_their_own():
    text = "celltype hepatoblast\n  K_V 1\n\ncelltype cholangiocyte   # x\n  K_V 1\ncelltype a\n"
    assert bench_effects.cycles(text) == (
        "celltype hepatoblast\n  cycle_time 86400\n  K_V 1\n\n"
        "celltype cholangiocyte   # x\n  cycle_time 43200\n  K_V 1\ncelltype a\n")


def test_options_of_a_page_with_and_without_a_row(tmp_path, monkeypatch):
    header = registered()["fix dcm/constriction"]
    used, unused = effects_decks.options("fix dcm/constriction", header)
    assert "when" in used and "ramp" in used and "release" in unused


# --- the program without the other styles ---------------------------------------------------------


def test_what_is_pruned_is_not_included_by_what_is_left(tmp_path):
    code = tmp_path / "DCM"
    shutil.copytree(ROOT / "src/DCM", code)
    gone = effects_build.prune(code)
    assert set(registered(code)) == effects_build.NEEDED
    assert {"fix_dcm_osmosis_marks.cpp", "compute_dcm_lumen.h", "dcm_face_graph.cpp"} <= set(gone)
    for path in code.glob("*.*"):
        if path.suffix in (".h", ".cpp"):
            for name in re.findall(r'#include "(\w+\.h)"', path.read_text()):
                assert name not in gone, f"{path.name} includes {name}"


# --- runs and results -----------------------------------------------------------------------------


class FakeRuns:
    """Counts what is asked for; instructions are given by the words in the deck."""

    def __init__(self, folder, broken=""):
        self.folder, self.asked, self.broken = folder / "run", [], broken
        self.folder.mkdir()

    def instructions(self, job):
        self.asked.append(job)
        if self.broken and self.broken in job.deck():
            raise RuntimeError("the sky falls")
        return {"instructions": 1000.0 + 30.0 * ("dcm/tension" in job.deck()), "iterations": 4.0,
                **({"acts": 0.0} if job.acts else {})}


def job(what="none", **fields):
    return Job("instructions", "pair", what, tuple(fields.items()))


def test_a_benchmark_goes_on_where_it_was(tmp_path):
    runs, path = FakeRuns(tmp_path), tmp_path / "results.json"
    jobs = [job(), job(effect="fix t all dcm/tension"), job("the same deck")]
    assert measure(jobs, runs, Store(path), "build") == []
    assert len(runs.asked) == 2    # equal decks are one run
    assert measure(jobs, runs, Store(path), "build") == []
    assert len(runs.asked) == 2
    measure(jobs, runs, Store(path), "another build of the program")
    assert len(runs.asked) == 4


def test_a_deck_that_fails_is_told_and_the_others_go_on(tmp_path, capsys):
    runs, store = FakeRuns(tmp_path, broken="dcm/tension"), Store(tmp_path / "results.json")
    bad = job("tension: named", effect="fix t all dcm/tension")
    assert measure([bad, job()], runs, store, "build") == [bad]
    assert "pair, tension: named failed:\nthe sky falls" in capsys.readouterr().err
    assert list(store.known) == [job().key("build")]


def test_an_effect_that_did_not_happen_is_a_failure(tmp_path, capsys):
    runs, store = FakeRuns(tmp_path), Store(tmp_path / "results.json")
    idle = Job("instructions", "pair", "death: named", (), acts="f_die")
    assert measure([idle], runs, store, "build") == [idle]
    assert "f_die is 0: the effect did not happen" in capsys.readouterr().err


def test_numbers_of_a_log():
    assert bench_effects.iterations(LOG) == 3.7
    assert bench_effects.iterations("no motion") is None
    assert bench_effects.last_row(LOG) == [10.0, 7.5]
    assert bench_effects.loop_seconds(LOG) == pytest.approx(2.0)


def test_messages_are_the_difference_of_two_lengths(tmp_path):
    class Counted(bench_effects.Runs):
        def lmp(self, text, scene, env=None, ranks=1, **_):
            steps = int(re.search(r"run +(\d+)", text)[1])
            self.folder.mkdir(exist_ok=True)
            for rank in range(ranks):
                row = [100 + 3 * steps, 8 * steps] + 8 * [rank] + [5, 6, 7000 + 10 * rank]
                (self.folder / f"counts.{rank}").write_text(" ".join(map(str, row)))

    runs = Counted(tmp_path / "run", tmp_path)
    found = runs.counts(Job("counts", "block", "x", ()))
    assert found == {"messages": 3.0, "bytes": 8.0, "heap": 7005.0}
    assert runs.counts(Job("counts", "block", "x", (), per="event"))["messages"] == 3.0


# --- tables ---------------------------------------------------------------------------------------


@pytest.fixture
def tables(tmp_path):
    """Results of made-up effects: base 500, named 700 instructions, in a scene's deck of 1000."""
    effect = Effect("made up", ("fix dcm/tension",), {"effect": "named"}, {"effect": "base"},
                    idle={"effect": "fix x all dcm/tension tension 0"}, idle_base={})
    store = Store(tmp_path / "results.json")

    def put(the_job, **found):
        store.put(the_job.key("b"), found)

    for scene in SCENES:
        put(base_job("instructions", scene), instructions=1000.0, iterations=4.0)
        jobs = jobs_of(effect, scene, "instructions")
        put(jobs["base"], instructions=500.0, iterations=4.0)
        put(jobs["named"], instructions=700.0, iterations=5.0)
        put(jobs["idle"], instructions=1000.0 + 6.0 * (scene == "duct"), iterations=4.0)
    return effect, Tables(store, "b")


def test_shares_are_of_the_deck_of_the_scene(tables):
    effect, found = tables
    assert found.added(effect, "pair", "instructions", "instructions") == (200.0, 20.0)
    assert found.added(effect, "pair", "counts", "heap") == (None, None)    # not measured


def test_rows_of_the_pages(tables, monkeypatch):
    effect, found = tables
    monkeypatch.setattr(effects_tables, "EFFECTS", [effect])
    head, row = found.named()
    line = dict(zip(head, row))
    assert line["effect"] == "made up" and line["duct, %"] == "+20.00"
    assert line["iterations"] == "4.0 to 5.0" and line["KiB"] == ""
    rows = list(found.idle())
    assert rows[1][:5] == ["fix dcm/tension", "all dcm/tension tension 0", "0", "0", "+0.600"]
    assert effects_tables.over(rows) == [rows[1]]
    assert len(list(found.events())) == 1


def test_styles_that_no_deck_names(tables):
    _, found = tables
    for kind, was, now in (("instructions", {"instructions": 1000.0}, {"instructions": 998.0}),
                           ("counts", dict(heap=9000.0, messages=4.0, bytes=80.0),
                            dict(heap=7000.0, messages=4.0, bytes=80.0))):
        found.store.put(base_job(kind, "pair").key("b"), was)
        found.store.put(base_job(kind, "pair").key("few"), now)
    rows = list(found.unnamed("few"))
    assert rows[1:] == [["pair", "10000", "9980", "+0.2004", "+2000.0", "0", "0"]]
    assert effects_tables.unlike(rows) == rows[1:]
    found.store.put(base_job("instructions", "pair").key("few"), {"instructions": 999.5})
    assert effects_tables.unlike(found.unnamed("few")) == []


def test_a_table_without_rows_says_so(tmp_path):
    effects_tables.write(tmp_path, "x", [["scene", "a"]])
    assert (tmp_path / "x.csv").read_text() == "scene,a\nnot measured,\n"


def test_an_event_is_told_in_steps(tables, monkeypatch):
    effect, found = tables
    event = Effect("once", effect.styles, effect.named, effect.base, per="event")
    monkeypatch.setattr(effects_tables, "EFFECTS", [event])
    for variant in ("base", "named"):
        old = jobs_of(effect, "pair", "instructions")[variant].key("b")
        found.store.put(jobs_of(event, "pair", "instructions")[variant].key("b"),
                        found.store.known[old])
    head, row = found.events()
    line = dict(zip(head, row))
    assert line["pair, steps"] == "+2.00"    # 200 more a step in ten steps of 1000


def test_the_median_of_pairs_counts():
    assert effects_tables.percent_of([(1.0, 1.1), (2.0, 2.0), (1.0, 9.0)]) == pytest.approx(10.0)


def test_numbers_in_tables():
    assert effects_tables.number(None) == ""
    assert effects_tables.number(0.0) == "0"
    assert effects_tables.number(0.00004, 2) == "+4e-05"
    assert effects_tables.number(-1.236, 2) == "-1.24"


def test_unknown_words_teach(capsys):
    with pytest.raises(SystemExit, match="unknown scenes moon; there are pair, block, duct"):
        bench_effects.main(["--scenes", "moon"])
    with pytest.raises(SystemExit, match="no effect or style contains 'moon'"):
        bench_effects.main(["--only", "moon"])
    bench_effects.main(["--list", "--only", "dcm/tension"])
    assert "dcm/tension" in capsys.readouterr().out


def test_every_row_has_what_the_tables_need():
    assert all(set(e.scenes) <= set(SCENES) for e in EFFECTS)
    assert all(deck(SCENES[s], e.named, 10) for e in EFFECTS for s in e.scenes)
