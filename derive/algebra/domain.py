"""The polynomial ring of one robot, and the way of an exact expression into it.

Exact polynomials as expression trees of the cell grammar.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from functools import cached_property

from derive.algebra.angles import contracted_groups, decompose
from derive.algebra.atoms import MAX_MULTIPLE, SPECIAL, Atoms, bundled, canonical, collect, split_pi, square_free
from derive.algebra.generators import Generator, Kind, robot_angles, robot_values, scaled
from derive.algebra.ring import Polynomial, Relation, Ring
from derive.errors import ExpressionError
from derive.robot.description import Joint
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, add, multiply, power
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot
from derive.robot.style import Contraction


class PolynomialDomain:
    """Exact polynomials as scalars of the mechanics (a `derive.mechanics.chain.Domain`).

    Args:
        robot: The robot whose symbols are the generators.
        extra: Further expressions that the ring must be able to hold, for instance a printed formula; names that the
            robot does not know become parameters.
        sums: For which groups of aligned joints the sums of the angles are the generators; for the others each angle
            by itself. Any choice is exact; it decides how many terms a polynomial has.
        contraction: Which parallel axes form a group.
        rates: Whether velocities and accelerations are generators too.
        max_terms: A product with more terms raises `TooManyTerms`.

    Attributes:
        groups: Revolute joints with parallel axes, see `derive.algebra.angles`.
        directions: For each joint +1, or -1 where its angle is subtracted in the sums of its group.
        angles: For each joint the joints whose variables its generator sums, empty for a prismatic joint.
    """

    def __init__(
        self,
        robot: Robot,
        extra: Iterable[Expression] = (),
        *,
        sums: Callable[[tuple[int, ...]], bool] = lambda group: True,
        contraction: Contraction = Contraction.ALIGNED,
        rates: bool = True,
        max_terms: int = 10**9,
    ) -> None:
        self.robot = robot
        self.contraction = contraction
        self.groups, self.directions = contracted_groups(robot, contraction)
        self.angles = tuple(_basis_angles(self.groups, sums, robot.n))
        self._joint = {joint.variable: i for i, joint in enumerate(robot.joints)}
        self._with_rates = rates
        self._angles = frozenset(joint.variable for joint in robot.joints if joint.is_revolute)
        self.atoms = collect([*robot_values(robot), *extra], robot_angles(robot), self._angles)
        self.generators = tuple(self._generators(self.atoms))
        self.ring = Ring([g.name for g in self.generators], max_terms)
        self._relate()

    def _generators(self, atoms: Atoms) -> Iterator[Generator]:
        yield from (Generator(Kind.INVERSE, f"1/{e!r}", e) for e in reversed(atoms.inverses))
        yield from (Generator(Kind.ROOT, f"sqrt {e!r}", e) for e in reversed(atoms.roots))
        for p in sorted(atoms.primes):
            yield Generator(Kind.PRIME_ROOT, f"sqrt {p}", Number(Fraction(p)))
        for kind, word in ((Kind.SINE, "sin"), (Kind.COSINE, "cos")):
            for i, members in enumerate(self.angles):
                if members:
                    yield Generator(kind, f"{word} {self._key(i)}", self.angle_sum(members), i)
        units = self._constant_units(atoms)
        yield from (Generator(Kind.CONSTANT_SINE, f"sin {e!r}", e) for e in units)
        yield from (Generator(Kind.CONSTANT_COSINE, f"cos {e!r}", e) for e in units)
        yield from self._variables()
        known = {j.variable for j in self.robot.joints if not j.is_revolute} | {
            f(j.variable) for j in self.robot.joints for f in (velocity_name, acceleration_name)
        }
        yield from (Generator(Kind.PARAMETER, n, Name(n)) for n in atoms.names if n not in known)
        if atoms.has_pi:
            yield Generator(Kind.PI, "pi", Pi())

    def angle_sum(self, members: tuple[int, ...]) -> Expression:
        """The sum of some angles of a group, the first of them positive."""
        first = self.directions[members[0]]
        terms = [scaled(Name(self.robot.joints[m].variable), Fraction(first * self.directions[m])) for m in members]
        return terms[0] if len(terms) == 1 else Sum(tuple(terms))

    def _key(self, index: int) -> str:
        return "+".join(self.robot.joints[m].variable for m in self.angles[index])

    def _constant_units(self, atoms: Atoms) -> list[Expression]:
        units = [
            scaled(unit, part)
            for unit, divisor in atoms.units.items()
            if not (isinstance(unit, Name) and self._is_angle(unit.name))
            for part in ([Fraction(1, divisor)] if atoms.is_common(unit) else atoms.multiples[unit])
        ]
        return units + [scaled(Pi(), rest) for rest in atoms.pi_rests]

    def _variables(self) -> Iterator[Generator]:
        variables = [(i, j.variable) for i, j in enumerate(self.robot.joints)]
        for i, q in variables:
            if not self.robot.joints[i].is_revolute:
                yield Generator(Kind.VARIABLE, q, Name(q), i)
        for kind, rename in ((Kind.ACCELERATION, acceleration_name), (Kind.RATE, velocity_name)):
            if not self._with_rates:
                break
            yield from (Generator(kind, rename(q), Name(rename(q)), i) for i, q in variables)

    def _relate(self) -> None:
        """Roots and inverses last: their relations hold polynomials in the other generators."""
        ring = self.ring
        for i, g in enumerate(self.generators):
            if g.kind is Kind.PRIME_ROOT:
                self._square(i, self.constant(g.argument))
            elif g.kind in (Kind.SINE, Kind.CONSTANT_SINE):
                cosine = ring.generator("cos" + g.name[3:])
                self._square(i, 1 - cosine * cosine)
        pending = [(i, g) for i, g in enumerate(self.generators) if g.kind in (Kind.ROOT, Kind.INVERSE)]
        for i, g in reversed(pending):
            value = self.constant(g.argument)
            if g.kind is Kind.ROOT:
                self._square(i, value)
            else:
                raw = ring.generator(g.name).raw * value.raw - 1
                ring.relate(Relation(i, raw, always=True))

    def _square(self, index: int, value: Polynomial) -> None:
        generator = self.ring.generator(self.generators[index].name)
        self.ring.relate(Relation(index, generator.raw**2 - value.raw))

    # -- scalars of the mechanics

    def number(self, value: int | Fraction) -> Polynomial:
        """A rational."""
        return self.ring.number(value)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of ``sign*q + theta``."""
        c, s = self.cosine_sine_of(index)
        turned = (c, s) if joint.sign > 0 else (c, -s)
        return _add_angles(turned, self.cosine_sine(joint.theta))

    def joint_offset(self, index: int, joint: Joint) -> Polynomial:
        """``sign*q + d``."""
        return joint.sign * self.ring.generator(joint.variable) + self.constant(joint.d)

    def cosine_sine_of(self, index: int) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of the variable of joint ``index`` itself."""
        pair = self._generators_of(index)
        if len(self.angles[index]) == 1:
            return pair
        cosine, sine = self._generators_of(self.angles[index][-2])
        turned = _add_angles(pair, (cosine, -sine))
        return turned if self.directions[index] > 0 else (turned[0], -turned[1])

    def _generators_of(self, index: int) -> tuple[Polynomial, Polynomial]:
        key = self._key(index)
        return self.ring.generator(f"cos {key}"), self.ring.generator(f"sin {key}")

    def rate(self, index: int) -> Polynomial:
        """The velocity of joint ``index``."""
        return self.ring.generator(velocity_name(self.robot.joints[index].variable))

    def acceleration(self, index: int) -> Polynomial:
        """The acceleration of joint ``index``."""
        return self.ring.generator(acceleration_name(self.robot.joints[index].variable))

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
                return self.ring.sum(self.constant(t) for t in terms)
            case Product(factors):
                result = self.ring.one
                for factor in factors:
                    result = result * self.constant(factor)
                return result
            case Power(base, exponent):
                return self._power(base, exponent)
            case Call(function, (argument,)):
                return self._call(function, argument)
        raise ExpressionError(
            "atan2 in an algebraic expression", allowed="sums and products of sines, cosines and names"
        )

    def _power(self, base: Expression, exponent: int) -> Polynomial:
        if exponent >= 0:
            return self.constant(base) ** exponent
        if isinstance(base, Number):
            return self.ring.number(1 / base.value) ** -exponent
        return self.ring.generator(f"1/{canonical(base)!r}") ** -exponent

    def _call(self, function: str, argument: Expression) -> Polynomial:
        if function == "sqrt":
            return self._root(argument)
        cosine, sine = self.cosine_sine(argument)
        if function == "tan":
            return sine * self.ring.generator(f"1/{canonical(Call('cos', (argument,)))!r}")
        return cosine if function == "cos" else sine

    def _root(self, argument: Expression) -> Polynomial:
        if not isinstance(argument, Number):
            return self.ring.generator(f"sqrt {canonical(argument)!r}")
        if argument.value < 0:
            raise ExpressionError("square root of a negative number", allowed="real values")
        if argument.value == 0:
            return self.ring.zero
        factor, primes = square_free(argument.value)
        result = self.ring.number(factor)
        for p in primes:
            result = result * self.ring.generator(f"sqrt {p}")
        return result

    # -- angles

    def cosine_sine(self, angle: Expression) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of an angle made of constants and joint variables."""
        exact = bundled(decompose(canonical(angle)), self._angles)
        pair = self._pi_multiple(exact.pi_multiple)
        for unit, k in exact.terms:
            pair = _add_angles(pair, self._unit_multiple(unit, k))
        return pair

    def _pi_multiple(self, multiple: Fraction) -> tuple[Polynomial, Polynomial]:
        quarter, rest = split_pi(multiple)
        cosine, sine = self._first_octant(abs(rest))
        if rest < 0:
            sine = -sine
        for _ in range(quarter):
            cosine, sine = -sine, cosine
        return cosine, sine

    def _first_octant(self, rest: Fraction) -> tuple[Polynomial, Polynomial]:
        ring = self.ring
        if rest == 0:
            return ring.one, ring.zero
        if rest not in SPECIAL:
            key = repr(scaled(Pi(), rest))
            return ring.generator(f"cos {key}"), ring.generator(f"sin {key}")
        half = Fraction(1, 2)
        first = half * ring.generator(f"sqrt {SPECIAL[rest][0]}")
        if rest == Fraction(1, 4):
            return first, first
        if rest == Fraction(1, 6):
            return first, ring.number(half)
        second = half * ring.generator("sqrt 3")
        return first * (second + half), first * (second - half)

    def _unit_multiple(self, unit: Expression, k: Fraction) -> tuple[Polynomial, Polynomial]:
        sign = 1 if k > 0 else -1
        if unit == Number(Fraction(1)):
            unit, k = Number(abs(k)), Fraction(sign)
        one, part = self._unit(unit, abs(k))
        count = abs(k) / part
        if count.denominator != 1 or count > MAX_MULTIPLE:
            raise ExpressionError(
                f"the multiple {k} of one angle", allowed=f"whole multiples up to {MAX_MULTIPLE} of a common part"
            )
        pair = (self.ring.one, self.ring.zero)
        for _ in range(int(count)):
            pair = _add_angles(pair, one)
        return pair if sign > 0 else (pair[0], -pair[1])

    def _unit(self, unit: Expression, multiple: Fraction) -> tuple[tuple[Polynomial, Polynomial], Fraction]:
        """Cosine and sine of the generator angle for a multiple of ``unit``, and the part of the unit that it is."""
        if isinstance(unit, Name) and self._is_angle(unit.name):
            return self.cosine_sine_of(self._joint[unit.name]), Fraction(1)
        part = Fraction(1, self.atoms.units[unit]) if self.atoms.is_common(unit) else multiple
        key = repr(scaled(unit, part))
        return (self.ring.generator(f"cos {key}"), self.ring.generator(f"sin {key}")), part

    def _is_angle(self, name: str) -> bool:
        return name in self._joint and self.robot.joints[self._joint[name]].is_revolute

    # -- calculus

    @cached_property
    def _indices(self) -> dict[tuple[Kind, int], int]:
        return {(g.kind, g.joint): i for i, g in enumerate(self.generators) if g.joint >= 0}

    def derivative(self, p: Polynomial, joint: int) -> Polynomial:
        """The partial derivative with respect to the variable of joint ``joint``."""
        indices = self._indices
        if not self.robot.joints[joint].is_revolute:
            return p.partial(indices[Kind.VARIABLE, joint])
        total = self.ring.zero
        for i, members in enumerate(self.angles):
            if joint in members:
                cosine, sine = self._generators_of(i)
                by_angle = p.partial(indices[Kind.SINE, i]) * cosine - p.partial(indices[Kind.COSINE, i]) * sine
                total = total + self._direction_in(members, joint) * by_angle
        return total

    def _direction_in(self, members: tuple[int, ...], joint: int) -> int:
        """The factor of a joint's angle in the sum that a generator stands for."""
        return self.directions[members[0]] * self.directions[joint]


def _basis_angles(
    groups: tuple[tuple[int, ...], ...], sums: Callable[[tuple[int, ...]], bool], n: int
) -> Iterator[tuple[int, ...]]:
    home = {joint: group for group in groups for joint in group}
    for i in range(n):
        group = home.get(i, ())
        if group and sums(group):
            yield group[: group.index(i) + 1]
        else:
            yield (i,) if group else ()


def _add_angles(a: tuple[Polynomial, Polynomial], b: tuple[Polynomial, Polynomial]) -> tuple[Polynomial, Polynomial]:
    return a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]


_CALLS = {
    Kind.SINE: "sin",
    Kind.COSINE: "cos",
    Kind.CONSTANT_SINE: "sin",
    Kind.CONSTANT_COSINE: "cos",
    Kind.ROOT: "sqrt",
    Kind.PRIME_ROOT: "sqrt",
}


def polynomial_expression(p: Polynomial, domain: PolynomialDomain) -> Expression:
    """The polynomial, term by term.

    Args:
        p: An element of the ring of ``domain``.
        domain: Says what the generators stand for.
    """
    return add(*(_term(exponents, Number(coefficient), domain) for exponents, coefficient in p.terms()))


def _term(exponents: tuple[int, ...], coefficient: Expression, domain: PolynomialDomain) -> Expression:
    factors = (power(_base(g), e) for g, e in zip(domain.generators, exponents, strict=True) if e)
    return multiply(coefficient, *factors)


def _base(generator: Generator) -> Expression:
    if generator.kind is Kind.INVERSE:
        return power(generator.argument, -1)
    call = _CALLS.get(generator.kind)
    return generator.argument if call is None else Call(call, (generator.argument,))
