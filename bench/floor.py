"""The machine's floor: how fast one core could be, measured by a small C program.

Arithmetic is counted as multiplications and additions that are not fused, half of each; sines and cosines as pairs of
libmvec's vector functions or of our generated C, whichever are faster; memory as the bytes that a batch moves, a
written line being read before.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from bench.built import build
from bench.compilers import library
from bench.native import FOLDER
from bench.problems import brief
from bench.robots import TIMED

_VECTORS = {2: "b", 4: "d", 8: "e"}
"""libmvec's letters for SSE, AVX2 and AVX-512."""

_TURNS = 2_000_000
_PAIRS = 400_000
_DOUBLES = 1 << 23


def floor() -> dict[str, Any]:
    """Nanoseconds per operation, pair and byte by lanes; ``failed`` where there is no compiler."""
    try:
        widths = {str(lanes): _measure(lanes) for lanes in _VECTORS if _runs(lanes)}
        return {"lanes": widths, "byte": min(_call(_load(2), "memory", _DOUBLES) for _ in range(3)), **_ours()}
    except Exception as error:
        return {"failed": brief(error)}


def _ours() -> dict[str, float]:
    """The pair of sine and cosine in our generated C, if that can be built."""
    try:
        folder = build(TIMED[0], "c")
        flags = (f'-DMODEL="{folder / "model.c"}"', f"-I{folder}", "-lm")
        loaded = library(FOLDER / "our_sines.c", flags, [folder / "model.c"])
        return {"our pair": float(f"{_best(loaded, 'pairs', _PAIRS // 500):.4g}")}
    except (RuntimeError, OSError):
        return {}


def widest() -> int:
    """Doubles in the widest vector of this processor."""
    return max(lanes for lanes in _VECTORS if _runs(lanes))


def _runs(lanes: int) -> bool:
    needed = {2: "sse2", 4: "avx2", 8: "avx512f"}[lanes]
    information = Path("/proc/cpuinfo")
    return needed in information.read_text() if information.is_file() else lanes == 2


def _measure(lanes: int) -> dict[str, float]:
    loaded = _load(lanes)
    times = {
        "operation": _best(loaded, "arithmetic", _TURNS),
        "pair": _best(loaded, "vector_pairs", _PAIRS),
        "scalar pair": _best(loaded, "scalar_pairs", _PAIRS),
    }
    return {name: float(f"{value:.4g}") for name, value in times.items() if value}


def _load(lanes: int) -> ctypes.CDLL:
    letter, plain = _VECTORS[lanes], (f"-DLANES={lanes}", "-std=gnu99", "-ffp-contract=off")
    names = tuple(f"-DVECTOR_{kind.upper()}=_ZGV{letter}N{lanes}v_{kind}" for kind in ("sin", "cos"))
    try:
        return library(FOLDER / "floor.c", (*plain, *names, "-lmvec", "-lm"))
    except (RuntimeError, OSError):
        return library(FOLDER / "floor.c", (*plain, "-lm"))


def _best(loaded: ctypes.CDLL, name: str, turns: int) -> float:
    return min(_call(loaded, name, turns) for _ in range(7))


def _call(loaded: ctypes.CDLL, name: str, argument: int) -> float:
    function = getattr(loaded, name)
    function.restype = ctypes.c_double
    return float(function(ctypes.c_long(argument)))


def floor_of(measured: dict[str, Any], lanes: int, arithmetic: int, trig: int, moved: int) -> dict[str, float]:
    """Least nanoseconds per configuration.

    Args:
        measured: Of `floor`.
        lanes: Which vectors.
        arithmetic: Multiplications and additions.
        trig: Sines and cosines, half a pair each.
        moved: Doubles moved: read, and written twice over.

    Returns:
        ``arithmetic``, ``trig`` and ``memory``, ``cache`` = arithmetic + trig, ``batch`` = the larger of the last two.
    """
    width = measured["lanes"][str(lanes)]
    pair = min(width.get("pair", width["scalar pair"]), measured.get("our pair", width["scalar pair"]))
    parts = {
        "arithmetic": arithmetic * width["operation"],
        "trig": trig / 2 * pair,
        "memory": 8 * moved * measured["byte"],
    }
    cache = parts["arithmetic"] + parts["trig"]
    return {**parts, "cache": cache, "batch": max(cache, parts["memory"])}
