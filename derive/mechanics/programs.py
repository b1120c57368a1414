"""The program of a robot: every function's cheapest candidate, as a tape.

The functions and their candidates are listed in `derive.mechanics.kinematic_functions`,
`derive.mechanics.dynamic_functions` and `derive.mechanics.identification_functions`; a further formulation is one more
`Candidate` there.
"""

from __future__ import annotations

from derive.algebra.program import Function, Program
from derive.algebra.tape_finish import Finisher
from derive.errors import QuantityError
from derive.mechanics.dynamic_functions import accelerations, dynamic_functions, no_accelerations
from derive.mechanics.identification_functions import identification_functions
from derive.mechanics.kinematic_functions import kinematic_functions
from derive.mechanics.specification import Specification
from derive.mechanics.trace import Trace
from derive.robot.names import free_symbols
from derive.robot.robot import Robot


def build_program(robot: Robot) -> Program:
    """All functions of ``robot``: kinematics, and dynamics where the file has links.

    Raises:
        QuantityError: A cell divides by zero or has no real root once the parameters have their numbers.
    """
    trace = Trace(robot)
    finisher = Finisher(robot, trace.graph)
    functions = [_function(specification, finisher) for specification in kinematic_functions(trace)]
    if robot.has_dynamics:
        functions += [_function(specification, finisher) for specification in dynamic_functions(trace)]
        functions.append(_accelerations(trace, finisher))
        functions += [_function(specification, finisher) for specification in identification_functions(trace)]
    return Program(tuple(functions), free_symbols(robot))


def _function(specification: Specification, finisher: Finisher) -> Function:
    candidates = specification.candidates
    outputs = [[value.ref for value in candidate.values()] for candidate in candidates]
    chosen, tape = finisher.cheapest(outputs, search=specification.search)
    formulation = candidates[chosen].formulation
    name, shape = specification.name, specification.shape
    return Function(name, specification.arguments, shape, tape, formulation, specification.columns)


def _accelerations(trace: Trace, finisher: Finisher) -> Function:
    """Forward dynamics; infinite or not a number where no motion of a joint meets inertia.

    Cells without a value have been refused by the functions before.
    """
    try:
        return _function(accelerations(trace), finisher)
    except QuantityError:
        return _function(no_accelerations(trace), finisher)
