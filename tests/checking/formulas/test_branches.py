"""Formulas with several values: equal for all branches, for some, or for none."""

import pytest

from derive.checking.formulas.branches import branches, has_branches, needs_branches
from derive.robot.expression import Call, Name, add, multiply, negate, number, power
from derive.robot.robot import Robot

ARM = Robot.load("planar-2r-perugia")
ANGLE = Name(ARM.joints[1].variable)
COSINE, SINE = Call("cos", (ANGLE,)), Call("sin", (ANGLE,))
SIGN = Name("±1")
ROOT = Call("sqrt", (add(number(1), negate(power(COSINE, 2))),))


@pytest.mark.parametrize(
    ("printed", "all_of_them", "some"),
    [
        (multiply(SIGN, Call("acos", (COSINE,))), True, False),
        (Call("acos", (COSINE,)), False, True),
        (Call("atan2", (multiply(SIGN, ROOT), COSINE)), True, False),
        (Call("Atan2", (COSINE, SINE)), True, False),  # with the cosine first
        (Call("asin", (SINE,)), False, True),
        (Call("atan", (multiply(SINE, power(COSINE, -1)),)), False, True),
        (Call("acos", (SINE,)), False, False),
        (multiply(SIGN, Call("acos", (negate(COSINE),))), False, False),
    ],
)
def test_an_angle_is_compared_for_every_choice_of_signs(printed: Call, all_of_them: bool, some: bool) -> None:
    seen = branches(ARM, ANGLE, printed)
    assert (seen.all, seen.some) == (all_of_them, some)
    assert has_branches(printed, roots=False)


def test_a_root_has_two_signs_only_where_that_is_asked() -> None:
    assert has_branches(ROOT, roots=True)
    assert not has_branches(ROOT, roots=False)
    assert not needs_branches(Call("atan2", (SINE, COSINE)))
    assert needs_branches(multiply(SIGN, ROOT))
    assert branches(ARM, SINE, multiply(SIGN, ROOT)).all
    assert branches(ARM, SINE, ROOT).some
