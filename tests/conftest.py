"""Fixtures of all tests: the real lmp, and the scenes it runs."""

import pytest

from support import scenes as shared_scenes
from support.runner import Runner


@pytest.fixture
def lmp(tmp_path):
    """Runner of decks; each run gets its own folder below the test's tmp_path."""
    return Runner(tmp_path)


@pytest.fixture(scope="module")
def lmp_module(tmp_path_factory):
    """The same for fixtures shared by the tests of a file."""
    return Runner(tmp_path_factory.mktemp("lmp"))


@pytest.fixture(scope="session")
def scenes():
    """The module support.scenes."""
    return shared_scenes
