"""The part about a motion plan: segments, largest values, how coefficients of polynomials are found, formulas."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from sympy import Expr, Float, Integer, Matrix, Poly, Rational, Symbol, ff, latex

from derive.arrays import Array
from derive.handouts.figure.drawing import Color, Drawing, Item, Label, Path, Point, label_width
from derive.handouts.layout.lines import Equation, equation_lines
from derive.handouts.notation.pieces import Box, concatenate
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Document, Figure, Paragraph, Rows, Section, Steps, Table
from derive.plans.profile import MOST_PRINTED, VALUES, Profile, basis
from derive.plans.segments import Segment, SegmentPeaks, formula
from derive.version import __version__

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
        digest=digest,
        footer=_("derive %(version)s, motion plan `%(digest)s`", version=__version__, digest=digest[:16]),
        sections=sections,
    )


def _blocks(
    context: Context, segments: Sequence[SegmentPeaks], profiles: Sequence[str], curves: Sequence[Array]
) -> Iterator[Block]:
    _ = context.text
    total = _exact(context, sum((peaks.segment.duration for peaks in segments), Integer(0)))
    yield context.paragraph(
        "Duration $%(time)s$ s. Largest velocities and accelerations, with their signs, in rad and m:", time=total
    )
    yield _speeds(context, segments)
    if any(peaks.loads for peaks in segments):
        yield context.paragraph("Largest torques [N m] and forces [N], and the work of all joints [J]:")
        symbols = (f"${context.symbols.torque(i).tex}$" for i in range(1, context.robot.dof + 1))
        numbers = ((peaks.segment, (*(load.peak for load in peaks.loads), peaks.work)) for peaks in segments)
        rows = tuple((_title(segment), *(f"${_decimal(context, x)}$" for x in row)) for segment, row in numbers)
        yield Table((_("segment"), *symbols, _("work")), rows, long=len(rows) > 30)
        yield context.paragraph(
            "Of each joint the root mean square of the torque or force, the largest power, and the work:"
        )
        cells = []
        for peaks in segments:
            title = _title(peaks.segment)
            for i, load in enumerate(peaks.loads, 1):
                values = (f"${_decimal(context, x)}$" for x in (load.rms, load.power, load.work))
                cells.append((title, f"${context.symbols.torque(i).tex}$", *values))
                title = ""
        header = (_("segment"), "", _("root mean square"), _("power [W]"), _("work [J]"))
        yield Table(header, tuple(cells), long=len(cells) > 30)
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
    return segment.name.replace("->", "\N{RIGHTWARDS ARROW}").replace("$", "").replace("`", "")


def _speeds(context: Context, segments: Sequence[SegmentPeaks]) -> Block:
    _ = context.text
    header = (_("segment"), "$T$ [s]", _("joint"), _("velocity"), _("acceleration"))
    rows = []
    for peaks in segments:
        cells = (_title(peaks.segment), f"${_exact(context, peaks.segment.duration)}$")
        for variable, *of_joint in zip(context.robot.variables, peaks.speeds, peaks.accelerations, strict=True):
            if any(peak.value != 0 for peak in of_joint):
                row = [*cells, f"${context.notation.glyph(variable.variable).box.tex}$"]
                for value in (peak.value for peak in of_joint):
                    exact, decimal = _exact(context, value), _decimal(context, float(value))
                    is_alone = exact == decimal or value.has(Float) or len(exact) > _LONGEST_EXACT
                    row.append(f"${decimal}$" if is_alone else f"${exact} = {decimal}$")
                rows.append(tuple(row))
                cells = ("", "")
        rows += [(*cells, "", _("none moves"), "")] if cells[0] else []
    return Table(header, tuple(rows), long=len(rows) > 30)


def _plots(context: Context, segments: Sequence[SegmentPeaks], times: Array, *curves: Array) -> Drawing:
    """Panels of positions, velocities, accelerations and torques, of angles and of slides beside each other."""
    joints = context.robot.variables
    kinds = [[j for j, joint in enumerate(joints) if joint.is_revolute is kind] for kind in (True, False)]
    rows = []
    for values, (letter, *units) in zip(curves, _QUANTITIES, strict=False):
        shown = ((kind, unit) for kind, unit in zip(kinds, units, strict=True) if kind)
        rows.append(tuple((f"{letter}\\,[{unit}]", tuple((j, values[:, j]) for j in kind)) for kind, unit in shown))
    ends = np.cumsum([float(peaks.segment.duration) for peaks in segments])
    names = tuple(context.notation.glyph(joint.variable).box.tex for joint in joints)
    figure = Panels(times, tuple(rows), tuple(map(float, ends[:-1])), names, partial(_decimal, context))
    return figure.drawing(context.text("What the joints do over time."))


def _derivation(context: Context, k: int) -> Iterator[Block]:
    """From rest to rest in unit time: k conditions at each end, their linear system, and its solution."""
    yield context.paragraph(
        "With $u = (t - t_0)/T$ a joint that goes from rest to rest is at $q = q_0 + (q_1 - q_0)\\,s(u)$, "
        "$s = \\sum_i a_i u^i$, with"
    )
    starts = [f"{letter}(0) = 0" for letter in _DERIVATIVES[:k]]
    ends = [f"{letter}(1) = {0 if order else 1}" for order, letter in enumerate(_DERIVATIVES[:k])]
    yield Rows((",\\quad ".join(starts), ",\\quad ".join(ends)))
    lower = [f"a_{{{i}}} = 0" for i in range(k)]
    yield context.paragraph("The conditions at the start give the first coefficients, those at the end the others:")
    system = Matrix(k, k, lambda order, i: ff(k + i, order))
    unknowns = Matrix([Symbol(f"a_{k + i}") for i in range(k)])
    right = Matrix([1] + [0] * (k - 1))
    product = "".join(latex(part, mat_str="bmatrix", mat_delim="") for part in (system, unknowns))
    yield Rows((",\\quad ".join(lower), f"{product} = {latex(right, mat_str='bmatrix', mat_delim='')}"))
    s = Poly.from_list(list(reversed(basis(k)[k])), UNIT)
    polynomials = zip(_DERIVATIVES, (s, s.diff(UNIT), s.diff(UNIT).diff(UNIT)), strict=False)
    yield context.paragraph(
        "Hence, with the derivatives by $u$, to be divided by $T$ for velocities and by $T^2$ for accelerations:"
    )
    yield Rows(tuple(f"{letter} = {latex(poly.as_expr(), order='rev-lex')}" for letter, poly in polynomials))
    yield context.paragraph("Where a joint does not stop at a point, its velocity there takes the place of the zero.")


def _other_profiles(context: Context) -> dict[str, Steps]:
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
    yield context.paragraph("In the time $t$ since the segment began [s]:")
    for segment in (peaks.segment for peaks in segments):
        yield Paragraph(f"{_title(segment)}, $0 \\le t \\le {_exact(context, segment.duration)}$")
        equations, counts = [], set()
        for joint, pieces in zip(context.robot.variables, segment.joints, strict=True):
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
            yield context.paragraph(
                "The other joints: %(count)s polynomials each, between places on the way.", count=count
            )


def _rational(value: Expr) -> Expr:
    """Floats as fractions, which the printer rounds."""
    return value.xreplace({number: Rational(float(number)) for number in value.atoms(Float)})


def _exact(context: Context, value: Expr) -> str:
    return context.printer.latex(_rational(value))


def _decimal(context: Context, value: float) -> str:
    return LatexPrinter(replace(context.notation, decimals=True)).latex(Rational(f"{value:.{_DIGITS}g}"))


# -- curves over time: panels below each other with one axis of time, and beside each other where units differ

HEIGHT = 74.0  # height of a panel [pt]
WIDTHS = {1: 330.0, 2: 185.0}  # width of a panel by the number of panels beside each other [pt]
LEFT, RIGHT, TOP, BOTTOM, GAP = 34.0, 8.0, 16.0, 46.0, 16.0  # room beside a panel, above, below, between two [pt]
PALE: Color = (0.82, 0.82, 0.82)

# Of curves, told apart with colour-blind eyes and on grey paper.
COLORS: tuple[Color, ...] = (
    (0.11, 0.31, 0.61), (0.76, 0.34, 0.10), (0.18, 0.49, 0.26), (0.54, 0.23, 0.56), (0.66, 0.53, 0.10),
    (0.30, 0.33, 0.38), (0.69, 0.19, 0.29), (0.13, 0.50, 0.56),
)  # fmt: skip
STEPS = (1.0, 2.0, 5.0, 10.0)  # between numbers at an axis, times a power of ten


Panel = tuple[str, tuple[tuple[int, Array], ...]]  # what curves are, with their unit, in LaTeX; colours and values (k,)


@dataclass(frozen=True)
class Panels:
    """Panels with one axis of time."""

    times: Array  # at which all curves are known, (k,)
    rows: tuple[tuple[Panel, ...], ...]  # panels beside each other, row by row; as many in each
    corners: tuple[float, ...]  # times at which something begins, marked by dashed lines
    names: tuple[str, ...]  # LaTeX of what each colour means
    write: Callable[[float], str]  # writes a number as LaTeX

    def drawing(self, title: str) -> Drawing:
        """The drawing."""
        across = len(self.rows[0])
        width = across * (LEFT + WIDTHS[across] + RIGHT)
        height = TOP + len(self.rows) * (HEIGHT + GAP) + BOTTOM
        items: list[Item] = []
        for i, row in enumerate(self.rows):
            for k, panel in enumerate(row):
                corner = LEFT + k * (LEFT + WIDTHS[across] + RIGHT), height - TOP - (i + 1) * HEIGHT - i * GAP
                items += self._panel(panel, corner, WIDTHS[across], is_last=i == len(self.rows) - 1)
        lengths = [16.0 + label_width(name) + 14.0 for name in self.names]
        x = (width - sum(lengths) + 14.0) / 2  # what each colour means, in the middle below all
        for color, (name, length) in enumerate(zip(self.names, lengths, strict=True)):
            items.append(Path(((x, 6.0), (x + 12.0, 6.0)), stroke=COLORS[color % len(COLORS)], width=1.2))
            items.append(Label((x + 16.0, 6.0), name, (-1, 0)))
            x += length
        return Drawing(width, height, tuple(items), title)

    def _panel(self, panel: Panel, corner: Point, width: float, *, is_last: bool) -> Iterator[Item]:
        (x, y), (latex, curves), start, end = corner, panel, float(self.times[0]), float(self.times[-1])
        # The values with a rim of 6 % above and below; what is constant but for rounding has a panel of height 2.
        values = [row for _, row in curves]
        low, high = min(float(row.min()) for row in values), max(float(row.max()) for row in values)
        if high - low < 1e-9 * max(abs(low), abs(high), 1e-3):
            low, high = low - 1.0, high + 1.0
        room = 0.06 * (high - low)
        low, high = low - room, high + room

        def _at(time: float, value: float) -> Point:
            return x + width * (time - start) / (end - start), y + HEIGHT * (value - low) / (high - low)

        for tick in _ticks(low, high, 4):
            yield Path((_at(start, tick), _at(end, tick)), stroke=PALE, width=0.3)
            yield Label((x - 3.0, _at(start, tick)[1]), self.write(tick), (1, 0))
        for time in self.corners:
            yield Path((_at(time, low), _at(time, high)), stroke=PALE, width=0.5, dashed=True)
        for color, row in curves:
            points = tuple(_at(float(t), float(value)) for t, value in zip(self.times, row, strict=True))
            yield Path(points, stroke=COLORS[color % len(COLORS)], width=0.9)
        yield Path(((x, y + HEIGHT), (x, y), (x + width, y)), width=0.5)
        yield Label((x + 2.0, y + HEIGHT + 3.0), latex, (-1, -1))
        if is_last:
            for tick in _ticks(start, end, 6):
                yield Path((_at(tick, low), (_at(tick, low)[0], y - 2.5)), width=0.4)
                yield Label((_at(tick, low)[0], y - 4.0), self.write(tick), (0, 1))
            yield Label((x + width / 2, y - 15.0), "t\\,[\\mathrm{s}]", (0, 1))


def _ticks(low: float, high: float, most: int) -> Sequence[float]:
    """Round numbers between two, so many at most."""
    # the smallest step 1, 2, 5 or 10 times a power of ten that gives no more numbers than there is room for
    least = (high - low) / most
    power = 10.0 ** math.floor(math.log10(least))
    step = next(step * power for step in STEPS if step * power >= least)
    first = math.ceil(low / step - 1e-9)
    return [float(np.round(k * step, 12)) for k in range(first, math.floor(high / step + 1e-9) + 1)]
