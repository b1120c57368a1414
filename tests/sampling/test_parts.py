"""Configurations by their numbers, parts of reductions from blocks, and functions by their names."""

from dataclasses import replace

import numpy as np
import pytest

from derive.errors import QuantityError
from derive.robot.robot import Robot
from derive.sampling.configurations import BLOCK, Configurations, grid
from derive.sampling.reductions import QUANTILES, joined, part_of, reduced
from derive.sampling.sample import program_for

KINDS = ("min", "mean", "max", "quantiles")


def test_more_configurations_begin_with_the_fewer() -> None:
    few = Configurations({"q": (0.0, 1.0)}, {"q": (1.0, 3.0)}, 100, 7)
    many = replace(few, number=BLOCK + 5)
    assert np.array_equal(few.block(0)["q"], many.block(0)["q"][:100])
    assert [len(many.block(k)["q"]) for k in range(many.blocks)] == [BLOCK, 5]


def test_quantiles_are_right_to_their_bins_for_both_signs_and_zero() -> None:
    values = np.random.default_rng(0).normal(size=(4 * 999, 3)) * [1e-9, 1.0, 1e9] + [0.0, 5.0, 0.0]
    values[::9] = 0.0
    parts = [part_of(rows, block, binned=True) for block, rows in enumerate(np.split(values, 4))]
    found = reduced(joined([joined(parts[:3], added=False), parts[3]], added=True), KINDS)
    expected = (
        np.quantile(values, QUANTILES, axis=0, method="lower"),
        np.quantile(values, QUANTILES, axis=0, method="higher"),
    )
    slack = 2e-3 * np.maximum(*map(np.abs, expected))
    assert (found["quantiles"] >= expected[0] - slack).all()
    assert (found["quantiles"] <= expected[1] + slack).all()
    np.testing.assert_allclose(found["mean"], values.mean(axis=0), rtol=1e-10)


def test_configurations_without_a_value_are_counted_and_left_out() -> None:
    values = np.array([[1.0, 2.0], [np.nan, 9.0], [3.0, -np.inf], [5.0, 4.0]])
    part = part_of(values, 3, binned=True)
    assert (part.rows, part.lacking) == (2, 2)
    assert {kind: list(found) for kind, found in reduced(part, KINDS[:3]).items()} == {
        "min": [1.0, 2.0],
        "mean": [3.0, 3.0],
        "max": [5.0, 4.0],
    }


def test_a_grid_has_as_many_points_along_each_variable_as_it_may() -> None:
    assert (grid(63, 2), grid(64, 3), grid(1, 4)) == ((7, 7), (4, 4, 4), (1, 1, 1, 1))


def test_functions_are_found_by_their_names_and_symbols_and_those_of_ends() -> None:
    arm = Robot.load("two-armed-torso")
    assert [each.name for each in program_for(arm, ["T", "jacobian"])][:1] == ["forward_kinematics_left"]
    assert [each.name for each in program_for(arm, ["J_right"])] == ["jacobian_right"]
    assert len([*program_for(arm, ["J", "T"])]) == 4
    with pytest.raises(QuantityError, match="no function 'T_up'"):
        program_for(arm, ["T_up"])
