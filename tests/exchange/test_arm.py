"""A chain of a URDF as lines in space."""

from __future__ import annotations

from fractions import Fraction

import pytest

from derive.errors import RobotFileError
from derive.exchange.arm import arm_of, snapped, tips
from derive.exchange.read_urdf import read_urdf
from derive.exchange.urdf import Urdf
from derive.mechanics.space import exactly
from tests.exchange.urdfs import HALF, J, urdf

SNAP = Fraction(1, 10**6)


def read(*joints: J) -> Urdf:
    return read_urdf(urdf(joints).encode(), "arm.urdf")


def test_fixed_joints_are_folded() -> None:
    with exactly():
        arm = arm_of(read(J("0 0 1", HALF + " 0 0", type="fixed"), J("0 0 1")), None, None, SNAP)
    assert len(arm.axes) == 1
    line = arm.axes[0].line
    assert [float(c) for c in line.point] == [0, -1, 1]
    assert [float(c) for c in line.direction] == [0, -1, 0]


def test_angles_near_fractions_of_pi_are_taken_for_them() -> None:
    with exactly():
        written = (Fraction("1.570796"), Fraction(0), Fraction(0))
        assert snapped(written, SNAP)[0] != snapped(written, Fraction(0))[0]
        assert float(snapped(written, SNAP)[0]) == float(HALF)


def test_several_tips_are_listed() -> None:
    tree = read(J(link="left"), J(link="right", parent="l0"))
    assert tips(tree) == ("left", "right")
    with exactly(), pytest.raises(RobotFileError, match="left, right"):
        arm_of(tree, None, None, SNAP)


@pytest.mark.parametrize(
    ("joint", "found"),
    [
        (J(type="floating"), "is floating"),
        (J(type="planar"), "is planar"),
        (J(type="screw"), "arm.urdf:5.*of type 'screw'; allowed: revolute, continuous, prismatic, fixed"),
        (J(axis="0 0 0.0"), "arm.urdf:5.*an axis of length 0"),
        (J(more="<mimic/>"), "follows ''"),
        (J(more='<mimic joint="j0"/>'), "follows 'j0'"),
        (J(type="fixed"), "no joint moves"),
    ],
)
def test_joints_that_no_table_has_are_refused_by_name(joint: J, found: str) -> None:
    with exactly(), pytest.raises(RobotFileError, match=found):
        arm_of(read(joint), None, None, SNAP)
