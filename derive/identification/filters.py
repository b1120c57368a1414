"""From the rows of a log to states and torques: speeds by zero-phase filters, and fewer rows; block by block.

A Butterworth filter forwards and backwards turns no phase. What it does at a row depends on the rows around it as far
as its slowest pole rings, so that blocks which overlap by that give what the whole log would, to `FORGOTTEN`; as many
rows at both ends of a segment are left out. Fewer rows come from regressor and torques filtered alike, which leaves tau
= Y beta true (parallel filtering: Khalil and Dombre, Modeling, Identification and Control of Robots, ch. 12).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import ceil, log
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.errors import DeriveError, optional
from derive.identification.log import BATCH, Log

ORDER = 4  # of the filters
FORGOTTEN = 1e-8  # what is left of a row where a filter no longer needs it
CUTOFF = 10.0  # frequency [Hz] up to which positions are kept where nobody says; at most a tenth of the rows' rate
BAND = 0.8  # part of the band of fewer rows that is kept
ROWS, THIN = 2000, 8192  # rows of a regressor that are worked on at once, and filtered at once
# Central differences of five points for the first and the second derivative, errors h^4/30 and h^4/90.
FIRST, SECOND = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12, np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12
# Times (rows,) [s], or numbers of rows, speeds (rows, n), regressor (rows, n, p), torques (rows, n).
Block = tuple[Array, ...]


@dataclass(frozen=True)
class Preparation:
    """What is done to the rows of a log."""

    log: Log
    cutoff: float | None = None  # [Hz]; None for the usual where speeds or accelerations are missing
    decimate: int = 1  # of so many rows one is kept

    @cached_property
    def missing(self) -> tuple[str, ...]:
        """What is differentiated."""
        return tuple(quantity for quantity in ("qd", "qdd") if quantity not in self.log.columns)

    @cached_property
    def band(self) -> float:
        """Up to which frequency positions, or speeds, are kept [Hz]; 0 where they are not filtered."""
        step = self.log.step
        if not (self.missing or self.cutoff):
            return 0.0
        if not step:
            lacking = f"{self.log.path or 'the table'}: no time, by which rows are filtered"
            raise DeriveError(lacking, remedy="add a column time")
        found = min(CUTOFF, 0.1 / step) if self.cutoff is None else self.cutoff
        if not 0 < 2 * found * step < 1:
            allowed = f"allowed: below {0.5 / step:g} Hz, half the rows' rate"
            raise DeriveError(f"a cutoff of {found:g} Hz", allowed=allowed)
        return found

    @cached_property
    def _filters(self) -> list[Any]:
        """Of states, and of regressor and torques: a low-pass filter in sections of second order, or None."""
        edges = 2 * self.band * self.log.step, BAND / self.decimate if self.decimate > 1 else 0.0  # of half the rate
        return [_signal().butter(ORDER, edge, output="sos") if edge else None for edge in edges]

    @cached_property
    def margin(self) -> int:
        """Rows at both ends of a block that filters and differences need, a multiple of ``decimate``."""
        poles = ([np.roots(s[3:]) for s in each] for each in self._filters if each is not None)
        rows = sum(ceil(log(FORGOTTEN) / log(np.abs(each).max())) for each in poles) + 2 * len(self.missing)
        return -(-rows // self.decimate) * self.decimate

    def windows(self) -> Iterator[tuple[Array, slice]]:
        """Blocks of rows without gaps, and which rows of each are used."""
        margin, most = self.margin, THIN if self.decimate > 1 else BATCH
        size = max(most // self.decimate, 1) * self.decimate
        held = np.empty((0, 0))
        for rows, starts in self.log.segments():
            if starts:
                yield held, slice(margin, len(held) - margin)
            held = rows if starts else np.concatenate([held, rows])
            while len(held) >= size + 2 * margin:
                yield held[: size + 2 * margin], slice(margin, size + margin)
                held = held[size:]
        yield held, slice(margin, len(held) - margin)

    def states(self, rows: Array) -> tuple[Array, list[Array], Array]:
        """Times, q, qd and qdd, and torques of a block, those near its ends wrong where filters are."""
        step, ends = self.log.step, np.cumsum([len(columns) for columns in self.log.columns.values()])
        parts = dict(zip(self.log.columns, np.split(rows, ends[:-1], axis=1), strict=True))
        if (smooth := self._filters[0]) is not None:
            # What is differentiated; where nothing is, all of the state, so that it stays one motion.
            source = ("q",) if "qd" in self.missing else ("qd",) if self.missing else ("q", "qd", "qdd")
            parts |= {quantity: _both_ways(smooth, parts[quantity]) for quantity in source}
        if "qdd" in self.missing:
            twice = "qd" in self.missing
            parts["qdd"] = _difference(parts["q"], SECOND, step**2) if twice else _difference(parts["qd"], FIRST, step)
        if "qd" in self.missing:
            parts["qd"] = _difference(parts["q"], FIRST, step)
        time = parts["time"][:, 0] if "time" in parts else np.arange(float(len(rows)))
        return time, [parts[key] for key in ("q", "qd", "qdd")], parts["tau"]

    def blocks(self, regressor: Callable[[Array, Array, Array], Array]) -> Iterator[Block]:
        """What tau = Y beta is solved from, in blocks of some thousand rows."""
        thin = self._filters[1]
        for rows, used in self.windows():
            if used.stop <= used.start:
                continue
            time, state, tau = self.states(rows)
            if thin is not None:
                kept = slice(used.start, used.stop, self.decimate)
                yield time[kept], state[1][kept], *(_both_ways(thin, each)[kept] for each in (regressor(*state), tau))
                continue
            for start in range(used.start, used.stop, ROWS):
                part = slice(start, min(start + ROWS, used.stop))
                yield time[part], state[1][part], regressor(*(each[part] for each in state)), tau[part]


def _signal() -> Any:
    return optional("scipy.signal", "filtering a log needs SciPy", "data")


def _both_ways(sections: Any, values: Array) -> Array:
    return np.asarray(_signal().sosfiltfilt(sections, values, axis=0, padlen=min(6 * ORDER, len(values) - 1)))


def _difference(values: Array, weights: Array, unit: float) -> Array:
    """Weighed neighbours of each row over a unit; zero for two rows at both ends."""
    found, inner = np.zeros_like(values), max(len(values) - 4, 0)
    found[2 : 2 + inner] = sum(w / unit * values[k : k + inner] for k, w in enumerate(weights))
    return found
