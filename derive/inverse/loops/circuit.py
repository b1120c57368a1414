"""The way around a closed loop, and the serial arm of its unknown joints; how rods determine these.

Once around a loop all motions make the identity. The joints that are not known yet, those of the closure among them,
are one run of it, U, and the rest K is known, so that U = K^-1: the inverse kinematics of a serial arm whose pose the
variables determine.

A rod says |p_A - p_B|^2 = L^2 of its ends. Seen from before an unknown joint one end is where the variables put it, p.
The other end moves with the joint and is a vector linear in its cosine and sine, or in its length. The square of the
distance is A cos + B sin + C of an angle and a quadratic in a length: two solutions, real where the rod is long and
short enough.

Three rods to one point: its three slides x are at right angles, and |b_i + D x|^2 = L_i^2 are three spheres. Two less
the first one are the planes n_i . x + e_i = 0, of whose line two points are on the sphere.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from itertools import takewhile

from derive.errors import QuantityError
from derive.inverse.closed.graph import Node, SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance
from derive.inverse.closed.unknowns import InverseDomain, baked, shifted, with_numbers
from derive.inverse.loops.closing import slides
from derive.mechanics.chain import Domain, about_z, build_chain, constant_frame, link_factor
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.mechanics.vectors import Frame, S, cross, dot
from derive.robot import tree
from derive.robot.description import (
    BASE,
    IDENTITY,
    Convention,
    FixedRow,
    Joining,
    Joint,
    JointType,
    Loop,
    Matrix,
    Stand,
)
from derive.robot.expression import ONE, ZERO, Call, Expression, Number, Pi, add, multiply, negate, number
from derive.robot.names import own_names
from derive.robot.options.inverse import TASKS, InverseOptions, Task
from derive.robot.robot import Robot

_RIGHT = multiply(Number(Fraction(1, 2)), Pi())
# Angles about x behind the first and second of the three joints that turn about z, y and z.
_BALL = (_RIGHT, negate(_RIGHT))


@dataclass(frozen=True, slots=True)
class Screw:
    """A constant turn about an axis and shift along it."""

    axis: str  # x or z
    angle: Expression  # [rad]
    length: Expression  # [m]


@dataclass(frozen=True, slots=True)
class Passage:
    """A joint passed outwards (+1) or inwards (-1), its variable alone."""

    joint: Joint  # a row of the tree, or one of a closure
    index: int  # of the joint in the tree, -1 of a closure
    way: int


Step = Screw | Passage | Matrix
_OVER = Screw("x", Pi(), ZERO)
_NOTHING = (IDENTITY, Screw("x", ZERO, ZERO), Screw("z", ZERO, ZERO))


@dataclass(frozen=True, slots=True)
class Circuit:
    """A loop as a serial arm of what is unknown in it."""

    arm: Robot  # in the modified convention; variables of the tree's joints keep their names
    places: tuple[int, ...]  # for each joint of the arm its index in the tree, -1 of a closure
    known: tuple[Step, ...]  # what is known, from behind the arm once around to its beginning

    def pose(self, domain: Domain[S]) -> Frame[S]:
        """The pose of the arm, in a domain of the tree."""
        frame, zero, one = constant_frame(IDENTITY, domain), domain.number(0), domain.number(1)
        for step in self.known:
            if isinstance(step, tuple):
                frame = frame @ constant_frame(step, domain)
            elif isinstance(step, Screw):
                x, angle = step.length, step.angle
                frame = frame @ (link_factor(x, angle, domain) if step.axis == "x" else about_z(angle, x, domain))
            else:
                joint, (c, s), d = replace(step.joint, theta=ZERO, d=ZERO), (one, zero), zero
                if joint.is_revolute:
                    c, s = domain.joint_cosine_sine(step.index, joint)
                else:
                    d = domain.joint_offset(step.index, joint)
                moved = Frame(((c, -s, zero), (s, c, zero), (zero, zero, one)), (zero, zero, d))
                frame = frame @ (moved if step.way > 0 else moved.inverse)
        return frame.inverse


def circuit(robot: Robot, loop: Loop, solved: Sequence[int], *, opposed: bool = False) -> Circuit:
    """A loop of which some passive joints are known from loops before; ``opposed`` are z axes of joined frames."""

    def _unknown(steps: Sequence[Step]) -> list[int]:
        motions = [(at, step) for at, step in enumerate(steps) if isinstance(step, Passage)]
        return [at for at, step in motions if step.index < 0 or (step.joint.follows and step.index not in solved)]

    one, other = (list(_outwards(robot, label, loop)) for label in loop.join)
    for inner, outer in ((one, other), (other, one)):
        if loop.by is Joining.DISTANCE and (found := _unknown(outer)):
            before = (*(_back(step) for step in reversed(inner)), *outer[: found[0]])
            return _arm(robot, [Screw("x", ZERO, loop.length), *outer[found[0] :]], before, ())
        # Where a ball joint ends the only branch that has unknown joints, these have a position to reach.
        at = _unknown(outer) if loop.by is Joining.SPHERICAL and not _unknown(inner) else []
        if at and not any(isinstance(step, Passage) for step in outer[at[-1] + 1 :]):
            before = (*(_back(step) for step in reversed(inner)), *outer[: at[0]])
            return _arm(robot, outer[at[0] :], before, TASKS["position"])
    steps = [*(_back(step) for step in reversed(one)), *other, *([_OVER] if opposed else [])]
    # The joints of the closure, from its second frame to its first.
    taken, k, stem = own_names(robot), robot.loops.index(loop) + 1, "psi"
    while any(name.startswith(stem) for name in taken):  # names of their rates are free, too
        stem += "_"
    kind = JointType.PRISMATIC if loop.by is Joining.PRISMATIC else JointType.REVOLUTE
    names = {Joining.FIXED: (), Joining.SPHERICAL: tuple(f"{stem}{k}{a}" for a in "abc")}.get(loop.by, (f"{stem}{k}",))
    for name, twist in zip(names, (*_BALL[: len(names) - 1], ZERO), strict=False):
        steps += [Passage(Joint(kind, name, 1, ZERO, ZERO, ZERO, ZERO), -1, -1), Screw("x", twist, ZERO)]
    unknown = _unknown(steps)
    # Cut where most of what is known lies between two unknown joints: these are the last and the first of the arm.
    twice, firsts = [*steps, *steps], [*unknown[1:], unknown[0] + len(steps)]
    known = {last: tuple(twice[last + 1 : first]) for last, first in zip(unknown, firsts, strict=True)}
    last = max(known, key=lambda at: (sum(isinstance(step, Passage) for step in known[at]), len(known[at])))
    return _arm(robot, twice[last + 1 + len(known[last]) : last + 1 + len(steps)], known[last])


def _outwards(robot: Robot, label: str, loop: Loop) -> Iterator[Step]:
    """From where the branches of a loop meet to the frame of a row."""
    one, other = (tree.rows_to(robot, each) for each in loop.join)
    meeting = sum(a == b for a, b in zip(one, other, strict=False))
    index = {joint.label: k for k, joint in enumerate(robot.joints)}
    fixed = {row.name: row for row in robot.fixed}
    for name in tree.rows_to(robot, label)[meeting:]:
        row: Joint | FixedRow = fixed[name] if name in fixed else robot.joints[index[name]]
        stand = row.stand or Stand(BASE)  # right behind the row above, with nothing between
        link, about_z = Screw("x", row.alpha, row.a), Screw("z", row.theta, row.d)
        yield from _steps(stand.mount)
        yield Screw("z", stand.gamma, stand.b)
        if robot.convention is Convention.MODIFIED:
            yield link
        yield about_z
        if isinstance(row, Joint):
            yield Passage(row, index[name], 1)
        if robot.convention is Convention.STANDARD:
            yield link


def _steps(mount: Matrix) -> Iterator[Step]:
    """A constant transform; one of decimals that keeps the direction of z by angles.

    Of decimals c^2 + s^2 is not 1: equations that hold for a rotation would be missed by what is rounded.
    """
    cells = [cell.value if isinstance(cell, Number) else None for row in mount[:3] for cell in row]
    c, x, s, y, along, z = (cells[k] for k in (0, 3, 4, 7, 10, 11))
    if c is None or s is None or x is None or y is None or z is None or c * c + s * s == 1 or along not in (1, -1):
        yield mount
        return
    way, turn = (math.atan2(y, x) if y else 0.0), math.atan2(s, c)
    yield Screw("z", number(Fraction(way)), number(z))
    yield Screw("x", ZERO, number(Fraction(math.hypot(x, y))) if y else number(x))
    yield Screw("z", number(Fraction(turn - way)), ZERO)
    yield Screw("x", Pi(), ZERO) if along < 0 else Screw("x", ZERO, ZERO)


def _back(step: Step) -> Step:
    if isinstance(step, Passage):
        return replace(step, way=-step.way)
    if isinstance(step, Screw):
        return Screw(step.axis, negate(step.angle), negate(step.length))
    (a, b, c, x), (d, e, f, y), (g, h, i, z), last = step  # (R, p)^-1 = (R^T, -R^T p)
    columns = ((a, d, g), (b, e, h), (c, f, i))
    moved = (negate(add(*(multiply(r, p) for r, p in zip(row, (x, y, z), strict=True)))) for row in columns)
    top = tuple((*row, p) for row, p in zip(columns, moved, strict=True))
    return (*top, last)


def _arm(robot: Robot, steps: Sequence[Step], known: tuple[Step, ...], task: Task = TASKS["pose"]) -> Circuit:
    """The run of unknown joints as rows of the modified convention: what a row cannot hold is a mount before it."""
    rows: list[Joint] = []
    places: list[int] = []
    between: list[Step] = []
    for step in steps:
        if not isinstance(step, Passage):
            between += [step] if step not in _NOTHING else []
            continue
        # What turns about z right behind a joint or right before one belongs to its own row.
        lead = _about_z(between) if rows else []
        trail = _about_z(between[len(lead) :][::-1])
        middle = between[len(lead) : len(between) - len(trail)]
        if lead:
            rows[-1] = _turned(rows[-1], lead)
        about_x = [each for each in middle if isinstance(each, Screw) and each.axis == "x"]
        mount = IDENTITY if len(about_x) == len(middle) else reduce(_product, map(_matrix, middle))
        alpha, a = _sums(about_x) if mount == IDENTITY else (ZERO, ZERO)
        stand, sign = Stand(rows[-1].label if rows else BASE, mount), step.joint.sign * step.way
        joint = Joint(step.joint.type, step.joint.variable, sign, ZERO, ZERO, a, alpha, stand=stand)
        rows.append(_turned(joint, trail))
        places.append(step.index)
        between = []
    given = tuple(robot.joints[k].variable for k in places if k >= 0 and not robot.joints[k].follows)
    tool = reduce(_product, map(_matrix, between), IDENTITY)
    return Circuit(_serial(robot, "loop", tuple(rows), InverseOptions(task, given), tool), tuple(places), known)


def _serial(
    robot: Robot, suffix: str, rows: tuple[Joint, ...], inverse: InverseOptions, tool: Matrix = IDENTITY
) -> Robot:
    """An arm of the modified convention with the parameters of a robot."""
    arm = Robot(f"{robot.name}-{suffix}", "", Convention.MODIFIED, rows, tool=tool, inverse=inverse)
    return tree.plain(replace(arm, parameters=robot.parameters, runtime=robot.runtime))


def _about_z(steps: Sequence[Step]) -> list[Screw]:
    """The steps about z with which a list begins."""
    return [s for s in takewhile(lambda s: isinstance(s, Screw) and s.axis == "z", steps) if isinstance(s, Screw)]


def _sums(screws: Sequence[Screw]) -> tuple[Expression, Expression]:
    return add(*(screw.angle for screw in screws)), add(*(screw.length for screw in screws))


def _turned(row: Joint, screws: Sequence[Screw]) -> Joint:
    """A row with constants about z added to its cells."""
    theta, d = _sums(screws)
    return replace(row, theta=add(row.theta, theta), d=add(row.d, d))


def _matrix(step: Step) -> Matrix:
    """A constant step as a matrix."""
    if isinstance(step, tuple):
        return step
    assert isinstance(step, Screw)
    x, functions = step.length, [Call(name, (step.angle,)) for name in ("cos", "sin")]
    c, s = functions if step.angle != ZERO else (ONE, ZERO)
    if step.axis == "x":
        return ((ONE, ZERO, ZERO, x), (ZERO, c, negate(s), ZERO), (ZERO, s, c, ZERO), IDENTITY[3])
    return ((c, negate(s), ZERO, ZERO), (s, c, ZERO, ZERO), (ZERO, ZERO, ONE, x), IDENTITY[3])


def _product(left: Matrix, right: Matrix) -> Matrix:
    rows = [
        [add(*(multiply(a, b) for a, b in zip(row, column, strict=True))) for column in zip(*right, strict=True)]
        for row in left
    ]
    return tuple((a, b, c, d) for a, b, c, d in rows)


# -- rods


def rod_graph(arm: Robot, is_zero: Sequence[bool]) -> SolutionGraph:
    """The solutions of the first joint of an arm whose first link is the rod.

    Later joints are given, and of the pose the position, of which ``is_zero`` says what vanishes.
    """
    plain, shifts = shifted(with_numbers(arm, {k: cell for k, cell in baked(arm).items() if cell == ZERO}))
    domain, (first, *others) = InverseDomain(plain), plain.joints
    end = forward_kinematics(build_chain(replace(plain, joints=(replace(first, a=ZERO), *others)), domain)).position
    place = (domain.ring.zero if zero else domain.ring.generator(f"T[{i},4]") for i, zero in enumerate(is_zero, 1))
    square = sum(((p - x) ** 2 for p, x in zip(place, end, strict=True)), -(domain.constant(first.a) ** 2))
    unknown = domain.unknown(0)
    terms = domain.ring.coefficients(square, [domain.ring.index[name] for name in unknown.generators])
    if not any(map(any, terms)):
        raise QuantityError("the joint does not change the distance of the ends")
    kind, given = NodeKind.TYPE_2 if unknown.is_angle else NodeKind.QUADRATIC, tuple(range(1, plain.n))
    formula = NodeFormula(kind, (NodeEquation(terms, 2, Provenance(1, 1, "rod")),))
    nodes = [Node(k - 1, (domain.unknown(k),), (NodeFormula(NodeKind.GIVEN),)) for k in given]
    nodes.append(Node(len(given), (unknown,), (formula,), tuple(range(len(given))), formula.branches))
    scale = domain.square_reach
    return SolutionGraph(
        plain, domain, (), given, (), scale, tuple(nodes), shifts, count=2, complete=True, everywhere=True
    )


@dataclass(frozen=True, slots=True)
class ThreeRods:
    """Three rods to a point that three slides move; what is known of them stands in place of a pose."""

    robot: Robot
    loops: tuple[Loop, ...]
    places: tuple[int, ...]  # of the slides; the last one's equation is the quadratic one

    @property
    def arm(self) -> Robot:
        """The slides alone."""
        names = [self.robot.joints[k].variable for k in self.places]
        rows = tuple(Joint(JointType.PRISMATIC, name, 1, ZERO, ZERO, ZERO, ZERO) for name in names)
        return _serial(self.robot, "rods", rows, InverseOptions(TASKS["position"], ()))

    def pose(self, domain: Domain[S]) -> Frame[S]:
        """Columns n_2, n_3, b_1 of differences n_i.x + e_i = 0 and of x.x + 2 b_1.x + c_1 = 0; then e_2, e_3, c_1."""
        columns, rests = [], []
        for loop in self.loops:
            way, ways = slides(self.robot, loop, domain, self.places)
            length = domain.constant(loop.length)
            columns.append([dot(own, way) for own in ways])
            rests.append(dot(way, way) - length * length)
        (b, *others), (c, *ends) = columns, rests
        half = domain.number(Fraction(1, 2))
        normals = [[x - y for x, y in zip(own, b, strict=True)] for own in others]
        x, y, z = zip(*normals, b, strict=True)
        first, second = (half * (end - c) for end in ends)
        return Frame((x, y, z), (first, second, c))


def point_graph(arm: Robot, is_zero: Sequence[Sequence[bool]]) -> SolutionGraph:
    """The solutions of three slides, of whose numbers in place of a pose ``is_zero`` says which vanish."""
    domain = InverseDomain(arm)
    ring = domain.ring
    known = [
        [ring.zero if zero else ring.generator(f"T[{i},{j}]") for j, zero in enumerate(row, 1)]
        for i, row in enumerate(is_zero, 1)
    ]
    (n, m, b), (e, f, c) = zip(*(row[:3] for row in known), strict=True), (row[3] for row in known)
    # The line u along both planes: u_3 x_1 = u_1 x_3 + v_2 and u_3 x_2 = u_2 x_3 - v_1.
    values = [*cross(n, m), *(f * x - e * y for x, y in zip(n[:2], m[:2], strict=True))]
    named = dict(zip(("W[1,4]", "W[2,4]", "W[3,4]", "W[1,1]", "W[2,1]"), values, strict=True))
    u, v, w, one, two = (ring.generator(name) if value else ring.zero for name, value in named.items())
    source, last = Provenance(1, 3, "rods"), domain.unknown(2)
    middle = 2 * (u * two - v * one + w * dot(b, (u, v, w)))
    rest = one * one + two * two + 2 * w * (b[0] * two - b[1] * one) + w * w * c
    square = NodeEquation({(2,): dot((u, v, w), (u, v, w)), (1,): middle, (0,): rest}, 6, source)
    nodes = [Node(0, (last,), (NodeFormula(NodeKind.QUADRATIC, (square,)),), (), 2)]
    for k, start in enumerate((u * ring.generator(*last.generators) + two, v * ring.generator(*last.generators) - one)):
        formula = NodeFormula(NodeKind.TYPE_1, (NodeEquation({(1,): w, (0,): -start}, 3, source),))
        nodes.append(Node(k + 1, (domain.unknown(k),), (formula,), (0,)))
    scale = sum((x * x for row in known for x in row[:3]), ring.zero)
    given = tuple(pair for pair in named.items() if pair[1])
    own = arm, domain, (), (), given, scale, tuple(nodes), (ZERO,) * 3
    return SolutionGraph(*own, count=2, complete=True, everywhere=True)
