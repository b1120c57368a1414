"""Axes and origins of the joints, from which the columns of the Jacobian are made.

Column i is (z x (p - o), z) for a revolute joint and (z, 0) for a prismatic one, times the sign of its variable, with
z and o of frame i-1 in the standard convention and of frame i in the modified one (Siciliano, Sciavicco, Villani,
Oriolo, Robotics, section 3.1).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from derive.emit.handout.context import Context
from derive.emit.handout.kinematics import Whole, axes_group, whole
from derive.emit.handout.submatrix import column, total_terms
from derive.emit.latex.layout import EQUALS, fits, matrix
from derive.emit.latex.metrics import BINARY_WIDTH, BRACKET_WIDTH, MINUS_WIDTH, Box, concatenate, italic, script
from derive.emit.latex.quantity import Block, Namer
from derive.emit.latex.symbols import bold
from derive.emit.quantity import Quantity
from derive.robot.robot import Convention

_UPPER = (1, 2, 3)
_ALL = (1, 2, 3, 4, 5, 6)
_ZERO = Box("\\mathbf{0}", 6.0)
_CROSS = Box(" \\times ", BINARY_WIDTH)


@dataclass(frozen=True, slots=True)
class Vector:
    """A vector of a step.

    Attributes:
        box: ``symbol = ...`` without its entries, where these are too long.
        whole: The vector with its entries; None where these are too wide.
        entries: Its entries one by one, in that case; None where these are too long, or stand elsewhere.
    """

    box: Box
    whole: Whole | None = None
    entries: Block | None = None


@dataclass(frozen=True)
class JointAxes:
    """The axes of one robot.

    Attributes:
        context: The handout.
    """

    context: Context

    def general(self, *, revolute: bool) -> Box:
        """The column of joint i in general."""
        index = "i-1" if self._standard else "i"
        symbol = script(bold("J"), italic("i"))
        return concatenate(symbol, EQUALS, _column(index, revolute=revolute, negative=False))

    def summary(self) -> Box | None:
        """J by the axes and origins of this robot; None if that is too wide."""
        upper, lower = zip(*(self._halves(i) for i in self._joints), strict=True)
        box = concatenate(bold("J"), EQUALS, matrix([upper, lower]))
        return box if fits(box, 2) else None

    def axis(self, i: int) -> Vector:
        """The axis of joint i, from 1."""
        symbol = script(bold("z"), italic(str(self._frame(i))))
        return self._of_frame(symbol, i, 3)

    def origin(self, i: int) -> Vector:
        """The origin on the axis of joint i, from 1."""
        symbol = script(bold("o"), italic(str(self._frame(i))))
        return self._of_frame(symbol, i, 4)

    def end(self) -> Vector:
        """The origin of the end effector."""
        return Vector(bold("p"), self._whole(bold("p"), bold("p"), column(self.context.quantities["T"], 4, _UPPER)))

    def column(self, i: int) -> Vector:
        """Column i of J, from 1."""
        symbol = script(bold("J"), italic(str(i)))
        upper, lower = self._halves(i)
        box = concatenate(symbol, EQUALS, matrix([[upper], [lower]]))
        return Vector(box, self._whole(symbol, box, column(self.context.quantities["J"], i, _ALL)))

    @property
    def _standard(self) -> bool:
        return self.context.robot.convention is Convention.STANDARD

    @property
    def _joints(self) -> range:
        return range(1, self.context.robot.n + 1)

    def _frame(self, i: int) -> int:
        return i - 1 if self._standard else i

    def _of_frame(self, symbol: Box, i: int, index: int) -> Vector:
        frame = self._frame(i)
        if frame > self._last_short:
            return Vector(symbol)
        quantity = column(self.context.quantities[f"frame[{frame}]"], index, _UPPER)
        found = self._whole(symbol, symbol, quantity)
        if found is not None or total_terms(quantity) > self.context.policy.matrix_terms:
            return Vector(symbol, found)
        namer, group = _component_namer(symbol), axes_group(self.context.robot, frame, index)
        block = self.context.layouter.block(symbol, namer, quantity, group=group)
        return Vector(symbol, entries=block)

    @cached_property
    def _last_short(self) -> int:
        """The last frame before one without a column that could be printed; not even derived are those behind it."""
        for frame in range(self.context.robot.n + 1):
            quantity = self.context.quantities[f"frame[{frame}]"]
            if min(total_terms(column(quantity, k, _UPPER)) for k in (3, 4)) > self.context.policy.matrix_terms:
                return frame - 1
        return self.context.robot.n

    def _halves(self, i: int) -> tuple[Box, Box]:
        joint = self.context.robot.joints[i - 1]
        return _halves(str(self._frame(i)), revolute=joint.is_revolute, negative=joint.sign < 0)

    def _whole(self, symbol: Box, box: Box, quantity: Quantity) -> Whole | None:
        return whole(self.context, box, quantity, _component_namer(symbol))


def _component_namer(symbol: Box) -> Namer:
    """Components of a vector: (z_1)_2."""

    def component(row: int, _: int) -> Box:
        return script(concatenate(Box("(", BRACKET_WIDTH), symbol, Box(")", BRACKET_WIDTH)), italic(str(row)))

    return component


def _column(index: str, *, revolute: bool, negative: bool) -> Box:
    upper, lower = _halves(index, revolute=revolute, negative=negative)
    return matrix([[upper], [lower]])


def _halves(index: str, *, revolute: bool, negative: bool) -> tuple[Box, Box]:
    z, o = (script(bold(letter), italic(index)) for letter in "zo")
    if negative:
        z = concatenate(Box("-", MINUS_WIDTH), z)
    if not revolute:
        return z, _ZERO
    opening, closing = Box("(", BRACKET_WIDTH), Box(")", BRACKET_WIDTH)
    arm = concatenate(opening, bold("p"), Box(" - ", BINARY_WIDTH), o, closing)
    return concatenate(z, _CROSS, arm), z
