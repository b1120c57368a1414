"""Every cell of a robot with its place, what it is a number of, and so in which unit the number of a symbol is.

In a file that says ``parameters: file``, the number of a symbol is in the unit of the cells in which it stands by
itself: a symbol that is a length in a file in millimetres has a number in millimetres.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from enum import Enum
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from derive.errors import RobotFileError
from derive.robot import expression as tree
from derive.robot.description import INERTIA, Description, FileUnits, FixedRow, Joint, Matrix, Variable
from derive.robot.expression import Call, Expression, Name, Pi, Product, is_constant, names
from derive.robot.tree import located_links, table

Row = TypeVar("Row", bound=Joint | FixedRow)

if TYPE_CHECKING:  # names of symbols are asked for where no YAML is read
    from derive.robot.reading.document import KeyPath


class Unit(Enum):
    """What a cell is a number of, as far as files differ in it."""

    SI = "a quantity in SI units"
    LENGTH = "a length"
    ANGLE = "an angle"

    def differs_in(self, units: FileUnits) -> bool:
        """Whether the file has another unit for it than SI and radians."""
        return (self is Unit.ANGLE and units.degrees) or (self is Unit.LENGTH and units.millimetres)


def position_unit(joint: Joint | Variable) -> Unit:
    """What the variable of a joint is."""
    return Unit.ANGLE if joint.is_revolute else Unit.LENGTH


def cell_unit(path: KeyPath, robot: Description) -> Unit:
    """What the cell at a place of the file is."""
    match path:
        case ("joints", int(row), "limits", _) if isinstance(joint := table(robot)[row], Joint):
            return position_unit(joint)
        case ("figure", "q", int(index)):
            return position_unit(robot.variables[index])
        case ("variables", str(name), "limits", _):
            return next(position_unit(variable) for variable in robot.coupled if variable.variable == name)
        case ("joints", _, "theta" | "alpha" | "gamma"):
            return Unit.ANGLE
        case ("joints", _, "d" | "a" | "b") | ("loops", _, "length") | ("links" | "root", _, "com", _):
            return Unit.LENGTH
        case (*_, "base" | "tool" | "mount", 0 | 1 | 2, 3):
            return Unit.LENGTH
    return Unit.SI


def located_frames(robot: Description) -> Iterator[tuple[KeyPath, Matrix]]:
    """Every constant transform that the file gives as a matrix."""
    yield from ((("base",), robot.base), (("tool",), robot.tool))
    stands = ((index, row.stand) for index, row in enumerate(table(robot)) if row.stand)
    yield from ((("joints", index, "mount"), stand.mount) for index, stand in stands)
    yield from ((("ends", end.name, "tool"), end.tool) for end in robot.ends if end.name)


def located_expressions(robot: Description) -> Iterator[tuple[KeyPath, Expression]]:
    """Every expression of the robot."""
    for path, matrix in located_frames(robot):
        yield from (((*path, i, j), entry) for i, row in enumerate(matrix) for j, entry in enumerate(row))
    for index, row in enumerate(table(robot)):
        place: KeyPath = ("joints", index)
        yield from (((*place, key), getattr(row, key)) for key in ("theta", "d", "a", "alpha"))
        if row.stand:
            yield from (((*place, "gamma"), row.stand.gamma), ((*place, "b"), row.stand.b))
        if isinstance(row, Joint):
            yield from (((*place, "drive", name), factor) for name, factor in row.drive)
            yield from (((*place, "limits", k), limit) for k, limit in enumerate(row.limits or ()))
    for variable in robot.coupled:
        place = ("variables", variable.variable, "limits")
        yield from (((*place, k), limit) for k, limit in enumerate(variable.limits or ()))
    yield from ((("loops", k, "length"), loop.length) for k, loop in enumerate(robot.loops))
    yield from ((("gravity", k), entry) for k, entry in enumerate(robot.gravity or ()))
    for place, link in located_links(robot):
        yield (*place, "mass"), link.mass
        yield from (((*place, "com", k), entry) for k, entry in enumerate(link.com))
        yield from (((*place, "inertia", key), getattr(link.inertia, key)) for key in INERTIA)
        keys = ("mass", "inertia", "ratio") if link.motor is not None else ()
        yield from (((*place, "motor", key), getattr(link.motor, key)) for key in keys)
        yield (*place, "armature"), link.armature
        yield (*place, "friction", "viscous"), link.viscous
        dry: KeyPath = (*place, "friction", "coulomb")
        yield from zip([(*dry, 0), (*dry, 1)] if isinstance(link.coulomb, tuple) else [dry], link.dry, strict=False)


def is_turn(expression: Expression) -> bool:
    """Whether it is a sine, cosine or tangent."""
    return isinstance(expression, Call) and expression.function in ("sin", "cos", "tan")


def turned_angles(expression: Expression) -> Iterator[Expression]:
    """The arguments of sin, cos and tan in a cell."""
    if is_turn(expression):
        yield from tree.children(expression)
    for part in tree.children(expression):
        yield from turned_angles(part)


def symbolic_factors(term: Expression) -> list[Expression]:
    """What of a term is neither a number nor a sine, cosine or tangent."""
    factors = term.factors if isinstance(term, Product) else (term,)
    return [factor for factor in factors if not is_constant(factor) and not is_turn(factor)]


def symbol_unit(robot: Description, name: str) -> Unit:
    """What a symbol is a number of, `Unit.SI` also where the units of the file make no difference."""
    # A term 2*cos(beta)*a1 of a length cell says that a1 is a length; products of symbols say nothing.
    # alone: what the symbol is where it stands by itself; others: what it could be in products, where none tells
    alone, others = set[Unit](), set[Unit]()
    for path, cell in located_expressions(robot):
        unit = cell_unit(path, robot)
        for whole, what in [(cell, unit), *((angle, Unit.ANGLE) for angle in turned_angles(cell))]:
            for _, term in tree.linear_terms(whole):
                factors = symbolic_factors(term)
                if factors == [Name(name)]:
                    alone.add(what)
                elif any(name in names(factor) for factor in factors):
                    others |= {Unit.SI, Unit.LENGTH if what is Unit.SI else what}
    found = {unit if unit.differs_in(robot.units) else Unit.SI for unit in alone or others}
    if len(found) < 2:
        return next(iter(found), Unit.SI)
    meanings = " and ".join(unit.value for unit in Unit if unit in alone)
    said = f"'{name}' stands for {meanings}" if alone else f"'{name}' stands in products alone, which tell no unit"
    allowed = "with parameters: file, allowed: symbols that stand by themselves, and for one kind of quantity"
    remedy = "write its number into these cells, use two symbols, or leave out parameters: file and write SI units"
    raise RobotFileError(said, allowed=allowed, remedy=remedy)


def are_units_clear(robot: Description) -> bool:
    """Whether every symbol with a number has one unit in the file."""
    try:
        return all(symbol_unit(robot, name) for name, _ in (*robot.parameters, *robot.figure.values))
    except RobotFileError:
        return False


def in_file_units(cell: Expression, unit: Unit, units: FileUnits) -> Expression:
    """A cell as the file has it: terms without a name are in its units."""
    if not unit.differs_in(units):
        return cell
    factor = tree.number(1000) if unit is Unit.LENGTH else tree.multiply(tree.number(180), tree.power(Pi(), -1))
    terms = []
    for coefficient, term in tree.linear_terms(cell):
        if not is_constant(term):
            terms.append(tree.multiply(tree.number(coefficient), term))
            continue
        # 180/pi times pi/4 is 45: pi and its inverse cancel
        parts = list(product.factors if isinstance(product := tree.multiply(factor, term), Product) else (product,))
        if Pi() in parts and tree.power(Pi(), -1) in parts:
            parts.remove(Pi())
            parts.remove(tree.power(Pi(), -1))
        terms.append(tree.multiply(tree.number(coefficient), *parts))
    return tree.add(*terms)


def row_in_file_units(row: Row, units: FileUnits) -> Row:
    """A row of the table whose numbers in cells are as the file has them, those of its mount in metres."""
    angle, length = (partial(in_file_units, unit=unit, units=units) for unit in (Unit.ANGLE, Unit.LENGTH))
    row = replace(row, theta=angle(row.theta), d=length(row.d), a=length(row.a), alpha=angle(row.alpha))
    if row.stand is not None:
        row = replace(row, stand=replace(row.stand, gamma=angle(row.stand.gamma), b=length(row.stand.b)))
    if isinstance(row, FixedRow):
        return row
    position, limits = angle if row.is_revolute else length, row.limits
    limits = limits and (position(limits[0]), position(limits[1]))
    return replace(row, limits=limits, speed=row.speed and position(row.speed))


def in_symbol_units(robot: Description, name: str, value: Expression) -> Expression:
    """The number of a symbol as a user types it: in SI units unless the file says otherwise."""
    return in_file_units(value, symbol_unit(robot, name), robot.units) if robot.units.parameters else value
