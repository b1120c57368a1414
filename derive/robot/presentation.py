"""The blocks ``handout:`` and ``figure:`` of a robot file: what is shown, and which configuration is drawn."""

from __future__ import annotations

import re
from collections.abc import Callable
from enum import StrEnum
from typing import TypeVar

from derive.errors import listed, near_miss, quoted
from derive.robot.cells import Cells, check_symbol
from derive.robot.description import Joint
from derive.robot.document import Document, KeyPath, YamlMapping
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, names
from derive.robot.handout import (
    PARTS,
    AngleLetter,
    FigureOptions,
    FrameIndices,
    Functions,
    HandoutOptions,
    InertiaLetter,
    NotationOptions,
    SliderLetter,
)

LANGUAGE = re.compile(r"[a-z]{2}(_[A-Z]{2})?")
"""How a language is written: ``it`` or ``pt_BR``. Which ones have a catalogue is known where texts are translated."""

_Q: KeyPath = ("figure", "q")
_NUMBERS = "allowed: numbers and constant expressions such as pi/6"

Choice = TypeVar("Choice", bound=StrEnum)


def read_handout(document: Document) -> HandoutOptions:
    """What the handout shows and how; a key that is left out has its default.

    Raises:
        RobotFileError: An unknown part, a part twice, or a language that is none.
    """
    default = HandoutOptions()
    return HandoutOptions(
        parts=_parts(document),
        derivation=_choice(document, ("handout", "derivation"), default.derivation),
        language=_language(document, default.language),
        notation=_notation(document),
    )


def _notation(document: Document) -> NotationOptions:
    block: KeyPath = ("handout", "notation")
    return NotationOptions(
        angle=_choice(document, (*block, "angle"), AngleLetter.NAME),
        prismatic=_choice(document, (*block, "prismatic"), SliderLetter.NAME),
        functions=_choice(document, (*block, "functions"), Functions.SHORT),
        frames=_choice(document, (*block, "frames"), FrameIndices.RIGHT),
        inertia=_choice(document, (*block, "inertia"), InertiaLetter.B),
    )


def _choice(document: Document, path: KeyPath, default: Choice) -> Choice:
    scalar = document.scalar(path)
    return type(default)(scalar.text) if scalar else default


def _language(document: Document, default: str) -> str:
    path: KeyPath = ("handout", "language")
    scalar = document.scalar(path)
    if scalar is None:
        return default
    if LANGUAGE.fullmatch(scalar.text) is None:
        raise document.error(
            path,
            f"{quoted(scalar.text)} is not a language code",
            "allowed: two lower-case letters, with a country if need be",
            "write for instance en, it, pt or pt_BR",
        )
    return scalar.text


def _parts(document: Document) -> tuple[str, ...]:
    """The chosen parts in the order in which they are printed."""
    path: KeyPath = ("handout", "parts")
    if document.find(path) is None:
        return PARTS
    scalars = [document.scalar((*path, index)) for index in range(document.length(path))]
    chosen = [scalar.text for scalar in scalars if scalar]
    if not chosen:
        raise document.error(path, "no parts", f"allowed: {listed(PARTS)}", "leave parts out to have all")
    for index, name in enumerate(chosen):
        if name not in PARTS:
            raise document.error(
                (*path, index), f"unknown part {quoted(name)}", f"allowed: {listed(PARTS)}", near_miss(name, PARTS)
            )
        if name in chosen[:index]:
            raise document.error((*path, index), f"'{name}' twice", remedy="remove one")
    return tuple(part for part in PARTS if part in chosen)


def read_figure(
    document: Document,
    cells: Cells,
    joints: tuple[Joint, ...],
    parameters: tuple[tuple[str, Expression], ...],
) -> FigureOptions:
    """The configuration that is drawn; it uses no symbol, so a parameter is not used by being drawn.

    Args:
        document: The file.
        cells: Its cells, every other block having been read.
        joints: Rows of the table.
        parameters: Symbols with a number.

    Raises:
        RobotFileError: Not one number per joint, or a value for what is no symbol or has a number.
        ExpressionError: A cell is outside the grammar.
    """
    own = Cells(document, cells.units)
    symbols = cells.first_use.keys() - {joint.variable for joint in joints}
    numbered = {name for name, _ in parameters}
    return FigureOptions(_configuration(document, own, joints), _values(document, own, joints, symbols, numbered))


def _configuration(document: Document, cells: Cells, joints: tuple[Joint, ...]) -> tuple[Expression, ...] | None:
    if document.find(_Q) is None:
        return None
    count = document.length(_Q)
    if count != len(joints):
        entries = "1 entry" if count == 1 else f"{count} entries"
        raise document.error(
            _Q, entries, f"allowed: exactly {len(joints)}", "write one number per joint, in the order of the table"
        )
    return tuple(
        _number(document, (*_Q, row), cells.angle if joint.is_revolute else cells.length)
        for row, joint in enumerate(joints)
    )


def _values(
    document: Document, cells: Cells, joints: tuple[Joint, ...], symbols: set[str], numbered: set[str]
) -> tuple[tuple[str, Expression], ...]:
    node = document.find(("figure", "values"))
    if not isinstance(node, YamlMapping):
        return ()
    for name in node.entries:
        _check_open(document, name, joints, symbols, numbered)
    return tuple((name, _number(document, ("figure", "values", name), cells.plain)) for name in node.entries)


def _check_open(
    document: Document, name: str, joints: tuple[Joint, ...], symbols: set[str], numbered: set[str]
) -> None:
    """Refuse what needs no value for the figure: joint variables, symbols with a number, names that nothing uses."""
    path: KeyPath = ("figure", "values", name)
    allowed = "allowed: symbols of the robot without a number"
    check_symbol(document, path, name)
    if any(name == joint.variable for joint in joints):
        raise document.error(path, "a joint variable", allowed, "write the configuration: figure: {q: [...]}")
    if name in numbered:
        raise document.error(path, "a parameter, which has a number already", allowed, "remove it")
    if name not in symbols:
        raise document.error(path, "no cell uses this symbol", allowed, near_miss(name, symbols - numbered))


def _number(document: Document, path: KeyPath, read: Callable[[KeyPath], Expression]) -> Expression:
    value = read(path)
    if others := list(names(value)):
        raise document.error(path, f"name '{others[0]}' in a number", _NUMBERS, "write its number")
    try:
        evaluate(value, {})
    except ArithmeticError as error:
        raise document.error(path, str(error), "allowed: expressions with a finite real value") from None
    return value
