"""Closed loops in any scalars: where their frames are, how they move, and by how much they miss each other.

Rows of several loops that are solved together stand one below the other, six for each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.algebra.ring import determinant
from derive.errors import QuantityError, listed
from derive.mechanics.chain import Chain, Domain, build_chain, way_frame
from derive.mechanics.floats import ArrayDomain
from derive.mechanics.vectors import Frame, S, Vector, add, column, cross, dot, multiply, scale, subtract, transpose
from derive.robot import tree
from derive.robot.description import Joining, Loop, coupling
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import ZERO, Expression, Name, Power
from derive.robot.names import free_symbols
from derive.robot.robot import Robot

Array = npt.NDArray[Any]
Twist = tuple[Any, ...]  # linear velocity, then angular velocity, per unit of one rate

SAMPLES = 256  # configurations at which a loop is looked at
OPEN = 1e-9  # frames that miss each other by more [m, and entries of rotations] are not joined


@dataclass(frozen=True, eq=False, kw_only=True)
class Closing:
    """Loops that are solved together, and the rows of their velocities."""

    loops: tuple[Loop, ...]
    passive: tuple[int, ...]  # indices of the joints that they determine
    rows: tuple[int, ...] = ()  # of the twists, that determine the passive rates
    in_frame: bool = False  # whether the twists are in the axes of first frames, not of where branches begin

    @property
    def loop(self) -> Loop:
        """The first of them."""
        return self.loops[0]

    def determinant(self, columns: Mapping[int, Twist]) -> Any:
        """det J_p of the twists of the loop's joints."""
        return determinant([[columns[p][row] for p in self.passive] for row in self.rows])

    def numerators(self, columns: Mapping[int, Twist], right: Sequence[Any]) -> list[Any]:
        """x det J_p of J_p x + right = 0, for each passive joint, by Cramer's rule."""
        rows = [[columns[p][row] for p in self.passive] for row in self.rows]
        replaced = ([[*r[:at], -e, *r[at + 1 :]] for r, e in zip(rows, right, strict=True)] for at in range(len(rows)))
        return [determinant(matrix) for matrix in replaced]

    def first(self, robot: Robot, columns: Mapping[int, Twist], domain: Domain[Any]) -> Iterator[tuple[Name, Any]]:
        """The first derivatives by name, numerators over det J_p."""
        matrix = coupling(robot)
        for k, variable in enumerate(robot.variables):
            shares = [(m, domain.constant(matrix[m][k])) for m in columns if m not in self.passive]
            right = [sum((columns[m][row] * share for m, share in shares), domain.number(0)) for row in self.rows]
            for p, numerator in zip(self.passive, self.numerators(columns, right), strict=True):
                if (name := dict(robot.joints[p].follows).get(variable.variable)) is not None:
                    yield name, numerator


def _frames(robot: Robot, loop: Loop, domain: Domain[S]) -> tuple[Chain[S], list[Frame[S]], list[Frame[S]]]:
    """The chain, and the joint frames and joined frames of a loop, in the frame on which its branches begin."""
    chain, own = build_chain(robot, domain), {k for branch in tree.around(robot, loop) for k in branch}
    frames: list[Frame[S]] = []
    for i, joint in enumerate(chain.joints):
        # Rows of velocities in axes that turn with the rest of the tree would fail at some of its positions.
        before = frames[joint.parent] if joint.parent in own else chain.unit
        frames.append(before @ (joint.fixed @ joint.motion(chain.zero, chain.one)) if i in own else chain.unit)
    joined: list[Frame[S]] = []
    for carrier, behind in (way_frame(robot, label, domain) for label in loop.join):
        frame = frames[carrier] @ chain.ends[carrier] if carrier >= 0 else chain.unit
        joined.append(frame if behind is None else frame @ behind)
    return chain, frames, joined


@lru_cache(64)
def are_opposed(robot: Robot, loop: Loop) -> bool:
    """Whether the z axes of the joined frames are opposed wherever the joints are: so is then that of the pin."""
    source = np.random.default_rng(3)
    values = parameter_values(robot, {name: source.uniform(0.2, 1.0) for name in free_symbols(robot)})
    _, _, joined = _frames(robot, loop, ArrayDomain(robot, list(source.uniform(-2, 2, (robot.n, SAMPLES))), values))
    one, other = (column(frame.rotation, 2) for frame in joined)
    return bool(np.all(np.abs(dot(one, other) + 1.0) < OPEN))


def lengths(robot: Robot) -> list[Expression]:
    """The lengths of all rows and rods [m]."""
    cells = [cell for joint in robot.joints for cell in (joint.a, joint.d)] + tree.lengths(robot)
    return cells + [loop.length for loop in robot.loops]


def reach(robot: Robot, values: Mapping[str, Any]) -> float:
    """The lengths of all rows together [m], further than which no slide goes; 1 where there are none."""
    return sum(abs(to_float(cell, values)) for cell in lengths(robot)) or 1.0


def gaps(robot: Robot, loop: Loop, domain: Domain[S]) -> Vector[S]:
    """The way between the origins of the joined frames, zero where they are one."""
    _, _, (one, other) = _frames(robot, loop, domain)
    return subtract(one.position, other.position)


def slides(robot: Robot, loop: Loop, domain: Domain[S], places: Sequence[int]) -> tuple[Vector[S], list[Vector[S]]]:
    """The way between the origins of the joined frames where some slides are at zero, and how it changes with each."""
    _, frames, (one, other) = _frames(robot, loop, domain)
    way, ways = subtract(one.position, other.position), list[Vector[S]]()
    for k in places:
        joint, (first, _) = replace(robot.joints[k], d=ZERO), tree.around(robot, loop)
        ways.append(scale(joint.sign if k in first else -joint.sign, column(frames[k].rotation, 2)))
        way = subtract(way, scale(domain.joint_offset(k, replace(joint, sign=1)), ways[-1]))
    return way, ways


def twists(robot: Robot, one: Closing, domain: Domain[S]) -> tuple[dict[int, Twist], list[Twist]]:
    """Twists of first frames against second ones, per rate of each joint and of those of the closures."""
    parts = [_twists(robot, loop, domain, in_frame=one.in_frame) for loop in one.loops]
    if len(parts) == 1:
        return parts[0]
    found, closing, still = dict[int, Twist](), list[Twist](), (domain.number(0),) * 6
    for k in sorted({k for own, _ in parts for k in own}):
        found[k] = tuple(x for own, _ in parts for x in own.get(k, still))
    for at, (_, own) in enumerate(parts):
        closing += [(*still * at, *axis, *still * (len(parts) - 1 - at)) for axis in own]
    return found, closing


def _twists(robot: Robot, loop: Loop, domain: Domain[S], *, in_frame: bool) -> tuple[dict[int, Twist], list[Twist]]:
    chain, frames, joined = _frames(robot, loop, domain)
    end, back, is_slide = joined[0], transpose(joined[0].rotation), loop.by is Joining.PRISMATIC
    # Unless one slides along the other their origins are one point, to which each branch has a way of its own.
    points = [end.position, end.position if is_slide else joined[1].position]
    rod = subtract(*points[::-1]) if loop.by is Joining.DISTANCE else None

    def _in_axes(linear: Vector[S], angular: Vector[S]) -> Twist:
        if rod is not None:  # ball joints leave the velocity along it alone
            return (dot(rod, linear), *chain.null, *chain.null[:2])
        return (*multiply(back, linear), *multiply(back, angular)) if in_frame else (*linear, *angular)

    found: dict[int, Twist] = {}
    for branch, way, point in zip(tree.around(robot, loop), (1, -1), points, strict=True):
        for k in branch:
            z = scale(way * robot.joints[k].sign, column(frames[k].rotation, 2))
            turns = chain.joints[k].revolute
            linear = cross(z, subtract(point, frames[k].position)) if turns else z
            found[k] = _in_axes(linear, z if turns else chain.null)
    z = column(end.rotation, 2)
    axes = {Joining.REVOLUTE: [z], Joining.SPHERICAL: [column(end.rotation, i) for i in range(3)]}.get(loop.by, [])
    slides = [_in_axes(z, chain.null)] if is_slide else []
    return found, [*slides, *(_in_axes(chain.null, axis) for axis in axes)]


def openings(robot: Robot, one: Closing, domain: Domain[S]) -> tuple[list[S], list[S]]:
    """By how much the first frames are off the second ones, in the rows of `twists`, of which these are the rates.

    And all that is zero where the loops are closed and only there [m, and entries of rotations].
    """
    rows, misses = list[S](), list[S]()
    half, nothing = domain.number(Fraction(1, 2)), domain.number(0)
    for loop in one.loops:
        _, _, (first, second) = _frames(robot, loop, domain)
        gap, turn = subtract(first.position, second.position), (nothing,) * 3
        if loop.by is Joining.DISTANCE:
            length = domain.constant(loop.length)
            rows += [half * (length * length - dot(gap, gap)), *(nothing,) * 5]
            misses.append(rows[-6] * domain.constant(Power(loop.length, -1)))
            continue
        if loop.by is Joining.PRISMATIC:  # what is beside the axis
            z = column(first.rotation, 2)
            gap = subtract(gap, scale(dot(z, gap), z))
        axes = {Joining.REVOLUTE: (2,), Joining.SPHERICAL: ()}.get(loop.by, (0, 1, 2))
        way = domain.number(-1 if loop.by is Joining.REVOLUTE and are_opposed(robot, loop) else 1)
        for k in axes:
            u, v = scale(way, column(second.rotation, k)), column(first.rotation, k)
            turn = add(turn, scale(half if len(axes) == 3 else domain.number(1), cross(u, v)))
            misses.append(dot(u, v) - domain.number(1))  # half a turn is no closure either
        misses += [*gap, *turn]
        if one.in_frame:
            back = transpose(first.rotation)
            gap, turn = multiply(back, gap), multiply(back, turn)
        rows += [*gap, *turn]
    return rows, misses


def refused(robot: Robot, loop: Loop, found: str, allowed: str = "", remedy: str = "") -> QuantityError:
    """An error about a loop."""
    what = f"the loop of {robot.name} that joins {listed(loop.join)}: {found}"
    return QuantityError(what, allowed=allowed, remedy=remedy, location=loop.location)
