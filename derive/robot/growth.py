"""How many terms an expression may have when it is multiplied out: an upper bound, found without doing it."""

from __future__ import annotations

from math import comb, prod

from derive.robot.expression import Call, Expression, Power, Product, Sum


def expanded_terms(expression: Expression, stop: int) -> int:
    """Upper bound of the number of terms of the expanded expression, and of any function's argument.

    A power of a sum of t terms has ``comb(t + e - 1, e)`` terms; denominators count like numerators.

    Args:
        expression: Any tree.
        stop: Results beyond it are returned as ``stop + 1``.
    """
    match expression:
        case Sum(terms):
            count = sum(expanded_terms(term, stop) for term in terms)
        case Product(factors):
            count = _bounded_product([expanded_terms(factor, stop) for factor in factors], stop)
        case Power(base, exponent):
            width = expanded_terms(base, stop)
            count = 1 if width == 1 else comb(width + abs(exponent) - 1, abs(exponent))
        case Call(_, arguments):
            inner = max(expanded_terms(argument, stop) for argument in arguments)
            count = inner if inner > stop else 1
        case _:
            count = 1
    return min(count, stop + 1)


def _bounded_product(counts: list[int], stop: int) -> int:
    large = [count for count in counts if count > 1]
    bits = sum(count.bit_length() - 1 for count in large)
    return stop + 1 if bits > stop.bit_length() else prod(large)
