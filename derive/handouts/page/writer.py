"""A document as one HTML file: formulas, figures, fonts, styles and scripts inside of it, nothing from a network.

The file holds every formula as LaTeX, and KaTeX, which sets it in the reader's browser: what is on the screen first,
the rest while the reader reads. Without scripts the LaTeX is there to be read.
"""

from __future__ import annotations

import re
from base64 import b64encode
from functools import cache
from importlib.resources import files
from typing import Any

from derive.handouts.document import Document, Steps, blocks_of
from derive.handouts.language import Text
from derive.handouts.page.blocks import BlockWriter
from derive.handouts.page.viewer import Viewer
from derive.targets import templating
from derive.targets.escape import html_text

_SCRIPT_END = re.compile(r"<(?=/script|!--|script)", re.IGNORECASE)
_STYLE_END = re.compile(r"<(?=/style)", re.IGNORECASE)
_FONT_FACE = re.compile(r"(@font-face\{[^}]*?src:url\(fonts/([\w-]+\.woff2)\)[^}]*\})")
_FONT_SOURCES = re.compile(r"src:[^;}]*")


def page(document: Document, text: Text, viewer: Viewer | None = None) -> str:
    """The document as a web page.

    Args:
        document: The handout.
        text: Translates the words of the page itself.
        viewer: The figure that the reader can move, None for none.

    Returns:
        HTML that needs no other file.
    """
    return templating.render(
        "page/page.html.jinja",
        language=html_text(document.language),
        title=html_text(document.title or document.name),
        style="\n".join((formula_style(), templating.render("page/style.css.jinja"))),
        script=templating.render("page/page.js.jinja"),
        katex=safe_script(_asset("katex.min.js").decode()),
        viewer_style=safe_style(viewer.css) if viewer else "",
        viewer_script=safe_script(viewer.script) if viewer else "",
        content=templating.render("page/content.html.jinja", **_content(document, text, viewer)),
    )


def _content(document: Document, text: Text, viewer: Viewer | None) -> dict[str, Any]:
    _ = text
    writer = BlockWriter(text)
    words = {
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
    sections = [
        {"anchor": html_text(section.part), "title": writer.words(section.title), "body": writer.blocks(section.blocks)}
        for section in document.sections
    ]
    return {
        "words": {name: html_text(word) for name, word in words.items()},
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


@cache
def formula_style() -> str:
    """The style sheet of KaTeX with its fonts inside; families of which we have no file are left out."""
    folder = files("derive").joinpath("assets", "katex")
    css = _asset("katex.min.css").decode()
    for face, font in _FONT_FACE.findall(css):
        inside = ""
        if folder.joinpath(font).is_file():
            data = b64encode(_asset(font)).decode("ascii")
            inside = _FONT_SOURCES.sub(f'src:url(data:font/woff2;base64,{data}) format("woff2")', face)
        css = css.replace(face, inside)
    return safe_style(css)


def _asset(name: str) -> bytes:
    """A file of the vendored KaTeX."""
    return files("derive").joinpath("assets", "katex", name).read_bytes()


def safe_script(script: str) -> str:
    r"""A script that cannot end its element: in strings ``<\/script`` means the same as ``</script``.

    Args:
        script: JavaScript in which such text stands in strings only.
    """
    return _SCRIPT_END.sub(lambda found: "<\\", script)


def safe_style(css: str) -> str:
    """A style sheet that cannot end its element.

    Args:
        css: The style sheet.
    """
    return _STYLE_END.sub(lambda found: "<\\", css)
