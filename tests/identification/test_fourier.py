"""Fourier series from rest to rest: in floats, as exact text, and what they do between two times."""

import random
from decimal import Decimal

import numpy as np
import pytest
import sympy

from derive.identification.excitation import BETWEEN, FourierSeries


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
