"""Simulations: energy, friction that sticks, and laws that follow."""

import sys
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from scipy import integrate

from derive.errors import RobotFileError, TargetError
from derive.motion.motion import Motion
from derive.motion.simulation.simulation import NEEDS, Run, stages_of
from derive.plans.profile import Profile
from derive.plans.schema import Law
from derive.plans.segments import Payload
from derive.robot.evaluate import evaluate
from derive.robot.expression import number
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import decimal, dressed
from tests.motion.random_arms import simulated
from tests.random_robots import seeds

PENDULUM = """\
robot: {name: pendulum, convention: standard, gravity: [0, -9.81, 0], joints: [{type: revolute, a: 1}],
  links: [{mass: 1, friction: FRICTION}]}
points: {a: [START], b: [START]}
path: [a, {to: b, time: 2}]
"""


TEN = [
    *("scara-perugia", "puma560-laschi", "stanford-deluca", "thumb", "kuka-lwr4", "skeleton-root", "spherical-arm"),
    *("anthropomorphic-wrist", "scara-bajd", "planar-3r"),
]


def planned(name: str, path: str, law: str, profile: Profile) -> Motion:
    """A robot of the catalogue with random links, between two random points, without dry friction."""
    text = f"robot: wheel.yaml\npoints: {{a: [0], b: [0]}}\npath: {path}\nsample: 0.05\nfriction: none\n"
    wheel = "{name: wheel, convention: standard, joints: [{type: revolute, a: 1}]}"
    plan = Motion.from_text(text.replace("wheel.yaml", wheel)).plan
    robot, random = dressed(name, calm=True), np.random.default_rng(3)
    places = {
        point: replace(plan.points[point], q=tuple(decimal(value) for value in random.uniform(-1, 1, robot.n)))
        for point in "ab"
    }
    control = replace(plan.control, law=law, kp=(number(400),) * robot.n, kd=(number(60),) * robot.n)
    steps = tuple(replace(step, profile=profile) for step in plan.steps)
    nothing = (None,) * robot.n
    limits = {"speed": nothing, "acceleration": nothing, "torque": nothing}
    return Motion(replace(plan, robot=robot, points=places, control=control, steps=steps, **limits))


def pendulum(start: str, friction: str = "{}", extra: str = "") -> Motion:
    return Motion.from_text(PENDULUM.replace("START", start).replace("FRICTION", friction) + extra)


def test_without_friction_energy_is_kept_and_the_pendulum_swings_as_it_must() -> None:
    run = pendulum("-pi/2 + 0.1", extra="friction: none\n").simulate()
    assert run.reached
    assert run.energy_error < 1e-8
    assert np.ptp(run.energy) < 1e-8
    # period of a pendulum of amplitude 0.1: 2 pi sqrt(l/g) (1 + a^2/16 + 11 a^4/3072)
    period = 2 * np.pi / np.sqrt(9.81) * (1 + 0.01 / 16 + 11e-4 / 3072)
    angle = np.interp(period, run.t, run.q[:, 0])
    assert angle == pytest.approx(-np.pi / 2 + 0.1, abs=1e-4)


def test_a_trapezoid_is_followed_across_the_jumps_of_its_acceleration() -> None:
    text = PENDULUM.replace("START", "0", 1).replace("START", "1").replace("time: 2", "time: 1.3")
    motion = Motion.from_text(
        text.replace("FRICTION", "{}") + "profile: trapezoidal\ncontrol: {law: computed-torque, kp: 100, kd: 20}\n"
    )
    run = motion.simulate()
    assert np.abs(run.q - motion(run.t)[0]).max() < 5e-12


def test_pd_with_gravity_settles_where_it_should() -> None:
    """At rest e = 0 with gravity compensated, and e = -g(q)/kp without."""
    text = "points: {a: [0], b: [0]}\npath: [a, {to: b, time: 8}]\ncontrol: {law: LAW, kp: 400, kd: 40}\n"
    head = PENDULUM.replace("START", "0").replace("FRICTION", "{}").split("points:")[0]
    with_gravity = Motion.from_text(head + text.replace("LAW", "pd-gravity")).simulate()
    assert np.abs(with_gravity.q).max() < 1e-9
    without = Motion.from_text(head + text.replace("LAW", "pd")).simulate()
    angle = without.q[-1, 0]
    assert angle == pytest.approx(-9.81 * np.cos(angle) / 400, rel=1e-6)


def test_a_plant_that_the_controller_does_not_know_is_not_followed_exactly() -> None:
    head = PENDULUM.replace("START", "0").replace("mass: 1", "mass: m1").replace("FRICTION", "{}").split("points:")[0]
    head = head.replace("links:", "parameters: {m1: 1}, links:")
    text = head + "points: {a: [0], b: [1]}\npath: [a, {to: b, time: 1}]\nplant: {m1: 1.2}\n"
    motion = Motion.from_text(text + "control: {law: computed-torque, kp: 100, kd: 20}\n")
    run = motion.simulate()
    assert 1e-3 < np.abs(run.q - motion(run.t)[0]).max() < 0.1
    assert run.energy_error < 1e-7


def test_every_law_is_known_and_the_ledger_is_what_the_start_had_and_the_motors_brought() -> None:
    assert set(NEEDS) == set(get_args(Law))
    energy, work, lost = np.array([[5.0, 6.5, 4.0], [0, 2.0, 2.0], [0, 0.5, 2.5]])
    run = Run(np.arange(3.0), *[np.zeros((3, 1))] * 3, energy, work, np.zeros(3), lost, None)
    assert run.energy_error == 0.5
    assert run.reached


SLIDE = """\
robot: {name: slide, convention: standard, gravity: [0, 0, -9.81], joints: [{type: prismatic}], links: [{mass: 1}]}
points: {a: [0], b: [1]}
path: [a, {to: b, time: 1}]
control: {law: computed-torque, kp: 100, kd: 20}
"""


@pytest.mark.parametrize(
    ("base", "work", "given"),
    [
        ("{z: t}", 9.81, 9.81),  # 1 m/s carries the weight and what the joint pushes with, m g + m qdd: no more work
        ("{z: t**2}", 11.81, 9.81),  # m (g + 2) on a way of 1 m, and m (g + 2 + qdd) by 2 t: 11.81 less 2 q(1)
        pytest.param("{rpy: [0, pi/2, 0]}", 0, 0, marks=pytest.mark.sweep),
        ("{rpy: [pi, 0, 0]}", -9.81, 0),
        ("{x: t**2}", 9.81, 2),
    ],
)
@pytest.mark.first(1)
def test_joints_and_base_do_the_work_of_lifting_a_kilogram_on_a_slide(base: str, work: float, given: float) -> None:
    motion = Motion.from_text(SLIDE + f"base: {base}\n")
    run, planned = motion.simulate(), motion.peaks[0]
    assert [planned.work, planned.base.work] == pytest.approx([work, given], abs=1e-9)
    assert [run.work[-1], run.base[-1]] == pytest.approx([work, given], abs=1e-8)
    assert run.energy_error < 1e-9


RIDES = """\
robot:
  name: arm
  convention: modified
  gravity: [1, -9.81, 2]
  base: [[0, 0, 1, 0.2], [1, 0, 0, 0], [0, 1, 0, 0.1], [0, 0, 0, 1]]
  joints: [{type: revolute, d: 0.2}, {type: prismatic, alpha: pi/2, a: 0.3, theta: pi/2}]
  links:
    - {mass: 2, com: [0.1, 0, 0.1], inertia: {xx: 0.1, yy: 0.1, zz: 0.1}, motor: {inertia: 2e-4, ratio: 50, mass: 0.3},
       friction: {viscous: 0.4, coulomb: DRY}}
    - {mass: 1, com: [0, 0.1, 0], inertia: {xx: 0.02, yy: 0.03, zz: 0.04}, motor: {inertia: 1e-4, ratio: 30}}
points: {a: [0.2, 0.1], b: [1, 0.4], c: [0.3, 0.2]}
path: [a, {to: b, time: 1/4, payload: {mass: 0.5, com: [0.1, 0, 0], inertia: [0.01, 0.01, 0.01]}}, {to: c, time: 1/4}]
sample: 1/256
"""

RIDDEN = [  # law, dry friction and how it is simulated, base, push and plant
    ("{law: computed-torque, kp: 100, kd: 20}", 0, "none", "{y: t**2, rpy: [t, t**2/2, 0.3]}", ""),
    ("{law: pd, kp: 40, kd: 9}", 3, "exact", "{z: t**2/2, rpy: [pi/3, 0, 0]}", ""),
    ("{law: pd, kp: 400, kd: 30, period: 1/128}", 0.3, "exact", "{z: cos(4*t)/9}", "PUSH"),
    ("{law: none}", 0, "none", "", "PUSH"),
]
RIDDEN += [
    pytest.param(*row, marks=pytest.mark.sweep)
    for row in (
        ("{law: pd-gravity, kp: 900, kd: 60}", 0.8, "smooth", "{x: sin(3*t), rpy: [0, t, 0]}", "plant: {payload: 0.2}"),
        ("{law: computed-torque, kp: 100, kd: 20, period: 1/256}", 0, "none", "{rpy: [0, 0.4, 2*t]}", "PUSH"),
        ("{law: none}", 0.2, "smooth", "{x: t**3, rpy: [t, 0, 0]}", "PUSH"),
        ("{law: pd, kp: 90, kd: 9, period: 1/64}", 0.1, "smooth", "", "PUSH"),
    )
]


@pytest.mark.parametrize(("law", "dry", "friction", "base", "extra"), RIDDEN)
@pytest.mark.first(1)
def test_work_is_the_integral_of_torque_by_velocity_and_the_ledger_closes(
    law: str, dry: float, friction: str, base: str, extra: str
) -> None:
    push = "disturbance: [{joint: q1, torque: 5, start: 0.1, end: 0.3}, {joint: q2, torque: -9, start: 0.05, end: 9}]"
    text = RIDES.replace("DRY", str(dry)) + f"control: {law}\nfriction: {friction}\n{extra.replace('PUSH', push)}\n"
    motion = Motion.from_text(text + (f"base: {base}\n" if base else ""))
    run = motion.simulate()
    assert run.reached
    power = (run.tau * run.qd).sum(axis=1)
    if "period" in law:  # the torque of a row was held since the row before
        work = np.append(0, np.cumsum((run.tau[1:] * np.diff(run.q, axis=0)).sum(axis=1)))
        assert len(np.unique(run.tau[:, 0])) == motion.duration / evaluate(motion.plan.control.period, {})  # type: ignore[arg-type]
    else:
        work = integrate.cumulative_simpson(power, x=run.t, initial=0)
    largest = np.abs(power).max()
    assert np.abs(run.work - work).max() <= 1e-4 * largest + 1e-12
    assert run.energy_error <= 1e-8 * max(largest, float(np.ptp(run.energy)), 1)
    if base and motion.plan.control.law == "computed-torque" and not extra:
        planned = [sum(peaks.work for peaks in motion.peaks), sum(peaks.base.work for peaks in motion.peaks)]  # type: ignore[union-attr]
        assert [run.work[-1], run.base[-1]] == pytest.approx(planned, abs=1e-6)


def test_what_needs_scipy_or_looks_too_often_is_refused_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy.integrate", None)
    with pytest.raises(TargetError, match=r"simulations need scipy, .*-m pip install .*'scipy>="):
        pendulum("0").simulate()
    with pytest.raises(RobotFileError, match=r"control, period: 1e\+09 samples of the controller in 2 s; allowed"):
        pendulum("0", extra="control: {law: pd, kp: 1, kd: 1, period: 2e-9}\n")


@pytest.mark.parametrize("seed", seeds(50, usual=0))
def test_the_ledger_closes_for_every_law_friction_load_push_and_plant(seed: int) -> None:
    motion = Motion.from_text(simulated(np.random.default_rng(seed)))
    run = motion.simulate()
    turned_over = max(1.0, float(np.ptp(run.energy)), float(np.abs(run.work).max()))
    assert run.reached or motion.plan.control.period, "a slow look may drive an arm away"
    assert run.energy_error <= 1e-8 * turned_over
    assert (np.diff(run.lost) >= -1e-12).all()


@pytest.mark.sweep
@pytest.mark.parametrize("name", TEN)
@pytest.mark.parametrize("profile", [Profile.TRAPEZOIDAL, Profile.QUINTIC])
def test_computed_torque_follows_on_ten_robots(name: str, profile: Profile) -> None:
    motion = planned(name, "[a, {to: b, time: 1}, {to: a, time: 1}]", "computed-torque", profile)
    run = motion.simulate()
    assert np.abs(run.q - motion(run.t)[0]).max() <= 1e-8


@pytest.mark.sweep
@pytest.mark.parametrize("name", TEN)
@pytest.mark.parametrize("law", ["pd", "pd-gravity"])
def test_ten_robots_settle_where_gains_hold_what_gravity_leaves(name: str, law: str) -> None:
    """Kp e = g(q) of the plant, with its load, less what the controller takes off; by potential energies."""
    motion = planned(name, "[a, {to: a, time: 30}]", law, Profile.QUINTIC)
    motion = Motion(replace(motion.plan, plant_payload=Payload(number(1), (number(0),) * 3, (number(0),) * 3)))
    run = motion.simulate()
    q, step = run.q[-1], 1e-6
    plant = stages_of(motion.plan, motion.trajectory, motion.values, None, None)[0].plant
    lifted = [plant.functions("potential_energy", q + s * step * np.eye(q.size)) for s in (1, -1)]
    left = (lifted[0] - lifted[1]) / (2 * step)
    if law == "pd-gravity":
        left = left - Oracle.of(motion.plan.robot).evaluate("gravity_vector", q)
    assert np.abs(run.qd[-1]).max() < 1e-9
    assert 400 * (motion(0.0)[0] - q) == pytest.approx(left, abs=1e-6)
    assert np.abs(left).max() > 1
