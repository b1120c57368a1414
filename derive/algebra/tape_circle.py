"""The squares of sine and cosine of one angle add up to one: polynomials with either square written out."""

from __future__ import annotations

from itertools import pairwise

from derive.algebra.tape import Op
from derive.algebra.tape_network import Network, Opaque, Polynomial


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
