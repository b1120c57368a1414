"""``python -m derive``: the same command as ``derive``."""

import sys

from derive.cli.main import main

sys.exit(main())
