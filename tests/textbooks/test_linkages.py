"""Trees, coupled joints and closed loops of textbooks: all is right, most comes out as printed, and slips are told."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from derive.api.check import check_formula, check_inverse, check_latex
from derive.checking.comparison import check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import FileReport, Finding, Outcome, Role, compared, judge
from derive.errors import QuantityError
from derive.robot.expression import Expression, Name, is_constant, multiply, names, negate, number, substitute
from derive.robot.robot import Robot
from tests.random_robots import sampled

FILES = sorted((Path(__file__).parent / "linkages").glob("*.yaml"))
QUICK = [path for path in FILES if "norton" not in path.stem]
SAME = 0.85
every = pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)


@cache
def report(path: Path) -> FileReport:
    return check_file(corpus_from_bytes(path.read_bytes(), str(path)))


def moving(found: FileReport) -> list[Finding]:
    """What is printed and no constant."""
    return [f for f in found.findings if f.question is not None and not is_constant(f.question.printed)]


def slips(e: Expression, right: Expression) -> Iterator[Expression]:
    """A wrong sign, a wrong factor and a wrong index or letter."""
    yield from (negate(e), multiply(number(2), e))
    known = sorted({*names(e), *names(right)})
    if len(known) > 1:
        yield substitute(e, {known[0]: Name(known[1])})


@pytest.mark.first(4)
@every
def test_every_formula_is_right(path: Path) -> None:
    found = report(path)
    assert found.passed
    assert all(f.verdict.exact or f.verdict.configurations for f in found.findings)  # how it is known is said


def test_most_come_out_as_printed() -> None:
    printed = [f for path in FILES for f in moving(report(path)) if f.role is not Role.IDENTITY]
    same = sum(judge(f).outcome is Outcome.SAME_FORM for f in printed)
    assert same >= SAME * len(printed), f"{same} of {len(printed)}"


@pytest.mark.parametrize("path", sampled(FILES, QUICK), ids=lambda path: path.stem)
def test_slips_are_told(path: Path) -> None:
    told, repaired = 0, list[bool]()
    for f in moving(report(path)):
        assert f.question is not None
        for slip in slips(f.question.printed, f.question.right):
            question = replace(f.question, printed=slip)
            if slip != f.question.printed:
                found = compared(question, f.quantity, (f.row, f.column), f.role, f.text, f.right, f.location)
                assert not found.verdict.equal, (f.entry, slip)
                assert found.verdict.exact or found.verdict.counter_example is not None
                told += 1
                repaired += [judge(found).repair is not None] if f.role is Role.IDENTITY else []
    assert told
    assert any(repaired) or not repaired


def test_what_is_asked_of_a_tree_says_of_which_end() -> None:
    pendulums = Robot.load(FILES[-1])
    latex = r"p_{first} = \begin{bmatrix} -l_1 c_2 \\ 0 \\ q_1 + l_1 s_2 \end{bmatrix}"
    assert [check_latex(pendulums, text).passed for text in (latex, latex.replace("first", "second"))] == [True, False]
    with pytest.raises(QuantityError, match=r"several ends; allowed: p\[first\]\[1\], p\[second\]\[1\]"):
        check_formula(pendulums, "p[1]", "0")
    with pytest.raises(QuantityError, match="a check of inverse kinematics of two-pendulums, whose table is a tree"):
        check_inverse(pendulums, "q2 = 0")
