"""The bound of the pose error holds, and is not much larger than what happens."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.exchange.arm import arm_of
from derive.exchange.certificate import certify
from derive.exchange.from_urdf import ImportOptions, import_urdf
from derive.exchange.read_urdf import read_urdf
from derive.mechanics.space import exactly
from derive.robot.description import Convention
from derive.robot.expression import number
from tests.exchange.urdfs import J, pose, urdf

TEXT = urdf([J("0 0 0.3", "1.5 0.3 0"), J("0.4 0 0.1", "1.57075 0 0"), J("0.3 0.1 0", "-1.2 0 0", axis="0 1 0")])


@pytest.mark.parametrize("convention", Convention)
def test_the_largest_difference_of_a_changed_table_stays_below_the_bound(convention: Convention) -> None:
    urdf_read = read_urdf(TEXT.encode(), "arm.urdf")
    robot = import_urdf(urdf_read, None, None, ImportOptions(convention=convention, snap=Fraction(0))).robot
    changed = import_urdf(urdf_read, None, None, ImportOptions(convention=convention, snap=Fraction(1, 10000))).robot
    with exactly():
        arm = arm_of(urdf_read, None, None, Fraction(0))
    bound = certify(arm, changed)
    q = np.random.default_rng(2).uniform(-3, 3, (2000, 3))
    apart = pose(changed, q) - pose(robot, q)
    worst = np.linalg.norm(apart[:, :3, 3], axis=1).max()
    turned = np.linalg.norm(apart[:, :3, :3], ord=2, axis=(1, 2)).max()
    assert worst <= bound.position <= 20 * worst
    assert turned <= bound.rotation <= 20 * turned
    assert certify(arm, robot).position < 1e-14


def test_a_slide_whose_limits_leave_no_room_is_bound_for_a_metre() -> None:
    """They are taken as none, so the bound must not rest on them."""
    joints = [J("0 0 0.3"), J("0.1 0 0", "1.5705 0 0", type="prismatic", limit='lower="0" upper="0"'), J("0.2 0 0")]
    read = read_urdf(urdf(joints).encode(), "arm.urdf")
    bound = import_urdf(read, None, None, ImportOptions(snap=Fraction(1, 1000))).certificate
    assert 2.9e-4 < bound.position < 0.01


def test_a_base_that_is_no_rotation_counts_where_the_hand_goes() -> None:
    """At zero the hand is along x, where this base is right; a quarter turn on it is not."""
    read = read_urdf(urdf([J("0 0 0.3"), J("0.5 0 0", type="fixed")]).encode(), "arm.urdf")
    robot = import_urdf(read, None, None, ImportOptions(snap=Fraction(0))).robot
    columns = [list(row) for row in robot.base]
    columns[1][1] = number(Fraction(1001, 1000))
    skew = replace(robot, base=tuple(map(tuple, columns)))
    with exactly():
        arm = arm_of(read, None, None, Fraction(0))
    assert certify(arm, robot).position < 1e-15
    assert 0.5e-3 <= certify(arm, skew).position < 2e-3
