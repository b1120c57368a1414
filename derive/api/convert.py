"""The same arm otherwise, from Python: by the table of the other convention, or with physically consistent bodies."""

from dataclasses import replace
from pathlib import Path

from derive.api.robots import Robot, RobotLike, load
from derive.exchange.convert import Converted, convention_named, converted
from derive.model.identification.possible import Possible, wants_possible, with_chosen_bodies
from derive.model.identification.possible import possible as nearest
from derive.publish.atomic_folder import refuse_taken, write_files
from derive.robot.description import Convention


def convert(
    robot: RobotLike,
    convention: str | None = None,
    path: str | Path | None = None,
    *,
    inertia: str = "given",
    name: str | None = None,
    force: bool = False,
) -> Converted:
    """The same arm by the table of the other convention, as ``derive convert`` makes it.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        convention: ``standard`` or ``modified``; None for the other one.
        path: The robot file that is written; None for none.
        inertia: ``given``, or ``possible``: the nearest bodies that exist and give the same torques; a robot of
            numbers alone.
        name: Name of the new robot; None for the same.
        force: Whether a file that exists is overwritten.

    Returns:
        ``text`` of the robot file, the ``robot`` that it describes, ``notes`` on what the other convention says
        otherwise, and the ``conversion``: which factor has moved where.

    Raises:
        DeriveError: No such convention, or the robot's own; no such choice of inertia, or no possible bodies.
        RobotFileError: A file that cannot be read or does not describe a robot, or a name that no robot may have.
        OutputError: There is such a file or folder already, or it cannot be written.
    """
    if path is not None:
        refuse_taken([Path(path)], force=force)
    given = load(robot, remarks_on_bodies=not wants_possible(inertia))
    other = next(member for member in Convention if member is not given.convention)
    target = other if convention is None else convention_named(convention)
    bodies, changes = with_chosen_bodies(given, inertia)
    made = replace(converted(bodies, target, name), bodies=changes)
    if path is not None:
        write_files({Path(path): made.text.encode()}, force=force)
    return made


def possible(robot: RobotLike) -> Possible:
    """The nearest physically consistent bodies that give the same torques.

    Args:
        robot: Path of a robot file, a name of the catalogue, or a robot; its symbols all have numbers.

    Returns:
        The robot with these links, what was changed, and the text of its robot file.

    Raises:
        NoSuchBodies: There are none; the message says why.
        DeriveError: The robot has no links or symbols without numbers, or the packages of the extra are missing.
    """
    return nearest(Robot.of(load(robot, remarks_on_bodies=False)))
