"""The part with the geometric Jacobian: how its columns are made from axes and origins, and the result.

Axes and origins of the joints, from which the columns of the Jacobian are made.

Column i is (z x (p - o), z) for a revolute joint and (z, 0) for a prismatic one, times the sign of its variable, with
z and o of frame i-1 in the standard convention and of frame i in the modified one (Siciliano, Sciavicco, Villani,
Oriolo, Robotics, section 3.1).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from derive.handout.angles import euler_zyz
from derive.handout.context import Context
from derive.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.handout.formula import formula
from derive.handout.frames import Whole, axes_group, column, packed, total_terms, whole
from derive.handout.layout.lines import EQUALS, fits, matrix, pack
from derive.handout.layout.quantity import LaidOut, Namer
from derive.handout.notation.pieces import BINARY_WIDTH, BRACKET_WIDTH, MINUS_WIDTH, Box, concatenate, italic, script
from derive.handout.notation.symbols import EntryNamer, bold
from derive.handout.quantity import Quantity
from derive.robot.description import Convention

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
    entries: LaidOut | None = None


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


def section(context: Context) -> Section:
    """J."""
    _ = context.text
    block = context.layouter.block(bold("J"), EntryNamer(context.symbols, "J"), context.quantities["J"], group=1)
    blocks: list[Block] = [
        Paragraph(
            _(
                "In the world frame, linear velocity of the end effector in rows 1 to 3, angular velocity in rows "
                "4 to 6."
            )
        ),
        *_construction(context),
        *_steps(context),
        formula(context, block, "jacobian"),
        *_analytic(context),
    ]
    return Section("jacobian", _("Geometric Jacobian"), tuple(blocks))


def _construction(context: Context) -> Iterator[Block]:
    _ = context.text
    joints, axes = context.robot.joints, JointAxes(context)
    yield Paragraph(_axis_text(context))
    if any(joint.is_revolute for joint in joints):
        yield Paragraph(_("The column of a revolute joint is"))
        yield Rows((axes.general(revolute=True).tex,))
    if not all(joint.is_revolute for joint in joints):
        yield Paragraph(_("The column of a prismatic joint is"))
        yield Rows((axes.general(revolute=False).tex,))
    if any(joint.sign < 0 for joint in joints):
        yield Paragraph(_("with the opposite sign where the joint variable has a minus sign in the table."))
    summary = axes.summary()
    if summary is not None:
        yield Paragraph(_("so that for this arm"))
        yield Rows((summary.tex,))


def _axis_text(context: Context) -> str:
    _ = context.text
    if context.robot.convention is Convention.STANDARD:
        return _(
            "Joint $i$ moves about or along $%(z)s$, the axis $z$ of frame $i-1$, through its origin $%(o)s$; "
            "$%(p)s$ is the origin of the end effector, all in the world.",
            z="\\mathbf{z}_{i-1}",
            o="\\mathbf{o}_{i-1}",
            p="\\mathbf{p}",
        )
    return _(
        "Joint $i$ moves about or along $%(z)s$, the axis $z$ of frame $i$, through its origin $%(o)s$; "
        "$%(p)s$ is the origin of the end effector, all in the world.",
        z="\\mathbf{z}_{i}",
        o="\\mathbf{o}_{i}",
        p="\\mathbf{p}",
    )


# -- steps


def _steps(context: Context) -> Iterator[Block]:
    if context.steps:
        yield Steps(context.text("Axes, origins and columns"), tuple(_step_blocks(context)))


def _step_blocks(context: Context) -> Iterator[Block]:
    _ = context.text
    axes = JointAxes(context)
    joints = range(1, context.robot.n + 1)
    turning = [i for i in joints if context.robot.joints[i - 1].is_revolute]
    origins = [*(axes.origin(i) for i in turning), axes.end()] if turning else []
    for title, vectors in (
        (_("Axes:"), [axes.axis(i) for i in joints]),
        (_("Origins, and that of the end effector:"), origins),
        (_("Columns:"), [axes.column(i) for i in joints]),
    ):
        if vectors:
            yield Paragraph(title)
            yield from _vectors(context, vectors)


def _vectors(context: Context, vectors: Sequence[Vector]) -> Iterator[Block]:
    """Those that fit share lines; then those by their entries, and those whose entries are too long."""
    fitting = [vector.whole for vector in vectors if vector.whole is not None]
    if fitting:
        yield formula(context, packed(fitting))
    yield from (formula(context, vector.entries) for vector in vectors if vector.entries is not None)
    left = [vector.box for vector in vectors if vector.whole is None and vector.entries is None]
    if left:
        yield Paragraph(context.text("Too long for a step:"))
        yield Rows(tuple(pack(left)))


# -- analytic


def _analytic(context: Context) -> Iterator[Block]:
    """How the Jacobian of the angles ZYZ follows, where they are not singular in every configuration."""
    end = context.quantities["T"]
    if not (end.terms(1, 3) or end.terms(2, 3)):
        return
    _ = context.text
    phi, theta, psi = (name.tex.strip() for name in euler_zyz(context).names)
    yield Paragraph(
        _(
            "The analytic Jacobian for Euler angles ZYZ, $%(angles)s$, has the same linear rows; its angular rows are "
            "those of $%(jacobian)s$ multiplied from the left by the inverse of",
            angles=f"{phi}, {theta}, {psi}",
            jacobian="\\mathbf{J}",
        )
    )
    rows = (
        f"0 & -\\sin {phi} & \\cos {phi}\\,\\sin {theta}",
        f"0 & \\cos {phi} & \\sin {phi}\\,\\sin {theta}",
        f"1 & 0 & \\cos {theta}",
    )
    body = " \\\\ ".join(rows)
    yield Rows((f"\\begin{{bmatrix}} {body} \\end{{bmatrix}}",))
