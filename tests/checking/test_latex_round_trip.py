"""What `derive show --format latex` prints is read back as the same formula."""

from __future__ import annotations

import pytest

from derive.checking.latex_formula import read_latex
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import LatexPrinter
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot

LONGEST = 3_000


@pytest.mark.parametrize("name", [name for name in catalogue_names() if Robot.load(name).n <= 7])
def test_printed_latex_is_read_back(name: str) -> None:
    robot = Robot.load(name)
    model, latex = Model(robot), LatexPrinter(Notation.of(robot)).latex
    quantities = ["T", "J", *(["B", "C", "g", "tau"] if robot.has_dynamics and robot.n < 5 else [])]
    for entry in (entry for quantity in quantities for entry in model.quantity(quantity)):
        text = latex(entry)
        if len(text) <= LONGEST:
            assert compare(robot, expression_from_sympy(entry), read_latex(text, robot)).equal, text
