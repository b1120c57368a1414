"""The elementary equations of inverse kinematics: their unknowns, what each takes, how many values it has.

The types are those of Khalil and Dombre, Modeling, Identification and Control of Robots, 2002, chapter 4.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import cached_property
from typing import Any

from derive.algebra.ring import Polynomial

Exponents = tuple[int, ...]  # of cosine and sine, or of the length, of the unknown


class NodeKind(StrEnum):
    """How a node is solved; the types are those of Khalil and Dombre, 2002, chapter 4."""

    GIVEN = "given"  # the joint is an argument
    SUM = "sum"  # a sum or difference of angles that are known
    TYPE_1 = "type 1"  # X r = Y
    TYPE_2 = "type 2"  # Y c + X s = Z
    TYPE_3 = "type 3"  # two equations Y c + X s = Z
    QUADRATIC = "quadratic"  # X r^2 + Y r = Z
    CONIC = "conic"  # one equation of the second degree in c and s: a quartic
    GENERAL = "general"  # several unknowns at once: elimination and an eigenvalue problem


# How many values an unknown has for given coefficients; of a general node its payload says it.
BRANCHES = {**dict.fromkeys(NodeKind, 1), NodeKind.TYPE_2: 2, NodeKind.QUADRATIC: 2, NodeKind.CONIC: 4}


@dataclass(frozen=True, slots=True)
class Unknown:
    """What a node solves for: a slide, a joint angle, or the sum of the angles of neighbouring parallel joints."""

    joints: tuple[int, ...]  # indices of the joints, from 0
    signs: tuple[int, ...]  # the factor of each joint's variable in the sum; the first is +1
    generators: tuple[str, ...]  # names of the generators in the ring: cosine and sine, or the length

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle, and not a length."""
        return len(self.generators) == 2


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where an equation comes from: M = A_first ... A_last between joint frames, and the rest of the chain around T.

    With the pose W without base and tool, M = (Z_1 ... )^-1 W (... Z_n)^-1. The entries are named as `pool` names them.
    """

    first: int  # first joint of M, from 1
    last: int  # last joint of M
    entry: str  # which entry or invariant of both sides
    outer_left: bool = False  # whether M begins behind the offset of its first joint
    outer_right: bool = False  # whether M ends before the offset of its last joint
    also: Provenance | None = None  # another equation, with which an unknown was eliminated (`unknowns.without`)


@dataclass(frozen=True)
class NodeEquation:
    """``sum of coefficient * c^i s^j = 0`` (or ``coefficient * r^i``) with coefficients of what is known."""

    terms: Mapping[Exponents, Polynomial]  # exponents of the unknown -> coefficient, none of them the zero polynomial
    dimension: int  # the power of length that it has: 0 for entries of rotations, 1 for positions, 2 for squares
    source: Provenance  # where it comes from
    size: Fraction = Fraction(1)  # of its coefficients against those it comes from, lengths in parts of the reach

    def coefficient(self, *exponents: int) -> Polynomial:
        """The coefficient of a power of the unknown, zero where it does not occur."""
        known = self.terms.get(exponents)
        return next(iter(self.terms.values())).ring.zero if known is None else known

    @property
    def linear(self) -> tuple[Polynomial, Polynomial, Polynomial]:
        """(A, B, C) of an equation A c + B s = C of an angle."""
        return self.coefficient(1, 0), self.coefficient(0, 1), -self.coefficient(0, 0)


@dataclass(frozen=True)
class NodeFormula:
    """One way to solve a node."""

    kind: NodeKind  # the elementary type
    equations: tuple[NodeEquation, ...] = ()  # one, or two for type 3; none for sums and given joints
    parts: tuple[tuple[Unknown, int], ...] = ()  # of a sum: the angles that are added, each with its sign
    payload: Any = None  # what a general node needs besides; see `derive.inverse.general.search`

    @property
    def branches(self) -> int:
        """How many values it gives."""
        return int(self.payload.branches) if self.kind is NodeKind.GENERAL else BRANCHES[self.kind]

    @cached_property
    def degenerate(self) -> tuple[Polynomial, ...]:
        """The polynomials at whose common zeros the formula does not determine its unknown; none: it always does."""
        match self.kind:
            case NodeKind.TYPE_1:
                found: tuple[Polynomial, ...] = (self.equations[0].coefficient(1),)
            case NodeKind.QUADRATIC:
                found = (self.equations[0].coefficient(2),)
            case NodeKind.TYPE_2:
                found = self.equations[0].linear[:2]
            case NodeKind.TYPE_3:
                (a, b, _), (d, e, _) = (equation.linear for equation in self.equations)
                found = (a, e) if not b and not d else (b, d) if not a and not e else (a * e - b * d,)
            case NodeKind.CONIC:
                found = tuple(p for exponents, p in self.equations[0].terms.items() if any(exponents))
            case _:
                return ()
        kept = tuple(p for p in found if p)
        return () if self.kind is not NodeKind.TYPE_3 and any(p.is_constant for p in kept) else kept
