"""The deck examples/lumen, shortened: its dump gives the lumens that compute dcm/lumen does."""
import csv
from pathlib import Path

import pytest

import lammps_dcm
from lammps_dcm.__main__ import main

ROOT = Path(__file__).resolve().parents[2]
# names of the analysis -> elements of compute dcm/lumen
ELEMENTS = {"lumens": 1, "volume": 2, "wall": 3, "section": 4, "closure": 5, "cells": 6,
            "circularity": 7, "covered": 8}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    from support.runner import Runner

    deck = (ROOT / "examples/lumen/in.lumen").read_text()
    style = "c_lumen[1] c_lumen[4] c_lumen[5] c_lumen[6]"
    assert style in deck
    deck = deck.replace(style, "c_lumen[*]").replace(
        "thermo          300", "thermo 300\nthermo_modify format float %.15g").replace(
        "%.10g", "%.16g").replace("run             ${hold}",
                                  "thermo_modify norm no format float %.15g\nrun ${hold}")
    return Runner(tmp_path_factory.mktemp("lumen"))(
        deck, files={"cells.txt": ROOT / "examples/lumen/cells.txt"},
        vars={"shut": 240, "start": 240, "hold": 360, "more": 120, "P": 0.6, "grow": 0.7})


@pytest.mark.parametrize("own", [False, True])
def test_analysis_agrees_with_the_compute(run, own, tmp_path):
    out = tmp_path / "lumen.csv"
    if own:    # as `compute dcm/lumen` numbers them, here found by the analysis itself
        assert main(["lumen", str(run.path / "lumen.dump"), "--plane", "z", "--slab", "-3", "3",
                     "-o", str(out)]) == 0
        rows = {int(r["step"]): r for r in csv.DictReader(out.open())}
    else:
        u = lammps_dcm.load(dump=run.path / "lumen.dump")
        results = lammps_dcm.Lumens(u, plane=(2, 0.0), slab=(-3.0, 3.0)).run().results
        rows = {step: {n: results["number" if n == "lumens" else n][k] for n in ELEMENTS}
                for k, step in enumerate(results.steps)}
    thermo = {int(row["Step"]): row for row in run.thermo if "c_lumen[1]" in row}
    common = sorted(set(rows) & set(thermo))
    assert len(common) >= 3 and thermo[common[-1]]["c_lumen[4]"] > 1.0
    for step in common:
        for name, n in ELEMENTS.items():
            # the sum of faces in another order; marks at the start may be in pieces
            assert float(rows[step][name]) == pytest.approx(
                thermo[step][f"c_lumen[{n}]"], rel=1e-6, abs=1e-6), (step, name)
