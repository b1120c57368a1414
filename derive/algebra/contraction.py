"""The shortest way to write a trigonometric polynomial in the angles of one aligned group.

For a group of k joints the angles q_i + ... + q_j of every contiguous run are candidates; any k of them that span
form a basis. With the runs as edges between k+1 nodes the bases are the spanning trees. The polynomial is written in
each basis, each s^2 or c^2 is replaced by s^2 + c^2 = 1 where that leaves fewer terms, and the shortest result wins:
c2*c3 - s2*s3 becomes c23, c1*c12 + s1*s12 becomes c2, 1 - c5^2 becomes s5^2.
"""

from fractions import Fraction
from functools import cache, lru_cache
from itertools import combinations
from typing import NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from derive.algebra.ring import fraction

Edge = tuple[int, int]  # nodes lo < hi: the sum of the angles lo+1 .. hi, counted within the group
Tree = tuple[Edge, ...]
# Terms (exponents of s_1..s_k, c_1..c_k; coefficient) in the generators of the ring.
Items = tuple[tuple[tuple[int, ...], Fraction], ...]
MAX_ENUMERATED = 3  # largest group whose spanning trees are all tried; 16 trees for 3 joints, 125 for 4
MAX_STARS = 8
"""Largest number of sums for which each of them is tried as the common reference: every further one costs a rewriting
of the polynomial."""

MAX_REWRITTEN_TERMS = 60
"""Polynomials with more terms are written in the basis they come in: rewriting them in every basis takes long, and
nobody would read the result."""


class Trig(NamedTuple):
    """A power of the sine or cosine of a contiguous sum of angles."""

    is_sine: bool
    edge: Edge
    exponent: int


class Contracted(NamedTuple):
    """One term of the result."""

    coefficient: Fraction
    factors: tuple[Trig, ...]


def contract(size: int, sums: bool, items: Items) -> tuple[Contracted, ...]:
    """The shortest form of a polynomial in the angles of a group."""
    if not sums or size == 1:
        return _shortest(size, sums, items)
    # sums that do not occur are left out, and the nodes of the others numbered as in the whole group afterwards
    used = [i for i in range(size) if any(e[i] or e[size + i] for e, _ in items)]
    places = [*used, *(size + i for i in used)]
    small = tuple((tuple(e[p] for p in places), coefficient) for e, coefficient in items)
    nodes = (0, *(i + 1 for i in used))
    terms = _shortest(len(used), True, small)
    placed = ([f._replace(edge=(nodes[f.edge[0]], nodes[f.edge[1]])) for f in term.factors] for term in terms)
    return tuple(Contracted(term.coefficient, tuple(own)) for term, own in zip(terms, placed, strict=True))


@lru_cache(maxsize=100_000)
def _shortest(size: int, sums: bool, items: Items) -> tuple[Contracted, ...]:
    """The terms in the basis in which there are fewest; then those of least degree, with the fewest angles."""
    # every basis is tried: rewritten, squares folded, counted; ties go to the ring's own angles, which come first
    polynomial = _context(size).from_dict({exponents: fmpq(c.numerator, c.denominator) for exponents, c in items})
    bases = trees(size, sums)
    if len(items) == 1 or len(items) > MAX_REWRITTEN_TERMS:
        return _terms_in(bases[0], polynomial)
    candidates = []
    for rank, tree in enumerate(bases):
        terms = _terms_in(tree, _fold_squares(size, polynomial.compose(*_in_angles_of(size, sums, tree))))
        factors = [f for term in terms for f in term.factors]
        degree, angles = sum(f.exponent for f in factors), len({f.edge for f in factors})
        length = sum(f.edge[1] - f.edge[0] for f in factors)
        candidates.append(((len(terms), degree, angles, length, rank), terms))
    return min(candidates, key=lambda candidate: candidate[0])[1]


@cache
def trees(size: int, sums: bool) -> tuple[Tree, ...]:
    """The bases to try, the ring's own first, which wins ties; of large groups those of sums of two angles at most."""
    nodes = range(size + 1)
    own = tuple((0 if sums else i, i + 1) for i in range(size))
    others: list[Tree] = []
    if size <= MAX_ENUMERATED:
        # spanning trees: as many edges as joints, and every node is reached
        every = combinations(combinations(nodes, 2), size)
        others = [tree for tree in every if len(paths(tree, 0)) == size + 1]
    elif sums and size <= MAX_STARS:
        # stars: all sums with one end r in common
        others = [tuple((min(r, i), max(r, i)) for i in nodes if i != r) for r in nodes]
    return tuple(dict.fromkeys([own, *others]))


def paths(tree: Tree, root: int) -> dict[int, dict[int, int]]:
    """The ways of fewest edges from one node to others: by the numbers of edges, whether along or against them."""
    found: dict[int, dict[int, int]] = {root: {}}
    queue = [root]
    while queue:
        node = queue.pop(0)
        # along an edge the angle counts as it is, against it with a minus
        for index, (lo, hi) in enumerate(tree):
            for here, there, sign in ((lo, hi, 1), (hi, lo, -1)):
                if here == node and there not in found:
                    found[there] = {**found[node], index: sign}
                    queue.append(there)
    return found


@cache
def _context(size: int) -> fmpq_mpoly_ctx:
    """Polynomials in s_1..s_k, c_1..c_k without relations."""
    return fmpq_mpoly_ctx.get([*(f"s{i}" for i in range(size)), *(f"c{i}" for i in range(size))], Ordering.lex)


@cache
def _in_angles_of(size: int, sums: bool, tree: Tree) -> tuple[fmpq_mpoly, ...]:
    """Sine and cosine of every generator angle as polynomials in those of the angles of a tree."""
    context = _context(size)
    g = context.gens()
    pairs = []
    # addition theorem along the path that spans a generator's angle in the tree
    for lo, hi in trees(size, sums)[0]:
        cosine, sine = context.constant(1), context.constant(0)
        for index, sign in paths(tree, lo)[hi].items():
            s, c = sign * g[index], g[size + index]
            cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        pairs.append((sine, cosine))
    return (*(s for s, _ in pairs), *(c for _, c in pairs))


def _fold_squares(size: int, p: fmpq_mpoly) -> fmpq_mpoly:
    """Normal form by s^2 -> 1 - c^2, then c^2 -> 1 - s^2 for each angle where that leaves fewer terms."""
    generators = _context(size).gens()
    # division by s^2 + c^2 - 1, led by s, leaves s linear
    circles = [generators[i] ** 2 + generators[size + i] ** 2 - 1 for i in range(size)]
    for circle in circles:
        p = divmod(p, circle)[1]
    for i in range(size):
        if p and p.degrees()[size + i] >= 2:
            # the same division with sine and cosine exchanged replaces c^2 instead
            swapped = list(generators)
            swapped[i], swapped[size + i] = swapped[size + i], swapped[i]
            other = divmod(p.compose(*swapped), circles[i])[1].compose(*swapped)
            if len(other) < len(p):
                p = other
    return p


def _terms_in(tree: Tree, p: fmpq_mpoly) -> tuple[Contracted, ...]:
    """The terms of a polynomial whose angles are those of a tree."""
    size = len(tree)
    terms = []
    for exponents, coefficient in p.terms():
        factors = tuple(Trig(k < size, tree[k % size], int(e)) for k, e in enumerate(exponents) if e)
        terms.append(Contracted(fraction(coefficient), factors))
    return tuple(terms)
