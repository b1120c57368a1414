"""From a robot to its verified folder: render in memory, write beside the target, verify there, take its place."""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path

from derive import __version__
from derive.algebra.collection import uncollected
from derive.algebra.effort import effort_named
from derive.build.libraries import compile_libraries, library_names
from derive.build.manifest import FILE as MANIFEST
from derive.build.manifest import compiled_files, is_current, read_manifest
from derive.build.publish import heal, publish
from derive.build.render import render_robot
from derive.build.results import BuildResult, CheckResult, Progress
from derive.check.verify import Report, verify
from derive.compiler import require_compiler
from derive.emit.readme_target import package_name
from derive.emit.registry import targets_named
from derive.robot.robot import Robot


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
