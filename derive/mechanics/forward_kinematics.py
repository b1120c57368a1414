"""Poses of the frames, from the base outwards."""

from __future__ import annotations

from derive.mechanics.chain import Chain
from derive.mechanics.joint_motion import advance
from derive.mechanics.vectors import Frame, S


def joint_poses(chain: Chain[S]) -> list[Frame[S]]:
    """Joint frames 1..n in the world frame."""
    poses: list[Frame[S]] = []
    pose = chain.base
    for joint in chain.joints:
        pose = advance(pose, joint)
        poses.append(pose)
    return poses


def forward_kinematics(chain: Chain[S]) -> Frame[S]:
    """T = base A_1 ... A_n tool: the end effector in the world frame."""
    return joint_poses(chain)[-1] @ chain.tool


def link_transforms(chain: Chain[S]) -> list[Frame[S]]:
    """Base A_1 ... A_i for i = 1..n: DH frames 1..n in the world frame, without the tool."""
    return [pose @ end for pose, end in zip(joint_poses(chain), chain.ends, strict=True)]


def rows(frame: Frame[S], zero: S, one: S) -> list[list[S]]:
    """The 4x4 matrix of a frame."""
    top = [[*frame.rotation[k], frame.position[k]] for k in range(3)]
    return [*top, [zero, zero, zero, one]]
