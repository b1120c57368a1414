"""Formulas of a motion in print."""

from __future__ import annotations

import re

import numpy as np
import pytest
from sympy import Symbol, lambdify, sympify

from derive.motion.motion import Motion
from derive.motion.output.polynomials import printed
from tests.motion.plans import PICK_AND_PLACE


def test_a_quintic_is_printed_by_powers_of_time() -> None:
    lines = list(printed(Motion.from_text(PICK_AND_PLACE)))
    assert lines[:2] == ["rest -> A, 0 <= t <= 3 s", "  q1 = 5*pi*t**3/27 - 5*pi*t**4/54 + pi*t**5/81"]
    assert "  q3 = 1 + 20*t**3/27 - 10*t**4/27 + 4*t**5/81" in lines


@pytest.mark.parametrize("profile", ["cubic", "quintic", "septic", "trapezoidal", "harmonic", "spline"])
def test_what_is_printed_is_what_moves(profile: str) -> None:
    motion = Motion.from_text(PICK_AND_PLACE.replace("quintic", profile))
    starts = {segment.name: float(segment.start) for segment in motion.trajectory.segments}
    start, checked, symbol = 0.0, 0, Symbol("t")
    names = [joint.variable for joint in motion.plan.robot.joints]
    for line in printed(motion):
        if not line.startswith("  "):
            start = starts[line.split(",")[0]]
            continue
        name, rest = line.strip().split(" = ")
        text, _, span = rest.partition("  for ")
        low, high = (float(sympify(part)) for part in (span or "0 <= t <= 3").split(" <= t <= "))
        t = np.linspace(low, high, 5)
        value = lambdify(symbol, sympify(text), "numpy")(t)
        assert motion(start + t)[0][:, names.index(name)] == pytest.approx(np.broadcast_to(value, 5), abs=1e-12)
        checked += 1
    assert checked >= 20


def test_latex_has_a_display_for_every_segment() -> None:
    lines = list(printed(Motion.from_text(PICK_AND_PLACE), as_latex=True))
    assert lines[:2] == ["% rest -> A, 0 <= t <= 3 s", r"\begin{align*}"]
    assert lines[2] == r"  q_{1}(t) &= \frac{5 \pi t^{3}}{27} - \frac{5 \pi t^{4}}{54} + \frac{\pi t^{5}}{81} \\"
    assert lines[5:7] == [r"  q_{4}(t) &= 0", r"\end{align*}"]


def test_what_is_not_exact_is_printed_in_decimals_alone() -> None:
    """A pose is reached by floats, and no polynomial has them beside powers of pi."""
    text = PICK_AND_PLACE.replace("A: [pi/2, pi/2, 1, 0]", "A: {pose: {p: [-1.9, 2.1, -1], rpy: [pi, 0, 0]}}")
    first, *lines = list(printed(Motion.from_text(text)))[:4]
    assert first == "rest -> A, 0 <= t <= 3 s"
    assert all(re.fullmatch(r"  q\d = [-+*t. e\d]+", line) for line in lines)


def test_curves_are_printed_as_they_were_given() -> None:
    motion = Motion.from_text("robot: planar-2r-perugia\ncurves: {q1: sin(2*t)}\ntime: 1\n")
    assert list(printed(motion))[1:] == ["  q1 = sin(2*t)", "  q2 = 0"]
