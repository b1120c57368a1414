"""Generated functions as a module of this process: rendered, compiled if asked for, and imported."""

from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Self

from derive.errors import TargetError
from derive.interrupts import TemporaryFolder
from derive.targets import c, native, numpy
from derive.targets.compiler import find_compiler, require_compiler
from derive.targets.target import Source

KEPT = 64  # how many robots' functions a process keeps


@dataclass(frozen=True, slots=True)
class ModuleSources:
    """The texts of a module, which other processes import, too; a compiled one is compiled where it is imported."""

    files: tuple[tuple[str, str], ...]  # texts by name, the module last
    compiled: bool

    @classmethod
    def of(cls, source: Source, *, compiled: bool) -> Self:
        """Those of ``model_native.py``, or of ``model_numpy.py``."""
        targets = [c.TARGET, native.TARGET] if compiled else [numpy.TARGET]
        files = {name: text for target in targets for name, text in target.render(source).items()}
        module = targets[-1].files[0]
        return cls((*(pair for pair in files.items() if pair[0] != module), (module, files[module])), compiled)


@lru_cache(KEPT)
def imported(sources: ModuleSources) -> tuple[ModuleType, TemporaryFolder]:
    """The module, and the folder that holds it as long as both are kept; refused where it lacks its compiler."""
    compiler = require_compiler() if sources.compiled else None
    temporary = TemporaryFolder()
    for name, text in sources.files:
        (temporary.path / name).write_text(text, encoding="utf-8")
    if compiler:
        from derive.publish.render import compile_libraries  # motions of few samples compile nothing

        compile_libraries(temporary.path, [c.TARGET, native.TARGET], compiler)
    return module_of(temporary.path / sources.files[-1][0], f"derive_module_{temporary.path.name}"), temporary


def serving_sources(source: Source, *, compiled: bool = True) -> ModuleSources:
    """Those of ``model_numpy.py``, or of ``model_native.py`` where a compiler serves."""
    if compiled and find_compiler():
        with suppress(TargetError):  # a compiler that does not serve is none
            imported(found := ModuleSources.of(source, compiled=True))
            return found
    return ModuleSources.of(source, compiled=False)


def loaded(source: Source, *, compiled: bool) -> tuple[ModuleType, TemporaryFolder]:
    """The module of `serving_sources`, and the folder that holds it."""
    return imported(serving_sources(source, compiled=compiled))


def module_of(file: Path, name: str) -> ModuleType:
    """A module of generated code, imported from its file."""
    spec = spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
