"""Formulas with several values, such as those of inverse kinematics: right for all of their branches, or for some."""

import itertools
from collections.abc import Iterator, Sequence
from contextlib import suppress
from math import hypot, remainder, tau

from derive.checking.formulas.edits import NO_VALUE, float_value, nodes
from derive.model.equality import samples
from derive.robot import expression as tree
from derive.robot.expression import ONE, Call, Expression, Name, Number, Pi, Product, Sum
from derive.robot.robot import Robot

SIGN = "±"  # first letter of the name of a plus-minus
POINTS = 24  # points at which two sides are compared
SIGNS = 6  # signs of one equation that are tried in all combinations
CLOSE = 1e-8  # relative difference of two values, or that of two angles up to full turns
ONLY_AT_POINTS = ("Atan2", "acos", "asin", "atan")  # what only a comparison at points understands
ARCS = ("atan2", *ONLY_AT_POINTS)


def has_branches(e: Expression, functions: Sequence[str]) -> bool:
    """Whether a formula stands for several values: a plus-minus or one of some functions occurs."""
    own = (isinstance(e, Name) and e.name[0] == SIGN) or (isinstance(e, Call) and e.function in functions)
    return own or any(has_branches(child, functions) for child in tree.children(e))


def branches(robot: Robot, one: Expression, other: Expression) -> tuple[int, int]:
    """How many points give both sides a value, and at how many of them some signs make them equal, up to full turns."""
    joints = {joint.variable for joint in robot.movers if joint.is_revolute}
    modulus = tau if all(_is_angle(side, joints) for side in (one, other)) else 0.0
    wanted = sorted({*tree.names(one), *tree.names(other)})
    signs = [name for name in wanted if name[0] == SIGN][:SIGNS]
    sides = [_with_one_arc(side) for side in (one, other)]  # Atan2 may have the cosine first
    variants = [[with_atan2(side, "Atan2", turned) for side in sides] for turned in (False, True)]
    variants = variants[: 1 + any(count_calls(side, "Atan2") > 0 for side in (one, other))]
    points = samples(robot, [name for name in wanted if name[0] != SIGN])
    values = ({name: float(value) for name, value in point.items()} for point in points)
    near = (list(_nearness(variants, known, signs, modulus)) for known in values)
    alike = [any(each) for each in itertools.islice(filter(None, near), POINTS)]
    return len(alike), sum(alike)


def _nearness(
    variants: Sequence[Sequence[Expression]], values: dict[str, float], signs: Sequence[str], modulus: float
) -> Iterator[bool]:
    """Whether two sides are near each other, for each choice of signs that gives both a value."""
    for one, other in variants:
        for chosen in itertools.product((1.0, -1.0), repeat=len(signs)):
            here = values | dict(zip(signs, chosen, strict=True))
            with suppress(*NO_VALUE):
                a, b = float_value(one, here), float_value(other, here)
                gap = remainder(a - b, modulus) if modulus else a - b
                yield abs(gap) <= CLOSE * (1 if modulus else hypot(1, a, b))


def _is_angle(e: Expression, joints: set[str]) -> bool:
    """Whether an expression is a sum of joint angles, arc functions and multiples of pi."""
    match e:
        case Name(name):
            return name in joints
        case Call(function, _):
            return function in ARCS
        case Pi() | Number(0):
            return True
        case Sum(terms):
            return all(_is_angle(term, joints) for term in terms)
        case Product(factors):
            rest = [f for f in factors if not isinstance(f, Number) and not (isinstance(f, Name) and f.name[0] == SIGN)]
            return len(rest) == 1 and _is_angle(rest[0], joints)
    return False


def count_calls(e: Expression, function: str) -> int:
    """How often a function is called."""
    return sum(isinstance(node, Call) and node.function == function for node in nodes(e))


def with_atan2(e: Expression, function: str, swapped: bool) -> Expression:
    """An expression with atan2 in the place of a function of two arguments."""
    whole = tree.rebuilt(e, lambda part: with_atan2(part, function, swapped))
    if isinstance(whole, Call) and whole.function == function:
        return Call("atan2", whole.arguments[::-1] if swapped else whole.arguments)
    return whole


def _with_one_arc(e: Expression) -> Expression:
    """The formula with atan2 for all arc functions of one argument."""
    e = tree.rebuilt(e, _with_one_arc)
    match e:
        case Call("acos", (x,)):  # acos x = atan2(sqrt(1 - x^2), x)
            return Call("atan2", (other_leg(x), x))
        case Call("asin", (y,)):
            return Call("atan2", (y, other_leg(y)))
        case Call("atan", (x,)):
            return Call("atan2", (x, ONE))
    return e


def other_leg(x: Expression) -> Expression:
    """The root of 1 - x^2."""
    return Call("sqrt", (tree.add(ONE, tree.negate(tree.power(x, 2))),))
