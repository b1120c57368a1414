"""How many terms nested kinematics has when multiplied out, without multiplying out.

The recursion of `derive.mechanics.nested` runs on numbers of terms instead of expressions: a sum has the terms of its
parts together, a product the product of theirs.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from derive.algebra.domain import PolynomialDomain
from derive.mechanics.chain import build_chain
from derive.mechanics.nested import NestedKinematics, nested_kinematics
from derive.robot.expression import Expression
from derive.robot.robot import Joint, Robot


@dataclass(frozen=True, slots=True)
class TermCount:
    """A number of terms, as a scalar of the recursions.

    Attributes:
        value: The number; 0 for what is zero.
    """

    value: int

    def __add__(self, other: Any, /) -> TermCount:
        return TermCount(self.value + _count(other))

    __radd__ = __sub__ = __rsub__ = __add__

    def __mul__(self, other: Any, /) -> TermCount:
        return TermCount(self.value * _count(other))

    __rmul__ = __mul__

    def __neg__(self) -> TermCount:
        return self


def _count(scalar: Any) -> int:
    return scalar.value if isinstance(scalar, TermCount) else int(scalar != 0)


class TermCountDomain:
    """A `derive.mechanics.chain.Domain` of numbers of terms.

    Args:
        domain: Where the leaves are counted; every angle stands by itself in it.
    """

    def __init__(self, domain: PolynomialDomain) -> None:
        self._domain = domain

    def number(self, value: int | Fraction) -> TermCount:
        """A rational."""
        return TermCount(int(value != 0))

    def constant(self, expression: Expression) -> TermCount:
        """A cell without joint variables."""
        return TermCount(len(self._domain.constant(expression)))

    def cosine_sine(self, angle: Expression) -> tuple[TermCount, TermCount]:
        """Cosine and sine of a constant angle."""
        cosine, sine = self._domain.cosine_sine(angle)
        return TermCount(len(cosine)), TermCount(len(sine))

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[TermCount, TermCount]:
        """Cosine and sine of a joint's angle."""
        cosine, sine = self._domain.joint_cosine_sine(index, joint)
        return TermCount(len(cosine)), TermCount(len(sine))

    def joint_offset(self, index: int, joint: Joint) -> TermCount:
        """Offset of a prismatic joint."""
        return TermCount(len(self._domain.joint_offset(index, joint)))


def nested_term_counts(robot: Robot) -> NestedKinematics[TermCount]:
    """Numbers of terms of T and J."""
    alone = PolynomialDomain(robot, rates=False, sums=lambda group: False)
    return nested_kinematics(build_chain(robot, TermCountDomain(alone)))
