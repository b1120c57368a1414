"""Inverse solutions of textbooks pass as they are printed; slips in them are found, each with what repairs it."""

from __future__ import annotations

import random
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from derive.api.robots import load
from derive.checking.formulas.findings import Finding, Role, judge
from derive.checking.formulas.printed import Asked
from derive.checking.inverse.check import check_inverse, inverse_text
from derive.errors import CheckError, Location
from derive.model.model import Model

ITEMS: list[dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("printed_solutions.yaml").read_text("utf-8"))
TEXTBOOKS = Path(__file__).parents[1] / "textbooks"
PLAIN = [item for item in ITEMS if "text" in item]


@cache
def model(robot: str) -> Model:
    file = TEXTBOOKS / f"{robot}.yaml"
    return Model(load(file if file.exists() else robot))


def checked(robot: str, text: str, latex: bool = False) -> tuple[Finding, ...]:
    return check_inverse(model(robot), inverse_text(text, Asked(Location("book")), latex=latex))[0]


@pytest.mark.parametrize("item", ITEMS, ids=[item["book"] for item in ITEMS])
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


@pytest.mark.parametrize(("robot", "kind", "text"), slips(14, 5))
def test_every_slip_is_found_and_repaired(robot: str, kind: str, text: str) -> None:
    assert caught(robot, text) is not False, kind


@pytest.mark.sweep
def test_two_hundred_slips_are_found_and_repaired() -> None:
    found = [(kind, text) for robot, kind, text in slips(200, 9) if caught(robot, text) is False]
    assert found == []


LATEX_SLIPS = [
    ("Craig 4.7, PUMA 560", "- r_{33}s_{23}c_4)", "+ r_{33}s_{23}c_4)", "sign of the 3rd term"),
    ("Craig 4.7, PUMA 560", "- K^2})", "- K})", "exponent: K**2 instead of K"),
    ("Craig 4.7, PUMA 560", r" \text{ or } \theta_4 + 180^\circ", "", "second solution missing: or q4 + pi"),
    ("Craig 4.7, PUMA 560", "(p_y, p_x)", "(p_x, p_y)", "order of the arguments: atan2(py, px)"),
    ("Perugia (document 004), SCARA, its two errata corrected", "c_2^2}", "c_2}", "exponent: c2**2 instead of c2"),
    ("Perugia (document 004), SCARA, its two errata corrected", "-o_z - d_4", "o_z + d_4", "sign of the whole"),
]


@pytest.mark.parametrize(("book", "old", "new", "said"), LATEX_SLIPS)
def test_a_slip_in_latex_is_named(book: str, old: str, new: str, said: str) -> None:
    (item,) = (item for item in ITEMS if item["book"] == book)
    assert old in item["latex"]
    found = checked(item["robot"], item["latex"].replace(old, new), latex=True)
    (wrong,) = (f for f in found if not f.verdict.equal and f.role is Role.SOLUTION)
    repair = judge(wrong).repair
    assert repair is not None
    assert said in repair.text
