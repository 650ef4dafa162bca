"""fix dcm/polarity, keyword sees: apical sides look at the marked faces only."""
import numpy as np
import pytest

from .test_polarity import Seen, deck_of


def test_sees_lumen(lmp, scenes):
    """A is the direction of the faces that were marked in the step before, in contact or not."""
    scene = scenes.doublet(level=2)
    extra = "compute m all dcm/face mark\n"
    osmosis = ("fix osmosis all dcm/osmosis pressure 0.0 marks flood slab x -1.5 1.5 "
               "starter 0 0 0 3 100 every 1\n")
    deck = deck_of(scene, scenes, "sees lumen apical 0.9 init variable v_one v_zero v_zero every 1",
                   before="variable one atom 0.6*(x<0)-0.6*(x>0)\nvariable zero atom 0.1\n",
                   motion=osmosis + scene.motion(), extra=extra)
    deck = deck.replace("c_f[3]", "c_f[3] c_m")
    frames = lmp(deck + "run 6\n").dump()
    seen = 0
    for before, now in zip(frames[1:-1], frames[2:], strict=True):
        for molecule in (1, 2):
            cell, old = Seen(now, molecule), Seen(before, molecule)
            face = (before["mol"] == molecule) & (before["c_k"] == before["c_k"].max())
            marked = before["c_m"][face] > 0
            d = before.x[face] - old.center
            total = (d / np.linalg.norm(d, axis=1)[:, None])[marked].sum(axis=0)
            if np.linalg.norm(total) > 0.5:
                assert cell.A == pytest.approx(total / np.linalg.norm(total), abs=1e-8)
                assert cell.A[0] * (1 if molecule == 1 else -1) > 0.9    # toward the other cell
                seen += 1
    assert seen > 4


@pytest.mark.parametrize("np_", [1, 2])
def test_sees_outside(lmp, scenes, np_):
    """A is opposite to the mean direction of the free faces of the step before: each cell of a
    doublet turns its apical side to the other one, wherever it looked first."""
    scene = scenes.doublet(level=2)
    deck = deck_of(scene, scenes, "sees outside init toward 0 30 0 every 1")
    frames = lmp(deck + "run 4\n", np=np_).dump()
    for molecule in (1, 2):
        first = Seen(frames[0], molecule)
        assert first.A[1] > 0.8    # as it began: contacts are not known yet
        for before, now in zip(frames[:-1], frames[1:], strict=True):
            direction, length = Seen(before, molecule).free_direction()
            assert length > 10.0
            cell = Seen(now, molecule).check()
            assert cell.A == pytest.approx(-direction, abs=1e-8)
            assert cell.A[0] * (1 if molecule == 1 else -1) > 0.9


def test_sees_lumen_without_marks(lmp, scenes):
    """Nothing marks faces: a warning, and A stays as it began."""
    scene = scenes.doublet(level=1)
    run = lmp(deck_of(scene, scenes, "sees lumen init random every 1") + "run 5\n")
    assert "sees lumen, and nothing marks the faces at a lumen" in run.out
    first, *_, last = run.dump()
    for molecule in (1, 2):
        assert np.array_equal(Seen(first, molecule).A, Seen(last, molecule).A)
