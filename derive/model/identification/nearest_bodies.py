"""The nearest physically consistent bodies: convex problems in floats, each body in the units of its own link.

The pseudo-inertia of a body is taken about the link's own centre of mass as given, with its mass as unit of mass and
its radius of gyration as unit of length, so that a wrist counts as much as an upper arm, wherever the frames lie. First
the sum of the links' changes is made least, which leaves most links as they are; then, among the links that change, the
sum of squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from derive.mechanics.chain import Chain
from derive.model.identification.exact_scalars import Exact
from derive.model.identification.regressor_null_space import WIDTH, Direction, parameters_of
from derive.model.identification.semidefinite import Array, Cone, Limit, least, packed, unpacked

# Least eigenvalue of a pseudo-inertia in the link's own units, where the arm leaves room for it: programs that read
# models compute principal moments in floats, and refuse what does not hold after rounding.
MARGIN = 1e-5
UNIT = packed(np.eye(4))  # the unit matrix as a vector
BORDER = 1e-8  # least eigenvalues that are smaller than the solver can tell from zero
EXISTING = 1e-9  # where all given eigenvalues are above it nothing changes
KEPT = 1e-4  # a link whose change is a smaller part of the largest one does not change
HEAVIEST = 1e-6  # a link counts at least this part of the heaviest
LARGEST = 1e-3  # a link is at least this part of the arm's largest length
# The same of links that are given without a mass, or with less: the units of what they get, if they get something.
LIGHT, SHORT = 1e-2, 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """An arm's bodies in their own units, as an affine function of how far they go along each direction."""

    given: Array  # (n, 10) pseudo-inertias as vectors, see `derive.model.identification.semidefinite`
    along: Array  # (n, 10, k) their change along each direction
    units: Array  # (n, 4, 4) what takes a pseudo-inertia in the joint frame to these units, from both sides
    masses: Array  # (n,) the least mass of links given without one, or with a negative one; zero for all others


def size_of(chain: Chain[Exact]) -> float:
    """The largest length of an arm [m]; 1 where it has none."""
    lengths = [abs(float(c)) for joint in chain.joints for c in (*joint.fixed.position, joint.offset)]
    lengths += [abs(float(c)) for end in chain.ends for c in end.position]
    for body in chain.bodies:
        lengths += [abs(float(h) / float(body.mass)) for h in body.first_moment] if float(body.mass) > 0 else []
    return max(lengths) or 1.0


def pseudo_inertias(parameters: Array) -> Array:
    """The pseudo-inertias of bodies with parameters (n, 10, ...) in the order of `LINK_PARTS`."""
    # S = tr(I)/2 1 - I, the second moments of a body of inertia tensor I (Wensing, Kim and Slotine 2018).
    m, hx, hy, hz, xx, yy, zz, xy, xz, yz = np.moveaxis(parameters, 1, 0)
    rows = [
        [(yy + zz - xx) / 2, -xy, -xz, hx],
        [-xy, (xx + zz - yy) / 2, -yz, hy],
        [-xz, -yz, (xx + yy - zz) / 2, hz],
        [hx, hy, hz, m],
    ]
    found: Array = np.moveaxis(np.array(rows), 2, 0)
    return found


def in_own_units(chain: Chain[Exact], basis: Sequence[Direction]) -> Bodies:
    """The bodies of an arm, and their changes, each about its centre of mass, in its radius of gyration and mass."""
    size = size_of(chain)
    numbers = np.array([[float(value) for value in parameters_of(body)] for body in chain.bodies])
    columns = np.array([[float(value) for value in direction] for direction in basis])
    along = columns.T.reshape(len(numbers), WIDTH, -1) if len(basis) else np.zeros((len(numbers), WIDTH, 0))
    given, heaviest = pseudo_inertias(numbers), float(np.abs(numbers[:, 0]).max())
    found = []
    for body in given:
        mass = max(body[3, 3], 0.0)
        least_mass, least_radius = (HEAVIEST, LARGEST) if mass else (LIGHT, SHORT)
        weight = max(mass, least_mass * (heaviest or 1.0))
        center = body[:3, 3] / mass if mass == weight else np.zeros(3)
        # Trace of the second moments about the centre of mass: mass times squared radius of gyration.
        spread = float(np.abs(np.linalg.eigvalsh(body[:3, :3] - mass * np.outer(center, center))).sum())
        weight = max(weight, spread / size**2)
        radius = max(sqrt(spread / weight), least_radius * size)
        rows = [[np.eye(3) / radius, -center[:, None] / radius], [np.zeros((1, 3)), np.ones((1, 1))]]
        found.append(np.block(rows) / sqrt(weight))
    units = np.array(found)
    # A congruence U P U^T: it keeps a pseudo-inertia semidefinite.
    moved = np.moveaxis(pseudo_inertias(along), 3, 1)
    changes = np.einsum("nab,nkbc,ndc->nkad", units, moved, units)
    own = packed(np.einsum("nab,nbc,ndc->nad", units, given, units))
    return Bodies(own, packed(changes).swapaxes(1, 2), units, np.zeros(len(given)))


def least_eigenvalues(bodies: Bodies, steps: Array | None = None) -> Array:
    """(n,) least eigenvalue of each pseudo-inertia in the units of its link, after steps along directions if any."""
    moved = bodies.given if steps is None else bodies.given + bodies.along @ steps
    found: Array = np.linalg.eigvalsh(unpacked(moved))[..., 0]
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """How far from the limit all bodies can be at once."""

    value: float  # their least eigenvalue, at most `MARGIN`; negative where no bodies exist
    weights: Array  # (n,) by which that of each body counts: less for one that is given nearer to the limit
    # (n, 4, 4) positive semidefinite; the sum of their products with the pseudo-inertias is the same for all bodies
    # with these torques, and is ``value`` where no bodies exist.
    prices: Array


def most_room(bodies: Bodies) -> Room:
    """Bodies as far from the limit as they can be."""
    given = least_eigenvalues(bodies)
    weights = np.where(given > 0, np.clip(given / (2 * MARGIN), EXISTING / MARGIN, 1.0), 1.0)
    slopes, width = _slopes(bodies, 1), bodies.along.shape[2]
    # Variables: steps along the directions, then the room r; maximise r with P_i - w_i r 1 >= 0, r <= MARGIN.
    room = np.eye(width + 1)[width]
    rows = zip(bodies.given, slopes, weights, strict=True)
    limits = [Limit(Cone.SEMIDEFINITE, body, slope - w * np.outer(UNIT, room)) for body, slope, w in rows]
    limits.append(Limit(Cone.NOT_NEGATIVE, np.array([MARGIN]), -room[None]))
    found = least(-room, limits)
    return Room(float(found.x[width]), weights, unpacked(np.array(found.prices[: len(slopes)])))


def targets(bodies: Bodies, room: Room) -> Array:
    """(n,) the least eigenvalue of each body to keep to: half of what it can have while others have theirs.

    Less than zero, by what a solver does not see, for bodies that torques keep at the limit.
    """
    if room.value > MARGIN / 2:
        return room.weights * room.value / 2
    n, _, width = bodies.along.shape
    # One room for each body: the sum of all is made largest.
    rooms = np.eye(n + width)[width:]
    rows = zip(bodies.given, _slopes(bodies, n), room.weights, rooms, strict=True)
    limits = [Limit(Cone.SEMIDEFINITE, body, slope - w * np.outer(UNIT, own)) for body, slope, w, own in rows]
    limits.append(Limit(Cone.NOT_NEGATIVE, np.full(n, MARGIN), -rooms))
    limits.append(Limit(Cone.NOT_NEGATIVE, np.full(n, 2 * BORDER), rooms))
    found = least(-rooms.sum(axis=0), limits).x[width:]
    return np.where(found > 2 * BORDER, room.weights * found / 2, -2 * BORDER)


def weighed(bodies: Bodies, target: Array) -> Bodies:
    """The same with masses for the links that are given none, or less, as far as torques allow them.

    One that has moments of inertia would else get next to nothing, and a radius of gyration of kilometres. Those that
    are at the limit of what exists anyway stay what they are, to the last digit.
    """
    massless, (n, _, width) = (bodies.given[:, -1] <= 0) & (target > 0), bodies.along.shape
    if not massless.any():
        return bodies
    own, slopes = np.eye(n + width)[width:], _slopes(bodies, n)
    limits = list(map(_beyond, bodies.given, slopes, target))
    places = np.flatnonzero(massless)
    limits += [Limit(Cone.NOT_NEGATIVE, bodies.given[i, -1:], (slopes[i, -1] - own[i])[None]) for i in places]
    limits += [Limit(Cone.NOT_NEGATIVE, np.zeros(n), own), Limit(Cone.NOT_NEGATIVE, np.ones(n), -own)]
    found = least(-own[massless].sum(axis=0), limits).x[width:]
    return replace(bodies, masses=np.where(massless, np.clip(found, 0, 1) / 2, 0))


def _masses(bodies: Bodies, more: int) -> list[Limit]:
    """What ``masses`` asks for, of functions of the steps and of some more variables."""
    least_masses, slopes = bodies.given[:, -1] - bodies.masses, _slopes(bodies, more)[:, -1]
    places = np.flatnonzero(bodies.masses)
    return [Limit(Cone.NOT_NEGATIVE, least_masses[i, None], slopes[i, None]) for i in places]


def needed(bodies: Bodies, target: Array) -> list[int]:
    """The links that change where the sum of changes is least."""
    n, _, width = bodies.along.shape
    # Least sum of lengths |P_i - given_i| <= s_i: most links stay exactly as they are.
    sizes = np.eye(n + width)[width:]
    slopes = _slopes(bodies, n)
    limits = list(map(_beyond, bodies.given, slopes, target))
    pairs = zip(sizes, slopes, strict=True)
    limits += [Limit(Cone.LONGEST_FIRST, np.zeros(11), np.vstack([size, slope])) for size, slope in pairs]
    found = least(sizes.sum(axis=0), [*limits, *_masses(bodies, n)]).x[width:]
    missing = least_eigenvalues(bodies) < np.minimum(target, EXISTING)
    return [i for i, size in enumerate(found) if size > KEPT * found.max() or missing[i]]


def nearest(bodies: Bodies, target: Array) -> Array:
    """How far along each direction the nearest bodies are."""
    slopes = _slopes(bodies)
    limits = [*map(_beyond, bodies.given, slopes, target), *_masses(bodies, 0)]
    # Least squares of all changes, |A x|^2 with A the stacked directions.
    every = slopes.reshape(-1, slopes.shape[2])
    found: Array = least(np.zeros(every.shape[1]), limits, every.T @ every).x * _column_units(bodies)
    return found


def _beyond(body: Array, slope: Array, margin: float) -> Limit:
    return Limit(Cone.SEMIDEFINITE, body - margin * UNIT, slope)


def _column_units(bodies: Bodies) -> Array:
    """What a step along each direction is measured in, so that all are alike to the solver."""
    found: Array = 1 / np.sqrt((bodies.along**2).sum(axis=(0, 1)))
    return found


def _slopes(bodies: Bodies, more: int = 0) -> Array:
    """(n, 10, k + more) what the bodies change by with each step, and not with some more variables."""
    return np.pad(bodies.along * _column_units(bodies), ((0, 0), (0, 0), (0, more)))
