"""Closed loops, on a sheet and as lines: their passive joints by elementary equations, and how fast these move."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import sympy

from derive.errors import listed
from derive.handouts.layout.quantity import Item
from derive.handouts.notation import derivation
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import italic
from derive.handouts.notation.printer import LatexPrinter, PlainPrinter
from derive.handouts.notation.solution_printer import SignLatexPrinter, SignPrinter, pose_names, with_names
from derive.handouts.parts.inverse import InversePart
from derive.handouts.parts.inverse_words import and_list
from derive.handouts.parts.table import end_lines, table_rows, tool_of
from derive.handouts.sheet.context import Context, formula
from derive.handouts.sheet.document import Block, Rows
from derive.inverse.words.elementary import PrintedLine
from derive.model.closure import Closure, IteratedClosure, JoinedLoops, LoopClosure
from derive.model.entries import ModelEntries, expanded_terms
from derive.model.model import Model
from derive.robot.description import IDENTITY, Joining, derivatives
from derive.robot.expression import to_text

SOLVED_NUMERICALLY = "they are solved numerically, in generated code by Newton steps from the last configuration"
_MOST_SECOND = 12  # second derivatives that are printed


def closure(context: Context) -> Iterator[Block]:
    """The loops in the order in which they are solved, and the derivatives of all passive joints."""
    if not context.robot.loops:
        return
    loops = context.entries.model.closure.loops
    for number, one in enumerate(loops, 1):
        if isinstance(one, IteratedClosure):
            yield from _iterated(context, one)
        else:
            yield from _loop(context, one, f"loop{number}" if len(loops) > 1 else "loop")
    yield context.paragraph(
        "The derivatives of the passive joints by the variables, $G$ the first and $H$ the second ones, follow from "
        "the velocities of the joined frames: $\\mathbf{G} = -\\mathbf{J}_p^{-1}\\,\\mathbf{J}_a$ where "
        "$\\mathbf{J}_p\\,\\dot{\\mathbf{q}}_p + \\mathbf{J}_a\\,\\dot{\\mathbf{q}} = \\mathbf{0}$."
    )
    yield from _derivatives(context, loops)


def _loop(context: Context, one: LoopClosure, name: str) -> Iterator[Block]:
    """One loop: its unknown joints as an arm, what is known of the pose of that arm, and the solution."""
    entries = ModelEntries(Model(one.inverse.robot))
    own = Context(entries, context.options, context.text, None, context.policy, context, name)
    part = InversePart(own, one.inverse)
    writer = part.writer
    if one.surfaces:
        yield from _joined(context, one)
        yield context.paragraph("The point that the rods hold is on two planes and a sphere:")
        lines = (PrintedLine(e, sympy.S.Zero) for e in one.surfaces)
        yield Rows(tuple(row for line in lines for row in writer.rows(line)))
        yield context.paragraph("The variables determine these numbers of them:")
    else:
        yield context.paragraph(
            "Rows `%(first)s` and `%(second)s` are joined (`by: %(by)s`). The unknown joints of the loop are a serial "
            "arm, whose joints and frames are counted from 1 here, with this table in the modified convention:",
            first=one.loops[0].join[0],
            second=one.loops[0].join[1],
            by=one.loops[0].by.value,
        )
        yield from table_rows(own)
        if one.loops[0].by is Joining.DISTANCE:
            yield context.paragraph("Its first link is the rod, which may have any direction.")
        yield from own.announced("Before the first of them and behind the last:", end_lines(own, tool=tool_of(name)))
        pose = own.symbols.of_end("T").tex
        yield context.paragraph("The variables determine these entries of its pose $%(pose)s$:", pose=pose)
    yield Rows(tuple(row for line in one.known for row in writer.rows(line)))
    yield part.number_of_solutions()
    yield from part.decoupled()
    yield from part.derived()
    pairs = zip(one.solution.lines[len(one.known) :], one.inverse.named_lines, strict=True)
    chosen = tuple(row for line, each in pairs if each.signs for row in writer.rows(line))
    yield from context.announced("The robot file chooses this assembly:", chosen)
    yield from _dead_points(context, one)


def _joined(context: Context, one: JoinedLoops) -> Iterator[Block]:
    for loop in one.loops:
        yield context.paragraph(
            "Rows `%(first)s` and `%(second)s` are joined (`by: %(by)s`).",
            first=loop.join[0],
            second=loop.join[1],
            by=loop.by.value,
        )


def _iterated(context: Context, one: IteratedClosure) -> Iterator[Block]:
    """Loops without formulas: what remains of them."""
    yield from _joined(context, one)
    yield context.paragraph(
        "No elementary equations one after the other give %(names)s. These closure equations remain; they are solved "
        "numerically, by Newton's method from the last configuration.",
        names=and_list(context.text, [f"${context.notation.glyph(name).box.tex}$" for name in one.passive]),
    )
    items = [Item(italic("0"), expanded_terms(e), partial(lambda e: e, e)) for e in one.equations]
    yield formula(context, context.layouter.entries(items))
    yield from _dead_points(context, one)


def _dead_points(context: Context, one: JoinedLoops) -> Iterator[Block]:
    if one.zeros:
        write = context.printer.latex
        zeros = [_written(zero, write, "\\begin{vmatrix} %s \\end{vmatrix}", " & ", r" \\ ") for zero in one.zeros]
        where = and_list(context.text, [f"${zero} = 0$" for zero in zeros], either=True)
        yield context.paragraph("$G$ and $H$ have no values where %(zeros)s.", zeros=where)


def _written(zero: Any, write: Callable[[Any], str], form: str = "det([[%s]])", *between: str) -> str:
    if not isinstance(zero, sympy.Determinant):
        return write(zero)
    beside, below = between or (", ", "], [")
    return form % below.join(beside.join(map(write, row)) for row in zero.arg.tolist())


def _derivatives(context: Context, loops: Sequence[JoinedLoops]) -> Iterator[Block]:
    slopes = {name: one.slope for one in loops for name in one.names}
    second = [name for name in slopes if name.startswith("H_")]
    if is_left_out := len(second) > _MOST_SECOND:
        slopes = {name: slope for name, slope in slopes.items() if name not in second}
    values = {name: slope(name) for name, slope in slopes.items()}
    glyph = context.notation.glyph
    items = [Item(glyph(name).box, expanded_terms(e), partial(values.__getitem__, name)) for name, e in values.items()]
    task = context.text("Find the derivatives of the passive joints.")
    yield formula(context, context.layouter.entries(items), task=task)
    if is_left_out:
        yield context.answer("The second derivatives are too many to print.")


# -- as lines of text, LaTeX and Python, and as data


def closure_lines(found: Closure, form: str, notation: Notation) -> list[str]:
    """The loops one after the other."""
    lines: list[str] = []
    for one in found.loops:
        join = one.words
        if isinstance(one, IteratedClosure):
            lines += _iterated_lines(found, one, form, notation)
            continue
        arm = one.inverse
        signs = [f"{sign} = {choice}" for sign, choice in one.solution.signs.items()]
        names, solved = with_names(notation, arm), derivation.derivation_lines(arm, form, notation)
        if form == "latex":
            tex = SignLatexPrinter(names, arm).latex
            rows = [f"  {derivation.formula(line, tex, ' &= ')} \\\\" for line in one.known]
            lines += [f"% {join}; branch: {', '.join(signs) or 'the only one'}", solved[0], *rows, *solved[1:]]
        elif form == "python":
            known = [f"{line.symbol} = {PlainPrinter().doprint(line.value)}" for line in one.known]
            lines += [f"# {join}; the branch of the file", *signs, *known, *solved]
        else:
            write = SignPrinter(found.robot, names, pose_names(arm)).doprint
            own = zip(one.solution.lines[len(one.known) :], arm.named_lines, strict=True)
            _, *table, _ = repr(arm.robot).splitlines()
            words = ["the unknown joints are an arm (modified convention)", "of whose pose T these are known"]
            if one.surfaces:
                table = [f"{write(e)} = 0" for e in one.surfaces]
                words = ["the point is on two planes and a sphere", "of which these are known"]
            elif one.loops[0].by is Joining.DISTANCE:
                table.append("its first link is the rod, in any direction")
            if arm.robot.tool != IDENTITY:
                table.append(f"tool at {listed(to_text(row[3]) for row in arm.robot.tool[:3])}")
            lines += [
                *(f"{join}; {words[0]}", *(f"   {row}" for row in table)),
                *("", f"{words[1]}:"),
                *(f"   {derivation.formula(line, write)}" for line in one.known),
                *("", *derivation.derivation_text(arm, write), ""),
                *(f"branch of the file: {derivation.formula(line, write)}" for line, each in own if each.signs),
                f"G and H have {undefined([one])}",
            ]
    return lines


def _iterated_lines(found: Closure, one: IteratedClosure, form: str, notation: Notation) -> list[str]:
    words = f"{one.words}; no elementary equations one after the other give {listed(one.passive)}: these remain"
    told = f"{SOLVED_NUMERICALLY}, which say by how much loops are open"
    if form == "latex":
        rows = [f"  {LatexPrinter(notation).latex(e)} &= 0 \\\\" for e in one.equations]
        return [f"% {words}", r"\begin{aligned}", *rows, r"\end{aligned}", f"% {told}"]
    if form == "python":
        return [f"# {words}", *(f"0 == {PlainPrinter().doprint(e)}" for e in one.equations), f"# {told}"]
    write = SignPrinter(found.robot, notation, frozenset()).doprint
    return [words, *(f"   {write(e)} = 0" for e in one.equations), told, f"G and H have {undefined([one])}"]


def closure_parts(found: Closure) -> list[dict[str, Any]]:
    """What there is to know of each loop, as text that Python reads, for JSON."""
    write = PlainPrinter().doprint
    parts: list[dict[str, Any]] = []
    for one in found.loops:
        zeros = {"no_value_where_zero": [_written(zero, write) for zero in one.zeros]}
        loops = {"loops": [{"join": list(loop.join), "by": loop.by.value} for loop in one.loops]}
        if isinstance(one, IteratedClosure):
            equations = {"solved": "numerically", "zero": list(map(write, one.equations))}
            parts.append({**loops, **zeros, "passive": list(one.passive), **equations})
            continue
        parts.append(
            (loops if one.surfaces else {"join": list(one.loops[0].join), "by": one.loops[0].by.value})
            | {**zeros, **({"zero": list(map(write, one.surfaces))} if one.surfaces else {})}
            | {"branch": {str(sign): choice for sign, choice in one.solution.signs.items()}}
            | {"known": {write(line.symbol): write(line.value) for line in one.known}}
            | derivation.derivation_parts(one.inverse)
        )
    return parts


def loop_remarks(model: Model, shown: Sequence[tuple[str, Any]], address: str) -> list[str]:
    """What G_q3_q1 and H_q3_q1_q1 mean in what is printed, and the rows of G and H."""
    robot, lines, meanings = model.robot, list[str](), dict[str, str]()
    if any(name.partition("[")[0] in "GH" for name, _ in shown):
        rows, columns = (listed(joint.variable for joint in part) for part in (robot.passive, robot.variables))
        lines += [f"rows {rows}; columns {columns}, of H their pairs; {undefined(model.closure.loops)}"]
    used = {str(symbol) for _, value in shown for symbol in getattr(value, "free_symbols", ())}
    for of, symbol in derivatives(robot).items():
        if symbol.name in used:
            meanings.setdefault(symbol.name[0], f"{symbol.name} = d{'2' * (len(of) > 2)}{of[0]}/d{' d'.join(of[1:])}")
    if meanings:
        lines.append(f"{', '.join(meanings.values())}: derive show {address} {' '.join(meanings)}")
    return lines


def undefined(loops: Sequence[JoinedLoops]) -> str:
    """Where the derivatives do not exist."""
    zeros = [f"{_written(zero, PlainPrinter().doprint)} = 0" for one in loops for zero in one.zeros]
    return f"no value where {' or '.join(zeros)}" if zeros else "values wherever the loops close"
