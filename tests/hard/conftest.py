"""The runner and scenes of tests/styles, for the hard cases."""

import importlib.util
from pathlib import Path

_path = Path(__file__).resolve().parents[1] / "styles" / "conftest.py"
_spec = importlib.util.spec_from_file_location("dcm_styles_conftest", _path)
_module = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(_module)

lmp = _module.lmp
scenes = _module.scenes
