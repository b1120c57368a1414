"""Bodies and frames of a robot, placed for other programs in formats that are not MuJoCo's; a URDF comes back."""

from dataclasses import replace
from fractions import Fraction
from xml.etree import ElementTree as Xml

import numpy as np
import pytest
from flint import arb

from derive.errors import DeriveError, Location
from derive.exchange.arm import arm_of
from derive.exchange.body_chain import RigidBody, body_chain, is_world, quaternion, roll_pitch_yaw
from derive.exchange.certificate import ball
from derive.exchange.formats import FORMS, GIVEN, exported
from derive.exchange.numeric import angle_text, text, with_numbers, with_positive_axes
from derive.exchange.reading.urdf import read_urdf
from derive.exchange.robot_of_arm import carried_table
from derive.exchange.to_xml import rod
from derive.mechanics.space import WORLD, Frame, exactly, unit, vector
from derive.mechanics.vectors import Symmetric
from derive.robot.description import Convention
from derive.robot.expression import Pi, multiply, number
from derive.robot.names import robot_symbols
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import EVERY, SWEEP, dressed, numeric, uneven
from tests.exchange.urdfs import J, Reading, imported, turned, urdf
from tests.rows import robot_of_rows


def matrix(frame: Frame) -> np.ndarray:
    return np.array([[float(axis[k]) for axis in (frame.x, frame.y, frame.z)] for k in range(3)])


@pytest.mark.parametrize("x", [(1, 2, 3), (0, 0, 1), (0, 0, -1), (-1, 0, 0), (0, -1, 0)])
def test_roll_pitch_yaw_and_quaternion_are_the_rotation(x: tuple[int, int, int]) -> None:
    with exactly():
        first = unit(vector(x))
        z = unit(vector((-x[1], x[0], 0) if x[0] or x[1] else (0, 1, 0)))
        frame = Frame.of(vector((0, 0, 0)), first, z)
        (r, p, y), (w, i, j, k) = map(float, roll_pitch_yaw(frame)), map(float, quaternion(frame))
    assert np.abs(turned(2, y) @ turned(1, p) @ turned(0, r) - matrix(frame)).max() < 1e-15
    cross = np.array([[0, -k, j], [k, 0, -i], [-j, i, 0]])
    assert np.abs(np.eye(3) + 2 * w * cross + 2 * cross @ cross - matrix(frame)).max() < 1e-15


def test_bodies_that_exist_are_possible_and_points_rods_and_plates_are_limits_of_them() -> None:
    with exactly():
        one = RigidBody(arb(1), vector((0, 0, 0)), Symmetric(*vector((2, 3, 4)), arb(0), arb(0), arb(0)))
        assert one.is_possible
        assert not RigidBody(arb(-1), one.com, one.inertia).is_possible
        assert not RigidBody(one.mass, one.com, replace(one.inertia, zz=arb(6))).is_possible
        links = numeric("puma560-corke").links
        assert [i for i, body in enumerate(map(RigidBody.of, links), 1) if not body.is_possible] == [1, 3]
    with exactly():
        for mass, moments in ((1, (0, 0, 0)), (1, (0, 3, 3)), (1, (1, 3, 4)), (0, (0, 0, 0)), (0, (1, 2, 2))):
            inertia = Symmetric(*vector(moments), arb(0), arb(0), arb(0))
            assert RigidBody(arb(mass), vector((0, 0, 0)), inertia).is_possible


def test_the_drag_of_rotors_is_known_where_axes_keep_their_angles() -> None:
    with exactly():
        scara = body_chain(dressed("scara-matlab", rotors=True)).segments
        puma = body_chain(dressed("puma560-corke", rotors=True)).segments
    assert [s.rotor and s.rotor.drag for s in scara] == [(), (1.0,), (-1.0, -1.0), (-1.0, -1.0, 0.0)]
    assert [s.rotor is not None and s.rotor.drag is None for s in puma] == [False, False, False, True, True, True]
    with exactly():
        assert is_world(WORLD)
        assert not is_world(body_chain(numeric("skeleton")).tool) or not is_world(body_chain(numeric("skeleton")).base)


@pytest.mark.parametrize("to", FORMS)
def test_every_robot_has_every_format_which_says_or_names_what_it_has(to: str) -> None:
    assert set(FORMS[to].lacks) <= set(GIVEN)
    assert bool(FORMS[to].lacks) is (to != "csv")
    for name in EVERY[::4]:
        made = exported(numeric(name), to)
        assert name in made.text
        assert all(remark in made.text for remark in made.remarks)


@pytest.mark.parametrize(
    ("to", "inertia", "message"),
    [
        ("udf", "given", "unknown format 'udf'; allowed: urdf, mjcf, rtb, corke, .* did you mean 'urdf'?"),
        ("urdf", "real", "unknown choice of inertia 'real'; allowed: given, possible"),
    ],
)
def test_an_unknown_word_gets_one_message(to: str, inertia: str, message: str) -> None:
    with pytest.raises(DeriveError, match=message):
        exported(Robot.load("kuka-kr5"), to, inertia)


ARM = robot_of_rows("R d: h, a: 2*h, alpha: pi/2, limits: [-w, w] | P a: b/c", "parameters: {h: 0.3, c: 0.5}")


def test_numbers_of_the_file_and_of_the_user_take_the_place_of_all_symbols() -> None:
    robot = with_numbers(ARM, {"b": number("0.25"), "w": number(2), "c": number("0.125")})
    assert not robot_symbols(robot)
    assert [robot.joints[0].d, robot.joints[0].a, robot.joints[1].a] == [number("0.3"), number("0.6"), number(2)]
    assert robot.joints[0].limits == (number(-2), number(2))


def test_symbols_without_numbers_and_cells_without_values_are_refused() -> None:
    with pytest.raises(DeriveError, match=r"arm: symbols without a number: b, w; .*; .*--values b=0\.5,w=0\.5"):
        with_numbers(ARM)
    with pytest.raises(DeriveError, match="b/c has no finite value"):
        with_numbers(ARM, {"b": number(1), "w": number(1), "c": number(0)})


@pytest.mark.parametrize(
    ("cell", "digits", "angle"),
    [
        ("0.4318", "0.4318", "0.4318"),
        ("-pi/2", "-1.5707963267948966", "-pi/2"),
        ("sqrt(2)/2", "0.70710678118654752", "0.70710678118654752"),
        ("pi + 1", "4.1415926535897932", "4.1415926535897932"),
        ("1/3", "0.33333333333333333", "0.33333333333333333"),
    ],
)
def test_numbers_are_written_with_seventeen_digits(cell: str, digits: str, angle: str) -> None:
    with exactly():
        expression = parse_expression(cell, Location("<test>"))
        assert (text(ball(expression)), angle_text(expression)) == (digits, angle)


@pytest.mark.parametrize("name", ["stanford-deluca", "skeleton-modified", "skeleton-root"])
def test_axes_turned_around_move_the_same_arm(name: str) -> None:
    robot = dressed(name, rotors=True)
    random = np.random.default_rng(2)
    for signs in random.choice([-1, 1], (4, robot.n)):
        cells = {"theta": number("0.4"), "d": number("0.3")}
        joints = (replace(joint, sign=int(sign), **cells) for joint, sign in zip(robot.joints, signs, strict=True))
        arm = replace(robot, joints=tuple(joints))
        made = with_positive_axes(arm)
        assert all(joint.sign == 1 for joint in made.joints)
        q, qd, qdd = random.uniform(-1, 1, (3, robot.n))
        ours, theirs = Oracle.of(arm), Oracle.of(made)
        for function, given in (("forward_kinematics", (q,)), ("inverse_dynamics", (q, qd, qdd))):
            expected = ours.evaluate(function, *given)
            assert np.abs(theirs.evaluate(function, *given) - expected).max() < 1e-13 * max(1, np.abs(expected).max())


@pytest.mark.parametrize("name", SWEEP)
def test_pinocchio_reads_the_same_poses_and_torques(name: str) -> None:
    robot = dressed(name)
    bare = replace(robot, gravity=(number(0), number(0), number("-9.81")))
    links = tuple(replace(link, armature=number(0), viscous=number(0)) for link in bare.links)
    oracle = Oracle.of(replace(bare, links=links))
    reading = Reading(exported(bare, "urdf").text, [joint.variable for joint in bare.joints])
    random = np.random.default_rng(3)
    for _ in range(3):
        q, qd, qdd = random.uniform(-2, 2, (3, robot.n))
        assert np.abs(reading.pose(q, "tool") - oracle.evaluate("forward_kinematics", q)).max() < 1e-13
        expected = oracle.evaluate("inverse_dynamics", q, qd, qdd)
        assert np.abs(reading.torque(q, qd, qdd) - expected).max() < 1e-12 * max(1, np.abs(expected).max())


def test_limits_friction_effort_and_speed_are_written() -> None:
    robot = dressed("stanford-deluca", coulomb=True)
    bounded = replace(robot.joints[1], limits=(number("-0.5"), number(2)), torque=number(7), speed=number("1.5"))
    made = exported(replace(robot, joints=(robot.joints[0], bounded, *robot.joints[2:])), "urdf")
    joints = {joint.get("name"): joint for joint in Xml.fromstring(made.text).iter("joint")}
    assert joints["q2"].find("limit").attrib == {"lower": "-0.5", "upper": "2", "effort": "7", "velocity": "1.5"}
    assert float(joints["q2"].find("dynamics").get("friction")) == Oracle.of(robot).arm.coulomb[0, 1]
    assert [joints[q].get("type") for q in ("q1", "q2", "q3")] == ["continuous", "revolute", "prismatic"]
    assert joints["q3"].find("limit").get("lower") == "-10"
    assert "URDF wants limits of slides: 10 m to either side of q3" in made.remarks


def test_what_urdf_cannot_say_is_named_in_its_first_comment() -> None:
    made = exported(dressed("scara-matlab", rotors=True), "urdf")
    for lost in ("the armature of q1", "the rotor inertia", "the coupling of the rotor", "the gravity 0.3, -9.1, -2.7"):
        assert any(lost in remark for remark in made.remarks)
        assert lost in made.text.partition("-->")[0]


@pytest.mark.parametrize(("down", "is_named"), [("-9.81", False), ("-9.8", False), ("-1.62", True), ("9.81", True)])
def test_a_gravity_that_is_not_the_earths_is_named(down: str, is_named: bool) -> None:
    robot = replace(dressed("planar-3r"), gravity=(number(0), number(0), number(down)))
    assert any("the gravity 0, 0, " in remark for remark in exported(robot, "urdf").remarks) == is_named


def test_dashes_of_a_name_end_no_comment_and_a_cylinder_goes_from_joint_to_joint() -> None:
    made = exported(replace(dressed("planar-3r"), name="a---b----c"), "urdf")
    assert Xml.fromstring(made.text).get("name") == "a---b----c"
    found = rod((arb(0), arb(3), arb(4)), 0.1)
    assert found == {"xyz": "0 1.5 2", "rpy": "0 0.643501 1.5708", "length": "5", "to": "0 3 4"}
    assert rod((arb(0), arb(0), arb("0.05")), 0.1) is None


def test_joints_may_be_called_as_those_that_are_fixed() -> None:
    robot = dressed("planar-3r")
    called = ("tool-joint", "q3", "base-joint")
    named = tuple(replace(joint, name=name) for joint, name in zip(robot.joints, called, strict=True))
    text = exported(replace(robot, joints=named), "urdf").text
    names = [joint.get("name") for joint in Xml.fromstring(text).iter("joint")]
    assert len({*names}) == len(names)
    assert Reading(text, called).model.nv == 3


def cells(robot: Robot) -> list[object]:
    rows = [(j.type, j.variable, j.sign, j.theta, j.d, j.a, j.alpha) for j in robot.joints]
    return [*rows, robot.base, robot.tool]


@pytest.mark.parametrize("name", SWEEP)
def test_the_table_comes_back_to_the_letter_and_torques_to_rounding(name: str) -> None:
    for robot in (numeric(name), uneven(dressed(name, rotors=True, coulomb=True))):
        text = exported(robot, "urdf").text
        found = imported(text, convention=robot.convention)
        assert cells(found.robot) == cells(robot)
        assert found.certificate.position < 1e-13
        if not robot.links:
            continue
        states = np.random.default_rng(2).uniform(-2, 2, (3, 4, robot.n))
        ours, theirs = (Oracle.of(r).evaluate("inverse_dynamics", *states) for r in (robot, found.robot))
        assert np.abs(ours - theirs).max() < 1e-12 * np.abs(ours).max()
        # What somebody else writes into the URDF goes before what it carries.
        changed = imported(text.replace(' friction="', ' friction="1'), convention=robot.convention).robot
        assert not any(isinstance(link.coulomb, tuple) for link in changed.links)


SLANTED = robot_of_rows(
    "R theta: q1 + 1.7398639118778688, d: 0.4, a: 0.097873524170258314 | "
    "R theta: q2 + 2.1154531206566901, d: 0.3, alpha: 0.7",
    """
gravity: [0, 0, -9.81]
links:
  - {mass: 2.5, com: [0, 0.1, 0.15], inertia: {xx: 0.02, yy: 0.03, zz: 0.04}}
  - {mass: 1.5, com: [-0.07, 0, 0], inertia: {xx: 0.012, yy: 0.012, zz: 0.002, xy: -0.0001}}
""",
)


def test_limits_come_back_and_links_without_the_noise_of_turning_them() -> None:
    """An entry of 1e-19 would stand in every equation."""
    assert imported(exported(SLANTED, "urdf").text, convention=SLANTED.convention).robot.links == SLANTED.links
    robot = dressed("stanford-deluca")
    ends = (multiply(number("-1/2"), Pi()), number(2))
    for places in ((), (1, 2)):
        joints = tuple(replace(joint, limits=ends if k in places else None) for k, joint in enumerate(robot.joints))
        found = imported(exported(replace(robot, joints=joints), "urdf").text, convention=robot.convention)
        assert [joint.limits for joint in found.robot.joints] == [joint.limits for joint in joints]
    narrower = exported(robot, "urdf").text.replace('lower="-10" upper="10"', 'lower="-9" upper="10"')
    assert imported(narrower, convention=robot.convention).robot.joints[2].limits == (number(-9), number(10))


def test_a_table_of_another_arm_or_convention_gives_way_to_common_normals() -> None:
    robot = numeric("kuka-kr5")
    text = exported(robot, "urdf").text
    other = imported(text.replace('axis xyz="0 0 1"', 'axis xyz="0 1 0"', 1), convention=robot.convention)
    assert cells(other.robot) != cells(robot)
    assert imported(text, convention=Convention.MODIFIED).robot.convention is Convention.MODIFIED
    read = read_urdf(text.encode(), "arm.urdf")
    with exactly():
        arm = arm_of(read, None, None, Fraction(0))
        assert carried_table(read, arm, Convention.STANDARD) is not None
        assert carried_table(replace(read, table="joints: ["), arm, Convention.STANDARD) is None
        assert carried_table(replace(read, table=""), arm, Convention.STANDARD) is None


NAMED = """
name: named
convention: modified
joints:
  - {type: revolute, theta: -q1, d: 0.3, limits: [-2, 2], speed: 3, torque: 80, name: "shoulder \\"pan\\" & <turn>"}
  - {type: prismatic, d: q2 + 0.1, alpha: pi/2, limits: [0, 0.4], torque: 9.5, name: it's a  slide}
  - {type: revolute, q: q7, theta: q7, a: 0.1}
gravity: [0, 0, -9.81]
links:
  - {mass: 2, com: [0, 0, 0.1], inertia: {xx: 0.02, yy: 0.02, zz: 0.01}}
  - {mass: 1, com: [0, 0.1, 0], inertia: {xx: 0.02, yy: 0.02, zz: 0.01}, motor: {mass: 0.1, inertia: 1e-4, ratio: 30}}
  - {mass: 1, com: [0, 0.1, 0], inertia: {xx: 0.02, yy: 0.02, zz: 0.01}, friction: {viscous: 0.3}}
"""


def test_names_speeds_torques_and_the_convention_come_back_and_names_of_a_urdf_stay() -> None:
    robot = Robot.from_text(NAMED)
    text = exported(robot, "urdf").text
    found = imported(text)
    assert found.robot.joints == robot.joints
    assert (found.robot.convention, found.robot.base, found.robot.tool) == (robot.convention, robot.base, robot.tool)
    assert found.joints == tuple(joint.label for joint in robot.joints)
    assert "the table is the one that the URDF carries with it" in found.notes
    assert imported(text, convention=Convention.STANDARD).robot.convention is Convention.STANDARD
    text = urdf([J(name="pan&#10;x"), J("0.3 0 0", "1.57 0 0", name="q2"), J("0 0 1", name="w" * 600)])
    joints = imported(text).robot.joints
    assert [joint.name for joint in joints] == ["pan\\nx", "", "w" * 500]
    assert [joint.variable for joint in joints] == ["q1", "q2", "q3"]


def test_every_format_has_the_names() -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = Robot.from_text(NAMED)
    names = [joint.label for joint in robot.joints]
    model = mujoco.MjModel.from_xml_string(exported(robot, "mjcf").text)
    assert [model.joint(i).name for i in range(3)] == names
    assert [model.actuator(i).name for i in range(3)] == names
    assert Reading(exported(robot, "urdf").text, names).model.nv == 3
    for to in ("rtb", "corke", "rigidbodytree", "csv"):
        assert "slide" in exported(robot, to).text
    assert "rigidBodyJoint('it''s a slide', 'prismatic')" in exported(robot, "rigidbodytree").text
    compile(exported(robot, "rtb").text, "rtb.py", "exec")
