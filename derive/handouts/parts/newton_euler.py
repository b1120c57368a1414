"""The part with the Newton-Euler recursion: equations for the joint types that occur, and the data of the links.

The vectors of link i are in frame i (Luh, Walker and Paul 1980; Fu, Gonzalez and Lee, Robotics, section 3.3; for the
modified convention Craig, Introduction to Robotics, section 6.5). In the standard convention joint i moves about z of
frame i-1 and p*_i = o_i - o_{i-1} is constant in frame i; in the modified one it moves about z of frame i, and p_i is
constant in frame i-1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from derive.handouts.layout.lines import Equation, break_lines, equated, equation_lines, fits, matrix, pack
from derive.handouts.notation import pieces as typeset
from derive.handouts.notation.pieces import Box, TexPiece, bracketed, concatenate, italic, joined, script, signed_sum
from derive.handouts.notation.printer import LatexPrinter, PlainPrinter
from derive.handouts.notation.symbols import Symbols
from derive.handouts.parts.dynamics import has_rotors
from derive.handouts.sheet.context import Context, component_namer, entry_namer, matrix_lines, textbook
from derive.handouts.sheet.document import Block, Entry, Paragraph, Rows, SheetFormula, Steps
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.robot.expression import ZERO
from derive.robot.names import acceleration_name, velocity_name


def newton_euler(context: Context) -> Iterator[Block]:
    """The recursion: equations of the joint types that occur, constants of every link, all of it written out."""
    _ = context.text
    recursion = Recursion(context.is_standard, context.symbols)
    yield Paragraph(_introduction(context))
    yield Paragraph(_("The base is at rest, gravity acts as an acceleration of the base, and nothing loads the end."))
    start = textbook("recursion_start", after_last=context.robot.n + 1)
    base = [[tuple(context.printer.pieces(cell))] for cell in context.entries.base_acceleration]
    symbol = Box("\\mathbf{a}_{0}", 11.0)
    yield Rows((*start.lines, *matrix_lines(symbol, base, lambda k, _: Box(f"({symbol.tex})_{{{k}}}", 25.0))))
    for is_revolute in sorted({joint.is_revolute for joint in context.robot.joints}, reverse=True):
        if is_revolute:
            yield context.paragraph("A revolute joint, outward from $i = 1$ and back inward from the last link:")
        else:
            yield context.paragraph("A prismatic joint, outward from $i = 1$ and back inward from the last link:")
        letters = JointLetters.any_joint(is_revolute)
        yield Rows((*recursion.outward(letters), *recursion.inward(letters)))
    yield from _remarks(context)
    words = {True: _("revolute"), False: _("prismatic")}
    for i, row in enumerate(context.robot.joints, 1):
        yield context.paragraph("Link %(index)s, its joint %(kind)s:", index=i, kind=words[row.is_revolute])
        yield _link_data(context, recursion, i)
    if context.steps:
        joints = [JointLetters.of(context, i) for i in range(1, context.robot.n + 1)]
        outward = tuple(line for letters in joints for line in recursion.outward(letters))
        inward = tuple(line for letters in reversed(joints) for line in recursion.inward(letters))
        yield Steps(_("Outward, link by link"), (Rows(outward),))
        yield Steps(_("Inward, link by link"), (Rows(inward),))


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
    if context.is_standard:
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


def _remarks(context: Context) -> Iterator[Block]:
    """What the equations for any joint leave out: signs of variables, rotors, friction and armatures."""
    robot = context.robot
    if opposed := ", ".join(f"${i}$" for i, joint in enumerate(robot.joints, 1) if joint.sign < 0):
        yield context.paragraph(
            "The variables of these joints count against their axes: %(joints)s. For them $-\\dot{q}_i$, "
            "$-\\ddot{q}_i$ and $-\\tau_i$ stand in place of $\\dot{q}_i$, $\\ddot{q}_i$ and $\\tau_i$.",
            joints=opposed,
        )
    if has_rotors(robot):
        yield context.paragraph(
            "This recursion covers the links only; the rotors of the motors are included in the inertia matrix and "
            "the equations of motion."
        )
    added = []
    for i, link in enumerate(robot.links, 1):
        if any(cell != ZERO for cell in (link.viscous, *link.dry, link.armature)):
            armature = expression_to_sympy(link.armature) * context.entries.model.qdd[i - 1]
            torque, symbol = armature + context.entries.friction(i), context.symbols.torque(i)
            name = Box(f"\\Delta {symbol.tex}", symbol.width + 9.0)
            added.append(Equation(name, tuple(context.printer.pieces(torque))))
    yield from context.announced("Friction and armatures add to the torques of the joints:", equation_lines(added))


# A matrix, vector or number of a link: what it is called, its entries, and what prints them; the printer of the robot's
# data prints every digit.
_Constant = tuple[Box, list[list[Expr]], LatexPrinter]


def _link_data(context: Context, recursion: Recursion, i: int) -> SheetFormula:
    """R_i^{i-1}, p_i, r_i, m_i and I_i of link i (from 1), one formula."""
    lines: list[str] = []
    shared, entries, blanks, python = list[Box](), list[Entry](), list[str](), PlainPrinter().doprint
    for symbol, cells, printer in _constants(context, recursion, i):
        rows = [[joined(printer.pieces(cell)) for cell in row] for row in cells]
        box = equated(symbol, rows[0][0] if len(rows) == 1 else matrix(rows))
        namer = entry_namer(symbol) if len(cells[0]) > 1 else component_namer(symbol)
        named = [(namer(r, c), cell) for r, row in enumerate(cells, 1) for c, cell in enumerate(row, 1)]
        if len(cells) == 1:
            named = [(symbol, cells[0][0])]
        if fits(box, len(rows)):
            shared.append(box)
        else:
            lines += equation_lines(Equation(name, tuple(printer.pieces(cell))) for name, cell in named if cell != 0)
        entries += (Entry(name.tex, printer.latex(cell), python(cell)) for name, cell in named)
        blanks.append(symbol.tex)
    task = context.text("Write the constants of each link that the recursion needs.")
    return SheetFormula((Rows((*pack(shared), *lines)),), entries=lambda: entries, task=task, blanks=tuple(blanks))


def _constants(context: Context, recursion: Recursion, i: int) -> Iterator[_Constant]:
    index, link, row = str(i), context.robot.links[i - 1], context.entries.A(i)
    rotation = [[row.entry(r, c) for c in (1, 2, 3)] for r in (1, 2, 3)]
    yield context.symbols.frame("R", i, i - 1), rotation, context.printer
    # p leads from o_{i-1} to o_i: in frame i (standard), where it is constant, or in frame i-1 (modified)
    back = context.entries.transform(i, i - 1) if context.is_standard else None
    p = [row.entry(r, 4) if back is None else -back.entry(r, 4) for r in (1, 2, 3)]
    yield recursion.offset(index), [[cell] for cell in p], context.printer
    t = link.inertia
    tensor = ((t.xx, t.xy, t.xz), (t.xy, t.yy, t.yz), (t.xz, t.yz, t.zz))
    data = LatexPrinter(context.data.notation)
    for symbol, cells in (
        (com(index), [[cell] for cell in link.com]),
        (script(italic("m"), italic(index)), [[link.mass]]),
        (vector("I", index), [list(row) for row in tensor]),
    ):
        yield symbol, [[expression_to_sympy(cell) for cell in row] for row in cells], data


# -- the recursion as equations: for any joint, or for one joint of the robot

_TIMES = Box(" \\times ", typeset.RELATION_WIDTH)
_OPEN, _CLOSE = Box("(", typeset.BRACKET_WIDTH), Box(")", typeset.BRACKET_WIDTH)
_TWICE = italic("2")
_OMEGA = Box("\\boldsymbol{\\omega}", 8.0)

Term = tuple[int, "Box | tuple[TexPiece, ...]"]  # sign and absolute value; in pieces where it may be broken over lines
Sides = tuple[Box, list[Term]]  # left side of an equation, and the terms of the right one


@dataclass(frozen=True)
class JointLetters:
    """How the recursion calls a joint and the links on both sides of it."""

    index: str  # its index: ``i`` or a number
    before: str  # the index before
    after: str  # the index after
    is_revolute: bool  # whether the joint turns
    sign: int  # +1 or -1, how its variable counts
    rate: Box  # its velocity
    acceleration: Box  # its acceleration
    torque: Box  # its torque or force
    is_last: bool = False  # whether no link follows

    @classmethod
    def any_joint(cls, is_revolute: bool) -> JointLetters:
        """Joint i."""
        rate, acceleration = (script(Box(f"{dots}{{q}}", 5.5), italic("i")) for dots in ("\\dot", "\\ddot"))
        return cls("i", "i-1", "i+1", is_revolute, 1, rate, acceleration, script(Box("\\tau", 5.0), italic("i")))

    @classmethod
    def of(cls, context: Context, i: int) -> JointLetters:
        """A joint of a robot, from 1."""
        joint, glyph = context.robot.joints[i - 1], context.notation.glyph
        rate, acceleration = (glyph(name(joint.variable)).box for name in (velocity_name, acceleration_name))
        torque, is_last = context.symbols.torque(i), i == context.robot.n
        names = str(i), str(i - 1), str(i + 1)
        return cls(*names, joint.is_revolute, joint.sign, rate, acceleration, torque, is_last)


@dataclass(frozen=True)
class Recursion:
    """The equations in one convention."""

    is_standard: bool  # whether the convention is the standard one
    symbols: Symbols  # names of matrices

    def offset(self, index: str) -> Box:
        """The vector p from o_{i-1} to o_i, with a star in the standard convention."""
        return script(Box("\\mathbf{p}", 6.5), italic(index), Box("*", 5.0) if self.is_standard else typeset.EMPTY)

    def outward(self, joint: JointLetters) -> list[str]:
        """Motion of link i from that of link i-1, and the force and moment that this motion takes."""
        i = joint.index
        w, wd, a = _motion(i)
        center, inertia = vector("a", f"c_{{{i}}}"), vector("I", i)
        return _lines(
            [
                *self._motion_of_link(joint),
                (center, [(1, a), *_rotational(w, wd, com(i))]),
                (vector("F", i), [(1, concatenate(script(italic("m"), italic(i)), center))]),
                (vector("N", i), [(1, concatenate(inertia, wd)), (1, concatenate(w, _TIMES, bracketed(inertia, w)))]),
            ]
        )

    def inward(self, joint: JointLetters) -> list[str]:
        """Force and moment that link i receives through its joint, and the torque of the joint."""
        i = joint.index
        back = self.symbols.frame("R", joint.after, i)
        force, moment = vector("f", i), vector("n", i)
        resultant, resultant_moment = vector("F", i), vector("N", i)
        p, r = self.offset(i if self.is_standard else joint.after), com(i)
        arm = bracketed(p, Box(" + ", 12.3), r) if self.is_standard else r
        z = vector("z", "0")
        axis = concatenate(self.symbols.frame("R", joint.before, i), z) if self.is_standard else z
        forces: list[Term] = [(1, resultant)]
        moments: list[Term] = [(1, concatenate(arm, _TIMES, resultant)), (1, resultant_moment)]
        if not joint.is_last:
            carried = concatenate(back, vector("f", joint.after))
            forces = [(1, carried), *forces]
            behind = concatenate(back, vector("n", joint.after)), concatenate(p, _TIMES, bracketed(carried))
            moments = [*((1, box) for box in behind), *moments]
        received = moment if joint.is_revolute else force
        torque = concatenate(Box(f"{received.tex}^{{T}}", received.width + 5.0), axis)
        return _lines([(force, forces), (moment, moments), (joint.torque, [(joint.sign, torque)])])

    def _motion_of_link(self, joint: JointLetters) -> Iterator[Sides]:
        """The motion of link i; its joint moves about z of frame i-1 (standard) or of frame i (modified)."""
        w, wd, a = _motion(joint.index)
        w0, wd0, a0 = _motion(joint.before)
        turn, z, p = self.symbols.frame("R", joint.before, joint.index), vector("z", "0"), self.offset(joint.index)
        rate, acceleration = ((joint.sign, concatenate(box, z)) for box in (joint.rate, joint.acceleration))
        product = concatenate(joint.rate, w0 if self.is_standard else w, _TIMES, z)
        coriolis, twice = (joint.sign, product), (joint.sign, concatenate(_TWICE, product))
        turns: list[list[Term]] = [[rate], [acceleration, coriolis], []]  # what the joint adds to w, wd and a
        slides: list[list[Term]] = [[], [], [acceleration, twice]]
        to_w, to_wd, to_a = turns if joint.is_revolute else slides
        if self.is_standard:
            yield w, [_turned(turn, [(1, w0), *to_w])]
            yield wd, [_turned(turn, [(1, wd0), *to_wd])]
            yield a, [_turned(turn, [(1, a0), *to_a]), *_rotational(w, wd, p)]
        else:
            yield w, [_turned(turn, [(1, w0)]), *to_w]
            yield wd, [_turned(turn, [(1, wd0)]), *to_wd]
            yield a, [_turned(turn, [(1, a0), *_rotational(w0, wd0, p)]), *to_a]


def vector(letter: str, index: str) -> Box:
    """A vector or tensor of a link."""
    return script(Box(f"\\mathbf{{{letter}}}", 9.0), italic(index))


def com(index: str) -> Box:
    """The vector r from o_i to the centre of mass of link i."""
    return vector("r", f"c_{{{index}}}")


def _motion(index: str) -> tuple[Box, Box, Box]:
    """Angular velocity and acceleration of link i, acceleration of its origin."""
    acceleration = Box(f"\\dot{{{_OMEGA.tex}}}", _OMEGA.width)
    return script(_OMEGA, italic(index)), script(acceleration, italic(index)), vector("a", index)


def _rotational(w: Box, wd: Box, r: Box) -> list[Term]:
    """The acceleration of a point at r due to rotation."""
    return [(1, concatenate(wd, _TIMES, r)), (1, concatenate(w, _TIMES, bracketed(w, _TIMES, r)))]


def _turned(turn: Box, terms: list[Term]) -> Term:
    """R (a + b), or R a."""
    if len(terms) == 1:
        return 1, (TexPiece(turn), *_pieces(terms))
    return 1, (TexPiece(concatenate(turn, _OPEN)), *_pieces(terms, depth=1), TexPiece(_CLOSE))


def _pieces(terms: Iterable[Term], depth: int = 0) -> list[TexPiece]:
    values = ((sign < 0, (TexPiece(value),) if isinstance(value, Box) else value) for sign, value in terms)
    return signed_sum(values, depth)


def _lines(equations: Iterable[Sides]) -> list[str]:
    broken = (break_lines(equated(left), _pieces(terms)) for left, terms in equations)
    return [line for lines in broken for line in lines]
