"""Singular factors of det J and the steps of the inverse kinematics in which they are seen."""

from __future__ import annotations

from dataclasses import replace

import pytest
import sympy

from derive.model.model import Model
from derive.model.singularities.coincidences import coincidences
from derive.robot.robot import Robot


def seen(name: str) -> dict[str, tuple[list[str], list[str]]]:
    model = Model(Robot.load(name))
    pairs = coincidences(model.inverse, model.singularities.factors)
    return {
        str(step.unknown): ([str(f.expression) for f in merged], [str(f.expression) for f in free])
        for step, (merged, free) in zip(model.inverse.steps, pairs, strict=True)
    }


def test_the_elbow_is_where_two_values_are_one_and_the_wrist_where_a_joint_is_free() -> None:
    found = seen("anthropomorphic-wrist")
    assert found["q3"] == (["cos(q3)"], [])
    assert found["q4"] == ([], ["sin(q5)"])
    assert found["q1"] == ([], ["a2*cos(q2) + d4*sin(q2 + q3)"])
    assert found["q6"] == ([], [])


def test_with_an_offset_the_shoulder_is_where_two_values_are_one() -> None:
    found = seen("puma560-corke")
    assert found["q1"] == (["a2*cos(q2) + a3*cos(q2 + q3) - d4*sin(q2 + q3)"], [])
    assert found["q3"] == (["a3*sin(q3) + d4*cos(q3)"], [])


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia"])
def test_planar_elbows(name: str) -> None:
    assert seen(name)["q2"] == (["sin(q2)"], [])


def test_zeros_of_a_factor_are_as_near_as_the_rounding_of_its_terms_allows() -> None:
    """Terms of an arm of 17 digits may be as large, and what they leave as small."""
    model = Model(Robot.load("planar-3r"))
    (factor,) = [factor for factor in model.singularities.factors if factor.condition is not None]
    q2 = sympy.Symbol("q2")
    steep = (1 + q2) * (10**30 * sympy.cos(q2) - 10**30 * sympy.cos(1)) - sympy.sin(q2)
    pairs = coincidences(model.inverse, [replace(factor, expression=steep)])
    assert not any(merged or free for merged, free in pairs)
