"""Values written in terms of two others that exist, where their definition costs more than one operation.

Whether values agree is known from their residues, so identities count that no rewriting shows: the trace of an inertia
tensor is the same in every frame, the square of a cosine is one less the square of the sine.
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.algebra.tape_coefficients import PRIME
from derive.algebra.tape_graph import ONE
from derive.algebra.tape_network import Monomial, Network, Operand, Polynomial
from derive.algebra.tape_scale import Scale


class Resubstitution:
    """Shorter definitions of the variables of a network as it stands.

    Args:
        network: The network; later changes of it are not known here.
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self._scale = Scale(network)
        self._values = [(v, network.residue[v]) for v in network.definition if v >= 0 and network.residue[v]]
        self._known = {r for residue in network.coefficients.residues() for r in (residue, PRIME - residue)}
        self._known.update(r for _, residue in self._values for r in (residue, PRIME - residue))
        self._inverses = [(v, pow(residue, -1, PRIME)) for v, residue in self._values]

    def candidates(self) -> list[int]:
        """Variables whose definition, with what it alone uses, costs more than one operation."""
        return [v for v, p in self._network.polynomials() if self._is_dear(p)]

    def _is_dear(self, polynomial: Polynomial) -> bool:
        network = self._network
        if network.cost_of(polynomial) > 1:
            return True
        return any(len(network.users[v]) == 1 and network.polynomial(v) for monomial in polynomial for v in monomial)

    def alternatives(self, variable: int) -> Iterator[Polynomial]:
        """Other definitions of a variable, each of one operation: sums, differences and products of two values."""
        network, known = self._network, self._known
        value = network.residue[variable]
        network.work += len(self._values) // 16
        plus = [v for v, residue in self._values if (value - residue) % PRIME in known]
        minus = [v for v, residue in self._values if (value + residue) % PRIME in known]
        times = [v for v, inverse in self._inverses if value * inverse % PRIME in known]
        for other, sign in [*((v, 0) for v in plus), *((v, 1) for v in minus)]:
            residue = network.residue[other]
            rest = network.find((value + residue if sign else value - residue) % PRIME)
            if rest is not None and other != variable != rest.variable != other:
                yield {(other,): ONE ^ sign, _monomial(rest): rest.coefficient}
        for other in times:
            rest = network.find(value * pow(network.residue[other], -1, PRIME) % PRIME)
            if rest is not None and other != variable != rest.variable:
                yield {tuple(sorted((other, *_monomial(rest)))): rest.coefficient}

    def fits(self, variable: int, definition: Polynomial) -> bool:
        """Whether a definition is new, of variables that are in use and do not need this one, and is as accurate."""
        network = self._network
        if network.polynomial(variable) == definition:
            return False
        parts = [v for monomial in definition for v in monomial]
        if not all(v in network.definition and not network.needs(v, variable) for v in parts):
            return False
        return self._scale.allows(variable, definition)


def _monomial(operand: Operand) -> Monomial:
    return () if operand.variable is None else (operand.variable,)
