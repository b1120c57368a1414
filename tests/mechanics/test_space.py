"""Points, lines and frames in balls."""

from __future__ import annotations

from fractions import Fraction

from derive.mechanics.space import NOTHING, WORLD, Frame, Line, exactly, length, plus, real, unit, vector
from derive.mechanics.vectors import cross, dot


def test_the_nearest_points_of_two_lines_are_joined_by_their_common_normal() -> None:
    with exactly():
        one = Line(vector((1, 2, 3)), unit(vector((1, 1, 4))))
        other = Line(vector((-2, 5, 1)), unit(vector((2, -3, 1))))
        normal = plus(one.nearest(other), other.nearest(one), -1)
        assert abs(dot(normal, one.direction)) < NOTHING
        assert abs(dot(normal, other.direction)) < NOTHING
        assert one.distance(one.nearest(other)) < NOTHING


def test_a_frame_seen_from_another_and_put_back_is_the_same() -> None:
    with exactly():
        z = unit(vector((1, 2, 2)))
        outer = Frame.of(vector((1, 0, -1)), unit(cross(z, vector((1, 0, 0)))), z)
        back = outer.then(WORLD.seen_from(outer))
        assert all(abs(a - b) < NOTHING for a, b in zip(back.origin, WORLD.origin, strict=True))
        assert all(abs(a - b) < NOTHING for a, b in zip(back.z, WORLD.z, strict=True))


def test_balls_enclose_rationals() -> None:
    with exactly():
        third = real(Fraction(1, 3))
        assert (3 * third - 1).contains(0)
        assert abs(3 * third - 1) < NOTHING
        assert abs(length(vector((2, 3, 6))) - 7) < NOTHING
