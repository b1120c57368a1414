"""The part with the geometric Jacobian: how its columns are made from axes and origins, and the result.

Column i is (z x (p - o), z) for a revolute joint and (z, 0) for a prismatic one, times the sign of its variable, with
z and o of frame i-1 in the standard convention and of frame i in the modified one (Siciliano, Sciavicco, Villani,
Oriolo, Robotics, section 3.1). In the standard convention a row of a tree begins behind its mount, in a frame with z'_i
and o'_i; columns of joints that do not move an end of it are zero.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial

from derive.handouts.layout.lines import equated, fits, matrix, pack
from derive.handouts.layout.quantity import LaidOut
from derive.handouts.notation.pieces import BINARY_WIDTH, EMPTY, Box, bracketed, concatenate, italic, minus, script
from derive.handouts.notation.symbols import Group, bold
from derive.handouts.parts.kinematics import euler_names
from derive.handouts.sheet.context import Context, component_namer, formula, side_by_side, textbook
from derive.handouts.sheet.document import Block, Paragraph, Rows, Steps
from derive.model.entries import Entries

_UPPER = (1, 2, 3)
_ALL = (1, 2, 3, 4, 5, 6)
_ZERO = Box("\\mathbf{0}", 6.0)
_CROSS = Box(" \\times ", BINARY_WIDTH)


Vector = LaidOut | Box  # of a step: its entries; else what stands for it, where these are too long or stand elsewhere


def jacobian(context: Context) -> Iterator[Block]:
    """J, from axes and origins to its entries, and how the analytic Jacobian follows."""
    axes = JointAxes(context)
    yield context.paragraph(
        "In the world frame; rows 1 to 3 give the linear velocity of the end effector, rows 4 to 6 its angular "
        "velocity."
    )
    yield from _construction(context, axes)
    if context.steps:
        yield Steps(context.text("Axes, origins and columns"), tuple(_steps(context, axes)))
    name = partial(context.symbols.entry, "J")
    laid_out = context.layouter.lay_out(context.symbols.of_end("J"), name, context.J, group=Group.J)
    yield formula(context, laid_out, context.function("jacobian"), context.text("Find the geometric Jacobian."))
    end = context.entries.T
    if end.terms(1, 3) or end.terms(2, 3):  # else the angles ZYZ are singular in every configuration
        phi, theta, psi = (angle.tex.strip() for angle in euler_names(context))
        yield context.paragraph(
            "The analytic Jacobian for Euler angles ZYZ, $%(angles)s$, has the same linear rows; its angular rows "
            "are those of $%(jacobian)s$ multiplied from the left by the inverse of",
            angles=f"{phi}, {theta}, {psi}",
            jacobian=context.symbols.of_end("J").tex,
        )
        yield textbook("euler_zyz_rates", phi=phi, theta=theta)


def _construction(context: Context, axes: JointAxes) -> Iterator[Block]:
    joints, index = context.robot.joints, axes.index("i")
    names = {letter: axes.symbol(letter, index).tex for letter in "zo"} | {"p": "\\mathbf{p}", "frame": index}
    if axes.at_begin:
        yield context.paragraph(
            "Joint $i$ turns about $%(z)s$ or slides along it, the axis $z$ through the origin $%(o)s$ of the frame in "
            "which row $i$ begins: that of the row which it follows, behind the mount; $%(p)s$ is the origin of the "
            "end effector, all in the world.",
            **names,
        )
    else:
        yield context.paragraph(
            "Joint $i$ turns about $%(z)s$ or slides along it, the axis $z$ of frame $%(frame)s$ through its origin "
            "$%(o)s$; $%(p)s$ is the origin of the end effector, all in the world.",
            **names,
        )
    column = script(bold("J"), italic("i"))
    if any(joint.is_revolute for joint in joints):
        yield context.paragraph("The column of a revolute joint is")
        yield Rows((equated(column, matrix([[half] for half in axes.columns(index)])).tex,))
    if not all(joint.is_revolute for joint in joints):
        yield context.paragraph("The column of a prismatic joint is")
        yield Rows((equated(column, matrix([[half] for half in axes.columns(index, is_revolute=False)])).tex,))
    if any(joint.sign < 0 for joint in joints):
        yield context.paragraph("with the opposite sign where the joint variable has a minus sign in the table.")
    if context.robot.coupled:
        yield context.answer(
            "and $%(jacobian)s$ is the matrix of these columns times $\\mathbf{S}$, a column for each variable.",
            jacobian=context.symbols.of_end("J").tex,
        )
        return
    moving = {place: axes.halves(i) for i, place in enumerate(context.places, 1)}
    upper, lower = zip(*(moving.get(place, (_ZERO, _ZERO)) for place in range(context.whole.robot.n)), strict=True)
    summary = equated(context.symbols.of_end("J"), matrix([upper, lower]))
    if fits(summary, 2):
        yield context.answer("so that for this arm")
        yield Rows((summary.tex,), is_answer=True)


def _steps(context: Context, axes: JointAxes) -> Iterator[Block]:
    """Vectors that fit share lines; then those by their entries, and those whose entries are too long."""
    _ = context.text
    joints = range(1, context.robot.n + 1)
    if origins := [axes.of_joint("o", i) for i in joints if context.robot.joints[i - 1].is_revolute]:
        origins.append(axes.end())
    columns = [] if context.robot.coupled else [axes.column(i) for i in joints]
    for title, vectors in (
        (_("Axes:"), [axes.of_joint("z", i) for i in joints]),
        (_("Origins, and that of the end effector:"), origins),
        (_("Columns:"), columns),
    ):
        if not vectors:
            continue
        yield Paragraph(title)
        laid_out = [vector for vector in vectors if isinstance(vector, LaidOut)]
        if fitting := [vector for vector in laid_out if vector.box != EMPTY]:
            yield formula(context, side_by_side(fitting))
        yield from (formula(context, vector) for vector in laid_out if vector.box == EMPTY)
        left = [vector for vector in vectors if isinstance(vector, Box)]
        if vectors is columns:
            yield from context.announced("Left as products, for their entries are long:", pack(left))
        elif left:
            end, whole = bold("p"), context.symbols.of_end("T").tex
            names = ", ".join(f"${box.tex}$" for box in left if box != end)
            if names and vectors is origins:
                yield context.paragraph(
                    "Too long to be written out here: %(vectors)s; an origin is the fourth column of the transform "
                    "from its frame to the world.",
                    vectors=names,
                )
            elif names:
                yield context.paragraph(
                    "Too long to be written out here: %(vectors)s; an axis $z$ is the third column of the transform "
                    "from its frame to the world.",
                    vectors=names,
                )
            if end in left:
                yield context.paragraph("For $%(p)s$ see the fourth column of $%(end)s$.", p=end.tex, end=whole)


@dataclass(frozen=True)
class JointAxes:
    """Axes and origins of the joints of one robot, from which the columns of J are made; joints from 1."""

    context: Context

    @property
    def at_begin(self) -> bool:
        """Whether joints move about the axes of frames in which rows begin, not of those of the rows before."""
        return self.context.is_standard and bool(self.context.labels)

    def index(self, i: int | str) -> str:
        """How the frame about or along whose z axis a joint moves is numbered, of joint i of this arm or of any."""
        if isinstance(i, int):
            i = self.context.places[i - 1] + 1
            return str(i if self.at_begin or not self.context.is_standard else i - 1)
        return i if self.at_begin or not self.context.is_standard else f"{i}-1"

    def symbol(self, letter: str, index: str) -> Box:
        """An axis z, or an origin o."""
        return script(Box(f"{bold(letter).tex}'", 12.0) if self.at_begin else bold(letter), italic(index))

    def columns(self, index: str, *, is_revolute: bool = True, is_opposed: bool = False) -> tuple[Box, Box]:
        """Linear and angular half of a column, by z and o with that index."""
        z, o = (self.symbol(letter, index) for letter in "zo")
        z = minus(z) if is_opposed else z
        if not is_revolute:
            return z, _ZERO
        return concatenate(z, _CROSS, bracketed(bold("p"), Box(" - ", BINARY_WIDTH), o)), z

    def of_joint(self, letter: str, i: int) -> Vector:
        """The axis z of a joint, or the origin o on it, in the world."""
        # the frame about or along whose z axis joint i moves, or the row that begins in it
        frame, column = i - 1 if self.context.is_standard and not self.at_begin else i, 3 if letter == "z" else 4
        symbol = self.symbol(letter, self.index(i))
        if frame > self._last_short:
            return symbol
        if not (quantity := self._in_world(frame).part(_UPPER, (column,))).is_short(self.context.policy.matrix_terms):
            return symbol
        group = Group.axis(self.context.robot.n, frame, column)
        return self.context.layouter.lay_out(symbol, component_namer(symbol), quantity, group=group)

    def end(self) -> Vector:
        """The origin of the end effector."""
        p = bold("p")
        return self.context.layouter.small(p, component_namer(p), self.context.entries.T.part(_UPPER, (4,))) or p

    def column(self, i: int) -> Vector:
        """A column of J."""
        symbol = script(bold("J"), italic(str(self.context.places[i - 1] + 1)))
        box = equated(symbol, matrix([[half] for half in self.halves(i)]))
        quantity = self.context.entries.J.part(_ALL, (i,))
        return self.context.layouter.small(box, component_namer(symbol), quantity) or box

    @cached_property
    def _last_short(self) -> int:
        """The last frame before one without a column that could be printed; not even derived are those behind it."""
        limit = self.context.policy.matrix_terms
        for frame in range(self.context.robot.n + 1):
            quantity = self._in_world(frame)
            if not any(quantity.part(_UPPER, (column,)).is_short(limit) for column in (3, 4)):
                return frame - 1
        return self.context.robot.n

    def _in_world(self, frame: int) -> Entries:
        entries = self.context.entries
        return entries.begin(frame) if self.at_begin and frame else entries.frame(frame)

    def halves(self, i: int) -> tuple[Box, Box]:
        """Linear and angular half of the column of a joint."""
        joint = self.context.robot.joints[i - 1]
        return self.columns(self.index(i), is_revolute=joint.is_revolute, is_opposed=joint.sign < 0)
