"""Generated functions of the links' inertia, each with its candidate formulations."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from derive.mechanics.coriolis import coriolis_matrix
from derive.mechanics.forward_dynamics import articulated_accelerations, forward_dynamics
from derive.mechanics.inertia_matrix import gravity_vector, inertia_matrix
from derive.mechanics.newton_euler import inverse_dynamics
from derive.programs.closed_form import ClosedForm
from derive.programs.frame_choice import ALL_CHOICES, CHAIN_CHOICES, Forms
from derive.programs.tape.scalars import QD, QDD, TAU, Q
from derive.programs.tape.value import Value
from derive.programs.trace import Candidate, Specification, Trace, flat, near

BASE = "in base parameters"

_NEAR = 1.3
"""In terms of the cheapest; a closed form may improve by so much more than a recursion."""

ARTICULATED = 7
"""Fewest joints for which articulated bodies may be cheaper than the factorised inertia matrix."""

FACTORISED = 10
"""Most joints for which the inertia matrix may be cheaper, whose factorisation grows with the cube."""


def dynamic_functions(trace: Trace) -> tuple[Specification, ...]:
    """Inertia, Coriolis and gravity, and the torques that they make."""
    n, graph = trace.n, trace.graph
    return (
        Specification("inertia_matrix", (Q,), (n, n), near(graph, _inertia_candidates(trace), _NEAR)),
        Specification("coriolis_matrix", (Q, QD), (n, n), near(graph, _coriolis_candidates(trace), _NEAR)),
        Specification("gravity_vector", (Q,), (n,), near(graph, _gravity_candidates(trace), _NEAR)),
        Specification("inverse_dynamics", (Q, QD, QDD), (n,), near(graph, _torque_candidates(trace), _NEAR)),
    )


def accelerations(trace: Trace) -> Specification:
    """Forward dynamics."""
    return Specification("forward_dynamics", (Q, QD, TAU), (trace.n,), tuple(_acceleration_candidates(trace)))


def no_accelerations(trace: Trace) -> Specification:
    """Forward dynamics of an arm whose inertia matrix is singular everywhere."""
    words = "the inertia matrix is singular everywhere"
    return Specification(
        "forward_dynamics", (Q, QD, TAU), (trace.n,), (Candidate(words, lambda: _divided_by_zero(trace)),)
    )


def _inertia_candidates(trace: Trace) -> Iterator[Candidate]:
    yield from searched(trace, "inertia", f"composite bodies {BASE}", _inertia(trace))
    yield from _closed(trace, ClosedForm.inertia)


def _coriolis_candidates(trace: Trace) -> Iterator[Candidate]:
    yield from searched(trace, "coriolis", f"composite bodies and their inner motion {BASE}", _coriolis(trace))
    yield from _closed(trace, ClosedForm.coriolis)


def coriolis_forms(trace: Trace) -> tuple[Forms, ...]:
    """The cheapest forms of the joints for C."""
    return trace.cheapest_forms("coriolis", _coriolis(trace))


def _coriolis(trace: Trace) -> Callable[[Forms], list[Value]]:
    def values(forms: Forms) -> list[Value]:
        return flat(coriolis_matrix(trace.arranged(forms), trace.arguments(QD), trace.half))

    return values


def torque_forms(trace: Trace) -> tuple[Forms, ...]:
    """The cheapest forms of the joints for tau; what is like Newton-Euler takes them too."""
    return trace.cheapest_forms("torques", torques(trace, trace.arguments(QDD)), ALL_CHOICES)


def _gravity_candidates(trace: Trace) -> Iterator[Candidate]:
    def values(forms: Forms) -> list[Value]:
        return gravity_vector(trace.arranged(forms))

    yield from searched(trace, "gravity", f"composite first moments {BASE}", values)
    yield from _closed(trace, ClosedForm.gravity)


def _torque_candidates(trace: Trace) -> Iterator[Candidate]:
    values = torques(trace, trace.arguments(QDD))
    yield from searched(trace, "torques", f"Newton-Euler {BASE}", values, ALL_CHOICES)
    yield from _closed(trace, ClosedForm.torques, trace.with_friction)


def searched(
    trace: Trace,
    name: str,
    words: str,
    values: Callable[[Forms], list[Value]],
    choices: Sequence[str] = CHAIN_CHOICES,
    starts: Sequence[Forms] = (),
) -> Iterator[Candidate]:
    """A recursion with each of the cheapest forms of the joints."""
    for forms in trace.cheapest_forms(name, values, choices, starts):
        yield Candidate(words, partial(values, forms))


def _closed(
    trace: Trace,
    quantity: Callable[[ClosedForm], list[Value] | None],
    finish: Callable[[list[Value]], list[Value]] = lambda values: values,
) -> Iterator[Candidate]:
    """Closed forms of a quantity where they are short."""
    for form in trace.closed_forms:
        if (values := quantity(form)) is not None:
            outputs = finish(values)
            yield Candidate(form.words, lambda outputs=outputs: outputs)  # type: ignore[misc]


def _inertia(trace: Trace) -> Callable[[Forms], list[Value]]:
    return lambda forms: flat(inertia_matrix(trace.arranged(forms)))


def torques(trace: Trace, gains: Sequence[Value]) -> Callable[[Forms], list[Value]]:
    """Newton-Euler with friction, with any forms of the joints."""
    rates = trace.arguments(QD)

    def values(forms: Forms) -> list[Value]:
        return trace.with_friction(inverse_dynamics(trace.arranged(forms, axial=True), rates, gains, forms))

    return values


def _accelerations(trace: Trace) -> list[Value]:
    inertia, moving, bias = _inertia(trace), torques(trace, trace.arguments(QDD)), torques(trace, trace.zeros())
    n, entries = trace.n, inertia(trace.cheapest_forms("inertia", inertia)[0])
    matrix = [entries[n * i : n * i + n] for i in range(n)]
    forms = trace.cheapest_forms("torques", moving, ALL_CHOICES)[0]
    return forward_dynamics(matrix, bias(forms), trace.arguments(TAU))


def _acceleration_candidates(trace: Trace) -> Iterator[Candidate]:
    if trace.n <= FACTORISED:
        words = "inertia matrix and Newton-Euler, factorised without roots"
        yield Candidate(words, lambda: _accelerations(trace))
    if trace.n >= ARTICULATED:
        yield from searched(trace, "articulated", f"articulated bodies {BASE}", _articulated(trace), ALL_CHOICES)


def _articulated(trace: Trace) -> Callable[[Forms], list[Value]]:
    friction = trace.with_friction(trace.zeros())
    push = [torque - loss for torque, loss in zip(trace.arguments(TAU), friction, strict=True)]

    def values(forms: Forms) -> list[Value]:
        return articulated_accelerations(trace.arranged(forms), trace.arguments(QD), push, forms)

    return values


def _divided_by_zero(trace: Trace) -> list[Value]:
    return [torque / trace.chain.zero for torque in trace.arguments(TAU)]
