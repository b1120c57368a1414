"""Elementary equations, their origins and solutions in words."""

import random
from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import mpmath
import pytest
import sympy

from derive.algebra.ring import Polynomial, Ring
from derive.inverse.closed.nodes import Provenance
from derive.inverse.words.derivation import Origin, OriginForm, PrintedDerivation, origin, pose_names
from derive.inverse.words.elementary import Scribe, Sign, Solved
from derive.inverse.words.solutions import InverseKinematics, inverse_kinematics
from derive.lecture.point import value_of
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.model import Model
from derive.robot.options.style import Contraction
from derive.robot.robot import Robot
from tests.inverse.arms import arm_of
from tests.inverse.closed.test_pool import PLANAR, planar_graph

NAMES = ("x", "y", "a", "b", "d")
RING = Ring(NAMES)
x, y, a, b, d = map(RING.generator, NAMES)
zero, one = RING.zero, RING.one
VALUES = dict(zip(NAMES, (mpmath.mpf(k) for k in ("0.7", "-0.9", "0.5", "0.4", "0.3")), strict=True))


def written(p: Polynomial) -> sympy.Expr:
    terms = []
    for exponents, coefficient in p.terms():
        powers = (sympy.Symbol(name) ** e for name, e in zip(NAMES, exponents, strict=True))
        terms.append(sympy.Mul(sympy.Rational(coefficient.numerator, coefficient.denominator), *powers))
    return sympy.Add(*terms)


def scribe() -> Scribe:
    return Scribe(written, set(NAMES), lambda p: any(p.degrees()[:2]))


def values(by: Scribe, solved: Solved) -> list[mpmath.mpf]:
    signs = sorted({s for e in (solved.value, *(line.value for line in by.lines)) for s in e.free_symbols}, key=str)
    signs = [sign for sign in signs if isinstance(sign, Sign)]
    found = []
    for choice in product((1, -1), repeat=len(signs)):
        known = {sympy.Symbol(name): value for name, value in VALUES.items()}
        known.update(zip(signs, map(mpmath.mpf, choice), strict=True))
        for line in by.lines:
            known[line.symbol] = value_of(line.value, known)
        found.append(value_of(solved.value, known))
    return found


def number(p: Polynomial) -> mpmath.mpf:
    return value_of(written(p), {sympy.Symbol(name): value for name, value in VALUES.items()})


ONE_EQUATION = {
    "both": (y, x, a),
    "scaled": (2 * a * b, -2 * a * d, x * x - y * y - b * b + d * d),
    "cosine": (2 * a * b, zero, x * x - a * a - b * b),
    "sine": (zero, a, b * d),
    "no constant": (-x, y, zero),
    "numbers": (3 * one, -4 * one, one),
}


@pytest.mark.parametrize("equation", ONE_EQUATION.values(), ids=ONE_EQUATION)
def test_both_angles_of_one_equation_satisfy_it(equation: Sequence[Polynomial]) -> None:
    by = scribe()
    first, second = values(by, by.one_equation("1", tuple(equation)))  # type: ignore[arg-type]
    assert abs(mpmath.sin((first - second) / 2)) > 1e-3
    A, B, C = map(number, equation)
    for angle in (first, second):
        assert abs(A * mpmath.cos(angle) + B * mpmath.sin(angle) - C) < 1e-12


def test_a_factor_that_moves_is_kept_with_its_sign_which_solution_is_which() -> None:
    towards = [scribe().one_equation("1", (e * a * x, e * b * x, d * one)).value for e in (1, -1)]
    assert all(sympy.Symbol("x") in value.free_symbols for value in towards)
    assert "/x" not in str(towards[0])
    assert "a*x" not in str(scribe().one_equation("1", (a * b, a * d, x)).value)


TWO_EQUATIONS = {
    "turned": ((a + b, -d, x), (d, a + b, y)),
    "turned and mirrored": ((a, d, x), (d, -a, y)),
    "apart": ((a, zero, x), (zero, -b, y)),
    "crossed": ((zero, a, x), (b, zero, y)),
    "any": ((a, x, b), (y, d, a)),
}


@pytest.mark.parametrize("equations", TWO_EQUATIONS.values(), ids=TWO_EQUATIONS)
def test_the_angle_of_two_equations_has_their_cosine_and_sine_but_for_a_positive_factor(
    equations: tuple[Sequence[Polynomial], ...],
) -> None:
    by = scribe()
    (angle,) = values(by, Solved(by.two_equations(sympy.Symbol("q"), "1", *map(tuple, equations))))  # type: ignore[arg-type]
    (A, B, C), (D, E, F) = (map(number, equation) for equation in equations)
    solution = mpmath.lu_solve(mpmath.matrix([[A, B], [D, E]]), mpmath.matrix([C, F]))
    assert abs(mpmath.sin((angle - mpmath.atan2(solution[1], solution[0])) / 2)) < 1e-12


@pytest.mark.parametrize("equation", [(one, zero, -x * x - d * d), (one, 2 * x, -y * y), (zero, a, x), (a, b, -d)])
def test_lengths_satisfy_their_equation(equation: tuple[Polynomial, Polynomial, Polynomial]) -> None:
    by = scribe()
    A, B, C = map(number, equation)
    found = values(by, by.length("1", equation))
    assert len(found) == (2 if A else 1)
    assert all(abs(A * r * r + B * r + C) < 1e-12 for r in found)


def test_names_clash_with_nothing() -> None:
    by = Scribe(written, {"D", "E", "F", "D_2"}, bool)
    assert [by.name(("D", "E", "F"), "2") for _ in range(3)] == ["E_2", "F_2", "D_1"]


def test_laws_of_cosines_and_offsets_beside_an_axis_have_the_form_of_textbooks() -> None:
    by = scribe()
    solved = by.one_equation("2", (2 * a * b, zero, x * x + y * y - a * a - b * b))
    assert str(by.lines[0].symbol) == "D"
    assert str(by.lines[0].value) == "(-a**2 - b**2 + x**2 + y**2)/(2*a*b)"
    assert str(solved.value) == "atan2(epsilon_2*sqrt(1 - D**2), D)"
    solved = by.one_equation("1", (y, -x, d))
    assert str(solved.value) == "-atan2(d, epsilon_1*sqrt(-d**2 + x**2 + y**2)) + atan2(y, x)"
    assert str(solved.exists) == "x**2 + y**2 >= d**2"


def test_the_equations_of_a_step_hold_the_unknown_on_their_left_and_what_is_known_on_their_right() -> None:
    steps = PrintedDerivation(planar_graph(), PLANAR, PLANAR.style).steps
    assert [step.unknown for step in steps] == list(sympy.symbols("q2 q1"))
    q1, q2, a1, a2, px, py = sympy.symbols("q1 q2 a1 a2 px py")
    assert [(e.left, e.right) for step in steps for e in step.equations] == [
        (2 * a1 * a2 * sympy.cos(q2), px**2 + py**2 - a1**2 - a2**2),
        (a1 * sympy.cos(q1) + a2 * sympy.cos(q1 + q2), px),
        (a1 * sympy.sin(q1) + a2 * sympy.sin(q1 + q2), py),
    ]


def test_sums_of_angles_may_have_offsets_that_no_joint_has() -> None:
    robot = arm_of("modified", "R 0 0 0 -172.22; R 0 0.3 0 -102.78; R 0 0.25 0 0")
    found = inverse_kinematics(robot, robot.style)
    assert found.count == 2
    assert len(found.solutions) == 2
    assert found.verified


def test_the_pose_has_other_names_where_the_robot_has_these() -> None:
    names = pose_names(arm_of("standard", "R 0 0 r11 0; R 0 0 a2 0"))
    assert names[1, 1] == "R11"
    assert names[1, 4] == "Px"
    assert len(set(names.values())) == 12


def test_where_an_unknown_is_free_no_constant_stands_before_what_vanishes() -> None:
    robot = arm_of("standard", "R 0 0.1 0 60; R 0 0.2 0 90; R 0 0.3 0 60")
    found = inverse_kinematics(robot, robot.style)
    vanishing = {str(value) for step in found.steps for value in step.fails}
    assert "wz" in vanishing
    assert not any("sqrt(3)" in text for text in vanishing)


def test_each_choice_of_signs_has_a_solution_of_pose_and_parameters_alone_and_what_is_free_is_said() -> None:
    planar = InverseKinematics(planar_graph(), PLANAR, PLANAR.style)
    assert len(planar.solutions) == planar.graph.leaves == 2
    assert [list(solution.signs.values()) for solution in planar.solutions] == [[1], [-1]]
    allowed = set(sympy.symbols("px py a1 a2"))
    for solution in planar.solutions:
        assert set(solution.explicit) == set(sympy.symbols("q1 q2"))
        assert all(value.free_symbols <= allowed for value in solution.explicit.values())
    (degenerate,) = planar.degenerate
    assert degenerate.unknown == sympy.Symbol("q1")
    assert set(degenerate.conditions) == set(sympy.symbols("px py"))


def test_who_asks_again_has_the_same_solutions_and_another_style_others() -> None:
    robot = Robot.load("planar-3r")
    found = inverse_kinematics(robot, robot.style)
    assert inverse_kinematics(Robot.load("planar-3r"), robot.style) is found
    assert inverse_kinematics(robot, replace(robot.style, contraction=Contraction.OPPOSED)) is not found


ENDS = """base: [[2/3, -1/3, 2/3, 1/10], [2/3, 2/3, -1/3, 0], [-1/3, 2/3, 2/3, 0], [0, 0, 0, 1]]
tool: [[1, 0, 0, 1/5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
inverse: {task: [x, y, phi]}"""
ARMS = {
    "standard": Robot.load("puma560-corke"),
    "modified": arm_of("modified", "R 0 0 0 0; R -90 0 0 0; R 0 a2 d3 0; R -90 a3 d4 0; R 90 0 0 0; R -90 0 0 0"),
    "scara": arm_of("standard task=position", "R 0 d3 a2 0; R 0 0 a3 180; P 0 0 0 0"),
    "turned": arm_of("standard", "R 0 0 a2 0; R 0 0 a3 0; R 0 0 d3 0", ENDS),
}
TOLERANCE = mpmath.mpf(10) ** -20


def test_columns_are_counted_behind_the_twist_and_positions_are_those_of_the_last_frame_that_has_them() -> None:
    robot = ARMS["standard"]
    assert origin(robot, Provenance(5, 5, "R[3,2]"), to_end=False) == Origin(OriginForm.ENTRY, 5, 5, ((3, 3),))
    assert origin(robot, Provenance(3, 6, "R[3,2]"), to_end=False) == Origin(OriginForm.ENTRY, 3, 6, ((3, 2),))
    assert origin(robot, Provenance(2, 4, "p[3]"), to_end=False) == Origin(OriginForm.ENTRY, 2, 6, ((3, 4),))
    assert origin(robot, Provenance(2, 4, "p.p"), to_end=False).form is OriginForm.SQUARES
    robot = ARMS["scara"]
    assert origin(robot, Provenance(1, 1, "p[3]"), to_end=False) == Origin(OriginForm.ENTRY, 1, 1, ((3, 4),))


def valued(matrix: sympy.Matrix, known: dict[sympy.Expr, mpmath.mpf]) -> sympy.Matrix:
    return sympy.Matrix(*matrix.shape, [value_of(entry, dict(known)) for entry in matrix])


@pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)
def test_an_equation_is_the_difference_of_the_entries_that_are_compared(arm: Robot) -> None:
    """At poses that are not those of the configuration, so that both sides differ: always by the same factor."""
    model = Model(arm)
    found, rng = model.inverse, random.Random(4)
    factors: dict[sympy.Expr, list[mpmath.mpf]] = {}
    with mpmath.workdps(40):
        for _ in range(2):
            parameters = {s: mpmath.mpf(rng.randint(20, 90)) / 97 for s in sympy.symbols("a2 a3 d3 d4")}
            there, here = ({s: mpmath.mpf(rng.randint(-300, 300)) / 101 for s in model.q} for _ in range(2))
            pose = valued(model.T, {**parameters, **there})
            known = {**parameters, **here, **dict(zip(found.pose[:3, :], pose[:3, :], strict=True))}
            for line in found.definitions:
                known[line.symbol] = value_of(line.value, dict(known))
            matrices = [sympy.eye(4), *(valued(model.A(i), known) for i in range(1, arm.n + 1))]
            frames = [[[expression_to_sympy(cell) for cell in row] for row in rows] for rows in (arm.base, arm.tool)]
            ends = [valued(sympy.Matrix(rows), {}) for rows in frames]
            for equation in (equation for step in found.steps for equation in step.equations):
                place, *eliminated = equation.origins
                if place.form is OriginForm.ENTRY and not eliminated:
                    base, first = (sympy.eye(4), ends[0]) if place.has_base else (ends[0], sympy.eye(4))
                    tool, last = (sympy.eye(4), ends[1]) if place.has_tool else (ends[1], sympy.eye(4))
                    left = sympy.prod(matrices[: place.first], start=base)
                    right = sympy.prod(matrices[place.last + 1 :], start=sympy.eye(4)) * tool
                    inside = sympy.prod(matrices[place.first : place.last + 1], start=first) * last
                    ((row, column),) = place.entries
                    gap = (inside - left.inv() * pose * right.inv())[row - 1, column - 1]
                    difference = value_of(equation.left - equation.right, dict(known))
                    factors.setdefault(equation.left - equation.right, []).append(difference / gap)
    assert len(factors) >= arm.n
    for ratios in factors.values():
        assert all(abs(abs(ratio) - abs(ratios[0])) < TOLERANCE for ratio in ratios)
