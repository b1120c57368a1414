"""Exact constants of tapes: rationals as rationals, all others to 256 bits until they are printed.

A constant that is not rational (sqrt(2)/2, cos(1), 3*pi) is kept to 256 bits and compared in its first 160: values
that are equal by algebra, such as (sqrt(2)/2)**2 and 1/2, are the same constant, and a difference that cancels that
far is zero.
"""

import copyreg
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial, reduce
from math import inf, isinf, isqrt
from typing import Any

import mpmath

from derive.errors import QuantityError
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, names

_CONTEXT = mpmath.MPContext()
_CONTEXT.prec = 256
_COMPARED_BITS = 160
# A 256-bit number with so few bits is taken for the rational that it looks like: (sqrt(2)/2)**2 for 1/2.
_RATIONAL_BITS = 64
_MAX_RATIONAL_SIZE = 8192  # bits of a rational; beyond them exactness costs more than it is worth
# A Fraction, or an mpmath number of the private context; zero and rationals are always Fractions.
Constant = Fraction | Any
Key = tuple[int, int, int]


def key_of(value: Constant) -> Key:
    """What tells two constants apart."""
    if isinstance(value, Fraction):
        return (0, value.numerator, value.denominator)
    sign, mantissa, exponent, _ = _rounded(value)
    return (1, -mantissa if sign else mantissa, exponent)


def to_float(value: Constant) -> float:
    """The nearest double."""
    try:
        number = float(value)
    except OverflowError:
        number = inf
    if isinf(number):
        raise QuantityError("a constant of the robot is too large for a double", remedy="rescale the units")
    return number


def pi() -> Constant:
    """The constant pi."""
    return _settle(+_CONTEXT.pi, 1)


def add(a: Constant, b: Constant) -> Constant:
    """The sum of two constants."""
    if isinstance(a, Fraction) and isinstance(b, Fraction):
        return _bounded(a + b)
    # what cancels is compared with the terms, not with the sum: sqrt(2) - sqrt(2) is zero but for the last bits
    x, y = _real(a), _real(b)
    return _settle(x + y, max(abs(x), abs(y)))


def multiply(a: Constant, b: Constant) -> Constant:
    """The product of two constants."""
    if isinstance(a, Fraction) and isinstance(b, Fraction):
        return _bounded(a * b)
    return _settle(_real(a) * _real(b), 0)


def reciprocal(a: Constant) -> Constant:
    """The reciprocal, 1/a."""
    if a == 0:
        raise _no_value("division by zero")
    return 1 / a if isinstance(a, Fraction) else _settle(1 / a, 0)


def square_root(a: Constant) -> Constant:
    """The square root."""
    if a < 0:
        raise _no_value("square root of a negative number")
    if isinstance(a, Fraction):  # the root of a square of rationals is rational
        top, bottom = isqrt(a.numerator), isqrt(a.denominator)
        if top * top == a.numerator and bottom * bottom == a.denominator:
            return Fraction(top, bottom)
    return _settle(_CONTEXT.sqrt(_real(a)), 0)


def sine(a: Constant) -> Constant:
    """The sine."""
    return _settle(_CONTEXT.sin(_real(a)), _uncertainty(a))


def cosine(a: Constant) -> Constant:
    """The cosine."""
    return _settle(_CONTEXT.cos(_real(a)), _uncertainty(a))


def arctangent(y: Constant, x: Constant) -> Constant:
    """The angle of a point of the plane [rad]."""
    return _settle(_CONTEXT.atan2(_real(y), _real(x)), 0)


def less(a: Constant, b: Constant) -> bool:
    """Whether one constant is less than another."""
    return bool(_real(a) < _real(b))


def _no_value(what: str) -> QuantityError:
    found = f"{what} in a cell once the parameters have their numbers"
    return QuantityError(found, remedy="change the parameter or name it in runtime")


def _real(value: Constant) -> Any:
    return _CONTEXT.mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else value


def _bounded(value: Fraction) -> Constant:
    """A rational that has grown past all use becomes a 256-bit number."""
    if value.numerator.bit_length() + value.denominator.bit_length() > _MAX_RATIONAL_SIZE:
        return _settle(_real(value), 0)
    return value


def _uncertainty(angle: Constant) -> Any:
    """Scale below which a sine or cosine is taken for zero: that of a rational angle other than 0 never is zero."""
    # an algebraic angle has a transcendental sine (Lindemann); one with pi in it may be a multiple of pi/2
    return 0 if isinstance(angle, Fraction) else max(1, abs(angle))


def _settle(value: Any, scale: Any) -> Constant:
    """Recognise zero and short rationals."""
    # below the compared bits of the terms it is made of, a value is zero
    if abs(value) <= scale * _CONTEXT.ldexp(1, -_COMPARED_BITS):
        return Fraction(0)
    # a binary fraction of few bits came from an identity, (sqrt(2)/2)^2, not by chance: 2^-96 is the odds against it
    sign, mantissa, exponent, bits = _rounded(value)
    if bits <= _RATIONAL_BITS and abs(exponent) <= _MAX_RATIONAL_SIZE:
        return Fraction(-mantissa if sign else mantissa) * Fraction(2) ** exponent
    return value


def _restored(sign: int, mantissa: int, exponent: int, bits: int) -> Constant:
    return _CONTEXT.make_mpf((sign, mpmath.libmp.MPZ(mantissa), exponent, bits))


def _parts(value: Any) -> tuple[Callable[..., Constant], tuple[int, ...]]:
    """A constant as another process gets it: numbers of a private context are none that `pickle` finds by name."""
    return _restored, tuple(map(int, value._mpf_))


copyreg.pickle(_CONTEXT.mpf, _parts)


def _rounded(value: Any) -> tuple[int, int, int, int]:
    """Sign, mantissa, exponent and bits of the compared part."""
    sign, mantissa, exponent, bits = mpmath.libmp.mpf_pos(value._mpf_, _COMPARED_BITS, "n")
    return int(sign), int(mantissa), int(exponent), int(bits)


def exact_number(expression: Expression, numbers: Mapping[str, Expression]) -> Constant | None:
    """The number behind a cell of the robot file; None where a name in the cell has none."""
    if not all(name in numbers and not any(True for _ in names(numbers[name])) for name in names(expression)):
        return None
    return _evaluate(expression, numbers)


def _evaluate(expression: Expression, numbers: Mapping[str, Expression]) -> Constant:
    value_of = partial(_evaluate, numbers=numbers)
    match expression:
        case Number(value):
            return value
        case Pi():
            return pi()
        case Name(name):
            return value_of(numbers[name])
        case Sum(terms):
            return reduce(add, map(value_of, terms), Fraction(0))
        case Product(factors):
            return reduce(multiply, map(value_of, factors), Fraction(1))
        case Power(base, exponent):
            power = reduce(multiply, [value_of(base)] * abs(exponent), Fraction(1))
            return reciprocal(power) if exponent < 0 else power
        case Call("tan", (angle,)):
            return multiply(sine(value_of(angle)), reciprocal(cosine(value_of(angle))))
        case Call(function, arguments):
            if function not in _FUNCTIONS:
                raise QuantityError(f"'{function}' is not allowed in a cell", allowed="allowed: sin, cos, tan, sqrt")
            return _FUNCTIONS[function](value_of(arguments[0]))


_FUNCTIONS: Mapping[str, Callable[[Constant], Constant]] = {"sin": sine, "cos": cosine, "sqrt": square_root}
