"""Quantities of the ends of a tree: each is that of the serial arm which leads to the end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, lru_cache, wraps
from typing import Any, Self, TypeVar, cast

import sympy

from derive.errors import QuantityError, listed, near_miss
from derive.lecture.sympy_conversion import Matrix
from derive.robot import tree
from derive.robot.description import BASE
from derive.robot.options.style import Style
from derive.robot.robot import Robot

Method = TypeVar("Method", bound=Callable[..., Any])


class TreeModel:
    """What a model knows of the tree that its robot may be."""

    robot: Robot
    style: Style

    def arm(self, end: str) -> tuple[Self, tuple[int, ...]]:
        """The model of the serial arm to an end of a tree, without bodies, and its joints' indices there, from 0."""
        kind: Any = type(self)
        return cast("tuple[Self, tuple[int, ...]]", _arm(kind, self.robot, self.style, end))

    def _require_index(self, i: int, first: int, last: int) -> None:
        if not first <= i <= last:
            raise QuantityError(f"index {i}", allowed=f"allowed: {first} to {last} for {self.robot.name}")

    def _index(self, i: int | str) -> int:
        """The number of a frame of a chain."""
        if isinstance(i, str):
            raise QuantityError(f"frame {i!r} of {self.robot.name}", allowed="allowed: numbers, for it is no tree")
        self._require_index(i, 0, self.robot.n)
        return i

    def frame_number(self, row: str, *, or_end: bool = False) -> int:
        """The number of a frame of a tree: that of its joint, and behind these those of the rows without motion.

        ``or_end`` says whether the name of an end would do, too, where one is to be told what is known.
        """
        labels = tree.labels(self.robot)
        if row not in labels and row != BASE:
            ends = [end.name for end in self.robot.ends if end.name and or_end]
            known = dict.fromkeys([*ends, BASE, *labels[1:]])
            found = f"{'end or ' * bool(ends)}row {row!r} of {self.robot.name}"
            raise QuantityError(found, allowed=f"allowed: {listed(known)}", remedy=near_miss(row, known))
        return labels.index(row) if row in labels else 0

    def _label(self, i: int | str) -> str:
        number, labels = self.frame_number(i) if isinstance(i, str) else i, tree.labels(self.robot)
        if not 0 <= number < len(labels):
            raise QuantityError(f"frame {number} of {self.robot.name}", allowed=f"allowed: 0 to {len(labels) - 1}")
        return labels[number]


@lru_cache(64)
def _arm(kind: Callable[[Robot, Style], Any], robot: Robot, style: Style, end: str) -> tuple[Any, tuple[int, ...]]:
    arm, places = tree.arm(robot, end)
    return kind(arm, style), places


class OfEnds(Mapping[str, Any]):
    """A quantity of each end, by the end's name: ``T["left"]``, or ``T("left")``."""

    def __init__(self, names: Sequence[str], value: Callable[[str], Any]) -> None:
        self._names, self._value = tuple(names), cache(value)

    def __getitem__(self, name: Any) -> Any:
        # a row and a column, or slices of them, are those of each end
        return self._value(name) if isinstance(name, str) else self.each(lambda value: value[name])

    def __call__(self, name: str) -> Any:
        """The quantity of an end."""
        return self._value(name)

    def each(self, change: Callable[[Any], Any]) -> OfEnds:
        """What follows from it, of each end."""
        return OfEnds(self._names, lambda name: change(self[name]))

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return "\n".join(f"{name}: {self[name]!r}" for name in self)


def of_each_end(function: Method) -> Method:
    """Of a tree with named ends the quantity of each end."""
    return _of_each_end(function, lambda value, places, n: value)


def of_each_end_by_joints(function: Method) -> Method:
    """The same of a matrix with a column for each joint: those of joints that do not move the end are zero."""
    return _of_each_end(function, spread)


def _of_each_end(function: Method, finish: Callable[[Any, Sequence[int], int], Any]) -> Method:
    @wraps(function)
    def _value(model: Any, *arguments: Any, **named: Any) -> Any:
        names = [end.name for end in model.robot.ends if end.name]
        if not names:
            return function(model, *arguments, **named)

        def _of(name: str) -> Any:
            arm, places = model.arm(name)
            columns = range(model.n) if model.robot.coupled else places
            return finish(function(arm, *arguments, **named), columns, model.n)

        return OfEnds(names, _of)

    return cast("Method", _value)


def spread(matrix: Matrix, places: Sequence[int], n: int) -> Matrix:
    """A matrix with a column for each joint of an arm, with one for each joint of the tree."""
    columns = dict(zip(places, range(len(places)), strict=True))
    zero = sympy.ImmutableMatrix.zeros(matrix.shape[0], 1)
    return sympy.ImmutableMatrix.hstack(*(matrix[:, columns[k]] if k in columns else zero for k in range(n)))
