"""The formulas of the inverse kinematics as blocks of a handout."""

from dataclasses import replace

import pytest

from derive.handouts.assemble import context_of
from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.parts.inverse_formulas import formulas
from derive.robot.options.handout import NotationOptions, PoseEntries
from derive.robot.robot import Robot

WITH_AX = """
name: named
convention: standard
joints: [{type: revolute, a: ax}, {type: revolute, a: a2}, {type: revolute, a: a3}]
"""


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


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "spherical-wrist", "stanford-laschi"])
def test_derive_show_prints_the_same_formulas(name: str) -> None:
    context = context_of(Robot.load(name))
    shown = derivation_lines(context.entries.model.inverse, "latex", context.notation)
    known = {" ".join(line.replace("&=", "=").removesuffix("\\\\").split()) for line in shown}
    for block in formulas(context):
        for entry in block.entries:
            printed = " ".join(f"{entry.name} = {entry.latex}".split())
            assert "\\frac" in printed or printed in known


def test_the_rotation_of_the_pose_may_be_written_by_its_columns() -> None:
    robot = Robot.load("scara-perugia")
    options = replace(robot.handout, notation=NotationOptions(pose=PoseEntries.COLUMNS))
    lines = [row for block in formulas(context_of(robot, options)) for rows in block.rows for row in rows.lines]
    assert any("\\operatorname{atan2}(n_{y},\\, n_{x})" in line for line in lines)


def test_columns_that_look_like_symbols_of_the_robot_stay_entries() -> None:
    robot = Robot.from_text(WITH_AX)
    options = replace(robot.handout, notation=NotationOptions(pose=PoseEntries.COLUMNS))
    lines = [row for block in formulas(context_of(robot, options)) for rows in block.rows for row in rows.lines]
    assert any("r_{21}" in line for line in lines)
    assert not any("n_{y}" in line for line in lines)
