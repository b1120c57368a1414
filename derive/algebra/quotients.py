"""Formulas with divisions as exact quotients of polynomials, so that equality is decided by cross-multiplication.

The ring of a robot is a domain: n1/d1 = n2/d2 exactly where n1*d2 - n2*d1 = 0. What is not algebraic (atan2, sign)
enters as a symbol of its own, named after its argument.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import prod

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind, canonical, collect
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.errors import CheckError
from derive.robot.expression import Call, Expression, Name, Power, Product, Sum, children, rebuilt, substitute, to_text
from derive.robot.robot import Robot

# Budget of one product, which keeps a comparison to seconds; beyond it formulas are compared at points.
MAX_PRODUCT_TERMS = 50_000
# Different denominators are all multiplied together; with more of them formulas are compared at points.
MAX_DENOMINATORS = 64
NOT_ALGEBRAIC = frozenset({"atan2", "sign"})


@dataclass(frozen=True, slots=True)
class Quotient:
    """``numerator / denominator``; the denominator is not zero."""

    numerator: Polynomial
    denominator: Polynomial

    def __add__(self, other: Quotient) -> Quotient:
        if self.denominator == other.denominator:
            return Quotient(self.numerator + other.numerator, self.denominator)
        numerator = self.numerator * other.denominator + other.numerator * self.denominator
        return Quotient(numerator, self.denominator * other.denominator)

    def __mul__(self, other: Quotient) -> Quotient:
        return Quotient(self.numerator * other.numerator, self.denominator * other.denominator)


class QuotientRing:
    """A ring that can hold some formulas of one robot, and the way of a formula into it."""

    def __init__(self, robot: Robot, formulas: Iterable[Expression]) -> None:
        given = list(formulas)
        self.denominators = sum(map(_denominators, given))  # how many divisions and tangents there are
        if self.denominators > MAX_DENOMINATORS:
            raise TooManyTerms(MAX_PRODUCT_TERMS)
        # generators for what is irrational in them; denominators need none, they become polynomials of their own
        algebraic = [opaque(e) for e in given]
        plain = [_without_division(e) for e in algebraic]
        atoms = collect(plain, ())
        # joint angles of which fractions occur, cos(q1/2), get sines and cosines of their own
        joints = {joint.variable for joint in robot.variables if joint.is_revolute}
        split = [unit for unit, divisor in atoms.units.items() if isinstance(unit, Name) and divisor > 1]
        self._renamed = {unit.name: Name(f"({unit.name})") for unit in split if unit.name in joints}
        if self._renamed:
            given = [substitute(e, self._renamed) for e in given]
            algebraic = [opaque(e) for e in given]
            plain = [_without_division(e) for e in algebraic]
            atoms = collect(plain, ())
        # roots and constant angles may be related in ways that the ring does not know: sqrt(x y) = sqrt(x) sqrt(y),
        # and so are multiples of an angle too large to be expanded: cos(26 x) = 2 cos(13 x)^2 - 1
        units_are_plain = all(isinstance(unit, Name) and atoms.is_common(unit) for unit in atoms.units)
        has_others = atoms.roots or atoms.pi_rests or atoms.inverses
        # whether different polynomials are certainly different functions: no roots, nothing that is not algebraic, no
        # constant angles but multiples of pi/4 and pi/6
        self.faithful = algebraic == given and units_are_plain and not has_others
        self._robot, self._plain = robot, plain

    @cached_property
    def domain(self) -> PolynomialDomain:
        """The ring itself, which formulas that differ at a point do without."""
        domain = PolynomialDomain(self._robot, self._plain, max_terms=MAX_PRODUCT_TERMS)
        # an inverse u x = 1 of an x that is zero would make every polynomial of the ring zero
        for generator in domain.generators:
            if generator.kind is Kind.INVERSE and not domain.constant(generator.argument):
                raise _division_by_zero(generator.argument)
        return domain

    def difference(self, ours: Expression, theirs: Expression) -> Polynomial:
        """A polynomial that is zero exactly where two formulas are equal wherever both are defined."""
        a, b = (self._quotient(opaque(substitute(formula, self._renamed))) for formula in (ours, theirs))
        # n1/d1 = n2/d2 exactly where n1 d2 = n2 d1: the ring has no zero divisors
        if a.denominator == b.denominator:
            difference = a.numerator - b.numerator
        else:
            difference = a.numerator * b.denominator - b.numerator * a.denominator
        return self.domain.ring.settle(difference.raw)

    def _quotient(self, e: Expression) -> Quotient:
        one = self.domain.ring.one
        match e:
            case Sum(terms):
                # terms without a denominator first: they need no cross-multiplication
                values = sorted((self._quotient(term) for term in terms), key=lambda value: len(value.denominator))
                return sum(values, Quotient(self.domain.ring.zero, one))
            case Product(factors):
                return prod(map(self._quotient, factors), start=Quotient(one, one))
            case Power(base, exponent):
                value = self._quotient(base)
                above, below = value.numerator, value.denominator
                if exponent < 0:  # a divisor that is zero everywhere is refused, not one that vanishes somewhere
                    above, below = below, _nonzero(above, base)
                return Quotient(above ** abs(exponent), below ** abs(exponent))
            case Call("tan", (argument,)):
                cosine, sine = self.domain.cosine_sine(argument)
                return Quotient(sine, _nonzero(cosine, e))
            case _:
                return Quotient(self.domain.constant(e), one)


def _nonzero(p: Polynomial, e: Expression) -> Polynomial:
    """The polynomial of a divisor, fully reduced."""
    settled = p.ring.settle(p.raw)
    if not settled:
        raise _division_by_zero(e)
    return settled


def _division_by_zero(e: Expression) -> CheckError:
    return CheckError(f"division by zero: {to_text(e)[:80]} is zero everywhere")


def opaque(e: Expression, meanings: dict[str, Expression] | None = None) -> Expression:
    """The tree with atan2 and sign replaced by symbols named after their arguments; no user's name has brackets."""
    if isinstance(e, Call) and e.function in NOT_ALGEBRAIC:
        name = to_text(rebuilt(e, canonical, folds=False))
        if meanings is not None:
            meanings[name] = e
        return Name(name)
    return rebuilt(e, lambda part: opaque(part, meanings), folds=False)


def _without_division(e: Expression) -> Expression:
    """A tree with the same irrational pieces, but denominators as factors: quotients need no inverses."""
    match e:
        case Power(base, exponent):
            return Power(_without_division(base), abs(exponent))
        case Call("tan", (argument,)):
            return Call("cos", (argument,))
        case Call():
            return e
        case _:
            return rebuilt(e, _without_division, folds=False)


def _denominators(e: Expression) -> int:
    """How many divisions and tangents there are in a tree."""
    divides = isinstance(e, Power) and e.exponent < 0
    return int(divides or (isinstance(e, Call) and e.function == "tan")) + sum(map(_denominators, children(e)))
