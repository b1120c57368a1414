"""Which irrational pieces a set of expressions needs: angle units, roots, inverses and names.

The ring must know its generators before any expression can become a polynomial, so the expressions are read twice:
here for what they contain, in `derive.algebra.domain` for what they are.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from math import isqrt, lcm

from derive.algebra.angles import ExactAngle, decompose
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, children

MAX_MULTIPLE = 24
"""Largest multiple of one angle unit that is expanded by the addition theorem."""


MAX_UNITS = 4
"""Most constant units of one angle that are told apart; a longer sum is one unit."""


def canonical(e: Expression) -> Expression:
    """The tree with the terms of sums and the factors of products in a fixed order."""
    match e:
        case Sum(terms):
            return Sum(tuple(sorted((canonical(t) for t in terms), key=repr)))
        case Product(factors):
            return Product(tuple(sorted((canonical(f) for f in factors), key=repr)))
        case Power(base, exponent):
            return Power(canonical(base), exponent)
        case Call(function, arguments):
            return Call(function, tuple(canonical(a) for a in arguments))
        case _:
            return e


def split_pi(multiple: Fraction) -> tuple[int, Fraction]:
    """multiple = quarter/2 + rest with rest in (-1/4, 1/4]; quarter counts right angles."""
    quarter = round(multiple * 2)
    rest = multiple - Fraction(quarter, 2)
    if rest == Fraction(-1, 4):
        quarter, rest = quarter - 1, Fraction(1, 4)
    return quarter % 4, rest


SPECIAL: dict[Fraction, tuple[int, ...]] = {
    Fraction(0): (),
    Fraction(1, 4): (2,),
    Fraction(1, 6): (3,),
    Fraction(1, 12): (2, 3),
}
"""Angles (multiples of pi, up to sign and right angles) whose cosine and sine are square roots of these primes."""


def square_free(value: Fraction) -> tuple[Fraction, tuple[int, ...]]:
    """sqrt(value) = factor * product of sqrt(p); trial division, a large cofactor counts as prime."""
    number = value.numerator * value.denominator
    factor, primes = Fraction(1, value.denominator), []
    p = 2
    while p * p <= number and p < 10_000:
        while number % (p * p) == 0:
            number //= p * p
            factor *= p
        if number % p == 0:
            number //= p
            primes.append(p)
        p += 1
    root = isqrt(number)
    if root * root == number:
        return factor * root, tuple(primes)
    return factor, (*primes, number)


@dataclass
class Atoms:
    """What `collect` found, in order of first appearance.

    Attributes:
        joints: Names of joint angles, given.
        names: Plain symbols.
        units: Angle units, each with the common denominator of its coefficients.
        multiples: The absolute coefficients that occur of each unit.
        pi_rests: Constant angles rest*pi in (0, 1/4) that are not special.
        primes: Primes whose square roots are needed.
        roots: Radicands of the other square roots, innermost first.
        inverses: Denominators, innermost first.
        has_pi: Whether pi occurs outside of angles.
    """

    joints: frozenset[str] = frozenset()
    names: dict[str, None] = field(default_factory=dict)
    units: dict[Expression, int] = field(default_factory=dict)
    multiples: dict[Expression, dict[Fraction, None]] = field(default_factory=dict)
    pi_rests: dict[Fraction, None] = field(default_factory=dict)
    primes: dict[int, None] = field(default_factory=dict)
    roots: dict[Expression, None] = field(default_factory=dict)
    inverses: dict[Expression, None] = field(default_factory=dict)
    has_pi: bool = False

    def angle(self, e: Expression) -> None:
        """Record what the sine and cosine of an angle need."""
        exact = bundled(decompose(canonical(e)), self.joints)
        self._pi_multiple(exact)
        for unit, k in exact.terms:
            if unit == Number(Fraction(1)):
                unit, k = Number(abs(k)), Fraction(1)
            self.units[unit] = lcm(self.units.get(unit, 1), k.denominator)
            self.multiples.setdefault(unit, {})[abs(k)] = None

    def is_common(self, unit: Expression) -> bool:
        """Whether all multiples of a unit are expanded by the addition theorem from one common part."""
        return max(self.multiples[unit]) * self.units[unit] <= MAX_MULTIPLE

    def _pi_multiple(self, exact: ExactAngle) -> None:
        _, rest = split_pi(exact.pi_multiple)
        if abs(rest) in SPECIAL:
            self.primes.update(dict.fromkeys(SPECIAL[abs(rest)]))
        else:
            self.pi_rests[abs(rest)] = None

    def value(self, e: Expression) -> None:
        """Record what an expression needs."""
        match e:
            case Pi():
                self.has_pi = True
            case Name(name):
                self.names[name] = None
            case Power(base, exponent):
                self.value(base)
                if exponent < 0 and not isinstance(base, Number):
                    self._inverse(base)
            case Call(function, (argument,)):
                self._call(function, argument)
            case _:
                for child in children(e):
                    self.value(child)

    def _call(self, function: str, argument: Expression) -> None:
        if function == "sqrt":
            self._root(argument)
            return
        self.angle(argument)
        if function == "tan":
            self._inverse(Call("cos", (argument,)))

    def _root(self, argument: Expression) -> None:
        if isinstance(argument, Number):
            if argument.value > 0:
                self.primes.update(dict.fromkeys(square_free(argument.value)[1]))
            return
        self.value(argument)
        self.roots[canonical(argument)] = None

    def _inverse(self, base: Expression) -> None:
        self.inverses[canonical(base)] = None


def bundled(exact: ExactAngle, joints: frozenset[str]) -> ExactAngle:
    """The angle with its constant units as one, where there are so many that their addition theorem explodes."""
    constant = [(u, k) for u, k in exact.terms if not (isinstance(u, Name) and u.name in joints)]
    if len(constant) <= MAX_UNITS:
        return exact
    moving = [term for term in exact.terms if term not in constant]
    whole = canonical(Sum(tuple(Product((Number(k), u)) for u, k in constant)))
    return ExactAngle(exact.pi_multiple, (*moving, (whole, Fraction(1))))


def collect(values: Iterable[Expression], angles: Iterable[Expression], joints: frozenset[str] = frozenset()) -> Atoms:
    """The atoms of some cell values and some constant angles, in a ring that has these joint angles."""
    atoms = Atoms(joints)
    for e in angles:
        atoms.angle(e)
    for e in values:
        atoms.value(e)
    return atoms
