"""The generated functions of a robot in memory, as a plan needs them."""

from __future__ import annotations

from collections.abc import Mapping
from types import ModuleType
from typing import Any

import numpy as np

from derive.motion.hermite import Array
from derive.programs.build import build_program
from derive.programs.search_policy import Effort
from derive.robot.robot import Robot
from derive.targets.numpy import FILE, render_numpy
from derive.targets.target import Source
from derive.version import __version__


class Functions:
    """Functions of ``model_numpy.py`` with the numbers of a plan.

    Args:
        robot: The robot.
        names: Which functions.
        values: Numbers of symbols that are arguments.
    """

    def __init__(self, robot: Robot, names: frozenset[str], values: Mapping[str, float]) -> None:
        program = build_program(robot, Effort.QUICK, names=names)
        text = render_numpy(Source(robot, program, __version__))[FILE]
        self._module: Any = ModuleType(FILE)
        exec(compile(text, FILE, "exec"), vars(self._module))  # our own text, as it is written by a build
        self._params = {"params": {name: values[name] for name in program.parameters}} if program.parameters else {}
        self.parameters = program.parameters

    @property
    def names(self) -> frozenset[str]:
        """What can be called."""
        return frozenset(vars(self._module))

    @property
    def standard_parameters(self) -> tuple[str, ...]:
        """Columns of the regressor."""
        return tuple(self._module.STANDARD_PARAMETERS)

    def __call__(self, name: str, *arguments: Array) -> Array:
        """The value of a function.

        Args:
            name: Its name.
            *arguments: (..., n) each.

        Returns:
            (..., *shape).
        """
        value: Array = getattr(self._module, name)(*map(np.ascontiguousarray, arguments), **self._params)
        return value
