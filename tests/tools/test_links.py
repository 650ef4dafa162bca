"""The check of what pages point to finds what is not there, and nothing else."""
import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def links(tmp_path, monkeypatch):
    """The check, in a repository of its own: a page, two .md files, a style, a picture."""
    spec = importlib.util.spec_from_file_location("check_links", ROOT / "tools/lib/check_links.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for name in ("doc/page.rst", "src/DCM/README.md", "README.md", "src/DCM/dcm_args.cpp",
                 "examples/single/in.single", "doc/img/cell.png", "src/DCM/law/hinge.h"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    (tmp_path / "doc/conf.py").write_text('LAMMPS_PAGES = set(\n    """\n    run fix_nve\n"""\n)')
    monkeypatch.chdir(tmp_path)

    def check(*words, page="", readme=""):
        Path("doc/page.rst").write_text(page)
        Path("README.md").write_text(readme)
        return module.main([str(w) for w in words])

    return check


GOOD = """``tools``, ``src/DCM/dcm_args``, ``examples/single/in.single -var R 5``; examples/*/in.*,
``src/DCM/law/\\*.h``, ``doc/<kind>_dcm.rst``, /path/to/lammps/src/version.h, $PWD/doc/x, runs/doc/y
.. image:: img/cell.png
   :target: page.html
"""


def test_what_is_there_is_no_fault(links, capsys):
    readme = "![cell](doc/img/cell.png) [a page](doc/page.rst#top) [site](https://x.org/doc/none)"
    assert links(page=GOOD, readme=readme) == 0 and capsys.readouterr().out == ""


@pytest.mark.parametrize("page, readme, says", [
    ("one\n\n``examples/double/in.x``", "", "doc/page.rst:3: there is no examples/double/in.x"),
    ("see doc/other.rst.", "", "doc/page.rst:1: there is no doc/other.rst"),
    ("   :target: none.html\n", "", "target none.html is no page"),
    ("", "![cell](doc/img/cells.png)", "doc/img/cells.png leads nowhere"),
    ("", "[a](CHANGES.md)", "README.md: the link CHANGES.md leads nowhere")])
def test_what_is_not_there_is_named(links, page, readme, says, capsys):
    assert links(page=page, readme=readme) == 1
    assert says in capsys.readouterr().out


def test_pages_of_lammps(links, tmp_path, capsys):
    manual = tmp_path / "manual"
    manual.mkdir()
    (manual / "run.rst").touch()
    assert links(manual) == 1
    assert capsys.readouterr().out.strip() == "doc/conf.py: LAMMPS' manual has no page fix_nve"
    (manual / "fix_nve.rst").touch()
    assert links(manual) == 0
    assert links(tmp_path / "nowhere") == 0    # without LAMMPS' sources they are not looked up
