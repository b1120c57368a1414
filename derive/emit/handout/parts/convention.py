"""The part with the convention: the general A matrix, its picture, and how sines and cosines are abbreviated."""

from __future__ import annotations

from derive.emit.figure.convention import convention_drawing
from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Figure, Paragraph, Rows, Section
from derive.emit.latex.metrics import EMPTY
from derive.robot.handout import Functions
from derive.robot.robot import Convention

_STANDARD = (
    r"= \mathrm{Rot}(z,\theta_i)\,\mathrm{Trans}(z,d_i)\,\mathrm{Trans}(x,a_i)\,\mathrm{Rot}(x,\alpha_i)",
    r"= \begin{bmatrix} "
    r"\cos\theta_i & -\sin\theta_i\cos\alpha_i & \sin\theta_i\sin\alpha_i & a_i\cos\theta_i \\ "
    r"\sin\theta_i & \cos\theta_i\cos\alpha_i & -\cos\theta_i\sin\alpha_i & a_i\sin\theta_i \\ "
    r"0 & \sin\alpha_i & \cos\alpha_i & d_i \\ 0 & 0 & 0 & 1 \end{bmatrix}",
)
_MODIFIED = (
    r"= \mathrm{Rot}(x,\alpha_{i-1})\,\mathrm{Trans}(x,a_{i-1})\,\mathrm{Rot}(z,\theta_i)\,\mathrm{Trans}(z,d_i)",
    r"= \begin{bmatrix} \cos\theta_i & -\sin\theta_i & 0 & a_{i-1} \\ "
    r"\sin\theta_i\cos\alpha_{i-1} & \cos\theta_i\cos\alpha_{i-1} & -\sin\alpha_{i-1} & -d_i\sin\alpha_{i-1} \\ "
    r"\sin\theta_i\sin\alpha_{i-1} & \cos\theta_i\sin\alpha_{i-1} & \cos\alpha_{i-1} & d_i\cos\alpha_{i-1} \\ "
    r"0 & 0 & 0 & 1 \end{bmatrix}",
)


def section(context: Context) -> Section:
    """The convention of the table and of the abbreviations."""
    _ = context.text
    standard = context.robot.convention is Convention.STANDARD
    product, matrix = _STANDARD if standard else _MODIFIED
    symbol = context.symbols.frame("A", "i", "i-1").tex
    blocks: list[Block] = [
        Paragraph(_("Row $i$ of the table takes frame $i$ into frame $i-1$:")),
        Rows((f"{symbol} {product}", f"\\phantom{{{symbol}}} {matrix}")),
        Figure(convention_drawing(context.robot.convention), _("The four parameters of row $i$.")),
    ]
    return Section("convention", _("Convention"), (*blocks, *_notation(context)))


def _notation(context: Context) -> list[Block]:
    _ = context.text
    texts = [*_abbreviations(context), _("A dot is a derivative with respect to time.")]
    if context.notation.decimals:
        texts.append(
            _(
                "Decimal numbers in the equations are rounded to %(digits)s significant digits; "
                "the generated code is not.",
                digits=context.notation.digits,
            )
        )
    return [Paragraph(" ".join(texts))]


def _abbreviations(context: Context) -> list[str]:
    notation = context.notation
    labelled = tuple(notation.labels)
    if not labelled or context.options.notation.functions is Functions.FULL:
        return []
    _ = context.text
    angle = notation.glyph(labelled[0]).box.tex
    short = [
        f"${notation.abbreviation('c', labelled[:1], EMPTY).tex} = \\cos {angle}$",
        f"${notation.abbreviation('s', labelled[:1], EMPTY).tex} = \\sin {angle}$",
    ]
    if len(labelled) > 1:
        total = " + ".join(notation.glyph(name).box.tex for name in labelled[:2])
        short.append(f"${notation.abbreviation('c', labelled[:2], EMPTY).tex} = \\cos({total})$")
    rule = _(
        "%(examples)s, and so on: the labels are the digits in the names of the joint variables.",
        examples=", ".join(short),
    )
    return [rule]
