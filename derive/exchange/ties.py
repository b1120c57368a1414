"""Joints that depend on each other, as other programs have them: each with its own position, and equations between.

Closed loops of a robot file are written so, and what closes loops in an MJCF is read as loops of a robot file.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import groupby, product
from math import inf, remainder, tau

import numpy as np
from flint import arb, arb_mat

from derive.errors import DeriveError, QuantityError, RobotFileError, listed
from derive.exchange.arm import direction_of, frame_at, joints_between
from derive.exchange.certificate import ball
from derive.exchange.numeric import text
from derive.exchange.reading.elements import MOVING, Urdf, UrdfJoint, free_name
from derive.inverse.loops.closing import are_opposed, gaps
from derive.inverse.loops.linkage import SolvedLoop, assembled, linkage, positions
from derive.mechanics.floats import ArrayDomain
from derive.mechanics.space import NOTHING, WORLD, Frame, Point, Real, length, plus, unit
from derive.mechanics.vectors import cross, dot
from derive.robot.description import End, Joining, Joint, Loop, Variable, coupling
from derive.robot.evaluate import to_float
from derive.robot.expression import Name
from derive.robot.robot import Robot
from derive.robot.tree import ends

Sum = tuple[tuple[str, Real], ...]  # labels of joints with the factors of their positions


@dataclass(frozen=True, slots=True)
class Joined:
    """Two frames that a closed loop joins."""

    ends: tuple[str, str]  # the ends that stand for them
    by: Joining
    way: int  # along which of the first one's z axis that of the second points: 1, or -1 where they are opposed
    stretch: float  # of a rod, by how much it is longer than the way between them where all joints are at zero [m]


@dataclass(frozen=True, slots=True)
class Ties:
    """Equations between the positions of joints."""

    driven: Mapping[str, Sum]  # by the label of a joint what its position is
    variables: Mapping[str, Sum]  # what variables are that are no position of a joint, by name
    passive: frozenset[str] = frozenset()  # labels of joints that loops move
    loops: tuple[Joined, ...] = ()
    closed: tuple[float, ...] = ()  # positions of all joints with which the loops are closed [rad or m]


NONE = Ties({}, {})


def untied(robot: Robot) -> tuple[Robot, Ties]:
    """A robot of numbers with a variable for every joint, and the equations between these."""
    if not robot.coupled:
        return robot, NONE
    # x = S v of joints that are no passive ones of loops: n independent rows x_b of S give v = S_b^-1 x_b, and with it
    # the other rows, x = S S_b^-1 x_b.
    rows = [k for k, joint in enumerate(robot.joints) if not joint.follows]
    matrix = coupling(robot, lambda factor: arb(0) if isinstance(factor, Name) else ball(factor))
    basis: list[int] = []
    for k in sorted(rows, key=lambda k: bool(robot.joints[k].drive)):
        found = np.array([[float(factor) for factor in matrix[row]] for row in (*basis, k)])
        basis += [k] if np.linalg.matrix_rank(found) == len(found) else []
    inverse = arb_mat([matrix[k] for k in basis]).inv()
    labels = [robot.joints[k].label for k in basis]

    def _sum(factors: Sequence[arb]) -> Sum:
        return tuple((label, f) for label, f in zip(labels, factors, strict=True) if not abs(f) < NOTHING)

    driven = {robot.joints[k].label: _sum((arb_mat([matrix[k]]) * inverse).entries()) for k in rows if k not in basis}
    own = {joint.variable for joint in robot.joints if not joint.drive}
    sums = zip(robot.coupled, inverse.tolist(), strict=True)
    bare = replace(robot, joints=tuple(_alone(robot, joint) for joint in robot.joints), coupled=())
    ties = Ties(driven, {each.variable: _sum(row) for each, row in sums if each.variable not in own})
    return _open(robot, bare, ties) if robot.loops else (bare, ties)


def _alone(robot: Robot, joint: Joint) -> Joint:
    """A joint with a variable of its own, which is its label where that was none."""
    if joint.drive:
        return replace(joint, variable=joint.label, drive=())
    alike = next((v for v in robot.coupled if v.variable == joint.variable), joint)
    limits, speed, torque = joint.limits or alike.limits, joint.speed or alike.speed, joint.torque or alike.torque
    return replace(joint, limits=limits, speed=speed, torque=torque, follows=())


def _open(robot: Robot, bare: Robot, ties: Ties) -> tuple[Robot, Ties]:
    """With its loops open: an end stands for each of the frames that they join."""
    loops, more = [], []
    values, q, full, _ = assembled(robot, linkage(robot))
    rest = ArrayDomain(robot, [np.zeros(1)] * robot.n, values)
    for k, loop in enumerate(robot.loops, 1):
        if loop.by is Joining.PRISMATIC:
            raise DeriveError(
                f"the loop of {robot.name} that joins {listed(loop.join)} by a slide",
                allowed="allowed in other programs: revolute, spherical, distance and fixed",
                remedy="write the slide as a row of the table, and close by: fixed",
                location=loop.location,
            )
        first, second = (free_name(f"loop{k}_{side}", [end.name for end in robot.ends]) for side in ("first", "second"))
        is_opposed = loop.by is Joining.REVOLUTE and are_opposed(robot, loop)
        stretch = to_float(loop.length, values) - float(np.linalg.norm(gaps(robot, loop, rest)))
        loops.append(Joined((first, second), loop.by, -1 if is_opposed else 1, stretch))
        more += [End(first, loop.join[0]), End(second, loop.join[1])]
    nearest = int(np.argmin(sum(np.square(x) for x in q)))
    closed = tuple(float(x[nearest]) for x in full)
    whole = tuple(replace(end, name=end.name or "tool") for end in ends(bare))
    ties = replace(ties, passive=frozenset(joint.label for joint in robot.passive), loops=tuple(loops), closed=closed)
    return replace(bare, ends=(*whole, *more), loops=()), ties


def in_words(total: Sum) -> str:
    """A sum of positions as text: ``shoulder + 0.5*elbow``."""
    terms = (label if factor == 1 else f"{text(factor)}*{label}" for label, factor in total)
    return " + ".join(terms).replace("+ -", "- ")


# -- what closes loops in an MJCF, ``equality connect`` and ``weld``, as loops of a robot file

_APART = 1e-9  # two points of an axis are farther from each other [m], and directions differ by more
_SEEN = 1e-3  # how near to the file's the positions of passive joints are in its branch [rad or m]


@dataclass(frozen=True, slots=True)
class Join:
    """Two frames that are joined, each on a link, and the joints of the loop that they close."""

    links: tuple[str, str]
    frames: tuple[Frame, Frame]
    by: Joining
    around: tuple[UrdfJoint, ...]


def turn_to(axis: Point) -> Frame:
    """A rotation that takes z to a unit vector: axes change places where it is one of them."""
    largest = max(range(3), key=lambda k: abs(float(axis[k])))
    beside = (WORLD.y, WORLD.z, WORLD.x)[largest]
    across = tuple(own - axis[(largest + 1) % 3] * along for own, along in zip(beside, axis, strict=True))
    return Frame.of(WORLD.origin, unit((across[0], across[1], across[2])), axis)


def joins(urdf: Urdf, joints: Sequence[UrdfJoint], snap: Fraction) -> Iterator[Join]:
    """The loops of a file; points that connect the same links are one pin, and so is one of a plane linkage."""
    at_zero = {joint.parent: WORLD for joint in joints[:1]}
    for joint in joints:
        at_zero[joint.child] = at_zero[joint.parent].then(frame_at(joint.origin, snap))
    for (links, is_weld), group in groupby(urdf.closures, key=lambda each: (each.links, each.is_weld)):
        around = tuple(joint for joint in joints_between(urdf, *links[::-1])[::-1] if joint.type in MOVING)
        frames, *others = [[frame_at(origin, snap) for origin in each.origins] for each in group]
        by, axes = Joining.FIXED if is_weld else Joining.SPHERICAL, list[Point]()
        ways = [[plus(end.origin, own.origin, -1) for end, own in zip(pair, frames, strict=True)] for pair in others]
        ways = [pair for pair in ways if length(pair[0]) > _APART]  # no point twice
        turns = [(joint, at_zero[joint.child].direction(direction_of(joint, snap))) for joint in around]
        if not is_weld and ways:
            axes = [unit(way) for way in ways[0]]
            if any(length(cross(axis, way)) > _APART for pair in ways for axis, way in zip(axes, pair, strict=True)):
                found = f"{len(ways) + 1} points connect {listed(links)}, which are not on one line"
                raise RobotFileError(f"{urdf.source}: {found}", remedy="write equality weld")
        elif not is_weld and (normal := _normal(turns)):
            axes = [WORLD.seen_from(at_zero[link]).direction(normal) for link in links]
        if axes:
            turned = zip(frames, map(turn_to, axes), strict=True)
            by, frames = Joining.REVOLUTE, [Frame(f.origin, t.x, t.y, t.z) for f, t in turned]
        yield Join(links, (frames[0], frames[1]), by, around)


def _normal(axes: Sequence[tuple[UrdfJoint, Point]]) -> Point | None:
    """Of the plane in which all joints of a loop move; None where there is none."""
    found = next((axis for joint, axis in axes if MOVING[joint.type]), None)
    plane = found is not None and all(
        length(cross(found, axis)) < _APART if MOVING[joint.type] else abs(dot(found, axis)) < _APART
        for joint, axis in axes
    )
    return found if plane else None


def variable_of(joint: Joint) -> Variable:
    """That of a joint which follows no other."""
    return Variable(joint.variable, joint.type, joint.limits, joint.speed, joint.torque)


def closed(robot: Robot, urdf: Urdf, found: Sequence[Join], labels: Mapping[str, str]) -> tuple[Robot, str]:
    """The tree with its loops, in the branch in which the file has them; joints around them without motors follow."""
    # ``labels`` are those of the rows of joints by their names. And a remark where the file has no closed
    # configuration.
    around = {joint.name: joint for join in found for joint in join.around if joint.mimics is None}
    passive = {labels[name] for name in around if name not in urdf.driven}
    if len(passive) == len(around):
        what = f"{urdf.source}: no motor drives a joint of the loops, {listed(labels[name] for name in around)}"
        raise RobotFileError(what, remedy="add an actuator to each joint that is driven")
    own = [joint for joint in robot.joints if not joint.drive and joint.label not in passive]
    active = tuple(map(variable_of, own))
    slopes = ((j, tuple((v.variable, Name(f"G_{j.variable}_{v.variable}")) for v in active)) for j in robot.joints)
    joints = tuple(replace(joint, follows=own) if joint.label in passive else joint for joint, own in slopes)
    names = [row.name for row in robot.fixed[-2 * len(found) :]]
    loops = tuple(Loop((names[2 * k], names[2 * k + 1]), join.by) for k, join in enumerate(found))
    made = replace(robot, joints=joints, coupled=active, loops=loops)
    for posture in urdf.postures:
        at = {labels[name]: value for name, value in posture.items() if name in labels}
        if branch := _on_branch(made, [np.array([at.get(joint.label, 0.0)]) for joint in robot.joints]):
            return branch, ""
    linkage(made)  # refuses what it cannot solve
    return made, "no configuration of the file closes its loops: the first branch is taken"


def _on_branch(robot: Robot, at: Sequence[np.ndarray]) -> Robot | None:
    """The robot with the branches of its loops in which its joints are at some positions; None where none is."""
    places = {joint.variable: x for joint, x in zip(robot.joints, at, strict=True)}
    q, loops = [places[variable.variable] for variable in robot.variables], list(robot.loops)
    for k in range(len(loops)):
        try:
            solved = linkage(replace(robot, loops=tuple(loops[: k + 1])))[-1]
        except QuantityError:  # perhaps together with those below
            continue
        nodes = solved.graph.nodes if isinstance(solved, SolvedLoop) else ()
        for signs in product("+-", repeat=sum(node.formulas[0].branches > 1 for node in nodes)):
            loops[k] = replace(loops[k], branch="".join(signs))
            part = replace(robot, loops=tuple(loops[: k + 1]))
            try:
                full, exists = positions(part, linkage(part), q)
            except QuantityError:  # a branch in which it cannot be assembled
                continue
            gaps = ((float(full[p][0] - at[p][0]), part.joints[p].is_revolute) for p in solved.passive)
            if exists.all() and all(abs(remainder(gap, tau if turns else inf)) < _SEEN for gap, turns in gaps):
                break
        else:
            return None
    linkage(found := replace(robot, loops=tuple(loops)))  # refuses what it cannot solve
    return found
