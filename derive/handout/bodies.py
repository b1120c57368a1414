"""The bodies of a robot: its links, and the rotors of its motors."""

from __future__ import annotations

from dataclasses import dataclass

from derive.robot.description import Inertia, Link
from derive.robot.expression import ZERO
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Body:
    """A link or a rotor that has mass or inertia.

    Attributes:
        kind: ``link`` or ``motor``, as in the names of quantities.
        index: Its link or joint, from 1.
    """

    kind: str
    index: int

    @property
    def is_rotor(self) -> bool:
        """Whether it is the rotor of a motor."""
        return self.kind == "motor"

    @property
    def letter(self) -> str:
        """How it is called in indices: l or m."""
        return "m" if self.is_rotor else "l"

    @property
    def point(self) -> str:
        """``com`` or ``motor``, as in the names of Jacobians."""
        return "motor" if self.is_rotor else "com"


def bodies(robot: Robot) -> tuple[Body, ...]:
    """Links with mass or inertia, each followed by the rotor of its joint."""
    found: list[Body] = []
    for i, link in enumerate(robot.links, 1):
        if link.mass != ZERO or link.inertia != Inertia():
            found.append(Body("link", i))
        if has_rotor(link):
            found.append(Body("motor", i))
    return tuple(found)


def has_rotor(link: Link) -> bool:
    """Whether the joint's motor has a rotor with mass or inertia."""
    return link.motor is not None and (link.motor.mass != ZERO or link.motor.inertia != ZERO)
