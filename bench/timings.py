"""Times of all tools, one configuration and a batch of 100,000: `python -m bench.timings`.

Every time belongs to a result that was checked at configurations of the batch against the independent recursion.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from bench import our_times
from bench.environment import environment
from bench.floor import floor
from bench.peers import adam_casadi, casadi_by_hand, pinocchio_cpp, pinocchio_python, toolbox, urdf_to_casadi
from bench.peers.peer import Peer, Row, Timed
from bench.problems import brief
from bench.quantities import BY_SYMBOL, QUANTITIES, TOLERANCE, relative_error
from bench.results import write_json
from bench.robots import TIMED, Array, Case, load
from bench.stopwatch import FULL, QUICK, Effort, measure
from bench.terminal import say

BATCH = 100_000
PEERS = (
    pinocchio_python.PEER,
    pinocchio_cpp.PEER,
    casadi_by_hand.BASE,
    urdf_to_casadi.PEER,
    adam_casadi.PEER,
    toolbox.PEER,
)
SLOW = {urdf_to_casadi.PEER.name, adam_casadi.PEER.name, toolbox.PEER.name}
_CHECKED = 16


def run(quick: bool) -> dict[str, Any]:
    """The content of ``timings.json``."""
    peers = [our_times.PEER, *(peer for peer in PEERS if not (quick and peer.name in SLOW))]
    absent = {peer.name: list(peer.missing) for peer in peers if peer.missing}
    present = [peer for peer in peers if not peer.missing and peer.time is not None]
    robots = {name: _robot(load(name), present, QUICK if quick else FULL) for name in TIMED}
    return {
        "environment": environment(),
        "not installed": absent,
        "batch": BATCH,
        "rounds": (QUICK if quick else FULL).rounds,
        "floor": floor(),
        "robots": robots,
    }


def _robot(case: Case, peers: Iterable[Peer], effort: Effort) -> dict[str, Any]:
    motions = case.motions(BATCH)
    rows = [row for peer in peers for row in _rows(peer, case, motions)]
    tables: dict[str, Any] = {"title": case.robot.title, "joints": case.robot.n, "one": {}, "batch": {}}
    for table, batch in (("one", False), ("batch", True)):
        for quantity in QUANTITIES:
            chosen = [row for row in rows if row.symbol == quantity.symbol and row.batch is batch]
            for label, cell in _cells(case, chosen, motions, effort).items():
                tables[table].setdefault(label, {})[quantity.symbol] = cell
                say(f"{case.name}: {table}: {quantity.symbol}: {label}: {cell}")
    return tables


def _rows(peer: Peer, case: Case, motions: Sequence[Array]) -> list[Row]:
    assert peer.time is not None
    try:
        return list(peer.time(case, motions))
    except Exception as error:
        say(f"{case.name}: {peer.name}: {brief(error)}")
        return []


def _cells(case: Case, rows: Iterable[Row], motions: tuple[Array, ...], effort: Effort) -> dict[str, dict[str, Any]]:
    """One quantity, measured in turns; rows that fail or are wrong say so."""
    cells: dict[str, dict[str, Any]] = {}
    ready: dict[str, Timed] = {}
    for row in rows:
        try:
            timed = row.prepare()
            timed.run()
            error = _error(case, row.symbol, timed, motions)
        except Exception as problem:
            cells[row.label] = {"failed": brief(problem)}
            continue
        if error <= TOLERANCE:
            ready[row.label] = timed
            cells[row.label] = {"error": float(f"{error:.1e}")}
        else:
            cells[row.label] = {"failed": f"relative error {error:.1e}"}
    for label, times in measure(ready, effort).items():
        cells[label] = {**times, **cells[label]}
    return cells


def _error(case: Case, symbol: str, timed: Timed, motions: tuple[Array, ...]) -> float:
    """The worst error at configurations spread over a pass, the first and the last among them."""
    places = np.unique(np.linspace(0, timed.count - 1, _CHECKED).astype(int))
    taken = tuple(motion[places] for motion in motions)
    return relative_error(case, BY_SYMBOL[symbol], taken, timed.values()[places])


def main() -> int:
    """Measure and write ``results/timings.json``."""
    parser = argparse.ArgumentParser(prog="python -m bench.timings", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer tools and rounds")
    write_json("timings", run(parser.parse_args().quick))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
