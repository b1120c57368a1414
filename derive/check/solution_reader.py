"""The block ``inverse_kinematics:`` of corpus files."""

from __future__ import annotations

from derive.check import tree
from derive.check.printed import Printed, Solution
from derive.check.remarks import remark
from derive.errors import CheckError
from derive.robot import document
from derive.robot.document import Node, Scalar
from derive.robot.expression import Expression, Name
from derive.robot.names import robot_symbols
from derive.robot.notation import read_formula
from derive.robot.robot import Robot

POSE_NAMES = ("ox", "oy", "oz", *(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)), "sgn")
"""Position and rotation of the end effector, and the printed plus-minus, in formulas of inverse kinematics."""


class SolutionReader:
    """Reads formulas whose names are entries of T.

    Args:
        robot: A name of its own hides the pose's.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        own = {*robot_symbols(robot), *(joint.variable for joint in robot.joints)}
        self.pose: dict[str, Expression] = {name: Name(name) for name in POSE_NAMES if name not in own}

    def solutions(self, node: Node | None) -> tuple[Solution, ...]:
        """The formulas of the block.

        Raises:
            CheckError: A formula, or the structure around it, cannot be read.
        """
        if node is None:
            return ()
        block = tree.mapping(node, "inverse_kinematics", ("formulas",), ("given", "notation", "note"))
        return tuple(self._solution(item) for item in tree.items(block.entries["formulas"][1], "formulas"))

    def _solution(self, node: Node) -> Solution:
        needed = ("unknown", "value", "printed")
        item = tree.mapping(node, "a formula", needed, ("angle", "status", "correct", "kind", "printed_as", "note"))
        correct = tree.child(item, "correct")
        value = tree.scalar(item.entries["value"][1], "value")
        return Solution(
            unknown=tree.scalar(item.entries["unknown"][1], "unknown").text,
            value=self._formula(value, {}),
            printed=self._printed(item, "printed"),
            is_angle=tree.flag(item, "angle"),
            correction=self._printed(item, "correct") if correct else None,
            status=tree.word(item, "status", ("ok", "erratum"), "ok"),
            remark=remark(item),
        )

    def _printed(self, item: document.Mapping, key: str) -> Printed:
        text = tree.scalar(item.entries[key][1], key)
        return Printed(1, 1, text.text, self._formula(text, self.pose), text.inner)

    def _formula(self, text: Scalar, names: dict[str, Expression]) -> Expression:
        try:
            return read_formula(text.text, self.robot, text.inner, names)
        except CheckError as error:
            if text.verbatim:
                raise
            raise CheckError(
                error.found, allowed=error.allowed, remedy=error.remedy, location=text.location
            ) from None
