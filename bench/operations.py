"""Operation counts of all tools on all robots: `python -m bench.operations`.

Every count belongs to a result that was checked at random configurations against the independent recursion.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from bench.environment import environment
from bench.ours import OURS
from bench.peers import adam_casadi, casadi_by_hand, skidy_kinematics, sympy_by_hand, urdf_to_casadi
from bench.peers.peer import Counted, Peer
from bench.problems import brief
from bench.quantities import BY_SYMBOL, TOLERANCE, arguments, relative_error
from bench.results import write_json
from bench.robots import COUNTED, Case, load
from bench.terminal import say

PEERS = (
    casadi_by_hand.BASE,
    casadi_by_hand.PLAIN,
    urdf_to_casadi.PEER,
    adam_casadi.PEER,
    sympy_by_hand.PEER,
    skidy_kinematics.PEER,
)
SLOW = {skidy_kinematics.PEER.name, urdf_to_casadi.PEER.name}
_CHECKED = 3


def measure(names: Iterable[str], peers: Iterable[Peer]) -> dict[str, Any]:
    """The content of ``operations.json``."""
    peers = tuple(peers)
    absent = {peer.name: list(peer.missing) for peer in peers if peer.missing}
    present = [OURS, *(peer for peer in peers if not peer.missing)]
    robots = {}
    for name in names:
        case = load(name)
        robots[name] = {"title": case.robot.title, "counts": {p.name: _row(p, case) for p in present}}
    return {"environment": environment(), "not installed": absent, "robots": robots}


def _row(peer: Peer, case: Case) -> dict[str, Any]:
    """One tool on one robot: counts by quantity, or what went wrong."""
    start, row = time.perf_counter(), {}
    assert peer.count is not None
    try:
        for symbol, program in peer.count(case):
            row[symbol] = _cell(case, symbol, program)
    except Exception as error:
        row["failed"] = {"failed": brief(error)}
    say(f"{case.name}: {peer.name}: {_summary(row)} ({time.perf_counter() - start:.1f} s)")
    return row


def _cell(case: Case, symbol: str, program: Callable[[], Counted]) -> dict[str, Any]:
    try:
        counted = program()
        error = _error(case, symbol, counted)
    except Exception as problem:
        return {"failed": brief(problem)}
    if not error <= TOLERANCE:
        return {"failed": f"relative error {error:.1e}"}
    return {**counted.counts.as_dict(), "error": float(f"{error:.1e}")}


def _error(case: Case, symbol: str, counted: Counted) -> float:
    quantity, motions = BY_SYMBOL[symbol], case.motions(_CHECKED)
    taken = arguments(quantity, motions)
    got = np.array([counted.evaluate(*(argument[k] for argument in taken)) for k in range(_CHECKED)])
    return relative_error(case, quantity, motions, got)


def _summary(row: dict[str, Any]) -> str:
    return ", ".join(f"{symbol} {cell.get('arithmetic', 'failed')}" for symbol, cell in row.items()) or "nothing"


def main() -> int:
    """Count and write ``results/operations.json``."""
    parser = argparse.ArgumentParser(prog="python -m bench.operations", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="leave out the tools that take long")
    options = parser.parse_args()
    write_json("operations", run(options.quick))
    return 0


def run(quick: bool) -> dict[str, Any]:
    """All robots; without the slow tools where ``quick``."""
    return measure(COUNTED, [peer for peer in PEERS if not (quick and peer.name in SLOW)])


if __name__ == "__main__":
    raise SystemExit(main())
