"""The other convention: the same functions of motion, exactly and in numbers, and the same table on the way back."""

import random
from dataclasses import replace

import numpy as np
import pytest

from derive.mechanics.convention import Factor, convert, has_equal_poses
from derive.robot.description import Convention
from derive.robot.evaluate import parameter_values
from derive.robot.expression import ONE, ZERO, to_text
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.mechanics.arms import assert_close
from tests.random_robots import robot_text, swept, swept_catalogue
from tests.rows import robot_of_rows

FEW = ("stanford-deluca", "dh-modified-deluca", "planar-2r-perugia", "skeleton-modified")
OTHER = {Convention.STANDARD: Convention.MODIFIED, Convention.MODIFIED: Convention.STANDARD}
MOTORS = """
gravity: [gx, gy, -9.81]
links:
  - {mass: m1, com: [x1, y1, z1], inertia: {xx: 0.1, yy: 0.2, zz: 0.3, xy: 0.01, xz: 0.02, yz: 0.03},
      motor: {mass: u1, inertia: J1, ratio: 3}}
  - {mass: MASS, com: [x2, 0.2, 0], inertia: {yy: I2}, motor: {mass: u2, inertia: J2, ratio: 5},
      friction: {viscous: b2, coulomb: f2}}
  - {mass: 0.7, com: [0, 0, l3], armature: 0.25, motor: {mass: u3, inertia: J3, ratio: 7}}
"""
"""Rotors with mass at offset joints, everything symbolic."""


def motors(convention: str, mass: str = "m2", last: str = "R d: d3") -> Robot:
    """An arm whose rotors stand elsewhere in the other convention."""
    rows = f"R d: d1, a: a1, alpha: pi/2 | R d: d2, a: a2, alpha: beta | {last}, a: a3, alpha: -pi/2"
    return robot_of_rows(rows, MOTORS.replace("MASS", mass), name="motors", convention=convention)


def in_numbers(robot: Robot, seed: int) -> dict[str, np.ndarray]:
    """T, J, B, C, g and tau at some point, by the recursion that shares no code with the derivation."""
    rng = random.Random(seed)
    known = parameter_values(robot)
    values = {name: random.Random(f"{seed} {name}").uniform(0.3, 1.7) for name in robot_symbols(robot)}
    oracle = Oracle.of(robot, {name: value for name, value in values.items() if name not in known})
    q, qd, qdd = (np.array([rng.uniform(-2, 2) for _ in range(robot.n)]) for _ in range(3))
    asked = {"forward_kinematics": (q,), "jacobian": (q,)}
    if robot.has_dynamics:
        asked |= {"inertia_matrix": (q,), "coriolis_matrix": (q, qd), "gravity_vector": (q,)}
        asked |= {"inverse_dynamics": (q, qd, qdd)}
    return {name: oracle.evaluate(name, *point) for name, point in asked.items()}


def assert_same_functions(robot: Robot, other: Robot, seed: int = 3) -> None:
    ours, theirs = in_numbers(robot, seed), in_numbers(other, seed)
    for name, value in ours.items():
        assert_close(theirs[name], value)


@pytest.mark.parametrize("name", swept_catalogue(usual=FEW))
def test_every_built_in_robot_is_the_same_arm_and_comes_back_as_the_same_table(name: str) -> None:
    robot = Robot.load(name)
    there = convert(robot)
    assert there.result.convention is OTHER[robot.convention]
    assert there.notes == ()
    assert has_equal_poses(there)
    other = Robot.of(there.result)
    assert_same_functions(robot, other)
    back = convert(other, there.leaving).result
    assert Robot.of(back) == replace(robot, remarks=())
    assert convert(other).result.joints == robot.joints, "no built-in robot needs to be told its last row"


@pytest.mark.parametrize("seed", [*range(5), *swept(*range(5, 400))])
def test_random_robots_are_the_same_arm_and_come_back(seed: int) -> None:
    """Bases, tools, motors, degrees, millimetres, both conventions."""
    robot = Robot.from_text(robot_text(random.Random(seed)))
    there = convert(robot)
    other = Robot.of(there.result)
    assert_same_functions(robot, other, seed)
    back = Robot.of(convert(other, there.leaving).result)
    assert back.joints == robot.joints
    assert_same_functions(robot, back, seed)


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("last", ["R d: d3", "P theta: pi/3, d: q3 + d3"])
def test_rotors_with_mass_at_offset_joints_keep_the_dynamics(convention: str, last: str) -> None:
    robot = motors(convention, last=last)
    there = convert(robot)
    assert_same_functions(robot, Robot.of(there.result))
    way = "further" if convention == "standard" else "less far"
    said = [f"the rotor of joint {i} stands d{i} {way} along its axis in this convention" for i in (1, 2, 3)]
    assert [note.split(":")[0] for note in there.notes] == said
    back = convert(Robot.of(there.result), there.leaving).result
    assert [link.motor for link in back.links] == [link.motor for link in robot.links]
    assert back.links == robot.links


@pytest.mark.parametrize("mass", ["0", "0*m1"])
def test_a_link_without_mass_takes_the_mass_of_its_rotor(mass: str) -> None:
    of_file = motors("standard", mass=mass)
    robot = replace(of_file, parameters=(("x2", ONE),), runtime=("x2",))
    there = convert(robot)
    assert there.result.parameters == there.result.runtime == (), "a massless body is nowhere"
    assert to_text(there.result.links[1].mass) == "u3"
    assert there.result.links[2].motor is not None
    assert there.result.links[2].motor.mass == ZERO
    assert there.notes[-1].endswith("link 2, without mass, has the rotor's mass now")
    assert_same_functions(robot, Robot.of(there.result))


def test_the_last_factor_goes_into_the_tool_and_the_first_into_the_base() -> None:
    robot = motors("standard")
    there = convert(robot)
    assert there.leaving == Factor(robot.joints[-1].a, robot.joints[-1].alpha)
    assert [[to_text(cell) for cell in row] for row in there.result.tool] == [
        ["1", "0", "0", "a3"], ["0", "0", "1", "0"], ["0", "-1", "0", "0"], ["0", "0", "0", "1"]
    ]  # fmt: skip
    assert there.result.joints[0].a == there.result.joints[0].alpha == ZERO
    assert there.factors == (Factor(), *(Factor(joint.a, joint.alpha) for joint in robot.joints))
    other = convert(motors("modified"))
    assert to_text(other.result.base[0][3]) == "a1"
    assert other.leaving == Factor(robot.joints[0].a, robot.joints[0].alpha)


def test_any_factor_may_be_taken_out_of_a_tool() -> None:
    robot = motors("modified")
    for factor in (Factor(robot.joints[1].a, robot.joints[1].alpha), Factor(robot.joints[0].d, robot.joints[2].alpha)):
        there = convert(robot, factor)
        assert there.entering == factor
        assert (there.result.joints[-1].a, there.result.joints[-1].alpha) == (factor.a, factor.alpha)
        assert_same_functions(robot, Robot.of(there.result))


@pytest.mark.parametrize(
    ("x", "c", "s", "alpha"),
    [
        ("l", "cos(beta)", "sin(beta)", "beta"),
        ("l", "cos(beta)", "-sin(beta)", "-beta"),
        ("l", "-cos(beta)", "-sin(beta)", "beta + pi"),
        ("0.3", "sqrt(2)/2", "sqrt(2)/2", "pi/4"),
        ("0", "-1", "0", "pi"),
        ("0", "cos(pi/9)", "sin(pi/9)", "pi/9"),
        ("0.1", "3/5", "4/5", "0"),
        ("0.1", "0.9999999", "0.0004472136", "0"),
    ],
)
def test_a_tool_that_is_a_factor_becomes_the_last_row(x: str, c: str, s: str, alpha: str) -> None:
    tool = f"tool: [[1, 0, 0, {x}], [0, {c}, -({s}), 0], [0, {s}, {c}, 0], [0, 0, 0, 1]]"
    robot = robot_of_rows("R", tool, convention="modified")
    there = convert(robot)
    (row,) = there.result.joints
    assert to_text(row.alpha) == alpha
    if alpha != "0":
        assert to_text(row.a) == to_text(robot.tool[0][3])
        assert all(to_text(there.result.tool[i][j]) == str(int(i == j)) for i in range(4) for j in range(4))
    else:
        assert there.result.tool == robot.tool
    assert_same_functions(robot, Robot.of(there.result))
