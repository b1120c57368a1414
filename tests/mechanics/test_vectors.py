"""Vectors between joint frames; points, lines and frames in balls."""

import pytest

from derive.mechanics import space
from derive.mechanics.joint_motion import advance, to_child, to_parent
from derive.mechanics.space import NOTHING, WORLD, Line, exactly, plus, unit, vector
from derive.mechanics.vectors import Frame, axial_tensor, cross, dot, identity, multiply
from tests.mechanics.arms import SEEDS, arm_of, assert_close


@pytest.mark.parametrize("seed", SEEDS)
def test_a_joint_leads_to_its_child_and_back(seed: int) -> None:
    for joint in arm_of(seed).chain.joints:
        frame = advance(Frame(identity(0.0, 1.0), (0.0, 0.0, 0.0)), joint)
        assert_close(to_parent(joint, to_child(joint, (0.3, -0.7, 0.5))), (0.3, -0.7, 0.5))
        assert_close(multiply(frame.rotation, (0.3, -0.7, 0.5)), to_parent(joint, (0.3, -0.7, 0.5)))


def test_what_turns_about_one_axis_alone_resists_no_other_turning() -> None:
    axis, tensor = (1 / 3, 2 / 3, 2 / 3), axial_tensor(0.75, (1 / 3, 2 / 3, 2 / 3)).matrix
    assert_close(multiply(tensor, axis), (0.25, 0.5, 0.5))
    assert_close(multiply(tensor, (2 / 3, 1 / 3, -2 / 3)), (0, 0, 0))
    assert_close(multiply(tensor, (2 / 3, -2 / 3, 1 / 3)), (0, 0, 0))


def test_lines_have_a_common_normal_and_frames_are_put_back() -> None:
    with exactly():
        one, other = (Line(vector(p), unit(vector(d))) for p, d in (((1, 2, 3), (1, 1, 4)), ((-2, 5, 1), (2, -3, 1))))
        normal = plus(one.nearest(other), other.nearest(one), -1)
        assert all(abs(dot(normal, line.direction)) < NOTHING for line in (one, other))
        z = unit(vector((1, 2, 2)))
        tilted = space.Frame.of(vector((1, 0, -1)), unit(cross(z, vector((1, 0, 0)))), z)
        back = tilted.then(WORLD.seen_from(tilted))
        assert all(abs(a - b) < NOTHING for a, b in zip((*back.origin, *back.z), (0, 0, 0, 0, 0, 1), strict=True))
