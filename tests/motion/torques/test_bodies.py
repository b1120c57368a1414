"""Bodies that an arm carries."""

from __future__ import annotations

import numpy as np
import pytest

from derive.motion.torques.bodies import CarriedBody, OpenLink
from derive.plans.points import Payload
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Name, number
from derive.robot.names import free_symbols
from derive.robot.robot import Robot


def cloud(seed: int) -> tuple[CarriedBody, np.ndarray, np.ndarray]:
    """A body of five points: its mass, centre and inertia by their sums."""
    random = np.random.default_rng(seed)
    masses, places = random.uniform(1, 2, 5), random.normal(size=(5, 3))
    mass, com = masses.sum(), masses @ places / masses.sum()
    off = places - com
    inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, off, strict=True))
    return CarriedBody(float(mass), com, np.array(inertia)), masses, places


def test_two_bodies_are_one_of_all_their_points() -> None:
    (a, m, p), (b, n, r) = cloud(1), cloud(2)
    masses, places = np.concatenate([m, n]), np.concatenate([p, r])
    both = a + b
    assert both.mass == pytest.approx(masses.sum())
    assert both.com == pytest.approx(masses @ places / masses.sum())
    about_origin = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, places, strict=True))
    assert both.about(np.zeros(3)) == pytest.approx(np.array(about_origin))


def test_columns_are_first_moments_and_inertia_about_the_origin() -> None:
    body, masses, places = cloud(3)
    columns = body.columns(6)
    assert columns["mx6"] == pytest.approx(masses @ places[:, 0])
    assert columns["Ixy6"] == pytest.approx(-(masses @ (places[:, 0] * places[:, 1])))
    assert columns["Izz6"] == pytest.approx(masses @ (places[:, 0] ** 2 + places[:, 1] ** 2))
    assert len(columns) == 10


def test_nothing_and_nothing_is_nothing() -> None:
    none = CarriedBody(0.0, np.zeros(3), np.zeros((3, 3)))
    assert (none + none).mass == 0
    assert not (none + none).inertia.any()


def test_a_payload_stands_in_the_frame_of_the_tool() -> None:
    robot = Robot.from_text(
        "{name: arm, convention: standard, joints: [{type: revolute, a: 1}], links: [{mass: 1}], gravity: [0, 0, -9],"
        " tool: [[1, 0, 0, a], [0, 0, -1, 0], [0, 1, 0, 0.2], [0, 0, 0, 1]]}"
    )
    payload = Payload(number(2), (number(1), number(2), number(3)), (number(4), number(5), number(6)))
    body = CarriedBody.payload(robot, payload, {"a": 0.5})
    assert body.com.tolist() == [1.5, -3, 2.2]
    assert np.diag(body.inertia).tolist() == [4, 6, 5]


def test_an_open_link_has_ten_symbols_that_nobody_else_has() -> None:
    robot = Robot.load("puma560-corke")
    opened = OpenLink.of(robot)
    assert free_symbols(opened.robot) == opened.names
    again = OpenLink.of(opened.robot)
    assert not set(again.names) & set(opened.names)
    body = CarriedBody.last_link(robot, parameter_values(robot))  # type: ignore[arg-type]
    assert opened.values(body)[opened.names[0]] == 0.09
    assert opened.robot.links[-1].mass == Name(opened.names[0])
