"""The drawing of an arm: shaded joints and links in depth, axes of the frames, lengths and names on top."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from derive.handout.figure.annotations import annotate
from derive.handout.figure.drawing import Drawing
from derive.handout.figure.placing import Paper, bounds, moved, resized
from derive.handout.figure.projection import View, best_view, paint
from derive.handout.figure.scene import Scene, arm_scene
from derive.handout.figure.solids import Sizes, solid_faces
from derive.handout.tables import DataPrinter
from derive.robot.robot import Robot

Array = npt.NDArray[np.float64]

WIDTH = 380.0
"""Largest width of a drawing [pt]."""

HEIGHT = 300.0
"""Largest height of a drawing [pt]."""

LONGEST_LINK = 130.0
"""A link is drawn no longer than this [pt]."""

_MARGIN = 3.0
_ROOM = 36.0
_TRIES = 6


@dataclass(frozen=True, eq=False)
class Stage:
    """A scene on its way to the page.

    Attributes:
        scene: The arm.
        view: From where it is seen.
        scale: Points per metre.
        sizes: How large joints, links and arrows are drawn.
    """

    scene: Scene
    view: View
    scale: float
    sizes: Sizes


def arm_drawing(
    robot: Robot,
    data: DataPrinter,
    frames: Sequence[Sequence[Sequence[float]]],
    title: str = "",
    view: View | None = None,
) -> Drawing:
    """The drawing of a robot whose frames are known.

    Args:
        robot: The robot.
        data: Prints the lengths of its table.
        frames: Frame 0, frames 1 to n and the end effector in the world, 4x4 each [m].
        title: What the drawing shows.
        view: From where it is seen; chosen if not given.
    """
    scene = arm_scene(robot, frames)
    view = view or arm_view(scene)
    flat = view.project(scene.places)[:, :2]
    scale = _first_scale(scene, flat)
    for _ in range(_TRIES):
        paper = _paper(robot, data, Stage(scene, view, scale, _sizes(scene, scale)))
        left, bottom, right, top = bounds(paper.items)
        excess = max((right - left + 2 * _MARGIN) / WIDTH, (top - bottom + 2 * _MARGIN) / HEIGHT)
        if excess <= 1.0:
            break
        scale *= 0.97 / excess
    items = paper.items if excess <= 1.0 else resized(paper.items, 0.999 / excess)
    return moved(items, _MARGIN, title)


def arm_view(scene: Scene) -> View:
    """From where an arm is best seen."""
    stars = [_star(scene, place) for place in scene.places]
    segments = [np.stack([s.start, s.end]) for s in scene.stretches]
    return best_view(scene.places, [star for star in stars if len(star)], segments, scene.up)


def _star(scene: Scene, place: Array) -> Array:
    near = [axis.direction for axis in scene.axes if np.linalg.norm(axis.origin - place) < 1e-3 * scene.size]
    kept: list[Array] = []
    for direction in near:
        if all(direction @ other < 0.999 for other in kept):
            kept.append(direction)
    return np.stack(kept) if kept else np.zeros((0, 3))


def _first_scale(scene: Scene, flat: Array) -> float:
    width, height = flat.max(axis=0) - flat.min(axis=0)
    longest = max((stretch.length for stretch in scene.stretches), default=1.0)
    fits = [LONGEST_LINK / longest]
    if width > 0:
        fits.append((WIDTH - 2 * _ROOM) / width)
    if height > 0:
        fits.append((HEIGHT - 2 * _ROOM) / height)
    return float(min(fits))


def _sizes(scene: Scene, scale: float) -> Sizes:
    """Smaller arrows and joints where places are close to each other."""
    gaps = sorted(s.length * scale for s in scene.stretches if s.length > 0.05 * scene.size)
    typical = gaps[len(gaps) // 3] if gaps else 80.0
    return Sizes(float(np.clip(typical / 62.0, 0.55, 1.0)))


def _paper(robot: Robot, data: DataPrinter, stage: Stage) -> Paper:
    paper = Paper()
    faces, outlines = solid_faces(stage.scene, stage.scale, stage.sizes)
    for path in paint(faces, stage.view):
        paper.items.append(path)
    for line in outlines:
        flat = stage.view.project(line)[:, :2]
        paper.line([(float(x), float(y)) for x, y in flat], weight=0.8)
    annotate(paper, robot, data, stage.scene, stage.view, stage.scale, stage.sizes)
    return paper
