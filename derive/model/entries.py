"""Closed forms entry by entry: how long an entry is, before it is written.

`Model` writes whole matrices. A sheet prints only what is short, so it asks for the number of terms first, which is
counted on the exact polynomials, and what is too long to print is never converted to SymPy. The names are those of
`Model`; what derivations show on the way to B is here too: the places of bodies, their parts of B, dB_ij/dq_k.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import prod

import sympy

from derive.algebra.ring import Polynomial
from derive.lecture.sympy_conversion import Expr, Matrix
from derive.mechanics.vectors import Frame, Vector
from derive.model.long_chain import NestedKinematics, TermCount, nested_term_counts
from derive.model.model import Model


@dataclass(frozen=True, slots=True)
class Entries:
    """A matrix whose entries are counted first and written one by one; vectors are columns, scalars 1x1."""

    shape: tuple[int, int]  # rows and columns
    terms: Callable[[int, int], int]  # (row, column), from 1 -> number of terms multiplied out; 0 if it is zero
    entry: Callable[[int, int], Expr]  # (row, column), from 1 -> the entry as a SymPy expression

    @property
    def places(self) -> list[tuple[int, int]]:
        """(row, column) of all entries, row by row, from 1."""
        return [(i, j) for i in range(1, self.shape[0] + 1) for j in range(1, self.shape[1] + 1)]

    def is_short(self, limit: int) -> bool:
        """Whether all entries together have at most so many terms; a long matrix is not counted to its end."""
        total = 0
        for place in self.places:
            total += self.terms(*place)
            if total > limit:
                return False
        return True

    def part(self, rows: Sequence[int], columns: Sequence[int]) -> Entries:
        """Some rows and columns."""
        return Entries(
            (len(rows), len(columns)),
            lambda i, j: self.terms(rows[i - 1], columns[j - 1]),
            lambda i, j: self.entry(rows[i - 1], columns[j - 1]),
        )


class KinematicEntries:
    """Closed-form kinematics of a model, entry by entry; joints, links and frames count from 1 as in `Model`."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.robot = model.robot
        self._long = model.long_chain
        self._kept: dict[tuple[object, ...], Entries] = {}

    # -- kinematics

    def A(self, i: int) -> Entries:
        """A_i, 4x4: DH frame i in DH frame i-1."""
        return self._keep(("A", i), lambda: _written((4, 4), lambda: self.model.A(i)))

    def transform(self, i: int, j: int) -> Entries:
        """T_j^i, 4x4: DH frame j in DH frame i, without base and tool."""
        if self._long.is_long(i, j):
            return self._keep(("T", i, j), lambda: _written((4, 4), lambda: self.model.transform(i, j)))
        return self._keep(("T", i, j), lambda: self._frame(self.model.kinematics.transform(i, j)))

    def frame(self, i: int) -> Entries:
        """T_i, 4x4: DH frame i in the world, base included."""
        if self._long.is_long(0, i):
            return self._keep(("frame", i), lambda: _written((4, 4), lambda: self.model.frame(i)))
        return self._keep(("frame", i), lambda: self._frame(self.model.kinematics.frame(i)))

    @cached_property
    def T(self) -> Entries:
        """T, 4x4: the end effector in the world. Of a long arm only entries that are short enough are derived."""
        if not self._long.is_long(0, self.robot.n):
            return self._frame(self.model.kinematics.end)
        end = self._long_counts.end
        counts = [[x.value for x in (*end.rotation[i], end.position[i])] for i in range(3)] + [[0, 0, 0, 1]]
        bottom = (sympy.S.Zero, sympy.S.Zero, sympy.S.Zero, sympy.S.One)
        return Entries(
            (4, 4),
            lambda i, j: counts[i - 1][j - 1],
            lambda i, j: bottom[j - 1] if i == 4 else self.model.T[i - 1, j - 1],
        )

    @cached_property
    def J(self) -> Entries:
        """Geometric Jacobian, 6xn, world frame. Of a long arm the lower rows, axes of the first joints, are short."""
        n, model = self.robot.n, self.model
        if self._long.is_long(0, n):
            counts = [
                [x.value for x in (*linear, *angular)]
                for linear, angular in zip(self._long_counts.linear, self._long_counts.angular, strict=True)
            ]

            axis, write = model.kinematics.axis, model.form.kinematic
            return Entries(
                (6, n),
                lambda i, j: counts[j - 1][i - 1],
                lambda i, j: write(axis(j)[i - 4]) if i > 3 else model.J[i - 1, j - 1],
            )
        kinematics = model.kinematics
        halves = zip(kinematics.linear_columns(kinematics.end.position), kinematics.angular_columns(n), strict=True)
        return self._columns([[*linear, *angular] for linear, angular in halves])

    @cached_property
    def rpy(self) -> Entries:
        """Roll, pitch and yaw, 3x1 [rad]."""
        return _written((3, 1), lambda: self.model.rpy)

    @cached_property
    def euler_zyz(self) -> Entries:
        """Euler angles ZYZ, 3x1 [rad]."""
        return _written((3, 1), lambda: self.model.euler_zyz)

    @cached_property
    def _long_counts(self) -> NestedKinematics[TermCount]:
        return nested_term_counts(self.robot)

    def _frame(self, frame: Frame[Polynomial]) -> Entries:
        number = self.model.domain.number
        rows = [[*frame.rotation[i], frame.position[i]] for i in range(3)]
        return of_polynomials([*rows, [number(k // 3) for k in range(4)]], self.model.form.kinematic)

    def _columns(self, columns: Sequence[Sequence[Polynomial]]) -> Entries:
        return of_polynomials(list(zip(*columns, strict=True)), self.model.form.kinematic)

    # -- links and rotors

    def body_position(self, i: int, of_rotor: bool) -> Entries:
        """Where the centre of mass of link i is, or the rotor of joint i, 3x1 [m], world frame."""
        return self._columns([self._body_position(i, of_rotor)])

    def linear_jacobian(self, i: int, of_rotor: bool) -> Entries:
        """J_v of link i or of the rotor of joint i, 3xn: velocity of its centre of mass per rate, world frame."""
        return self._columns(self.model.kinematics.linear_columns(self._body_position(i, of_rotor)))

    def angular_jacobian(self, i: int, of_rotor: bool) -> Entries:
        """J_w of link i or of the rotor of joint i, its spin included, 3xn: angular velocity per rate, world frame."""
        kinematics = self.model.kinematics
        return self._columns(kinematics.motor_angular_columns(i) if of_rotor else kinematics.angular_columns(i))

    def _body_position(self, i: int, of_rotor: bool) -> Vector[Polynomial]:
        kinematics = self.model.kinematics
        return kinematics.motor_place(i) if of_rotor else kinematics.com(i)

    def _keep(self, key: tuple[object, ...], make: Callable[[], Entries]) -> Entries:
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]


def of_matrix(matrix: Matrix) -> Entries:
    """Entries of a matrix that is already there."""
    return _written(matrix.shape, lambda: matrix)


def _written(shape: tuple[int, int], make: Callable[[], Matrix]) -> Entries:
    """Entries of a matrix that is made as a whole, on first use, and counted before terms meet."""
    matrix = cache(make)
    return Entries(shape, lambda i, j: expanded_terms(matrix()[i - 1, j - 1]), lambda i, j: matrix()[i - 1, j - 1])


def expanded_terms(expression: Expr, known: dict[Expr, int] | None = None) -> int:
    """Number of terms of a nested expression when multiplied out, before terms meet; that of parts may be known."""
    known = {} if known is None else known
    if not expression.args:
        return int(expression != 0)
    if expression not in known:
        if expression.is_Add:
            known[expression] = sum(expanded_terms(term, known) for term in expression.args)
        elif expression.is_Mul:
            known[expression] = prod(expanded_terms(factor, known) for factor in expression.args)
        elif expression.is_Pow and expression.exp.is_Integer and expression.exp > 0:
            known[expression] = expanded_terms(expression.base, known) ** int(expression.exp)
        else:
            known[expression] = 1
    return known[expression]


def of_polynomials(rows: Sequence[Sequence[Polynomial]], write: Callable[[Polynomial], Expr]) -> Entries:
    """Entries that are polynomials already."""
    return Entries(
        (len(rows), len(rows[0])), lambda i, j: len(rows[i - 1][j - 1]), lambda i, j: write(rows[i - 1][j - 1])
    )
