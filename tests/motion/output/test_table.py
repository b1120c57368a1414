"""Tables, the summary, the plane and playback of a motion."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from sympy import Abs, atan2, cos, pi, sign, sin, sqrt, tan

from derive.motion.motion import Motion
from derive.motion.output import printed
from derive.motion.output.film import Film, frames_of, motion_normal
from derive.motion.output.page import OPERATIONS, motion_page, playback, tree
from derive.plans.profile import TIME
from tests.motion.plans import PICK_AND_PLACE, REACH, ROOT, swing

LIMITED = """\
robot: {name: arm, convention: standard, gravity: [0, -9.81, 0], links: [{mass: 1}],
  joints: [{type: revolute, a: 1, limits: [-1, 1], speed: SPEED, torque: TORQUE}]}
points: {a: [-1], b: [1]}
path: [a, {to: b, time: 1}, {to: a, time: 3}]
"""


SPRUNG = swing("1", "kp: 400, kd: 40", ", speed: 1")


def test_each_segment_has_a_row_with_the_joint_that_has_most_to_do() -> None:
    rows = printed.table(Motion.from_text(PICK_AND_PLACE))
    peaks = "q1 5*pi/16 = 0.9817 rad/s | q1 5*sqrt(3)*pi/27 = 1.008 rad/s^2 | tau1 376.8 N m at 0.6172 s"
    assert " | ".join(rows[0]) == f"rest -> A | 3 s | {peaks} | 17.98 J"
    assert rows[1][2] == "q3 5/4 = 1.25 m/s"


def test_each_joint_has_a_row_with_its_root_mean_square_its_power_and_its_work() -> None:
    motion = Motion.from_text(PICK_AND_PLACE)
    rows = printed.joint_table(motion)
    assert len(rows) == 5 * 4
    load = motion.peaks[0].loads[1]
    assert rows[1][:3] == ("", "q2", "5*pi/16 = 0.9817 rad/s")
    assert rows[1][5:] == (f"{load.rms:.4g} N m", f"{load.power:.4g} W", f"{load.work:.4g} J")
    assert (rows[6][2], rows[6][4]) == ("5/4 = 1.25 m/s", "-70.94 N at 5.493 s")
    assert all(len(row) == len(printed.JOINT_HEADER) for row in rows)


def test_nothing_that_moves_is_said_so() -> None:
    text = PICK_AND_PLACE.replace("path: [rest, {to: A, time: 3}", "path: [rest, {to: rest, time: 1}")
    assert printed.table(Motion.from_text(text))[0][2:4] == ("none", "none")


def test_what_exceeds_a_limit_of_the_robot_or_of_the_plan_is_told_with_time_and_amount() -> None:
    lines = printed.violations(Motion.from_text(LIMITED.replace("SPEED", "2").replace("TORQUE", "100")))
    assert lines == ["q1: speed 3.75 rad/s at 0.5 s exceeds the limit 2 by 1.75 rad/s"]
    assert printed.violations(Motion.from_text(LIMITED.replace("SPEED", "3.75").replace("TORQUE", "100"))) == []
    text = LIMITED.replace("SPEED", "3").replace("TORQUE", "100") + "speed: [3.5]\nacceleration: [10]\n"
    speed, acceleration = printed.violations(Motion.from_text(text))
    assert speed.endswith("exceeds the limit 3 by 0.75 rad/s")
    assert acceleration.startswith("q1: acceleration ")
    assert acceleration.endswith(" rad/s^2")


def test_of_a_simulation_what_happens_is_compared() -> None:
    text = LIMITED.replace("SPEED", "3.7").replace("TORQUE", "100") + "control: {law: pd, kp: 300, kd: 30}\n"
    motion = Motion.from_text(text)
    (line,) = [line for line in printed.violations(motion, motion.simulate()) if "speed" in line]
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


def test_samples_have_a_column_for_each_quantity_and_all_digits_in_the_file() -> None:
    motion = Motion.from_text(LIMITED.replace("SPEED", "10").replace("TORQUE", "50"))
    names, rows = printed.samples(motion)
    assert names == ("t", "q1", "qd1", "qdd1", "tau1")
    assert rows.shape == (401, 5)
    t, q, qd, qdd, tau = rows[37]
    assert tau == pytest.approx(qdd + 9.81 * np.cos(q), rel=1e-12)
    assert (q, qd) == pytest.approx(tuple(value[0] for value in motion(t)[:2]), rel=1e-12)
    head, *lines = printed.csv_bytes(motion).decode().splitlines()
    assert head == "t,q1,qd1,qdd1,tau1"
    assert (np.array([[float(cell) for cell in line.split(",")] for line in lines]) == printed.samples(motion)[1]).all()


def test_rows_of_a_simulation_are_its_own() -> None:
    motion = Motion.from_text(LIMITED.replace("SPEED", "10").replace("TORQUE", "50") + "control: {law: none}\n")
    run = motion.simulate()
    names, rows = printed.samples(motion, run)
    assert names == ("t", "q1", "qd1", "tau1", "energy", "work", "lost")
    assert (rows[:, 0] == run.t).all()
    assert (rows[:, 4] == run.energy).all()


def test_a_simulation_has_a_row_for_each_segment_that_it_reached() -> None:
    head = LIMITED.replace("SPEED", "10").replace("TORQUE", "50").partition("path:")[0]
    text = head + "path: [a, {to: b, time: 1/2}, {to: a, time: 1/2}]\ncontrol: {law: pd, kp: 400, kd: 40}\n"
    motion = Motion.from_text(text)
    run = motion.simulate()
    rows = printed.simulated_table(motion, run)
    assert [row[0] for row in rows] == ["a -> b", "b -> a"]
    half = int(np.abs(run.t - 0.5).argmin())
    assert rows[1][3] == f"{run.work[-1] - run.work[half]:.4g} J"
    worst = np.abs(run.q - motion(run.t)[0])[: half + 1].max()
    assert f"{worst:.1e}" in rows[0][1]


def test_work_of_a_simulation_is_that_of_its_motors_also_where_a_body_is_taken_up() -> None:
    text = LIMITED.replace("speed: SPEED, torque: TORQUE", "").replace("time: 3}", "time: 3, payload: 2}")
    motion = Motion.from_text(text + "control: {law: computed-torque, kp: 100, kd: 20}\n")
    planned = [row[-1] for row in printed.table(motion)]
    assert [row[3] for row in printed.simulated_table(motion, motion.simulate())] == planned


def test_exact_peaks_stand_beside_their_decimals() -> None:
    motion = Motion.from_text(PICK_AND_PLACE, "p.yaml")
    found = printed.summary(motion)
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    first = found["segments"][0]
    assert (found["plan"], found["duration"], found["samples"]) == ("p.yaml", 15.0, 1501)
    assert first["joints"]["q1"]["speed"]["exact"] == "5*pi/16"
    assert first["joints"]["q1"]["speed"]["value"] == pytest.approx(0.98174770424681)
    load = motion.peaks[0].loads[0]
    assert first["joints"]["q1"]["torque"] == {"value": load.peak, "time": load.time, "rms": load.rms}
    assert first["work"] == pytest.approx(sum(joint["work"] for joint in first["joints"].values()))


def test_what_was_sampled_has_no_exact_value_and_an_arm_without_links_no_torque() -> None:
    found = printed.summary(Motion.load("skeleton-reach"))
    (segment,) = found["segments"]
    assert "exact" not in segment["joints"]["q4"]["speed"]
    assert "work" not in segment
    assert set(segment["joints"]["q1"]) == {"speed", "acceleration"}


def test_a_simulation_has_its_ledger_and_the_largest_errors() -> None:
    motion = Motion.from_text(SPRUNG.replace("law: pd", "law: pd-gravity"))
    run = motion.simulate()
    found = printed.summary(motion, run)
    assert found["simulation"]["reached"]
    assert found["simulation"]["largest_errors"]["q1"] == abs(run.q - motion(run.t)[0]).max()
    (violation,) = found["violations"]
    assert (violation["joint"], violation["what"], violation["limit"]) == ("q1", "speed", 1.0)


@pytest.mark.parametrize(
    ("text", "normal"),
    [
        (ROOT, [0, 0, 1]),
        (REACH, [0, 0, 1]),
        (REACH.replace("rpy: [0, 0, t/7]", "x: t").replace("x: 3*t/10, ", ""), [0, 0, 1]),
        (PICK_AND_PLACE, None),
        (REACH.replace("[0, 0, t/7]", "[t, 0, 0]"), None),
        (REACH.replace("x: 3*t/10", "z: 3*t/10"), None),
    ],
)
def test_what_stays_in_a_plane_is_seen_there_and_what_leaves_it_in_space(text: str, normal: list[int] | None) -> None:
    found = motion_normal(Motion.from_text(text))
    assert (found is None) if normal is None else np.abs(found) == pytest.approx(normal, abs=1e-12)


def test_the_film_of_a_planar_arm_keeps_lengths_and_the_page_faces_its_plane() -> None:
    film = Film(Motion.from_text(ROOT))
    poses = frames_of(film.motion, film.times, film._q)
    ends = film._view.project(poses[:, [2, 3, -1]][..., :3, 3])[..., :2]
    lengths = np.linalg.norm(np.diff(ends, axis=1), axis=-1)
    assert lengths == pytest.approx(np.tile([0.4, 0.3], (len(lengths), 1)), rel=1e-6)
    assert '"facing": [' in motion_page(Motion.from_text(ROOT))


def test_frames_go_with_the_base() -> None:
    motion = Motion.from_text(REACH)
    t = np.array([0.0, 2.0])
    frames = frames_of(motion, t, motion(t)[0])
    base = motion.base
    assert frames[:, 0, :3, 3] == pytest.approx(np.array([at[:3, :3] @ [0.1, 0.2, 0] + at[:3, 3] for at in base(t, 0)]))


LAW: dict[str, Callable[..., float]] = {name: getattr(math, name) for name in ("sin", "cos", "tan", "atan2", "atan")}
LAW |= {"add": lambda *terms: math.fsum(terms), "multiply": lambda *factors: math.prod(factors)}
LAW |= {"power": lambda a, b: a**b, "sign": lambda a: math.copysign(1, a) if a else 0.0, "abs": abs}


def value(formula: Any, t: float) -> float:
    if isinstance(formula, list):
        return LAW[formula[0]](*(value(part, t) for part in formula[1:]))
    return t if formula == "t" else float(formula)


@pytest.mark.parametrize(
    "formula",
    [
        pi / 4 * sin(2 * TIME),
        TIME**2 / 10 - cos(TIME),
        sqrt(1 + TIME) / (2 + TIME),
        atan2(TIME, 3) + atan2(1, TIME - 2) + tan(TIME / 5),
        Abs(TIME - 2) * sign(TIME - 1),
        pi / 3,
    ],
)
def test_a_formula_is_a_tree_of_numbers_and_operations(formula: Any) -> None:
    made = tree(formula)
    for t in (0.1, 0.7, 1.9):
        assert value(made, t) == pytest.approx(float(formula.subs(TIME, t)), rel=1e-14)


def test_a_formula_is_a_tree_of_operations_that_the_page_knows() -> None:
    assert set(LAW) == set(OPERATIONS.values())


def test_pieces_of_a_joint_follow_each_other_and_end_with_the_motion() -> None:
    motion = Motion.from_text(PICK_AND_PLACE)
    made = playback(motion)
    assert made.duration == 15
    for j, track in enumerate(made.tracks):
        assert [piece.start for piece in track] == [0, 3, 6, 9, 12]
        assert all(piece.duration == 3 for piece in track)
        assert [piece.values[0] for piece in track] == motion(np.array([0.0, 3, 6, 9, 12]))[0][:, j].tolist()
    assert made.ranges[2] == (1, 3)
    assert made.basis == {3: made.basis[3]}


def test_what_the_tool_carries_is_known_by_its_segment() -> None:
    text = PICK_AND_PLACE.replace("{to: D, time: 3}", "{to: D, time: 3, payload: 0.5}")
    made = playback(Motion.from_text(text))
    assert [bool(payload) for _, _, payload, _ in made.segments] == [False, False, False, False, True]
    assert 0.5 in [number for _, number in made.segments[-1][2]]
    assert made.functions == ("inverse_dynamics", "regressor")


def test_of_a_simulation_the_rows_are_played_down_to_the_first_alone_and_its_excess_is_told() -> None:
    motion = Motion.from_text(SPRUNG)
    run = motion.simulate()
    made = playback(motion, run)
    assert made.run.times == tuple(run.t.tolist())
    assert np.array(made.run.q) == pytest.approx(run.q, rel=1e-11)
    assert made.bounds == {"speed": ((None, 1.0),)}
    ((quantity, joint, _, value),) = made.exceeded
    assert (quantity, joint, value) == ("speed", 0, pytest.approx(np.abs(run.qd).max()))
    assert made.ranges[0][0] == pytest.approx(run.q.min())
    only = replace(run, **{name: getattr(run, name)[:1] for name in ("t", "q", "qd", "tau", "energy", "work", "lost")})
    made = playback(motion, only)
    assert made.duration == motion.sample
    assert made.run.times == (0, motion.sample)
    assert made.run.q == ((0.0,), (0.0,))


def test_motions_of_many_pieces_and_long_simulations_have_fewer_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("derive.motion.output.page.MOST_NUMBERS", 32)
    motion = Motion.from_text(PICK_AND_PLACE)
    made = playback(motion)
    assert made.places == 4
    times = [piece.start for piece in made.tracks[0]]
    assert times == [0, 5, 10]
    values = np.array([piece.values[:2] for piece in made.tracks[1]]).T
    assert pytest.approx(np.array(motion(np.array(times)))[:2, :, 1], abs=1e-14) == values
    monkeypatch.setattr("derive.motion.output.page.MOST_NUMBERS", 200)
    motion = Motion.from_text(SPRUNG)
    made = playback(motion, motion.simulate()).run
    assert 4 * len(made.times) <= 104
    assert made.times[-1] == 1


def test_an_arm_without_links_has_no_torques() -> None:
    arm = "{name: arm, convention: standard, joints: [{type: revolute, a: 1}]}"
    made = playback(Motion.from_text(f"robot: {arm}\ncurves: {{q1: t**2}}\ntime: 2\n"))
    assert made.functions == ()
    assert made.tracks[0][0].values[1] == ["multiply", 2.0, "t"]


def test_a_base_that_moves_brings_a_program_for_each_load() -> None:
    text = PICK_AND_PLACE.replace("{to: D, time: 3}", "{to: D, time: 3, payload: 0.5}") + "base: {x: t/2}\n"
    found = playback(Motion.from_text(text))
    assert [load for *_, load in found.segments] == [0, 0, 0, 0, 1]
    assert len(found.base_torques) == 2
    assert all(len(results) == 4 for _, results in found.base_torques)
    assert [len(rows) for rows in found.base_rates] == [3, 3]
    assert playback(Motion.from_text(PICK_AND_PLACE)).base_torques == ()
