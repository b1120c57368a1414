"""Vectors and frames in floats; points, lines and frames in balls."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from derive.mechanics import space
from derive.mechanics.chain import Body
from derive.mechanics.joint_motion import (
    advance,
    body_to_parent,
    generalized_force,
    shift,
    tensor_to_parent,
    to_child,
    to_parent,
    turn_about_z,
    turn_tensor,
)
from derive.mechanics.regressor import link_screws
from derive.mechanics.space import NOTHING, WORLD, Line, exactly, length, plus, real, unit, vector
from derive.mechanics.vectors import Frame, Symmetric, cross, dot, from_matrix, identity, multiply
from tests.mechanics.arms import SEEDS, arm_of, assert_close

RNG = np.random.default_rng(3)
A, B = (tuple(row) for row in RNG.uniform(-1, 1, (2, 3)).tolist())
TENSOR = Symmetric(1.0, 2.0, 1.5, 0.1, -0.2, 0.3)


def rotation(seed: int) -> Any:
    q, _ = np.linalg.qr(np.random.default_rng(seed).uniform(-1, 1, (3, 3)))
    return tuple(map(tuple, (q * np.sign(np.linalg.det(q))).tolist()))


@pytest.mark.parametrize("seed", range(4))
def test_turned_tensors_are_those_of_turned_axes(seed: int) -> None:
    turn, matrix = np.array(rotation(seed)), np.array(TENSOR.matrix)
    assert_close(turn_tensor(rotation(seed), TENSOR).matrix, turn @ matrix @ turn.T)
    c, s = np.cos(seed), np.sin(seed)
    about_z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert_close(turn_about_z(c, s, TENSOR).matrix, about_z @ matrix @ about_z.T)


def test_a_shifted_tensor_is_that_of_the_same_masses() -> None:
    """Eight point masses, summed about the old and about the new origin."""
    masses, places, p = RNG.uniform(0.5, 2, 8), RNG.uniform(-1, 1, (8, 3)), np.array(A)

    def about(origin: np.ndarray) -> np.ndarray:
        return sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, places - origin, strict=True))

    moment = tuple((masses @ places).tolist())
    before = from_matrix(tuple(map(tuple, about(np.zeros(3)).tolist())))
    assert_close(shift(float(masses.sum()), moment, before, tuple((-p).tolist())).matrix, about(p))


def test_frames_compose_and_invert() -> None:
    one, two = Frame(rotation(1), A), Frame(rotation(2), B)
    numbers = [np.array(frame.rows(0.0, 1.0)) for frame in (one, two, one @ two, one.inverse)]
    assert_close(numbers[2], numbers[0] @ numbers[1])
    assert_close(numbers[3] @ numbers[0], np.eye(4))


@pytest.mark.parametrize("seed", SEEDS)
def test_a_joint_leads_to_its_child_and_back(seed: int) -> None:
    chain = arm_of(seed).chain
    for joint in chain.joints:
        assert_close(to_parent(joint, to_child(joint, A)), A)
        frame = advance(Frame(identity(0.0, 1.0), (0.0, 0.0, 0.0)), joint)
        assert_close(multiply(frame.rotation, A), to_parent(joint, A))
        turn = np.array(frame.rotation)
        assert_close(tensor_to_parent(joint, TENSOR).matrix, turn @ np.array(TENSOR.matrix) @ turn.T)
        assert generalized_force(joint, A, B) == pytest.approx(B[2] if joint.revolute else A[2])


@pytest.mark.parametrize("seed", SEEDS)
def test_a_body_carried_to_the_parent_keeps_its_mass_and_its_kinetic_energy(seed: int) -> None:
    chain = arm_of(seed).chain
    body = Body(2.0, A, Symmetric(3.0, 4.0, 3.5, 0.1, -0.2, 0.3))
    for joint in chain.joints:
        carried = body_to_parent(joint, body)
        frame = advance(Frame(identity(0.0, 1.0), (0.0, 0.0, 0.0)), joint)
        linear, angular = np.array(B), np.array((0.3, -0.7, 0.5))
        there = linear + np.cross(angular, frame.position)
        turned = np.array(frame.rotation).T
        assert carried.mass == body.mass
        energies = [energy(carried, linear, angular), energy(body, turned @ there, turned @ angular)]
        assert energies[0] == pytest.approx(energies[1], rel=1e-12)


def energy(body: Body[float], v: np.ndarray, w: np.ndarray) -> float:
    """Twice the kinetic energy of a body whose frame moves."""
    return float(body.mass * v @ v + 2 * v @ np.cross(w, body.first_moment) + w @ np.array(body.inertia.matrix) @ w)


@pytest.mark.parametrize("seed", SEEDS)
def test_screws_of_the_last_link_are_the_jacobian(seed: int) -> None:
    arm = arm_of(seed)
    chain, n = arm.chain, arm.robot.n
    last = [screw.seen_from(chain.tool) for screw in link_screws(chain)[-1]]
    pose = arm.expected("forward_kinematics")[:3, :3]
    signs = [joint.sign for joint in chain.joints]
    columns = [[*pose @ screw.linear, *pose @ screw.angular] for screw in last]
    assert_close(np.array(columns).T * signs, arm.expected("jacobian").reshape(6, n))


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
        tilted = space.Frame.of(vector((1, 0, -1)), unit(cross(z, vector((1, 0, 0)))), z)
        back = tilted.then(WORLD.seen_from(tilted))
        assert all(abs(a - b) < NOTHING for a, b in zip(back.origin, WORLD.origin, strict=True))
        assert all(abs(a - b) < NOTHING for a, b in zip(back.z, WORLD.z, strict=True))


def test_balls_enclose_rationals() -> None:
    with exactly():
        third = real(Fraction(1, 3))
        assert (3 * third - 1).contains(0)
        assert abs(3 * third - 1) < NOTHING
        assert abs(length(vector((2, 3, 6))) - 7) < NOTHING
