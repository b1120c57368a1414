"""A Denavit-Hartenberg table from a product of elementary transforms: ``Rz(q1) Tz(d1) Tx(a2) Rx(pi/2) ...``.

The axis of every joint becomes z: a joint about x is Rot(y, pi/2) Z Rot(y, -pi/2), one about y Rot(x, -pi/2) Z Rot(x,
pi/2). The constants that then stand between two joints are split as

    W = Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha) Trans(z, d') Rot(z, theta'),

the common normal of both axes between two motions along them, of which the first belongs to the row before and the
second to the row behind (Corke, A simple and systematic approach to assigning Denavit-Hartenberg parameters, 2007, for
the aim). Right angles are kept as permutations of the axes, so cells stay exact.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import accumulate, chain, takewhile

from derive.algebra.angles import composed, decompose
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.errors import ExpressionError, Location, RobotFileError, quoted
from derive.exchange.convert import converted
from derive.mechanics.chain import build_chain
from derive.mechanics.convention import Cells
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.mechanics.vectors import Frame, Matrix, about_axis, identity, matmul
from derive.robot import expression as tree
from derive.robot.description import IDENTITY, Convention, Description, Joint, JointType
from derive.robot.expression import ZERO, Call, Expression, Name, Pi, names
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.robot.writer import robot_text

_SOURCE = "--from-transforms"
_TRANSFORM = re.compile(r"(?P<kind>[RrTt])(?P<axis>[xyz])\s*\(")
_BETWEEN = " \t\r\n*@.\u2295\u00b7"  # what may stand between two transforms
_VARIABLE = re.compile(r"q[0-9]*|(?:theta|th)[0-9]+")
_FORM = "allowed: Rx, Ry, Rz, Tx, Ty and Tz with a cell, such as Rz(q1) Tz(d1) Rx(pi/2); q1 or theta1 is a joint"

Permutation = Matrix[int]  # a rotation by right angles, rows of entries 0, 1 and -1


@dataclass(frozen=True, slots=True)
class Elementary:
    """A rotation about an axis, or a translation along it."""

    turns: bool
    axis: int  # 0, 1, 2 for x, y, z
    cell: Expression  # angle [rad] or length [m]; of a joint what is added to its variable
    variable: str = ""  # of a joint; empty for a constant
    sign: int = 1  # factor of the variable


def robot_of_transforms(text: str, name: str, convention: Convention = Convention.STANDARD) -> str:
    """The robot file of a product of elementary transforms, proven to have the same T."""
    product = tuple(_read(text))
    comment = f"The product {' '.join(text.split())}, as a table with the same T (proven)."
    robot = Robot.from_text(robot_text(_table(product, name), [comment]), f"{name}.yaml")
    if convention is not robot.convention:
        robot = Robot.from_text(robot_text(converted(robot, convention).robot, [comment]), f"{name}.yaml")
    # The proof: the table's T and the product of the transforms, multiplied out in one ring, are the same polynomials.
    domain = PolynomialDomain(robot, _atoms(product), rates=False)
    zero, one = domain.number(0), domain.number(1)
    ours, theirs = forward_kinematics(build_chain(robot, domain)), _product(product, domain)
    pairs = zip(chain(*ours.rows(zero, one)), chain(*theirs.rows(zero, one)), strict=True)
    if any(_cleared(a - b, domain) for a, b in pairs):
        raise RobotFileError(
            f"no table is proven to have the product {quoted(text)}",
            remedy="write names for angles in numbers: Rz(beta)",
        )
    return robot_text(robot, [comment])


def _read(text: str) -> Iterator[Elementary]:
    seen: set[str] = set()
    offset = len(text) - len(text.lstrip(_BETWEEN))
    while offset < len(text):
        match, where = _TRANSFORM.match(text, offset), Location(_SOURCE, 1, offset + 1)
        if match is None:
            word = re.split(r"(?<=\w)\b", text[offset:])[0]
            raise ExpressionError(f"unknown transform {quoted(word)}", allowed=_FORM, location=where)
        depths = accumulate((letter == "(") - (letter == ")") for letter in text[match.end() :])
        if (end := next((i for i, depth in enumerate(depths, match.end()) if depth < 0), None)) is None:
            raise ExpressionError(f"{quoted(match[0])} is never closed", allowed=_FORM, location=where)
        place = Location(_SOURCE, 1, match.end() + 1)
        found = _elementary(match["kind"] in "Rr", "xyz".index(match["axis"]), text[match.end() : end], place)
        if found.variable in seen:
            twice = f"the variable {found.variable} twice"
            raise ExpressionError(twice, allowed="allowed: each joint once", location=where)
        seen.update([found.variable] if found.variable else [])
        yield found
        offset = len(text) - len(text[end + 1 :].lstrip(_BETWEEN))
    if not seen:
        raise ExpressionError("no joint", allowed=_FORM, location=Location(_SOURCE, 1, 1))


def _elementary(turns: bool, axis: int, text: str, place: Location) -> Elementary:
    degrees = re.fullmatch(r"([^a-z\u00b0]+?)\s*(?:deg|\u00b0)\s*", text) if turns else None
    cell = parse_expression(degrees[1] if degrees else text, place)
    exact = decompose(tree.multiply(tree.number(Fraction(1, 180)), cell, Pi()) if degrees else cell)
    moving = {unit: k for unit, k in exact.terms if isinstance(unit, Name) and _VARIABLE.fullmatch(unit.name)}
    rest = composed(replace(exact, terms=tuple(pair for pair in exact.terms if pair[0] not in moving)))
    if len(moving) > 1 or set(moving.values()) - {1, -1} or any(map(_VARIABLE.fullmatch, names(rest))):
        allowed = "allowed: one variable, with + or - before it, and constants, such as Rz(q1 + pi/2)"
        raise ExpressionError(f"the cell {quoted(text)} of a joint", allowed=allowed, location=place)
    variable, sign = next(((unit.name, int(k)) for unit, k in moving.items()), ("", 1))
    return Elementary(turns, axis, rest, variable, sign)


# -- from the product to the rows

Z = 2
RIGHT = ((1, 0), (0, 1), (-1, 0), (0, -1))  # cosine and sine of 0, 1, 2 and 3 right angles


def _right(axis: int, quarters: int) -> Permutation:
    return about_axis(axis, *RIGHT[quarters % 4], 0, 1)


def _image(turn: Permutation, axis: int) -> tuple[int, int]:
    """The axis, and its sign, to which a rotation by right angles takes an axis."""
    row = next(i for i in range(3) if turn[i][axis])
    return row, turn[row][axis]


def _plus(*cells: Expression) -> Expression:
    """A sum in which equal terms are together."""
    return composed(decompose(tree.add(*cells)))


def _sum(parts: Sequence[Elementary], *, turns: bool) -> Expression:
    """All angles, or all lengths, of motions along one axis."""
    return _plus(*(part.cell for part in parts if part.turns is turns))


def _signed(sign: int, cell: Expression) -> Expression:
    return cell if sign > 0 else _plus(tree.negate(cell))


@dataclass(frozen=True, slots=True)
class _Split:
    """Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha) Trans(z, beyond) Rot(z, twist)."""

    theta: Expression = ZERO
    d: Expression = ZERO
    a: Expression = ZERO
    alpha: Expression = ZERO
    beyond: Expression = ZERO
    twist: Expression = ZERO


def _table(product: Sequence[Elementary], name: str) -> Description:
    words: list[list[Elementary]] = [[]]
    moving = [part for part in product if part.variable]
    for part in product:
        if not part.variable:
            words[-1].append(part)
            continue
        # The joint's axis becomes z: about x by Rot(y, pi/2), about y by Rot(x, -pi/2).
        right = tree.multiply(tree.number(Fraction(1, 2)), Pi())
        before = {0: [Elementary(True, 1, right)], 1: [Elementary(True, 0, tree.negate(right))], 2: []}[part.axis]
        words[-1] += before
        words.append([replace(turn, cell=tree.negate(turn.cell)) for turn in before])
    # the constants before the first joint, and the motions along its axis at their end
    count = next((i for i, part in enumerate(reversed(words[0])) if part.axis != Z), len(words[0]))
    base, along = words[0][: len(words[0]) - count], words[0][len(words[0]) - count :]
    behind = _Split(twist=_sum(along, turns=True), beyond=_sum(along, turns=False))
    end, tool = _last(words[-1])
    joints = []
    for part, row in zip(moving, [*map(_split, words[1:-1]), end], strict=True):
        theta, d = _plus(behind.twist, row.theta), _plus(behind.beyond, row.d)
        theta, d = (_plus(theta, part.cell), d) if part.turns else (theta, _plus(d, part.cell))
        kind = JointType.REVOLUTE if part.turns else JointType.PRISMATIC
        joints.append(Joint(kind, part.variable, part.sign, theta, d, row.a, row.alpha))
        behind = row
    table = Description(name, name, Convention.STANDARD, tuple(joints))
    cells = Cells(Robot.of(table), _atoms([*base, *tool]))
    first, last = (cells.matrix(_product(word, cells.domain), IDENTITY) for word in (base, tool))
    return replace(table, base=first, tool=last)


def _last(word: Sequence[Elementary]) -> tuple[_Split, list[Elementary]]:
    """The constants after the last joint: a row, and what remains for the tool."""
    try:
        row = _split(word)
    except RobotFileError:
        along = list(takewhile(lambda part: part.axis == Z, word))
        return _Split(_sum(along, turns=True), _sum(along, turns=False)), list(word[len(along) :])
    if row.alpha == ZERO:  # both axes are parallel
        row = replace(row, d=_plus(row.d, row.beyond), beyond=ZERO)
        if row.a == ZERO:
            row = replace(row, theta=_plus(row.theta, row.twist), twist=ZERO)
    rest = [Elementary(False, Z, row.beyond), Elementary(True, Z, row.twist)]
    return row, [part for part in rest if part.cell != ZERO]


def _split(word: Sequence[Elementary]) -> _Split:
    """Constants between two joints as motions along both axes and their common normal."""
    parts, turn = _without_right_angles(word)
    # Motions along the first axis leave to the left, those along the second, which is the image of z, to the right.
    axis, sign = _image(turn, Z)
    front = list(takewhile(lambda part: part.axis == Z, parts)) if any(part.axis != Z for part in parts) else []
    parts = [part for part in front if not part.turns] + parts[len(front) :]
    twist, beyond, parts = _peeled(parts, axis, 1)
    theta, d, parts = _peeled(parts, Z, -1)
    last, further, parts = _peeled(parts, axis, 1)  # what a turn about z has brought there
    twist, beyond = _signed(sign, _plus(twist, last)), _signed(sign, _plus(beyond, further))
    turning = {part.axis for part in parts if part.turns}
    lengths = {part.axis for part in parts if not part.turns}
    normal = next(iter(turning or lengths), 0 if axis == Z else 3 - Z - axis)
    if (turning or lengths) - {normal} or (turning and normal in (Z, axis)):
        shown = " ".join(f"{'RT'[not part.turns]}{'xyz'[part.axis]}({tree.to_text(part.cell)})" for part in word)
        allowed = "allowed: a common normal whose direction is an axis, or one that Rz names before it"
        remedy = "turn about the first joint's axis so that the offset lies along one axis: Rz(angle) Tx(length)"
        raise RobotFileError(f"the constants {shown} between two joints", allowed=allowed, remedy=remedy)
    # Rot(z, k pi/2) takes x to the normal; then Rot(x, m pi/2) Rot(z, n pi/2) is what is left of the right angles.
    angle, a = _sum(parts, turns=True), _sum([part for part in parts if part.axis == normal], turns=False)
    k, direction = normal, 1
    if normal == 1 and tree.to_text(a).startswith("-"):  # where an offset is needed anyway, one with a length above 0
        k, direction = -1, -1
    left = matmul(_right(Z, -k), turn)
    m, n = next((m, n) for m in range(4) for n in range(4) if matmul(_right(0, m), _right(Z, n)) == left)
    alpha, a = _plus(_signed(direction, angle), _angle(m)), _signed(direction, a)
    # Any other length v stands in the plane of both axes, at an angle phi to its y axis there:
    #     v (cos phi, sin phi) = d (0, 1) + d' (-sin alpha, cos alpha)
    turned: Expression = ZERO
    for part in parts:
        if part.turns:
            turned = _plus(turned, _signed(direction, part.cell))
        elif part.axis != normal:
            phi = _plus(turned, _angle(1)) if part.axis == Z else turned
            sign = 1 if normal == 0 or part.axis == Z else -direction  # Rot(z, pi/2) takes y to -x
            v = tree.multiply(_signed(sign, part.cell), tree.power(_cosine(_plus(alpha, _angle(-1))), -1))
            d = _plus(d, tree.multiply(_cosine(_plus(alpha, tree.negate(phi))), v))
            beyond = _plus(beyond, tree.multiply(tree.MINUS_ONE, _cosine(phi), v))
    return _Split(_plus(_sum(front, turns=True), theta, _angle(k)), d, a, alpha, beyond, _plus(twist, _angle(n)))


def _cosine(angle: Expression) -> Expression:
    """The cosine of an angle, a number for right angles and a sine where a right angle is added to it."""
    exact = decompose(angle)
    quarters = 2 * exact.pi_multiple
    if quarters.denominator != 1:
        return Call("cos", (angle,))
    rest = composed(replace(exact, pi_multiple=Fraction(0)))
    c, s = RIGHT[int(quarters) % 4]
    if rest == ZERO:
        return tree.number(c)
    # cos(rest + k pi/2) = cos(k pi/2) cos(rest) - sin(k pi/2) sin(rest)
    return tree.multiply(tree.number(c or -s), Call("cos" if c else "sin", (rest,)))


def _angle(quarters: int) -> Expression:
    return tree.multiply(tree.number(Fraction((quarters + 1) % 4 - 1, 2)), Pi())  # from -pi/2 to pi


def _without_right_angles(word: Sequence[Elementary]) -> tuple[list[Elementary], Permutation]:
    """The constants with all rotations by right angles at the end, as one permutation of the axes."""
    parts, turn = [], identity(0, 1)
    for part in word:
        exact = decompose(part.cell)
        if part.turns and not exact.terms and (quarters := 2 * exact.pi_multiple).denominator == 1:
            turn = matmul(turn, _right(part.axis, int(quarters)))
        elif part.cell != ZERO:
            axis, sign = _image(turn, part.axis)
            parts.append(replace(part, axis=axis, cell=_signed(sign, part.cell)))
    return parts, turn


def _peeled(parts: Sequence[Elementary], axis: int, side: int) -> tuple[Expression, Expression, list[Elementary]]:
    """Angle and length of the motions along an axis that go to one end (side -1: the front), and what remains."""
    angle: Expression = ZERO
    length: Expression = ZERO
    rest: list[Elementary] = []
    for part in parts[::-side]:
        if part.axis != axis or (any(other.turns for other in rest)):
            rest.append(part)
        elif part.turns:
            # Trans(v) Rot(beta) = Rot(beta) Trans(Rot(-beta) v): lengths are turned where a turn passes them
            rest = [turned for other in rest for turned in _turned(other, axis, _signed(side, part.cell))]
            angle = _plus(angle, part.cell)
        else:
            length = _plus(length, part.cell)
    return angle, length, rest[::-side]


def _turned(part: Elementary, axis: int, angle: Expression) -> list[Elementary]:
    """A translation after a turn about another axis."""
    along = tree.multiply(_cosine(angle), part.cell)
    sign = 1 if (part.axis - axis) % 3 == 1 else -1
    across = _signed(sign, tree.multiply(_cosine(_plus(angle, _angle(-1))), part.cell))
    return [replace(part, cell=along), replace(part, axis=3 - axis - part.axis, cell=across)]


# -- the proof


def _whole(product: Sequence[Elementary]) -> Iterator[Elementary]:
    """The product with constants along a joint's axis as one, where the table adds them: no ring adds numbers."""
    first = next((part for part in product if part.variable), None)
    runs: list[list[Elementary]] = []
    for part in reversed(product):
        last = runs[-1] if runs else []
        is_full = any(p.variable for p in last) if part.variable else part.axis != Z and first in last
        if not last or last[0].axis != part.axis or is_full:
            runs.append([])
        runs[-1].append(part)
    for run in reversed(runs):
        yield from (Elementary(turns, run[0].axis, _sum(run, turns=turns)) for turns in (True, False))
        yield from (replace(part, cell=ZERO) for part in run if part.variable)


def _atoms(product: Sequence[Elementary]) -> list[Expression]:
    return [x for p in _whole(product) for x in ([Call(f, (p.cell,)) for f in ("cos", "sin")] if p.turns else [p.cell])]


def _product(product: Sequence[Elementary], domain: PolynomialDomain) -> Frame[Polynomial]:
    zero, one = domain.number(0), domain.number(1)
    found = Frame(identity(zero, one), (zero, zero, zero))
    for part in _whole(product):
        cell = tree.multiply(tree.number(part.sign), Name(part.variable)) if part.variable else part.cell
        c, s = domain.cosine_sine(cell if part.turns else ZERO)
        x, y, z = (zero if part.turns or axis != part.axis else domain.constant(cell) for axis in range(3))
        found = found @ Frame(about_axis(part.axis, c, s, zero, one), (x, y, z))
    return found


def _cleared(value: Polynomial, domain: PolynomialDomain) -> Polynomial:
    """A polynomial times its denominators: 1/sin(alpha) has no normal form beside squares of sin(alpha)."""
    for place, generator in enumerate(domain.generators):
        if generator.kind is Kind.INVERSE:
            divisor, most = domain.constant(generator.argument), value.degrees()[place]
            powers = domain.ring.coefficients(value, [place]).items()
            value = sum((part * divisor ** (most - power) for (power,), part in powers), domain.number(0))
    return value
