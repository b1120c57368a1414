"""``units: {parameters: file}``: numbers of symbols are in the units of their cells, wherever somebody types them."""

import math
import random
from dataclasses import replace
from pathlib import Path

import pytest

import derive
from derive.errors import DeriveError, RobotFileError
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import to_text
from derive.robot.names import without_lost_symbols
from derive.robot.robot import Robot
from derive.robot.units import located_expressions
from derive.robot.writer import robot_text
from tests.cli.command import derive as command
from tests.random_robots import seeds

HEAD = "name: arm\nconvention: standard\nunits: {angle: deg, length: mm}\n"
ARM = (
    HEAD
    + """\
joints:
  - {type: revolute, d: d1, alpha: 90}
  - {type: revolute, a: 2*a2, limits: [-90, top]}
  - {type: revolute, theta: q3 + beta, a: sqrt(2)*a3 + 20, alpha: -90}
  - {type: prismatic, d: q4 + a4*cos(gamma), limits: [0, s]}
tool: [[1, 0, 0, t], [0, cos(delta), -sin(delta), 0], [0, sin(delta), cos(delta), 5], [0, 0, 0, 1]]
gravity: [0, 0, -g]
links:
  - {mass: m1, com: [0, l1/2, 0], inertia: {xx: m1*l1**2/12}, friction: {viscous: b}}
  - {mass: 1, com: [a2, 0, 0], motor: {inertia: J, ratio: k}}
  - {mass: 1}
  - {mass: 1}
parameters:
  {d1: 400, a2: 175, a3: 150, a4: 80, top: 120, beta: 30, gamma: 60, s: 200, t: 12.5, delta: 45,
   m1: 3, l1: 300, g: 9.81, b: 0.2, J: 0.001, k: 50}
figure: {q: [0, 30, 0, 100]}
"""
)
SI = {"d1": 0.4, "a2": 0.175, "a3": 0.15, "a4": 0.08, "s": 0.2, "t": 0.0125, "l1": 0.3, "m1": 3.0, "g": 9.81}


def in_file(text: str) -> str:
    return text.replace("length: mm}", "length: mm, parameters: file}")


def numbers(robot: Robot) -> dict[str, float]:
    return {name: float(number) for name, number in parameter_values(robot).items()}


def test_a_number_is_in_the_unit_of_the_cells_of_its_symbol_and_all_else_is_si() -> None:
    robot = Robot.from_text(in_file(ARM))
    found = numbers(robot)
    assert {name: found[name] for name in SI} == pytest.approx(SI, rel=1e-15)
    angles = {name: to_text(value) for name, value in robot.parameters if name in ("top", "beta", "gamma", "delta")}
    assert angles == {"top": "2*pi/3", "beta": "pi/6", "gamma": "pi/3", "delta": "pi/4"}
    assert robot.remarks == ()


def test_it_is_the_arm_whose_numbers_stand_in_the_cells() -> None:
    """An independent oracle: the same text with every symbol replaced by its number."""
    text = ARM[: ARM.index("parameters:")]
    robot = Robot.from_text(in_file(ARM))
    spelt = {"2*a2": "350", "sqrt(2)*a3": "sqrt(2)*150", "a4*cos(gamma)": "40", "[a2,": "[175,", "l1/2": "150"}
    spelt |= {"m1*l1**2/12": "0.0225", "m1": "3", "d1": "400", "top": "120", "beta": "30", "delta": "45", "s]": "200]"}
    spelt |= {"0, t]": "0, 12.5]", "-g": "-9.81", ": b}": ": 0.2}", "J,": "0.001,", "k}": "50}"}
    for cell, written in spelt.items():
        text = text.replace(cell, written)
    plain = Robot.from_text(text)
    pairs = zip(located_expressions(robot), located_expressions(plain), strict=True)
    for (path, ours), (_, theirs) in pairs:
        assert evaluate(ours, parameter_values(robot)) == pytest.approx(evaluate(theirs, {}), abs=1e-15), path


def test_without_the_key_numbers_stay_si_and_what_no_arm_is_is_remarked_on() -> None:
    robot = Robot.from_text(ARM)
    assert numbers(robot)["d1"] == 400.0
    told = {remark.found.split(":")[0].split(", ")[-1]: remark.remedy for remark in robot.remarks}
    assert {"d1", "a2", "a3", "a4", "s", "l1", "top", "beta", "gamma", "delta"} <= set(told)
    assert not {"m1", "g", "b", "J", "k"} & set(told)
    assert all("parameters: file" in remedy for remedy in told.values())


ROW = "joints:\n  - {type: revolute, a: a1}\n"


@pytest.mark.parametrize(
    ("units", "rest", "remarked"),
    [
        ("length: mm", "parameters: {a1: 0.4}", []),
        ("length: mm", "parameters: {a1: 19}", []),
        ("length: mm", "parameters: {a1: 400}", ["a1"]),
        ("length: mm", "parameters: {a1: -400}", ["a1"]),
        ("length: mm", "parameters: {a1: 0.004}", ["a1"]),
        ("length: m", "parameters: {a1: 0.004}", []),
        ("length: mm, parameters: file", "parameters: {a1: 400}", []),
        ("length: mm, parameters: file", "parameters: {a1: 0.4}", ["a1"]),
        ("length: mm, parameters: si", "parameters: {a1: 400}", ["a1"]),
        ("length: mm", "links: [{com: [k*c, 0, 0]}]\nparameters: {a1: 0.4, k: 2, c: 200}", ["c"]),
        ("length: mm", "figure: {values: {a1: 400}}", ["a1"]),
        ("length: mm", "links: [{com: [1/(a1 - c), 0, 0]}]\nfigure: {values: {a1: 400, c: 400}}", ["a1", "c"]),
        ("length: mm", "tool: [[1,0,0,30000],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\nparameters: {a1: 0.4}", []),
    ],
)
def test_sizes_of_arms(units: str, rest: str, remarked: list[str]) -> None:
    robot = Robot.from_text(f"name: r\nconvention: standard\nunits: {{{units}}}\n{ROW}{rest}\n")
    assert [remark.found.split(":")[0].split(" ")[-1] for remark in robot.remarks] == remarked
    assert all("parameters: file" in remark.remedy for remark in robot.remarks)


def test_radians_among_degrees_of_parameters_are_remarked_on() -> None:
    text = in_file(HEAD) + "joints:\n  - {type: revolute, alpha: beta}\nparameters: {beta: 1.5708}\n"
    (remark,) = Robot.from_text(text).remarks
    assert "angles of this file are in degrees; if radians are meant write 90" in str(remark)


@pytest.mark.parametrize(
    ("row", "rest", "words"),
    [
        ("a: x, alpha: x", "parameters: {x: 1}", "'x' stands for a length and an angle"),
        ("a: x", "links: [{mass: x}]\nparameters: {x: 1}", "'x' stands for a quantity in SI units and a length"),
        ("a: k*x", "parameters: {k: 2, x: 100}", "'k' stands in products alone"),
        ("a: sqrt(x**2 + y**2)", "parameters: {x: 3, y: 4}", "'x' stands in products alone"),
        ("a: 1", "links: [{mass: 1, inertia: {zz: l**2}}]\nparameters: {l: 300}", "'l' stands in products alone"),
        ("alpha: x", "parameters: {x: pi/2}", "pi in an angle"),
        ("alpha: x", "figure: {values: {x: pi/2}}", "pi in an angle"),
    ],
)
def test_a_symbol_without_one_clear_unit_is_refused_at_its_number(row: str, rest: str, words: str) -> None:
    text = f"{HEAD}joints:\n  - {{type: revolute, {row}}}\n{rest}\n"
    Robot.from_text(text)  # SI units are clear
    with pytest.raises(RobotFileError, match=r"^<text>:\d+:\d+: .*" + words):
        Robot.from_text(in_file(text))


def test_products_tell_nothing_where_the_symbol_stands_by_itself_too_or_units_make_no_difference() -> None:
    text = f"{HEAD}joints:\n  - {{type: revolute, a: x, d: k*x}}\nparameters: {{x: 100, k: 2}}\n"
    with pytest.raises(RobotFileError, match="'k' stands in products alone"):
        Robot.from_text(in_file(text))
    robot = Robot.from_text(in_file(text.replace("k*x", "2*x*cos(k)")))
    assert numbers(robot) == pytest.approx({"x": 0.1, "k": math.radians(2)})
    degrees = in_file(text).replace("length: mm, ", "")
    assert numbers(Robot.from_text(degrees)) == {"x": 100.0, "k": 2.0}


def test_whatever_is_typed_beside_the_file_is_in_its_units(tmp_path: Path) -> None:
    text = in_file(HEAD) + "joints:\n  - {type: revolute, a: a1, alpha: beta}\n  - {type: revolute, a: 300}\n"
    (tmp_path / "arm.yaml").write_text(text)
    robot = Robot.from_text(text)
    point = {"a1": 500, "beta": 90}
    assert float(derive.Model(robot).at("p[3]", [0, 90], values=point)) == pytest.approx(0.3)
    done = command("show", "arm.yaml", "p[1]", "--at", "0, 0, a1=500, beta=90", folder=tmp_path)
    assert done.stdout.splitlines()[-1] == "p[1] = 0.8"
    assert 'xyz="0.5 0 0"' in derive.export(robot, "urdf", values=point)
    plan = "robot: arm.yaml\npoints: {a: [0, 0], b: [90, 0]}\npath: [a, {to: b, time: 1}]\n"
    (tmp_path / "plan.yaml").write_text(plan + "values: {a1: 500, beta: 90}\n")
    assert derive.Motion.load(tmp_path / "plan.yaml").poses(0.0)[0, 3] == pytest.approx(0.8)
    with pytest.raises(DeriveError, match="pi in the value"):
        derive.Model(robot).at("p", [0, 0], values={"beta": "pi/2"})


@pytest.mark.parametrize("seed", seeds(12, usual=4))
def test_written_converted_and_exported_it_is_the_same_arm(seed: int) -> None:
    source = random.Random(seed)
    text = in_file(ARM)
    for name in ("d1", "a2", "a3", "t", "l1", "beta"):
        text = text.replace(f"{name}: ", f"{name}: {source.uniform(1, 80):.3g}*", 1)
    robot = Robot.from_text(text)
    again = Robot.from_text(robot_text(robot))
    assert robot_text(again) == robot_text(robot)
    assert (again.parameters, again.units, again.joints) == (robot.parameters, robot.units, robot.joints)
    other = derive.Robot.of(robot).convert("modified")
    back = Robot.from_text(robot_text(other))
    assert numbers(back) == pytest.approx(numbers(robot))
    assert float(derive.Model(back).at("p[1]", [10, 20, 30, 40])) == pytest.approx(
        float(derive.Model(robot).at("p[1]", [10, 20, 30, 40])), abs=1e-12
    )


def test_a_symbol_that_has_lost_its_unit_has_a_number_in_si_units() -> None:
    robot = Robot.from_text(in_file(HEAD) + ROW + "parameters: {a1: 400}\n")
    (joint,) = robot.joints
    squared = Robot.from_text(HEAD + "joints:\n  - {type: revolute, a: a1*a1}\n").joints[0].a
    changed = without_lost_symbols(robot, replace(robot, joints=(replace(joint, a=squared),)))
    assert not changed.units.parameters
    assert "a1: 0.4" in robot_text(changed)
    assert "parameters: file" not in robot_text(changed)


def test_tables_are_printed_in_the_units_of_the_file() -> None:
    robot = Robot.from_text(in_file(ARM))
    shown = str(robot)
    assert "numbers in deg and mm" in shown
    assert "sqrt(2)*a3 + 20" in shown
    assert "-90 to top" in shown
