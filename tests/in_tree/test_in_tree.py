"""The package as a part of LAMMPS, built with CMake and with make, against the plugin.

The builds take the code-generation flags of the plugin, so that results agree to the last digit.
"""

import os
import subprocess

import pytest
from lammps_tree import BUILD, ROOT, build_cmake, build_make

# shipped decks in short: a cell under load; two cells and a sphere in contact
DECKS = {
    "single": ("examples/single/in.single", {"hold": 2, "image": "no"}),
    "first_steps": ("doc/first_steps/in.first_steps", {"level": 1}),
}

EVERYTHING = (
    "write_dump all custom end.dump id mol type radius x y z vx vy vz fx fy fz "
    "modify sort id format float %.17g\n"
)

BUILT_IN = "dcmplugin.so not loaded: this LAMMPS has the package DCM built in"


class Runner:
    """Runs decks with one lmp, each in a folder of its own."""

    def __init__(self, lmp, folder):
        self.lmp, self.folder = str(lmp), folder

    def __call__(self, deck, np=1, plugin=False, variables=None, name="run"):
        """Folder and everything printed; plugin: LAMMPS finds it in LAMMPS_PLUGIN_PATH."""
        path = self.folder / f"{name}{np}"
        path.mkdir()
        (path / "in.test").write_text(deck)
        env = {**os.environ, "LAMMPS_POTENTIALS": str(ROOT / "potentials")}
        env["LAMMPS_PLUGIN_PATH"] = str(BUILD) if plugin else ""
        command = ["mpirun", "-np", str(np), self.lmp, "-in", "in.test", "-nocite"]
        for variable, value in (variables or {}).items():
            command += ["-var", variable, str(value)]
        done = subprocess.run(
            command, cwd=path, env=env, check=False, capture_output=True, text=True, timeout=300
        )
        out = done.stdout + done.stderr
        assert done.returncode == 0, f"{' '.join(command)} in {path}\n{out}"
        return path, out


@pytest.fixture(scope="module", params=[build_cmake, build_make], ids=["cmake", "make"])
def in_tree(request, tmp_path_factory):
    """lmp with the package built in."""
    return Runner(request.param(), tmp_path_factory.mktemp("in_tree"))


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """(deck, ranks) -> folder of the run with the plugin, once each."""
    lmp = Runner(os.environ["DCM_LMP"], tmp_path_factory.mktemp("plugin"))
    runs = {}

    def get(deck, np):
        if (deck, np) not in runs:
            runs[deck, np] = run_deck(lmp, deck, np, plugin=True)
        return runs[deck, np]

    return get


def run_deck(lmp, deck, np, plugin):
    path, variables = DECKS[deck]
    text = f"include {ROOT / path}\n{EVERYTHING}"
    return lmp(text, np=np, plugin=plugin, variables=variables, name=f"{deck}_{plugin}")[0]


def thermo(folder):
    """The thermo tables of the log, as printed."""
    rows, inside = [], False
    for line in (folder / "log.lammps").read_text().splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            inside = True
        elif line.startswith("Loop time"):
            inside = False
        if inside:
            rows.append(words)
    assert len(rows) > 3
    return rows


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("deck", DECKS)
def test_same_numbers_as_the_plugin(in_tree, reference, deck, np_):
    """Thermo output as printed, and all atoms at the end to the last digit."""
    ours, plugin = run_deck(in_tree, deck, np_, plugin=False), reference(deck, np_)
    assert thermo(ours) == thermo(plugin)
    assert (ours / "end.dump").read_text() == (plugin / "end.dump").read_text()


def test_lammps_lists_the_package(in_tree):
    _, out = in_tree("info config styles atom\n", name="info")
    packages = out.split("Installed packages:")[1].split("\n\n")[1]
    assert sorted(packages.split()) == ["DCM", "PLUGIN"]  # needs no other package


@pytest.mark.parametrize("how", ["path", "command"])
def test_plugin_beside_the_built_in_package_is_refused(in_tree, reference, how):
    """A message, and the styles stay those that are built in."""
    path, variables = DECKS["single"]
    load = f"plugin load {BUILD}/dcmplugin.so\n" if how == "command" else ""
    deck = f"{load}include {ROOT / path}\nplugin list\n{EVERYTHING}"
    folder, out = in_tree(deck, plugin=how == "path", variables=variables, name=how)
    assert out.count(BUILT_IN) == 1
    assert "style plugin dcm" not in out
    assert (folder / "end.dump").read_text() == (reference("single", 1) / "end.dump").read_text()


CELL = """\
units lj
atom_style dcm
newton on
special_bonds lj/coul 1 1 1
boundary p p p
region box block -13 13 -13 13 -13 13
create_box 3 box bond/types 1 dihedral/types 1
mass * 1.0
create_cells single hepatoblast dcm 0 0 0 6.0 dcm hepatoblast 1 2 3 1 1 &
  mesh icosphere 1 rest 0.95
{replicate}
bond_style dcm/cortex
bond_coeff 1 bile_duct.dcm hepatoblast
dihedral_style dcm/bend
dihedral_coeff 1 bile_duct.dcm hepatoblast
pair_style dcm/contact
variable map string "bile_duct.dcm hepatoblast hepatoblast hepatoblast"
pair_coeff * * ${{map}}
neighbor 0.6 multi
fix cell all dcm/cell
fix volume all dcm/volume ${{map}}
fix move all dcm/motion ${{map}}
compute cell all dcm/cell molecule volume area pressure
timestep 0.1
run 20
group centers type 1
write_dump centers custom end.dump id c_cell[1] c_cell[2] c_cell[3] c_cell[4] &
  modify sort id format float %.17g
"""


def cells(folder):
    lines = (folder / "end.dump").read_text().splitlines()
    start = [line.startswith("ITEM: ATOMS") for line in lines].index(True) + 1
    return [[float(word) for word in line.split()[1:]] for line in lines[start:]]


@pytest.mark.parametrize("np_", [1, 2])
def test_replicate_works_in_the_tree(in_tree, np_):
    """Two by one by one copies: two cells, each as the one alone."""
    one = cells(in_tree(CELL.format(replicate=""), np=np_, name="one")[0])
    two = cells(in_tree(CELL.format(replicate="replicate 2 1 1"), np=np_, name="two")[0])
    assert len(one) == 1 and [cell[0] for cell in two] == [1, 2]
    for cell in two:
        assert cell[1:] == pytest.approx(one[0][1:], rel=1e-9)
