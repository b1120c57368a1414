"""Reading of positioned trees outside the robot block: mappings with known keys, lists, texts and words.

What a file says around its formulas: where they are printed, and why one is wrong.

Printed formulas from texts: one with an unknown name is kept as such, what is no formula is refused.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from derive.check.printed import Document, Printed, Remark
from derive.errors import CheckError, UnknownNameError, listed, near_miss, quoted
from derive.lecture.shorthand import read_formula
from derive.robot.document import Node, YamlMapping, YamlScalar, YamlSequence
from derive.robot.expression import ZERO, Expression, Name
from derive.robot.robot import Robot


def mapping(node: Node, what: str, required: Collection[str] = (), optional: Collection[str] = ()) -> YamlMapping:
    """A mapping with these keys and no others; with no keys given, any.

    Raises:
        CheckError: Another kind of node, a key that is missing, or one that is unknown.
    """
    if not isinstance(node, YamlMapping):
        raise CheckError(f"{what} is not a mapping", remedy="write key: value", location=node.location)
    known = (*required, *optional)
    for name, (key, _) in node.entries.items():
        if known and name not in known:
            raise CheckError(
                f"unknown key {quoted(name)} in {what}",
                allowed=f"allowed: {listed(known)}",
                remedy=near_miss(name, known),
                location=key.location,
            )
    for name in required:
        if name not in node.entries:
            raise CheckError(f"{what} without {name!r}", remedy=f"add {name}:", location=node.location)
    return node


def items(node: Node | None, what: str) -> list[Node]:
    """The items of a list; none where there is no node.

    Raises:
        CheckError: Another kind of node.
    """
    if node is None:
        return []
    if not isinstance(node, YamlSequence):
        raise CheckError(f"{what} is not a list", remedy="write items with - or in [ ]", location=node.location)
    return node.items


def scalar(node: Node, what: str) -> YamlScalar:
    """A text.

    Raises:
        CheckError: A list or a mapping.
    """
    if not isinstance(node, YamlScalar):
        raise CheckError(f"{what} is not a single text", remedy='write "..."', location=node.location)
    return node


def child(node: YamlMapping, name: str) -> Node | None:
    """The value of a key, or None."""
    entry = node.entries.get(name)
    return entry[1] if entry else None


def word(node: YamlMapping, name: str, allowed: Collection[str], default: str) -> str:
    """One of some words.

    Raises:
        CheckError: Another word.
    """
    value = child(node, name)
    if value is None:
        return default
    found = scalar(value, name)
    if found.text not in allowed:
        raise CheckError(
            f"{name}: {quoted(found.text)}",
            allowed=f"allowed: {listed(allowed)}",
            remedy=near_miss(found.text, allowed),
            location=found.location,
        )
    return found.text


def flag(node: YamlMapping, name: str) -> bool:
    """``true`` or ``false``; false where the key is missing."""
    return word(node, name, ("true", "false"), "false") == "true"


KINDS = ("error", "convention", "notation")


def remark(item: YamlMapping) -> Remark:
    """The remarks of one item.

    Raises:
        CheckError: An unknown kind.
    """
    return Remark(
        note=text_of(item, "note"),
        kind=word(item, "kind", KINDS, "error"),
        duplicate=flag(item, "duplicate"),
        document=printed_in(item),
    )


def printed_in(node: YamlMapping) -> Document:
    """The block ``source:``, empty where there is none or where it is only a text."""
    source = child(node, "source")
    if isinstance(source, YamlMapping):
        return Document(text_of(source, "document"), text_of(source, "section"))
    return Document(source.text if isinstance(source, YamlScalar) else "")


def text_of(node: YamlMapping, key: str) -> str:
    """The text under a key, on one line; empty where it is missing or no text."""
    value = child(node, key)
    return " ".join(value.text.split()) if isinstance(value, YamlScalar) else ""


Refusal = TypeVar("Refusal", bound=CheckError)

_WORD = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """Further names of some formulas, beside the robot's own.

    Attributes:
        names: What they stand for; those of `unknown` stand for themselves.
        unknown: Why nothing can be said about a formula with such a name: its definition has an unknown name.
    """

    names: Mapping[str, Expression] = field(default_factory=dict)
    unknown: Mapping[str, UnknownNameError] = field(default_factory=dict)

    def defining(self, name: str, definition: Printed) -> Vocabulary:
        """With one name more."""
        if definition.unknown is None:
            return Vocabulary({**self.names, name: definition.formula}, self.unknown)
        return Vocabulary({**self.names, name: Name(name)}, {**self.unknown, name: definition.unknown})


NO_NAMES = Vocabulary()


def read_printed(
    text: YamlScalar, robot: Robot, further: Vocabulary = NO_NAMES, place: tuple[int, int] = (1, 1)
) -> Printed:
    """A printed formula; one with a name that the robot does not know says so and has the formula zero.

    Args:
        text: The formula in the file.
        robot: Whose formula it is.
        further: Names beside the robot's own.
        place: Row and column of the entry, from 1.

    Raises:
        CheckError: The text is no formula.
    """
    try:
        formula = read_formula(text.text, robot, text.inner, further.names)
    except UnknownNameError as error:
        return Printed(*place, text.text, ZERO, text.inner, _placed(error, text))
    except CheckError as error:
        raise _placed(error, text) from None
    for word in _WORD.findall(text.text) if further.unknown else ():
        if word in further.unknown:
            return Printed(*place, text.text, ZERO, text.inner, further.unknown[word])
    return Printed(*place, text.text, formula, text.inner)


def _placed(error: Refusal, text: YamlScalar) -> Refusal:
    """Columns inside a folded or escaped text are not those of the file; there the error is at its beginning."""
    if text.verbatim:
        return error
    return type(error)(error.found, allowed=error.allowed, remedy=error.remedy, location=text.location)
