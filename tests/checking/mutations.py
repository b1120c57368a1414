"""Slips put into right formulas, written independently of the changes that `derive.checking.formulas.edits` tries."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator

from derive.robot.expression import (
    Call,
    Expression,
    Name,
    Number,
    Power,
    Product,
    Sum,
    add,
    children,
    multiply,
    negate,
    power,
)
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

Mutator = Callable[[Expression, random.Random, Robot], Expression | None]


def paths(e: Expression, path: tuple[int, ...] = ()) -> Iterator[tuple[int, ...]]:
    """Places outside the arguments of functions."""
    yield path
    if not isinstance(e, Call):
        for i, child in enumerate(children(e)):
            yield from paths(child, (*path, i))


def at(e: Expression, path: tuple[int, ...]) -> Expression:
    for i in path:
        e = children(e)[i]
    return e


def put(e: Expression, path: tuple[int, ...], new: Expression) -> Expression:
    if not path:
        return new
    parts = list(children(e))
    parts[path[0]] = put(parts[path[0]], path[1:], new)
    match e:
        case Sum():
            return add(*parts)
        case Product():
            return multiply(*parts)
        case Power(_, exponent):
            return power(parts[0], exponent)
    raise TypeError(e)


def sign(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    if isinstance(e, Sum):
        i = rng.randrange(len(e.terms))
        return add(*e.terms[:i], negate(e.terms[i]), *e.terms[i + 1 :])
    return None


def function(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    swapped = {"cos": "sin", "sin": "cos"}
    return Call(swapped[e.function], e.arguments) if isinstance(e, Call) and e.function in swapped else None


def index(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    if isinstance(e, Name):
        stem = re.sub("[0-9]+$", "", e.name)
        others = [n for n in robot_symbols(robot) if n != e.name and re.sub("[0-9]+$", "", n) == stem]
        return Name(rng.choice(others)) if others else None
    if isinstance(e, Call) and e.function in ("cos", "sin"):
        angles = [joint.variable for joint in robot.joints if joint.is_revolute]
        own = {n.name for n in (*children(e.arguments[0]), e.arguments[0]) if isinstance(n, Name)}
        kept = rng.choice([sorted(own)[:-1], sorted(own)[1:], sorted(own)])
        other = [a for a in angles if a not in own]
        label = [*kept, rng.choice(other)] if other and (not kept or rng.random() < 0.5) else kept
        return Call(e.function, (add(*map(Name, label)),)) if label and set(label) != own else None
    return None


def exponent(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    if isinstance(e, Power):
        return e.base if e.exponent == 2 else None
    return power(e, 2) if isinstance(e, Name | Call) else None


def dropped(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    if isinstance(e, Sum):
        i = rng.randrange(len(e.terms))
        return add(*e.terms[:i], *e.terms[i + 1 :])
    return None


MUTATORS: tuple[Mutator, ...] = (sign, function, index, exponent, dropped)


def mutant(e: Expression, rng: random.Random, robot: Robot, mutate: Mutator) -> Expression | None:
    """The formula with one slip of a kind; None where it offers no place."""
    places = list(paths(e))
    rng.shuffle(places)
    for path in places:
        inside_power = path and isinstance(at(e, path[:-1]), Power)
        changed = None if inside_power and mutate is exponent else mutate(at(e, path), rng, robot)
        if changed is not None and not isinstance(at(e, path), Number):
            return put(e, path, changed)
    return None
