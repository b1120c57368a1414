"""The drawing of an arm in several configurations over each other: a line for all whose links cover each other."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from derive.handouts.figure.arm import HEIGHT, arm_view
from derive.handouts.figure.drawing import Color, Drawing, Path, Point, label_width
from derive.handouts.figure.paper import AXIS_COLORS, DIMENSION, Paper, around, moved
from derive.handouts.figure.projection import View, view_along
from derive.handouts.figure.scene import Scene, arm_scene
from derive.robot.robot import Robot

# Told apart by readers who see few colours; after them lines are dashed, too.
COLORS: tuple[Color, ...] = (
    (0.00, 0.32, 0.62),
    (0.80, 0.33, 0.00),
    (0.00, 0.48, 0.36),
    (0.62, 0.20, 0.52),
    (0.45, 0.36, 0.00),
    (0.25, 0.25, 0.28),
)
_MOST = 4  # lines over each other; more are two drawings side by side
_WIDTH, _HALF = 300.0, 210.0  # width of one drawing, and of each of two [pt]
_TALLEST = min(HEIGHT, 230.0)
_ROOM = 40.0  # room for arrows and numbers at both sides [pt]
_JOINT = 2.4  # radius of the dot of a joint [pt]
_ARROW = 24.0
_SAME = 1e-6  # lines closer to each other than this part of the arm's size are one


def branches_drawing(
    robot: Robot, frames: Sequence[Sequence[Sequence[Sequence[float]]]], names: Sequence[str], title: str
) -> Drawing | None:
    """The drawing of an arm with frames (configurations, n + 2, 4, 4) [m]; None where its links cover each other."""
    scenes = [arm_scene(robot, own) for own in frames]
    lines = []  # the links of each, as one line from the base to the end effector
    for scene in scenes:
        line = [scene.places[0]]
        for segment in scene.segments:
            line += [p for p in (segment.start, segment.end) if np.linalg.norm(p - line[-1]) > _SAME * scene.size]
        lines.append(line)
    size = max(scene.size for scene in scenes)
    groups: list[list[int]] = []
    for k, line in enumerate(lines):
        alike = (g for g in groups if len(lines[g[0]]) == len(line))
        near = (g for g in alike if all(np.linalg.norm(np.subtract(lines[g[0]], line), axis=1) < _SAME * size))
        if group := next(near, None):
            group.append(k)
        else:
            groups.append([k])
    if len(groups) < 2:
        return None
    # Of one configuration: an arm whose places lie in a plane normal to its first axis is seen along that axis.
    scene = scenes[0]
    heights = (scene.places - scene.places[0]) @ scene.joints[0].direction
    is_flat = all(abs(heights) < _SAME * scene.size)
    view = view_along(scene.joints[0].direction, scene.up) if is_flat else arm_view(scene)
    flat = [[view.flat(point) for point in lines[group[0]]] for group in groups]
    low, high = (f(np.array([point for line in flat for point in line]), axis=0) for f in (np.min, np.max))
    # Many lines are two drawings side by side, each with a half of them (rounded up), at one scale.
    half = -(-len(groups) // 2) if len(groups) > _MOST else len(groups)
    width = _WIDTH if half == len(groups) else _HALF
    rooms = zip((width, _TALLEST), high - low, strict=True)
    scale = min((room - 2 * _ROOM) / extent for room, extent in rooms if extent)
    paper = Paper()
    for first in range(0, len(groups), half):
        chosen = range(first, min(first + half, len(groups)))
        aside = (first // half) * (scale * float(high[0] - low[0]) + 2 * _ROOM)
        shown = [[(scale * x + aside, scale * y) for x, y in flat[k]] for k in chosen]
        dots = [[view.flat(joint.anchor * scale) for joint in scenes[groups[k][0]].joints] for k in chosen]
        texts = [",".join(names[branch] for branch in groups[k]) for k in chosen]
        _draw_arms(paper, shown, [[(x + aside, y) for x, y in own] for own in dots], texts)
        _draw_ends(paper, view, scenes[0], frames[0][-1], scale, aside)
    return moved(paper.items, 3.0, title)


def _draw_arms(
    paper: Paper, lines: Sequence[Sequence[Point]], dots: Sequence[Sequence[Point]], texts: Sequence[str]
) -> None:
    """Arms over each other, each in its colour with its text beside it."""
    for index, (places, centers) in enumerate(zip(lines, dots, strict=True)):
        color, dashed = COLORS[index % len(COLORS)], index >= len(COLORS)
        paper.draw(Path(tuple(places), stroke=color, width=1.5, dashed=dashed))
        for x, y in centers:
            turns = [2 * math.pi * k / 12 for k in range(12)]
            corners = tuple((x + _JOINT * math.cos(t), y + _JOINT * math.sin(t)) for t in turns)
            paper.draw(Path(corners, closed=True, stroke=color, fill=(1.0, 1.0, 1.0), width=0.8))
    for index, (places, text) in enumerate(zip(lines, texts, strict=True)):
        others = [point for other in lines if other is not places for point in _along(other, 20)]
        # The text stands where the line is farthest from all others, on the side away from the middle of all.
        apart = [round(min((math.dist(p, other) for other in others), default=0.0), 6) for p in _along(places, 6)]
        place = _along(places, 6)[apart.index(max(apart))]
        middle = np.mean(np.array([*places, *others]), axis=0)
        direction = float(place[0] - middle[0]), float(place[1] - middle[1])
        paper.label(text, around(place, direction, 9.0, label_width(text)), COLORS[index % len(COLORS)])


def _draw_ends(
    paper: Paper, view: View, scene: Scene, end: Sequence[Sequence[float]], scale: float, aside: float
) -> None:
    """The ground below the base, and the axes of the pose that all reach."""
    x, y = view.flat(scene.places[0] * scale)
    x += aside
    paper.draw(Path(((x - 12, y - 5), (x + 12, y - 5)), stroke=DIMENSION, width=1.2))
    pose = np.array(end)
    for letter in (0, 2):
        ends = (pose[:3, 3] * scale, pose[:3, 3] * scale + _ARROW * pose[:3, letter])
        start, tip = ((u + aside, v) for u, v in map(view.flat, ends))
        if math.dist(start, tip) > 4.0:
            paper.arrow(start, tip, AXIS_COLORS[letter], 0.9)


def _along(line: Sequence[Point], parts: int) -> list[Point]:
    return [
        ((1 - k / parts) * a[0] + k / parts * b[0], (1 - k / parts) * a[1] + k / parts * b[1])
        for a, b in pairwise(line)
        for k in range(parts + 1)
    ]
