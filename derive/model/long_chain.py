"""Kinematics of arms whose expanded polynomials would be too long: SymPy expressions nested from the base outwards.

SymPy expressions as scalars: for kinematics that is nested instead of expanded.

Kinematics straight from the recursion, nested from the base outwards.

For arms whose expanded polynomials are too long. Everything is computed from the end effector inwards, so that an
expression is ``c1*(...) + s1*(...)`` with inner parts shared between entries; a chain of n joints costs O(n^2)
operations where its polynomials have a number of terms exponential in n.

How many terms nested kinematics has when multiplied out, without multiplying out.

The recursion of `derive.model.long_chain` runs on numbers of terms instead of expressions: a sum has the terms of its
parts together, a product the product of theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Generic

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import TooManyTerms
from derive.lecture.form import LectureForm
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.vectors import Frame, Matrix, S, Vector, multiply, scale
from derive.model.kinematics import Kinematics
from derive.model.matrices import columns_matrix, frame_matrix
from derive.robot.description import Convention, Joint
from derive.robot.expression import Expression
from derive.robot.robot import Robot


class SymPyDomain:
    """A `derive.mechanics.chain.Domain` whose scalars are SymPy expressions.

    Args:
        domain: A polynomial domain in which every angle is a generator by itself; leaves are written from it.
    """

    def __init__(self, domain: PolynomialDomain) -> None:
        self.domain = domain
        self.form = LectureForm(domain)

    def number(self, value: int | Fraction) -> Expr:
        """A rational."""
        return sympy.Rational(Fraction(value).numerator, Fraction(value).denominator)

    def constant(self, expression: Expression) -> Expr:
        """A cell without joint variables."""
        return self.form.kinematic(self.domain.constant(expression))

    def cosine_sine(self, angle: Expression) -> tuple[Expr, Expr]:
        """Cosine and sine of a constant angle."""
        c, s = self.domain.cosine_sine(angle)
        return self.form.kinematic(c), self.form.kinematic(s)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Expr, Expr]:
        """Cosine and sine of ``sign*q + theta``."""
        c, s = self.domain.joint_cosine_sine(index, joint)
        return self.form.kinematic(c), self.form.kinematic(s)

    def joint_offset(self, index: int, joint: Joint) -> Expr:
        """``sign*q + d``."""
        return self.form.kinematic(self.domain.joint_offset(index, joint))


@dataclass(frozen=True)
class NestedKinematics(Generic[S]):
    """T and J of a chain, nested from the base outwards.

    Attributes:
        end: The end effector in the world.
        linear: Columns of the linear part of J, world frame.
        angular: Columns of the angular part of J, world frame.
    """

    end: Frame[S]
    linear: tuple[Vector[S], ...]
    angular: tuple[Vector[S], ...]


def nested_kinematics(chain: Chain[S]) -> NestedKinematics[S]:
    """T and J of ``chain`` from the end effector inwards."""
    end = chain.tool
    columns: list[tuple[Vector[S], Vector[S]]] = []
    for joint in reversed(chain.joints):
        rotation = joint.motion(chain.zero, chain.one)
        columns = [*(_turned(c, rotation.rotation) for c in columns)]
        end = rotation @ end
        columns.insert(0, _column(chain, joint.revolute, joint.sign, end.position))
        columns = [_turned(c, joint.fixed.rotation) for c in columns]
        end = joint.fixed @ end
    columns = [_turned(c, chain.base.rotation) for c in columns]
    return NestedKinematics(
        end=chain.base @ end,
        linear=tuple(v for v, _ in columns),
        angular=tuple(w for _, w in columns),
    )


def _column(chain: Chain[S], revolute: bool, sign: int, p: Vector[S]) -> tuple[Vector[S], Vector[S]]:
    """Velocity of the end and of the link per unit rate about (along) z, in a frame on the axis of the joint."""
    zero = chain.zero
    z = (zero, zero, chain.one)
    v, w = ((-p[1], p[0], zero), z) if revolute else (z, (zero, zero, zero))
    return (v, w) if sign > 0 else (scale(-1, v), scale(-1, w))


def _turned(column: tuple[Vector[S], Vector[S]], rotation: Matrix[S]) -> tuple[Vector[S], Vector[S]]:
    return multiply(rotation, column[0]), multiply(rotation, column[1])


def product(frames: Sequence[Frame[S]]) -> Frame[S]:
    """The product of frames from the right, so that it nests outwards."""
    result = frames[-1]
    for frame in reversed(frames[:-1]):
        result = frame @ result
    return result


Expr = Any
SympyMatrix = Any

MAX_TERMS = 300
"""Entries of a transform with more terms are nested from the recursion instead of derived as polynomials."""

ALWAYS_SHORT = 8
"""Arms with so few joints are never long; measuring them would be wasted."""


class LongChain:
    """Decides what is too long to expand, and writes that.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._reach: dict[int, int] = {}

    def is_long(self, i: int, j: int) -> bool:
        """Whether the entries of the transform between frames i and j are too long to expand."""
        if self.robot.n <= ALWAYS_SHORT:
            return False
        start, end = sorted((i, j))
        if start not in self._reach:
            self._reach[start] = self._measure(start)
        return end > self._reach[start]

    def _measure(self, i: int) -> int:
        """The last j up to which the polynomials of T_j^i stay short."""
        probe = PolynomialDomain(self.robot, rates=False, max_terms=20 * MAX_TERMS)
        kinematics = Kinematics(self.robot, probe)
        for j in range(i + 1, self.robot.n + 1):
            try:
                frame = kinematics.transform(i, j)
            except TooManyTerms:
                return j - 1
            if max(len(x) for x in (*frame.position, *frame.rotation[0], *frame.rotation[1])) > MAX_TERMS:
                return j - 1
        return self.robot.n

    @cached_property
    def chain(self) -> Chain[Expr]:
        """The arm over SymPy expressions, each angle by itself."""
        alone = PolynomialDomain(self.robot, rates=False, sums=lambda group: False)
        return build_chain(self.robot, SymPyDomain(alone))

    @cached_property
    def kinematics(self) -> NestedKinematics[Expr]:
        """T and J."""
        return nested_kinematics(self.chain)

    @property
    def end(self) -> SympyMatrix:
        """The end effector in the world, 4x4."""
        return frame_matrix(self.kinematics.end)

    @property
    def jacobian(self) -> SympyMatrix:
        """J, 6xn, world frame."""
        return columns_matrix(self.kinematics.linear, self.kinematics.angular)

    def frame(self, i: int) -> SympyMatrix:
        """DH frame i in the world, 4x4."""
        return frame_matrix(product([self.chain.base, *(self._row(k) for k in range(1, i + 1))]))

    def transform(self, i: int, j: int) -> SympyMatrix:
        """DH frame j in DH frame i, 4x4."""
        if i < j:
            return frame_matrix(product([self._row(k) for k in range(i + 1, j + 1)]))
        t = self.transform(j, i)
        turned = t[:3, :3].T
        rows = turned.row_join(-turned * t[:3, 3])
        return sympy.ImmutableMatrix(rows.col_join(sympy.Matrix([[0, 0, 0, 1]])))

    def _row(self, i: int) -> Frame[Expr]:
        joint = self.chain.joints[i - 1]
        motion = joint.motion(self.chain.zero, self.chain.one)
        if self.robot.convention is Convention.STANDARD:
            return motion @ self.chain.ends[i - 1]
        return joint.fixed @ motion


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
