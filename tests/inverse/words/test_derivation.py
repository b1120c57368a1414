"""The steps of a derivation: equations in the robot's own variables, names that clash with nothing."""

from __future__ import annotations

import sympy

from derive.inverse.words.derivation import PrintedDerivation, pose_names
from derive.inverse.words.solutions import inverse_kinematics
from derive.robot.robot import Robot
from tests.inverse.closed.test_graph import PLANAR, planar_graph

OFFSETS = """
name: offsets
convention: modified
units: {angle: deg}
joints:
  - {type: revolute, theta: q1 - 172.22}
  - {type: revolute, theta: q2 - 102.78, a: 0.3}
  - {type: revolute, a: 0.25}
"""
"""An arm whose first two angles together have the offset -275 degrees."""


def test_the_equations_of_a_step_hold_the_unknown_on_their_left_and_what_is_known_on_their_right() -> None:
    robot = Robot.from_text(PLANAR)
    steps = PrintedDerivation(planar_graph(), robot, robot.style).steps
    assert [step.unknown for step in steps] == list(sympy.symbols("q2 q1"))
    q1, q2, a1, a2, px, py = sympy.symbols("q1 q2 a1 a2 px py")
    assert steps[0].equations[0].left == 2 * a1 * a2 * sympy.cos(q2)
    assert steps[0].equations[0].right == px**2 + py**2 - a1**2 - a2**2
    assert [(e.left, e.right) for e in steps[1].equations] == [
        (a1 * sympy.cos(q1) + a2 * sympy.cos(q1 + q2), px),
        (a1 * sympy.sin(q1) + a2 * sympy.sin(q1 + q2), py),
    ]


def test_sums_of_angles_may_have_offsets_that_no_joint_has() -> None:
    robot = Robot.from_text(OFFSETS)
    found = inverse_kinematics(robot, robot.style)
    assert found.count == 2
    assert len(found.solutions) == 2
    assert found.verified


def test_the_pose_has_other_names_where_the_robot_has_these() -> None:
    names = pose_names(Robot.from_text(PLANAR.replace("a1", "r11")))
    assert names[1, 1] == "R11"
    assert names[1, 4] == "Px"
    assert len(set(names.values())) == 12


def test_where_an_unknown_is_free_no_constant_stands_before_what_vanishes() -> None:
    table = ((0.1, "pi/3"), (0.2, "pi/2"), (0.3, "pi/3"))
    rows = "".join(f"  - {{type: revolute, d: {d}, alpha: {twist}}}\n" for d, twist in table)
    robot = Robot.from_text(f"name: tilted\nconvention: standard\njoints:\n{rows}")
    found = inverse_kinematics(robot, robot.style)
    vanishing = {str(value) for step in found.steps for value in step.fails}
    assert "wz" in vanishing
    assert not any("sqrt(3)" in text for text in vanishing)
