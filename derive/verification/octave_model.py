"""The package of MATLAB and Octave as a callable: one process of Octave answers all calls, in numbers through pipes."""

import subprocess
import tempfile
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import IO, Any

import numpy as np

from derive.errors import VerificationError
from derive.interrupts import TemporaryFolder, uninterrupted
from derive.targets.compiler import Command, find_command
from derive.targets.templating import render
from derive.verification.oracle.frames import Array
from derive.verification.oracle.functions import FUNCTIONS, stem
from derive.verification.samples import Parameters

NAMES = ("octave-cli", "octave")  # looked for in this order where ``$OCTAVE`` is not set
OPTIONS = ("--norc", "--no-history", "--quiet", "--no-gui")  # nobody's settings, no trace, no window
SECONDS = 600  # longest call
FIRST_FILE = "link_transforms.m"  # every package of ours has it


def find_octave(environment: Mapping[str, str] | None = None) -> Command | None:
    """Command of Octave: ``$OCTAVE``, else the usual names on the path of an environment; None if there is none."""
    return find_command("OCTAVE", NAMES, environment)


def octave_package(folder: Path) -> str:
    """The package of MATLAB and Octave in a folder."""
    return next((path.name for path in sorted(folder.glob("+*")) if (path / FIRST_FILE).is_file()), "")


@dataclass(frozen=True)
class OctaveModel:
    """The functions of a package: of one configuration and of a batch."""

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
            [*octave, *OPTIONS, str(script), str(folder.resolve())],
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
