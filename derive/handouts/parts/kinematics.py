"""The parts with the transforms of the rows and with the end effector: T as a product and by its entries."""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise

from derive.handouts.layout.lines import EQUALS, Equation, equation_lines, pack
from derive.handouts.layout.quantity import LaidOut
from derive.handouts.notation.pieces import Box, Break, TexPiece, concatenate
from derive.handouts.notation.symbols import Group, bold
from derive.handouts.parts.table import BASE, TOOL
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Rows, Steps
from derive.handouts.sheet.formula import entry_namer, formula, in_rows, side_by_side, small, textbook
from derive.model.entries import Entries
from derive.robot.description import IDENTITY

_FEW_FACTORS = 8  # so many factors of a product are all written; of more the first and the last
_DOTS = Box("\\cdots ", 15.0)
_END = bold("T")


def transforms(context: Context) -> Iterator[Block]:
    """A_1 ... A_n; those that fit share lines, the others are given entry by entry."""
    yield context.paragraph("The transform of each row of the table, from frame $i$ to frame $i-1$:")
    task = context.text("Write the transform of each row of the table.")
    rows: list[LaidOut] = []
    for i in range(1, context.robot.n + 1):
        symbol, quantity = context.symbols.frame("A", i, i - 1), context.entries.A(i)
        fitting = small(context, symbol, quantity, entry_namer(symbol))
        rows.append(fitting or _laid_out(context, symbol, quantity, Group.row(i)))
    yield from (formula(context, laid_out, "link_transforms", task) for laid_out in in_rows(rows))


def end_effector(context: Context) -> Iterator[Block]:
    """T as a product and by its entries, and the names of its columns."""
    end = context.layouter.lay_out(_END, partial(context.symbols.entry, "t"), context.entries.T, group=Group.T)
    yield context.paragraph("The end effector in the world:")
    n, frame = context.robot.n, context.symbols.frame
    factors = [frame("A", i, i - 1) for i in (range(1, n + 1) if n <= _FEW_FACTORS else (1, 2, 3, n))]
    if n > _FEW_FACTORS:
        factors.insert(3, _DOTS)
    yield Rows((concatenate(_END, EQUALS, *_between_base_and_tool(context, factors)).tex,))
    if context.steps:
        yield Steps(context.text("The product, row by row"), tuple(_steps(context)))
    if end.omitted:
        yield from _partial_products(context)
    task = context.text("Find the transform $%(end)s$ of the end effector.", end=_END.tex)
    yield formula(context, end, "forward_kinematics", task)
    yield context.paragraph(
        "The columns of $%(end)s$: $%(n)s$, $%(s)s$ and $%(a)s$ are the axes $x$, $y$ and $z$ of the end "
        "effector in the world, $%(p)s$ is its origin.",
        end=_END.tex,
        **{letter: bold(letter).tex for letter in "nsap"},
    )
    yield textbook("columns_of_T")


def _laid_out(context: Context, symbol: Box, quantity: Entries, group: int) -> LaidOut:
    return context.layouter.lay_out(symbol, entry_namer(symbol), quantity, group=group)


def _between_base_and_tool(context: Context, factors: Sequence[Box]) -> list[Box]:
    """The factors of the arm with those of base and tool, where these are not the identity."""
    base = [BASE] if context.robot.base != IDENTITY else []
    tool = [TOOL] if context.robot.tool != IDENTITY else []
    return [*base, *factors, *tool]


def _steps(context: Context) -> Iterator[Block]:
    """T_i^0 = T_{i-1}^0 A_i, with its entries as long as they are short."""
    robot, frame = context.robot, context.symbols.frame
    yield Rows((concatenate(frame("T", 1, 0), EQUALS, frame("A", 1, 0)).tex,))
    is_bare = robot.base == IDENTITY and robot.tool == IDENTITY
    last = robot.n - 1 if is_bare else robot.n
    products = {
        i: concatenate(frame("T", i, 0), EQUALS, frame("T", i - 1, 0), frame("A", i, i - 1))
        for i in range(1, robot.n + 1)
    }
    limit = context.policy.matrix_terms
    long = next((i for i in range(2, last + 1) if not context.entries.transform(0, i).is_short(limit)), last + 1)
    for i in range(2, long):
        symbol, quantity = frame("T", i, 0), context.entries.transform(0, i)
        on_one_line = small(context, products[i], quantity, entry_namer(symbol))
        if on_one_line is not None:
            yield formula(context, side_by_side([on_one_line]))
        else:
            yield Rows((products[i].tex,))
            yield formula(context, _laid_out(context, symbol, quantity, Group.product(i)), "link_transforms")
    if long <= last:
        yield context.paragraph("From here on the entries are too long for a step:")
    end = concatenate(_END, EQUALS, *_between_base_and_tool(context, [frame("T", robot.n, 0)]))
    yield Rows(tuple(pack([*(products[i] for i in range(long, robot.n + 1)), end])))


def _partial_products(context: Context) -> Iterator[Block]:
    """Where T is too long: the arm as a product of a few transforms that can be printed, if it is long enough."""
    n, frame = context.robot.n, context.symbols.frame
    cuts = [0]
    for end in range(1, n + 1):
        quantity = context.entries.transform(cuts[-1], end)
        if (
            end > cuts[-1] + 1
            and max(quantity.terms(*place) for place in quantity.places) > context.policy.factor_terms
        ):
            cuts.append(end - 1)
    cuts.append(n)
    if len(cuts) == 2:
        return
    yield context.paragraph(
        "Multiplied out, the entries are too long to print; here they are as a product of shorter transforms:"
    )
    for start, end in pairwise(cuts):
        quantity = context.entries.transform(start, end)
        laid_out = _laid_out(context, frame("T", end, start), quantity, Group.factor(start))
        yield formula(context, laid_out, "link_transforms", context.text("Multiply these transforms out."))
    yield context.paragraph("The arm as a whole is")
    factors = (TexPiece(frame("T", end, start), Break.COMMA) for start, end in pairwise(cuts))
    yield Rows(tuple(equation_lines([Equation(frame("T", n, 0), tuple(factors))])))
