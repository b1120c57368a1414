"""What is called and with what it is compared; what is wrong with a program, a source or a solution is one message."""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from derive.errors import VerificationError
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.targets.c import render_c
from derive.targets.compiler import require_compiler
from derive.targets.target import Source
from derive.verification import verify as module
from derive.verification.generated import CModel, NumpyModel, find_octave, load_c_model, octave_package, running_octave
from derive.verification.inverse import CLOSED, inverse_errors
from derive.verification.oracle.frames import Array
from derive.verification.oracle.functions import ANGLES, FUNCTIONS, Oracle
from derive.verification.samples import Parameters, SampleSet, sample_sets
from derive.verification.tolerance import Bounds, expectation, regressor_size, relative_errors
from derive.verification.verify import BLOCK_ROWS, trials, verify
from tests.rows import robot_of_rows, text_of_rows
from tests.targets.generated_models import needs_compiler, needs_octave, numpy_model, write_package

LINKS = "[{mass: m1, com: [-1/2, 0, 0], inertia: {zz: 2}}, {mass: 3, com: [0, 0, 1/5]}]"
ARM = text_of_rows("R a: a1 | P alpha: pi/2", f"links: {LINKS}\ngravity: [0, -9.81, 0]")


class Perfect:
    target, file = "perfect", "perfect.py"
    ways = ("one", "batch", "broadcast", "blocks", "parameters")
    constants: Mapping[str, Any] = {"DOF": 2, "PARAMETERS": ("a1", "m1")}

    def __init__(self, sets: Sequence[SampleSet]) -> None:
        self.sets = sets

    def call(self, function: str, arguments: Sequence[Array], parameters: Mapping[str, Any]) -> Array:
        if np.ndim(parameters["m1"]):
            return np.stack([s.oracle.evaluate(function, *(a[k] for a in arguments)) for k, s in enumerate(self.sets)])
        oracle = next(one.oracle for one in self.sets if one.parameters == dict(parameters))
        assert isinstance(oracle, Oracle)
        return oracle.evaluate(function, *arguments)


@pytest.fixture(scope="module")
def sets() -> tuple[SampleSet, ...]:
    return sample_sets(Robot.from_text(ARM), 24, np.random.default_rng(1))


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


ROBOTS = ("scara-perugia", "stanford-deluca", "puma560-corke")
NOT_BOUNDED = {"forward_dynamics", "task_inertia", "base_parameters", *ANGLES}
"""Accelerations and rates of angles grow without bound near singular configurations; a fit has its own yardstick."""


def samples_of(name: str) -> SampleSet:
    return sample_sets(Robot.load(name), 24, np.random.default_rng(3))[0]


@pytest.mark.parametrize("name", ROBOTS)
def test_values_keep_within_their_natural_size(name: str) -> None:
    """The bounds hold, and are of the value's shape: an error of a thousandth of them is never lost."""
    samples = samples_of(name)
    oracle = samples.oracle
    for function in oracle.functions:
        arguments = tuple(samples.arguments[argument] for argument in FUNCTIONS[function].arguments)
        if function in NOT_BOUNDED:
            continue
        limits = Bounds(oracle, arguments[0])
        if FUNCTIONS[function].identifies:
            size = regressor_size(limits, oracle.identification, function, arguments[1:])
        else:
            size = limits.natural_size(function, arguments)
        value = oracle.evaluate(function, *arguments)
        if function == "manipulability_dq":  # which has no bound where it has no value
            value = np.where(oracle.evaluate("manipulability", *arguments)[:, None] > 1e-6, value, 0.0)
        assert np.broadcast_shapes(size.shape, value.shape) == value.shape, function
        assert (np.abs(value) <= size * (1 + 1e-12)).all(), function


def test_errors_are_relative_and_a_function_without_a_natural_size_is_no_silent_zero() -> None:
    samples = samples_of("scara-perugia")
    limits = Bounds(samples.oracle, samples.arguments["q"])
    with pytest.raises(KeyError, match="hovering"):
        limits.natural_size("hovering", (samples.arguments["q"],))
    difference = np.array([0.0, 0.0, 2.0, np.nan, 1.0])
    scale = np.array([0.0, 1.0, 4.0, 1.0, 0.0])
    assert relative_errors(difference, scale).tolist() == [0.0, 0.0, 0.5, np.inf, np.inf]


TWO_BARS = robot_of_rows("R a: a1 | P alpha: pi/2", name="two-bars")


def test_octave_is_found_by_its_variable_or_its_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "octave").write_text("#!/bin/sh\n")
    (tmp_path / "octave").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    found = {"": (str(tmp_path / "octave"),), "octave -W": (str(tmp_path / "octave"), "-W"), "no-such-program": None}
    for variable, command in found.items():
        monkeypatch.setenv("OCTAVE", variable)
        assert find_octave() == command


@needs_octave
def test_a_wrong_function_fails_the_verification(tmp_path: Path) -> None:
    write_package(tmp_path, TWO_BARS)
    assert {row.target for row in verify(TWO_BARS, tmp_path, samples=3).rows} == {"octave"}
    file = tmp_path / "+two_bars" / "jacobian.m"
    right = file.read_text()
    file.write_text(right.replace("J = reshape([\n", "J = 1.5*reshape([\n"))
    with pytest.raises(VerificationError, match=r"jacobian of \+two_bars differs: entry"):
        verify(TWO_BARS, tmp_path, samples=3)
    file.write_text("function J = jacobian(q\n")
    with pytest.raises(VerificationError, match=r"jacobian of \+two_bars raises VerificationError: .*parse error"):
        verify(TWO_BARS, tmp_path, samples=3)


@needs_octave
def test_an_octave_that_ends_is_one_message(tmp_path: Path) -> None:
    write_package(tmp_path, TWO_BARS)
    with running_octave(tmp_path, find_octave()) as (model,):
        model.process.kill()
        with pytest.raises(VerificationError, match=r"Octave ended while it ran \+two_bars"):
            model.call("jacobian", [np.zeros(2)], {"a1": 1.0})


def test_without_octave_the_report_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_package(tmp_path, TWO_BARS)
    monkeypatch.setattr(module, "find_octave", lambda: None)
    (tmp_path / "MANIFEST.json").write_text('{"files": {"+two_bars/jacobian.m": ""}}')
    report = verify(TWO_BARS, tmp_path, samples=3)
    assert octave_package(tmp_path) == "+two_bars"
    assert report.reasons == ("+two_bars: not verified, there is no Octave",)
    with running_octave(tmp_path, None) as found:
        assert found == ()


def test_names_and_numbers_are_those_of_the_header() -> None:
    robot = robot_of_rows("R a: a1, d: d1")
    program = build_program(robot, Effort.QUICK)
    model = CModel(ctypes.CDLL(None), render_c(Source(robot, program, "0.0.0"))["model.h"])
    shapes = {function.name: function.shape for function in program}
    assert model.constants == {**shapes, "DOF": 1, "PARAMETERS": program.parameters, "GIVEN": ()}
    assert set(program.parameters) == {"a1", "d1"}


@needs_compiler
def test_code_that_does_not_compile_is_one_message(tmp_path: Path) -> None:
    (tmp_path / "model.c").write_text("this is no C\n", encoding="utf-8")
    with pytest.raises(VerificationError, match=r"model\.c cannot be compiled"):
        load_c_model(tmp_path / "model.c", require_compiler())


Change = Callable[[Array, Array], tuple[Array, Array]]
PLANAR = robot_of_rows("R a: 0.5 | R a: 0.4", "inverse: {task: [x, y]}")
NAMED = robot_of_rows("R a: 0.5 | R a: 0.4 | R a: 0.2, name: wrist", "inverse: {task: [x, y], given: [q3]}")


@cache
def right_model(robot: Robot = PLANAR) -> NumpyModel:
    program = build_program(robot, Effort.QUICK, names={"forward_kinematics"}, inverse=True)
    assert program.inverse.branches == 2
    return NumpyModel(numpy_model(robot, program))


@dataclass(frozen=True)
class Faulty:
    change: Change
    right: NumpyModel
    target = "numpy"
    file = "model_numpy.py"
    ways = ()
    constants: dict[str, object] = field(default_factory=dict)

    def call(self, function: str, arguments: list[Array], parameters: Parameters) -> Array:
        raise NotImplementedError

    def inverse(self, poses: Array, given: Array, parameters: Parameters) -> tuple[Array, Array]:
        q, status = self.right.inverse(poses, given, parameters)
        return self.change(q.copy(), status.copy())


@pytest.mark.parametrize("robot", [PLANAR, NAMED], ids=["plain", "a given joint with a name"])
def test_a_right_model_passes(robot: Robot) -> None:
    sets = sample_sets(robot, 12, np.random.default_rng(2))
    for poses, worst in inverse_errors(robot, right_model(robot), sets, "report it"):
        assert poses == 12
        assert worst < CLOSED / 10


def without_second(q: Array, status: Array) -> tuple[Array, Array]:
    q[:, 1], status[:, 1] = np.nan, 0
    return q, status


def everything(q: Array, status: Array) -> tuple[Array, Array]:
    found = np.where(np.isnan(q).all(axis=(1, 2), keepdims=True), 0.5, q)
    return found, np.maximum(status, ~status.any(axis=1)[:, None])


def moody(q: Array, status: Array) -> tuple[Array, Array]:
    """One pose in another order than a batch."""
    return (q[:, ::-1], status[:, ::-1]) if len(q) == 1 else (q, status)


OF_ONE_JOINT = np.array([[[0, 0], [1, 0]]])  # of the second branch


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (without_second, "misses the configuration"),
        (lambda q, status: (q[:, [0, 0, 1]], status[:, [0, 0, 1]]), "finds a solution twice"),
        (lambda q, status: (q + 1e-6 * OF_ONE_JOINT, status), r"leads to a pose that is .* off at q = \[.*report it"),
        (lambda q, status: (np.nan_to_num(q), status), "marks branches that do not exist by other things than nan"),
        (lambda q, status: (np.full_like(q, np.nan), np.zeros_like(status)), "finds no solution of a reachable pose"),
        (everything, "finds solutions of poses out of reach"),
        (moody, "gives one pose other solutions than a batch"),
        (lambda q, status: (q[..., :1], status), "returns shapes"),
    ],
)
def test_every_fault_is_found(change: Change, message: str) -> None:
    samples = sample_sets(PLANAR, 12, np.random.default_rng(2))  # the first configuration is singular
    with pytest.raises(VerificationError, match=message):
        list(inverse_errors(PLANAR, Faulty(change, right_model()), samples, "report it"))
