"""What derive generates: NumPy, native and C."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bench.built import build, module
from bench.compilers import library
from bench.inverse.problem import BATCH, CHECKED, ONE, C, Problem, Solver, Solving, one_by_one
from bench.native import FOLDER
from bench.our_times import prefix
from bench.peers.pinocchio_cpp import pointer
from bench.robots import Array

NUMPY, NATIVE, C_ONE, C_BATCH = (
    "derive: model_numpy",
    "derive: model_native",
    "derive: model.c",
    "derive: model.c, batch",
)

_VECTORS = ("-fno-math-errno", "-fno-trapping-math", "-lm")
"""Without which compilers do not compute square roots and choices in lanes."""


def _one(target: str, problem: Problem) -> Solving:
    return one_by_one(_function(target, problem), lambda rows: np.asarray(rows), problem.poses)


def _batch(target: str, problem: Problem) -> Solving:
    function, poses = _function(target, problem), problem.poses
    return Solving(lambda: function(poses), len(poses), lambda: iter(np.asarray(function(poses[:CHECKED]))))


def _function(target: str, problem: Problem) -> Callable[[Array], Any]:
    made: Callable[[Array], Any] = module(problem.case.name, target, f"model_{target}.py").inverse_kinematics
    return made


def _c_one(problem: Problem) -> Solving:
    folder, found = build(problem.case.name, "c"), _array(problem)
    call = f"{prefix(folder)}inverse_kinematics(T + 16 * k, 0, out + {found[0].size} * k, 0)"
    loop = pose_loop(folder / "model.c", call, (f"-I{folder}",))
    return _filled(partial(loop, ctypes.c_long(len(found)), pointer(problem.poses), pointer(found), None), found)


def pose_loop(source: Path, call: str, flags: Sequence[str] = ()) -> Callable[..., object]:
    """A function of C in a loop over poses.

    Args:
        source: What is included.
        call: The call for pose number k.
        flags: For the compiler.
    """
    defined = (f'-DSOURCE="{source}"', *flags, f"-DCALL={call}", *_VECTORS)
    made: Callable[..., object] = library(FOLDER / "inverse_loop.c", defined, [source]).loop
    return made


def _c_batch(problem: Problem) -> Solving:
    folder, found = build(problem.case.name, "c"), _array(problem)
    function = getattr(library(folder / "model.c", _VECTORS), f"{prefix(folder)}inverse_kinematics_batch")
    status = np.empty(found.shape[:2], dtype=np.intc)
    arguments = (ctypes.c_size_t(len(found)), pointer(problem.poses), None, pointer(found), pointer(status))
    return _filled(partial(function, *arguments), found)


def _array(problem: Problem) -> Array:
    """Room for all branches of all poses."""
    branches = len(_function("numpy", problem)(problem.poses[0]))
    return np.empty((len(problem.poses), branches, problem.case.robot.n))


def _filled(run: Callable[[], object], found: Array) -> Solving:
    return Solving(run, len(found), lambda: iter(found[:CHECKED]))


SOLVERS = (
    Solver(NUMPY, ONE, partial(_one, "numpy")),
    Solver(NATIVE, ONE, partial(_one, "native")),
    Solver(C_ONE, C, _c_one),
    Solver(NUMPY, BATCH, partial(_batch, "numpy")),
    Solver(NATIVE, BATCH, partial(_batch, "native")),
    Solver(C_BATCH, BATCH, _c_batch),
)
