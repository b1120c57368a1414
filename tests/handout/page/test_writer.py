"""The web page: one file, everything escaped, every formula drawn and nothing lost in making it small."""

from __future__ import annotations

import ast
import re
from html.parser import HTMLParser
from importlib.util import find_spec

import pytest

from derive.errors import TargetError
from derive.handout.document import Document, Entry, Formula, Paragraph, Rows, Section, blocks_of
from derive.handout.language import Text
from derive.handout.page import katex
from derive.handout.page.blocks import plain
from derive.handout.page.compact import compact, elements, parse
from derive.handout.page.formulas import size
from derive.handout.page.katex import Mathematics, render
from derive.handout.page.stylesheet import known_classes, names, stylesheet, write
from derive.handout.page.viewer import Viewer
from derive.handout.page.writer import page, safe_script
from tests.handout.page.page_documents import ENTRIES, LONG, MATRIX, TITLE, document

pytestmark = pytest.mark.skipif(find_spec("py_mini_racer") is None, reason="mini-racer is not installed")

VOID = {"meta", "link", "br", "img", "input", "hr"}
FORMULAS = (
    MATRIX,
    LONG,
    r"\dot{q}_{1}^{2} + \ddot{\vartheta}_{2} = \frac{1}{2}m_{1}\dot{\mathbf{q}}^{\mathsf{T}}\mathbf{B}\dot{\mathbf{q}}",
    r"\sum_{i=1}^{n} x_i^{2} + \sqrt{a_1^2 + a_2^2} + \operatorname{atan2}(r_{11}, \pm\sqrt{r_{13}^2}) + {}^{0}\!A_1",
    r"\begin{cases} a & b > 0 \\ c & d \end{cases}\quad\left(\frac{1}{2}\right)^2\,\hat{z}_{i-1}\times\vec{p}",
)


class Reader(HTMLParser):
    """Elements, attributes and text of a page; fails where tags do not match."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self._open: list[str] = []
        self.feed(html)
        assert not self._open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.found if name == tag]


@pytest.fixture(scope="module")
def html() -> str:
    return page(document(), Text())


@pytest.fixture(scope="module")
def reader(html: str) -> Reader:
    return Reader(html)


def test_no_address_of_another_file_is_in_the_page(html: str, reader: Reader) -> None:
    assert not re.findall(r"https?://|//[a-z]+\.", html)
    for _, attributes in reader.found:
        for name in ("src", "href", "srcset", "action"):
            assert (attributes.get(name) or "#").startswith(("#", "data:"))
    assert all(address.startswith("data:") for address in re.findall(r"url\(([^)]*)\)", html))


def test_the_page_states_its_language_and_refuses_every_request(html: str, reader: Reader) -> None:
    assert reader.all("html") == [{"lang": "it"}]
    policies = [meta["content"] for meta in reader.all("meta") if "http-equiv" in meta]
    assert [policy for policy in policies if (policy or "").startswith("default-src 'none'")]


def test_the_title_is_text_whatever_it_holds(html: str, reader: Reader) -> None:
    assert len(reader.all("script")) == 1
    assert "".join(reader.texts).count(TITLE.removesuffix("</title>")) == 2
    assert "alert(" not in html[html.index("<script>") :]


def test_markup_in_texts_is_text(reader: Reader) -> None:
    assert "<b>nothing</b>" in "".join(reader.texts)


def test_every_section_can_be_reached(reader: Reader) -> None:
    anchors = {attributes["href"] for attributes in reader.all("a")}
    assert {f"#{attributes['id']}" for attributes in reader.all("section")} <= anchors


def test_every_formula_is_drawn_and_spoken(html: str) -> None:
    """Each display is there once for the eye and once as MathML."""
    sheet = document()
    lines = [line for section in sheet.sections for block in blocks_of(section) for line in lines_of(block)]
    assert html.count("<span class=katex-display>") == len(lines)
    assert html.count("<math") == html.count('aria-hidden="true"') == html.count("<span class=katex>")
    assert "katex-error" not in html


def lines_of(block: object) -> list[str]:
    if isinstance(block, Formula):
        return [*(line for rows in block.rows for line in rows.lines), *block.named, *block.omitted]
    return list(block.lines) if isinstance(block, Rows) else []


def test_tables_have_heads(reader: Reader) -> None:
    assert {attributes["scope"] for attributes in reader.all("th")} == {"col", "row"}


def test_entries_can_be_copied_as_they_are(reader: Reader) -> None:
    options = [(option["data-latex"], option["data-python"]) for option in reader.all("option")]
    assert options == [(entry.latex, entry.python) for entry in ENTRIES]
    for _, python in options:
        ast.parse(python or "", mode="eval")


def test_the_page_is_the_same_each_time(html: str) -> None:
    assert page(document(), Text()) == html


def test_texts_of_the_page_are_translated() -> None:
    assert "Copia LaTeX" in page(document(), Text("it", {"Copy LaTeX": "Copia LaTeX"}))


def test_a_formula_that_cannot_be_drawn_is_named() -> None:
    with pytest.raises(TargetError, match=r"\\nonsense"):
        render([Mathematics(r"a + \nonsense")])


def test_without_the_engine_the_remedy_is_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "py_mini_racer", None)
    with pytest.raises(TargetError, match=r"pip install 'derive-robot\[handout\]'"):
        katex.render([Mathematics("a")])


def test_a_script_cannot_end_its_element() -> None:
    assert "</script" not in safe_script('var a = "</script><!--";')


def test_the_figure_stands_in_the_page() -> None:
    viewer = Viewer("<div id=arm></div>", "#arm{color:red}", 'var arm = "</script>";')
    html = page(document(), Text(), viewer)
    assert "<div id=arm></div>" in html
    assert "#arm{color:red}" in html
    assert html.count("</script>") == 2


def large(rows: int) -> Document:
    lines = tuple(rf"b_{{{k}}} = {LONG}" for k in range(rows))
    entry = Entry("b", LONG, "b")
    formula = Formula((Rows(lines),), entries=(entry,))
    return document(Section("large", "Large", (Paragraph("$x$"), formula)), title="Large")


def test_a_page_beyond_the_budget_gives_up_mathml_of_the_longest_displays_and_nothing_else() -> None:
    sheet = large(60)
    whole = page(sheet, Text(), budget=10**9)
    budget = size(whole) - 100_000
    small = page(sheet, Text(), budget=budget)
    assert size(small) <= budget
    labels = re.findall(r'role=img aria-label="([^"]*)"', small)
    assert labels
    assert all(len(label) >= len(LONG) for label in labels)
    assert small.count("<span class=katex") - small.count("<math") == whole.count("<span class=katex") - whole.count(
        "<math"
    )
    assert small.count("<math") + len(labels) == whole.count("<math")


@pytest.mark.parametrize("latex", FORMULAS)
def test_compaction_keeps_every_letter_in_its_order(latex: str) -> None:
    html = render([Mathematics(latex, True)])[Mathematics(latex, True)].html
    tree = compact(parse(html), known_classes(), display=True)
    assert letters(write(tree, names([tree]))) == letters(html)


def letters(html: str) -> str:
    return re.sub(r"<[^>]*>|\u200b", "", html)


def test_compaction_makes_indices_ten_times_smaller() -> None:
    item = Mathematics(LONG, True)
    html = render([item])[item].html
    tree = compact(parse(html), known_classes(), display=True)
    assert 10 * len(write(tree, names([tree]))) < len(html)


def test_every_font_and_rule_of_the_formulas_is_in_the_style_sheet() -> None:
    rendered = render(Mathematics(latex, True) for latex in FORMULAS)
    trees = [compact(parse(both.html), known_classes(), display=True) for both in rendered.values()]
    given = names(trees)
    css = stylesheet(given)
    for name in ("mathbf", "vlist-t", "delimsizing", "stack", "stack-center"):
        assert re.search(rf"\.{given.classes[name]}(?![\w-])[^{{}}]*{{", css)
    rules = re.sub(r"@font-face{[^}]*}", "", css)
    assert set(re.findall(r"KaTeX_\w+", rules)) == set(re.findall(r"KaTeX_\w+", css))
    assert {"KaTeX_Main", "KaTeX_Math", "KaTeX_Size4"} <= set(re.findall(r"@font-face{[^}]*(KaTeX_\w+)", css))
    assert not re.search(r"url\((?!data:)", css)
    assert (
        not {name for tree in trees for node in elements(tree) for name in node.classes}
        - set(given.classes)
        - {
            "katex",
            "katex-display",
        }
    )


@pytest.mark.parametrize(
    ("latex", "name"),
    [
        ("b_{12}", "b₁₂"),
        (r"\dot{\vartheta}_{1}", "ϑ\u0307₁"),
        (r"\mathbf{T}_{4}^{0}", "T₄⁰"),
        (r"c_{ijk}", "cᵢⱼₖ"),
        (r"{}^{0}A_{1}", "⁰A₁"),
    ],
)
def test_names_of_entries_in_plain_letters(latex: str, name: str) -> None:
    assert plain(latex) == name
