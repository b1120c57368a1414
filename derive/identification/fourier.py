"""Joint variables as Fourier series that start and end at rest.

    q(t) = c + sum_k a_k cos(k w t) + b_k sin(k w t),   w = 2 pi/T,   k = 1 ... K

(Swevers, Ganseman, Tukel, De Schutter and Van Brussel, IEEE Trans. Robotics and Automation 13(5), 1997). At 0 and T
the speed is w sum k b_k and the acceleration -w^2 sum k^2 a_k; both vanish where a_1 and b_1 are minus the sums of the
others, which alone are free.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from derive.arrays import Array

# Of a trigonometric polynomial of degree K the largest magnitude is at most 1/cos(pi K/N) times that at N > 2 K evenly
# spaced times of its period (M. Riesz 1914): about the maximum it falls no faster than its cosine of degree K.
TIMES = 12  # of the grid for each harmonic: 3.5 % between
BETWEEN = float(np.cos(np.pi / TIMES))  # what part of its largest magnitude a series reaches at one of these at least


@dataclass(frozen=True, slots=True)
class FourierSeries:
    """All series of a period [s] with so many harmonics; one of them is a row c, a_2 ... a_K, b_2 ... b_K a joint."""

    period: float
    harmonics: int

    @property
    def width(self) -> int:
        """How many numbers a row has."""
        return 2 * self.harmonics - 1

    @property
    def times(self) -> Array:
        """Evenly spaced times of a period [s], on which bounds within `BETWEEN` of one hold everywhere."""
        count = TIMES * self.harmonics
        return self.period / count * np.arange(count, dtype=float)

    @property
    def sizes(self) -> Array:
        """The coefficients for which each term moves about as fast, (width,)."""
        k = np.arange(2.0, self.harmonics + 1)
        return np.concatenate([[1.0], 1 / k**2, 1 / k])

    def basis(self, times: Array) -> Array:
        """Positions, speeds and accelerations at times (t,) [s] per unit of each coefficient, (3, t, width)."""
        k = np.arange(1, self.harmonics + 1)
        rates = 2j * np.pi / self.period * k
        waves = np.exp(np.outer(times, rates)) * np.stack([np.ones(len(k)), rates, rates**2])[:, None]
        first, others, k = waves[..., :1], waves[..., 1:], k[1:]
        still = np.repeat([1.0, 0.0, 0.0], len(times)).reshape(3, -1, 1)
        return np.concatenate([still, (others - k**2 * first).real, (others - k * first).imag], axis=-1)

    def formula(self, row: Sequence[Decimal]) -> str:
        """The series of a row as the text of a cell; decimals are exact, so it is exactly at rest at its ends."""
        centre, cosines, sines = row[0], list(row[1 : self.harmonics]), list(row[self.harmonics :])
        cosines.insert(0, -sum((k**2 * a for k, a in enumerate(cosines, start=2)), Decimal(0)))
        sines.insert(0, -sum((k * b for k, b in enumerate(sines, start=2)), Decimal(0)))
        terms = [f"{centre:f}"]
        for k, pair in enumerate(zip(cosines, sines, strict=True), start=1):
            angle = f"{2 * k}*pi*t/{Decimal(repr(self.period)).normalize():f}"
            terms += [f"{value:+f}*{name}({angle})" for name, value in zip(("cos", "sin"), pair, strict=True) if value]
        return " ".join(terms)
