"""CasADi by hand: textbook recursions through SX and `casadi.cse`, with and without base parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from bench.byhand.casadi_arm import functions
from bench.peers import casadi_times
from bench.peers.casadi_programs import Programs, counted
from bench.peers.peer import Peer, Row
from bench.robots import Array, Case


def _programs(case: Case, base: bool) -> Programs:
    for symbol, entry in functions(case, base):
        yield symbol, lambda entry=entry: (entry.function, entry.parameters)  # type: ignore[misc]


def _peer(name: str, base: bool) -> Peer:
    def count(case: Case) -> Iterator[tuple[str, Any]]:
        return counted(case, _programs(case, base))

    def time(case: Case, motions: Sequence[Array]) -> Iterator[Row]:
        return casadi_times.rows(name, case, _programs(case, base), motions, vectorised=True)

    return Peer(name, ("casadi",), count, time)


PLAIN = _peer("CasADi by hand", base=False)
BASE = _peer("CasADi by hand, base parameters", base=True)
