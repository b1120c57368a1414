"""Inertial parameters, motors, friction and gravity."""

from __future__ import annotations

from derive.robot.arithmetic import negate
from derive.robot.cells import Cells
from derive.robot.document import Document, Path
from derive.robot.expression import ZERO, Name
from derive.robot.robot import Inertia, Link, Motor, Vector

DEFAULT_GRAVITY_SYMBOL = "g"


def read_links(document: Document, cells: Cells, joints: int) -> tuple[Link, ...]:
    """One link per joint, or none when the file has no dynamics.

    Raises:
        RobotFileError: Another number of links than joints.
    """
    node = document.find(("links",))
    if node is None:
        return ()
    rows = document.length(("links",))
    if rows != joints:
        raise document.error(
            ("links",),
            f"{rows} {'row' if rows == 1 else 'rows'} for {joints} joints",
            f"allowed: exactly {joints}",
            "write one row per joint; a massless link is {mass: 0}",
        )
    return tuple(_link(document, cells, ("links", row)) for row in range(rows))


def _link(document: Document, cells: Cells, path: Path) -> Link:
    return Link(
        mass=cells.plain((*path, "mass")),
        com=_lengths(cells, (*path, "com")),
        inertia=_inertia(cells, (*path, "inertia")),
        motor=_motor(document, cells, (*path, "motor")),
        armature=cells.plain((*path, "armature")),
        viscous=cells.plain((*path, "friction", "viscous")),
        coulomb=cells.plain((*path, "friction", "coulomb")),
    )


def _lengths(cells: Cells, path: Path) -> Vector:
    x, y, z = (cells.length((*path, index)) for index in range(3))
    return x, y, z


def _inertia(cells: Cells, path: Path) -> Inertia:
    return Inertia(**{key: cells.plain((*path, key)) for key in ("xx", "yy", "zz", "xy", "xz", "yz")})


def _motor(document: Document, cells: Cells, path: Path) -> Motor | None:
    if document.find(path) is None:
        return None
    return Motor(**{key: cells.plain((*path, key)) for key in ("mass", "inertia", "ratio")})


def read_gravity(document: Document, cells: Cells) -> Vector | None:
    """Acceleration of gravity in the world frame [m/s^2].

    A file with links and without ``gravity`` means ``[0, 0, -g]``: z points up, and ``g`` is a symbol like any other.
    Read it after everything else, because that default is refused where ``g`` means something else.

    Raises:
        RobotFileError: No gravity although there are links, while ``g`` is used otherwise.
    """
    if document.find(("gravity",)) is not None:
        x, y, z = (cells.plain(("gravity", index)) for index in range(3))
        return x, y, z
    if document.find(("links",)) is None:
        return None
    if DEFAULT_GRAVITY_SYMBOL in cells.first_use:
        raise document.error(
            ("links",),
            "links without gravity, and the name 'g' is used for something else",
            "allowed: gravity: [gx, gy, gz]",
            "write the vector, for instance gravity: [0, 0, -9.81]",
        )
    cells.first_use[DEFAULT_GRAVITY_SYMBOL] = document.location(("links",))
    return ZERO, ZERO, negate(Name(DEFAULT_GRAVITY_SYMBOL))
