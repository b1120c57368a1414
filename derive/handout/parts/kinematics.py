"""The part with the end effector: T as a product, step by step, its entries and the names of its columns.

The part with the transform of each row of the table.
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.handout.context import Context
from derive.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.handout.formula import formula
from derive.handout.frames import (
    Whole,
    between_base_and_tool,
    entry_namer,
    factor_group,
    packed,
    product_of_rows,
    rows_group,
    step_group,
    total_terms,
    transform_block,
    whole,
)
from derive.handout.layout import quantity
from derive.handout.layout.lines import EQUALS, Equation, equation_lines, pack
from derive.handout.layout.quantity import LaidOut, places
from derive.handout.notation.pieces import Box, Break, Piece, concatenate
from derive.handout.notation.symbols import EntryNamer, bold
from derive.robot.description import IDENTITY

_END = bold("T")
_COLUMNS = (
    r"\mathbf{T} = \begin{bmatrix} \mathbf{n} & \mathbf{s} & \mathbf{a} & \mathbf{p} \\ 0 & 0 & 0 & 1 \end{bmatrix}"
)


def kinematics_section(context: Context) -> Section:
    """T."""
    _ = context.text
    end = context.layouter.block(_END, EntryNamer(context.symbols, "t"), context.quantities["T"], group=0)
    blocks: list[Block] = [
        Paragraph(_("The end effector in the world:")),
        Rows((_product_line(context),)),
        *_steps(context),
        *(_partial_products(context) if end.omitted else ()),
        formula(context, end, "forward_kinematics"),
        Paragraph(
            _(
                "The columns of $%(end)s$: $%(n)s$, $%(s)s$ and $%(a)s$ are the axes $x$, $y$ and $z$ of the end "
                "effector in the world, $%(p)s$ is its origin.",
                end=_END.tex,
                **{letter: bold(letter).tex for letter in "nsap"},
            )
        ),
        Rows((_COLUMNS,)),
    ]
    return Section("kinematics", _("End effector"), tuple(blocks))


def _product_line(context: Context) -> str:
    factors = between_base_and_tool(context.robot, product_of_rows(context))
    return concatenate(_END, EQUALS, *factors).tex


# -- steps


def _steps(context: Context) -> Iterator[Block]:
    if context.steps:
        _ = context.text
        yield Steps(_("The product, row by row"), tuple(_step_blocks(context)))


def _step_blocks(context: Context) -> Iterator[Block]:
    """T_i^0 = T_{i-1}^0 A_i, with its entries as long as they are short."""
    robot = context.robot
    first = concatenate(context.symbols.frame("T", 1, 0), EQUALS, context.symbols.frame("A", 1, 0))
    yield Rows((first.tex,))
    bare = robot.base == IDENTITY and robot.tool == IDENTITY
    printed = robot.n - 1 if bare else robot.n
    long = next((i for i in range(2, printed + 1) if not _is_short(context, i)), printed + 1)
    for i in range(2, long):
        yield from _step(context, i)
    products = [_step_product(context, i) for i in range(long, robot.n + 1)]
    if long <= printed:
        yield Paragraph(context.text("From here on the entries are too long for a step:"))
    last = concatenate(_END, EQUALS, *between_base_and_tool(robot, [context.symbols.frame("T", robot.n, 0)]))
    yield Rows(tuple(pack([*products, last])))


def _is_short(context: Context, i: int) -> bool:
    return total_terms(context.quantities[f"T[0,{i}]"]) <= context.policy.matrix_terms


def _step_product(context: Context, i: int) -> Box:
    factors = context.symbols.frame("T", i - 1, 0), context.symbols.frame("A", i, i - 1)
    return concatenate(context.symbols.frame("T", i, 0), EQUALS, *factors)


def _step(context: Context, i: int) -> Iterator[Block]:
    """The product and its entries, on one line if they fit."""
    product, symbol = _step_product(context, i), context.symbols.frame("T", i, 0)
    quantity = context.quantities[f"T[0,{i}]"]
    namer = entry_namer(symbol)
    on_one_line = whole(context, product, quantity, namer)
    if on_one_line is not None:
        yield formula(context, packed([on_one_line]))
        return
    yield Rows((product.tex,))
    yield formula(context, transform_block(context, symbol, quantity, step_group(i)), "link_transforms")


# -- where T is too long


def _partial_products(context: Context) -> Iterator[Block]:
    """The arm as a product of a few transforms that can be printed, if it is long enough to be taken apart."""
    blocks, factors, start = [], [], 0
    while start < context.robot.n:
        end = _last_short(context, start)
        blocks.append(_factor(context, start, end))
        factors.append(Piece(context.symbols.frame("T", end, start), Break.COMMA))
        start = end
    if len(blocks) == 1:
        return
    _ = context.text
    yield Paragraph(
        _("Multiplied out, the entries are too long to print; here they are as a product of shorter transforms:")
    )
    yield from (formula(context, block, "link_transforms") for block in blocks)
    yield Paragraph(_("The arm as a whole is"))
    arm = Equation(context.symbols.frame("T", context.robot.n, 0), tuple(factors))
    yield Rows(tuple(equation_lines([arm])))


def _factor(context: Context, start: int, end: int) -> quantity.LaidOut:
    quantity = context.quantities[f"T[{start},{end}]"]
    return transform_block(context, context.symbols.frame("T", end, start), quantity, factor_group(start))


def _last_short(context: Context, start: int) -> int:
    """The frame up to which the product from frame ``start`` on is short."""
    end = start + 1
    while end < context.robot.n and _is_factor(context, start, end + 1):
        end += 1
    return end


def _is_factor(context: Context, start: int, end: int) -> bool:
    quantity = context.quantities[f"T[{start},{end}]"]
    longest = max(quantity.terms(*place) for place in places(quantity.shape))
    return longest <= context.policy.factor_terms


def transforms_section(context: Context) -> Section:
    """A_1 ... A_n."""
    _ = context.text
    introduction = Paragraph(_("Frame $i$ in frame $i-1$, row by row:"))
    formulas = (formula(context, block, "link_transforms") for block in _blocks(context))
    return Section("transforms", _("Transforms of the rows"), (introduction, *formulas))


def _blocks(context: Context) -> Iterator[LaidOut]:
    """Those that fit share lines; the others are given entry by entry."""
    side_by_side: list[Whole] = []
    for i in range(1, context.robot.n + 1):
        symbol, quantity = context.symbols.frame("A", i, i - 1), context.quantities[f"A[{i}]"]
        fitting = whole(context, symbol, quantity, entry_namer(symbol))
        if fitting is not None:
            side_by_side.append(fitting)
            continue
        if side_by_side:
            yield packed(side_by_side)
        yield transform_block(context, symbol, quantity, rows_group(i))
        side_by_side = []
    if side_by_side:
        yield packed(side_by_side)
