"""``python -m derive``: the same command as ``derive``."""

from __future__ import annotations

import sys

from derive.cli.main import main

sys.exit(main())
