"""The options of the notation, letters, functions, frames; and the order of textbooks, whatever that of SymPy."""

import random
from collections import Counter
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sympy import Rational, Symbol, cos, pi, sin, symbols

from derive.handouts.layout.lines import Equation, equation_lines
from derive.handouts.notation.notation import Notation, Order
from derive.handouts.notation.pieces import italic, joined
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.notation.symbols import Group, Symbols
from derive.robot.load import catalogue_names
from derive.robot.options.handout import (
    AngleLetter,
    FrameIndices,
    Functions,
    InertiaLetter,
    NotationOptions,
    SliderLetter,
)
from derive.robot.robot import Robot
from tests.handouts.latex_runner import assert_widths
from tests.rows import robot_of_rows

q1, q2, d3, a1, a2, m1, qd1, qd2, dd3 = symbols("q1 q2 d3 a1 a2 m1 qd1 qd2 dd3")

EVERY_CHOICE = [
    NotationOptions(angle, slider, functions)
    for angle, slider, functions in product(AngleLetter, SliderLetter, Functions)
]
FULL = NotationOptions(angle=AngleLetter.VARTHETA, functions=Functions.FULL)


def scara(extra: str = "", third: str = "d3", alpha: str = "0") -> Robot:
    return robot_of_rows(f"R a: a1, alpha: {alpha} | R a: a2 | P q: {third}", extra)


def printed(expression: object, options: NotationOptions, robot: Robot | None = None) -> str:
    return LatexPrinter(Notation.of(robot or scara(), options)).latex(expression).strip()


@pytest.mark.parametrize(
    ("angle", "letter"), [("name", "q"), ("theta", r"\theta"), ("vartheta", r"\vartheta"), ("q", "q")]
)
def test_letter_of_an_angle(angle: str, letter: str) -> None:
    notation = Notation.of(scara(), NotationOptions(angle=AngleLetter(angle)))
    wanted = {
        "q1": f"{letter}_{{1}}",
        "qd1": rf"\dot{{{letter}}}_{{1}}",
        "qdd1": rf"\ddot{{{letter}}}_{{1}}",
        "d3": "d_{3}",
    }
    assert {name: notation.glyph(name).box.tex for name in wanted} == wanted


@pytest.mark.parametrize(("slider", "latex"), [("name", r"\mathrm{lift}_{3}"), ("d", "d_{3}"), ("q", "q_{3}")])
def test_letter_of_an_offset(slider: str, latex: str) -> None:
    notation = Notation.of(scara(third="lift3"), NotationOptions(prismatic=SliderLetter(slider)))
    assert notation.glyph("lift3").box.tex == latex
    assert notation.glyph("q1").box.tex == "q_{1}"


THETAS = NotationOptions(AngleLetter.THETA, SliderLetter.D)
TOOL = "tool: [[1,0,0,d3],[0,1,0,theta1],[0,0,1,0],[0,0,0,1]]\n"


@pytest.mark.parametrize(
    ("robot", "options", "letters"),
    [
        # a variable without a label keeps its name
        (scara(third="lift"), THETAS, {"lift": r"\mathrm{lift}"}),
        # d_3 is a parameter and theta_1 another: the variables keep their names
        (
            scara(TOOL, third="q3"),
            THETAS,
            {"q1": "q_{1}", "q2": r"\theta_{2}", "q3": "q_{3}", "d3": "d_{3}", "theta1": r"\theta_{1}"},
        ),
        # q1 and u1 cannot both be theta_1
        (
            robot_of_rows("R | R q: u1 | P q: d1"),
            NotationOptions(AngleLetter.THETA, SliderLetter.Q),
            {"q1": "q_{1}", "u1": "u_{1}", "d1": "d_{1}"},
        ),
        # limits have symbols too
        (
            robot_of_rows("P q: q3, limits: [0, d3] | P q: q4"),
            THETAS,
            {"q3": "q_{3}", "q4": "d_{4}", "d3": "d_{3}"},
        ),
    ],
)
def test_a_letter_that_is_taken_is_not_taken_away(
    robot: Robot, options: NotationOptions, letters: dict[str, str]
) -> None:
    notation = Notation.of(robot, options)
    assert {name: notation.glyph(name).box.tex for name in letters} == letters


def assert_different(robot: Robot, options: NotationOptions) -> None:
    looks = [glyph.box.tex for glyph in Notation.of(robot, options).glyphs.values()]
    assert len(set(looks)) == len(looks)


@given(
    st.lists(st.sampled_from(["q1", "q2", "d1", "d2", "theta1", "theta2", "u1", "u2"]), unique=True, min_size=3),
    st.sampled_from(EVERY_CHOICE),
    st.randoms(use_true_random=False),
)
def test_no_two_names_look_the_same_in_any_notation(
    names: list[str], options: NotationOptions, source: random.Random
) -> None:
    count = source.randint(1, len(names))
    kinds = [source.choice("RP") for _ in range(count)]
    lengths = names[count:] + ["1"] * count
    rows = [f"{kind} q: {q}, a: {a}" for kind, q, a in zip(kinds, names, lengths, strict=False)]
    rows += [f"R q: w{k}, a: {name}" for k, name in enumerate(lengths[count:]) if name != "1"]
    assert_different(robot_of_rows("|".join(rows)), options)


@pytest.mark.first(9)
@pytest.mark.parametrize("name", catalogue_names())
def test_no_two_symbols_of_a_catalogue_robot_look_the_same_in_any_notation(name: str) -> None:
    for options in EVERY_CHOICE:
        assert_different(Robot.load(name), options)


IN_FULL = {
    r"a_{1}\cos \vartheta_{1} + a_{2}\cos (\vartheta_{1} + \vartheta_{2})": a1 * cos(q1) + a2 * cos(q1 + q2),
    r"\cos (\vartheta_{1} + \vartheta_{2})": cos(q1 + q2),
    r"\cos \vartheta_{1}\sin \vartheta_{2}": cos(q1) * sin(q2),
    r"d_{3}\sin \vartheta_{1}": d3 * sin(q1),
    r"\sin^{2}\vartheta_{1}": sin(q1) ** 2,
    r"m_{1}a_{1}\sin (\vartheta_{2})\dot{\vartheta}_{1}\dot{\vartheta}_{2}": m1 * a1 * sin(q2) * qd1 * qd2,
    r"\cos (\vartheta_{1})(a_{1} + a_{2}\cos \vartheta_{2})": cos(q1) * (a1 + a2 * cos(q2)),
    r"a_{1}[1 + \cos (\vartheta_{1} + \vartheta_{2})]": a1 * (1 + cos(q1 + q2)),
    r"\frac{1}{\cos \vartheta_{1}}": 1 / cos(q1),
    r"\tfrac{1}{2}\cos \vartheta_{2}": cos(q2) * Rational(1, 2),
    r"\cos (\vartheta_{1} - \vartheta_{2})": cos(q1 - q2),
}


@pytest.mark.parametrize(("latex", "expression"), IN_FULL.items(), ids=range(len(IN_FULL)))
def test_functions_in_full(latex: str, expression: object) -> None:
    """A factor behind the argument never looks like a part of it."""
    assert printed(expression, FULL, scara("links: [{mass: m1}, {mass: m2}, {mass: m3}]\n")) == latex


def test_short_functions_keep_their_labels_with_any_letter() -> None:
    for angle in AngleLetter:
        assert printed(a2 * cos(q1 + q2), NotationOptions(angle=angle)) == "a_{2}c_{12}"


def test_long_sums_in_full_still_fit_on_lines() -> None:
    printer = LatexPrinter(Notation.of(robot_of_rows("|".join(["R a: a"] * 40)), FULL))
    angles = [Symbol(f"q{k}") for k in range(1, 41)]
    assert len(printer.pieces(cos(angles[0] + angles[1]))) == 1
    assert len(equation_lines([Equation(italic("x"), tuple(printer.pieces(cos(sum(angles)))))])) > 1


def test_widths_are_those_that_tex_finds(tmp_path: Path) -> None:
    robot = scara("links: [{mass: m1}, {mass: m2}, {mass: m3}]\n")
    boxes = []
    for angle in AngleLetter:
        notation = Notation.of(robot, NotationOptions(angle, SliderLetter.Q, Functions.FULL, FrameIndices.LEFT))
        printer, symbols_ = LatexPrinter(notation), Symbols(notation, 3)
        boxes += [joined(printer.pieces(expression)) for expression in (*IN_FULL.values(), qd1 * dd3)]
        boxes += [symbols_.frame("A", 1, 0), symbols_.frame("T", 12, 10), symbols_.frame("R", "n", 0)]
    boxes.append(Symbols(Notation.of(robot), 3).frame("T", 12, 10))
    assert_widths(boxes, tmp_path)


def test_frames_stand_right_or_left() -> None:
    left = Symbols(Notation.of(scara(), NotationOptions(frames=FrameIndices.LEFT)), 3)
    assert Symbols(Notation.of(scara()), 3).frame("A", 1, 0).tex == r"\mathbf{A}_{1}^{0}"
    assert left.frame("A", 1, 0).tex == r"{}^{0}\mathbf{A}_{1}"
    assert left.frame("T", "n", 0).tex == r"{}^{0}\mathbf{T}_{n}"


def test_entries_that_would_look_like_a_variable_are_written_with_the_matrix() -> None:
    """Joint 11 of a robot written d_{11} is no entry of D."""
    robot = scara(third="q11")
    notation = Notation.of(robot, NotationOptions(prismatic=SliderLetter.D, inertia=InertiaLetter.D))
    assert notation.glyph("q11").box.tex == "d_{11}"
    assert Symbols(notation, 3).entry("d", 1, 1).tex == r"(\mathbf{D})_{11}"


PLANAR = Robot.load("planar-2r-perugia")
Q1, Q2, QD1, QDD1 = (Symbol(name) for name in ("q1", "q2", "qd1", "qdd1"))
A1 = Symbol("a1")
MASS = Symbol(next(iter(Notation.of(PLANAR).inertial)))


FACTORS = [MASS, A1, cos(Q1), sin(Q1), cos(Q1 + Q2), cos(Q2), A1 + cos(Q2), QD1, QDD1]  # masses to accelerations
TERMS = [MASS * QDD1, MASS * QD1**2, A1, A1 * cos(Q1), A1 * cos(Q1 + Q2), pi]  # accelerations to multiples of pi


@pytest.mark.parametrize(("kind", "wanted"), [("factor", FACTORS), ("term", TERMS)])
def test_factors_and_terms_stand_in_the_order_of_textbooks(kind: str, wanted: list[Any]) -> None:
    for seed in range(20):
        shuffled = random.Random(seed).sample(wanted, len(wanted))
        assert sorted(shuffled, key=getattr(Order(Notation.of(PLANAR)), kind)) == wanted


@pytest.mark.parametrize("n", [1, 6, 7, 20, 64])
def test_groups_are_all_different(n: int) -> None:
    found = [Group.T, Group.J, Group.B, Group.CHRISTOFFEL, Group.C, Group.N, Group.TORQUE, Group.POTENTIAL]
    found += [Group.KINETIC, Group.DERIVATIVE]
    found += [Group.row(i) for i in range(1, n + 2)]
    found += [Group.factor(start) for start in range(n)]
    found += [Group.product(i) for i in range(1, n + 1)]
    found += [Group.axis(n, frame, column) for frame in range(n + 1) for column in (3, 4)]
    found += [Group.body(place, quantity) for place in range(2 * n) for quantity in range(4)]
    if n <= 6:
        found += [Group.SINGULARITY_BLOCKS, Group.SINGULARITY_BLOCKS + 1, Group.DETERMINANT, Group.DETERMINANT + 1]
    assert max(Counter(found).values()) == 1
