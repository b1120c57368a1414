"""The build: from robots to verified folders on disk, each replaced as a whole or not at all."""

from __future__ import annotations

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
