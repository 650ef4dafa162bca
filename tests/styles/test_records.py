"""Records of fixes in restart files: whoever reads one that is not its own says so."""

import struct

import pytest

from support.cycle_decks import growth
from support.parameters import FILES, PLAIN

MAGIC = b"DCM-re2\n"
# magic, name of the style, version, size, checksums of the data and of this header: dcm_record.h
HEADER = struct.Struct("<8s40sqqQQ")


@pytest.fixture(scope="module")
def written(lmp_module, scenes):
    """A restart file with records of all fixes that have one, and the deck to go on with."""
    scene = scenes.hybrid(boundary="f f f")
    scene.parameters = PLAIN
    fixes = (
        "fix cell all dcm/cell\n"
        + scene.volume()
        + growth(scene, "cycle_time 1000")
        + "fix division all dcm/division seed 4\n"
        + "fix death all dcm/death age 1e9\n"
        + "variable want atom 0\n"
        + "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_want mesh icosphere 1\n"
        + scene.motility(options="D 1e-4")
        + "fix confine all dcm/confine plane z 2.0\n"
        + scene.motion(options="")
    )
    head = scene.head() + scene.cortex() + scene.contact().replace("0.6", "0.8")
    result = lmp_module(head + fixes + "run 2\nwrite_restart r.2\n", files=FILES)
    deck = f"read_restart r.2\npair_coeff * * {scene.map}\nneighbor 0.8 multi\n" + fixes
    return (result.path / "r.2").read_bytes(), deck + "run 1\n"


def records(data):
    """Style -> place of its header."""
    found, at = {}, data.find(MAGIC)
    while at >= 0:
        _, style, version, size, _, _ = HEADER.unpack_from(data, at)
        assert version >= 1 and 0 <= size <= len(data)
        found[style.rstrip(b"\0").decode()] = at
        at = data.find(MAGIC, at + 1)
    return found


def read(lmp, written, change):
    data, deck = bytearray(written[0]), written[1]
    change(data)
    (lmp.folder / "changed").mkdir()
    path = lmp.folder / "changed" / "r.2"
    path.write_bytes(data)
    return lmp.run(deck, files={**FILES, "r.2": path})


def the_error(result):
    assert result.returncode == 1, result.tail()
    assert not result.thermo
    assert result.out.count("ERROR") == 1
    return result.error


STYLES = ["cell", "growth", "division", "death", "convert"]


def test_undamaged(lmp, written):
    assert set(records(written[0])) >= {f"Fix dcm/{name}" for name in STYLES}
    result = read(lmp, written, lambda data: None)
    assert result.returncode == 0, result.tail()
    assert len(result.thermo) == 2


@pytest.mark.parametrize("style", STYLES)
def test_no_record_of_this_package(lmp, written, style):
    """As raw numbers without a header, of a version that had none."""
    style = f"Fix dcm/{style}"

    def change(data):
        at = records(written[0])[style]
        data[at : at + 8] = struct.pack("<d", 7.0)

    error = the_error(read(lmp, written, change))
    assert f"{style}: its record in the restart file was not written by this style" in error
    assert "start from a data file" in error


@pytest.mark.parametrize("style", STYLES)
def test_another_version(lmp, written, style):
    style = f"Fix dcm/{style}"

    data = written[0]
    version = HEADER.unpack_from(data, records(data)[style])[2]

    def change(data):
        struct.pack_into("<q", data, records(written[0])[style] + 48, version + 41)

    error = the_error(read(lmp, written, change))
    assert f"{style}: its record in the restart file has version {version + 41}" in error
    assert f"this program reads version {version}" in error
    assert "use the version of the package" in error


def test_record_of_another_style(lmp, written):
    def change(data):
        at = records(written[0])["Fix dcm/growth"]
        data[at + 8 : at + 48] = b"Fix dcm/death".ljust(40, b"\0")

    error = the_error(read(lmp, written, change))
    assert "Fix dcm/growth: its record in the restart file was not written by this style" in error


@pytest.mark.parametrize("style", ["cell", "death"])
@pytest.mark.parametrize("size", ["short", "negative"])
def test_wrong_size(lmp, written, style, size):
    """The size of the record in its header is not that of what follows."""
    style = f"Fix dcm/{style}"

    def change(data):
        at = records(written[0])[style]
        right = HEADER.unpack_from(data, at)[3]
        assert right > 8
        wrong = {"short": 4, "negative": -1}[size]
        struct.pack_into("<q", data, at + 56, wrong)

    error = the_error(read(lmp, written, change))
    assert f"{style}: its record in the restart file" in error


@pytest.mark.parametrize("np_", [2])
def test_error_on_all_ranks(lmp, written, np_):
    """One error, not one per rank and no hanging process."""
    data, deck = bytearray(written[0]), written[1]
    at = records(written[0])["Fix dcm/cell"]
    struct.pack_into("<q", data, at + 48, 2)
    (lmp.folder / "changed").mkdir()
    path = lmp.folder / "changed" / "r.2"
    path.write_bytes(data)
    result = lmp.run(deck, np=np_, files={**FILES, "r.2": path}, timeout=60)
    assert result.returncode != 0
    assert result.out.count("ERROR: ") == 1, result.tail()
    assert "Fix dcm/cell: its record in the restart file has version 2" in result.error


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("where", ["size", "data", "last byte"])
@pytest.mark.parametrize("style", STYLES)
def test_damaged(lmp, written, style, where, np_):
    """One bit of a record has changed: what the checksum is for."""
    if np_ > 1 and style != "cell":
        pytest.skip("all records are read by the same code")
    style = f"Fix dcm/{style}"

    def change(data):
        at = records(written[0])[style]
        size = HEADER.unpack_from(data, at)[3]
        place = {"size": 57, "data": HEADER.size, "last byte": HEADER.size + size - 1}[where]
        data[at + place] ^= 4

    data, deck = bytearray(written[0]), written[1]
    change(data)
    (lmp.folder / "changed").mkdir()
    path = lmp.folder / "changed" / "r.2"
    path.write_bytes(data)
    error = the_error(lmp.run(deck, np=np_, files={**FILES, "r.2": path}))
    assert f"{style}: its record in the restart file is damaged" in error
    assert "use an earlier restart file" in error


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("back", [401, 1013, 4001])
def test_damaged_atom(lmp, written, back, np_):
    """One bit of an atom has changed; the file ends with the atoms."""
    data, deck = bytearray(written[0]), written[1]
    data[-back] ^= 1
    (lmp.folder / "changed").mkdir()
    path = lmp.folder / "changed" / "r.2"
    path.write_bytes(data)
    result = lmp.run(deck, np=np_, files={**FILES, "r.2": path})
    assert result.returncode != 0 and not result.thermo, result.tail()
    assert "Atom style dcm: an atom in the restart file is damaged" in result.error, result.tail()
