"""The words of a derivation are true: the entries that are said to be compared give the equation."""

from __future__ import annotations

import random

import mpmath
import pytest
import sympy

from derive.inverse.closed.nodes import Provenance
from derive.inverse.words.origins import Origin, OriginForm, origin
from derive.lecture.point import value_of
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.model import Model
from derive.robot.robot import Robot

CRAIG = """
name: puma-craig
convention: modified
joints:
  - {type: revolute}
  - {type: revolute, alpha: -pi/2}
  - {type: revolute, a: a2, d: d3}
  - {type: revolute, alpha: -pi/2, a: a3, d: d4}
  - {type: revolute, alpha: pi/2}
  - {type: revolute, alpha: -pi/2}
"""
SCARA = """
name: scara
convention: standard
joints:
  - {type: revolute, d: d3, a: a2}
  - {type: revolute, a: a3, alpha: pi}
  - {type: prismatic}
inverse: {task: position}
"""
TURNED = """
name: turned
convention: standard
base: [[2/3, -1/3, 2/3, 1/10], [2/3, 2/3, -1/3, 0], [-1/3, 2/3, 2/3, 0], [0, 0, 0, 1]]
tool: [[1, 0, 0, 1/5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
joints:
  - {type: revolute, a: a2}
  - {type: revolute, a: a3}
  - {type: revolute, a: d3}
inverse: {task: [x, y, phi]}
"""
ARMS = {
    "standard": Robot.load("puma560-corke"),
    "modified": Robot.from_text(CRAIG),
    "scara": Robot.from_text(SCARA),
    "turned": Robot.from_text(TURNED),
}
TOLERANCE = mpmath.mpf(10) ** -20


def test_columns_are_counted_behind_the_twist_of_the_last_row() -> None:
    robot = ARMS["standard"]
    assert origin(robot, Provenance(5, 5, "R[3,2]"), to_end=False) == Origin(OriginForm.ENTRY, 5, 5, ((3, 3),))
    assert origin(robot, Provenance(3, 6, "R[3,2]"), to_end=False) == Origin(OriginForm.ENTRY, 3, 6, ((3, 2),))


def test_a_position_is_that_of_the_last_frame_that_has_it() -> None:
    """The axes of a wrist meet, so that the matrices behind its centre change no position."""
    robot = ARMS["standard"]
    assert origin(robot, Provenance(2, 4, "p[3]"), to_end=False) == Origin(OriginForm.ENTRY, 2, 6, ((3, 4),))
    assert origin(robot, Provenance(2, 4, "p.p"), to_end=False).form is OriginForm.SQUARES


def test_along_the_axis_of_a_joint_its_own_length_changes_no_position() -> None:
    robot = ARMS["scara"]
    assert origin(robot, Provenance(1, 1, "p[3]"), to_end=False) == Origin(OriginForm.ENTRY, 1, 1, ((3, 4),))


def numbers(model: Model, rng: random.Random) -> dict[sympy.Expr, mpmath.mpf]:
    return {symbol: mpmath.mpf(rng.randint(-300, 300)) / 101 for symbol in model.q}


def frame(rows) -> sympy.Matrix:
    return sympy.Matrix(4, 4, [expression_to_sympy(cell) for row in rows for cell in row])


def valued(matrix: sympy.Matrix, known: dict[sympy.Expr, mpmath.mpf]) -> sympy.Matrix:
    return sympy.Matrix(*matrix.shape, [value_of(entry, dict(known)) for entry in matrix])


@pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)
def test_an_equation_is_the_difference_of_the_entries_that_are_compared(arm: Robot) -> None:
    """At poses that are not those of the configuration, so that both sides differ: always by the same factor."""
    model = Model(arm)
    found, rng = model.inverse, random.Random(4)
    factors: dict[sympy.Expr, list[mpmath.mpf]] = {}
    with mpmath.workdps(40):
        for _ in range(3):
            parameters = {s: mpmath.mpf(rng.randint(20, 90)) / 97 for s in sympy.symbols("a2 a3 d3 d4")}
            there, here = numbers(model, rng), numbers(model, rng)
            pose = valued(model.T, {**parameters, **there})
            known = {**parameters, **here, **dict(zip(found.pose[:3, :], pose[:3, :], strict=True))}
            for line in found.definitions:
                known[line.symbol] = value_of(line.value, dict(known))
            matrices = [sympy.eye(4), *(valued(model.A(i), known) for i in range(1, arm.n + 1))]
            ends = [valued(frame(rows), {}) for rows in (arm.base, arm.tool)]
            for equation in (equation for step in found.steps for equation in step.equations):
                place, *eliminated = equation.origins
                if place.form is OriginForm.ENTRY and not eliminated:
                    base, first = (sympy.eye(4), ends[0]) if place.has_base else (ends[0], sympy.eye(4))
                    tool, last = (sympy.eye(4), ends[1]) if place.has_tool else (ends[1], sympy.eye(4))
                    left = sympy.prod(matrices[: place.first], start=base)
                    right = sympy.prod(matrices[place.last + 1 :], start=sympy.eye(4)) * tool
                    inside = sympy.prod(matrices[place.first : place.last + 1], start=first) * last
                    ((row, column),) = place.entries
                    gap = (inside - left.inv() * pose * right.inv())[row - 1, column - 1]
                    difference = value_of(equation.left - equation.right, dict(known))
                    factors.setdefault(equation.left - equation.right, []).append(difference / gap)
    assert len(factors) >= arm.n
    for ratios in factors.values():
        assert all(abs(abs(ratio) - abs(ratios[0])) < TOLERANCE for ratio in ratios)
