"""Every scene of the hard-case suite, in two ways of running each: ranks 1 to 4 and both
schemes are spread over the scenes. tools/hard runs all scenes in all ways."""

import pytest

from hard import families
from hard.suite import RANKS, SCENES, SCHEMES, Case, perform

# numbers of ranks of the two ways of a scene: more ranks than cores cost time
PAIRS = ((1, 2), (3, 1), (1, 4), (2, 1), (1, 3), (4, 1))


def ways(number, scene):
    """Two ways (ranks, scheme) for a scene."""
    pair = PAIRS[number % len(PAIRS)]
    schemes = (scene.quick,) if scene.quick else scene.schemes
    return [(ranks, schemes[k % len(schemes)]) for k, ranks in enumerate(pair)]


WAYS = [
    pytest.param(name, ranks, scheme, id=f"{name}-{ranks}-{scheme}")
    for number, (name, scene) in enumerate(families.in_order())
    for ranks, scheme in ways(number, scene)
]


@pytest.mark.parametrize(("name", "ranks", "scheme"), WAYS)
def test_scene(lmp, scenes, name, ranks, scheme):
    case = perform(SCENES[name], Case(lmp, scenes, ranks, scheme))
    print("\n".join(map(str, case.measured)))
    assert case.measured
    assert case.good, "\n".join([name, *case.faults(), *case.log])


def test_ways():
    """All ranks and both schemes are there, and every scene has a sentence and a criterion."""
    assert {p.values[1] for p in WAYS} == set(RANKS) and {p.values[2] for p in WAYS} == set(SCHEMES)
    for scene in SCENES.values():
        assert scene.sentence.endswith(".") and scene.criterion.endswith("."), scene.name
    assert len(SCENES) >= 40
