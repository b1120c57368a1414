"""The package of MATLAB and Octave: the same functions as the NumPy module, with a column for each configuration."""

import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from derive.errors import VerificationError
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.targets.numpy import render_numpy
from derive.targets.octave import TARGET, package_folder, render_octave
from derive.verification.octave_model import OctaveModel
from derive.verification.oracle.functions import FUNCTIONS
from derive.verification.samples import SampleSet, sample_sets
from tests.targets.generated_models import load, planar, source_of
from tests.targets.octave_model import needs_octave, octave_model

TOLERANCE = 1e-12
USUAL = ("dh-classical-deluca", "planar-2r-perugia", "scara-matlab")
CASES = [pytest.param(name, marks=() if name in USUAL else pytest.mark.sweep) for name in catalogue_names()]

OCTAVE_ALONE = re.compile(
    r"\bend(?:function|if|for|while|switch)\b|!|\+\+|--|[-+*/]=|\"|^\s*#|\bprintf\b|\bunwind_protect\b"
)
"""What Octave reads and MATLAB does not, or reads otherwise."""


@needs_octave
@pytest.mark.parametrize("name", CASES)
def test_every_function_gives_what_numpy_gives(name: str, tmp_path: Path) -> None:
    """Of one configuration and of a batch, all branches of inverse kinematics, and the nearest one."""
    robot = Robot.load(name)
    program = build_program(robot, Effort.QUICK, inverse=True)
    numpy = load(render_numpy(source_of(robot, program))["model_numpy.py"])
    with octave_model(tmp_path, robot, program) as model:
        for samples in sample_sets(robot, 6, np.random.default_rng(1)):
            for function in program:
                compare(model, numpy, function.name, samples)
            if program.inverse:
                compare_inverse(model, numpy, robot, samples)


def compare(model: OctaveModel, numpy: ModuleType, function: str, samples: SampleSet) -> None:
    arguments = [samples.arguments[kind] for kind in FUNCTIONS[function].arguments]
    options = {"params": dict(samples.parameters)} if samples.parameters else {}
    with np.errstate(all="ignore"):
        wanted = np.asarray(getattr(numpy, function)(*arguments, **options))
    found = model.call(function, arguments, samples.parameters)
    assert found.shape == wanted.shape
    axes = tuple(range(1 if arguments else 0, wanted.ndim))
    scale = np.abs(wanted).max(axis=axes, keepdims=True, initial=1.0)
    regular = np.isfinite(scale) & (scale < 1e3 if function in ("forward_dynamics",) else scale < np.inf)
    assert np.where(regular, np.abs(found - wanted) / scale, 0.0).max(initial=0.0) <= TOLERANCE, function
    if arguments:
        one = model.call(function, [argument[0] for argument in arguments], samples.parameters)
        np.testing.assert_array_equal(one, found[0])


def compare_inverse(model: OctaveModel, numpy: ModuleType, robot: Robot, samples: SampleSet) -> None:
    """The same branches in the same order; pi and -pi are one angle, and a zero's sign may tell them apart."""
    q = samples.arguments["q"]
    given = [k for k in range(robot.n) if robot.joints[k].variable in numpy.GIVEN]
    options = {"params": dict(samples.parameters)} if samples.parameters else {}
    poses = numpy.forward_kinematics(q, **options)
    more = {**options, "given": q[:, given]} if given else options
    wanted, codes = numpy.inverse_kinematics(poses, status=True, **more)
    found, status = model.inverse(poses, q[:, given], samples.parameters)
    np.testing.assert_array_equal(status, codes)
    revolute = np.array([joint.is_revolute for joint in robot.joints])
    turns = 2.0 * np.pi * revolute * np.round((found - wanted) / (2.0 * np.pi))
    np.testing.assert_allclose(found - turns, wanted, rtol=1e-9, atol=1e-9)
    inputs = [poses.transpose(1, 2, 0), q.T]
    if samples.parameters:
        inputs.append(np.array([[samples.parameters[key]] for key in numpy.PARAMETERS]))
    nearest, _ = model.results("inverse_kinematics_nearest", inputs, 2)
    np.testing.assert_allclose(nearest.T, numpy.inverse_kinematics_nearest(poses, q, **options), rtol=1e-9, atol=1e-9)


@needs_octave
def test_singular_poses_have_the_solutions_of_numpy(tmp_path: Path) -> None:
    """Where branches are in doubt they are refined, and looked for elsewhere, as there."""
    robot = Robot.load("puma560-corke")
    program = build_program(robot, Effort.QUICK, inverse=True)
    numpy = load(render_numpy(source_of(robot, program))["model_numpy.py"])
    angles = np.array([[0, 0, 0, 0, 0, 0], [0, 90, -90, 0, 0, 0], [10, 20, 30, 40, 0, 50], [0, 0, -90, 0, 45, 0]])
    poses = numpy.forward_kinematics(np.radians(angles))
    wanted, codes = numpy.inverse_kinematics(poses, status=True)
    with octave_model(tmp_path, robot, program) as model:
        found, status = model.inverse(poses, np.zeros((len(poses), 0)), {})
    np.testing.assert_array_equal(status > 0, codes > 0)
    for rows, kinds in zip(found, status, strict=True):
        again = numpy.forward_kinematics(rows[kinds > 0])
        assert np.abs(again - again[:1]).max() < 1e-9
    assert (status == 3).any()
    assert wanted.shape == found.shape


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OctaveModel]:
    with octave_model(tmp_path_factory.mktemp("package"), planar()) as found:
        yield found


@needs_octave
@pytest.mark.parametrize(
    ("function", "inputs", "message"),
    [
        ("forward_kinematics", [[[1.0]]], r"forward_kinematics: q must be 2 x 1 or 2 x N; got \[1 1\]"),
        ("inertia_matrix", [[[1.0], [2.0]]], "inertia_matrix: missing in params: m1, m2"),
        (
            "gravity_vector",
            [[[1.0], [2.0]], [[1.0]]],
            "gravity_vector: params must be a struct or a vector of 2 numbers",
        ),
        (
            "coriolis_vector",
            [np.zeros((2, 3)), np.zeros((2, 2)), [[1.0], [1.0]]],
            "coriolis_vector: qd has 2 columns, and another argument 3",
        ),
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
    robot = Robot.from_text(
        "name: skew-arm\nconvention: standard\njoints:\n"
        + "".join(f"  - {{type: revolute, a: 0.{k}, alpha: 0.{k + 3}, d: 0.{9 - k}}}\n" for k in range(1, 7))
    )
    texts = render_octave(source_of(robot, build_program(robot, Effort.QUICK, inverse=True)))
    assert "+skew_arm/inverse_kinematics.m" not in texts
    assert "Inverse kinematics: there is no function, since " in texts["+skew_arm/Contents.m"]


@needs_octave
def test_a_forgotten_argument_is_named_before_parameters_that_are_missing_then(tmp_path: Path) -> None:
    rows = "".join(f"  - {{type: revolute, a: {length}}}\n" for length in ("a1", "a2", "0.2"))
    robot = Robot.from_text(f"name: three-bars\nconvention: standard\njoints:\n{rows}inverse: {{task: [x, y]}}\n")
    program = build_program(robot, Effort.QUICK, inverse=True)
    message = r"inverse_kinematics: given must be 1 x 1 or 1 x N; got \[2 1\]"
    with octave_model(tmp_path, robot, program) as model, pytest.raises(VerificationError, match=message):
        model.results("inverse_kinematics", [np.eye(4), np.array([[0.5], [0.4]])], 1)
