"""What printed solutions call the entries of a pose, and configurations at which they are tried.

Books write the pose by its entries, r11 or T14, by its columns n, s (or o) and a with p, or by x, y and phi; of a wrist
the centre, p_w or x_c. An o is the position where nothing else is, as in [R o], else the second column.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction

import mpmath
import numpy as np
import numpy.typing as npt
import sympy

from derive.checking.formulas.edits import float_value
from derive.checking.inverse.printed import Place
from derive.errors import DeriveError
from derive.inverse.words.postures import Placed, common_point, parallel, placed
from derive.inverse.words.solutions import ArrayDomain
from derive.mechanics.chain import build_chain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import Call, Expression, Name
from derive.robot.names import own_names, robot_symbols
from derive.robot.robot import Robot

BATCHES = 5  # geometries that are tried
CONFIGURATIONS = 12  # configurations of each
# Angles of joints that are tried, none close to a right angle, where arms are singular.
ANGLES = tuple(k / 100 for k in range(-310, 311) if abs(np.sin(k / 50)) > 0.2)
_COLUMN = re.compile(r"([nsoapP])([xyz])")
_END, _WRIST = "(?:e|ee|E|EE|eff|tip|d|des|desired|target|g|goal)", "(?:[wWcC]|[wW][cC]|[wW]rist)"
_COLUMNS = {"n": 1, "s": 2, "o": 2, "a": 3, "p": 4}


@dataclass(frozen=True)
class PoseNames:
    """The names of a printed solution that stand for entries of the pose, its wrist centre or its planar angle."""

    robot: Robot  # whose pose it is; its own names are none of the pose
    entries: Mapping[str, tuple[int, int]]  # row and column, from 1, of each name
    wrist: Mapping[str, int]  # which coordinate, from 0, of the wrist's centre a name is
    angles: Mapping[str, Expression]  # names of the planar orientation
    relatives: Mapping[str, tuple[int, int]]  # entries by names with other indices, which may have been meant

    @classmethod
    def of(cls, robot: Robot, words: Iterable[str], *, any_wrist: bool = False) -> PoseNames:
        """Those among the words of a text, with names of a wrist only if the arm has a centre, or any wrist will do."""
        own = own_names(robot)
        words = [word for word in dict.fromkeys(words) if word not in own]
        flat = {word: word.replace("_", "") for word in words}
        letters = {found[1] for word in flat.values() if (found := _COLUMN.fullmatch(word))}
        o_is_position = "s" in letters or not letters.intersection("npaP")
        bob = "|p" if robot.n < 3 else ""  # x_p of a pendulum; of other arms p is any point
        entries, wrist = dict[str, tuple[int, int]](), dict[str, int]()
        letter = "[rR]" if robot.has_dynamics else "[rRm]"  # with links m_12 is an entry of the inertia matrix
        for word, short in flat.items():
            if found := re.fullmatch(rf"{letter}([123])([123])|[tT]([123])([1234])", short):
                row, column = [int(group) for group in found.groups() if group]
                entries[word] = row, column
            elif found := _COLUMN.fullmatch(short):
                column = 4 if found[1] == "o" and o_is_position else _COLUMNS[found[1].lower()]
                entries[word] = "xyz".index(found[2]) + 1, column
            elif found := re.fullmatch(rf"(?:EE|[pP]{_END})?([xyzXYZ])|([xyzXYZ])(?:{_END}|t|T{bob})", short):
                entries[word] = "xyz".index((found[1] or found[2]).lower()) + 1, 4
            elif found := re.fullmatch(rf"[pPoO]?{_WRIST}([xyzXYZ])|([xyzXYZ]){_WRIST}", short):
                wrist[word] = "xyz".index((found[1] or found[2]).lower())
        # one configuration with stand-in numbers tells whether the arm is planar and has a wrist
        lengths = {s: 0.3 + 0.1 * k for k, s in enumerate(geometry_symbols(robot))}
        example = _Arm(robot, lengths, [np.full(1, 0.4 + 0.3 * k) for k in range(robot.n)])
        is_planar = all(parallel(axis, example.arms[0].axes[0]) for axis in example.arms[0].axes) and robot.n > 1
        angle = (Name("(phi)"),)
        known: dict[str, Expression] = {"phi": angle[0], "cphi": Call("cos", angle), "sphi": Call("sin", angle)}
        plain = {word: short.replace("varphi", "phi") for word, short in flat.items()} if is_planar else {}
        angles = {word: known[name] for word, name in plain.items() if name in known}
        wrist = wrist if any_wrist or example.wrist is not None else {}
        relatives: dict[str, tuple[int, int]] = {}  # names with other indices, r21 beside r12, p_y beside p_x
        for word, (_, column) in entries.items():
            if word[-1].isdigit():
                columns = (1, 2, 3, 4) if word[0] in "tT" else (1, 2, 3)
                relatives |= {f"{word[:-2]}{i}{j}": (i, j) for i in (1, 2, 3) for j in columns}
            else:
                relatives |= {f"{word[:-1]}{axis}": (i, column) for i, axis in enumerate("xyz", 1)}
        relatives = {name: at for name, at in relatives.items() if name not in own and name not in words}
        return cls(robot, entries, wrist, angles, relatives)

    @property
    def meanings(self) -> dict[str, Expression]:
        """What the names stand for: themselves, or the angle of a planar arm."""
        return {**{name: Name(name) for name in (*self.entries, *self.wrist)}, **self.angles}

    @property
    def rows(self) -> tuple[str, ...]:
        """The rows of a task that says as much as these names do; none where they say less than a position."""
        if any(column < 4 for _, column in self.entries.values()):
            return ()
        found = {*(row - 1 for row, _ in self.entries.values()), *self.wrist.values()}
        return (*("xyz"[k] for k in sorted(found)), *(("phi",) if self.angles else ()))


class _Arm:
    """An arm of numbers at k configurations: its pose in three rows of four arrays (k,), its axes at each of them."""

    def __init__(self, robot: Robot, values: Mapping[str, float], q: list[npt.NDArray[np.float64]]) -> None:
        self._robot = plain = replace(robot, links=(), gravity=None)
        known = {sympy.Symbol(name): mpmath.mpf(value) for name, value in values.items()}
        self._size = len(q[0])
        chain = build_chain(plain, ArrayDomain(plain, q, known))
        end = forward_kinematics(chain)
        rows = [[*row, x] for row, x in zip(end.rotation, end.position, strict=True)]
        self.pose = [[np.broadcast_to(np.asarray(x, dtype=np.float64), self._size) for x in row] for row in rows]
        self.arms = placed(chain, q, self._size)

    @property
    def wrist(self) -> npt.NDArray[np.float64] | None:
        """Where the last three axes meet, (k, 3) [m]; of three joints the last one or the end; None of others."""
        centres = [self._centre(arm) for arm in self.arms]
        found = [centre for centre in centres if centre is not None]
        return np.array(found) if len(found) == len(centres) else None

    def _centre(self, arm: Placed) -> npt.NDArray[np.float64] | None:
        if len(arm.axes) == 3:
            is_planar = all(parallel(axis, arm.axes[0]) for axis in arm.axes) and self._robot.joints[2].is_revolute
            return arm.points[2] if is_planar else arm.end
        if len(arm.axes) < 6 or not all(joint.is_revolute for joint in self._robot.joints[-3:]):
            return None
        return common_point(arm.points[-3:], arm.axes[-3:])


def places(names: PoseNames, sums: Mapping[str, Expression], *, numbers: bool = False) -> tuple[Place, ...]:
    """Random configurations with everything that a formula may know; the same ones each time."""
    return tuple(place for batch in range(BATCHES) for place in _places(names, sums, random.Random(batch), numbers))


def pose_of(robot: Robot, values: Mapping[str, float]) -> list[list[float]]:
    """The pose of an arm at one configuration, the first three rows of T (3, 4)."""
    q = [np.array([values[joint.variable]]) for joint in robot.joints]
    arm = _Arm(robot, {name: values[name] for name in geometry_symbols(robot)}, q)
    return [[float(x[0]) for x in row] for row in arm.pose]


def _places(names: PoseNames, sums: Mapping[str, Expression], rng: random.Random, numbers: bool) -> Iterator[Place]:
    robot = names.robot
    # lengths from 0.2 to 1.5: none vanishes beside another
    drawn = {name: rng.randint(20, 150) / 100 for name in geometry_symbols(robot)}
    values = {**drawn, **{n: float(x) for n, x in parameter_values(robot).items()}} if numbers else drawn
    q, required = [], np.ones(CONFIGURATIONS, dtype=bool)
    for joint in robot.joints:
        if joint.is_revolute:
            own = np.array([rng.choice(ANGLES) for _ in range(CONFIGURATIONS)])
        elif limits := _limits(joint.limits, values):
            own = np.array([round(rng.uniform(*limits), 2) for _ in range(CONFIGURATIONS)])
        else:
            # books take slides for positive: a third is negative, and need not be given
            own = np.array([rng.choice((1, 1, -1)) * rng.randint(20, 150) / 100 for _ in range(CONFIGURATIONS)])
            required &= own > 0
        q.append(own)
    arm = _Arm(robot, values, q)
    centre, entries = arm.wrist if names.wrist else None, {**names.relatives, **names.entries}
    for k in range(CONFIGURATIONS):
        known = {**values, **{joint.variable: float(x[k]) for joint, x in zip(robot.joints, q, strict=True)}}
        known.update({name: float_value(meaning, known) for name, meaning in sums.items()})
        known.update({name: float(arm.pose[i - 1][j - 1][k]) for name, (i, j) in entries.items()})
        known["(phi)"] = float(np.arctan2(arm.pose[1][0][k], arm.pose[0][0][k]))
        if centre is not None:
            known.update({name: float(centre[k][axis]) for name, axis in names.wrist.items()})
        yield Place(known, [[float(x[k]) for x in row] for row in arm.pose], bool(required[k]))


def _limits(limits: tuple[Expression, Expression] | None, values: Mapping[str, float]) -> tuple[float, float] | None:
    """The range of a slide, where the file gives one."""
    known = {name: Fraction(value) for name, value in values.items()}
    with suppress(ArithmeticError, DeriveError):
        low, high = (evaluate(limit, known) for limit in limits) if limits else (0, 0)
        return (low, high) if low < high else None
    return None


def geometry_symbols(robot: Robot) -> tuple[str, ...]:
    """Symbols of the table, without those of masses, inertias and gravity."""
    return robot_symbols(replace(robot, links=(), gravity=None))
