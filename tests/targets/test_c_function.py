"""Functions in C: their parts take what they need and no more, limits and lengths are those of the robot."""

import re
from fractions import Fraction

from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import PARAMETER
from derive.programs.tape.value import Value
from derive.targets.c import c_inverse
from derive.targets.c_function import c_function
from tests.targets.generated_models import small_program, source_of
from tests.targets.test_inverse import elbow, program_of


def test_work_goes_to_the_part_that_needs_nothing_more() -> None:
    graph = Graph()
    angle, length = Value(graph, graph.input("q", 0)), Value(graph, graph.input(PARAMETER, 0))
    program = small_program(graph, [angle.cos() * length.sqrt(), (angle + length).sin()])
    (text,) = [c_function(function, ["a1"]) for function in program]
    assert (text.used, text.constant_count, text.angle_count) == (("q",), 2, 2)
    assert "sqrt" in " ".join(text.constants["body"] + text.constants["results"])
    assert arrays(text.constants["declaration"]) == ["params", "k"]
    assert arrays(text.angles["declaration"]) == ["q", "k", "angles"]
    assert arrays(text.lane["declaration"]) == ["sines", "cosines", "k", "result"]


def test_an_argument_without_a_say_is_declared_and_not_loaded() -> None:
    graph = Graph()
    (text,) = [c_function(f, ()) for f in small_program(graph, [Value(graph, graph.number(Fraction(3)))])]
    assert (text.used, text.unused) == ((), text.arguments)
    assert arrays(text.declaration) == [*text.arguments, "result"]
    assert arrays(text.block_declaration) == ["result"]


def arrays(declaration: str) -> list[str]:
    return re.findall(r"\*(?:restrict )?(\w+)", declaration)


def test_inverse_kinematics_has_the_limits_and_lengths_of_the_robot() -> None:
    program = program_of(elbow())
    assert program.inverse is not None
    text = c_inverse(program.inverse, source_of(elbow(), program))
    assert text["lower"] == "-2.0, -INFINITY, -INFINITY, -1.0"
    assert text["upper"] == "2.0, INFINITY, INFINITY, 1.0"
    assert text["revolute"] == "1, 1, 1, 0"
    assert text["size"] == text["branches"] * 4
    assert {load["name"]: load["width"] for load in text["loads"]}["T"] == 16
    assert {load["name"] for load in text["loads"] if load["is_optional"]} <= {"near"}
