"""Writes single files as a whole or not at all, and overwrites none that derive did not write.

Each file is written beside its target and takes its name in one step; all are written before the first does, so that
a full disk leaves everything as it was.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from derive.errors import OutputError

MARKS = (b"written by derive", b"/Creator (derive")
"""One of these stands in everything that derive writes to be handed out."""


def write_files(files: Mapping[str, bytes], folder: Path, *, force: bool = False) -> list[Path]:
    """Writes files into a folder, which is made if there is none.

    Args:
        files: Contents by file name.
        folder: Where to.
        force: Whether to overwrite files that derive did not write.

    Returns:
        Their paths, in the order of ``files``.

    Raises:
        OutputError: A file is there that derive did not write, or the system refused to write.
    """
    targets = {folder / name: data for name, data in files.items()}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not force:
            _require_ours(list(targets))
        _write(targets)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(
            f"cannot write {error.filename or folder}: {reason}", remedy="make room, or choose another --out"
        ) from error
    return list(targets)


def _require_ours(paths: list[Path]) -> None:
    foreign = [path for path in paths if os.path.lexists(path) and not _is_ours(path)]
    if foreign:
        raise OutputError(
            f"{foreign[0]} was not written by derive",
            remedy="move it away, choose another --out, or overwrite it with --force",
        )


def _is_ours(path: Path) -> bool:
    if path.is_symlink() or not path.is_file():
        return False
    data = path.read_bytes()
    return not data or any(mark in data for mark in MARKS)


def _write(targets: Mapping[Path, bytes]) -> None:
    written: dict[Path, Path] = {}
    try:
        for target, data in targets.items():
            temporary = target.with_name(f".derive-{secrets.token_hex(4)}-{target.name}")
            written[target] = temporary
            _write_one(temporary, data)
        for target, temporary in written.items():
            os.replace(temporary, target)
    finally:
        for temporary in written.values():
            with suppress(OSError):
                temporary.unlink(missing_ok=True)


def _write_one(path: Path, data: bytes) -> None:
    with open(path, "xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
