"""Kinematics of arms whose expanded polynomials would be too long: SymPy expressions nested from the base outwards.

Everything is computed from the end effector inwards, so that an expression is ``c1*(...) + s1*(...)`` with inner parts
shared between entries; a chain of n joints costs O(n^2) operations where its polynomials have a number of terms
exponential in n. How many terms an entry has when multiplied out is found without multiplying out: the same recursion
runs on numbers of terms instead of expressions, a sum having the terms of its parts together, a product the product of
theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any, Generic

import sympy

from derive.algebra.domain import MappedDomain, PolynomialDomain
from derive.algebra.ring import TooManyTerms
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr, Matrix, frame_matrix
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.exact import Kinematics
from derive.mechanics.vectors import Frame, S, Vector, multiply, scale
from derive.robot.robot import Robot

# Entries of a transform with more terms are nested from the recursion instead of derived as polynomials.
LONGEST_ENTRY = 300
ALWAYS_SHORT = 8  # arms with so few joints are never long; measuring them would be wasted


@dataclass(frozen=True)
class NestedKinematics(Generic[S]):
    """T and J of a chain, nested from the base outwards."""

    end: Frame[S]  # the end effector in the world
    linear: tuple[Vector[S], ...]  # columns of the linear part of J, world frame
    angular: tuple[Vector[S], ...]  # columns of the angular part of J, world frame


def nested_kinematics(chain: Chain[S]) -> NestedKinematics[S]:
    """T and J of an arm from the end effector inwards."""
    zero, end = chain.zero, chain.tool
    linear: list[Vector[S]] = []
    angular: list[Vector[S]] = []
    for joint in reversed(chain.joints):
        motion = joint.motion(zero, chain.one)
        # Columns of the joints farther out are seen through this joint's motion.
        linear, angular = ([multiply(motion.rotation, v) for v in columns] for columns in (linear, angular))
        end = motion @ end
        # velocity of the end and of the link per unit rate about (along) z, in a frame on the axis of the joint
        x, y, _ = end.position
        z: Vector[S] = (zero, zero, chain.one)
        v, w = ((-y, x, zero), z) if joint.revolute else (z, chain.null)
        linear.insert(0, v if joint.sign > 0 else scale(-1, v))
        angular.insert(0, w if joint.sign > 0 else scale(-1, w))
        linear, angular = ([multiply(joint.fixed.rotation, v) for v in columns] for columns in (linear, angular))
        end = joint.fixed @ end
    linear, angular = ([multiply(chain.base.rotation, v) for v in columns] for columns in (linear, angular))
    return NestedKinematics(end=chain.base @ end, linear=tuple(linear), angular=tuple(angular))


class LongChain:
    """An arm of which some transforms are too long to expand: says which, and writes those."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._reach: dict[int, int] = {}  # by frame the last one up to which its transforms are short

    def is_long(self, i: int, j: int) -> bool:
        """Whether the entries of the transform between two DH frames are too long to expand."""
        if self.robot.n <= ALWAYS_SHORT:
            return False
        start, end = sorted((i, j))
        if start not in self._reach:
            probe = PolynomialDomain(self.robot, rates=False, offsets=True, max_terms=20 * LONGEST_ENTRY)
            kinematics, last = Kinematics(self.robot, probe), start
            with suppress(TooManyTerms):
                for k in range(start + 1, self.robot.n + 1):
                    frame = kinematics.transform(start, k)
                    if max(len(x) for x in (*frame.position, *frame.rotation[0], *frame.rotation[1])) > LONGEST_ENTRY:
                        break
                    last = k
            self._reach[start] = last
        return end > self._reach[start]

    @cached_property
    def chain(self) -> Chain[Expr]:
        """The arm over SymPy expressions, each angle by itself."""
        alone = PolynomialDomain(self.robot, rates=False, offsets=True, sums=lambda group: False)
        return build_chain(self.robot, MappedDomain(alone, LectureForm(alone).kinematic))

    @cached_property
    def kinematics(self) -> NestedKinematics[Expr]:
        """T and J."""
        return nested_kinematics(self.chain)

    def frame(self, i: int) -> Matrix:
        """DH frame i in the world."""
        return frame_matrix(_product([self.chain.base, *self._rows(0, i)]))

    def transform(self, i: int, j: int) -> Matrix:
        """DH frame j in DH frame i, without base and tool."""
        if i < j:
            return frame_matrix(_product(self._rows(i, j)))
        t = self.transform(j, i)
        # T^-1 = (R^T, -R^T p).
        turned = t[:3, :3].T
        return sympy.ImmutableMatrix(turned.row_join(-turned * t[:3, 3]).col_join(sympy.Matrix([[0, 0, 0, 1]])))

    def _rows(self, i: int, j: int) -> list[Frame[Expr]]:
        """A_{i+1} ... A_j."""
        return [self.chain.row(k, self.robot.convention) for k in range(i + 1, j + 1)]


def _product(frames: Sequence[Frame[S]]) -> Frame[S]:
    """The product of frames from the right, so that it nests outwards."""
    return reduce(lambda inner, frame: frame @ inner, reversed(frames))


@dataclass(frozen=True, slots=True)
class TermCount:
    """A number of terms, as a scalar of the recursions."""

    value: int  # the number; 0 for what is zero

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


def nested_term_counts(robot: Robot) -> NestedKinematics[TermCount]:
    """Numbers of terms of the entries of T and J, without multiplying out."""
    alone = PolynomialDomain(robot, rates=False, offsets=True, sums=lambda group: False)
    return nested_kinematics(build_chain(robot, MappedDomain(alone, lambda p: TermCount(len(p)))))
