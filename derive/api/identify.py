"""The parameters of a robot from a log, from Python."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from derive.api.robots import RobotLike, load
from derive.errors import DeriveError, RobotFileError, quoted, require_known
from derive.identification.identified import Identified, identified
from derive.identification.log import Log
from derive.identification.regression import Method
from derive.identification.standard import Unknowns
from derive.publish.atomic_folder import ending_of, refuse_taken, write_files
from derive.robot.robot import Robot

ENDINGS = (".html", ".htm")  #: what the name of a report may end with


def identify(
    robot: RobotLike,
    log: str | Path | Mapping[str, Any] | Any,
    path: str | Path | None = None,
    *,
    report: str | Path | None = None,
    method: str = "wls",
    columns: Mapping[str, str] | None = None,
    add: Sequence[str] = ("viscous", "coulomb"),
    held_out: float | str | Path | Any = None,
    cutoff: float | None = None,
    decimate: int = 1,
    drop: bool = False,
    trust_torques: bool = False,
    force: bool = False,
) -> Identified:
    """Identify the base parameters of a robot from a log, as ``derive identify`` does.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue; its symbols all have numbers.
        log: Path of a .csv or .parquet, a mapping of names to columns, or a table of pyarrow.
        path: The robot file that is written; None for none.
        report: The web page that is written; None for none.
        method: ``ols``, ``wls`` (each joint by its noise), or ``possible``: within what bodies that exist can have.
        columns: Patterns of the columns by quantity (``time``, ``q``, ``qd``, ``qdd``, ``tau``), such as
            ``{"q": "position_*", "tau": "-effort_*"}``; ``*`` is a joint's number or name, a minus turns the sign.
        add: What is identified though the robot file does not give it: ``viscous``, ``coulomb``, ``armature``.
        held_out: A log for validation, or the part of the log, at its end, that is kept for it: 0.2.
        cutoff: Frequency of the filter [Hz]; None for 10 Hz where speeds or accelerations are missing.
        decimate: Of so many rows one is kept, regressor and torques filtered alike.
        drop: Whether rows without numbers and gaps in time are passed over.
        trust_torques: Whether torques are taken though they look like the robot's in another unit or of another sign.
        force: Whether files that exist are overwritten.

    Returns:
        The robot with the nearest links that have the identified base parameters, the parameters with their standard
        deviations, residuals, and the ``text`` of the robot file.

    Raises:
        DeriveError: A column is missing, rows are, the log is too short, or its torques are not the robot's.
        QuantityError: A robot without links, with coupled joints or with a symbol without a number.
        OutputError: There is such a file already, or it cannot be written.
        TargetError: pyarrow or SciPy is not installed.
    """
    refuse_taken([Path(each) for each in (path, report) if each is not None], force=force)
    if report is not None:
        ending_of(Path(report), ENDINGS)
    given, part = Robot.of(load(robot, remarks_on_bodies=False)), 0.0
    with suppress(TypeError, ValueError):  # of another log
        part = 0.0 if held_out is None else float(held_out)  # type: ignore[arg-type]
        if not 0 < part < 1 and held_out is not None:
            raise DeriveError(f"{part:g} of a log held out", allowed="allowed: a log, or a part such as 0.2")
    require_known(method, list(Method), f"no method {quoted(method)}")
    unknowns = Unknowns.of(given, tuple(add))
    logs = (log, *(() if part or held_out is None else (held_out,)))
    read = [Log(each, given, columns or {}, drop, cutoff, decimate) for each in logs]
    found = identified(unknowns, Method(method), read, part=1 - part, trusted=trust_torques)
    try:
        Robot.from_text(found.text)
    except RobotFileError as error:
        raise RobotFileError(f"identified: {error.found}", remedy="take --method possible") from error
    files = {Path(path): found.text.encode()} if path is not None else {}
    if report is not None:
        from derive.identification.report import report_page  # the handout's modules, which nothing else needs

        files[Path(report)] = report_page(found).encode()
    write_files(files, force=force)
    return found
