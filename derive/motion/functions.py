"""The generated functions of a robot as a motion needs them: compiled where there is a compiler, else in NumPy."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from derive.errors import TargetError
from derive.motion.hermite import Array
from derive.programs.build import build_program
from derive.programs.search_policy import Effort
from derive.publish.render import compile_libraries
from derive.robot.robot import Robot
from derive.targets import c, native, numpy
from derive.targets.compiler import find_compiler
from derive.targets.target import Source
from derive.version import __version__


class Functions:
    """Functions of ``model_numpy.py`` or ``model_native.py`` with the numbers of a plan.

    Args:
        robot: The robot.
        names: Which functions.
        values: Numbers of symbols that are arguments.
        compiled: Whether it is worth a compiler's second.
        inverse: Whether inverse kinematics is wanted, too.
    """

    def __init__(
        self,
        robot: Robot,
        names: frozenset[str],
        values: Mapping[str, float],
        *,
        compiled: bool = False,
        inverse: bool = False,
    ) -> None:
        program = build_program(robot, Effort.QUICK, names=names, inverse=inverse)
        self._folder = TemporaryDirectory(prefix="derive-", ignore_cleanup_errors=True)
        self._module = _imported(Source(robot, program, __version__), Path(self._folder.name), compiled=compiled)
        self._parameters = program.parameters
        self._options = self._numbers(values)

    def _numbers(self, values: Mapping[str, float]) -> dict[str, Any]:
        numbers = {name: values[name] for name in self._parameters}
        return {"params": self._module.precompute(numbers)} if numbers else {}

    def given(self, values: Mapping[str, float]) -> Functions:
        """The same functions with other numbers.

        Args:
            values: Numbers of symbols that are arguments.
        """
        other = copy(self)
        other._options = self._numbers(values)
        return other

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
        value: Array = getattr(self._module, name)(*arguments, **self._options)
        return value

    def nearest(self, pose: Array, q: Array) -> Array:
        """The solution of a pose nearest to a configuration.

        Args:
            pose: (4, 4).
            q: (n,).

        Returns:
            (n,); not numbers where there is none.
        """
        found: Array = self._module.inverse_kinematics_nearest(pose, q, **self._options)
        return found


def _imported(source: Source, folder: Path, *, compiled: bool) -> Any:
    """The module of a target, written and imported."""
    compiler = find_compiler() if compiled else None
    targets = [c.TARGET, native.TARGET] if compiler else [numpy.TARGET]
    for target in targets:
        for name, text in target.render(source).items():
            (folder / name).write_text(text, encoding="utf-8")
    if compiler:
        try:
            compile_libraries(folder, targets, compiler)
        except TargetError:  # a compiler that does not serve is none
            return _imported(source, folder, compiled=False)
    spec = spec_from_file_location(f"derive_motion_{id(folder)}", folder / targets[-1].files[0])
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
