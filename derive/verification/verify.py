"""`verify`: compare everything that was generated with the independent recursion, and fail where it differs."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache, partial
from pathlib import Path

import numpy as np

from derive.errors import VerificationError
from derive.inverse.loops import without_parallelograms
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.targets.compiler import find_compiler
from derive.verification import inverse
from derive.verification.generated import COMPILED, MODULES, GeneratedModel, all_models, find_octave, octave_package
from derive.verification.oracle.frames import Array, together
from derive.verification.oracle.functions import ANGLES, FUNCTIONS, stem
from derive.verification.samples import Parameters, SampleSet, sample_sets
from derive.verification.tolerance import TOLERANCE, Expectation, expectation

REMEDY = "this is a fault of derive, not of the robot file: please report it with the file"
TARGETS = ("numpy", "casadi", "native", "c", "casadi-c", "octave")  # the order in which reports list what was verified

# What the oracle has answered: it is asked once, since the targets are called at the same configurations.
_Answers = dict[tuple[object, ...], Expectation]


@dataclass(frozen=True, slots=True)
class VerifiedFunction:
    """One generated function."""

    target: str  # name of the target, ``numpy``, ``casadi`` or ``c``
    function: str  # name of the function
    samples: int  # number of values compared, over all ways of calling
    worst: float  # worst relative error
    note: str = ""  # why values were left out, if any were


@dataclass(frozen=True, slots=True)
class Report:
    """What a verification found: all functions of all targets."""

    robot: str  # name of the robot
    seed: int  # seed of the random configurations and parameters
    rows: tuple[VerifiedFunction, ...]  # one per target and function
    # Files that were not verified since there is no C compiler, and packages since there is no Octave.
    left_out: tuple[str, ...] = ()

    @property
    def worst(self) -> float:
        """Worst relative error of all functions."""
        return max((row.worst for row in self.rows), default=0.0)

    def as_dict(self) -> dict[str, object]:
        """Plain data, for JSON."""
        found = {"worst": self.worst, "left_out": list(self.left_out), "rows": [asdict(row) for row in self.rows]}
        return {"robot": self.robot, "seed": self.seed, "tolerance": TOLERANCE, **found}

    @property
    def reasons(self) -> tuple[str, ...]:
        """What was not verified and why, a line each."""
        lack = {True: "there is no Octave", False: "there is no C compiler"}
        return tuple(f"{file}: not verified, {lack[file.startswith('+')]}" for file in self.left_out)


def verify(
    robot: Robot, folder: Path, *, samples: int = 24, seed: int = 0, libraries: Callable[[], None] = lambda: None
) -> Report:
    """Compare every function of every generated module with the independent recursion.

    Each function is called with one configuration, a batch, broadcast batches, more rows than one block holds and,
    where symbols are free, batches of parameters; at random configurations within the limits and random velocities and
    parameters.
    """
    robot, compiler = without_parallelograms(robot), find_compiler()
    octave, package = find_octave(), octave_package(folder)
    left_out = frozenset() if compiler else COMPILED & {path.name for path in folder.iterdir()}
    left_out |= {package} if package and not octave else set()
    sets = sample_sets(robot, samples, np.random.default_rng(seed))
    names, wanted = sets[0].oracle.names, sets[0].oracle.functions
    rows: list[VerifiedFunction] = []
    models: list[GeneratedModel] = []
    answers: _Answers = {}
    for model in all_models(folder, compiler, octave, libraries):
        models.append(model)
        _check_interface(robot, folder, model)
        # Jacobians that may hardly ever have a value
        rare = {name for name in names if stem(name) in ANGLES and name in model.constants}
        for function in names:
            if function in wanted or function in rare:
                rows.append(_row(model, function, trials(model, function, sets), answers))
        for solver in inverse.solvers(model):
            counted = list(inverse.inverse_errors(robot, solver, sets, REMEDY))
            poses, worst = sum(count for count, _ in counted), max(error for _, error in counted)
            rows.append(VerifiedFunction(model.target, inverse.name_of(solver), poses, worst))
    _check_coverage(folder, models, rows, wanted, left_out)
    rows.sort(key=lambda row: TARGETS.index(row.target))
    return Report(robot.name, seed, tuple(rows), tuple(sorted(left_out)))


def _row(model: GeneratedModel, function: str, calls: Iterator[Trial], answers: _Answers) -> VerifiedFunction:
    compared, called, worst = 0, 0, 0.0
    for trial in calls:
        key = (function, trial.sample_set, *((a.shape, a.tobytes()) for a in trial.arguments))
        if key not in answers:
            answers[key] = expectation(function, trial.sample_set, trial.arguments)
        expected = answers[key]
        called += expected.regular.size
        compared += int(expected.regular.sum())
        worst = max(worst, _worst_error(f"{function} of {model.file}", function, trial, expected))
    known = stem(function)
    singular = "angles" if known in ANGLES else "inertia matrix" if "dynamics" in known else "Jacobian"
    note = f"{called - compared} of {called} left out: singular {singular}" if compared < called else ""
    return VerifiedFunction(model.target, function, compared, worst, note)


def _worst_error(where: str, function: str, trial: Trial, expected: Expectation) -> float:
    """The worst error of one call, if it is within the tolerance."""
    try:
        with np.errstate(all="ignore"):
            got = np.asarray(trial.run(), dtype=float)
    except Exception as error:
        if isinstance(error, (ArithmeticError, np.linalg.LinAlgError)) and not expected.regular.all():
            return 0.0  # by zero, which may be right there
        found = f"{where} raises {type(error).__name__}: {error} ({trial.how})"
        raise VerificationError(found, remedy=REMEDY) from error
    shape = (trial.repeated, *expected.value.shape[1:]) if trial.repeated else expected.value.shape
    if got.shape != shape:
        found = f"{where} returns shape {got.shape} instead of {shape} ({trial.how})"
        raise VerificationError(found, remedy=REMEDY)
    if trial.repeated:
        got = expected.farthest_repetitions(got)
    errors = expected.errors(got)
    worst = float(errors.max(initial=0.0))
    if worst > TOLERANCE:
        said = f"{where} {_difference(function, trial, expected, got, errors)}"
        raise VerificationError(said, allowed=f"relative errors up to {TOLERANCE:g} are allowed", remedy=REMEDY)
    return worst


def _difference(function: str, trial: Trial, expected: Expectation, got: Array, errors: Array) -> str:
    """The entry that is farthest off, and where."""
    batch = expected.arguments[0].ndim - 1 if expected.arguments else 0
    place = np.unravel_index(int(np.argmax(errors)), errors.shape)
    entry = ",".join(str(int(k) + 1) for k in place[batch:])
    values = []
    for name, argument in zip(FUNCTIONS[stem(function)].arguments, expected.arguments, strict=True):
        numbers = ", ".join(f"{value:.17g}" for value in argument[place[:batch]])
        values.append(f"{name} = [{numbers}]")
    values += [f"{name} = {value:.17g}" for name, value in trial.sample_set.parameters.items()]
    found = f"differs: entry [{entry}] is {got[place]:.17g} instead of {expected.value[place]:.17g}"
    return f"{found} ({trial.how}) at {', '.join(values)}"


def _check_interface(robot: Robot, folder: Path, model: GeneratedModel) -> None:
    """The module's constants are those of this robot."""
    constants = model.constants
    parameters = tuple(constants.get("PARAMETERS", ()))
    rows = (("DOF", constants.get("DOF"), robot.dof), ("PARAMETERS", parameters, free_symbols(robot)))
    for name, found, wanted in rows:
        if found != wanted:
            said = f"{name} of {model.file} is {found!r} instead of {wanted!r}"
            raise VerificationError(said, remedy=f"rebuild {folder.name}, it belongs to another robot file")


def _check_coverage(
    folder: Path,
    models: list[GeneratedModel],
    rows: list[VerifiedFunction],
    wanted: tuple[str, ...],
    left_out: frozenset[str],
) -> None:
    """Every function that the robot has or the manifest lists was called: all of nothing is right, too."""
    path = folder / "MANIFEST.json"
    try:
        manifest = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    except ValueError as error:
        raise VerificationError(f"{folder.name}/MANIFEST.json is not JSON: {error}", remedy="build it again") from error
    if not isinstance(manifest, dict):
        manifest = {}
    listed = {*wanted, *manifest.get("operations", ())}
    modules = {str(name).partition("/")[0] for name in manifest.get("files", ())}
    absent = {name for name in modules if name in MODULES or name.startswith("+")} - left_out
    absent -= {model.file for model in models}
    if absent or not (models or manifest):
        missing = ", ".join(sorted(absent or MODULES))
        raise VerificationError(f"{folder.name} does not hold {missing}", remedy="build the robot again")
    for model in models:
        called = {row.function for row in rows if row.target == model.target}
        of_ends = {name for name in listed if name.startswith(f"{inverse.FUNCTION}_")}  # NumPy alone has these
        lacking = listed - called - (set() if model.target == "numpy" else of_ends)
        if lacking:
            missing = ", ".join(sorted(lacking))
            raise VerificationError(f"{model.file}: not verified: {missing}", remedy=REMEDY)


# -- the ways of calling a generated function, each with the arguments at which the oracle has to answer the same

# More configurations than generated code handles at once, and no multiple of anything: faults between blocks show.
BLOCK_ROWS = 8231
LANE_ROWS = 1031  # the same of C, whose blocks have up to 32
# Samples times n^4 that may be spent on Christoffel symbols: all samples up to 14 joints, a few beyond.
CHRISTOFFEL_BUDGET = 1_000_000
# Functions without a value in some configurations: where B, J or the angles are singular.
UNDETERMINED = frozenset(
    {"forward_dynamics", "forward_dynamics_wrench", "forward_dynamics_wrench_end", "manipulability_dq", *ANGLES}
)


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """One call of a function."""

    how: str  # the way in words, for messages
    run: Callable[[], Array]  # calls the generated function
    given: tuple[Array, ...]  # its arguments, broadcast to (..., n) each, a wrench to (..., 6)
    sample_set: SampleSet  # the parameters that belong to them
    repeated: int = 0  # rows of the value where it repeats the arguments over and over; else 0

    @property
    def arguments(self) -> tuple[Array, ...]:
        """What its values belong to: all but the positions of passive joints, which follow."""
        return self.given[:-1] if self.sample_set.oracle.is_iterated else self.given


def trials(model: GeneratedModel, function: str, sample_sets: Sequence[SampleSet]) -> Iterator[Trial]:
    """All calls of a function: in every way that its target offers, with every set of parameters and all at once."""
    for sample_set in sample_sets:
        arguments = _arguments(function, sample_set)
        if not arguments:
            yield Trial("no arguments", partial(model.call, function, (), sample_set.parameters), (), sample_set)
            continue
        for way in model.ways:  # long batches for the first set alone: where they are cut does not depend on numbers
            if way != "parameters" and (way != "blocks" or sample_set is sample_sets[0]):
                yield _trial(way, model, function, arguments, sample_set)
    if "parameters" in model.ways and sample_sets[0].parameters:
        # Every parameter an array of its numbers in all sets, (sets, 1), against (sets, samples, n) configurations of
        # these: loops that close with the numbers of one set may be open with those of another.
        owned = [_arguments(function, one) for one in sample_sets]
        names, shape = sample_sets[0].parameters, (-1, *(1 for _ in owned[0][:1]))
        stacked = {name: np.reshape([one.parameters[name] for one in sample_sets], shape) for name in names}
        call = cache(partial(model.call, function, read_only([*map(np.stack, zip(*owned, strict=True))]), stacked))
        for index, (sample_set, arguments) in enumerate(zip(sample_sets, owned, strict=True)):
            own: Callable[[], Array] = partial(lambda k: np.asarray(call())[k], index)
            yield Trial("a batch of parameters", own, arguments, sample_set)


def _arguments(function: str, sample_set: SampleSet) -> tuple[Array, ...]:
    """Arguments of a function at as many samples as can be compared: the Christoffel symbols of n joints cost n^4."""
    count, n = sample_set.arguments["q"].shape
    if function == "coriolis_matrix":
        count = min(count, max(2, CHRISTOFFEL_BUDGET // n**4))
    names = FUNCTIONS[stem(function)].arguments
    if sample_set.oracle.is_iterated:
        names = (*names, "start" if function == "passive_positions" else "q_p")
    return tuple(sample_set.arguments[name][:count] for name in names)


def _trial(
    way: str, model: GeneratedModel, function: str, arguments: tuple[Array, ...], sample_set: SampleSet
) -> Trial:
    numbers, call = sample_set.parameters, partial(model.call, function)
    if way == "one":
        run = partial(_one_by_one, model, function, arguments, numbers)
        return Trial("one configuration", run, arguments, sample_set)
    if way == "batch":  # (samples, n)
        return Trial("a batch", partial(call, read_only(arguments), numbers), arguments, sample_set)
    if way == "broadcast":  # (samples, 1, n), (2, n) and (n,)
        first, second, third = arguments[:1], arguments[1:2], arguments[2:]
        shaped = [*(a[:, None, :] for a in first), *(a[:2] for a in second), *(a[-1] for a in third)]
        if sample_set.oracle.is_iterated:  # passive joints belong to q
            shaped[-1] = arguments[-1][:, None, :]
        run = partial(call, read_only(shaped), numbers)
        return Trial("broadcast batches", run, together(shaped), sample_set)
    assert way == "blocks", way  # the same configurations over and over, in more rows than one block holds
    rows = np.arange(LANE_ROWS if model.target == "c" else BLOCK_ROWS) % len(arguments[0])
    run = partial(call, read_only([argument[rows] for argument in arguments]), numbers)
    return Trial("a long batch", run, arguments, sample_set, len(rows))


def _one_by_one(model: GeneratedModel, function: str, arguments: tuple[Array, ...], numbers: Parameters) -> Array:
    """One configuration a call; what ends in a division by zero is not a number where that may be right."""
    values = []
    for row in zip(*read_only(arguments), strict=True):
        try:
            values.append(model.call(function, row, numbers))
        except (ArithmeticError, np.linalg.LinAlgError):
            if stem(function) not in UNDETERMINED:
                raise
            values.append(np.full((6, len(row[0])) if stem(function) in ANGLES else row[0].shape, np.nan))
    return np.stack(values)


def read_only(arrays: Sequence[Array]) -> list[Array]:
    """Views that a function cannot write into."""
    return [np.broadcast_to(array, array.shape) for array in arrays]
