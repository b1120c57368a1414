"""Closed loops in any scalars: where their frames are, how they move, and by how much they miss each other.

Rows of several loops that are solved together stand one below the other, six for each.

Loops that no elementary equations solve are closed together, by Newton's method from the last configuration. With phi
by how much the joined frames miss each other and J_p its derivatives, x_p <- x_p - s J_p^-1 phi, where s <= 1 keeps the
largest change of a step small, so that the assembly stays the one of the start. An assembly is found once, by steps of
least squares from many random configurations; others are reached from it along a straight way of variables.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
from derive.robot.description import Joining, Joint, Loop, Variable, coupling
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import ZERO, Expression, Name, Power
from derive.robot.names import free_symbols, limit_symbols, robot_symbols
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


def drawn(
    robot: Robot, joints: Iterable[Variable | Joint], values: Mapping[str, Any], source: np.random.Generator, count: int
) -> list[Array]:
    """Random positions of joints within their limits; of one without half a turn, or all lengths, to either side."""
    found, way = list[Array](), reach(robot, values)
    for joint in joints:
        most = math.pi if joint.is_revolute else way
        low, high = (to_float(limit, values) for limit in joint.limits) if joint.limits else (-most, most)
        found.append(source.uniform(low, high, count))
    return found


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


# -- loops without formulas

STEP = 0.5  # most that a joint moves in a step [rad, or of all lengths together]
STEPS = 8  # of generated code
_STARTS = 96  # random configurations from which an assembly is looked for
_SEARCH, _FOLLOW, _LEGS = 60, 6, 16  # steps of a search, and of each leg of the way to a configuration
_DIFFERENCE = 1e-30  # of complex numbers, whose imaginary parts are derivatives
_SMALL, _SETTLED = 1e-14, 1e-8  # damping of J^T J, which must have an inverse, and the last step that matters
_RANK = 1e-7  # singular values below this part of the largest are rounding
# Positions of all joints where the loops before are closed, by those of the variables and numbers of symbols.
Before = Callable[[Sequence[Array], Mapping[str, float]], list[Array]]
# Variables, passive joints, what is missing, and singular values of J_p.
Found = tuple[Array, Array, Array, Array]


@dataclass(frozen=True, kw_only=True)
class IteratedLoops(Closing):
    """Loops whose passive joints have no formulas; equal ones are searched once."""

    robot: Robot  # its table alone
    before: Before

    def positions(self, q: Sequence[Array], values: Mapping[str, Any]) -> tuple[list[Array], Array]:
        """Of their passive joints along the way from where they are assembled, and what is missing there."""
        numbers = {name: float(x) for name, x in values.items()}
        start = self._home(numbers)
        if start is None:
            return [np.full(np.shape(q[0]), np.nan)] * len(self.passive), np.full(np.shape(q[0]), np.inf)
        ends = np.stack([np.ravel(x) for x in np.broadcast_arrays(*q)])
        at = np.broadcast_to(start[1][:, None], (len(self.passive), ends.shape[1]))
        for leg in range(1, _LEGS + 1):
            full = self.before(list(start[0][:, None] + (ends - start[0][:, None]) * (leg / _LEGS)), numbers)
            at = self._closed(full, at, numbers, _FOLLOW)
        missing = self._missing(full, at, numbers)
        return [x.reshape(np.shape(q[0])) for x in at], missing.reshape(np.shape(q[0]))

    def searched(self, numbers: Mapping[str, float]) -> Found:
        """Configurations that random ones lead to."""
        own = {*robot_symbols(self.robot), *limit_symbols(self.robot)}
        known = tuple(sorted((name, x) for name, x in numbers.items() if name in own))
        return _searched(replace(self, rows=(), in_frame=False), known)

    def _home(self, numbers: Mapping[str, float]) -> tuple[Array, Array] | None:
        """Variables and passive joints of an assembly far from dead points, within their limits if there is one."""
        q, at, missing, singular = self.searched(numbers)
        inside, at = np.ones(len(missing), dtype=bool), at.copy()
        for k, x in zip(self.passive, at, strict=True):
            joint = self.robot.joints[k]
            if joint.is_revolute:
                x[:] = np.arctan2(np.sin(x), np.cos(x))
            if joint.limits:
                low, high = (to_float(limit, numbers) for limit in joint.limits)
                inside &= (low <= x) & (x <= high)
        far = np.where(missing < OPEN, singular[:, -1] + inside * singular.max(), -1.0)
        best = int(np.argmax(far))
        return (q[:, best], at[:, best]) if far[best] > 0 else None

    def _closed(self, full: list[Array], at: Array, numbers: Mapping[str, float], steps: int) -> Array:
        """Positions of the passive joints after some damped steps of least squares."""
        unit = np.array([1.0 if self.robot.joints[k].is_revolute else reach(self.robot, numbers) for k in self.passive])
        at, left = at.copy(), np.arange(at.shape[1])
        for _ in range(steps):
            values, matrix = self._linear([x[left] for x in full], at[:, left], numbers)
            matrix = np.nan_to_num(matrix * unit)
            square = np.swapaxes(matrix, -1, -2) @ matrix
            square += _SMALL * (1.0 + np.trace(square, axis1=-2, axis2=-1))[:, None, None] * np.eye(len(unit))
            right = np.swapaxes(matrix, -1, -2) @ np.nan_to_num(values)[..., None]
            change = np.linalg.solve(square, right)[..., 0]
            most = np.abs(change).max(axis=-1)
            at[:, left] -= (change / np.maximum(most / STEP, 1.0)[:, None] * unit).T
            left = left[most > _SETTLED]  # the next step is shorter than rounding
            if not left.size:
                break
        return at

    def _linear(self, full: list[Array], at: Array, numbers: Mapping[str, float]) -> tuple[Array, Array]:
        """phi, (configurations, rows), and J_p, (configurations, rows, passive)."""
        moved = at[:, None, :] + 1j * _DIFFERENCE * np.eye(len(at))[:, :, None]
        rows, _ = openings(self.robot, self, ArrayDomain(self.robot, self._placed(full, moved), numbers))
        found = np.stack([np.broadcast_to(row, moved.shape[1:]).astype(complex) for row in rows], axis=-1)
        return found[0].real, np.moveaxis(found.imag, 0, -1) / _DIFFERENCE

    def _missing(self, full: list[Array], at: Array, numbers: Mapping[str, float]) -> Array:
        _, misses = openings(self.robot, self, ArrayDomain(self.robot, self._placed(full, at), numbers))
        found = np.max([np.broadcast_to(np.abs(miss), at.shape[1]) for miss in misses], axis=0)
        return np.asarray(np.nan_to_num(found, nan=np.inf))

    def _placed(self, full: list[Array], at: Sequence[Array] | Array) -> list[Array]:
        known = dict(zip(self.passive, at, strict=True))
        return [known.get(k, x) for k, x in enumerate(full)]


@lru_cache(64)
def _searched(one: IteratedLoops, known: tuple[tuple[str, float], ...]) -> Found:
    robot, numbers, source = one.robot, dict(known), np.random.default_rng(11)
    q = np.stack(drawn(robot, robot.variables, numbers, source, _STARTS))
    at = np.stack(drawn(robot, [robot.joints[k] for k in one.passive], numbers, source, _STARTS))
    full = one.before(list(q), numbers)
    at = one._closed(full, at, numbers, _SEARCH)
    _, matrix = one._linear(full, at, numbers)
    return q, at, one._missing(full, at, numbers), np.linalg.svd(np.nan_to_num(matrix), compute_uv=False)


def iterated(robot: Robot, loops: Sequence[Loop], known: Sequence[int], before: Before) -> IteratedLoops | None:
    """Loops that determine their passive joints together, besides those that are known; None where they do not."""
    around = {k for loop in loops for way in tree.around(robot, loop) for k in way if robot.joints[k].follows}
    passive = tuple(sorted(around - {*known}))
    one = IteratedLoops(loops=tuple(loops), passive=passive, robot=robot, before=before)
    source = np.random.default_rng(5)
    numbers = parameter_values(robot, {name: source.uniform(0.2, 1.0) for name in free_symbols(robot)})
    _, _, missing, singular = one.searched({name: float(x) for name, x in numbers.items()})
    near = missing <= max(OPEN, float(missing.min()))
    rank = (singular[near] > _RANK * singular[near].max(axis=-1, keepdims=True)).sum(axis=-1)
    if np.median(rank) < len(passive):
        return None
    for loop in loops:
        if loop.branch:
            found, remedy = f"branch of loops that are solved numerically: {loop.branch}", "leave branch out"
            raise refused(robot, loop, found, "allowed: none", f"{remedy}, and give passive joints limits")
    return one
