"""Motions of trees: ends that follow poses and ways, payloads at any of them, and free trees."""

from functools import cache

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.motion.incremental import increments_of
from derive.motion.motion import Motion
from derive.motion.output.printed import printed_hand, printed_weights, samples
from derive.plans.catalogue import new_plan_text
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.places import ROOT
from tests.refusals import one_message

TORSO = (ROOT / "derive/robot/catalogue/two-armed-torso.yaml").read_text(encoding="utf-8")
TORSO = TORSO.replace("runtime: [m2]", "inverse: {task: [x, y, z], given: [q1]}\nruntime: [m2]").split("runtime")[0]
ROBOT = "robot:\n" + "".join(f"  {line}\n" for line in TORSO.splitlines())
POINTS = """\
points:
  rest: [0, 0.3, 0.2, -0.8, 0.3, -0.2, -0.8]
  A: {pose: {p: [0.45, 0.2, 1.0]}, end: left}
  B: {pose: {p: [0.35, 0.3, 0.9]}, end: left}
  C: {pose: {p: [0.4, -0.3, 0.95]}, end: right}
"""
RIGHT = "A: {pose: {p: [0.45, 0.2, 1.0]}, end: left}"
PLAN = f"""{ROBOT}{POINTS}path:
  - rest
  - {{to: A, time: 1}}
  - {{to: B, time: 1, line: yes, payload: 0.5}}
  - {{to: C, time: 1, line: yes}}
  - {{to: rest, time: 1, payload: {{mass: 0.3, end: right}}}}
control: {{law: computed-torque, kp: 100, kd: 20}}
"""
FLOATING = """\
robot:
  name: satellite
  convention: modified
  root: {type: floating, link: {mass: 8, com: [0.05, 0, 0.02], inertia: {xx: 0.4, yy: 0.5, zz: 0.6}}}
  joints:
    - {type: revolute, after: base, d: 0.2}
    - {type: revolute, alpha: pi/2, a: 0.1}
    - {type: fixed, name: dish, after: base, mount: [[1, 0, 0, 0], [0, 0, 1, 0.3], [0, -1, 0, 0], [0, 0, 0, 1]]}
    - {type: prismatic, alpha: pi/2}
  ends: {up: q2, side: q3}
  gravity: [0, 0, -9.81]
  links: [{mass: 1, com: [0, 0, 0.1], inertia: {xx: 0.02, yy: 0.02, zz: 0.01}}, {mass: 0.7, com: [0.2, 0, 0]},
    {mass: 0.4, com: [0, 0, 0.1], inertia: {xx: 0.01, yy: 0.01, zz: 0.01}}, {mass: 0.6, com: [0, 0.05, 0]}]
curves: {x: t, z: 2*t, yaw: 1.5*t, pitch: 0.3 + 0.2*t, roll: t, q1: 2*t, q2: 0.4 - t, q3: 0.1}
time: 2
"""
PLANAR = """\
robot: human-skeleton
curves: {x: t/2, y: 3*t, phi: 0.7*t, q1: 0.3 + 2*t, q2: -t, q4: 0.2 - t, q7: t, q9: -2*t, q10: 1.3*t}
time: 2
"""


@cache
def reach() -> Motion:
    return Motion.from_text(PLAN)


def test_an_end_goes_where_the_plan_says_and_other_joints_stay() -> None:
    t = np.linspace(0, 4, 81)
    q, left, right = reach()(t)[0], reach().poses(t, "left"), reach().poses(t, "right")
    a, b, c = (np.array(p) for p in ([0.45, 0.2, 1.0], [0.35, 0.3, 0.9], [0.4, -0.3, 0.95]))
    oracle = Oracle.of(reach().plan.robot)
    for end, poses in (("left", left), ("right", right)):
        assert poses == pytest.approx(oracle.evaluate(f"forward_kinematics_{end}", q), abs=1e-13)
    assert np.array([left[20], left[40], right[60]])[:, :3, 3] == pytest.approx(np.array([a, b, c]), abs=1e-9)
    assert not q[:61, 0].any()  # the waist is given
    assert q[:41, 4:] == pytest.approx(np.tile([0.3, -0.2, -0.8], (41, 1)), abs=1e-14)
    assert q[40:61, 1:4] == pytest.approx(np.tile(q[40, 1:4], (21, 1)), abs=1e-14)
    off = np.cross(left[20:41, :3, 3] - a, b - a)
    assert np.abs(off).max() < 1e-9  # a line
    assert q[-1] == pytest.approx([0, 0.3, 0.2, -0.8, 0.3, -0.2, -0.8])


def test_each_payload_loads_its_own_arm() -> None:
    """Against the oracle of wrenches: the weight of a mass at rest, and zero torque on the other arm."""
    bare = Motion.from_text(PLAN.replace(", payload: 0.5", "").replace(", payload: {mass: 0.3, end: right}", ""))
    oracle = Oracle.of(bare.plan.robot)
    for time, end, mass in ((1.0, "left", 0.5), (4.0 - 1e-9, "right", 0.3)):
        added, q = reach().torques(time) - bare.torques(time), bare(time)[0]
        jacobian, qdd = oracle.evaluate(f"jacobian_{end}", q)[:3], bare(time)[2]
        assert added == pytest.approx(mass * jacobian.T @ (jacobian @ qdd + [0, 0, 9.81]), abs=1e-6)
        assert not added[[4, 5, 6] if end == "left" else [1, 2, 3]].any()


def test_a_law_that_knows_all_payloads_follows_and_each_end_is_printed() -> None:
    run = reach().simulate()
    assert np.abs(run.q - reach()(run.t)[0]).max() < 1e-6
    assert run.energy_error < 1e-6
    assert samples(reach(), run)[1].shape == (401, 1 + 3 * 7 + 4)
    lines = list(printed_hand(reach()))
    assert [line for line in lines if line.startswith("hand")] == ["hand, end left", "hand, end right"]
    assert [line[:13] for line in printed_weights(reach())][::4] == ["q1 moves left", "q1 moves righ"]


def test_increments_lead_an_end_to_its_pose() -> None:
    path = "path: [rest, {to: A, time: 1}, {to: C, time: 1}]\n"
    found = increments_of(Motion.from_text(ROBOT + POINTS + path), 40)
    assert all(each.is_closed and each.q.shape == (41, 4) for each in found)
    with pytest.raises(DeriveError, match="increments to rest, which is a point of no end; write it as a pose"):
        increments_of(reach(), 10)


@pytest.mark.parametrize("text", [PLANAR, FLOATING], ids=["planar", "floating"])
def test_a_free_tree_keeps_its_energy_and_gravity_alone_changes_its_momentum(text: str) -> None:
    motion = Motion.from_text(text)
    run = motion.simulate()
    assert run.reached
    assert np.abs(run.tau).max() == 0
    assert np.ptp(run.energy) < 1e-6
    oracle = Oracle.of(motion.plan.robot, {"g": 9.81} if "human" in text else {})
    inertia = oracle.evaluate("inertia_matrix", run.q)
    slides = [k for k, joint in enumerate(motion.plan.robot.joints[:3]) if not joint.is_revolute]
    momentum = np.einsum("tij,tj->ti", inertia, run.qd)[:, slides]
    lost = np.outer(run.t, inertia[0, 0, 0] * 9.81 * np.eye(len(slides))[-1])
    assert momentum == pytest.approx(momentum[0] - lost, abs=1e-6)


WRONG = {
    "A: {pose: {p: [0.45, 0.2, 1.0]}}": "points, A: a pose of two-armed-torso without end; allowed: one of left, right",
    "A: {pose: {p: [0.45, 0.2, 1.0]}, end: lft}": "points, A, end: end 'lft' of two-armed-torso; allowed: left, right",
    "A: {pose: {p: [9, 0.2, 1.0]}, end: left}": "the arm does not reach A",
    "{to: rest, time: 1, line: yes}": "path entry 2: the way to rest of two-armed-torso without end",
    "{to: rest, time: 1, payload: 1}": "path entry 2: a payload of two-armed-torso without end",
    "{to: A, time: 1, line: yes, end: right}": "path entry 2: A is a pose of end left, and end right follows the way",
    "{to: rest, time: 1, end: left}": "path entry 2, end: an end, and no line, arc or payload is its own; leave it out",
    "{to: A, time: 1, payload: {mass: 1, end: up}}": "path entry 2, payload, end: end 'up' of two-armed-torso; allowed",
}


@pytest.mark.parametrize("row", WRONG)
def test_a_wrong_end_is_told_at_its_place(row: str) -> None:
    points, step = (POINTS, row) if row.startswith("{") else (POINTS.replace(RIGHT, row), "{to: A, time: 1}")
    with one_message(DeriveError, r"plan.yaml:\d+:\d+", WRONG[row]):
        Motion.from_text(f"{ROBOT}{points}path: [rest, {step}]\n", "plan.yaml")


def test_a_root_that_moves_follows_no_pose() -> None:
    text = "robot: human-skeleton\npoints: {a: {pose: {p: [0, 1, 0]}, end: head}}\npath: [a, {to: a, time: 1}]\n"
    with pytest.raises(DeriveError, match="2:13: points, a: a pose of human-skeleton, whose root moves"):
        Motion.from_text(text)


@pytest.mark.parametrize("name", ["two-armed-torso", "human-skeleton"])
def test_a_new_plan_of_a_tree_is_one(name: str) -> None:
    text = new_plan_text("new", Robot.load(name), name)
    assert Motion.from_text(text).duration == 4
    assert ("end: left" in text) is (name == "two-armed-torso")
