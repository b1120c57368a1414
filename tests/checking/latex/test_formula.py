"""How LaTeX is read: grammar, names, pieces, matrices, typography."""

import re
from collections.abc import Iterator, Mapping
from typing import Any

import pytest
from lark.exceptions import UnexpectedInput

from derive.checking.latex.formula import LatexReader
from derive.checking.latex.grammar import parsed
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.names import LatexNames, Symbol
from derive.checking.latex.pieces import MATRIX_MARK, LatexPiece, display_piece
from derive.checking.latex.typography import cleaned
from derive.errors import CheckError, Location, UnknownNameError
from derive.lecture.shorthand import read_formula
from derive.model.equality import same_form
from derive.robot.expression import Call, Expression, Name, Pi, add, multiply, negate
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from tests.lectures.results import ROBOT_FILES, corpus_file, document
from tests.refusals import one_message
from tests.rows import robot_of_rows

SCARA = Robot.load("scara-perugia-zup")
WRIST = Robot.load("spherical-wrist")


def read_latex(text: str, robot: Robot, abbreviations: Mapping[str, Expression] | None = None) -> Expression:
    reader = LatexReader(LatexNames(robot, abbreviations or {}), text, Location("<latex>"))
    return reader.formula(LatexPiece(cleaned(text), 0))


READ = [
    (r"c_1 \left(a_2 c_2 + a_1 c_{12}\right)", "c1*(a2*c2 + a1*c12)"),
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
        (r"\dot{a}_1", 6, "not a joint variable"),
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
    with one_message(CheckError, f"<latex>:1:{column}", message):
        read_latex(latex, SCARA)


def test_labels_are_those_of_the_joint_variables_and_other_names_unknown() -> None:
    with pytest.raises(UnknownNameError, match=r"<latex>:1:7: unknown name 'a7'.*did you mean"):
        read_latex("a_1 + a_7", SCARA)
    assert read_latex(r"c_4 \cos\theta_5 \dot{q}_6", WRIST) == read_formula("c4*c5*qd6", WRIST)
    with pytest.raises(UnknownNameError):
        read_latex("c_1", WRIST)


def test_names_are_matched_loosely_only_where_that_is_clear_and_greek_angles_may_stand_in_an_index() -> None:
    robot = robot_of_rows("R a: L_1, d: l_1, alpha: Izz1")
    assert read_latex("L_1 + l_1 + I_{1zz}", robot) == read_formula("L_1 + l_1 + Izz1", robot)
    clear = robot_of_rows("R a: L_1")
    assert read_latex("l_1", clear) == read_formula("L_1", clear)
    robot = Robot.load("dh-general-usp")
    angle = next(name for name in robot_symbols(robot) if name.startswith("alpha"))
    latex = rf"c_{{\{angle[:5]}_{{{angle[5:]}}}}}"
    assert read_latex(latex, robot) == read_formula(f"cos({angle})", robot)


@pytest.mark.parametrize(
    "text", ["(" * 5_000, r"\frac{" * 2_000, "((a_1+a_2)^{32})^{32}", "a_1 + " * 90_000 + "a_1", "2^{32}" * 300]
)
def test_hostile_formulas_are_refused_in_time(text: str) -> None:
    with pytest.raises(CheckError):
        read_latex(text, SCARA)


@pytest.mark.parametrize("text", ["{" * 39 + "a_1" + "}" * 39, "(" * 39 + "a_1" + ")" * 39, "a_1 + " * 6_000 + "a_1"])
def test_long_and_deep_formulas_are_read(text: str) -> None:
    assert read_latex(text, SCARA)


def cells(latex: str) -> Iterator[tuple[int, int, str]]:
    body = re.search(r"\\begin\{[bp]matrix\}(.*)\\end\{[bp]matrix\}", latex, re.DOTALL)
    for i, row in enumerate(body[1].split(r"\\") if body else (), 1):
        for j, cell in enumerate(row.split("&"), 1):
            yield i, j, cell


def formulas(latex: str) -> Iterator[str]:
    for part in re.split(r";|\\quad", latex):
        yield from (side.removesuffix("\\").strip() for side in part.split("=")[1:])


def entries(item: Mapping[str, Any]) -> dict[tuple[int, int], str]:
    if "matrix" in item:
        return {(i, j): t for i, row in enumerate(item["matrix"], 1) for j, t in enumerate(row, 1)}
    return {tuple(map(int, f"{place},1".split(",")[:2])): text for place, text in item["entries"].items()}


def printed_pairs() -> Iterator[tuple[str, Robot, str, list[Expression], Mapping[str, Expression]]]:
    """(file, robot, LaTeX, what it may say, abbreviations)."""
    for file in ROBOT_FILES:
        robot = corpus_file(file).robot
        for item in document(file)["expected"]:
            if "printed_as" not in item:
                continue
            short = {name: read_formula(text, robot) for name, text in item.get("abbreviations", {}).items()}
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


ARM = robot_of_rows("R a: l_1, alpha: alpha1 | R a: ml1 | P")


def meaning(text: str, dots: int = 0) -> Expression:
    return LatexNames(ARM).meaning(Symbol(text, 0, dots))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("pi", Pi()),
        ("l_1", Name("l_1")),
        ("l1", Name("l_1")),
        ("m1l", Name("ml1")),
        ("ML1", Name("ml1")),
        ("theta2", Name("q2")),
        ("q3", Name("q3")),
        ("d3", Name("q3")),
        ("c12", Call("cos", (add(Name("q1"), Name("q2")),))),
        ("sq1q2", Call("sin", (add(Name("q1"), Name("q2")),))),
        ("calpha1", Call("cos", (Name("alpha1"),))),
    ],
)
def test_a_printed_name_stands_for_one_thing(text: str, expected: Expression) -> None:
    assert meaning(text) == expected


def test_dots_are_rates_and_two_ways_to_read_a_name_are_one_too_many() -> None:
    assert meaning("theta1", 1) == Name("qd1")
    assert meaning("q3", 2) == Name("qdd3")
    with pytest.raises(CheckError, match="two ways"):
        LatexNames(robot_of_rows("R a: m_1, d: m_1_")).meaning(Symbol("m1", 0))
    assert LatexNames(ARM).circular(Symbol("c", 0)) == "cos"
    assert LatexNames(robot_of_rows("R a: c")).circular(Symbol("c", 0)) == ""


@pytest.mark.parametrize(("text", "dots"), [("zz", 0), ("theta3", 0), ("l1", 1), ("q1", 3)])
def test_other_names_are_refused(text: str, dots: int) -> None:
    with pytest.raises(CheckError):
        meaning(text, dots)


COLUMN = Table(((Entry(Name("a1")),), (Entry(Name("a2")),)))


def made(text: str) -> Expression | Table:
    tables = {i: COLUMN for i, sign in enumerate(text) if sign == MATRIX_MARK}
    return parsed(text, LatexNames(SCARA), tables)


def test_a_matrix_is_scaled_added_and_transposed_and_what_is_outside_the_grammar_refused() -> None:
    table = made(f"2{MATRIX_MARK} + {MATRIX_MARK}")
    assert isinstance(table, Table)
    assert [row[0].formula for row in table.rows] == [read_formula(f"2*{a} + {a}", SCARA) for a in ("a1", "a2")]
    assert made(f"{MATRIX_MARK}^T") == COLUMN.transposed
    with pytest.raises(UnexpectedInput):
        made("a_1 +")


START = Location("notes.tex")


def piece(text: str) -> LatexPiece:
    return display_piece(text, 0, len(text), text, START)


def test_a_matrix_is_one_sign_with_entries_of_its_own_and_bars_make_a_determinant() -> None:
    whole = piece(r"T = \begin{bmatrix} a & b \\ \frac{c}{d} & e \\ \end{bmatrix}^T")
    assert whole.text.replace(" ", "") == f"T={MATRIX_MARK}^T"
    cells = [[cell.text.strip() for cell in row] for row in whole.matrices[0].rows]
    assert cells == [["a", "b"], [r"\frac{c}{d}", "e"]]
    for text in (r"\begin{vmatrix} a \end{vmatrix}", r"\left| \begin{array}{c} a \end{array} \right|"):
        assert piece(text.replace(r"\left", "").replace(r"\right", "")).matrices[0].is_determinant
    assert not piece(r"\begin{bmatrix} a \end{bmatrix}").matrices[0].is_determinant


def test_a_part_keeps_its_own_matrices_and_nested_environments_have_a_limit() -> None:
    text = r"\begin{matrix} a \end{matrix} + \begin{matrix} b \\ c \end{matrix}"
    whole = piece(text)
    second = whole.part(whole.text.index("+"), len(whole.text))
    entries = [row[0] for row in second.matrices[0].rows]
    assert [text[entry.start : entry.end] for entry in entries] == ["b", "c"]
    assert [t.strip() for t in second.texts] == [second.text.strip(), "b", "c"]
    with pytest.raises(CheckError, match="nested too deeply"):
        piece(r"\begin{split}" * 12 + "a" + r"\end{split}" * 12)


a, b, c, d = map(Name, "abcd")


def table(*rows: tuple[Name, ...]) -> Table:
    return Table(tuple(tuple(Entry(name, name.name, 7) for name in row) for row in rows))


def test_sums_products_transposes_and_determinants_of_tables() -> None:
    square = table((a, b), (c, d))
    assert square.transposed.rows[0][1].formula == c
    assert square.plus(square).rows[0][0].formula == add(a, a)
    assert square.times(table((a,), (b,))).rows[1][0].formula == add(multiply(c, a), multiply(d, b))
    assert table((a, b), (c, d)).determinant.formula == add(multiply(a, d), negate(multiply(b, c)))
    assert square.transposed.rows[0][0].text == "a"
    assert square.changed(negate).rows[0][0] == Entry(negate(a), "", 7)
    row = table((a, b))
    for refused in (lambda: row.plus(row.transposed), lambda: row.times(row), lambda: row.determinant):
        with pytest.raises(CheckError):
            refused()


@pytest.mark.parametrize(
    ("typed", "left"),
    [
        (r"a_1 % a_2", "a_1"),
        (r"\left( a_1 \right.", "( a_1"),
        (r"\biggl[ a_1 \Bigr]", "[ a_1 ]"),
        (r"\label{eq:x} a_1 \tag{1} \nonumber", "a_1"),
        (r"\boxed{x = a_1}", "x = a_1"),
        (r"\underbrace{a_1 + a_2}_{\text{length}} c_1", "{a_1 + a_2} c_1"),
        (r"\frac{d}{d t} q_1{\left(t \right)}", r"\dot q_1"),
        (r"\frac{d^{2}}{d t^{2}} q_1(t)", r"\ddot q_1"),
        (r"\frac{d\theta_1}{dt} a_1", r"\dot {\theta_1} a_1"),
        ("\\theta _1'(t)^2", "\\theta _1\ue001 ^2"),
        (r"\operatorname{q_{1}}{\left(t \right)}", "{q_{1}}"),
        ("a\u00b7b \u2212 c", "a*b - c"),
        (r"\mathrm{sin}", r"\mathrm{sin}"),
    ],
)
def test_only_what_means_something_stays(typed: str, left: str) -> None:
    assert cleaned(typed).split() == left.split()
    assert len(cleaned(typed)) == len(typed)


def test_lines_stay_lines_and_t_is_a_name_where_the_robot_has_one() -> None:
    assert cleaned("a % b\n\\left(c").count("\n") == 1
    assert cleaned("q(t)", time=False) == "q(t)"
