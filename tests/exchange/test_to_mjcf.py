"""MuJoCo moves an exported arm as the equations do."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.exchange.body_chain import RigidBody
from derive.exchange.formats import exported
from derive.exchange.to_xml import LEAST, is_too_thin
from derive.robot.description import Inertia, Motor
from derive.robot.expression import ZERO, number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import EVERY, SWEEP, dressed, numeric, uneven, with_links
from tests.rows import robot_of_rows

mujoco = pytest.importorskip("mujoco")


def worst(robot: Robot, text: str) -> tuple[float, float]:
    """Largest differences of accelerations, relative, and of poses at random states in which all joints slip."""
    model = mujoco.MjModel.from_xml_string(text)
    data, oracle, random = mujoco.MjData(model), Oracle.of(robot), np.random.default_rng(1)
    accelerations, poses = 0.0, 0.0
    for _ in range(10):
        q, tau = random.uniform(-3, 3, robot.n), random.uniform(-20, 20, robot.n)
        qd = random.choice([-1, 1], robot.n) * random.uniform(1, 2, robot.n)
        data.qpos[:], data.qvel[:], data.ctrl[:] = q, qd, tau
        mujoco.mj_forward(model, data)
        expected = oracle.evaluate("forward_dynamics", q, qd, tau)
        accelerations = max(accelerations, np.abs(data.qacc - expected).max() / max(1, np.abs(expected).max()))
        pose = oracle.evaluate("forward_kinematics", q)
        found = np.column_stack([data.site("tool").xmat.reshape(3, 3), data.site("tool").xpos])
        poses = max(poses, np.abs(found - pose[:3]).max())
    return accelerations, poses


@pytest.mark.parametrize("name", SWEEP)
def test_accelerations_with_armature_and_viscous_friction_are_ours(name: str) -> None:
    robot = dressed(name)
    text = exported(robot, "mjcf").text
    assert max(worst(robot, text)) < 1e-12
    assert joints_of_bodies(text) == [1] * robot.n


@pytest.mark.parametrize("name", ["planar-2r-perugia", "scara-matlab", "skeleton-modified"])
def test_rotors_are_coupled_where_axes_keep_their_angles(name: str) -> None:
    robot = dressed(name, rotors=True)
    made = exported(robot, "mjcf")
    assert max(worst(robot, made.text)) < 1e-12
    assert not any("coupling" in remark for remark in made.remarks)


def test_a_coupling_that_varies_is_named() -> None:
    robot = dressed("kuka-kr5", rotors=True)
    made = exported(robot, "mjcf")
    (told,) = (remark for remark in made.remarks if "coupling" in remark)
    said = "MJCF cannot say the coupling of the rotor with the joints before it, which depends on q, of"
    assert told.startswith(said)
    size = float(told.partition("by up to ")[2].partition(" ")[0])
    assert size / 10 < worst(robot, made.text)[0] < 10 * size


def test_friction_limits_and_torques_are_those_of_the_robot_and_cylinders_weigh_what_has_no_masses() -> None:
    robot = dressed("kuka-kr5", coulomb=True)
    assert max(worst(robot, exported(robot, "mjcf").text)) < 1e-12
    made = exported(uneven(robot), "mjcf")
    losses = mujoco.MjModel.from_xml_string(made.text).dof_frictionloss
    assert losses == pytest.approx(1.15 * Oracle.of(robot).arm.coulomb[0])
    assert any("by direction, written as the mean of both ways, of q1, q2" in remark for remark in made.remarks)
    robot = dressed("planar-3r")
    first = replace(robot.joints[0], limits=(number("-0.5"), number(2)), torque=number(7))
    made = exported(replace(robot, joints=(first, *robot.joints[1:])), "mjcf")
    model = mujoco.MjModel.from_xml_string(made.text)
    assert model.jnt_limited.tolist() == [1, 0, 0]
    assert model.jnt_range[0].tolist() == [-0.5, 2]
    assert model.actuator_ctrllimited.tolist() == [1, 0, 0]
    assert model.actuator_ctrlrange[0].tolist() == [-7, 7]
    made = exported(numeric("kuka-kr5"), "mjcf")
    assert mujoco.MjModel.from_xml_string(made.text).body_mass[1:].min() > 0
    assert any("cylinders" in remark for remark in made.remarks)


@pytest.mark.parametrize("name", [name for name in EVERY if Robot.load(name).links])
def test_built_in_robots_with_bodies_accelerate_as_ours_with_possible_ones(name: str) -> None:
    pytest.importorskip("clarabel")
    given = numeric(name)
    slipping = tuple(replace(link, coulomb=ZERO) for link in given.links)
    given = replace(given, joints=tuple(replace(joint, limits=None) for joint in given.joints), links=slipping)
    made = exported(given, "mjcf", "possible")
    assert max(worst(given, made.text)) < 1e-12
    assert not any("refuses" in remark for remark in made.remarks)


NOTHING, STONE = ("0", "0 0 0", "0 0 0 0 0 0"), ("1.2", "-0.1 0.07 0.02", "0.005 0.006 0.01 0.001 0 0")

STONES = (STONE,) * 3
ROWS = (
    *("R theta: q1 + 0.2, d: 0.3, a: 0.2, alpha: 0.7", "R theta: -q2, d: 0.1, a: 0.15, alpha: pi/2"),
    *("P theta: 0.4, a: 0.1, alpha: -1.1", "R d: 0.2, a: 0.25, alpha: pi/2", "R a: 0.2, alpha: 0.3"),
    *("R theta: -q6 + 1, d: -0.1, alpha: 1.2", "R d: 0.3, a: -0.2", "P theta: 1, d: -q8, alpha: 0.4"),
)
"""Skew axes with lengths between them, slides, reversed variables."""


def limb(convention: str, *links: tuple[str, str, str], armature: str = "0.02") -> Robot:
    """The first rows with a base, a tool and links."""
    more = (
        "base: [[0, -1, 0, 0.3], [1, 0, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]]\n"
        "tool: [[1, 0, 0, 0], [0, 0, -1, 0.1], [0, 1, 0, 0], [0, 0, 0, 1]]\n"
        f"gravity: [1, 2, -9]\nlinks: [{', '.join(['{}'] * len(links))}]\n"
    )
    made = with_links(robot_of_rows("|".join(ROWS[: len(links)]), more, convention=convention), *links)
    return replace(made, links=tuple(replace(link, armature=number(Fraction(armature))) for link in made.links))


def test_points_rods_and_links_without_mass_accelerate_as_the_equations_say() -> None:
    """Two links that are nothing; then a body, a rod, a point, and a slanted plate."""
    rod, point = ("1.5", "0.1 0 0.1", "0.05 0.05 0 0 0 0"), ("0.7", "-0.1 0.05 0.02", "0 0 0 0 0 0")
    plate = ("0.9", "-0.1 0.07 0.02", "0.005 0.005 0.01 0.001 0 0")
    robot = limb("standard", NOTHING, NOTHING, STONE, rod, point, plate)
    made = exported(robot, "mjcf")
    assert max(worst(robot, made.text)) < 1e-12
    assert any(remark.startswith("MuJoCo has no body for link 1, 2, without mass") for remark in made.remarks)
    assert "MuJoCo wants a little of each: 1e-15 kg or kg m^2 where link 4, 5 has none" in made.remarks
    assert [LEAST, is_too_thin(RigidBody.of(robot.links[5]))] == [1e-15, False]


def joints_of_bodies(text: str) -> list[int]:
    return mujoco.MjModel.from_xml_string(text).body_jntnum[1:].tolist()


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize(
    ("weighs", "joints"),
    [("..x.x", [3, 2]), ("x..x", [1, 3]), (".x.x.x.x", [2] * 4), (".......x", [6, 2]), ("..x.", [3, 1])],
)
def test_joints_of_links_without_mass_move_the_next_body(convention: str, weighs: str, joints: list[int]) -> None:
    """A last link has none to go into, nor have more than MuJoCo has joints in a body."""
    robot = limb(convention, *(STONE if link == "x" else NOTHING for link in weighs))
    made = exported(robot, "mjcf")
    assert joints_of_bodies(made.text) == joints
    assert max(worst(robot, made.text)) < 1e-12


@pytest.mark.parametrize(
    ("links", "joints"),
    [
        pytest.param((("0.4", "0 0 0", "0 0 0 0 0 0"), STONE), [2], id="point on the next axis"),
        pytest.param((STONE, ("0.4", "0 0 0", "0 0 0 0 0 0"), STONE), [1, 1, 1], id="which slides"),
        pytest.param((*STONES, ("0.4", "-0.25 0 0", "3 0 3 0 0 0"), STONE), [1, 1, 1, 2], id="rod on its own"),
        pytest.param((*STONES, ("0.4", "-0.24 0 0", "3 0 3 0 0 0"), STONE), [1] * 5, id="rod beside it"),
        pytest.param((*STONES, ("0.4", "-0.25 0 0", "3 1 3 0 0 0"), STONE), [1] * 5, id="a body"),
    ],
)
def test_mass_along_an_axis_is_with_the_link_beyond_where_mujoco_would_refuse_it(
    links: tuple[tuple[str, str, str], ...], joints: list[int]
) -> None:
    robot = limb("standard", *links)
    made = exported(robot, "mjcf")
    assert joints_of_bodies(made.text) == joints
    assert max(worst(robot, made.text)) < 1e-12
    mass = sum(float(Fraction(mass)) for mass, _, _ in links)
    assert mujoco.MjModel.from_xml_string(made.text).body_mass.sum() == pytest.approx(mass, rel=1e-14)


def test_a_light_finger_behind_links_without_mass_gets_no_mass_that_it_has_not() -> None:
    """1e-15 kg m^2 in each of them would be 3e-8 of what it weighs."""
    finger = ("0.002", "0.01 0.007 0.02", "3e-7 2e-7 3e-7 0 0 0")
    robot = limb("standard", STONE, NOTHING, NOTHING, finger, armature="0")
    assert max(worst(robot, exported(robot, "mjcf").text)) < 1e-12


def test_the_way_between_the_joints_of_one_body_is_shown() -> None:
    """From where the first axis is to where the last one is, whatever the angles are."""
    robot = limb("standard", NOTHING, STONE)
    model = mujoco.MjModel.from_xml_string(exported(robot, "mjcf").text)
    data, oracle = mujoco.MjData(model), Oracle.of(robot)
    for q in ([-1.0, 0.7], [0.0, 0.0], [2.0, 0.1]):
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        assert data.ten_length[0] == pytest.approx(np.hypot(0.3, 0.2), abs=1e-14)
        assert data.site("link1-start").xpos == pytest.approx([0.3, 0, 0.2], abs=1e-14)
        assert data.site("link1-end").xpos == pytest.approx(oracle.evaluate("link_transforms", q)[0][:3, 3], abs=1e-14)


def test_rotors_turn_with_the_joints_before_them_in_one_body_too() -> None:
    robot = dressed("planar-3r", rotors=True)
    motor = replace(robot.links[0].motor or Motor(), mass=ZERO)
    first = replace(robot.links[0], mass=ZERO, inertia=Inertia(), motor=motor)
    links = (first, *(replace(link, motor=replace(link.motor or motor, mass=ZERO)) for link in robot.links[1:]))
    robot = replace(robot, links=links)
    made = exported(robot, "mjcf")
    assert joints_of_bodies(made.text) == [2, 1]
    assert max(worst(robot, made.text)) < 1e-12


def test_bodies_that_mujoco_refuses_are_named_before_and_nothing_is_said_of_those_that_it_takes() -> None:
    pytest.importorskip("clarabel")
    made = exported(numeric("scara-matlab"), "mjcf", "possible")  # with its rotor's spin, link 2 would be no body
    assert mujoco.MjModel.from_xml_string(made.text).nv == 4
    assert not any("refuses" in remark for remark in made.remarks)
    made = exported(numeric("puma560-corke"), "mjcf")
    assert "MuJoCo refuses link 1, 3: inconsistent inertia; inertia: possible finds a valid one" in made.remarks
    with pytest.raises(ValueError, match=r"mass|inertia"):
        mujoco.MjModel.from_xml_string(made.text)
