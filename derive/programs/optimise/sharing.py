"""What sums and products may share: pairs of factors of a term, and pairs of terms of a sum up to a common factor.

The two-term divisors of multi-level logic synthesis (Rajski and Vasudevamurthy 1992; for polynomials Hosangadi, Fallah
and Kastner 2006), with coefficients: a*x + b*x*y is x*(a + b*y), and with numbers 2*x + 6*y is 2*(x + 3*y).

Sharing made explicit: the divisor that saves most becomes a variable, until none saves anything.
"""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heappop, heappush

from derive.programs.optimise.coefficients import Coefficients
from derive.programs.optimise.network import Definition, Monomial, Network, Operand, Polynomial
from derive.programs.tape.graph import ONE, Ref

Key = tuple[int, int] | tuple[Monomial, Ref, Monomial, Ref]
"""Two factors (a negative first one is minus the index of a coefficient), or two terms."""

Place = tuple[tuple[Monomial, ...], Monomial, Ref, int]
"""Where a divisor stands in a polynomial: the monomials of the terms that hold it, what is left of them without it, the
coefficient, and the operations that are saved there, the divisor itself not counted."""

Found = list[tuple[Key, Place]]


def factor_pairs(monomial: Monomial, coefficient: Ref) -> Found:
    """Pairs of factors of a term, the coefficient among them."""
    found: Found = []
    count = len(monomial)
    here = (monomial,)
    if count and coefficient >> 1 != 1:
        key, rest = -(coefficient >> 1), ONE ^ (coefficient & 1)
        for i, x in enumerate(monomial):
            if not (i and monomial[i - 1] == x):
                found.append(((key, x), (here, monomial[:i] + monomial[i + 1 :], rest, 1)))
    if count < 2:
        return found
    seen = set()
    for i, x in enumerate(monomial):
        for j in range(i + 1, count):
            pair = (x, monomial[j])
            if pair not in seen:
                seen.add(pair)
                left = monomial[:i] + monomial[i + 1 : j] + monomial[j + 1 :]
                found.append((pair, (here, left, coefficient, 1)))
    return found


def term_pairs(a: Monomial, j: Ref, b: Monomial, k: Ref, coefficients: Coefficients) -> Found:
    """Two terms of a sum as divisors: as they are, and with the coefficient of the first taken out.

    Args:
        a: Monomial of the first term.
        j: Its coefficient.
        b: Monomial of the second term.
        k: Its coefficient.
        coefficients: Arithmetic of coefficients.
    """
    common = _common(a, b) if len(a) + len(b) > 2 and a and b else ()
    terms = (a, b)
    saving = (len(a) - 1 + (j >> 1 != 1) if a else 0) + (len(b) - 1 + (k >> 1 != 1) if b else 0) + 1
    if common:
        saving -= len(common)
        a, b = _less(a, common), _less(b, common)
    if a > b:
        a, j, b, k = b, k, a, j
    sign = j & 1
    found: Found = [((a, j ^ sign, b, k ^ sign), (terms, common, ONE ^ sign, saving))]
    if j >> 1 != 1:
        ratio = coefficients.ratio(k, j)
        if ratio is not None:
            found.append(((a, ONE, b, ratio), (terms, common, j, saving - 1)))
    return found


def price(key: Key) -> int:
    """Operations of a divisor."""
    if len(key) == 2:
        return 1
    a, j, b, k = key
    return (len(a) - 1 + (j >> 1 != 1) if a else 0) + (len(b) - 1 + (k >> 1 != 1) if b else 0) + 1


def _common(a: Monomial, b: Monomial) -> Monomial:
    """The greatest common divisor of two monomials."""
    found: list[int] = []
    i = k = 0
    while i < len(a) and k < len(b):
        if a[i] == b[k]:
            found.append(a[i])
            i, k = i + 1, k + 1
        elif a[i] < b[k]:
            i += 1
        else:
            k += 1
    return tuple(found)


def _less(monomial: Monomial, common: Monomial) -> Monomial:
    """The monomial over a divisor of it."""
    rest = list(monomial)
    for variable in common:
        rest.remove(variable)
    return tuple(rest)


_LONG = 40
"""Terms from which sums are not searched for pairs of terms: there are too many."""


Entry = tuple[int, list[Place], int]
"""The number of a divisor, its places in one polynomial, and what they save together."""


@dataclass(frozen=True, slots=True)
class _Term:
    """A term of sums, with the divisors in it and in pairs with other terms as far as they have been asked for."""

    number: int
    monomial: Monomial
    coefficient: Ref
    factors: tuple[Entry, ...]
    pairs: dict[int, tuple[Entry, ...]]


class Extractor:
    """A network together with all divisors of its polynomials.

    Args:
        network: The network; all its changes must go through it from now on.
    """

    def __init__(self, network: Network) -> None:
        self.network = network
        self._numbers: dict[Key, int] = {}
        self._keys: list[Key] = []
        self._prices: list[int] = []
        self._places: list[dict[int, list[Place]]] = []
        self._gains: list[int] = []
        self._terms: dict[tuple[Monomial, Ref], _Term] = {}
        self._entries: dict[int, list[Entry]] = {}
        self._known: dict[int, tuple[Polynomial, list[Entry], int]] = {}
        self._heap: list[tuple[int, int, int]] = []
        self._count = 0
        for variable, polynomial in network.polynomials():
            self.learn(variable, polynomial)
        network.watcher = self

    def learn(self, variable: int, definition: Definition) -> None:
        """Take up the divisors of a new definition."""
        if not isinstance(definition, dict):
            return
        known = self._known.get(id(definition))
        if known is None:
            known = self._known[id(definition)] = self._divided(definition)
        _, entries, count = known
        self._entries[variable] = entries
        self.network.work += 1 + count
        places, gains = self._places, self._gains
        for number, spots, saving in entries:
            places[number][variable] = spots
            gain = gains[number] = gains[number] + saving
            if gain > 0:
                self._count += 1
                heappush(self._heap, (-gain, self._count, number))

    def forget(self, variable: int, definition: Definition) -> None:
        """Drop the divisors of a definition."""
        if not isinstance(definition, dict):
            return
        places, gains = self._places, self._gains
        for number, _, saving in self._entries.pop(variable):
            del places[number][variable]
            gains[number] -= saving

    def _divided(self, polynomial: Polynomial) -> tuple[Polynomial, list[Entry], int]:
        """Kept, for definitions come and go; and the polynomial with them, lest its address be given to another."""
        terms = [self._terms.get(term) or self._term(term) for term in polynomial.items()]
        found = [entry for term in terms for entry in term.factors]
        if 1 < len(terms) <= _LONG:
            terms.sort(key=_in_order)
            for i, one in enumerate(terms):
                pairs = one.pairs
                for other in terms[i + 1 :]:
                    found += pairs.get(other.number) or self._pair(one, other)
        return polynomial, _grouped(found), len(found)

    def _term(self, term: tuple[Monomial, Ref]) -> _Term:
        monomial, coefficient = term
        factors = self._entered(factor_pairs(monomial, coefficient))
        made = self._terms[term] = _Term(len(self._terms), monomial, coefficient, factors, {})
        return made

    def _pair(self, one: _Term, other: _Term) -> tuple[Entry, ...]:
        coefficients = self.network.coefficients
        found = term_pairs(one.monomial, one.coefficient, other.monomial, other.coefficient, coefficients)
        entries = one.pairs[other.number] = self._entered(found)
        return entries

    def _entered(self, found: Found) -> tuple[Entry, ...]:
        return tuple((self._number(key), [place], place[3]) for key, place in found)

    def _number(self, key: Key) -> int:
        number = self._numbers.get(key)
        if number is None:
            number = self._numbers[key] = len(self._keys)
            self._keys.append(key)
            self._prices.append(price(key))
            self._places.append({})
            self._gains.append(-price(key))
        return number

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
            claimed, order, number = heappop(self._heap)
            if self._gains[number] <= 0:
                continue
            chosen = self._disjoint(number)
            gain = sum([place[3] for places in chosen.values() for place in places]) - self._prices[number]
            if gain == -claimed:
                self._extract(self._keys[number], chosen)
            elif gain > 0:
                heappush(self._heap, (-gain, order, number))

    def drain(self) -> None:
        """Forget what was on offer: nothing saves."""
        self._heap.clear()

    def _disjoint(self, number: int) -> dict[int, list[Place]]:
        """Places of a divisor that do not share a term."""
        chosen: dict[int, list[Place]] = {}
        for variable, places in self._places[number].items():
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
        home = network.find(network.evaluate(divisor))
        fresh = home is None
        home = home or Operand(network.create(divisor), ONE)
        for variable, places in chosen.items():
            if fresh or home.variable is None or not network.needs(home.variable, variable):
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


def _in_order(term: _Term) -> tuple[Monomial, Ref]:
    return term.monomial, term.coefficient


def _grouped(found: list[Entry]) -> list[Entry]:
    """One entry for each divisor."""
    groups: dict[int, Entry] = {}
    for entry in found:
        number = entry[0]
        old = groups.get(number)
        groups[number] = entry if old is None else (number, old[1] + entry[1], old[2] + entry[2])
    return list(groups.values())
