"""Where the frames of a robot are, in numbers, for figures; symbols without one get a length or an angle to draw."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import cycle
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.errors import DeriveError, ExpressionError
from derive.inverse.loops.linkage import assembled, linkage, positions, rates
from derive.mechanics.chain import Chain, ChainJoint, build_chain, constant_frame, stand_frame, way_frame
from derive.mechanics.floats import FloatDomain
from derive.mechanics.forward_kinematics import joint_poses
from derive.mechanics.vectors import Frame
from derive.robot import tree
from derive.robot.description import Joint, Variable
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import Call, Expression, Number, Pi, Product, Sum, children, multiply, names
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

Pose = tuple[tuple[float, ...], ...]  # a 4x4 transform
ASSUMED_ANGLE = math.pi / 6  # drawn for an angle without a number [rad]
# Lengths for symbols without a number, in units of the longest known one; the next row if a cell has no value.
PATTERNS = ((1.0, 0.8, 0.6, 0.9, 0.7, 0.5), (1.0, 0.5, 1.3, 0.3, 1.6, 0.2), (0.9, 0.4, 0.5, 0.2, 0.15, 0.1))
_FIRST = (2, 4, -2, 6, -4, 8)  # twelfths of pi at which angles are looked at first: generic ones
_TRIES, _CLEAR = 256, 0.5  # configurations of loops that are looked at, and which part of the best clearance is enough
Numbers = Mapping[str, Fraction | float]  # symbol -> its number, exact where the file gives it


class RobotPoses:
    """Frames of a robot at any configuration.

    `values` has the numbers of all symbols, `assumed` those that no file gives: name, value and unit (``m``, ``rad``);
    `longest` is the longest length of the table [m], 1 m if there is none.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = replace(robot, links=(), gravity=None, fixed=tree.massless(robot.fixed))  # its kinematics
        known = parameter_values(self.robot)
        known |= {name: to_float(value, known) for name, value in robot.figure.values}
        missing = [name for name in robot_symbols(self.robot) if name not in known]
        # Symbols of angles: in cells theta and alpha, or under a sine, cosine or tangent anywhere else.
        joints, unit = self.robot.joints, _longest(self.robot, known)
        values, turns = tree.constant_cells(self.robot)
        turns += [cell for joint in joints for cell in (joint.theta, joint.alpha)]
        angles = {name for cell in turns for name in names(cell)}
        pending = [cell for matrix in (robot.base, robot.tool) for row in matrix for cell in row] + values
        pending += [cell for joint in joints for cell in (joint.d, joint.a)]
        while pending:
            if isinstance(node := pending.pop(), Call) and node.function in ("sin", "cos", "tan"):
                angles |= set(names(node))
            pending += children(node)
        self._loops, self._closed = linkage(self.robot), tuple[Expression, ...]()
        choices: list[Iterator[float]] = [cycle(float(f"{unit * part:.1g}") for part in row) for row in PATTERNS]
        if self._loops and missing:  # with which they were assembled
            closing, *_ = assembled(self.robot, self._loops)
            choices.append(iter(float(f"{closing[name]:.3g}") for name in missing if name not in angles))
        for lengths in choices:
            assumed = {name: ASSUMED_ANGLE if name in angles else next(lengths) for name in missing}
            self.values: Numbers = {**known, **assumed}
            self.longest = _longest(self.robot, self.values)
            try:
                domain = FloatDomain(self.robot, (0.0,) * robot.n, self.values)
                self._chain: Chain[Any] = build_chain(self.robot, domain)
                self._rows = [way_frame(self.robot, row.name, domain) for row in self.robot.fixed]
                self._stands = [stand_frame(row.stand, domain) for row in self.robot.fixed]
                ends = [(*way_frame(self.robot, e.after, domain), constant_frame(e.tool, domain)) for e in robot.ends]
                self._ends = [(joint, tool if row is None else row @ tool) for joint, row, tool in ends]
                self._closed = self._closing_cells() if self._loops else ()
            except (ExpressionError, ArithmeticError):
                continue
            self.assumed = tuple((name, value, "rad" if name in angles else "m") for name, value in assumed.items())
            return
        found = f"{robot.name} cannot be drawn without numbers for its symbols"
        raise DeriveError(found, remedy="give them under parameters: or figure: values:")

    @property
    def zero(self) -> tuple[float, ...]:
        """The zero configuration, which is within the limits [rad or m], see `zero_cells`."""
        return self.numbers(self.zero_cells)

    @cached_property
    def zero_cells(self) -> tuple[Expression, ...]:
        """Zero, or the middle of limits that exclude it; of loops a place where they close, away from dead points."""
        found: list[Expression] = []
        for joint, bounds in zip(self.robot.variables, self.limits, strict=True):
            limits = joint.limits
            has_numbers = limits and all(name in self.values for cell in limits for name in names(cell))
            is_outside = bounds is not None and has_numbers and not min(bounds) <= 0.0 <= max(bounds)
            found.append(middle(joint) if is_outside else Number(Fraction(0)))
        return self._closed or tuple(found)

    def _closing_cells(self) -> tuple[Expression, ...]:
        """Of some generic configurations the first in which the loops close and are clear enough of dead points."""
        choices: list[list[Expression]] = []
        for k, (variable, bounds) in enumerate(zip(self.robot.variables, self.limits, strict=True)):
            if variable.is_revolute:
                low, high = bounds or (-math.pi, math.pi)
                cells = [multiply(Number(Fraction(i, 12)), Pi()) for i in (_FIRST[k % len(_FIRST)], *range(-12, 13))]
            else:
                low, high = bounds or (-self.longest, self.longest)
                cells = [Number(Fraction(f"{low + (high - low) * i / 20:.2g}")) for i in (11, *range(1, 20))]
            choices.append([cell for cell in cells if low <= to_float(cell, {}) <= high] or [middle(variable)])
        source = np.random.default_rng(7)
        picks = [[0, *source.integers(len(cells), size=_TRIES)] for cells in choices]
        tried = [[cells[i] for i in own] for cells, own in zip(choices, picks, strict=True)]
        with np.errstate(all="ignore"):
            q = [np.array([to_float(cell, self.values) for cell in cells]) for cells in tried]
            full, closed = positions(self.robot, self._loops, q, self.values)
            clear = np.nan_to_num(rates(self.robot, self._loops, full, self.values)[1]) * closed
        if not clear.any():
            raise ArithmeticError
        best = int(np.argmax(clear >= _CLEAR * clear.max()))
        return tuple(cells[best] for cells in tried)

    def joints(self, q: Sequence[float]) -> tuple[float, ...]:
        """The positions of all joints by those of the variables [rad or m]."""
        if not self.robot.coupled:
            return tuple(q)
        full, closed = positions(self.robot, self._loops, [np.array([x]) for x in q], self.values)
        if not closed.all():
            found = f"{self.robot.name}, whose loops are open at this configuration"
            raise DeriveError(found, remedy="choose values of the variables at which they close")
        return tuple(float(x[0]) for x in full)

    def rates(self, q: Sequence[float]) -> Array:
        """How fast the joints move by the variables, (joints, n): S, or W of closed loops."""
        return rates(self.robot, self._loops, self.joints(q), self.values)[0]

    @cached_property
    def start_cells(self) -> tuple[Expression, ...]:
        """The configuration that the robot file asks to draw if loops close there, else the zero configuration."""
        with suppress(DeriveError):
            if self.configuration and self.joints(self.configuration):
                return self.robot.figure.q or ()
        return self.zero_cells

    @property
    def configuration(self) -> tuple[float, ...] | None:
        """The configuration that the robot file asks to draw [rad or m]."""
        return None if (q := self.robot.figure.q) is None else self.numbers(q)

    def numbers(self, cells: Sequence[Expression]) -> tuple[float, ...]:
        """The values of cells with the numbers of the drawing."""
        return tuple(to_float(cell, self.values) for cell in cells)

    @property
    def limits(self) -> tuple[tuple[float, float] | None, ...]:
        """Lower and upper limit of every variable [rad or m], None where the file gives none."""
        found: list[tuple[float, float] | None] = []
        for limits in (variable.limits for variable in self.robot.variables):
            values = {**dict.fromkeys((name for cell in limits or () for name in names(cell)), 1.0), **self.values}
            found.append(limits and (to_float(limits[0], values), to_float(limits[1], values)))
        return tuple(found)

    def frames(self, q: Sequence[float], joints: Sequence[float] = ()) -> tuple[Pose, ...]:
        """Base frame 0, frames 1 to n and the end effector in the world: n + 2 transforms 4x4 [m]; joints if known."""
        # Of a tree the frames of rows without motion come behind frame n, then for all these rows the frames in which
        # they begin, and last the ends.
        inner, chain = self._joint_frames(joints or self.joints(q), math.cos, math.sin), self._chain
        rows = [chain.base, *(frame @ end for frame, end in zip(inner, chain.ends, strict=True))]
        tips = [rows[joint + 1] @ end for joint, end in self._ends] or [(inner[-1] if inner else rows[0]) @ chain.tool]
        if self.robot.is_tree:
            starts = [rows[j.parent + 1] if j.mount is None else rows[j.parent + 1] @ j.mount for j in chain.joints]
            fixed = [rows[joint + 1] if row is None else rows[joint + 1] @ row for joint, row in self._rows]
            known = dict(zip(tree.labels(self.robot), [*rows, *fixed], strict=True))
            stands = zip(self.robot.fixed, self._stands, strict=True)
            rows += [*fixed, *starts, *(known.get(row.stand.after, rows[0]) @ stand for row, stand in stands)]
        poses = []
        for frame in (*rows, *tips):
            upper = (tuple(map(float, (*row, x))) for row, x in zip(frame.rotation, frame.position, strict=True))
            poses.append((*upper, (0.0, 0.0, 0.0, 1.0)))
        return tuple(poses)

    def joint_frames(self, q: Sequence[Any]) -> list[Frame[Any]]:
        """Frames with the axes of the joints as z; joint positions are numbers, or arrays of one shape."""
        frames = self._joint_frames(q, np.cos, np.sin)
        return [*frames, frames[-1] @ self._chain.tool]

    def end_point(self, q: Sequence[Any], place: Sequence[float], joints: Sequence[int] = ()) -> list[list[Any]]:
        """Where a point of the end effector is in the world, then its derivatives by the variables of some joints."""
        # A vector goes through the constant frames of the joints, from the tool inwards; most of their entries are
        # zero, so that this is cheaper than frames. Joint positions are numbers, or arrays of one shape.
        point, slopes = _placed(self._chain.tool, place), dict[int, list[Any]]()
        moved = self._moved(q, np.cos, np.sin)
        for index in reversed(range(len(q))):
            row, joint = moved[index], self.robot.joints[index]
            c, s = row.cosine, row.sine
            # The motion of the joint about (along) its z axis, of the point and of the derivatives by joints beyond.
            vectors = [[c * x - s * y, s * x + c * y, z] for x, y, z in (point, *slopes.values())]
            x, y, z = vectors[0]
            slopes = dict(zip(slopes, vectors[1:], strict=True))
            if index in joints:
                # dp/dq = z x p of a joint that turns, z of one that slides.
                slopes[index] = [-joint.sign * y, joint.sign * x, 0.0] if joint.is_revolute else [0.0, 0.0, joint.sign]
            slopes = {place: _turned(row.fixed, slope) for place, slope in slopes.items()}
            point = _placed(row.fixed, (x, y, z + row.offset))
        base = self._chain.base
        return [_placed(base, point), *(_turned(base, slopes[index]) for index in joints)]

    def frame_of_axis(self, joint: int) -> Frame[Any]:
        """The frame in the world in which a joint moves about (along) z, in the zero configuration."""
        frames = [self._chain.base, *self._joint_frames(self.zero, math.cos, math.sin)]
        return frames[joint] @ self._chain.joints[joint].fixed

    def _joint_frames(self, q: Any, cosine: Any, sine: Any) -> list[Frame[Any]]:
        """Frames 1 to n that move with the joints, each with the axis of its joint as z."""
        return joint_poses(replace(self._chain, joints=tuple(self._moved(q, cosine, sine))))

    def _moved(self, q: Any, cosine: Any, sine: Any) -> list[ChainJoint[Any]]:
        found = []
        for value, row, joint in zip(q, self._chain.joints, self.robot.joints, strict=True):
            moved = joint.sign * value + to_float(joint.theta if joint.is_revolute else joint.d, self.values)
            changed = {"cosine": cosine(moved), "sine": sine(moved)} if joint.is_revolute else {"offset": moved}
            found.append(replace(row, **changed))
        return found


def _turned(frame: Frame[float], vector: Sequence[Any]) -> list[Any]:
    """A vector of a constant frame, of which most entries are zero, in the axes outside of it."""
    return [sum(k * x for k, x in zip(row, vector, strict=True) if k) for row in frame.rotation]


def _placed(frame: Frame[float], point: Sequence[Any]) -> list[Any]:
    """A point of a constant frame in the axes outside of it."""
    return [x + shift for x, shift in zip(_turned(frame, point), frame.position, strict=True)]


def middle(joint: Joint | Variable) -> Expression:
    """The value half way between the limits of a joint."""
    return Product((Number(Fraction(1, 2)), Sum(joint.limits or ())))


def _longest(robot: Robot, known: Numbers) -> float:
    """The longest length in the table that has a number; 1 m without any."""
    cells = (cell for joint in robot.joints for cell in (joint.d, joint.a))
    lengths = (abs(to_float(cell, known)) for cell in cells if all(name in known for name in names(cell)))
    return max(lengths, default=0.0) or 1.0
