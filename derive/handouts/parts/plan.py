"""The part about a motion plan: segments, largest values, how coefficients of polynomials are found, formulas."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

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
from derive.plans.hermite import MOST_PRINTED, basis
from derive.plans.profile import VALUES, Profile
from derive.plans.segments import Segment, SegmentPeaks, formula

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


def plan_section(
    context: Context, segments: Sequence[SegmentPeaks], profiles: Sequence[str], curves: Sequence[Array] = ()
) -> Section:
    """The part; curves are times [s], (k,), then q, qd, qdd and, where they are known, torques, (k, n) each."""
    return Section("plan", context.text("Motion plan"), tuple(_blocks(context, segments, profiles, curves)))


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


def _blocks(
    context: Context, segments: Sequence[SegmentPeaks], profiles: Sequence[str], curves: Sequence[Array]
) -> Iterator[Block]:
    _ = context.text
    total = _exact(context, sum((peaks.segment.duration for peaks in segments), Integer(0)))
    yield Paragraph(
        _("Duration $%(time)s$ s. Largest velocities and accelerations, with their signs, in rad and m:", time=total)
    )
    yield _speeds(context, segments)
    if any(peaks.loads for peaks in segments):
        yield Paragraph(_("Largest torques [N m] and forces [N], and the work of all joints [J]:"))
        symbols = (f"${context.symbols.torque(i).tex}$" for i in range(1, context.robot.n + 1))
        numbers = ((peaks.segment, (*(load.peak for load in peaks.loads), peaks.work)) for peaks in segments)
        rows = tuple((_title(segment), *(f"${_decimal(context, x)}$" for x in row)) for segment, row in numbers)
        yield Table((_("segment"), *symbols, _("work")), rows, long=len(rows) > 30)
        words = _("Of each joint the root mean square of the torque or force, the largest power, and the work:")
        yield Paragraph(words)
        yield _powers(context, segments)
    if curves:
        yield Figure(_plots(context, segments, *curves), _("What the joints do over time."))
    others = _other_profiles(context)
    for name in profiles:
        if name in others:
            yield others[name]
        elif name in VALUES:
            k = VALUES[Profile(name)]
            title = _("How the polynomial of degree %(degree)s is found", degree=2 * k - 1)
            yield Steps(title, (*_derivation(context, k),))
    yield Steps(_("Formulas of the joints"), (*_formulas(context, segments),))


def _title(segment: Segment) -> str:
    """Its name as it is printed."""
    return segment.name.replace("->", "\N{RIGHTWARDS ARROW}").replace("$", "").replace("`", "")


def _speeds(context: Context, segments: Sequence[SegmentPeaks]) -> Block:
    _ = context.text
    header = (_("segment"), "$T$ [s]", _("joint"), _("velocity"), _("acceleration"))
    rows = []
    for peaks in segments:
        cells = (_title(peaks.segment), f"${_exact(context, peaks.segment.duration)}$")
        for variable, *of_joint in zip(context.robot.joints, peaks.speeds, peaks.accelerations, strict=True):
            if any(peak.value != 0 for peak in of_joint):
                symbol = context.notation.glyph(variable.variable).box.tex
                rows.append((*cells, f"${symbol}$", *(f"${_exact_and_decimal(context, p.value)}$" for p in of_joint)))
                cells = ("", "")
        if cells[0]:
            rows.append((*cells, "", _("none moves"), ""))
    return Table(header, tuple(rows), long=len(rows) > 30)


def _powers(context: Context, segments: Sequence[SegmentPeaks]) -> Block:
    _ = context.text
    rows = []
    for peaks in segments:
        title = _title(peaks.segment)
        for i, load in enumerate(peaks.loads, 1):
            symbol = context.symbols.torque(i).tex
            rows.append(
                (title, f"${symbol}$", *(f"${_decimal(context, x)}$" for x in (load.rms, load.power, load.work)))
            )
            title = ""
    header = (_("segment"), "", _("root mean square"), _("power [W]"), _("work [J]"))
    return Table(header, tuple(rows), long=len(rows) > 30)


def _plots(context: Context, segments: Sequence[SegmentPeaks], times: Array, *curves: Array) -> Drawing:
    """Panels of positions, velocities, accelerations and torques, of angles and of slides beside each other."""
    joints = context.robot.joints
    kinds = [[j for j, joint in enumerate(joints) if joint.is_revolute is kind] for kind in (True, False)]
    rows = []
    for values, (letter, *units) in zip(curves, _QUANTITIES, strict=False):
        panels = (
            Panel(f"{letter}\\,[{unit}]", tuple((j, values[:, j]) for j in kind))
            for kind, unit in zip(kinds, units, strict=True)
            if kind
        )
        rows.append(tuple(panels))
    ends = np.cumsum([float(peaks.segment.duration) for peaks in segments])
    names = tuple(context.notation.glyph(joint.variable).box.tex for joint in joints)
    write = LatexPrinter(replace(context.notation, decimals=True)).latex
    figure = Panels(times, tuple(rows), tuple(map(float, ends[:-1])), names, lambda x: write(Rational(f"{x:.6g}")))
    return figure.drawing(context.text("What the joints do over time."))


def _derivation(context: Context, k: int) -> Iterator[Block]:
    """From rest to rest in unit time: k conditions at each end, their linear system, and its solution."""
    _ = context.text
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
    s = Poly.from_list(list(reversed(basis(k)[k])), UNIT)
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


def _formulas(context: Context, segments: Sequence[SegmentPeaks]) -> Iterator[Block]:
    _ = context.text
    yield Paragraph(_("In the time $t$ since the segment began [s]:"))
    for segment in (peaks.segment for peaks in segments):
        yield Paragraph(f"{_title(segment)}, $0 \\le t \\le {_exact(context, segment.duration)}$")
        equations, counts = [], set()
        for joint, pieces in zip(context.robot.joints, segment.joints, strict=True):
            if len(pieces) > MOST_PRINTED:
                counts.add(len(pieces))
                continue
            symbol = context.notation.glyph(joint.variable).box
            for piece in pieces:
                span = [_exact(context, time - segment.start) for time in (piece.start, piece.end)]
                bar = Box(f"\\,\\big|_{{{span[0]} \\le t \\le {span[1]}}}", 12.0 + 4.5 * len("".join(span)))
                left = symbol if len(pieces) == 1 else concatenate(symbol, bar)
                equations.append(Equation(left, tuple(context.printer.pieces(_rational(formula(piece, segment))))))
        if equations:
            yield Rows(tuple(equation_lines(equations)))
        for count in sorted(counts):
            yield Paragraph(_("The other joints: %(count)s polynomials each, between places on the way.", count=count))


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
