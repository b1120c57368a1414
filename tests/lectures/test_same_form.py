"""How many printed expressions come out written as the notes write them.

"Same form" is implemented here a second time, on multisets instead of sorted tuples: the tool does not grade itself.
"""

from collections import Counter
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from derive.checking.comparison import derived_matrix
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import same_form
from derive.model.model import Model
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, children
from tests.lectures.results import corpus_file
from tests.places import CORPUS

FILES = sorted(CORPUS.glob("0*.yaml"))


def multiset(items: Counter[Any]) -> frozenset[Any]:
    return frozenset(items.items())


def shape(e: Expression) -> tuple[Fraction, Any]:
    """(rational factor, unordered tree)."""
    match e:
        case Number(value):
            return value, frozenset()
        case Pi():
            return Fraction(1), frozenset({("pi", 1)})
        case Name(name):
            return Fraction(1), frozenset({(name, 1)})
        case Call(function, arguments):
            return Fraction(1), frozenset({((function, *(shape(a) for a in arguments)), 1)})
        case Power(base, exponent):
            factor, tree = shape(base)
            return factor**exponent, frozenset((x, k * exponent) for x, k in tree)
        case Product(factors):
            total, counted = Fraction(1), Counter[Any]()
            for part in factors:
                factor, tree = shape(part)
                total *= factor
                for x, k in tree:
                    counted[x] += k
            return total, multiset(counted)
        case Sum(terms):
            return sum_shape(terms)


def sum_shape(terms: tuple[Expression, ...]) -> tuple[Fraction, Any]:
    collected: list[tuple[Fraction, Any]] = []
    for term in terms:
        factor, tree = shape(term)
        only = next(iter(tree)) if len(tree) == 1 else None
        if only is not None and only[1] == 1 and isinstance(only[0], tuple) and only[0][0] == "+":
            collected += [(factor * k, x) for k, x in only[0][1]]
        elif factor:
            collected.append((factor, tree))
    if len(collected) < 2:
        return collected[0] if collected else (Fraction(0), frozenset())
    scale = max(abs(k) for k, _ in collected)
    signed = {s: multiset(Counter((s * k / scale, x) for k, x in collected)) for s in (1, -1)}
    sign = min(signed, key=lambda s: text(signed[s]))
    unordered = tuple(sorted((pair for pair, n in signed[sign] for _ in range(n)), key=text))
    return sign * scale, frozenset({(("+", unordered), 1)})


def text(tree: Any) -> str:
    """A text that is equal for equal trees, whatever the order of their sets."""
    if isinstance(tree, frozenset):
        return "{" + ",".join(sorted(map(text, tree))) + "}"
    if isinstance(tree, tuple):
        return "(" + ",".join(map(text, tree)) + ")"
    return str(tree)


def contains_sum(e: Expression) -> bool:
    if isinstance(e, Call):
        return False
    return isinstance(e, Sum) or any(contains_sum(part) for part in children(e))


@cache
def compared(path: Path) -> list[tuple[str, Expression, Expression]]:
    """(place, ours, printed) for every right entry with a sum, the A_i left out."""
    file = corpus_file(path)
    model = Model(file.robot)
    found = []
    for item in file.expected:
        if item.quantity.startswith("A[") or (item.status == "erratum" and item.remark.kind != "error"):
            continue
        derived = derived_matrix(model, item)
        for entry in item.entries if item.status == "ok" else item.corrections:
            if contains_sum(entry.formula):
                ours = expression_from_sympy(derived[entry.row - 1, entry.column - 1])
                found.append((f"{item.quantity} {entry.row},{entry.column}: {entry.text}", ours, entry.formula))
    return found


def test_the_lecture_form_is_the_printed_form() -> None:
    rows = [row for path in FILES for row in compared(path)]
    different = [place for place, ours, printed in rows if shape(ours) != shape(printed)]
    assert len(rows) == 90, "docs/lecture-form.md names the number"
    assert different == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_both_implementations_of_same_form_agree(path: Path) -> None:
    for place, ours, printed in compared(path):
        assert same_form(ours, printed) == (shape(ours) == shape(printed)), place
