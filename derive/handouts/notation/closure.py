"""How passive joints of closed loops follow from the variables: lines of text, LaTeX and Python, and parts for JSON."""

from collections.abc import Sequence
from typing import Any

from derive.errors import listed
from derive.handouts.notation import derivation
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import PlainPrinter
from derive.handouts.notation.solution_printer import SignLatexPrinter, SignPrinter, pose_names, with_names
from derive.model.closure import Closure, LoopClosure
from derive.model.model import Model
from derive.robot.coupling import derivatives
from derive.robot.description import IDENTITY, Joining
from derive.robot.expression import to_text


def closure_lines(found: Closure, form: str, notation: Notation) -> list[str]:
    """The loops one after the other."""
    lines: list[str] = []
    for one in found.loops:
        join, arm = f"{listed(one.loop.join)} are joined ({one.loop.by.value})", one.inverse
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
            if one.loop.by is Joining.DISTANCE:
                table.append("its first link is the rod, in any direction")
            if arm.robot.tool != IDENTITY:
                table.append(f"tool at {listed(to_text(row[3]) for row in arm.robot.tool[:3])}")
            lines += [
                *(f"{join}; the unknown joints are an arm (modified convention)", *(f"   {row}" for row in table)),
                *("", "of whose pose T these are known:"),
                *(f"   {derivation.formula(line, write)}" for line in one.known),
                *("", *derivation.derivation_text(arm, write), ""),
                *(f"branch of the file: {derivation.formula(line, write)}" for line, each in own if each.signs),
                f"G and H have {undefined([one])}",
            ]
    return lines


def closure_parts(found: Closure) -> list[dict[str, Any]]:
    """What there is to know of each loop, as text that Python reads, for JSON."""
    write = PlainPrinter().doprint
    return [
        {"join": list(one.loop.join), "by": one.loop.by.value, "no_value_where_zero": list(map(write, one.zeros))}
        | {"branch": {str(sign): choice for sign, choice in one.solution.signs.items()}}
        | {"known": {write(line.symbol): write(line.value) for line in one.known}}
        | derivation.derivation_parts(one.inverse)
        for one in found.loops
    ]


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


def undefined(loops: Sequence[LoopClosure]) -> str:
    """Where the derivatives do not exist."""
    write = PlainPrinter().doprint
    zeros = [f"{write(zero)} = 0" for one in loops for zero in one.zeros]
    return f"no value where {' or '.join(zeros)}" if zeros else "values wherever the loops close"
