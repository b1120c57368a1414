"""The part with position and orientation: p, roll, pitch and yaw, and Euler angles ZYZ from the entries of T."""

from __future__ import annotations

from collections.abc import Iterator

from derive.handout.angles import Angles, euler_zyz, roll_pitch_yaw
from derive.handout.context import Context
from derive.handout.document import Block, Paragraph, Rows, Section
from derive.handout.formula import formula
from derive.handout.frames import column, rows_group, total_terms
from derive.handout.layout.lines import EQUALS, Equation, equation_lines, matrix
from derive.handout.layout.quantity import LaidOut as Laid
from derive.handout.notation.pieces import Box, concatenate, italic, script
from derive.handout.notation.symbols import bold

SHORT_ANGLES = 12
"""Most terms of the entries of T from which angles are written out; of more they are given by the entries alone."""

_END = bold("T").tex


def section(context: Context) -> Section:
    """Position and angles."""
    _ = context.text
    blocks = (*_position(context), *_roll_pitch_yaw(context), *_euler(context))
    return Section("orientation", _("Position and orientation"), blocks)


# -- position


def _position(context: Context) -> Iterator[Block]:
    _ = context.text
    yield Paragraph(_("The position of the end effector in the world is the fourth column of $%(end)s$:", end=_END))
    quantity = column(context.quantities["T"], 4, (1, 2, 3))
    if total_terms(quantity) > context.policy.compact_terms:
        entries = [[context.symbols.entry("t", i, 4)] for i in (1, 2, 3)]
        yield Rows((concatenate(bold("p"), EQUALS, matrix(entries)).tex,))
        return
    group = rows_group(context.robot.n + 1)
    block = context.layouter.block(bold("p"), lambda i, _: _coordinate(context, i), quantity, group=group)
    yield formula(context, block, "forward_kinematics")


def _coordinate(context: Context, i: int) -> Box:
    name = script(italic("p"), italic("xyz"[i - 1]))
    return context.symbols.entry("t", i, 4) if name.tex in context.notation.taken else name


# -- angles


def _roll_pitch_yaw(context: Context) -> Iterator[Block]:
    _ = context.text
    angles = roll_pitch_yaw(context)
    roll, pitch, yaw = (f"${name.tex}$" for name in angles.names)
    yield Paragraph(
        _(
            "Roll, pitch and yaw turn about the fixed axes $x$, $y$ and $z$, in this order: "
            "$\\mathbf{R} = %(product)s$. With the entries $t_{ij}$ of $%(end)s$:",
            product=_rotations(("z", "y", "x"), angles.names[::-1]),
            end=_END,
        )
    )
    yield from _angles(context, angles)
    if angles.is_always_singular:
        yield Paragraph(
            _(
                "This arm has %(pitch)s at a right angle in every configuration; only the sum or the difference of "
                "%(roll)s and %(yaw)s is determined, and %(roll)s is taken as zero.",
                roll=roll, pitch=pitch, yaw=yaw,
            )
        )  # fmt: skip
    elif angles.is_never_singular:
        yield Paragraph(_("They are never singular for this arm, for %(zero)s.", zero=_is_zero(angles)))
    else:
        yield Paragraph(
            _(
                "They are singular where %(zeros)s, that is at %(pitch)s $= \\pm\\pi/2$: there only "
                "%(yaw)s $-$ %(roll)s (plus) or %(yaw)s $+$ %(roll)s (minus) is determined.",
                zeros=_vanishing(angles), roll=roll, pitch=pitch, yaw=yaw,
            )
        )  # fmt: skip


def _euler(context: Context) -> Iterator[Block]:
    _ = context.text
    angles = euler_zyz(context)
    first, second, third = (f"${name.tex.strip()}$" for name in angles.names)
    yield Paragraph(
        _(
            "Euler angles ZYZ turn about the moving axes $z$, $y$ and $z$: $\\mathbf{R} = %(product)s$.",
            product=_rotations(("z", "y", "z"), angles.names),
        )
    )
    yield from _angles(context, angles)
    if angles.is_always_singular:
        yield Paragraph(
            _(
                "The axis $z$ of the end effector is parallel to that of the world in every configuration of this arm; "
                "only the sum or the difference of %(first)s and %(third)s is determined, and %(third)s is taken as "
                "zero.",
                first=first, third=third,
            )
        )  # fmt: skip
    elif angles.is_never_singular:
        yield Paragraph(_("They are never singular for this arm, for %(zero)s.", zero=_is_zero(angles)))
    else:
        yield Paragraph(
            _(
                "They are singular where %(zeros)s, that is at %(second)s $= 0$ and %(second)s $= \\pi$: there only "
                "%(first)s $+$ %(third)s or %(first)s $-$ %(third)s is determined.",
                zeros=_vanishing(angles), first=first, second=second, third=third,
            )
        )  # fmt: skip


def _rotations(axes: tuple[str, ...], names: tuple[Box, ...]) -> str:
    pairs = zip(axes, names, strict=True)
    return "\\,".join(f"\\mathrm{{Rot}}({axis},{name.tex.strip()})" for axis, name in pairs)


def _is_zero(angles: Angles) -> str:
    return f"${angles.sine.tex} = 0$"


def _vanishing(angles: Angles) -> str:
    return "$" + " = ".join(box.tex for box in angles.vanishing) + " = 0$"


def _angles(context: Context, angles: Angles) -> Iterator[Block]:
    """The angles by entries of T, then written out if that is short."""
    yield Rows(tuple(equation_lines(map(Equation, angles.names, angles.by_entries))))
    if angles.terms > SHORT_ANGLES:
        return
    quantity = context.quantities[angles.quantity]
    values = [quantity.entry(i, 1) for i in (1, 2, 3)]
    written = [Equation(name, tuple(context.printer.pieces(v))) for name, v in zip(angles.names, values, strict=True)]
    yield Paragraph(context.text("For this arm:"))
    laid = Laid(
        tuple(equation_lines(written)),
        values=tuple(zip(angles.names, values, strict=True)),
        blanks=tuple(name.tex for name in angles.names),
    )
    yield formula(context, laid)
