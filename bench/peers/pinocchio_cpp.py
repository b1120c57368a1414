"""Pinocchio in a C++ loop, built with -O3 -march=native against the headers that its packages bring.

The headers of Eigen come from the package cmeel-eigen. All of Pinocchio that is used is compiled from its headers.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
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


def make(loops: ctypes.CDLL, arm: PlainArm) -> int:
    """The model's handle.

    Raises:
        NotImplementedError: A joint's variable is negated in its cell.
    """
    if any(joint.sign < 0 for joint in arm.joints):
        raise NotImplementedError("negated joint variables are left out")
    revolute = (ctypes.c_int * len(arm.joints))(*(int(joint.revolute) for joint in arm.joints))
    columns = [
        np.array([getattr(joint, name) for joint in arm.joints], dtype=float)
        for name in ("placement", "mass", "com", "inertia")
    ]
    numbers = [*columns, np.ascontiguousarray(arm.end), np.ascontiguousarray(arm.gravity)]
    handle = loops.make_arm(len(arm.joints), revolute, *(pointer(array) for array in numbers))
    assert handle
    return int(handle)


def pointer(array: Array) -> Any:
    """The address of an array of doubles."""
    assert array.flags.c_contiguous
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def _time(case: Case, motions: Sequence[Array]) -> Iterator[Row]:
    for quantity in QUANTITIES:
        yield Row(LABEL, quantity.symbol, True, lambda symbol=quantity.symbol: _timed(case, symbol, motions))  # type: ignore[misc]


def _timed(case: Case, symbol: str, motions: Sequence[Array]) -> Timed:
    loops = load()
    handle = ctypes.c_void_p(make(loops, plain_arm(case)))
    out = np.empty((len(motions[0]), *BY_SYMBOL[symbol].shape(case.robot.n)))
    loop = getattr(loops, f"loop_{symbol}")
    addresses = [pointer(array) for array in (*motions, out)]
    return filled(lambda: loop(handle, ctypes.c_long(len(out)), *addresses), out)


PEER = Peer(LABEL, ("pinocchio",), time=_time)
