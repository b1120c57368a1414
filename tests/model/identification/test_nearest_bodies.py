"""The search for bodies in floats: room, targets, masses for links without one."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.mechanics.space import exactly
from derive.model.identification.exact_scalars import ExactDomain
from derive.model.identification.nearest_bodies import (
    MARGIN,
    Bodies,
    in_own_units,
    least_eigenvalues,
    most_room,
    nearest,
    needed,
    pseudo_inertias,
    size_of,
    targets,
    weighed,
)
from derive.model.identification.regressor_null_space import bare_chain, directions, parameters_of
from derive.model.identification.semidefinite import packed
from derive.robot.description import Inertia, Link
from derive.robot.expression import ZERO, number
from derive.robot.robot import Robot
from tests.exchange.bodied import arm

pytest.importorskip("clarabel")


def bodies_of(robot: Robot) -> Bodies:
    with exactly():
        domain = ExactDomain(robot)
        chain = bare_chain(robot, domain)
        parameters = [value for body in chain.bodies for value in parameters_of(body)]
        return in_own_units(parameters, directions(robot, chain, domain), size_of(chain))


def test_a_pseudo_inertia_is_the_integral_of_place_by_place() -> None:
    points, masses = np.random.default_rng(3).normal(size=(7, 3)), np.arange(1.0, 8.0)
    places = np.column_stack([points, np.ones(7)])
    second = np.einsum("p,pa,pb->ab", masses, points, points)
    tensor = np.trace(second) * np.eye(3) - second
    entries = [tensor[k] for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    found = pseudo_inertias(np.array([[masses.sum(), *(masses @ points), *entries]]))
    assert np.allclose(found, [np.einsum("p,pa,pb->ab", masses, places, places)])


def test_a_body_in_its_own_units_has_mass_one_and_no_first_moment() -> None:
    found = bodies_of(arm("spatial"))
    assert np.allclose(found.given[:, 6:9], 0, atol=1e-12)
    assert np.allclose(found.given[:, 9], 1)
    assert least_eigenvalues(found).min() > 0


def test_steps_to_the_nearest_bodies_keep_to_the_targets() -> None:
    robot = arm("spatial", "modified")
    flat = replace(robot.links[1], inertia=Inertia(number(Fraction(4)), number(1), number(1), ZERO, ZERO, ZERO))
    bodies = bodies_of(replace(robot, links=(robot.links[0], flat, *robot.links[2:])))
    room = most_room(bodies)
    target = targets(bodies, room)
    assert least_eigenvalues(bodies).min() < 0 < target.min()
    assert room.value == pytest.approx(MARGIN, rel=1e-3)
    assert 1 in needed(bodies, target)
    assert (least_eigenvalues(bodies, nearest(bodies, target)) >= 0.99 * target).all()


def test_a_link_that_needs_a_little_changes_beside_one_that_needs_much() -> None:
    given = packed(np.array([np.diag([-0.1, 1, 1, 1]), np.diag([0.0, 1, 1, 1]), np.diag([0.1, 1, 1, 1])]))
    along = np.zeros((3, 10, 3))
    along[[0, 1, 2], 0, [0, 1, 2]] = 1
    bodies = Bodies(given, along, np.array([np.eye(4)] * 3), np.zeros(3))
    assert needed(bodies, np.full(3, MARGIN / 2)) == [0, 1]


def test_links_without_a_mass_get_as_much_of_one_as_torques_allow_each() -> None:
    """A sole Izz bounds the mass of a link that has its centre off the axis; all or nothing would leave nothing."""
    robot = arm("planar")
    small = Inertia(number(Fraction(1, 10)), number(Fraction(1, 10)), number(Fraction(1, 50)), ZERO, ZERO, ZERO)
    bare = replace(robot, links=(robot.links[0], Link(inertia=small), Link(inertia=small)))
    bodies = bodies_of(bare)
    target = targets(bodies, most_room(bodies))
    found = weighed(bodies, target)
    assert found.masses[0] == 0
    assert (found.masses[1:] > 1e-3).all()
    assert found.masses.min() < 0.4
    steps = nearest(found, target)
    assert (least_eigenvalues(found, steps) >= 0.99 * target).all()
    assert ((found.given + found.along @ steps)[1:, -1] >= 0.99 * found.masses[1:]).all()
