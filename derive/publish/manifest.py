"""``MANIFEST.json``: what a generated folder was made from, and what is in it."""

import hashlib
import json
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

from derive.programs.optimise.search_policy import Effort
from derive.robot.expression import to_text
from derive.robot.names import free_symbols
from derive.targets.target import Source, Target

MANIFEST = "MANIFEST.json"
GENERATOR = "derive"
LARGEST = 10_000_000  # bytes of a manifest that is read at all


def manifest_text(source: Source, targets: Collection[Target], files: Mapping[str, bytes], effort: Effort) -> str:
    """The manifest of a build."""
    robot = source.robot
    content = {
        "generator": GENERATOR,
        "version": source.version,
        "robot": robot.name,
        "robot_file_sha256": robot.digest,
        "effort": effort.value,
        "convention": robot.convention.value,
        "dof": robot.dof,
        "joints": [{"name": joint.variable, "type": joint.type.value} for joint in robot.variables],
        "parameters": {
            "free": list(free_symbols(robot)),
            "numbers": {name: to_text(value) for name, value in dict(robot.parameters).items()},
        },
        "operations": source.program.operations,
        "operations_on_parameters": source.program.hoisted_operations,
        "targets": [target.name for target in targets],
        "compiled": sorted(name for target in targets for name in target.compiled),
        "files": {name: hashlib.sha256(data).hexdigest() for name, data in files.items()},
    }
    return json.dumps(content, indent=2, sort_keys=True) + "\n"


def read_manifest(folder: Path) -> dict[str, Any] | None:
    """The manifest of a folder; None if there is none of ours."""
    path = folder / MANIFEST
    try:
        if path.is_symlink() or not path.is_file() or path.stat().st_size > LARGEST:
            return None
        content = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return None
    ours = isinstance(content, dict) and content.get("generator") == GENERATOR
    return content if ours and isinstance(content.get("files"), dict) else None


def compiled_files(manifest: Mapping[str, Any]) -> tuple[str, ...]:
    """Libraries of a folder: compiled from its files, and of other bytes with every compiler."""
    return _names(manifest, "compiled")


def written_targets(folder: Path) -> tuple[str, ...]:
    """The targets that a folder holds."""
    return _names(read_manifest(folder) or {}, "targets")


def _names(manifest: Mapping[str, Any], key: str) -> tuple[str, ...]:
    names = manifest.get(key, ())
    return tuple(name for name in names if isinstance(name, str)) if isinstance(names, list) else ()


def is_current(folder: Path, robot_digest: str, version: str, targets: Iterable[Target], effort: Effort) -> bool:
    """Whether a folder holds, untouched, what these targets of this version make of this robot file."""
    if (manifest := read_manifest(folder)) is None:
        return False
    wanted = (robot_digest, version, [target.name for target in targets], effort)
    found = tuple(manifest.get(key) for key in ("robot_file_sha256", "version", "targets", "effort"))
    if found != wanted or not all((folder / name).is_file() for name in compiled_files(manifest)):
        return False
    held = ((contents(folder / name), expected) for name, expected in manifest["files"].items())
    return all(data is not None and hashlib.sha256(data).hexdigest() == expected for data, expected in held)


def contents(path: Path) -> bytes | None:
    """The bytes of a generated file; None if it is a link, is not there, or cannot be read."""
    try:
        return None if path.is_symlink() else path.read_bytes()
    except OSError:
        return None
