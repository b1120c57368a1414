"""Comparisons of printed formulas with derived ones, and the verdict on each: same form, equal, or wrong and why."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import Enum, StrEnum
from fractions import Fraction
from functools import lru_cache
from itertools import islice, takewhile
from math import floor, log10

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.quotients import opaque
from derive.checking.formulas.branches import ARCS, ONLY_AT_POINTS, branches, has_branches
from derive.checking.formulas.diagnosis import Question, Repair, diagnose
from derive.checking.formulas.edits import float_value
from derive.checking.formulas.printed import NO_CITATION, NO_REMARK, Citation, Remark
from derive.errors import CheckError, DeriveError, Location, placed
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr, expression_from_sympy, expression_to_sympy
from derive.model.equality import Verdict, compare, same_form, samples
from derive.robot import expression as tree
from derive.robot.expression import Call, Expression, Name, Number, Pi, Sum
from derive.robot.options.style import NAMED_STYLES
from derive.robot.robot import Robot
from derive.robot.units import are_units_clear, in_file_units, symbol_unit

MAX_DIFFERENCE_TERMS = 20_000  # of a difference; beyond them none is shown, since nobody would find the slip in it
ROUNDED = range(5, 18)  # significant digits of decimals that count as rounded; 9.81 and 0.4318 are meant as they stand
ROUNDING_POINTS = 12  # points at which a difference must be as small as rounding explains
_SLACK = 1.05  # more than what the squares of rounding errors add
NOTHING_KNOWN = Verdict(equal=False, exact=True)  # stands where no verdict is possible


class Role(Enum):
    """What a compared formula is in its file."""

    PRINTED = "printed"
    ABBREVIATED = "abbreviated"
    REST = "rest"
    CORRECTION = "correction"
    IDENTITY = "identity"
    FACTORISATION = "factorisation"
    SOLUTION = "solution"
    BRANCHES = "branches"
    PRODUCT = "product"
    EQUATION = "equation"


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """One comparison."""

    quantity: str  # what the formula is printed for, without the place of the entry
    row: int  # row of the entry, from 1; 0 where the whole is one formula
    column: int  # column of the entry, from 1; 0 where the whole is a vector or one formula
    role: Role  # what the formula is in its file
    text: str  # the formula as printed
    verdict: Verdict  # whether it is right; `NOTHING_KNOWN` where that cannot be decided
    right: Expr  # the derived formula
    location: Location  # where it stands
    erratum: bool = False  # whether the file marks it as wrong
    question: Question | None = None  # what a search for the slip starts from; None where the formula is no single tree
    repair: Repair | None = None  # what repairs it, where that was found with the comparison
    remark: Remark = NO_REMARK  # what the file says about it
    unknown: CheckError | None = None  # the name that the robot does not know: nothing can be decided
    same: bool = False  # whether it is known to have the form of the derived one
    some: bool = False  # whether it is right for some branches of a solution
    missing: tuple[str, ...] = ()  # names of the branches that are missing
    note: str = ""  # what is said behind the verdict
    cause: str = ""  # one change that makes all wrong entries of its matrix right

    @property
    def entry(self) -> str:
        """The quantity with its place: ``B[1,2]``, ``A[1][2,4]``, ``g[3]``."""
        indices = ",".join(str(i) for i in (self.row, self.column) if i)
        bracket = "[]" if self.quantity == "T" else ""
        return f"{self.quantity}{bracket}[{indices}]" if indices else self.quantity


def verdict_at(where: Location, robot: Robot, right: Expression, printed: Expression) -> Verdict:
    """Whether a printed formula is right."""
    with placed(where):
        verdict = compare(robot, right, printed)
    if verdict.counter_example is None:
        return verdict
    if numbers := _lacking(robot, right, printed):
        # the page has numbers where the file has symbols, whose numbers it gives, in SI units or in its own
        is_own = robot.units.millimetres and are_units_clear(robot)
        typed = {n: in_file_units(x, symbol_unit(robot, n), robot.units) for n, x in numbers.items() if is_own}
        if any(compare(robot, tree.substitute(right, x), tree.substitute(printed, x)).equal for x in (numbers, typed)):
            return Verdict(equal=True, exact=False)
        right, printed = tree.substitute(right, numbers), tree.substitute(printed, numbers)
    if robot.units.millimetres and compare(robot, tree.multiply(tree.number(1000), right), printed).equal:
        return Verdict(equal=True, exact=False)  # numbers of the page are in the units of the file
    return Verdict(equal=True, exact=False) if _within_rounding(robot, right, printed) else verdict


def _lacking(robot: Robot, right: Expression, printed: Expression) -> dict[str, Expression]:
    """The numbers of the file for symbols that the page does not have: one symbol for another stays a slip."""
    symbols = {*tree.names(right)} - {*tree.names(printed)}
    return {name: value for name, value in robot.parameters if name in symbols}


def compared(
    question: Question, quantity: str, place: tuple[int, int], role: Role, text: str, right: Expr, where: Location
) -> Finding:
    """The comparison that a question asks; right is what is shown for the right formula."""
    robot, sides = question.robot, (question.right, question.printed)
    # as it stands where the two are compared at points, branch by branch: no search for the slip starts from there
    plain = Finding(quantity, *place, role, text, NOTHING_KNOWN, right, where)
    only_points = any(has_branches(side, ONLY_AT_POINTS) for side in sides)
    is_same = not only_points and same_form(*sides)
    verdict = NOTHING_KNOWN if only_points else Verdict(True, True) if is_same else verdict_at(where, robot, *sides)
    # a root is one value, but for an equation between joint variables, such as s_2 = sqrt(1 - c_2^2)
    several = (*ARCS, "sqrt") if role is Role.IDENTITY else ARCS
    if not verdict.equal and any(has_branches(side, several) for side in sides):
        (points, alike), numbers = branches(robot, *sides), _lacking(robot, *sides)
        if not alike and numbers:  # the page has numbers where the file has symbols
            one, other = (tree.substitute(side, numbers) for side in sides)
            points, alike = branches(robot, one, other)
        if only_points and not points:
            if branches(robot, question.right, question.right)[0]:
                note = ", with no real value at any of many random points"
                return replace(plain, verdict=Verdict(equal=False, exact=False), note=note)
            found = "formula without a real value at any of many random points"
            raise CheckError(found, remedy="check its roots and denominators", location=where)
        if alike or only_points:  # equal at some of the points only: the other ones belong to other branches
            verdict = Verdict(alike > 0, False, configurations=alike if robot.passive else 0)
            return replace(plain, verdict=verdict, some=0 < alike < points)
    note, turned = "", question.printed if verdict.equal else in_degrees(question.printed)
    if turned != question.printed and verdict_at(where, robot, question.right, turned).equal:
        verdict, note = Verdict(equal=True, exact=True), ", with its angles in degrees"
    return replace(plain, verdict=verdict, question=question, note=note, same=is_same)


def in_degrees(formula: Expression) -> Expression:
    """A formula in which whole numbers that are added to an angle, as in cos(180 - theta2), are degrees."""
    match formula:
        case Call("sin" | "cos" | "tan", (Sum(terms),)) if any(
            isinstance(x, Number) and abs(x.value) >= 30 for x in terms
        ):
            turn = (Number(Fraction(1, 180)), Pi())
            turned = (tree.multiply(term, *turn) if isinstance(term, Number) else term for term in terms)
            return Call(formula.function, (tree.add(*turned),))
        case Call("sin" | "cos" | "tan"):
            return formula
    return tree.rebuilt(formula, in_degrees)


def _within_rounding(robot: Robot, right: Expression, printed: Expression) -> bool:
    """Whether rounding each printed decimal to as many digits as the longest one has explains a difference."""
    decimals: dict[str, Fraction] = {}
    marked = _with_marked_decimals(printed, decimals)
    digits = max((significant(value) for value in decimals.values()), default=0)
    if digits not in ROUNDED:
        return False
    halves = {name: 0.5 * 10.0 ** (floor(log10(abs(value))) - digits + 1) for name, value in decimals.items()}
    wanted = sorted({*tree.names(right), *tree.names(printed)})

    def is_explained() -> Iterator[bool]:
        for sample in samples(robot, wanted):
            values = {name: float(value) for name, value in (sample | decimals).items()}
            with suppress(ArithmeticError, ValueError):
                there = float_value(marked, values)
                # first-order error propagation: half a unit of the last digit of each decimal, all with the worst sign
                changes = (float_value(marked, {**values, n: values[n] + half}) - there for n, half in halves.items())
                yield abs(there - float_value(right, values)) <= _SLACK * sum(map(abs, changes)) + 1e-12 * abs(there)

    return [*takewhile(bool, islice(is_explained(), ROUNDING_POINTS))] == [True] * ROUNDING_POINTS


def _with_marked_decimals(e: Expression, decimals: dict[str, Fraction]) -> Expression:
    """A formula with a name for each of its decimals, which are collected."""
    if isinstance(e, Number) and significant(e.value):
        name = f"(decimal {len(decimals)})"
        decimals[name] = e.value
        return Name(name)
    return tree.rebuilt(e, lambda part: _with_marked_decimals(part, decimals))


def significant(value: Fraction) -> int:
    """Significant digits of a decimal; 0 of a fraction that is none, or of a whole number."""
    if value.denominator == 1:
        return 0
    scaled = value * 10**24  # a decimal has no more places
    return len(str(abs(scaled.numerator)).strip("0")) if scaled.denominator == 1 else 0


def undecidable(quantity: str, place: tuple[int, int], role: Role, text: str, unknown: CheckError) -> Finding:
    """A formula with an unknown name; it is placed at that name."""
    return Finding(quantity, *place, role, text, NOTHING_KNOWN, "", unknown.location or Location(""), unknown=unknown)


@dataclass(frozen=True, slots=True)
class Skipped:
    """An equation that was not compared."""

    location: Location  # where it stands
    reason: str  # why not
    text: str = ""  # its beginning


@dataclass(frozen=True, slots=True)
class FileReport:
    """Everything that was compared in one file."""

    source: str  # name of the file
    robot: str  # name of its robot
    findings: tuple[Finding, ...]  # one for each comparison, in the order of the file
    unread: tuple[str, ...] = ()  # blocks that were not compared
    document: Citation = NO_CITATION  # where all this is printed
    readings: tuple[str, ...] = ()  # how the document as a whole is read, where that is not the usual way

    @property
    def wrong(self) -> tuple[Finding, ...]:
        """The comparisons that found a difference."""
        return tuple(f for f in self.findings if f.unknown is None and not f.verdict.equal)

    @property
    def undecidable(self) -> tuple[Finding, ...]:
        """The formulas about which nothing can be said, because of a name that the robot does not know."""
        return tuple(f for f in self.findings if f.unknown is not None)

    @property
    def equal(self) -> int:
        """How many formulas are right as printed."""
        return len(self.findings) - len(self.wrong) - len(self.undecidable)

    @property
    def passed(self) -> bool:
        """Whether everything is right as printed."""
        return not self.wrong and not self.undecidable


class Outcome(StrEnum):
    """The verdict on one formula."""

    SAME_FORM = "same form"  # right, and written as the lecture form writes it
    EQUAL = "equal"  # right, written in another way
    SOME = "right for some branches"  # right for some branches of an inverse solution only
    WRONG = "wrong"  # not equal
    UNDECIDABLE = "undecidable name"  # a name that the robot does not know; nothing can be said


@dataclass(frozen=True, slots=True)
class Judgement:
    """The verdict on one formula and the reasons."""

    outcome: Outcome  # the verdict
    difference: tuple[Expr, ...] = ()  # terms of printed minus right, where it is wrong and both are polynomials
    repair: Repair | None = None  # the smallest change that makes it right, if one was found


@lru_cache(maxsize=10_000)
def judge(finding: Finding) -> Judgement:
    """The verdict on a comparison."""
    question = finding.question
    if finding.unknown is not None:
        return Judgement(Outcome.UNDECIDABLE)
    if finding.some:
        return Judgement(Outcome.SOME, repair=finding.repair)
    if finding.verdict.equal:
        same = finding.same or (question is not None and same_form(question.printed, question.right))
        return Judgement(Outcome.SAME_FORM if same else Outcome.EQUAL)
    return Judgement(Outcome.WRONG, repair=finding.repair) if question is None else _reasons(question)


@lru_cache(maxsize=10_000)  # a finding that is told in another way asks the same question
def _reasons(question: Question) -> Judgement:
    terms = _difference_terms(question) if question.compared is None else ()
    lacking: tuple[Expression, ...] = ()
    if len(terms) == 1:  # a difference of one term is a term too many or too few
        with suppress(DeriveError):
            lacking = (expression_from_sympy(sympy.Mul(-1, terms[0])),)
    return Judgement(Outcome.WRONG, terms, diagnose(replace(question, extra_terms=lacking)))


def _difference_terms(question: Question) -> tuple[Expr, ...]:
    """SymPy terms of printed minus right, angle sums contracted; none of no polynomials; sign(qd1) is a symbol."""
    meanings: dict[str, Expression] = {}
    whole = tree.substitute(question.printed, question.definitions)
    printed, right = opaque(whole, meanings), opaque(question.right, meanings)
    try:
        domain = PolynomialDomain(question.robot, [printed, right], max_terms=MAX_DIFFERENCE_TERMS)
        polynomial = domain.constant(printed) - domain.constant(right)
        difference = LectureForm(domain, style=NAMED_STYLES["expanded"]).kinematic(polynomial)
    except DeriveError:
        return ()
    difference = difference.xreplace({sympy.Symbol(name): expression_to_sympy(e) for name, e in meanings.items()})
    return tuple(term for term in sympy.Add.make_args(difference) if term != 0)
