"""Numbers and hoisted values are told apart by their residues: equal values are one coefficient."""

from derive.programs.optimise.coefficients import PRIME, Coefficients, residue_of, scatter
from derive.programs.tape.graph import ZERO, Graph, negated
from derive.programs.tape.tape import PARAMETER, Op


def test_the_modulus_is_prime() -> None:
    """By Fermat, for enough bases to leave no doubt about 2^61 - 1."""
    assert all(pow(base, PRIME - 1, PRIME) == 1 for base in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37))


def test_residues_are_fixed_and_scattered() -> None:
    found = [scatter("parameter", k) for k in range(1000)]
    assert found == [scatter("parameter", k) for k in range(1000)]
    assert len(set(found)) == 1000
    assert all(0 <= residue < PRIME for residue in found)


def test_residues_follow_the_operations() -> None:
    a, b = scatter("a"), scatter("b")
    assert residue_of(Op.ADD, [a, b]) == (a + b) % PRIME
    assert residue_of(Op.MULTIPLY, [a, b]) == a * b % PRIME
    assert residue_of(Op.NEGATE, [a]) == -a % PRIME


def test_equal_values_are_one_coefficient_however_they_are_computed() -> None:
    graph = Graph()
    a, b = (graph.input(PARAMETER, k) for k in range(2))
    known = Coefficients(graph)
    product = known.multiply(known.same(a), known.same(b))
    assert known.multiply(known.same(b), known.same(a)) == product
    assert known.add(product, negated(product)) == ZERO
    assert known.residue(product) == known.residue(known.same(a)) * known.residue(known.same(b)) % PRIME
