"""Places in a printed formula, and the single changes there that undo slips of typists, scanners and tired authors.

A place knows what stands there, and what the whole becomes if something else stood there: at one point the new value
is carried up to the root, without evaluating the rest. Changes are said in words: ``sign of the 2nd term, -a2*c12``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import lru_cache, partial

from derive.lecture.shorthand import notation_text
from derive.robot import expression as tree
from derive.robot.evaluate import FUNCTIONS as REAL_FUNCTIONS
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, number
from derive.robot.robot import Robot
from derive.robot.rounding import is_given_in_decimals, number_text

FUNCTIONS: Mapping[str, Callable[..., float]] = {
    **REAL_FUNCTIONS,
    **{"sign": lambda x: math.copysign(1.0, x) if x else 0.0, "acos": math.acos, "asin": math.asin, "atan": math.atan},
}
SWAPPED = {"cos": "sin", "sin": "cos"}
Known = Mapping[Expression, float] | None  # values of nodes, which are not evaluated again
NO_VALUE = (ArithmeticError, ValueError, KeyError)  # what `float_value` raises where a formula has no value


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """One node of a formula."""

    node: Expression  # what stands there
    above: Spot | None = None  # the place above; None for the whole formula
    index: int = 0  # which child of the node above it is, from 0
    siblings: tuple[float, ...] = ()  # values of all children of the node above
    depth: int = 0  # nodes above it
    cost: int = 1  # float operations of one value of the whole, about

    @property
    def parent(self) -> Expression | None:
        """The node above; None for the whole formula."""
        return self.above.node if self.above else None

    @property
    def is_term(self) -> bool:
        """Whether it is the whole formula or a term of a sum."""
        return self.above is None or isinstance(self.above.node, Sum)

    def value(self, here: float) -> float:
        """The value of the whole formula for another value here."""
        spot = self
        while (above := spot.above) is not None:
            # only the nodes on the way to the root change; their other children keep the values that they had
            parts = [*spot.siblings[: spot.index], here, *spot.siblings[spot.index + 1 :]]
            spot, here = above, _combined(above.node, parts, {})
        return here

    def formula(self, here: Expression) -> Expression:
        """The whole formula with another node here, flattened."""
        if self.above is None:
            return here
        parts = tree.children(self.above.node)
        changed = iter((*parts[: self.index], here, *parts[self.index + 1 :]))
        return self.above.formula(tree.rebuilt(self.above.node, lambda _: next(changed)))


def float_value(e: Expression, values: Mapping[str, float], known: Known = None) -> float:
    """The value of a tree at a point; ArithmeticError, ValueError or KeyError (`NO_VALUE`) where there is none."""
    if known and (value := known.get(e)) is not None:
        return value
    return _combined(e, [float_value(child, values, known) for child in tree.children(e)], values)


def _combined(e: Expression, parts: Sequence[float], values: Mapping[str, float]) -> float:
    """The value of a node from the values below it."""
    match e:
        case Number(number):
            return float(number)
        case Pi():
            return math.pi
        case Name(name):
            return values[name]
        case Sum():
            return math.fsum(parts)
        case Product():
            return math.prod(parts)
        case Power(_, exponent):
            return float(parts[0] ** exponent)
        case Call(function, _):
            return FUNCTIONS[function](*parts)


def spots(root: Expression, values: Mapping[str, float] | None = None, known: Known = None) -> Iterator[Spot]:
    """Every place of a formula from the root down, plain cosines and sines as tokens; values only at a point."""
    waiting = [Spot(root)]
    while waiting:
        spot = waiting.pop()
        yield spot
        if not is_token(spot.node):
            parts = tree.children(spot.node)
            siblings = () if values is None else tuple(float_value(part, values, known) for part in parts)
            depth, cost = spot.depth + 1, spot.cost + len(parts)
            waiting += reversed([Spot(part, spot, i, siblings, depth, cost) for i, part in enumerate(parts)])


def is_token(e: Expression) -> bool:
    """Whether it is the cosine or sine of an angle without numbers and further functions."""
    if not (isinstance(e, Call) and e.function in ("cos", "sin")):
        return False
    (angle,) = e.arguments
    return all(isinstance(t, Name | Product) for t in (angle.terms if isinstance(angle, Sum) else (angle,)))


def nodes(e: Expression) -> Iterator[Expression]:
    """Every node of a tree."""
    yield e
    for child in reversed(tree.children(e)):
        yield from nodes(child)


class SlipKind(Enum):
    """What kind of slip a change undoes, the likelier first; of several changes the first kind is reported."""

    PLUS_MINUS = "+- missing"
    ATAN2 = "atan2"
    SIGN = "sign"
    ORDER = "order of the arguments"
    FUNCTION = "sine or cosine"
    EXPONENT = "exponent"
    INDEX = "index"
    SYMBOL = "symbol"
    NUMBER = "number"
    MISSING_FACTOR = "missing factor"
    EXTRA_FACTOR = "extra factor"
    MISSING_TERM = "missing term"
    EXTRA_TERM = "extra term"


@dataclass(frozen=True, slots=True, eq=False)
class Edit:
    """One change at one place."""

    kind: SlipKind  # what it undoes
    place: Spot
    node: Expression  # what stands there then
    old: Expression  # the part that is replaced
    new: Expression | None = None  # what replaces it; None where a part is only negated or left out

    @property
    def formula(self) -> Expression:
        """The whole formula with the change made."""
        return self.place.formula(self.node)


@dataclass(frozen=True, slots=True)
class Replacements:
    """What may stand in a formula."""

    names: tuple[str, ...]  # names that may stand for another
    angles: tuple[str, ...]  # joint variables of revolute joints, in their order
    factors: tuple[Expression, ...] = ()  # what a term may lack
    terms: tuple[Expression, ...] = ()  # what a sum may lack


def edits(spot: Spot, may: Replacements, kind: SlipKind) -> Iterator[Edit]:
    """All changes of one kind at one place."""
    node = spot.node
    match kind, node:
        case SlipKind.SIGN, _:
            if spot.is_term:
                yield Edit(kind, spot, tree.negate(node), node)
            if isinstance(node, Call) and is_token(node) and isinstance(angle := node.arguments[0], Sum):
                for i, term in enumerate(angle.terms):  # one inside the angle of a cosine or sine
                    turned = tree.add(*angle.terms[:i], tree.negate(term), *angle.terms[i + 1 :])
                    yield _replaced(kind, spot, Call(node.function, (turned,)))
        case SlipKind.ORDER, Call(function, (first, second)):
            yield _replaced(kind, spot, Call(function, (second, first)))
        case SlipKind.FUNCTION, Call(function, arguments) if function in SWAPPED:
            yield _replaced(kind, spot, Call(SWAPPED[function], arguments))
        case SlipKind.EXPONENT, Power(base, exponent):
            # an exponent misread, or off by one; -1 and -2 are a division by the base and by its square
            exponents = {1, 2, 3, exponent + 1, exponent - 1} if exponent > 0 else {-1, -2}
            yield from (_replaced(kind, spot, tree.power(base, other)) for other in sorted(exponents - {0, exponent}))
        case SlipKind.EXPONENT, Name() | Call() | Sum() if not isinstance(spot.parent, Power):
            yield _replaced(kind, spot, tree.power(node, 2))
        case ((SlipKind.INDEX | SlipKind.SYMBOL), Name(own)):
            # an index is another number behind the same letter, a symbol is another letter
            stem, wants_relatives = _stem(own), kind is SlipKind.INDEX
            fitting = (name for name in may.names if name != own and (_stem(name) == stem) is wants_relatives)
            yield from (_replaced(kind, spot, Name(name)) for name in fitting)
        case SlipKind.INDEX, Call(function, (angle,)) if is_token(node):
            yield from (_replaced(kind, spot, Call(function, (a,))) for a in _other_angles(angle, may.angles))
        case SlipKind.NUMBER, Number(value):
            values = (value + 1, value - 1, value * 2, value / 2)
            yield from (_replaced(kind, spot, number(other)) for other in values if other != value)
        case SlipKind.NUMBER, _ if spot.is_term:
            yield from (_replaced(kind, spot, tree.multiply(number(k), node)) for k in (2, Fraction(1, 2)))
        case SlipKind.MISSING_FACTOR, _ if spot.is_term:
            yield from (Edit(kind, spot, tree.multiply(node, factor), node, factor) for factor in may.factors)
        case SlipKind.EXTRA_FACTOR, Product(factors):
            for i, factor in enumerate(factors):
                if not (isinstance(factor, Number) and factor.value == -1):
                    yield Edit(kind, spot, tree.multiply(*factors[:i], *factors[i + 1 :]), factor)
        case SlipKind.MISSING_TERM, _ if not isinstance(spot.parent, Sum):
            yield from (Edit(kind, spot, tree.add(node, term), node, term) for term in may.terms)
        case SlipKind.EXTRA_TERM, _ if isinstance(spot.parent, Sum):
            yield Edit(kind, spot, number(0), node)


def _replaced(kind: SlipKind, spot: Spot, new: Expression) -> Edit:
    return Edit(kind, spot, new, spot.node, new)


@lru_cache(10_000)  # formulas have the same few angles again and again
def _other_angles(angle: Expression, angles: tuple[str, ...]) -> tuple[Expression, ...]:
    """One angle more, one less, one instead of another; for short arms any run of neighbours."""
    terms, others = angle.terms if isinstance(angle, Sum) else (angle,), list[Expression]()
    present = {term.name for term in terms if isinstance(term, Name)}
    absent = [Name(name) for name in angles if name not in present]
    for i in range(len(terms)):
        others += [tree.add(*terms[:i], *terms[i + 1 :])] if len(terms) > 1 else ()
        others += (tree.add(*terms[:i], other, *terms[i + 1 :]) for other in absent)
    others += (tree.add(*terms, other) for other in absent)
    if len(angles) <= 8:  # c234 for c23: sums of neighbouring joints are what books abbreviate
        runs = (angles[i:j] for i in range(len(angles)) for j in range(i + 1, len(angles) + 1))
        others += (tree.add(*map(Name, run)) for run in runs if set(run) != present)
    return tuple(others)


def _stem(name: str) -> str:
    """A name without the number at its end."""
    return name.rstrip("0123456789")


def ordinal(i: int) -> str:
    """``2nd`` for 2."""
    return f"{i}{'th' if 10 < i % 100 < 14 else {1: 'st', 2: 'nd', 3: 'rd'}.get(i % 10, 'th')}"


def changes_text(made: Sequence[Edit], robot: Robot) -> str:
    """One change, or several and how many, in the notation of the robot, with few digits but where these change."""
    rounded = partial(number_text, decimals=is_given_in_decimals(robot))
    texts = []
    for edit in made:
        hides = edit.new and notation_text(edit.old, robot, rounded) == notation_text(edit.new, robot, rounded)
        texts.append(_text(edit, partial(notation_text, robot=robot, write=str if hides else rounded)))
    return texts[0] if len(texts) == 1 else f"{len(texts)} changes: {'; '.join(texts)}"


def _text(edit: Edit, write: Callable[[Expression], str]) -> str:
    place, parent = edit.place, edit.place.parent
    shown_parent = write(parent) if parent is not None else ""
    old, new = write(edit.old), write(edit.new) if edit.new is not None else ""
    match edit.kind:
        case SlipKind.SIGN if not new and parent is None:
            return "sign of the whole" if isinstance(edit.old, Sum) else f"sign: {write(edit.node)} instead of {old}"
        case SlipKind.SIGN if not new:
            inside = f" of {shown_parent}" if place.depth > 1 else ""
            return f"sign of the {ordinal(place.index + 1)} term{inside}, {old}"
        case SlipKind.EXTRA_TERM:
            return f"extra term: {old}"
        case SlipKind.EXTRA_FACTOR:
            return f"extra factor: {old} in {write(place.node)}"
        case SlipKind.MISSING_FACTOR:
            return f"missing factor: {new} of {old}"
        case SlipKind.MISSING_TERM:
            return f"missing term: {new}" + (f" beside {old}" if parent is not None else "")
        case kind:
            inside = f" in {shown_parent}" if isinstance(parent, Product) else ""
            return f"{kind.value}: {new} instead of {old}{inside}"
