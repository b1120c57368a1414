"""Degrees and millimetres become radians and metres exactly; names and factors stay what they are."""

import math

import pytest

from derive.errors import DeriveError, Location, RobotFileError
from derive.robot.cells import angle_in_radians, joint_values
from derive.robot.description import FileUnits
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, to_text
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot


def robot(row: str, angle: str = "deg", length: str = "mm", extra: str = "") -> Robot:
    return Robot.from_text(
        f"name: r\nconvention: standard\nunits: {{angle: {angle}, length: {length}}}\njoints:\n  - {row}\n{extra}"
    )


def value(expression: Expression, **values: float) -> float:
    return evaluate(expression, values)


@pytest.mark.parametrize(
    ("key", "cell", "converted"),
    [
        ("alpha", "90", "pi/2"), ("alpha", "-45", "-pi/4"), ("alpha", "180/7", "pi/7"), ("alpha", "beta", "beta"),
        ("alpha", "beta + 90", "beta + pi/2"), ("alpha", "2*beta - 30", "2*beta - pi/6"),
        ("alpha", "-(beta + 90)", "-beta - pi/2"), ("alpha", "2*30 + beta/2", "pi/3 + beta/2"), ("alpha", "0", "0"),
        ("alpha", "90*sin(30)", "sin(pi/6)*pi/2"), ("a", "431.8", "2159/5000"), ("a", "a1", "a1"),
        ("a", "a1 + 20", "a1 + 1/50"), ("a", "2*a1 - 20", "2*a1 - 1/50"), ("a", "2*(a1 + 20)", "2*a1 + 1/25"),
        ("a", "sqrt(2)*100", "sqrt(2)/10"), ("a", "100*sin(30)", "sin(pi/6)/10"),
        ("a", "100*sin(pi/6)", "sin(pi/6)/10"), ("a", "a1*cos(beta + 30)", "a1*cos(beta + pi/6)"),
        ("a", "a1*1.5", "3*a1/2"),
    ],
)  # fmt: skip
def test_plain_numbers_are_degrees_in_angles_and_millimetres_in_lengths(key: str, cell: str, converted: str) -> None:
    assert to_text(getattr(robot(f"{{type: revolute, {key}: {cell}}}").joints[0], key)) == converted


@pytest.mark.parametrize(
    ("row", "sign", "theta", "d"),
    [("revolute, theta: -q1 + 90", -1, "pi/2", "0"), ("prismatic, d: q1 + 100, theta: b + 90", 1, "b + pi/2", "1/10")],
)
def test_offsets_are_in_degrees_or_millimetres(row: str, sign: int, theta: str, d: str) -> None:
    joint = robot(f"{{type: {row}}}").joints[0]
    assert (joint.sign, to_text(joint.theta), to_text(joint.d)) == (sign, theta, d)


ANGLES = ("pi/2", "beta + pi", "2*pi/3")


@pytest.mark.parametrize(
    "cell", [*(f"alpha: {angle}" for angle in ANGLES), *(f"theta: q1 + {a}" for a in ANGLES), "limits: [-90, pi]"]
)
def test_pi_in_an_angle_cell_in_degrees_is_refused_with_a_hint(cell: str) -> None:
    with pytest.raises(RobotFileError, match=r":5:\d+: joints row 1, .*pi in an angle cell.*write 90 for pi/2"):
        robot(f"{{type: revolute, {cell}}}")


def test_limits_follow_the_type_of_the_joint() -> None:
    revolute = robot("{type: revolute, limits: [-180, 90]}").joints[0]
    prismatic = robot("{type: prismatic, limits: [-180, 90]}").joints[0]
    assert [value(limit) for limit in revolute.limits or ()] == pytest.approx([-math.pi, math.pi / 2])
    assert [value(limit) for limit in prismatic.limits or ()] == pytest.approx([-0.18, 0.09])


def test_translations_of_frames_and_centres_of_mass_are_lengths_and_all_else_is_si() -> None:
    loaded = robot(
        "{type: revolute}",
        extra="tool: [[0, -1, 0, 100], [1, 0, 0, L + 5], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
        "gravity: [0, 0, -9.81]\n"
        "links: [{mass: 3, com: [100, c, 0], inertia: {zz: 0.5}, armature: 2, friction: {viscous: 7}}]\n"
        "parameters: {L: 2}\n",
    )
    assert [to_text(row[3]) for row in loaded.tool] == ["1/10", "L + 1/200", "0", "1"]
    assert [to_text(row[1]) for row in loaded.tool] == ["-1", "0", "0", "0"]
    link = loaded.links[0]
    assert [to_text(cell) for cell in (link.mass, *link.com, link.inertia.zz)] == ["3", "1/10", "c", "0", "1/2"]
    assert [to_text(cell) for cell in (link.armature, link.viscous)] == ["2", "7"]
    assert to_text(loaded.gravity[2]) == "-981/100"
    assert to_text(dict(loaded.parameters)["L"]) == "2"
    loaded = robot("{type: revolute}", extra="gravity: [9.81*sin(30), 0, -9.81*cos(30)]\n")
    assert value(loaded.gravity[0]) == pytest.approx(4.905)


def cell(text: str) -> Expression:
    return parse_expression(text, Location("arm.yaml"))


@pytest.mark.parametrize(
    ("text", "radians"),
    [
        ("30*t", "pi*t/6"),
        ("30 + 10*t", "pi/6 + pi*t/18"),
        ("45*sin(2*t)", "pi/4*sin(2*t)"),
        ("a + 90*t", "a + pi/2*t"),
        ("a*t", "a*t"),
    ],
)
def test_terms_of_names_without_a_unit_are_in_the_units_of_the_file(text: str, radians: str) -> None:
    """The time in a formula is such a name."""
    found = angle_in_radians(cell(text), FileUnits(degrees=True), frozenset({"t"}))
    for t in (0.0, 0.7, 2.0):
        values = {"t": t, "a": 0.4}
        assert evaluate(found, values) == pytest.approx(evaluate(cell(radians), values), rel=1e-15)


def test_joint_values_are_in_the_units_of_the_file() -> None:
    rows = "joints: [{type: revolute}, {type: prismatic}]\n"
    head = "name: arm\nconvention: standard\n"
    robot = Robot.from_text(head + "units: {angle: deg, length: mm}\n" + rows)
    assert [evaluate(v, {}) for v in joint_values(robot, ["90", "250"])] == pytest.approx([math.pi / 2, 0.25])
    plain = Robot.from_text(head + rows)
    assert [evaluate(v, {}) for v in joint_values(plain, ["pi/2", "1/4"])] == pytest.approx([math.pi / 2, 0.25])
    for texts in (["1"], ["1", "a1"], ["1", "2, 3"]):
        with pytest.raises(DeriveError):
            joint_values(plain, texts)
