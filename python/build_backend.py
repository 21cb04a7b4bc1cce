"""The build backend of the package: maturin's, told to put what the module links (the MuJoCo engine) into the wheel.

By itself maturin leaves it out of what `pip install .` builds, and the package would end with the folder that it was built in.
"""

import os

from maturin import *  # noqa: F403 - the hooks of a backend

_ARGS = "MATURIN_PEP517_ARGS"
_GIVEN = os.environ.get(_ARGS, "")
if "--compatibility" not in _GIVEN:
    os.environ[_ARGS] = f"{_GIVEN} --compatibility pypi".strip()
