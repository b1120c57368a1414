"""The part with the Newton-Euler recursion, written out for the robot's joints.

What the Newton-Euler recursion of one robot is made of: rotations, arms, masses and inertias of its links.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from derive.handout.bodies import has_rotor
from derive.handout.context import Context
from derive.handout.document import Block, Entry, Formula, Paragraph, Rows, Section, Steps
from derive.handout.layout.lines import EQUALS, Equation, equation_lines, fits, matrix, pack
from derive.handout.notation.pieces import Box, concatenate, italic, joined, script
from derive.handout.notation.printer import LatexPrinter
from derive.handout.notation.text import PlainPrinter
from derive.handout.parts.recursion import Recursion, Subject, vector
from derive.lecture.to_sympy import expression_to_sympy
from derive.robot.description import Convention
from derive.robot.expression import ZERO
from derive.robot.names import acceleration_name, velocity_name

Cells = Sequence[Sequence[Any]]


@dataclass(frozen=True)
class Constant:
    """A matrix or vector of a link.

    Attributes:
        symbol: What it is called.
        cells: Its entries.
        data: Whether they are the user's numbers, printed with every digit.
    """

    symbol: Box
    cells: Cells
    data: bool = False


def link_constants(context: Context, recursion: Recursion, i: int) -> Formula:
    """R_i^{i-1}, p_i, r_i, m_i and I_i of link i (from 1), one formula."""
    lines: list[str] = []
    whole: list[Box] = []
    entries: list[Entry] = []
    constants = list(_constants_of_links(context, recursion, i))
    for constant in constants:
        printer = context.printer if not constant.data else LatexPrinter(context.data.notation)
        box = _whole(printer, constant)
        if box is not None:
            whole.append(box)
        else:
            lines += equation_lines(_equations_of_links(printer, constant))
        entries += _entries(printer, constant)
    blanks = tuple(constant.symbol.tex for constant in constants)
    return Formula((Rows((*pack(whole), *lines)),), entries=tuple(entries), blanks=blanks)


def _constants_of_links(context: Context, recursion: Recursion, i: int) -> Iterator[Constant]:
    index, link = str(i), context.robot.links[i - 1]
    row = context.quantities[f"A[{i}]"]
    yield Constant(recursion.rotation(index, str(i - 1)), [[row.entry(r, c) for c in (1, 2, 3)] for r in (1, 2, 3)])
    yield Constant(recursion.offset(index), _arm(context, i))
    yield Constant(recursion.com(index), [[expression_to_sympy(cell)] for cell in link.com], data=True)
    yield Constant(script(italic("m"), italic(index)), [[expression_to_sympy(link.mass)]], data=True)
    t = link.inertia
    tensor = ((t.xx, t.xy, t.xz), (t.xy, t.yy, t.yz), (t.xz, t.yz, t.zz))
    cells = [[expression_to_sympy(cell) for cell in cells] for cells in tensor]
    yield Constant(vector("I", index), cells, data=True)


def _arm(context: Context, i: int) -> Cells:
    """From o_{i-1} to o_i: in frame i (standard), where it is constant, or in frame i-1 (modified)."""
    if context.robot.convention is Convention.STANDARD:
        back = context.quantities[f"T[{i},{i - 1}]"]
        return [[-back.entry(r, 4)] for r in (1, 2, 3)]
    row = context.quantities[f"A[{i}]"]
    return [[row.entry(r, 4)] for r in (1, 2, 3)]


def _whole(printer: LatexPrinter, constant: Constant) -> Box | None:
    rows = [[joined(printer.pieces(cell)) for cell in row] for row in constant.cells]
    right = rows[0][0] if len(rows) == 1 else matrix(rows)
    box = concatenate(constant.symbol, EQUALS, right)
    return box if fits(box, len(rows)) else None


def _named(constant: Constant) -> Iterator[tuple[Box, Any]]:
    """The entries with their names."""
    held = concatenate(Box("(", 5.0), constant.symbol, Box(")", 5.0))
    for r, row in enumerate(constant.cells, 1):
        for c, cell in enumerate(row, 1):
            index = f"{r}{c}" if len(row) > 1 else str(r)
            yield constant.symbol if len(constant.cells) == 1 else script(held, italic(index)), cell


def _equations_of_links(printer: LatexPrinter, constant: Constant) -> list[Equation]:
    return [Equation(name, tuple(printer.pieces(cell))) for name, cell in _named(constant) if cell != 0]


def _entries(printer: LatexPrinter, constant: Constant) -> Iterator[Entry]:
    python = PlainPrinter()
    for name, cell in _named(constant):
        yield Entry(name.tex, printer.latex(cell), python.doprint(cell))


def section(context: Context) -> Section | None:
    """The recursion: generic equations of the joint types that occur, and the constants of every link."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    standard = context.robot.convention is Convention.STANDARD
    recursion = Recursion(standard, context.symbols)
    blocks = (
        Paragraph(_introduction(context)),
        *_start(context),
        *_generic(context, recursion),
        *_remarks(context),
        *_constants(context, recursion),
        *(_written_out(context, recursion) if context.steps else ()),
    )
    return Section("newton-euler", _("Newton-Euler recursion"), blocks)


def _introduction(context: Context) -> str:
    _ = context.text
    common = _(
        "All vectors of link $i$ are in the axes of its own frame: $\\boldsymbol{\\omega}_i$ and "
        "$\\dot{\\boldsymbol{\\omega}}_i$ of the link, $\\mathbf{a}_i$ the acceleration of $\\mathbf{o}_i$ less "
        "gravity, $\\mathbf{a}_{c_i}$ that of the centre of mass, which is at $\\mathbf{r}_{c_i}$ from "
        "$\\mathbf{o}_i$; $\\mathbf{F}_i$ and $\\mathbf{N}_i$ are what the motion of the link takes, "
        "$\\mathbf{f}_i$ and $\\mathbf{n}_i$ the force and the moment that it receives through joint $i$, "
        "$\\mathbf{I}_i$ is its inertia about the centre of mass."
    )
    if context.robot.convention is Convention.STANDARD:
        rest = _(
            "$\\mathbf{p}_i^{*}$ leads from $\\mathbf{o}_{i-1}$ to $\\mathbf{o}_i$, and "
            "$\\mathbf{z}_0 = (0, 0, 1)^T$ is the axis of joint $i$ in frame $i-1$."
        )
    else:
        rest = _(
            "$\\mathbf{p}_i$ leads from $\\mathbf{o}_{i-1}$ to $\\mathbf{o}_i$, in frame $i-1$, and "
            "$\\mathbf{z}_0 = (0, 0, 1)^T$ is the axis of joint $i$ in frame $i$."
        )
    return f"{common} {rest}"


def _start(context: Context) -> Iterator[Block]:
    """What the recursion starts from, at the base and at the end effector."""
    _ = context.text
    still = "\\boldsymbol{\\omega}_0 = \\dot{\\boldsymbol{\\omega}}_0 = \\mathbf{0}"
    n = context.robot.n + 1
    free = f"\\mathbf{{f}}_{{{n}}} = \\mathbf{{n}}_{{{n}}} = \\mathbf{{0}}"
    yield Paragraph(_("The base is at rest, gravity acts as an acceleration of the base, and nothing loads the end."))
    yield Rows((f"{still} \\qquad {free}", *_base_acceleration(context)))


def _base_acceleration(context: Context) -> list[str]:
    symbol, cells = Box("\\mathbf{a}_{0}", 11.0), base_acceleration(context)
    printer = context.printer
    whole = concatenate(symbol, EQUALS, matrix([[joined(printer.pieces(cell))] for cell in cells]))
    if fits(whole, 3):
        return [whole.tex]
    names = (Box(f"({symbol.tex})_{{{k}}}", 25.0) for k in (1, 2, 3))
    return equation_lines(
        [Equation(name, tuple(printer.pieces(cell))) for name, cell in zip(names, cells, strict=True)]
    )


def base_acceleration(context: Context) -> list[Any]:
    """-g_0 in the axes of frame 0."""
    robot = context.robot
    if robot.gravity is None:
        return [sympy.S.Zero] * 3
    g = [expression_to_sympy(cell) for cell in robot.gravity]
    turn = [[expression_to_sympy(robot.base[r][c]) for c in range(3)] for r in range(3)]
    return [sympy.Add(*(-turn[r][c] * g[r] for r in range(3))) for c in range(3)]


def _generic(context: Context, recursion: Recursion) -> Iterator[Block]:
    _ = context.text
    kinds = {joint.is_revolute for joint in context.robot.joints}
    if True in kinds:
        yield Paragraph(_("A revolute joint, outward from $i = 1$ and back inward from the last link:"))
        yield _equations(recursion, Subject.anyone(revolute=True))
    if False in kinds:
        yield Paragraph(_("A prismatic joint, outward from $i = 1$ and back inward from the last link:"))
        yield _equations(recursion, Subject.anyone(revolute=False))


def _equations(recursion: Recursion, subject: Subject) -> Rows:
    return Rows((*recursion.outward(subject), *recursion.inward(subject)))


def _remarks(context: Context) -> Iterator[Block]:
    _ = context.text
    robot = context.robot
    opposed = ", ".join(f"${i}$" for i, joint in enumerate(robot.joints, 1) if joint.sign < 0)
    if opposed:
        yield Paragraph(
            _(
                "The variables of these joints count against their axes: %(joints)s. For them $-\\dot{q}_i$, "
                "$-\\ddot{q}_i$ and $-\\tau_i$ stand in place of $\\dot{q}_i$, $\\ddot{q}_i$ and $\\tau_i$.",
                joints=opposed,
            )
        )
    if any(has_rotor(link) for link in robot.links):
        yield Paragraph(
            _(
                "The rotors of the motors are no part of this recursion, which is that of the links; the inertia "
                "matrix and the equations of motion contain them."
            )
        )
    added = list(_added_torques(context))
    if added:
        yield Paragraph(_("Friction and armatures add to the torques of the joints:"))
        yield Rows(tuple(equation_lines(added)))


def _added_torques(context: Context) -> Iterator[Equation]:
    """Friction and reflected inertia, joint by joint."""
    for i, (joint, link) in enumerate(zip(context.robot.joints, context.robot.links, strict=True), 1):
        cells = (link.viscous, link.coulomb, link.armature)
        if all(cell == ZERO for cell in cells):
            continue
        viscous, coulomb, armature = map(expression_to_sympy, cells)
        rate, growth = (sympy.Symbol(name(joint.variable)) for name in (velocity_name, acceleration_name))
        torque = armature * growth + viscous * rate + coulomb * sympy.sign(rate)
        symbol = context.symbols.torque(i)
        yield Equation(Box(f"\\Delta {symbol.tex}", symbol.width + 9.0), tuple(context.printer.pieces(torque)))


def _constants(context: Context, recursion: Recursion) -> Iterator[Block]:
    _ = context.text
    words = {True: _("revolute"), False: _("prismatic")}
    for i, joint in enumerate(context.robot.joints, 1):
        yield Paragraph(_("Link %(index)s, its joint %(kind)s:", index=i, kind=words[joint.is_revolute]))
        yield link_constants(context, recursion, i)


def _written_out(context: Context, recursion: Recursion) -> Iterator[Block]:
    _ = context.text
    subjects = [_subject(context, i) for i in range(1, context.robot.n + 1)]
    outward = tuple(line for subject in subjects for line in recursion.outward(subject))
    inward = tuple(line for subject in reversed(subjects) for line in recursion.inward(subject))
    yield Steps(_("Outward, link by link"), (Rows(outward),))
    yield Steps(_("Inward, link by link"), (Rows(inward),))


def _subject(context: Context, i: int) -> Subject:
    joint, glyph = context.robot.joints[i - 1], context.notation.glyph
    return Subject(
        index=str(i),
        before=str(i - 1),
        after=str(i + 1),
        revolute=joint.is_revolute,
        sign=joint.sign,
        rate=glyph(velocity_name(joint.variable)).box,
        acceleration=glyph(acceleration_name(joint.variable)).box,
        torque=context.symbols.torque(i),
        last=i == context.robot.n,
    )
