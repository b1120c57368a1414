"""One unknown out of two equations with two."""

from __future__ import annotations

from derive.algebra.ring import Polynomial, Ring
from derive.inverse.closed.pairs import without_angle, without_length


def ring() -> Ring:
    made = Ring(["s", "c", "r", "a", "x", "y", "z"])
    made.relate_angle("s", "c")
    return made


def generators(made: Ring) -> list[Polynomial]:
    return [made.generator(name) for name in ("c", "s", "r", "a", "x", "y", "z")]


def test_two_equations_turned_against_each_other_are_squared_and_added() -> None:
    made = ring()
    c, s, _, a, x, y, z = generators(made)
    found = without_angle(made, ("c", "s"), x * c + y * s - z, 2 * a * (x * s - y * c) - a)
    assert found is not None
    assert found == a * a * (4 * z * z + 1 - 4 * (x * x + y * y))


def test_any_other_pair_of_the_first_degree_is_solved_by_cramers_rule() -> None:
    made = ring()
    c, s, _, a, x, y, z = generators(made)
    found = without_angle(made, ("c", "s"), a * c - x, z * s - y)
    assert found == a * a * (y * y) + z * z * (x * x) - a * a * (z * z)
    assert without_angle(made, ("c", "s"), a * c * s - x, z * s - y) is None


def test_a_slide_drops_out_of_two_equations_of_the_first_degree() -> None:
    made = ring()
    _, _, r, a, x, y, _ = generators(made)
    found = without_length(made, "r", a * r - x, 2 * a * r - y)
    assert found is not None
    assert found == y - 2 * x
    assert without_length(made, "r", a * r * r - x, a * r - y) is None
    assert without_length(made, "r", x, a * r - y) is None
