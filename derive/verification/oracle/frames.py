"""An arm as plain numbers, and its frames.

The DH table, the frames around it and the inertial parameters are arrays. Frames and Jacobians come straight from the
definitions.

Every function takes configurations ``(..., n)``, real or complex: complex ones serve to differentiate by complex step,
so nothing here conjugates. Inside, everything is in frame 0; the base transform is applied last.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.robot.description import Convention, Link, Motor
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import ZERO, Expression
from derive.robot.options.inverse import POSE
from derive.robot.robot import Robot

Array = npt.NDArray[Any]
ROUNDING = 1e-12  # what is left of a sine, or of a length [m], that vanishes


@dataclass(frozen=True, slots=True, eq=False)
class NumericArm:
    """The numbers of one arm with n joints."""

    standard: bool  # whether the table follows the standard convention, not the modified one
    revolute: Array  # (n,) whether joint i turns
    sign: Array  # (n,) factor of the variable in its cell, +1 or -1
    theta: Array  # (n,) constant part of the angle [rad]
    d: Array  # (n,) constant part of the offset along z [m]
    a: Array  # (n,) link length [m]
    alpha: Array  # (n,) link twist [rad]
    base: Array  # (4, 4) world to frame 0
    tool: Array  # (4, 4) frame n to the end effector
    gravity: Array  # (3,) acceleration of gravity in the world frame [m/s^2]
    mass: Array  # (n,) link masses [kg]
    com: Array  # (n, 3) centres of mass in the links' DH frames [m]
    inertia: Array  # (n, 3, 3) tensors about the centres of mass, axes of the links' DH frames [kg m^2]
    rotor_mass: Array  # (n,) rotor masses [kg]
    rotor_inertia: Array  # (n,) rotor inertias about the spin axes [kg m^2]
    ratio: Array  # (n,) gear ratios
    armature: Array  # (n,) reflected inertias, on the diagonal of B only
    viscous: Array  # (n,) joint-side viscous friction
    coulomb: Array  # (2, n) joint-side Coulomb friction for qd > 0, and against that for qd < 0
    task: tuple[str, ...]  # what is asked of the end effector, in the words of robot files

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.sign)

    @property
    def gravity_in_frame_0(self) -> Array:
        """Acceleration of gravity in the axes of frame 0, R_base^T g [m/s^2]."""
        return self.base[:3, :3].T @ self.gravity


def numeric_arm(robot: Robot, chosen: Mapping[str, float] | None = None) -> NumericArm:
    """The numbers of a robot."""
    values = parameter_values(robot, chosen)
    joints, links = robot.joints, robot.links or (Link(),) * robot.n
    motors = [link.motor or Motor() for link in links]

    def numbers(cells: Iterable[Expression]) -> Array:
        return np.array([to_float(cell, values) for cell in cells])

    def tensor(link: Link) -> Array:
        t = link.inertia
        return numbers((t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz)).reshape(3, 3)

    return NumericArm(
        standard=robot.convention is Convention.STANDARD,
        revolute=np.array([joint.is_revolute for joint in joints]),
        sign=np.array([float(joint.sign) for joint in joints]),
        theta=numbers(joint.theta for joint in joints),
        d=numbers(joint.d for joint in joints),
        a=numbers(joint.a for joint in joints),
        alpha=numbers(joint.alpha for joint in joints),
        base=np.array([numbers(row) for row in robot.base]),
        tool=np.array([numbers(row) for row in robot.tool]),
        gravity=numbers(robot.gravity or (ZERO, ZERO, ZERO)),
        mass=numbers(link.mass for link in links),
        com=np.array([numbers(link.com) for link in links]),
        inertia=np.array([tensor(link) for link in links]),
        rotor_mass=numbers(motor.mass for motor in motors),
        rotor_inertia=numbers(motor.inertia for motor in motors),
        ratio=numbers(motor.ratio for motor in motors),
        armature=numbers(link.armature for link in links),
        viscous=numbers(link.viscous for link in links),
        coulomb=np.array([numbers(link.dry[way] for link in links) for way in (0, 1)]),
        task=robot.inverse.task,
    )


def together(arguments: Sequence[Array]) -> tuple[Array, ...]:
    """Arguments with one batch shape, broadcast, each with its own entries."""
    batch = np.broadcast_shapes(*(argument.shape[:-1] for argument in arguments))
    return tuple(np.broadcast_to(argument, (*batch, argument.shape[-1])) for argument in arguments)


def row_transform(arm: NumericArm, i: int, q: Array) -> Array:
    """A_i, the product of its four elementary transforms.

    Standard: Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha). Modified (a and alpha are a_{i-1} and alpha_{i-1}):
    Rot(x, alpha) Trans(x, a) Rot(z, theta) Trans(z, d).
    """
    # theta_i = sign q + theta of a revolute joint, d_i = sign q + d of a prismatic one
    moving = arm.sign[i] * q
    theta = arm.theta[i] + moving * arm.revolute[i]
    d = arm.d[i] + moving * (not arm.revolute[i])
    # Rot and Trans along one axis commute: one screw about z, one about x.
    z, x = _screw(2, theta, d), _screw(0, arm.alpha[i], arm.a[i])
    return z @ x if arm.standard else x @ z


def chain_frames(arm: NumericArm, q: Array) -> Array:
    """DH frames 0 to n seen from frame 0, the first being the identity."""
    # T_i = T_{i-1} A_i, outward from frame 0
    frames = [np.broadcast_to(np.eye(4, dtype=q.dtype), (*q.shape[:-1], 4, 4))]
    for i in range(arm.n):
        frames.append(frames[-1] @ row_transform(arm, i, q[..., i]))
    return np.stack(frames, axis=-3)


def joint_axes(arm: NumericArm, frames: Array) -> tuple[Array, Array]:
    """Direction of z and a point on the axis of each joint, in frame 0.

    Joint i moves along or about z_{i-1} through o_{i-1} (standard), z_i through o_i (modified).
    """
    on_axis = frames[..., :-1, :, :] if arm.standard else frames[..., 1:, :, :]
    return on_axis[..., :3, 2], on_axis[..., :3, 3]


def point_jacobian(arm: NumericArm, frames: Array, points: Array, carriers: Array) -> Array:
    """Linear Jacobians dp/dq in frame 0 of points on links, each moved by its first ``carriers`` (m,) joints."""
    # dp/dq_j = z_j x (p - o_j) of a revolute joint, z_j of a prismatic one; zero for joints beyond the link
    axis, origin = joint_axes(arm, frames)
    lever = points[..., :, None, :] - origin[..., None, :, :]
    turning = cross(axis[..., None, :, :], lever)
    columns = np.where(arm.revolute[:, None], turning, axis[..., None, :, :])
    return _only_moving(arm, columns, carriers)


def angular_jacobian(arm: NumericArm, frames: Array, carriers: Array) -> Array:
    """Angular Jacobians in frame 0 of links, each moved by its first ``carriers`` (m,) joints: sign z, 0 for slides."""
    axis, _ = joint_axes(arm, frames)
    columns = np.where(arm.revolute[:, None], axis, 0.0)[..., None, :, :]
    return _only_moving(arm, np.broadcast_to(columns, (*columns.shape[:-3], len(carriers), arm.n, 3)), carriers)


def rotor_places(arm: NumericArm, frames: Array) -> Array:
    """Where the rotors sit, in frame 0, rotor i fixed on link i-1.

    o_{i-1} (standard); o_i at q_i = 0 (modified), where a revolute joint leaves o_i anyway.
    """
    carriers = frames[..., :-1, :, :]
    if arm.standard:
        return carriers[..., :3, 3]
    # Column 4 of A_i at q_i = 0: where frame i would be, seen from frame i-1
    at_rest = np.stack([row_transform(arm, i, np.zeros(()))[:, 3] for i in range(arm.n)])
    return np.asarray(np.einsum("...kab,kb->...ka", carriers, at_rest)[..., :3])


def forward_kinematics(arm: NumericArm, q: Array) -> Array:
    """T = base A_1 ... A_n tool."""
    return arm.base @ chain_frames(arm, q)[..., -1, :, :] @ arm.tool


def link_transforms(arm: NumericArm, q: Array) -> Array:
    """Base A_1 ... A_i for i = 1..n."""
    return arm.base @ chain_frames(arm, q)[..., 1:, :, :]


def jacobian(arm: NumericArm, q: Array) -> Array:
    """Geometric Jacobian of the end effector in world axes, linear rows first."""
    frames = chain_frames(arm, q)
    # The base only turns the rows: J = diag(R, R) J_0.
    end = (frames[..., -1, :, :] @ arm.tool)[..., None, :3, 3]
    carrier = np.array([arm.n])
    turn = arm.base[:3, :3]
    linear = turn @ point_jacobian(arm, frames, end, carrier)[..., 0, :, :]
    return np.concatenate([linear, turn @ angular_jacobian(arm, frames, carrier)[..., 0, :, :]], axis=-2)


def task_rows(arm: NumericArm, part: str = "all") -> list[int]:
    """Rows of J of the task that the file names, or of a part of what moves, seen from a first joint along z."""
    words = ("x", "y", "z", "approach", "approach", "phi")
    if part == "all" and arm.task != POSE:
        full = bool({"approach", "orientation"} & {*arm.task})
        return [row for row, word in enumerate(words) if word in arm.task or (row > 2 and full)]
    axis, origin = joint_axes(arm, chain_frames(arm, np.random.default_rng(0).uniform(-1.0, 1.0, arm.n)))
    turns, slides = bool(arm.revolute.any()), not arm.revolute.all()
    parallel = np.abs(cross(axis, axis[:1])).max() < ROUNDING
    moving = {row for row, moves in enumerate((turns, turns, slides, False, False, turns)) if moves or not parallel}
    if part == "all" and len(moving) > arm.n:
        # Three lines across each other meet in one point if any two do: z_i . (o_j x z_j) + z_j . (o_i x z_i) = 0.
        moment = cross(origin, axis)
        meeting = np.abs(axis @ moment.T + moment @ axis.T).max() < ROUNDING
        is_wrist = arm.n == 3 and not slides and meeting and np.linalg.matrix_rank(axis) == 3
        part = "orientation" if is_wrist else "position"
    wanted = {"position": (0, 1, 2), "orientation": (3, 4, 5)}.get(part, range(6))
    return [row for row in wanted if row in moving]


def task_jacobian(arm: NumericArm, q: Array, part: str = "all") -> Array:
    """Rows of a part of J: of named tasks and whole vectors in the world, else in the axes before joint 1."""
    matrix, rows = jacobian(arm, q), task_rows(arm, part)
    if (part != "all" or arm.task == POSE) and rows not in ([0, 1, 2], [3, 4, 5], [0, 1, 2, 3, 4, 5]):
        back = arm.base[:3, :3].T if arm.standard else (arm.base @ _screw(0, arm.alpha[0], arm.a[0]))[:3, :3].T
        matrix = np.concatenate([back @ matrix[..., :3, :], back @ matrix[..., 3:, :]], axis=-2)
    return matrix[..., rows, :]


def jacobian_end(arm: NumericArm, q: Array) -> Array:
    """Geometric Jacobian of the end effector in its own axes, linear rows first: R^T times both halves of the other."""
    # J_end = diag(R^T, R^T) J with R of the end effector
    back = np.swapaxes(forward_kinematics(arm, q)[..., :3, :3], -1, -2)
    in_world = jacobian(arm, q)
    return np.concatenate([back @ in_world[..., :3, :], back @ in_world[..., 3:, :]], axis=-2)


def cross(u: Array, v: Array) -> Array:
    """Vector product over the last axis."""
    ux, uy, uz = u[..., 0], u[..., 1], u[..., 2]
    vx, vy, vz = v[..., 0], v[..., 1], v[..., 2]
    return np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], axis=-1)


def _only_moving(arm: NumericArm, columns: Array, carriers: Array) -> Array:
    moves = np.arange(arm.n) < carriers[:, None]
    return np.swapaxes(columns * (arm.sign * moves)[..., None], -1, -2)


def _screw(axis: int, angle: Array, distance: Array) -> Array:
    """Rot(axis, angle) Trans(axis, distance), axes counted from x = 0."""
    matrix: Array = np.zeros((*np.shape(angle), 4, 4), dtype=np.result_type(angle, distance, float))
    cosine, sine = np.cos(angle), np.sin(angle)
    # The plane across the axis, in cyclic order: cos and -sin above, sin and cos below.
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix[..., j, j], matrix[..., j, k] = cosine, -sine
    matrix[..., k, j], matrix[..., k, k] = sine, cosine
    matrix[..., axis, axis] = matrix[..., 3, 3] = 1.0
    matrix[..., axis, 3] = distance
    return matrix
