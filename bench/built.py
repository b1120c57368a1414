"""Models as `derive build` writes them, imported."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from functools import cache
from pathlib import Path
from shutil import rmtree
from types import ModuleType

from bench.compilers import BUILD
from bench.robots import FOLDER

ROOT = FOLDER.parents[1]


def build(name: str, target: str) -> Path:
    """The folder of a robot of the harness, built anew once per process, with one target, by the command.

    Raises:
        RuntimeError: It cannot be built; the message is the command's last line.
    """
    result = _built(name, target)
    if isinstance(result, str):
        raise RuntimeError(result)
    return result


@cache
def _built(name: str, target: str) -> Path | str:
    BUILD.mkdir(exist_ok=True)
    out = BUILD / f"{name}-{target}"
    rmtree(out, ignore_errors=True)
    command = [sys.executable, "-m", "derive", "build", str(FOLDER / f"{name}.yaml"), "--target", target]
    done = subprocess.run(
        [*command, "--out", str(out), "--quiet"], capture_output=True, text=True, check=False, cwd=ROOT
    )
    if done.returncode:
        lines = (done.stderr or done.stdout).strip().splitlines()
        return f"derive build --target {target}: {lines[-1][-160:] if lines else done.returncode}"
    return next(path for path in out.iterdir() if path.is_dir() and not path.name.startswith("."))


def module(name: str, target: str, file: str) -> ModuleType:
    """A generated module of that folder, imported as part of its package."""
    folder = build(name, target)
    package = f"bench_{target}_{folder.name}"
    _load(package, folder / "__init__.py", [str(folder)])
    return _load(f"{package}.{Path(file).stem}", folder / file)


def imported(path: Path) -> ModuleType:
    """A module by its file."""
    return _load(f"bench_{path.stem}", path)


def _load(name: str, path: Path, search: list[str] | None = None) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, path, submodule_search_locations=search)
    assert spec is not None
    assert spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    sys.modules[name] = loaded
    spec.loader.exec_module(loaded)
    return loaded
