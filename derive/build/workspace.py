"""Points that the end effector of a robot reaches, at random configurations within the joints' limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from derive.build.poses import RobotPoses

Array = npt.NDArray[np.float64]

AT_A_LIMIT = 0.25
"""Part of the samples of a joint that lie at one of its limits or at zero: the boundary is reached there."""


@dataclass(frozen=True, slots=True)
class Assumption:
    """Limits taken for a joint that has none in the file.

    Attributes:
        variable: The joint's variable.
        lower: Lower limit [rad or m].
        upper: Upper limit [rad or m].
        unit: ``rad`` or ``m``.
    """

    variable: str
    lower: float
    upper: float
    unit: str


@dataclass(frozen=True, eq=False)
class Workspace:
    """A cloud of positions.

    Attributes:
        points: (3, samples) seen from the axis of joint 1: z along it, x and y across [m].
        assumed: Limits that the file does not give.
    """

    points: Array
    assumed: tuple[Assumption, ...]


def sample_workspace(poses: RobotPoses, samples: int, seed: int) -> Workspace:
    """Positions at random configurations; the same seed gives the same points.

    Joints without limits turn from -pi to pi, and slide from 0 to the longest length of the arm.

    Args:
        poses: The robot in numbers.
        samples: Number of configurations.
        seed: Of the random numbers.
    """
    ranges, assumed = [], []
    for joint, limits in zip(poses.robot.joints, poses.limits, strict=True):
        if limits is None:
            limits = (-math.pi, math.pi) if joint.is_revolute else (0.0, poses.longest)
            assumed.append(Assumption(joint.variable, *limits, "rad" if joint.is_revolute else "m"))
        ranges.append(limits)
    rng = np.random.default_rng(seed)
    q = np.stack([_spread(rng, low, high, samples) for low, high in ranges])
    if poses.robot.joints[0].is_revolute:  # it turns the cloud as a whole
        q[0] = rng.uniform(*ranges[0], samples)
    rotation, origin = poses.first_axis
    points: Array = np.array(rotation).T @ (poses.positions(q) - np.array(origin)[:, None])
    return Workspace(points, tuple(assumed))


def _spread(rng: np.random.Generator, low: float, high: float, samples: int) -> Array:
    values = rng.uniform(low, high, samples)
    special = np.array([low, high, min(max(0.0, low), high)])
    chosen = special[rng.integers(0, len(special), samples)]
    return np.where(rng.random(samples) < AT_A_LIMIT, chosen, values)
