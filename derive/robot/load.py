"""From a path, a catalogue name or a text to a validated `Description`.

Inertial parameters, motors, friction and gravity.

Name and title of a robot.
"""

from __future__ import annotations

import keyword
import re
import unicodedata
from pathlib import Path

from derive.errors import Location, RobotFileError, UnknownRobotError, near_miss, quoted
from derive.robot.catalogue import catalogue_names, catalogue_text
from derive.robot.cells import Cells, Units, check_symbol
from derive.robot.description import Convention, Description, Inertia, Link, Motor, Vector
from derive.robot.document import Document, KeyPath, YamlMapping, read_document
from derive.robot.expression import ZERO, Expression, Name, names, negate
from derive.robot.limits import FILE_LIMITS
from derive.robot.presentation import read_figure, read_handout
from derive.robot.schema import check_structure
from derive.robot.style import Contraction, Style
from derive.robot.table import read_frame, read_joints
from derive.robot.validate import validate

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


def _link(document: Document, cells: Cells, path: KeyPath) -> Link:
    return Link(
        mass=cells.plain((*path, "mass")),
        com=_lengths(cells, (*path, "com")),
        inertia=_inertia(cells, (*path, "inertia")),
        motor=_motor(document, cells, (*path, "motor")),
        armature=cells.plain((*path, "armature")),
        viscous=cells.plain((*path, "friction", "viscous")),
        coulomb=cells.plain((*path, "friction", "coulomb")),
    )


def _lengths(cells: Cells, path: KeyPath) -> Vector:
    x, y, z = (cells.length((*path, index)) for index in range(3))
    return x, y, z


def _inertia(cells: Cells, path: KeyPath) -> Inertia:
    return Inertia(**{key: cells.plain((*path, key)) for key in ("xx", "yy", "zz", "xy", "xz", "yz")})


def _motor(document: Document, cells: Cells, path: KeyPath) -> Motor | None:
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


_NAME = re.compile(rf"[a-z0-9][a-z0-9-]{{0,{FILE_LIMITS.name_length - 1}}}")
_DEVICES = {"con", "prn", "aux", "nul"} | {f"{port}{k}" for port in ("com", "lpt") for k in range(10)}
_IMPORTED_BY_GENERATED_CODE = {"numpy", "casadi", "math", "derive"}
_FORBIDDEN_CATEGORIES = {"Cc", "Cs"}


def is_robot_name(name: str) -> bool:
    """Whether ``name`` has the right letters and makes an importable folder on every system."""
    taken = _DEVICES | _IMPORTED_BY_GENERATED_CODE
    return _NAME.fullmatch(name) is not None and not keyword.iskeyword(name) and name not in taken


def read_name(document: Document) -> str:
    """The robot's name, which becomes the name of an importable folder.

    Raises:
        RobotFileError: Not ``[a-z0-9][a-z0-9-]*``, or a name that cannot be a folder or a Python package.
    """
    scalar = document.scalar(("name",))
    name = scalar.text if scalar else ""
    if _NAME.fullmatch(name) is None:
        raise document.error(
            ("name",),
            f"{quoted(name)} is not a robot name",
            f"allowed: a-z, 0-9 and -, at most {FILE_LIMITS.name_length} characters",
            f"write for instance {_suggestion(name)}; the title may be any text",
        )
    if not is_robot_name(name):
        raise document.error(
            ("name",), f"'{name}' cannot be the name of a Python package", remedy=f"write for instance {name}-robot"
        )
    return name


def _suggestion(name: str) -> str:
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode("ascii").lower()
    words = re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[: FILE_LIMITS.name_length - 6]
    return words if _NAME.fullmatch(words) else f"robot-{words}".strip("-")


def read_title(document: Document) -> str:
    """The title, an inert text; empty when there is none.

    Raises:
        RobotFileError: Too long, or with control characters other than line breaks and tabs.
    """
    scalar = document.scalar(("title",))
    if scalar is None:
        return ""
    title = scalar.text
    if len(title) > FILE_LIMITS.title_length:
        raise document.error(
            ("title",), f"{len(title)} characters", f"allowed: at most {FILE_LIMITS.title_length}", "shorten it"
        )
    for character in title:
        if character not in "\n\t" and unicodedata.category(character) in _FORBIDDEN_CATEGORIES:
            raise document.error(
                ("title",), f"control character U+{ord(character):04X}", "allowed: text, line breaks and tabs"
            )
    return title


def load_description(path_or_name: str | Path) -> Description:
    """Load a robot file, or a robot of the catalogue.

    A text that is exactly a catalogue name means the catalogue; write ``./name`` for a file of that name.

    Args:
        path_or_name: Path of a YAML file, or a name that ``derive list`` shows.

    Raises:
        RobotFileError: The file cannot be read or does not describe a robot.
        ExpressionError: A cell is outside the grammar.
        UnknownRobotError: Neither a file nor a catalogue name.
    """
    text = str(path_or_name)
    if text in catalogue_names():
        return description_from_bytes(catalogue_text(text).encode(), text)
    path = Path(text)
    if "\0" in text or not _exists(path):
        raise UnknownRobotError(
            f"no file and no catalogue robot {quoted(text, 200)}",
            allowed="allowed: a path to a robot file, or a name from derive list",
            remedy=near_miss(path.stem, catalogue_names()),
        )
    return description_from_bytes(file_bytes(path), text)


def description_from_bytes(data: bytes, source: str) -> Description:
    """Load a robot from the bytes of a file.

    Raises:
        RobotFileError: The bytes do not describe a robot.
        ExpressionError: A cell is outside the grammar.
    """
    document = read_document(data, source if source.isprintable() else quoted(source, 200))
    check_structure(document)
    cells = Cells(document, _units(document))
    robot = _read(document, cells)
    validate(document, cells, robot)
    return robot


def _read(document: Document, cells: Cells) -> Description:
    joints = read_joints(document, cells)
    base, tool = read_frame(document, cells, "base"), read_frame(document, cells, "tool")
    links = read_links(document, cells, len(joints))
    gravity = read_gravity(document, cells)
    name = read_name(document)
    parameters = _parameters(document)
    return Description(
        name=name,
        title=read_title(document) or name,
        convention=Convention(_text(document, "convention")),
        joints=joints,
        base=base,
        tool=tool,
        gravity=gravity,
        links=links,
        parameters=parameters,
        runtime=_runtime(document),
        style=Style(_text(document, "style") or Style.COMPACT),
        contraction=Contraction(_text(document, "contraction") or Contraction.ALIGNED),
        handout=read_handout(document),
        figure=read_figure(document, cells, joints, parameters),
        digest=document.digest,
        source=document.source,
    )


def _text(document: Document, *path: str) -> str:
    scalar = document.scalar(path)
    return scalar.text if scalar else ""


def _units(document: Document) -> Units:
    return Units(
        degrees=_text(document, "units", "angle") == "deg",
        millimetres=_text(document, "units", "length") == "mm",
    )


def _parameters(document: Document) -> tuple[tuple[str, Expression], ...]:
    node = document.find(("parameters",))
    if not isinstance(node, YamlMapping):
        return ()
    si_cells = Cells(document, Units())
    return tuple((name, _constant(document, si_cells, name)) for name in node.entries)


def _constant(document: Document, cells: Cells, name: str) -> Expression:
    path = ("parameters", name)
    if document.find(path) is not None:
        check_symbol(document, path, name)
    value = cells.raw(path)
    if others := list(names(value)):
        raise document.error(
            path,
            f"name '{others[0]}' in the number of a parameter",
            "allowed: numbers and constant expressions such as sqrt(2)/2 or pi/6",
            "write its number",
        )
    return value


def _runtime(document: Document) -> tuple[str, ...]:
    count = document.length(("runtime",))
    found = tuple((document.scalar(("runtime", index)), index) for index in range(count))
    for scalar, index in found:
        check_symbol(document, ("runtime", index), scalar.text if scalar else "")
    return tuple(scalar.text for scalar, _ in found if scalar)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def file_bytes(path: Path) -> bytes:
    """Contents of a regular file, at most one byte more than is allowed.

    Raises:
        RobotFileError: Not a file, or it cannot be read.
    """
    shown = str(path) if str(path).isprintable() else quoted(str(path), 200)
    place = Location(shown)
    if not path.is_file():
        raise RobotFileError("not a file", remedy="give the path of a YAML file", location=place)
    try:
        with path.open("rb") as file:
            return file.read(FILE_LIMITS.size + 1)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise RobotFileError(f"cannot be read: {reason}", remedy="check its permissions", location=place) from None
