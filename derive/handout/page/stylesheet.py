"""Names for the classes of all formulas of a page, and the part of KaTeX's style sheet that they need."""

from __future__ import annotations

import re
from base64 import b64encode
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import count, islice, product
from string import ascii_lowercase
from typing import Any

from derive.handout.page.compact import CENTERED, STACK, Node, elements
from derive.handout.page.katex import asset

ELEMENT = "b"
"""What a span becomes: three letters shorter, twice."""

ITALIC = "mathnormal"
"""Class of a variable's letter, which becomes an element of its own."""

_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_CLASS = re.compile(r"\.([A-Za-z][\w-]*)")
_ROOTS = frozenset(("katex", "katex-display", "katex-mathml"))
_FONTS = (
    ("Main-Regular", "KaTeX_Main", 400, "normal", ()),
    ("Main-Bold", "KaTeX_Main", 700, "normal", ("mathbf", "textbf")),
    ("Main-Italic", "KaTeX_Main", 400, "italic", ("mathit", "textit")),
    ("Main-BoldItalic", "KaTeX_Main", 700, "italic", ("textit", "textbf")),
    ("Math-Italic", "KaTeX_Math", 400, "italic", (ITALIC,)),
    ("Math-BoldItalic", "KaTeX_Math", 700, "italic", ("boldsymbol",)),
    ("Size1-Regular", "KaTeX_Size1", 400, "normal", ("size1", "delim-size1", "small-op")),
    ("Size2-Regular", "KaTeX_Size2", 400, "normal", ("size2", "large-op")),
    ("Size3-Regular", "KaTeX_Size3", 400, "normal", ("size3",)),
    ("Size4-Regular", "KaTeX_Size4", 400, "normal", ("size4", "delim-size4")),
    ("AMS-Regular", "KaTeX_AMS", 400, "normal", ("amsrm", "mathbb", "textbb")),
    ("Typewriter-Regular", "KaTeX_Typewriter", 400, "normal", ("mathtt", "texttt")),
    ("Caligraphic-Regular", "KaTeX_Caligraphic", 400, "normal", ("mathcal",)),
)
"""File, family, weight, style, and the classes that ask for it; none: always."""

_BASE = f"""
.katex {ELEMENT}{{font-weight:inherit}}
.katex i{{font-family:KaTeX_Math;font-style:italic}}
.katex sub,.katex sup{{line-height:0;vertical-align:baseline}}
.katex .{STACK},.katex .{CENTERED}{{display:inline-grid;line-height:0;align-items:baseline;justify-items:start}}
.katex .{CENTERED}{{justify-items:center}}
.katex .{STACK}>*,.katex .{CENTERED}>*{{grid-area:1/1;position:relative}}
"""
"""Rules for what the compaction makes."""


@dataclass(frozen=True)
class Names:
    """Short names of classes and of inline styles.

    Attributes:
        classes: Class -> name.
        styles: Inline style -> name.
        usual: Tag -> the style that an element of it has without a class.
    """

    classes: dict[str, str]
    styles: dict[str, str]
    usual: dict[str, str]


@cache
def known_classes() -> frozenset[str]:
    """Classes that KaTeX's style sheet has rules for."""
    return frozenset(name for selectors, _ in _rules() for name in _CLASS.findall(selectors))


@cache
def _rules() -> tuple[tuple[str, str], ...]:
    css = asset("katex.min.css").read_text(encoding="utf-8")
    rules = ((selectors.strip(), body) for selectors, body in _RULE.findall(css))
    return tuple(rule for rule in rules if not rule[0].startswith(("@", "body")) and "katex-version" not in rule[0])


def names(trees: Iterable[Node]) -> Names:
    """Names for everything in the trees, the shortest for the most frequent."""
    usage: Counter[tuple[str, str]] = Counter()
    scripts: dict[str, Counter[str]] = {"sub": Counter(), "sup": Counter()}
    for node in (node for tree in trees for node in elements(tree)):
        usage.update(("class", name) for name in node.classes if name not in _ROOTS)
        if node.style and node.tag in scripts:
            scripts[node.tag][node.style] += 1
        elif node.style:
            usage["style", node.style] += 1
    usual = {tag: _order(counter)[0] for tag, counter in scripts.items() if counter}
    for tag, counter in scripts.items():
        usage.update({("style", style): n for style, n in counter.items() if style != usual[tag]})
    given = dict(zip(_order(usage), _short_names(len(usage)), strict=True))
    return Names(
        {text: name for (kind, text), name in given.items() if kind == "class"},
        {text: name for (kind, text), name in given.items() if kind == "style"},
        usual,
    )


def _order(counter: Counter[Any]) -> list[Any]:
    return sorted(counter, key=lambda key: (-counter[key], key))


def _short_names(number: int) -> list[str]:
    """a, b, ..., z, aa, ab, ...: none of them is a class of the page's own style sheet."""
    words = ("".join(letters) for length in count(1) for letters in product(ascii_lowercase, repeat=length))
    return list(islice(words, number))


def write(node: Node, names: Names) -> str:
    """The tree as HTML with the short names."""
    inner = "".join(child if isinstance(child, str) else write(child, names) for child in node.children)
    attributes = "".join(f' {name}="{value}"' for name, value in node.attributes)
    tag, classes = node.tag, [names.classes.get(name, name) for name in node.classes]
    if tag == "span" and node.classes == (ITALIC,):
        tag, classes = "i", []
    if node.style and names.usual.get(tag) != node.style:
        classes.append(names.styles[node.style])
    tag = ELEMENT if tag == "span" else tag
    return f"<{tag}{_class(classes)}{attributes}>{inner}</{tag}>"


def _class(classes: list[str]) -> str:
    if not classes:
        return ""
    return f" class={classes[0]}" if len(classes) == 1 else f' class="{" ".join(classes)}"'


def stylesheet(names: Names) -> str:
    """The rules and fonts that formulas with these names need."""
    used = set(names.classes) | _ROOTS
    rules = [_rule(selectors, body, used, names) for selectors, body in _rules()]
    own = [_renamed(line, names) for line in _BASE.strip().splitlines()]
    usual = [f".katex {tag}{{{style}}}" for tag, style in sorted(names.usual.items())]
    styles = [f".katex .{name}.{name}.{name}{{{style}}}" for style, name in sorted(names.styles.items())]
    return "\n".join([*_font_faces(used), *filter(None, rules), *own, *usual, *styles])


def _rule(selectors: str, body: str, used: set[str], names: Names) -> str:
    wanted = [selector for selector in selectors.split(",") if set(_CLASS.findall(selector)) <= used]
    return f"{_renamed(','.join(wanted), names)}{{{body}}}" if wanted else ""


def _renamed(rule: str, names: Names) -> str:
    rule = re.sub(r"\bspan\b", ELEMENT, rule)
    return _CLASS.sub(lambda found: f".{names.classes.get(found[1], found[1])}", rule)


def _font_faces(used: set[str]) -> list[str]:
    return [
        f"@font-face{{font-display:block;font-family:{family};font-style:{style};font-weight:{weight};"
        f'src:url(data:font/woff2;base64,{_font(file)}) format("woff2")}}'
        for file, family, weight, style, classes in _FONTS
        if not classes or used.intersection(classes)
    ]


@cache
def _font(file: str) -> str:
    return b64encode(asset(f"KaTeX_{file}.woff2").read_bytes()).decode("ascii")
