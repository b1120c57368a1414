"""From robots to verified folders: render in memory, write beside the target, verify there, take its place."""

import gc
import multiprocessing
import os
import shutil
import signal
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing import resource_tracker
from pathlib import Path
from queue import SimpleQueue
from typing import Any, TypeVar

from derive.errors import DeriveError, OutputError, TargetError
from derive.interrupts import TemporaryFolder, interruptible, uninterrupted
from derive.programs.optimise.search_policy import Effort
from derive.publish.atomic_folder import OvertakenError, heal, publish, require_replaceable, rewrite, system_errors
from derive.publish.manifest import MANIFEST, compiled_files, contents, is_current, read_manifest, written_targets
from derive.publish.render import Rendered, compile_libraries, library_names, render_robot, rendering
from derive.publish.targets import targets_named
from derive.robot.robot import Robot
from derive.targets.compiler import Command, compiling_meanwhile, require_compiler
from derive.targets.target import Target, package_name
from derive.verification.verify import Report, verify
from derive.version import __version__

Progress = Callable[[str, str], None]  # of a robot's name and a stage: derive, compile, verify, done or failed


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
            **{name: list(getattr(self, name)) for name in ("stale", "missing", "extra")},
        }


def folder_of(robot: Robot, out: Path) -> Path:
    """The folder of a robot."""
    return out / package_name(robot)


def build_robot(
    robot: Robot,
    out: Path,
    targets: Iterable[str] | None = None,  # beside those of a usual build
    *,
    only: bool = False,
    verified: bool = True,
    force: bool = False,
    effort: Effort = Effort.FULL,
    progress: Progress | None = None,
) -> BuildResult:
    """Builds one robot into ``out/<robot_name>``: usual targets, those asked for, and those that the folder holds."""
    started = time.perf_counter()
    tell = progress or (lambda robot, stage: None)
    target = folder_of(robot, out)
    heal(out)

    choose = partial(targets_named, targets, only=only)  # beside those that the folder holds by then
    while True:
        chosen = choose(written_targets(target))
        if not force and is_current(target, robot.digest, __version__, chosen, effort):
            tell(robot.name, "unchanged")
            texts, compiled = _listed_files(target)
            files = (*texts, MANIFEST, *compiled)
            return BuildResult(robot.name, target, files, True, {}, None, time.perf_counter() - started)
        require_replaceable(target, robot.name, ())  # before the work is done
        libraries = library_names(chosen)
        compiler = _compiler_for(targets_named(targets), target) if libraries else None
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
                further, still = [*libraries, *late], lambda written=chosen: written == choose(written_targets(target))
                report, rendered = publish(first.files, target, robot.name, finish, further, still)
        except OvertakenError:  # a build of other targets was faster, and what it has written stays
            continue
        tell(robot.name, "built")
        files = (*rendered.files, *libraries)
        return BuildResult(robot.name, target, files, False, rendered.operations, report, time.perf_counter() - started)


def _compiler_for(asked: Sequence[Target], folder: Path) -> Command:
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
    robot: Robot, take: Callable[[Path], None], whole: Callable[[], Rendered], checks: bool, target: Path, folder: Path
) -> tuple[Report | None, Rendered]:
    """Checks what is made of the program, and then adds the rest to it, which takes as long to render."""
    report = verify(robot, folder, libraries=partial(take, folder)) if checks else None
    if not checks:
        take(folder)
    rendered = whole()
    rewrite(rendered.files, folder, target)
    return report, rendered


@contextmanager
def _uncollected() -> Iterator[None]:
    """Collect no cycles of references while a robot is rendered and verified."""
    # The search makes millions of small objects and hardly a cycle, as do generated modules that are called: collecting
    # them takes a sixth of the time. What is in no cycle is freed as ever.
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
    targets: Iterable[str] | None = None,  # beside those of a usual build
    effort: Effort = Effort.FULL,
    *,
    only: bool = False,
) -> CheckResult:
    """Compares the folder of a robot with what a build would write, byte by byte; writes nothing."""
    # Of compiled libraries only the presence is checked: what a compiler makes of the same text is its own affair.
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


# -- several robots

R = TypeVar("R", BuildResult, CheckResult)

GRACE = 10.0  # seconds that processes have to clean up after an interrupt
FAILED = 1  # exit status of a process that was asked to end


def require_distinct(robots: Iterable[Robot]) -> None:
    """Refuse two robots with one name: they would overwrite each other's folder."""
    seen: dict[str, Robot] = {}
    for robot in robots:
        if (other := seen.setdefault(package_name(robot), robot)).digest != robot.digest:
            both = f"{other.source or other.name} and {robot.source or robot.name}"
            allowed = "robots that are built into one folder have different names"
            remedy = "change `name:` in one of the files, or build them with different --out"
            raise OutputError(f"{both} have the same name {robot.name!r}", allowed=allowed, remedy=remedy)


def for_each(
    work: Callable[[Robot], R], robots: Sequence[Robot], jobs: int = 1, progress: Progress | None = None
) -> list[R | BuildFailure]:
    """The work on every robot, here or in processes of their own."""
    if min(jobs, len(robots)) <= 1:
        done: list[R | BuildFailure] = []
        for robot in robots:
            with interruptible():
                done.append(_attempt(work, robot))
            _tell(done[-1], progress)
        return done
    results = _in_processes(work, robots, jobs, progress)
    killed = DeriveError("the process that built it was killed")
    for index in [index for index in range(len(robots)) if index not in results]:
        # A process died: each robot that it may have been gets one of its own.
        alone = _in_processes(work, [robots[index]], 1, progress)
        results[index] = alone.get(0) or BuildFailure(robots[index].name, killed)
    return [results[index] for index in range(len(robots))]


def _attempt(work: Callable[[Robot], R], robot: Robot) -> R | BuildFailure:
    """One robot: a fault of it, or of derive, must not take the others along."""
    try:
        return work(robot)
    except Exception as error:
        return BuildFailure(robot.name, error)


def _tell(result: BuildResult | CheckResult | BuildFailure, progress: Progress | None) -> None:
    if progress is not None:
        progress(result.robot, "failed" if isinstance(result, BuildFailure) else "done")


def _in_processes(
    work: Callable[[Robot], R], robots: Sequence[Robot], jobs: int, progress: Progress | None
) -> dict[int, R | BuildFailure]:
    """Results by index; robots whose process died are missing."""
    results: dict[int, R | BuildFailure] = {}
    with interruptible(), _pool(min(jobs, len(robots))) as pool:
        futures: dict[Future[R | BuildFailure], int] = {}
        done: SimpleQueue[Future[R | BuildFailure]] = SimpleQueue()  # an interrupt may leave the lock of a future held
        with uninterrupted():  # a terminal interrupts every process: those started here leave it to us
            for index, robot in enumerate(robots):
                future = pool.submit(_attempt_unless_ended, work, robot)
                futures[future] = index
                future.add_done_callback(done.put)
        for _ in robots:
            future = done.get()
            try:
                results[futures[future]] = future.result()
            except BrokenProcessPool:
                continue
            _tell(results[futures[future]], progress)
    return results


def _attempt_unless_ended(work: Callable[[Robot], R], robot: Robot) -> R | BuildFailure:
    """One robot in a process of its own, which cleans up and ends when it is asked to."""
    with suppress(KeyboardInterrupt), interruptible(signal.SIGTERM):
        return _attempt(work, robot)
    os._exit(FAILED)  # what the work held is freed by now; the pool would give this process the next robot


@contextmanager
def _pool(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that end with us: after an interrupt they are asked to clean up, and killed where they do not."""
    others = multiprocessing.active_children()
    resource_tracker.ensure_running()  # it lets interrupts through when it starts
    with TemporaryFolder() as temporary:
        with uninterrupted():
            context = multiprocessing.get_context("spawn")
            pool = ProcessPoolExecutor(jobs, context, _have_temporary_files_in, (temporary.path,))
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            ours = [process for process in multiprocessing.active_children() if process not in others]
            for process in ours:
                process.terminate()
            deadline = time.monotonic() + GRACE
            for process in ours:
                process.join(max(0.0, deadline - time.monotonic()))
                process.kill()
                process.join()
            raise
        pool.shutdown()


def _have_temporary_files_in(folder: Path) -> None:
    """What a process that is killed leaves behind goes with this folder."""
    tempfile.tempdir = str(folder)
