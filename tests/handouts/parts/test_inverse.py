"""The formulas of the inverse kinematics as blocks of a handout."""

from __future__ import annotations

from derive.handouts.assemble import context_of
from derive.handouts.parts.inverse import formulas
from derive.robot.robot import Robot


def test_each_unknown_has_a_block_and_the_pose_within_the_arm_one_before_them() -> None:
    robot = Robot.load("planar-3r")
    blocks = list(formulas(context_of(robot, robot.handout)))
    lines = ["\n".join(row for rows in block.rows for row in rows.lines) for block in blocks]
    assert [text.split(" = ")[0].strip() for text in lines] == ["w_{x}", "q_{123}", "D", "q_{1}", "q_{3}"]
    assert r"\frac{w_{x}^{2} + w_{y}^{2} - a_{1}^{2} - a_{2}^{2}}{2a_{1}a_{2}}" in lines[2]
    assert r"\pm \sqrt{1 - D^{2}}" in lines[2]


def test_of_two_values_the_second_stands_behind_a_word() -> None:
    robot = Robot.load("spherical-wrist")
    text = "\n".join(row for block in formulas(context_of(robot, robot.handout)) for r in block.rows for row in r.lines)
    assert r"\text{or}" in text
