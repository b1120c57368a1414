"""Parts of a robot: the symbols of its inertia, one link alone."""

from __future__ import annotations

from dataclasses import replace

from derive.robot.expression import names
from derive.robot.robot import Link, Robot


def inertial_symbols(robot: Robot) -> frozenset[str]:
    """Symbols of masses and moments of inertia, by which dynamics is grouped."""
    found: set[str] = set()
    for link in robot.links:
        t = link.inertia
        cells = [link.mass, t.xx, t.yy, t.zz, t.xy, t.xz, t.yz, link.armature]
        if link.motor is not None:
            cells += [link.motor.mass, link.motor.inertia]
        for cell in cells:
            found.update(names(cell))
    return frozenset(found)


def gravity_symbols(robot: Robot) -> frozenset[str]:
    """Symbols of the acceleration of gravity."""
    return frozenset(name for cell in robot.gravity or () for name in names(cell))


def only_link(robot: Robot, i: int) -> Robot:
    """The robot with the body of link i (from 1) alone: every other link massless, no rotor at all."""
    link = replace(robot.links[i - 1], motor=None, armature=Link().armature)
    links = tuple(link if k == i else Link() for k in range(1, robot.n + 1))
    return replace(robot, links=links)


def only_rotor(robot: Robot, i: int) -> Robot:
    """The robot with the rotor of joint i (from 1) alone: every link massless, no armature."""
    rotor = Link(motor=robot.links[i - 1].motor)
    links = tuple(rotor if k == i else Link() for k in range(1, robot.n + 1))
    return replace(robot, links=links)
