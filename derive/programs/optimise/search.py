"""Local search for cheaper networks: variables written out where they are used, and sharing looked for again.

What was shared first may stand in the way of more. So a variable is put back into the definitions that use it (all of
them, or one), which are then searched for shared parts anew; the change is taken back if it costs operations. Changes
that cost nothing stay: they lead to others. The order of the trials is random with a fixed seed.

Sums are also rewritten by s^2 + c^2 = 1, the squares of a sine and a cosine of one angle, with either square written
out (`Circle`).

A coefficient with which values are multiplied wherever they stand moves into their definitions, where it meets other
coefficients and costs nothing.

Values whose definition costs more than one operation are also written in terms of two others that exist
(`Resubstitution`). Whether values agree is known from their residues, so identities count that no rewriting shows: the
trace of an inertia tensor is the same in every frame. v = x - y may be exact algebra and still ruin v, if x and y hold
something that cancels: a mass that has nothing to do with v, or a length a thousand times larger. So a difference is
allowed only between values that depend on nothing but what v depends on and that are not much larger than v at some
random points (`Scale`).
"""

import math
import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import reduce
from itertools import pairwise
from operator import or_
from random import Random

from derive.programs.optimise.coefficients import PRIME
from derive.programs.optimise.network import Monomial, Network, Opaque, Operand, Polynomial, polynomial_cost
from derive.programs.optimise.search_policy import POLICY
from derive.programs.optimise.sharing import Extractor
from derive.programs.tape.graph import ONE, UNITS, Ref, is_negative, negated, node_of, ref_to, signed
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
_OTHER = {Op.SINE: Op.COSINE, Op.COSINE: Op.SINE}
Trial = tuple[int, int | None]  # a variable, and the one place where it is written out, or None for all


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
                operands = [self._term(_monomial(o), o.coefficient) for o in definition.operands]
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
        parts = [self._coefficient(coefficient), *(self._variables[v] for v in monomial)]
        return _combined(parts, lambda *values: math.prod(values))

    def _input(self, key: object) -> Size:
        bit = self._bits.setdefault(key, len(self._bits))
        return 1 << bit, tuple(self._random.uniform(0.5, 2.0) for _ in range(_POINTS))

    def _coefficient(self, ref: Ref) -> Size:
        node = node_of(ref)
        if (found := self._coefficients.get(node)) is None:
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


class Circle:
    """Sines and cosines of the same angles in a network."""

    def __init__(self, network: Network) -> None:
        self._network = network
        functions = {
            (d.operands[0].variable, d.op): v
            for v, d in network.definition.items()
            if isinstance(d, Opaque) and d.op in _OTHER
        }
        others = ((v, (angle, _OTHER[op])) for (angle, op), v in functions.items())
        self.partner = {v: functions[other] for v, other in others if other in functions}

    def without(self, polynomial: Polynomial, variable: int) -> Polynomial:
        """A polynomial with every square of a sine or cosine replaced by one less the other square."""
        network, other = self._network, self.partner[variable]
        result: Polynomial = {}
        stack = list(reversed(polynomial.items()))
        # s s m is m - c c m; what comes out may hold further squares.
        while stack:
            monomial, coefficient = stack.pop()
            if monomial.count(variable) < 2:
                network.plus(result, monomial, coefficient)
                continue
            place = monomial.index(variable)
            rest = monomial[:place] + monomial[place + 2 :]
            stack += [(rest, coefficient), (tuple(sorted((*rest, other, other))), negated(coefficient))]
        return result

    def squares(self, polynomial: Polynomial) -> list[int]:
        """Which squares of sines and cosines a polynomial holds."""
        found: dict[int, None] = {}
        for monomial in polynomial:
            # Monomials ascend, so equal factors are neighbours.
            for first, second in pairwise(monomial):
                if first == second and self.partner.get(first) in self._network.definition:
                    found[first] = None
        return list(found)

    def shortest(self, polynomial: Polynomial) -> Polynomial:
        """A polynomial with one kind of squares written out, if that is cheaper."""
        rewritten = [self.without(polynomial, variable) for variable in self.squares(polynomial)]
        return min([polynomial, *rewritten], key=polynomial_cost) if rewritten else polynomial


class Search:
    """A network that is being improved."""

    def __init__(self, network: Network, seed: int = 0) -> None:
        self._network = network
        self._extractor = Extractor(network)
        self._random = random.Random(seed)
        self._circle = Circle(network)
        self._limit = 0
        self._rewritten_at = network.cost + 1

    def run(self, work: int) -> None:
        """Share what can be shared at once, then try changes."""
        network = self._network
        self._extractor.run()
        self._limit = network.work + work
        # Squares only when something has changed since they were last tried.
        for _ in range(POLICY.search_rounds):
            cost = network.cost
            # Sums to be multiplied out: the trials that succeed most often, and the cheapest.
            self._try_all([(v, None) for v, p in network.polynomials() if len(p) > 1 and len(network.users[v]) == 1])
            if cost < self._rewritten_at:
                self._rewrite_squares()
                self._rewritten_at = network.cost
            # Then sums in sums, and products that serve two.
            trials: list[Trial] = []
            for variable, polynomial in network.polynomials():
                users = network.users[variable]
                # A sum pays where it stands alone in a sum, whose terms it may meet; a product, where few repeat it.
                if len(polynomial) > 1:
                    pays = len(users) > 1 and any((variable,) in (network.polynomial(user) or ()) for user in users)
                else:
                    pays = len(users) == 2
                trials += [(variable, None), *((variable, user) for user in users)] if pays else []
            self._try_all(trials)
            if network.cost == cost or network.work > self._limit:
                return

    def resubstitute(self, work: int) -> None:
        """Try other definitions of variables in terms of two others; what saves nothing is taken back."""
        network = self._network
        self._limit = network.work + work
        others = Resubstitution(network)
        for variable in others.candidates():
            if network.work > self._limit:
                return
            # The first definition that saves is taken: it changes what the others would save.
            for definition in list(others.alternatives(variable)) if variable in network.definition else ():
                if others.fits(variable, definition):
                    cost, mark = network.cost, network.mark()
                    network.define(variable, definition)
                    self._settle(cost - 1, mark)
                    if network.cost < cost:
                        break

    def move_coefficients(self) -> None:
        """Take multiples of values where these stand nowhere without one coefficient, if that saves operations."""
        network = self._network
        holders: dict[Ref, dict[int, int]] = {}  # how often a coefficient stands in each definition
        for variable, polynomial in network.polynomials():
            for monomial, coefficient in polynomial.items():
                if monomial and coefficient not in UNITS:
                    places = holders.setdefault(signed(coefficient, is_negative(coefficient)), {})
                    places[variable] = places.get(variable, 0) + 1
        for coefficient, counts in holders.items():
            if sum(counts.values()) == 1:
                continue
            cost, mark = network.cost, network.mark()
            factors, stack = dict[int, None](), list(counts)
            # k (a + b) is written out: it may be that k stands with a and with b everywhere.
            while stack:
                place = stack.pop()
                terms = (network.polynomial(place) or {}).items()
                here = [v for monomial, k in terms if signed(k, is_negative(k)) == coefficient for v in monomial]
                sums = (v for v in here if len(network.polynomial(v) or ()) > 1 and network.users[v] == {place: 1})
                if (inner := next(sums, None)) is not None and self._write_out(inner, place):
                    stack.append(place)
                factors |= dict.fromkeys(here)
            network.settle()
            if any([self._scale(variable, coefficient) for variable in factors]):
                self._settle(cost - 1, mark)
            else:
                self._undo(mark)

    def _scale(self, variable: int, coefficient: Ref) -> bool:
        """Take a multiple in the place of a variable that stands nowhere without the coefficient, if that saves."""
        network = self._network
        definition = network.polynomial(variable)
        users = {user: network.polynomial(user) for user in network.users.get(variable, ())}
        if definition is None or None in users.values():
            return False
        scaled = {m: network.coefficients.multiply(k, coefficient) for m, k in definition.items()}
        saved = polynomial_cost(definition) - polynomial_cost(scaled)
        for polynomial in users.values():
            found = [(m, k) for m, k in (polynomial or {}).items() if variable in m]
            saved += len(found)
            if any(m.count(variable) > 1 or signed(k, is_negative(k)) != coefficient for m, k in found):
                return False
        if saved <= 0 or network.find(network.evaluate(scaled)):
            return False
        multiple = network.create(scaled)
        for user, polynomial in users.items():
            new: Polynomial = {}
            for m, k in (polynomial or {}).items():
                if variable in m:
                    new[tuple(sorted((*[v for v in m if v != variable], multiple)))] = signed(ONE, is_negative(k))
                else:
                    new[m] = k
            network.define(user, new)
        return True

    def _settle(self, limit: int, mark: int) -> None:
        """Share anew after a change; take it back if the cost exceeds a limit."""
        self._network.settle()
        self._extractor.run()
        if self._network.cost > limit:
            self._undo(mark)

    def _undo(self, mark: int) -> None:
        self._network.undo(mark)
        self._extractor.drain()

    def _rewrite_squares(self) -> None:
        """Squares of sines in terms of cosines or the other way round, in all definitions at once."""
        network, circle = self._network, self._circle
        for variable in circle.partner:
            if network.work > self._limit:
                return
            cost, mark, own = network.cost, network.mark(), network.users.get(variable, {})
            # Squares may be hidden in products, and in sums that are used once: those are written out first; `own`, the
            # row of users itself, follows.
            users = [(v, p) for v, p in network.polynomials() if v in own]
            hidden = [v for v, _ in users if len(network.users[v]) == 1] + [v for v, p in users if len(p) == 1]
            for inner in dict.fromkeys(hidden):  # products and single-use sums in which a square may hide
                self._write_out(inner, None)
            holders = [(v, p) for v, p in network.polynomials() if v in own and variable in circle.squares(p)]
            for holder, polynomial in holders:
                network.define(holder, circle.without(polynomial, variable))
            # All together must save: half of an identity only makes sums longer.
            if holders:
                self._settle(cost - 1, mark)
            else:
                self._undo(mark)

    def _try_all(self, trials: list[Trial]) -> None:
        """Write variables out in one definition or in all, each by itself, and share anew."""
        network = self._network
        self._random.shuffle(trials)
        for variable, user in trials:
            if network.work > self._limit:
                return
            cost, mark = network.cost, network.mark()
            if self._write_out(variable, user):
                self._settle(cost, mark)
            else:
                network.undo(mark)

    def _write_out(self, variable: int, user: int | None) -> bool:
        """Write a variable out; False where it stands nowhere, or where a sum would get too long."""
        network = self._network
        if (inner := network.polynomial(variable)) is None:
            return False
        changed = False
        # A sum that would get too long makes the whole trial void; the caller undoes it.
        for place in [u for u in network.users[variable] if user in (None, u)]:
            if (outer := network.polynomial(place)) is None:
                continue
            longer = self._circle.shortest(network.expanded(outer, variable, inner))
            if len(longer) > POLICY.longest_expansion:
                return False
            network.define(place, longer)
            changed = True
        return changed
