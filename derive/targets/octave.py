"""``+robot/*.m``: the functions of a robot as a package of MATLAB and Octave, a file each, from the same tapes.

A configuration is a column and a batch has a column for each, as MATLAB's users have them. Every file stands alone:
Octave has no private functions in packages.
"""

import re
from collections.abc import Iterable, Sequence
from math import inf, prod
from typing import Any

import numpy as np

from derive.programs.program import GIVEN, POSE, Function, Inverse, Program
from derive.programs.tape.tape import BRANCHING_NAMES, PARAMETER, Layer, Op
from derive.robot.robot import Robot
from derive.targets.escape import matlab_package, matlab_string, matlab_symbol, one_line
from derive.targets.kernel import OCTAVE, entry_names, input_name, wrapped, write_kernel
from derive.targets.target import Source, Target, bound_text, heading, joint_bounds, joint_limits, shape_text
from derive.targets.templating import render


def render_octave(source: Source) -> dict[str, str]:
    """The package ``+robot``."""
    robot, program = source.robot, source.program
    folder, package = package_folder(robot), matlab_package(robot.name)
    functions = tuple(_function(function, program.parameters, robot) for function in program)
    inverse = _inverse(program.inverse, program, robot) if program.inverse else None
    context = heading(source, one_line) | {
        "package": package,
        "revolute": ", ".join("true" if joint.is_revolute else "false" for joint in robot.variables),
        "parameters": wrapped([matlab_string(name) for name in program.parameters], " ..."),
        "limits": [", ".join(bound_text(bound, "Inf") for bound in p or (-inf, inf)) for p in joint_limits(robot)],
        "bounds": {
            name.lower(): "; ".join(bound_text(inf if most is None else most, "Inf") for most in row)
            for name, row in joint_bounds(robot).items()
        },
        "functions": functions,
        "inverse": inverse,
        "without_inverse": "its solutions come from eigenvalues or a search, which NumPy and C have"
        if program.search
        else one_line(program.without_inverse),
    }
    texts = {f"{folder}/Contents.m": render("octave/Contents.m.jinja", **context)}
    texts[f"{folder}/model.m"] = render("octave/model.m.jinja", **context, constants=_constants(robot, program))
    for function in functions:
        texts[f"{folder}/{function['name']}.m"] = render("octave/function.m.jinja", **context, function=function)
    for name in ("inverse_kinematics", "inverse_kinematics_nearest") if inverse else ():
        texts[f"{folder}/{name}.m"] = render(f"octave/{name}.m.jinja", **context)
    return texts


def package_folder(robot: Robot) -> str:
    """The folder of a robot's package."""
    return f"+{matlab_package(robot.name)}"


_WHAT = "a package of MATLAB and Octave, one file for each function"
TARGET = Target("octave", _WHAT, (), render_octave, default=False, package=package_folder)


def _constants(robot: Robot, program: Program) -> tuple[tuple[str, tuple[str, ...]], ...]:
    standard = program["regressor"].columns if "regressor" in program else ()
    base = program["base_parameters"].columns if "base_parameters" in program else ()
    lists: dict[str, Iterable[str]] = {
        "joint_names": [joint.label for joint in robot.variables],
        "joint_types": [joint.type.value for joint in robot.variables],
        "parameters": program.parameters,
        "standard_parameters": [column.name for column in standard],
        "base_parameters": [column.name for column in base],
        "base_formulas": [column.formula for column in base],
        "given_joints": [robot.joints[i].label for i in program.inverse.given] if program.inverse else [],
    }
    return tuple((name, wrapped([matlab_string(text) for text in texts], " ...")) for name, texts in lists.items())


def _function(function: Function, parameters: Sequence[str], robot: Robot) -> dict[str, Any]:
    tape = function.tape
    kernel = write_kernel(tape, OCTAVE, [matlab_symbol(name, k) for k, name in enumerate(parameters, 1)])
    needed = [parameters[index] for index in kernel.parameters]
    names = [matlab_symbol(parameters[index], index + 1) for index in kernel.parameters]
    layers = [tape.nodes[output.node].layer for output in tape.outputs]
    operators = {node.op for node in tape.nodes}
    is_row = [layer is Layer.BODY and Op.SELECT not in operators for layer in layers]  # a choice may be a constant
    # A result that is the same in all configurations becomes a row by adding zeros.
    rows = zip(kernel.results, is_row, strict=True)
    results = [text if row else "z" if text == "0.0" else f"{text} + z" for text, row in rows]
    places, extent = _column_major(function.shape)
    widths = [function.width(name, robot.dof) for name in function.arguments]
    return {
        "name": function.name,
        "heading": function.name.upper(),  # the name as help texts begin with it, in capitals
        "result": re.sub(r"\W", "_", function.interface.symbol),  # the variable that is returned, ``B``
        "signature": ", ".join((*function.arguments, *(["params"] if parameters else []))),
        "wording": function.interface,  # what its help says: summary, symbol and result
        "described": function.described,  # arguments
        "notes": function.notes,  # how it is computed
        "shape": shape_text((*extent, 1) if len(extent) == 1 else extent),
        "wide_shape": shape_text(extent or (1,)),  # what is before the number of configurations in that of a batch
        "arguments": ", ".join(function.arguments),
        "rows": f"[{', '.join(map(str, widths))}]" if len(set(widths)) > 1 else robot.dof,  # entries of the arguments
        "params_place": len(function.arguments) + 1,  # place of the argument ``params``
        "quoted": ", ".join(f"'{name}'" for name in function.arguments),
        "unpack": _unpacked(function, robot.dof),  # statements that name the entries of the arguments
        "needed": wrapped([matlab_string(name) for name in needed], " ..."),
        "unpack_parameters": tuple(f"p_{name} = p({k});" for k, name in enumerate(names, 1)),
        "hoisted": kernel.hoisted,  # statements on parameters alone
        "hoisted_results": kernel.constant_values,  # the values that the body takes from there
        "unpack_constants": tuple(f"{name} = k({place});" for place, name in enumerate(kernel.constants, 1)),
        "name_constants": tuple(
            f"{name} = {value};"
            for name, value in zip(kernel.constants, kernel.constant_values, strict=True)
            if name != value
        ),
        "body": kernel.body,  # statements on the arguments
        "results": tuple(results[place] for place in places),  # the outputs, column by column, a line each
        "single": results[0] if len(results) == 1 else "",  # the output, where it is one
        "extent": ", ".join(map(str, extent)) if len(extent) > 1 else "",
        "has_root": Op.ROOT in operators,  # whether roots are taken
        "has_cases": not operators.isdisjoint(BRANCHING_NAMES),  # whether cases are told apart
        "has_zeros": not all(is_row),  # whether entries of the result are constants
    }


def _column_major(shape: Sequence[int]) -> tuple[list[int], tuple[int, ...]]:
    """Where the entries of a result stand among the outputs, column by column, and its shape: a stack has pages."""
    places = np.arange(prod(shape)).reshape(shape)
    places = places.transpose(1, 2, 0) if len(shape) == 3 else places
    return places.ravel(order="F").tolist(), places.shape


def _unpacked(function: Function, joints: int) -> tuple[str, ...]:
    """Statements that name the entries of arguments that the tape reads; those of a pose stand column by column."""
    sources = [node.source for node in function.tape.nodes if node.source is not None]
    used = {input_name(source, ()) for source in sources if source.kind != PARAMETER}
    lines = []
    for kind in function.arguments:
        for k, name in enumerate(entry_names(function, kind, joints)):
            row = 4 * (k % 4) + k // 4 if kind == POSE else k
            lines += [f"{name} = {kind}({row + 1}, :);"] if name in used else []
    return tuple(lines)


def _inverse(inverse: Inverse, program: Program, robot: Robot) -> dict[str, Any]:
    names = [one_line(robot.joints[i].label) for i in inverse.given]
    inputs = [*([GIVEN] if names else []), *(["params"] if program.parameters else [])]
    turning = ["true" if j.is_revolute and i not in inverse.given else "false" for i, j in enumerate(robot.variables)]
    return {
        "kernel": _function(inverse.function, program.parameters, robot),  # the texts of its program
        "step": _function(inverse.step, program.parameters, robot),  # those of its Newton step
        "count": inverse.summary,  # how many solutions there are
        "order": tuple(map(one_line, inverse.order)),
        "branches": inverse.branches,
        "closed": repr(inverse.closed),  # error of the pose of a branch in doubt up to which it is a solution
        "around": inverse.around,  # where further solutions are looked for
        "given_count": len(names),  # number of given joints
        "given_words": ", ".join(names),
        "given": ", ".join(str(i + 1) for i in inverse.given),  # places of the given joints, from 1
        "turning": ", ".join(turning),  # which joints turn and are not given
        "inputs": "".join(f", {name}" for name in inputs),  # arguments behind ``T``, each with a comma before it
        "params_place": len(inputs) + 1,  # place of the argument ``params``
        "near_place": len(inputs) + 2,  # place of the argument ``near``
        "size": robot.n * inverse.branches,  # joint variables of all branches
        "error_place": robot.n + 1,  # where a step has the error
        "unit_place": robot.n + 2,  # where it has the unit of length
    }
