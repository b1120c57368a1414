"""What is said of many values together: parts of it from blocks, joined in the order of the blocks.

Extremes and counts are the same in any order. Sums are not: they are added block by block.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from derive.arrays import Array, Whole

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
KINDS = ("min", "mean", "max", "quantiles")

_CUT = (
    42  # of the 52 bits of a double's mantissa those that bins do not tell apart: bins are 2^-10 of their values wide
)


Bins = tuple[Whole, Whole]


@dataclass(frozen=True, slots=True)
class Part:
    """Of the values (rows, entries) of some blocks."""

    rows: int  # those with a value, in which every entry is finite
    lacking: int  # the others
    low: Array  # smallest values, (entries), and the blocks in which they are, the first such
    low_at: Whole
    high: Array
    high_at: Whole
    sums: Array  # of each block, (blocks, entries); added up where parts are joined, (1, entries)
    bins: tuple[Bins, ...]  # of each entry bins in order, and how many values are in them; or none


def part_of(values: Array, block: int, *, binned: bool) -> Part:
    """Of one block's values."""
    sums = values.sum(axis=0)
    lacking = 0
    if not np.isfinite(sums.sum()):  # what costs more than a sum is rarely done
        sound = np.isfinite(values).all(axis=1)
        lacking, values = int(len(values) - sound.sum()), values[sound]
        sums = values.sum(axis=0)
    at = np.full(values.shape[1], block)
    low, high = values.min(axis=0, initial=np.inf), values.max(axis=0, initial=-np.inf)
    heads = np.ascontiguousarray(values.T).view(np.int64) >> _CUT if binned else ()
    bins = tuple(np.unique(entry, return_counts=True) for entry in heads)
    return Part(len(values), lacking, low, at, high, at, sums[None], bins)


def joined(parts: Iterable[Part], *, added: bool) -> Part:
    """Of several parts in the order of their blocks, whose sums are kept apart until they are to be ``added``."""
    found = list(parts)
    lows, highs = np.stack([part.low for part in found]), np.stack([part.high for part in found])
    at_low, at_high = lows.argmin(axis=0), highs.argmax(axis=0)
    entries = np.arange(lows.shape[1])
    sums = np.concatenate([part.sums for part in found])
    return Part(
        sum(part.rows for part in found),
        sum(part.lacking for part in found),
        lows[at_low, entries],
        np.stack([part.low_at for part in found])[at_low, entries],
        highs[at_high, entries],
        np.stack([part.high_at for part in found])[at_high, entries],
        np.cumsum(sums, axis=0)[-1:] if added else sums,
        tuple(_counted(each) for each in zip(*(part.bins for part in found), strict=True)),
    )


def _counted(bins: Iterable[Bins]) -> Bins:
    """Bins of one entry, each once."""
    keys, counts = (np.concatenate(each) for each in zip(*bins, strict=True))
    found, places = np.unique(keys, return_inverse=True)
    total = np.zeros(len(found), np.int64)
    np.add.at(total, places, counts)
    return found, total


def reduced(part: Part, kinds: Iterable[str]) -> dict[str, Array]:
    """The reductions of all blocks, (entries) each, quantiles (quantiles, entries)."""
    ways: Mapping[str, Callable[[], Array]] = {
        "min": lambda: part.low,
        "mean": lambda: part.sums[0] / part.rows,
        "max": lambda: part.high,
        "quantiles": lambda: np.stack([_quantiles(*each) for each in part.bins], axis=-1).clip(part.low, part.high),
    }
    return {kind: ways[kind]() for kind in kinds}


def _quantiles(keys: Whole, counts: Whole) -> Array:
    """Quantiles of one entry, linear within a bin."""
    # A bin's number is the head of its values' bits; negative ones grow in magnitude with it.
    edges = np.stack([(keys << _CUT).view(np.float64), ((keys + 1) << _CUT).view(np.float64)])
    edges.sort(axis=0)
    order = edges[0].argsort()
    low, high, until = *edges[:, order], np.cumsum(counts[order])
    ranks = np.array(QUANTILES) * (until[-1] - 1)
    place = np.searchsorted(until, ranks, side="right")
    inside = (ranks - (until - counts[order])[place] + 0.5) / counts[order][place]
    found: Array = low[place] + inside * (high - low)[place]
    return np.where(np.abs(found) < np.finfo(float).tiny, 0.0, found)  # in the bin of zero
