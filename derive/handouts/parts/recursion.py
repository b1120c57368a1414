"""The Newton-Euler recursion as equations: for any joint, or for one joint of the robot.

The vectors of link i are in frame i (Luh, Walker and Paul 1980; Fu, Gonzalez and Lee, Robotics, section 3.3; for the
modified convention Craig, Introduction to Robotics, section 6.5). In the standard convention joint i moves about z of
frame i-1 and p*_i = o_i - o_{i-1} is constant in frame i; in the modified one it moves about z of frame i, and p_i is
constant in frame i-1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from derive.handouts.layout.lines import EQUALS, break_lines
from derive.handouts.notation.pieces import (
    BRACKET_WIDTH,
    EMPTY,
    RELATION_WIDTH,
    Box,
    TexPiece,
    binary,
    concatenate,
    italic,
    script,
)
from derive.handouts.notation.printer import MINUS
from derive.handouts.notation.symbols import Symbols

_TIMES = Box(" \\times ", RELATION_WIDTH)
_OPEN, _CLOSE = Box("(", BRACKET_WIDTH), Box(")", BRACKET_WIDTH)
_TWICE = italic("2")
_OMEGA = Box("\\boldsymbol{\\omega}", 8.0)

# Sign and absolute value, which may be broken over lines where it is in pieces.
Term = tuple[int, "Box | tuple[TexPiece, ...]"]
Sides = tuple[Box, list[Term]]  # left side of an equation, and the terms of the right one


@dataclass(frozen=True)
class JointLetters:
    """How the recursion calls a joint and the links on both sides of it."""

    index: str  # its index: ``i`` or a number
    before: str  # the index before
    after: str  # the index after
    is_revolute: bool  # whether the joint turns
    sign: int  # +1 or -1, how its variable counts
    rate: Box  # its velocity
    acceleration: Box  # its acceleration
    torque: Box  # its torque or force
    is_last: bool = False  # whether no link follows

    @classmethod
    def any_joint(cls, is_revolute: bool) -> JointLetters:
        """Joint i."""
        rate, acceleration = (script(Box(f"{dots}{{q}}", 5.5), italic("i")) for dots in ("\\dot", "\\ddot"))
        return cls("i", "i-1", "i+1", is_revolute, 1, rate, acceleration, script(Box("\\tau", 5.0), italic("i")))


@dataclass(frozen=True)
class Recursion:
    """The equations in one convention."""

    is_standard: bool  # whether the convention is the standard one
    symbols: Symbols  # names of matrices

    def offset(self, index: str) -> Box:
        """The vector p from o_{i-1} to o_i, with a star in the standard convention."""
        return script(Box("\\mathbf{p}", 6.5), italic(index), Box("*", 5.0) if self.is_standard else EMPTY)

    def outward(self, joint: JointLetters) -> list[str]:
        """Motion of link i from that of link i-1, and the force and moment that this motion takes."""
        i = joint.index
        w, wd, a = _motion(i)
        center, inertia = vector("a", f"c_{{{i}}}"), vector("I", i)
        gyroscopic = concatenate(w, _TIMES, _OPEN, inertia, w, _CLOSE)
        return _lines(
            [
                *(self._standard_motion(joint) if self.is_standard else self._modified_motion(joint)),
                (center, [(1, a), *_rotational(w, wd, com(i))]),
                (vector("F", i), [(1, concatenate(script(italic("m"), italic(i)), center))]),
                (vector("N", i), [(1, concatenate(inertia, wd)), (1, gyroscopic)]),
            ]
        )

    def inward(self, joint: JointLetters) -> list[str]:
        """Force and moment that link i receives through its joint, and the torque of the joint."""
        i = joint.index
        back = self.symbols.frame("R", joint.after, i)
        force, moment = vector("f", i), vector("n", i)
        resultant, resultant_moment = vector("F", i), vector("N", i)
        p, r = self.offset(i if self.is_standard else joint.after), com(i)
        arm = concatenate(_OPEN, p, Box(" + ", 12.3), r, _CLOSE) if self.is_standard else r
        z = vector("z", "0")
        axis = concatenate(self.symbols.frame("R", joint.before, i), z) if self.is_standard else z
        forces: list[Term] = [(1, resultant)]
        moments: list[Term] = [(1, concatenate(arm, _TIMES, resultant)), (1, resultant_moment)]
        if not joint.is_last:
            carried = concatenate(back, vector("f", joint.after))
            forces = [(1, carried), *forces]
            moments = [
                (1, concatenate(back, vector("n", joint.after))),
                (1, concatenate(p, _TIMES, _OPEN, carried, _CLOSE)),
                *moments,
            ]
        received = moment if joint.is_revolute else force
        torque = concatenate(Box(f"{received.tex}^{{T}}", received.width + 5.0), axis)
        return _lines([(force, forces), (moment, moments), (joint.torque, [(joint.sign, torque)])])

    def _standard_motion(self, joint: JointLetters) -> Iterator[Sides]:
        w, wd, a = _motion(joint.index)
        w0, wd0, a0 = _motion(joint.before)
        turn, z, p = self.symbols.frame("R", joint.before, joint.index), vector("z", "0"), self.offset(joint.index)
        rate, acceleration = concatenate(joint.rate, z), concatenate(joint.acceleration, z)
        coriolis = concatenate(joint.rate, w0, _TIMES, z)
        if joint.is_revolute:
            yield w, [(1, _turned(turn, [(1, w0), (joint.sign, rate)]))]
            yield wd, [(1, _turned(turn, [(1, wd0), (joint.sign, acceleration), (joint.sign, coriolis)]))]
            start: tuple[TexPiece, ...] = (TexPiece(concatenate(turn, a0)),)
        else:
            yield w, [(1, concatenate(turn, w0))]
            yield wd, [(1, concatenate(turn, wd0))]
            twice = concatenate(_TWICE, coriolis)
            start = _turned(turn, [(1, a0), (joint.sign, acceleration), (joint.sign, twice)])
        yield a, [(1, start), *_rotational(w, wd, p)]

    def _modified_motion(self, joint: JointLetters) -> Iterator[Sides]:
        w, wd, a = _motion(joint.index)
        w0, wd0, a0 = _motion(joint.before)
        turn, z, p = self.symbols.frame("R", joint.before, joint.index), vector("z", "0"), self.offset(joint.index)
        rate, acceleration = (joint.sign, concatenate(joint.rate, z)), (joint.sign, concatenate(joint.acceleration, z))
        coriolis = concatenate(joint.rate, w, _TIMES, z)
        carried = (1, _turned(turn, [(1, a0), *_rotational(w0, wd0, p)]))
        if joint.is_revolute:
            yield w, [(1, concatenate(turn, w0)), rate]
            yield wd, [(1, concatenate(turn, wd0)), acceleration, (joint.sign, coriolis)]
            yield a, [carried]
        else:
            yield w, [(1, concatenate(turn, w0))]
            yield wd, [(1, concatenate(turn, wd0))]
            yield a, [carried, acceleration, (joint.sign, concatenate(_TWICE, coriolis))]


def vector(letter: str, index: str) -> Box:
    """A vector or tensor of a link."""
    return script(Box(f"\\mathbf{{{letter}}}", 9.0), italic(index))


def com(index: str) -> Box:
    """The vector r from o_i to the centre of mass of link i."""
    return vector("r", f"c_{{{index}}}")


def _motion(index: str) -> tuple[Box, Box, Box]:
    """Angular velocity and acceleration of link i, acceleration of its origin."""
    acceleration = Box(f"\\dot{{{_OMEGA.tex}}}", _OMEGA.width)
    return script(_OMEGA, italic(index)), script(acceleration, italic(index)), vector("a", index)


def _rotational(w: Box, wd: Box, r: Box) -> list[Term]:
    """The acceleration of a point at r due to rotation."""
    return [(1, concatenate(wd, _TIMES, r)), (1, concatenate(w, _TIMES, _OPEN, w, _TIMES, r, _CLOSE))]


def _turned(turn: Box, terms: list[Term]) -> tuple[TexPiece, ...]:
    return (TexPiece(concatenate(turn, _OPEN)), *_pieces(terms, depth=1), TexPiece(_CLOSE))


def _pieces(terms: Iterable[Term], depth: int = 0) -> Iterator[TexPiece]:
    for index, (sign, value) in enumerate(terms):
        if index:
            yield binary("+" if sign > 0 else "-", depth)
        elif sign < 0:
            yield MINUS
        yield from (TexPiece(value),) if isinstance(value, Box) else value


def _lines(equations: Iterable[Sides]) -> list[str]:
    broken = (break_lines(concatenate(left, EQUALS), tuple(_pieces(terms))) for left, terms in equations)
    return [line for lines in broken for line in lines]
