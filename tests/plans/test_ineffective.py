"""Keys of a plan without effect; further messages stand in `tests.motion.wrong_plans`."""

from __future__ import annotations

import pytest

from derive.errors import RobotFileError
from derive.motion.motion import Motion
from derive.plans.checks import OF_PATHS
from derive.plans.schema import PlanFile
from derive.robot.reading.structure import model_of

BARE = """\
robot: {name: bare, convention: standard, joints: [{type: revolute, a: 1}]}
points: {a: [0], b: [1], c: [2]}
path: [a, {to: b, time: 1}, {to: c, time: 1}]
"""


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("{to: b, time: 1}", "{to: b, time: 1, payload: 2}", "3:37: path entry 2, payload"),
        ("points:", "plant: {payload: 2}\npoints:", "2:8: plant"),
        ("points:", "disturbance: [{joint: q1, torque: 1, end: 2}]\npoints:", "2:14: disturbance"),
    ],
)
def test_what_acts_on_bodies_is_refused_for_a_robot_without_any(old: str, new: str, place: str) -> None:
    with pytest.raises(RobotFileError, match=f"{place}: bare has no dynamics; leave it out, or write links"):
        Motion.from_text(BARE.replace(old, new))


def test_via_stop_of_a_plan_stops_splines_too() -> None:
    spline = BARE + "profile: spline\n"
    assert Motion.from_text(spline)(1.0)[1][0] > 0.5
    assert Motion.from_text(spline + "via: stop\n")(1.0)[1][0] == pytest.approx(0, abs=1e-12)


def test_what_is_about_paths_is_a_part_of_plans() -> None:
    assert set(OF_PATHS) <= set(model_of(PlanFile).model_fields)
