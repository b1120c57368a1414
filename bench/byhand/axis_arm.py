"""A robot in frames on its joint axes, its inertial parameters about their origins.

Frame i follows Rot(x, alpha_i) Trans(x, a_i) Rot(z, theta_i) Trans(z, d_i) from frame i-1: the modified convention. A
table of the standard convention is read as a_{i-1}, alpha_{i-1} of its row before, its last row becomes the end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from bench.byhand.symbols import Arithmetic
from derive.robot.description import IDENTITY, Convention, Joint, Link
from derive.robot.expression import ZERO, Expression
from derive.robot.robot import Robot

Vector = tuple[Any, Any, Any]
Rows = tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Body:
    """Ten inertial parameters in the axes of a frame: mass, first moment, inertia about the frame's origin."""

    mass: Any
    moment: Vector
    inertia: Rows


@dataclass(frozen=True)
class Axis:
    """One joint: the step to its axis, and its body."""

    cos_alpha: Any
    sin_alpha: Any
    a: Any
    theta: Any
    d: Any
    sign: int
    revolute: bool
    body: Body


@dataclass(frozen=True)
class AxisArm:
    """A chain of axes.

    Attributes:
        axes: The joints from the base outwards.
        end: cos alpha, sin alpha and a of the step from the last axis to the end effector.
        gravity: Acceleration of gravity in the base frame.
    """

    axes: tuple[Axis, ...]
    end: tuple[Any, Any, Any]
    gravity: Vector

    def with_bodies(self, bodies: list[Body]) -> AxisArm:
        """The same chain with other bodies."""
        axes = tuple(replace(axis, body=body) for axis, body in zip(self.axes, bodies, strict=True))
        return replace(self, axes=axes)


def axis_arm(robot: Robot, system: Arithmetic, values: Mapping[str, Any]) -> AxisArm:
    """A robot in joint-axis frames.

    Args:
        robot: The robot; without base, tool, motors and friction.
        system: The arithmetic.
        values: A number or symbol for every name of the file.

    Raises:
        NotImplementedError: The robot has what these recursions leave out.
    """
    if robot.base != IDENTITY or robot.tool != IDENTITY or any(_has_drive(link) for link in robot.links):
        raise NotImplementedError("base, tool, motors and friction are left out by hand")
    return _Reader(robot, system, values).arm()


def _has_drive(link: Link) -> bool:
    return link.motor is not None or any(cell != ZERO for cell in (link.armature, link.viscous, link.coulomb))


class _Reader:
    def __init__(self, robot: Robot, system: Arithmetic, values: Mapping[str, Any]) -> None:
        self.robot, self.system, self.values = robot, system, values
        self.standard = robot.convention is Convention.STANDARD

    def arm(self) -> AxisArm:
        steps = [self.step(joint) for joint in self.robot.joints]
        one, zero = self.system.number(1.0), self.system.number(0.0)
        still = (one, zero, zero)
        before = [still, *steps[:-1]] if self.standard else steps
        end = steps[-1] if self.standard else still
        links = self.robot.links or (Link(),) * self.robot.n
        axes = tuple(
            self.axis(joint, step, self.body(link, own if self.standard else still))
            for joint, step, own, link in zip(self.robot.joints, before, steps, links, strict=True)
        )
        return AxisArm(axes, end, self.vector(self.robot.gravity or (ZERO, ZERO, ZERO)))

    def axis(self, joint: Joint, step: Vector, body: Body) -> Axis:
        theta, d = self.cell(joint.theta), self.cell(joint.d)
        return Axis(*step, theta, d, int(joint.sign), joint.is_revolute, body)

    def step(self, joint: Joint) -> Vector:
        cos, sin = (self.system.sine(joint.alpha, self.values, name) for name in ("cos", "sin"))
        return cos, sin, self.cell(joint.a)

    def body(self, link: Link, step: Vector) -> Body:
        """A link's parameters, moved from its DH frame to the frame on its axis."""
        i = link.inertia
        central = tuple(self.vector(row) for row in ((i.xx, i.xy, i.xz), (i.xy, i.yy, i.yz), (i.xz, i.yz, i.zz)))
        mass, (x, y, z) = self.cell(link.mass), turned(step, self.vector(link.com))
        com = (x + step[2], y, z)
        tensor = turned_tensor(step, central)
        return Body(mass, tuple(mass * c for c in com), added(tensor, steiner(mass, com, com)))

    def vector(self, cells: tuple[Expression, ...]) -> Vector:
        x, y, z = (self.cell(cell) for cell in cells)
        return x, y, z

    def cell(self, expression: Expression) -> Any:
        return self.system.value(expression, self.values)


def turned(step: Vector, v: Vector) -> Vector:
    """Rot(x, alpha) v."""
    cos, sin, _ = step
    return v[0], cos * v[1] - sin * v[2], sin * v[1] + cos * v[2]


def turned_tensor(step: Vector, tensor: Rows) -> Rows:
    """Rot(x, alpha) tensor Rot(x, alpha)^T."""
    columns = [turned(step, row) for row in tensor]
    rows = [turned(step, column) for column in zip(*columns, strict=True)]
    return rows[0], rows[1], rows[2]


def steiner(mass: Any, p: Vector, r: Vector) -> Rows:
    """mass (p.r 1 - p r^T), symmetric for parallel p and r."""
    dot = p[0] * r[0] + p[1] * r[1] + p[2] * r[2]
    rows = [tuple(mass * ((dot if i == j else 0) - p[i] * r[j]) for j in range(3)) for i in range(3)]
    return rows[0], rows[1], rows[2]


def added(x: Rows, y: Rows) -> Rows:
    """x + y."""
    rows = [tuple(p + r for p, r in zip(u, v, strict=True)) for u, v in zip(x, y, strict=True)]
    return rows[0], rows[1], rows[2]
