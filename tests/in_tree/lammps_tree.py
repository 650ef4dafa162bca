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
    """Flags of the plugin that decide on its code: with them the same numbers must come out.

    Position-independent code whose symbols are visible has fewer functions inlined, as another
    library might replace them, and then other products are fused with sums.
    """
    words = flags(BUILD, "dcmplugin")
    wanted = [w for w in words if w.startswith(("-O", "-m", "-f"))]
    wanted = [w for w in wanted if not w.startswith(("-fPIC", "-fvisibility"))]
    return ["-DNDEBUG", *wanted, "-fno-semantic-interposition"]


def settings():
    """Settings of the LAMMPS that runs the plugin, such as -DLAMMPS_PNG."""
    words = flags(lammps_source().parent / "build", "lammps") or flags(BUILD, "dcmplugin")
    return [w for w in words if w.startswith(("-DLAMMPS_", "-DLMP_"))]


def objects(folder):
    """Folder of links to the objects of that LAMMPS that any build with its settings may use.

    Not those that were compiled with the list of styles.
    """
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    build = lammps_source().parent / "build"
    for depends in (build / "CMakeFiles" / "lammps.dir").rglob("*.cpp.o.d"):
        if f"{build}/styles/" not in depends.read_text():
            name = depends.name.removesuffix(".cpp.o.d") + ".o"
            (folder / name).symlink_to(depends.with_suffix(""))
    return folder


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
    return subprocess.run([INSTALL, tree, *options], check=False, capture_output=True, text=True)


# --- builds ---------------------------------------------------------------------------------------


class Steps:
    """Runs the steps of a build in its folder; shows the end of their output if one fails."""

    def __init__(self, folder):
        self.log = folder / "build.log"
        self.log.write_text("")
        self.env = {
            **os.environ,
            "IN_TREE_OBJECTS": str(objects(folder / "objects")),
            "IN_TREE_SETTINGS": " ".join(settings()),
            "IN_TREE_LAUNCHER": os.environ.get("CMAKE_CXX_COMPILER_LAUNCHER", ""),
        }

    def __call__(self, *command, cwd=None):
        with open(self.log, "a") as out:
            print("+", *command, file=out, flush=True)
            done = subprocess.run(
                command, cwd=cwd, env=self.env, check=False, stdout=out, stderr=subprocess.STDOUT
            )
        if done.returncode != 0:
            end = "\n".join(self.log.read_text().splitlines()[-30:])
            pytest.fail(f"the in-tree build failed, end of {self.log}:\n{end}", pytrace=False)


def prepare(way):
    """Folder and tree of one way to build, with the package in the tree, and its steps."""
    folder = BUILD / "in_tree" / way
    plant(folder / "lammps")
    done = install(folder / "lammps")
    assert done.returncode == 0, done.stderr
    return folder, folder / "lammps", Steps(folder)


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
