"""The markup that KaTeX writes, as a tree."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import NamedTuple

_TOKEN = re.compile(r"<(/?)([a-z]+)([^>]*?)(/?)>|([^<]+)")
_ATTRIBUTE = re.compile(r'([a-zA-Z-]+)="([^"]*)"')
_NAMESPACE = "xmlns"


class Node(NamedTuple):
    """An element.

    Attributes:
        tag: Its name.
        classes: Its classes.
        style: Its inline style.
        attributes: Its other attributes.
        children: Elements, and texts with their entities.
    """

    tag: str
    classes: tuple[str, ...] = ()
    style: str = ""
    attributes: tuple[tuple[str, str], ...] = ()
    children: tuple[Node | str, ...] = ()

    @property
    def plain(self) -> bool:
        """Whether it adds nothing to its children."""
        return self.tag == "span" and not (self.classes or self.style or self.attributes)

    @property
    def elements(self) -> tuple[Node, ...]:
        """Its children without the texts."""
        return tuple(child for child in self.children if isinstance(child, Node))


def parse(html: str) -> Node:
    """The one element of a text; declarations of name spaces, which HTML does not need, are left out."""
    open_tags: list[tuple[Node, list[Node | str]]] = [(Node("root"), [])]
    for closing, tag, attributes, empty, text in _TOKEN.findall(html):
        if text:
            open_tags[-1][1].append(text)
        elif closing:
            node, children = open_tags.pop()
            open_tags[-1][1].append(node._replace(children=tuple(children)))
        elif empty:
            open_tags[-1][1].append(_node(tag, attributes))
        else:
            open_tags.append((_node(tag, attributes), []))
    (root,) = (child for child in open_tags[0][1] if isinstance(child, Node))
    return root


def _node(tag: str, text: str) -> Node:
    attributes = dict(_ATTRIBUTE.findall(text))
    classes = tuple(sorted(set(attributes.pop("class", "").split())))
    style = attributes.pop("style", "").rstrip(";")
    attributes.pop(_NAMESPACE, None)
    return Node(tag, classes, style, tuple(attributes.items()))


def rebuild(node: Node, change: Callable[[Node], Node]) -> Node:
    """The tree with every element changed, the innermost first."""
    children = tuple(rebuild(child, change) if isinstance(child, Node) else child for child in node.children)
    return change(node._replace(children=children))


def elements(node: Node) -> Iterator[Node]:
    """The element and all below it."""
    pending = [node]
    while pending:
        current = pending.pop()
        yield current
        pending += reversed(current.elements)


def find(node: Node, name: str) -> Node | None:
    """The first element of a class."""
    return next((found for found in elements(node) if name in found.classes), None)
