"""Formulas with divisions as exact quotients of polynomials, so that equality is decided by cross-multiplication.

The ring of a robot is a domain: n1/d1 = n2/d2 exactly where n1*d2 - n2*d1 = 0. What is not algebraic (atan2, sign)
enters as a symbol of its own, named after its argument.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from derive.algebra.atoms import Atoms, canonical, collect
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.errors import CheckError
from derive.robot.expression import Call, Expression, Name, Power, Product, Sum, children, substitute, to_text
from derive.robot.robot import Robot

MAX_TERMS = 50_000
"""Budget of one product; beyond it formulas are compared at points."""

MAX_DENOMINATORS = 64
"""Different denominators are all multiplied together; with more of them formulas are compared at points."""

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
    """A ring that can hold some formulas of one robot, and the way of a formula into it.

    Args:
        robot: The robot.
        formulas: Every expression that will be asked for.

    Attributes:
        faithful: Whether different polynomials are certainly different functions: no roots, nothing that is not
            algebraic, no constant angles but multiples of pi/4 and pi/6.

    Raises:
        CheckError: A root of an expression that divides by zero.
        ExpressionError: An angle outside what the ring can hold.
        TooManyTerms: A polynomial beyond the budget.
    """

    def __init__(self, robot: Robot, formulas: Iterable[Expression]) -> None:
        given = list(formulas)
        if sum(map(_denominators, given)) > MAX_DENOMINATORS:
            raise TooManyTerms(MAX_TERMS)
        self._renamed = _split_angles(robot, given)
        renamed = [substitute(e, self._renamed) for e in given]
        algebraic = [_opaque(e) for e in renamed]
        plain = [_without_division(e) for e in algebraic]
        self.faithful = algebraic == renamed and _is_faithful(collect(plain, ()))
        self.domain = PolynomialDomain(robot, plain, max_terms=MAX_TERMS)
        for generator in self.domain.generators:
            if generator.kind is Kind.INVERSE and not self.domain.constant(generator.argument):
                raise _division_by_zero(generator.argument)

    def quotient(self, formula: Expression) -> Quotient:
        """The formula as a quotient of polynomials.

        Raises:
            CheckError: A denominator is zero.
        """
        return self._value(_opaque(substitute(formula, self._renamed)))

    def difference(self, ours: Expression, theirs: Expression) -> Polynomial:
        """A polynomial that is zero exactly where the formulas are equal wherever both are defined."""
        a, b = self.quotient(ours), self.quotient(theirs)
        if a.denominator == b.denominator:
            return self._settled(a.numerator - b.numerator)
        return self._settled(a.numerator * b.denominator - b.numerator * a.denominator)

    def _value(self, e: Expression) -> Quotient:
        match e:
            case Sum(terms):
                return self._sum([self._value(term) for term in terms])
            case Product(factors):
                return self._product([self._value(factor) for factor in factors])
            case Power(base, exponent):
                return self._power(self._value(base), exponent, base)
            case Call("tan", (argument,)):
                cosine, sine = self.domain.cosine_sine(argument)
                return Quotient(sine, self._nonzero(cosine, e))
            case _:
                return Quotient(self.domain.constant(e), self.domain.ring.one)

    def _sum(self, terms: list[Quotient]) -> Quotient:
        """Terms without a denominator first: they need no cross-multiplication."""
        total = Quotient(self.domain.ring.zero, self.domain.ring.one)
        for term in sorted(terms, key=lambda t: len(t.denominator)):
            total = total + term
        return total

    def _product(self, factors: list[Quotient]) -> Quotient:
        total = Quotient(self.domain.ring.one, self.domain.ring.one)
        for factor in factors:
            total = total * factor
        return total

    def _power(self, base: Quotient, exponent: int, e: Expression) -> Quotient:
        if exponent < 0:
            base = Quotient(base.denominator, self._nonzero(base.numerator, e))
        return Quotient(base.numerator ** abs(exponent), base.denominator ** abs(exponent))

    def _nonzero(self, p: Polynomial, e: Expression) -> Polynomial:
        settled = self._settled(p)
        if not settled:
            raise _division_by_zero(e)
        return settled

    def _settled(self, p: Polynomial) -> Polynomial:
        """Fully reduced: squares of roots may bring back squares of sines."""
        while (again := p.ring.wrap(p.raw)) != p:
            p = again
        return p


def _division_by_zero(e: Expression) -> CheckError:
    return CheckError(f"division by zero: {to_text(e)[:80]} is zero everywhere")


def _opaque(e: Expression) -> Expression:
    """The tree with atan2 and sign replaced by symbols named after their arguments; no user's name has brackets."""
    match e:
        case Sum(terms):
            return Sum(tuple(_opaque(t) for t in terms))
        case Product(factors):
            return Product(tuple(_opaque(f) for f in factors))
        case Power(base, exponent):
            return Power(_opaque(base), exponent)
        case Call(function, arguments) if function in NOT_ALGEBRAIC:
            return Name(to_text(Call(function, tuple(canonical(a) for a in arguments))))
        case Call(function, arguments):
            return Call(function, tuple(_opaque(a) for a in arguments))
        case _:
            return e


def _without_division(e: Expression) -> Expression:
    """A tree with the same irrational pieces, but denominators as factors: quotients need no inverses."""
    match e:
        case Sum(terms):
            return Sum(tuple(_without_division(t) for t in terms))
        case Product(factors):
            return Product(tuple(_without_division(f) for f in factors))
        case Power(base, exponent):
            return Power(_without_division(base), abs(exponent))
        case Call("tan", (argument,)):
            return Call("cos", (argument,))
        case _:
            return e


def _denominators(e: Expression) -> int:
    divides = isinstance(e, Power) and e.exponent < 0
    own = divides or (isinstance(e, Call) and e.function == "tan")
    return int(own) + sum(map(_denominators, children(e)))


def _split_angles(robot: Robot, formulas: Iterable[Expression]) -> dict[str, Expression]:
    """Joint angles of which fractions occur, cos(q1/2): they get sines and cosines of their own."""
    units = collect((_without_division(_opaque(e)) for e in formulas), ()).units
    revolute = {joint.variable for joint in robot.joints if joint.is_revolute}
    return {
        unit.name: Name(f"({unit.name})")
        for unit, divisor in units.items()
        if isinstance(unit, Name) and unit.name in revolute and divisor > 1
    }


def _is_faithful(atoms: Atoms) -> bool:
    plain_units = all(isinstance(unit, Name) for unit in atoms.units)
    return plain_units and not atoms.roots and not atoms.pi_rests and not atoms.inverses
