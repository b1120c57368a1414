"""Closed-form dynamics of a robot: B, Christoffel symbols, C, g, tau, energies, regressors, as plain SymPy.

The column of a parameter in a regressor is B qdd + C qd + g of the arm on which that parameter is 1 and all others are
0; friction columns are qd_i and sign(qd_i).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

import sympy

from derive.algebra.ring import Polynomial
from derive.errors import QuantityError
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr, Matrix, aligned_latex, columns_matrix
from derive.mechanics.chain import build_chain
from derive.mechanics.exact import Dynamics
from derive.mechanics.regressor import coulomb_column, with_unit_rotors
from derive.model.dynamic_form import MAX_DYNAMIC_TERMS, DynamicForm, RateWriting, friction_torque, times_rate
from derive.model.kinematic_model import KinematicModel
from derive.robot.inertial_parameters import FRICTION_PARTS, Parameter, standard_parameters
from derive.robot.options.style import Grouping, Kinetic

if TYPE_CHECKING:  # what identifies imports NumPy, which nothing else of a model in closed form needs
    from derive.model.identification.base_parameters import BaseSet


@dataclass(frozen=True)
class Energy:
    """Kinetic and potential energy."""

    kinetic: Expr  # T = 1/2 qd^T B qd [J]
    potential: Expr  # U = -sum m g0.p, over links and rotors [J]

    def _repr_latex_(self) -> str:
        kinetic, potential = sympy.latex(self.kinetic), sympy.latex(self.potential)
        return aligned_latex([f"\\mathcal{{T}} = {kinetic}", f"\\mathcal{{U}} = {potential}"])


class DynamicModel(KinematicModel):
    """Closed forms of the dynamics of one robot; arguments and attributes as in `derive.model.model.Model`."""

    def _require_links(self, what: str) -> None:
        if not self.robot.has_dynamics:
            found, allowed = f"{what} of {self.robot.name}", "kinematics only, for the file has no `links`"
            raise QuantityError(found, allowed=allowed, remedy="add `links:` with mass, com and inertia of each link")

    # -- exact layer

    @cached_property
    def dynamics(self) -> Dynamics:
        """Exact B and Christoffel symbols.

        Raises:
            QuantityError: The robot file gives no links.
        """
        self._require_links("dynamics")
        if isinstance(self._alike, DynamicModel):
            return self._alike.dynamics
        return Dynamics(self.robot, self.domain, MAX_DYNAMIC_TERMS)

    @cached_property
    def dynamic_form(self) -> DynamicForm:
        """How dynamics is written."""
        return DynamicForm(self.dynamics, self.form)

    @cached_property
    def christoffel_limit(self) -> int:
        """Longest Christoffel symbol that is written in the user's symbols, see `DynamicForm`."""
        if isinstance(self._alike, DynamicModel):
            return self._alike.christoffel_limit
        n = range(self.n)
        return self.dynamic_form.limit(self.dynamics.christoffel(i, j, k) for i in n for j in n for k in n if j <= k)

    def rate_coefficient(self, quantity: str) -> Callable[[int, int, int], Polynomial] | None:
        """By i, j, k, from 0, the exact coefficient of qd_k in entry (i, j) of a matrix; None for other quantities.

        Args:
            quantity: ``C``, ``N`` or ``Bdot``.
        """
        d = self.dynamics
        return {"C": d.christoffel, "N": d.skew, "Bdot": d.derivative}.get(quantity)

    def terms(self, quantity: str, row: int, column: int = 1) -> int:
        """Number of terms of an entry expanded in the user's symbols, counted without writing it.

        Args:
            quantity: ``B``, ``C``, ``Bdot``, ``N`` or ``g``.
            row: From 1.
            column: From 1.

        Raises:
            QuantityError: No such quantity.
        """
        i, j = row - 1, column - 1
        if quantity == "B":
            return self.dynamics.expanded_size(self.dynamics.inertia_matrix[i][j])
        if quantity == "g":
            return len(self.kinematics.gravity_vector[i])
        coefficient = self.rate_coefficient(quantity)
        if coefficient is None:
            raise QuantityError(f"the size of {quantity!r}", allowed="allowed: B, C, Bdot, N or g")
        return sum(self.dynamics.expanded_size(coefficient(i, j, k)) for k in range(self.n))

    def _require_body(self, i: int) -> None:
        self._require_links("link and rotor Jacobians")
        self._require_index(i, 1, self.robot.n)

    # -- Jacobians of bodies

    def Jv_com(self, i: int) -> Matrix:
        """J_v, 3xn, world frame, of the centre of mass of a link: its velocity is J_v qd (Siciliano et al., 7.1.1).

        Args:
            i: The link, from 1.

        Raises:
            QuantityError: No such link, or the file gives none.
        """
        self._require_body(i)
        return columns_matrix(self.kinematics.linear_columns(self.kinematics.com(i)), write=self.form.kinematic)

    def Jw_com(self, i: int) -> Matrix:
        """J_w, 3xn, world frame, of a link: its angular velocity is J_w qd (Siciliano et al., Robotics, section 7.1.1).

        Args:
            i: The link, from 1.

        Raises:
            QuantityError: No such link, or the file gives none.
        """
        self._require_body(i)
        return columns_matrix(self.kinematics.angular_columns(i), write=self.form.kinematic)

    def Jv_motor(self, i: int) -> Matrix:
        """J_v, 3xn, world frame, of the rotor of a joint: the velocity of its place is J_v qd.

        Args:
            i: The joint, from 1.

        Raises:
            QuantityError: No such joint, or the file gives no links.
        """
        self._require_body(i)
        return columns_matrix(self.kinematics.linear_columns(self.kinematics.motor_place(i)), write=self.form.kinematic)

    def Jw_motor(self, i: int) -> Matrix:
        """J_w, 3xn, world frame, of the rotor of a joint, its spin included: that of link i-1, ratio * z in column i.

        Args:
            i: The joint, from 1.

        Raises:
            QuantityError: No such joint, or the file gives no links.
        """
        self._require_body(i)
        return columns_matrix(self.kinematics.motor_angular_columns(i), write=self.form.kinematic)

    # -- dynamics

    @cached_property
    def energy(self) -> Energy:
        """Kinetic energy 1/2 qd^T B qd and potential energy -sum m g0.p [J]."""
        qd, n, potential = self.qd, range(self.n), self.form.potential(self.kinematics.potential)
        rates = {(i, j): qd[i] ** 2 / 2 if i == j else qd[i] * qd[j] for i in n for j in n if i <= j}
        if self.style.kinetic is Kinetic.BODY:
            pairs = [(self.dynamics.inertia_matrix[i][j], rate) for (i, j), rate in rates.items()]
            if all(self.dynamics.expanded_size(p) <= self.dynamic_form.inertia_limit for p, _ in pairs):
                return Energy(self.dynamic_form.energy([(p, rate) for p, rate in pairs if p]), potential)
        return Energy(sympy.Add(*(self.B[place] * rate for place, rate in rates.items())), potential)

    @cached_property
    def B(self) -> Matrix:
        """Inertia matrix B(q), nxn, symmetric: links, rotors and armatures [kg m^2, kg m, kg].

        B = sum m J_v^T J_v + J_w^T R I R^T J_w over links and rotors (Siciliano et al., Robotics, section 7.1.1).
        """
        return self._inertia(self.dynamic_form)

    def B_link(self, i: int) -> Matrix:
        """The part of B, nxn, that one link contributes, without any rotor.

        Args:
            i: The link, from 1.

        Raises:
            QuantityError: No such link, or the file gives none.
        """
        self._require_body(i)
        return self._inertia(self.dynamic_form.of_part(i, of_rotor=False))

    def _inertia(self, form: DynamicForm) -> Matrix:
        return sympy.ImmutableMatrix(self.n, self.n, lambda i, j: form.inertia(min(i, j), max(i, j)))

    def christoffel(self, i: int, j: int, k: int) -> Expr:
        """c_ijk = c_ikj = 1/2 (db_ij/dq_k + db_ik/dq_j - db_jk/dq_i) (Siciliano et al., Robotics, section 7.2.1).

        Args:
            i: Joint of the torque, from 1.
            j: Joint of one velocity, from 1.
            k: Joint of the other, from 1.

        Raises:
            QuantityError: No such joint, or the file gives no links.
        """
        for index in (i, j, k):
            self._require_index(index, 1, self.n)
        p = self.dynamics.christoffel(i - 1, j - 1, k - 1)
        return self.dynamic_form.entry(p, self.christoffel_limit, self.style.christoffel)

    def christoffel_table(self) -> Mapping[tuple[int, int, int], Expr]:
        """The Christoffel symbols that are not zero, for j <= k (c_ijk = c_ikj); indices from 1."""
        n = range(1, self.n + 1)
        keys = [(i, j, k) for i in n for j in n for k in n if j <= k]
        return MappingProxyType({key: c for key in keys if (c := self.christoffel(*key)) != 0})

    @cached_property
    def C(self) -> Matrix:
        """Coriolis matrix C(q, qd), nxn, by Christoffel symbols: C_ij = sum_k c_ijk qd_k, so that Bdot - 2C is skew.

        Siciliano et al., Robotics, section 7.2.1.
        """
        return self._rate_matrix("C")

    @cached_property
    def B_qdd(self) -> Matrix:
        """B qdd, nx1: the part of the torques that accelerations ask for [N m or N]."""
        b, n, form = self.dynamics.inertia_matrix, range(self.n), self.dynamic_form
        writing = RateWriting(self.style.accelerations, self._in_torques(self.style.inertia), form.inertia_limit)
        return sympy.ImmutableMatrix([form.rate_sum([(b[i][j], self.qdd[j]) for j in n], writing) for i in n])

    @cached_property
    def coriolis_vector(self) -> Matrix:
        """C qd, nx1: Coriolis and centrifugal torques [N m or N]."""
        grouping, form = self._in_torques(self.style.christoffel), self.dynamic_form
        writing = RateWriting(self.style.velocities, grouping, self.christoffel_limit)
        return sympy.ImmutableMatrix([form.rate_sum(self.velocity_pairs(i), writing) for i in range(self.n)])

    @cached_property
    def N(self) -> Matrix:
        """N = Bdot - 2C, nxn, skew-symmetric (Siciliano et al., Robotics, section 7.2.1)."""
        return self._rate_matrix("N")

    @cached_property
    def Bdot(self) -> Matrix:
        """dB/dt, nxn: sum_k dB/dq_k qd_k."""
        return self._rate_matrix("Bdot")

    def _rate_matrix(self, quantity: str) -> Matrix:
        coefficient = self.rate_coefficient(quantity)
        assert coefficient is not None
        n, form = range(self.n), self.dynamic_form
        writing = RateWriting(self.style.coriolis, self.style.christoffel, self.christoffel_limit)
        return sympy.ImmutableMatrix(
            [[form.rate_sum([(coefficient(i, j, k), self.qd[k]) for k in n], writing) for j in n] for i in n]
        )

    @cached_property
    def g(self) -> Matrix:
        """Gravity vector g(q) = dU/dq, nx1 [N m or N] (Siciliano et al., Robotics, section 7.1.3)."""
        self._require_links("gravity vector")
        return sympy.ImmutableMatrix([self.form.gravity(p) for p in self.kinematics.gravity_vector])

    @cached_property
    def friction(self) -> Matrix:
        """Joint friction, nx1 [N m or N]: b*qd + f*sign(qd).

        Where it differs by direction, f_plus*(sign(qd) + sign(qd)**2)/2 + f_minus*(sign(qd) - sign(qd)**2)/2 stands
        for f*sign(qd): f_plus for qd > 0, -f_minus for qd < 0, and 0 at rest.
        """
        self._require_links("friction")
        write = lambda cell: self.form.dynamic(self.domain.constant(cell))  # noqa: E731
        rows = [friction_torque(*pair, write) for pair in zip(self.robot.links, self._rates, strict=True)]
        return sympy.ImmutableMatrix(self._coupling.T * sympy.Matrix(rows) if self.robot.coupled else rows)

    @cached_property
    def _coupling(self) -> Matrix:
        """S of coupled joints, a row for each joint and a column for each variable."""
        return sympy.ImmutableMatrix([[self.form.dynamic(entry) for entry in row] for row in self.domain.coupling])

    @property
    def _rates(self) -> Sequence[Expr]:
        """The velocity of each joint."""
        return list(self._coupling * sympy.Matrix(self.qd)) if self.robot.coupled else self.qd

    @cached_property
    def tau(self) -> Matrix:
        """Joint torques, nx1 [N m or N]: B qdd + C qd + g + friction (Siciliano et al., Robotics, section 7.1.3)."""
        return self.B_qdd + self.coriolis_vector + self.g + self.friction

    def _in_torques(self, grouping: Grouping) -> Grouping:
        """What is grouped first in a coefficient that stands in a torque."""
        return grouping if self.style.torques is Grouping.USUAL else self.style.torques

    def velocity_pairs(self, i: int) -> list[tuple[Polynomial, Expr]]:
        """What C qd consists of: exact c_ijk, and qd_j qd_k of each pair of joints once, with the factor 2.

        Args:
            i: The joint, from 0.
        """
        n, qd, c = range(self.n), self.qd, self.dynamics.christoffel
        return [(c(i, j, k), (1 if j == k else 2) * qd[j] * qd[k]) for j in n for k in n if j <= k]

    # -- regressors and base parameters

    @cached_property
    def standard_set(self) -> tuple[Parameter, ...]:
        """Which the standard parameters are."""
        self._require_links("regressor")
        return standard_parameters(self.robot)

    @cached_property
    def base_set(self) -> BaseSet:
        """Which the base parameters are, and the relations behind them."""
        self._require_links("regressor")
        from derive.model.identification.base_parameters import base_set

        return base_set(self.robot)

    @property
    def standard_parameter_names(self) -> tuple[str, ...]:
        """Names of the standard parameters: ``m1``, ``mx1``, ..., ``Iyz1``, ``mm1``, ``Im1``, ``Ia1``, ..."""
        return tuple(parameter.name for parameter in self.standard_set)

    @property
    def base_parameter_names(self) -> tuple[str, ...]:
        """Names of the base parameters, each that of the parameter which takes the others over."""
        return tuple(parameter.name for parameter in self.base_set.parameters)

    @cached_property
    def standard_parameters(self) -> Matrix:
        """The standard parameters pi, px1, link by link.

        Of each link mass, first moments and inertia about the origin of its DH frame, ten whether the file gives them
        or not; of its joint rotor mass and inertia, armature and friction where the file gives them.
        """
        from derive.model.identification.base_parameters import standard_values

        values = standard_values(self.robot, self.standard_set, self.domain)
        return sympy.ImmutableMatrix([self.form.dynamic(value) for value in values])

    @cached_property
    def base_parameters(self) -> Matrix:
        """The base parameters beta, bx1: as few combinations of the standard parameters as determine the torques.

        Links' parameters are those in joint frames: on the axis of joint i, DH frame i in the modified convention, DH
        frame i before its a_i and alpha_i in the standard one. How the set is found and proven is in
        `derive.model.identification.base_parameters` (Gautier and Khalil 1990; Khalil and Dombre, ch. 9).
        """
        from derive.model.identification.base_parameters import grouped_values

        base = self.base_set
        values = grouped_values(self.robot, base, self.domain)
        moved: dict[Parameter, dict[Expr, Polynomial]] = {parameter: {} for parameter in base.parameters}
        for relation in base.relations:
            assert base.domain is not None, "relations come with their ring"
            write, value = LectureForm(base.domain).kinematic, values[relation.parameter]
            for parameter, factor in relation.terms:
                if factor.numerator.is_constant and factor.denominator.is_constant:
                    values[parameter] = values[parameter] + factor.numerator.constant_term * value
                else:
                    ratio = write(factor.numerator) / write(factor.denominator)
                    moved[parameter][ratio] = moved[parameter].get(ratio, self.domain.ring.zero) + value
        write = self.form.parameter
        rows = ((values[p], *(k * write(v) for k, v in moved[p].items())) for p in base.parameters)
        return sympy.ImmutableMatrix([sympy.Add(write(own), *others) for own, *others in rows])

    @cached_property
    def regressor(self) -> Matrix:
        """Y(q, qd, qdd), nxp, with tau = Y pi for the standard parameters pi (Siciliano et al., section 7.2.2)."""
        return self._regressor(self.standard_set, ends=True)

    @cached_property
    def regressor_base(self) -> Matrix:
        """Y(q, qd, qdd), nxb, with tau = Y beta for the base parameters beta; its columns are independent."""
        return self._regressor(self.base_set.parameters, ends=False)

    def _regressor(self, parameters: Sequence[Parameter], ends: bool) -> Matrix:
        """``ends``: the links' parameters are those in DH frames, else in joint frames."""
        n, columns, write = range(self.n), [], cache(self.form.kinematic)  # many parameters share entries
        from derive.model.identification.unit_dynamics import UnitDynamics

        coupling = self.domain.coupling if self.robot.coupled else ()
        units = UnitDynamics(build_chain(with_unit_rotors(self.robot), self.domain), ends, coupling)
        for parameter in parameters:
            if parameter.part in FRICTION_PARTS:
                joint = parameter.joint - 1
                rate = self._rates[joint]
                own = rate if parameter.part == "b" else coulomb_column(parameter.part, sympy.sign(rate))
                shares = self._coupling.row(joint) if self.robot.coupled else [int(k == joint) for k in n]
                columns.append([own * share for share in shares])
                continue
            gravity = {k: self.form.gravity(p) for k, p in units.gravity(parameter).items()}
            inertia = {key: p for (a, b), p in units.inertia(parameter).items() for key in ((a, b), (b, a))}
            columns.append([sympy.Add(*self._inertial(inertia, k, write), gravity.get(k, sympy.S.Zero)) for k in n])
        return sympy.ImmutableMatrix(self.n, len(columns), lambda i, j: columns[j][i])

    def _inertial(
        self, inertia: Mapping[tuple[int, int], Polynomial], i: int, write: Callable[[Polynomial], Expr]
    ) -> Iterator[Expr]:
        """B_ij qdd_j, and c_ijk qd_j qd_k for every pair of joints once; what is missing in B is zero."""
        n, zero = range(self.n), self.domain.ring.zero

        def _slope(i: int, j: int, k: int) -> Polynomial:
            value = inertia.get((i, j))
            return self.domain.derivative(value, k) if value else zero

        for j in n:
            yield times_rate(write(inertia.get((i, j), zero)), self.qdd[j], self.style.accelerations)
        for j in n:
            for k in range(j, self.n):
                # 2 c_ijk = dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i.
                twice = _slope(i, j, k) + _slope(i, k, j) - _slope(j, k, i)
                if twice:
                    value = twice * Fraction(1, 2) if j == k else twice
                    yield times_rate(write(value), self.qd[j] * self.qd[k], self.style.velocities)
