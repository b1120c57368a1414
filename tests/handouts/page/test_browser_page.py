"""The web page in a browser: it works from disk, alone, for everybody, and KaTeX sets every formula."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from derive.handouts.assemble import context_of
from derive.handouts.assemble import document as handout
from derive.handouts.page.writer import page
from derive.handouts.sheet.document import Paragraph, Rows, Section
from derive.handouts.sheet.language import Text
from derive.robot.options.handout import Derivation
from derive.robot.robot import Robot
from tests.handouts.page.page_documents import ENTRIES, LONG, MATRIX, document
from tests.handouts.page.test_browser_viewer import browser, serious, watched

__all__ = ["browser"]

pytestmark = pytest.mark.first(1)

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page

THEMES = ("light", "dark")
FORMULAS = (
    MATRIX,
    LONG,
    r"\dot{q}_{1}^{2} + \ddot{\vartheta}_{2} = \frac{1}{2}m_{1}\dot{\mathbf{q}}^{\mathsf{T}}\mathbf{B}\dot{\mathbf{q}}",
    r"\sum_{i=1}^{n} x_i^{2} + \sqrt{a_1^2 + a_2^2} + \operatorname{atan2}(r_{11}, \pm\sqrt{r_{13}^2}) + {}^{0}\!A_1",
    r"\begin{cases} a & b > 0 \\ c & d \end{cases}\quad\left(\frac{1}{2}\right)^2\,\hat{z}_{i-1}\times\vec{p}",
)


@pytest.fixture(scope="module")
def file(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "hostile.html"
    path.write_text(page(document(*far()), Text()), encoding="utf-8")
    return path


def far() -> tuple[Section, Section]:
    many = tuple(Paragraph("Nothing.") for _ in range(100))
    return Section("between", "Between", (*many, Rows(FORMULAS))), Section("far", "Far", (Rows(FORMULAS), *many))


@pytest.fixture(params=THEMES)
def context(browser: Browser, request: pytest.FixtureRequest) -> Iterator[BrowserContext]:
    opened = browser.new_context(color_scheme=request.param, viewport={"width": 1280, "height": 900})
    yield opened
    opened.close()


@pytest.fixture
def view(context: BrowserContext, file: Path) -> Page:
    opened = context.new_page()
    opened.goto(file.as_uri())
    opened.evaluate("document.fonts.ready.then(() => true)")
    return opened


def paper(view: Page) -> str:
    return str(view.evaluate("getComputedStyle(document.body).backgroundColor"))


def test_the_page_needs_no_network_and_makes_no_error(context: BrowserContext, file: Path) -> None:
    opened = context.new_page()
    trouble = watched(opened, file)
    opened.wait_for_timeout(300)
    assert trouble == []


def test_no_serious_violation_of_accessibility(view: Page) -> None:
    view.click("#steps")
    assert serious(view) == []
    view.click("#theme")
    assert serious(view) == []


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


def test_light_and_dark_change_places_and_steps_open_and_close(view: Page) -> None:
    before = paper(view)
    view.click("#theme")
    assert paper(view) != before
    view.click("#theme")
    assert paper(view) == before
    inner = view.locator("main details .display").first
    assert not inner.is_visible()
    view.locator("main summary").first.click()
    assert inner.is_visible()
    view.click("#steps")
    assert not inner.is_visible()


def test_wide_formulas_scroll_and_the_page_does_not(view: Page) -> None:
    view.set_viewport_size({"width": 390, "height": 800})
    view.evaluate("window.dispatchEvent(new Event('beforeprint'))")  # every formula is set, not only those in sight
    view.wait_for_function("document.documentElement.scrollWidth <= innerWidth")
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


def test_formulas_are_set_where_the_reader_is_and_all_of_them_for_print(view: Page) -> None:
    first, last = view.locator("#inertia .math").first, view.locator("#far .math").last
    assert "set" in (first.get_attribute("class") or "")
    assert "set" not in (last.get_attribute("class") or "")
    assert last.inner_text() == FORMULAS[-1]
    last.scroll_into_view_if_needed()
    view.locator("#far .math.set").last.wait_for()
    view.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert view.locator(".math:not(.set)").count() == 0
    assert view.locator(".math .katex math").count() == view.locator(".math").count()


def test_a_link_leads_to_its_section(view: Page) -> None:
    view.click("nav a[href='#far']")
    view.locator("#far .math.set").first.wait_for(state="attached")
    view.wait_for_function("Math.abs(document.getElementById('far').getBoundingClientRect().top) < 40")


def test_formulas_are_readable_without_scripts(browser: Browser, file: Path) -> None:
    context = browser.new_context(java_script_enabled=False)
    view = context.new_page()
    view.goto(file.as_uri())
    assert view.locator("#inertia .display .math").nth(1).inner_text() == MATRIX
    assert not view.locator("button").first.is_visible()
    context.close()


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["scara-perugia", "stanford-deluca", "thumb", "dh-modified-deluca"])
def test_katex_understands_every_formula_of_a_handout(browser: Browser, tmp_path: Path, name: str) -> None:
    robot = Robot.load(name)
    context = context_of(robot, replace(robot.handout, derivation=Derivation.STEPS))
    path = tmp_path / "page.html"
    path.write_text(page(handout(context), context.text), encoding="utf-8")
    view = browser.new_page()
    view.goto(path.as_uri())
    view.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert view.locator(".katex-error").all_inner_texts() == []
    assert view.locator(".math").count() == view.locator(".math.set").count() > 20
    view.close()


def test_a_formula_that_scrolls_has_a_shadow_where_there_is_more(browser: Browser, file: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    opened = browser.new_page(viewport={"width": 390, "height": 800}, color_scheme="light")
    opened.goto(file.as_uri())
    opened.evaluate("document.fonts.ready.then(() => true)")
    find = "() => [...document.querySelectorAll('.display')].find((box) => box.scrollWidth > box.clientWidth + 200)"
    wide = opened.evaluate_handle(find).as_element()
    wide.scroll_into_view_if_needed()

    def dark_edges(share: float) -> list[bool]:
        opened.evaluate(
            "([box, share]) => { box.scrollLeft = share * (box.scrollWidth - box.clientWidth); }", [wide, share]
        )
        picture = image.open(BytesIO(wide.screenshot())).convert("L")
        edges = [picture.crop((x, 0, x + 1, 3)) for x in (0, picture.width - 1)]
        return [255 - edge.getextrema()[1] > 40 for edge in edges]

    for share, expected in ((0.0, [False, True]), (0.5, [True, True]), (1.0, [True, False])):
        tries = 0
        while dark_edges(share) != expected and tries < 50:  # a busy machine sets formulas and draws late
            opened.wait_for_timeout(100)
            tries += 1
        assert dark_edges(share) == expected
    opened.close()
