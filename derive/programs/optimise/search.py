"""Local search for cheaper networks: variables written out where they are used, and sharing looked for again.

What was shared first may stand in the way of more. So a variable is put back into the definitions that use it (all of
them, or one), which are then searched for shared parts anew; the change is taken back if it costs operations. Changes
that cost nothing stay: they lead to others. The order of the trials is random with a fixed seed.

Sums are also rewritten by s^2 + c^2 = 1, the squares of a sine and a cosine of one angle, with either square written
out (`Circle`).
"""

import random
from itertools import pairwise

from derive.programs.optimise.network import Network, Opaque, Polynomial
from derive.programs.optimise.resubstitute import Resubstitution
from derive.programs.optimise.search_policy import POLICY
from derive.programs.optimise.sharing import Extractor
from derive.programs.tape.cost import polynomial_cost
from derive.programs.tape.graph import negated
from derive.programs.tape.tape import Op

_OTHER = {Op.SINE: Op.COSINE, Op.COSINE: Op.SINE}

Trial = tuple[int, int | None]  # a variable, and the one place where it is written out, or None for all


class Circle:
    """Sines and cosines of the same angles in a network."""

    def __init__(self, network: Network) -> None:
        self._network = network
        functions = {
            (d.operands[0].variable, d.op): v
            for v, d in network.definition.items()
            if isinstance(d, Opaque) and d.op in _OTHER
        }
        self.partner = {
            variable: functions[angle, _OTHER[op]]
            for (angle, op), variable in functions.items()
            if (angle, _OTHER[op]) in functions
        }

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
            stack.append((rest, coefficient))
            stack.append((tuple(sorted((*rest, other, other))), negated(coefficient)))
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
        squares = self.squares(polynomial)
        if not squares:
            return polynomial
        return min([polynomial, *(self.without(polynomial, variable) for variable in squares)], key=polynomial_cost)


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
            cost, mark = network.cost, network.mark()
            # Squares may be hidden in products, and in sums that are used once: those are written out first.
            users = [(v, p) for v, p in network.polynomials() if any(variable in m for m in p)]
            hidden = [v for v, _ in users if len(network.users[v]) == 1] + [v for v, p in users if len(p) == 1]
            for inner in dict.fromkeys(hidden):  # products and single-use sums in which a square may hide
                self._write_out(inner, None)
            holders = [(v, p) for v, p in network.polynomials() if variable in circle.squares(p)]
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
        inner = network.polynomial(variable)
        if inner is None:
            return False
        changed = False
        # A sum that would get too long makes the whole trial void; the caller undoes it.
        for place in [u for u in network.users[variable] if user in (None, u)]:
            outer = network.polynomial(place)
            if outer is None:
                continue
            longer = self._circle.shortest(network.expanded(outer, variable, inner))
            if len(longer) > POLICY.longest_expansion:
                return False
            network.define(place, longer)
            changed = True
        return changed
