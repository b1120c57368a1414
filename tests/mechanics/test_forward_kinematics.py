"""Poses and Jacobians by joint frames are those of the independent recursion by 4x4 matrices."""

from __future__ import annotations

import numpy as np
import pytest

from derive.mechanics.forward_kinematics import (
    TILTED,
    analytic_jacobian,
    forward_kinematics,
    jacobian,
    jacobian_rate,
    joint_poses,
    link_transforms,
)
from derive.mechanics.vectors import column
from tests.mechanics.arms import SEEDS, Arm, arm_of, assert_close


@pytest.fixture(params=SEEDS)
def arm(request: pytest.FixtureRequest) -> Arm:
    """One arm after another."""
    return arm_of(request.param)


def test_poses(arm: Arm) -> None:
    chain = arm.chain
    assert_close(forward_kinematics(chain).rows(0.0, 1.0), arm.expected("forward_kinematics"))
    links = [frame.rows(0.0, 1.0) for frame in link_transforms(chain)]
    assert_close(links, arm.expected("link_transforms"))


def test_joint_frames_are_link_frames_but_for_a_constant(arm: Arm) -> None:
    chain = arm.chain
    for pose, end, link in zip(joint_poses(chain), chain.ends, link_transforms(chain), strict=True):
        assert_close((pose @ end).rows(0.0, 1.0), link.rows(0.0, 1.0))


def test_jacobian_and_its_rate(arm: Arm) -> None:
    assert_close(jacobian(arm.chain), arm.expected("jacobian"))
    assert_close(jacobian_rate(arm.chain, arm.qd.tolist()), arm.expected("jacobian_dot", arm.q, arm.qd))


class Rooted(float):
    """A float that has its square root as a method, as the scalars of tapes do."""

    def sqrt(self) -> Rooted:
        return Rooted(float(self) ** 0.5)


for _name in ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv"):
    _plain = getattr(float, f"__{_name}__")
    setattr(Rooted, f"__{_name}__", lambda self, other, _plain=_plain: Rooted(_plain(self, other)))


@pytest.mark.parametrize("kind", ["rpy", "zyz"])
def test_analytic_jacobian_is_the_geometric_one_in_rates_of_angles(arm: Arm, kind: str) -> None:
    """J_A = diag(1, E^-1) J with omega = E phidot (Siciliano et al., Robotics, section 3.6)."""
    pose = forward_kinematics(arm.chain)
    tilted = tuple(map(Rooted, column(pose.rotation, TILTED[kind])))
    distance = np.hypot(*tilted[:2])
    if distance < 1e-9:  # these angles are singular wherever the arm is
        return
    rows = [[Rooted(x) for x in row] for row in jacobian(arm.chain)]
    found = np.array(analytic_jacobian(kind, tilted, rows), dtype=float)
    assert_close(found, arm.expected(f"analytic_jacobian_{kind}"), 1e-12 / distance**2)
