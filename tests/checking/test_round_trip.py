"""What is printed by ours and by books is found right, and slips are found."""

import random
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from derive.api.robots import load
from derive.checking.formulas.findings import Finding, Outcome, Role, judge
from derive.checking.formulas.printed import InverseText, PrintedText
from derive.checking.inverse.check import check_inverse
from derive.checking.latex.check import check_latex
from derive.checking.report import Item, errata_items, repaired_text
from derive.cli.main import main
from derive.errors import CheckError, DeriveError, Location
from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.render import fragment_text
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.model.quantities import REGISTRY
from derive.robot.options.handout import HandoutOptions
from derive.robot.robot import Robot
from tests.checking.latex.test_formula import read_latex
from tests.docs.errata import printouts
from tests.random_robots import catalogue, chains, swept_catalogue

ITEMS: list[dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("printed_solutions.yaml").read_text("utf-8"))
TEXTBOOKS = Path(__file__).parents[1] / "textbooks"
PLAIN = [item for item in ITEMS if "text" in item]


@cache
def model(robot: str) -> Model:
    file = TEXTBOOKS / f"{robot}.yaml"
    return Model(load(file if file.exists() else robot))


def checked(robot: str, text: str, latex: bool = False) -> tuple[Finding, ...]:
    where = Location("book")
    return check_inverse(model(robot), InverseText((PrintedText(text, where),), where, latex=latex))[0]


@pytest.mark.parametrize("item", ITEMS, ids=[item["book"] for item in ITEMS])
@pytest.mark.first(8)
def test_what_books_print_is_right(item: dict[str, Any]) -> None:
    found = checked(item["robot"], item.get("text") or item["latex"], "latex" in item)
    assert [finding.text for finding in found if not finding.verdict.equal] == []
    assert found[-1].text == item["says"]


NUMBER = re.compile(r"(?<=[ (*/+-])([acsdlpr][123xyz]|r[123][123])(?!\w)")
"""A name with an index, on the right of something."""

ARGUMENT = r"([^(),]+|[^(),]*\([^()]*\)[^(),]*)"
NEXT = {"x": "y", "y": "z", "z": "x", "1": "2", "2": "3", "3": "1"}


def slipped(text: str, kind: str, rng: random.Random) -> str | None:
    """A text with one slip of a kind; None where there is no place for one."""
    patterns = {
        "sign": r"(?<= )([-+])(?= (?!pi))",
        "order": rf"[aA]tan2\({ARGUMENT}, {ARGUMENT}\)",
        "square": r"\*\*2",
        "index": NUMBER.pattern,
        "plus-minus": r"(?<=[=(,] )\+-|(?<=\()\+-",
    }
    places = list(re.finditer(patterns[kind], text))
    if not places:
        return None
    match = rng.choice(places)
    before, old, after = text[: match.start()], match[0], text[match.end() :]
    match kind:
        case "sign":
            new = "-" if old == "+" else "+"
        case "order":
            new = f"{old[:6]}{match[2]}, {match[1]})"
        case "index":
            new = old[:-1] + NEXT[old[-1]]
        case _:
            new = ""
    return before + new + after


def slips(count: int, seed: int) -> list[tuple[str, str, str]]:
    """Robots, kinds and texts with one slip each; the same ones each time."""
    rng, found = random.Random(seed), dict[tuple[str, str], str]()
    kinds = ("sign", "order", "square", "index", "plus-minus")
    for k in range(20 * count):
        item, kind = rng.choice(PLAIN), kinds[k % len(kinds)]
        if (text := slipped(item["text"], kind, rng)) not in (None, item["text"]) and len(found) < count:
            found[item["robot"], str(text)] = kind
    return [(robot, kind, text) for (robot, text), kind in found.items()]


def caught(robot: str, text: str) -> bool | None:
    """Whether a slip is found with what repairs it; None where it is no formula any more."""
    try:
        found = checked(robot, text)
    except CheckError as error:
        return None if error.location else False
    wrong = [finding for finding in found if not finding.verdict.equal]
    lines = [finding for finding in wrong if finding.role is Role.SOLUTION]
    return bool(lines) and all(judge(finding).repair is not None for finding in lines)


SWEPT = [pytest.param(*slip, marks=pytest.mark.sweep) for slip in slips(200, 9)]


@pytest.mark.first(3)
@pytest.mark.parametrize(("robot", "kind", "text"), [*slips(14, 5), *SWEPT])
def test_every_slip_is_found_and_repaired(robot: str, kind: str, text: str) -> None:
    assert caught(robot, text) is not False, kind


LATEX_SLIPS = [
    ("Craig 4.7, PUMA 560", "- r_{33}s_{23}c_4)", "+ r_{33}s_{23}c_4)", "sign of the 3rd term"),
    ("Craig 4.7, PUMA 560", "- K^2})", "- K})", "exponent: K**2 instead of K"),
    ("Craig 4.7, PUMA 560", r" \text{ or } \theta_4 + 180^\circ", "", "second solution missing: or q4 + pi"),
    ("Craig 4.7, PUMA 560", "(p_y, p_x)", "(p_x, p_y)", "order of the arguments: atan2(py, px)"),
    ("Perugia (document 004), SCARA, its two errata corrected", "c_2^2}", "c_2}", "exponent: c2**2 instead of c2"),
    ("Perugia (document 004), SCARA, its two errata corrected", "-o_z - d_4", "o_z + d_4", "sign of the whole"),
]


@pytest.mark.first(2)
@pytest.mark.parametrize(("book", "old", "new", "said"), LATEX_SLIPS)
def test_a_slip_in_latex_is_named(book: str, old: str, new: str, said: str) -> None:
    (item,) = (item for item in ITEMS if item["book"] == book)
    assert old in item["latex"]
    found = checked(item["robot"], item["latex"].replace(old, new), latex=True)
    (wrong,) = (f for f in found if not f.verdict.equal and f.role is Role.SOLUTION)
    repair = judge(wrong).repair
    assert said in repair.text


USUAL = ("planar-3r", "scara-perugia", "spherical-wrist", "skeleton-root")
OTHERS = (
    "anthropomorphic-arm", "anthropomorphic-wrist", "kuka-kr5", "planar-2r-perugia", "puma560-corke", "puma560-laschi",
    "puma560-usp", "scara-bajd", "scara-matlab", "scara-perugia-zup", "scara-sankyo", "skeleton", "skeleton-modified",
    "spherical-arm", "stanford-deluca", "stanford-laschi", "thumb",
)  # fmt: skip
MARKS = [pytest.mark.sweep if k % 3 == 0 else pytest.mark.release for k in range(len(OTHERS))]


@pytest.mark.first(5)
@pytest.mark.parametrize("form", ["text", "latex", "python"])
@pytest.mark.parametrize(
    "robot", [*USUAL, *(pytest.param(name, marks=mark) for name, mark in zip(OTHERS, MARKS, strict=True))]
)
def test_what_is_shown_is_right_and_complete(robot: str, form: str) -> None:
    model = Model(load(robot))
    lines = derivation_lines(model.inverse, form, Notation.of(model.robot))
    if form == "text":  # formulas alone, without the words around them
        lines = [line for line in lines if line.startswith("   ") and " = " in line and " if " not in line]
    where, task = Location(form), model.robot.inverse.task
    solution = InverseText((PrintedText("\n".join(lines), where),), where, task, latex=form == "latex")
    findings, _ = check_inverse(model, solution)
    assert [finding.text for finding in findings if not finding.verdict.equal] == []
    assert findings[-1].role is Role.BRANCHES
    count = model.inverse.count
    assert findings[-1].text.startswith(f"all {count} solutions" if count > 1 else "the one solution")
    assert any(finding.same for finding in findings)


LONGEST = 3_000
QUICK = ("planar-2r-perugia", "spherical-wrist")
LONG_CHAIN = 8
"""Joints from which only the transforms of the rows are short enough to be read."""


def quantities(model: Model) -> Iterator[str]:
    """Every quantity that the robot has, with indices where it takes some."""
    n = model.robot.n
    for row in REGISTRY.values():
        if row.name == "inverse":  # solutions are lines, no entries
            continue
        for indices in ("", "[1]", f"[0,{n}]", "[1,2]", "[1,1,2]"):
            name = row.name + indices
            if indices.count(",") + bool(indices) not in row.indices:
                continue
            try:
                value = model.quantity(name)
            except DeriveError:
                continue
            if 0 not in getattr(value, "shape", ()):
                yield name


@pytest.mark.parametrize("name", swept_catalogue(LONG_CHAIN - 1, usual=QUICK))
def test_what_show_prints_is_read_back(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    model = Model(Robot.load(name))
    for quantity in quantities(model):
        assert main(["show", name, quantity, "--format", "latex"]) == 0
        printed, asked = capsys.readouterr().out, quantity
        if quantity == "singularities":  # a configuration in which it is zero is no formula for it
            printed, asked = "\n".join(line for line in printed.splitlines() if "\\det \\mathbf" in line), ""
        findings = check_latex(model, printed, asked).findings if printed else ()
        assert findings or not (printed or model.singularities.blocks)
        assert all(finding.unknown is None and finding.verdict.equal for finding in findings), quantity


FRAGMENTS = ("T", "J", "A[1]", "T[0,1]", "B", "C", "g", "tau", "potential", "kinetic")


@pytest.mark.parametrize("name", swept_catalogue(LONG_CHAIN - 1, usual=QUICK))
def test_fragments_of_the_handout_are_read_back(name: str) -> None:
    robot = Robot.load(name)
    model = Model(robot)
    for quantity in FRAGMENTS:
        if robot.has_dynamics or not REGISTRY[quantity.split("[")[0]].dynamic:
            report = check_latex(model, fragment_text(robot, HandoutOptions(), quantity), document=True)
            long = [skipped for skipped in report.skipped if "\\colon" in skipped.text]  # printed as a number of terms
            assert len(long) == len(report.skipped), quantity
            assert all(finding.verdict.equal for finding in report.findings), quantity


@pytest.mark.first(4)
@pytest.mark.parametrize("name", [name for name in chains() if catalogue()[name].n <= 7])
def test_printed_latex_is_read_back(name: str) -> None:
    robot = Robot.load(name)
    model, latex = Model(robot), LatexPrinter(Notation.of(robot)).latex
    names = ["T", "J", *(["B", "C", "g", "tau"] if robot.has_dynamics and robot.n < 5 else [])]
    for entry in (entry for quantity in names for entry in model.quantity(quantity)):
        text = latex(entry)
        if len(text) <= LONGEST:
            assert compare(robot, expression_from_sympy(entry), read_latex(text, robot)).equal, text


ERRATA = 26
WRONG = 35


@cache
def errors() -> tuple[Item, ...]:
    """Without what only differs by a convention of signs."""
    return tuple(item for item in errata_items(printouts()) if item.findings[0].remark.kind != "convention")


@pytest.mark.sweep
def test_every_erratum_is_found_with_the_change_of_its_correction_and_nothing_else() -> None:
    found = [finding for item in errors() for finding in item.findings]
    assert (len(errors()), len(found)) == (ERRATA, WRONG)
    assert all(finding.erratum for finding in found)
    assert {judge(finding).outcome for finding in found} == {Outcome.WRONG}
    changes = {item.findings[0].entry: [judge(finding).repair for finding in item.findings] for item in errors()}
    single = [name for name, repairs in changes.items() if all(r is not None and len(r.kinds) == 1 for r in repairs)]
    double = [name for name, repairs in changes.items() if all(r is not None and len(r.kinds) == 2 for r in repairs)]
    assert len(single) == 24, single
    assert double == ["T[][1,2]", "Newton-Euler, link frame: vd (prismatic joint)"]
    agree, differ = 0, []
    for item in errors():
        corrections = {f.entry: f.text for f in item.printout.report.findings if f.role.value == "correction"}
        for finding in item.findings:
            correct = corrections[finding.entry]
            same = repaired_text(finding).replace(" ", "") == correct.replace(" ", "")
            agree, differ = agree + same, [*differ, *([] if same else [(repaired_text(finding), correct)])]
    assert agree >= 31, differ
    wrong = [f for p in printouts() for f in p.report.findings if not f.verdict.equal and not f.erratum]
    assert wrong == []
