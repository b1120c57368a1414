"""Branches have one order and one name each, in print and in the graph that generated code runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
import sympy

from derive.inverse.closed.solve import solve
from derive.inverse.numeric.in_numbers import ArrayDomain, array_value
from derive.inverse.words.elementary import PrintedLine
from derive.inverse.words.postures import LOOKED_AT, postures
from derive.inverse.words.solutions import InverseKinematics, inverse_kinematics
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from tests.inverse.arms import PUBLISHED, random_arm
from tests.inverse.closed.test_graph import PLANAR, planar_graph

USUAL = ("planar-3r", "scara-perugia", "spherical-wrist", "stanford-deluca")
"""And ``scara-wrist``, where a factor of an equation moves."""


@pytest.mark.parametrize(
    "name",
    [*USUAL, "scara-wrist", *(pytest.param(n, marks=pytest.mark.sweep) for n in catalogue_names() if n not in USUAL)],
)
def test_printed_solutions_stand_in_the_order_of_the_graph_under_its_names(name: str) -> None:
    found = None if name in catalogue_names() else next(case.robot() for case in PUBLISHED if case.name == name)
    robot = found or Robot.load(name)
    inverse = inverse_kinematics(robot, robot.style)
    if len(inverse.solutions) < 2:
        return
    looked = postures(robot, inverse.graph)
    assert tuple(solution.name for solution in inverse.solutions) == looked.names[: len(inverse.solutions)]
    met = 0
    for solution, branch in zip(inverse.solutions, looked.branches, strict=False):
        own = in_numbers(inverse, solution.lines)
        real = np.isfinite(own).all(axis=0)
        met += int(real.sum())
        assert np.abs(np.exp(1j * own) - np.exp(1j * branch))[:, real].max(initial=0.0) < 1e-5
    assert met >= LOOKED_AT


def in_numbers(inverse: InverseKinematics, lines: Sequence[PrintedLine]) -> np.ndarray:
    """The joint variables of a solution at the poses looked at, not a number where it is none."""
    looked, robot = postures(inverse.robot, inverse.graph), inverse.robot
    variables = [sympy.Symbol(joint.variable) for joint in robot.joints]
    q = dict(zip(variables, looked.q, strict=True))
    known = inverse.values_at({sympy.Symbol(k): float(x) for k, x in looked.parameters.items()}, q, ArrayDomain)
    with np.errstate(all="ignore"):
        for line in lines:
            known[line.symbol] = array_value(line.value, known)
    return np.stack([np.broadcast_to(known.get(symbol, own), own.shape) for symbol, own in q.items()])


def test_solutions_are_told_apart_wherever_rounding_puts_them() -> None:
    robot = Robot.from_text(PLANAR)
    looked = postures(robot, planar_graph())
    assert looked.names == ("elbow down", "elbow up")
    turned = [np.where(np.arange(LOOKED_AT) < 20, a, b) for a, b in (looked.branches, looked.branches[::-1])]
    assert looked.places(turned) == [1, 0]
    assert looked.places(looked.branches) == [0, 1]


def test_an_arm_with_one_solution_has_no_names() -> None:
    robot = Robot.load("spherical-arm")
    inverse = inverse_kinematics(robot, robot.style)
    assert postures(robot, inverse.graph).names == ("",)
    assert [solution.name for solution in inverse.solutions] == [""]


def test_branches_that_do_not_exist_raise_no_warning() -> None:
    robot = random_arm("5dof", 2).robot()
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        assert len(postures(robot, solve(robot)).branches) > 1
