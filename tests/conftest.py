"""What holds for all tests: two workers share two cores, and a busy machine is no fault; examples are the same for all.

With ``DERIVE_NEW_EXAMPLES=1`` in the environment every run draws others.
"""

from __future__ import annotations

import gc
import os
from importlib import import_module
from typing import Any

import pytest
from hypothesis import settings

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # two workers on two cores: threads would wait for each other
settings.register_profile("derive", deadline=None, derandomize="DERIVE_NEW_EXAMPLES" not in os.environ)
settings.load_profile("derive")


@pytest.fixture(scope="session")
def roboticstoolbox() -> Any:
    """The package, which ``make test-toolbox`` installs and then requires."""
    name = "roboticstoolbox"
    return import_module(name) if os.environ.get("DERIVE_REQUIRE_TOOLBOX") == "1" else pytest.importorskip(name)


def pytest_collection_finish() -> None:
    """Modules and tests live to the end: looking through them for cycles again and again took a seventh of the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(5_000, 20, 20)
