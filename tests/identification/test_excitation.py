"""Exciting motions: what they promise of the parameters, and that joints can do them."""

import random
from dataclasses import replace
from decimal import Decimal
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import sympy

from derive.api.excite import _noise, _room, excite
from derive.identification.excitation import (
    BETWEEN,
    Criterion,
    Design,
    Excitation,
    FourierSeries,
    condition,
    information,
    written,
)
from derive.identification.standard import Unknowns
from derive.motion.motion import Motion
from derive.motion.torques.functions import Functions
from derive.robot.robot import Robot

ARM = """\
name: arm
convention: standard
units: {angle: deg, length: mm}
joints:
  - {type: revolute, d: 300, alpha: 90, limits: [-170, 170], speed: 120}
  - {type: revolute, a: 400, alpha: -90, limits: [-20, 120], speed: 100, torque: 27}
  - {type: prismatic, limits: [100, 500], speed: 600, torque: 40}
gravity: [0, 0, -9.81]
links:
  - {mass: 4, com: [0, 50, 10], inertia: {xx: 0.02, yy: 0.02, zz: 0.01}, friction: {viscous: 1.5, coulomb: 2}}
  - {mass: 5, com: [-150, 10, 0], inertia: {xx: 0.01, yy: 0.07, zz: 0.07}, armature: 0.2, friction: {coulomb: [3, 4]}}
  - {mass: 2, com: [0, 0, -60], inertia: {xx: 0.01, yy: 0.01, zz: 0.002}}
"""
"""Angles in degrees, lengths in millimetres, a slide, friction by direction, and torques that limit."""
LIMITS = {"acceleration": ["200", "200", "1500"]}
FLOOR = 0.25
CRITERIA = pytest.mark.parametrize("criterion", ["determinant", pytest.param("condition", marks=pytest.mark.sweep)])


@cache
def arm() -> Robot:
    """The robot."""
    return Robot.from_text(ARM)


@cache
def found(criterion: str) -> Excitation:
    """Its motion."""
    return excite(arm(), criterion=criterion, **LIMITS, floor=FLOOR, noise=[0.1, 0.2, 0.5], starts=1)


def design(criterion: str, robot: Robot | None = None) -> Design:
    """What it is found by."""
    robot = robot or arm()
    series, room, noise = FourierSeries(10.0, 5), _room(robot, LIMITS, FLOOR), _noise(robot, [0.1, 0.2, 0.5])
    return Design(Unknowns.of(robot, ("viscous", "coulomb")), series, room, Criterion(criterion), noise)


def stacked(motion: Motion) -> np.ndarray:
    """The base regressors of its samples, (t, n, p), by the generated NumPy functions."""
    wide = design("condition").unknowns.wide
    q, qd, qdd = motion(motion.times[:-1])
    qd[0] = 0  # at rest, but for rounding, which has a sign
    return Functions(wide, frozenset({"base_regressor"}), {})("base_regressor", q, qd, qdd)


@CRITERIA
def test_the_plan_keeps_to_all_limits_and_begins_and_ends_at_rest(criterion: str) -> None:
    motion = Motion.from_text(found(criterion).text)
    assert motion.violations == ()
    assert np.abs(motion(np.array([0.0, motion.duration]))[1:]).max() < 1e-12
    times = np.linspace(0, motion.duration, 3001)
    assert motion.poses(times)[:, 2, 3].min() >= FLOOR
    # the torques of the plan, those of NumPy, are the regressors of the search times the parameters
    assert 24 < np.abs(motion.torques(times))[:, 1].max() <= 27
    beta = design(criterion).unknowns.prior
    assert (stacked(motion) @ beta)[1:] == pytest.approx(motion.torques(motion.times[1:-1]), abs=1e-9)


@CRITERIA
def test_condition_and_deviations_are_those_of_least_squares(criterion: str) -> None:
    excitation = found(criterion)
    regressors = stacked(Motion.from_text(excitation.text))
    assert condition(regressors) == pytest.approx(excitation.condition, rel=1e-6)
    # two hundred experiments with noise, each fitted with the weights of its torques
    rng, rows = np.random.default_rng(5), (regressors / excitation.noise[:, None]).reshape(-1, regressors.shape[2])
    fits = np.linalg.lstsq(rows, rng.standard_normal((len(rows), 400)), rcond=None)[0]
    assert fits.std(axis=1) == pytest.approx(excitation.deviations, rel=0.15)
    assert excitation.names == ("Izz1", "b1", "f1", "mx2", "my2", "Ixx2", "Izz2", "Ixy2", "Ixz2", "Iyz2", "b2", "fp2",
                                "fm2", "m3", "mx3", "my3", "mz3", "b3", "f3")  # fmt: skip


@pytest.mark.sweep
@CRITERIA
def test_it_is_better_than_the_best_of_many_random_motions(criterion: str) -> None:
    search = design(criterion)
    rng = np.random.default_rng(7)
    centres, weights = search.centres(rng), search.noise(np.ones(3)) ** -2.0
    drawn = [search.drawn(rng, centres) for _ in range(200)]
    times = search.series.times
    assert all(search.use(*search.samples(rows, times)[1:]).max() <= 1 for rows in drawn)

    def _small(regressors: np.ndarray) -> float:
        """What shall be small, as a logarithm."""
        if criterion == Criterion.CONDITION:
            return np.log(condition(regressors))
        return -np.linalg.slogdet(information(regressors, weights) / len(regressors))[1]

    least = min(_small(search.samples(rows, times)[0]) for rows in drawn)
    assert _small(stacked(Motion.from_text(found(criterion).text))) < least - (3 if criterion == "determinant" else 0.1)


def test_the_same_seed_gives_the_same_motion() -> None:
    options = {"harmonics": 2, "starts": 1, "floor": None, "position": "90,90,400"}
    first, again, other = (excite(arm(), seed=seed, **options).text for seed in (1, 1, 2))
    assert first == again != other


def test_a_motion_that_asks_too_much_is_made_smaller() -> None:
    search = design("condition", replace(arm(), runtime=()))
    rows = search.drawn(np.random.default_rng(1), search.centres(np.random.default_rng(1)))
    most = np.abs(search.samples(rows, search.fine)[1]).max(axis=0) + np.array([2, 4, 0])
    tight = replace(search, room=replace(search.room, torque=0.97 * most))
    smaller, factor = tight.shrunk(rows, search.series.times)
    assert factor < 1
    assert tight.use(*tight.samples(smaller, search.series.times)[1:]).max() <= 1
    assert written(smaller, arm())[1] == pytest.approx(smaller, abs=1e-9)


@pytest.mark.parametrize("robot", [pytest.param("two-armed-torso", marks=pytest.mark.sweep), "scara-matlab"])
def test_other_robots(robot: str, tmp_path: Path) -> None:
    path = tmp_path / "plans" / "excite.yaml"
    path.parent.mkdir()
    excitation = excite(robot, path, position=2, speed=1, floor=None, starts=1, harmonics=3)
    assert Motion.load(path).violations == ()
    assert excitation.condition < 200


@pytest.mark.parametrize(("period", "harmonics"), [(10.0, 5), (2.5, 2), (0.7, 9)])
def test_the_text_is_the_series_and_exactly_at_rest_at_both_ends(period: float, harmonics: int) -> None:
    series = FourierSeries(period, harmonics)
    rng = random.Random(harmonics)
    row = [Decimal(rng.randint(-999, 999)) / 1000 for _ in range(series.width)]
    t = sympy.Symbol("t")
    formula = sympy.nsimplify(sympy.sympify(series.formula(row)), rational=True)
    for time in (0, sympy.nsimplify(str(period), rational=True)):
        assert [sympy.simplify(formula.diff(t, order).subs(t, time)) for order in (1, 2)] == [0, 0]
    times = np.linspace(0, period, 7)
    for order, table in enumerate(series.basis(times)):
        expected = [float(formula.diff(t, order).subs(t, float(time))) for time in times]
        assert table @ np.array(row, dtype=float) == pytest.approx(expected, abs=1e-9 / period**order)


def test_a_bound_on_the_grid_holds_everywhere() -> None:
    rng = np.random.default_rng(3)
    for harmonics in (2, 5, 8):
        series = FourierSeries(10.0, harmonics)
        rows = rng.standard_normal((series.width, 500))
        rows[:, :100] = rows[:, :100] ** 5  # few large terms
        grids = (series.times, np.linspace(0, 10, 5000))
        coarse, fine = (np.abs(series.basis(times) @ rows).max(axis=1) for times in grids)
        assert (fine * BETWEEN <= coarse).all()
        # a single harmonic half way between two times reaches the bound
        lone = np.cos(2 * np.pi * harmonics * (series.times / 10.0 - 0.5 / len(series.times)))
        assert np.abs(lone).max() == pytest.approx(BETWEEN)
