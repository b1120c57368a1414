"""A Denavit-Hartenberg table for lines in space: frames on common normals, chosen for the fewest cells.

Every sequence of joint axes has a standard and a modified table with a constant base and tool: two lines that are not
parallel have one common normal, two that are have many, and one may be taken; what is left before the first frame and
behind the last one is base and tool (Denavit and Hartenberg, 1955; Craig, Introduction to Robotics, 3.4).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np

from derive.errors import RobotFileError, quoted
from derive.exchange.arm import Arm
from derive.exchange.body_chain import angle_of
from derive.mechanics.space import NOTHING, WORLD, Frame, Line, Point, Real, length, plus, times, unit
from derive.mechanics.vectors import cross, dot
from derive.robot.description import Convention

ALIKE = 1e-9  # of floats: what differs by less is the same
ROUNDING = 1e-13  # of floats, relative: frames that fit no worse fit exactly
# What a number of the base or the tool counts beside a cell of the table, so that rows hold what they can.
BASE_CELL = 1.6
NEIGHBOURS = 2  # how many joints further a frame looks for points that it may share
NEGATIVE = 0.02  # what a minus sign counts
# What an offset counts for each joint behind it: of parallel axes the last one has it, as in makers' tables.
EARLY = 1e-4
FAR = 2.0  # no cell of a table is a larger multiple of the arm's reach where another table does without
# How far the arm may move where axes with such a far common normal are taken as parallel: of 1 m, or of a lesser reach.
TURNED = 1e-4
AS_WRITTEN = 1e-5  # the same where nothing is snapped
TOO_FAR = 1000.0  # what a far cell counts for each power of ten


@dataclass(frozen=True, slots=True)
class DHRow:
    """The constant cells of a joint."""

    theta: Real  # [rad]
    d: Real  # [m]
    a: Real  # [m]
    alpha: Real  # [rad]


@dataclass(frozen=True, slots=True)
class Placement:
    """Frames of a table at q = 0."""

    convention: Convention  # standard or modified
    frames: tuple[Frame, ...]  # frame 0 to frame n, in the world
    rows: tuple[DHRow, ...]  # of the table
    tool: Frame  # the arm's end in frame n
    turned: tuple[float, ...]  # by how much axes were turned, where they were [rad]
    far: tuple[tuple[int, bool], ...] = ()  # axes, from 0, that meet the one before too far away; if taken as parallel


def place(arm: Arm, convention: Convention, snap: float) -> Placement:
    """The table of an arm; axes closer to parallel or to each other than the snap are taken for it [rad, m]."""
    lines, far = _straightened(arm, snap)
    turned = [_sine(line.direction, axis.line.direction) for line, axis in zip(lines, arm.axes, strict=True)]
    standard = convention is Convention.STANDARD
    # Lines for every z of the table: the axes, slides moved beside them, and the z that no joint has.
    frame, axis = (arm.end, lines[-1]) if standard else (WORLD, lines[0])
    own, free = Line(frame.origin, frame.z), [axis, Line(frame.origin, axis.direction)]
    if parallel(own.direction, axis.direction, NOTHING) or not _is_far(own, axis, arm.reach):
        free = [own, *free]
    # Points that frames may take: base, tip, and where neighbours are nearest to each other, with their joint.
    spots: list[tuple[int | None, Point]] = [(None, WORLD.origin), (None, arm.end.origin)]
    for i, j in pairwise([i for i, axis in enumerate(arm.axes) if axis.is_revolute]):
        line, other = lines[i], lines[j]
        if not parallel(line.direction, other.direction, ALIKE):
            near = ((i, line.nearest(other), line.point), (j, other.nearest(line), other.point))
            spots += [(k, spot) for k, spot, own in near if length(plus(spot, own, -1)) <= FAR * arm.reach + ALIKE]
    options = [[line] for line in lines]
    for i, (line, joint) in enumerate(zip(lines, arm.axes, strict=True)):
        for spot in () if joint.is_revolute else _near(spots, i):  # the axis of a slide may stand anywhere
            if all(other.distance(spot) > ALIKE for other in options[i]):
                options[i].append(Line(spot, line.direction))
    columns = [*options, free] if standard else [free, *options]
    frames = _cheapest(arm, _candidates(arm, columns, spots, standard, snap), standard, min(max(snap, ROUNDING), ALIKE))
    # Standard: Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha), about and along the z before and the x behind;
    # modified: Trans(x, a) Rot(x, alpha) Rot(z, theta) Trans(z, d), about and along the x before and the z behind.
    rows = []
    for before, after in pairwise(frames):
        z, x = (before.z, after.x) if standard else (after.z, before.x)
        apart = plus(after.origin, before.origin, -1)
        theta, alpha = _angle(before.x, after.x, z), _angle(before.z, after.z, x)
        rows.append(DHRow(theta, dot(apart, z), dot(apart, x), alpha))
    tool, changes = arm.end.seen_from(frames[-1]), tuple(float(sine) for sine in turned if sine > NOTHING)
    return Placement(convention, frames, tuple(rows), tool, changes, far)


def parallel(a: Point, b: Point, snap: float) -> bool:
    """Whether two unit vectors have one direction, or opposite ones."""
    return bool(_sine(a, b) <= max(snap, NOTHING))


def _sine(a: Point, b: Point) -> Real:
    return length(cross(a, b))


def _is_far(line: Line, other: Line, reach: float) -> bool:
    """Whether two lines that are not parallel are nearest to each other beyond all that the arm reaches."""
    apart = length(plus(line.nearest(other), line.point, -1)), length(plus(other.nearest(line), other.point, -1))
    return max(map(float, apart)) > FAR * reach


def _straightened(arm: Arm, snap: float) -> tuple[list[Line], tuple[tuple[int, bool], ...]]:
    """The axes; one that is almost parallel to the one before or to an axis of the base takes its direction."""
    # So does one that meets the axis before beyond everything that the arm reaches, where this costs little: no arm is
    # 75 km long because somebody wrote 1.5708. What it costs is in the certificate.
    lines: list[Line] = []
    far: list[tuple[int, bool]] = []
    most = (TURNED if snap else AS_WRITTEN) * min(arm.reach, 1)
    for i, axis in enumerate(arm.axes):
        line = axis.line
        known = [other.direction for other in reversed(lines)] + [WORLD.z, WORLD.x, WORLD.y, arm.end.z]
        # The direction of an axis before it, of the base or of the end, where it is that but for the snap.
        alike = next((direction for direction in known if parallel(direction, line.direction, snap)), None)
        line = line if alike is None else _along(line, alike)
        if lines and parallel(lines[-1].direction, line.direction, snap):  # by then
            line = _along(line, lines[-1].direction)
        if lines and not parallel(line.direction, lines[-1].direction, 0) and _is_far(line, lines[-1], arm.reach):
            taken = bool(2 * _sine(line.direction, lines[-1].direction) * arm.way[i + 1] <= most)
            line = _along(line, lines[-1].direction) if taken else line
            far.append((i, taken))
        lines.append(line)
    return lines, tuple(far)


def _along(line: Line, direction: Point) -> Line:
    """The line through the same point in a direction, or against it."""
    return Line(line.point, direction if dot(direction, line.direction) > 0 else times(direction, -1))


def _near(spots: Sequence[tuple[int | None, Point]], joint: int) -> list[Point]:
    """Of points with their joints those at the ends of the arm and near a joint."""
    return [spot for i, spot in spots if i is None or abs(i - joint) <= NEIGHBOURS]


def _candidates(
    arm: Arm, columns: Sequence[Sequence[Line]], spots: Sequence[tuple[int | None, Point]], standard: bool, snap: float
) -> list[list[Frame]]:
    """Frames on each axis: origins at common normals or near spots, x along normals or what is known."""
    normals = []  # directions of the common normals of the lines of two joints
    for before, after in pairwise(columns):
        normal = cross(before[0].direction, after[0].direction)
        ways = (plus(other.foot(line.point), line.point, -1) for line in before for other in after)
        normals.append([normal] if length(normal) > ALIKE else list(ways))
    ends = [WORLD.x, WORLD.y, arm.end.x, arm.end.y]
    known = [[*ends, *chain(*normals[max(i - NEIGHBOURS, 0) : i + NEIGHBOURS])] for i in range(len(columns))]
    found = []
    for i, column in enumerate(columns):
        partners = [] if i == (0 if standard else len(columns) - 1) else columns[i - 1 if standard else i + 1]
        frames: dict[tuple[float, ...], Frame] = {}
        for line in column:
            for origin, x in _normals(line, partners, _near(spots, i), known[i], snap):
                for sign in (1, -1):
                    frame = Frame.of(origin, times(x, sign), line.direction)
                    key = tuple(round(float(c), 12) for v in (origin, frame.x, frame.z) for c in v)
                    frames.setdefault(key, frame)
        found.append(list(frames.values()))
    return found


def _normals(
    line: Line, partners: Sequence[Line], spots: Sequence[Point], known: Sequence[Point], snap: float
) -> Iterator[tuple[Point, Point]]:
    """Origins on a line with directions of x that are perpendicular to it and to a partner, which x meets."""
    # The part of each known direction that is perpendicular to the line: (z x v) x z.
    slanting = [v for v in known if length(cross(line.direction, v)) > ALIKE]
    across = [unit(cross(cross(line.direction, v), line.direction)) for v in slanting]
    feet = [line.foot(spot) for spot in spots]
    if not partners:
        yield from ((foot, x) for foot in feet for x in across)
        return
    for partner in partners:
        # x meets both lines at right angles: along z x z', else along the way between parallels, else free.
        normal = cross(partner.direction, line.direction)
        if length(normal) > max(snap, NOTHING):
            yield line.nearest(partner), unit(normal)
            continue
        apart = plus(line.point, partner.foot(line.point), -1)
        if length(apart) > max(min(snap, ALIKE), NOTHING):
            yield from ((foot, unit(apart)) for foot in feet)
        else:
            yield from ((foot, x) for foot in feet for x in across)


def _angle(a: Point, b: Point, about: Point) -> Real:
    """From one direction to another about a third [rad]."""
    return angle_of(dot(cross(a, b), about), dot(a, b))


def _cheapest(arm: Arm, candidates: Sequence[Sequence[Frame]], standard: bool, loose: float) -> tuple[Frame, ...]:
    """The frames whose table has the fewest numbers (Viterbi)."""
    if not all(candidates):
        raise _lost(arm)
    costs = np.array([_frame_cost(WORLD, frame) for frame in candidates[0]])
    # Origin, x and z of all frames on an axis in floats, (3, frames, 3).
    parts = ("origin", "x", "z")
    numbers = [np.array([[list(map(float, getattr(f, v))) for f in column] for v in parts]) for column in candidates]
    back: list[np.ndarray] = []
    # The least cost to each frame from the base on, and which frame it came from.
    for behind, (column, following) in zip(range(len(candidates) - 1, 0, -1), pairwise(numbers), strict=True):
        steps, cells = _step_costs(column, following, standard, loose)
        far = np.maximum(cells / (FAR * arm.reach + ALIKE), 1)
        steps = steps + EARLY * behind * (cells[0] > ALIKE) + TOO_FAR * ((far > 1) + np.log10(far)).sum(axis=0)
        total = costs[:, None] + steps
        back.append(total.argmin(axis=0))
        costs = total.min(axis=0)
    costs = costs + np.array([_frame_cost(frame, arm.end) for frame in candidates[-1]])
    at = int(costs.argmin())
    if not np.isfinite(costs[at]):  # two lines have a common normal, but floats may not tell where
        raise _lost(arm)
    chosen = [at]  # back from the cheapest end
    for choice in reversed(back):
        chosen.append(int(choice[chosen[-1]]))
    return tuple(column[k] for column, k in zip(candidates, reversed(chosen), strict=True))


def _lost(arm: Arm) -> RobotFileError:
    """What to raise where lengths of an arm have no numbers in common."""
    away = max(arm.axes, key=lambda axis: float(length(axis.line.point)))
    found = f"joint {quoted(away.joint.name)}: so far from others that floats lose where these are"
    return RobotFileError(found, remedy="correct the lengths", location=away.joint.location)


def _frame_cost(outer: Frame, inner: Frame) -> float:
    local = inner.seen_from(outer)
    places = sum(abs(float(c)) > ALIKE for c in local.origin)
    turned = 2 * (abs(float(local.z[2]) - 1) > ALIKE) or abs(float(local.x[0]) - 1) > ALIKE
    return BASE_CELL * (places + float(turned))


def _step_costs(column: np.ndarray, following: np.ndarray, standard: bool, loose: float) -> tuple[np.ndarray, ...]:
    """Of each pair of frames: the numbers of their row, infinite where x is no common normal; sizes of d and a."""
    o0, x0, z0 = column[:, :, None, :]
    o1, x1, z1 = following[:, None, :, :]
    apart, (x, turning) = o1 - o0, (x1, z0) if standard else (x0, z1)
    # x is perpendicular to the z that it meets, and (o' - o) . (x x z) = 0: both z meet the line along x.
    wrong = np.abs((x * turning).sum(-1)) > loose
    wrong |= np.abs((apart * np.cross(x, turning)).sum(-1)) > loose * (1 + np.abs(apart).sum(-1))
    d, a = (apart * turning).sum(-1), (apart * x).sum(-1)
    sin_theta, cos_theta = (np.cross(x0, x1) * turning).sum(-1), (x0 * x1).sum(-1)
    sin_alpha, cos_alpha = (np.cross(z0, z1) * x).sum(-1), (z0 * z1).sum(-1)
    # Each number counts one, a minus sign a little: theta and alpha are none where sine is 0 and cosine 1.
    cost = np.zeros(d.shape)
    for sine, cosine in ((sin_theta, cos_theta), (sin_alpha, cos_alpha)):
        cost += (np.abs(sine) > ALIKE) | (cosine < 0)
        cost += NEGATIVE * (sine < -ALIKE) + NEGATIVE / 4 * ((np.abs(sine) <= ALIKE) & (cosine < 0))
    for value in (d, a):
        cost += (np.abs(value) > ALIKE) + NEGATIVE * (value < -ALIKE)
    return np.where(wrong, np.inf, cost), np.abs(np.array([d, a]))
