"""Examples as modules, as `python examples/NAME.py` finds them and what lies beside them."""

import importlib
import sys
from types import ModuleType
from unittest import mock

from tests.places import ROOT

EXAMPLES = ROOT / "examples"


def loaded(name: str) -> ModuleType:
    with mock.patch.object(sys, "path", [str(EXAMPLES), *sys.path]):
        return importlib.import_module(name)
