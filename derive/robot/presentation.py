"""What is wanted of a robot: style, handout, figure and inverse kinematics, by blocks of its file or by a caller."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, replace
from typing import TypeVar

from derive.errors import QuantityError, listed, near_miss, quoted
from derive.robot.cells import Cells, check_symbol, joint_values
from derive.robot.description import Description, Joint, Variable
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression
from derive.robot.options import handout
from derive.robot.options.handout import FigureOptions, HandoutOptions, NotationOptions
from derive.robot.options.inverse import POSE, InverseOptions, chosen_given, chosen_task
from derive.robot.options.style import DEFAULT_STYLE, Choice, Style, choice_named
from derive.robot.reading.document import Document, KeyPath, YamlMapping

# How a language is written: ``it`` or ``pt_BR``. Which ones have a catalogue is known where texts are translated.
LANGUAGE = re.compile(r"[a-z]{2}(_[A-Z]{2})?")

Some = TypeVar("Some", bound=Description)


def with_options(
    robot: Some,
    parts: Iterable[str] | None = None,
    language: str | None = None,
    derivation: str | None = None,
    notation: Mapping[str, str] | None = None,
    q: Sequence[float | str] | None = None,
    style: Style | str | Mapping[str, str] | None = None,
) -> Some:
    """A robot with other options of its handout, figure and style; None leaves those of the file."""
    options, figure = robot.handout, robot.figure
    if parts is not None:
        options = replace(options, parts=handout.chosen_parts(parts))
    if language is not None:
        options = replace(options, language=language)
    if derivation is not None:
        options = replace(options, derivation=choice_named(handout.Derivation, derivation))
    if notation is not None:
        options = replace(options, notation=handout.chosen_notation(notation, options.notation))
    if q is not None:
        figure = replace(figure, q=joint_values(robot, q))
    return replace(robot, handout=options, figure=figure, style=robot.style if style is None else Style.of(style))


def read_style(document: Document) -> Style:
    """How expressions are grouped: a name, or a block of options with or without one."""
    block, beside = document.find(("style",)), document.text("contraction")
    options = {"name": document.text("style") or DEFAULT_STYLE}
    if isinstance(block, YamlMapping):
        options = {key: document.text("style", key) for key in block.entries}
    if beside and "contraction" in options:
        path: KeyPath = ("style", "contraction")
        raise document.error(path, "given twice", "allowed: once, here or beside the style", "remove one")
    return Style.of({**options, "contraction": beside} if beside else options)


def read_handout(document: Document) -> HandoutOptions:
    """What the handout shows and how; a key that is left out has its default."""

    def _chosen(path: KeyPath, default: Choice) -> Choice:
        """The choice that the file makes among those of the default's kind."""
        scalar = document.scalar(path)
        return type(default)(scalar.text) if scalar else default

    default = HandoutOptions()
    parts = _parts(document)
    derivation = _chosen(("handout", "derivation"), default.derivation)
    path: KeyPath = ("handout", "language")
    language = document.scalar(path)
    if language is not None and LANGUAGE.fullmatch(language.text) is None:
        found = f"{quoted(language.text)} is not a language code"
        allowed = "allowed: two lower-case letters, with a country if need be"
        raise document.error(path, found, allowed, "write for instance en, it, pt or pt_BR")
    usual = {option.name: getattr(default.notation, option.name) for option in fields(NotationOptions)}
    letters = {name: _chosen(("handout", "notation", name), choice) for name, choice in usual.items()}
    path, pages = ("handout", "pages"), default.pages
    if (limit := document.scalar(path)) is not None:
        try:
            pages = handout.chosen_pages(limit.text)
        except QuantityError as error:
            raise document.error(path, error.found, error.allowed) from None
    code = language.text if language else default.language
    return HandoutOptions(parts, derivation, code, NotationOptions(**letters), pages)


def _parts(document: Document) -> tuple[str, ...]:
    """The chosen parts in the order in which they are printed."""
    path: KeyPath = ("handout", "parts")
    if document.find(path) is None:
        return handout.USUAL_PARTS
    chosen = [document.text(*path, index) for index in range(document.length(path))]
    allowed = f"allowed: {listed(handout.PARTS)}"
    if not chosen:
        raise document.error(path, "no parts", allowed, "leave parts out to have the usual ones")
    for index, name in enumerate(chosen):
        if name not in handout.PARTS:
            remedy = near_miss(name, handout.PARTS)
            raise document.error((*path, index), f"unknown part {quoted(name)}", allowed, remedy)
        if name in chosen[:index]:
            raise document.error((*path, index), f"'{name}' twice", remedy="remove one")
    return tuple(part for part in handout.PARTS if part in chosen)


def read_figure(
    document: Document, cells: Cells, joints: Sequence[Joint | Variable], parameters: tuple[tuple[str, Expression], ...]
) -> FigureOptions:
    """The configuration that is drawn; it uses no symbol, so a parameter is not used by being drawn."""
    own = Cells(document, cells.units)
    variables, numbered = {joint.variable for joint in joints}, {name for name, _ in parameters}
    q, where = None, ("figure", "q")
    if document.find(where) is not None:
        count = document.length(where)
        if count != len(joints):
            found, allowed = "1 entry" if count == 1 else f"{count} entries", f"allowed: exactly {len(joints)}"
            order = "in the order of the table" if document.find(("root",)) is None else "those of the root first"
            raise document.error(where, found, allowed, f"write one number per joint, {order}")
        reads = (own.angle if joint.is_revolute else own.length for joint in joints)
        q = tuple(_number(own, (*where, row), read) for row, read in enumerate(reads))
    block = document.find(("figure", "values"))
    values = list(block.entries) if isinstance(block, YamlMapping) else []
    for name in values:
        path: KeyPath = ("figure", "values", name)
        allowed = "allowed: symbols of the robot without a number"
        check_symbol(document, path, name)
        if name in variables:
            raise document.error(path, "a joint variable", allowed, "write the configuration: figure: {q: [...]}")
        if name in numbered:
            raise document.error(path, "a parameter, which has a number already", allowed, "remove it")
        if name not in cells.first_use:
            known = cells.first_use.keys() - variables - numbered
            raise document.error(path, "no cell uses this symbol", allowed, near_miss(name, known))
    return FigureOptions(q, tuple((name, _number(own, ("figure", "values", name), own.plain)) for name in values))


def read_inverse(document: Document, joints: Sequence[Joint | Variable]) -> InverseOptions:
    """What inverse kinematics is asked for."""

    def _chosen(path: KeyPath, choose: Callable[[list[str]], tuple[str, ...]]) -> tuple[str, ...] | None:
        if document.find(path) is None:
            return None
        words = [document.text(*path, index) for index in range(document.length(path))]
        try:
            return choose(words or [word for word in [document.text(*path)] if word])
        except QuantityError as error:
            raise document.error(path, error.found, error.allowed, error.remedy) from None

    variables = [joint.variable for joint in joints]
    task = _chosen(("inverse", "task"), lambda words: chosen_task(words, len(joints)))
    given = _chosen(("inverse", "given"), lambda words: chosen_given(words, variables))
    key = "inverse" if task is None and given is None else "given" if given is not None else "task"
    return InverseOptions(task or POSE, given, None if key == "inverse" else document.location(("inverse", key)))


def _number(cells: Cells, path: KeyPath, read: Callable[[KeyPath], Expression]) -> Expression:
    """A cell without names whose value exists."""
    value = cells.constant(path, read(path), "a number", "allowed: numbers and constant expressions such as pi/6")
    try:
        evaluate(value, {})
    except ArithmeticError as error:
        raise cells.document.error(path, str(error), "allowed: expressions with a finite real value") from None
    return value
