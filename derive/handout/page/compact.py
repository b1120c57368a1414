"""KaTeX's markup made small, with the same picture.

KaTeX places an index with nine nested elements, for browsers of ten years ago. Here an index is one element with a
vertical shift, a column of a matrix one grid with shifted cells, and what has no rule in the style sheet goes.

The markup that KaTeX writes, as a tree.
"""

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


STACK = "stack"
"""Class of elements that lie over each other, each with a shift."""

CENTERED = "stack-center"
"""Class of such elements that are centred on each other."""

_CONTEXTS = {"msupsub": STACK, "katex-accent": CENTERED, "col-align-c": CENTERED, "col-align-l": STACK}
_STRUCTURE = frozenset(
    ("vlist", "mfrac", "delim-size1", "delim-size4", "katex-inner", "clap", "llap", "rlap", STACK, CENTERED)
)
"""Classes whose children, and theirs, are addressed by their places."""

_SIZE = {"size1": 0.5, "size2": 0.6, "size3": 0.7, "size4": 0.8, "size5": 0.9, "size6": 1.0}
"""Sizes as parts of the normal size."""

_LENGTH = re.compile(r"-?[0-9.]+")


def compact(tree: Node, kept: frozenset[str], *, display: bool) -> Node:
    """The tree with the same picture and far fewer elements.

    Args:
        tree: KaTeX's HTML of one formula.
        kept: Classes that have a rule in the style sheet.
        display: Whether the formula stands on a line of its own, where lines are never broken.
    """
    tree = rebuild(tree, _stacked)
    if display:
        tree = rebuild(tree, _joined)
    tree = rebuild(tree, lambda node: _spaced(_dressed(node, kept)))
    return rebuild(tree, _unwrapped)


def _length(text: str) -> float:
    found = _LENGTH.match(text)
    return float(found.group()) if found else 0.0


def properties(style: str) -> dict[str, str]:
    """An inline style as a mapping."""
    pairs = (part.split(":", 1) for part in style.split(";") if part)
    return {name: value for name, value in pairs}


def em(value: float) -> str:
    """A length, short."""
    text = f"{value:.4f}".rstrip("0").rstrip(".").replace("0.", ".", 1) if abs(value) < 1 else f"{value:.4f}"
    text = text.rstrip("0").rstrip(".") if "." in text[1:] else text
    return "0" if text in ("", "0", "-0", "-") else f"{text}em"


def _stacked(node: Node) -> Node:
    """Indices, accents and columns without their tables."""
    context = next((name for name in node.classes if name in _CONTEXTS), None)
    if context is None or len(node.children) != 1:
        return node
    items = _items(node.elements[0])
    if not items:
        return node
    if context == "msupsub" and len(items) == 1:
        return _script(*items[0])
    cells = tuple(_cell(shift, style, content) for shift, style, content in items)
    classes = tuple(name for name in node.classes if name != context)
    return Node("span", (*classes, _CONTEXTS[context]), node.style, (), cells)


def _items(table: Node) -> list[tuple[float, dict[str, str], Node]]:
    """Shift downwards [em], other style and content of everything in a table; nothing if it is of another kind."""
    box = find(table, "vlist") if "vlist-t" in table.classes else None
    found = []
    for entry in box.elements if box else ():
        if len(entry.children) < 2 or entry.classes or "pstrut" not in entry.elements[0].classes:
            return []
        style = properties(entry.style)
        shift = _length(style.pop("top")) + _length(properties(entry.elements[0].style)["height"])
        rest = entry.children[1:]
        content = rest[0] if len(rest) == 1 and isinstance(rest[0], Node) else Node("span", children=rest)
        if any(name in ("svg-align", "frac-line", "katex-stretchy") for name in content.classes):
            return []
        found.append((round(shift, 4), style, content))
    return found


def _resized(content: Node) -> float:
    """Factor of the type size of an index."""
    known = "katex-sizing" in content.classes and "reset-size6" in content.classes and not content.style
    return next((_SIZE[name] for name in content.classes if name in _SIZE), 0.0) if known else 0.0


def _margins(style: dict[str, str], size: float) -> str:
    left, right = (_length(style.get(f"margin-{side}", "0")) / size for side in ("left", "right"))
    return f"margin:0 {em(right)} 0 {em(left)}" if left or right else ""


def _script(shift: float, style: dict[str, str], content: Node) -> Node:
    """A single index: shifted text."""
    size = _resized(content)
    inner = content.children if size else (content,)
    size = size or 1.0
    parts = (f"vertical-align:{em(-shift / size)}", f"font-size:{em(size)}", _margins(style, size))
    return Node("sub" if shift > 0 else "sup", (), ";".join(filter(None, parts)), (), inner)


def _cell(shift: float, style: dict[str, str], content: Node) -> Node:
    """One of several elements that lie over each other."""
    size = _resized(content)
    parts = [f"top:{em(shift / (size or 1.0))}" if shift else "", _margins(style, size or 1.0)]
    if size:
        parts.append(f"font-size:{em(size)}")
        return Node("span", (), ";".join(filter(None, parts)), (), content.children)
    if "accent-body" in content.classes:
        width = () if "accent-full" in content.classes else ("width:0",)
        parts += [content.style, *width]
        return Node("span", (), ";".join(filter(None, parts)), (), content.children)
    return Node("span", (), ";".join(filter(None, parts)), (), (content,))


def _joined(node: Node) -> Node:
    """One base, as high as the highest, where lines are never broken."""
    bases = node.elements
    if "katex-html" not in node.classes or not all("katex-base" in base.classes for base in bases) or len(bases) < 2:
        return node
    struts = [properties(base.elements[0].style) for base in bases]
    depths = [-_length(strut.get("vertical-align", "0")) for strut in struts]
    heights = [_length(strut["height"]) - depth for strut, depth in zip(struts, depths, strict=True)]
    style = f"height:{em(max(heights) + max(depths))};vertical-align:{em(-max(depths))}"
    strut = bases[0].elements[0]._replace(style=style)
    rest = tuple(child for base in bases for child in base.children[1:])
    return node._replace(children=(bases[0]._replace(children=(strut, *rest)),))


def _dressed(node: Node, kept: frozenset[str]) -> Node:
    """Without the classes that no rule knows."""
    classes = tuple(name for name in node.classes if name in kept or name in (STACK, CENTERED))
    return node._replace(classes=classes)


def _spaced(node: Node) -> Node:
    """Spaces as margins of the sign between them."""
    if not any(_space(child) is not None for child in node.elements):
        return node
    return node._replace(children=tuple(_with_margins(node.children)))


def _space(child: Node | str) -> float | None:
    """Width of a space [em]; None for anything else."""
    if isinstance(child, str) or child.classes != ("mspace",) or child.children:
        return None
    style = properties(child.style)
    return _length(style["margin-right"]) if set(style) == {"margin-right"} else None


def _with_margins(children: tuple[Node | str, ...]) -> Iterator[Node | str]:
    waiting = list(reversed(children))
    while waiting:
        before = _take_spaces(waiting)
        if waiting and _is_sign(waiting[-1]):
            sign = waiting.pop()
            yield _with_margin(sign, before, _take_spaces(waiting))
            continue
        if before:
            yield Node("span", ("mspace",), f"margin-right:{em(before)}")
        if waiting:
            yield waiting.pop()


def _take_spaces(waiting: list[Node | str]) -> float:
    """Takes all spaces at the end of the list; their width [em]."""
    width = 0.0
    while waiting and (found := _space(waiting[-1])) is not None:
        width += found
        waiting.pop()
    return width


def _is_sign(child: Node | str) -> bool:
    return isinstance(child, Node) and child.plain and all(isinstance(part, str) for part in child.children)


def _with_margin(sign: Node | str, before: float, after: float) -> Node | str:
    if isinstance(sign, str) or not (before or after):
        return sign
    return sign._replace(style=f"margin:0 {em(after)} 0 {em(before)}")


def _unwrapped(node: Node) -> Node:
    """Without elements that say nothing; called from the inside out."""
    if _STRUCTURE.intersection(node.classes):
        return node._replace(children=tuple(_single(child) for child in node.children))
    children = tuple(_inside(child) for child in node.children)
    return node._replace(children=tuple(part for parts in children for part in parts))


def _single(child: Node | str) -> Node | str:
    """The only element in an element that says nothing, in its place."""
    if isinstance(child, str) or not child.plain or len(child.children) != 1:
        return child
    return child.children[0] if isinstance(child.children[0], Node) else child


def _inside(child: Node | str) -> tuple[Node | str, ...]:
    return (child,) if isinstance(child, str) or not child.plain else child.children
