"""Segments of a plan: which of them move the end effector in space."""

from __future__ import annotations

import pytest

from derive.motion.motion import Motion
from derive.plans.points import Step

PLAN = """\
robot: planar-3r
values: {{a1: 1, a2: 1, a3: 1}}
points: {{a: [0, 0.5, 0.5], b: [0.2, 0.4, 0.6]}}
path: [a, {{to: b, time: 1{more}}}]
"""


@pytest.mark.parametrize(("more", "in_space"), [("", False), (", line: yes", True)])
def test_lines_are_in_space_and_profiles_of_joints_are_not(more: str, in_space: bool) -> None:
    (step,) = Motion.from_text(PLAN.format(more=more)).plan.steps
    assert isinstance(step, Step)
    assert step.in_space is in_space
