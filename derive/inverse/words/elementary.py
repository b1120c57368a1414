"""How textbooks write the solution of one elementary equation: a few lines with named quantities.

``D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2)``, ``theta2 = atan2(+-sqrt(1 - D**2), D)``: an angle is an atan2, never an
arc cosine, and every choice of a sign stands in one line. The types are those of Khalil and Dombre, Modeling,
Identification and Control of Robots, 2002, chapter 4; the forms are those of Craig, Spong and Siciliano.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from math import prod
from typing import Any

import numpy as np
import sympy

from derive.algebra.ring import Polynomial, in_lowest_terms
from derive.lecture.sympy_conversion import Expr

LONGEST_ARGUMENTS = 12  # operations of both arguments of an atan2 together; longer ones stand on lines of their own
LONGEST_INLINE = 3  # operations of a quantity that is written where it is used; a longer one gets a name
Write = Callable[[Polynomial], Expr]
Linear = tuple[Polynomial, Polynomial, Polynomial]  # (A, B, C) of A cos + B sin = C
Numbers = dict[Expr, Any]  # numbers by symbol
_FUNCTIONS: Mapping[Any, Callable[..., Any]] = {sympy.sin: np.sin, sympy.cos: np.cos, sympy.atan2: np.arctan2}


class Sign(sympy.Symbol):  # type: ignore[misc]
    """+1 or -1: the choice between two solutions, printed as a plus-minus sign."""

    __slots__ = ()


@dataclass(frozen=True)
class PrintedLine:
    """One line of a solution: ``symbol = value``."""

    symbol: Expr  # a named quantity, a joint variable, a sum of them, or the sine or cosine of one
    value: Expr  # in the pose, the parameters, what the lines before it give, and signs

    @property
    def signs(self) -> tuple[Sign, ...]:
        """The choices that are made in it."""
        return tuple(sorted((s for s in self.value.free_symbols if isinstance(s, Sign)), key=str))

    @property
    def alternatives(self) -> tuple[Expr, ...]:
        """Its values for both signs where a sign stands in it more than once, else the value as it is."""
        signs = self.signs
        if len(signs) == 1 and self.value.count(signs[0]) > 1:
            return tuple(self.value.xreplace({signs[0]: sympy.Integer(e)}) for e in (1, -1))
        return (self.value,)


@dataclass(frozen=True)
class Solved:
    """What an equation gives."""

    value: Expr  # the unknown
    exists: Expr = sympy.true  # the condition that it exists (SymPy's true where it always does)


@dataclass
class Scribe:
    """Writes the lines of one arm's solution, in order."""

    write: Write  # writes a polynomial
    taken: set[str]  # names that are in use: those of the robot, of the pose, and what has been named
    moves: Callable[[Polynomial], bool]  # whether a polynomial holds more than parameters
    lines: list[PrintedLine] = field(default_factory=list)  # the lines so far
    sums: dict[Expr, Expr] = field(default_factory=dict)  # names of the sums of angles that have been found

    def name(self, letters: Iterable[str], label: str = "") -> str:
        """A name that nothing has yet: the first free letter, else one with a label, else with a number."""
        letters = tuple(letters)
        numbered = (f"{letters[0]}_{k}" for k in range(1, len(self.taken) + 2))
        candidates = (*letters, *(f"{letter}_{label}" for letter in letters if label), *numbered)
        found = next(name for name in candidates if name not in self.taken)
        self.taken.add(found)
        return found

    def named(self, value: Expr, letters: Iterable[str], label: str, longest: int = LONGEST_INLINE) -> Expr:
        """A symbol for a value, or the value itself where it is short."""
        if operations(value) <= longest:
            return value
        symbol = sympy.Symbol(self.name(letters, label))
        self.lines.append(PrintedLine(symbol, value))
        return symbol

    def ratio(self, above: Polynomial, below: Polynomial) -> Expr:
        """A quotient without common factors, ``(x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2)``."""
        above, below = reduced(above, below)
        if below == 1:
            return self.write(above)
        if len(above) == 1:
            return self.write(above) / self.write(below)
        return sympy.Mul(1 / self.write(below), self.write(above), evaluate=not below.is_constant)

    def simplest(self, polynomials: Linear) -> Linear:
        """An equation divided by its common factor, with as few minus signs as may be."""
        ring = polynomials[0].ring
        common = reduce(lambda p, q: p.gcd(q), (p.raw for p in polynomials if p))
        a, b, c = (ring.wrap(p.raw / common) for p in polynomials)
        signs = sum(minus_signs(self.write(p)) for p in (a, b, c))
        return (-a, -b, -c) if signs > sum(minus_signs(self.write(-p)) for p in (a, b, c)) else (a, b, c)

    def one_equation(self, label: str, equation: Linear) -> Solved:
        """A cos + B sin = C (type 2): two angles.

        With a sine or cosine alone it is known and the other is a root. Else the equation says that the angle differs
        by a known one from that of the vector (-B, A) (Craig, Introduction to Robotics, section 4.7).
        """
        a, minus_b, c = self.simplest((equation[0], -equation[1], equation[2]))
        sign = Sign(self.name((f"epsilon_{label}",)))
        # A cos + B sin = 0: atan2(+-A, -+B).
        if not c:
            return Solved(_atan2(sign * self.write(a), sign * self.write(minus_b)))
        if not a or not minus_b:
            known = self.named(self.ratio(c, a or -minus_b), ("D", "E", "F"), label, longest=1)
            root = sign * sympy.sqrt(1 - known**2)
            return Solved(_atan2(root, known) if a else _atan2(known, root), sympy.Abs(known) <= 1)
        # Both without their common factor; one that moves is kept: with its sign the two solutions would change places.
        ring, raw = a.ring, a.raw.gcd(minus_b.raw)
        if self.moves(ring.wrap(raw)):
            raw = ring.one.raw
        a, minus_b = ring.wrap(a.raw / raw), ring.wrap(minus_b.raw / raw)
        sizes = {abs(coefficient) for p in (a, minus_b) for _, coefficient in p.terms()}
        size = sizes.pop() if len(sizes) == 1 else Fraction(1)
        a, minus_b, common = a * (1 / size), minus_b * (1 / size), ring.wrap(raw) * size
        # A cos + B sin = K: the angle of (-B, A) less atan2(K, +-sqrt(A^2 + B^2 - K^2)) (Craig, section 4.7).
        along = self.named(self.ratio(c, common), ("K", "k", "L"), label)
        square, (y, x) = self.write(a * a + minus_b * minus_b), (self.write(a), self.write(minus_b))
        if operations(square) > LONGEST_ARGUMENTS:
            y, x = self.named(y, ("A", "M", "G"), label), self.named(x, ("B", "N", "H"), label)
            square = x**2 + y**2
        root = self.named(sign * sympy.sqrt(square - along**2), ("r", "rho", "h"), label, longest=LONGEST_ARGUMENTS)
        towards, apart = _atan2(y, x), _atan2(along, root)
        if is_negative(along):
            apart = -_atan2(-along, root)
        return Solved(towards - apart, square >= along**2)

    def two_equations(self, unknown: Expr, label: str, first: Linear, second: Linear) -> Expr:
        """A cos + B sin = C twice (type 3): one angle, where one is the other turned as a difference of atan2."""
        (a, b, c), (d, e, g) = self.simplest(first), self.simplest(second)
        if not b and not d:
            return self._quotients(unknown, label, (g, e), (c, a))
        if not a and not e:
            return self._quotients(unknown, label, (c, b), (g, d))
        # Cramer's rule; a divisor that is a sum of squares drops out of the atan2.
        determinant = a * e - b * d
        above = (a * g - c * d, c * e - b * g)
        if (e == a and d == -b) or (e == -a and d == b):
            if e == -a:
                g, above = -g, (-above[0], -above[1])
            together = _atan2(*map(self.write, above))
            apart = self._turned(g, c) - self._turned(-b, a)
            from_axis_y = (self._turned(a, -b) - self._turned(c, g), self._turned(c, -g) - self._turned(a, b))
            return min((together, apart, *from_axis_y), key=lambda e: (e.count_ops(), e.count(sympy.atan2)))
        return self._quotients(unknown, label, (above[0], determinant), (above[1], determinant))

    def _turned(self, sine: Polynomial, cosine: Polynomial) -> Expr:
        """An atan2, or the name of its angle; of a sine with a minus sign it has the minus sign in front."""
        negative = is_negative(self.write(sine))
        found = _atan2(self.write(-sine if negative else sine), self.write(cosine))
        arc: Expr = self.sums.get(found, found)
        return -arc if negative else arc

    def _quotients(
        self, unknown: Expr, label: str, sine: tuple[Polynomial, Polynomial], cosine: tuple[Polynomial, Polynomial]
    ) -> Expr:
        """The angle of a sine and a cosine that are quotients; a positive number is left out of both."""
        one = sine[1].ring.one
        exact = sine[1].is_constant and cosine[1].is_constant
        if exact:
            sine, cosine = ((p * (1 / q.constant_term), one) for p, q in (sine, cosine))
        values = [self.ratio(*sine), self.ratio(*cosine)]
        if sum(map(operations, values)) <= LONGEST_ARGUMENTS:
            return _atan2(*values)
        if exact:
            names = (sympy.sin(unknown), sympy.cos(unknown))
            self.lines += [PrintedLine(name, value) for name, value in zip(names, values, strict=True)]
            return sympy.atan2(*names, evaluate=False)
        pairs = zip(values, (("Y", "V"), ("X", "U")), strict=True)
        return _atan2(*(self.named(value, letters, label, longest=1) for value, letters in pairs))

    def length(self, label: str, coefficients: tuple[Polynomial, Polynomial, Polynomial]) -> Solved:
        """A r^2 + B r + C = 0: two lengths, or one where A is zero (types 1 and 4)."""
        a, b, c = self.simplest(coefficients)
        if not a:
            return Solved(self.ratio(-c, b))
        sign = Sign(self.name((f"epsilon_{label}",)))
        if not b:
            square = self.ratio(-c, a)
            return Solved(sign * sympy.sqrt(square), square >= 0)
        half = b * Fraction(1, 2)
        inside = self.named(self.write(half * half - a * c), ("Delta", "delta"), label)
        root = -self.write(half) + sign * sympy.sqrt(inside)
        return Solved(root if a == 1 else root / self.write(a), inside >= 0)


def reduced(above: Polynomial, below: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Dividend and divisor without common factors; the dividend begins with 1, or the divisor is 1."""
    above, below = in_lowest_terms(above, below)
    if below.is_constant:
        whole = above * (1 / below.constant_term)
        if len(above) == 1 or all(coefficient.denominator == 1 for _, coefficient in whole.terms()):
            return whole, above.ring.one
    scale = usual(above.terms()) * (-1 if 2 * sum(c < 0 for _, c in below.terms()) > len(below) else 1)
    return above * (1 / scale), below * (1 / scale)


def usual(terms: Iterable[tuple[tuple[int, ...], Fraction]]) -> Fraction:
    """The absolute value that most coefficients have: of squares, where there are any."""
    sizes = [(sorted(exponents)[-2:] == [0, 2], abs(coefficient)) for exponents, coefficient in terms]
    among = [size for is_square, size in sizes if is_square] or [size for _, size in sizes]
    return max(among, key=among.count)


def operations(e: Expr) -> int:
    """How many operations an expression has; sines and cosines, which are known by then, are none."""
    return int(e.count_ops()) - len(e.atoms(sympy.sin, sympy.cos))


def minus_signs(e: Expr) -> int:
    """How many terms of a sum have a minus sign."""
    return sum(bool(term.as_coeff_Mul()[0] < 0) for term in (e.args if e.is_Add else (e,)))


def is_negative(e: Expr) -> bool:
    """Whether more terms have a minus sign than not."""
    return bool(2 * minus_signs(e) > (len(e.args) if e.is_Add else 1))


def _atan2(sine: Expr, cosine: Expr) -> Expr:
    """An atan2 as it is written: SymPy would change one with a number; that of a sine and cosine is their angle."""
    if sine.func is sympy.sin and cosine.func is sympy.cos and sine.args == cosine.args:
        return sine.args[0]
    return sympy.atan2(sine, cosine, evaluate=False)


# -- lines in numbers


def array_value(e: Expr, known: Numbers) -> Any:
    """An expression as an array of floats; not a number where it has no real value."""
    if e in known:
        return known[e]
    arguments = [array_value(argument, known) for argument in e.args]
    if e.is_Number or e.is_NumberSymbol:
        found = np.float64(e)
    elif e.is_Add:
        found = sum(arguments[1:], arguments[0])
    elif e.is_Mul:
        found = prod(arguments[1:], start=arguments[0])
    elif e.is_Pow:
        found = np.sqrt(arguments[0]) if e.args[1] == sympy.S.Half else arguments[0] ** arguments[1]
    else:
        found = _FUNCTIONS[e.func](*arguments)
    known[e] = found
    return found


def with_lines(values: Numbers, lines: Iterable[PrintedLine]) -> Numbers:
    """Arrays of what is known and of lines that follow, each a symbol and its value; NaN where one has no value."""
    known = dict(values)
    with np.errstate(all="ignore"):
        for line in lines:
            known[line.symbol] = array_value(line.value, known)
    return known
