"""Reading of files around printed formulas; one with an unknown name is kept as such, what is no formula is refused."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from derive.checking.formulas.printed import Citation, Printed, PrintedText, Remark
from derive.errors import CheckError, Location, UnknownNameError, listed, near_miss, quoted
from derive.lecture.shorthand import read_formula
from derive.robot.expression import ZERO, Expression, Name
from derive.robot.reading.document import Node, YamlMapping, YamlScalar, YamlSequence
from derive.robot.robot import Robot


def mapping(node: Node, what: str, required: Collection[str] = (), optional: Collection[str] = ()) -> YamlMapping:
    """A mapping with some keys and no others; with no keys given, any."""
    if not isinstance(node, YamlMapping):
        raise CheckError(f"{what} is not a mapping", remedy="write key: value", location=node.location)
    known = (*required, *optional)
    for name, (key, _) in node.entries.items():
        if known and name not in known:
            raise _not_allowed(f"unknown key {quoted(name)} in {what}", name, known, key.location)
    for name in required:
        if name not in node.entries:
            raise CheckError(f"{what} without {name!r}", remedy=f"add {name}:", location=node.location)
    return node


def _not_allowed(found: str, word: str, known: Collection[str], where: Location) -> CheckError:
    return CheckError(found, allowed=f"allowed: {listed(known)}", remedy=near_miss(word, known), location=where)


def items(node: Node | None, what: str) -> list[Node]:
    """The items of a list; none where there is no node."""
    if node is None:
        return []
    if not isinstance(node, YamlSequence):
        raise CheckError(f"{what} is not a list", remedy="write items with - or in [ ]", location=node.location)
    return node.items


def scalar(node: Node, what: str) -> YamlScalar:
    """A text with its place."""
    if not isinstance(node, YamlScalar):
        raise CheckError(f"{what} is not a single text", remedy='write "..."', location=node.location)
    return node


def required_text(node: YamlMapping, key: str) -> YamlScalar:
    """The text under a key that the mapping is known to have."""
    return scalar(node.entries[key][1], key)


def child(node: YamlMapping, name: str) -> Node | None:
    """The value of a key, or None."""
    return node.entries[name][1] if name in node.entries else None


def pairs(node: YamlMapping, name: str, what: str) -> Iterator[tuple[YamlScalar, YamlScalar]]:
    """The keys and texts of a mapping inside another; none where the key is missing."""
    inner = child(node, name)
    yield from ((key, scalar(value, what)) for key, value in (mapping(inner, name).entries.values() if inner else ()))


def rows(node: Node | None, what: str, row: str) -> list[list[Node]]:
    """The entries of a matrix, row by row."""
    return [items(entries, row) for entries in items(node, what)]


def word(node: YamlMapping, name: str, allowed: Collection[str], default: str) -> str:
    """One of some words."""
    if (value := child(node, name)) is None:
        return default
    if (found := scalar(value, name)).text not in allowed:
        raise _not_allowed(f"{name}: {quoted(found.text)}", found.text, allowed, found.location)
    return found.text


def flag(node: YamlMapping, name: str) -> bool:
    """``true`` or ``false``; false where the key is missing."""
    return word(node, name, ("true", "false"), "false") == "true"


def text_of(node: YamlMapping, key: str) -> str:
    """The text under a key, on one line; empty where it is missing or no text."""
    value = child(node, key)
    return " ".join(value.text.split()) if isinstance(value, YamlScalar) else ""


def status(item: YamlMapping) -> str:
    """``ok``, or ``erratum`` where an item is marked as wrong."""
    return word(item, "status", ("ok", "erratum"), "ok")


def remark(item: YamlMapping) -> Remark:
    """What a file says about one item."""
    kind = word(item, "kind", ("error", "convention", "notation"), "error")
    return Remark(text_of(item, "note"), kind, flag(item, "duplicate"), printed_in(item))


def printed_in(node: YamlMapping) -> Citation:
    """Where something is printed, from the block ``source:``; empty where there is none."""
    source = child(node, "source")
    if isinstance(source, YamlMapping):
        return Citation(text_of(source, "document"), text_of(source, "section"))
    return Citation(source.text if isinstance(source, YamlScalar) else "")


def printed_text(scalar: YamlScalar, lines: Sequence[str]) -> PrintedText:
    """A text with its place; of a literal block (``|``) the lines of the file themselves, so that columns are exact."""
    if scalar.verbatim:
        return PrintedText(scalar.text, scalar.inner)
    block = lines[scalar.location.line :][: len(scalar.text.splitlines())]
    if [line.strip() for line in block] == [line.strip() for line in scalar.text.splitlines()]:
        return PrintedText("\n".join(block), Location(scalar.location.source, scalar.location.line + 1))
    return PrintedText(scalar.text, scalar.location, verbatim=False)


@dataclass(frozen=True, slots=True)
class Abbreviations:
    """Further names of some formulas, beside the robot's own."""

    names: Mapping[str, Expression] = field(default_factory=dict)  # what they stand for; `unknown` ones for themselves
    unknown: Mapping[str, UnknownNameError] = field(default_factory=dict)  # the unknown name in a definition

    def defining(self, name: str, definition: Printed) -> Abbreviations:
        """With one name more."""
        if definition.unknown is None:
            return Abbreviations({**self.names, name: definition.formula}, self.unknown)
        return Abbreviations({**self.names, name: Name(name)}, {**self.unknown, name: definition.unknown})


NO_ABBREVIATIONS = Abbreviations()


def read_printed(
    text: YamlScalar, robot: Robot, further: Abbreviations = NO_ABBREVIATIONS, place: tuple[int, int] = (1, 1)
) -> Printed:
    """A printed formula, zero with an unknown name; in a folded or escaped text errors stand at its beginning."""
    try:
        formula = read_formula(text.text, robot, text.inner, further.names)
    except CheckError as error:
        moved = error if text.verbatim else error.moved(text.location)
        if not isinstance(moved, UnknownNameError):
            raise moved from None
        return Printed(*place, text.text, ZERO, text.inner, moved)
    words = re.findall(r"[A-Za-z_][A-Za-z_0-9]*", text.text)
    unknown = next((further.unknown[name] for name in words if name in further.unknown), None)
    return Printed(*place, text.text, ZERO if unknown else formula, text.inner, unknown)
