"""Structure of a robot file: which keys, which shapes; a violation becomes one message at its place in the file.

What cells mean is read elsewhere. Every scalar arrives as text (see `document`), so the models hold texts;
the JSON Schema, which editors use, says that numbers may be written as numbers. The names of the models stand in it.
"""

from __future__ import annotations

from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

from derive.errors import Location, RobotFileError, listed, near_miss, path_text, quoted
from derive.robot.options import handout as sheet
from derive.robot.options.inverse import ROWS
from derive.robot.options.style import DEFAULT_STYLE, Style
from derive.robot.reading import structure
from derive.robot.reading.document import Document, KeyPath, Node, YamlMapping, YamlScalar, YamlSequence
from derive.robot.reading.hints import choice_hint, key_hint, shape_hint
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.reading.structure import Discriminator, Field, Strict, Tag, WithJsonSchema, fits, model_of, usually

if TYPE_CHECKING:
    from pydantic import BaseModel

NAME_PATTERN = rf"^[A-Za-z][A-Za-z0-9_]{{0,{FILE_LIMITS.name_length - 1}}}$"
ROBOT_NAME_PATTERN = rf"^[a-z0-9][a-z0-9-]{{0,{FILE_LIMITS.name_length - 1}}}$"

Cell = Annotated[str, WithJsonSchema({"type": ["string", "number"]})]
Symbol = Annotated[str, WithJsonSchema({"type": "string", "pattern": NAME_PATTERN})]
RowName = Annotated[str, WithJsonSchema({"type": "string", "minLength": 1, "maxLength": FILE_LIMITS.title_length})]
Flag = Annotated[Literal["true", "false"], WithJsonSchema({"type": "boolean"})]
Part = Annotated[str, WithJsonSchema({"type": "string", "enum": list(sheet.PARTS)})]
Language = Annotated[str, WithJsonSchema({"type": "string", "pattern": "^[a-z]{2}(_[A-Z]{2})?$"})]
Pages = Annotated[str, WithJsonSchema({"type": "integer", "minimum": 0, "maximum": sheet.MOST_PAGES})]
TaskName = Literal["pose", "position"]
TaskRow = Annotated[str, WithJsonSchema({"type": "string", "enum": list(ROWS)})]
StyleName = Literal["compact", "by-geometry", "expanded"]
Vector3 = tuple[Cell, Cell, Cell]
Row4 = tuple[Cell, Cell, Cell, Cell]
Matrix4 = tuple[Row4, Row4, Row4, Row4]


_NAME, _BLOCK = "<name>", "<block>"
# The forms that a value may have; they stand in the paths of violations, where no key can be called so.
FORMS = (_NAME, "<list>", _BLOCK)


def _block_if(kind: type) -> Any:
    return Discriminator(lambda value: _BLOCK if isinstance(value, kind) else _NAME)


class Units(Strict):
    """Units of plain numbers in joint cells, limits, centres of mass, base and tool; all else is SI."""

    angle: Literal["rad", "deg"] = usually("rad", "Unit of plain numbers in angle cells.")
    length: Literal["m", "mm"] = usually("m", "Unit of plain numbers in length cells.")
    parameters: Literal["si", "file"] = usually(
        "si", "Numbers of symbols: in SI units and radians, or in those of the cells they stand in."
    )


class JointRow(Strict):
    """One row of the Denavit-Hartenberg table."""

    type: Literal["revolute", "prismatic", "fixed"] = Field(description="What the joint's variable is, if it has one.")
    q: Symbol | None = usually(None, "Name of the joint variable; default q1, q2, ... by joint.")
    theta: Cell = usually("0", "Angle about z; a revolute joint's default is its variable.")
    d: Cell = usually("0", "Offset along z; a prismatic joint's default is its variable.")
    a: Cell = usually("0", "Link length; in the modified convention a_{i-1}.")
    alpha: Cell = usually("0", "Link twist; in the modified convention alpha_{i-1}.")
    limits: tuple[Cell, Cell] | None = usually(None, "Lower and upper limit of the variable.")
    speed: Cell | None = usually(None, "Largest speed of the variable, either way.")
    torque: Cell | None = usually(None, "Largest torque [N m] or force [N] of the joint, either way.")
    name: RowName | None = usually(None, "What others call the row; default: as the variable.")
    after: RowName | None = usually(None, "Row that it follows, or base; default: the row above.")
    mount: Matrix4 | None = usually(None, "Constant transform before all else of the row.")
    gamma: Cell = usually("0", "Angle about z of the row before; in the modified convention.")
    b: Cell = usually("0", "Offset along z of the row before; in the modified convention.")
    passive: Flag = usually("false", "Whether closed loops move the joint.")


class MotorRow(Strict):
    """Rotor that drives this joint, carried by the link before."""

    mass: Cell = usually("0", "Mass of the rotor [kg].")
    inertia: Cell = usually("0", "Moment of inertia about the spin axis [kg m^2].")
    ratio: Cell = usually("0", "Gear ratio; the rotor spins at ratio times the joint's velocity.")


class FrictionRow(Strict):
    """Joint-side friction, part of tau only."""

    viscous: Cell = usually("0", "Coefficient b of b*qd.")
    coulomb: Annotated[Annotated[Cell, Tag(_NAME)] | Annotated[tuple[Cell, Cell], Tag(_BLOCK)], _block_if(list)] = (
        usually("0", "Coefficient f of f*sign(qd), or [f_plus, f_minus]: f_plus at qd > 0, -f_minus at qd < 0.")
    )


class InertiaRow(Strict):
    """Inertia tensor about the centre of mass, axes of the link's own frame [kg m^2]."""

    xx: Cell = "0"
    yy: Cell = "0"
    zz: Cell = "0"
    xy: Cell = "0"
    xz: Cell = "0"
    yz: Cell = "0"


class BodyRow(Strict):
    """A body, in the frame that carries it."""

    mass: Cell = usually("0", "Mass [kg].")
    com: Vector3 = usually(("0", "0", "0"), "Centre of mass in the link's own frame.")
    inertia: InertiaRow = usually(InertiaRow(), "Tensor about the centre of mass [kg m^2].")


class LinkRow(BodyRow):
    """Inertial parameters of one link, in its own DH frame."""

    motor: MotorRow | None = usually(None, "Full model of the joint's motor.")
    armature: Cell = usually("0", "Reflected rotor inertia ratio^2*Jm, added to B[i,i] only.")
    friction: FrictionRow = usually(FrictionRow(), "Joint-side friction.")


class NotationRow(Strict):
    """How the handout writes symbols."""

    angle: sheet.AngleLetter = usually(sheet.AngleLetter.NAME, "Variables of revolute joints.")
    prismatic: sheet.SliderLetter = usually(sheet.SliderLetter.NAME, "Variables of prismatic joints.")
    functions: sheet.Functions = usually(sheet.Functions.SHORT, "c_12, or cos(q_1 + q_2) in full.")
    frames: sheet.FrameIndices = usually(sheet.FrameIndices.RIGHT, "A_1^0, or the frames on the left: ^0A_1.")
    inertia: sheet.InertiaLetter = usually(sheet.InertiaLetter.B, "Letter of the inertia matrix.")
    pose: sheet.PoseEntries = usually(sheet.PoseEntries.ENTRIES, "Rotation of a given pose: r_13, or a_x.")


class HandoutRow(Strict):
    """What the handout shows and how."""

    parts: list[Part] = usually(
        list(sheet.USUAL_PARTS),
        "Which parts; printed in their usual order.",
        json_schema_extra={"minItems": 1, "uniqueItems": True},
    )
    derivation: sheet.Derivation = usually(sheet.Derivation.RESULT, "Results only, or the steps to them.")
    language: Language = usually("en", "Language of the texts: en, it, pt, ...")
    notation: NotationRow = usually(NotationRow(), "How symbols are written.")
    pages: Pages = usually("20", "Most pages of the printed sheet; 0 for any number.")


class StyleRow(Strict, options=Style):
    """How books differ: what is grouped first in each kind of quantity. What is left out is as in the set `name`."""

    name: StyleName = usually(DEFAULT_STYLE, "The set of options from which the others are taken.")


class FigureRow(Strict):
    """Which configuration is drawn and computed in numbers."""

    q: list[Cell] | None = usually(None, "A number for every joint variable, in the units of the file as limits are.")
    values: dict[str, Cell] = usually(
        {}, "Numbers, in SI units and radians, for symbols without one; for drawing and example only."
    )


class InverseRow(Strict):
    """What inverse kinematics is asked for."""

    task: Annotated[Annotated[TaskName, Tag(_NAME)] | Annotated[list[TaskRow], Tag(_BLOCK)], _block_if(list)] = usually(
        "pose", "The whole pose, the position, or some rows of the pose."
    )
    given: list[Symbol] | None = usually(
        None, "Joint variables that are arguments; default: the joints that are too many."
    )


class EndRow(Strict):
    """An end of a tree."""

    after: RowName = Field(description="The row on which it is.")
    tool: Matrix4 | None = usually(None, "Constant transform from the row's frame to the end.")


class RootRow(Strict):
    """A root that moves, whose variables come first in q."""

    type: Literal["planar", "floating"] = Field(description="planar: x, y and an angle; floating: six variables.")
    q: list[Symbol] | None = usually(None, "Default: x, y, phi, or x, y, z, yaw, pitch, roll.")
    link: BodyRow | None = usually(None, "Its body, in its own frame.")


class LoopRow(Strict):
    """Where a loop closes."""

    join: tuple[RowName, RowName] = Field(description="Rows whose frames are joined, or base.")
    by: Literal["revolute", "prismatic", "spherical", "fixed", "distance"] = Field(
        description="revolute: origins and z axes coincide; prismatic: axes are parallel, one origin on the other's z "
        "axis; spherical: origins coincide; fixed: the frames coincide; distance: a rod of the given length joins the "
        "origins by two ball joints."
    )
    length: Cell | None = usually(None, "Length of the rod, with by: distance.")
    branch: Annotated[str, WithJsonSchema({"type": "string", "pattern": "^[+-]*$"})] = usually(
        "", "Which assembly: a sign for each +- of the solution; default: all +."
    )


class VariableRow(Strict):
    """A variable of coupled joints."""

    limits: tuple[Cell, Cell] | None = usually(None, "Lower and upper limit of the variable.")
    speed: Cell | None = usually(None, "Largest speed of the variable, either way.")
    torque: Cell | None = usually(None, "Largest torque [N m] or force [N], either way.")


class RobotFile(Strict):
    """An arm or a tree: its Denavit-Hartenberg table and, if given, frames around it and its dynamics."""

    name: str = Field(
        description="Name of the robot, and of its output folder.", json_schema_extra={"pattern": ROBOT_NAME_PATTERN}
    )
    title: str | None = usually(
        None, "Free text for people; default: the name.", json_schema_extra={"maxLength": FILE_LIMITS.title_length}
    )
    convention: Literal["standard", "modified"] = Field(
        description="standard: Rot z theta, Trans z d, Trans x a, Rot x alpha; modified (Craig): Rot x alpha, "
        "Trans x a, Rot z theta, Trans z d with alpha_{i-1}, a_{i-1}."
    )
    units: Units = usually(Units(), "Units of plain numbers; default rad and m.")
    joints: list[JointRow] = Field(
        description="One row per joint, and rows without motion.",
        json_schema_extra={"minItems": 1, "maxItems": 2 * FILE_LIMITS.joints},
    )
    base: Matrix4 | None = usually(None, "Constant transform before frame 0.")
    tool: Matrix4 | None = usually(None, "Constant transform after frame n, of an arm with one end.")
    ends: (
        dict[str, Annotated[Annotated[RowName, Tag(_NAME)] | Annotated[EndRow, Tag(_BLOCK)], _block_if(dict)]] | None
    ) = usually(None, "The ends of a tree: the row on which each is, or a block with its tool.")
    root: RootRow | None = usually(None, "How the root moves; default: it stands.")
    variables: dict[str, VariableRow] | None = usually(
        None, "Variables of coupled joints; default: those that the rows have for themselves."
    )
    loops: list[LoopRow] | None = usually(None, "Closed loops, which move the passive joints.")
    gravity: Vector3 | None = usually(
        None, "Acceleration of gravity in the world frame [m/s^2]; with links, default [0, 0, -g]."
    )
    links: list[LinkRow] | None = usually(None, "One row for each of joints: dynamics.")
    parameters: dict[str, Cell] = usually({}, "Numbers of symbols, in SI units and radians unless units say otherwise.")
    runtime: list[Symbol] = usually([], "Symbols that stay arguments though they have a number.")
    wrench: list[Literal["world", "end"]] = usually(
        [],
        "Axes of a wrench on the end effector that generated dynamics take.",
        json_schema_extra={"uniqueItems": True},
    )
    style: Annotated[Annotated[StyleName, Tag(_NAME)] | Annotated[StyleRow, Tag(_BLOCK)], _block_if(dict)] = usually(
        DEFAULT_STYLE, "How printed expressions are grouped: a name, or a block of options."
    )
    contraction: Literal["aligned", "opposed"] = usually(
        "aligned", "Which sums of joint angles are contracted: also those of opposed parallel axes?"
    )
    handout: HandoutRow = usually(HandoutRow(), "Parts, language and notation of the handout.")
    figure: FigureRow = usually(FigureRow(), "The configuration that is drawn and computed.")
    inverse: InverseRow = usually(InverseRow(), "Task and given joints of the inverse kinematics.")


def json_schema() -> dict[str, Any]:
    """JSON Schema of a robot file, for editors; a file with the robot in a block ``robot:`` is accepted too."""
    robot = structure.schema_of(RobotFile)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "derive robot file",
        "$defs": {**robot.pop("$defs", {}), "RobotFile": robot},
        "anyOf": [
            {"$ref": "#/$defs/RobotFile"},
            {
                "type": "object",
                "description": "A lecture corpus file: the robot in its own block, anything else beside it.",
                "required": ["robot"],
                "not": {"anyOf": [{"required": [key]} for key in ("joints", "convention", "links")]},
                "properties": {"robot": {"$ref": "#/$defs/RobotFile"}},
            },
        ],
    }


# What to write for a key that is missing.
_MISSING = {
    "convention": "write convention: standard (distal) or convention: modified (Craig); they give different robots",
    "type": "write type: revolute or type: prismatic",
    "root type": "write type: planar or type: floating",
    "after": "write after: and the name of the row on which the end is",
    "name": "write name: my-robot",
    "joints": "write one row per joint under joints:",
}


def check_structure(document: Document, model: type[Strict] = RobotFile) -> None:
    """Refuse unknown keys, missing keys and wrong shapes."""
    plain = _plain(document.root)
    if fits(model, plain):
        return
    from pydantic import ValidationError

    try:
        model_of(model).model_validate(plain)
    except ValidationError as error:
        refusals = []
        for violation in error.errors(include_url=False, include_input=False):
            refusal = _refusal(document, model_of(model), violation)
            place = refusal.location or Location("")
            refusals.append(((violation["type"] != "extra_forbidden", place.line, place.column), refusal))
        raise min(refusals, key=lambda pair: pair[0])[1] from None


def _plain(node: Node) -> Any:
    match node:
        case YamlScalar():
            return node.text
        case YamlSequence():
            return [_plain(item) for item in node.items]
        case YamlMapping():
            return {key: _plain(value) for key, (_, value) in node.entries.items()}


def _refusal(document: Document, model: type[BaseModel], violation: Any) -> RobotFileError:
    path: KeyPath = tuple(part for part in violation["loc"] if part not in FORMS)
    key, kind = str(path[-1]) if path else "", violation["type"]
    node = document.find(path)
    match kind:
        case "extra_forbidden":
            allowed = _fields(model, path[:-1])
            hint = key_hint(key, str(path[0]), allowed) if model is model_of(RobotFile) else ""
            found = f"{path_text(path[:-1], document.what)}: unknown key {quoted(key)}"
            remedy, location = hint or near_miss(key, allowed) or "remove it", document.key_location(path)
            return RobotFileError(found, allowed=f"allowed: {listed(allowed)}", remedy=remedy, location=location)
        case "missing" if not (path and isinstance(path[-1], int)):
            remedy = _MISSING.get(f"root {key}" if path[0] == "root" else key, "add it")
            return document.error(path[:-1], f"key '{key}' is missing", remedy=remedy)
        case "missing" | "too_long" | "too_short":
            where = path[:-1] if kind == "missing" else path
            expected = next((len(get_args(of)) for of in _types(model, where) if get_origin(of) is tuple), 0)
            count, block = document.length(where), document.find(where)
            remedy = _shape_hint(model, str(where[-1]), block) if where else ""
            remedy = remedy or "write zeros where nothing else is"
            found = f"{count} entr{'y' if count == 1 else 'ies'}"
            return document.error(where, found, f"allowed: exactly {expected}", remedy)
        case "literal_error" | "enum":
            text = node.text if isinstance(node, YamlScalar) else ""
            allowed = violation["ctx"]["expected"]
            choices = [word.strip(" '") for word in allowed.replace(" or ", ",").split(",")]
            found = f"found {quoted(text)}" if isinstance(node, YamlScalar) else _found(node)
            remedy = choice_hint(key, text, choices) or near_miss(text, choices)
            return document.error(path, found, f"allowed: {allowed}", remedy)
    remedy = "check the indentation and the dashes"
    if isinstance(node, YamlMapping):
        remedy = "check the indentation; texts with ': ' or '{' need quotation marks"
    hint = _shape_hint(model, "row" if isinstance(path[-1], int) else key, node)
    return document.error(path, _found(node), _expected(model, path, kind), hint or remedy)


def _shape_hint(model: type[BaseModel], key: str, node: Node | None) -> str:
    """What is meant by a value of the wrong shape in a robot file."""
    return shape_hint(key, _plain(node)) if node is not None and model is model_of(RobotFile) else ""


def _found(node: Node | None) -> str:
    match node:
        case YamlScalar(text="") | None:
            return "found nothing"
        case YamlScalar():
            return f"found the text {quoted(node.text)}"
        case YamlSequence():
            return "found a list"
        case YamlMapping():
            return "found a mapping"


def _expected(model: type[BaseModel], path: KeyPath, kind: str) -> str:
    texts = (("name",), ("title",), ("language",), ("after",))
    if path[-1:] in texts or (path[:1], path[-1:]) == (("joints",), ("q",)) or path[:-1] in (("ends",), ("root", "q")):
        return "allowed: a text"
    if path[:2] == ("handout", "parts") and kind == "string_type":
        return "allowed: names of parts"
    if path == ("handout", "pages"):
        return "allowed: a whole number"
    if kind == "string_type":
        return "allowed: one number, name or expression"
    if kind in ("list_type", "tuple_type"):
        return "allowed: a list"
    if kind == "union_tag_invalid":
        words = {str: "one number, name or expression", dict: "a mapping"}
        said = [
            f"a mapping with the keys {listed(of.model_fields)}"
            if _is_model(of)
            else words.get(get_origin(of) or of, "a list")
            for of in _types(model, path)
        ]
        return f"allowed: {' or '.join(dict.fromkeys(said))}"
    fields = _fields(model, path)
    return f"allowed: a mapping with the keys {listed(fields)}" if fields else "allowed: a mapping"


def _is_model(kind: Any) -> bool:
    return hasattr(kind, "model_fields")


def _fields(model: type[BaseModel], path: KeyPath) -> tuple[str, ...]:
    """Allowed keys of the mapping at a path; none where any key is allowed."""
    return tuple(key for kind in filter(_is_model, _types(model, path)) for key in kind.model_fields)


def _types(model: type[BaseModel], path: KeyPath) -> list[Any]:
    """What may stand at a path: models, and types of lists, mappings and texts."""
    found = _choices(model)
    for part in path:
        inner: list[Any] = []
        for kind in found:
            if _is_model(kind):
                inner += [kind.model_fields[str(part)].annotation] if str(part) in kind.model_fields else []
            elif get_origin(kind) is dict:
                inner.append(get_args(kind)[1])
            elif get_origin(kind) in (list, tuple):
                inner.append(get_args(kind)[0])
        found = [choice for kind in inner for choice in _choices(kind)]
    return found


def _choices(annotation: Any) -> list[Any]:
    """The alternatives of a type, bare."""
    if get_origin(annotation) is Annotated:
        return _choices(get_args(annotation)[0])
    if get_origin(annotation) in (Union, UnionType):
        return [choice for kind in get_args(annotation) for choice in _choices(kind)]
    return [] if annotation is type(None) else [annotation]
