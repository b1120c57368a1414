"""The block ``inverse_kinematics:`` of corpus files."""

from __future__ import annotations

from dataclasses import replace

from derive.check import tree
from derive.check.printed import Printed, Solution
from derive.check.printed_reader import NO_NAMES, Vocabulary, read_printed
from derive.check.remarks import remark
from derive.robot import document
from derive.robot.document import Node
from derive.robot.expression import Name
from derive.robot.names import robot_symbols
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
        self.pose = Vocabulary({name: Name(name) for name in POSE_NAMES if name not in own})

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
        value = self._printed(item, "value", NO_NAMES)
        return Solution(
            unknown=tree.scalar(item.entries["unknown"][1], "unknown").text,
            value=value.formula,
            printed=_lacking(self._printed(item, "printed", self.pose), value),
            is_angle=tree.flag(item, "angle"),
            correction=_lacking(self._printed(item, "correct", self.pose), value) if correct else None,
            status=tree.word(item, "status", ("ok", "erratum"), "ok"),
            remark=remark(item),
        )

    def _printed(self, item: document.Mapping, key: str, further: Vocabulary) -> Printed:
        return read_printed(tree.scalar(item.entries[key][1], key), self.robot, further)


def _lacking(printed: Printed, value: Printed) -> Printed:
    """A formula about whose value nothing is known cannot be decided either."""
    return replace(printed, unknown=printed.unknown or value.unknown)
