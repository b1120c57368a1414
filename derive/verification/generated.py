"""Generated modules as callables.

Python is imported by path, without leaving a trace in this process or in its folder; C is compiled for the occasion and
called through ctypes, as its header says, or ``casadi.external`` (``model_casadi.c``). The package of MATLAB and Octave
is asked through pipes, in numbers, from one process of Octave.

All have the name of the ``target`` and of its ``file``, the module's ``constants``, ``DOF``, ``PARAMETERS`` and
``GIVEN`` (the given joints or their places) among them, and the ``ways`` of calling that `derive.verification.verify`
knows.
"""

import ctypes
import re
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, cached_property, partial
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import IO, Any

import numpy as np

from derive.errors import TargetError, VerificationError
from derive.interrupts import TemporaryFolder, uninterrupted
from derive.targets.compiler import Command, compile_shared, compiling_meanwhile, find_command
from derive.targets.templating import render
from derive.verification.oracle.frames import Array
from derive.verification.oracle.functions import FUNCTIONS, stem
from derive.verification.samples import Parameters

# What is right without optimisation is right; compiling is most of the time spent here.
# Every kernel is compiled once, and not once more for each function that it is to be inlined into.
C_OPTIONS = ("-std=c99", "-O0", "-Dalways_inline=unused")
CASADI_OPTIONS = ("-O0",)
OCTAVES = ("octave-cli", "octave")  # looked for in this order where ``$OCTAVE`` is not set
OCTAVE_OPTIONS = ("--norc", "--no-history", "--quiet", "--no-gui")  # nobody's settings, no trace, no window
SECONDS = 600  # longest call of Octave
FIRST_FILE = "link_transforms.m"  # every package of MATLAB and Octave of ours has it


@dataclass(frozen=True, slots=True)
class NumpyModel:
    """``model_numpy.py``: functions of one configuration or any batch."""

    module: ModuleType
    end: str = ""  # of a tree, whose inverse kinematics is meant; empty for a robot of one end
    target = "numpy"
    file = "model_numpy.py"
    ways = ("one", "batch", "broadcast", "blocks", "parameters")

    @property
    def constants(self) -> Mapping[str, Any]:
        """The module's names."""
        names = vars(self.module)
        return {**names, "GIVEN": names["GIVEN_OF"][self.end]} if self.end else names

    def call(self, function: str, arguments: Sequence[Array], parameters: Parameters) -> Array:
        """The value of a function, with ``params`` where symbols are free."""
        options = {"params": dict(parameters)} if parameters else {}
        return np.asarray(getattr(self.module, function)(*arguments, **options))

    def inverse(self, poses: Array, given: Array, parameters: Parameters) -> tuple[Array, Array]:
        """Joint variables, (poses, branches, n), and the status of branches, for given joints' variables (poses, k)."""
        options: dict[str, Any] = {"params": dict(parameters)} if parameters else {}
        if given.shape[-1]:
            options["given"] = given if len(poses) > 1 else given[0]
        solve = getattr(self.module, f"inverse_kinematics_{self.end}" if self.end else "inverse_kinematics")
        q, status = solve(poses if len(poses) > 1 else poses[0], status=True, **options)
        return (q, status) if len(poses) > 1 else (q[None], status[None])


class NativeModel(NumpyModel):
    """``model_native.py``: the same functions, compiled."""

    target = "native"
    file = "model_native.py"


@dataclass(frozen=True, slots=True)
class CasadiModel:
    """CasADi functions of one configuration; a batch goes through ``Function.map``."""

    constants: Mapping[str, Any]  # the module's names, ``DOF`` and ``PARAMETERS`` among them
    function: Callable[[str], Any]  # the ``casadi.Function`` of a name
    target: str = "casadi"  # ``casadi``, or ``casadi-c`` for its C export
    file: str = "model_casadi.py"  # name of the module's file
    kept: object = None  # what has to stay as long as the functions do
    ways = ("one", "batch")

    def call(self, function: str, arguments: Sequence[Array], parameters: Parameters) -> Array:
        """The value of a function of columns, for arguments (n,) or (samples, n).

        CasADi knows matrices only: vectors are columns and square matrices of a stack lie side by side, 4 x 4n.
        """
        handle = self.function(function)
        columns = [np.atleast_2d(argument).T for argument in arguments]
        count = columns[0].shape[1] if columns else 1
        if parameters:
            numbers = [[float(parameters[name])] for name in self.constants["PARAMETERS"]]
            columns.append(np.repeat(numbers, count, axis=1))
        mapped = handle if count == 1 else handle.map(count)
        value = mapped(*columns) if columns else mapped()[handle.name_out(0)]
        stacked = np.asarray(value.full())
        blocks: Array = stacked.reshape(stacked.shape[0], count, handle.size2_out(0)).transpose(1, 0, 2)
        axes = FUNCTIONS[stem(function)].axes
        if axes == 3:
            size = blocks.shape[1]
            blocks = blocks.reshape(count, size, -1, size).transpose(0, 2, 1, 3)
        elif axes < 2 and blocks.shape[2] == 1:
            blocks = blocks[:, :, 0] if axes else blocks[:, 0, 0]
        return blocks if arguments and arguments[0].ndim > 1 else blocks[0]

    def inverse(self, poses: Array, given: Array, parameters: Parameters) -> tuple[Array, Array]:
        """Inverse kinematics, see `NumpyModel`; branch by branch."""
        listed = self.constants["inverse_kinematics"]
        branches = [self.function(name) if isinstance(name, str) else name for name in listed]
        numbers = [[float(parameters[name]) for name in self.constants["PARAMETERS"]]] if parameters else []
        rows: list[tuple[list[Array], list[float]]] = []
        for pose, values in zip(poses, given, strict=True):
            inputs = [*([values] if len(values) else []), *numbers]
            found = [branch(pose.reshape(branch.size_in(0)), *inputs) for branch in branches]
            rows.append(([np.asarray(q)[:, 0] for q, _ in found], [float(status) for _, status in found]))
        return np.array([q for q, _ in rows]), np.array([status for _, status in rows]).astype(int)


@dataclass(frozen=True)
class CModel:
    """The compiled ``model.c``: functions of one configuration and of a batch."""

    shared: ctypes.CDLL  # the library
    header: str  # text of ``model.h``, in which shapes and numbers are read
    target = "c"
    file = "model.c"
    ways = ("one", "batch", "blocks")

    @cached_property
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
        """Inverse kinematics, see `NumpyModel`."""
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


def _pointer(array: Array) -> Any:
    return array.ctypes.data_as(ctypes.c_void_p)


def find_octave() -> Command | None:
    """Command of Octave: ``$OCTAVE``, else the usual names on the path; None if there is none."""
    return find_command("OCTAVE", OCTAVES)


def octave_package(folder: Path) -> str:
    """The package of MATLAB and Octave in a folder."""
    return next((path.name for path in sorted(folder.glob("+*")) if (path / FIRST_FILE).is_file()), "")


@dataclass(frozen=True)
class OctaveModel:
    """The functions of a package of MATLAB and Octave: of one configuration and of a batch."""

    folder: Path  # the folder of the package
    process: subprocess.Popen[bytes]  # Octave, which answers
    said: IO[bytes]  # what it says beside
    target = "octave"
    ways = ("one", "batch")

    @property
    def file(self) -> str:
        """Name of the package's folder."""
        return self.folder.name

    @cached_property
    def constants(self) -> Mapping[str, Any]:
        """``DOF``, ``PARAMETERS`` and ``GIVEN``, as the package says, and the names of its functions."""
        (codes,) = self.results("model", [], 1)
        dof, parameters, given = "".join(map(chr, codes.ravel().astype(int).tolist())).split(";")
        names: dict[str, tuple[str, ...]] = {path.stem: () for path in self.folder.glob("*.m")}
        texts = {"PARAMETERS": parameters, "GIVEN": given}
        return names | {"DOF": int(dof)} | {name: tuple(filter(None, text.split(","))) for name, text in texts.items()}

    def call(self, function: str, arguments: Sequence[Array], parameters: Parameters) -> Array:
        """The value of a function; configurations are columns there, and the last axis of the result counts them."""
        columns = [np.atleast_2d(argument).T for argument in arguments]
        count, axes = columns[0].shape[1] if columns else 1, FUNCTIONS[stem(function)].axes
        (value,) = self.results(function, [*columns, *self._numbers(parameters)], 1)
        if axes == 0:
            value = value.reshape(value.size)
        elif axes == 1:
            value = value.T
        else:
            value = value.reshape(*value.shape[:2], -1, count, order="F") if axes == 3 else _stack(value, count)
            value = value.transpose(3, 2, 0, 1) if axes == 3 else value.transpose(2, 0, 1)
        return value if arguments and arguments[0].ndim > 1 else value[0]

    def inverse(self, poses: Array, given: Array, parameters: Parameters) -> tuple[Array, Array]:
        """Inverse kinematics; poses are pages there, and branches columns."""
        inputs = [poses.transpose(1, 2, 0), *([given.T] if given.shape[-1] else []), *self._numbers(parameters)]
        q, status = self.results("inverse_kinematics", inputs, 2)
        return _stack(q, len(poses)).transpose(2, 1, 0), status.T.astype(int)

    def results(self, function: str, inputs: Sequence[Array], count: int) -> list[Array]:
        """What a function of the package returns."""
        name = f"{self.folder.name[1:]}.{function}"
        request = [np.array([len(name), len(inputs), count, *map(ord, name)], dtype=float)]
        for value in inputs:
            array = np.asarray(value, dtype=float)
            request += [np.array([array.ndim, *array.shape], dtype=float), array.ravel(order="F")]
        assert self.process.stdin is not None
        timer = threading.Timer(SECONDS, self.process.kill)
        timer.daemon = True  # an interrupt may leave it running
        with uninterrupted():
            timer.start()
        try:
            self.process.stdin.write(b"".join(part.tobytes() for part in request))
            self.process.stdin.flush()
            message = self._received()
            if message.size:
                text = "".join(map(chr, message.ravel().astype(int).tolist()))
                raise VerificationError(f"{function} of {self.file} is refused by Octave: {text}")
            return [self._received() for _ in range(count)]
        except OSError as error:
            raise self._ended() from error
        finally:
            timer.cancel()

    def _numbers(self, parameters: Parameters) -> list[Array]:
        return [np.array([[float(parameters[name])] for name in self.constants["PARAMETERS"]])] if parameters else []

    def _received(self) -> Array:
        (rank,) = self._read(1)
        extent = self._read(int(rank)).astype(int)
        return self._read(int(np.prod(extent))).reshape(extent, order="F")

    def _read(self, count: int) -> Array:
        assert self.process.stdout is not None
        data = self.process.stdout.read(8 * count)
        if len(data) < 8 * count:
            raise self._ended()
        return np.frombuffer(data)

    def _ended(self) -> VerificationError:
        self.said.seek(0)
        said = self.said.read().decode(errors="replace").strip().splitlines()
        return VerificationError(f"Octave ended while it ran {self.file}{f': {said[0]}' if said else ''}")


def _stack(value: Array, count: int) -> Array:
    """Pages with an axis for them, which Octave drops where there is one."""
    return value.reshape(*value.shape[:2], count, order="F")


@contextmanager
def running_octave(folder: Path, octave: Command | None) -> Iterator[tuple[OctaveModel, ...]]:
    """Run Octave on the package in a folder, as long as it is needed."""
    package = octave_package(folder)
    if octave is None or not package:
        yield ()
        return
    with TemporaryFolder() as temporary, tempfile.TemporaryFile() as said:
        script = temporary.path / "server.m"
        script.write_text(render("octave/server.m.jinja"), encoding="utf-8")
        process = subprocess.Popen(
            [*octave, *OCTAVE_OPTIONS, str(script), str(folder.resolve())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=said,
            start_new_session=True,  # an interrupt from the terminal is ours to answer
        )
        try:
            yield (OctaveModel(folder / package, process, said),)
        finally:
            process.kill()
            process.communicate()


GeneratedModel = NumpyModel | CasadiModel | CModel | OctaveModel


def load_models(folder: Path, *, needing_library: bool | None = None) -> tuple[GeneratedModel, ...]:
    """The generated modules in Python: those that load a compiled library, the others, or with None all."""
    chosen = [file for file in _IMPORTED if needing_library in (None, file == NativeModel.file)]
    return tuple(_IMPORTED[file](_import(folder / file)) for file in chosen if (folder / file).is_file())


def compile_models(folder: Path, compiler: Command | None) -> tuple[GeneratedModel, ...]:
    """The generated sources in C, compiled for the occasion."""
    if compiler is None:
        return ()
    return tuple(load(folder / file, compiler) for file, load in _COMPILED.items() if (folder / file).is_file())


def all_models(
    folder: Path, compiler: Command | None, octave: Command | None, libraries: Callable[[], None]
) -> Iterator[GeneratedModel]:
    """All targets, those last whose libraries take longest; the C compiler works while the others are used."""
    with running_octave(folder, octave) as packages, compiling_meanwhile(compile_models, folder, compiler) as compiled:
        yield from load_models(folder, needing_library=False)
        yield from packages
        yield from compiled()
        libraries()
        yield from load_models(folder, needing_library=True)


class _Traceless(SourceFileLoader):
    """Reads and writes no byte code: a stale cache would hide what was just generated."""

    def path_stats(self, path: Any) -> Mapping[str, Any]:
        """Refuse, which is how the loader learns that there is no cache."""
        raise OSError("byte code is not wanted")


def _import(path: Path) -> ModuleType:
    """A module that is known to nobody else."""
    loader = _Traceless(f"_derive_verification_of_{path.stem}", str(path))
    module = ModuleType(loader.name)
    module.__file__ = str(path)
    try:
        loader.exec_module(module)
    except Exception as error:
        raise VerificationError(f"{path.name} cannot be imported: {type(error).__name__}: {error}") from error
    return module


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


def load_casadi_c(path: Path, compiler: Command) -> CasadiModel:
    """Compile and load CasADi's C export; joints and parameters are read in its heading."""
    import casadi

    temporary = TemporaryFolder()
    library = temporary.path / "model_casadi.so"
    try:
        compile_shared(compiler, [path], library, CASADI_OPTIONS)
    except TargetError as error:
        temporary.cleanup()
        raise VerificationError(f"{path.name} cannot be compiled: {error}") from error
    heading = path.read_text(encoding="utf-8")
    listed = re.search(r"^ \* Order of the entries of params.*:\n((?: \*     \w+\n)*)", heading, re.MULTILINE)
    joints = re.search(r"columns of ([0-9]+):", heading)
    names = tuple(line.removeprefix(" *").strip() for line in listed[1].splitlines()) if listed else ()
    constants: dict[str, Any] = {"DOF": int(joints[1]) if joints else 0, "PARAMETERS": names}
    branches = sorted(set(re.findall(r"\binverse_kinematics_[0-9]+\b", heading)), key=lambda name: int(name[19:]))
    if branches:
        given = re.search(r"^ \* Given joints: (.*)$", heading, re.MULTILINE)
        constants |= {"inverse_kinematics": branches, "GIVEN": tuple(given[1].split(", ")) if given else ()}
    external = cache(lambda name: casadi.external(name, str(library)))
    return CasadiModel(constants, external, "casadi-c", path.name, kept=temporary)


_IMPORTED: Mapping[str, Callable[[ModuleType], GeneratedModel]] = {
    NumpyModel.file: NumpyModel,
    "model_casadi.py": lambda module: CasadiModel(vars(module), partial(getattr, module)),
    NativeModel.file: NativeModel,
}

_COMPILED: Mapping[str, Callable[[Path, Command], GeneratedModel]] = {
    "model.c": load_c_model,
    "model_casadi.c": load_casadi_c,
}

COMPILED = frozenset(_COMPILED)  # files that are verified where there is a C compiler
MODULES = COMPILED.union(_IMPORTED)  # files that are verified
