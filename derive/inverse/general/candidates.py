"""From eigenvalues and vectors to joints: candidates for solutions of an arm.

A nearly real eigenvalue gives the hidden joint, ratios of entries of its vector the others between which the equations
hold (`derive.inverse.general.elimination`). The joints that were eliminated follow from the motion that is left between
them, the middle one first, from linear equations.
"""

import math
from dataclasses import dataclass

import numpy as np

from derive.inverse.general.closure import Closure, Loop, middle_part
from derive.inverse.general.elimination import POLICY, EigenProblem
from derive.inverse.general.rigid_motion import Array, motion_by, pose_features, rigid_inverse


@dataclass(frozen=True, eq=False)
class Candidates:
    """Values of the unknown joints that may belong to solutions."""

    place: Array  # (candidates,) the pose that each belongs to
    joints: Array  # (candidates, joints of the loop), NaN for the joints that are not known yet
    doubtful: Array  # (poses,) where eigenvalues coincide: solutions may share one, and its vectors mix


def candidates(problem: EigenProblem, pose: Array, real: float = POLICY.real) -> Candidates:
    """Values of the unknown joints from eigenvalues that are nearly real."""
    values, vectors, turn, singular = problem.eigen(pose)
    loop, hidden = problem.loop, problem.elimination.hidden
    size = 1.0 + np.abs(values) ** 2
    hides = problem.position(turn[:, None], values.real)
    # Double roots come as pairs with small imaginary parts, so nearly real eigenvalues are candidates, too.
    near = (np.abs(values.imag) <= real * size) & (loop.revolute[hidden] | (np.abs(hides) < POLICY.far))
    near &= np.isfinite(values)
    place, which = np.nonzero(near)
    # Neighbours on the circle of angles: where two coincide their eigenvectors span a space and may be mixed.
    line = np.sort(np.where(near, np.arctan(values.real), np.nan), axis=1)
    doubtful: Array = singular | np.any(np.diff(line, axis=1) < POLICY.shared, axis=1)
    joints = np.full((len(place), loop.n), np.nan)
    v = vectors[place, :, which]
    joints[:, hidden] = hides[place, which]
    # An eigenvector is known but for a complex factor: divided by its largest entry it is real.
    largest = np.take_along_axis(v, np.abs(v).argmax(axis=1)[:, None], axis=1)
    v = (v / np.where(largest == 0, 1.0, largest)).real.reshape(len(v), *problem.shape)
    for axis, joint in enumerate(problem.others):
        length = problem.shape[axis]
        # v is a product of one vector for each joint: every line along its axis is a multiple of that vector;
        # the longest one has lost fewest digits.
        lines = np.moveaxis(v, 1 + axis, -1).reshape(len(v), math.prod(problem.shape) // length, length)
        line = np.take_along_axis(lines, (lines**2).sum(axis=-1).argmax(axis=1)[:, None, None], axis=1)[:, 0]
        joints[:, joint] = _position(line, loop.revolute[joint])
    return Candidates(place, joints, doubtful)


def finished(problem: EigenProblem, found: Candidates, pose: Array) -> Candidates:
    """The same with the eliminated joints, which the motion between them determines."""
    way, loop = problem.elimination.finish, problem.loop
    if loop.tip:
        return _last_joint(problem, found, pose)
    # The joints that are known are locked: a chain of the three eliminated ones is left.
    motions = [
        None if joint in way.order[:3] else motion_by(loop.revolute[joint], found.joints[:, joint])
        for joint in range(loop.n)
    ]
    gaps = tuple(gap if gap.ndim == 2 else np.broadcast_to(gap, (len(pose), 4, 4))[found.place] for gap in loop.gaps)
    left = Loop(loop.revolute, gaps).locked(motions)
    values = _three_joints(left, way.alone, pose[found.place])
    joints = np.repeat(found.joints[None], len(values), axis=0)
    joints[:, :, np.sort(way.order[:3])] = values
    return Candidates(np.tile(found.place, len(values)), joints.reshape(-1, loop.n), found.doubtful)


def _last_joint(problem: EigenProblem, found: Candidates, pose: Array) -> Candidates:
    """The one eliminated joint of an arm whose end's position is wanted, from linear equations."""
    way, loop = problem.elimination.finish, problem.loop
    # The known joints put into the multilinear forms one after the other: numbers are left on the right.
    right = way.unknown_part(loop, pose_features(pose))[found.place]
    for joint in way.unknowns:
        value = found.joints[:, joint]
        line = (np.ones_like(value), *((np.cos(value), np.sin(value)) if loop.revolute[joint] else (value, value**2)))
        right = np.einsum("nmk...,nk->nm...", right, np.stack(line, axis=-1))
    part = np.broadcast_to(way.eliminated_part(loop), (len(pose), right.shape[1], 3))[found.place]
    values = _middle_joint(loop.revolute[way.order[1]], part[..., 1:], right - part[..., 0])
    joints = np.repeat(found.joints[None], len(values), axis=0)
    for own, value in zip(joints, values, strict=True):
        own[:, way.order[1]], own[:, -1] = value, 0.0
    return Candidates(np.tile(found.place, len(values)), joints.reshape(-1, loop.n), found.doubtful)


def _three_joints(loop: Loop, way: Closure, pose: Array) -> Array:
    """The positions of three joints that reach poses, (1 or 2, poses, 3).

    What the last one, c, does not change, seen from the first one, a: what a does not change either is linear in
    (1, cos, sin) of the middle one, b; the rest then gives a.
    """
    c, b, a = way.order
    sign, carried = -way.direction, loop.carried(c)
    # Z_a C Z_b C' Z_c = motion: what the three joints have to do between their outer gaps.
    motion = loop.product(loop.inverse(loop.gaps[0]), pose, loop.inverse(loop.gaps[-1]))
    motion = motion if sign > 0 else loop.inverse(motion)
    parts, near, far = middle_part(loop, way)
    # Axis c where the pose has it, in the frame of joint a.
    seen = carried.action(motion) @ carried.start
    # What turning (sliding) about a leaves alone: heights, distances (directions). Linear in (1, cos b, sin b).
    kept = list(carried.heights if loop.revolute[a] else carried.along)
    forms = np.broadcast_to(np.swapaxes(parts[..., 1:, kept], -1, -2), (len(pose), len(kept), 2))
    middle = _middle_joint(loop.revolute[b], forms, seen[:, kept] - parts[..., 0, kept])
    result = np.empty((len(middle), len(pose), 3))
    for value, row in zip(middle, result, strict=True):
        # With b known: axis c as it is with joint a at zero.
        before = near @ motion_by(loop.revolute[b], sign * value) @ far
        reference = carried.action(before) @ carried.start
        x, y = list(carried.crosswise), [k + 1 for k in carried.crosswise]
        if loop.revolute[a]:
            # Seen along axis a the two differ by a turn: the angle of least squares over all planar pairs.
            crosswise = reference[:, x] * seen[:, y] - reference[:, y] * seen[:, x]
            along = reference[:, x] * seen[:, x] + reference[:, y] * seen[:, y]
            first = np.arctan2(crosswise.sum(axis=1), along.sum(axis=1))
        else:
            moved = list(carried.shifted)
            # Along a slide they differ in proportion to its length: again by least squares.
            rate = (loop.joint_actions(carried, a, 1)[1] @ reference[..., None])[:, moved, 0]
            difference = (seen - reference)[:, moved]
            first = (rate * difference).sum(axis=1) / np.maximum((rate * rate).sum(axis=1), 1e-300)
        # What is left is Z_c alone.
        last = rigid_inverse(motion_by(loop.revolute[a], first) @ before) @ motion
        turned = np.arctan2(last[:, 1, 0] - last[:, 0, 1], last[:, 0, 0] + last[:, 1, 1])
        final = turned if loop.revolute[c] else last[:, 2, 3]
        row[:, a], row[:, b], row[:, c] = sign * first, value, sign * final
    return result


def _middle_joint(turns: bool, forms: Array, wanted: Array) -> list[Array]:
    """The joint from equations X c + Y s = Z or X d + Y d^2 = Z; two values where all are multiples of one."""
    # By singular values: rank 2 determines cosine and sine, rank 1 leaves X c + Y s = Z with two solutions.
    left, sizes, right = np.linalg.svd(forms, full_matrices=False)
    known = (np.swapaxes(left, -1, -2) @ wanted[..., None])[..., 0] / np.maximum(sizes, 1e-100)
    if not len(sizes) or sizes[:, 1].max() > 1e-7 * max(1.0, sizes[:, 0].max()):
        first, second = np.moveaxis((np.swapaxes(right, -1, -2) @ known[..., None])[..., 0], -1, 0)
        return [np.arctan2(second, first) if turns else first]
    x, y, z = right[:, 0, 0], right[:, 0, 1], known[:, 0]
    if turns:
        # (x, y) is a unit vector: cos(b - middle) = z.
        middle, off = np.arctan2(y, x), np.arccos(np.clip(z, -1.0, 1.0))
        return [middle + off, middle - off]
    root = np.sqrt(np.maximum(x * x + 4.0 * y * z, 0.0))
    # r^2 y + r x = z by the stable form; the second root is infinite where y = 0
    large = x + np.where(x < 0, -root, root)
    with np.errstate(divide="ignore", invalid="ignore"):
        return [2.0 * z / large, np.where(np.abs(y) > 1e-12, -large / (2.0 * y), 2.0 * z / large)]


def _position(line: Array, turns: bool) -> Array:
    """The joint from a multiple of (1, c, s), of (1, d, ...), or of cosines and sines of 3/2 and 1/2 of its angle."""
    if turns and line.shape[1] == 4:
        position: Array = 2.0 * np.arctan2(line[:, 3], line[:, 2])
    elif turns:
        sign = np.where(line[:, 0] < 0, -1.0, 1.0)
        position = np.arctan2(line[:, 2] * sign, line[:, 1] * sign)
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            position = np.nan_to_num(line[:, 1] / line[:, 0])
    return position
