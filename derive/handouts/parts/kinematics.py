"""The parts with the transforms of the rows, with the end effector, its position and its orientation.

Roll, pitch, yaw: R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll); Euler ZYZ: R = Rot(z, phi) Rot(y, theta) Rot(z, psi)
(Siciliano, Sciavicco, Villani, Oriolo, Robotics, section 2.4).
"""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise

from derive.handouts.layout.lines import Equation, equated, equation_lines, matrix, pack
from derive.handouts.layout.quantity import LaidOut
from derive.handouts.notation import pieces as typeset
from derive.handouts.notation.pieces import Box, Break, TexPiece, concatenate, greek, italic, minus, script, upright
from derive.handouts.notation.symbols import Group, bold
from derive.handouts.parts.table import BASE, tool_of
from derive.handouts.sheet.context import Context, entry_namer, formula, in_rows, side_by_side, textbook
from derive.handouts.sheet.document import Block, Paragraph, Rows, Steps
from derive.model.entries import Entries
from derive.robot import tree
from derive.robot.description import IDENTITY

_FEW_FACTORS = 8  # so many factors of a product are all written; of more the first and the last
_DOTS = Box("\\cdots ", 15.0)


def transforms(context: Context) -> Iterator[Block]:
    """A_1 ... A_n; those that fit share lines, the others are given entry by entry."""
    if context.robot.is_tree:
        yield context.paragraph(
            "The transform of each row of the table, from its frame to that of the row which it follows:"
        )
        pairs = [(pair, context.entries.between(*pair[::-1])) for pair in tree.antecedents(context.robot).items()]
        matrices = [(context.symbols.frame("A", *map(context.name, pair)), quantity) for pair, quantity in pairs]
    else:
        yield context.paragraph("The transform of each row of the table, from frame $i$ to frame $i-1$:")
        matrices = [(context.symbols.frame("A", i, i - 1), context.entries.A(i)) for i in range(1, context.robot.n + 1)]
    task = context.text("Write the transform of each row of the table.")
    rows = (_laid_out(context, symbol, quantity, Group.row(i)) for i, (symbol, quantity) in enumerate(matrices, 1))
    yield from (formula(context, laid_out, "link_transforms", task) for laid_out in in_rows(rows))


def end_effector(context: Context) -> Iterator[Block]:
    """T as a product and by its entries, and the names of its columns."""
    symbol, n = context.symbols.of_end("T"), len(context.path) - 1
    end = context.layouter.lay_out(symbol, partial(context.symbols.entry, "t"), context.entries.T, group=Group.T)
    yield context.paragraph("The end effector in the world:")
    factors = [_row(context, i) for i in (range(1, n + 1) if n <= _FEW_FACTORS else (1, 2, 3, n))]
    if n > _FEW_FACTORS:
        factors.insert(3, _DOTS)
    yield Rows((equated(symbol, *_between_base_and_tool(context, factors)).tex,))
    if context.steps:
        yield Steps(context.text("The product, row by row"), tuple(_steps(context)))
    if end.omitted:
        yield from _partial_products(context)
    task = context.text("Find the transform $%(end)s$ of the end effector.", end=symbol.tex)
    yield formula(context, end, context.function("forward_kinematics"), task)
    yield context.paragraph(
        "The columns of $%(end)s$: $%(n)s$, $%(s)s$ and $%(a)s$ are the axes $x$, $y$ and $z$ of the end "
        "effector in the world, $%(p)s$ is its origin.",
        end=symbol.tex,
        **{letter: bold(letter).tex for letter in "nsap"},
    )
    yield textbook("columns_of_T", T=symbol.tex)


def _row(context: Context, i: int) -> Box:
    """A of the row at a place on the way to the end effector."""
    return context.symbols.frame("A", context.path[i], context.path[i - 1])


def _laid_out(context: Context, symbol: Box, quantity: Entries, group: int) -> LaidOut:
    return context.layouter.lay_out(symbol, entry_namer(symbol), quantity, group=group)


def _between_base_and_tool(context: Context, factors: Sequence[Box]) -> list[Box]:
    base = [BASE] if context.robot.base != IDENTITY else []
    return [*base, *factors, *([tool_of(context.end)] if context.robot.tool != IDENTITY else [])]


def _steps(context: Context) -> Iterator[Block]:
    """T_i^0 = T_{i-1}^0 A_i, with its entries as long as they are short."""
    robot, names, ahead = context.robot, context.path, range(1, len(context.path))
    frames = [context.symbols.frame("T", name, names[0]) for name in names]
    yield Rows((equated(frames[1], _row(context, 1)).tex,))
    last = ahead[-1] - 1 if robot.base == IDENTITY == robot.tool else ahead[-1]
    products = {i: equated(frames[i], frames[i - 1], _row(context, i)) for i in ahead}
    limit = context.policy.matrix_terms
    long = next((i for i in range(2, last + 1) if not context.between(0, i).is_short(limit)), last + 1)
    for i in range(2, long):
        symbol, quantity = frames[i], context.between(0, i)
        if on_one_line := context.layouter.small(products[i], entry_namer(symbol), quantity):
            yield formula(context, side_by_side([on_one_line]))
        else:
            yield Rows((products[i].tex,))
            yield formula(context, _laid_out(context, symbol, quantity, Group.product(i)), "link_transforms")
    if long <= last:
        yield context.paragraph("From here on the entries are too long for a step:")
    end = equated(context.symbols.of_end("T"), *_between_base_and_tool(context, [frames[-1]]))
    yield Rows(tuple(pack([*(products[i] for i in ahead[long - 1 :]), end])))


def _partial_products(context: Context) -> Iterator[Block]:
    """Where T is too long: the arm as a product of a few transforms that can be printed, if it is long enough."""
    last, cuts = len(context.path) - 1, [0]
    for end in range(1, last + 1):
        quantity = context.between(cuts[-1], end)
        longest = max(quantity.terms(*place) for place in quantity.places)
        cuts += [end - 1] if end > cuts[-1] + 1 and longest > context.policy.factor_terms else []
    cuts.append(last)
    if len(cuts) == 2:
        return
    yield context.paragraph(
        "Multiplied out, the entries are too long to print; here they are as a product of shorter transforms:"
    )

    def _frame(start: int, end: int) -> Box:
        return context.symbols.frame("T", context.path[end], context.path[start])

    for start, end in pairwise(cuts):
        laid_out = _laid_out(context, _frame(start, end), context.between(start, end), Group.factor(start))
        yield formula(context, laid_out, "link_transforms", context.text("Multiply these transforms out."))
    yield context.paragraph("The arm as a whole is")
    factors = (TexPiece(_frame(start, end), Break.COMMA) for start, end in pairwise(cuts))
    yield Rows(tuple(equation_lines([Equation(_frame(0, last), tuple(factors))])))


SHORT_ANGLES = 12  # most terms of the entries of T by which angles are written out; of more they are not
_COMMA = TexPiece(Box(",\\, ", 5.0), depth=1)
_RIGHT_ANGLE = typeset.fraction(greek("pi"), italic("2"))

Angles = tuple[tuple[TexPiece, ...], tuple[TexPiece, ...], tuple[TexPiece, ...]]  # each angle by entries of T
Place = tuple[int, int]


def orientation(context: Context) -> Iterator[Block]:
    """The position of the end effector, and its orientation by two sets of angles."""
    yield context.paragraph(
        "The position of the end effector in the world is the fourth column of $%(end)s$:",
        end=context.symbols.of_end("T").tex,
    )
    quantity = context.entries.T.part((1, 2, 3), (4,))
    entries = [context.symbols.entry("t", i, 4) for i in (1, 2, 3)]
    if quantity.is_short(context.policy.compact_terms):
        letters = [script(italic("p"), italic(axis)) for axis in "xyz"]
        names = [t if p.tex in context.notation.taken else p for p, t in zip(letters, entries, strict=True)]
        group = Group.row(len(tree.labels(context.robot)))
        laid_out = context.layouter.lay_out(bold("p"), lambda i, _: names[i - 1], quantity, group=group)
        task = context.text("Find the position of the end effector.")
        yield formula(context, laid_out, context.function("forward_kinematics"), task)
    else:
        yield Rows((equated(bold("p"), matrix([[entry] for entry in entries])).tex,))
    yield from _roll_pitch_yaw(context)
    yield from _euler_zyz(context)


def _roll_pitch_yaw(context: Context) -> Iterator[Block]:
    """Singular where t_11 = t_21 = 0, at t_31 = -+1."""
    _, t = context.text, partial(context.symbols.entry, "t")
    names = tuple(Box(f"\\text{{{word}}}", upright(word).width) for word in (_("roll"), _("pitch"), _("yaw")))
    said = {angle: f"${name.tex}$" for angle, name in zip(("roll", "pitch", "yaw"), names, strict=True)}
    yield context.paragraph(
        "Roll, pitch and yaw turn about the fixed axes $x$, $y$ and $z$, in this order: $\\mathbf{R} = %(product)s$.",
        product=_rotations("zyx", names[::-1]),
    )
    task = _("Find roll, pitch and yaw of the end effector.")
    if is_upright := not _terms(context, (1, 1), (2, 1)):
        upright_pitch = (TexPiece(minus(concatenate(_RIGHT_ANGLE, t(3, 1)))),)
        angles: Angles = ((TexPiece(italic("0")),), upright_pitch, _atan2(minus(t(1, 2)), t(2, 2)))
        used = [(3, 1), (1, 2), (2, 2)]
    else:
        angles = _atan2(t(3, 2), t(3, 3)), _atan2(minus(t(3, 1)), _root(t(3, 2), t(3, 3))), _atan2(t(2, 1), t(1, 1))
        used = [(3, 2), (3, 3), (3, 1), (2, 1), (1, 1)]
    yield from _angles(context, names, angles, used, context.entries.rpy, task)
    if is_upright:
        yield context.answer(
            "This arm has %(pitch)s at a right angle in every configuration; only the sum or the difference of "
            "%(roll)s and %(yaw)s is determined, and %(roll)s is taken as zero.",
            **said,
        )
    elif not _terms(context, (3, 1)):
        yield context.answer("They are never singular for this arm, for %(zero)s.", zero=f"${t(3, 1).tex} = 0$")
    else:
        yield context.answer(
            "They are singular where %(zeros)s, that is at %(pitch)s $= \\pm %(right)s$: there only "
            "%(yaw)s $-$ %(roll)s (plus) or %(yaw)s $+$ %(roll)s (minus) is determined.",
            zeros=f"${t(1, 1).tex} = {t(2, 1).tex} = 0$",
            **said,
            right="90^{\\circ}" if context.notation.degrees else "\\pi/2",
        )


def euler_names(context: Context) -> list[Box]:
    """The Euler angles ZYZ: Greek letters, with an index where the robot has a symbol of that name."""
    taken = {tex.strip() for tex in context.notation.taken}
    letters = map(greek, ("varphi", "vartheta", "psi"))
    return [script(letter, upright("e")) if letter.tex.strip() in taken else letter for letter in letters]


def _euler_zyz(context: Context) -> Iterator[Block]:
    """Singular where t_13 = t_23 = 0, at t_33 = +-1."""
    _, t = context.text, partial(context.symbols.entry, "t")
    names, cosine = euler_names(context), t(3, 3)
    said = {place: f"${name.tex.strip()}$" for place, name in zip(("first", "second", "third"), names, strict=True)}
    yield context.paragraph(
        "Euler angles ZYZ turn about the moving axes $z$, $y$ and $z$: $\\mathbf{R} = %(product)s$.",
        product=_rotations("zyz", names),
    )
    task = _("Find the Euler angles ZYZ of the end effector.")
    if is_parallel := not _terms(context, (1, 3), (2, 3)):
        signed = [concatenate(cosine, t(i, 1)) for i in (2, 1)]
        inside = concatenate(Box("(1", 10.0), Box(" - ", typeset.BINARY_WIDTH), cosine, Box(")", typeset.BRACKET_WIDTH))
        angles: Angles = (_atan2(*signed), (TexPiece(concatenate(_RIGHT_ANGLE, inside)),), (TexPiece(italic("0")),))
        used = [(3, 3), (2, 1), (1, 1)]
    else:
        angles = _atan2(t(2, 3), t(1, 3)), _atan2(_root(t(1, 3), t(2, 3)), cosine), _atan2(t(3, 2), minus(t(3, 1)))
        used = [(2, 3), (1, 3), (3, 3), (3, 2), (3, 1)]
    yield from _angles(context, names, angles, used, context.entries.euler_zyz, task)
    if is_parallel:
        yield context.answer(
            "The axis $z$ of the end effector is parallel to that of the world in every configuration of this arm; "
            "only the sum or the difference of %(first)s and %(third)s is determined, and %(third)s is taken as "
            "zero.",
            **said,
        )
    elif not _terms(context, (3, 3)):
        yield context.answer("They are never singular for this arm, for %(zero)s.", zero=f"${cosine.tex} = 0$")
    else:
        yield context.answer(
            "They are singular where %(zeros)s, that is at %(second)s $= 0$ and %(second)s $= %(straight)s$: there "
            "only %(first)s $+$ %(third)s or %(first)s $-$ %(third)s is determined.",
            zeros=f"${t(1, 3).tex} = {t(2, 3).tex} = 0$",
            **said,
            straight="180^{\\circ}" if context.notation.degrees else "\\pi",
        )


def _rotations(axes: str, names: Sequence[Box]) -> str:
    return "\\,".join(f"\\mathrm{{Rot}}({axis},{name.tex.strip()})" for axis, name in zip(axes, names, strict=True))


def _angles(
    context: Context, names: Sequence[Box], by_entries: Angles, used: Sequence[Place], quantity: Entries, task: str
) -> Iterator[Block]:
    """The angles by entries of T, then written out if those entries are short, which an exercise asks for."""
    is_short = _terms(context, *used) <= SHORT_ANGLES
    words = context.text("With the entries $t_{ij}$ of $%(end)s$:", end=bold("T").tex)
    if context.end:
        words = context.text("With the entries of $%(end)s$:", end=context.symbols.of_end("T").tex)
    yield Paragraph(words, is_answer=is_short)
    yield Rows(tuple(equation_lines(map(Equation, names, by_entries))), is_answer=is_short)
    if not is_short:
        return
    values = [quantity.entry(i, 1) for i in (1, 2, 3)]
    written = [Equation(name, tuple(context.printer.pieces(v))) for name, v in zip(names, values, strict=True)]
    yield context.paragraph("For this arm:")
    blanks = tuple(name.tex for name in names)
    laid_out = LaidOut(tuple(equation_lines(written)), values=tuple(zip(names, values, strict=True)), blanks=blanks)
    yield formula(context, laid_out, task=task)


def _terms(context: Context, *places: Place) -> int:
    """Number of terms of some entries of T together; 0 if they vanish in every configuration."""
    return sum(context.entries.T.terms(*place) for place in places)


def _root(first: Box, second: Box) -> Box:
    squares = [script(box, sup=italic("2")) for box in (first, second)]
    inner = concatenate(squares[0], Box(" + ", typeset.BINARY_WIDTH), squares[1])
    return Box(f"\\sqrt{{{inner.tex}}}", inner.width + 10.0)


def _atan2(sine: Box, cosine: Box) -> tuple[TexPiece, ...]:
    opening, closing = TexPiece(Box("(", typeset.BRACKET_WIDTH)), TexPiece(Box(")", typeset.BRACKET_WIDTH))
    second = TexPiece(cosine, Break.COMMA, depth=1)
    return TexPiece(typeset.operator("atan2")), opening, TexPiece(sine, depth=1), _COMMA, second, closing
