"""Generated models from Python: building, comparing with what is there, verifying."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from derive.api.robots import RobotLike, load, load_all
from derive.errors import OutputError, VerificationError
from derive.programs.optimise.search_policy import Effort, effort_named

if TYPE_CHECKING:  # what builds and verifies takes longer to import than a refusal of its input to be told
    from derive.publish.build import BuildFailure, BuildResult, CheckResult, Progress
    from derive.verification.verify import Report

FOLDER = Path("generated")  #: the parent folder of all robots unless another one is named


def build(
    robot: RobotLike,
    out: str | Path = FOLDER,
    *,
    targets: Iterable[str] | None = None,
    only: bool = False,
    force: bool = False,
    effort: str = Effort.FULL,
) -> BuildResult:
    """Derive, generate and verify the models of a robot, as ``derive build`` does.

    The folder is replaced as a whole or not at all; what has not changed is not built again.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        out: Parent folder; the files go to ``out/<robot>``.
        targets: Such as ``native``, ``javascript``, or ``all``, beside those of a usual build. Those that the folder
            holds already are renewed with them.
        only: Whether the folder shall hold the named targets alone.
        force: Whether to build again even if nothing has changed.
        effort: ``full``, or ``quick`` for programs with up to a third more operations.

    Returns:
        Folder, files, operation counts, seconds, and in ``report`` the worst error of each function.

    Raises:
        RobotFileError: The file does not describe a robot.
        TargetError: An unknown target, or no C compiler for one that needs it.
        OutputError: The folder cannot or may not be written.
        VerificationError: A generated function is wrong; the old folder stays.
    """
    from derive.publish.build import build_robot

    return build_robot(load(robot), Path(out), targets, only=only, force=force, effort=effort_named(effort))


def build_all(
    robots: Iterable[RobotLike] | None = None,
    out: str | Path = FOLDER,
    *,
    targets: Iterable[str] | None = None,
    only: bool = False,
    force: bool = False,
    effort: str = Effort.FULL,
    jobs: int = 1,
    progress: Progress | None = None,
) -> list[BuildResult | BuildFailure]:
    """Build several robots; one failure does not stop the others.

    Args:
        robots: Robots, paths or names; None for the whole catalogue.
        out: Parent folder.
        targets: See `build`.
        only: See `build`.
        force: See `build`.
        effort: See `build`.
        jobs: Robots built at once, each in a process of its own.
        progress: Called with a robot's name and the stage it has reached.

    Returns:
        A result, or a failure with its error, for each robot, in the order given.

    Raises:
        RobotFileError: A file does not describe a robot.
        OutputError: Two different robots would share a folder.
    """
    from derive.publish.build import build_robot, for_each, require_distinct

    chosen, names = load_all(robots), None if targets is None else tuple(targets)
    require_distinct(chosen)
    work = partial(build_robot, out=Path(out), targets=names, only=only, force=force, effort=effort_named(effort))
    alone = min(jobs, len(chosen)) <= 1  # stages are told where no other process works
    return for_each(partial(work, progress=progress) if alone else work, chosen, jobs, progress)


def stale(
    robots: Iterable[RobotLike] | None = None,
    out: str | Path = FOLDER,
    *,
    targets: Iterable[str] | None = None,
    only: bool = False,
    effort: str = Effort.FULL,
    jobs: int = 1,
    progress: Progress | None = None,
) -> list[CheckResult | BuildFailure]:
    """How folders differ from what a build would write, as ``derive build --check`` says; writes nothing.

    Args:
        robots: Robots, paths or names; None for the whole catalogue.
        out: Parent folder.
        targets: See `build`.
        only: See `build`.
        effort: See `build`.
        jobs: Robots compared at once, each in a process of its own.
        progress: Called with a robot's name when it is done.

    Returns:
        Stale, missing and extra files of each robot, in the order given; ``is_current`` where there are none.

    Raises:
        RobotFileError: A file does not describe a robot.
    """
    from derive.publish.build import check_robot, for_each

    names = None if targets is None else tuple(targets)
    work = partial(check_robot, out=Path(out), targets=names, effort=effort_named(effort), only=only)
    return for_each(work, load_all(robots), jobs, progress)


def verify(robot: RobotLike, out: str | Path = FOLDER, *, samples: int = 24, seed: int = 0) -> Report:
    """Compare the generated functions of a robot with an independent recursion, as ``derive verify`` does.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        out: Parent folder; the models are in ``out/<robot>``.
        samples: Number of random configurations.
        seed: Seed of their choice.

    Returns:
        The worst relative error of each function of each target.

    Raises:
        OutputError: There is no such folder.
        VerificationError: A function is off by more than 1e-9, raises, returns another shape, or is missing.
    """
    from derive.publish.build import folder_of
    from derive.publish.manifest import read_manifest
    from derive.verification.verify import verify as verify_folder

    chosen = load(robot)
    folder = folder_of(chosen, Path(out))
    command = f"run: {shlex.join(['derive', 'build', chosen.source or chosen.name, '--out', str(out)])}"
    if not folder.is_dir():
        raise OutputError(f"no folder {folder}", remedy=command)
    try:
        return verify_folder(chosen, folder, samples=samples, seed=seed)
    except VerificationError as error:
        if (read_manifest(folder) or {}).get("robot_file_sha256") == chosen.digest:
            raise
        reason = f"{folder} was built from another robot file than {chosen.source or chosen.name}"
        raise VerificationError(error.found, allowed=error.allowed, remedy=f"{reason}; {command}") from error
