"""What holds for all tests: models are built with quick effort, unless a module asks for the full one."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest

from derive.programs.effort import VARIABLE, Effort

os.environ[VARIABLE] = Effort.QUICK
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # two workers on two cores: threads would wait for each other


@pytest.fixture(scope="module")
def full_effort() -> Iterator[None]:
    """Programs are searched as a user's are; for modules that are about them."""
    os.environ[VARIABLE] = Effort.FULL
    yield
    os.environ[VARIABLE] = Effort.QUICK
