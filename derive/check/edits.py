"""Single changes of a printed formula: the slips that typists, scanners and tired authors make, undone.

Changes of a formula in words: ``sign of the 2nd term, -a2*c12``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from fractions import Fraction

from derive.check.spots import Spot, is_token
from derive.lecture.shorthand import notation_text
from derive.robot.expression import (
    Call,
    Expression,
    Name,
    Number,
    Power,
    Product,
    Sum,
    add,
    multiply,
    negate,
    number,
    power,
)
from derive.robot.robot import Robot

_STEM = re.compile(r"(.*?)[0-9]*")
_SUFFIXES = ("st", "nd", "rd")
SWAPPED = {"cos": "sin", "sin": "cos"}


class Kind(IntEnum):
    """What kind of slip a change undoes, the likelier first; of several changes the first kind is reported."""

    SIGN = 0
    FUNCTION = 1
    EXPONENT = 2
    INDEX = 3
    SYMBOL = 4
    NUMBER = 5
    MISSING_FACTOR = 6
    EXTRA_FACTOR = 7
    MISSING_TERM = 8
    EXTRA_TERM = 9

    @property
    def words(self) -> str:
        """The kind as people say it."""
        return _WORDS[self]


_WORDS = {
    Kind.SIGN: "sign",
    Kind.FUNCTION: "sine or cosine",
    Kind.EXPONENT: "exponent",
    Kind.INDEX: "index",
    Kind.SYMBOL: "symbol",
    Kind.NUMBER: "number",
    Kind.MISSING_FACTOR: "missing factor",
    Kind.EXTRA_FACTOR: "extra factor",
    Kind.MISSING_TERM: "missing term",
    Kind.EXTRA_TERM: "extra term",
}


@dataclass(frozen=True, slots=True)
class Edit:
    """One change at one place.

    Attributes:
        kind: What it undoes.
        place: Where.
        node: What stands there then.
        old: The part that is replaced.
        new: What replaces it; None where a part is only negated or left out.
    """

    kind: Kind
    place: Spot
    node: Expression
    old: Expression
    new: Expression | None = None


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What may stand in a formula.

    Attributes:
        names: Names that may stand for another.
        angles: Joint variables of revolute joints, in their order.
        factors: What a term may lack.
        terms: What a sum may lack.
    """

    names: tuple[str, ...]
    angles: tuple[str, ...]
    factors: tuple[Expression, ...] = ()
    terms: tuple[Expression, ...] = ()
    stems: Mapping[str, str] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "stems", {name: _stem(name) for name in self.names})


def edits(spot: Spot, words: Vocabulary, kinds: frozenset[Kind]) -> Iterator[Edit]:
    """All changes of some kinds at one place."""
    for kind in sorted(kinds):
        yield from _MAKERS[kind](spot, words)


def _signs(spot: Spot, _: Vocabulary) -> Iterator[Edit]:
    node = spot.node
    if spot.is_term:
        yield Edit(Kind.SIGN, spot, negate(node), node)
    if isinstance(node, Call) and is_token(node) and isinstance(angle := node.arguments[0], Sum):
        for i, term in enumerate(angle.terms):
            turned = add(*angle.terms[:i], negate(term), *angle.terms[i + 1 :])
            yield _replaced(Kind.SIGN, spot, Call(node.function, (turned,)))


def _functions(spot: Spot, _: Vocabulary) -> Iterator[Edit]:
    if isinstance(spot.node, Call) and spot.node.function in SWAPPED:
        yield _replaced(Kind.FUNCTION, spot, Call(SWAPPED[spot.node.function], spot.node.arguments))


def _exponents(spot: Spot, _: Vocabulary) -> Iterator[Edit]:
    node = spot.node
    if isinstance(node, Power):
        others = {1, 2, 3, node.exponent + 1, node.exponent - 1} if node.exponent > 0 else {-1, -2}
        for exponent in sorted(others - {0, node.exponent}):
            yield _replaced(Kind.EXPONENT, spot, power(node.base, exponent))
    elif isinstance(node, Name | Call | Sum) and not isinstance(spot.parent, Power):
        yield _replaced(Kind.EXPONENT, spot, power(node, 2))


def _indices(spot: Spot, words: Vocabulary) -> Iterator[Edit]:
    node = spot.node
    if isinstance(node, Name):
        for name in words.names:
            if name != node.name and words.stems[name] == _stem(node.name):
                yield _replaced(Kind.INDEX, spot, Name(name))
    elif isinstance(node, Call) and is_token(node):
        for angle in _other_angles(node.arguments[0], words.angles):
            yield _replaced(Kind.INDEX, spot, Call(node.function, (angle,)))


def _other_angles(angle: Expression, angles: tuple[str, ...]) -> Iterator[Expression]:
    """One angle more, one less, one instead of another; for short arms any run of neighbours."""
    terms = angle.terms if isinstance(angle, Sum) else (angle,)
    present = {term.name for term in terms if isinstance(term, Name)}
    absent = [Name(name) for name in angles if name not in present]
    for i in range(len(terms)):
        rest = (*terms[:i], *terms[i + 1 :])
        if rest:
            yield add(*rest)
        yield from (add(*terms[:i], other, *terms[i + 1 :]) for other in absent)
    yield from (add(*terms, other) for other in absent)
    if len(angles) <= 8:
        runs = (angles[i:j] for i in range(len(angles)) for j in range(i + 1, len(angles) + 1))
        yield from (add(*map(Name, run)) for run in runs if set(run) != present)


def _symbols(spot: Spot, words: Vocabulary) -> Iterator[Edit]:
    if isinstance(spot.node, Name):
        own = _stem(spot.node.name)
        yield from (_replaced(Kind.SYMBOL, spot, Name(name)) for name in words.names if words.stems[name] != own)


def _numbers(spot: Spot, _: Vocabulary) -> Iterator[Edit]:
    node = spot.node
    if isinstance(node, Number):
        for value in (node.value + 1, node.value - 1, node.value * 2, node.value / 2):
            if value != node.value:
                yield _replaced(Kind.NUMBER, spot, number(value))
    elif spot.is_term:
        for factor in (2, Fraction(1, 2)):
            yield _replaced(Kind.NUMBER, spot, multiply(number(factor), node))


def _missing_factors(spot: Spot, words: Vocabulary) -> Iterator[Edit]:
    if spot.is_term:
        for factor in words.factors:
            yield Edit(Kind.MISSING_FACTOR, spot, multiply(spot.node, factor), spot.node, factor)


def _extra_factors(spot: Spot, _: Vocabulary) -> Iterator[Edit]:
    if isinstance(spot.node, Product):
        factors = spot.node.factors
        for i, factor in enumerate(factors):
            if not (isinstance(factor, Number) and factor.value == -1):
                yield Edit(Kind.EXTRA_FACTOR, spot, multiply(*factors[:i], *factors[i + 1 :]), factor)


def _missing_terms(spot: Spot, words: Vocabulary) -> Iterator[Edit]:
    if not isinstance(spot.parent, Sum):
        for term in words.terms:
            yield Edit(Kind.MISSING_TERM, spot, add(spot.node, term), spot.node, term)


def _extra_terms(spot: Spot, _: Vocabulary) -> Iterator[Edit]:
    if isinstance(spot.parent, Sum):
        yield Edit(Kind.EXTRA_TERM, spot, number(0), spot.node)


def _replaced(kind: Kind, spot: Spot, new: Expression) -> Edit:
    return Edit(kind, spot, new, spot.node, new)


def _stem(name: str) -> str:
    match = _STEM.fullmatch(name)
    return match[1] if match else name


def ordinal(i: int) -> str:
    """``2nd`` for 2."""
    plain = 10 < i % 100 < 14 or not 1 <= i % 10 <= 3
    return f"{i}th" if plain else f"{i}{_SUFFIXES[i % 10 - 1]}"


_MAKERS: Mapping[Kind, Callable[[Spot, Vocabulary], Iterator[Edit]]] = {
    Kind.SIGN: _signs,
    Kind.FUNCTION: _functions,
    Kind.EXPONENT: _exponents,
    Kind.INDEX: _indices,
    Kind.SYMBOL: _symbols,
    Kind.NUMBER: _numbers,
    Kind.MISSING_FACTOR: _missing_factors,
    Kind.EXTRA_FACTOR: _extra_factors,
    Kind.MISSING_TERM: _missing_terms,
    Kind.EXTRA_TERM: _extra_terms,
}


def changes_text(edits: Sequence[Edit], robot: Robot) -> str:
    """One change, or several and how many, with formulas in the notation of the robot."""
    texts = [_text(edit, robot) for edit in edits]
    return texts[0] if len(texts) == 1 else f"{len(texts)} changes: {'; '.join(texts)}"


def _text(edit: Edit, robot: Robot) -> str:
    def shown(e: Expression) -> str:
        return notation_text(e, robot)

    parent = edit.place.parent
    match edit:
        case Edit(kind=Kind.SIGN, new=None) if parent is None:
            whole = f"sign: {shown(edit.node)} instead of {shown(edit.old)}"
            return "sign of the whole" if isinstance(edit.old, Sum) else whole
        case Edit(kind=Kind.SIGN, new=None) if parent is not None:
            place = f" of {shown(parent)}" if edit.place.depth > 1 else ""
            return f"sign of the {ordinal(edit.place.index + 1)} term{place}, {shown(edit.old)}"
        case Edit(kind=Kind.EXTRA_TERM):
            return f"extra term: {shown(edit.old)}"
        case Edit(kind=Kind.EXTRA_FACTOR):
            return f"extra factor: {shown(edit.old)} in {shown(edit.place.node)}"
        case Edit(kind=Kind.MISSING_FACTOR, new=new) if new is not None:
            return f"missing factor: {shown(new)} of {shown(edit.old)}"
        case Edit(kind=Kind.MISSING_TERM, new=new) if new is not None:
            return f"missing term: {shown(new)}" + (f" beside {shown(edit.old)}" if parent is not None else "")
        case Edit(new=new) if new is not None:
            context = f" in {shown(parent)}" if isinstance(parent, Product) else ""
            return f"{edit.kind.words}: {shown(new)} instead of {shown(edit.old)}{context}"
    raise ValueError(edit.kind)
