"""From a robot to its verified folder: render in memory, write beside the target, verify there, take its place."""

import gc
import shutil
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from derive.errors import TargetError
from derive.interrupts import TemporaryFolder
from derive.programs.optimise.search_policy import Effort
from derive.publish.atomic_folder import OvertakenError, heal, publish, require_replaceable, rewrite, system_errors
from derive.publish.manifest import FILE as MANIFEST
from derive.publish.manifest import compiled_files, contents, is_current, read_manifest, written_targets
from derive.publish.render import Rendered, compile_libraries, library_names, render_robot, rendering
from derive.publish.targets import targets_named
from derive.robot.robot import Robot
from derive.targets.compiler import Command, compiling_meanwhile, require_compiler
from derive.targets.target import Target, package_name
from derive.verification.verify import Report, verify
from derive.version import __version__

# Called with the robot's name and a stage: derive, compile, verify, done or failed.
Progress = Callable[[str, str], None]


@dataclass(frozen=True, slots=True)
class BuildResult:
    """A robot that was built, or need not be."""

    robot: str  # its name
    folder: Path  # where its files are
    files: tuple[str, ...]  # their names
    unchanged: bool  # whether nothing had to be done
    operations: dict[str, dict[str, int]]  # operation counts by function; empty if nothing was done
    report: Report | None  # what the verification found; None if it was off or nothing was done
    seconds: float  # wall time

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {
            "robot": self.robot,
            "folder": str(self.folder),
            "files": list(self.files),
            "status": "unchanged" if self.unchanged else "built",
            "operations": self.operations,
            "verification": self.report.as_dict() if self.report else None,
            "seconds": round(self.seconds, 3),
        }


@dataclass(frozen=True, slots=True)
class BuildFailure:
    """A robot that could not be built."""

    robot: str  # its name
    error: Exception  # why

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {"robot": self.robot, "status": "failed", "error": str(self.error)}


@dataclass(frozen=True, slots=True)
class CheckResult:
    """How a folder differs from what a build would write."""

    robot: str  # name of the robot
    folder: Path
    stale: tuple[str, ...]  # files with other contents
    missing: tuple[str, ...]  # files that are not there
    extra: tuple[str, ...]  # files of an earlier build that this one would not write

    @property
    def is_current(self) -> bool:
        """Whether there is no difference."""
        return not (self.stale or self.missing or self.extra)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {
            "robot": self.robot,
            "folder": str(self.folder),
            "status": "current" if self.is_current else "stale",
            "stale": list(self.stale),
            "missing": list(self.missing),
            "extra": list(self.extra),
        }


def folder_of(robot: Robot, out: Path) -> Path:
    """The folder of a robot."""
    return out / package_name(robot)


def build_robot(
    robot: Robot,
    out: Path,
    targets: Iterable[str] | None = None,
    *,
    only: bool = False,
    verified: bool = True,
    force: bool = False,
    effort: Effort = Effort.FULL,
    progress: Progress | None = None,
) -> BuildResult:
    """Builds one robot into ``out/<robot_name>``: usual targets, those asked for, and those that the folder holds.

    Args:
        targets: Names of targets beside those of a usual build; None for no others.
    """
    started = time.perf_counter()
    tell = progress or (lambda robot, stage: None)
    target = folder_of(robot, out)
    heal(out)

    def _chosen() -> tuple[Target, ...]:
        return targets_named(targets, written_targets(target), only=only)

    while True:
        chosen = _chosen()
        if not force and is_current(target, robot.digest, __version__, chosen, effort):
            tell(robot.name, "unchanged")
            texts, compiled = _listed_files(target)
            files = (*texts, MANIFEST, *compiled)
            return BuildResult(robot.name, target, files, True, {}, None, time.perf_counter() - started)
        require_replaceable(target, robot.name, ())  # before the work is done
        libraries = library_names(chosen)
        compiler = _compiler_for(libraries, targets_named(targets), target) if libraries else None
        tell(robot.name, "derive")
        try:
            with (
                _uncollected(),
                _compiling(chosen, compiler, None if force else target) as (begin, take),
                rendering(robot, chosen, effort, begin) as (first, whole),
            ):
                stages = (["compile"] if libraries or not verified else []) + (["verify"] if verified else [])
                tell(robot.name, " and ".join(stages))
                finish = partial(_finished, robot, take, whole, verified, target)
                late = [name for each in chosen if not each.needs_program for name in each.files]
                further, still = [*libraries, *late], lambda written=chosen: written == _chosen()
                report, rendered = publish(first.files, target, robot.name, finish, further, still)
        except OvertakenError:  # a build of other targets was faster, and what it has written stays
            continue
        tell(robot.name, "built")
        files = (*rendered.files, *libraries)
        return BuildResult(robot.name, target, files, False, rendered.operations, report, time.perf_counter() - started)


def _compiler_for(libraries: Sequence[str], asked: Sequence[Target], folder: Path) -> Command:
    """The C compiler; where only libraries of an earlier build need it, its lack is told with a way round it."""
    try:
        return require_compiler()
    except TargetError as error:
        if library_names(asked):
            raise
        held = f"{error.found}, and {folder.name} holds native code of an earlier build, which is kept up to date"
        raise TargetError(held, remedy=f"{error.remedy}; or leave it out of the folder with --only") from None


@contextmanager
def _compiling(
    targets: Sequence[Target], compiler: Command | None, former: Path | None
) -> Iterator[tuple[Callable[[Mapping[str, bytes]], None], Callable[[Path], None]]]:
    """What begins to compile the libraries of some sources, beside what follows, and what puts them into a folder."""
    with ExitStack() as stack:
        temporary = stack.enter_context(TemporaryFolder()).path
        ready: list[Callable[[], None]] = []

        def _begin(sources: Mapping[str, bytes]) -> None:
            for name, data in sources.items():
                (temporary / name).write_bytes(data)
            assert compiler is not None, "it was asked for before anything was rendered"
            work = compiling_meanwhile(compile_libraries, temporary, targets, compiler, former)
            ready.append(stack.enter_context(work))

        def _take(folder: Path) -> None:
            for wait in ready:
                wait()
            with system_errors(folder, "make room"):
                for name in library_names(targets):
                    shutil.copy2(temporary / name, folder / name)

        yield _begin, _take


def _finished(
    robot: Robot,
    take: Callable[[Path], None],
    whole: Callable[[], Rendered],
    verified: bool,
    target: Path,
    folder: Path,
) -> tuple[Report | None, Rendered]:
    """Checks what is made of the program, and then adds the rest to it, which takes as long to render."""
    report = verify(robot, folder, libraries=partial(take, folder)) if verified else None
    if not verified:
        take(folder)
    rendered = whole()
    rewrite(rendered.files, folder, target)
    return report, rendered


@contextmanager
def _uncollected() -> Iterator[None]:
    """Collect no cycles of references while a robot is rendered and verified.

    The search makes millions of small objects and hardly a cycle, as do generated modules that are called: collecting
    them takes a sixth of the time. What is in no cycle is freed as ever.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def check_robot(
    robot: Robot,
    out: Path,
    targets: Iterable[str] | None = None,
    effort: Effort = Effort.FULL,
    *,
    only: bool = False,
) -> CheckResult:
    """Compares the folder of a robot with what a build would write, byte by byte; writes nothing.

    Of compiled libraries only the presence is checked: what a compiler makes of the same text is its own affair.

    Args:
        targets: Names of targets beside those of a usual build; None for no others.
    """
    target = folder_of(robot, out)
    chosen = targets_named(targets, written_targets(target), only=only)
    wanted = render_robot(robot, chosen, effort).files
    found = {name: contents(target / name) for name in wanted}
    libraries = library_names(chosen)
    absent = [name for name in libraries if not (target / name).is_file()]
    listed = [name for names in _listed_files(target) for name in names]
    return CheckResult(
        robot=robot.name,
        folder=target,
        stale=tuple(sorted(name for name, data in found.items() if data not in (None, wanted[name]))),
        missing=tuple(sorted([*(name for name, data in found.items() if data is None), *absent])),
        extra=tuple(sorted(name for name in listed if name not in (*wanted, *libraries) and (target / name).is_file())),
    )


def _listed_files(folder: Path) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Texts and libraries of a folder by its manifest."""
    manifest = read_manifest(folder) or {"files": {}}
    return tuple(manifest["files"]), compiled_files(manifest)
