"""``model.c``, compiled for the occasion and called through ctypes."""

from __future__ import annotations

import ctypes
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from derive.check.oracle.arm import Array
from derive.compiler import Command, compile_shared
from derive.errors import TargetError, VerificationError

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
