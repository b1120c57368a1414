"""Times of inverse kinematics: `python -m bench.inverse`."""

from __future__ import annotations

import argparse

from bench.inverse.report import inverse_markdown
from bench.inverse.run import run, write_inverse


def main() -> int:
    """Measure, write the results and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m bench.inverse", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer rounds")
    parser.add_argument("--no-write", action="store_true", help="print the tables and write nothing")
    options = parser.parse_args()
    print(inverse_markdown(run(options.quick)) if options.no_write else write_inverse(options.quick), end="")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
