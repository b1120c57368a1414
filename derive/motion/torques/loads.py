"""What joints do in a segment: torque, power and work, from torques at many times and between them."""

from collections.abc import Callable, Iterable
from itertools import pairwise

import numpy as np

from derive.arrays import Array
from derive.motion.curves.extremes import highest
from derive.plans.segments import Load

# Of a segment, for work and root mean square, however few samples it has; a multiple of four, for Boole's rule.
LEAST_INTERVALS = 64


def mean_weights(count: int) -> Array:
    """Weights (count + 1,) of evenly spaced places for the mean of a function: Boole's rule, Simpson's for the rest.

    Polynomials of degree five are exact where four divides the number.
    """
    weights, last = np.zeros(count + 1), count - count % 4
    for k in range(0, last, 4):
        weights[k : k + 5] += np.array([7, 32, 12, 32, 7]) * (2 / 45)
    weights[last : last + 3] += np.array([1, 4, 1]) / 3 if last < count else 0
    return np.asarray(weights / count)


def loads(
    start: float,
    end: float,
    samples: int,
    state: Callable[[Array], tuple[Array, Array]],
    corners: Iterable[float] = (),
) -> tuple[Load, ...]:
    """What each joint does in a segment, whose torques may jump at its ends and its corners [s]."""
    count, length = max(2 * samples, LEAST_INTERVALS), end - start
    places, parts = [], []
    for a, b in pairwise(sorted({start, *corners, end})):
        inner = count if b - a == length else 4 * max(2, int(np.ceil(count * (b - a) / length / 4)))
        # what comes before a jump, and what this segment carries and does, not the next one
        places.append(np.minimum(a + (b - a) * np.arange(inner + 1) / inner, np.nextafter(b, a)))
        parts.append(mean_weights(inner) * ((b - a) / length))
    times, weights = np.concatenate(places), np.concatenate(parts)

    def _both(at: Array) -> Array:
        torque, velocity = state(at)
        return np.concatenate([torque, torque * velocity], axis=-1)

    values = _both(times)
    tau, power = np.split(values, 2, axis=1)
    # work = integral of tau qd dt, rms^2 = mean of tau^2.
    work = weights @ power * (end - start)
    rms = np.sqrt(weights @ tau**2)
    when = highest(lambda at: np.abs(_both(at)), times, np.abs(values))
    own = np.arange(when.size)
    peaks, powers = np.split(_both(when)[own, own], 2)
    columns = (peaks, when[: peaks.size], rms, powers, work)
    return tuple(Load(*map(float, row)) for row in zip(*columns, strict=True))
