"""Count, time, and write pages and plot: `python -m bench`, which `make bench` runs."""

from __future__ import annotations

import argparse

from bench import operations, timings
from bench.inverse.run import write_inverse
from bench.motion import write_motion
from bench.plot import write_plot
from bench.report import PLOT, write_block, write_pages
from bench.results import read_json, write_json


def main() -> int:
    """Everything in one run."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer tools and rounds: some minutes")
    options = parser.parse_args()
    write_json("operations", operations.run(options.quick))
    write_json("timings", timings.run(options.quick))
    print(write_inverse(options.quick), end="")
    print(write_motion(options.quick), end="")
    write_pages()
    write_block()
    write_plot(read_json("timings"), PLOT)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
