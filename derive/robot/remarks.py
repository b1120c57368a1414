"""Remarks on a robot file that is accepted but surely holds a slip: degrees among radians, or a rounded pi/2.

An angle is exact in this program: ``1.5708`` is not pi/2, and its cosine is not 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import pi, tau

from derive.errors import path_text
from derive.robot.cells import Cells
from derive.robot.description import Description, Remark
from derive.robot.document import Document, KeyPath
from derive.robot.evaluate import evaluate
from derive.robot.expression import (
    Call,
    Expression,
    Name,
    add,
    children,
    contains_pi,
    is_constant,
    linear_terms,
    multiple_of_pi,
    multiply,
    names,
    number,
)
from derive.robot.validate import located_expressions

NEAR = 1e-3
"""Relative distance (absolute below 1) within which a number is taken for a rounded multiple of pi/12."""

TURNS_OF_A_JOINT = 2
"""Limits of up to so many turns to either side are those of real wrists; an angle of the table is within one."""

DEGREE_DECIMALS = 3
"""Among degrees only a number with so many decimals is taken for radians: 0.52 degrees is a calibrated angle."""


_LIKE_PI = ("Pi", "PI", "pI", "M_PI")

_PARAMETERS = "; numbers of parameters are in radians in every file"

_UNITS = ", or units: {angle: deg} for the whole file"


def remarks_on(document: Document, robot: Description) -> tuple[Remark, ...]:
    """What is remarkable about the angles of a robot file.

    A number in an angle cell beyond 2 pi rad (in limits and drawn configurations beyond two turns) is taken for
    degrees; one within 1e-3 of a multiple of pi/12 for a rounded one; in a file in degrees, the latter for radians.
    Numbers of parameters that stand in angle cells, and arguments of sin, cos and tan, are angles too.

    Args:
        document: The file, accepted.
        robot: What it says.

    Returns:
        The remarks in the order of the file.
    """
    cells = Cells(document, robot.units)
    found: dict[KeyPath, Remark] = {}
    angles: list[tuple[KeyPath, Expression]] = []
    paths = [path for path, _ in located_expressions(robot)]
    for path in (*paths, *(("figure", "q", row) for row in range(robot.n))):
        cell = cells.raw(path)
        angles += [(path, angle) for angle in _arguments(cell)] + ([(path, cell)] if _is_angle(path, robot) else [])
        if lookalike := next((name for name in names(cell) if name in _LIKE_PI), None):
            what = f"{path_text(path)}: '{lookalike}' is a name like any other"
            found[path] = Remark(document.location(path), what, "the constant is written pi")
    named = {term.name for _, angle in angles for _, term in linear_terms(angle) if isinstance(term, Name)}
    angles += [(("parameters", name), value) for name, value in robot.parameters if name in named]
    for path, angle in angles:
        if path not in found and (slip := _slip(path, angle, degrees=robot.units.degrees)):
            found[path] = Remark(document.location(path), f"{path_text(path)}: {slip[0]}", slip[1])
    return tuple(sorted(found.values(), key=lambda remark: (remark.location.line, remark.location.column)))


def _is_angle(path: KeyPath, robot: Description) -> bool:
    """Whether a cell is an angle as a whole."""
    if path[0] == "figure":
        return robot.joints[int(path[-1])].is_revolute
    if path[0] != "joints":
        return False
    return path[2] in ("theta", "alpha") or (path[2] == "limits" and robot.joints[int(path[1])].is_revolute)


def _arguments(expression: Expression) -> Iterator[Expression]:
    """The arguments of sin, cos and tan in a cell."""
    if isinstance(expression, Call) and expression.function in ("sin", "cos", "tan"):
        yield from expression.arguments
    for part in children(expression):
        yield from _arguments(part)


def _slip(path: KeyPath, angle: Expression, *, degrees: bool) -> tuple[str, str] | None:
    """What is found and what to write, where the plain number in an angle is hardly meant as it stands."""
    parameter, motion = path[0] == "parameters", "limits" in path or path[0] == "figure"
    plain = (
        multiply(number(c), term) for c, term in linear_terms(angle) if is_constant(term) and not contains_pi(term)
    )
    try:
        value = evaluate(add(*plain), {})
    except ArithmeticError:
        return None
    shown, twelfths = f"{value:.10g}", round(12 * value / pi)
    near = twelfths != 0 and abs(value - twelfths * pi / 12) <= NEAR * max(1.0, abs(value)) and abs(twelfths) <= 24
    exact = multiple_of_pi(Fraction(twelfths, 12))
    if degrees and not parameter:
        decimals = len(shown.partition(".")[2])
        if not near or motion or decimals < DEGREE_DECIMALS:
            return None
        return (
            f"{shown} is nearly {exact}, but angles of this file are in degrees",
            f"if radians are meant write {15 * twelfths}",
        )
    if near and not motion:
        return f"{shown} rad is nearly {exact}, but not exactly", f"did you mean {exact}?"
    if abs(value) <= tau * (TURNS_OF_A_JOINT if motion else 1) * (1 + NEAR):
        return None
    in_radians = multiple_of_pi(Fraction(shown) / 180) if "e" not in shown else f"{shown}*pi/180"
    return (
        f"{shown} rad is more than {'two turns' if motion else 'a turn'}",
        f"if degrees are meant write {in_radians}{_PARAMETERS if parameter else _UNITS}",
    )
