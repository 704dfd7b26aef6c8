"""Other people's packages, with a sentence instead of a traceback where one is missing."""

from __future__ import annotations

import importlib
from types import ModuleType


def need(name: str) -> ModuleType:
    """The module, or the end of the program."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        if error.name not in (None, name.partition(".")[0]):
            raise
        raise SystemExit(
            f"the package {name} is missing or broken ({error}): pip install -r validation/requirements.txt; bpy needs Python 3.11"
        ) from error
