"""Which singularities of an arm are seen in its inverse kinematics: where two values of a joint become one, or free.

At a zero of a factor of det J solutions meet, or are infinitely many. Which step of the derivation this happens in is
found by looking: the factor is brought to zero at random configurations, and the conditions of every step are computed
at the poses that the arm then has.
"""

import random
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import product
from typing import Any

import mpmath
import sympy

from derive.inverse.numeric.in_numbers import Numbers, parameter_numbers
from derive.inverse.words.elementary import Sign
from derive.inverse.words.solutions import InverseKinematics
from derive.lecture.point import DIGITS, value_of
from derive.lecture.sympy_conversion import Expr
from derive.model.singularities.singularities import SingularFactor

LOOKED_AT = 3  # zeros of a factor that are looked at
# Below it a condition of a step is zero: a square root halves the digits of a zero of the factor.
_VANISHES = mpmath.mpf(10) ** -12
_TRIES = 40
_GRID = 24  # intervals of a joint's way in which a factor is looked for a change of its sign


def coincidences(
    found: InverseKinematics, factors: Sequence[SingularFactor]
) -> tuple[tuple[tuple[SingularFactor, ...], tuple[SingularFactor, ...]], ...]:
    """For each step the factors of det J at whose zeros its two values are one, and those at whose zeros it is free."""
    moving = [factor for factor in factors if factor.condition is not None]
    places = [(factor, list(_zeros(found, factor))) for factor in moving]

    def _where_zero(conditions: Sequence[Expr]) -> tuple[SingularFactor, ...]:
        vanishing = []
        for factor, zeros in places if conditions else ():
            pairs = product(conditions, zeros)
            with mpmath.workdps(DIGITS), suppress(ArithmeticError, ValueError):  # what has no value is not zero
                if zeros and all(abs(value_of(e, known)) < _VANISHES for e, known in pairs):
                    vanishing.append(factor)
        return tuple(vanishing)

    # Values of a step become one where its condition, an inequality, holds with equality.
    merged = (() if step.exists is sympy.true else (step.exists.lhs - step.exists.rhs,) for step in found.steps)
    return tuple((_where_zero(own), _where_zero(step.free)) for own, step in zip(merged, found.steps, strict=True))


def _zeros(found: InverseKinematics, factor: SingularFactor) -> Iterator[Numbers]:
    """Numbers of everything that is named, at configurations at which a factor is zero."""
    rng, seen = random.Random(5), 0
    variables = [sympy.Symbol(joint.variable) for joint in found.robot.joints]
    with mpmath.workdps(DIGITS):
        for _ in range(_TRIES):
            values = parameter_numbers(found.robot, rng)
            q = {symbol: mpmath.mpf(rng.randint(-300, 300)) / 101 for symbol in variables}
            joint = variables[factor.condition.joints[-1] - 1] if factor.condition else variables[-1]
            zero = _zero(factor.expression, {**values, **q}, joint)
            if zero is not None:
                yield _known(found, values, {**q, joint: zero})
                seen += 1
            if seen == LOOKED_AT:
                return


def _zero(expression: Expr, known: Numbers, joint: Expr) -> Any:
    """A zero of an expression in one joint variable, by halving an interval; None where its sign does not change."""
    # A little more than a full turn, so that no change of sign lies at its ends.
    grid = [mpmath.mpf(7 * k) / _GRID - mpmath.mpf("3.4") for k in range(_GRID + 1)]
    values = [value_of(expression, {**known, joint: x}) for x in grid]
    size = max(map(abs, values))
    for k in range(_GRID):
        if values[k] * values[k + 1] < 0:
            ends, tolerance = (grid[k], grid[k + 1]), mpmath.mpf(10) ** -(2 * 28)
            return mpmath.findroot(
                lambda x: value_of(expression, {**known, joint: x}) / size, ends, solver="anderson", tol=tolerance
            )
    return None


def _known(found: InverseKinematics, values: Numbers, q: Numbers) -> Numbers:
    """Numbers of pose, joint variables, their sums and all named quantities; a choice of sign is plus."""
    known = found.values_at(values, q) | q
    known |= {name: value_of(total, known) for total, name in found.sums.items()}
    for line in found.lines:
        signs: Numbers = {symbol: mpmath.mpf(1) for symbol in line.value.free_symbols if isinstance(symbol, Sign)}
        if line.symbol.is_Symbol and line.symbol not in known:
            try:
                known[line.symbol] = value_of(line.value, {**known, **signs})
            except (ArithmeticError, ValueError):  # a root that vanishes here is negative by rounding
                known[line.symbol] = mpmath.mpf(0)
    return known
