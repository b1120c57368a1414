"""What is solved for, as generators of one ring: joint angles, slides, and sums of the angles of parallel joints.

Parallel joints form a group (opposed axes too), whose angles books add. Seen from its first link the link after k
joints of a group of m is turned by phi_k, k = 0..m; joint angles and their sums are the differences phi_v - phi_u.
Each difference has a cosine and a sine of its own in the ring: which of them describe an arm is a matter of choice,
made equation by equation. Knowing some of them splits 0..m into sets within which all differences are known.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import combinations, product
from typing import TypeVar

from derive.algebra.angles import decompose
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Generator, Kind
from derive.algebra.ring import Polynomial, Ring, in_lowest_terms
from derive.inverse.closed.nodes import Unknown
from derive.mechanics.vectors import Scalar
from derive.robot import tree as between_rows
from derive.robot.description import Joint
from derive.robot.expression import ZERO, Expression, Name, Number, Pi, add, multiply, names, substitute
from derive.robot.options.style import Contraction
from derive.robot.robot import Robot

# Invariants p.p, u = R^T p, m = [p]x R and k = p.p R - 2 p u^T of the pose W = (R, p) within the arm; then its entries
# and those of the pose T.
POSE_NAMES = (
    "p.p",
    *(f"u[{k}]" for k in (1, 2, 3)),
    *(f"{name}[{row},{column}]" for name in "mk" for row in (1, 2, 3) for column in (1, 2, 3)),
    *(f"{name}[{row},{column}]" for name in "WT" for row in (1, 2, 3) for column in (1, 2, 3, 4)),
)
S = TypeVar("S", bound=Scalar)

# The links of a group as sets (bits) that stand still against each other, the one of link 0 first.
Parts = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class State:
    """What is known."""

    groups: tuple[Parts, ...]  # for each group its parts
    slides: frozenset[int]  # the slides that are known

    def joined(self, group: int, a: int, b: int) -> State:
        """With the angle between two parts of a group; with slide a where there is no group."""
        if group < 0:
            return State(self.groups, self.slides | {a})
        rest = [part for part in self.groups[group] if part not in (a, b)]
        parts = tuple(sorted([*rest, a | b], key=lambda part: part & -part))
        return State((*self.groups[:group], parts, *self.groups[group + 1 :]), self.slides)


class InverseDomain(PolynomialDomain):
    """A robot's ring with cosine and sine of every sum of neighbouring angles of a group, and with `POSE_NAMES`."""

    def __init__(self, robot: Robot, extra: Iterable[Expression] = ()) -> None:
        super().__init__(robot, extra, sums=lambda group: False, contraction=Contraction.OPPOSED, rates=False)

    def _needed_generators(self, rates: bool) -> Iterator[Generator]:
        for group in self.groups:
            for u, v in combinations(range(len(group) + 1), 2):
                if v - u > 1:
                    members = group[u:v]
                    key = "+".join(self.robot.joints[m].variable for m in members)
                    argument = self.angle_sum(members)
                    yield Generator(Kind.SINE, f"sin {key}", argument, -1, f"cos {key}")
                    yield Generator(Kind.COSINE, f"cos {key}", argument, -1, f"sin {key}")
        yield from super()._needed_generators(rates)
        yield from (Generator(Kind.PARAMETER, name, Name(name)) for name in POSE_NAMES)

    def unknown(self, *joints: int) -> Unknown:
        """The angle of a joint, or of the sum of neighbouring ones of a group, or the length of a slide."""
        key = "+".join(self.robot.joints[m].variable for m in joints)
        if not self.robot.joints[joints[0]].is_revolute:
            return Unknown(joints, (1,), (key,))
        signs = tuple(self.directions[joints[0]] * self.directions[m] for m in joints)
        return Unknown(joints, signs, (f"cos {key}", f"sin {key}"))

    def joint_turn(self, joint: int, start: int) -> tuple[Polynomial, ...]:
        """The motion of a joint about (along) its own axis, its angle as a difference of sums of angles."""
        row = self.robot.joints[joint]
        if not row.is_revolute:
            return (row.sign * self.ring.generator(row.variable),)
        g, before, behind = self.ends(self.unknown(joint))
        group, sign = self.groups[g], row.sign * self.directions[joint]
        root = sum(member < start for member in group) if start >= 0 else len(group)
        (c, s), (d, e) = self.turn(g, root, before), self.turn(g, root, behind)
        return c * d + s * e, sign * (c * e - s * d)

    def turn(self, group: int, u: int, v: int) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of phi_v - phi_u of a group."""
        if u == v:
            return self.ring.one, self.ring.zero
        members = self.groups[group][min(u, v) : max(u, v)]
        cosine, sine = map(self.ring.generator, self.unknown(*members).generators)
        return cosine, sine if (self.directions[members[0]] > 0) == (u < v) else -sine

    @cached_property
    def square_reach(self) -> Polynomial:
        """The squares of all lengths of the table, 1 m where it has none, and of the position."""
        cells = [cell for joint in self.robot.joints for cell in (joint.a, joint.d)] + between_rows.lengths(self.robot)
        cells += [row[3] for matrix in (self.robot.base, self.robot.tool) for row in matrix[:3]]
        lengths = [length for length in map(self.constant, cells) if length] or [self.ring.one]
        lengths += [self.ring.generator(f"T[{k},4]") for k in (1, 2, 3)]
        return sum((x * x for x in lengths), self.ring.zero)

    def unknowns(self) -> Iterator[Unknown]:
        """All angles, sums of angles and slides."""
        for group in self.groups:
            for u in range(len(group)):
                yield from (self.unknown(*group[u:v]) for v in range(u + 1, len(group) + 1))
        yield from (self.unknown(i) for i, joint in enumerate(self.robot.joints) if not joint.is_revolute)

    def owner(self, name: str) -> Unknown | None:
        """The unknown of a generator."""
        return next((unknown for unknown in self.unknowns() if name in unknown.generators), None)

    def between(self, number: int, parts: tuple[int, int]) -> list[Unknown]:
        """The angles between two parts of a group, those of few joints first; or the slide."""
        if number < 0:
            return [self.unknown(parts[0])]
        group = self.groups[number]
        links = [[k for k in range(len(group) + 1) if part >> k & 1] for part in parts]
        ends = (sorted(pair) for pair in product(*links))
        return [self.unknown(*group[u:v]) for u, v in sorted(ends, key=lambda e: (e[1] - e[0], e))]

    def ends(self, unknown: Unknown) -> tuple[int, int, int]:
        """The group of an angle and the two links that it is between."""
        g = next(k for k, group in enumerate(self.groups) if unknown.joints[0] in group)
        place = self.groups[g].index(unknown.joints[0])
        return g, place, place + len(unknown.joints)

    def sense(self, unknown: Unknown, forwards: bool) -> int:
        """Whether phi_v - phi_u is the angle or its negative."""
        return self.directions[unknown.joints[0]] * (1 if forwards else -1)

    @cached_property
    def _angle_places(self) -> Mapping[str, tuple[int, int, int]]:
        angles = [unknown for unknown in self.unknowns() if unknown.is_angle]
        return {name: self.ends(unknown) for unknown in angles for name in unknown.generators}

    def is_known(self, name: str, state: State) -> bool:
        """Whether a generator is known: a constant, of the pose, or of an unknown that was found."""
        generator = self.generators[self.ring.index[name]]
        if generator.kind is Kind.VARIABLE:
            return generator.joint in state.slides
        if generator.kind not in (Kind.SINE, Kind.COSINE):
            return True
        g, u, v = self._angle_places[name]
        return any(part >> u & 1 and part >> v & 1 for part in state.groups[g])

    def rewritten(self, p: Polynomial, state: State, unknown: Unknown) -> Polynomial:
        """A polynomial with all angles of a group between parts that are known, counted from one of the unknown's."""
        # What does not occur after all drops out then, for the angles between the parts are independent.
        g, *ends = self.ends(unknown) if unknown.is_angle else (-1,)
        degrees, images, changed = p.degrees(), list(self.ring.context.gens()), False
        for name, (group, u, v) in self._angle_places.items():
            if not degrees[self.ring.index[name]] or name in unknown.generators:
                continue
            homes = [next(part for part in state.groups[group] if part >> k & 1) for k in (u, v)]
            if homes[0] == homes[1]:
                continue
            kept = ends if group == g else []
            first, last = (next((k for k in kept if home >> k & 1), _lowest(home)) for home in homes)
            root = ends[0] if group == g else _lowest(state.groups[group][0])
            turn = self.turn(group, u, first)
            for a, b in ((first, root), (root, last), (last, v)):
                turn = turned(turn, self.turn(group, a, b))
            other = self.unknown(*self.groups[group][u:v])
            value = turn[0] if name == other.generators[0] else self.sense(other, forwards=True) * turn[1]
            images[self.ring.index[name]], changed = value.raw, True
        return self.ring.wrap(p.raw.compose(*images)) if changed else p


def _lowest(part: int) -> int:
    return (part & -part).bit_length() - 1


def without(ring: Ring, unknown: Unknown, p: Polynomial, q: Polynomial) -> Polynomial | None:
    """What follows from two equations when an unknown is eliminated; None where one is not of the first degree in it.

    Of A c + B s = C and D c + E s = F Cramer's rule gives cosine c and sine s, whose squares add to 1:
    (C E - B F)^2 + (A F - C D)^2 = (A E - B D)^2. Where D and E are -B and A but for constants, D = -k B, E = k A, this
    is k^2 C^2 + F^2 = k^2 (A^2 + B^2): the equations are squared and added. With A, B, C, F of the first degree in the
    cosine and sine of another angle that is a quartic for it (Pieper, The Kinematics of Manipulators under Computer
    Control, 1968).
    """
    places = [ring.index[name] for name in unknown.generators]
    first, second = (ring.coefficients(each, places) for each in (p, q))
    if any(sum(exponents) > 1 for exponents in (*first, *second)):
        return None
    if not unknown.is_angle:
        (a, b), (c, d) = ((each.get((1,), ring.zero), each.get((0,), ring.zero)) for each in (first, second))
        if not a or not c:
            return None
        m, n = in_lowest_terms(a, c)
        return n * b - m * d
    a, b, c = (first.get(e, ring.zero) for e in ((1, 0), (0, 1), (0, 0)))
    d, e, f = (second.get(x, ring.zero) for x in ((1, 0), (0, 1), (0, 0)))
    if proportional := next((pair for pair in ((a, e), (b, -d)) if all(pair)), None):
        m, n = in_lowest_terms(*proportional)
        if m * e == n * a and m * -d == n * b:  # squared and added
            return n * n * (c * c) + m * m * (f * f) - n * n * (a * a + b * b)
    determinant, across, along = a * e - b * d, b * f - c * e, c * d - a * f
    return across * across + along * along - determinant * determinant


def shifted(robot: Robot) -> tuple[Robot, tuple[Expression, ...]]:
    """The robot with its joint variables counted from where their cells have no constants but right angles."""
    joints, shifts = list[Joint](), list[Expression]()
    for joint in robot.joints:
        kept, rest = replace(joint, d=ZERO), joint.d
        if joint.is_revolute:
            kept, rest = joint, ZERO
            exact = decompose(joint.theta)
            right = Fraction(round(exact.pi_multiple * 2), 2)
            if exact.terms or exact.pi_multiple != right:
                kept = replace(joint, theta=multiply(Number(right), Pi()))
                rest = add(joint.theta, multiply(Number(-right), Pi())) if right else joint.theta
        joints.append(kept)
        shifts.append(multiply(Number(Fraction(joint.sign)), rest))
    return replace(robot, joints=tuple(joints)), tuple(shifts)


def baked(robot: Robot) -> dict[str, Expression]:
    """The numbers of the parameters that are no arguments of generated functions."""
    found: dict[str, Expression] = {}
    for name, value in robot.parameters:
        if name not in robot.runtime:
            found[name] = substitute(value, found)
    return {name: value for name, value in found.items() if not any(True for _ in names(value))}


def with_numbers(robot: Robot, numbers: Mapping[str, Expression]) -> Robot:
    """The arm alone, with numbers in place of some names."""
    _cell = partial(substitute, values=numbers)
    base, tool = (tuple(tuple(map(_cell, row)) for row in matrix) for matrix in (robot.base, robot.tool))
    joints = tuple(
        replace(j, theta=_cell(j.theta), d=_cell(j.d), a=_cell(j.a), alpha=_cell(j.alpha)) for j in robot.joints
    )
    mapped = between_rows.mapped(replace(robot, joints=joints), _cell)
    return replace(mapped, base=base, tool=tool, links=(), fixed=between_rows.massless(mapped.fixed), gravity=None)


def turned(a: Sequence[S], b: Sequence[S], sign: int = 1) -> tuple[S, S]:
    """Cosine and sine of the sum (or difference) of two angles."""
    (c, s), (d, e) = a, b
    e = e if sign > 0 else -e
    return c * d - s * e, s * d + c * e
