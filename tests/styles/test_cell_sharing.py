"""Sums over the processes that share a cell, and the table of cells where a process has no atom of
many cells: what all() has is current wherever it is read."""

import os
from pathlib import Path

import numpy as np
import pytest

from support.bad_decks import whole

CELLS = 8
PROBE = {"shares": 11, "differ": 12, "elsewhere": 13, "blank": 14, "unequal": 15}


def row_of_cells(scenes, boundary="p p p"):
    """Touching cells in a row along x, those at the ends touch through the border."""
    room = 0.0 if boundary == "p p p" else 1.0
    scene = scenes.Scene((5.9 * CELLS + room, 20.0, 20.0), boundary)
    for n in range(CELLS):
        scene.dcm(5.9 * (2 * n + 1 - CELLS), 0.3 * (-1) ** n, 0.2 * n, 6.0)
    return scene


@pytest.fixture
def probing(lmp):
    """Runner with the plugin that has fix dcm/probe."""
    folder = Path(os.environ["DCM_BUILD"]) / "extend"
    assert (folder / "dcmplugin.so").exists(), f"no dcmplugin.so in {folder}; use tools/test"
    lmp.env["LAMMPS_PLUGIN_PATH"] = str(folder)
    return lmp


@pytest.mark.parametrize("np_", [1, 2, 3, 4])
@pytest.mark.parametrize("boundary", ["s s s", "p p p"])
def test_shared_sums(probing, scenes, np_, boundary):
    """The same to the last bit on all processes that share a cell; what others have is no
    number until it is asked for, and then the same everywhere."""
    deck = whole(row_of_cells(scenes, boundary), extra="fix probe all dcm/probe\n")
    deck += scenes.thermo([f"{name}=f_probe[{k}]" for name, k in PROBE.items()])
    for row in probing(deck + "timestep 1.0\nrun 5\n", np=np_).thermo:
        assert row["v_differ"] == row["v_unequal"] == 0
        assert row["v_shares"] + row["v_elsewhere"] == CELLS * np_
        assert row["v_shares"] > CELLS or np_ == 1
        assert row["v_elsewhere"] > 0 or np_ < 3
        if row["Step"] > 0:    # at first the pair style has asked, to check the start
            assert row["v_blank"] == row["v_elsewhere"]


READERS = {
    "confine": (
        "group some molecule 2 7\n"
        "fix confine all dcm/confine axis x center 0.5 0.2 pressure 0.2 over some tau 100 "
        "plane z 0.01 at 0.5 group all\n",
        ["force=f_confine[1]", "over=f_confine[2]", "far=f_confine[3]", "plane=f_confine"],
    ),
    "motility": ("fix m all dcm/motility {map} seed 7 D 1e-3 persistence 20\n", []),
    "growth": (
        "fix growth all dcm/growth {map} seed 3 cycle_time 60 cycle_sd 5 age random "
        "compression 0.1 1 rounding 0.5 0.95\n"
        "compute g all dcm/cell pressure_before cycle_time\ncompute gs all reduce sum c_g[*]\n",
        ["rounding=f_growth[2]", "before=c_gs[1]"],
    ),
    "signal": (
        "group from molecule 2 7\ngroup rest subtract all from\n"
        "fix turn rest dcm/signal from from to 1 2 3 time 8 area 0.05 lumen no every 2\n",
        ["waiting=f_turn[1]", "decided=f_turn[2]", "time=f_turn[4]"],
    ),
    "polarity": (
        "fix pol all dcm/polarity seed 11 init toward 0.5 20 30 junction auto every 3\n"
        "compute p all dcm/cell ax py apical_area\ncompute q all reduce sum c_p[*]\n",
        ["polar=f_pol[1]", "apical=f_pol[2]", "ribbon=f_pol[3]"]
        + [f"q{k}=c_q[{k}]" for k in (1, 2, 3)],
    ),
}


@pytest.mark.parametrize("scheme", ["explicit", "implicit dt auto tol 0.05 max 2"])
@pytest.mark.parametrize("reader", READERS)
def test_readers_of_the_whole_table(lmp, scenes, reader, scheme):
    """Whoever reads the measures of all cells has those of cells elsewhere: 1, 2, 3 and 4 ranks
    agree in positions and output."""
    scene = row_of_cells(scenes)
    extra, columns = READERS[reader]
    extra = extra.format(map=scene.map)
    if reader == "motility":
        scheme = scheme.split()[0]    # which draws for one step of given length
    motion = scene.motion(options=f"scheme {scheme} tolerance 1e-12")
    deck = whole(scene, extra=extra, motion=motion)
    deck += (
        "compute c all dcm/cell volume area pressure x vx contact_area\n"
        "compute cs all reduce sum c_c[*]\n"
    )
    deck += scenes.thermo(
        [*columns, "mean=f_volume[1]", "low=f_volume[2]", "high=f_volume[3]", "energy=f_volume",
         *(f"c{k}=c_c[{k}]" for k in (1, 2, 3, 6)), *(f"s{k}=c_cs[{k}]" for k in range(1, 7))], 2)
    deck += scenes.dump("id x y z fx fy fz", 6) + "timestep 1.0\nrun 12\n"
    one = lmp(deck)
    assert len({row["v_s1"] for row in one.thermo}) > 1    # something happens
    for np_ in (2, 3, 4):
        other = lmp(deck, np=np_)
        for a, b in zip(one.thermo, other.thermo, strict=True):
            for key in a:
                assert b[key] == pytest.approx(a[key], rel=1e-8, abs=1e-9), (np_, a["Step"], key)
        for a, b in zip(one.dump(), other.dump(), strict=True):
            assert np.abs(a.x - b.x).max() < 1e-9


def test_restart_with_cells_elsewhere(lmp, scenes):
    """100 steps after a restart are those of the run that wrote it, bit for bit, on 4 ranks."""
    scene, processors = row_of_cells(scenes), "processors 4 1 1\n"
    laws = "fix cell all dcm/cell\n" + scene.volume()
    for reader in ("confine", "motility"):
        laws += READERS[reader][0].format(map=scene.map)
    laws += scene.motion(options="tolerance 1e-6") + "timestep 1.0\n"
    columns = "id xu yu zu vx vy vz fx fy fz"
    laws += scenes.dump(columns, 10) + scenes.thermo(["over=f_confine[2]"], 10)
    whole_run = lmp(
        processors + scene.head() + scene.cortex() + scene.contact() + laws
        + "restart 30 r.*\nrun 60\n", np=4)  # fmt: skip
    rest = lmp(
        processors + f"read_restart r.30\npair_coeff * * {scene.map}\nneighbor 0.6 multi\n" + laws
        + "restart 30 r.*\nrun 30\n", np=4, files={"r.30": whole_run.path / "r.30"})  # fmt: skip
    expected, found = whole_run.dump()[3:], rest.dump()
    assert [frame.step for frame in found] == [30, 40, 50, 60]
    for a, b in zip(expected, found, strict=True):
        for name in columns.split()[1:]:
            if name[0] == "f" and a.step == 30:
                continue  # motility acts once a step, not in setup
            assert (a[name] == b[name]).all(), (a.step, name)
    for a, b in zip(whole_run.thermo[4:], rest.thermo[1:], strict=True):
        assert a == b


@pytest.mark.parametrize("np_", [1, 2, 4])
def test_inverted_cell_ends_the_run(lmp, scenes, np_):
    """Only the processes that have atoms of the cell know of it; it is one error all the same."""
    scene = row_of_cells(scenes)
    deck = whole(scene) + f"run 0\ngroup one molecule {CELLS}\n"
    deck += "variable y atom -y\nset group one y v_y\nrun 0\n"
    result = lmp.run(deck, np=np_)
    assert result.returncode != 0
    assert f"cell {CELLS} has volume -" in result.error, result.tail()
