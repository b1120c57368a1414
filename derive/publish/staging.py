"""The temporary folders of builds, beside their target: made, found again after a crash, and cleared away.

``.derive-NAME-XXXXXXXX`` is a folder being written, or the old one after an exchange; its maker holds a lock on it,
so that one without a lock belongs to nobody. ``.derive-NAME.old`` is the old folder in the instant between two
renames, on systems that cannot exchange folders.

Two calls of the system make this safe: folders are exchanged in one step where the file system can, and locks on
folders are released when their holder dies, however it dies.
"""

from __future__ import annotations

import ctypes
import errno
import os
import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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


def exchange(one: Path, other: Path) -> bool:
    """Swaps two folders atomically (``renameat2`` with ``RENAME_EXCHANGE``, Linux)."""
    try:
        call = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError, TypeError):
        return False
    if call(_AT_FDCWD, os.fsencode(one), _AT_FDCWD, os.fsencode(other), ctypes.c_uint(_RENAME_EXCHANGE)) == 0:
        return True
    number = ctypes.get_errno()
    if number in _NO_EXCHANGE:
        return False
    raise OSError(number, os.strerror(number), str(one), None, str(other))


def flush_folder(folder: Path) -> None:
    """Makes the names in a folder durable."""
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:  # folders cannot be opened on every system
        return
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)


def hold(folder: Path, *, wait: bool = False) -> int | None:
    """Locks a folder until the descriptor is closed.

    Returns:
        The descriptor; None where folders cannot be locked.
    """
    if fcntl is None:
        return None
    descriptor = os.open(folder, os.O_RDONLY if wait else os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(descriptor)
        if error.errno in _NO_LOCKS:
            return None
        raise
    return descriptor


@contextmanager
def exclusively(folder: Path) -> Iterator[bool]:
    """Waits for the lock on a folder."""
    descriptor = hold(folder, wait=True)
    try:
        yield descriptor is not None
    finally:
        release(descriptor)


def release(descriptor: int | None) -> None:
    """Gives a lock back.

    Args:
        descriptor: From `hold`; None is fine.
    """
    if descriptor is not None:
        os.close(descriptor)


def staging_of(target: Path) -> Path:
    """Where a new folder may be written, beside the target and under a name that nobody else has."""
    return target.with_name(f".derive-{target.name}-{secrets.token_hex(4)}")


def backup_of(target: Path) -> Path:
    """Where the old folder waits between two renames."""
    return target.with_name(f".derive-{target.name}.old")


def recover(parent: Path, locks_work: bool) -> None:
    """Puts back what a killed build left half-way, and removes the temporary folders of the dead.

    Without working locks nobody can tell the dead from the living, and temporary folders stay.
    """
    for path in sorted(parent.iterdir()):
        if path.is_symlink() or not path.is_dir():
            continue
        backup = _BACKUP.fullmatch(path.name)
        if backup:
            target = parent / backup.group(1)
            if target.is_symlink() or target.exists():
                remove(path)
            else:
                path.rename(target)
                flush_folder(parent)
        elif locks_work and _STAGING.fullmatch(path.name):
            try:
                descriptor = hold(path)
            except OSError:  # its maker is alive, or it is not ours to open
                continue
            try:
                if descriptor is not None:
                    remove(path)
            finally:
                release(descriptor)


def remove(folder: Path) -> None:
    """Removes a folder of ours as far as possible; what is left is found again by the next build."""
    shutil.rmtree(folder, ignore_errors=True)
