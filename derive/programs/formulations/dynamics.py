"""Formulations of what depends on the links' inertia: torques, accelerations, derivatives of torques, regressors.

Where a recursion leaves frames to choose, each of the cheapest choices is a formulation. What is like Newton-Euler or
like the recursion of C takes the choices that were found for that.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial

from derive.algebra.quotients import Quotient
from derive.mechanics.chain import build_chain
from derive.mechanics.energy import gravity_vector, inertia_matrix, kinetic_energy, potential_energy
from derive.mechanics.forward_dynamics import articulated_accelerations, carried, factorised, forward_dynamics
from derive.mechanics.forward_kinematics import jacobian
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.regressor import Regressor, with_unit_rotors
from derive.mechanics.torque_derivatives import coriolis_matrix, torque_position_derivative, torque_velocity_derivative
from derive.model.identification.base_parameters import base_formulas, base_set, base_values, standard_formulas
from derive.programs.formulations import kinematics
from derive.programs.formulations.choice import Formulation
from derive.programs.formulations.frame_choice import ALL_CHOICES, CHAIN_CHOICES, FrameChoices
from derive.programs.formulations.trace import Trace, flat
from derive.programs.optimise.search_policy import POLICY
from derive.programs.program import Column
from derive.programs.tape.derivative import gradient_columns
from derive.programs.tape.value import QD, QDD, TAU, Q, Value
from derive.robot.inertial_parameters import Parameter, standard_parameters
from derive.robot.options.inverse import POSE
from derive.robot.task_rows import PARTS, task_rows

Recursion = Callable[[FrameChoices], list[Value]]  # the outputs of a recursion with some frame choices
_BASE = "in base parameters"
_DEPENDENT = Fraction(1, 10**13)  # of a task's rows, squared; rounding leaves 1e-15, 1e-4 rad from a singularity 1e-12


def inertia_matrices(trace: Trace) -> Iterator[Formulation]:
    """Formulations of B."""
    yield from _searched(trace, "inertia", f"composite bodies {_BASE}", _inertia(trace))
    yield from _closed(trace, "inertia_matrix")


def coriolis_matrices(trace: Trace) -> Iterator[Formulation]:
    """Formulations of C."""
    if trace.passive.numbers:
        n, dof = trace.n, trace.robot.dof

        def _of_variables() -> list[Value]:
            # W^T (C W + B dW/dt): the joints' rates are W qd (Khalil and Dombre 2002, chapter 10).
            slopes = flat(trace.matrix)
            bent = trace.in_time(slopes)
            own = trace.by_variables(_coriolis(trace)(_coriolis_choices(trace)[0]), (n, n), 1)
            moved = [
                entry + sum((b * bent[dof * m + k] for m, b in enumerate(row)), trace.chain.zero)
                for i, row in enumerate(_cheapest_inertia(trace))
                for k, entry in enumerate(own[dof * i : dof * i + dof])
            ]
            return trace.by_variables(moved, (n, dof), 0)

        yield Formulation("composite bodies of the joints, then the variables", _of_variables, is_of_variables=True)
        return
    yield from _searched(trace, "coriolis", f"composite bodies and their inner motion {_BASE}", _coriolis(trace))
    yield from _closed(trace, "coriolis_matrix")


def gravity_vectors(trace: Trace) -> Iterator[Formulation]:
    """Formulations of g."""
    words = f"composite first moments {_BASE}"
    yield from _searched(trace, "gravity", words, lambda choices: gravity_vector(trace.arranged(choices)))
    yield from _closed(trace, "gravity_vector")


def kinetic_energies(trace: Trace) -> Iterator[Formulation]:
    """Formulations of the kinetic energy."""
    words, rates = f"velocities of the links {_BASE}", trace.arguments(QD)
    chain = partial(trace.arranged, axial=True)
    yield from _searched(trace, "kinetic", words, lambda choices: [kinetic_energy(chain(choices), rates, trace.half)])
    yield from _closed(trace, "kinetic_energy")


def potential_energies(trace: Trace) -> Iterator[Formulation]:
    """Formulations of the potential energy."""

    def _values(choices: FrameChoices, meeting: int = 0) -> list[Value]:
        return [potential_energy(trace.arranged(choices), meeting)]

    for chosen in trace.cheapest_choices("potential", _values):
        cheapest = min(range(trace.n + 1), key=lambda link: trace.choice.price([_values(chosen, link)[0].ref]).body)
        yield Formulation(f"gravity on composite first moments {_BASE}", partial(_values, chosen, cheapest))
    yield from _closed(trace, "potential_energy")


def torques(trace: Trace) -> Iterator[Formulation]:
    """Formulations of tau."""
    yield from _searched(trace, "torques", f"Newton-Euler {_BASE}", _newton_euler(trace, QDD), ALL_CHOICES)
    yield from _closed(trace, "inverse_dynamics", trace.with_friction)


def torques_under_wrench(frame: str, trace: Trace) -> Iterator[Formulation]:
    """Formulations of tau - J^T h, with h in the axes of the world or of the end effector."""
    words, starts = f"Newton-Euler with the wrench on the last link {_BASE}", _torque_choices(trace)
    recursion = _newton_euler(trace, QDD, frame)
    yield from _searched(trace, f"torques, {frame} wrench", words, recursion, ALL_CHOICES, starts)
    yield from _less(frame, trace, torques(trace))


def _less(frame: str, trace: Trace, plain: Iterator[Formulation], order: int = 0) -> Iterator[Formulation]:
    """Formulations less what joints feel of a wrench."""
    for each in plain:
        for found in kinematics.with_wrench_torques(frame, trace, each.trace(), -1, order=order):
            yield Formulation(f"{each.words}, less J^T h", partial(list, found))


def coriolis_vectors(trace: Trace) -> Iterator[Formulation]:
    """Formulations of C qd."""
    zero, rates, still = trace.chain.zero, trace.arguments(QD), trace.still()

    def _values(choices: FrameChoices) -> list[Value]:
        weightless = replace(trace.arranged(choices, axial=True), gravity=(zero, zero, zero))
        return inverse_dynamics(weightless, rates, still, choices)

    words = f"Newton-Euler without gravity and accelerations {_BASE}"
    yield from _searched(trace, "velocity torques", words, _values, ALL_CHOICES, _torque_choices(trace)[:1])


def accelerations(trace: Trace) -> Iterator[Formulation]:
    """Formulations of qdd under given torques."""
    n = trace.n
    if trace.robot.coupled:

        def _projected() -> list[Value]:
            bias = _newton_euler(trace, None)(_torque_choices(trace)[0])
            half = trace.by_variables(flat(_cheapest_inertia(trace)), (n, n), 0)
            entries, dof = trace.by_variables(half, (trace.robot.dof, n), 1), trace.robot.dof
            rows = [entries[dof * i : dof * i + dof] for i in range(dof)]
            return forward_dynamics(rows, trace.by_variables(bias, (n,), 0), trace.variables(TAU))

        words = "inertia matrix and Newton-Euler of the variables, factorised without roots"
        yield Formulation(words, _projected, is_of_variables=True)
        return
    if n <= POLICY.most_factorised:

        def _factorised() -> list[Value]:
            bias = _newton_euler(trace, None)
            return forward_dynamics(_cheapest_inertia(trace), bias(_torque_choices(trace)[0]), trace.arguments(TAU))

        yield Formulation("inertia matrix and Newton-Euler, factorised without roots", _factorised)
    yield from _articulated(trace)


def accelerations_under_wrench(frame: str, trace: Trace) -> Iterator[Formulation]:
    """Formulations of qdd under given torques and a wrench in the axes of the world or of the end effector."""
    given, choices, inertia = trace.arguments(TAU), _torque_choices(trace)[0], _cheapest_inertia(trace)
    bias = _newton_euler(trace, None)(choices)
    if trace.n <= POLICY.most_factorised:
        words = "inertia matrix and Newton-Euler under the wrench, factorised without roots"
        less = kinematics.with_wrench_torques(frame, trace, bias, -1)
        for load in (_newton_euler(trace, None, frame)(choices), *less):
            yield Formulation(words, partial(forward_dynamics, inertia, load, given))
    pushed, *_ = kinematics.with_wrench_torques(frame, trace, given, 1, beside=bias)
    yield from _articulated(trace, pushed)


def _articulated(trace: Trace, torques: Sequence[Value] | None = None) -> Iterator[Formulation]:
    """Accelerations of arms with many joints; the torques are the given ones, or those that a wrench adds to."""
    if trace.n >= POLICY.fewest_articulated:
        friction = trace.with_friction(trace.zeros())
        push = [torque - loss for torque, loss in zip(torques or trace.arguments(TAU), friction, strict=True)]
        yield from _searched(
            trace,
            "articulated",
            f"articulated bodies {_BASE}",
            lambda choices: articulated_accelerations(trace.arranged(choices), trace.arguments(QD), push, choices),
            ALL_CHOICES,
        )


def no_accelerations(trace: Trace) -> Formulation:
    """What stands for qdd where no motion of some joint meets inertia."""
    words = "the inertia matrix is singular everywhere"
    return Formulation(words, lambda: [torque / trace.chain.zero for torque in trace.arguments(TAU)])


def task_inertias(trace: Trace) -> Iterator[Formulation]:
    """Formulations of Lambda: J B^-1 J^T from the factors of B, and its inverse from its own."""
    chain, rows = trace.chain, task_rows(trace.robot)

    def _values() -> list[Value]:
        level = replace(chain, base=chain.unit, joints=(replace(chain.joints[0], fixed=chain.unit), *chain.joints[1:]))
        in_world = trace.robot.inverse.task != POSE or rows in (tuple(range(6)), *PARTS.values())
        whole = (trace.shortest_jacobian or jacobian(chain)) if in_world else jacobian(level)
        _, pivots, lifted = factorised(_cheapest_inertia(trace), [whole[row] for row in rows])
        mobility = carried(lifted, pivots, chain.zero)
        units = [[chain.one if i == j else chain.zero for j in range(len(rows))] for i in range(len(rows))]
        _, pivots, lifted = factorised(mobility, units)
        # Where rows are dependent a pivot is rounding, which the smallest before has magnified: then all are made 0.
        has_rank = lowest = chain.one
        for k in reversed(range(len(rows))):
            alike = (mobility[i][i] for i, row in enumerate(rows) if (row < 3) == (rows[k] < 3))
            share = pivots[k] / sum(alike, chain.zero)
            has_rank, lowest = has_rank * trace.domain.number(_DEPENDENT).less(share * lowest), lowest.minimum(share)
        return flat(carried(lifted, [has_rank * pivot for pivot in pivots], chain.zero))

    yield Formulation("inertia matrix, then the task's, factorised without roots", _values)


def no_task_inertia(trace: Trace) -> Formulation:
    """What stands for Lambda there."""
    gap = trace.arguments(Q)[0] / trace.chain.zero
    return Formulation("J B^-1 J^T is singular everywhere", lambda: [gap] * len(task_rows(trace.robot)) ** 2)


def torque_position_derivatives(trace: Trace) -> Iterator[Formulation]:
    """Formulations of d tau / d q."""
    rates, accelerations = trace.arguments(QD), trace.arguments(QDD)

    def _values(choices: FrameChoices) -> list[Value]:
        return flat(torque_position_derivative(trace.arranged(choices), rates, accelerations, trace.half, choices))

    starts = (*_torque_choices(trace), *_coriolis_choices(trace))
    yield from _searched(trace, "torque slopes", f"moving composite bodies {_BASE}", _values, (), starts)
    if trace.n <= POLICY.most_differentiated and not trace.robot.coupled:
        found, choices = _newton_euler(trace, QDD), _torque_choices(trace)[0]
        words = f"Newton-Euler {_BASE}, its operations differentiated"
        yield Formulation(words, lambda: flat(gradient_columns(found(choices), trace.arguments(Q))))


def slopes_under_wrench(frame: str, trace: Trace) -> Iterator[Formulation]:
    """Formulations of d (tau - J^T h) / dq."""
    if trace.n <= POLICY.most_differentiated:
        found, choices = _newton_euler(trace, QDD, frame), _torque_choices(trace)[0]
        words = f"Newton-Euler with the wrench on the last link {_BASE}, its operations differentiated"
        yield Formulation(words, lambda: flat(gradient_columns(found(choices), trace.arguments(Q))))
    yield from _less(frame, trace, torque_position_derivatives(trace), 1)


def torque_velocity_derivatives(trace: Trace) -> Iterator[Formulation]:
    """Formulations of d tau / d qd."""

    def _values(choices: FrameChoices) -> list[Value]:
        return flat(torque_velocity_derivative(trace.arranged(choices), trace.arguments(QD), trace.half))

    words = f"composite bodies of twice the mass and their inner motion {_BASE}"
    for choices in _coriolis_choices(trace):
        yield Formulation(words, partial(_values, choices))


def _searched(
    trace: Trace,
    name: str,
    words: str,
    values: Recursion,
    choices: Sequence[str] = CHAIN_CHOICES,
    starts: Sequence[FrameChoices] = (),
) -> Iterator[Formulation]:
    """A recursion with each of the cheapest frame choices."""
    for chosen in trace.cheapest_choices(name, values, choices, starts):
        yield Formulation(words, partial(values, chosen))


def _closed(
    trace: Trace, function: str, finish: Callable[[list[Value]], list[Value]] = lambda values: values
) -> Iterator[Formulation]:
    """Closed forms of a function where they are short."""
    for form in trace.closed_forms:
        if (values := form.values(function)) is not None:
            yield Formulation(form.words, partial(finish, values))


def _inertia(trace: Trace) -> Recursion:
    return lambda choices: flat(inertia_matrix(trace.arranged(choices)))


def _cheapest_inertia(trace: Trace) -> list[list[Value]]:
    inertia, n = _inertia(trace), trace.n
    entries = inertia(trace.cheapest_choices("inertia", inertia)[0])
    return [entries[n * i : n * i + n] for i in range(n)]


def _coriolis(trace: Trace) -> Recursion:
    return lambda choices: flat(coriolis_matrix(trace.arranged(choices), trace.arguments(QD), trace.half))


def _coriolis_choices(trace: Trace) -> tuple[FrameChoices, ...]:
    return trace.cheapest_choices("coriolis", _coriolis(trace))


def _newton_euler(trace: Trace, accelerations: str | None, wrench: str = "") -> Recursion:
    """Torques with friction, under a wrench in some axes; without accelerations they are the bias."""
    rates = trace.arguments(QD)
    given = trace.still() if accelerations is None else trace.arguments(accelerations)

    def _values(choices: FrameChoices) -> list[Value]:
        if not wrench:
            return trace.with_friction(inverse_dynamics(trace.arranged(choices, axial=True), rates, given, choices))
        turning = (*choices[:-1], replace(choices[-1], held=False))  # the wrench turns with the last link
        arranged = trace.arranged(turning, axial=True)
        tip = kinematics.wrench_at_tip(wrench, trace, arranged)
        return trace.with_friction(inverse_dynamics(arranged, rates, given, turning, tip=tip))

    return _values


def _torque_choices(trace: Trace) -> tuple[FrameChoices, ...]:
    return trace.cheapest_choices("torques", _newton_euler(trace, QDD), ALL_CHOICES)


def regressors(trace: Trace) -> Iterator[Formulation]:
    """Formulations of Y."""
    yield _regressor(trace, standard_parameters(trace.robot), ends=True)


def base_regressors(trace: Trace) -> Iterator[Formulation]:
    """Formulations of Y_b."""
    yield _regressor(trace, base_set(trace.robot).parameters, ends=False)


def base_parameters(trace: Trace) -> Iterator[Formulation]:
    """Formulations of beta."""
    base = base_set(trace.robot)

    def _value(coefficient: Quotient) -> Value:
        numerator, denominator = map(trace.domain.constant, base.fraction(coefficient))
        return numerator / denominator

    yield Formulation("grouped from the tip inwards", lambda: base_values(trace.robot, base, trace.domain, _value))


def standard_columns(trace: Trace) -> tuple[Column, ...]:
    """What the columns of Y belong to."""
    parameters = standard_parameters(trace.robot)
    formulas = standard_formulas(trace.robot, parameters)
    return tuple(Column(p.name, formula) for p, formula in zip(parameters, formulas, strict=True))


def base_columns(trace: Trace) -> tuple[Column, ...]:
    """What the columns of Y_b and the entries of beta belong to."""
    base = base_set(trace.robot)
    formulas = base_formulas(trace.robot, base)
    return tuple(Column(p.name, formula) for p, formula in zip(base.parameters, formulas, strict=True))


def _regressor(trace: Trace, parameters: Sequence[Parameter], *, ends: bool) -> Formulation:
    def _values() -> list[Value]:
        chain = build_chain(with_unit_rotors(trace.robot), trace.domain)
        rates, accelerations = trace.arguments(QD), trace.arguments(QDD)
        return flat(Regressor(chain, rates, accelerations, ends=ends, sign=Value.sign).rows(parameters))

    return Formulation("work of unit wrenches on the screws of the joints", _values)
