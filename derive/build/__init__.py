"""The build: from robots to verified folders on disk, each replaced as a whole or not at all."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from derive.build.many import build_many, check_many
    from derive.build.pipeline import build_robot, check_robot, folder_of
    from derive.build.results import BuildFailure, BuildResult, CheckResult, Progress

__all__ = [
    "BuildFailure",
    "BuildResult",
    "CheckResult",
    "Progress",
    "build_many",
    "build_robot",
    "check_many",
    "check_robot",
    "folder_of",
]

_HOMES = {
    "BuildFailure": "results",
    "BuildResult": "results",
    "CheckResult": "results",
    "Progress": "results",
    "build_many": "many",
    "build_robot": "pipeline",
    "check_many": "many",
    "check_robot": "pipeline",
    "folder_of": "pipeline",
}


def __getattr__(name: str) -> Any:
    """Import on first use: publishing a folder needs no mathematics."""
    if name not in _HOMES:
        raise AttributeError(f"module 'derive.build' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"derive.build.{_HOMES[name]}"), name)
