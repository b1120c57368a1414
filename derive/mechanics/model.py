"""The model of a robot: every quantity in closed form, computed once when asked for, as plain SymPy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.lecture_form import LectureForm, SymbolRoles
from derive.algebra.ring import Polynomial
from derive.algebra.style import Style
from derive.errors import QuantityError
from derive.mechanics.angles import analytic_jacobian, euler_zyz, rpy
from derive.mechanics.determinant import determinant
from derive.mechanics.dynamic_form import DynamicForm
from derive.mechanics.dynamics import Dynamics
from derive.mechanics.kinematics import Kinematics
from derive.mechanics.long_chain import LongChain
from derive.mechanics.parts import gravity_symbols, inertial_symbols, only_link
from derive.mechanics.vectors import Vector, multiply, transpose
from derive.mechanics.writing import columns_matrix, frame_matrix, symmetric_matrix
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot

Expr = Any
Matrix = Any

MAX_DYNAMIC_TERMS = 400_000
"""Budget of one entry of B; beyond it only the generated functions remain."""


@dataclass(frozen=True)
class Energy:
    """Kinetic and potential energy.

    Attributes:
        kinetic: T = 1/2 qd^T B qd [J].
        potential: U = -sum m g0.p, over links and rotors [J].
    """

    kinetic: Expr
    potential: Expr


class Model:
    """Closed forms of one robot.

    Every quantity is an immutable SymPy matrix or an expression in the robot's own symbols, which are plain
    ``sympy.Symbol``s; ``qd1`` and ``qdd1`` are velocity and acceleration of ``q1``.

    Args:
        robot: The robot.
        style: How expressions are grouped: ``compact``, ``by-geometry`` or ``expanded``.

    Attributes:
        robot: The robot.
        style: How expressions are grouped.
        q: Joint variables.
        qd: Their velocities.
        qdd: Their accelerations.
    """

    def __init__(self, robot: Robot, style: Style | str = Style.COMPACT) -> None:
        self.robot = robot
        self.style = Style.named(style)
        variables = [joint.variable for joint in robot.joints]
        self.q = tuple(sympy.Symbol(v) for v in variables)
        self.qd = tuple(sympy.Symbol(velocity_name(v)) for v in variables)
        self.qdd = tuple(sympy.Symbol(acceleration_name(v)) for v in variables)

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.robot.n

    # -- exact layer

    @cached_property
    def domain(self) -> PolynomialDomain:
        """The polynomial ring of kinematics, with the user's symbols."""
        return PolynomialDomain(self.robot, rates=False)

    @cached_property
    def kinematics(self) -> Kinematics:
        """Exact frames and Jacobians."""
        return Kinematics(self.robot, self.domain)

    @cached_property
    def dynamics(self) -> Dynamics:
        """Exact B and Christoffel symbols.

        Raises:
            QuantityError: The robot file gives no links.
        """
        self._require_links("dynamics")
        return Dynamics(self.robot, self.domain, MAX_DYNAMIC_TERMS)

    @cached_property
    def form(self) -> LectureForm:
        """How expressions are written."""
        roles = SymbolRoles(inertial_symbols(self.robot), gravity_symbols(self.robot))
        return LectureForm(self.domain, roles, self.style)

    @cached_property
    def dynamic_form(self) -> DynamicForm:
        """How dynamics is written."""
        return DynamicForm(self.dynamics, self.form)

    def _require_links(self, what: str) -> None:
        if not self.robot.has_dynamics:
            raise QuantityError(
                f"{what} of {self.robot.name}",
                allowed="kinematics only, for the file has no `links`",
                remedy="add `links:` with mass, com and inertia of each link",
            )

    # -- frames

    def A(self, i: int) -> Matrix:
        """A_i, 4x4: DH frame i in DH frame i-1, row i of the table (from 1)."""
        self._require_index(i, 1)
        return frame_matrix(self.kinematics.row(i), self.form.kinematic)

    def transform(self, i: int, j: int) -> Matrix:
        """T_j^i, 4x4: DH frame j in DH frame i, without base and tool; i and j from 0 to n, in either order."""
        self._require_index(i, 0)
        self._require_index(j, 0)
        if self._long.is_long(i, j):
            return self._long.transform(i, j)
        return frame_matrix(self.kinematics.transform(i, j), self.form.kinematic)

    def frame(self, i: int) -> Matrix:
        """T_i, 4x4: DH frame i in the world, base A_1 ... A_i."""
        self._require_index(i, 0)
        if self._long.is_long(0, i):
            return self._long.frame(i)
        return frame_matrix(self.kinematics.frame(i), self.form.kinematic)

    @cached_property
    def T(self) -> Matrix:
        """T, 4x4: the end effector in the world, base A_1 ... A_n tool."""
        if self._long.is_long(0, self.n):
            return self._long.end
        return frame_matrix(self.kinematics.end, self.form.kinematic)

    @property
    def p(self) -> Matrix:
        """Position of the end effector in the world, 3x1 [m]."""
        return self.T[:3, 3]

    @property
    def R(self) -> Matrix:
        """Orientation of the end effector in the world, 3x3."""
        return self.T[:3, :3]

    @cached_property
    def rpy(self) -> Matrix:
        """Roll, pitch, yaw [rad]: R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll), pitch in (-pi/2, pi/2).

        Singular at pitch = +-pi/2, where only the sum or difference of roll and yaw is determined.
        """
        return rpy(self.R)

    @cached_property
    def euler_zyz(self) -> Matrix:
        """Euler angles phi, theta, psi [rad]: R = Rot(z, phi) Rot(y, theta) Rot(z, psi), theta in (0, pi).

        Singular at theta = 0 and pi, where only the sum or difference of phi and psi is determined.
        """
        return euler_zyz(self.R)

    # -- Jacobians

    @cached_property
    def J(self) -> Matrix:
        """Geometric Jacobian of the end effector, 6xn, linear rows first, world frame."""
        if self._long.is_long(0, self.n):
            return self._long.jacobian
        return columns_matrix(*self._jacobian_columns, write=self.form.kinematic)

    @cached_property
    def J_end(self) -> Matrix:
        """Geometric Jacobian of the end effector, 6xn, linear rows first, in the axes of the end effector."""
        if self._long.is_long(0, self.n):
            turned = sympy.Matrix(self.R).T
            return sympy.ImmutableMatrix(sympy.Matrix.vstack(turned * self.J[:3, :], turned * self.J[3:, :]))
        turned_back = transpose(self.kinematics.end.rotation)
        linear, angular = ([multiply(turned_back, v) for v in columns] for columns in self._jacobian_columns)
        return columns_matrix(linear, angular, self.form.kinematic)

    @cached_property
    def _jacobian_columns(self) -> tuple[list[Vector[Polynomial]], list[Vector[Polynomial]]]:
        k = self.kinematics
        return k.linear_columns(k.end.position), k.angular_columns(self.n)

    def det_J(self, rows: Sequence[int] | None = None, columns: Sequence[int] | None = None) -> Expr:
        """Determinant of a square block of J.

        Args:
            rows: Rows of J from 1; default 1 to 3 for three joints, all six for six.
            columns: Columns of J from 1; default all.

        Raises:
            QuantityError: The block is not square, or the arm is too long for a closed form.
        """
        columns = tuple(range(1, self.n + 1)) if columns is None else tuple(columns)
        rows = tuple(range(1, min(len(columns), 6) + 1)) if rows is None else tuple(rows)
        inside = all(1 <= r <= 6 for r in rows) and all(1 <= c <= self.n for c in columns)
        if len(rows) != len(columns) or not inside:
            raise QuantityError(
                f"rows {list(rows)} and columns {list(columns)} of J",
                allowed=f"as many rows (1 to 6) as columns (1 to {self.n})",
                remedy="name a square block, for instance rows 1, 2, 3 and columns 1, 2, 3",
            )
        linear, angular = self._jacobian_columns
        block = [[(*linear[c - 1], *angular[c - 1])[r - 1] for c in columns] for r in rows]
        return self.form.determinant(determinant(block))

    def J_analytic(self, kind: str) -> Matrix:
        """Analytic Jacobian, 6xn: derivative of position and of the angles ``rpy`` or ``zyz``.

        Raises:
            QuantityError: Another kind.
        """
        if kind not in ("rpy", "zyz"):
            raise QuantityError(f"J_analytic of kind {kind!r}", allowed="rpy or zyz")
        return analytic_jacobian(kind, self.R, self.J)

    def Jv_com(self, i: int) -> Matrix:
        """3xn: velocity of the centre of mass of link i (from 1) per rate, world frame."""
        self._require_body(i)
        return columns_matrix(self.kinematics.linear_columns(self.kinematics.com(i)), write=self.form.kinematic)

    def Jw_com(self, i: int) -> Matrix:
        """3xn: angular velocity of link i (from 1) per rate, world frame."""
        self._require_body(i)
        return columns_matrix(self.kinematics.angular_columns(i), write=self.form.kinematic)

    def Jv_motor(self, i: int) -> Matrix:
        """3xn: velocity of the rotor of joint i (from 1) per rate, world frame."""
        self._require_body(i)
        return columns_matrix(self.kinematics.linear_columns(self.kinematics.motor_place(i)), write=self.form.kinematic)

    def Jw_motor(self, i: int) -> Matrix:
        """3xn: angular velocity of the rotor of joint i (from 1) per rate, its spin included, world frame."""
        self._require_body(i)
        return columns_matrix(self.kinematics.motor_angular_columns(i), write=self.form.kinematic)

    # -- dynamics

    @cached_property
    def energy(self) -> Energy:
        """Kinetic and potential energy."""
        return Energy(self._kinetic(), self._potential())

    def _kinetic(self) -> Expr:
        b, n = self.B, self.n
        squares = [b[i, i] * self.qd[i] ** 2 / 2 for i in range(n)]
        products = [b[i, j] * self.qd[i] * self.qd[j] for i in range(n) for j in range(i + 1, n)]
        return sympy.Add(*squares, *products)

    def _potential(self) -> Expr:
        self._require_links("potential energy")
        return self.form.dynamic(self.kinematics.potential)

    @cached_property
    def B(self) -> Matrix:
        """Inertia matrix B(q), nxn, links, rotors and armatures [kg m^2, kg m, kg]."""
        return self._inertia(self.dynamics, self.dynamic_form)

    def B_link(self, i: int) -> Matrix:
        """The part of B that link i (from 1) contributes, without any rotor."""
        self._require_body(i)
        alone = Dynamics(only_link(self.robot, i), self.domain, MAX_DYNAMIC_TERMS)
        return self._inertia(alone, DynamicForm(alone, self.form))

    def _inertia(self, dynamics: Dynamics, form: DynamicForm) -> Matrix:
        b, n = dynamics.inertia_matrix, self.n
        return symmetric_matrix(n, form.matrix_entries([b[i][j] for i in range(n) for j in range(i, n)]))

    def christoffel(self, i: int, j: int, k: int) -> Expr:
        """c_ijk = 1/2 (db_ij/dq_k + db_ik/dq_j - db_jk/dq_i); indices from 1."""
        for index in (i, j, k):
            self._require_index(index, 1)
        p = self.dynamics.christoffel(i - 1, j - 1, k - 1)
        return self.dynamic_form.entry(p, self._christoffel_limit)

    def christoffel_table(self) -> Mapping[tuple[int, int, int], Expr]:
        """The Christoffel symbols that are not zero, for j <= k (c_ijk = c_ikj); indices from 1."""
        n = range(1, self.n + 1)
        keys = [(i, j, k) for i in n for j in n for k in n if j <= k]
        found = {(i, j, k): self.dynamics.christoffel(i - 1, j - 1, k - 1) for i, j, k in keys}
        return MappingProxyType({key: self.christoffel(*key) for key, p in found.items() if p})

    @cached_property
    def C(self) -> Matrix:
        """Coriolis matrix C(q, qd), nxn, by Christoffel symbols: C_ij = sum_k c_ijk qd_k."""
        return self._rate_matrix(self.dynamics.christoffel)

    @cached_property
    def N(self) -> Matrix:
        """N = Bdot - 2C, nxn, skew-symmetric."""
        return self._rate_matrix(self.dynamics.skew)

    @cached_property
    def Bdot(self) -> Matrix:
        """dB/dt, nxn: sum_k dB/dq_k qd_k."""
        return self._rate_matrix(self.dynamics.derivative)

    @cached_property
    def g(self) -> Matrix:
        """Gravity vector g(q) = dU/dq, nx1 [N m or N]."""
        self._require_links("gravity vector")
        return sympy.ImmutableMatrix([self.form.gravity(p) for p in self.kinematics.gravity_vector])

    @cached_property
    def friction(self) -> Matrix:
        """Joint friction, nx1: b*qd + f*sign(qd)."""
        self._require_links("friction")
        constant = self.domain.constant
        return sympy.ImmutableMatrix(
            [
                self.form.dynamic(constant(link.viscous)) * rate
                + self.form.dynamic(constant(link.coulomb)) * sympy.sign(rate)
                for link, rate in zip(self.robot.links, self.qd, strict=True)
            ]
        )

    @cached_property
    def tau(self) -> Matrix:
        """Joint torques, nx1: B qdd + C qd + g + friction [N m or N]."""
        rows = [self._inertial_torque(i) + self._velocity_torque(i) for i in range(self.n)]
        return sympy.ImmutableMatrix([r + self.g[i] + self.friction[i] for i, r in enumerate(rows)])

    def _inertial_torque(self, i: int) -> Expr:
        return sympy.Add(*(self.B[i, j] * self.qdd[j] for j in range(self.n)))

    def _velocity_torque(self, i: int) -> Expr:
        """sum_jk c_ijk qd_j qd_k, each pair once."""
        terms = []
        for j in range(self.n):
            for k in range(j, self.n):
                rates = (1 if j == k else 2) * self.qd[j] * self.qd[k]
                terms.append(self.christoffel(i + 1, j + 1, k + 1) * rates)
        return sympy.Add(*terms)

    # -- sizes, identities

    def terms(self, quantity: str, row: int, column: int = 1) -> int:
        """Number of terms of an entry of B, C, Bdot, N or g expanded in the user's symbols; indices from 1.

        It is counted on the exact polynomial, without writing it.

        Raises:
            QuantityError: No such quantity.
        """
        i, j = row - 1, column - 1
        if quantity == "B":
            return self.dynamics.expanded_size(self.dynamics.inertia_matrix[i][j])
        if quantity == "g":
            return len(self.kinematics.gravity_vector[i])
        coefficient = self._rate_coefficients.get(quantity)
        if coefficient is None:
            raise QuantityError(f"the size of {quantity!r}", allowed="B, C, Bdot, N or g")
        return sum(self.dynamics.expanded_size(coefficient(i, j, k)) for k in range(self.n))

    @property
    def _rate_coefficients(self) -> dict[str, Callable[[int, int, int], Polynomial]]:
        d = self.dynamics
        return {"C": d.christoffel, "N": d.skew, "Bdot": d.derivative}

    def quantity(self, name: str) -> Expr:
        """A quantity by its name as `derive show` takes it, for instance ``T[1,4]`` or ``christoffel[1,1,2]``.

        Raises:
            QuantityError: No such quantity or entry.
        """
        from derive.mechanics.quantities import evaluate

        return evaluate(self, name)

    def equal(self, quantity: str, expression: object) -> bool:
        """Whether an expression equals a scalar quantity identically.

        Args:
            quantity: A scalar quantity such as ``T[1,4]``.
            expression: Text in the notation of lecture notes (c12, qd1, ...) or a SymPy expression.

        Raises:
            QuantityError: No such quantity.
            CheckError: The expression cannot be read.
        """
        from derive.mechanics.equality import equal

        return equal(self, quantity, expression)

    # -- writing

    @cached_property
    def _long(self) -> LongChain:
        return LongChain(self.robot)

    @cached_property
    def _christoffel_limit(self) -> int:
        n = range(self.n)
        return self.dynamic_form.limit(self.dynamics.christoffel(i, j, k) for i in n for j in n for k in n if j <= k)

    def _rate_matrix(self, coefficient: Callable[[int, int, int], Polynomial]) -> Matrix:
        n = range(self.n)
        limit = self._christoffel_limit
        form = self.dynamic_form
        return sympy.ImmutableMatrix(
            [[form.rate_sum([(coefficient(i, j, k), self.qd[k]) for k in n], limit) for j in n] for i in n]
        )

    # -- arguments

    def _require_index(self, i: int, first: int) -> None:
        if not first <= i <= self.n:
            raise QuantityError(f"index {i}", allowed=f"{first} to {self.n} for {self.robot.name}")

    def _require_body(self, i: int) -> None:
        self._require_links("link and rotor Jacobians")
        self._require_index(i, 1)
