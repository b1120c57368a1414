"""The shortest way to write a trigonometric polynomial in the angles of one aligned group.

For a group of k joints the angles q_i + ... + q_j of every contiguous run are candidates; any k of them that span
form a basis. With the runs as edges between k+1 nodes the bases are the spanning trees. The polynomial is written in
each basis, each s^2 or c^2 is replaced where that leaves fewer terms, and the shortest result wins: c2*c3 - s2*s3
becomes c23, c1*c12 + s1*s12 becomes c2, 1 - c5^2 becomes s5^2.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, lru_cache
from itertools import combinations
from typing import NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from derive.algebra.ring import fraction

Edge = tuple[int, int]
"""Nodes lo < hi: the sum of the angles lo+1 .. hi, counted within the group."""

Tree = tuple[Edge, ...]
Items = tuple[tuple[tuple[int, ...], int, int], ...]
"""Terms (exponents of s_1..s_k, c_1..c_k; numerator; denominator) in the generators of the ring."""

MAX_ENUMERATED = 3
"""Largest group whose spanning trees are all tried; 16 trees for 3 joints, 125 for 4."""

MAX_STARS = 8
"""Largest number of sums for which each of them is tried as the common reference."""

MAX_TERMS = 60
"""Polynomials with more terms are written in the basis they come in."""


class Trig(NamedTuple):
    """A power of the sine or cosine of a contiguous sum of angles."""

    is_sine: bool
    edge: Edge
    exponent: int


class Contracted(NamedTuple):
    """One term of the result: coefficient as numerator and denominator, and its factors."""

    numerator: int
    denominator: int
    factors: tuple[Trig, ...]


def contract(size: int, sums: bool, items: Items) -> tuple[Contracted, ...]:
    """The shortest form of a polynomial in the angles of a group.

    Args:
        size: Number of joints in the group.
        sums: Whether the generators are the sums q_1, q_1 + q_2, ... (else the angles themselves).
        items: The polynomial.
    """
    if not sums or size == 1:
        return _contract(size, sums, items)
    used = [i for i in range(size) if any(e[i] or e[size + i] for e, _, _ in items)]
    places = [*used, *(size + i for i in used)]
    small = tuple((tuple(e[p] for p in places), n, d) for e, n, d in items)
    nodes = (0, *(i + 1 for i in used))
    return tuple(_renumbered(term, nodes) for term in _contract(len(used), True, small))


def _renumbered(term: Contracted, nodes: tuple[int, ...]) -> Contracted:
    """A term over the sums that occur, with the nodes of the whole group."""
    factors = tuple(Trig(f.is_sine, (nodes[f.edge[0]], nodes[f.edge[1]]), f.exponent) for f in term.factors)
    return Contracted(term.numerator, term.denominator, factors)


@lru_cache(maxsize=100_000)
def _contract(size: int, sums: bool, items: Items) -> tuple[Contracted, ...]:
    own = _own_tree(size, sums)
    if len(items) == 1 or len(items) > MAX_TERMS:
        return _read(own, _polynomial(size, items))
    polynomial = _polynomial(size, items)
    best: tuple[tuple[int, ...], tuple[Contracted, ...]] | None = None
    for rank, tree in enumerate(trees(size, sums)):
        written = _fold_squares(size, polynomial.compose(*_substitution(size, sums, tree)))
        terms = _read(tree, written)
        cost = (*_cost(terms), rank)
        if best is None or cost < best[0]:
            best = (cost, terms)
    assert best is not None
    return best[1]


def _cost(terms: tuple[Contracted, ...]) -> tuple[int, ...]:
    degree = sum(f.exponent for t in terms for f in t.factors)
    angles = len({f.edge for t in terms for f in t.factors})
    length = sum(f.edge[1] - f.edge[0] for t in terms for f in t.factors)
    return len(terms), degree, angles, length


def _own_tree(size: int, sums: bool) -> Tree:
    return tuple((0 if sums else i, i + 1) for i in range(size))


@cache
def trees(size: int, sums: bool) -> tuple[Tree, ...]:
    """The bases to try; the ring's own first, so that ties leave a polynomial as it is.

    In a large group only those in which every generator is a sum of two angles at most: a longer sum has exponentially
    many terms.
    """
    own = _own_tree(size, sums)
    if size <= MAX_ENUMERATED:
        others = list(_spanning_trees(size))
    elif sums and size <= MAX_STARS:
        others = [tuple((min(r, i), max(r, i)) for i in range(size + 1) if i != r) for r in range(size + 1)]
    else:
        others = []
    return tuple(dict.fromkeys([own, *others]))


def _spanning_trees(size: int) -> Iterator[Tree]:
    edges = [(i, j) for i in range(size + 1) for j in range(i + 1, size + 1)]
    for tree in combinations(edges, size):
        if len(paths(tree, 0)) == size + 1:
            yield tree


def paths(tree: Tree, root: int) -> dict[int, dict[int, int]]:
    """For every node that the tree reaches: the signed edges from the root to it."""
    found: dict[int, dict[int, int]] = {root: {}}
    queue = [root]
    while queue:
        node = queue.pop()
        for index, (lo, hi) in enumerate(tree):
            for here, there, sign in ((lo, hi, 1), (hi, lo, -1)):
                if here == node and there not in found:
                    found[there] = {**found[node], index: sign}
                    queue.append(there)
    return found


@cache
def _context(size: int) -> fmpq_mpoly_ctx:
    names = [f"s{i}" for i in range(size)] + [f"c{i}" for i in range(size)]
    return fmpq_mpoly_ctx.get(names, Ordering.lex)


@cache
def _squares(size: int) -> tuple[fmpq_mpoly, ...]:
    g = _context(size).gens()
    return tuple(g[i] ** 2 + g[size + i] ** 2 - 1 for i in range(size))


def _polynomial(size: int, items: Items) -> fmpq_mpoly:
    return _context(size).from_dict({exponents: fmpq(p, q) for exponents, p, q in items})


@cache
def _substitution(size: int, sums: bool, tree: Tree) -> tuple[fmpq_mpoly, ...]:
    """Sine and cosine of every generator angle as polynomials in the basis angles."""
    pairs = []
    for lo, hi in _own_tree(size, sums):
        pairs.append(_angle(size, paths(tree, lo)[hi]))
    return (*(s for _, s in pairs), *(c for c, _ in pairs))


def _angle(size: int, path: dict[int, int]) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    context = _context(size)
    g = context.gens()
    cosine, sine = context.constant(1), context.constant(0)
    for index, sign in path.items():
        s, c = sign * g[index], g[size + index]
        cosine, sine = cosine * c - sine * s, sine * c + cosine * s
    return cosine, sine


def _fold_squares(size: int, p: fmpq_mpoly) -> fmpq_mpoly:
    """Normal form, then c^2 -> 1 - s^2 for each angle where that leaves fewer terms."""
    for relation in _squares(size):
        p = divmod(p, relation)[1]
    if not p:
        return p
    for i in range(size):
        if p.degrees()[size + i] >= 2:
            other = _swap(size, i, divmod(_swap(size, i, p), _squares(size)[i])[1])
            if len(other) < len(p):
                p = other
    return p


def _swap(size: int, i: int, p: fmpq_mpoly) -> fmpq_mpoly:
    g = list(_context(size).gens())
    g[i], g[size + i] = g[size + i], g[i]
    return p.compose(*g)


def _read(tree: Tree, p: fmpq_mpoly) -> tuple[Contracted, ...]:
    size = len(tree)
    terms = []
    for exponents, coefficient in p.terms():
        factors = tuple(
            Trig(position < size, tree[position % size], int(e)) for position, e in enumerate(exponents) if e
        )
        value = fraction(coefficient)
        terms.append(Contracted(value.numerator, value.denominator, factors))
    return tuple(terms)
