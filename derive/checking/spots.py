"""Places in a printed formula: what stands there, and what the whole becomes if something else stood there.

Values are floats at one point: a change is tried by carrying the new value of one place up to the root, without
evaluating the rest again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from derive.robot.evaluate import FUNCTIONS as REAL_FUNCTIONS
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, children, rebuilt

FUNCTIONS: Mapping[str, Callable[..., float]] = {
    **REAL_FUNCTIONS,
    "sign": lambda x: math.copysign(1.0, x) if x else 0.0,
}


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """One node of a formula.

    Attributes:
        node: What stands there.
        above: The place above; None for the whole formula.
        index: Which child of the node above it is, from 0.
        siblings: Values of all children of the node above.
        depth: Nodes above it.
        cost: Float operations of one value of the whole, about.
    """

    node: Expression
    above: Spot | None = None
    index: int = 0
    siblings: tuple[float, ...] = ()
    depth: int = 0
    cost: int = 1

    @property
    def parent(self) -> Expression | None:
        """The node above; None for the whole formula."""
        return self.above.node if self.above else None

    @property
    def is_term(self) -> bool:
        """Whether it is the whole formula or a term of a sum."""
        return self.above is None or isinstance(self.above.node, Sum)

    def value(self, here: float) -> float:
        """The value of the whole formula for another value here.

        Args:
            here: What this place is worth.
        """
        spot = self
        while (above := spot.above) is not None:
            parts = [*spot.siblings[: spot.index], here, *spot.siblings[spot.index + 1 :]]
            spot, here = above, combined(above.node, parts)
        return here

    def formula(self, here: Expression) -> Expression:
        """The whole formula with another node here, flattened.

        Args:
            here: What stands at this place.
        """
        if self.above is None:
            return here
        parts = children(self.above.node)
        changed = iter((*parts[: self.index], here, *parts[self.index + 1 :]))
        return self.above.formula(rebuilt(self.above.node, lambda _: next(changed)))


class Evaluator:
    """The values of trees at one point; every node is evaluated once.

    Args:
        values: Numbers of the names.
    """

    def __init__(self, values: Mapping[str, float]) -> None:
        self.values = values
        # by identity, since hashing a tree takes as long as evaluating it; the entry keeps its node, so the id, alive
        self._known: dict[int, tuple[Expression, float]] = {}

    def __call__(self, e: Expression) -> float:
        """The value of a tree; ArithmeticError, ValueError or KeyError where there is none."""
        known = self._known.get(id(e))
        if known is not None:
            return known[1]
        match e:
            case Number(number):
                value = float(number)
            case Pi():
                value = math.pi
            case Name(name):
                value = self.values[name]
            case _:
                value = combined(e, [self(child) for child in children(e)])
        self._known[id(e)] = (e, value)
        return value


def combined(e: Expression, parts: Sequence[float]) -> float:
    """The value of a node from the values below it.

    Args:
        e: A sum, product, power or call.
        parts: The values of its children.

    Raises:
        ArithmeticError: There is none.
        ValueError: There is none.
    """
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


def spots(root: Expression, evaluate: Evaluator) -> Iterator[Spot]:
    """Every place of a formula, from the root down; not the angles of plain cosines and sines, which are one token.

    Args:
        root: The formula.
        evaluate: Gives the values at the point.
    """
    waiting = [Spot(root)]
    while waiting:
        spot = waiting.pop()
        yield spot
        if not is_token(spot.node):
            parts = children(spot.node)
            values = tuple(evaluate(part) for part in parts)
            depth, cost = spot.depth + 1, spot.cost + len(parts)
            below = [Spot(part, spot, i, values, depth, cost) for i, part in enumerate(parts)]
            waiting.extend(reversed(below))


def is_token(e: Expression) -> bool:
    """Whether it is the cosine or sine of an angle without numbers and further functions.

    Args:
        e: Any tree.
    """
    if not (isinstance(e, Call) and e.function in ("cos", "sin")):
        return False
    (angle,) = e.arguments
    return all(isinstance(t, Name | Product) for t in (angle.terms if isinstance(angle, Sum) else (angle,)))
