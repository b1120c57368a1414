"""``model.h`` and ``model.c``: the functions of a robot in C99, one configuration or a batch, from the same tapes."""

from __future__ import annotations

from typing import Any

from derive.programs.program import Inverse, InverseSearch, Program, joint_lines
from derive.programs.tape.tape import Op
from derive.targets.c_function import c_function
from derive.targets.c_inverse import c_inverse
from derive.targets.escape import c_comment, c_prefix
from derive.targets.kernel import case_context
from derive.targets.target import Source, Target
from derive.targets.templating import render

HEADER, CODE = "model.h", "model.c"


def render_c(source: Source) -> dict[str, str]:
    """Header and code."""
    context = c_context(source)
    return {HEADER: render("c/model.h.jinja", **context), CODE: render("c/model.c.jinja", **context)}


TARGET = Target(
    name="c",
    summary="C99 without allocation or globals, one configuration or a batch",
    files=(HEADER, CODE),
    render=render_c,
)


def c_context(source: Source) -> dict[str, Any]:
    """What the templates of C ask for."""
    program, prefix = source.program, c_prefix(source.robot.name)
    functions = [c_function(function, program.parameters) for function in program]
    solved = solvable(program)
    inverse = c_inverse(solved, source) if solved else None
    texts = [*functions, inverse["function"]] if inverse else functions
    return c_heading(source) | {
        "parameters": [{"name": name, "place": str(i)} for i, name in enumerate(program.parameters)],
        "parameter_count": len(program.parameters),
        "prefix": prefix,
        "guard": f"DERIVE_{prefix.upper()}MODEL_H",
        "functions": functions,
        "inverse": inverse,
        "has_angles": any(function.angle_count for function in texts),
        **case_context(program.all_tapes),
        "has_sign": any(node.op is Op.SIGN for tape in program.all_tapes for node in tape.nodes),
        "has_batches": any(function.arguments for function in texts),
    }


def solvable(program: Program) -> Inverse | InverseSearch | None:
    """Inverse kinematics that C has: by a program, or by eigenvalues."""
    search = program.search if program.search and program.search.eliminations else None
    return program.inverse or search


def c_heading(source: Source) -> dict[str, object]:
    """What the comment at the top of a file in C asks for."""
    robot = source.robot
    return {
        "title": c_comment(robot.title or robot.name),
        "name": c_comment(robot.name),
        "version": c_comment(source.version),
        "digest": robot.digest,
        "convention": robot.convention.value,
        "dof": robot.n,
        "joints": joint_lines(robot, c_comment),
    }
