"""Generated functions of the table alone, each with its candidate formulations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from derive.algebra.tape_domain import Q
from derive.algebra.tape_price import price
from derive.algebra.tape_value import Value
from derive.mechanics import forward_kinematics as kinematics
from derive.mechanics.cheapest_kinematics import cheapest_jacobian, cheapest_pose
from derive.mechanics.cheapest_links import cheapest_links
from derive.mechanics.jacobian import jacobian
from derive.mechanics.specification import Candidate, Specification
from derive.mechanics.trace import Trace, flat
from derive.mechanics.vectors import Frame

_FRAMES = "transforms of joint frames from the base outwards"
_NEAR = 1.05
"""In terms of the cheapest."""

_SEARCHED = "the shortest ways to the world frame, turned by sums of angles of parallel joints"


def kinematic_functions(trace: Trace) -> tuple[Specification, ...]:
    """Poses and Jacobians."""
    n = trace.n
    return (
        Specification("forward_kinematics", (Q,), (4, 4), _near(trace, _poses(trace))),
        Specification("link_transforms", (Q,), (n, 4, 4), _near(trace, _links(trace))),
        Specification("jacobian", (Q,), (6, n), _near(trace, _jacobians(trace))),
    )


def _near(trace: Trace, candidates: Iterable[Candidate]) -> tuple[Candidate, ...]:
    """Those that are worth improving: no dearer as traced than the cheapest, nearly."""
    known = [Candidate(candidate.formulation, _held(candidate.values())) for candidate in candidates]
    prices = [price(trace.graph, [v.ref for v in candidate.values()])[0] for candidate in known]
    return tuple(c for c, found in zip(known, prices, strict=True) if found <= _NEAR * min(prices))


def _held(values: Sequence[Value]) -> Callable[[], Sequence[Value]]:
    return lambda: values


def _poses(trace: Trace) -> Iterator[Candidate]:
    yield Candidate(_FRAMES, lambda: _entries(trace, [kinematics.forward_kinematics(trace.chain)]))
    if (stations := trace.stations) is not None:
        yield Candidate(f"columns of the pose by {_SEARCHED}", lambda: _entries(trace, [cheapest_pose(stations)]))


def _links(trace: Trace) -> Iterator[Candidate]:
    yield Candidate(_FRAMES, lambda: _entries(trace, kinematics.link_transforms(trace.chain)))
    if (stations := trace.stations) is not None:
        words = "frames turned by sums of angles of parallel joints"
        yield Candidate(words, lambda: _entries(trace, cheapest_links(stations)))


def _jacobians(trace: Trace) -> Iterator[Candidate]:
    yield Candidate("geometric, from axes and origins", lambda: flat(jacobian(trace.chain)))
    if (stations := trace.stations) is not None:
        yield Candidate(f"geometric, columns by {_SEARCHED}", lambda: flat(cheapest_jacobian(stations)))


def _entries(trace: Trace, frames: Sequence[Frame[Value]]) -> list[Value]:
    chain = trace.chain
    return [v for frame in frames for v in flat(kinematics.rows(frame, chain.zero, chain.one))]
