"""The pose as exact polynomials: what of it is zero, one or equal wherever the arm reaches, and names for the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from derive.algebra.ring import Polynomial
from derive.inverse.closed.evidence import Evidence
from derive.inverse.closed.pool import Atoms, Links, dimension
from derive.inverse.closed.unknowns import InverseDomain
from derive.mechanics.vectors import Frame, Matrix, dot, hat, matmul, multiply, outer, transpose
from derive.robot.expression import Expression


class Pose:
    """The pose in exact polynomials: entries that are always zero, one or equal are not told apart.

    `atoms` are W and its invariants; `definitions` by generator polynomials of T and of those defined before;
    `constant` what vanishes, by entries of the position within the arm that are a number or another entry.
    """

    def __init__(
        self,
        domain: InverseDomain,
        links: Links[Polynomial],
        evidence: Evidence,
        constants: Mapping[str, Expression],
        allowed: frozenset[tuple[int, int]] = frozenset(),
        *,
        deep: bool = False,
    ) -> None:
        self._domain, self._evidence, self._constants = domain, evidence, constants
        self._known: list[tuple[int, bool, tuple[int, ...], Polynomial]] = []
        self.definitions: dict[str, Polynomial] = {}
        self.constant: dict[str, Polynomial] = {}
        places = [(i, j) for j in range(4) for i in range(3)]
        first = sorted(places, key=lambda place: (place[0] + 1, place[1] + 1) not in allowed)
        end = self._frame({(i, j): self._entry(f"T[{i + 1},{j + 1}]", None) for i, j in first})
        inner = links.base.inverse @ end @ links.tool.inverse
        self._known.clear()
        flat = {(i, j): inner.position[i] if j == 3 else inner.rotation[i][j] for i, j in places}
        told = sorted(places, key=lambda place: not evidence.is_told(f"W[{place[0] + 1},{place[1] + 1}]"))
        pose = self._frame({(i, j): self._entry(f"W[{i + 1},{j + 1}]", flat[i, j]) for i, j in told})
        r, p = pose.rotation, pose.position
        plain = [(f"p[{i + 1}]", flat[i, 3] - p[i]) for i in range(3) if f"W[{i + 1},4]" not in self.definitions]
        self.constant = {entry: difference for entry, difference in plain if difference}
        back = [self._entry(f"u[{k + 1}]", value) for k, value in enumerate(multiply(transpose(r), p))]
        square = self._entry("p.p", dot(p, p))
        moment = reflection = None
        if deep:
            zero = links.zero
            moment = self._matrix("m", matmul(hat(p, zero), r))
            products = outer(p, (back[0], back[1], back[2]))
            rows = [[square * r[i][j] - 2 * products[i][j] for j in range(3)] for i in range(3)]
            reflection = self._matrix("k", _as_matrix(rows))
        self.atoms = Atoms(r, p, (back[0], back[1], back[2]), square, moment, reflection)

    def _matrix(self, name: str, values: Matrix[Polynomial]) -> Matrix[Polynomial]:
        return _as_matrix([[self._entry(f"{name}[{i + 1},{j + 1}]", values[i][j]) for j in range(3)] for i in range(3)])

    @staticmethod
    def _frame(entries: Mapping[tuple[int, int], Polynomial]) -> Frame[Polynomial]:
        rows = [[entries[i, j] for j in range(3)] for i in range(3)]
        return Frame(_as_matrix(rows), (entries[0, 3], entries[1, 3], entries[2, 3]))

    def _entry(self, name: str, value: Polynomial | None) -> Polynomial:
        """An entry: zero, plus or minus one, plus or minus an earlier one, what it is if that is short, or its name.

        An earlier one has the same dimension, and what is told by the task is not written by what is not.
        """
        ring, p = self._domain.ring, self._evidence.prime
        residues = self._evidence.number(name, self._constants)
        for number in (0, 1, -1):
            if np.all(residues == number % p):
                return ring.number(number)
        power = int(name.endswith(",4]")) if name[0] in "TW" else dimension(name)  # of length
        told = name[0] == "T" or self._evidence.is_told(name)
        for own_power, own_told, known, polynomial in self._known:
            if own_power == power and (own_told or not told):
                if np.all(residues == known):
                    return polynomial
                if np.all(residues == (p - np.array(known)) % p):
                    return -polynomial
        if value is None or not is_plain(value):
            if value is not None:
                self.definitions[name] = value
            value = ring.generator(name)
        self._known.append((power, told, tuple(int(x) for x in residues), value))
        return value


def is_plain(p: Polynomial) -> bool:
    """Whether a polynomial is a number, or plus or minus one generator."""
    return p.is_constant or (len(p) == 1 and sum(p.degrees()) == 1 and abs(next(iter(p.terms()))[1]) == 1)


def _as_matrix(rows: Sequence[Sequence[Polynomial]]) -> Matrix[Polynomial]:
    a, b, c = ((row[0], row[1], row[2]) for row in rows)
    return (a, b, c)
