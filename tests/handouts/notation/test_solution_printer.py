"""Choices of sign in print, and what stands first in a solution."""

import pytest

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.solution_printer import (
    SignLatexPrinter,
    SignPrinter,
    pose_names,
    with_names,
    with_signs,
)
from derive.inverse.words.solutions import InverseKinematics
from tests.inverse.closed.test_pool import PLANAR, planar_graph


@pytest.fixture(scope="module")
def planar() -> InverseKinematics:
    robot = PLANAR
    return InverseKinematics(planar_graph(), robot, robot.style)


def test_a_plus_before_a_plus_minus_is_left_out() -> None:
    assert with_signs(r"a + \pm b - \pm c") == r"a \pm b \mp c"


def test_a_choice_of_sign_is_a_plus_minus_in_text_and_latex(planar: InverseKinematics) -> None:
    notation = with_names(Notation.of(planar.robot), planar)
    line = next(line for line in planar.lines if line.signs)
    assert "+-sqrt(" in SignPrinter(planar.robot, notation, pose_names(planar)).doprint(line.value)
    assert r"\pm \sqrt{" in SignLatexPrinter(notation, planar).latex(line.value)


def test_the_pose_stands_before_the_arm(planar: InverseKinematics) -> None:
    notation = with_names(Notation.of(planar.robot), planar)
    line = next(line for line in planar.lines if str(line.symbol) == "D")
    text = SignPrinter(planar.robot, notation, pose_names(planar)).doprint(line.value)
    assert text == "(px**2 + py**2 - a1**2 - a2**2)/(2*a1*a2)"


def test_a_quotient_is_a_fraction_unless_it_is_too_wide(planar: InverseKinematics) -> None:
    notation = with_names(Notation.of(planar.robot), planar)
    line = next(line for line in planar.lines if str(line.symbol) == "D")
    assert r"\frac{p_{x}^{2}" in SignLatexPrinter(notation, planar).latex(line.value)
    assert r"\frac{p_{x}^{2}" not in SignLatexPrinter(notation, planar, widest=10).latex(line.value)
