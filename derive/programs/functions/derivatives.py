"""Generated functions made of rates and derivatives, each with its candidate formulations.

Exact derivatives of graph values: every node once, in the graph that holds the values.

A derivative is made of nodes of the same graph, so it shares all that the values have computed already, and what does
not depend on the input costs nothing. The graph is differentiated as it stands; a graph that has been improved first
has fewer nodes to differentiate (`improved`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial

from derive.mechanics.forward_kinematics import TILTED, analytic_jacobian, forward_kinematics, jacobian, jacobian_rate
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.torque_derivatives import torque_position_derivative, torque_velocity_derivative
from derive.mechanics.vectors import Frame, column
from derive.programs.cheapest_kinematics import cheapest_jacobian, cheapest_pose
from derive.programs.frame_choice import ALL_CHOICES, Forms
from derive.programs.functions.dynamics import BASE, coriolis_forms, searched, torque_forms, torques
from derive.programs.optimise.improve import improve
from derive.programs.tape.build import copy_leaf, reachable
from derive.programs.tape.graph import ZERO, Graph, Ref
from derive.programs.tape.scalars import QD, QDD, Q
from derive.programs.tape.tape import LEAVES, Op
from derive.programs.tape.value import Value
from derive.programs.trace import Candidate, Specification, Trace, flat


def derivative(values: Sequence[Value], rates: Mapping[Value, Value]) -> list[Value]:
    """d value / dt for given rates of inputs.

    Args:
        values: Of one graph.
        rates: For inputs of that graph, their rates of change; other inputs do not change.
    """
    if not values:
        return []
    graph = values[0].graph
    refs = [value.ref for value in values]
    tangents = {source.ref >> 1: rate.ref ^ (source.ref & 1) for source, rate in rates.items() if rate.ref != ZERO}
    for i in reachable(graph, refs):
        if i not in tangents and graph.op[i] not in LEAVES:
            tangent = _tangent(graph, i, tangents)
            if tangent != ZERO:
                tangents[i] = tangent
    found = (tangents.get(ref >> 1, ZERO) for ref in refs)
    return [Value(graph, graph.negate(t) if ref & 1 else t) for ref, t in zip(refs, found, strict=True)]


def gradient_columns(values: Sequence[Value], inputs: Sequence[Value]) -> list[list[Value]]:
    """The matrix d value_i / d input_j, row by row."""
    if not values:
        return []
    one = Value(values[0].graph, values[0].graph.number(Fraction(1)))
    columns = [derivative(values, {source: one}) for source in inputs]
    return [list(row) for row in zip(*columns, strict=True)]


def improved(values: Sequence[Value]) -> list[Value]:
    """The same values from fewer operations, in the same graph."""
    if not values:
        return []
    graph = values[0].graph
    fresh, refs = improve(graph, [value.ref for value in values])
    moved: dict[int, Ref] = {}
    for i in reachable(fresh, refs):
        if fresh.op[i] in LEAVES:
            moved[i] = copy_leaf(fresh, i, graph)
        else:
            moved[i] = graph.apply(fresh.op[i], *(moved[k] for k in fresh.operands[i]))
    return [Value(graph, graph.negate(moved[r >> 1]) if r & 1 else moved[r >> 1]) for r in refs]


def _tangent(graph: Graph, i: int, tangents: Mapping[int, Ref]) -> Ref:
    """The rate of change of a node from those of its operands."""
    operands = graph.operands[i]
    rates = [tangents.get(k, ZERO) for k in operands]
    if not any(rates):
        return ZERO
    a, da = 2 * operands[0], rates[0]
    match graph.op[i]:
        case Op.ADD:
            return graph.add(da, rates[1])
        case Op.SUBTRACT:
            return graph.subtract(da, rates[1])
        case Op.MULTIPLY:
            b, db = 2 * operands[1], rates[1]
            return graph.add(graph.multiply(da, b), graph.multiply(a, db))
        case Op.DIVIDE:
            b, db = 2 * operands[1], rates[1]
            return graph.divide(graph.subtract(da, graph.multiply(2 * i, db)), b)
        case Op.NEGATE:
            return graph.negate(da)
        case Op.SINE:
            return graph.multiply(graph.cosine(a), da)
        case Op.COSINE:
            return graph.negate(graph.multiply(graph.sine(a), da))
        case Op.ROOT:
            return graph.divide(da, graph.add(2 * i, 2 * i))
        case _:
            return ZERO


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
