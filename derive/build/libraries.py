"""Compiles what targets hand to the C compiler, in the folder in which they were written."""

from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from derive.compiler import Command, compile_shared
from derive.emit.target import Target
from derive.errors import OutputError, TargetError

OPTIONS = ("-std=c99", "-O3", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math")
"""Products and sums may be fused and nobody reads `errno` or traps; nothing here changes the order of operations."""

PROCESSORS = (("-march=native",), ("-mcpu=native",), ())
"""Names that compilers have for the processor at hand, tried in this order."""


def library_names(targets: Iterable[Target]) -> tuple[str, ...]:
    """Names of the libraries of some targets."""
    return tuple(name for target in targets for name in target.compiled)


def compile_libraries(folder: Path, targets: Iterable[Target], compiler: Command, former: Path | None = None) -> None:
    """Compile the libraries of some targets.

    Args:
        folder: Where the sources are and the libraries go.
        targets: The targets.
        compiler: The compiler's command.
        former: A folder built earlier: what has the same sources there is taken from there.

    Raises:
        TargetError: The compiler refused.
        OutputError: A library cannot be written.
    """
    try:
        for target in targets:
            for name, sources in target.compiled.items():
                if former and _is_same(folder, former, name, sources):
                    shutil.copy2(former / name, folder / name)
                else:
                    _compile(compiler, folder / sources[0], folder / name)
                _flush(folder / name)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {error.strerror or error}", remedy="make room") from error


def _is_same(folder: Path, former: Path, name: str, sources: Iterable[str]) -> bool:
    paths = [former / name, *(former / source for source in sources)]
    if any(path.is_symlink() or not path.is_file() for path in paths):
        return False
    return all(filecmp.cmp(folder / source, former / source, shallow=False) for source in sources)


def _compile(compiler: Command, source: Path, library: Path) -> None:
    for place, processor in enumerate(PROCESSORS):
        try:
            return compile_shared(compiler, [source], library, (*OPTIONS, *processor))
        except TargetError:
            if place + 1 == len(PROCESSORS):
                raise


def _flush(path: Path) -> None:
    with open(path, "rb+") as file:
        os.fsync(file.fileno())
