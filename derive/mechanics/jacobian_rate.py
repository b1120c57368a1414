"""The rate of change of the geometric Jacobian, in the world frame.

With z the axis of a revolute joint, r the lever from it to the end effector and omega the angular velocity of the link
before the joint, dz/dt = omega x z and d(z x r)/dt = zdot x r + z x rdot, where rdot is the velocity of the end
effector less that of the joint's origin. A prismatic joint's column is its axis (Siciliano et al., Robotics, section
3.1; Lynch and Park, Modern Robotics, section 8.1, for spatial velocities).
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.mechanics.chain import Chain
from derive.mechanics.forward_kinematics import joint_poses
from derive.mechanics.joint_motion import rates
from derive.mechanics.vectors import S, Vector, add, column, cross, scale, subtract


def jacobian_rate(chain: Chain[S], velocities: Sequence[S]) -> list[list[S]]:
    """dJ/dt(q, qd), 6xn, rows first: the acceleration of the end effector is J qdd + dJ/dt qd.

    Args:
        chain: The arm.
        velocities: qd, n entries.
    """
    speed = rates(chain, velocities)
    axes, levers = _axes_and_levers(chain)
    drift = _velocities_beyond(chain, speed, axes, levers)
    none = (chain.zero, chain.zero, chain.zero)
    omega = none
    columns: list[list[S]] = []
    for joint, rate, z, r, beyond in zip(chain.joints, speed, axes, levers, drift, strict=True):
        turning = cross(omega, z)
        if joint.revolute:
            # omega x (z x r) is the turn of the whole column; beyond is what the joints from this one on add to r
            linear = add(cross(omega, cross(z, r)), cross(z, beyond))
            entries = [*linear, *turning]
            omega = add(omega, scale(rate, z))
        else:
            entries = [*turning, *none]
        columns.append(entries if joint.sign > 0 else [-entry for entry in entries])
    return [[entries[row] for entries in columns] for row in range(6)]


def _axes_and_levers(chain: Chain[S]) -> tuple[list[Vector[S]], list[Vector[S]]]:
    """Joint axes, and the end effector seen from the joints' origins, in the world."""
    poses = joint_poses(chain)
    end = (poses[-1] @ chain.tool).position
    return [column(pose.rotation, 2) for pose in poses], [subtract(end, pose.position) for pose in poses]


def _velocities_beyond(
    chain: Chain[S], speed: Sequence[S], axes: Sequence[Vector[S]], levers: Sequence[Vector[S]]
) -> list[Vector[S]]:
    """For each joint, the velocity of the end effector that it and the joints after it make."""
    total = (chain.zero, chain.zero, chain.zero)
    found: list[Vector[S]] = []
    for joint, rate, z, r in zip(
        reversed(chain.joints), reversed(speed), reversed(axes), reversed(levers), strict=True
    ):
        total = add(total, scale(rate, cross(z, r) if joint.revolute else z))
        found.append(total)
    return found[::-1]
