"""What holds for all tests: two workers share two cores, and a busy machine is no fault."""

from __future__ import annotations

import os

from hypothesis import settings

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # two workers on two cores: threads would wait for each other
settings.register_profile("derive", deadline=None)
settings.load_profile("derive")
