"""The derived solution beside a printed one."""

from __future__ import annotations

from derive.checking.inverse.ours import OurSolution
from derive.checking.inverse.poses import places
from derive.model.model import Model
from tests.checking.inverse.test_printed import solution

TEXT = "D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2); theta2 = atan2(+-sqrt(1 - D**2), D); theta1 = atan2(y, x)"


def ours(task: tuple[str, ...] | None = None) -> tuple[OurSolution, tuple]:
    printed, vocabulary = solution("planar-2r-perugia", TEXT)
    tried = places(vocabulary.pose, vocabulary.sums)
    return OurSolution(Model(printed.robot), printed, vocabulary.pose, task, tried), (printed, vocabulary)


def test_the_names_in_the_text_say_the_task() -> None:
    assert ours()[0].count == 2
    assert ours(("x", "y", "z", "orientation"))[0].count == 1


def test_our_formula_stands_with_what_it_names() -> None:
    found, (printed, _) = ours()
    assert found.text(printed.given[0]) == ("atan2(+-sqrt(1 - D**2), D), D = (px**2 + py**2 - a1**2 - a2**2)/(2*a1*a2)")
    assert found.has_form(printed.given[0].formulas[0])
    assert not found.has_form(printed.given[1].formulas[0])


def test_branches_that_are_met_nowhere_are_missing() -> None:
    found, (_, vocabulary) = ours()
    tried = places(vocabulary.pose, vocabulary.sums)
    assert found.met(tried, lambda place: place.values["q2"] < 0) == (1, ("elbow down",))
    assert found.met(tried, lambda place: True) == (2, ())
    assert found.met(tried, lambda place: place.values["q1"] < 0) == (0, ())
