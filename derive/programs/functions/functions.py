"""The program of a robot: every function's cheapest candidate, as a tape.

The functions and their candidates are listed in `derive.programs.functions.kinematics`,
`derive.programs.functions.derivatives`, `derive.programs.functions.dynamics` and
`derive.programs.functions.identification`; a further formulation is one more `Candidate` there.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress

from derive.errors import QuantityError
from derive.programs.effort import Effort, effort_named, uncollected
from derive.programs.functions.derivatives import (
    analytic_jacobians,
    jacobian_rates,
    torque_derivatives,
    velocity_torques,
)
from derive.programs.functions.dynamics import accelerations, dynamic_functions, no_accelerations
from derive.programs.functions.identification import identification_functions
from derive.programs.functions.kinematics import kinematic_functions
from derive.programs.program import Function, Program
from derive.programs.tape.finish import Finisher
from derive.programs.trace import Specification, Trace
from derive.robot.names import free_symbols
from derive.robot.robot import Robot


def build_program(robot: Robot, effort: Effort | None = None) -> Program:
    """All functions of ``robot``: kinematics, and dynamics where the file has links.

    Args:
        robot: The robot.
        effort: See `effort_named`.

    Raises:
        QuantityError: A cell divides by zero or has no real root once the parameters have their numbers.
    """
    spent = effort_named(effort)
    with uncollected():
        return Program(tuple(_functions(robot, spent)), free_symbols(robot))


def _functions(robot: Robot, effort: Effort) -> list[Function]:
    trace = Trace(robot, effort)
    finisher = Finisher(robot, trace.graph, effort)
    functions = [_function(specification, finisher) for specification in kinematic_functions(trace)]
    functions.append(_function(jacobian_rates(trace), finisher))
    functions += _regular(analytic_jacobians(trace), finisher)
    if robot.has_dynamics:
        functions += [_function(specification, finisher) for specification in dynamic_functions(trace)]
        functions.append(_accelerations(trace, finisher))
        functions.append(_function(velocity_torques(trace), finisher))
        functions += [_function(specification, finisher) for specification in torque_derivatives(trace)]
        functions += [_function(specification, finisher) for specification in identification_functions(trace)]
    return functions


def _function(specification: Specification, finisher: Finisher) -> Function:
    candidates = specification.candidates
    outputs = [[value.ref for value in candidate.values()] for candidate in candidates]
    chosen, tape = finisher.cheapest(outputs, search=specification.search)
    formulation = candidates[chosen].formulation
    name, shape = specification.name, specification.shape
    return Function(name, specification.arguments, shape, tape, formulation, specification.columns)


def _regular(specifications: Iterable[Specification], finisher: Finisher) -> list[Function]:
    """The functions that have a value anywhere: some angles are singular in every configuration of an arm.

    Cells without a value have been refused by the functions before.
    """
    found: list[Function] = []
    for specification in specifications:
        with suppress(QuantityError):
            found.append(_function(specification, finisher))
    return found


def _accelerations(trace: Trace, finisher: Finisher) -> Function:
    """Forward dynamics; infinite or not a number where no motion of a joint meets inertia.

    Cells without a value have been refused by the functions before.
    """
    try:
        return _function(accelerations(trace), finisher)
    except QuantityError:
        return _function(no_accelerations(trace), finisher)
