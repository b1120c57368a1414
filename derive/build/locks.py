"""Locks on folders, released by the system when their holder dies, however it dies."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

try:
    import fcntl
except ImportError:  # not a POSIX system
    fcntl = None  # type: ignore[assignment]

_UNSUPPORTED = (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL)


def hold(folder: Path) -> int | None:
    """Locks a folder of our own until the descriptor is closed.

    Returns:
        The descriptor; None where folders cannot be locked.

    Raises:
        BlockingIOError: Somebody else holds it.
    """
    return _locked(folder, wait=False)


@contextmanager
def exclusively(folder: Path) -> Iterator[bool]:
    """Waits for the lock on a folder; yields whether there are locks here at all."""
    descriptor = _locked(folder, wait=True)
    try:
        yield descriptor is not None
    finally:
        release(descriptor)


def release(descriptor: int | None) -> None:
    """Gives a lock back."""
    if descriptor is not None:
        os.close(descriptor)


def _locked(folder: Path, *, wait: bool) -> int | None:
    if fcntl is None:
        return None
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW if not wait else os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(descriptor)
        if error.errno in _UNSUPPORTED:
            return None
        raise
    return descriptor
