"""`--inertia possible`: the nearest physically consistent bodies with the torques of the given ones.

A rigid body exists where its pseudo-inertia [[S, h], [h^T, m]], with S its second moments and h its first moment, is
positive semidefinite: then its mass is not negative, and no principal moment is larger than the sum of the other two
(Wensing, Kim and Slotine, IEEE Robotics and Automation Letters 3(1), 2018). Published links often break this. Torques
know base parameters alone, so bodies may change along the null space of the regressor (`witness`) without any torque
changing; among these the nearest are found by semidefinite programming, in floats. The pseudo-inertia of a body is
taken about the link's own centre of mass as given, with its mass as unit of mass and its radius of gyration as unit of
length, so that a wrist counts as much as an upper arm, wherever the frames lie. First the sum of the links' changes is
made least, which leaves most links as they are; then, among the links that change, the sum of squares. The changes are
rounded to few digits and applied in exact arithmetic, and what comes out is looked at again: bodies that do not exist
are never handed out.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import floor, log10, sqrt

import numpy as np
from flint import arb, fmpq

from derive.arrays import Array
from derive.errors import DeriveError, quoted, require_known
from derive.mechanics.chain import Chain
from derive.mechanics.space import decimal, exactly
from derive.mechanics.vectors import add, conjugate, from_matrix, multiply, scale, steiner, transpose
from derive.model.identification import witness
from derive.model.identification.base_parameters import parameters_of
from derive.model.identification.exact_scalars import Exact, ExactDomain, is_zero
from derive.model.identification.semidefinite import Cone, Limit, least, packed, unpacked
from derive.model.identification.witness import WIDTH, Direction, bare_chain, body_of, refusal
from derive.robot.description import INERTIA, Inertia, Link
from derive.robot.expression import Expression, number, to_text
from derive.robot.names import without_lost_symbols
from derive.robot.robot import Robot
from derive.robot.tree import require_chain
from derive.robot.writer import robot_text

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
# Which bodies are taken: those of the robot, or the nearest ones that exist and move alike.
INERTIAS = ("given", "possible")
CELLS = ("mass", "com x", "com y", "com z", *INERTIA)  # of a link
# To which changes are rounded, in the units of the links; the finer ones where the coarser ones are too coarse.
UNITS = (1e-8, 1e-11, 1e-14)


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """An arm's bodies in their own units, as an affine function of how far they go along each direction."""

    given: Array  # (n, 10) pseudo-inertias as vectors, see `derive.model.identification.semidefinite`
    along: Array  # (n, 10, k) their change along each direction
    units: Array  # (n, 4, 4) what takes a pseudo-inertia in the joint frame to these units, from both sides
    masses: Array  # (n,) the least mass of links given without one, or with a negative one; zero for all others


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
    return np.asarray(np.moveaxis(np.array(rows), 2, 0))


def in_own_units(chain: Chain[Exact], basis: Sequence[Direction]) -> Bodies:
    """The bodies of an arm, and their changes, each about its centre of mass, in its radius of gyration and mass."""
    lengths = [float(c) for joint in chain.joints for c in (*joint.fixed.position, joint.offset)]
    lengths += [float(c) for end in chain.ends for c in end.position]
    lengths += [float(h) / m for body in chain.bodies if (m := float(body.mass)) > 0 for h in body.first_moment]
    size = max(map(abs, lengths)) or 1.0  # the largest length of the arm [m]
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
    changes = np.einsum("nab,nkbc,ndc->nkad", units, np.moveaxis(pseudo_inertias(along), 3, 1), units)
    own = packed(np.einsum("nab,nbc,ndc->nad", units, given, units))
    return Bodies(own, packed(changes).swapaxes(1, 2), units, np.zeros(len(given)))


def least_eigenvalues(bodies: Bodies, steps: Array | None = None) -> Array:
    """(n,) least eigenvalue of each pseudo-inertia in the units of its link, after steps along directions if any."""
    moved = bodies.given if steps is None else bodies.given + bodies.along @ steps
    return np.asarray(np.linalg.eigvalsh(unpacked(moved))[..., 0])


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
    found, prices = least(-room, limits)
    return Room(float(found[width]), weights, unpacked(np.array(prices[: len(slopes)])))


def targets(bodies: Bodies, room: Room) -> Array:
    """(n,) the least eigenvalue of each body to keep to: half of what it can have; just below zero at the limit."""
    if room.value > MARGIN / 2:
        return room.weights * room.value / 2
    n, _, width = bodies.along.shape
    # One room for each body: the sum of all is made largest.
    rooms = np.eye(n + width)[width:]
    rows = zip(bodies.given, _slopes(bodies, n), room.weights, rooms, strict=True)
    limits = [Limit(Cone.SEMIDEFINITE, body, slope - w * np.outer(UNIT, own)) for body, slope, w, own in rows]
    limits.append(Limit(Cone.NOT_NEGATIVE, np.full(n, MARGIN), -rooms))
    limits.append(Limit(Cone.NOT_NEGATIVE, np.full(n, 2 * BORDER), rooms))
    found = least(-rooms.sum(axis=0), limits)[0][width:]
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
    found = least(-own[massless].sum(axis=0), limits)[0][width:]
    return replace(bodies, masses=np.where(massless, np.clip(found, 0, 1) / 2, 0))


def _masses(bodies: Bodies, more: int) -> list[Limit]:
    """What ``masses`` asks for, of functions of the steps and of some more variables."""
    least_masses, slopes = bodies.given[:, -1] - bodies.masses, _slopes(bodies, more)[:, -1]
    return [Limit(Cone.NOT_NEGATIVE, least_masses[i, None], slopes[i, None]) for i in np.flatnonzero(bodies.masses)]


def needed(bodies: Bodies, target: Array) -> list[int]:
    """The links that change where the sum of changes is least."""
    n, _, width = bodies.along.shape
    # Least sum of lengths |P_i - given_i| <= s_i: most links stay exactly as they are.
    sizes = np.eye(n + width)[width:]
    slopes = _slopes(bodies, n)
    limits = list(map(_beyond, bodies.given, slopes, target))
    pairs = zip(sizes, slopes, strict=True)
    limits += [Limit(Cone.LONGEST_FIRST, np.zeros(11), np.vstack([size, slope])) for size, slope in pairs]
    found = least(sizes.sum(axis=0), [*limits, *_masses(bodies, n)])[0][width:]
    missing = least_eigenvalues(bodies) < np.minimum(target, EXISTING)
    return [i for i, size in enumerate(found) if size > KEPT * found.max() or missing[i]]


def nearest(bodies: Bodies, target: Array) -> Array:
    """How far along each direction the nearest bodies are."""
    slopes = _slopes(bodies)
    limits = [*map(_beyond, bodies.given, slopes, target), *_masses(bodies, 0)]
    # Least squares of all changes, |A x|^2 with A the stacked directions.
    every = slopes.reshape(-1, slopes.shape[2])
    return np.asarray(least(np.zeros(every.shape[1]), limits, every.T @ every)[0] * _column_units(bodies))


def _beyond(body: Array, slope: Array, margin: float) -> Limit:
    return Limit(Cone.SEMIDEFINITE, body - margin * UNIT, slope)


def _column_units(bodies: Bodies) -> Array:
    """What a step along each direction is measured in, so that all are alike to the solver."""
    return np.asarray(1 / np.sqrt((bodies.along**2).sum(axis=(0, 1))))


def _slopes(bodies: Bodies, more: int = 0) -> Array:
    """(n, 10, k + more) what the bodies change by with each step, and not with some more variables."""
    return np.pad(bodies.along * _column_units(bodies), ((0, 0), (0, 0), (0, more)))


@dataclass(frozen=True, slots=True)
class Change:
    """What became of a link."""

    link: int  # number, from 1
    size: float  # of the change, without units; see `derive.model.identification.possible`
    cells: tuple[tuple[str, Expression, Expression], ...]  # cells that changed: name, old and new

    def __str__(self) -> str:
        cells = ", ".join(f"{name} {_short(old)} -> {_short(new)}" for name, old, new in self.cells)
        return f"link {self.link} changed by {self.size:.2g}: {cells}"


@dataclass(frozen=True, slots=True)
class Possible:
    """A robot whose links are physically consistent."""

    robot: Robot
    changes: tuple[Change, ...]  # the links that changed
    border: tuple[int, ...] = ()  # links, from 1, that torques keep at limits of bodies: a point, a thin rod

    @property
    def report(self) -> tuple[str, ...]:
        """What was changed, in lines."""
        head = f"{len(self.changes)} of {self.robot.n} links changed; base parameters and torques stay the same"
        lines = [head, *map(str, self.changes)] if self.changes else ["all links exist as they are"]
        if self.border:
            several, which = len(self.border) > 1, ", ".join(map(str, self.border))
            are = f"links {which} are" if several else f"link {which} is"
            limit = "at the limit of what exists (nothing, a point, a thin rod or plate); torques allow no other"
            lines.append(f"{are} {limit}")
        return tuple(lines)

    @property
    def text(self) -> str:
        """The robot file of the robot, with the comments at its head and what was changed."""
        return robot_text(self.robot, (*self.robot.comments, *self.report))


def possible(robot: Robot) -> Possible:
    """The nearest physically consistent bodies that give the same torques."""
    require_chain(robot, "the search for possible bodies")
    if not robot.links:
        raise DeriveError(f"{robot.name} has no masses and inertias", remedy="give links in the robot file")
    with exactly():
        domain = ExactDomain(robot)
        chain = bare_chain(robot, domain)
        if float(least_eigenvalues(in_own_units(chain, ())).min()) >= EXISTING:
            return Possible(robot, ())
        every = witness.directions(robot, chain, domain)
        # Where torques leave a link no mass it gets no first moment: a solver would not see a small one beside large
        # second ones, which is within its tolerance.
        masses = [WIDTH * i for i, body in enumerate(chain.bodies) if is_zero(body.mass)]
        massless = [k for k in masses if all(is_zero(direction[k]) for direction in every)]
        basis = witness.fixing(every, [k + axis for k in massless for axis in (1, 2, 3)])
        # A semidefinite program in each link's own units: room, targets, which links change, and how little.
        bodies = in_own_units(chain, basis)
        room = most_room(bodies)
        if room.value < -BORDER:
            raise refusal(robot, chain, every, room.prices, bodies.units)
        target = targets(bodies, room)
        border = tuple(int(i) + 1 for i in np.flatnonzero(target < 0))
        if border and float(least_eigenvalues(bodies).min()) >= -BORDER:
            return Possible(robot, (), border)
        bodies = weighed(bodies, target)
        changed = needed(bodies, target)
        still = [WIDTH * i + k for i in range(robot.n) if i not in changed for k in range(WIDTH)]
        fewer = witness.fixing(basis, still)
        for among in (fewer, basis):  # at the limit a solver may need the other links, too
            alone = replace(in_own_units(chain, among), masses=bodies.masses)
            if (steps := _decimal_steps(alone, target)) is not None:
                with suppress(DeriveError):  # rounding left a link a first moment without a mass
                    return _result(robot, chain, domain, witness.combined(among, steps), border)
        raise DeriveError(f"{robot.name}: consistent inertias with these torques may exist, but the search found none")


def wants_possible(inertia: str) -> bool:
    """Whether physically consistent bodies are asked for."""
    require_known(inertia, INERTIAS, f"unknown choice of inertia {quoted(inertia)}")
    return inertia == "possible"


def with_chosen_bodies(robot: Robot, inertia: str) -> tuple[Robot, tuple[str, ...]]:
    """A robot with its own bodies, or with the nearest that exist."""
    if not wants_possible(inertia):
        return robot, ()
    found = possible(robot)
    return replace(found.robot, comments=(*robot.comments, *found.report)), found.report


def _decimal_steps(bodies: Bodies, target: Array) -> list[Exact] | None:
    """Steps with few digits to the nearest bodies, or None where the search does not reach what is asked for."""
    if not bodies.along.shape[2]:
        return None
    try:
        found = nearest(bodies, target)
    except DeriveError:
        return None
    lengths = np.sqrt((bodies.along**2).sum(axis=(0, 1)))
    for unit in UNITS:
        places = [floor(-log10(unit / length)) for length in lengths]
        steps = [fmpq(round(step * 10**p), 1) / fmpq(10) ** p for step, p in zip(found, places, strict=True)]
        reached = least_eigenvalues(bodies, np.array([float(step) for step in steps]))
        if (reached >= target - abs(target) / 2).all():
            return steps
    return None


def _result(
    robot: Robot, chain: Chain[Exact], domain: ExactDomain, moved: Direction, border: tuple[int, ...]
) -> Possible:
    """The links after a change of their parameters."""
    links, changes = list(robot.links), []
    shapes = in_own_units(chain, [moved])
    for i, link in enumerate(robot.links):
        change = moved[WIDTH * i : WIDTH * (i + 1)]
        if all(map(is_zero, change)):
            continue
        links[i] = _moved_link(link, chain, i, change, domain)
        cells = ((x.mass, *x.com, *(getattr(x.inertia, key) for key in INERTIA)) for x in (link, links[i]))
        changed = tuple(cell for cell in zip(CELLS, *cells, strict=True) if cell[1] != cell[2])
        if changed:
            changes.append(Change(i + 1, float(np.sqrt((shapes.along[i] ** 2).sum())), changed))
    return Possible(without_lost_symbols(robot, replace(robot, links=tuple(links))), tuple(changes), border)


def _moved_link(link: Link, chain: Chain[Exact], i: int, change: Sequence[Exact], domain: ExactDomain) -> Link:
    """A link whose parameters in the joint frame changed; what does not change stays as it is written."""
    given = parameters_of(chain.bodies[i])
    body, end = body_of([old + by for old, by in zip(given, change, strict=True)]), chain.ends[i]
    turned = transpose(end.rotation)
    if (massless := is_zero(body.mass)) and not all(map(is_zero, body.first_moment)):
        found = f"link {i + 1}: torques leave it no mass, but a first moment"
        raise DeriveError(found, remedy="correct masses and inertias")
    mass = _kept(link.mass, body.mass, domain)
    # From the joint frame to the link's: first moment about its origin, tensor about its centre (Steiner).
    m = domain.constant(mass)
    moments = multiply(turned, add(body.first_moment, scale(-body.mass, end.position)))
    com = link.com
    if not massless:
        x, y, z = (_kept(old, h / body.mass, domain) for old, h in zip(link.com, moments, strict=True))
        com = (x, y, z)
    r = add(end.position, multiply(end.rotation, tuple(map(domain.constant, com))))
    tensor = from_matrix(conjugate(turned, (body.inertia + steiner(-m, r)).matrix))
    inertia = Inertia(*(_kept(getattr(link.inertia, name), getattr(tensor, name), domain) for name in INERTIA))
    return replace(link, mass=mass, com=com, inertia=inertia)


def _kept(cell: Expression, value: Exact, domain: ExactDomain) -> Expression:
    """A cell where it has the value already, else the value."""
    return cell if is_zero(domain.constant(cell) - value) else number(decimal(arb(value)))


def _short(cell: Expression) -> str:
    return to_text(cell, lambda value: f"{float(value):.6g}")
