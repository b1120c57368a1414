"""Sharing made explicit: the divisor that saves most becomes a variable, until none saves anything."""

from __future__ import annotations

from heapq import heappop, heappush

from derive.algebra.tape_divisors import Key, Place, factor_pairs, term_cost, term_pairs
from derive.algebra.tape_graph import ONE, Ref
from derive.algebra.tape_network import Definition, Monomial, Network, Polynomial

_LONG = 40
"""Terms from which sums are not searched for pairs of terms: there are too many."""


class Extractor:
    """A network together with all divisors of its polynomials.

    Args:
        network: The network; all its changes must go through it from now on.
        turn: Which of equally good divisors comes first: the oldest (0) or another fixed order.
    """

    def __init__(self, network: Network, turn: int = 0) -> None:
        self.network = network
        self.turn = turn
        self.places: dict[Key, dict[int, list[Place]]] = {}
        self.savings: dict[Key, int] = {}
        self._pairs: dict[int, list[tuple[Key, Place]]] = {}
        self._known: dict[int, tuple[Polynomial, list[tuple[Key, Place]]]] = {}
        self._term_memory: dict[tuple[tuple[Monomial, Ref], tuple[Monomial, Ref]], list[tuple[Key, Place]]] = {}
        self._heap: list[tuple[int, int, Key]] = []
        self._count = 0
        self.banned: Key | None = None
        for variable, polynomial in network.polynomials():
            self.learn(variable, polynomial)
        network.watcher = self

    def learn(self, variable: int, definition: Definition) -> None:
        """Take up the divisors of a new definition."""
        if not isinstance(definition, dict):
            return
        pairs = self._pairs[variable] = self._divisors(definition)
        self.network.work += 1 + len(pairs)
        keys, savings = self.places, self.savings
        for key, place in pairs:
            row = keys.get(key)
            if row is None:
                keys[key] = {variable: [place]}
                savings[key] = place.saving - self._price(key)
                continue
            spots = row.get(variable)
            if spots is None:
                row[variable] = [place]
            else:
                spots.append(place)
            savings[key] += place.saving
        for key, _ in pairs:
            if savings[key] > 0:
                self._offer(key)

    def forget(self, variable: int, definition: Definition) -> None:
        """Drop the divisors of a definition."""
        if not isinstance(definition, dict):
            return
        for key, place in self._pairs.pop(variable):
            row = self.places[key]
            spots = row[variable]
            if len(spots) > 1:
                spots.pop()
            elif len(row) > 1:
                del row[variable]
            else:
                del self.places[key], self.savings[key]
                continue
            self.savings[key] -= place.saving

    def _divisors(self, polynomial: Polynomial) -> list[tuple[Key, Place]]:
        """Kept, for definitions come and go; and the polynomial with them, lest its address be given to another."""
        known = self._known.get(id(polynomial))
        if known is None:
            found: list[tuple[Key, Place]] = []
            for monomial, coefficient in polynomial.items():
                found += factor_pairs(monomial, coefficient)
            if 1 < len(polynomial) <= _LONG:
                found += self._term_pairs(polynomial)
            known = self._known[id(polynomial)] = (polynomial, found)
        return known[1]

    def _term_pairs(self, polynomial: Polynomial) -> list[tuple[Key, Place]]:
        found: list[tuple[Key, Place]] = []
        terms = sorted(polynomial.items())
        memory = self._term_memory
        for i, one in enumerate(terms):
            for other in terms[i + 1 :]:
                pair = memory.get((one, other))
                if pair is None:
                    pair = memory[one, other] = term_pairs(*one, *other, self.network.coefficients)
                found += pair
        return found

    def _offer(self, key: Key) -> None:
        self._count += 1
        order = self._count if not self.turn else (self._count * 2654435761 * self.turn) % 4294967291
        heappush(self._heap, (-self.savings[key], order, key))

    def _price(self, key: Key) -> int:
        """What a divisor costs if it is made."""
        if len(key) == 2:
            return 1
        a, j, b, k = key
        return term_cost(a, j) + term_cost(b, k) + 1

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
            if key not in self.places or key == self.banned:
                continue
            chosen = self._disjoint(key)
            gain = sum(p.saving for row in chosen.values() for p in row) - self._price(key)
            if gain <= 0:
                continue
            if gain < -claimed:
                heappush(self._heap, (-gain, order, key))
                continue
            self._extract(key, chosen)

    def drain(self) -> None:
        """Forget what was on offer: nothing saves."""
        self._heap.clear()

    def _disjoint(self, key: Key) -> dict[int, list[Place]]:
        """Places of a divisor that do not share a term."""
        chosen: dict[int, list[Place]] = {}
        for variable, places in self.places[key].items():
            used: set[Monomial] = set()
            for place in places:
                if used.isdisjoint(place.terms):
                    used.update(place.terms)
                    chosen.setdefault(variable, []).append(place)
        return chosen

    def _extract(self, key: Key, chosen: dict[int, list[Place]]) -> None:
        network, divisor = self.network, self.divisor(key)
        home = next((v for v in chosen if network.polynomial(v) == divisor), None)
        if home is None:
            home = network.create(divisor)
        for variable, places in chosen.items():
            if variable != home:
                self._replace(variable, places, home)
        network.settle()

    def _replace(self, variable: int, places: list[Place], home: int) -> None:
        network = self.network
        old = network.polynomial(variable)
        assert old is not None
        gone = {monomial for place in places for monomial in place.terms}
        new = {m: k for m, k in old.items() if m not in gone}
        for place in places:
            network.plus(new, tuple(sorted((*place.quotient, home))), place.coefficient)
        network.define(variable, new)
