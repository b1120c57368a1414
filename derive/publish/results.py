"""What a build reports."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from derive.verify.report import Report

Progress = Callable[[str, str], None]
"""Called with the robot's name and a stage: derive, compile, verify, done or failed."""


@dataclass(frozen=True, slots=True)
class BuildResult:
    """A robot that was built, or need not be.

    Attributes:
        robot: Its name.
        folder: Where its files are.
        files: Their names.
        unchanged: Whether nothing had to be done.
        operations: Operation counts by function; empty if nothing was done.
        report: What the verification found; None if it was off or nothing was done.
        seconds: Wall time.
    """

    robot: str
    folder: Path
    files: tuple[str, ...]
    unchanged: bool
    operations: dict[str, dict[str, int]]
    report: Report | None
    seconds: float

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {
            "robot": self.robot,
            "folder": str(self.folder),
            "files": list(self.files),
            "status": "unchanged" if self.unchanged else "built",
            "operations": self.operations,
            "verification": self.report.as_dict() if self.report else None,
            "seconds": round(self.seconds, 3),
        }


@dataclass(frozen=True, slots=True)
class BuildFailure:
    """A robot that could not be built.

    Attributes:
        robot: Its name.
        error: Why.
    """

    robot: str
    error: Exception

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {"robot": self.robot, "status": "failed", "error": str(self.error)}


@dataclass(frozen=True, slots=True)
class CheckResult:
    """How a folder differs from what a build would write.

    Attributes:
        robot: Name of the robot.
        folder: The folder.
        stale: Files with other contents.
        missing: Files that are not there.
        extra: Files of an earlier build that this one would not write.
    """

    robot: str
    folder: Path
    stale: tuple[str, ...]
    missing: tuple[str, ...]
    extra: tuple[str, ...]

    @property
    def is_current(self) -> bool:
        """Whether there is no difference."""
        return not (self.stale or self.missing or self.extra)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {
            "robot": self.robot,
            "folder": str(self.folder),
            "status": "current" if self.is_current else "stale",
            "stale": list(self.stale),
            "missing": list(self.missing),
            "extra": list(self.extra),
        }
