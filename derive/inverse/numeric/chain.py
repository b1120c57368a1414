"""An arm of numbers, and how far its configurations are from a pose, with exact derivatives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.vectors import Frame
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.robot import Robot

Array = npt.NDArray[Any]

Entries = tuple[tuple[int, int], ...]  # rows and columns of T, from 0, that a task prescribes
POSE: Entries = tuple((i, j) for i in range(3) for j in range(4))
POSITION: Entries = ((0, 3), (1, 3), (2, 3))


@dataclass(frozen=True, eq=False)
class NumericChain:
    """A numeric arm: T = C_1 M_1 C_2 M_2 ... C_n M_n tool, M_i turning about z or sliding along it."""

    revolute: Array  # (n,) whether joint i turns
    sign: Array  # (n,) +1 or -1, the factor of the variable
    fixed: Array  # (n, 4, 4) C_i, the base in the first one
    tool: Array  # (4, 4) what follows the last joint
    limits: Array  # (n, 2) joint limits, infinite where the file gives none

    @classmethod
    def of(cls, robot: Robot, parameters: Mapping[str, float] | None = None) -> NumericChain:
        """The numbers of a robot."""
        values = parameter_values(robot, parameters)
        chain = build_chain(replace(robot, links=(), gravity=None), FloatDomain(robot, [0.0] * robot.n, values))
        fixed = [_matrix(joint.fixed @ joint.motion(0.0, 1.0)) for joint in chain.joints]
        fixed[0] = _matrix(chain.base) @ fixed[0]
        unbounded = (-math.inf, math.inf)
        limits = [[to_float(x, values) for x in joint.limits] if joint.limits else unbounded for joint in robot.joints]
        return cls(
            revolute=np.array([joint.revolute for joint in chain.joints]),
            sign=np.array([float(joint.sign) for joint in chain.joints]),
            fixed=np.array(fixed),
            tool=_matrix(chain.tool),
            limits=np.array(limits, dtype=float),
        )

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.sign)

    @cached_property
    def reach(self) -> float:
        """The sum of all constant distances [m], 1 where there is none: the arm's unit of length."""
        links = np.linalg.norm(self.fixed[1:, :3, 3], axis=-1).sum() + np.linalg.norm(self.tool[:3, 3])
        return float(links) or 1.0

    def pose_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """T and its derivatives by the joint variables, along the recursion."""
        pose = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
        axes, places = [], []
        for i in range(self.n):
            pose = pose @ self.fixed[i]
            axis, place = pose[..., :3, 2].copy(), pose[..., :3, 3].copy()
            moved = self.sign[i] * q[..., i, None]
            if self.revolute[i]:
                x, y = pose[..., :3, 0].copy(), pose[..., :3, 1].copy()
                cosine, sine = np.cos(moved), np.sin(moved)
                pose[..., :3, 0], pose[..., :3, 1] = cosine * x + sine * y, cosine * y - sine * x
            else:
                pose[..., :3, 3] += moved * axis
            axes.append(self.sign[i] * axis)
            places.append(place)
        pose = pose @ self.tool
        # dR/dq = [z]x R and dp/dq = z x (p - o); of a slide 0 and z (Siciliano et al., section 3.1.3).
        z, o = np.stack(axes, axis=-2), np.stack(places, axis=-2)
        turning = self.revolute[:, None]
        rotation = cross_matrix(z * turning) @ pose[..., None, :3, :3]
        shift = np.where(turning, np.cross(z, pose[..., None, :3, 3] - o), z)
        slope = np.concatenate([rotation, shift[..., None]], axis=-1)
        return pose, slope


@dataclass(frozen=True, eq=False)
class Problem:
    """Which joints reach wanted entries of the pose, the others being given."""

    chain: NumericChain  # the arm
    poses: Array  # (4, 4), or one for each configuration that is tried
    entries: Entries = POSE  # the entries of T that are wanted
    free: Array = field(default_factory=lambda: np.array([], dtype=bool))  # (n,) the joints that are solved for

    @cached_property
    def unit(self) -> Array:
        """Unit of length of each pose [m]: the reach, or how far the goal is."""
        far = np.abs(self.poses[..., :3, 3]).max(axis=-1)
        return np.maximum(self.chain.reach, np.where(np.isfinite(far), far, 0.0))

    @cached_property
    def scale(self) -> Array:
        """(..., n) unit of each joint variable: 1 rad, or the unit of length."""
        return np.where(self.chain.revolute, 1.0, self.unit[..., None])

    def errors(self, q: Array) -> tuple[Array, Array]:
        """How far the wanted entries are from the goal, and the derivatives by the free joints, without units."""
        pose, slope = self.chain.pose_and_jacobian(q)
        rows, columns = (list(index) for index in zip(*self.entries, strict=True))
        weight = np.where(np.array(columns) == 3, 1.0 / self.unit[..., None], 1.0)
        difference: Array = pose - self.poses
        error = difference[..., rows, columns] * weight
        by_joint = slope[..., rows, columns] * weight[..., None, :] * self.scale[..., :, None]
        return error, np.swapaxes(by_joint[..., self.free, :], -1, -2)

    def moved(self, q: Array, step: Array) -> Array:
        """Configurations after a step of the free joints."""
        result = q.copy()
        result[..., self.free] += step * self.scale[..., self.free]
        return result

    def residual(self, q: Array) -> Array:
        """The largest error of an entry, without units."""
        worst: Array = np.abs(self.errors(q)[0]).max(axis=-1)
        return worst


def cross_matrix(v: Array) -> Array:
    """(..., 3, 3) the matrix S with S u = v x u."""
    matrix: Array = np.cross(np.eye(3), v[..., None, :])
    return matrix


def _matrix(frame: Frame[float]) -> Array:
    """A frame as a (4, 4) matrix."""
    return np.array([[float(entry) for entry in row] for row in frame.rows(0.0, 1.0)])
