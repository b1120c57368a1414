"""The C compiler of this system: found by ``$CC`` or by its usual names, and run."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from derive.errors import TargetError

NAMES = ("cc", "gcc", "clang")
"""Looked for in this order where ``$CC`` is not set."""

SECONDS = 600
"""Longest run of a compiler."""

Command = tuple[str, ...]


def find_compiler(environment: Mapping[str, str] | None = None) -> Command | None:
    """Look for the C compiler.

    Args:
        environment: Where ``CC`` and ``PATH`` are looked up; None for the process's.

    Returns:
        Its command, ``$CC`` before the usual names; None if there is none.
    """
    variables = os.environ if environment is None else environment
    path = variables.get("PATH", os.defpath)
    given = shlex.split(variables.get("CC", ""))
    for command in [given] if given else [[name] for name in NAMES]:
        found = shutil.which(command[0], path=path)
        if found:
            return (found, *command[1:])
    return None


def require_compiler() -> Command:
    """The command of the C compiler of this process's environment.

    Raises:
        TargetError: There is none.
    """
    compiler = find_compiler()
    if compiler is None:
        given = os.environ.get("CC")
        found = f"the C compiler of $CC, {given!r}, was not found" if given else f"no C compiler ({', '.join(NAMES)})"
        raise TargetError(found, remedy="install one, for instance gcc or clang, or name it in $CC")
    return compiler


def compile_shared(compiler: Command, sources: Sequence[Path], library: Path, options: Sequence[str] = ()) -> None:
    """Compile C into a shared library.

    Args:
        compiler: From `find_compiler`.
        sources: The files.
        library: What to write.
        options: Further options.

    Raises:
        TargetError: The compiler refused, in its own first words.
    """
    command = [*compiler, "-shared", "-fPIC", *options, *map(str, sources), "-o", str(library), "-lm"]
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=SECONDS,
            start_new_session=True,  # an interrupt from the terminal is ours to answer
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise TargetError(f"the C compiler {compiler[0]} did not run: {type(error).__name__}: {error}") from error
    if done.returncode != 0:
        reason = next((line for line in done.stderr.splitlines() if "error" in line), "without saying why")
        raise TargetError(f"the C compiler {compiler[0]} failed: {reason.strip()}")
