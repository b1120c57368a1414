"""Sharing made explicit: the divisor of polynomials that saves most becomes a variable, until none saves anything.

Divisors are pairs of factors of a term, and pairs of terms of a sum up to a common factor: the two-term divisors of
multi-level logic synthesis (Rajski and Vasudevamurthy 1992; for polynomials Hosangadi, Fallah and Kastner 2006), with
coefficients: a*x + b*x*y is x*(a + b*y), and with numbers 2*x + 6*y is 2*(x + 3*y).
"""

from collections.abc import Hashable
from dataclasses import dataclass
from heapq import heappop, heappush
from operator import attrgetter

from derive.programs.optimise.network import Definition, Monomial, Network, Operand, Polynomial, polynomial_cost
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.graph import ONE, UNITS, Ref, is_negative, signed

Place = tuple[tuple[Monomial, ...], Monomial, Ref, int]
"""Where a divisor stands in a polynomial: the monomials of the terms that hold it, what is left of them without it, the
coefficient, and the operations that are saved there, the divisor itself not counted."""

# The number of a divisor, its places in one polynomial, and what they save together.
Entry = tuple[int, list[Place], int]
_IN_ORDER = attrgetter("content")


@dataclass(frozen=True, slots=True)
class _Term:
    """A term of sums, with the divisors in it, and in pairs with other terms as far as they have been asked for."""

    number: int
    content: tuple[Monomial, Ref]
    factors: list[Entry]
    pairs: dict[int, list[Entry]]


class Extractor:
    """A network together with all divisors of its polynomials; it watches the network."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self._numbers: dict[Hashable, int] = {}
        self._divisors: list[Polynomial] = []
        self._prices: list[int] = []
        self._places: list[dict[int, list[Place]]] = []
        self._gains: list[int] = []
        self._terms: dict[tuple[Monomial, Ref], _Term] = {}
        self._entries: dict[int, list[Entry]] = {}
        self._divided: dict[tuple[tuple[Monomial, Ref], ...], tuple[list[Entry], int]] = {}
        self._heap: list[tuple[int, int, int]] = []
        self._count = 0
        for variable, polynomial in network.polynomials():
            self.learn(variable, polynomial)
        network.watcher = self

    def learn(self, variable: int, definition: Definition) -> None:
        """Take up the divisors of a new definition."""
        if not isinstance(definition, dict):
            return
        content = tuple(definition.items())
        if (known := self._divided.get(content)) is None:
            known = self._divided[content] = self._divide(content)
        entries, count = known
        self._entries[variable] = entries
        self.network.work += 1 + count
        places, gains, heap = self._places, self._gains, self._heap
        for number, spots, saving in entries:
            places[number][variable] = spots
            gain = gains[number] = gains[number] + saving
            if gain > 0:
                self._count += 1
                heappush(heap, (-gain, self._count, number))

    def forget(self, variable: int, definition: Definition) -> None:
        """Drop the divisors of a definition."""
        if not isinstance(definition, dict):
            return
        places, gains = self._places, self._gains
        for number, _, saving in self._entries.pop(variable):
            del places[number][variable]
            gains[number] -= saving

    def run(self) -> None:
        """Extract until nothing saves."""
        heap, gains = self._heap, self._gains
        # Gains fall while offers wait: each is priced again when it comes up, and put back where it is worth less.
        while heap:
            claimed, order, number = heappop(heap)
            if gains[number] <= 0:
                continue
            chosen = self._disjoint(number)
            gain = sum([saving for places in chosen.values() for *_, saving in places]) - self._prices[number]
            if gain == -claimed:
                self._extract(self._divisors[number], chosen)
            elif gain > 0:
                heappush(heap, (-gain, order, number))

    def drain(self) -> None:
        """Forget what was on offer: nothing saves."""
        self._heap.clear()

    def _divide(self, polynomial: tuple[tuple[Monomial, Ref], ...]) -> tuple[list[Entry], int]:
        """The divisors of a polynomial, one entry for each, and the number of their places."""
        terms = [self._terms.get(term) or self._term(term) for term in polynomial]
        found = [entry for term in terms for entry in term.factors]
        if 1 < len(terms) <= POLICY.longest_paired:
            # In one order, so that equal sums have equal divisors.
            terms.sort(key=_IN_ORDER)
            for i, one in enumerate(terms):
                pairs = one.pairs
                for other in terms[i + 1 :]:
                    found += pairs.get(other.number) or self._pair(one, other)
        groups: dict[int, Entry] = {}
        for entry in found:
            number = entry[0]
            old = groups.get(number)
            groups[number] = entry if old is None else (number, old[1] + entry[1], old[2] + entry[2])
        return list(groups.values()), len(found)

    def _term(self, content: tuple[Monomial, Ref]) -> _Term:
        """A term with its pairs of factors, the coefficient among them."""
        monomial, coefficient = content
        found: list[Entry] = []
        here = (monomial,)
        # The coefficient times one factor: k x, once for equal factors.
        if coefficient not in UNITS:
            magnitude, rest = signed(coefficient, is_negative(coefficient)), signed(ONE, is_negative(coefficient))
            for i, x in enumerate(monomial):
                if not (i and monomial[i - 1] == x):
                    number = self._number(("multiple", magnitude, x), {(x,): magnitude})
                    found.append((number, [(here, monomial[:i] + monomial[i + 1 :], rest, 1)], 1))
        # Two factors: x y, once for equal pairs.
        seen = set()
        for i, x in enumerate(monomial):
            for j in range(i + 1, len(monomial)):
                if (pair := (x, monomial[j])) not in seen:
                    seen.add(pair)
                    left = monomial[:i] + monomial[i + 1 : j] + monomial[j + 1 :]
                    found.append((self._number(pair, {pair: ONE}), [(here, left, coefficient, 1)], 1))
        term = self._terms[content] = _Term(len(self._terms), content, found, {})
        return term

    def _pair(self, one: _Term, other: _Term) -> list[Entry]:
        """Two terms of a sum as divisors: as they are, and with the coefficient of the first taken out."""
        (a, j), (b, k) = one.content, other.content
        terms = (a, b)
        # Two products and an addition become one product, if anything is left beside the divisor.
        saving = term_cost(a, j) + term_cost(b, k) + 1
        common = _common(a, b) if len(a) + len(b) > 2 and a and b else ()
        if common:
            saving -= len(common)
            a, b = _without(a, common), _without(b, common)
        # One spelling of each divisor: the smaller monomial first, with a positive coefficient.
        if a > b:
            a, j, b, k = b, k, a, j
        negative = is_negative(j)
        first, second = signed(j, negative), signed(k, negative)
        number = self._number((a, first, b, second), {a: first, b: second})
        found: list[Entry] = [(number, [(terms, common, signed(ONE, negative), saving)], saving)]
        # j (a + k/j b): over numbers 2 x + 6 y is 2 (x + 3 y).
        if j not in UNITS and (ratio := self.network.coefficients.ratio(k, j)) is not None:
            number = self._number((a, ONE, b, ratio), {a: ONE, b: ratio})
            found.append((number, [(terms, common, j, saving - 1)], saving - 1))
        one.pairs[other.number] = found
        return found

    def _number(self, key: Hashable, divisor: Polynomial) -> int:
        """The number of a divisor, the next where it has none."""
        if (number := self._numbers.get(key)) is None:
            number = self._numbers[key] = len(self._divisors)
            price = polynomial_cost(divisor)
            self._divisors.append(divisor)
            self._prices.append(price)
            self._places.append({})
            self._gains.append(-price)
        return number

    def _disjoint(self, number: int) -> dict[int, list[Place]]:
        """Places of a divisor that do not share a term."""
        chosen: dict[int, list[Place]] = {}
        # Greedy, in the order of the terms: places in one sum may overlap.
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

    def _extract(self, divisor: Polynomial, chosen: dict[int, list[Place]]) -> None:
        """Make a divisor a variable, unless one has its value, and use it where it stands."""
        network = self.network
        # A variable may have this value already, or minus it.
        known = network.find(network.evaluate(divisor))
        home = known or Operand(network.create(divisor), ONE)
        factor = () if home.variable is None else (home.variable,)
        for variable, places in chosen.items():
            # Not where the known variable is itself computed from this one: that would be a circle.
            if known and known.variable is not None and network.needs(known.variable, variable):
                continue
            new = dict(network.polynomial(variable) or {})
            # First all terms that hold the divisor go, then its multiples come: they may meet other terms.
            for terms, *_ in places:
                for monomial in terms:
                    del new[monomial]
            for _, quotient, coefficient, _ in places:
                product = network.coefficients.multiply(coefficient, home.coefficient)
                network.plus(new, tuple(sorted((*quotient, *factor))), product)
            network.define(variable, new)
        network.settle()


def term_cost(monomial: Monomial, coefficient: Ref) -> int:
    """Multiplications of a coefficient and a product of variables."""
    return len(monomial) - (coefficient in UNITS) if monomial else 0


def _common(a: Monomial, b: Monomial) -> Monomial:
    """The greatest common divisor of two monomials."""
    found, rest = list[int](), list(b)
    for variable in a:  # ascending, and so is what is found
        if variable in rest:
            rest.remove(variable)
            found.append(variable)
    return tuple(found)


def _without(monomial: Monomial, common: Monomial) -> Monomial:
    """The monomial over a divisor of it."""
    rest = list(monomial)
    for variable in common:
        rest.remove(variable)
    return tuple(rest)
