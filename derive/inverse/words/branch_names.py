"""What the branches of a solution are called: shoulder left or right, elbow up or down, wrist flipped or not.

The words are found by looking: at random poses the arm stands in each of its solutions, and a word is given where it
holds at most of them. Arms that change their posture without meeting a singularity (cuspidal arms, Wenger, 2007)
have no such words.

- shoulder: on which side of axis 1 the arm stands, seen towards the wrist; that of the offset along axis 2, or of axis
  2 itself where there is none;
- elbow: above or below the line from the shoulder to the wrist, left or right of it where axes are vertical; of a
  planar arm as it is drawn, reaching to the right;
- wrist: flipped where the angle from the axis before to the axis behind its middle joint is negative.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.mechanics.chain import Chain
from derive.mechanics.forward_kinematics import joint_poses
from derive.robot.robot import Robot

Vector = npt.NDArray[np.float64]

SMALL = 1e-9  # sines and lengths (in parts of the reach) below it are zero
# Part of the poses at which a word has to hold: the elbow of an arm that reaches behind its shoulder hangs down.
MOSTLY = 2 / 3


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

    points: Vector  # a point of each joint's axis, (n, 3)
    axes: Vector  # its direction, (n, 3)
    end: Vector  # the end effector
    q: Vector  # the joint variables


def placed(chain: Chain[Any], q: Sequence[Any], samples: int) -> list[Placed]:
    """An arm at several configurations."""
    poses = joint_poses(chain)
    points = [[np.broadcast_to(x, samples) for x in pose.position] for pose in poses]
    axes = [[np.broadcast_to(row[2], samples) for row in pose.rotation] for pose in poses]
    end = [np.broadcast_to(x, samples) for x in (poses[-1] @ chain.tool).position]
    stacked = [
        np.asarray(part, dtype=np.float64) for part in (points, axes, end, [np.broadcast_to(x, samples) for x in q])
    ]
    return [Placed(*(part[..., k] for part in stacked)) for k in range(samples)]


class Shape:
    """Which parts an arm has.

    Args:
        up: The direction against gravity; None where the file does not say.

    Attributes:
        wrist: The middle joint of its wrist (from 0), None without one.
        elbow: The joint that bends it, None without one.
        shoulder: Whether there is a joint that turns the whole arm.
    """

    def __init__(self, robot: Robot, example: Placed, up: Vector | None) -> None:
        self._robot, n = robot, robot.n
        revolute = [joint.is_revolute for joint in robot.joints]
        axes = example.axes
        self.wrist: int | None = None
        if (n >= 6 or (n == 3 and _meet(example))) and all(revolute[-3:]):
            self.wrist = n - 2
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
        self._up = np.array([0.0, 0.0, 1.0]) if up is None else up

    def words(self, arm: Placed) -> tuple[str | None, ...]:
        """What is said of shoulder, elbow, slides and wrist; None where nothing can be said."""
        slides = [
            f"{joint.variable} {'>' if value > 0 else '<'} 0"
            for joint, value in zip(self._robot.joints, arm.q, strict=True)
            if not joint.is_revolute
        ]
        return (self._shoulder_word(arm), self._elbow_word(arm), *slides, self._wrist_word(arm))

    def signs(self, arm: Placed) -> tuple[str | None, ...]:
        """On which side of zero each joint angle is, for branches that words do not tell apart."""
        return tuple(
            f"{joint.variable} {'>' if np.sin(value) > 0 else '<'} 0" if joint.is_revolute else None
            for joint, value in zip(self._robot.joints, arm.q, strict=True)
        )

    def _centre(self, arm: Placed) -> Vector:
        """The centre of the wrist, or the end effector."""
        if self.wrist is None:
            return arm.end
        return nearest(
            arm.points[self.wrist], arm.axes[self.wrist], arm.points[self.wrist + 1], arm.axes[self.wrist + 1]
        )

    def _shoulder_word(self, arm: Placed) -> Word | None:
        if not self.shoulder:
            return None
        first, second = arm.axes[:2]
        # The side of axis 1 on which the wrist is: the offset along axis 2, seen outwards.
        reach = self._centre(arm) - arm.points[0]
        outwards = reach - (reach @ first) * first
        left = _cross(first, outwards) @ second
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
            above = (line @ line) * bend - (bend @ line) * line
            return _either(above @ self._up, Word.ELBOW_UP, Word.ELBOW_DOWN)
        return _either(side * (axis @ self._up), Word.ELBOW_LEFT, Word.ELBOW_RIGHT)

    def _wrist_word(self, arm: Placed) -> Word | None:
        if self.wrist is None:
            return None
        before, middle, behind = arm.axes[self.wrist - 1 : self.wrist + 2]
        return _either(_cross(before, behind) @ middle, Word.WRIST, Word.WRIST_FLIPPED)


def branch_names(shape: Shape, seen: Sequence[Sequence[Placed]], otherwise: Sequence[str]) -> list[str]:
    """A name for each branch."""
    names = [""] * len(seen)
    for words in (shape.words, shape.signs):
        for part in zip(*(zip(*map(words, arms), strict=True) for arms in seen), strict=True):
            counted = [Counter(found).most_common(1)[0] for found in part]
            holds = all(
                word is not None and count >= MOSTLY * len(found)
                for (word, count), found in zip(counted, part, strict=True)
            )
            longer = [
                ", ".join(filter(None, (name, str(word)))) for name, (word, _) in zip(names, counted, strict=True)
            ]
            if holds and len(set(longer)) > len(set(names)):
                names = longer
    return [
        name if names.count(name) == 1 else ", ".join(filter(None, (name, signs)))
        for name, signs in zip(names, otherwise, strict=True)
    ]


def _either(value: float, positive: Word, negative: Word) -> Word | None:
    return None if abs(value) < SMALL else positive if value > 0 else negative


def parallel(a: Vector, b: Vector) -> bool:
    """Whether two directions are the same or opposite."""
    return bool(np.linalg.norm(_cross(a, b)) < SMALL)


def _meet(arm: Placed) -> bool:
    """Whether three axes go through one point, and not all in one direction."""
    (p, q, r), (a, b, c) = arm.points, arm.axes
    if parallel(a, b) or parallel(b, c):
        return False
    centre = nearest(p, a, q, b)
    gaps = (_cross(centre - point, axis) for point, axis in ((p, a), (q, b), (r, c)))
    return all(np.linalg.norm(gap) < SMALL for gap in gaps)


def nearest(p: Vector, a: Vector, q: Vector, b: Vector) -> Vector:
    """The point of one line that is nearest to another."""
    normal = _cross(a, b)
    square = float(normal @ normal)
    if square < SMALL:
        return p
    found: Vector = p + (_cross(q - p, b) @ normal) / square * a
    return found


def _cross(a: Vector, b: Vector) -> Vector:
    """a x b of two vectors, in a tenth of the time that NumPy takes for so few."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array((y * w - z * v, z * u - x * w, x * v - y * u))
