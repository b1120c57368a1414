"""From a robot to its verified folder: render in memory, write beside the target, verify there, take its place.

Compiles what targets hand to the C compiler, in the folder in which they were written.
"""

from __future__ import annotations

import filecmp
import os
import shutil
import time
from collections.abc import Iterable
from pathlib import Path

from derive.errors import OutputError, TargetError
from derive.programs.effort import effort_named, uncollected
from derive.publish.manifest import FILE as MANIFEST
from derive.publish.manifest import compiled_files, is_current, read_manifest
from derive.publish.publish import heal, publish
from derive.publish.render import render_robot
from derive.publish.results import BuildResult, CheckResult, Progress
from derive.publish.targets import targets_named
from derive.robot.robot import Robot
from derive.targets.compiler import Command, compile_shared, require_compiler
from derive.targets.readme import package_name
from derive.targets.target import Target
from derive.verify.report import Report
from derive.verify.verify import verify
from derive.version import __version__

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


def folder_of(robot: Robot, out: Path) -> Path:
    """The folder of a robot below ``out``: its name as Python can import it."""
    return out / package_name(robot)


def build_robot(
    robot: Robot,
    out: Path,
    targets: Iterable[str] | None = None,
    *,
    verified: bool = True,
    force: bool = False,
    effort: str | None = None,
    progress: Progress | None = None,
) -> BuildResult:
    """Builds one robot into ``out/<robot_name>``.

    Args:
        robot: The robot.
        out: Parent folder; made if there is none.
        targets: Names of targets; None for all.
        verified: Whether every generated function is compared with the independent recursion first.
        force: Whether to build even what has not changed.
        effort: See `effort_named`.
        progress: Told the stages.

    Raises:
        TargetError: An unknown target, or no C compiler for one that needs it.
        OutputError: The folder cannot or may not be written.
        VerificationError: A generated function is wrong; the old folder stays.
    """
    started = time.perf_counter()
    tell = progress or _silent
    chosen, spent = targets_named(targets), effort_named(effort)
    target = folder_of(robot, out)
    heal(out)
    if not force and is_current(target, robot.digest, __version__, chosen, spent):
        tell(robot.name, "unchanged")
        return BuildResult(robot.name, target, _files_in(target), True, {}, None, _since(started))
    libraries = library_names(chosen)
    compiler = require_compiler() if libraries else None
    tell(robot.name, "derive")
    with uncollected():
        rendered = render_robot(robot, chosen, spent)

    def check(folder: Path) -> Report | None:
        if compiler:
            tell(robot.name, "compile")
            compile_libraries(folder, chosen, compiler, None if force else target)
        return _verified(robot, folder, tell) if verified else None

    report = publish(rendered.files, target, robot.name, check, libraries)
    tell(robot.name, "built")
    files = (*rendered.files, *libraries)
    return BuildResult(robot.name, target, files, False, rendered.operations, report, _since(started))


def _verified(robot: Robot, folder: Path, tell: Progress) -> Report:
    tell(robot.name, "verify")
    return verify(robot, folder)


def _files_in(folder: Path) -> tuple[str, ...]:
    """The files of a folder that is current."""
    manifest = read_manifest(folder) or {"files": {}}
    return (*manifest["files"], MANIFEST, *compiled_files(manifest))


def check_robot(
    robot: Robot, out: Path, targets: Iterable[str] | None = None, effort: str | None = None
) -> CheckResult:
    """Compares the folder of a robot with what a build would write, byte by byte; writes nothing.

    Of compiled libraries only the presence is checked: what a compiler makes of the same text is its own affair.

    Raises:
        TargetError: An unknown target.
    """
    target = folder_of(robot, out)
    chosen = targets_named(targets)
    wanted = render_robot(robot, chosen, effort_named(effort)).files
    found = {name: _contents(target / name) for name in wanted}
    libraries = library_names(chosen)
    absent = [name for name in libraries if not (target / name).is_file()]
    manifest = read_manifest(target) or {"files": {}}
    listed = (*manifest["files"], *compiled_files(manifest))
    return CheckResult(
        robot=robot.name,
        folder=target,
        stale=tuple(sorted(name for name, data in found.items() if data is not None and data != wanted[name])),
        missing=tuple(sorted([*(name for name, data in found.items() if data is None), *absent])),
        extra=tuple(sorted(name for name in listed if name not in (*wanted, *libraries) and (target / name).is_file())),
    )


def _contents(path: Path) -> bytes | None:
    try:
        return None if path.is_symlink() else path.read_bytes()
    except OSError:
        return None


def _since(started: float) -> float:
    return time.perf_counter() - started


def _silent(robot: str, stage: str) -> None:
    """Progress that nobody asked for."""
