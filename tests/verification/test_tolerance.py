"""The yardstick of errors: every function has a natural size that its values keep within, and 1e-9 is the tolerance."""

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.verification.oracle.functions import ANGLES, FUNCTIONS
from derive.verification.samples import SampleSet, sample_sets
from derive.verification.tolerance import TOLERANCE, bounds, regressor_size, relative_errors

ROBOTS = ("scara-perugia", "stanford-deluca", "puma560-corke")
NOT_BOUNDED = {"forward_dynamics", "base_parameters", *ANGLES}
"""Accelerations and rates of angles grow without bound near singular configurations; a fit has its own yardstick."""


def samples_of(name: str) -> SampleSet:
    return sample_sets(Robot.load(name), 24, np.random.default_rng(3))[0]


def test_the_tolerance_is_the_one_that_the_documentation_states() -> None:
    assert TOLERANCE == 1e-9


@pytest.mark.parametrize("name", ROBOTS)
def test_values_keep_within_their_natural_size(name: str) -> None:
    """The bounds hold, and are of the value's shape: an error of a thousandth of them is never lost."""
    samples = samples_of(name)
    oracle = samples.oracle
    for function in oracle.functions:
        arguments = tuple(samples.arguments[argument] for argument in FUNCTIONS[function].arguments)
        if function in NOT_BOUNDED:
            continue
        limits = bounds(oracle, arguments[0])
        if FUNCTIONS[function].identifies:
            assert oracle.identification is not None
            size = regressor_size(limits, oracle.identification, function, arguments[1:])
        else:
            size = limits.natural_size(function, arguments)
        value = oracle.evaluate(function, *arguments)
        assert np.broadcast_shapes(size.shape, value.shape) == value.shape, function
        assert (np.abs(value) <= size * (1 + 1e-12)).all(), function


def test_a_function_without_a_natural_size_is_no_silent_zero() -> None:
    samples = samples_of("scara-perugia")
    limits = bounds(samples.oracle, samples.arguments["q"])
    with pytest.raises(KeyError, match="hovering"):
        limits.natural_size("hovering", (samples.arguments["q"],))


def test_errors_are_relative_exact_zeros_and_infinite_where_there_is_no_number() -> None:
    difference = np.array([0.0, 0.0, 2.0, np.nan, 1.0])
    scale = np.array([0.0, 1.0, 4.0, 1.0, 0.0])
    assert relative_errors(difference, scale).tolist() == [0.0, 0.0, 0.5, np.inf, np.inf]
