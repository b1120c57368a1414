"""The geometric Jacobian at the end effector, in the world frame.

Column i is (z_i x (p_e - o_i), z_i) for a revolute joint and (z_i, 0) for a prismatic one, times the sign of the
joint's variable; the linear rows come first (Siciliano et al., Robotics, section 3.1).
"""

from __future__ import annotations

from derive.mechanics.chain import Chain
from derive.mechanics.forward_kinematics import joint_poses
from derive.mechanics.vectors import S, column, cross, subtract


def jacobian(chain: Chain[S]) -> list[list[S]]:
    """J(q), 6xn, rows first: (v, omega) = J qd for the origin of the end effector, tool included."""
    poses = joint_poses(chain)
    end = (poses[-1] @ chain.tool).position
    columns: list[list[S]] = []
    for joint, pose in zip(chain.joints, poses, strict=True):
        z = column(pose.rotation, 2)
        none = (chain.zero, chain.zero, chain.zero)
        entries = [*cross(z, subtract(end, pose.position)), *z] if joint.revolute else [*z, *none]
        columns.append(entries if joint.sign > 0 else [-entry for entry in entries])
    return [[entries[row] for entries in columns] for row in range(6)]
