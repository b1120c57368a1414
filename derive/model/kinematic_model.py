"""Closed-form kinematics of a robot: frames, orientation angles, Jacobians and their determinants."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import combinations, product
from typing import TYPE_CHECKING, Any, Self

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial, determinant
from derive.errors import QuantityError
from derive.inverse.loops import without_parallelograms
from derive.lecture.form import MOST_SHORT_TERMS, LectureForm, SymbolRoles
from derive.lecture.sympy_conversion import Expr, Matrix, columns_matrix, frame_matrix
from derive.mechanics.exact import Kinematics, Reference, jacobian_columns
from derive.mechanics.vectors import Vector, multiply, transpose
from derive.model.ends import OfEnds, TreeModel, of_each_end, of_each_end_by_joints
from derive.model.long_chain import LongChain
from derive.robot.description import Convention
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.options.inverse import POSE
from derive.robot.options.style import Contraction, Style, choice_named
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows
from derive.robot.tree import require_arm, require_chain, require_own_variables

if TYPE_CHECKING:  # inverse kinematics is forty modules and NumPy, a sixth of the time in which `derive show` prints T
    from derive.inverse.words.reach import Reach
    from derive.inverse.words.solutions import InverseKinematics
    from derive.model.singularities.aspects import Aspects
    from derive.model.singularities.singularities import Singularities

# Attributes of a model that hold FLINT's polynomials or functions, and are not pickled.
MADE_AGAIN = (
    *("domain", "kinematics", "form", "long_chain", "jacobian_columns", "_alike", "_is_of_short_arm"),
    *("dynamics", "dynamic_form", "standard_set", "base_set", "inverse", "workspace", "aspects", "closure"),
)
ITSELF = ("robot", "style", "q", "qd", "qdd", "_view")  # attributes of every model
SHORT_ROOT = 4  # most terms under the roots of the orientation angles that are worth simplifying


class KinematicModel(TreeModel):
    """Closed-form kinematics of one robot; arguments and attributes as in `derive.model.model.Model`."""

    _alike: Self | None = None  # a model of the same robot in another style, whose exact layer this one has, too

    def __init__(
        self, robot: Robot, style: Style | str | Mapping[str, str] | None = None, contraction: str | None = None
    ) -> None:
        self.robot = robot = without_parallelograms(robot)
        chosen = robot.style if style is None else Style.of(style)
        if contraction is not None:
            chosen = replace(chosen, contraction=choice_named(Contraction, contraction))
        self.style = chosen
        self.q = tuple(sympy.Symbol(mover.variable) for mover in robot.variables)
        self.qd = tuple(sympy.Symbol(velocity_name(q.name)) for q in self.q)
        self.qdd = tuple(sympy.Symbol(acceleration_name(q.name)) for q in self.q)

    def __getstate__(self) -> dict[str, Any]:
        """The robot and the closed forms that were derived; SymPy compares nested ones of long arms for hours."""
        is_long = "long_chain" in vars(self) and self._is_long
        named = vars(self).items()
        return {name: value for name, value in named if name in ITSELF or not (is_long or name in MADE_AGAIN)}

    def with_style(self, style: Style) -> Self:
        """The same model written in another style; what does not depend on it is not derived again.

        Args:
            style: How expressions are grouped.
        """
        other = type(self)(self.robot, style)
        if style.contraction is self.style.contraction:
            other._alike = self
        return other

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.robot.name}, {self.n} joints>"

    @property
    def n(self) -> int:
        """Number of joint variables."""
        return self.robot.dof

    # -- exact layer

    @cached_property
    def domain(self) -> PolynomialDomain:
        """The polynomial ring of kinematics, with the user's symbols."""
        if self._alike:
            return self._alike.domain
        return PolynomialDomain(self.robot, contraction=self.style.contraction, rates=False, offsets=True)

    @cached_property
    def kinematics(self) -> Kinematics:
        """Exact frames and Jacobians."""
        return self._alike.kinematics if self._alike else Kinematics(self.robot, self.domain)

    @cached_property
    def form(self) -> LectureForm:
        """How expressions are written."""
        if self._alike:
            return self._alike.form.with_style(self.style)
        return LectureForm(self.domain, SymbolRoles.of(self.robot), self.style, lambda: self._is_of_short_arm)

    @cached_property
    def _is_of_short_arm(self) -> bool:
        end = self.kinematics.end
        entries = [*(entry for row in end.rotation for entry in row), *end.position]
        return not self._is_long and all(len(self.form.terms(entry)) <= MOST_SHORT_TERMS for entry in entries)

    @cached_property
    def long_chain(self) -> LongChain:
        """Which transforms are too long to expand, and how these are written."""
        return LongChain(self.robot)

    @property
    def _is_long(self) -> bool:
        return not self.robot.coupled and self.long_chain.is_long(0, self.n)

    # -- frames

    def A(self, i: int) -> Matrix:
        """A_i, 4x4: DH frame i in DH frame i-1, in a tree in that of the row that it follows.

        Standard: A_i = Rot(z, theta_i) Trans(z, d_i) Trans(x, a_i) Rot(x, alpha_i) (Siciliano et al., Robotics,
        section 2.8.2); modified: Rot(x, alpha_{i-1}) Trans(x, a_{i-1}) Rot(z, theta_i) Trans(z, d_i) (Craig,
        Introduction to Robotics, ch. 3).

        Args:
            i: Row of the table, from 1.

        Raises:
            QuantityError: No such row.
        """
        self._require_index(i, 1, self.robot.n)
        return frame_matrix(self.kinematics.row(i), self.form.kinematic)

    def transform(self, i: int | str, j: int | str) -> Matrix:
        """T_j^i = A_{i+1} ... A_j, 4x4: DH frame j in DH frame i, without base and tool.

        Args:
            i: The reference frame, from 0 to n; in a tree also a row by its name.
            j: The frame, from 0 to n, or a row; before i it is the inverse transform.

        Raises:
            QuantityError: No such frame.
        """
        if self.robot.is_tree:
            return frame_matrix(self.kinematics.between(self._label(i), self._label(j)), self.form.kinematic)
        i, j = self._index(i), self._index(j)
        if self.long_chain.is_long(i, j):
            return self.long_chain.transform(i, j)
        return frame_matrix(self.kinematics.transform(i, j), self.form.kinematic)

    def frame(self, i: int | str) -> Matrix:
        """T_i = base A_1 ... A_i, 4x4: DH frame i in the world.

        Args:
            i: The frame, from 0 to n; in a tree also a row by its name.

        Raises:
            QuantityError: No such frame.
        """
        if self.robot.is_tree:
            return frame_matrix(self.kinematics.placed(self._label(i)), self.form.kinematic)
        i = self._index(i)
        if self.long_chain.is_long(0, i):
            return self.long_chain.frame(i)
        return frame_matrix(self.kinematics.frame(i), self.form.kinematic)

    @cached_property
    @of_each_end
    def T(self) -> Matrix:
        """T = base A_1 ... A_n tool, 4x4: the end effector in the world."""
        if self._is_long:
            return frame_matrix(self.long_chain.kinematics.end)
        return frame_matrix(self.kinematics.end, self.form.kinematic)

    @property
    @of_each_end
    def p(self) -> Matrix:
        """Position of the end effector in the world, 3x1 [m]."""
        return self.T[:3, 3]

    @property
    @of_each_end
    def R(self) -> Matrix:
        """Orientation of the end effector in the world, 3x3."""
        return self.T[:3, :3]

    @cached_property
    @of_each_end
    def rpy(self) -> Matrix:
        """Roll, pitch, yaw, 3x1 [rad]: R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll), pitch in (-pi/2, pi/2).

        Singular where r11 = r21 = 0 (pitch = +-pi/2): only yaw - roll or yaw + roll is then determined. Where that
        holds in every configuration, roll is taken as 0 (Siciliano et al., Robotics, section 2.4.2).
        """
        r = self.R
        if r[0, 0] == 0 and r[1, 0] == 0:
            return sympy.ImmutableMatrix([0, -r[2, 0] * sympy.pi / 2, sympy.atan2(-r[0, 1], r[1, 1])])
        cosine = self._length((2, 1), (2, 2))
        angles = [sympy.atan2(r[2, 1], r[2, 2]), sympy.atan2(-r[2, 0], cosine), sympy.atan2(r[1, 0], r[0, 0])]
        return sympy.ImmutableMatrix(angles)

    @cached_property
    @of_each_end
    def euler_zyz(self) -> Matrix:
        """Euler angles phi, theta, psi, 3x1 [rad]: R = Rot(z, phi) Rot(y, theta) Rot(z, psi), theta in (0, pi).

        Singular where r13 = r23 = 0 (theta = 0 or pi): only phi + psi or phi - psi is then determined. Where that
        holds in every configuration, as for planar arms, psi is taken as 0 (Siciliano et al., Robotics, section
        2.4.1).
        """
        r = self.R
        if r[0, 2] == 0 and r[1, 2] == 0:
            theta = sympy.pi * (1 - r[2, 2]) / 2
            return sympy.ImmutableMatrix([sympy.atan2(r[2, 2] * r[1, 0], r[2, 2] * r[0, 0]), theta, 0])
        sine = self._length((0, 2), (1, 2))
        angles = [sympy.atan2(r[1, 2], r[0, 2]), sympy.atan2(sine, r[2, 2]), sympy.atan2(r[2, 1], -r[2, 0])]
        return sympy.ImmutableMatrix(angles)

    def _length(self, *places: tuple[int, int]) -> Expr:
        """Square root of the sum of squares of two entries of R, simplified where they are short: ``abs(s5)``."""
        plain = sympy.Add(*(self.R[i, j] ** 2 for i, j in places))
        if self._is_long:
            return sympy.sqrt(plain)
        entries = [self.kinematics.end.rotation[i][j] for i, j in places]
        if sum(map(len, entries)) > SHORT_ROOT:
            return sympy.sqrt(plain)
        square = self.form.kinematic(entries[0] * entries[0] + entries[1] * entries[1])
        shorter = min(plain, square, key=lambda e: e.count_ops())
        root = sympy.Mul(*(base ** (exponent / 2) for base, exponent in shorter.as_powers_dict().items()))
        is_square = not shorter.is_number and all(exponent % 2 == 0 for exponent in shorter.as_powers_dict().values())
        return sympy.Abs(root) if is_square else sympy.sqrt(shorter)

    # -- Jacobians

    @cached_property
    @of_each_end_by_joints
    def J(self) -> Matrix:
        """Geometric Jacobian of the end effector, 6xn: (v, omega) = J qd, linear rows first, world frame.

        Column i is (z x (p - o), z) of a revolute joint, (z, 0) of a prismatic one (Siciliano et al., Robotics,
        section 3.1.3).
        """
        if self._is_long:
            return columns_matrix(self.long_chain.kinematics.linear, self.long_chain.kinematics.angular)
        return columns_matrix(*self.jacobian_columns, write=self.form.kinematic)

    @cached_property
    @of_each_end_by_joints
    def J_end(self) -> Matrix:
        """Geometric Jacobian of the end effector, 6xn, linear rows first, in the axes of the end effector.

        It is diag(R^T, R^T) J (Siciliano et al., Robotics, section 3.1).
        """
        if self._is_long:
            turned = sympy.Matrix(self.R).T
            return sympy.ImmutableMatrix(sympy.Matrix.vstack(turned * self.J[:3, :], turned * self.J[3:, :]))
        turned_back = transpose(self.kinematics.end.rotation)
        linear, angular = ([multiply(turned_back, v) for v in columns] for columns in self.jacobian_columns)
        return columns_matrix(linear, angular, self.form.kinematic)

    @cached_property
    def jacobian_columns(self) -> tuple[list[Vector[Polynomial]], list[Vector[Polynomial]]]:
        """Linear and angular columns of J, exact.

        Raises:
            QuantityError: The arm is too long to multiply them out.
        """
        if self._is_long:
            raise QuantityError(f"J of {self.robot.name}, multiplied out", allowed="arms whose T is shorter")
        k = self.kinematics
        return k.linear_columns(k.end.position), k.angular_columns(self.robot.n)

    @cached_property
    @of_each_end_by_joints
    def J_dot(self) -> Matrix:
        """dJ/dt(q, qd), 6xn: rate of change of the geometric Jacobian J, world frame.

        The acceleration of the end effector is J qdd + dJ/dt qd (Siciliano et al., Robotics, section 3.7).
        """
        rates = [self.hessian(k) * qd for k, qd in enumerate(self.qd, 1)]
        return sympy.ImmutableMatrix(sum(rates, sympy.zeros(6, self.n)))

    def hessian(self, k: int) -> Matrix:
        """dJ/dq_k, 6xn: the derivative of the geometric Jacobian by a joint variable, world frame.

        Args:
            k: The joint, from 1.

        Raises:
            QuantityError: No such joint.
        """
        self._require_index(k, 1, self.n)
        if isinstance(every := self.J, OfEnds) and self.robot.passive:  # these move with q_k, too
            return OfEnds(tuple(every), lambda end: self.arm(end)[0].hessian(k))
        if isinstance(every, OfEnds):
            return every.each(lambda matrix: sympy.ImmutableMatrix(matrix.diff(self.q[k - 1])))
        if self._is_long:
            return sympy.ImmutableMatrix(self.J.diff(self.q[k - 1]))
        slope = self.domain.derivative
        return columns_matrix(*self.jacobian_columns, write=lambda entry: self.form.kinematic(slope(entry, k - 1)))

    @of_each_end_by_joints
    def J_analytic(self, kind: str) -> Matrix:
        """Analytic Jacobian, 6xn: rows of velocity in the world frame, then of the rates of orientation angles.

        The matrix that turns angular velocity into rates is written in entries of R, so that no inverse trigonometric
        function occurs (Siciliano et al., Robotics, section 3.6).

        Args:
            kind: ``rpy`` (roll, pitch, yaw) or ``zyz`` (phi, theta, psi).

        Raises:
            QuantityError: Another kind, or angles that are singular in every configuration.
        """
        if kind not in ("rpy", "zyz"):
            raise QuantityError(f"J_analytic of kind {kind!r}", allowed="allowed: rpy or zyz")
        x, y, z = self.R[:, 0 if kind == "rpy" else 2]  # the direction that the second turn tilts
        if x == 0 and y == 0:
            allowed = "allowed: angles that are not singular in every configuration of this arm"
            remedy = f"use {'rpy' if kind == 'zyz' else 'zyz'}, or the geometric Jacobian J"
            raise QuantityError(f"the analytic Jacobian for {kind}", allowed=allowed, remedy=remedy)
        square = x**2 + y**2
        rates = []
        for k in range(self.n):
            wx, wy, wz = self.J[3:, k]
            # omega split about the axis that the second angle tilts and across it (Siciliano et al., section 3.6).
            about = (x * wx + y * wy) / square
            across = (x * wy - y * wx) / sympy.sqrt(square)
            turn = wz - z * about
            rates.append([about, across, turn] if kind == "rpy" else [turn, across, about])
        return sympy.ImmutableMatrix(sympy.Matrix.vstack(sympy.Matrix(self.J[:3, :]), sympy.Matrix(rates).T))

    @of_each_end
    def det_J(self, rows: Sequence[int] | None = None, columns: Sequence[int] | None = None) -> Expr:
        """Determinant of a square block of J, in the lecture form.

        Args:
            rows: Rows of J from 1; by default those that are not zero everywhere if they are as many as the columns,
                such as 1, 2, 6 of an arm of three joints in the plane, else the first of two or three joints.
            columns: Columns of J from 1; default all.

        Raises:
            QuantityError: The block is not square, no rows are named and none are natural, or the arm is too long for
                a closed form.
        """
        require_own_variables(self.robot, "det J")
        columns = tuple(range(1, self.n + 1)) if columns is None else tuple(columns)
        linear, angular = self.jacobian_columns
        entries = [(*v, *w) for v, w in zip(linear, angular, strict=True)]
        if rows is None:
            moving = [row for row in range(1, 7) if any(column[row - 1] for column in entries)]
            rows = moving if len(moving) == len(columns) else range(1, min(len(columns), 6) + 1)
            if len(rows) in (4, 5) and len(moving) > len(rows):
                said = f"det J of {self.robot.name}, which moves in {len(moving)} coordinates by {len(rows)} joints"
                how = "ask for singularities, or for a task such as detJ_rows[1,2,3,6]"
                raise QuantityError(said, allowed="allowed: a determinant of named rows", remedy=how)
        inside = all(1 <= r <= 6 for r in rows) and all(1 <= c <= self.n for c in columns)
        if len(rows) != len(columns) or not inside:
            found = f"rows {list(rows)} and columns {list(columns)} of J"
            remedy = "name a square block, for instance rows 1, 2, 3 and columns 1, 2, 3"
            allowed = f"allowed: as many rows (1 to 6) as columns (1 to {self.n})"
            raise QuantityError(found, allowed=allowed, remedy=remedy)
        return self.form.determinant(determinant([[entries[c - 1][r - 1] for c in columns] for r in rows]))

    @cached_property
    def manipulability(self) -> Expr:
        """w = sqrt(det(J J^T)) of the rows of the task: the root of the sum of the squares of its largest minors.

        |det J| if there are as many rows as joints, sqrt(det(J^T J)) if there are more (Yoshikawa, Manipulability of
        robotic mechanisms, International Journal of Robotics Research 4(2), 1985).
        """
        require_own_variables(self.robot, "the manipulability")
        is_natural, first = self.robot.inverse.task == POSE, int(self.robot.convention is Convention.MODIFIED)
        rows, n, _ = task_rows(self.robot), self.n, self.jacobian_columns  # which refuses long arms
        columns = jacobian_columns(self.kinematics, Reference(first if is_natural else None))
        places = product(combinations(rows, min(len(rows), n)), combinations(columns, min(len(rows), n)))
        blocks = [determinant([[column[row] for column in some] for row in chosen]) for chosen, some in places]
        minors = [self.form.determinant(block) for block in blocks if block]
        if len(minors) < 2:
            return sympy.Abs(sympy.Add(*minors))
        if max(map(len, blocks)) <= 2:  # s^2 + c^2 = 1 may make one square of short ones
            whole = sum((block * block for block in blocks), 0 * blocks[0])
            if len(whole) == 1:
                return sympy.Abs(sympy.powdenest(sympy.sqrt(self.form.determinant(whole)), force=True))
        return sympy.sqrt(sympy.Add(*(m**2 for m in minors)))

    @cached_property
    def singularities(self) -> Singularities:
        """Where J loses rank: the zeros of the determinant of a task in factors, or of all minors.

        With a spherical wrist det J = det J_11 det J_22 about the wrist centre (Siciliano et al., Robotics, section
        3.3).
        """
        require_chain(self.robot, "the singularities")
        from derive.model.singularities.determinant import find_singularities

        return find_singularities(self.robot, self.style)

    @cached_property
    @of_each_end
    def inverse(self) -> InverseKinematics:
        """How the joint variables follow from the pose, every branch, for the task of the robot file."""
        require_arm(self.robot, "the inverse kinematics")
        from derive.inverse.words.solutions import inverse_kinematics

        return inverse_kinematics(self.robot, self.style)

    @cached_property
    def workspace(self) -> Reach:
        """What the arm reaches if no joint has limits, by the square roots of its inverse kinematics."""
        require_chain(self.robot, "the workspace")
        from derive.inverse.words.reach import find_reach

        return find_reach(self.robot, self.style, self.inverse)

    @cached_property
    def aspects(self) -> Aspects:
        """The sets of configurations without a singularity, and whether the arm changes posture within one of them."""
        require_chain(self.robot, "the aspects")
        from derive.inverse.words.solutions import parameter_numbers
        from derive.model.singularities.aspects import find_aspects

        numbers = {str(symbol): float(x) for symbol, x in parameter_numbers(self.robot, random.Random(12)).items()}
        return find_aspects(self.workspace.inverse, self.singularities, numbers)
