"""The plot of a motion."""

import re
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.output import plot
from derive.motion.output.plot import BEYOND, plot_bytes
from tests.motion.plans import PICK_AND_PLACE, swing

pytest.importorskip("matplotlib")


PENDULUM = swing("1", "kp: 30, kd: 8")


@pytest.mark.parametrize(("suffix", "start"), [(".svg", b"<?xml"), (".png", b"\x89PNG"), (".pdf", b"%PDF")])
def test_the_same_motion_gives_the_same_bytes(suffix: str, start: bytes) -> None:
    motion = Motion.from_text(PENDULUM)
    data = plot_bytes(motion, suffix)
    assert data.startswith(start)
    assert data == plot_bytes(motion, suffix)


def words(svg: bytes) -> list[str]:
    """Texts of the figure: matplotlib leaves each in a comment above its outlines."""
    return re.findall(r"<!-- (.+?) -->", svg.decode())


def test_panels_have_units_and_peaks_their_numbers() -> None:
    """But tau4, at most 0.006 N m beside 377 N m, has none."""
    said = words(plot_bytes(Motion.from_text(PICK_AND_PLACE), ".svg"))
    assert {"position [rad]", "speed [m/s]", "torque [N m]", "force [N]", "rest", "B", "D"} <= set(said)
    assert {"376.8", "159.1", "1.25", "0.9817", "1.283", "\N{MINUS SIGN}75.4"} <= set(said)
    assert not [word for word in said if "0.006" in word]


def test_of_a_simulation_the_peaks_are_those_of_what_happens() -> None:
    motion = Motion.from_text(PENDULUM)
    run = motion.simulate()
    largest = max(run.tau[:, 0], key=abs)
    assert "1.875" in words(plot_bytes(motion, ".svg"))
    limited = Motion.from_text(PENDULUM.replace("a: 1}", "a: 1, speed: 1.5}"))
    drawn = plot_bytes(limited, ".svg", run)
    assert f"{largest:.4g}".replace("-", "\N{MINUS SIGN}") in words(drawn)
    assert BEYOND in drawn.decode()


SIX = """\
robot: puma560-corke
points: {a: [0, 0, 0, 0, 0, 0], b: [30, 20, 10, 40, 50, 60], c: [0, 30, -20, 4, 5, 6]}
path: [a, {to: b, time: 1, payload: 2}, {to: c, time: 1}]
control: {law: computed-torque, kp: 100, kd: 20, period: 0.01}
sample: SAMPLE
"""


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    found: list[Any] = []
    monkeypatch.setattr(plot, "figure_bytes", lambda figure, *_: found.append(figure) or b"")
    return found


def numbers(axes: Any) -> list[Any]:
    return [text.get_window_extent() for text in axes.texts if text.get_text()]


@pytest.mark.parametrize(("text", "simulated"), [(SIX, False), (SIX, True), (PICK_AND_PLACE, False)])
@pytest.mark.first(1)
def test_numbers_of_peaks_lie_in_their_panels_and_cover_nothing(figures: list[Any], text: str, simulated: bool) -> None:
    motion = Motion.from_text(text.replace("SAMPLE", "0.02"))
    plot_bytes(motion, ".svg", motion.simulate() if simulated else None)
    figures[0].draw_without_rendering()
    told = 0
    for axes in figures[0].axes:
        boxes, room = numbers(axes), axes.get_window_extent()
        assert all(room.x0 <= box.x0 <= box.x1 <= room.x1 and box.y1 <= room.y1 for box in boxes)
        assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))
        dots = [line for line in axes.get_lines() if line.get_marker() == "o"]
        places = [axes.transData.transform(dot.get_xydata()[0]) for dot in dots]
        assert not any(box.contains(*place) for box in boxes for place in places)
        told += len(boxes)
    assert told >= 7


def test_curves_are_as_fine_where_samples_are_far_apart(figures: list[Any]) -> None:
    for sample in ("0.5", "0.01"):
        motion = Motion.from_text(SIX.replace("SAMPLE", sample))
        plot_bytes(motion, ".svg")
    rare = Motion.from_text(SIX.replace("SAMPLE", "0.5"))
    plot_bytes(rare, ".svg", rare.simulate())
    coarse, fine, simulated = ([line.get_xydata() for line in figure.axes[0].get_lines()] for figure in figures)
    assert all(len(line) > 1000 for line in (*coarse[:6], *simulated[:12]))
    assert all((a == b).all() for a, b in zip(coarse, fine, strict=True))


def test_a_simulation_shows_what_is_wanted_and_the_error(figures: list[Any]) -> None:
    motion = Motion.from_text(SIX.replace("SAMPLE", "0.02"))
    run = motion.simulate()
    plot_bytes(motion, ".svg", run)
    panels = figures[0].axes
    labels = ["position [rad]", "speed [rad/s]", "error [rad]", "torque [N m]"]
    assert [axes.get_ylabel() for axes in panels[:4]] == labels
    dashed = [sum(line.is_dashed() for line in axes.get_lines()) for axes in panels[:4]]
    assert dashed[1:] == [6, 0, 6]
    assert figures[0].legends[0].get_texts()[-1].get_text() == "reference"
    drawn = next(line for line in panels[2].get_lines() if line.get_gid() == "joint-02")
    assert np.interp(run.t, *drawn.get_xydata().T) == pytest.approx((run.q - motion(run.t)[0])[:, 1], abs=1e-12)


def test_a_constant_curve_has_no_peak(figures: list[Any]) -> None:
    """Tx goes at 0.3 m/s all the time; a joint that hangs needs its torque all the time."""
    plot_bytes(Motion.load("skeleton-reach"), ".svg")
    told = {text.get_text() for text in figures[0].axes[3].texts}
    assert told == {"\N{MINUS SIGN}0.06283"}
    labels = [axes.get_ylabel() for axes in figures[0].axes]
    assert "acceleration [m/s$^2$]" in labels
    assert not any("torque" in label or "force" in label for label in labels), "an arm without links"
    still = Motion.from_text(PENDULUM.replace("b: [1]", "b: [0]"))
    plot_bytes(still, ".svg")
    assert not any(text.get_text() for axes in figures[1].axes for text in axes.texts)


@pytest.mark.sweep
def test_limits_and_what_is_beyond_them_are_drawn() -> None:
    """A speed of 1.875 rad/s at most: a limit of 1.5 is exceeded, one of 2 is near enough, one of 9 is not."""
    plain, exceeded, near, far = (
        plot_bytes(Motion.from_text(PENDULUM.replace("a: 1}", f"a: 1{limit}}}")), ".svg").decode()
        for limit in ("", ", speed: 1.5", ", speed: 2", ", speed: 9")
    )
    assert BEYOND in exceeded
    assert BEYOND not in near
    assert near != plain
    assert far == plain
