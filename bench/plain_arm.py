"""A robot's numbers in frames on its joint axes, as tools take them that know no Denavit-Hartenberg table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.robots import Array, Case
from derive.verification.oracle.frames import NumericArm


@dataclass(frozen=True, eq=False)
class PlainJoint:
    """One joint, moving about or along z of its own frame, and the body that it moves.

    Attributes:
        placement: (4, 4) from the frame of the joint before, at position 0.
        revolute: Whether it turns.
        sign: Factor of the variable.
        mass: Of the body.
        com: (3,) centre of mass.
        inertia: (3, 3) about the centre of mass.
    """

    placement: Array
    revolute: bool
    sign: float
    mass: float
    com: Array
    inertia: Array


@dataclass(frozen=True, eq=False)
class PlainArm:
    """The joints from the base outwards, the end effector in the last joint's frame, and gravity."""

    joints: tuple[PlainJoint, ...]
    end: Array
    gravity: Array


def plain_arm(case: Case) -> PlainArm:
    """The numbers of a robot without motors and friction.

    Raises:
        NotImplementedError: It has motors or friction.
    """
    arm = case.oracle.arm
    if any(np.any(v) for v in (arm.rotor_inertia, arm.rotor_mass, arm.armature, arm.viscous, arm.coulomb)):
        raise NotImplementedError("motors and friction are left out")
    steps = [_step(arm, i) for i in range(arm.n)]
    bodies = steps if arm.standard else [np.eye(4)] * arm.n
    before = [np.eye(4), *steps[:-1]] if arm.standard else steps
    joints = tuple(_joint(arm, i, before[i], bodies[i]) for i in range(arm.n))
    end = (steps[-1] if arm.standard else np.eye(4)) @ arm.tool
    return PlainArm(joints, end, np.asarray(arm.gravity, dtype=float))


def _joint(arm: NumericArm, i: int, before: Array, body: Array) -> PlainJoint:
    placement = before @ _screw(2, arm.theta[i], arm.d[i])
    if i == 0:
        placement = arm.base @ placement
    turn, shift = body[:3, :3], body[:3, 3]
    com, inertia = turn @ arm.com[i] + shift, turn @ arm.inertia[i] @ turn.T
    return PlainJoint(placement, bool(arm.revolute[i]), float(arm.sign[i]), float(arm.mass[i]), com, inertia)


def _step(arm: NumericArm, i: int) -> Array:
    return _screw(0, arm.alpha[i], arm.a[i])


def _screw(axis: int, angle: float, distance: float) -> Array:
    """Rotation about and translation along an axis; right angles are exact."""
    cos, sin = (_exact(value) for value in (np.cos(angle), np.sin(angle)))
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(4)
    matrix[j, j], matrix[j, k], matrix[k, j], matrix[k, k] = cos, -sin, sin, cos
    matrix[axis, 3] = distance
    return matrix


def _exact(value: float) -> float:
    return float(round(value)) if abs(value - round(value)) < 1e-15 else float(value)
