"""The web page: one file, everything escaped, every formula in it as LaTeX, with KaTeX and its fonts."""

import ast
import re
from html import unescape
from html.parser import HTMLParser
from itertools import chain

import pytest

from derive.handouts.page.viewer import Viewer
from derive.handouts.page.writer import formula, formula_style, page, safe_script, unicode_name
from derive.handouts.sheet.document import SheetFormula, blocks_of
from derive.handouts.sheet.language import Text
from tests.handouts.page.page_documents import ENTRIES, TITLE, document
from tests.handouts.reading import lines

VOID = {"meta", "link", "br", "img", "input", "hr"}


class Reader(HTMLParser):
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
    assert not re.findall(r"https?://|//[a-z]+\.", re.sub(r"<script>.*?</script>", "", html, flags=re.DOTALL))
    for _, attributes in reader.found:
        for name in ("src", "href", "srcset", "action"):
            assert (attributes.get(name) or "#").startswith(("#", "data:"))
    assert all(address.startswith("data:") for address in re.findall(r"url\(([^)]*)\)", html))


def test_the_page_states_its_language_and_refuses_every_request(html: str, reader: Reader) -> None:
    assert reader.all("html") == [{"lang": "it"}]
    policies = [meta["content"] for meta in reader.all("meta") if "http-equiv" in meta]
    assert [policy for policy in policies if (policy or "").startswith("default-src 'none'")]


def test_the_title_is_text_whatever_it_holds(html: str, reader: Reader) -> None:
    assert len(reader.all("script")) == 2
    assert "".join(reader.texts).count(TITLE.removesuffix("</title>")) == 2
    assert "alert(" not in html[html.index("<script>") :]
    assert "<b>nothing</b>" in "".join(reader.texts)
    assert formula(r"a < b \& c", display=True) == r"<div class=math>a &lt; b \&amp; c</div>"


def test_every_section_can_be_reached_and_tables_have_heads(reader: Reader) -> None:
    assert {attributes["scope"] for attributes in reader.all("th")} == {"col", "row"}
    anchors = {attributes["href"] for attributes in reader.all("a")}
    assert {f"#{attributes['id']}" for attributes in reader.all("section")} <= anchors


def test_every_formula_stands_in_the_page_as_its_latex(html: str) -> None:
    sheet = document()
    found = [block for section in sheet.sections for block in blocks_of(section)]
    parts = ((*b.named, *lines([b]), *b.omitted) if isinstance(b, SheetFormula) else lines([b]) for b in found)
    assert [unescape(latex) for latex in re.findall(r"<div class=math>([^<]*)</div>", html)] == [*chain(*parts)]


def test_entries_can_be_copied_as_they_are(reader: Reader) -> None:
    options = [(option["data-latex"], option["data-python"]) for option in reader.all("option")]
    assert options == [(entry.latex, entry.python) for entry in ENTRIES]
    for _, python in options:
        ast.parse(python or "", mode="eval")


def test_the_page_is_the_same_each_time(html: str) -> None:
    assert page(document(), Text()) == html


def test_texts_of_the_page_are_translated() -> None:
    assert "Copia LaTeX" in page(document(), Text("it", {"Copy LaTeX": "Copia LaTeX"}))


def test_a_script_cannot_end_its_element() -> None:
    assert "</script" not in safe_script('var a = "</script><!--";')


def test_the_figure_stands_in_the_page() -> None:
    viewer = Viewer("<div id=arm></div>", "#arm{color:red}", 'var arm = "</script>";')
    html = page(document(), Text(), viewer)
    assert "<div id=arm></div>" in html
    assert "#arm{color:red}" in html
    assert html.count("</script>") == 3


def test_fonts_of_the_formulas_are_inside_and_no_others_are_asked_for() -> None:
    css = formula_style()
    faces = re.findall(r"@font-face{[^}]*}", css)
    assert len(faces) == 13
    assert all("url(data:font/woff2;base64," in face for face in faces)
    assert not re.search(r"url\((?!data:)", css)


@pytest.mark.parametrize(
    ("latex", "name"),
    [
        ("b_{12}", "b₁₂"),
        (r"\dot{\vartheta}_{1}", "ϑ\u0307₁"),
        (r"\mathbf{T}_{4}^{0}", "T₄⁰"),
        (r"c_{ijk}", "cᵢⱼₖ"),
        (r"{}^{0}A_{1}", "⁰A₁"),
        (r"c_{1,23}", "c_1,23"),
    ],
)
def test_names_of_entries_in_plain_letters(latex: str, name: str) -> None:
    assert unicode_name(latex) == name
