"""Local search for cheaper networks: variables written out where they are used, and sharing looked for again.

What was shared first may stand in the way of more. So a variable is put back into the definitions that use it (all of
them, or one), which are then searched for shared parts anew; the change is taken back if it costs operations. Changes
that cost nothing stay: they lead to others. The order of the trials is random with a fixed seed.

The squares of sine and cosine of one angle add up to one: polynomials with either square written out.
"""

from __future__ import annotations

import random
from itertools import pairwise

from derive.programs.optimise.network import Network, Opaque, Polynomial
from derive.programs.optimise.resubstitute import Resubstitution
from derive.programs.optimise.sharing import Extractor
from derive.programs.tape.tape import Op


class Circle:
    """Sines and cosines of the same angles in a network.

    Args:
        network: The network; functions that it gets later are not known here.
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self.partner = _partners(network)

    def without(self, polynomial: Polynomial, variable: int) -> Polynomial:
        """Every square of a sine or cosine replaced by one less the other square."""
        network, other = self._network, self.partner[variable]
        result: Polynomial = {}
        stack = list(reversed(polynomial.items()))
        while stack:
            monomial, coefficient = stack.pop()
            if monomial.count(variable) < 2:
                network.plus(result, monomial, coefficient)
                continue
            place = monomial.index(variable)
            rest = monomial[:place] + monomial[place + 2 :]
            stack.append((rest, coefficient))
            stack.append((tuple(sorted((*rest, other, other))), coefficient ^ 1))
        return result

    def squares(self, polynomial: Polynomial) -> list[int]:
        """Sines and cosines whose squares it holds, where the other of the pair is in use too."""
        found: dict[int, None] = {}
        for monomial in polynomial:
            for first, second in pairwise(monomial):
                if first == second and self.partner.get(first) in self._network.definition:
                    found[first] = None
        return list(found)

    def shortest(self, polynomial: Polynomial) -> Polynomial:
        """The polynomial with one kind of squares written out, if that is cheaper."""
        squares = self.squares(polynomial)
        if not squares:
            return polynomial
        forms = [polynomial, *(self.without(polynomial, variable) for variable in squares)]
        return min(forms, key=self._network.cost_of)


def _partners(network: Network) -> dict[int, int]:
    """The cosine of each sine, and the sine of each cosine."""
    found: dict[tuple[int | None, Op], int] = {}
    for variable, definition in network.definition.items():
        if isinstance(definition, Opaque) and definition.op in (Op.SINE, Op.COSINE):
            found[definition.operands[0].variable, definition.op] = variable
    partners: dict[int, int] = {}
    for (angle, op), variable in found.items():
        other = found.get((angle, Op.COSINE if op is Op.SINE else Op.SINE))
        if other is not None:
            partners[variable] = other
    return partners


_ROUNDS = 6
_MAX_TERMS = 24
"""Sums that would get longer than this are not written out."""

Trial = tuple[int, int | None]
"""A variable, and the one place where it is written out, or None for all."""


class Search:
    """A network that is being improved.

    Args:
        network: The network.
        seed: Of the order of trials.
    """

    def __init__(self, network: Network, seed: int = 0) -> None:
        self._network = network
        self._extractor = Extractor(network)
        self._random = random.Random(seed)
        self._circle = Circle(network)
        self._limit = 0
        self._turned = network.cost + 1

    def run(self, effort: int) -> None:
        """Share what can be shared at once, then try changes.

        Args:
            effort: Divisors that trials may look at.
        """
        self._extractor.run()
        self._limit = self._network.work + effort
        for _ in range(_ROUNDS):
            cost = self._network.cost
            self._round(self._used_once())
            if cost < self._turned:
                self._turn()
                self._turned = self._network.cost
            self._round(self._used_often())
            if self._network.cost == cost or self._network.work > self._limit:
                return

    def resubstitute(self, effort: int) -> None:
        """Try other definitions of variables in terms of two others.

        Args:
            effort: Divisors that trials may look at.
        """
        network = self._network
        self._limit = network.work + effort
        others = Resubstitution(network)
        for variable in others.candidates():
            if network.work > self._limit:
                return
            if variable in network.definition:
                self._redefine(variable, others)

    def _redefine(self, variable: int, others: Resubstitution) -> None:
        network = self._network
        for definition in list(others.alternatives(variable)):
            if not others.fits(variable, definition):
                continue
            cost, mark = network.cost, network.mark()
            network.define(variable, definition)
            self._settle(cost - 1, mark)
            if network.cost < cost:
                return

    def _settle(self, limit: int, mark: int) -> None:
        """Share anew after a change; take it back if the cost exceeds a limit."""
        self._network.settle()
        self._extractor.run()
        if self._network.cost > limit:
            self._network.undo(mark)
            self._extractor.drain()

    def _turn(self) -> None:
        """Squares of sines in terms of cosines or the other way round, in all definitions at once."""
        network = self._network
        for variable in self._circle.partner:
            if network.work > self._limit:
                return
            cost, mark = network.cost, network.mark()
            self._write_out_squares(variable)
            holders = [(v, p) for v, p in network.polynomials() if variable in self._circle.squares(p)]
            for holder, polynomial in holders:
                network.define(holder, self._circle.without(polynomial, variable))
            if holders:
                self._settle(cost - 1, mark)
            else:
                network.undo(mark)
                self._extractor.drain()

    def _write_out_squares(self, variable: int) -> None:
        """Write out products and single-use sums in which a square may hide."""
        network = self._network
        hidden = [v for v, p in network.polynomials() if any(variable in m for m in p) and len(network.users[v]) == 1]
        hidden += [v for v, p in network.polynomials() if len(p) == 1 and any(variable in m for m in p)]
        for inner in dict.fromkeys(hidden):
            self._write_out(inner, None)

    def _used_once(self) -> list[Trial]:
        """Sums to be multiplied out: the trials that succeed most often, and the cheapest."""
        network = self._network
        return [(v, None) for v, p in network.polynomials() if len(p) > 1 and len(network.users[v]) == 1]

    def _used_often(self) -> list[Trial]:
        """Sums in sums, and products that serve two."""
        users = self._network.users
        trials: list[Trial] = []
        for variable, polynomial in self._network.polynomials():
            row = users[variable]
            if len(row) > 1 and (self._is_term(variable) if len(polynomial) > 1 else len(row) == 2):
                trials += [(variable, None), *((variable, user) for user in row)]
        return trials

    def _is_term(self, variable: int) -> bool:
        """Whether it stands alone as a term of a sum."""
        polynomials = map(self._network.polynomial, self._network.users[variable])
        return any((variable,) in polynomial for polynomial in polynomials if polynomial is not None)

    def _round(self, trials: list[Trial]) -> None:
        self._random.shuffle(trials)
        for variable, user in trials:
            if self._network.work > self._limit:
                return
            self._try(variable, user)

    def _try(self, variable: int, user: int | None) -> None:
        """Write a variable out in one definition or in all, and share anew."""
        network = self._network
        cost, mark = network.cost, network.mark()
        if not self._write_out(variable, user):
            network.undo(mark)
            return
        self._settle(cost, mark)

    def _write_out(self, variable: int, user: int | None) -> bool:
        network = self._network
        inner = network.polynomial(variable)
        if inner is None:
            return False
        places = [u for u in network.users[variable] if user in (None, u)]
        changed = False
        for place in places:
            outer = network.polynomial(place)
            if outer is None:
                continue
            longer = self._circle.shortest(network.expanded(outer, variable, inner))
            if len(longer) > _MAX_TERMS:
                return False
            network.define(place, longer)
            changed = True
        return changed
