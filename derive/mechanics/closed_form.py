"""Closed forms as a further formulation of generated functions: exact polynomials, expanded and then factored.

For small arms, or where most inertial parameters vanish, the expanded polynomial costs less than a recursion once
common parts are found. For others it grows out of bounds, so only short ones are offered.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property

from derive.algebra.domain import PolynomialDomain
from derive.algebra.polynomial_tape import PolynomialTape
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.algebra.tape_domain import TapeDomain
from derive.algebra.tape_value import Value
from derive.errors import ExpressionError
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.composite_inertia import inertia_matrix
from derive.mechanics.coriolis import coriolis_matrix
from derive.mechanics.gravity import gravity_vector
from derive.mechanics.newton_euler import inverse_dynamics
from derive.robot.robot import Robot
from derive.robot.style import Contraction

_MOST_TERMS = 300
"""Of all entries of a function."""


class ClosedForm:
    """The dynamics of one robot as polynomials in one choice of angles.

    Args:
        robot: The robot.
        tape: Where the values go.
        sums: Whether sums of parallel joints' angles are the generators, else each angle by itself.
    """

    def __init__(self, robot: Robot, tape: TapeDomain, *, sums: bool) -> None:
        self._robot = robot
        self._tape = tape
        self._sums = sums

    @cached_property
    def _domain(self) -> PolynomialDomain:
        sums = self._sums
        return PolynomialDomain(
            self._robot, sums=lambda group: sums, contraction=Contraction.OPPOSED, max_terms=_MOST_TERMS
        )

    @cached_property
    def _chain(self) -> Chain[Polynomial]:
        return build_chain(self._robot, self._domain)

    @cached_property
    def _rates(self) -> list[Polynomial]:
        return [self._domain.rate(i) for i in range(self._robot.n)]

    @property
    def words(self) -> str:
        """In which angles."""
        return "closed form in sums of angles" if self._sums else "closed form"

    def inertia(self) -> list[Value] | None:
        """B, row by row, or None where it is long."""
        return self._values(lambda: _flat(inertia_matrix(self._chain)))

    def coriolis(self) -> list[Value] | None:
        """C in Christoffel form."""

        def entries() -> list[Polynomial]:
            return _flat(coriolis_matrix(self._chain, self._rates, self._domain.number(Fraction(1, 2))))

        return self._values(entries)

    def gravity(self) -> list[Value] | None:
        """The gravity vector."""
        return self._values(lambda: gravity_vector(self._chain))

    def torques(self) -> list[Value] | None:
        """B qdd + C qd + g."""

        def entries() -> list[Polynomial]:
            gains = [self._domain.acceleration(i) for i in range(self._robot.n)]
            return inverse_dynamics(self._chain, self._rates, gains)

        return self._values(entries)

    def _values(self, entries: Callable[[], Sequence[Polynomial]]) -> list[Value] | None:
        try:
            found = entries()
        except (TooManyTerms, ExpressionError):
            return None
        if sum(len(entry) for entry in found) > _MOST_TERMS:
            return None
        writer = PolynomialTape(self._domain, self._tape)
        return [writer.value(entry) for entry in found]


def _flat(rows: Sequence[Sequence[Polynomial]]) -> list[Polynomial]:
    return [entry for row in rows for entry in row]
