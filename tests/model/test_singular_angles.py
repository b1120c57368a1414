"""Orientation angles of arms that are singular in every configuration: a valid triple, and no analytic Jacobian."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

from derive.errors import QuantityError
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.evaluate import evaluate

VALUES = {
    "q1": 0.3,
    "q2": -0.8,
    "q3": 0.5,
    "q4": 1.1,
    "q5": -0.7,
    "q6": 0.2,
    "a1": 1.0,
    "a2": 1.0,
    "a3": 1.0,
    "d4": 0.2,
}


def rotation(axis: str, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    if axis == "z":
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    if axis == "y":
        return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "spherical-wrist", "spherical-arm"])
def test_euler_angles_of_short_arms_give_the_rotation_without_the_root_of_a_square(name: str) -> None:
    model = Model(Robot.load(name))
    assert "sqrt" not in str(model.euler_zyz)
    phi, theta, psi = evaluate(model.euler_zyz, VALUES).ravel()
    product = rotation("z", phi) @ rotation("y", theta) @ rotation("z", psi)
    np.testing.assert_allclose(product, evaluate(model.R, VALUES), atol=1e-12)


def test_roll_pitch_yaw_with_the_pitch_fixed_at_a_right_angle_give_the_rotation() -> None:
    base = "[[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]"
    text = f"name: up\nconvention: standard\nbase: {base}\njoints: [{{type: prismatic}}]\n"
    model = Model(Robot.from_text(text))
    roll, pitch, yaw = (float(sympy.N(x)) for x in model.rpy)
    product = rotation("z", yaw) @ rotation("y", pitch) @ rotation("x", roll)
    np.testing.assert_allclose(product, np.array(model.R.tolist(), dtype=float), atol=1e-12)


def test_the_analytic_jacobian_of_a_planar_arm_is_refused_for_zyz_and_given_for_rpy() -> None:
    model = Model(Robot.load("planar-3r"))
    with pytest.raises(QuantityError, match="singular in every configuration"):
        model.J_analytic("zyz")
    assert model.J_analytic("rpy")[5, :] == sympy.ones(1, 3)
