"""Three points of the map of accuracy (doc/accuracy.rst), small: ratios of errors stay where theory
has them. No expected value is an earlier output."""
import os

import pytest

from accuracy import scenes
from accuracy.errors import error, order_of
from accuracy.points import Point, Runner, digest
from accuracy.scenes import SCENES, BileDuct


class Short(BileDuct):
    """The first 300 s of the bile duct, while all of it moves."""

    name, hours, times = "short", 300.0 / 3600.0, (300.0,)
    quantities = tuple(q for q in BileDuct.quantities if q.of.endswith(" 300 s"))


@pytest.fixture(scope="module")
def value(tmp_path_factory):
    """Function: scene, settings -> values of the run."""
    scenes.SCENES["short"] = Short()
    digest.cache_clear()
    runner = Runner(tmp_path_factory.mktemp("map"), os.environ["DCM_LMP"].split())

    def run(scene, **settings):
        point = Point.of(scene, **settings)
        if runner.result(point) is None:
            runner.run(point)
        result = runner.result(point)
        assert not result.note, f"{point.name}: {result.note}"
        return result.values

    yield run
    del scenes.SCENES["short"]


def relative(scene, of, values, reference):
    """Relative error of the first quantity that is read from `of`."""
    q = next(q for q in SCENES[scene].quantities if q.of == of)
    return error(q, values, reference)[1]


@pytest.mark.parametrize("scene, of, more", [
    ("compress", "pressure after 40 s", {}),
    ("compress", "area after 40 s", {}),
    ("doublet", "radius soon", dict(pull="no")),
])
def test_half_the_step_leaves_half_the_error(value, scene, of, more):
    """Implicit Euler: errors C dt (1 + q), q of second order between -1/3 and 2/3 at the longer
    step, fall by 2 (1 + q)/(1 + q/2), which is between 1.6 and 2.5."""
    exact = value(scene, step="explicit 0.125", tolerance="1e-8", **more)
    off = [relative(scene, of, value(scene, step=f"implicit {dt}", **more), exact)
           for dt in (4, 2, 1)]
    assert 1.6 < off[0] / off[1] < 2.5
    assert 1.6 < off[1] / off[2] < 2.5
    assert order_of(4.0, off[0], 1.0, off[2]) == pytest.approx(1.0, abs=0.25)


@pytest.mark.parametrize("of", ["way 300 s", "pressure 300 s"])
def test_a_smaller_tol_of_dt_auto_is_more_exact(value, of):
    """Steps leave X sqrt(h/B) and about h^2: h as X^(2/3), and so the error. A tol that is four
    times smaller has to bring at least half of that order."""
    exact = value("short", step="explicit 0.5", tolerance="1e-8")
    coarse, fine = (relative("short", of, value("short", step=f"auto {tol}"), exact)
                    for tol in (0.01, 0.0025))
    assert coarse / fine > 4.0**(0.5 * 2.0 / 3.0)


def test_adhesion_at_rest_does_not_depend_on_the_step(value):
    """The radius of two cells that adhere is that of the forces, whatever brought it about."""
    radius = {step: value("doublet", step=step, pull="no")["radius"][""][0]
              for step in ("explicit 0.125", "implicit 1", "implicit 4", "implicit 8")}
    assert 2.0 < min(radius.values())    # they adhere: two spheres at first touch have 0
    assert max(radius.values()) < 1.01 * min(radius.values())
