"""Values written in terms of two others that exist, where their definition costs more than one operation.

Whether values agree is known from their residues, so identities count that no rewriting shows: the trace of an inertia
tensor is the same in every frame, the square of a cosine is one less the square of the sine.

v = x - y may be exact algebra and still ruin v, if x and y hold something that cancels: a mass that has nothing to do
with v, or a length a thousand times larger. So a difference is allowed only between values that depend on nothing but
what v depends on and that are not much larger than v at some random points.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import reduce
from operator import or_
from random import Random

from derive.programs.optimise.coefficients import PRIME
from derive.programs.optimise.network import Monomial, Network, Opaque, Operand, Polynomial
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.cost import polynomial_cost
from derive.programs.tape.graph import ONE, Ref, is_negative, node_of, ref_to, signed
from derive.programs.tape.tape import ARITHMETIC, Op

_POINTS = 3

_FLOATS: dict[Op, Callable[..., float]] = {
    **ARITHMETIC,
    Op.DIVIDE: lambda a, b: a / b if b else math.nan,
    Op.SINE: math.sin,
    Op.COSINE: math.cos,
    Op.ROOT: lambda a: math.sqrt(abs(a)),
    Op.SIGN: lambda a: math.copysign(1.0, a),
    Op.ARCTANGENT: math.atan2,
    Op.LESS: lambda a, b: float(a < b),
    Op.SELECT: lambda case, a, b: max(a, b, key=abs),
    Op.MAXIMUM: max,
    Op.MINIMUM: min,
    Op.ABSOLUTE: abs,
}

# On what a value depends, a bit for each input and parameter, and how large it is at some points.
Size = tuple[int, tuple[float, ...]]


class Scale:
    """On what the variables of a network as it stands depend, and how large they are."""

    def __init__(self, network: Network) -> None:
        self._graph = network.coefficients.graph
        self._bits: dict[object, int] = {}
        self._random = Random(0)
        self._coefficients: dict[int, Size] = {}
        self._variables: dict[int, Size] = {}
        for variable in network.order():
            # Bottom up: sizes at random points, and inputs as bits, of each variable from those of what it uses.
            definition = network.definition[variable]
            if not isinstance(definition, Opaque):
                terms = [self._term(monomial, coefficient) for monomial, coefficient in definition.items()]
                self._variables[variable] = _combined(terms, lambda *values: sum(values))
            elif definition.op is None:
                self._variables[variable] = self._input(("argument", definition.source))
            else:
                operands = [
                    self._term(() if o.variable is None else (o.variable,), o.coefficient) for o in definition.operands
                ]
                self._variables[variable] = _combined(operands, _FLOATS[definition.op])

    def allows(self, variable: int, definition: Polynomial) -> bool:
        """Whether a sum may define a variable without harm to its accuracy."""
        if any(v not in self._variables for monomial in definition for v in monomial):
            return False
        support, sizes = self._variables[variable]
        for monomial, coefficient in definition.items():
            part, values = self._term(monomial, coefficient)
            # A term that holds an input on which the variable does not depend would have to cancel.
            if part & ~support:
                return False
            # Nor may a term be much larger than the result: the difference would lose digits.
            pairs = zip(values, sizes, strict=True)
            if not all(abs(value) <= POLICY.cancellation * abs(size) for value, size in pairs):
                return False
        return True

    def _term(self, monomial: Monomial, coefficient: Ref) -> Size:
        return _combined(
            [self._coefficient(coefficient), *(self._variables[v] for v in monomial)], lambda *values: math.prod(values)
        )

    def _input(self, key: object) -> Size:
        bit = self._bits.setdefault(key, len(self._bits))
        return 1 << bit, tuple(self._random.uniform(0.5, 2.0) for _ in range(_POINTS))

    def _coefficient(self, ref: Ref) -> Size:
        node = node_of(ref)
        found = self._coefficients.get(node)
        if found is None:
            source, value = self._graph.sources.get(node), self._graph.constants.get(node)
            if source is not None:
                found = self._input((source.kind, source.index))
            elif value is not None:
                with suppress(OverflowError):  # of a number that is too large for a float nothing is known
                    found = 0, (float(value),) * _POINTS
                found = found or (0, (math.nan,) * _POINTS)
            else:
                operands = [self._coefficient(ref_to(k)) for k in self._graph.operands[node]]
                found = _combined(operands, _FLOATS[self._graph.op[node]])
            self._coefficients[node] = found
        return (found[0], tuple(-value for value in found[1])) if is_negative(ref) else found


def _combined(parts: Sequence[Size], operation: Callable[..., float]) -> Size:
    support = reduce(or_, [part for part, _ in parts], 0)
    return support, tuple(operation(*values) for values in zip(*(values for _, values in parts), strict=True))


class Resubstitution:
    """Shorter definitions of the variables of a network as it stands."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._scale = Scale(network)
        self._values = [(v, network.residue[v]) for v in network.definition if v >= 0 and network.residue[v]]
        self._known = {r for residue in network.coefficients.residues() for r in (residue, PRIME - residue)}
        self._known.update(r for _, residue in self._values for r in (residue, PRIME - residue))
        self._inverses = [(v, pow(residue, -1, PRIME)) for v, residue in self._values]

    def candidates(self) -> list[int]:
        """Variables whose definition, with what it alone uses, costs more than one operation."""
        network = self._network
        return [
            variable
            for variable, polynomial in network.polynomials()
            if polynomial_cost(polynomial) > 1
            or any(len(network.users[v]) == 1 and network.polynomial(v) for monomial in polynomial for v in monomial)
        ]

    def alternatives(self, variable: int) -> Iterator[Polynomial]:
        """Other definitions of a variable, each of one operation: sums, differences and products of two values."""
        network, known = self._network, self._known
        # v = x + y, -x + y or x y: for every x, is the missing y known by its residue? a over b is a b^-1.
        value = network.residue[variable]
        network.work += len(self._values) // 16
        plus = [v for v, residue in self._values if (value - residue) % PRIME in known]
        minus = [v for v, residue in self._values if (value + residue) % PRIME in known]
        times = [v for v, inverse in self._inverses if value * inverse % PRIME in known]
        # Sums: neither part may be the variable itself, nor both parts the same variable.
        for other, negative in [*((v, False) for v in plus), *((v, True) for v in minus)]:
            residue = network.residue[other]
            rest = network.find((value + residue if negative else value - residue) % PRIME)
            if rest is not None and other != variable != rest.variable != other:
                yield {(other,): signed(ONE, negative), _monomial(rest): rest.coefficient}
        # Products; the remaining factor may be a coefficient.
        for other in times:
            rest = network.find(value * pow(network.residue[other], -1, PRIME) % PRIME)
            if rest is not None and other != variable != rest.variable:
                yield {tuple(sorted((other, *_monomial(rest)))): rest.coefficient}

    def fits(self, variable: int, definition: Polynomial) -> bool:
        """Whether a definition may take the place of that of a variable."""
        network = self._network
        if network.polynomial(variable) == definition:
            return False
        # A variable that is computed from this one may not define it.
        parts = [v for monomial in definition for v in monomial]
        if not all(v in network.definition and not network.needs(v, variable) for v in parts):
            return False
        return self._scale.allows(variable, definition)


def _monomial(operand: Operand) -> Monomial:
    return () if operand.variable is None else (operand.variable,)
