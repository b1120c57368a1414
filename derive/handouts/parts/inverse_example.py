"""The example of the inverse kinematics: one pose, all configurations that reach it, and the arm drawn in each."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import mpmath
import numpy as np
import sympy

from derive.errors import DeriveError
from derive.handouts.figure.arm import branches_drawing
from derive.handouts.layout.lines import equated, matrix
from derive.handouts.notation.pieces import DECIMAL_COMMA, Box, italic, joined
from derive.handouts.parts.example import configuration, copied_rows
from derive.handouts.parts.figure import stated_values
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Entry, Figure, Paragraph, Rows, SheetFormula, Table
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.words.elementary import Numbers
from derive.inverse.words.solutions import CLOSE, InverseKinematics
from derive.lecture.point import DIGITS
from derive.lecture.sympy_conversion import Expr
from derive.mechanics.floats import value_at
from derive.robot.description import Joint
from derive.robot.expression import Number
from derive.robot.names import free_symbols
from derive.robot.units import position_unit
from derive.workspace.poses import RobotPoses

_PLACES = 4  # decimals of lengths and radians; two less of degrees
_DIGIT = 5.0  # width of a digit [pt]
_UNIT, _CELL, _ROOM = 30.0, 50.0, 400.0  # width of a unit, of a number with its gap, of a table's numbers [pt]
_LEAST = 1e-9  # two configurations closer to each other than this are one [rad or m]


Solutions = dict[int, tuple[float, ...]]  # joint variables [rad or m], angles in (-pi, pi], by number of the branch


def example(context: Context, found: InverseKinematics) -> Iterator[Block]:
    """All solutions at one pose in numbers, each put back, and a drawing of them."""
    _, poses = context.text, context.poses
    if poses is None:
        return
    assumed = tuple((name, Number(Fraction(str(value)))) for name, value, _unit in poses.assumed)
    figure = context.robot.figure
    robot = replace(context.robot, figure=replace(figure, values=(*figure.values, *assumed)))
    numbers = {sympy.Symbol(name): float(value) for name, value in poses.values.items()}
    try:
        # the configuration of the figure, or a generic one; then the generic one alone
        generic = replace(robot, figure=replace(robot.figure, q=None))
        tried = ((q, reached(found, numbers, q)) for q in (configuration(robot)[1], configuration(generic)[1]))
        q, solutions = next((q, solutions) for q, solutions in tried if _is_regular(found, solutions, q))
    except (StopIteration, DeriveError):
        return
    if assumed_values := _assumed(context, poses):
        yield context.paragraph("In numbers, with %(values)s, at this pose:", values=assumed_values)
    else:
        yield context.paragraph("In numbers, at this pose:")
    # what is 0, 1 or -1 but for rounding is written so
    rows = value_at(robot, "T", q)
    whole = {value: round(value) for row in rows for value in row if abs(value - round(value)) < _LEAST}
    cells = [[italic(str(whole[x])) if x in whole else _number(context, x) for x in row] for row in rows]
    yield Rows((equated(context.symbols.of_end("T"), matrix(cells)).tex,))
    words = _("It is the pose of the configuration %(values)s.", values=_stated(context, q))
    end = context.symbols.of_end("T").tex
    rest = _("All configurations below reach this pose (checked by substitution into $%(end)s$):", end=end)
    yield Paragraph(f"{words} {rest}", is_answer=True)
    yield from _results(context, solutions)
    if len(solutions) > 1:
        frames = [poses.frames(own) for own in solutions.values()]
        title = _("The arm in all configurations that reach one pose")
        if drawing := branches_drawing(context.robot, frames, list(map(str, solutions)), title):
            caption = _("The arm in these configurations, drawn over each other; numbers are those of the table.")
            yield Figure(drawing, caption, is_answer=True)


def reached(found: InverseKinematics, numbers: dict[Expr, float], q: Sequence[float]) -> Solutions:
    """Every solution of the pose of a configuration [rad or m], put back; with formulas to fifty digits."""
    if not found.is_explicit:  # by the eigenvalues of a matrix, or by the roots of a quartic
        solver = InverseSolver.of(found.robot, found.graph, {str(symbol): x for symbol, x in numbers.items()})
        pose, _slopes = solver.chain.pose_and_jacobian(np.array(q, dtype=float))
        solved = solver.solve(pose, [q[k] for k in found.graph.given]).q
        real = sorted(solved[np.isfinite(solved).all(axis=-1)].tolist(), key=lambda own: [round(x, 6) for x in own])
        return {number: tuple(own) for number, own in enumerate(real, 1)}
    variables = [sympy.Symbol(joint.variable) for joint in found.robot.joints]
    solutions = Solutions()
    with mpmath.workdps(DIGITS):
        given: Numbers = {symbol: mpmath.mpf(x) for symbol, x in zip(variables, q, strict=True)}
        values = found.values_at({symbol: mpmath.mpf(x) for symbol, x in numbers.items()}, given)
        for number, solution in enumerate(found.solutions, 1):
            by_formulas = solution.numbers(values)
            if by_formulas is not None and found.error(values, whole := {**given, **by_formulas}) < CLOSE:
                own = [float(whole[symbol]) for symbol in variables]
                solutions[number] = _in_one_turn(found.robot.joints, own)
    return solutions


def _in_one_turn(joints: Sequence[Joint], q: Sequence[float]) -> tuple[float, ...]:
    pairs, turn = zip(q, joints, strict=True), 2 * math.pi
    return tuple(x - turn * math.ceil((x - math.pi) / turn) if joint.is_revolute else x for x, joint in pairs)


def _is_regular(found: InverseKinematics, solutions: Solutions, q: Sequence[float]) -> bool:
    """Whether a pose has as many different configurations as others: one that teaches nothing special."""
    turned = _in_one_turn(found.robot.joints, q)
    own = any(_apart(solution, turned) < _LEAST for solution in solutions.values())
    return own and all(_apart(*pair) > _LEAST for pair in combinations(solutions.values(), 2))


def _apart(a: Sequence[float], b: Sequence[float]) -> float:
    return max(abs(math.remainder(x - y, 2 * math.pi)) for x, y in zip(a, b, strict=True))


def _assumed(context: Context, poses: RobotPoses) -> str:
    """The numbers of symbols that have none among the parameters of the robot file."""
    free, data = free_symbols(context.robot), context.data
    cells, glyph = [pair for pair in context.robot.figure.values if pair[0] in free], data.notation.glyph
    written = [f"${glyph(name).box.tex.strip()} = {joined(data.symbol(name, cell)).tex}$" for name, cell in cells]
    written += [stated_values(context, poses.assumed)] if poses.assumed else []
    return context.text.listing(written)


def _stated(context: Context, q: Sequence[float]) -> str:
    written = []
    for joint, value in zip(context.robot.joints, q, strict=True):
        symbol = context.notation.glyph(joint.variable).box.tex.strip()
        unit = _unit(context, joint)[0]
        behind = unit.removeprefix("{}") if "circ" in unit else f"\\,{unit}"
        written.append(f"${symbol} = {_position(context, value, joint).tex}{behind}$")
    return context.text.listing(written)


def _unit(context: Context, joint: Joint) -> tuple[str, float, int]:
    """The unit of a joint variable in the robot file, how many are 1 rad or 1 m, and the decimals that it shows."""
    if not position_unit(joint).differs_in(context.robot.units):
        return "\\mathrm{rad}" if joint.is_revolute else "\\mathrm{m}", 1.0, _PLACES
    return ("{}^{\\circ}", math.degrees(1.0), _PLACES - 2) if joint.is_revolute else ("\\mathrm{mm}", 1e3, _PLACES - 3)


def _position(context: Context, value: float, joint: Joint) -> Box:
    _, size, places = _unit(context, joint)
    return _number(context, size * value, places)


def _number(context: Context, value: float, places: int = _PLACES) -> Box:
    if not float(shown := f"{value:.{places}f}"):
        shown = shown.removeprefix("-")
    return Box(shown.replace(".", DECIMAL_COMMA) if context.notation.comma else shown, _DIGIT * len(shown) + _DIGIT)


def _results(context: Context, solutions: Solutions) -> Iterator[Block]:
    """What an exercise asks for and a page copies, then the configurations as a table."""
    _, joints = context.text, context.robot.joints
    names = [context.notation.glyph(joint.variable).box for joint in joints]
    units = [_unit(context, joint)[0] for joint in joints]
    heads = [f"{name.tex.strip()}\\,[{unit}]" for name, unit in zip(names, units, strict=True)]
    cells = [[_position(context, x, j).tex for x, j in zip(q, joints, strict=True)] for q in solutions.values()]
    body = " \\\\ ".join(" & ".join((str(k), *row)) for k, row in zip(solutions, cells, strict=True))
    array = f"\\begin{{array}}{{c|{'r' * len(joints)}}} & {' & '.join(heads)} \\\\ \\hline {body} \\end{{array}}"
    python = copied_rows(solutions.values())
    task = _("Compute in numbers all configurations that reach this pose.")
    room, entries = ("",) * max(1, len(solutions) // 2), (Entry("\\mathbf{q}", array, python),)
    yield SheetFormula((), function="inverse_kinematics", entries=lambda: entries, task=task, blanks=room)
    if sum(max(name.width + _UNIT, _CELL) for name in names) > _ROOM:
        separator = ";\\, " if context.notation.comma else ",\\, "
        vectors = (f"\\mathbf{{q}} = [{separator.join(row)}]" for row in cells)
        yield Rows(tuple(map("{}\\colon\\quad {}".format, solutions, vectors)), is_answer=True)
        return
    # a phantom minus aligns a number without a sign below one that has it
    aligned = ([f"${x}$" if x.startswith("-") else f"$\\phantom{{-}}{x}$" for x in row] for row in cells)
    rows = tuple((str(k), *row) for k, row in zip(solutions, aligned, strict=True))
    yield Table((_("Branch"), *(f"${head}$" for head in heads)), rows, is_answer=True)
