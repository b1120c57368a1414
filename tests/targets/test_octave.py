"""The package of MATLAB and Octave: a column for each configuration, texts that both read, arguments named."""

import re
from collections.abc import Iterator

import numpy as np
import pytest

from derive.errors import VerificationError
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.targets.octave import TARGET, package_folder, render_octave
from derive.verification.generated import OctaveModel
from tests.rows import robot_of_rows
from tests.targets.generated_models import needs_octave, planar, source_of
from tests.targets.languages import running
from tests.targets.searched_arms import LOOSE, program_of, robot_of

OCTAVE_ALONE = re.compile(
    r"\bend(?:function|if|for|while|switch)\b|!|\+\+|--|[-+*/]=|\"|^\s*#|\bprintf\b|\bunwind_protect\b"
)
"""What Octave reads and MATLAB does not, or reads otherwise."""


@pytest.fixture(scope="module")
def model() -> Iterator[OctaveModel]:
    with running("octave", planar()) as found:
        yield found


@needs_octave
@pytest.mark.parametrize(
    ("function", "inputs", "message"),
    [
        ("forward_kinematics", [[[1.0]]], r"forward_kinematics: q must be 2 x 1 or 2 x N; got \[1 1\]"),
        ("inertia_matrix", [[[1.0], [2.0]]], "inertia_matrix: missing in params: m1, m2"),
        ("gravity_vector", [[[1.0], [2.0]], [[1.0]]], "gravity_vector: params must be a struct or a vector"),
        ("coriolis_vector", [np.ones((2, 3)), np.ones((2, 2)), np.ones((2, 1))], "qd has 2 columns, and another .* 3"),
    ],
)
def test_wrong_arguments_are_named(model: OctaveModel, function: str, inputs: list[object], message: str) -> None:
    with pytest.raises(VerificationError, match=message):
        model.results(function, [np.asarray(value, dtype=float) for value in inputs], 1)


@needs_octave
def test_rows_are_columns_and_one_column_serves_a_batch(model: OctaveModel) -> None:
    params = np.array([[2.0], [1.5]])
    (column,) = model.results("inertia_matrix", [np.array([[0.1], [0.2]]), params], 1)
    (row,) = model.results("inertia_matrix", [np.array([[0.1, 0.2]]), params], 1)
    np.testing.assert_array_equal(row, column)
    (tau,) = model.results("coriolis_vector", [np.array([[0.1], [0.2]]), np.ones((2, 3)), params], 1)
    assert tau.shape == (2, 3)
    (none,) = model.results("inertia_matrix", [np.zeros((2, 0)), params], 1)
    assert none.shape == (2, 2, 0)


@pytest.mark.parametrize("name", ["planar-2r-perugia", "scara-matlab", "thumb"])
def test_texts_are_matlab_too(name: str) -> None:
    """No syntax of Octave alone, lines and names of a length that MATLAB takes, a function in every file."""
    robot = Robot.load(name)
    texts = render_octave(source_of(robot, build_program(robot, Effort.QUICK, inverse=True)))
    assert TARGET.names(robot) == (f"{package_folder(robot)}/",)
    for file, text in texts.items():
        stem = file.rpartition("/")[2].removesuffix(".m")
        code = [re.sub(r"'(?:[^']|'')*'|%.*", "''", line) for line in text.splitlines()]
        assert not [line for line in code if OCTAVE_ALONE.search(line)], file
        assert max(map(len, text.splitlines())) < 4096
        assert all(len(word) <= 63 for line in code for word in re.findall(r"\w+", line))
        assert stem == "Contents" or re.match(rf"function .*\b{stem}\(.*\)\n%{stem.upper()} \w", text), file


def test_a_robot_without_formulas_says_why_it_has_no_inverse_kinematics() -> None:
    texts = render_octave(source_of(robot_of(LOOSE), program_of(LOOSE)))
    assert not [file for file in texts if "inverse_kinematics" in file]
    (contents,) = (text for file, text in texts.items() if file.endswith("/Contents.m"))
    assert "Inverse kinematics: there is no function, since " in contents


@needs_octave
def test_a_forgotten_argument_is_named_before_parameters_that_are_missing_then() -> None:
    robot = robot_of_rows("R a: a1 | R a: a2 | R a: 0.2", "inverse: {task: [x, y]}")
    program = build_program(robot, Effort.QUICK, inverse=True)
    message = r"inverse_kinematics: given must be 1 x 1 or 1 x N; got \[2 1\]"
    with running("octave", robot, program) as model, pytest.raises(VerificationError, match=message):
        model.results("inverse_kinematics", [np.eye(4), np.array([[0.5], [0.4]])], 1)
