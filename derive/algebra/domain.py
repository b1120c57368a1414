"""The polynomial ring of one robot, and the way of an exact expression into it and out again."""

from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from functools import cached_property
from itertools import takewhile
from math import prod
from typing import Generic, TypeVar

from derive.algebra import generators
from derive.algebra.angles import composed, contracted_groups, decompose, printed_offsets
from derive.algebra.generators import MAX_MULTIPLE, SPECIAL, Generator, Kind, canonical, scaled, sine_and_cosine
from derive.algebra.ring import UNBOUNDED, Polynomial, Ring
from derive.errors import ExpressionError
from derive.robot import tree
from derive.robot.description import Joint, coupling, drives, position, second_derivative
from derive.robot.expression import ZERO, Call, Expression, Name, Number, Pi, Power, Product, Sum, add, multiply, power
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.options.style import Contraction
from derive.robot.robot import Robot

Value = TypeVar("Value")


class PolynomialDomain:
    """Exact polynomials as scalars of the mechanics (a `derive.mechanics.chain.Domain`)."""

    def __init__(
        self,
        robot: Robot,
        extra: Iterable[Expression] = (),
        *,
        sums: Callable[[tuple[int, ...]], bool] = lambda group: True,
        contraction: Contraction = Contraction.ALIGNED,
        rates: bool = True,
        offsets: bool = False,
        max_terms: int = UNBOUNDED,
    ) -> None:
        self.robot, self.contraction = robot, contraction
        self._pairs: dict[Expression, tuple[Polynomial, Polynomial]] = {}  # cosine and sine of the angles seen
        # groups: revolute joints with parallel axes, see `derive.algebra.angles`; directions: for each joint +1, or -1
        # where its angle is subtracted in the sums of its group
        self.groups, self.directions = contracted_groups(robot, contraction)
        self.with_offsets = offsets  # whether sines and cosines add the constants of their cells to the variables
        # for each joint the constant that its sines and cosines add to the variable [rad]
        self.offsets = printed_offsets(robot, self.groups, self.directions) if offsets else (ZERO,) * robot.n
        # in a group the generator of a joint is the sum of its angle and all before it, where `sums` says so
        home = {joint: group for group in self.groups for joint in group}
        summed = {i: group[: group.index(i) + 1] if sums(group) else (i,) for i, group in home.items()}
        # for each joint the joints whose variables its generator sums, empty for a prismatic joint
        self.angles = tuple(summed.get(i, ()) for i in range(robot.n))
        self._same = self._same_angles() if robot.coupled else {}
        # only joints up to the first whose sum is another's: between later ones sums are not those of neighbours
        before = (tuple(takewhile(lambda i: i not in self._same, group)) for group in self.groups)
        self.groups = tuple(group for group in before if group)
        self._pair_siblings(robot)
        own = robot.joints if not robot.coupled else ()
        self._revolute = {joint.variable: i for i, joint in enumerate(own) if joint.is_revolute}
        values, angles = generators.robot_cells(robot)
        self.atoms = generators.collect([*values, *extra], angles, frozenset(self._revolute))
        # what the generators stand for, in the order of the ring
        self.generators = tuple(self._needed_generators(rates))
        # index of the generator of some kind that belongs to a joint
        self.places = {(g.kind, g.joint): i for i, g in enumerate(self.generators) if g.joint >= 0}
        self.ring = Ring([g.name for g in self.generators], max_terms)
        # Roots and inverses last: their relations hold polynomials in the other generators.
        for g in self.generators:
            if g.kind is Kind.PRIME_ROOT:
                self.ring.relate_root(g.name, self.constant(g.argument))
            elif g.partner and self.ring.index[g.name] < self.ring.index[g.partner]:
                self.ring.relate_angle(g.name, g.partner)
        for g in reversed(self.generators):
            if g.kind is Kind.ROOT:
                self.ring.relate_root(g.name, self.constant(g.argument))
            elif g.kind is Kind.INVERSE:
                self.ring.relate_inverse(g.name, self.constant(g.argument))
        self._pairs.clear()  # from here on all relations hold

    def _same_angles(self) -> dict[int, tuple[int, int]]:
        """For each coupled joint whose sum is that of a joint before, or opposed, that joint and +-1; 0 for no sum."""
        known: dict[tuple[Fraction, frozenset[tuple[Expression, Fraction]]], int] = {}
        found: dict[int, tuple[int, int]] = {}
        for i, members in enumerate(self.angles):
            if not members:
                continue
            exact = decompose(canonical(self.printed_angle(members)))
            for sign in (1, -1):
                key = sign * exact.pi_multiple, frozenset((unit, sign * k) for unit, k in exact.terms)
                if key in known:
                    found[i] = known[key], sign
            if not exact.terms and exact.pi_multiple == 0:
                found[i] = i, 0
            if i not in found:
                known[exact.pi_multiple, frozenset(exact.terms)] = i
        return found

    def _pair_siblings(self, robot: Robot) -> None:
        """Two joints on one row, each alone in its group, form one where another joint follows both, as by q1 - q2."""
        parents, followed = tree.parents(robot), [dict(joint.drive).keys() for joint in robot.joints]
        alone = sorted((parents[group[0]], group[0]) for group in self.groups if len(group) == 1)
        for parent in {parent for parent, _ in alone} if robot.coupled else ():
            pair = tuple(i for before, i in alone if before == parent)
            if len(pair) == 2 and any({robot.joints[i].variable for i in pair} <= both for both in followed):
                self.groups = (*(group for group in self.groups if group[0] not in pair), pair)
                self.directions = tuple(-1 if i == pair[1] else way for i, way in enumerate(self.directions))

    @cached_property
    def coupling(self) -> list[list[Polynomial]]:
        """S of coupled joints, a row for each joint and a column for each variable."""
        return coupling(self.robot, self.constant)

    @cached_property
    def _turning(self) -> dict[int, list[Polynomial]]:
        """For each joint with generators the derivatives, by the variables, of the sum of angles that these are of."""
        turning = {}
        for i, members in enumerate(self.angles):
            if members and i not in self._same:
                signs = [self.directions[members[0]] * self.directions[m] for m in members]
                rows = [[sign * entry for entry in self.coupling[m]] for sign, m in zip(signs, members, strict=True)]
                turning[i] = [sum(column, self.ring.zero) for column in zip(*rows, strict=True)]
        return turning

    def _needed_generators(self, rates: bool) -> Iterator[Generator]:
        """Those that a relation eliminates come before those that replace them."""
        atoms, joints = self.atoms, self.robot.joints
        yield from (Generator(Kind.INVERSE, f"1/{e!r}", e) for e in reversed(atoms.inverses))
        yield from (Generator(Kind.ROOT, f"sqrt {e!r}", e) for e in reversed(atoms.roots))
        yield from (Generator(Kind.PRIME_ROOT, f"sqrt {p}", Number(Fraction(p))) for p in sorted(atoms.primes))
        moving = [
            sine_and_cosine(self.printed_angle(members), "+".join(joints[m].variable for m in members), i)
            for i, members in enumerate(self.angles)
            if members and i not in self._same
        ]
        constant: list[tuple[Generator, Generator]] = []
        for unit, divisor in atoms.units.items():
            if not (isinstance(unit, Name) and unit.name in self._revolute):
                parts = [Fraction(1, divisor)] if atoms.is_common(unit) else list(atoms.multiples[unit])
                constant += [sine_and_cosine(scaled(unit, part), repr(scaled(unit, part))) for part in parts]
        # of an angle near 0 the cosine's squares go: s^2 is a small number, 1 - c^2 the difference of two large ones
        small = [sine_and_cosine(scaled(Pi(), rest), repr(scaled(Pi(), rest)))[::-1] for rest in atoms.pi_rests]
        for pairs in (moving, constant, small):
            yield from (eliminated for eliminated, _ in pairs)
            yield from (kept for _, kept in pairs)
        slid = {name for joint in joints if not joint.is_revolute for name, _ in drives(joint)}
        for i, mover in enumerate(self.robot.movers):  # passive joints behind all variables
            if mover.variable in slid:
                yield Generator(Kind.VARIABLE, mover.variable, Name(mover.variable), i)
        known = set(slid)
        for kind, rename in ((Kind.ACCELERATION, acceleration_name), (Kind.RATE, velocity_name)):
            renamed = [rename(mover.variable) for mover in self.robot.variables]
            known.update(renamed)
            if rates:
                yield from (Generator(kind, name, Name(name), i) for i, name in enumerate(renamed))
        yield from (Generator(Kind.PARAMETER, name, Name(name)) for name in atoms.names if name not in known)
        if atoms.has_pi:
            yield Generator(Kind.PI, "pi", Pi())

    def angle_sum(self, members: tuple[int, ...]) -> Expression:
        """The sum of some joint variables of a group, the first of them positive."""
        first = self.directions[members[0]]
        if self.robot.coupled:
            turns = (Number(Fraction(first * self.directions[m])) for m in members)
            joints = (self.robot.joints[m] for m in members)
            angles = (position(joint) if joint.drive else Name(joint.variable) for joint in joints)
            return composed(decompose(add(*(multiply(turn, angle) for turn, angle in zip(turns, angles, strict=True)))))
        terms = [scaled(Name(self.robot.joints[m].variable), Fraction(first * self.directions[m])) for m in members]
        return terms[0] if len(terms) == 1 else Sum(tuple(terms))

    def offset_sum(self, members: tuple[int, ...]) -> Expression:
        """What sines and cosines add to `angle_sum`."""
        first = self.directions[members[0]]
        terms = (multiply(Number(Fraction(first * self.directions[m])), self.offsets[m]) for m in members)
        return composed(decompose(add(*terms)))

    def printed_angle(self, members: tuple[int, ...]) -> Expression:
        """The angle of a printed sine or cosine: `angle_sum` with `offset_sum`."""
        return add(self.angle_sum(members), self.offset_sum(members))

    def adds_angles(self, group: tuple[int, ...]) -> bool:
        """Whether the generators of a group are sums of angles, not the angles themselves."""
        return len(group) > 1 and len(self.angles[group[1]]) > 1

    # -- scalars of the mechanics

    def number(self, value: int | Fraction) -> Polynomial:
        """A rational as a constant polynomial."""
        return self.ring.number(value)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of the angle of a revolute joint, ``sign*q + theta``."""
        c, s = self.cosine_sine_of(index, offset=True)
        # cos(-q) = cos q, sin(-q) = -sin q; then the constant of the cell that the generator does not hold already
        turned = (c, s) if joint.sign > 0 else (c, -s)
        rest = add(joint.theta, multiply(Number(Fraction(-joint.sign)), self.offsets[index]))
        return _add_angles(turned, self.cosine_sine(rest))

    def joint_offset(self, index: int, joint: Joint) -> Polynomial:
        """The displacement of a prismatic joint, ``sign*q + d`` [m]."""
        if joint.drive:
            return self.constant(add(position(joint), joint.d))
        return joint.sign * self.ring.generator(joint.variable) + self.constant(joint.d)

    def cosine_sine_of(self, index: int, *, offset: bool = False) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of the variable of a revolute joint itself."""
        pair = self._generator_pair(index)
        if len(self.angles[index]) > 1:
            # q_i = (q_1 + ... + q_i) - (q_1 + ... + q_(i-1)), by the addition theorem
            cosine, sine = self._generator_pair(self.angles[index][-2])
            turned = _add_angles(pair, (cosine, -sine))
            pair = turned if self.directions[index] > 0 else (turned[0], -turned[1])
        if offset or self.offsets[index] == ZERO:
            return pair
        # the generator is that of sign*q + theta: theta is taken off again
        joint = self.robot.joints[index]
        cosine, sine = self.cosine_sine(joint.theta)
        c, s = _add_angles(self.joint_cosine_sine(index, joint), (cosine, -sine))
        return c, joint.sign * s

    def _generator_pair(self, index: int) -> tuple[Polynomial, Polynomial]:
        same, sign = self._same.get(index, (index, 1))
        if sign == 0:
            return self.ring.one, self.ring.zero
        if same != index:
            c, s = self._generator_pair(same)
            return c, sign * s
        cosine = self.generators[self.places[Kind.COSINE, index]]
        return self.ring.generator(cosine.name), self.ring.generator(cosine.partner)

    def rate(self, index: int) -> Polynomial:
        """The velocity of a joint [rad/s or m/s]."""
        return self.ring.generator(velocity_name(self.robot.variables[index].variable))

    def acceleration(self, index: int) -> Polynomial:
        """The acceleration of a joint [rad/s^2 or m/s^2]."""
        return self.ring.generator(acceleration_name(self.robot.variables[index].variable))

    def constant(self, expression: Expression) -> Polynomial:
        """The polynomial of an expression."""
        match expression:
            case Number(value):
                return self.ring.number(value)
            case Pi():
                return self.ring.generator("pi")
            case Name(name):
                return self.ring.generator(name)
            case Sum(terms):
                return sum((self.constant(t) for t in terms), self.ring.zero)
            case Product(factors):
                return prod(map(self.constant, factors), start=self.ring.one)
            case Power(base, exponent) if exponent >= 0:
                return self.constant(base) ** exponent
            case Power(Number(value), exponent):
                return self.ring.number(1 / value) ** -exponent
            case Power(base, exponent):
                return self.ring.generator(f"1/{canonical(base)!r}") ** -exponent
            case Call("sqrt", (Number(value),)):
                if value < 0:
                    raise ExpressionError("square root of a negative number", allowed="allowed: real values")
                factor, primes = generators.square_free(value)
                return prod((self.ring.generator(f"sqrt {p}") for p in primes), start=self.ring.number(factor))
            case Call("sqrt", (argument,)):
                return self.ring.generator(f"sqrt {canonical(argument)!r}")
            case Call("tan", (argument,)):
                return self.cosine_sine(argument)[1] * self.ring.generator(f"1/{canonical(Call('cos', (argument,)))!r}")
            case Call("cos", (argument,)):
                return self.cosine_sine(argument)[0]
            case Call("sin", (argument,)):
                return self.cosine_sine(argument)[1]
            case Call(function):
                found = f"{function} in an algebraic expression"
                raise ExpressionError(found, allowed="allowed: sums and products of sines, cosines and names")

    # -- angles

    def cosine_sine(self, angle: Expression) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of an angle made of constants and joint variables."""
        if (pair := self._pairs.get(angle)) is None:
            exact = generators.bundled(decompose(canonical(angle)), frozenset(self._revolute))
            pair = self._pi_multiple(exact.pi_multiple)
            for unit, k in exact.terms:
                pair = _add_angles(pair, self._unit_multiple(unit, k))
            self._pairs[angle] = pair
        return pair

    def _pi_multiple(self, multiple: Fraction) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of multiple*pi: those of the rest below an eighth turn, turned by right angles."""
        ring, half = self.ring, Fraction(1, 2)
        quarter, signed_rest = generators.split_pi(multiple)
        rest = abs(signed_rest)
        if rest == 0:
            cosine, sine = ring.one, ring.zero
        elif rest not in SPECIAL:
            key = repr(scaled(Pi(), rest))
            cosine, sine = ring.generator(f"cos {key}"), ring.generator(f"sin {key}")
        else:
            # cos(pi/4) = sin(pi/4) = sqrt(2)/2, cos(pi/6) = sqrt(3)/2, sin(pi/6) = 1/2
            cosine = half * ring.generator(f"sqrt {SPECIAL[rest][0]}")
            sine = cosine if rest == Fraction(1, 4) else ring.number(half)
            if rest == Fraction(1, 12):  # pi/12 = pi/4 - pi/6: sqrt(2)/2 (sqrt(3)/2 +- 1/2)
                second = half * ring.generator("sqrt 3")
                cosine, sine = cosine * (second + half), cosine * (second - half)
        if signed_rest < 0:
            sine = -sine
        for _ in range(quarter):
            cosine, sine = -sine, cosine
        return cosine, sine

    def _unit_multiple(self, unit: Expression, k: Fraction) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of k*unit, by the addition theorem from the part of the unit that has generators."""
        positive, size = k > 0, abs(k)
        # of plain radians every number is a unit of its own, of symbols the common part of all coefficients that occur
        if unit == Number(Fraction(1)):
            unit, size = Number(size), Fraction(1)
        if isinstance(unit, Name) and unit.name in self._revolute:
            one, part = self.cosine_sine_of(self._revolute[unit.name]), Fraction(1)
        else:
            part = Fraction(1, self.atoms.units[unit]) if self.atoms.is_common(unit) else size
            key = repr(scaled(unit, part))
            one = self.ring.generator(f"cos {key}"), self.ring.generator(f"sin {key}")
        count = size / part
        if count.denominator != 1 or count > MAX_MULTIPLE:
            found = f"the multiple {size if positive else -size} of one angle"
            raise ExpressionError(found, allowed=f"allowed: whole multiples up to {MAX_MULTIPLE} of a common part")
        cosine, sine = self.ring.one, self.ring.zero
        for _ in range(int(count)):
            cosine, sine = _add_angles((cosine, sine), one)
        return cosine, sine if positive else -sine

    # -- calculus

    def derivative(self, p: Polynomial, variable: int) -> Polynomial:
        """The partial derivative with respect to a variable."""
        place = self.places.get((Kind.VARIABLE, variable))
        total = self.ring.zero if place is None else p.partial(place)
        for i, factors in self._turning.items():
            if factor := factors[variable]:
                by_sine, by_cosine = (p.partial(self.places[kind, i]) for kind in (Kind.SINE, Kind.COSINE))
                if by_sine or by_cosine:
                    cosine, sine = self._generator_pair(i)
                    total = total + factor * (by_sine * cosine - by_cosine * sine)
        for at, joint in enumerate(self.robot.passive, self.robot.dof):
            if (slider := self.places.get((Kind.VARIABLE, at))) is not None:
                total = total + p.partial(slider) * self.coupling[self.robot.joints.index(joint)][variable]
            name = self.robot.variables[variable].variable
            for other, slope in joint.follows if name in dict(joint.follows) else ():
                if by_slope := p.partial(self.ring.index[slope.name]):
                    total = total + by_slope * self.constant(second_derivative(joint, other, name))
        return total


class MappedDomain(Generic[Value]):
    """A `derive.mechanics.chain.Domain` whose scalars are made of the exact cells, angles and offsets of an arm."""

    def __init__(self, domain: PolynomialDomain, value: Callable[[Polynomial], Value]) -> None:
        self.domain, self._value = domain, value

    def number(self, value: int | Fraction) -> Value:
        """A rational."""
        return self._value(self.domain.number(value))

    def constant(self, expression: Expression) -> Value:
        """A cell without joint variables."""
        return self._value(self.domain.constant(expression))

    def cosine_sine(self, angle: Expression) -> tuple[Value, Value]:
        """Cosine and sine of a constant angle."""
        cosine, sine = self.domain.cosine_sine(angle)
        return self._value(cosine), self._value(sine)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Value, Value]:
        """Cosine and sine of ``sign*q + theta`` of a revolute joint."""
        cosine, sine = self.domain.joint_cosine_sine(index, joint)
        return self._value(cosine), self._value(sine)

    def joint_offset(self, index: int, joint: Joint) -> Value:
        """``sign*q + d`` of a prismatic joint."""
        return self._value(self.domain.joint_offset(index, joint))


def polynomial_expression(p: Polynomial, domain: PolynomialDomain) -> Expression:
    """The polynomial as an expression tree, term by term."""
    bases = [g.expression for g in domain.generators]
    return add(*(multiply(Number(factor), *map(power, bases, exponents)) for exponents, factor in p.terms()))


def _add_angles(a: tuple[Polynomial, Polynomial], b: tuple[Polynomial, Polynomial]) -> tuple[Polynomial, Polynomial]:
    """Cosine and sine of a sum of two angles."""
    return a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]
