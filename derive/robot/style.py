"""The ways in which books differ when they print the same expression."""

from __future__ import annotations

from enum import StrEnum
from typing import TypeVar

from derive.errors import QuantityError

Choice = TypeVar("Choice", bound=StrEnum)


class Style(StrEnum):
    """How expressions are grouped.

    Attributes:
        COMPACT: Kinematics nested from the base outwards, ``c1*(a2*c2 + a3*c23)``; dynamics grouped by mass and
            inertia, ``m1*l1**2 + m2*(a1**2 + l2**2 + 2*a1*l2*c2)``.
        BY_GEOMETRY: Kinematics with the lengths factored, ``d6*(...)``; dynamics grouped by geometry,
            ``(m1 + m2)*a1**2 + m2*a2**2 + 2*m2*a1*a2*c2``.
        EXPANDED: Sums of products, ``a2*c1*c2 + a3*c1*c23``.
    """

    COMPACT = "compact"
    BY_GEOMETRY = "by-geometry"
    EXPANDED = "expanded"

    @classmethod
    def named(cls, name: str) -> Style:
        """The style of that name.

        Raises:
            QuantityError: No such style.
        """
        return _named(cls, "style", name)


class Contraction(StrEnum):
    """Which sums of joint angles are contracted.

    Attributes:
        ALIGNED: Those of parallel axes that point the same way: c12, s123.
        OPPOSED: Those of antiparallel axes too: cos(q1 + q2 - q4).
    """

    ALIGNED = "aligned"
    OPPOSED = "opposed"

    @classmethod
    def named(cls, name: str) -> Contraction:
        """The contraction of that name.

        Raises:
            QuantityError: No such contraction.
        """
        return _named(cls, "contraction", name)


def _named(kind: type[Choice], word: str, name: str) -> Choice:
    try:
        return kind(name)
    except ValueError:
        allowed = ", ".join(member.value for member in kind)
        raise QuantityError(f"{word} {name!r}", allowed=allowed) from None
