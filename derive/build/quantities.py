"""The closed forms of a model as the emitters ask for them: by name, entry by entry, sizes before expressions."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from derive.emit.quantity import Quantity
from derive.mechanics.model import Model
from derive.robot.expression import ZERO
from derive.robot.robot import Robot

_INDEXED = re.compile(r"(A|T|christoffel)\[([0-9,]+)\]")


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


class ModelQuantities(Mapping[str, Quantity]):
    """All quantities of a model by name.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.model = Model(robot)
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
        if match:
            return self._indexed(match.group(1), tuple(int(index) for index in match.group(2).split(",")))
        model, n = self.model, self.robot.n
        match name:
            case "T":
                return Written((4, 4), lambda: model.T)
            case "J":
                return Written((6, n), lambda: model.J)
            case "B" | "C" | "N":
                return Counted((n, n), lambda i, j: model.terms(name, i, j), self._entry_of(name))
            case "g":
                return Counted((n, 1), lambda i, j: model.terms(name, i, j), self._entry_of(name))
            case "tau":
                return Counted((n, 1), self._torque_terms, self._entry_of(name))
            case "potential":
                potential = model.kinematics.potential
                return Counted((1, 1), lambda i, j: len(potential), lambda i, j: model.energy.potential)
        raise KeyError(name)

    def _indexed(self, letter: str, indices: tuple[int, ...]) -> Quantity:
        model = self.model
        if letter == "A":
            return Written((4, 4), lambda: model.A(*indices))
        if letter == "T":
            return Written((4, 4), lambda: model.transform(*indices))
        i, j, k = indices
        return Counted((1, 1), lambda r, c: self._christoffel_terms(i, j, k), lambda r, c: model.christoffel(i, j, k))

    def _entry_of(self, name: str) -> Callable[[int, int], Any]:
        return lambda i, j: getattr(self.model, name)[i - 1, j - 1]

    def _christoffel_terms(self, i: int, j: int, k: int) -> int:
        dynamics = self.model.dynamics
        return dynamics.expanded_size(dynamics.christoffel(i - 1, j - 1, k - 1))

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
