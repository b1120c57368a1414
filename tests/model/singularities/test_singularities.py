"""Singularities: det J in factors against the Jacobian of the independent recursion, in numbers."""

from __future__ import annotations

import random
import time
from typing import Any

import pytest
import sympy
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from derive.model.kinematic_model import KinematicModel
from derive.model.singularities.conditions import Posture
from derive.model.singularities.singularities import Outcome
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from tests.model.singularities.singular_arms import SingularArm
from tests.random_robots import random_robot

CATALOGUE = catalogue_names()
ARTICULATED = ["anthropomorphic-arm", "anthropomorphic-wrist", "puma560-corke", "puma560-usp", "puma560-laschi"]


# -- every robot of the catalogue


@pytest.mark.parametrize("name", CATALOGUE)
def test_the_catalogue_has_the_determinant_of_the_recursion_within_seconds(name: str) -> None:
    for seed in range(3):
        SingularArm(Robot.load(name), seed).check_determinant()
    model = KinematicModel(Robot.load(name))
    start = time.process_time()
    assert model.singularities is model.singularities
    assert time.process_time() - start < 5


@pytest.mark.first(8)
@pytest.mark.parametrize("name", [name for name in CATALOGUE if Robot.load(name).n <= 7])
def test_rank_drops_where_it_is_stated_and_nowhere_else(name: str) -> None:
    SingularArm(Robot.load(name)).check(places=200, starts=6)


# -- what the books say


A1, A2, A3, D4 = sympy.symbols("a1 a2 a3 d4")
Q1, Q2, Q3, Q4, Q5 = sympy.symbols("q1 q2 q3 q4 q5")
ELBOW = A3 * sympy.sin(Q3) + D4 * sympy.cos(Q3)


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("planar-2r-perugia", A1 * A2 * sympy.sin(Q2)),
        ("planar-3r", A1 * A2 * sympy.sin(Q2)),
        ("scara-perugia", A1 * A2 * sympy.sin(Q2)),
        ("anthropomorphic-arm", -A2 * A3 * sympy.sin(Q3) * (A2 * sympy.cos(Q2) + A3 * sympy.cos(Q2 + Q3))),
        ("spherical-arm", -(Q3**2) * sympy.sin(Q2)),
        ("spherical-wrist", -sympy.sin(Q5)),
        ("stanford-deluca", Q3**2 * sympy.sin(Q2) * sympy.sin(Q5)),
        (
            "puma560-corke",
            A2 * sympy.sin(Q5) * ELBOW * (A2 * sympy.cos(Q2) + A3 * sympy.cos(Q2 + Q3) - D4 * sympy.sin(Q2 + Q3)),
        ),
    ],
)
def test_the_determinants_are_those_of_the_books(name: str, printed: Any) -> None:
    assert KinematicModel(Robot.load(name)).singularities.determinant == printed


@pytest.mark.parametrize("name", ARTICULATED)
def test_an_articulated_arm_has_a_shoulder_and_an_elbow(name: str) -> None:
    found = KinematicModel(Robot.load(name)).singularities
    postures = {c.posture for c in found.conditions}
    wrist = {Posture.WRIST} if len(found.blocks) > 1 else set()
    assert postures == {Posture.SHOULDER, Posture.ELBOW} | wrist


def test_the_coefficients_of_a_factor_are_lengths_of_the_robot() -> None:
    elbow = next(c for c in KinematicModel(Robot.load("puma560-laschi")).singularities.conditions if c.joints == (3,))
    coefficients = {abs(float(k)) for k in elbow.expression.as_coefficients_dict().values()}
    assert coefficients == {0.43307, 0.02032}


def arm_of(joints: list[str], base: str = "") -> KinematicModel:
    rows = "".join(f"  - {{{row}}}\n" for row in joints)
    return KinematicModel(Robot.from_text(f"name: arm\ntitle: Arm\nconvention: standard\njoints:\n{rows}{base}"))


def test_arms_are_singular_everywhere_or_never_where_their_axes_say_so() -> None:
    model = arm_of(["type: revolute, a: a1", "type: revolute, alpha: pi/2", "type: revolute, a: a3"])
    assert arm_of(["type: revolute", "type: revolute, a: a1"]).singularities.outcome is Outcome.EVERYWHERE
    assert model.singularities.outcome is not Outcome.EVERYWHERE
    joints = ["type: prismatic, alpha: -pi/2", "type: prismatic, theta: pi/2, alpha: -pi/2", "type: prismatic"]
    found = arm_of(joints).singularities
    assert found.outcome is Outcome.NEVER
    assert abs(found.determinant) == 1


def test_a_tilted_scara_is_judged_in_the_axes_of_its_base() -> None:
    joints = ["type: revolute, a: a1", "type: revolute, a: a2, alpha: pi", "type: prismatic", "type: revolute"]
    base = "base: [[1, 0, 0, 0], [0, 3/5, -4/5, 0], [0, 4/5, 3/5, 1], [0, 0, 0, 1]]\n"
    found = arm_of(joints, base).singularities
    assert found.blocks[0].rows == (1, 2, 3, 6)
    assert found.blocks[0].reference.frame == 0
    assert found.conditions[0].values == (0, sympy.pi)


# -- robots never seen


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(2, 6))
@example(seed=897535, n=2)  # a twist of -0.07 degrees: cos^2 - 1 would lose ten of its digits
def test_random_arms_have_the_determinant_of_the_recursion(seed: int, n: int) -> None:
    SingularArm(Robot.from_text(random_robot(random.Random(seed), n, dynamics=False).text), seed).check_determinant()


SLANTED = """
name: slanted
convention: standard
joints:
  - {type: revolute, q: q2, theta: q2 + 2.1154531206566901, d: -0.71587363831331372, alpha: pi/2}
  - {type: revolute, q: q3, theta: q3, d: 0.5, alpha: -pi/2}
  - {type: revolute, q: q4, theta: q4, a: 0.07}
"""

BASE = """
base:
  - [-0.93541434669348535, 0, -0.35355339059327376, 0]
  - [0.13363062095621219, 0.92582009977255146, -0.35355339059327376, 0]
  - [0.32732683535398857, -0.37796447300922723, -sqrt(0.75), 0]
  - [0, 0, 0, 1]
"""


def test_a_slanted_base_does_not_enter_the_determinant() -> None:
    """Rank does not depend on it; in its numbers the determinant had coefficients of 96 digits."""
    level, slanted = (KinematicModel(Robot.from_text(SLANTED + base)).singularities for base in ("", BASE))
    assert slanted.determinant == level.determinant
    assert level.task == ("position",)
    assert slanted.blocks[0].reference.frame == 0


LONG = """
name: long
convention: standard
joints:
  - {type: revolute, q: q1, theta: q1, d: 0.71587363831331372, alpha: pi/2}
  - {type: revolute, q: q2, theta: q2, a: 0.097873524170258314}
  - {type: revolute, q: q3, theta: q3, a: 0.51234567890123456}
tool:
  - [1, 0, 0, 0.02345678901234567]
  - [0, 1, 0, 0.11234567890123457]
  - [0, 0, 1, 0]
  - [0, 0, 0, 1]
"""


def test_no_whole_number_of_a_factor_is_longer_than_its_decimals() -> None:
    numbers = KinematicModel(Robot.from_text(LONG)).singularities.determinant.atoms(sympy.Rational)
    assert max(abs(float(number)) for number in numbers) < 1e9
