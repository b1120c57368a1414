"""What is written with possible bodies exists, is taken by MuJoCo, and moves as the equations say."""

from dataclasses import replace
from xml.etree import ElementTree as Xml

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.exchange.body_chain import body_chain
from derive.exchange.formats import exported, lost_coupling, with_rotors
from derive.mechanics.space import exactly
from derive.model.identification.witness import NoSuchBodies
from derive.robot.description import Motor
from derive.robot.expression import number
from derive.robot.robot import Robot
from tests.exchange.arms import numeric, random_arm
from tests.exchange.test_to_mjcf import worst
from tests.exchange.urdfs import Reading
from tests.random_robots import swept
from tests.rows import robot_of_rows

mujoco = pytest.importorskip("mujoco")
pytest.importorskip("clarabel")

SEEDS = [*range(6), *swept(*range(6, 500))]

SPUN = "inertia: {xx: 0.001, yy: 0.02, zz: 0.021}, motor: {inertia: 0.03, ratio: 50}"
PAIR = f"[{{mass: 2, com: [-0.25, 0, 0], {SPUN}}}, {{mass: 1, com: [-0.2, 0, 0], {SPUN}}}]"
TWO = robot_of_rows("R a: 0.5 | R a: 0.4", f"gravity: [0, -9.81, 0]\nlinks: {PAIR}")
WRIST = robot_of_rows(
    "R d: 0.3 | R theta: -q2, a: 0.1, alpha: pi/2 | P theta: 0.3, alpha: 0.7 | R theta: -q4, a: 0.2, alpha: -pi/2"
    "| R d: 0.1, alpha: pi/2",
    """
gravity: [0, 0, -9.81]
links:
  - {mass: 9, com: [0, 0.02, -0.1], inertia: {xx: 0.3, yy: 0.3, zz: 0.2}}
  - {mass: 6, com: [0.1, 0, 0.1], inertia: {xx: 0.2, yy: 0.3, zz: 0.2}, motor: {inertia: 0.001, ratio: 90}}
  - {mass: 4, com: [0, 0.1, 0], inertia: {xx: 0.2, yy: 0.2, zz: 0.2}}
  - {mass: 3, com: [0, 0, 0.1], inertia: {xx: 0.1, yy: 0.1, zz: 0.1}, motor: {mass: 0.2, inertia: 0.0005, ratio: -80}}
  - {mass: 2, com: [0, 0, 0.1], inertia: {xx: 0.1, yy: 0.1, zz: 0.05}, motor: {inertia: 0.0005, ratio: 60}}
""",
    convention="modified",
)


def room(text: str) -> float:
    """The least of mass, moments and A + B - C of the links of a URDF, of the largest moment of each."""
    found = []
    for inertial in Xml.fromstring(text).iter("inertial"):
        tensor = inertial.find("inertia")
        xx, yy, zz, xy, xz, yz = (float(tensor.get(f"i{k}")) for k in ("xx", "yy", "zz", "xy", "xz", "yz"))
        a, b, c = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        found += [min(a, a + b - c) / c if c else 0.0, float(inertial.find("mass").get("value"))]
    return min(found)


@pytest.mark.first(2)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_arm_is_taken_by_mujoco_and_accelerates_as_ours_or_the_remark_says_how_much_not(seed: int) -> None:
    robot = random_arm(seed, motors=seed % 2 == 1)
    try:
        made, plain = exported(robot, "mjcf", "possible"), exported(robot, "urdf", "possible")
    except DeriveError as error:  # bodies of so little inertia carry such a rotor, or are points
        if not isinstance(error, NoSuchBodies) and "the search found none" not in error.found:
            raise
        pytest.skip("refused")
    acceleration, pose = worst(robot, made.text)
    told = [float(remark.partition("by up to ")[2].split()[0]) for remark in made.remarks if "coupling" in remark]
    assert pose < 1e-12
    assert acceleration < 10 * told[0] if told else acceleration < 1e-11
    assert room(plain.text) >= 0
    states = np.random.default_rng(seed).uniform(-1, 1, (3, robot.n))
    names = [joint.variable for joint in robot.joints]
    ours, theirs = (Reading(text, names).torque(*states) for text in (exported(robot, "urdf").text, plain.text))
    assert np.abs(ours - theirs).max() < 1e-9 * np.abs(ours).max()


@pytest.mark.parametrize("robot", [numeric("scara-matlab"), TWO], ids=["scara", "two"])
def test_bodies_are_repaired_with_the_rotors_that_they_carry(robot: Robot) -> None:
    assert room(exported(robot, "urdf").text) < 0
    assert room(exported(robot, "urdf", "possible").text) > 0


@pytest.mark.parametrize("inertia", ["given", "possible"])
def test_a_rotor_whose_coupling_varies_is_divided_where_both_links_can_be(inertia: str) -> None:
    robot, made = WRIST, exported(WRIST, "mjcf", inertia)
    assert "the rotor of q4, q5 is divided between the links beside the joint, and its armature" in made.remarks
    assert max(worst(robot, made.text)) < 1e-12
    heavier = replace(robot.links[4], motor=Motor(inertia=number("0.01"), ratio=number(60)))
    other = replace(robot, links=(*robot.links[:4], heavier))
    made = exported(other, "mjcf", inertia)
    assert any("of q5; where accelerations are up to 1, they differ by up to" in remark for remark in made.remarks)
    with exactly():
        written, _ = with_rotors(body_chain(other), lambda rotor: False, inertia)
        assert lost_coupling(other, written, lambda rotor: False) > 1e-3
