"""Generated functions of the links' inertia, each with its candidate formulations."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from derive.algebra.tape_domain import QD, QDD, TAU, Q
from derive.algebra.tape_value import Value
from derive.mechanics.closed_form import ClosedForm
from derive.mechanics.composite_inertia import inertia_matrix
from derive.mechanics.christoffel_recursion import christoffel_matrix
from derive.mechanics.form_search import ALL_CHOICES, Forms
from derive.mechanics.forward_dynamics import forward_dynamics
from derive.mechanics.gravity import gravity_vector
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.specification import Candidate, Specification
from derive.mechanics.trace import Trace, flat

BASE = "in base parameters"


def dynamic_functions(trace: Trace) -> tuple[Specification, ...]:
    """Inertia, Coriolis and gravity, and the torques that they make."""
    n = trace.n
    return (
        Specification("inertia_matrix", (Q,), (n, n), _inertia_candidates(trace)),
        Specification("coriolis_matrix", (Q, QD), (n, n), _coriolis_candidates(trace)),
        Specification("gravity_vector", (Q,), (n,), _gravity_candidates(trace)),
        Specification("inverse_dynamics", (Q, QD, QDD), (n,), _torque_candidates(trace)),
    )


def accelerations(trace: Trace) -> Specification:
    """Forward dynamics."""
    words = "inertia matrix and Newton-Euler, factorised without roots"
    return Specification(
        "forward_dynamics", (Q, QD, TAU), (trace.n,), (Candidate(words, lambda: _accelerations(trace)),)
    )


def no_accelerations(trace: Trace) -> Specification:
    """Forward dynamics of an arm whose inertia matrix is singular everywhere."""
    words = "the inertia matrix is singular everywhere"
    return Specification(
        "forward_dynamics", (Q, QD, TAU), (trace.n,), (Candidate(words, lambda: _divided_by_zero(trace)),)
    )


def _inertia_candidates(trace: Trace) -> tuple[Candidate, ...]:
    words = f"composite bodies {BASE}"
    return (Candidate(words, lambda: flat(_inertia(trace))), *_closed(trace, ClosedForm.inertia))


def _coriolis_candidates(trace: Trace) -> tuple[Candidate, ...]:
    def values(forms: Forms) -> list[Value]:
        return flat(christoffel_matrix(trace.arranged(forms), trace.arguments(QD), trace.half))

    words = f"moving composite bodies {BASE}"
    searched = Candidate(words, lambda: values(trace.cheapest_forms("coriolis", values)))
    return (searched, *_closed(trace, ClosedForm.coriolis))


def _gravity_candidates(trace: Trace) -> tuple[Candidate, ...]:
    def values(forms: Forms) -> list[Value]:
        return gravity_vector(trace.arranged(forms))

    words = f"composite first moments {BASE}"
    searched = Candidate(words, lambda: values(trace.cheapest_forms("gravity", values)))
    return (searched, *_closed(trace, ClosedForm.gravity))


def _torque_candidates(trace: Trace) -> tuple[Candidate, ...]:
    recursion = Candidate(f"Newton-Euler {BASE}", lambda: _torques(trace, "torques", trace.arguments(QDD)))
    return (recursion, *_closed(trace, ClosedForm.torques, trace.with_friction))


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


def _inertia(trace: Trace) -> list[list[Value]]:
    def matrix(forms: Forms) -> list[list[Value]]:
        return inertia_matrix(trace.arranged(forms))

    return matrix(trace.cheapest_forms("inertia", lambda forms: flat(matrix(forms))))


def _torques(trace: Trace, name: str, gains: Sequence[Value]) -> list[Value]:
    rates = trace.arguments(QD)

    def values(forms: Forms) -> list[Value]:
        return trace.with_friction(inverse_dynamics(trace.arranged(forms, axial=True), rates, gains, forms))

    return values(trace.cheapest_forms(name, values, ALL_CHOICES))


def _accelerations(trace: Trace) -> list[Value]:
    return forward_dynamics(_inertia(trace), _torques(trace, "bias", trace.zeros()), trace.arguments(TAU))


def _divided_by_zero(trace: Trace) -> list[Value]:
    return [torque / trace.chain.zero for torque in trace.arguments(TAU)]
