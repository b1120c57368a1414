"""What a file says around its formulas: where they are printed, and why one is wrong."""

from __future__ import annotations

from derive.check import tree
from derive.check.printed import Document, Remark
from derive.robot.document import Mapping, Scalar

KINDS = ("error", "convention", "notation")


def remark(item: Mapping) -> Remark:
    """The remarks of one item.

    Raises:
        CheckError: An unknown kind.
    """
    return Remark(
        note=text_of(item, "note"),
        kind=tree.word(item, "kind", KINDS, "error"),
        duplicate=tree.flag(item, "duplicate"),
        document=printed_in(item),
    )


def printed_in(node: Mapping) -> Document:
    """The block ``source:``, empty where there is none or where it is only a text."""
    source = tree.child(node, "source")
    if isinstance(source, Mapping):
        return Document(text_of(source, "document"), text_of(source, "section"))
    return Document(source.text if isinstance(source, Scalar) else "")


def text_of(node: Mapping, key: str) -> str:
    """The text under a key, on one line; empty where it is missing or no text."""
    value = tree.child(node, key)
    return " ".join(value.text.split()) if isinstance(value, Scalar) else ""
