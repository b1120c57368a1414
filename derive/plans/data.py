"""Plans as Python data: the keys of a plan's file, and configurations in an array."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike


def plan_text(keys: Mapping[str, Any]) -> str:
    """The file of a plan.

    Args:
        keys: Numbers, texts of cells, lists, arrays and mappings; None and False count as left out.
    """
    return json.dumps(_plain(keys), indent=1, ensure_ascii=False)


def _plain(value: object) -> object:
    """What stands in a file for a value."""
    if isinstance(value, Mapping):
        plain = {str(key): _plain(entry) for key, entry in value.items()}
        return {key: entry for key, entry in plain.items() if entry is not None}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, bool):
        return "yes" if value else None
    return value if value is None or isinstance(value, int | float | str) else str(value)


def waypoints(points: ArrayLike, times: ArrayLike | None) -> dict[str, Any]:
    """The points and the path of a plan.

    Args:
        points: One row a configuration, (points, n).
        times: Of the segments [s], (points - 1,), or one for all; None where limits decide.
    """
    rows = np.asarray(points)
    if rows.ndim != 2 or len(rows) < 2:
        raise ValueError(f"points: two rows at least, not an array of shape {rows.shape}")
    count = len(rows) - 1
    if times is not None and np.size(times) not in (1, count):
        raise ValueError(f"times: one, or {count} for {len(rows)} points, not {np.size(times)}")
    steps: list[dict[str, Any]] = [{"to": f"p{k}"} for k in range(1, len(rows))]
    for step, time in zip(steps, np.resize([] if times is None else times, count).tolist(), strict=True):
        step["time"] = None if times is None else time
    return {"points": {f"p{k}": row for k, row in enumerate(rows)}, "path": ["p0", *steps]}
