"""The web page in a browser: it works from disk, alone, for everybody, and looks as KaTeX draws it."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from derive.handout.language import Text
from derive.handout.page.compact import compact, parse
from derive.handout.page.katex import Mathematics, asset, render
from derive.handout.page.stylesheet import known_classes, names, stylesheet, write
from derive.handout.page.writer import page
from tests.handout.page.page_documents import ENTRIES, LONG, MATRIX, document

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page

THEMES = ("light", "dark")
BAD = ("error", "warning")
FORMULAS = (
    MATRIX,
    LONG,
    r"\dot{q}_{1}^{2} + \ddot{\vartheta}_{2} = \frac{1}{2}m_{1}\dot{\mathbf{q}}^{\mathsf{T}}\mathbf{B}\dot{\mathbf{q}}",
    r"\sum_{i=1}^{n} x_i^{2} + \sqrt{a_1^2 + a_2^2} + \operatorname{atan2}(r_{11}, \pm\sqrt{r_{13}^2}) + {}^{0}\!A_1",
    r"\begin{cases} a & b > 0 \\ c & d \end{cases}\quad\left(\frac{1}{2}\right)^2\,\hat{z}_{i-1}\times\vec{p}",
)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    chromium = shutil.which("chromium")
    if os.environ.get("DERIVE_REQUIRE_CHROMIUM") != "1":
        pytest.importorskip("py_mini_racer")
        pytest.importorskip("playwright.sync_api")
        if chromium is None:
            pytest.skip("chromium is not installed")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as engine:
        opened = engine.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def file(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "hostile.html"
    path.write_text(page(document(), Text()), encoding="utf-8")
    return path


@pytest.fixture(params=THEMES)
def context(browser: Browser, request: pytest.FixtureRequest) -> Iterator[BrowserContext]:
    opened = browser.new_context(color_scheme=request.param, viewport={"width": 1280, "height": 900})
    yield opened
    opened.close()


@pytest.fixture
def troubles() -> list[str]:
    return []


@pytest.fixture
def view(context: BrowserContext, file: Path, troubles: list[str]) -> Page:
    opened = context.new_page()
    opened.on(
        "console", lambda message: troubles.append(message.text) if message.type in ("error", "warning") else None
    )
    opened.on("pageerror", lambda error: troubles.append(str(error)))
    opened.on("dialog", lambda dialog: troubles.append(dialog.message))
    opened.on("request", lambda request: troubles.append(request.url) if request.url != file.as_uri() else None)
    opened.goto(file.as_uri())
    opened.evaluate("document.fonts.ready.then(() => true)")
    return opened


def paper(view: Page) -> str:
    return str(view.evaluate("getComputedStyle(document.body).backgroundColor"))


def test_the_page_needs_no_network_and_makes_no_error(view: Page, troubles: list[str]) -> None:
    view.wait_for_timeout(300)
    assert [url for url in troubles if not url.startswith("data:")] == []


def test_no_serious_violation_of_accessibility(view: Page) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    view.click("#steps")
    assert serious(axe.run(view).response) == []
    view.click("#theme")
    assert serious(axe.run(view).response) == []


def serious(response: dict[str, Any]) -> list[str]:
    return [
        f"{found['id']}: {node['html'][:120]}"
        for found in response["violations"]
        if found["impact"] in ("serious", "critical")
        for node in found["nodes"]
    ]


@pytest.mark.parametrize("allowed", [True, False])
def test_entries_are_copied(view: Page, context: BrowserContext, allowed: bool) -> None:
    """By the clipboard of the browser, and where there is none by a selection."""
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    if not allowed:
        view.evaluate("Object.defineProperty(navigator.clipboard, 'writeText', {value: () => Promise.reject()})")
    for index, entry in enumerate(ENTRIES):
        view.locator(".tools select").first.select_option(index=index)
        for kind, wanted in (("latex", entry.latex), ("python", entry.python)):
            view.evaluate("document.getElementById('message').textContent = ''")
            view.locator(f"[data-copy={kind}]").first.click()
            view.locator("#message:not(:empty)").wait_for()
            assert view.evaluate("navigator.clipboard.readText()") == wanted


def test_light_and_dark_change_places(view: Page) -> None:
    before = paper(view)
    view.click("#theme")
    assert paper(view) != before
    view.click("#theme")
    assert paper(view) == before


def test_steps_open_and_close(view: Page) -> None:
    inner = view.locator("main details .display").first
    assert not inner.is_visible()
    view.locator("main summary").first.click()
    assert inner.is_visible()
    view.click("#steps")
    assert not inner.is_visible()


def test_wide_formulas_scroll_and_the_page_does_not(view: Page) -> None:
    view.set_viewport_size({"width": 390, "height": 800})
    view.wait_for_timeout(100)
    assert view.evaluate("document.documentElement.scrollWidth <= innerWidth")
    stops = view.evaluate(
        "[...document.querySelectorAll('.display[tabindex]')].map(e => e.scrollWidth > e.clientWidth)"
    )
    assert stops
    assert all(stops)


def test_print_shows_the_steps_and_no_buttons(view: Page) -> None:
    view.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    view.emulate_media(media="print")
    assert view.locator("main details .display").first.is_visible()
    assert not view.locator("button").first.is_visible()
    assert paper(view) == "rgb(255, 255, 255)"


def test_compaction_moves_no_letter(browser: Browser, tmp_path: Path) -> None:
    """Where KaTeX puts each letter, half a pixel either way."""
    rendered = render(Mathematics(latex, True) for latex in FORMULAS)
    trees = [compact(parse(both.html), known_classes(), display=True) for both in rendered.values()]
    given = names(trees)
    raw = letters(browser, tmp_path / "raw.html", katex_css(), [both.html for both in rendered.values()])
    small = letters(browser, tmp_path / "small.html", stylesheet(given), [write(tree, given) for tree in trees])
    assert [letter[0] for letter in raw] == [letter[0] for letter in small]
    assert (
        max(
            abs(a - b)
            for before, after in zip(raw, small, strict=True)
            for a, b in zip(before[1:], after[1:], strict=True)
        )
        <= 0.5
    )


def katex_css() -> str:
    return asset("katex.min.css").read_text(encoding="utf-8").replace("fonts/", f"{Path(str(asset(''))).as_uri()}/")


def letters(browser: Browser, path: Path, css: str, formulas: list[str]) -> list[list[Any]]:
    """Every letter with the left edge and the baseline's neighbour, its lower edge [px]."""
    style = f"<style>{css}body{{width:2400px}}</style>"
    path.write_text(f"<!DOCTYPE html><meta charset=utf-8>{style}{''.join(formulas)}", encoding="utf-8")
    view = browser.new_page(viewport={"width": 2500, "height": 900})
    view.goto(path.as_uri())
    view.evaluate("document.fonts.ready.then(() => true)")
    script = """() => {
      const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), found = [];
      for (let node = walker.nextNode(); node; node = walker.nextNode())
        for (let k = 0; k < node.data.length; k++) {
          if (node.data[k] === "\\u200b") continue;
          const range = document.createRange();
          range.setStart(node, k); range.setEnd(node, k + 1);
          const box = range.getBoundingClientRect();
          found.push([node.data[k], box.left, box.bottom]);
        }
      return found;
    }"""
    found: list[list[Any]] = view.evaluate(script)
    view.close()
    return found
