"""Which robots there are, how a function of the Python API is given one, and `derive.Robot` itself."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Self, Unpack

from derive.errors import RobotFileWarning
from derive.robot.description import Remark
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot as PlainRobot

if TYPE_CHECKING:
    from derive.exchange.from_urdf import ImportKeywords

RobotLike = PlainRobot | str | Path  #: a robot, the path of a robot file, or a name of the catalogue


class Robot(PlainRobot):
    """A serial arm, as `derive.robot.robot.Robot`, with what else can be made of it as methods.

    It is equal to the plain robot of the same data.
    """

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PlainRobot) and _data(self) == _data(other)

    def __hash__(self) -> int:
        return PlainRobot.__hash__(self)

    def convert(self, convention: str, inertia: str = "given") -> Robot:
        """The same arm by the table of the other Denavit-Hartenberg convention; see `derive.convert`.

        Args:
            convention: ``standard`` or ``modified``.
            inertia: ``given``, or ``possible``: the nearest bodies that exist, with the same dynamics.

        Returns:
            The arm whose T, J, B, C, g and tau are the same functions.

        Raises:
            DeriveError: No such convention, or the robot's own, or there are no possible bodies.
        """
        from derive.exchange.convert import convention_named, converted  # `import derive` and `load` need no algebra
        from derive.model.identification.possible import with_chosen_bodies

        return Robot.of(converted(with_chosen_bodies(self, inertia)[0], convention_named(convention)).robot)

    @classmethod
    def from_urdf(
        cls,
        file: str | Path | bytes,
        *,
        tip: str | None = None,
        base: str | None = None,
        **options: Unpack[ImportKeywords],
    ) -> Self:
        """The robot of a chain of a URDF; `derive.import_urdf` also tells what is known about it.

        Args:
            file: Path of a URDF or a .xacro file, or the contents of a URDF.
            tip: Last link; None where only one carries no other.
            base: Link that stands; None for the one on which everything hangs.
            options: Such as ``convention="modified"``: those of `derive.import_urdf`, which raises the same errors.
        """
        from derive.api.importing import import_urdf

        return cls.of(import_urdf(file, tip=tip, base=base, **options).robot)

    def to_urdf(self, inertia: str = "given") -> str:
        """The robot as URDF; see `derive.export` for its remarks, files, and numbers of symbols.

        Args:
            inertia: ``given``, or ``possible``: the nearest bodies that exist, with the same dynamics.

        Returns:
            The text, with what URDF cannot say in its first comment.

        Raises:
            DeriveError: A symbol has no number, or there are no possible bodies.
        """
        from derive.exchange.formats import exported  # `import derive` and `load` need none of it

        return exported(self, "urdf", inertia).text

    def to_mjcf(self, inertia: str = "given") -> str:
        """The robot as MJCF, for MuJoCo, as `to_urdf` makes URDF of it.

        Args:
            inertia: As there.

        Returns:
            The text, with what MJCF cannot say in its first comment.
        """
        from derive.exchange.formats import exported

        return exported(self, "mjcf", inertia).text


def _data(robot: PlainRobot) -> tuple[object, ...]:
    return tuple(getattr(robot, part.name) for part in fields(robot) if part.compare)


def catalogue() -> tuple[str, ...]:
    """Names of the built-in robots.

    Returns:
        The names that ``derive list`` shows, sorted.
    """
    return catalogue_names()


def load(robot: RobotLike, *, remarks_on_bodies: bool = True) -> Robot:
    """Load a robot.

    Args:
        robot: Path of a robot file, a name of the catalogue, or a robot, which stays itself.
        remarks_on_bodies: Whether it is told, too, which links no body can be; nobody need know where no dynamics are
            made.

    Returns:
        The validated robot; its ``remarks`` are issued as `RobotFileWarning`, too.

    Raises:
        RobotFileError: The file cannot be read or does not describe a robot.
        UnknownRobotError: Neither a file nor a catalogue name.
    """
    if isinstance(robot, Robot):
        return robot
    if isinstance(robot, PlainRobot):
        return Robot.of(robot)
    found = Robot.load(robot)
    tell(remark for remark in found.remarks if remarks_on_bodies or not remark.is_of_bodies)
    return found


def tell(remarks: Iterable[Remark]) -> None:
    """Issue remarks on a robot file as warnings.

    Args:
        remarks: Of a robot that has just been read.
    """
    for remark in remarks:
        warnings.warn(RobotFileWarning(str(remark), remark.location), stacklevel=3)


def load_all(robots: Iterable[RobotLike] | None) -> list[Robot]:
    """Load several robots.

    Args:
        robots: Robots, paths or names; None for the whole catalogue.

    Returns:
        The validated robots in that order, as `load` gives them.
    """
    return [load(robot) for robot in (catalogue() if robots is None else robots)]
