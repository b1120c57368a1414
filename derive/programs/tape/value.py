"""Values of a graph with Python's operators, cells and joint variables among them: what recursions are traced with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from operator import attrgetter

from derive.algebra import constants
from derive.algebra.angles import composed, decompose
from derive.errors import QuantityError
from derive.inverse.closed.unknowns import turned
from derive.programs.tape.graph import ONE, Graph, Ref, is_negative, negated, node_of
from derive.programs.tape.graph import ZERO as ZERO_VALUE
from derive.programs.tape.tape import PARAMETER, Op
from derive.robot.description import Joint, coupling
from derive.robot.expression import ZERO, Call, Expression, Name, Number, Pi, Power, Product, Sum, substitute
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot


def _operation(make: Callable[..., Ref]) -> Callable[..., Value]:
    """A method for an operation of the graph on this value and others, which may be numbers."""
    return lambda value, *others: Value(value.graph, make(value.graph, value.ref, *map(value._other, others)))


def _kept_operation(table: str, make: Callable[..., Ref]) -> Callable[[Value, Value | int | Fraction], Value]:
    """The same of one other value, which is looked for in a table of the graph first."""
    results = attrgetter(table)

    def _operate(value: Value, other: Value | int | Fraction, /) -> Value:
        graph = value.graph
        pair = value.ref, other.ref if isinstance(other, Value) else graph.number(Fraction(other))
        found: Value | None = results(graph).get(pair)
        if found is None:
            found = results(graph)[pair] = Value(graph, make(graph, *pair))
        return found

    return _operate


class Value:
    """A reference into a graph with Python's operators; immutable."""

    __slots__ = ("graph", "ref")

    def __init__(self, graph: Graph, ref: Ref) -> None:
        self.graph = graph
        self.ref = ref

    __add__ = __radd__ = _kept_operation("sums", Graph.add)
    __sub__ = _kept_operation("differences", Graph.subtract)
    __mul__ = __rmul__ = _kept_operation("products", Graph.multiply)

    def __rsub__(self, other: Value | int | Fraction, /) -> Value:
        return Value(self.graph, self.graph.subtract(self._other(other), self.ref))

    def __rtruediv__(self, other: Value | int | Fraction, /) -> Value:
        return Value(self.graph, self.graph.divide(self._other(other), self.ref))

    def __neg__(self) -> Value:
        return Value(self.graph, negated(self.ref))

    def __pow__(self, exponent: int, /) -> Value:
        """Integer powers by repeated squaring; a negative one divides."""
        if exponent < 0:
            return 1 / self ** (-exponent)
        result, square = Value(self.graph, ONE), self
        while exponent:
            if exponent & 1:
                result = result * square
            exponent >>= 1
            if exponent:
                square = square * square
        return result

    sin = _operation(Graph.sine)  # of an angle [rad]
    cos = _operation(Graph.cosine)
    sqrt = _operation(Graph.root)
    sign = _operation(Graph.sign)  # -1, 0 or 1
    arctangent = _operation(Graph.arctangent)  # atan2 of this and another one [rad]
    less = _operation(Graph.less)  # 1 where this is less than another one, else 0
    select = _operation(Graph.select)  # the first of two others where this is 1, else the second
    opposite = _operation(Graph.opposite)  # 0 where this is 1, 1 where it is 0
    maximum = _operation(lambda graph, *pair: graph.extreme(Op.MAXIMUM, *pair))
    minimum = _operation(lambda graph, *pair: graph.extreme(Op.MINIMUM, *pair))
    __abs__ = _operation(Graph.absolute)
    __truediv__ = _operation(Graph.divide)

    def __bool__(self) -> bool:
        """Whether it is anything but the constant zero."""
        return self.ref != ZERO_VALUE

    def __repr__(self) -> str:
        """``v7``, or ``-v7``."""
        return f"{'-' if is_negative(self.ref) else ''}v{node_of(self.ref)}"

    def _other(self, other: Value | int | Fraction) -> Ref:
        return other.ref if isinstance(other, Value) else self.graph.number(Fraction(other))


# -- exact cells and joint variables as tape values
#
# Symbols stay symbols while a graph is traced, whether they have a number or not; the numbers are put in afterwards
# (`derive.programs.tape.build`), so that work is shared before it is folded. Only the offset of a joint angle looks at
# the numbers: a multiple of pi/2 exchanges sine and cosine, any other goes into the angle, cos(q + offset), which costs
# less than the addition theorem.

Q, QD, QDD, TAU, WRENCH, PASSIVE = "q", "qd", "qdd", "tau", "h", "q_p"  # kinds of arguments
_OF_JOINTS = frozenset({Q, QD, QDD, TAU})  # those with one entry per joint


@dataclass(frozen=True)
class Passive:
    """What is known of the passive joints of closed loops, by their places in the robot."""

    numbers: Mapping[int, tuple[Value, ...]] = field(default_factory=dict)  # cosine and sine of the variable, or length
    slopes: Mapping[Expression, Value] = field(default_factory=dict)  # derivatives by the variables, by their names
    biases: Mapping[int, Value] = field(default_factory=dict)  # accelerations while the variables have none
    is_given: bool = False  # whether functions take their positions, which follow from no formulas


class TapeDomain:
    """A `derive.mechanics.chain.Domain` on a graph, whose run-time parameter k is ``robot_symbols(robot)[k]``.

    With ``places`` it is that of the arm whose joints are these joints of the robot.
    """

    def __init__(
        self, robot: Robot, graph: Graph, places: Sequence[int] | None = None, passive: Passive | None = None
    ) -> None:
        self.graph = graph
        self._passive = passive or Passive()
        self._places = range(robot.n) if places is None else places
        self._coupling = coupling(robot) if robot.coupled else []
        self._joints = [robot.joints[place] for place in self._places]
        self._numbers = {k: v for k, v in dict(robot.parameters).items() if k not in robot.runtime}
        self._known: dict[Expression, Value] = {
            Name(name): Value(graph, graph.input(PARAMETER, i)) for i, name in enumerate(robot_symbols(robot))
        } | dict(self._passive.slopes)

    def argument(self, kind: str, index: int) -> Value:
        """One entry of an argument; of q, its derivatives and tau that of the joint with that index in the arm."""
        if kind not in _OF_JOINTS:
            return self.variable(kind, index)
        if not self._coupling:
            return self.variable(kind, self._places[index])
        place = self._places[index]
        if kind == Q and place in self._passive.numbers:
            numbers = self._passive.numbers[place]
            return numbers[0] if len(numbers) == 1 else numbers[1].arctangent(numbers[0])
        if self._joints[index].follows and place not in self._passive.numbers:
            return self.number(0)  # of a loop that is still to be solved: nothing that is used depends on it
        start = self._passive.biases.get(place, self.number(0)) if kind == QDD else self.number(0)
        row = enumerate(self._coupling[place])
        return sum((self.constant(factor) * self.variable(kind, k) for k, factor in row if factor != ZERO), start)

    def bias(self, index: int) -> Value:
        """The acceleration of the joint with that index in the arm while the variables have none."""
        return self._passive.biases.get(self._places[index], self.number(0))

    def variable(self, kind: str, index: int) -> Value:
        """One entry of an argument of the function."""
        return Value(self.graph, self.graph.input(kind, index))

    def number(self, value: int | Fraction) -> Value:
        """A rational."""
        return Value(self.graph, self.graph.number(Fraction(value)))

    def constant(self, expression: Expression) -> Value:
        """The value of a cell."""
        found = self._known.get(expression)
        if found is None:
            found = self._known[expression] = self._evaluate(expression)
        return found

    def _evaluate(self, expression: Expression) -> Value:
        match expression:
            case Number(value):
                return self.number(value)
            case Pi():
                return Value(self.graph, self.graph.number(constants.pi()))
            case Sum(terms):
                return sum((self.constant(term) for term in terms), self.number(0))
            case Product(factors):  # divisors last: a * b**-1 is one division, not a reciprocal and a product
                result = self.number(1)
                divisors = [f for f in factors if isinstance(f, Power) and f.exponent < 0]
                for factor in factors:
                    if factor not in divisors:
                        result = result * self.constant(factor)
                for divisor in divisors:
                    result = result / self.constant(divisor.base) ** -divisor.exponent
                return result
            case Power(base, exponent):
                return self.constant(base) ** exponent
            case Call("sin", (angle,)):
                return self.constant(angle).sin()
            case Call("cos", (angle,)):
                return self.constant(angle).cos()
            case Call("tan", (angle,)):
                argument = self.constant(angle)
                return argument.sin() / argument.cos()
            case Call("sqrt", (square,)):
                return self.constant(square).sqrt()
        raise QuantityError(f"{expression} has no place in a cell", allowed="allowed: symbols, sin, cos, tan, sqrt")

    def cosine_sine(self, angle: Expression) -> tuple[Value, Value]:
        """Cosine and sine of a constant angle in the robot's symbols [rad]."""
        return self._cosine_sine(self.number(0), angle)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Value, Value]:
        """Cosine and sine of the angle ``sign*q + theta`` of a revolute joint."""
        if (pair := self._passive.numbers.get(self._places[index])) is not None:
            return turned(self._cosine_sine(self.number(0), joint.theta), pair, joint.sign)
        return self._cosine_sine(self._signed(index, joint), joint.theta)

    def cosine_sine_of_sum(self, turns: Sequence[tuple[int, int]]) -> tuple[Value, Value]:
        """Cosine and sine of a signed sum of the angles ``sign*q + theta`` of revolute joints, which are added."""
        variable, offset = self.number(0), []
        for index, direction in turns:
            joint = self._joints[index]
            if not self._coupling:
                variable = variable + direction * self._signed(index, joint)
            offset.append(Product((Number(Fraction(direction)), joint.theta)))
        numbers = self._passive.numbers
        active = [turn for turn in turns if self._places[turn[0]] not in numbers]
        total = self._cosine_sine(self._coupled_sum(active) if self._coupling else variable, Sum(tuple(offset)))
        for index, direction in turns:  # the angles of passive joints are known by cosine and sine
            if (pair := numbers.get(self._places[index])) is not None:
                total = turned(total, pair, direction * self._joints[index].sign)
        return total

    def _coupled_sum(self, turns: Sequence[tuple[int, int]]) -> Value:
        """What is variable of a sum of angles of coupled joints; what cancels there costs nothing."""
        rows = [(direction * self._joints[i].sign, self._coupling[self._places[i]]) for i, direction in turns]
        total = self.number(0)
        for k, column in enumerate(zip(*(row for _, row in rows), strict=True)):
            signed = (Product((Number(Fraction(sign)), factor)) for (sign, _), factor in zip(rows, column, strict=True))
            terms = composed(decompose(Sum(tuple(signed))))
            total = total + self.constant(terms) * self.variable(Q, k) if terms != ZERO else total
        return total

    def joint_offset(self, index: int, joint: Joint) -> Value:
        """The offset ``sign*q + d`` of a prismatic joint."""
        return self._signed(index, joint) + self.constant(joint.d)

    def _signed(self, index: int, joint: Joint) -> Value:
        variable = self.argument(Q, index)
        return variable if joint.sign > 0 else -variable

    def _cosine_sine(self, variable: Value, offset: Expression) -> tuple[Value, Value]:
        """Of ``variable + offset``, whole quarter turns of the offset taken out."""
        exact = decompose(substitute(offset, self._numbers))
        quarters = 2 * exact.pi_multiple
        whole = quarters if quarters.denominator == 1 else Fraction(0)
        rest = self.constant(Pi()) * (exact.pi_multiple - whole / 2)
        for unit, coefficient in exact.terms:
            rest = rest + self.constant(unit) * coefficient
        angle = variable + rest
        c, s = angle.cos(), angle.sin()
        return ((c, s), (-s, c), (-c, -s), (s, -c))[int(whole) % 4]


def least_squares(
    columns: Sequence[Sequence[Value]], weights: Sequence[Value | int], right: Sequence[Value]
) -> list[Value]:
    """The x for which the weighted sum of the squares of A x - b is least, by the modified method of Gram and Schmidt.

    It loses the digits of the condition of A, not of its square (Bjorck, Numerical Methods for Least Squares Problems,
    section 2.4), and without square roots.
    """
    rest = [list(column) for column in (*columns, right)]
    factors: list[list[Value]] = []
    for j in range(len(columns)):
        weighted = [weight * value for weight, value in zip(weights, rest[j], strict=True)]
        square = dot_product(weighted, rest[j])
        factors.append([dot_product(weighted, other) / square for other in rest[j + 1 :]])
        for other, factor in zip(rest[j + 1 :], factors[j], strict=True):
            other[:] = [value - factor * own for value, own in zip(other, rest[j], strict=True)]
    found: list[Value] = []
    for row in reversed(factors):
        found.insert(0, row[-1] - dot_product(row[:-1], found) if found else row[-1])
    return found


def dot_product(a: Sequence[Value], b: Sequence[Value]) -> Value:
    """The sum of the products of two rows of values."""
    return reduce(Value.__add__, map(Value.__mul__, a, b))
