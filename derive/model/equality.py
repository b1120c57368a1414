"""Whether a printed formula equals a derived quantity, decided exactly in the polynomial ring wherever possible."""

import random
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import islice
from math import gcd, lcm
from typing import TYPE_CHECKING, Any

import mpmath
import sympy

from derive.algebra.quotients import QuotientRing
from derive.algebra.ring import TooManyTerms
from derive.errors import CheckError, ExpressionError, QuantityError
from derive.lecture.shorthand import read_formula
from derive.lecture.sympy_conversion import Expr, Matrix, expression_from_sympy, expression_to_sympy
from derive.model.dynamic_model import DynamicModel
from derive.model.ends import OfEnds
from derive.model.quantity_names import evaluate as asked_for
from derive.model.quantity_names import of_one_end, parse, pick
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, names
from derive.robot.robot import Robot

if TYPE_CHECKING:
    from derive.model.closure import OnClosure

Real = Any
Values = Mapping[str, Fraction]

DIGITS = 50
POINTS = 8
POINTS_OF_LOOPS = 24  # which are the only proof where branches and roots play a part
TRIALS = 240
CLOSE = mpmath.mpf(10) ** -30  # relative difference below which two values with fifty digits are the same number
LARGEST = mpmath.mpf(10) ** 300  # values beyond it do not fit into a float and count as none
# Relative difference that a reader sees in a few digits; a counter-example should show one.
VISIBLE = mpmath.mpf(10) ** -3
# The form of an expression up to a rational factor; ordered, so that equal forms are equal values.
Shape = tuple[Any, ...]
ONE: Shape = ("*",)
UNIT = Fraction(1)  # one object: most factors are 1, and are not multiplied
_PARITY = {"cos": 1, "sin": -1, "tan": -1}  # f(-x) = +-f(x)


def _real_root(value: Real) -> Real:
    if value < 0:
        raise ValueError("root of a negative number")
    return mpmath.sqrt(value)


_FUNCTIONS: Mapping[str, Callable[..., Real]] = {
    **{name: getattr(mpmath, name) for name in ("sin", "cos", "tan", "atan2", "sign")},
    "sqrt": _real_root,
}


@dataclass(frozen=True, slots=True)
class CounterExample:
    """A point at which two formulas differ."""

    values: tuple[tuple[str, Fraction], ...]  # a number for every name in them, in SI units and radians
    printed: float  # value of the formula in question
    right: float  # value of the derived one


def evaluate(expression: Expression, values: Values) -> Real | None:
    """The value of a formula with the working precision of mpmath; None where it is not real or too large."""
    try:
        value = _value(expression, values, {})
    except (ArithmeticError, ValueError):
        return None
    return value if abs(value) < LARGEST else None


def _value(e: Expression, values: Values, known: dict[Expression, Real]) -> Real:
    match e:
        case Number(value):
            return mpmath.mpf(value.numerator) / value.denominator
        case Pi():
            return +mpmath.pi
        case Sum(terms):
            return mpmath.fsum(_value(term, values, known) for term in terms)
        case Product(factors):
            return mpmath.fprod(_value(factor, values, known) for factor in factors)
        case Power(base, exponent):
            return _value(base, values, known) ** exponent
    if e not in known:  # a name or a function, each of which stands in many terms
        if isinstance(e, Name):
            known[e] = mpmath.mpf(values[e.name].numerator) / values[e.name].denominator
        else:
            known[e] = _FUNCTIONS[e.function](*(_value(argument, values, known) for argument in e.arguments))
    return known[e]


def samples(robot: Robot, wanted: list[str]) -> Iterator[dict[str, Fraction]]:
    """Points of two decimals: angles of either sign, other numbers mostly positive; loops closed, near the file's."""
    rng, closed = random.Random(1), _closed(robot)
    angles = {joint.variable for joint in robot.variables if joint.is_revolute}
    slides = {joint.variable for joint in robot.variables if not joint.is_revolute}
    typed = parameter_values(robot) if closed else {}
    drawn = sorted({*closed.free, *(n for n in wanted if closed.meaning(n) is None)}) if closed else wanted
    for trial in range(TRIALS):
        point = {}
        for name in drawn:
            size = Fraction(rng.randint(10, 290 if name in angles else 200), 100)
            point[name] = -size if rng.random() < (0.5 if name in angles else 0.25 * (trial % 2)) else size
            if name in typed:
                usual = Fraction(typed[name]).limit_denominator(10**6) or Fraction(1, 50)
                point[name] = usual * Fraction(rng.randint(80, 125), 100)
        if closed is None:
            yield point
            continue
        point |= {name: point[name] * Fraction(closed.reach(point) / 2).limit_denominator(100) for name in slides}
        if not closed.closes(point):
            continue
        point |= closed.roots(point)
        if _complete(closed, point, wanted):
            yield {name: point[name] for name in wanted}


@lru_cache(8)
def _closed(robot: Robot) -> "OnClosure | None":
    """The closed configurations of a robot with loops."""
    if not robot.passive:
        return None
    from derive.model.closure import OnClosure  # NumPy, which models without loops do not need

    return OnClosure(robot)


def _complete(closed: "OnClosure", point: dict[str, Fraction], wanted: Iterable[str]) -> bool:
    """Whether all names that are wanted have a value at a point; they are added to it."""
    for name in wanted:
        if name not in point:
            meaning = closed.meaning(name)
            if meaning is None or not _complete(closed, point, names(meaning)):
                return False
            with mpmath.workdps(DIGITS):
                value = evaluate(meaning, point)
                if value is None:
                    return False
                if name in closed.angles:
                    value = mpmath.atan2(mpmath.sin(value), mpmath.cos(value))
                point[name] = Fraction(mpmath.nstr(value, DIGITS))
    return True


@dataclass(frozen=True, slots=True)
class Verdict:
    """The outcome of a comparison."""

    equal: bool  # whether the formulas are equal wherever both are defined
    exact: bool  # whether algebra decided that identically, and not values with fifty digits at random points
    counter_example: CounterExample | None = None  # a point where they differ; None where they are equal
    configurations: int = 0  # of closed loops at which they were seen to be equal, where that is all


def _examples(robot: Robot, ours: Expression, theirs: Expression) -> Iterator[tuple[Real, CounterExample]]:
    """Random points at which both formulas have real values, with the gap between these; a visible one is the last."""
    for values in samples(robot, sorted({*names(ours), *names(theirs)})):
        with mpmath.workdps(DIGITS):
            right, printed = evaluate(ours, values), evaluate(theirs, values)
            if right is None or printed is None:
                continue
            # Relative to both, so that formulas of any size are judged alike.
            gap = min(abs(right - printed) / (1 + abs(right) + abs(printed)), VISIBLE)
            example = CounterExample(tuple(values.items()), float(printed), float(right))
        yield gap, example
        if gap == VISIBLE:
            return


def compare(robot: Robot, ours: Expression, theirs: Expression) -> Verdict:
    """Whether two formulas are equal wherever both are defined."""
    closed = _closed(robot)
    examples = _examples(robot, ours, theirs)
    points = [] if closed else [*islice(examples, 1)]  # what one shows needs no algebra, but for a rounded zero below
    try:
        ring = QuotientRing(robot, (ours, theirs))
        shown = bool(points) and points[0][0] == VISIBLE and not ring.denominators
        zero, proves = not (shown or ring.difference(ours, theirs)), ring.faithful
    except (ExpressionError, TooManyTerms):
        zero = proves = False
    if zero:
        return Verdict(True, True)
    if closed is not None:
        with suppress(ExpressionError, TooManyTerms, CheckError):  # the last of what is singular wherever it is closed
            one, other = closed.reduced(ours), closed.reduced(theirs)
            if not QuotientRing(robot, (one, other)).difference(one, other):
                return Verdict(True, True)
        proves = False
    points += islice(examples, (POINTS_OF_LOOPS if closed else POINTS) - len(points))
    if not proves and not points:
        remedy = "check its roots and denominators"
        raise CheckError("formula without a real value at any of many random points", remedy=remedy)
    worst, example = max(points, key=lambda pair: pair[0], default=(0, None))
    is_equal, seen = not proves and worst <= CLOSE, len(points) if closed else 0
    return Verdict(is_equal, proves, example if worst > CLOSE else None, seen * is_equal)


def verdict(model: DynamicModel, quantity: str, expression: object) -> Verdict:
    """Whether an expression equals a scalar quantity."""
    if isinstance(expression, str):
        theirs = read_formula(expression, model.robot)
    else:
        try:
            theirs = expression_from_sympy(expression)
        except ExpressionError as error:
            raise CheckError(error.found, allowed=error.allowed, remedy=error.remedy) from None
    return compare(model.robot, expression_from_sympy(scalar_quantity(model, quantity)), theirs)


def passive_positions(model: DynamicModel) -> Matrix:
    """The closure as a column: each passive joint in one formula, its branch that of the file."""
    formulas = (on.solved(joint.variable) for joint in model.robot.passive if (on := _closed(model.robot)))
    return sympy.ImmutableMatrix([*map(expression_to_sympy, formulas)])


def scalar_quantity(model: DynamicModel, text: str) -> Expr:
    """A quantity that is one expression."""
    text = of_one_end(model, text)
    quantity, indices, entry = parse(model, text)
    if quantity.name == "closure" and entry is not None:
        return pick(passive_positions(model), entry, text)
    if entry is not None:
        return asked_for(model, text)
    # as many indices as possible name the quantity, the rest picks the entry
    for count in sorted((count for count in quantity.indices if count <= len(indices)), reverse=True):
        value, rest = quantity.value(model, *indices[:count]), indices[count:]
        shape = getattr(value, "shape", None)
        if shape is None and not rest and not isinstance(value, OfEnds):
            return value
        if shape == (1, 1) and not rest:
            return value[0, 0]
        if shape is not None and len(rest) == (1 if shape[1] == 1 else 2):
            return pick(value, rest, text)
    remedy = f"name an entry, for instance {quantity.name}[...][1,1]"
    raise QuantityError(f"{text} is a matrix", allowed="allowed: a scalar here", remedy=remedy)


def same_form(a: Expression, b: Expression) -> bool:
    """Whether trees agree, flattened and with rational factors in front: c1*(a + b) has not the form of a*c1 + b*c1."""
    return form_of(a) == form_of(b)


def form_of(e: Expression) -> tuple[Fraction, Shape]:
    """The form of an expression: two that have the same one are equal values."""
    match e:
        case Number(value):
            return value, ONE
        case Pi():
            return UNIT, ("pi",)
        case Name(name):
            return UNIT, ("name", name)
        case Sum():
            return _form_of_sum(e)
        case Product() | Power():
            return _form_of_product(e)
        case Call(function, arguments):
            forms = tuple(form_of(a) for a in arguments)
            is_turned = function in _PARITY and forms[0][0] < 0  # cos(q2 - q1) = cos(q1 - q2)
            forms = ((-forms[0][0], forms[0][1]),) if is_turned else forms
            texts = (f"{k} {_text(shape)}" for k, shape in forms)
            return Fraction(_PARITY[function]) if is_turned else UNIT, ("call", function, *texts)


def _form_of_product(e: Product | Power) -> tuple[Fraction, Shape]:
    factor = UNIT
    factors: dict[str, tuple[int, Shape]] = {}
    # powers of the same base are joined, so that the order and the grouping of factors do not count
    for base, exponent in _flat_factors(e, 1):
        k, shape = form_of(base)
        factor = factor if k is UNIT else factor * k**exponent if k else k
        for text, power, part in shape[1:] if shape[0] == "*" else ((_text(shape), 1, shape),):
            factors[text] = factors.get(text, (0,))[0] + power * exponent, part
    kept = sorted((text, power, part) for text, (power, part) in factors.items() if power)
    if len(kept) == 1 and kept[0][1] == 1:
        return factor, kept[0][2]
    return factor, ("*", *kept)


def _text(shape: Shape) -> str:
    """A form in writing: forms hold names, numbers and tuples, which have no order among each other."""
    return ",".join([part if isinstance(part, str) else f"{part[0]}:{part[1]}" for part in shape]).join("()")


def _flat_factors(e: Expression, exponent: int) -> list[tuple[Expression, int]]:
    """Bases and exponents of the flattened product."""
    if isinstance(e, Product):
        return [pair for f in e.factors for pair in _flat_factors(f, exponent)]
    return _flat_factors(e.base, exponent * e.exponent) if isinstance(e, Power) else [(e, exponent)]


def _form_of_sum(e: Sum) -> tuple[Fraction, Shape]:
    terms: list[tuple[str, Fraction, Shape]] = []
    for term in e.terms:
        k, shape = form_of(term)
        if shape[0] == "+":
            terms.extend((text, k * inner, s) for text, inner, s in shape[1:])
        elif k:
            terms.append((_text(shape), k, shape))
    if len(terms) < 2:
        return terms[0][1:] if terms else (Fraction(0), ONE)
    terms.sort()
    # the rational that leaves whole numbers without a common factor, the first of them positive
    content = Fraction(gcd(*(k.numerator for _, k, _ in terms)), lcm(*(k.denominator for _, k, _ in terms)))
    if terms[0][1] < 0:
        content = -content
    return content, ("+", *((text, int(k / content), s) for text, k, s in terms))
