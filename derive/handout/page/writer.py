"""A document as one HTML file: formulas, figures, fonts, styles and scripts inside of it, nothing from a network."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from derive.handout.document import Document, Steps, blocks_of
from derive.handout.language import Text
from derive.handout.page.blocks import BlockWriter
from derive.handout.page.formulas import Collector, size
from derive.targets import templating
from derive.targets.escape import html_text

if TYPE_CHECKING:
    from derive.handout.page.viewer import Viewer


BUDGET = 2_990_000
"""Bytes of the page; the file may have three million, with what a command writes at its top."""

_SCRIPT_END = re.compile(r"<(?=/script|!--|script)", re.IGNORECASE)
_STYLE_END = re.compile(r"<(?=/style)", re.IGNORECASE)
_CONTENT = "\ue002"
_FORMULA_STYLES = "\ue003"
"""Places of the parts that are written last."""


def page(document: Document, text: Text, viewer: Viewer | None = None, budget: int = BUDGET) -> str:
    """The document as a web page.

    Args:
        document: The handout.
        text: Translates the words of the page itself.
        viewer: The figure that the reader can move, None for none.
        budget: Bytes that the file may have; beyond it the longest formulas lose their MathML, never their drawing.

    Raises:
        TargetError: The package mini-racer is not installed, or a formula cannot be drawn.
    """
    formulas = Collector()
    content = templating.render("page/content.html.jinja", **_content(document, text, viewer, formulas))
    frame = templating.render("page/page.html.jinja", **_frame(document, text, viewer))
    content, styles = formulas.fill(content, budget - size(frame))
    return frame.replace(_FORMULA_STYLES, styles, 1).replace(_CONTENT, content, 1)


def _content(document: Document, text: Text, viewer: Viewer | None, formulas: Collector) -> dict[str, Any]:
    writer = BlockWriter(text, formulas)
    sections = [
        {"anchor": html_text(section.part), "title": writer.words(section.title), "body": writer.blocks(section.blocks)}
        for section in document.sections
    ]
    return {
        "words": {name: html_text(word) for name, word in _words(text).items()},
        "title": html_text(document.title),
        "subtitle": writer.words(document.subtitle),
        "sections": sections,
        "viewer": viewer.html if viewer else "",
        "steps": any(isinstance(block, Steps) for section in document.sections for block in blocks_of(section)),
        "footer": writer.words(document.footer),
        "name": html_text(document.name),
        "digest": html_text(document.digest),
        "version": html_text(document.version),
    }


def _words(text: Text) -> dict[str, str]:
    """What the page itself says."""
    _ = text
    return {
        "skip": _("Skip to the content"),
        "contents": _("Contents"),
        "motion": _("The robot in motion"),
        "open_steps": _("Open all steps"),
        "close_steps": _("Close all steps"),
        "dark": _("Dark page"),
        "light": _("Light page"),
        "copied": _("Copied"),
        "failed": _("The browser does not allow copying"),
    }


def _frame(document: Document, text: Text, viewer: Viewer | None) -> dict[str, Any]:
    return {
        "language": html_text(document.language),
        "title": html_text(document.title or document.name),
        "style": templating.render("page/style.css.jinja"),
        "script": templating.render("page/page.js.jinja"),
        "viewer_style": safe_style(viewer.css) if viewer else "",
        "viewer_script": safe_script(viewer.script) if viewer else "",
        "formula_styles": _FORMULA_STYLES,
        "content": _CONTENT,
    }


def safe_script(script: str) -> str:
    r"""A script that cannot end its element: in strings ``<\/script`` means the same as ``</script``."""
    return _SCRIPT_END.sub(lambda found: "<\\", script)


def safe_style(css: str) -> str:
    """A style sheet that cannot end its element."""
    return _STYLE_END.sub(lambda found: "<\\", css)
