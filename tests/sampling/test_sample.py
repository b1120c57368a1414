"""Parts of reductions from blocks, and functions by their names."""

import numpy as np
import pytest

from derive.errors import QuantityError
from derive.robot.robot import Robot
from derive.sampling.sample import QUANTILES, joined, part_of, program_for, quantiles


def test_quantiles_are_right_to_their_bins_for_both_signs_and_zero() -> None:
    values = np.random.default_rng(0).normal(size=(4 * 999, 3)) * [1e-9, 1.0, 1e9] + [0.0, 5.0, 0.0]
    values[::9] = 0.0
    parts = [part_of(rows, block, binned=True) for block, rows in enumerate(np.split(values, 4))]
    found = joined([joined(parts[:3], added=False), parts[3]], added=True)
    ranks = [np.quantile(values, QUANTILES, axis=0, method=way) for way in ("lower", "higher")]
    slack = 1e-3 * np.maximum(*map(np.abs, ranks))
    at = np.stack([quantiles(*each) for each in found.bins], axis=-1)
    assert ((at >= ranks[0] - slack) & (at <= ranks[1] + slack)).all()
    np.testing.assert_allclose(found.sums[0], values.sum(axis=0), rtol=1e-10)
    np.testing.assert_array_equal(found.extremes[0], [*values.min(axis=0), *-values.max(axis=0)])


def test_configurations_without_a_value_are_counted_and_left_out() -> None:
    part = part_of(np.array([[1.0, 2.0], [np.nan, 9.0], [3.0, -np.inf], [5.0, 4.0]]), 3, binned=False)
    assert (part.rows, part.lacking, part.sums.tolist()) == (2, 2, [[6.0, 6.0]])
    assert part.extremes.tolist() == [[1.0, 2.0, -5.0, -4.0], [3.0] * 4]


def test_functions_are_found_by_their_names_and_symbols_and_those_of_all_ends() -> None:
    arm = Robot.load("two-armed-torso")
    found = [each.name for each in program_for(arm, ["T", "jacobian"])]
    assert found[::2] == ["forward_kinematics_left", "jacobian_left"]
    with pytest.raises(QuantityError, match=r"did you mean 'forward_kinematics'"):
        program_for(arm, ["forward_kinematic"])
