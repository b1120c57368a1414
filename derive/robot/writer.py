"""A robot as the text of a robot file, which reads back as the same robot."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from fractions import Fraction

from derive.robot.description import (
    IDENTITY,
    INERTIA,
    Convention,
    Description,
    FileUnits,
    Inertia,
    Joint,
    Link,
    Motor,
    pair_text,
)
from derive.robot.expression import ZERO, Expression, to_text
from derive.robot.options.handout import HandoutOptions, NotationOptions
from derive.robot.options.inverse import InverseOptions
from derive.robot.rounding import shown
from derive.robot.units import Unit, in_file_units, in_symbol_units, joint_in_file_units, position_unit


def cell_text(cell: Expression) -> str:
    """A cell as it stands in a robot file, with all digits of its numbers, decimals where they end."""

    def _decimal(value: Fraction) -> str:
        found = shown(value, decimals=True, digits=None)
        if isinstance(found, Fraction):
            return str(found)
        return f"{found:f}" if -7 < found.adjusted() < 16 else f"{found:e}".replace("E", "e").replace("e+", "e")

    return to_text(cell, _decimal)


def robot_text(robot: Description, comments: Sequence[str] = ()) -> str:
    """The robot file of a robot, in the units of the file that it comes from."""
    lines = [*(f"# {line}".rstrip() for line in comments), f"name: {robot.name}"]
    lines += [f"title: {_quoted(robot.title)}"] if robot.title and robot.title != robot.name else []
    lines += [f"convention: {robot.convention.value}"]
    units = robot.units
    if units != FileUnits():
        written = f"angle: {'deg' if units.degrees else 'rad'}, length: {'mm' if units.millimetres else 'm'}"
        lines += [f"units: {{{written}{', parameters: file' if units.parameters else ''}}}"]
    lines += ["joints:"]
    rows = (_row(joint_in_file_units(joint, units), robot.convention) for joint in robot.joints)
    lines += [f"  - {{{', '.join(row)}}}" for row in rows]
    for key, matrix in (("base", robot.base), ("tool", robot.tool)):
        if matrix != IDENTITY:
            lengths = (f"  - [{', '.join([*map(cell_text, row[:3]), _length(row[3], units)])}]" for row in matrix[:3])
            lines += [f"{key}:", *lengths, f"  - {_list(matrix[3])}"]
    if robot.gravity is not None:
        lines += [f"gravity: {_list(robot.gravity)}"]
    if robot.links:
        lines += ["links:", *(line for link in robot.links for line in _link(link, units))]
    numbers = {name: cell_text(in_symbol_units(robot, name, value)) for name, value in robot.parameters}
    lines += _block("parameters", numbers)
    lines += [f"runtime: [{', '.join(robot.runtime)}]"] if robot.runtime else []
    return "\n".join([*lines, *_options(robot)]) + "\n"


def _quoted(text: str) -> str:
    plain = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{plain}"'


def _options(robot: Description) -> Iterator[str]:
    """What is wanted of the robot: style, handout, figure and inverse kinematics, as far as it is not the usual."""
    style = robot.style.options()
    yield from [f"style: {style['name']}"] if list(style) == ["name"] else _block("style", style)
    handout, usual = robot.handout, HandoutOptions()
    chosen = {part.name: getattr(handout, part.name) for part in fields(handout) if part.name != "notation"}
    changed = {key: value for key, value in chosen.items() if value != getattr(usual, key)}
    changed |= {"parts": f"[{', '.join(handout.parts)}]"} if "parts" in changed else {}
    notation = {part.name: getattr(handout.notation, part.name) for part in fields(handout.notation)}
    letters = [f"{key}: {value}" for key, value in notation.items() if value != getattr(NotationOptions(), key)]
    yield from _block("handout", changed | ({"notation": f"{{{', '.join(letters)}}}"} if letters else {}))
    figure, inverse, drawn = robot.figure, robot.inverse, {}
    if figure.q is not None:
        kinds = map(position_unit, robot.joints)
        drawn["q"] = _list([in_file_units(*cell, robot.units) for cell in zip(figure.q, kinds, strict=True)])
    if figure.values:
        values = (f"{name}: {cell_text(in_symbol_units(robot, name, value))}" for name, value in figure.values)
        drawn["values"] = f"{{{', '.join(values)}}}"
    yield from _block("figure", drawn)
    asked = {"task": inverse.task} if inverse.task != InverseOptions().task else {}
    asked |= {"given": inverse.given} if inverse.given is not None else {}
    yield from _block("inverse", {key: f"[{', '.join(words)}]" for key, words in asked.items()})


def _block(key: str, entries: dict[str, str]) -> Iterator[str]:
    if entries:
        yield f"{key}:"
        yield from (f"  {name}: {value}" for name, value in entries.items())


def _length(cell: Expression, units: FileUnits) -> str:
    return cell_text(in_file_units(cell, Unit.LENGTH, units))


def _list(cells: Sequence[Expression]) -> str:
    return f"[{', '.join(map(cell_text, cells))}]"


def _row(joint: Joint, convention: Convention) -> Iterator[str]:
    """Type and cells of a joint in the order of the convention; those that are zero are left out."""
    yield f"type: {joint.type.value}"
    yield f"q: {joint.variable}"
    cells, standard = joint.written(cell_text), convention is Convention.STANDARD
    order = ("theta", "d", "a", "alpha") if standard else ("alpha", "a", "theta", "d")
    yield from (f"{key}: {cells[key]}" for key in order if cells[key] != "0")
    if joint.limits is not None:
        yield f"limits: {_list(joint.limits)}"
    if joint.speed is not None:
        yield f"speed: {cell_text(joint.speed)}"
    if joint.torque is not None:
        yield f"torque: {cell_text(joint.torque)}"
    if joint.name:
        yield f"name: {_quoted(joint.name)}"


def _cells(part: Link | Inertia | Motor, keys: Sequence[str]) -> str:
    """Some cells of a part in braces, without those that are zero; nothing where all are."""
    cells = {key: getattr(part, key) for key in keys}
    rows = [f"{key}: {pair_text(cell, cell_text)}" for key, cell in cells.items() if cell != ZERO]
    return f"{{{', '.join(rows)}}}" if rows else ""


def _link(link: Link, units: FileUnits) -> Iterator[str]:
    """The lines of a link; what is zero is left out."""
    tensor = _cells(link.inertia, INERTIA)
    friction = _cells(link, ("viscous", "coulomb"))
    yield f"  - mass: {cell_text(link.mass)}"
    if any(cell != ZERO for cell in link.com):
        yield f"    com: [{', '.join(_length(cell, units) for cell in link.com)}]"
    if tensor:
        yield f"    inertia: {tensor}"
    if link.motor is not None:
        yield f"    motor: {_cells(link.motor, ('mass', 'inertia', 'ratio')) or '{mass: 0}'}"
    if link.armature != ZERO:
        yield f"    armature: {cell_text(link.armature)}"
    if friction:
        yield f"    friction: {friction}"
