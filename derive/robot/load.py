"""From a path, a name of the catalogue or a text to a validated `Description`: names, parameters, and the whole."""

import keyword
import re
import unicodedata
from dataclasses import replace
from functools import cache, lru_cache
from importlib.resources import files
from itertools import takewhile
from pathlib import Path

from derive.errors import Location, RobotFileError, UnknownRobotError, near_miss, quoted
from derive.robot.cells import Cells, check_symbol, inert_text
from derive.robot.description import Description, FileUnits
from derive.robot.expression import Expression
from derive.robot.presentation import read_figure, read_handout, read_inverse, read_style
from derive.robot.reading.document import Document, KeyPath, YamlMapping, read_document
from derive.robot.reading.schema import check_structure
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.reading.table import read_table
from derive.robot.validate import remarks_on, remarks_on_bodies, validate

_CATALOGUE = "robot/catalogue"
_SUFFIX = ".yaml"


@cache
def names_in(folder: str) -> tuple[str, ...]:
    """Names of the built-in files in a folder of derive, sorted."""
    found = (entry.name for entry in files("derive").joinpath(folder).iterdir())
    return tuple(sorted(name.removesuffix(_SUFFIX) for name in found if name.endswith(_SUFFIX)))


def catalogue_names() -> tuple[str, ...]:
    """Names of the built-in robots, sorted."""
    return names_in(_CATALOGUE)


_NAME = re.compile(rf"[a-z0-9][a-z0-9-]{{0,{FILE_LIMITS.name_length - 1}}}")
_TAKEN = {
    *("con", "prn", "aux", "nul"),  # devices of Windows, whatever their ending
    *(f"{port}{k}" for port in ("com", "lpt") for k in range(10)),
    *("numpy", "casadi", "math", "derive"),  # imported by generated code
}


def robot_file_bytes(path_or_name: str | Path) -> bytes:
    """Contents of a robot file, or of the file of a robot of the catalogue."""
    return named_bytes(path_or_name, _CATALOGUE, "robot", "derive list")


def named_bytes(path_or_name: str | Path, folder: str, kind: str, command: str) -> bytes:
    """Contents of a file, or of a built-in one of a folder, whose names a command lists."""
    # A text that is exactly a built-in name means that file; users write ./name for a file of that name.
    text = str(path_or_name)
    if text in names_in(folder):
        return files("derive").joinpath(folder, f"{text}{_SUFFIX}").read_bytes()
    path = Path(text)
    if not is_there(path):
        found = f"{quoted(text, 200)} is neither a file nor a built-in {kind}"
        allowed = f"allowed: a path, or a name from {command}"
        raise UnknownRobotError(found, allowed=allowed, remedy=near_miss(path.stem, names_in(folder)))
    return file_bytes(path)


def is_there(path: Path) -> bool:
    """Whether a path that a user typed exists; False where no file can have it."""
    try:
        return "\0" not in str(path) and path.exists()
    except (OSError, ValueError):
        return False


def file_bytes(path: Path, most: int = FILE_LIMITS.size) -> bytes:
    """Contents of a regular file, at most one byte more than it may have."""
    place = Location(str(path) if str(path).isprintable() else quoted(str(path), 200))
    if not path.is_file():
        raise RobotFileError("not a file", remedy="give the path of a YAML file", location=place)
    try:
        with path.open("rb") as file:
            return file.read(most + 1)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise RobotFileError(f"cannot be read: {reason}", remedy="check its permissions", location=place) from None


@lru_cache(64)
def description_from_bytes(data: bytes, source: str) -> Description:
    """Load a robot from the bytes of a file."""
    document = read_document(data, source if source.isprintable() else quoted(source, 200))
    check_structure(document)
    others = (("angle", "deg"), ("length", "mm"), ("parameters", "file"))  # than in the robot itself
    units = FileUnits(*(document.text("units", key) == word for key, word in others))
    cells = Cells(document, units)
    table = read_table(document, cells)
    name, parameters = _name(document), _parameters(document)
    runtime = tuple(document.text("runtime", index) for index in range(document.length(("runtime",))))
    for index, symbol in enumerate(runtime):
        check_symbol(document, ("runtime", index), symbol)
    head = takewhile(lambda line: line.startswith("#"), data.decode("utf-8-sig").splitlines())
    robot = replace(
        table,
        name=name,
        title=inert_text(document, ("title",), "\n\t") or name,
        parameters=parameters,
        runtime=runtime,
        wrench=tuple(document.text("wrench", index) for index in range(document.length(("wrench",)))),
        style=read_style(document),
        handout=read_handout(document),
        figure=read_figure(document, cells, table.variables, parameters),
        inverse=read_inverse(document, table.variables),
        units=units,
        digest=document.digest,
        source=document.source,
        comments=tuple(line[1:].strip() for line in head),
    )
    if units.parameters:
        read = Cells(document, units).symbol
        drawn = tuple((name, read(("figure", "values", name), robot, name)) for name, _ in robot.figure.values)
        given = tuple((name, read(("parameters", name), robot, name)) for name, _ in parameters)
        robot = replace(robot, parameters=given, figure=replace(robot.figure, values=drawn))
    validate(document, cells, robot)
    found = (*remarks_on(document, robot), *remarks_on_bodies(document, robot))
    remarks = sorted(found, key=lambda remark: (remark.location.line, remark.location.column))
    return replace(robot, remarks=tuple(remarks))


def _parameters(document: Document) -> tuple[tuple[str, Expression], ...]:
    node = document.find(("parameters",))
    if not isinstance(node, YamlMapping):
        return ()
    cells, found = Cells(document, FileUnits()), []
    allowed = "allowed: numbers and constant expressions such as sqrt(2)/2 or pi/6"
    for name in node.entries:
        path: KeyPath = ("parameters", name)
        check_symbol(document, path, name)
        found.append((name, cells.constant(path, cells.raw(path), "the number of a parameter", allowed)))
    return tuple(found)


def is_robot_name(name: str) -> bool:
    """Whether a name has the right letters and makes an importable folder on every system."""
    return _NAME.fullmatch(name) is not None and not keyword.iskeyword(name) and name not in _TAKEN


def _name(document: Document) -> str:
    """The robot's name, which becomes the name of an importable folder."""
    name = document.text("name")
    if _NAME.fullmatch(name) is None:
        plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode("ascii").lower()
        words = re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[: FILE_LIMITS.name_length - 6]
        suggestion = words if _NAME.fullmatch(words) else f"robot-{words}".strip("-")
        allowed = f"allowed: a-z, 0-9 and -, at most {FILE_LIMITS.name_length} characters"
        remedy = f"write for instance {suggestion}; the title may be any text"
        raise document.error(("name",), f"{quoted(name)} is not a robot name", allowed, remedy)
    if not is_robot_name(name):
        found = f"'{name}' cannot be the name of a Python package"
        raise document.error(("name",), found, remedy=f"write for instance {name}-robot")
    return name
