"""The bodies of a robot, links and rotors, and the part with their Jacobians."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from derive.handouts import groups
from derive.handouts.context import Context
from derive.handouts.document import Block, Paragraph
from derive.handouts.formula import BodyItem, body_formulas
from derive.handouts.notation.pieces import Box, italic, script
from derive.handouts.notation.symbols import bold
from derive.handouts.textbook import textbook
from derive.robot.description import Inertia, Link
from derive.robot.expression import ZERO
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Body:
    """A link or a rotor that has mass or inertia.

    Attributes:
        place: Its place among the bodies, from 0.
        index: Its link or joint, from 1.
        is_rotor: Whether it is the rotor of a motor.
    """

    place: int
    index: int
    is_rotor: bool

    def symbol(self, letter: str, sub: str = "") -> Box:
        """A matrix or vector of the body: B_{l_1}, p_{m_2}, or J_v^{l_1}.

        Args:
            letter: The matrix or vector.
            sub: What stands below, if the body stands above.

        Returns:
            Its name.
        """
        body = italic(f"{'m' if self.is_rotor else 'l'}_{{{self.index}}}")
        return script(bold(letter), italic(sub), body) if sub else script(bold(letter), body)


def bodies(robot: Robot) -> tuple[Body, ...]:
    """Links with mass or inertia, each followed by the rotor of its joint.

    Args:
        robot: The robot.

    Returns:
        Its bodies.
    """
    found: list[tuple[int, bool]] = []
    for i, link in enumerate(robot.links, 1):
        if link.mass != ZERO or link.inertia != Inertia():
            found.append((i, False))
        if has_rotor(link):
            found.append((i, True))
    return tuple(Body(place, *body) for place, body in enumerate(found))


def has_rotor(link: Link) -> bool:
    """Whether the motor of a joint has a rotor with mass or inertia.

    Args:
        link: The link that the joint moves.

    Returns:
        True if it has.
    """
    return link.motor is not None and (link.motor.mass != ZERO or link.motor.inertia != ZERO)


def has_rotors(robot: Robot) -> bool:
    """Whether any joint has a rotor with mass or inertia.

    Args:
        robot: The robot.

    Returns:
        True if one has.
    """
    return any(map(has_rotor, robot.links))


def link_jacobians(context: Context) -> Iterator[Block]:
    """J_v and J_w of every link and rotor.

    Args:
        context: The handout.

    Yields:
        The blocks of the part.
    """
    _ = context.text
    yield Paragraph(
        _(
            "In the world frame, $\\mathbf{p}_{l_i}$ being the centre of mass of link $i$. Column $j$ is the velocity "
            "of that point, and the angular velocity of the link, per unit of $\\dot{q}_j$; it is zero for $j > i$, "
            "for a joint does not move the links before it."
        )
    )
    joints = context.robot.joints
    yield textbook(
        "link_jacobians",
        k="j-1" if context.is_standard else "j",
        revolute=_("revolute") if any(joint.is_revolute for joint in joints) else "",
        prismatic=_("prismatic") if not all(joint.is_revolute for joint in joints) else "",
    )
    opposed = ", ".join(f"${i}$" for i, joint in enumerate(joints, 1) if joint.sign < 0)
    if opposed:
        yield Paragraph(
            _(
                "The variables of these joints count against their axes, and their columns change sign: %(joints)s.",
                joints=opposed,
            )
        )
    if has_rotors(context.robot):
        yield Paragraph(
            _(
                "The rotor that drives joint $i$ sits on its axis $\\mathbf{z}_{m_i}$ at $\\mathbf{p}_{m_i}$, is "
                "carried by link $i-1$ and spins at $k_{r_i}\\dot{q}_i$: columns $j < i$ are those of a point of link "
                "$i-1$, column $i$ is the spin, the others are zero."
            )
        )
        yield textbook("rotor_jacobians")
    items = []
    for body in bodies(context.robot):
        linear = context.entries.linear_jacobian(body.index, body.is_rotor)
        angular = context.entries.angular_jacobian(body.index, body.is_rotor)
        items.append(BodyItem(body.symbol("J", "v"), linear, groups.body(body.place, 1)))
        items.append(BodyItem(body.symbol("J", "\\omega"), angular, groups.body(body.place, 2)))
    yield from body_formulas(context, items)
