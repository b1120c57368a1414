"""Reading of positioned trees outside the robot block: mappings with known keys, lists, texts and words."""

from __future__ import annotations

from collections.abc import Collection

from derive.errors import CheckError
from derive.robot.document import Mapping, Node, Scalar, Sequence
from derive.robot.wording import listed, near_miss, quoted


def mapping(node: Node, what: str, required: Collection[str] = (), optional: Collection[str] = ()) -> Mapping:
    """A mapping with these keys and no others; with no keys given, any.

    Raises:
        CheckError: Another kind of node, a key that is missing, or one that is unknown.
    """
    if not isinstance(node, Mapping):
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
    if not isinstance(node, Sequence):
        raise CheckError(f"{what} is not a list", remedy="write items with - or in [ ]", location=node.location)
    return node.items


def scalar(node: Node, what: str) -> Scalar:
    """A text.

    Raises:
        CheckError: A list or a mapping.
    """
    if not isinstance(node, Scalar):
        raise CheckError(f"{what} is not a single text", remedy='write "..."', location=node.location)
    return node


def child(node: Mapping, name: str) -> Node | None:
    """The value of a key, or None."""
    entry = node.entries.get(name)
    return entry[1] if entry else None


def word(node: Mapping, name: str, allowed: Collection[str], default: str) -> str:
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


def flag(node: Mapping, name: str) -> bool:
    """``true`` or ``false``; false where the key is missing."""
    return word(node, name, ("true", "false"), "false") == "true"
