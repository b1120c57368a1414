"""The curve of the hand and incremental inverse kinematics: document 001, slides 25 to 32."""

from pathlib import Path

import numpy as np
import pytest
from sympy import Symbol, cos, latex, pi, sin, sqrt

from derive.arrays import Array
from derive.cli.main import main
from derive.errors import QuantityError
from derive.motion.incremental import Walker, increments_of, printed_increments
from derive.motion.motion import Motion
from derive.motion.output.printed import HandCurve, printed_hand, printed_weights
from derive.plans.profile import TIME
from derive.robot.evaluate import parameter_values
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from tests.motion.plans import PICK_AND_PLACE, REACH, ROOT

L0, L1 = Symbol("l0"), Symbol("l1")


@pytest.fixture(scope="module")
def root() -> HandCurve:
    return HandCurve(Motion.from_text(ROOT))


def hand_of(motion: Motion, t: Array, h: float = 1e-5) -> tuple[Array, Array]:
    """Where the hand is within a motion, and its velocity by differences."""
    before, p, after = (motion.poses(t + step)[:, :3, 3] for step in (-h, 0.0, h))
    return p, (after - before) / (2 * h)


def test_slide_29_the_hand_is_a_formula_of_the_curves(root: HandCurve) -> None:
    """P_e(t) = (l1 c_ab + l0 c_b + Tx, -l1 s_ab - l0 s_b + Ty), of alpha(t), beta(t), Tx(t), Ty(t)."""
    values = Motion.from_text(ROOT).plan.curves
    assert list(values) == ["q1", "q2", "q3", "q4"]
    beta, alpha = pi / 3 + sin(TIME) / 2, pi / 4 * sin(2 * TIME)
    x, y, z = root.formula
    assert (x - (L1 * cos(alpha + beta) + L0 * cos(beta) + 3 * TIME / 10)).expand() == 0
    assert (y - (-L1 * sin(alpha + beta) - L0 * sin(beta) + TIME**2 / 10)).expand() == 0
    assert z == 0


def test_formula_and_numbers_agree_and_velocities_are_derivatives() -> None:
    t = np.linspace(0.1, 4.9, 6)
    for text in (REACH, ROOT):
        motion = Motion.from_text(text)
        p, v = hand_of(motion, t)
        numbers = {L0: 0.4, L1: 0.3, Symbol("Tx"): 0.1, Symbol("Ty"): 0.2}
        for axis, entry in enumerate(HandCurve(motion).formula):
            rate = entry.diff(TIME)
            for place, speed, at in zip(p[:, axis], v[:, axis], t, strict=True):
                assert float(entry.subs(numbers).subs(TIME, at)) == pytest.approx(place, abs=1e-12)
                assert float(rate.subs(numbers).subs(TIME, at)) == pytest.approx(speed, abs=1e-8)


def test_a_base_that_moves_is_the_root_with_joints() -> None:
    moving = REACH.replace(", rpy: [0, 0, t/7]", "").replace("Tx: 0.1, Ty: 0.2", "Tx: 0, Ty: 0")
    t = np.linspace(0, 5, 50)
    ours, theirs = (Motion.from_text(text).poses(t)[:, :3, 3] for text in (moving, ROOT))
    assert ours == pytest.approx(theirs, abs=1e-12)


def test_slide_27_how_far_each_joint_moves_the_hand(root: HandCurve) -> None:
    """About P0 by sqrt(l1^2 + l0^2 + 2 l1 l0 cos a), about P1 by l1; the root by one."""
    one, two, shoulder, elbow = root.weights
    alpha = Symbol("q4")
    assert one == two == 1
    assert (shoulder**2 - (L0**2 + L1**2 + 2 * L0 * L1 * cos(alpha))).expand() == 0
    assert (elbow**2 - L1**2).expand() == 0
    assert list(printed_weights(Motion.from_text(ROOT)))[2].startswith("q3 moves the hand by sqrt(")


def test_the_hand_of_document_004_runs_on_a_limacon() -> None:
    """Simulation pages, rest to A: q1 = q2 = u, p = 2(e^iu + e^2iu), and |dp/du| = 2 sqrt(5 + 4 cos u)."""
    motion = Motion.from_text(PICK_AND_PLACE)
    t = np.linspace(0, 3, 63)[1:-1]
    u, rate = (value[:, 0] for value in motion(t)[:2])
    p, v = hand_of(motion, t)
    assert p[:, 0] + 1j * p[:, 1] == pytest.approx(2 * (np.exp(1j * u) + np.exp(2j * u)), abs=1e-12)
    assert p[:, 2] == pytest.approx(np.full(61, -1.0), abs=1e-12)
    assert np.linalg.norm(v, axis=1) == pytest.approx(2 * np.sqrt(5 + 4 * np.cos(u)) * rate, abs=1e-8)
    a, b = Symbol("q1"), Symbol("q2")
    x, y, _ = HandCurve(motion).position
    arm = {Symbol("a1"): 2, Symbol("a2"): 2, a: TIME, b: TIME}
    squared = sum(entry.subs(arm).diff(TIME) ** 2 for entry in (x, y))
    assert (squared - (2 * sqrt(5 + 4 * cos(TIME))) ** 2).simplify() == 0


def test_print_leaves_out_what_is_always_zero_and_says_positions_and_velocities() -> None:
    lines = list(printed_hand(Motion.from_text(ROOT)))
    assert [line.split(" =")[0].strip() for line in lines] == ["hand", "px", "py", "vx", "vy"]
    assert "3*t/10" in lines[1]
    in_latex = list(printed_hand(Motion.from_text(ROOT), as_latex=True))
    assert in_latex[1].startswith("p_x(t) = ")
    assert latex(L0) in in_latex[1]


def test_a_symbol_without_number_is_named() -> None:
    with pytest.raises(QuantityError, match="'l0'"):
        Motion.from_text(ROOT.replace("l0: 0.4, ", "")).poses(np.zeros(1))
    with pytest.raises(QuantityError, match="only curves"):
        _ = HandCurve(Motion.from_text(PICK_AND_PLACE)).formula


VALUES = {"l0": 0.4, "l1": 0.3, "Tx": 0.1, "Ty": 0.2}
START = np.array([0.3, 0.9])


def place(walker: Walker, q: Array) -> Array:
    return walker.pose(q)[:3, 3]


@pytest.fixture(scope="module")
def walker() -> Walker:
    return Walker(Robot.load("skeleton"), VALUES)


def test_the_error_before_correction_falls_with_the_step_and_the_hand_follows_the_line(walker: Walker) -> None:
    target = place(walker, np.array([0.8, 1.4]))
    coarse, fine = walker.walk(START, target, 200), walker.walk(START, target, 400)
    assert coarse.error / fine.error == pytest.approx(2, abs=0.05)
    assert coarse.error > 1e-5
    for found in (coarse, fine):
        assert found.closed <= 1e-9
        assert np.linalg.norm(place(walker, found.q[-1]) - target) <= 1e-9
        assert (found.damped, found.factor) == (0, "")
        assert 0 < found.corrections < 6
    found = walker.walk(START, target, 1000)
    places = np.array([place(walker, q) for q in found.q])
    line = place(walker, START) + np.linspace(0, 1, 1001)[:, None] * (target - place(walker, START))
    assert np.abs(places - line).max() < 1e-3
    assert found.q.shape == (1001, 2)


def test_near_the_straight_arm_steps_are_damped_and_the_vanishing_factor_is_named(walker: Walker) -> None:
    beyond = np.array([0.1 + 0.75, 0.2, 0])
    found = walker.walk(np.array([0.3, -0.6]), beyond, 100)
    assert found.damped > 0
    assert found.factor == "sin(q2)"
    assert 0.05 <= found.closed < 0.1
    assert np.abs(np.diff(found.q, axis=0)).max() < 1


@pytest.mark.first(12)
@pytest.mark.parametrize("start", [[0.0, 0.0], [0.5, 0.0], [0.5, np.pi], [0.3, 1.0], [0.3, 1e-8]])
@pytest.mark.parametrize("share", [0.3, -0.3, 0.6, -0.9])
@pytest.mark.parametrize("steps", [50, 400])
def test_targets_across_or_along_an_axis_are_met(walker: Walker, start: list[float], share: float, steps: int) -> None:
    """J^+ of a straight arm leads along it and never aside."""
    pivot, q = np.array([0.1, 0.2, 0]), np.array(start)
    way = place(walker, q) - pivot
    target = pivot + share * 0.7 * way / np.linalg.norm(way)
    found = walker.walk(q, target, steps)
    assert found.is_closed
    assert place(walker, found.q[-1]) == pytest.approx(target, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "turns"), [("puma560-corke", True), ("scara-matlab", True), ("skeleton", False), ("planar-3r", True)]
)
def test_a_hand_that_is_free_to_turn_is_brought_to_the_orientation_too(name: str, turns: bool) -> None:
    robot, random = Robot.load(name), np.random.default_rng(2)
    free = Walker(robot, {**VALUES, **{symbol: 0.4 for symbol in free_symbols(robot)}, **parameter_values(robot)})
    for case in range(4):
        start, end = random.uniform(-2, 2, (2, robot.n)) * [[case > 0], [1]]
        coarse, fine = (free.walk(start, free.pose(end), steps) for steps in (100, 200))
        assert fine.is_closed
        assert (fine.turn is not None) is turns
        wanted = free.pose(end) if turns else free.pose(end)[:3, 3]
        reached = free.pose(fine.q[-1]) if turns else place(free, fine.q[-1])
        assert reached == pytest.approx(wanted, abs=3e-9)
        if turns and not (coarse.damped or fine.damped or case == 0):
            assert fine.turn == pytest.approx((coarse.turn or 0) / 2, rel=0.2, abs=1e-9)


def test_targets_that_stay_open_are_told_with_status_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "plan.yaml"
    plan.write_text(
        "robot: {name: arm, convention: standard, joints: [{type: revolute, a: 1}, {type: revolute, a: 1}]}\n"
        "points: {a: [0, 0], b: [pi/3, -2*pi/3]}\npath: [a, {to: b, time: 1}]\n"
    )
    assert main(["move", str(plan), "--increments", "20"]) == 0
    assert "in attempt 2, aside of where J^+ stops" in capsys.readouterr().out
    monkeypatch.setattr("derive.motion.incremental.ANEW", 0)
    assert main(["move", str(plan), "--increments", "20"]) == 1
    printed = capsys.readouterr()
    assert "a -> b: 1 m after 20 steps, 1 m after 40; not closed: 1 m left by 50 corrections" in printed.out
    assert "increments do not close on the target of a -> b; go through a point aside" in printed.err


def test_what_has_no_path_or_a_base_that_moves_is_refused() -> None:
    with pytest.raises(QuantityError, match="base moves"):
        increments_of(Motion.from_text(REACH), 10)
    curves = "robot: planar-3r\ncurves: {q1: t, q2: t**2, q3: t}\ntime: 1\n"
    with pytest.raises(QuantityError, match="from point to point"):
        increments_of(Motion.from_text(curves), 10)


def test_a_hand_that_no_joint_moves_stays_where_it_is(recwarn: pytest.WarningsRecorder) -> None:
    robot = Robot.from_text("name: arm\nconvention: standard\njoints: [{type: revolute}]\n")
    found = Walker(robot, {}).walk(np.zeros(1), np.zeros(3), 3)
    assert found.error == 0
    assert not found.damped
    assert not recwarn.list


def test_near_a_singular_configuration_other_directions_are_exact_and_an_end_there_is_named() -> None:
    """C to D goes down where sin(q2) = 0, and A to C ends there (document 004)."""
    motion = Motion.from_text(PICK_AND_PLACE)
    first, to_b, _, to_c, down = increments_of(motion, 20)
    assert first.factor == "sin(q2)"
    assert to_b.error < 1e-12
    assert down.error < 1e-12
    assert (down.damped, down.factor) == (20, "sin(q2)")
    assert to_c.damped == 0
    assert to_c.factor == "sin(q2)"
    assert to_c.closed <= 1e-9
    lines = list(printed_increments(motion, 20))
    assert "near sin(q2) = 0" in lines[0]
    assert lines[1].startswith("A -> B: ")
    assert lines[3].endswith("; ends near sin(q2) = 0")
