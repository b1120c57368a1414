"""The part about a motion plan: segments, largest values, how coefficients of polynomials are found, formulas."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from sympy import Expr, Float, Integer, Matrix, Poly, Rational, Symbol, ff, latex

from derive.arrays import Array
from derive.handouts.figure.drawing import Drawing
from derive.handouts.figure.panels import Panel, Panels
from derive.handouts.layout.lines import Equation, equation_lines
from derive.handouts.notation.pieces import Box, concatenate
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Document, Figure, Paragraph, Rows, Section, Steps, Table

UNIT = Symbol("u")  # time since a piece began, in units of its length
HAND_SPLINE = "spline of the hand"  # what a spline of the end effector is called among the profiles
_DERIVATIVES = ("s", "s'", "s''", "s'''")  # the way from 0 to 1 in unit time, and its derivatives by that
# What is drawn from the top, with the units of revolute and of prismatic joints.
_QUANTITIES = (
    ("q", "\\mathrm{rad}", "\\mathrm{m}"),
    ("\\dot{q}", "\\mathrm{rad/s}", "\\mathrm{m/s}"),
    ("\\ddot{q}", "\\mathrm{rad/s}^2", "\\mathrm{m/s}^2"),
    ("\\tau", "\\mathrm{N\\,m}", "\\mathrm{N}"),
)
_LONGEST_EXACT = 48  # letters of LaTeX of an exact value that stands beside its decimals
_DIGITS = 6


@dataclass(frozen=True, slots=True)
class PlannedPiece:
    """A formula of a joint."""

    start: Expr  # when it begins, since its segment did [s]
    end: Expr  # when it ends [s]
    value: Expr  # position in the time since the segment began, in the symbol ``t``


@dataclass(frozen=True, slots=True)
class PlannedJoint:
    """A joint in a segment."""

    pieces: tuple[PlannedPiece, ...]  # its formulas; none where there are too many to print
    count: int  # how many there are
    speed: Expr  # its largest velocity with its sign, exact where that is known [rad/s or m/s]
    acceleration: Expr  # its largest acceleration
    torque: float | None  # its largest torque with its sign [N m or N]; None where the robot has no dynamics, as below
    rms: float | None = None  # root of the mean of its square
    power: float | None = None  # its largest power with its sign [W]
    work: float | None = None  # its mechanical work [J]


@dataclass(frozen=True, slots=True)
class PlannedSegment:
    """The way from one point to the next."""

    name: str  # ``rest -> A``
    duration: Expr  # how long it takes [s]
    joints: tuple[PlannedJoint, ...]  # what each joint does
    work: float | None  # mechanical work of all joints [J]; None where the robot has no dynamics

    @property
    def title(self) -> str:
        """Its name as it is printed."""
        return self.name.replace("->", "\N{RIGHTWARDS ARROW}").replace("$", "").replace("`", "")


@dataclass(frozen=True, slots=True)
class PlannedCurves:
    """What joints do over time."""

    times: Array  # [s], (k,)
    values: tuple[Array, ...]  # positions, velocities, accelerations and, where they are known, torques, (k, n) each


@dataclass(frozen=True, slots=True)
class PlannedMotion:
    """A motion in formulas and numbers."""

    segments: tuple[PlannedSegment, ...]  # one after the other
    # Names of the profiles that occur; of those that are polynomials from rest to rest the coefficients in unit time,
    # from the constant on, else nothing.
    profiles: Mapping[str, Sequence[int]]
    curves: PlannedCurves | None = None  # what is drawn; None for nothing


def plan_section(context: Context, motion: PlannedMotion) -> Section:
    """The part."""
    return Section("plan", context.text("Motion plan"), tuple(_blocks(context, motion)))


def plan_sheet(context: Context, title: str, digest: str, sections: tuple[Section, ...]) -> Document:
    """A document about a motion plan."""
    _ = context.text
    return Document(
        title=title,
        subtitle=_("Motion plan"),
        name=context.robot.name,
        language=_.language,
        digest=digest,
        version=context.version,
        footer=_("derive %(version)s, motion plan `%(digest)s`", version=context.version, digest=digest[:16]),
        sections=sections,
    )


def _blocks(context: Context, motion: PlannedMotion) -> Iterator[Block]:
    _ = context.text
    total = sum((segment.duration for segment in motion.segments), Integer(0))
    yield Paragraph(
        _(
            "Duration $%(time)s$ s. Largest velocities and accelerations, with their signs, in rad and m:",
            time=_exact(context, total),
        )
    )
    yield _speeds(context, motion)
    if any(segment.work is not None for segment in motion.segments):
        yield Paragraph(_("Largest torques [N m] and forces [N], and the work of all joints [J]:"))
        yield _torques(context, motion)
    if any(joint.rms is not None for segment in motion.segments for joint in segment.joints):
        words = _("Of each joint the root mean square of the torque or force, the largest power, and the work:")
        yield Paragraph(words)
        yield _powers(context, motion)
    if motion.curves is not None:
        yield Figure(_plots(context, motion, motion.curves), _("What the joints do over time."))
    others = _other_profiles(context)
    for profile, coefficients in motion.profiles.items():
        if coefficients:
            title = _("How the polynomial of degree %(degree)s is found", degree=len(coefficients) - 1)
            yield Steps(title, (*_derivation(context, coefficients),))
        elif profile in others:
            yield others[profile]
    yield Steps(_("Formulas of the joints"), (*_formulas(context, motion),))


def _speeds(context: Context, motion: PlannedMotion) -> Block:
    _ = context.text
    header = (_("segment"), "$T$ [s]", _("joint"), _("velocity"), _("acceleration"))
    rows = []
    for segment in motion.segments:
        cells = (segment.title, f"${_exact(context, segment.duration)}$")
        for variable, joint in zip(context.robot.joints, segment.joints, strict=True):
            if joint.speed != 0 or joint.acceleration != 0:
                symbol = context.notation.glyph(variable.variable).box.tex
                values = (f"${_exact_and_decimal(context, value)}$" for value in (joint.speed, joint.acceleration))
                rows.append((*cells, f"${symbol}$", *values))
                cells = ("", "")
        if cells[0]:
            rows.append((*cells, "", _("none moves"), ""))
    return Table(header, tuple(rows), long=len(rows) > 30)


def _torques(context: Context, motion: PlannedMotion) -> Block:
    _ = context.text
    symbols = (f"${context.symbols.torque(i).tex}$" for i in range(1, context.robot.n + 1))
    rows = tuple(
        (
            segment.title,
            *(f"${_decimal(context, joint.torque or 0.0)}$" for joint in segment.joints),
            f"${_decimal(context, segment.work or 0.0)}$",
        )
        for segment in motion.segments
    )
    return Table((_("segment"), *symbols, _("work")), rows, long=len(rows) > 30)


def _powers(context: Context, motion: PlannedMotion) -> Block:
    _ = context.text
    rows = []
    for segment in motion.segments:
        title = segment.title
        for i, joint in enumerate(segment.joints, 1):
            symbol = context.symbols.torque(i).tex
            numbers = (f"${_decimal(context, number or 0.0)}$" for number in (joint.rms, joint.power, joint.work))
            rows.append((title, f"${symbol}$", *numbers))
            title = ""
    header = (_("segment"), "", _("root mean square"), _("power [W]"), _("work [J]"))
    return Table(header, tuple(rows), long=len(rows) > 30)


def _plots(context: Context, motion: PlannedMotion, curves: PlannedCurves) -> Drawing:
    """Panels of positions, velocities, accelerations and torques, of angles and of slides beside each other."""
    joints = context.robot.joints
    kinds = [[j for j, joint in enumerate(joints) if joint.is_revolute is kind] for kind in (True, False)]
    rows = []
    for values, (letter, *units) in zip(curves.values, _QUANTITIES, strict=False):
        panels = (
            Panel(f"{letter}\\,[{unit}]", tuple((j, values[:, j]) for j in kind))
            for kind, unit in zip(kinds, units, strict=True)
            if kind
        )
        rows.append(tuple(panels))
    ends = np.cumsum([float(segment.duration) for segment in motion.segments])
    names = tuple(context.notation.glyph(joint.variable).box.tex for joint in joints)
    write = LatexPrinter(replace(context.notation, decimals=True)).latex
    figure = Panels(
        curves.times, tuple(rows), tuple(map(float, ends[:-1])), names, lambda x: write(Rational(f"{x:.6g}"))
    )
    return figure.drawing(context.text("What the joints do over time."))


def _derivation(context: Context, coefficients: Sequence[int]) -> Iterator[Block]:
    """From rest to rest in unit time: conditions at the ends, their linear system, and its solution."""
    _ = context.text
    k = len(coefficients) // 2
    yield Paragraph(
        _(
            "With $u = (t - t_0)/T$ a joint that goes from rest to rest is at $q = q_0 + (q_1 - q_0)\\,s(u)$, "
            "$s = \\sum_i a_i u^i$, with"
        )
    )
    starts = [f"{letter}(0) = 0" for letter in _DERIVATIVES[:k]]
    ends = [f"{letter}(1) = {0 if order else 1}" for order, letter in enumerate(_DERIVATIVES[:k])]
    yield Rows((",\\quad ".join(starts), ",\\quad ".join(ends)))
    lower = [f"a_{{{i}}} = 0" for i in range(k)]
    yield Paragraph(_("The conditions at the start give the first coefficients, those at the end the others:"))
    system = Matrix(k, k, lambda order, i: ff(k + i, order))
    unknowns = Matrix([Symbol(f"a_{k + i}") for i in range(k)])
    right = Matrix([1] + [0] * (k - 1))
    product = "".join(latex(part, mat_str="bmatrix", mat_delim="") for part in (system, unknowns))
    yield Rows((",\\quad ".join(lower), f"{product} = {latex(right, mat_str='bmatrix', mat_delim='')}"))
    s = Poly.from_list(list(reversed(coefficients)), UNIT)
    lines = [
        f"{letter} = {latex(poly.as_expr(), order='rev-lex')}"
        for letter, poly in zip(_DERIVATIVES, (s, s.diff(UNIT), s.diff(UNIT).diff(UNIT)), strict=False)
    ]
    yield Paragraph(
        _("Hence, with the derivatives by $u$, to be divided by $T$ for velocities and by $T^2$ for accelerations:")
    )
    yield Rows(tuple(lines))
    yield Paragraph(_("Where a joint does not stop at a point, its velocity there takes the place of the zero."))


def _other_profiles(context: Context) -> dict[str, Steps]:
    """Profiles that are no polynomials from rest to rest."""
    _ = context.text
    blend = ("t_b = T - \\frac{D}{V},\\quad \\frac{D}{T} < V \\le \\frac{2D}{T},\\quad a = \\frac{V}{t_b}",)
    cosine = (
        "s = \\frac{1 - \\cos \\pi u}{2},\\quad s' = \\frac{\\pi}{2} \\sin \\pi u,"
        "\\quad s'' = \\frac{\\pi^2}{2} \\cos \\pi u",
    )
    continuity = (
        "\\frac{v_{j-1}}{h_{j-1}} + 2 \\left(\\frac{1}{h_{j-1}} + \\frac{1}{h_j}\\right) v_j + \\frac{v_{j+1}}{h_j}"
        " = 3 \\left(\\frac{\\sigma_{j-1}}{h_{j-1}} + \\frac{\\sigma_j}{h_j}\\right)",
    )
    speeding = _(
        "A joint that goes the distance $D = |q_1 - q_0|$ in the time $T$ speeds up with the acceleration $a$ until "
        "$t_b$, goes on with the velocity $V$, and slows down as it has sped up:"
    )
    unit = _("With $u = (t - t_0)/T$ and $q = q_0 + (q_1 - q_0)\\,s(u)$:")
    points = _(
        "Cubic polynomials between the points, with intervals of lengths $h_j$ and slopes $\\sigma_j$. Accelerations "
        "are continuous where the velocities $v_j$ at the points, zero at both ends, satisfy"
    )
    following = _(
        "The three coordinates of the end effector and the three components of its rotation vector are such splines. "
        "The joints follow by the inverse kinematics, with the linear and angular velocity $\\nu$ of the end effector:"
    )
    rates = ("\\dot{q} = J^{-1}\\,\\nu,\\quad \\ddot{q} = J^{-1} \\left(\\dot{\\nu} - \\dot{J}\\,\\dot{q}\\right)",)
    spline = (Paragraph(points), Rows(continuity))
    return {
        "trapezoidal": Steps(_("Trapezoids of velocity"), (Paragraph(speeding), Rows(blend))),
        "harmonic": Steps(_("Harmonic motion"), (Paragraph(unit), Rows(cosine))),
        "spline": Steps(_("How the spline is found"), spline),
        HAND_SPLINE: Steps(_("How the spline is found"), (*spline, Paragraph(following), Rows(rates))),
    }


def _formulas(context: Context, motion: PlannedMotion) -> Iterator[Block]:
    _ = context.text
    yield Paragraph(_("In the time $t$ since the segment began [s]:"))
    for segment in motion.segments:
        yield Paragraph(f"{segment.title}, $0 \\le t \\le {_exact(context, segment.duration)}$")
        equations, counts = [], set()
        for joint, found in zip(context.robot.joints, segment.joints, strict=True):
            symbol = context.notation.glyph(joint.variable).box
            for piece in found.pieces:
                left = symbol if len(found.pieces) == 1 else concatenate(symbol, _span(context, piece))
                equations.append(Equation(left, tuple(context.printer.pieces(_rational(piece.value)))))
            counts |= set() if found.pieces else {found.count}
        if equations:
            yield Rows(tuple(equation_lines(equations)))
        for count in sorted(counts):
            yield Paragraph(_("The other joints: %(count)s polynomials each, between places on the way.", count=count))


def _span(context: Context, piece: PlannedPiece) -> Box:
    start, end = (_exact(context, value) for value in (piece.start, piece.end))
    return Box(f"\\,\\big|_{{{start} \\le t \\le {end}}}", 12.0 + 4.5 * len(start + end))


def _rational(value: Expr) -> Expr:
    """Floats as fractions, which the printer rounds."""
    return value.xreplace({number: Rational(float(number)) for number in value.atoms(Float)})


def _exact(context: Context, value: Expr) -> str:
    return context.printer.latex(_rational(value))


def _decimal(context: Context, value: float) -> str:
    """Six significant digits."""
    printer = LatexPrinter(replace(context.notation, decimals=True))
    return printer.latex(Rational(f"{value:.{_DIGITS}g}"))


def _exact_and_decimal(context: Context, value: Expr) -> str:
    exact, decimal = _exact(context, value), _decimal(context, float(value))
    if exact == decimal or value.has(Float) or len(exact) > _LONGEST_EXACT:
        return decimal
    return f"{exact} = {decimal}"
