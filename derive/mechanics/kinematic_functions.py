"""Generated functions of the table alone, each with its candidate formulations."""

from __future__ import annotations

from derive.algebra.tape_domain import Q
from derive.algebra.tape_value import Value
from derive.mechanics import forward_kinematics as kinematics
from derive.mechanics.jacobian import jacobian
from derive.mechanics.specification import Candidate, Specification
from derive.mechanics.trace import Trace, flat


def kinematic_functions(trace: Trace) -> tuple[Specification, ...]:
    """Poses and Jacobians."""
    poses, n = "transforms of joint frames from the base outwards", trace.n
    columns = "geometric, from axes and origins"
    return (
        Specification("forward_kinematics", (Q,), (4, 4), (Candidate(poses, lambda: _pose(trace)),)),
        Specification("link_transforms", (Q,), (n, 4, 4), (Candidate(poses, lambda: _links(trace)),)),
        Specification("jacobian", (Q,), (6, n), (Candidate(columns, lambda: flat(jacobian(trace.chain))),)),
    )


def _pose(trace: Trace) -> list[Value]:
    chain = trace.chain
    return flat(kinematics.rows(kinematics.forward_kinematics(chain), chain.zero, chain.one))


def _links(trace: Trace) -> list[Value]:
    chain = trace.chain
    frames = kinematics.link_transforms(chain)
    return [v for frame in frames for v in flat(kinematics.rows(frame, chain.zero, chain.one))]
