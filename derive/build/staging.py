"""The temporary folders of builds, beside their target: made, found again after a crash, and cleared away.

``.derive-NAME-XXXXXXXX`` is a folder being written, or the old one after an exchange; its maker holds a lock on it,
so that one without a lock belongs to nobody. ``.derive-NAME.old`` is the old folder in the instant between two
renames, on systems that cannot exchange folders.
"""

from __future__ import annotations

import re
import secrets
import shutil
from pathlib import Path

from derive.build.exchange import flush_folder
from derive.build.locks import hold, release

_STAGING = re.compile(r"\.derive-([a-z0-9_]+)-[0-9a-f]{8}")
_BACKUP = re.compile(r"\.derive-([a-z0-9_]+)\.old")


def make_staging(target: Path) -> Path:
    """A new, empty folder beside the target."""
    path = target.with_name(f".derive-{target.name}-{secrets.token_hex(4)}")
    path.mkdir()
    return path


def backup_of(target: Path) -> Path:
    """Where the old folder waits between two renames."""
    return target.with_name(f".derive-{target.name}.old")


def recover(parent: Path, locks_work: bool) -> None:
    """Puts back what a killed build left half-way, and removes the temporary folders of the dead.

    The caller holds the lock on ``parent``. Without working locks nobody can tell the dead from the living, and
    temporary folders stay.
    """
    for path in sorted(parent.iterdir()):
        if path.is_symlink() or not path.is_dir():
            continue
        backup = _BACKUP.fullmatch(path.name)
        if backup:
            _put_back(path, parent / backup.group(1))
        elif locks_work and _STAGING.fullmatch(path.name):
            _remove_if_dead(path)


def _put_back(backup: Path, target: Path) -> None:
    if target.is_symlink() or target.exists():
        remove(backup)
    else:
        backup.rename(target)
        flush_folder(target.parent)


def _remove_if_dead(path: Path) -> None:
    try:
        descriptor = hold(path)
    except OSError:  # its maker is alive, or it is not ours to open
        return
    try:
        if descriptor is not None:
            remove(path)
    finally:
        release(descriptor)


def remove(folder: Path) -> None:
    """Removes a folder of ours as far as possible; what is left is found again by the next build."""
    shutil.rmtree(folder, ignore_errors=True)
