"""The cases of printed Newton-Euler equations: every kind of joint at every place, and the laws hold there."""

from __future__ import annotations

import numpy as np
import pytest

from derive.checking.formulas.vector_formula import read_vector, value_of
from derive.checking.methods_file import ARMS, SETS, cases
from derive.errors import Location


@pytest.mark.parametrize("name", list(SETS))
def test_every_link_of_every_arm_is_a_case(name: str) -> None:
    joints = "".join(joint[0] for joint, _ in cases(name))
    assert joints == "".join(types for types, _ in ARMS)


@pytest.mark.parametrize("name", list(SETS))
@pytest.mark.parametrize(("result", "text"), [("F", "m*a"), ("N", "I @ wd + cross(w, I @ w)")])
def test_newton_and_euler_hold_at_every_link(name: str, result: str, text: str) -> None:
    equation = read_vector(text, Location("<test>"))
    for _, values in cases(name):
        assert np.allclose(value_of(equation, values), values[result], rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", list(SETS))
def test_rotations_are_rotations_and_axes_are_unit_vectors(name: str) -> None:
    for _, values in cases(name):
        for rotation in ("Rp", "Rn", "R0"):
            assert np.allclose(values[rotation] @ values[rotation].T, np.eye(3))
        assert np.linalg.norm(values["z_prev"]) == pytest.approx(1)
