"""Verification finds wrong operators anywhere in generated code, not only faults planted at its outputs."""

import random
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from derive.errors import VerificationError
from derive.programs.build import build_program
from derive.robot.robot import Robot
from derive.targets.casadi import render_casadi
from derive.targets.numpy import render_numpy
from derive.targets.target import Source
from derive.verification.generated import GeneratedModel, load_models
from derive.verification.oracle.functions import FUNCTIONS
from derive.verification.samples import SampleSet, sample_sets
from derive.verification.verify import verify
from tests.random_robots import random_robot

STEP = re.compile(r"^\s+t\d+ = \S.*? ([+*-]) ", re.MULTILINE)
"""A line of a kernel with an operator between blanks."""

OTHER = {"+": "-", "-": "+", "*": "+"}

Render = Callable[[Source], dict[str, str]]


@pytest.mark.parametrize(
    ("render", "joints"),
    [
        pytest.param(render_numpy, 3, id="numpy"),
        pytest.param(render_numpy, 4, id="numpy-longer", marks=pytest.mark.sweep),
        pytest.param(render_casadi, 4, id="casadi", marks=pytest.mark.sweep),
    ],
)
def test_a_changed_operator_is_found_unless_it_changes_no_value(tmp_path: Path, render: Render, joints: int) -> None:
    rng = random.Random(11)
    robot = Robot.from_text(random_robot(rng, joints).text)
    (file, text), *_ = render(Source(robot, build_program(robot), "0.0.0")).items()
    (tmp_path / file).write_text(text, encoding="utf-8")
    (right,) = load_models(tmp_path)
    verify(robot, tmp_path, samples=6)
    operators = [match.start(1) for match in STEP.finditer(text)]
    assert len(operators) > 100
    found = 0
    for place in rng.sample(operators, 8):
        mutant = text[:place] + OTHER[text[place]] + text[place + 1 :]
        (tmp_path / file).write_text(mutant, encoding="utf-8")
        try:
            verify(robot, tmp_path, samples=6)
        except VerificationError:
            found += 1
        else:
            (wrong,) = load_models(tmp_path)
            assert_same_values(right, wrong, sample_sets(robot, 60, np.random.default_rng(1))[0])
    assert found >= 6


def assert_same_values(one: GeneratedModel, other: GeneratedModel, sample_set: SampleSet) -> None:
    """Some work is redundant: a C matrix has the same value for every split of what cancels in it."""
    for name, definition in FUNCTIONS.items():
        arguments = [sample_set.arguments[argument] for argument in definition.arguments]
        values = [model.call(name, arguments, sample_set.parameters) for model in (one, other)]
        assert np.allclose(*values, rtol=1e-9, atol=1e-9)
