"""What is compared: the functions of the generated interface that some other tool has as well."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.robots import Array, Case

TOLERANCE = 1e-9
"""Largest relative error of a result that is reported."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity of the tables.

    Attributes:
        symbol: Its letter in the tables.
        function: The generated function.
        arguments: ``q``, ``qd``, ``qdd``.
    """

    symbol: str
    function: str
    arguments: tuple[str, ...]

    def shape(self, joints: int) -> tuple[int, ...]:
        """Shape of the value for one configuration."""
        return {"tau": (joints,), "g": (joints,), "T": (4, 4), "J": (6, joints)}.get(self.symbol, (joints, joints))


QUANTITIES = (
    Quantity("tau", "inverse_dynamics", ("q", "qd", "qdd")),
    Quantity("B", "inertia_matrix", ("q",)),
    Quantity("C", "coriolis_matrix", ("q", "qd")),
    Quantity("g", "gravity_vector", ("q",)),
    Quantity("T", "forward_kinematics", ("q",)),
    Quantity("J", "jacobian", ("q",)),
)
BY_SYMBOL = {quantity.symbol: quantity for quantity in QUANTITIES}


def arguments(quantity: Quantity, motions: tuple[Array, ...]) -> tuple[Array, ...]:
    """Those of q, qd and qdd that the function takes."""
    return motions[: len(quantity.arguments)]


def relative_error(case: Case, quantity: Quantity, motions: tuple[Array, ...], got: Array) -> float:
    """Worst relative error against the independent recursion, a C compared through C qd.

    Other tools' C need not be Christoffel's; the product with qd is the same for all.

    Args:
        case: The robot.
        quantity: What was computed.
        motions: q, qd, qdd, (k, n) each.
        got: The values, (k, *shape).
    """
    wanted = case.oracle.evaluate(quantity.function, *arguments(quantity, motions))
    if got.shape != wanted.shape or not np.isfinite(got).all():
        return float("inf")
    if quantity.symbol == "C":
        wanted, got = (np.einsum("kij,kj->ki", matrix, motions[1]) for matrix in (wanted, got))
    return float(np.abs(got - wanted).max() / max(float(np.abs(wanted).max()), 1e-300))
