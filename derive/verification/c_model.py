"""The C model as a callable: compiled for the occasion, called through ctypes; its header says what there is."""

import ctypes
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from derive.errors import TargetError, VerificationError
from derive.interrupts import TemporaryFolder
from derive.targets.compiler import Command, compile_shared
from derive.verification.oracle.frames import Array
from derive.verification.samples import Parameters

C_OPTIONS = ("-std=c99", "-O0", "-Dalways_inline=unused")
"""What is right without optimisation is right; compiling is most of the time spent here.

Every kernel is compiled once, and not once more for each function that it is to be inlined into.
"""


@dataclass(frozen=True)
class CModel:
    """The compiled ``model.c``: functions of one configuration and of a batch."""

    shared: ctypes.CDLL  # the library
    header: str  # text of ``model.h``, in which shapes and numbers are read
    target = "c"
    file = "model.c"
    ways = ("one", "batch", "blocks")

    @property
    def constants(self) -> Mapping[str, Any]:
        """``DOF``, ``PARAMETERS`` and the places ``GIVEN``, as the header has them; shapes of the functions by name."""
        start = f"{self._prefix}index_of_"
        names = [name.removeprefix(start) for name in self._numbers if name.startswith(start)]
        given = [k for name, k in self._numbers.items() if name.startswith(f"{self._prefix}given_joint_")]
        functions = {name.removeprefix(self._prefix): shape for name, shape in self._shapes.items()}
        if f"{self._prefix}branches" in self._numbers:
            functions["inverse_kinematics"] = ()
        dof = self._numbers[f"{self._prefix}dof"]
        return {**functions, "DOF": dof, "PARAMETERS": tuple(names), "GIVEN": tuple(given)}

    def call(self, function: str, arguments: Sequence[Array], parameters: Parameters) -> Array:
        """The value of a function, by the batch function for more than one configuration."""
        name = f"{self._prefix}{function}"
        inputs = [np.ascontiguousarray(argument, dtype=float) for argument in arguments]
        batch = inputs[0].shape[:-1] if inputs else ()
        result = np.full((*batch, *self._shapes[name]), np.nan)
        pointers = [_pointer(array) for array in (*inputs, *self._hoisted(name, parameters), result)]
        if batch:
            getattr(self.shared, f"{name}_batch")(ctypes.c_size_t(int(np.prod(batch))), *pointers)
        else:
            getattr(self.shared, name)(*pointers)
        return result

    def inverse(self, poses: Array, given: Array, parameters: Parameters) -> tuple[Array, Array]:
        """Inverse kinematics, see `derive.verification.generated.GeneratedModel`."""
        name, count = f"{self._prefix}inverse_kinematics", len(poses)
        branches = self._numbers[f"{self._prefix}branches"]
        q = np.zeros((count, branches, self._numbers[f"{self._prefix}dof"]))
        status = np.full((count, branches), -1, dtype=np.intc)
        arrays = [np.ascontiguousarray(poses, dtype=float)]
        arrays += [np.ascontiguousarray(given, dtype=float)] if given.shape[-1] else []
        pointers = [_pointer(array) for array in (*arrays, *self._hoisted(name, parameters), q, status)]
        pointers.insert(1 + bool(given.shape[-1]), ctypes.c_void_p())  # free joints at zero
        if count > 1:
            getattr(self.shared, f"{name}_batch")(ctypes.c_size_t(count), *pointers)
        elif getattr(self.shared, name)(*pointers) != (status > 0).sum():
            raise VerificationError(f"{name} of {self.file} returns another number of solutions than it marks")
        return q, status

    def _hoisted(self, name: str, parameters: Parameters) -> list[Array]:
        """The array of the constants that a function takes from the parameters, if it takes any."""
        constants = np.full(self._numbers.get(f"{name}_constant_count", 0), np.nan)
        if not constants.size:
            return []
        params = np.array([float(parameters[k]) for k in self.constants["PARAMETERS"]])
        getattr(self.shared, f"{name}_constants")(_pointer(params), _pointer(constants))
        return [constants]

    @cached_property
    def _numbers(self) -> dict[str, int]:
        """The enumerators of the header."""
        return {name: int(number) for name, number in re.findall(r"^ +(\w+) = (\d+),", self.header, re.MULTILINE)}

    @cached_property
    def _prefix(self) -> str:
        return next(iter(self._numbers)).removesuffix("dof")

    @cached_property
    def _shapes(self) -> dict[str, tuple[int, ...]]:
        """Shapes of the results, from the functions' comments."""
        shapes = {}
        for comment, name in re.findall(r"/\*\*\n((?: \*.*\n)+?) \*/\nvoid (\w+)\(", self.header):
            shape = re.search(r"@param\[out\] result +\S+, (scalar|[0-9]+(?: x [0-9]+)*)", comment)
            if shape:
                shapes[name] = tuple(map(int, re.findall("[0-9]+", shape[1])))
        return shapes


def load_c_model(path: Path, compiler: Command) -> CModel:
    """Compile and load a C model."""
    with TemporaryFolder() as temporary:
        library = temporary.path / "model.so"
        try:
            compile_shared(compiler, [path], library, C_OPTIONS)
            shared = ctypes.CDLL(str(library))
        except (TargetError, OSError) as error:
            raise VerificationError(f"{path.name} cannot be compiled: {error}") from error
    return CModel(shared, path.with_suffix(".h").read_text(encoding="utf-8"))


def _pointer(array: Array) -> Any:
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
