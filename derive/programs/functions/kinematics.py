"""Generated functions of the table alone, each with its candidate formulations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.mechanics import forward_kinematics
from derive.mechanics.forward_kinematics import jacobian
from derive.mechanics.vectors import Frame
from derive.programs.cheapest_kinematics import cheapest_jacobian, cheapest_links, cheapest_pose
from derive.programs.tape.scalars import Q
from derive.programs.tape.value import Value
from derive.programs.trace import Candidate, Specification, Trace, flat, near

_FRAMES = "transforms of joint frames from the base outwards"
_NEAR = 1.05
"""In terms of the cheapest."""

_SEARCHED = "the shortest ways to the world frame, turned by sums of angles of parallel joints"


def kinematic_functions(trace: Trace) -> tuple[Specification, ...]:
    """Poses and Jacobians."""
    n = trace.n
    return (
        Specification("forward_kinematics", (Q,), (4, 4), near(trace.graph, _poses(trace), _NEAR)),
        Specification("link_transforms", (Q,), (n, 4, 4), near(trace.graph, _links(trace), _NEAR)),
        Specification("jacobian", (Q,), (6, n), near(trace.graph, _jacobians(trace), _NEAR)),
    )


def _poses(trace: Trace) -> Iterator[Candidate]:
    yield Candidate(_FRAMES, lambda: _entries(trace, [forward_kinematics.forward_kinematics(trace.chain)]))
    if (stations := trace.stations) is not None:
        yield Candidate(f"columns of the pose by {_SEARCHED}", lambda: _entries(trace, [cheapest_pose(stations)]))


def _links(trace: Trace) -> Iterator[Candidate]:
    yield Candidate(_FRAMES, lambda: _entries(trace, forward_kinematics.link_transforms(trace.chain)))
    if (stations := trace.stations) is not None:
        words = "frames turned by sums of angles of parallel joints"
        yield Candidate(words, lambda: _entries(trace, cheapest_links(stations)))


def _jacobians(trace: Trace) -> Iterator[Candidate]:
    yield Candidate("geometric, from axes and origins", lambda: flat(jacobian(trace.chain)))
    if (stations := trace.stations) is not None:
        yield Candidate(f"geometric, columns by {_SEARCHED}", lambda: flat(cheapest_jacobian(stations)))


def _entries(trace: Trace, frames: Sequence[Frame[Value]]) -> list[Value]:
    chain = trace.chain
    return [v for frame in frames for v in flat(frame.rows(chain.zero, chain.one))]
