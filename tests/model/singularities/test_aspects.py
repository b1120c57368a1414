"""Aspects, and paths between postures without a singularity."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from derive.inverse.numeric.chain import NumericChain
from derive.model.model import Model
from derive.model.singularities.aspects import (
    CLEAR,
    Aspects,
    Roadmap,
    ScaledDeterminant,
    connected,
    random_configurations,
)
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, jacobian, numeric_arm
from tests.inverse.arms import PUBLISHED
from tests.random_robots import swept
from tests.rows import robot_of_rows


@cache
def aspects(name: str) -> Aspects:
    return Model(Robot.load(name)).aspects


def orthogonal(d3: float, d4: float, r2: float) -> Robot:
    """Three orthogonal axes with d2 = 1 and r3 = 0."""
    return robot_of_rows(f"R a: 1, alpha: -pi/2 | R d: {r2}, a: {d3}, alpha: pi/2 | R a: {d4}")


@pytest.mark.parametrize(
    ("name", "count"), [("planar-3r", 2), ("scara-perugia", 2), ("anthropomorphic-arm", 4), ("puma560-corke", 8)]
)
@pytest.mark.first(1)
def test_arms_of_textbooks_have_as_many_aspects_as_solutions_each_in_its_own(name: str, count: int) -> None:
    found = aspects(name)
    assert (found.count, found.inverse.count, found.shared, found.is_cuspidal) == (count, count, 0, False)
    assert len(set(found.signs)) == count
    assert None not in found.signs


def test_signs_of_the_factors_are_the_words_of_the_branches() -> None:
    found = aspects("puma560-corke")
    elbow = [str(factor.posture) for factor in found.factors].index("elbow")
    wrist = [str(factor.posture) for factor in found.factors].index("wrist")
    for solution, signs in zip(found.inverse.solutions, found.signs, strict=True):
        assert (signs[wrist] > 0) == ("not flipped" in solution.name)
        left, up = "left" in solution.name, "elbow up" in solution.name
        assert (signs[elbow] > 0) == (left == up)


def assert_is_a_path(robot: Robot, found: Aspects, rows: slice) -> None:
    """The oracle's det J keeps its sign along the path, and its ends are two configurations of one pose."""
    path, arm = found.crossing.path, numeric_arm(robot, {})
    ends = [forward_kinematics(arm, q) for q in (path[0], path[-1])]
    place = (slice(0, 3), 3) if rows == slice(0, 3) else (slice(None), slice(None))
    assert np.abs(ends[0][place] - ends[1][place]).max() < 1e-9
    assert np.abs(np.exp(1j * path[0]) - np.exp(1j * path[-1])).max() > 1e-2
    places = (a + s * (b - a) for a, b in pairwise(path) for s in np.linspace(0.0, 1.0, 200))
    values = [np.linalg.det(jacobian(arm, q)[rows]) for q in places]
    assert min(values) > 0.0 or max(values) < 0.0


def test_of_orthogonal_arms_those_that_fold_over_are_cuspidal() -> None:
    robot = orthogonal(2, 1.5, 1)  # Wenger: four cusps, two aspects
    found = Model(robot).aspects
    assert found.count == 2
    assert {2, 4} == set(found.solutions)
    assert_is_a_path(robot, found, slice(0, 3))
    assert found.inverse.solutions == ()  # no words for its branches
    found = Model(orthogonal(1, 3, 0)).aspects  # r2 = r3 = 0: quadratics, not cuspidal (Wenger 2007)
    assert not found.is_cuspidal


def baili_bounds(d3: float, r2: float) -> tuple[float, float]:
    """Of orthogonal arms with d2 = 1, r3 = 0: below the first d4 none is cuspidal, from there to the second all are.

    Baili, Wenger and Chablat, A classification of 3R orthogonal manipulators by the topology of their workspace, 2004.
    """
    a, b, square = math.hypot(d3 + 1, r2), math.hypot(d3 - 1, r2), d3**2 + r2**2
    return math.sqrt((square - (square**2 - d3**2 + r2**2) / (a * b)) / 2), d3 * a / (1 + d3)


@pytest.mark.parametrize(
    ("d3", "r2"), swept((2.33, 1.02), (0.9, 0.39), (1.23, 0.44), (0.54, 0.66), (1.53, 0.55), (0.85, 1.13), (2.08, 0.47))
)
def test_orthogonal_arms_are_cuspidal_where_the_literature_says_so(d3: float, r2: float) -> None:
    first, second = baili_bounds(d3, r2)
    assert not Model(orthogonal(d3, round(0.8 * first, 3), r2)).aspects.is_cuspidal
    robot = orthogonal(d3, round((first + second) / 2, 3), r2)
    found = Model(robot).aspects
    assert found.is_cuspidal
    assert_is_a_path(robot, found, slice(0, 3))


@pytest.mark.sweep
def test_a_crx_is_cuspidal() -> None:
    case = next(case for case in PUBLISHED if case.name == "crx-10ia")
    robot = case.robot()
    found = Model(robot).aspects
    assert found.shared > 0
    assert found.count is None
    assert_is_a_path(robot, found, slice(0, 6))


@pytest.mark.first(1)
@pytest.mark.parametrize(
    ("name", "why"),
    [("thumb", "no single determinant"), ("kuka-lwr4", "more joints"), ("skeleton-root", "more joints")],
)
def test_arms_without_a_determinant_say_so(name: str, why: str) -> None:
    found = aspects(name)
    assert (found.count, found.is_cuspidal) == (None, False)
    assert why in found.why_not


def test_cells_hang_together_around_the_ends_of_an_angle() -> None:
    code = np.array([[1, 1, 0, 1], [0, 0, 0, 1], [1, 1, 0, 1]])
    assert len(np.unique(connected(code, (False, False)))) == 4
    assert len(np.unique(connected(code, (True, False)))) == 3
    assert len(np.unique(connected(code, (True, True)))) == 2


@pytest.fixture(scope="module")
def chain() -> NumericChain:
    return NumericChain.of(robot_of_rows("R a: 1 | R a: 0.7"))


def test_the_determinant_of_a_planar_arm_is_the_sine_of_its_elbow(chain: NumericChain) -> None:
    q = random_configurations(chain, 50, 1)
    assert np.abs(ScaledDeterminant(chain)(q)) == pytest.approx(np.abs(np.sin(q[:, 1])), abs=1e-5)


def test_a_path_leads_past_singularities_and_none_through_them(chain: NumericChain) -> None:
    determinant = ScaledDeterminant(chain)
    places = random_configurations(chain, 300, 2)
    above = places[determinant(places) > CLEAR]
    sign = float(np.sign(determinant(np.array([0.0, 1.0]))))
    roads = Roadmap(chain, determinant, above if sign > 0 else places[determinant(places) < -CLEAR], (1,))
    start, end = np.array([0.3, 0.2]), np.array([-2.0, 2.9])
    found = roads.path(start, end)
    assert found.path[0] == pytest.approx(start)
    assert np.sin(found.path[-1] - end) == pytest.approx(np.zeros(2), abs=1e-12)
    assert CLEAR < found.clearance <= np.sin(0.2) + 1e-5
    assert roads.path(start, np.array([0.3, -0.2])) is None
