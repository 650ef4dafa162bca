"""Run decks through the real lmp, and build the small scenes the tests share.

Environment, all set by tools/test: DCM_LMP (the lmp executable), LAMMPS_PLUGIN_PATH or DCM_BUILD
(the folder that holds dcmplugin.so), optionally DCM_MPIEXEC (mpirun).
"""

import itertools
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
TIMEOUT = 300  # s, for one run of lmp

# the tests' own parameters, so that their closed forms outlive changes in potentials/; every run
# finds them in its folder. Shipped files are found through LAMMPS_POTENTIALS: Scene(parameters=...)

PARAMETERS = "test.dcm"
PARAMETER_TEXT = """\
celltype hepatoblast
  E_cor 5.0
  h_cor 0.5
  nu_cor 0.5
  gamma 4.0
  K_V 2.5
  E_contact 5.0
  nu_contact 0.4
  friction_normal 50.0
  friction_tangential 50.0
  friction_ecm 1.0
  D 1e-4
celltype hepatoblast_cbm
  E_contact 0.45
  nu_contact 0.4
  friction_normal 50.0
  friction_tangential 50.0
  friction_ecm 1.0
  D 1e-4
adhesion hepatoblast hepatoblast 0.1
adhesion hepatoblast hepatoblast_cbm 0.1
adhesion hepatoblast_cbm hepatoblast_cbm 0.1
"""

# --- runner ---------------------------------------------------------------------------------------


class Frame:
    """One frame of a dump: step, box bounds, one array per column, rows sorted by id."""

    def __init__(self, step, box, names, rows):
        order = sorted(range(len(rows)), key=lambda r: int(rows[r][names.index("id")]))
        self.step, self.box, self.names = step, box, names
        self.columns = {
            name: np.array([_number(rows[r][k]) for r in order]) for k, name in enumerate(names)
        }

    def __getitem__(self, name):
        return self.columns[name]

    def vectors(self, *names):
        """Array (atoms, len(names))."""
        return np.stack([self.columns[n] for n in names], axis=1)

    @property
    def x(self):
        """Unwrapped positions if the dump has them, else wrapped ones."""
        names = ("xu", "yu", "zu") if "xu" in self.columns else ("x", "y", "z")
        return self.vectors(*names)

    @property
    def f(self):
        return self.vectors("fx", "fy", "fz")

    @property
    def v(self):
        return self.vectors("vx", "vy", "vz")


def _number(text):
    return float.fromhex(text) if "0x" in text else float(text)


def read_dump(path):
    """All frames of a text dump (style custom)."""
    frames, lines = [], Path(path).read_text().splitlines()
    k = 0
    while k < len(lines):
        assert lines[k] == "ITEM: TIMESTEP", lines[k]
        step, natoms = int(lines[k + 1]), int(lines[k + 3])
        box = np.array([[_number(w) for w in lines[k + 5 + d].split()] for d in range(3)])
        names = lines[k + 8].split()[2:]
        rows = [lines[k + 9 + n].split() for n in range(natoms)]
        frames.append(Frame(step, box, names, rows))
        k += 9 + natoms
    return frames


class Result:
    """What a run left: returncode, out, err, log (text), path (its folder), and the thermo lines.

    thermo: one dict (column -> value) per thermo line, all runs of the deck one after the other;
    runs: the same, one list per run.
    """

    def __init__(self, returncode, out, err, path, command):
        self.returncode, self.out, self.err, self.path = returncode, out, err, path
        self.command = command
        log = path / "log.lammps"
        self.log = log.read_text() if log.exists() else ""
        self.runs = self._thermo()
        self.thermo = [row for run in self.runs for row in run]

    def _thermo(self):
        runs, names = [], None
        for line in self.log.splitlines():
            words = line.split()
            if words and words[0] == "Step":
                names = words
                runs.append([])
            elif line.startswith("Loop time"):
                names = None
            elif names and len(words) == len(names):
                try:
                    runs[-1].append(dict(zip(names, map(float, words))))
                except ValueError:
                    pass  # a warning among the lines
        return runs

    def dump(self, name="dump.txt"):
        """Frames of a dump file of this run."""
        return read_dump(self.path / name)

    @property
    def error(self):
        """The lines of LAMMPS' error message, '' if there is none."""
        lines = self.out.splitlines()
        start = [k for k, line in enumerate(lines) if "ERROR" in line]
        return "\n".join(lines[start[0] :]) if start else ""

    def tail(self):
        return f"{self.command} in {self.path} returned {self.returncode}\n" + "\n".join(
            self.out.splitlines()[-25:] + self.err.splitlines()[-15:]
        )


class Runner:
    """lmp(deck): run a deck, an error fails the test; lmp.run(deck): the caller looks at it."""

    def __init__(self, folder):
        self.folder, self.count = folder, 0
        self.lmp = os.environ.get("DCM_LMP")
        plugins = os.environ.get("LAMMPS_PLUGIN_PATH") or os.environ.get("DCM_BUILD")
        if not self.lmp or not plugins:
            pytest.fail(
                "DCM_LMP and LAMMPS_PLUGIN_PATH are not set; run these tests with tools/test, "
                "for example: tools/test tests/styles -k ranks",
                pytrace=False,
            )
        if not os.access(self.lmp, os.X_OK):
            pytest.fail(f"DCM_LMP={self.lmp} is no executable; use tools/test", pytrace=False)
        if not any((Path(p) / "dcmplugin.so").exists() for p in plugins.split(":")):
            pytest.fail(f"no dcmplugin.so in {plugins}; use tools/test", pytrace=False)
        self.env = {
            **os.environ,
            "LAMMPS_PLUGIN_PATH": plugins,
            "LAMMPS_POTENTIALS": str(ROOT / "potentials"),
            "OMP_NUM_THREADS": "1",
            "OMPI_ALLOW_RUN_AS_ROOT": "1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_hwloc_base_binding_policy": "none",
            "OMPI_MCA_mpi_yield_when_idle": "1",  # more ranks than cores
        }

    def __call__(self, deck, np=1, vars=None, files=None, check=True, cwd=None, timeout=TIMEOUT):
        """Run `deck` (text, or the Path of a file) in a new folder, or in `cwd`.

        vars: index variables; a list gives several values. files: name -> text (or a Path to
        copy), written to the folder first. check: fail the test if lmp does not return 0.
        """
        self.count += 1
        path = Path(cwd) if cwd else self.folder / f"run{self.count}"
        path.mkdir(parents=True, exist_ok=True)
        (path / "log.lammps").unlink(missing_ok=True)
        for name, text in {PARAMETERS: PARAMETER_TEXT, **(files or {})}.items():
            if isinstance(text, Path):
                shutil.copy(text, path / name)
            else:
                (path / name).write_text(text)
        deck_path = path / "in.test"
        deck_path.write_text(deck.read_text() if isinstance(deck, Path) else deck)

        command = [self.lmp, "-in", "in.test", "-nocite"]
        for name, value in (vars or {}).items():
            values = value if isinstance(value, (list, tuple)) else [value]
            command += ["-var", name, *map(str, values)]
        if np > 1:
            mpirun = os.environ.get("DCM_MPIEXEC", "mpirun")
            command = [mpirun, "-np", str(np), *command]
        try:
            done = subprocess.run(
                command,
                cwd=path,
                env=self.env,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                timeout=timeout,
            )
        except subprocess.TimeoutExpired as late:
            out = (late.stdout or b"").decode(errors="replace")
            pytest.fail(f"{' '.join(command)} in {path} took more than {timeout} s:\n{out[-2000:]}")
        result = Result(done.returncode, done.stdout, done.stderr, path, " ".join(command))
        if check and result.returncode != 0:
            pytest.fail(result.tail(), pytrace=False)
        return result

    def run(self, deck, **options):
        """The same without a check of the return code."""
        return self(deck, check=False, **options)


@pytest.fixture
def lmp(tmp_path):
    """Runner of decks; each run gets its own folder below the test's tmp_path."""
    return Runner(tmp_path)


@pytest.fixture(scope="module")
def lmp_module(tmp_path_factory):
    """The same for fixtures shared by the tests of a file."""
    return Runner(tmp_path_factory.mktemp("lmp"))


# --- scenes ---------------------------------------------------------------------------------------


def words(*numbers):
    """Numbers for a deck, exact."""
    return " ".join(repr(float(x)) for x in numbers)


class Scene:
    """Text of a deck, part by part. One cell type: atom types 1 center, 2 node, 3 face, 4 sphere.

    s = Scene(box=20); s.dcm(-5, 0, 0, 6); s.cbm(5, 0, 0, 6); deck = s.head() + s.forces() + ...
    """

    NAMES = "hepatoblast hepatoblast hepatoblast hepatoblast_cbm"

    def __init__(self, box=20.0, boundary="s s s", level=1, parameters=PARAMETERS):
        self.box = [float(a) for a in np.broadcast_to(box, 3)]  # half lengths
        self.boundary, self.level, self.parameters = boundary, level, parameters
        self.cells, self.tags, self.next_tag = [], [], 1

    def dcm(self, x, y, z, radius, level=None, mesh=None, options="rotate 3 rest 0.95"):
        """Deformable cell of an icosphere or a mesh file; returns the tag of its center."""
        level = self.level if level is None else level
        shape = f"file {mesh[0]}" if mesh else f"icosphere {level}"
        self.cells.append(
            f"create_cells single hep dcm {words(x, y, z, radius)} dcm hep 1 2 3 1 1 "
            f"mesh {shape} {options}"
        )
        nodes, faces = mesh[1:] if mesh else (10 * 4**level + 2, 20 * 4**level)
        return self._tag(1 + nodes + faces)

    def cbm(self, x, y, z, radius):
        """Center-based cell; returns its tag."""
        self.cells.append(f"create_cells single cbm cbm {words(x, y, z, radius)} cbm cbm 4")
        return self._tag(1)

    def _tag(self, natoms):
        tag, self.next_tag = self.next_tag, self.next_tag + natoms
        return tag

    def head(self):
        """Box and cells."""
        a, b, c = self.box
        return (
            "units lj\natom_style dcm\nnewton on\n"
            f"boundary {self.boundary}\n"
            f"region box block {words(-a, a, -b, b, -c, c)}\n"
            "create_box 4 box bond/types 1 dihedral/types 1 "
            "extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
            "mass * 1.0\n" + "\n".join(self.cells) + "\n"
        )

    @property
    def map(self):
        return f"{self.parameters} {self.NAMES}"

    def cortex(self, bond="", bend="rest mesh"):
        return (
            "bond_style dcm/cortex\n"
            f"bond_coeff 1 {self.parameters} hepatoblast {bond}\n"
            "dihedral_style dcm/bend\n"
            f"dihedral_coeff 1 {self.parameters} hepatoblast {bend}\n"
        )

    def contact(self, style="", coeff=""):
        return (
            f"pair_style dcm/contact {style}\npair_coeff * * {self.map} {coeff}\n"
            "neighbor 0.6 multi\n"
        )

    def volume(self, options=""):
        return f"fix volume all dcm/volume {self.map} {options}\n"

    def motility(self, seed=7, options=""):
        return f"fix motility all dcm/motility {self.map} seed {seed} {options}\n"

    def motion(self, group="all", options="tolerance 1e-12"):
        return f"fix motion {group} dcm/motion {self.map} {options}\n"

    def forces(self, contact="", **options):
        """All laws of cells in contact, without motion."""
        return (
            self.cortex(**options)
            + self.contact(contact)
            + "fix cell all dcm/cell\n"
            + self.volume()
        )


def dump_command(
    columns="id mol type xu yu zu vx vy vz fx fy fz", every=1, file="dump.txt", group="all"
):
    """A dump in which every number is exact."""
    formats = "".join(
        f"dump_modify {file} format {k} %.17g\n"
        for k, name in enumerate(columns.split(), 1)
        if name not in ("id", "mol", "type", "proc", "ix", "iy", "iz")
    )
    return (
        f"dump {file} {group} custom {every} {file} {columns}\n"
        f"dump_modify {file} sort id\n" + formats
    )


def thermo_command(columns, every=1):
    """Thermo output in full precision; columns: thermo keywords, or name=formula."""
    names, text = [], ""
    for column in columns:
        if "=" in column:
            name, formula = column.split("=", 1)
            text += f"variable {name} equal {formula}\n"
            names.append("v_" + name)
        else:
            names.append(column)
    return (
        text + f"thermo_style custom step {' '.join(names)}\n"
        "thermo_modify norm no format float %.17g\n"
        f"thermo {every}\n"
    )


def single_cell(level=1, radius=6.0, box=15.0, boundary="s s s", options="rotate 3 rest 0.95"):
    """One deformable cell around the origin."""
    scene = Scene(box, boundary, level)
    scene.dcm(0.0, 0.0, 0.0, radius, options=options)
    return scene


def doublet(level=1, radius=6.0, gap=-0.1, boundary="s s s", box=20.0):
    """Two deformable cells along x, `gap` um between their mean surfaces."""
    scene = Scene(box, boundary, level)
    d = radius + gap / 2
    scene.dcm(-d, 0.0, 0.0, radius)
    scene.dcm(d, 0.0, 0.0, radius)
    return scene


def hybrid(level=1, boundary="s s s", box=(26.0, 26.0, 13.0), shift=(0.0, 0.0, 0.0)):
    """Three deformable and four center-based cells, touching."""
    scene = Scene(box, boundary, level)
    sx, sy, sz = shift
    for x, y in ((0.0, 6.8), (-5.9, -3.4), (5.9, -3.4)):
        scene.dcm(x + sx, y + sy, 0.0 + sz, 6.0)
    for x, y in ((-11.0, 7.0), (11.0, 7.0), (0.0, -13.0), (-16.0, -1.5)):
        scene.cbm(x + sx, y + sy, 0.2 + sz, 5.0)
    return scene


# --- meshes, independent of the package's own -----------------------------------------------------


def icosphere(level):
    """Nodes (n, 3) on the unit sphere and outward faces (m, 3)."""
    g = (1 + 5**0.5) / 2
    nodes = [v for a in (-1, 1) for b in (-g, g) for v in ((0, a, b), (a, b, 0), (b, 0, a))]
    nodes = [np.array(v) / np.linalg.norm(v) for v in nodes]
    edge = min(np.linalg.norm(nodes[0] - v) for v in nodes[1:])
    faces = []
    for t in itertools.combinations(range(12), 3):
        a, b, c = (nodes[i] for i in t)
        if all(abs(np.linalg.norm(d) - edge) < 1e-9 for d in (a - b, b - c, c - a)):
            faces.append(t if np.dot(np.cross(b - a, c - a), a) > 0 else t[::-1])
    for _ in range(level):
        middle = {}

        def mid(i, j):
            key = (min(i, j), max(i, j))
            if key not in middle:
                m = nodes[i] + nodes[j]
                middle[key] = len(nodes)
                nodes.append(m / np.linalg.norm(m))
            return middle[key]

        faces = [
            t
            for a, b, c in faces
            for ab, bc, ca in [(mid(a, b), mid(b, c), mid(c, a))]
            for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))
        ]
    return np.array(nodes), np.array(faces)


def off(nodes, faces):
    """Text of an OFF file."""
    lines = ["OFF", f"{len(nodes)} {len(faces)} 0"]
    lines += [" ".join(f"{x:.17g}" for x in node) for node in nodes]
    lines += ["3 " + " ".join(map(str, face)) for face in faces]
    return "\n".join(lines) + "\n"


class Scenes:
    """The builders above, for tests (conftest.py cannot be imported by name)."""

    Scene = Scene
    single_cell = staticmethod(single_cell)
    doublet = staticmethod(doublet)
    hybrid = staticmethod(hybrid)
    dump = staticmethod(dump_command)
    thermo = staticmethod(thermo_command)
    read_dump = staticmethod(read_dump)
    icosphere = staticmethod(icosphere)
    off = staticmethod(off)
    words = staticmethod(words)


@pytest.fixture(scope="session")
def scenes():
    return Scenes
