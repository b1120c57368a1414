"""The step between base and standard parameters, by regressors of the oracle; robot files that have what was found."""

import random
from dataclasses import replace

import numpy as np
import pytest

from derive.api.convert import export
from derive.api.robots import load
from derive.errors import DeriveError
from derive.identification.regression import Estimate
from derive.identification.standard import Unknowns
from derive.model.identification.possible import pseudo_inertias
from derive.robot.description import Link
from derive.robot.evaluate import to_float
from derive.robot.expression import number
from derive.robot.inertial_parameters import FRICTION_PARTS
from derive.robot.robot import Robot
from derive.robot.writer import robot_text
from derive.verification.oracle.functions import Oracle
from tests.identification.logs import PUMA, REAL
from tests.random_robots import RandomRobot, random_robot
from tests.random_trees import random_tree

SLIDES = """\
name: slides
convention: modified
joints:
  - {type: prismatic, alpha: pi/2}
  - {type: revolute, a: a, d: 0.2}
  - {type: revolute, alpha: pi/3, a: 0.3}
gravity: [0, 0, -9.81]
links:
  - {mass: 3, motor: {mass: 0.5, inertia: 0.01, ratio: 30}}
  - {mass: m, com: [0.1, 0, 0.05], inertia: {xx: 0.1, yy: 0.2, zz: 0.2}, armature: 0.3, friction: {coulomb: [1, 2]}}
  - {mass: 1, com: [0, 0.1, 0.05], motor: {mass: 0.2, inertia: 0.001, ratio: 50}, armature: 0.3}
parameters: {a: 0.4, m: 2}
runtime: [a, m]
"""


def numbered(drawn: RandomRobot) -> Robot:
    """With numbers for symbols that have none."""
    robot = Robot.from_text(drawn.text)
    lacking = drawn.values.keys() - dict(robot.parameters).keys()
    numbers = ((name, number(repr(drawn.values[name]))) for name in sorted(lacking))
    return replace(robot, parameters=(*robot.parameters, *numbers))


def cases() -> list[Robot]:
    drawn = [random_robot(random.Random(seed)) for seed in range(40, 47)]
    grown = [random_tree(random.Random(seed), 5) for seed in (0, 1, 2, 219, 225)]
    trees = [tree.table for tree in grown if tree.root is None]
    return [REAL, Robot.from_text(SLIDES), *(robot for robot in map(numbered, (*drawn, *trees)) if robot.links)]


CASES = cases()


@pytest.mark.parametrize("robot", CASES, ids=lambda robot: robot.name)
@pytest.mark.first(2)
def test_base_parameters_are_the_grouping_times_the_standard_ones(robot: Robot) -> None:
    unknowns = Unknowns.of(robot, ("viscous", "coulomb", "armature"))
    base, oracle = unknowns.base.parameters, Oracle.of(unknowns.wide, base=unknowns.base.parameters)
    state = np.random.default_rng(1).uniform(-1, 1, (3, 30, robot.n))
    own, standard = (oracle.evaluate(name, *state) for name in ("base_regressor", "regressor"))
    assert own @ unknowns.grouping == pytest.approx(standard, rel=1e-9, abs=1e-9 * np.abs(standard).max())
    tau = Oracle.of(robot).evaluate("inverse_dynamics", *state)
    assert own @ unknowns.prior == pytest.approx(tau, rel=1e-9, abs=1e-9 * np.abs(tau).max())
    given = dict(zip(unknowns.standard, unknowns.given, strict=True))  # friction is grouped with nothing, to the bit
    assert all(v == given[p] for p, v in zip(base, unknowns.prior, strict=True) if p.part in FRICTION_PARTS)
    assert (unknowns.units > 0).all()
    # The same in formulas, by numbers for all names.
    values = {name: to_float(cell, {}) for name, cell in robot.parameters}
    values |= dict(zip((p.name for p in unknowns.standard), unknowns.given, strict=True))
    if not robot.fixed and None not in unknowns.formulas:
        found = [to_float(formula, values) for formula in unknowns.formulas if formula]
        assert found == pytest.approx(unknowns.prior, rel=1e-9, abs=1e-9)
    assert len(unknowns.formulas) == len(base)


@pytest.mark.parametrize("robot", CASES, ids=lambda robot: robot.name)
@pytest.mark.first(5)
def test_the_nearest_robot_has_the_base_parameters_and_reads_back(robot: Robot) -> None:
    unknowns = Unknowns.of(robot, ("viscous", "coulomb"))
    wanted = unknowns.prior + 0.02 * np.random.default_rng(2).normal(size=len(unknowns.prior)) * np.abs(unknowns.prior)
    standard = unknowns.nearest(wanted)
    found = unknowns.robot_of(standard)
    back = Unknowns.of(Robot.from_text(robot_text(found)), ("viscous", "coulomb"))
    assert back.prior == pytest.approx(wanted, rel=1e-8, abs=1e-8 * np.abs(wanted).max())
    # No other change is shorter: this one is orthogonal to all that change no torque.
    change = (standard - unknowns.given) / unknowns.units
    movable = [p.part != "mm" for p in unknowns.standard]  # masses of rotors stay
    null = np.linalg.svd(unknowns.grouping * unknowns.units * movable)[2][len(wanted) :]
    assert null @ change == pytest.approx(np.zeros(len(null)), abs=1e-8 * max(1.0, np.linalg.norm(change)))
    assert unknowns.robot_of(unknowns.nearest(unknowns.prior)).links == robot.links


def estimated(unknowns: Unknowns, beta: np.ndarray, noise: float) -> Estimate:
    """What a log of random rows says."""
    oracle = Oracle.of(unknowns.wide, base=unknowns.base.parameters)
    rows = oracle.evaluate("base_regressor", *np.random.default_rng(3).uniform(-2, 2, (3, 300, unknowns.robot.n)))
    flat = rows.reshape(-1, rows.shape[2]) / noise
    factor = np.linalg.qr(np.column_stack([flat, flat @ beta]), mode="r")
    return Estimate(beta, np.zeros(len(beta)), np.zeros(len(beta), dtype=bool), factor)


def test_bodies_that_exist_are_as_near_as_can_be_and_load_in_mujoco() -> None:
    pytest.importorskip("clarabel")
    mujoco = pytest.importorskip("mujoco")
    unknowns = Unknowns.of(PUMA, ("viscous", "coulomb"))
    truth = Unknowns.of(REAL).prior
    for noise in (0.01, 1e-6):
        possible = unknowns.nearest_possible(estimated(unknowns, truth, noise))
        assert unknowns.prior + unknowns.grouping @ (possible - unknowns.given) == pytest.approx(truth, abs=1e-6)
    wrong = truth.copy()
    wrong[[p.name for p in unknowns.base.parameters].index("Izz5")] = -0.01  # nothing turns so
    for beta in (truth, wrong):
        standard = unknowns.nearest_possible(estimated(unknowns, beta, 0.01))
        bodies = np.array([standard[k : k + 10] for k, p in enumerate(unknowns.standard) if p.part == "m"])
        assert np.linalg.eigvalsh(pseudo_inertias(bodies)).min() > 0
        model = mujoco.MjModel.from_xml_string(export(Robot.of(unknowns.robot_of(standard)), "mjcf"))
        assert model.nv == 6


def test_a_robot_of_which_nothing_is_known_gets_masses() -> None:
    blank = replace(PUMA, links=tuple(Link() for _ in PUMA.links))
    unknowns = Unknowns.of(blank, ("viscous", "coulomb", "armature"))
    assert np.isinf(unknowns.largest).all()
    truth = dict(zip((p.name for p in Unknowns.of(REAL).base.parameters), Unknowns.of(REAL).prior, strict=True))
    wanted = np.array([truth[p.name] for p in unknowns.base.parameters])
    back = Unknowns.of(Robot.from_text(robot_text(unknowns.robot_of(unknowns.nearest(wanted)))), ("armature",))
    assert back.prior == pytest.approx(wanted, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize(
    ("robot", "message"),
    [
        ("kuka-kr5", "kuka-kr5 has no links to identify; write links with a mass each, 0 where"),
        ("scara-perugia", "the symbol 'a1' of scara-perugia has no number"),
        ("palletiser", "identification of palletiser, whose joints are coupled"),
        ("human-skeleton", "identification of human-skeleton, whose root moves"),
        ("four-bar", "identification of four-bar, which has closed loops"),
    ],
)
def test_what_cannot_be_identified(robot: str, message: str) -> None:
    with pytest.raises(DeriveError, match=message):
        Unknowns.of(load(robot, remarks_on_bodies=False))
    with pytest.raises(DeriveError, match=r"no part 'viscos' to add; .*; did you mean 'viscous'"):
        Unknowns.of(PUMA, ("viscos",))
