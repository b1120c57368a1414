"""Closed-form dynamics entry by entry, and C, N and tau as sums of Christoffel symbols times rates."""

from collections.abc import Callable, Iterable
from functools import cached_property, partial
from typing import NamedTuple

import sympy

from derive.algebra.ring import Polynomial, TooManyTerms
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.model.dynamic_form import MAX_DYNAMIC_TERMS, DynamicForm
from derive.model.entries import Entries, KinematicEntries, of_polynomials
from derive.model.regressor_forms import friction_torque
from derive.robot.expression import ZERO

Triple = tuple[int, int, int]  # i, j, k of the Christoffel symbol c_ijk, from 1, with j <= k


class RateTerm(NamedTuple):
    """A summand of an entry of C or N: sign * c_triple * qd_k."""

    sign: int  # +1 or -1
    triple: Triple  # the Christoffel symbol
    k: int  # the joint whose velocity it is multiplied by, from 1


class ModelEntries(KinematicEntries):
    """The closed forms of a model, entry by entry; joints, links and frames count from 1 as in `Model`."""

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
            self.robot.n,
            lambda i, j: dynamics.expanded_size(dynamics.inertia_matrix[i - 1][j - 1]),
            lambda i, j: form.inertia(i - 1, j - 1),
        )

    @cached_property
    def _inertia_is_affordable(self) -> bool:
        """Whether B and all Christoffel symbols stay within the budget of the model."""
        n = range(self.robot.n)
        try:
            for i, j, k in ((i, j, k) for i in n for j in n for k in n if j <= k):
                self.model.dynamics.christoffel(i, j, k)
        except TooManyTerms:
            return False
        return True

    def _by_inertia(self, columns: int, terms: Callable[[int, int], int], entry: Callable[[int, int], Expr]) -> Entries:
        """A matrix of n rows that follows from B."""
        shape = (self.robot.n, columns)
        return Entries(shape, terms, entry) if self._inertia_is_affordable else _too_long(shape)

    # -- dynamics

    @cached_property
    def C(self) -> Entries:
        """Coriolis matrix, nxn, by Christoffel symbols."""
        return self._rate_matrix("C")

    @cached_property
    def N(self) -> Entries:
        """N = dB/dt - 2C, nxn."""
        return self._rate_matrix("N")

    @cached_property
    def Bdot(self) -> Entries:
        """dB/dt, nxn."""
        return self._rate_matrix("Bdot")

    def _rate_matrix(self, name: str) -> Entries:
        model = self.model
        return self._by_inertia(
            self.robot.n, partial(model.terms, name), lambda i, j: getattr(model, name)[i - 1, j - 1]
        )

    @cached_property
    def g(self) -> Entries:
        """Gravity vector dU/dq, nx1 [N m or N]."""
        return of_polynomials([[p] for p in self.model.kinematics.gravity_vector], self.model.form.gravity)

    @cached_property
    def tau(self) -> Entries:
        """Equations of motion, nx1: B qdd + C qd + g + friction [N m or N]."""
        return self._by_inertia(1, self._torque_terms, lambda i, _: self.model.tau[i - 1])

    def _torque_terms(self, i: int, _: int) -> int:
        joints, link = self._joints, self.robot.links[i - 1]
        inertia = sum(self.B.terms(i, j) for j in joints)
        velocity = sum(self.christoffel(i, j, k).terms(1, 1) for j in joints for k in joints if j <= k)
        friction = sum(cell != ZERO for cell in (link.viscous, *link.signed))
        return inertia + velocity + self.g.terms(i, 1) + friction

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

    @property
    def _joints(self) -> range:
        return range(1, self.robot.n + 1)

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
        velocity = (
            (1 if j == k else 2) * self.christoffel(i, j, k).entry(1, 1) * qd[j - 1] * qd[k - 1]
            for row, j, k in self.triples
            if row == i
        )
        return sympy.Add(*inertia, *velocity, self.g.entry(i, 1), self.friction(i))

    def friction(self, i: int) -> Expr:
        """Friction of joint i [N m or N], as the file gives it: b qd + f sign(qd)."""
        link, rate = self.robot.links[i - 1], self.model.qd[i - 1]
        return friction_torque(link, rate, expression_to_sympy)

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
