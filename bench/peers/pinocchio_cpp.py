"""Pinocchio in a C++ loop, built with -O3 -march=native against the headers that its packages bring.

The headers of Eigen come from the package cmeel-eigen. All of Pinocchio that is used is compiled from its headers.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.compilers import library
from bench.native import FOLDER
from bench.peers.passes import filled
from bench.peers.peer import Peer, Row, Timed
from bench.plain_arm import PlainArm, plain_arm
from bench.quantities import BY_SYMBOL, QUANTITIES
from bench.robots import Array, Case

LABEL = "Pinocchio, C++ loop"
KINDS = ("RX", "RY", "RZ", "PX", "PY", "PZ")
"""Joints that turn about and slide along the axes of their frames."""

_DEFINITIONS = (
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)
"""As the package's own CMake file sets them."""


def headers() -> Path:
    """The folder of headers of the installed packages.

    Raises:
        FileNotFoundError: Pinocchio's or Eigen's are missing.
    """
    import pinocchio

    for parent in Path(pinocchio.__file__).parents:
        found = parent / "include"
        if (found / "pinocchio").is_dir():
            if not (found / "eigen3" / "Eigen").is_dir():
                raise FileNotFoundError("headers of Eigen are missing: pip install cmeel-eigen")
            return found
    raise FileNotFoundError("headers of Pinocchio are missing")


def load() -> ctypes.CDLL:
    """The compiled loops."""
    include = headers()
    flags = ("-std=c++17", "-fvisibility=hidden", f"-I{include}", f"-I{include / 'eigen3'}", *_DEFINITIONS)
    loops = library(FOLDER / "pinocchio_loop.cpp", flags)
    loops.make_arm.restype = ctypes.c_void_p
    return loops


def make(arm: PlainArm) -> ctypes.c_void_p:
    """The model of an arm.

    Raises:
        NotImplementedError: A joint's variable is negated in its cell.
    """
    if any(joint.sign < 0 for joint in arm.joints):
        raise NotImplementedError("negated joint variables are left out")
    kinds = ["RZ" if joint.revolute else "PZ" for joint in arm.joints]
    columns = [
        np.array([getattr(joint, name) for joint in arm.joints], dtype=float)
        for name in ("placement", "mass", "com", "inertia")
    ]
    return handle(kinds, range(len(kinds)), columns, np.ascontiguousarray(arm.end), np.ascontiguousarray(arm.gravity))


def handle(
    kinds: Sequence[str], parents: Iterable[int], columns: Iterable[Array], end: Array, gravity: Array
) -> ctypes.c_void_p:
    """The model of an arm or tree.

    Args:
        kinds: Of each joint, of `KINDS`.
        parents: The joint that each follows, counted from 1; 0 is the base.
        columns: Placements, masses, centres of mass and central inertias.
        end: (4, 4) in the frame of the last joint.
        gravity: (3,) in the base.
    """
    of_kinds, of_parents = (
        (ctypes.c_int * len(kinds))(*values) for values in ([KINDS.index(kind) for kind in kinds], parents)
    )
    found = load().make_arm(len(kinds), of_kinds, of_parents, *(pointer(array) for array in (*columns, end, gravity)))
    assert found
    return ctypes.c_void_p(found)


def pointer(array: Array) -> Any:
    """The address of an array of doubles."""
    assert array.flags.c_contiguous
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def _time(case: Case, motions: Sequence[Array]) -> Iterator[Row]:
    for quantity in QUANTITIES:
        yield Row(LABEL, quantity.symbol, True, lambda symbol=quantity.symbol: _timed(case, symbol, motions))  # type: ignore[misc]


def _timed(case: Case, symbol: str, motions: Sequence[Array]) -> Timed:
    loops, arm = load(), make(plain_arm(case))
    out = np.empty((len(motions[0]), *BY_SYMBOL[symbol].shape(case.robot.n)))
    loop = getattr(loops, f"loop_{symbol}")
    addresses = [pointer(array) for array in (*motions, out)]
    return filled(lambda: loop(arm, ctypes.c_long(len(out)), *addresses), out)


PEER = Peer(LABEL, ("pinocchio",), time=_time)
