"""Closed forms as a further formulation of generated functions: exact polynomials, expanded and then factored.

For small arms, or where most inertial parameters vanish, the expanded polynomial costs less than a recursion once
common parts are found. For others it grows out of bounds, so only short ones are offered.
"""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Generator, Kind
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.errors import ExpressionError
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.coriolis import coriolis_matrix
from derive.mechanics.energy import kinetic_energy, potential_energy
from derive.mechanics.inertia_matrix import gravity_vector, inertia_matrix
from derive.mechanics.newton_euler import inverse_dynamics
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.scalars import QD, QDD, Q, TapeDomain
from derive.programs.tape.value import Value
from derive.robot.options.style import Contraction
from derive.robot.robot import Robot

_ARGUMENTS = {Kind.VARIABLE: Q, Kind.RATE: QD, Kind.ACCELERATION: QDD}
_LATE = (Kind.SINE, Kind.COSINE, *_ARGUMENTS)  # what depends on the arguments

Monomial = tuple[tuple[int, int], ...]  # generator indices with their exponents, ascending


class ClosedForm:
    """The dynamics of one robot as polynomials in one choice of angles, which ``words`` tell."""

    def __init__(self, robot: Robot, tape: TapeDomain, *, sums: bool) -> None:
        self.words = "closed form in sums of angles" if sums else "closed form"
        self._robot = robot
        self._tape = tape
        self._sums = sums

    @cached_property
    def _domain(self) -> PolynomialDomain:
        terms = POLICY.closed_form_terms
        sums = self._sums
        return PolynomialDomain(self._robot, sums=lambda group: sums, contraction=Contraction.OPPOSED, max_terms=terms)

    @cached_property
    def _chain(self) -> Chain[Polynomial]:
        return build_chain(self._robot, self._domain)

    def values(self, function: str) -> list[Value] | None:
        """The outputs of a function, row by row, torques without friction; None where they are long."""
        try:
            rates = [self._domain.rate(i) for i in range(self._robot.n)]
            found = CLOSED_FORMS[function](self._domain, self._chain, rates)
        except (TooManyTerms, ExpressionError):
            return None
        if sum(len(entry) for entry in found) > POLICY.closed_form_terms:
            return None
        return [self._value(entry) for entry in found]

    @cached_property
    def _values(self) -> list[Value]:
        return [self._generator(generator) for generator in self._domain.generators]

    def _value(self, p: Polynomial) -> Value:
        """A polynomial, expanded: a sum of products of sines, cosines, variables and rates.

        What stands beside such a product, parameters and numbers, is gathered first, so that it is hoisted.
        """
        zero, one = self._tape.number(0), self._tape.number(1)
        groups: dict[Monomial, Value] = {}
        for exponents, coefficient in p.terms():
            used = tuple((i, e) for i, e in enumerate(exponents) if e)
            late = tuple((i, e) for i, e in used if self._domain.generators[i].kind in _LATE)
            early = self._product(tuple(pair for pair in used if pair not in late), self._tape.number(coefficient))
            groups[late] = groups.get(late, zero) + early
        return sum((factor * self._product(late, one) for late, factor in groups.items()), zero)

    def _product(self, monomial: Monomial, start: Value) -> Value:
        for i, exponent in monomial:
            start = start * self._values[i] ** exponent
        return start

    def _generator(self, generator: Generator) -> Value:
        tape, kind = self._tape, generator.kind
        match kind:
            case Kind.SINE:
                return self._angle(generator.joint).sin()
            case Kind.COSINE:
                return self._angle(generator.joint).cos()
            case Kind.VARIABLE | Kind.RATE | Kind.ACCELERATION:
                return tape.argument(_ARGUMENTS[kind], generator.joint)
            case Kind.CONSTANT_COSINE:
                return tape.cosine_sine(generator.argument)[0]
            case Kind.CONSTANT_SINE:
                return tape.cosine_sine(generator.argument)[1]
            case Kind.ROOT | Kind.PRIME_ROOT:
                return tape.constant(generator.argument).sqrt()
            case Kind.INVERSE:
                return 1 / tape.constant(generator.argument)
            case Kind.PARAMETER | Kind.PI:
                return tape.constant(generator.argument)

    def _angle(self, joint: int) -> Value:
        """The sum of joint variables of which a generator is the sine or cosine."""
        members, directions = self._domain.angles[joint], self._domain.directions
        turns = (directions[members[0]] * directions[m] * self._tape.argument(Q, m) for m in members)
        return sum(turns, self._tape.number(0))


Polynomials = Sequence[Polynomial]

# The functions that have one, from the chain and the joints' rates; a half and accelerations come from the domain.
CLOSED_FORMS: Mapping[str, Callable[[PolynomialDomain, Chain[Polynomial], Polynomials], Polynomials]] = {
    "inertia_matrix": lambda domain, chain, qd: [b for row in inertia_matrix(chain) for b in row],
    "coriolis_matrix": lambda domain, chain, qd: [c for row in coriolis_matrix(chain, qd, _half(domain)) for c in row],
    "gravity_vector": lambda domain, chain, qd: gravity_vector(chain),
    "kinetic_energy": lambda domain, chain, qd: [kinetic_energy(chain, qd, _half(domain))],
    "potential_energy": lambda domain, chain, qd: [potential_energy(chain)],
    "inverse_dynamics": lambda domain, chain, qd: inverse_dynamics(
        chain, qd, [domain.acceleration(i) for i in range(chain.n)]
    ),
}


def _half(domain: PolynomialDomain) -> Polynomial:
    return domain.number(Fraction(1, 2))
