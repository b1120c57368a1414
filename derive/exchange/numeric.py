"""A robot whose cells are numbers, as other programs' formats have them, and how a number is written for them."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar

from derive.errors import DeriveError, QuantityError
from derive.exchange.certificate import ball
from derive.mechanics.space import Real, decimal
from derive.robot.description import Convention, Description
from derive.robot.expression import Expression, Pi, Product, add, negate, number, substitute
from derive.robot.names import file_symbols
from derive.robot.writer import cell_text

Some = TypeVar("Some", bound=Description)

# Of a robot what has cells.
PARTS = ("joints", "base", "tool", "gravity", "links", "fixed", "ends", "root", "coupled")
MOST_SYMBOLS = 8  # of those that a message names


def with_numbers(robot: Some, chosen: Mapping[str, Expression] | None = None) -> Some:
    """The robot with numbers in the place of symbols."""
    values: dict[str, Expression] = {}
    for name, expression in dict(robot.parameters).items():
        values[name] = substitute(expression, values)
    values |= chosen or {}
    if missing := [name for name in file_symbols(robot) if name not in values]:
        shown = ", ".join(missing[:MOST_SYMBOLS]) + (", ..." if len(missing) > MOST_SYMBOLS else "")
        example = ",".join(f"{name}=0.5" for name in missing[:2])
        found = f"{robot.name}: symbols without a number: {shown}"
        remedy = f"give them under parameters:, or write --values {example}"
        raise DeriveError(found, allowed="other programs accept numbers only", remedy=remedy)
    return replace(robot, **{name: _filled(getattr(robot, name), values) for name in PARTS}, parameters=(), runtime=())


def _filled(part: Any, values: Mapping[str, Expression]) -> Any:
    if isinstance(part, tuple):
        return tuple(_filled(entry, values) for entry in part)
    if isinstance(part, Expression):
        try:
            found = substitute(part, values)
            if ball(found).is_finite():
                return found
        except (ZeroDivisionError, QuantityError):
            pass
        raise DeriveError(f"{cell_text(part)} has no finite value", remedy="choose other numbers")
    if hasattr(part, "__dataclass_fields__"):
        names = (entry.name for entry in fields(part) if entry.name not in ("follows", "meant"))  # no cells
        return replace(part, **{name: _filled(getattr(part, name), values) for name in names})
    return part


def with_positive_axes(robot: Some) -> Some:
    """The same arm by a table in which every variable counts positive along its axis."""
    # A half turn H about x takes z to -z, so that Rot(z, -q) Trans(z, d) = H Rot(z, q) Trans(z, -d) H. It commutes with
    # Trans(x, a) Rot(x, alpha) and adds pi to the alpha on either side; next to the base or the tool it goes there.
    # Which rows have H on their z part; two that follow one another cancel between them.
    turned = [joint.sign < 0 for joint in robot.joints]
    before, behind = [False, *turned[:-1]], [*turned[1:], False]
    standard = robot.convention is Convention.STANDARD
    halves = [one != other for one, other in zip(turned, behind if standard else before, strict=True)]
    frames = behind if standard else turned
    base, tool = robot.base, robot.tool
    if standard and turned[0]:
        base = tuple(tuple(negate(cell) if k in (1, 2) else cell for k, cell in enumerate(row)) for row in base)
    if not standard and turned[-1]:
        tool = tuple(tuple(map(negate, row)) if k in (1, 2) else row for k, row in enumerate(tool))
    joints, links = [], []
    for joint, half in zip(robot.joints, halves, strict=True):
        if half:
            joint = replace(joint, alpha=add(joint.alpha, Pi() if ball(joint.alpha) <= 0 else negate(Pi())))
        if joint.sign < 0:
            joint = replace(joint, sign=1, theta=negate(joint.theta), d=negate(joint.d))
        joints.append(joint)
    for link, half, own in zip(robot.links, frames, turned, strict=False):
        if half:  # seen from a frame that is turned about x by pi
            x, y, z = link.com
            inertia = replace(link.inertia, xy=negate(link.inertia.xy), xz=negate(link.inertia.xz))
            link = replace(link, com=(x, negate(y), negate(z)), inertia=inertia)
        if own and link.motor:
            link = replace(link, motor=replace(link.motor, ratio=negate(link.motor.ratio)))
        links.append(link)
    return replace(robot, joints=tuple(joints), base=base, tool=tool, links=tuple(links))


def text(value: Real) -> str:
    """A number with 17 digits, fewer where it ends: ``0.4318``, ``1.5707963267948966``."""
    return cell_text(number(decimal(value)))


def texts(values: Any, separator: str = " ") -> str:
    """Numbers side by side."""
    return separator.join(map(text, values))


def angle_text(cell: Expression) -> str:
    """An angle for a program that knows ``pi``: ``-pi/2``, or a number."""
    whole = cell == Pi() or (isinstance(cell, Product) and len(cell.factors) == 2 and cell.factors[1] == Pi())
    return cell_text(cell) if whole else text(ball(cell))
