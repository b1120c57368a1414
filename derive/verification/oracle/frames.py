"""An arm or a tree as plain numbers, and its frames.

The DH table, the frames around it and the inertial parameters are arrays. Frames and Jacobians come straight from the
definitions. Joints are counted from 0, and what stands on frame 0 follows joint -1.

Every function takes configurations ``(..., n)``, real or complex: complex ones serve to differentiate by complex step,
so nothing here conjugates. Inside, everything is in frame 0; the base transform is applied last.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.robot import tree
from derive.robot.description import BASE, Convention, End, FixedRow, Joining, Link, Matrix, Motor, Stand
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import ZERO, Expression
from derive.robot.options.inverse import POSE
from derive.robot.robot import Robot

Array = npt.NDArray[Any]
Place = tuple[int, Array]  # of a frame: the joint that carries it, and where it is in that joint's frame
ROUNDING = 1e-12  # what is left of a sine, or of a length [m], that vanishes


@dataclass(frozen=True, slots=True, eq=False)
class NumericArm:
    """The numbers of one arm or tree with n joints and k bodies, as seen from one of its ends."""

    standard: bool  # whether the table follows the standard convention, not the modified one
    revolute: Array  # (n,) whether joint i turns
    sign: Array  # (n,) factor of the variable in its cell, +1 or -1
    theta: Array  # (n,) constant part of the angle [rad]
    d: Array  # (n,) constant part of the offset along z [m]
    a: Array  # (n,) link length [m]
    alpha: Array  # (n,) link twist [rad]
    parent: Array  # (n,) joint that joint i follows
    start: Array | None  # (n, 4, 4) from the frame of that joint to where row i begins; None where nothing is between
    moves: Array  # (n + 1, n) whether joint j moves link i; the last row is that of the base
    base: Array  # (4, 4) world to frame 0
    last: int  # the joint that carries the end effector
    tool: Array  # (4, 4) its frame to the end effector
    ends: Mapping[str, Place]  # both of each end
    gravity: Array  # (3,) acceleration of gravity in the world frame [m/s^2]
    # Bodies, the n links and then those of rows without motion, in the DH frames of the joints that carry them.
    carrier: Array  # (k,) these joints
    mass: Array  # (k,) masses [kg]
    com: Array  # (k, 3) centres of mass [m]
    inertia: Array  # (k, 3, 3) tensors about the centres of mass [kg m^2]
    rotor_mass: Array  # (n,) rotor masses [kg]
    rotor_inertia: Array  # (n,) rotor inertias about the spin axes [kg m^2]
    ratio: Array  # (n,) gear ratios
    armature: Array  # (n,) reflected inertias, on the diagonal of B only
    viscous: Array  # (n,) joint-side viscous friction
    coulomb: Array  # (2, n) joint-side Coulomb friction for qd > 0, and against that for qd < 0
    task: tuple[str, ...]  # what is asked of the end effector, in the words of robot files
    coupling: Array | None  # (n, v) positions of joints per unit of each variable; None where each joint has its own
    loops: tuple[tuple[Joining, float, Place, Place], ...]  # what joins which two frames, with the length of a rod [m]
    passive: Array  # joints that the loops move, whose rows of the coupling are zeros

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.sign)

    @property
    def on_way(self) -> Array:
        """(n,) whether joint j moves the end effector."""
        return np.asarray(self.moves[self.last])

    @property
    def length(self) -> float:
        """Of all rows together [m], 1 where they have none."""
        between = 0.0 if self.start is None else np.abs(self.start[:, :3, 3]).sum()
        return float(np.abs(self.a).sum() + np.abs(self.d).sum() + between) or 1.0

    def at(self, end: str) -> NumericArm:
        """The same seen from another end."""
        last, tool = self.ends[end]
        return replace(self, last=last, tool=tool)

    @property
    def gravity_in_frame_0(self) -> Array:
        """Acceleration of gravity in the axes of frame 0, R_base^T g [m/s^2]."""
        return self.base[:3, :3].T @ self.gravity


class _Numbers:
    """Numbers of the cells of a robot."""

    def __init__(self, robot: Robot, chosen: Mapping[str, float] | None) -> None:
        self.robot, self.values = robot, parameter_values(robot, chosen)
        self.standard = robot.convention is Convention.STANDARD

    def __call__(self, cells: Iterable[Expression]) -> Array:
        return np.array([to_float(cell, self.values) for cell in cells])

    def matrix(self, rows: Matrix) -> Array:
        return np.array([self(row) for row in rows])

    def tensor(self, link: Link) -> Array:
        t = link.inertia
        return self((t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz)).reshape(3, 3)

    def start(self, stand: Stand) -> Array:
        """Mount Rot(z, gamma) Trans(z, b)."""
        return np.asarray(self.matrix(stand.mount) @ _screw(2, *self((stand.gamma, stand.b))))

    def along(self, rows: Iterable[FixedRow]) -> Array:
        """Over rows without motion that follow each other."""
        found = np.eye(4)
        for row in rows:
            theta, d, a, alpha = self((row.theta, row.d, row.a, row.alpha))
            found = found @ self.start(row.stand) @ _row(_screw(2, theta, d), _screw(0, alpha, a), self.standard)
        return found

    def place(self, label: str) -> Place:
        """The joint that carries a row, and the row's frame in that of the joint."""
        way = tree.way_to(self.robot, label)
        return way.joint, self.along(way.rows)

    def end(self, end: End) -> Place:
        """The joint that carries an end, and the end in that joint's frame."""
        joint, frame = self.place(end.after)
        return joint, frame @ self.matrix(end.tool)

    def coupling(self) -> Array:
        places = {variable.variable: k for k, variable in enumerate(self.robot.coupled)}
        matrix = np.zeros((self.robot.n, len(places)))
        for row, joint in zip(matrix, self.robot.joints, strict=True):
            for name, factor in joint.drive:
                row[places[name]] = to_float(factor, self.values)
            if not joint.drive and not joint.follows:
                row[places[joint.variable]] = 1.0
        return matrix

    def starts(self) -> Array | None:
        """From the frame of the joint that each row follows to where it begins; None where nothing is between."""
        stands = [joint.stand for joint in self.robot.joints]
        if not any(stands):
            return None
        between = zip(tree.ways(self.robot), stands, strict=True)
        return np.array([self.along(way.rows) @ self.start(stand or Stand(BASE)) for way, stand in between])


def numeric_arm(robot: Robot, chosen: Mapping[str, float] | None = None) -> NumericArm:
    """The numbers of a robot, seen from its first end."""
    numbers, joints, parents = _Numbers(robot, chosen), robot.joints, tree.parents(robot)
    links = robot.links or (Link(),) * robot.n
    motors = [link.motor or Motor() for link in links]
    bodies = [(i, np.eye(4), link) for i, link in enumerate(links)]
    bodies += [(*numbers.place(row.name), row.link) for row in robot.fixed if row.link is not None]
    moves = np.zeros((robot.n + 1, robot.n), dtype=bool)
    for i, parent in enumerate(parents):
        moves[i] = moves[parent]
        moves[i, i] = True
    ends = {end.name: numbers.end(end) for end in tree.ends(robot)}
    last, tool = next(iter(ends.values()))
    return NumericArm(
        standard=numbers.standard,
        revolute=np.array([joint.is_revolute for joint in joints]),
        sign=np.array([float(joint.sign) for joint in joints]),
        theta=numbers(joint.theta for joint in joints),
        d=numbers(joint.d for joint in joints),
        a=numbers(joint.a for joint in joints),
        alpha=numbers(joint.alpha for joint in joints),
        parent=np.array(parents),
        start=numbers.starts(),
        moves=moves,
        base=numbers.matrix(robot.base),
        last=last,
        tool=tool,
        ends=ends,
        gravity=numbers(robot.gravity or (ZERO, ZERO, ZERO)),
        mass=numbers(link.mass for _, _, link in bodies),
        com=np.array([frame[:3, :3] @ numbers(link.com) + frame[:3, 3] for _, frame, link in bodies]),
        inertia=np.array([frame[:3, :3] @ numbers.tensor(link) @ frame[:3, :3].T for _, frame, link in bodies]),
        carrier=np.array([i for i, _, _ in bodies]),
        rotor_mass=numbers(motor.mass for motor in motors),
        rotor_inertia=numbers(motor.inertia for motor in motors),
        ratio=numbers(motor.ratio for motor in motors),
        armature=numbers(link.armature for link in links),
        viscous=numbers(link.viscous for link in links),
        coulomb=np.array([numbers(link.dry[way] for link in links) for way in (0, 1)]),
        task=robot.inverse.task,
        coupling=numbers.coupling() if robot.coupled else None,
        loops=tuple(
            (loop.by, *numbers([loop.length]).tolist(), *map(numbers.place, loop.join)) for loop in robot.loops
        ),
        passive=np.array([i for i, joint in enumerate(joints) if joint.follows], dtype=int),
    )


def together(arguments: Sequence[Array]) -> tuple[Array, ...]:
    """Arguments with one batch shape, broadcast, each with its own entries."""
    batch = np.broadcast_shapes(*(argument.shape[:-1] for argument in arguments))
    return tuple(np.broadcast_to(argument, (*batch, argument.shape[-1])) for argument in arguments)


def row_transform(arm: NumericArm, i: int, q: Array) -> Array:
    """A_i without what is constant before the row, the product of its four elementary transforms."""
    # Standard: Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha). Modified (a and alpha are a_{i-1} and alpha_{i-1}):
    # Rot(x, alpha) Trans(x, a) Rot(z, theta) Trans(z, d).
    # theta_i = sign q + theta of a revolute joint, d_i = sign q + d of a prismatic one
    moving = arm.sign[i] * q
    theta = arm.theta[i] + moving * arm.revolute[i]
    d = arm.d[i] + moving * (not arm.revolute[i])
    # Rot and Trans along one axis commute: one screw about z, one about x.
    return _row(_screw(2, theta, d), _screw(0, arm.alpha[i], arm.a[i]), arm.standard)


def chain_frames(arm: NumericArm, q: Array) -> Array:
    """DH frames 0 to n seen from frame 0, the first being the identity; nobody may write into them."""
    return _chain_frames(arm, q.shape, q.dtype, q.tobytes())


@lru_cache(maxsize=16)  # most functions are asked for at the same configurations, one after the other
def _chain_frames(arm: NumericArm, shape: tuple[int, ...], kind: np.dtype[Any], data: bytes) -> Array:
    q: Array = np.frombuffer(data, kind).reshape(shape)
    # T_i = T_{i-1} A_i, outward from frame 0, with the frame that joint i follows for frame i-1
    frames = [np.broadcast_to(np.eye(4, dtype=q.dtype), (*q.shape[:-1], 4, 4))]
    for i in range(arm.n):
        before = frames[arm.parent[i] + 1]
        before = before if arm.start is None else before @ arm.start[i]
        frames.append(before @ row_transform(arm, i, q[..., i]))
    found = np.stack(frames, axis=-3)
    found.flags.writeable = False
    return found


def row_starts(arm: NumericArm, frames: Array) -> Array:
    """Where the rows begin, seen from frame 0: frames 0 to n-1 of a chain with nothing between its rows."""
    before = frames[..., arm.parent + 1, :, :]
    return before if arm.start is None else np.asarray(before @ arm.start)


def joint_axes(arm: NumericArm, frames: Array) -> tuple[Array, Array]:
    """Direction of z and a point on the axis of each joint, in frame 0."""
    # Joint i moves along or about z through the origin where row i begins, z_{i-1} and o_{i-1} of a chain (standard),
    # or z_i through o_i (modified).
    on_axis = row_starts(arm, frames) if arm.standard else frames[..., 1:, :, :]
    return on_axis[..., :3, 2], on_axis[..., :3, 3]


def point_jacobian(arm: NumericArm, frames: Array, points: Array, moves: Array) -> Array:
    """Linear Jacobians dp/dq in frame 0 of points on links; ``moves``: (m, n), the joints that move each."""
    # dp/dq_j = z_j x (p - o_j) of a revolute joint, z_j of a prismatic one; zero for joints that do not move it
    axis, origin = joint_axes(arm, frames)
    turning = cross(axis[..., None, :, :], points[..., :, None, :] - origin[..., None, :, :])
    return _only_moving(arm, np.where(arm.revolute[:, None], turning, axis[..., None, :, :]), moves)


def angular_jacobian(arm: NumericArm, frames: Array, moves: Array) -> Array:
    """Angular Jacobians in frame 0 of links, sign z, 0 for slides; ``moves``: (m, n), the joints that move each."""
    axis, _ = joint_axes(arm, frames)
    columns = np.where(arm.revolute[:, None], axis, 0.0)[..., None, :, :]
    return _only_moving(arm, np.broadcast_to(columns, (*columns.shape[:-3], len(moves), arm.n, 3)), moves)


def rotor_places(arm: NumericArm, frames: Array) -> Array:
    """Where the rotors sit, in frame 0, rotor i fixed on the link that joint i follows."""
    # o_{i-1}, or where row i begins (standard); o_i at q_i = 0 (modified), where a revolute joint leaves o_i anyway.
    carriers = row_starts(arm, frames)
    if arm.standard:
        return np.asarray(carriers[..., :3, 3])
    # Column 4 of A_i at q_i = 0: where frame i would be, seen from where row i begins
    at_rest = np.stack([row_transform(arm, i, np.zeros(()))[:, 3] for i in range(arm.n)])
    return np.asarray(np.einsum("...kab,kb->...ka", carriers, at_rest)[..., :3])


def forward_kinematics(arm: NumericArm, q: Array) -> Array:
    """T = base A_1 ... A_n tool, over the rows on the way to the end."""
    return np.asarray(arm.base @ chain_frames(arm, q)[..., arm.last + 1, :, :] @ arm.tool)


def passive_positions(arm: NumericArm, x: Array) -> Array:
    """Positions of the passive joints, angles in (-pi, pi]."""
    return np.where(arm.revolute, x - 2 * np.pi * np.ceil(x / (2 * np.pi) - 0.5), x)[..., arm.passive]


def link_transforms(arm: NumericArm, q: Array) -> Array:
    """Base A_1 ... A_i for i = 1..n, over the rows on the way to each."""
    return arm.base @ chain_frames(arm, q)[..., 1:, :, :]


def jacobian(arm: NumericArm, q: Array) -> Array:
    """Geometric Jacobian of the end effector in world axes, linear rows first."""
    frames = chain_frames(arm, q)
    # The base only turns the rows: J = diag(R, R) J_0.
    end = (frames[..., arm.last + 1, :, :] @ arm.tool)[..., None, :3, 3]
    moves = arm.on_way[None]
    turn = arm.base[:3, :3]
    linear = turn @ point_jacobian(arm, frames, end, moves)[..., 0, :, :]
    return np.concatenate([linear, turn @ angular_jacobian(arm, frames, moves)[..., 0, :, :]], axis=-2)


def task_rows(arm: NumericArm, part: str = "all") -> list[int]:
    """Rows of J of the task that the file names, or of a part of what moves, seen from a first joint along z."""
    words = ("x", "y", "z", "approach", "approach", "phi")
    if part == "all" and arm.task != POSE:
        full = bool({"approach", "orientation"} & {*arm.task})
        return [row for row, word in enumerate(words) if word in arm.task or (row > 2 and full)]
    q, revolute = np.random.default_rng(0).uniform(-1.0, 1.0, arm.n), arm.revolute[arm.on_way]
    axis, origin = (each[arm.on_way] for each in joint_axes(arm, chain_frames(arm, q)))
    turns, slides = bool(revolute.any()), not revolute.all()
    parallel = np.abs(cross(axis, axis[:1])).max() < ROUNDING
    moving = {row for row, moves in enumerate((turns, turns, slides, False, False, turns)) if moves or not parallel}
    if part == "all" and len(moving) > len(axis):
        # Three lines across each other meet in one point if any two do: z_i . (o_j x z_j) + z_j . (o_i x z_i) = 0.
        moment = cross(origin, axis)
        meeting = np.abs(axis @ moment.T + moment @ axis.T).max() < ROUNDING
        is_wrist = len(axis) == 3 and not slides and meeting and np.linalg.matrix_rank(axis) == 3
        is_wrist &= arm.start is None  # of a tree's ends it is the position
        part = "orientation" if is_wrist else "position"
    return [row for row in {"position": (0, 1, 2), "orientation": (3, 4, 5)}.get(part, range(6)) if row in moving]


def task_jacobian(arm: NumericArm, q: Array, part: str = "all") -> Array:
    """Rows of a part of J: of named tasks and whole vectors in the world, else in the axes before joint 1."""
    matrix, rows = jacobian(arm, q), task_rows(arm, part)
    if (part != "all" or arm.task == POSE) and rows not in ([0, 1, 2], [3, 4, 5], [0, 1, 2, 3, 4, 5]):
        first = np.flatnonzero(arm.on_way)[0]
        before = arm.base if arm.start is None else arm.base @ arm.start[first]
        back = (before if arm.standard else before @ _screw(0, arm.alpha[first], arm.a[first]))[:3, :3].T
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
    first = uy * vz - uz * vy
    product = np.empty((*first.shape, 3), dtype=first.dtype)
    product[..., 0], product[..., 1], product[..., 2] = first, uz * vx - ux * vz, ux * vy - uy * vx
    return product


def _only_moving(arm: NumericArm, columns: Array, moves: Array) -> Array:
    return np.swapaxes(columns * (arm.sign * moves)[..., None], -1, -2)


def _row(z: Array, x: Array, standard: bool) -> Array:
    """The product of a screw about z and one about x in the order of the convention."""
    return np.asarray(z @ x if standard else x @ z)


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
