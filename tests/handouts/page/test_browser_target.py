"""The target of the figure in Chromium: it is dragged, the arm follows, branches can be chosen, keys work."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from derive.robot.robot import Robot
from tests.handouts.page.test_browser_viewer import Figure, browser

__all__ = ["browser"]

USUAL = ("scara-perugia",)
SWEPT = (
    "planar-2r-perugia",
    "puma560-laschi",
    "stanford-laschi",
    "planar-3r",
    "spherical-arm",
    "kuka-lwr4",
    "thumb",
    "kuka-kr5",
)
MARKS = [pytest.mark.sweep] * 3 + [pytest.mark.release] * (len(SWEPT) - 3)


@pytest.fixture(params=[*USUAL, *(pytest.param(name, marks=mark) for name, mark in zip(SWEPT, MARKS, strict=True))])
def figure(request: pytest.FixtureRequest, browser: Any, tmp_path: Path) -> Iterator[Figure]:
    made = Figure(browser, tmp_path, Robot.load(request.param))
    yield made
    made.close()


def target(figure: Figure) -> np.ndarray:
    return np.array(figure.page.evaluate("deriveViewer.target()"))


def inner(figure: Figure, rng: np.random.Generator) -> np.ndarray:
    low, high = (np.array([getattr(travel, end) for travel in figure.travels]) for end in ("lower", "upper"))
    return low + rng.uniform(0.3, 0.7, len(low)) * (high - low)


def on_screen(figure: Figure) -> tuple[float, float]:
    x, y = figure.page.evaluate("deriveViewer.targetOnCanvas()")
    box = figure.page.locator(".viewer-canvas").bounding_box()
    return box["x"] + (0.5 + 0.5 * x) * box["width"], box["y"] + (0.5 - 0.5 * y) * box["height"]


def test_the_arm_is_where_the_target_is_wherever_it_is_dragged(figure: Figure) -> None:
    rng = np.random.default_rng(6)
    moved = 0
    for _ in range(4):
        figure.set(inner(figure, rng))
        figure.settle()
        before, start = figure.pose(), on_screen(figure)
        figure.page.mouse.move(*start)
        figure.page.mouse.down()
        for step in range(1, 4):
            figure.page.mouse.move(start[0] - 9 * step, start[1] - 5 * step)
            if figure.page.evaluate("deriveViewer.isReached()"):
                moved += bool(np.abs(target(figure) - before[:3, 3]).max() > 1e-3)
                assert np.abs(figure.pose()[:3, 3] - target(figure)).max() <= 1e-9
                assert "viewer-missed" not in figure.page.get_attribute(".viewer-reached", "class")
        figure.page.mouse.up()
    assert moved >= 2


def test_every_branch_that_is_chosen_reaches_the_target(figure: Figure) -> None:
    figure.set(inner(figure, np.random.default_rng(2)))
    wanted = target(figure)
    reached = []
    for value in figure.page.locator(".viewer-branch option").evaluate_all("(all) => all.map((one) => one.value)")[1:]:
        figure.page.locator(".viewer-branch").select_option(value)
        if figure.page.evaluate("deriveViewer.isReached()"):
            assert np.abs(figure.pose()[:3, 3] - wanted).max() <= 1e-9
            name = figure.page.locator(f'.viewer-branch option[value="{value}"]').inner_text()
            assert figure.page.locator(".viewer-reached").inner_text().endswith(name)
            reached.append(figure.page.evaluate("deriveViewer.configuration()"))
    assert len({tuple(np.round(q, 6)) for q in reached}) == len(reached) >= 1


def test_a_target_out_of_reach_is_said_and_leaves_the_arm(figure: Figure) -> None:
    before = figure.transforms()
    assert figure.page.evaluate("deriveViewer.setTarget([90, 80, 70])") is False
    assert np.array_equal(figure.transforms(), before)
    assert "No configuration" in figure.page.locator(".viewer-reached").inner_text()
    figure.page.locator(".viewer-reset").click()
    assert figure.page.evaluate("deriveViewer.isReached()") is True


def test_coordinates_and_arrow_keys_move_the_target(figure: Figure) -> None:
    figure.set(inner(figure, np.random.default_rng(2)))
    field, before = figure.page.locator(".viewer-coordinate").first, target(figure)
    field.focus()
    figure.page.keyboard.press("ArrowDown")
    lower = target(figure)
    assert lower[0] < before[0]
    assert np.abs(lower[1:] - before[1:]).max() <= 1e-12
    field.fill(f"{before[0]:.6f}")
    figure.page.keyboard.press("Tab")
    assert target(figure)[0] == pytest.approx(before[0], abs=1e-6)
    assert np.abs(figure.pose()[:3, 3] - target(figure)).max() <= 1e-9


@pytest.mark.parametrize("robot", ["dh-general-laschi", pytest.param("human-body", marks=pytest.mark.sweep)])
def test_without_a_closed_form_or_a_way_to_go_there_is_no_target(robot: str, browser: Any, tmp_path: Path) -> None:
    figure = Figure(browser, tmp_path, Robot.load(robot))
    assert figure.page.locator(".viewer-target").count() == 0
    assert figure.page.evaluate("deriveViewer.setTarget") is None
    figure.close()


def test_without_webgl_coordinates_still_move_the_arm(browser: Any, tmp_path: Path) -> None:
    figure = Figure(browser, tmp_path, Robot.load("planar-3r"), without_webgl=True)
    figure.set([0.3, 0.8, -0.4])
    wanted = target(figure) * [0.9, 0.9, 1.0]
    assert figure.page.evaluate("(place) => deriveViewer.setTarget(place)", wanted.tolist())
    assert np.abs(figure.pose()[:3, 3] - wanted).max() <= 1e-9
    figure.close()
