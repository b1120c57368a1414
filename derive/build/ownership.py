"""Whether a folder may be replaced, and which of the files in it are the user's."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from derive.build.manifest import FILE as MANIFEST
from derive.build.manifest import compiled_files, read_manifest
from derive.errors import OutputError

_CACHE = "__pycache__"


def require_replaceable(target: Path, robot_name: str, files: Iterable[str]) -> None:
    """Refuses to replace what derive did not write.

    Args:
        target: The folder to be written.
        robot_name: The robot it is for.
        files: Names of the files that will be written.

    Raises:
        OutputError: A symbolic link, a file, a folder without a manifest of ours, another robot's folder, or a file of
            the user's under the name of one to be written.
    """
    if target.is_symlink():
        raise _refusal(target, "is a symbolic link", "remove the link, or choose another --out")
    if not os.path.lexists(target):
        return
    if not target.is_dir():
        raise _refusal(target, "is not a folder", "move it away, or choose another --out")
    if not any(target.iterdir()):
        return
    manifest = read_manifest(target)
    if manifest is None:
        raise _refusal(target, f"holds files, but no {MANIFEST} of derive", "move it away, or choose another --out")
    if manifest.get("robot") != robot_name:
        raise _refusal(target, f"belongs to the robot {manifest.get('robot')!r}", "choose another --out")
    taken = sorted(set(files) & set(users_files(target)))
    if taken:
        raise _refusal(target / taken[0], f"is not listed in {MANIFEST}, but a build would write it", "move it away")


def users_files(target: Path) -> list[str]:
    """Names in a generated folder that no build has written: they are kept."""
    if target.is_symlink() or not target.is_dir():
        return []
    manifest = read_manifest(target) or {"files": {}}
    ours = {MANIFEST, _CACHE, *manifest["files"], *compiled_files(manifest)}
    return sorted(path.name for path in target.iterdir() if path.name not in ours)


def carry_over(target: Path, staging: Path) -> None:
    """Takes the user's files from the old folder into the new one; the old one keeps them until it is removed."""
    for name in users_files(target):
        source, copy = target / name, staging / name
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
