"""The report of an identification as a web page: joints, base parameters, residuals over time and against speed."""

from collections.abc import Iterator

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.drawing import Color, Drawing, Item, Label, Path
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.page.writer import page
from derive.handouts.sheet.document import Document, Figure, Paragraph, Section, Table
from derive.handouts.sheet.language import Text
from derive.identification.identified import JOINT_HEAD, PARAMETER_HEAD, Identified
from derive.lecture.sympy_conversion import expression_to_sympy

WIDTH, HEIGHT, GAP, EDGE = 220.0, 90.0, 50.0, 20.0  # of a panel, between two, and around them [pt]
DOT = 1.6  # diameter of a row of the log [pt]
FRAME: Color = (0.6, 0.6, 0.6)
RESIDUAL: Color = (0.1, 0.3, 0.6)


def report_page(found: Identified) -> str:
    """One HTML file that needs no network."""
    printer = LatexPrinter(Notation.of(found.source))
    symbols = [f"${printer.latex(expression_to_sympy(formula))}$" if formula else "" for formula in found.formulas]
    rows = [(*row[:-1], symbol) for row, symbol in zip(found.parameter_rows(), symbols, strict=True)]
    about = f"{found.rows} rows, method `{found.method}`. Residuals are root mean squares in N m or N."
    notes = [Paragraph(text) for text in (about, *found.notes)]
    named = "Each base parameter in SI units, called by the parameter that takes the others over"
    what = f"{named}, with 1.96 standard deviations; `kept` is what the log does not excite."
    sections = (
        Section("joints", "Torques and residuals", (*notes, Table(JOINT_HEAD, tuple(found.joint_rows())))),
        Section("base", "Base parameters", (Paragraph(what), Table(PARAMETER_HEAD, tuple(rows), long=True))),
        Section("residuals", "Residuals", tuple(_figures(found))),
    )
    document = Document(
        title=found.robot.title or found.robot.name,
        subtitle="Identification",
        name=found.robot.name,
        digest=found.source.digest,
        footer=f"Parameters of `{found.robot.name}` from a log",
        sections=sections,
    )
    return page(document, Text())


def _figures(found: Identified) -> Iterator[Figure]:
    time, speed, residual = found.shown
    for j, joint in enumerate(found.robot.joints):
        panels = ((time, "t"), (speed[:, j], r"\dot{q}"))
        items = [item for k, (x, name) in enumerate(panels) for item in _panel(k, x, residual[:, j], name)]
        drawing = Drawing(2 * WIDTH + GAP + 3 * EDGE, HEIGHT + 2 * EDGE, tuple(items), f"residuals of {joint.label}")
        yield Figure(drawing, f"Residual of `{joint.label}` over time (left) and against its speed (right)")


def _panel(place: int, x: Array, y: Array, name: str) -> Iterator[Item]:
    """Dots of y over x in a frame, with the line of zero and the ends of both axes."""
    left, low = 2 * EDGE + place * (WIDTH + GAP), EDGE
    (x0, x1), top = (float(x.min()), float(x.max())), float(np.abs(y).max()) or 1.0
    across, middle = WIDTH / ((x1 - x0) or 1.0), low + HEIGHT / 2
    yield Path(((left, low), (left + WIDTH, low), (left + WIDTH, low + HEIGHT), (left, low + HEIGHT)), True, FRAME)
    yield Path(((left, middle), (left + WIDTH, middle)), stroke=FRAME)
    for a, b in zip(x, y, strict=True):
        dot = (left + across * (float(a) - x0), middle + float(b) / top * HEIGHT / 2)
        yield Path((dot, dot), stroke=RESIDUAL, width=DOT)
    for at, value in ((left, x0), (left + WIDTH, x1)):
        yield Label((at, low - 2), f"{value:.3g}", (0, 1))
    yield Label((left + WIDTH / 2, low - 2), name, (0, 1))
    for sign in (-1, 1):
        yield Label((left - 2, middle + sign * (HEIGHT / 2 - 4)), f"{sign * top:.2g}", (1, 0))
