"""Cells of the robot file as tape values."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from derive.algebra import tape_constant
from derive.algebra.tape_constant import Constant
from derive.algebra.tape_graph import Graph
from derive.algebra.tape_value import Value
from derive.errors import QuantityError
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, names


class CellReader:
    """Evaluates expressions on one graph, each once.

    Args:
        graph: Where the values live.
        values: What the names stand for.
    """

    def __init__(self, graph: Graph, values: Mapping[str, Value]) -> None:
        self.graph = graph
        self._values = values
        self._cache: dict[Expression, Value] = {}

    def number(self, value: int | Fraction) -> Value:
        """A rational."""
        return Value(self.graph, self.graph.number(Fraction(value)))

    def constant(self, expression: Expression) -> Value:
        """The value of a cell.

        Raises:
            QuantityError: Division by zero, or the square root of a negative number.
        """
        found = self._cache.get(expression)
        if found is None:
            found = self._cache[expression] = self._evaluate(expression)
        return found

    def _evaluate(self, expression: Expression) -> Value:
        match expression:
            case Number(value):
                return self.number(value)
            case Pi():
                return Value(self.graph, self.graph.number(tape_constant.pi()))
            case Name(name):
                return self._values[name]
            case Sum(terms):
                return sum((self.constant(term) for term in terms), self.number(0))
            case Product(factors):
                return self._product(factors)
            case Power(base, exponent):
                return self.constant(base) ** exponent
            case Call(function, arguments):
                return self._call(function, self.constant(arguments[0]))

    def _product(self, factors: tuple[Expression, ...]) -> Value:
        """Divisors last: ``a * b**-1`` is one division, not a reciprocal and a product."""
        result = self.number(1)
        divisors = [f for f in factors if isinstance(f, Power) and f.exponent < 0]
        for factor in factors:
            if factor not in divisors:
                result = result * self.constant(factor)
        for divisor in divisors:
            result = result / self.constant(divisor.base) ** -divisor.exponent
        return result

    def _call(self, function: str, argument: Value) -> Value:
        match function:
            case "sin":
                return argument.sin()
            case "cos":
                return argument.cos()
            case "tan":
                return argument.sin() / argument.cos()
            case "sqrt":
                return argument.sqrt()
        raise QuantityError(f"'{function}' has no place in a cell", allowed="sin, cos, tan, sqrt")


def substitute(expression: Expression, numbers: Mapping[str, Expression]) -> Expression:
    """The tree with its names replaced where they have a number."""
    match expression:
        case Name(name):
            return numbers.get(name, expression)
        case Sum(terms):
            return Sum(tuple(substitute(term, numbers) for term in terms))
        case Product(factors):
            return Product(tuple(substitute(factor, numbers) for factor in factors))
        case Power(base, exponent):
            return Power(substitute(base, numbers), exponent)
        case Call(function, arguments):
            return Call(function, tuple(substitute(argument, numbers) for argument in arguments))
        case _:
            return expression


def exact_number(expression: Expression, numbers: Mapping[str, Expression]) -> Constant | None:
    """The number behind a cell, or None if a name in it has none."""
    closed = substitute(expression, numbers)
    if any(True for _ in names(closed)):
        return None
    graph = Graph()
    return graph.constant_of(CellReader(graph, {}).constant(closed).ref)
