"""Inverse kinematics, singularities, aspects and workspaces in formulas, as text, LaTeX, Python and JSON."""

import json
from fractions import Fraction

import pytest
import sympy

from derive.handouts.notation.derivation import (
    aspects_parts,
    aspects_text,
    derivation_lines,
    singularities_lines,
    singularities_parts,
    workspace_lines,
    workspace_parts,
)
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import PlainPrinter, TextPrinter
from derive.handouts.notation.solution_printer import SignLatexPrinter, with_names, with_signs
from derive.inverse.closed.solve import solve
from derive.inverse.words.reach import Reach
from derive.inverse.words.solutions import InverseKinematics, inverse_kinematics
from derive.model.model import Model
from derive.robot.expression import Number
from derive.robot.robot import Robot
from tests.inverse.arms import PUBLISHED
from tests.inverse.closed.test_pool import PLANAR, planar_graph
from tests.random_robots import catalogue, chains
from tests.rows import robot_of_rows
from tests.workspace.arms import arm

WRITE = PlainPrinter().doprint


@pytest.mark.parametrize("name", [name for name in chains() if catalogue()[name].n > 1])
def test_every_form_has_the_task_all_families_and_whether_they_are_all(name: str) -> None:
    found = Model(Robot.load(name)).singularities
    parts = json.loads(json.dumps(singularities_parts(found, WRITE)))
    assert parts["task"] == list(found.task)
    assert parts["complete"] is found.complete
    assert [[c["zero"] for c in family] for family in parts["families"]] == [
        [WRITE(c.expression) for c in family] for family in found.families
    ]
    for form in ("text", "latex", "python"):
        printed = "\n".join(singularities_lines(found, "singularities", form, WRITE))
        assert all(WRITE(c.expression) in printed or c.is_solution for family in found.families for c in family)
        assert f"for the task {', '.join(found.task)}" in printed or not found.task
        assert ("others may exist" in printed or "no closed form" in printed) is not found.complete


def test_python_can_run_what_is_written_for_it() -> None:
    code = singularities_lines(Model(Robot.load("kuka-lwr4")).singularities, "singularities", "python", WRITE)
    names = {f"q{k}": sympy.Symbol(f"q{k}") for k in range(1, 8)} | {"sin": sympy.sin, "cos": sympy.cos}
    exec("\n".join(code), names)
    assert [sympy.sin(sympy.Symbol("q4"))] in names["singularities"]


def aspects(robot: Robot) -> list[str]:
    return aspects_text(Model(robot).aspects, TextPrinter(robot, None).doprint)


def test_each_solution_is_listed_with_its_signs() -> None:
    found = aspects(Robot.load("planar-2r-perugia"))
    assert found[0].startswith("2 aspects")
    assert found[1:5] == ["   1. s2", "its sign in each solution:", "   +  elbow down", "   -  elbow up"]
    assert found[-1].startswith("looked at with a1 = ")


def test_a_cuspidal_arm_is_called_so_with_the_path() -> None:
    robot = arm("cuspidal")
    aspects = Model(robot).aspects
    found = aspects_text(aspects, TextPrinter(robot, None).doprint)
    (first,) = [number for number, line in enumerate(found) if line.startswith("cuspidal")]
    assert [line.split()[0] for line in found[first + 2 :]] == ["q1", "q2", "q3"]
    rounded = aspects_text(aspects, TextPrinter(robot, None).doprint, 3)[first + 2 :]
    for exact, short in zip(found[first + 2 :], rounded, strict=True):
        assert [f"{float(value):.3g}" for value in exact.split()[1:]] == short.split()[1:]
    parts = json.loads(json.dumps(aspects_parts(aspects)))
    assert parts["cuspidal"] is True
    assert all(len(corner) == 3 for corner in parts["path"])


def test_an_arm_without_aspects_says_why() -> None:
    assert aspects(Robot.load("thumb")) == ["aspects cannot be computed: no single determinant decides the rank of J"]


def lines(name: str, form: str) -> list[str]:
    robot = Robot.load(name)
    return workspace_lines(Model(robot).workspace, form, Notation.of(robot))


def test_a_ring_is_written_with_its_radii_and_numbers_alone_are_decimals() -> None:
    assert lines("planar-2r-perugia", "text") == [
        "reachable region, if no joint has limits:",
        "   abs(a1 - a2) <= sqrt(px**2 + py**2) <= a1 + a2: between two circles, q2 is real",
        "2 solutions inside",
    ]
    (_, row, _) = lines("planar-2r-perugia", "latex")
    assert row == r"  \lvert a_{1} - a_{2} \rvert \le \sqrt{p_{x}^{2} + p_{y}^{2}} \le a_{1} + a_{2} \\"
    (bound,) = [line for line in lines("kuka-kr5", "text") if "<=" in line]
    assert bound.strip() == ("0.0384234 <= sqrt(wz**2 + (rho - 0.075)**2) <= 0.578423: between two tori, q3 is real")


def test_python_can_run_a_workspace() -> None:
    code = "\n".join(lines("planar-3r", "python"))
    for px, wanted in ((1.05, True), (0.25, False), (1.3, False)):  # the tool points along x: the wrist is at px - 0.2
        values = {"a1": 0.5, "a2": 0.4, "a3": 0.2, "px": px, "py": 0.0, "r11": 1.0, "r21": 0.0}
        exec("from math import sqrt\n" + code, values)
        assert values["reached"] is wanted


def test_json_has_every_bound_and_an_arm_without_any_says_what_to_do() -> None:
    found: Reach = Model(Robot.load("puma560-corke")).workspace
    parts = workspace_parts(found)
    assert [bound["shape"] for bound in parts["bounds"]] == ["outside of a cylinder", "between two spheres"]
    assert (parts["whole"], parts["count"]) == (True, 8)
    assert lines("thumb", "text")[-1] == "the boundary: derive plot --workspace"
    assert lines("spherical-wrist", "text")[0].startswith("no bound")


@pytest.fixture(scope="module")
def planar() -> InverseKinematics:
    return InverseKinematics(planar_graph(), PLANAR, PLANAR.style)


def test_the_planar_arm_is_solved_as_in_textbooks_and_in_latex_by_a_fraction(planar: InverseKinematics) -> None:
    lines = derivation_lines(planar, "text", Notation.of(planar.robot))
    assert lines[0] == "2 solutions (complete)"
    assert "   D = (px**2 + py**2 - a1**2 - a2**2)/(2*a1*a2)" in lines
    assert "   q2 = atan2(+-sqrt(1 - D**2), D)" in lines
    assert "   real for abs(D) <= 1" in lines
    assert "     a1*c1 + a2*c12 = px" in lines
    assert "   q1 = atan2(py, px) - atan2(a2*s2, a1 + a2*c2)" in lines
    assert "   arbitrary if px = 0 and py = 0" in lines
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
    robot = robot_of_rows("R a: 1, alpha: -pi/2 | R d: 1, a: 2, alpha: pi/2 | R a: 1.5", "inverse: {task: position}")
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


def test_signs_are_joined_and_a_quotient_is_a_fraction_unless_it_is_too_wide(planar: InverseKinematics) -> None:
    assert with_signs(r"a + \pm b - \pm c") == r"a \pm b \mp c"
    notation = with_names(Notation.of(planar.robot), planar)
    value = next(line.value for line in planar.lines if str(line.symbol) == "D")
    assert r"\frac{p_{x}^{2}" in SignLatexPrinter(notation, planar).latex(value)
    assert r"\frac{p_{x}^{2}" not in SignLatexPrinter(notation, planar, widest=10).latex(value)
