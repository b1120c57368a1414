"""``model.mjs``: the functions of a robot as a JavaScript module, from the same tapes, for browsers and Node alike."""

from collections.abc import Sequence

from derive.programs.program import GIVEN, NEAR, POSE, WIDTHS, Function, Inverse, Program
from derive.robot.robot import Robot
from derive.targets.escape import javascript_comment, javascript_string
from derive.targets.kernel import JAVASCRIPT, Kernel, entry_names, rows_of, wrapped, write_kernel
from derive.targets.target import Source, Target, case_context, heading, joint_bounds, joint_limits, shape_text
from derive.targets.templating import render

FILE = "model.mjs"


def render_javascript(source: Source) -> dict[str, str]:
    """The module ``model.mjs``."""
    context = heading(source, javascript_comment) | _body_context(source.robot, source.program)
    return {FILE: render("javascript/model.mjs.jinja", **context)}


_WHAT = "a JavaScript module for browsers and Node, one configuration a call"
TARGET = Target("javascript", _WHAT, (FILE,), render_javascript, default=False)


def javascript_body(robot: Robot, program: Program) -> str:
    """Declarations of the functions and their constants, without exports: for a page's script."""
    return render("javascript/functions.js.jinja", **_body_context(robot, program))


def camel_case(name: str) -> str:
    """A function's name as JavaScript has it."""
    first, *rest = name.split("_")
    return first + "".join(part.capitalize() for part in rest)


def _body_context(robot: Robot, program: Program) -> dict[str, object]:
    return {
        "dof": robot.dof,
        "joint_names": wrapped([javascript_string(joint.label) for joint in robot.variables]),
        "joint_types": wrapped([javascript_string(joint.type.value) for joint in robot.variables]),
        "limits": wrapped([f"[{pair[0]!r}, {pair[1]!r}]" if pair else "null" for pair in joint_limits(robot)]),
        "bounds": {
            name: wrapped(["null" if most is None else repr(most) for most in row])
            for name, row in joint_bounds(robot).items()
        },
        "parameters": wrapped([javascript_string(name) for name in program.parameters]),
        **case_context(program.all_tapes),
        "inverse": _inverse(program.inverse, program.parameters, robot) if program.inverse else None,
        "functions": tuple(_function(function, program.parameters, robot.dof) for function in program),
    }


def _function(function: Function, parameters: Sequence[str], joints: int) -> dict[str, object]:
    kernel = write_kernel(function.tape, JAVASCRIPT, parameters)
    needed = [parameters[index] for index in kernel.parameters]
    return {
        "name": camel_case(function.name),
        "label": javascript_string(camel_case(function.name)),  # its name as a string literal
        "signature": ", ".join((*function.arguments, "params")),
        "wording": function.interface,  # what its comment says: summary, symbol and result
        "described": function.described,  # arguments
        "shape": shape_text(function.shape),
        "notes": function.notes,  # how it is computed
        "parameters": wrapped([javascript_string(name) for name in needed]),  # those that it needs, if any
        "unpack_parameters": wrapped([f"p_{name}" for name in needed]),  # lines that name them
        "hoisted": kernel.hoisted,  # statements on parameters alone
        "hoisted_results": wrapped(kernel.constant_values),  # lines of the values that the body takes from there
        "checks": _checks(function, kernel, joints) if POSE not in function.widths else (),
        "constants": wrapped(kernel.constants),  # lines of the names of the values on parameters alone
        "body": kernel.body,
        "results": _nested(kernel.results, function.shape) if function.shape else (),  # lines of nested array literals
        "scalar": "" if function.shape else kernel.results[0],  # the result where it is one number, else nothing
    }


def _inverse(inverse: Inverse, parameters: Sequence[str], robot: Robot) -> dict[str, object]:
    function = inverse.function
    turning = [i for i, joint in enumerate(robot.variables) if joint.is_revolute and i not in inverse.given]
    count, unpacked = len(inverse.given), ", ".join(entry_names(function, GIVEN, 0))
    given = f'const [{unpacked}] = finite("inverseKinematics", "given", given, {count});'
    return {
        "kernel": _function(function, parameters, robot.dof),  # the texts of its program
        "step": _function(inverse.step, parameters, robot.dof),  # those of its Newton step
        "step_entries": tuple((n, wrapped(entry_names(inverse.step, n, robot.dof))) for n in inverse.step.arguments),
        "count": inverse.summary,  # how many solutions there are
        "branches": inverse.branches,
        "order": tuple(map(javascript_comment, inverse.order)),
        "entries": wrapped(entry_names(function, POSE, 0)),  # lines of the names of the entries of a pose
        "near_entries": wrapped(entry_names(function, NEAR, 0)),  # lines of those of ``near``
        "size": inverse.branches * inverse.joints,  # joint variables of all branches
        "closed": repr(inverse.closed),  # error of the pose of a branch in doubt up to which it is a solution
        "around": inverse.around,  # where further solutions are looked for
        "given_count": count,  # number of given joints
        "unpack_given": (given,) if count else (),  # statements that check their variables and name them
        "given_of_q": ", ".join(f"q[{i}]" for i in inverse.given),  # their variables in a configuration
        "turning": ", ".join(map(str, turning)),  # revolute joints that are not given, from 0
        "given_words": ", ".join(javascript_comment(robot.joints[i].label) for i in inverse.given),
    }


def _checks(function: Function, kernel: Kernel, joints: int) -> tuple[str, ...]:
    """Every argument is checked, and named where the kernel reads it."""
    lines: list[str] = []
    for kind in function.arguments:
        width = {**WIDTHS, **function.widths}.get(kind, 0)
        length = f", {width}" if width else ""
        call = f"vector({javascript_string(camel_case(function.name))}, {javascript_string(kind)}, {kind}{length})"
        if kind not in kernel.arguments:
            lines.append(f"{call};")
            continue
        names = wrapped(entry_names(function, kind, joints))
        lines += [f"const [{names[0]}", *(f"  {line}" for line in names[1:])]
        lines[-1] = f"{lines[-1].rstrip(',')}] = {call};"
    return tuple(lines)


def _nested(results: Sequence[str], shape: Sequence[int]) -> tuple[str, ...]:
    """Results as the inside of an array literal of that shape, in lines."""
    if len(shape) == 1:
        return wrapped(results)
    lines: list[str] = []
    for part in rows_of(results, len(results) // shape[0]):
        inside = _nested(part, shape[1:])
        short = len(shape) == 2 and len(inside) == 1
        lines += [f"[{inside[0].rstrip(',')}],"] if short else ["[", *(f"  {line}" for line in inside), "],"]
    return tuple(lines)
