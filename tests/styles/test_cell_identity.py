"""Analyses of a tissue whose cells grow, divide, die, change form and type, against compute
dcm/cell dumped in the same run: atom IDs go from cell to cell, and every row must be the right
cell's."""

import csv
import re

import numpy as np
import pytest

import lammps_dcm
from lammps_dcm.__main__ import main
from lammps_dcm.render import PALETTE, make_picture
from support.divisions import Cell, scene_of

EVERY = 5
FULL = (
    "id mol type c_p[1] radius xu yu zu c_p[2] c_p[3] c_p[4] c_p[5] c_p[6] "
    "c_c[1] c_c[2] c_c[3] c_c[4] c_c[5] c_f"
)
RENAME = {
    "c_p[1]": "kind", "c_p[2]": "v1", "c_p[3]": "v2", "c_p[4]": "v3", "c_p[5]": "volume0",
    "c_p[6]": "region", "c_f": "contact_area",
}  # fmt: skip
VOLUME, AREA, VOLUME0, PRESSURE, CONTACT = (f"c_c[{k}]" for k in range(1, 6))
K_V = 2.5


def tissue(scenes):
    """Two types of deformable cells (1 to 3, 5 to 7) and spheres (4), crowded at the middle."""
    scene = scene_of(scenes, 26.0, "p p p")
    scene.NAMES = "hepatoblast hepatoblast hepatoblast hepatoblast_cbm" + 3 * " hepatoblast"
    for x, y in ((-6.0, 0.0), (5.9, 0.0), (0.0, 10.2), (0.1, -10.2)):
        scene.dcm(x, y, 0.0, 6.0)
    scene.cbm(12.0, 10.0, 0.0, 5.0)
    scene.cbm(-12.0, 10.0, 0.3, 5.0)
    dumps, kinds = "", {"full": FULL, "poor": "id mol type x y z", "blind": "id type x y z"}
    for name, columns in kinds.items():
        # not sorted: rows come in another order in every frame, and on every number of ranks
        dumps += scenes.dump(columns, EVERY, f"{name}.dump").replace(
            f"dump_modify {name}.dump sort id\n", ""
        )
    return (
        scene.head().replace("create_box 4", "create_box 7")
        + scene.cortex()
        + scene.contact()
        + "fix cell all dcm/cell\n"
        + scene.volume()
        + f"fix grow all dcm/growth {scene.map} seed 5 cycle_time 40 cycle_sd 8 age random\n"
        + "fix divide all dcm/division seed 7 log div.log\n"
        + "variable dies atom (step==50)*((mol%4)==1)\n"
        + "fix die all dcm/death variable v_dies every 10 log die.log\n"
        + "variable form atom (step==60)*(mol%2==0)-(step==30)*(mol%3==0)\n"
        + "fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 variable v_form mesh icosphere 1 "
        + "rest 0.95 every 10\n"
        + scene.motion()
        + "timestep 1.0\n"
        + "compute p all property/atom kind vertex1 vertex2 vertex3 volume0 region\n"
        + "compute c all dcm/cell volume area volume0 pressure contact_area\n"
        + "compute f all dcm/face contact_area\n"
        + scenes.thermo(["atoms", "f_grow", "births=f_grow[6]", "deaths=f_grow[7]",
                         "to=f_convert[1]", "back=f_convert[2]"], EVERY)
        + "write_data start.data nofix\n"
        + dumps
        + "run 5\n"
        # two cells become such of the other type
        + "group first molecule 1 2\n"
        + "".join(
            f"group was{t} type {t}\ngroup now{t} intersect first was{t}\n"
            f"set group now{t} type {t + 4}\n"
            for t in (1, 2, 3)
        )
        + "run 65\n"
    )


@pytest.fixture(scope="module")
def run(lmp_module, scenes):
    result = lmp_module(tissue(scenes), np=2)
    result.truth = {frame.step: frame for frame in result.dump("full.dump")}
    return result


def deformable(frame):
    """molecule ID -> index of the center atom, of the deformable cells of a frame."""
    return {int(frame["mol"][k]): k for k in np.flatnonzero(frame["c_p[1]"] == 2)}


def spheres(frame):
    return {int(frame["mol"][k]): k for k in np.flatnonzero(frame["c_p[1]"] == 1)}


def load(run, dump="full", **options):
    return lammps_dcm.load(run.path / "start.data", run.path / f"{dump}.dump", **options)


def table(path):
    """(step, cell) -> row of a CSV file."""
    rows = list(csv.DictReader(path.open()))
    found = {(int(r["step"]), int(r["cell"])): r for r in rows}
    assert len(found) == len(rows)
    return found


def test_the_tissue_does_what_it_should(run):
    """Births, deaths, both conversions, a new type, and atom IDs that go from cell to cell."""
    last = run.thermo[-1]
    assert last["v_births"] >= 6 and last["v_deaths"] >= 2
    assert last["v_to"] >= 1 and last["v_back"] >= 1
    owners, kinds, types = {}, {}, {}
    for frame in run.truth.values():
        for tag, mol, kind, type in zip(
            *(frame[c].astype(int) for c in ("id", "mol", "c_p[1]", "type")), strict=True
        ):
            owners.setdefault(tag, set()).add(mol)
            kinds.setdefault(tag, set()).add(kind)
            types.setdefault(mol, set()).add(type)
    assert sum(len(mols) > 1 for mols in owners.values()) > 300
    assert sum(len(k) > 1 for k in kinds.values()) > 1
    assert any({1, 5} <= t for t in types.values())
    ids = [tuple(frame["id"]) for frame in run.truth.values()]
    assert len(set(map(len, ids))) > 3


def test_cells_on_the_command_line(run, tmp_path):
    words = ["cells", str(run.path / "full.dump"), "--data", str(run.path / "start.data")]
    words += ["--rename", ",".join(f"{k}={v}" for k, v in RENAME.items())]
    assert main([*words, "--bulk-modulus", str(K_V), "-o", str(tmp_path / "c.csv")]) == 0
    rows = table(tmp_path / "c.csv")
    truth = {
        (step, mol): [frame[c][k] for c in (VOLUME, AREA, PRESSURE)]
        for step, frame in run.truth.items()
        for mol, k in deformable(frame).items()
    }
    assert rows.keys() == truth.keys()
    for key, expected in truth.items():
        found = [float(rows[key][name]) for name in ("volume", "area", "pressure")]
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-8), key


def test_quality_on_the_command_line(run, tmp_path):
    words = ["quality", str(run.path / "full.dump"), "--data", str(run.path / "start.data")]
    words += ["--rename", ",".join(f"{k}={v}" for k, v in RENAME.items()), "--frame", "all"]
    assert main([*words, "-o", str(tmp_path / "q.csv")]) == 0
    rows = table(tmp_path / "q.csv")
    assert rows.keys() == {(s, m) for s, frame in run.truth.items() for m in deformable(frame)}
    for (step, mol), row in rows.items():
        frame = run.truth[step]
        assert float(row["worst"]) == pytest.approx(cell(frame, mol).quality, rel=1e-8)
        face = np.flatnonzero(frame["id"] == int(row["worst_face"]))[0]
        assert (frame["mol"][face], frame["c_p[1]"][face]) == (mol, 4)


def cell(frame, mol):
    """Cell of tests/styles/divisions.py, which wants other columns."""
    names = {"c_c[2]": frame[VOLUME0], "c_c[3]": frame[CONTACT], "fx": frame["xu"],
             "fy": frame["xu"], "fz": frame["xu"], "vx": frame["xu"], "vy": frame["xu"],
             "vz": frame["xu"]}  # fmt: skip
    copy = type(frame).__new__(type(frame))
    copy.step, copy.box, copy.names = frame.step, frame.box, frame.names
    copy.columns = {**frame.columns, **names}
    return Cell(copy, mol)


def test_arrays_cover_all_frames(run):
    u = load(run, rename=RENAME)
    r = lammps_dcm.CellPressure(u, {"1": K_V, "5": 2 * K_V}).run().results
    assert r.cells.tolist() == sorted(set().union(*map(deformable, run.truth.values())))
    for k, step in enumerate(r.steps):
        frame, here = run.truth[step], deformable(run.truth[step])
        assert r.cells[r.present[k]].tolist() == sorted(here)
        assert np.isnan(r.volume[k, ~r.present[k]]).all()
        at = [here[m] for m in r.cells[r.present[k]]]
        assert r.volume0[k, r.present[k]] == pytest.approx(frame[VOLUME0][at], rel=1e-12)
        modulus = np.where(frame["type"][at] == 5, 2.0, 1.0)    # of the type of that frame
        assert r.pressure[k, r.present[k]] == pytest.approx(modulus * frame[PRESSURE][at], abs=1e-8)


def test_contacts(run):
    r = lammps_dcm.CellContacts(load(run, rename=RENAME)).run().results
    touching = 0
    for k, step in enumerate(r.steps):
        frame, here = run.truth[step], deformable(run.truth[step])
        at = [here[m] for m in r.cells[r.present[k]]]
        assert r.contact_area[k, r.present[k]] == pytest.approx(frame[CONTACT][at], abs=1e-8)
        pairs = set(map(tuple, r.neighbors[k]))
        assert {m for pair in pairs for m in pair} <= here.keys() | spheres(frame).keys()
        # who touches: a neighbor is near, as told by this frame's own atoms of that cell
        for mol, k in here.items():
            if frame[CONTACT][k] > 1.0:
                touching += 1
                assert any(mol in pair for pair in pairs), (step, mol)
    assert touching > 20


def test_faces(run):
    r = lammps_dcm.FaceArea(load(run, rename=RENAME)).run().results
    assert len(set(zip(r.cell, r.faces, strict=True))) == len(r.faces)
    for k, step in enumerate(r.steps):
        frame = run.truth[step]
        face = frame["c_p[1]"] == 4
        now = set(zip(frame["mol"][face].astype(int), frame["id"][face].astype(int), strict=True))
        there = ~np.isnan(r.area[k])
        assert set(zip(r.cell[there], r.faces[there], strict=True)) == now
        assert (r.regions[k, ~there] == -1).all() and (r.regions[k, there] == 0).all()
        total = sum(frame[AREA][c] for c in deformable(frame).values())
        assert np.nansum(r.area[k]) == pytest.approx(total, rel=1e-8)


def test_pictures(run):
    """Surfaces and spheres where the frame has them, in the color of their molecule ID."""
    from matplotlib.colors import to_rgb

    u = load(run, rename=RENAME)
    for n, (_, frame) in enumerate(sorted(run.truth.items())):
        u.trajectory[n]
        picture = make_picture(u, "cell")
        expected = {}
        for mol in frame["mol"][frame["c_p[1]"] == 4].astype(int):
            color = to_rgb(PALETTE[(mol - 1) % len(PALETTE)])
            expected[color] = expected.get(color, 0) + 1
        colors, count = np.unique(picture.face_rgb, axis=0, return_counts=True)
        assert {tuple(c): m for c, m in zip(colors, count, strict=True)} == expected
        ball = {tuple(x): m for x, m in zip(picture.centers, picture.sphere_rgb, strict=True)}
        for mol, k in spheres(frame).items():
            rgb = to_rgb(PALETTE[(mol - 1) % len(PALETTE)])
            assert tuple(ball.pop(tuple(frame.x[k]))) == rgb
        assert not ball
        assert (picture.radii == frame["radius"][frame["c_p[1]"] == 1]).all()


def test_dump_with_mol_but_without_faces(run):
    """Cells of the data file are measured as long as they are there, the others have a row without
    values and a warning: what their faces are is in no column."""
    u = load(run, "poor")
    with pytest.warns(UserWarning) as said:
        r = lammps_dcm.CellVolume(u).run().results
    for text in ("vertices of its faces are not known.*v1 v2 v3", "are is not known.*column kind"):
        assert any(re.search(text, str(w.message)) for w in said), text
    measured = 0
    for k, step in enumerate(r.steps):
        frame = run.truth[step]
        # types 5 to 7 are not in the data file: cells 1 and 2 are known by their IDs
        here = {m: c for m, c in deformable(frame).items() if m <= 2 or frame["type"][c] == 1}
        assert r.cells[r.present[k]].tolist() == sorted(here)
        for mol, volume in zip(r.cells[r.present[k]], r.volume[k, r.present[k]], strict=True):
            if mol <= 4 and not np.isnan(volume):
                assert volume == pytest.approx(frame[VOLUME][here[mol]], rel=1e-8)
                measured += 1
            else:
                assert np.isnan(volume)
    first = run.truth[0]
    assert measured >= 4 * 3 and r.volume[0, :4] == pytest.approx(
        [first[VOLUME][deformable(first)[m]] for m in (1, 2, 3, 4)], rel=1e-8)


def test_dump_without_mol_is_refused(run):
    u = load(run, "blind")
    with pytest.warns(UserWarning, match="no column mol"), pytest.raises(
        ValueError, match=r"frame \d+: the dump has no column mol.*add mol"
    ):
        lammps_dcm.CellVolume(u).run()
    with pytest.raises(ValueError, match="add mol"):
        u.trajectory[len(u.trajectory) - 1]
        make_picture(u, "cell")


def test_lineage_of_the_run(run, tmp_path, capsys):
    """Numbers of cells from the thermo output and the logs are those of the book."""
    logs = [str(run.path / "div.log"), "--death", str(run.path / "die.log")]
    logs += ["--thermo", str(run.path / "log.lammps"), "-o", str(tmp_path / "t.png")]
    assert main(["lineage", *logs]) == 0
    said = capsys.readouterr().out
    first, last = (int(n) for n in re.search(r"cells: (\d+) at .*, (\d+) at", said).groups())
    assert (first, last) == (6, run.thermo[-1]["f_grow"])
