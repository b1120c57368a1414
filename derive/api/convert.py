"""The same arm otherwise, from Python: by the other convention, with consistent bodies, or for another program."""

import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from derive.api.robots import Robot, RobotLike, load
from derive.errors import DeriveError, RobotFileWarning, near_miss, quoted
from derive.exchange.convert import Converted, convention_named, converted
from derive.exchange.formats import Exported, exported
from derive.model.identification.possible import Possible, wants_possible, with_chosen_bodies
from derive.model.identification.possible import possible as nearest
from derive.publish.atomic_folder import refuse_taken, write_files
from derive.robot.cells import joint_value
from derive.robot.description import Convention
from derive.robot.names import file_symbols


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
    paths = [] if path is None else [Path(path)]
    refuse_taken(paths, force=force)
    given = load(robot, remarks_on_bodies=not wants_possible(inertia))
    other = next(member for member in Convention if member is not given.convention)
    target = other if convention is None else convention_named(convention)
    bodies, changes = with_chosen_bodies(given, inertia)
    made = replace(converted(bodies, target, name), bodies=changes)
    write_files({path: made.text.encode() for path in paths}, force=force)
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


def export(
    robot: RobotLike,
    to: str,
    path: str | Path | None = None,
    *,
    inertia: str = "given",
    values: Mapping[str, float | str] | None = None,
    force: bool = False,
) -> str:
    """A robot in the format of another program, as ``derive export`` writes it.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        to: ``urdf``, ``mjcf``, ``rtb`` (Python), ``corke`` or ``rigidbodytree`` (MATLAB), or ``csv``.
        path: The file that is written; None for none.
        inertia: ``given``, or ``possible``: the nearest bodies that exist, with the same dynamics.
        values: Numbers or cells of symbols, as under ``parameters:``; they go before those of the robot file.
        force: Whether a file that exists is overwritten.

    Returns:
        The text; what the format cannot say stands in its first comment, and is issued as `RobotFileWarning`.

    Raises:
        DeriveError: An unknown format, or a symbol without a number.
        RobotFileError: The file does not describe a robot.
        OutputError: There is such a file or folder already, or it cannot be written.
    """
    return export_file(robot, to, path, inertia=inertia, values=values, force=force).text


def export_file(
    robot: RobotLike,
    to: str,
    path: str | Path | None,
    *,
    inertia: str = "given",
    values: Mapping[str, float | str] | None = None,
    force: bool = False,
) -> Exported:
    """What `export` does, of the same arguments, with its remarks as a result, too.

    Returns:
        The text and the remarks.
    """
    paths = [] if path is None else [Path(path)]
    refuse_taken(paths, force=force)
    chosen = load(robot, remarks_on_bodies=not wants_possible(inertia))
    symbols, cells = file_symbols(chosen), {}
    for name, value in (values or {}).items():
        if name not in symbols:
            allowed = f"allowed: {', '.join(symbols)}" if symbols else "the robot has no symbols"
            raise DeriveError(f"no {quoted(name)} in {chosen.name}", allowed=allowed, remedy=near_miss(name, symbols))
        cells[name] = joint_value(chosen, None, value if isinstance(value, str) else repr(float(value)), name)
    found = exported(chosen, to, inertia, cells)
    for remark in found.remarks:
        warnings.warn(f"{chosen.name}: {remark}", RobotFileWarning, stacklevel=3)
    write_files({path: found.text.encode() for path in paths}, force=force)
    return found
