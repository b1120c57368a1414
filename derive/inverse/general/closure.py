"""Equations that hold between three joints of a closed chain, whatever the other three do.

The arm and its pose are a closed loop,

    C_0 Z_1 C_1 Z_2 ... Z_n C_n T^-1 = 1,

with Z_i the motion of joint i about or along z. The numbers of joint d (`derive.inverse.general.rigid_motion.Carried`)
do not feel Z_d. Carried around the loop from there over the two joints beside it, they are linear in the nine products
of (1, c, s) of these two; carried around the other way, they are multilinear in the (1, c, s) of the others.
Combinations in which the nine products cancel are equations between the others alone. For a slide (1, d, d^2) take the
place of (1, c, s).

All of it runs over floats and over integers modulo a prime alike, so that ranks are found exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np

from derive.inverse.general.rigid_motion import (
    AXIS,
    FRAME,
    POINT,
    Array,
    Carried,
    inverse_features,
    joint_motion,
    rigid_inverse,
)


@dataclass(frozen=True, eq=False)
class Loop:
    """A numeric arm as constant motions between its joints: T = C_0 Z_1 C_1 ... Z_n C_n."""

    revolute: tuple[bool, ...]  # whether each joint turns
    gaps: tuple[Array, ...]  # C_0 to C_n, each (4, 4), or one for each pose
    prime: int = 0  # the numbers are integers modulo this prime; 0 for floats
    # Whether the last "joint" is a ball joint at the end effector: its position is wanted, not how it is turned.
    tip: bool = False

    @property
    def n(self) -> int:
        """Number of joints, a ball joint at the end included."""
        return len(self.revolute)

    def settle(self, values: Array) -> Array:
        """Numbers reduced modulo the prime."""
        return values % self.prime if self.prime else values

    def product(self, *matrices: Array) -> Array:
        """The product of matrices."""
        return reduce(lambda a, b: self.settle(a @ b), matrices)

    def inverse(self, frame: Array) -> Array:
        """The inverse of rigid motions."""
        return self.settle(rigid_inverse(frame))

    def carried(self, joint: int) -> Carried:
        """What a joint does not change."""
        if self.tip and joint == self.n - 1:
            return POINT
        return AXIS if self.revolute[joint] else FRAME

    @property
    def with_tip(self) -> Loop:
        """The same arm with a ball joint at its end."""
        unit = np.eye(4, dtype=int).astype(self.gaps[0].dtype)
        return replace(self, revolute=(*self.revolute, True), gaps=(*self.gaps, unit), tip=True)

    def pose(self, motions: Sequence[Array]) -> Array:
        """T."""
        frames = [self.gaps[0]]
        for motion, gap in zip(motions, self.gaps[1:], strict=True):
            frames += [motion, gap]
        return self.product(*frames)

    def locked(self, motions: Sequence[Array | None]) -> Loop:  # Z of each known joint, None for the others
        """The loop of the joints that are left when some have known positions."""
        gaps = [self.gaps[0]]
        for motion, gap in zip(motions, self.gaps[1:], strict=True):
            if motion is None:
                gaps.append(gap)
            else:
                gaps[-1] = self.product(gaps[-1], motion, gap)
        left = tuple(turns for turns, motion in zip(self.revolute, motions, strict=True) if motion is None)
        return replace(self, revolute=left, gaps=tuple(gaps))

    def rotated(self, start: int, pose: Array) -> tuple[Loop, Array]:
        """The same loop read from another joint on, with the pose among its gaps."""
        # The loop closes over the pose, C_n T^-1 C_0, which becomes one of its gaps.
        around = self.product(self.gaps[-1], self.inverse(pose), self.gaps[0])
        unit = np.eye(4, dtype=int).astype(around.dtype)
        gaps = (unit, *self.gaps[start + 1 : -1], around, *self.gaps[1:start], unit)
        constant = np.broadcast_to(self.inverse(self.gaps[start]), pose.shape)
        return replace(self, revolute=self.revolute[start:] + self.revolute[:start], gaps=gaps), constant

    def joint_actions(self, carried: Carried, joint: int, sign: int) -> Array:
        """(3, 15, 15): the action of Z_joint^sign is the sum of these times 1, c, s (or 1, d, d^2)."""
        kind = self.gaps[0].dtype
        if self.revolute[joint]:
            # An action is affine in (c, s): its parts are sums and differences of its values at quarter turns.
            points = np.array([[1, 0], [-1, 0], [0, sign], [0, -sign]]).astype(kind)
            actions = carried.action(joint_motion(True, points[:, 0], points[:, 1]))
            parts = [actions[0] + actions[1], actions[0] - actions[1], actions[2] - actions[3]]
        else:
            # Quadratic in d: by its values at 0, 1 and -1.
            actions = carried.action(joint_motion(False, np.array([0, sign, -sign]).astype(kind)))
            parts = [2 * actions[0], actions[1] - actions[2], actions[1] + actions[2] - 2 * actions[0]]
        half: Any = (self.prime + 1) // 2 if self.prime else 0.5
        return self.settle(np.stack(parts) * half)


@dataclass(frozen=True)
class Closure:
    """Whose numbers are carried around the loop, and which way."""

    joints: int  # number of joints of the loop
    dropped: int  # index of the joint that does not change them
    direction: int  # +1 towards the hand, -1 towards the base
    eliminated: int = 2  # how many joints beside the dropped one are eliminated

    @property
    def order(self) -> tuple[int, ...]:
        """The joints in order around the loop: the dropped one, the eliminated ones, then the unknown ones."""
        return tuple((self.dropped + self.direction * k) % self.joints for k in range(self.joints))

    @property
    def unknowns(self) -> tuple[int, ...]:
        """The joints between which equations hold, in order."""
        return tuple(sorted(self.order[1 + self.eliminated :]))

    @property
    def pose_gap(self) -> int:
        """The place in this order after which the pose lies."""
        return self.order.index(self.joints - 1 if self.direction > 0 else 0)

    @property
    def is_constant(self) -> bool:
        """Whether the pose is not met among what is eliminated."""
        return self.pose_gap >= self.eliminated

    @property
    def aligned(self) -> int | None:
        """The unknown joint next to the eliminated ones, where the pose does not lie between."""
        return self.order[1 + self.eliminated] if self.pose_gap > self.eliminated else None

    @property
    def alone(self) -> Closure:
        """The same way around a loop of the dropped and the eliminated joints alone."""
        return Closure(3, 2 if self.direction < 0 else 0, self.direction)

    def gap(self, loop: Loop, place: int) -> Array:
        """The constant motion after a place in the order, apart from the pose."""
        joint = self.order[place]
        return loop.gaps[joint + 1] if self.direction > 0 else loop.inverse(loop.gaps[joint])

    def action(self, loop: Loop, frame: Array) -> Array:
        """How rigid motions map the numbers that are carried around."""
        return loop.settle(loop.carried(self.dropped).action(frame))

    def eliminated_part(self, loop: Loop) -> Array:
        """The numbers as linear forms of the products of the eliminated joints, (..., numbers, 9 or 3)."""
        carried = loop.carried(self.dropped)
        forms = carried.start.astype(loop.gaps[0].dtype)[:, None]
        for place in range(self.eliminated):
            # The numbers are carried backwards over the gap, then over the joint, whose (1, c, s) become a new axis.
            back = self.action(loop, loop.inverse(self.gap(loop, place)))
            motion = loop.joint_actions(carried, self.order[place + 1], -self.direction)
            turned = loop.settle(motion @ loop.product(back, forms)[..., None, :, :])
            forms = np.moveaxis(turned, -3, -2).reshape(*turned.shape[:-3], len(carried.start), -1)
        if self.aligned is None:
            return forms
        return loop.product(self.action(loop, loop.inverse(self.gap(loop, self.eliminated))), forms)

    def unknown_part(self, loop: Loop, features: Array) -> Array:
        """The same numbers as multilinear forms of the unknown joints, for each pose: linear in its features.

        (poses, numbers, 3, 3, ...) with an axis for each unknown joint, in their order, of features (poses, 35).
        """
        # The other way around the loop, from the dropped joint over all unknown ones and over the pose.
        carried, count = loop.carried(self.dropped), len(features)
        start, end, size = 1 + self.eliminated, self.joints - 1, len(carried.start)
        forms = np.broadcast_to(carried.start.astype(features.dtype)[:, None], (count, size, 1))
        for place in range(end, self.eliminated - 1, -1):
            if place > self.eliminated or self.aligned is None:
                forms = self._across_gap(loop, place, features, forms)
            if place < start:
                break
            turned = loop.settle(loop.joint_actions(carried, self.order[place], self.direction) @ forms[:, None])
            forms = np.moveaxis(turned, 1, 2).reshape(count, size, -1)
        # Axes from the order in which the joints were met to that of the arm.
        places = np.argsort(self.order[start:])
        result: Array = forms.reshape(count, size, *[3] * (self.joints - start)).transpose(0, 1, *(2 + places))
        return result

    def _across_gap(self, loop: Loop, place: int, features: Array, forms: Array) -> Array:
        """Forms carried over the constant motion after a place in the order."""
        if place != self.pose_gap:
            return loop.product(self.action(loop, self.gap(loop, place)), forms)
        ends = loop.gaps[-1], loop.gaps[0]
        if self.direction < 0:
            ends = loop.inverse(ends[1]), loop.inverse(ends[0])
        else:
            # Towards the hand the loop is closed over T^-1.
            features = inverse_features(features)
        between = loop.settle(loop.carried(self.dropped).linear(features))
        return loop.product(self.action(loop, ends[0]), between, self.action(loop, ends[1]), forms)


def closures(loop: Loop) -> list[Closure]:
    """All ways around a loop on which the pose is not met among what is eliminated."""
    if loop.tip:
        return [Closure(loop.n, loop.n - 1, -1, eliminated=1)]
    ways = (Closure(loop.n, d, e) for d in range(loop.n) for e in (1, -1))
    return [way for way in ways if way.is_constant]


def middle_part(loop: Loop, way: Closure) -> tuple[Array, Array, Array]:
    """What the last of three joints carries, seen from the first one, over (1, c, s) of the middle one."""
    near, far = (loop.inverse(way.gap(loop, k)) for k in (1, 0))
    carried = loop.carried(way.dropped)
    parts = loop.joint_actions(carried, 1, -way.direction) @ (carried.action(far) @ carried.start)[..., None, :, None]
    return (carried.action(near)[..., None, :, :] @ parts)[..., 0], near, far
