"""What a generated function has to return, whatever the function is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.verify.oracle.arm import Array
from derive.verify.oracle.oracle import Oracle


@dataclass(frozen=True, slots=True, eq=False)
class Expectation:
    """The oracle's answer for a batch of arguments.

    Attributes:
        oracle: The robot with its numbers.
        arguments: Broadcast arguments, (..., n) each.
        value: The answer, (..., *shape).
        scale: What an error of each entry is measured against, broadcastable to ``value``.
    """

    oracle: Oracle
    arguments: tuple[Array, ...]
    value: Array
    scale: Array

    @property
    def called(self) -> int:
        """Number of configurations."""
        return self.arguments[0][..., 0].size

    @property
    def compared(self) -> int:
        """Number of configurations that are compared."""
        return self.called

    def errors(self, got: Array) -> Array:
        """Relative error of each entry; infinite where ``got`` is not a number."""
        return relative(got - self.value, self.scale)

    def farthest_repetitions(self, got: Array, rows: Array) -> Array:
        """Of a batch that repeats the arguments, for each of them the value that is farthest off.

        Args:
            got: The values, (len(rows), *shape).
            rows: Which of the arguments each of them belongs to.
        """
        distance = np.abs(got - self.value[rows]).reshape(len(rows), -1).max(axis=1)
        distance[np.isnan(distance)] = np.inf
        order = np.argsort(distance, kind="stable")
        farthest = np.empty(len(self.value), dtype=int)
        farthest[rows[order]] = order
        values: Array = got[farthest]
        return values


@dataclass(frozen=True, slots=True, eq=False)
class PartialExpectation(Expectation):
    """The answer of a function without a value in some configurations, which are called but not compared.

    Attributes:
        regular: (...) where there is a value.
    """

    regular: Array

    @property
    def compared(self) -> int:
        """Number of configurations with a value."""
        return int(self.regular.sum())

    def errors(self, got: Array) -> Array:
        """Relative error of each entry; 0 where there is no value."""
        errors = relative(got - self.value, self.scale)
        errors[~self.regular] = 0.0
        return errors


def relative(difference: Array, scale: Array) -> Array:
    """Size of a difference in terms of a scale; 0 where there is none, infinite where it is not a number."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(difference) / scale
    exact = np.broadcast_to(difference == 0, ratio.shape)
    errors: Array = np.where(exact, 0.0, np.where(np.isnan(ratio), np.inf, ratio))
    return errors
