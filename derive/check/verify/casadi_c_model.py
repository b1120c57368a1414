"""``model_casadi.c``, compiled for the occasion and called through ``casadi.external``."""

from __future__ import annotations

import re
import tempfile
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from derive.compiler import Command, compile_shared
from derive.errors import TargetError, VerificationError

FILE = "model_casadi.c"
OPTIONS = ("-O0",)

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
        compile_shared(compiler, [folder / FILE], path, OPTIONS)
    except TargetError as error:
        temporary.cleanup()
        raise VerificationError(f"{FILE} cannot be compiled: {error}") from error
    heading = (folder / FILE).read_text(encoding="utf-8")
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
