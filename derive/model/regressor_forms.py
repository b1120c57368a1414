"""Regressors and base parameters in closed form, in the robot's own symbols.

The column of a parameter is B qdd + C qd + g of the arm on which that parameter is 1 and all others are 0; friction
columns are qd_i and sign(qd_i), or one for each sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache, cached_property
from typing import TYPE_CHECKING

import sympy

from derive.algebra.ring import Polynomial
from derive.errors import QuantityError
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr, Matrix
from derive.mechanics.chain import build_chain
from derive.mechanics.regressor import coulomb_column, with_unit_rotors
from derive.model.dynamic_form import times_rate
from derive.model.kinematic_model import KinematicModel
from derive.robot.description import Link
from derive.robot.expression import Expression
from derive.robot.inertial_parameters import FRICTION_PARTS, Parameter, coulomb_parts, standard_parameters

if TYPE_CHECKING:  # what identifies imports NumPy, which nothing else of a model in closed form needs
    from derive.model.identification.base_parameters import BaseSet


def friction_torque(link: Link, rate: Expr, write: Callable[[Expression], Expr]) -> Expr:
    """Friction of a joint [N m or N], its coefficients each written in some way."""
    dry = (write(cell) * coulomb_column(part, sympy.sign(rate)) for part, cell in coulomb_parts(link).items())
    return sympy.Add(write(link.viscous) * rate, *dry)


class IdentifiedModel(KinematicModel):
    """Standard and base parameters of a robot with links, and the regressors that they are multiplied by."""

    def _require_links(self, what: str) -> None:
        if not self.robot.has_dynamics:
            raise QuantityError(
                f"{what} of {self.robot.name}",
                allowed="kinematics only, for the file has no `links`",
                remedy="add `links:` with mass, com and inertia of each link",
            )

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
        from derive.model.identification.parameter_values import standard_values

        values = standard_values(self.robot, self.standard_set, self.domain)
        return sympy.ImmutableMatrix([self.form.dynamic(value) for value in values])

    @cached_property
    def base_parameters(self) -> Matrix:
        """The base parameters beta, bx1: as few combinations of the standard parameters as determine the torques.

        Links' parameters are those in joint frames: on the axis of joint i, DH frame i in the modified convention, DH
        frame i before its a_i and alpha_i in the standard one. How the set is found and proven is in
        `derive.model.identification.base_parameters` (Gautier and Khalil 1990; Khalil and Dombre, ch. 9).
        """
        from derive.model.identification.parameter_values import grouped_values

        base = self.base_set
        values = grouped_values(self.robot, base, self.domain)
        moved: dict[Parameter, dict[Expr, Polynomial]] = {parameter: {} for parameter in base.parameters}
        for relation in base.relations:
            assert base.domain is not None, "relations come with their ring"
            write = LectureForm(base.domain).kinematic
            value = values[relation.parameter]
            for parameter, factor in relation.terms:
                if factor.numerator.is_constant:
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

        units = UnitDynamics(build_chain(with_unit_rotors(self.robot), self.domain), ends=ends)
        for parameter in parameters:
            if parameter.part in FRICTION_PARTS:
                rate = self.qd[parameter.joint - 1]
                own = rate if parameter.part == "b" else coulomb_column(parameter.part, sympy.sign(rate))
                columns.append([own if k == parameter.joint - 1 else sympy.S.Zero for k in n])
                continue
            gravity = [self.form.gravity(p) for p in units.gravity(parameter)]
            gravity += [sympy.S.Zero] * (self.n - len(gravity))
            inertia = {key: p for (a, b), p in units.inertia(parameter).items() for key in ((a, b), (b, a))}
            columns.append([sympy.Add(*self._inertial(inertia, k, write), gravity[k]) for k in n])
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
