"""Closed forms entry by entry: how long an entry is, before it is written.

`Model` writes whole matrices. A sheet prints only what is short, so it asks for the number of terms first, which is
counted on the exact polynomials, and what is too long to print is never converted to SymPy. The names are those of
`Model`; what derivations show on the way is here too: the places of bodies, their parts of B, dB_ij/dq_k, and C, N and
tau as sums of Christoffel symbols times rates.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from itertools import accumulate
from math import prod
from typing import NamedTuple

import sympy

from derive.algebra.ring import Polynomial, TooManyTerms
from derive.lecture.sympy_conversion import Expr, Matrix, expression_to_sympy
from derive.mechanics.vectors import Frame, Vector
from derive.model.dynamic_form import MAX_DYNAMIC_TERMS, DynamicForm, friction_torque
from derive.model.long_chain import NestedKinematics, TermCount, nested_term_counts
from derive.model.model import Model
from derive.robot import tree
from derive.robot.expression import ZERO

Triple = tuple[int, int, int]  # i, j, k of the Christoffel symbol c_ijk, from 1, with j <= k


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
        return all(total <= limit for total in accumulate(self.terms(*place) for place in self.places))

    def part(self, rows: Sequence[int], columns: Sequence[int]) -> Entries:
        """Some rows and columns."""
        return Entries(
            (len(rows), len(columns)),
            lambda i, j: self.terms(rows[i - 1], columns[j - 1]),
            lambda i, j: self.entry(rows[i - 1], columns[j - 1]),
        )


class RateTerm(NamedTuple):
    """A summand of an entry of C or N: sign * c_triple * qd_k."""

    sign: int  # +1 or -1
    triple: Triple  # the Christoffel symbol
    k: int  # the joint whose velocity it is multiplied by, from 1


def _angles(name: str) -> cached_property[Entries]:
    """Angles of the orientation of the end effector, 3x1 [rad]."""
    return cached_property(lambda self: _written((3, 1), lambda: getattr(self.model, name)))


def _rate_matrix(name: str) -> cached_property[Entries]:
    """A matrix that is linear in the velocities, nxn."""

    def _entries(self: ModelEntries) -> Entries:
        n, terms = self.model.n, partial(self.model.terms, name)
        return self._by_inertia(n, terms, lambda i, j: getattr(self.model, name)[i - 1, j - 1])

    return cached_property(_entries)


class ModelEntries:
    """The closed forms of a model, entry by entry; joints, links and frames count from 1 as in `Model`."""

    def __init__(self, model: Model) -> None:
        self.model, self.robot, self._long = model, model.robot, model.long_chain
        self._joints = range(1, model.n + 1)
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

    def between(self, one: str, other: str) -> Entries:
        """The frame of a row of a tree, 4x4, in that of another one, both by their labels, of frame 0 empty."""
        return self._keep(("between", one, other), lambda: self._frame(self.model.kinematics.between(one, other)))

    def begin(self, i: int) -> Entries:
        """The frame, 4x4, in the world in which row i of a tree begins, about z of which it moves (standard)."""
        kinematics = self.model.kinematics
        joint = kinematics.chain.joints[i - 1]
        return self._keep(("begin", i), lambda: self._frame(kinematics.joint_frame(joint.parent + 1) @ joint.fixed))

    @cached_property
    def T(self) -> Entries:
        """T, 4x4: the end effector in the world. Of a long arm only entries that are short enough are derived."""
        if self.robot.coupled or not self._long.is_long(0, self.robot.n):
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
        if not self.robot.coupled and self._long.is_long(0, n):
            columns = zip(self._long_counts.linear, self._long_counts.angular, strict=True)
            counts = [[x.value for x in (*linear, *angular)] for linear, angular in columns]
            axis, write = model.kinematics.axis, model.form.kinematic
            return Entries(
                (6, n),
                lambda i, j: counts[j - 1][i - 1],
                lambda i, j: write(axis(j)[i - 4]) if i > 3 else model.J[i - 1, j - 1],
            )
        kinematics = model.kinematics
        halves = zip(kinematics.linear_columns(kinematics.end.position), kinematics.angular_columns(n), strict=True)
        return self._columns([[*linear, *angular] for linear, angular in halves])

    rpy, euler_zyz = map(_angles, ("rpy", "euler_zyz"))

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
        if of_rotor:
            return self._columns(kinematics.motor_angular_columns(i))
        carrier = tree.way_to(self.robot, tree.labels(self.robot)[i]).joint + 1
        return self._columns(kinematics.angular_columns(carrier))

    def _body_position(self, i: int, of_rotor: bool) -> Vector[Polynomial]:
        kinematics = self.model.kinematics
        return kinematics.motor_place(i) if of_rotor else kinematics.com(i)

    def _keep(self, key: tuple[object, ...], make: Callable[[], Entries]) -> Entries:
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]

    # -- inertia

    @cached_property
    def B(self) -> Entries:
        """Inertia matrix, nxn."""
        return self._inertia(self.model.dynamic_form)

    def inertia_part(self, i: int, of_rotor: bool) -> Entries:
        """The part of B, nxn, of link i without any rotor, or of the rotor of joint i without its armature."""
        return self._inertia(self.model.dynamic_form.of_part(i, of_rotor))

    def _inertia(self, form: DynamicForm) -> Entries:
        dynamics = form.dynamics
        return self._by_inertia(
            self.model.n,
            lambda i, j: dynamics.expanded_size(dynamics.inertia_matrix[i - 1][j - 1]),
            lambda i, j: form.inertia(i - 1, j - 1),
        )

    @cached_property
    def _inertia_is_affordable(self) -> bool:
        """Whether B and all Christoffel symbols stay within the budget of the model."""
        n = range(self.model.n)
        try:
            for i, j, k in ((i, j, k) for i in n for j in n for k in n if j <= k):
                self.model.dynamics.christoffel(i, j, k)
        except TooManyTerms:
            return False
        return True

    def _by_inertia(self, columns: int, terms: Callable[[int, int], int], entry: Callable[[int, int], Expr]) -> Entries:
        """A matrix of n rows that follows from B."""
        shape = (self.model.n, columns)
        return Entries(shape, terms, entry) if self._inertia_is_affordable else _too_long(shape)

    # -- dynamics

    # Coriolis matrix by Christoffel symbols, dB/dt - 2C, and dB/dt
    C, N, Bdot = map(_rate_matrix, ("C", "N", "Bdot"))

    @cached_property
    def g(self) -> Entries:
        """Gravity vector dU/dq, nx1 [N m or N]."""
        return of_polynomials([[p] for p in self.model.kinematics.gravity_vector], self.model.form.gravity)

    @cached_property
    def tau(self) -> Entries:
        """Equations of motion, nx1: B qdd + C qd + g + friction [N m or N]."""
        return self._by_inertia(1, self._torque_terms, lambda i, _: self.model.tau[i - 1])

    def _torque_terms(self, i: int, _: int) -> int:
        joints = self._joints
        inertia = sum(self.B.terms(i, j) for j in joints)
        velocity = sum(self.christoffel(i, j, k).terms(1, 1) for j in joints for k in joints if j <= k)
        if self.robot.coupled:
            return inertia + velocity + self.g.terms(i, 1) + expanded_terms(self.friction(i))
        link = self.robot.links[i - 1]
        return inertia + velocity + self.g.terms(i, 1) + sum(cell != ZERO for cell in (link.viscous, *link.signed))

    @cached_property
    def kinetic(self) -> Entries:
        """Kinetic energy 1/2 qd^T B qd, 1x1 [J], from the entries of B."""
        above = [(i, j) for i, j in self.B.places if i <= j and self.B.terms(i, j)]
        size = sum(self.B.terms(*place) for place in above)
        return Entries((1, 1), lambda _, __: size, lambda _, __: self.model.energy.kinetic)

    @cached_property
    def potential(self) -> Entries:
        """Potential energy, 1x1 [J]."""
        return of_polynomials([[self.model.kinematics.potential]], self.model.form.potential)

    def christoffel(self, i: int, j: int, k: int) -> Entries:
        """c_ijk = 1/2 (dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i), 1x1."""
        find = self.model.dynamics.christoffel
        return self._keep(("christoffel", *_triple(i, j, k)), lambda: self._of_three(find, i, j, k))

    def inertia_derivative(self, i: int, j: int, k: int) -> Entries:
        """dB_ij/dq_k, 1x1."""
        return self._of_three(self.model.dynamics.derivative, i, j, k)

    def _of_three(self, find: Callable[[int, int, int], Polynomial], i: int, j: int, k: int) -> Entries:
        if not self._inertia_is_affordable:
            return _too_long((1, 1))
        model, p = self.model, find(i - 1, j - 1, k - 1)
        size, write, grouping = model.dynamics.expanded_size(p), model.dynamic_form.entry, model.style.christoffel
        return Entries((1, 1), lambda _, __: size, lambda _, __: write(p, model.christoffel_limit, grouping))

    # -- C, N and tau by Christoffel symbols

    @cached_property
    def triples(self) -> tuple[Triple, ...]:
        """The Christoffel symbols that are not zero."""
        n = self._joints
        found = ((i, j, k) for i in n for j in n for k in n if j <= k)
        return tuple(triple for triple in found if self.christoffel(*triple).terms(1, 1))

    def coriolis_sum(self, i: int, j: int) -> tuple[RateTerm, ...]:
        """C_ij = sum_k c_ijk qd_k (Siciliano et al., Robotics, section 7.2.1), without what is zero."""
        return self._nonzero(RateTerm(1, _triple(i, j, k), k) for k in self._joints)

    def skew_sum(self, i: int, j: int) -> tuple[RateTerm, ...]:
        """N_ij = sum_k (c_jik - c_ijk) qd_k, for dB_ij/dq_k = c_ijk + c_jik (ibidem, eq. 7.47)."""
        pairs = ((RateTerm(1, _triple(j, i, k), k), RateTerm(-1, _triple(i, j, k), k)) for k in self._joints)
        return self._nonzero(term for pair in pairs for term in pair)

    def _nonzero(self, terms: Iterable[RateTerm]) -> tuple[RateTerm, ...]:
        known = set(self.triples)
        return tuple(term for term in terms if term.triple in known)

    def rate_value(self, terms: Iterable[RateTerm]) -> Expr:
        """A sum over rates with the Christoffel symbols put in."""
        qd = self.model.qd
        return sympy.Add(*(sign * self.christoffel(*triple).entry(1, 1) * qd[k - 1] for sign, triple, k in terms))

    def torque_value(self, i: int) -> Expr:
        """The equation of motion of joint i [N m or N], not collected: B qdd + c qd qd + g + friction."""
        qd, qdd = self.model.qd, self.model.qdd
        inertia = (self.B.entry(i, j) * qdd[j - 1] for j in self._joints)
        pairs = ((j, k, self.christoffel(i, j, k).entry(1, 1)) for row, j, k in self.triples if row == i)
        velocity = ((1 if j == k else 2) * c * qd[j - 1] * qd[k - 1] for j, k, c in pairs)
        return sympy.Add(*inertia, *velocity, self.g.entry(i, 1), self.friction(i))

    def friction(self, i: int) -> Expr:
        """Friction of joint i [N m or N], as the file gives it: b qd + f sign(qd); S^T of that of coupled joints."""
        if self.robot.coupled:
            return self.model.friction[i - 1]
        return friction_torque(self.robot.links[i - 1], self.model.qd[i - 1], expression_to_sympy)

    def is_skew(self, limit: int) -> bool:
        """Whether the entries of N + N^T, N = dB/dt - 2C, cancel when multiplied out."""
        if not (self.Bdot.is_short(limit) and self.C.is_short(limit)):
            return False
        rate, c = self.Bdot.entry, self.C.entry
        sums = (rate(i, j) + rate(j, i) - 2 * (c(i, j) + c(j, i)) for i, j in self.C.places if i <= j)
        return all(sympy.expand(value) == 0 for value in sums)

    @cached_property
    def base_acceleration(self) -> tuple[Expr, Expr, Expr]:
        """-g_0 in the axes of frame 0: how the Newton-Euler recursion takes gravity as an acceleration of the base."""
        if self.robot.gravity is None:
            return (sympy.S.Zero, sympy.S.Zero, sympy.S.Zero)
        g = [expression_to_sympy(cell) for cell in self.robot.gravity]
        rotation = [[expression_to_sympy(self.robot.base[r][c]) for c in range(3)] for r in range(3)]
        x, y, z = (sympy.Add(*(-rotation[r][c] * g[r] for r in range(3))) for c in range(3))
        return (x, y, z)


def _too_long(shape: tuple[int, int]) -> Entries:
    """A matrix that is not even derived, for it exceeds the budget of the model."""

    def _refuse(_: int, __: int) -> Expr:
        raise TooManyTerms(MAX_DYNAMIC_TERMS)

    return Entries(shape, lambda _, __: MAX_DYNAMIC_TERMS, _refuse)


def _triple(i: int, j: int, k: int) -> Triple:
    return (i, min(j, k), max(j, k))


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
