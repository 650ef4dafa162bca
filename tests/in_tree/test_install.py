"""tools/install-in-tree: what it changes, that it can be repeated and undone, and its refusals."""

import difflib
import filecmp
import shutil
import subprocess

import pytest
from lammps_tree import ROOT, install, lammps_source

FILES = ("cmake/CMakeLists.txt", "src/Makefile", "src/version.h")


@pytest.fixture
def tree(tmp_path):
    """The files of a LAMMPS source that the tool looks at."""
    tree = tmp_path / "lammps"
    for name in FILES:
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(lammps_source() / name, tree / name)
    (tree / "cmake/Modules/Packages").mkdir(parents=True)
    (tree / "lib").mkdir()
    return tree


def content(tree):
    """Path -> bytes (folders: None) of everything below."""
    paths = sorted(tree.rglob("*"))
    return {p.relative_to(tree): p.read_bytes() if p.is_file() else None for p in paths}


def done(tree, *options):
    result = install(tree, *options)
    assert result.returncode == 0, result.stderr
    return result.stdout


def refused(tree, *options):
    before = content(tree) if tree.exists() else None
    result = install(tree, *options)
    assert result.returncode == 1 and "ERROR" in result.stderr
    assert before is None or content(tree) == before
    return result.stderr


def test_every_file_of_the_package_arrives(tree):
    done(tree)
    for source in (ROOT / "src/DCM").rglob("*.*"):
        if source.suffix in (".cpp", ".h"):
            target = tree / "src/DCM" / source.relative_to(ROOT / "src/DCM")
            assert filecmp.cmp(source, target, shallow=False)


def test_lists_of_packages_gain_one_entry_each(tree):
    done(tree)
    for name in ("cmake/CMakeLists.txt", "src/Makefile"):
        old = (lammps_source() / name).read_text().splitlines(keepends=True)
        new = (tree / name).read_text().splitlines(keepends=True)
        changes = [line for line in difflib.ndiff(old, new) if line[0] in "+-"]
        if name == "src/Makefile":
            assert changes == ["+ \tdcm \\\n"] * 3
        else:
            added, before, after = changes
            assert added == "+   DCM\n"
            assert before[2:].replace(")", " DCM)") == after[2:]


def test_twice_is_once(tree):
    done(tree)
    once = content(tree)
    assert done(tree) == "nothing to do\n"
    assert content(tree) == once


@pytest.mark.parametrize("option", [(), ("--link",)], ids=["copy", "link"])
def test_remove_restores_the_tree(tree, option):
    before = content(tree)
    done(tree, *option)
    assert content(tree) != before
    done(tree, "--remove")
    assert content(tree) == before
    assert done(tree, "--remove") == "nothing to do\n"


def test_links_lead_here_and_copies_replace_them(tree):
    done(tree, "--link")
    header = tree / "src/DCM/law/hinge.h"
    assert header.resolve() == ROOT / "src/DCM/law/hinge.h"
    done(tree)
    assert not header.is_symlink()
    assert filecmp.cmp(header, ROOT / "src/DCM/law/hinge.h", shallow=False)


def test_links_in_the_tree_are_replaced_and_not_written_through(tree, tmp_path):
    real = tmp_path / "elsewhere"
    shutil.move(tree / "src/Makefile", real)
    (tree / "src/Makefile").symlink_to(real)
    before = real.read_bytes()
    done(tree)
    assert real.read_bytes() == before
    assert b"\tdcm \\\n" in (tree / "src/Makefile").read_bytes()


def test_outdated_files_are_renewed_and_removed(tree):
    done(tree)
    stale, outdated = tree / "src/DCM/fix_dcm_gone.cpp", tree / "src/DCM/law/hinge.h"
    copy = tree / "src/fix_dcm_gone.cpp"  # as make yes-dcm leaves it
    for path in (stale, outdated, copy):
        path.write_text("old\n")
    out = done(tree)
    assert not stale.exists() and not copy.exists()
    assert filecmp.cmp(outdated, ROOT / "src/DCM/law/hinge.h", shallow=False)
    assert out.splitlines() == ["removed src/DCM/fix_dcm_gone.cpp", "copied src/DCM/law/hinge.h"]


def test_files_of_others_in_the_folder_stay(tree):
    done(tree)
    (tree / "src/DCM/notes.txt").write_text("mine\n")
    done(tree, "--remove")
    assert [p.name for p in (tree / "src/DCM").iterdir()] == ["notes.txt"]


def test_refuses_a_folder_that_is_no_lammps(tmp_path):
    assert "is not the top folder of a LAMMPS source: it has no src/version.h" in refused(tmp_path)


def test_refuses_a_folder_that_does_not_exist(tmp_path):
    assert "is not the top folder of a LAMMPS source" in refused(tmp_path / "nowhere")


def test_refuses_the_src_folder(tree):
    assert "give the folder above it" in refused(tree / "src")


def test_refuses_an_old_version(tree):
    (tree / "src/version.h").write_text('#define LAMMPS_VERSION "29 Aug 2024"\n')
    assert "LAMMPS 29 Aug 2024, the package needs 4 Feb 2025 or newer" in refused(tree)


def test_accepts_a_newer_version(tree):
    (tree / "src/version.h").write_text('#define LAMMPS_VERSION "22 Jul 2025"\n')
    done(tree)


def test_refuses_a_package_of_the_same_name(tree):
    (tree / "src/DCM").mkdir()
    (tree / "src/DCM/other.cpp").write_text("\n")
    assert "src/DCM is there and is not this package" in refused(tree)


@pytest.mark.parametrize("name", ["cmake/CMakeLists.txt", "src/Makefile"])
def test_refuses_a_list_it_does_not_know(tree, name):
    path = tree / name
    path.write_text(path.read_text().replace("PACKAGES", "PARCELS").replace("PACKAGE", "PARCEL"))
    message = refused(tree)
    assert str(path) in message and "has no list of packages" in message


# --- traditional make -----------------------------------------------------------------------------


@pytest.fixture
def src(tree):
    """src of the tree with the package, as make sees it when another package is installed."""
    for name in ("Makefile.package", "Makefile.package.settings"):
        text = (lammps_source() / "src" / f"{name}.empty").read_text()
        text = text.replace("PKG_SYSINC = ", "PKG_SYSINC = $(other_SYSINC) ")
        (tree / "src" / name).write_text(text)
    done(tree)
    return tree / "src"


def mode(src, number):
    command = ["sh", "Install.sh", str(number)]
    return subprocess.run(
        command, cwd=src / "DCM", check=True, capture_output=True, text=True
    ).stdout


def test_make_gets_the_files_and_the_settings_once(src):
    mode(src, 1)
    once = content(src)
    for path in (src / "DCM").rglob("*.*"):
        if path.suffix in (".cpp", ".h"):
            assert filecmp.cmp(path, src / path.relative_to(src / "DCM"), shallow=False)
    settings = (src / "Makefile.package").read_text()
    assert "PKG_SYSINC = $(dcm_SYSINC) $(other_SYSINC) \n" in settings
    lines = (src / "Makefile.package.settings").read_text().splitlines()
    assert lines.count("include ../../lib/dcm/Makefile.lammps") == 1
    mode(src, 1)
    assert content(src) == once
    (src / "law/hinge.h").write_text("old\n")
    assert mode(src, 2) == "  updating src/law/hinge.h\n"
    assert content(src) == once


def test_make_gives_everything_back(src):
    before = content(src)
    mode(src, 1)
    assert content(src) != before
    mode(src, 0)
    assert content(src) == before


def test_remove_undoes_the_installation_for_make(tree, src):
    mode(src, 1)
    done(tree, "--remove")
    left = {p.relative_to(tree).as_posix() for p in tree.rglob("*") if p.is_file()}
    assert left == {*FILES, "src/Makefile.package", "src/Makefile.package.settings"}


def make_settings(tree, **variables):
    """Makefile.lammps, read as Obj_mpi/Makefile reads it."""
    text = f"include {tree}/lib/dcm/Makefile.lammps\nall:\n\t@echo $(dcm_SYSINC)\n"
    (tree / "Makefile").write_text(text)
    command = ["make", "-s", "all", *(f"{name}={value}" for name, value in variables.items())]
    return subprocess.run(command, cwd=tree, check=False, capture_output=True, text=True)


def test_make_finds_eigen(tree, tmp_path):
    done(tree)
    (tmp_path / "mine/Eigen").mkdir(parents=True)
    (tmp_path / "mine/Eigen/Core").touch()
    given = make_settings(tree, EIGEN3_INCLUDE_DIR=tmp_path / "mine")
    assert given.stdout == f"-I../law -I{tmp_path}/mine\n"
    assert make_settings(tree).stdout.startswith("-I../law -I/")


def test_make_says_what_is_missing(tree):
    done(tree)
    eigen = make_settings(tree, EIGEN3_INCLUDE_DIR="/nowhere")
    assert eigen.returncode != 0
    assert "needs the headers of Eigen 3.3 or newer, and /nowhere has no" in eigen.stderr
    serial = make_settings(tree, MPI_INC="-I../STUBS")
    assert serial.returncode != 0 and "needs an MPI library" in serial.stderr
