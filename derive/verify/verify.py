"""`verify`: compare everything that was generated with the independent recursion, and fail where it differs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from derive.errors import VerificationError
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.targets.compiler import Command, find_compiler
from derive.verify.expectation import expectation
from derive.verify.expected import Expectation, PartialExpectation
from derive.verify.forms import FORMS, Trial, constant_trials, parameter_trials
from derive.verify.generated import COMPILED, MODULES, GeneratedModel, compile_models, load_models
from derive.verify.oracle.arm import Array
from derive.verify.oracle.oracle import ANGLES, FUNCTIONS, Oracle
from derive.verify.report import TOLERANCE, Report, Row
from derive.verify.samples import SampleSet, sample_sets

REMEDY = "this is a fault of derive, not of the robot file: please report it with the file"

CHRISTOFFEL_BUDGET = 1_000_000
"""Samples times n^4 that may be spent on Christoffel symbols: all samples up to 14 joints, a few beyond."""


def verify(robot: Robot, folder: Path, *, samples: int = 24, seed: int = 0) -> Report:
    """Compare every function of every generated module with the independent recursion.

    Each function is called with one configuration, a batch, broadcast batches, more rows than one block holds and,
    where symbols are free, batches of parameters; at random configurations within the limits and random velocities and
    parameters.

    Args:
        robot: The robot.
        folder: Its generated folder, with any of ``model_numpy.py``, ``model_casadi.py`` and ``model.c``; the last is
            left out where there is no C compiler, and the report says so.
        samples: Number of configurations.
        seed: Seed of their random choice.

    Returns:
        The worst relative error of each function.

    Raises:
        VerificationError: A function differs by more than 1e-9, raises, returns another shape, or is missing.
    """
    compiler = find_compiler()
    left_out = frozenset() if compiler else COMPILED & {path.name for path in folder.iterdir()}
    sets = sample_sets(robot, samples, np.random.default_rng(seed))
    rows: list[Row] = []
    expectations = _Expectations()
    models: list[GeneratedModel] = []
    for model in _models(folder, compiler):
        models.append(model)
        _check_interface(robot, folder, model)
        verifier = _Verifier(model, sets, expectations)
        rows += [verifier.row(function) for function in _functions(sets[0].oracle, model)]
    _check_coverage(folder, tuple(models), rows, sets[0].oracle.functions, left_out)
    return Report(robot.name, seed, tuple(rows), tuple(sorted(left_out)))


def _models(folder: Path, compiler: Command | None) -> Iterator[GeneratedModel]:
    """All targets; the C compiler works while the others are verified."""
    with ThreadPoolExecutor(1) as pool:
        compiled = pool.submit(compile_models, folder, compiler)
        yield from load_models(folder)
        yield from compiled.result()


class _Expectations:
    """What the oracle answers, asked once: the targets are called at the same configurations."""

    def __init__(self) -> None:
        self._known: dict[tuple[object, ...], Expectation] = {}

    def of(self, function: str, trial: Trial) -> Expectation:
        """The answer to a trial."""
        key = (function, id(trial.sample_set), *((a.shape, a.tobytes()) for a in trial.arguments))
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = expectation(function, trial.sample_set, trial.arguments)
        return found


@dataclass(frozen=True, slots=True)
class _Verifier:
    """Runs all trials of one target."""

    model: GeneratedModel
    sets: tuple[SampleSet, ...]
    expectations: _Expectations

    def row(self, function: str) -> Row:
        """The worst error of one function over all trials."""
        compared, called, worst = 0, 0, 0.0
        for trial in self.trials(function):
            expected = self.expectations.of(function, trial)
            called += expected.called
            compared += expected.compared
            worst = max(worst, self.check(function, trial, expected))
        reason = "singular angles" if function in ANGLES else "singular inertia matrix"
        note = f"{called - compared} of {called} left out: {reason}" if compared < called else ""
        return Row(self.model.target, function, compared, worst, note)

    def trials(self, function: str) -> Iterator[Trial]:
        names = FUNCTIONS[function].arguments
        if not names:
            yield from constant_trials(self.model, function, self.sets)
            return
        for sample_set in self.sets:
            count = _affordable(function, sample_set)
            arguments = tuple(sample_set.arguments[name][:count] for name in names)
            for form in self.model.forms:
                if form in FORMS:
                    yield FORMS[form](self.model, function, arguments, sample_set)
        if "parameters" in self.model.forms and self.sets[0].parameters:
            count = _affordable(function, self.sets[0])
            arguments = tuple(self.sets[0].arguments[name][:count] for name in names)
            yield from parameter_trials(self.model, function, arguments, self.sets)

    def check(self, function: str, trial: Trial, expected: Expectation) -> float:
        """The worst error of one trial, if it is within the tolerance."""
        got = self.value(function, trial, expected)
        if got is None:
            return 0.0
        rows = trial.rows
        shape = expected.value.shape if rows is None else (len(rows), *expected.value.shape[1:])
        if got.shape != shape:
            found = f"{self.where(function)} returns shape {got.shape} instead of {shape}"
            raise VerificationError(f"{found} ({trial.how})", remedy=REMEDY)
        if rows is not None:
            got = expected.farthest_repetitions(got, rows)
        errors = expected.errors(got)
        worst = float(errors.max(initial=0.0))
        if worst > TOLERANCE:
            raise VerificationError(
                f"{self.where(function)} {_difference(expected, got, errors)} ({trial.how})"
                f" at {_place(function, trial, expected, errors)}",
                allowed=f"relative errors up to {TOLERANCE:g} are allowed",
                remedy=REMEDY,
            )
        return worst

    def value(self, function: str, trial: Trial, expected: Expectation) -> Array | None:
        """What the generated function returns; None where it ends in a division by zero that may be right."""
        try:
            with np.errstate(all="ignore"):
                return np.asarray(trial.run(), dtype=float)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            if isinstance(expected, PartialExpectation) and not expected.regular.all():
                return None
            raise self.failure(function, trial, error) from error
        except Exception as error:
            raise self.failure(function, trial, error) from error

    def failure(self, function: str, trial: Trial, error: Exception) -> VerificationError:
        found = f"{self.where(function)} raises {type(error).__name__}: {error} ({trial.how})"
        return VerificationError(found, remedy=REMEDY)

    def where(self, function: str) -> str:
        return f"{function} of {self.model.file}"


def _functions(oracle: Oracle, model: GeneratedModel) -> list[str]:
    """What has to be there, and analytic Jacobians that hardly ever have a value, where they are."""
    extra = [name for name in ANGLES if name in model.constants]
    return [name for name in FUNCTIONS if name in oracle.functions or name in extra]


def _affordable(function: str, sample_set: SampleSet) -> int:
    """How many samples to compare: the Christoffel symbols of n joints cost n^4."""
    count, n = sample_set.arguments["q"].shape
    return min(count, max(2, CHRISTOFFEL_BUDGET // n**4)) if function == "coriolis_matrix" else int(count)


def _difference(expected: Expectation, got: Array, errors: Array) -> str:
    place = np.unravel_index(int(np.argmax(errors)), errors.shape)
    entry = ",".join(str(int(k) + 1) for k in place[_batch_axes(expected) :])
    return f"differs: entry [{entry}] is {got[place]:.17g} instead of {expected.value[place]:.17g}"


def _place(function: str, trial: Trial, expected: Expectation, errors: Array) -> str:
    batch = _batch_axes(expected)
    place = np.unravel_index(int(np.argmax(errors)), errors.shape)[:batch]
    names = FUNCTIONS[function].arguments
    values = [f"{name} = {_vector(a[place])}" for name, a in zip(names, expected.arguments, strict=True)]
    numbers = [f"{name} = {value:.17g}" for name, value in trial.sample_set.parameters.items()]
    return ", ".join(values + numbers)


def _batch_axes(expected: Expectation) -> int:
    return expected.arguments[0].ndim - 1 if expected.arguments else 0


def _vector(values: Array) -> str:
    return "[" + ", ".join(f"{value:.17g}" for value in values) + "]"


def _check_interface(robot: Robot, folder: Path, model: GeneratedModel) -> None:
    """The module's constants are those of this robot."""
    constants = model.constants
    found = {"DOF": constants.get("DOF"), "PARAMETERS": tuple(constants.get("PARAMETERS", ()))}
    wanted = {"DOF": robot.n, "PARAMETERS": free_symbols(robot)}
    for name, value in wanted.items():
        if found[name] != value:
            raise VerificationError(
                f"{name} of {model.file} is {found[name]!r} instead of {value!r}",
                remedy=f"rebuild {folder.name}, it belongs to another robot file",
            )


def _check_coverage(
    folder: Path,
    models: tuple[GeneratedModel, ...],
    rows: list[Row],
    wanted: tuple[str, ...],
    left_out: frozenset[str],
) -> None:
    """Every function that the robot has or the manifest lists was called: all of nothing is right, too."""
    manifest = _manifest(folder)
    listed = {*wanted, *manifest.get("operations", ())}
    absent = {name for name in manifest.get("files", ()) if name in MODULES - left_out}
    absent -= {model.file for model in models}
    if absent or not (models or manifest):
        missing = ", ".join(sorted(absent or MODULES))
        raise VerificationError(f"{folder.name} does not hold {missing}", remedy="build the robot again")
    for model in models:
        called = {row.function for row in rows if row.target == model.target}
        if listed - called:
            missing = ", ".join(sorted(listed - called))
            raise VerificationError(f"{model.file}: not verified: {missing}", remedy=REMEDY)


def _manifest(folder: Path) -> dict[str, Any]:
    path = folder / "MANIFEST.json"
    if not path.is_file():
        return {}
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise VerificationError(f"{folder.name}/MANIFEST.json is no JSON: {error}", remedy="build it again") from error
    return manifest if isinstance(manifest, dict) else {}
