"""Bodies that exist and move as the given ones: torques by the oracle, acceptance and accelerations by MuJoCo."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.mechanics.space import exactly
from derive.model.identification.exact_scalars import ExactDomain, as_fraction
from derive.model.identification.possible import possible
from derive.model.identification.regressor_null_space import bare_chain, combined, directions, parameters_of
from derive.robot.description import Inertia, Link
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import TABLES, arm, with_links
from tests.motion.mjcf import mjcf

pytest.importorskip("clarabel")


def spoiled(robot: Robot, by: float) -> Robot:
    """The same torques from bodies that are moved far along a direction that no torque notices."""
    random = np.random.default_rng(1)
    with exactly():
        domain = ExactDomain(robot)
        chain = bare_chain(robot, domain)
        basis = directions(robot, chain, domain)
        weights = [domain.number(Fraction(round(float(w) * 1000), 1000)) for w in random.normal(0, by, len(basis))]
        moved = combined(basis, weights)
        links = []
        for i, (link, body) in enumerate(zip(robot.links, chain.bodies, strict=True)):
            change = moved[10 * i : 10 * i + 10]
            if robot.convention == "standard":
                links.append(link)
                continue
            m, hx, hy, hz, *tensor = (
                as_fraction(a) + as_fraction(b) for a, b in zip(parameters_of(body), change, strict=True)
            )
            r = np.array([hx / m, hy / m, hz / m])
            steiner = m * (np.dot(r, r) * np.eye(3, dtype=int) - np.outer(r, r))
            places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
            own = (number(Fraction(t - steiner[place])) for t, place in zip(tensor, places, strict=True))
            links.append(replace(link, mass=number(m), com=tuple(map(number, r)), inertia=Inertia(*own)))
    return replace(robot, links=tuple(links))


def slack(robot: Robot) -> float:
    """How far all bodies are from the limit of the triangle inequality, as a part of their largest moment."""
    oracle = Oracle.of(robot).arm
    assert (oracle.mass > 0).all()
    moments = np.linalg.eigvalsh(oracle.inertia)
    return float(((moments[:, 0] + moments[:, 1] - moments[:, 2]) / moments[:, 2]).min())


def same_torques(one: Robot, other: Robot) -> None:
    random = np.random.default_rng(3)
    q, qd, qdd = random.uniform(-2, 2, (3, 30, one.n))
    given, found = Oracle.of(one), Oracle.of(other)
    calls = {"inverse_dynamics": (q, qd, qdd), "inertia_matrix": (q,), "gravity_vector": (q,)}
    torque = np.abs(given.evaluate("inverse_dynamics", q, qd, qdd)).max()
    for name, arguments in (calls | {"coriolis_vector": (q, qd)}).items():
        expected = given.evaluate(name, *arguments)
        largest, all_of_them = np.abs(expected).max(axis=0), np.abs(expected).max()
        if all_of_them < 1e-9 * torque:  # nothing but rounding, as the Coriolis terms of an arm without masses
            all_of_them = torque
        error = np.abs(found.evaluate(name, *arguments) - expected).max(axis=0)
        assert (error <= 1e-12 * np.where(largest > 1e-9 * all_of_them, largest, all_of_them)).all(), name


def test_corke_s_puma_has_bodies_that_exist_and_move_the_same() -> None:
    robot = Robot.load("puma560-corke")
    found = possible(robot)
    assert slack(robot.of(replace(robot, links=robot.links[1:3] * 3))) < 0 < slack(found.robot)
    same_torques(robot, found.robot)
    assert [change.link for change in found.changes] == [1, 3]
    for i in (1, 3, 4, 5):  # nothing moved that need not
        assert found.robot.links[i] == robot.links[i]
    assert not found.border
    assert to_float(found.robot.links[0].mass, {}) > 0.1  # not a body of a gram that is kilometres wide
    assert "2 of 6 links changed" in found.report[0]


def test_mujoco_takes_the_bodies_and_accelerates_as_the_given_ones() -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = Robot.load("puma560-corke")
    found = possible(robot).robot
    values = {name: float(value) for name, value in parameter_values(robot).items()}
    with pytest.raises(ValueError, match="inertia must"):
        mujoco.MjModel.from_xml_string(mjcf(robot, values, 1e-3))
    model = mujoco.MjModel.from_xml_string(mjcf(found, values, 1e-3))
    data, oracle = mujoco.MjData(model), Oracle.of(robot)
    random = np.random.default_rng(1)
    for _ in range(20):
        q, qd, tau = random.uniform(-3, 3, (3, 6))
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, qd, 20 * tau
        mujoco.mj_forward(model, data)
        expected = oracle.evaluate("forward_dynamics", q, qd, 20 * tau)
        assert np.abs(expected - data.qacc).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("name", TABLES)
def test_bodies_that_exist_are_found_from_others_with_the_same_torques_and_stay_as_they_are(name: str) -> None:
    robot = arm(name, "modified")
    wrong = spoiled(robot, 0.5)
    same_torques(robot, wrong)
    found = possible(wrong)
    same_torques(robot, found.robot)
    assert found.changes
    assert slack(found.robot) > 1e-6
    kept = possible(arm(name))
    assert kept.robot == arm(name)
    assert kept.report == ("all links exist as they are",)


def test_robots_without_numbers_or_links_are_refused_by_name() -> None:
    with pytest.raises(DeriveError, match="a1, a2"):
        possible(replace(Robot.load("planar-2r-perugia"), parameters=()))
    with pytest.raises(DeriveError, match="no masses"):
        possible(Robot.load("kuka-kr5"))


def test_a_massless_link_gets_a_mass_where_torques_allow_it() -> None:
    robot = arm("upright")
    bare = replace(robot, links=(Link(inertia=robot.links[0].inertia), *robot.links[1:]))
    found = possible(bare)
    assert [change.link for change in found.changes] == [1]
    same_torques(bare, found.robot)
    assert slack(found.robot) > 1e-6


def test_a_link_whose_mass_torques_keep_at_zero_gets_no_first_moment() -> None:
    """The slide's mass is seen by gravity; a first moment beside its second ones would be within rounding."""
    given = with_links(
        arm("upright", "modified"),
        ("3.6", "0.1 0.2 0.1", "0.2 0.2 0.1 0 0 0"),
        ("2.8", "0.26 -0.06 -0.05", "0.2 0.01 0.1 0.05 0 0"),
        ("0", "0 0 0", "0.3 0.2 0.4 0 0 0"),
    )
    found = possible(given)
    same_torques(given, found.robot)
    assert found.border == (3,)
    assert found.report[-1].startswith("link 3 is at the limit of what exists")
    assert found.robot.links[2].mass == given.links[2].mass
    assert found.robot.links[2].com == given.links[2].com
    moments = np.linalg.eigvalsh(Oracle.of(found.robot).arm.inertia)
    assert (moments[:, 0] + moments[:, 1] > (1 - 1e-7) * moments[:, 2]).all()


def test_a_last_link_that_weighs_nothing_stays_so_beside_one_that_changes() -> None:
    given = with_links(
        arm("spatial", "modified"),
        ("0.9", "0.1 -0.2 0.1", "0.1 0.1 0.08 0 0 0.01"),
        ("1.9", "-0.13 -0.23 0.07", "0.23 0.015 0.2 0 0 0"),
        ("1.7", "-0.11 0.01 0.25", "0.16 0.25 0.19 0.01 0.02 -0.02"),
        ("0", "0 0 0", "0 0 0 0 0 0"),
    )
    found = possible(given)
    same_torques(given, found.robot)
    assert found.border == (4,)
    assert 2 in [change.link for change in found.changes]
    assert found.robot.links[3] == given.links[3]


def test_a_symbol_whose_cells_become_numbers_is_no_parameter_any_more() -> None:
    """Otherwise the file that is written could not be read: no cell uses this parameter."""
    found = possible(Robot.from_text(TABLE_WITH_SYMBOLS))
    assert [change.link for change in found.changes] == [1, 2]
    again = Robot.from_text(found.text)
    assert dict(again.parameters).keys() == {"a1", "g"}
    assert again.runtime == ("a1",)


TABLE_WITH_SYMBOLS = """
name: symbols
convention: standard
joints:
  - {type: revolute, q: q1, theta: q1, a: a1}
  - {type: revolute, q: q2, theta: q2, a: 0.3, alpha: pi/2}
gravity: [0, -g, 0]
links:
  - {mass: 0, com: [0, 0, 0], inertia: {xx: I1, yy: 0.01, zz: 0.02}}
  - {mass: m2, com: [-0.1, 0, 0], inertia: {xx: I2, yy: 0.01, zz: 0.02}}
parameters: {a1: 0.5, g: 9.81, I1: 0.5, I2: -0.1, m2: 2}
runtime: [a1, I2]
"""
