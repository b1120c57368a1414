"""Torques of motions on moving bases, with bodies that are carried, and their figures."""

import random
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from sympy import Rational, cos, sin

from derive.arrays import Array
from derive.motion.motion import Motion
from derive.motion.torques.base_torques import BaseCurve, BaseTorques, OpenLinks
from derive.motion.torques.functions import loads
from derive.plans.profile import TIME
from derive.plans.segments import Payload
from derive.robot.description import Link
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Name
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from tests.random_robots import RandomRobot, random_robot, seeds
from tests.verification.oracle.pinocchio_reference import _Builder, along

BASE = BaseCurve.of(
    (TIME / 2, TIME**2 / 5, sin(2 * TIME) / 3), (TIME / 3 + Rational(1, 5), cos(3 * TIME) / 2, TIME**2 / 7)
)
"""It goes and turns about all axes."""

LOAD = "payload: {mass: 1, com: [0.5, 0, 0]}"

SKELETON = """\
robot:
  name: NAME
  convention: standard
  gravity: [0, -9.81, 0]
  FRAME
  joints:
    ROOT
    - {type: revolute, q: b, theta: -b, a: 0.4}
    - {type: revolute, q: a, theta: -a, a: 0.3}
  links:
    MASSES
    - {mass: 2, com: [-0.2, 0, 0], inertia: {xx: 0.01, yy: 0.03, zz: 0.03}}
    - {mass: 1, com: [-0.15, 0, 0.02], inertia: {xx: 0.005, yy: 0.01, zz: 0.01}, friction: {viscous: 0.3}}
"""


class _FreeFlyer(_Builder):
    """The arm on a body that flies."""

    def __init__(self, robot: RandomRobot) -> None:
        super().__init__(robot)
        self.root = int(self.model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base"))

    def add_joint(self, i: int, parent: int) -> int:
        return super().add_joint(i, parent or self.root)


class _Ground(_FreeFlyer):
    """The rotor of joint 1 alone, as a part of the base, whose mass counts for nothing."""

    def build(self) -> Any:
        link = self.robot.links[0]
        lift = 0.0 if self.robot.standard else self.robot.joints[0].d
        body = pin.Inertia(link.rotor_mass, np.zeros(3), np.diag([0.0, 0.0, link.rotor_inertia]))
        self.model.appendBodyToJoint(self.root, body, self.axis(0) * along(0, 0, lift))
        return self.model


def flying(t: float) -> list[Array]:
    """Position, velocity and acceleration of the base at a time, as Pinocchio has them."""
    pose, rate, bend = (BASE(np.array([t]), order)[0] for order in range(3))
    turned = pose[:3, :3].T
    spin = turned @ rate[:3, :3]
    omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    tensor = turned @ bend[:3, :3] - spin @ spin
    alpha = np.array([tensor[2, 1], tensor[0, 2], tensor[1, 0]])
    speed = turned @ rate[:3, 3]
    push = turned @ bend[:3, 3] - np.cross(omega, speed)
    place = np.concatenate([pose[:3, 3], pin.Quaternion(pose[:3, :3]).coeffs()])
    return [place, np.concatenate([speed, omega]), np.concatenate([push, alpha])]


def flown(robot: RandomRobot, t: float, q: Array, rates: tuple[Array, Array]) -> tuple[Array, float, float]:
    """Torques of Pinocchio, without friction, on the base at a time; the power of the base, and the energy."""
    outside, base = _FreeFlyer(robot).build(), flying(t)
    whole = [np.concatenate([root, (outside.map @ own)[6:]]) for root, own in zip(base, (q, *rates), strict=True)]
    torques = pin.rnea(outside.model, outside.model.createData(), *whole)
    ground = _Ground(robot).build()
    power = (torques[:6] - pin.rnea(ground, ground.createData(), *base)) @ base[1]
    energy, armature = 0.0, outside.model.armature.copy()
    outside.model.armature = np.zeros_like(armature)
    for sign, model, place, speed in ((1, outside.model, *whole[:2]), (-1, ground, *base[:2])):
        energy += sign * pin.computeKineticEnergy(model, model.createData(), place, speed)
        energy += sign * pin.computePotentialEnergy(model, model.createData(), place)
    return np.array(outside.map.T @ torques), float(power), energy + whole[1] @ (armature * whole[1]) / 2


@pytest.mark.parametrize("seed", seeds(200, 2))
def test_they_are_those_of_a_free_flying_base(seed: int) -> None:
    """Random arms of both conventions with rotors, against Pinocchio."""
    robot = random_robot(random.Random(seed))
    loaded = Robot.from_text(robot.text)
    values: dict[str, Any] = {**parameter_values(loaded), **robot.values}
    source = np.random.default_rng(seed)
    t = source.uniform(0, 3, 4)
    q, qd, qdd = source.uniform(-2, 2, (3, 4, robot.n))
    base = BaseTorques(loaded, values, BASE, 3.0)
    added, power, energy = base(t, q, qd), base.power(t, q, qd, qdd), base.energy(t, q, qd)
    standing = _Builder(robot).build()
    for k in range(4):
        ours = standing.rigid_torque(q[k], qd[k], qdd[k]) + added[k]
        expected, given, held = flown(robot, float(t[k]), q[k], (qd[k], qdd[k]))
        assert ours == pytest.approx(expected, rel=1e-11, abs=1e-11 * np.abs(expected).max())
        assert power[k] == pytest.approx(given, rel=1e-10, abs=1e-10)
        assert energy[k] == pytest.approx(held, rel=1e-10, abs=1e-10)


def test_they_are_those_of_an_arm_that_has_joints_for_its_base() -> None:
    """Document 001: the root's translation as prismatic joints, or as a base that moves; friction and load included."""
    root = "- {type: prismatic, theta: pi/2, alpha: pi/2}\n    - {type: prismatic, theta: pi/2, alpha: pi/2}"
    permuted = "base: [[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]"
    blocks = {"NAME": "long", "FRAME": permuted, "ROOT": root, "MASSES": "- {mass: 0}\n    - {mass: 0}"}
    arm = {"NAME": "short", "FRAME": "title: moving", "ROOT": "", "MASSES": ""}
    texts = []
    for changes in (blocks, arm):
        text = SKELETON
        for old, new in changes.items():
            text = text.replace(old, new)
        texts.append("\n".join(line for line in text.splitlines() if line.strip()) + "\n")
    angles = "b: pi/3 + sin(t)/2, a: pi/4*sin(2*t)"
    joints = Motion.from_text(f"{texts[0]}curves: {{q1: 3*t/10 + sin(t), q2: t**2/10, {angles}}}\ntime: 5\n")
    moving = Motion.from_text(f"{texts[1]}curves: {{{angles}}}\nbase: {{x: 3*t/10 + sin(t), y: t**2/10}}\ntime: 5\n")
    t = np.linspace(0, 5, 41)
    assert moving.torques(t) == pytest.approx(joints.torques(t)[:, 2:], rel=1e-12, abs=1e-12)
    assert moving.torques(1.5) == pytest.approx(moving.torques(np.array([1.5]))[0], rel=1e-14)
    ours, theirs = ([load.peak for load in motion.peaks[0].loads] for motion in (moving, joints))
    assert ours == pytest.approx(theirs[2:], rel=1e-12)


def test_a_payload_is_carried_by_the_moving_base_too() -> None:
    """An arm that carries a point mass, and one whose last link is as heavy."""
    arm = """robot: {name: arm, convention: standard, gravity: [0, 0, -9.81], joints: [{type: revolute, a: 1}],
      links: [{mass: MASS, com: [COM, 0, 0], inertia: {xx: 0, yy: INERTIA, zz: INERTIA}}]}
points: {a: [0], b: [1]}
path: [a, {to: b, time: 1}, {to: a, time: 1, LOAD}]
base: {y: t**2, rpy: [t, t**2/4, 0]}
"""
    light = arm.replace("MASS", "2").replace("COM", "0").replace("INERTIA", "0.5").replace("LOAD", LOAD)
    heavy = arm.replace("MASS", "3").replace("COM", "1/6").replace("INERTIA", "2/3").replace(", LOAD", "")
    t = np.linspace(1.01, 2, 11)
    assert Motion.from_text(light).torques(t) == pytest.approx(Motion.from_text(heavy).torques(t), rel=1e-12)
    bare = Motion.from_text(light.replace(f", {LOAD}", ""))
    before = t[:-1] - 1
    assert Motion.from_text(light).torques(before) == pytest.approx(bare.torques(before), rel=1e-12)


PENDULUM = """robot: {name: arm, convention: standard, gravity: [GX, -9.81, 0],
  joints: [{type: revolute, a: 0.5}, {type: revolute, a: 0.4}],
  links: [{mass: 2, com: [-0.2, 0, 0], inertia: {xx: 0, yy: 0.1, zz: 0.1}, friction: {coulomb: DRY, viscous: 0.1}},
    {mass: 1, com: [-0.1, 0, 0], inertia: {xx: 0, yy: 0.05, zz: 0.05}}]}
points: {a: [0.2, 0.4]}
path: [a, {to: a, time: 1}]
sample: 0.05
friction: KIND
"""


@pytest.mark.parametrize(("kind", "dry"), [("none", "0"), pytest.param("exact", "0.8", marks=pytest.mark.sweep)])
def test_an_arm_on_an_accelerated_base_falls_as_in_a_tilted_world(kind: str, dry: str) -> None:
    """x = t^2 is a weight of 2 m/s^2 to the other side, in torques, in simulations, and in the ledger of energy."""
    text = PENDULUM.replace("KIND", kind).replace("DRY", dry)
    moving = Motion.from_text(text.replace("GX", "0") + "base: {x: t**2}\n").simulate()
    tilted = Motion.from_text(text.replace("GX", "-2")).simulate()
    assert moving.reached
    assert moving.q == pytest.approx(tilted.q, abs=1e-8)
    assert np.ptp(moving.q[:, 0]) > 0.5
    assert moving.energy_error < 1e-6


def turning_base() -> Motion:
    text = PENDULUM.replace("KIND", "none").replace("DRY", "0").replace("GX", "0")
    text = text.replace("[0.2, 0.4]}", "[0.2, 0.4], b: [1, -0.3]}").replace("to: a", "to: b, payload: 0.5")
    control = "control: {law: computed-torque, kp: 100, kd: 20}\n"
    return Motion.from_text(f"{text}{control}base: {{x: t**2, z: sin(t), rpy: [t, t**2/2, 0.3]}}\n")


def test_what_one_time_gives_is_what_many_give_before_and_after_the_motion_too() -> None:
    motion = turning_base()
    added, load = motion.base_torques, motion.plan.steps[0].payload
    t = np.linspace(-0.1, 1.1, 13)
    q, qd, _ = motion(t)
    single = added.single(load)
    one = [single(*each) for each in zip(t.tolist(), q, qd, strict=True)]
    assert np.array(one) == pytest.approx(added(t, q, qd, load), abs=1e-11)


@pytest.mark.sweep
def test_computed_torque_follows_on_a_base_that_turns() -> None:
    motion = turning_base()
    run = motion.simulate()
    assert run.q == pytest.approx(motion(run.t)[0], abs=1e-8)
    assert run.energy_error < 1e-6


def test_two_bodies_that_are_nothing_are_nothing() -> None:
    robot = Robot.load("puma560-corke")
    light = replace(robot, links=(*robot.links[:-1], Link()))
    opened = OpenLinks.of(light, [Payload()])
    values = {name: float(value) for name, value in parameter_values(robot).items()}
    found = opened.carrying(light, values, [Payload()])
    assert [found[name] for name in opened.names[5]] == [0.0] * 10


def test_an_open_link_has_ten_symbols_that_nobody_else_has() -> None:
    robot = Robot.load("puma560-corke")
    opened = OpenLinks.of(robot, [None, Payload()])
    names = opened.names[5]
    assert free_symbols(opened.robot) == names
    again = OpenLinks.of(opened.robot, [Payload()])
    assert not set(again.names[5]) & set(names)
    values = {name: float(value) for name, value in parameter_values(robot).items()}
    assert opened.carrying(robot, values)[names[0]] == 0.09
    assert opened.robot.links[-1].mass == Name(names[0])


def state(times: Array) -> tuple[Array, Array]:
    """Two joints: tau = 3 sin(2 t), -t; qd = cos(t), 2."""
    tau = np.stack([3 * np.sin(2 * times), -times], axis=-1)
    return tau, np.stack([np.cos(times), np.full_like(times, 2.0)], axis=-1)


@pytest.mark.parametrize("samples", [1, 7, 300])
def test_peaks_lie_between_samples_and_integrals_are_exact(samples: int) -> None:
    first, second = loads(0.0, 1.5, samples, state)
    assert (first.peak, first.time) == pytest.approx((3.0, np.pi / 4), rel=1e-5)
    assert first.peak == pytest.approx(3.0, rel=1e-10)
    assert (second.peak, second.time) == pytest.approx((-1.5, 1.5))
    assert second.work == pytest.approx(-(1.5**2))
    assert second.rms == pytest.approx(1.5 / np.sqrt(3))
    assert first.work == pytest.approx(2 * (1 - np.cos(1.5) ** 3), rel=1e-7)
    u = np.sqrt(1 / 3)  # 6 sin t cos^2 t is largest where sin^2 t = 1/3
    assert first.power == pytest.approx(6 * u * (1 - u**2), rel=1e-10)


def test_integrals_stop_at_corners_and_the_load_of_the_next_segment_does_not_count() -> None:
    """A torque of 1 that jumps to 3 at a third of the time: work 7/3, mean square 19/3."""

    def jumping(t: Array) -> tuple[Array, Array]:
        return np.where(t < 1 / 3, 1.0, 3.0)[..., None], np.ones((*t.shape, 1))

    (load,) = loads(0.0, 1.0, 10, jumping, [1 / 3])
    assert load.work == pytest.approx(7 / 3, rel=1e-12)
    assert load.rms == pytest.approx(np.sqrt(19 / 3), rel=1e-12)
    assert (load.peak, load.power) == (3, 3)
    assert load.time == pytest.approx(1 / 3)
    (load,) = loads(0.0, 1.0, 10, lambda t: (np.where(t < 1, 1.0, 9.0)[..., None], np.ones((*t.shape, 1))))
    assert (load.peak, load.power, load.rms) == (1.0, 1.0, pytest.approx(1.0))
