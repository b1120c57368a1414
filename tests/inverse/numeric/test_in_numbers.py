"""An arm in numbers: with fifty digits and as arrays it stands where the floats say."""

from __future__ import annotations

import random
from dataclasses import replace

import mpmath
import numpy as np
import sympy

from derive.inverse.numeric.in_numbers import ArrayDomain, DigitsDomain, array_value, parameter_numbers
from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.robot.robot import Robot


def test_positions_agree_in_digits_arrays_and_floats() -> None:
    robot = replace(Robot.load("puma560-corke"), links=(), gravity=None)
    values = parameter_numbers(robot, random.Random(1))
    q = [0.3, -0.4, 0.5, -0.6, 0.7, -0.8]
    numbers = {str(symbol): float(value) for symbol, value in values.items()}
    expected = forward_kinematics(build_chain(robot, FloatDomain(robot, q, numbers))).position
    with mpmath.workdps(50):
        exact = forward_kinematics(build_chain(robot, DigitsDomain(robot, list(map(mpmath.mpf, q)), values)))
    arrays = forward_kinematics(build_chain(robot, ArrayDomain(robot, [np.array([x, 0.0]) for x in q], values)))
    assert np.allclose([float(x) for x in exact.position], expected, atol=1e-15)
    assert np.allclose([x[0] for x in arrays.position], expected, atol=1e-15)


def test_an_expression_is_not_a_number_where_it_is_not_real() -> None:
    x = sympy.Symbol("x")
    with np.errstate(invalid="ignore"):
        found = array_value(sympy.atan2(sympy.sqrt(1 - x**2), x), {x: np.array([0.5, 2.0])})
    assert np.isclose(found[0], np.arccos(0.5))
    assert np.isnan(found[1])
