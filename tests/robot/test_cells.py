"""Cells in degrees and millimetres mean what the same cells mean in radians and metres."""

from math import pi

import pytest

from derive.errors import DeriveError, Location
from derive.robot.cells import angle_in_radians, joint_values
from derive.robot.description import FileUnits
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot

DEGREES, MILLIMETRES, PLAIN = FileUnits(degrees=True), FileUnits(millimetres=True), FileUnits()
VALUES = {"a1": 0.3, "beta": 0.7}


def cell(text: str) -> Expression:
    return parse_expression(text, Location("arm.yaml"))


@pytest.mark.parametrize(
    ("text", "radians"),
    [
        ("30*t", "pi*t/6"),
        ("30 + 10*t", "pi/6 + pi*t/18"),
        ("45*sin(2*t)", "pi/4*sin(2*t)"),
        ("a + 90*t", "a + pi/2*t"),
        ("a*t", "a*t"),
    ],
)
def test_terms_of_names_without_a_unit_are_in_the_units_of_the_file(text: str, radians: str) -> None:
    """The time in a formula is such a name."""
    found = angle_in_radians(cell(text), DEGREES, frozenset({"t"}))
    for t in (0.0, 0.7, 2.0):
        values = {"t": t, "a": 0.4}
        assert evaluate(found, values) == pytest.approx(evaluate(cell(radians), values), rel=1e-15)


def test_joint_values_are_in_the_units_of_the_file() -> None:
    rows = "joints: [{type: revolute}, {type: prismatic}]\n"
    head = "name: arm\nconvention: standard\n"
    robot = Robot.from_text(head + "units: {angle: deg, length: mm}\n" + rows)
    assert [evaluate(v, {}) for v in joint_values(robot, [90, "250"])] == pytest.approx([pi / 2, 0.25])
    plain = Robot.from_text(head + rows)
    assert [evaluate(v, {}) for v in joint_values(plain, ["pi/2", "1/4"])] == pytest.approx([pi / 2, 0.25])
    for arm, texts, words in (
        (plain, ["1"], "2 joint values are needed, 1 given"),
        (plain, ["1", "a1"], "value 'a1' of q2 holds a name"),
        (plain, ["1", "2, 3"], "value '2, 3' of q2: unexpected ','"),
        (robot, ["pi/2", "0"], "pi in the value 'pi/2' of q1"),
    ):
        with pytest.raises(DeriveError, match=words):
            joint_values(arm, texts)
