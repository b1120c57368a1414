"""Cells of the robot file in print."""

from __future__ import annotations

import pytest

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import joined
from derive.handouts.notation.printer import DataPrinter
from derive.robot.robot import Robot

ARM = "name: arm\nconvention: standard\nunits: {{angle: {unit}}}\njoints:\n  - {{type: {kind}, {cells}}}\n"


def printer(cells: str, kind: str = "revolute", unit: str = "rad") -> tuple[DataPrinter, Robot]:
    robot = Robot.from_text(ARM.format(cells=cells, kind=kind, unit=unit))
    return DataPrinter(robot, Notation.of(robot, robot.handout.notation)), robot


@pytest.mark.parametrize(
    ("alpha", "expected"),
    [
        ("pi/2", "\\tfrac{\\pi}{2}"),
        ("-pi/6", "-\\tfrac{\\pi}{6}"),
        ("pi/8", "22.5^{\\circ}"),
        ("-pi/5", "-36^{\\circ}"),
    ],
)
def test_usual_angles_are_multiples_of_pi_and_others_in_degrees(alpha: str, expected: str) -> None:
    data, robot = printer(f"alpha: {alpha}")
    assert joined(data.angle(robot.joints[0].alpha)).tex == expected


def test_lengths_have_every_digit() -> None:
    data, robot = printer("a: 0.431812345678")
    assert joined(data.value(robot.joints[0].a)).tex == "0.431812345678"


@pytest.mark.parametrize(
    ("kind", "limits", "end"),
    [
        ("revolute", "[-pi, pi/3]", "60^{\\circ}]"),
        ("revolute", "[-3, 2]", "2]\\;\\mathrm{rad}"),
        ("prismatic", "[0, 0.5]", "0.5]\\;\\mathrm{m}"),
    ],
)
def test_limits_have_their_unit(kind: str, limits: str, end: str) -> None:
    data, robot = printer(f"limits: {limits}", kind)
    assert joined(data.limits(robot.joints[0])).tex.endswith(end)


def test_a_joint_without_limits_has_a_dash() -> None:
    data, robot = printer("a: 1")
    assert joined(data.limits(robot.joints[0])).tex == "\\text{--}"


@pytest.mark.parametrize(
    ("limits", "expected"),
    [("[-2.5, 2]", "[-2{,}5;\\, 2]"), ("[-pi, pi/3]", "[-180^{\\circ},\\, 60^{\\circ}]"), ("[-3, 2]", "[-3,\\, 2]")],
)
def test_a_list_with_a_decimal_comma_has_semicolons(limits: str, expected: str) -> None:
    _, robot = printer(f"limits: {limits}")
    data = DataPrinter(robot, Notation.of(robot, comma=True))
    assert joined(data.limits(robot.joints[0])).tex.startswith(expected)
