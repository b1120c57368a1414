"""Families of singular configurations: blocks, zeros, coincidences, and paths without one."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.model.kinematic_model import KinematicModel
from derive.model.model import Model
from derive.model.singularities.coincidences import coincidences
from derive.model.singularities.determinant import find_singularities
from derive.model.singularities.rank import rank_loss
from derive.model.singularities.real_zeros import RealZeros
from derive.model.singularities.singularities import Outcome, statement
from derive.robot.robot import Robot
from tests.model.singularities.singular_arms import SingularArm, arm_text


def robot(rows: str, more: str = "", convention: str = "standard") -> Robot:
    """A robot file: a row for each joint, ``P`` before those that slide."""
    joints = ""
    for row in rows.split("|"):
        kind, cells = row.strip()[0], row.strip()[1:].strip()
        joints += f"  - {{type: {'prismatic' if kind == 'P' else 'revolute'}{', ' if cells else ''}{cells}}}\n"
    return Robot.from_text(f"name: arm\ntitle: Arm\nconvention: {convention}\n{more}joints:\n{joints}")


def families(arm: Robot) -> set[frozenset[str]]:
    return {frozenset(str(c.expression) for c in family) for family in find_singularities(arm).families}


ELBOW = "R d: d1, alpha: pi/2 | R a: a2 | R a: a3"
WRIST = "R alpha: -pi/2 | R alpha: pi/2 | R d: 0.1"


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        (f"{ELBOW} | R a: a4", [{"sin(q3)"}]),
        (f"{ELBOW} | R alpha: -pi/2 | R d: d5", [{"sin(q3)"}, {"a2*cos(q2) + a3*cos(q2 + q3)", "sin(q2 + q3 + q4)"}]),
        ("R a: a1 | R a: a2 | R a: a3 | R a: a4", [{"sin(q2)", "sin(q3)"}]),
        (
            "R d: 1, alpha: -pi/2 | R alpha: pi/2 | R d: 1, alpha: pi/2 | R alpha: -pi/2 "
            "| R d: 1, alpha: -pi/2 | R alpha: pi/2 | R d: 1",  # Baron and Angeles, isotropic redundant arms: S-R-S
            [{"sin(q4)"}, {"sin(q2)", "cos(q3)"}, {"sin(q2)", "sin(q6)"}, {"cos(q5)", "sin(q6)"}],
        ),
    ],
)
def test_arms_of_special_geometry_have_families_of_sines(rows: str, expected: list[set[str]]) -> None:
    arm = SingularArm(robot(rows))
    assert families(robot(rows)) == {frozenset(family) for family in expected}
    assert arm.found.complete
    arm.check(places=500, starts=12)


@pytest.mark.parametrize(
    ("rows", "more", "task", "shown"),
    [
        ("R a: a1 | R a: a2", "", ("x", "y"), "(rows 1, 2)"),
        ("R a: a1, alpha: pi | R a: a2 | R a: a3", "", ("x", "y", "phi"), "(rows 1, 2, 6)"),
        ("P alpha: pi/2 | R a: a2 | R a: a3", "", ("x", "z", "rotation about y"), "(rows 1, 3, 5)"),
        (
            "P theta: 0.4, alpha: pi/2 | R a: a2 | R a: a3",
            "",
            ("x", "y", "phi"),
            "(rows 1, 2, 6) in the axes of frame 1",
        ),
        ("R a: a1 | R a: a2", "base: [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]\n", ("x", "z"), "(rows"),
        ("R a: a1 | R a: a2, alpha: pi | P | R", "", ("x", "y", "z", "phi"), "(rows 1, 2, 3, 6)"),
        ("P alpha: 1 | R a: a1 | R a: a2 | P theta: 0.3", "", ("x", "y", "z", "phi"), "frame 1"),
        (WRIST, "", ("orientation",), "(rows 4, 5, 6)"),
        ("R alpha: pi/2 | R a: a2 | R a: a3", "", ("position",), "(rows 1, 2, 3)"),
        ("R alpha: pi/2 | R a: a2", "inverse: {task: [x, z]}\n", ("x", "z"), "(rows 1, 3)"),
        ("R a: a1 | R a: a2 | R a: a3", "inverse: {task: [x, phi]}\n", ("x", "phi"), "(2x3)"),
        ("R alpha: pi/2 | R a: a2", "", (), "(6x2)"),
        ("R alpha: pi/2 | R a: a2 | R a: a3 | R a: a4", "", (), "(6x4)"),
    ],
)
def test_the_task_is_natural_or_stated_and_named(rows: str, more: str, task: tuple[str, ...], shown: str) -> None:
    found = KinematicModel(robot(rows, more)).singularities
    assert found.task == task
    first = next(statement(found, str))
    assert shown in first
    assert f"for the task {', '.join(task)}" in first or not task


def test_a_stated_task_of_fewer_coordinates_is_judged_by_its_own_rank() -> None:
    arm = "R a: a1 | R a: a2 | R a: a3"
    assert families(robot(arm, "inverse: {task: [x, y]}\n")) == {frozenset({"sin(q2)", "sin(q3)"})}
    assert families(robot(arm)) == {frozenset({"sin(q2)"})}


@pytest.mark.parametrize(
    ("rows", "more", "is_met"),
    [
        ("R a: 0.5, alpha: pi/2 | R a: 0.3", "", False),
        ("R a: a1, alpha: pi/2 | R a: a2", "parameters: {a1: 0.5, a2: 0.3}\n", False),
        ("R a: 0.2, alpha: pi/2 | R a: 0.3", "", True),
        ("R a: a1, alpha: pi/2 | R a: a2", "", None),
    ],
)
def test_factors_that_are_never_zero_are_no_singularities(rows: str, more: str, is_met: bool | None) -> None:
    """Of a1 + a2*c2 numbers decide; symbols leave it open."""
    found = KinematicModel(robot(rows, f"{more}inverse: {{task: [x, y]}}\n")).singularities
    shoulder = [c for c in found.conditions if not c.values]
    assert [c.is_certain for c in shoulder] == {False: [], True: [True], None: [False]}[is_met]


def test_lengths_that_are_equal_in_the_file_count_as_equal() -> None:
    """Folded, the third axis lies on the first: where a2 = a3 the rank of all four columns is less."""
    rows = "R a: a2 | R a: a3, alpha: pi/2 | R alpha: pi/2 | R"
    assert SingularArm(robot(rows, "parameters: {a2: 0.3, a3: 0.3}\n")).check(places=200, starts=12) is None


def test_what_has_no_closed_form_says_what_decides_and_is_not_called_complete() -> None:
    row = "R a: 0.3, d: 0.1, alpha: 0.4 | R a: 0.2, alpha: 1.1, d: 0.2 | R a: 0.3, alpha: -0.4, d: 0.4"
    more = "R a: 0.2, d: 0.3, alpha: 0.7 | R a: 0.2"
    five = KinematicModel(robot(f"{row} | {more}")).singularities
    assert (five.outcome, five.complete, five.rank, five.square) == (Outcome.UNSOLVED, False, 5, "J^T*J")
    assert list(statement(five, str))[-1].endswith("what decides is det(J^T*J) = 0")
    seven = KinematicModel(robot(f"{row} | {more}, d: 0.2, alpha: 0.9 | R a: 0.1, alpha: 0.8 | R a: 0.2")).singularities
    assert (seven.outcome, seven.complete, seven.rank, seven.square) == (Outcome.UNSOLVED, False, 6, "J*J^T")


def test_four_general_axes_are_proven_to_be_never_singular() -> None:
    row = "R a: 0.3, d: 0.1, alpha: 0.4 | R a: 0.2, alpha: 1.1, d: 0.2 | R a: 0.3, alpha: -0.4, d: 0.4 | R a: 0.2"
    assert KinematicModel(robot(row)).singularities.outcome is Outcome.NEVER


def _check(seed: int, places: int, starts: int) -> None:
    rng = random.Random(seed)
    text = arm_text(rng, rng.randint(2, 7), rng.choice([0.5, 0.8, 1.0, 1.0]))
    SingularArm(Robot.from_text(text), seed).check(places, starts)


@pytest.mark.parametrize("seed", range(8))
def test_random_arms_lose_rank_where_it_is_stated_and_nowhere_else(seed: int) -> None:
    _check(seed, places=500, starts=4)


@pytest.mark.sweep
@pytest.mark.parametrize("block", range(25))
def test_five_hundred_arms_lose_rank_where_it_is_stated_and_nowhere_else(block: int) -> None:
    for seed in range(1000 + 20 * block, 1020 + 20 * block):
        _check(seed, places=10_000, starts=8)


def seen(name: str) -> dict[str, tuple[list[str], list[str]]]:
    model = Model(Robot.load(name))
    pairs = coincidences(model.inverse, model.singularities.factors)
    return {
        str(step.unknown): ([str(f.expression) for f in merged], [str(f.expression) for f in free])
        for step, (merged, free) in zip(model.inverse.steps, pairs, strict=True)
    }


SEEN = {
    "anthropomorphic-wrist": {
        "q3": (["cos(q3)"], []),
        "q4": ([], ["sin(q5)"]),
        "q1": ([], ["a2*cos(q2) + d4*sin(q2 + q3)"]),
        "q6": ([], []),
    },
    "puma560-corke": {  # with an offset of the shoulder
        "q1": (["a2*cos(q2) + a3*cos(q2 + q3) - d4*sin(q2 + q3)"], []),
        "q3": (["a3*sin(q3) + d4*cos(q3)"], []),
    },
    "planar-3r": {"q2": (["sin(q2)"], [])},
    "scara-perugia": {"q2": (["sin(q2)"], [])},
}


@pytest.mark.parametrize("name", SEEN)
def test_elbows_are_where_two_values_are_one_and_wrists_where_a_joint_is_free(name: str) -> None:
    assert SEEN[name].items() <= seen(name).items()


def test_zeros_of_a_factor_are_as_near_as_the_rounding_of_its_terms_allows() -> None:
    """Terms of an arm of 17 digits may be as large, and what they leave as small."""
    model = Model(Robot.load("planar-3r"))
    (factor,) = [factor for factor in model.singularities.factors if factor.condition is not None]
    q2 = sympy.Symbol("q2")
    steep = (1 + q2) * (10**30 * sympy.cos(q2) - 10**30 * sympy.cos(1)) - sympy.sin(q2)
    pairs = coincidences(model.inverse, [replace(factor, expression=steep)])
    assert not any(merged or free for merged, free in pairs)


ARM = """
name: arm
convention: standard
parameters: {a: 0.5, b: 0.5}
joints:
  - {type: revolute, a: a, alpha: pi/2}
  - {type: revolute, a: b, alpha: x}
  - {type: prismatic, a: k}
"""
DOMAIN = PolynomialDomain(Robot.from_text(ARM), rates=False)
C1, S1 = DOMAIN.cosine_sine_of(0)
C2, S2 = DOMAIN.cosine_sine_of(1)
A, B, K, Q3 = (DOMAIN.ring.generator(name) for name in ("a", "b", "k", "q3"))


@pytest.mark.parametrize(
    ("polynomials", "exist"),
    [
        ([K * C1 + S1], True),  # changes its sign by half a turn
        ([Q3 + K * Q3 * C1], True),
        ([K * K + Q3 * Q3], None),  # k may be zero
        ([1 + K * K + Q3 * Q3], False),
        ([1 + C1 * C1], False),
        ([K + C1], None),  # depends on k
        ([A + B * C1], None),  # touches zero
        ([A + C1], True),
        ([3 * A + B * C1 + B * S2], False),
        ([2 + C1 * C2 + S1 * S2], False),
        ([C1 - 2 * S1 * C2, C2 + 2 * C1 - 5], False),
        ([C1 - C2, S1 - S2], None),
    ],
)
def test_what_is_said_of_zeros_is_true(polynomials: list[Polynomial], exist: bool | None) -> None:
    assert RealZeros(DOMAIN).exist(polynomials) is exist


def test_numbers_of_the_file_decide_what_vanishes() -> None:
    zeros = RealZeros(DOMAIN)
    assert zeros.vanishes(A - B)
    assert zeros.vanishes(K * (A - B) * C1 + (A - B) * S2)
    assert not zeros.vanishes(A + B)
    assert not zeros.vanishes(A - K)
    assert not zeros.vanishes((A - B) * C1 + K * S2)


def test_what_vanishes_in_numbers_is_no_pivot_and_the_rank_is_less_where_all_minors_are_zero() -> None:
    zero, still = DOMAIN.ring.zero, K * (A - B)
    loss = rank_loss(DOMAIN, [[[still, C1, zero], [zero, S2, still * C1 + (A - B) * S1]]])
    assert (loss.rank, loss.unless, loss.complete) == (1, (), True)
    assert [len(family) for family in loss.families] == [2]
    loss = rank_loss(DOMAIN, [[[C1, K * S2], [DOMAIN.ring.zero, S2 * C1], [Q3 * S2, Q3]]])
    found = {frozenset(str(zero.factor.value.raw) for zero in family) for family in loss.families}
    assert (loss.rank, loss.complete) == (2, True)
    assert found == {frozenset({"cos q1", "sin q2"}), frozenset({"cos q1", "q3"}), frozenset({"sin q2", "q3"})}
