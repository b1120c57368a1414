"""Small C and C++ libraries for loops without Python in them, kept for the next run."""

from __future__ import annotations

import ctypes
import hashlib
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from bench.environment import environment

BUILD = Path(__file__).parent / ".build"
FLAGS = ("-O3", "-march=native", "-fPIC", "-shared")


class NoCompiler(RuntimeError):
    """There is no compiler for that language here."""


def library(source: Path, flags: Sequence[str] = (), also: Sequence[Path] = ()) -> ctypes.CDLL:
    """Compile a file and load it.

    Args:
        source: A ``.c`` or ``.cpp`` file.
        flags: Further flags; libraries come last.
        also: Files that it includes, so that a change of them compiles again.

    Raises:
        NoCompiler: There is none.
        RuntimeError: It does not compile.
    """
    command = compiler(source)
    BUILD.mkdir(exist_ok=True)
    seen = hashlib.sha256(" ".join([environment()["processor"], environment()["C compiler"], *flags]).encode())
    for path in (source, *also):
        seen.update(path.read_bytes())
    target = BUILD / f"{source.stem}-{seen.hexdigest()[:16]}.so"
    if not target.is_file():
        done = subprocess.run(
            [command, *FLAGS, str(source), "-o", str(target), *flags], capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise RuntimeError(f"{source.name} does not compile: {_first_error(done.stderr)}")
    return ctypes.CDLL(str(target))


def compiler(source: Path) -> str:
    """The command for a file."""
    names = ("c++", "g++", "clang++") if source.suffix == ".cpp" else ("cc", "gcc", "clang")
    for name in names:
        found = shutil.which(name)
        if found:
            return found
    raise NoCompiler(f"no {'C++' if source.suffix == '.cpp' else 'C'} compiler")


def _first_error(text: str) -> str:
    lines = [line for line in text.splitlines() if "error" in line] or text.splitlines()[:1]
    return lines[0].rsplit("/", 1)[-1][:160] if lines else "no message"
