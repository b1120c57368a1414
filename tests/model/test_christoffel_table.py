"""The table of Christoffel symbols is complete, and styles and contractions go by their names."""

from __future__ import annotations

import pytest
import sympy

from derive.errors import QuantityError
from derive.model.model import Model
from derive.robot.robot import Robot


def test_the_coriolis_matrix_is_the_sum_of_the_symbols_in_the_table() -> None:
    model = Model(Robot.load("scara-perugia"))
    table = model.christoffel_table()
    assert table
    assert all(j <= k and value != 0 for (_, j, k), value in table.items())
    n = range(1, model.n + 1)
    summed = sympy.Matrix(
        [[sum(table.get((i, *sorted((j, k))), 0) * model.qd[k - 1] for k in n) for j in n] for i in n]
    )
    assert sympy.expand(summed - model.C) == sympy.zeros(model.n, model.n)


@pytest.mark.parametrize(
    ("option", "allowed"), [("style", "compact, by-geometry, expanded"), ("contraction", "aligned, opposed")]
)
def test_an_unknown_style_or_contraction_is_refused_with_the_known_ones(option: str, allowed: str) -> None:
    with pytest.raises(QuantityError, match=allowed):
        Model(Robot.load("planar-3r"), **{option: "roman"})
