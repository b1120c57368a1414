"""`--inertia possible`: the nearest physically consistent bodies with the torques of the given ones.

A rigid body exists where its pseudo-inertia [[S, h], [h^T, m]], with S its second moments and h its first moment, is
positive semidefinite: then its mass is not negative, and no principal moment is larger than the sum of the other two
(Wensing, Kim and Slotine, IEEE Robotics and Automation Letters 3(1), 2018). Published links often break this. Torques
know base parameters alone, so bodies may change along the directions of `regressor_null_space` without
any torque changing; among these the nearest are found by semidefinite programming (`nearest_bodies`,
which also says what near means). The changes are rounded to few digits and applied in exact arithmetic, and what comes
out is looked at again: bodies that do not exist are never handed out.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import floor, log10

import numpy as np
from flint import arb, fmpq

from derive.errors import DeriveError, near_miss, quoted
from derive.mechanics.chain import Chain
from derive.mechanics.space import decimal, exactly
from derive.mechanics.vectors import add, conjugate, from_matrix, multiply, scale, steiner, transpose
from derive.model.identification import nearest_bodies, regressor_null_space
from derive.model.identification.exact_scalars import Exact, ExactDomain, is_zero
from derive.model.identification.nearest_bodies import BORDER, EXISTING, Bodies
from derive.model.identification.regressor_null_space import WIDTH, Direction, bare_chain, body_of, parameters_of
from derive.model.identification.semidefinite import Array
from derive.model.identification.witness import refusal
from derive.robot.description import INERTIA, Inertia, Link
from derive.robot.expression import Expression, number, to_text
from derive.robot.names import without_lost_symbols
from derive.robot.robot import Robot
from derive.robot.writer import robot_text

# Which bodies are taken: those of the robot, or the nearest ones that exist and move alike.
INERTIAS = ("given", "possible")
CELLS = ("mass", "com x", "com y", "com z", *INERTIA)  # of a link
# To which changes are rounded, in the units of the links; the finer ones where the coarser ones are too coarse.
UNITS = (1e-8, 1e-11, 1e-14)


@dataclass(frozen=True, slots=True)
class Change:
    """What became of a link."""

    link: int  # number, from 1
    size: float  # of the change, without units; see `derive.model.identification.nearest_bodies`
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
    if not robot.links:
        raise DeriveError(f"{robot.name} has no masses and inertias", remedy="give links in the robot file")
    with exactly():
        domain = ExactDomain(robot)
        chain = bare_chain(robot, domain)
        if float(nearest_bodies.least_eigenvalues(nearest_bodies.in_own_units(chain, ())).min()) >= EXISTING:
            return Possible(robot, ())
        every = regressor_null_space.directions(robot, chain, domain)
        # Where torques leave a link no mass it gets no first moment: a solver would not see a small one beside large
        # second ones, which is within its tolerance.
        masses = [WIDTH * i for i, body in enumerate(chain.bodies) if is_zero(body.mass)]
        massless = [k for k in masses if all(is_zero(direction[k]) for direction in every)]
        basis = regressor_null_space.fixing(every, [k + axis for k in massless for axis in (1, 2, 3)])
        # A semidefinite program in each link's own units: room, targets, which links change, and how little.
        bodies = nearest_bodies.in_own_units(chain, basis)
        room = nearest_bodies.most_room(bodies)
        if room.value < -BORDER:
            raise refusal(robot, chain, every, room.prices, bodies.units)
        target = nearest_bodies.targets(bodies, room)
        border = tuple(int(i) + 1 for i in np.flatnonzero(target < 0))
        if border and float(nearest_bodies.least_eigenvalues(bodies).min()) >= -BORDER:
            return Possible(robot, (), border)
        bodies = nearest_bodies.weighed(bodies, target)
        changed = nearest_bodies.needed(bodies, target)
        still = [WIDTH * i + k for i in range(robot.n) if i not in changed for k in range(WIDTH)]
        fewer = regressor_null_space.fixing(basis, still)
        for among in (fewer, basis):  # at the limit a solver may need the other links, too
            alone = replace(nearest_bodies.in_own_units(chain, among), masses=bodies.masses)
            if (steps := _decimal_steps(alone, target)) is not None:
                with suppress(DeriveError):  # rounding left a link a first moment without a mass
                    return _result(robot, chain, domain, regressor_null_space.combined(among, steps), border)
        raise DeriveError(f"{robot.name}: consistent inertias with these torques may exist, but the search found none")


def wants_possible(inertia: str) -> bool:
    """Whether physically consistent bodies are asked for."""
    if inertia not in INERTIAS:
        allowed = f"allowed: {', '.join(INERTIAS)}"
        raise DeriveError(
            f"unknown choice of inertia {quoted(inertia)}", allowed=allowed, remedy=near_miss(inertia, INERTIAS)
        )
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
        found = nearest_bodies.nearest(bodies, target)
    except DeriveError:
        return None
    lengths = np.sqrt((bodies.along**2).sum(axis=(0, 1)))
    for unit in UNITS:
        places = [floor(-log10(unit / length)) for length in lengths]
        steps = [fmpq(round(step * 10**p), 1) / fmpq(10) ** p for step, p in zip(found, places, strict=True)]
        reached = nearest_bodies.least_eigenvalues(bodies, np.array([float(step) for step in steps]))
        if (reached >= target - abs(target) / 2).all():
            return steps
    return None


def _result(
    robot: Robot, chain: Chain[Exact], domain: ExactDomain, moved: Direction, border: tuple[int, ...]
) -> Possible:
    """The links after a change of their parameters."""
    links, changes = list(robot.links), []
    shapes = nearest_bodies.in_own_units(chain, [moved])
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
    moment = add(body.first_moment, scale(-body.mass, end.position))
    moments = multiply(turned, moment)
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
