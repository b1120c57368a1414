"""The formulas of a page: collected while the page is written, drawn together, then put in their places.

Each formula has a text alternative: MathML that screen readers read aloud, hidden behind the drawing. Where the page
would grow too large with it, the longest displays have their LaTeX as a label instead; nothing is left out.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape

from derive.handout.page.compact import Node, compact, parse, rebuild
from derive.handout.page.katex import Mathematics, Rendered, render
from derive.handout.page.stylesheet import known_classes, names, stylesheet, write

_PLACE = re.compile("\ue000(\\d+)\ue001")
"""Private characters, which no escaped text holds."""


class Collector:
    """Gives every formula of a page a place."""

    def __init__(self) -> None:
        self._places: dict[Mathematics, int] = {}

    def place(self, latex: str, *, display: bool = False) -> str:
        """A mark where the formula will stand.

        Args:
            latex: The formula in mathematics mode.
            display: Whether it stands on a line of its own.
        """
        number = self._places.setdefault(Mathematics(latex, display), len(self._places))
        return f"\ue000{number}\ue001"

    def fill(self, page: str, budget: int) -> tuple[str, str]:
        """The page with its formulas, and the style sheet that they need.

        Args:
            page: HTML with the marks.
            budget: Bytes for the page and the style sheet together.

        Raises:
            TargetError: A formula cannot be drawn, or the engine is not installed.
        """
        drawn, css = draw(render(self._places))
        formulas = list(self._places)
        counts = [0] * len(formulas)
        for found in _PLACE.finditer(page):
            counts[int(found[1])] += 1
        forms = within(drawn, dict(zip(formulas, counts, strict=True)), budget - size(page) - size(css))
        return _PLACE.sub(lambda found: forms[formulas[int(found[1])]], page), css


@dataclass(frozen=True, slots=True)
class Drawn:
    """A formula in both of its forms.

    Attributes:
        spoken: With hidden MathML.
        labelled: With its LaTeX as a label.
    """

    spoken: str
    labelled: str


def draw(rendered: Mapping[Mathematics, Rendered]) -> tuple[dict[Mathematics, Drawn], str]:
    """All formulas in both forms, and their style sheet."""
    known = known_classes()
    trees = {item: compact(parse(both.html), known, display=item.display) for item, both in rendered.items()}
    given = names(trees.values())
    drawn = {}
    for item, tree in trees.items():
        picture = write(_picture(tree), given)
        mathml = f"<span class=katex-mathml>{_mathml(rendered[item].mathml)}</span>"
        label = f' role=img aria-label="{escape(item.latex)}"'
        drawn[item] = Drawn(_framed(item, "", mathml + picture), _framed(item, label, picture))
    return drawn, stylesheet(given)


def _picture(tree: Node) -> Node:
    """KaTeX's element for the eye, which screen readers skip."""
    return next(node for node in _path(tree) if ("aria-hidden", "true") in node.attributes)


def _path(tree: Node) -> list[Node]:
    """The root, its first element, the first element of that, and so on."""
    path = [tree]
    while path[-1].elements:
        path.append(path[-1].elements[0])
    return path


def _framed(item: Mathematics, attributes: str, inner: str) -> str:
    formula = f"<span class=katex{attributes}>{inner}</span>"
    return f"<span class=katex-display>{formula}</span>" if item.display else formula


def _mathml(html: str) -> str:
    """The MathML alone, without the LaTeX that KaTeX adds to it."""
    tree = rebuild(next(node for node in _path(parse(html)) if node.tag == "math"), _lean)
    return _plain(tree)


def _lean(node: Node) -> Node:
    if node.tag == "semantics":
        return node.elements[0]
    return node.elements[0] if node.tag == "mrow" and len(node.children) == len(node.elements) == 1 else node


def _plain(node: Node) -> str:
    inner = "".join(child if isinstance(child, str) else _plain(child) for child in node.children)
    attributes = "".join(f' {name}="{value}"' for name, value in node.attributes)
    return f"<{node.tag}{attributes}>{inner}</{node.tag}>"


def within(
    drawn: Mapping[Mathematics, Drawn], counts: Mapping[Mathematics, int], budget: int
) -> dict[Mathematics, str]:
    """The form of every formula: with MathML as far as the budget goes, the longest displays lose it first.

    Args:
        drawn: Both forms.
        counts: How often each formula stands on the page.
        budget: Bytes for all of them.
    """
    forms = {item: both.spoken for item, both in drawn.items()}
    total = sum(counts[item] * size(form) for item, form in forms.items())
    for item in sorted(drawn, key=lambda item: (not item.display, -len(item.latex), item.latex)):
        if total <= budget:
            break
        total += counts[item] * (size(drawn[item].labelled) - size(forms[item]))
        forms[item] = drawn[item].labelled
    return forms


def size(text: str) -> int:
    """Bytes of a text in the file."""
    return len(text.encode())
