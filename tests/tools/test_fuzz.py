"""The fuzzer of tools/fuzz: inputs that failed once, and a fixed number of new ones."""

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lib"))

from dcm_fuzz import mutate  # noqa: E402
from dcm_fuzz.cases import KINDS, Case, Maker, read_case  # noqa: E402
from dcm_fuzz.judge import Judge  # noqa: E402

CORPUS = sorted(path for path in (ROOT / "tests" / "fuzz").glob("*") if path.is_dir())
NEW = 6  # of each kind, for always the same seeds


@pytest.fixture(scope="module")
def judge(tmp_path_factory):
    if not os.environ.get("DCM_LMP"):
        pytest.fail("DCM_LMP is not set; run this with tools/test", pytrace=False)
    return Judge(tmp_path_factory.mktemp("fuzz"), os.environ.get("DCM_PRESET") == "asan", 3)


@pytest.fixture(scope="module")
def maker(judge):
    return Maker(judge)


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.name)
def test_corpus(judge, path):
    """Inputs that ended badly once."""
    verdict = judge(read_case(path))
    assert verdict.good, f"{verdict.kind}: {verdict.message}"


@pytest.mark.parametrize("kind", KINDS)
def test_new(judge, maker, kind):
    for seed in range(NEW):
        verdict = judge(maker(kind, seed))
        assert verdict.good, f"tools/fuzz --only {kind} --one {seed}: {verdict.message}"


def test_a_seed_is_a_case(maker):
    """The same seed makes the same case, another one another."""
    for kind in ("deck", "wild", "table"):
        assert maker(kind, 5) == maker(kind, 5) and maker(kind, 5) != maker(kind, 6)


def test_faults_are_seen(judge):
    """What must not pass as good: a number that is none, a signal, an error of several kinds."""
    head = "units lj\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\nmass 1 1\npair_style none\n"
    nan = head + "variable n equal exp(1e4)\nthermo_style custom step v_n\nrun 0\n"
    for deck, kind in {nan: "not a number", "fix x\n": "refused", head + "run 0\n": "ran"}.items():
        assert judge(Case("test", 0, deck)).kind == kind, deck
    nowhere = Path("/nowhere")
    both = "ERROR: Fix dcm/a: b (a.cpp:1)\nERROR: Fix dcm/c: d (c.cpp:1)\n"
    assert judge.read(-11, "", "", nowhere).kind == "crash"
    assert judge.read(1, "", "terminate called after throwing", nowhere).kind == "exception"
    assert judge.read(1, both, "", nowhere).kind == "many errors"
    assert judge.read(1, "ERROR: bad (src/DCM/x.cpp:1)\n", "", nowhere).kind == "no context"
    assert judge.read(1, "", "", nowhere).kind == "no message"


def test_reports_of_open_mpi(judge):
    """A report counts unless all of its access is in a thread of Open MPI, as when it aborts."""
    head = "==1==ERROR: AddressSanitizer: heap-use-after-free on address 0x1\n"
    mpi = "    #0 0x1 in memcpy sanitizer.inc:8\n    #1 0x2 in send (/lib/libopen-rte.so.40+0x1)\n"
    ours = "    #2 0x3 in LAMMPS_NS::FixDCMCell::init() /x/src/DCM/fix_dcm_cell.cpp:9\n"
    error = "ERROR: Fix dcm/cell: wrong (src/DCM/fix_dcm_cell.cpp:1)\n"
    freed = "\nfreed by thread T0 here:\n" + ours
    assert judge.read(1, error, head + mpi + freed, Path("/nowhere")).kind == "refused"
    assert judge.read(1, error, head + mpi + ours + freed, Path("/nowhere")).kind == "sanitizer"
    assert judge.read(1, error, head + ours, Path("/nowhere")).kind == "sanitizer"


def test_damage():
    import numpy as np

    whole = b"one 1\ntwo 2.5\n" * 20
    changed = [mutate.text(np.random.default_rng(n), whole) for n in range(50)]
    assert len(set(changed)) > 40 and sum(c == whole for c in changed) < 10
