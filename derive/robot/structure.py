"""Checks a document's structure against the schema; a violation becomes one message at its place in the file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from derive.errors import DeriveError, Location, RobotFileError
from derive.robot.document import Document, Mapping, Node, Path, Scalar, Sequence
from derive.robot.wording import listed, near_miss, path_text, quoted

if TYPE_CHECKING:
    from pydantic import BaseModel

_HABITS = {
    "offset": "write it into the cell, for instance theta: q1 + pi/2",
    "theta0": "write it into the cell, for instance theta: q1 + pi/2",
    "sigma": "write type: revolute or type: prismatic",
    "m": "write mass",
    "r": "write com",
    "I": "write inertia: {xx: ..., yy: ..., zz: ...}",
    "Jm": "write motor: {inertia: ..., ratio: ...} or armature",
    "G": "write motor: {inertia: ..., ratio: ...} or armature",
    "B": "write friction: {viscous: ...}",
    "Tc": "write friction: {coulomb: ...}",
    "qlim": "write limits: [lower, upper]",
    "yx": "write xy",
    "zx": "write xz",
    "zy": "write yz",
    "<<": "merge keys are not supported; write the values out",
}
"""Keys that people bring from other tools, and what to write instead."""


def check_structure(document: Document) -> None:
    """Refuse unknown keys, missing keys and wrong shapes.

    Raises:
        RobotFileError: The first violation in the file, unknown keys before anything else.
    """
    from pydantic import ValidationError

    from derive.robot.schema import RobotFile

    try:
        RobotFile.model_validate(plain(document.root))
    except ValidationError as error:
        raise _first(document, error.errors(include_url=False, include_input=False)) from None


def plain(node: Node) -> Any:
    """The tree as dicts, lists and texts."""
    match node:
        case Scalar():
            return node.text
        case Sequence():
            return [plain(item) for item in node.items]
        case Mapping():
            return {key: plain(value) for key, (_, value) in node.entries.items()}


def _first(document: Document, errors: list[Any]) -> RobotFileError:
    found = [(item["type"] != "extra_forbidden", _message(document, item)) for item in errors]
    return min(found, key=lambda pair: (pair[0], _order(pair[1])))[1]


def _order(error: DeriveError) -> tuple[int, int]:
    place = error.location or Location("")
    return (place.line, place.column)


def _message(document: Document, item: dict[str, Any]) -> RobotFileError:
    path: Path = tuple(item["loc"])
    kind = item["type"]
    if kind == "extra_forbidden":
        return _unknown_key(document, path)
    if path and isinstance(path[-1], int) and kind == "missing":
        return _wrong_length(document, path[:-1])
    if kind == "missing":
        return _missing_key(document, path)
    if kind in ("literal_error", "enum"):
        return _wrong_choice(document, path, item)
    if kind in ("too_long", "too_short"):
        return _wrong_length(document, path)
    return document.error(path, _found(document.find(path)), _expected(path, kind), _remedy(document.find(path)))


def _unknown_key(document: Document, path: Path) -> RobotFileError:
    key = str(path[-1])
    allowed = _fields(path[:-1])
    remedy = _HABITS.get(key) or near_miss(key, allowed) or "remove it"
    return RobotFileError(
        f"{path_text(path[:-1])}: unknown key {quoted(key)}",
        allowed=f"allowed: {listed(allowed)}",
        remedy=remedy,
        location=document.key_location(path),
    )


def _missing_key(document: Document, path: Path) -> RobotFileError:
    key = str(path[-1])
    remedy = {
        "convention": "write convention: standard (distal) or convention: modified (Craig); they give different robots",
        "type": "write type: revolute or type: prismatic",
        "name": "write name: my-robot",
        "joints": "write one row per joint under joints:",
    }.get(key, "add it")
    return document.error(path[:-1], f"key '{key}' is missing", remedy=remedy)


def _wrong_choice(document: Document, path: Path, item: dict[str, Any]) -> RobotFileError:
    node = document.find(path)
    text = node.text if isinstance(node, Scalar) else ""
    allowed = item["ctx"]["expected"]
    found = f"found {quoted(text)}" if isinstance(node, Scalar) else _found(node)
    choices = [word.strip(" '") for word in allowed.replace(" or ", ",").split(",")]
    return document.error(path, found, f"allowed: {allowed}", near_miss(text, choices))


def _wrong_length(document: Document, path: Path) -> RobotFileError:
    expected = {"limits": 2, "com": 3, "gravity": 3}.get(str(path[-1]), 4) if path else 0
    count = document.length(path)
    remedy = "write [lower, upper]" if path[-1:] == ("limits",) else "write zeros where nothing else is"
    found = f"{count} entry" if count == 1 else f"{count} entries"
    return document.error(path, found, f"allowed: exactly {expected}", remedy)


def _found(node: Node | None) -> str:
    match node:
        case Scalar(text="") | None:
            return "found nothing"
        case Scalar():
            return f"found the text {quoted(node.text)}"
        case Sequence():
            return "found a list"
        case Mapping():
            return "found a mapping"


def _expected(path: Path, kind: str) -> str:
    if path[-1:] in (("name",), ("title",), ("language",)) or (path[:1], path[-1:]) == (("joints",), ("q",)):
        return "allowed: a text"
    if path[:2] == ("handout", "parts") and kind == "string_type":
        return "allowed: names of parts"
    if kind == "string_type":
        return "allowed: one number, name or expression"
    if kind in ("list_type", "tuple_type"):
        return "allowed: a list"
    return f"allowed: a mapping with the keys {listed(_fields(path))}" if _fields(path) else "allowed: a mapping"


def _remedy(node: Node | None) -> str:
    if isinstance(node, Mapping):
        return "check the indentation; texts with ': ' or '{' need quotation marks"
    return "check the indentation and the dashes"


def _fields(path: Path) -> tuple[str, ...]:
    """Allowed keys of the mapping at a path."""
    from derive.robot import schema

    model: type[BaseModel] = schema.RobotFile
    nested: dict[str, type[BaseModel]] = {
        "joints": schema.JointRow,
        "links": schema.LinkRow,
        "units": schema.Units,
        "motor": schema.MotorRow,
        "friction": schema.FrictionRow,
        "inertia": schema.InertiaRow,
        "handout": schema.HandoutRow,
        "notation": schema.NotationRow,
        "figure": schema.FigureRow,
    }
    for part in path:
        if part in ("parameters", "values"):
            return ()
        model = nested.get(str(part), model)
    return tuple(model.model_fields)
