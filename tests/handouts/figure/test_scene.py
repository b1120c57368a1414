"""Drawings of arms: where things stand, what they are called, and that any robot can be drawn."""

import random

import numpy as np
import pytest

from derive.handouts.figure.arm import HEIGHT, WIDTH, arm_drawing, arm_view
from derive.handouts.figure.drawing import Drawing, Label, Path
from derive.handouts.figure.paper import AXIS_COLORS
from derive.handouts.figure.scene import arm_scene
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter
from derive.robot.load import catalogue_names
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import chain_frames, forward_kinematics, numeric_arm
from derive.workspace.poses import RobotPoses
from tests.random_robots import robot_text


def _draw(robot: Robot, q: list[float] | None = None) -> Drawing:
    poses = RobotPoses(robot)
    return arm_drawing(robot, DataPrinter(robot, Notation.of(robot)), poses.frames(q or poses.zero), "an arm")


def _points(drawing: Drawing) -> np.ndarray:
    return np.array([p for item in drawing.items for p in (item.points if isinstance(item, Path) else (item.at,))])


def _labels(drawing: Drawing) -> set[str]:
    return {part for item in drawing.items if isinstance(item, Label) for part in item.latex.split(",")}


def _random_robots() -> list[Robot]:
    rng = random.Random(4)
    return [Robot.from_text(robot_text(rng, 1 + k % 7)) for k in range(20)]


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "stanford-deluca", "dh-modified-deluca"])
def test_poses_are_the_frames_of_the_independent_recursion(name: str) -> None:
    robot = Robot.load(name)
    poses = RobotPoses(robot)
    q = np.linspace(0.3, 0.9, robot.n)
    unknown = dict.fromkeys(free_symbols(robot), 1.0)
    arm = numeric_arm(robot, unknown | {name: value for name, value, _ in poses.assumed})
    frames = np.array(poses.frames(q.tolist()))
    np.testing.assert_allclose(frames[:-1], arm.base @ chain_frames(arm, q), atol=1e-12)
    np.testing.assert_allclose(frames[-1], forward_kinematics(arm, q), atol=1e-12)


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "spherical-arm", "dh-modified-deluca"])
def test_axes_start_at_the_projected_origins_of_the_frames(name: str) -> None:
    robot = Robot.load(name)
    poses = RobotPoses(robot)
    q = [0.4] * robot.n
    frames = np.array(poses.frames(q))
    view = arm_view(arm_scene(robot, frames))
    expected = view.project(frames[: robot.n + 1, :3, 3])[:, :2]
    starts = np.array(
        [i.points[0] for i in _draw(robot, q).items if isinstance(i, Path) and i.stroke in AXIS_COLORS and not i.fill]
    )
    spread = np.ptp(starts, axis=0)
    scale = float(spread.max() / np.ptp(expected, axis=0)[int(spread.argmax())])
    placed = (expected - expected.min(axis=0)) * scale + starts.min(axis=0)
    for point in placed:
        assert np.abs(starts - point).max(axis=1).min() < 0.05


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "planar-2r-perugia", "human-body"])
def test_every_frame_has_its_x_and_z_named(name: str) -> None:
    robot = Robot.load(name)
    labels = _labels(_draw(robot))
    for index in range(robot.n + 1):
        assert {f"x_{{{index}}}", f"z_{{{index}}}"} <= labels


def test_lengths_are_named_where_they_are_not_zero() -> None:
    assert {"a_{1}", "a_{2}", "d_{4}"} <= _labels(_draw(Robot.load("scara-perugia")))
    assert {"a_{2}", "a_{3}", "d_{3}", "d_{4}"} <= _labels(_draw(Robot.load("puma560-corke")))
    assert "a_{3}" not in _labels(_draw(Robot.load("scara-perugia")))


@pytest.mark.first(10)
@pytest.mark.slow
@pytest.mark.parametrize("robot", [*map(Robot.load, catalogue_names()), *_random_robots()], ids=lambda r: r.name)
def test_every_robot_is_drawn_inside_its_canvas(robot: Robot) -> None:
    rng = random.Random(robot.n)
    for q in (None, [rng.uniform(-1.5, 1.5) for _ in robot.joints]):
        drawing = _draw(robot, q)
        points = _points(drawing)
        assert np.isfinite(points).all()
        assert 0 < drawing.width <= WIDTH
        assert 0 < drawing.height <= HEIGHT
        assert points.min() >= 0
        assert (points.max(axis=0) <= (drawing.width, drawing.height)).all()


def test_same_robot_same_drawing() -> None:
    assert _draw(Robot.load("stanford-deluca")) == _draw(Robot.load("stanford-deluca"))


def test_numbers_of_the_figure_are_used_and_the_others_are_stated() -> None:
    from dataclasses import replace
    from fractions import Fraction

    from derive.robot.expression import Number
    from derive.robot.options.handout import FigureOptions

    robot = Robot.load("planar-2r-perugia")
    q = (Number(Fraction(1, 2)), Number(Fraction(1)))
    chosen = replace(robot, figure=FigureOptions(q=q, values=(("a1", Number(Fraction(1, 4))),)))
    poses = RobotPoses(chosen)
    assert poses.configuration == (0.5, 1.0)
    assert [name for name, _, _ in poses.assumed] == ["a2"]
    assert poses.frames(poses.zero)[1][0][3] == 0.25
    assert RobotPoses(robot).configuration is None
