"""Arms under torques that are held, in C: without control, and between two looks of a sampled controller."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from copy import copy
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.errors import TargetError
from derive.interrupts import TemporaryFolder
from derive.motion.simulation.stepping import DIVERGED, STICTION_SPEED, TOLERANCE, Divergence, Plant, Steps
from derive.motion.torques.functions import COMPILING, KEPT, bare_robot, program_of
from derive.programs.program import Program
from derive.robot.robot import Robot
from derive.targets.compiler import compile_shared, find_compiler

NAMES = frozenset({"forward_dynamics"})  # generated functions that a step asks for
SAVED = 1e-5  # what C saves an evaluation of the rates of a state [s]
OPTIONS = ("-std=c99", "-O2", "-fno-math-errno")

FIRST = 1e-4  # length of the first step that is tried [s]


class HeldArm:
    """Steps of an arm whose motors hold their torques."""

    def __init__(self, program: Program, library: _Library, values: Mapping[str, float]) -> None:
        self._program, self._library = program, library
        self._step = FIRST
        self._constants = np.zeros(library.constant_count)
        self._prepare(values)

    def _prepare(self, values: Mapping[str, float]) -> None:
        params = np.array([float(values[name]) for name in self._program.parameters])
        self._library.constants(_pointer(params), _pointer(self._constants))

    def given(self, values: Mapping[str, float]) -> HeldArm:
        """The same arm with other numbers."""
        other = copy(self)
        other._constants = self._constants.copy()
        other._prepare(values)
        return other

    def __call__(self, plant: Plant, motors: Array, state: Array, span: tuple[float, float], times: Array) -> Steps:
        """A motion by DOP853 under torques of the motors, (n,), with the usual tolerance and smooth dry friction."""
        clock, rows = np.array([span[0], self._step]), np.empty((times.size, state.size))
        given = [np.ascontiguousarray(part, dtype=float) for part in (times, motors)]
        ahead, back = plant.coulomb
        arm = np.concatenate([plant.push, plant.viscous, (ahead + back) / 2, (ahead - back) / 2])
        others = [arm, self._constants, state.copy(), rows]
        count = self._library.held(_pointer(clock), times.size, *map(_pointer, (*given, *others)))
        self._step = float(clock[1])
        if count == times.size:
            return rows, None
        n, last = plant.viscous.size, others[2]
        return rows[:count], Divergence(float(clock[0]), last[:n], last[n : 2 * n])


def held_arm(robot: Robot, values: Mapping[str, float], evaluations: float) -> HeldArm | None:
    """The arm in C; None where there is no compiler, or where it takes longer than it saves."""
    if evaluations * SAVED < COMPILING:
        return None
    bare = bare_robot(robot)
    library = _compiled(bare)
    return None if library is None else HeldArm(program_of(bare, NAMES), library, values)


class _Library:
    """Compiled code, and the folder that holds it as long as it is used."""

    def __init__(self, folder: TemporaryFolder, path: Path, prefix: str) -> None:
        self._folder = folder
        shared = ctypes.CDLL(str(path))
        self.constant_count = ctypes.c_int.in_dll(shared, f"{prefix}held_constant_count").value
        self.held, self.constants = shared[f"{prefix}held"], shared[f"{prefix}held_constants"]
        self.held.argtypes = [ctypes.c_void_p, ctypes.c_int, *[ctypes.c_void_p] * 6]
        self.constants.argtypes, self.constants.restype = [ctypes.c_void_p] * 2, None


@lru_cache(KEPT)
def _compiled(robot: Robot) -> _Library | None:
    from scipy.integrate import DOP853

    from derive.targets import c
    from derive.targets.target import Source
    from derive.targets.templating import render
    from derive.version import __version__

    compiler = find_compiler()
    if compiler is None:
        return None
    temporary = TemporaryFolder()
    folder, source = temporary.path, Source(robot, program_of(robot, NAMES), __version__)
    context = c.c_context(source)
    code = render(
        "motion/held.c.jinja",
        **context,
        stages=DOP853.n_stages,
        weights=[_listed(row) for row in DOP853.A[: DOP853.n_stages]],
        sums=_listed(DOP853.B),
        third=_listed(DOP853.E3),
        fifth=_listed(DOP853.E5),
        tolerance=repr(TOLERANCE),
        stiction=repr(STICTION_SPEED),
        diverged=repr(DIVERGED),
    )
    files = {**c.TARGET.render(source), "held.c": code}
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    try:
        compile_shared(compiler, [folder / "model.c", folder / "held.c"], folder / "held.so", OPTIONS)
    except TargetError:  # a compiler that does not serve is none
        return None
    return _Library(temporary, folder / "held.so", str(context["prefix"]))


def _listed(numbers: Any) -> str:
    return ", ".join(repr(float(number)) for number in numbers)


def _pointer(array: Array) -> int:
    address: int = array.__array_interface__["data"][0]
    return address
