"""The solution of closed loops as lines and as data: the branch of the file, and where it ends."""

import pytest

from derive.handouts.notation.notation import Notation
from derive.handouts.parts.closure import closure_lines, closure_parts
from derive.model.model import Model
from derive.robot.robot import Robot


@pytest.mark.parametrize("name", ["four-bar", "slider-crank"])
def test_a_branch_is_told_as_the_formula_that_the_sign_of_the_file_takes(name: str) -> None:
    robot = Robot.load(name)
    model = Model(robot)
    lines = closure_lines(model.closure, "text", Notation.of(robot))
    (part,) = closure_parts(model.closure)
    assert any(line.startswith("branch of the file: ") and "+-" not in line for line in lines)
    assert part["by"] == "revolute"
    assert len(part["branch"]) == 1
    assert part["no_value_where_zero"]
    assert "2 solutions (complete)" in lines
