"""The closed forms of a model as the emitters ask for them: by name, entry by entry, sizes before expressions.

Quantities of single bodies, by name: Jacobians, places and parts of B of link i or of the rotor of joint i.

The singularities of a model as the emitters ask for them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import sympy

from derive.algebra.ring import Polynomial, TooManyTerms
from derive.handout.quantity import Quantity, SingularBlock, SingularFactor, SingularityQuantity
from derive.mechanics.vectors import Frame, Vector
from derive.model.dynamic_form import DynamicForm
from derive.model.dynamic_model import MAX_DYNAMIC_TERMS
from derive.model.dynamics import Dynamics
from derive.model.long_chain import LongChain, NestedKinematics, TermCount, nested_term_counts
from derive.model.matrices import only_link, only_rotor
from derive.model.model import Model
from derive.model.singularities import singularities
from derive.robot.expression import ZERO
from derive.robot.robot import Robot

BODY = re.compile(r"((?:Jv|Jw|p)_(?:com|motor)|B_link|B_motor)\[([0-9]+)\]")
"""Names of these quantities: ``Jv_com[2]``, ``p_motor[1]``, ``B_link[3]``."""


class Entries(NamedTuple):
    """A matrix whose entries are counted first and written one by one.

    Attributes:
        shape: Rows and columns.
        size: Number of terms of an entry when multiplied out; indices from 1.
        write: The expression of an entry.
    """

    shape: tuple[int, int]
    size: Callable[[int, int], int]
    write: Callable[[int, int], Any]


def body_quantity(model: Model, kind: str, i: int) -> Entries:
    """The quantity of link i, or of the rotor of joint i, from 1.

    Args:
        model: The closed forms.
        kind: ``Jv_com``, ``Jw_com``, ``Jv_motor``, ``Jw_motor`` (3xn, per rate, world frame), ``p_com``, ``p_motor``
            (3x1, place in the world) or ``B_link``, ``B_motor`` (nxn, the body's part of the inertia matrix).
        i: The link or joint.
    """
    k = model.kinematics
    match kind:
        case "Jv_com":
            return _columns(model, k.linear_columns(k.com(i)))
        case "Jw_com":
            return _columns(model, k.angular_columns(i))
        case "Jv_motor":
            return _columns(model, k.linear_columns(k.motor_place(i)))
        case "Jw_motor":
            return _columns(model, k.motor_angular_columns(i))
        case "p_com":
            return _columns(model, [k.com(i)])
        case "p_motor":
            return _columns(model, [k.motor_place(i)])
    part = only_link(model.robot, i) if kind == "B_link" else only_rotor(model.robot, i)
    return _InertiaPart(model, part).entries


def derivative_quantity(model: Model, i: int, j: int, k: int) -> Entries:
    """dB_ij/dq_k, 1x1; indices from 1."""
    p, form = model.dynamics.derivative(i - 1, j - 1, k - 1), model.dynamic_form
    size = model.dynamics.expanded_size(p)
    return Entries((1, 1), lambda row, column: size, lambda row, column: form.entry(p, model.christoffel_limit))


def _columns(model: Model, columns: Sequence[Vector[Polynomial]]) -> Entries:
    return Entries(
        (3, len(columns)),
        lambda row, column: len(columns[column - 1][row - 1]),
        lambda row, column: model.form.kinematic(columns[column - 1][row - 1]),
    )


class _InertiaPart:
    """B of a robot in which one body alone has mass."""

    def __init__(self, model: Model, alone: Robot) -> None:
        self._dynamics = Dynamics(alone, model.domain, MAX_DYNAMIC_TERMS)
        self._form = DynamicForm(self._dynamics, model.form)
        self._n = alone.n

    @property
    def entries(self) -> Entries:
        size = self._dynamics.expanded_size
        return Entries(
            (self._n, self._n),
            lambda i, j: size(self._matrix[i - 1][j - 1]),
            lambda i, j: self._form.entry(self._matrix[i - 1][j - 1], self._limit),
        )

    @cached_property
    def _matrix(self) -> list[list[Polynomial]]:
        return self._dynamics.inertia_matrix

    @cached_property
    def _limit(self) -> int:
        return self._form.limit(self._matrix[i][j] for i in range(self._n) for j in range(i + 1))


AsQuantity = Callable[[Any], Quantity]


def singularity_quantity(model: Model, as_quantity: AsQuantity, count: Callable[[Any], int]) -> SingularityQuantity:
    """Plain data of ``model.singularities``.

    Args:
        model: The model.
        as_quantity: Makes a quantity of a matrix.
        count: Counts the terms of an expression.
    """
    found = model.singularities
    return SingularityQuantity(
        outcome=found.outcome.value,
        blocks=tuple(_block(block, as_quantity) for block in found.blocks),
        factors=tuple(_factor(factor, count) for factor in found.factors),
        determinant=found.determinant,
        budget=singularities.MAX_TERMS,
    )


def _block(block: singularities.Block, as_quantity: AsQuantity) -> SingularBlock:
    reference = block.reference
    matrix = as_quantity(block.matrix)
    return SingularBlock(block.name, block.rows, reference.frame, reference.point, block.others_are_zero, matrix)


def _factor(factor: singularities.SingularFactor, count: Callable[[Any], int]) -> SingularFactor:
    condition = factor.condition
    return SingularFactor(
        expression=factor.expression,
        exponent=factor.exponent,
        terms=count(factor.expression),
        moving=condition is not None,
        variable=condition.variable if condition else None,
        values=condition.values if condition else (),
        posture=condition.posture.value if condition and condition.posture else "",
    )


_INDEXED = re.compile(r"(A|T|frame|christoffel|dB)\[([0-9,]+)\]")
_BY_INERTIA = ("B", "C", "N", "tau", "christoffel", "dB")


@dataclass(frozen=True)
class Written:
    """A quantity whose expressions are made as a whole, on first use."""

    shape: tuple[int, int]
    make: Callable[[], Any]

    @cached_property
    def _matrix(self) -> Any:
        return self.make()

    def terms(self, row: int, column: int) -> int:
        """Number of terms when multiplied out, before terms meet."""
        return expanded_terms(self._matrix[row - 1, column - 1])

    def entry(self, row: int, column: int) -> Any:
        """The expression."""
        return self._matrix[row - 1, column - 1]


@dataclass(frozen=True)
class Counted:
    """A quantity whose entries are counted on the exact polynomials and written one by one."""

    shape: tuple[int, int]
    count: Callable[[int, int], int]
    write: Callable[[int, int], Any]

    def terms(self, row: int, column: int) -> int:
        """Number of terms when multiplied out."""
        return self.count(row, column)

    def entry(self, row: int, column: int) -> Any:
        """The expression."""
        return self.write(row, column)


@dataclass(frozen=True)
class TooLong:
    """A quantity that is not even derived: it has more terms than the budget of the model."""

    shape: tuple[int, int]

    def terms(self, row: int, column: int) -> int:
        """The budget, which the true number exceeds."""
        return MAX_DYNAMIC_TERMS

    def entry(self, row: int, column: int) -> Any:
        """Nothing can be written.

        Raises:
            TooManyTerms: Always.
        """
        raise TooManyTerms(MAX_DYNAMIC_TERMS)


class ModelQuantities(Mapping[str, Quantity]):
    """All quantities of a model by name.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.model = Model(robot)
        self._long = LongChain(robot)
        self._sizes: dict[tuple[int, int, int], int] = {}
        self._found: dict[str, Quantity] = {}

    def __getitem__(self, name: str) -> Quantity:
        if name not in self._found:
            self._found[name] = self._make(name)
        return self._found[name]

    def __iter__(self) -> Iterator[str]:
        dynamic = ("B", "C", "N", "g", "tau", "potential") if self.robot.has_dynamics else ()
        return iter((*(f"A[{i}]" for i in range(1, self.robot.n + 1)), "T", "J", *dynamic))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _make(self, name: str) -> Quantity:
        match = _INDEXED.fullmatch(name)
        if name.startswith(_BY_INERTIA) and not self._inertia_is_affordable:
            return TooLong((1, 1) if match else (self.robot.n, 1 if name == "tau" else self.robot.n))
        if match:
            return self._indexed(match.group(1), tuple(int(index) for index in match.group(2).split(",")))
        model, n = self.model, self.robot.n
        match name:
            case "T":
                return self._end_effector()
            case "J":
                return self._jacobian()
            case "B":
                return Counted((n, n), lambda i, j: model.terms("B", i, j), self._inertia_entry)
            case "C":
                return Counted((n, n), self._coriolis_terms, self._entry_of(name))
            case "N" | "Bdot":
                return Counted((n, n), lambda i, j: model.terms(name, i, j), self._entry_of(name))
            case "g":
                return self._polynomials([[p] for p in model.kinematics.gravity_vector], model.form.gravity)
            case "tau":
                return Counted((n, 1), self._torque_terms, self._entry_of(name))
            case "potential":
                return self._polynomials([[model.kinematics.potential]], model.form.dynamic)
            case "rpy" | "euler_zyz":
                return Written((3, 1), lambda: getattr(model, name))
            case "singularities":
                return singularity_quantity(model, lambda m: Written(m.shape, lambda: m), expanded_terms)
        body = BODY.fullmatch(name)
        if body:
            return Counted(*body_quantity(model, body.group(1), int(body.group(2))))
        raise KeyError(name)

    @cached_property
    def _inertia_is_affordable(self) -> bool:
        n = range(self.robot.n)
        dynamics = self.model.dynamics
        try:
            for i, j, k in ((i, j, k) for i in n for j in n for k in n if j <= k):
                dynamics.christoffel(i, j, k)
        except TooManyTerms:
            return False
        return True

    def _indexed(self, letter: str, indices: tuple[int, ...]) -> Quantity:
        model = self.model
        if letter == "A":
            return Written((4, 4), lambda: model.A(*indices))
        if letter == "T":
            return self._transform(*indices)
        if letter == "frame":
            return self._world_frame(*indices)
        i, j, k = indices
        if letter == "dB":
            return Counted(*derivative_quantity(model, i, j, k))
        return Counted((1, 1), lambda r, c: self._christoffel_terms(i, j, k), lambda r, c: model.christoffel(i, j, k))

    def _transform(self, i: int, j: int) -> Quantity:
        if self._long.is_long(i, j):
            return Written((4, 4), lambda: self.model.transform(i, j))
        return self._frame(self.model.kinematics.transform(i, j))

    def _world_frame(self, i: int) -> Quantity:
        """DH frame i in the world, base included."""
        if self._long.is_long(0, i):
            return Written((4, 4), lambda: self.model.frame(i))
        return self._frame(self.model.kinematics.frame(i))

    def _end_effector(self) -> Quantity:
        if self._long.is_long(0, self.robot.n):
            return self._long_frame()
        return self._frame(self.model.kinematics.end)

    def _frame(self, frame: Frame[Polynomial]) -> Quantity:
        number = self.model.domain.number
        rows = [[*frame.rotation[i], frame.position[i]] for i in range(3)]
        return self._polynomials([*rows, [number(k // 3) for k in range(4)]], self.model.form.kinematic)

    def _jacobian(self) -> Quantity:
        n, kinematics = self.robot.n, self.model.kinematics
        if self._long.is_long(0, n):
            return self._long_jacobian()
        halves = zip(kinematics.linear_columns(kinematics.end.position), kinematics.angular_columns(n), strict=True)
        columns = [[*linear, *angular] for linear, angular in halves]
        return self._polynomials([[column[row] for column in columns] for row in range(6)], self.model.form.kinematic)

    @cached_property
    def _long_counts(self) -> NestedKinematics[TermCount]:
        return nested_term_counts(self.robot)

    def _long_frame(self) -> Quantity:
        """T of a long arm; only entries short enough to print make it worth to be written."""
        end = self._long_counts.end
        rows = [[*end.rotation[i], end.position[i]] for i in range(3)]
        counts = [*([x.value for x in row] for row in rows), [0, 0, 0, 1]]
        bottom = (sympy.S.Zero, sympy.S.Zero, sympy.S.Zero, sympy.S.One)
        return Counted(
            (4, 4),
            lambda i, j: counts[i - 1][j - 1],
            lambda i, j: bottom[j - 1] if i == 4 else self.model.T[i - 1, j - 1],
        )

    def _long_jacobian(self) -> Quantity:
        """J of a long arm; the axes of the first joints, in its lower rows, are short."""
        counts, n = self._long_counts, self.robot.n
        columns = [[x.value for x in (*v, *w)] for v, w in zip(counts.linear, counts.angular, strict=True)]

        def write(i: int, j: int) -> Any:
            if i > 3:
                return self.model.form.kinematic(self.model.kinematics.axis(j)[i - 4])
            return self.model.J[i - 1, j - 1]

        return Counted((6, n), lambda i, j: columns[j - 1][i - 1], write)

    def _polynomials(self, rows: Sequence[Sequence[Polynomial]], write: Callable[[Polynomial], Any]) -> Quantity:
        """Entries that are counted as they are, and written one by one."""
        return Counted(
            (len(rows), len(rows[0])),
            lambda i, j: len(rows[i - 1][j - 1]),
            lambda i, j: write(rows[i - 1][j - 1]),
        )

    def _inertia_entry(self, i: int, j: int) -> Any:
        return self.model.dynamic_form.entry(self.model.dynamics.inertia_matrix[i - 1][j - 1], self._inertia_limit)

    @cached_property
    def _inertia_limit(self) -> int:
        matrix = self.model.dynamics.inertia_matrix
        return self.model.dynamic_form.limit([matrix[i][j] for i in range(self.robot.n) for j in range(i + 1)])

    def _entry_of(self, name: str) -> Callable[[int, int], Any]:
        return lambda i, j: getattr(self.model, name)[i - 1, j - 1]

    def _christoffel_terms(self, i: int, j: int, k: int) -> int:
        key = (i, min(j, k), max(j, k))
        if key not in self._sizes:
            dynamics = self.model.dynamics
            self._sizes[key] = dynamics.expanded_size(dynamics.christoffel(i - 1, j - 1, k - 1))
        return self._sizes[key]

    def _coriolis_terms(self, i: int, j: int) -> int:
        return sum(self._christoffel_terms(i, j, k) for k in range(1, self.robot.n + 1))

    def _torque_terms(self, i: int, _: int) -> int:
        joints = range(1, self.robot.n + 1)
        link = self.robot.links[i - 1]
        inertia = sum(self.model.terms("B", i, j) for j in joints)
        velocity = sum(self._christoffel_terms(i, j, k) for j in joints for k in joints if j <= k)
        friction = (link.viscous != ZERO) + (link.coulomb != ZERO)
        return inertia + velocity + self.model.terms("g", i) + friction


def expanded_terms(expression: Any) -> int:
    """Number of terms of a nested expression when multiplied out, before terms meet."""
    return _Counter().count(expression)


class _Counter:
    """Counts shared subexpressions once."""

    def __init__(self) -> None:
        self._known: dict[Any, int] = {}

    def count(self, expression: Any) -> int:
        if not expression.args:
            return int(expression != 0)
        found = self._known.get(expression)
        if found is None:
            found = self._known[expression] = self._count(expression)
        return found

    def _count(self, expression: Any) -> int:
        if expression.is_Add:
            return sum(self.count(term) for term in expression.args)
        if expression.is_Mul:
            total = 1
            for factor in expression.args:
                total *= self.count(factor)
            return total
        if expression.is_Pow and expression.exp.is_Integer and expression.exp > 0:
            return int(self.count(expression.base) ** int(expression.exp))
        return 1
