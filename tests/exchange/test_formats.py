"""Formats by name, and what is said about an export."""

from __future__ import annotations

import pytest

from derive.errors import DeriveError
from derive.exchange.formats import FORMS, GIVEN, exported
from derive.robot.robot import Robot
from tests.exchange.arms import EVERY, numeric


def test_every_format_says_or_names_what_a_robot_has() -> None:
    assert all(set(form.lacks) <= set(GIVEN) for form in FORMS.values())
    assert FORMS["csv"].lacks == ()


@pytest.mark.parametrize("to", FORMS)
def test_every_robot_has_every_format(to: str) -> None:
    for name in EVERY[::4]:
        made = exported(numeric(name), to)
        assert name in made.text
        assert all(remark in made.text for remark in made.remarks)


@pytest.mark.parametrize(
    ("to", "inertia", "message"),
    [
        ("udf", "given", "no format 'udf'; allowed: urdf, mjcf, rtb, corke, rigidbodytree, csv; did you mean 'urdf'?"),
        ("urdf", "real", "no choice of inertia 'real'; allowed: given, possible"),
    ],
)
def test_an_unknown_word_gets_one_message(to: str, inertia: str, message: str) -> None:
    with pytest.raises(DeriveError) as caught:
        exported(Robot.load("kuka-kr5"), to, inertia)
    assert str(caught.value) == message
