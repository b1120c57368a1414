"""The ways of calling a generated function, each with the arguments at which the oracle has to answer the same."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from derive.verification.generated import GeneratedModel
from derive.verification.oracle.frames import Array, together
from derive.verification.oracle.functions import ANGLES, FUNCTIONS
from derive.verification.samples import Parameters, SampleSet

# More configurations than generated code handles at once, and no multiple of anything: faults between blocks show.
BLOCK_ROWS = 8231
# Samples times n^4 that may be spent on Christoffel symbols: all samples up to 14 joints, a few beyond.
CHRISTOFFEL_BUDGET = 1_000_000
# Functions without a value in some configurations: where B, J or the angles are singular.
UNDETERMINED = frozenset({"forward_dynamics", "manipulability_dq", *ANGLES})


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """One call of a function."""

    how: str  # the way in words, for messages
    run: Callable[[], Array]  # calls the generated function
    arguments: tuple[Array, ...]  # what its values belong to, broadcast to (..., n) each, a wrench to (..., 6)
    sample_set: SampleSet  # the parameters that belong to them
    repeated: int = 0  # rows of the value where it repeats the arguments over and over; else 0


def trials(model: GeneratedModel, function: str, sample_sets: Sequence[SampleSet]) -> Iterator[Trial]:
    """All calls of a function: in every way that its target offers, with every set of parameters and all at once.

    Long batches are for the first set alone: where they are cut does not depend on numbers.
    """
    for sample_set in sample_sets:
        arguments = _arguments(function, sample_set)
        if not arguments:
            yield Trial("no arguments", partial(model.call, function, (), sample_set.parameters), (), sample_set)
            continue
        for way in model.ways:
            if way != "parameters" and (way != "blocks" or sample_set is sample_sets[0]):
                yield _trial(way, model, function, arguments, sample_set)
    if "parameters" in model.ways and sample_sets[0].parameters:
        # Every parameter an array of its numbers in all sets, (sets, 1), against (sets, samples, n) configurations.
        arguments, sets = _arguments(function, sample_sets[0]), len(sample_sets)
        stacked: Parameters = {
            name: np.reshape([one.parameters[name] for one in sample_sets], (sets, *(1 for _ in arguments[:1])))
            for name in sample_sets[0].parameters
        }
        shaped = read_only([np.broadcast_to(argument, (sets, *argument.shape)) for argument in arguments])
        call = cache(partial(model.call, function, shaped, stacked))
        for index, sample_set in enumerate(sample_sets):
            own: Callable[[], Array] = partial(lambda k: np.asarray(call())[k], index)
            yield Trial("a batch of parameters", own, arguments, sample_set)


def _arguments(function: str, sample_set: SampleSet) -> tuple[Array, ...]:
    """Arguments of a function at as many samples as can be compared: the Christoffel symbols of n joints cost n^4."""
    count, n = sample_set.arguments["q"].shape
    if function == "coriolis_matrix":
        count = min(count, max(2, CHRISTOFFEL_BUDGET // n**4))
    return tuple(sample_set.arguments[name][:count] for name in FUNCTIONS[function].arguments)


def _trial(
    way: str, model: GeneratedModel, function: str, arguments: tuple[Array, ...], sample_set: SampleSet
) -> Trial:
    """A call of a function of configurations: one by one, all at once, broadcast, or in a long batch."""
    numbers = sample_set.parameters
    call = partial(model.call, function)
    if way == "one":
        run = partial(_one_by_one, model, function, arguments, numbers)
        return Trial("one configuration", run, arguments, sample_set)
    if way == "batch":  # (samples, n)
        return Trial("a batch", partial(call, read_only(arguments), numbers), arguments, sample_set)
    if way == "broadcast":  # (samples, 1, n), (2, n) and (n,)
        first, second, third = arguments[:1], arguments[1:2], arguments[2:]
        shaped = [*(a[:, None, :] for a in first), *(a[:2] for a in second), *(a[-1] for a in third)]
        run = partial(call, read_only(shaped), numbers)
        return Trial("broadcast batches", run, together(shaped), sample_set)
    assert way == "blocks", way  # the same configurations over and over, in more rows than one block holds
    rows = np.arange(BLOCK_ROWS) % len(arguments[0])
    run = partial(call, read_only([argument[rows] for argument in arguments]), numbers)
    return Trial("a long batch", run, arguments, sample_set, BLOCK_ROWS)


def _one_by_one(model: GeneratedModel, function: str, arguments: tuple[Array, ...], numbers: Parameters) -> Array:
    """One configuration a call; what ends in a division by zero is not a number where that may be right."""
    values = []
    for row in zip(*arguments, strict=True):
        try:
            values.append(model.call(function, read_only(row), numbers))
        except (ArithmeticError, np.linalg.LinAlgError):
            if function not in UNDETERMINED:
                raise
            values.append(np.full((6, len(row[0])) if function in ANGLES else row[0].shape, np.nan))
    return np.stack(values)


def read_only(arrays: Sequence[Array]) -> list[Array]:
    """Views that a function cannot write into."""
    views = [array.view() for array in arrays]
    for view in views:
        view.flags.writeable = False
    return views
