"""What a base that moves adds to the torques of an arm: Newton-Euler, started with the motion of the base.

In the axes of the base, a point at r of it accelerates with R^T (p'' - g) + U r, where U = R^T R'' = alpha^ +
omega^ omega^ and omega^ = R^T R'; that is how the recursion of `derive.mechanics.newton_euler` sees a link. Joint
accelerations are multiplied by the same inertia matrix whether the base moves or not, so that the difference of the two
recursions has none of them: it depends on time, position and velocity alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from derive.mechanics.chain import Chain, build_chain, constant_vector
from derive.mechanics.floats import FloatDomain
from derive.mechanics.newton_euler import LinkMotion, angular_acceleration_tensor, inverse_dynamics
from derive.mechanics.vectors import Frame, S, Vector, add, matmul, multiply, subtract, transpose
from derive.motion.bodies import Body, OpenLink
from derive.motion.hermite import Array
from derive.motion.moving_base import BaseCurve
from derive.motion.points import Payload
from derive.programs.tape.build import cut
from derive.programs.tape.graph import Graph
from derive.programs.tape.scalars import QD, TapeDomain
from derive.programs.tape.tape import Tape
from derive.programs.tape.value import Value
from derive.robot.description import Joint
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression
from derive.robot.robot import Robot

BASE = "base"
"""Argument of a tape: the upper three rows of the transform of the base, of its rate and of its second derivative."""


def added_torques(chain: Chain[S], qd: Sequence[S], base: Sequence[Frame[S]], gravity: Vector[S]) -> list[S]:
    """What is added to the torques of the arm on a base that stands, over any scalar type.

    Args:
        chain: The arm at its configuration.
        qd: Velocities of the joints.
        base: The transform of the base, its rate and its second derivative.
        gravity: In the world.
    """
    pose, rate, bend = base
    fixed = chain.base
    back = transpose(matmul(pose.rotation, fixed.rotation))
    spin, tensor = (matmul(back, matmul(each.rotation, fixed.rotation)) for each in (rate, bend))
    x, y, z = omega = (spin[2][1], spin[0][2], spin[1][0])
    alpha = (tensor[2][1] - y * z, tensor[0][2] - x * z, tensor[1][0] - x * y)
    pull = subtract(add(bend.position, multiply(bend.rotation, fixed.position)), gravity)
    found, differences = angular_acceleration_tensor(omega, alpha)
    motion = LinkMotion(omega, alpha, found, multiply(back, pull), differences)
    still = [chain.zero] * chain.n
    moving, standing = (inverse_dynamics(chain, qd, still, base=each) for each in (motion, None))
    return [a - b for a, b in zip(moving, standing, strict=True)]


class ArrayDomain(FloatDomain):
    """Cells of a robot as floats, at many configurations at once.

    Args:
        robot: The robot.
        q: Joint variables [rad or m], (..., n).
        values: Numbers of the parameters.
    """

    def __init__(self, robot: Robot, q: Array, values: Mapping[str, float]) -> None:
        columns: Any = tuple(np.moveaxis(q, -1, 0))
        super().__init__(robot, columns, values)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Any, Any]:
        """Cosine and sine of the angle of a revolute joint.

        Args:
            index: Number of the joint, from 0.
            joint: Its row of the table.
        """
        value = joint.sign * self.q[index] + self.constant(joint.theta)
        return np.cos(value), np.sin(value)


class NumberedDomain(TapeDomain):
    """Cells of a robot as numbers on a graph, and its configuration as arguments.

    Args:
        robot: The robot.
        graph: Where the values live.
        values: Numbers of the parameters.
    """

    def __init__(self, robot: Robot, graph: Graph, values: Mapping[str, float]) -> None:
        super().__init__(robot, graph)
        self._values = values

    def constant(self, expression: Expression) -> Value:
        """The value of a cell.

        Args:
            expression: Of the robot's symbols.
        """
        return self.number(Fraction(evaluate(expression, self._values)))


@dataclass(frozen=True)
class BaseTorques:
    """Torques that an arm needs since its base moves.

    Attributes:
        robot: The robot; its gravity is that of the world in which the base moves.
        values: Numbers of all symbols.
        base: The motion of its base.
        duration: How long it moves [s]; before and after it stands.
    """

    robot: Robot
    values: Mapping[str, float]
    base: BaseCurve
    duration: float

    def _carrying(self, *payloads: Payload | None) -> tuple[Robot, Mapping[str, float]]:
        """The robot whose last link is as heavy as with what the tool carries."""
        if not any(payloads):
            return self.robot, self.values
        link, carried = OpenLink.of(self.robot), Body.last_link(self.robot, self.values)
        for payload in filter(None, payloads):
            carried += Body.payload(self.robot, payload, self.values)
        return link.robot, {**self.values, **link.values(carried)}

    def __call__(self, t: Array, q: Array, qd: Array, payload: Payload | None = None) -> Array:
        """What is added to the torques of the arm on a base that stands.

        Args:
            t: Times [s], (times,).
            q: Joint variables, (times, n).
            qd: Their velocities, (times, n).
            payload: What the tool carries.

        Returns:
            (times, n) [N m or N].
        """
        robot, values = self._carrying(payload)
        domain = ArrayDomain(robot, q, values)
        inside = np.clip(t, 0.0, self.duration)
        base = np.array([self.base(inside, order) for order in range(3)])
        base[1:, inside != t] = 0.0
        frames = [_frame([list(row) for row in np.moveaxis(each[:, :3], 0, -1)]) for each in base]
        gravity: Any = constant_vector(robot.gravity, domain) if robot.gravity else (0.0, 0.0, 0.0)
        chain: Chain[Any] = build_chain(robot, domain)
        torques = added_torques(chain, tuple(np.moveaxis(qd, -1, 0)), frames, gravity)
        return np.stack([np.broadcast_to(torque, t.shape) for torque in torques], axis=-1)

    def single(self, *payloads: Payload | None) -> Callable[[float, Array, Array], Array]:
        """The same at one time, without the cost of arrays.

        Args:
            *payloads: What the tool carries.

        Returns:
            A function of the time [s], joint variables and velocities, (n,) each.
        """
        robot, values = self._carrying(*payloads)

        def _at(t: float, q: Array, qd: Array) -> Array:
            domain = FloatDomain(robot, q.tolist(), values)
            inside = min(max(t, 0.0), self.duration)
            pose, *rates = self.base.single(inside)
            if inside != t:
                rates = [[[0.0] * 4] * 4] * 2
            frames = [_frame(rows) for rows in (pose, *rates)]
            gravity = constant_vector(robot.gravity, domain) if robot.gravity else (0.0, 0.0, 0.0)
            return np.array(added_torques(build_chain(robot, domain), qd.tolist(), frames, gravity))

        return _at

    def tape(self, payload: Payload | None = None) -> Tape:
        """The same as a program with the arguments ``q``, ``qd`` and `BASE`.

        Args:
            payload: What the tool carries.
        """
        robot, values = self._carrying(payload)
        graph = Graph()
        domain = NumberedDomain(robot, graph, values)
        frames = [
            _frame([[domain.argument(BASE, 12 * order + 4 * i + j) for j in range(4)] for i in range(3)])
            for order in range(3)
        ]
        zero = domain.number(0)
        gravity = constant_vector(robot.gravity, domain) if robot.gravity else (zero, zero, zero)
        rates = [domain.argument(QD, j) for j in range(robot.n)]
        torques = added_torques(build_chain(robot, domain), rates, frames, gravity)
        return cut(graph, [torque.ref for torque in torques])


def _frame(rows: Sequence[Sequence[Any]]) -> Frame[Any]:
    """Three rows of four entries as a frame; of a derivative no transform, and yet of that form."""
    a, b, c = ((row[0], row[1], row[2]) for row in rows[:3])
    return Frame((a, b, c), (rows[0][3], rows[1][3], rows[2][3]))
