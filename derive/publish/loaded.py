"""Generated functions in this process, without a folder that stays: written for the occasion, imported, kept."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from derive.errors import TargetError
from derive.interrupts import TemporaryFolder
from derive.targets import numpy
from derive.targets.compiler import find_compiler
from derive.targets.target import Source


def loaded(source: Source, *, compiled: bool) -> tuple[ModuleType, TemporaryFolder]:
    """``model_numpy.py``, or ``model_native.py`` where a compiler serves, and the folder that holds it while kept."""
    temporary = TemporaryFolder()
    folder = temporary.path
    compiler = find_compiler() if compiled else None
    targets = [numpy.TARGET]
    if compiler:
        from derive.publish.render import compile_libraries
        from derive.targets import c, native

        targets = [c.TARGET, native.TARGET]
    for target in targets:
        for name, text in target.render(source).items():
            (folder / name).write_text(text, encoding="utf-8")
    if compiler:
        try:
            compile_libraries(folder, targets, compiler)
        except TargetError:  # a compiler that does not serve is none
            return loaded(source, compiled=False)
    return module_of(folder / targets[-1].files[0], f"derive_loaded_{folder.name}"), temporary


def module_of(file: Path, name: str) -> ModuleType:
    """A module of generated code, imported from its file."""
    spec = spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
