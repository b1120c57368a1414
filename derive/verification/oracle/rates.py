"""Rates and derivatives of an arm of numbers, by complex steps: no difference is taken, so nothing cancels.

The angles' rates come from those of the rotation's entries, d atan2(y, x) = (x dy - y dx) / (x^2 + y^2), with the
closed forms of roll, pitch, yaw and Euler ZYZ (Siciliano, Sciavicco, Villani, Oriolo, Robotics, section 2.4).
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from derive.verification.oracle.frames import Array, NumericArm, forward_kinematics, jacobian, task_jacobian
from derive.verification.oracle.lagrange import inertia_matrix
from derive.verification.oracle.newton import inverse_dynamics

STEP = 1e-30  # complex step; the truncation error, its square, vanishes
TILTED = {"rpy": 0, "zyz": 2}  # column of R whose first two entries vanish where the angles are singular


def jacobian_dot(arm: NumericArm, q: Array, qd: Array) -> Array:
    """dJ/dt along qd."""
    return jacobian(arm, q + 1j * STEP * qd).imag / STEP


def jacobian_hessian(arm: NumericArm, q: Array) -> Array:
    """Entry r, i, j: d J_ri / d q_j."""
    return np.moveaxis(_by_joints(arm, q, lambda q: jacobian(arm, q)), -3, -1)


def wrench_torques(arm: NumericArm, q: Array, h: Array) -> Array:
    """J^T h, force first, in the world."""
    return np.asarray((jacobian(arm, q) * h[..., None]).sum(axis=-2))


def wrench_torques_end(arm: NumericArm, q: Array, h: Array) -> Array:
    """The same with h in the axes of the end effector, turned into the world by those of its pose."""
    turn = forward_kinematics(arm, q)[..., :3, :3]
    world = [(turn * part[..., None, :]).sum(axis=-1) for part in (h[..., :3], h[..., 3:])]
    return wrench_torques(arm, q, np.concatenate(world, axis=-1))


def slopes(function: Callable[..., Array], arm: NumericArm, q: Array, h: Array) -> Array:
    """The derivatives of the torques of a wrench by q_j, column j."""
    return np.swapaxes(_by_joints(arm, q, lambda q: function(arm, q, h[..., None, :])), -1, -2)


def task_mobility(arm: NumericArm, q: Array) -> Array:
    """J B^-1 J^T of the rows of the task, the inverse of its inertia."""
    rows = task_jacobian(arm, q)
    return np.asarray(rows @ np.linalg.pinv(inertia_matrix(arm, q)) @ np.swapaxes(rows, -1, -2))


def gram_determinant(arm: NumericArm, q: Array, part: str = "all") -> Array:
    """det(J J^T) of a part of J, or det(J^T J) of more rows than joints that move the end."""
    rows = task_jacobian(arm, q, part)
    turned = np.swapaxes(rows, -1, -2)
    # Joints that do not move the end have columns of zeros, which with a 1 on the diagonal change no determinant.
    is_wide = rows.shape[-2] <= arm.on_way.sum()
    product = rows @ turned if is_wide else turned @ rows + np.diag(1.0 * ~arm.on_way)
    return np.asarray(np.linalg.det(product) * (rows.shape[-2] > 0))


def manipulability(arm: NumericArm, q: Array, part: str = "all") -> Array:
    """The volume to which a part of J takes unit rates of the joints."""
    return np.asarray(np.sqrt(np.abs(gram_determinant(arm, q, part))))


def manipulability_dq(arm: NumericArm, q: Array) -> Array:
    """d w / d q_j, half of that of w^2 over w."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(_by_joints(arm, q, partial(gram_determinant, arm)) / (2 * manipulability(arm, q)[..., None]))


def analytic_jacobian(arm: NumericArm, q: Array, kind: str) -> Array:
    """Derivatives of position and angles: R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll), or Rot(z) Rot(y) Rot(z)."""
    slope, tilted = _by_joints(arm, q, lambda q: forward_kinematics(arm, q)), TILTED[kind]
    r, dr = forward_kinematics(arm, q)[..., None, :3, :3], slope[..., :3, :3]
    with np.errstate(divide="ignore", invalid="ignore"):
        # yaw = atan2(r21, r11), phi = atan2(r23, r13)
        first = _angle_rate(r[..., 1, tilted], r[..., 0, tilted], dr[..., 1, tilted], dr[..., 0, tilted])
        length = np.sqrt((r[..., :2, tilted] ** 2).sum(axis=-1))
        rate = (r[..., :2, tilted] * dr[..., :2, tilted]).sum(axis=-1) / length
        if kind == "rpy":  # roll = atan2(r32, r33), pitch = atan2(-r31, |(r11, r21)|)
            roll = _angle_rate(r[..., 2, 1], r[..., 2, 2], dr[..., 2, 1], dr[..., 2, 2])
            angles = [roll, _angle_rate(-r[..., 2, 0], length, -dr[..., 2, 0], rate), first]
        else:  # theta = atan2(|(r13, r23)|, r33), psi = atan2(r32, -r31)
            psi = _angle_rate(r[..., 2, 1], -r[..., 2, 0], dr[..., 2, 1], -dr[..., 2, 0])
            angles = [first, _angle_rate(length, r[..., 2, 2], rate, dr[..., 2, 2]), psi]
    return np.stack([*[slope[..., k, 3] for k in range(3)], *angles], axis=-2)


def distance_from_singularity(arm: NumericArm, kind: str, q: Array) -> Array:
    """Sine of the angle by which the second turn misses its singular values."""
    # |(r11, r21)| = |cos(pitch)|, |(r13, r23)| = |sin(theta)|
    return np.asarray(np.sqrt((forward_kinematics(arm, q)[..., :2, TILTED[kind]] ** 2).sum(axis=-1)))


def weightless(arm: NumericArm) -> NumericArm:
    """The same without gravity and friction."""
    return replace(arm, gravity=np.zeros(3), viscous=np.zeros(arm.n), coulomb=np.zeros((2, arm.n)))


def inverse_dynamics_dq(arm: NumericArm, q: Array, qd: Array, qdd: Array) -> Array:
    """d tau_i / d q_j."""
    return np.swapaxes(_by_joints(arm, q, lambda q: inverse_dynamics(arm, q, _each(qd), _each(qdd))), -1, -2)


def inverse_dynamics_dqd(arm: NumericArm, q: Array, qd: Array) -> Array:
    """d tau_i / d qd_j; Coulomb friction counts as constant."""
    # No term of the torques holds both qd and qdd, so qdd is taken as zero.
    smooth, rest = replace(arm, coulomb=np.zeros((2, arm.n))), np.zeros_like(_each(q))
    return np.swapaxes(_by_joints(arm, qd, lambda qd: inverse_dynamics(smooth, _each(q), qd, rest)), -1, -2)


def _each(argument: Array) -> Array:
    """The same argument for every direction, (..., 1, n)."""
    return argument[..., None, :]


def _by_joints(arm: NumericArm, q: Array, function: Callable[[Array], Array]) -> Array:
    """The derivatives of a function by each q_j, along the axis behind the batch."""
    return np.asarray(function(_each(q) + 1j * STEP * np.eye(arm.n)).imag / STEP)


def _angle_rate(y: Array, x: Array, dy: Array, dx: Array) -> Array:
    """The derivative of atan2(y, x)."""
    return np.asarray((x * dy - y * dx) / (x * x + y * y))
