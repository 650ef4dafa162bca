"""Fixtures for the tests of the Python package."""
import pytest

from support.data_files import Scene


@pytest.fixture
def scene():
    """A fresh Scene in a box of 100 um, periodic unless a frame says otherwise."""
    return Scene()


@pytest.fixture
def make_scene():
    """The Scene class, for other boxes."""
    return Scene
