"""A LAMMPS source of the tests' own with the package in its tree, and both ways to build it.

Trees and builds stay in build/in_tree, so that only what changed is compiled again.
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
INSTALL = ROOT / "tools" / "install-in-tree"
REUSE = ROOT / "tests" / "in_tree" / "reuse_object"
BUILD = Path(os.environ.get("DCM_BUILD") or ROOT / "build")
JOBS = os.environ.get("DCM_JOBS") or str(os.cpu_count())


# --- the LAMMPS that the plugin was built for -----------------------------------------------------


def lammps_source():
    """Its top folder. Never written to."""
    cache = BUILD / "CMakeCache.txt"
    if not cache.is_file():
        pytest.fail(f"no {cache}; run these tests with tools/test", pytrace=False)
    for line in cache.read_text().splitlines():
        if line.startswith("LAMMPS_SOURCE_DIR:"):
            return Path(line.split("=", 1)[1]).resolve().parent
    return pytest.fail(f"no LAMMPS_SOURCE_DIR in {cache}", pytrace=False)


def flags(build, target):
    """Words of the compile command of a CMake target; none if it was not built there."""
    path = build / "CMakeFiles" / f"{target}.dir" / "flags.make"
    return path.read_text().split() if path.is_file() else []


def code_flags():
    """Flags of the plugin that decide on its code: with them the same numbers must come out."""
    words = flags(BUILD, "dcmplugin")
    wanted = [w for w in words if w.startswith(("-O", "-m", "-f"))]
    return ["-DNDEBUG"] + [w for w in wanted if not w.startswith(("-fPIC", "-fvisibility"))]


def settings():
    """Settings of the LAMMPS that runs the plugin, such as -DLAMMPS_PNG."""
    words = flags(lammps_source().parent / "build", "lammps") or flags(BUILD, "dcmplugin")
    return [w for w in words if w.startswith(("-DLAMMPS_", "-DLMP_"))]


# --- trees ----------------------------------------------------------------------------------------


def plant(tree):
    """A tree of links to the LAMMPS source; one of the same source that is there stays."""
    source = lammps_source()
    if (tree / "src" / "version.h").resolve() == source / "src" / "version.h":
        return
    shutil.rmtree(tree, ignore_errors=True)
    tree.mkdir(parents=True)
    folders = [source / name for name in ("src", "cmake", "lib")]
    subprocess.run(["cp", "-rs", *folders, tree], check=True)
    for other in source.iterdir():
        if not (tree / other.name).exists():
            (tree / other.name).symlink_to(other)


def install(tree, *options):
    """tools/install-in-tree, whether it works or not."""
    return subprocess.run([INSTALL, tree, *options], capture_output=True, text=True)


# --- builds ---------------------------------------------------------------------------------------


class Log:
    """Runs the steps of a build; shows the end of their output if one fails."""

    def __init__(self, path):
        self.path = path
        path.write_text("")

    def __call__(self, *command, cwd=None):
        env = {
            **os.environ,
            "IN_TREE_REFERENCE": str(lammps_source().parent / "build"),
            "IN_TREE_LAUNCHER": os.environ.get("CMAKE_CXX_COMPILER_LAUNCHER", ""),
        }
        with open(self.path, "a") as out:
            print("+", *command, file=out, flush=True)
            done = subprocess.run(command, cwd=cwd, stdout=out, stderr=subprocess.STDOUT, env=env)
        if done.returncode != 0:
            end = "\n".join(self.path.read_text().splitlines()[-30:])
            pytest.fail(f"the in-tree build failed, end of {self.path}:\n{end}", pytrace=False)


def prepare(way):
    """Folder, tree and log of one way to build, with the package in the tree."""
    folder = BUILD / "in_tree" / way
    plant(folder / "lammps")
    done = install(folder / "lammps")
    assert done.returncode == 0, done.stderr
    return folder, folder / "lammps", Log(folder / "build.log")


def build_cmake():
    """lmp of LAMMPS' CMake build with the packages DCM and PLUGIN."""
    folder, tree, run = prepare("cmake")
    options = {
        "PKG_DCM": "yes",
        "PKG_PLUGIN": "yes",
        "LAMMPS_SIZES": "BIGBIG" if "-DLAMMPS_BIGBIG" in settings() else "SMALLBIG",
        "BUILD_MPI": "yes",
        "BUILD_OMP": "no",
        "WITH_PNG": "yes" if "-DLAMMPS_PNG" in settings() else "no",
        "WITH_JPEG": "no",
        "WITH_GZIP": "no",
        "WITH_FFMPEG": "no",
        "WITH_CURL": "no",
        "CMAKE_BUILD_TYPE": "Release",
        "CMAKE_CXX_FLAGS_RELEASE": " ".join(code_flags()),
        "CMAKE_CXX_COMPILER_LAUNCHER": REUSE,
    }
    defines = [f"-D{name}={value}" for name, value in options.items()]
    run("cmake", "-S", tree / "cmake", "-B", folder / "build", *defines)
    run("cmake", "--build", folder / "build", "--parallel", JOBS)
    return folder / "build" / "lmp"


def build_make():
    """lmp of LAMMPS' traditional make with the same packages."""
    _, tree, run = prepare("make")
    src = tree / "src"
    run("make", "yes-plugin", "yes-dcm", cwd=src)
    run(
        "make",
        f"-j{JOBS}",
        "mpi",
        f"CC={REUSE} mpicxx",
        f"CCFLAGS={' '.join(code_flags())}",
        f"LMP_INC={' '.join(settings())}",
        "JPG_LIB=" + ("-lpng" if "-DLAMMPS_PNG" in settings() else ""),
        "LINKFLAGS=-rdynamic",
        cwd=src,
    )
    return src / "lmp_mpi"
