"""All files of one robot, in memory: a pure function of the robot file and the tool's version."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.programs.effort import Effort
from derive.programs.functions.functions import build_program
from derive.programs.interface import operations_of
from derive.publish.manifest import FILE as MANIFEST
from derive.publish.manifest import manifest_text
from derive.robot.robot import Robot
from derive.targets import templating
from derive.targets.escape import python_docstring
from derive.targets.readme import package_name
from derive.targets.target import Source, Target
from derive.version import __version__

PACKAGE = "__init__.py"


@dataclass(frozen=True, slots=True)
class Rendered:
    """The contents of a generated folder.

    Attributes:
        robot: The robot.
        files: Contents by file name, the manifest included, in the order of writing.
        operations: Operation counts by function.
    """

    robot: Robot
    files: dict[str, bytes]
    operations: dict[str, dict[str, int]]

    @property
    def folder(self) -> str:
        """Name of the folder: the robot's name as Python can import it."""
        return package_name(self.robot)


def render_robot(robot: Robot, targets: Sequence[Target], effort: Effort = Effort.FULL) -> Rendered:
    """Every file of every target, the package file and the manifest."""
    source = source_of(robot, targets, effort)
    files = {PACKAGE: _package(source).encode()}
    for target in targets:
        files |= {name: text.encode() for name, text in target.render(source).items()}
    files[MANIFEST] = manifest_text(source, targets, files, effort).encode()
    return Rendered(robot, files, operations_of(source.program))


def source_of(robot: Robot, targets: Sequence[Target], effort: Effort = Effort.FULL) -> Source:
    """What the targets are rendered from."""
    names = (PACKAGE, *(name for target in targets for name in target.files), MANIFEST)
    return Source(
        robot,
        build_program(robot, effort),
        __version__,
        tuple(sorted(names)),
    )


def _package(source: Source) -> str:
    context = {
        "title": python_docstring(source.robot.title),
        "name": source.robot.name,
        "version": source.version,
    }
    return templating.render("package/__init__.py.jinja", **context)
