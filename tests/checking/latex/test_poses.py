"""Names of a pose mean one pose in a whole document: that with which most of its equations hold."""

import pytest

from derive.checking.latex.poses import MARK, Poses
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.checking.test_pages import checked

SPHERICAL = Robot.from_text("""name: spherical-wrist
convention: standard
joints:
  - {type: revolute, d: d1, alpha: pi/2}
  - {type: revolute, a: a2}
  - {type: revolute, alpha: pi/2}
  - {type: revolute, d: d4, alpha: -pi/2}
  - {type: revolute, alpha: pi/2}
  - {type: revolute, d: d6}
""")
WRIST = r"""
$$\theta_4 = \text{atan2}(r_{23}, r_{13})$$
$$\theta_5 = \pm\arccos(r_{33})$$
$$\theta_6 = \text{atan2}(r_{32}, -r_{31})$$
"""


def test_rotations_are_those_of_the_wrist_where_most_equations_need_it() -> None:
    report = checked(SPHERICAL, WRIST)
    assert (report.equal, report.wrong, report.unread) == (3, (), ())
    assert "rotations from frame 3 (3 of 3 equations)" in report.readings[0]
    slipped = checked(SPHERICAL, WRIST.replace("-r_{31}", "r_{31}"))
    assert [finding.quantity for finding in slipped.wrong] == [r"\theta_6"]


@pytest.mark.parametrize("point", ["x_w", "x_c", "p_{wx}"])
def test_the_centre_of_the_wrist_has_names_of_its_own(point: str) -> None:
    other = point.replace("x", "y")
    report = checked(SPHERICAL, rf"$$\theta_1 = \text{{atan2}}({other}, {point})$$")
    assert (report.equal, report.wrong, report.unread) == (1, (), ())


def test_one_equation_that_no_pose_explains_is_not_called_wrong() -> None:
    report = checked(SPHERICAL, r"$$\theta_1 = \text{atan2}(p_x, p_y)$$ $$\theta_2 = \arccos(p_z)$$")
    assert report.wrong == ()
    assert len(report.unread) == 2
    assert "which pose p" in report.unread[0]


def test_the_usual_reading_is_the_end_effector_in_the_base() -> None:
    first, *others = Poses(Model(SPHERICAL), "p_x r_{13} x_3").readings
    assert (first.position, first.reference, first.usual) == (6, 0, True)
    assert {MARK + name for name in ("px", "r13", "x3")} <= first.values.keys()
    assert not any(reading.usual for reading in others)
