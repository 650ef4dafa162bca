"""tools/check docs: what the manual and the .md files point to is there.

Names of files of the repository in the text, links and pictures of .md files, targets of pictures
and the pages of LAMMPS' manual that doc/conf.py allows. Not what Sphinx checks itself (links
between pages), nor addresses of other sites (tools/check links). Run from the root of the
repository, standard library only.

  python check_links.py [DOC_OF_LAMMPS]      the folder doc/src of LAMMPS, to look up its pages
"""
import re
import sys
from pathlib import Path

DOC = Path("doc")
FOLDERS = ("src", "examples", "potentials", "tools", "tests", "doc", ".ci")
# ``tools/run ...``, `doc/build.rst`, and the first word of commands in code blocks
NAMED = re.compile(rf"(?<![\w/.$*{{}}<-])((?:{'|'.join(map(re.escape, FOLDERS))})/[\w./+-]*[\w/])"
                   r"(?![\w*{<$])")
MARKDOWN = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
TARGET = re.compile(r"^\s*:target: (\S+)$", re.MULTILINE)
# in LAMMPS' tree, or a name that stands for any
OTHER = re.compile(r"^src/(Makefile|law)$|NAME")


def named_files(text):
    """Names of files and folders of the repository in a page; those with a pattern or a variable in
    them, or followed by one, are left out."""
    for m in NAMED.finditer(text):
        yield m.group(1).rstrip("./"), text.count("\n", 0, m.start()) + 1


def check_names(path, text, known):
    for name, line in named_files(text):
        if not known(name) and not OTHER.search(name):
            yield f"{path}:{line}: there is no {name}"


def check_markdown(path, text):
    for link in MARKDOWN.findall(text):
        if not re.match(r"[a-z]+:|#", link) and not (path.parent / link.partition("#")[0]).exists():
            yield f"{path}: the link {link} leads nowhere"


def check_targets(path, text):
    for target in TARGET.findall(text):
        if not re.match(r"https?:", target) and not (
                DOC / target.partition("#")[0]).with_suffix(".rst").exists():
            yield f"{path}: the picture's target {target} is no page"


def check_lammps(folder):
    """Pages of LAMMPS' manual that conf.py names."""
    text = (DOC / "conf.py").read_text()
    for page in re.search(r'LAMMPS_PAGES = set\(\s*"""(.*?)"""', text, re.DOTALL).group(1).split():
        if not (folder / f"{page}.rst").exists():
            yield f"{DOC}/conf.py: LAMMPS' manual has no page {page}"


def main(words):
    faults = []

    def known(name):    # src/DCM/dcm_args means .cpp and .h
        return any(Path(name + end).exists() for end in ("", ".py", ".cpp", ".h"))

    pages = [*sorted(DOC.glob("*.rst")), *sorted(Path().glob("*.md")), Path("src/DCM/README.md")]
    for path in pages:
        text = path.read_text()
        faults += check_names(path, text, known)
        if path.suffix == ".md":
            faults += check_markdown(path, text)
        else:
            faults += check_targets(path, text)
    if words and Path(words[0]).is_dir():
        faults += check_lammps(Path(words[0]))
    for fault in faults:
        print(fault)
    return 1 if faults or len(pages) < 3 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
