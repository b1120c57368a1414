"""The branches of a graph by name, in the one order that print and generated code have.

At random reachable poses the arm is looked at in each of its solutions. A word is given where it holds at most of them,
and to which leaf of the graph a printed solution leads gives its place. Arms that change their posture without meeting
a singularity (cuspidal arms, Wenger, 2007) have no such words.

- shoulder: on which side of axis 1 the arm stands, seen towards the wrist; that of the offset along axis 2, or of axis
  2 itself where there is none;
- elbow: above or below the line from the shoulder to the wrist, left or right of it where axes are vertical; of a
  planar arm as it is drawn, reaching to the right;
- wrist: flipped where the angle from the axis before to the axis behind its middle joint is negative.
"""

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import GraphWalk, SolutionGraph
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.floats import ArrayDomain
from derive.mechanics.forward_kinematics import forward_kinematics, joint_poses
from derive.robot.evaluate import Values, parameter_values, to_float
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

SMALL = 1e-9  # sines and lengths (in parts of the reach) below it are zero
# Part of the poses at which a word has to hold: the elbow of an arm that reaches behind its shoulder hangs down.
MOSTLY = 2 / 3
LOOKED_AT = 60  # random poses at which the arm is looked at
_KEPT = 32  # graphs whose branches are kept for those who ask again


class Word(StrEnum):
    """What is said of one part of the arm."""

    SHOULDER_RIGHT = "shoulder right"
    SHOULDER_LEFT = "shoulder left"
    ELBOW_UP = "elbow up"
    ELBOW_DOWN = "elbow down"
    ELBOW_LEFT = "elbow left"
    ELBOW_RIGHT = "elbow right"
    WRIST = "wrist not flipped"
    WRIST_FLIPPED = "wrist flipped"


@dataclass(frozen=True)
class Placed:
    """An arm at one configuration."""

    points: Array  # a point of each joint's axis, (n, 3)
    axes: Array  # its direction, (n, 3)
    end: Array  # the end effector
    q: Array  # the joint variables


def placed(chain: Chain[Any], q: Sequence[Any], samples: int) -> list[Placed]:
    """An arm at several configurations."""
    poses = joint_poses(chain)

    def _stacked(rows: Any) -> Array:
        return np.array([[np.broadcast_to(x, samples) for x in row] for row in rows], dtype=np.float64)

    points, axes = _stacked(pose.position for pose in poses), _stacked([row[2] for row in p.rotation] for p in poses)
    stacked = points, axes, _stacked([(poses[-1] @ chain.tool).position])[0], _stacked([q])[0]
    return [Placed(*(part[..., k] for part in stacked)) for k in range(samples)]


class Shape:
    """The middle joint of a wrist, the elbow (from 0), whether a shoulder turns it; ``up`` is against gravity."""

    def __init__(self, robot: Robot, example: Placed, up: Array) -> None:
        self._robot, n = robot, robot.n
        revolute = [joint.is_revolute for joint in robot.joints]
        axes = example.axes
        has_centre = n >= 6 or (n == 3 and common_point(example.points, axes) is not None)
        self.wrist = n - 2 if has_centre and all(revolute[-3:]) else None
        before = n if self.wrist is None else n - 3
        self.elbow: int | None = None
        self._upper = 0
        for k in range(1, before):
            others = [j for j in range(k) if revolute[j]]
            if revolute[k] and others and parallel(axes[k], axes[others[-1]]):
                self.elbow, self._upper = k, others[-1]
                break
        self.shoulder = before > 1 and revolute[0] and revolute[1] and abs(axes[0] @ axes[1]) < SMALL
        self._planar = all(revolute[:before]) and all(parallel(axes[0], axis) for axis in axes[:before])
        self._up = up

    def words(self, arm: Placed) -> tuple[str | None, ...]:
        """What is said of shoulder, elbow, slides and wrist; None where nothing can be said."""
        pairs = zip(self._robot.joints, arm.q, strict=True)
        slides = [f"{joint.variable} {'>' if x > 0 else '<'} 0" for joint, x in pairs if not joint.is_revolute]
        wrist = None
        if self.wrist is not None:
            before, middle, behind = arm.axes[self.wrist - 1 : self.wrist + 2]
            wrist = _either(_cross(before, behind) @ middle, Word.WRIST, Word.WRIST_FLIPPED)
        return (self._shoulder_word(arm), self._elbow_word(arm), *slides, wrist)

    def signs(self, arm: Placed) -> tuple[str | None, ...]:
        """On which side of zero each joint angle is, for branches that words do not tell apart."""
        pairs = zip(self._robot.joints, arm.q, strict=True)
        return tuple(f"{j.variable} {'>' if np.sin(x) > 0 else '<'} 0" if j.is_revolute else None for j, x in pairs)

    def _centre(self, arm: Placed) -> Array:
        """The centre of the wrist, or the end effector."""
        if self.wrist is None:
            return arm.end
        k = self.wrist
        return nearest(arm.points[k], arm.axes[k], arm.points[k + 1], arm.axes[k + 1])

    def _shoulder_word(self, arm: Placed) -> Word | None:
        if not self.shoulder:
            return None
        first, second = arm.axes[:2]
        # The side of axis 1 on which the wrist is: the offset along axis 2, seen outwards.
        reach = self._centre(arm) - arm.points[0]
        left = _cross(first, reach - (reach @ first) * first) @ second
        offset = (self._centre(arm) - arm.points[1]) @ second
        return _either(left * offset if abs(offset) > SMALL else -left, Word.SHOULDER_LEFT, Word.SHOULDER_RIGHT)

    def _elbow_word(self, arm: Placed) -> Word | None:
        if self.elbow is None:
            return None
        axis, elbow, shoulder = arm.axes[self._upper], arm.points[self.elbow], arm.points[self._upper]
        following = self.elbow + 1
        robot = self._robot
        if following < robot.n and robot.joints[following].is_revolute and parallel(arm.axes[following], axis):
            hand = arm.points[following]
        else:
            hand = self._centre(arm)
        # In the plane across the elbow's axis: is the elbow above the line from shoulder to hand?
        line, bend = (v - (v @ axis) * axis for v in (hand - shoulder, elbow - shoulder))
        side = float(_cross(line, bend) @ axis)
        if self._planar:  # as an arm is drawn that reaches to the right
            return _either(side, Word.ELBOW_UP, Word.ELBOW_DOWN)
        if abs(axis @ self._up) < 1 - SMALL:
            return _either(((line @ line) * bend - (bend @ line) * line) @ self._up, Word.ELBOW_UP, Word.ELBOW_DOWN)
        return _either(side * (axis @ self._up), Word.ELBOW_LEFT, Word.ELBOW_RIGHT)


def branch_names(shape: Shape, seen: Sequence[Sequence[Placed]], otherwise: Sequence[str]) -> list[str]:
    """A name for each branch."""
    names = [""] * len(seen)
    for words in (shape.words, shape.signs):
        for part in zip(*(zip(*map(words, arms), strict=True) for arms in seen), strict=True):
            counted = [Counter(found).most_common(1)[0] for found in part]
            pairs = zip(counted, part, strict=True)
            holds = all(word is not None and count >= MOSTLY * len(found) for (word, count), found in pairs)
            longer = [f"{name}, {word}" if name else str(word) for name, (word, _) in zip(names, counted, strict=True)]
            if holds and len(set(longer)) > len(set(names)):
                names = longer
    numbered = [f"{name}, {own}" if name else own for name, own in zip(names, otherwise, strict=True)]
    return [name if names.count(name) == 1 else own for name, own in zip(names, numbered, strict=True)]


def _either(value: float, positive: Word, negative: Word) -> Word | None:
    return None if abs(value) < SMALL else positive if value > 0 else negative


def parallel(a: Array, b: Array) -> bool:
    """Whether two directions are the same or opposite."""
    return bool(np.linalg.norm(_cross(a, b)) < SMALL)


def common_point(points: Array, axes: Array) -> Array | None:
    """The point through which three axes go (Pieper's condition); None where there is none, or two are parallel."""
    (p, q, r), (a, b, c) = points, axes
    if parallel(a, b) or parallel(b, c):
        return None
    centre = nearest(p, a, q, b)
    gaps = (_cross(centre - point, axis) for point, axis in ((p, a), (q, b), (r, c)))
    return centre if all(np.linalg.norm(gap) < SMALL for gap in gaps) else None


def nearest(p: Array, a: Array, q: Array, b: Array) -> Array:
    """The point of one line that is nearest to another."""
    normal = _cross(a, b)
    square = float(normal @ normal)
    return p if square < SMALL else p + (_cross(q - p, b) @ normal) / square * a


def _cross(a: Array, b: Array) -> Array:
    """a x b of two vectors, in a tenth of the time that NumPy takes for so few."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array((y * w - z * v, z * u - x * w, x * v - y * u))


@dataclass(frozen=True, eq=False)
class Postures:
    """The branches of a graph at some poses."""

    # What each is called; ``#3`` where words do not tell the third one from others, empty where it is the only one or
    # exists at none of the poses.
    names: tuple[str, ...]
    parameters: Values  # numbers of the parameters: those of the file, random ones for the others
    q: Array  # (n, poses) the configurations that the poses are made of
    branches: tuple[Array, ...]  # (n, poses) for each branch, not a number where it does not exist

    def places(self, printed: Sequence[Array]) -> list[int]:
        """To which branch each of as many solutions, (n, poses) or NaN, leads most often; each to another one."""
        hits: Counter[tuple[int, int]] = Counter()
        with np.errstate(invalid="ignore"):
            for k, own in enumerate(printed):
                among = self.branches[: len(printed)]
                apart = [np.abs(np.exp(1j * own) - np.exp(1j * branch)).sum(axis=0) for branch in among]
                real = np.isfinite(own).all(axis=0) & np.isfinite(apart).any(axis=0)
                nearest = np.argmin(np.where(np.isfinite(apart), apart, np.inf), axis=0)[real]
                hits.update((k, int(place)) for place in nearest)
        found, places = dict[int, int](), range(len(printed))
        for k, place in (*(pair for pair, _ in hits.most_common()), *product(places, places)):
            if k not in found and place not in found.values():
                found[k] = place
        return [found[k] for k in places]


@lru_cache(_KEPT)
def postures(robot: Robot, graph: SolutionGraph) -> Postures:
    """The branches of an arm."""
    rng = np.random.default_rng(12)
    numbers, known = random.Random(12), parameter_values(robot)
    for name in robot_symbols(robot):
        known.setdefault(name, Fraction(numbers.randint(20, 90), 97))
    q = np.stack([rng.uniform(*((-3, 3) if j.is_revolute else (-1, 1)), LOOKED_AT) for j in robot.joints])
    end = forward_kinematics(_chain(robot, known, q))
    rows = [[np.broadcast_to(x, LOOKED_AT) + 0.0 for x in row] for row in end.rows(0.0, 1.0)[:3]]
    run: GraphWalk[Any, Any] = GraphWalk(graph, FloatField(known), rows, [q[k] for k in graph.given])
    branches = []
    with np.errstate(all="ignore"):  # where a branch does not exist its numbers are any
        for leaf in run.leaves():
            own = np.stack([np.broadcast_to(x, LOOKED_AT) + 0.0 for x in run.angles(leaf)])
            exists = np.broadcast_to(leaf.exists, LOOKED_AT) & np.isfinite(own).all(axis=0)
            branches.append(np.where(exists, own, np.nan))
    # Words for the branches where they hold wherever the arm is looked at, else their numbers.
    names = [""] * len(branches)
    real = [own[:, np.isfinite(own).all(axis=0)] for own in branches]
    met = [k for k, own in enumerate(real) if own.size]
    if len(branches) > 1 and met:
        seen = [placed(_chain(robot, known, real[k]), list(real[k]), real[k].shape[1]) for k in met]
        # The direction against gravity, where the robot file has one; a symbol in it counts as positive.
        against = [-to_float(cell, dict.fromkeys(robot_symbols(robot), 1)) for cell in robot.gravity or ()]
        up = np.array(against) / np.linalg.norm(against) if any(against) else np.array([0.0, 0.0, 1.0])
        shape = Shape(robot, placed(_chain(robot, known, q), list(q), LOOKED_AT)[0], up)
        for k, name in zip(met, branch_names(shape, seen, [f"#{k + 1}" for k in met]), strict=True):
            names[k] = name
    return Postures(tuple(names), known, q, tuple(branches))


def _chain(robot: Robot, known: Values, q: Array) -> Chain[Any]:
    bare = replace(robot, links=(), gravity=None)
    return build_chain(bare, ArrayDomain(bare, list(q), known))
