"""A robot as the text of a robot file, which reads back as the same robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from derive.robot.description import IDENTITY, Convention, Description, Inertia, Joint, Link, Matrix, Motor
from derive.robot.expression import ZERO, Expression, to_text
from derive.robot.rounding import shown

_INERTIA = ("xx", "yy", "zz", "xy", "xz", "yz")


def cell_text(cell: Expression) -> str:
    """A cell as it stands in a robot file, with all digits of its numbers, decimals where they end.

    Args:
        cell: Exact, in SI units and radians.
    """
    return to_text(cell, _decimal)


def robot_text(robot: Description, comments: Sequence[str] = ()) -> str:
    """The robot file of a robot, in radians and metres.

    Args:
        robot: The robot; its options of print and handout are left out.
        comments: Lines that go before it.

    Returns:
        YAML.
    """
    title = robot.title.replace("\\", "\\\\").replace('"', '\\"')
    lines = [*(f"# {line}".rstrip() for line in comments), f"name: {robot.name}"]
    lines += [f'title: "{title}"'] if title and title != robot.name else []
    lines += [f"convention: {robot.convention.value}", "joints:"]
    lines += [f"  - {{{', '.join(_row(joint, robot.convention))}}}" for joint in robot.joints]
    for key, matrix in (("base", robot.base), ("tool", robot.tool)):
        lines += _frame(key, matrix)
    if robot.gravity is not None:
        lines += [f"gravity: {_list(robot.gravity)}"]
    if robot.links:
        lines += ["links:", *(line for link in robot.links for line in _link(link))]
    if robot.parameters:
        lines += ["parameters:", *(f"  {name}: {cell_text(value)}" for name, value in robot.parameters)]
    lines += [f"runtime: [{', '.join(robot.runtime)}]"] if robot.runtime else []
    return "\n".join(lines) + "\n"


def _decimal(value: Fraction) -> str:
    found = shown(value, decimals=True, digits=None)
    if isinstance(found, Fraction):
        return str(found)
    return f"{found:f}" if -7 < found.adjusted() < 16 else f"{found:e}".replace("E", "e").replace("e+", "e")


def _list(cells: Sequence[Expression]) -> str:
    return f"[{', '.join(map(cell_text, cells))}]"


def _row(joint: Joint, convention: Convention) -> Iterator[str]:
    """Type and cells of a joint in the order of the convention; those that are zero are left out."""
    yield f"type: {joint.type.value}"
    yield f"q: {joint.variable}"
    moving = "theta" if joint.is_revolute else "d"
    standard = convention is Convention.STANDARD
    for key in ("theta", "d", "a", "alpha") if standard else ("alpha", "a", "theta", "d"):
        cell = getattr(joint, key)
        if key == moving:
            variable = joint.variable if joint.sign > 0 else f"-{joint.variable}"
            constant = cell_text(cell)
            rest = f" - {constant[1:]}" if constant.startswith("-") else f" + {constant}"
            yield f"{key}: {variable if cell == ZERO else variable + rest}"
        elif cell != ZERO:
            yield f"{key}: {cell_text(cell)}"
    if joint.limits is not None:
        yield f"limits: {_list(joint.limits)}"
    for key, value in (("speed", joint.speed), ("torque", joint.torque)):
        if value is not None:
            yield f"{key}: {cell_text(value)}"


def _frame(key: str, matrix: Matrix) -> Iterator[str]:
    if matrix != IDENTITY:
        yield f"{key}:"
        yield from (f"  - {_list(row)}" for row in matrix)


def _cells(part: Link | Inertia | Motor, keys: Sequence[str]) -> str:
    """Some cells of a part in braces, without those that are zero; nothing where all are."""
    cells = {key: getattr(part, key) for key in keys}
    rows = [f"{key}: {cell_text(cell)}" for key, cell in cells.items() if cell != ZERO]
    return f"{{{', '.join(rows)}}}" if rows else ""


def _link(link: Link) -> Iterator[str]:
    """The lines of a link; what is zero is left out."""
    tensor = _cells(link.inertia, _INERTIA)
    friction = _cells(link, ("viscous", "coulomb"))
    yield f"  - mass: {cell_text(link.mass)}"
    if any(cell != ZERO for cell in link.com):
        yield f"    com: {_list(link.com)}"
    if tensor:
        yield f"    inertia: {tensor}"
    if link.motor is not None:
        yield f"    motor: {_cells(link.motor, ('mass', 'inertia', 'ratio')) or '{mass: 0}'}"
    if link.armature != ZERO:
        yield f"    armature: {cell_text(link.armature)}"
    if friction:
        yield f"    friction: {friction}"
