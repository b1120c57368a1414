"""The table of a motion, and what exceeds limits."""

from __future__ import annotations

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.output.table import JOINT_HEADER, csv_bytes, joint_table, samples, simulated_table, table, violations
from tests.motion.plans import PICK_AND_PLACE

LIMITED = """\
robot: {name: arm, convention: standard, gravity: [0, -9.81, 0], links: [{mass: 1}],
  joints: [{type: revolute, a: 1, limits: [-1, 1], speed: SPEED, torque: TORQUE}]}
points: {a: [-1], b: [1]}
path: [a, {to: b, time: 1}, {to: a, time: 3}]
"""


def test_each_segment_has_a_row_with_the_joint_that_has_most_to_do() -> None:
    rows = table(Motion.from_text(PICK_AND_PLACE))
    assert rows[0] == (
        "rest -> A",
        "3 s",
        "q1 5*pi/16 = 0.9817 rad/s",
        "q1 5*sqrt(3)*pi/27 = 1.008 rad/s^2",
        "tau1 376.8 N m at 0.6172 s",
        "17.98 J",
    )
    assert rows[1][2] == "q3 5/4 = 1.25 m/s"


def test_each_joint_has_a_row_with_its_root_mean_square_its_power_and_its_work() -> None:
    motion = Motion.from_text(PICK_AND_PLACE)
    rows = joint_table(motion)
    assert len(rows) == 5 * 4
    load = motion.peaks[0].loads[1]
    assert rows[1][:3] == ("", "q2", "5*pi/16 = 0.9817 rad/s")
    assert rows[1][5:] == (f"{load.rms:.4g} N m", f"{load.power:.4g} W", f"{load.work:.4g} J")
    assert (rows[6][2], rows[6][4]) == ("5/4 = 1.25 m/s", "-70.94 N at 5.493 s")
    assert all(len(row) == len(JOINT_HEADER) for row in rows)


def test_nothing_that_moves_is_said_so() -> None:
    text = PICK_AND_PLACE.replace("path: [rest, {to: A, time: 3}", "path: [rest, {to: rest, time: 1}")
    assert table(Motion.from_text(text))[0][2:4] == ("none", "none")


def test_what_exceeds_a_limit_is_told_with_time_and_amount() -> None:
    lines = violations(Motion.from_text(LIMITED.replace("SPEED", "2").replace("TORQUE", "100")))
    assert lines == ["q1: speed 3.75 rad/s at 0.5 s exceeds the limit 2 by 1.75 rad/s"]


def test_what_keeps_to_its_limits_is_not_told() -> None:
    assert violations(Motion.from_text(LIMITED.replace("SPEED", "3.75").replace("TORQUE", "100"))) == []


def test_limits_of_the_plan_count_beside_those_of_the_robot() -> None:
    """The smaller of both speeds, and an acceleration, which the robot file does not limit."""
    text = LIMITED.replace("SPEED", "3").replace("TORQUE", "100") + "speed: [3.5]\nacceleration: [10]\n"
    speed, acceleration = violations(Motion.from_text(text))
    assert speed.endswith("exceeds the limit 3 by 0.75 rad/s")
    assert acceleration.startswith("q1: acceleration ")
    assert acceleration.endswith(" rad/s^2")


def test_of_a_simulation_what_happens_is_compared() -> None:
    text = LIMITED.replace("SPEED", "3.7").replace("TORQUE", "100") + "control: {law: pd, kp: 300, kd: 30}\n"
    motion = Motion.from_text(text)
    (line,) = [line for line in violations(motion, motion.simulate()) if "speed" in line]
    assert line.startswith("simulated q1: speed ")
    assert "exceeds the limit 3.7" in line


def test_a_torque_beyond_its_limit_is_found_where_it_is_largest() -> None:
    motion = Motion.from_text(LIMITED.replace("SPEED", "10").replace("TORQUE", "5"))
    (found,) = motion.violations
    tau = motion.torques(motion.times)[:, 0]
    assert (found.what, found.limit) == ("torque", 5)
    assert np.abs(tau).max() < found.value < np.abs(tau).max() * (1 + 1e-4)
    assert found.value == pytest.approx(motion.peaks[0].loads[0].peak, rel=1e-10)
    assert found.value == pytest.approx(motion.torques(found.time)[0], rel=1e-12)
    assert found.value >= np.abs(motion.torques(np.linspace(0, 4, 40_001))).max()


def test_samples_have_a_column_for_each_quantity() -> None:
    motion = Motion.from_text(LIMITED.replace("SPEED", "10").replace("TORQUE", "50"))
    names, rows = samples(motion)
    assert names == ("t", "q1", "qd1", "qdd1", "tau1")
    assert rows.shape == (401, 5)
    t, q, qd, qdd, tau = rows[37]
    assert tau == pytest.approx(qdd + 9.81 * np.cos(q), rel=1e-12)
    assert (q, qd) == pytest.approx(tuple(value[0] for value in motion(t)[:2]), rel=1e-12)


def test_rows_of_a_simulation_are_its_own() -> None:
    motion = Motion.from_text(LIMITED.replace("SPEED", "10").replace("TORQUE", "50") + "control: {law: none}\n")
    run = motion.simulate()
    names, rows = samples(motion, run)
    assert names == ("t", "q1", "qd1", "tau1", "energy", "work", "lost")
    assert (rows[:, 0] == run.t).all()
    assert (rows[:, 4] == run.energy).all()


def test_comma_separated_values_have_all_digits() -> None:
    motion = Motion.from_text(LIMITED.replace("SPEED", "10").replace("TORQUE", "50"))
    head, *lines = csv_bytes(motion).decode().splitlines()
    assert head == "t,q1,qd1,qdd1,tau1"
    assert (np.array([[float(cell) for cell in line.split(",")] for line in lines]) == samples(motion)[1]).all()


def test_a_simulation_has_a_row_for_each_segment_that_it_reached() -> None:
    head = LIMITED.replace("SPEED", "10").replace("TORQUE", "50").partition("path:")[0]
    text = head + "path: [a, {to: b, time: 1/2}, {to: a, time: 1/2}]\ncontrol: {law: pd, kp: 400, kd: 40}\n"
    motion = Motion.from_text(text)
    run = motion.simulate()
    rows = simulated_table(motion, run)
    assert [row[0] for row in rows] == ["a -> b", "b -> a"]
    half = int(np.abs(run.t - 0.5).argmin())
    assert rows[1][3] == f"{run.work[-1] - run.work[half]:.4g} J"
    worst = np.abs(run.q - motion(run.t)[0])[: half + 1].max()
    assert f"{worst:.1e}" in rows[0][1]


def test_work_of_a_simulation_is_that_of_its_motors_also_where_a_body_is_taken_up() -> None:
    text = LIMITED.replace("speed: SPEED, torque: TORQUE", "").replace("time: 3}", "time: 3, payload: 2}")
    motion = Motion.from_text(text + "control: {law: computed-torque, kp: 100, kd: 20}\n")
    planned = [row[-1] for row in table(motion)]
    assert [row[3] for row in simulated_table(motion, motion.simulate())] == planned
