"""Generated functions made of rates and derivatives, each with its candidate formulations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from derive.algebra.tape_derivative import derivative, gradient_columns, improved
from derive.algebra.tape_domain import QD, QDD, Q
from derive.algebra.tape_value import Value
from derive.mechanics.angle_rates import TILTED, analytic_jacobian
from derive.mechanics.cheapest_kinematics import cheapest_jacobian, cheapest_pose
from derive.mechanics.dynamic_functions import BASE, coriolis_forms, searched, torque_forms, torques
from derive.mechanics.form_search import ALL_CHOICES, Forms
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.mechanics.jacobian import jacobian
from derive.mechanics.jacobian_rate import jacobian_rate
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.specification import Candidate, Specification
from derive.mechanics.torque_derivatives import torque_position_derivative, torque_velocity_derivative
from derive.mechanics.trace import Trace, flat
from derive.mechanics.vectors import Frame, column

Matrix = list[list[Value]]

SHORT = 7
"""Most joints for which torques are also differentiated operation by operation: the work grows with n^3 or so."""


def jacobian_rates(trace: Trace) -> Specification:
    """dJ/dt."""
    candidates = [Candidate("velocities of axes and origins", lambda: _rates_of_axes(trace))]
    for words, values in _jacobians(trace):
        differentiated = f"{words}, differentiated in time"
        candidates.append(Candidate(differentiated, lambda values=values: _in_time(trace, values())))  # type: ignore[misc]
    return Specification("jacobian_dot", (Q, QD), (6, trace.n), tuple(candidates))


def analytic_jacobians(trace: Trace) -> tuple[Specification, ...]:
    """J_A for both kinds of angles."""
    return tuple(
        Specification(f"analytic_jacobian_{kind}", (Q,), (6, trace.n), tuple(_analytic_candidates(trace, kind)))
        for kind in TILTED
    )


def velocity_torques(trace: Trace) -> Specification:
    """C qd."""
    zero = trace.chain.zero
    rates, gains = trace.arguments(QD), trace.zeros()

    def values(forms: Forms) -> list[Value]:
        weightless = replace(trace.arranged(forms, axial=True), gravity=(zero, zero, zero))
        return inverse_dynamics(weightless, rates, gains, forms)

    words = f"Newton-Euler without gravity and accelerations {BASE}"
    candidates = searched(trace, "velocity torques", words, values, ALL_CHOICES, torque_forms(trace)[:1])
    return Specification("coriolis_vector", (Q, QD), (trace.n,), tuple(candidates))


def torque_derivatives(trace: Trace) -> tuple[Specification, ...]:
    """Derivatives of tau."""
    n = trace.n
    return (
        Specification("inverse_dynamics_dq", (Q, QD, QDD), (n, n), tuple(_position_candidates(trace))),
        Specification("inverse_dynamics_dqd", (Q, QD), (n, n), tuple(_velocity_candidates(trace))),
    )


def _position_candidates(trace: Trace) -> Iterator[Candidate]:
    rates, gains = trace.arguments(QD), trace.arguments(QDD)

    def values(forms: Forms) -> list[Value]:
        return flat(torque_position_derivative(trace.arranged(forms), rates, gains, trace.half, forms))

    starts = (*torque_forms(trace), *coriolis_forms(trace))
    yield from searched(trace, "torque slopes", f"moving composite bodies {BASE}", values, (), starts)
    if trace.n <= SHORT:
        found, forms = torques(trace, gains), torque_forms(trace)[0]
        words = f"Newton-Euler {BASE}, its operations differentiated"
        yield Candidate(words, lambda: flat(gradient_columns(found(forms), trace.arguments(Q))))


def _velocity_candidates(trace: Trace) -> Iterator[Candidate]:
    def values(forms: Forms) -> list[Value]:
        return flat(torque_velocity_derivative(trace.arranged(forms), trace.arguments(QD), trace.half))

    words = f"composite bodies of twice the mass and their inner motion {BASE}"
    for forms in coriolis_forms(trace):
        yield Candidate(words, partial(values, forms))


def _jacobians(trace: Trace) -> Iterator[tuple[str, Callable[[], Matrix]]]:
    """The geometric Jacobian, in the ways in which it may be cheapest."""
    yield "geometric Jacobian", lambda: jacobian(trace.chain)
    if (stations := trace.stations) is not None:
        yield "geometric Jacobian by the shortest ways to the world frame", lambda: cheapest_jacobian(stations)


def _in_time(trace: Trace, matrix: Matrix) -> list[Value]:
    rates = dict(zip(trace.arguments(Q), trace.arguments(QD), strict=True))
    return derivative(improved(flat(matrix)), rates)


def _rates_of_axes(trace: Trace) -> list[Value]:
    return flat(jacobian_rate(trace.chain, trace.arguments(QD)))


def _analytic_candidates(trace: Trace, kind: str) -> Iterator[Candidate]:
    k, words = TILTED[kind], "the angles' rates"
    for (name, matrix), pose in zip(_jacobians(trace), _poses(trace), strict=True):

        def values(matrix: Callable[[], Matrix] = matrix, pose: Callable[[], Frame[Value]] = pose) -> list[Value]:
            return flat(analytic_jacobian(kind, column(pose().rotation, k), matrix()))

        yield Candidate(f"{name}, and {words}", values)


def _poses(trace: Trace) -> Iterator[Callable[[], Frame[Value]]]:
    yield lambda: forward_kinematics(trace.chain)
    if (stations := trace.stations) is not None:
        yield lambda: cheapest_pose(stations)
