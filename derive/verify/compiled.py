"""``model.c``, compiled for the occasion and called through ctypes.

``model_casadi.c``, compiled for the occasion and called through ``casadi.external``.
"""

from __future__ import annotations

import ctypes
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from derive.errors import TargetError, VerificationError
from derive.targets.compiler import Command, compile_shared
from derive.verify.oracle.arm import Array

FILE, HEADER = "model.c", "model.h"
OPTIONS = ("-std=c99", "-O0")
"""What is right without optimisation is right; compiling is most of the time spent here."""

_NUMBER = re.compile(r"^ +(\w+) = (\d+),", re.MULTILINE)
_RESULT = re.compile(r"@param\[out\] result +\S+, ([0-9]+(?: x [0-9]+)*)")
_COMMENTED = re.compile(r"/\*\*\n((?: \*.*\n)+?) \*/\nvoid (\w+)\(")


def load_c_model(folder: Path, compiler: Command) -> CModel:
    """Compile and load the C model of a folder.

    Raises:
        VerificationError: It does not compile.
    """
    with tempfile.TemporaryDirectory(prefix="derive-") as temporary:
        path = Path(temporary, "model.so")
        try:
            compile_shared(compiler, [folder / FILE], path, OPTIONS)
            library = ctypes.CDLL(str(path))
        except (TargetError, OSError) as error:
            raise VerificationError(f"{FILE} cannot be compiled: {error}") from error
    return CModel(library, (folder / HEADER).read_text(encoding="utf-8"))


@dataclass(frozen=True)
class CModel:
    """The functions of one configuration and of a batch; shapes and numbers are read in the header."""

    shared: ctypes.CDLL
    header: str
    target = "c"
    file = FILE
    forms = ("one", "batch", "blocks")

    @property
    def constants(self) -> Mapping[str, Any]:
        """``DOF`` and ``PARAMETERS``, as the header has them, and the shapes of the functions by name."""
        start = f"{self._prefix}index_of_"
        names = [name.removeprefix(start) for name in self._numbers if name.startswith(start)]
        functions = {name.removeprefix(self._prefix): shape for name, shape in self._shapes.items()}
        return {**functions, "DOF": self._numbers[f"{self._prefix}dof"], "PARAMETERS": tuple(names)}

    def call(self, function: str, arguments: Sequence[Array], parameters: Mapping[str, Any]) -> Array:
        """One configuration, or the batch function for more."""
        name = f"{self._prefix}{function}"
        inputs = [np.ascontiguousarray(argument, dtype=float) for argument in arguments]
        batch = inputs[0].shape[:-1] if inputs else ()
        result = np.full((*batch, *self._shapes[name]), np.nan)
        inputs += self._hoisted(name, parameters)
        if batch:
            size = ctypes.c_size_t(int(np.prod(batch)))
            getattr(self.shared, f"{name}_batch")(size, *map(_pointer, inputs), _pointer(result))
        else:
            getattr(self.shared, name)(*map(_pointer, inputs), _pointer(result))
        return result

    def _hoisted(self, name: str, parameters: Mapping[str, Any]) -> list[Array]:
        """The constants from the parameters, if the function takes any."""
        count = self._numbers.get(f"{name}_constant_count", 0)
        if not count:
            return []
        params = np.array([float(parameters[k]) for k in self.constants["PARAMETERS"]])
        constants = np.full(count, np.nan)
        getattr(self.shared, f"{name}_constants")(_pointer(params), _pointer(constants))
        return [constants]

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {name: int(number) for name, number in _NUMBER.findall(self.header)}

    @cached_property
    def _prefix(self) -> str:
        return next(iter(self._numbers)).removesuffix("dof")

    @cached_property
    def _shapes(self) -> dict[str, tuple[int, ...]]:
        found = {name: _RESULT.search(comment) for comment, name in _COMMENTED.findall(self.header)}
        return {name: tuple(map(int, match[1].split(" x "))) for name, match in found.items() if match}


def _pointer(array: Array) -> Any:
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


CASADI_FILE = "model_casadi.c"
CASADI_OPTIONS = ("-O0",)

_PARAMETERS = re.compile(r"^ \* Order of the entries of params.*:\n((?: \*     \w+\n)*)", re.MULTILINE)
_JOINTS = re.compile(r"columns of ([0-9]+):")


def load_casadi_c(folder: Path, compiler: Command) -> Any:
    """The functions of the compiled file, by name, as a module would have them.

    Raises:
        VerificationError: It does not compile.
    """
    temporary = tempfile.TemporaryDirectory(prefix="derive-")
    path = Path(temporary.name, "model_casadi.so")
    try:
        compile_shared(compiler, [folder / CASADI_FILE], path, CASADI_OPTIONS)
    except TargetError as error:
        temporary.cleanup()
        raise VerificationError(f"{CASADI_FILE} cannot be compiled: {error}") from error
    heading = (folder / CASADI_FILE).read_text(encoding="utf-8")
    return _Externals(path, temporary, heading)


class _Externals(SimpleNamespace):
    """Functions that are looked up when they are asked for; the library stays as long as this does."""

    def __init__(self, path: Path, temporary: Any, heading: str) -> None:
        listed = _PARAMETERS.search(heading)
        joints = _JOINTS.search(heading)
        names = tuple(line.removeprefix(" *").strip() for line in listed[1].splitlines()) if listed else ()
        super().__init__(DOF=int(joints[1]) if joints else 0, PARAMETERS=names)
        self.temporary = temporary
        self.find = cache(lambda name: _external(name, path))

    def __getattr__(self, name: str) -> Any:
        """A function of the library."""
        return vars(self)["find"](name)


def _external(name: str, path: Path) -> Any:
    import casadi

    return casadi.external(name, str(path))
