"""What a base that moves adds to the torques of an arm: Newton-Euler, started with the motion of the base.

In the axes of the base, a point at r of it accelerates with R^T (p'' - g) + U r, where U = R^T R'' = alpha^ +
omega^ omega^ and omega^ = R^T R'; that is how the recursion of `derive.mechanics.newton_euler` sees a link. Joint
accelerations are multiplied by the same inertia matrix whether the base moves or not, so that the difference of the two
recursions has none of them: it depends on time, position and velocity alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.newton_euler import LinkMotion, angular_acceleration_tensor, inverse_dynamics
from derive.motion.bodies import Body, OpenLink
from derive.motion.hermite import Array
from derive.motion.moving_base import BaseCurve
from derive.motion.points import Payload
from derive.robot.description import Joint
from derive.robot.evaluate import evaluate
from derive.robot.robot import Robot


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


class BaseTorques:
    """Torques that an arm needs since its base moves.

    Args:
        robot: The robot; its gravity is that of the world in which the base moves.
        values: Numbers of all symbols.
        base: The motion of its base.
    """

    def __init__(self, robot: Robot, values: Mapping[str, float], base: BaseCurve) -> None:
        self._robot = robot
        self._values = values
        self._base = base

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
        robot, values = self._robot, dict(self._values)
        if payload is not None:
            link = OpenLink.of(robot)
            carried = Body.last_link(robot, values) + Body.payload(robot, payload, values)
            robot, values = link.robot, values | link.values(carried)
        chain: Chain[Any] = build_chain(robot, ArrayDomain(robot, q, values))
        rates = tuple(np.moveaxis(qd, -1, 0))
        still = [0.0] * robot.n
        moving = inverse_dynamics(chain, rates, still, base=self._motion(chain, t))
        standing = inverse_dynamics(chain, rates, still)
        return np.stack([np.broadcast_to(a - b, t.shape) for a, b in zip(moving, standing, strict=True)], axis=-1)

    def _motion(self, chain: Chain[Any], t: Array) -> LinkMotion[Any]:
        """The motion of frame 0, in its own axes."""
        pose, rate, bend = (self._base(t, order) for order in range(3))
        place = np.array(chain.base.position)
        axes = np.swapaxes(pose[:, :3, :3] @ np.array(chain.base.rotation), 1, 2)
        gravity = np.array([evaluate(cell, self._values) for cell in self._robot.gravity or ()] or [0.0] * 3)
        spin = axes @ rate[:, :3, :3] @ np.array(chain.base.rotation)
        tensor = axes @ bend[:, :3, :3] @ np.array(chain.base.rotation)
        acceleration = bend[:, :3, 3] - gravity + bend[:, :3, :3] @ place
        omega, alpha = _axial(spin), _axial(tensor)
        found, differences = angular_acceleration_tensor(omega, alpha)
        return LinkMotion(omega, alpha, found, tuple(np.einsum("tij,tj->it", axes, acceleration)), differences)


def _axial(matrix: Array) -> tuple[Any, Any, Any]:
    """The vector of the antisymmetric part of matrices, its three components."""
    skew = (matrix - np.swapaxes(matrix, 1, 2)) / 2
    return skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]
