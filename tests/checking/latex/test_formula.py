"""LaTeX as notes print it: what is read, and what is refused with its place."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import pytest

from derive.checking.formulas.findings import same_form
from derive.checking.latex.formula import read_latex
from derive.errors import CheckError, UnknownNameError
from derive.lecture.shorthand import read_formula
from derive.robot.expression import Expression
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from tests.lectures.results import ROBOT_FILES, document
from tests.lectures.robot_results import corpus_file

SCARA = Robot.load("scara-perugia-zup")
WRIST = Robot.load("spherical-wrist")

READ = [
    (r"c_1 \left(a_2 c_2 + a_1 c_{12}\right)", "c1*(a2*c2 + a1*c12)"),
    (r"$ a_1 $", "a1"),
    (r"-a_1\,s_1\;-\quad a_2~s_{12}", "-a1*s1 - a2*s12"),
    (r"a_1\cos\theta_1+a_2\cos(\theta_1+\theta_2)", "a1*c1 + a2*c12"),
    (r"a_1 \cos(\vartheta_1) a_2", "a1*c1*a2"),
    (r"\cos\theta_1\sin\theta_2", "c1*s2"),
    (r"\cos^2 q_1 + \sin^{2}(q_2)", "c1**2 + s2**2"),
    (r"\cos(q_1)^2", "c1**2"),
    (r"\cos 2\theta_1", "cos(2*q1)"),
    (r"\sin\frac{\theta_1}{2}", "sin(q1/2)"),
    (r"cos(q_1) + sin q_2", "c1 + s2"),
    (r"\frac{1}{2}a_1 + \tfrac12 a_2 + \dfrac{a_1}{a_2}", "a1/2 + a2/2 + a1/a2"),
    (r"a_1/2 + a_1 / a_2 \cdot c_1", "a1/2 + a1/a2*c1"),
    (r"m_{l_1} m_{\ell_1} m_{\mathrm{l}1} {m_l}_1", "ml1**4"),
    (r"I_{m_2} k_{r1}^2 k_{r_1}", "Im2*kr1**2*kr1"),
    (r"\dot{\theta}_1 \dot{q}_{1} \dot q_1 \dot{\theta_1} {\dot\theta}_1", "qd1**5"),
    (r"\ddot{\theta}_{1} + \ddot{q}_3 + \ddot d_3", "qdd1 + qdd3 + qdd3"),
    (r"\dot{\theta}_1^2", "qd1**2"),
    (r"q_3 d_3", "q3**2"),
    (r"c\theta_1 s\theta_2 + c_{\theta_1} + C_{12} + s_{1+2} + s_{1,2}", "c1*s2 + c1 + c12 + s12 + s12"),
    (r"\sqrt{1 - c_2^2}", "sqrt(1 - c2**2)"),
    (r"\operatorname{atan2}(s_2, c_2)", "atan2(s2, c2)"),
    (r"\big[ \{ (a_1 + a_2)^2 c_1 \} \bigr]^{2}", "((a1 + a2)**2*c1)**2"),
    (r"2 \times a_1 \cdot a_2 + \pi", "2*a1*a2 + pi"),
    (r"\mathbf{g} + 0.5 + .5a_1", "g + 0.5 + 0.5*a1"),
    (r"l_2c12 + l_2 s1", "l2*c12 + l2*s1"),
]


@pytest.mark.parametrize(("latex", "plain"), READ)
def test_it_reads_as_the_plain_formula(latex: str, plain: str) -> None:
    assert same_form(read_latex(latex, SCARA), read_formula(plain, SCARA))


@pytest.mark.parametrize(
    ("latex", "column", "message"),
    [
        (r"a_1 + \foo", 7, r"unknown macro '\foo'"),
        (r"a_1 + \thet_1", 7, "did you mean"),
        (r"a_1 \left( c_1", 15, "ends too early"),
        (r"a_1 c_1)", 8, "unexpected"),
        (r"a_1 = c_1", 5, "right-hand side"),
        (r"a_1 + c_12", 8, "write _{12}"),
        (r"a_1^12", 4, "write ^{12}"),
        (r"\cos\theta_1^2", 13, r"\cos^2"),
        (r"\cos^{-1} q_1", 1, "inverse function"),
        (r"\cos", 5, "ends too early"),
        (r"\theta_3", 1, "joint 3 is prismatic"),
        (r"\dot{a}_1", 6, "no joint variable"),
        (r"\dddot{q}_1", 1, "unknown macro"),
        (r"a_1'", 4, "prime"),
        (r"a_1 & c_1", 5, "one entry"),
        (r"a_1^{c_1}", 1, "exponent"),
        (r"a_1^{99}", 1, "exponent too large"),
        (r"\frac{a_1}{0}", 1, "division by zero"),
        (r"", 1, "empty formula"),
        (r"$$", 1, "empty formula"),
        (r"\pm a_1", 1, "one sign at a time"),
        (r"\input{/etc/passwd}", 1, "unknown macro"),
        (r"(a_1 + a_2)_1", 12, "subscript"),
    ],
)
def test_what_is_not_understood_is_refused_at_its_place(latex: str, column: int, message: str) -> None:
    with pytest.raises(CheckError) as caught:
        read_latex(latex, SCARA)
    assert message in str(caught.value)
    assert caught.value.location is not None
    assert (caught.value.location.line, caught.value.location.column) == (1, column)


def test_an_unknown_name_is_told_from_what_cannot_be_read() -> None:
    with pytest.raises(UnknownNameError, match=r"<latex>:1:7: unknown name 'a7'.*did you mean"):
        read_latex("a_1 + a_7", SCARA)


def test_names_are_matched_loosely_only_where_that_is_clear() -> None:
    robot = Robot.from_text("name: x\nconvention: standard\njoints: [{type: revolute, a: L_1, d: l_1, alpha: Izz1}]\n")
    assert read_latex("L_1 + l_1 + I_{1zz}", robot) == read_formula("L_1 + l_1 + Izz1", robot)
    clear = Robot.from_text("name: x\nconvention: standard\njoints: [{type: revolute, a: L_1}]\n")
    assert read_latex("l_1", clear) == read_formula("L_1", clear)


def test_greek_angles_may_stand_in_the_index_of_a_cosine() -> None:
    robot = Robot.load("dh-general-usp")
    angle = next(name for name in robot_symbols(robot) if name.startswith("alpha"))
    latex = rf"c_{{\{angle[:5]}_{{{angle[5:]}}}}}"
    assert read_latex(latex, robot) == read_formula(f"cos({angle})", robot)


def test_labels_are_those_of_the_joint_variables() -> None:
    assert read_latex(r"c_4 \cos\theta_5 \dot{q}_6", WRIST) == read_formula("c4*c5*qd6", WRIST)
    with pytest.raises(UnknownNameError):
        read_latex("c_1", WRIST)


@pytest.mark.parametrize(
    "text", ["(" * 5_000, r"\frac{" * 2_000, "((a_1+a_2)^{32})^{32}", "a_1 + " * 90_000 + "a_1", "2^{32}" * 300]
)
def test_hostile_formulas_are_refused_in_time(text: str) -> None:
    with pytest.raises(CheckError):
        read_latex(text, SCARA)


@pytest.mark.parametrize("text", ["{" * 39 + "a_1" + "}" * 39, "(" * 39 + "a_1" + ")" * 39, "a_1 + " * 6_000 + "a_1"])
def test_long_and_deep_formulas_are_read(text: str) -> None:
    assert read_latex(text, SCARA)


# -- the corpus, as it was printed


def cells(latex: str) -> Iterator[tuple[int, int, str]]:
    """Entries of a printed matrix."""
    body = re.search(r"\\begin\{[bp]matrix\}(.*)\\end\{[bp]matrix\}", latex, re.DOTALL)
    for i, row in enumerate(body[1].split(r"\\") if body else (), 1):
        for j, cell in enumerate(row.split("&"), 1):
            yield i, j, cell


def formulas(latex: str) -> Iterator[str]:
    """Right-hand sides of printed equations."""
    for part in re.split(r";|\\quad", latex):
        yield from (side.removesuffix("\\").strip() for side in part.split("=")[1:])


def entries(item: Mapping[str, Any]) -> dict[tuple[int, int], str]:
    if "matrix" in item:
        return {(i, j): t for i, row in enumerate(item["matrix"], 1) for j, t in enumerate(row, 1)}
    places = {tuple(map(int, f"{place},1".split(",")[:2])): text for place, text in item["entries"].items()}
    return {(i, j): text for (i, j), text in places.items()}


def printed_pairs() -> Iterator[tuple[str, Robot, str, list[Expression], Mapping[str, Expression]]]:
    """(file, robot, LaTeX, what it may say, abbreviations)."""
    for file in ROBOT_FILES:
        robot = corpus_file(file).robot
        for item in document(file)["expected"]:
            if "printed_as" not in item:
                continue
            short: dict[str, Expression] = {}
            for name, text in item.get("abbreviations", {}).items():
                short[name] = read_formula(text, robot)
            plain = {place: read_formula(str(text), robot) for place, text in entries(item).items()}
            for i, j, cell in cells(item["printed_as"]):
                if (i, j) in plain:
                    yield file, robot, cell, [plain[i, j]], short
            if "matrix}" not in item["printed_as"]:
                for side in formulas(item["printed_as"]):
                    yield file, robot, side, list(plain.values()), short


def test_the_printed_latex_says_what_the_plain_strings_say() -> None:
    agreed, different, unread = 0, [], []
    for file, robot, latex, plain, short in printed_pairs():
        try:
            found = read_latex(latex, robot, abbreviations=short)
        except CheckError as error:
            unread.append((file, latex, str(error)))
            continue
        if any(same_form(found, expression) for expression in plain):
            agreed += 1
        else:
            different.append((file, latex))
    assert agreed >= 300, (agreed, different, unread)
    assert different == [], different
