"""The Newton-Euler recursion as equations: for any joint, or for one joint of the robot.

The vectors of link i are in frame i (Luh, Walker and Paul 1980; Fu, Gonzalez and Lee, Robotics, section 3.3; for the
modified convention Craig, Introduction to Robotics, section 6.5). In the standard convention joint i moves about z of
frame i-1 and p*_i = o_i - o_{i-1} is constant in frame i; in the modified one it moves about z of frame i, and p_i is
constant in frame i-1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from derive.handout.layout.lines import EQUALS, break_lines
from derive.handout.notation.pieces import RELATION_WIDTH, Box, Piece, binary, concatenate, italic, script
from derive.handout.notation.printer import MINUS
from derive.handout.notation.symbols import Symbols

TIMES = Box(" \\times ", RELATION_WIDTH)
OPEN, CLOSE = Box("(", 5.0), Box(")", 5.0)

Term = tuple[int, "Box | tuple[Piece, ...]"]
"""Sign and absolute value, which may be broken over lines where it is in pieces."""


@dataclass(frozen=True)
class Subject:
    """Whose equations they are.

    Attributes:
        index: Its index: ``i`` or a number.
        before: The index before.
        after: The index after.
        revolute: Whether the joint turns.
        sign: +1 or -1, how its variable counts.
        rate: Its velocity.
        acceleration: Its acceleration.
        torque: Its torque or force.
        last: Whether no link follows.
    """

    index: str
    before: str
    after: str
    revolute: bool
    sign: int
    rate: Box
    acceleration: Box
    torque: Box
    last: bool = False

    @classmethod
    def anyone(cls, revolute: bool) -> Subject:
        """Joint i."""
        rate, acceleration = (script(Box(f"{dots}{{q}}", 5.5), italic("i")) for dots in ("\\dot", "\\ddot"))
        return cls("i", "i-1", "i+1", revolute, 1, rate, acceleration, script(Box("\\tau", 5.0), italic("i")))


@dataclass(frozen=True)
class Recursion:
    """The equations in one convention.

    Attributes:
        standard: Whether the convention is the standard one.
        symbols: Names of matrices.
    """

    standard: bool
    symbols: Symbols

    # -- symbols

    def rotation(self, frame: str, reference: str) -> Box:
        """R, from the axes of one frame into those of another."""
        return self.symbols.frame("R", frame, reference)

    def offset(self, index: str) -> Box:
        """The vector between the origins."""
        return script(Box("\\mathbf{p}", 6.5), italic(index), Box("*", 5.0) if self.standard else Box("", 0.0))

    @staticmethod
    def com(index: str) -> Box:
        """From o_i to the centre of mass."""
        return vector("r", f"c_{{{index}}}")

    # -- equations

    def outward(self, s: Subject) -> Iterator[str]:
        """Motion of link i from that of link i-1, and what it takes."""
        motion = self._standard(s) if self.standard else self._modified(s)
        for left, terms in (*motion, *_resultants(s, self.com(s.index))):
            yield from _equation(left, terms)

    def inward(self, s: Subject) -> Iterator[str]:
        """Force and moment on link i, and the torque of its joint."""
        for left, terms in self._wrench(s):
            yield from _equation(left, terms)

    def _standard(self, s: Subject) -> Iterator[tuple[Box, list[Term]]]:
        w, wd, a = _motion(s.index)
        w0, wd0, a0 = _motion(s.before)
        turn, z, p = self.rotation(s.before, s.index), vector("z", "0"), self.offset(s.index)
        rate, growth = concatenate(s.rate, z), concatenate(s.acceleration, z)
        swing = concatenate(s.rate, w0, TIMES, z)
        if s.revolute:
            yield w, [(1, _turned(turn, [(1, w0), (s.sign, rate)]))]
            yield wd, [(1, _turned(turn, [(1, wd0), (s.sign, growth), (s.sign, swing)]))]
            start: tuple[Piece, ...] = (Piece(concatenate(turn, a0)),)
        else:
            yield w, [(1, concatenate(turn, w0))]
            yield wd, [(1, concatenate(turn, wd0))]
            start = _turned(turn, [(1, a0), (s.sign, growth), (s.sign, concatenate(italic("2"), swing))])
        yield a, [(1, start), *_swept(w, wd, p)]

    def _modified(self, s: Subject) -> Iterator[tuple[Box, list[Term]]]:
        w, wd, a = _motion(s.index)
        w0, wd0, a0 = _motion(s.before)
        turn, z, p = self.rotation(s.before, s.index), vector("z", "0"), self.offset(s.index)
        rate, growth = (s.sign, concatenate(s.rate, z)), (s.sign, concatenate(s.acceleration, z))
        carried = (1, _turned(turn, [(1, a0), *_swept(w0, wd0, p)]))
        if s.revolute:
            yield w, [(1, concatenate(turn, w0)), rate]
            yield wd, [(1, concatenate(turn, wd0)), growth, (s.sign, concatenate(s.rate, w, TIMES, z))]
            yield a, [carried]
        else:
            yield w, [(1, concatenate(turn, w0))]
            yield wd, [(1, concatenate(turn, wd0))]
            yield a, [carried, growth, (s.sign, concatenate(italic("2"), s.rate, w, TIMES, z))]

    def _wrench(self, s: Subject) -> Iterator[tuple[Box, list[Term]]]:
        back, force, moment = self.rotation(s.after, s.index), vector("f", s.index), vector("n", s.index)
        pushed = concatenate(back, vector("f", s.after))
        p, r = self.offset(s.index if self.standard else s.after), self.com(s.index)
        arm = concatenate(OPEN, p, Box(" + ", 12.3), r, CLOSE) if self.standard else r
        resultant, spin = vector("F", s.index), vector("N", s.index)
        own: list[Term] = [(1, concatenate(arm, TIMES, resultant)), (1, spin)]
        after: list[Term] = [
            (1, concatenate(back, vector("n", s.after))),
            (1, concatenate(p, TIMES, OPEN, pushed, CLOSE)),
        ]
        yield force, [(1, resultant)] if s.last else [(1, pushed), (1, resultant)]
        yield moment, own if s.last else [*after, *own]
        axis = concatenate(self.rotation(s.before, s.index), vector("z", "0")) if self.standard else vector("z", "0")
        received = moment if s.revolute else force
        yield s.torque, [(s.sign, concatenate(Box(f"{received.tex}^{{T}}", received.width + 5.0), axis))]


def vector(letter: str, index: str) -> Box:
    """A vector."""
    return script(Box(f"\\mathbf{{{letter}}}", 9.0), italic(index))


def _motion(index: str) -> tuple[Box, Box, Box]:
    """Angular velocity and acceleration of link i, acceleration of its origin."""
    omega = Box("\\boldsymbol{\\omega}", 8.0)
    rate = Box(f"\\dot{{{omega.tex}}}", 8.0)
    return script(omega, italic(index)), script(rate, italic(index)), vector("a", index)


def _resultants(s: Subject, com: Box) -> Iterator[tuple[Box, list[Term]]]:
    w, wd, a = _motion(s.index)
    acceleration, inertia = vector("a", f"c_{{{s.index}}}"), vector("I", s.index)
    yield acceleration, [(1, a), *_swept(w, wd, com)]
    yield vector("F", s.index), [(1, concatenate(script(italic("m"), italic(s.index)), acceleration))]
    spin = concatenate(w, TIMES, OPEN, inertia, w, CLOSE)
    yield vector("N", s.index), [(1, concatenate(inertia, wd)), (1, spin)]


def _swept(w: Box, wd: Box, r: Box) -> list[Term]:
    """The acceleration of a point at r due to rotation."""
    return [(1, concatenate(wd, TIMES, r)), (1, concatenate(w, TIMES, OPEN, w, TIMES, r, CLOSE))]


def _turned(turn: Box, terms: list[Term]) -> tuple[Piece, ...]:
    return (Piece(concatenate(turn, OPEN)), *_pieces(terms, depth=1), Piece(CLOSE))


def _pieces(terms: Iterable[Term], depth: int = 0) -> Iterator[Piece]:
    for index, (sign, value) in enumerate(terms):
        if index:
            yield binary("+" if sign > 0 else "-", depth)
        elif sign < 0:
            yield MINUS
        yield from (Piece(value),) if isinstance(value, Box) else value


def _equation(left: Box, terms: list[Term]) -> list[str]:
    return break_lines(concatenate(left, EQUALS), tuple(_pieces(terms)))
