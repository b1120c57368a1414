"""Bodies and frames of a robot, placed for other programs."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb

from derive.exchange.body_chain import RigidBody, body_chain, is_world, quaternion, roll_pitch_yaw
from derive.mechanics.space import WORLD, Frame, exactly, unit, vector
from tests.exchange.arms import dressed, numeric


def matrix(frame: Frame) -> np.ndarray:
    return np.array([[float(axis[k]) for axis in (frame.x, frame.y, frame.z)] for k in range(3)])


@pytest.mark.parametrize("x", [(1, 2, 3), (0, 0, 1), (0, 0, -1), (-1, 0, 0), (0, -1, 0)])
def test_roll_pitch_yaw_and_quaternion_are_the_rotation(x: tuple[int, int, int]) -> None:
    with exactly():
        first = unit(vector(x))
        z = unit(vector((-x[1], x[0], 0) if x[0] or x[1] else (0, 1, 0)))
        frame = Frame.of(vector((0, 0, 0)), first, z)
        (r, p, y), (w, i, j, k) = map(float, roll_pitch_yaw(frame)), map(float, quaternion(frame))
    about_x = np.array([[1, 0, 0], [0, np.cos(r), -np.sin(r)], [0, np.sin(r), np.cos(r)]])
    about_y = np.array([[np.cos(p), 0, np.sin(p)], [0, 1, 0], [-np.sin(p), 0, np.cos(p)]])
    about_z = np.array([[np.cos(y), -np.sin(y), 0], [np.sin(y), np.cos(y), 0], [0, 0, 1]])
    assert np.abs(about_z @ about_y @ about_x - matrix(frame)).max() < 1e-15
    cross = np.array([[0, -k, j], [k, 0, -i], [-j, i, 0]])
    assert np.abs(np.eye(3) + 2 * w * cross + 2 * cross @ cross - matrix(frame)).max() < 1e-15


def test_a_body_and_what_is_taken_away_again_is_the_body() -> None:
    with exactly():
        link, other = (RigidBody.of(link) for link in dressed("planar-3r").links[:2])
        back = link + other + other.negative
        assert all(abs(a - b) < 1e-60 for a, b in zip(back.entries, link.entries, strict=True))
        assert back.link(dressed("planar-3r").links[0]) == dressed("planar-3r").links[0]


def test_only_bodies_that_exist_are_possible() -> None:
    with exactly():
        one = RigidBody(arb(1), vector((0, 0, 0)), (vector((2, 0, 0)), vector((0, 3, 0)), vector((0, 0, 4))))
        assert one.is_possible
        assert not RigidBody(arb(-1), one.com, one.inertia).is_possible
        assert not RigidBody(one.mass, one.com, (one.inertia[0], one.inertia[1], vector((0, 0, 6)))).is_possible
        assert [body.is_possible for body in map(RigidBody.of, numeric("puma560-corke").links)] == [
            False,
            True,
            False,
            True,
            True,
            True,
        ]


def test_points_rods_plates_and_nothing_are_limits_of_bodies() -> None:
    with exactly():
        for mass, moments in ((1, (0, 0, 0)), (1, (0, 3, 3)), (1, (1, 3, 4)), (0, (0, 0, 0)), (0, (1, 2, 2))):
            rows = [vector(tuple(m if i == j else 0 for j in range(3))) for i, m in enumerate(moments)]
            assert RigidBody(arb(mass), vector((0, 0, 0)), (rows[0], rows[1], rows[2])).is_possible


def test_the_drag_of_rotors_is_known_where_axes_keep_their_angles() -> None:
    with exactly():
        scara = body_chain(dressed("scara-matlab", rotors=True)).segments
        puma = body_chain(dressed("puma560-corke", rotors=True)).segments
    assert [s.rotor and s.rotor.drag for s in scara] == [(), (1.0,), (-1.0, -1.0), (-1.0, -1.0, 0.0)]
    assert [s.rotor is not None and s.rotor.drag is None for s in puma] == [False, False, False, True, True, True]


def test_the_world_is_where_it_is() -> None:
    with exactly():
        assert is_world(WORLD)
        assert not is_world(body_chain(numeric("skeleton")).tool) or not is_world(body_chain(numeric("skeleton")).base)
