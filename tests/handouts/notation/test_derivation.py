"""The derivation of the inverse kinematics reads as in a textbook, and a choice of sign is a plus-minus."""

from fractions import Fraction

import pytest

from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.solution_printer import SignLatexPrinter, SignPrinter, pose_names, with_names, with_signs
from derive.inverse.closed.solve import solve
from derive.inverse.words.solutions import InverseKinematics, inverse_kinematics
from derive.robot.expression import Number
from derive.robot.robot import Robot
from tests.inverse.arms import PUBLISHED
from tests.inverse.closed.test_pool import PLANAR, planar_graph

ORTHOGONAL = """
name: orthogonal
convention: standard
joints:
  - {type: revolute, a: 1, alpha: -pi/2}
  - {type: revolute, d: 1, a: 2, alpha: pi/2}
  - {type: revolute, a: 1.5}
inverse: {task: position}
"""


@pytest.fixture(scope="module")
def planar() -> InverseKinematics:
    return InverseKinematics(planar_graph(), PLANAR, PLANAR.style)


def test_the_planar_arm_is_solved_as_in_textbooks(planar: InverseKinematics) -> None:
    lines = derivation_lines(planar, "text", Notation.of(planar.robot))
    assert lines[0] == "2 solutions (complete)"
    assert "   D = (px**2 + py**2 - a1**2 - a2**2)/(2*a1*a2)" in lines
    assert "   q2 = atan2(+-sqrt(1 - D**2), D)" in lines
    assert "   real for abs(D) <= 1" in lines
    assert "     a1*c1 + a2*c12 = px" in lines
    assert "   q1 = atan2(py, px) - atan2(a2*s2, a1 + a2*c2)" in lines
    assert "   arbitrary if px = 0 and py = 0" in lines


def test_in_latex_the_law_of_cosines_is_a_fraction(planar: InverseKinematics) -> None:
    text = "\n".join(derivation_lines(planar, "latex", Notation.of(planar.robot)))
    assert r"D &= \frac{p_{x}^{2} + p_{y}^{2} - a_{1}^{2} - a_{2}^{2}}{2a_{1}a_{2}}" in text
    assert r"\operatorname{atan2}(\pm \sqrt{1 - D^{2}},\, D)" in text


def test_in_python_every_line_is_an_assignment_of_what_is_known(planar: InverseKinematics) -> None:
    known = {"a1", "a2", "px", "py", "epsilon_2"}
    for line in derivation_lines(planar, "python", Notation.of(planar.robot)):
        name, _, value = line.partition("#")[0].partition(" = ")
        compile(value.strip(), "<line>", "eval")
        known.add(name)
    assert {"D", "q1", "q2"} <= known


def test_what_has_no_formula_is_said_in_python_and_latex_too() -> None:
    robot = Robot.from_text(ORTHOGONAL)
    found = inverse_kinematics(robot, robot.style)
    text, latex, python = (derivation_lines(found, form, Notation.of(robot)) for form in ("text", "latex", "python"))
    assert "   of the fourth degree in tan(q3/2): at most 4 values" in text
    assert sum(line.endswith(r"&= 0 \\") for line in latex) == 1
    assert [line.partition(":")[0] for line in python[:1]] == ["# q3"]
    assert python[1].startswith("#   ")
    assert python[1].endswith(" = 0")
    compile("\n".join(python), "<lines>", "exec")


@pytest.mark.sweep
def test_a_general_arm_says_which_joints_the_eigenvalues_give_and_reaches_the_pose_of_a_configuration() -> None:
    case = next(case for case in PUBLISHED if case.name == "manseur-doty")
    robot = case.robot(choice=False)
    found = InverseKinematics(solve(robot), robot, robot.style)
    lines = derivation_lines(found, "text", Notation.of(robot))
    assert lines[0] == "16 solutions (complete)"
    first = next(line for line in lines if line.startswith("1. "))
    assert "from the eigenvalues of a 16x16 matrix: equations in q" in first
    assert sum("from the eigenvector" in line for line in lines) == 2
    assert all(line.startswith("#") for line in derivation_lines(found, "python", Notation.of(robot)))
    assert all(line.startswith("%") for line in derivation_lines(found, "latex", Notation.of(robot)))
    assert sum("from linear equations" in line for line in lines) == 3
    q = (Fraction(1, 3), Fraction(1, 2), Fraction(-1, 5), Fraction(1), Fraction(-2, 3), Fraction(1, 7))
    columns = found.at({f"q{i}": Number(x) for i, x in enumerate(q, 1)})
    assert columns.shape[1] % 2 == 0
    errors = [max(abs(float(a) - b) for a, b in zip(columns.col(k), q, strict=True)) for k in range(columns.shape[1])]
    assert min(errors) < 1e-9


def test_a_plus_before_a_plus_minus_is_left_out() -> None:
    assert with_signs(r"a + \pm b - \pm c") == r"a \pm b \mp c"


def test_a_choice_of_sign_is_a_plus_minus_in_text_and_latex(planar: InverseKinematics) -> None:
    notation = with_names(Notation.of(planar.robot), planar)
    line = next(line for line in planar.lines if line.signs)
    assert "+-sqrt(" in SignPrinter(planar.robot, notation, pose_names(planar)).doprint(line.value)
    assert r"\pm \sqrt{" in SignLatexPrinter(notation, planar).latex(line.value)


def test_the_pose_stands_before_the_arm_and_a_quotient_is_a_fraction_unless_it_is_too_wide(
    planar: InverseKinematics,
) -> None:
    notation = with_names(Notation.of(planar.robot), planar)
    value = next(line.value for line in planar.lines if str(line.symbol) == "D")
    text = SignPrinter(planar.robot, notation, pose_names(planar)).doprint(value)
    assert text == "(px**2 + py**2 - a1**2 - a2**2)/(2*a1*a2)"
    assert r"\frac{p_{x}^{2}" in SignLatexPrinter(notation, planar).latex(value)
    assert r"\frac{p_{x}^{2}" not in SignLatexPrinter(notation, planar, widest=10).latex(value)
