"""Expressions and cells of the robot file in the notation of lecture notes, as LaTeX and as plain text."""

import math
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from sympy import Integer, Rational, Symbol, atan2, cos, pi, sign, sin, sqrt, symbols

from derive.errors import TargetError
from derive.handouts.notation.notation import Notation, distinct, natural
from derive.handouts.notation.pieces import joined, magnitude
from derive.handouts.notation.printer import DataPrinter, LatexPrinter, TextPrinter, loses_digits
from derive.robot.robot import Robot
from derive.robot.rounding import DIGITS
from tests.handouts.latex_runner import assert_widths
from tests.interpreters import another_hash_seed, printed_by
from tests.rows import robot_of_rows


def arm(joints: int = 4, extra: str = "") -> Robot:
    rows = "|".join(f"R a: a{i}, alpha: alpha{i}" for i in range(1, joints + 1))
    links = "\n".join(f"  - {{mass: m{i}, com: [l{i}, 0, 0], inertia: {{zz: I{i}}}}}" for i in range(1, joints + 1))
    return robot_of_rows(rows, f"links:\n{links}\n{extra}")


PRINTER = LatexPrinter(Notation.of(arm()))
q1, q2, q3, q4, a1, a2, l2, m1, m2, i2, alpha1, qd1, qd2, qdd1, g = symbols(
    "q1 q2 q3 q4 a1 a2 l2 m1 m2 I2 alpha1 qd1 qd2 qdd1 g"
)

PRINTED = {
    r"a_{1}c_{1} + a_{2}c_{12}": a2 * cos(q1 + q2) + a1 * cos(q1),
    r"c_{12}c_{4} + s_{12}s_{4}": sin(q4) * sin(q1 + q2) + cos(q4) * cos(q1 + q2),
    r"-c_{12}s_{4} + s_{12}c_{4}": sin(q1 + q2) * cos(q4) - cos(q1 + q2) * sin(q4),
    r"m_{2}(a_{1}^{2} + l_{2}^{2} + 2a_{1}l_{2}c_{2}) + I_{2}": i2 + m2 * (2 * a1 * l2 * cos(q2) + l2**2 + a1**2),
    r"-m_{2}a_{1}l_{2}s_{2}\dot{q}_{2}": -a1 * l2 * m2 * qd2 * sin(q2),
    r"m_{2}\ddot{q}_{1} + m_{1}\dot{q}_{1}\dot{q}_{2} + m_{1}g": m2 * qdd1 + m1 * qd1 * qd2 + m1 * g,
    r"-(a_{1} + a_{2})\dot{q}_{1}": (-a1 - a2) * qd1,
    r"\tfrac{1}{2}m_{1}\dot{q}_{1}^{2}": m1 * qd1**2 / 2,
    r"\tfrac{\sqrt{3}}{2}a_{1}": sqrt(3) * a1 / 2,
    r"\frac{a_{1}}{a_{2}}c_{1}": a1 * cos(q1) / a2,
    r"c_{1}^{2}": cos(q1) ** 2,
    r"\cos (q_{1} - q_{2})": cos(q1 - q2),
    r"\cos \alpha_{1}\dot{q}_{1}": cos(alpha1) * qd1,
    r"\sin^{2}\alpha_{1}": sin(alpha1) ** 2,
    r"\cos (2q_{1})": cos(2 * q1),
    r"q_{1} + \tfrac{\pi}{2}": q1 + pi / 2,
    r"-\tfrac{2\pi}{3}": -2 * pi / 3,
    r"\operatorname{atan2}(s_{1},\, c_{1})": atan2(sin(q1), cos(q1)),
    r"\operatorname{sgn}\dot{q}_{1}": sign(qd1),
    r"\sqrt{a_{1}^{2} + a_{2}^{2}}": sqrt(a1**2 + a2**2),
    r"\frac{1}{\sqrt{a_{1}}}": 1 / sqrt(a1),
    r"a_{1}[1 + m_{1}(a_{1} + a_{2})]^{2}": a1 * (m1 * (a1 + a2) + 1) ** 2,
    r"0": sympy.Integer(0),
    r"-1": sympy.Integer(-1),
    r"\tfrac{1}{2}": Rational(1, 2),
}


@pytest.mark.parametrize(("latex", "expression"), PRINTED.items(), ids=range(len(PRINTED)))
def test_expressions_look_as_in_lecture_notes(latex: str, expression: sympy.Expr) -> None:
    assert PRINTER.latex(expression).strip() == latex


NAMES = {
    "m1": "m_{1}",
    "ml1": "m_{l1}",
    "Ixx3": "I_{xx3}",
    "alpha1": r"\alpha_{1}",
    "beta": r"\beta",
    "kr1": "k_{r1}",
    "g": "g",
    "payload": r"\mathrm{payload}",
    "m_load": r"m_{\mathrm{load}}",
    "k_r1": "k_{r1}",
    "a_max_2": r"a_{\mathrm{max},2}",
    "a__b": r"\mathtt{a\_\_b}",
    "lambda": r"\lambda",
    "E": "E",
}


@pytest.mark.parametrize(("name", "latex"), NAMES.items())
def test_names_look_as_in_lecture_notes(name: str, latex: str) -> None:
    assert natural(name).box.tex.strip() == latex


@given(st.lists(st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,12}", fullmatch=True), unique=True, max_size=30))
def test_no_two_names_look_the_same(names: list[str]) -> None:
    printed = [glyph.box.tex for _, glyph in distinct(names)]
    assert len(set(printed)) == len(names)
    assert not any(re.fullmatch(r"[cs]_\{[0-9,]+\}", tex) for tex in printed)


def test_dots_belong_to_the_joint_and_not_to_a_letter() -> None:
    """A parameter whose name begins with qd is no velocity."""
    printer = LatexPrinter(Notation.of(arm(2, "tool: [[1,0,0,qd7],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\n")))
    assert printer.latex(Symbol("qd7") * Symbol("qd1")) == r"q_{d7}\dot{q}_{1}"


def test_labels_of_two_digits_are_told_apart() -> None:
    """c_{12} of a robot with a joint 12 is the cosine of that joint alone."""
    printer = LatexPrinter(Notation.of(arm(12)))
    assert printer.latex(cos(Symbol("q12"))) == "c_{12}"
    assert printer.latex(cos(q1 + q2)) == "c_{1,2}"
    assert printer.latex(cos(Symbol("q10") + Symbol("q11"))) == "c_{10,11}"


@pytest.mark.parametrize(
    ("value", "latex"),
    [
        ("0.4318", "0.4318"),
        ("0.5", "0.5"),
        ("1/3", r"\tfrac{1}{3}"),
        ("1.234567891", "1.23457"),
        ("2e-7", r"2 \cdot 10^{-7}"),
    ],
)
def test_robots_given_in_decimals_are_printed_in_decimals(value: str, latex: str) -> None:
    robot = robot_of_rows(f"R a: 0.25, d: '{value}'")
    assert LatexPrinter(Notation.of(robot)).latex(Rational(value)) == latex


def test_functions_outside_the_grammar_are_refused() -> None:
    with pytest.raises(TargetError):
        PRINTER.latex(sympy.gamma(q1))


def test_print_does_not_depend_on_hash_seeds() -> None:
    """The same long sum from this interpreter, whose seed is another in every run, and from one with a given seed."""
    program = "from tests.handouts.notation.test_printer import long_sums; print(long_sums())"
    assert printed_by(program, PYTHONHASHSEED=another_hash_seed()) == str(long_sums())


def long_sums() -> list[str]:
    return [PRINTER.latex(sum(PRINTED.values()) * e) for e in PRINTED.values() if e.args]


def test_widths_are_those_that_tex_finds(tmp_path: Path) -> None:
    names = [*NAMES, "Wx", "fM2", "phi", "Omega3", "w_tool", "Jm12", "VV2"]
    boxes = [joined(PRINTER.pieces(expression)) for expression in PRINTED.values()]
    boxes += [natural(name).box for name in names]
    assert_widths(boxes, tmp_path)


def data_printer(cells: str, kind: str = "revolute", unit: str = "rad") -> tuple[DataPrinter, Robot]:
    robot = robot_of_rows(f"{kind[0].upper()} {cells}", f"units: {{angle: {unit}}}")
    return DataPrinter(robot, Notation.of(robot, robot.handout.notation)), robot


@pytest.mark.parametrize(
    ("unit", "kind", "cell", "expected"),
    [
        ("rad", "revolute", "alpha: pi/2", "\\tfrac{\\pi}{2}"),
        ("rad", "revolute", "alpha: -pi/6", "-\\tfrac{\\pi}{6}"),
        ("rad", "revolute", "alpha: pi/8", "\\tfrac{\\pi}{8}"),
        ("rad", "revolute", "alpha: 0.5", "0.5"),
        ("deg", "revolute", "alpha: 90", "90^{\\circ}"),
        ("deg", "revolute", "alpha: -30", "-30^{\\circ}"),
        ("deg", "revolute", "alpha: 22.5", "22.5^{\\circ}"),
        ("deg", "revolute", "alpha: beta - 10", "\\beta  - 10^{\\circ}"),
        ("deg", "revolute", "alpha: beta", "\\beta "),
        ("rad", "revolute", "a: 0.431812345678", "0.431812345678"),
        ("rad", "revolute", "limits: [-pi, pi/3]", "[-\\pi ,\\, \\tfrac{\\pi}{3}]\\,\\mathrm{rad}"),
        ("rad", "revolute", "limits: [-3, 2]", "[-3,\\, 2]\\,\\mathrm{rad}"),
        ("rad", "prismatic", "limits: [0, 0.5]", "[0,\\, 0.5]\\,\\mathrm{m}"),
        ("deg", "revolute", "limits: [-180, 60]", "[-180^{\\circ},\\, 60^{\\circ}]"),
        ("deg", "revolute", "limits: [0, 60]", "[0^{\\circ},\\, 60^{\\circ}]"),
        ("deg", "prismatic", "limits: [0, 0.5]", "[0,\\, 0.5]\\,\\mathrm{m}"),
    ],
)
def test_cells_have_their_unit_and_every_digit(unit: str, kind: str, cell: str, expected: str) -> None:
    data, robot = data_printer(cell, kind, unit)
    joint, name = robot.joints[0], cell.partition(":")[0]
    written = {
        "alpha": lambda: data.angle(joint.alpha),
        "a": lambda: data.value(joint.a),
        "limits": lambda: data.limits(joint),
    }
    assert joined(written[name]()).tex == expected


@pytest.mark.parametrize(
    ("limits", "expected"), [("[-2.5, 2]", "[-2{,}5;\\, 2]"), ("[-pi, 2]", "[-\\pi ,\\, 2]"), ("[-3, 2]", "[-3,\\, 2]")]
)
def test_a_list_with_a_decimal_comma_has_semicolons(limits: str, expected: str) -> None:
    _, robot = data_printer(f"limits: {limits}")
    data = DataPrinter(robot, Notation.of(robot, comma=True))
    assert joined(data.limits(robot.joints[0])).tex.startswith(expected)


@pytest.mark.parametrize(
    ("value", "decimals", "tex"),
    [
        (Fraction(7), False, "7"),
        (Fraction(-1, 2), False, r"\tfrac{1}{2}"),
        (Fraction(1, 2), True, "0.5"),
        (Fraction(1, 3), True, r"\tfrac{1}{3}"),
        (Fraction(4318, 10000), True, "0.4318"),
        (Fraction(12, 10**8), True, r"1.2 \cdot 10^{-7}"),
        (Fraction(10**9), True, "10^{9}"),
    ],
)
def test_numbers_look_as_on_paper(value: Fraction, decimals: bool, tex: str) -> None:
    assert magnitude(value, decimals).tex == tex


@given(st.fractions(max_denominator=10**12), st.booleans())
def test_the_printed_number_is_the_number(value: Fraction, decimals: bool) -> None:
    box = magnitude(value, decimals)
    text = re.sub(r"\\tfrac\{(\d+)\}\{(\d+)\}", r"\1/\2", box.tex)
    mantissa, _, exponent = text.replace("10^{", " \\cdot 10^{").removeprefix(" \\cdot ").partition("10^{")
    number = Fraction(mantissa.removesuffix(" \\cdot ").replace(" \\cdot", "").strip() or "1")
    if exponent:
        number *= Fraction(10) ** int(exponent.rstrip("}"))
    assert abs(number - abs(value)) <= abs(value) / 10 ** (DIGITS - 1)
    assert box.width > 0


@given(st.fractions(max_denominator=10**12), st.booleans())
def test_a_decimal_comma_is_in_braces_and_changes_nothing_else(value: Fraction, decimals: bool) -> None:
    """TeX would put a space behind a bare one."""
    point, comma = magnitude(value, decimals), magnitude(value, decimals, comma=True)
    assert "." not in comma.tex
    assert comma.tex.replace("{,}", ".") == point.tex
    assert comma.width == point.width


ROBOT = Robot.load("scara-perugia")
Q = symbols("q1 q2 q4")
A = symbols("a1 a2 ml1")
VALUES = {str(symbol): 0.3 + 0.37 * index for index, symbol in enumerate((*Q, *A, *symbols("q3 g")))}


SCOPE = {**VALUES, "cos": math.cos, "sin": math.sin, "sqrt": math.sqrt, "pi": math.pi}
for chosen in ("1", "2", "4", "12", "14", "24", "124"):
    angle = sum(VALUES[f"q{label}"] for label in chosen)
    SCOPE |= {f"c{chosen}": math.cos(angle), f"s{chosen}": math.sin(angle)}


def angles() -> st.SearchStrategy[Any]:
    signs = st.sampled_from([1, 1, 1, -1])
    return st.lists(st.tuples(signs, st.sampled_from(Q)), min_size=1, max_size=3, unique_by=lambda pair: pair[1]).map(
        lambda terms: sum(sign * symbol for sign, symbol in terms)
    )


def expressions() -> st.SearchStrategy[Any]:
    leaves = st.one_of(
        st.sampled_from(A),
        st.fractions(min_value=-3, max_value=3, max_denominator=7).map(lambda f: Rational(f.numerator, f.denominator)),
        angles().map(cos),
        angles().map(sin),
        st.sampled_from(A).map(sqrt),
        st.sampled_from(A).map(lambda symbol: 1 / symbol),
    )
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.tuples(inner, inner).map(lambda pair: pair[0] + pair[1]),
            st.tuples(inner, inner).map(lambda pair: pair[0] * pair[1]),
            inner.map(lambda e: -e),
            inner.map(lambda e: e**2),
        ),
        max_leaves=12,
    )


@given(expressions())
def test_printed_text_has_the_value_of_the_expression(expression: Any) -> None:
    printed = TextPrinter(ROBOT).doprint(expression)
    expected = float(expression.subs({symbol: VALUES[str(symbol)] for symbol in (*Q, *A)}))
    assert eval(printed, {"__builtins__": {}}, SCOPE) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("expression", "printed"),
    [
        (A[0] * cos(Q[0]) + A[1] * cos(Q[0] + Q[1]), "a1*c1 + a2*c12"),
        (sin(Q[0] + Q[1]) * cos(Q[2]) - cos(Q[0] + Q[1]) * sin(Q[2]), "-c12*s4 + s12*c4"),
        (cos(Q[0] - Q[1]), "cos(q1 - q2)"),
        (-A[0] / 2, "-a1/2"),
        (1 / A[0], "1/a1"),
    ],
)
def test_order_and_shorthand_are_those_of_the_notes(expression: Any, printed: str) -> None:
    assert TextPrinter(ROBOT).doprint(expression) == printed


@pytest.mark.parametrize(
    "robot",
    [
        robot_of_rows("R a: c1 | R a: c1"),
        robot_of_rows("|".join(f"R a: a{i}" for i in range(1, 13))),
        robot_of_rows("R q: theta1_1, a: a1 | R q: theta2_1, a: a2"),
    ],
    ids=["a parameter looks like a token", "labels of two digits", "labels that occur twice"],
)
def test_ambiguous_shorthand_is_spelled_out(robot: Robot) -> None:
    variable = symbols(robot.joints[0].variable)
    assert TextPrinter(robot).doprint(cos(variable)) == f"cos({variable})"


PUMA = Robot.load("puma560-corke")


@pytest.mark.parametrize(
    ("expression", "printed"),
    [
        (Rational(1129213793321, 500000000000) + Rational(243, 12500) * A[0], "2.25843 + 0.01944*a1"),
        (-A[0] * cos(Q[0]) / 2 + Rational(7, 3) * A[1], "7*a2/3 - a1*c1/2"),
        (cos(Q[0] + Rational(3, 20) * pi) * Rational(5, 4) / A[0], "1.25*cos(q1 + 3*pi/20)/a1"),
        (Rational(1, 3 * 10**9) * A[0] ** 2, "3.33333e-10*a1**2"),
        (A[0] + Integer(10) ** 7, "1e7 + a1"),
    ],
)
def test_digits_round_what_is_long_and_leave_what_is_short(expression: Any, printed: str) -> None:
    assert TextPrinter(PUMA, Notation.of(PUMA)).doprint(expression) == printed
    values = {symbol: VALUES[str(symbol)] for symbol in (*Q, *A)}
    names = {**SCOPE, "c1": math.cos(VALUES["q1"])}
    value = eval(TextPrinter(PUMA, Notation.of(PUMA)).doprint(expression), {"__builtins__": {}}, names)
    assert value == pytest.approx(float(expression.subs(values)), rel=1e-5)


def test_loss_of_digits_is_noticed() -> None:
    short, long = Rational(4318, 10000) * A[0], Rational(1234567, 10**6) * A[0]
    assert not loses_digits([short], decimals=True, digits=6)
    assert loses_digits([short, A[1] + cos(long)], decimals=True, digits=6)
    assert loses_digits([short], decimals=True, digits=3)
