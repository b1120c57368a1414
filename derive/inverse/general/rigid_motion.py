"""Rigid motions, and numbers of an axis, a frame or a point that they map linearly.

An axis through the point p with the unit vector l moves with a rigid motion. The fifteen numbers

    1, l, p, p.p, p.l, p x l, (p.p) l - 2 (p.l) p

of it (Raghavan and Roth, Inverse kinematics of the general 6R manipulator, J. Mech. Des. 115(3), 1993) are mapped
linearly by every rigid motion: `axis_action` is that matrix. So are fifteen numbers that a motion along the z axis of
a frame (x, y, z) at p leaves alone (`frame_action`),

    1, x, y, z, p.x, p.y, p x z.

All of it runs over floats and over integers modulo a prime alike.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

FEATURES = 35  # numbers of a rigid motion in which all these maps are linear
BESIDE = (
    (
        (0.9999995648001089, -0.0008000861999784501, -0.00047985588003603, 0.0006),
        (0.0007999134000216501, 0.9999996152000963, -0.0003601919099520225, 0.00064),
        (0.00048014387996402996, 0.0003598079100480225, 0.999999820000045, -0.00048),
    ),
    (
        (0.9997120647854233, -0.014569521857582044, 0.019066110125221823, 0.0144),
        (0.01422399960008998, 0.9997343797645529, 0.01813415981404184, -0.0108),
        (-0.019325251818340872, -0.017857742008048186, 0.9996537579044715, 0.024),
    ),
)
"""Motions by a thousandth and by three hundredths of a radian and of the unit of length, along nothing in particular:
solutions that are alone are found at a singular pose from those of the poses where these bring it."""


def pose_features(frame: Array) -> Array:
    """The numbers 1, R, t, R^T t, t.t, t x R, (t.t) R - 2 t (R^T t)^T of a rigid motion x -> R x + t."""
    rotation, shift = frame[..., :3, :3], frame[..., :3, 3]
    # R^T t, t.t, and row by row t x R.
    projected = (shift[..., None, :] @ rotation)[..., 0, :]
    square = (shift * shift).sum(axis=-1, keepdims=True)
    y, z = [1, 2, 0], [2, 0, 1]
    crossed = shift[..., y, None] * rotation[..., z, :] - shift[..., z, None] * rotation[..., y, :]
    mirrored = square[..., None] * rotation - 2 * shift[..., :, None] * projected[..., None, :]
    flat = [matrix.reshape(*matrix.shape[:-2], 9) for matrix in (rotation, crossed, mirrored)]
    return np.concatenate([np.ones_like(square), flat[0], shift, projected, square, *flat[1:]], axis=-1)


def inverse_features(features: Array) -> Array:
    """Those of the inverse motion: R^T, -R^T t, -t, t.t, and the last two matrices transposed."""
    turned = [0, 3, 6, 1, 4, 7, 2, 5, 8]
    places = [0, *(1 + k for k in turned), 13, 14, 15, 10, 11, 12, 16, *(17 + k for k in turned)]
    places += [26 + k for k in turned]
    sign = np.ones(FEATURES, dtype=int)
    sign[10:16] = -1
    return features[..., places] * sign


def axis_action(features: Array) -> Array:
    """How a rigid motion maps the fifteen numbers of an axis.

    With l' = R l, p' = R p + t: p'.p' = p.p + 2 t.R p + t.t, p'.l' = p.l + t.R l, p' x l' = R (p x l) + t x R l and
    (p'.p') l' - 2 (p'.l') p' = R k - 2 t x R m + (t.t) R l - 2 t (t.R l) - 2 (p.l) t with k and m of p, l.
    """
    one, shift, projected, square = features[..., 0], features[..., 10:13], features[..., 13:16], features[..., 16]
    rotation, crossed, mirrored = _matrices(features)
    result = np.zeros((*features.shape[:-1], 15, 15), dtype=features.dtype)
    # l, p, p x l and (p.p) l - 2 (p.l) p turn with R; 1, p.p and p.l are taken over.
    for start in (1, 4, 9, 12):
        result[..., start : start + 3, start : start + 3] = rotation
    for place in (0, 7, 8):
        result[..., place, place] = one
    result[..., 4:7, 0], result[..., 7, 0] = shift, square
    result[..., 7, 4:7], result[..., 8, 1:4] = 2 * projected, projected
    result[..., 9:12, 1:4], result[..., 12:15, 9:12] = crossed, -2 * crossed
    result[..., 12:15, 1:4], result[..., 12:15, 8] = mirrored, -2 * shift
    return result


def frame_action(features: Array) -> Array:
    """How a rigid motion maps the fifteen numbers of a frame that may slide along its z axis."""
    rotation, crossed, _ = _matrices(features)
    result = np.zeros((*features.shape[:-1], 15, 15), dtype=features.dtype)
    # x, y, z and p x z turn with R; 1, p.x and p.y are taken over, and the shift adds t.x and t.y.
    for start in (1, 4, 7, 12):
        result[..., start : start + 3, start : start + 3] = rotation
    for place in (0, 10, 11):
        result[..., place, place] = features[..., 0]
    result[..., 10, 1:4] = result[..., 11, 4:7] = features[..., 13:16]
    result[..., 12:15, 7:10] = crossed
    return result


def point_action(features: Array) -> Array:
    """How a rigid motion maps the numbers 1, p, p.p of a point."""
    places = [0, 4, 5, 6, 7]
    return axis_action(features)[..., places, :][..., places]


def _matrices(features: Array) -> tuple[Array, Array, Array]:
    """R, t x R and (t.t) R - 2 t (R^T t)^T."""
    shape = (*features.shape[:-1], 3, 3)
    return features[..., 1:10].reshape(shape), features[..., 17:26].reshape(shape), features[..., 26:].reshape(shape)


@dataclass(frozen=True, eq=False)
class Carried:
    """The numbers that a joint does not change."""

    start: Array  # their values in the frame of the joint
    linear: Callable[[Array], Array]  # how a rigid motion maps them, of its features
    heights: tuple[int, ...]  # those that no rotation about z changes
    crosswise: tuple[int, ...]  # first places of the pairs that a rotation about z turns
    along: tuple[int, ...]  # those that no motion along z changes
    shifted: tuple[int, ...]  # those that a motion along z changes in proportion

    def action(self, frame: Array) -> Array:
        """How rigid motions map the numbers."""
        return self.linear(pose_features(frame))


AXIS = Carried(
    start=np.array([1, 0, 0, 1, *[0] * 11]),
    linear=axis_action,
    heights=(3, 6, 7, 8, 11, 14),
    crosswise=(1, 4, 9, 12),
    along=(1, 2, 3, 4, 5),
    shifted=(6,),
)

FRAME = Carried(
    start=np.array([1, *np.eye(3, dtype=int).ravel(), *[0] * 5]),
    linear=frame_action,
    heights=(3, 6, 9, 10, 11, 14),
    crosswise=(1, 4, 7, 12),
    along=(*range(1, 10), 14),
    shifted=(10, 11, 12, 13),
)

POINT = Carried(
    start=np.array([1, 0, 0, 0, 0]), linear=point_action, heights=(3, 4), crosswise=(1,), along=(1, 2), shifted=(3,)
)


def rigid_inverse(frame: Array) -> Array:
    """The inverse of rigid motions."""
    result = np.zeros_like(frame)
    turned = np.swapaxes(frame[..., :3, :3], -1, -2)
    result[..., :3, :3], result[..., 3, 3] = turned, 1
    result[..., :3, 3] = -(turned @ frame[..., :3, 3, None])[..., 0]
    return result


def joint_motion(revolute: bool, first: Array, second: Array | None = None) -> Array:
    """Z of a joint from cosine and sine of its angle, or from its displacement."""
    result = np.zeros((*first.shape, 4, 4), dtype=first.dtype)
    result[..., (0, 1, 2, 3), (0, 1, 2, 3)] = 1
    if revolute:
        result[..., 0, 0] = result[..., 1, 1] = first
        result[..., 1, 0], result[..., 0, 1] = second, -second  # type: ignore[operator]
    else:
        result[..., 2, 3] = first
    return result


def motion_by(revolute: bool, value: Array) -> Array:
    """Z of a joint from its variable."""
    return joint_motion(True, np.cos(value), np.sin(value)) if revolute else joint_motion(False, value)


def beside(poses: Array, which: int, unit: Array) -> Array:
    """Poses A T close to others, displaced in a generic direction."""
    motion = np.array(BESIDE[which])
    result = poses.copy()
    result[..., :3, :] = motion[:, :3] @ poses[..., :3, :]
    result[..., :3, 3] += unit[..., None] * motion[:, 3]
    return result
