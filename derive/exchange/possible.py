"""`--inertia possible`: the nearest bodies that exist and move as the given ones do.

A rigid body exists where its pseudo-inertia [[S, h], [h^T, m]], with S its second moments and h its first moment, is
positive semidefinite: then its mass is not negative, and no principal moment is larger than the sum of the other two
(Wensing, Kim and Slotine, IEEE Robotics and Automation Letters 3(1), 2018). Published links often break this. Torques
know base parameters alone, so bodies may change along the directions of `derive.exchange.regressor_null_space` without
any torque changing; among these the nearest are found by semidefinite programming.

Near is meant without units: the pseudo-inertia is taken about the link's own centre of mass, with its mass as unit of
mass and its radius of gyration as unit of length, so that a wrist counts as much as an upper arm, wherever the frames
lie. First the sum of the links' changes is made least, which leaves most links as they are; then, among the links that
change, the sum of squares. The changes are rounded to few digits and applied in exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import floor, isfinite, log10, sqrt
from typing import Any

import numpy as np
import numpy.typing as npt
from flint import arb, fmpq

from derive.errors import DeriveError
from derive.exchange.exact_scalars import Exact, ExactDomain, is_zero
from derive.exchange.regressor_null_space import (
    WIDTH,
    Direction,
    bare_chain,
    body_of,
    combined,
    directions,
    keeping,
    parameters_of,
)
from derive.exchange.semidefinite import Cone, Limit, least, packed, unpacked
from derive.exchange.space import decimal, exactly
from derive.exchange.witness import refusal
from derive.mechanics.chain import Chain
from derive.mechanics.vectors import Symmetric, add, from_matrix, matmul, multiply, scale, steiner, transpose
from derive.robot.description import Inertia, Link
from derive.robot.expression import Expression, number, to_text
from derive.robot.robot import Robot
from derive.robot.writer import robot_text

Array = npt.NDArray[Any]

MARGIN = 1e-5
"""Least eigenvalue of a pseudo-inertia in the link's own units, where the arm leaves room for it; programs that read
models compute principal moments in floats and refuse those that do not hold after rounding."""

UNIT = packed(np.eye(4))
"""The unit matrix as a vector."""

STEP = 1e-8
"""To which changes are rounded, in the same units."""

BORDER = 1e-8
"""Least eigenvalues that are smaller than the solver can tell from zero."""

EXISTING = 1e-9
"""Where all given eigenvalues are above it nothing changes."""

KEPT = 1e-4
"""A link whose change is a smaller part of the largest one does not change."""

HEAVIEST = 1e-6
"""A link counts at least this part of the heaviest."""

LARGEST = 1e-3
"""A link is at least this part of the arm's largest length."""


@dataclass(frozen=True, slots=True)
class Change:
    """What became of a link.

    Attributes:
        link: Number, from 1.
        size: Of the change, without units; see the head of this module.
        cells: Cells that changed: name, old and new.
    """

    link: int
    size: float
    cells: tuple[tuple[str, Expression, Expression], ...]

    def __str__(self) -> str:
        cells = ", ".join(f"{name} {_short(old)} -> {_short(new)}" for name, old, new in self.cells)
        return f"link {self.link} changed by {self.size:.2g}: {cells}"


@dataclass(frozen=True, slots=True)
class Possible:
    """A robot whose links exist.

    Attributes:
        robot: The robot.
        changes: The links that changed.
        border: Whether some body is the limit of ones that exist, such as a thin rod, and the arm leaves no choice.
    """

    robot: Robot
    changes: tuple[Change, ...]
    border: bool

    @property
    def report(self) -> tuple[str, ...]:
        """What was changed, in lines."""
        head = f"{len(self.changes)} of {self.robot.n} links changed; base parameters and torques stay the same"
        lines = [head, *map(str, self.changes)] if self.changes else ["all links exist as they are"]
        if self.border:
            lines.append("some body is at the limit of what exists (a thin rod or a plate), and torques allow no other")
        return tuple(lines)

    @property
    def text(self) -> str:
        """The robot file of the robot, with the comments at its head and what was changed."""
        return robot_text(self.robot, (*self.robot.comments, *self.report))


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """An arm's bodies in their own units, as an affine function of how far they go along each direction.

    Attributes:
        given: (n, 10) pseudo-inertias as vectors, see `derive.exchange.semidefinite`.
        along: (n, 10, k) their change along each direction.
        units: (n, 4, 4) what takes a pseudo-inertia in the joint frame to these units, from both sides.
        weighed: Links given without a mass, which must get enough of it not to be wider than the arm.
    """

    given: Array
    along: Array
    units: Array
    weighed: tuple[int, ...] = ()


def possible(robot: Robot) -> Possible:
    """The nearest bodies that exist and give the same torques.

    Args:
        robot: A robot with links, whose symbols all have numbers. Rotors, armatures and friction stay as they are.

    Returns:
        The robot with these links; cells that need no change are kept as they stand.

    Raises:
        NoSuchBodies: There are none.
        DeriveError: No links, or the packages of the extra are missing.
        ExpressionError: A symbol has no number.
    """
    if not robot.links:
        raise DeriveError(f"{robot.name}: no masses and inertias", remedy="give links in the robot file")
    with exactly():
        domain = ExactDomain(robot)
        chain = bare_chain(robot, domain)
        parameters = [value for body in chain.bodies for value in parameters_of(body)]
        bodies = in_own_units(parameters, (), size_of(chain))
        if float(_least(bodies).min()) >= EXISTING:
            return Possible(robot, (), border=False)
        basis = directions(robot, chain, domain)
        bodies = in_own_units(parameters, basis, size_of(chain))
        bodies, room = _weighed(bodies, most_room(bodies))
        if room.value < -BORDER:
            raise refusal(
                robot, parameters, basis, np.einsum("nba,nbc,ncd->nad", bodies.units, room.prices, bodies.units)
            )
        target = _targets(bodies, room)
        if (target < 0).any() and float(_least(bodies).min()) >= -BORDER:
            return Possible(robot, (), border=True)
        changed = _needed(bodies, target)
        steps: Array | None = None
        if fewer := keeping(basis, [i for i in range(robot.n) if i not in changed]):
            alone = replace(in_own_units(parameters, fewer, size_of(chain)), weighed=bodies.weighed)
            with suppress(DeriveError):  # at the limit a solver may need the other links, too
                steps = _nearest(alone, target)
                basis, bodies = fewer, alone
        if steps is None:
            steps = _nearest(bodies, target)
        moved = combined(basis, [_decimal_step(step, bodies.along[..., k]) for k, step in enumerate(steps)])
        return _result(robot, chain, domain, moved, border=bool((target < 0).any()))


def size_of(chain: Chain[Exact]) -> float:
    """The largest length of an arm [m]; 1 where it has none.

    Args:
        chain: Its links and frames.
    """
    lengths = [abs(float(c)) for joint in chain.joints for c in (*joint.fixed.position, joint.offset)]
    lengths += [abs(float(c)) for end in chain.ends for c in end.position]
    for body in chain.bodies:
        lengths += [abs(float(h) / float(body.mass)) for h in body.first_moment] if float(body.mass) > 0 else []
    return max(lengths) or 1.0


def pseudo_inertias(parameters: Array) -> Array:
    """The pseudo-inertias of bodies.

    Args:
        parameters: (n, 10, ...) in the order of `LINK_PARTS`.

    Returns:
        (n, 4, 4, ...).
    """
    m, hx, hy, hz, xx, yy, zz, xy, xz, yz = np.moveaxis(parameters, 1, 0)
    rows = [
        [(yy + zz - xx) / 2, -xy, -xz, hx],
        [-xy, (xx + zz - yy) / 2, -yz, hy],
        [-xz, -yz, (xx + yy - zz) / 2, hz],
        [hx, hy, hz, m],
    ]
    found: Array = np.moveaxis(np.array(rows), 2, 0)
    return found


def in_own_units(parameters: Sequence[Exact], basis: Sequence[Direction], size: float) -> Bodies:
    """Bodies, and their changes, each in the units of its link.

    Args:
        parameters: Of all links, in joint frames.
        basis: Changes of them.
        size: See `size_of`.
    """
    numbers = np.array([float(value) for value in parameters]).reshape(-1, WIDTH)
    columns = np.array([[float(value) for value in direction] for direction in basis])
    along = columns.T.reshape(len(numbers), WIDTH, -1) if len(basis) else np.zeros((len(numbers), WIDTH, 0))
    given, heaviest = pseudo_inertias(numbers), float(np.abs(numbers[:, 0]).max())
    units = np.array([_units(body, heaviest or 1.0, size) for body in given])
    moved = np.moveaxis(pseudo_inertias(along), 3, 1)
    changes = np.einsum("nab,nkbc,ndc->nkad", units, moved, units)
    return Bodies(packed(np.einsum("nab,nbc,ndc->nad", units, given, units)), packed(changes).swapaxes(1, 2), units)


def _units(body: Array, heaviest: float, size: float) -> Array:
    """To coordinates about the centre of mass, in radii of gyration and masses of the link, within reason."""
    given = body[3, 3]
    mass = max(abs(given), HEAVIEST * heaviest)
    center = body[:3, 3] / given if abs(given) == mass else np.zeros(3)
    spread = float(np.abs(np.linalg.eigvalsh(body[:3, :3] - given * np.outer(center, center))).sum())
    mass = max(mass, spread / size**2)
    radius = max(sqrt(spread / mass), LARGEST * size)
    return np.block([[np.eye(3) / radius, -center[:, None] / radius], [np.zeros((1, 3)), np.ones((1, 1))]]) / sqrt(mass)


def _least(bodies: Bodies) -> Array:
    """Least eigenvalue of each given pseudo-inertia."""
    found: Array = np.linalg.eigvalsh(unpacked(bodies.given))[..., 0]
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """How far from the limit all bodies can be at once.

    Attributes:
        value: Their least eigenvalue, at most `MARGIN`; negative where no bodies exist.
        weights: (n,) by which that of each body counts: less for one that is given nearer to the limit.
        prices: (n, 4, 4) positive semidefinite; the sum of their products with the pseudo-inertias is the same for all
            bodies with these torques, and is ``value`` where no bodies exist.
    """

    value: float
    weights: Array
    prices: Array


def most_room(bodies: Bodies) -> Room:
    """Bodies as far from the limit as they can be.

    Args:
        bodies: The arm's.
    """
    given = _least(bodies)
    weights = np.where(given > 0, np.clip(given / (2 * MARGIN), EXISTING / MARGIN, 1.0), 1.0)
    slopes, width = _slopes(bodies), bodies.along.shape[2]
    limits = [
        Limit(Cone.SEMIDEFINITE, body, np.column_stack([slope, -weight * UNIT]))
        for body, slope, weight in zip(bodies.given, slopes, weights, strict=True)
    ]
    room = np.eye(width + 1)[width]
    limits.append(Limit(Cone.NOT_NEGATIVE, np.array([MARGIN]), -room[None]))
    found = least(-room, [*limits, *_masses(bodies, 1)])
    return Room(float(found.x[width]), weights, unpacked(np.array(found.prices[: len(slopes)])))


def _weighed(bodies: Bodies, room: Room) -> tuple[Bodies, Room]:
    """The same with masses for the links that are given none, where torques allow it.

    One that has moments of inertia would else get next to nothing, and a radius of gyration of kilometres.
    """
    massless = tuple(i for i, body in enumerate(bodies.given) if body[-1] == 0)
    if not massless or room.value < MARGIN / 2:
        return bodies, room
    heavier = replace(bodies, weighed=massless)
    try:
        found = most_room(heavier)
    except DeriveError:
        return bodies, room
    return (heavier, found) if found.value > room.value / 2 else (bodies, room)


def _masses(bodies: Bodies, more: int) -> list[Limit]:
    """What `weighed` asks for, of functions of the steps and of some more variables."""
    slopes = _slopes(bodies)[:, -1, :]
    return [
        Limit(Cone.NOT_NEGATIVE, bodies.given[i, -1:] - 1, np.append(slopes[i], np.zeros(more))[None])
        for i in bodies.weighed
    ]


def _targets(bodies: Bodies, room: Room) -> Array:
    """The least eigenvalue of each body to keep to: half of what it can have while others have theirs.

    Bodies that torques keep at the limit have less than zero, by what a solver does not see.
    """
    if room.value > MARGIN / 2:
        return room.weights * room.value / 2
    slopes, (n, _, width) = _slopes(bodies), bodies.along.shape
    rooms = np.eye(n + width)[width:]
    limits = [
        Limit(Cone.SEMIDEFINITE, body, np.column_stack([slope, -weight * np.outer(UNIT, own[width:])]))
        for body, slope, weight, own in zip(bodies.given, slopes, room.weights, rooms, strict=True)
    ]
    limits += [
        Limit(Cone.NOT_NEGATIVE, np.full(n, MARGIN), -rooms),
        Limit(Cone.NOT_NEGATIVE, np.full(n, 2 * BORDER), rooms),
    ]
    found = least(-rooms.sum(axis=0), [*limits, *_masses(bodies, n)]).x[width:]
    return np.where(found > 2 * BORDER, room.weights * found / 2, -2 * BORDER)


def _needed(bodies: Bodies, target: Array) -> list[int]:
    """The links that change where the sum of changes is least."""
    slopes, (n, _, width) = _slopes(bodies), bodies.along.shape
    sizes = np.eye(n + width)[width:]
    limits = [
        _beyond(body, np.column_stack([slope, np.zeros((10, n))]), t)
        for body, slope, t in zip(bodies.given, slopes, target, strict=True)
    ]
    limits += [
        Limit(Cone.LONGEST_FIRST, np.zeros(11), np.vstack([size, np.column_stack([slope, np.zeros((10, n))])]))
        for size, slope in zip(sizes, slopes, strict=True)
    ]
    found = least(sizes.sum(axis=0), [*limits, *_masses(bodies, n)]).x[width:]
    return [i for i, size in enumerate(found) if size > KEPT * found.max()]


def _nearest(bodies: Bodies, target: Array) -> Array:
    """How far along each direction the nearest bodies are."""
    slopes = _slopes(bodies)
    limits = [_beyond(*each) for each in zip(bodies.given, slopes, target, strict=True)] + _masses(bodies, 0)
    every = slopes.reshape(-1, slopes.shape[2])
    found: Array = least(np.zeros(every.shape[1]), limits, every.T @ every).x * _column_units(bodies)
    return found


def _beyond(body: Array, slope: Array, margin: float) -> Limit:
    """A body whose least eigenvalue is at least a margin."""
    return Limit(Cone.SEMIDEFINITE, body - margin * UNIT, slope)


def _column_units(bodies: Bodies) -> Array:
    """What a step along each direction is measured in, so that all are alike to the solver."""
    found: Array = 1 / np.sqrt((bodies.along**2).sum(axis=(0, 1)))
    return found


def _slopes(bodies: Bodies) -> Array:
    found: Array = bodies.along * _column_units(bodies)
    return found


def _decimal_step(step: float, along: Array) -> Exact:
    """A step with few digits."""
    places = floor(-log10(STEP / float(np.sqrt((along**2).sum()))))
    return fmpq(round(step * 10**places), 1) / fmpq(10) ** places if isfinite(step) else fmpq(0)


def _result(robot: Robot, chain: Chain[Exact], domain: ExactDomain, moved: Direction, *, border: bool) -> Possible:
    """The links after a change of their parameters."""
    links, changes = list(robot.links), []
    shapes = in_own_units([value for body in chain.bodies for value in parameters_of(body)], [moved], size_of(chain))
    for i, link in enumerate(robot.links):
        change = moved[WIDTH * i : WIDTH * (i + 1)]
        if all(map(is_zero, change)):
            continue
        links[i] = _moved_link(link, chain, i, change, domain)
        cells = tuple(_differences(link, links[i]))
        if cells:
            changes.append(Change(i + 1, float(np.sqrt((shapes.along[i] ** 2).sum())), cells))
    return Possible(replace(robot, links=tuple(links)), tuple(changes), border)


def _moved_link(link: Link, chain: Chain[Exact], i: int, change: Sequence[Exact], domain: ExactDomain) -> Link:
    """A link whose parameters in the joint frame changed; what does not change stays as it is written."""
    given = parameters_of(chain.bodies[i])
    body, end = body_of([old + by for old, by in zip(given, change, strict=True)]), chain.ends[i]
    turned = transpose(end.rotation)
    if (massless := is_zero(body.mass)) and not all(map(is_zero, body.first_moment)):
        found = f"link {i + 1}: torques leave it no mass, but a first moment"
        raise DeriveError(found, remedy="correct masses and inertias")
    mass = _kept(link.mass, body.mass, domain)
    m = domain.constant(mass)
    moment = add(body.first_moment, scale(-body.mass, end.position))
    moments = multiply(turned, moment)
    com = link.com
    if not massless:
        x, y, z = (_kept(old, h / body.mass, domain) for old, h in zip(link.com, moments, strict=True))
        com = (x, y, z)
    r = add(end.position, multiply(end.rotation, tuple(map(domain.constant, com))))
    own = body.inertia + Symmetric(*(-entry for entry in parameters_of_tensor(steiner(m, r))))
    tensor = from_matrix(matmul(matmul(turned, own.matrix), end.rotation))
    old = link.inertia
    cells = [old.xx, old.yy, old.zz, old.xy, old.xz, old.yz]
    inertia = Inertia(*(_kept(c, v, domain) for c, v in zip(cells, parameters_of_tensor(tensor), strict=True)))
    return replace(link, mass=mass, com=com, inertia=inertia)


def parameters_of_tensor(tensor: Symmetric[Exact]) -> list[Exact]:
    """xx, yy, zz, xy, xz, yz.

    Args:
        tensor: The tensor.
    """
    return [tensor.xx, tensor.yy, tensor.zz, tensor.xy, tensor.xz, tensor.yz]


def _kept(cell: Expression, value: Exact, domain: ExactDomain) -> Expression:
    """A cell where it has the value already, else the value."""
    return cell if is_zero(domain.constant(cell) - value) else number(decimal(arb(value)))


def _differences(old: Link, new: Link) -> Iterator[tuple[str, Expression, Expression]]:
    pairs = [("mass", old.mass, new.mass)]
    pairs += [(f"com {axis}", *pair) for axis, pair in zip("xyz", zip(old.com, new.com, strict=True), strict=True)]
    names = ("xx", "yy", "zz", "xy", "xz", "yz")
    pairs += [(name, getattr(old.inertia, name), getattr(new.inertia, name)) for name in names]
    yield from ((name, before, after) for name, before, after in pairs if before != after)


def _short(cell: Expression) -> str:
    """A cell for a message."""
    return to_text(cell, lambda value: f"{float(value):.6g}")
