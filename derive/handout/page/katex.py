"""LaTeX to HTML and MathML ahead of time, by the vendored KaTeX in an embedded V8 engine."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable

from derive.errors import TargetError

MEMORY = 1_500_000_000
"""Bytes that the engine may use before it gives up."""

_RENDER = """
(function (formulas) {
  return JSON.stringify(formulas.map(function (formula) {
    try {
      var options = {displayMode: formula[1], throwOnError: true, strict: "ignore", trust: false, output: "html"};
      var html = katex.renderToString(formula[0], options);
      options.output = "mathml";
      return [html, katex.renderToString(formula[0], options)];
    } catch (error) {
      return [String(error.message || error)];
    }
  }));
})
"""


@dataclass(frozen=True, slots=True, order=True)
class Mathematics:
    """A formula to be rendered.

    Attributes:
        latex: In mathematics mode.
        display: Whether it stands on a line of its own.
    """

    latex: str
    display: bool = False


@dataclass(frozen=True, slots=True)
class Rendered:
    """A formula as KaTeX writes it.

    Attributes:
        html: For the eye; needs the style sheet and the fonts of KaTeX.
        mathml: For screen readers, and for browsers that draw MathML themselves.
    """

    html: str
    mathml: str


def render(formulas: Iterable[Mathematics]) -> dict[Mathematics, Rendered]:
    """All formulas, each distinct one rendered once, in one call of the engine.

    Raises:
        TargetError: The engine is not installed, or KaTeX does not understand a formula.
    """
    wanted = sorted(set(formulas))
    if not wanted:
        return {}
    answers = json.loads(_evaluate(json.dumps([[item.latex, item.display] for item in wanted])))
    return {item: _rendered(item, answer) for item, answer in zip(wanted, answers, strict=True)}


def asset(name: str) -> Traversable:
    """A file of the vendored KaTeX."""
    return files("derive").joinpath("assets", "katex", name)


def _evaluate(argument: str) -> str:
    """A fresh engine each time: it starts in a tenth of a second and leaves no threads behind."""
    try:
        from py_mini_racer import MiniRacer
    except ImportError:
        raise TargetError(
            "the web page needs the package mini-racer, which is not installed",
            remedy="run: pip install 'derive-robot[handout]'",
        ) from None
    with MiniRacer() as engine:
        engine.eval(_script())
        return str(engine.eval(f"{_RENDER}({argument})", max_memory=MEMORY))


@cache
def _script() -> str:
    return asset("katex.min.js").read_text(encoding="utf-8")


def _rendered(item: Mathematics, answer: list[str]) -> Rendered:
    if len(answer) == 2:
        return Rendered(*answer)
    raise TargetError(
        f"KaTeX cannot draw the formula {item.latex!r}: {answer[0]}",
        remedy="please report it with the robot file: every formula of the handout is meant to be drawn",
    )
