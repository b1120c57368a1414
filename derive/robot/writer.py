"""A robot as the text of a robot file, which reads back as the same robot."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from fractions import Fraction
from functools import partial

from derive.robot import description
from derive.robot.expression import ZERO, Expression, to_text
from derive.robot.options.handout import HandoutOptions, NotationOptions
from derive.robot.options.inverse import InverseOptions
from derive.robot.rounding import shown
from derive.robot.tree import explicit, located_links, table
from derive.robot.units import Unit, in_file_units, in_symbol_units, position_unit, row_in_file_units


def cell_text(cell: Expression) -> str:
    """A cell as it stands in a robot file, with all digits of its numbers, decimals where they end."""

    def _decimal(value: Fraction) -> str:
        found = shown(value, decimals=True, digits=None)
        if isinstance(found, Fraction):
            return str(found)
        return f"{found:f}" if -7 < found.adjusted() < 16 else f"{found:e}".replace("E", "e").replace("e+", "e")

    return to_text(cell, _decimal)


def robot_text(robot: description.Description, comments: Sequence[str] = ()) -> str:
    """The robot file of a robot, in the units of the file that it comes from."""
    lines = [*(f"# {line}".rstrip() for line in comments), f"name: {robot.name}"]
    lines += [f"title: {_quoted(robot.title)}"] if robot.title and robot.title != robot.name else []
    lines += [f"convention: {robot.convention.value}"]
    units = robot.units
    if units != description.FileUnits():
        written = f"angle: {'deg' if units.degrees else 'rad'}, length: {'mm' if units.millimetres else 'm'}"
        lines += [f"units: {{{written}{', parameters: file' if units.parameters else ''}}}"]
    lines += ["joints:" if table(robot) else "joints: []"]
    above = description.BASE
    for row in table(explicit(robot)):
        lines += [f"  - {{{', '.join(_row(row_in_file_units(row, units), above, robot))}}}"]
        above = row.label
    for key, matrix in (("base", robot.base), ("tool", robot.tool)):
        if matrix != description.IDENTITY:
            lines += [f"{key}:", *(f"  - {row}" for row in _frame(matrix, units))]
    if robot.gravity is not None:
        lines += [f"gravity: {_list(robot.gravity)}"]
    for variable in robot.coupled:
        lines += ["variables:"] if variable is robot.coupled[0] else []
        lines += [f"  {variable.variable}: {_variable(variable, robot)}"]
    ends = {}
    for end in (end for end in robot.ends if end.name):
        after, tool = _quoted(end.after), f"[{', '.join(_frame(end.tool, units))}]"
        ends[end.name] = after if end.tool == description.IDENTITY else f"{{after: {after}, tool: {tool}}}"
    lines += _block("ends", ends)
    if robot.root is not None:
        lines += _block("root", {"type": robot.root.type.value, "q": f"[{', '.join(robot.root.variables)}]"})
        if robot.root.link and robot.root.link != description.Link():
            lines += ["  link:", *(f"    {line[4:]}" for line in _link(robot.root.link, units))]
    lines += ["loops:"] if robot.loops else []
    for loop in robot.loops:
        branch = f", branch: {_quoted(loop.branch)}" if loop.branch else ""
        length = f", length: {_length(loop.length, units)}" if loop.length != ZERO else ""
        lines += [f"  - {{join: [{', '.join(map(_quoted, loop.join))}], by: {loop.by.value}{length}{branch}}}"]
    if robot.links:
        bodies = [link for place, link in located_links(robot) if place[0] == "links"]
        lines += ["links:" if bodies else "links: []", *(line for link in bodies for line in _link(link, units))]
    numbers = {name: cell_text(in_symbol_units(robot, name, value)) for name, value in robot.parameters}
    lines += _block("parameters", numbers)
    lines += [f"runtime: [{', '.join(robot.runtime)}]"] if robot.runtime else []
    lines += [f"wrench: [{', '.join(robot.wrench)}]"] if robot.wrench else []
    return "\n".join([*lines, *_options(robot)]) + "\n"


def _quoted(text: str) -> str:
    plain = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{plain}"'


def _options(robot: description.Description) -> Iterator[str]:
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
        kinds = map(position_unit, robot.variables)
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


def _length(cell: Expression, units: description.FileUnits) -> str:
    return cell_text(in_file_units(cell, Unit.LENGTH, units))


def _list(cells: Sequence[Expression]) -> str:
    return f"[{', '.join(map(cell_text, cells))}]"


def _frame(matrix: description.Matrix, units: description.FileUnits) -> list[str]:
    """The rows of a transform in brackets."""
    lengths = [f"[{', '.join([*map(cell_text, row[:3]), _length(row[3], units)])}]" for row in matrix[:3]]
    return [*lengths, _list(matrix[3])]


def _variable(variable: description.Variable, robot: description.Description) -> str:
    """The bounds of a variable in braces, without those that are its row's anyway."""
    alone = next((joint for joint in robot.joints if joint.variable == variable.variable), None)
    unit = partial(in_file_units, unit=position_unit(variable), units=robot.units)
    bounds = [(getattr(variable, key), alone and getattr(alone, key)) for key in ("limits", "speed", "torque")]
    limits, speed, torque = (None if own == of_row else own for own, of_row in bounds)
    cells = [f"limits: {_list([*map(unit, limits)])}"] if limits else []
    cells += [f"speed: {cell_text(unit(speed))}"] if speed else []
    cells += [f"torque: {cell_text(torque)}"] if torque else []
    return f"{{{', '.join(cells)}}}"


def _row(row: description.Joint | description.FixedRow, above: str, robot: description.Description) -> Iterator[str]:
    """Type and cells of a row in the order of the convention; what is zero or goes without saying is left out."""
    yield f"type: {row.type.value if isinstance(row, description.Joint) else description.FIXED}"
    if isinstance(row, description.Joint) and row.variable in {mover.variable for mover in robot.movers}:
        yield f"q: {row.variable}"
    if isinstance(row, description.Joint) and row.follows:
        yield "passive: true"
    stand, cells = row.stand or description.Stand(above), row.written(cell_text)
    if stand.after != above:
        yield f"after: {_quoted(stand.after)}"
    if stand.mount != description.IDENTITY:
        yield f"mount: [{', '.join(_frame(stand.mount, robot.units))}]"
    cells |= {"gamma": cell_text(stand.gamma), "b": cell_text(stand.b)}
    standard = robot.convention is description.Convention.STANDARD
    order = ("theta", "d", "a", "alpha") if standard else ("gamma", "b", "alpha", "a", "theta", "d")
    yield from (f"{key}: {cells[key]}" for key in order if cells[key] != "0")
    if isinstance(row, description.Joint):
        yield from [f"limits: {_list(row.limits)}"] if row.limits is not None else []
        bounds = (("speed", row.speed), ("torque", row.torque))
        yield from (f"{key}: {cell_text(cell)}" for key, cell in bounds if cell is not None)
    if row.name:
        yield f"name: {_quoted(row.name)}"


def _cells(part: description.Link | description.Inertia | description.Motor, keys: Sequence[str]) -> str:
    """Some cells of a part in braces, without those that are zero; nothing where all are."""
    cells = {key: getattr(part, key) for key in keys}
    rows = [f"{key}: {description.pair_text(cell, cell_text)}" for key, cell in cells.items() if cell != ZERO]
    return f"{{{', '.join(rows)}}}" if rows else ""


def _link(link: description.Link, units: description.FileUnits) -> Iterator[str]:
    """The lines of a link; what is zero is left out."""
    tensor = _cells(link.inertia, description.INERTIA)
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
