"""Puts folders and files in place, each as a whole or not at all, and overwrites nobody's file unasked.

A new folder is written and checked beside the target and then takes its name in one step, so that a kill at any moment,
a full disk or two builds at once leave the complete old folder or the complete new one. Files of the user's in it are
kept. Two calls of the system make this safe: folders are exchanged in one step where the file system can, and locks on
folders end with their holder, however that ends. ``.derive-NAME-XXXXXXXX`` is a folder being written, or the old one
after an exchange; its maker holds a lock on it, so that one without a lock belongs to nobody. ``.derive-NAME.old`` is
the old folder in the instant between two renames, on systems that cannot exchange folders.

Single files are all written beside their targets before the first takes its name, which must be free: only with
``force`` they replace files, whoever wrote those.
"""

import ctypes
import errno
import os
import re
import secrets
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import TypeVar

from derive.errors import DeriveError, OutputError
from derive.interrupts import uninterrupted
from derive.publish.manifest import MANIFEST, compiled_files, contents, read_manifest

try:
    import fcntl
except ImportError:  # not a POSIX system
    fcntl = None  # type: ignore[assignment]

_STAGING = re.compile(r"\.derive-([a-z0-9_]+)-[0-9a-f]{8}")
_BACKUP = re.compile(r"\.derive-([a-z0-9_]+)\.old")

_AT_FDCWD = -100
_RENAME_EXCHANGE = 2
_NO_EXCHANGE = (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP, errno.EPERM)
_NO_LOCKS = (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL)
_CACHE = "__pycache__"

R = TypeVar("R")


class OvertakenError(DeriveError):
    """Another build has replaced the folder since this one began."""


def publish(
    files: Mapping[str, bytes],
    target: Path,
    robot_name: str,
    check: Callable[[Path], R],
    further: Iterable[str] = (),
    still: Callable[[], bool] = lambda: True,
) -> R:
    """Writes files into a folder that replaces ``target``."""
    names = (*files, *further)
    staging = target.with_name(f".derive-{target.name}-{secrets.token_hex(4)}")
    try:
        with ExitStack() as lock:
            with system_errors(target):
                target.parent.mkdir(parents=True, exist_ok=True)
                with locked(target.parent):
                    _recover(target.parent)
                    require_replaceable(target, robot_name, names)
                    staging.mkdir()
                    lock.enter_context(locked(staging, wait=False))
                for name, data in files.items():
                    (staging / name).parent.mkdir(exist_ok=True)
                    _write_new(staging / name, data)
            result = check(staging)
            with system_errors(target), locked(target.parent):
                require_replaceable(target, robot_name, names)
                if not still():
                    raise OvertakenError(f"{target} was replaced meanwhile")
                _carry_over(target, staging)
                _take_place(staging, target)
            return result
    finally:
        with uninterrupted():
            shutil.rmtree(staging, ignore_errors=True)


def rewrite(files: Mapping[str, bytes], folder: Path, target: Path) -> None:
    """Writes those files into the temporary folder of a target that are not in it, or are others."""
    with system_errors(target):
        for name, data in files.items():
            if contents(folder / name) != data:
                (folder / name).unlink(missing_ok=True)
                _write_new(folder / name, data)


def heal(parent: Path) -> None:
    """Puts in order what a killed build left in a folder of robots."""
    if os.path.lexists(parent) and not parent.is_dir():
        raise OutputError(f"{parent} is not a folder", remedy="choose another --out")
    if parent.is_dir():
        with system_errors(parent), locked(parent):
            _recover(parent)


def _recover(parent: Path) -> None:
    """Puts back what a killed build left half-way, and removes the temporary folders of the dead."""
    # Without working locks nobody can tell the dead from the living, and temporary folders stay.
    for path in sorted(parent.iterdir()):
        if path.is_symlink() or not path.is_dir():
            continue
        if (backup := _BACKUP.fullmatch(path.name)) and not os.path.lexists(parent / backup[1]):
            path.rename(parent / backup[1])
        elif backup:
            shutil.rmtree(path, ignore_errors=True)
        elif _STAGING.fullmatch(path.name):
            with suppress(OSError), locked(path, wait=False) as is_dead:  # else its maker lives, or it is not ours
                if is_dead:
                    shutil.rmtree(path, ignore_errors=True)


@contextmanager
def locked(folder: Path, *, wait: bool = True) -> Iterator[bool]:
    """Holds the lock on a folder; False where folders have no locks, `OSError` where another one is not waited for."""
    if fcntl is None:
        yield False
        return
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        works = True
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if works := error.errno not in _NO_LOCKS:
                raise
        yield works
    finally:
        os.close(descriptor)


def exchange(one: Path, other: Path) -> bool:
    """Swaps two folders atomically (``renameat2`` with ``RENAME_EXCHANGE``, Linux)."""
    try:
        call = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError, TypeError):
        return False
    if call(_AT_FDCWD, os.fsencode(one), _AT_FDCWD, os.fsencode(other), ctypes.c_uint(_RENAME_EXCHANGE)) == 0:
        return True
    if (number := ctypes.get_errno()) in _NO_EXCHANGE:
        return False
    raise OSError(number, os.strerror(number), str(one), None, str(other))


@contextmanager
def system_errors(
    target: Path, remedy: str = "what was there before is unchanged; make room, or choose another --out"
) -> Iterator[None]:
    """Errors of the operating system become `OutputError`."""
    try:
        yield
    except OSError as error:
        raise OutputError(f"cannot write {target}: {error.strerror or error}", remedy=remedy) from error


def _write_new(path: Path, data: bytes) -> None:
    with open(path, "xb") as file:
        file.write(data)


def _take_place(staging: Path, target: Path) -> None:
    """Gives the new folder the target's name; afterwards ``staging`` is the old one, or nothing."""
    # Where folders cannot be exchanged, two renames do it, and a kill between them is healed by the next build.
    if not os.path.lexists(target):
        staging.rename(target)
    elif not exchange(staging, target):
        backup = target.with_name(f".derive-{target.name}.old")
        target.rename(backup)
        try:
            staging.rename(target)
        except OSError:
            backup.rename(target)
            raise
        shutil.rmtree(backup, ignore_errors=True)


def require_replaceable(target: Path, robot_name: str, files: Iterable[str]) -> None:
    """Refuses to replace what derive did not write."""
    if target.is_symlink():
        raise _refusal(target, "is a symbolic link", "remove the link, or choose another --out")
    if not os.path.lexists(target):
        return
    if not target.is_dir():
        raise _refusal(target, "is not a folder", "move it away, or choose another --out")
    if not any(target.iterdir()):
        return
    if (manifest := read_manifest(target)) is None:
        raise _refusal(target, f"holds files, but no {MANIFEST} of derive", "move it away, or choose another --out")
    if manifest.get("robot") != robot_name:
        raise _refusal(target, f"belongs to the robot {manifest.get('robot')!r}", "choose another --out")
    wanted = {place.as_posix() for name in files for place in (PurePosixPath(name), *PurePosixPath(name).parents)}
    if taken := sorted(wanted & set(_users_files(target))):
        raise _refusal(target / taken[0], f"is not listed in {MANIFEST}, but a build would write it", "move it away")


def _users_files(target: Path) -> list[str]:
    """Names in a generated folder that no build has written: they are kept."""
    if target.is_symlink() or not target.is_dir():
        return []
    manifest = read_manifest(target) or {"files": {}}
    ours = {MANIFEST, _CACHE, *manifest["files"], *compiled_files(manifest)}
    folders = {name.partition("/")[0] for name in ours if "/" in name} - {"", ".", ".."}
    shared = {name for name in folders if (target / name).is_dir() and not (target / name).is_symlink()}
    found = [path for path in target.iterdir() if path.name not in shared]
    found += [path for folder in shared for path in (target / folder).iterdir()]
    return sorted(name for name in (path.relative_to(target).as_posix() for path in found) if name not in ours)


def _carry_over(target: Path, staging: Path) -> None:
    """Takes the user's files from the old folder into the new one; the old one keeps them until it is removed."""
    for name in _users_files(target):
        source, copy = target / name, staging / name
        copy.parent.mkdir(exist_ok=True)
        if source.is_symlink():
            copy.symlink_to(source.readlink())
        elif source.is_dir():
            shutil.copytree(source, copy, symlinks=True, copy_function=_link_or_copy)
        else:
            _link_or_copy(str(source), str(copy))


def _link_or_copy(source: str, copy: str) -> str:
    try:
        os.link(source, copy, follow_symlinks=False)
    except OSError:
        shutil.copy2(source, copy, follow_symlinks=False)
    return copy


def _refusal(path: Path, found: str, remedy: str) -> OutputError:
    return OutputError(f"{path} {found}", allowed="derive replaces only folders that it wrote itself", remedy=remedy)


def refuse_taken(paths: Iterable[Path], *, force: bool) -> None:
    """Refuse names of files that are taken, or have no folder, before work is done for them."""
    for path in paths:
        if _is_stream(path):
            continue
        if path.is_dir():
            raise OutputError(f"{str(path)!r} is a folder", remedy="write the name of a file in it")
        if path.is_symlink():
            raise OutputError(f"{path} is a symbolic link", remedy="remove the link, or choose another name")
        if path.exists() and not force:
            raise _taken(path)
        if not (above := next((folder for folder in path.parents if os.path.lexists(folder)), path)).is_dir():
            raise OutputError(f"{above} is not a folder", remedy="choose another place")


def write_files(files: Mapping[Path, bytes], *, force: bool = False) -> list[Path]:
    """Writes files, all or none; folders are made if there are none."""
    refuse_taken(files, force=force)
    written: dict[Path, Path] = {}
    placed: list[Path] = []
    target = Path()
    try:
        for target, data in files.items():
            if _is_stream(target):
                target.write_bytes(data)
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            written[target] = target.with_name(f".derive-{secrets.token_hex(4)}-{target.name}")
            _write_new(written[target], data)
        with uninterrupted():
            for target, temporary in written.items():
                (os.replace if force else _claim)(temporary, target)
                placed.append(target)
    except OSError as error:
        for path in () if force else placed:
            path.unlink(missing_ok=True)
        if isinstance(error, FileExistsError):
            raise _taken(target) from None
        reason = error.strerror or str(error)
        raise OutputError(f"cannot write {target}: {reason}", remedy="make room, or choose another place") from error
    finally:
        for temporary in written.values():
            with suppress(OSError):
                temporary.unlink(missing_ok=True)
    return list(files)


def _claim(temporary: Path, target: Path) -> None:
    """Give a file a name that nobody else has, in one step; `FileExistsError` where somebody has taken it meanwhile."""
    try:
        os.link(temporary, target)
    except FileExistsError:
        raise
    except OSError:  # a file system where files have one name
        open(target, "xb").close()
        os.replace(temporary, target)


def _taken(path: Path) -> OutputError:
    remedy = "choose another name, or overwrite it with --force (force=True in Python)"
    return OutputError(f"{path} exists already", remedy=remedy)


def ending_of(path: Path, allowed: Sequence[str]) -> str:
    """The ending of a file's name, which says its form; a device or a pipe takes the first one."""
    ending = (*allowed, "")[0] if _is_stream(path) else path.suffix.lower()
    if allowed and ending not in allowed:
        found = f"{path.name!r} has the ending of another kind of file"
        raise DeriveError(found, allowed=f"allowed: {', '.join(allowed)}")
    return ending


def _is_stream(path: Path) -> bool:
    """Whether a path is a device or a pipe, which is written to and never replaced."""
    with suppress(OSError):
        return path.is_char_device() or path.is_fifo()
    return False
