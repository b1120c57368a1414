"""The parts with the robot's data: the DH table, base and tool, parameters, links."""

from collections.abc import Iterable, Iterator
from dataclasses import fields
from itertools import chain

from derive.handouts.layout.lines import Equation, equation_lines, pack
from derive.handouts.notation import pieces as typeset
from derive.handouts.notation.pieces import Box, Break, TexPiece, concatenate, italic, joined, script, upright
from derive.handouts.notation.printer import Cell
from derive.handouts.notation.symbols import bold
from derive.handouts.sheet.context import Context, entry_namer, matrix_lines
from derive.handouts.sheet.document import Block, Paragraph, Rows, Table
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.robot import tree
from derive.robot.description import IDENTITY, FixedRow, Joint, Link, Matrix, RootType, Stand, coupling, position
from derive.robot.expression import ZERO
from derive.robot.inertial_parameters import coulomb_parts
from derive.robot.names import free_symbols
from derive.robot.units import row_in_file_units
from derive.targets.escape import latex_text

BASE = Box("\\mathbf{T}_{\\mathrm{base}}", 30.0)
TOOL = Box("\\mathbf{T}_{\\mathrm{tool}}", 30.0)

_TABLE_WIDTH = 470.0  # room for a table [pt]
_FIRST_COLUMNS = 90.0
_TREE_COLUMNS = 90.0  # more of a tree
_COLUMN_GAP = 12.0
_LONGEST_TABLE = 30  # rows of a table that is kept on one page; a longer one needs two runs of LaTeX to align
_LETTER_WIDTH = 5.2  # of running text in mathematics [pt]


def dh_table(context: Context) -> Iterator[Block]:
    """The convention in words, the DH table, base and tool; of a tree its root, mounts and ends."""
    _, n = context.text, context.robot.n
    standard = _("Standard Denavit-Hartenberg convention, %(n)s joints.", n=n)
    modified = _("Modified Denavit-Hartenberg convention, %(n)s joints.", n=n)
    yield Paragraph(f"{standard if context.is_standard else modified} {_units(context)}")
    if root := context.robot.root:
        symbols = [f"${context.notation.glyph(name).box.tex.strip()}$" for name in root.variables]
        slides, axes = (2, "$z$") if root.type is RootType.PLANAR else (3, "$z$, $y$, $x$")
        yield context.paragraph(
            "The root moves: row `base` is displaced by %(slides)s along the axes of frame $0$ and turned by %(turns)s "
            "about its own axes %(axes)s, in this order. These are joints 1 to %(n)s.",
            slides=", ".join(symbols[:slides]),
            turns=", ".join(symbols[slides:]),
            axes=axes,
            n=len(symbols),
        )
    yield from table_rows(context)
    yield from _variables(context)
    if context.robot.is_tree:
        yield from _mounts_and_ends(context)
    else:
        yield from context.announced(
            "Constant transforms: the base takes frame $0$ into the world, "
            "the tool the end effector into frame $%(n)s$.",
            end_lines(context),
            n=n,
        )


def _variables(context: Context) -> Iterator[Block]:
    """What the variables of coupled joints are, how joints move with them, and within which limits."""
    robot, glyph = context.robot, context.notation.glyph
    if not robot.coupled:
        return
    symbols = {q.variable: glyph(q.variable).box.tex.strip() for q in robot.movers}
    named = ", ".join(f"${symbols[variable.variable]}$" for variable in robot.variables)
    if robot.passive:
        yield context.paragraph(
            "Variables $\\mathbf{q}$: %(variables)s. Loops determine the passive joints: %(passive)s. Joints move at "
            "the rates $\\mathbf{S}\\,\\dot{\\mathbf{q}}$, in the order of the table; $G$ are derivatives of passive "
            "joints by variables.",
            variables=named,
            passive=", ".join(f"${symbols[joint.variable]}$" for joint in robot.passive),
        )
    else:
        yield context.paragraph(
            "Variables $\\mathbf{q}$: %(variables)s. Positions of joints, in the order of the table, are "
            "$\\mathbf{S}\\,\\mathbf{q}$ and constants.",
            variables=named,
        )
    rows = [list(map(context.data.value, row)) for row in coupling(robot)]
    yield Rows(tuple(matrix_lines(bold("S"), rows, entry_namer(bold("S"), ","))))
    of_rows = {joint.variable: joint.limits for joint in robot.joints}
    other = [each for each in robot.variables if each.limits and each.limits != of_rows.get(each.variable)]
    if limits := ", ".join(f"${symbols[q.variable]} \\in {joined(context.data.limits(q)).tex}$" for q in other):
        yield context.paragraph("Limits of the variables: %(limits)s.", limits=limits)


def _mounts_and_ends(context: Context) -> Iterator[Block]:
    robot = context.robot
    rows = ((row.label, row.stand.mount) for row in tree.table(robot) if row.stand)
    lines = _matrices(context, ((script(bold("M"), context.name(label)), mount) for label, mount in rows))
    yield from context.announced("Mounts, which come before all else of their rows:", lines)
    if places := [(end.name, f"${context.name(end.after).tex}$") for end in robot.ends if end.name]:
        named = ", ".join(f"`{name}` ({after})" for name, after in places)
        yield context.paragraph("Ends, and the rows on which they are: %(ends)s.", ends=named)
    yield from context.announced(
        "Constant transforms: the base takes frame $0$ into the world, a tool its end into the frame of its row.",
        _matrices(context, ((BASE, robot.base), *((tool_of(end.name), end.tool) for end in tree.ends(robot)))),
    )


def _units(context: Context) -> str:
    _, units = context.text, context.robot.units
    with_degrees = _("Angles with a degree sign are in degrees, all others in radians.")
    angles = with_degrees if units.degrees else _("Angles are in radians.")
    if units.millimetres and units.parameters:
        return f"{angles} {_('Lengths in these tables are in millimetres, all other quantities in SI units.')}"
    if units.millimetres:
        lengths = _("Numbers of lengths in these tables are in millimetres; symbols and all else in SI units.")
        return f"{angles} {lengths}"
    if units.degrees:
        return _(
            "Angles with a degree sign are in degrees; all other quantities are in SI units, lengths in metres and "
            "angles in radians."
        )
    return _("Angles are in radians, lengths in metres, all other quantities in SI units.")


def end_lines(context: Context, base: Box = BASE, tool: Box = TOOL) -> list[str]:
    """Base and tool as matrices, where they are not the identity."""
    return _matrices(context, ((base, context.robot.base), (tool, context.robot.tool)))


def tool_of(end: str) -> Box:
    """The tool of an end."""
    return script(bold("T"), concatenate(upright("tool"), italic(","), upright(end))) if end else TOOL


def _matrices(context: Context, frames: Iterable[tuple[Box, Matrix]]) -> list[str]:
    value, length, lines = context.data.value, context.data.length, list[str]()
    for symbol, frame in frames:
        if frame != IDENTITY:
            rows = [[*map(value, row[:3]), (length if i < 3 else value)(row[3])] for i, row in enumerate(frame)]
            lines += matrix_lines(symbol, rows, entry_namer(symbol))
    return lines


def table_rows(context: Context) -> Iterator[Block]:
    """The table, or its cells row by row where it is too wide for the page."""
    _, robot = context.text, context.robot
    table = tree.table(robot)
    has_limits = any(joint.limits is not None for joint in robot.joints)
    has_turns = any(stand.gamma != ZERO or stand.b != ZERO for stand in tree.stands(robot))
    words = {True: _("revolute"), False: _("prismatic")}
    rows = [_cells(context, row, has_turns=has_turns, has_limits=has_limits) for row in table]
    kinds = [words[row.is_revolute] if isinstance(row, Joint) else _("fixed") for row in table]
    heads: list[tuple[str, ...]] = [(f"${i}$", kind) for i, kind in enumerate(kinds, 1)]
    header = ["$i$", _("joint")]
    if robot.is_tree:
        before = tree.antecedents(robot)
        places = [[f"${context.name(label).tex}$" for label in (row.label, before[row.label])] for row in table]
        named = [[f"`{row.name}`" if isinstance(row, Joint) and row.name else ""] for row in table]
        named = named if any(name for (name,) in named) else [[] for _row in table]
        heads = [(*place, *name, kind) for place, name, kind in zip(places, named, kinds, strict=True)]
        header = ["$i$", _("after"), *([_("name")] if named[0] else []), _("joint")]
    boxes = [[joined(cell) for cell in row] for row in rows]
    widths = (max(box.width for box in column) for column in zip(*boxes, strict=True))
    names = [f"{letter}_{{{i}}}" if len(i) > 1 else f"{letter}_{i}" for letter, i in _letters(context, "i", has_turns)]
    room = _FIRST_COLUMNS + (_TREE_COLUMNS if robot.is_tree else 0.0)
    if room + sum(width + _COLUMN_GAP for width in widths) > _TABLE_WIDTH:
        if robot.is_tree:
            yield Table(tuple(header), tuple(heads), len(rows) > _LONGEST_TABLE)
        pairs = zip(table, rows, strict=True)
        lines = (equation_lines(_named_cells(context, row, cells, has_turns)) for row, cells in pairs)
        yield Rows(tuple(line for own in lines for line in own))
        return
    header += [*(f"${name}$" for name in names), *([_("limits")] if has_limits else [])]
    texts = ([f"${box.tex.strip()}$" if box.tex else "" for box in row] for row in boxes)
    cells = tuple((*head, *row) for head, row in zip(heads, texts, strict=True))
    yield Table(tuple(header), cells, len(rows) > _LONGEST_TABLE)


def _cells(context: Context, row: Joint | FixedRow, *, has_turns: bool, has_limits: bool) -> list[Cell]:
    data, length = context.data, row_in_file_units(row, context.robot.units).d
    theta, d = expression_to_sympy(row.theta), expression_to_sympy(length)
    if isinstance(row, Joint):
        variable = expression_to_sympy(position(row))
        data = data.driven(row)
        theta, d = (theta + variable, d) if row.is_revolute else (theta, d + variable)
    moving, fixed = [data.angle(theta), data.value(d)], [data.length(row.a), data.angle(row.alpha)]
    cells = moving + fixed if context.is_standard else fixed[::-1] + moving
    if has_turns:
        stand = row.stand or Stand("")
        cells = [data.angle(stand.gamma), data.length(stand.b), *cells]
    return [*cells, data.limits(row) if isinstance(row, Joint) else ()] if has_limits else cells


def _letters(context: Context, index: str, has_turns: bool, before: str = "i-1") -> list[tuple[str, str]]:
    names = [(letter, index) for letter in ("\\theta", "d", "a", "\\alpha")]
    if not context.is_standard:
        behind = index if context.robot.is_tree else before
        names = [("\\alpha", behind), ("a", behind), *names[:2]]
    return [("\\gamma", index), ("b", index), *names] if has_turns else names


def _named_cells(context: Context, row: Joint | FixedRow, cells: list[Cell], has_turns: bool) -> Iterator[Equation]:
    number = tree.labels(context.robot).index(row.label)
    index = context.name(row.label)
    for (letter, i), cell in zip(_letters(context, index.tex, has_turns, str(number - 1)), cells, strict=False):
        yield Equation(script(Box(letter, 6.5), index if i == index.tex else italic(i)), cell)
    if isinstance(row, Joint) and row.limits is not None:
        yield Equation(Box(f"\\text{{limits {number}}}", 45.0), cells[-1])


def parameters(context: Context) -> Iterator[Block]:
    """Numbers of the robot file, arguments of the generated functions, inertial data of the links."""
    data, glyph = context.data, context.data.notation.glyph
    given = context.robot.parameters
    numbers = equation_lines(Equation(glyph(name).box, data.symbol(name, cell)) for name, cell in given)
    yield from context.announced("Numbers given in the robot file:", numbers)
    free = pack(glyph(name).box for name in free_symbols(context.robot))
    yield from context.announced("Arguments of the generated functions, in this order:", free)
    moving = len(context.robot.root.variables) if context.robot.root else 0
    if context.robot.links:
        yield context.paragraph(
            "Links: centre of mass, and inertia about it, in the axes of the link's own frame. Moments of inertia, "
            "motors and friction that are zero are left out."
        )
    for i, link in enumerate(tree.bodies(context.robot), 1):
        if (i > context.robot.n and link == Link()) or i <= moving:
            continue
        index = i if i <= context.robot.n else f"`{tree.labels(context.robot)[i]}`"
        yield context.paragraph("Link %(index)s:", index=index)
        yield Rows(tuple(equation_lines(link_equations(context, link))))


def link_equations(context: Context, link: Link) -> Iterator[Equation]:
    """Mass and centre of mass; inertia, rotor and friction of a link as far as they are not zero."""
    _ = context.text
    yield Equation(_word(_("mass")), context.data.value(link.mass))
    com: list[TexPiece] = [TexPiece(Box("(", typeset.BRACKET_WIDTH))]
    parts = [context.data.length(cell) for cell in link.com]
    separator = TexPiece(typeset.list_separator(chain(*parts)))
    for index, part in enumerate(parts):
        if index:  # behind a comma a line may be broken
            com.append(separator)
            part = (part[0]._replace(before=Break.COMMA), *part[1:])
        com += part
    yield Equation(_word(_("centre of mass")), (*com, TexPiece(Box(")", typeset.BRACKET_WIDTH))))
    cells = [(f"$I_{{{item.name}}}$", getattr(link.inertia, item.name)) for item in fields(link.inertia)]
    if motor := link.motor:
        cells += [(_("rotor mass"), motor.mass), (_("rotor inertia"), motor.inertia), (_("gear ratio"), motor.ratio)]
    cells += [(_("armature"), link.armature), (_("viscous friction"), link.viscous)]
    ways = {"f": "", "fp": " (+)", "fm": " (-)"}
    cells += [(_("Coulomb friction") + ways[part], cell) for part, cell in coulomb_parts(link).items()]
    for label, cell in cells:
        if cell != ZERO:
            yield Equation(_word(label), context.data.value(cell))


def _word(text: str) -> Box:
    escaped = text if text.startswith("$") else latex_text(text)
    return Box(f"\\text{{{escaped}}}", _LETTER_WIDTH * len(text.strip("${}")))
