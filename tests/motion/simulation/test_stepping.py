"""Simulations step by step, and friction that sticks: closed forms, complementarity, and both ways of integration."""

from dataclasses import replace

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.simulation import stepping
from derive.motion.simulation.simulation import NEEDS, Controller, Run, stages_of
from derive.motion.simulation.stepping import DIVERGED, Plant, held_arm, smooth
from derive.motion.simulation.sticking import exact, stepped
from derive.motion.torques.functions import Functions
from derive.publish import modules
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.motion.plans import PICK_AND_PLACE, PUMA_FALLS
from tests.random_robots import swept
from tests.targets.generated_models import needs_compiler


@pytest.fixture(scope="module")
def plant() -> Plant:
    motion = Motion.from_text(PUMA_FALLS.replace("TIME", "1"))
    values = {"g": 9.81, "a2": 0.4318, "a3": 0.0203, "d3": 0.15005, "d4": 0.4318}
    return stages_of(motion.plan, motion.trajectory, values, None, None)[0].plant


def state(plant: Plant) -> np.ndarray:
    return np.concatenate([[0, 0.8, -1.5, 0.2, 0.3, 0.5], np.zeros(6), [0, 0]])


@pytest.mark.parametrize("step", [smooth, exact, stepped])
def test_what_diverges_says_when_and_where_and_keeps_its_rows(plant: Plant, step: object) -> None:
    def driven(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        return 5 * qd + np.array([0, 0, 0, 0, 0, 1.0])

    times = np.linspace(0.01, 5, 500)
    rows, divergence = step(plant, driven, state(plant), (0.0, 5.0), times)  # type: ignore[operator]
    assert 0 < len(rows) < 500
    assert times[len(rows) - 1] <= divergence.time < times[len(rows)]
    assert np.abs(divergence.qd).max() == pytest.approx(DIVERGED, rel=0.7)
    assert np.isfinite(rows).all()


def test_large_gains_of_a_light_joint_take_few_steps() -> None:
    """Velocities that decay within microseconds hold explicit solvers up: a hundred thousand calls and more."""
    arm = "gravity: [0, -9.81, 0], joints: [{type: revolute, a: 0.1}], links: [{mass: 0.01}]"
    motion = Motion.from_text(f"""robot: {{name: p, convention: standard, {arm}}}
points: {{a: [0], b: [1]}}
path: [a, {{to: b, time: 0.3}}]
control: {{law: pd, kp: 400, kd: 20}}\n""")
    (stage,) = stages_of(motion.plan, motion.trajectory, {}, None, None)
    calls = 0

    def counted(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        return stage.law(t, q, qd)

    (end,), divergence = smooth(stage.plant, counted, np.zeros(4), (0.0, 0.3), np.array([0.3]))
    assert divergence is None
    assert calls < 5000
    assert end[0] == pytest.approx(1, abs=1e-3)


WANTED, QD, QDD = np.array([0.4, -0.7]), np.array([0.2, 0.3]), np.array([-1.0, 2.0])
Q, SPEED = np.array([0.5, -0.4]), np.array([0.1, -0.2])
CONTROLLED = """{name: arm, convention: standard, gravity: [0, -9.81, 0],
  joints: [{type: revolute, a: 1}, {type: revolute, a: 1}], links: [{mass: 1}, {mass: 2}]}"""


def torque(law: str) -> np.ndarray:
    functions = Functions(Robot.from_text(CONTROLLED), NEEDS[law], {}) if NEEDS[law] else None
    kp, kd = np.array([100.0, 50]), np.array([20.0, 10])
    return Controller(law, kp, kd, lambda _: (WANTED, QD, QDD), functions)(0.0, Q, SPEED)


def test_laws_are_those_of_their_books() -> None:
    oracle = Oracle.of(Robot.from_text(CONTROLLED))
    pull = np.array([100.0, 50]) * (WANTED - Q) + np.array([20.0, 10]) * (QD - SPEED)
    assert torque("none").tolist() == [0, 0]
    assert torque("pd") == pytest.approx(pull)
    assert torque("pd-gravity") == pytest.approx(pull + oracle.evaluate("gravity_vector", Q))
    expected = oracle.evaluate("inverse_dynamics", Q, SPEED, QDD + pull)
    assert torque("computed-torque") == pytest.approx(expected)


HELD = """\
robot: {name: arm, convention: standard, gravity: [0, -9.81, 0], parameters: {m2: 1}, joints:
    [{type: revolute, a: 1}, {type: prismatic, alpha: pi/2}],
  links: [{mass: 2, com: [-0.5, 0, 0], inertia: {zz: 0.2}, friction: {viscous: 0.3, coulomb: [1.5, 0.9]}},
    {mass: m2, friction: {coulomb: 0.5}}]}
points: {a: [0.4, 0.1], b: [1, 0.3]}
path: [a, {to: b, time: 0.5, payload: 0.3}, {to: a, time: 0.3}]
plant: {m2: 1.25}
disturbance: [{joint: q1, torque: 3, start: 0.2, end: 0.25}]
"""
SAMPLED = "control: {law: LAW, kp: 100, kd: 20, period: 0.004}\n"


@pytest.fixture
def held_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """All other functions are in NumPy: their compilation is tested elsewhere."""
    monkeypatch.setattr(modules, "find_compiler", lambda: None)


def runs(extra: str) -> tuple[Run, Run]:
    motion = Motion.from_text(HELD + extra)
    return motion.simulate(calls=1e9), motion.simulate(calls=0)


@needs_compiler
@pytest.mark.usefixtures("held_alone")
@pytest.mark.parametrize(
    "extra",
    [
        "friction: none\n",
        pytest.param("friction: none\n" + SAMPLED.replace("LAW", "pd-gravity"), marks=pytest.mark.sweep),
        "friction: smooth\n" + SAMPLED.replace("LAW", "computed-torque"),
    ],
    ids=["falls", "sampled, without dry friction", "sampled, with dry friction"],
)
def test_both_are_one_motion(extra: str) -> None:
    ours, theirs = runs(extra)
    assert ours.reached
    assert np.abs(ours.q - theirs.q).max() < 1e-9
    assert np.abs(ours.qd - theirs.qd).max() < 1e-7
    assert np.abs(ours.tau - theirs.tau).max() < 1e-6
    assert ours.energy_error < 1e-8


@needs_compiler
@pytest.mark.usefixtures("held_alone")
def test_what_diverges_says_where_and_keeps_the_rows_so_far() -> None:
    ours, theirs = runs("friction: none\ncontrol: {law: pd, kp: 1, kd: 100000, period: 0.01}\n")
    assert ours.divergence.time == pytest.approx(theirs.divergence.time, abs=0.01)
    assert np.abs(ours.divergence.qd).max() >= 1e4
    assert 1 <= ours.t.size == theirs.t.size
    assert np.isfinite(ours.q).all()


@needs_compiler
@pytest.mark.usefixtures("held_alone")
def test_a_time_as_near_as_rounding_is_reached() -> None:
    motion = Motion.from_text(HELD + "friction: none\n")
    plant = stages_of(motion.plan, motion.trajectory, motion.values, 1e9, None)[0].plant
    state = np.array([0.4, 0.1, 1.0, -0.5, 0.0, 0.0])
    for start in (0.5, 7.0, 1e5):
        end = np.nextafter(start, np.inf)
        rows, divergence = plant.held(plant, np.zeros(2), state, (start, end), np.array([end]))
        assert divergence is None
        assert rows[0] == pytest.approx(state, abs=1e-9)


def test_few_evaluations_are_not_worth_a_compiler_and_without_it_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = Motion.from_text(HELD.replace("name: arm", "name: another")).plan.robot
    monkeypatch.setattr(stepping, "find_compiler", pytest.fail)
    assert held_arm(robot, 1000) is None
    monkeypatch.setattr(stepping, "find_compiler", lambda: None)
    assert held_arm(robot, 1e9) is None


SHORT = PICK_AND_PLACE.replace("time: 3", "time: 1/2").replace("friction: smooth", "friction: none")
CARRYING = SHORT.replace("{to: B, time: 1/2}", "{to: B, time: 1/2, payload: {mass: 2, com: [0.1, 0, 0.2]}}")


def error(text: str) -> float:
    motion = Motion.from_text(text)
    run = motion.simulate()
    assert run.reached
    assert run.energy_error < 1e-6
    return float(np.abs(run.q - motion(run.t)[0]).max())


def test_a_stage_lasts_as_long_as_load_and_push_stay_and_its_plant_carries_the_load() -> None:
    text = CARRYING + "disturbance: [{joint: q2, torque: 3, start: 0.7, end: 1.2}]\n"
    motion = Motion.from_text(text)
    stages = stages_of(motion.plan, motion.trajectory, motion.values, None, None)
    assert [stage.start for stage in stages] == [0, 0.5, 0.7, 1, 1.2]
    assert [stage.plant.push[1] for stage in stages] == [0, 0, 3, 3, 0]
    motion = Motion.from_text(CARRYING)
    plant = stages_of(motion.plan, motion.trajectory, motion.values, None, None)[1].plant
    for t in (0.55, 0.7, 0.9):
        q, qd, qdd = motion(t)
        assert plant.functions("forward_dynamics", q, qd, motion.torques(t)) == pytest.approx(qdd, abs=1e-10)


def test_a_load_is_followed_where_the_controller_knows_it() -> None:
    assert error(CARRYING) < 1e-8
    assert 1e-3 < error(SHORT + "plant: {payload: {mass: 2, com: [0.1, 0, 0.2]}}\n") < 1


def test_a_push_moves_an_arm_as_a_motor_would() -> None:
    """From rest with gravity compensated by B^-1 push; PD holds it at push/kp."""
    text = (
        "robot: {name: arm, convention: standard, gravity: [0, -9.81, 0],\n"
        "  joints: [JOINT, JOINT], links: [LINK, LINK]}\n"
        "points: {a: [0.3, 0.7]}\npath: [a, {to: a, time: 4}]\nfriction: none\nsample: 0.002\n"
        "control: {law: pd-gravity, kp: 90, kd: 45}\ndisturbance: [{joint: q1, torque: 0.9, start: 0.5, end: 9}]\n"
    )
    text = text.replace("JOINT", "{type: revolute, a: 1}").replace("LINK", "{mass: 1}")
    motion = Motion.from_text(text)
    run = motion.simulate()
    assert np.abs(run.q[run.t <= 0.5] - run.q[0]).max() < 1e-10
    assert run.q[-1] - run.q[0] == pytest.approx([0.01, 0], abs=1e-4)
    inertia = Oracle.of(motion.plan.robot).evaluate("inertia_matrix", run.q[0])
    at = int(np.searchsorted(run.t, 0.501))
    expected = np.linalg.solve(inertia, [0.9, 0]) * (run.t[at] - 0.5)
    assert run.qd[at] == pytest.approx(expected, rel=0.2)
    assert run.energy_error < 1e-8


SLIDES = """\
robot: {name: slides, convention: standard, gravity: [0, -9.81, 0], joints: [{type: prismatic}, {type: prismatic}],
  links: [{mass: 3, friction: {coulomb: FIRST}}, {mass: 2, friction: {coulomb: 4}}]}
points: {a: [0, 0]}
path: [a, {to: a, time: 2}]
friction: exact
disturbance: [{joint: q2, torque: 10, end: 1}]
"""
"""A slide of 2 kg on one of 3 kg, on one line across gravity; the upper one is pushed."""

ARM = """\
robot: {name: arm, convention: standard, gravity: [0, -9.81, 0],
  joints: [{type: revolute, a: 1}, {type: revolute, a: 0.8}, {type: revolute, a: 0.5}],
  links: [{mass: 2, com: [-0.5, 0, 0], friction: {coulomb: 6, viscous: 0.3}}, {mass: 1.5, friction: {coulomb: 4}},
    {mass: 1, com: [-0.2, 0, 0], friction: {coulomb: 1.5}}]}
points: {a: [-1, 0.3, 0.2], b: [-0.7, 0.2, 0.5]}
path: [a, {to: b, time: 1}, {to: a, time: 1}, {to: a, time: 0.5}]
control: {law: pd, kp: 60, kd: 4}
friction: exact
"""


def plant_of(text: str) -> Plant:
    motion = Motion.from_text(text)
    return stages_of(motion.plan, motion.trajectory, motion.values, None, None)[0].plant


def test_one_joint_stands_while_the_other_slides_and_both_come_to_rest() -> None:
    """The upper slide speeds up at (10 - 4)/2 and slows down at 4/2; the lower one is pulled by 6, then 4 of 7 N."""
    run = Motion.from_text(SLIDES.replace("FIRST", "7")).simulate()
    assert not run.q[:, 0].any()
    assert not run.qd[:, 0].any()
    early, t = run.t <= 1, run.t
    assert run.qd[early, 1] == pytest.approx(3 * t[early], abs=1e-12)
    assert run.qd[~early, 1] == pytest.approx(3 - 2 * (t[~early] - 1), abs=1e-12)
    assert run.q[-1, 1] == pytest.approx(1.5 + 3 - 1, abs=1e-11)
    assert run.energy_error < 1e-12
    longer = Motion.from_text(SLIDES.replace("FIRST", "7").replace("time: 2", "time: 3")).simulate()
    assert longer.q[-1, 1] == pytest.approx(1.5 + 9 / 4, abs=1e-11)
    assert (longer.qd[longer.t > 2.51] == 0).all()


def test_where_the_reaction_is_more_than_breakaway_both_slide() -> None:
    """With 5 N below, 2 a2 + 2 a1 = 10 - 4 and 5 a1 + 2 a2 = 5 (pulled back): a1 = -1/3, a2 = 10/3."""
    run = Motion.from_text(SLIDES.replace("FIRST", "5")).simulate()
    early, t = run.t <= 1, run.t[run.t <= 1]
    assert run.qd[early] == pytest.approx(np.stack([-t / 3, 10 * t / 3], axis=1), abs=1e-12)
    assert run.energy_error < 1e-10


@pytest.mark.first(1)
@pytest.mark.parametrize("least", [3, 0, *swept(6)])
def test_friction_is_complementary_at_every_sample(least: float) -> None:
    """What stands needs less than breakaway, by an oracle's dynamics, and what slips loses energy."""
    motion = Motion.from_text(ARM.replace("6, viscous", f"[6, {least}], viscous"))
    run, oracle = motion.simulate(), Oracle.of(motion.plan.robot)
    ahead, back, viscous, seen = np.array([6, 4, 1.5]), np.array([least, 4, 1.5]), np.array([0.3, 0, 0]), set()
    for q, qd, after, tau in zip(run.q[:-1], run.qd[:-1], run.qd[1:], run.tau[:-1], strict=True):
        stands = (qd == 0) & (after == 0)
        seen.add(tuple(stands))
        inertia, pull = oracle.evaluate("inertia_matrix", q), tau - oracle.evaluate("gravity_vector", q)
        pull -= oracle.evaluate("coriolis_vector", q, qd) + viscous * qd + np.where(qd > 0, ahead, back) * np.sign(qd)
        slips = qd != 0
        if (slips | stands).sum() < 3:
            continue  # it breaks away before the next sample
        qdd = np.zeros(3)
        qdd[slips] = np.linalg.solve(inertia[np.ix_(slips, slips)], pull[slips])
        assert (np.abs(pull - inertia @ qdd - (ahead - back) / 2)[stands] <= (ahead + back)[stands] / 2 + 1e-9).all()
    assert len(seen) >= 4
    assert run.energy_error < 1e-9
    assert (np.diff(run.lost) >= 0).all()


def test_small_steps_and_smooth_friction_come_to_the_same_motion_and_breakaway_itself_moves_nothing() -> None:
    plant = replace(plant_of(ARM), coulomb=np.array([[3.0, 2, 0.5], [2.0, 3, 0.5]]))
    start = np.concatenate([[0.2, 0.5, -0.3], np.zeros(5)])
    idle = np.zeros(3)
    times = ((0.0, 0.4), np.array([0.4]))
    ends = [method(plant, lambda *_: idle, start, *times)[0][0] for method in (exact, smooth, stepped)]
    assert np.abs(ends[0][3:6]).max() > 1
    assert ends[1] == pytest.approx(ends[0], abs=2e-3)
    assert ends[2] == pytest.approx(ends[0], abs=3e-2)
    plant = replace(plant_of(SLIDES.replace("FIRST", "7")), coulomb=np.array([[9.0, 10]] * 2))
    (end,), divergence = exact(plant, lambda *_: np.zeros(2), np.zeros(6), (0.0, 1.0), np.array([1.0]))
    assert divergence is None
    assert not end.any()


@pytest.mark.parametrize("kind", ["exact", "smooth"])
def test_a_slide_breaks_away_at_other_forces_forwards_and_backwards(kind: str) -> None:
    """2 kg for a second; what it stands against, smooth friction lets creep."""
    text = SLIDES.replace("FIRST", "99").replace("friction: exact", f"friction: {kind}").replace("time: 2", "time: 1")
    for coulomb, ends in {"[7, 3]": {6: 0, 9: 1, -2: 0, -5: -1}, "[0, 3]": {0: 0, 2: 1, -2: 0}}.items():
        for push, speed in ends.items():
            pushed = text.replace("coulomb: 4", f"coulomb: {coulomb}").replace("torque: 10", f"torque: {push}")
            run = Motion.from_text(pushed).simulate()
            assert run.qd[-1, 1] == pytest.approx(speed, abs=1e-9 if kind == "exact" else 2e-4)
            assert (np.diff(run.lost) >= -1e-12).all()


def test_large_gains_of_a_light_link_do_not_stop_a_simulation() -> None:
    """20 N m s/rad on 0.0004 kg m^2 decay at 50,000/s; an explicit solver would take as many steps."""
    text = ARM.replace("[-0.2, 0, 0], friction", "[0, 0, 0], friction").replace("mass: 1,", "mass: 0.001,")
    plant, calls = plant_of(text.replace("a: 0.5", "a: 0.1")), 0

    def stiff(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        return -60 * q - 20 * qd

    (end,), divergence = exact(plant, stiff, np.array([0.3, 0.2, 0.5, 0, 0, 0, 0, 0]), (0.0, 0.5), np.array([0.5]))
    assert divergence is None
    assert calls < 20_000
    assert np.abs(end[:3]).max() < 0.5


def test_chatter_does_not_stop_a_simulation() -> None:
    """A motor that pushes against the velocity with more than breakaway: no way of slipping lasts."""
    plant = replace(plant_of(SLIDES.replace("FIRST", "7")), coulomb=np.ones((2, 2)), push=np.zeros(2))

    def chatter(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        return np.where(qd > 0, -5.0, 5.0)

    (end,), divergence = exact(plant, chatter, np.zeros(6), (0.0, 0.03), np.array([0.03]))
    assert divergence is None
    assert np.abs(end[2:4]).max() < 0.05
