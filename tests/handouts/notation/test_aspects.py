"""Aspects read as text and JSON."""

import json

from derive.handouts.notation.singularities import aspects_parts, aspects_text
from derive.handouts.notation.text import TextPrinter
from derive.model.model import Model
from derive.robot.robot import Robot

CUSPIDAL = """name: arm
convention: standard
joints:
  - {type: revolute, a: 1, alpha: -pi/2}
  - {type: revolute, d: 1, a: 2, alpha: pi/2}
  - {type: revolute, a: 1.5}
"""


def text(robot: Robot) -> list[str]:
    return aspects_text(Model(robot).aspects, TextPrinter(robot, None).doprint)


def test_each_solution_is_listed_with_its_signs() -> None:
    found = text(Robot.load("planar-2r-perugia"))
    assert found[0].startswith("2 aspects")
    assert found[1:5] == ["   1. s2", "its sign in each solution:", "   +  elbow down", "   -  elbow up"]
    assert found[-1].startswith("looked at with a1 = ")


def test_a_cuspidal_arm_is_called_so_with_the_path() -> None:
    robot = Robot.from_text(CUSPIDAL)
    aspects = Model(robot).aspects
    found = aspects_text(aspects, TextPrinter(robot, None).doprint)
    (first,) = [number for number, line in enumerate(found) if line.startswith("cuspidal")]
    assert [line.split()[0] for line in found[first + 2 :]] == ["q1", "q2", "q3"]
    rounded = aspects_text(aspects, TextPrinter(robot, None).doprint, 3)[first + 2 :]
    for exact, short in zip(found[first + 2 :], rounded, strict=True):
        assert [f"{float(value):.3g}" for value in exact.split()[1:]] == short.split()[1:]
    parts = json.loads(json.dumps(aspects_parts(aspects)))
    assert parts["cuspidal"] is True
    assert all(len(corner) == 3 for corner in parts["path"])


def test_an_arm_without_aspects_says_why() -> None:
    assert text(Robot.load("thumb")) == ["aspects cannot be computed: no single determinant decides the rank of J"]
