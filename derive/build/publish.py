"""Writes a folder as a whole or not at all.

The new folder is written and checked beside the target and then takes its name in one step, so that a kill at any
moment, a full disk or two builds at once leave the complete old folder or the complete new one. Files of the user's
in it are kept.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

from derive.build.exchange import exchange, flush_folder
from derive.build.locks import exclusively, hold, release
from derive.build.ownership import carry_over, require_replaceable
from derive.build.staging import backup_of, make_staging, recover, remove
from derive.errors import OutputError

R = TypeVar("R")


def publish(
    files: Mapping[str, bytes],
    target: Path,
    robot_name: str,
    check: Callable[[Path], R],
    further: Iterable[str] = (),
) -> R:
    """Writes files into a folder that replaces ``target``.

    Args:
        files: Contents by file name.
        target: The folder; its parent is made if there is none.
        robot_name: The robot that the folder is for.
        check: Called with the finished temporary folder; what it raises stops the build, and the old folder stays.
        further: Names of the files that ``check`` adds.

    Returns:
        What ``check`` returned.

    Raises:
        OutputError: The target is not ours to replace, or the system refused to write.
    """
    with _system_errors(target):
        target.parent.mkdir(parents=True, exist_ok=True)
        names = (*files, *further)
        staging, lock = _begin(target, robot_name, names)
    try:
        with _system_errors(target):
            _write(files, staging)
        result = check(staging)
        with _system_errors(target):
            _finish(staging, target, robot_name, names)
        return result
    finally:
        remove(staging)
        release(lock)


def heal(parent: Path) -> None:
    """Puts in order what a killed build left in a folder of robots."""
    if parent.is_dir():
        with _system_errors(parent), exclusively(parent) as locks_work:
            recover(parent, locks_work)


@contextmanager
def _system_errors(target: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(
            f"cannot write {target}: {reason}",
            remedy="what was there before is unchanged; make room, or choose another --out",
        ) from error


def _begin(target: Path, robot_name: str, files: Iterable[str]) -> tuple[Path, int | None]:
    """A locked, empty folder beside the target."""
    with exclusively(target.parent) as locks_work:
        recover(target.parent, locks_work)
        require_replaceable(target, robot_name, files)
        staging = make_staging(target)
        return staging, hold(staging)


def _write(files: Mapping[str, bytes], staging: Path) -> None:
    for name, data in files.items():
        with open(staging / name, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
    flush_folder(staging)


def _finish(staging: Path, target: Path, robot_name: str, files: Iterable[str]) -> None:
    """Gives the new folder the target's name; afterwards ``staging`` is the old one, or nothing."""
    with exclusively(target.parent):
        require_replaceable(target, robot_name, files)
        carry_over(target, staging)
        if not os.path.lexists(target):
            staging.rename(target)
        elif not exchange(staging, target):
            _replace_in_two_steps(staging, target)
        with suppress(OSError):  # the new folder is in place; what fails now is how long it outlives a power cut
            flush_folder(target.parent)


def _replace_in_two_steps(staging: Path, target: Path) -> None:
    """Where folders cannot be exchanged: a kill between the renames is healed by the next build."""
    backup = backup_of(target)
    target.rename(backup)
    try:
        staging.rename(target)
    except OSError:
        backup.rename(target)
        raise
    try:
        flush_folder(target.parent)
    except OSError:  # keep both until a build finds the disk in order
        return
    remove(backup)
