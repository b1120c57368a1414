"""Several robots, one after the other or at once; one failure does not stop the rest."""

import multiprocessing
import os
import signal
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing import resource_tracker
from pathlib import Path
from queue import SimpleQueue
from typing import TypeVar

from derive.errors import DeriveError, OutputError
from derive.interrupts import TemporaryFolder, interruptible, uninterrupted
from derive.programs.optimise.search_policy import Effort
from derive.publish.build import BuildFailure, BuildResult, CheckResult, Progress, build_robot, check_robot
from derive.robot.robot import Robot
from derive.targets.target import package_name

R = TypeVar("R", BuildResult, CheckResult)

GRACE = 10.0  # seconds that processes have to clean up after an interrupt
FAILED = 1  # exit status of a process that was asked to end


def build_many(
    robots: Sequence[Robot],
    out: Path,
    targets: Iterable[str] | None = None,
    *,
    only: bool = False,
    jobs: int = 1,
    verified: bool = True,
    force: bool = False,
    effort: Effort = Effort.FULL,
    progress: Progress | None = None,
) -> list[BuildResult | BuildFailure]:
    """Builds robots as `build_robot` does."""
    seen: dict[str, Robot] = {}
    for robot in robots:  # two files with one name would overwrite each other's folder
        other = seen.setdefault(package_name(robot), robot)
        if other.digest != robot.digest:
            raise OutputError(
                f"{other.source or other.name} and {robot.source or robot.name} have the same name {robot.name!r}",
                allowed="robots that are built into one folder have different names",
                remedy="change `name:` in one of the files, or build them with different --out",
            )
    work = partial(
        build_robot,
        out=out,
        targets=None if targets is None else tuple(targets),
        only=only,
        verified=verified,
        force=force,
        effort=effort,
        progress=None if min(jobs, len(robots)) > 1 else progress,
    )
    return _run(work, robots, jobs, progress)


def check_many(
    robots: Sequence[Robot],
    out: Path,
    targets: Iterable[str] | None = None,
    *,
    only: bool = False,
    jobs: int = 1,
    effort: Effort = Effort.FULL,
    progress: Progress | None = None,
) -> list[CheckResult | BuildFailure]:
    """Checks robots as `check_robot` does."""
    names = None if targets is None else tuple(targets)
    work = partial(check_robot, out=out, targets=names, effort=effort, only=only)
    return _run(work, robots, jobs, progress)


def _run(
    work: Callable[[Robot], R], robots: Sequence[Robot], jobs: int, progress: Progress | None
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
    lost = [index for index in range(len(robots)) if index not in results]
    for index in lost:  # a process died: each robot that it may have been gets one of its own
        alone = _in_processes(work, [robots[index]], 1, progress)
        results[index] = alone.get(0) or BuildFailure(
            robots[index].name, DeriveError("the process that built it was killed")
        )
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
    try:
        with interruptible(signal.SIGTERM):
            return _attempt(work, robot)
    except KeyboardInterrupt:
        pass
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
