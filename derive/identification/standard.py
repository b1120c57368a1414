"""From base parameters to the links of a robot file: the standard parameters nearest to those that it had.

Torques know base parameters alone, beta = K x with x the standard parameters. Of all x that have the identified beta
the nearest to the prior is taken, each change in units of its link: mass m, radius r of gyration about the frame's
origin, so that a wrist counts as much as an upper arm. With `--method possible` the torques are fitted as well as links
allow that can exist: pseudo-inertias without negative eigenvalues (Wensing, Kim and Slotine, IEEE Robotics and
Automation Letters 3(1), 2018; Sousa and Cortesao, Int. J. Robotics Research 33(6), 2014).
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, reduce
from operator import sub
from typing import Any, Self

import numpy as np

from derive.algebra.domain import PolynomialDomain, polynomial_expression
from derive.algebra.quotients import Quotient
from derive.algebra.ring import Polynomial
from derive.arrays import Array
from derive.errors import DeriveError, ExpressionError, QuantityError, quoted, require_known
from derive.identification.regression import Estimate
from derive.mechanics.chain import Domain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.vectors import S, Symmetric, steiner
from derive.model.identification.base_parameters import BaseSet, base_set, base_values, standard_values
from derive.model.identification.possible import MARGIN, pseudo_inertias
from derive.model.identification.semidefinite import Cone, Limit, least, packed
from derive.robot import inertial_parameters, tree
from derive.robot.description import INERTIA, Inertia, Link, Motor
from derive.robot.expression import ONE, ZERO, Expression, Name, Number, add, multiply, number
from derive.robot.inertial_parameters import FRICTION_PARTS, LINK_PARTS, REGRESSOR_JOINTS, Parameter
from derive.robot.names import free_symbols, without_lost_symbols
from derive.robot.robot import Robot

ADDED = ("viscous", "coulomb", "armature")  # what a robot file may lack and a log may tell
DIGITS = 12  # of the numbers in a robot file
FAR = 0.1  # radius of gyration of links of which nothing is known [m]
BEYOND = 10.0  # times what its file says no robot has
LIGHT = 1e-6  # part of its unit of mass below which a link has none
SLACK = 0.1  # the pull of the prior per unit of change, where the noise of all torques pulls with 1
POWERS = {"m": 0, "mm": 0, "mx": 1, "my": 1, "mz": 1}  # of a length in the units of parameters, else 2
WIDTH = len(LINK_PARTS)


@dataclass(frozen=True, eq=False)
class Unknowns:
    """What is identified of a robot, s standard and p base parameters, and what its file says of it."""

    robot: Robot
    wide: Robot  # the robot with all that is identified: one where its file gives nothing
    base: BaseSet
    standard: tuple[Parameter, ...]
    given: Array  # (s,) the standard parameters as the file has them, without bodies that are fixed to links
    grouping: Array  # K, (p, s): the base parameters are what the standard parameters are times it
    prior: Array  # (p,) the base parameters as the file has them

    @classmethod
    def of(cls, robot: Robot, added: Sequence[str] = ()) -> Self:
        """Those of a robot, and what its file lacks of some of `ADDED`."""
        tree.require_own_variables(robot, "identification")
        for name in added:
            require_known(name, ADDED, f"no part {quoted(name)} to add")
        if robot.root is not None or robot.n > REGRESSOR_JOINTS:
            found = f"identification of {robot.name}, {'whose root moves' if robot.root else f'of {robot.n} joints'}"
            raise QuantityError(found, allowed=f"allowed: robots that stand, of up to {REGRESSOR_JOINTS} joints")
        if not robot.links:
            remedy = "write links with a mass each, 0 where nothing is known"
            raise QuantityError(f"{robot.name} has no links to identify", remedy=remedy)
        for lacking in free_symbols(replace(robot, runtime=())):
            remedy = f"write parameters: {{{lacking}: 0}} where nothing is known of a link"
            raise QuantityError(f"the symbol '{lacking}' of {robot.name} has no number", remedy=remedy)
        links = []
        for link in robot.links:
            ones: dict[str, Any] = {name: ONE for name in added if getattr(link, name) == ZERO}
            links.append(replace(link, **ones))
        wide = replace(robot, links=tuple(links), runtime=())
        base, standard = base_set(wide), inertial_parameters.standard_parameters(wide)
        domain = FloatDomain(robot, [0.0] * robot.n)

        def _number(coefficient: Quotient) -> float:
            numerator, denominator = map(domain.constant, base.fraction(coefficient))
            return numerator / denominator

        bare = replace(robot, fixed=tree.massless(robot.fixed))
        given, whole = (np.array(standard_values(each, standard, domain)) for each in (bare, robot))
        grouping = np.array(grouped(wide, base, domain, _number)).T
        prior, rounding = grouping @ whole, np.finfo(float).eps * (np.abs(grouping) @ np.abs(whole))
        return cls(robot, wide, base, standard, given, grouping, np.where(np.abs(prior) > 10 * rounding, prior, 0.0))

    @cached_property
    def formulas(self) -> tuple[Expression | None, ...]:
        """What each base parameter groups, ``Izz1 + a2**2*m3``; None where a cell is none of polynomials."""

        def _polynomial(coefficient: Quotient) -> Polynomial:
            top, bottom = self.base.fraction(coefficient)
            if not isinstance(bottom, Number):
                raise ExpressionError("a denominator")
            return domain.constant(multiply(number(1 / bottom.value), top))

        with suppress(ExpressionError, ZeroDivisionError):
            domain = PolynomialDomain(_empty(self.wide), rates=False)
            columns = grouped(self.wide, self.base, domain, _polynomial)
            cells = [[polynomial_expression(entry, domain) for entry in column] for column in columns]
            names = [Name(parameter.name) for parameter in self.standard]
            return tuple(add(*map(multiply, row, names)) for row in zip(*cells, strict=True))
        return (None,) * len(self.base.parameters)

    # -- scales

    @cached_property
    def _links(self) -> list[int]:
        """Where the ten parameters of each link begin."""
        return [k for k, parameter in enumerate(self.standard) if parameter.part == LINK_PARTS[0]]

    @cached_property
    def _sizes(self) -> tuple[Array, Array]:
        """Units of mass and of length of each link."""
        rows = np.array([self.given[k : k + WIDTH] for k in self._links])
        masses, spreads = rows[:, 0], rows[:, 4:7].sum(axis=1) / 2
        usual = masses[masses > 0].mean() if (masses > 0).any() else 1.0
        units = np.where(masses > LIGHT * usual, masses, usual)
        lengths = np.sqrt(np.maximum(spreads, 0) / units)
        far = lengths[lengths > 0].mean() if (lengths > 0).any() else FAR
        return units, np.where(lengths > 1e-3 * far, lengths, far)

    @cached_property
    def units(self) -> Array:
        """What a change of each standard parameter is counted in, (s,)."""
        found = []
        for parameter, value in zip(self.standard, self.given, strict=True):
            mass, length = (sizes[parameter.joint - 1] for sizes in self._sizes)
            usual = 1.0 if parameter.part in FRICTION_PARTS else mass * length ** POWERS.get(parameter.part, 2)
            found.append(usual if parameter.of_link or not value else abs(value))
        return np.array(found)

    @property
    def largest(self) -> Array:
        """More than a robot of such links has of each base parameter, (p,); infinite where nothing is known of them."""
        unknown = [p.part in FRICTION_PARTS or not self.given[self._links].any() for p in self.base.parameters]
        return np.where(unknown, np.inf, BEYOND * (np.abs(self.grouping) @ self.units))

    # -- what comes out

    @cached_property
    def _slope(self) -> Array:
        """K times the units, (p, s); masses of rotors, which are no others than those of links, stay."""
        return self.grouping * self.units * [parameter.part != "mm" for parameter in self.standard]

    def nearest(self, beta: Array) -> Array:
        """The standard parameters nearest to those given that have some base parameters, (s,)."""
        # Least |y| with K D y = beta - beta_0, D the units, rows of length one. Torques leave most masses free: one
        # that comes out negative, or zero beside a first moment, is set.
        rows, right = self._slope, beta - self.prior
        right = right / np.linalg.norm(rows, axis=1)
        rows = rows / np.linalg.norm(rows, axis=1)[:, None]
        for _ in range(self.robot.n):
            found = np.linalg.lstsq(rows, right, rcond=None)[0]
            found[np.abs(found) < 10.0**-DIGITS] = 0.0
            whole = found + self.given / self.units
            light = [k for k in self._links if whole[k] < LIGHT and np.abs(whole[k : k + 4]).max() > LIGHT]
            rows = np.concatenate([rows, np.eye(len(found))[light]])
            right = np.append(right, 0.5 - (self.given / self.units)[light])
        if np.abs(rows @ found - right).max() > LIGHT * max(1.0, np.abs(right).max()):
            found_text = f"torques leave a link of {self.robot.name} no mass"
            raise DeriveError(found_text, remedy="take --method possible, or a log that excites more")
        return np.asarray(whole * self.units)

    def nearest_possible(self, estimate: Estimate) -> Array:
        """The standard parameters of links that exist whose torques are nearest to those of an estimate, (s,)."""
        # How far along each unit links without a mass should go.
        wanted = np.zeros(len(self.given))
        wanted[[k for k in self._links if self.given[k] <= LIGHT * self.units[k]]] = 1.0
        slope = estimate.factor[:, :-1] @ self._slope
        offset = estimate.factor[:, :-1] @ (self.prior - estimate.beta)
        # Least |slope y + offset|^2 + SLACK^2 |y - wanted|^2, for z = y sizes, whose curvature is 1 along each axis.
        quadratic = slope.T @ slope + SLACK**2 * np.eye(len(wanted))
        sizes = np.sqrt(np.diag(quadratic))
        linear = (slope.T @ offset - SLACK**2 * wanted) / sizes
        limits = [self._exists(k, mass, length) for k, mass, length in zip(self._links, *self._sizes, strict=True)]
        if joints := [k for k, parameter in enumerate(self.standard) if not parameter.of_link]:
            limits.append(Limit(Cone.NOT_NEGATIVE, (self.given / self.units)[joints], np.eye(len(wanted))[joints]))
        limits = [replace(limit, slope=limit.slope / sizes) for limit in limits]
        scale = np.abs(linear).max() or 1.0
        found = least(linear / scale, limits, quadratic / np.outer(sizes, sizes) / scale)[0]
        standard = self.given + self.units * found / sizes
        standard[joints] = standard[joints].clip(min=0.0)  # but for rounding
        return np.asarray(standard)

    def _exists(self, k: int, mass: float, length: float) -> Limit:
        """A pseudo-inertia, in the units of its link, without an eigenvalue below `MARGIN`."""
        unit = np.array([1 / length] * 3 + [1.0]) / np.sqrt(mass)
        own = pseudo_inertias(np.diag(self.units[k : k + WIDTH])[None])[0]
        slope = np.zeros((WIDTH, len(self.given)))
        slope[:, k : k + WIDTH] = packed(np.moveaxis(own, 2, 0) * np.outer(unit, unit)).T
        given = pseudo_inertias(self.given[None, k : k + WIDTH])[0] * np.outer(unit, unit)
        return Limit(Cone.SEMIDEFINITE, packed(given - MARGIN * np.eye(4)), slope)

    def robot_of(self, standard: Array) -> Robot:
        """The robot with these standard parameters; what does not change stays as it is written."""
        links = list(self.robot.links)
        same = np.abs(standard - self.given) <= 10.0**-DIGITS * self.units
        for k, parameter in enumerate(self.standard):
            i, body = parameter.joint - 1, slice(k, k + WIDTH)
            if k in self._links and not same[body].all():
                links[i] = _with_body(links[i], standard[body])
            if not parameter.of_link and not same[k]:
                links[i] = _with_part(links[i], parameter.part, _cell(standard[k]))
        return without_lost_symbols(self.robot, replace(self.robot, links=tuple(links)))


def _empty(robot: Robot) -> Robot:
    """A robot without bodies and friction; an armature that it has is one, as rotors are counted into it."""
    links = []
    for link in robot.links:
        motor, dry = link.motor and Motor(ratio=link.motor.ratio), isinstance(link.coulomb, tuple)
        armature = ZERO if link.armature == ZERO else ONE
        links.append(Link(motor=motor, armature=armature, coulomb=(ZERO, ZERO) if dry else ZERO))
    return replace(robot, links=tuple(links), fixed=tree.massless(robot.fixed))


def grouped(robot: Robot, base: BaseSet, domain: Domain[S], coefficient: Callable[[Quotient], S]) -> list[list[S]]:
    """For each standard parameter what one unit of it adds to the base parameters, which are linear in them."""
    empty = _empty(robot)

    def _values(link: Link | None = None, i: int = 0) -> list[S]:
        links = (*empty.links[:i], link or empty.links[i], *empty.links[i + 1 :])
        return base_values(replace(empty, links=links), base, domain, coefficient)

    nothing, columns = _values(), dict[Parameter, list[S]]()
    for parameter in inertial_parameters.standard_parameters(robot):
        link, part, is_moment = empty.links[parameter.joint - 1], parameter.part, parameter.part in LINK_PARTS[1:4]
        if parameter.of_link:  # a first moment comes with a mass, which is taken off again
            one = _with_body(link, [float(p == part or (is_moment and p == "m")) for p in LINK_PARTS])
        else:
            one = _with_part(link, part, number(2) if part == "Ia" else ONE)
        less = [nothing, columns[Parameter(parameter.joint, "m")]] if is_moment else [nothing]
        rows = zip(_values(one, parameter.joint - 1), *less, strict=True)
        columns[parameter] = [reduce(sub, cells) for cells in rows]
    return list(columns.values())


def _with_part(link: Link, part: str, cell: Expression) -> Link:
    motor, (ahead, back) = link.motor or Motor(), link.dry
    cells: dict[str, Any] = {"Ia": {"armature": cell}, "b": {"viscous": cell}, "f": {"coulomb": cell}}
    cells |= {"fp": {"coulomb": (cell, back)}, "fm": {"coulomb": (ahead, cell)}}
    cells |= {"mm": {"motor": replace(motor, mass=cell)}, "Im": {"motor": replace(motor, inertia=cell)}}
    return replace(link, **cells[part])


def _with_body(link: Link, parameters: Sequence[float] | Array) -> Link:
    """A link with other ten parameters about the origin of its frame."""
    mass, mx, my, mz, *tensor = parameters
    com = (mx / mass, my / mass, mz / mass) if mass else (0.0, 0.0, 0.0)
    about = Symmetric(*tensor) + steiner(-mass, com)
    x, y, z = map(_cell, com)
    inertia = Inertia(*(_cell(getattr(about, name)) for name in INERTIA))
    return replace(link, mass=_cell(mass), com=(x, y, z), inertia=inertia)


def _cell(value: float) -> Number:
    return number(Fraction(f"{value:.{DIGITS}g}"))
