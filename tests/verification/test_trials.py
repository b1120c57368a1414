"""The calls of a function: every way that a target offers, each with arguments that the oracle can answer."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.verification.expectation import expectation
from derive.verification.oracle.frames import Array
from derive.verification.oracle.functions import Oracle
from derive.verification.samples import SampleSet, sample_sets
from derive.verification.trials import BLOCK_ROWS, trials

ROBOT = """
name: arm
convention: standard
joints:
  - {type: revolute, a: a1}
  - {type: prismatic, alpha: pi/2}
links:
  - {mass: m1, com: [-1/2, 0, 0], inertia: {zz: 2}}
  - {mass: 3, com: [0, 0, 1/5]}
gravity: [0, -9.81, 0]
"""


class Perfect:
    target, file = "perfect", "perfect.py"
    ways = ("one", "batch", "broadcast", "blocks", "parameters")
    constants: Mapping[str, Any] = {"DOF": 2, "PARAMETERS": ("a1", "m1")}

    def __init__(self, sets: Sequence[SampleSet]) -> None:
        self.sets = sets

    def call(self, function: str, arguments: Sequence[Array], parameters: Mapping[str, Any]) -> Array:
        if np.ndim(parameters["m1"]):
            return np.stack(
                [one.oracle.evaluate(function, *(a[k] for a in arguments)) for k, one in enumerate(self.sets)]
            )
        oracle = next(one.oracle for one in self.sets if one.parameters == dict(parameters))
        assert isinstance(oracle, Oracle)
        return oracle.evaluate(function, *arguments)


@pytest.fixture(scope="module")
def sets() -> tuple[SampleSet, ...]:
    return sample_sets(Robot.from_text(ROBOT), 24, np.random.default_rng(1))


@pytest.mark.parametrize("function", ["forward_kinematics", "gravity_vector", "inverse_dynamics", "forward_dynamics"])
def test_every_way_is_tried_with_every_set_and_a_long_batch_once(function: str, sets: tuple[SampleSet, ...]) -> None:
    found = [trial.how for trial in trials(Perfect(sets), function, sets)]
    ways = ["one configuration", "a batch", "broadcast batches"]
    assert found == [*ways, "a long batch"] + 2 * ways + 3 * ["a batch of parameters"]


@pytest.mark.parametrize("function", ["jacobian", "inertia_matrix", "coriolis_matrix", "inverse_dynamics"])
def test_calls_give_what_is_expected_of_them(function: str, sets: tuple[SampleSet, ...]) -> None:
    """Shapes belong together, also where rows repeat."""
    for trial in trials(Perfect(sets), function, sets):
        expected = expectation(function, trial.sample_set, trial.arguments)
        got = trial.run()
        if trial.repeated:
            assert len(got) == trial.repeated == BLOCK_ROWS
            got = expected.farthest_repetitions(got)
        assert got.shape == expected.value.shape
        assert expected.errors(got).max() < 1e-12


def test_of_repetitions_the_farthest_counts(sets: tuple[SampleSet, ...]) -> None:
    """One wrong row among thousands, in whatever repetition, and one that is no number."""
    arguments = tuple(sets[0].arguments[name] for name in ("q", "qd", "qdd"))
    expected = expectation("inverse_dynamics", sets[0], arguments)
    count = len(arguments[0])
    for row in (0, count - 1, 5 * count + 2, BLOCK_ROWS - 1):
        got = np.resize(expected.value, (BLOCK_ROWS, 2))
        got[row, 1] += 1.0
        got[(row + 1) % BLOCK_ROWS, 0] = np.nan
        farthest = expected.farthest_repetitions(got)
        assert farthest[row % count, 1] == got[row, 1]
        assert np.isnan(farthest[(row + 1) % BLOCK_ROWS % count, 0])


def test_arguments_cannot_be_written_into(sets: tuple[SampleSet, ...]) -> None:
    class Vandal(Perfect):
        def call(self, function: str, arguments: Sequence[Array], parameters: Mapping[str, Any]) -> Array:
            arguments[0][...] = 0.0
            return arguments[0]

    for trial in trials(Vandal(sets), "gravity_vector", sets):
        with pytest.raises(ValueError, match="read-only"):
            trial.run()
