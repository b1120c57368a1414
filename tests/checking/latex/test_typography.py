"""What only moves ink goes, and nothing is shifted."""

from __future__ import annotations

import pytest

from derive.checking.latex.typography import cleaned


@pytest.mark.parametrize(
    ("typed", "left"),
    [
        (r"a_1 % a_2", "a_1"),
        (r"\left( a_1 \right.", "( a_1"),
        (r"\biggl[ a_1 \Bigr]", "[ a_1 ]"),
        (r"\label{eq:x} a_1 \tag{1} \nonumber", "a_1"),
        (r"\boxed{x = a_1}", "x = a_1"),
        (r"\underbrace{a_1 + a_2}_{\text{length}} c_1", "{a_1 + a_2} c_1"),
        (r"\frac{d}{d t} q_1{\left(t \right)}", r"\dot q_1"),
        (r"\frac{d^{2}}{d t^{2}} q_1(t)", r"\ddot q_1"),
        (r"\frac{d\theta_1}{dt} a_1", r"\dot {\theta_1} a_1"),
        ("\\theta _1'(t)^2", "\\theta _1\ue001 ^2"),
        (r"\operatorname{q_{1}}{\left(t \right)}", "{q_{1}}"),
        ("a\u00b7b \u2212 c", "a*b - c"),
        (r"\mathrm{sin}", r"\mathrm{sin}"),
    ],
)
def test_only_what_means_something_stays(typed: str, left: str) -> None:
    assert cleaned(typed).split() == left.split()
    assert len(cleaned(typed)) == len(typed)


def test_lines_stay_lines() -> None:
    assert cleaned("a % b\n\\left(c").count("\n") == 1


def test_t_is_a_name_where_the_robot_has_one() -> None:
    assert cleaned("q(t)", time=False) == "q(t)"
