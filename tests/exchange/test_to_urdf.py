"""Bodies and frames of a robot, placed for other programs, in the formats that are not MuJoCo's."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree as Xml

import numpy as np
import pytest
from flint import arb

from derive.errors import DeriveError, Location
from derive.exchange.body_chain import RigidBody, body_chain, is_world, quaternion, roll_pitch_yaw
from derive.exchange.certificate import ball
from derive.exchange.formats import FORMS, GIVEN, exported
from derive.exchange.numeric import angle_text, text, with_numbers, with_positive_axes
from derive.exchange.to_urdf import rod
from derive.mechanics.space import WORLD, Frame, exactly, unit, vector
from derive.robot.expression import number
from derive.robot.names import robot_symbols
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import EVERY, SWEEP, dressed, numeric
from tests.exchange.urdfs import Reading


def matrix(frame: Frame) -> np.ndarray:
    return np.array([[float(axis[k]) for axis in (frame.x, frame.y, frame.z)] for k in range(3)])


@pytest.mark.parametrize("x", [(1, 2, 3), (0, 0, 1), (0, 0, -1), (-1, 0, 0), (0, -1, 0)])
def test_roll_pitch_yaw_and_quaternion_are_the_rotation(x: tuple[int, int, int]) -> None:
    with exactly():
        first = unit(vector(x))
        z = unit(vector((-x[1], x[0], 0) if x[0] or x[1] else (0, 1, 0)))
        frame = Frame.of(vector((0, 0, 0)), first, z)
        (r, p, y), (w, i, j, k) = map(float, roll_pitch_yaw(frame)), map(float, quaternion(frame))
    about_x = np.array([[1, 0, 0], [0, np.cos(r), -np.sin(r)], [0, np.sin(r), np.cos(r)]])
    about_y = np.array([[np.cos(p), 0, np.sin(p)], [0, 1, 0], [-np.sin(p), 0, np.cos(p)]])
    about_z = np.array([[np.cos(y), -np.sin(y), 0], [np.sin(y), np.cos(y), 0], [0, 0, 1]])
    assert np.abs(about_z @ about_y @ about_x - matrix(frame)).max() < 1e-15
    cross = np.array([[0, -k, j], [k, 0, -i], [-j, i, 0]])
    assert np.abs(np.eye(3) + 2 * w * cross + 2 * cross @ cross - matrix(frame)).max() < 1e-15


def test_a_body_and_what_is_taken_away_again_is_the_body() -> None:
    with exactly():
        link, other = (RigidBody.of(link) for link in dressed("planar-3r").links[:2])
        back = link + other + other.negative
        assert all(abs(a - b) < 1e-60 for a, b in zip(back.entries, link.entries, strict=True))
        assert back.link(dressed("planar-3r").links[0]) == dressed("planar-3r").links[0]


def test_bodies_that_exist_are_possible_and_points_rods_and_plates_are_limits_of_them() -> None:
    with exactly():
        one = RigidBody(arb(1), vector((0, 0, 0)), (vector((2, 0, 0)), vector((0, 3, 0)), vector((0, 0, 4))))
        assert one.is_possible
        assert not RigidBody(arb(-1), one.com, one.inertia).is_possible
        assert not RigidBody(one.mass, one.com, (one.inertia[0], one.inertia[1], vector((0, 0, 6)))).is_possible
        links = numeric("puma560-corke").links
        assert [i for i, body in enumerate(map(RigidBody.of, links), 1) if not body.is_possible] == [1, 3]
    with exactly():
        for mass, moments in ((1, (0, 0, 0)), (1, (0, 3, 3)), (1, (1, 3, 4)), (0, (0, 0, 0)), (0, (1, 2, 2))):
            rows = [vector(tuple(m if i == j else 0 for j in range(3))) for i, m in enumerate(moments)]
            assert RigidBody(arb(mass), vector((0, 0, 0)), (rows[0], rows[1], rows[2])).is_possible


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
        (
            "udf",
            "given",
            "unknown format 'udf'; allowed: urdf, mjcf, rtb, corke, rigidbodytree, csv; did you mean 'urdf'?",
        ),
        ("urdf", "real", "unknown choice of inertia 'real'; allowed: given, possible"),
    ],
)
def test_an_unknown_word_gets_one_message(to: str, inertia: str, message: str) -> None:
    with pytest.raises(DeriveError) as caught:
        exported(Robot.load("kuka-kr5"), to, inertia)
    assert str(caught.value) == message


ARM = """
name: arm
convention: standard
joints:
  - {type: revolute, d: h, a: 2*h, alpha: pi/2, limits: [-w, w]}
  - {type: prismatic, a: b/c}
parameters: {h: 0.3, c: 0.5}
"""


def test_numbers_of_the_file_and_of_the_user_take_the_place_of_all_symbols() -> None:
    robot = with_numbers(Robot.from_text(ARM), {"b": number("0.25"), "w": number(2), "c": number("0.125")})
    assert not robot_symbols(robot)
    assert [robot.joints[0].d, robot.joints[0].a, robot.joints[1].a] == [number("0.3"), number("0.6"), number(2)]
    assert robot.joints[0].limits == (number(-2), number(2))


def test_symbols_without_numbers_and_cells_without_values_are_refused() -> None:
    with pytest.raises(DeriveError, match=r"arm: symbols without a number: b, w; .*; .*--values b=0\.5,w=0\.5"):
        with_numbers(Robot.from_text(ARM))
    with pytest.raises(DeriveError, match="b/c has no finite value"):
        with_numbers(Robot.from_text(ARM), {"b": number(1), "w": number(1), "c": number(0)})


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
    assert float(joints["q2"].find("dynamics").get("friction")) == Oracle.of(robot).arm.coulomb[1]
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
