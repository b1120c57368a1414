"""Robots in the formats of other programs, from Python."""

import warnings
from collections.abc import Mapping
from pathlib import Path

from derive.api.robots import RobotLike, load
from derive.errors import DeriveError, RobotFileWarning, near_miss, quoted
from derive.exchange.formats import Exported, exported
from derive.model.identification.possible import wants_possible
from derive.publish.atomic_folder import refuse_taken, write_files
from derive.robot.cells import joint_value
from derive.robot.names import file_symbols


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
    if path is not None:
        refuse_taken([Path(path)], force=force)
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
    if path is not None:
        write_files({Path(path): found.text.encode()}, force=force)
    return found
