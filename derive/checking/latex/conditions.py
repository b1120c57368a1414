r"""Whether a difference is a slip: conditions such as ``\theta_2 = 0``, ``J(\theta_2=0) =``, what a formula is near to.

What is wrong in general may be meant under a condition: it is right where it belongs to the sentence that states it,
and nothing that it replaces is left in it or in the matrix around it. A verdict "wrong" needs a formula that is near to
ours, one small change away, or that stands among right ones of its kind, in frames that are those of the table.
"""

import re
from bisect import bisect_right
from collections import ChainMap, Counter
from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import groupby

from derive.checking.formulas.diagnosis import PAIRED, Question
from derive.checking.formulas.edits import NO_VALUE, float_value, is_token, spots
from derive.checking.formulas.findings import Finding, Role, Skipped, compared, judge
from derive.checking.latex.matrices import Table
from derive.errors import CheckError, Location
from derive.model.equality import Verdict, compare
from derive.robot import expression as tree
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Call, Expression, Name, Number, Pi, Product, Sum
from derive.robot.robot import Robot

NEAR = 0.5  # more than this part of its names and functions a near formula shares with ours, or with what repairs it
AMONG = 3  # right formulas of a kind for each one that is far from ours, which make these certain
_FAR = "as {} it would be wrong in more than one place, and so would most of its kind: it may mean something else"
_LETTER = re.compile(r"\s*\\?[A-Za-z]+(?:_\{?\w+\}?)?\s*")
_NAMED = "as {} it would be wrong, and it is a letter for what is 0 here: it may mean something else"
_SIDES_DIFFER = "its sides differ in more than one place, as too many here do: a name may mean something else"
DIGITS = 5  # units of the last printed digit by which numbers may differ: authors round what they go on with
ROUGHLY = 0.02  # relative difference that rounding on the way may explain
DECIMALS = re.compile(r"[0-9]\.([0-9]+)")
REACH = 25  # lines behind a condition, such as s_5 = 0, in which formulas may be meant under it

NEARLY = re.compile(
    r"(?i)\\approx|taylor|small[- ]angle|lineari[sz]|linealiz|approxim|\u6cf0\u52d2|\u5c0f\u89d2|\u8fd1\u4f3c"
)
Values = Mapping[str, Expression]  # what stands for a name where a condition holds
_MATHEMATICS = re.compile(r"\$\$.*?\$\$|\$[^$]*\$|\\\[.*?\\\]|\\begin\{(\w+\*?)\}.*?\\end\{\1\}", re.DOTALL)
_SENTENCE_ENDS = re.compile(r"[.!?;](?:\s|$)|^\s*#|\\(?:sub)*section|\n\s*\n\s*\S", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition of a text."""

    line: int
    end: int  # offset behind it
    text: str
    ways: tuple[Values, ...]  # each fulfils it
    is_of_side: bool = False  # whether it belongs to one left side alone

    def is_near(self, begin: int, text: str) -> bool:
        """Whether a formula that begins there belongs to the same sentence."""
        between = _MATHEMATICS.sub(" ", text[self.end : begin].strip("$ "))
        return self.is_of_side or (self.end <= begin and not _SENTENCE_ENDS.search(between))


# Angles, in multiples of pi, of which a sine or a cosine has such a value.
_HALF_TURNS = {("sin", 0): ("0", "1"), ("sin", 1): ("1/2",), ("sin", -1): ("-1/2",)}
_HALF_TURNS |= {("cos", 0): ("1/2", "-1/2"), ("cos", 1): ("0",), ("cos", -1): ("1",)}


def ways(sides: Sequence[Expression]) -> tuple[Values, ...]:
    """What fulfils an equation between names and numbers, of products, or of a sine or cosine; none of other ones."""
    symbols, constants = [e for e in sides if isinstance(e, Name)], [e for e in sides if tree.is_constant(e)]
    with suppress(*NO_VALUE):  # theta_1 = pi/4 (1 - cos(pi/2)) = pi/4
        numbers = [float_value(e, {}) for e in constants]
        constants = constants[-1:] if max(numbers, default=0) - min(numbers, default=0) < 1e-3 else constants
    match sides:
        case [Name(name), formula] if not isinstance(formula, Name) and name not in tree.names(formula):
            return ({name: formula},)
        case [Call("sin" | "cos" as function, (Name(name),)), Number(value)] if value in (-1, 0, 1):
            return tuple({name: tree.multiply(tree.number(half), Pi())} for half in _HALF_TURNS[function, int(value)])
        case [Sum(terms), value] if tree.is_constant(value) and all(isinstance(term, Name) for term in terms):
            *first, last = terms  # theta_{234} = 0
            assert isinstance(last, Name)
            return ({last.name: tree.add(value, *map(tree.negate, first))},)
    if len(sides) == 2 and not constants and len(symbols) < 2:
        return tuple(_of_products(*(side.factors if isinstance(side, Product) else (side,) for side in sides)))
    if not all(isinstance(e, Name) or tree.is_constant(e) for e in sides) or len(constants) > 1 or not symbols:
        return ()
    return tuple({symbol.name: value for symbol in symbols if symbol != value} for value in constants or symbols)


def _of_products(one: Sequence[Expression], other: Sequence[Expression]) -> Iterator[Values]:
    """Each name that stands once, by the others: m_3 l_2 = m_4 l_1."""
    if all(isinstance(factor, (Name, Number)) for factor in (*one, *other)):
        for own, by in ((one, other), (other, one)):
            for name in (f for f in own if isinstance(f, Name) and [*own, *by].count(f) == 1):
                yield {name.name: tree.multiply(*by, *(tree.power(f, -1) for f in own if f != name))}


def explaining(
    conditions: Sequence[Condition], finding: Finding, begin: int, text: str, around: frozenset[str]
) -> tuple[str, bool] | None:
    """The condition that makes a formula right that begins at an offset, and whether it is certainly meant."""
    question, line = finding.question, finding.location.line or 0
    if finding.verdict.equal or question is None:
        return None
    known = set(tree.names(question.printed))
    within = (c for c in conditions if c.line <= line <= c.line + (0 if c.is_of_side else REACH))
    for said, values, is_near in _combined([(c, c.is_near(begin, text)) for c in within], known | around):
        is_replaced = values.keys().isdisjoint(known | around)
        if not is_replaced and finding.role is not Role.IDENTITY:
            continue
        right, printed = (tree.substitute(side, values) for side in (question.right, question.printed))
        with suppress(CheckError, ArithmeticError):
            here = Question(question.robot, printed, right)
            if compared(here, "", (0, 0), Role.IDENTITY, "", "", finding.location).verdict.equal:
                return said, is_near and is_replaced
    return None


def _combined(holding: Sequence[tuple[Condition, bool]], known: set[str]) -> Iterator[tuple[str, Values, bool]]:
    """Single conditions, and those together that stand close before a formula with known names."""
    if len(near := [condition for condition, is_near in holding if is_near]) > 1:
        together: dict[str, Expression] = {}
        for condition in near:
            together |= next((way for way in condition.ways if known.isdisjoint(way)), condition.ways[0])
        yield " and ".join(dict.fromkeys(c.text for c in near)), together, True
    yield from ((c.text, way, is_near) for c, is_near in reversed(holding) for way in c.ways)


def at_home(robot: Robot, moving: AbstractSet[str], table: Table, findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Of a matrix in which nothing moves: whether it is right where all joint variables are zero."""
    wrong = {f: f.question for f in findings if not f.verdict.equal}
    is_still = moving.isdisjoint(name for entry in table.entries for name in tree.names(entry.formula))
    is_place = all(f.quantity[:1] in "TAp" or f.quantity in ("base", "tool") for f in findings)
    if not (is_place and is_still and wrong) or table.shape == (1, 1):
        return findings
    zero = dict.fromkeys((joint.variable for joint in robot.movers), tree.ZERO)
    pairs = [(tree.substitute(q.right, zero), q.printed) for q in wrong.values() if q is not None]
    if len(pairs) < len(wrong) or not all(compare(robot, *pair).equal for pair in pairs):
        return findings
    right, note = Verdict(equal=True, exact=True), ", with all joint variables zero"
    mended = {f: replace(f, verdict=right, note=note, cause="", question=None) for f in wrong}
    return tuple(mended.get(f, f) for f in findings)


def at_stated_numbers(
    robot: Robot, conditions: Sequence[Condition], findings: tuple[Finding, ...], is_example: bool
) -> tuple[Finding, ...]:
    """Findings of which printed numbers are right with the file's numbers and a configuration that the text states."""
    wrong = {f: f.question for f in findings if not f.verdict.equal}
    printed = [f.question.printed if f.question else None for f in findings]
    # a zero among formulas, or alone, is meant in general: that it holds somewhere makes no slip right
    is_example |= any(e != tree.ZERO or f.text != "0" for e, f in zip(printed, findings, strict=True))
    if not (wrong and is_example and all(e is not None and tree.is_constant(e) for e in printed)):
        return findings
    line = findings[0].location.line or 0
    earlier = [c for c in conditions if c.line <= line]
    stated = [(f" where {c.text}", way) for c in earlier if line <= c.line + REACH for way in c.ways]
    # of several ways to fulfil one condition the first; of several conditions the last
    given = ((name, value) for c in earlier for name, value in ChainMap(*map(dict, c.ways)).items())
    together = {name: value for name, value in given if tree.is_constant(value)}
    file = {name: float(value) for name, value in parameter_values(robot).items()}
    moving = {name: value for name, value in together.items() if name not in file}
    for where, way in [("", {}), (" and the text", moving), (" and the text", together), *reversed(stated)]:
        with suppress(*NO_VALUE):
            values = file | {name: float_value(value, file) for name, value in way.items()}
            if all(_rounds_to(float_value(q.right, values), q.printed, f.text) for f, q in wrong.items() if q):
                note = f", with the numbers of the file{where}"
                mended = {f: replace(f, verdict=Verdict(True, False), note=note, question=None) for f in wrong}
                return tuple(mended.get(f, f) for f in findings)
    return findings


def _rounds_to(value: float, printed: Expression, text: str) -> bool:
    """Whether a number is a value, to a few units of its last digit, and a formula of rounded ones nearly so."""
    gap, places = abs(value - float_value(printed, {})), [len(digits) for digits in DECIMALS.findall(text)]
    if places and isinstance(printed, Number):
        digit = 10.0 ** -min(places)
        return gap <= max(digit, min(DIGITS * digit, ROUGHLY * abs(value)))
    return gap <= (ROUGHLY / 4 * abs(value) if places else 0) + 1e-9 * (1 + abs(value))


def certain(findings: Sequence[Finding], begins: Sequence[Location]) -> tuple[tuple[Finding, ...], tuple[Skipped, ...]]:
    """The findings without those far from ours, but in a matrix or of a kind that is mostly right; what is left out."""
    starts = [(at.line or 0, at.column or 0) for at in begins]

    def matrix(f: Finding) -> tuple[str, int]:
        return f.quantity, bisect_right(starts, (f.location.line or 0, f.location.column or 0))

    far = [f for f in findings if not (f.verdict.equal or f.some or f.unknown or f.cause) and not _is_near(f)]
    right = [f for f in findings if f.verdict.equal and not (f.question and tree.is_constant(f.question.right))]
    matrices, kinds = Counter(map(matrix, right)), Counter(map(_kind, right))
    far_matrices, far_kinds = Counter(map(matrix, far)), Counter(map(_kind, far))
    # the frames of a text of which no transform is right are others than those of the table
    entries = [f for f in findings if re.match(r"[TA]\[", f.quantity) and f.question and f.row]
    moving = [f for f in entries if not (f.verdict.equal and f.right in (0, 1))]
    slipped = {matrix(f) for f in moving if not f.verdict.equal}
    strange = slipped if len(slipped) >= AMONG and slipped.issuperset(map(matrix, moving)) else frozenset()
    rare = [f for f in far if kinds[_kind(f)] < AMONG * far_kinds[_kind(f)] and matrix(f) not in strange]
    rare = [f for f in rare if not (f.row and matrices[matrix(f)] >= far_matrices[matrix(f)])]
    doubted = [f for f in findings if matrix(f) in strange and not f.verdict.equal]
    doubted += [f for f in rare if not (f.role is Role.IDENTITY and far_kinds[_kind(f)] == 1)]
    zeros = [f for f in far if not f.column and f.question and f.question.printed == tree.ZERO and f not in doubted]
    doubted += (named := [f for f in zeros if _LETTER.fullmatch(f.text)])
    firsts = [next(group) for _, group in groupby(doubted, key=matrix)]
    reasons = (
        _SIDES_DIFFER if f.role is Role.IDENTITY else (_NAMED if f in named else _FAR).format(f.entry) for f in firsts
    )
    told = tuple(Skipped(f.location, reason, f.text) for f, reason in zip(firsts, reasons, strict=True))
    return tuple(f for f in findings if f not in doubted), told


def moves(finding: Finding) -> bool:
    """Whether it is about more than a constant entry of a matrix."""
    return finding.question is None or not tree.is_constant(finding.question.right)


def _kind(finding: Finding) -> str:
    """What a finding is about without its indices; all identities are of one kind."""
    return finding.role.value if finding.role is Role.IDENTITY else re.sub(r"\[.*", "", finding.quantity)


def _is_near(finding: Finding) -> bool:
    """Whether it shares most with ours, or is repaired by a sign, a function, an exponent, an index or little else."""
    repair, question = judge(finding).repair, finding.question
    if question is None or (repair and repair.kinds and set(repair.kinds) <= {*PAIRED}):
        return repair is not None
    # the sides of an identity are those of the text
    near = [question.right] if finding.role is not Role.IDENTITY else []
    printed = _tokens(question.printed)
    others = map(_tokens, (*near, *([repair.formula] if repair else ())))
    return any((printed & other).total() > NEAR * max(printed.total(), other.total()) for other in others)


def _tokens(e: Expression) -> Counter[Expression]:
    """The names, numbers and cosines and sines of a formula."""
    return Counter(spot.node for spot in spots(e) if is_token(spot.node) or not tree.children(spot.node))
