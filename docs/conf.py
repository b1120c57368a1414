"""The documentation as a site: ``make docs``."""

from __future__ import annotations

import html
import re
import shutil
import sys
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[1]
KATEX = ROOT / "derive" / "assets" / "katex"
sys.path.insert(0, str(ROOT))

from derive.version import __version__  # noqa: E402

project = "derive"
author = "the derive developers"
copyright = author
release = version = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["_build"]
default_role = "literal"

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True, "show-inheritance": True}
toc_object_entries = False
"""An entry for each function in the contents, which every page carries, took six minutes of eight."""
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

suppress_warnings = ["ref.python"]
"""Names in signatures may have several homes; a link to one of them is no promise."""

html_theme = "furo"
html_title = f"derive {__version__}"
html_static_path = ["site", *(str(KATEX / name) for name in ("katex.min.css", "katex.min.js"))]
html_css_files = ["katex.min.css"]
html_js_files = ["katex.min.js", "formulas.js"]
html_math_renderer = "katex"
html_extra_path = ["gallery/pages"]


def _formula(block: bool) -> Any:
    def visit(self: Any, node: nodes.Node) -> None:
        tag = "div" if block else "span"
        self.body.append(f'<{tag} class="formula">{html.escape(node.astext())}</{tag}>')
        raise nodes.SkipNode

    return visit


def _at_home(app: Sphinx, page: str, source: list[str]) -> None:
    """README is the first page; links are as in the repository, so those out of ``docs`` lead elsewhere in the site."""
    if page == "index":
        readme = (ROOT / "README.md").read_text(encoding="utf-8")
        source[0] = re.sub(r"\]\((?!https?:|#|docs/)", "](../", readme).replace("](docs/", "](") + source[0]
    source[0] = (
        source[0]
        .replace("](../bench/results/", "](bench/results/")
        .replace("](../../bench/results/", "](../bench/results/")  # from a decision
        .replace("](../CONTRIBUTING.md", "](contributing.md")
    )


def _plain(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Docstrings hold formulas, not markup: ``a1*c1`` and ``|qd|`` stay as they are, outside of backticks."""
    for number, line in enumerate(lines):
        parts = line.split("`")
        lines[number] = "`".join(_escaped(part) if i % 2 == 0 else part for i, part in enumerate(parts))


def _escaped(text: str) -> str:
    return re.sub(r"[*|\\]|(?<=\w)_(?!\w)", lambda found: "\\" + found[0], text)


def _fonts(app: Sphinx, error: Exception | None) -> None:
    """The fonts of the formulas lie where KaTeX's style sheet looks for them."""
    folder = Path(app.outdir) / "_static" / "fonts"
    folder.mkdir(parents=True, exist_ok=True)
    for font in KATEX.glob("*.woff2"):
        shutil.copy(font, folder)


def setup(app: Sphinx) -> None:
    """Formulas are drawn by the KaTeX that derive brings along: the site needs no network."""
    shutil.copytree(ROOT / "bench" / "results", ROOT / "docs" / "bench" / "results", dirs_exist_ok=True)
    recipes = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (ROOT / "docs" / "contributing.md").write_text(recipes.replace("](docs/", "]("), encoding="utf-8")
    app.connect("source-read", _at_home)
    app.connect("build-finished", _fonts)
    app.connect("autodoc-process-docstring", _plain, priority=100)
    app.add_html_math_renderer("katex", (_formula(False), None), (_formula(True), None))
