"""Forward kinematics from the base outwards: poses of the frames, the Jacobian, its rate and the analytic Jacobians.

*Geometric Jacobian*, at the end effector, in the world frame: column i is (z_i x (p_e - o_i), z_i) for a revolute joint
and (z_i, 0) for a prismatic one, times the sign of the joint's variable; the linear rows come first (Siciliano et al.,
Robotics, section 3.1).

*In the axes of the end effector* both are those of the arm seen from there: an arm whose base is the end effector and
whose joints follow in the other order, with opposed motions.

*Its rate*: with z the axis of a revolute joint, r the lever from it to the end effector and omega the angular velocity
of the link before the joint, dz/dt = omega x z and d(z x r)/dt = zdot x r + z x rdot, where rdot is the velocity of the
end effector less that of the joint's origin. A prismatic joint's column is its axis (Siciliano et al., Robotics,
section 3.1; Lynch and Park, Modern Robotics, ch. 5, for spatial velocities).

*Its derivatives*: a joint turns and shifts, with its velocity (v_j, w_j), the columns of the joints from its own on,
and of those before only the end effector: dJ_i/dq_j = (w_j x v_i, w_j x w_i) for j <= i, (w_i x v_j, 0) for j > i
(Hourtash, The kinematic Hessian and higher derivatives, CIRA 2005).

*A wrench* h, force f and moment m on the end effector about its origin, is felt by the joints as J^T h, whatever the
axes of both. With columns (v_i, w_i) of J and a_i = v_i x f + w_i x m, what joint i feels changes with q_j by

    w_j . a_i  (j <= i),   w_i . (v_j x f)              (j > i)   if f and m stand in the world,
    0          (j <= i),   w_i . a_j + v_i . (w_j x f)  (j > i)   if they turn with the end effector, f by w_j x f

(Siciliano et al., Robotics, section 3.8; with the derivatives of J above).

*Seen from another frame* and of another point of the last link, J has the same volume, its manipulability: sqrt(det(J
J^T)), |det J| of a square J (Yoshikawa, Manipulability of robotic mechanisms, International Journal of Robotics
Research 4(2), 1985). In the middle of the arm most entries are zero.

*Analytic Jacobians*: velocity of the end effector and rates of its orientation angles. Both kinds of angles begin with
a turn about the world's z axis, and the direction u = (x, y, z) that their second turn tilts, column 1 of R for roll,
pitch, yaw and column 3 for Euler ZYZ, says it all: with omega the angular velocity,

    about = (x omega_x + y omega_y) / (x^2 + y^2),    across = (x omega_y - y omega_x) / sqrt(x^2 + y^2),

the rates are (roll, pitch, yaw) = (about, across, omega_z - z about) and (phi, theta, psi) = (omega_z - z about,
across, about). Where x = y = 0 the angles are singular and their rates infinite or not a number (Siciliano et al.,
Robotics, section 3.6).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Protocol, Self, TypeVar

from derive.mechanics.chain import Chain
from derive.mechanics.forward_dynamics import Field
from derive.mechanics.joint_motion import advance, along_axes
from derive.mechanics.vectors import Frame, S, Vector, add, column, cross, dot, scale, subtract


def joint_poses(chain: Chain[S]) -> list[Frame[S]]:
    """Joint frames 1..n in the world frame."""
    poses = [chain.base]
    for joint in chain.joints:
        poses.append(advance(poses[joint.parent + 1], joint))
    return poses[1:]


def forward_kinematics(chain: Chain[S]) -> Frame[S]:
    """T = base A_1 ... A_n tool: the end effector in the world frame."""
    return joint_poses(chain)[-1] @ chain.tool


def link_transforms(chain: Chain[S]) -> list[Frame[S]]:
    """Base A_1 ... A_i for i = 1..n: DH frames 1..n in the world frame, without the tool."""
    return [pose @ end for pose, end in zip(joint_poses(chain), chain.ends, strict=True)]


def jacobian(chain: Chain[S]) -> list[list[S]]:
    """J(q): (v, omega) = J qd for the origin of the end effector, tool included, in the world frame."""
    poses = joint_poses(chain)
    return _columns(chain, poses, (poses[-1] @ chain.tool).position)


def jacobian_from(chain: Chain[S], k: int, *, at_end: bool) -> list[list[S]]:
    """J seen from joint frame k: in its axes, of its origin as a point of the last link unless of the end effector."""
    inner = replace(chain, base=chain.unit, joints=chain.joints[:k], tool=chain.unit).inverted
    beyond = tuple(replace(joint, parent=i - 1) for i, joint in enumerate(chain.joints[k:]))
    outer = joint_poses(replace(chain, base=chain.unit, joints=beyond))
    end = ([chain.unit, *outer][-1] @ chain.tool).position if at_end else chain.null
    return _columns(chain, [*reversed(joint_poses(inner)), *outer], end)


def _columns(chain: Chain[S], poses: Sequence[Frame[S]], end: Vector[S]) -> list[list[S]]:
    columns: list[list[S]] = []
    for joint, pose in zip(chain.joints, poses, strict=True):
        z = column(pose.rotation, 2)
        entries = [*cross(z, subtract(end, pose.position)), *z] if joint.revolute else [*z, *chain.null]
        columns.append(entries if joint.sign > 0 else [-entry for entry in entries])
    return [[entries[row] for entries in columns] for row in range(6)]


def jacobian_end(chain: Chain[S]) -> list[list[S]]:
    """J(q) in the axes of the end effector: (v, omega) = J qd for its origin, by recursion from there to the base."""
    columns: list[list[S]] = []
    inverted = chain.inverted
    for joint, pose in zip(inverted.joints, joint_poses(inverted), strict=True):
        z = column(pose.rotation, 2)
        entries = [*cross(pose.position, z), *z] if joint.revolute else [*z, *chain.null]
        columns.append([-entry for entry in entries] if joint.sign > 0 else entries)
    return [[entries[row] for entries in reversed(columns)] for row in range(6)]


def jacobian_rate(chain: Chain[S], qd: Sequence[S]) -> list[list[S]]:
    """dJ/dt(q, qd): the acceleration of the end effector is J qdd + dJ/dt qd, in the world frame."""
    rates = along_axes(chain, qd)
    poses = joint_poses(chain)
    end = (poses[-1] @ chain.tool).position
    axes, levers = [column(pose.rotation, 2) for pose in poses], [subtract(end, pose.position) for pose in poses]
    beyond = [chain.null]  # the velocity of the end effector that a joint and the joints after it make
    for i in range(chain.n - 1, -1, -1):
        own = cross(axes[i], levers[i]) if chain.joints[i].revolute else axes[i]
        beyond.append(add(beyond[-1], scale(rates[i], own)))
    omega = chain.null
    columns: list[list[S]] = []
    for joint, rate, z, r, rdot in zip(chain.joints, rates, axes, levers, reversed(beyond[1:]), strict=True):
        turning = cross(omega, z)
        if joint.revolute:  # omega x (z x r) is the turn of the whole column
            entries = [*add(cross(omega, cross(z, r)), cross(z, rdot)), *turning]
            omega = add(omega, scale(rate, z))
        else:
            entries = [*turning, *chain.null]
        columns.append(entries if joint.sign > 0 else [-entry for entry in entries])
    return [[entries[row] for entries in columns] for row in range(6)]


def jacobian_hessian(jacobian: Sequence[Sequence[S]], zero: S) -> list[list[S]]:
    """dJ/dq from J, in the same axes: n rows for each row r of J, whose entry i, j is the derivative of J_ri by q_j."""
    columns = [((a, b, c), (d, e, f)) for a, b, c, d, e, f in zip(*jacobian, strict=True)]
    places = range(len(columns))
    linear = [[cross(columns[min(i, j)][1], columns[max(i, j)][0]) for j in places] for i in places]
    still = (zero, zero, zero)
    angular = [[cross(columns[j][1], columns[i][1]) if j < i else still for j in places] for i in places]
    return [[entry[r] for entry in row] for half in (linear, angular) for r in range(3) for row in half]


def wrench_torques(jacobian: Sequence[Sequence[S]], force: Vector[S], moment: Vector[S]) -> list[S]:
    """J^T h [N m or N], from J and a wrench in the same axes."""
    return [dot((a, b, c), force) + dot((d, e, f), moment) for a, b, c, d, e, f in zip(*jacobian, strict=True)]


def wrench_torque_derivatives(
    jacobian: Sequence[Sequence[S]], force: Vector[S], moment: Vector[S], zero: S, *, turning: bool
) -> list[list[S]]:
    """Derivatives of J^T h by q_j, column j, of a wrench that stands in the world or turns with the end effector."""
    columns = [((a, b, c), (d, e, f)) for a, b, c, d, e, f in zip(*jacobian, strict=True)]
    bent = [cross(v, force) for v, _ in columns]
    both = [add(own, cross(w, moment)) for own, (_, w) in zip(bent, columns, strict=True)]
    placed = list(enumerate(columns))
    if turning:
        bent = [cross(w, force) for _, w in columns]
        return [[dot(w, both[j]) + dot(v, bent[j]) if j > i else zero for j, _ in placed] for i, (v, w) in placed]
    return [[dot(w_j, both[i]) if j <= i else dot(w, bent[j]) for j, (_, w_j) in placed] for i, (_, w) in placed]


class RootField(Field, Protocol):
    """A scalar that can divide and has square roots."""

    def __rtruediv__(self, other: Any, /) -> Self: ...

    def sqrt(self) -> Self:
        """The square root."""


R = TypeVar("R", bound=RootField)

RPY, ZYZ = "rpy", "zyz"
TILTED = {RPY: 0, ZYZ: 2}  # column of R that the second turn tilts


def analytic_jacobian(kind: str, tilted: Vector[R], jacobian: Sequence[Sequence[R]]) -> list[list[R]]:
    """J_A(q): rows of velocity, then of the rates of the angles, roll, pitch, yaw or phi, theta, psi."""
    x, y, z = tilted
    square = x * x + y * y
    inverse, inverse_root = 1 / square, 1 / square.sqrt()
    along, aside = (inverse * x, inverse * y), (inverse_root * x, inverse_root * y)
    rates: list[list[R]] = []
    for wx, wy, wz in zip(*jacobian[3:], strict=True):
        about = along[0] * wx + along[1] * wy
        across = aside[0] * wy - aside[1] * wx
        turn = wz - z * about
        rates.append([about, across, turn] if kind == RPY else [turn, across, about])
    return [*(list(row) for row in jacobian[:3]), *(list(row) for row in zip(*rates, strict=True))]
