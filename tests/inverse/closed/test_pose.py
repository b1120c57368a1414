"""The pose of an arm in exact polynomials: what is zero, one or equal wherever the arm reaches."""

from __future__ import annotations

import numpy as np
import pytest

from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.formulas import GraphDerivation
from derive.inverse.closed.pose import Pose
from derive.inverse.closed.solve import solve
from derive.inverse.numeric.chain import NumericChain
from derive.robot.robot import Robot


def pose_of(name: str) -> Pose:
    robot = Robot.load(name)
    return GraphDerivation(robot, robot.inverse.task).pose


def test_an_arm_with_parallel_axes_has_a_rotation_of_two_numbers() -> None:
    (a, b, x), (c, d, y), (u, v, z) = pose_of("scara-perugia").atoms.rotation
    assert not any((x, y, u, v))
    assert z.is_constant
    assert z * z == 1
    assert (a * d - b * c) * z in (a * a + c * c, -(a * a) - c * c)


def test_nine_entries_of_a_spatial_arm_are_told_apart() -> None:
    entries = [entry for row in pose_of("puma560-corke").atoms.rotation for entry in row]
    assert len({str(entry) for entry in entries}) == 9
    assert not any(entry.is_constant for entry in entries)


def test_what_is_defined_comes_after_what_it_needs() -> None:
    known: set[str] = set()
    definitions = pose_of("puma560-corke").definitions
    for name, value in definitions.items():
        used = {other for other, degree in zip(value.ring.names, value.degrees(), strict=True) if degree}
        assert used & set(definitions) <= known
        known.add(name)


@pytest.mark.parametrize(
    ("joints", "task"),
    [
        ("{type: revolute, a: 0.5}, {type: revolute, a: 0.5}", "[x, y]"),
        ("{type: revolute, d: 0.3, alpha: pi/2}, {type: revolute, a: 0.5}, {type: revolute, a: 0.5}", "position"),
        ("{type: revolute, d: 0.3, alpha: pi/2}, {type: revolute, a: 1}", "[x, z]"),
        ("{type: revolute, d: 1, alpha: pi/2}, {type: revolute, a: 1}, {type: revolute, a: 1}", "position"),
    ],
)
def test_equal_lengths_do_not_make_a_position_depend_on_the_orientation(joints: str, task: str) -> None:
    robot = Robot.from_text(f"name: arm\nconvention: standard\njoints: [{joints}]\ninverse: {{task: {task}}}\n")
    solver = InverseSolver.of(robot, solve(robot))
    pose = NumericChain.of(robot).pose_and_jacobian(np.full((1, robot.n), 0.7))[0][0]
    found = solver.solve(pose)
    pose[:3, :3] = [[0, 0.6, 0.8], [1, 0, 0], [0, 0.8, -0.6]]
    assert found.status.any()
    assert solver.solve(pose).q == pytest.approx(found.q, nan_ok=True)
