"""Generated modules as callables, imported by path and without leaving a trace in this process or in their folder."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

import numpy as np

from derive.errors import VerificationError
from derive.targets.compiler import Command
from derive.verify.compiled import CModel, load_c_model, load_casadi_c
from derive.verify.oracle.arm import Array

Parameters = Mapping[str, Any]
"""A number, or an array that broadcasts against the batch, for every free symbol."""


class GeneratedModel(Protocol):
    """One target of a robot, callable from Python."""

    @property
    def target(self) -> str:
        """Name of the target."""

    @property
    def file(self) -> str:
        """Name of the module's file."""

    @property
    def constants(self) -> Mapping[str, Any]:
        """The module's names, ``DOF`` and ``PARAMETERS`` among them."""

    @property
    def forms(self) -> tuple[str, ...]:
        """The ways of calling that the target offers, of `derive.verify.forms.FORMS`."""

    def call(self, function: str, arguments: Sequence[Array], parameters: Parameters) -> Array:
        """The value of a generated function."""


class _Traceless(SourceFileLoader):
    """Reads and writes no byte code: a stale cache would hide what was just generated."""

    def path_stats(self, path: Any) -> Mapping[str, Any]:
        raise OSError("byte code is not wanted")


def load_models(folder: Path) -> tuple[GeneratedModel, ...]:
    """The generated modules that lie in ``folder``.

    Raises:
        VerificationError: A module cannot be imported.
    """
    return tuple(kind(_import(folder / file)) for file, kind in _KINDS.items() if (folder / file).is_file())


def compile_models(folder: Path, compiler: Command | None) -> tuple[GeneratedModel, ...]:
    """The generated C sources that lie in ``folder``, compiled for the occasion; none without a compiler.

    Raises:
        VerificationError: One does not compile.
    """
    if compiler is None:
        return ()
    return tuple(load(folder, compiler) for file, load in _COMPILED.items() if (folder / file).is_file())


@dataclass(frozen=True, slots=True)
class NumpyModel:
    """``model_numpy.py``: functions of one configuration or any batch."""

    module: ModuleType
    target = "numpy"
    file = "model_numpy.py"
    forms = ("one", "batch", "broadcast", "blocks", "parameters")

    @property
    def constants(self) -> Mapping[str, Any]:
        """The module's names."""
        return vars(self.module)

    def call(self, function: str, arguments: Sequence[Array], parameters: Parameters) -> Array:
        """Call it with ``params`` where symbols are free."""
        options = {"params": dict(parameters)} if parameters else {}
        value: Array = getattr(self.module, function)(*arguments, **options)
        return value


class NativeModel(NumpyModel):
    """``model_native.py``: the same functions, compiled."""

    target = "native"
    file = "model_native.py"


@dataclass(frozen=True, slots=True)
class CasadiModel:
    """``model_casadi.py``: CasADi functions of one configuration; a batch goes through ``Function.map``."""

    module: ModuleType
    target = "casadi"
    file = "model_casadi.py"
    forms = ("one", "batch")

    @property
    def constants(self) -> Mapping[str, Any]:
        """The module's names."""
        return vars(self.module)

    def call(self, function: str, arguments: Sequence[Array], parameters: Parameters) -> Array:
        """Call it with columns; the blocks of the results side by side become the first axis."""
        handle = getattr(self.module, function)
        names = tuple(self.module.PARAMETERS)
        columns = [np.atleast_2d(argument).T for argument in arguments]
        count = columns[0].shape[1] if columns else 1
        if parameters:
            columns.append(np.repeat([[float(parameters[name])] for name in names], count, axis=1))
        mapped = handle if count == 1 else handle.map(count)
        value = mapped(*columns) if columns else mapped()[handle.name_out(0)]
        stacked = np.asarray(value.full())
        width = handle.size2_out(0)
        blocks = stacked.reshape(stacked.shape[0], count, width).transpose(1, 0, 2)
        shaped = np.stack([_without_casadi_layout(function, block) for block in blocks])
        return shaped if arguments and arguments[0].ndim > 1 else shaped[0]


class CasadiCModel(CasadiModel):
    """``model_casadi.c``: the C export of the same functions."""

    target = "casadi-c"
    file = "model_casadi.c"


_KINDS: Mapping[str, Callable[[ModuleType], GeneratedModel]] = {
    kind.file: kind for kind in (NumpyModel, CasadiModel, NativeModel)
}

_COMPILED: Mapping[str, Callable[[Path, Command], GeneratedModel]] = {
    CModel.file: load_c_model,
    CasadiCModel.file: lambda folder, compiler: CasadiCModel(load_casadi_c(folder, compiler)),
}

COMPILED = frozenset(_COMPILED)
"""Files that are verified where there is a C compiler."""

MODULES = COMPILED.union(_KINDS)
"""Files that are verified."""


def _without_casadi_layout(function: str, block: Array) -> Array:
    """Vectors are columns and link transforms lie side by side, 4 x 4n, since CasADi knows matrices only."""
    if function == "link_transforms":
        return block.reshape(4, -1, 4).transpose(1, 0, 2)
    return block[:, 0] if block.shape[1] == 1 and function in VECTORS else block


VECTORS = frozenset({"gravity_vector", "inverse_dynamics", "forward_dynamics", "coriolis_vector", "base_parameters"})


def _import(path: Path) -> ModuleType:
    name = f"_derive_verification_of_{path.stem}"
    loader = _Traceless(name, str(path))
    spec = importlib.util.spec_from_loader(name, loader)
    if spec is None:
        raise VerificationError(f"{path.name} cannot be imported")
    module = importlib.util.module_from_spec(spec)
    try:
        loader.exec_module(module)
    except Exception as error:
        raise VerificationError(f"{path.name} cannot be imported: {type(error).__name__}: {error}") from error
    return module
