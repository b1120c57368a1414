"""``model.h`` and ``model.c``: the functions of a robot in C99, one configuration or a batch, from the same tapes."""

from __future__ import annotations

from collections.abc import Sequence

from derive.programs.interface import joint_lines
from derive.targets.c.functions import CFunction, c_functions
from derive.targets.escape import c_comment, c_prefix
from derive.targets.target import Source, Target
from derive.targets.templating import render

HEADER, CODE = "model.h", "model.c"


def render_c(source: Source) -> dict[str, str]:
    """Header and code."""
    context = c_context(source)
    return {HEADER: render("c/model.h.jinja", **context), CODE: render("c/model.c.jinja", **context)}


def c_context(source: Source) -> dict[str, object]:
    """What the templates ask for."""
    robot, program = source.robot, source.program
    functions = c_functions(program)
    return c_heading(source) | {
        "parameters": [{"name": name, "place": str(i)} for i, name in enumerate(program.parameters)],
        "parameter_count": len(program.parameters),
        "prefix": c_prefix(robot.name),
        "guard": f"DERIVE_{c_prefix(robot.name).upper()}MODEL_H",
        "functions": functions,
        "has_angles": any(function.angle_count for function in functions),
        "has_sign": _mentions(functions, "sign("),
        "has_batches": any(function.arguments for function in functions),
    }


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
        "joints": [c_comment(line) for line in joint_lines(robot)],
    }


def _mentions(functions: Sequence[CFunction], word: str) -> bool:
    texts = [
        text for f in functions for part in (f.constants, f.angles, f.lane) for text in (*part.body, *part.results)
    ]
    return any(word in text for text in texts)


TARGET = Target(
    name="c",
    summary="C99 without allocation or globals, one configuration or a batch",
    files=(HEADER, CODE),
    render=render_c,
)
