"""What wrists reach within their limits, and dexterous parts, against brute force over orientations."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.workspace.point import TURN, ArmPoint, joint_ranges
from derive.workspace.poses import RobotPoses
from derive.workspace.views import Wrist, find_workspace, find_wrist
from tests.workspace.arms import arm

shapely = pytest.importorskip("shapely")

Limits = tuple[float, float]
FULL, HALF, LESS, BEYOND = (-math.pi, math.pi), (-1.6, 1.6), (-1.5, 1.5), (0.0, math.pi)


def wrist_of(joints: str) -> Wrist | None:
    poses = RobotPoses(arm(joints))
    return find_wrist(ArmPoint(poses, joint_ranges(poses)))


def allowed(angle: float, limits: Limits) -> bool:
    """Whether an angle is within limits, by full turns."""
    return (angle - limits[0]) % TURN <= limits[1] - limits[0] + 1e-9


def turns_everywhere(first: Limits, middle: Limits, last: Limits) -> bool:
    """Whether one of both solutions of every orientation, off the places where they are one, is within the limits."""
    return all(
        any(allowed(a + s, first) and allowed(c, middle) and allowed(b + s, last) for s, c in ((0.0, m), (math.pi, -m)))
        for a, b, m in product(*[np.linspace(0.01, TURN, 40)] * 2, np.linspace(0.02, math.pi - 0.02, 9))
    )


@pytest.mark.parametrize("ways", [*product((FULL, HALF, LESS), (FULL, BEYOND, LESS), (FULL, HALF))])
def test_a_wrist_is_complete_if_brute_force_finds_every_orientation(ways: tuple[Limits, Limits, Limits]) -> None:
    cells = [
        f"{{type: revolute, alpha: {alpha}, limits: [{low}, {high}]}}"
        for alpha, (low, high) in zip(("-pi/2", "pi/2", "0"), ways, strict=True)
    ]
    found = wrist_of(f"[{{type: revolute, a: 1}}, {', '.join(cells)}]")
    assert found is not None
    assert found.complete == turns_everywhere(*ways)


def test_a_hand_that_slides_is_no_wrist() -> None:
    slides = "[{type: revolute, a: 1}, {type: revolute, alpha: pi/2}, {type: prismatic, limits: [0.2, 1]}]"
    assert wrist_of(slides) is None


def test_limits_of_a_wrist_that_are_assumed_are_told() -> None:
    assert [way.variable for way in find_workspace(RobotPoses(Robot.load("scara-perugia"))).assumed][-1] == "q4"


@pytest.mark.parametrize(
    "limits", [((-1.2, 2.0), (0.3, 2.4)), pytest.param(((-3.0, 3.0), (-2.5, -0.2)), marks=pytest.mark.sweep)]
)
def test_places_are_dexterous_if_all_orientations_are_reached(limits: tuple[Limits, Limits]) -> None:
    """The pose of a planar arm in closed form: both elbows, within the limits."""
    rows = [f"{{type: revolute, a: {a}, limits: [{w[0]}, {w[1]}]}}" for a, w in zip((1, 0.8), limits, strict=True)]
    (view,) = find_workspace(RobotPoses(arm(f"[{', '.join(rows)}, {{type: revolute, a: 0.15}}]"))).views
    assert view.dexterous is not None
    x, y = np.random.default_rng(5).uniform(-2.0, 2.0, (2, 4_000, 1))
    hand = np.linspace(0.0, TURN, 180, endpoint=False)
    u, v = x - 0.15 * np.cos(hand), y - 0.15 * np.sin(hand)
    bend = (u**2 + v**2 - 1.64) / 1.6
    reached = np.zeros(u.shape, dtype=bool)
    for q2 in (np.arccos(np.clip(bend, -1.0, 1.0)), -np.arccos(np.clip(bend, -1.0, 1.0))):
        q1 = np.arctan2(v, u) - np.arctan2(0.8 * np.sin(q2), 1.0 + 0.8 * np.cos(q2))
        within = [(q - w[0]) % TURN <= w[1] - w[0] for q, w in zip((q1, q2), limits, strict=True)]
        reached |= (np.abs(bend) <= 1.0) & within[0] & within[1]
    places = shapely.points(np.hstack([x, y]))
    clear = shapely.distance(view.dexterous.region.boundary, places) > 5e-3
    assert (shapely.contains(view.dexterous.region, places) == reached.all(axis=1))[clear].all()
    assert reached.all(axis=1).sum() > 20
