"""What a target may ask about a derived quantity: its shape, how long an entry is, and the entry itself.

The size is known before an entry is converted, so that an entry too long to print costs nothing.

What a target may ask about the singularities of a robot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol


class Quantity(Protocol):
    """A matrix in the lecture form; vectors are columns and scalars are 1x1."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""

    def terms(self, row: int, column: int) -> int:
        """Number of terms of an entry when multiplied out; 0 if it is zero. Indices count from 1."""

    def entry(self, row: int, column: int) -> Any:
        """The SymPy expression of an entry."""


Quantities = Mapping[str, Quantity]
"""By name, as in ``derive show``: ``A[1]``, ``T``, ``T[0,3]``, ``J``, ``B``, ``christoffel[1,2,3]``, ``C``, ``tau``."""


@dataclass(frozen=True)
class SingularBlock:
    """A square block of J.

    Attributes:
        name: ``J``, or ``J_11`` and ``J_22`` where J is block triangular about the wrist centre.
        rows: Its rows of J, from 1.
        frame: DH frame in whose axes it is, None for the world.
        point: DH frame whose origin is the point of the last link, None for the end effector.
        others_are_zero: Whether the rows of J that are left out are zero everywhere.
        quantity: The block.
    """

    name: str
    rows: tuple[int, ...]
    frame: int | None
    point: int | None
    others_are_zero: bool
    quantity: Quantity


@dataclass(frozen=True)
class SingularFactor:
    """A factor of the determinant.

    Attributes:
        expression: The factor.
        exponent: Its power.
        terms: Number of its terms when multiplied out.
        moving: Whether it moves with the arm.
        variable: The joint variable or sum of angles that its zeros are known of, else None.
        values: The zeros, angles in (-pi, pi].
        posture: ``wrist``, ``elbow``, ``shoulder``, or nothing.
    """

    expression: Any
    exponent: int
    terms: int
    moving: bool
    variable: Any
    values: tuple[Any, ...]
    posture: str


@dataclass(frozen=True)
class SingularityQuantity:
    """The determinant of a square block of J, as a 1x1 quantity.

    Attributes:
        outcome: ``found``, ``never``, ``everywhere``, ``redundant`` or ``too long``.
        blocks: The diagonal blocks whose determinants are multiplied.
        factors: The factors of the determinant.
        determinant: Their product, None where it was not computed.
        budget: Most terms of any polynomial on the way to the determinant.
    """

    outcome: str
    blocks: tuple[SingularBlock, ...]
    factors: tuple[SingularFactor, ...]
    determinant: Any
    budget: int

    @property
    def shape(self) -> tuple[int, int]:
        """A scalar."""
        return (1, 1)

    def terms(self, row: int, column: int) -> int:
        """Terms of all factors together."""
        return sum(factor.terms for factor in self.factors) or int(self.determinant not in (None, 0))

    def entry(self, row: int, column: int) -> Any:
        """The determinant in factors."""
        return self.determinant
