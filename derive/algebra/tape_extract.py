"""Sharing made explicit: the divisor that saves most becomes a variable, until none saves anything."""

from __future__ import annotations

from heapq import heappop, heappush

from derive.algebra.tape_divisors import Found, Key, Place, factor_pairs, price, term_pairs
from derive.algebra.tape_graph import ONE, Ref
from derive.algebra.tape_network import Definition, Monomial, Network, Operand, Polynomial

_LONG = 40
"""Terms from which sums are not searched for pairs of terms: there are too many."""


class Extractor:
    """A network together with all divisors of its polynomials.

    Args:
        network: The network; all its changes must go through it from now on.
    """

    def __init__(self, network: Network) -> None:
        self.network = network
        self._places: dict[Key, dict[int, list[Place]]] = {}
        self._gains: dict[Key, int] = {}
        self._pairs: dict[int, Found] = {}
        self._known: dict[int, tuple[Polynomial, Found]] = {}
        self._memory: dict[tuple[tuple[Monomial, Ref], tuple[Monomial, Ref]], Found] = {}
        self._heap: list[tuple[int, int, Key]] = []
        self._count = 0
        for variable, polynomial in network.polynomials():
            self.learn(variable, polynomial)
        network.watcher = self

    def learn(self, variable: int, definition: Definition) -> None:
        """Take up the divisors of a new definition."""
        if not isinstance(definition, dict):
            return
        found = self._pairs[variable] = self._divisors(definition)
        self.network.work += 1 + len(found)
        places, gains = self._places, self._gains
        for key, place in found:
            row = places.get(key)
            if row is None:
                places[key] = {variable: [place]}
                gains[key] = place[3] - price(key)
                continue
            gains[key] += place[3]
            spots = row.get(variable)
            if spots is None:
                row[variable] = [place]
            else:
                spots.append(place)
        for key, _ in found:
            if gains[key] > 0:
                self._count += 1
                heappush(self._heap, (-gains[key], self._count, key))

    def forget(self, variable: int, definition: Definition) -> None:
        """Drop the divisors of a definition."""
        if not isinstance(definition, dict):
            return
        places, gains = self._places, self._gains
        for key, place in self._pairs.pop(variable):
            row = places[key]
            spots = row[variable]
            if len(spots) > 1:
                spots.pop()
            elif len(row) > 1:
                del row[variable]
            else:
                del places[key], gains[key]
                continue
            gains[key] -= place[3]

    def _divisors(self, polynomial: Polynomial) -> Found:
        """Kept, for definitions come and go; and the polynomial with them, lest its address be given to another."""
        known = self._known.get(id(polynomial))
        if known is None:
            found: Found = []
            for monomial, coefficient in polynomial.items():
                if len(monomial) > 1 or coefficient >> 1 != 1:
                    found += factor_pairs(monomial, coefficient)
            if 1 < len(polynomial) <= _LONG:
                self._add_term_pairs(polynomial, found)
            known = self._known[id(polynomial)] = (polynomial, found)
        return known[1]

    def _add_term_pairs(self, polynomial: Polynomial, found: Found) -> None:
        terms = sorted(polynomial.items())
        memory = self._memory
        for i, one in enumerate(terms):
            for other in terms[i + 1 :]:
                pair = memory.get((one, other))
                if pair is None:
                    pair = memory[one, other] = term_pairs(*one, *other, self.network.coefficients)
                found += pair

    def divisor(self, key: Key) -> Polynomial:
        """The polynomial of a divisor."""
        if len(key) == 4:
            a, j, b, k = key
            return {a: j, b: k}
        x, y = key
        return {(y,): -2 * x} if x < 0 else {(x, y): ONE}

    def run(self) -> None:
        """Extract until nothing saves."""
        while self._heap:
            claimed, order, key = heappop(self._heap)
            if self._gains.get(key, 0) <= 0:
                continue
            chosen = self._disjoint(key)
            gain = sum(place[3] for places in chosen.values() for place in places) - price(key)
            if gain == -claimed:
                self._extract(key, chosen)
            elif gain > 0:
                heappush(self._heap, (-gain, order, key))

    def drain(self) -> None:
        """Forget what was on offer: nothing saves."""
        self._heap.clear()

    def _disjoint(self, key: Key) -> dict[int, list[Place]]:
        """Places of a divisor that do not share a term."""
        chosen: dict[int, list[Place]] = {}
        for variable, places in self._places[key].items():
            if len(places) == 1:
                chosen[variable] = places
                continue
            used: set[Monomial] = set()
            row = chosen[variable] = []
            for place in places:
                if used.isdisjoint(place[0]):
                    used.update(place[0])
                    row.append(place)
        return chosen

    def _extract(self, key: Key, chosen: dict[int, list[Place]]) -> None:
        network, divisor = self.network, self.divisor(key)
        home = network.find(network.evaluate(divisor)) or Operand(network.create(divisor), ONE)
        for variable, places in chosen.items():
            if home.variable is None or not (home.variable == variable or network.needs(home.variable, variable)):
                self._replace(variable, places, home)
        network.settle()

    def _replace(self, variable: int, places: list[Place], home: Operand) -> None:
        network = self.network
        new = dict(network.polynomial(variable) or {})
        for terms, _, _, _ in places:
            for monomial in terms:
                del new[monomial]
        factor = () if home.variable is None else (home.variable,)
        for _, quotient, coefficient, _ in places:
            product = network.coefficients.multiply(coefficient, home.coefficient)
            network.plus(new, tuple(sorted((*quotient, *factor))), product)
        network.define(variable, new)
