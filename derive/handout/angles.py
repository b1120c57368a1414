"""Orientation angles by the entries of T, and where they are singular.

Roll, pitch, yaw: R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll); Euler ZYZ: R = Rot(z, phi) Rot(y, theta) Rot(z, psi)
(Siciliano, Sciavicco, Villani, Oriolo, Robotics, section 2.4).
"""

from __future__ import annotations

from dataclasses import dataclass

from derive.handout.context import Context
from derive.handout.notation.pieces import (
    BINARY_WIDTH,
    BRACKET_WIDTH,
    MINUS_WIDTH,
    Box,
    Break,
    Piece,
    concatenate,
    fraction,
    greek,
    italic,
    operator,
    script,
    upright,
)

Place = tuple[int, int]
Pieces = tuple[Piece, ...]

_COMMA = Piece(Box(",\\, ", 5.0), depth=1)


@dataclass(frozen=True, slots=True)
class Angles:
    """Three angles that take the world to the end effector.

    Attributes:
        quantity: Name of their closed form.
        names: The angles, in its order.
        by_entries: Each angle by entries of T.
        terms: Number of terms of these entries.
        vanishing: Two entries of T that are both zero where the angles are singular.
        sine: The entry of T that is plus or minus one there.
        is_always_singular: Whether that is so in every configuration.
        is_never_singular: Whether it is in none, because that entry is zero.
    """

    quantity: str
    names: tuple[Box, Box, Box]
    by_entries: tuple[Pieces, Pieces, Pieces]
    terms: int
    vanishing: tuple[Box, Box]
    sine: Box
    is_always_singular: bool
    is_never_singular: bool


def roll_pitch_yaw(context: Context) -> Angles:
    """Roll, pitch and yaw."""
    _ = context.text
    names = _word(_("roll")), _word(_("pitch")), _word(_("yaw"))
    always = _vanish(context, (1, 1), (2, 1))
    if always:
        right_angle = _plain(_minus(concatenate(fraction(greek("pi"), italic("2")), _entry(context, 3, 1))))
        angles = _plain(italic("0")), right_angle, _atan2(_minus(_entry(context, 1, 2)), _entry(context, 2, 2))
        used = [(3, 1), (1, 2), (2, 2)]
    else:
        angles = (
            _atan2(_entry(context, 3, 2), _entry(context, 3, 3)),
            _atan2(_minus(_entry(context, 3, 1)), _root(_entry(context, 3, 2), _entry(context, 3, 3))),
            _atan2(_entry(context, 2, 1), _entry(context, 1, 1)),
        )
        used = [(3, 2), (3, 3), (3, 1), (2, 1), (1, 1)]
    never = _vanish(context, (3, 1))
    vanishing = _entry(context, 1, 1), _entry(context, 2, 1)
    return Angles("rpy", names, angles, _terms(context, used), vanishing, _entry(context, 3, 1), always, never)


def euler_zyz(context: Context) -> Angles:
    """Euler angles ZYZ."""
    names = _letter(context, "varphi"), _letter(context, "vartheta"), _letter(context, "psi")
    always = _vanish(context, (1, 3), (2, 3))
    cosine = _entry(context, 3, 3)
    if always:
        signed = [concatenate(cosine, _entry(context, i, 1)) for i in (2, 1)]
        inside = concatenate(Box("(1", 10.0), Box(" - ", BINARY_WIDTH), cosine, Box(")", BRACKET_WIDTH))
        half_turn = _plain(concatenate(fraction(greek("pi"), italic("2")), inside))
        angles = _atan2(*signed), half_turn, _plain(italic("0"))
        used = [(3, 3), (2, 1), (1, 1)]
    else:
        angles = (
            _atan2(_entry(context, 2, 3), _entry(context, 1, 3)),
            _atan2(_root(_entry(context, 1, 3), _entry(context, 2, 3)), cosine),
            _atan2(_entry(context, 3, 2), _minus(_entry(context, 3, 1))),
        )
        used = [(2, 3), (1, 3), (3, 3), (3, 2), (3, 1)]
    vanishing = _entry(context, 1, 3), _entry(context, 2, 3)
    never = _vanish(context, (3, 3))
    return Angles("euler_zyz", names, angles, _terms(context, used), vanishing, cosine, always, never)


def _entry(context: Context, row: int, column: int) -> Box:
    return context.symbols.entry("t", row, column)


def _vanish(context: Context, *places: Place) -> bool:
    """Whether these entries of T are zero in every configuration."""
    return not _terms(context, places)


def _terms(context: Context, places: tuple[Place, ...] | list[Place]) -> int:
    return sum(context.quantities["T"].terms(*place) for place in places)


def _word(text: str) -> Box:
    return Box(f"\\text{{{text}}}", upright(text).width)


def _letter(context: Context, name: str) -> Box:
    """A Greek letter, with an index where the robot has a symbol of that name."""
    letter = greek(name)
    taken = {tex.strip() for tex in context.notation.taken}
    return script(letter, upright("e")) if letter.tex.strip() in taken else letter


def _plain(box: Box) -> Pieces:
    return (Piece(box),)


def _minus(box: Box) -> Box:
    return concatenate(Box("-", MINUS_WIDTH), box)


def _root(first: Box, second: Box) -> Box:
    """Square root of a sum of two squares."""
    squares = [script(box, sup=italic("2")) for box in (first, second)]
    inner = concatenate(squares[0], Box(" + ", BINARY_WIDTH), squares[1])
    return Box(f"\\sqrt{{{inner.tex}}}", inner.width + 10.0)


def _atan2(sine: Box, cosine: Box) -> Pieces:
    opening, closing = Piece(Box("(", BRACKET_WIDTH)), Piece(Box(")", BRACKET_WIDTH))
    second = Piece(cosine, Break.COMMA, depth=1)
    return Piece(operator("atan2")), opening, Piece(sine, depth=1), _COMMA, second, closing
