"""Drawings of an arm: shaded in depth with axes, lengths and joint variables by name; configurations as lines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.drawing import Color, Drawing, Item, Path, Point, label_width
from derive.handouts.figure.paper import AXIS_COLORS, DIMENSION, Paper, around, bounds, moved, resized
from derive.handouts.figure.projection import Sizes, View, best_view, joint_centers, paint, solid_faces, view_along
from derive.handouts.figure.scene import LETTERS, Frames, LinkSegment, Scene, arm_scene
from derive.handouts.notation.pieces import joined, upright
from derive.handouts.notation.printer import DataPrinter
from derive.robot import tree
from derive.robot.description import Convention, FixedRow, Joint, position
from derive.robot.expression import Sum, names
from derive.robot.robot import Robot

WIDTH = 380.0  # largest width of a drawing [pt]
HEIGHT = 300.0  # largest height of a drawing [pt]
LONGEST_LINK = 130.0  # a link is drawn no longer than this [pt]
LONGEST_LABEL = 70.0  # a wider length is labelled by its symbol of the table, such as a_2 [pt]
_MARGIN = 3.0
_ROOM = 36.0  # room for axes and labels at each side of the arm, as a first guess [pt]
_TRIES = 6
_SHORT = 15.0  # a shorter length has its name beside it and no dimension line [pt]
_OFFSETS = (14.0, -14.0, 20.0, -20.0, 28.0, -28.0, 38.0, -38.0)  # of a dimension line, the best first [pt]
_MOST_NAMES = 8  # joints up to which every joint variable is written beside its joint


def arm_drawing(robot: Robot, data: DataPrinter, frames: Frames, title: str = "", view: View | None = None) -> Drawing:
    """The drawing of a robot; frames 0 to n and that of the end effector in the world are 4x4 each [m]."""
    scene = arm_scene(robot, frames)
    view = view or arm_view(scene)
    flat = view.project(scene.places)[:, :2]
    width, height = flat.max(axis=0) - flat.min(axis=0)
    fitting = [LONGEST_LINK / max((segment.length for segment in scene.segments), default=1.0)]
    fitting += [(WIDTH - 2 * _ROOM) / width] if width > 0 else []
    fitting += [(HEIGHT - 2 * _ROOM) / height] if height > 0 else []
    scale = float(min(fitting))  # points per metre with which the arm fits without its labels
    for _ in range(_TRIES):  # arrows and labels do not shrink with the arm: a smaller scale until all fits
        items = _Stage(robot, data, scene, view, scale).drawn()
        left, bottom, right, top = bounds(items)
        if (excess := max((right - left + 2 * _MARGIN) / WIDTH, (top - bottom + 2 * _MARGIN) / HEIGHT)) <= 1.0:
            break
        scale *= 0.97 / excess
    return moved(items if excess <= 1.0 else resized(items, 0.999 / excess), _MARGIN, title)


def arm_view(scene: Scene) -> View:
    """From where an arm is best seen."""
    stars = []
    for place in scene.places:
        directions: list[Array] = []
        for axis in scene.axes:
            here = np.linalg.norm(axis.origin - place) < 1e-3 * scene.size
            if here and all(axis.direction @ other < 0.999 for other in directions):
                directions.append(axis.direction)
        stars += [np.stack(directions)] if directions else []
    segments = [np.stack([segment.start, segment.end]) for segment in scene.segments]
    return best_view(scene.places, stars, segments, scene.up)


@dataclass(frozen=True, eq=False)
class _Stage:
    """A scene on its way to the page, at a scale in points per metre."""

    robot: Robot
    data: DataPrinter
    scene: Scene
    view: View
    scale: float
    paper: Paper = field(default_factory=Paper)

    def drawn(self) -> list[Item]:
        """All items: the solid arm, then axes and their names, lengths, joint variables."""
        gaps = sorted(s.length * self.scale for s in self.scene.segments if s.length > 0.05 * self.scene.size)
        typical = gaps[len(gaps) // 3] if gaps else 80.0
        sizes = Sizes(float(np.clip(typical / 62.0, 0.55, 1.0)))  # smaller joints and arrows where places are close
        faces, outlines = solid_faces(self.scene, self.scale, sizes)
        self.paper.items.extend(paint(faces, self.view))
        for line in outlines:
            self.paper.line([(float(x), float(y)) for x, y in self.view.project(line)[:, :2]], weight=0.8)
        # Arrows first, the longest at the back, then names of x and z: y follows from them.
        arrows = []
        for axis in sorted(self.scene.axes, key=lambda axis: (-sizes.arrow[axis.letter], axis.frames)):
            origin = axis.origin * self.scale
            end = origin + axis.direction * sizes.arrow[axis.letter]
            arrows.append((axis, self.view.flat(origin), self.view.flat(end)))
        for axis, start, tip in arrows:
            self.paper.arrow(start, tip, AXIS_COLORS[axis.letter], 0.9)
        names = frame_names(self.robot)
        for axis, (x, y), tip in arrows:
            if LETTERS[axis.letter] != "y":
                latex = ",".join(f"{LETTERS[axis.letter]}_{{{names[k]}}}" for k in axis.frames)
                places = around(tip, (tip[0] - x, tip[1] - y), 6.5, label_width(latex))
                self.paper.label(latex, places, AXIS_COLORS[axis.letter])
        for segment in self.scene.segments:
            self._draw_length(segment)
        joints = self.robot.joints[len(self.robot.root.variables) if self.robot.root else 0 :]
        if len(joints) <= _MOST_NAMES:
            for joint, center in zip(joints, joint_centers(self.scene, self.scale, sizes), strict=False):
                latex = self.data.notation.glyph(joint.variable).box.tex.strip()
                if joint.drive:
                    latex = joined(self.data.driven(joint).value(position(joint))).tex.strip()
                places = around(self.view.flat(center), (1.0, 0.3), 11.0 + 4.0 * sizes.factor)
                self.paper.label(latex, places, DIMENSION)
        return self.paper.items

    def _draw_length(self, segment: LinkSegment) -> None:
        """A dimension line beside a link, where it crosses least; only the name beside a short one."""
        if not (latex := _length(self.robot, self.data, segment)):
            return
        start, end = self.view.flat(segment.start * self.scale), self.view.flat(segment.end * self.scale)
        length = math.hypot(end[0] - start[0], end[1] - start[1])
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        if length < _SHORT:
            direction = (-(end[1] - start[1]), end[0] - start[0]) if length > 1e-6 else (0.0, 1.0)
            self.paper.label(latex, around(middle, direction, 9.0, label_width(latex)), DIMENSION)
            return
        nx, ny = -(end[1] - start[1]) / length, (end[0] - start[0]) / length

        def _beside(point: Point, by: float) -> Point:
            return (point[0] + by * nx, point[1] + by * ny)

        costs = [self.paper.crossing(_beside(start, o), _beside(end, o)) + 0.12 * abs(o) for o in _OFFSETS]
        offset = _OFFSETS[int(np.argmin(np.round(costs, 6)))]
        for point in (start, end):
            ends = _beside(point, math.copysign(4.0, offset)), _beside(point, offset + math.copysign(2.5, offset))
            self.paper.draw(Path(ends, stroke=DIMENSION, width=0.3), weight=0.4)
        a, b = _beside(start, offset), _beside(end, offset)
        self.paper.arrow(a, b, DIMENSION, 0.45, both=True)
        outward = (math.copysign(1.0, offset) * nx, math.copysign(1.0, offset) * ny)
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        self.paper.label(latex, around(middle, outward, 6.0 + 4.0 * abs(outward[0]), label_width(latex)), DIMENSION)


def _length(robot: Robot, data: DataPrinter, segment: LinkSegment) -> str:
    """The cell of the table that a segment shows, as LaTeX; its symbol where the cell is too wide."""
    if segment.cell in ("tool", "mount"):
        return ""
    rows: tuple[Joint | FixedRow, ...] = (*robot.joints, *robot.fixed)
    joint, is_rod = rows[segment.row], segment.cell == "rod"
    cell = robot.loops[segment.row].length if is_rod else joint.a if segment.cell == "a" else joint.d
    if segment.cell == "d" and isinstance(joint, Joint) and not joint.is_revolute:
        cell = Sum((position(joint), cell))
    latex = joined(data.length(cell)).tex.strip()
    if not any(True for _ in names(cell)):
        latex += r"\,\mathrm{mm}" if robot.units.millimetres else r"\,\mathrm{m}"
    if label_width(latex) <= LONGEST_LABEL and "frac{" not in latex and "\\sqrt" not in latex:
        return latex
    if is_rod:
        return ""
    behind = segment.cell == "a" and robot.convention is Convention.MODIFIED and not robot.is_tree
    return f"{segment.cell}_{{{frame_names(robot)[segment.row + (0 if behind else 1)]}}}"


def frame_names(robot: Robot) -> list[str]:
    """The names of frames 0 to n, of rows without motion and of the ends, as LaTeX."""
    words = [*(row.name for row in robot.fixed), *(end.name or "e" for end in tree.ends(robot))]
    return [*map(str, range(robot.n + 1)), *(upright(word).tex if len(word) > 1 else word for word in words)]


# -- the arm in several configurations over each other: a line for all whose links cover each other

# Told apart by readers who see few colours; after them lines are dashed, too.
COLORS: tuple[Color, ...] = (
    *((0.00, 0.32, 0.62), (0.80, 0.33, 0.00), (0.00, 0.48, 0.36)),
    *((0.62, 0.20, 0.52), (0.45, 0.36, 0.00), (0.25, 0.25, 0.28)),
)
_MOST = 4  # lines over each other; more are two drawings side by side
_WIDTH, _HALF = 300.0, 210.0  # width of one drawing, and of each of two [pt]
_TALLEST = min(HEIGHT, 230.0)
_ARROWS_ROOM = 40.0  # room for arrows and numbers at both sides [pt]
_JOINT = 2.4  # radius of the dot of a joint [pt]
_ARROW = 24.0
Points = Sequence[Point]
_SAME = 1e-6  # lines closer to each other than this part of the arm's size are one


def branches_drawing(robot: Robot, frames: Sequence[Frames], names: Sequence[str], title: str) -> Drawing | None:
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
    scene, axis = scenes[0], scenes[0].joints[0].direction
    is_flat = all(abs((scene.places - scene.places[0]) @ axis) < _SAME * scene.size)
    view = view_along(axis, scene.up) if is_flat else arm_view(scene)
    flat = [[view.flat(point) for point in lines[group[0]]] for group in groups]
    low, high = (f(np.array([point for line in flat for point in line]), axis=0) for f in (np.min, np.max))
    # Many lines are two drawings side by side, each with a half of them (rounded up), at one scale.
    half = -(-len(groups) // 2) if len(groups) > _MOST else len(groups)
    rooms = zip((_WIDTH if half == len(groups) else _HALF, _TALLEST), high - low, strict=True)
    scale = min((room - 2 * _ARROWS_ROOM) / extent for room, extent in rooms if extent)
    paper = Paper()
    for first in range(0, len(groups), half):
        chosen = range(first, min(first + half, len(groups)))
        aside = (first // half) * (scale * float(high[0] - low[0]) + 2 * _ARROWS_ROOM)
        shown = [[(scale * x + aside, scale * y) for x, y in flat[k]] for k in chosen]
        dots = [[view.flat(joint.anchor * scale) for joint in scenes[groups[k][0]].joints] for k in chosen]
        texts = [",".join(names[branch] for branch in groups[k]) for k in chosen]
        _draw_arms(paper, shown, [[(x + aside, y) for x, y in own] for own in dots], texts)
        _draw_ends(paper, view, scenes[0], np.array(frames[0][-1]), scale, aside)
    return moved(paper.items, 3.0, title)


def _draw_arms(paper: Paper, lines: Sequence[Points], dots: Sequence[Points], texts: Sequence[str]) -> None:
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


def _draw_ends(paper: Paper, view: View, scene: Scene, pose: Array, scale: float, aside: float) -> None:
    """The ground below the base, and the axes of the pose that all reach."""
    x, y = view.flat(scene.places[0] * scale)
    x += aside
    paper.draw(Path(((x - 12, y - 5), (x + 12, y - 5)), stroke=DIMENSION, width=1.2))
    for letter in (0, 2):
        ends = (pose[:3, 3] * scale, pose[:3, 3] * scale + _ARROW * pose[:3, letter])
        start, tip = ((u + aside, v) for u, v in map(view.flat, ends))
        if math.dist(start, tip) > 4.0:
            paper.arrow(start, tip, AXIS_COLORS[letter], 0.9)


def _along(line: Points, parts: int) -> list[Point]:
    shares = [k / parts for k in range(parts + 1)]
    return [((1 - t) * a[0] + t * b[0], (1 - t) * a[1] + t * b[1]) for a, b in pairwise(line) for t in shares]
