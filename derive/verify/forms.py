"""The ways of calling a generated function, each with the arguments at which the oracle has to answer the same."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

import numpy as np

from derive.verify.generated import GeneratedModel, Parameters
from derive.verify.oracle.arm import Array
from derive.verify.oracle.oracle import ANGLES
from derive.verify.samples import SampleSet

BLOCK_ROWS = 8231
"""More configurations than generated code handles at once, and no multiple of anything: faults between blocks show."""


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """One way of calling a function.

    Attributes:
        how: The way in words, for messages.
        run: Calls the generated function.
        arguments: What its values belong to, broadcast to (..., n) each.
        sample_set: The parameters that belong to them.
        rows: Which of ``arguments`` each row of the value belongs to, where rows repeat.
    """

    how: str
    run: Callable[[], Array]
    arguments: tuple[Array, ...]
    sample_set: SampleSet
    rows: Array | None = None


UNDETERMINED = frozenset({"forward_dynamics", *ANGLES})
"""Functions without a value in some configurations: where B, or the angles, are singular."""

Form = Callable[[GeneratedModel, str, tuple[Array, ...], SampleSet], Trial]


def one(model: GeneratedModel, function: str, arguments: tuple[Array, ...], sample_set: SampleSet) -> Trial:
    """One configuration at a time."""

    def run() -> Array:
        rows = zip(*arguments, strict=True)
        return np.stack([_single(model, function, row, sample_set.parameters) for row in rows])

    return Trial("one configuration", run, arguments, sample_set)


def batch(model: GeneratedModel, function: str, arguments: tuple[Array, ...], sample_set: SampleSet) -> Trial:
    """All configurations at once, (samples, n)."""

    def run() -> Array:
        return model.call(function, read_only(arguments), sample_set.parameters)

    return Trial("a batch", run, arguments, sample_set)


def broadcast(model: GeneratedModel, function: str, arguments: tuple[Array, ...], sample_set: SampleSet) -> Trial:
    """Arguments of different batch shapes: (samples, 1, n), (2, n) and (n,)."""
    first, second, third = arguments[:1], arguments[1:2], arguments[2:]
    shaped = [*(a[:, None, :] for a in first), *(a[:2] for a in second), *(a[-1] for a in third)]

    def run() -> Array:
        return model.call(function, read_only(shaped), sample_set.parameters)

    return Trial("broadcast batches", run, tuple(np.broadcast_arrays(*shaped)), sample_set)


def blocks(model: GeneratedModel, function: str, arguments: tuple[Array, ...], sample_set: SampleSet) -> Trial:
    """The same configurations over and over, in more rows than one block holds."""
    rows = np.arange(BLOCK_ROWS) % len(arguments[0])
    long = [argument[rows] for argument in arguments]

    def run() -> Array:
        return model.call(function, read_only(long), sample_set.parameters)

    return Trial("a long batch", run, arguments, sample_set, rows)


FORMS: Mapping[str, Form] = MappingProxyType({"one": one, "batch": batch, "broadcast": broadcast, "blocks": blocks})


def parameter_trials(
    model: GeneratedModel, function: str, arguments: tuple[Array, ...], sample_sets: Sequence[SampleSet]
) -> list[Trial]:
    """Every parameter an array of its numbers in all sets, (sets, 1), against (sets, samples, n) configurations."""
    stacked: Parameters = {
        name: np.array([[sample_set.parameters[name]] for sample_set in sample_sets])
        for name in sample_sets[0].parameters
    }

    shaped = [np.broadcast_to(argument, (len(sample_sets), *argument.shape)) for argument in arguments]

    def trial(index: int) -> Trial:
        def run() -> Array:
            value: Array = np.asarray(model.call(function, read_only(shaped), stacked))[index]
            return value

        return Trial("a batch of parameters", run, arguments, sample_sets[index])

    return [trial(index) for index in range(len(sample_sets))]


def constant_trials(model: GeneratedModel, function: str, sample_sets: Sequence[SampleSet]) -> Iterator[Trial]:
    """A function without arguments: with the parameters of every set, and with all sets at once, (sets,)."""
    for sample_set in sample_sets:
        yield Trial("no arguments", partial(model.call, function, (), sample_set.parameters), (), sample_set)
    if "parameters" not in model.forms or not sample_sets[0].parameters:
        return
    names = sample_sets[0].parameters
    stacked: Parameters = {name: np.array([s.parameters[name] for s in sample_sets]) for name in names}

    def entry(index: int) -> Array:
        value: Array = np.asarray(model.call(function, (), stacked))[index]
        return value

    for index, sample_set in enumerate(sample_sets):
        yield Trial("a batch of parameters", partial(entry, index), (), sample_set)


def _single(model: GeneratedModel, function: str, row: Sequence[Array], parameters: Parameters) -> Array:
    """One value; what ends in a division by zero is not a number where that may be right."""
    try:
        return model.call(function, read_only(row), parameters)
    except (ArithmeticError, np.linalg.LinAlgError):
        if function not in UNDETERMINED:
            raise
        return np.full((6, len(row[0])) if function in ANGLES else row[0].shape, np.nan)


def read_only(arrays: Sequence[Array]) -> list[Array]:
    """Views that a function cannot write into."""
    views = [array.view() for array in arrays]
    for view in views:
        view.flags.writeable = False
    return views
