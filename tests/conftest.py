"""What holds for all tests: two workers share two cores."""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # two workers on two cores: threads would wait for each other
