"""Kinematics of arms whose expanded polynomials would be too long: SymPy expressions nested from the base outwards."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import TooManyTerms
from derive.algebra.sympy_domain import SymPyDomain
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.kinematics import Kinematics
from derive.mechanics.nested import NestedKinematics, nested_kinematics, product
from derive.mechanics.vectors import Frame
from derive.mechanics.writing import columns_matrix, frame_matrix
from derive.robot.robot import Convention, Robot

Expr = Any
Matrix = Any

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
    def end(self) -> Matrix:
        """The end effector in the world, 4x4."""
        return frame_matrix(self.kinematics.end)

    @property
    def jacobian(self) -> Matrix:
        """J, 6xn, world frame."""
        return columns_matrix(self.kinematics.linear, self.kinematics.angular)

    def frame(self, i: int) -> Matrix:
        """DH frame i in the world, 4x4."""
        return frame_matrix(product([self.chain.base, *(self._row(k) for k in range(1, i + 1))]))

    def transform(self, i: int, j: int) -> Matrix:
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
