"""Linear combinations of joint variables, and what follows from those that are known."""

from __future__ import annotations

from fractions import Fraction

from derive.api.robots import load
from derive.checking.inverse.order import Known, unit_vector
from derive.checking.inverse.printed import JointCombinations
from derive.robot.expression import Call, Name, Pi, add, multiply, negate, number

JOINTS = JointCombinations(load("planar-3r"), {"q23": add(Name("q2"), Name("q3"))})


def test_sums_and_names_of_sums_are_combinations_and_constants_do_not_count() -> None:
    e = add(Name("q23"), negate(Name("q1")), Pi())
    assert JOINTS.combination(e) == (-1, 1, 1)
    assert JOINTS.combination(multiply(number("1/2"), Name("q1"))) == (Fraction(1, 2), 0, 0)
    assert JOINTS.combination(Pi()) is None
    assert JOINTS.combination(multiply(Name("q1"), Name("q2"))) is None


def test_what_is_needed_are_angles_and_their_functions() -> None:
    e = add(multiply(Name("a1"), Call("cos", (Name("q23"),))), Name("q1"))
    assert list(JOINTS.needed(e)) == [("cos", (0, 1, 1)), ("", (1, 0, 0))]
    assert JOINTS.meaning(Call("sqrt", (Name("q1"),))) is None


def test_a_sum_and_all_but_one_of_its_terms_give_the_last_one() -> None:
    known = Known([0], 3)
    assert not known.has("", unit_vector(1, 3))
    known.add("", (Fraction(0), Fraction(1), Fraction(1)))
    known.add("cos", unit_vector(2, 3))
    assert known.has("cos", unit_vector(2, 3))
    assert not known.has("", unit_vector(1, 3))
    known.add("sin", unit_vector(2, 3))
    assert known.has("", unit_vector(1, 3))
