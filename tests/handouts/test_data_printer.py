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
    ("unit", "alpha", "expected"),
    [
        ("rad", "pi/2", "\\tfrac{\\pi}{2}"),
        ("rad", "-pi/6", "-\\tfrac{\\pi}{6}"),
        ("rad", "pi/8", "\\tfrac{\\pi}{8}"),
        ("rad", "0.5", "0.5"),
        ("deg", "90", "90^{\\circ}"),
        ("deg", "-30", "-30^{\\circ}"),
        ("deg", "22.5", "22.5^{\\circ}"),
        ("deg", "beta - 10", "\\beta  - 10^{\\circ}"),
        ("deg", "beta", "\\beta "),
    ],
)
def test_angles_are_in_the_unit_of_the_file(unit: str, alpha: str, expected: str) -> None:
    """A file with pi has no degrees on its sheet, one with degrees no pi."""
    data, robot = printer(f"alpha: {alpha}", unit=unit)
    assert joined(data.angle(robot.joints[0].alpha)).tex == expected


def test_lengths_have_every_digit() -> None:
    data, robot = printer("a: 0.431812345678")
    assert joined(data.value(robot.joints[0].a)).tex == "0.431812345678"


@pytest.mark.parametrize(
    ("unit", "kind", "limits", "expected"),
    [
        ("rad", "revolute", "[-pi, pi/3]", "[-\\pi ,\\, \\tfrac{\\pi}{3}]\\,\\mathrm{rad}"),
        ("rad", "revolute", "[-3, 2]", "[-3,\\, 2]\\,\\mathrm{rad}"),
        ("rad", "prismatic", "[0, 0.5]", "[0,\\, 0.5]\\,\\mathrm{m}"),
        ("deg", "revolute", "[-180, 60]", "[-180^{\\circ},\\, 60^{\\circ}]"),
        ("deg", "revolute", "[0, 60]", "[0^{\\circ},\\, 60^{\\circ}]"),
        ("deg", "prismatic", "[0, 0.5]", "[0,\\, 0.5]\\,\\mathrm{m}"),
    ],
)
def test_limits_have_their_unit(unit: str, kind: str, limits: str, expected: str) -> None:
    data, robot = printer(f"limits: {limits}", kind, unit)
    assert joined(data.limits(robot.joints[0])).tex == expected


def test_a_joint_without_limits_has_a_dash() -> None:
    data, robot = printer("a: 1")
    assert joined(data.limits(robot.joints[0])).tex == "\\text{--}"


@pytest.mark.parametrize(
    ("limits", "expected"),
    [("[-2.5, 2]", "[-2{,}5;\\, 2]"), ("[-pi, 2]", "[-\\pi ,\\, 2]"), ("[-3, 2]", "[-3,\\, 2]")],
)
def test_a_list_with_a_decimal_comma_has_semicolons(limits: str, expected: str) -> None:
    _, robot = printer(f"limits: {limits}")
    data = DataPrinter(robot, Notation.of(robot, comma=True))
    assert joined(data.limits(robot.joints[0])).tex.startswith(expected)
