"""The figure in Chromium: sliders and the dragged target move the arm, and it shows the pose of the NumPy model."""

import io
import json
import math
import os
import shutil
from collections.abc import Iterator
from functools import cache
from itertools import combinations
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from PIL import Image

from derive.handouts.page.viewer import symbol_values, travels
from derive.robot.robot import Robot
from tests.handouts.page.page_documents import assumed, viewer_page
from tests.random_robots import swept
from tests.rows import robot_of_rows
from tests.targets.generated_models import numpy_model

pytestmark = pytest.mark.first(1)

ROBOTS = ("scara-perugia", "puma560-laschi", "stanford-laschi")
SAMPLES = 20
FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader"]
FOLDING = robot_of_rows(
    "R d: 0.4, limits: [-pi/2, 1] | P alpha: -pi/2, limits: [0.2, 0.7] | R alpha: pi/2, a: a2, d: -0.1",
    "gravity: [0, -9.81, 0]\nbase: [[1, 0, 0, 0.1], [0, 0, 1, 0], [0, -1, 0, 0.2], [0, 0, 0, 1]]",
    convention="modified",
)


def chromium() -> str:
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        if os.environ.get("DERIVE_REQUIRE_CHROMIUM") == "1":
            pytest.fail("Chromium is not installed")
        pytest.skip("Chromium is not installed")
    return found


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    api = pytest.importorskip("playwright.sync_api")
    with api.sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
        yield launched
        launched.close()


def watched(page: Any, path: Path) -> list[str]:
    """What a page does that it must not, as it comes: writing to the console, failing, dialogs, asking for files."""
    trouble: list[str] = []

    def _note(url: str) -> None:
        if url != path.as_uri() and not url.startswith("data:"):
            trouble.append(f"request: {url}")

    page.on("console", lambda message: trouble.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: trouble.append(str(error)))
    page.on("dialog", lambda dialog: trouble.append(dialog.message))
    page.on("request", lambda request: _note(request.url))
    page.goto(path.as_uri())
    return trouble


def serious(page: Any) -> list[str]:
    """What axe finds that shuts people out."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    found = [v for v in axe.run(page).response["violations"] if v["impact"] in ("serious", "critical")]
    return [f"{v['id']}: {node['html'][:120]}" for v in found for node in v["nodes"]]


class Figure:
    def __init__(self, browser: Any, folder: Path, robot: Robot, theme: str = "", without_webgl: bool = False) -> None:
        self.robot = robot
        self.values = symbol_values(robot, (), assumed(robot))
        self.travels = travels(robot, self.values)
        path = folder / "viewer.html"
        path.write_text(viewer_page(robot, theme=theme), encoding="utf-8")
        self.page = browser.new_page(viewport={"width": 1000, "height": 700})
        if without_webgl:
            self.page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null;")
        self.trouble = watched(self.page, path)
        self.settle()

    def settle(self) -> None:
        self.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def close(self) -> None:
        self.page.close()
        assert self.trouble == []

    def set(self, q: Any) -> list[float]:
        return list(self.page.evaluate("q => window.deriveViewer.setConfiguration(q)", list(map(float, q))))

    def pose(self) -> np.ndarray:
        return np.array(json.loads(self.page.get_attribute(".viewer-pose", "data-pose")))

    def transforms(self) -> np.ndarray:
        return np.array(self.page.evaluate("() => window.deriveViewer.linkTransforms()"))

    def picture(self) -> bytes:
        self.settle()
        return bytes(self.page.locator(".viewer-stage").screenshot())

    def steady_picture(self) -> bytes:
        """The picture once fonts are there and nothing moves any more: a busy machine draws late."""
        self.page.evaluate("document.fonts.ready.then(() => true)")
        before, now, rest = b"", self.picture(), 0
        for _ in range(100):
            rest = rest + 1 if before and is_same_picture(now, before) else 0
            if rest == 3:
                break
            self.page.wait_for_timeout(100)
            before, now = now, self.picture()
        return now

    def params(self, model: ModuleType) -> dict[str, float]:
        return {name: self.values.get(name, 1.0) for name in model.PARAMETERS}


def is_same_picture(one: bytes, other: bytes) -> bool:
    """Whether two pictures differ by rounding alone, in the last bits of their colours."""
    first, second = (np.asarray(Image.open(io.BytesIO(png)), dtype=int) for png in (one, other))
    return bool(np.abs(first - second).max() <= 2)


@cache
def opened(browser: Any, folder: Path, name: str) -> Figure:
    """Tests share pages: to open one takes a second."""
    robot = FOLDING if name == "folding" else Robot.load(name)
    (folder / name).mkdir()
    return Figure(browser, folder / name, robot)


def shared(request: pytest.FixtureRequest, browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Figure]:
    made = opened(browser, tmp_path_factory.getbasetemp(), request.param)
    made.page.locator(".viewer-reset").click()
    yield made
    assert made.trouble == []


figure = pytest.fixture(params=[ROBOTS[0], "folding", *swept(*ROBOTS[1:])])(shared)


def test_the_pose_is_that_of_the_numpy_model(figure: Figure) -> None:
    model = numpy_model(figure.robot)
    rng = np.random.default_rng(4)
    low, high = ([getattr(travel, end) for travel in figure.travels] for end in ("lower", "upper"))
    for q in rng.uniform(low, high, (SAMPLES, figure.robot.n)):
        assert figure.set(q) == q.tolist()
        wanted = model.forward_kinematics(q, params=figure.params(model))
        assert np.abs(figure.pose() - wanted).max() <= 1e-9
        frames = model.link_transforms(q, params=figure.params(model))
        assert np.abs(figure.transforms() - frames).max() <= 1e-9
        shown = [
            text.replace("\N{MINUS SIGN}", "-") for text in figure.page.locator(".viewer-pose td").all_inner_texts()
        ]
        assert np.array(shown, dtype=float) == pytest.approx(wanted.ravel(), abs=5.1e-5)


def test_every_slider_moves_the_arm(figure: Figure) -> None:
    for i, travel in enumerate(figure.travels):
        frames, picture = figure.transforms(), figure.picture()
        value = travel.shown(0.75 * travel.upper + 0.25 * travel.lower)
        slider = figure.page.locator(".viewer-range").nth(i)
        slider.evaluate("(e, v) => { e.value = v; e.dispatchEvent(new Event('input', {bubbles: true})); }", value)
        moved = figure.transforms()
        assert np.abs(moved[i] - frames[i]).max() > 1e-3
        assert np.abs(moved[:i] - frames[:i]).max(initial=0) <= 1e-12
        assert figure.picture() != picture


def test_limits_are_respected(figure: Figure) -> None:
    lower = [travel.lower for travel in figure.travels]
    upper = [travel.upper for travel in figure.travels]
    assert figure.set([-1e6] * figure.robot.n) == lower
    assert figure.set([1e6] * figure.robot.n) == upper
    for i, travel in enumerate(figure.travels):
        slider = figure.page.locator(".viewer-range").nth(i)
        for end in ("lower", "upper"):
            assert float(slider.get_attribute({"lower": "min", "upper": "max"}[end])) == pytest.approx(
                travel.shown(getattr(travel, end)), rel=1e-11
            )
        if (limits := figure.robot.joints[i].limits) is None and travel.revolute:
            assert (travel.lower, travel.upper) == (-math.pi, math.pi)
        elif limits is None:
            assert travel.lower == 0 < travel.upper


def test_keys_numbers_and_the_reset_button_work(figure: Figure) -> None:
    start = [travel.start for travel in figure.travels]
    page = figure.page
    frames = figure.transforms()
    page.locator(".viewer-range").first.focus()
    page.keyboard.press("ArrowRight")
    assert page.evaluate("deriveViewer.configuration()")[0] > start[0]
    page.locator(".viewer-number").nth(1).fill("0.3")
    page.keyboard.press("Tab")
    wanted = math.radians(0.3) if figure.travels[1].revolute else 0.3
    assert page.evaluate("deriveViewer.configuration()")[1] == pytest.approx(wanted, abs=1e-12)
    page.locator(".viewer-number").nth(1).fill("")
    page.keyboard.press("Tab")
    assert page.evaluate("deriveViewer.configuration()")[1] == pytest.approx(wanted, abs=1e-12)
    page.locator(".viewer-reset").click()
    assert page.evaluate("deriveViewer.configuration()") == start
    assert np.array_equal(figure.transforms(), frames)


@pytest.mark.sweep
def test_the_view_turns_by_mouse_and_keys_and_returns(figure: Figure) -> None:
    page = figure.page
    page.reload()
    assert page.evaluate("deriveViewer.configuration()") == [travel.start for travel in figure.travels]
    home = figure.steady_picture()
    box = page.locator(".viewer-canvas").bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 320, box["y"] + 230, steps=4)
    page.mouse.up()
    turned = figure.picture()
    assert turned != home
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("+")
    assert figure.picture() != turned
    page.locator(".viewer-home").click()
    page.locator(".viewer-names").uncheck()
    page.locator(".viewer-names").check()
    page.evaluate("document.activeElement.blur()")
    page.mouse.move(5, 5)
    assert is_same_picture(figure.steady_picture(), home)


def test_frames_and_labels_can_be_hidden(figure: Figure) -> None:
    with_frames = figure.picture()
    figure.page.locator(".viewer-frames").uncheck()
    without_frames = figure.picture()
    figure.page.locator(".viewer-names").uncheck()
    assert len({with_frames, without_frames, figure.picture()}) == 3
    for box in (".viewer-frames", ".viewer-names"):
        figure.page.locator(box).check()


@pytest.mark.sweep
@pytest.mark.parametrize(("name", "width"), [("kuka-kr5", 1000), ("scara-perugia", 400)])
def test_no_posture_leaves_the_picture_and_no_names_cover_each_other(
    name: str, width: int, browser: Any, tmp_path: Path
) -> None:
    figure = Figure(browser, tmp_path, Robot.load(name))
    figure.page.set_viewport_size({"width": width, "height": 700})
    figure.settle()
    rng = np.random.default_rng(2)
    low, high = ([getattr(travel, end) for travel in figure.travels] for end in ("lower", "upper"))
    postures = [low, high, *rng.uniform(low, high, (8, figure.robot.n))]
    shared = 0.0
    for q in postures:
        figure.set(q)
        figure.settle()
        assert np.abs(np.array(figure.page.evaluate("deriveViewer.onCanvas()"))[:, :2]).max() <= 1.0
        names = figure.page.evaluate(BOXES)
        stage = names.pop()
        for box in names:
            assert stage["left"] - 1 <= box["left"] <= box["right"] <= stage["right"] + 1
            assert stage["top"] - 1 <= box["top"] <= box["bottom"] <= stage["bottom"] + 1
        areas = [(box["right"] - box["left"]) * (box["bottom"] - box["top"]) for box in names]
        shared += sum(overlap(a, b) for a, b in combinations(names, 2)) / sum(areas)
    assert shared / len(postures) <= 0.01
    figure.close()


BOXES = """() => [...document.querySelectorAll(".viewer-labels span"), document.querySelector(".viewer-stage")]
  .map((element) => element.getBoundingClientRect().toJSON())"""


def overlap(a: dict[str, float], b: dict[str, float]) -> float:
    wide = min(a["right"], b["right"]) - max(a["left"], b["left"])
    tall = min(a["bottom"], b["bottom"]) - max(a["top"], b["top"])
    return max(0.0, wide) * max(0.0, tall)


def test_the_matrix_stands_in_brackets(figure: Figure) -> None:
    sides = figure.page.evaluate(
        """() => ["::before", "::after"].map((side) => {
          const style = getComputedStyle(document.querySelector(".viewer-pose table"), side);
          return ["top", "right", "bottom", "left"].map((edge) => parseFloat(style[`border-${edge}-width`]) > 0);
        })"""
    )
    assert sides == [[True, False, True, True], [True, True, True, False]]


def test_dark_pages_get_a_dark_figure(browser: Any, tmp_path: Path) -> None:
    figure = Figure(browser, tmp_path, Robot.load("planar-2r-perugia"), theme="dark")
    dark = figure.picture()
    figure.page.evaluate("document.documentElement.dataset.theme = 'light'")
    assert figure.picture() != dark
    figure.close()


def test_without_webgl_sliders_pose_and_coordinates_still_work(browser: Any, tmp_path: Path) -> None:
    figure = Figure(browser, tmp_path, Robot.load("planar-3r"), without_webgl=True)
    assert figure.page.locator(".viewer-message").is_visible()
    before = figure.pose()
    figure.page.locator(".viewer-range").first.focus()
    figure.page.keyboard.press("ArrowRight")
    assert np.abs(figure.pose() - before).max() > 1e-3
    figure.set([0.3, 0.8, -0.4])
    wanted = target(figure) * [0.9, 0.9, 1.0]
    assert figure.page.evaluate("(place) => deriveViewer.setTarget(place)", wanted.tolist())
    assert np.abs(figure.pose()[:3, 3] - wanted).max() <= 1e-9
    figure.close()


def test_the_figure_is_accessible(figure: Figure) -> None:
    assert serious(figure.page) == []


SWEPT = swept("planar-2r-perugia", "puma560-laschi", "stanford-laschi")
OTHERS = ("planar-3r", "spherical-arm", "kuka-lwr4", "thumb", "kuka-kr5")
BEFORE_RELEASE = [pytest.param(name, marks=pytest.mark.release) for name in OTHERS]
dragged = pytest.fixture(params=["scara-perugia", *SWEPT, *BEFORE_RELEASE])(shared)


def target(figure: Figure) -> np.ndarray:
    return np.array(figure.page.evaluate("deriveViewer.target()"))


def inner(figure: Figure, rng: np.random.Generator) -> np.ndarray:
    low, high = (np.array([getattr(travel, end) for travel in figure.travels]) for end in ("lower", "upper"))
    return low + rng.uniform(0.3, 0.7, len(low)) * (high - low)


def on_screen(figure: Figure) -> tuple[float, float]:
    x, y = figure.page.evaluate("deriveViewer.targetOnCanvas()")
    box = figure.page.locator(".viewer-canvas").bounding_box()
    return box["x"] + (0.5 + 0.5 * x) * box["width"], box["y"] + (0.5 - 0.5 * y) * box["height"]


def test_the_arm_is_where_the_target_is_wherever_it_is_dragged(dragged: Figure) -> None:
    rng = np.random.default_rng(6)
    moved = 0
    for _ in range(4):
        dragged.set(inner(dragged, rng))
        dragged.settle()
        before, start = dragged.pose(), on_screen(dragged)
        dragged.page.mouse.move(*start)
        dragged.page.mouse.down()
        for step in range(1, 4):
            dragged.page.mouse.move(start[0] - 9 * step, start[1] - 5 * step)
            if dragged.page.evaluate("deriveViewer.isReached()"):
                moved += bool(np.abs(target(dragged) - before[:3, 3]).max() > 1e-3)
                assert np.abs(dragged.pose()[:3, 3] - target(dragged)).max() <= 1e-9
                assert "viewer-missed" not in dragged.page.get_attribute(".viewer-reached", "class")
        dragged.page.mouse.up()
    assert moved >= 2


def test_every_branch_that_is_chosen_reaches_the_target(dragged: Figure) -> None:
    dragged.set(inner(dragged, np.random.default_rng(2)))
    wanted = target(dragged)
    reached = []
    for value in dragged.page.locator(".viewer-branch option").evaluate_all("(all) => all.map((one) => one.value)")[1:]:
        dragged.page.locator(".viewer-branch").select_option(value)
        if dragged.page.evaluate("deriveViewer.isReached()"):
            assert np.abs(dragged.pose()[:3, 3] - wanted).max() <= 1e-9
            name = dragged.page.locator(f'.viewer-branch option[value="{value}"]').inner_text()
            assert dragged.page.locator(".viewer-reached").inner_text().endswith(name)
            reached.append(dragged.page.evaluate("deriveViewer.configuration()"))
    assert len({tuple(np.round(q, 6)) for q in reached}) == len(reached) >= 1


def test_a_target_out_of_reach_is_said_and_leaves_the_arm(dragged: Figure) -> None:
    before = dragged.transforms()
    assert dragged.page.evaluate("deriveViewer.setTarget([90, 80, 70])") is False
    assert np.array_equal(dragged.transforms(), before)
    assert "No configuration" in dragged.page.locator(".viewer-reached").inner_text()
    dragged.page.locator(".viewer-reset").click()
    assert dragged.page.evaluate("deriveViewer.isReached()") is True


def test_coordinates_and_arrow_keys_move_the_target(dragged: Figure) -> None:
    dragged.set(inner(dragged, np.random.default_rng(2)))
    field, before = dragged.page.locator(".viewer-coordinate").first, target(dragged)
    field.focus()
    dragged.page.keyboard.press("ArrowDown")
    lower = target(dragged)
    assert lower[0] < before[0]
    assert np.abs(lower[1:] - before[1:]).max() <= 1e-12
    field.fill(f"{before[0]:.6f}")
    dragged.page.keyboard.press("Tab")
    assert target(dragged)[0] == pytest.approx(before[0], abs=1e-6)
    assert np.abs(dragged.pose()[:3, 3] - target(dragged)).max() <= 1e-9


@pytest.mark.parametrize("robot", ["dh-general-laschi", pytest.param("human-body", marks=pytest.mark.sweep)])
def test_without_a_closed_form_or_a_way_to_go_there_is_no_target(robot: str, browser: Any, tmp_path: Path) -> None:
    figure = Figure(browser, tmp_path, Robot.load(robot))
    assert figure.page.locator(".viewer-target").count() == 0
    assert figure.page.evaluate("deriveViewer.setTarget") is None
    figure.close()
