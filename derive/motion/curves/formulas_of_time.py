"""Formulas of time that a joint can follow: position, velocity and acceleration finite at all times."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from sympy import Abs, Expr, Integer, Pow, cos, preorder_traversal, tan

from derive.arrays import Array
from derive.errors import QuantityError
from derive.motion.curves.extremes import refined
from derive.motion.curves.trajectory import Trajectory
from derive.plans.hermite import TIME
from derive.plans.profile import ZERO, Curve
from derive.plans.segments import Segment

# Times at which parts of a formula are looked at; zeros between two of them are found by the change of sign.
PLACES = 4001
NOTHING = 1e-12  # relative to the largest value: what is smaller is zero


def curves_of(formulas: Sequence[Expr], duration: Expr) -> Trajectory:
    """Joint variables by formulas of time that last so long [s]."""
    pieces = []
    for formula in formulas:
        velocity = formula.diff(TIME)
        pieces.append((Curve(ZERO, duration, (formula, velocity, velocity.diff(TIME))),))
    return Trajectory((Segment("curves", ZERO, duration, tuple(pieces)),))


def followed(formula: Expr, duration: float) -> Expr:
    """A formula that a joint can follow from 0 to its duration [s].

    Magnitudes, as of ``sqrt(t**2)``, are written without where what stands in them keeps its sign: the derivatives are
    one-sided at both ends.
    """
    times = np.linspace(0.0, duration, PLACES)
    for magnitude in sorted(formula.atoms(Abs), key=lambda node: node.count_ops()):
        (inner,) = magnitude.args
        values = _numbers(inner, times)
        if values.min() < 0 < values.max():
            raise _refusal("the velocity jumps", _zero(times, values))
        formula = formula.xreplace({magnitude: inner if values.max() > 0 else -inner})
    derivative = formula
    for what in ("the formula", "its velocity", "its acceleration"):
        for message, time in _undefined(derivative, times):
            raise _refusal(message if what == "the formula" else f"{what} is not finite: {message}", time)
        if not np.isfinite(_numbers(derivative, times)).all():
            at = int(np.argmin(np.isfinite(_numbers(derivative, times))))
            raise _refusal(f"{what} is not finite", times[at])
        derivative = derivative.diff(TIME)
    return formula


def _refusal(found: str, time: float) -> QuantityError:
    allowed = "allowed: formulas with a finite velocity and acceleration from 0 to the end"
    return QuantityError(f"{found} near t = {time:.4g} s", allowed=allowed, remedy="write another formula or time")


def _numbers(formula: Expr, times: Array) -> Array:
    with np.errstate(all="ignore"):
        return np.asarray(Curve(Integer(0), Integer(1), (formula, formula, formula)).sampled(times, 0), dtype=float)


def _undefined(formula: Expr, times: Array) -> Iterator[tuple[str, float]]:
    """Parts of a formula that have no finite real value at some time, and when."""
    for node in preorder_traversal(formula):
        if isinstance(node, Pow) and node.has(TIME):
            base = _numbers(node.base, times)
            if not node.exp.is_Integer and base.min() < -NOTHING * np.abs(base).max():
                yield "root of a negative number", times[base.argmin()]
            elif node.exp.is_negative and (time := _zero_of(node.base, times, base)) is not None:
                yield "division by zero", time
        elif isinstance(node, tan) and node.has(TIME):
            below = cos(node.args[0])
            if (time := _zero_of(below, times, _numbers(below, times))) is not None:
                yield "tangent at its pole", time


def _zero_of(formula: Expr, times: Array, values: Array) -> float | None:
    """When a formula is zero, whether it changes its sign there or not."""
    if values.min() < 0 < values.max():
        return _zero(times, values)
    at, last = int(np.abs(values).argmin()), times.size - 1
    ends = times[[max(at - 1, 0)]], times[[min(at + 1, last)]]
    (when,), (least,) = refined(lambda places: -np.abs(_numbers(formula, places)), *ends)
    return float(when) if -least <= NOTHING * np.abs(values).max() else None


def _zero(times: Array, values: Array) -> float:
    """The first time at which a function changes its sign."""
    signs = np.sign(values)
    at = int(np.argmax(signs[1:] * signs[:-1] <= 0))
    a, b = values[at], values[at + 1]
    return float(times[at] if a == b else times[at] - a * (times[at + 1] - times[at]) / (b - a))
