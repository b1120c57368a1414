"""Places in a printed formula: what stands there, and what the whole becomes if something else stood there.

Values are floats at one point: a change is tried by carrying the new value of one place up to the root, without
evaluating the rest again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeVar

from derive.robot.evaluate import FUNCTIONS as REAL_FUNCTIONS
from derive.robot.expression import (
    Call,
    Expression,
    Name,
    Number,
    Pi,
    Power,
    Product,
    Sum,
    add,
    children,
    multiply,
    power,
)

T = TypeVar("T")


def _sign(x: float) -> float:
    return math.copysign(1.0, x) if x else 0.0


FUNCTIONS: Mapping[str, Callable[..., float]] = {**REAL_FUNCTIONS, "sign": _sign}


@dataclass(frozen=True, slots=True)
class Spot:
    """One node of a formula.

    Attributes:
        node: What stands there.
        parent: The node above; None for the whole formula.
        value: Value of the whole for a value here.
        formula: The whole for another node here.
        index: Which child of its parent it is, from 0.
        depth: Nodes above it.
        cost: Float operations of one value, about.
    """

    node: Expression
    parent: Expression | None
    value: Callable[[float], float]
    formula: Callable[[Expression], Expression]
    index: int = 0
    depth: int = 0
    cost: int = 1

    @property
    def is_term(self) -> bool:
        """Whether it is the whole formula or a term of a sum."""
        return self.parent is None or isinstance(self.parent, Sum)


class Evaluator:
    """Values of trees at one point; those of shared nodes are computed once."""

    def __init__(self, values: Mapping[str, float]) -> None:
        self.values = values
        self._known: dict[int, tuple[Expression, float]] = {}

    def __call__(self, e: Expression) -> float:
        """The value of a tree; ArithmeticError, ValueError or KeyError where there is none."""
        known = self._known.get(id(e))
        if known is not None:
            return known[1]
        value = self._value(e)
        self._known[id(e)] = (e, value)
        return value

    def _value(self, e: Expression) -> float:
        match e:
            case Number(value):
                return float(value)
            case Pi():
                return math.pi
            case Name(name):
                return self.values[name]
            case _:
                return combined(e, [self(child) for child in children(e)])


def combined(e: Expression, parts: list[float]) -> float:
    """The value of a node from the values below it."""
    match e:
        case Sum():
            return math.fsum(parts)
        case Product():
            return math.prod(parts)
        case Power(_, exponent):
            return float(parts[0] ** exponent)
        case Call(function, _):
            return FUNCTIONS[function](*parts)
    raise TypeError(e)


def rebuilt(e: Expression, parts: tuple[Expression, ...]) -> Expression:
    """The node with other children, flattened."""
    match e:
        case Sum():
            return add(*parts)
        case Product():
            return multiply(*parts)
        case Power(_, exponent):
            return power(parts[0], exponent)
        case Call(function, _):
            return Call(function, parts)
    raise TypeError(e)


def spots(root: Expression, evaluate: Evaluator) -> Iterator[Spot]:
    """Every place of a formula, from the root down; not the angles of plain cosines and sines, which are one token."""
    waiting = [Spot(root, None, _same, _same)]
    while waiting:
        spot = waiting.pop()
        yield spot
        waiting.extend(reversed([] if is_token(spot.node) else list(_below(spot, evaluate))))


def is_token(e: Expression) -> bool:
    """Whether it is the cosine or sine of an angle without numbers and further functions."""
    if not (isinstance(e, Call) and e.function in ("cos", "sin")):
        return False
    (angle,) = e.arguments
    return all(isinstance(t, Name | Product) for t in (angle.terms if isinstance(angle, Sum) else (angle,)))


def _same(value: T) -> T:
    return value


def _below(spot: Spot, evaluate: Evaluator) -> Iterator[Spot]:
    parts = children(spot.node)
    values = [evaluate(part) for part in parts]
    for i, part in enumerate(parts):
        value, formula = _value_with(spot, values, i), _formula_with(spot, parts, i)
        yield Spot(part, spot.node, value, formula, i, spot.depth + 1, spot.cost + len(parts))


def _value_with(spot: Spot, values: list[float], i: int) -> Callable[[float], float]:
    def value(here: float) -> float:
        return spot.value(combined(spot.node, [*values[:i], here, *values[i + 1 :]]))

    return value


def _formula_with(spot: Spot, parts: tuple[Expression, ...], i: int) -> Callable[[Expression], Expression]:
    def formula(here: Expression) -> Expression:
        return spot.formula(rebuilt(spot.node, (*parts[:i], here, *parts[i + 1 :])))

    return formula
