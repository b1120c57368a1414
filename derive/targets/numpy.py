"""``model_numpy.py``: the functions of a robot for one configuration or any batch, importing NumPy alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.programs.interface import joint_lines
from derive.targets.escape import python_docstring, python_string
from derive.targets.python_kernel import python_functions, python_tuple, wrapped
from derive.targets.target import Source, Target, joint_limits
from derive.targets.templating import render

FILE = "model_numpy.py"
_SHORT = 100


@dataclass(frozen=True, slots=True)
class Constant:
    """A tuple at the top of the module: its name, and its entries on one line or in several."""

    name: str
    short: bool
    inside: str
    lines: tuple[str, ...]


def render_numpy(source: Source) -> dict[str, str]:
    """The module's text."""
    text = render("numpy/model_numpy.py.jinja", **python_context(source))
    return {FILE: text}


def python_context(source: Source) -> dict[str, object]:
    """What the Python templates ask for."""
    robot, program = source.robot, source.program
    return {
        "title": python_docstring(robot.title or robot.name),
        "name": python_docstring(robot.name),
        "version": python_docstring(source.version),
        "digest": robot.digest,
        "convention": robot.convention.value,
        "joints": joint_lines(robot),
        "dof": robot.n,
        "constants": _constants(source),
        "tables": tuple(_tables(source)),
        "has_parameters": bool(program.parameters),
        "has_dynamics": robot.has_dynamics,
        "functions": python_functions(program, robot.n),
    }


def _constants(source: Source) -> tuple[Constant, ...]:
    robot = source.robot
    columns: dict[str, Sequence[str]] = {
        "JOINT_NAMES": [python_string(joint.variable) for joint in robot.joints],
        "JOINT_TYPES": [python_string(joint.type.value) for joint in robot.joints],
        "LIMITS": joint_limits(robot),
        "PARAMETERS": [python_string(name) for name in source.program.parameters],
        **_tables(source),
    }
    return tuple(_constant(name, values) for name, values in columns.items())


def _tables(source: Source) -> dict[str, Sequence[str]]:
    """The names of the regressors' columns, and what the base parameters are."""
    program = source.program
    if "regressor" not in program:
        return {}
    standard, base = program["regressor"].columns, program["base_parameters"].columns
    return {
        "STANDARD_PARAMETERS": [python_string(column.name) for column in standard],
        "BASE_PARAMETERS": [python_string(column.name) for column in base],
        "BASE_FORMULAS": [python_string(column.formula) for column in base],
    }


def _constant(name: str, values: Sequence[str]) -> Constant:
    lines = wrapped(values)
    inside = python_tuple(values) if values else ""
    return Constant(name, short=len(name) + len(inside) <= _SHORT, inside=inside, lines=lines)


TARGET = Target(
    name="numpy",
    summary="functions of one configuration or a batch, importing NumPy alone",
    files=(FILE,),
    render=render_numpy,
)
