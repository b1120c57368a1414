"""The plot of a motion."""

from __future__ import annotations

import re

import pytest

from derive.motion.motion import Motion
from derive.motion.plot import BEYOND, plot_bytes
from tests.motion.plans import PICK_AND_PLACE

pytest.importorskip("matplotlib")


PENDULUM = """\
robot: {name: p, convention: standard, gravity: [0, -9.81, 0], joints: [{type: revolute, a: 1}], links: [{mass: 1}]}
points: {a: [0], b: [1]}
path: [a, {to: b, time: 1}]
control: {law: pd, kp: 30, kd: 8}
"""


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


def test_an_arm_without_links_has_no_torques() -> None:
    said = words(plot_bytes(Motion.load("skeleton-reach"), ".svg"))
    assert "acceleration [m/s$^2$]" in said
    assert not [word for word in said if "torque" in word or "force" in word]


def test_of_a_simulation_the_peaks_are_those_of_what_happens() -> None:
    motion = Motion.from_text(PENDULUM)
    run = motion.simulate()
    largest = max(run.tau[:, 0], key=abs)
    assert "1.875" in words(plot_bytes(motion, ".svg"))
    limited = Motion.from_text(PENDULUM.replace("a: 1}", "a: 1, speed: 1.5}"))
    drawn = plot_bytes(limited, ".svg", run)
    assert f"{largest:.4g}".replace("-", "\N{MINUS SIGN}") in words(drawn)
    assert BEYOND in drawn.decode()


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
