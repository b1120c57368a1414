"""Accelerations from torques: B qdd = tau - (C qd + g + friction), by a factorisation without roots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, Self, TypeVar

from derive.mechanics.vectors import Scalar


class Field(Scalar, Protocol):
    """A scalar that can also divide."""

    def __truediv__(self, other: Any, /) -> Self:
        """Self over other."""


F = TypeVar("F", bound=Field)


def forward_dynamics(inertia: Sequence[Sequence[F]], bias: Sequence[F], torques: Sequence[F]) -> list[F]:
    """The accelerations qdd.

    Args:
        inertia: B(q), symmetric positive definite.
        bias: C qd + g + friction.
        torques: tau.
    """
    return solve_symmetric(inertia, [t - b for t, b in zip(torques, bias, strict=True)])


def solve_symmetric(matrix: Sequence[Sequence[F]], right: Sequence[F]) -> list[F]:
    """Solve ``matrix x = right`` by matrix = U D U^T with unit upper U, from the last row up.

    Starting at the tip keeps the zeros of a chain's inertia matrix (Featherstone, Rigid Body Dynamics Algorithms,
    section 6.5).
    """
    n = len(right)
    work = [list(row[: i + 1]) for i, row in enumerate(matrix)]
    x = list(right)
    factors: list[list[F]] = [[] for _ in range(n)]
    for k in range(n - 1, -1, -1):
        factors[k] = [entry / work[k][k] for entry in work[k][:k]]
        for i in range(k):
            for j in range(i + 1):
                work[i][j] = work[i][j] - factors[k][i] * work[k][j]
            x[i] = x[i] - factors[k][i] * x[k]
    for k in range(n):
        x[k] = x[k] / work[k][k]
        for i in range(k):
            x[k] = x[k] - factors[k][i] * x[i]
    return x
