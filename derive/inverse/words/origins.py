"""Where an equation comes from, in the words of textbooks: entry (3,4) of A_1^-1 T.

The pool of equations cuts the arm on the axes of its joints. A textbook compares entries of A_i ... A_j with those of
what is left of T when the other matrices are brought to its side. Both are the same where the link length and twist
between cut and frame do no more than turn by right angles; else the equation is said by axes.
"""

import re
from dataclasses import dataclass, replace
from enum import StrEnum

from derive.algebra.angles import decompose
from derive.inverse.closed.nodes import Provenance
from derive.robot.description import Convention
from derive.robot.expression import ZERO, Expression
from derive.robot.robot import Robot

# The last matrix of a product, and the rows of its fourth column that are meant; None where there is no such product.
Seen = tuple[int, tuple[int, ...]] | None


class OriginForm(StrEnum):
    """What is made of the entries."""

    ENTRY = "entry"  # one entry of the product
    SQUARES = "squares"  # several entries, squared and added
    COMPONENT = "component"  # a component of the vector between two axes, in the frame of one of them
    DISTANCE = "distance"  # the squared distance between points of two axes
    ROD = "rod"  # the squared distance between the ends of a rod
    DIRECTIONS = "directions"  # the rotation between two axes
    MOMENT = "moment"  # of p x R, or p.p R - 2 p (R^T p)^T: Raghavan and Roth, J. Mech. Des. 115(3), 1993


@dataclass(frozen=True)
class Origin:
    """Where an equation comes from."""

    form: OriginForm  # what is made of the entries
    first: int  # first matrix of the product A_first ... A_last, or the first of two axes, from 1
    last: int  # the last one; one less than the first where nothing is left of it
    entries: tuple[tuple[int, ...], ...]  # rows and columns, from 1; of a component its number alone
    inverse: bool = False  # whether of the inverse product; of a component, whether in the frame of the last axis
    has_base: bool = False  # whether the product begins with the base
    has_tool: bool = False  # whether it ends with the tool


def origin(robot: Robot, source: Provenance, *, to_end: bool, from_base: bool = False) -> Origin:
    """The origin of an equation."""
    name, places = source.entry, tuple(map(int, re.findall(r"\d", source.entry)))
    in_world = from_base and source.first == 1
    # What is constant between the rows is no part of a matrix of the table: then no entry of a product is named.
    has_table = not robot.is_tree
    match name[0]:
        case "R":
            found, (row, column) = Origin(OriginForm.DIRECTIONS, source.first, source.last, (places,)), places
            if robot.convention is Convention.MODIFIED and not in_world:
                row = _turned(robot.joints[source.first - 1].alpha, row)
            elif robot.convention is Convention.STANDARD and not (to_end and source.last == robot.n):
                column = _turned(robot.joints[source.last - 1].alpha, column)
            if row and column and has_table:
                found = replace(found, form=OriginForm.ENTRY, entries=((row, column),))
        case "r":
            found = Origin(OriginForm.ROD, source.first, source.last, ((1, 4), (2, 4), (3, 4)))
        case "m" | "k":
            found = Origin(OriginForm.MOMENT, source.first, source.last, (places,))
        case kind:
            form = OriginForm.COMPONENT if places else OriginForm.DISTANCE
            found = Origin(form, source.first, source.last, (places,), inverse=kind != "p")
            asked = robot, source, places, in_world
            seen = _position(*asked, to_end) if kind == "p" else _back(*asked)
            if seen is not None and all(seen[1]) and has_table:
                form = OriginForm.ENTRY if places else OriginForm.SQUARES
                found = replace(found, form=form, last=seen[0], entries=tuple((row, 4) for row in seen[1]))
    return replace(found, has_base=in_world, has_tool=to_end and source.last == robot.n)


def _position(robot: Robot, source: Provenance, places: tuple[int, ...], in_world: bool, to_end: bool) -> Seen:
    """The position at which M ends, seen from where it begins."""
    first, standard = source.first, robot.convention is Convention.STANDARD
    last = _end(robot, source, to_end, along=places == (3,))
    start, squares = robot.joints[first - 1], source.entry == "p.p"
    exact = last is not None
    if squares and not in_world:
        exact &= start.d == ZERO or not (start.is_revolute and (source.outer_left or first == 1))
    rows = places or ((1, 2, 3) if squares else (1, 2))
    if not standard and not in_world:
        exact &= start.a == ZERO or (not squares and source.entry != "p.xy")
        rows = tuple(_turned(start.alpha, row) for row in rows)
    return (last, rows) if exact and last is not None else None


def _end(robot: Robot, source: Provenance, to_end: bool, *, along: bool) -> int | None:
    """The last matrix of the shortest product that ends where M does, carried on to where nothing more is added."""
    joints, last = robot.joints, source.last
    joint = joints[last - 1]
    is_open = source.outer_right or (last == robot.n and not to_end)
    if to_end and last == robot.n:
        return last
    if robot.convention is Convention.STANDARD:
        if joint.is_revolute and (is_open or joint.d == ZERO):
            last -= 1
        elif joint.a != ZERO and not (along and source.first == last):  # a adds nothing along the axis of its joint
            return None
    elif joint.is_revolute and is_open and joint.d != ZERO:
        return None
    while last < robot.n and joints[last].is_revolute and joints[last].a == joints[last].d == ZERO:
        last += 1
    return last


def _back(robot: Robot, source: Provenance, places: tuple[int, ...], in_world: bool) -> Seen:
    """The position at which M begins, seen from where it ends."""
    first, last, standard = source.first, source.last, robot.convention is Convention.STANDARD
    begin, end = robot.joints[first - 1], robot.joints[last - 1]
    exact = in_world or not begin.is_revolute or begin.d == ZERO or not (source.outer_left or first == 1)
    rows = places or (1, 2)
    if standard:
        exact &= end.a == ZERO or bool(places)
        rows = tuple(_turned(end.alpha, row) for row in rows)
    else:
        exact &= begin.a == ZERO or in_world
    return (last, rows) if exact else None


def _turned(angle: Expression, index: int) -> int:
    """The number of an axis after a turn about x, 0 where it is none of the axes."""
    exact = decompose(angle)
    quarters = exact.pi_multiple * 2
    if index == 1:
        return 1
    if exact.terms or quarters.denominator != 1:
        return 0
    return index if quarters % 2 == 0 else 5 - index
