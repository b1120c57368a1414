"""What every target is rendered from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from derive.algebra.program import Program
from derive.emit.handout.context import Numbers, Poses
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Source:
    """One robot, ready to be printed.

    Attributes:
        robot: The robot.
        program: Its functions as tapes.
        quantities: Closed forms by name, for the targets that print formulas.
        version: Version of the tool, stated in every output.
        files: Names of all files of this build, for the page that lists them.
        poses: Where the frames of the robot are, for figures; None where nothing is drawn.
        numbers: Values of the closed forms at a configuration, for the example; None where there is none.
    """

    robot: Robot
    program: Program
    quantities: Mapping[str, Any]
    version: str
    files: tuple[str, ...] = ()
    poses: Poses | None = None
    numbers: Numbers | None = None
